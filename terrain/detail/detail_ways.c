/* terrain/detail/detail_ways.c: what lies along ways and fields: wheel paths and worn edges of roads, ruts and the
 * grassy middle of tracks, rows of crops and furrows. Estimates, all of them. */
#include "terrain/detail/detail.h"
#include "terrain/elevation/levels.h"
#include "terrain/invented/invented_eight.h"

/* What a detail adds to the factors of 1, and to the other values. */
typedef struct Added {
    double albedo, warmth_k, radar, slope; /* slope: across */
} Added;

/* 1 for a width of four footprints, 0 for two. */
static double fade(double width_m, double footprint_m) { return 1 - smooth_step(0.25, 0.5, footprint_m / width_m); }

static void add_at(const GroundDetail *out, int n, const Added *a, const double across[2], bool albedo)
{
    if (out->albedo && albedo) out->albedo[n] *= (float)fmax(1 + a->albedo, 0.2);
    if (out->warmth_k) out->warmth_k[n] += (float)a->warmth_k;
    if (out->radar) out->radar[n] *= (float)fmax(1 + a->radar, 0.1);
    if (out->slope_x) {
        out->slope_x[n] += (float)(a->slope * across[0]);
        out->slope_y[n] += (float)(a->slope * across[1]);
    }
}

/* ---- ways ------------------------------------------------------------------------------------- */

/* A strip along a way on both sides of its middle, in section a Gaussian. */
typedef struct Strip {
    double at_m, deviation_m;
    bool   of_edge;                 /* at_m is beyond the edge */
    double albedo, warmth_k, radar; /* values at its middle; the mean over the way is subtracted */
    double height_m;
} Strip;

static const Strip road_strips[] = {
    {0.75, 0.28, false, -0.07, 0.15, -0.10, -0.006},
    {2.25, 0.28, false, -0.07, 0.15, -0.10, -0.006},
    {1.5, 0.25, false, -0.04, 0.05, 0, 0},
    {0, 0.22, true, 0.22, -0.25, 0.50, -0.010},
};
static const Strip lane_strips[] = {
    {0.8, 0.3, false, -0.06, 0.15, -0.10, -0.008},
    {0, 0.3, true, 0.25, -0.25, 0.50, -0.015},
};
static const Strip track_strips[] = {
    {0.8, 0.2, false, 0.12, 0.25, -0.25, -0.045},
    {0, 0.3, false, -0.14, -0.35, 0.30, 0.010}, /* at the middle, both halves overlap */
};

/* Filtered by a footprint, whose section is taken as a Gaussian of its variance. */
static Added section(const Strip *strip, int strips, double half_m, double across_m, double footprint_m)
{
    static const double root_of_two_pi = 2.5066282746310002;
    Added               sum = {0};
    for (int n = 0; n < strips; n++) {
        const Strip *s = &strip[n];
        const double at_m = s->of_edge ? half_m + s->at_m : s->at_m, variance = s->deviation_m * s->deviation_m;
        const double wider = variance + footprint_m * footprint_m / 12, lower = sqrt(variance / wider);
        const double left_m = across_m - at_m, right_m = across_m + at_m;
        const double left = lower * exp(-left_m * left_m / (2 * wider));
        const double right = lower * exp(-right_m * right_m / (2 * wider));
        const double mean = root_of_two_pi * s->deviation_m / (2 * half_m) * (s->of_edge ? 1 : 2);
        const double here = left + right - mean;
        sum.albedo += s->albedo * here, sum.warmth_k += s->warmth_k * here, sum.radar += s->radar * here;
        sum.slope -= s->height_m * (left * left_m + right * right_m) / wider;
    }
    const double share = fade(2 * half_m, footprint_m);
    return (Added){share * sum.albedo, share * sum.warmth_k, share * sum.radar, share * sum.slope};
}

/* Tracks between fields have no segments of their own. */
static bool field_track(double *away_m, double across[2], uint64_t seed, double x_m, double y_m)
{
    PlotBorder border;
    uint64_t   fields;
    if (!plot_border_about(&border, across, &fields, seed, x_m, y_m) || !border.track) return false;
    *away_m = border.away_m;
    return *away_m < 2.5;
}

static void way_detail(const GroundDetail *out, int n, const Landscape *landscape, SurfaceClass surface, double x_m,
                       double y_m, double footprint_m)
{
    enum {
        roads = sizeof road_strips / sizeof *road_strips,
        lanes = sizeof lane_strips / sizeof *lane_strips,
        tracks = sizeof track_strips / sizeof *track_strips
    };
    WayPlace way;
    double   across[2], away_m;
    Added    added;
    uint64_t seed;
    (void)landscape_seed(&seed, landscape);
    if (landscape_way(&way, landscape, x_m, y_m) && way.kind <= WAY_TRACK &&
        (way.kind == WAY_TRACK) == (surface == SURFACE_TRACK)) {
        across[0] = -way.direction[1], across[1] = way.direction[0];
        added = way.kind == WAY_ROAD   ? section(road_strips, roads, way.half_m, way.across_m, footprint_m)
                : way.kind == WAY_LANE ? section(lane_strips, lanes, way.half_m, way.across_m, footprint_m)
                                       : section(track_strips, tracks, way.half_m, way.across_m, footprint_m);
    } else if (surface == SURFACE_TRACK && landscape_is_synthetic(landscape) &&
               field_track(&away_m, across, seed, x_m, y_m)) {
        added = section(track_strips, tracks, 2, away_m, footprint_m);
    } else {
        return;
    }
    add_at(out, n, &added, across, true);
}

/* ---- rows of fields --------------------------------------------------------------------------- */

typedef struct Rows {
    SurfaceClass class;
    double apart_m, albedo, warmth_k, radar, height_m; /* amplitudes; height_m: from furrow to ridge */
} Rows;

static const Rows rows_of_class[] = {{SURFACE_CROP, 0.75, 0.08, -0.10, 0.15, 0.020},
                                     {SURFACE_PLOUGHED, 1.1, 0.08, -0.15, 0.20, 0.045}};

/* Unit vectors across the rows of the fields in which eight places lie. */
static void across_rows(float across_x[8], float across_y[8], uint64_t seed, const double x_m[8], const double y_m[8],
                        unsigned lanes)
{
    double i[8], j[8], bent_x[8], bent_y[8];
    F32x8  x, y, to_x = f32x8_set(0), to_y = f32x8_set(0);
    plot_bend(bent_x, bent_y, seed, x_m, y_m);
    plot_cells_of(i, j, &x, &y, bent_x, bent_y);
    for (unsigned left = lanes, same; left; left &= ~same) {
        same = plot_cell_lanes(i, j, left);
        const int       first = __builtin_ctz(left);
        const PlotCell *cell = plot_cell_at(seed, (int64_t)i[first], (int64_t)j[first]);
        const F32x8     mask = f32x8_mask(same);
        I32x8           site;
        (void)plot_nearest(&site, cell, x, y);
        to_x = f32x8_select(mask, f32x8_gather(cell->across_x, site), to_x);
        to_y = f32x8_select(mask, f32x8_gather(cell->across_y, site), to_y);
    }
    f32x8_store(across_x, to_x), f32x8_store(across_y, to_y);
}

/* A smooth wave of mean 0 across the rows. */
static Added row_at(const Rows *rows, double across_m, double share)
{
    const double f = across_m / rows->apart_m, whole = 2 * (f - floor(f)) - 1,
                 t = fabs(whole); /* falls from 1 to 0 and rises to 1 again */
    const double wave = share * (2 * t * t * (3 - 2 * t) - 1), rise = share * 24 * whole * (1 - t) / rows->apart_m;
    return (Added){rows->albedo * wave, rows->warmth_k * wave, rows->radar * wave, 0.5 * rows->height_m * rise};
}

static void rows_detail(const GroundDetail *out, int first, const Landscape *landscape, const Rows *rows,
                        const double x_m[8], const double y_m[8], const float *footprint_m, unsigned lanes)
{
    uint64_t seed;
    float    across_x[8], across_y[8], photo_m[8];
    (void)landscape_seed(&seed, landscape);
    across_rows(across_x, across_y, seed, x_m, y_m, lanes);
    landscape_photo_cells(photo_m, landscape, x_m, y_m, lanes);
    for (; lanes; lanes &= lanes - 1) {
        const int    k = __builtin_ctz(lanes);
        const double across[2] = {(double)across_x[k], (double)across_y[k]};
        /* from two of its pixels on, a photograph shows the rows itself */
        const bool  seen = photo_m[k] > 0 && (double)photo_m[k] < rows->apart_m / 2;
        const Added added =
            row_at(rows, x_m[k] * across[0] + y_m[k] * across[1], fade(rows->apart_m, (double)footprint_m[first + k]));
        add_at(out, first + k, &added, across, !seen);
    }
}

bool detail_row(double place_m[2], const Landscape *landscape, SurfaceClass surface, double x_m, double y_m)
{
    uint64_t   seed;
    double     x[8], y[8];
    float      across_x[8], across_y[8];
    const bool covered = landscape_seed(&seed, landscape);
    for (size_t r = 0; covered && r < sizeof rows_of_class / sizeof *rows_of_class; r++) {
        if (rows_of_class[r].class != surface) continue;
        for (int k = 0; k < 8; k++) x[k] = x_m, y[k] = y_m;
        across_rows(across_x, across_y, seed, x, y, 1);
        const double rows = (x_m * (double)across_x[0] + y_m * (double)across_y[0]) / rows_of_class[r].apart_m;
        const double off_m = (round(rows) - rows) * rows_of_class[r].apart_m;
        place_m[0] = x_m + off_m * (double)across_x[0], place_m[1] = y_m + off_m * (double)across_y[0];
        return true;
    }
    return false;
}

/* ---- both ------------------------------------------------------------------------------------- */

void detail_ways(const GroundDetail *detail, const Landscape *landscape, int count, const uint8_t *surface,
                 const double *x_m, const double *y_m, const float *footprint_m)
{
    enum { row_kinds = sizeof rows_of_class / sizeof *rows_of_class };
    static const double widest_m = 3; /* in footprints: the width below which nothing is left */
    uint64_t            seed;
    if (!landscape_seed(&seed, landscape)) return;
    for (int first = 0; first < count; first += 8) {
        double    x[8] = {0}, y[8] = {0};
        unsigned  lanes[row_kinds] = {0};
        const int some = count - first < 8 ? count - first : 8;
        for (int k = 0; k < some; k++) {
            const int n = first + k;
            if (!((double)footprint_m[n] < widest_m) || !isfinite(x_m[n]) || !isfinite(y_m[n])) continue;
            x[k] = x_m[n], y[k] = y_m[n];
            if (surface[n] == SURFACE_ROAD || surface[n] == SURFACE_TRACK)
                way_detail(detail, n, landscape, (SurfaceClass)surface[n], x_m[n], y_m[n], (double)footprint_m[n]);
            for (int r = 0; r < row_kinds; r++)
                if (surface[n] == rows_of_class[r].class && (double)footprint_m[n] < rows_of_class[r].apart_m / 2)
                    lanes[r] |= 1u << k;
        }
        for (int r = 0; r < row_kinds; r++)
            if (lanes[r]) rows_detail(detail, first, landscape, &rows_of_class[r], x, y, footprint_m, lanes[r]);
    }
}
