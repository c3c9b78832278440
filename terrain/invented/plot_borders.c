/* terrain/invented/plot_borders.c: eight places among the fields: their field, the border that they are near, and the
 * class that a track or a hedge along it gives them. */
#include "terrain/invented/invented.h"
#include "terrain/invented/invented_eight.h"

static const double track_half_m = 2, hedge_half_m = 1.5, hedge_beyond_m = 3.6, border_wander_m = 0.6;
static const double verge_m = 0.7; /* of grass beside a track */

/* ---- which sites ------------------------------------------------------------------------------ */

/* Sites of a cell that matter to places in one of its parts. A place at d from its own site is within reach of the
 * border to a site at e only if e - d < 2 reach, as sites are no farther apart than d + e. */
static uint16_t find_sites(const PlotCell *cell, int part)
{
    static const double rounding_m = 0.1, reach_m = 2 * (hedge_beyond_m + border_wander_m) * 1.01;
    const double        side_m = plot_m / plot_parts, half_m = 0.5 * side_m;
    const double        x = (part % plot_parts + 0.5) * side_m, y = (part / plot_parts + 0.5) * side_m;
    double              nearest_m[plot_sites], least_m = INFINITY;
    unsigned            sites = 0;
    for (int n = 0; n < plot_sites; n++) {
        const double dx = fabs(x - (double)cell->x_m[n]), dy = fabs(y - (double)cell->y_m[n]);
        least_m = fmin(least_m, hypot(dx + half_m, dy + half_m));
        nearest_m[n] = hypot(fmax(dx - half_m, 0), fmax(dy - half_m, 0));
    }
    for (int n = 0; n < plot_sites; n++)
        if (nearest_m[n] < least_m + reach_m + rounding_m) sites |= 1u << n;
    return (uint16_t)sites;
}

static unsigned sites_of_part(PlotCell *cell, int part)
{
    uint16_t *sites = &cell->sites_about[part];
    if (!*sites) *sites = find_sites(cell, part);
    return *sites;
}

/* Of the parts that the places of these lanes are in; at least one lane. */
static unsigned sites_about(PlotCell *cell, F32x8 x, F32x8 y, unsigned lanes)
{
    const I32x8 none = i32x8_set(0), last = i32x8_set(plot_parts - 1);
    const F32x8 per_m = f32x8_set(plot_parts / plot_m);
    const I32x8 column = _mm256_min_epi32(_mm256_max_epi32(i32x8_truncate(x * per_m), none), last);
    const I32x8 row = _mm256_min_epi32(_mm256_max_epi32(i32x8_truncate(y * per_m), none), last);
    int32_t     part[8];
    i32x8_store(part, i32x8_add(i32x8_mul(row, i32x8_set(plot_parts)), column));
    unsigned sites = 0;
    for (int before = -1; lanes; lanes &= lanes - 1) {
        const int here = part[__builtin_ctz(lanes)];
        if (here != before) sites |= sites_of_part(cell, here);
        before = here;
    }
    return sites;
}

/* ---- the nearest border ----------------------------------------------------------------------- */

/* As plot_nearest, of some of the sites; square: of the distance of each of these. */
static F32x8 nearest_of(I32x8 *site, F32x8 square[plot_sites], const PlotCell *cell, unsigned sites, F32x8 x, F32x8 y)
{
    F32x8 least = f32x8_set(INFINITY);
    I32x8 best = i32x8_set(0);
    for (; sites; sites &= sites - 1) {
        const int   n = __builtin_ctz(sites);
        const F32x8 dx = x - _mm256_set1_ps(cell->x_m[n]), dy = y - _mm256_set1_ps(cell->y_m[n]);
        square[n] = f32x8_fma(dx, dx, dy * dy);
        const F32x8 nearer = f32x8_less(square[n], least);
        least = f32x8_select(nearer, square[n], least);
        best = i32x8_select(nearer, i32x8_set(n), best);
    }
    *site = best;
    return least;
}

/* Lanes within reach of a border between their field and another. other: site beyond the nearest border. Distances to
 * perpendicular bisectors are compared by their squares, without divisions. */
static unsigned near_border(I32x8 *other, const PlotCell *cell, unsigned sites, const F32x8 square[plot_sites],
                            I32x8 site, F32x8 least)
{
    const F32x8  own_x = f32x8_gather(cell->x_m, site), own_y = f32x8_gather(cell->y_m, site);
    const I32x8  own = plot_look(cell->field, site);
    const double reach_m = 2 * (hedge_beyond_m + border_wander_m);
    F32x8 best = f32x8_set(reach_m * reach_m * 1.01), best_apart = f32x8_set(1); /* 1.01: a margin for rounding */
    F32x8 near = f32x8_set(0);
    I32x8 found = i32x8_set(0);
    for (; sites; sites &= sites - 1) {
        const int   n = __builtin_ctz(sites);
        const F32x8 ax = _mm256_set1_ps(cell->x_m[n]) - own_x, ay = _mm256_set1_ps(cell->y_m[n]) - own_y;
        const F32x8 more = square[n] - least, apart = f32x8_fma(ax, ax, ay * ay);
        const F32x8 off = more * more, same = i32x8_equal(own, i32x8_set(cell->field[n]));
        const F32x8 nearer = f32x8_and_not(f32x8_less(off * best_apart, best * apart), same);
        best = f32x8_select(nearer, off, best);
        best_apart = f32x8_select(nearer, apart, best_apart);
        found = i32x8_select(nearer, i32x8_set(n), found);
        near = f32x8_or(near, nearer);
    }
    *other = found;
    return f32x8_bits(near);
}

/* Distances from a border, as plot_border has them. */
static void borders_away(double away_m[8], const PlotCell *cell, int site, int other, double apart_m, F32x8 x, F32x8 y)
{
    const F32x8 own_x = x - _mm256_set1_ps(cell->x_m[site]), own_y = y - _mm256_set1_ps(cell->y_m[site]);
    const F32x8 off_x = x - _mm256_set1_ps(cell->x_m[other]), off_y = y - _mm256_set1_ps(cell->y_m[other]);
    for (int half = 0; half < 2; half++) {
        const F64x4 ox = f64x4_half(own_x, half), oy = f64x4_half(own_y, half);
        const F64x4 fx = f64x4_half(off_x, half), fy = f64x4_half(off_y, half);
        const F64x4 more = fx * fx + fy * fy - (ox * ox + oy * oy);
        f64x4_storeu(away_m + 4 * half, f64x4_set(0.5) * more / f64x4_set(apart_m));
    }
}

/* By how much a border and its edges wander, together, and a margin. */
static const double wander_most_m = 1.5 * border_wander_m + 1e-3;

/* How far from the border it changes classes, before it wanders. */
static double reach_of(const PlotEdge *edge)
{
    return edge->track ? (edge->hedge ? hedge_beyond_m : track_half_m + verge_m) : edge->hedge ? hedge_half_m : 0;
}

/* Adds what places know of the border between two sites: all of these lanes are near it. */
static void note_border(PlotPlaces *out, const double away_m[8], const PlotCell *cell, const PlotEdge *edge, int other,
                        unsigned lanes)
{
    const double reach_m = reach_of(edge) + wander_most_m;
    out->first |= edge->first ? lanes : 0;
    out->track |= edge->track ? lanes : 0;
    out->hedge |= edge->hedge ? lanes : 0;
    out->beyond = i32x8_select(f32x8_mask(lanes), i32x8_set(cell->crop[other]), out->beyond);
    for (unsigned left = lanes; left; left &= left - 1) {
        const int    k = __builtin_ctz(left);
        const double m = out->away_m[k] = away_m[k];
        if (m > reach_m || (edge->track && m >= 0 && m < track_half_m - wander_most_m)) out->sure |= 1u << k;
    }
}

void plots_find(PlotPlaces *out, uint64_t seed, const double bent_x[8], const double bent_y[8], unsigned lanes)
{
    double i[8], j[8];
    F32x8  x, y;
    *out = (PlotPlaces){.crop = i32x8_set(SURFACE_NONE), .beyond = i32x8_set(SURFACE_NONE)};
    plot_cells_of(i, j, &x, &y, bent_x, bent_y);
    for (unsigned left = lanes, same; left; left &= ~same) {
        same = plot_cell_lanes(i, j, left);
        const int      lane = __builtin_ctz(left);
        PlotCell      *cell = plot_cell_at(seed, (int64_t)i[lane], (int64_t)j[lane]);
        const unsigned sites = sites_about(cell, x, y, same);
        F32x8          square[plot_sites];
        I32x8          site, other;
        const F32x8    least = nearest_of(&site, square, cell, sites, x, y);
        out->crop = i32x8_select(f32x8_mask(same), plot_look(cell->crop, site), out->crop);
        if (!(sites & (sites - 1))) continue;
        const unsigned near = near_border(&other, cell, sites, square, site, least) & same;
        if (!near) continue;
        int32_t site_of[8], other_of[8];
        i32x8_store(site_of, site), i32x8_store(other_of, other);
        out->near |= near;
        for (unsigned rest = near, pair; rest; rest &= ~pair) { /* mostly all are near one border */
            const int of = __builtin_ctz(rest);
            double    away_m[8];
            pair = rest & f32x8_bits(f32x8_and(i32x8_equal(site, i32x8_set(site_of[of])),
                                               i32x8_equal(other, i32x8_set(other_of[of]))));
            const PlotEdge *edge = plot_edge(cell, seed, site_of[of], other_of[of]);
            borders_away(away_m, cell, site_of[of], other_of[of], edge->apart_m, x, y);
            note_border(out, away_m, cell, edge, other_of[of], pair);
        }
    }
}

/* ---- classes on it ---------------------------------------------------------------------------- */

I32x8 plots_on_borders(PlotPlaces *places, F32x8 wander, unsigned lanes)
{
    const F64x4 none = f64x4_set(0);
    unsigned    over = 0, on_track = 0, beyond_track = 0, before_field = 0, in_hedge = 0, on_verge = 0;
    for (int half = 0; half < 2; half++) {
        const F64x4 off_m = f64x4_set(border_wander_m) * f64x4_half(wander, half);
        const F64x4 by_m = f64x4_select(f64x4_mask(places->first >> 4 * half), off_m, -off_m);
        const F64x4 signed_m = f64x4_loadu(places->away_m + 4 * half) + by_m;
        const F64x4 here_m = f64x4_select(f64x4_less(signed_m, none), -signed_m, signed_m);
        /* edges of tracks and hedges wander less than borders */
        const F64x4 edge_m = here_m + f64x4_set(0.5) * off_m;
        const int   shift = 4 * half;
        over |= f64x4_bits(f64x4_less(signed_m, none)) << shift;
        on_track |= f64x4_bits(f64x4_less(edge_m, f64x4_set(track_half_m))) << shift;
        beyond_track |= f64x4_bits(f64x4_less(f64x4_set(track_half_m), here_m)) << shift;
        before_field |= f64x4_bits(f64x4_less(edge_m, f64x4_set(hedge_beyond_m))) << shift;
        in_hedge |= f64x4_bits(f64x4_less(edge_m, f64x4_set(hedge_half_m))) << shift;
        on_verge |= f64x4_bits(f64x4_less(edge_m, f64x4_set(track_half_m + verge_m))) << shift;
    }
    const unsigned track = places->track & lanes, hedge = places->hedge & lanes;
    const unsigned scrub = (hedge & track & beyond_track & before_field) | (hedge & ~track & in_hedge);
    places->crop = i32x8_select(f32x8_mask(over & lanes), places->beyond, places->crop);
    I32x8 class = i32x8_select(f32x8_mask(track & on_verge), i32x8_set(SURFACE_GRASS), i32x8_set(SURFACE_NONE));
    class = i32x8_select(f32x8_mask(scrub), i32x8_set(SURFACE_SCRUB), class);
    return i32x8_select(f32x8_mask(track & on_track), i32x8_set(SURFACE_TRACK), class);
}

/* ---- areas ------------------------------------------------------------------------------------ */

bool plots_alike(uint64_t seed, const double bent_m[2], double radius_m)
{
    const double rounding_m = 0.1, i = floor(bent_m[0] / plot_m), j = floor(bent_m[1] / plot_m);
    PlotCell    *cell = plot_cell_at(seed, (int64_t)i, (int64_t)j);
    double       square[plot_sites], nearest_m = INFINITY;
    const double at_m[2] = {bent_m[0] - i * plot_m, bent_m[1] - j * plot_m};
    for (int n = 0; n < plot_sites; n++) {
        const double dx = at_m[0] - (double)cell->x_m[n], dy = at_m[1] - (double)cell->y_m[n];
        square[n] = dx * dx + dy * dy;
        nearest_m = fmin(nearest_m, sqrt(square[n]));
    }
    for (int own = 0, field = -1; own < plot_sites; own++) {
        if (sqrt(square[own]) > nearest_m + 2 * radius_m + rounding_m) continue; /* nearest to no place there */
        if (field >= 0 && cell->field[own] != field) return false;
        field = cell->field[own];
        for (int n = 0; n < plot_sites; n++) {
            if (cell->field[n] == field) continue;
            const double apart_m =
                hypot((double)cell->x_m[n] - (double)cell->x_m[own], (double)cell->y_m[n] - (double)cell->y_m[own]);
            const double away_m = 0.5 * (square[n] - square[own]) / apart_m - radius_m - rounding_m;
            if (away_m > hedge_beyond_m + wander_most_m) continue;
            if (!(away_m > reach_of(plot_edge(cell, seed, own, n)) + wander_most_m)) return false;
        }
    }
    return true;
}
