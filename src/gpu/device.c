/* A world's buffers and passes on a card: making, filling, running them for a step, reading back, releasing. */
#include "gpu/device.h"

#include <epoxy/gl.h>
#include <string.h>

#include "base/status.h"

/* ---- buffers ---- */

static size_t vector_bytes(const sk_gpu_device *device) {
    return device->slot_count * 4 * sizeof(float);
}

skein_status sk_gpu_buffer(sk_gpu_device *device, size_t bytes, unsigned *buffer, skein_error *error) {
    while (glGetError() != GL_NO_ERROR) {} // clears earlier errors
    glCreateBuffers(1, buffer);
    glNamedBufferStorage(*buffer, (GLsizeiptr)bytes, NULL, GL_DYNAMIC_STORAGE_BIT);
    GLenum fault = glGetError();
    if (fault != GL_NO_ERROR) {
        glDeleteBuffers(1, buffer);
        *buffer = 0;
        return sk_fail(error, SKEIN_ERROR_MEMORY, "device",
                       "the graphics card has no room: %zu particles need %.1f MB more, %.1f MB are in use",
                       device->particle_count, (double)bytes * 1e-6, (double)device->bytes * 1e-6);
    }
    glClearNamedBufferData(*buffer, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, NULL);
    device->bytes += bytes;
    return SKEIN_OK;
}

void sk_gpu_buffer_free(sk_gpu_device *device, unsigned *buffer, size_t bytes) {
    if (!*buffer) return;
    glDeleteBuffers(1, buffer);
    *buffer = 0;
    device->bytes -= bytes;
}

static void free_vectors(sk_gpu_device *device) {
    for (int v = SK_X; v < SK_VECTOR_COUNT; v++) sk_gpu_buffer_free(device, &device->vector[v], vector_bytes(device));
}

static bool is_identity(const sk_particles *particles) {
    for (size_t i = 0; i < particles->count; i++)
        if (particles->slot_of[i] != i) return false;
    return true;
}

/* Buffers for the vectors that the passes name, and no others. */
static skein_status make_vectors(sk_gpu_device *device, skein_error *error) {
    skein_status status = SKEIN_OK;
    for (int v = SK_X; v < SK_VECTOR_COUNT && !status; v++) {
        bool wanted = device->passes.vectors >> v & 1;
        if (!wanted) sk_gpu_buffer_free(device, &device->vector[v], vector_bytes(device));
        else if (!device->vector[v]) status = sk_gpu_buffer(device, vector_bytes(device), &device->vector[v], error);
    }
    return status;
}

/* A plan that uses the grid binds whole vectors, which must not be larger than a binding can be. */
static skein_status check_walks(const sk_gpu_device *device, skein_error *error) {
    for (size_t i = 0; i < device->passes.count; i++) {
        if (device->passes.data[i].kind != SK_GPU_NEIGHBOURS || vector_bytes(device) <= device->most_bytes) continue;
        return sk_fail(error, SKEIN_ERROR_LIMIT, "device",
                       "%zu particles with neighbours need buffers of %.1f MB; this driver binds at most %.1f MB, "
                       "%zu particles",
                       device->particle_count, (double)vector_bytes(device) * 1e-6, (double)device->most_bytes * 1e-6,
                       device->most_bytes / 16);
    }
    return SKEIN_OK;
}

static bool has_grid(const sk_gpu_device *device) {
    for (size_t i = 0; i < device->passes.count; i++)
        if (device->passes.data[i].kind == SK_GPU_GRID) return true;
    return false;
}

/* ---- what the world asks of it ---- */

static skein_status prepare_entered(sk_gpu_device *device, skein_world *world, skein_error *error) {
    const sk_particles *particles = &world->particles;
    if (particles->out_count)
        return sk_fail(error, SKEIN_ERROR_VALUE, "device",
                       "%zu particles are of bodies that are disabled or were removed: a graphics card steps worlds in "
                       "which all are there; enable them, or step on the processor",
                       particles->out_count);
    if (device->slot_count != particles->slot_count) {
        free_vectors(device); // the world has fetched the state
        device->base.behind = true;
    }
    device->slot_count = particles->slot_count;
    device->particle_count = particles->count;
    device->identity = is_identity(particles);
    skein_status status = sk_gpu_compose(&device->passes, &device->programs, world, device->identity, error);
    if (!status) status = check_walks(device, error);
    if (!status) status = make_vectors(device, error);
    if (!has_grid(device)) sk_gpu_grid_free(device);
    else if (!status) status = sk_gpu_grid_make(device, world, error);
    if (!status) status = sk_gpu_arrange_make(device, world, error);
    return status;
}

static skein_status prepare(sk_device *base, skein_world *world, skein_error *error) {
    sk_gpu_device *device = (sk_gpu_device *)(void *)base;
    skein_status status = sk_world_fetch(world); // buffers may be released below
    if (status) return status;
    sk_gpu_context_enter(&device->context);
    status = prepare_entered(device, world, error);
    if (status) device->passes.count = 0;
    sk_gpu_context_leave(&device->context);
    return status;
}

/* Writes or reads a vector of the world, in parts where numbers are to be turned. */
static void copy_vector(sk_gpu_device *device, sk_vec4 *vector, unsigned buffer, bool write) {
    // slots behind the last particle are empty, and a copy in the world's order has none
    size_t slots = device->identity && !write ? device->particle_count : device->slot_count;
    if (sizeof(real) == sizeof(float)) {
        if (write) glNamedBufferSubData(buffer, 0, (GLsizeiptr)(16 * slots), vector);
        else glGetNamedBufferSubData(buffer, 0, (GLsizeiptr)(16 * slots), vector);
        return;
    }
    enum { PART = SK_GPU_STAGE / 16 };
    float(*part)[4] = (float(*)[4])(void *)device->stage;
    for (size_t first = 0; first < slots; first += PART) {
        size_t count = slots - first < PART ? slots - first : PART;
        for (size_t i = 0; i < count && write; i++) {
            sk_vec4 v = vector[first + i];
            part[i][0] = (float)v.x, part[i][1] = (float)v.y, part[i][2] = (float)v.z, part[i][3] = (float)v.w;
        }
        if (write) glNamedBufferSubData(buffer, (GLintptr)first * 16, (GLsizeiptr)count * 16, part);
        else glGetNamedBufferSubData(buffer, (GLintptr)first * 16, (GLsizeiptr)count * 16, part);
        // masses keep the precision that they have here
        for (size_t i = 0; i < count && !write; i++)
            vector[first + i] = (sk_vec4){(real)part[i][0], (real)part[i][1], (real)part[i][2], vector[first + i].w};
    }
}

static skein_status check_gl(const char *what, skein_error *error) {
    GLenum fault = glGetError();
    if (fault == GL_NO_ERROR) return SKEIN_OK;
    return sk_fail(error, fault == GL_OUT_OF_MEMORY ? SKEIN_ERROR_MEMORY : SKEIN_ERROR_VALUE, "device",
                   "the graphics card failed in %s: OpenGL error 0x%x", what, fault);
}

static skein_status step(sk_device *base, skein_world *world, sk_run *run, skein_error *error) {
    sk_gpu_device *device = (sk_gpu_device *)(void *)base;
    sk_gpu_context_enter(&device->context);
    if (base->behind) {
        copy_vector(device, world->particles.vector[SK_X], device->vector[SK_X], true);
        copy_vector(device, world->particles.vector[SK_V], device->vector[SK_V], true);
        device->grid.begin = device->grid.end = 0; // the particles' box is not known any more
        sk_gpu_arrange_reset(device);
    }
    sk_gpu_arrange_step(device);
    sk_gpu_run(device, run);
    skein_status status = check_gl("a step", error);
    sk_gpu_context_leave(&device->context);
    base->behind = false;
    base->ahead = true;
    return status;
}

static skein_status read_back(sk_device *base, skein_world *world, skein_error *error) {
    static const sk_vector state[] = {SK_X, SK_V, SK_PREVIOUS};
    sk_gpu_device *device = (sk_gpu_device *)(void *)base;
    sk_gpu_context_enter(&device->context);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    for (size_t i = 0; i < sizeof state / sizeof *state; i++)
        copy_vector(device, world->particles.vector[state[i]], sk_gpu_arrange_back(device, state[i]), false);
    skein_status status = check_gl("reading the state", error);
    sk_gpu_context_leave(&device->context);
    return status;
}

static void wait_for(sk_device *base) {
    sk_gpu_device *device = (sk_gpu_device *)(void *)base;
    sk_gpu_context_enter(&device->context);
    glFinish();
    sk_gpu_context_leave(&device->context);
}

static void release(sk_device *base, skein_world *world) {
    sk_gpu_device *device = (sk_gpu_device *)(void *)base;
    sk_allocator *allocator = &world->allocator;
    sk_gpu_context_enter(&device->context);
    free_vectors(device);
    sk_gpu_arrange_free(device);
    sk_gpu_grid_free(device);
    for (size_t i = 0; i < SK_GPU_GRID_PROGRAMS; i++) device->grid.program[i] = 0;
    sk_gpu_programs_release(&device->programs, allocator);
    if (device->blocks) glDeleteBuffers(1, &device->blocks);
    sk_gpu_context_leave(&device->context);
    sk_gpu_context_release(&device->context);
    sk_release(allocator, device->passes.data);
    sk_release(allocator, device->passes.ops.data);
    sk_release(allocator, device->stage);
    sk_release(allocator, device->calls);
    sk_release(allocator, device);
}

/* ---- making one ---- */

static void ask_limits(sk_gpu_device *device) {
    GLint64 bytes = 0;
    GLint groups = 0, alignment = 0, storage_alignment = 0;
    glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &bytes);
    glGetIntegeri_v(GL_MAX_COMPUTE_WORK_GROUP_COUNT, 0, &groups);
    glGetIntegerv(GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT, &alignment);
    glGetIntegerv(GL_SHADER_STORAGE_BUFFER_OFFSET_ALIGNMENT, &storage_alignment);
    device->most_bytes = (size_t)bytes;
    device->most_groups = groups > 65535 ? 65535 : (size_t)groups;
    device->block_alignment = alignment > 16 ? (size_t)alignment : 16;
}

static skein_status create(skein_world *world, bool adopt, sk_device **out, skein_error *error) {
    sk_allocator *allocator = &world->allocator;
    sk_gpu_device *device = sk_allocate(allocator, sizeof *device);
    if (!device) return sk_fail_memory(error, "the device");
    device->base = (sk_device){prepare, step, read_back, release, wait_for, false, true, NULL};
    device->stage = sk_allocate(allocator, SK_GPU_STAGE);
    device->calls = sk_allocate(allocator, SK_GPU_STAGE / 256 * sizeof *device->calls);
    skein_status status = device->stage && device->calls ? SKEIN_OK : sk_fail_memory(error, "the device");
    if (!status)
        status = adopt ? sk_gpu_context_adopt(&device->context, error) : sk_gpu_context_create(&device->context, error);
    if (status) {
        sk_release(allocator, device->stage);
        sk_release(allocator, device->calls);
        sk_release(allocator, device);
        return status;
    }
    sk_gpu_context_enter(&device->context);
    ask_limits(device);
    glCreateBuffers(1, &device->blocks);
    glNamedBufferStorage(device->blocks, SK_GPU_STAGE, NULL, GL_DYNAMIC_STORAGE_BIT);
    sk_gpu_context_leave(&device->context);
    *out = &device->base;
    return SKEIN_OK;
}

skein_status skein_world_device_set(skein_world *world, skein_device device) {
    SK_NEED(world, world);
    skein_error *error = sk_world_error(world);
    sk_device *made = NULL;
    skein_status status = SKEIN_OK;
    if (device == SKEIN_DEVICE_SHARED)
        return sk_fail(error, SKEIN_ERROR_VALUE, "device", "a run is shared by skein_world_runner_set()");
    if (device != SKEIN_DEVICE_CPU) status = create(world, device == SKEIN_DEVICE_CURRENT_GL, &made, error);
    if (!status && (status = sk_world_set_device(world, made)) && made) release(made, world);
    return status;
}

skein_device_info skein_world_device(const skein_world *world) {
    if (!world) return (skein_device_info){.name = ""};
    const sk_gpu_device *device = (const sk_gpu_device *)(const void *)world->device;
    if (!device) return (skein_device_info){.device = SKEIN_DEVICE_CPU, .name = "processor"};
    if (device->base.name) return (skein_device_info){.device = SKEIN_DEVICE_SHARED, .name = device->base.name};
    bool newest = !device->base.behind; // else the card's state is out of date
    return (skein_device_info){
        .device = device->context.own ? SKEIN_DEVICE_GPU : SKEIN_DEVICE_CURRENT_GL,
        .name = device->context.name,
        .software = device->context.software,
        .bytes = device->bytes,
        .position_buffer = newest ? device->vector[SK_X] : 0,
        .velocity_buffer = newest ? device->vector[SK_V] : 0,
        .slot_of = device->arrangement.moved ? NULL : world->particles.slot_of,
        .particle_buffer = newest && device->arrangement.moved ? device->arrangement.home : 0,
        .slot_count = device->slot_count,
        .pass_count = device->passes.count,
    };
}
