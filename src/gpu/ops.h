/* What single ops are on a card: their text, their part of the block.
 * Called by compose.c. */
#ifndef SK_GPU_OPS_H
#define SK_GPU_OPS_H

#include "gpu/compose.h"

/* Whether there is a text for it, and it can run as it is set now; else `why` not, where there is more to say. */
bool sk_gpu_op_can(const sk_op *op, const char **why);
/* Whether an op over neighbours moves all particles, and they look at all. */
bool sk_gpu_op_everyone(const sk_op *op, size_t particle_count);
/* Whether it is the same for every slot. */
bool sk_gpu_op_knows_no_slots(const sk_op *op, size_t particle_count);
/* The size of its part of the block, in vectors. */
size_t sk_gpu_op_size(const sk_op *op);
void sk_gpu_op_pack(const sk_op *op, const sk_run *run, float (*block)[4]);
/* Whether it is another at another time: a moving collider's, a formula's of time. */
bool sk_gpu_op_moves(const sk_op *op);
/* Whether it looks at the position of one particle, which is to be in its block; nobody may move that in the same pass.
 * Then: in which vector of its part of the block, and what the packed block says is the particle's slot. */
bool sk_gpu_op_has_target(const sk_op *op);
size_t sk_gpu_op_target_to(void);
size_t sk_gpu_op_target_from(const float (*block)[4]);

/* Its members of the block; what stands before main; what stands in main. `number` is its place in the shader. */
void sk_gpu_put_members(sk_gpu_text *text, const sk_op *op, size_t number);
void sk_gpu_put_functions(sk_gpu_text *text, const sk_op *const *ops, size_t number);
void sk_gpu_put_statements(sk_gpu_text *text, const sk_op *op, size_t number, size_t particle_count);
const char *sk_gpu_vector_name(sk_vector vector);

#endif
