/* One video stream in one file: libavcodec's encoder, libavformat's muxer, and the file itself.
 *
 * Used by video.c and gif.c. Invariant: all that was muxed is handed to the system at once, so that a
 * process that is killed loses only what it had not muxed yet. */
#ifndef SKEIN_FILM_STREAM_H
#define SKEIN_FILM_STREAM_H

#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>

#include "film/maker.h"

typedef struct film_stream {
    AVCodecContext *codec;
    AVFormatContext *muxer;
    AVStream *stream;
    AVPacket *packet;
    char *path;
    int file, fault;   /* fault: errno of the first failed write, or 0 */
    bool regular;      /* a file that may be removed, and in which one can go back */
    bool header_begun; /* so that a trailer is due */
    int64_t pictures;  /* sent to the encoder */
} film_stream;

/* Opens everything and writes the header; empties the file at `path`. `encoder` is libavcodec's name,
 * `prepare` sets what is special about it before it is opened (and leaves options for it). NULL on failure. */
film_stream *film_stream_open(const film_job *job, const char *encoder, enum AVPixelFormat pixels,
                              void (*prepare)(const film_job *job, AVCodecContext *codec, AVDictionary **options),
                              const char *muxer_options, skein_error *error);
/* Encodes the next picture; NULL lets out what the encoder holds back. */
skein_status film_stream_write(film_stream *s, AVFrame *frame, skein_error *error);
/* The trailer where `complete`; else the file is removed. Frees the stream. */
skein_status film_stream_close(film_stream *s, bool complete, skein_error *error);

/* A failure of libav's; `code` is its. */
skein_status film_fail_av(skein_error *error, const char *where, const char *what, int code);
/* A failure of the system's; `reason` is an errno. */
skein_status film_fail_file(skein_error *error, const char *path, int reason);

#endif
