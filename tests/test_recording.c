/* Recordings hold every number that went in, appear only when they are complete, and say why they cannot be written. */
#include "helpers.h"
#include "io/recording.h"

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
    static const char *const names[] = {"a.csv", "a.h5", "a.xdmf"};
    for (size_t i = 0; i < COUNT(names); i++) unlink(in_folder(names[i]));
    return rmdir(folder); // fails if anything else is left
}

/* Awkward numbers, as the library rounds them. */
static double number(int sample, int particle, int k) {
    uint64_t seed = (uint64_t)(1000000 * sample + 100 * particle + k);
    return (double)(skein_real)(random_between(&seed, -1, 1) * pow(10, (sample * 7 + particle * 3 + k) % 30 - 15));
}

static void record(const io_recording_format *format, const char *path) {
    skein_error error = {SKEIN_OK, "", ""};
    void *file = format->create(path, PARTICLES, &error);
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

    // the index names the file without its folder, and every sample of both sets
    FILE *index = fopen(in_folder("a.xdmf"), "r");
    assert_non_null(index);
    char line[400];
    int steps_seen = 0, positions = 0, velocities = 0, slabs = 0;
    while (fgets(line, sizeof line, index)) {
        double time;
        long long first;
        if (sscanf(line, " <Time Value=\"%lf\"/>", &time) == 1) assert_true(time == steps_seen++ / 3.0);
        if (strstr(line, "Dimensions=\"5 37 3\"")) positions += strstr(line, ">a.h5:/positions<") != NULL;
        if (strstr(line, "Dimensions=\"5 37 3\"")) velocities += strstr(line, ">a.h5:/velocities<") != NULL;
        if (sscanf(line, " <DataItem Dimensions=\"3 3\" Format=\"XML\">%lld 0 0 1 1 1 1 37 3", &first) == 1)
            assert_true(first == slabs++ / 2);
    }
    fclose(index);
    assert_true(steps_seen == SAMPLES && positions == SAMPLES && velocities == SAMPLES && slabs == 2 * SAMPLES);
#else
    skip();
#endif
}

static void what_is_abandoned_or_cannot_be_leaves_nothing(void **state) {
    (void)state;
    static const char *const names[] = {"csv", "hdf5"};
    assert_null(io_recording_named("obj"));
    for (size_t i = 0; i < COUNT(names); i++) {
        const io_recording_format *format = io_recording_named(names[i]);
        if (!format) continue; // not built
        skein_error error = {SKEIN_OK, "", ""};
        double zero[3 * PARTICLES] = {0};
        const char *path = in_folder(i ? "a.h5" : "a.csv");
        void *file = format->create(path, PARTICLES, &error);
        assert_int_equal(format->add(file, 0, zero, zero, &error), SKEIN_OK);
        format->abandon(file);
        assert_false(exists(path));
        format->abandon(NULL);
        assert_null(format->create("/tmp/there/is/no/such/folder/a", PARTICLES, &error));
        assert_int_equal(error.status, SKEIN_ERROR_FILE);
        assert_true(strstr(error.where, "no/such/folder/a") && error.message[0]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(csv_holds_every_number, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(hdf5_holds_every_number, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(what_is_abandoned_or_cannot_be_leaves_nothing, make_folder, remove_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
