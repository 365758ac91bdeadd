/* Faults of a mesh that do not stop a simulation but may surprise: said as warnings, with counts and
 * an example each. */
#ifndef SK_BODIES_FAULTS_H
#define SK_BODIES_FAULTS_H

#include "bodies/sheet.h"
#include "bodies/springs.h"
#include "world/world.h"

skein_status sk_report_faults(skein_world *world, const char *label, const sk_sheet *sheet, const sk_springs *springs,
                              skein_error *error);

#endif
