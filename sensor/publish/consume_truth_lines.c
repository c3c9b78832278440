/* sensor/publish/consume_truth_lines.c: the consumer that writes truth.jsonl. */
#include "sensor/publish/consumers.h"

#include <errno.h>
#include <stdlib.h>

typedef struct TruthLines {
    Consumer consumer;
    FILE    *file;
    bool     patient;
    RetryBackoff patience;
    int     *failed;
} TruthLines;

static Status put(Consumer *consumer, Frame *frame)
{
    TruthLines *t      = (TruthLines *)consumer;
    FrameRecord record = frame->record;
    Status      status = frame_sha256(&frame->seen);
    if (status != STATUS_OK) return status;
    record.frame_sha256 = frame->seen.sha256;
    if (!t->patient) return record_write_frame(t->file, &record);

    const bool due = retry_due(&t->patience);
    if (due) status = record_write_frame(t->file, &record);
    retry_done(&t->patience, due, due ? status : STATUS_IO);
    clearerr(t->file);
    return status == STATUS_IO ? STATUS_OK : status;
}

static Status close_lines(Consumer *consumer)
{
    TruthLines *t      = (TruthLines *)consumer;
    Status      status = STATUS_OK;
    if (t->failed) *t->failed = t->patience.lacking;
    if (t->file && fclose(t->file) != 0) {
        log_error("session: cannot write truth.jsonl: %s", strerror(errno));
        status = STATUS_IO;
    }
    free(t);
    return status;
}

Status consume_truth_lines(Consumer **out, const char *folder, bool patient, int *failed)
{
    char        path[frame_path_size];
    TruthLines *t = calloc(1, sizeof *t);
    if (!t) return STATUS_NO_MEMORY;
    *t = (TruthLines){.consumer = {WANT_TARGETS | WANT_ERROR | WANT_SHA256, put, NULL, close_lines, "truth_lines"}, .patient = patient,
                      .patience = {.what = "lines in truth.jsonl"}, .failed = failed};
    const bool fits = snprintf(path, sizeof path, "%s/truth.jsonl", folder) < (int)sizeof path;
    if (!fits) errno = ENAMETOOLONG;
    t->file = fits ? fopen(path, "w") : NULL;
    if (t->file) {
        *out = &t->consumer;
        return STATUS_OK;
    }
    log_error("session: cannot write %s: %s; choose another place with --out", path, strerror(errno));
    free(t);
    return STATUS_IO;
}
