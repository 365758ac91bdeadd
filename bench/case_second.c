/* Second derivatives of energies by tapes and as emitted C, beside the same by hand; and how long it takes from a text
 * to a tape that runs. */
#include <stdio.h>
#include <stdlib.h>

#include "bench/elements.h"

/* ---- second derivatives ---- */

/* Their size is that of the cache: by hand in blocks of as many elements as a tape's. */
static void measure(const bench_text *m, by_hand_function *by_hand, by_hand_function *emitted_second) {
    enum { TAPE, EMITTED, BY_HAND };
    bench_elements e;
    bench_tape tape;
    size_t coordinates = 3 * (size_t)m->particles, outputs = coordinates * (coordinates + 1) / 2;
    bench_elements_make(&e, m->solid, m->parameter_count, outputs);
    bench_tape_make(&tape, &e, m, true);
    bench_by_hand wide = bench_by_hand_of(&e, by_hand, 64), emitted = bench_by_hand_of(&e, emitted_second, 64);
    bench_check_by_hand(&e, &tape, &wide, m->name);
    bench_check_by_hand(&e, &tape, &emitted, m->name);
    bench_job jobs[] = {{.run = bench_tape_run, .data = &tape},
                        {.run = bench_by_hand_run, .data = &emitted},
                        {.run = bench_by_hand_run, .data = &wide}};
    double seconds[3];
    bench_measure(jobs, 3, 0.05, seconds);
    char size[80], note[120];
    snprintf(note, sizeof note, "%zu instructions, %zu registers, %zu elements a block", tape.tape.code.count,
             tape.tape.registers, tape.tape.wides * SK_LANES);
    for (int k = TAPE; k <= EMITTED; k++) {
        snprintf(size, sizeof size, "%s, %zu x %zu, %s", m->name, coordinates, coordinates, k ? "emitted" : "tape");
        bench_report(&(bench_result){.name = "second",
                                     .size = size,
                                     .ours = 1e9 * seconds[k] / (double)e.count,
                                     .unit = "ns/element",
                                     .other = "wide by hand",
                                     .theirs = 1e9 * seconds[BY_HAND] / (double)e.count,
                                     .as_long = 1.0,
                                     .note = k ? "" : note});
    }
    bench_tape_free(&tape);
    bench_elements_free(&e);
}

static void run_second(void) {
    for (size_t i = 0; i < BENCH_FORMULAS; i++)
        if (bench_functions_of[i].second)
            measure(&bench_texts[i], bench_functions_of[i].second, bench_functions_of[i].emitted_second);
}

const bench_case bench_second = {"second", "second derivatives by tapes and emitted C, against wide C by hand",
                                 run_second};

/* ---- from text to tape ---- */

typedef struct making {
    const bench_text *text;
    const bench_elements *elements;
    bool second;
} making;

/* The text is read, differentiated, made a tape and run on the first block of elements. */
static void make_and_run(void *data) {
    const making *m = data;
    bench_tape tape;
    bench_elements first = *m->elements;
    first.count = 128;
    bench_tape_make(&tape, &first, m->text, m->second);
    bench_tape_run(&tape);
    bench_tape_free(&tape);
}

static int compare_doubles(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void report_text(const char *size, double ms) {
    bench_report(
        &(bench_result){.name = "text", .size = size, .ours = ms, .unit = "ms", .under = 1, .note = "one block"});
}

static void run_text(void) {
    double first[BENCH_FORMULAS], all[BENCH_FORMULAS];
    for (size_t i = 0; i < BENCH_FORMULAS; i++) {
        const bench_text *m = &bench_texts[i];
        bench_elements e;
        bench_elements_make(&e, m->solid, m->parameter_count, 0);
        making gradient = {m, &e, false}, second = {m, &e, true};
        bench_job jobs[] = {{.run = make_and_run, .data = &gradient}, {.run = make_and_run, .data = &second}};
        double seconds[2];
        bench_measure(jobs, 2, 0.02, seconds);
        first[i] = 1e3 * seconds[0], all[i] = 1e3 * seconds[1];
        report_text(m->name, first[i]);
        bench_elements_free(&e);
    }
    qsort(first, BENCH_FORMULAS, sizeof *first, compare_doubles);
    qsort(all, BENCH_FORMULAS, sizeof *all, compare_doubles);
    report_text("median", first[BENCH_FORMULAS / 2]);
    report_text("median, second derivatives", all[BENCH_FORMULAS / 2]);
}

const bench_case bench_text_to_tape = {"text", "from a formula's text to its tape's first block", run_text};
