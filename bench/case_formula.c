/* Tapes of formulas, and what is made from formulas otherwise: value and gradient of 100,000 elements gathered from a
 * mesh, beside the same by hand, by dual numbers and by ADOL-C; second derivatives; and the way from text to tape. */
#include <stdio.h>

#include "bench/elements.h"

static void measure(const bench_text *m, const bench_functions *by) {
    bench_elements e;
    bench_tape tape;
    bench_elements_make(&e, m->solid, m->parameter_count, 1 + 3 * (size_t)m->particles);
    bench_tape_make(&tape, &e, m, false);
    bench_by_hand scalar = bench_by_hand_of(&e, by->by_hand, 128), wide = bench_by_hand_of(&e, by->by_hand_wide, 128);
    bench_check_by_hand(&e, &tape, &scalar, m->name);
    bench_check_by_hand(&e, &tape, &wide, m->name);
    bench_job jobs[] = {{.run = bench_tape_run, .data = &tape},
                        {.run = bench_by_hand_run, .data = &scalar},
                        {.run = bench_by_hand_run, .data = &wide}};
    double seconds[3];
    bench_measure(jobs, 3, 0.05, seconds);
    char note[80];
    snprintf(note, sizeof note, "%zu instructions, %zu registers", tape.tape.code.count, tape.tape.registers);
    bench_result result = {.name = "formula",
                           .size = m->name,
                           .ours = 1e9 * seconds[0] / (double)e.count,
                           .unit = "ns/element",
                           .note = note};
    result.other = "scalar by hand", result.theirs = 1e9 * seconds[1] / (double)e.count;
    bench_report(&result);
    result.other = "wide by hand", result.theirs = 1e9 * seconds[2] / (double)e.count;
    result.as_long = 2.4;
    bench_report(&result);
    bench_tape_free(&tape);
    bench_elements_free(&e);
}

static void run(void) {
    for (size_t i = 0; i < BENCH_FORMULAS; i++) measure(&bench_texts[i], &bench_functions_of[i]);
}

const bench_case bench_formula = {"formula", "value and gradient of formulas, against scalar C by hand", run};
