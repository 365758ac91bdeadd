/* Recordings: all that is done to a world and what came of it, so that it can be done again and compared.
 *
 *     skein_recorder to = {.write = put, .user = file, .note = "what it is of"};
 *     skein_record_begin(world, &to);   the state as it stands, then every call that changes it, and every step
 *     ...
 *     skein_record_end(world);
 *
 * and in a world that was built by the same calls
 *
 *     skein_replay(other, bytes, size, &difference, &error);
 *
 * which names the first step, and the first particle in it, that came out otherwise. docs/recording.md has the layout.
 */
#ifndef SKEIN_RECORD_H
#define SKEIN_RECORD_H

#include <skein/skein.h>

#ifdef __cplusplus
extern "C" {
#endif
#if defined(__GNUC__)
#pragma GCC visibility push(default)
#endif

/* Where a recording goes. */
typedef struct skein_recorder {
    /* Takes its bytes, part after part; false ends it. */
    bool (*write)(void *user, const void *bytes, size_t size);
    void *user;
    const char *note; /* a text that is kept at its beginning, what built the world, say; NULL: none */
} skein_recorder;

/* Begins to record. The recorder is copied. Recorded are steps and what is set: fields, the method, positions,
 * velocities, who is held, places of pins, teleports, vertices of colliders, the clock, resets, snapshots that are read. Adding or removing
 * objects or particles ends the recording, and it says so at its end. What writes past the calls (through a view's
 * pointer) is not recorded: replaying finds it. Costs about half a byte a particle and step, and a look at each. Fails
 * with SKEIN_ERROR_VALUE where one is running, SKEIN_ERROR_MEMORY, and SKEIN_ERROR_FILE where it could not be written.
 */
skein_status skein_record_begin(skein_world *world, const skein_recorder *recorder);
/* Ends it with the state as it stands. Fails with SKEIN_ERROR_VALUE where none is running, and with SKEIN_ERROR_FILE
 * where some of it could not be written. A world that goes ends its recording. */
skein_status skein_record_end(skein_world *world);

typedef struct skein_recording_info {
    uint32_t version, real_size;
    const char *note; /* within the bytes; "" where there is none */
} skein_recording_info;
/* Looks at the beginning of a recording. Fails with SKEIN_ERROR_SYNTAX and SKEIN_ERROR_LIMIT (a newer version). */
skein_status skein_recording_look(const void *bytes, size_t size, skein_recording_info *info, skein_error *error);

/* What a replay found. */
typedef struct skein_difference {
    uint64_t steps; /* that came out the same */
    bool found;     /* and then one that did not: all below is about the state after `steps` steps */
    bool exact;     /* only this particle differs among the 64 that were looked at together; else the first of these */
    bool position, velocity;   /* what differs */
    uint32_t particle, blocks; /* blocks: how many lots of 64 differ */
    skein_handle body;         /* that has the particle; of no object where it is loose */
    bool is_whole;             /* the recording was ended; else it breaks off, and all that is there was replayed */
    char stopped[160];         /* why recording stopped before its end; "" where it did not */
} skein_difference;

/* Does again what was recorded, in a world that was built as the recorded one was. Nothing of `bytes` is trusted. Fails
 * as skein_snapshot_read() does, with SKEIN_ERROR_SYNTAX for what is damaged, and where a recorded call fails; a
 * difference is no failure. */
skein_status skein_replay(skein_world *world, const void *bytes, size_t size, skein_difference *difference);

#if defined(__GNUC__)
#pragma GCC visibility pop
#endif
#ifdef __cplusplus
}
#endif
#endif
