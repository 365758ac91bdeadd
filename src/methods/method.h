/* Methods: how rules become motion. Each type is one file that writes its substep as rows of the plan;
 * no method touches a particle itself. */
#ifndef SK_METHODS_METHOD_H
#define SK_METHODS_METHOD_H

#include "base/fields.h"
#include "methods/writer.h"

typedef struct sk_method_type {
    skein_kind kind;
    /* Whether the method can run the rules at all; NULL: always. */
    skein_status (*check)(const void *params, const sk_rules *rules, skein_error *error);
    /* Writes the rows of one step of `dt` seconds. */
    void (*write)(sk_writer *writer, const void *params, double dt);
    int (*substeps)(const void *params);
} sk_method_type;

/* For methods that need finite forces: names the first rigid batch. */
skein_status sk_refuse_rigid(const sk_rules *rules, const char *method, skein_error *error);

extern const sk_method_type sk_symplectic_euler, sk_xpbd;

#endif
