/* Every field of every kind is changed under every method, and has to change the motion or to be refused with words.
 *
 * Nothing here knows a kind: fields, their ranges and defaults come from the catalogue, so a new kind or field is
 * tested without a new line. What a field needs to matter (a velocity to damp, another field that turns it on, a
 * neighbour, a collider ahead) is found by trying small random scenes, at four levels, from the plainest:
 *
 *   0  the object alone with some moving particles, its other fields as by default
 *   1  the same, its other fields at random
 *   2  other forces and colliders besides, at random; its other fields as by default
 *   3  the same, its other fields at random
 *
 * At the first level where a field matters under one method, it has to matter, or be refused, under each: a kernel that
 * only some of the methods run is found so. What of it a graphics card runs has to go there as on the processor, with
 * every field of forces and colliders. And where a field can be set on a living object, that has to lead to the
 * same bits as having built the object with it. */
#include "helpers.h"

#include "all_methods.h"

enum { LEVELS = 4, FEW_TRIALS = 8, TRIALS = 96, STEPS = 2, LOOSE = 8, MOST_FIELDS = 40, MOST_TEXTS = 32 };

/* ---- Fields that move nothing, and why ------------------------------------------------------------ */

static const struct {
    const char *kind, *field, *why; // a kind of NULL: all of them
} idle[] = {
    {NULL, "name", "a label"},
    {NULL, "visible", "for drawing"},
    {NULL, "look", "for drawing"},
    {NULL, "mesh", "a file that scenes read; a program passes the mesh"},
    {"cache", "file", "a file that scenes read; a program passes the places"},
    {"cache", "fps", "of that file; a program says its interval"},
    {"translate", "jump_turn", "it never turns"},
    {NULL, "sleep", "it takes half a second of rest; test_sleep.c"},
    {"attach", "colliders", "it is no moving frame, and says so; test_attach.c"},
    {"attach", "jump_times", "as colliders"},
    {"attach", "to", "there is but one that it can name, which is the default; test_attach.c has several"},
    {"cache", "pull", "the places that are tried are of pins; test_command_run.c has others"},
    {"cache", "max_distance", "as pull"},
    {"cache", "backstop", "as pull"},
    {"cache", "backstop_radius", "as pull"},
    {NULL, "groups", "a body is in them alone here; test_groups.c has rules that name them"},
    {NULL, "map", "as many numbers as it leads; test_leashes.c has them"},
};

static const char *idle_reason(const skein_kind *kind, const skein_field *field) {
    for (size_t i = 0; i < COUNT(idle); i++)
        if ((!idle[i].kind || !strcmp(idle[i].kind, kind->name)) && !strcmp(idle[i].field, field->name))
            return idle[i].why;
    return NULL;
}

/* ---- A kind, and values for its fields ------------------------------------------------------------ */

typedef struct subject {
    const skein_kind *kind;
    const skein_field *fields[MOST_FIELDS]; // its own, then the common ones
    size_t count;
    const char *texts[MOST_FIELDS][MOST_TEXTS]; // those that a text field takes
    size_t text_count[MOST_FIELDS];
    bool parameters; // of formulas
} subject;

/* Texts for whatever takes a text: what selects particles, bodies' names, formulas. A kind's fields take some of them.
 */
static const char *const texts[] = {
    "",
    "a",
    "b",
    "wall",
    "solid",
    "b:c",
    "0",
    "0 1",
    "box -9 -9 -9 0.1 9 9",
    "sphere 0.3 0.3 0.3 0.5",
    "p.y",
    "relative_distance",
    "1-relative_distance",
    "p.y - 0.1",
    "length(p)-0.7",
    "vec3(1, p.x, v.z)",
    "3 * p.y * p.x",
    "length(p0 - p1) - 0.3",
    "(p0.x - p1.y)^2",
    "0 0 0 0, 0.2 1 2 3 10 20 30",
    "0 0.1 0 0 0 9 0, 0.002 1 2 3 10 20 30",
};
/* The same with a parameter. */
static const char *const texts_of_k[] = {"k * p.y - 0.1", "vec3(k, p.x, 0)", "k * (length(p0 - p1) - 0.3)",
                                         "k * (p0.x - p1.x)^2"};

static int number_count(const skein_field *field) {
    switch (field->type) {
    case SKEIN_FIELD_TEXT: return 0;
    case SKEIN_FIELD_INT2:
    case SKEIN_FIELD_REAL2: return 2;
    case SKEIN_FIELD_INT3:
    case SKEIN_FIELD_VEC3: return 3;
    default: return 1;
    }
}

static int random_whole(uint64_t *seed, int count) {
    return (int)random_between(seed, 0, count);
}

/* Around the default where there is one; else over some powers of ten, or all of a short range. */
static double random_real(uint64_t *seed, const skein_field *field, double initial) {
    double size = initial != 0 && isfinite(initial) ? fabs(initial) : 0.1, x;
    bool whole_range = field->most - field->least <= 1000 && random_whole(seed, 2);
    if (whole_range) x = random_between(seed, field->least, field->most);
    else x = size * pow(10, random_between(seed, -2, 2)) * (field->least < 0 && random_whole(seed, 2) ? -1 : 1);
    return fmin(fmax(x, field->least), field->most);
}

/* A text is one of those given, or else the default. */
static skein_value random_value(uint64_t *seed, const skein_field *field, const char *const *of, size_t of_count) {
    skein_value value = {.count = number_count(field)};
    if (field->type == SKEIN_FIELD_TEXT) value.text = of_count ? of[random_whole(seed, (int)of_count)] : field->text;
    for (int i = 0; i < value.count; i++) {
        int choices = 1;
        for (const char *c = field->choices; field->type == SKEIN_FIELD_CHOICE && *c; c++) choices += *c == '|';
        if (field->type == SKEIN_FIELD_CHOICE) value.number[i] = random_whole(seed, choices);
        else if (field->type == SKEIN_FIELD_REAL || field->type == SKEIN_FIELD_REAL2 || field->type == SKEIN_FIELD_VEC3)
            value.number[i] = random_real(seed, field, field->initial[i]);
        else value.number[i] = field->least + random_whole(seed, (int)fmin(field->most - field->least + 1, 9));
    }
    return value;
}

static skein_value random_value_of(uint64_t *seed, const subject *s, size_t f) {
    return random_value(seed, s->fields[f], s->texts[f], s->text_count[f]);
}

static bool same_value(const skein_value *a, const skein_value *b) {
    if (a->count != b->count) return false;
    if (a->count == 0) return !strcmp(a->text ? a->text : "", b->text ? b->text : "");
    for (int i = 0; i < a->count; i++)
        if (a->number[i] != b->number[i]) return false;
    return true;
}

static bool is_kept(const skein_field *field) { // as it is, in every scene
    static const char *const names[] = {"name", "enabled", "visible", "groups", "mesh", "cell", "parameters.*"};
    for (size_t i = 0; i < COUNT(names); i++)
        if (!strcmp(field->name, names[i])) return true;
    return false;
}

/* ---- Scenes ---------------------------------------------------------------------------------------- */

/* One scene, but for the value of one field. */
typedef struct trial {
    const subject *s;
    const char *method;
    int level;
    uint64_t seed;
    int mesh; // 0: none
    double dt;
    skein_setting settings[MOST_FIELDS + 3]; // the other fields; then room for the changed one
    size_t setting_count;
    const char *field; // by its own name: "parameters.k"
} trial;

static const double sheet_points[][3] = {{0, 0, 0},       {0, 0.1, 0.5}, {0, 0, 1},     {0.5, 0, 0},
                                         {0.5, 0.1, 0.5}, {0.5, 0, 1},   {0.505, 0, 0}, {0.5, 0.1, 0.502},
                                         {0.5, 0, 1.01},  {1, 0, 0},     {1, 0.1, 0.5}, {1, 0, 1}};
static const uint32_t sheet_corners[] = {0, 1, 4, 3, 1, 2, 5, 4, 6, 7, 10, 9, 7, 8, 11, 10};
static const double solid_points[][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
static const uint32_t solid_corners[] = {0, 1, 2, 3, 1, 2, 3, 4}, fours[] = {4, 4, 4, 4};

/* A sheet whose seam is of doubled vertices; two tetrahedra. */
static const skein_mesh meshes[] = {{NULL, 0, NULL, 0, NULL, 0},
                                    {&sheet_points[0][0], 12, fours, 4, sheet_corners, 16},
                                    {&solid_points[0][0], 5, fours, 2, solid_corners, 8}};

/* Of colliders that are made from one. */
static const uint32_t triangle_corners[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 4, 2, 3, 4, 1, 4, 3},
                      threes[] = {3, 3, 3, 3, 3, 3};
static const skein_mesh solid_of_triangles = {&solid_points[0][0], 5, threes, 6, triangle_corners, 18};

static const skein_mesh *mesh_of(const skein_kind *kind) {
    return skein_field_find(kind, "mesh", NULL) ? &solid_of_triangles : NULL;
}

/* Some kinds of a category, some of their fields at random. */
static void add_others(skein_world *world, uint64_t *seed, skein_category category, const char *but) {
    const skein_kind *kind;
    for (size_t i = 0; (kind = skein_kind_at(category, i)); i++) {
        skein_setting settings[MOST_FIELDS + 1];
        size_t count = 0;
        for (size_t f = 0; f < kind->field_count; f++)
            if (!is_kept(&kind->fields[f]) && random_whole(seed, 2))
                settings[count++] =
                    (skein_setting){kind->fields[f].name, random_value(seed, &kind->fields[f], NULL, 0)};
        settings[count].name = NULL;
        if (random_whole(seed, 3) || !strcmp(kind->name, but)) continue;
        if (category == SKEIN_FORCE) (void)skein_force_add(world, kind->name, settings, NULL);
        else (void)skein_collider_add_mesh(world, kind->name, mesh_of(kind), settings, NULL);
    }
}

/* Two bodies with names, one of loose particles and one of springs, on which another may lie, and LOOSE particles, two of which are held, as some of
 * the springs' are; the index of the first one. */
static uint32_t add_company(skein_world *world, uint64_t *seed, bool layers) {
    double positions[LOOSE][3] = {{0, 0, 0}, {0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 0.5}}, masses[LOOSE];
    for (int i = 0; i < LOOSE; i++) {
        masses[i] = i < 6 ? random_between(seed, 0.1, 1) : 0;
        for (int k = 0; k < 3; k++) positions[i][k] += random_between(seed, 0, i < 4 ? 0.1 : 0.6);
    }
    uint32_t first;
    OK(world, skein_particles_add(world, LOOSE, &positions[0][0], NULL, masses, &first));
    OK(world, skein_body_add(world, "flock", NULL,
                             SKEIN_SETTINGS(SKEIN_TEXT("name", "a"), SKEIN_REAL("count", 6),
                                            SKEIN_VEC3("spread", 1, 1, 1), SKEIN_REAL("speed", 2)),
                             NULL));
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_TEXT("name", "b"), SKEIN_PAIR("grid", 3, 3),
                                            SKEIN_VEC3("rotation", 30, 20, 10), SKEIN_TEXT("pins", "0 1")),
                             NULL));
    if (!layers) return first;
    OK(world,
       skein_body_add(world, "cloth", NULL,
                      SKEIN_SETTINGS(SKEIN_TEXT("name", "c"), SKEIN_PAIR("grid", 2, 2), SKEIN_PAIR("size", 0.5, 0.5),
                                     SKEIN_VEC3("rotation", 30, 20, 10), SKEIN_VEC3("position", 0, 0.004, 0)),
                      NULL));
    return first;
}

/* Kinds of three particles may want a closed surface: they get a tetrahedron's. */
static skein_status add_constraint(skein_world *world, const trial *t, uint32_t first, const skein_setting *settings,
                                   skein_handle *handle) {
    static const uint32_t faces[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};
    uint32_t particles[12];
    size_t arity;
    skein_status status = skein_constraint_arity(world, t->s->kind->name, settings, &arity);
    if (status) return status;
    size_t count = arity == 3 ? 4 : arity == 0 ? 0 : 12 / arity;
    for (size_t i = 0; i < count * arity; i++)
        particles[i] = first + (arity == 3 ? faces[i] : (uint32_t)(i * 3 / arity + i) % LOOSE);
    if (arity > 3)
        for (size_t i = 0; i < count * arity; i++) particles[i] = first + (uint32_t)(i % arity + i / arity) % LOOSE;
    return skein_constraint_add(world, t->s->kind->name, particles, count, settings, handle);
}

/* Those that are given places get some that they come past within the steps of a trial. */
static skein_status add_motion(skein_world *world, const trial *t, uint32_t first, const skein_setting *settings,
                               skein_handle *handle) {
    enum { SAMPLES = 3, LED = 4 };
    const uint32_t led[LED] = {first + 6, first + 7, first + LOOSE + 6, first + LOOSE + 7}; // and two of the cloth
    double places[SAMPLES][LED][3];
    uint64_t seed = 17;
    for (int i = 0; i < SAMPLES * LED * 3; i++) (&places[0][0][0])[i] = random_between(&seed, -1, 1);
    const skein_track track = {led, &places[0][0][0], LED, SAMPLES, 0.0007};
    OK(world, skein_collider_add(world, "sphere",
                                 SKEIN_SETTINGS(SKEIN_TEXT("name", "wall"), SKEIN_VEC3("centre", 0.3, 0.3, 0.3),
                                                SKEIN_REAL("radius", 0.4)),
                                 NULL));
    OK(world,
       skein_collider_add_mesh(world, "mesh", &solid_of_triangles,
                               SKEIN_SETTINGS(SKEIN_TEXT("name", "solid"), SKEIN_TEXT("on", "a"),
                                              SKEIN_VEC3("motion.velocity", 0.3, 1, 0), SKEIN_REAL("motion.spin", 5)),
                               NULL));
    skein_status status = skein_motion_add(world, t->s->kind->name, NULL, settings, handle);
    return status == SKEIN_ERROR_VALUE ? skein_motion_add(world, t->s->kind->name, &track, settings, handle) : status;
}

static skein_status add_subject(skein_world *world, const trial *t, uint32_t first, const skein_setting *settings,
                                skein_handle *handle) {
    const char *name = t->s->kind->name;
    switch (t->s->kind->category) {
    case SKEIN_BODY: return skein_body_add(world, name, t->mesh ? &meshes[t->mesh] : NULL, settings, handle);
    case SKEIN_CONSTRAINT: return add_constraint(world, t, first, settings, handle);
    case SKEIN_FORCE: return skein_force_add(world, name, settings, handle);
    case SKEIN_COLLIDER: return skein_collider_add_mesh(world, name, mesh_of(t->s->kind), settings, handle);
    case SKEIN_MOTION: return add_motion(world, t, first, settings, handle);
    default:
        if (strcmp(name, t->method)) return SKEIN_ERROR_NAME;
        skein_status status = skein_method_set(world, name, settings);
        *handle = skein_object_at(world, SKEIN_METHOD, 0);
        return status;
    }
}

/* So that nothing is at rest; and everything is now here, now at some distance, for what is only felt there. */
enum { NEAR = 3, FAR = 4 };
static void stir(skein_world *world, uint64_t *seed, int reaches) {
    static const double shifts[FAR] = {0, 0, 2, 80};
    size_t count = skein_particle_count(world);
    double(*x)[3] = malloc(count * sizeof *x), (*v)[3] = malloc(count * sizeof *v);
    double far = random_between(seed, 0, 0.05), fast = pow(10, random_between(seed, -1, 1)), shift[3];
    int reach = random_whole(seed, reaches);
    for (int k = 0; k < 3; k++) shift[k] = random_between(seed, -shifts[reach], shifts[reach]);
    OK(world, skein_positions_copy(world, 0, count, *x));
    OK(world, skein_velocities_copy(world, 0, count, *v));
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            x[i][k] += shift[k] + random_between(seed, -far, far);
            v[i][k] += random_between(seed, -fast, fast);
        }
    OK(world, skein_positions_set(world, 0, count, *x));
    OK(world, skein_velocities_set(world, 0, count, *v));
    free(x);
    free(v);
}

/* The world of a trial with one more setting (or none); NULL, with the status, where it is refused. */
static skein_world *build(const trial *t, const skein_value *value, skein_handle *handle, skein_error *error) {
    skein_world *world = skein_world_create(NULL, NULL);
    assert_non_null(world);
    uint64_t seed = t->seed;
    skein_setting settings[MOST_FIELDS + 3];
    memcpy(settings, t->settings, t->setting_count * sizeof *settings);
    size_t count = t->setting_count;
    if (value) settings[count++] = (skein_setting){t->field, *value};
    settings[count].name = NULL;
    skein_category category = t->s->kind->category;
    uint32_t first = category == SKEIN_BODY ? 0 : add_company(world, &seed, category == SKEIN_FORCE);
    skein_status status = SKEIN_OK;
    if (category != SKEIN_METHOD)
        status = skein_method_set(world, t->method, SKEIN_SETTINGS(SKEIN_REAL("substeps", 2)));
    if (!status) status = add_subject(world, t, first, settings, handle);
    if (t->level >= 2) {
        add_others(world, &seed, SKEIN_FORCE, t->s->kind->name);
        add_others(world, &seed, SKEIN_COLLIDER, t->s->kind->name);
    }
    if (!status) {
        stir(world, &seed, FAR);
        status = skein_world_explain(world, t->dt, NULL, NULL);
    }
    if (!status) return world;
    *error = *skein_world_error(world);
    skein_world_destroy(world);
    return NULL;
}

/* Where the world goes; 0 where it breaks, or refuses. */
static uint64_t go(skein_world *world, double dt, skein_error *error) {
    skein_statistics s = {.nonfinite = 1};
    for (int i = 0; i < STEPS; i++)
        if (skein_world_step(world, dt)) {
            *error = *skein_world_error(world);
            return 0;
        }
    OK(world, skein_world_statistics(world, &s));
    return s.nonfinite ? 0 : s.state_hash;
}

/* ---- One field under one method --------------------------------------------------------------------- */

typedef enum outcome { VOID, REFUSED, IGNORED, MOVED } outcome;

static void make_trial(trial *t, const subject *s, size_t f, const char *method, int level, int number) {
    const skein_field *field = s->fields[f];
    uint64_t seed = (uint64_t)number * 0x9e3779b97f4a7c15u + (uint64_t)level + 1;
    for (int i = 0; i < 4; i++) random_between(&seed, 0, 1);
    *t = (trial){.s = s, .method = method, .level = level, .field = field->name};
    t->mesh = number % 3;
    t->dt = pow(10, random_between(&seed, -3.5, -1.5));
    bool parameter = !strcmp(field->name, "parameters.*");
    for (size_t i = 0; i < s->count; i++) {
        const skein_field *other = s->fields[i];
        bool large = s->kind->category == SKEIN_BODY && other->type == SKEIN_FIELD_INT && other->initial[0] > 32;
        if (i == f || is_kept(other)) continue;
        if (parameter && other->type == SKEIN_FIELD_TEXT && strcmp(other->name, "on") != 0) {
            t->settings[t->setting_count++] =
                (skein_setting){other->name, skein_text(texts_of_k[number % (int)COUNT(texts_of_k)])};
            continue;
        }
        if (!large && (level % 2 == 0 || random_whole(&seed, 2))) continue;
        t->settings[t->setting_count++] = (skein_setting){other->name, random_value_of(&seed, s, i)};
    }
    if (parameter) t->field = "parameters.k";
    t->seed = seed;
}

/* A field that is set later leads to the same bits as one set at once; a collider that is set elsewhere travels there,
 * unless it is said to have been there, and contact that becomes thicker leads apart slowly, unless time jumps. */
static void judge_later(const trial *t, const skein_value *from, const skein_value *to, uint64_t ought) {
    skein_handle handle;
    skein_error error;
    skein_world *world = build(t, from, &handle, &error);
    size_t count = skein_particle_count(world);
    if (!skein_field_is_live(world, handle, t->field)) {
        skein_world_destroy(world);
        return;
    }
    double(*x)[3] = malloc(count * sizeof *x), (*v)[3] = malloc(count * sizeof *v);
    OK(world, skein_positions_copy(world, 0, count, *x));
    OK(world, skein_velocities_copy(world, 0, count, *v));
    OK(world, skein_world_step(world, t->dt));
    OK(world, skein_positions_set(world, 0, count, *x));
    OK(world, skein_velocities_set(world, 0, count, *v));
    OK(world, skein_world_time_set(world, 0));
    if (skein_set(world, handle, t->field, *to)) assert_true(skein_world_error(world)->message[0]);
    else if (t->s->kind->category == SKEIN_COLLIDER && skein_collider_teleport(world, handle))
        fail_msg("%s", skein_world_error(world)->message);
    else if (t->s->kind->category == SKEIN_FORCE && skein_world_time_set(world, 0))
        fail_msg("%s", skein_world_error(world)->message);
    else if (go(world, t->dt, &error) != ought)
        fail_msg("%s.%s under %s: set later it leads elsewhere", t->s->kind->name, t->field, t->method);
    skein_world_destroy(world);
    free(x);
    free(v);
}

static outcome run_trial(const trial *t, size_t f, int number) {
    const skein_field *field = t->s->fields[f];
    uint64_t seed = t->seed ^ 0x5bd1e995;
    skein_value from = random_value_of(&seed, t->s, f), to = random_value_of(&seed, t->s, f);
    bool first = number % 2 == 0 && strcmp(field->name, "parameters.*"); // from the default
    if (first || !strcmp(field->name, "enabled")) {
        from = (skein_value){.count = number_count(field), .text = field->text};
        memcpy(from.number, field->initial, sizeof from.number);
    }
    for (int i = 0; same_value(&from, &to) && i < 20; i++) to = random_value_of(&seed, t->s, f);
    skein_handle handle;
    skein_error error = {SKEIN_OK, "", ""};
    skein_world *world = build(t, &from, &handle, &error);
    uint64_t before = world ? go(world, t->dt, &error) : 0;
    skein_world_destroy(world);
    if (!before) return VOID;
    error = (skein_error){SKEIN_OK, "", ""};
    world = build(t, &to, &handle, &error);
    uint64_t after = world ? go(world, t->dt, &error) : 0;
    skein_world_destroy(world);
    if (error.status) return error.message[0] ? REFUSED : IGNORED;
    if (!after) return VOID;
    if (after == before) return IGNORED;
    judge_later(t, &from, &to, after);
    return MOVED;
}

/* A method's fields are its own. */
static bool has_method(const subject *s, const char *method) {
    return s->kind->category != SKEIN_METHOD || !strcmp(s->kind->name, method);
}

/* The best outcome of some scenes, from number `*start` on; that becomes the one where the field mattered. */
static outcome try_field(const subject *s, size_t f, const char *method, int level, int trials, int *start) {
    outcome best = VOID;
    for (int i = 0; i < trials; i++) {
        int number = (*start + i) % TRIALS;
        trial t;
        make_trial(&t, s, f, method, level, number);
        outcome o = run_trial(&t, f, number);
        if (o > best) best = o;
        if (o == MOVED) {
            *start = number;
            break;
        }
    }
    return best;
}

/* The best outcome under any method. */
static outcome try_methods(const subject *s, size_t f, int level, int *start) {
    outcome best = VOID;
    for (size_t m = 0; m < COUNT(all_methods) && best != MOVED; m++) { // each in other scenes
        *start = (int)m * FEW_TRIALS;
        outcome o = has_method(s, all_methods[m]) ? try_field(s, f, all_methods[m], level, FEW_TRIALS, start) : VOID;
        if (o > best) best = o;
    }
    return best;
}

/* Whether cloth that is tried seldom does what the field is for: it rubs at itself by luck. test_fabrics.c has some that slides. */
static bool is_seldom(const char *kind, const char *field) {
    return !strcmp(kind, "cloth") && !strcmp(field, "contact.friction");
}

/* Whether a field says that it is for other methods. */
static bool is_for_others(const char *kind, const char *field, const char *method) {
    return !strcmp(kind, "contact") && !strcmp(field, "more_substeps") && strcmp(method, "xpbd") != 0 &&
           strcmp(method, "pbd") != 0;
}

/* How many faults the field has. */
static int judge_field(const subject *s, size_t f) {
    const char *why = idle_reason(s->kind, s->fields[f]), *kind = s->kind->name, *field = s->fields[f]->name;
    int faults = 0, level = 0, start = 0;
    outcome best = VOID, here = VOID;
    for (; level < LEVELS && (here = try_methods(s, f, level, &start)) != MOVED; level++)
        if (here > best) best = here;
    if (why) {
        if (level < LEVELS) fprintf(stderr, "%s.%s: it has an effect, and the list says: %s\n", kind, field, why);
        return level < LEVELS;
    }
    if (level == LEVELS && (best == REFUSED || is_seldom(kind, field))) return 0; // refused wherever it was given
    if (level == LEVELS) fprintf(stderr, "%s.%s: no effect under any method\n", kind, field);
    for (size_t m = 0; m < COUNT(all_methods) && level < LEVELS; m++) {
        if (!has_method(s, all_methods[m]) || is_seldom(kind, field) || is_for_others(kind, field, all_methods[m]))
            continue;
        if (try_field(s, f, all_methods[m], level, TRIALS, &start) != IGNORED) continue;
        fprintf(stderr, "%s.%s: no effect under %s (level %d)\n", kind, field, all_methods[m], level);
        faults++;
    }
    return faults + (level == LEVELS);
}

/* ---- All of them ------------------------------------------------------------------------------------- */

static void find_texts(subject *s, size_t f) {
    for (size_t i = 0; i < COUNT(texts); i++)
        for (int number = 0; number < 3; number++) {
            trial t;
            skein_handle handle;
            skein_error error;
            make_trial(&t, s, f, "symplectic_euler", 0, number);
            const skein_value value = skein_text(texts[i]);
            skein_world *world = build(&t, &value, &handle, &error);
            skein_world_destroy(world);
            if (!world) continue;
            s->texts[f][s->text_count[f]++] = texts[i];
            break;
        }
}

static void make_subject(subject *s, const skein_kind *kind) {
    size_t count;
    const skein_field *common = skein_common_fields(kind->category, &count);
    *s = (subject){.kind = kind};
    assert_true(kind->field_count + count <= MOST_FIELDS);
    for (size_t i = 0; i < kind->field_count; i++) s->fields[s->count++] = &kind->fields[i];
    for (size_t i = 0; i < count; i++) s->fields[s->count++] = &common[i];
    for (size_t i = 0; i < s->count; i++)
        if (s->fields[i]->type == SKEIN_FIELD_TEXT && !is_kept(s->fields[i])) find_texts(s, i);
}

static void judge_category(skein_category category) {
    int faults = 0;
    const skein_kind *kind;
    for (size_t i = 0; (kind = skein_kind_at(category, i)); i++) {
        subject s;
        make_subject(&s, kind);
        for (size_t f = 0; f < s.count; f++) faults += judge_field(&s, f);
    }
    assert_int_equal(faults, 0);
}

static void fields_of_bodies(void **state) {
    (void)state;
    ONLY_IN_PLAIN_BUILDS();
    judge_category(SKEIN_BODY);
}

static void fields_of_constraints(void **state) {
    (void)state;
    ONLY_IN_PLAIN_BUILDS();
    judge_category(SKEIN_CONSTRAINT);
}

static void fields_of_forces(void **state) {
    (void)state;
    ONLY_IN_PLAIN_BUILDS();
    judge_category(SKEIN_FORCE);
}

static void fields_of_colliders(void **state) {
    (void)state;
    ONLY_IN_PLAIN_BUILDS();
    judge_category(SKEIN_COLLIDER);
}

static void fields_of_motions(void **state) {
    (void)state;
    ONLY_IN_PLAIN_BUILDS();
    judge_category(SKEIN_MOTION);
}

static void fields_of_methods(void **state) {
    (void)state;
    ONLY_IN_PLAIN_BUILDS();
    judge_category(SKEIN_METHOD);
}

/* ---- On a card -------------------------------------------------------------------------------------- */

/* A trial's scene of loose particles, which is what cards know; NULL where it is refused. */
static skein_world *build_loose(const trial *t, const skein_value *value) {
    skein_world *world = skein_world_create(NULL, NULL);
    uint64_t seed = t->seed;
    skein_setting settings[MOST_FIELDS + 3];
    skein_handle handle;
    memcpy(settings, t->settings, t->setting_count * sizeof *settings);
    settings[t->setting_count] = (skein_setting){t->field, *value};
    settings[t->setting_count + 1].name = NULL;
    for (int i = 0; i < 2; i++)
        OK(world, skein_body_add(world, "flock", NULL,
                                 SKEIN_SETTINGS(SKEIN_TEXT("name", i ? "b" : "a"), SKEIN_REAL("count", 12),
                                                SKEIN_VEC3("spread", 1, 1, 1), SKEIN_REAL("speed", 2)),
                                 NULL));
    skein_status status = skein_method_set(world, t->method, SKEIN_SETTINGS(SKEIN_REAL("substeps", 2)));
    if (!status) status = add_subject(world, t, 0, settings, &handle);
    if (!status && t->s->kind->category == SKEIN_FORCE)
        OK(world, skein_collider_add(world, "sphere", SKEIN_SETTINGS(SKEIN_REAL("radius", 0.3)), NULL));
    else if (!status) OK(world, skein_force_add(world, "gravity", NULL, NULL));
    stir(world, &seed, NEAR); // far off, floats of a card tell little
    if (!status) return world;
    skein_world_destroy(world);
    return NULL;
}

/* How far any position or velocity is off, as a part of the largest of them, or of 1. */
static double farthest(const skein_world *one, const skein_world *other) {
    size_t count = 6 * skein_particle_count(one);
    double *a = malloc(2 * count * sizeof *a), *b = a + count, worst = 0, size = 1;
    OK(one, skein_positions_copy(one, 0, count / 6, a));
    OK(one, skein_velocities_copy(one, 0, count / 6, a + count / 2));
    OK(other, skein_positions_copy(other, 0, count / 6, b));
    OK(other, skein_velocities_copy(other, 0, count / 6, b + count / 2));
    for (size_t i = 0; i < count; i++) {
        size = fmax(size, fabs(a[i]));
        if (!(fabs(a[i] - b[i]) <= worst)) worst = fabs(a[i] - b[i]);
    }
    free(a);
    return worst / size;
}

typedef enum on_card { NOTHING_TO_SEE, CANNOT, AGREES, IS_OFF } on_card;

/* Changes the field on the processor, and holds the card against it. */
static on_card try_on_card(const trial *t, size_t f) {
    const double tolerance = 1e-4;
    uint64_t seed = t->seed ^ 0x5bd1e995;
    skein_value from = random_value_of(&seed, t->s, f), to = random_value_of(&seed, t->s, f);
    for (int i = 0; same_value(&from, &to) && i < 20; i++) to = random_value_of(&seed, t->s, f);
    skein_world *before = build_loose(t, &from), *after = build_loose(t, &to), *card = build_loose(t, &to);
    on_card result = NOTHING_TO_SEE;
    bool ran = before && after && card && !skein_world_step(before, t->dt) && !skein_world_step(after, t->dt);
    double effect = ran ? farthest(before, after) : 0;
    if (effect > 20 * tolerance) {
        OK(card, skein_world_device_set(card, SKEIN_DEVICE_GPU));
        if (skein_world_step(card, t->dt)) {
            assert_non_null(strstr(skein_world_error(card)->message, "graphics card"));
            result = CANNOT;
        } else {
            result = farthest(after, card) <= fmax(tolerance, 0.01 * effect) ? AGREES : IS_OFF;
        }
    }
    skein_world_destroy(before);
    skein_world_destroy(after);
    skein_world_destroy(card);
    return result;
}

/* Particles may be just about to touch, and do so on one side only, or slide so little that the way of it is rounding:
 * then other scenes agree. */
static int judge_on_card(const subject *s, size_t f, const char *method) {
    enum { ENOUGH = 2 };
    int agreed = 0, off = 0;
    for (int number = 0; number < TRIALS && agreed < ENOUGH; number++) {
        trial t;
        make_trial(&t, s, f, method, number % 2, number);
        on_card result = try_on_card(&t, f);
        if (result == CANNOT) return 0;
        agreed += result == AGREES;
        off += result == IS_OFF;
    }
    if (agreed || !off) return 0;
    fprintf(stderr, "%s.%s under %s: the card goes elsewhere\n", s->kind->name, s->fields[f]->name, method);
    return 1;
}

static void fields_on_a_card(void **state) {
    (void)state;
    ONLY_IN_PLAIN_BUILDS();
    static const skein_category categories[] = {SKEIN_FORCE, SKEIN_COLLIDER};
    static const char *const methods[] = {"xpbd", "symplectic_euler"};
    skein_world *world = skein_world_create(NULL, NULL);
    bool none = skein_world_device_set(world, SKEIN_DEVICE_GPU);
    if (none) fprintf(stderr, "skipped: %s\n", skein_world_error(world)->message);
    skein_world_destroy(world);
    if (none) skip();
    int faults = 0;
    const skein_kind *kind;
    for (size_t c = 0; c < COUNT(categories); c++)
        for (size_t i = 0; (kind = skein_kind_at(categories[c], i)); i++) {
            subject s;
            make_subject(&s, kind);
            for (size_t f = 0; f < s.count; f++)
                for (size_t m = 0; m < COUNT(methods) && !idle_reason(kind, s.fields[f]); m++)
                    faults += judge_on_card(&s, f, methods[m]);
        }
    assert_int_equal(faults, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fields_of_bodies),  cmocka_unit_test(fields_of_constraints),
        cmocka_unit_test(fields_of_forces),  cmocka_unit_test(fields_of_colliders),
        cmocka_unit_test(fields_of_motions), cmocka_unit_test(fields_of_methods),
        cmocka_unit_test(fields_on_a_card),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
