/* terrain/landscape/ways_roads.c: villages, roads between them along gentle slopes, lanes with plots, and tracks along
 * the routes of vehicles. Roads are found on the coarse grid and drawn as splines. */
#include "terrain/landscape/ways_private.h"

#include <stdlib.h>

static const double village_grid_m = 2600, vertex_m = 8;
static const double road_half_m = 3, lane_half_m = 2.2, track_half_m = 1.7;

/* ---- splines ---------------------------------------------------------------------------------- */

typedef struct Line {
    double (*p)[2];
    int    count, room;
} Line;

static Status line_add(Line *line, double x, double y)
{
    const Status status = ways_reserve((void **)&line->p, &line->room, line->count + 1, sizeof *line->p);
    if (status != STATUS_OK) return status;
    line->p[line->count][0] = x, line->p[line->count][1] = y;
    line->count++;
    return STATUS_OK;
}

/* A cubic B-spline about control points, through the first and the last, with a vertex every some metres. */
static Status draw_spline(Line *out, const Line *control)
{
    out->count = 0;
    const int n = control->count;
    if (n < 2) return STATUS_OK;
    Status status = line_add(out, control->p[0][0], control->p[0][1]);
    for (int k = -1; k < n && status == STATUS_OK; k++) {
        double c[4][2];
        for (int m = 0; m < 4; m++) /* mirrored beyond the ends */
            for (int a = 0; a < 2; a++) {
                const int i = k - 1 + m;
                c[m][a] = i < 0 ? 2 * control->p[0][a] - control->p[-i < n ? -i : n - 1][a]
                          : i >= n ? 2 * control->p[n - 1][a] - control->p[2 * n - 2 - i > 0 ? 2 * n - 2 - i : 0][a]
                                   : control->p[i][a];
            }
        if (k < 0 || k >= n - 1) continue;
        const int parts = (int)clamp(ceil(hypot(c[2][0] - c[1][0], c[2][1] - c[1][1]) / vertex_m), 1, 200);
        for (int s = 1; s <= parts && status == STATUS_OK; s++) {
            const double t = (double)s / parts, u = 1 - t;
            const double w[4] = {u * u * u / 6, (3 * t * t * t - 6 * t * t + 4) / 6,
                                 (3 * u * u * u - 6 * u * u + 4) / 6, t * t * t / 6};
            double       q[2] = {0, 0};
            for (int m = 0; m < 4; m++) q[0] += w[m] * c[m][0], q[1] += w[m] * c[m][1];
            status = line_add(out, q[0], q[1]);
        }
    }
    return status;
}

/* ---- routes ----------------------------------------------------------------------------------- */

typedef struct Open {
    float cost;
    int   at;
} Open;

typedef struct Search {
    float *cost;    /* [posts] so far */
    int   *from;    /* [posts] */
    float *dear;    /* [posts] factor of a post: vehicles, water */
    Open  *heap;
    int    heap_count, heap_room;
} Search;

static void search_free(Search *s)
{
    free(s->cost), free(s->from), free(s->dear), free(s->heap);
}

static Status heap_push(Search *s, Open o)
{
    const Status status = ways_reserve((void **)&s->heap, &s->heap_room, s->heap_count + 1, sizeof *s->heap);
    if (status != STATUS_OK) return status;
    int n = s->heap_count++;
    for (; n > 0 && s->heap[(n - 1) / 2].cost > o.cost; n = (n - 1) / 2) s->heap[n] = s->heap[(n - 1) / 2];
    s->heap[n] = o;
    return STATUS_OK;
}

static Open heap_pop(Search *s)
{
    const Open top = s->heap[0], last = s->heap[--s->heap_count];
    int        n = 0;
    for (int child = 1; child < s->heap_count; child = 2 * n + 1) {
        if (child + 1 < s->heap_count && s->heap[child + 1].cost < s->heap[child].cost) child++;
        if (s->heap[child].cost >= last.cost) break;
        s->heap[n] = s->heap[child];
        n = child;
    }
    s->heap[n] = last;
    return top;
}

/* Whole posts to a neighbour: sixteen directions, so that routes turn by half a right angle's half. */
static const int8_t neighbour[16][2] = {{1, 0},  {0, 1},  {-1, 0}, {0, -1}, {1, 1},  {-1, 1}, {-1, -1}, {1, -1},
                                        {2, 1},  {1, 2},  {-1, 2}, {-2, 1}, {-2, -1}, {-1, -2}, {1, -2}, {2, -1}};

static const double least_cost = 0.3; /* of a post's distance: along a road */

static double root_of(int di, int dj)
{
    return sqrt((double)(di * di + dj * dj));
}

/* Cheapest route between two posts; path from goal to start. Returns its length, 0: none. */
static Status find_route(int **path, int *count, Search *s, const Ways *ways, int start, int goal)
{
    const int posts = ways->cx * ways->cy;
    *path = NULL;
    *count = 0;
    for (int n = 0; n < posts; n++) s->cost[n] = INFINITY;
    s->heap_count = 0;
    s->cost[start] = 0, s->from[start] = -1;
    const int    gi = goal % ways->cx, gj = goal / ways->cx;
    double       run_of[16];
    for (int n = 0; n < 16; n++) run_of[n] = root_of(neighbour[n][0], neighbour[n][1]);
    Status       status = heap_push(s, (Open){0, start});
    while (s->heap_count && status == STATUS_OK) {
        const Open o = heap_pop(s);
        const int  at = o.at, i = at % ways->cx, j = at / ways->cx;
        if (at == goal) break;
        if ((double)o.cost > (double)s->cost[at] + least_cost * root_of(gi - i, gj - j) + 1e-3) continue; /* stale */
        for (int n = 0; n < 16 && status == STATUS_OK; n++) {
            const int ni = i + neighbour[n][0], nj = j + neighbour[n][1];
            if (ni < 0 || nj < 0 || ni >= ways->cx || nj >= ways->cy) continue;
            const int    to = nj * ways->cx + ni;
            const double run = run_of[n];
            const double slope = fabs((double)(ways->height[to] - ways->height[at])) / (run * ways->coarse_m);
            const bool   road = ways->road_vertex[at] >= 0 && ways->road_vertex[to] >= 0;
            const double each = 1 + 400 * slope * slope + 8 * slope;
            const double cost = (double)s->cost[at] +
                                run * each * (road ? least_cost : 0.5 * (double)(s->dear[at] + s->dear[to]));
            if (!(cost < (double)s->cost[to])) continue;
            s->cost[to] = (float)cost, s->from[to] = at;
            status = heap_push(s, (Open){(float)(cost + least_cost * root_of(gi - ni, gj - nj)), to});
        }
    }
    if (status != STATUS_OK || !(s->cost[goal] < INFINITY)) return status;
    for (int at = goal; at >= 0; at = s->from[at]) (*count)++;
    *path = malloc((size_t)*count * sizeof **path);
    if (!*path) return STATUS_NO_MEMORY;
    int n = 0;
    for (int at = goal; at >= 0; at = s->from[at]) (*path)[n++] = at;
    return STATUS_OK;
}

static int post_near(const Ways *ways, double x, double y)
{
    const int i = (int)clamp(rint(x / ways->coarse_m), 0, ways->cx - 1);
    const int j = (int)clamp(rint(y / ways->coarse_m), 0, ways->cy - 1);
    return j * ways->cx + i;
}

static Status lay_line(Ways *ways, WayKind kind, Line *line, double half_m)
{
    /* no road where a vehicle was reported: it ends before and goes on after */
    static const double near_m = 14;
    const int           first = ways->segments;
    Status              status = STATUS_OK;
    for (int n = 0, from = 0; n <= line->count && status == STATUS_OK; n++) {
        if (n < line->count && !ways_vehicle_near(ways, line->p[n][0], line->p[n][1], near_m)) continue;
        status = ways_append(ways, kind, (const double (*)[2])line->p + from, n - from, half_m, half_m);
        from = n + 1;
    }
    for (int n = first; n < ways->segments && kind == WAY_ROAD; n++)
        ways->road_vertex[post_near(ways, (double)ways->segment[n].x_m, (double)ways->segment[n].y_m)] = n;
    return status;
}

/* The pieces of a route that are not on roads yet, as roads; their ends on vertices of the roads they meet. */
static Status lay_route(Ways *ways, const int *path, int count)
{
    enum { skip = 3 };
    Line   control = {0}, line = {0};
    Status status = STATUS_OK;
    const int before = ways->segments;
    for (int n = 0; n < count && status == STATUS_OK;) {
        if (ways->road_vertex[path[n]] >= 0 && ways->road_vertex[path[n]] < before &&
            (n + 1 == count || ways->road_vertex[path[n + 1]] >= 0)) {
            n++;
            continue;
        }
        int end = n + 1;
        while (end < count && ways->road_vertex[path[end]] < 0) end++;
        if (end == count) end--;
        control.count = 0;
        for (int k = n; k <= end && status == STATUS_OK; k++) {
            const bool   tip = k == n || k == end;
            const int    met = tip ? ways->road_vertex[path[k]] : -1;
            double       x = (path[k] % ways->cx) * ways->coarse_m, y = (path[k] / ways->cx) * ways->coarse_m;
            if (met >= 0) x = (double)ways->segment[met].x_m, y = (double)ways->segment[met].y_m;
            if (tip || ((k - n) % skip == 0 && end - k >= 2)) status = line_add(&control, x, y);
        }
        if (status == STATUS_OK) status = draw_spline(&line, &control);
        if (status == STATUS_OK) status = lay_line(ways, WAY_ROAD, &line, road_half_m);
        n = end > n ? end : n + 1;
    }
    free(control.p), free(line.p);
    return status;
}

static Status join(Ways *ways, Search *s, int start, int goal)
{
    int   *path, count;
    Status status = find_route(&path, &count, s, ways, start, goal);
    if (status == STATUS_OK && count > 1) status = lay_route(ways, path, count);
    free(path);
    return status;
}

/* ---- villages --------------------------------------------------------------------------------- */

/* Gentle dry land without vehicles, one in most squares of the grid. */
static void choose_villages(Ways *ways, const WaysGround *ground)
{
    static const double margin_m = 300, vehicle_m = 96, steepest = 0.09;
    const int           across = (int)fmax(rint(ways->side_m[0] / village_grid_m), 1);
    const int           up = (int)fmax(rint(ways->side_m[1] / village_grid_m), 1);
    const double        wide_m = ways->side_m[0] / across, high_m = ways->side_m[1] / up;
    for (int n = 0; n < across * up && ways->villages < ways_most_villages; n++) {
        const uint64_t h = landscape_hash(ground->seed + 60, n % across, n / across);
        if (across * up > 1 && unit_from_hash(landscape_hash(h, 0, 0)) < 0.25) continue;
        double best[2] = {0, 0}, least = INFINITY;
        for (int k = 0; k < 16; k++) {
            const double x = (n % across + 0.15 + 0.7 * unit_from_hash(landscape_hash(h, 1, k))) * wide_m;
            const double y = (n / across + 0.15 + 0.7 * unit_from_hash(landscape_hash(h, 2, k))) * high_m;
            if (x < margin_m || y < margin_m || x > ways->side_m[0] - margin_m || y > ways->side_m[1] - margin_m)
                continue;
            bool busy = false;
            for (int m = 0; m < 9 && !busy; m++)
                busy = ways_vehicle_near(ways, x + 130 * (m % 3 - 1), y + 130 * (m / 3 - 1), vehicle_m) ||
                       (ground->coast->sea_count && coast_at(ground->coast, ways->x0_m + x + 250 * (m % 3 - 1),
                                                            ways->y0_m + y + 250 * (m / 3 - 1)) != COAST_LAND);
            if (busy) continue;
            const double arm_m = 120, here = ways_height(ways, ground, x, y);
            const double dx = ways_height(ways, ground, x + arm_m, y) - ways_height(ways, ground, x - arm_m, y);
            const double dy = ways_height(ways, ground, x, y + arm_m) - ways_height(ways, ground, x, y - arm_m);
            const double score = hypot(dx, dy) / (2 * arm_m);
            if (!isfinite(here) || !(score < steepest) || score >= least) continue;
            least = score, best[0] = x, best[1] = y;
        }
        if (least == INFINITY) continue;
        ways->village[ways->villages][0] = best[0], ways->village[ways->villages][1] = best[1];
        ways->villages++;
    }
}

/* ---- plots ------------------------------------------------------------------------------------ */

/* From the starts of streams and gullies, and from ponds. near_m: at most 64. */
static bool stream_near(const Ways *ways, double x, double y, double near_m)
{
    const NearGrid *grid = &ways->stream_near;
    const int64_t   west = near_grid_cell(grid, x - near_m), east = near_grid_cell(grid, x + near_m);
    const int64_t   south = near_grid_cell(grid, y - near_m), north = near_grid_cell(grid, y + near_m);
    for (int64_t j = south; j <= north; j++)
        for (int64_t i = west; i <= east; i++) {
            int first, end;
            near_grid_bucket(grid, i, j, &first, &end);
            for (int n = first; n < end; n++) {
                const WaySegment *s = &ways->segment[grid->item[n]];
                if (fabs((double)s->x_m - x) < near_m && fabs((double)s->y_m - y) < near_m) return true;
            }
        }
    for (int n = 0; n < ways->ponds; n++)
        if (hypot((double)ways->pond[n].x_m - x, (double)ways->pond[n].y_m - y) <
            near_m + (double)ways->pond[n].most_m)
            return true;
    return false;
}

/* The segments so far are those of streams and gullies. */
static Status index_streams(Ways *ways)
{
    double *xy = malloc(2 * ((size_t)ways->segments + 1) * sizeof *xy);
    if (!xy) return STATUS_NO_MEMORY;
    for (int n = 0; n < ways->segments; n++)
        xy[2 * n] = (double)ways->segment[n].x_m, xy[2 * n + 1] = (double)ways->segment[n].y_m;
    const Status status = near_grid_create(&ways->stream_near, 64, ways->segments, xy, xy + 1, 2 * sizeof *xy);
    free(xy);
    return status;
}

/* Distance of a place from the nearest road or lane other than a given one. */
static double other_road_m(const Ways *ways, const int *near, int count, int way, double x, double y)
{
    double least = INFINITY;
    for (int n = 0; n < count; n++) {
        const WaySegment *s = &ways->segment[near[n]];
        if (s->way == way) continue;
        const double px = x - (double)s->x_m, py = y - (double)s->y_m, dx = (double)s->dx, dy = (double)s->dy;
        const double t = clamp(px * dx + py * dy, 0, (double)s->length_m);
        least = fmin(least, hypot(px - t * dx, py - t * dy));
    }
    return least;
}

/* Plots along both sides of the roads and lanes about a village. */
static Status lay_plots(Ways *ways, const WaysGround *ground, const double centre[2], double radius_m)
{
    static const double back_m = 1.4; /* of the way's edge */
    int    near[4096], nears = 0;
    const int first_plot = ways->plots;
    Status status = STATUS_OK;
    for (int n = 0; n < ways->segments && nears < 4096; n++)
        if (ways->segment[n].kind <= WAY_LANE &&
            hypot((double)ways->segment[n].x_m - centre[0], (double)ways->segment[n].y_m - centre[1]) < radius_m + 80)
            near[nears++] = n;
    double next[2] = {0, 0};
    int    way = -1;
    for (int n = 0; n < nears && status == STATUS_OK; n++) {
        const WaySegment *s = &ways->segment[near[n]];
        if (s->way != way) way = s->way, next[0] = next[1] = (double)s->along_m;
        if (hypot((double)s->x_m - centre[0], (double)s->y_m - centre[1]) > radius_m) continue;
        for (int side = 0; side < 2 && status == STATUS_OK; side++) {
            if ((double)s->along_m < next[side]) continue;
            const uint64_t h =
                landscape_hash(ground->seed + 61, (int64_t)(s->x_m * 16), (int64_t)(s->y_m * 16) * 2 + side);
            const double   u = unit_from_hash(h), v = unit_from_hash(landscape_hash(h, 1, 0));
            const double   z = unit_from_hash(landscape_hash(h, 2, 0));
            HousePlot      p = {.half_along_m = 9 + 6 * u, .half_across_m = 15 + 9 * v};
            const double   sign = side ? -1 : 1, off_m = (double)s->half_m + back_m + p.half_across_m;
            p.direction[0] = (double)s->dx, p.direction[1] = (double)s->dy;
            const double x = (double)s->x_m + p.half_along_m * (double)s->dx - sign * off_m * (double)s->dy;
            const double y = (double)s->y_m + p.half_along_m * (double)s->dy + sign * off_m * (double)s->dx;
            next[side] = (double)s->along_m + 6;
            if (z < 0.12) continue; /* a gap */
            const double reach = hypot(p.half_along_m, p.half_across_m);
            if (other_road_m(ways, near, nears, s->way, x, y) < p.half_across_m + 6) continue;
            if (ways_vehicle_near(ways, x, y, fmin(reach + 20, 95)) || stream_near(ways, x, y, reach + 8)) continue;
            bool taken = false;
            for (int k = first_plot; k < ways->plots && !taken; k++)
                taken = hypot(ways->plot[k].x_m - ways->x0_m - x, ways->plot[k].y_m - ways->y0_m - y) <
                        0.9 * (p.half_along_m + ways->plot[k].half_along_m);
            if (taken) continue;
            p.x_m = ways->x0_m + x, p.y_m = ways->y0_m + y;
            /* the house towards the lane, which lies across < 0 of a plot on the left */
            p.house_half[0] = 5 + 2.5 * v, p.house_half[1] = 4 + 1.5 * u;
            p.house[0] = (z - 0.5) * (p.half_along_m - p.house_half[0] - 2);
            p.house[1] = -sign * (p.half_across_m - p.house_half[1] - 4 - 4 * z);
            status = ways_reserve((void **)&ways->plot, &ways->plots_room, ways->plots + 1, sizeof *ways->plot);
            if (status == STATUS_OK) ways->plot[ways->plots++] = p;
            next[side] = (double)s->along_m + 2 * p.half_along_m + 1;
        }
    }
    return status;
}

/* Lanes that leave the roads about a village, bent, to the left and right in turn; some meet at their ends. */
static Status lay_lanes(Ways *ways, const WaysGround *ground, const double centre[2], double radius_m)
{
    Line      control = {0}, line = {0};
    Status    status = STATUS_OK;
    const int roads = ways->segments;
    int       lanes = 0;
    double    last_m = -1e9;
    int       way = -1;
    for (int n = 0; n < roads && status == STATUS_OK && lanes < 7; n++) {
        const WaySegment s = ways->segment[n];
        if (s.kind != WAY_ROAD || hypot((double)s.x_m - centre[0], (double)s.y_m - centre[1]) > 0.75 * radius_m)
            continue;
        if (s.way != way) way = s.way, last_m = (double)s.along_m - 45;
        const uint64_t h = landscape_hash(ground->seed + 62, (int64_t)(s.x_m * 16), (int64_t)(s.y_m * 16));
        if ((double)s.along_m - last_m < 75 + 40 * unit_from_hash(h)) continue;
        last_m = (double)s.along_m;
        const double sign = lanes % 2 ? -1 : 1;
        const double length_m = (0.45 + 0.5 * unit_from_hash(landscape_hash(h, 1, 0))) * radius_m;
        const double bend = 0.5 * (unit_from_hash(landscape_hash(h, 2, 0)) - 0.5);
        double       x = (double)s.x_m, y = (double)s.y_m, dx = -sign * (double)s.dy, dy = sign * (double)s.dx;
        control.count = 0;
        for (int k = 0; k <= 5 && status == STATUS_OK; k++) {
            status = line_add(&control, x, y);
            const double c = cos(bend * 0.5), t = sin(bend * 0.5), turned = dx * c - dy * t;
            dy = dx * t + dy * c, dx = turned;
            x += dx * length_m / 5, y += dy * length_m / 5;
            if (k > 0 && (stream_near(ways, x, y, 12) || ways_vehicle_near(ways, x, y, 30))) break;
        }
        if (status != STATUS_OK || control.count < 3) continue;
        status = draw_spline(&line, &control);
        if (status == STATUS_OK) status = lay_line(ways, WAY_LANE, &line, lane_half_m);
        lanes++;
    }
    free(control.p), free(line.p);
    return status;
}

/* ---- columns ---------------------------------------------------------------------------------- */

/* Tracks along the routes of vehicles: reports of one vehicle in turn that go on in much the same direction. Where
 * another has driven the same way, its track serves. */
static Status lay_columns(Ways *ways, const WaysGround *ground)
{
    static const double longest_m = 160, least_m = 10, shortest_route_m = 120, beside_route_m = 7;
    Line     control = {0}, line = {0};
    Status   status = STATUS_OK;
    uint32_t mask = (1 << 16) - 1, used = 0;
    uint64_t *taken = calloc((size_t)mask + 1, sizeof *taken);
    if (!taken) return STATUS_NO_MEMORY;
    for (int n = 0; n < ground->fix_count && status == STATUS_OK;) {
        const GroundFix *fix = ground->fix;
        const int        voter = fix[n].voter;
        double           length_m = 0;
        control.count = 0;
        int m = n;
        for (; m < ground->fix_count && fix[m].voter == voter && voter > 0 && status == STATUS_OK; m++) {
            const double x = fix[m].p_enu[0] - ways->x0_m, y = fix[m].p_enu[1] - ways->y0_m;
            if (!(x > 0 && y > 0 && x < ways->side_m[0] && y < ways->side_m[1])) break;
            if (control.count) {
                const double *last = control.p[control.count - 1];
                const double  dx = x - last[0], dy = y - last[1], step = hypot(dx, dy);
                if (step < least_m) continue;
                if (step > longest_m) break;
                if (control.count > 1) {
                    const double *prior = control.p[control.count - 2];
                    if (dx * (last[0] - prior[0]) + dy * (last[1] - prior[1]) < 0) break; /* turned back */
                }
                length_m += step;
            }
            /* another's track */
            const uint64_t key = ((uint64_t)(int64_t)(x / beside_route_m) << 32 |
                                  (uint64_t)(int64_t)(y / beside_route_m)) + 1;
            uint32_t at = (uint32_t)landscape_hash(2, (int64_t)key, 0) & mask;
            while (taken[at] && taken[at] >> 1 != key) at = (at + 1) & mask;
            if (taken[at]) break;
            status = line_add(&control, x, y);
        }
        if (status == STATUS_OK && length_m > shortest_route_m && control.count > 2) {
            line.count = 0;
            for (int k = 0; k < control.count && status == STATUS_OK; k++) /* through the reports themselves */
                status = line_add(&line, control.p[k][0], control.p[k][1]);
            if (status == STATUS_OK)
                status = ways_append(ways, WAY_TRACK, (const double (*)[2])line.p, line.count, track_half_m,
                                     track_half_m);
            for (int k = 1; k < control.count && used < mask / 2; k++) {
                const double *a = control.p[k - 1], *b = control.p[k];
                const int     parts = (int)ceil(hypot(b[0] - a[0], b[1] - a[1]) / (0.5 * beside_route_m));
                for (int s = 0; s < parts * 9 && used < mask / 2; s++) { /* and the squares about */
                    const double   t = (double)(s / 9) / parts;
                    const double   x = a[0] + t * (b[0] - a[0]), y = a[1] + t * (b[1] - a[1]);
                    const int64_t  i = (int64_t)(x / beside_route_m) + s % 9 % 3 - 1;
                    const int64_t  j = (int64_t)(y / beside_route_m) + s % 9 / 3 - 1;
                    const uint64_t key = ((uint64_t)i << 32 | (uint64_t)j) + 1;
                    uint32_t       at = (uint32_t)landscape_hash(2, (int64_t)key, 0) & mask;
                    while (taken[at] && taken[at] >> 1 != key) at = (at + 1) & mask;
                    if (!taken[at]) taken[at] = key << 1, used++;
                }
            }
        }
        n = m > n ? m : n + 1;
    }
    free(control.p), free(line.p), free(taken);
    return status;
}

/* ---- the whole -------------------------------------------------------------------------------- */

/* Every village to the nearest one of those joined already, and some to another; then the four sides. */
static Status join_villages(Ways *ways, Search *s)
{
    bool   joined[ways_most_villages] = {true};
    int    post[ways_most_villages];
    Status status = STATUS_OK;
    if (!ways->villages) return status;
    for (int n = 0; n < ways->villages; n++) post[n] = post_near(ways, ways->village[n][0], ways->village[n][1]);
    for (int count = 1; count < ways->villages && status == STATUS_OK; count++) {
        int    from = 0, to = -1;
        double least = INFINITY;
        for (int a = 0; a < ways->villages; a++)
            for (int b = 0; b < ways->villages && joined[a]; b++) {
                if (joined[b]) continue;
                const double apart = hypot(ways->village[a][0] - ways->village[b][0],
                                           ways->village[a][1] - ways->village[b][1]);
                if (apart < least) least = apart, from = a, to = b;
            }
        if (to < 0) break;
        joined[to] = true;
        status = join(ways, s, post[to], post[from]);
    }
    for (int side = 0; side < 4 && status == STATUS_OK; side++) {
        const int axis = side / 2;
        int       nearest = 0;
        for (int n = 1; n < ways->villages; n++)
            if ((ways->village[n][axis] < ways->village[nearest][axis]) == (side % 2 == 0)) nearest = n;
        double rim[2] = {ways->village[nearest][0], ways->village[nearest][1]};
        rim[axis] = side % 2 ? ways->side_m[axis] : 0;
        status = join(ways, s, post[nearest], post_near(ways, rim[0], rim[1]));
    }
    for (int a = 0; a < ways->villages && status == STATUS_OK; a++)
        for (int b = a + 1; b < ways->villages && status == STATUS_OK; b++) {
            const double apart = hypot(ways->village[a][0] - ways->village[b][0],
                                       ways->village[a][1] - ways->village[b][1]);
            if (apart < 1.15 * village_grid_m) status = join(ways, s, post[a], post[b]);
        }
    return status;
}

static Status search_create(Search *s, const Ways *ways, const WaysGround *ground)
{
    const int posts = ways->cx * ways->cy;
    *s = (Search){.cost = malloc((size_t)posts * sizeof *s->cost), .from = malloc((size_t)posts * sizeof *s->from),
                  .dear = malloc((size_t)posts * sizeof *s->dear)};
    if (!s->cost || !s->from || !s->dear) return STATUS_NO_MEMORY;
    for (int n = 0; n < posts; n++) {
        const double x = (n % ways->cx) * ways->coarse_m, y = (n / ways->cx) * ways->coarse_m;
        /* no two posts alike: a road over a plain is not ruled */
        s->dear[n] = 1 + 0.5f * (float)unit_from_hash(landscape_hash(ground->seed + 63, n, 0));
        if (ways_vehicle_near(ways, x, y, 50)) s->dear[n] += 25;
        if (ground->coast->sea_count && coast_at(ground->coast, ways->x0_m + x, ways->y0_m + y) == COAST_SEA)
            s->dear[n] += 200;
    }
    for (int n = 0; n < ways->segments; n++)
        if (ways->segment[n].kind == WAY_STREAM)
            s->dear[post_near(ways, (double)ways->segment[n].x_m, (double)ways->segment[n].y_m)] += 0.25f;
    for (int n = 0; n < ways->ponds; n++)
        for (int k = 0; k < 9; k++)
            s->dear[post_near(ways, (double)ways->pond[n].x_m + 60 * (k % 3 - 1),
                              (double)ways->pond[n].y_m + 60 * (k / 3 - 1))] += 30;
    return STATUS_OK;
}

Status ways_lay_roads(Ways *ways, const WaysGround *ground)
{
    const int posts = ways->cx * ways->cy;
    Search    s = {0};
    ways->road_vertex = malloc((size_t)posts * sizeof *ways->road_vertex);
    if (!ways->road_vertex) return STATUS_NO_MEMORY;
    for (int n = 0; n < posts; n++) ways->road_vertex[n] = -1;
    choose_villages(ways, ground);
    Status status = index_streams(ways);
    if (status == STATUS_OK) status = search_create(&s, ways, ground);
    if (status == STATUS_OK) status = join_villages(ways, &s);
    search_free(&s);
    for (int n = 0; n < ways->villages && status == STATUS_OK; n++) {
        const double size = unit_from_hash(landscape_hash(ground->seed + 64, n, 0));
        const double radius_m = n % 2 ? 90 + 60 * size : 220 + 110 * size; /* hamlets, and villages */
        status = lay_lanes(ways, ground, ways->village[n], radius_m);
        if (status == STATUS_OK) status = lay_plots(ways, ground, ways->village[n], radius_m);
    }
    if (status == STATUS_OK) status = lay_columns(ways, ground);
    return status;
}
