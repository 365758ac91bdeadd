/* Birds; see birds.h. */
#include "render/birds.h"

#include "render/fail.h"
#include "render/linear.h"
#include "render/shader.h"

#include <epoxy/gl.h>
#include <math.h>
#include <string.h>

enum { POSITIONS, VELOCITIES, SLOTS, POSTURES }; /* bindings */
enum { posture_floats = 4, group = 64 };

// clang-format off
/* Seen along the flight (+z) with the left wing at +x; the wings span 2. The fourth number is 1 on wings. */
static const float bird[][4] = {
    // the body
    {0, 0, 0.55f, 0}, {0, 0.07f, 0.1f, 0}, {-0.08f, 0, 0.1f, 0},
    {0, 0, 0.55f, 0}, {0.08f, 0, 0.1f, 0}, {0, 0.07f, 0.1f, 0},
    {0, 0, 0.55f, 0}, {-0.08f, 0, 0.1f, 0}, {0, -0.08f, 0.1f, 0},
    {0, 0, 0.55f, 0}, {0, -0.08f, 0.1f, 0}, {0.08f, 0, 0.1f, 0},
    {0, 0, -0.5f, 0}, {-0.08f, 0, 0.1f, 0}, {0, 0.07f, 0.1f, 0},
    {0, 0, -0.5f, 0}, {0, 0.07f, 0.1f, 0}, {0.08f, 0, 0.1f, 0},
    {0, 0, -0.5f, 0}, {0, -0.08f, 0.1f, 0}, {-0.08f, 0, 0.1f, 0},
    {0, 0, -0.5f, 0}, {0.08f, 0, 0.1f, 0}, {0, -0.08f, 0.1f, 0},
    // the tail
    {0, 0.01f, -0.3f, 0}, {-0.17f, 0.01f, -0.75f, 0}, {0.17f, 0.01f, -0.75f, 0},
    // a wing: from the shoulder to the wrist, and from there to the tip
    {0.05f, 0.03f, 0.26f, 1}, {0.5f, 0.03f, 0.32f, 1}, {0.5f, 0.03f, -0.06f, 1},
    {0.05f, 0.03f, 0.26f, 1}, {0.5f, 0.03f, -0.06f, 1}, {0.05f, 0.03f, -0.16f, 1},
    {0.5f, 0.03f, 0.32f, 1}, {1, 0.03f, -0.08f, 1}, {0.5f, 0.03f, -0.06f, 1},
    // and the other
    {-0.05f, 0.03f, 0.26f, 1}, {-0.5f, 0.03f, -0.06f, 1}, {-0.5f, 0.03f, 0.32f, 1},
    {-0.05f, 0.03f, 0.26f, 1}, {-0.05f, 0.03f, -0.16f, 1}, {-0.5f, 0.03f, -0.06f, 1},
    {-0.5f, 0.03f, 0.32f, 1}, {-0.5f, 0.03f, -0.06f, 1}, {-1, 0.03f, -0.08f, 1},
};
// clang-format on
enum { bird_vertices = sizeof bird / sizeof *bird };

/* A jump in time longer than this (s) is a cut: nothing is learnt from it. */
static const double longest_gap = 0.25;

/* ---- Making --------------------------------------------------------------------------------- */

skein_status render_flight_create(render_flight *flight, skein_error *error) {
    flight->drawn = render_shader_link("fine,light,bird_block,bird.vert", "fine,display,bird.frag", error);
    if (flight->drawn) flight->depth = render_shader_link("bird_block,bird.vert", NULL, error);
    if (flight->depth) flight->advance = render_shader_link_compute("bird_block,bird.comp", error);
    if (!flight->advance) return SKEIN_ERROR_VALUE;
    glCreateBuffers(1, &flight->mesh);
    glNamedBufferStorage(flight->mesh, sizeof bird, bird, 0);
    glCreateVertexArrays(1, &flight->arrays);
    glVertexArrayVertexBuffer(flight->arrays, 0, flight->mesh, 0, sizeof *bird);
    glVertexArrayAttribFormat(flight->arrays, 0, 4, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(flight->arrays, 0, 0);
    glEnableVertexArrayAttrib(flight->arrays, 0);
    return SKEIN_OK;
}

void render_flight_destroy(render_flight *flight) {
    const GLuint buffers[] = {flight->mesh, flight->positions, flight->velocities, flight->slots, flight->postures};
    const GLuint programs[] = {flight->drawn, flight->depth, flight->advance};
    glDeleteBuffers(5, buffers);
    for (int i = 0; i < 3; i++)
        if (programs[i]) glDeleteProgram(programs[i]);
    glDeleteVertexArrays(1, &flight->arrays);
    memset(flight, 0, sizeof *flight);
}

/* ---- Bringing ------------------------------------------------------------------------------- */

static size_t count_birds(const render_frame *frame) {
    size_t count = 0;
    for (size_t i = 0; i < frame->bird_count; i++) count += frame->birds[i].count;
    return count;
}

static void renew(GLuint *buffer, size_t bytes) {
    glDeleteBuffers(1, buffer);
    glCreateBuffers(1, buffer);
    glNamedBufferStorage(*buffer, (GLsizeiptr)bytes, NULL, GL_DYNAMIC_STORAGE_BIT);
}

/* Room for so many birds, all flocks together. */
static void reserve(render_flight *flight, size_t count) {
    if (count <= flight->bird_room) return;
    flight->bird_room = count + count / 2;
    renew(&flight->positions, flight->bird_room * 4 * sizeof(float));
    renew(&flight->velocities, flight->bird_room * 4 * sizeof(float));
    renew(&flight->slots, flight->bird_room * sizeof(uint32_t));
    renew(&flight->postures, flight->bird_room * posture_floats * sizeof(float));
    flight->posture_count = 0;
}

/* What the list of slots is to the shaders: see bird_block.glsl. */
static GLint list_of(const render_birds *birds) {
    return !birds->position_buffer ? 0 : birds->slots ? 1 : 2;
}

/* Binds what a flock's numbers are read from. */
static void bind(const render_flight *flight, const render_birds *birds) {
    bool own = !birds->position_buffer;
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, POSITIONS, own ? flight->positions : birds->position_buffer);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, VELOCITIES, own ? flight->velocities : birds->velocity_buffer);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, SLOTS, birds->bird_buffer ? birds->bird_buffer : flight->slots);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, POSTURES, flight->postures);
}

static void advance(const render_flight *flight, const render_birds *birds, size_t first, double seconds, bool fresh) {
    GLuint program = flight->advance;
    bind(flight, birds);
    glUseProgram(program);
    glProgramUniform1ui(program, 0, (GLuint)birds->count);
    glProgramUniform1ui(program, 1, (GLuint)first);
    glProgramUniform1i(program, 2, list_of(birds));
    glProgramUniform1f(program, 3, (float)seconds);
    glProgramUniform1i(program, 4, fresh);
    size_t groups = (birds->count + group - 1) / group, rows = (groups + 65534) / 65535;
    glDispatchCompute((GLuint)((groups + rows - 1) / rows), (GLuint)rows, 1);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

skein_status render_flight_bring(render_flight *flight, const render_frame *frame, skein_error *error) {
    size_t count = count_birds(frame), first = 0;
    if (!count) return SKEIN_OK;
    if (count > UINT32_MAX / 64) return render_fail(error, SKEIN_ERROR_LIMIT, "", "%zu birds are too many", count);
    reserve(flight, count);
    double seconds = frame->time - flight->time;
    // a film that begins again begins as it did
    bool fresh = flight->posture_count != count || seconds < 0, cut = fresh || !(seconds > 0 && seconds < longest_gap);
    for (size_t i = 0; i < frame->bird_count; i++) {
        const render_birds *birds = &frame->birds[i];
        if (!birds->count) continue;
        if (birds->slots) {
            glNamedBufferSubData(flight->slots, (GLintptr)(4 * first), (GLsizeiptr)(4 * birds->count), birds->slots);
        } else if (!birds->position_buffer) {
            GLintptr at = (GLintptr)(16 * first);
            GLsizeiptr size = (GLsizeiptr)(16 * birds->count);
            glNamedBufferSubData(flight->positions, at, size, birds->positions);
            glNamedBufferSubData(flight->velocities, at, size, birds->velocities);
        }
        advance(flight, birds, first, cut ? 0 : seconds, fresh);
        first += birds->count;
    }
    flight->posture_count = count;
    flight->time = frame->time;
    return SKEIN_OK;
}

/* ---- Drawing -------------------------------------------------------------------------------- */

void render_flight_draw(const render_flight *flight, const render_frame *frame, bool depth, size_t part) {
    GLuint program = depth ? flight->depth : flight->drawn;
    size_t first = 0;
    for (size_t i = 0; i < frame->bird_count; first += frame->birds[i].count, i++) {
        const render_birds *birds = &frame->birds[i];
        if (!birds->count) continue;
        bind(flight, birds);
        glUseProgram(program);
        glProgramUniform1ui(program, 1, (GLuint)first);
        glProgramUniform1i(program, 2, list_of(birds));
        glProgramUniform1f(program, 3, (float)(0.5 * birds->span));
        if (!depth) {
            float light[3];
            render_to_light(birds->colour, 1, light);
            glProgramUniform1i(program, 4, birds->paint);
            glProgramUniform3f(program, 5, light[0], light[1], light[2]);
            glProgramUniform2f(program, 7, birds->range > 0 ? (float)(1 / birds->range) : 0, RENDER_LITTLE_TO_MUCH);
        }
        glBindVertexArray(flight->arrays);
        size_t most = part ? 3 * part / bird_vertices + 1 : birds->count;
        for (size_t from = 0; from < birds->count; from += most) {
            size_t count = birds->count - from < most ? birds->count - from : most;
            glProgramUniform1ui(program, 6, (GLuint)from);
            glDrawArraysInstanced(GL_TRIANGLES, 0, bird_vertices, (GLsizei)count);
            if (part) glFinish();
        }
    }
}
