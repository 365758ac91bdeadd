/* Tests of io/: files, numbers, meshes in and out, normals, point caches, exporters.
 *
 * Owns a temporary directory for the run. Run from the repository root, or built with
 * -DSKEIN_SOURCE_DIR="..." for the broken meshes in tests/bad/meshes.
 */
#include "io/exporters.h"
#include "io/file.h"
#include "io/mesh.h"
#include "io/pc2.h"

#include <dirent.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#ifndef SKEIN_SOURCE_DIR
#define SKEIN_SOURCE_DIR "."
#endif

#define COUNT(array_) (sizeof(array_) / sizeof *(array_))

/* ---- The temporary directory --------------------------------------------------------------- */

static char folder[] = "/tmp/skein-mesh-io-XXXXXX";

static int make_folder(void **state) {
    (void)state;
    signal(SIGXFSZ, SIG_IGN);
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state) {
    (void)state;
    DIR *open_folder = opendir(folder);
    if (!open_folder) return -1;
    for (struct dirent *entry; (entry = readdir(open_folder)) != NULL;)
        unlinkat(dirfd(open_folder), entry->d_name, 0); // no directories are made
    closedir(open_folder);
    return rmdir(folder);
}

static const char *in_folder(const char *name) {
    static char paths[4][128];
    static int turn;
    char *path = paths[turn++ % 4];
    snprintf(path, sizeof paths[0], "%s/%s", folder, name);
    return path;
}

static void write_text(const char *path, const char *text) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
    assert_int_equal(fclose(file), 0);
}

static io_bytes read_all(const char *path) {
    io_bytes bytes;
    skein_error error;
    assert_int_equal(io_file_read(path, (size_t)1 << 30, &bytes, &error), SKEIN_OK);
    return bytes;
}

/* Files of the directory whose names contain `part`. */
static int count_files(const char *part) {
    DIR *open_folder = opendir(folder);
    assert_non_null(open_folder);
    int count = 0;
    for (struct dirent *entry; (entry = readdir(open_folder)) != NULL;)
        count += entry->d_name[0] != '.' && strstr(entry->d_name, part) != NULL;
    closedir(open_folder);
    return count;
}

/* ---- Files --------------------------------------------------------------------------------- */

static void file_faults_are_named(void **state) {
    (void)state;
    io_bytes bytes;
    skein_error error;
    assert_int_equal(io_file_read(in_folder("nothing"), 100, &bytes, &error), SKEIN_ERROR_FILE);
    assert_string_equal(error.where, in_folder("nothing"));
    assert_string_equal(error.message, "cannot read: no such file or directory");
    assert_null(bytes.data);

    assert_int_equal(io_file_read(folder, 100, &bytes, &error), SKEIN_ERROR_FILE);
    assert_string_equal(error.message, "cannot read: it is a directory, expected a file");
    assert_int_equal(io_file_read("/dev/null", 100, &bytes, NULL), SKEIN_ERROR_FILE);
    // nobody writes into this pipe: whoever waits for that waits for ever
    assert_int_equal(mkfifo(in_folder("pipe"), 0666), 0);
    assert_int_equal(io_file_read(in_folder("pipe"), 100, &bytes, &error), SKEIN_ERROR_FILE);
    assert_string_equal(error.message, "cannot read: it is a pipe, expected a file");
    // the system's own files say that they are empty
    assert_int_equal(io_file_read("/proc/self/status", 1 << 20, &bytes, &error), SKEIN_OK);
    assert_true(bytes.size > 100);
    io_bytes_free(&bytes);

    write_text(in_folder("large"), "12345678901");
    assert_int_equal(io_file_read(in_folder("large"), 10, &bytes, &error), SKEIN_ERROR_LIMIT);
    assert_string_equal(error.message, "the file is larger than the 10 bytes allowed here");
    assert_int_equal(io_file_read(in_folder("large"), 11, &bytes, &error), SKEIN_OK);
    assert_int_equal(bytes.size, 11);
    io_bytes_free(&bytes);

    write_text(in_folder("empty"), "");
    assert_int_equal(io_file_read(in_folder("empty"), 10, &bytes, &error), SKEIN_OK);
    assert_int_equal(bytes.size, 0);
    assert_string_equal(bytes.data, "");
    io_bytes_free(&bytes);
}

static void a_file_that_may_not_be_read_is_told(void **state) {
    (void)state;
    if (geteuid() == 0) skip(); // the superuser may read everything
    skein_error error;
    io_bytes bytes;
    write_text(in_folder("closed"), "0123456789");
    assert_int_equal(chmod(in_folder("closed"), 0), 0);
    assert_int_equal(io_file_read(in_folder("closed"), 100, &bytes, &error), SKEIN_ERROR_FILE);
    assert_string_equal(error.message, "cannot read: no permission");
}

static void long_paths_keep_their_end(void **state) {
    (void)state;
    char path[600];
    memset(path, 'a', sizeof path);
    strcpy(path + 590, "/b.obj");
    skein_error error;
    io_error_at(&error, SKEIN_ERROR_SYNTAX, path, 1234, "%s", "words");
    assert_int_equal(strncmp(error.where, "...aaa", 6), 0);
    assert_string_equal(error.where + strlen(error.where) - 12, "a/b.obj:1234");
    io_error_set(&error, SKEIN_ERROR_SYNTAX, path, "%s", "words");
    assert_int_equal(strlen(error.where), sizeof error.where - 1);
    assert_string_equal(error.where + strlen(error.where) - 7, "a/b.obj");
}

static void output_appears_at_the_commit(void **state) {
    (void)state;
    char path[128];
    snprintf(path, sizeof path, "%s", in_folder("late.txt"));
    skein_error error;
    io_output *output = io_output_open(path, &error);
    assert_non_null(output);
    io_output_printf(output, "%d %s\n", 7, "seven");
    io_output_count(output, UINT64_MAX);
    assert_int_equal(access(path, F_OK), -1);
    assert_int_equal(io_output_commit(output, &error), SKEIN_OK);
    io_bytes bytes = read_all(path);
    assert_string_equal(bytes.data, "7 seven\n18446744073709551615");
    io_bytes_free(&bytes);

    // Abandoned: the old file stands. Through a link: the link stays one. The mode is kept.
    chmod(path, 0640);
    output = io_output_open(path, &error);
    io_output_write(output, "other", 5);
    io_output_abandon(output);
    char link_path[128];
    snprintf(link_path, sizeof link_path, "%s", in_folder("link.txt"));
    assert_int_equal(symlink(path, link_path), 0);
    output = io_output_open(link_path, &error);
    io_output_write(output, "linked", 6);
    assert_int_equal(io_output_commit(output, &error), SKEIN_OK);
    bytes = read_all(path);
    assert_string_equal(bytes.data, "linked");
    io_bytes_free(&bytes);
    struct stat info;
    assert_int_equal(lstat(link_path, &info), 0);
    assert_true(S_ISLNK(info.st_mode));
    assert_int_equal(stat(path, &info), 0);
    assert_int_equal(info.st_mode & 0777, 0640);
    assert_int_equal(count_files(".part"), 0);

    assert_null(io_output_open(folder, &error));
    assert_string_equal(error.message, "cannot write: it is a directory");
    assert_null(io_output_open(in_folder("no/such.txt"), &error));
    assert_string_equal(error.message, "cannot write: its directory does not exist, create it first");
}

static void large_output_is_whole(void **state) {
    (void)state;
    char *block = malloc(200000);
    assert_non_null(block);
    for (int i = 0; i < 200000; i++) block[i] = (char)('a' + i % 26);
    io_output *output = io_output_open(in_folder("large.txt"), NULL);
    assert_non_null(output);
    io_output_write(output, "xxxx", 4);
    io_output_write(output, block, 200000);
    for (int i = 0; i < 200000; i += 100) io_output_write(output, block + i, 100);
    io_output_printf(output, "%.5000s", block);
    io_output_patch(output, 1, "yy", 2);
    assert_int_equal(io_output_commit(output, NULL), SKEIN_OK);
    io_bytes bytes = read_all(in_folder("large.txt"));
    assert_int_equal(bytes.size, 405004);
    assert_memory_equal(bytes.data, "xyyx", 4);
    assert_memory_equal(bytes.data + 4, block, 200000);
    assert_memory_equal(bytes.data + 200004, block, 200000);
    assert_memory_equal(bytes.data + 400004, block, 5000);
    io_bytes_free(&bytes);
    free(block);
}

/* ---- Numbers ------------------------------------------------------------------------------- */

static io_number parse(const char *text, double *value) {
    return io_number_parse(text, text + strlen(text), value);
}

/* The words of a list; NULL after the last. */
static const char *next_word(const char **list) {
    static char word[80];
    int used = 0;
    if (sscanf(*list, "%79s%n", word, &used) != 1) return NULL;
    *list += used;
    return word;
}

static void numbers_are_read_exactly(void **state) {
    (void)state;
    const char *fine = "0 -0 .5 5. +1 -2 1e-3 1E+2 2.e1 00012.50 1e22 1e23 1e-22 1e-23 0.1 8.10109172351e-10 "
                       "123456789.123456789 5e-324 1e-400 1.7976931348623157e308 9007199254740993 "
                       "9007199254740992.999999999999999999999999999999 2.2250738585072011e-308 0e999999999999 "
                       "0.000000000000000000000000000000000000000000012345 "
                       "1234567890123456789012345678901234567890e-40";
    const char *none = "+ - . e5 1e 1e+ 1x 1.2.3 --1 0x1 1,5 1d3 +-1 1e5. na in 1/2 infinite";
    const char *not_finite = "nan -NaN inf +Infinity 1e400 -1e309 1.#INF 1.#QNAN -1.#IND nan(ind)";
    double value;
    for (const char *word; (word = next_word(&fine)) != NULL;) {
        assert_int_equal(parse(word, &value), IO_NUMBER_FINE);
        double expected = strtod(word, NULL);
        assert_memory_equal(&value, &expected, sizeof value);
    }
    for (const char *word; (word = next_word(&none)) != NULL;) assert_int_equal(parse(word, &value), IO_NUMBER_NONE);
    for (const char *word; (word = next_word(&not_finite)) != NULL;)
        assert_int_equal(parse(word, &value), IO_NUMBER_NOT_FINITE);
    assert_int_equal(parse("", &value), IO_NUMBER_NONE);

    // More digits than can matter: half way between two doubles, and a hair above.
    char text[2000] = "9007199254740993.";
    memset(text + 17, '0', 1500);
    assert_int_equal(parse(text, &value), IO_NUMBER_FINE);
    assert_true(value == 9007199254740992.0);
    text[1500] = '1';
    assert_int_equal(parse(text, &value), IO_NUMBER_FINE);
    assert_true(value == 9007199254740994.0);
}

/* A plain generator: the same numbers everywhere. */
static uint64_t next_random(uint64_t *seed) {
    *seed ^= *seed << 13;
    *seed ^= *seed >> 7;
    *seed ^= *seed << 17;
    return *seed;
}

static void numbers_agree_with_the_c_library(void **state) {
    (void)state;
    static const char *const formats[] = {"%.17g", "%.9g", "%.6f", "%.25e", "%.3e", "%.60g"};
    uint64_t seed = 88172645463325252u;
    for (int i = 0; i < 60000; i++) {
        uint64_t bits = next_random(&seed);
        double number, value;
        memcpy(&number, &bits, sizeof number);
        if (i % 2 == 0) number = (double)(int64_t)bits / 1e18;
        if (!isfinite(number)) continue;
        char text[512];
        snprintf(text, sizeof text, formats[i % 6], number);
        double expected = strtod(text, NULL);
        assert_int_equal(parse(text, &value), IO_NUMBER_FINE);
        assert_memory_equal(&value, &expected, sizeof value);

        uint32_t half = (uint32_t)bits;
        float single, back;
        memcpy(&single, &half, sizeof single);
        if (!isfinite(single) || single == 0) continue;
        char printed[IO_FLOAT_SIZE];
        size_t length = io_float_print(single, printed);
        snprintf(text, sizeof text, "%.9g", (double)single);
        assert_string_equal(printed, text);
        assert_int_equal(length, strlen(text));
        back = strtof(printed, NULL);
        assert_memory_equal(&back, &single, sizeof single);
    }
}

static void floats_are_printed_plainly(void **state) {
    (void)state;
    static const float values[] = {0, -0.0f, 1, -1, 0.1f, 100, 1e8f, 1e9f, 0.5f, 1e-4f, 16777216, 0.0009765625f};
    const char *texts = "0 0 1 -1 0.100000001 100 100000000 1e+09 0.5 9.99999975e-05 16777216 0.0009765625";
    for (size_t i = 0; i < COUNT(values); i++) {
        char text[IO_FLOAT_SIZE];
        io_float_print(values[i], text);
        assert_string_equal(text, next_word(&texts));
    }
}

/* ---- Meshes in ----------------------------------------------------------------------------- */

typedef struct heard {
    int count;
    char last[1024];
} heard;

static void hear(void *user, const char *line) {
    heard *h = user;
    h->count++;
    snprintf(h->last, sizeof h->last, "%s", line);
}

static io_mesh read_text(const char *text, bool off, heard *h) {
    io_mesh mesh;
    skein_error error = {SKEIN_OK, "", ""};
    heard unheard = {0, ""};
    io_warnings warnings = {hear, h ? h : &unheard};
    skein_status status = (off ? io_off_read : io_obj_read)(text, strlen(text), "text", &mesh, warnings, &error);
    if (status != SKEIN_OK) fail_msg("%s: %s", error.where, error.message);
    if (unheard.count > 0) fail_msg("unexpected warning %s", unheard.last);
    return mesh;
}

static void expect_mesh(const io_mesh *mesh, size_t vertex_count, const double *positions, size_t face_count,
                        const uint32_t *sizes, const uint32_t *corners) {
    assert_int_equal(mesh->vertex_count, vertex_count);
    for (size_t i = 0; i < 3 * vertex_count && positions; i++) assert_true(mesh->positions[i] == positions[i]);
    assert_int_equal(mesh->face_count, face_count);
    assert_memory_equal(mesh->face_sizes, sizes, face_count * sizeof *sizes);
    size_t corner_count = 0;
    for (size_t f = 0; f < face_count; f++) corner_count += sizes[f];
    assert_int_equal(mesh->face_vertex_count, corner_count);
    assert_memory_equal(mesh->face_vertices, corners, corner_count * sizeof *corners);
}

#define SQUARE "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\n"
static const double square[12] = {0, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 1};

static void every_way_to_write_a_square_is_read(void **state) {
    (void)state;
    static const char *const texts[] = {
        SQUARE "f 1 2 3\nf 1 3 4\n",
        SQUARE "f 1 2 3\nf 1 3 4", // no line end
        "v 0 0 0\r\nv 1 0 0\r\nv 1 0 1\r\nv 0 0 1\r\nf 1 2 3\r\nf 1 3 4\r\n",
        "v 0 0 0\rv 1 0 0\rv 1 0 1\rv 0 0 1\rf 1 2 3\rf 1 3 4\r",
        "\xEF\xBB\xBF" SQUARE "f 1 2 3\nf 1 3 4\n", // a UTF-8 mark
        "f 1 2 3\nf 1 3 4\n" SQUARE,                // faces first
        "v 0 0 0\nv 1 0 0\nv 1 0 1\nf -3 -2 -1\nv 0 0 1\nf -4 -2 -1\n",
        SQUARE "vn 0 1 0\nf 1//1 2//1 3//1\nf 1//-1 3//-1 4//-1\n",
        SQUARE "f 1/ 2/ 3/\nf 1// 3// 4//\n",
        "v .0 0. +0\nv 1e0 -0 0e5\nv 10e-1 0 .1E+1\nv 0 0 1.000\nf 1 2 3\nf 1 3 4\n",
        "v 0 0 0 1\nv 1 0 0 1.0\nv 1 0 1 0.5 0.25 0.125\nv 0 0 1 1 0.5 0.25 0.125\nf 1 2 3\nf +1 +3 +4\n",
        "  v\t0  0\t 0 \n\n\nv 1 0 0\t\nv 1 0 1 # here\nv 0 0 1#there\n f 1 2 3 \nf 1 3 4 #f 1 2 4\n",
        "v 0 0 0\nv 1 \\\n0 0\nv 1 0\\\r\n 1\nv 0 0 1\nf 1 \\\n 2 \\\n 3\nf 1 3 4\n",
        "# a mesh \\\nmtllib a b.mtl\no square\n" SQUARE
        "g one two\nusemtl \xC3\xA4\ns 1\nf 1 2 3\ns off\nvp 1\nf 1 3 4\n",
    };
    static const uint32_t sizes[] = {3, 3}, corners[] = {0, 1, 2, 0, 2, 3};
    for (size_t i = 0; i < COUNT(texts); i++) {
        io_mesh mesh = read_text(texts[i], false, NULL);
        expect_mesh(&mesh, 4, square, 2, sizes, corners);
        for (size_t corner = 0; corner < 6; corner++) assert_int_equal(mesh.face_uvs[corner], IO_NO_UV);
        skein_mesh view = io_mesh_view(&mesh);
        assert_ptr_equal(view.positions, mesh.positions);
        assert_int_equal(view.face_vertex_count, 6);
        io_mesh_free(&mesh);
        assert_null(mesh.positions);
    }
}

static void off_is_read(void **state) {
    (void)state;
    static const char *const texts[] = {
        "OFF\n4 2 5\n0 0 0\n1 0 0\n1 0 1\n0 0 1\n3 0 1 2\n3 0 2 3\n",
        "OFF 4 2\r\n0 0 0\r\n1 0 0\r\n1 0 1\r\n0 0 1\r\n3 0 1 2\r\n3 0 2 3",
        "# c\nOFF # c\n\n4 2 0 # c\n\n0 0 0\n# c\n1 0 0 #red\n1 0 1#blue\n0 0 1\n\n3 0 1 2 7\n3 0 2 3 0.5 "
        "0.5 0.5 1\n\n",
        "OFF\n4 2 0\n0 0 0 255 0 0\n1 0 0 1 2 3 4\n1 0 1\n0 0 1\n3 0 1 2 255 0 0\n3 0 2 3\n",
        "COFF\n4 2 0\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n1 0 1 0.5 1 1 1\n0 0 1 9\n3 0 1 2\n3 0 2 3\n",
        "NOFF\n4 2 0\n0 0 0 0 1 0\n1 0 0 0 1 0\n1 0 1 0 1 0\n0 0 1 0 1 0\n3 0 1 2\n3 0 2 3\n",
        "STCNOFF\n4 2 0\n0 0 0 0 1 0 9 0 0\n1 0 0 0 1 0 9 0 0\n1 0 1 0 1 0 9 0 0\n0 0 1 0 1 0 9 0 0\n3 0 1 "
        "2\n3 0 2 3\n",
    };
    static const uint32_t sizes[] = {3, 3}, corners[] = {0, 1, 2, 0, 2, 3};
    for (size_t i = 0; i < COUNT(texts); i++) {
        io_mesh mesh = read_text(texts[i], true, NULL);
        expect_mesh(&mesh, 4, square, 2, sizes, corners);
        io_mesh_free(&mesh);
    }
    heard h = {0, ""};
    io_mesh mesh = read_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n\n3 0 1 2\n", true, &h);
    assert_int_equal(h.count, 1);
    assert_string_equal(h.last, "text:8: what follows the last face was passed over");
    io_mesh_free(&mesh);
}

static void polygons_and_texture_places_are_kept(void **state) {
    (void)state;
    heard h = {0, ""};
    io_mesh mesh = read_text("v 0 0 0\nv 1 0 0\nv 2 0 1\nv 1 0 2\nv 0 0 2\nv 9 9 9\n"
                             "vt 0 .5\nvt 1\nvt 1 1 0\nvt nan 0\n"
                             "f 1 2 3 4 5\nf 1/1/7 2/2/7 3/-2/7 4/4\nf 1/9 2 3/0\nl 1 2\np 1\nwhat 1 2\nv 1 1 1 2\n",
                             false, &h);
    static const uint32_t sizes[] = {5, 4, 3}, corners[] = {0, 1, 2, 3, 4, 0, 1, 2, 3, 0, 1, 2};
    expect_mesh(&mesh, 7, NULL, 3, sizes, corners);
    static const uint32_t uvs[] = {IO_NO_UV, IO_NO_UV, IO_NO_UV, IO_NO_UV, IO_NO_UV, 0,
                                   1,        2,        3,        IO_NO_UV, IO_NO_UV, IO_NO_UV};
    assert_memory_equal(mesh.face_uvs, uvs, sizeof uvs);
    static const double places[] = {0, 0.5, 1, 0, 1, 1, 0, 0};
    assert_int_equal(mesh.uv_count, 4);
    assert_memory_equal(mesh.uvs, places, sizeof places);
    assert_int_equal(h.count, 4);
    assert_string_equal(h.last, "text:10: a texture coordinate that does not exist was left out (3 in the file)");
    io_mesh_free(&mesh);
}

/* A 16 x 16 grid of quads, each cut into two triangles, as text. */
static char *grid_text(int cells) {
    char *text = malloc((size_t)cells * (size_t)cells * 160 + 4096);
    assert_non_null(text);
    int at = 0, row = cells + 1;
    for (int i = 0; i < row * row; i++)
        at += sprintf(text + at, "v %.6f 0 %.6f\n", i % row / (double)cells, i / row / (double)cells);
    for (int i = 0; i < cells * cells; i++) {
        int a = i / cells * row + i % cells + 1;
        at += sprintf(text + at, "f %d %d %d\nf %d %d %d\n", a, a + row, a + 1, a + 1, a + row, a + row + 1);
    }
    return text;
}

static void the_grid_has_its_counts(void **state) {
    (void)state;
    char *text = grid_text(16);
    write_text(in_folder("Grid.OBJ"), text);
    free(text);
    io_mesh mesh;
    skein_error error;
    assert_int_equal(io_mesh_read(in_folder("Grid.OBJ"), &mesh, (io_warnings){NULL, NULL}, &error), SKEIN_OK);
    assert_int_equal(mesh.vertex_count, 289);
    assert_int_equal(mesh.face_count, 512);
    assert_true(mesh.positions[3 * 288] == 1 && mesh.positions[3 * 288 + 2] == 1);
    assert_int_equal(mesh.face_vertices[3 * 511 + 2], 288);
    io_mesh_free(&mesh);
}

static void very_long_lines_are_read(void **state) {
    (void)state;
    // A polygon of 30,000 corners on one line, and a comment of a megabyte.
    char *text = malloc(2500000);
    assert_non_null(text);
    int at = sprintf(text, "# ");
    memset(text + at, 'x', 1000000);
    at += 1000000;
    text[at++] = '\n';
    for (int i = 0; i < 30000; i++) at += sprintf(text + at, "v %d 0 %d\n", i, i % 7);
    at += sprintf(text + at, "f");
    for (int i = 30000; i > 0; i--) at += sprintf(text + at, " %d", i);
    io_mesh mesh = read_text(text, false, NULL);
    assert_int_equal(mesh.face_count, 1);
    assert_int_equal(mesh.face_sizes[0], 30000);
    io_mesh_free(&mesh);

    // The same with a corner twice, far apart.
    sprintf(text + at, " 29999");
    skein_error error;
    assert_int_equal(io_obj_read(text, strlen(text), "text", &mesh, (io_warnings){NULL, NULL}, &error),
                     SKEIN_ERROR_SYNTAX);
    assert_string_equal(error.where, "text:30002");
    free(text);
}

/* Every file in tests/bad/meshes: its line (0: the file as a whole) and what is said. */
static const struct {
    const char *name;
    int line;
    const char *message;
} bad_meshes[] = {
    {"accessor_too_long.gltf", 0, "accessor 0 reaches beyond its view or buffer"},
    {"buffer_cut_off.gltf", 0, "buffer 0 has 36 bytes of the 40 that it promises: it is cut off"},
    {"buffer_elsewhere.gltf", 0,
     "the buffer '../../corpus/mesh/box.bin' is not read: put it into the folder of the file"},
    {"buffer_elsewhere_hidden.gltf", 0,
     "the buffer '%2e%2e%2fmeshes%2fx.bin' is not read: put it into the folder of the file"},
    {"chunk_cut_off.glb", 0, "the first chunk is no JSON, or is cut off"},
    {"coordinate_missing.stl", 4, "the line ends where z is expected"},
    {"coordinate_nan.ply", 11, "vertex 1 has a number that is not finite"},
    {"coordinate_nan.stl", 0, "triangle 1 of 1 has a coordinate that is not finite"},
    {"coordinate_word.ply", 11, "'a': expected a number of vertex 1"},
    {"cut_off.glb", 0, "the file has 22 of the 1000 bytes that its header promises: it is cut off"},
    {"cut_off.ply", 0, "the file ends in face 1 of 1: it is cut off, or its header is wrong"},
    {"cut_off.stl", 0, "the header promises 2 triangles, 184 bytes, but the file has 134: it is cut off, or no STL"},
    {"extension_needed.gltf", 0,
     "it needs the extension 'KHR_draco_mesh_compression', which is not read: save the mesh without (no compression)"},
    {"face_with_vertex_twice.ply", 13,
     "vertex 1 twice in one face: expected different corners (a hole must be cut open)"},
    {"faces_cut_off.ply", 0, "the file ends in face 1 of 1: it is cut off, or its header is wrong"},
    {"flat.stl", 0, "no triangles in the file but such with two corners at one place"},
    {"format_unknown.ply", 2, "'binary': expected the format ascii, binary_little_endian or binary_big_endian"},
    {"index_out_of_range.ply", 13, "face 0 has a corner that is no vertex"},
    {"no_end_of_header.ply", 5, "the header has no end: expected 'end_header'"},
    {"no_faces.ply", 7,
     "the header promises no faces (a list 'vertex_indices'): points alone, and strips of triangles, are not read"},
    {"no_mesh.gltf", 0, "no triangles in the file"},
    {"nodes_in_a_ring.gltf", 0, "node 0 is in the scene twice: nodes have to be a tree"},
    {"not_json.gltf", 1, "the JSON of the file: unexpected token near end of file"},
    {"points_only.gltf", 0, "no triangles in the file, only points or lines"},
    {"promises_too_much.ply", 0, "the file ends in vertex 4 of 4000000000: it is cut off, or its header is wrong"},
    {"short.stl", 0, "5 bytes are no STL file: expected 'solid', or at least 84 bytes"},
    {"text_cut_off.stl", 9, "the file ends after 1 triangles, without 'endsolid': it is cut off"},
    {"two_corners.ply", 0, "byte 214: face 0 has fewer than three corners, or one of them twice"},
    {"type_unknown.ply", 4, "'half': expected a type: char, uchar, short, ushort, int, uint, float or double"},
    {"version_1.gltf", 0, "glTF of version 1.0: expected glTF 2.0"},
    {"word_missing.stl", 3, "'vertex': expected 'outer'"},
    {"binary.obj", 1, "the line begins with '?PNG': the file is binary or damaged, expected OBJ text"},
    {"binary.off", 1, "binary OFF is not read: save the mesh as text"},
    {"coordinate_1e400.obj", 2, "x is '1e400': expected a finite number"},
    {"coordinate_decimal_comma.obj", 2, "x is '1,5': expected a number such as 0.5, -2 or 1e-3 (a point, not a comma)"},
    {"coordinate_minus_inf.obj", 1, "z is '-inf': expected a finite number"},
    {"coordinate_msvc_inf.obj", 2, "z is '1.#INF': expected a finite number"},
    {"coordinate_nan.obj", 2, "y is 'nan': expected a finite number"},
    {"coordinate_nan.off", 4, "y is 'NaN': expected a finite number"},
    {"coordinate_word.obj", 2, "y is 'zero': expected a number such as 0.5, -2 or 1e-3"},
    {"empty.obj", 0, "the file is empty: expected a mesh"},
    {"ending_unknown.3ds", 0, "not a mesh file by its ending: expected .obj, .off, .ply, .stl, .glb, .gltf or .node"},
    {"face_cut_off.obj", 6, "a face of 2 corners: expected 3 or more; the file ends here, is it cut off?"},
    {"face_cut_off.off", 8, "the line ends after 2 of a face's 3 corners; the file ends here, is it cut off?"},
    {"face_of_two_corners.obj", 6, "a face of 2 corners: expected 3 or more"},
    {"face_of_two_corners.off", 8, "a face of 2 corners: expected 3 or more"},
    {"face_with_bad_corner.obj", 5, "a face's corner is '1/1/1/1': expected one such as 7, 7/2, 7//3 or 7/2/3"},
    {"face_with_vertex_twice.obj", 5,
     "vertex 2 twice in one face: expected different corners (a hole must be cut open)"},
    {"face_with_vertex_twice.off", 8,
     "vertex 2 twice in one face: expected different corners (a hole must be cut open)"},
    {"faces_cut_off.off", 8, "the file ends after 1 of 2 faces: it is cut off, or its header is wrong"},
    {"four_coordinates.off", 1,
     "the file begins with '4OFF': expected OFF, COFF or NOFF, with three coordinates a vertex"},
    {"header_cut_off.off", 2, "the header is not complete: expected the numbers of vertices, faces and edges"},
    {"header_promises_more_vertices.off", 7, "vertex 4 of 5 has 4 numbers: expected 3; is the header's number right?"},
    {"header_without_numbers.off", 2, "the number of vertices is 'four': expected a whole number"},
    {"index_huge.obj", 5, "a face's corner is '99999999999999999999': a mesh has at most 4294967294 vertices"},
    {"index_negative.off", 8, "a face's corner is '-1': expected a whole number"},
    {"index_out_of_range.obj", 6, "vertex 5 in a face, but the file has 4 vertices"},
    {"index_out_of_range.off", 8, "vertex 4 in a face, but the file has 4 vertices, 0 to 3"},
    {"index_too_far_back.obj", 4, "vertex -4 in a face, but only 3 vertices come before it"},
    {"index_zero.obj", 5, "vertex 0 in a face: OBJ counts from 1, or back from -1"},
    {"no_faces.obj", 0, "no faces in the file: expected lines such as \"f 1 2 3\""},
    {"no_faces.off", 2, "no faces in the file: the header promises 4 vertices and 0 faces"},
    {"no_header.off", 1, "the file begins with '4': expected OFF"},
    {"no_vertices.obj", 0, "no vertices in the file: expected lines such as \"v 0 1 0\""},
    {"normals_missing.off", 3, "vertex 0 of 3 has 3 numbers: expected 6 or more"},
    {"nul_byte.obj", 6, "a NUL byte: the file is binary or damaged, expected text"},
    {"too_many_vertices.off", 2, "the number of vertices is '353535235358': at most 4294967294 are possible"},
    {"utf16.obj", 1, "the file is UTF-16 text: save it as UTF-8 (or plain ASCII)"},
    {"utf16_without_mark.obj", 1, "the file is UTF-16 text: save it as UTF-8 (or plain ASCII)"},
    {"vertex_cut_off.obj", 3,
     "a vertex of 2 numbers: expected x y z, perhaps with a weight or a colour; the file ends here, is it "
     "cut off?"},
    {"vertex_of_five_numbers.obj", 2, "a vertex of 5 numbers: expected x y z, perhaps with a weight or a colour"},
    {"vertex_of_two_numbers.obj", 2, "a vertex of 2 numbers: expected x y z, perhaps with a weight or a colour"},
    {"vertices_cut_off.off", 5, "the file ends after 2 of 4 vertices: it is cut off, or its header is wrong"},
};

static void bad_meshes_are_refused_by_file_and_line(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT(bad_meshes); i++) {
        char path[1024], place[100];
        snprintf(path, sizeof path, SKEIN_SOURCE_DIR "/tests/bad/meshes/%s", bad_meshes[i].name);
        int length = snprintf(place, sizeof place, "/meshes/%s:%d", bad_meshes[i].name, bad_meshes[i].line);
        if (bad_meshes[i].line == 0) place[length -= 2] = '\0';
        io_mesh mesh;
        skein_error error = {SKEIN_OK, "", ""};
        skein_status status = io_mesh_read(path, &mesh, (io_warnings){NULL, NULL}, &error);
        assert_int_not_equal(status, SKEIN_OK);
        assert_int_equal(status, error.status);
        assert_string_equal(error.where + strlen(error.where) - length, place);
        assert_string_equal(error.message, bad_meshes[i].message);
        assert_null(mesh.positions);
        assert_int_equal(io_mesh_read(path, &mesh, (io_warnings){NULL, NULL}, NULL), status);
    }
    DIR *bad = opendir(SKEIN_SOURCE_DIR "/tests/bad/meshes");
    assert_non_null(bad);
    size_t count = 0;
    for (struct dirent *entry; (entry = readdir(bad)) != NULL;) count += entry->d_name[0] != '.';
    closedir(bad);
    assert_int_equal(count, COUNT(bad_meshes));
}

/* ---- Normals ------------------------------------------------------------------------------- */

static void expect_normal(const double *normal, double x, double y, double z) {
    double length = sqrt(x * x + y * y + z * z);
    assert_true(fabs(normal[0] - x / length) < 1e-14);
    assert_true(fabs(normal[1] - y / length) < 1e-14);
    assert_true(fabs(normal[2] - z / length) < 1e-14);
}

static void flat_meshes_have_exact_normals(void **state) {
    (void)state;
    char *text = grid_text(13);
    io_mesh mesh = read_text(text, false, NULL);
    free(text);
    skein_mesh view = io_mesh_view(&mesh);
    double *normals = malloc(3 * mesh.vertex_count * sizeof *normals);
    assert_non_null(normals);
    for (int turned = 0; turned < 2; turned++) {
        // An odd height and scale; then the faces the other way round.
        for (size_t v = 0; v < mesh.vertex_count; v++) {
            mesh.positions[3 * v] *= turned ? 1 : 0.37;
            mesh.positions[3 * v + 1] = 0.1;
        }
        for (size_t f = 0; f < mesh.face_count && turned; f++) {
            uint32_t first = mesh.face_vertices[3 * f];
            mesh.face_vertices[3 * f] = mesh.face_vertices[3 * f + 1];
            mesh.face_vertices[3 * f + 1] = first;
        }
        for (int mode = 0; mode < 3; mode++) {
            assert_int_equal(skein_mesh_normals(&view, (skein_normals)mode, normals, NULL), SKEIN_OK);
            for (size_t v = 0; v < mesh.vertex_count; v++) {
                double expected[3] = {0, turned ? -1 : 1, 0};
                assert_memory_equal(normals + 3 * v, expected, sizeof expected); // no -0 either
            }
        }
    }
    free(normals);
    io_mesh_free(&mesh);
}

/* A 1 x 2 x 3 box of quads, or with every quad cut: its corner at the origin has 2, 1 and 1 triangles. */
#define BOX "v 0 0 0\nv 1 0 0\nv 1 2 0\nv 0 2 0\nv 0 0 3\nv 1 0 3\nv 1 2 3\nv 0 2 3\n"
#define BOX_QUADS "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 4 8 7 3\nf 1 5 8 4\nf 2 3 7 6\n"
#define BOX_CUT                                                                                             \
    "f 1 4 3\nf 1 3 2\nf 5 6 7\nf 5 7 8\nf 1 2 5\nf 2 6 5\nf 4 8 7\nf 4 7 3\nf 1 5 4\nf 5 8 4\nf 2 3 7\nf " \
    "2 7 6\n"

static void a_box_has_the_normals_of_the_formulas(void **state) {
    (void)state;
    double normals[24];
    io_mesh mesh = read_text(BOX BOX_QUADS, false, NULL);
    skein_mesh view = io_mesh_view(&mesh);
    // The corner at the origin sees areas 6 (x), 3 (y) and 2 (z): 6^2 + 3^2 + 2^2 = 7^2.
    assert_int_equal(skein_mesh_normals(&view, SKEIN_NORMALS_AREA, normals, NULL), SKEIN_OK);
    expect_normal(normals, -6.0 / 7, -3.0 / 7, -2.0 / 7);
    expect_normal(normals + 18, 6.0 / 7, 3.0 / 7, 2.0 / 7);
    assert_int_equal(skein_mesh_normals(&view, SKEIN_NORMALS_UNIFORM, normals, NULL), SKEIN_OK);
    expect_normal(normals, -1, -1, -1);
    assert_int_equal(skein_mesh_normals(&view, SKEIN_NORMALS_ANGLE, normals, NULL), SKEIN_OK);
    expect_normal(normals, -1, -1, -1);
    io_mesh_free(&mesh);

    mesh = read_text(BOX BOX_CUT, false, NULL);
    view = io_mesh_view(&mesh);
    assert_int_equal(skein_mesh_normals(&view, SKEIN_NORMALS_AREA, normals, NULL), SKEIN_OK);
    expect_normal(normals, -3, -1.5, -2); // half of x and y, all of z
    assert_int_equal(skein_mesh_normals(&view, SKEIN_NORMALS_UNIFORM, normals, NULL), SKEIN_OK);
    expect_normal(normals, -1, -1, -2);
    assert_int_equal(skein_mesh_normals(&view, SKEIN_NORMALS_ANGLE, normals, NULL), SKEIN_OK);
    for (int v = 0; v < 8; v++)
        expect_normal(normals + 3 * v, v == 1 || v == 2 || v == 5 || v == 6 ? 1 : -1,
                      v == 2 || v == 3 || v == 6 || v == 7 ? 1 : -1, v >= 4 ? 1 : -1);
    io_mesh_free(&mesh);
}

static void odd_faces_do_no_harm(void **state) {
    (void)state;
    double normals[27];
    // An L with a reflex corner at vertex 4, bent up nowhere; 7 lies on no face; 8 and 9 only on one without
    // area.
    io_mesh mesh = read_text("v 0 0 0\nv 0 0 2\nv 1 0 2\nv 1 0 1\nv 2 0 1\nv 2 0 0\nv 5 5 5\nv 1 0 0\nv 3 0 0\n"
                             "f 1 2 3 4 5 6\nf 1 8 9\n",
                             false, NULL);
    skein_mesh view = io_mesh_view(&mesh);
    for (int mode = 0; mode < 3; mode++) {
        assert_int_equal(skein_mesh_normals(&view, (skein_normals)mode, normals, NULL), SKEIN_OK);
        for (int v = 0; v < 9; v++) expect_normal(normals + 3 * v, 0, 1, 0);
    }
    io_mesh_free(&mesh);

    // Two faces on a reflex corner of 270 degrees and a wall of 90: the angle's weights are 3 and 1.
    mesh = read_text("v 0 0 0\nv 0 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nv -1 0 0\nv 0 1 0\n"
                     "f 1 2 3 4 5 6\nf 1 2 7\n",
                     false, NULL);
    view = io_mesh_view(&mesh);
    assert_int_equal(skein_mesh_normals(&view, SKEIN_NORMALS_ANGLE, normals, NULL), SKEIN_OK);
    expect_normal(normals, -1, 3, 0);
    io_mesh_free(&mesh);
}

/* ---- Meshes out ---------------------------------------------------------------------------- */

static void obj_is_written_as_promised(void **state) {
    (void)state;
    static const double positions[] = {0, 0.1, 0, 1, 0.1, 0, 1, 0.1, 1, -0.0, 0.1, 1, 1e-9, 1e9, -2.5};
    static const uint32_t sizes[] = {4, 3}, corners[] = {3, 2, 1, 0, 0, 3, 1};
    skein_mesh mesh = {positions, 5, sizes, 2, corners, 7};
    skein_error error;
    assert_int_equal(io_obj_write(in_folder("out.obj"), &mesh, SKEIN_NORMALS_AREA, &error), SKEIN_OK);
    io_bytes bytes = read_all(in_folder("out.obj"));
    assert_string_equal(bytes.data, "# Skein " SKEIN_VERSION ": metres, y up; 5 vertices, 2 faces\n"
                                    "v 0 0.100000001 0\nv 1 0.100000001 0\nv 1 0.100000001 1\n"
                                    "v 0 0.100000001 1\nv 9.99999972e-10 1e+09 -2.5\n"
                                    "vn 0 1 0\nvn 0 1 0\nvn 0 1 0\nvn 0 1 0\nvn 0 1 0\n"
                                    "f 4//4 3//3 2//2 1//1\nf 1//1 4//4 2//2\n");
    io_bytes_free(&bytes);

    double broken[15];
    memcpy(broken, positions, sizeof broken);
    broken[4] = 1e300;
    mesh.positions = broken;
    assert_int_equal(io_obj_write(in_folder("out.obj"), &mesh, SKEIN_NORMALS_AREA, &error), SKEIN_ERROR_VALUE);
    assert_string_equal(error.message, "not written: vertex 1 is at (1, 1e+300, 0), which is not finite as a float "
                                       "(has the motion blown up?)");
    assert_int_equal(count_files(".part"), 0);
}

static void obj_round_trip_keeps_all(void **state) {
    (void)state;
    // Positions with all 24 bits in use, faces of every size, vertices that no face uses.
    enum { VERTICES = 1000, FACES = 600 };
    uint64_t seed = 1;
    io_mesh mesh = {0};
    for (int v = 0; v < VERTICES; v++) {
        double position[3];
        for (int k = 0; k < 3; k++)
            position[k] = (double)((float)(int64_t)next_random(&seed) * ldexpf(1, -60 - (int)(seed % 40)));
        assert_true(io_mesh_add_vertex(&mesh, position));
    }
    for (uint32_t f = 0; f < FACES; f++) {
        for (uint32_t corner = 0; corner < 3 + f % 5; corner++)
            assert_true(io_mesh_add_corner(&mesh, (f * 7 + corner * 11) % VERTICES, IO_NO_UV));
        assert_true(io_mesh_add_face(&mesh, 3 + f % 5));
    }
    skein_mesh view = io_mesh_view(&mesh);
    assert_int_equal(io_obj_write(in_folder("trip.obj"), &view, SKEIN_NORMALS_ANGLE, NULL), SKEIN_OK);
    io_mesh back;
    assert_int_equal(io_mesh_read(in_folder("trip.obj"), &back, (io_warnings){NULL, NULL}, NULL), SKEIN_OK);
    expect_mesh(&back, VERTICES, NULL, FACES, mesh.face_sizes, mesh.face_vertices);
    for (size_t i = 0; i < 3 * VERTICES; i++) assert_true((float)back.positions[i] == (float)mesh.positions[i]);
    io_mesh_free(&back);
    io_mesh_free(&mesh);
}

/* ---- Point caches -------------------------------------------------------------------------- */

static void pc2_has_the_bytes_of_the_format(void **state) {
    (void)state;
    static const double frames[2][6] = {{0, 1, -2, 0.5, 0, 0}, {1, 1, 1, 2, 2, 2}};
    static const char expected[] = "POINTCACHE2\0"    // and its zero
                                   "\1\0\0\0\2\0\0\0" // version 1, 2 points
                                   "\0\0\x80\x3F"     // first frame 1
                                   "\0\0\0\x40"       // a sample each 2 frames
                                   "\2\0\0\0"         // 2 samples
                                   "\0\0\0\0\0\0\x80\x3F\0\0\0\xC0"
                                   "\0\0\0\x3F\0\0\0\0\0\0\0\0"
                                   "\0\0\x80\x3F\0\0\x80\x3F\0\0\x80\x3F"
                                   "\0\0\0\x40\0\0\0\x40\0\0\0\x40";
    skein_error error;
    for (int known = 0; known < 2; known++) {
        io_pc2_header header = {2, 1, 2, known ? 2 : IO_PC2_UNKNOWN};
        io_pc2_writer *writer = io_pc2_create(in_folder("run.pc2"), header, &error);
        assert_non_null(writer);
        for (int frame = 0; frame < 2; frame++) assert_int_equal(io_pc2_add(writer, frames[frame], &error), SKEIN_OK);
        assert_int_equal(io_pc2_commit(writer, &error), SKEIN_OK);
        io_bytes bytes = read_all(in_folder("run.pc2"));
        assert_int_equal(bytes.size, sizeof expected - 1);
        assert_memory_equal(bytes.data, expected, sizeof expected - 1);
        io_bytes_free(&bytes);
    }
    io_pc2_header header;
    io_pc2_reader *reader = io_pc2_open(in_folder("run.pc2"), &header, &error);
    assert_non_null(reader);
    assert_int_equal(header.points, 2);
    assert_int_equal(header.samples, 2);
    assert_true(header.start == 1 && header.rate == 2);
    for (uint32_t frame = 2; frame-- > 0;) {
        double positions[6];
        assert_int_equal(io_pc2_read(reader, frame, positions, &error), SKEIN_OK);
        for (int i = 0; i < 6; i++) assert_true(positions[i] == frames[frame][i]);
    }
    assert_int_equal(io_pc2_read(reader, 2, (double[6]){0}, &error), SKEIN_ERROR_VALUE);
    io_pc2_close(reader);
}

static void pc2_faults_are_named(void **state) {
    (void)state;
    skein_error error;
    char path[128];
    snprintf(path, sizeof path, "%s", in_folder("bad.pc2"));
    assert_null(io_pc2_create(path, (io_pc2_header){0, 0, 1, 1}, &error));
    assert_null(io_pc2_create(path, (io_pc2_header){1, 0, 0, 1}, &error));
    io_pc2_writer *writer = io_pc2_create(path, (io_pc2_header){1, 0, 1, 3}, &error);
    assert_int_equal(io_pc2_add(writer, (double[3]){0, 0, 0}, &error), SKEIN_OK);
    assert_int_equal(io_pc2_commit(writer, &error), SKEIN_ERROR_VALUE);
    assert_string_equal(error.message, "3 samples were promised, 1 were added");
    assert_int_equal(count_files("bad.pc2") + count_files(".part"), 0);

    io_pc2_header header;
    assert_null(io_pc2_open(path, &header, &error));
    assert_int_equal(error.status, SKEIN_ERROR_FILE);
    write_text(path, "POINTCACHE2");
    assert_null(io_pc2_open(path, &header, &error));
    assert_string_equal(error.message, "not a PC2 file: expected POINTCACHE2");

    // More than a block of points; then a byte cut off.
    enum { POINTS = 10000 };
    double *positions = malloc(3 * POINTS * sizeof *positions);
    assert_non_null(positions);
    for (int i = 0; i < 3 * POINTS; i++) positions[i] = i;
    writer = io_pc2_create(path, (io_pc2_header){POINTS, 0, 1, IO_PC2_UNKNOWN}, &error);
    for (int frame = 0; frame < 3; frame++) assert_int_equal(io_pc2_add(writer, positions, &error), SKEIN_OK);
    assert_int_equal(io_pc2_commit(writer, &error), SKEIN_OK);
    io_pc2_reader *reader = io_pc2_open(path, &header, &error);
    assert_non_null(reader);
    memset(positions, 0, 3 * POINTS * sizeof *positions);
    assert_int_equal(io_pc2_read(reader, 2, positions, &error), SKEIN_OK);
    for (int i = 0; i < 3 * POINTS; i++) assert_true(positions[i] == i);
    io_pc2_close(reader);
    free(positions);
    assert_int_equal(truncate(path, 32 + 3 * POINTS * 12 - 1), 0);
    assert_null(io_pc2_open(path, &header, &error));
    assert_string_equal(error.message, "the header counts 3 samples, the file holds 2 and a part of one: it is cut off");
}

/* ---- A full disk --------------------------------------------------------------------------- */

static void a_full_device_is_an_error(void **state) {
    (void)state;
    static const double positions[] = {0, 0, 0, 1, 0, 0, 0, 0, 1};
    static const uint32_t sizes[] = {3}, corners[] = {0, 1, 2};
    skein_mesh mesh = {positions, 3, sizes, 1, corners, 3};
    skein_error error;
    assert_int_equal(io_obj_write("/dev/full", &mesh, SKEIN_NORMALS_AREA, &error), SKEIN_ERROR_FILE);
    assert_string_equal(error.where, "/dev/full");
    assert_string_equal(error.message, "cannot write: the disk is full");
    assert_int_equal(io_obj_write("/dev/null", &mesh, SKEIN_NORMALS_AREA, &error), SKEIN_OK);
    struct stat info;
    assert_int_equal(stat("/dev/null", &info), 0);
    assert_true(S_ISCHR(info.st_mode));
}

static void a_limit_leaves_nothing_half_written(void **state) {
    (void)state;
    char *text = grid_text(60);
    io_mesh mesh = read_text(text, false, NULL);
    free(text);
    skein_mesh view = io_mesh_view(&mesh);
    char old_path[128], new_path[128];
    snprintf(old_path, sizeof old_path, "%s", in_folder("limit_old.obj"));
    snprintf(new_path, sizeof new_path, "%s", in_folder("limit_new.pc2"));
    write_text(old_path, "old");

    struct rlimit before, low;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    low = before;
    low.rlim_cur = 100000;
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &low), 0);
    skein_error error, pc2_error;
    skein_status status = io_obj_write(old_path, &view, SKEIN_NORMALS_AREA, &error);
    io_pc2_writer *writer =
        io_pc2_create(new_path, (io_pc2_header){(uint32_t)mesh.vertex_count, 0, 1, IO_PC2_UNKNOWN}, &pc2_error);
    skein_status add_status = SKEIN_OK, commit_status = SKEIN_OK;
    for (int frame = 0; frame < 20 && add_status == SKEIN_OK && writer; frame++)
        add_status = io_pc2_add(writer, mesh.positions, &pc2_error);
    if (writer) commit_status = io_pc2_commit(writer, &pc2_error);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);

    assert_int_equal(status, SKEIN_ERROR_FILE);
    assert_string_equal(error.message, "cannot write: it grew over the limit for a file's size");
    assert_non_null(writer);
    assert_int_equal(add_status, SKEIN_ERROR_FILE);
    assert_int_equal(commit_status, SKEIN_ERROR_FILE);
    assert_string_equal(pc2_error.message, error.message);
    assert_int_equal(count_files(".part") + count_files("limit_new"), 0);
    io_bytes bytes = read_all(old_path);
    assert_string_equal(bytes.data, "old");
    io_bytes_free(&bytes);
    io_mesh_free(&mesh);
}

/* ---- Exporters ----------------------------------------------------------------------------- */

static void ignore_line(void *user, const char *line) {
    snprintf(user, 300, "%s", line);
}

/* What an OBJ says of its faces is written as it was read; and a fault in a face says whose it is. */
static void obj_keeps_what_is_said_of_faces(void **state) {
    (void)state;
    static const char source[] = "mtllib my  paints.mtl\n"
                                 "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0.5\n"
                                 "vt 0 0\nvt 1 0.25\nvt 1 1 0\nvt 0 1e300\n"
                                 "o left half # the first\ng a b\nusemtl red\ns 1\n"
                                 "f 1/1 2/2 3/3 4/4\n"
                                 "o right\nusemtl blue\ns off\n"
                                 "f 2 5 3//\n";
    char warning[300] = "", ought[1000], resolved[PATH_MAX];
    io_mesh mesh, again;
    skein_error error = {SKEIN_OK, "", ""};
    write_text(in_folder("said.obj"), source);
    assert_int_equal(io_mesh_read(in_folder("said.obj"), &mesh, (io_warnings){ignore_line, warning}, &error), SKEIN_OK);
    assert_non_null(strstr(warning, "its 2 objects become one body; save each as a file of its own"));
    skein_mesh view = io_mesh_view(&mesh);
    assert_true(io_mesh_has_faces_of(&mesh, &view));
    assert_int_equal(
        io_obj_write_as(in_folder("kept.obj"), &view, SKEIN_NORMALS_AREA, &mesh, in_folder("said.obj"), &error),
        SKEIN_OK);
    io_bytes bytes = read_all(in_folder("kept.obj"));
    snprintf(ought, sizeof ought,
             "vt 0 0\nvt 1 0.25\nvt 1 1\nvt 0 0\n"
             "mtllib %s/my paints.mtl\no left half\ng a b\nusemtl red\ns 1\n"
             "f 1/1/1 2/2/2 3/3/3 4/4/4\n"
             "o right\nusemtl blue\ns off\n"
             "f 2//2 5//5 3//3\n",
             realpath(folder, resolved));
    assert_string_equal(bytes.data + bytes.size - strlen(ought), ought);
    io_bytes_free(&bytes);
    // and read again it is the same
    assert_int_equal(io_mesh_read(in_folder("kept.obj"), &again, (io_warnings){NULL, NULL}, &error), SKEIN_OK);
    assert_true(io_mesh_has_faces_of(&again, &view) && again.mark_count == mesh.mark_count);
    assert_memory_equal(again.face_uvs, mesh.face_uvs, mesh.face_vertex_count * sizeof *mesh.face_uvs);
    mesh.face_vertices[0] = 4; // another mesh
    assert_false(io_mesh_has_faces_of(&again, &view));
    io_mesh_free(&again);
    io_mesh_free(&mesh);

    static const char bad[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\no hat\nf 1 2 3\no cape\nf 1 2 9\nf 3 3 1\n";
    assert_int_equal(io_obj_read(bad, sizeof bad - 1, "b.obj", &mesh, (io_warnings){NULL, NULL}, &error),
                     SKEIN_ERROR_SYNTAX);
    assert_string_equal(error.where, "b.obj:8");
    assert_non_null(strstr(error.message, "; it belongs to the object 'cape': mend or delete the face there"));
}

static void exporters_describe_their_fields(void **state) {
    (void)state;
    static const char *const names[] = {"obj", "pc2", "mdd", "glb", "usda", "ply", "stl", "csv", "hdf5", NULL};
    for (size_t i = 0; names[i]; i++) assert_string_equal(io_exporter_at(i)->name, names[i]);
    assert_null(io_exporter_at(COUNT(names) - 1));
    const skein_kind *obj = io_exporter_at(0);
    for (size_t i = 0; io_exporter_at(i); i++) {
        const skein_kind *kind = io_exporter_at(i);
        assert_int_equal(kind->category, SKEIN_EXPORTER);
        for (size_t f = 0; f < kind->field_count; f++) {
            const skein_field *field = &kind->fields[f];
            assert_true(field->offset + sizeof(int32_t) <= kind->params_size);
            assert_true(field->initial[0] >= field->least && field->initial[0] <= field->most);
            assert_non_null(field->unit);
            assert_non_null(field->help);
        }
    }
    assert_string_equal(obj->fields[0].choices, "area|uniform|angle");
    assert_int_equal(SKEIN_NORMALS_ANGLE, 2);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(file_faults_are_named),
        cmocka_unit_test(a_file_that_may_not_be_read_is_told),
        cmocka_unit_test(long_paths_keep_their_end),
        cmocka_unit_test(output_appears_at_the_commit),
        cmocka_unit_test(large_output_is_whole),
        cmocka_unit_test(numbers_are_read_exactly),
        cmocka_unit_test(numbers_agree_with_the_c_library),
        cmocka_unit_test(floats_are_printed_plainly),
        cmocka_unit_test(every_way_to_write_a_square_is_read),
        cmocka_unit_test(off_is_read),
        cmocka_unit_test(polygons_and_texture_places_are_kept),
        cmocka_unit_test(the_grid_has_its_counts),
        cmocka_unit_test(very_long_lines_are_read),
        cmocka_unit_test(bad_meshes_are_refused_by_file_and_line),
        cmocka_unit_test(flat_meshes_have_exact_normals),
        cmocka_unit_test(a_box_has_the_normals_of_the_formulas),
        cmocka_unit_test(odd_faces_do_no_harm),
        cmocka_unit_test(obj_is_written_as_promised),
        cmocka_unit_test(obj_round_trip_keeps_all),
        cmocka_unit_test(pc2_has_the_bytes_of_the_format),
        cmocka_unit_test(pc2_faults_are_named),
        cmocka_unit_test(a_full_device_is_an_error),
        cmocka_unit_test(a_limit_leaves_nothing_half_written),
        cmocka_unit_test(obj_keeps_what_is_said_of_faces),
        cmocka_unit_test(exporters_describe_their_fields),
    };
    return cmocka_run_group_tests_name("mesh io", tests, make_folder, remove_folder);
}
