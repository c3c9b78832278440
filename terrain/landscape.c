/* terrain/landscape.c: plan of the levels, and the order of the work.
 *
 * From the horizon inwards, in heights above the ellipsoid: refine the smooth field, add the hills of that
 * wavelength, pull in the fixes, push down under the lines. Where its control points are as fine as a level's
 * posts, the level is read off, bent over the curved Earth into ENU, joined to the level around it, cut by the
 * clear lines and moved onto its fixes. At the end everything is quantised, coarse before fine, so that edge
 * posts fall exactly on the level around them. */
#include "terrain/landscape_private.h"

#include <stdlib.h>

enum { ratio = 8, octaves_per_level = 3 }; /* 2^3 between the spacings of neighbouring levels */

LandscapeConfig landscape_default_config(void)
{
    /* 420 km: the horizon of an eye 10 km up is at 357, and hills stand behind it */
    return (LandscapeConfig){.seed = 1, .relief_m = 15, .spacing_m = 4, .half_width_m = 6000, .horizon_m = 420000};
}

double landscape_taper_m(const LandscapeConfig *config)
{
    return taper_of_spacing_m(config->spacing_m);
}

/* ---- curvature ---------------------------------------------------------------------------- */

void curve_of_frame(Curve *out, const LocalFrame *frame)
{
    static const double a_m = 6378137, b_m = 6356752.314245179498; /* WGS 84 */
    for (int k = 0; k < 3; k++) {
        const double inv = out->inv_scale[k] = 1 / (k < 2 ? a_m : b_m);
        out->origin[k] = frame->origin_ecef[k] * inv;
        out->east[k] = frame->r_ecef_from_enu[3 * k] * inv;
        out->north[k] = frame->r_ecef_from_enu[3 * k + 1] * inv;
        out->up[k] = frame->r_ecef_from_enu[3 * k + 2] * inv;
    }
}

void curve_at(const Curve *curve, double x_m, double y_m, double *z_m, double *dz_per_h)
{
    /* the vertical line at (x, y) meets the unit sphere where A z^2 + 2 B z + C = 0; C is zero at the origin,
     * so the root is taken without a difference */
    double q[3];
    for (int k = 0; k < 3; k++) q[k] = curve->origin[k] + x_m * curve->east[k] + y_m * curve->north[k];
    const double a = v3_dot(curve->up, curve->up), b = v3_dot(q, curve->up), c = v3_dot(q, q) - 1;
    const double root = sqrt(fmax(b * b - a * c, 0));
    const double z = -c / (b + root);

    /* the normal, in ECEF, is the scaled point scaled once more; up is already scaled once */
    double n[3];
    for (int k = 0; k < 3; k++) n[k] = (q[k] + z * curve->up[k]) * curve->inv_scale[k];
    const double nz = v3_dot(q, curve->up) + z * a;
    *z_m = z;
    *dz_per_h = v3_length(n) / fmax(nz, 1e-12);
}

/* Turns a level's heights above the ellipsoid into ENU z. Exact on every stride-th post, bilinear between: over
 * 64 m the ellipsoid bends by 0.1 mm. */
static Status bend(Field *posts, const Curve *curve)
{
    int stride = (int)(64 / posts->spacing_m);
    if (stride < 1) stride = 1;
    const int nx = (posts->nx - 1) / stride + 2;
    double   *z = malloc(4 * (size_t)nx * sizeof *z);
    if (!z) return STATUS_NO_MEMORY;

    /* two rows of exact values: z and dz/dh, south and north of the rows between them */
    double *z_of[2] = {z, z + nx}, *g_of[2] = {z + 2 * nx, z + 3 * nx};
    for (int j0 = 0; j0 < posts->ny; j0 += stride) {
        for (int side = 0; side < 2; side++)
            for (int c = 0; c < nx; c++)
                curve_at(curve, (posts->i0 + c * stride) * posts->spacing_m,
                         (posts->j0 + j0 + side * stride) * posts->spacing_m, &z_of[side][c], &g_of[side][c]);
        for (int j = j0; j < j0 + stride && j < posts->ny; j++) {
            const double v = (double)(j - j0) / stride;
            float       *row = posts->v + (size_t)j * posts->nx;
            for (int c = 0; c * stride < posts->nx; c++) {
                const double zw = z_of[0][c] + v * (z_of[1][c] - z_of[0][c]);
                const double ze = z_of[0][c + 1] + v * (z_of[1][c + 1] - z_of[0][c + 1]);
                const double g = g_of[0][c];
                const int    end = (c + 1) * stride < posts->nx ? stride : posts->nx - c * stride;
                for (int i = 0; i < end; i++)
                    row[c * stride + i] = (float)(zw + (ze - zw) * i / stride + g * row[c * stride + i]);
            }
        }
    }
    free(z);
    return STATUS_OK;
}

/* ---- plan --------------------------------------------------------------------------------- */

typedef struct Window {
    int i0, i1, j0, j1; /* inclusive, in posts of its level */
} Window;

typedef struct Work {
    int       level_count;
    double    spacing_m[elevation_max_levels];
    Window    window[elevation_max_levels];
    WorkLevel level[elevation_max_levels];
    Curve     curve;
    FixSet    fixes;
    LineSet   lines;
    Calm      calm;
    FieldAim *aim;
    int       aim_count;
    double    base_h_m;
} Work;

static int round_out(double posts)
{
    return (int)(posts < 0 ? floor(posts / ratio) : ceil(posts / ratio)) * ratio;
}

/* Level 0 is asked for about the origin; it grows to hold the fixes while that stays affordable. */
static Window innermost(const LandscapeConfig *config, const FixSet *fixes)
{
    static const double margin_m = 400, most_posts = 16e6;
    const int           half = round_out(config->half_width_m / config->spacing_m);
    const Window        plain = {-half, half, -half, half};

    /* all fixes; else those within twice the half width */
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
    static const double growth = 4.5; /* of half widths, at most, while there are levels to spare */

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

/* Height of the country where nothing is known: the middle of the fixes; without any, sea level or as much
 * lower as the lines need. */
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

    static const double below_m = 10;
    Curve               curve;
    curve_of_frame(&curve, frame);
    double base_m = 0;
    for (int n = 0; n < work->lines.count; n++)
        for (int k = 0; k < 3; k++) {
            double p[3], d[3], z_m, dz_per_h;
            v3_sub(d, work->lines.line[n].b_enu, work->lines.line[n].a_enu);
            v3_add_scaled(p, work->lines.line[n].a_enu, 0.5 * k, d);
            curve_at(&curve, p[0], p[1], &z_m, &dz_per_h);
            base_m = fmin(base_m, (p[2] - z_m) / dz_per_h - below_m);
        }
    work->base_h_m = fmax(base_m, lowest_ground_m);
    return STATUS_OK;
}

/* Fixes as aims, then the lines' ceilings; heights from the base. */
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
 * goes with wavelength: equal slopes, like worn-down country. */
static double octave_rms_m(double spacing_m, double relief_m)
{
    static const double knee_m = 512, largest_m = 8192;
    /* makes the squares of all octaves sum to 1: five alike from the knee up, a third of one below it */
    static const double normal = 0.433;
    if (spacing_m > largest_m) return 0;
    return relief_m * normal * fmin(1, spacing_m / knee_m);
}

/* Leads the posts near the outline over to the surface of the level around, on which the outline itself lies. */
static void join_outline(WorkLevel *level, const WorkLevel *outer)
{
    enum { band = 10 * ratio };
    Field *z = &level->z;
    for (int j = 0; j < z->ny; j++) {
        const int dj = j < z->ny - 1 - j ? j : z->ny - 1 - j;
        for (int i = 0; i < z->nx; i++) {
            const int di = i < z->nx - 1 - i ? i : z->nx - 1 - i, d = di < dj ? di : dj;
            if (d >= band) {
                i = z->nx - band - 1 > i ? z->nx - band - 1 : i; /* across the middle */
                continue;
            }
            int          corner[3];
            double       weight[3];
            const double around_m = posts_at(&outer->z, (z->i0 + i) * z->spacing_m, (z->j0 + j) * z->spacing_m,
                                             corner, weight);
            const double share = smooth_step(0, band, d);
            float       *post = &z->v[(size_t)j * z->nx + i];
            *post = (float)(around_m + share * (*post - around_m));
        }
    }
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

    status = bend(&level->z, &work->curve);
    if (status != STATUS_OK) return status;
    if (!level->outermost) join_outline(level, &work->level[k + 1]);
    status = line_cut(level, k, &work->lines, &work->fixes);
    if (status != STATUS_OK) return status;
    fit_posts(level, k, &work->fixes);
    free(level->cap);
    level->cap = NULL;
    return STATUS_OK;
}

/* Points of the spline that a level needs: a few more than its posts, in half the spacing per octave. */
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
    Status       status = field_create(&spline, spacing_m, w.i0, w.j0, w.i1 - w.i0 + 1, w.j1 - w.j0 + 1);
    if (status != STATUS_OK) return status;

    for (int octave = 0;; octave++) {
        const bool finest = k == 0 && spacing_m == work->spacing_m[0];
        /* hills shorter than two of the finest posts would only roughen the triangles */
        if (!finest)
            field_add_hills(&spline, landscape_hash(config->seed, 1, octave), octave_rms_m(spacing_m, config->relief_m),
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
        field_destroy(&spline);
        spline = fine;
        spacing_m /= 2;
    }
    field_destroy(&spline);
    return status;
}

/* ---- quantisation ------------------------------------------------------------------------- */

typedef struct Quanta {
    double z0_m, step_m;
} Quanta;

/* Power-of-two step that holds the level's heights; origin a multiple of every step that can occur. */
static Quanta choose_quanta(const Field *z)
{
    static const double finest_m = 0x1p-8, origin_m = 64;
    float               low = z->v[0], high = z->v[0];
    const size_t        posts = (size_t)z->nx * z->ny;
    for (size_t n = 0; n < posts; n++) {
        low = low < z->v[n] ? low : z->v[n];
        high = high > z->v[n] ? high : z->v[n];
    }
    Quanta q = {.z0_m = floor((low - 16) / origin_m) * origin_m, .step_m = finest_m};
    while ((high + 16 - q.z0_m) / q.step_m > 65535) q.step_m *= 2;
    return q;
}

/* Posts of the hole's outline become multiples of the coarse step and of 8 fine steps, rounded down (towards
 * clear lines): then the seven posts between them are whole fine steps. */
static void quantise(Elevation *elevation, const Work *work, const Quanta *quanta)
{
    for (int k = work->level_count - 1; k >= 0; k--) {
        const WorkLevel *level = &work->level[k];
        const Field     *z = &level->z;
        ElevationLevel  *to = &elevation->level[k];
        const float      inv_step = (float)(1 / quanta[k].step_m), z0 = (float)quanta[k].z0_m;
        /* coarse steps may rival the clearance of lines: round down there */
        const float  half = k < 2 ? 0.5f : 0.0f;
        const size_t posts = (size_t)z->nx * z->ny;
        for (size_t n = 0; n < posts; n++) to->post[n] = (uint16_t)((z->v[n] - z0) * inv_step + half);

        if (k > 0) {
            const double coarse = fmax(quanta[k].step_m, ratio * quanta[k - 1].step_m);
            for (int j = level->hole_j0; j <= level->hole_j1; j++)
                for (int i = level->hole_i0; i <= level->hole_i1; i++) {
                    const bool rim = i == level->hole_i0 || i == level->hole_i1 || j == level->hole_j0 ||
                                     j == level->hole_j1;
                    if (!rim) {
                        i = level->hole_i1 - 1;
                        continue;
                    }
                    const size_t at = (size_t)(j - z->j0) * z->nx + (i - z->i0);
                    to->post[at] = (uint16_t)((floor(z->v[at] / coarse) * coarse - quanta[k].z0_m) / quanta[k].step_m);
                }
        }
        if (level->outermost) continue;

        const ElevationLevel *outer = &elevation->level[k + 1];
        const int oi = z->i0 / ratio - work->level[k + 1].z.i0, oj = z->j0 / ratio - work->level[k + 1].z.j0;
        for (int side = 0; side < 4; side++) {
            const bool along_x = side < 2, far_side = side & 1;
            const int  n = along_x ? z->nx : z->ny;
            for (int m = 0; m < n; m++) {
                const int    i = along_x ? m : far_side ? z->nx - 1 : 0, j = along_x ? far_side ? z->ny - 1 : 0 : m;
                const int    c = m / ratio, part = m % ratio;
                const size_t a = (size_t)(oj + (along_x ? j / ratio : c)) * outer->nx + oi + (along_x ? c : i / ratio);
                const size_t b = part ? a + (along_x ? 1 : (size_t)outer->nx) : a;
                const double za = outer->z0_m + outer->step_m * outer->post[a];
                const double zb = outer->z0_m + outer->step_m * outer->post[b];
                to->post[(size_t)j * z->nx + i] =
                    (uint16_t)((za + (zb - za) * part / ratio - quanta[k].z0_m) / quanta[k].step_m);
            }
        }
    }
}

static Status store(Elevation *out, const Work *work)
{
    Elevation elevation = {0};
    Quanta    quanta[elevation_max_levels];
    for (int k = 0; k < work->level_count; k++) {
        const Field *z = &work->level[k].z;
        quanta[k] = choose_quanta(z);
        const Status status =
            elevation_level_create(&elevation, k, z->nx, z->ny, z->i0 * z->spacing_m, z->j0 * z->spacing_m,
                                   z->spacing_m, quanta[k].z0_m, quanta[k].step_m);
        if (status != STATUS_OK) {
            elevation_destroy(&elevation);
            return status;
        }
    }
    quantise(&elevation, work, quanta);
    elevation_build_pyramids(&elevation);
    *out = elevation;
    return STATUS_OK;
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

/* A fix that only shares a row is met through its neighbour; where that leaves it more than 5 cm off (at 4 m
 * posts) the neighbours have contradicted it. */
static void count_fixes(Landscape *landscape, const Work *work, const GroundFix *fix, int fix_count)
{
    for (int n = 0; n < fix_count; n++) {
        const int     number = work->fixes.row_of_fix[n];
        const FixRow *row = number < 0 ? NULL : &work->fixes.row[number];
        const double  z_m = elevation_height(&landscape->elevation, fix[n].p_enu[0], fix[n].p_enu[1], NULL);
        const double  off_m = fabs(z_m - fix[n].p_enu[2]);
        if (!row || row->dropped ||
            (row->fix != n && off_m > 0.05 * fmax(1, work->spacing_m[row->level] / 4))) {
            landscape->fixes_dropped++;
            continue;
        }
        landscape->fit_worst_m = fmax(landscape->fit_worst_m, off_m);
    }
}

Status landscape_create(Landscape *out, const LandscapeConfig *config, const LocalFrame *frame,
                        const GroundFix *fix, int fix_count, const ClearLine *line, int line_count)
{
    if (!config_ok(config) || fix_count < 0 || line_count < 0) return STATUS_BAD_VALUE;
    if (!v3_is_finite(frame->origin_ecef)) return STATUS_BAD_VALUE;

    Landscape landscape = {.frame = *frame, .config = *config};
    /* dyadic, so that every post's place is exact */
    landscape.config.spacing_m = rint(config->spacing_m * 64) / 64;
    config = &landscape.config;

    Work   work = {0};
    Cover *cover = calloc(1, sizeof *cover);
    Status status = cover ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = fix_set_create(&work.fixes, frame, fix, fix_count, config->horizon_m);
    if (status == STATUS_OK)
        status = line_set_create(&work.lines, line, line_count, frame, &work.fixes, config->horizon_m);
    if (status != STATUS_OK) goto done;

    curve_of_frame(&work.curve, frame);
    plan_levels(&work, config);
    status = choose_base(&work, frame);
    if (status == STATUS_OK) status = gather_aims(&work, config, frame);
    if (status == STATUS_OK) status = calm_create(&work.calm, &work.fixes, 64);
    if (status == STATUS_OK) status = grow_levels(&work, config);
    if (status == STATUS_OK) status = store(&landscape.elevation, &work);
    if (status != STATUS_OK) goto done;

    count_fixes(&landscape, &work, fix, fix_count);
    cover->seed = landscape_hash(config->seed, 2, 0);
    landscape.cover = cover;
    cover = NULL;
    *out = landscape;

done:
    free(cover);
    free(work.aim);
    field_destroy(&work.calm.factor);
    for (int k = 0; k < elevation_max_levels; k++) {
        field_destroy(&work.level[k].z);
        free(work.level[k].cap);
    }
    line_set_destroy(&work.lines);
    fix_set_destroy(&work.fixes);
    return status;
}

void landscape_destroy(Landscape *landscape)
{
    if (!landscape) return;
    elevation_destroy(&landscape->elevation);
    free(landscape->cover);
    *landscape = (Landscape){0};
}
