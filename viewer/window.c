/* The window: GLFW, its events, and the picture with the panels over it; see viewer.h.
 *
 * This thread waits for events and for pictures, and does nothing that could take long. What the pointer
 * does is sorted out after Dear ImGui has seen it: over a panel it is the panel's, else the stage's. */
#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <epoxy/gl.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "render/fail.h"
#include "render/messages.h"
#include "viewer/panels.h"
#include "viewer/stage.h"

/* Panels that take longer than this (ms) are felt to lag: an event tells. */
static const double late_ms = 25;
enum { MOST_PENDING = 64, FRAMES_AFTER_EVENT = 4 };

typedef struct window {
    const viewer_options *options;
    viewer_events events;
    viewer_exchange exchange;
    viewer_stage stage;
    viewer_panels panels;
    GLFWwindow *glfw, *hidden, *card; /* card: of steps on a graphics card */
    render_messages messages;
    viewer_request pending[MOST_PENDING]; /* of the pointer, until Dear ImGui has seen it */
    int pending_count;
    double x, y;            /* of the pointer, as its events say: it may be elsewhere by now */
    int stage_buttons;      /* that went down over the picture: the stage gets their end, too */
    int left, below;        /* where the picture begins, beside the panel; and what is docked below it, pixels */
    bool light;             /* the theme that the panels have */
    double picture_size[2]; /* that was asked for */
    int frames_due;         /* to draw, since something happened */
    unsigned framebuffer;
    uint64_t generation;
    char title[256];
    bool finished;    /* there is no stage any more */
    bool save_window; /* Shift and X */
    double longest;   /* ms between events being looked at */
    uint64_t turns;
} window;

viewer_options viewer_default_options(void) {
    return (viewer_options){.size = {1280, 720}, .samples = 4, .panels = true};
}

static window *window_of(GLFWwindow *glfw) {
    return glfwGetWindowUserPointer(glfw);
}

/* ---- Events ---- */

static void to_pixels(GLFWwindow *glfw, double *x, double *y) {
    int width, height, wide, tall;
    glfwGetWindowSize(glfw, &width, &height);
    glfwGetFramebufferSize(glfw, &wide, &tall);
    if (width > 0 && height > 0) *x *= (double)wide / width, *y *= (double)tall / height;
}

/* Notes what the pointer did; moves that follow each other are one. */
static void note_pointer(window *w, viewer_request request) {
    double x = w->x, y = w->y;
    to_pixels(w->glfw, &x, &y);
    if (request.kind != VIEWER_SCROLL) request.x = x, request.y = y;
    viewer_request *last = w->pending_count ? &w->pending[w->pending_count - 1] : NULL;
    if (last && last->kind == VIEWER_MOVE && request.kind == VIEWER_MOVE) *last = request;
    else if (w->pending_count < MOST_PENDING) w->pending[w->pending_count++] = request;
    w->frames_due = FRAMES_AFTER_EVENT;
}

static void on_move(GLFWwindow *glfw, double x, double y) {
    window *w = window_of(glfw);
    w->x = x, w->y = y;
    note_pointer(w, (viewer_request){.kind = VIEWER_MOVE});
}

static void on_enter(GLFWwindow *glfw, int inside) {
    window *w = window_of(glfw);
    viewer_request request = {.kind = VIEWER_MOVE, .x = w->x, .y = w->y, .down = true};
    if (!inside && !w->stage_buttons) viewer_ask(&w->exchange, &request);
}

static void on_button(GLFWwindow *glfw, int button, int action, int mods) {
    viewer_request request = {.kind = VIEWER_BUTTON, .code = button, .mods = mods, .down = action == GLFW_PRESS};
    note_pointer(window_of(glfw), request);
}

static void on_scroll(GLFWwindow *glfw, double x, double y) {
    (void)x;
    note_pointer(window_of(glfw), (viewer_request){.kind = VIEWER_SCROLL, .y = y});
}

static void on_key(GLFWwindow *glfw, int key, int scancode, int action, int mods) {
    (void)scancode;
    window *w = window_of(glfw);
    w->frames_due = FRAMES_AFTER_EVENT;
    if (key == GLFW_KEY_UNKNOWN || (action != GLFW_RELEASE && widgets_want_keys())) return;
    if (key == GLFW_KEY_X && action == GLFW_PRESS && mods & GLFW_MOD_SHIFT) {
        w->save_window = true;
        return;
    }
    bool quits = mods & GLFW_MOD_CONTROL && (key == GLFW_KEY_Q || key == GLFW_KEY_W);
    if (quits && action == GLFW_PRESS) glfwSetWindowShouldClose(glfw, GLFW_TRUE);
    viewer_request request = {
        .kind = action == GLFW_RELEASE ? VIEWER_KEY_UP : VIEWER_KEY_DOWN, .code = key, .mods = mods};
    if (action != GLFW_REPEAT || key == GLFW_KEY_PERIOD || key == GLFW_KEY_COMMA || key == GLFW_KEY_ENTER ||
        (key >= GLFW_KEY_RIGHT && key <= GLFW_KEY_END))
        viewer_ask(&w->exchange, &request);
}

static void on_focus(GLFWwindow *glfw, int focused) {
    viewer_request request = {.kind = VIEWER_FOCUS, .down = focused == GLFW_TRUE};
    viewer_ask(&window_of(glfw)->exchange, &request);
}

static void on_size(GLFWwindow *glfw, int width, int height) {
    (void)width, (void)height; // drawing finds out
    window_of(glfw)->frames_due = FRAMES_AFTER_EVENT;
}

static void on_refresh(GLFWwindow *glfw) {
    window_of(glfw)->frames_due = FRAMES_AFTER_EVENT;
}

/* A scene or a mesh: the first of what was dropped. */
static void on_drop(GLFWwindow *glfw, int count, const char **paths) {
    viewer_request request = {.kind = VIEWER_OPEN};
    window *w = window_of(glfw);
    if (count < 1) return;
    snprintf(request.text, sizeof request.text, "%s", paths[0]);
    viewer_event(&w->events, "dropped %s", paths[0]);
    viewer_ask(&w->exchange, &request);
    w->frames_due = FRAMES_AFTER_EVENT;
}

static void set_callbacks(window *w) {
    glfwSetWindowUserPointer(w->glfw, w);
    glfwSetCursorPosCallback(w->glfw, on_move);
    glfwSetMouseButtonCallback(w->glfw, on_button);
    glfwSetCursorEnterCallback(w->glfw, on_enter);
    glfwSetScrollCallback(w->glfw, on_scroll);
    glfwSetKeyCallback(w->glfw, on_key);
    glfwSetWindowFocusCallback(w->glfw, on_focus);
    glfwSetFramebufferSizeCallback(w->glfw, on_size);
    glfwSetWindowRefreshCallback(w->glfw, on_refresh);
    glfwSetDropCallback(w->glfw, on_drop);
}

/* Hands on what the pointer did over the picture, at its place in it. */
static void pass_pointer(window *w) {
    bool panels = widgets_want_pointer();
    for (int i = 0; i < w->pending_count; i++) {
        viewer_request request = w->pending[i];
        int bit = request.kind == VIEWER_BUTTON ? 1 << (request.code & 15) : 0;
        if (bit && request.down && panels) continue;
        if (bit && !request.down && !(w->stage_buttons & bit)) continue;
        if (request.kind == VIEWER_SCROLL && panels) continue;
        if (request.kind == VIEWER_MOVE) request.down = panels;
        if (bit) w->stage_buttons = request.down ? w->stage_buttons | bit : w->stage_buttons & ~bit;
        if (request.kind != VIEWER_SCROLL) request.x -= w->left;
        viewer_ask(&w->exchange, &request);
    }
    w->pending_count = 0;
}

/* ---- Pictures ---- */

/* Copies the newest picture into the window, byte by byte: it holds what a screen shows. */
static void show_picture(window *w, int width, int height) {
    viewer_shown *shown = &w->exchange.shown;
    const uint32_t paint = viewer_colours_of(w->light ? VIEWER_LIGHT : VIEWER_DARK)->window;
    const float behind[4] = {(float)(paint >> 16) / 255, (float)(paint >> 8 & 255) / 255, (float)(paint & 255) / 255, 1};
    glDisable(GL_FRAMEBUFFER_SRGB);
    glDisable(GL_SCISSOR_TEST);
    glViewport(0, 0, width, height);
    if (shown->generation != w->generation || shown->newest < 0) shown->in_use = -1;
    w->generation = shown->generation;
    if (shown->newest >= 0) shown->in_use = shown->newest;
    glClearNamedFramebufferfv(0, GL_COLOR, 0, behind);
    if (shown->in_use < 0 || !shown->has_scene) return;
    glNamedFramebufferRenderbuffer(w->framebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER,
                                   shown->pictures[shown->in_use]);
    // while the window changes its size, the last picture is stretched
    bool same = shown->width == width - w->left && shown->height == height - w->below;
    glBlitNamedFramebuffer(w->framebuffer, 0, 0, 0, shown->width, shown->height, w->left, w->below, width, height,
                           GL_COLOR_BUFFER_BIT, same ? GL_NEAREST : GL_LINEAR);
}

/* Shows a picture of a few pixels (no power of two, which some drivers treat apart), as large and stretched: the driver
 * makes what it needs for that before anybody waits for it (60 ms, on llvmpipe). */
static void rehearse(const window *w) {
    unsigned picture;
    glCreateRenderbuffers(1, &picture);
    glNamedRenderbufferStorage(picture, GL_SRGB8_ALPHA8, 7, 7);
    glNamedFramebufferRenderbuffer(w->framebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, picture);
    glBlitNamedFramebuffer(w->framebuffer, 0, 0, 0, 7, 7, 0, 0, 7, 7, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    glBlitNamedFramebuffer(w->framebuffer, 0, 0, 0, 7, 7, 0, 0, 5, 7, GL_COLOR_BUFFER_BIT, GL_LINEAR);
    glDeleteRenderbuffers(1, &picture);
}

/* The window as it is, with its panels. */
static void save_window(window *w, int width, int height) {
    render_image image = {0};
    skein_error error = {SKEIN_OK, "", ""};
    viewer_request request = {.kind = VIEWER_SAVED};
    w->save_window = false;
    viewer_free_name("skein", ".png", request.text, sizeof request.text);
    if (!render_image_resize(&image, width, height, &error)) {
        glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
        glReadBuffer(GL_BACK);
        glPixelStorei(GL_PACK_ALIGNMENT, 1);
        for (int y = 0; y < height; y++)
            glReadPixels(0, height - 1 - y, width, 1, GL_RGB, GL_UNSIGNED_BYTE,
                         image.pixels + 3 * (size_t)y * (size_t)width);
    }
    if (!error.status) render_image_write_png(&image, request.text, &error);
    render_image_release(&image);
    if (error.status) {
        request.kind = VIEWER_FAULT;
        snprintf(request.text, sizeof request.text, "%s: %s", error.where, error.message);
    }
    viewer_ask(&w->exchange, &request);
}

/* The picture is as large as what the side panel leaves of the window. */
static void ask_for_size(window *w, int width, int height) {
    const viewer_shown *shown = &w->exchange.shown;
    w->left = shown->panel[VIEWER_PANEL_SIDE] && shown->has_scene ? viewer_side_panel_width(width) : 0;
    w->below = shown->has_scene ? viewer_docked_height(shown, height) : 0;
    viewer_request request = {.kind = VIEWER_RESIZE, .x = width - w->left, .y = height - w->below};
    bool is_new = request.x != w->picture_size[0] || request.y != w->picture_size[1];
    if (!is_new || width < 1 || height < 1) return;
    w->picture_size[0] = request.x, w->picture_size[1] = request.y;
    viewer_ask(&w->exchange, &request);
}

static void draw(window *w) {
    int width, height;
    char title[256];
    glfwGetFramebufferSize(w->glfw, &width, &height);
    pthread_mutex_lock(&w->exchange.lock);
    bool light = w->exchange.shown.generation ? w->exchange.shown.light : w->light;
    pthread_mutex_unlock(&w->exchange.lock);
    if (light != w->light) widgets_theme(viewer_colours_of(light ? VIEWER_LIGHT : VIEWER_DARK));
    w->light = light;
    widgets_begin();
    pass_pointer(w);
    pthread_mutex_lock(&w->exchange.lock);
    if (w->exchange.shown.generation) ask_for_size(w, width, height); // the stage has begun
    show_picture(w, width, height);
    viewer_panels_show(&w->panels, width, height);
    memcpy(title, w->exchange.shown.title, sizeof title);
    w->finished = w->exchange.shown.finished;
    pthread_mutex_unlock(&w->exchange.lock);
    glDisable(GL_FRAMEBUFFER_SRGB);
    widgets_end();
    if (w->save_window) save_window(w, width, height);
    glfwSwapBuffers(w->glfw);
    // setting it is an event of its own, and would wake the loop for ever
    if (title[0] && strcmp(title, w->title) != 0) glfwSetWindowTitle(w->glfw, memcpy(w->title, title, sizeof w->title));
}

/* ---- Opening and closing ---- */

static char glfw_words[400];

static void keep_words(int code, const char *words) {
    snprintf(glfw_words, sizeof glfw_words, "%s (GLFW %d)", words, code);
}

static bool open_windows(window *w, skein_error *error) {
    glfwSetErrorCallback(keep_words);
    if (!glfwInit()) {
        render_fail(error, SKEIN_ERROR_VALUE, "display",
                    "there is no display to open a window on: %s. Set DISPLAY, or use `skein render`, which needs none",
                    glfw_words);
        return false;
    }
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, GLFW_TRUE);
    glfwWindowHint(GLFW_DEPTH_BITS, 0);
    glfwWindowHint(GLFW_STENCIL_BITS, 0);
    w->glfw = glfwCreateWindow(w->options->size[0], w->options->size[1], "Skein", NULL, NULL);
    glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
    if (w->glfw) w->hidden = glfwCreateWindow(16, 16, "Skein's pictures", NULL, w->glfw);
    if (w->hidden && w->options->device)
        w->card = glfwCreateWindow(16, 16, "Skein's steps", NULL, w->glfw); // without it steps stay on the processor
    if (w->hidden) return true;
    render_fail(error, SKEIN_ERROR_VALUE, "OpenGL",
                "no window with OpenGL 4.5: %s. Mesa's drivers have it, without a graphics card too (Debian: apt-get "
                "install libgl1-mesa-dri); LIBGL_ALWAYS_SOFTWARE=1 takes them; `skein render` needs no window",
                glfw_words);
    return false;
}

static double scale_of(const window *w) {
    float x = 1, y = 1;
    if (w->options->scale > 0) return w->options->scale;
    glfwGetWindowContentScale(w->glfw, &x, &y);
    return x > 0.5f ? (double)x : 1;
}

/* Ctrl-C on the terminal closes the window as its own button would: a film that is recorded gets its end. */
static volatile sig_atomic_t interrupted;

static void interrupt(int number) {
    interrupted = number;
}

static void wake(void) {
    glfwPostEmptyEvent();
}

static void loop(window *w) {
    uint64_t seen = 0;
    while (!glfwWindowShouldClose(w->glfw) && !interrupted && !w->finished) {
        if (w->frames_due > 0) glfwPollEvents();
        else glfwWaitEventsTimeout(0.5);
        if (w->frames_due > 0) w->frames_due--;
        double begin = viewer_seconds();
        draw(w);
        double took = 1e3 * (viewer_seconds() - begin);
        if (w->turns++ > 10 && took > w->longest) w->longest = took; // the first make the driver's shaders
        if (took > late_ms) viewer_event(&w->events, "late %.1f ms", took);
        if (!seen++) viewer_event(&w->events, "open %s", (const char *)glGetString(GL_RENDERER));
        // without vertical synchronisation (a virtual display) the due frames are not to come all at once
        if (w->frames_due > 0) usleep(4000);
    }
}

static skein_status run(window *w, skein_error *error) {
    if (!viewer_events_open(&w->events, w->options->events))
        return render_fail(error, SKEIN_ERROR_FILE, w->options->events, "cannot write: %s", strerror(errno));
    if (!open_windows(w, error)) return error->status;
    glfwMakeContextCurrent(w->glfw);
    glfwSwapInterval(1);
    render_messages_attach(&w->messages);
    glCreateFramebuffers(1, &w->framebuffer);
    rehearse(w);
    set_callbacks(w);
    w->light = w->options->theme == VIEWER_LIGHT;
    if (!viewer_exchange_open(&w->exchange, &w->events) ||
        !widgets_open(w->glfw, scale_of(w), viewer_colours_of(w->light ? VIEWER_LIGHT : VIEWER_DARK)))
        return render_fail(error, SKEIN_ERROR_MEMORY, "window", "out of memory");
    w->panels.exchange = &w->exchange;
    if (!widgets_has_letters()) {
        viewer_request plain = {.kind = VIEWER_FAULT};
        snprintf(plain.text, sizeof plain.text,
                 "no typeface was found: the built-in letters are shown (Debian: apt-get install fonts-inter)");
        viewer_ask(&w->exchange, &plain);
    }
    int width, height;
    glfwGetFramebufferSize(w->glfw, &width, &height);
    // as it will be once there is a scene
    w->stage.wide = w->options->panels && w->options->path ? width - viewer_side_panel_width(width) : width;
    w->stage.tall = height;
    w->picture_size[0] = w->stage.wide, w->picture_size[1] = height;
    w->exchange.wake = wake;
    if (!viewer_stage_start(&w->stage, w->options, &w->exchange, w->hidden, w->card))
        return render_fail(error, SKEIN_ERROR_MEMORY, "window", "no thread can be started");
    signal(SIGINT, interrupt);
    signal(SIGTERM, interrupt);
    loop(w);
    signal(SIGINT, SIG_DFL);
    signal(SIGTERM, SIG_DFL);
    viewer_stage_join(&w->stage);
    widgets_close();
    glDeleteFramebuffers(1, &w->framebuffer);
    viewer_event(&w->events, "opengl window errors=%zu warnings=%zu %s", w->messages.errors, w->messages.warnings,
                 w->messages.last);
    viewer_event(&w->events, "turns %llu longest=%.1f ms", (unsigned long long)w->turns, w->longest);
    viewer_event(&w->events, "closed");
    viewer_exchange_close(&w->exchange);
    if (w->stage.failure.status && error) *error = w->stage.failure;
    return w->stage.failure.status;
}

skein_status viewer_run(const viewer_options *options, skein_error *error) {
    window *w = calloc(1, sizeof *w);
    if (!w) return render_fail_memory(error, "the window");
    w->options = options;
    w->frames_due = FRAMES_AFTER_EVENT;
    skein_status status = run(w, error);
    if (w->card) glfwDestroyWindow(w->card);
    if (w->hidden) glfwDestroyWindow(w->hidden);
    if (w->glfw) glfwDestroyWindow(w->glfw);
    // GLFW stays as it is: ending it unloads Mesa's driver, which forgets a few tables each time (as in
    // render/context.c)
    viewer_events_close(&w->events);
    free(w);
    return status;
}
