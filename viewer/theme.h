/* The window's look: two themes of one design, and which of them was chosen last.
 *
 * Read by widgets.cpp, which gives the colours to Dear ImGui; kept in the user's folder of settings, so that the next
 * window opens as the last was left. Called by window.c and stage.c. */
#ifndef SKEIN_VIEWER_THEME_H
#define SKEIN_VIEWER_THEME_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum viewer_theme { VIEWER_KEPT_THEME, VIEWER_DARK, VIEWER_LIGHT } viewer_theme;

enum { VIEWER_SERIES = 6 };

/* Of a slider's knob, which lies under its number, and of one that is held: the number is read through it. */
#define VIEWER_KNOB_OPACITY 0.75
#define VIEWER_HELD_OPACITY 0.6

/* 0xRRGGBB, as a screen shows them. */
typedef struct viewer_colours {
    uint32_t window, panel, raised; /* behind everything; of panels; of cards and lists that lie on them */
    uint32_t field, field_over;     /* controls; under the pointer */
    uint32_t text, quiet;           /* words; and those that can wait */
    uint32_t line;                  /* between things, and on charts */
    uint32_t accent, accent_over;   /* what is chosen, or goes on */
    uint32_t on_accent;             /* words on it */
    uint32_t knob, warning, chart;  /* of sliders; words that warn; behind curves */
    uint32_t axis[3], handle, held; /* handles along x, y and z, for all of it, and the one that is taken hold of */
    uint32_t series[VIEWER_SERIES]; /* curves: told apart by lightness, too */
} viewer_colours;

const viewer_colours *viewer_colours_of(viewer_theme theme);

/* The one that was chosen last; dark if none was. */
viewer_theme viewer_theme_kept(void);
/* Remembers it in $XDG_CONFIG_HOME/skein/theme, or ~/.config/skein/theme; false where that cannot be written. */
bool viewer_theme_keep(viewer_theme theme);

#ifdef __cplusplus
}
#endif
#endif
