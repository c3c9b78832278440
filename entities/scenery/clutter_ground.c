/* entities/scenery/clutter_ground.c: where clutter can stand: classes of ground, slopes, what the exercise needs. */
#include "entities/scenery/scenery_clutter_private.h"

#include <stdlib.h>

/* Reported places and clear lines by the cells of a square that they touch. */
struct ClutterSpots {
    const ClutterConfig     *config;
    const LandscapeEvidence *evidence;
    double                   x0_m, y0_m, cell_m;
    int                      nx, ny;
    size_t                  *first; /* [nx ny + 1] */
    int32_t                 *item;  /* fix n, or line ~n */
};

enum { most_side = 2048 };
static const double least_cell_m = 32, beside_m = 12; /* of a line; no thing is wider */
static const double line_gap_m = 1;                   /* between a clear line and what stands below or beside it */
static const double steepest = 0.36;                  /* rise of the ground below a thing: 20 degrees */

static int along(double m, double from_m, double cell_m, int count)
{
    return (int)clamp(floor((m - from_m) / cell_m), 0, count - 1);
}

static void put_box(ClutterSpots *s, size_t *at, const double low[2], const double high[2], int32_t item)
{
    const double end_x = s->x0_m + s->nx * s->cell_m, end_y = s->y0_m + s->ny * s->cell_m;
    if (!(high[0] >= s->x0_m && high[1] >= s->y0_m && low[0] <= end_x && low[1] <= end_y)) return;
    const int i1 = along(high[0], s->x0_m, s->cell_m, s->nx), j1 = along(high[1], s->y0_m, s->cell_m, s->ny);
    for (int j = along(low[1], s->y0_m, s->cell_m, s->ny); j <= j1; j++)
        for (int i = along(low[0], s->x0_m, s->cell_m, s->nx); i <= i1; i++) {
            const size_t cell = (size_t)j * (size_t)s->nx + (size_t)i;
            if (s->item) s->item[at[cell]] = item;
            at[cell]++;
        }
}

/* The part of a line over the square, in pieces no longer than a cell. A cell may list it twice. */
static void put_line(ClutterSpots *s, size_t *at, const ClearLine *line, int32_t item)
{
    double       from = 0, to = 1;
    const double low[2] = {s->x0_m, s->y0_m}, high[2] = {s->x0_m + s->nx * s->cell_m, s->y0_m + s->ny * s->cell_m};
    for (int c = 0; c < 2; c++) {
        const double a = line->a_enu[c], d = line->b_enu[c] - a;
        const double t0 = (low[c] - beside_m - a) / d, t1 = (high[c] + beside_m - a) / d;
        if (d != 0) from = fmax(from, fmin(t0, t1)), to = fmin(to, fmax(t0, t1));
        else if (!(a >= low[c] - beside_m && a <= high[c] + beside_m)) return;
    }
    if (!(from <= to)) return;
    const double length_m = (to - from) * hypot(line->b_enu[0] - line->a_enu[0], line->b_enu[1] - line->a_enu[1]);
    const int    parts = (int)clamp(ceil(length_m / s->cell_m), 1, 4 * most_side);
    for (int k = 0; k < parts; k++) {
        double box[2][2];
        for (int c = 0; c < 2; c++) {
            const double d = line->b_enu[c] - line->a_enu[c];
            const double p = line->a_enu[c] + d * (from + (to - from) * k / parts);
            const double q = line->a_enu[c] + d * (from + (to - from) * (k + 1) / parts);
            box[0][c] = fmin(p, q) - beside_m, box[1][c] = fmax(p, q) + beside_m;
        }
        put_box(s, at, box[0], box[1], item);
    }
}

static void put_all(ClutterSpots *s, size_t *at)
{
    const double reach_m = clutter_clear_m + beside_m;
    for (int n = 0; n < s->evidence->fix_count; n++) {
        const double *p = s->evidence->fix[n].p_enu;
        if (!v3_is_finite(p)) continue;
        put_box(s, at, (const double[2]){p[0] - reach_m, p[1] - reach_m},
                (const double[2]){p[0] + reach_m, p[1] + reach_m}, n);
    }
    for (int n = 0; n < s->evidence->line_count; n++) {
        const ClearLine *line = &s->evidence->line[n];
        if (v3_is_finite(line->a_enu) && v3_is_finite(line->b_enu)) put_line(s, at, line, ~n);
    }
}

Status clutter_spots_create(ClutterSpots **out, const ClutterConfig *config)
{
    static const double margin_m = 256; /* groups and conflicts look beyond the square */
    ClutterSpots       *s = calloc(1, sizeof *s);
    if (!s) return STATUS_NO_MEMORY;
    s->config = config;
    s->evidence = config->evidence ? config->evidence : &config->landscape->fitted_to;
    s->x0_m = config->south_west_m[0] - margin_m, s->y0_m = config->south_west_m[1] - margin_m;
    const double wide_m = config->north_east_m[0] + margin_m - s->x0_m;
    const double high_m = config->north_east_m[1] + margin_m - s->y0_m;
    s->cell_m = fmax(least_cell_m, fmax(wide_m, high_m) / (most_side - 1));
    s->nx = (int)(wide_m / s->cell_m) + 1, s->ny = (int)(high_m / s->cell_m) + 1;
    const size_t cells = (size_t)s->nx * (size_t)s->ny;
    size_t      *at = calloc(cells + 1, sizeof *at);
    s->first = calloc(cells + 1, sizeof *s->first);
    if (at && s->first) {
        put_all(s, at); /* counts */
        for (size_t k = 0; k < cells; k++) s->first[k + 1] = s->first[k] + at[k];
        memcpy(at, s->first, cells * sizeof *at);
        s->item = malloc((s->first[cells] + 1) * sizeof *s->item);
        if (s->item) put_all(s, at);
    }
    free(at);
    if (!s->item) {
        clutter_spots_destroy(s);
        return STATUS_NO_MEMORY;
    }
    *out = s;
    return STATUS_OK;
}

void clutter_spots_destroy(ClutterSpots *s)
{
    if (!s) return;
    free(s->first), free(s->item), free(s);
}

/* Whether a line passes a disc about a place, in plan, below this height. */
static bool line_passes(const ClearLine *line, const double p[2], double radius_m, double top_m)
{
    const double *a = line->a_enu, *b = line->b_enu;
    const double  d[2] = {b[0] - a[0], b[1] - a[1]}, square = d[0] * d[0] + d[1] * d[1];
    const double  t = square > 0 ? clamp(((p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1]) / square, 0, 1) : 0;
    const double  off[2] = {a[0] + t * d[0] - p[0], a[1] + t * d[1] - p[1]}, off2 = off[0] * off[0] + off[1] * off[1];
    if (!(off2 < radius_m * radius_m)) return false;
    /* lowest over the disc: half a chord to either side */
    const double more = square > 0 ? sqrt((radius_m * radius_m - off2) / square) : 1;
    const double low = clamp(t + (b[2] < a[2] ? more : -more), 0, 1);
    return a[2] + low * (b[2] - a[2]) < top_m;
}

bool clutter_keeps_clear(const ClutterSpots *s, double x_m, double y_m, double radius_m, double height_m)
{
    const double p[2] = {x_m, y_m};
    if (!(x_m >= s->x0_m && y_m >= s->y0_m && x_m <= s->x0_m + s->nx * s->cell_m && y_m <= s->y0_m + s->ny * s->cell_m))
        return true;
    const size_t cell =
        (size_t)along(y_m, s->y0_m, s->cell_m, s->ny) * (size_t)s->nx + (size_t)along(x_m, s->x0_m, s->cell_m, s->nx);
    const double most_m = fmin(radius_m, beside_m - line_gap_m);
    double       ground_m = NAN;
    for (size_t k = s->first[cell]; k < s->first[cell + 1]; k++) {
        const int32_t n = s->item[k];
        if (n >= 0) {
            const double *f = s->evidence->fix[n].p_enu, reach_m = clutter_clear_m + fmin(radius_m, beside_m);
            if ((f[0] - x_m) * (f[0] - x_m) + (f[1] - y_m) * (f[1] - y_m) < reach_m * reach_m) return false;
            continue;
        }
        if (!isfinite(ground_m)) ground_m = elevation_height(&s->config->landscape->elevation, x_m, y_m, NULL);
        if (line_passes(&s->evidence->line[~n], p, most_m + line_gap_m, ground_m + height_m + line_gap_m)) return false;
    }
    return true;
}

/* ---- classes of ground -------------------------------------------------------------------------- */

static ClutterWhere area_of(SurfaceClass surface)
{
    switch (surface) {
    case SURFACE_CROP:
    case SURFACE_PLOUGHED:
    case SURFACE_BARE_SOIL:
        return CLUTTER_IN_FIELD;
    case SURFACE_GRASS:
    case SURFACE_DRY_GRASS:
        return CLUTTER_IN_PASTURE;
    case SURFACE_SCRUB:
        return CLUTTER_IN_SCRUB;
    case SURFACE_FOREST_BROADLEAF:
    case SURFACE_FOREST_CONIFER:
        return CLUTTER_IN_FOREST;
    case SURFACE_ROCK:
        return CLUTTER_ON_ROCK;
    case SURFACE_SAND:
        return CLUTTER_ON_SAND;
    case SURFACE_BUILT:
        return CLUTTER_IN_BUILT;
    default:
        return CLUTTER_PLACES;
    }
}

/* Whether others of the areas begin within clutter_edge_m of a place of an area. */
static bool is_edge(const Landscape *landscape, ClutterWhere area, double x_m, double y_m)
{
    const double x[4] = {x_m - clutter_edge_m, x_m + clutter_edge_m, x_m, x_m};
    const double y[4] = {y_m, y_m, y_m - clutter_edge_m, y_m + clutter_edge_m};
    uint8_t      surface[4];
    landscape_surfaces(surface, landscape, 4, x, y);
    for (int k = 0; k < 4; k++) {
        const ClutterWhere other = area_of((SurfaceClass)surface[k]);
        if (other != area && other != CLUTTER_PLACES) return true;
    }
    return false;
}

bool clutter_is_area(const Landscape *landscape, ClutterWhere where, double x_m, double y_m)
{
    const ClutterWhere area = area_of(landscape_surface(landscape, x_m, y_m));
    const bool         farmed = area == CLUTTER_IN_FIELD || area == CLUTTER_IN_PASTURE;
    if (where == CLUTTER_AT_EDGE) return farmed && is_edge(landscape, area, x_m, y_m);
    return area == where && !(farmed && is_edge(landscape, area, x_m, y_m));
}

/* ---- standing ----------------------------------------------------------------------------------- */

bool clutter_can_stand(const ClutterSpots *s, double x_m, double y_m, double heading_rad, const float size_m[3])
{
    const Landscape *land = s->config->landscape;
    const Culture   *culture = s->config->culture;
    const double     half_m[2] = {0.5 * (double)size_m[0], 0.5 * (double)size_m[1]};
    const double     forward[2] = {sin(heading_rad), cos(heading_rad)};
    const double     radius_m = hypot(half_m[0], half_m[1]), gap_m = 0.3;
    double           normal[3] = {0, 0, 1};
    const double     ground_m = elevation_height(&land->elevation, x_m, y_m, normal);
    if (!isfinite(ground_m) || hypot(normal[0], normal[1]) > steepest * normal[2]) return false;
    if (!clutter_keeps_clear(s, x_m, y_m, radius_m, (double)size_m[2])) return false;
    /* discs along its length, each as wide as it is */
    const double step_m = half_m[0] - half_m[1];
    const int    most = step_m > 0 ? (int)clamp(ceil(step_m / fmax(half_m[1], 0.5)), 1, 8) : 0;
    for (int k = -most; k <= most; k++) {
        const double off_m = most ? step_m * k / most : 0, x = x_m + off_m * forward[0], y = y_m + off_m * forward[1];
        WayPlace     way;
        if (landscape_surface(land, x, y) == SURFACE_WATER) return false;
        if (culture && culture_is_in_way(culture, x, y, half_m[1] + gap_m)) return false;
        if (landscape_way(&way, land, x, y) && fabs(way.across_m) < way.half_m + half_m[1] + 0.1) return false;
    }
    /* its corners, which those discs leave out */
    for (int k = 0; k < 4 && culture; k++) {
        const double a = (k & 1 ? 1 : -1) * half_m[0], b = (k & 2 ? 1 : -1) * half_m[1];
        if (culture_is_in_way(culture, x_m + a * forward[0] + b * forward[1], y_m + a * forward[1] - b * forward[0],
                              0.5 * gap_m))
            return false;
    }
    return true;
}

bool clutter_pose(double p_enu[3], double r[9], const Landscape *landscape, double x_m, double y_m, double heading_rad,
                  const float size_m[3], bool upright)
{
    const Elevation *e = &landscape->elevation;
    const double     flat[2] = {sin(heading_rad), cos(heading_rad)}; /* of its heading, and to its right */
    const double     reach_m[2] = {fmax(0.35 * (double)size_m[0], 0.05), fmax(0.35 * (double)size_m[1], 0.05)};
    double           h[2][2], forward[3], right[3], down[3];
    for (int axis = 0; axis < 2; axis++)
        for (int side = 0; side < 2; side++) {
            const double d_m = side ? reach_m[axis] : -reach_m[axis];
            const double x = x_m + d_m * (axis ? flat[1] : flat[0]), y = y_m + d_m * (axis ? -flat[0] : flat[1]);
            h[axis][side] = elevation_height(e, x, y, NULL);
            if (!isfinite(h[axis][side])) return false;
        }
    p_enu[0] = x_m, p_enu[1] = y_m;
    p_enu[2] = 0.25 * (h[0][0] + h[0][1] + h[1][0] + h[1][1]);
    const double along_rise = upright ? 0 : (h[0][1] - h[0][0]) / (2 * reach_m[0]);
    const double right_rise = upright ? 0 : (h[1][1] - h[1][0]) / (2 * reach_m[1]);
    v3_normalize(forward, (const double[3]){flat[0], flat[1], along_rise});
    /* the plane's normal, then what is square to both */
    const double up[3] = {-along_rise * flat[0] - right_rise * flat[1], -along_rise * flat[1] + right_rise * flat[0],
                          1};
    v3_normalize(down, (const double[3]){-up[0], -up[1], -up[2]});
    v3_cross(right, down, forward);
    for (int c = 0; c < 3; c++) r[3 * c] = forward[c], r[3 * c + 1] = right[c], r[3 * c + 2] = down[c];
    return true;
}
