/* The buffers and programs of the grid, in the order in which a build of it runs them. */
#include "gpu/grid.h"

#include <epoxy/gl.h>
#include <string.h>

#include "base/status.h"
#include "gpu/device.h"

enum {
    HEAD_BYTES = 128, /* before the cells: what the shaders' struct has there */
    BLOCK_CELLS = 4096,
};

enum { FIND, FRAME, CLEAR, COUNT, SUM_PARTS, SUM_SUMS, SUM_CELLS, SCATTER, SETTLE, PROGRAM_COUNT };
_Static_assert((int)PROGRAM_COUNT == (int)SK_GPU_GRID_PROGRAMS, "as many as the grid has room for");

static const struct {
    const char *file, *label;
    bool extent;
    int group, stage;
} shaders[PROGRAM_COUNT] = {
    [FIND] = {"gpu/grid_find", "grid: extent", true, SK_GPU_GROUP, 0},
    [FRAME] = {"gpu/grid_frame", "grid: frame", false, 1, 0},
    [CLEAR] = {"gpu/grid_clear", "grid: clear", false, SK_GPU_GROUP, 0},
    [COUNT] = {"gpu/grid_count", "grid: count", true, SK_GPU_GROUP, 0},
    [SUM_PARTS] = {"gpu/grid_sum", "grid: sums of parts", false, 256, 0},
    [SUM_SUMS] = {"gpu/grid_sum", "grid: sums of sums", false, 256, 1},
    [SUM_CELLS] = {"gpu/grid_sum", "grid: sums of cells", false, 256, 2},
    [SCATTER] = {"gpu/grid_scatter", "grid: scatter", false, SK_GPU_GROUP, 0},
    [SETTLE] = {"gpu/grid_settle", "grid: settle", false, SK_GPU_GROUP, 0},
};

static skein_status make_programs(sk_gpu_device *device, skein_world *world, skein_error *error) {
    skein_status status = SKEIN_OK;
    for (int i = 0; i < PROGRAM_COUNT && !status; i++) {
        sk_gpu_text text = {.allocator = &world->allocator};
        sk_gpu_put(&text, "#version 450 core\nlayout(local_size_x = %d) in;\n#define IDENTITY %d\n#define STAGE %d\n",
                   shaders[i].group, device->identity, shaders[i].stage);
        sk_gpu_put_file(&text, "gpu/grid", 0);
        if (shaders[i].extent) sk_gpu_put_file(&text, "gpu/grid_extent", 0);
        sk_gpu_put_file(&text, shaders[i].file, 0);
        status = sk_gpu_program(&device->programs, &world->allocator, &text, shaders[i].label, &device->grid.program[i],
                                error);
        sk_release(&world->allocator, text.data);
    }
    return status;
}

static size_t sum_count(const sk_gpu_grid *grid) {
    return grid->room / BLOCK_CELLS;
}

/* One of the grid's buffers. */
typedef struct part {
    unsigned *buffer;
    size_t bytes;
} part;

enum { PARTS = 6 };

static void list_parts(sk_gpu_device *device, part parts[PARTS]) {
    sk_gpu_grid *grid = &device->grid;
    const part all[PARTS] = {
        {&grid->cells, HEAD_BYTES + 4 * grid->room}, {&grid->number, 4 * grid->particles},
        {&grid->order, 4 * grid->particles},         {&grid->position, 16 * grid->particles},
        {&grid->sums, 4 * sum_count(grid)},          {&grid->slot_of, device->identity ? 0 : 4 * grid->particles}};
    for (int i = 0; i < PARTS; i++) parts[i] = all[i];
}

void sk_gpu_grid_free(sk_gpu_device *device) {
    sk_gpu_grid *grid = &device->grid;
    part parts[PARTS];
    list_parts(device, parts);
    if (grid->texture) glDeleteTextures(1, &grid->texture);
    grid->texture = 0;
    for (int i = 0; i < PARTS; i++) sk_gpu_buffer_free(device, parts[i].buffer, parts[i].bytes);
    grid->particles = grid->room = 0;
}

static skein_status make_buffers(sk_gpu_device *device, const skein_world *world, skein_error *error) {
    sk_gpu_grid *grid = &device->grid;
    GLint texels = 0;
    glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
    if (device->particle_count > (size_t)texels)
        return sk_fail(error, SKEIN_ERROR_LIMIT, "device",
                       "%zu particles with neighbours: this driver reads at most %d", device->particle_count, texels);
    grid->particles = device->particle_count;
    grid->room = (device->particle_count + 2 * BLOCK_CELLS - 1) / BLOCK_CELLS * BLOCK_CELLS;
    part parts[PARTS];
    list_parts(device, parts);
    skein_status status = SKEIN_OK;
    for (int i = 0; i < PARTS && !status; i++)
        if (parts[i].bytes) status = sk_gpu_buffer(device, parts[i].bytes, parts[i].buffer, error);
    if (status) return status;
    glCreateTextures(GL_TEXTURE_BUFFER, 1, &grid->texture);
    glTextureBuffer(grid->texture, GL_RGBA32F, grid->position);
    if (!device->identity)
        glNamedBufferSubData(grid->slot_of, 0, (GLsizeiptr)(4 * grid->particles), world->particles.slot_of);
    grid->begin = grid->end = 0;
    return SKEIN_OK;
}

skein_status sk_gpu_grid_make(sk_gpu_device *device, skein_world *world, skein_error *error) {
    skein_status status = make_programs(device, world, error);
    if (status) return status;
    bool same = device->grid.particles == device->particle_count && device->grid.particles && device->identity;
    if (same) return SKEIN_OK;
    sk_gpu_grid_free(device);
    status = make_buffers(device, world, error);
    if (status) sk_gpu_grid_free(device);
    return status;
}

void sk_gpu_grid_pack(const sk_gpu_grid *grid, const sk_op *op, float (*block)[4]) {
    const sk_group *group = op->group;
    const uint32_t head[4] = {(uint32_t)(group->end - group->first), (uint32_t)(grid->room - 2), (uint32_t)group->first,
                              0};
    memcpy(block[0], head, sizeof head);
    block[1][0] = (float)op->coefficient[0];
}

static void run_program(const sk_gpu_device *device, int which, size_t groups) {
    glUseProgram(device->grid.program[which]);
    sk_gpu_dispatch(device, groups * SK_GPU_GROUP);
}

void sk_gpu_grid_build(sk_gpu_device *device, size_t begin, size_t count, size_t block) {
    sk_gpu_grid *grid = &device->grid;
    const unsigned buffers[] = {device->vector[SK_X], device->vector[SK_V], grid->cells, grid->number,
                                grid->order,          grid->position,       grid->sums,  grid->slot_of};
    glBindBufferRange(GL_UNIFORM_BUFFER, 0, device->blocks, (GLintptr)block, SK_GPU_GRID_BLOCK * 16);
    for (GLuint i = 0; i < 8; i++) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, i, buffers[i]);
    size_t groups = (count + SK_GPU_GROUP - 1) / SK_GPU_GROUP;
    if (grid->begin != begin || grid->end != begin + count) {
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        glClearNamedBufferSubData(grid->cells, GL_R32UI, 0, 6 * 4, GL_RED_INTEGER, GL_UNSIGNED_INT, NULL);
        run_program(device, FIND, groups);
        grid->begin = begin, grid->end = begin + count;
    }
    run_program(device, FRAME, 1);
    run_program(device, CLEAR, (grid->room + SK_GPU_GROUP - 1) / SK_GPU_GROUP);
    run_program(device, COUNT, groups);
    run_program(device, SUM_PARTS, sum_count(grid));
    run_program(device, SUM_SUMS, 1);
    run_program(device, SUM_CELLS, sum_count(grid));
    run_program(device, SCATTER, groups);
    run_program(device, SETTLE, groups);
}

void sk_gpu_grid_bind(const sk_gpu_grid *grid) {
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 5, grid->cells);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 6, grid->number);
    if (grid->slot_of) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 7, grid->slot_of);
    glBindTextureUnit(0, grid->texture);
}
