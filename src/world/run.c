/* The runner: one loop over ops, whatever the rules and the method.
 *
 * Ops are taken in *segments*. A segment that walks along strips is run in chunks of strip rows: all of
 * its ops over the first chunk, then all over the next, so that what an op has touched is still in the
 * cache for the following one. Each op lags behind the one before it by its reach, and the answer is
 * that of one op after the other, bit for bit:
 *
 *   strip ops     0 . . . . . . . . . . . .          op g of the segment does, in chunk k, the strip rows
 *   op 0          [ chunk 0 )[ chunk 1 )[ ..         [k B - lag(g), (k + 1) B - lag(g)),
 *   op 1          [ chunk 0)[ chunk 1 )[ ...         with lag(g) = lag(g - 1) + reach(g), and where op g - 1
 *   op 2          [chunk )[ chunk 1 )[ .....         is free and reads around itself, + reach(g - 1)
 *
 * Threads own chunks that follow each other: chunk k does an ordered op when chunk k - 1 has done it, and a
 * free one when chunk k - 1 has done those before it. Where a repeat has iterations enough, a thread is an iteration
 * behind the one above it, and both walk small chunks; else each has one large chunk, and is an op behind.
 * (Barriers after each op, tiles with seams and cuts by columns were measured slower or less firm.)
 * Free ops that follow each other go over a chunk in small tiles, which stay in the nearest cache.
 * Other free ops are cut over the threads; other ordered ops run on the caller, whole. */
#include <stdatomic.h>
#include <time.h>

#include "base/float_mode.h"
#include "world/world.h"

enum {
    MOST_SEGMENT = 192, /* ops of a segment */
    MOST_CHUNKS = 4096,
    TILE = 128,             /* slots: the vectors of a few ops stay in the nearest cache; 512 cost a substep 15 % */
    CHUNK_BYTES = 16 << 10, /* of one vector in a chunk: in the first cache with its neighbours */
    SECOND_CACHE_BYTES = 512 << 10, /* of one vector in the iterations that one thread has under way */
    LEAST_ITERATIONS = 4,           /* a thread: with fewer, threads start together on large chunks */
    LONG_LAG = 8,                   /* ops, of a whole segment, */
    FAR_LAG = 20,                   /* as a mesh's has; */
    LEAST_CHUNKS = 4,               /* a thread, where they are made longer than the cache asks for */
    LINE = 16,                      /* counts in a cache line */
    MOST_THREADS = 256,             /* in one walk */
};

/* ---- segments ---- */

static bool same_strips(const sk_walk *a, const sk_walk *b) {
    return a->first_slot == b->first_slot && a->rows == b->rows && a->width == b->width;
}

/* How many ops from the first on make one segment, and the strips that they walk along (rows = 0: none). */
static size_t segment_length(const sk_op *ops, size_t count, sk_walk *walk) {
    *walk = (sk_walk){0, 0, 0, 0};
    size_t length = 0;
    for (; length < count && length < MOST_SEGMENT; length++) {
        const sk_op *op = &ops[length];
        if (sk_op_type_of(op)->leads) break;
        if (op->walk.rows) {
            if (walk->rows && !same_strips(walk, &op->walk)) break;
            *walk = op->walk;
        } else if (op->order != SK_FREE || op->by_particle || op->alone) {
            break;
        }
    }
    return length;
}

/* ---- a segment in chunks ---- */

typedef struct segment_job {
    const sk_run *run;
    const sk_op *ops;
    size_t count, iterations;
    double start, dt; /* of the first iteration; 0 iterations' worth of time where the segment is not a whole repeat */
    sk_walk walk;
    size_t lag[MOST_SEGMENT];
    size_t chunk_rows, chunk_count, threads;
    size_t head; /* ops that the first chunk has more, for those by which its ops lag and which it leaves to others */
    size_t first_chunk[MOST_THREADS + 1]; /* of each thread, where there are several */
    size_t ahead;                         /* chunks whose last iteration must be over before a chunk begins the next */
    size_t iterations_abreast;            /* how many iterations one thread alone has under way */
    _Atomic uint32_t *progress;           /* ops done, of each chunk, where there are several threads */
} segment_job;

/* Free ops of slots, one after the other over each tile of [begin, end). */
static void run_tiled(sk_run *run, const sk_op *ops, size_t count, size_t begin, size_t end) {
    for (size_t tile = begin; tile < end; tile += TILE) {
        size_t tile_end = tile + TILE < end ? tile + TILE : end;
        for (size_t g = 0; g < count; g++) {
            size_t first = tile > ops[g].begin ? tile : ops[g].begin,
                   last = tile_end < ops[g].end ? tile_end : ops[g].end;
            if (first < last && sk_op_is_due(run, &ops[g])) ops[g].kernel(run, &ops[g], first, last);
        }
    }
}

/* How many ops from g on are run together: free ops of slots. */
static size_t together(const segment_job *job, size_t g) {
    size_t count = 0;
    while (g + count < job->count && !job->ops[g + count].walk.rows) count++;
    return count ? count : 1;
}

/* Where a chunk begins, but for the lag. */
static size_t start_of(const segment_job *job, size_t chunk) {
    return chunk ? job->head + chunk * job->chunk_rows : 0;
}

/* The part of ops [g, g + count) that belongs to a chunk: strip rows, or the slots of them. */
static void run_part(sk_run *run, const segment_job *job, size_t g, size_t count, size_t chunk) {
    const sk_op *op = &job->ops[g];
    size_t first = start_of(job, chunk), last = start_of(job, chunk + 1), lag = job->lag[g];
    first = first > lag ? first - lag : 0;
    last = chunk + 1 == job->chunk_count ? job->walk.rows : last > lag ? last - lag : 0;
    if (op->walk.rows) {
        if (last > op->end) last = op->end;
        if (first < last && sk_op_is_due(run, op)) op->kernel(run, op, first, last);
        return;
    }
    // slots before and after the strips go with the first and last chunk
    size_t line = job->walk.width * 16, begin = job->walk.first_slot + first * line,
           end = job->walk.first_slot + last * line;
    if (chunk == 0) begin = 0;
    if (chunk + 1 == job->chunk_count) end = run->slot_count;
    run_tiled(run, op, count, begin, end);
}

/* The time of an iteration's end, and whether it is the last, where the segment is a whole repeat. */
static void set_iteration(sk_run *run, const segment_job *job, size_t iteration) {
    if (!(job->dt > 0)) return;
    run->time = job->start + (double)(iteration + 1) * job->dt;
    run->iteration = iteration;
    run->turn = job->run->turn + iteration * run->turns;
    run->last_iteration = iteration + 1 == job->iterations;
}

/* How many ops of a chunk are done, counted over all iterations. Threads' counts lie in different cache lines. */
static _Atomic uint32_t *progress_of(const segment_job *job, size_t chunk) {
    size_t thread = 0;
    while (chunk >= job->first_chunk[thread + 1]) thread++;
    return &job->progress[chunk + LINE * thread];
}

/* Strip rows of all of an iteration's ops that are in the first `chunks` chunks: fewer in the first ones, by their lag.
 */
static size_t work_before(const segment_job *job, size_t chunks) {
    size_t sum = 0, end = start_of(job, chunks);
    if (chunks == job->chunk_count) return job->count * job->walk.rows;
    for (size_t g = 0; g < job->count; g++) sum += end > job->lag[g] ? end - job->lag[g] : 0;
    return sum;
}

/* Gives threads chunks of as much work each: by number, the last thread had all that lags behind, and of a mesh, whose
 * rows lag far, twice as much as the first. */
static void share_chunks(segment_job *job) {
    size_t chunk = 0, all = work_before(job, job->chunk_count);
    job->first_chunk[0] = 0;
    for (size_t t = 1; t < job->threads; t++) {
        size_t share = all / job->threads * t;
        while (chunk < job->chunk_count && work_before(job, chunk) < share) chunk++;
        // the nearer of both, and one for each thread
        if (chunk > job->first_chunk[t - 1] + 1 && work_before(job, chunk) - share > share - work_before(job, chunk - 1))
            chunk--;
        if (chunk <= job->first_chunk[t - 1]) chunk = job->first_chunk[t - 1] + 1;
        if (chunk > job->chunk_count - job->threads + t) chunk = job->chunk_count - job->threads + t;
        job->first_chunk[t] = chunk;
    }
    job->first_chunk[job->threads] = job->chunk_count;
}

/* One thread of several: its chunks, iteration by iteration. */
static void run_chunks(const segment_job *job, size_t thread) {
    sk_run run = *job->run; // a copy each: threads may be at different times
    size_t first = job->first_chunk[thread], end = job->first_chunk[thread + 1];
    for (size_t iteration = 0; iteration < job->iterations; iteration++) {
        set_iteration(&run, job, iteration);
        uint32_t before = (uint32_t)(iteration * job->count);
        for (size_t k = first; k < end; k++) {
            for (size_t next = end; next <= k + job->ahead && next < job->chunk_count; next++)
                sk_wait_for(progress_of(job, next), before);
            for (size_t g = 0, count; g < job->count; g += count) {
                count = together(job, g);
                uint32_t done = before + (uint32_t)g;
                if (k && k == first) sk_wait_for(progress_of(job, k - 1), done + (job->ops[g].order == SK_ORDERED));
                run_part(&run, job, g, count, k);
                atomic_store_explicit(progress_of(job, k), done + (uint32_t)count, memory_order_release);
            }
        }
    }
}

/* One thread alone: several iterations follow each other down the chunks, so that the second cache serves them all. */
static void run_chunks_alone(const segment_job *job) {
    sk_run run = *job->run;
    for (size_t first = 0; first < job->iterations; first += job->iterations_abreast) {
        size_t abreast =
            first + job->iterations_abreast < job->iterations ? job->iterations_abreast : job->iterations - first;
        for (size_t front = 0; front < job->chunk_count + (abreast - 1) * job->ahead; front++)
            for (size_t t = 0; t < abreast && t * job->ahead <= front; t++) {
                size_t k = front - t * job->ahead;
                if (k >= job->chunk_count) continue;
                set_iteration(&run, job, first + t);
                for (size_t g = 0, count; g < job->count; g += count) {
                    count = together(job, g);
                    run_part(&run, job, g, count, k);
                }
            }
    }
}

/* Chooses the size of chunks: small enough for the cache, and large enough for threads to keep pace. */
static void cut_chunks(segment_job *job, int threads) {
    size_t lag = 0, lags = 0, line_bytes = job->walk.width * 16 * sizeof(sk_vec4), rows = job->walk.rows;
    for (size_t g = 0; g < job->count; g++) {
        lags += job->lag[g] = lag += job->ops[g].walk.reach;
        if (job->ops[g].order == SK_FREE) lag += job->ops[g].walk.reach;
    }
    size_t chunk = CHUNK_BYTES / line_bytes / 4 * 4;
    if (chunk < 4) chunk = 4;
    // a lattice's rows lag so far that all of it is under way at once, and what is called for a few rows costs
    if (chunk < LONG_LAG && lag >= LONG_LAG) chunk = LONG_LAG;
    if (threads > 1 && job->iterations < (size_t)threads * LEAST_ITERATIONS) {
        chunk = rows / (size_t)threads / 4 * 4;
        if (chunk < lag + 4) chunk = (lag + 7) / 4 * 4;
        job->head = lags / job->count;
    }
    // as much is under way if a chunk is as long as the lag, and slots, rest values and the like are read in longer pieces;
    // packed strips read none
    size_t longer = lag / 4 * 4 + 4;
    bool packed = job->walk.first_slot < job->ops[0].packed;
    if (!packed && lag >= FAR_LAG && chunk < longer && rows >= longer * (size_t)threads * LEAST_CHUNKS) chunk = longer;
    if (rows / chunk > MOST_CHUNKS) chunk = rows / MOST_CHUNKS + 1;
    job->chunk_rows = chunk;
    job->chunk_count = rows / chunk ? rows / chunk : 1;
    job->ahead = lag / chunk + 1;
    size_t abreast = SECOND_CACHE_BYTES / (job->ahead * chunk * line_bytes);
    job->iterations_abreast = abreast < 1 ? 1 : abreast;
    job->threads = (size_t)threads < job->chunk_count ? (size_t)threads : job->chunk_count;
    if (job->threads > MOST_THREADS) job->threads = MOST_THREADS;
}

/* A task; there may be fewer threads in the walk than tasks. */
static void run_chunks_of_thread(void *data, int thread) {
    const segment_job *job = data;
    uint64_t mode = sk_float_mode_enter();
    if ((size_t)thread < job->threads) run_chunks(job, (size_t)thread);
    sk_float_mode_leave(mode);
}

static void run_walk(sk_run *run, sk_tasks *tasks, const sk_op *ops, size_t count, const sk_walk *walk,
                     size_t iterations, double start, double dt) {
    segment_job job = {
        .run = run, .ops = ops, .count = count, .iterations = iterations, .start = start, .dt = dt, .walk = *walk};
    int threads = sk_tasks_together(tasks) && walk->rows * walk->width * 16 >= 4096 ? sk_tasks_count(tasks) : 1;
    cut_chunks(&job, threads);
    if (job.threads == 1) {
        run_chunks_alone(&job);
        return;
    }
    share_chunks(&job);
    _Atomic uint32_t progress[MOST_CHUNKS + LINE * MOST_THREADS];
    job.progress = progress;
    for (size_t k = 0; k < job.chunk_count; k++) atomic_init(progress_of(&job, k), 0);
    sk_tasks_run(tasks, run_chunks_of_thread, &job);
}

/* ---- other segments: free ops of the same range, tile by tile; all else op by op ---- */

typedef struct free_job {
    sk_run *run;
    const sk_op *ops;
    size_t count;
} free_job;

static void run_tiles(void *data, size_t begin, size_t end) {
    const free_job *job = data;
    uint64_t mode = sk_float_mode_enter();
    if (job->count > 1) run_tiled(job->run, job->ops, job->count, begin, end);
    else if (sk_op_is_due(job->run, job->ops)) job->ops->kernel(job->run, job->ops, begin, end);
    sk_float_mode_leave(mode);
}

static void run_free(sk_run *run, sk_tasks *tasks, const sk_op *ops, size_t count) {
    size_t begin = ops[0].begin, end = ops[0].end;
    for (size_t g = 1; g < count; g++) {
        if (ops[g].begin < begin) begin = ops[g].begin;
        if (ops[g].end > end) end = ops[g].end;
    }
    free_job job = {run, ops, count};
    sk_parallel_for(tasks, begin, end, run_tiles, &job);
}

static void run_segments(sk_run *run, sk_tasks *tasks, const sk_op *ops, size_t count) {
    for (size_t r = 0; r < count;) {
        sk_walk walk;
        size_t length = segment_length(ops + r, count - r, &walk);
        if (walk.rows) {
            run_walk(run, tasks, ops + r, length, &walk, 1, run->time, 0);
        } else if (length) {
            run_free(run, tasks, ops + r, length);
        } else if (ops[r].order == SK_FREE) {
            run_free(run, tasks, ops + r, length = 1);
        } else {
            if (sk_op_is_due(run, &ops[r])) ops[r].kernel(run, &ops[r], ops[r].begin, ops[r].end);
            length = 1;
        }
        r += length;
    }
}

/* ---- ops that lead others: repeats, solves and their parts ---- */

double sk_seconds(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static void run_ops(sk_run *run, const sk_op *ops, size_t count);

/* The iterations of a repeat, one after the other; further repeats may lie within it. */
static void run_iterations(sk_run *run, const sk_op *repeat) {
    double start = run->time;
    size_t outer_iteration = run->iteration;
    bool outer = run->last_iteration;
    for (size_t iteration = 0; iteration < repeat->end; iteration++) {
        run->time = start + (double)(iteration + 1) * repeat->dt;
        run->iteration = iteration;
        run->last_iteration = iteration + 1 == repeat->end;
        run_ops(run, repeat + 1, repeat->length);
        run->turn += run->turns;
    }
    run->iteration = outer_iteration;
    run->last_iteration = outer;
}

static void run_repeat(sk_run *run, const sk_op *repeat) {
    sk_walk walk;
    if (run->seconds || segment_length(repeat + 1, repeat->length, &walk) != repeat->length || !walk.rows) {
        run_iterations(run, repeat);
        return;
    }
    // the whole repeat is one walk: threads need not meet between iterations
    double start = run->time;
    run_walk(run, run->tasks, repeat + 1, repeat->length, &walk, repeat->end, start, repeat->dt);
    run->time = start + (double)repeat->end * repeat->dt;
    run->turn += repeat->end * run->turns;
}

/* What the ops behind an op have taken, so far. */
static double taken_behind(const sk_run *run, const sk_op *op) {
    double sum = 0;
    for (size_t r = 1; run->seconds && r <= op->length; r++) sum += run->seconds[op - run->timed + (ptrdiff_t)r];
    return sum;
}

/* As many ops as go together, a solve with those that it leads: ops that lead none, up to the next that does; with a
 * clock, one. */
static size_t run_some(sk_run *run, const sk_op *ops, size_t count) {
    size_t length = 1;
    bool solves = sk_op_decides(ops);
    while (!run->seconds && !solves && length < count && !sk_op_type_of(&ops[length])->leads) length++;
    double begin = run->seconds ? sk_seconds() : 0, behind = taken_behind(run, ops);
    if (solves) ops->kernel(run, ops, ops->begin, ops->end);
    else run_segments(run, run->tasks, ops, length);
    if (run->seconds) run->seconds[ops - run->timed] += sk_seconds() - begin - (taken_behind(run, ops) - behind);
    return solves ? 1 + ops->length : length;
}

static void run_ops(sk_run *run, const sk_op *ops, size_t count) {
    for (size_t r = 0; r < count;) {
        const sk_op *op = &ops[r];
        bool waits = sk_op_type_of(op)->leads && !op->kernel; // what is no repeat does so for whoever decides
        if (op->kind == SK_OP_REPEAT) run_repeat(run, op);
        r += waits ? 1 + op->length : run_some(run, op, count - r);
    }
}

void sk_run_ops(sk_run *run, sk_tasks *tasks, const sk_op *ops, size_t count) {
    run->tasks = tasks;
    run->ops = run_ops;
    run->timed = ops;
    run_ops(run, ops, count);
}
