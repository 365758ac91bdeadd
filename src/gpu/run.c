/* Running passes: blocks are gathered, sent together, and then the passes are dispatched in their order. */
#include <epoxy/gl.h>
#include <string.h>

#include "gpu/device.h"
#include "gpu/ops.h"

void sk_gpu_dispatch(const sk_gpu_device *device, size_t invocations) {
    size_t groups = (invocations + SK_GPU_GROUP - 1) / SK_GPU_GROUP;
    if (!groups) return;
    size_t rows = (groups + device->most_groups - 1) / device->most_groups, columns = (groups + rows - 1) / rows;
    glDispatchCompute((GLuint)columns, (GLuint)rows, 1);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
}

/* Copies the present positions of particles that ops read into the block. */
static void look(const sk_gpu_device *device, const sk_gpu_call *call) {
    size_t at = call->block + 16 * SK_GPU_HEAD;
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    for (size_t r = 0; r < call->pass->count; r++) {
        const sk_op *op = device->passes.ops.data[call->pass->first + r];
        if (sk_gpu_op_has_target(op)) {
            size_t slot = sk_gpu_op_target_from((const float(*)[4])(const void *)(device->stage + at));
            glCopyNamedBufferSubData(device->vector[SK_X], device->blocks, (GLintptr)(16 * slot),
                                     (GLintptr)(at + 16 * sk_gpu_op_target_to()), 12);
        }
        at += 16 * sk_gpu_op_size(op);
    }
}

static void run_call(sk_gpu_device *device, const sk_gpu_call *call) {
    const sk_gpu_pass *pass = call->pass;
    if (pass->looks) look(device, call);
    glUseProgram(pass->program);
    glBindBufferRange(GL_UNIFORM_BUFFER, 0, device->blocks, (GLintptr)call->block, (GLsizeiptr)pass->block * 16);
    bool whole = pass->kind == SK_GPU_NEIGHBOURS;
    for (size_t i = 0; i < pass->vector_count; i++)
        glBindBufferRange(GL_SHADER_STORAGE_BUFFER, (GLuint)i, device->vector[pass->vector[i]],
                          whole ? 0 : (GLintptr)call->first * 16,
                          (GLsizeiptr)(whole ? device->slot_count : call->count) * 16);
    if (whole) sk_gpu_grid_bind(&device->grid);
    sk_gpu_dispatch(device, call->count);
}

void sk_gpu_flush(sk_gpu_device *device) {
    if (device->staged) glNamedBufferSubData(device->blocks, 0, (GLsizeiptr)device->staged, device->stage);
    for (size_t i = 0; i < device->call_count; i++) {
        const sk_gpu_call *call = &device->calls[i];
        if (call->pass->kind == SK_GPU_GRID) sk_gpu_grid_build(device, call->first, call->count, call->block);
        else run_call(device, call);
    }
    device->staged = device->call_count = 0;
}

/* Room for a block; if there is none, what waits is sent first. */
static float (*stage_block(sk_gpu_device *device, size_t vectors, size_t *at))[4] {
    size_t bytes = (vectors * 16 + device->block_alignment - 1) / device->block_alignment * device->block_alignment;
    if (device->staged + bytes > SK_GPU_STAGE || device->call_count == SK_GPU_STAGE / 256) sk_gpu_flush(device);
    *at = device->staged;
    device->staged += bytes;
    memset(device->stage + *at, 0, bytes);
    return (float(*)[4])(void *)(device->stage + *at);
}

/* Adds the calls of a pass: several if its vectors are larger than a binding can be. */
static void call_pass(sk_gpu_device *device, const sk_run *run, const sk_gpu_pass *pass, size_t iterations) {
    bool walks = pass->kind == SK_GPU_NEIGHBOURS;
    size_t all = walks ? pass->end - pass->begin : device->slot_count;
    size_t most = walks ? all : device->most_bytes / 16 / SK_GPU_GROUP * SK_GPU_GROUP;
    for (size_t first = 0; first < all; first += most) {
        sk_gpu_call call = {.pass = pass, .first = first, .count = all - first < most ? all - first : most};
        float(*block)[4] = stage_block(device, pass->block, &call.block);
        const uint32_t head[4] = {(uint32_t)call.count, (uint32_t)(walks ? pass->begin : first), (uint32_t)iterations,
                                  run->last_iteration};
        memcpy(block[0], head, sizeof head);
        sk_gpu_pack(&device->passes, pass, run, block);
        device->calls[device->call_count++] = call;
    }
}

static void call_grid(sk_gpu_device *device, const sk_gpu_pass *pass) {
    sk_gpu_call call = {
        .pass = pass, .first = pass->op->group->first, .count = pass->op->group->end - pass->op->group->first};
    float(*block)[4] = stage_block(device, SK_GPU_GRID_BLOCK, &call.block);
    sk_gpu_grid_pack(&device->grid, pass->op, block);
    device->calls[device->call_count++] = call;
}

static void run_passes(sk_gpu_device *device, sk_run *run, size_t begin, size_t end) {
    for (size_t i = begin; i < end; i++) {
        const sk_gpu_pass *pass = &device->passes.data[i];
        if (pass->kind == SK_GPU_GRID) {
            call_grid(device, pass);
        } else if (pass->kind != SK_GPU_REPEAT) {
            call_pass(device, run, pass, 1);
        } else {
            const sk_op *repeat = pass->op;
            double start = run->time;
            bool outer = run->last_iteration, looped = pass->count == 1 && pass[1].looped;
            if (looped) call_pass(device, run, &pass[1], repeat->end);
            for (size_t iteration = 0; iteration < repeat->end && !looped; iteration++) {
                run->time = start + (double)(iteration + 1) * repeat->dt;
                run->last_iteration = iteration + 1 == repeat->end;
                run_passes(device, run, i + 1, i + 1 + pass->count);
            }
            run->time = start + (double)repeat->end * repeat->dt;
            run->last_iteration = outer;
            i += pass->count;
        }
    }
}

void sk_gpu_run(sk_gpu_device *device, sk_run *run) {
    run_passes(device, run, 0, device->passes.count);
    sk_gpu_flush(device);
}
