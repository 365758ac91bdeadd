/* Tests of film/: small films of known pictures, written and read back. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <dirent.h>
#include <math.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "film/film.h"
#include "film/maker.h"
#include "film_reader.h"

#define COUNT(array_) (sizeof(array_) / sizeof *(array_))

static char folder[] = "/tmp/test_film_XXXXXX";

static char *in_folder(const char *name) {
    static char paths[8][256];
    static int turn;
    char *path = paths[turn++ % 8];
    snprintf(path, sizeof paths[0], "%s/%s", folder, name);
    return path;
}

static bool exists(const char *path) {
    return access(path, F_OK) == 0;
}

static long size_of(const char *path) {
    struct stat info;
    assert_int_equal(stat(path, &info), 0);
    return (long)info.st_size;
}

/* ---- The pictures: patches of known colours that stand still, and a white square that moves -------------- */

enum { wide = 128, high = 72, pictures = 20 };
static const uint8_t patches[8][3] = {{230, 40, 30}, {40, 200, 60},   {30, 60, 220},   {240, 220, 60},
                                      {20, 20, 20},  {128, 128, 128}, {180, 210, 235}, {160, 110, 70}};

static int square_at(int picture) {
    return 4 + 4 * picture;
}

static void paint(render_image *image, int width, int height, int picture) {
    assert_int_equal(render_image_resize(image, width, height, NULL), SKEIN_OK);
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            uint8_t *p = image->pixels + 3 * ((size_t)y * (size_t)width + (size_t)x);
            bool square = y >= height - 12 && y < height - 4 && x >= square_at(picture) && x < square_at(picture) + 8;
            const uint8_t *colour =
                y < height - 16 ? patches[(x * 4 / width) + 4 * (y > (height - 16) / 2)] : patches[4];
            for (int k = 0; k < 3; k++) p[k] = square ? 255 : colour[k];
        }
}

static film_options options_of(int width, int height, int quality) {
    film_options options = film_default_options();
    options.size[0] = width, options.size[1] = height;
    options.quality = quality;
    return options;
}

static void must(skein_status status, const skein_error *error) {
    if (status) fprintf(stderr, "%s: %s\n", error->where, error->message);
    assert_int_equal(status, SKEIN_OK);
}

static void make(const char *path, int count, double rate, const film_options *options) {
    skein_error error = {SKEIN_OK, "", ""};
    render_image image = {0};
    film *f = film_create(path, options, rate, &error);
    if (!f) fprintf(stderr, "%s: %s\n", error.where, error.message);
    assert_non_null(f);
    for (int i = 0; i < count; i++) {
        paint(&image, options->size[0], options->size[1], i);
        must(film_add(f, &image, &error), &error);
    }
    must(film_finish(f, &error), &error);
    render_image_release(&image);
}

/* ---- What comes back ---------------------------------------------------------------------------------------- */

/* The mean of the patch's inner part is the patch's colour, within `off`. */
static void judge_patches(const film_seen *seen, int picture, double off) {
    for (int i = 0; i < 8; i++) {
        double sum[3] = {0}, count = 0;
        int left = (i % 4) * wide / 4 + 6, top = (i / 4) * (high - 16) / 2 + 6;
        for (int y = top; y < top + 16; y++)
            for (int x = left; x < left + 20; x++, count++)
                for (int k = 0; k < 3; k++) sum[k] += film_seen_pixel(seen, picture, x, y)[k];
        for (int k = 0; k < 3; k++)
            if (fabs(sum[k] / count - patches[i][k]) > off)
                fail_msg("patch %d, colour %d: %.1f is not %d", i, k, sum[k] / count, patches[i][k]);
    }
}

/* Where the white square is, by its middle. */
static double square_seen(const film_seen *seen, int picture) {
    double sum = 0, count = 0;
    for (int x = 0; x < wide; x++) {
        double light = film_seen_pixel(seen, picture, x, high - 8)[1];
        if (light > 140) sum += x + 0.5, count++;
    }
    assert_true(count >= 6 && count <= 10);
    return sum / count;
}

static void a_film_comes_back_as_it_was(void **state) {
    static const struct {
        const char *name, *codec;
        double rate, plays, off;
    } films[] = {
        {"a.mp4", "h264", 30, 30, 4},
        {"a.webm", "vp9", 30, 30, 4},
        {"a.gif", "gif", 25, 25, 3},
        {"odd rate.MP4", "h264", 23.976, 23.976, 4},
    };
    (void)state;
    for (size_t i = 0; i < COUNT(films); i++) {
        film_options options = options_of(wide, high, 85);
        make(in_folder(films[i].name), pictures, films[i].rate, &options);
        film_seen seen = film_see(in_folder(films[i].name));
        assert_string_equal(seen.codec, films[i].codec);
        assert_false(seen.broken);
        assert_int_equal(seen.pictures, pictures);
        assert_int_equal(seen.width, wide);
        assert_int_equal(seen.height, high);
        assert_true(seen.bt709 || films[i].codec[0] == 'g');
        assert_true(fabs(seen.start) < 1e-3);
        // a GIF counts hundredths of a second, WebM thousandths
        assert_true(fabs(seen.end - (pictures - 1) / films[i].plays) < 0.011);
        assert_true(fabs(seen.length - pictures / films[i].plays) < 0.02);
        for (int k = 0; k < pictures; k++) {
            judge_patches(&seen, k, films[i].off);
            assert_true(fabs(square_seen(&seen, k) - (square_at(k) + 4)) < 0.8);
        }
        film_seen_free(&seen);
        assert_int_equal(unlink(in_folder(films[i].name)), 0);
    }
}

/* The last picture has its time, too, even where there is no other. (Alone in a GIF it would stand for ever.) */
static void one_picture_is_a_film(void **state) {
    static const char *const names[] = {"one.mp4", "one.webm"};
    (void)state;
    film_options options = options_of(wide, high, 75);
    for (size_t i = 0; i < COUNT(names); i++) {
        make(in_folder(names[i]), 1, 2, &options);
        film_seen seen = film_see(in_folder(names[i]));
        assert_int_equal(seen.pictures, 1);
        if (fabs(seen.length - 0.5) > 0.02) fail_msg("%s: %g s", names[i], seen.length);
        film_seen_free(&seen);
        unlink(in_folder(names[i]));
    }
}

/* One second from key to key: what a film that was cut off loses at most, and how far a player must look. */
static void there_is_a_key_every_second(void **state) {
    (void)state;
    film_options options = options_of(64, 36, 30);
    make(in_folder("keys.mp4"), 45, 10, &options);
    film_seen seen = film_see(in_folder("keys.mp4"));
    assert_int_equal(seen.pictures, 45);
    assert_true(seen.keys >= 5);
    assert_true(fabs(seen.length - 4.5) < 0.02);
    film_seen_free(&seen);
    unlink(in_folder("keys.mp4"));
}

static void quality_shows_in_the_size(void **state) {
    static const char *const names[] = {"q.mp4", "q.webm", "q.gif"};
    (void)state;
    for (size_t i = 0; i < COUNT(names); i++) {
        long sizes[2];
        for (int good = 0; good < 2; good++) {
            render_image image = {0};
            film_options options = options_of(wide, high, good ? 95 : 10);
            film *f = film_create(in_folder(names[i]), &options, 25, NULL);
            assert_non_null(f);
            for (int k = 0; k < 6; k++) {
                assert_int_equal(render_image_resize(&image, wide, high, NULL), SKEIN_OK);
                for (int p = 0; p < 3 * wide * high; p++) // many colours, and no flat part
                    image.pixels[p] = (uint8_t)(128 + 100 * sin(0.02 * p + k) * cos(0.31 * (p % 977)));
                assert_int_equal(film_add(f, &image, NULL), SKEIN_OK);
            }
            assert_int_equal(film_finish(f, NULL), SKEIN_OK);
            render_image_release(&image);
            sizes[good] = size_of(in_folder(names[i]));
        }
        assert_true(sizes[1] > sizes[0] * 5 / 4);
        unlink(in_folder(names[i]));
    }
}

/* ---- GIF ------------------------------------------------------------------------------------------------------ */

static int count_colours(const film_seen *seen) {
    static unsigned char there[1 << 24];
    int count = 0;
    memset(there, 0, sizeof there);
    for (size_t i = 0; i < (size_t)seen->pictures * (size_t)seen->width * (size_t)seen->height; i++) {
        const uint8_t *p = seen->pixels + 3 * i;
        size_t colour = (size_t)p[0] << 16 | (size_t)p[1] << 8 | p[2];
        count += !there[colour];
        there[colour] = 1;
    }
    return count;
}

/* A gradient has more colours than a palette: what stands still must not flicker all the same, and the mean of
 * any part of it must be right. */
static void a_gif_has_one_good_palette(void **state) {
    (void)state;
    int colours[2];
    for (int good = 0; good < 2; good++) {
        render_image image = {0};
        film_options options = options_of(wide, high, good ? 75 : 10);
        film *f = film_create(in_folder("g.gif"), &options, 20, NULL);
        assert_non_null(f);
        for (int k = 0; k < 5; k++) {
            assert_int_equal(render_image_resize(&image, wide, high, NULL), SKEIN_OK);
            for (int i = 0; i < wide * high; i++) {
                int x = i % wide, y = i / wide;
                bool square = y >= high - 12 && x >= 20 * k && x < 20 * k + 12;
                uint8_t colour[3] = {(uint8_t)(2 * x), (uint8_t)(40 + 2 * y), (uint8_t)(220 - x)};
                for (int c = 0; c < 3; c++) image.pixels[3 * i + c] = square ? 255 : colour[c];
            }
            assert_int_equal(film_add(f, &image, NULL), SKEIN_OK);
        }
        assert_int_equal(film_finish(f, NULL), SKEIN_OK);
        render_image_release(&image);
        film_seen seen = film_see(in_folder("g.gif"));
        assert_int_equal(seen.pictures, 5);
        colours[good] = count_colours(&seen);
        double worst = 0; // of the means of squares, which dithering keeps where single pixels cannot be right
        for (int k = 1; k < 5; k++)
            assert_memory_equal(film_seen_pixel(&seen, 0, 0, 0), film_seen_pixel(&seen, k, 0, 0),
                                3 * wide * (high - 12));
        for (int top = 0; top + 16 <= high - 12; top += 16)
            for (int left = 0; left + 16 <= wide; left += 16) {
                double off[3] = {0};
                for (int y = top; y < top + 16; y++)
                    for (int x = left; x < left + 16; x++) {
                        const uint8_t *p = film_seen_pixel(&seen, 2, x, y);
                        off[0] += p[0] - 2.0 * x, off[1] += p[1] - 40 - 2.0 * y, off[2] += p[2] - 220.0 + x;
                    }
                for (int c = 0; c < 3; c++) worst = fmax(worst, fabs(off[c]) / 256);
            }
        assert_true(worst < (good ? 1.5 : 3.5));
        film_seen_free(&seen);
    }
    assert_true(colours[1] <= 256 && colours[1] > 150);
    assert_true(colours[0] <= 40);
    unlink(in_folder("g.gif"));
}

/* ---- Numbered pictures ------------------------------------------------------------------------------------------ */

static void numbers_go_where_the_name_says(void **state) {
    static const struct {
        const char *name, *first, *third;
    } series[] = {
        {"n-%04d.png", "n-0000.png", "n-0002.png"}, {"n-%d.png", "n-0.png", "n-2.png"},
        {"n-###.png", "n-000.png", "n-002.png"},    {"%03d n 100%.PNG", "000 n 100%.PNG", "002 n 100%.PNG"},
        {"#1 ##.png", "#1 00.png", "#1 02.png"},    {"n%s%n##.png", "n%s%n00.png", "n%s%n02.png"},
    };
    (void)state;
    film_options options = options_of(31, 17, 75); // any size will do
    for (size_t i = 0; i < COUNT(series); i++) {
        assert_true(film_path_is_numbered(series[i].name));
        make(in_folder(series[i].name), 3, 60, &options);
        render_image is = {0}, ought = {0};
        assert_int_equal(render_image_read(&is, in_folder(series[i].third), NULL), SKEIN_OK);
        paint(&ought, 31, 17, 2);
        assert_memory_equal(is.pixels, ought.pixels, 31 * 17 * 3);
        render_image_release(&is);
        render_image_release(&ought);
        DIR *open_folder = opendir(folder);
        int count = 0;
        for (struct dirent *entry; (entry = readdir(open_folder)) != NULL;) {
            if (entry->d_name[0] == '.') continue;
            count++;
            assert_int_equal(unlinkat(dirfd(open_folder), entry->d_name, 0), 0);
        }
        closedir(open_folder);
        assert_int_equal(count, 3);
    }
    static const char *const plain[] = {"a.png", "take #1.png", "100%.png", "%x.png", "%123d.png"};
    for (size_t i = 0; i < COUNT(plain); i++) assert_false(film_path_is_numbered(plain[i]));
    static const char *const bad[] = {"%02d-%02d.png", "##-%d.png", "%99d.png", "a.png"};
    for (size_t i = 0; i < COUNT(bad); i++) {
        skein_error error = {SKEIN_OK, "", ""};
        assert_null(film_create(in_folder(bad[i]), &options, 60, &error));
        assert_non_null(strstr(error.message, "name-%04d.png or name-####.png"));
    }
}

/* ---- What can be written -------------------------------------------------------------------------------------------
 */

static void an_ending_says_what_it_becomes(void **state) {
    (void)state;
    skein_error error = {SKEIN_OK, "", ""};
    assert_string_equal(film_format_of("a.b/c.mp4", &error)->ending, ".mp4");
    assert_string_equal(film_format_of("C.WebM", &error)->ending, ".webm");
    assert_string_equal(film_format_of("a.mp4.gif", &error)->ending, ".gif");
    static const char *const unknown[] = {"a.avi", "a", "a.mp4/b", ".mp4", "a.", ""};
    for (size_t i = 0; i < COUNT(unknown); i++) {
        assert_null(film_format_of(unknown[i], &error));
        assert_int_equal(error.status, SKEIN_ERROR_NAME);
        assert_non_null(strstr(error.message, "can be written here: .mp4, .webm, .gif, .png"));
    }
    assert_null(film_format_at(4));
    for (size_t i = 0; film_format_at(i); i++) assert_true(film_format_is_here(film_format_at(i)));
    // the exporter's words are the formats' endings, in their order
    const skein_field *format = skein_field_find(film_exporter(), "format", NULL);
    const char *word = format->choices;
    for (size_t i = 0; i <= (size_t)format->most; i++, word += strcspn(word, "|") + 1) {
        assert_int_equal(strcspn(word, "|"), strlen(film_format_at(i)->ending) - 1);
        assert_memory_equal(word, film_format_at(i)->ending + 1, strcspn(word, "|"));
    }
}

static bool is_gif(const char *encoder) {
    return !strcmp(encoder, "gif");
}

static bool is_second(const char *encoder) {
    return !strcmp(encoder, "libopenh264") || !strcmp(encoder, "libsvtav1");
}

static void a_missing_encoder_is_named(void **state) {
    (void)state;
    skein_error error = {SKEIN_OK, "", ""};
    char text[128];
    assert_null(film_choose_encoder(film_format_at(0), "a.film", is_gif, &error));
    assert_string_equal(error.where, "a.film");
    assert_string_equal(error.message,
                        "H.264 in MP4 needs an encoder that this libavcodec has not: libx264 or libopenh264; can be "
                        "written here: .gif, .png (numbered: name-%04d.png)");
    assert_null(film_choose_encoder(film_format_at(1), "a.film", is_gif, &error));
    assert_non_null(strstr(error.message, "libvpx-vp9 or libsvtav1 or libaom-av1; can be written here: .gif, .png"));
    assert_string_equal(film_choose_encoder(film_format_at(2), "a.film", is_gif, &error), "gif");
    // the second best is taken where the best is not there
    assert_string_equal(film_choose_encoder(film_format_at(0), "a.film", is_second, &error), "libopenh264");
    assert_string_equal(film_choose_encoder(film_format_at(1), "a.film", is_second, &error), "libsvtav1");
    film_list_formats(is_second, text, sizeof text);
    assert_string_equal(text, ".mp4, .webm, .png");
}

static void sizes_and_rates_are_made_to_fit(void **state) {
    (void)state;
    const film_format *mp4 = film_format_at(0), *gif = film_format_at(2), *png = film_format_at(3);
    int32_t odd[2] = {641, 361}, one[2] = {1, 1}, free_size[2] = {641, 361};
    film_fit_size(mp4, odd);
    film_fit_size(mp4, one);
    film_fit_size(gif, free_size);
    assert_true(odd[0] == 640 && odd[1] == 360 && one[0] == 2 && one[1] == 2);
    assert_true(free_size[0] == 641 && free_size[1] == 361);
    assert_int_equal(film_every(mp4, 60), 1);
    assert_int_equal(film_every(mp4, 240), 1);
    assert_int_equal(film_every(mp4, 1000), 5);
    assert_int_equal(film_every(gif, 50), 1);
    assert_int_equal(film_every(gif, 60), 2);
    assert_int_equal(film_every(gif, 1e-3), 1);
    assert_int_equal(film_every(png, 1e6), 1);

    film_options options = options_of(33, 17, 75);
    make(in_folder("odd.gif"), 3, 10, &options);
    film_seen seen = film_see(in_folder("odd.gif"));
    assert_true(seen.pictures == 3 && seen.width == 33 && seen.height == 17);
    film_seen_free(&seen);
    unlink(in_folder("odd.gif"));
    // a picture of another size is refused
    render_image image = {0};
    skein_error error = {SKEIN_OK, "", ""};
    film *f = film_create(in_folder("odd.mp4"), &options, 10, &error); // makes it 32 x 16
    assert_non_null(f);
    paint(&image, 33, 17, 0);
    assert_int_equal(film_add(f, &image, &error), SKEIN_ERROR_VALUE);
    assert_string_equal(error.message, "a picture of 33 x 17 in a film of 32 x 16");
    render_image_release(&image);
    film_abandon(f);
    assert_false(exists(in_folder("odd.mp4")));
    film_abandon(NULL);
}

/* ---- Trouble ----------------------------------------------------------------------------------------------------- */

static void failures_say_what_and_where(void **state) {
    static const char *const names[] = {"no/such/a.mp4", "no/such/a.webm", "no/such/a.gif"};
    (void)state;
    skein_error error = {SKEIN_OK, "", ""};
    film_options options = options_of(64, 36, 75);
    for (size_t i = 0; i < COUNT(names); i++) {
        assert_null(film_create(in_folder(names[i]), &options, 30, &error));
        assert_int_equal(error.status, SKEIN_ERROR_FILE);
        assert_string_equal(error.where, in_folder(names[i]));
        assert_string_equal(error.message, "cannot write: its directory does not exist, create it first");
    }
    assert_int_equal(mkdir(in_folder("dir.mp4"), 0777), 0);
    assert_null(film_create(in_folder("dir.mp4"), &options, 30, &error));
    assert_string_equal(error.message, "cannot write: it is a directory, name a file in it");
    assert_int_equal(rmdir(in_folder("dir.mp4")), 0);
    // /dev/full is a full disk; it is a device, which no one removes
    static const char *const links[] = {"full.mp4", "full.webm"};
    for (size_t i = 0; i < COUNT(links); i++) {
        assert_int_equal(symlink("/dev/full", in_folder(links[i])), 0);
        film *f = film_create(in_folder(links[i]), &options, 30, &error);
        render_image image = {0};
        skein_status status = f ? SKEIN_OK : SKEIN_ERROR_FILE;
        for (int k = 0; f && k < 100 && !status; k++) {
            paint(&image, 64, 36, k);
            status = film_add(f, &image, &error);
        }
        if (f) status = film_finish(f, &error);
        assert_int_equal(status, SKEIN_ERROR_FILE);
        assert_string_equal(error.message, "cannot write: the disk is full, make room or write elsewhere");
        render_image_release(&image);
        assert_int_equal(unlink(in_folder(links[i])), 0);
    }
    assert_true(exists("/dev/full"));
}

/* What was written before the disk was full can be played; of a GIF nothing is left. */
static void a_full_disk_ends_a_film(void **state) {
    static const char *const names[] = {"limit.mp4", "limit.webm", "limit.gif", "limit-%03d.png"};
    (void)state;
    struct rlimit before, small;
    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    for (size_t i = 0; i < COUNT(names); i++) {
        skein_error error = {SKEIN_OK, "", ""};
        film_options options = options_of(wide, high, 100);
        film *f = film_create(in_folder(names[i]), &options, 10, &error);
        assert_non_null(f);
        small = before;
        small.rlim_cur = i == 3 ? 100 : 30000;
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
        skein_status status = SKEIN_OK;
        render_image image = {0};
        for (int k = 0; k < 400 && !status; k++) {
            paint(&image, wide, high, k % 20);
            for (int p = 0; p < 3 * wide * 20; p++) image.pixels[p] = (uint8_t)((p * (k + 7) * 2654435761u) >> 13);
            status = film_add(f, &image, &error);
        }
        assert_int_equal(status, SKEIN_ERROR_FILE);
        assert_non_null(strstr(error.message, i == 3 ? "File too large" : "it grew over the limit for a file's size"));
        skein_error later = {SKEIN_OK, "", ""};
        assert_int_equal(film_finish(f, &later), SKEIN_ERROR_FILE);
        assert_string_equal(later.message, error.message);
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
        render_image_release(&image);
        assert_false(exists(in_folder(names[i]))); // nothing that is cut short has the name of what is whole
        if (i > 1) continue;
        const char *kept = i ? "limit.failed.webm" : "limit.failed.mp4";
        film_seen seen = film_see(in_folder(kept));
        assert_true(seen.pictures >= 5);
        film_seen_free(&seen);
        unlink(in_folder(kept));
    }
}

static void an_abandoned_film_is_gone(void **state) {
    static const char *const names[] = {"gone.mp4", "gone.webm", "gone.gif"};
    (void)state;
    film_options options = options_of(wide, high, 75);
    for (size_t i = 0; i < COUNT(names); i++) {
        film *f = film_create(in_folder(names[i]), &options, 30, NULL);
        assert_non_null(f);
        render_image image = {0};
        for (int k = 0; k < 7; k++) {
            paint(&image, wide, high, k);
            assert_int_equal(film_add(f, &image, NULL), SKEIN_OK);
        }
        render_image_release(&image);
        film_abandon(f);
        assert_false(exists(in_folder(names[i])));
    }
}

/* A longer film under the same name leaves nothing behind the end of a shorter one. */
static void a_new_film_takes_the_place_of_the_old(void **state) {
    (void)state;
    film_options options = options_of(wide, high, 90);
    make(in_folder("again.mp4"), 40, 30, &options);
    long longer = size_of(in_folder("again.mp4"));
    make(in_folder("again.mp4"), 4, 30, &options);
    assert_true(size_of(in_folder("again.mp4")) < longer);
    film_seen seen = film_see(in_folder("again.mp4"));
    assert_int_equal(seen.pictures, 4);
    film_seen_free(&seen);
    unlink(in_folder("again.mp4"));
}

static void a_film_without_pictures_does_no_harm(void **state) {
    static const char *const names[] = {"none.mp4", "none.webm", "none.gif"};
    (void)state;
    film_options options = options_of(wide, high, 75);
    for (size_t i = 0; i < COUNT(names); i++) {
        film *f = film_create(in_folder(names[i]), &options, 30, NULL);
        assert_non_null(f);
        skein_error error = {SKEIN_OK, "", ""};
        must(film_finish(f, &error), &error);
        unlink(in_folder(names[i]));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_film_comes_back_as_it_was),
        cmocka_unit_test(one_picture_is_a_film),
        cmocka_unit_test(there_is_a_key_every_second),
        cmocka_unit_test(quality_shows_in_the_size),
        cmocka_unit_test(a_gif_has_one_good_palette),
        cmocka_unit_test(numbers_go_where_the_name_says),
        cmocka_unit_test(an_ending_says_what_it_becomes),
        cmocka_unit_test(a_missing_encoder_is_named),
        cmocka_unit_test(sizes_and_rates_are_made_to_fit),
        cmocka_unit_test(failures_say_what_and_where),
        cmocka_unit_test(a_full_disk_ends_a_film),
        cmocka_unit_test(an_abandoned_film_is_gone),
        cmocka_unit_test(a_new_film_takes_the_place_of_the_old),
        cmocka_unit_test(a_film_without_pictures_does_no_harm),
    };
    if (!mkdtemp(folder)) return 1;
    int failed = cmocka_run_group_tests_name("films", tests, NULL, NULL);
    return failed + (rmdir(folder) != 0); // and nothing was left
}
