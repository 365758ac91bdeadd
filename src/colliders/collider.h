/* Colliders: solid shapes that particles may not enter, and how contact answers.
 *
 * A *type* is one file: its fields, where it stands, and `probe`, the signed distance and unit normal
 * of many particles. What contact does is the same for all types (contact.c), in the four kernels
 * that methods put into their plans. Particles touch when their distance is under the thickness. */
#ifndef SK_COLLIDERS_COLLIDER_H
#define SK_COLLIDERS_COLLIDER_H

#include "base/fields.h"
#include "base/frame.h"
#include "base/wide_types.h"
#include "formula/parameters.h"
#include "plan/op.h"
#include "plan/shader.h"

/* Where a collider stands at a time, and how it moves there. */
typedef struct sk_pose {
    sk_vec3 position;
    real rotation[9]; /* rows of the matrix that turns the shape as built into the shape now */
    sk_vec3 axis;     /* the shape's own direction, where it has one */
    sk_vec3 velocity; /* of `position`, m/s */
    sk_vec3 spin;     /* angular velocity, rad/s */
    double time;      /* s */
} sk_pose;

/* Of as many particles as a vector has. */
typedef struct sk_contact {
    sk_wide3 normal;  /* unit, out of the solid */
    sk_wide distance; /* to the surface, negative inside */
    sk_wide speed;    /* of the surface along the normal, besides the pose's motion; only of types that deform */
    sk_wide3 slide;   /* and what it has besides, along itself; only of types that a program may lead (`changes`) */
} sk_contact;

typedef void sk_probe(const void *params, const sk_pose *pose, const sk_wide3 *p, sk_contact *contact);
/* The same where only what is within `reach` (m; below 0: nothing is) or inside counts: else the distance may be anything
 * beyond it. */
typedef void sk_probe_near(const void *params, const sk_pose *pose, const sk_wide3 *p, const sk_wide *reach,
                           sk_contact *contact);

/* What is wrong with a mesh that is taken all the same, in words; "": nothing. */
typedef struct sk_faults_text {
    char text[320];
} sk_faults_text;

/* What every collider has besides its shape. */
typedef struct sk_collider_common {
    char *name, *on;
    bool enabled, visible;
    double thickness, friction, restitution, recovery;
    double velocity[3], axis[3], spin, start;
} sk_collider_common;

/* How contact finds out whether a way leads through the solid. */
typedef enum sk_passing {
    SK_NEVER_PASSED, /* there is no other side: a half space, the outside of a ball */
    SK_CONVEX,       /* the solid is behind the plane at its nearest point */
    SK_ANY_SHAPE,
} sk_passing;

typedef struct sk_collider_type {
    skein_kind kind;
    /* NULL if the parameters are good as they are. */
    skein_status (*check)(const void *params, skein_error *error);
    /* The shape's own point: a sphere's centre, a point of a plane. */
    void (*place)(const void *params, double position[3]);
    /* Its own unit direction before any motion: a plane's normal, a capsule's line; NULL: it has none. */
    void (*axis)(const void *params, double unit[3]);
    /* Rows of the matrix that turns the shape before any motion; NULL: it is not turned. */
    void (*turn)(const void *params, double rotation[9]);
    /* The collider's mass, which then says how particles bounce, or 0; NULL: it has none. */
    double (*mass)(const void *params);
    /* Distance and normal of a vector of particles; a version for each instruction set, which its own kernels call. */
    sk_probe *probe[SK_ISA_COUNT];
    sk_probe_near *near[SK_ISA_COUNT]; /* NULL where `probe` costs little anyway */
    bool deforms;                      /* its surface moves by itself, too */
    /* What it looks like, into a shape that is zero before; NULL: its surface is found by `probe`. */
    void (*shape)(const void *params, skein_shape *shape);
    /* Whether a value at x had to be guarded (formula/graph.h): for the statistics; NULL: there is nothing to guard. */
    bool (*guarded)(const void *params, const sk_pose *pose, const double x[3]);
    const sk_making *making; /* what is made from its texts; NULL: nothing */
    /* Of types that are made from a mesh, with `making` to unmake it, else NULL: makes it from the mesh, or fails where that is NULL. */
    skein_status (*take)(void *params, const skein_mesh *mesh, sk_allocator *allocator, sk_faults_text *faults,
                         skein_error *error);
    /* Of types whose surface a program may lead somewhere, else NULL: a step begins; whether it ever did, so that each substep has to
     * ask, and where it is then. */
    void (*begin)(const void *params, double time, double dt);
    bool (*changes)(const void *params);
    void (*follow)(const void *params, double time);
    void (*stop)(const void *params);      /* it is where it was led to, at once */
    double (*fastest)(const void *params); /* what of it is led fastest in the present step, m/s */
    sk_passing passing;
    /* Of types that know better than their probes do where they are passed, else NULL: where the way from a to b first crosses the surface, as
     * a part of it, over 1 where it does not, and the unit normal on the side of a; and a ball that the surface is in. */
    double (*cross)(const void *params, const sk_pose *pose, const double a[3], const double b[3], double normal[3]);
    void (*ball)(const void *params, const sk_pose *pose, sk_vec3 *middle, real *radius);
    bool (*is_shaped_by)(const char *field); /* whether a field counts only then; NULL: none does */
    struct sk_trimesh *(*surface)(
        const void *params); /* its triangles, for whoever draws, moves or sits on them; NULL: it has none */
    double (*scale)(const void *params); /* of types with a surface: the factor on its coordinates */
    /* Of arithmetic: see colliders/shape.h. A file defines vec4 probe@(vec3 p): the unit normal out of the solid, and the distance in w; and, where the surface
     * moves by itself, DEFORMS@ and float speed@, what it has along the normal then. What every collider has is pose@
     * (colliders/pose.glsl). */
    sk_shader shader;
} sk_collider_type;

/* A way that is made in a step because fields were set before it (pose.c). */
typedef struct sk_travel {
    bool noted, changed; /* a field was set since the last step, and it stands elsewhere by that */
    bool ever;           /* it has once */
    double position[3], rotation[9], direction[3], own[15]; /* as it stood before, and what its own fields said */
    bool moving;                                            /* in the step that began at `start`: */
    double way[3], axis[3], angle, start, dt;               /* from the end of the step back to its start */
} sk_travel;

typedef struct sk_collider {
    const sk_collider_type *type;
    const void *params;
    const sk_collider_common *common;
    const char *label;
    double warned_mass; /* that it was too light was said when its mass was this */
    sk_travel travel;
    bool led;       /* it stands in a frame that moves: */
    sk_frame frame; /* where that puts it, after its own fields, at the end of the present step */
    sk_only only;   /* whom it meets, found when a plan is written */
} sk_collider;

/* Fields of sk_collider_common. */
extern const skein_field sk_collider_fields[];
extern const size_t sk_collider_field_count;

sk_pose sk_collider_pose_at(const sk_collider *collider, double time);
/* As its fields alone say, by no frame, before they were set since the last step. */
sk_pose sk_collider_pose_unled(const sk_collider *collider, double time);
/* Where its own fields put it, without any motion: its point, how it is turned, its direction. */
void sk_collider_own_place(const sk_collider *collider, double own[static 15]);
/* Around a change of its fields at `time`: before it and after it. True when from now on it may stand elsewhere in
 * every substep. */
void sk_collider_note(sk_collider *collider, double time);
bool sk_collider_changed(sk_collider *collider);
/* A step begins: it sets out for where its fields have put it since the last one, or rests. */
void sk_collider_begin(sk_collider *collider, double time, double dt);
/* Before a step begins at `time`, the frame that it is led by: where it is now, what of the step's way is no way, but where
 * the collider begins (it is carried), and where it is at the end. */
void sk_collider_lead(sk_collider *collider, double time, const sk_frame *now, const sk_frame *carried,
                      const sk_frame *end);
/* It is where its fields say, at once. */
void sk_collider_stop(sk_collider *collider);
/* Whether it may stand elsewhere in every substep. */
bool sk_collider_moves(const sk_collider *collider);
/* The collider's mass, 0 where it has none: particles then bounce by its restitution. */
double sk_collider_mass(const sk_collider *collider);

/* Force methods: cancels the inward part of F and adds Coulomb friction that never reverses a slide. */
extern const sk_kernels sk_contact_force;
/* Force methods: reflects and rubs the inward part of V. */
extern const sk_kernels sk_contact_impulse;
/* All methods: moves X out to the thickness. With a second source (X0), friction against it. */
extern const sk_kernels sk_contact_push;
/* Position methods, once V has followed X: pushes X out with friction against X0, the second source, and gives V
 * the same move, and the bounce that V0, the third source, had coming. */
extern const sk_kernels sk_contact_update;
/* Position methods, while limits are still swept: finds who is pushed out, by which normal (SUPPORT) and to where (T0, and on by T1); and holds
 * him there, for all colliders at once, with friction. An update with a second coefficient of 1 leaves these planes for the next substep. */
extern const sk_kernels sk_contact_find_held, sk_contact_hold;
/* Nobody is held; with a coefficient of 1 only in a step's first substep. */
sk_op_kernel sk_contact_let_go;
/* Implicit methods: what a collider holds through the substep, as a filter in dst and the second source (xx yy zz and
 * xy xz yz), friction added to the third, and V as it is held. */
extern const sk_kernels sk_contact_filter;
/* The same for what has come inside since, X being where V leads from X0. */
extern const sk_kernels sk_contact_filter_more;

/* Of types with `cross`, before those that answer at the end of a substep: stops X where its way from X0, the second source, crosses the
 * surface. With a first coefficient of 1 friction takes its share, and V gets the same move. */
extern const sk_kernels sk_contact_sweep;
typedef struct sk_swept {
    const sk_collider *collider;
    sk_pose pose;  /* at the end */
    real turn[9];  /* what the collider did to points that go along with it, */
    sk_vec3 shift; /* and then this */
    bool moves, rubs;
    sk_vec3 middle; /* of the ball that its surface is in, */
    real radius;    /* and the thickness */
} sk_swept;
sk_swept sk_swept_begin(const sk_collider *collider, double from, double to, bool rubs);
/* Whether the way from `start`, as the collider sees it, to x crosses the surface; x is then where it ends. */
bool sk_swept_stop(const sk_swept *sweep, const double start[3], double x[3]);

/* Once a substep, by one thread: the surface of a collider that changes is where it is at the end. */
extern sk_op_kernel sk_contact_follow;

/* Rules that look out: adds to S, for the op's group. */
extern const sk_kernels sk_avoid;

/* Whether contact with this collider looks at F after the velocity update: what bounces must know what weighs. */
bool sk_contact_reads_force(const sk_collider *collider);

/* Deepest penetration below the thickness (m) and the number of particles in touch. */
void sk_collider_measure(const sk_collider *collider, double time, sk_isa isa, const sk_vec4 *x,
                         const uint32_t *slot_of, size_t particle_count, double *penetration, size_t *contacts);

/* How many of the free particles had to be guarded against at the present state. */
size_t sk_collider_count_guarded(const sk_collider *collider, double time, const sk_vec4 *x, const uint32_t *slot_of,
                                 size_t particle_count);

/* Sixteen points' distances and normals, from where that is no matter of kernels: x, y and z in three rows; beyond `reach` (m, or SK_REAL_MAX) the
 * distance may be anything that is, too. */
typedef struct sk_sixteen_contacts {
    real normal[3][SK_LANES], distance[SK_LANES];
    real own[3][SK_LANES]; /* the velocity that the surface has besides the pose's, m/s: of types that deform */
} sk_sixteen_contacts;
typedef void sk_probe_sixteen(const sk_collider *collider, const sk_pose *pose, real p[3][SK_LANES], real reach,
                              sk_sixteen_contacts *contacts);
extern sk_probe_sixteen *const sk_probe_sixteen_of[SK_ISA_COUNT];

/* The same for points anywhere, 3 numbers each; distances and normals may be NULL. */
void sk_collider_probe_points(const sk_collider *collider, double time, sk_isa isa, size_t count, const double *points,
                              double *distances, double *normals);

/* Calls `visit` for every particle in touch: what sk_collider_measure() counts. */
void sk_collider_visit(const sk_collider *collider, double time, sk_isa isa, const sk_vec4 *x, const uint32_t *slot_of,
                       size_t particle_count,
                       void (*visit)(void *user, size_t particle, sk_vec3 normal, double distance), void *user);

/* Where a ray (`along` is of length 1) first comes from outside to the surface, in metres, and the unit normal there;
 * infinity where it does not within `most` metres. */
double sk_collider_cast(const sk_collider *collider, double time, const double origin[3], const double along[3],
                        double most, double normal[3]);
/* The same of the way from a to b, as a part of it, over 1 where it does not come in: by `cross`, or by rays. What is at the
 * surface but for rounding, and goes in, crosses it at once. */
double sk_collider_cross(const sk_collider *collider, const sk_pose *pose, const double a[3], const double b[3],
                         double normal[3]);

#endif
