/* sensor/node/cigi/cigi_recorded.c: a CIGI host from a recording, and the notes of its time. */
#include "sensor/node/cigi/cigi_recorded.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

static const char begin[] = "pitviper: cigi ";

void cigi_time_note_text(char out[cigi_time_note_size], const CigiTimeNote *n)
{
    snprintf(out, cigi_time_note_size, "%sport %d time %a from datagram %" PRIu64, begin, n->port, n->offset_s,
             n->datagram);
}

static bool read_line(CigiTimeNote *out, const char *line)
{
    char         text[cigi_time_note_size], again[cigi_time_note_size];
    const size_t length = strcspn(line, "\n");
    CigiTimeNote n;
    if (length >= sizeof text || strncmp(line, begin, strlen(begin)) != 0) return false;
    memcpy(text, line, length);
    text[length] = 0;
    if (sscanf(text + strlen(begin), "port %d time %la from datagram %" SCNu64, &n.port, &n.offset_s, &n.datagram) != 3)
        return false;
    if (!(fabs(n.offset_s) < 1e9) || n.port < 1 || n.port > 65535 || n.datagram == 0) return false;
    cigi_time_note_text(again, &n);
    if (strcmp(text, again) != 0) return false;
    *out = n;
    return true;
}

bool cigi_time_note_next(CigiTimeNote *out, const char **at)
{
    while (*at && **at) {
        const bool good = read_line(out, *at);
        *at += strcspn(*at, "\n");
        *at += **at == '\n';
        if (good) return true;
    }
    return false;
}

struct CigiRecorded {
    DisLog       log;
    bool         open;
    int          next;
    const char  *notes; /* those that were not read yet */
    CigiTimeNote note;
    bool         waits; /* note does not hold yet */
    double       offset_s;
};

static bool readable_twice(const char *path)
{
    struct stat at;
    return stat(path, &at) == 0 && S_ISREG(at.st_mode);
}

static Status open_port(CigiRecorded *r, const char *path, int port)
{
    if (r->open) dis_log_close(&r->log);
    const Status status = dis_log_open(&r->log, path, port);
    r->open = status == STATUS_OK;
    r->notes = r->open ? r->log.notes : NULL;
    r->waits = r->open && cigi_time_note_next(&r->note, &r->notes);
    return status;
}

Status cigi_recorded_open(CigiRecorded **out, const char *path, int port)
{
    if (!readable_twice(path)) {
        log_error("cigi: %s: a CIGI host is replayed from a file, not from a pipe", path);
        return STATUS_BAD_VALUE;
    }
    CigiRecorded *r = calloc(1, sizeof *r);
    if (!r) return STATUS_NO_MEMORY;
    Status status = open_port(r, path, port);
    if (status == STATUS_OK && r->waits && r->note.port != port) status = open_port(r, path, r->note.port);
    if (status == STATUS_OK && (!r->waits || r->log.count == 0)) {
        log_error("cigi: %s holds no CIGI host: it is no recording of `run --cigi ... --record FILE.pcapng`", path);
        status = STATUS_BAD_VALUE;
    }
    if (status == STATUS_OK) *out = r;
    else cigi_recorded_close(r);
    return status;
}

void cigi_recorded_close(CigiRecorded *r)
{
    if (!r) return;
    if (r->open) dis_log_close(&r->log);
    free(r);
}

bool cigi_recorded_take(const uint8_t **datagram, size_t *octets, CigiRecorded *r)
{
    if (r->next == r->log.count) return false;
    const DisDatagram d = dis_log_datagram(&r->log, r->next++);
    *datagram = d.bytes;
    *octets = d.octets;
    return d.bytes != NULL;
}

double cigi_recorded_offset_s(CigiRecorded *r)
{
    while (r->waits && r->note.datagram <= (uint64_t)r->next) {
        r->offset_s = r->note.offset_s;
        r->waits = cigi_time_note_next(&r->note, &r->notes);
    }
    return r->offset_s;
}
