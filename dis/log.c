/* dis/log.c: from a capture file to a log: which packets are read, which port, and what is reported of the rest. */
#include "dis/log.h"

#include "dis/log_file.h"
#include "dis/log_packet.h"
#include "dis/log_pcap.h"

#include <pcap/pcap.h>
#include <stdio.h>
#include <stdlib.h>

enum { foreign_links_reported = 8 };

typedef struct Scan {
    DisLog          *log;
    DisPacketReader *reader;
    int              foreign_links; /* link layers that are not read, the first of them */
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

/* One that is not read: remembered by its link layer, to be reported once. */
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
        if (dis_packet_reads(packet.link))
            read = dis_packet_read(scan->reader, &packet);
        else
            skip_packet(scan, packet.link);
        if (read == STATUS_IO) return read; /* of the scratch file; logged */
        if (read != STATUS_OK) {
            log_error("log: %s: out of memory after %d datagrams", path, scan->log->count);
            return read;
        }
    }
    const char  *problem = dis_capture_problem(capture);
    const Status status  = dis_capture_status(capture);
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
    status = log.storage ? dis_log_file_create(&log.file, dis_capture_file(capture), path) : STATUS_NO_MEMORY;
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

bool dis_log_failed(const DisLog *log) { return dis_log_file_failed(log->file); }

void dis_log_close(DisLog *log)
{
    if (!log) return;
    free(log->datagram);
    dis_log_file_destroy(log->file);
    arena_destroy(log->storage);
    *log = (DisLog){0};
}
