/* The little of Dear ImGui that the panels use, for C.
 *
 * widgets.cpp is the only file that speaks to Dear ImGui. Called by window.c and the panels, on the window's thread,
 * between widgets_begin() and widgets_end() but for the first two. */
#ifndef SKEIN_VIEWER_WIDGETS_H
#define SKEIN_VIEWER_WIDGETS_H

#include <stdbool.h>
#include <stddef.h>

#include "viewer/theme.h"

#ifdef __cplusplus
extern "C" {
#endif

struct GLFWwindow;

/* `scale` of letters and all sizes. After the window's own callbacks were set: these go on being called. */
bool widgets_open(struct GLFWwindow *window, double scale, const viewer_colours *theme);
/* Whether a typeface was found; else there are only the built-in letters. */
bool widgets_has_letters(void);
/* Between two frames. */
void widgets_theme(const viewer_colours *theme);
void widgets_close(void);
void widgets_begin(void);
void widgets_end(void); /* draws them into the window */
bool widgets_want_pointer(void);
bool widgets_want_keys(void); /* a text is being typed */
double widgets_scale(void);
double widgets_line(void); /* the height of a line with a control on it */

/* Docked: it stays where it is put, and can be closed. */
typedef enum widgets_frame { WIDGETS_FIXED, WIDGETS_DOCKED, WIDGETS_FREE } widgets_frame;
/* A panel at a place (pixels); a free one may be moved and closed (`open` turns false). True where it is unfolded; in
 * any case end it. */
bool widgets_panel(const char *title, widgets_frame frame, double x, double y, double width, double height, bool *open);
/* Words over everything, in lines of at most `width` pixels: from (x, y) on downwards, or `above` it. `box` gets where
 * they are: x, y, width, height. */
void widgets_note(const char *text, double x, double y, bool above, double width, bool warning, double box[4]);
/* A small panel over the picture, its bottom's middle at (x, y), as large as what is in it and between the two edges; end
 * it as a panel. False in its first frame, which nobody sees: its size is not known yet. */
bool widgets_over(const char *id, double x, double y, double left, double right);
void widgets_panel_end(void);
bool widgets_group(const char *title, bool open); /* a heading that folds */
bool widgets_tree(const char *title, bool open);  /* a smaller one, indented; end it if true */
void widgets_tree_end(void);
void widgets_push(const void *id);
void widgets_pop(void);

void widgets_text(const char *text);
void widgets_heading(const char *text);
void widgets_quiet(const char *text); /* what can wait */
void widgets_wrapped(const char *text, bool warning);
/* A line with a mark under `count` of its bytes, from the first-th on (from 1). */
void widgets_marked(const char *line, size_t first, size_t count);
void widgets_same_line(void);
void widgets_new_line(void); /* after all not the same */
void widgets_gap(void);
void widgets_line_across(void);
bool widgets_button(const char *title);
bool widgets_main_button(const char *title); /* the one that is used most */
bool widgets_tick(const char *title, bool *value);
/* `words` with '|' between them; `place` is the chosen one's. */
bool widgets_choice(const char *title, const char *words, int *place);
/* Of the choice that was shown last: a word's box; false where there is none, or it is folded. */
bool widgets_choice_row(int row, double rectangle[4]);
/* `count` numbers as sliders from `least` to `most`; any other may be typed after Ctrl and a click. */
bool widgets_numbers(const char *title, double *numbers, int count, double least, double most, bool logarithmic,
                     bool whole, const char *format);
/* The last control has just been taken: it is pressed, or typed into. */
bool widgets_begun(void);
/* The last control was changed and has now been let go. */
bool widgets_released(void);
/* Whether the last control's number is being typed: it is not what is meant before Enter. */
bool widgets_typing(void);
/* True once it is typed and Enter pressed. */
bool widgets_input(const char *title, char *text, size_t size);
/* The same in several lines: Enter says that it is done, Ctrl and Enter makes a new line. */
bool widgets_input_lines(const char *title, char *text, size_t size);
/* A line as wide as its text, in a small panel. */
bool widgets_input_fitting(const char *title, char *text, size_t size);
void widgets_help(const char *text);  /* shown over the last control, while the pointer rests on it */
bool widgets_menu(const char *title); /* of the last control, by the right button; end it if true */
bool widgets_menu_row(const char *title);
void widgets_menu_end(void);
/* Over the picture and under all panels, within a box (x, y, width, height) until its end: 0xRRGGBB; a line has a dark
 * edge, so that it is seen on any ground. A width of 0 fills. */
void widgets_over_picture(const double box[4]);
void widgets_over_picture_end(void);
void widgets_stroke(const float from[2], const float to[2], float width, uint32_t colour, float opacity);
void widgets_fill(float (*corners)[2], int count, uint32_t colour, float opacity); /* three or four */
void widgets_circle(const float middle[2], float radius, float width, uint32_t colour, float opacity);
/* Curves over each other, by time; NULL entries are left out. `count` values from `first` on, in rings of `room`. Where
 * they are `compared`, one that blows up does not flatten the others. */
typedef struct widgets_chart {
    const char *title;          /* with the unit */
    const float *const *series; /* series_count */
    const char *const *names;   /* of the curves */
    int series_count;
    const float *times; /* s */
    size_t first, count, room;
    bool compared;
} widgets_chart;
void widgets_chart_show(const widgets_chart *chart, double width, double height);
bool widgets_picture(unsigned texture, double width, double height); /* true: it was clicked */
void widgets_columns(int count);
void widgets_next_column(void);
/* A list with a scroll bar of its own, beside what follows; end it if true. */
bool widgets_list(const char *id, double width, double height);
void widgets_list_end(void);
double widgets_height(void);            /* that is left below */
double widgets_room(void);              /* width that is left on this line */
void widgets_last(double rectangle[4]); /* x, y, width, height of the last control, pixels */
/* The same of the last number, choice or text, without its title. */
void widgets_last_frame(double rectangle[4]);
bool widgets_last_visible(void);
void widgets_follow(void); /* scrolls to the end, if the end was in view */

#ifdef __cplusplus
}
#endif
#endif
