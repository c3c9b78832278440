/* tests/bench/sensor/loop.c: `pitviper bench loop`: from a pose to the next, in step with a CIGI host.
 *
 * This process is the host: it sends a pose, waits for Start of Frame and for the answer of a recogniser, and makes the
 * next pose of it: the eye turns to what was found. The recogniser is a process of its own, in C: it takes the newest
 * frame of the ring, looks for the hottest pixel, and answers by UDP. The node is a replay of an exercise of one
 * vehicle on bare ground, 256 x 256, with two threads. All clocks are CLOCK_MONOTONIC; what happens in the node is in
 * the ring's records. Times are printed, and judged by no limit: other load decides them, and its average is in the
 * table. */
#include "tests/bench/suites.h"
#include "pitviper_output.h"

#include "dis/cigi/cigi_datagram.h"
#include "tests/bench/sensor/node_process.h"

#include <pitviper_memory.h>

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

enum { warm_up = 10, frames_quick = 30, frames_most = 1500, settings_most = 2 };
typedef struct Case {
    const char *name, *setting[settings_most];
} Case;
static const Case   cases[] = {{"default quality", {"--set", "sensor.antialias=adaptive"}},
                               {"one ray a pixel", {"--set", "sensor.antialias=off"}}};
static const double silent_s = 60, step_s = 0.01, start_s = 1351, hfov_deg = 6;
static const char   scenario[] = "duration_s: 60\n"
                                 "vehicles:\n"
                                 "  - name: Tank\n"
                                 "    type: 1.1.222.1.1.1.0\n"
                                 "    route_m: [[-40, 0], [40, 0], [40, 40], [-40, 40]]\n"
                                 "    loop: true\n"
                                 "    speed_mps: 8\n";

/* What the recogniser says of a frame: by UDP to the host. */
typedef struct Answer {
    int32_t frame, column, row;
    int64_t begun_ns, posed_ns, rendered_ns, written_ns; /* of the ring's record */
    int64_t taken_ns, answered_ns;
} Answer;

typedef enum Stage {
    TO_NODE,
    POSING,
    RENDERING,
    TO_RING,
    TO_RECOGNISER,
    RECOGNISING,
    TO_HOST,
    TO_HEARTBEAT,
    WHOLE,
    STAGES
} Stage;
static const char *const stage_name[STAGES] = {[TO_NODE] = "pose sent to work begun",
                                               [POSING] = "entities posed",
                                               [RENDERING] = "light, rendering, radiance",
                                               [TO_RING] = "rendered to in shared memory",
                                               [TO_RECOGNISER] = "to taken by the recogniser",
                                               [RECOGNISING] = "recognised (the hottest pixel)",
                                               [TO_HOST] = "answer sent to received",
                                               [TO_HEARTBEAT] = "answer received to Start of Frame",
                                               [WHOLE] = "pose to the next pose"};

typedef struct Loop {
    Bench      *bench;
    const Case *of;
    int         node_port, host_port, cigi, answers; /* sockets */
    char        folder[temp_path_size], exercise[temp_path_size], log[temp_path_size], memory[48];
    int         frames;
    double      lat_deg, lon_deg, height_m, yaw_deg, pitch_deg;
    double      processor_s; /* of the node, a frame */
    double      time_s[STAGES][frames_most];
} Loop;

/* ---- the recogniser --------------------------------------------------------------------------------- */

static void recognise(const char *memory, int port)
{
    const struct sockaddr_in host = {
        .sin_family = AF_INET, .sin_port = htons((uint16_t)port), .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    const int      to = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    PitviperMemory m;
    int            result;
    while ((result = pitviper_memory_open(&m, memory)) == PITVIPER_MEMORY_ABSENT) usleep(10000);
    while (result == 0 && (result = pitviper_memory_wait(&m, 1000)) >= 0) {
        while (pitviper_memory_take_newest(&m) == 1) {
            Answer       a = {.frame = m.record.frame,
                              .begun_ns = m.record.begun_ns,
                              .posed_ns = m.record.posed_ns,
                              .rendered_ns = m.record.rendered_ns,
                              .written_ns = m.record.written_ns,
                              .taken_ns = pitviper_memory_now_ns()};
            const float *value = pitviper_memory_plane(&m, 0);
            uint32_t     most = 0;
            for (uint32_t i = 1; i < m.plane[0].width * m.plane[0].height; i++)
                if (value[i] > value[most]) most = i;
            a.column = (int32_t)(most % m.plane[0].width);
            a.row = (int32_t)(most / m.plane[0].width);
            a.answered_ns = pitviper_memory_now_ns();
            sendto(to, &a, sizeof a, 0, (const struct sockaddr *)&host, sizeof host);
        }
        result = 0;
    }
    _exit(0);
}

/* ---- the host --------------------------------------------------------------------------------------- */

static int open_socket(int port)
{
    const struct sockaddr_in own = {
        .sin_family = AF_INET, .sin_port = htons((uint16_t)port), .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    const int s = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (s >= 0 && bind(s, (const struct sockaddr *)&own, sizeof own) != 0) {
        close(s);
        return -1;
    }
    return s;
}

static bool send_pose(const Loop *l, uint32_t host_frame, uint32_t ig_frame, double t_s)
{
    const struct sockaddr_in node = {
        .sin_family = AF_INET, .sin_port = htons((uint16_t)l->node_port), .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    uint8_t    octets[256];
    CigiPacket control = {.id = cigi_ig_control}, entity = {.id = cigi_entity_control};
    control.of.ig_control = (CigiIgControl){.mode = 1,
                                            .timestamp_valid = true,
                                            .host_frame = host_frame,
                                            .timestamp = (uint32_t)llround(1e5 * t_s),
                                            .last_ig_frame = ig_frame};
    entity.of.entity_control = (CigiEntityControl){.state = 1,
                                                   .alpha = 255,
                                                   .yaw_deg = (float)l->yaw_deg,
                                                   .pitch_deg = (float)l->pitch_deg,
                                                   .p = {l->lat_deg, l->lon_deg, l->height_m}};
    size_t count = cigi_write(octets, sizeof octets, &control, CIGI_BIG_ENDIAN);
    count += cigi_write(octets + count, sizeof octets - count, &entity, CIGI_BIG_ENDIAN);
    return sendto(l->cigi, octets, count, 0, (const struct sockaddr *)&node, sizeof node) == (ssize_t)count;
}

/* Waits for Start of Frame after a number, and where asked for the answer; their times of arrival. */
static bool wait_for(uint32_t *ig_frame, int64_t *heartbeat_ns, Answer *answer, int64_t *answered_ns, const Loop *l)
{
    struct pollfd  from[2] = {{.fd = l->cigi, .events = POLLIN}, {.fd = answer ? l->answers : -1, .events = POLLIN}};
    const uint32_t before = *ig_frame;
    uint8_t        octets[2048];
    bool           heard = false, answered = !answer;
    while (!heard || !answered) {
        if (poll(from, 2, (int)(1e3 * silent_s)) <= 0) return false;
        if (from[1].revents & POLLIN) {
            answered = recv(l->answers, answer, sizeof *answer, 0) == (ssize_t)sizeof *answer;
            *answered_ns = pitviper_memory_now_ns();
        }
        if (!(from[0].revents & POLLIN)) continue;
        const ssize_t got = recv(l->cigi, octets, sizeof octets, 0);
        CigiCounters  counters = {0};
        CigiReader    reader;
        CigiPacket    first;
        if (got <= 0 || cigi_open(&reader, &first, &counters, octets, (size_t)got, CIGI_FROM_IG) != STATUS_OK) continue;
        if (first.of.start_of_frame.ig_frame <= before) continue; /* sent again */
        *ig_frame = first.of.start_of_frame.ig_frame;
        *heartbeat_ns = pitviper_memory_now_ns();
        heard = true;
    }
    return true;
}

/* The eye turns to what was found, as a gimbal of some bandwidth does. */
static void turn(Loop *l, const Answer *a)
{
    static const double share = 0.2, pixels = 256, most_deg = 20;
    l->yaw_deg = clamp(l->yaw_deg + share * hfov_deg * ((a->column + 0.5) / pixels - 0.5), -most_deg, most_deg);
    l->pitch_deg = clamp(l->pitch_deg - share * hfov_deg * ((a->row + 0.5) / pixels - 0.5), -most_deg, most_deg);
}

/* Processor time that a process has had, s, by /proc; NaN: unknown. */
static double processor_s(pid_t process)
{
    char               path[48], text[1024];
    unsigned long long user, system;
    snprintf(path, sizeof path, "/proc/%d/stat", (int)process);
    FILE        *file = fopen(path, "r");
    const size_t got = file ? fread(text, 1, sizeof text - 1, file) : 0;
    if (file) fclose(file);
    text[got] = 0;
    const char *at = strrchr(text, ')'); /* behind the name, which may hold anything: field 3 */
    if (!at || sscanf(at + 1, " %*c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %llu %llu", &user, &system) != 2)
        return NAN;
    return (double)(user + system) / (double)sysconf(_SC_CLK_TCK);
}

static Status fly(Loop *l, pid_t node)
{
    uint32_t ig_frame = 0, host_frame = 0;
    int64_t  heartbeat_ns = 0, answered_ns = 0;
    Answer   a;
    if (!wait_for(&ig_frame, &heartbeat_ns, NULL, NULL, l)) return STATUS_IO;
    for (int i = -warm_up; i < l->frames; i++) {
        const int64_t sent_ns = pitviper_memory_now_ns();
        if (!send_pose(l, ++host_frame, ig_frame, start_s + step_s * (i + warm_up))) return STATUS_IO;
        if (!wait_for(&ig_frame, &heartbeat_ns, &a, &answered_ns, l)) return STATUS_IO;
        turn(l, &a);
        if (i == 0) l->processor_s = processor_s(node);
        if (i < 0) continue;
        const int64_t last_ns = heartbeat_ns > answered_ns ? heartbeat_ns : answered_ns;
        const int64_t at[STAGES] = {sent_ns,    a.begun_ns,    a.posed_ns,  a.rendered_ns, a.written_ns,
                                    a.taken_ns, a.answered_ns, answered_ns, last_ns};
        for (int s = 0; s < WHOLE; s++) l->time_s[s][i] = 1e-9 * (double)(at[s + 1] - at[s]);
        l->time_s[WHOLE][i] = 1e-9 * (double)(last_ns - sent_ns);
    }
    l->processor_s = (processor_s(node) - l->processor_s) / (l->frames - 1);
    return STATUS_OK;
}

/* ---- the processes ---------------------------------------------------------------------------------- */

static Status run_all(Loop *l)
{
    char          to[32], port[48], threads[8];
    const int     nowhere = open("/dev/null", O_RDWR | O_CLOEXEC);
    Status        status = STATUS_IO;
    struct rusage unused;
    snprintf(to, sizeof to, "127.0.0.1:%d", l->host_port);
    snprintf(port, sizeof port, "exercise.cigi_port=%d", l->node_port);
    snprintf(threads, sizeof threads, "%d", bench_threads(l->bench));
    const char *const make[] = {"pitviper", "exercise", l->exercise, "--overwrite", "-o", l->log, NULL};
    const char *const node[] = {"pitviper",
                                "replay",
                                l->log,
                                "--out",
                                l->folder,
                                "--overwrite",
                                "--cigi",
                                to,
                                "--set",
                                port,
                                "--memory",
                                l->memory,
                                "--bands",
                                "lwir",
                                "--size",
                                "256x256",
                                "--no-files",
                                "--threads",
                                threads,
                                "--set",
                                "terrain.woods=off",
                                "--set",
                                "terrain.buildings=off",
                                "--set",
                                "terrain.clutter=0",
                                "--set",
                                "quality.budget=off",
                                "--set",
                                "publish.truth=false",
                                l->of->setting[0],
                                l->of->setting[1],
                                NULL};
    const pid_t       maker = node_start(make, nowhere, nowhere);
    if (maker > 0 && node_finish(maker, silent_s, &unused) == 0) {
        const pid_t recogniser = fork();
        if (recogniser == 0) recognise(l->memory, l->host_port + 2);
        const pid_t child = node_start(node, nowhere, nowhere);
        if (child > 0 && recogniser > 0) status = fly(l, child);
        if (child > 0) kill(child, SIGINT);
        if (child > 0) node_finish(child, silent_s, &unused);
        if (recogniser > 0) kill(recogniser, SIGTERM);
        if (recogniser > 0) waitpid(recogniser, NULL, 0);
    }
    if (nowhere >= 0) close(nowhere);
    if (status != STATUS_OK) log_error("bench: loop: the node did not answer within %g s", silent_s);
    return status;
}

/* ---- rows ------------------------------------------------------------------------------------------- */

static double at_share(const double *sorted, int count, double share)
{
    const int rank = (int)ceil(share * count - 1e-9);
    return sorted[rank < 1 ? 0 : rank - 1];
}

static void add_rows(Loop *l)
{
    char      what[160], beside[96];
    double    load[3] = {NAN, NAN, NAN};
    const int n = l->frames;
    if (getloadavg(load, 3) < 1) load[0] = NAN;
    for (int s = 0; s < STAGES; s++) {
        double *t = l->time_s[s];
        qsort(t, (size_t)n, sizeof *t, bench_by_value);
        snprintf(what, sizeof what, "a host's loop, 256 x 256, %s: %s", l->of->name, stage_name[s]);
        BenchRow row = bench_row(what);
        row.median = at_share(t, n, 0.5);
        row.best = t[0];
        row.low = at_share(t, n, 0.25);
        row.high = at_share(t, n, 0.75);
        row.unit = "s";
        row.error = at_share(t, n, 0.99);
        row.error_unit = "s";
        row.against = "99 % of the frames";
        if (s == WHOLE) {
            row.rate = 1 / row.median;
            row.rate_unit = "frames/s";
            snprintf(beside, sizeof beside, "99 %% of the frames; 90 %%: %.2f ms, longest: %.2f ms, load average %.1f",
                     1e3 * at_share(t, n, 0.9), 1e3 * t[n - 1], load[0]);
            row.against = beside;
        }
        bench_add(l->bench, &row);
    }
}

static void add_processor(const Loop *l)
{
    char what[160];
    snprintf(what, sizeof what, "a host's loop, 256 x 256, %s: processor time of the node, a frame", l->of->name);
    BenchRow row = bench_row(what);
    row.median = row.best = l->processor_s;
    row.unit = "s";
    bench_add(l->bench, &row);
}

static Status run_case(Bench *bench, const Case *of, int index)
{
    Loop *l = calloc(1, sizeof *l);
    if (!l) return STATUS_NO_MEMORY;
    const int base = 20000 + (int)((getpid() * 11L + 10L * index) % 12000);
    *l = (Loop){.bench = bench,
                .of = of,
                .node_port = base,
                .host_port = base + 1,
                .frames = bench_quick(bench) ? frames_quick : frames_most,
                .lat_deg = 35.9925,
                .lon_deg = -123,
                .height_m = 270, /* 150 m above the ground there */
                .pitch_deg = -10};
    snprintf(l->memory, sizeof l->memory, "pitviper_bench_loop_%d", (int)getpid());
    l->cigi = open_socket(l->host_port);
    l->answers = open_socket(l->host_port + 2);
    Status status = l->cigi >= 0 && l->answers >= 0 && temp_folder(l->folder) && temp_file(l->exercise, ".yaml") &&
                            temp_file(l->log, ".pcap")
                        ? STATUS_OK
                        : STATUS_IO;
    FILE  *file = status == STATUS_OK ? output_file(l->exercise, 0) : NULL;
    if (!file || fputs(scenario, file) < 0 || fclose(file) != 0) status = STATUS_IO;
    bench_progress(bench, of->name);
    if (status == STATUS_OK) status = run_all(l);
    if (status == STATUS_OK) add_rows(l);
    if (status == STATUS_OK) add_processor(l);
    else log_error("bench: loop: %s: %s", of->name, status_name(status));
    if (l->cigi >= 0) close(l->cigi);
    if (l->answers >= 0) close(l->answers);
    remove(l->exercise);
    remove(l->log);
    char path[temp_path_size + 16];
    snprintf(path, sizeof path, "%s/run.json", l->folder);
    remove(path);
    remove(l->folder);
    free(l);
    return status;
}

Status bench_loop(Bench *bench)
{
    Status status = STATUS_OK;
    for (int i = 0; i < (int)(sizeof cases / sizeof *cases); i++) {
        const Status one = run_case(bench, &cases[i], i);
        if (status == STATUS_OK) status = one;
    }
    return status;
}
