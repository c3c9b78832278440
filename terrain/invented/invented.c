/* terrain/invented/invented.c: the posts of invented ground: layout of the levels, and the sequence of steps.
 *
 * From the horizon inwards, in heights above the ellipsoid: refine the smooth field, add the hills of that
 * wavelength, pull in the fixes, push down under the lines. Where its control points are as fine as a level's
 * posts, the level is read off, bent over the curved Earth into ENU, joined to the level around it, cut by the
 * clear lines and moved onto its fixes. At the end everything is quantised, coarse before fine, so that edge
 * posts fall exactly on the level around them. */
#include "terrain/invented/invented_private.h"

#include <stdlib.h>

enum { ratio = level_ratio };

double invented_taper_m(const LandscapeConfig *config) { return taper_of_spacing_m(config->spacing_m); }

/* ---- plan --------------------------------------------------------------------------------- */

typedef struct Window {
    int i0, i1, j0, j1; /* range of posts of its level, inclusive */
} Window;

typedef struct Work {
    int       level_count;
    double    spacing_m[elevation_max_levels];
    Window    window[elevation_max_levels];
    WorkLevel level[elevation_max_levels];
    Curve     curve;
    FixSet    fixes;
    LineSet   lines;
    Coast     coast;
    Calm      calm;
    FieldAim *aim;
    int       aim_count;
    double    base_h_m;
} Work;

static int round_out(double posts) { return (int)(posts < 0 ? floor(posts / ratio) : ceil(posts / ratio)) * ratio; }

/* The window of level 0, which is centred on the origin and grows to hold the fixes while that is affordable. */
static Window innermost(const LandscapeConfig *config, const FixSet *fixes)
{
    static const double margin_m = 400, most_posts = 16e6;
    const int           half = round_out(config->half_width_m / config->spacing_m);
    const Window        plain = {-half, half, -half, half};

    /* tries to hold all fixes, then only those within twice the half width */
    for (int attempt = 0; attempt < 2; attempt++) {
        const double reach_m = attempt ? 2 * config->half_width_m : INFINITY;
        Window       w = plain;
        double       x0 = 0, x1 = 0, y0 = 0, y1 = 0;
        for (int n = 0; n < fixes->count; n++) {
            const FixRow *row = &fixes->row[n];
            if (row->dropped || fabs(row->x_m) > reach_m || fabs(row->y_m) > reach_m) continue;
            x0 = fmin(x0, row->x_m - margin_m);
            x1 = fmax(x1, row->x_m + margin_m);
            y0 = fmin(y0, row->y_m - margin_m);
            y1 = fmax(y1, row->y_m + margin_m);
        }
        const double s = config->spacing_m;
        if (!((x1 - x0) / s * ((y1 - y0) / s) <= most_posts)) continue;
        if (round_out(x0 / s) < w.i0) w.i0 = round_out(x0 / s);
        if (round_out(x1 / s) > w.i1) w.i1 = round_out(x1 / s);
        if (round_out(y0 / s) < w.j0) w.j0 = round_out(y0 / s);
        if (round_out(y1 / s) > w.j1) w.j1 = round_out(y1 / s);
        const double posts = (double)(w.i1 - w.i0 + 1) * (w.j1 - w.j0 + 1);
        if (posts <= most_posts || attempt) return posts <= most_posts ? w : plain;
    }
    return plain;
}

static void plan_levels(Work *work, const LandscapeConfig *config)
{
    enum { least_ring = 2 * ratio };
    static const double growth = 4.5; /* largest ratio of neighbouring half widths, while there are levels to spare */

    const double widths = config->horizon_m / config->half_width_m;
    int          levels = 1;
    if (widths > 1) levels = 1 + (int)ceil(log(widths) / log(growth));
    if (levels > elevation_max_levels) levels = elevation_max_levels;
    work->level_count = levels;
    work->spacing_m[0] = config->spacing_m;
    work->window[0] = innermost(config, &work->fixes);
    for (int k = 1; k < levels; k++) {
        const double s = work->spacing_m[k] = ratio * work->spacing_m[k - 1];
        const int    half = round_out(config->half_width_m * pow(widths, k / (levels - 1.0)) / s);
        const Window in = work->window[k - 1];
        Window       w = {-half, half, -half, half};
        if (w.i0 > round_out(in.i0 / ratio - least_ring)) w.i0 = round_out(in.i0 / ratio - least_ring);
        if (w.i1 < round_out(in.i1 / ratio + least_ring)) w.i1 = round_out(in.i1 / ratio + least_ring);
        if (w.j0 > round_out(in.j0 / ratio - least_ring)) w.j0 = round_out(in.j0 / ratio - least_ring);
        if (w.j1 < round_out(in.j1 / ratio + least_ring)) w.j1 = round_out(in.j1 / ratio + least_ring);
        work->window[k] = w;
    }

    for (int n = 0; n < work->fixes.count; n++) {
        FixRow *row = &work->fixes.row[n];
        row->level = -1;
        for (int k = 0; k < levels && row->level < 0; k++) {
            const double x = row->x_m / work->spacing_m[k], y = row->y_m / work->spacing_m[k];
            const Window w = work->window[k];
            if (x >= w.i0 && x <= w.i1 && y >= w.j0 && y <= w.j1) row->level = k;
        }
        if (row->level < 0) row->dropped = true;
    }
}

static int by_value(const void *pa, const void *pb)
{
    const double a = *(const double *)pa, b = *(const double *)pb;
    return (a > b) - (a < b);
}

/* Chooses the height of the terrain away from fixes: the median of the fixes. Without fixes it is the sea's height or
 * else the ellipsoid's, or as much lower as the lines require. */
static Status choose_base(Work *work, const LocalFrame *frame)
{
    double *h = malloc(((size_t)work->fixes.count + 1) * sizeof *h);
    if (!h) return STATUS_NO_MEMORY;
    int count = 0;
    for (int n = 0; n < work->fixes.count; n++)
        if (!work->fixes.row[n].dropped) h[count++] = work->fixes.row[n].h_m;
    if (count) {
        qsort(h, (size_t)count, sizeof *h, by_value);
        work->base_h_m = h[count / 2];
        free(h);
        return STATUS_OK;
    }
    free(h);
    if (work->coast.sea_count) {
        work->base_h_m = work->coast.h_m;
        return STATUS_OK;
    }

    static const double below_m = 10;
    Curve               curve;
    levels_curve(&curve, frame);
    double base_m = 0;
    for (int n = 0; n < work->lines.count; n++)
        for (int k = 0; k < 3; k++) {
            double p[3], d[3], z_m, dz_per_h;
            v3_sub(d, work->lines.line[n].b_enu, work->lines.line[n].a_enu);
            v3_add_scaled(p, work->lines.line[n].a_enu, 0.5 * k, d);
            levels_curve_at(&curve, p[0], p[1], &z_m, &dz_per_h);
            base_m = fmin(base_m, (p[2] - z_m) / dz_per_h - below_m);
        }
    work->base_h_m = fmax(base_m, lowest_ground_m);
    return STATUS_OK;
}

/* Collects fixes as aims, then the lines' ceilings, with heights relative to the base. */
static Status gather_aims(Work *work, const LandscapeConfig *config, const LocalFrame *frame)
{
    double top_m = work->base_h_m + 8 * config->relief_m + 50;
    for (int n = 0; n < work->fixes.count; n++)
        if (!work->fixes.row[n].dropped) top_m = fmax(top_m, work->fixes.row[n].h_m + 8 * config->relief_m);

    FieldAim *ceiling;
    int       ceilings;
    Status    status = line_ceilings(&ceiling, &ceilings, &work->lines, frame, top_m);
    if (status != STATUS_OK) return status;
    work->aim = malloc(((size_t)work->fixes.count + (size_t)ceilings + 1) * sizeof *work->aim);
    if (!work->aim) {
        free(ceiling);
        return STATUS_NO_MEMORY;
    }
    for (int n = 0; n < work->fixes.count; n++) {
        const FixRow *row = &work->fixes.row[n];
        if (!row->dropped) work->aim[work->aim_count++] = (FieldAim){row->x_m, row->y_m, row->h_m, false};
    }
    for (int n = 0; n < ceilings; n++) work->aim[work->aim_count++] = ceiling[n];
    for (int n = 0; n < work->aim_count; n++) work->aim[n].h_m -= work->base_h_m;
    free(ceiling);
    return STATUS_OK;
}

/* ---- levels ------------------------------------------------------------------------------- */

/* rms height of the hills of one octave. Above half a kilometre all wavelengths are equally high, below it height
 * goes with wavelength: equal slopes, like eroded terrain. */
static double octave_rms_m(double spacing_m, double relief_m)
{
    static const double knee_m = 512, largest_m = 8192;
    /* makes the squares of all octaves sum to 1: above the knee five octaves are equal, below it each adds a third of
     * the one before */
    static const double normal = 0.433;
    if (spacing_m > largest_m) return 0;
    return relief_m * normal * fmin(1, spacing_m / knee_m);
}

static Status read_level(Work *work, int k, const Field *spline)
{
    WorkLevel   *level = &work->level[k];
    const Window w = work->window[k];
    *level = (WorkLevel){.hole_i0 = 0, .hole_i1 = -1, .outermost = k == work->level_count - 1};
    Status status = field_posts(&level->z, spline, w.i0, w.j0, w.i1 - w.i0 + 1, w.j1 - w.j0 + 1);
    if (status != STATUS_OK) return status;
    const size_t posts = (size_t)level->z.nx * level->z.ny;
    for (size_t n = 0; n < posts; n++) level->z.v[n] += (float)work->base_h_m;
    if (k > 0) {
        level->hole_i0 = work->window[k - 1].i0 / ratio;
        level->hole_i1 = work->window[k - 1].i1 / ratio;
        level->hole_j0 = work->window[k - 1].j0 / ratio;
        level->hole_j1 = work->window[k - 1].j1 / ratio;
    }

    status = coast_shape(level, &work->coast);
    if (status != STATUS_OK) return status;
    status = levels_bend(&level->z, &work->curve);
    if (status != STATUS_OK) return status;
    if (!level->outermost) levels_join(level, &work->level[k + 1], 10 * ratio);
    status = line_cut(level, k, &work->lines, &work->fixes);
    if (status != STATUS_OK) return status;
    fit_posts(level, k, &work->fixes);
    free(level->cap);
    free(level->water);
    level->cap = NULL;
    level->water = NULL;
    return STATUS_OK;
}

/* The window of the spline that a level needs: a few points more than the level has posts, at half the spacing for each
 * octave. */
static Window window_at(const Work *work, int k, double spacing_m, int margin)
{
    const double scale = work->spacing_m[k] / spacing_m;
    const Window w = work->window[k];
    return (Window){(int)floor(w.i0 * scale) - margin, (int)ceil(w.i1 * scale) + margin,
                    (int)floor(w.j0 * scale) - margin, (int)ceil(w.j1 * scale) + margin};
}

static Status grow_levels(Work *work, const LandscapeConfig *config)
{
    enum { margin = 6, top_octaves = 5 };
    int          k = work->level_count - 1;
    double       spacing_m = work->spacing_m[k] * (1 << top_octaves);
    const Window w = window_at(work, k, spacing_m, margin);
    Field        spline;
    Status       status = levels_field_create(&spline, spacing_m, w.i0, w.j0, w.i1 - w.i0 + 1, w.j1 - w.j0 + 1);
    if (status != STATUS_OK) return status;

    for (int octave = 0;; octave++) {
        const bool finest = k == 0 && spacing_m == work->spacing_m[0];
        /* hills shorter than two of the finest posts would only roughen the triangles */
        if (!finest)
            field_add_hills(&spline, invented_hash(config->seed, 1, octave), octave_rms_m(spacing_m, config->relief_m),
                            &work->calm);
        status = field_pull(&spline, work->aim, work->aim_count);
        if (status == STATUS_OK && spacing_m == work->spacing_m[k]) {
            status = read_level(work, k, &spline);
            k--;
        }
        if (status != STATUS_OK || k < 0) break;

        const Window n = window_at(work, k, spacing_m / 2, margin);
        Field        fine;
        status = field_refine(&fine, &spline, n.i0, n.j0, n.i1 - n.i0 + 1, n.j1 - n.j0 + 1);
        if (status != STATUS_OK) break;
        levels_field_destroy(&spline);
        spline = fine;
        spacing_m /= 2;
    }
    levels_field_destroy(&spline);
    return status;
}

/* ---- the whole ---------------------------------------------------------------------------- */

static bool config_ok(const LandscapeConfig *config)
{
    if (!(config->relief_m >= 0 && config->relief_m <= 200)) return false;
    if (!(config->spacing_m >= 1 && config->spacing_m <= 30)) return false;
    if (!(config->half_width_m >= 32 * config->spacing_m && config->half_width_m <= 3000 * config->spacing_m))
        return false;
    return config->horizon_m >= config->half_width_m && config->horizon_m <= 1e6;
}

/* Counts fixes that are not fitted. A fix that shares another's row is fitted through that; with a residual above 5 cm
 * (at 4 m posts) it is inconsistent. */
static void count_fixes(InventedTerrain *terrain, const Work *work, const GroundFix *fix, int fix_count)
{
    for (int n = 0; n < fix_count; n++) {
        const int     number = work->fixes.row_of_fix[n];
        const FixRow *row = number < 0 ? NULL : &work->fixes.row[number];
        const double  z_m = elevation_height(&terrain->elevation, fix[n].p_enu[0], fix[n].p_enu[1], NULL);
        const double  off_m = fabs(z_m - fix[n].p_enu[2]);
        if (!row || row->dropped || (row->fix != n && off_m > 0.05 * fmax(1, work->spacing_m[row->level] / 4))) {
            terrain->fixes_dropped++;
            continue;
        }
        terrain->fit_worst_m = fmax(terrain->fit_worst_m, off_m);
    }
}

/* Drops fixes on the water, which do not give the land's height. */
static void drop_fixes_at_sea(Work *work)
{
    for (int n = 0; work->coast.sea_count && n < work->fixes.count; n++) {
        FixRow *row = &work->fixes.row[n];
        if (coast_at(&work->coast, row->x_m, row->y_m) == COAST_SEA) row->dropped = true;
    }
}

Status invented_create(InventedTerrain *out, const LandscapeConfig *config, const LocalFrame *frame,
                       const LandscapeEvidence *evidence)
{
    const GroundFix *fix = evidence->fix;
    const ClearLine *line = evidence->line;
    const int        fix_count = evidence->fix_count, line_count = evidence->line_count;
    if (!config_ok(config) || fix_count < 0 || line_count < 0 || evidence->place_count < 0) return STATUS_BAD_VALUE;
    if (!v3_is_finite(frame->origin_ecef)) return STATUS_BAD_VALUE;

    InventedTerrain terrain = {.ground.seed = invented_hash(config->seed, 2, 0)};
    Work            work = {0};
    Status          status = fix_set_create(&work.fixes, frame, fix, fix_count, config->horizon_m);
    if (status == STATUS_OK) status = coast_create(&work.coast, evidence, invented_hash(config->seed, 3, 0));
    if (status == STATUS_OK) drop_fixes_at_sea(&work);
    if (status == STATUS_OK)
        status = line_set_create(&work.lines, line, line_count, frame, &work.fixes, config->horizon_m);
    if (status != STATUS_OK) goto done;

    levels_curve(&work.curve, frame);
    plan_levels(&work, config);
    status = choose_base(&work, frame);
    if (status == STATUS_OK) status = gather_aims(&work, config, frame);
    if (status == STATUS_OK) status = calm_create(&work.calm, &work.fixes, 64);
    if (status == STATUS_OK) status = grow_levels(&work, config);
    if (status == STATUS_OK) status = levels_store(&terrain.elevation, work.level, work.level_count);
    if (status != STATUS_OK) goto done;

    count_fixes(&terrain, &work, fix, fix_count);
    status = ways_create(&terrain.ground.ways, &(WaysGround){.elevation = &terrain.elevation,
                                                             .coast = &work.coast,
                                                             .seed = terrain.ground.seed,
                                                             .fix_count = fix_count,
                                                             .fix = fix});
    if (status != STATUS_OK) goto done;
    terrain.ground.coast = work.coast;
    work.coast = (Coast){0};
    *out = terrain;

done:
    if (status != STATUS_OK) elevation_destroy(&terrain.elevation);
    free(work.aim);
    levels_field_destroy(&work.calm.factor);
    for (int k = 0; k < elevation_max_levels; k++) {
        levels_field_destroy(&work.level[k].z);
        free(work.level[k].cap);
        free(work.level[k].water);
    }
    coast_destroy(&work.coast);
    line_set_destroy(&work.lines);
    fix_set_destroy(&work.fixes);
    return status;
}

void invented_ground_free(InventedGround *ground)
{
    coast_destroy(&ground->coast);
    ways_free(ground->ways);
}
