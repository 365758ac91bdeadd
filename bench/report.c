/* What is printed and kept: a line a result, with its bar and whether that was reached. */
#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/utsname.h>
#include <unistd.h>

#include "bench/bench.h"

static bool as_csv;
static FILE *kept; /* the file of this processor's results, or NULL */
static int bars, reached;

/* ---- the machine ---- */

/* The processor's name; where the kernel does not tell it, the machine's sort. */
static void find_processor(char *name, size_t size) {
    struct utsname machine;
    snprintf(name, size, "%s", uname(&machine) ? "unknown" : machine.machine);
    FILE *file = fopen("/proc/cpuinfo", "r");
    if (!file) return;
    char line[256];
    while (fgets(line, sizeof line, file)) {
        const char *colon = strchr(line, ':');
        if (!colon || strncmp(line, "model name", 10)) continue;
        snprintf(name, size, "%.*s", (int)strcspn(colon + 2, "\n"), colon + 2);
        break;
    }
    fclose(file);
}

/* Small letters and digits, all else as single hyphens; what stands in round brackets is left out. */
static void make_file_name(char *name, size_t size, const char *processor) {
    size_t length = 0;
    bool bracket = false;
    for (const char *p = processor; *p && length + 2 < size; p++) {
        unsigned char letter = (unsigned char)*p;
        if (letter == '(') bracket = true;
        else if (letter == ')') bracket = false;
        else if (bracket) continue;
        else if (isalnum(letter)) name[length++] = (char)tolower(letter);
        else if (length && name[length - 1] != '-') name[length++] = '-';
    }
    while (length && name[length - 1] == '-') length--;
    name[length] = 0;
}

static void print_machine(FILE *out, const char *processor, const char *isa) {
    fprintf(out, "# processor: %s, %ld on line\n", processor, sysconf(_SC_NPROCESSORS_ONLN));
#if defined(__clang__)
    fprintf(out, "# compiler: clang %s\n", __clang_version__);
#else
    fprintf(out, "# compiler: gcc %s\n", __VERSION__);
#endif
    fprintf(out, "# Skein: %s, %s\n", isa, sizeof(skein_real) == sizeof(double) ? "double" : "float");
#ifdef BENCH_BULLET
    fprintf(out, "# Bullet: %s\n", BENCH_BULLET);
#else
    fprintf(out, "# Bullet: not in this build\n");
#endif
#ifdef BENCH_ADOLC
    fprintf(out, "# ADOL-C: %s\n", BENCH_ADOLC);
#else
    fprintf(out, "# ADOL-C: not in this build\n");
#endif
    if (bench_quick) fprintf(out, "# quick: these numbers mean nothing\n");
}

static const char csv_head[] = "case,size,ours,unit,theirs,other,ratio,of,bar,reached,stretch mean %,stretch p99 %,"
                               "stretch max %,their mean %,their p99 %,their max %,note\n";

void bench_report_open(bool csv, const char *folder, const char *isa) {
    char processor[200], name[200], path[1024];
    as_csv = csv;
    find_processor(processor, sizeof processor);
    print_machine(stdout, processor, isa);
    if (csv) fputs(csv_head, stdout);
    if (!folder) return;
    make_file_name(name, sizeof name, processor);
    snprintf(path, sizeof path, "%s/%s.csv", folder, name);
    kept = fopen(path, "w");
    if (!kept) bench_stop("%s cannot be written: does the folder exist?", path);
    print_machine(kept, processor, isa);
    fputs(csv_head, kept);
}

void bench_report_close(void) {
    if (!as_csv && bars) printf("%d of %d bars reached\n", reached, bars);
    if (kept && fclose(kept)) bench_stop("the results could not be kept: the disk is full?");
    kept = NULL;
}

void bench_say(const char *format, ...) {
    va_list words;
    va_start(words, format);
    fputs("# ", stdout);
    vprintf(format, words);
    fputc('\n', stdout);
    va_end(words);
    fflush(stdout);
}

/* ---- results ---- */

/* How many times as fast Skein is, or how many times as long it takes, where the bar says so. */
static double find_ratio(const bench_result *r) {
    return r->as_long > 0 ? r->ours / r->theirs : r->theirs / r->ours;
}

static const char *ratio_text(const bench_result *r) {
    return r->as_long > 0 ? "as long" : "faster";
}

/* The bars in words, and whether all of them were reached. */
static bool describe_bar(const bench_result *r, char *bar, size_t size) {
    size_t length = 0;
    bool good = true;
    bar[0] = 0;
    if (bench_quick) return true;
    if (r->other && r->faster > 0) {
        length += (size_t)snprintf(bar + length, size - length, "at least %gx", r->faster);
        good &= r->theirs / r->ours >= r->faster;
    }
    if (r->other && r->as_long > 0) {
        length += (size_t)snprintf(bar + length, size - length, "at most %gx", r->as_long);
        good &= r->ours / r->theirs <= r->as_long;
    }
    if (r->under > 0) {
        length += (size_t)snprintf(bar + length, size - length, "%sunder %g", length ? " and " : "", r->under);
        good &= r->ours < r->under;
    }
    if (r->firm > 0 && r->stretch) {
        snprintf(bar + length, size - length, "%sp99 at most %g %%", length ? " and " : "", 100 * r->firm);
        good &= r->stretch->p99 <= r->firm;
    }
    return good;
}

static void print_csv(FILE *out, const bench_result *r, const char *bar, bool good) {
    const char *verdict = !bar[0] ? "" : good ? "yes" : "no";
    fprintf(out, "\"%s\",\"%s\",%.4g,%s,", r->name, r->size, r->ours, r->unit);
    if (r->other) fprintf(out, "%.4g,\"%s\",%.2f,%s,", r->theirs, r->other, find_ratio(r), ratio_text(r));
    else fputs(",,,,", out);
    fprintf(out, "%s,%s,", bar, verdict);
    for (int i = 0; i < 2; i++) {
        const bench_stretch *s = i ? r->other_stretch : r->stretch;
        if (s) fprintf(out, "%.3f,%.3f,%.3f,", 100 * s->mean, 100 * s->p99, 100 * s->most);
        else fputs(",,,", out);
    }
    fprintf(out, "\"%s\"\n", r->note ? r->note : "");
}

static void print_stretch(const bench_stretch *s, const char *between) {
    if (s) printf("%s%.2f/%.2f/%.2f %%", between, 100 * s->mean, 100 * s->p99, 100 * s->most);
}

static void print_row(const bench_result *r, const char *bar, bool good) {
    printf("%-15s %-28s %9.4g %-13s", r->name, r->size, r->ours, r->unit);
    if (r->other) printf(" %9.4g %-24s %6.2fx %-7s", r->theirs, r->other, find_ratio(r), ratio_text(r));
    else if (bar[0]) printf(" %50s", "");
    if (bar[0]) printf("  %s: %s", bar, good ? "reached" : "MISSED");
    print_stretch(r->stretch, "; stretch mean/p99/max ");
    print_stretch(r->other_stretch, " against ");
    putchar('\n');
}

void bench_report(const bench_result *r) {
    char bar[80];
    bool good = describe_bar(r, bar, sizeof bar);
    bars += bar[0] != 0;
    reached += bar[0] && good;
    if (as_csv) print_csv(stdout, r, bar, good);
    else print_row(r, bar, good);
    if (kept) print_csv(kept, r, bar, good);
    fflush(stdout);
}
