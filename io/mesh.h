/* Meshes as files: polygons from OBJ, OFF, PLY, STL and glTF, tetrahedra from .node and .ele; write OBJ.
 *
 * Owns: io_mesh, the mesh as it stands in a file. Called by the scene reader, the command and the
 * exporters. Invariant of a mesh that was read: at least one vertex and one face; every face has three
 * or more corners, all different, all below vertex_count; every coordinate is finite; one vertex per
 * line of the file and the faces with their sizes, all in the file's own order.
 */
#ifndef SKEIN_IO_MESH_H
#define SKEIN_IO_MESH_H

#include "io/file.h"

#define IO_NO_UV UINT32_MAX
#define IO_MESH_MOST_VERTICES (UINT32_MAX - 1) /* 2^32 - 2 */

/* face_sizes      3        4
 * face_vertices   0 1 2    2 1 3 4      corners, face after face, 0-based
 * face_uvs        0 1 2    2 1 - -      the corners' places in uvs; IO_NO_UV where a corner has none */
/* A line of an OBJ that names the object, group, smoothing or material of the faces from `face` on, or the file of the
 * materials: "usemtl red", its words parted by one blank each. */
typedef struct io_mesh_mark {
    size_t face;
    char *line;
} io_mesh_mark;

typedef struct io_mesh {
    double *positions; /* vertex_count x 3, as in the file */
    size_t vertex_count;
    uint32_t *face_sizes; /* face_count */
    size_t face_count;
    uint32_t *face_vertices; /* face_vertex_count */
    uint32_t *face_uvs;      /* face_vertex_count */
    size_t face_vertex_count;
    double *uvs; /* uv_count x 2 */
    size_t uv_count;
    struct io_mesh_mark *marks; /* mark_count, by their faces: what OBJ says of the faces that follow */
    size_t mark_count, mark_capacity;
    bool tetrahedra; /* the faces are none, but tetrahedra of four corners each, in no order of their own */
    size_t vertex_capacity, face_capacity, corner_capacity, corner_uv_capacity, uv_capacity; /* internal */
} io_mesh;

/* Whether the path's ending is that of a mesh. */
bool io_path_is_mesh(const char *path);
/* Reads a mesh by its ending in any case, .obj, .off, .ply, .stl, .glb or .gltf; .node or .ele reads both files of the name. `out` is
 * overwritten (free it afterwards) and empty on failure. Faults that leave a usable mesh are warnings, one line each.
 */
skein_status io_mesh_read(const char *path, io_mesh *out, io_warnings warnings, skein_error *error);
void io_mesh_free(io_mesh *mesh); /* empty again; an empty one is allowed */

/* The mesh as the library takes it; valid until the mesh changes. */
skein_mesh io_mesh_view(const io_mesh *mesh);

/* Building one by hand, from io_mesh mesh = {0}. False: no memory. A face's corners are added one by
 * one, then closed by the number of them. */
bool io_mesh_add_vertex(io_mesh *mesh, const double position[3]);
bool io_mesh_add_uv(io_mesh *mesh, const double uv[2]);
bool io_mesh_add_corner(io_mesh *mesh, uint32_t vertex, uint32_t uv);
bool io_mesh_add_face(io_mesh *mesh, uint32_t size);
/* Takes `line`, which malloc() made, for the faces from here on. */
bool io_mesh_add_mark(io_mesh *mesh, char *line);

/* Read a mesh from memory; `path` serves the messages only. */
skein_status io_obj_read(const char *text, size_t size, const char *path, io_mesh *out, io_warnings warnings,
                         skein_error *error);
skein_status io_off_read(const char *text, size_t size, const char *path, io_mesh *out, io_warnings warnings,
                         skein_error *error);
/* What these read is bytes. A .gltf may name files of numbers, which are looked for in the folder of `path` alone. */
skein_status io_ply_read(const char *text, size_t size, const char *path, io_mesh *out, io_warnings warnings,
                         skein_error *error);
skein_status io_stl_read(const char *text, size_t size, const char *path, io_mesh *out, io_warnings warnings,
                         skein_error *error);
skein_status io_gltf_read(const char *text, size_t size, const char *path, io_mesh *out, io_warnings warnings,
                          skein_error *error);

/* A text in memory; `path` serves the messages. */
typedef struct io_text {
    const char *text;
    size_t size;
    const char *path;
} io_text;
/* A mesh of tetrahedra: points in one text, corners in the other. */
skein_status io_tetrahedra_read(const io_text *node, const io_text *ele, io_mesh *out, io_warnings warnings,
                                skein_error *error);
/* The same from both files of a name, of at most `most` bytes each; `path` is either. */
skein_status io_tetrahedra_read_files(const char *path, size_t most, io_mesh *out, io_warnings warnings,
                                      skein_error *error);

/* Writes an OBJ with unit vertex normals, faces as `a//a b//b c//c` in the mesh's own order. Positions
 * are written as floats that read back bit for bit. Refuses a position that is not finite as a float.
 * `mesh` needs valid indices. */
skein_status io_obj_write(const char *path, const skein_mesh *mesh, skein_normals normals, skein_error *error);
/* The same with the texture coordinates, objects, groups and materials of the mesh that was read from `read_path`, of
 * the same faces. A file of materials is named with its folder. */
skein_status io_obj_write_as(const char *path, const skein_mesh *mesh, skein_normals normals, const io_mesh *read,
                             const char *read_path, skein_error *error);
/* Whether a mesh that was read has the same vertices and faces, in number and order. */
bool io_mesh_has_faces_of(const io_mesh *read, const skein_mesh *mesh);

/* ---- For the readers and writers: lines, words and numbers -------------------------------------- */

/* A word ends at a blank, a comment ('#' to the line's end) or the line's end. Lines end with LF,
 * CR LF or CR; where `continues`, a backslash right before the end joins the next line on. */
typedef struct io_scan {
    const char *at, *end;
    size_t line; /* of `at`, from 1 */
    bool continues;
    const char *path;
    skein_error *error;
} io_scan;

typedef struct io_word {
    const char *begin, *end;
    size_t line;
} io_word;

/* Begins after a UTF-8 mark; fails on UTF-16. */
skein_status io_scan_start(io_scan *scan, const char *text, size_t size);
/* Fails on the first NUL byte: what has one is no text. */
skein_status io_scan_check_text(const io_scan *scan);
/* The line's next word; false at its end (or comment). */
bool io_scan_word(io_scan *scan, io_word *word);
/* Goes to the next line; false at the text's end. */
bool io_scan_line(io_scan *scan);
/* The first word of the next line that has one; false at the text's end. */
bool io_scan_next_line_word(io_scan *scan, io_word *word);
/* The word as a whole number from 0 to `most`, or an error that begins with `name`. */
skein_status io_scan_count(const io_scan *scan, io_word word, const char *name, uint64_t most, uint64_t *value);
/* For the end of a message about a line that is too short. */
const char *io_scan_cut_hint(const io_scan *scan);
/* The word as a finite number, or an error that says what was expected: "a coordinate". */
skein_status io_scan_number(const io_scan *scan, io_word word, const char *expected, double *value);
/* Closes a face of the last `size` corners added; fails where it has fewer than three or one twice.
 * `base` is the format's first index, for the message. */
skein_status io_scan_close_face(const io_scan *scan, io_mesh *mesh, size_t line, size_t size, uint32_t base);
bool io_word_is(io_word word, const char *text);

typedef enum io_number {
    IO_NUMBER_FINE,
    IO_NUMBER_NONE,      /* not a decimal number */
    IO_NUMBER_NOT_FINITE /* nan, inf, or too large for a double */
} io_number;

/* Reads [begin, end), all of it, as a decimal number (".5", "5.", "+1", "1e-3"): correctly rounded,
 * the same in every locale. */
io_number io_number_parse(const char *begin, const char *end, double *value);

/* Prints a finite float as "%.9g" does in the C locale, which reads back as the same float; -0 as 0.
 * Returns the length. */
#define IO_FLOAT_SIZE 24
size_t io_float_print(float value, char out[IO_FLOAT_SIZE]);

#endif
