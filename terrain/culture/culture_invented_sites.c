/* terrain/culture/culture_invented_sites.c: places beside ways, for farms and works: those of the fields' tracks and of
 * the landscape's ways, a cell of a fixed grid at a time. */
#include "terrain/culture/culture_invented_private.h"

#include "terrain/invented/invented_eight.h"

#include <stdlib.h>

/* ---- the grid ---------------------------------------------------------------------------------------- */

Status invent_sites_open(Inventor *v)
{
    WayCells *w = &v->way_cells;
    w->nx = (int)ceil(v->side_m[0] / invent_site_cell_m), w->ny = (int)ceil(v->side_m[1] / invent_site_cell_m);
    const size_t cells = (size_t)w->nx * (size_t)w->ny;
    w->first = calloc(cells + 2, sizeof *w->first);
    w->vertex = calloc((size_t)v->vertices + 1, sizeof *w->vertex);
    if (!w->first || !w->vertex) return STATUS_NO_MEMORY;
    for (int pass = 0; pass < 2; pass++) {
        for (int way = 0; way < v->way_count; way++)
            for (int n = v->way_first[way]; n + 1 < v->way_first[way + 1] && v->way_kind[way] <= WAY_TRACK; n++) {
                const double i = floor((v->vertex[n][0] - v->x0_m) / invent_site_cell_m);
                const double j = floor((v->vertex[n][1] - v->y0_m) / invent_site_cell_m);
                if (!(i >= 0 && j >= 0 && i < w->nx && j < w->ny)) continue;
                const size_t cell = (size_t)j * (size_t)w->nx + (size_t)i;
                if (pass) w->vertex[w->first[cell + 1]++] = n;
                else w->first[cell + 2]++;
            }
        for (size_t c = 1; c <= cells && !pass; c++) w->first[c + 1] += w->first[c];
    }
    return STATUS_OK;
}

void invent_sites_close(Inventor *v) { free(v->way_cells.first), free(v->way_cells.vertex); }

/* ---- places beside ways -------------------------------------------------------------------------------- */

/* Moves a place to the middle of the track between two fields nearest to it. False: there is none near. */
static bool to_track(Rectangle *out, const Inventor *v, double x_m, double y_m)
{
    static const double near_m = 0.5;
    uint64_t            seed, fields;
    if (!landscape_seed(&seed, v->landscape)) return false;
    for (int step = 0; step < 6; step++) { /* the plane is bent, so the step is repeated */
        PlotBorder border;
        double     away[2];
        if (!plot_border_about(&border, away, &fields, seed, x_m, y_m) || !border.track) return false;
        if (fabs(border.away_m) < near_m) {
            *out = (Rectangle){x_m, y_m, {-away[1], away[0]}, {0, 0}};
            return landscape_surface(v->landscape, x_m, y_m) == SURFACE_TRACK;
        }
        x_m -= border.away_m * away[0], y_m -= border.away_m * away[1];
    }
    return false;
}

bool invent_beside_way(Rectangle *out, const Inventor *v, int cell, uint64_t hash, bool on_roads)
{
    static const double margin = 0.2; /* of a cell, so that sites of neighbours are apart */
    const WayCells     *w = &v->way_cells;
    double              p[2];
    for (int k = 0; k < 2; k++) p[k] = margin + (1 - 2 * margin) * invent_unit(hash, k);
    const double corner_m[2] = {v->x0_m + cell % w->nx * invent_site_cell_m,
                                v->y0_m + cell / w->nx * invent_site_cell_m};
    if (!on_roads)
        return to_track(out, v, corner_m[0] + p[0] * invent_site_cell_m, corner_m[1] + p[1] * invent_site_cell_m);
    const int first = w->first[cell], count = w->first[cell + 1] - first;
    if (count == 0) return false;
    const int     n = w->vertex[first + (int)(p[0] * count) % count];
    const double *a = v->vertex[n], *b = v->vertex[n + 1], length_m = hypot(b[0] - a[0], b[1] - a[1]);
    for (int k = 0; k < 2; k++) {
        const double at = (a[k] - corner_m[k]) / invent_site_cell_m;
        if (!(at >= margin && at <= 1 - margin)) return false;
    }
    if (!(length_m > 0)) return false;
    *out = (Rectangle){a[0], a[1], {(b[0] - a[0]) / length_m, (b[1] - a[1]) / length_m}, {0, 0}};
    return true;
}

Rectangle invent_site_beside(const Rectangle *way, bool left, double front_m, const double half_m[2])
{
    Rectangle r = *way;
    if (!left) r.along[0] = -r.along[0], r.along[1] = -r.along[1];
    return rectangle_within(&r, 0, front_m + half_m[1], half_m[0], half_m[1]);
}

Rectangle invent_site_and_front(const Rectangle *site, double front_m)
{
    return rectangle_within(site, 0, -0.5 * front_m, site->half_m[0], site->half_m[1] + 0.5 * front_m);
}

int invent_ways_about(const Inventor *v, double x_m, double y_m, double radius_m)
{
    enum { looks = 64 };
    double  x[looks], y[looks];
    uint8_t surface[looks];
    int     ways = 0;
    bool    on[looks];
    for (int k = 0; k < looks; k++)
        x[k] = x_m + radius_m * cos(2 * pi_rad * k / looks), y[k] = y_m + radius_m * sin(2 * pi_rad * k / looks);
    landscape_surfaces(surface, v->landscape, looks, x, y);
    for (int k = 0; k < looks; k++) on[k] = surface[k] == SURFACE_ROAD || surface[k] == SURFACE_TRACK;
    for (int k = 0; k < looks; k++) ways += on[k] && !on[(k + looks - 1) % looks];
    return ways;
}

double invent_wild_share(const Inventor *v, const Rectangle *r)
{
    enum { side = 8 };
    double  x[side * side], y[side * side];
    uint8_t surface[side * side];
    int     wild = 0;
    for (int k = 0; k < side * side; k++) {
        double p[2];
        rectangle_at(p, r, r->half_m[0] * ((k % side + 0.5) / side * 2 - 1),
                     r->half_m[1] * ((k / side + 0.5) / side * 2 - 1));
        x[k] = p[0], y[k] = p[1];
    }
    landscape_surfaces(surface, v->landscape, side * side, x, y);
    for (int k = 0; k < side * side; k++)
        wild += surface[k] == SURFACE_SCRUB || surface[k] == SURFACE_ROCK || surface[k] == SURFACE_TRACK;
    return (double)wild / (side * side);
}

/* ---- what stands on a site ------------------------------------------------------------------------------ */

bool invent_site_building(Inventor *v, const Rectangle *site, const double at_m[2], const double half_m[2],
                          const Building *building, int owner)
{
    const Rectangle r = rectangle_within(site, at_m[0], at_m[1], half_m[0], half_m[1]);
    if (!invent_fits(v, &r, 1, (double)building->ridge_m + culture_above_ridge_m, owner)) return false;
    invent_building(v, &r, building, owner);
    return true;
}

bool invent_site_point(Inventor *v, const Rectangle *site, CulturePointKind kind, const double at_m[2],
                       const double size_m[3], int owner)
{
    const Rectangle r = rectangle_within(site, at_m[0], at_m[1], 0.5 * size_m[0], 0.5 * size_m[1]);
    if (!invent_fits(v, &r, 0.3, size_m[2], owner)) return false;
    invent_point(v, kind, &r, size_m[2], owner);
    return true;
}

void invent_ground_strip(Inventor *v, const Rectangle *site, CultureLineKind kind, SurfaceClass surface,
                         const double from_m[2], const double to_m[2], double width_m)
{
    const CultureLine strip = {.kind = (uint8_t)kind, .width_m = (float)width_m, .surface = (uint8_t)surface};
    double            corner[2][2];
    rectangle_at(corner[0], site, from_m[0], from_m[1]), rectangle_at(corner[1], site, to_m[0], to_m[1]);
    invent_line(v, &strip, (const double(*)[2])corner, 2);
}
