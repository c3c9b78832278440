/* tests/bench/sensor/network_live.c: a live node in a process of its own, an exercise sent to it from another, over
 * loopback.
 *
 * The node records the datagrams it receives, and those it sends: a Data PDU per frame, which it receives like every
 * other. So the recording has the kernel's stamp of each report, the time of each frame, and the stamp at which the
 * frame was published. Both processes end by themselves, and are killed if they do not. On quick rounds, which run
 * beside other load, times and losses are printed and not checked. */
#include "tests/bench/suites.h"
#include "pitviper_output.h"

#include "tests/bench/sensor/node_process.h"

#include "dis/pdu/decode.h"
#include "dis/clock/exercise_clock.h"
#include "dis/capture/log.h"
#include "sensor/settings/config.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { rate_hz = 30, path_size = temp_name_size };
static const double patience_s = 120, publish_s = 0.010; /* DESIGN: frame time to published <= render + 10 ms */

typedef struct Live {
    Bench  *bench;
    char    folder[temp_path_size], recording[path_size], said[path_size], run_json[path_size];
    int     port;
    double  ready_s, sent_for_s, resident_mb;
    double  sent, heard, own, lost, frames, late; /* datagrams; frames */
    double  frame_median_s, frame_p95_s;
    double *sampled_s, *published_s; /* sorted */
    int     samples, publications;
} Live;

/* ---- processes -------------------------------------------------------------------------------- */

static Status run_both(Live *l)
{
    const bool quick = bench_quick(l->bench);
    char       port[16], to[32], length[16], threads[16], rate[16];
    int        ears[2];
    snprintf(port, sizeof port, "%d", l->port);
    snprintf(to, sizeof to, "127.0.0.1:%d", l->port);
    snprintf(length, sizeof length, "%.0f", 3 * patience_s); /* the last resort */
    snprintf(threads, sizeof threads, "%d", bench_threads(l->bench));
    snprintf(rate, sizeof rate, "%d", rate_hz);
    const char *const node[] = {"pitviper",
                                "run",
                                "--address",
                                "127.0.0.1",
                                "--port",
                                port,
                                "--size",
                                quick ? "96x64" : "320x216",
                                "--bands",
                                "lwir",
                                "--rate",
                                rate,
                                "--no-files",
                                "--for",
                                length,
                                "--out",
                                l->folder,
                                "--record",
                                l->recording,
                                "--threads",
                                threads,
                                "--set",
                                "exercise.listen_s=0.5",
                                "--set",
                                "entities.shown=10000",
                                "--set",
                                "publish.dis=sensor",
                                NULL};
    const char *const exercise[] = {"pitviper", "exercise", quick ? "demo" : "crowd", "--send", to, NULL};
    if (pipe2(ears, O_CLOEXEC) != 0) return STATUS_IO;
    const int     out = output_open(l->said, 0);
    const double  begun_s = wall_clock_s();
    struct rusage usage = {0}, unused;
    pid_t         listener = out < 0 ? -1 : node_start(node, ears[1], ears[1]), sender = -1;
    close(ears[1]);
    bool ok = listener > 0 && node_hears(ears[0], "listening on", patience_s);
    l->ready_s = wall_clock_s() - begun_s;
    const double sending_s = wall_clock_s();
    if (ok) sender = node_start(exercise, out, out);
    if (sender > 0) {
        ok = node_hears(ears[0], "ground:", patience_s); /* its choices are made: frames begin */
        if (ok) usleep((useconds_t)(1e6 * (quick ? 3 : 12)));
        kill(sender, SIGTERM);
        ok = node_finish(sender, 5, &unused) >= 0 && ok;
        l->sent_for_s = wall_clock_s() - sending_s;
        if (ok) usleep(300000); /* the last of it is in transit */
    }
    if (listener > 0) {
        kill(listener, SIGINT);
        ok = node_finish(listener, patience_s, &usage) == 0 && ok && sender > 0;
    }
    l->resident_mb = 1024e-6 * (double)usage.ru_maxrss;
    close(ears[0]);
    if (out >= 0) close(out);
    if (!ok) log_error("bench: the live node or its exercise did not end as it should");
    return ok ? STATUS_OK : STATUS_IO;
}

/* ---- results -------------------------------------------------------------------------- */

static Status read_result(Live *l)
{
    char  *text = NULL;
    size_t octets;
    Status status = text_read_file(&text, &octets, "bench", l->said, 1 << 20);
    if (status != STATUS_OK) return status;
    const char *count = strstr(text, " datagrams,");
    while (count && count > text && count[-1] != ' ') count--;
    l->sent = count ? strtod(count, NULL) : NAN;
    free(text);
    status = text_read_file(&text, &octets, "bench", l->run_json, 1 << 28);
    if (status != STATUS_OK) return status;
    l->own = NUMBER_AT(text, "live", "sent");
    l->heard = NUMBER_AT(text, "live", "datagrams") - l->own;
    l->lost = NUMBER_AT(text, "live", "lost_kernel") + NUMBER_AT(text, "live", "lost_queue");
    l->late = NUMBER_AT(text, "live", "frames_late");
    l->frame_median_s = 1e-3 * NUMBER_AT(text, "timings_ms", "frame", "median");
    l->frame_p95_s = 1e-3 * NUMBER_AT(text, "timings_ms", "frame", "p95");
    free(text);
    return STATUS_OK;
}

static int by_value(const void *pa, const void *pb)
{
    const double a = *(const double *)pa, b = *(const double *)pb;
    return (a > b) - (a < b);
}

/* Time from one time in the hour to another, by the shorter way. */
static double after_s(double from_s, double to_s) { return remainder(to_s - from_s, 3600); }

/* The time in the hour of a datagram's frame; NaN: it is not a frame of the node. */
static double frame_of(const DisDatagram *d, const Config *config)
{
    DisCounters    counters = {0};
    DisHeader      header;
    const uint8_t *pdu, *at = d->bytes;
    uint16_t       sender[2];
    if (!dis_next_pdu(&header, &pdu, &at, d->bytes + d->octets, &counters) || !dis_pdu_sender(sender, &header, pdu))
        return NAN;
    return sender[0] == config->node.site && sender[1] == config->node.application
               ? dis_timestamp_seconds(header.timestamp)
               : NAN;
}

/* Reads, for each report between the first frame and the last, the delay to the first frame after it. */
static Status read_latency(Live *l)
{
    const Config config = config_default();
    DisLog       log;
    Status       status = dis_log_open(&log, l->recording, l->port);
    if (status != STATUS_OK) return status;
    double *t_s = calloc((size_t)log.count + 1, sizeof *t_s);
    l->sampled_s = calloc((size_t)log.count + 1, sizeof *l->sampled_s);
    l->published_s = calloc((size_t)log.count + 1, sizeof *l->published_s);
    if (!t_s || !l->sampled_s || !l->published_s) status = STATUS_NO_MEMORY;
    for (int i = 0; i < log.count && status == STATUS_OK; i++) {
        const DisDatagram d = dis_log_datagram(&log, i);
        const double      frame_s = frame_of(&d, &config);
        if (isnan(frame_s)) continue;
        t_s[l->publications] = frame_s;
        l->published_s[l->publications++] = after_s(frame_s, fmod(log.datagram[i].capture_s, 3600));
    }
    for (int i = 0, k = 0; i < log.count && status == STATUS_OK && l->publications > 1; i++) {
        const DisDatagram d = dis_log_datagram(&log, i);
        const double      came_s = fmod(d.capture_s, 3600);
        if (after_s(t_s[0], came_s) < 0 || !isnan(frame_of(&d, &config))) continue;
        while (k < l->publications && after_s(t_s[k], came_s) > 0) k++;
        if (k < l->publications) l->sampled_s[l->samples++] = after_s(came_s, t_s[k]);
    }
    l->frames = l->publications;
    if (status == STATUS_OK) {
        qsort(l->sampled_s, (size_t)l->samples, sizeof *l->sampled_s, by_value);
        qsort(l->published_s, (size_t)l->publications, sizeof *l->published_s, by_value);
    }
    free(t_s);
    dis_log_close(&log);
    return status;
}

/* ---- rows ------------------------------------------------------------------------------------- */

static void add_latency(Live *l, const char *name, const double *sorted_s, int count, double limit_s, const char *limit)
{
    char what[96];
    for (int k = 0; k < 2 && count > 0; k++) {
        snprintf(what, sizeof what, "%s, %s", name, k ? "99 % of all" : "median");
        BenchRow row = bench_row(what);
        row.median = sorted_s[k ? count - 1 - count / 100 : count / 2];
        row.unit = "s";
        if (k) {
            row.error = row.median;
            row.error_unit = "s";
            row.against = limit;
            if (!bench_quick(l->bench)) row.error_limit = limit_s;
        }
        bench_add(l->bench, &row);
    }
}

static void add_figure(Live *l, const char *what, double figure, const char *unit)
{
    BenchRow row = bench_row(what);
    row.median = figure;
    row.unit = unit;
    bench_add(l->bench, &row);
}

static void add_rows(Live *l)
{
    char against[128];
    add_figure(l, "live node: ready to listen after", l->ready_s, "s");
    BenchRow row = bench_row("live node: reports heard");
    row.rate = l->heard / l->sent_for_s;
    row.rate_unit = "datagrams/s";
    row.error = fmax(l->sent - l->heard, l->lost);
    row.error_unit = "datagrams";
    if (!bench_quick(l->bench)) row.error_limit = 0;
    snprintf(against, sizeof against, "lost of %.0f sent", l->sent);
    row.against = against;
    bench_add(l->bench, &row);

    row = bench_row("live node: a frame");
    row.median = l->frame_median_s;
    row.unit = "s";
    row.error = 100 * l->late / (l->frames + l->late);
    row.error_unit = "%";
    snprintf(against, sizeof against, "left out, of %.0f a second asked for; made: %.0f", (double)rate_hz, l->frames);
    row.against = against;
    bench_add(l->bench, &row);
    add_latency(l, "live node: arrival to pose sampled", l->sampled_s, l->samples, 1.0 / rate_hz, "the frame interval");
    add_latency(l, "live node: frame time to published", l->published_s, l->publications, l->frame_p95_s + publish_s,
                "a frame (95 %) and 10 ms");
    add_figure(l, "live node: memory resident at most", l->resident_mb, "MB");
}

Status bench_network_live(Bench *bench)
{
    static const char *const files[] = {"node.pcapng", "said.txt", "run.json", "truth.jsonl"};
    Live                     l = {.bench = bench, .port = 20000 + (int)(getpid() * 7L % 12000)};
    char                     path[path_size];
    bench_progress(bench, "live node");
    if (!temp_folder(l.folder)) return STATUS_IO;
    snprintf(l.recording, sizeof l.recording, "%s/%s", l.folder, files[0]);
    snprintf(l.said, sizeof l.said, "%s/%s", l.folder, files[1]);
    snprintf(l.run_json, sizeof l.run_json, "%s/%s", l.folder, files[2]);
    Status status = run_both(&l);
    if (status == STATUS_OK) status = read_result(&l);
    if (status == STATUS_OK) status = read_latency(&l);
    if (status == STATUS_OK && (l.publications < 2 || l.samples < 1)) {
        log_error("bench: the live node made no frames in its time; is this machine so busy?");
        status = STATUS_IO;
    }
    if (status == STATUS_OK) add_rows(&l);
    else log_error("bench: network: live node: %s", status_name(status));
    free(l.sampled_s);
    free(l.published_s);
    for (size_t k = 0; k < sizeof files / sizeof *files; k++) {
        snprintf(path, sizeof path, "%s/%s", l.folder, files[k]);
        remove(path);
    }
    for (const char *const *sub = (const char *const[]){"frames", "profiles", "", NULL}; *sub; sub++) {
        snprintf(path, sizeof path, "%s/%s", l.folder, *sub);
        remove(path);
    }
    return status;
}
