/* Tapes and emitted kernels beside other ways of letting a machine differentiate: a class of dual numbers, as a
 * textbook has it, and ADOL-C. Value and gradient of 100,000 elements gathered from a mesh. */
#include <stdio.h>

#include "bench/elements.h"

static void report(const bench_text *m, const char *of, const char *other, double ours, double theirs, double bar) {
    char size[40];
    snprintf(size, sizeof size, "%s, %s", m->name, of);
    bench_report(&(bench_result){.name = "dual",
                                 .size = size,
                                 .ours = ours,
                                 .unit = "ns/element",
                                 .other = other,
                                 .theirs = theirs,
                                 .faster = bar});
}

/* A distance is too short for bars: it is reported. */
static void measure(const bench_text *m, const bench_functions *by) {
    enum { TAPE, EMITTED, DUAL, ADOLC };
    bench_elements e;
    bench_tape tape;
    bench_elements_make(&e, m->solid, m->parameter_count, 1 + 3 * (size_t)m->particles);
    bench_tape_make(&tape, &e, m, false);
    bench_by_hand others[] = {bench_by_hand_of(&e, by->emitted, 128), bench_by_hand_of(&e, by->by_dual, 128),
                              bench_by_hand_of(&e, by->by_adolc, 128)};
    size_t count = by->by_adolc ? 3 : 2;
    bench_job jobs[4] = {{.run = bench_tape_run, .data = &tape}};
    for (size_t i = 0; i < count; i++) {
        bench_check_by_hand(&e, &tape, &others[i], m->name);
        jobs[1 + i] = (bench_job){.run = bench_by_hand_run, .data = &others[i]};
    }
    double ns[4];
    bench_measure(jobs, 1 + count, 0.05, ns);
    for (size_t i = 0; i < 1 + count; i++) ns[i] *= 1e9 / (double)e.count;
    bool barred = m->particles > 2;
    report(m, "tape", "dual numbers", ns[TAPE], ns[DUAL], barred ? 4 : 0);
    report(m, "emitted", "dual numbers", ns[EMITTED], ns[DUAL], barred ? 7 : 0);
    if (by->by_adolc) report(m, "tape", "ADOL-C", ns[TAPE], ns[ADOLC], 100);
    bench_tape_free(&tape);
    bench_elements_free(&e);
}

static void run(void) {
    if (!bench_functions_of[0].by_dual) {
        bench_say("no dual numbers in this build: it found no C++ compiler");
        return;
    }
    if (!bench_functions_of[0].by_adolc) bench_say("no ADOL-C in this build: 'tools/setup bench' installs it");
    for (size_t i = 0; i < BENCH_FORMULAS; i++) measure(&bench_texts[i], &bench_functions_of[i]);
}

const bench_case bench_dual = {"dual", "the same, and emitted kernels, against dual numbers and ADOL-C", run};
