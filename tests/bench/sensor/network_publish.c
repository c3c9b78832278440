/* tests/bench/sensor/network_publish.c: a live node that renders for a recogniser and a player.
 *
 * Shared memory, and video with KLV, on two cores; an exercise is sent to it over loopback. The figures are those of
 * its latency ledger (run.json). A socket takes the video in place of a player. The node makes no files and no truth
 * (publish.truth), and chooses its quality by the frame interval (quality.frame_ms). On quick rounds, which run beside
 * other load, times and losses are printed and not checked. */
#include "tests/bench/suites.h"
#include "pitviper_output.h"

#include "tests/bench/sensor/node_process.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

enum { receivers_max = 3, arguments_max = 64 };

typedef struct Case {
    const char *name, *bands, *size, *scale; /* scale: of the crowd of 10 000; NULL: one target */
    int         rate_hz, bands_count;
    bool        video;
} Case;

static const Case cases[] = {
    {"640 x 480 LWIR at 30 frames/s, 200 entities", "lwir", "640x480", "scale=0.02", 30, 1, true},
    {"256 x 256 LWIR at 100 frames/s, one target", "lwir", "256x256", NULL, 100, 1, false},
    {"640 x 480 optical, MWIR, LWIR at 10 frames/s, 200 entities", "optical,mwir,lwir", "640x480", "scale=0.02", 10, 3,
     true},
};

static const char one_target[] = "duration_s: 600\n"
                                 "vehicles:\n"
                                 "  - name: Tank\n"
                                 "    type: 1.1.222.1.1.1.0\n"
                                 "    force: 2\n"
                                 "    route_m: [[-200, 0], [200, 0], [200, 200], [-200, 200]]\n"
                                 "    loop: true\n"
                                 "    speed_mps: 8\n";

static const double memory_s = 0.001, video_s = 0.006; /* rendered to in memory, to last octet of video sent, 99 % */

typedef struct Node {
    Bench      *bench;
    const Case *of;
    int         port, receiver[receivers_max];
    char        folder[temp_path_size], scenario[temp_path_size], run_json[temp_path_size + 16], memory[48], stream[48];
} Node;

/* ---- the processes ------------------------------------------------------------------------------- */

static bool open_receivers(Node *n)
{
    for (int k = 0; k < receivers_max; k++) n->receiver[k] = -1;
    for (int k = 0; n->of->video && k < n->of->bands_count; k++) {
        const struct sockaddr_in at = {.sin_family = AF_INET,
                                       .sin_port = htons((uint16_t)(n->port + 1001 + 2 * k)),
                                       .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
        n->receiver[k] = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
        if (n->receiver[k] < 0 || bind(n->receiver[k], (const struct sockaddr *)&at, sizeof at) != 0) return false;
    }
    return true;
}

/* Gives the node the first two processors, and its exercise the others, if there are any. */
static void choose_processors(cpu_set_t *node, cpu_set_t *others)
{
    cpu_set_t all;
    int       taken = 0;
    CPU_ZERO(node);
    CPU_ZERO(others);
    sched_getaffinity(0, sizeof all, &all);
    for (int i = 0; i < CPU_SETSIZE; i++)
        if (CPU_ISSET(i, &all)) CPU_SET(i, taken++ < 2 ? node : others);
    if (CPU_COUNT(others) == 0) *others = all;
}

static pid_t start_on(const cpu_set_t *processors, const char *const *argument, int out)
{
    cpu_set_t before;
    sched_getaffinity(0, sizeof before, &before);
    sched_setaffinity(0, sizeof *processors, processors);
    const pid_t child = node_start(argument, out, out);
    sched_setaffinity(0, sizeof before, &before);
    return child;
}

static pid_t start_node(const Node *n, const cpu_set_t *processors, int out)
{
    const bool  quick = bench_quick(n->bench);
    char        port[16], rate[16], quality[48];
    const char *argument[arguments_max];
    int         count = 0;
    snprintf(port, sizeof port, "%d", n->port);
    snprintf(rate, sizeof rate, "%d", n->of->rate_hz);
    snprintf(quality, sizeof quality, "quality.frame_ms=%g", 800.0 / n->of->rate_hz);
    const char *const all[] = {"pitviper",
                               "run",
                               "--address",
                               "127.0.0.1",
                               "--port",
                               port,
                               "--size",
                               quick ? "96x64" : n->of->size,
                               "--bands",
                               n->of->bands,
                               "--rate",
                               rate,
                               "--no-files",
                               "--threads",
                               "2",
                               "--for",
                               "90",
                               "--out",
                               n->folder,
                               "--memory",
                               n->memory,
                               "--set",
                               "exercise.listen_s=0.5",
                               "--set",
                               "publish.truth=false",
                               "--set",
                               quality,
                               "--set",
                               "entities.shown=10000",
                               "--overwrite"};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) argument[count++] = all[i];
    if (n->of->video) {
        argument[count++] = "--stream";
        argument[count++] = n->stream;
    }
    argument[count] = NULL;
    return start_on(processors, argument, out);
}

static Status run_both(const Node *n)
{
    const bool    quick = bench_quick(n->bench);
    char          to[32];
    int           said[2];
    struct rusage usage;
    cpu_set_t     for_node, for_others;
    choose_processors(&for_node, &for_others);
    snprintf(to, sizeof to, "127.0.0.1:%d", n->port);
    const char *const crowd[] = {"pitviper", "exercise", "crowd", "--set", n->of->scale, "--send", to, NULL};
    const char *const one[] = {"pitviper", "exercise", n->scenario, "--send", to, NULL};
    if (pipe2(said, O_CLOEXEC) != 0) return STATUS_IO;
    const int   nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    const pid_t node = nowhere < 0 ? -1 : start_node(n, &for_node, said[1]);
    pid_t       sender = -1;
    close(said[1]);
    bool ok = node > 0 && node_hears(said[0], "listening on", 120);
    if (ok) sender = start_on(&for_others, n->of->scale ? crowd : one, nowhere);
    ok = ok && sender > 0 && node_hears(said[0], "ground:", 120); /* its choices are made: frames begin */
    if (ok) fcntl(said[0], F_SETFL, O_NONBLOCK);
    char rest[4096];
    for (int i = 0; ok && i < (quick ? 20 : 120); i++) { /* its messages are read on, or it would wait */
        usleep(100000);
        while (read(said[0], rest, sizeof rest) > 0) {
        }
    }
    if (sender > 0) kill(sender, SIGTERM);
    if (sender > 0) node_finish(sender, 5, &usage);
    if (node > 0) kill(node, SIGINT);
    ok = node > 0 && node_finish(node, 30, &usage) == 0 && ok;
    close(said[0]);
    if (nowhere >= 0) close(nowhere);
    if (!ok) log_error("bench: the live node or its exercise did not end as it should");
    return ok ? STATUS_OK : STATUS_IO;
}

/* ---- rows ----------------------------------------------------------------------------------------- */

static BenchRow row_of(char what[160], const Node *n, const char *name)
{
    snprintf(what, 160, "live node, %s: %s", n->of->name, name);
    return bench_row(what);
}

/* Adds the median and the 99 % quantile of one of the ledger's figures, s; limit_s NaN: there is no limit. */
static void add_latency(const Node *n, const char *text, const char *name, const char *const *key, double limit_s,
                        const char *against)
{
    char        what[160];
    const char *median[4] = {"latency_ms", key[0], key[1] ? key[1] : "median", "median"};
    const char *p99[4] = {"latency_ms", key[0], key[1] ? key[1] : "p99", "p99"};
    const int   keys = key[1] ? 4 : 3;
    BenchRow    row = row_of(what, n, name);
    row.median = 1e-3 * node_number(text, median, keys);
    row.unit = "s";
    row.error = 1e-3 * node_number(text, p99, keys);
    row.error_unit = "s";
    row.against = against;
    if (!bench_quick(n->bench)) row.error_limit = limit_s;
    bench_add(n->bench, &row);
}

static Status add_rows(const Node *n)
{
    char         what[160], against[128], *text = NULL;
    size_t       octets;
    const Status status = text_read_file(&text, &octets, "bench", n->run_json, 1 << 28);
    if (status != STATUS_OK) return status;
    add_latency(n, text, "rendered to in shared memory", (const char *const[]){"consumers", "memory"}, memory_s,
                "99 % of the frames; 1 ms");
    if (n->of->video)
        add_latency(n, text, "rendered to last octet of video sent", (const char *const[]){"consumers", "video"},
                    video_s, "99 % of the frames; 6 ms");
    add_latency(n, text, "arrival to pose sampled", (const char *const[]){"arrival_to_pose", NULL},
                1.0 / n->of->rate_hz, "99 % of the frames with news; the frame interval");
    add_latency(n, text, "rendering", (const char *const[]){"render", NULL}, NAN, "99 % of the frames");

    const double late = NUMBER_AT(text, "live", "frames_late");
    const double made = NUMBER_AT(text, "latency_ms", "render", "count");
    const double left = n->of->video ? NUMBER_AT(text, "latency_ms", "consumers", "video", "left_out") : 0;
    BenchRow     row = row_of(what, n, "frames left out");
    row.error = 100 * late / (made + late);
    row.error_unit = "%";
    snprintf(against, sizeof against, "of those due; made: %.0f; without video: %.0f", made, left);
    row.against = against;
    bench_add(n->bench, &row);
    row = row_of(what, n, "frames kept, with all bands");
    row.error = 100 * NUMBER_AT(text, "live", "kept_share");
    row.error_unit = "%";
    row.against = "of those due";
    bench_add(n->bench, &row);
    static const char *const step[] = {"frames_targets", "frames_checkerboard", "frames_quarter"};
    double                   at[3];
    for (int i = 0; i < 3; i++) at[i] = NUMBER_AT(text, "live", step[i]);
    row = row_of(what, n, "frames that gave up sampling (quality.deadline)");
    row.error = made > 0 ? 100 * (at[0] + at[1] + at[2]) / made : 0;
    row.error_unit = "%";
    snprintf(against, sizeof against, "of those made; targets %.0f, checkerboard %.0f, quarter %.0f", at[0], at[1],
             at[2]);
    row.against = against;
    bench_add(n->bench, &row);
    row = row_of(what, n, "datagrams lost");
    row.error = NUMBER_AT(text, "live", "lost_kernel") + NUMBER_AT(text, "live", "lost_queue");
    row.error_unit = "datagrams";
    snprintf(against, sizeof against, "of %.0f", NUMBER_AT(text, "live", "datagrams"));
    row.against = against;
    if (!bench_quick(n->bench)) row.error_limit = 0;
    bench_add(n->bench, &row);
    free(text);
    return STATUS_OK;
}

static Status run_case(Bench *bench, const Case *of, int index)
{
    Node   n = {.bench = bench, .of = of, .port = 20000 + (int)((getpid() * 7L + 40L * index) % 12000)};
    Status status = temp_folder(n.folder) ? STATUS_OK : STATUS_IO;
    bench_progress(bench, of->name);
    if (status != STATUS_OK) return status;
    snprintf(n.run_json, sizeof n.run_json, "%s/run.json", n.folder);
    snprintf(n.memory, sizeof n.memory, "pitviper_bench_%d", (int)getpid());
    snprintf(n.stream, sizeof n.stream, "udp://127.0.0.1:%d", n.port + 1001);
    if (!temp_file(n.scenario, ".yaml")) status = STATUS_IO;
    FILE *file = status == STATUS_OK ? output_file(n.scenario, 0) : NULL;
    if (!file || fputs(one_target, file) < 0 || fclose(file) != 0) status = STATUS_IO;
    if (!open_receivers(&n)) {
        log_error("bench: cannot receive on loopback: %s", strerror(errno));
        status = STATUS_IO;
    }
    if (status == STATUS_OK) status = run_both(&n);
    if (status == STATUS_OK) status = add_rows(&n);
    else log_error("bench: network: %s: %s", of->name, status_name(status));
    for (int k = 0; k < receivers_max; k++)
        if (n.receiver[k] >= 0) close(n.receiver[k]);
    remove(n.scenario);
    remove(n.run_json);
    remove(n.folder);
    return status;
}

Status bench_network_publish(Bench *bench)
{
    const int count = bench_quick(bench) ? 1 : (int)(sizeof cases / sizeof *cases);
    Status    status = STATUS_OK;
    for (int i = 0; i < count; i++) {
        const Status one = run_case(bench, &cases[i], i);
        if (status == STATUS_OK) status = one;
    }
    return status;
}
