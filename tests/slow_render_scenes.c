/* Every scene in scenes/, drawn by the command at 640 x 360: the picture must hold what the scene does. */
#include "test_command.h"

#include <math.h>

#include "render/camera.h"
#include "render/image.h"

enum { width = 640, height = 360 };

/* What can be told apart by its colour alone. */
typedef struct parts {
    double cloth;                    /* warm and full: part of the picture */
    double ball;                     /* dark blue */
    double sky, ground;              /* bluish and light in the upper rows; pale and warm in the lower */
    double shade;                    /* grey, in the lower half */
    double cloth_x, shade_x;         /* their middles across, 0 to 1 */
    double left, right, top, bottom; /* of the cloth, 0 to 1 */
} parts;

static bool is_warm(const uint8_t *p) {
    return p[0] > p[2] + 60 && p[0] > p[1] + 40;
}

static parts look_at(const render_image *image) {
    parts seen = {.left = 1, .top = 1};
    const double all = width * height;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            const uint8_t *p = render_image_pixel(image, x, y);
            int light = p[0] + p[1] + p[2];
            seen.ball += (p[2] > p[0] + 30 && light < 330) / all;
            seen.sky += (y < 16 && p[2] > p[0] + 4 && light > 500) / (16.0 * width);
            seen.ground += (y >= height - 16 && p[0] >= p[2] && light > 400) / (16.0 * width);
            if (y > height / 2 && light < 560 && abs(p[0] - p[2]) < 30)
                seen.shade += 1 / all, seen.shade_x += x / all / width;
            if (!is_warm(p)) continue;
            seen.cloth += 1 / all, seen.cloth_x += x / all / width;
            seen.left = fmin(seen.left, (double)x / width), seen.right = fmax(seen.right, (double)x / width);
            seen.top = fmin(seen.top, (double)y / height), seen.bottom = fmax(seen.bottom, (double)y / height);
        }
    seen.shade_x /= seen.shade, seen.cloth_x /= seen.cloth;
    return seen;
}

/* Whether the shadow falls to the picture's right: 1, or -1 for left. */
static int shadow_side(void) {
    const render_bounds box = {{-1, 0, -1}, {1, 2, 1}};
    render_look look = render_default_look();
    render_camera camera = render_camera_framing(&box, (double)width / height);
    double right[3], up[3], back[3];
    render_camera_axes(&camera, right, up, back);
    return look.sun[0] * right[0] + look.sun[2] * right[2] < 0 ? 1 : -1;
}

/* What a scene must show; one that is new here must show sky and ground. */
static const struct {
    const char *name, *frame;
    double ball;          /* at least so much of the picture, where no cloth hides it */
    double hidden, shown; /* parts of that: at least so much is hidden, so much seen */
} expectations[] = {
    {"drape", "120", 0.03, 0.5, 0}, {"elephant", "60", 0.03, 0, 0.05},  {"flag", "120", 0, 0, 0},
    {"hanging", "200", 0, 0, 0},    {"turntable", "150", 0.03, 0.3, 0},
};

static parts draw(const char *scene, const char *frame, const char *set) {
    char path[300];
    snprintf(path, sizeof path, "%s", in_folder("a.png"));
    outcome o = SKEIN("render", scene, "-o", path, "--frame", frame, "--size", "640x360", "--quiet", "--set", set);
    assert_status(o, 0);
    assert_string_equal(o.err, "");
    outcome_free(&o);
    render_image image = {0};
    assert_int_equal(render_image_read(&image, path, NULL), SKEIN_OK);
    assert_true(image.width == width && image.height == height);
    parts seen = look_at(&image);
    render_image_release(&image);
    return seen;
}

static bool is_missing(const char *path) {
    json_t *scene = json_load_file(path, 0, NULL);
    assert_non_null(scene);
    const char *mesh = json_string_value(json_object_get(json_array_get(json_object_get(scene, "bodies"), 0), "mesh"));
    char mesh_path[600];
    snprintf(mesh_path, sizeof mesh_path, "scenes/%s", mesh ? mesh : "");
    bool missing = mesh && !exists(mesh_path);
    json_decref(scene);
    return missing;
}

static void judge(const char *path, const char *name) {
    const char *frame = "60";
    double ball = 0, hidden = 0, shown = 0;
    bool known = false;
    for (size_t i = 0; i < COUNT(expectations); i++) {
        if (strcmp(name, expectations[i].name)) continue;
        known = true;
        frame = expectations[i].frame, ball = expectations[i].ball;
        hidden = expectations[i].hidden, shown = expectations[i].shown;
    }
    parts seen = draw(path, frame, "skein=1"), bare = draw(path, frame, "bodies.0.visible=false");
    fprintf(stderr, "%s: cloth %.4f (%.4f without), ball %.4f (%.4f), sky %.2f, ground %.2f, shade %.4f\n", name,
            seen.cloth, bare.cloth, seen.ball, bare.ball, seen.sky, seen.ground, seen.shade);
    assert_true(seen.sky > 0.3 && seen.ground > 0.6);
    if (!known) return;
    assert_true(seen.cloth > 0.01 && seen.cloth < 0.6 && bare.cloth < seen.cloth / 4);
    assert_true(bare.ball >= ball && (ball > 0 || bare.ball < 0.001));
    assert_true(seen.ball <= (1 - hidden) * bare.ball && seen.ball >= shown * bare.ball);
    assert_true(seen.shade > 0.002);
    assert_true((seen.shade_x - seen.cloth_x) * shadow_side() > 0);
    // all of it, and not at the rim
    assert_true(seen.left > 0.02 && seen.right < 0.98 && seen.top > 0.02 && seen.bottom < 0.98);
    assert_true(fabs((seen.left + seen.right) / 2 - 0.5) < 0.2);
}

static void every_scene_shows_what_it_is(void **state) {
    (void)state;
    DIR *scenes = opendir("scenes");
    assert_non_null(scenes);
    int count = 0;
    for (struct dirent *entry; (entry = readdir(scenes)) != NULL;) {
        char path[512], name[256];
        const char *ending = strstr(entry->d_name, ".json");
        if (!ending) continue;
        snprintf(path, sizeof path, "scenes/%s", entry->d_name);
        snprintf(name, sizeof name, "%.*s", (int)(ending - entry->d_name), entry->d_name);
        if (is_missing(path)) fprintf(stderr, "%s: its mesh was not fetched\n", name);
        else judge(path, name);
        count++;
    }
    closedir(scenes);
    assert_true(count >= (int)COUNT(expectations));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(every_scene_shows_what_it_is, make_folder, remove_folder),
    };
    return cmocka_run_group_tests_name("scenes drawn", tests, NULL, NULL);
}
