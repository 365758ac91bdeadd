/* Recordings hold every number that went in, can be read while they grow, appear only when they are complete, and say
 * why they cannot be written. HDF5 is read by the HDF5 library, which had no part in writing it. */
#include "helpers.h"
#include "io/hdf5.h"
#include "io/recording.h"

#include <dirent.h>
#include <sys/stat.h>
#include <unistd.h>
#ifdef SKEIN_HDF5
#include <hdf5.h>
#endif

enum { PARTICLES = 37, SAMPLES = 5 };

static char folder[64];

static int make_folder(void **state) {
    (void)state;
    snprintf(folder, sizeof folder, "/tmp/skein-recording-XXXXXX");
    return mkdtemp(folder) ? 0 : -1;
}

static const char *in_folder(const char *name) {
    static char path[4][128];
    static int turn;
    turn = (turn + 1) % 4;
    snprintf(path[turn], sizeof path[turn], "%s/%s", folder, name);
    return path[turn];
}

static bool exists(const char *path) {
    struct stat info;
    return !stat(path, &info);
}

static int remove_folder(void **state) {
    (void)state;
    static const char *const names[] = {"a.csv", "a.h5", "a.xdmf", "failed.csv", "failed.h5", "failed.xdmf"};
    for (size_t i = 0; i < COUNT(names); i++) unlink(in_folder(names[i]));
    return rmdir(folder); // fails if anything else is left
}

/* Awkward numbers, as the library rounds them. */
static double number(int sample, int particle, int k) {
    uint64_t seed = (uint64_t)(1000000 * sample + 100 * particle + k);
    return (double)(skein_real)(random_between(&seed, -1, 1) * pow(10, (sample * 7 + particle * 3 + k) % 30 - 15));
}

/* A triangle, two quadrilaterals, a polygon of five. */
static const uint32_t sizes[] = {3, 4, 4, 5};
static const uint32_t corners[] = {0, 1, 2, 2, 1, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 36};

static io_recorded what_is_recorded(void) {
    static double masses[PARTICLES];
    for (int i = 0; i < PARTICLES; i++) masses[i] = 0.5 + i;
    return (io_recorded){PARTICLES, masses, sizes, corners, COUNT(sizes), "sheet", "{ \"skein\": 1 }"};
}

static void record(const io_recording_format *format, const char *path) {
    skein_error error = {SKEIN_OK, "", ""};
    io_recorded recorded = what_is_recorded();
    void *file = format->create(path, &recorded, &error);
    assert_non_null(file);
    for (int s = 0; s < SAMPLES; s++) {
        double x[3 * PARTICLES], v[3 * PARTICLES];
        for (int i = 0; i < PARTICLES; i++)
            for (int k = 0; k < 3; k++) x[3 * i + k] = number(s, i, k), v[3 * i + k] = number(s, i, k + 3);
        assert_false(exists(path));
        assert_int_equal(format->add(file, s / 3.0, x, v, &error), SKEIN_OK);
    }
    assert_int_equal(format->commit(file, &error), SKEIN_OK);
    assert_true(exists(path));
}

static void csv_holds_every_number(void **state) {
    (void)state;
    record(&io_recording_csv, in_folder("a.csv"));
    FILE *file = fopen(in_folder("a.csv"), "r");
    char line[400];
    assert_non_null(fgets(line, sizeof line, file));
    assert_string_equal(line, "time (s),particle,x (m),y (m),z (m),vx (m/s),vy (m/s),vz (m/s)\n");
    for (int s = 0; s < SAMPLES; s++)
        for (int i = 0; i < PARTICLES; i++) {
            double time, is[6];
            int particle;
            assert_non_null(fgets(line, sizeof line, file));
            assert_int_equal(sscanf(line, "%lf,%d,%lf,%lf,%lf,%lf,%lf,%lf", &time, &particle, is, is + 1, is + 2,
                                    is + 3, is + 4, is + 5),
                             8);
            assert_true(time == s / 3.0 && particle == i);
            for (int k = 0; k < 6; k++) assert_true((skein_real)is[k] == (skein_real)number(s, i, k));
        }
    assert_null(fgets(line, sizeof line, file));
    fclose(file);
}

static void hdf5_holds_every_number(void **state) {
    (void)state;
#ifdef SKEIN_HDF5
    record(&io_recording_hdf5, in_folder("a.h5"));
    hid_t file = H5Fopen(in_folder("a.h5"), H5F_ACC_RDONLY, H5P_DEFAULT);
    assert_true(file >= 0);
    static const char *const names[] = {"/positions", "/velocities"};
    for (int set = 0; set < 2; set++) {
        static double is[SAMPLES][PARTICLES][3];
        hid_t data = H5Dopen2(file, names[set], H5P_DEFAULT), space = H5Dget_space(data);
        hsize_t size[3];
        assert_int_equal(H5Sget_simple_extent_dims(space, size, NULL), 3);
        assert_true(size[0] == SAMPLES && size[1] == PARTICLES && size[2] == 3);
        assert_true(H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, is) >= 0);
        for (int s = 0; s < SAMPLES; s++)
            for (int i = 0; i < PARTICLES; i++)
                for (int k = 0; k < 3; k++) assert_true(is[s][i][k] == number(s, i, 3 * set + k));
        H5Sclose(space);
        H5Dclose(data);
    }
    double times[SAMPLES];
    hid_t data = H5Dopen2(file, "/time", H5P_DEFAULT);
    assert_true(H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, times) >= 0);
    for (int s = 0; s < SAMPLES; s++) assert_true(times[s] == s / 3.0);
    H5Dclose(data);
    H5Fclose(file);
#else
    skip();
#endif
}

#ifdef SKEIN_HDF5
static hid_t open_set(hid_t file, const char *name) {
    hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
    assert_true(set >= 0);
    return set;
}

/* A text that is attached to an object, or is one. */
static void assert_text(hid_t object, const char *attribute, const char *ought) {
    char is[256] = "";
    hid_t at = attribute ? H5Aopen(object, attribute, H5P_DEFAULT) : object;
    assert_true(at >= 0);
    hid_t type = attribute ? H5Aget_type(at) : H5Dget_type(at);
    assert_true(H5Tget_class(type) == H5T_STRING && H5Tget_size(type) == strlen(ought) + 1);
    assert_true((attribute ? H5Aread(at, type, is) : H5Dread(at, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, is)) >= 0);
    assert_string_equal(is, ought);
    H5Tclose(type);
    if (attribute) H5Aclose(at);
}
#endif

static void hdf5_says_what_made_it(void **state) {
    (void)state;
#ifdef SKEIN_HDF5
    record(&io_recording_hdf5, in_folder("a.h5"));
    hid_t file = H5Fopen(in_folder("a.h5"), H5F_ACC_RDONLY, H5P_DEFAULT);
    assert_true(file >= 0);
    static const char *const units[][2] = {
        {"/time", "s"}, {"/positions", "m"}, {"/velocities", "m/s"}, {"/masses", "kg"}};
    for (size_t i = 0; i < COUNT(units); i++) {
        hid_t set = open_set(file, units[i][0]);
        assert_text(set, "unit", units[i][1]);
        H5Dclose(set);
    }
    hid_t group = H5Gopen2(file, "/", H5P_DEFAULT);
    assert_text(group, "skein", SKEIN_VERSION);
    assert_text(group, "body", "sheet");
    H5Gclose(group);
    hid_t set = open_set(file, "/scene");
    assert_text(set, NULL, "{ \"skein\": 1 }");
    H5Dclose(set);
    double masses[PARTICLES];
    set = open_set(file, "/masses");
    assert_true(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, masses) >= 0);
    for (int i = 0; i < PARTICLES; i++) assert_true(masses[i] == 0.5 + i);
    H5Dclose(set);
    // of several sizes: XDMF's own mixed topology
    static const uint32_t ought[] = {4, 0, 1, 2, 5, 2, 1, 3, 4, 5, 5, 6, 7, 8, 3, 5, 9, 10, 11, 12, 36};
    uint32_t faces[COUNT(ought)];
    set = open_set(file, "/faces");
    hid_t space = H5Dget_space(set);
    assert_int_equal(H5Sget_simple_extent_npoints(space), COUNT(ought));
    assert_true(H5Dread(set, H5T_NATIVE_UINT32, H5S_ALL, H5S_ALL, H5P_DEFAULT, faces) >= 0);
    assert_memory_equal(faces, ought, sizeof ought);
    H5Sclose(space);
    H5Dclose(set);
    H5Fclose(file);
#else
    skip();
#endif
}

/* How often a text has another. */
static int count_in(const char *text, const char *part) {
    int count = 0;
    for (; (text = strstr(text, part)) != NULL; text++) count++;
    return count;
}

static char *whole_text(const char *path) {
    io_bytes bytes;
    assert_int_equal(io_file_read(path, 1 << 20, &bytes, NULL), SKEIN_OK);
    return bytes.data;
}

static void the_index_shows_faces_edges_or_points(void **state) {
    (void)state;
    // the index names the file without its folder, and every sample of both sets
    record(&io_recording_hdf5, in_folder("a.h5"));
    char *text = whole_text(in_folder("a.xdmf")), part[200];
    for (int s = 0; s < SAMPLES; s++) {
        snprintf(part, sizeof part, "<Time Value=\"%.17g\"/>", s / 3.0);
        assert_int_equal(count_in(text, part), 1);
        snprintf(part, sizeof part, "<DataItem Dimensions=\"3 3\" Format=\"XML\">%d 0 0 1 1 1 1 37 3</DataItem>", s);
        assert_int_equal(count_in(text, part), 2);
    }
    snprintf(part, sizeof part, "\"5 37 3\" NumberType=\"Float\" Precision=\"%zu\" Format=\"HDF\">a.h5:/positions<",
             sizeof(skein_real));
    assert_int_equal(count_in(text, part), SAMPLES);
    assert_int_equal(count_in(text, ">a.h5:/velocities<"), SAMPLES);
    assert_int_equal(count_in(text, "<Topology TopologyType=\"Mixed\" NumberOfElements=\"4\">"), SAMPLES);
    assert_int_equal(count_in(text, "<DataItem Dimensions=\"21\" NumberType=\"UInt\" Precision=\"4\" "
                                    "Format=\"HDF\">a.h5:/faces</DataItem>"),
                     SAMPLES);
    free(text);

    static const uint32_t all_quads[] = {4, 4}, all_edges[] = {2, 2, 2};
    const struct {
        io_recorded recorded;
        const char *topology, *cells;
    } others[] = {
        {{.particles = PARTICLES, .cell_sizes = all_quads, .cells = corners, .cell_count = 2},
         "<Topology TopologyType=\"Quadrilateral\" NumberOfElements=\"2\">",
         "<DataItem Dimensions=\"2 4\" NumberType=\"UInt\" Precision=\"4\" Format=\"HDF\">a.h5:/faces</DataItem>"},
        {{.particles = PARTICLES, .cell_sizes = all_edges, .cells = corners, .cell_count = 3},
         "<Topology TopologyType=\"Polyline\" NumberOfElements=\"3\" NodesPerElement=\"2\">",
         "<DataItem Dimensions=\"3 2\" NumberType=\"UInt\" Precision=\"4\" Format=\"HDF\">a.h5:/edges</DataItem>"},
        {{.particles = PARTICLES},
         "<Topology TopologyType=\"Polyvertex\" NodesPerElement=\"1\" NumberOfElements=\"37\"/>",
         "</Topology>"},
    };
    for (size_t i = 0; i < COUNT(others); i++) {
        skein_error error = {SKEIN_OK, "", ""};
        double zero[3 * PARTICLES] = {0};
        void *file = io_recording_hdf5.create(in_folder("a.h5"), &others[i].recorded, &error);
        assert_non_null(file);
        assert_int_equal(io_recording_hdf5.add(file, 0, zero, zero, &error), SKEIN_OK);
        assert_int_equal(io_recording_hdf5.commit(file, &error), SKEIN_OK);
        text = whole_text(in_folder("a.xdmf"));
        assert_int_equal(count_in(text, others[i].topology), 1);
        assert_int_equal(count_in(text, others[i].cells), others[i].recorded.cell_count != 0);
        free(text);
    }
}

/* The one entry of the folder with this in its name. */
static const char *find_entry(const char *part) {
    static char path[400];
    DIR *open_folder = opendir(folder);
    int found = 0;
    for (struct dirent *entry; (entry = readdir(open_folder)) != NULL;)
        if (strstr(entry->d_name, part)) {
            snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
            found++;
        }
    closedir(open_folder);
    assert_int_equal(found, 1);
    return path;
}

/* Opens what there is as any program would, and looks at all samples. */
static void judge_growing(const char *path, uint64_t samples) {
#ifdef SKEIN_HDF5
    hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    assert_true(file >= 0);
    for (int which = 0; which < 2; which++) {
        hid_t set = open_set(file, which ? "/b" : "/a"), space = H5Dget_space(set);
        assert_int_equal(H5Sget_simple_extent_npoints(space), which ? samples : 2 * samples);
        uint32_t *is = malloc((2 * samples + 1) * sizeof *is);
        assert_true(samples == 0 || H5Dread(set, H5T_NATIVE_UINT32, H5S_ALL, H5S_ALL, H5P_DEFAULT, is) >= 0);
        for (uint32_t s = 0; s < samples; s++) {
            if (which) assert_int_equal(is[s], 7 * s);
            else assert_true(is[2 * s] == s && is[2 * s + 1] == s * s + 1);
        }
        free(is);
        H5Sclose(space);
        H5Dclose(set);
    }
    H5Fclose(file);
#else
    (void)path, (void)samples;
#endif
}

/* So many samples that the trees have three levels, of one that fills a chunk and of three that share one. */
static void hdf5_can_be_read_while_it_grows(void **state) {
    (void)state;
#ifndef SKEIN_HDF5
    skip();
#endif
    const uint32_t all = 64 * 64 + 100;
    const io_hdf5_set sets[] = {{.name = "a", .type = IO_HDF5_UINT32, .rank = 2, .dims = {0, 2}, .chunk = 1},
                                {.name = "b", .type = IO_HDF5_UINT32, .rank = 1, .chunk = 3}};
    skein_error error = {SKEIN_OK, "", ""};
    io_hdf5 *file =
        io_hdf5_begin(in_folder("a.h5"), sets, 2, (const io_hdf5_note[IO_HDF5_MOST_NOTES]){{NULL, NULL}}, &error);
    assert_non_null(file);
    io_hdf5_publish(file);
    judge_growing(find_entry("a.h5."), 0);
    for (uint32_t s = 0; s < all; s++) {
        const uint32_t a[2] = {s, s * s + 1}, b = 7 * s;
        assert_int_equal(io_hdf5_add(file, (const void *const[]){a, &b}, &error), SKEIN_OK);
        bool near_a_change = s % 64 < 2 || (s > 4094 && s < 4100);
        if (s % 7 == 0) io_hdf5_publish(file);
        if (s < 6 || (near_a_change && s % 5 == 0) || s > 4090)
            judge_growing(find_entry("a.h5."), io_hdf5_readable(file));
        if (s % 7 == 0) assert_true(io_hdf5_readable(file) == s + 1);
    }
    assert_false(exists(in_folder("a.h5")));
    assert_int_equal(io_hdf5_commit(file, &error), SKEIN_OK);
    judge_growing(in_folder("a.h5"), all);
}

static void what_is_whole_is_kept_under_another_name(void **state) {
    (void)state;
    static const char *const endings[] = {"csv", "h5"};
    for (int i = 0; i < 2; i++) {
        const io_recording_format *format = i ? &io_recording_hdf5 : &io_recording_csv;
        skein_error error = {SKEIN_OK, "", ""};
        double zero[3 * PARTICLES] = {0};
        char name[32];
        io_recorded recorded = {.particles = PARTICLES};
        snprintf(name, sizeof name, "a.%s", endings[i]);
        void *file = format->create(in_folder(name), &recorded, &error);
        for (int s = 0; s < 3; s++) assert_int_equal(format->add(file, s, zero, zero, &error), SKEIN_OK);
        snprintf(name, sizeof name, "failed.%s", endings[i]);
        assert_int_equal(format->keep(file, in_folder(name), &error), SKEIN_OK);
        if (i) {
            char *text = whole_text(in_folder("failed.xdmf"));
            assert_int_equal(count_in(text, "failed.h5:/positions"), 3);
            free(text);
        } else {
            char *text = whole_text(in_folder(name));
            assert_int_equal(count_in(text, "\n"), 1 + 3 * PARTICLES);
            free(text);
        }
    }
    assert_false(exists(in_folder("a.csv")) || exists(in_folder("a.h5")) || exists(in_folder("a.xdmf")));
}

static void what_is_abandoned_or_cannot_be_leaves_nothing(void **state) {
    (void)state;
    static const char *const names[] = {"csv", "hdf5"};
    assert_null(io_recording_named("obj"));
    for (size_t i = 0; i < COUNT(names); i++) {
        const io_recording_format *format = io_recording_named(names[i]);
        skein_error error = {SKEIN_OK, "", ""};
        double zero[3 * PARTICLES] = {0};
        const char *path = in_folder(i ? "a.h5" : "a.csv");
        io_recorded recorded = {.particles = PARTICLES};
        void *file = format->create(path, &recorded, &error);
        assert_int_equal(format->add(file, 0, zero, zero, &error), SKEIN_OK);
        format->abandon(file);
        assert_false(exists(path));
        format->abandon(NULL);
        assert_null(format->create("/tmp/there/is/no/such/folder/a", &recorded, &error));
        assert_int_equal(error.status, SKEIN_ERROR_FILE);
        assert_true(strstr(error.where, "no/such/folder/a") && error.message[0]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(csv_holds_every_number, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(hdf5_holds_every_number, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(hdf5_says_what_made_it, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(the_index_shows_faces_edges_or_points, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(hdf5_can_be_read_while_it_grows, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(what_is_whole_is_kept_under_another_name, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(what_is_abandoned_or_cannot_be_leaves_nothing, make_folder, remove_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
