/* MP4 and WebM: from sRGB to the film's colours, and what each encoder is told. */
#include <libswscale/swscale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "film/stream.h"
#include "render/fail.h"

typedef struct video {
    film_stream *stream;
    struct SwsContext *scale;
    AVFrame *frame;
} video;

/* What an encoder is told. `crf`, its constant quality, at our qualities 1 and 100. */
static const struct {
    const char *encoder;
    double worst, best;
    const char *options;
} encoders[] = {
    {"libx264", 45, 12, "preset=fast"},
    {"libvpx-vp9", 60, 12, "deadline=good:cpu-used=4:row-mt=1"},
    {"libsvtav1", 60, 12, "preset=8"},
    {"libaom-av1", 60, 12, "cpu-used=6:row-mt=1"},
};

/* Fragments from key picture to key picture, once a second: a film that is cut off anywhere can be played.
 * (The head waits for the first of them, and can so say when the first picture is due.) */
static const char mp4_options[] = "movflags=frag_keyframe+empty_moov+default_base_moof+delay_moov";
static const char webm_options[] = "cluster_time_limit=1000";

static void prepare(const film_job *job, AVCodecContext *codec, AVDictionary **options) {
    double quality = (job->options.quality - 1) / 99.0, pixels = (double)codec->width * codec->height;
    // the picture's own colours, as high definition video has them: what players expect
    codec->colorspace = AVCOL_SPC_BT709;
    codec->color_primaries = AVCOL_PRI_BT709;
    codec->color_trc = AVCOL_TRC_BT709;
    codec->color_range = AVCOL_RANGE_MPEG;
    codec->chroma_sample_location = AVCHROMA_LOC_LEFT;
    codec->gop_size = (int)fmax(1, round(job->rate));
    // where there is no constant quality: bits a pixel
    codec->bit_rate = (int64_t)(job->rate * pixels * 0.02 * exp2(4 * quality));
    for (size_t i = 0; i < sizeof encoders / sizeof *encoders; i++) {
        char crf[32];
        if (strcmp(codec->codec->name, encoders[i].encoder)) continue;
        codec->bit_rate = 0;
        av_dict_parse_string(options, encoders[i].options, "=", ":", 0);
        snprintf(crf, sizeof crf, "%d",
                 (int)lround(encoders[i].worst + quality * (encoders[i].best - encoders[i].worst)));
        av_dict_set(options, "crf", crf, 0);
    }
}

static skein_status end(void *state, bool complete, skein_error *error) {
    video *v = state;
    skein_status status = v->stream ? film_stream_close(v->stream, complete, error) : SKEIN_OK;
    sws_freeContext(v->scale);
    av_frame_free(&v->frame);
    free(v);
    return status;
}

static bool make_frame(video *v, int width, int height) {
    v->scale = sws_getContext(width, height, AV_PIX_FMT_RGB24, width, height, AV_PIX_FMT_YUV420P,
                              SWS_BICUBIC | SWS_ACCURATE_RND, NULL, NULL, NULL);
    v->frame = av_frame_alloc();
    if (!v->scale || !v->frame) return false;
    const int *colours = sws_getCoefficients(SWS_CS_ITU709);
    if (sws_setColorspaceDetails(v->scale, colours, 1, colours, 0, 0, 1 << 16, 1 << 16) < 0) return false;
    v->frame->width = width;
    v->frame->height = height;
    v->frame->format = AV_PIX_FMT_YUV420P;
    return av_frame_get_buffer(v->frame, 0) >= 0;
}

static void *begin(const film_job *job, skein_error *error) {
    video *v = calloc(1, sizeof *v);
    if (!v || !make_frame(v, job->options.size[0], job->options.size[1])) {
        render_fail_memory(error, "the film");
        if (v) end(v, false, NULL);
        return NULL;
    }
    setenv("SVT_LOG", "1", 0); // or that encoder tells its life on standard error
    v->stream = film_stream_open(job, job->encoder, AV_PIX_FMT_YUV420P, prepare,
                                 strcmp(job->format->ending, ".mp4") ? webm_options : mp4_options, error);
    if (v->stream) return v;
    end(v, false, NULL);
    return NULL;
}

static skein_status add(void *state, const render_image *image, skein_error *error) {
    video *v = state;
    const uint8_t *const rows[1] = {image->pixels};
    const int stride[1] = {3 * image->width};
    if (av_frame_make_writable(v->frame) < 0) return render_fail_memory(error, "a picture of the film");
    sws_scale(v->scale, rows, stride, 0, image->height, v->frame->data, v->frame->linesize);
    return film_stream_write(v->stream, v->frame, error);
}

const film_maker film_video = {begin, add, end};
