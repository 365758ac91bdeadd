/* What --compile does with a scene:
 *
 *     formula --hash--> key --the cache has it--------------------------> dlopen, check, register
 *                        \--emit--> formula.c --compiler--> formula.so --/ and into the cache
 *
 * The key is of all that the code depends on but the compiler, since the bits are the same from each. */
#include "app/compile.h"

#include <dlfcn.h>
#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <skein/compiled.h>
#include <skein/formula.h>

#include "app/headers.h"

/* ---- the key ---- */

static uint64_t hash_bytes(uint64_t hash, const void *bytes, size_t count) {
    for (const unsigned char *b = bytes; count; count--) hash = (hash ^ *b++) * UINT64_C(0x100000001b3);
    return hash;
}

static uint64_t hash_string(uint64_t hash, const char *text) {
    return hash_bytes(hash, text, strlen(text) + 1);
}

/* What -march=native means here: the processor's kind and what it can do, each line once. */
static uint64_t hash_processor(uint64_t hash) {
    static const char *const lines[] = {"vendor_id", "cpu family", "model", "model name",      "flags",
                                        "Features",  "CPU part",   "isa",   "CPU implementer", NULL};
    bool seen[sizeof lines / sizeof *lines] = {false}, any = false;
    char *line = NULL;
    size_t size = 0;
    FILE *file = fopen("/proc/cpuinfo", "r");
    while (file && getline(&line, &size, file) > 0) {
        size_t name = strcspn(line, "\t:");
        for (size_t i = 0; lines[i]; i++) {
            if (seen[i] || strlen(lines[i]) != name || strncmp(line, lines[i], name)) continue;
            hash = hash_string(hash, line);
            any = seen[i] = true;
        }
    }
    free(line);
    if (file) fclose(file);
    char host[256] = "";
    if (!any && !gethostname(host, sizeof host - 1)) hash = hash_string(hash, host); // then it is for this one alone
    return hash;
}

static uint64_t key_of(const skein_formula *f) {
    const uint64_t numbers[] = {skein_formula_hash(f), SKEIN_COMPILED_ABI, sizeof(skein_real)};
    uint64_t hash = hash_bytes(UINT64_C(0xcbf29ce484222325), numbers, sizeof numbers);
    for (const app_header *h = app_headers; h->name; h++) hash = hash_string(hash, h->text);
    return hash_processor(hash_string(hash, app_compiler_flags()));
}

/* ---- loading ---- */

/* The code of a file, if it is what the formula needs; the file stays open as long as the program runs. */
static const skein_compiled *load(const char *path, const skein_formula *f, char *words, size_t size) {
    void *file = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!file) {
        const char *why = dlerror();
        snprintf(words, size, "%s", why ? why : path);
        return NULL;
    }
    const skein_compiled *compiled = dlsym(file, "skein_compiled_formula");
    if (compiled && compiled->abi == SKEIN_COMPILED_ABI && compiled->real_size == sizeof(skein_real) &&
        compiled->hash == skein_formula_hash(f))
        return compiled;
    dlclose(file);
    snprintf(words, size, "%s is another formula, or of another version", path);
    return NULL;
}

/* ---- compiling ---- */

static void write_text(void *file, const char *text) {
    fputs(text, file);
}

static bool write_file(const char *folder, const char *name, const char *text, const skein_formula *f) {
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    if (!file) return false;
    bool good = true;
    if (text) fputs(text, file);
    else good = !skein_formula_emit_compiled(f, NULL, write_text, file, NULL);
    good &= !ferror(file);
    return !fclose(file) && good;
}

static bool make_folder(const char *folder, const char *name) {
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return !mkdir(path, 0700);
}

static void remove_file(const char *folder, const char *name) {
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    if (unlink(path)) rmdir(path);
}

/* In a folder of its own, which is gone afterwards. `cache` is the path to keep it at, or NULL. */
static const skein_compiled *compile_in_folder(const app_compiler *compiler, const skein_formula *f, const char *cache,
                                               char *words, size_t size) {
    const char *temporary = getenv("TMPDIR");
    char folder[2048], made[2100];
    const skein_compiled *compiled = NULL;
    snprintf(folder, sizeof folder, "%s/skein-XXXXXX", temporary && temporary[0] ? temporary : "/tmp");
    if (!mkdtemp(folder)) {
        snprintf(words, size, "no file can be written in %.300s", folder);
        return NULL;
    }
    snprintf(made, sizeof made, "%s/formula.so", folder);
    bool good =
        write_file(folder, "formula.c", NULL, f) && make_folder(folder, "skein") && make_folder(folder, "skein/inside");
    for (const app_header *h = app_headers; h->name && good; h++) good = write_file(folder, h->name, h->text, NULL);
    if (!good) snprintf(words, size, "no file can be written in %.300s", folder);
    if (good && app_compiler_run(compiler, folder, words, size)) {
        bool kept = cache && app_cache_put(made, cache);
        compiled = load(kept ? cache : made, f, words, size);
    }
    static const char *const names[] = {"formula.c", "formula.so", "formula.log"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) remove_file(folder, names[i]);
    for (const app_header *h = app_headers; h->name; h++) remove_file(folder, h->name);
    remove_file(folder, "skein/inside");
    remove_file(folder, "skein");
    rmdir(folder);
    return compiled;
}

/* The same; who interrupts it waits until the folder is gone. */
static const skein_compiled *compile(const app_compiler *compiler, const skein_formula *f, const char *cache,
                                     char *words, size_t size) {
    sigset_t ends, before;
    sigemptyset(&ends);
    sigaddset(&ends, SIGINT);
    sigaddset(&ends, SIGTERM);
    sigaddset(&ends, SIGHUP);
    pthread_sigmask(SIG_BLOCK, &ends, &before);
    const skein_compiled *compiled = compile_in_folder(compiler, f, cache, words, size);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return compiled;
}

/* ---- a scene ---- */

typedef struct work {
    skein_world *world;
    bool quiet;
    size_t warnings;
    app_compiler compiler;
    bool looked, has_compiler; /* for it is only looked for where the cache has not all */
    char cache[2048];          /* "": there is none */
    size_t from_cache, compiled;
    double seconds;
} work;

static void warn(work *w, const char *what, const char *words) {
    w->warnings++;
    fprintf(stderr, "skein: warning: %s%s\n", what, words);
}

static const skein_compiled *from_cache(work *w, const skein_formula *f, const char *path) {
    char words[512];
    if (access(path, F_OK)) return NULL;
    const skein_compiled *compiled = app_cache_check(path) ? load(path, f, words, sizeof words) : NULL;
    if (compiled) w->from_cache++;
    return compiled; // what is not whole is made anew, and takes its place
}

static const skein_compiled *from_compiler(work *w, const skein_formula *f, const char *path) {
    char words[1024] = "";
    if (!w->looked) {
        w->looked = true;
        w->has_compiler = app_compiler_find(&w->compiler);
        if (!w->has_compiler)
            warn(w, "--compile: there is no C compiler ($CC, cc, gcc, clang): formulas run on their tapes", "");
    }
    if (!w->has_compiler) return NULL;
    double start = app_seconds();
    const skein_compiled *compiled = compile(&w->compiler, f, path, words, sizeof words);
    w->seconds += app_seconds() - start;
    if (compiled) w->compiled++;
    else warn(w, "--compile: a formula stays on its tape: ", words);
    return compiled;
}

static void take_formula(work *w, skein_handle constraint) {
    skein_world *world = w->world;
    const skein_formula *f = skein_formula_of(world, constraint);
    if (!f) return;
    if (skein_formula_is_compiled(world, constraint)) return; // an earlier one is the same
    char path[2100];
    snprintf(path, sizeof path, "%s/formula-%016" PRIx64 ".so", w->cache, key_of(f));
    const skein_compiled *compiled = w->cache[0] ? from_cache(w, f, path) : NULL;
    if (!compiled) compiled = from_compiler(w, f, w->cache[0] ? path : NULL);
    if (compiled && skein_formula_register(world, compiled)) warn(w, "--compile: ", skein_world_error(world)->message);
}

size_t app_compile(skein_world *world, bool quiet) {
    work w = {.world = world, .quiet = quiet};
    char words[512] = "";
    size_t count = skein_object_count(world, SKEIN_CONSTRAINT);
    bool any = false;
    for (size_t i = 0; i < count; i++)
        any |= skein_formula_of(world, skein_object_at(world, SKEIN_CONSTRAINT, i)) != NULL;
    if (!any) {
        if (!quiet) fprintf(stderr, "skein: --compile: no constraint of the scene is a formula\n");
        return 0;
    }
    if (!app_cache_folder(w.cache, sizeof w.cache, words, sizeof words)) {
        w.cache[0] = '\0';
        warn(&w, "--compile: nothing is kept for the next time: ", words);
    }
    for (size_t i = 0; i < count; i++) take_formula(&w, skein_object_at(world, SKEIN_CONSTRAINT, i));
    if (quiet || !(w.from_cache + w.compiled)) return w.warnings;
    fprintf(stderr, "skein: compiled formulas: ");
    if (w.from_cache) fprintf(stderr, "%zu from %s%s", w.from_cache, w.cache, w.compiled ? ", " : "");
    if (w.compiled) fprintf(stderr, "%zu by %s in %.2f s", w.compiled, w.compiler.arguments[0], w.seconds);
    fputc('\n', stderr);
    return w.warnings;
}
