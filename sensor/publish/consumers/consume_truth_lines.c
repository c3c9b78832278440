/* sensor/publish/consumers/consume_truth_lines.c: the consumer that writes truth.jsonl.
 *
 * Where a latency ledger is kept, a line waits as text until all consumers are done with its frame, or two further
 * frames were put: at most three are held. */
#include "sensor/publish/consumers/consumers.h"
#include "pitviper_output.h"

#include <errno.h>
#include <stdlib.h>

enum { held_max = 3 };

typedef struct HeldLine {
    char    *text;
    uint64_t key;
} HeldLine;

typedef struct TruthLines {
    Consumer     consumer;
    char         path[frame_path_size];
    FILE        *file;
    bool         patient;
    RetryBackoff patience;
    int         *failed;
    Latency     *latency; /* of the frames; NULL: none is kept */
    int          held;
    HeldLine     line[held_max]; /* [held], the oldest first */
} TruthLines;

static Status write_line(TruthLines *t, const char *text, const LatencyLine *latency)
{
    if (!t->patient) return record_write_text(t->file, text, latency);
    Status     status = STATUS_OK;
    const bool due = retry_due(&t->patience);
    if (due) status = record_write_text(t->file, text, latency);
    retry_done(&t->patience, due, due ? status : STATUS_IO);
    clearerr(t->file);
    return status == STATUS_IO ? STATUS_OK : status;
}

static Status write_oldest(TruthLines *t)
{
    LatencyLine latency;
    latency_line(&latency, t->latency, t->line[0].key);
    const Status status = write_line(t, t->line[0].text, &latency);
    free(t->line[0].text);
    memmove(t->line, t->line + 1, (size_t)--t->held * sizeof *t->line);
    return status;
}

static Status put(Consumer *consumer, Frame *frame)
{
    TruthLines *t = (TruthLines *)consumer;
    FrameRecord record = frame->record;
    Status      status = frame_sha256(&frame->seen);
    if (status != STATUS_OK) return status;
    record.frame_sha256 = frame->seen.sha256;
    char *text = record_frame_text(&record);
    if (!text) return STATUS_NO_MEMORY;
    t->latency = frame->latency;
    if (!t->latency) {
        status = write_line(t, text, NULL);
        free(text);
        return status;
    }
    t->line[t->held++] = (HeldLine){text, frame->latency_key};
    while (status == STATUS_OK && t->held > 0 && (t->held == held_max || latency_complete(t->latency, t->line[0].key)))
        status = write_oldest(t);
    return status;
}

static Status close_lines(Consumer *consumer)
{
    TruthLines *t = (TruthLines *)consumer;
    Status      status = STATUS_OK;
    while (t->held > 0) {
        const Status one = write_oldest(t);
        if (status == STATUS_OK) status = one;
    }
    if (t->failed) *t->failed = t->patience.lacking;
    if (t->file && fclose(t->file) != 0) {
        log_error("session: cannot write truth.jsonl: %s", strerror(errno));
        status = STATUS_IO;
    }
    free(t);
    return status;
}

static Status begin(Consumer *consumer)
{
    TruthLines *t = (TruthLines *)consumer;
    t->file = output_file(t->path, 0);
    if (t->file) return STATUS_OK;
    log_error("session: cannot write %s: %s; choose another place with --out", t->path, output_reason(errno));
    return STATUS_IO;
}

Status consume_truth_lines(Consumer **out, const char *folder, bool patient, int *failed)
{
    TruthLines *t = calloc(1, sizeof *t);
    if (!t) return STATUS_NO_MEMORY;
    *t = (TruthLines){.consumer = {WANT_TARGETS | WANT_ERROR | WANT_SHA256 | WANT_LATENCY, put, NULL, close_lines,
                                   "truth_lines", begin},
                      .patient = patient,
                      .patience = {.what = "lines in truth.jsonl"},
                      .failed = failed};
    snprintf(t->path, sizeof t->path, "%.*s/truth.jsonl", frame_path_size - frame_path_room, folder);
    *out = &t->consumer;
    return STATUS_OK;
}
