/* GIF: one palette for the whole film, so that what stands still keeps its colours from picture to picture.
 *
 * The palette needs all pictures, and GIF needs the palette first: until the end the pictures wait in a file
 * without a name, beside the film's. So of a process that is killed no GIF is left. */
#include <errno.h>
#include <fcntl.h>
#include <libavfilter/avfilter.h>
#include <libavfilter/buffersink.h>
#include <libavfilter/buffersrc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "film/stream.h"
#include "render/fail.h"

typedef struct gif {
    film_stream *stream;
    film_job job;
    char *path;
    int store;       /* the pictures' file */
    size_t pictures; /* in it */
    bool failed;
} gif;

/* A filter graph with sources "in" (and "palette") and a sink "out". */
typedef struct graph {
    AVFilterGraph *graph;
    AVFilterContext *in, *palette, *out;
} graph;

/* ---- the store ---- */

static int open_store(const char *path) {
    const char *slash = strrchr(path, '/');
    size_t folder = slash ? (size_t)(slash + 1 - path) : 0, size = folder + 32;
    char *name = malloc(size);
    if (!name) return -1;
    snprintf(name, size, "%.*s%s", (int)folder, path, slash ? "" : ".");
    int fd = open(name, O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (fd < 0 && (errno == EOPNOTSUPP || errno == EISDIR || errno == EINVAL)) { // not every file system has it
        snprintf(name, size, "%.*s.skein-XXXXXX", (int)folder, path);
        fd = mkostemp(name, O_CLOEXEC);
        if (fd >= 0) unlink(name);
    }
    free(name);
    return fd;
}

static size_t picture_size(const gif *g) {
    return 3 * (size_t)g->job.options.size[0] * (size_t)g->job.options.size[1];
}

static int store_picture(const gif *g, const uint8_t *pixels) {
    for (size_t left = picture_size(g); left > 0;) {
        ssize_t done = write(g->store, pixels, left);
        if (done < 0 && errno != EINTR) return errno;
        if (done > 0) pixels += done, left -= (size_t)done;
    }
    return 0;
}

/* Picture `index` as a new frame; NULL when it cannot be read, or there is no memory. */
static AVFrame *fetch_picture(const gif *g, size_t index) {
    AVFrame *frame = av_frame_alloc();
    int width = g->job.options.size[0], height = g->job.options.size[1];
    if (!frame) return NULL;
    frame->width = width;
    frame->height = height;
    frame->format = AV_PIX_FMT_RGB24;
    frame->pts = (int64_t)index;
    bool good = av_frame_get_buffer(frame, 0) >= 0;
    off_t at = (off_t)(index * picture_size(g));
    for (int y = 0; y < height && good; y++, at += 3 * width)
        good = pread(g->store, frame->data[0] + (ptrdiff_t)y * frame->linesize[0], 3 * (size_t)width, at) == 3 * width;
    if (!good) av_frame_free(&frame);
    return frame;
}

/* ---- filters ---- */

static AVFilterContext *make_source(const graph *g, const char *name, enum AVPixelFormat pixels, int width, int height,
                                    AVRational time_base) {
    char arguments[160];
    AVFilterContext *source = NULL;
    snprintf(arguments, sizeof arguments, "video_size=%dx%d:pix_fmt=%d:time_base=%d/%d:pixel_aspect=1/1", width, height,
             (int)pixels, time_base.num, time_base.den);
    return avfilter_graph_create_filter(&source, avfilter_get_by_name("buffer"), name, arguments, NULL, g->graph) < 0
               ? NULL
               : source;
}

static bool make_graph(graph *g, const gif *of, const char *filters, bool with_palette) {
    AVRational time_base = av_inv_q(av_d2q(of->job.rate, 1000000));
    int width = of->job.options.size[0], height = of->job.options.size[1];
    g->graph = avfilter_graph_alloc();
    if (!g->graph) return false;
    g->graph->nb_threads = 1;
    g->in = make_source(g, "in", AV_PIX_FMT_RGB24, width, height, time_base);
    if (with_palette) g->palette = make_source(g, "palette", AV_PIX_FMT_RGB32, 16, 16, time_base);
    if (!g->in || (with_palette && !g->palette) ||
        avfilter_graph_create_filter(&g->out, avfilter_get_by_name("buffersink"), "out", NULL, NULL, g->graph) < 0)
        return false;
    AVFilterInOut *sources = avfilter_inout_alloc(), *sink = avfilter_inout_alloc(),
                  *second = with_palette ? avfilter_inout_alloc() : NULL;
    bool good = sources && sink && (!with_palette || second);
    if (good) {
        *sources = (AVFilterInOut){av_strdup("in"), g->in, 0, second};
        *sink = (AVFilterInOut){av_strdup("out"), g->out, 0, NULL};
        if (second) *second = (AVFilterInOut){av_strdup("palette"), g->palette, 0, NULL};
        good = avfilter_graph_parse_ptr(g->graph, filters, &sink, &sources, NULL) >= 0 &&
               avfilter_graph_config(g->graph, NULL) >= 0;
    }
    avfilter_inout_free(&sources);
    avfilter_inout_free(&sink);
    return good;
}

/* The one palette of all pictures, or NULL. */
static AVFrame *make_palette(const gif *g) {
    graph one = {0};
    char filters[96];
    int quality = g->job.options.quality, colours = quality >= 75 ? 256 : 256 * quality / 75;
    snprintf(filters, sizeof filters, "[in]palettegen=max_colors=%d:stats_mode=full[out]", colours < 8 ? 8 : colours);
    bool good = make_graph(&one, g, filters, false);
    for (size_t i = 0; i < g->pictures && good; i++) {
        AVFrame *frame = fetch_picture(g, i);
        good = frame && av_buffersrc_add_frame(one.in, frame) >= 0;
        av_frame_free(&frame);
    }
    AVFrame *palette = av_frame_alloc();
    good =
        good && palette && av_buffersrc_add_frame(one.in, NULL) >= 0 && av_buffersink_get_frame(one.out, palette) >= 0;
    if (!good) av_frame_free(&palette);
    avfilter_graph_free(&one.graph);
    return palette;
}

/* What comes out of the graph goes into the film. */
static skein_status drain(const gif *g, const graph *two, skein_error *error) {
    skein_status status = SKEIN_OK;
    AVFrame *frame = av_frame_alloc();
    if (!frame) return render_fail_memory(error, "a picture of the film");
    while (status == SKEIN_OK && av_buffersink_get_frame(two->out, frame) >= 0) {
        status = film_stream_write(g->stream, frame, error);
        av_frame_unref(frame);
    }
    av_frame_free(&frame);
    return status;
}

static skein_status write_all(const gif *g, AVFrame *palette, skein_error *error) {
    // an ordered pattern stays where it is, so that what does not move costs nothing
    static const char filters[] = "[in][palette]paletteuse=dither=bayer:bayer_scale=3:diff_mode=rectangle[out]";
    graph two = {0};
    skein_status status = SKEIN_OK;
    bool good = make_graph(&two, g, filters, true) && av_buffersrc_add_frame(two.palette, palette) >= 0 &&
                av_buffersrc_add_frame(two.palette, NULL) >= 0;
    for (size_t i = 0; i < g->pictures && good && status == SKEIN_OK; i++) {
        AVFrame *frame = fetch_picture(g, i);
        good = frame && av_buffersrc_add_frame(two.in, frame) >= 0;
        av_frame_free(&frame);
        if (good) status = drain(g, &two, error);
    }
    if (good && status == SKEIN_OK) {
        good = av_buffersrc_add_frame(two.in, NULL) >= 0;
        if (good) status = drain(g, &two, error);
    }
    avfilter_graph_free(&two.graph);
    return good ? status : film_fail_av(error, g->path, "the GIF's colours cannot be reduced", AVERROR_EXTERNAL);
}

/* ---- the maker ---- */

static void prepare(const film_job *job, AVCodecContext *codec, AVDictionary **options) {
    (void)job, (void)codec, (void)options;
}

static skein_status end(void *state, bool complete, skein_error *error) {
    gif *g = state;
    complete = complete && !g->failed && g->pictures; // a GIF of no pictures is none
    skein_status status = SKEIN_OK;
    if (complete) {
        AVFrame *palette = make_palette(g);
        status = palette ? write_all(g, palette, error)
                         : film_fail_av(error, g->path, "the GIF's palette cannot be made", AVERROR_EXTERNAL);
        av_frame_free(&palette);
    }
    if (g->stream) {
        skein_error later = {SKEIN_OK, "", ""};
        skein_status closed = film_stream_close(g->stream, complete && status == SKEIN_OK, &later);
        if (status == SKEIN_OK && closed != SKEIN_OK) {
            status = closed;
            if (error) *error = later;
        }
    }
    if (g->store >= 0) close(g->store);
    free(g->path);
    free(g);
    return status;
}

static void *begin(const film_job *job, skein_error *error) {
    gif *g = calloc(1, sizeof *g);
    if (!g || !(g->path = strdup(job->path))) {
        free(g);
        render_fail_memory(error, "the film");
        return NULL;
    }
    g->job = *job;
    g->job.path = g->path;
    g->store = open_store(job->path);
    if (g->store < 0) film_fail_file(error, job->path, errno);
    else g->stream = film_stream_open(&g->job, "gif", AV_PIX_FMT_PAL8, prepare, "loop=0", error);
    if (g->stream) return g;
    end(g, false, NULL);
    return NULL;
}

static skein_status add(void *state, const render_image *image, skein_error *error) {
    gif *g = state;
    int reason = store_picture(g, image->pixels);
    g->failed |= reason != 0;
    if (reason) return film_fail_file(error, g->path, reason);
    g->pictures++;
    return SKEIN_OK;
}

const film_maker film_gif = {begin, add, end};
