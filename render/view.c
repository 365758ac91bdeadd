/* The settings of a view; see view.h. */
#include "render/view.h"

#include <stddef.h>
#include <string.h>

// clang-format off
#define BOOL(member, name, initial, help)                                                                     \
    {name, SKEIN_FIELD_BOOL, offsetof(render_view, member), "", {initial, 0, 0}, 0, 1, NULL, NULL, help}
#define REAL(member, name, unit, initial, least, most, help)                                                  \
    {name, SKEIN_FIELD_REAL, offsetof(render_view, member), unit, {initial, 0, 0}, least, most, NULL, NULL, help}
#define VECTOR(member, name, unit, x, y, z, help)                                                             \
    {name, SKEIN_FIELD_VEC3, offsetof(render_view, member), unit, {x, y, z}, -1e15, 1e15, NULL, NULL, help}
#define CHOICE(member, name, words, help)                                                                     \
    {name, SKEIN_FIELD_CHOICE, offsetof(render_view, member), "", {0, 0, 0}, 0, 0, words, NULL, help}

static const skein_field fields[] = {
    CHOICE(shading, "shading", "beautiful|plain",
           "beautiful: a sun with soft shadows, and the sky's light; plain: Blinn-Phong without shadows"),
    BOOL(surface, "surface", 1, "the bodies' surfaces, and ropes"),
    BOOL(wireframe, "wireframe", 0, "the edges of the bodies' faces, as lines"),
    BOOL(springs, "springs", 0, "every spring as a line, coloured by its strain"),
    BOOL(constraints, "constraints", 0, "what is no part of a body, as lines through its particles: formulas, single springs"),
    BOOL(gradients, "gradients", 0, "of the same, at each particle an arrow: where the constraint's value grows, and by how much"),
    CHOICE(particles, "particles", "loose|all|none", "as balls: those in no surface or rope, all of them, or none"),
    BOOL(birds, "birds", 1, "flocks as birds, whose wings beat; else as balls"),
    BOOL(pins, "pins", 1, "pinned particles of a surface, as small dark balls"),
    BOOL(normals, "normals", 0, "the surfaces' normals, as lines"),
    BOOL(velocities, "velocities", 0, "the particles' velocities, as lines"),
    BOOL(contacts, "contacts", 0, "where particles touch colliders, as lines along the collider's normal"),
    BOOL(fields, "fields", 1, "force fields and potentials by formula, as arrows; the strongest is as long as they lie apart"),
    BOOL(colliders, "colliders", 1, "all but level planes, which are ground"),
    BOOL(ground, "ground", 1, "the ground: a level plane, or one of no effect where there is none"),
    BOOL(grid, "grid", 1, "lines on the ground; a cell is 1, 2 or 5 times a power of ten metres wide"),
    BOOL(axes, "axes", 0, "x (red), y (green) and z (blue) at the origin, a cell of the grid long"),
    CHOICE(colour, "colour", "material|body|speed|strain|direction",
           "what colours tell: the material, which body it is, its speed, how far its springs are from rest, or where birds fly: towards +z red, else blue"),
    REAL(range, "range", "", 0, 0, 1e15,
         "the speed (m/s) or strain at the end of the colours; 0: the largest in the picture"),
    CHOICE(pattern, "pattern", "suited|weave|checker|none", "on surfaces, by texture coordinates: the mesh's, a grid's, or else projected from a box; suited: as each body's `look` says"),
    {"image", SKEIN_FIELD_TEXT, offsetof(render_view, image), "path", {0, 0, 0}, 0, 0, NULL, "",
     "a PNG or JPEG laid on surfaces instead of the pattern"},
    REAL(repeats, "repeats", "", 0, 0, 1e4, "how often the pattern or image repeats along the longer side; 0: as suits"),
    REAL(particle_radius, "particle_radius", "m", 0, 0, 1e15, "of the balls, and of ropes; 0: as suits the scene"),
    REAL(line_width, "line_width", "pixels", 1.4, 0.1, 100, "of wireframes, springs and other lines"),
    REAL(velocity_scale, "velocity_scale", "s", 0.05, 0, 1e15, "a velocity's line is the way of so much time"),
    REAL(gradient_scale, "gradient_scale", "m", 0, 0, 1e15, "how long the arrow of a gradient of 1 is; 0: as suits the picture"),
    VECTOR(sun, "sun", "", -0.62, 0.86, 0.42, "the direction to the sun"),
    REAL(exposure, "exposure", "", 1, 0.01, 100, "how bright the picture is"),
    VECTOR(camera.from, "camera.from", "m", 0, 0, 0,
           "where the eye is; the same as camera.at: the camera frames the scene by itself"),
    VECTOR(camera.at, "camera.at", "m", 0, 0, 0, "what the eye looks at, where camera.from is given"),
    REAL(camera.fov, "camera.fov", "degrees", 34, 1, 150, "from the picture's bottom to its top"),
    REAL(camera.azimuth, "camera.azimuth", "degrees", 27, -1e4, 1e4,
         "which side a camera that frames by itself looks from: 0 is +z, 90 is +x"),
    REAL(camera.elevation, "camera.elevation", "degrees", 14, -89, 89, "and how high above the level; at 14 higher where a level sheet, which lies high, would be seen on its edge"),
    REAL(camera.orbit, "camera.orbit", "degrees/s", 0, -1e4, 1e4, "turns the camera about what it looks at, with the scene's time"),
    REAL(camera.zoom, "camera.zoom", "", 1, 0.01, 100, "how large things are in a picture that frames itself"),
    {"camera.follow", SKEIN_FIELD_TEXT, offsetof(render_view, camera.follow), "body", {0, 0, 0}, 0, 0, NULL, "",
     "the body that the camera goes along with: its name, or its number from 0; \"all\": the middle of all bodies"},
};
// clang-format on

enum { FIELD_COUNT = sizeof fields / sizeof *fields };

const skein_kind *render_view_kind(void) {
    static const skein_kind kind = {"view",      "how pictures are drawn", SKEIN_VIEW, fields,
                                    FIELD_COUNT, sizeof(render_view)};
    return &kind;
}

/* The struct that the table describes, filled from it. */
render_view render_view_default(void) {
    static char nothing[1] = "";
    render_view view;
    memset(&view, 0, sizeof view);
    for (size_t i = 0; i < FIELD_COUNT; i++) {
        char *at = (char *)&view + fields[i].offset;
        switch (fields[i].type) {
        case SKEIN_FIELD_BOOL: *(bool *)at = fields[i].initial[0] != 0; break;
        case SKEIN_FIELD_CHOICE: *(int32_t *)(void *)at = (int32_t)fields[i].initial[0]; break;
        case SKEIN_FIELD_REAL: memcpy(at, fields[i].initial, sizeof(double)); break;
        case SKEIN_FIELD_VEC3: memcpy(at, fields[i].initial, 3 * sizeof(double)); break;
        default: *(char **)(void *)at = nothing; break; // a text
        }
    }
    return view;
}
