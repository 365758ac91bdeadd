/* skein_bench: speed as ratios within one run; see bench/README.md. This file reads the options and takes the time. */
#include "bench/bench.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/isa.h"

enum { BLOCKS = 5 };

bool bench_quick;
static int faults;

static const bench_case *const cases[] = {
    &bench_force,        &bench_sweep,  &bench_shapes,  &bench_substep, &bench_threads,   &bench_w1,
    &bench_default,      &bench_w2,     &bench_w3,      &bench_scale,   &bench_irregular, &bench_rope,
    &bench_settled,      &bench_memory, &bench_formula, &bench_kinds,   &bench_dual,      &bench_second,
    &bench_text_to_tape, &bench_flock,  &bench_changes, &bench_widths,  &bench_contact,   &bench_broad,
    &bench_field,        &bench_clips,
};
enum { CASES = sizeof cases / sizeof *cases };

/* ---- what goes wrong ---- */

void bench_stop(const char *format, ...) {
    va_list words;
    va_start(words, format);
    fputs("skein_bench: ", stderr);
    vfprintf(stderr, format, words);
    fputc('\n', stderr);
    va_end(words);
    exit(2);
}

void bench_fault(const char *format, ...) {
    va_list words;
    va_start(words, format);
    fputs("skein_bench: ", stderr);
    vfprintf(stderr, format, words);
    fputc('\n', stderr);
    va_end(words);
    faults++;
}

void *bench_allocate(size_t count, size_t size) {
    void *memory = calloc(count ? count : 1, size);
    if (!memory) bench_stop("no memory");
    return memory;
}

/* ---- timing ---- */

static double seconds_now(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int compare_doubles(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double time_block(const bench_job *job, size_t calls) {
    if (job->prepare) job->prepare(job->data);
    double start = seconds_now();
    for (size_t i = 0; i < calls; i++) job->run(job->data);
    return (seconds_now() - start) / (double)calls;
}

/* The second call tells how many fit: the first one may have something to set up. */
static size_t count_calls(const bench_job *job, double seconds) {
    if (job->calls) return job->calls;
    time_block(job, 1);
    double once = time_block(job, 1);
    return once > seconds ? 1 : (size_t)(seconds / (once > 1e-9 ? once : 1e-9)) + 1;
}

void bench_measure(const bench_job *jobs, size_t count, double seconds, double *median) {
    double block[BENCH_MOST_JOBS][BLOCKS];
    size_t calls[BENCH_MOST_JOBS];
    int blocks = bench_quick ? 1 : BLOCKS;
    if (bench_quick) seconds = 0;
    for (size_t i = 0; i < count; i++) calls[i] = count_calls(&jobs[i], seconds);
    for (int b = 0; b < blocks; b++)
        for (size_t i = 0; i < count; i++) block[i][b] = time_block(&jobs[i], calls[i]);
    for (size_t i = 0; i < count; i++) {
        qsort(block[i], (size_t)blocks, sizeof **block, compare_doubles);
        median[i] = block[i][blocks / 2];
    }
}

/* ---- the program ---- */

static void print_help(void) {
    puts("usage: skein_bench [--csv] [--save FOLDER] [--quick] [CASE...]\n"
         "Times Skein beside others in one process: medians of five blocks, in turns.\n"
         "A CASE is a case's name, or how one or several of them begin; without any, all cases run.\n\n"
         "  --csv          comma separated values instead of a table\n"
         "  --save FOLDER  the same values also as FOLDER/PROCESSOR.csv\n"
         "  --quick        small and short, only to see that every case works: the numbers mean nothing\n"
         "  --help         this\n\n"
         "Cases");
    for (size_t c = 0; c < CASES; c++) printf("  %-10s %s\n", cases[c]->name, cases[c]->help);
    puts("\nSKEIN_SIMD=sse, avx2 or avx512 chooses the instruction set of Skein's side.");
}

static bool is_wanted(const bench_case *c, char **names, int count) {
    for (int i = 0; i < count; i++)
        if (!strncmp(c->name, names[i], strlen(names[i]))) return true;
    return !count;
}

int main(int argc, char **argv) {
    bool csv = false;
    const char *folder = NULL;
    char **names = argv + 1; // the cases' names move to the front
    int count = 0;
    for (int a = 1; a < argc; a++) {
        if (!strcmp(argv[a], "--csv")) {
            csv = true;
        } else if (!strcmp(argv[a], "--quick")) {
            bench_quick = true;
        } else if (!strcmp(argv[a], "--help")) {
            print_help();
            return 0;
        } else if (!strcmp(argv[a], "--save") && a + 1 < argc) {
            folder = argv[++a];
        } else if (argv[a][0] == '-') {
            bench_stop("'%s' is no option, or lacks its value; --help lists them", argv[a]);
        } else {
            names[count++] = argv[a];
        }
    }
    for (int i = 0; i < count; i++) {
        bool any = false;
        for (size_t c = 0; c < CASES; c++) any |= is_wanted(cases[c], names + i, 1);
        if (!any) bench_stop("'%s' is no case; --help lists them", names[i]);
    }
    bench_report_open(csv, folder, sk_isa_text(sk_isa_choose()));
    for (size_t c = 0; c < CASES; c++)
        if (is_wanted(cases[c], names, count)) cases[c]->run();
    bench_report_close();
    return faults ? 1 : 0;
}
