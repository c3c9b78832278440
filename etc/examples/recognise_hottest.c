/* etc/examples/recognise_hottest.c: the hottest pixel, answered to a living node: recognise_hottest.py in C.
 *
 *     cc -O2 -I etc/include etc/examples/recognise_hottest.c -lm -o recognise_hottest
 *     pitviper run --memory seeker --set publish.detections_port=3456 ...      in one terminal
 *     ./recognise_hottest seeker [BAND]                                        in another
 *
 * Without BAND the first of lwir, mwir and optical that the ring has; of colour the mean. What is answered is printed,
 * a line per frame: its number, box (left, top, right, bottom, px), score, track. It waits for the node to start (60 s)
 * and ends with it. */
#include <pitviper_memory.h>

#include <arpa/inet.h>
#include <math.h>
#include <netinet/in.h>
#include <stdio.h>
#include <sys/socket.h>

enum {
    reach_px = 32, /* surroundings of the brightest pixel on each side, and the farthest that a box reaches */
    side_px = 2 * reach_px + 1,
    patience = 5, /* frames without a detection after which a track ends */
};
static const double level = 0.1;  /* of the way from their median to it: what is above belongs to the box */
static const float  gate = 0.08f; /* farthest step of a track from one frame to the next, over the width of the image */

typedef struct Plane {
    int    width, height;
    float *value, *median; /* [height * width]; median: of 5 x 5 */
} Plane;

typedef struct Found {
    int   left, top, right, bottom; /* px, the last two beyond it; right 0: nothing */
    float score;
} Found;

typedef struct Track {
    uint32_t number; /* 0: none yet */
    int      frame;
    float    column, row;
} Track;

static int by_value(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* As numpy's: of an even count the mean of the two in the middle. Sorts the values. */
static float median(float *value, int count)
{
    qsort(value, (size_t)count, sizeof *value, by_value);
    return count % 2 ? value[count / 2] : (value[count / 2 - 1] + value[count / 2]) / 2;
}

static int within(int value, int count) { return value < 0 ? 0 : value >= count ? count - 1 : value; }

/* Median of 5 x 5, the margin repeated: without defective pixels and small clumps of them. */
static void despeckle(Plane *p)
{
    for (int y = 0; y < p->height; y++)
        for (int x = 0; x < p->width; x++) {
            float near[25];
            int   n = 0;
            for (int dy = -2; dy <= 2; dy++)
                for (int dx = -2; dx <= 2; dx++)
                    near[n++] = p->value[within(y + dy, p->height) * p->width + within(x + dx, p->width)];
            p->median[y * p->width + x] = median(near, n);
        }
}

/* Grows from one pixel of the surroundings to all that is above the threshold and connected with it, by sides. */
static void grow(Found *box, const float *near, int width, int height, int x, int y, float threshold)
{
    static unsigned char seen[side_px * side_px];
    static int           stack[side_px * side_px];
    int                  count = 0;
    memset(seen, 0, sizeof seen);
    seen[y * width + x] = 1;
    stack[count++] = y * width + x;
    *box = (Found){.left = x, .top = y, .right = x + 1, .bottom = y + 1};
    while (count > 0) {
        const int at = stack[--count], column = at % width, row = at / width;
        const int next[4][2] = {{column - 1, row}, {column + 1, row}, {column, row - 1}, {column, row + 1}};
        if (column < box->left) box->left = column;
        if (column + 1 > box->right) box->right = column + 1;
        if (row < box->top) box->top = row;
        if (row + 1 > box->bottom) box->bottom = row + 1;
        for (int i = 0; i < 4; i++) {
            const int c = next[i][0], r = next[i][1];
            if (c < 0 || c >= width || r < 0 || r >= height) continue;
            if (seen[r * width + c] || !(near[r * width + c] > threshold)) continue;
            seen[r * width + c] = 1;
            stack[count++] = r * width + c;
        }
    }
}

static Found hottest(const Plane *p)
{
    static float near[side_px * side_px], sorted[side_px * side_px];
    int          at = 0, count = 0;
    Found        found;
    for (int i = 1; i < p->width * p->height; i++)
        if (p->median[i] > p->median[at]) at = i;
    const int column = at % p->width, row = at / p->width;
    const int left = column > reach_px ? column - reach_px : 0, top = row > reach_px ? row - reach_px : 0;
    const int right = column + reach_px + 1 < p->width ? column + reach_px + 1 : p->width;
    const int bottom = row + reach_px + 1 < p->height ? row + reach_px + 1 : p->height;
    for (int y = top; y < bottom; y++)
        for (int x = left; x < right; x++) near[count++] = p->median[y * p->width + x];
    memcpy(sorted, near, (size_t)count * sizeof *near);
    const float middle = median(sorted, count), peak = p->median[at];
    if (!(peak > middle)) return (Found){0}; /* an image of one value */
    grow(&found, near, right - left, bottom - top, column - left, row - top,
         (float)(middle + level * ((double)peak - middle)));
    for (int i = 0; i < count; i++) sorted[i] = fabsf(near[i] - middle);
    found.score = (peak - middle) / (peak - middle + 10 * median(sorted, count));
    found.left += left, found.right += left, found.top += top, found.bottom += top;
    return found;
}

/* The planes of a band as one. 1: done; 0: no memory. */
static int take_band(Plane *p, const PitviperMemory *m, uint32_t band)
{
    int channels = 0;
    for (uint32_t k = 0; k < m->header.plane_count; k++) {
        const PitviperMemoryPlane *from = &m->plane[k];
        const void                *values = pitviper_memory_plane(m, k);
        const int                  count = (int)(from->width * from->height);
        if (from->band != band || !values) continue;
        if (!p->value) {
            p->width = (int)from->width, p->height = (int)from->height;
            p->value = malloc((size_t)count * sizeof *p->value);
            p->median = malloc((size_t)count * sizeof *p->median);
            if (!p->value || !p->median) return 0;
        }
        for (int i = 0; i < count; i++) {
            const float v =
                from->type == PITVIPER_PLANE_FLOAT32 ? ((const float *)values)[i] : ((const uint16_t *)values)[i];
            p->value[i] = channels ? p->value[i] + v : v;
        }
        channels++;
    }
    for (int i = 0; channels > 1 && i < p->width * p->height; i++) p->value[i] /= (float)channels;
    return 1;
}

/* Continues the track, or begins the next: there is one detection a frame at most. */
static void follow(Track *track, const Found *f, int frame, int width)
{
    const float column = 0.5f * (float)(f->left + f->right), row = 0.5f * (float)(f->top + f->bottom);
    if (track->number == 0 || frame - track->frame > patience ||
        hypotf(column - track->column, row - track->row) > gate * (float)width)
        track->number++;
    track->frame = frame, track->column = column, track->row = row;
}

static void answer(int to, const PitviperMemory *m, uint32_t band, const Found *f, const Track *track)
{
    const struct sockaddr_in node = {.sin_family = AF_INET,
                                     .sin_port = htons((uint16_t)m->header.detections_port),
                                     .sin_addr = {.s_addr = htonl(INADDR_LOOPBACK)}};
    PitviperDetections       d;
    memset(&d, 0, sizeof d);
    memcpy(d.magic, PITVIPER_DETECTIONS_MAGIC, sizeof d.magic);
    d.byte_order = PITVIPER_MEMORY_BYTE_ORDER;
    d.version = PITVIPER_DETECTIONS_VERSION;
    d.detection_size = sizeof d.detection[0];
    d.frame = m->record.frame;
    d.band = band;
    d.count = f->right > 0;
    if (d.count) {
        d.detection[0].left = (float)f->left, d.detection[0].top = (float)f->top;
        d.detection[0].right = (float)f->right, d.detection[0].bottom = (float)f->bottom;
        d.detection[0].score = f->score;
        d.detection[0].track = track->number;
        strcpy(d.detection[0].class_name, "hot");
    }
    if (sendto(to, &d, PITVIPER_DETECTIONS_SIZE(d.count), 0, (const struct sockaddr *)&node, sizeof node) < 0)
        perror("recognise_hottest: send");
}

/* By its name, or the first of those preferred; -1: the ring has none. */
static int band_of(const PitviperMemory *m, const char *name)
{
    const char *const preferred[] = {name ? name : "lwir", name ? name : "mwir", name ? name : "optical"};
    for (int i = 0; i < 3; i++)
        for (uint32_t k = 0; k < m->header.plane_count; k++)
            if (strcmp(m->plane[k].band_name, preferred[i]) == 0) return (int)m->plane[k].band;
    return -1;
}

/* Until the node ends; else an error. */
static int recognise(PitviperMemory *m, int band)
{
    const int to = socket(AF_INET, SOCK_DGRAM, 0);
    Plane     plane = {0};
    Track     track = {0};
    int       result;
    while ((result = pitviper_memory_wait(m, -1)) == 1) {
        if (pitviper_memory_take_newest(m) != 1) continue;
        if (!take_band(&plane, m, (uint32_t)band)) {
            result = PITVIPER_MEMORY_SYSTEM;
            break;
        }
        despeckle(&plane);
        const Found found = hottest(&plane);
        if (found.right > 0) follow(&track, &found, m->record.frame, plane.width);
        if (m->header.detections_port) answer(to, m, (uint32_t)band, &found, &track);
        printf("%d %d %d %d %d %.4f %u\n", m->record.frame, found.left, found.top, found.right, found.bottom,
               (double)found.score, track.number);
        fflush(stdout);
    }
    free(plane.value);
    free(plane.median);
    close(to);
    return result;
}

int main(int argc, char **argv)
{
    PitviperMemory m;
    int            result = PITVIPER_MEMORY_ABSENT;
    if (argc < 2 || argc > 3) {
        fprintf(stderr, "usage: recognise_hottest NAME [BAND]\n");
        return 1;
    }
    for (int tries = 0; tries < 6000 && (result == PITVIPER_MEMORY_ABSENT || result == PITVIPER_MEMORY_ENDED);
         tries++) {
        result = pitviper_memory_open(&m, argv[1]);
        if (result < 0) usleep(10000);
    }
    if (result < 0) {
        fprintf(stderr, "recognise_hottest: %s/%s: %s\n", PITVIPER_MEMORY_FOLDER, argv[1],
                pitviper_memory_error(result));
        return 1;
    }
    const int band = band_of(&m, argc > 2 ? argv[2] : NULL);
    if (band < 0) fprintf(stderr, "recognise_hottest: the ring has no such band: lwir, mwir or optical\n");
    else if (m.header.detections_port == 0)
        fprintf(stderr, "recognise_hottest: the node takes no detections; set publish.detections_port\n");
    result = band < 0 ? 0 : recognise(&m, band);
    pitviper_memory_close(&m);
    if (band >= 0 && result == PITVIPER_MEMORY_ENDED) return 0;
    if (result < 0) fprintf(stderr, "recognise_hottest: %s\n", pitviper_memory_error(result));
    return 1;
}
