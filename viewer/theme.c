/* Two themes of one design; see theme.h. */
#include "viewer/theme.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Warm greys, as of the ground in the pictures; the accent is that of the gingham's red, so that there is one strong
 * colour. Words have a contrast of at least 7 to 1 with what they stand on, quiet ones of 4.5 to 1. */
static const viewer_colours dark = {
    .window = 0x191b1e,
    .panel = 0x202327,
    .raised = 0x2a2e33,
    .field = 0x31363c,
    .field_over = 0x3c4249,
    .text = 0xecedee,
    .quiet = 0xa3a9b0,
    .line = 0x3a3f45,
    .accent = 0xd4583f,
    .accent_over = 0xe26b51,
    .on_accent = 0xffffff,
    .knob = 0x5b646e,
    .warning = 0xffb35a,
    .chart = 0x1a1d20,
    .axis = {0xe8604c, 0x7cc35a, 0x5a9df2},
    .handle = 0xf2f3f4,
    .held = 0xffd24a,
    .series = {0x6db7f2, 0xf4a259, 0x8fd07a, 0xe9eaec, 0xd58be0, 0xf1da63},
};
static const viewer_colours light = {
    .window = 0xd9d5cf,
    .panel = 0xf7f5f2,
    .raised = 0xffffff,
    .field = 0xe6e2dc,
    .field_over = 0xdad5ce,
    .text = 0x1f2225,
    .quiet = 0x5e646b,
    .line = 0xd5d0c9,
    .accent = 0xc04530,
    .accent_over = 0xa93a27,
    .on_accent = 0xffffff,
    .knob = 0xaaa49b,
    .warning = 0x9a4a00,
    .chart = 0xffffff,
    .axis = {0xc8402c, 0x3f8a2c, 0x2568c0},
    .handle = 0xfbfaf8,
    .held = 0xf0a800,
    .series = {0x1f6fb5, 0xc46210, 0x3d8b2f, 0x2b2e32, 0x8e3fa0, 0x8a7400},
};

const viewer_colours *viewer_colours_of(viewer_theme theme) {
    return theme == VIEWER_LIGHT ? &light : &dark;
}

/* ---- What was chosen last -------------------------------------------------------------------- */

static const char *const words[] = {[VIEWER_DARK] = "dark", [VIEWER_LIGHT] = "light"};

/* The file, and where `make` the folders that it lies in; false where nobody has a home. */
static bool find_file(char *path, size_t size, bool make) {
    const char *settings = getenv("XDG_CONFIG_HOME"), *home = getenv("HOME");
    bool own = settings && settings[0] == '/';
    if (!own && (!home || !home[0])) return false;
    int length = snprintf(path, size, "%s%s", own ? settings : home, own ? "" : "/.config");
    if (length < 0 || (size_t)length + 16 > size) return false;
    if (make) mkdir(path, 0700); // what is there already, stays
    strcat(path, "/skein");
    if (make) mkdir(path, 0700);
    strcat(path, "/theme");
    return true;
}

viewer_theme viewer_theme_kept(void) {
    char path[4096], word[16] = "";
    FILE *file = find_file(path, sizeof path, false) ? fopen(path, "r") : NULL;
    if (!file) return VIEWER_DARK;
    if (!fgets(word, sizeof word, file)) word[0] = 0;
    fclose(file);
    word[strcspn(word, "\r\n")] = 0;
    return strcmp(word, words[VIEWER_LIGHT]) ? VIEWER_DARK : VIEWER_LIGHT;
}

bool viewer_theme_keep(viewer_theme theme) {
    char path[4096];
    FILE *file = find_file(path, sizeof path, true) ? fopen(path, "w") : NULL;
    if (!file) return false;
    bool good = fprintf(file, "%s\n", words[theme == VIEWER_LIGHT ? VIEWER_LIGHT : VIEWER_DARK]) > 0;
    return fclose(file) == 0 && good;
}
