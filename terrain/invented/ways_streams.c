/* terrain/invented/ways_streams.c: streams, ponds and gullies along the descent of the ground, and how wet or worn the
 * ground is. A coarse grid tells where water gathers; from there each stream is followed downhill on the terrain. */
#include "terrain/invented/ways_private.h"

#include <stdlib.h>

static const double stream_cells = 34,
                    gully_cells =
                        5; /* coarse cells that must drain through a place for a stream, and a gully, to start there */
enum { most_steps = 4000 };

/* ---- coarse grid ------------------------------------------------------------------------------ */

/* Number of the lowest neighbour of a post, -1: none is lower. */
static int lowest_neighbour(const Ways *ways, int at)
{
    const int i = at % ways->cx, j = at / ways->cx;
    double    best = 0;
    int       found = -1;
    for (int n = 0; n < 9; n++) {
        const int ni = i + n % 3 - 1, nj = j + n / 3 - 1;
        if (n == 4 || ni < 0 || nj < 0 || ni >= ways->cx || nj >= ways->cy) continue;
        const int    to = nj * ways->cx + ni;
        const double fall = (double)(ways->height[at] - ways->height[to]) / (n % 2 ? 1 : 1.41421356);
        if (fall > best) best = fall, found = to;
    }
    return found;
}

typedef struct Ranked {
    float height;
    int   at;
} Ranked;

static int by_height_down(const void *pa, const void *pb)
{
    const Ranked *a = pa, *b = pb;
    if (a->height != b->height) return a->height < b->height ? 1 : -1;
    return (a->at > b->at) - (a->at < b->at);
}

static Status gather_flow(Ways *ways, const WaysGround *ground)
{
    const int posts = ways->cx * ways->cy;
    ways->height = malloc((size_t)posts * sizeof *ways->height);
    ways->flow = malloc((size_t)posts * sizeof *ways->flow);
    Ranked *order = malloc((size_t)posts * sizeof *order);
    if (!ways->height || !ways->flow || !order) {
        free(order);
        return STATUS_NO_MEMORY;
    }
    for (int n = 0; n < posts; n++) {
        const double x = fmin((n % ways->cx) * ways->coarse_m, ways->side_m[0] - 0.01);
        const double y = fmin((n / ways->cx) * ways->coarse_m, ways->side_m[1] - 0.01);
        const double h = ways_height(ways, ground, x, y);
        ways->height[n] = isfinite(h) ? (float)h : 0;
        ways->flow[n] = 1;
        order[n] = (Ranked){ways->height[n], n};
    }
    qsort(order, (size_t)posts, sizeof *order, by_height_down);
    for (int n = 0; n < posts; n++) {
        const int to = lowest_neighbour(ways, order[n].at);
        if (to >= 0) ways->flow[to] += ways->flow[order[n].at];
    }
    free(order);
    return STATUS_OK;
}

/* How wet or worn the ground is: hollows and valleys are wet, crests worn. It follows from the height relative to the
 * mean of the neighbours, and from the flow. */
static double wet_at(const Ways *ways, int i, int j)
{
    static const double deep_m = 1.6;
    double              sum = 0;
    i = i < 0 ? 0 : i >= ways->cx ? ways->cx - 1 : i, j = j < 0 ? 0 : j >= ways->cy ? ways->cy - 1 : j;
    if (i < 1 || j < 1 || i > ways->cx - 2 || j > ways->cy - 2) return 0;
    const int at = j * ways->cx + i;
    for (int n = 0; n < 9; n++)
        if (n != 4) sum += (double)ways->height[at + (n / 3 - 1) * ways->cx + n % 3 - 1] / 8;
    const double hollow = clamp((sum - (double)ways->height[at]) / deep_m, -1, 1);
    const double flow = clamp(log2((double)ways->flow[at]) / 6, 0, 1);
    return clamp(0.75 * hollow + (hollow > 0 ? 0.35 : 0.1) * flow, -1, 1);
}

static Status measure_wet(Ways *ways)
{
    const int posts = ways->cx * ways->cy;
    ways->wet = malloc((size_t)posts * sizeof *ways->wet);
    uint8_t *one = malloc((size_t)posts);
    if (!ways->wet || !one) {
        free(one);
        return STATUS_NO_MEMORY;
    }
    for (int n = 0; n < posts; n++) one[n] = (uint8_t)(128 + rint(127 * wet_at(ways, n % ways->cx, n / ways->cx)));
    for (int n = 0; n < posts; n++) {
        const int i = n % ways->cx, j = n / ways->cx;
        const int east = i + 1 < ways->cx ? 1 : 0, north = j + 1 < ways->cy ? ways->cx : 0;
        ways->wet[n] = one[n] | (uint32_t)one[n + east] << 8 | (uint32_t)one[n + north] << 16 |
                       (uint32_t)one[n + east + north] << 24;
    }
    free(one);
    return STATUS_OK;
}

/* ---- following the descent -------------------------------------------------------------------- */

static const double step_m = 10, arm_m = 14;

typedef enum TraceEnd { TRACE_PIT, TRACE_RIM, TRACE_SEA, TRACE_JOINED } TraceEnd;

typedef struct Trace {
    double   p[most_steps][2];
    int      count;
    TraceEnd end;
    int      joined; /* segment of another stream that it joins */
} Trace;

/* The streams laid so far by place: for each square of 12 m the start of a segment, by open addressing. */
typedef struct Laid {
    uint64_t *key;
    int32_t  *segment;
    uint32_t  mask, count;
} Laid;

static const double laid_m = 12;

static uint64_t laid_key(double x, double y)
{
    return ((uint64_t)(int64_t)floor(x / laid_m) << 32 | (uint64_t)(uint32_t)(int64_t)floor(y / laid_m)) + 1;
}

static int laid_find(const Laid *laid, double x, double y)
{
    const uint64_t key = laid_key(x, y);
    for (uint32_t at = (uint32_t)invented_hash(1, (int64_t)key, 0) & laid->mask; laid->key[at];
         at = (at + 1) & laid->mask)
        if (laid->key[at] == key) return laid->segment[at];
    return -1;
}

static void laid_put(Laid *laid, double x, double y, int segment)
{
    const uint64_t key = laid_key(x, y);
    uint32_t       at = (uint32_t)invented_hash(1, (int64_t)key, 0) & laid->mask;
    while (laid->key[at] && laid->key[at] != key) at = (at + 1) & laid->mask;
    if (laid->key[at] || laid->count > laid->mask / 2) return;
    laid->key[at] = key, laid->segment[at] = segment;
    laid->count++;
}

/* Finds a lower place on rings about a pit, from which the stream goes on as if it had cut through. */
static bool lower_about(double out[2], const Ways *ways, const WaysGround *ground, const double p[2], double h)
{
    for (double r = 20; r <= 100; r += 20) {
        double best = h - 0.01;
        bool   found = false;
        for (int n = 0; n < 16; n++) {
            const double angle = n * (2 * 3.14159265358979 / 16);
            const double x = p[0] + r * cos(angle), y = p[1] + r * sin(angle);
            const double here = ways_height(ways, ground, x, y);
            if (here < best) best = here, found = true, out[0] = x, out[1] = y;
        }
        if (found) return true;
    }
    return false;
}

static void follow(Trace *t, const Ways *ways, const WaysGround *ground, const Laid *laid, double x, double y)
{
    double dir[2] = {0, 0}, h = ways_height(ways, ground, x, y);
    t->count = 0;
    t->end = TRACE_PIT;
    while (t->count < most_steps) {
        t->p[t->count][0] = x, t->p[t->count][1] = y;
        t->count++;
        if (x < 2 || y < 2 || x > ways->side_m[0] - 2 || y > ways->side_m[1] - 2) {
            t->end = TRACE_RIM;
            return;
        }
        if (ground->coast->sea_count && coast_at(ground->coast, ways->x0_m + x, ways->y0_m + y) == COAST_SEA) {
            t->end = TRACE_SEA;
            return;
        }
        const int met = laid_find(laid, x, y);
        if (met >= 0 && t->count > 1) { /* goes on to the end of that segment, if that is lower */
            const WaySegment *s = &ways->segment[met];
            const double      ex = (double)(s->x_m + s->dx * s->length_m), ey = (double)(s->y_m + s->dy * s->length_m);
            if (ways_height(ways, ground, ex, ey) < h && t->count < most_steps) {
                t->p[t->count][0] = ex, t->p[t->count][1] = ey;
                t->count++;
                t->end = TRACE_JOINED;
                t->joined = met;
                return;
            }
        }
        const double gx = ways_height(ways, ground, x + arm_m, y) - ways_height(ways, ground, x - arm_m, y);
        const double gy = ways_height(ways, ground, x, y + arm_m) - ways_height(ways, ground, x, y - arm_m);
        const double steep = hypot(gx, gy);
        bool         moved = false;
        for (int straight = 1; straight >= 0 && steep > 1e-9 && !moved;
             straight--) { /* tries with the stream's momentum, then without */
            const double ax = -gx / steep + 0.8 * straight * dir[0], ay = -gy / steep + 0.8 * straight * dir[1];
            const double length = fmax(hypot(ax, ay), 1e-6);
            const double nx = x + step_m * ax / length, ny = y + step_m * ay / length;
            const double next = ways_height(ways, ground, nx, ny);
            if (!(next < h)) continue;
            dir[0] = ax / length, dir[1] = ay / length;
            x = nx, y = ny, h = next, moved = true;
        }
        if (moved) continue;
        double to[2] = {x, y};
        if (!lower_about(to, ways, ground, (double[2]){x, y}, h)) return;
        const double length = hypot(to[0] - x, to[1] - y);
        dir[0] = (to[0] - x) / length, dir[1] = (to[1] - y) / length;
        x = to[0], y = to[1], h = ways_height(ways, ground, x, y);
    }
    t->count = 0; /* it does not end, so it is not laid */
}

/* ---- ponds ------------------------------------------------------------------------------------ */

static Status lay_pond(Ways *ways, const WaysGround *ground, const double p[2])
{
    static const double most_m = 55, least_m = 7, deep_m = 0.3, march_m = 3;
    const Status status = ways_reserve((void **)&ways->pond, &ways->ponds_room, ways->ponds + 1, sizeof *ways->pond);
    if (status != STATUS_OK) return status;
    Pond         pond = {.x_m = (float)p[0], .y_m = (float)p[1]};
    const double level_m = ways_height(ways, ground, p[0], p[1]) + deep_m;
    for (int n = 0; n < pond_radii; n++) {
        /* directions evenly spaced along a square, as pond_radius takes them */
        const double turn = 4.0 * n / pond_radii, s = turn <= 1 ? turn : turn <= 3 ? 2 - turn : turn - 4;
        const double c = (1 - fabs(s)) * (turn <= 1 || turn >= 3 ? 1 : -1), length = hypot(c, s);
        double       r = least_m;
        while (r < most_m && ways_height(ways, ground, p[0] + r * c / length, p[1] + r * s / length) < level_m)
            r += march_m;
        pond.radius_m[n] = (float)r;
    }
    for (int pass = 0; pass < 2; pass++) { /* smooths the outline */
        float       before = pond.radius_m[pond_radii - 1];
        const float first = pond.radius_m[0];
        for (int n = 0; n < pond_radii; n++) {
            const float here = pond.radius_m[n], after = n + 1 < pond_radii ? pond.radius_m[n + 1] : first;
            pond.radius_m[n] = 0.25f * before + 0.5f * here + 0.25f * after;
            before = here;
        }
    }
    for (int n = 0; n < pond_radii; n++) pond.most_m = fmaxf(pond.most_m, pond.radius_m[n]);
    /* a hollow where a vehicle was reported holds no water */
    if (!ways_vehicle_near(ways, p[0], p[1], fmin((double)pond.most_m + 4, 96))) ways->pond[ways->ponds++] = pond;
    return STATUS_OK;
}

/* ---- laying ----------------------------------------------------------------------------------- */

static double flow_at(const Ways *ways, const double p[2])
{
    const int i = (int)clamp(p[0] / ways->coarse_m + 0.5, 0, ways->cx - 1);
    const int j = (int)clamp(p[1] / ways->coarse_m + 0.5, 0, ways->cy - 1);
    return (double)ways->flow[j * ways->cx + i];
}

static Status lay_stream(Ways *ways, const WaysGround *ground, Laid *laid, Trace *t)
{
    const int last = t->count - 1;
    if (t->end == TRACE_PIT) {
        bool known = false;
        for (int n = 0; n < ways->ponds && !known; n++)
            known = hypot((double)ways->pond[n].x_m - t->p[last][0], (double)ways->pond[n].y_m - t->p[last][1]) < 40;
        const Status status = known ? STATUS_OK : lay_pond(ways, ground, t->p[last]);
        if (status != STATUS_OK) return status;
    }
    const double half_m = 0.5, end_m = clamp(0.5 + 0.12 * sqrt(flow_at(ways, t->p[last])), 0.6, 3.2);
    const int    first = ways->segments;
    const Status status = ways_append(ways, WAY_STREAM, (const double(*)[2])t->p, t->count, half_m, end_m);
    for (int n = first; n < ways->segments; n++)
        laid_put(laid, (double)ways->segment[n].x_m, (double)ways->segment[n].y_m, n);
    return status;
}

/* Lays a gully, which is short, steep and dry: down to where it is gentle, or to the next stream. */
static Status lay_gully(Ways *ways, const WaysGround *ground, Laid *laid, Trace *t)
{
    static const double steep = 0.09;
    int                 count = 1;
    while (count < t->count) {
        const double fall = ways_height(ways, ground, t->p[count - 1][0], t->p[count - 1][1]) -
                            ways_height(ways, ground, t->p[count][0], t->p[count][1]);
        if (fall < steep * 0.6 * step_m && count > 3) break;
        count++;
    }
    if (count < 8) return STATUS_OK;
    const int    first = ways->segments;
    const Status status = ways_append(ways, WAY_GULLY, (const double(*)[2])t->p, count, 0.4, 1.4);
    for (int n = first; n < ways->segments; n++)
        laid_put(laid, (double)ways->segment[n].x_m, (double)ways->segment[n].y_m, n);
    return status;
}

/* Whether the flow first reaches a limit here: no neighbour that drains into it has as much. */
static bool is_head(const Ways *ways, int at, double limit)
{
    const int i = at % ways->cx, j = at / ways->cx;
    if ((double)ways->flow[at] < limit || i < 1 || j < 1 || i > ways->cx - 2 || j > ways->cy - 2) return false;
    for (int n = 0; n < 9; n++) {
        const int from = at + (n / 3 - 1) * ways->cx + n % 3 - 1;
        if (n != 4 && (double)ways->flow[from] >= limit && lowest_neighbour(ways, from) == at) return false;
    }
    return true;
}

Status ways_lay_streams(Ways *ways, const WaysGround *ground)
{
    static const double gully_slope = 0.12;
    Laid                laid = {.mask = (1 << 17) - 1};
    Trace              *t = malloc(sizeof *t);
    Status              status = gather_flow(ways, ground);
    if (status == STATUS_OK) status = measure_wet(ways);
    laid.key = calloc((size_t)laid.mask + 1, sizeof *laid.key);
    laid.segment = calloc((size_t)laid.mask + 1, sizeof *laid.segment);
    if (!t || !laid.key || !laid.segment) status = STATUS_NO_MEMORY;
    for (int pass = 0; pass < 2; pass++)
        for (int at = 0; at < ways->cx * ways->cy && status == STATUS_OK; at++) {
            if (!is_head(ways, at, pass ? gully_cells : stream_cells)) continue;
            const int    to = lowest_neighbour(ways, at);
            const double x = (at % ways->cx) * ways->coarse_m, y = (at / ways->cx) * ways->coarse_m;
            if (to < 0) continue;
            const double fall = (double)(ways->height[at] - ways->height[to]) / ways->coarse_m;
            if (pass && fall < gully_slope) continue;
            follow(t, ways, ground, &laid, x, y);
            if (t->count < 6) continue;
            status = pass ? lay_gully(ways, ground, &laid, t) : lay_stream(ways, ground, &laid, t);
        }
    free(t), free(laid.key), free(laid.segment);
    return status;
}
