/* sensor/commands/record_command.c: `pitviper record`: writes datagrams from the receive queue to a file, and how
 * that ends. */
#include "sensor/commands/commands.h"

#include "dis/capture/recorder.h"
#include "dis/network/udp.h"
#include "sensor/settings/command_line.h"
#include "sensor/commands/overwrite.h"
#include "sensor/node/run/stop.h"

#include <stdio.h>

typedef struct Options {
    const char  *out;
    double       for_s; /* INFINITY: until stopped */
    long long    count; /* -1: any number */
    bool         overwrite;
    DisUdpConfig udp;
} Options;

static const char help[] =
    "usage: pitviper record -o LOG [options]\n"
    "\n"
    "Records the DIS datagrams received, with the times of arrival, until Ctrl-C. LOG is a pcapng file (pcap if the\n"
    "name ends in .pcap) that `pitviper replay`, `pitviper inspect`, Wireshark and tshark read.\n"
    "\n"
    "  -o, --out LOG      the recording\n"
    "  --overwrite        replace an existing LOG, once something is received; without it that is an error\n"
    "  --address A        receive on this address: a multicast group (joined, IPv4 or IPv6) or an address of this\n"
    "                     machine; default: all IPv4 addresses, and broadcast\n"
    "  --interface NAME   receive on this network interface only, such as eth0; default: all\n"
    "  --port N           default: 3000\n"
    "  --for S            stop after S seconds\n"
    "  --count N          stop after N datagrams\n";

/* ---- command line ----------------------------------------------------------------------------------- */

static bool copy_text(char *out, size_t out_size, const char *name, const char *text)
{
    if (text[0] && strlen(text) < out_size) {
        strcpy(out, text);
        return true;
    }
    log_error("record: --%s: '%s' is not 1 .. %zu characters", name, text, out_size - 1);
    return false;
}

/* Returns 0 to go on; else the program exits with this code - 1. */
static int parse(Options *o, int argc, char **argv)
{
    enum { OUT = 'o', HELP = 'h', ADDRESS = 256, INTERFACE, PORT, FOR, COUNT, OVERWRITE };
    static const struct option options[] = {{"out", 1, NULL, OUT},
                                            {"address", 1, NULL, ADDRESS},
                                            {"interface", 1, NULL, INTERFACE},
                                            {"port", 1, NULL, PORT},
                                            {"for", 1, NULL, FOR},
                                            {"count", 1, NULL, COUNT},
                                            {"overwrite", 0, NULL, OVERWRITE},
                                            {"help", 0, NULL, HELP},
                                            {NULL, 0, NULL, 0}};
    optind = 0; /* restart getopt */
    for (int option; (option = command_line_option(argc, argv, "o:h", options)) != -1;) {
        long long number;
        bool      ok = true;
        switch (option) {
        case OUT:
            o->out = optarg;
            break;
        case ADDRESS:
            ok = copy_text(o->udp.address, sizeof o->udp.address, "address", optarg);
            break;
        case INTERFACE:
            ok = copy_text(o->udp.interface, sizeof o->udp.interface, "interface", optarg);
            break;
        case PORT:
            ok = text_to_long(&number, optarg) && number >= 1 && number <= 65535;
            if (ok) o->udp.port = (int)number;
            else log_error("record: --port: '%s' is not a whole number in 1 .. 65535", optarg);
            break;
        case FOR:
            ok = text_to_double(&o->for_s, optarg) && o->for_s > 0 && o->for_s <= 1e9;
            if (!ok) log_error("record: --for: '%s' is not a number of seconds above 0, up to 1e9", optarg);
            break;
        case COUNT:
            ok = text_to_long(&o->count, optarg) && o->count >= 1;
            if (!ok) log_error("record: --count: '%s' is not a whole number from 1 on", optarg);
            break;
        case OVERWRITE:
            o->overwrite = true;
            break;
        case HELP:
            fputs(help, stdout);
            return 1;
        default:
            return 1 + 2; /* reported by command_line_option */
        }
        if (!ok) return 1 + 2;
    }
    if (optind < argc) return 1 + command_line_wrong("record", "'%s': the log's name follows -o", argv[optind]);
    if (!o->out) return 1 + command_line_wrong("record", "no LOG is named: usage: pitviper record -o LOG [options]");
    if (!dis_recorder_name("record: -o", o->out)) return 1 + 2;
    return 0;
}

/* ---- recording --------------------------------------------------------------------------------------- */

typedef struct Recording {
    DisUdp      *udp;
    DisRecorder *recorder;
    long long    left; /* datagrams left to record; -1: any number */
    uint64_t     datagrams, octets;
    double       begun_s, shown_s, flushed_s; /* wall clock */
    uint64_t     shown;
} Recording;

enum { turn = 4096 }; /* datagrams between two checks of the clock and the signals */

/* Records queued datagrams that arrived until until_ns, at most one batch. *more: there may be some left. */
static Status write_waiting(Recording *r, int64_t until_ns, bool *more)
{
    DisArrival a;
    for (int i = 0; i < turn; i++) {
        *more = r->left != 0 && dis_udp_take(&a, r->udp, until_ns);
        if (!*more) return STATUS_OK;
        const Status status = dis_recorder_add(r->recorder, a.capture_ns, a.from, a.from_port, a.bytes, a.octets);
        if (status != STATUS_OK) return status;
        r->datagrams++;
        r->octets += a.octets;
        if (r->left > 0) r->left--;
    }
    return STATUS_OK;
}

static uint64_t lost(const DisUdpCounters *counters) { return counters->lost_kernel + counters->lost_queue; }

static void show_progress(Recording *r, double now_s)
{
    const DisUdpCounters counters = dis_udp_counters(r->udp);
    char                 text[160];
    snprintf(text, sizeof text, "%llu datagrams  %.0f /s  %llu lost  %.0f s%s", (unsigned long long)r->datagrams,
             (double)(r->datagrams - r->shown) / (now_s - r->shown_s), (unsigned long long)lost(&counters),
             now_s - r->begun_s, counters.away ? "  the network is gone" : "");
    log_status(text);
    r->shown = r->datagrams;
    r->shown_s = now_s;
}

/* Records until stopped by a signal or an option; then the datagrams that had arrived by that moment, and no more. */
static Status record(Recording *r, double for_s)
{
    const int64_t check_ns = 100000000; /* a signal does not end a wait */
    const double  flush_s = 0.5, show_s = 1;
    const double  end_s = r->begun_s + for_s;
    Status        status = STATUS_OK;
    bool          more = false;
    while (status == STATUS_OK && !stop_asked() && r->left != 0) {
        const double now_s = wall_clock_s();
        if (now_s >= end_s) break;
        if (now_s - r->shown_s >= show_s) show_progress(r, now_s);
        if (now_s - r->flushed_s >= flush_s) {
            status = dis_recorder_flush(r->recorder);
            r->flushed_s = now_s;
            if (status != STATUS_OK) break;
        }
        const int64_t wait_ns = (int64_t)(1e9 * fmin(1e-9 * (double)check_ns, end_s - now_s));
        if (more || dis_udp_wait(r->udp, dis_udp_now_ns() + wait_ns)) status = write_waiting(r, INT64_MAX, &more);
    }
    log_status(NULL);

    const int64_t last_ns = dis_udp_now_ns();
    if (r->left != 0) dis_udp_close_tick(r->udp, last_ns);
    for (more = true; status == STATUS_OK && more;) status = write_waiting(r, last_ns, &more);
    return status;
}

int record_command(int argc, char **argv)
{
    Options   o = {.for_s = INFINITY, .count = -1, .udp = dis_udp_default_config()};
    Recording r = {.left = -1};
    char      where[dis_udp_where_size], comment[dis_udp_where_size + 40];
    uint8_t   to[16];

    const int stop = parse(&o, argc, argv);
    if (stop) return stop - 1;
    stop_by_signals();
    /* The socket first: if it failed with the file open, an older recording would be lost for nothing. Datagrams
     * that arrive until the file is open are queued. */
    if (dis_udp_open(&r.udp, &o.udp) != STATUS_OK) return 1;
    dis_udp_where(where, &o.udp);
    snprintf(comment, sizeof comment, "pitviper record: %s", where);
    if (overwrite_file("record", o.out, o.overwrite) != STATUS_OK ||
        dis_recorder_open(&r.recorder, o.out, comment) != STATUS_OK) {
        dis_udp_close(r.udp);
        return 1;
    }
    dis_udp_destination(to, r.udp);
    dis_recorder_to(r.recorder, to, (uint16_t)o.udp.port);
    log_info("record: listening on %s, into %s; Ctrl-C ends it", where, o.out);

    r.begun_s = r.shown_s = r.flushed_s = wall_clock_s();
    r.left = o.count;
    Status               status = record(&r, o.for_s);
    const double         spent_s = wall_clock_s() - r.begun_s;
    const DisUdpCounters counters = dis_udp_counters(r.udp);
    dis_udp_close(r.udp);
    const bool begun = dis_recorder_begun(r.recorder);
    if (dis_recorder_close(r.recorder) != STATUS_OK) status = STATUS_IO;
    log_info("record: %s: %llu datagrams, %llu octets in %.1f s; lost %llu", o.out, (unsigned long long)r.datagrams,
             (unsigned long long)r.octets, spent_s, (unsigned long long)lost(&counters));
    if (!begun) log_warn("record: nothing came: %s is the earlier recording, as it was", o.out);
    if (r.datagrams == 0)
        log_warn("record: nothing came on %s; --port, --address and --interface say where to listen, `ss -ulpn` and "
                 "`ip address` show what there is",
                 where);
    if (lost(&counters))
        log_warn("record: this machine was too slow for some: lost in the kernel %llu, in the queue %llu; a larger "
                 "net.core.rmem_max or a faster disk helps",
                 (unsigned long long)counters.lost_kernel, (unsigned long long)counters.lost_queue);
    return status == STATUS_OK ? 0 : 1;
}
