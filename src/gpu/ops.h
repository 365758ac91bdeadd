/* What single ops are on a card: their text, their part of the block.
 * Called by compose.c. */
#ifndef SK_GPU_OPS_H
#define SK_GPU_OPS_H

#include "gpu/compose.h"

/* Whether there is a text for it, and it can run with its present parameters; else `why` may say the reason. */
bool sk_gpu_op_can(const sk_op *op, const char **why);
/* Whether an op over neighbours moves all particles, and all are their neighbours. */
bool sk_gpu_op_everyone(const sk_op *op, size_t particle_count);
/* Whether it does the same in every slot. */
bool sk_gpu_op_knows_no_slots(const sk_op *op, size_t particle_count);
/* The size of its part of the block, in vectors. */
size_t sk_gpu_op_size(const sk_op *op);
void sk_gpu_op_pack(const sk_op *op, const sk_run *run, float (*block)[4]);
/* Whether it depends on time: that of a moving collider, or of a formula of t. */
bool sk_gpu_op_moves(const sk_op *op);
/* Whether it reads the position of one particle, from its block; no op may move that in the same pass. If so: in which
 * vector of its part of the block that is, and the particle's slot from the packed block. */
bool sk_gpu_op_has_target(const sk_op *op);
size_t sk_gpu_op_target_to(void);
size_t sk_gpu_op_target_from(const float (*block)[4]);

/* Write its members of the block, its functions, and its statements in main. `number` is its place in the shader. */
void sk_gpu_put_members(sk_gpu_text *text, const sk_op *op, size_t number);
void sk_gpu_put_functions(sk_gpu_text *text, const sk_op *const *ops, size_t number);
void sk_gpu_put_statements(sk_gpu_text *text, const sk_op *op, size_t number, size_t particle_count);
const char *sk_gpu_vector_name(sk_vector vector);

#endif
