/* terrain/landscape/elevation_error.c: the error of imported elevation against its files. */
#include "terrain/landscape/elevation_import_private.h"

#include <stdlib.h>

static int by_value(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return x < y ? -1 : x > y;
}

/* Signed distance of the surface below or above one place of the main grid; NaN off level 0 or where it is joined. */
static double off_m(const Import *m, const Elevation *elevation, double lon_rad, double lat_rad, double h_m)
{
    const ElevationLevel *level = &elevation->level[0];
    Geodetic place = {.lat_rad = lat_rad, .lon_rad = lon_rad, .h_m = h_m};
    double   p_ecef[3], p_enu[3];
    if (!m->grid[m->main].ellipsoidal) place.h_m += geoid_height_m(&m->geoid, lat_rad, lon_rad);
    if (ecef_from_geodetic(p_ecef, NULL, &place) != STATUS_OK) return NAN;
    enu_from_ecef(p_enu, m->frame, p_ecef);
    const double fx = (p_enu[0] - level->x0_m) / level->spacing_m, fy = (p_enu[1] - level->y0_m) / level->spacing_m;
    if (!(fx >= import_join_band && fy >= import_join_band && fx <= level->nx - 1 - import_join_band &&
          fy <= level->ny - 1 - import_join_band))
        return NAN;
    return elevation_height(elevation, p_enu[0], p_enu[1], NULL) - p_enu[2];
}

/* Places of the grid drawn at random, each converted exactly to ENU and compared with the stored surface; and as many
 * posts of it, where peaks between the stored posts are lost most. */
Status elevation_import_measure(ElevationReport *report, const Import *m, const Elevation *elevation,
                                const Patch *patch)
{
    enum { places = 100000, block = 1000 };
    const Grid *g = &m->grid[m->main];
    float      *error = malloc(places * sizeof *error);
    double      sum = 0, worst_m = 0, x[block], y[block], h[block];
    int         count = 0;
    if (!error) return STATUS_NO_MEMORY;
    const double w = patch->nx[0] - 1, d = patch->ny[0] - 1;
    for (int first = 0; first < 2 * places; first += block) {
        const bool at_posts = first >= places;
        int        drawn = 0;
        for (int n = 0; n < block; n++) {
            double u = w * random_uniform(20, 1, 0, (uint64_t)(first + n)),
                   v = d * random_uniform(20, 2, 0, (uint64_t)(first + n));
            if (at_posts) u = floor(u), v = floor(v);
            const uint8_t *hole = patch->hole + (size_t)v * (size_t)patch->nx[0] + (size_t)u;
            if (hole[0] || hole[1] || hole[patch->nx[0]] || hole[patch->nx[0] + 1]) continue;
            x[drawn] = patch->x0 + u + 0.5;
            y[drawn] = patch->y0 + v + 0.5;
            h[drawn] = patch_at(patch, x[drawn], y[drawn], 0) * g->raster->metres_per_unit;
            drawn++;
        }
        raster_earth_from_px(g->raster, drawn, x, y);
        for (int n = 0; n < drawn; n++) {
            const double off = fabs(off_m(m, elevation, x[n], y[n], h[n]));
            if (!isfinite(off)) continue;
            worst_m = fmax(worst_m, off);
            if (at_posts) continue;
            error[count++] = (float)off;
            sum += off * off;
        }
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
