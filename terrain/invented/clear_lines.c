/* terrain/invented/clear_lines.c: height limits of the terrain by clear lines.
 *
 * A flight path, or the sight line of a shot that hit, is above the ground. Every post within one
 * cell's diagonal of a point of the line is held `clearance` below that point, so every triangle the line
 * passes over is below the line entirely, whatever the interpolation. From there the ground may rise by one in two, a
 * valley. The clearance is 2 m, less where an accepted fix is closer under the line, 0.15 m at least; it grows by
 * one in twenty from where the line comes down to a fix, and within taper_of_spacing_m of such a place the line sets no
 * limit. A fix that is still above the limit is dropped. */
#include "terrain/invented/invented_private.h"

#include <stdlib.h>

static const double full_clearance_m = 2, least_clearance_m = 0.15;
static const double taper_slope = 0.05, valley_slope = 0.5;
static const float  no_cap_m = 1e30f; /* no limit; finite, so that a share of 0 of it is 0 */
static const double touch_m =
    8; /* an end this near a fix counts as at the fix: half the length of a large vehicle, and its height */

/* ---- the usable lines --------------------------------------------------------------------- */

static double squared_distance(const double a[3], const double b[3])
{
    double d[3];
    v3_sub(d, a, b);
    return v3_dot(d, d);
}

static bool comes_down(const double p[3], const FixSet *fixes)
{
    const NearGrid *near = &fixes->near;
    const int64_t   ci = near_grid_cell(near, p[0]), cj = near_grid_cell(near, p[1]);
    for (int64_t j = cj - 1; j <= cj + 1; j++)
        for (int64_t i = ci - 1; i <= ci + 1; i++) {
            int first, end;
            near_grid_bucket(near, i, j, &first, &end);
            for (int n = first; n < end; n++) {
                const FixRow *row = &fixes->row[near->item[n]];
                if (row->dropped) continue;
                if (squared_distance(p, (double[3]){row->x_m, row->y_m, row->z_m}) <= touch_m * touch_m) return true;
            }
        }
    return false;
}

static int by_place(const void *pa, const void *pb)
{
    const double *a = pa, *b = pb;
    for (int k = 0; k < 3; k++)
        if (a[k] != b[k]) return a[k] < b[k] ? -1 : 1;
    return 0;
}

/* Whether a line comes from below the lowest ground on Earth. Such a line is ignored, since it would pull the terrain
 * down. */
static bool under_the_ground(const double p[3], const Curve *curve)
{
    double z_m, dz_per_h;
    levels_curve_at(curve, p[0], p[1], &z_m, &dz_per_h);
    return !((p[2] - z_m) / dz_per_h > lowest_ground_m);
}

Status line_set_create(LineSet *out, const ClearLine *line, int count, const LocalFrame *frame, const FixSet *fixes,
                       double horizon_m)
{
    Curve   curve;
    LineSet set = {0};
    levels_curve(&curve, frame);
    set.line = calloc((size_t)count + 1, sizeof *set.line);
    set.touch = calloc(2 * (size_t)count + 1, 3 * sizeof *set.touch);
    if (!set.line || !set.touch) {
        line_set_destroy(&set);
        return STATUS_NO_MEMORY;
    }
    for (int n = 0; n < count; n++) {
        const double *a = line[n].a_enu, *b = line[n].b_enu;
        if (!v3_is_finite(a) || !v3_is_finite(b)) continue;
        /* ignores a line that is entirely beyond one side of the terrain, or too long for a path */
        if (fmin(a[0], b[0]) > horizon_m || fmax(a[0], b[0]) < -horizon_m || fmin(a[1], b[1]) > horizon_m ||
            fmax(a[1], b[1]) < -horizon_m || !(squared_distance(a, b) < 16 * horizon_m * horizon_m))
            continue;
        if (under_the_ground(a, &curve) || under_the_ground(b, &curve)) continue;
        set.line[set.count++] = line[n];
        if (comes_down(a, fixes)) memcpy(set.touch + 3 * set.touch_count++, a, sizeof line[n].a_enu);
        if (comes_down(b, fixes)) memcpy(set.touch + 3 * set.touch_count++, b, sizeof line[n].b_enu);
    }

    /* places are kept once: a hundred shots at one tank end at one place */
    qsort(set.touch, (size_t)set.touch_count, 3 * sizeof *set.touch, by_place);
    int kept = 0;
    for (int n = 0; n < set.touch_count; n++) {
        if (kept && by_place(set.touch + 3 * (kept - 1), set.touch + 3 * n) == 0) continue;
        memmove(set.touch + 3 * kept++, set.touch + 3 * n, 3 * sizeof *set.touch);
    }
    set.touch_count = kept;

    const Status status = near_grid_create(&set.near_touch, 128, kept, set.touch, set.touch + 1, 3 * sizeof *set.touch);
    if (status != STATUS_OK) {
        line_set_destroy(&set);
        return status;
    }
    *out = set;
    return STATUS_OK;
}

void line_set_destroy(LineSet *set)
{
    free(set->line);
    free(set->touch);
    near_grid_destroy(&set->near_touch);
    *set = (LineSet){0};
}

/* Distance to the nearest place where a line ends at a fix; infinite beyond 128 m. */
static double touch_distance_m(const LineSet *lines, const double p[3])
{
    const NearGrid *near = &lines->near_touch;
    double          best = INFINITY;
    const int64_t   ci = near_grid_cell(near, p[0]), cj = near_grid_cell(near, p[1]);
    for (int64_t j = cj - 1; near->count && j <= cj + 1; j++)
        for (int64_t i = ci - 1; i <= ci + 1; i++) {
            int first, end;
            near_grid_bucket(near, i, j, &first, &end);
            for (int n = first; n < end; n++) best = fmin(best, squared_distance(p, lines->touch + 3 * near->item[n]));
        }
    return sqrt(best);
}

/* ---- for the smooth field ----------------------------------------------------------------- */

Status line_ceilings(FieldAim **out, int *out_count, const LineSet *lines, const LocalFrame *frame, double h_m)
{
    enum { most_aims = 400000 };
    static const double finest_step_m = 32, most_steps = 1e6;

    double total_m = 0;
    for (int n = 0; n < lines->count; n++)
        total_m += sqrt(squared_distance(lines->line[n].a_enu, lines->line[n].b_enu));
    const double step_m = fmax(finest_step_m, total_m / most_steps);

    Curve curve;
    levels_curve(&curve, frame);
    int       count = 0, room = 1024;
    FieldAim *aim = malloc((size_t)room * sizeof *aim);
    if (!aim) return STATUS_NO_MEMORY;
    for (int n = 0; n < lines->count && count < most_aims; n++) {
        double d[3];
        v3_sub(d, lines->line[n].b_enu, lines->line[n].a_enu);
        const double length_m = v3_length(d);
        /* a point this far above h_m cannot come down to it within that distance */
        for (double s_m = 0; s_m <= length_m && count < most_aims;) {
            double p[3], z_m, dz_per_h;
            v3_add_scaled(p, lines->line[n].a_enu, length_m > 0 ? s_m / length_m : 0, d);
            levels_curve_at(&curve, p[0], p[1], &z_m, &dz_per_h);
            const double above_m = (p[2] - z_m) / dz_per_h - h_m;
            if (above_m < 0) {
                if (count == room) {
                    FieldAim *more = realloc(aim, 2 * (size_t)room * sizeof *aim);
                    if (!more) {
                        free(aim);
                        return STATUS_NO_MEMORY;
                    }
                    aim = more;
                    room *= 2;
                }
                const double taper_m = least_clearance_m + taper_slope * touch_distance_m(lines, p);
                aim[count++] = (FieldAim){p[0], p[1], above_m + h_m - fmin(full_clearance_m, taper_m), true};
            }
            s_m += fmax(step_m, 0.99 * above_m);
        }
    }
    *out = aim;
    *out_count = count;
    return STATUS_OK;
}

/* ---- on the posts ------------------------------------------------------------------------- */

enum { tile_posts = 64 };

/* The highest post of each square of 64 x 64 and of the eight squares around it. */
static Status tile_maxima(Field *out, const Field *z)
{
    const int nx = (z->nx + tile_posts - 1) / tile_posts, ny = (z->ny + tile_posts - 1) / tile_posts;
    Field     own, around;
    Status    status = levels_field_create(&own, z->spacing_m * tile_posts, 0, 0, nx, ny);
    if (status != STATUS_OK) return status;
    status = levels_field_create(&around, own.spacing_m, 0, 0, nx, ny);
    if (status != STATUS_OK) {
        levels_field_destroy(&own);
        return status;
    }
    for (int n = 0; n < nx * ny; n++) own.v[n] = around.v[n] = -INFINITY;
    for (int j = 0; j < z->ny; j++) {
        const float *row = z->v + (size_t)j * z->nx;
        for (int t = 0; t < nx; t++) {
            const int end = (t + 1) * tile_posts < z->nx ? (t + 1) * tile_posts : z->nx;
            float     most = row[t * tile_posts];
            for (int i = t * tile_posts + 1; i < end; i++) most = most > row[i] ? most : row[i];
            float *tile = &own.v[(size_t)(j / tile_posts) * nx + t];
            *tile = fmaxf(*tile, most);
        }
    }
    for (int j = 0; j < ny; j++)
        for (int i = 0; i < nx; i++)
            for (int b = j > 0 ? j - 1 : j; b <= j + 1 && b < ny; b++)
                for (int a = i > 0 ? i - 1 : i; a <= i + 1 && a < nx; a++)
                    around.v[(size_t)j * nx + i] = fmaxf(around.v[(size_t)j * nx + i], own.v[(size_t)b * nx + a]);
    levels_field_destroy(&own);
    *out = around;
    return STATUS_OK;
}

typedef struct Cutter {
    WorkLevel     *level;
    const LineSet *lines;
    const FixSet  *fixes;
    Field          tiles;
    double         core_m;         /* diagonal of a cell */
    double         top_m;          /* highest post of the level */
    int            i0, i1, j0, j1; /* range of posts that have been seeded; i1 < i0: none */
    double         lowest_m;       /* lowest seeded limit */
    bool           any_fix;        /* whether a fix lies on this level */
} Cutter;

/* How far the ground must stay below z_m, a height of the line near p. */
static double clearance_m(const Cutter *cutter, const double p[3], double z_m, double touch_distance)
{
    const double taper_m = taper_of_spacing_m(cutter->level->z.spacing_m);
    double       room_m = full_clearance_m;
    room_m = fmin(room_m, least_clearance_m + taper_slope * fmax(0, touch_distance - taper_m));

    if (!cutter->any_fix) return room_m;
    const NearGrid *near = &cutter->fixes->near;
    const double    flat_m = 1.5 * cutter->core_m, reach_m = fmin(flat_m + full_clearance_m / valley_slope, 100);
    const int64_t   ci0 = near_grid_cell(near, p[0] - reach_m), ci1 = near_grid_cell(near, p[0] + reach_m);
    const int64_t   cj0 = near_grid_cell(near, p[1] - reach_m), cj1 = near_grid_cell(near, p[1] + reach_m);
    for (int64_t j = cj0; near->count && j <= cj1 && room_m > least_clearance_m; j++)
        for (int64_t i = ci0; i <= ci1; i++) {
            int first, end;
            near_grid_bucket(near, i, j, &first, &end);
            for (int n = first; n < end; n++) {
                const FixRow *row = &cutter->fixes->row[near->item[n]];
                if (row->dropped) continue;
                const double r_m = hypot(row->x_m - p[0], row->y_m - p[1]);
                if (r_m > reach_m) continue;
                room_m = fmin(room_m, z_m - row->z_m + valley_slope * fmax(0, r_m - flat_m) - 0.02);
            }
        }
    return fmax(room_m, least_clearance_m);
}

/* Limits every post within a cell's diagonal of the piece from a to b. */
static void seed_piece(Cutter *cutter, const double a[3], const double b[3], double cap_m)
{
    const Field *z = &cutter->level->z;
    const double s = z->spacing_m, core_m = cutter->core_m;
    const int    i0 = (int)fmax(ceil((fmin(a[0], b[0]) - core_m) / s) - z->i0, 0);
    const int    i1 = (int)fmin(floor((fmax(a[0], b[0]) + core_m) / s) - z->i0, z->nx - 1);
    const int    j0 = (int)fmax(ceil((fmin(a[1], b[1]) - core_m) / s) - z->j0, 0);
    const int    j1 = (int)fmin(floor((fmax(a[1], b[1]) + core_m) / s) - z->j0, z->ny - 1);
    const double dx = b[0] - a[0], dy = b[1] - a[1], square = dx * dx + dy * dy;
    for (int j = j0; j <= j1; j++)
        for (int i = i0; i <= i1; i++) {
            const double px = (z->i0 + i) * s - a[0], py = (z->j0 + j) * s - a[1];
            const double t = square > 0 ? clamp((px * dx + py * dy) / square, 0, 1) : 0;
            const double ex = px - t * dx, ey = py - t * dy;
            if (!(ex * ex + ey * ey <= core_m * core_m)) continue;
            float *cap = &cutter->level->cap[(size_t)j * z->nx + i];
            if (*cap > cap_m) *cap = (float)cap_m;
        }
    if (i0 > i1 || j0 > j1) return;
    cutter->i0 = i0 < cutter->i0 ? i0 : cutter->i0;
    cutter->i1 = i1 > cutter->i1 ? i1 : cutter->i1;
    cutter->j0 = j0 < cutter->j0 ? j0 : cutter->j0;
    cutter->j1 = j1 > cutter->j1 ? j1 : cutter->j1;
    cutter->lowest_m = fmin(cutter->lowest_m, cap_m);
}

/* The part of the line from a along d that is over the level's square, widened by margin_m. Returns false when there is
 * none. */
static bool clip_to_level(double *t0, double *t1, const double a[3], const double d[3], const Field *z, double margin_m)
{
    const double low[2] = {z->i0 * z->spacing_m - margin_m, z->j0 * z->spacing_m - margin_m};
    const double high[2] = {(z->i0 + z->nx - 1) * z->spacing_m + margin_m,
                            (z->j0 + z->ny - 1) * z->spacing_m + margin_m};
    *t0 = 0;
    *t1 = 1;
    for (int k = 0; k < 2; k++) {
        if (d[k] == 0) {
            if (a[k] < low[k] || a[k] > high[k]) return false;
            continue;
        }
        const double u = (low[k] - a[k]) / d[k], v = (high[k] - a[k]) / d[k];
        *t0 = fmax(*t0, fmin(u, v));
        *t1 = fmin(*t1, fmax(u, v));
    }
    return *t0 <= *t1;
}

/* Whether a place is deep inside the level's hole, where the level does not exist. */
static bool in_hole(const WorkLevel *level, const double p[3])
{
    enum { margin = 4 };
    const double x = p[0] / level->z.spacing_m, y = p[1] / level->z.spacing_m;
    return x > level->hole_i0 + margin && x < level->hole_i1 - margin && y > level->hole_j0 + margin &&
           y < level->hole_j1 - margin;
}

static void seed_line(Cutter *cutter, const ClearLine *line)
{
    const Field *z = &cutter->level->z;
    double       d[3], t0, t1;
    v3_sub(d, line->b_enu, line->a_enu);
    const double length_m = v3_length(d);
    if (!clip_to_level(&t0, &t1, line->a_enu, d, z, 2 * cutter->core_m)) return;

    const double piece_m = z->spacing_m, end_m = t1 * length_m;
    const double slope = length_m > 0 ? fabs(d[2]) / length_m : 0;
    for (double s_m = t0 * length_m;; s_m += piece_m) {
        double a[3], b[3], mid[3];
        v3_add_scaled(a, line->a_enu, length_m > 0 ? s_m / length_m : 0, d);

        /* the line can have no effect over this distance, since it is high above the whole level */
        const double above_m = a[2] - full_clearance_m - cutter->top_m;
        if (above_m > 0) {
            const double skip_m = slope > 0 ? above_m / slope : INFINITY;
            if (!(s_m + skip_m < end_m)) return;
            s_m += fmax(0, skip_m - 2 * piece_m);
            v3_add_scaled(a, line->a_enu, length_m > 0 ? s_m / length_m : 0, d);
        }
        const double next_m = fmin(s_m + piece_m, end_m);
        v3_add_scaled(b, line->a_enu, length_m > 0 ? next_m / length_m : 0, d);
        for (int k = 0; k < 3; k++) mid[k] = 0.5 * (a[k] + b[k]);
        const double low_m = fmin(a[2], b[2]);

        const int    tile_i = (int)clamp((mid[0] / z->spacing_m - z->i0) / tile_posts, 0, cutter->tiles.nx - 1);
        const int    tile_j = (int)clamp((mid[1] / z->spacing_m - z->j0) / tile_posts, 0, cutter->tiles.ny - 1);
        const double around_m = cutter->tiles.v[(size_t)tile_j * cutter->tiles.nx + tile_i];
        if (low_m - full_clearance_m < around_m && !in_hole(cutter->level, mid)) {
            const double touch_distance = touch_distance_m(cutter->lines, mid);
            if (!(touch_distance < taper_of_spacing_m(z->spacing_m)))
                seed_piece(cutter, a, b, low_m - clearance_m(cutter, mid, low_m, touch_distance));
        }
        if (next_m >= end_m) return;
    }
}

/* Lets the limit rise away from the seeded posts with the valley's slope: two chamfer sweeps over the part concerned.
 * */
static void spread_valleys(const Cutter *cutter)
{
    const Field *z = &cutter->level->z;
    const double reach = fmin((cutter->top_m - cutter->lowest_m) / (valley_slope * z->spacing_m) + 2, 32768);
    const int    wide = (int)fmax(reach, 2), nx = z->nx;
    const int    i0 = cutter->i0 - wide > 1 ? cutter->i0 - wide : 1;
    const int    i1 = cutter->i1 + wide < nx - 2 ? cutter->i1 + wide : nx - 2;
    const int    j0 = cutter->j0 - wide > 1 ? cutter->j0 - wide : 1;
    const int    j1 = cutter->j1 + wide < z->ny - 2 ? cutter->j1 + wide : z->ny - 2;
    const float  side = (float)(valley_slope * z->spacing_m), slant = (float)(valley_slope * z->spacing_m * sqrt(2.0));

    for (int j = j0; j <= j1; j++) {
        float *p = cutter->level->cap + (size_t)j * nx;
        for (int i = i0; i <= i1; i++) {
            const float south = fminf(p[i - nx] + side, fminf(p[i - nx - 1], p[i - nx + 1]) + slant);
            p[i] = fminf(p[i], south);
        }
        for (int i = i0; i <= i1; i++) p[i] = fminf(p[i], p[i - 1] + side);
    }
    for (int j = j1; j >= j0; j--) {
        float *p = cutter->level->cap + (size_t)j * nx;
        for (int i = i0; i <= i1; i++) {
            const float north = fminf(p[i + nx] + side, fminf(p[i + nx - 1], p[i + nx + 1]) + slant);
            p[i] = fminf(p[i], north);
        }
        for (int i = i1; i >= i0; i--) p[i] = fminf(p[i], p[i + 1] + side);
    }
}

Status line_cut(WorkLevel *level, int index, const LineSet *lines, FixSet *fixes)
{
    if (!lines->count) return STATUS_OK;
    Field       *z = &level->z;
    const size_t posts = (size_t)z->nx * z->ny;
    Cutter       cutter = {.level = level,
                           .lines = lines,
                           .fixes = fixes,
                           .core_m = sqrt(2.0) * z->spacing_m * 1.001,
                           .top_m = -INFINITY,
                           .i0 = z->nx,
                           .i1 = -1,
                           .j0 = z->ny,
                           .j1 = -1,
                           .lowest_m = INFINITY};
    const Status status = tile_maxima(&cutter.tiles, z);
    if (status != STATUS_OK) return status;
    for (int n = 0; n < fixes->count && !cutter.any_fix; n++)
        cutter.any_fix = !fixes->row[n].dropped && fixes->row[n].level == index;
    for (int n = 0; n < cutter.tiles.nx * cutter.tiles.ny; n++) cutter.top_m = fmax(cutter.top_m, cutter.tiles.v[n]);

    level->cap = malloc(posts * sizeof *level->cap);
    if (!level->cap) {
        levels_field_destroy(&cutter.tiles);
        return STATUS_NO_MEMORY;
    }
    for (size_t n = 0; n < posts; n++) level->cap[n] = no_cap_m;
    for (int n = 0; n < lines->count; n++) seed_line(&cutter, &lines->line[n]);
    levels_field_destroy(&cutter.tiles);
    if (cutter.i1 < cutter.i0) {
        free(level->cap);
        level->cap = NULL;
        return STATUS_OK;
    }

    spread_valleys(&cutter);
    for (size_t n = 0; n < posts; n++)
        if (!level->water || !level->water[n]) z->v[n] = z->v[n] < level->cap[n] ? z->v[n] : level->cap[n];

    /* drops rows that lie above the limit of the lines */
    const Field cap = {z->spacing_m, z->i0, z->j0, z->nx, z->ny, level->cap};
    for (int n = 0; n < fixes->count; n++) {
        FixRow *row = &fixes->row[n];
        int     corner[3];
        double  weight[3];
        if (row->dropped || row->level != index) continue;
        if (levels_height(&cap, row->x_m, row->y_m, corner, weight) < row->z_m - 0.02) row->dropped = true;
    }
    return STATUS_OK;
}
