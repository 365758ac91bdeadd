/* Tests of clips (io/clip.h), the files of a run for other programs: what a run writes is read back by small readers of
 * our own here, which know the formats from their descriptions and share no code with the writers. */
#include "test_command.h"

#include <math.h>

#include <skein/cut.h>

#include "io/clip.h"
#include "io/uncut.h"

/* ---- Small readers -------------------------------------------------------------------------------------- */

/* All samples of a point cache. */
typedef struct samples {
    uint32_t count, points;
    double *times; /* count, where the format has them */
    float *places; /* count x points x 3 */
} samples;

static void samples_free(samples *s) {
    free(s->times);
    free(s->places);
}

static io_bytes read_bytes(const char *path) {
    io_bytes bytes;
    skein_error error = {SKEIN_OK, "", ""};
    if (io_file_read(path, (size_t)1 << 30, &bytes, &error)) fail_msg("%s: %s", error.where, error.message);
    return bytes;
}

static uint32_t big(const char *at) {
    const unsigned char *b = (const unsigned char *)at;
    return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
}

static float big_float(const char *at) {
    uint32_t bits = big(at);
    float value;
    memcpy(&value, &bits, 4);
    return value;
}

static samples read_mdd(const char *path) {
    io_bytes bytes = read_bytes(path);
    assert_true(bytes.size >= 8);
    samples s = {big(bytes.data), big(bytes.data + 4), NULL, NULL};
    assert_int_equal(bytes.size, 8 + 4 * (size_t)s.count + 12 * (size_t)s.count * s.points);
    s.times = malloc(s.count * sizeof *s.times);
    s.places = malloc(3 * (size_t)s.count * s.points * sizeof *s.places);
    for (uint32_t i = 0; i < s.count; i++) s.times[i] = big_float(bytes.data + 8 + 4 * i);
    for (size_t i = 0; i < 3 * (size_t)s.count * s.points; i++)
        s.places[i] = big_float(bytes.data + 8 + 4 * (size_t)s.count + 4 * i);
    io_bytes_free(&bytes);
    return s;
}

static samples read_pc2(const char *path) {
    io_bytes bytes = read_bytes(path);
    samples s = {0, 0, NULL, NULL};
    memcpy(&s.points, bytes.data + 16, 4); // these machines are little endian
    memcpy(&s.count, bytes.data + 28, 4);
    assert_int_equal(bytes.size, 32 + 12 * (size_t)s.count * s.points);
    s.places = malloc(bytes.size - 32);
    memcpy(s.places, bytes.data + 32, bytes.size - 32);
    io_bytes_free(&bytes);
    return s;
}

/* A GLB: its JSON, and its numbers. */
typedef struct glb {
    json_t *root;
    io_bytes bytes;
    const char *numbers;
} glb;

static uint32_t little(const char *at) {
    const unsigned char *b = (const unsigned char *)at;
    return (uint32_t)b[3] << 24 | (uint32_t)b[2] << 16 | (uint32_t)b[1] << 8 | b[0];
}

static glb read_glb(const char *path) {
    glb g = {NULL, read_bytes(path), NULL};
    const char *data = g.bytes.data;
    assert_true(g.bytes.size > 28 && !memcmp(data, "glTF", 4) && little(data + 4) == 2);
    assert_int_equal(little(data + 8), g.bytes.size);
    uint32_t length = little(data + 12);
    assert_true(length % 4 == 0 && !memcmp(data + 16, "JSON", 4));
    g.root = json_loadb(data + 20, length, JSON_REJECT_DUPLICATES, NULL);
    assert_non_null(g.root);
    assert_memory_equal(data + 20 + length + 4, "BIN", 4);
    assert_int_equal(little(data + 20 + length), g.bytes.size - length - 28);
    g.numbers = data + 28 + length;
    return g;
}

static void glb_free(glb *g) {
    json_decref(g->root);
    io_bytes_free(&g->bytes);
}

static json_int_t whole(const json_t *object, const char *key) {
    return json_integer_value(json_object_get(object, key));
}

/* The numbers of an accessor: floats, or whole numbers as floats. To be freed. */
static float *read_accessor(const glb *g, json_int_t place, size_t width, size_t *count) {
    const json_t *a = json_array_get(json_object_get(g->root, "accessors"), (size_t)place);
    const json_t *view = json_array_get(json_object_get(g->root, "bufferViews"), (size_t)whole(a, "bufferView"));
    const char *type = json_string_value(json_object_get(a, "type"));
    assert_string_equal(type, width == 1 ? "SCALAR" : width == 2 ? "VEC2" : "VEC3");
    *count = (size_t)whole(a, "count");
    size_t size = 4 * width * *count, offset = (size_t)whole(a, "byteOffset");
    assert_true(offset + size <= (size_t)whole(view, "byteLength"));
    assert_true(!json_object_get(view, "byteStride") || whole(view, "byteStride") == (json_int_t)(4 * width));
    const char *from = g->numbers + whole(view, "byteOffset") + offset;
    float *out = malloc(size);
    memcpy(out, from, size); // these machines are little endian
    const json_t *least = json_object_get(a, "min"), *most = json_object_get(a, "max");
    for (size_t i = 0; i < width * *count; i++) {
        if (whole(a, "componentType") == 5125) out[i] = (float)little(from + 4 * i);
        if (!least) continue;
        assert_true((double)out[i] >= json_number_value(json_array_get(least, i % width)));
        assert_true((double)out[i] <= json_number_value(json_array_get(most, i % width)));
    }
    return out;
}

/* ---- Point caches and sequences ------------------------------------------------------------------------- */

static void all_formats_hold_the_same_motion(void **state) {
    (void)state;
    const char *s = tiny_scene();
    char path[64];
    outcome o = SKEIN("run", s, "--out", in_folder("out"), "--fps", "24", "--set",
                      "output=[\"pc2\", {\"type\": \"mdd\", \"every\": 2}, {\"type\": \"obj\", \"every\": 2}]");
    assert_status(o, 0);
    assert_contains(o.out, "/out/sheet_0002.obj\n");
    outcome_free(&o);
    samples all = read_pc2(in_folder("out/sheet.pc2")), some = read_mdd(in_folder("out/sheet.mdd"));
    assert_int_equal(all.points, 25);
    assert_int_equal(all.count, 5);
    assert_int_equal(some.points, 25);
    assert_int_equal(some.count, 3);
    size_t sample = 3 * 25;
    assert_true(all.places[sample * 4 + 37] < all.places[37]); // it fell in between
    for (uint32_t i = 0; i < 3; i++) {
        assert_float_equal(some.times[i], 2 * i / 24.0, 1e-8);
        assert_memory_equal(some.places + i * sample, all.places + 2 * i * sample, sample * sizeof(float));
        snprintf(path, sizeof path, "out/sheet_%04u.obj", 2 * i);
        io_mesh mesh;
        assert_int_equal(io_mesh_read(in_folder(path), &mesh, (io_warnings){NULL, NULL}, NULL), SKEIN_OK);
        for (size_t k = 0; k < sample; k++) assert_true((float)mesh.positions[k] == all.places[2 * i * sample + k]);
        io_mesh_free(&mesh);
    }
    assert_false(exists(in_folder("out/sheet.obj")) || exists(in_folder("out/sheet_0001.obj")));
    samples_free(&all);
    samples_free(&some);
}

static void a_file_can_be_asked_for_alone(void **state) {
    (void)state;
    const char *s = tiny_scene();
    outcome o = SKEIN("run", s, "--out", in_folder("some/cape.MDD"), "--set",
                      "bodies=[{\"type\": \"cloth\", \"grid\": [3, 3]}]", "--set", "output.0.every=4");
    assert_status(o, 0);
    outcome_free(&o);
    assert_int_equal(count_entries(in_folder("some")), 1);
    samples one = read_mdd(in_folder("some/cape.mdd"));
    assert_int_equal(one.count, 2);
    samples_free(&one);
    // of two bodies each has its own; a folder of such a name stays a folder
    o = SKEIN("run", s, "--out", in_folder("two.mdd"));
    assert_status(o, 0);
    outcome_free(&o);
    assert_true(exists(in_folder("two-sheet.mdd")) && exists(in_folder("two-cloth.mdd")));
    assert_int_equal(mkdir(in_folder("folder.mdd"), 0777), 0);
    o = SKEIN("run", s, "--out", in_folder("folder.mdd"));
    assert_status(o, 0);
    outcome_free(&o);
    assert_true(exists(in_folder("folder.mdd/sheet.pc2")) && exists(in_folder("folder.mdd/report.json")));
}

static void axes_and_units_change_in_every_format(void **state) {
    (void)state;
    const char *s = tiny_scene();
    static const char outputs[] = "output=[\"pc2\", \"mdd\", \"obj\"]";
    hash_of(SKEIN("run", s, "--out", in_folder("y"), "--set", outputs));
    hash_of(SKEIN("run", s, "--out", in_folder("z"), "--set", outputs, "--up", "z", "--scale", "100"));
    samples y = read_pc2(in_folder("y/sheet.pc2")), z = read_pc2(in_folder("z/sheet.pc2")),
            m = read_mdd(in_folder("z/sheet.mdd"));
    assert_int_equal(y.count, z.count);
    assert_true(y.places[1] != y.places[2]);
    for (size_t i = 0; i < (size_t)y.count * y.points; i++) {
        const float *a = y.places + 3 * i, *b = z.places + 3 * i;
        double placed[3] = {100 * (double)a[0], -100 * (double)a[2], 100 * (double)a[1]};
        for (int k = 0; k < 3; k++) assert_float_equal(b[k], placed[k], 1e-5 * (fabs(placed[k]) + 1e-3));
    }
    assert_memory_equal(m.places, z.places, 3 * (size_t)z.count * z.points * sizeof(float));
    io_mesh mesh;
    assert_int_equal(io_mesh_read(in_folder("z/sheet.obj"), &mesh, (io_warnings){NULL, NULL}, NULL), SKEIN_OK);
    const float *last = z.places + 3 * (size_t)(z.count - 1) * z.points;
    for (size_t k = 0; k < 3 * (size_t)z.points; k++) assert_true((float)mesh.positions[k] == last[k]);
    char *text = read_text(in_folder("z/sheet.obj"));
    assert_contains(text, ": a metre is 100, z up; ");
    free(text);
    io_mesh_free(&mesh);
    samples_free(&y);
    samples_free(&z);
    samples_free(&m);

    assert_says(2, "", "skein run: --up x: expected y or z\n", "run", s, "--out", in_folder("x"), "--up", "x");
    assert_says(2, "", "skein run: --scale 0: 0 is out of range: expected from 1e-06 to 1e+06 1/m\n", "run", s, "--out",
                in_folder("x"), "--scale", "0");
    assert_says(2, "", "skein run: --up z: none of the scene's outputs has it (a glTF file is y up, always)\n", "run",
                s, "--out", in_folder("x"), "--up", "z", "--set", "output=[\"csv\"]");
    assert_false(exists(in_folder("x")));
}

enum { STRIP_VERTICES = 6, STRIP_FACES = 2 };

/* Two squares with a wave in them; as far as `frame`. */
static void strip_places(int frame, double *places) {
    for (int i = 0; i < STRIP_VERTICES; i++) {
        places[3 * i] = i / 2;
        places[3 * i + 1] = sin(0.5 * frame + i / 2);
        places[3 * i + 2] = i % 2;
    }
}

static io_clip strip(const double *places, uint32_t count, const io_clip_params *params) {
    static const uint32_t sizes[] = {4, 4}, corners[] = {0, 1, 3, 2, 2, 3, 5, 4};
    return (io_clip){.name = "strip",
                     .mesh = {places, STRIP_VERTICES, sizes, STRIP_FACES, corners, 8},
                     .fps = 30,
                     .samples = count,
                     .read_path = "",
                     .params = params};
}

static const io_clip_params plain_params = {.every = 1, .scale = 1};

/* ---- glTF --------------------------------------------------------------------------------------------------- */

static const json_t *primitive_of(const glb *g) {
    const json_t *meshes = json_object_get(g->root, "meshes");
    assert_int_equal(json_array_size(meshes), 1);
    return json_array_get(json_object_get(json_array_get(meshes, 0), "primitives"), 0);
}

/* Targets are the ways from the first frame; each has all the weight at its time. */
static void a_glb_moves_as_the_point_cache_does(void **state) {
    (void)state;
    const char *s = tiny_scene();
    hash_of(SKEIN("run", s, "--out", in_folder("out"), "--fps", "24", "--set", "output=[\"pc2\", \"glb\"]"));
    samples all = read_pc2(in_folder("out/sheet.pc2"));
    glb g = read_glb(in_folder("out/sheet.glb"));
    const json_t *primitive = primitive_of(&g), *targets = json_object_get(primitive, "targets");
    const json_t *attributes = json_object_get(primitive, "attributes");
    size_t count, numbers = 3 * (size_t)all.points;
    float *base = read_accessor(&g, whole(attributes, "POSITION"), 3, &count);
    assert_int_equal(count, 25);
    assert_memory_equal(base, all.places, numbers * sizeof *base);
    float *normals = read_accessor(&g, whole(attributes, "NORMAL"), 3, &count);
    for (size_t v = 0; v < 25; v++)
        assert_float_equal(normals[3 * v] * normals[3 * v] + normals[3 * v + 1] * normals[3 * v + 1] +
                               normals[3 * v + 2] * normals[3 * v + 2],
                           1, 1e-6);
    assert_int_equal(json_array_size(targets), 4);
    for (size_t t = 0; t < 4; t++) {
        float *way = read_accessor(&g, whole(json_array_get(targets, t), "POSITION"), 3, &count);
        assert_int_equal(count, 25);
        for (size_t i = 0; i < numbers; i++)
            assert_float_equal(base[i] + way[i], all.places[(t + 1) * numbers + i], 1e-6);
        free(way);
    }
    const json_t *animation = json_array_get(json_object_get(g.root, "animations"), 0);
    const json_t *sampler = json_array_get(json_object_get(animation, "samplers"), 0);
    float *times = read_accessor(&g, whole(sampler, "input"), 1, &count);
    assert_int_equal(count, 5);
    float *weights = read_accessor(&g, whole(sampler, "output"), 1, &count);
    assert_int_equal(count, 20);
    for (size_t i = 0; i < 5; i++) {
        assert_float_equal(times[i], (double)i / 24, 1e-7);
        for (size_t t = 0; t < 4; t++) assert_true(weights[4 * i + t] == (i == t + 1 ? 1 : 0));
    }
    float *indices = read_accessor(&g, whole(primitive, "indices"), 1, &count);
    static const float first[] = {0, 5, 6, 0, 6, 1};
    assert_int_equal(count, 3 * 2 * 16);
    assert_memory_equal(indices, first, sizeof first);
    free(indices);
    free(weights);
    free(times);
    free(normals);
    free(base);
    glb_free(&g);
    samples_free(&all);
}

/* Two squares whose common edge has other coordinates in each: two vertices more, of the same places. */
static void a_seam_of_a_glb_has_vertices_of_both_sides(void **state) {
    (void)state;
    static const float uv[] = {0, 0, 0, 1, 0.5f, 1, 0.5f, 0, 0.25f, 0, 0.25f, 1, 1, 1, 1, 0};
    static const uint32_t corners[] = {0, 1, 3, 2, 2, 3, 5, 4};
    double places[18];
    skein_error error = {SKEIN_OK, "", ""};
    strip_places(0, places);
    io_clip clip = strip(places, 2, &plain_params);
    clip.corner_uv = uv;
    void *file = io_clip_glb.create(&clip, in_folder("seam.glb"), &error);
    for (int frame = 0; frame < 2; frame++) {
        strip_places(frame, places);
        assert_int_equal(io_clip_glb.add(file, places, &error), SKEIN_OK);
    }
    assert_int_equal(io_clip_glb.commit(file, &error), SKEIN_OK);
    strip_places(0, places);
    glb g = read_glb(in_folder("seam.glb"));
    const json_t *primitive = primitive_of(&g), *attributes = json_object_get(primitive, "attributes");
    size_t count, uv_count, index_count;
    float *at = read_accessor(&g, whole(attributes, "POSITION"), 3, &count);
    float *st = read_accessor(&g, whole(attributes, "TEXCOORD_0"), 2, &uv_count);
    float *indices = read_accessor(&g, whole(primitive, "indices"), 1, &index_count);
    assert_int_equal(count, 8);
    assert_int_equal(uv_count, 8);
    assert_int_equal(index_count, 12);
    static const size_t cut[] = {0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7}; // corners of the triangles
    for (size_t i = 0; i < 12; i++) {
        size_t c = cut[i], v = (size_t)indices[i];
        for (size_t k = 0; k < 3; k++) assert_true(at[3 * v + k] == (float)places[3 * corners[c] + k]);
        assert_true(st[2 * v] == uv[2 * c] && st[2 * v + 1] == 1 - uv[2 * c + 1]);
    }
    for (size_t v = 0; v < 6; v++) assert_true(at[3 * v + 1] == (float)places[3 * v + 1]); // its own come first
    free(indices);
    free(st);
    free(at);
    glb_free(&g);
}

static void a_glb_that_would_be_too_large_is_refused_at_once(void **state) {
    (void)state;
    double places[18];
    skein_error error = {SKEIN_OK, "", ""};
    strip_places(0, places);
    io_clip clip = strip(places, 100000, &plain_params);
    assert_null(io_clip_glb.create(&clip, in_folder("large.glb"), &error));
    assert_int_equal(error.status, SKEIN_ERROR_LIMIT);
    assert_contains(error.message, "100000 frames of 6 vertices are 40.0 GB, and a GLB holds 4: ");
    assert_int_equal(count_entries(folder), 0);
}

/* ---- USD ---------------------------------------------------------------------------------------------------- */

/* The numbers of "NAME.timeSamples = {", three each, of all samples: strict, in the one way that it is written. */
static samples read_usda(const char *text, const char *name) {
    samples s = {0, 0, calloc(64, sizeof(double)), calloc(1 << 16, sizeof(float))};
    char words[64];
    snprintf(words, sizeof words, "    %s.timeSamples = {\n", name);
    const char *at = strstr(text, words);
    if (!at) fail_msg("there is no '%s'", words);
    at += strlen(words);
    size_t numbers = 0;
    for (char *end; *at != ' ' || at[4] == ' '; s.count++) {
        assert_true(!strncmp(at, "        ", 8) && s.count < 64);
        s.times[s.count] = (double)strtoul(at + 8, &end, 10);
        assert_memory_equal(end, ": [(", 4);
        for (at = end + 3; *at == '('; numbers += 3) {
            at++;
            for (int k = 0; k < 3; k++) {
                s.places[numbers + (size_t)k] = strtof(at, &end);
                assert_true(end > at);
                assert_memory_equal(end, k < 2 ? ", " : ")", k < 2 ? 2 : 1);
                at = end + (k < 2 ? 2 : 1);
            }
            if (!strncmp(at, ", (", 3)) at += 2;
        }
        assert_memory_equal(at, "],\n", 3);
        at += 3;
    }
    assert_memory_equal(at, "    }\n", 6);
    s.points = (uint32_t)(numbers / 3 / s.count);
    return s;
}

static void usd_text_holds_the_motion_with_axes_and_units(void **state) {
    (void)state;
    const char *s = tiny_scene();
    hash_of(SKEIN("run", s, "--out", in_folder("out"), "--fps", "24", "--up", "z", "--scale", "100", "--set",
                  "output=[\"pc2\", {\"type\": \"usda\", \"every\": 2}]"));
    assert_int_equal(count_entries(in_folder("out")), 5);
    char *text = read_text(in_folder("out/sheet.usda"));
    assert_memory_equal(text, "#usda 1.0\n", 10);
    assert_contains(text, "    endTimeCode = 4         \n    framesPerSecond = 24\n    metersPerUnit = 0.01\n"
                          "    startTimeCode = 0\n    timeCodesPerSecond = 24\n    upAxis = \"Z\"\n)\n");
    assert_contains(text, "\ndef Mesh \"sheet\"\n{\n");
    assert_contains(text, "    int[] faceVertexIndices = [0, 5, 6, 1, 1, 6, 7, 2,");
    samples all = read_pc2(in_folder("out/sheet.pc2")), usd = read_usda(text, "point3f[] points");
    samples normals = read_usda(text, "normal3f[] normals"), boxes = read_usda(text, "float3[] extent");
    assert_int_equal(usd.count, 3);
    assert_int_equal(usd.points, 25);
    assert_int_equal(normals.count, 3);
    assert_int_equal(boxes.points, 2);
    for (size_t i = 0; i < 3; i++) {
        assert_true(usd.times[i] == 2 * (double)i && normals.times[i] == usd.times[i]);
        const float *box = boxes.places + 6 * i;
        for (size_t k = 0; k < 75; k++) {
            float x = usd.places[75 * i + k];
            assert_true(x == all.places[75 * 2 * i + k] && x >= box[k % 3] && x <= box[3 + k % 3]);
        }
        for (const float *n = normals.places + 75 * i; n < normals.places + 75 * (i + 1); n += 3)
            assert_float_equal(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1, 1e-6);
    }
    assert_true(fabsf(normals.places[2]) == 1); // the sheet begins level, and z is up
    size_t length = strlen(text);
    assert_string_equal(text + length - 8, "    }\n}\n");
    samples_free(&all);
    samples_free(&usd);
    samples_free(&normals);
    samples_free(&boxes);
    free(text);
}

/* While it grows, the part is a whole file at each moment. */
static void usd_text_ends_well_while_it_grows(void **state) {
    (void)state;
    double places[18];
    skein_error error = {SKEIN_OK, "", ""};
    strip_places(0, places);
    io_clip clip = strip(places, 10, &plain_params);
    clip.name = "2 sheets.\xc3\xa4";
    void *file = io_clip_usda.create(&clip, in_folder("strip.usda"), &error);
    for (int frame = 0; frame < 3; frame++) {
        strip_places(frame, places);
        assert_int_equal(io_clip_usda.add(file, places, &error), SKEIN_OK);
        char part[64];
        snprintf(part, sizeof part, "strip.usda.%ld.part", (long)getpid());
        char *text = read_text(in_folder(part));
        samples s = read_usda(text, "point3f[] points");
        assert_int_equal(s.count, frame + 1);
        assert_contains(text, "def Mesh \"_2_sheets___\"\n");
        assert_string_equal(text + strlen(text) - 8, "    }\n}\n");
        samples_free(&s);
        free(text);
    }
    io_clip_usda.abandon(file);
    assert_int_equal(count_entries(folder), 0);
}

/* ---- What does not come to its end ------------------------------------------------------------------------ */

/* Of each format that grows: five samples of ten are a whole file, and none at all is a failure. */
static void a_clip_that_ends_early_is_whole(void **state) {
    (void)state;
    double places[3 * STRIP_VERTICES];
    char name[64], kept[80];
    const io_clip_format *format;
    for (size_t f = 0; (format = io_clip_format_at(f)); f++) {
        if (!format->create) continue;
        for (int way = 0; way < 4; way++) {
            skein_error error = {SKEIN_OK, "", ""};
            snprintf(name, sizeof name, "strip%d%s", way, format->ending);
            snprintf(kept, sizeof kept, "kept%d%s", way, format->ending);
            strip_places(0, places);
            io_clip clip = strip(places, way == 0 ? 5 : 10, &plain_params);
            void *file = format->create(&clip, in_folder(name), &error);
            assert_non_null(file);
            for (int frame = 0; frame < (way == 3 ? 0 : 5); frame++) {
                strip_places(frame, places);
                assert_int_equal(format->add(file, places, &error), SKEIN_OK);
            }
            assert_false(exists(in_folder(name)));
            skein_status status = way < 2 ? format->commit(file, &error) : format->keep(file, in_folder(kept), &error);
            assert_int_equal(status, way < 3 ? SKEIN_OK : SKEIN_ERROR_VALUE);
        }
        snprintf(name, sizeof name, "strip0%s", format->ending);
        io_bytes whole = read_bytes(in_folder(name));
        for (int way = 1; way < 3; way++) {
            snprintf(name, sizeof name, "%s%d%s", way == 1 ? "strip" : "kept", way, format->ending);
            io_bytes other = read_bytes(in_folder(name));
            assert_int_equal(other.size, whole.size);
            assert_memory_equal(other.data, whole.data, whole.size);
            io_bytes_free(&other);
        }
        io_bytes_free(&whole);
        assert_int_equal(count_entries(folder), 3);
        remove_folder(state);
        make_folder(state);
    }
}

static void a_full_disk_leaves_no_clip(void **state) {
    (void)state;
    const char *s = tiny_scene();
    const io_clip_format *format;
    char set[128], out[64];
    for (size_t f = 0; (format = io_clip_format_at(f)); f++) {
        snprintf(set, sizeof set, "output=[\"%s\"]", format->kind.name);
        snprintf(out, sizeof out, "full-%s", format->kind.name);
        outcome o = SKEIN_IN(((surroundings){.file_limit = 400}), "run", s, "--out", in_folder(out), "--set", set);
        assert_status(o, 1);
        assert_contains(o.err, "cannot write: ");
        outcome_free(&o);
        snprintf(out, sizeof out, "full-%s/sheet%s", format->kind.name, format->ending);
        assert_false(exists(in_folder(out)));
    }
}

/* On a disk that gets full what was finished is kept, as a whole file. */
static void a_disk_that_gets_full_keeps_whole_samples(void **state) {
    (void)state;
    const char *s = tiny_scene();
    static const char *const kinds[] = {"pc2", "mdd", "usda"};
    for (size_t i = 0; i < COUNT(kinds); i++) {
        char set[64], out[32], kept[64];
        snprintf(set, sizeof set, "output=[\"%s\"]", kinds[i]);
        snprintf(out, sizeof out, "out-%s", kinds[i]);
        snprintf(kept, sizeof kept, "%s/sheet.failed.%s", out, kinds[i]);
        outcome o = SKEIN_IN(((surroundings){.file_limit = 30000}), "run", s, "--frames", "600", "--out",
                             in_folder(out), "--set", set);
        assert_status(o, 1);
        assert_contains(o.err, "cannot write: ");
        outcome_free(&o);
        samples all = {0, 0, NULL, NULL};
        if (i == 0) all = read_pc2(in_folder(kept));
        if (i == 1) all = read_mdd(in_folder(kept));
        if (i == 2) {
            char *text = read_text(in_folder(kept));
            all = read_usda(text, "point3f[] points");
            assert_string_equal(text + strlen(text) - 8, "    }\n}\n");
            free(text);
        }
        assert_int_equal(all.points, 25);
        assert_true(all.count >= 5 && all.count < 600);
        size_t sample = 75;
        assert_true(all.places[(all.count - 1) * sample + 37] < all.places[37]); // it fell
        for (uint32_t k = 0; i == 1 && k < all.count; k++) assert_float_equal(all.times[k], k / 60.0, 1e-6);
        samples_free(&all);
    }
}

/* ---- What is cut ------------------------------------------------------------------------------------------ */

/* A cut body's mesh has no face that is cut: an OBJ written after it says of each face that is left what the file said. */
static void a_file_has_no_face_that_is_cut(void **state) {
    (void)state;
    static const char text[] = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 0 1\nv 1 0 1\nv 2 0 1\nvt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\n"
                               "g left\nf 1/1 2/2 5/4\nusemtl red\nf 1/1 5/4 4/3\ng right\nf 2/1 3/2 6/4 5/3\n";
    write_text(in_folder("two.obj"), text);
    io_mesh read;
    skein_error error = {SKEIN_OK, "", ""};
    const io_warnings quiet = {NULL, NULL};
    assert_int_equal(io_mesh_read(in_folder("two.obj"), &read, quiet, &error), SKEIN_OK);
    skein_world *world = skein_world_create(NULL, NULL);
    skein_handle cloth;
    skein_mesh whole = io_mesh_view(&read);
    assert_int_equal(skein_body_add(world, "cloth", &whole, NULL, &cloth), SKEIN_OK);
    for (int cut = 0; cut < 2; cut++) {
        if (cut) assert_int_equal(skein_cut_faces(world, cloth, (const uint32_t[]){0}, 1), SKEIN_OK);
        skein_surface s;
        uint32_t *room;
        assert_int_equal(skein_body_surface(world, cloth, &s), SKEIN_OK);
        assert_true(io_surface_uncut(world, cloth, &s, &room));
        assert_true(!room == !cut);
        io_mesh_uncut(&read, world, cloth);
        io_clip clip = {
            .name = "two",
            .mesh = {read.positions, s.vertex_count, s.face_sizes, s.face_count, s.face_vertices, s.face_vertex_count},
            .read = &read,
            .read_path = "two.obj",
            .params = &plain_params};
        assert_true(io_mesh_has_faces_of(&read, &clip.mesh));
        assert_int_equal(io_clip_obj.write(&clip, in_folder("out.obj"), &error), SKEIN_OK);
        char *written = read_text(in_folder("out.obj"));
        static const char rest[] = "usemtl red\nf 1/1/1 5/4/5 4/3/4\ng right\nf 2/1/2 3/2/3 6/4/6 5/3/5\n";
        const char *faces = strstr(written, "g left\n");
        assert_non_null(faces);
        assert_string_equal(faces + 7 + (cut ? 0 : strcspn(faces + 7, "\n") + 1), rest);
        assert_true(!strstr(written, "f 1/1/1 2/2/2 5/4/5\n") == (cut == 1));
        assert_contains(written, cut ? "6 vertices, 2 faces" : "6 vertices, 3 faces");
        free(written);
        free(room);
    }
    io_mesh_free(&read);
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
#define TEST(name_) cmocka_unit_test_setup_teardown(name_, make_folder, remove_folder)
        TEST(all_formats_hold_the_same_motion),
        TEST(a_file_can_be_asked_for_alone),
        TEST(axes_and_units_change_in_every_format),
        TEST(a_glb_moves_as_the_point_cache_does),
        TEST(a_seam_of_a_glb_has_vertices_of_both_sides),
        TEST(a_glb_that_would_be_too_large_is_refused_at_once),
        TEST(usd_text_holds_the_motion_with_axes_and_units),
        TEST(usd_text_ends_well_while_it_grows),
        TEST(a_clip_that_ends_early_is_whole),
        TEST(a_full_disk_leaves_no_clip),
        TEST(a_disk_that_gets_full_keeps_whole_samples),
        TEST(a_file_has_no_face_that_is_cut),
    };
    return cmocka_run_group_tests_name("clips", tests, NULL, NULL);
}
