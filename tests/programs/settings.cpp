// Every way in which a C++ program may give settings: what was written is what the world has. 0 if so.
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <skein/names.h>
#include <skein/skein.h>

static int faults;

static void expect(const skein_world *world, const char *path, double x, double y = 0, double z = 0) {
    skein_value v;
    bool good = skein_get_path(world, path, &v) == SKEIN_OK && v.number[0] == x && v.number[1] == y && v.number[2] == z;
    if (!good) std::printf("%s = %g %g %g, not %g %g %g\n", path, v.number[0], v.number[1], v.number[2], x, y, z);
    faults += !good;
}

static void need(const skein_world *world, skein_status status) {
    if (!status) return;
    std::printf("%s: %s\n", skein_world_error(world)->where, skein_world_error(world)->message);
    faults++;
}

// what a list becomes on its way through somebody else's functions
static skein_status add_ball(skein_world *world, const skein_setting *settings) {
    return skein_collider_add(world, SKEIN_SPHERE, settings, nullptr);
}
template <typename settings_> static settings_ passed(const settings_ &settings) {
    return settings;
}
static auto breeze(double strength) {
    return SKEIN_SETTINGS(SKEIN_VEC3(SKEIN_SURFACE_WIND_VELOCITY, strength, 0, 5 * strength), SKEIN_REAL("drag", 3));
}
// leaves other numbers where the temporaries of a line that is over were
static double scribble(int depth) {
    volatile double numbers[64];
    for (int i = 0; i < 64; i++) numbers[i] = 77 + depth;
    return depth ? scribble(depth - 1) + numbers[7] : numbers[3];
}

int main(int argc, char **) {
    const int n = argc + 4;       // 5: no constant, as the compiler sees it
    const float radius = 0.25f * static_cast<float>(argc);
    skein_world *world = skein_world_create(nullptr, nullptr);
    skein_handle cloth;
    // given where they are used
    need(world, skein_body_add(world, SKEIN_CLOTH, nullptr,
                               SKEIN_SETTINGS(SKEIN_PAIR(SKEIN_CLOTH_GRID, n, n + 1), SKEIN_TEXT("pins", "corners"),
                                              SKEIN_REAL(SKEIN_CLOTH_STRETCH_STIFFNESS, 1000 * n)),
                               &cloth));
    need(world, skein_method_set(world, "xpbd", SKEIN_SETTINGS(SKEIN_REAL(SKEIN_XPBD_SUBSTEPS, n))));
    const uint32_t pair[] = {0, 1};
    need(world, skein_constraint_add(world, "distance", pair, 1, SKEIN_SETTINGS(SKEIN_REAL("stiffness", n * 0.5)), nullptr));
    size_t arity = 0;
    need(world, skein_constraint_arity(world, "formula", SKEIN_SETTINGS(SKEIN_TEXT("constraint", "length(p0 - p2) - 1")),
                                       &arity));
    // kept: as a value, as an array, as a value from a function, copied, and with a pointer to what stays
    auto wind = SKEIN_SETTINGS(SKEIN_VEC3("velocity", 0.5, 0, 0.5 * n), SKEIN_REAL("drag", 3));
    const skein_setting ball[] = {SKEIN_VEC3(SKEIN_SPHERE_CENTRE, 0, 0.9, -0.8), SKEIN_REAL("radius", radius), SKEIN_END};
    const auto from_function = breeze(n);
    auto copied = passed(wind);
    const skein_setting *pointer = wind;
    if (scribble(9) < 0) return 1;
    need(world, skein_force_add(world, "surface_wind", wind, nullptr));
    need(world, skein_force_add(world, "surface_wind", from_function, nullptr));
    need(world, skein_force_add(world, "surface_wind", copied, nullptr));
    need(world, skein_force_add(world, "surface_wind", pointer, nullptr));
    need(world, skein_collider_add(world, "sphere", ball, nullptr));
    need(world, add_ball(world, ball));
    const auto far_off = SKEIN_SETTINGS(SKEIN_VEC3("centre", n, n, n));
    need(world, add_ball(world, far_off));
    need(world, add_ball(world, SKEIN_SETTINGS(SKEIN_REAL("radius", n)).list)); // as long as the line
    // none
    need(world, skein_force_add(world, "gravity", nullptr, nullptr));
    need(world, skein_force_add(world, "gravity", NULL, NULL));
    need(world, skein_force_add(world, "gravity", SKEIN_SETTINGS(), nullptr));

    expect(world, "bodies.0.grid", 5, 6), expect(world, "bodies.0.stretch.stiffness", 5000);
    expect(world, "method.substeps", 5), expect(world, "constraints.0.stiffness", 2.5);
    expect(world, "forces.0.velocity", 0.5, 0, 2.5), expect(world, "forces.0.drag", 3);
    expect(world, "forces.1.velocity", 5, 0, 25), expect(world, "forces.1.drag", 3);
    expect(world, "forces.2.velocity", 0.5, 0, 2.5), expect(world, "forces.3.velocity", 0.5, 0, 2.5);
    for (const char *path : {"colliders.0.centre", "colliders.1.centre"}) expect(world, path, 0, 0.9, -0.8);
    for (const char *path : {"colliders.0.radius", "colliders.1.radius"}) expect(world, path, 0.25);
    expect(world, "colliders.2.centre", 5, 5, 5), expect(world, "colliders.3.radius", 5);
    faults += arity != 3 || skein_object_count(world, SKEIN_FORCE) != 7 || !skein_handle_valid(world, cloth);
    skein_world_destroy(world);
    return faults != 0;
}
