/* Rearranging particles on the card: when it is done, and the programs that move the state there and back. */
#include "gpu/arrange.h"

#include <epoxy/gl.h>

#include "base/status.h"
#include "gpu/device.h"
#include "gpu/ops.h"

enum { GATHER, COPY, GATHER_NUMBERS, COPY_NUMBERS, SCATTER };

/* Steps until the state is moved again: particles stay near each other for long. The first time comes soon, for they
 * are built in any order. */
enum { STEPS_BETWEEN = 64, FIRST_STEPS = 2 };

/* Whether the order of particles is free: no op depends on slots. */
static bool is_possible(const sk_gpu_device *device, const skein_world *world) {
    bool walks = false;
    if (!device->identity) return false;
    for (size_t r = 0; r < world->plan.count; r++)
        if (!sk_gpu_op_knows_no_slots(&world->plan.data[r], device->particle_count)) return false;
    for (size_t i = 0; i < device->passes.count; i++) walks |= device->passes.data[i].kind == SK_GPU_NEIGHBOURS;
    return walks;
}

static skein_status make_programs(sk_gpu_device *device, skein_world *world, skein_error *error) {
    skein_status status = SKEIN_OK;
    for (int i = 0; i < SK_GPU_ARRANGE_PROGRAMS && !status; i++) {
        sk_gpu_text text = {.allocator = &world->allocator};
        sk_gpu_put(&text, "#version 450 core\nlayout(local_size_x = %d) in;\n#define STAGE %d\n", SK_GPU_GROUP, i);
        sk_gpu_put_file(&text, "gpu/arrange", 0);
        status = sk_gpu_program(&device->programs, &world->allocator, &text, "moving the state",
                                &device->arrangement.program[i], error);
        sk_release(&world->allocator, text.data);
    }
    return status;
}

skein_status sk_gpu_arrange_make(sk_gpu_device *device, skein_world *world, skein_error *error) {
    sk_gpu_arrangement *a = &device->arrangement;
    a->possible = is_possible(device, world);
    if (!a->possible || a->count != device->particle_count) sk_gpu_arrange_free(device);
    if (!a->possible || a->home) return SKEIN_OK;
    skein_status status = make_programs(device, world, error);
    if (!status) status = sk_gpu_buffer(device, 4 * device->particle_count, &a->home, error);
    if (status) return status;
    a->count = device->particle_count;
    device->base.behind = true; // makes the next step write the state, and then reset `home`
    return SKEIN_OK;
}

void sk_gpu_arrange_free(sk_gpu_device *device) {
    sk_gpu_arrangement *a = &device->arrangement;
    if (a->moved) device->base.behind = true; // the world has fetched the state, and writes it to its own slots
    sk_gpu_buffer_free(device, &a->home, 4 * a->count);
    a->count = 0;
    a->moved = false;
}

/* Runs one of the programs from one buffer to another. */
static void move(const sk_gpu_device *device, int which, unsigned from, unsigned to, unsigned list) {
    const sk_gpu_arrangement *a = &device->arrangement;
    const unsigned buffers[] = {from, to, list};
    for (GLuint i = 0; i < 3; i++)
        if (buffers[i]) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, i, buffers[i]);
    glUseProgram(a->program[which]);
    glProgramUniform1ui(a->program[which], 0, (GLuint)a->count);
    sk_gpu_dispatch(device, a->count);
}

void sk_gpu_arrange_reset(sk_gpu_device *device) {
    device->arrangement.moved = false;
    device->arrangement.steps = 0;
}

/* Moves the state into the order of the grid's list, the slots of the last step by cells. */
static void arrange(sk_gpu_device *device) {
    sk_gpu_arrangement *a = &device->arrangement;
    const sk_gpu_grid *grid = &device->grid;
    for (sk_vector v = SK_X; v <= SK_V; v++) {
        move(device, GATHER, device->vector[v], grid->position, grid->number);
        move(device, COPY, grid->position, device->vector[v], 0);
    }
    if (a->moved) {
        move(device, GATHER_NUMBERS, a->home, grid->order, grid->number);
        move(device, COPY_NUMBERS, grid->order, a->home, 0);
    } else {
        move(device, COPY_NUMBERS, grid->number, a->home, 0);
    }
    a->moved = true;
}

void sk_gpu_arrange_step(sk_gpu_device *device) {
    sk_gpu_arrangement *a = &device->arrangement;
    if (!a->possible) return;
    size_t wait = a->moved ? STEPS_BETWEEN : FIRST_STEPS;
    if (a->steps >= wait) {
        arrange(device);
        a->steps = 0;
    }
    a->steps++;
}

unsigned sk_gpu_arrange_back(sk_gpu_device *device, sk_vector vector) {
    const sk_gpu_arrangement *a = &device->arrangement;
    if (!a->moved) return device->vector[vector];
    move(device, SCATTER, device->vector[vector], device->grid.position, a->home);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    return device->grid.position;
}
