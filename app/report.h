/* What a run says at its end: report.json, and the same in a few lines on the terminal. */
#ifndef SKEIN_APP_REPORT_H
#define SKEIN_APP_REPORT_H

#include <jansson.h>

#include "app/command.h"
#include "app/log.h"
#include "app/verdict.h"

typedef struct app_report {
    app_scene *loaded;
    const app_arguments *arguments; /* as they were given */
    bool quiet, calm, json;         /* calm: without progress */
    bool is_file;                   /* one output is wanted, as a file, and no report beside it */
    app_verdict verdict;
    int frames, steps_per_frame;
    double dt, seconds; /* seconds: spent in steps */
    bool interrupted;
    skein_statistics statistics; /* of the end */
    double worst_stretch;        /* over the whole run, sampled now and then */
    double worst_over_limit;     /* the same of what edges stretch beyond their limit */
    bool counts_crossings;       /* in every frame: there is contact */
    size_t worst_crossings;      /* of one frame */
    int crossed_frames;          /* that had some */
    uint64_t crossed_noted;      /* the frame after the one that was last counted */
    char device[256];            /* where it was stepped */
    size_t device_bytes;         /* held there, where that is a graphics card */
    json_t *files;               /* their paths */
    json_t *flocks;              /* their order parameters over time */
    int flocks_noted;            /* the frame after the one that they were last noted at */
    app_log *log;                /* a line a step, or NULL */
    const char *log_path;
    const char *parts;              /* the folder where ranks write their own, or NULL */
    struct app_shared *shared;      /* what sharing it with other ranks has cost, or NULL */
    struct app_good *good;          /* what a blow-up is looked into from, or NULL */
    struct app_keep *keep;          /* what --resume goes on from, or NULL */
    char failure[APP_FAILURE_SIZE]; /* why it failed, or "" */
} app_report;

/* Writes FOLDER/report.json (of a run that failed, report.failed.json) and adds it to the files. False after a printed
 * fault. */
bool app_report_write(app_report *report, const char *folder);
/* The same to standard output. False where there is no memory, after it was said. */
bool app_report_print_json(const app_report *report);
/* A few lines. */
void app_report_print(const app_report *report);

#endif
