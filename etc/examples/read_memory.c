/* etc/examples/read_memory.c: reads the frames that a Pitviper node puts into shared memory.
 *
 *     cc -O2 -I etc/include etc/examples/read_memory.c -o read_memory
 *     pitviper run --memory seeker ...                          in one terminal
 *     ./read_memory seeker                                      in another
 *
 * A line per frame: its number, exercise time, age, the brightest pixel of each plane, targets (publish.memory_record:
 * truth). It waits for the node to start and ends with it.
 *
 *     --in-order      every frame that the ring still holds, in order; default: the newest, skipping older ones
 *     --frames N      ends after so many
 *     --wait S        gives up when there is no node after so many seconds; default: 60
 *     --raw FOLDER    each plane as FOLDER/FRAME_BAND_NAME.raw: values row by row, in the machine's byte order
 *     --slow MS       waits that long after each frame, as a recogniser that computes
 *     --detect        sends the brightest spot of each band back as a detection (publish.detections_port)
 *
 * Exit code 0: the node ended, or N frames were read. 1: no node, or another error. */
#include <pitviper_memory.h>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <stdio.h>
#include <sys/socket.h>

typedef struct Options {
    const char *name, *raw;
    long        frames;
    double      wait_s, slow_ms;
    int         in_order, detect;
} Options;

typedef struct Brightest {
    double   value;
    uint32_t column, row;
} Brightest;

static Brightest brightest(const PitviperMemory *m, uint32_t k)
{
    const PitviperMemoryPlane *p = &m->plane[k];
    const void                *plane = pitviper_memory_plane(m, k);
    Brightest                  best = {-1e300, 0, 0};
    for (uint32_t row = 0; row < p->height; row++)
        for (uint32_t column = 0; column < p->width; column++) {
            const size_t i = (size_t)row * p->width + column;
            const double value = p->type == PITVIPER_PLANE_FLOAT32 ? (double)((const float *)plane)[i]
                                                                   : (double)((const uint16_t *)plane)[i];
            if (value > best.value) best = (Brightest){value, column, row};
        }
    return best;
}

static void show(const PitviperMemory *m)
{
    const PitviperMemoryRecord *r = &m->record;
    const int64_t               now_ns = pitviper_memory_now_ns();
    printf("frame %d  %.3f s  %.3f ms since written, %.3f ms since rendered", r->frame, r->time_s,
           1e-6 * (double)(now_ns - r->written_ns), 1e-6 * (double)(now_ns - r->rendered_ns));
    for (uint32_t k = 0; k < m->header.plane_count; k++) {
        const Brightest b = brightest(m, k);
        printf("  %s/%s %.9g at %u,%u", m->plane[k].band_name, m->plane[k].name, b.value, b.column, b.row);
    }
    for (uint32_t i = 0; i < r->target_count; i++) {
        PitviperMemoryTarget t;
        if (pitviper_memory_target(&t, m, i))
            printf("  %s %u:%u:%u box %d %d %d %d range %.1f m", t.class_name, t.site, t.application, t.entity,
                   t.box[0], t.box[1], t.box[2], t.box[3], t.range_m);
    }
    printf("\n");
    fflush(stdout);
}

static int dump(const PitviperMemory *m, const char *folder)
{
    for (uint32_t k = 0; k < m->header.plane_count; k++) {
        const PitviperMemoryPlane *p = &m->plane[k];
        char                       path[4096];
        snprintf(path, sizeof path, "%s/%06d_%s_%s.raw", folder, m->record.frame, p->band_name, p->name);
        FILE        *file = fopen(path, "wb");
        const size_t size = p->type == PITVIPER_PLANE_FLOAT32 ? 4 : 2, count = (size_t)p->width * p->height;
        int          good = file && fwrite(pitviper_memory_plane(m, k), size, count, file) == count;
        if (file && fclose(file) != 0) good = 0;
        if (!good) {
            perror(path);
            return 0;
        }
    }
    return 1;
}

/* The brightest spot of each band, with a box of 9 x 9 pixels about it. */
static void detect(const PitviperMemory *m, int to)
{
    const struct sockaddr_in node = {.sin_family = AF_INET,
                                     .sin_port = htons((uint16_t)m->header.detections_port),
                                     .sin_addr = {.s_addr = htonl(INADDR_LOOPBACK)}};
    for (uint32_t k = 0; k < m->header.plane_count; k++) {
        const PitviperMemoryPlane *p = &m->plane[k];
        if (k > 0 && p->band == m->plane[k - 1].band) continue; /* of a colour picture, R */
        const Brightest    b = brightest(m, k);
        PitviperDetections d;
        memset(&d, 0, sizeof d);
        memcpy(d.magic, PITVIPER_DETECTIONS_MAGIC, sizeof d.magic);
        d.byte_order = PITVIPER_MEMORY_BYTE_ORDER;
        d.version = PITVIPER_DETECTIONS_VERSION;
        d.detection_size = sizeof d.detection[0];
        d.frame = m->record.frame;
        d.band = p->band;
        d.count = 1;
        d.detection[0].left = b.column < 4 ? 0 : (float)b.column - 4;
        d.detection[0].top = b.row < 4 ? 0 : (float)b.row - 4;
        d.detection[0].right = b.column + 5 > p->width ? (float)p->width : (float)b.column + 5;
        d.detection[0].bottom = b.row + 5 > p->height ? (float)p->height : (float)b.row + 5;
        d.detection[0].score = 0.5f;
        d.detection[0].track = 1;
        strcpy(d.detection[0].class_name, "bright");
        if (sendto(to, &d, PITVIPER_DETECTIONS_SIZE(1), 0, (const struct sockaddr *)&node, sizeof node) < 0)
            perror("send");
    }
}

/* Until the node ends: 1; or enough frames were read: 0. Negative: an error of the reader. */
static int read_frames(PitviperMemory *m, const Options *o)
{
    const int to = o->detect ? socket(AF_INET, SOCK_DGRAM, 0) : -1;
    int       result = 0;
    long      frames = 0;
    if (o->detect && m->header.detections_port == 0)
        fprintf(stderr, "read_memory: the node takes no answers; set publish.detections_port\n");
    while ((o->frames == 0 || frames < o->frames) && (result = pitviper_memory_wait(m, -1)) == 1) {
        if ((o->in_order ? pitviper_memory_take_next(m) : pitviper_memory_take_newest(m)) != 1) continue;
        frames++;
        show(m);
        if (o->raw && !dump(m, o->raw)) return PITVIPER_MEMORY_SYSTEM;
        if (o->detect && m->header.detections_port) detect(m, to);
        if (o->slow_ms > 0) usleep((useconds_t)(1000 * o->slow_ms));
    }
    if (to >= 0) close(to);
    printf("%ld frames read, %llu missed, %llu copies torn\n", frames, (unsigned long long)m->missed,
           (unsigned long long)m->torn);
    return o->frames > 0 && frames == o->frames ? 0 : result;
}

/* Waits for the node to start. */
static int open_ring(PitviperMemory *m, const Options *o)
{
    const int64_t end_ns = pitviper_memory_now_ns() + (int64_t)(1e9 * o->wait_s);
    int           result;
    /* absent: not started; ended: one that was killed, and not restarted */
    while ((result = pitviper_memory_open(m, o->name)) == PITVIPER_MEMORY_ABSENT || result == PITVIPER_MEMORY_ENDED) {
        if (pitviper_memory_now_ns() > end_ns) break;
        usleep(10000);
    }
    return result;
}

int main(int argc, char **argv)
{
    Options        o = {.wait_s = 60};
    PitviperMemory m;
    for (int i = 1; i < argc; i++) {
        const char *value = i + 1 < argc ? argv[i + 1] : "";
        if (strcmp(argv[i], "--in-order") == 0) o.in_order = 1;
        else if (strcmp(argv[i], "--detect") == 0) o.detect = 1;
        else if (strcmp(argv[i], "--frames") == 0) o.frames = atol(value), i++;
        else if (strcmp(argv[i], "--wait") == 0) o.wait_s = atof(value), i++;
        else if (strcmp(argv[i], "--slow") == 0) o.slow_ms = atof(value), i++;
        else if (strcmp(argv[i], "--raw") == 0) o.raw = value, i++;
        else if (!o.name && argv[i][0] != '-') o.name = argv[i];
        else o.name = NULL, i = argc;
    }
    if (!o.name) {
        fprintf(stderr, "usage: read_memory NAME [--in-order] [--frames N] [--wait S] [--raw FOLDER] [--slow MS] "
                        "[--detect]\n");
        return 1;
    }
    int result = open_ring(&m, &o);
    if (result < 0) {
        fprintf(stderr, "read_memory: %s/%s: %s\n", PITVIPER_MEMORY_FOLDER, o.name, pitviper_memory_error(result));
        return 1;
    }
    result = read_frames(&m, &o);
    pitviper_memory_close(&m);
    if (result == 0 || result == PITVIPER_MEMORY_ENDED) return 0;
    fprintf(stderr, "read_memory: %s\n", pitviper_memory_error(result));
    return 1;
}
