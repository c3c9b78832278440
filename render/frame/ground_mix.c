/* render/frame/ground_mix.c: pixels that cover several ground classes.
 *
 * Grass beside asphalt is 10 K colder at noon: the error of one sample on their border is all of that, of four
 * samples 0.6 K (rms), and as the eye moves the border flickers. The existing hit gives the plane of the ground, so
 * no further ray is needed: points over the sample's square are projected on the plane of its hit, their surface
 * classes are looked up, and the hit is split into one for each class, at the mean of its points, weighted by their
 * number. */
#include "render/frame/frame_private.h"

#include <assert.h>

/* Range at which the ray d meets the plane through a hit at range_m along d_hit. At grazing view the plane runs away
 * from the ground: then the hit's own range. */
static double plane_through(const double n[3], const double d_hit[3], double range_m, const double d[3])
{
    const double at_m = range_m * v3_dot(n, d_hit) / v3_dot(n, d);
    return at_m < 2 * range_m && at_m > 0.5 * range_m ? at_m : range_m;
}

/* ---- which pixels ---------------------------------------------------------------------------- */

enum { corners_together = 128 };

/* Where corners are on the ground; NaN: no ground there. corner: [count], columns and rows of the picture. */
static void place_corners(double *x_m, double *y_m, const Job *job, const uint16_t (*corner)[2], int count)
{
    enum { most = corners_together };
    const View    *view = &job->request->view;
    const Picture *p = job->picture;
    double         column_px[2][most], row_px[2][most], hit[3][most], way[3][most], n[3][most], hit_m[most];
    bool           ground[most];
    for (int k = 0; k < count; k++) {
        /* the pixel below and to the right of the corner gives the plane of the ground; at the picture's end the last
         */
        const int    x = corner[k][0], px = x < view->width ? x : view->width - 1;
        const int    y = corner[k][1], py = y < view->height ? y : view->height - 1;
        const size_t at = pixel_index(job, px, py);
        column_px[0][k] = px + 0.5, row_px[0][k] = py + 0.5;
        column_px[1][k] = x, row_px[1][k] = y;
        for (int c = 0; c < 3; c++) n[c][k] = (double)p->normal[c][at];
        hit_m[k] = (double)p->range_m[at];
        ground[k] = p->cover[at] != SURFACE_NONE;
    }
    view_rays((double *const[3]){hit[0], hit[1], hit[2]}, view, count, column_px[0], row_px[0]);
    view_rays((double *const[3]){way[0], way[1], way[2]}, view, count, column_px[1], row_px[1]);
    for (int k = 0; k < count; k++) { /* plane_through */
        const double above = n[0][k] * hit[0][k] + n[1][k] * hit[1][k] + n[2][k] * hit[2][k];
        const double along = n[0][k] * way[0][k] + n[1][k] * way[1][k] + n[2][k] * way[2][k];
        const double at_m = hit_m[k] * above / along,
                     range_m = at_m < 2 * hit_m[k] && at_m > 0.5 * hit_m[k] ? at_m : hit_m[k];
        x_m[k] = ground[k] ? view->p_enu[0] + range_m * way[0][k] : NAN;
        y_m[k] = ground[k] ? view->p_enu[1] + range_m * way[1][k] : NAN;
    }
}

void corner_materials(uint16_t out[corner_capacity], const Job *job, const Tile *tile,
                      const bool wanted[corner_capacity])
{
    const Materials *materials = &job->scene.world->materials;
    const int        columns = tile->x1 - tile->x0 + 1, corners = columns * (tile->y1 - tile->y0 + 1);
    double           x_m[corners_together], y_m[corners_together];
    uint8_t          surface[corners_together];
    uint16_t         corner[corners_together], place[corners_together][2];
    int              x = tile->x0, y = tile->y0;
    for (int at = 0; at < corners;) {
        int count = 0;
        for (; at < corners && count < corners_together; at++) {
            corner[count] = (uint16_t)at, place[count][0] = (uint16_t)x, place[count][1] = (uint16_t)y;
            count += wanted[at];
            if (++x > tile->x1) x = tile->x0, y++;
        }
        place_corners(x_m, y_m, job, place, count);
        surface_cells_at(surface, job->scene.world->cells, job->scene.world->landscape, count, x_m, y_m);
        for (int k = 0; k < count; k++)
            out[corner[k]] = surface[k] == SURFACE_NONE ? material_unknown : (uint16_t)materials->surface[surface[k]];
    }
}

bool corners_differ(const uint16_t *corner, int columns, uint32_t material)
{
    const uint16_t of[4] = {corner[0], corner[1], corner[columns], corner[columns + 1]};
    for (int k = 0; k < 4; k++)
        if (of[k] != material_unknown && of[k] != material) return true;
    return false;
}

/* ---- splitting -------------------------------------------------------------------------------- */

/* A class within a sample's square. */
typedef struct GroundPatch {
    uint8_t surface;
    int     count;
    double  place[2]; /* sum of its places, px */
} GroundPatch;

/* The square that a sample stands for, on the plane of its hit: places a side x side apart, row by row. */
typedef struct SquarePlaces {
    double at_px[2][ground_mix_places]; /* on the picture */
    double x_m[ground_mix_places], y_m[ground_mix_places];
} SquarePlaces;

/* Finds the picture positions of the points, relative to the sample's, for a square of 1 / n px. */
static void places_about(SquarePlaces *out, double offset_px[2][ground_mix_places], const double centre_px[2],
                         int places)
{
    for (int c = 0; c < 2; c++)
        for (int k = 0; k < places; k++) out->at_px[c][k] = centre_px[c] + offset_px[c][k];
}

/* Does what plane_through does for many directions: without a lens they are linear in the place on the picture. */
static void places_on_plane(SquarePlaces *out, const View *view, const double n[3], const double d_hit[3],
                            double range_m, const double centre_px[2], int places)
{
    const double *r = view->r_enu_from_cam, per_px = 1 / view->focal_px;
    double        d_centre[3], axis_x[3], axis_y[3];
    for (int k = 0; k < 3; k++) {
        axis_x[k] = r[3 * k] * per_px, axis_y[k] = r[3 * k + 1] * per_px;
        d_centre[k] = r[3 * k + 2] + axis_x[k] * (centre_px[0] - 0.5 * view->width) +
                      axis_y[k] * (centre_px[1] - 0.5 * view->height);
    }
    const double length = v3_length(d_centre), on_plane = range_m * v3_dot(n, d_hit), flat = range_m / length;
    const double n_centre = v3_dot(n, d_centre), n_x = v3_dot(n, axis_x), n_y = v3_dot(n, axis_y);
    for (int k = 0; k < places; k++) {
        const double dx = out->at_px[0][k] - centre_px[0], dy = out->at_px[1][k] - centre_px[1];
        const double share = on_plane / (n_centre + n_x * dx + n_y * dy); /* of the direction, whose length is not 1 */
        const double at = share < 2 * flat && share > 0.5 * flat ? share : flat;
        out->x_m[k] = view->p_enu[0] + at * (d_centre[0] + axis_x[0] * dx + axis_y[0] * dy);
        out->y_m[k] = view->p_enu[1] + at * (d_centre[1] + axis_x[1] * dx + axis_y[1] * dy);
    }
}

static void places_through_lens(SquarePlaces *out, const View *view, const double n[3], const double d_hit[3],
                                double hit_range_m, int places)
{
    for (int k = 0; k < places; k++) {
        double d[3];
        view_ray(d, view, out->at_px[0][k], out->at_px[1][k]);
        const double range_m = plane_through(n, d_hit, hit_range_m, d);
        out->x_m[k] = view->p_enu[0] + range_m * d[0];
        out->y_m[k] = view->p_enu[1] + range_m * d[1];
    }
}

/* Normal of the ground at a hit where rays are straight lines: what is seen rises with the distance from the eye. */
static void seen_normal(double n[3], const Visibility *v, const Hits *hits, int i, const double d_enu[3])
{
    const double twice = 2 * visibility_bend(v) * hits->range_m[i] * (double)hits->n_geo[2][i];
    for (int c = 0; c < 3; c++) n[c] = (double)hits->n_geo[c][i] - (c < 2 ? twice * d_enu[c] : 0);
}

/* Counts the points of each class, and sums their places. Neighbours are mostly of one class. */
static void count_places(GroundPatch found[SURFACE_COUNT], const SquarePlaces *square, const uint8_t *surface,
                         int places)
{
    for (int k = 0; k < places;) {
        const uint8_t here = surface[k];
        GroundPatch  *to = &found[here < SURFACE_COUNT ? here : SURFACE_NONE], sum = *to;
        for (; k < places && surface[k] == here; k++) {
            sum.count++;
            sum.place[0] += square->at_px[0][k], sum.place[1] += square->at_px[1][k];
        }
        *to = sum;
    }
}

static bool all_alike(const uint8_t *surface, int places)
{
    return memcmp(surface, surface + 1, (size_t)places - 1) == 0;
}

/* Classes of the points over a square of 1 / n px about a sample's position, the most frequent first; the rest is
 * counted to the first. Returns their number, 1 .. most; 0: no ground there. */
static int find_patches(GroundPatch patch[ground_mix_most], const Worker *w, const Job *job, int i,
                        const double centre_px[2], double offset_px[2][ground_mix_places], int side, int most)
{
    const View  *view = &job->request->view;
    const Hits  *hits = &w->samples.hits;
    const Rays  *rays = &w->samples.rays;
    const int    places = side * side;
    const double d_hit[3] = {rays->d_enu[0][i], rays->d_enu[1][i], rays->d_enu[2][i]};
    double       n[3];
    SquarePlaces square;
    uint8_t      surface[ground_mix_places];
    GroundPatch  found[SURFACE_COUNT] = {{0}};
    seen_normal(n, job->scene.visibility, hits, i, d_hit);
    places_about(&square, offset_px, centre_px, places);
    if (view_has_lens(view)) places_through_lens(&square, view, n, d_hit, hits->range_m[i], places);
    else places_on_plane(&square, view, n, d_hit, hits->range_m[i], centre_px, places);
    landscape_surfaces_square(surface, job->scene.world->landscape, side, square.x_m, square.y_m);
    if (all_alike(surface, places)) {
        patch[0] = (GroundPatch){.surface = surface[0], .count = places};
        return surface[0] > SURFACE_NONE && surface[0] < SURFACE_COUNT;
    }
    count_places(found, &square, surface, places);
    int count = 0, total = 0;
    for (; count < most; count++) {
        int best = 0; /* of equals the first class */
        for (int c = SURFACE_NONE + 1; c < SURFACE_COUNT; c++)
            if (found[c].count > (best ? found[best].count : 0)) best = c;
        if (!best) break;
        patch[count] = found[best];
        patch[count].surface = (uint8_t)best;
        total += found[best].count;
        found[best].count = 0;
    }
    if (count == 0) return 0;
    for (int c = 0; c < 2; c++) {
        for (int k = 0; k < count; k++) patch[k].place[c] /= patch[k].count;
    }
    patch[0].count += places - total;
    return count;
}

/* Moves a ground sample to another position of the picture on the plane of its hit. */
static void move_sample(Hits *hits, Rays *rays, int i, const Job *job, const double at_px[2])
{
    const View  *view = &job->request->view;
    const double d_hit[3] = {rays->d_enu[0][i], rays->d_enu[1][i], rays->d_enu[2][i]};
    double       d[3], n[3];
    seen_normal(n, job->scene.visibility, hits, i, d_hit);
    view_ray(d, view, at_px[0], at_px[1]);
    hits->range_m[i] = plane_through(n, d_hit, hits->range_m[i], d);
    for (int k = 0; k < 3; k++) {
        rays->d_enu[k][i] = d[k];
        hits->p_enu[k][i] = view->p_enu[k] + hits->range_m[i] * d[k];
    }
    hits->p_enu[2][i] -=
        visibility_lift_at(job->scene.visibility, (const double[3]){hits->p_enu[0][i], hits->p_enu[1][i]});
}

void split_ground(Worker *w, const Job *job, int side, int most)
{
    const PixelBlock *block = &w->block;
    Samples          *s = &w->samples;
    const int         samples = block->n * block->n, before = s->hits.count;
    Hits             *hits = &w->hits;
    Rays             *rays = &w->rays;
    float             sun[hits_capacity];
    int               count = 0;
    rays->bent = s->rays.bent;
    double offset_px[2][ground_mix_places];
    assert(before * most <= hits_capacity && most <= ground_mix_most && side * side <= ground_mix_places);
    for (int k = 0; k < side * side; k++) {
        double place[2];
        sample_place(place, side, k);
        for (int c = 0; c < 2; c++) offset_px[c][k] = (place[c] - 0.5) / block->n;
    }
    for (int i = 0; i < before; i++) {
        GroundPatch patch[ground_mix_most];
        const int   pixel = i / samples;
        const bool  ground = s->hits.surface[i] && !s->hits.entity[i] && s->hits.range_m[i] < INFINITY &&
                            !visibility_is_beyond(job->scene.visibility, s->hits.p_enu[0][i], s->hits.p_enu[1][i]);
        double centre_px[2];
        sample_place(centre_px, block->n, i % samples);
        centre_px[0] += block->x[pixel], centre_px[1] += block->y[pixel];
        const int patches = ground ? find_patches(patch, w, job, i, centre_px, offset_px, side, most) : 0;
        for (int k = 0; k < (patches > 1 ? patches : 1); k++, count++) {
            hits_copy(hits, rays, count, &s->hits, &s->rays, i);
            sun[count] = s->sun[i];
            hits->ray[count] = (uint16_t)i;
            hits->weight[count] = 1;
            if (patches == 0) continue;
            hits->weight[count] = (float)patch[k].count / (float)(side * side);
            hits->surface[count] = patch[k].surface;
            hits->material[count] = (uint16_t)job->scene.world->materials.surface[patch[k].surface];
            if (patches > 1) move_sample(hits, rays, count, job, patch[k].place);
        }
    }
    for (int i = 0; i < count; i++) s->sun[i] = sun[i];
    hits->count = rays->count = count;
    hits->columns = rays->columns = 0;
    hits->several = true;
    hits_copy_all(&s->hits, &s->rays, hits, rays);
}
