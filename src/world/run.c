/* The runner: one loop over rows, whatever the rules and the method.
 *
 * Rows are taken in *segments*. A segment that walks along strips is run in chunks of strip rows: all of
 * its rows over the first chunk, then all over the next, so that what a row has touched is still in the
 * cache for the following one. Each row lags behind the one before it by its reach, and the answer is
 * that of one row after the other, bit for bit:
 *
 *   strip rows    0 . . . . . . . . . . . .          row g of the segment does, in chunk k, the strip rows
 *   row 0         [ chunk 0 )[ chunk 1 )[ ..         [k B - lag(g), (k + 1) B - lag(g)),
 *   row 1         [ chunk 0)[ chunk 1 )[ ...         with lag(g) = lag(g - 1) + reach(g)
 *   row 2         [chunk )[ chunk 1 )[ .....
 *
 * Threads take chunks in turn and follow each other: chunk k does row g when chunk k - 1 has done it.
 * (Barriers after each row, tiles with seams and cuts by columns were measured slower or less firm.)
 * Other free rows are cut over the threads; other ordered rows run on the caller, whole. */
#include <stdatomic.h>

#include "base/float_mode.h"
#include "world/world.h"

enum {
    MOST_SEGMENT = 96, /* rows of a segment */
    MOST_CHUNKS = 4096,
    CHUNK_BYTES =
        24 << 10,        /* of one vector in a chunk, where one thread runs: in the first cache with its neighbours */
    CHUNKS_A_THREAD = 1, /* more would shorten the start, and wait more often: worse wherever a core is shared */
};

/* ---- segments ---- */

static bool same_strips(const sk_walk *a, const sk_walk *b) {
    return a->first_slot == b->first_slot && a->rows == b->rows && a->width == b->width;
}

/* How many rows from the first on make one segment, and the strips that they walk along (rows = 0: none). */
static size_t segment_length(const sk_row *rows, size_t count, sk_walk *walk) {
    *walk = (sk_walk){0, 0, 0, 0};
    size_t length = 0;
    for (; length < count && length < MOST_SEGMENT; length++) {
        const sk_row *row = &rows[length];
        if (row->kind == SK_ROW_REPEAT) break;
        if (row->walk.rows) {
            if (walk->rows && !same_strips(walk, &row->walk)) break;
            *walk = row->walk;
        } else if (row->order != SK_FREE || row->by_particle) {
            break;
        }
    }
    return length;
}

/* ---- a segment in chunks ---- */

typedef struct segment_job {
    const sk_run *run;
    const sk_row *rows;
    size_t count, turns;
    double start, dt; /* of the first turn; 0 turns' worth of time where the segment is not a whole repeat */
    sk_walk walk;
    size_t lag[MOST_SEGMENT];
    size_t chunk_rows, chunk_count, threads;
    size_t ahead;               /* chunks whose last turn must be over before a chunk begins the next */
    _Atomic uint32_t *progress; /* rows done, of each chunk; NULL for one thread */
} segment_job;

/* The part of a row that belongs to a chunk: strip rows, or the slots of them. */
static void run_part(sk_run *run, const segment_job *job, size_t g, size_t chunk) {
    const sk_row *row = &job->rows[g];
    size_t first = chunk * job->chunk_rows, last = first + job->chunk_rows, lag = job->lag[g];
    first = first > lag ? first - lag : 0;
    last = chunk + 1 == job->chunk_count ? job->walk.rows : last > lag ? last - lag : 0;
    if (row->walk.rows) {
        if (last > row->end) last = row->end;
        if (first < last) row->kernel(run, row, first, last);
        return;
    }
    // slots before and after the strips go with the first and last chunk
    size_t line = job->walk.width * 16, begin = job->walk.first_slot + first * line,
           end = job->walk.first_slot + last * line;
    if (chunk == 0 || begin < row->begin) begin = row->begin;
    if (chunk + 1 == job->chunk_count || end > row->end) end = row->end;
    if (begin < end) row->kernel(run, row, begin, end);
}

static void run_chunks(void *data, int thread) {
    const segment_job *job = data;
    sk_run run = *job->run; // a copy each: threads may be at different times
    for (size_t turn = 0; turn < job->turns; turn++) {
        if (job->dt > 0) run.time = job->start + (double)(turn + 1) * job->dt;
        uint32_t before = (uint32_t)(turn * job->count);
        for (size_t k = (size_t)thread; k < job->chunk_count; k += job->threads) {
            for (size_t next = k + 1; job->progress && next <= k + job->ahead && next < job->chunk_count; next++)
                sk_wait_for(&job->progress[next], before);
            for (size_t g = 0; g < job->count; g++) {
                if (job->progress && k) sk_wait_for(&job->progress[k - 1], before + (uint32_t)g + 1);
                run_part(&run, job, g, k);
                if (job->progress)
                    atomic_store_explicit(&job->progress[k], before + (uint32_t)g + 1, memory_order_release);
            }
        }
    }
}

/* Chooses the size of chunks: small enough for the cache, and large enough for threads to keep pace. */
static void cut_chunks(segment_job *job, int threads) {
    size_t lag = 0, line_bytes = job->walk.width * 16 * sizeof(sk_vec4), rows = job->walk.rows;
    for (size_t g = 0; g < job->count; g++) job->lag[g] = lag += job->rows[g].walk.rows ? job->rows[g].walk.reach : 0;
    size_t chunk = CHUNK_BYTES / line_bytes / 4 * 4;
    if (chunk < 4) chunk = 4;
    if (threads > 1) {
        chunk = (rows / ((size_t)threads * CHUNKS_A_THREAD) + 3) / 4 * 4;
        if (chunk < lag + 4) chunk = (lag + 7) / 4 * 4;
    }
    if (rows / chunk > MOST_CHUNKS) chunk = rows / MOST_CHUNKS + 1;
    job->chunk_rows = chunk;
    job->chunk_count = rows / chunk ? rows / chunk : 1;
    job->ahead = lag / chunk + 1;
    job->threads = (size_t)threads < job->chunk_count ? (size_t)threads : job->chunk_count;
}

/* A task; there may be fewer threads in the walk than tasks. */
static void run_chunks_of_thread(void *data, int thread) {
    const segment_job *job = data;
    uint64_t mode = sk_float_mode_enter();
    if ((size_t)thread < job->threads) run_chunks(data, thread);
    sk_float_mode_leave(mode);
}

static void run_walk(sk_run *run, sk_tasks *tasks, const sk_row *rows, size_t count, const sk_walk *walk, size_t turns,
                     double start, double dt) {
    segment_job job = {
        .run = run, .rows = rows, .count = count, .turns = turns, .start = start, .dt = dt, .walk = *walk};
    int threads = sk_tasks_together(tasks) && walk->rows * walk->width * 16 >= 4096 ? sk_tasks_count(tasks) : 1;
    cut_chunks(&job, threads);
    if (job.threads == 1) {
        run_chunks(&job, 0);
        return;
    }
    _Atomic uint32_t progress[MOST_CHUNKS];
    for (size_t k = 0; k < job.chunk_count; k++) atomic_init(&progress[k], 0);
    job.progress = progress;
    sk_tasks_run(tasks, run_chunks_of_thread, &job);
}

/* ---- other segments: free rows of the same range, tile by tile; all else row by row ---- */

typedef struct free_job {
    sk_run *run;
    const sk_row *rows;
    size_t count;
} free_job;

static void run_tiles(void *data, size_t begin, size_t end) {
    const free_job *job = data;
    enum { TILE = 1024 };
    uint64_t mode = sk_float_mode_enter();
    for (size_t tile = begin; tile < end; tile += TILE) {
        size_t tile_end = tile + TILE < end ? tile + TILE : end;
        for (size_t g = 0; g < job->count; g++) {
            const sk_row *row = &job->rows[g];
            size_t first = tile > row->begin ? tile : row->begin, last = tile_end < row->end ? tile_end : row->end;
            if (first < last) row->kernel(job->run, row, first, last);
        }
    }
    sk_float_mode_leave(mode);
}

static void run_free(sk_run *run, sk_tasks *tasks, const sk_row *rows, size_t count) {
    size_t begin = rows[0].begin, end = rows[0].end;
    for (size_t g = 1; g < count; g++) {
        if (rows[g].begin < begin) begin = rows[g].begin;
        if (rows[g].end > end) end = rows[g].end;
    }
    free_job job = {run, rows, count};
    sk_parallel_for(tasks, begin, end, run_tiles, &job);
}

static void run_segments(sk_run *run, sk_tasks *tasks, const sk_row *rows, size_t count) {
    for (size_t r = 0; r < count;) {
        sk_walk walk;
        size_t length = segment_length(rows + r, count - r, &walk);
        if (walk.rows) {
            run_walk(run, tasks, rows + r, length, &walk, 1, run->time, 0);
        } else if (length) {
            run_free(run, tasks, rows + r, length);
        } else if (rows[r].order == SK_FREE) {
            run_free(run, tasks, rows + r, length = 1);
        } else {
            rows[r].kernel(run, &rows[r], rows[r].begin, rows[r].end);
            length = 1;
        }
        r += length;
    }
}

/* The turns of a repeat, one after the other; further repeats may lie within it. */
static void run_turns(sk_run *run, sk_tasks *tasks, const sk_row *repeat) {
    double start = run->time;
    for (size_t turn = 0; turn < repeat->end; turn++) {
        if (repeat->cell && run->cell[repeat->cell] != 0) break;
        if (!repeat->cell) run->time = start + (double)(turn + 1) * repeat->dt;
        sk_run_rows(run, tasks, repeat + 1, repeat->length);
    }
}

void sk_run_rows(sk_run *run, sk_tasks *tasks, const sk_row *rows, size_t count) {
    double start = run->time;
    for (size_t r = 0; r < count;) {
        const sk_row *row = &rows[r];
        if (row->kind != SK_ROW_REPEAT) {
            size_t length = 1;
            while (r + length < count && rows[r + length].kind != SK_ROW_REPEAT) length++;
            run_segments(run, tasks, row, length);
            r += length;
            continue;
        }
        sk_walk walk;
        if (!row->cell && segment_length(row + 1, row->length, &walk) == row->length && walk.rows) {
            // the whole repeat is one walk: threads need not meet between turns
            run_walk(run, tasks, row + 1, row->length, &walk, row->end, start, row->dt);
            run->time = start + (double)row->end * row->dt;
        } else {
            run_turns(run, tasks, row);
        }
        r += 1 + row->length;
    }
}
