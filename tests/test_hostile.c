/* Files that mean no good: small ones that claim a gigabyte, JSON and nodes nested a hundred thousand deep, and links that
 * lead out of a folder. Each is refused with words that name it, at once and in little memory: the command may not take
 * more than 400 MB of data here, so that whoever makes room for what a file claims runs out of it, and says so. */
#include "test_command.h"

#include <skein/record.h>

#include "sparing.h"

enum { GIGABYTE = 1000000000, DEPTH = 100000 };

/* ---- Making them ------------------------------------------------------------------------------------------- */

typedef struct bytes {
    unsigned char data[4096];
    size_t size;
} bytes;

static void put(bytes *b, const void *from, size_t size) {
    assert_true(b->size + size <= sizeof b->data);
    memcpy(b->data + b->size, from, size);
    b->size += size;
}

static void put_text(bytes *b, const char *text) {
    put(b, text, strlen(text));
}

static void put_u32(bytes *b, uint32_t value) {
    put(b, &value, sizeof value); // on machines whose bytes lie as the files' do
}

static void put_floats(bytes *b, int count) { // 0, 0, 0, 1, 0, 0, 0, 1, 0 and on
    for (int i = 0; i < count; i++) {
        float value = i % 9 == 3 || i % 9 == 7;
        put(b, &value, sizeof value);
    }
}

static const char *save(const char *name, const void *data, size_t size) {
    const char *path = in_folder(name);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(data, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
    return path;
}

/* A text with a middle many times over, of ' for "; to be freed. */
static char *nested(const char *before, const char *open, const char *middle, const char *close, const char *after) {
    size_t room = strlen(before) + DEPTH * (strlen(open) + strlen(close)) + strlen(middle) + strlen(after) + 1;
    char *text = malloc(room), *at = text;
    assert_non_null(text);
    at = stpcpy(at, before);
    for (int i = 0; i < DEPTH; i++) at = stpcpy(at, open);
    at = stpcpy(at, middle);
    for (int i = 0; i < DEPTH; i++) at = stpcpy(at, close);
    stpcpy(at, after);
    for (at = text; (at = strchr(at, '\'')) != NULL;) *at = '"';
    return text;
}

static void remove_tree(const char *path) {
    assert_int_equal(nftw(path, remove_entry, 8, FTW_DEPTH | FTW_PHYS), 0);
}

/* ---- Judging ----------------------------------------------------------------------------------------------- */

/* Runs the command with little memory. */
static outcome run_in_little(const char *const *arguments) {
    struct rlimit before, low;
    assert_int_equal(getrlimit(RLIMIT_DATA, &before), 0);
    low = before;
    if (!SPARING) low.rlim_cur = 400u << 20;
    assert_int_equal(setrlimit(RLIMIT_DATA, &low), 0);
    outcome o = finish_skein(start_skein((surroundings){0}, arguments));
    assert_int_equal(setrlimit(RLIMIT_DATA, &before), 0);
    return o;
}

/* It has to refuse with these words, and not for want of memory. */
static void refused(const char *words, const char *const *arguments) {
    outcome o = run_in_little(arguments);
    if (o.status != 1 && o.status != 2)
        fail_msg("%s %s: exit status %d; it said:\n%s%s", arguments[0], arguments[1], o.status, o.out, o.err);
    assert_contains(o.err, words);
    assert_null(strstr(o.err, "out of memory"));
    outcome_free(&o);
}
#define REFUSED(words_, ...) refused((words_), (const char *const[]){__VA_ARGS__, NULL})

/* ---- Sizes that are only claimed ---------------------------------------------------------------------------- */

static void texts_that_claim_a_gigabyte(void **state) {
    (void)state;
    static const struct {
        const char *name, *text, *words;
    } files[] = {
        {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 1000000000\n",
         ":4: vertex 1000000000 in a face, but the file has 3"},
        {"a.off", "OFF\n80000000 80000000 0\n0 0 0\n1 0 0\n0 1 0\n", "the file ends after 3 of 80000000 vertices"},
        {"b.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n250000000 0 1 2\n", ":6: "},
        {"a.ply",
         "ply\nformat ascii 1.0\nelement vertex 80000000\nproperty float x\nproperty float y\nproperty float z\n"
         "element face 1\nproperty list uchar uint vertex_indices\nend_header\n0 0 0\n1 0 0\n",
         "the file ends in vertex 3 of 80000000"},
        {"b.ply",
         "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
         "element face 1\nproperty list uint uint vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n250000000 0 1 2\n",
         "the file ends in face 1 of 1"},
        {"a.node", "80000000 3 0 0\n1 0 0 0\n", "the file ends after 1 of 80000000 points"},
        {"b.node", "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n", "b.ele:3: the file ends after 1 of 80000000"},
        {"a.gltf", // of an accessor without bytes glTF says that they are all 0
         "{\"asset\": {\"version\": \"2.0\"}, \"accessors\": [{\"componentType\": 5126, \"count\": 80000000, \"type\": "
         "\"VEC3\"}], \"meshes\": [{\"primitives\": [{\"attributes\": {\"POSITION\": 0}}]}]}",
         "accessor 0 or its view is not as glTF 2.0 has it"},
        {"grid.json", "{\"bodies\": [{\"type\": \"cloth\", \"grid\": [30000, 30000]}]}",
         "bodies.0.mesh: 900000000 vertices"},
        {"rope.json", "{\"bodies\": [{\"type\": \"rope\", \"count\": 1000000000}]}",
         "bodies.0.count: 1e+09 is out of range"},
        {"cube.json", "{\"bodies\": [{\"type\": \"lattice\", \"count\": [1000, 1000, 1000]}]}", "bodies.0"},
    };
    static const char cells[] = "80000000 4 0\n1 1 2 3 4\n";
    save("a.ele", cells, sizeof cells - 1), save("b.ele", cells, sizeof cells - 1);
    for (size_t i = 0; i < COUNT(files); i++)
        REFUSED(files[i].words, "check", save(files[i].name, files[i].text, strlen(files[i].text)));
}

static void binary_meshes_that_claim_a_gigabyte(void **state) {
    (void)state;
    static const char places[] =
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nelement face 1\nproperty list uint uint vertex_indices\nend_header\n";
    bytes b = {.size = 0};
    put_text(&b, places), put_floats(&b, 9), put_u32(&b, 250000000), put_u32(&b, 0), put_u32(&b, 1), put_u32(&b, 2);
    REFUSED("the file ends in face 1 of 1", "check", save("a.ply", b.data, b.size));

    b = (bytes){.size = 80};
    put_u32(&b, 20000000), put_floats(&b, 12), put(&b, "\0", 2);
    REFUSED("the header promises 20000000 triangles, 1000000084 bytes", "check", save("a.stl", b.data, b.size));

    static const char json[] =
        "{\"asset\": {\"version\": \"2.0\"}, \"buffers\": [{\"byteLength\": 1000000000}], \"bufferViews\": [{\"buffer\": 0, "
        "\"byteLength\": 1000000000}], \"accessors\": [{\"bufferView\": 0, \"componentType\": 5126, \"count\": 80000000, "
        "\"type\": \"VEC3\"}], \"meshes\": [{\"primitives\": [{\"attributes\": {\"POSITION\": 0}}]}]} ";
    uint32_t text = (uint32_t)(sizeof json - 1) & ~3u, whole = 12 + 8 + text + 8 + 36;
    static const char *const words[] = {"of the 1000000000 bytes that its header promises", "is cut off",
                                        "the chunk of numbers is cut off",
                                        "buffer 0 has 36 bytes of the 1000000000 that it promises"};
    for (int wrong = 0; wrong < 4; wrong++) { // the file's length, that of either chunk, a buffer's
        b = (bytes){.size = 0};
        put_text(&b, "glTF"), put_u32(&b, 2), put_u32(&b, wrong == 0 ? GIGABYTE : whole);
        put_u32(&b, wrong == 1 ? GIGABYTE : text), put_text(&b, "JSON"), put(&b, json, text);
        put_u32(&b, wrong == 2 ? GIGABYTE : 36), put(&b, "BIN", 4), put_floats(&b, 9);
        REFUSED(words[wrong], "check", save("a.glb", b.data, b.size));
    }
}

static void caches_that_claim_a_gigabyte(void **state) {
    (void)state;
    static const struct {
        uint32_t points, samples;
        const char *words;
    } claims[] = {{9, 9000000, "the header counts 9000000 samples, the file holds 1"},
                  {80000000, 1, "the header counts 1 samples, the file holds 0"},
                  {2000000000, 2000000000, "the header counts 2000000000 samples"}};
    write_scene(in_folder("a.json"),
                "{'bodies': [{'type': 'cloth', 'grid': [3, 3], 'pins': 'corners'}], 'motions': [{'type': "
                "'cache', 'file': 'a.pc2'}]}");
    for (size_t i = 0; i < COUNT(claims); i++) {
        bytes b = {.size = 0};
        put(&b, "POINTCACHE2", 12), put_u32(&b, 1), put_u32(&b, claims[i].points), put_u32(&b, 0);
        put(&b, &(float){1}, 4), put_u32(&b, claims[i].samples), put_floats(&b, 27);
        save("a.pc2", b.data, b.size);
        REFUSED(claims[i].words, "check", in_folder("a.json"));
    }
}

/* A number of every place of a file's first bytes is made a gigabyte, one after the other: whatever it counts, the
 * command ends with words. A sum in the file may find it first; test_snapshot and the fuzzers put that right. */
static void each_word_a_gigabyte(const char *path, size_t first, size_t most, const char *const *arguments) {
    io_bytes good;
    skein_error error;
    assert_int_equal(io_file_read(path, 1 << 20, &good, &error), SKEIN_OK);
    unsigned char *changed = malloc(good.size);
    assert_non_null(changed);
    char name[600];
    snprintf(name, sizeof name, "%s", path + strlen(folder) + 1);
    for (size_t at = first; at + 4 <= good.size && at < most; at += 4) {
        memcpy(changed, good.data, good.size);
        memcpy(changed + at, &(uint32_t){GIGABYTE}, 4);
        save(name, changed, good.size);
        refused("skein", arguments);
    }
    save(name, good.data, good.size);
    free(changed);
    io_bytes_free(&good);
}

static void recordings_and_snapshots_that_claim_a_gigabyte(void **state) {
    (void)state;
    char film[600], out[600], path[700];
    const char *scene = tiny_scene();
    snprintf(film, sizeof film, "%s", in_folder("a.skeinrec"));
    snprintf(out, sizeof out, "%s", in_folder("out"));
    outcome o = SKEIN("record", scene, "-o", film, "--quiet");
    assert_status(o, 0);
    outcome_free(&o);
    each_word_a_gigabyte(film, 0, 64, (const char *const[]){"verify", film, NULL});
    o = SKEIN("verify", film);
    assert_status(o, 0);
    outcome_free(&o);

    o = SKEIN("run", scene, "--out", out, "--snapshots", "2", "--quiet");
    assert_status(o, 0);
    outcome_free(&o);
    snprintf(path, sizeof path, "%s/resume", out);
    int snapshots = 0;
    DIR *open_folder = opendir(path);
    assert_non_null(open_folder);
    char names[8][300];
    for (struct dirent *entry; (entry = readdir(open_folder)) != NULL && snapshots < 8;)
        if (strstr(entry->d_name, ".snapshot"))
            snprintf(names[snapshots++], sizeof names[0], "out/resume/%s", entry->d_name);
    closedir(open_folder);
    assert_true(snapshots > 0);
    for (int i = 0; i < snapshots; i++) {
        io_bytes good;
        skein_error error;
        assert_int_equal(io_file_read(in_folder(names[i]), 1 << 20, &good, &error), SKEIN_OK);
        for (size_t at = 16; at < 24; at += 4) memcpy(good.data + at, &(uint32_t){at == 16 ? GIGABYTE : 0}, 4);
        save(names[i], good.data, good.size);
        io_bytes_free(&good);
    }
    // where none is whole, it says so of each, and begins anew
    o = run_in_little((const char *const[]){"run", "--resume", out, "--quiet", NULL});
    assert_status(o, 0);
    assert_contains(o.err, "the snapshot is damaged: it has ");
    assert_contains(o.err, " bytes of 1000000000\n");
    outcome_free(&o);
}

/* ---- Nested ------------------------------------------------------------------------------------------------- */

static bool put_to_file(void *user, const void *data, size_t size) {
    return fwrite(data, 1, size, user) == size;
}

static void json_is_nested_deep(void **state) {
    (void)state;
    static const struct {
        const char *before, *open, *middle, *close, *after;
    } texts[] = {{"", "[", "", "", ""},
                 {"", "{'a':", "1", "", ""},
                 {"", "[", "", "]", ""},
                 {"{'bodies': ", "[", "", "]", "}"},
                 {"{'method': ", "{'type': ", "1", "}", "}"}};
    for (size_t i = 0; i < COUNT(texts); i++) {
        char *text = nested(texts[i].before, texts[i].open, texts[i].middle, texts[i].close, texts[i].after);
        char mesh[300];
        save("deep.json", text, strlen(text));
        save("deep.gltf", text, strlen(text));
        snprintf(mesh, sizeof mesh, "%s", in_folder("deep.gltf"));
        REFUSED("maximum parsing depth", "check", in_folder("deep.json"));
        REFUSED("maximum parsing depth", "study", in_folder("deep.json"), "--out", in_folder("study"));
        REFUSED("the JSON of the file: maximum parsing depth", "check", mesh);
        // what a value on the command line, a run to go on with and a recording have of it
        assert_int_equal(mkdir(in_folder("resume"), 0777) == 0 || errno == EEXIST, 1);
        save("resume/run.json", text, strlen(text));
        REFUSED("run.json", "run", "--resume", in_folder("resume"));
        const char *path = in_folder("deep.skeinrec");
        FILE *file = fopen(path, "wb");
        assert_non_null(file);
        skein_world *world = skein_world_create(NULL, NULL);
        skein_recorder to = {.write = put_to_file, .user = file, .note = text};
        assert_int_equal(skein_record_begin(world, &to), SKEIN_OK);
        assert_int_equal(skein_world_step(world, 0.01), SKEIN_OK);
        assert_int_equal(skein_record_end(world), SKEIN_OK);
        skein_world_destroy(world);
        assert_int_equal(fclose(file), 0);
        REFUSED("deep.skeinrec", "verify", path);
        free(text);
    }
}

/* Nodes that hang on each other in a row, and one that hangs on itself: flat JSON, deep all the same. */
static void nodes_are_nested_deep(void **state) {
    (void)state;
    char *text = malloc(40 * DEPTH + 1000), *at = text;
    assert_non_null(text);
    at = stpcpy(at, "{\"asset\": {\"version\": \"2.0\"}, \"scenes\": [{\"nodes\": [0]}], \"nodes\": [");
    for (int i = 1; i < DEPTH; i++) at += sprintf(at, "{\"children\": [%d]}, ", i);
    stpcpy(at, "{\"mesh\": 0}], \"meshes\": [{\"primitives\": []}]}");
    REFUSED("nodes are nested more than 64 deep", "check", save("deep.gltf", text, strlen(text)));
    free(text);
    static const char ring[] =
        "{\"asset\": {\"version\": \"2.0\"}, \"scenes\": [{\"nodes\": [0]}], \"nodes\": [{\"children\": "
        "[1]}, {\"children\": [0]}]}";
    REFUSED("nodes have to be a tree", "check", save("ring.gltf", ring, sizeof ring - 1));
}

/* ---- Links and ways out ---------------------------------------------------------------------------------------- */

/* A mesh is in two files, and the second one is a link, or is named by a way out of the folder. */
static void what_a_mesh_names_lies_beside_it(void **state) {
    (void)state;
    assert_int_equal(mkdir(in_folder("project"), 0777) || mkdir(in_folder("outside"), 0777), 0);
    bytes b = {.size = 0};
    put_floats(&b, 9);
    save("outside/a.bin", b.data, b.size);
    save("project/own.bin", b.data, b.size);
    static const struct {
        const char *uri, *words;
    } buffers[] = {{"own.bin", NULL},
                   {"inside.bin", NULL}, // a link that stays there
                   {"link.bin", "link.bin: is a link out of its folder"},
                   {"../outside/a.bin", "is not read: put it into the folder"},
                   {"..%2Foutside%2Fa.bin", "is not read: put it into the folder"},
                   {"/etc/hostname", "is not read: put it into the folder"}};
    assert_int_equal(symlink("../outside/a.bin", in_folder("project/link.bin")), 0);
    assert_int_equal(symlink("own.bin", in_folder("project/inside.bin")), 0);
    for (size_t i = 0; i < COUNT(buffers); i++) {
        char text[700];
        snprintf(
            text, sizeof text,
            "{'asset': {'version': '2.0'}, 'buffers': [{'byteLength': 36, 'uri': '%s'}], 'bufferViews': [{'buffer': 0, "
            "'byteLength': 36}], 'accessors': [{'bufferView': 0, 'componentType': 5126, 'count': 3, 'type': 'VEC3'}], "
            "'meshes': [{'primitives': [{'attributes': {'POSITION': 0}}]}]}",
            buffers[i].uri);
        write_scene(in_folder("project/a.gltf"), text);
        if (buffers[i].words) {
            REFUSED(buffers[i].words, "check", in_folder("project/a.gltf"));
            continue;
        }
        outcome o = SKEIN("check", in_folder("project/a.gltf"));
        assert_status(o, 0);
        outcome_free(&o);
    }
    static const char points[] = "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n", cells[] = "1 4 0\n1 1 2 3 4\n";
    save("project/a.node", points, sizeof points - 1);
    save("outside/a.ele", cells, sizeof cells - 1);
    assert_int_equal(symlink("../outside/a.ele", in_folder("project/a.ele")), 0);
    REFUSED("a.ele: is a link out of its folder", "check", in_folder("project/a.node"));
    assert_int_equal(unlink(in_folder("project/a.ele")), 0);
    save("project/a.ele", cells, sizeof cells - 1);
    outcome o = SKEIN("check", in_folder("project/a.node"));
    assert_status(o, 0);
    outcome_free(&o);
}

/* Names that a scene gives to what is written: none of them leads out of --out. */
static void nothing_is_written_outside(void **state) {
    (void)state;
    static const char *const names[] = {"../../away", "/tmp/away", "..", ".", "a/b", "\\\\away", "a\\u0001b"};
    assert_int_equal(mkdir(in_folder("deep"), 0777), 0);
    outcome o = SKEIN("list"); // what it says is kept in two files there
    assert_status(o, 0);
    outcome_free(&o);
    int ought = count_entries(folder);
    for (size_t i = 0; i < COUNT(names); i++) {
        char text[900];
        snprintf(
            text, sizeof text,
            "{'name': '%s', 'frames': 1, 'output': ['obj', 'pc2', 'mdd', 'glb', 'usda', 'ply', 'stl', 'csv', 'png'], "
            "'bodies': [{'type': 'cloth', 'name': '%s', 'grid': [3, 3]}]}",
            names[i], names[i]);
        write_scene(in_folder("deep/a.json"), text);
        o = SKEIN("run", in_folder("deep/a.json"), "--out", in_folder("deep/out"), "--quiet");
        assert_status(o, 0);
        outcome_free(&o);
        assert_int_equal(count_entries(in_folder("deep/out")), 10);
        assert_int_equal(count_entries(in_folder("deep")), 2);
        assert_int_equal(count_entries(folder), ought);
        assert_false(exists("/tmp/away.obj"));
        remove_tree(in_folder("deep/out"));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
#define TEST(name_) cmocka_unit_test_setup_teardown(name_, make_folder, remove_folder)
        TEST(texts_that_claim_a_gigabyte),
        TEST(binary_meshes_that_claim_a_gigabyte),
        TEST(caches_that_claim_a_gigabyte),
        TEST(recordings_and_snapshots_that_claim_a_gigabyte),
        TEST(json_is_nested_deep),
        TEST(nodes_are_nested_deep),
        TEST(what_a_mesh_names_lies_beside_it),
        TEST(nothing_is_written_outside),
    };
    return cmocka_run_group_tests_name("hostile files", tests, NULL, NULL);
}
