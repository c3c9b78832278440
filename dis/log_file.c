/* dis/log_file.c: windows of a large log's octets, the least recently used is read anew. */
#include "dis/log_file.h"

#include "pitviper_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

/* Senders whose clocks differ are read in the order of their stamps, each a little off in the file. */
enum { stride = 1 << 18, window_octets = stride + dis_log_file_most, windows = 16, buffer_octets = 1 << 18 };

static const uint64_t in_scratch = (uint64_t)1 << 63;

typedef struct Window {
    uint64_t block;   /* of stride octets; UINT64_MAX: none. With in_scratch */
    size_t   count;
    uint64_t used;    /* when last */
    uint8_t *octet;   /* [window_octets] */
} Window;

struct DisLogFile {
    int      file, scratch; /* -1: none */
    char    *path;
    uint64_t written, uses;
    size_t   waiting;       /* octets in the buffer, not written yet */
    uint8_t *buffer;        /* [buffer_octets] */
    bool     failed;
    Window   window[windows];
};

Status dis_log_file_create(DisLogFile **out, int file, const char *path)
{
    DisLogFile *f = calloc(1, sizeof *f);
    if (!f) return STATUS_NO_MEMORY;
    f->scratch = -1;
    f->file    = fcntl(file, F_DUPFD_CLOEXEC, 0);
    f->path    = strdup(path);
    for (int w = 0; w < windows; w++) f->window[w].block = UINT64_MAX;
    if (f->file < 0 || !f->path) {
        dis_log_file_destroy(f);
        return STATUS_NO_MEMORY;
    }
    *out = f;
    return STATUS_OK;
}

void dis_log_file_destroy(DisLogFile *f)
{
    if (!f) return;
    if (f->file >= 0) close(f->file);
    if (f->scratch >= 0) close(f->scratch);
    for (int w = 0; w < windows; w++) free(f->window[w].octet);
    free(f->buffer);
    free(f->path);
    free(f);
}

/* ---- the scratch file ---------------------------------------------------------------------------------- */

static Status scratch_failed(const DisLogFile *f)
{
    log_error("log: %s: its datagrams cannot be kept in a scratch file: %s; set TMPDIR to a folder with room for the log "
              "expanded, or expand it with its own program first", f->path, strerror(errno));
    return STATUS_IO;
}

static Status open_scratch(DisLogFile *f)
{
    char path[temp_path_size];
    f->buffer = malloc(buffer_octets);
    if (!f->buffer) return STATUS_NO_MEMORY;
    if (!temp_file(path, "")) return STATUS_IO;
    f->scratch = open(path, O_RDWR | O_CLOEXEC);
    unlink(path);
    return f->scratch >= 0 ? STATUS_OK : scratch_failed(f);
}

static Status flush_scratch(DisLogFile *f)
{
    for (size_t done = 0; done < f->waiting;) {
        const ssize_t now = write(f->scratch, f->buffer + done, f->waiting - done);
        if (now <= 0 && errno != EINTR) return scratch_failed(f);
        done += now > 0 ? (size_t)now : 0;
    }
    f->written += f->waiting;
    f->waiting = 0;
    return STATUS_OK;
}

Status dis_log_file_keep(uint64_t *at, DisLogFile *f, const uint8_t *bytes, size_t octets)
{
    Status status = f->scratch < 0 ? open_scratch(f) : STATUS_OK;
    if (status == STATUS_OK && f->waiting + octets > buffer_octets) status = flush_scratch(f);
    if (status != STATUS_OK) return status;
    *at = in_scratch | (f->written + f->waiting);
    memcpy(f->buffer + f->waiting, bytes, octets);
    f->waiting += octets;
    return STATUS_OK;
}

/* ---- windows ------------------------------------------------------------------------------------------- */

static Window *window_of(DisLogFile *f, uint64_t block)
{
    Window *oldest = &f->window[0];
    for (int w = 0; w < windows; w++) {
        if (f->window[w].block == block) return &f->window[w];
        if (f->window[w].used < oldest->used) oldest = &f->window[w];
    }
    oldest->block = UINT64_MAX;
    if (!oldest->octet) oldest->octet = malloc(window_octets);
    if (!oldest->octet) return NULL;
    const bool scratch = block & in_scratch;
    const long got = file_read_at(scratch ? f->scratch : f->file, oldest->octet, window_octets, block & ~in_scratch);
    if (got < 0) return NULL;
    oldest->block = block;
    oldest->count = (size_t)got;
    return oldest;
}

const uint8_t *dis_log_file_octets(DisLogFile *f, uint64_t at, size_t octets)
{
    const uint64_t within = (at & ~in_scratch) % stride;
    errno = 0;
    Window *w = (at & in_scratch) == 0 || f->waiting == 0 || flush_scratch(f) == STATUS_OK ? window_of(f, at - within) : NULL;
    if (w) w->used = ++f->uses;
    if (w && within + octets <= w->count) return w->octet + within;
    if (!f->failed)
        log_error("log: %s cannot be read any more: %s", f->path, errno ? strerror(errno) : "it was cut meanwhile");
    f->failed = true;
    return NULL;
}

bool dis_log_file_failed(const DisLogFile *f) { return f && f->failed; }
