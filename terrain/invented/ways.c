/* terrain/invented/ways.c: the spatial index of ways, the nearest way of a place, and its class. */
#include "terrain/invented/ways_private.h"

#include <stdlib.h>

static const double index_cell_m = 24, coarse_step_m = 64;
/* how far a way reaches beyond its own edge: verge, margin, banks */
static const double beside_m[WAY_KINDS] = {
    [WAY_ROAD] = 4, [WAY_LANE] = 3, [WAY_TRACK] = 2.5, [WAY_STREAM] = 8, [WAY_GULLY] = 4,
};

/* ---- rows ------------------------------------------------------------------------------------- */

Status ways_reserve(void **rows, int *room, int count, size_t size)
{
    if (count <= *room) return STATUS_OK;
    const int wanted = count + count / 2 + 64;
    void     *more = realloc(*rows, (size_t)wanted * size);
    if (!more) return STATUS_NO_MEMORY;
    *rows = more;
    *room = wanted;
    return STATUS_OK;
}

Status ways_append(Ways *ways, WayKind kind, const double (*p)[2], int count, double half_m, double half_end_m)
{
    double total_m = 0, along_m = 0;
    if (count < 2 || ways->ways >= UINT16_MAX) return STATUS_OK;
    for (int n = 1; n < count; n++) total_m += hypot(p[n][0] - p[n - 1][0], p[n][1] - p[n - 1][1]);
    if (!(total_m > 0)) return STATUS_OK;
    const Status status =
        ways_reserve((void **)&ways->segment, &ways->segments_room, ways->segments + count, sizeof *ways->segment);
    if (status != STATUS_OK) return status;
    const double widens = (half_end_m - half_m) / total_m;
    for (int n = 1; n < count; n++) {
        const double dx = p[n][0] - p[n - 1][0], dy = p[n][1] - p[n - 1][1], length_m = hypot(dx, dy);
        if (length_m < 0.01) continue;
        ways->segment[ways->segments++] = (WaySegment){
            .x_m = (float)p[n - 1][0],
            .y_m = (float)p[n - 1][1],
            .dx = (float)(dx / length_m),
            .dy = (float)(dy / length_m),
            .length_m = (float)length_m,
            .along_m = (float)along_m,
            .half_m = (float)(half_m + widens * along_m),
            .widens = (float)widens,
            .way = (uint16_t)ways->ways,
            .kind = (uint8_t)kind,
        };
        along_m += length_m;
    }
    ways->ways++;
    return STATUS_OK;
}

double ways_height(const Ways *ways, const WaysGround *ground, double x_m, double y_m)
{
    const double x = ways->x0_m + x_m, y = ways->y0_m + y_m;
    return elevation_height(ground->elevation, x, y, NULL) + (x * x + y * y) * (0.5 / 6371e3);
}

/* ---- vehicles --------------------------------------------------------------------------------- */

/* Collects the places where vehicles were reported: one for each square of 3 m that holds a fix. */
static Status gather_reported(Ways *ways, const WaysGround *ground)
{
    static const double grain_m = 3;
    uint32_t            mask = 255;
    while (mask < 2 * (uint32_t)ground->fix_count) mask = 2 * mask + 1;
    uint64_t *taken = calloc((size_t)mask + 1, sizeof *taken);
    if (!taken) return STATUS_NO_MEMORY;
    Status status = STATUS_OK;
    for (int n = 0; n < ground->fix_count && status == STATUS_OK; n++) {
        const double x = ground->fix[n].p_enu[0] - ways->x0_m, y = ground->fix[n].p_enu[1] - ways->y0_m;
        if (!(x >= 0 && y >= 0 && x < ways->side_m[0] && y < ways->side_m[1])) continue;
        const int64_t  i = (int64_t)(x / grain_m), j = (int64_t)(y / grain_m);
        const uint64_t key = ((uint64_t)i << 32 | (uint64_t)j) + 1;
        uint32_t       at = (uint32_t)invented_hash(0, i, j) & mask;
        while (taken[at] && taken[at] != key) at = (at + 1) & mask;
        if (taken[at]) continue;
        taken[at] = key;
        status =
            ways_reserve((void **)&ways->reported, &ways->reported_room, ways->reports + 1, sizeof *ways->reported);
        if (status != STATUS_OK) break;
        ways->reported[ways->reports][0] = x, ways->reported[ways->reports][1] = y;
        ways->reports++;
    }
    free(taken);
    if (status != STATUS_OK) return status;
    static const double none[2] = {0, 0};
    const double       *xy = ways->reports ? ways->reported[0] : none;
    return near_grid_create(&ways->reported_near, 96, ways->reports, xy, xy + 1, sizeof *ways->reported);
}

bool ways_vehicle_near(const Ways *ways, double x_m, double y_m, double near_m)
{
    const NearGrid *grid = &ways->reported_near;
    const int64_t   west = near_grid_cell(grid, x_m - near_m), east = near_grid_cell(grid, x_m + near_m);
    const int64_t   south = near_grid_cell(grid, y_m - near_m), north = near_grid_cell(grid, y_m + near_m);
    for (int64_t j = south; j <= north; j++)
        for (int64_t i = west; i <= east; i++) {
            int first, end;
            near_grid_bucket(grid, i, j, &first, &end);
            for (int n = first; n < end; n++) {
                const double *place = ways->reported[grid->item[n]];
                const double  dx = place[0] - x_m, dy = place[1] - y_m;
                if (dx * dx + dy * dy < near_m * near_m) return true;
            }
        }
    return false;
}

/* ---- index ------------------------------------------------------------------------------------ */

typedef struct Box {
    double west, east, south, north;
} Box;

static Box item_box(const Ways *ways, WayItem type, int n)
{
    if (type == WAY_ITEM_SEGMENT) {
        const WaySegment *s = &ways->segment[n];
        const double      x = (double)s->x_m, y = (double)s->y_m, dx = (double)(s->dx * s->length_m),
                     dy = (double)(s->dy * s->length_m);
        const double reach = (double)fmaxf(s->half_m, s->half_m + s->widens * s->length_m) + beside_m[s->kind];
        return (Box){fmin(x, x + dx) - reach, fmax(x, x + dx) + reach, fmin(y, y + dy) - reach,
                     fmax(y, y + dy) + reach};
    }
    if (type == WAY_ITEM_PLOT) {
        const HousePlot *p = &ways->plot[n];
        const double     reach = hypot(p->half_along_m, p->half_across_m) + 1;
        const double     x = p->x_m - ways->x0_m, y = p->y_m - ways->y0_m;
        return (Box){x - reach, x + reach, y - reach, y + reach};
    }
    const Pond  *pond = &ways->pond[n];
    const double x = (double)pond->x_m, y = (double)pond->y_m, reach = (double)pond->most_m + 8;
    return (Box){x - reach, x + reach, y - reach, y + reach};
}

/* Files one kind of item in the index cells that its box touches; with item NULL it counts them. */
static void file_items(Ways *ways, WayItem type, int count, int32_t *fill)
{
    for (int n = 0; n < count; n++) {
        const Box b = item_box(ways, type, n);
        const int west = (int)clamp(floor(b.west / ways->index_m), 0, ways->nx - 1);
        const int east = (int)clamp(floor(b.east / ways->index_m), 0, ways->nx - 1);
        const int south = (int)clamp(floor(b.south / ways->index_m), 0, ways->ny - 1);
        const int north = (int)clamp(floor(b.north / ways->index_m), 0, ways->ny - 1);
        for (int j = south; j <= north; j++)
            for (int i = west; i <= east; i++) {
                const int cell = j * ways->nx + i;
                if (ways->item) ways->item[fill[cell]++] = (uint32_t)type << 28 | (uint32_t)n;
                else ways->start[cell + 1]++;
            }
    }
}

static Status make_index(Ways *ways)
{
    const int cells = ways->nx * ways->ny;
    ways->start = calloc((size_t)cells + 1, sizeof *ways->start);
    int32_t *fill = malloc((size_t)cells * sizeof *fill);
    if (!ways->start || !fill) {
        free(fill);
        return STATUS_NO_MEMORY;
    }
    const int count[WAY_ITEMS] = {ways->segments, ways->ponds, ways->plots};
    for (int type = 0; type < WAY_ITEMS; type++) file_items(ways, (WayItem)type, count[type], NULL);
    for (int c = 0; c < cells; c++) ways->start[c + 1] += ways->start[c];
    memcpy(fill, ways->start, (size_t)cells * sizeof *fill);
    ways->item = malloc(((size_t)ways->start[cells] + 1) * sizeof *ways->item);
    for (int type = 0; type < WAY_ITEMS && ways->item; type++) file_items(ways, (WayItem)type, count[type], fill);
    free(fill);
    return ways->item ? STATUS_OK : STATUS_NO_MEMORY;
}

I32x8 ways_cells(const Ways *ways, const double x_m[8], const double y_m[8])
{
    double        at[2][8];
    const double *from[2] = {x_m, y_m};
    const double  corner_m[2] = {ways->x0_m, ways->y0_m};
    const F64x4   per_m = f64x4_set(1 / ways->index_m), least = f64x4_set(-1), most = f64x4_set(1 << 20);
    for (int axis = 0; axis < 2; axis++)
        for (int k = 0; k < 8; k += 4) {
            const F64x4 g = (f64x4_loadu(from[axis] + k) - f64x4_set(corner_m[axis])) * per_m;
            f64x4_storeu(at[axis] + k, f64x4_min(f64x4_max(g, least), most)); /* NaN becomes `least` */
        }
    const Lattice x = lattice_of(at[0], 1), y = lattice_of(at[1], 1);
    const I32x8   nx = i32x8_set(ways->nx), ny = i32x8_set(ways->ny), outside = i32x8_set(-1);
    F32x8         in = f32x8_and(i32x8_greater(x.cell, outside), i32x8_greater(y.cell, outside));
    in = f32x8_and(in, f32x8_and(i32x8_greater(nx, x.cell), i32x8_greater(ny, y.cell)));
    if (!f32x8_bits(in)) return outside;
    const I32x8 cell = i32x8_add(i32x8_mul(y.cell, nx), x.cell), mask = _mm256_castps_si256(in);
    const I32x8 none = i32x8_set(0);
    const I32x8 first = _mm256_mask_i32gather_epi32(none, ways->start, cell, mask, 4);
    const I32x8 end = _mm256_mask_i32gather_epi32(none, ways->start + 1, cell, mask, 4);
    return i32x8_select(i32x8_greater(end, first), cell, outside);
}

F32x8 ways_wet(const Ways *ways, const double x_m[8], const double y_m[8])
{
    double        at[2][8];
    const double *from[2] = {x_m, y_m};
    const double  corner_m[2] = {ways->x0_m, ways->y0_m}, most[2] = {ways->cx - 1.001, ways->cy - 1.001};
    const F64x4   per_m = f64x4_set(1 / ways->coarse_m);
    for (int axis = 0; axis < 2; axis++)
        for (int k = 0; k < 8; k += 4) { /* positions are held at the rim; those of NaN are there too */
            const F64x4 g = (f64x4_loadu(from[axis] + k) - f64x4_set(corner_m[axis])) * per_m;
            f64x4_storeu(at[axis] + k, f64x4_min(f64x4_max(g, f64x4_set(0)), f64x4_set(most[axis])));
        }
    const F32x8 x = f32x8_of_doubles(at[0]), y = f32x8_of_doubles(at[1]), fx = f32x8_floor(x), fy = f32x8_floor(y);
    const I32x8 cell = i32x8_add(i32x8_mul(i32x8_truncate(fy), i32x8_set(ways->cx)), i32x8_truncate(fx));
    const F32x8 u = (x - fx) * (x - fx) * (f32x8_set(3) - f32x8_set(2) * (x - fx));
    const F32x8 v = (y - fy) * (y - fy) * (f32x8_set(3) - f32x8_set(2) * (y - fy));
    const I32x8 corners = _mm256_i32gather_epi32((const int *)(const void *)ways->wet, cell, 4);
    F32x8       w[4];
    for (int c = 0; c < 4; c++)
        w[c] = f32x8_of_ints(i32x8_and(i32x8_shift_right(corners, 8 * c), i32x8_set(255))) - f32x8_set(128);
    return f32x8_lerp(f32x8_lerp(w[0], w[1], u), f32x8_lerp(w[2], w[3], u), v) * f32x8_set(1 / 127.0);
}

/* ---- nearest ---------------------------------------------------------------------------------- */

/* Distance from a place to the edge of a segment, with its signed distance across and its position along. */
static double beyond_edge(double *across_m, double *along_m, const WaySegment *s, double x_m, double y_m)
{
    const double px = x_m - (double)s->x_m, py = y_m - (double)s->y_m;
    const double dx = (double)s->dx, dy = (double)s->dy, t = clamp(px * dx + py * dy, 0, (double)s->length_m);
    const double side = dx * py - dy * px, away = sqrt((px - t * dx) * (px - t * dx) + (py - t * dy) * (py - t * dy));
    *across_m = side < 0 ? -away : away;
    *along_m = t;
    return away - ((double)s->half_m + (double)s->widens * t);
}

static bool ways_nearest(WayPlace *out, const Ways *ways, int32_t cell, double x_m, double y_m)
{
    const WaySegment *best = NULL;
    double            least = INFINITY, across = 0, along = 0;
    x_m -= ways->x0_m, y_m -= ways->y0_m;
    for (int n = ways->start[cell]; n < ways->start[cell + 1]; n++) {
        if (ways->item[n] >> 28 != WAY_ITEM_SEGMENT) continue;
        const WaySegment *s = &ways->segment[ways->item[n] & 0xfffffff];
        double            across_m, along_m, beyond_m = beyond_edge(&across_m, &along_m, s, x_m, y_m);
        /* a road lies over whatever it crosses */
        if (beyond_m > beside_m[s->kind]) continue;
        if (s->kind <= WAY_TRACK && beyond_m < 0) beyond_m -= 100 * (WAY_STREAM - s->kind);
        if (beyond_m >= least) continue;
        least = beyond_m, best = s, across = across_m, along = along_m;
    }
    if (!best) return false;
    *out = (WayPlace){.kind = (WayKind)best->kind,
                      .way = best->way,
                      .across_m = across,
                      .along_m = (double)best->along_m + along,
                      .half_m = (double)best->half_m + (double)best->widens * along,
                      .direction = {(double)best->dx, (double)best->dy}};
    return true;
}

/* ---- class ------------------------------------------------------------------------------------ */

/* The class that a way gives to a place `beyond_m` outside of its edge; SURFACE_NONE: it does not change it. */
static SurfaceClass way_surface(WayKind kind, double beyond_m, double half_m, float wander, float patch)
{
    const double w = (double)wander;
    switch (kind) {
    case WAY_ROAD:
    case WAY_LANE:
        if (beyond_m + 0.12 * w < 0) return SURFACE_ROAD;
        if (beyond_m + 0.5 * w < 0.5) return SURFACE_TRACK; /* gravel */
        return beyond_m + w < (kind == WAY_ROAD ? 2.4 : 1.2) ? SURFACE_GRASS : SURFACE_NONE;
    case WAY_TRACK:
        if (beyond_m + 0.45 * w < 0) return SURFACE_TRACK;
        return beyond_m + w < 0.9 ? SURFACE_GRASS : SURFACE_NONE;
    case WAY_STREAM:
        if (beyond_m + fmin(0.5, half_m) * w < 0) return SURFACE_WATER;
        if (beyond_m + 0.8 * w < 1.2) return SURFACE_WETLAND;
        if (patch > 0.1f && beyond_m + 1.5 * w < 1.5 + 5 * (double)patch) return SURFACE_SCRUB;
        return beyond_m + w < 3 ? SURFACE_GRASS : SURFACE_NONE;
    case WAY_GULLY:
        if (beyond_m + 0.5 * w < 0) return patch > 0.35f ? SURFACE_ROCK : SURFACE_BARE_SOIL;
        return patch > -0.2f && beyond_m + 1.2 * w < 1.5 + (double)patch ? SURFACE_SCRUB : SURFACE_NONE;
    default:
        return SURFACE_NONE;
    }
}

/* Radius of a pond in a direction, which is given as a position on a square: exact, and needs no roots. */
static double pond_radius(const Pond *pond, double dx, double dy)
{
    const double sum = fabs(dx) + fabs(dy), s = sum > 0 ? dy / sum : 0;
    const double turn = dx >= 0 ? (s < 0 ? 4 + s : s) : 2 - s; /* position on the square, 0 .. 4 */
    const double at = turn * (pond_radii / 4.0), whole = floor(at), share = at - whole;
    const int    n = (int)whole % pond_radii;
    return (1 - share) * (double)pond->radius_m[n] + share * (double)pond->radius_m[(n + 1) % pond_radii];
}

/* The class at a place of a plot: house, drive, hedge or garden. */
static SurfaceClass plot_surface(const HousePlot *p, double dx, double dy, float wander, float patch)
{
    const double along = dx * p->direction[0] + dy * p->direction[1];
    const double across = p->direction[0] * dy - p->direction[1] * dx;
    if (fabs(along) > p->half_along_m || fabs(across) > p->half_across_m) return SURFACE_NONE;
    /* the sign of the house's place tells the side of the lane */
    const double front = p->house[1] < 0 ? -across : across, house_front = fabs(p->house[1]);
    if (fabs(along - p->house[0]) < p->house_half[0] && fabs(front - house_front) < p->house_half[1])
        return SURFACE_BUILT;
    const double w = (double)wander, edge_m = fmin(p->half_along_m - fabs(along), p->half_across_m + front);
    const double drive = p->house[0] + (p->house[0] > 0 ? -1 : 1) * (p->house_half[0] + 1.8);
    if (fabs(along - drive) + 0.2 * w < 1.5 && front > house_front - p->house_half[1]) return SURFACE_TRACK;
    if (edge_m + 0.4 * w < 0.9) return SURFACE_SCRUB;
    if (front < -0.45 * p->half_across_m && along * p->house[0] > 0) return SURFACE_BARE_SOIL; /* beds */
    return patch > 0.45f ? SURFACE_SCRUB : SURFACE_GRASS;
}

SurfaceClass ways_surface(const Ways *ways, int32_t cell, double x_m, double y_m, SurfaceClass field, float wander,
                          float patch)
{
    SurfaceClass surface = field;
    const double x = x_m - ways->x0_m, y = y_m - ways->y0_m, w = (double)wander;
    bool         house = false;
    for (int n = ways->start[cell]; n < ways->start[cell + 1]; n++) {
        const uint32_t number = ways->item[n] & 0xfffffff;
        switch ((WayItem)(ways->item[n] >> 28)) {
        case WAY_ITEM_SEGMENT:
            break;
        case WAY_ITEM_POND: {
            const Pond  *p = &ways->pond[number];
            const double dx = x - (double)p->x_m, dy = y - (double)p->y_m;
            const double beyond_m = hypot(dx, dy) - pond_radius(p, dx, dy) + 0.7 * w;
            if (beyond_m < 0) surface = SURFACE_WATER;
            else if (beyond_m < 1.5) surface = SURFACE_WETLAND;
            else if (beyond_m < 2 + 5 * (double)patch) surface = SURFACE_SCRUB;
            break;
        }
        case WAY_ITEM_PLOT: {
            const HousePlot   *p = &ways->plot[number];
            const SurfaceClass found = plot_surface(p, x_m - p->x_m, y_m - p->y_m, wander, patch);
            if (found != SURFACE_NONE && !house) surface = found, house = true;
            break;
        }
        case WAY_ITEMS:
            break;
        }
    }
    WayPlace way;
    if (ways_nearest(&way, ways, cell, x_m, y_m)) {
        const SurfaceClass found = way_surface(way.kind, fabs(way.across_m) - way.half_m, way.half_m, wander, patch);
        const bool         hard = way.kind <= WAY_TRACK || surface != SURFACE_WATER;
        if (found != SURFACE_NONE && hard && !(house && found == SURFACE_GRASS)) surface = found;
    }
    return surface;
}

/* Whether an item changes no class within a radius of a place, which is relative to the square's corner. */
static bool item_clear(const Ways *ways, uint32_t item, double x, double y, double radius_m)
{
    static const double bank_m = 7.7; /* beyond a pond, with what its border wanders */
    const uint32_t      number = item & 0xfffffff;
    double              across_m, along_m;
    switch ((WayItem)(item >> 28)) {
    case WAY_ITEM_SEGMENT: {
        const WaySegment *s = &ways->segment[number];
        const double      beyond_m = beyond_edge(&across_m, &along_m, s, x, y);
        return beyond_m > beside_m[s->kind] + radius_m * (1 + fabs((double)s->widens));
    }
    case WAY_ITEM_POND: {
        const Pond *p = &ways->pond[number];
        return hypot(x - (double)p->x_m, y - (double)p->y_m) > (double)p->most_m + bank_m + radius_m;
    }
    case WAY_ITEM_PLOT: {
        const HousePlot *p = &ways->plot[number];
        const double     dx = x + ways->x0_m - p->x_m, dy = y + ways->y0_m - p->y_m;
        return fabs(dx * p->direction[0] + dy * p->direction[1]) > p->half_along_m + radius_m ||
               fabs(p->direction[0] * dy - p->direction[1] * dx) > p->half_across_m + radius_m;
    }
    default:
        return false;
    }
}

bool ways_clear(const Ways *ways, const double place_m[2], double radius_m)
{
    const double x = place_m[0] - ways->x0_m, y = place_m[1] - ways->y0_m, per_m = 1 / ways->index_m;
    const int west = (int)fmax(floor((x - radius_m) * per_m), 0), south = (int)fmax(floor((y - radius_m) * per_m), 0);
    const int east = (int)fmin(floor((x + radius_m) * per_m), ways->nx - 1);
    const int north = (int)fmin(floor((y + radius_m) * per_m), ways->ny - 1);
    for (int j = south; j <= north; j++)
        for (int i = west; i <= east; i++)
            for (int n = ways->start[j * ways->nx + i]; n < ways->start[j * ways->nx + i + 1]; n++)
                if (!item_clear(ways, ways->item[n], x, y, radius_m)) return false;
    return true;
}

/* ---- the whole -------------------------------------------------------------------------------- */

Status ways_create(Ways **out, const WaysGround *ground)
{
    const ElevationLevel *level = &ground->elevation->level[0];
    Ways                 *ways = calloc(1, sizeof *ways);
    *out = NULL;
    if (!ways) return STATUS_NO_MEMORY;
    ways->x0_m = level->x0_m, ways->y0_m = level->y0_m;
    ways->side_m[0] = (level->nx - 1) * level->spacing_m, ways->side_m[1] = (level->ny - 1) * level->spacing_m;
    const double longest_m = fmax(ways->side_m[0], ways->side_m[1]);
    ways->index_m = fmax(index_cell_m, longest_m / 1000);
    ways->nx = (int)ceil(ways->side_m[0] / ways->index_m), ways->ny = (int)ceil(ways->side_m[1] / ways->index_m);
    ways->coarse_m = fmax(coarse_step_m, longest_m / 300);
    ways->cx = (int)fmax(floor(ways->side_m[0] / ways->coarse_m) + 1, 2);
    ways->cy = (int)fmax(floor(ways->side_m[1] / ways->coarse_m) + 1, 2);
    Status status = gather_reported(ways, ground);
    if (status == STATUS_OK) status = ways_lay_streams(ways, ground);
    if (status == STATUS_OK) status = ways_lay_roads(ways, ground);
    if (status == STATUS_OK) status = make_index(ways);
    near_grid_destroy(&ways->reported_near), near_grid_destroy(&ways->stream_near);
    free(ways->height), free(ways->flow), free(ways->road_vertex), free(ways->reported);
    ways->height = ways->flow = NULL;
    ways->road_vertex = NULL;
    ways->reported = NULL;
    ways->reports = ways->reported_room = 0;
    if (status != STATUS_OK) ways_free(ways);
    else *out = ways;
    return status;
}

void ways_free(Ways *ways)
{
    if (!ways) return;
    near_grid_destroy(&ways->reported_near), near_grid_destroy(&ways->stream_near);
    free(ways->start), free(ways->item), free(ways->segment), free(ways->pond), free(ways->plot), free(ways->reported);
    free(ways->wet), free(ways->height), free(ways->flow), free(ways->road_vertex);
    free(ways);
}

/* ---- queries ---------------------------------------------------------------------------------- */

bool ways_at(WayPlace *out, const Ways *ways, double x_m, double y_m)
{
    const double x[8] = {x_m, NAN, NAN, NAN, NAN, NAN, NAN, NAN}, y[8] = {y_m, 0, 0, 0, 0, 0, 0, 0};
    int32_t      cell[8];
    if (!ways) return false;
    i32x8_store(cell, ways_cells(ways, x, y));
    return cell[0] >= 0 && ways_nearest(out, ways, cell[0], x_m, y_m);
}

int ways_vertices(double (*out)[2], WayKind *kind, const Ways *ways, int way, int most)
{
    int count = 0;
    for (int n = 0; ways && n < ways->segments; n++) {
        const WaySegment *s = &ways->segment[n];
        if (s->way != way) continue;
        *kind = (WayKind)s->kind;
        const double x = ways->x0_m + (double)s->x_m, y = ways->y0_m + (double)s->y_m;
        if (count < most) out[count][0] = x, out[count][1] = y, count++;
        if (n + 1 < ways->segments && ways->segment[n + 1].way == way) continue;
        if (count < most) {
            out[count][0] = x + (double)(s->dx * s->length_m), out[count][1] = y + (double)(s->dy * s->length_m);
            count++;
        }
    }
    return count;
}

const HousePlot *ways_plots(const Ways *ways, int *count)
{
    *count = ways ? ways->plots : 0;
    return *count ? ways->plot : NULL;
}

bool ways_village(double place_m[2], const Ways *ways, int index)
{
    if (!ways || index < 0 || index >= ways->villages) return false;
    place_m[0] = ways->x0_m + ways->village[index][0], place_m[1] = ways->y0_m + ways->village[index][1];
    return true;
}

double ways_wetness(const Ways *ways, double x_m, double y_m)
{
    const double x[8] = {x_m}, y[8] = {y_m};
    float        wet[8];
    if (!ways) return 0;
    f32x8_store(wet, ways_wet(ways, x, y));
    return (double)wet[0];
}

bool ways_touch(const Ways *ways, double x_m, double y_m)
{
    const double x[8] = {x_m}, y[8] = {y_m};
    int32_t      cell[8];
    if (!ways) return false;
    i32x8_store(cell, ways_cells(ways, x, y));
    return cell[0] >= 0;
}
