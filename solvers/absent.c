/* In place of cholmod.c where CHOLMOD is not there. */
#include <stdio.h>

#include "solvers/cholmod.h"

bool skein_cholmod_is_here(void) {
    return false;
}

skein_status skein_cholmod_attach(skein_world *world, skein_error *error) {
    (void)world;
    if (error) {
        *error = (skein_error){SKEIN_ERROR_VALUE, "", ""};
        snprintf(error->message, sizeof error->message,
                 "Skein was built without CHOLMOD: 'tools/setup build' installs it, then build again");
    }
    return SKEIN_ERROR_VALUE;
}
