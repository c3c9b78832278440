/* tests/bench/dis/network_sockets.c: datagrams over loopback at stated rates, how late they can be taken, and how fast
 * they are recorded.
 *
 * A thread sends a fixed number in each millisecond; received datagrams are compared octet by octet with the expected
 * ones by sequence number. It stops after the set time, whatever the network does. Sender and receiver share the
 * machine: beyond some rate the sender is the limit. In quick runs, beside other work, loss is reported but not a
 * failure. */
#include "tests/bench/suites.h"

#include "dis/capture/log.h"
#include "dis/capture/recorder.h"
#include "dis/network/udp.h"

#include <netinet/in.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum {
    pdu_octets = 208,
    bundled = 6,
    most_octets = pdu_octets * bundled,
    promised_rate = 60000, /* DESIGN: none lost */
    what_size = 96,
    late_rate = 1000
};
static const int64_t still_ns = 200000000; /* nothing for so long after the last was sent: it is over */

typedef struct Flow {
    DisUdp       *sender;
    int           octets, rate; /* per second; 0: as fast as possible */
    uint64_t      count;        /* at most; the time ends it, too */
    double        for_s;
    double        took_s;
    atomic_ullong sent; /* that the system took */
    atomic_bool   done;
    /* receiver */
    uint8_t *seen; /* [count] */
    uint64_t received, wrong, twice, disordered;
    double  *late_s; /* [count], in order of arrival; NULL: not needed */
} Flow;

/* Fills a datagram with its number, and with words that follow from the number. */
static void fill(uint8_t *out, int octets, uint64_t number)
{
    uint64_t word = number;
    for (int i = 0; i < octets; i += 8) {
        memcpy(out + i, &word, 8);
        word = (word ^ number) * 0x9E3779B97F4A7C15u + 1;
    }
}

static void sleep_until_s(double until_s)
{
    const struct timespec at = {(time_t)until_s, (long)(1e9 * (until_s - floor(until_s)))};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, NULL);
}

static void *send_flow(void *user)
{
    Flow        *f = user;
    uint8_t      octet[most_octets];
    const double begun_s = wall_clock_s();
    uint64_t     n = 0;
    for (double now_s = begun_s; n < f->count && now_s - begun_s < f->for_s; now_s = wall_clock_s()) {
        const double due = f->rate ? fmin((now_s - begun_s) * f->rate + 1, (double)f->count) : (double)n + 64;
        for (; n < f->count && (double)n < due; n++) {
            fill(octet, f->octets, n);
            if (dis_udp_send(f->sender, octet, (size_t)f->octets) == STATUS_OK) f->sent++;
        }
        if (f->rate) sleep_until_s(fmax(now_s + 1e-3, begun_s + (double)n / f->rate));
    }
    f->took_s = wall_clock_s() - begun_s;
    f->done = true;
    return NULL;
}

static void take_one(Flow *f, const DisArrival *a, uint64_t *last)
{
    uint8_t  octet[most_octets];
    uint64_t number = UINT64_MAX;
    if (a->octets >= 8) memcpy(&number, a->bytes, 8);
    if ((int)a->octets != f->octets || number >= f->count) {
        f->wrong++;
        return;
    }
    fill(octet, f->octets, number);
    f->wrong += memcmp(octet, a->bytes, a->octets) != 0;
    f->twice += f->seen[number];
    f->disordered += f->received > 0 && number < *last;
    f->seen[number] = 1;
    *last = number;
    if (f->late_s && f->received < f->count) f->late_s[f->received] = 1e-9 * (double)(dis_udp_now_ns() - a->capture_ns);
    f->received++;
}

static Status run_flow(Flow *f, DisUdp *receiver)
{
    DisArrival a;
    uint64_t   last = 0;
    pthread_t  thread;
    f->seen = calloc(f->count, 1);
    if (!f->seen) return STATUS_NO_MEMORY;
    if (pthread_create(&thread, NULL, send_flow, f) != 0) return STATUS_IO;
    for (;;) {
        const bool done = f->done;
        if (!dis_udp_wait(receiver, dis_udp_now_ns() + still_ns) && done) break;
        while (dis_udp_take(&a, receiver, INT64_MAX)) take_one(f, &a, &last);
    }
    pthread_join(thread, NULL);
    free(f->seen);
    f->seen = NULL;
    return STATUS_OK;
}

/* ---- rates ------------------------------------------------------------------------------------ */

typedef struct Link {
    Bench      *bench;
    DisUdp     *receiver, *sender;
    const char *name;      /* IPv4 */
    uint64_t    spoilt;    /* wrong, twice or out of order, of all flows */
    double      most_rate; /* received a second without a loss */
} Link;

static int free_port(int family)
{
    struct sockaddr_in6 at6 = {.sin6_family = AF_INET6, .sin6_addr = IN6ADDR_LOOPBACK_INIT};
    struct sockaddr_in  at4 = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    const bool          v6 = family == AF_INET6;
    struct sockaddr    *at = v6 ? (struct sockaddr *)&at6 : (struct sockaddr *)&at4;
    socklen_t           octets = v6 ? sizeof at6 : sizeof at4;
    const int           s = socket(family, SOCK_DGRAM, 0);
    const bool          ok = s >= 0 && bind(s, at, octets) == 0 && getsockname(s, at, &octets) == 0;
    if (s >= 0) close(s);
    return ok ? ntohs(v6 ? at6.sin6_port : at4.sin_port) : -1;
}

static Status link_open(Link *l, Bench *bench, bool v6, int port)
{
    DisUdpConfig config = dis_udp_default_config();
    *l = (Link){.bench = bench, .name = v6 ? "IPv6" : "IPv4"};
    strcpy(config.address, v6 ? "::1" : "127.0.0.1");
    config.port = port;
    const Status status = dis_udp_open(&l->receiver, &config);
    return status == STATUS_OK ? dis_udp_open_sender(&l->sender, &config) : status;
}

static void link_close(Link *l)
{
    dis_udp_close(l->sender);
    dis_udp_close(l->receiver);
}

static Status time_rate(Link *l, int rate, int pdus)
{
    const double for_s = bench_quick(l->bench) ? 0.15 : 2;
    Flow         f = {.sender = l->sender,
                      .octets = pdus * pdu_octets,
                      .rate = rate,
                      .for_s = for_s,
                      .count = rate ? (uint64_t)(rate * for_s) : (uint64_t)(2e6 * for_s)};
    char         what[what_size], against[what_size], asked[24];
    const Status status = run_flow(&f, l->receiver);
    if (status != STATUS_OK) return status;
    const double received_rate = (double)f.received / f.took_s;
    const bool   lossless = f.received == f.sent && f.sent > 0;
    l->spoilt += f.wrong + f.twice + f.disordered;
    if (lossless && pdus == 1 && received_rate > l->most_rate) l->most_rate = received_rate;
    snprintf(asked, sizeof asked, "%d a second", rate);
    snprintf(what, sizeof what, "%s: %s, %s", l->name, pdus > 1 ? "bundles of six" : "datagrams of an Entity State",
             rate ? asked : "as fast as sent");
    BenchRow row = bench_row(what);
    row.rate = 1e-3 * received_rate * pdus;
    row.rate_unit = "k PDUs/s";
    row.error = f.sent > 0 ? 100 * (1 - (double)f.received / (double)f.sent) : NAN;
    row.error_unit = "%";
    if (rate && rate * pdus <= promised_rate && !bench_quick(l->bench)) row.error_limit = 0;
    snprintf(against, sizeof against, "lost of %llu sent, %.0f a second", f.sent, (double)f.sent / f.took_s);
    row.against = against;
    bench_add(l->bench, &row);
    return STATUS_OK;
}

/* ---- how late --------------------------------------------------------------------------------- */

static int by_value(const void *pa, const void *pb)
{
    const double a = *(const double *)pa, b = *(const double *)pb;
    return (a > b) - (a < b);
}

/* From the kernel's time stamp until the waiting receiver has the datagram. */
static Status time_late(Link *l)
{
    Flow f = {.sender = l->sender,
              .octets = pdu_octets,
              .rate = late_rate,
              .for_s = 60,
              .count = bench_quick(l->bench) ? 300 : 4000};
    char what[what_size];
    f.late_s = calloc(f.count, sizeof *f.late_s);
    Status status = f.late_s ? run_flow(&f, l->receiver) : STATUS_NO_MEMORY;
    if (status == STATUS_OK && f.received > 0) {
        const int n = (int)f.received;
        qsort(f.late_s, (size_t)n, sizeof *f.late_s, by_value);
        l->spoilt += f.wrong + f.twice + f.disordered;
        for (int k = 0; k < 2; k++) {
            snprintf(what, sizeof what, "%s: arrival to taken, %s", l->name, k ? "99 % of all" : "median");
            BenchRow row = bench_row(what);
            row.median = f.late_s[k ? n - 1 - n / 100 : n / 2];
            row.best = f.late_s[0];
            row.unit = "s";
            bench_add(l->bench, &row);
        }
    }
    free(f.late_s);
    return status;
}

static Status time_link(Bench *bench, bool v6)
{
    static const int rates[] = {10000, 50000, 60000, 100000, 200000, 0};
    const int        port = free_port(v6 ? AF_INET6 : AF_INET), most = v6 ? 3 : 6;
    Link             l;
    char             what[what_size];
    if (port < 0 && v6) return STATUS_OK; /* no IPv6 here */
    bench_progress(bench, v6 ? "IPv6" : "IPv4");
    Status status = link_open(&l, bench, v6, port);
    for (int r = 0; r < most && status == STATUS_OK; r++) status = time_rate(&l, rates[r], 1);
    if (status == STATUS_OK) status = time_rate(&l, 8000, bundled);
    if (status == STATUS_OK && !v6) status = time_rate(&l, 0, bundled);
    if (status == STATUS_OK) status = time_late(&l);
    if (status == STATUS_OK) {
        snprintf(what, sizeof what, "%s: most that was received without a loss", l.name);
        BenchRow row = bench_row(what);
        row.rate = 1e-3 * l.most_rate;
        row.rate_unit = "k PDUs/s";
        row.error = (double)l.spoilt;
        row.error_limit = 0;
        row.error_unit = "datagrams";
        row.against = "of all flows: other octets, twice, or out of order";
        bench_add(bench, &row);
    }
    link_close(&l);
    return status;
}

/* ---- the recorder ----------------------------------------------------------------------------- */

typedef struct Recording {
    char   path[temp_path_size];
    int    count;
    Status status;
} Recording;

static void record(void *user)
{
    Recording   *r = user;
    DisRecorder *recorder = NULL;
    uint8_t      octet[pdu_octets];
    r->status = dis_recorder_open(&recorder, r->path, NULL);
    for (int i = 0; i < r->count && r->status == STATUS_OK; i++) {
        fill(octet, pdu_octets, (uint64_t)i);
        r->status =
            dis_recorder_add(recorder, 1000000000000000000 + 1000 * (int64_t)i, NULL, dis_port, octet, pdu_octets);
    }
    const Status closed = dis_recorder_close(recorder);
    if (r->status == STATUS_OK) r->status = closed;
}

static double differing(const Recording *r)
{
    DisLog  log;
    uint8_t octet[pdu_octets];
    double  bad = 0;
    if (dis_log_open(&log, r->path, dis_port) != STATUS_OK) return INFINITY;
    if (log.count != r->count) bad = INFINITY;
    for (int i = 0; i < log.count && i < r->count; i++) {
        fill(octet, pdu_octets, (uint64_t)i);
        const DisDatagram d = dis_log_datagram(&log, i);
        bad += d.octets != pdu_octets || memcmp(d.bytes, octet, pdu_octets) != 0;
    }
    dis_log_close(&log);
    return bad;
}

static Status time_recorder(Bench *bench)
{
    Recording r = {.count = bench_quick(bench) ? 5000 : 100000};
    BenchTime time;
    if (!temp_file(r.path, ".pcapng")) return STATUS_IO;
    const BenchWork work = {record, &r, r.count};
    bench_time(&time, bench, &work, 1);
    BenchRow row = bench_row_of("recorder: a datagram of an Entity State", &time, "k datagrams/s", 1e3);
    row.error = differing(&r);
    row.error_limit = 0;
    row.error_unit = "datagrams";
    row.against = "that differ when read again";
    bench_add(bench, &row);
    remove(r.path);
    return r.status;
}

Status bench_network_sockets(Bench *bench)
{
    Status status = time_link(bench, false);
    if (status == STATUS_OK) status = time_link(bench, true);
    if (status == STATUS_OK) status = time_recorder(bench);
    if (status != STATUS_OK) log_error("bench: network: %s", status_name(status));
    return status;
}
