/* A real window on a virtual screen, driven as a user would: Xvfb, xdotool, and what `skein view --events` tells.
 *
 *     open_screen()  Xvfb on a display of its own        open_window()  skein view on it
 *     tool("key space")  xdotool                         expect("paused")  waits for a line of the events
 *
 * No window manager is needed: keys go to the window that has the focus, which is given to it by hand. */
#ifndef SKEIN_TEST_WINDOW_H
#define SKEIN_TEST_WINDOW_H

#include "test_command.h"

#include <X11/Xatom.h>
#include <X11/Xlib.h>
#include <ctype.h>

#include "render/image.h"

/* Of the virtual screen; a test may have said another before this file. */
#ifndef SCREEN_SIZE
#define SCREEN_SIZE "1024x768"
#endif

static struct {
    pid_t xvfb, skein;
    FILE *hands; /* xdotool, which reads what to do line by line */
    char display[16], window[32];
    char events[512];
    long seen; /* of the events, bytes */
    char line[2048];
} screen;

/* After three failures nothing is worth waiting for. */
static double patience_seconds = 60;

static inline void lose_patience(void) {
    static int failures;
    if (++failures == 3) patience_seconds = 0.5;
    fail();
}

static inline double seconds_now(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static inline void pause_for(double seconds) {
    struct timespec span = {(time_t)seconds, (long)(1e9 * (seconds - (double)(time_t)seconds))};
    nanosleep(&span, NULL);
}

static inline bool have(const char *program) {
    char line[128];
    snprintf(line, sizeof line, "command -v %s >/dev/null 2>&1", program);
    return system(line) == 0;
}

/* Whether there is a screen to test on; says why not. */
static inline bool can_open_screen(void) {
    if (have("Xvfb") && have("xdotool")) return true;
    fprintf(stderr, "skipped: Xvfb or xdotool is missing, `tools/setup test` installs them\n");
    return false;
}

static inline void open_screen(void) {
    int ends[2];
    assert_int_equal(pipe(ends), 0);
    screen.xvfb = fork();
    assert_true(screen.xvfb >= 0);
    if (screen.xvfb == 0) {
        char descriptor[16];
        int quiet = open("/dev/null", O_RDWR);
        close(ends[0]);
        dup2(quiet, 1);
        dup2(quiet, 2);
        snprintf(descriptor, sizeof descriptor, "%d", ends[1]);
        execlp("Xvfb", "Xvfb", "-displayfd", descriptor, "-screen", "0", SCREEN_SIZE "x24", "-nolisten", "tcp",
               (char *)NULL);
        _exit(127);
    }
    close(ends[1]);
    char number[16] = "";
    // a number and a newline, when the server is ready; nothing, when it is dead
    for (size_t length = 0; length + 1 < sizeof number && read(ends[0], number + length, 1) == 1;)
        if (number[length++] == '\n') break;
    close(ends[0]);
    assert_non_null(strchr(number, '\n'));
    snprintf(screen.display, sizeof screen.display, ":%d", atoi(number));
    setenv("DISPLAY", screen.display, 1);
    unsetenv("WAYLAND_DISPLAY");
}

static inline void end_process(pid_t *process, int number) {
    if (*process > 0) {
        kill(*process, number);
        waitpid(*process, NULL, 0);
    }
    *process = 0;
}

/* xdotool with these words; "WINDOW" stands for the window. */
static inline void tool(const char *words) {
    char line[1024];
    snprintf(line, sizeof line, "xdotool %s", words);
    if (system(line)) {
        fprintf(stderr, "failed: %s\n", line);
        lose_patience();
    }
}

/* The same without a program of its own for each word, for those who do much: "mousemove 10 20", one a line. */
static inline void hand(const char *format, ...) __attribute__((format(printf, 1, 2)));
static inline void hand(const char *format, ...) {
    char line[1024];
    va_list arguments;
    if (!screen.hands) screen.hands = popen("xdotool - >/dev/null", "we"); // a window must not hold its end
    assert_non_null(screen.hands);
    va_start(arguments, format);
    vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    fprintf(screen.hands, "%s\n", line);
    fflush(screen.hands);
}

/* Waits until all of it is done. */
static inline void await_hands(void) {
    double until = seconds_now() + patience_seconds;
    const char *mark = in_folder("hands");
    write_text(mark, "");
    hand("exec --sync rm -f %s", mark);
    while (exists(mark) && seconds_now() < until) pause_for(0.005);
}

static inline void drop_hands(void) {
    if (screen.hands) pclose(screen.hands);
    screen.hands = NULL;
}

/* ---- What the window tells ------------------------------------------------------------------------ */

/* The next line, from where the last search ended, that begins with `begin`; false after `seconds`. */
static inline bool hear(const char *begin, double seconds) {
    double until = seconds_now() + seconds;
    do {
        FILE *file = fopen(screen.events, "r");
        if (file) {
            fseek(file, screen.seen, SEEK_SET);
            while (fgets(screen.line, sizeof screen.line, file)) {
                size_t length = strlen(screen.line);
                if (!length || screen.line[length - 1] != '\n') break; // it is not whole yet
                screen.seen += (long)length;
                screen.line[length - 1] = 0;
                if (!strncmp(screen.line, begin, strlen(begin))) {
                    fclose(file);
                    return true;
                }
            }
            fclose(file);
        }
        pause_for(0.01);
    } while (seconds_now() < until);
    return false;
}

/* Forgets what was told so far. */
static inline void listen_from_here(void) {
    struct stat info;
    if (!stat(screen.events, &info)) screen.seen = (long)info.st_size;
}

static inline const char *expect(const char *begin) {
    long from = screen.seen;
    if (hear(begin, patience_seconds)) return screen.line;
    char *all = read_text(screen.events);
    fprintf(stderr, "no line '%s' since:\n%s\n", begin, all + from);
    free(all);
    lose_patience();
    return NULL;
}

/* The number after "name=" in the line that was heard last. */
static inline double told(const char *name) {
    char word[64];
    snprintf(word, sizeof word, " %s=", name);
    const char *at = strstr(screen.line, word);
    assert_non_null(at);
    return strtod(at + strlen(word), NULL);
}

/* GLFW's number of a key by xdotool's name, with "ctrl+" or "shift+" before it or not. */
static inline int key_code(const char *key) {
    static const struct {
        const char *name;
        int code;
    } rows[] = {{"space", 32}, {"comma", 44}, {"period", 46}, {"Return", 257}, {"BackSpace", 259}, {"Right", 262},
                {"Left", 263}, {"Down", 264}, {"Up", 265},    {"Prior", 266},  {"Next", 267},      {"Home", 268},
                {"End", 269},  {"F4", 293},   {"F6", 295},    {"F7", 296},     {"Shift_L", 340},   {"Escape", 256}};
    const char *last = strrchr(key, '+') ? strrchr(key, '+') + 1 : key;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (!strcmp(last, rows[i].name)) return rows[i].code;
    if (strlen(last) != 1) fail_msg("the tests know no number of the key %s", key);
    return toupper((unsigned char)*last);
}

/* Presses a key (xdotool's name) and returns the state after it. What an earlier key is still to say is not taken for it. */
static inline const char *press_key(const char *key) {
    char words[64];
    snprintf(words, sizeof words, "key %s", key);
    listen_from_here();
    tool(words);
    snprintf(words, sizeof words, "key %d ", key_code(key));
    expect(words);
    return expect("state ");
}

/* The box of a control (x, y, width, height), by its last place among the events from `from` on; waits at most so long.
 */
static inline bool find_box(const char *name, long from, double box[4], double seconds) {
    double until = seconds_now() + seconds;
    do {
        char *all = read_text(screen.events), *line = all + (from < (long)strlen(all) ? from : (long)strlen(all));
        bool found = false;
        for (char *next; line && *line; line = next) {
            double at[4];
            int used = 0;
            next = strchr(line, '\n');
            if (next) *next++ = 0;
            if (sscanf(line, "control %lf %lf %lf %lf %n", &at[0], &at[1], &at[2], &at[3], &used) < 4) continue;
            if (strcmp(line + used, name) != 0) continue;
            memcpy(box, at, sizeof at);
            found = true;
        }
        free(all);
        if (found) return true;
        pause_for(0.02);
    } while (seconds_now() < until);
    return false;
}

/* The middle of a control, by its last place; waits until there is one. */
static inline void place_of(const char *name, double *x, double *y) {
    double box[4] = {0, 0, 0, 0};
    if (!find_box(name, 0, box, patience_seconds)) {
        fprintf(stderr, "there is no control '%s'\n", name);
        lose_patience();
    }
    *x = box[0] + 0.5 * box[2];
    *y = box[1] + 0.5 * box[3];
}

/* ---- The window ------------------------------------------------------------------------------------ */

/* Opens skein view in the temporary folder with arguments up to NULL, and waits until it shows something. */
static inline void open_window(const char *const *arguments) {
    const char *list[24];
    size_t count = 0;
    end_process(&screen.skein, SIGKILL); // of a test that failed
    screen.seen = 0;
    snprintf(screen.events, sizeof screen.events, "%s", in_folder("events"));
    remove(screen.events);
    for (; arguments[count] && count < 16; count++) list[count] = arguments[count];
    list[count++] = "--events";
    list[count++] = screen.events;
    list[count] = NULL;
    fflush(NULL);
    screen.skein = fork();
    assert_true(screen.skein >= 0);
    if (screen.skein == 0) {
        char *words[32] = {(char *)(uintptr_t)SKEIN_COMMAND, (char *)(uintptr_t) "view"};
        int out = open(in_folder("words"), O_RDWR | O_CREAT | O_TRUNC, 0666);
        for (size_t i = 0; i < count; i++) words[i + 2] = (char *)(uintptr_t)list[i];
        alarm(900);
        dup2(out, 1);
        dup2(out, 2);
        setenv("XDG_STATE_HOME", folder, 1); // nothing is left in the user's own
        if (!chdir(folder)) execv(SKEIN_COMMAND, words);
        _exit(127);
    }
    expect("open ");
    screen.seen = 0; // a scene may be there before the window is
    // the focus, which a window manager would give
    char line[256];
    FILE *answer = popen("xdotool search --onlyvisible --name '^Skein'", "re");
    assert_non_null(answer);
    assert_non_null(fgets(screen.window, sizeof screen.window, answer));
    pclose(answer);
    screen.window[strcspn(screen.window, "\n")] = 0;
    snprintf(line, sizeof line, "windowmove %s 0 0 windowfocus --sync %s", screen.window, screen.window);
    tool(line);
}

/* Waits for the window's end; returns the exit status. */
static inline int await_end(void) {
    int status = -1;
    double until = seconds_now() + patience_seconds;
    pid_t ended = 0;
    while (!ended && seconds_now() < until) {
        ended = waitpid(screen.skein, &status, WNOHANG);
        if (!ended) pause_for(0.02);
    }
    if (!ended) end_process(&screen.skein, SIGKILL);
    screen.skein = 0;
    if (ended && WIFEXITED(status) && WEXITSTATUS(status) == 0) return 0;
    char *words = read_text(in_folder("words"));
    fprintf(stderr, "%s\n", words);
    free(words);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/* Drags from one place to another in some steps. */
static inline void drag(double x, double y, double to_x, double to_y, int button) {
    char words[512];
    snprintf(
        words, sizeof words,
        "mousemove %.0f %.0f sleep 0.1 mousedown %d sleep 0.05 mousemove %.0f %.0f sleep 0.05 mousemove %.0f %.0f sleep 0.1 "
        "mouseup %d",
        x, y, button, 0.5 * (x + to_x), 0.5 * (y + to_y), to_x, to_y, button);
    tool(words);
}

static inline void click(double x, double y) {
    char words[128];
    snprintf(words, sizeof words, "mousemove %.0f %.0f sleep 0.1 click 1", x, y);
    tool(words);
}

/* ---- Controls ------------------------------------------------------------------------------------------ */

/* Presses the button there until the window says that this control has it. Dear ImGui looks at the pointer once a picture:
 * what is let go by then was never pressed. */
static inline bool take(const char *name, double x, double y) {
    char said[220];
    snprintf(said, sizeof said, "takes %s", name);
    for (int turn = 0; turn < 3; turn++) {
        hand("mousemove %.0f %.0f", x, y);
        hand("sleep 0.03");
        hand("mousedown 1");
        while (hear("takes ", 3))
            if (!strcmp(screen.line, said)) return true;
        hand("mouseup 1");
        await_hands();
    }
    return false;
}

static inline void let_go(double slowly) {
    hand("sleep %g", slowly);
    hand("mouseup 1");
    await_hands();
}

/* Drags the k-th of n numbers' sliders to a share of its width. */
static inline void drag_number(const char *name, const double box[4], int k, int n, double share, double slowly) {
    double wide = (box[2] - 4 * (n - 1)) / n, x = box[0] + k * (wide + 4), y = box[1] + 0.5 * box[3];
    double from = share > 0.5 ? share - 0.3 : share + 0.3;
    if (!take(name, x + from * wide, y)) return;
    hand("mousemove %.0f %.0f", x + share * wide, y);
    let_go(slowly);
}

static inline void press(double x, double y, double slowly) {
    hand("mousemove %.0f %.0f", x, y);
    hand("sleep %g", slowly);
    hand("mousedown 1");
    let_go(slowly);
}

static inline void hold_key(const char *key, double slowly) {
    hand("keydown %s", key);
    hand("sleep %g", slowly);
    hand("keyup %s", key);
    hand("sleep %g", slowly);
}

/* Types into a box and presses Enter. */
static inline void type_into(const char *name, const double box[4], const char *text, double slowly) {
    if (!take(name, box[0] + 0.3 * box[2], box[1] + 0.5 * box[3])) return;
    let_go(slowly);
    hand("keydown ctrl");
    hold_key("a", slowly);
    hand("keyup ctrl");
    hand("type --delay 2 \"%s\"", text);
    hand("sleep %g", slowly);
    hold_key("Return", slowly);
    await_hands();
}

/* Types a number into the k-th of n numbers' sliders: Ctrl and a press, then Enter. */
static inline void type_number(const char *name, int k, int n, const char *number) {
    double box[4];
    assert_true(find_box(name, 0, box, patience_seconds));
    double wide = (box[2] - 4 * (n - 1)) / n;
    hand("keydown ctrl");
    hand("sleep 0.2");
    if (!take(name, box[0] + k * (wide + 4) + 0.4 * wide, box[1] + 0.5 * box[3])) fail_msg("%s is not taken", name);
    let_go(0.05);
    hand("keyup ctrl");
    hand("type --delay 2 \"%s\"", number);
    hand("sleep 0.1");
    hold_key("Return", 0.05);
    await_hands();
}

/* ---- Other programs on the screen ------------------------------------------------------------------- */

/* A second window, which takes the focus; or, asked again, gives it back. */
static inline void focus_elsewhere(bool elsewhere) {
    static Display *display;
    static Window other;
    if (!display) {
        display = XOpenDisplay(screen.display);
        assert_non_null(display);
        other = XCreateSimpleWindow(display, DefaultRootWindow(display), 900, 700, 20, 20, 0, 0, 0);
        XMapWindow(display, other);
        XSync(display, False);
        pause_for(0.1);
    }
    Window target = elsewhere ? other : (Window)strtoul(screen.window, NULL, 10);
    XSetInputFocus(display, target, RevertToParent, CurrentTime);
    XSync(display, False);
}

static inline void send_message(Display *display, Window from, Window to, const char *type, long a, long b, long c,
                                long d) {
    XEvent event = {.xclient = {.type = ClientMessage,
                                .window = to,
                                .message_type = XInternAtom(display, type, False),
                                .format = 32,
                                .data.l = {(long)from, a, b, c, d}}};
    XSendEvent(display, to, False, NoEventMask, &event);
    XFlush(display);
}

/* The window asks for what was dropped, and gets it. */
static inline void hand_over(Display *display, const XSelectionRequestEvent *asked, const char *text) {
    XChangeProperty(display, asked->requestor, asked->property, asked->target, 8, PropModeReplace,
                    (const unsigned char *)text, (int)strlen(text));
    XEvent answer = {.xselection = {.type = SelectionNotify,
                                    .requestor = asked->requestor,
                                    .selection = asked->selection,
                                    .target = asked->target,
                                    .property = asked->property,
                                    .time = asked->time}};
    XSendEvent(display, asked->requestor, False, NoEventMask, &answer);
    XFlush(display);
}

/* Drops a file on the window, as a file manager does (XDND, version 5). */
static inline void drop_file(const char *path) {
    Display *display = XOpenDisplay(screen.display);
    assert_non_null(display);
    Window target = (Window)strtoul(screen.window, NULL, 10);
    Window source = XCreateSimpleWindow(display, DefaultRootWindow(display), 0, 0, 1, 1, 0, 0, 0);
    Atom list = XInternAtom(display, "text/uri-list", False), copy = XInternAtom(display, "XdndActionCopy", False);
    char text[600];
    snprintf(text, sizeof text, "file://%s\r\n", path);
    XSetSelectionOwner(display, XInternAtom(display, "XdndSelection", False), source, CurrentTime);
    send_message(display, source, target, "XdndEnter", 5L << 24, (long)list, 0, 0);
    send_message(display, source, target, "XdndPosition", 0, 320 << 16 | 180, CurrentTime, (long)copy);
    send_message(display, source, target, "XdndDrop", 0, CurrentTime, 0, 0);
    bool done = false;
    for (double until = seconds_now() + patience_seconds; !done && seconds_now() < until;) {
        if (!XPending(display)) {
            pause_for(0.01);
            continue;
        }
        XEvent event;
        XNextEvent(display, &event);
        if (event.type == SelectionRequest) hand_over(display, &event.xselectionrequest, text);
        done = event.type == ClientMessage && event.xclient.message_type == XInternAtom(display, "XdndFinished", False);
    }
    XCloseDisplay(display);
    assert_true(done);
}

/* What a window manager's closing button says. */
static inline void ask_to_close(void) {
    Display *display = XOpenDisplay(screen.display);
    assert_non_null(display);
    Window target = (Window)strtoul(screen.window, NULL, 10);
    send_message(display, XInternAtom(display, "WM_DELETE_WINDOW", False), target, "WM_PROTOCOLS", CurrentTime, 0, 0, 0);
    XCloseDisplay(display);
}

/* ---- Pictures -------------------------------------------------------------------------------------------- */

/* The share of pixels that differ by more than so much, of 255. */
static inline double difference_over(const char *one, const char *other, int most_apart) {
    render_image a = {0}, b = {0};
    assert_int_equal(render_image_read(&a, one, NULL), SKEIN_OK);
    assert_int_equal(render_image_read(&b, other, NULL), SKEIN_OK);
    assert_int_equal(a.width, b.width);
    assert_int_equal(a.height, b.height);
    size_t count = (size_t)a.width * (size_t)a.height, differ = 0;
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0, most = 0; k < 3 && !most; k++)
            if (abs((int)a.pixels[3 * i + k] - (int)b.pixels[3 * i + k]) > most_apart) differ++, most = 1;
    render_image_release(&a);
    render_image_release(&b);
    return (double)differ / (double)count;
}

/* By more than a little. */
static inline double difference(const char *one, const char *other) {
    return difference_over(one, other, 3);
}

#endif
