/* Encoder, muxer and file; see stream.h. */
#include "film/stream.h"

#include <errno.h>
#include <fcntl.h>
#include <libavutil/opt.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "render/fail.h"

enum { BUFFER_SIZE = 1 << 16 };

/* ---- words ---- */

static pthread_mutex_t words_lock = PTHREAD_MUTEX_INITIALIZER;
static char words[160]; /* libav's last complaint: its codes alone say little */

static void keep_words(void *context, int level, const char *format, va_list arguments) {
    (void)context;
    if (level > AV_LOG_ERROR) return;
    pthread_mutex_lock(&words_lock);
    vsnprintf(words, sizeof words, format, arguments);
    words[strcspn(words, "\n")] = 0;
    pthread_mutex_unlock(&words_lock);
}

static void listen_to_libav(void) {
    av_log_set_callback(keep_words);
}

skein_status film_fail_av(skein_error *error, const char *where, const char *what, int code) {
    char text[AV_ERROR_MAX_STRING_SIZE];
    av_make_error_string(text, sizeof text, code);
    pthread_mutex_lock(&words_lock);
    render_fail(error, code == AVERROR(ENOMEM) ? SKEIN_ERROR_MEMORY : SKEIN_ERROR_VALUE, where, "%s: %s%s%s%s", what,
                text, words[0] ? " (" : "", words, words[0] ? ")" : "");
    words[0] = 0;
    pthread_mutex_unlock(&words_lock);
    return SKEIN_ERROR_VALUE;
}

skein_status film_fail_file(skein_error *error, const char *path, int reason) {
    const char *text = reason == ENOENT   ? "its directory does not exist, create it first"
                       : reason == EISDIR ? "it is a directory, name a file in it"
                       : reason == ENOSPC ? "the disk is full, make room or write elsewhere"
                       : reason == EFBIG  ? "it grew over the limit for a file's size"
                       : reason == EACCES ? "no permission, write elsewhere"
                                          : strerror(reason);
    return render_fail(error, SKEIN_ERROR_FILE, path, "cannot write: %s", text);
}

/* ---- the file ---- */

static int write_bytes(void *user, uint8_t *bytes, int size) {
    film_stream *s = user;
    for (int done = 0; done < size && !s->fault;) {
        ssize_t written = write(s->file, bytes + done, (size_t)(size - done));
        if (written >= 0) done += (int)written;
        else if (errno != EINTR) s->fault = errno;
    }
    return s->fault ? AVERROR(s->fault) : size;
}

static int64_t seek_to(void *user, int64_t offset, int whence) {
    film_stream *s = user;
    if (whence & AVSEEK_SIZE) return AVERROR(ENOSYS);
    off_t at = lseek(s->file, offset, whence & ~AVSEEK_FORCE);
    return at < 0 ? AVERROR(errno) : at;
}

/* Emptied only here, when nothing else can fail any more. */
static skein_status open_file(film_stream *s, skein_error *error) {
    struct stat info;
    s->file = open(s->path, O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    if (s->file < 0 || fstat(s->file, &info)) return film_fail_file(error, s->path, errno);
    s->regular = S_ISREG(info.st_mode);
    if (s->regular && ftruncate(s->file, 0)) return film_fail_file(error, s->path, errno);
    uint8_t *buffer = av_malloc(BUFFER_SIZE);
    s->muxer->pb =
        buffer ? avio_alloc_context(buffer, BUFFER_SIZE, 1, s, NULL, write_bytes, s->regular ? seek_to : NULL) : NULL;
    if (s->muxer->pb) return SKEIN_OK;
    av_free(buffer);
    return render_fail_memory(error, "the film");
}

/* ---- opening ---- */

static skein_status open_encoder(film_stream *s, const film_job *job, const char *encoder, enum AVPixelFormat pixels,
                                 void (*prepare)(const film_job *, AVCodecContext *, AVDictionary **),
                                 skein_error *error) {
    const AVCodec *codec = avcodec_find_encoder_by_name(encoder);
    s->codec = avcodec_alloc_context3(codec);
    s->packet = av_packet_alloc();
    if (!codec || !s->codec || !s->packet) return render_fail_memory(error, "the encoder");
    AVRational rate = av_d2q(job->rate, 1000000);
    s->codec->width = job->options.size[0];
    s->codec->height = job->options.size[1];
    s->codec->pix_fmt = pixels;
    s->codec->framerate = rate;
    s->codec->time_base = av_inv_q(rate);
    s->codec->sample_aspect_ratio = (AVRational){1, 1};
    s->codec->thread_count = 0; // as many as there are processors
    if (s->muxer->oformat->flags & AVFMT_GLOBALHEADER) s->codec->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    AVDictionary *options = NULL;
    prepare(job, s->codec, &options);
    int code = avcodec_open2(s->codec, codec, &options);
    av_dict_free(&options);
    return code < 0 ? film_fail_av(error, encoder, "the encoder cannot make such a film", code) : SKEIN_OK;
}

static skein_status open_muxer(film_stream *s, const char *options, skein_error *error) {
    AVDictionary *dictionary = NULL;
    s->stream = avformat_new_stream(s->muxer, NULL);
    if (!s->stream || avcodec_parameters_from_context(s->stream->codecpar, s->codec) < 0 ||
        av_dict_parse_string(&dictionary, options, "=", ":", 0) < 0) {
        av_dict_free(&dictionary);
        return render_fail_memory(error, "the film");
    }
    s->stream->time_base = s->codec->time_base;
    s->stream->avg_frame_rate = s->stream->r_frame_rate = s->codec->framerate;
    s->muxer->flags |= AVFMT_FLAG_FLUSH_PACKETS;
    skein_status status = open_file(s, error);
    if (status != SKEIN_OK) {
        av_dict_free(&dictionary);
        return status;
    }
    int code = avformat_write_header(s->muxer, &dictionary);
    av_dict_free(&dictionary);
    s->header_begun = code >= 0;
    if (s->fault) return film_fail_file(error, s->path, s->fault);
    return code < 0 ? film_fail_av(error, s->path, "the film cannot be begun", code) : SKEIN_OK;
}

film_stream *film_stream_open(const film_job *job, const char *encoder, enum AVPixelFormat pixels,
                              void (*prepare)(const film_job *, AVCodecContext *, AVDictionary **),
                              const char *muxer_options, skein_error *error) {
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, listen_to_libav);
    film_stream *s = calloc(1, sizeof *s);
    if (s) s->file = -1;
    if (!s || !(s->path = strdup(job->path)) ||
        avformat_alloc_output_context2(&s->muxer, NULL, job->format->ending + 1, NULL) < 0) {
        if (s) film_stream_close(s, false, NULL);
        render_fail_memory(error, "the film");
        return NULL;
    }
    skein_status status = open_encoder(s, job, encoder, pixels, prepare, error);
    if (status == SKEIN_OK) status = open_muxer(s, muxer_options, error);
    if (status == SKEIN_OK) return s;
    film_stream_close(s, false, NULL);
    return NULL;
}

/* ---- pictures ---- */

static skein_status mux_packets(film_stream *s, skein_error *error) {
    int code;
    while ((code = avcodec_receive_packet(s->codec, s->packet)) >= 0) {
        av_packet_rescale_ts(s->packet, s->codec->time_base, s->stream->time_base);
        s->packet->stream_index = s->stream->index;
        code = av_write_frame(s->muxer, s->packet);
        av_packet_unref(s->packet);
        if (s->fault) return film_fail_file(error, s->path, s->fault);
        if (code < 0) return film_fail_av(error, s->path, "the film cannot go on", code);
    }
    return code == AVERROR(EAGAIN) || code == AVERROR_EOF
               ? SKEIN_OK
               : film_fail_av(error, s->codec->codec->name, "the encoder failed", code);
}

skein_status film_stream_write(film_stream *s, AVFrame *frame, skein_error *error) {
    if (frame) frame->pts = s->pictures++;
    int code = avcodec_send_frame(s->codec, frame);
    if (code < 0) return film_fail_av(error, s->codec->codec->name, "the encoder failed", code);
    return mux_packets(s, error);
}

/* ---- closing ---- */

static skein_status finish(film_stream *s, skein_error *error) {
    if (s->fault) return film_fail_file(error, s->path, s->fault);
    skein_status status = film_stream_write(s, NULL, error);
    int code = av_write_trailer(s->muxer);
    avio_flush(s->muxer->pb);
    if (status != SKEIN_OK) return status;
    if (s->fault) return film_fail_file(error, s->path, s->fault);
    return code < 0 ? film_fail_av(error, s->path, "the film cannot be completed", code) : SKEIN_OK;
}

/* A film that could not be completed: what there is of it plays, but not under the name that was asked for. A GIF of
 * which the end is missing is none. */
static void put_aside(const film_stream *s) {
    const char *ending = strrchr(s->path, '.');
    size_t size = strlen(s->path) + sizeof ".failed";
    char *path = ending && strcmp(ending, ".gif") && s->pictures > 0 ? malloc(size) : NULL;
    if (path) snprintf(path, size, "%.*s.failed%s", (int)(ending - s->path), s->path, ending);
    if (!path || rename(s->path, path)) unlink(s->path);
    free(path);
}

skein_status film_stream_close(film_stream *s, bool complete, skein_error *error) {
    skein_status status = complete && s->header_begun ? finish(s, error) : SKEIN_OK;
    if (s->muxer && s->muxer->pb) {
        av_freep(&s->muxer->pb->buffer);
        avio_context_free(&s->muxer->pb);
    }
    avformat_free_context(s->muxer);
    avcodec_free_context(&s->codec);
    av_packet_free(&s->packet);
    // some file systems report a full disk only here
    if (s->file >= 0 && close(s->file) && complete && status == SKEIN_OK)
        status = film_fail_file(error, s->path, errno);
    if (s->file >= 0 && s->regular && !complete) unlink(s->path);
    else if (s->file >= 0 && s->regular && status != SKEIN_OK) put_aside(s);
    free(s->path);
    free(s);
    return status;
}
