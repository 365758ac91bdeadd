/* What methods share: their substeps, what they refuse, and the amplification of Runge-Kutta methods. */
#include "methods/method.h"

#include "base/status.h"

int sk_substeps_of(const void *params) {
    return ((const sk_substeps *)params)->substeps;
}

skein_status sk_method_check(const sk_method_type *method, const void *params, const sk_rules *rules,
                             skein_error *error) {
    skein_status status = method->check ? method->check(params, rules, error) : SKEIN_OK;
    const sk_batch *rigid = method->takes_rigid ? NULL : sk_first_rigid_batch(rules);
    if (status || !rigid) return status;
    return sk_fail(error, SKEIN_ERROR_VALUE, "method.type",
                   "%s needs finite stiffness, but '%s' is rigid: give it a stiffness or use xpbd", method->kind.name,
                   rigid->label);
}

/* matrix = c + zA matrix, with A = (0 1; -1 -2 zeta): one step of Horner's scheme. */
static void raise(double z, double zeta, double c, double m[4]) {
    double x[2] = {m[2], m[3]}, v[2] = {-m[0] - 2 * zeta * m[2], -m[1] - 2 * zeta * m[3]};
    m[0] = c + z * x[0], m[1] = z * x[1];
    m[2] = z * v[0], m[3] = c + z * v[1];
}

void sk_amplify_polynomial(double z, double zeta, const double c[4], double matrix[4]) {
    matrix[0] = matrix[3] = c[3];
    matrix[1] = matrix[2] = 0;
    raise(z, zeta, c[2], matrix);
    raise(z, zeta, c[1], matrix);
    raise(z, zeta, c[0], matrix);
    raise(z, zeta, 1, matrix);
}
