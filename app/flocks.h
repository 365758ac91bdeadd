/* The order parameters of a world's flocks, noted now and then, for the report. */
#ifndef SKEIN_APP_FLOCKS_H
#define SKEIN_APP_FLOCKS_H

#include <jansson.h>
#include <skein/skein.h>

/* Measures every body of the kind "flock" and appends to `flocks`, an array with an object for each: its name and
 * lists over time. About the centre of the first attraction, else about the origin; groups are of birds that are
 * in reach of each other by the first flocking rule. False if there is no memory; the world's error says so. */
bool app_flocks_note(json_t *flocks, skein_world *world);
/* A line for each flock, as it was noted last. */
void app_flocks_print(const json_t *flocks);

#endif
