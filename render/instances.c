/* What is drawn many times over; see instances.h. */
#include "render/instances.h"

#include "render/fail.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Floats of a ball: centre and radius, three rows of its rotation, paint, marking; of a solid: the same, and its
 * extent; of a line: both ends, paint. */
enum { ball_floats = 4 + 9 + 3 + 3, solid_floats = ball_floats + 3, line_floats = 6 + 3 };

/* ---- Making --------------------------------------------------------------------------------- */

/* Attributes `first` and on read parts[i] floats each of a buffer at binding 1 that steps by instance. */
static void make_attributes(GLuint arrays, GLuint first, const GLint *parts, GLuint count) {
    GLuint offset = 0;
    for (GLuint i = 0; i < count; i++) {
        glVertexArrayAttribFormat(arrays, first + i, parts[i], GL_FLOAT, GL_FALSE, offset);
        glVertexArrayAttribBinding(arrays, first + i, 1);
        glEnableVertexArrayAttrib(arrays, first + i);
        offset += (GLuint)parts[i] * (GLuint)sizeof(float);
    }
    glVertexArrayBindingDivisor(arrays, 1, 1);
}

/* Of one shape, with `count` attributes after its own. */
static void make_shaped(render_instances *instances, const render_shape *shape, GLuint count) {
    static const GLint parts[7] = {4, 3, 3, 3, 3, 3, 3};
    glCreateVertexArrays(1, &instances->arrays);
    glVertexArrayAttribFormat(instances->arrays, 0, 3, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(instances->arrays, 0, 0);
    glEnableVertexArrayAttrib(instances->arrays, 0);
    render_instances_take_shape(instances, shape);
    make_attributes(instances->arrays, 1, parts, count);
}

void render_instances_make_balls(render_instances *instances, const render_shape *shape) {
    make_shaped(instances, shape, 6);
}

void render_instances_make_solids(render_instances *instances, const render_shape *shape) {
    make_shaped(instances, shape, 7);
}

void render_instances_take_shape(const render_instances *instances, const render_shape *shape) {
    glVertexArrayVertexBuffer(instances->arrays, 0, shape->vertices, 0, 3 * sizeof(float));
    glVertexArrayElementBuffer(instances->arrays, shape->indices);
}

void render_instances_make_lines(render_instances *instances) {
    static const GLint parts[3] = {3, 3, 3};
    glCreateVertexArrays(1, &instances->arrays);
    make_attributes(instances->arrays, 0, parts, 3);
}

void render_instances_destroy(render_instances *instances) {
    glDeleteVertexArrays(1, &instances->arrays);
    glDeleteBuffers(1, &instances->buffer);
    free(instances->staged);
    memset(instances, 0, sizeof *instances);
}

/* Room for `count` instances of `floats` floats, on the card and in `staged`. */
static skein_status reserve(render_instances *instances, size_t count, size_t floats, skein_error *error) {
    size_t need = count * floats * sizeof(float);
    instances->count = 0;
    if (need > instances->room) {
        float *staged = realloc(instances->staged, 2 * need);
        if (!staged) return render_fail_memory(error, "what is drawn");
        instances->staged = staged;
        instances->room = 2 * need;
        glDeleteBuffers(1, &instances->buffer);
        glCreateBuffers(1, &instances->buffer);
        glNamedBufferStorage(instances->buffer, (GLsizeiptr)instances->room, NULL, GL_DYNAMIC_STORAGE_BIT);
        glVertexArrayVertexBuffer(instances->arrays, 1, instances->buffer, 0, (GLsizei)(floats * sizeof(float)));
    }
    instances->count = count;
    return SKEIN_OK;
}

static void send(const render_instances *instances, size_t floats) {
    size_t size = instances->count * floats * sizeof(float);
    if (size > 0) glNamedBufferSubData(instances->buffer, 0, (GLsizeiptr)size, instances->staged);
}

/* ---- Bringing ------------------------------------------------------------------------------- */

static void stage_ball(float *out, const double centre[3], double radius, const double rotation[9],
                       const float paint[3], const float marking[3]) {
    for (int i = 0; i < 3; i++) out[i] = (float)centre[i];
    out[3] = (float)radius;
    for (int i = 0; i < 9; i++) out[4 + i] = (float)rotation[i];
    render_to_light(paint, 1.0f, out + 13);
    render_to_light(marking, 1.0f, out + 16);
}

skein_status render_instances_bring_spheres(render_instances *instances, const render_frame *frame, skein_error *error) {
    skein_status status = reserve(instances, frame->sphere_count, ball_floats, error);
    if (status != SKEIN_OK) return status;
    for (size_t i = 0; i < frame->sphere_count; i++) {
        const render_sphere *sphere = &frame->spheres[i];
        stage_ball(&instances->staged[i * ball_floats], sphere->centre, sphere->radius, sphere->rotation,
                   sphere->colour, sphere->marking);
    }
    send(instances, ball_floats);
    return SKEIN_OK;
}

skein_status render_instances_bring_solids(render_instances *instances, const render_solid *solids, size_t count,
                                           skein_error *error) {
    skein_status status = reserve(instances, count, solid_floats, error);
    if (status != SKEIN_OK) return status;
    for (size_t i = 0; i < count; i++) {
        float *out = &instances->staged[i * solid_floats];
        stage_ball(out, solids[i].centre, solids[i].radius, solids[i].rotation, solids[i].colour, solids[i].marking);
        for (int k = 0; k < 3; k++) out[ball_floats + k] = (float)solids[i].extent[k];
    }
    send(instances, solid_floats);
    return SKEIN_OK;
}

skein_status render_instances_bring_points(render_instances *instances, const render_frame *frame,
                                           const double rotation[9], skein_error *error) {
    size_t count = 0, next = 0;
    for (size_t g = 0; g < frame->points_count; g++) count += frame->points[g].count;
    skein_status status = reserve(instances, count, ball_floats, error);
    if (status != SKEIN_OK) return status;
    for (size_t g = 0; g < frame->points_count; g++) {
        const render_points *points = &frame->points[g];
        for (size_t i = 0; i < points->count; i++) {
            const float *paint = points->colours ? &points->colours[3 * i] : points->colour;
            stage_ball(&instances->staged[next++ * ball_floats], &points->positions[3 * i], points->radius, rotation,
                       paint, paint);
        }
    }
    send(instances, ball_floats);
    return SKEIN_OK;
}

skein_status render_instances_bring_lines(render_instances *instances, const render_frame *frame, skein_error *error) {
    size_t count = 0, next = 0;
    for (size_t g = 0; g < frame->lines_count; g++) count += frame->lines[g].count;
    skein_status status = reserve(instances, count, line_floats, error);
    if (status != SKEIN_OK) return status;
    for (size_t g = 0; g < frame->lines_count; g++) {
        const render_lines *lines = &frame->lines[g];
        float light[3];
        render_to_light(lines->colour, 1, light);
        for (size_t i = 0; i < lines->count; i++) {
            float *out = &instances->staged[next++ * line_floats];
            for (size_t k = 0; k < 6; k++) out[k] = (float)lines->positions[6 * i + k];
            if (lines->colours) render_to_light(&lines->colours[3 * i], 1, light);
            memcpy(out + 6, light, sizeof light);
        }
    }
    send(instances, line_floats);
    return SKEIN_OK;
}

/* ---- Drawing -------------------------------------------------------------------------------- */

void render_instances_draw_lines(const render_instances *instances, unsigned program, const render_frame *frame,
                                 double width, double height, size_t part) {
    GLuint first = 0;
    glUseProgram(program);
    glBindVertexArray(instances->arrays);
    for (size_t i = 0; i < frame->lines_count; i++) {
        const render_lines *lines = &frame->lines[i];
        glProgramUniform3f(program, 0, 1.0f / (float)width, 1.0f / (float)height, (float)lines->width);
        size_t most = part ? part / 2 + 1 : lines->count;
        for (size_t from = 0; from < lines->count; from += most) {
            size_t count = lines->count - from < most ? lines->count - from : most;
            glDrawArraysInstancedBaseInstance(GL_TRIANGLE_STRIP, 0, 4, (GLsizei)count, first + (GLuint)from);
            if (part) glFinish();
        }
        first += (GLuint)lines->count;
    }
}
