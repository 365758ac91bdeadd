/* Reading a film back with libav: how many pictures, of which size, when, and in which colours. */
#ifndef SKEIN_TEST_FILM_READER_H
#define SKEIN_TEST_FILM_READER_H

#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libswscale/swscale.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct film_seen {
    int pictures, width, height;
    int keys;          /* pictures that need no other */
    double start, end; /* s, when the first picture begins, and the last */
    double length;     /* s, as the file says; 0 where it does not */
    double rate;       /* pictures a second, as the file says */
    char codec[32];
    bool bt709;      /* all four marks: primaries, transfer, matrix, limited range */
    bool broken;     /* something could not be decoded */
    uint8_t *pixels; /* all pictures, sRGB, rows from the top; freed by film_seen_free */
} film_seen;

/* Adds a decoded frame, taking its colours as it says that they are. */
static inline bool film_seen_add(film_seen *seen, const AVFrame *frame, AVRational time_base) {
    size_t size = 3 * (size_t)frame->width * (size_t)frame->height;
    uint8_t *grown = realloc(seen->pixels, size * (size_t)(seen->pictures + 1));
    if (!grown || (seen->pictures && (frame->width != seen->width || frame->height != seen->height))) return false;
    seen->pixels = grown;
    seen->width = frame->width, seen->height = frame->height;
    struct SwsContext *scale =
        sws_getContext(frame->width, frame->height, (enum AVPixelFormat)frame->format, frame->width, frame->height,
                       AV_PIX_FMT_RGB24, SWS_BICUBIC | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INT, NULL, NULL, NULL);
    const int *matrix = sws_getCoefficients((int)frame->colorspace); // the same numbers as SWS_CS_...
    sws_setColorspaceDetails(scale, matrix, frame->color_range == AVCOL_RANGE_JPEG, matrix, 1, 0, 1 << 16, 1 << 16);
    uint8_t *rows[1] = {seen->pixels + size * (size_t)seen->pictures};
    int stride[1] = {3 * frame->width};
    sws_scale(scale, (const uint8_t *const *)frame->data, frame->linesize, 0, frame->height, rows, stride);
    sws_freeContext(scale);
    double now = (double)frame->best_effort_timestamp * av_q2d(time_base);
    if (!seen->pictures) seen->start = now;
    seen->end = now;
    seen->keys += frame->key_frame;
    seen->bt709 = frame->colorspace == AVCOL_SPC_BT709 && frame->color_primaries == AVCOL_PRI_BT709 &&
                  frame->color_trc == AVCOL_TRC_BT709 && frame->color_range == AVCOL_RANGE_MPEG;
    seen->pictures++;
    return true;
}

static inline void film_seen_decode(film_seen *seen, AVFormatContext *file, AVCodecContext *codec) {
    AVPacket *packet = av_packet_alloc();
    AVFrame *frame = av_frame_alloc();
    AVRational time_base = file->streams[0]->time_base;
    for (bool more = true; more;) {
        more = av_read_frame(file, packet) >= 0;
        if (avcodec_send_packet(codec, more ? packet : NULL) < 0) seen->broken = true;
        av_packet_unref(packet);
        while (avcodec_receive_frame(codec, frame) >= 0) {
            seen->broken |= !film_seen_add(seen, frame, time_base) || frame->decode_error_flags;
            av_frame_unref(frame);
        }
    }
    av_frame_free(&frame);
    av_packet_free(&packet);
}

/* Reads all of it; no pictures where it is no film. */
static inline film_seen film_see(const char *path) {
    film_seen seen = {0};
    AVFormatContext *file = NULL;
    av_log_set_level(AV_LOG_QUIET);
    if (avformat_open_input(&file, path, NULL, NULL) < 0) return seen;
    if (avformat_find_stream_info(file, NULL) >= 0 && file->nb_streams == 1) {
        const AVStream *stream = file->streams[0];
        const AVCodec *decoder = avcodec_find_decoder(stream->codecpar->codec_id);
        AVCodecContext *codec = avcodec_alloc_context3(decoder);
        snprintf(seen.codec, sizeof seen.codec, "%s", avcodec_get_name(stream->codecpar->codec_id));
        seen.rate = av_q2d(stream->avg_frame_rate);
        seen.length = file->duration > 0 ? (double)file->duration / AV_TIME_BASE : 0;
        avcodec_parameters_to_context(codec, stream->codecpar);
        if (avcodec_open2(codec, decoder, NULL) >= 0) film_seen_decode(&seen, file, codec);
        avcodec_free_context(&codec);
    }
    avformat_close_input(&file);
    return seen;
}

static inline void film_seen_free(film_seen *seen) {
    free(seen->pixels);
    *seen = (film_seen){0};
}

/* The three bytes of a pixel of a picture. */
static inline const uint8_t *film_seen_pixel(const film_seen *seen, int picture, int x, int y) {
    return seen->pixels + 3 * (((size_t)picture * (size_t)seen->height + (size_t)y) * (size_t)seen->width + (size_t)x);
}

#endif
