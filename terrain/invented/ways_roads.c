/* terrain/invented/ways_roads.c: roads between villages along gentle slopes, found on the coarse grid and drawn as
 * splines. */
#include "terrain/invented/ways_private.h"

#include <stdlib.h>

static const double vertex_m = 8, road_half_m = 3;

/* ---- lines ------------------------------------------------------------------------------------- */

Status ways_line_add(WayLine *line, double x, double y)
{
    const Status status = ways_reserve((void **)&line->p, &line->room, line->count + 1, sizeof *line->p);
    if (status != STATUS_OK) return status;
    line->p[line->count][0] = x, line->p[line->count][1] = y;
    line->count++;
    return STATUS_OK;
}

Status ways_draw_spline(WayLine *out, const WayLine *control)
{
    out->count = 0;
    const int n = control->count;
    if (n < 2) return STATUS_OK;
    Status status = ways_line_add(out, control->p[0][0], control->p[0][1]);
    for (int k = -1; k < n && status == STATUS_OK; k++) {
        double c[4][2];
        for (int m = 0; m < 4; m++) /* control points beyond the ends are mirrored */
            for (int a = 0; a < 2; a++) {
                const int i = k - 1 + m;
                c[m][a] = i < 0    ? 2 * control->p[0][a] - control->p[-i < n ? -i : n - 1][a]
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
            status = ways_line_add(out, q[0], q[1]);
        }
    }
    return status;
}

/* The post of the coarse grid nearest to a place. */
static int ways_post_near(const Ways *ways, double x, double y)
{
    const int i = (int)clamp(rint(x / ways->coarse_m), 0, ways->cx - 1);
    const int j = (int)clamp(rint(y / ways->coarse_m), 0, ways->cy - 1);
    return j * ways->cx + i;
}

Status ways_lay_line(Ways *ways, WayKind kind, WayLine *line, double half_m)
{
    const int    first = ways->segments;
    const Status status = ways_append(ways, kind, (const double(*)[2])line->p, line->count, half_m, half_m);
    for (int n = first; n < ways->segments && kind == WAY_ROAD; n++)
        ways->road_vertex[ways_post_near(ways, (double)ways->segment[n].x_m, (double)ways->segment[n].y_m)] = n;
    return status;
}

/* ---- routes ----------------------------------------------------------------------------------- */

typedef struct Open {
    float cost;
    int   at;
} Open;

typedef struct Search {
    float *cost; /* [posts] least cost found so far */
    int   *from; /* [posts] */
    float *dear; /* [posts] factor of a post's cost: high on water */
    Open  *heap;
    int    heap_count, heap_room;
} Search;

static void search_free(Search *s) { free(s->cost), free(s->from), free(s->dear), free(s->heap); }

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

/* Steps to a neighbouring post: sixteen directions, so that routes turn by 22.5 degrees. */
static const int8_t neighbour[16][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 1},   {-1, 1},  {-1, -1}, {1, -1},
                                        {2, 1}, {1, 2}, {-1, 2}, {-2, 1}, {-2, -1}, {-1, -2}, {1, -2},  {2, -1}};

static const double least_cost = 0.3; /* cost of a post's distance along a road */

static double root_of(int di, int dj) { return sqrt((double)(di * di + dj * dj)); }

/* Finds the cheapest route between two posts; path is from goal to start. *count is its length; 0: there is none. */
static Status find_route(int **path, int *count, Search *s, const Ways *ways, int start, int goal)
{
    const int posts = ways->cx * ways->cy;
    *path = NULL;
    *count = 0;
    for (int n = 0; n < posts; n++) s->cost[n] = INFINITY;
    s->heap_count = 0;
    s->cost[start] = 0, s->from[start] = -1;
    const int gi = goal % ways->cx, gj = goal / ways->cx;
    double    run_of[16];
    for (int n = 0; n < 16; n++) run_of[n] = root_of(neighbour[n][0], neighbour[n][1]);
    Status status = heap_push(s, (Open){0, start});
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
            const double cost =
                (double)s->cost[at] + run * each * (road ? least_cost : 0.5 * (double)(s->dear[at] + s->dear[to]));
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

/* Lays those pieces of a route that are not on roads yet; their ends are on vertices of the roads they meet. */
static Status lay_route(Ways *ways, const int *path, int count)
{
    enum { skip = 3 };
    WayLine   control = {0}, line = {0};
    Status    status = STATUS_OK;
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
            const bool tip = k == n || k == end;
            const int  met = tip ? ways->road_vertex[path[k]] : -1;
            double     x = (path[k] % ways->cx) * ways->coarse_m, y = (path[k] / ways->cx) * ways->coarse_m;
            if (met >= 0) x = (double)ways->segment[met].x_m, y = (double)ways->segment[met].y_m;
            if (tip || ((k - n) % skip == 0 && end - k >= 2)) status = ways_line_add(&control, x, y);
        }
        if (status == STATUS_OK) status = ways_draw_spline(&line, &control);
        if (status == STATUS_OK) status = ways_lay_line(ways, WAY_ROAD, &line, road_half_m);
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

/* ---- the whole -------------------------------------------------------------------------------- */

/* Joins every village to the nearest one that is joined already, and some to another one; then joins the four sides. */
static Status join_villages(Ways *ways, Search *s)
{
    bool   joined[ways_most_villages] = {true};
    int    post[ways_most_villages];
    Status status = STATUS_OK;
    if (!ways->villages) return status;
    for (int n = 0; n < ways->villages; n++) post[n] = ways_post_near(ways, ways->village[n][0], ways->village[n][1]);
    for (int count = 1; count < ways->villages && status == STATUS_OK; count++) {
        int    from = 0, to = -1;
        double least = INFINITY;
        for (int a = 0; a < ways->villages; a++)
            for (int b = 0; b < ways->villages && joined[a]; b++) {
                if (joined[b]) continue;
                const double apart =
                    hypot(ways->village[a][0] - ways->village[b][0], ways->village[a][1] - ways->village[b][1]);
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
        status = join(ways, s, post[nearest], ways_post_near(ways, rim[0], rim[1]));
    }
    for (int a = 0; a < ways->villages && status == STATUS_OK; a++)
        for (int b = a + 1; b < ways->villages && status == STATUS_OK; b++) {
            const double apart =
                hypot(ways->village[a][0] - ways->village[b][0], ways->village[a][1] - ways->village[b][1]);
            if (apart < 1.15 * ways_village_grid_m) status = join(ways, s, post[a], post[b]);
        }
    return status;
}

static Status search_create(Search *s, const Ways *ways, const WaysGround *ground)
{
    const int posts = ways->cx * ways->cy;
    *s = (Search){.cost = malloc((size_t)posts * sizeof *s->cost),
                  .from = malloc((size_t)posts * sizeof *s->from),
                  .dear = malloc((size_t)posts * sizeof *s->dear)};
    if (!s->cost || !s->from || !s->dear) return STATUS_NO_MEMORY;
    for (int n = 0; n < posts; n++) {
        const double x = (n % ways->cx) * ways->coarse_m, y = (n / ways->cx) * ways->coarse_m;
        /* no two posts cost the same, so that a road over a plain is not dead straight */
        s->dear[n] = 1 + 0.5f * (float)invented_unit(invented_hash(ground->seed + 63, n, 0));
        if (ground->coast->sea_count && coast_at(ground->coast, ways->x0_m + x, ways->y0_m + y) == COAST_SEA)
            s->dear[n] += 200;
    }
    for (int n = 0; n < ways->segments; n++)
        if (ways->segment[n].kind == WAY_STREAM)
            s->dear[ways_post_near(ways, (double)ways->segment[n].x_m, (double)ways->segment[n].y_m)] += 0.25f;
    for (int n = 0; n < ways->ponds; n++)
        for (int k = 0; k < 9; k++)
            s->dear[ways_post_near(ways, (double)ways->pond[n].x_m + 60 * (k % 3 - 1),
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
    Status status = ways_choose_villages(ways, ground);
    if (status == STATUS_OK) status = search_create(&s, ways, ground);
    if (status == STATUS_OK) status = join_villages(ways, &s);
    search_free(&s);
    if (status == STATUS_OK) status = ways_lay_villages(ways, ground);
    if (status == STATUS_OK) status = ways_lay_tracks(ways, ground);
    return status;
}
