/* terrain/landscape/elevation_error.c: the error of imported elevation against its files. */
#include "terrain/landscape/elevation_import_private.h"

#include <stdlib.h>

static int by_value(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return x < y ? -1 : x > y;
}

static bool reserve(Samples *s, int more)
{
    if (s->count + more <= s->capacity) return true;
    const int capacity = 2 * s->capacity > s->count + more ? 2 * s->capacity : s->count + more;
    bool     *at_post = realloc(s->at_post, (size_t)capacity * sizeof *at_post);
    if (at_post) s->at_post = at_post;
    double (*p_enu)[3] = at_post ? realloc(s->p_enu, (size_t)capacity * sizeof *p_enu) : NULL;
    if (!p_enu) return false;
    s->p_enu    = p_enu;
    s->capacity = capacity;
    return true;
}

void samples_free(Samples *samples)
{
    free(samples->at_post);
    free(samples->p_enu);
    *samples = (Samples){0};
}

/* Places of the grid, each converted exactly to ENU; and posts of it, where peaks between the stored posts are lost
 * most. */
Status samples_draw(Samples *samples, const Import *m, const Patch *patch, int first, int end, int at_posts)
{
    enum { block = 1000 };
    const Grid *g = &m->grid[m->main];
    double      x[block], y[block], h[block];
    bool        at_post[block];
    const double w = patch->nx[0] - 1, d = patch->ny[0] - 1;
    for (; first < end; first += block) {
        int drawn = 0;
        for (int n = first; n < first + block && n < end; n++) {
            double u = w * random_uniform(20, 1, 0, (uint64_t)n), v = d * random_uniform(20, 2, 0, (uint64_t)n);
            if (n >= at_posts) u = floor(u), v = floor(v);
            const uint8_t *hole = patch->hole + (size_t)v * (size_t)patch->nx[0] + (size_t)u;
            if (hole[0] || hole[1] || hole[patch->nx[0]] || hole[patch->nx[0] + 1]) continue;
            x[drawn]       = patch->x0 + u + 0.5;
            y[drawn]       = patch->y0 + v + 0.5;
            h[drawn]       = patch_at(patch, x[drawn], y[drawn], 0) * g->raster->metres_per_unit;
            at_post[drawn] = n >= at_posts;
            drawn++;
        }
        raster_earth_from_px(g->raster, drawn, x, y);
        if (!reserve(samples, drawn)) return STATUS_NO_MEMORY;
        for (int n = 0; n < drawn; n++) {
            Geodetic place = {.lat_rad = y[n], .lon_rad = x[n], .h_m = h[n]};
            double   p_ecef[3];
            if (!g->ellipsoidal) place.h_m += geoid_height_m(&m->geoid, place.lat_rad, place.lon_rad);
            if (ecef_from_geodetic(p_ecef, NULL, &place) != STATUS_OK) continue;
            samples->at_post[samples->count] = at_post[n];
            enu_from_ecef(samples->p_enu[samples->count++], m->frame, p_ecef);
        }
    }
    return STATUS_OK;
}

/* Signed distance of the surface below or above one place; NaN off level 0 or where it is joined. */
static double off_m(const Elevation *elevation, const double p_enu[3])
{
    const ElevationLevel *level = &elevation->level[0];
    const double fx = (p_enu[0] - level->x0_m) / level->spacing_m, fy = (p_enu[1] - level->y0_m) / level->spacing_m;
    if (!(fx >= import_join_band && fy >= import_join_band && fx <= level->nx - 1 - import_join_band &&
          fy <= level->ny - 1 - import_join_band))
        return NAN;
    return elevation_height(elevation, p_enu[0], p_enu[1], NULL) - p_enu[2];
}

Status samples_measure(ElevationReport *report, const Samples *samples, const Elevation *elevation)
{
    float *error = malloc(((size_t)samples->count + 1) * sizeof *error);
    double sum = 0, worst_m = 0;
    int    count = 0;
    if (!error) return STATUS_NO_MEMORY;
    for (int n = 0; n < samples->count; n++) {
        const double off = fabs(off_m(elevation, samples->p_enu[n]));
        if (!isfinite(off)) continue;
        worst_m = fmax(worst_m, off);
        if (samples->at_post[n]) continue;
        error[count++] = (float)off;
        sum += off * off;
    }
    report->places = count;
    if (count > 0) {
        qsort(error, (size_t)count, sizeof *error, by_value);
        report->error_rms_m = sqrt(sum / count);
        report->error_p99_m = (double)error[(int)(0.99 * (count - 1))];
        report->error_max_m = worst_m;
    }
    free(error);
    return STATUS_OK;
}
