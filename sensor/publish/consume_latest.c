/* sensor/publish/consume_latest.c: the consumer that keeps the newest display of each band as a file. */
#include "sensor/publish/consumers.h"

#include "sensor/publish/image_file.h"

#include <stdio.h>
#include <stdlib.h>

typedef struct Latest {
    Consumer     consumer;
    char         folder[frame_path_size];
    bool         patient;
    RetryBackoff retry;
    uint8_t     *shown; /* [capacity] */
    size_t       capacity;
} Latest;

/* A reader finds the earlier image or this one, never a part. */
static Status write_band(Latest *l, const Frame *frame, int band)
{
    const FrameDisplay *d     = &frame->display[band];
    const Picture      *p     = &frame->seen.picture;
    const size_t        count = (size_t)p->width * (size_t)p->height, octets = count * (size_t)d->planes;
    char                path[frame_path_size + 32];
    if (d->planes == 0) return STATUS_OK;
    if (octets > l->capacity) {
        uint8_t *larger = realloc(l->shown, octets);
        if (!larger) return STATUS_NO_MEMORY;
        l->shown    = larger;
        l->capacity = octets;
    }
    snprintf(path, sizeof path, "%s/%s.png", l->folder, band_name((Band)band));
    frame_display_quantise(l->shown, d, count, 8);
    return image_write_png(path, l->shown, p->width, p->height, d->planes, 8);
}

static Status put(Consumer *consumer, Frame *frame)
{
    Latest    *l      = (Latest *)consumer;
    const bool due    = !l->patient || retry_due(&l->retry);
    Status     status = due ? STATUS_OK : STATUS_IO;
    for (int b = 0; b < BAND_COUNT && status == STATUS_OK; b++) status = write_band(l, frame, b);
    if (l->patient) retry_done(&l->retry, due, status);
    return status;
}

static Status close_latest(Consumer *consumer)
{
    Latest *l = (Latest *)consumer;
    free(l->shown);
    free(l);
    return STATUS_OK;
}

static Status begin(Consumer *consumer) { return frame_files_folder(((Latest *)consumer)->folder); }

Status consume_latest(Consumer **out, const char *folder, bool patient)
{
    Latest *l = calloc(1, sizeof *l);
    if (!l) return STATUS_NO_MEMORY;
    *l = (Latest){.consumer = {WANT_DISPLAY, put, NULL, close_latest, "latest", begin}, .patient = patient,
                  .retry = {.what = "latest pictures"}};
    snprintf(l->folder, sizeof l->folder, "%.*s/latest", frame_path_size - frame_path_room, folder);
    *out = &l->consumer;
    return STATUS_OK;
}
