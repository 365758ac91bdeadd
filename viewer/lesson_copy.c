/* A lesson's own memory: room for operations, and copies for the window; see lesson.h. */
#include <stdlib.h>
#include <string.h>

#include "viewer/lesson.h"

void viewer_lesson_release(viewer_lesson *lesson) {
    free(lesson->operations);
    free(lesson->derivatives);
    memset(lesson, 0, sizeof *lesson);
}

bool viewer_lesson_reserve(viewer_lesson *lesson, size_t operations, size_t derivatives) {
    if (operations > lesson->operation_room) {
        skein_operation *grown = realloc(lesson->operations, operations * sizeof *grown);
        if (!grown) return false;
        lesson->operations = grown, lesson->operation_room = operations;
    }
    if (derivatives > lesson->derivative_room) {
        double *grown = realloc(lesson->derivatives, derivatives * sizeof *grown);
        if (!grown) return false;
        lesson->derivatives = grown, lesson->derivative_room = derivatives;
    }
    return true;
}

bool viewer_lesson_copy(viewer_lesson *to, const viewer_lesson *from) {
    size_t derivatives = 3 * from->operation_count * from->particle_count;
    bool good = viewer_lesson_reserve(to, from->operation_count, derivatives);
    viewer_lesson own = *to;
    *to = *from;
    to->operations = own.operations, to->operation_room = own.operation_room;
    to->derivatives = own.derivatives, to->derivative_room = own.derivative_room;
    if (!good) to->operation_count = 0;
    if (to->operation_count) memcpy(to->operations, from->operations, from->operation_count * sizeof *to->operations);
    if (to->operation_count) memcpy(to->derivatives, from->derivatives, derivatives * sizeof *to->derivatives);
    return good;
}
