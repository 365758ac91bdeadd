/* An engine: loads a plugin, a shared object that Skein's archive is linked into, and calls it. plugin FILE */
#include <dlfcn.h>
#include <stdio.h>

int main(int argc, char **argv) {
    void *plugin = argc > 1 ? dlopen(argv[1], RTLD_NOW | RTLD_LOCAL) : NULL;
    if (!plugin) return fprintf(stderr, "plugin: %s\n", argc > 1 ? dlerror() : "a file is needed"), 1;
    int (*run)(int, char **);
    *(void **)&run = dlsym(plugin, "run_plugin");
    return run ? run(0, NULL) : 1;
}
