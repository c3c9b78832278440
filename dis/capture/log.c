/* dis/capture/log.c: from a capture file to a log: which packets are read, which port, and what is reported of the
 * rest; and the octets of a large log, which stay on disk: windows of them are in memory, the least recently used is
 * read anew. */

#include "dis/capture/log_private.h"
#include "pitviper_file.h"

#include <errno.h>
#include <fcntl.h>
#include <pcap/pcap.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

/* Senders whose clocks differ are read in the order of their stamps, which lies a little off the order in the file; the
 * windows must hold both. */
enum { stride = 1 << 18, window_octets = stride + dis_log_file_most, windows = 16, buffer_octets = 1 << 18 };

static const uint64_t in_scratch = (uint64_t)1 << 63;

typedef struct Window {
    uint64_t block; /* number of the block of `stride` octets that it holds, with in_scratch; UINT64_MAX: none */
    size_t   count;
    uint64_t used;  /* number of the last use, by which the least recently used window is found */
    uint8_t *octet; /* [window_octets] */
} Window;

struct DisLogFile {
    int      file, scratch; /* descriptors of the file and of the scratch file; -1: not open */
    char    *path;
    uint64_t written, uses;
    size_t   waiting; /* octets in the buffer that are not written yet */
    uint8_t *buffer;  /* [buffer_octets] */
    bool     failed;
    Window   window[windows];
};

static void log_file_destroy(DisLogFile *f)
{
    if (!f) return;
    if (f->file >= 0) close(f->file);
    if (f->scratch >= 0) close(f->scratch);
    for (int w = 0; w < windows; w++) free(f->window[w].octet);
    free(f->buffer);
    free(f->path);
    free(f);
}

/* file: descriptor of the log, which is duplicated. path: for messages. */
static Status log_file_create(DisLogFile **out, int file, const char *path)
{
    DisLogFile *f = calloc(1, sizeof *f);
    if (!f) return STATUS_NO_MEMORY;
    f->scratch = -1;
    f->file = fcntl(file, F_DUPFD_CLOEXEC, 0);
    f->path = strdup(path);
    for (int w = 0; w < windows; w++) f->window[w].block = UINT64_MAX;
    if (f->file < 0 || !f->path) {
        log_file_destroy(f);
        return STATUS_NO_MEMORY;
    }
    *out = f;
    return STATUS_OK;
}

/* ---- the scratch file ---------------------------------------------------------------------------------- */

static Status scratch_failed(const DisLogFile *f)
{
    log_error(
        "log: %s: its datagrams cannot be kept in a scratch file: %s; set TMPDIR to a folder with room for the log "
        "expanded, or expand it with its own program first",
        f->path, strerror(errno));
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
    Window *w =
        (at & in_scratch) == 0 || f->waiting == 0 || flush_scratch(f) == STATUS_OK ? window_of(f, at - within) : NULL;
    if (w) w->used = ++f->uses;
    if (w && within + octets <= w->count) return w->octet + within;
    if (!f->failed)
        log_error("log: %s cannot be read any more: %s", f->path, errno ? strerror(errno) : "it was cut meanwhile");
    f->failed = true;
    return NULL;
}

static bool log_file_failed(const DisLogFile *f) { return f && f->failed; }

/* ---- from the capture to the log ------------------------------------------------------------ */

enum { foreign_links_reported = 8 };

typedef struct Scan {
    DisLog          *log;
    DisPacketReader *reader;
    int              foreign_links; /* number of link layers that are not read; the first of them are listed */
    struct {
        int      link;
        uint64_t packets;
    } foreign[foreign_links_reported];
} Scan;

static void name_link(char out[32], int link)
{
    const char *name = pcap_datalink_val_to_name(link);
    snprintf(out, 32, "%s (%d)", name ? name : "unknown", link);
}

/* Notes a packet whose link layer is not read; each such link layer is reported once. */
static void skip_packet(Scan *scan, int link)
{
    scan->log->counters.other_link++;
    int i = 0;
    while (i < scan->foreign_links && scan->foreign[i].link != link) i++;
    if (i == foreign_links_reported) return;
    if (i == scan->foreign_links) scan->foreign[scan->foreign_links++].link = link;
    scan->foreign[i].packets++;
}

static void report_skipped(const Scan *scan, const char *path)
{
    char name[32];
    for (int i = 0; i < scan->foreign_links; i++) {
        name_link(name, scan->foreign[i].link);
        log_warn("log: %s: %llu packets of an interface with link layer %s are left out: this program does not read it",
                 path, (unsigned long long)scan->foreign[i].packets, name);
    }
}

/* A file without a readable interface is rejected by link layer; a file without packets by its interface records. */
static bool nothing_readable(int *link, const Scan *scan, const DisCapture *capture)
{
    const DisLogCounters *counters = &scan->log->counters;
    if (counters->packets > counters->other_link) return false;
    if (counters->packets > 0) {
        *link = scan->foreign[0].link;
        return true;
    }
    *link = dis_capture_link(capture, 0);
    for (int i = 0; dis_capture_link(capture, i) >= 0; i++)
        if (dis_packet_reads(dis_capture_link(capture, i))) return false;
    return *link >= 0;
}

static Status scan_capture(Scan *scan, DisCapture *capture, const char *path)
{
    DisCapturePacket packet;
    while (dis_capture_next(&packet, capture)) {
        scan->log->counters.packets++;
        Status read = STATUS_OK;
        if (dis_packet_reads(packet.link)) read = dis_packet_read(scan->reader, &packet);
        else skip_packet(scan, packet.link);
        if (read == STATUS_IO) return read; /* the scratch file failed, which was logged */
        if (read != STATUS_OK) {
            log_error("log: %s: out of memory after %d datagrams", path, scan->log->count);
            return read;
        }
    }
    const char  *problem = dis_capture_problem(capture);
    const Status status = dis_capture_status(capture);
    if (status != STATUS_OK) {
        log_error("log: cannot use %s: after packet %llu: %s", path, (unsigned long long)scan->log->counters.packets,
                  problem);
        return status;
    }
    int link;
    if (nothing_readable(&link, scan, capture)) {
        char name[32];
        name_link(name, link);
        log_error("log: %s was captured on a link layer this program does not read: %s; it reads Ethernet, Linux "
                  "cooked v1 and v2, BSD loopback and raw IP",
                  path, name);
        return STATUS_UNSUPPORTED;
    }
    report_skipped(scan, path);
    if (problem) {
        scan->log->truncated = true;
        log_warn("log: %s ends early after packet %llu: %s; what came before is used", path,
                 (unsigned long long)scan->log->counters.packets, problem);
    }
    scan->log->any_port = dis_packet_reader_end(scan->reader);
    return STATUS_OK;
}

Status dis_log_open_read(DisLog *out, const char *path, int port, DisLogRead *read, void *user)
{
    DisCapture *capture = NULL;
    if (port < dis_port_default || port > UINT16_MAX) return STATUS_BAD_VALUE;
    Status status = dis_capture_open_tapped(&capture, path, read, user);
    if (status != STATUS_OK) return status;

    DisLog log = {0};
    Scan   scan = {.log = &log};
    log.storage = arena_create();
    status = log.storage ? log_file_create(&log.file, dis_capture_file(capture), path) : STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = dis_packet_reader_create(&scan.reader, &log, log.storage, port);
    if (status == STATUS_OK) status = scan_capture(&scan, capture, path);
    if (status == STATUS_OK) {
        dis_capture_drain(capture);
        const size_t octets = strlen(dis_capture_notes(capture)) + 1;
        char        *notes = arena_alloc(log.storage, octets, 1);
        if (notes) memcpy(notes, dis_capture_notes(capture), octets);
        else status = STATUS_NO_MEMORY;
        log.notes = notes;
    }
    dis_packet_reader_destroy(scan.reader);
    dis_capture_close(capture);
    if (status != STATUS_OK) {
        dis_log_close(&log);
        return status;
    }
    log.any_port |= port == dis_port_any;
    log.retimed = dis_log_retime(&log);
    if (dis_log_failed(&log)) {
        dis_log_close(&log);
        return STATUS_IO;
    }
    *out = log;
    return STATUS_OK;
}

Status dis_log_open(DisLog *out, const char *path, int port) { return dis_log_open_read(out, path, port, NULL, NULL); }

DisDatagram dis_log_datagram(const DisLog *log, int i)
{
    DisDatagram d = log->datagram[i];
    if (!(d.packet & dis_datagram_on_disk)) return d;
    const uint8_t *bytes = dis_log_file_octets(log->file, d.at, d.octets);
    d.packet &= ~dis_datagram_on_disk;
    d.bytes = bytes ? bytes : (const uint8_t *)"";
    if (!bytes) d.octets = 0;
    return d;
}

bool dis_log_failed(const DisLog *log) { return log_file_failed(log->file); }

void dis_log_close(DisLog *log)
{
    if (!log) return;
    free(log->datagram);
    log_file_destroy(log->file);
    arena_destroy(log->storage);
    *log = (DisLog){0};
}
