/* terrain/from_files/elevation_import.c: terrain from files in memory: all levels at once, corrected by fixes; how far
 * it is from its files; and with land cover and a photograph one landscape. */
#include "terrain/from_files/elevation_import_private.h"
#include "terrain/from_files/elevation_import.h"
#include "terrain/ground/landscape_parts.h"

#include <stdlib.h>

/* ---- the error against the files ---------------------------------------------------------------- */

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
    double(*p_enu)[3] = at_post ? realloc(s->p_enu, (size_t)capacity * sizeof *p_enu) : NULL;
    if (!p_enu) return false;
    s->p_enu = p_enu;
    s->capacity = capacity;
    return true;
}

void samples_free(Samples *samples)
{
    free(samples->at_post);
    free(samples->p_enu);
    *samples = (Samples){0};
}

/* Draws places of the grid, each converted exactly to ENU, and posts of it, since peaks between the stored posts are
 * lost most. */
Status samples_draw(Samples *samples, const Import *m, const RasterPatch *patch, int first, int end, int at_posts)
{
    enum { block = 1000 };
    const Grid  *g = &m->grid[m->main];
    double       x[block], y[block], h[block];
    bool         at_post[block];
    const double w = patch->nx[0] - 1, d = patch->ny[0] - 1;
    for (; first < end; first += block) {
        int drawn = 0;
        for (int n = first; n < first + block && n < end; n++) {
            double u = w * random_uniform(20, 1, 0, (uint64_t)n), v = d * random_uniform(20, 2, 0, (uint64_t)n);
            if (n >= at_posts) u = floor(u), v = floor(v);
            const uint8_t *hole = patch->hole + (size_t)v * (size_t)patch->nx[0] + (size_t)u;
            if (hole[0] || hole[1] || hole[patch->nx[0]] || hole[patch->nx[0] + 1]) continue;
            x[drawn] = patch->x0 + u + 0.5;
            y[drawn] = patch->y0 + v + 0.5;
            h[drawn] = raster_patch_at(patch, x[drawn], y[drawn], 0) * g->raster->metres_per_unit;
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

/* Signed height of the surface over one place; NaN off level 0 or where it is blended with level 1. */
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

/* ---- all levels ---------------------------------------------------------------------------------- */

enum { most_side_0 = 6 << 10 }; /* 36 M posts */
static const double most_read_gb =
    1024; /* decoding that takes an hour; a file of 300 octets may ask for a million times as much */

static Status refuse_vast(const Import *m)
{
    double px = 0;
    for (int k = 0; k < m->set.count; k++) px += elevation_import_reads_px(m, k);
    if (1e-9 * sizeof(float) * px <= most_read_gb) return STATUS_OK;
    log_error(
        "terrain.elevation: %s and what else is named: %.0f GB to decode, more than %.0f; gdal_translate -srcwin cuts out what is "
        "needed, -tr makes its pixels larger",
        m->set.raster[0].sheet[0].path, 1e-9 * sizeof(float) * px, most_read_gb);
    return STATUS_BAD_VALUE;
}

Status elevation_import(Elevation *out, ElevationReport *report, const ElevationFiles *files, const LocalFrame *frame,
                        const GroundFix *fix, int fix_count)
{
    Import          m = {.files = files, .frame = frame};
    ElevationReport r = {0};
    Elevation       elevation = {0};
    View            view = {0};
    Samples         samples = {0};
    if (!(files->horizon_m > 0) || !(files->spacing_m >= 0)) return STATUS_BAD_VALUE;
    levels_curve(&m.curve, frame);
    Status status = elevation_import_open(&m);
    if (status == STATUS_OK) status = elevation_import_choose(&m, &r);
    if (status == STATUS_OK) status = refuse_vast(&m);
    if (status != STATUS_OK) goto done;
    elevation_import_plan(&m, most_side_0);
    m.geoid_m = m.geoid.n_m ? geoid_height_m(&m.geoid, frame->origin.lat_rad, frame->origin.lon_rad) : 0;
    status = elevation_import_levels(&m, true, &view);
    if (status == STATUS_OK && fix_count > 0)
        status = invented_correct(m.level, m.level_count, frame, files->horizon_m, fix, fix_count, &r.correction_m);
    for (int k = m.level_count - 1; status == STATUS_OK && k >= 0; k--) {
        Field *z = &m.level[k].z;
        status = view_bend(z->v, &m, z, 0, z->ny);
        if (status == STATUS_OK && !m.level[k].outermost) view_join(z->v, z, 0, z->ny, &m.level[k + 1].z);
    }
    if (status == STATUS_OK) status = levels_store_fine(&elevation, m.level, m.level_count);
    const RasterPatch *patch = &view.patch[m.main];
    if (status == STATUS_OK && patch->mips > 0 && r.correction_m == 0 && patch->factor == 1 && patch->nx[0] > 1 &&
        patch->ny[0] > 1) {
        status = samples_draw(&samples, &m, patch, 0, 2 * samples_places, samples_places);
        if (status == STATUS_OK) status = samples_measure(&r, &samples, &elevation);
    }
    if (status != STATUS_OK) goto done;

    r.voids = patch->voids;
    elevation_import_describe(&r, &m);
    *report = r;
    *out = elevation;
    elevation = (Elevation){0};

done:
    elevation_destroy(&elevation);
    samples_free(&samples);
    view_free(&view);
    for (int k = 0; k < elevation_max_levels; k++) levels_field_destroy(&m.level[k].z);
    geoid_close(&m.geoid);
    raster_set_close(&m.set);
    return status;
}

/* ---- a landscape --------------------------------------------------------------------------------- */

Status landscape_import(Landscape *out, LandscapeReport *report, const LandscapeFiles *files, const LocalFrame *frame,
                        const GroundFix *fix, int fix_count)
{
    LandscapeParts  parts = {.frame = *frame, .cover_seed = landscape_cover_seed(files->seed)};
    LandscapeReport r = {0};
    float           mean[SURFACE_COUNT][photo_channels];
    Status          status = elevation_import(&parts.elevation, &r.elevation, &files->elevation, frame, fix, fix_count);
    if (status != STATUS_OK) return status;

    parts.config = (LandscapeConfig){.seed = files->seed,
                                     .spacing_m = r.elevation.spacing_m,
                                     .half_width_m = 0.5 * fmax(r.elevation.width_m[0], r.elevation.width_m[1]),
                                     .horizon_m = files->elevation.horizon_m};
    parts.geoid_m = r.elevation.geoid_m;
    if (*files->cover)
        status = cover_grid_read(parts.cover, &r.cover, files->cover, files->cover_table, files->cover_band,
                                 &parts.elevation, frame);
    if (status == STATUS_OK && *files->photo)
        status = photo_read(&parts.photo, &r.photo_posting_m, files->photo, &parts.elevation, frame);
    if (status == STATUS_OK) status = landscape_borrow(out, &parts, NULL);
    if (status != STATUS_OK) {
        elevation_destroy(&parts.elevation);
        cover_grid_free(parts.cover);
        photo_free(&parts.photo);
        return status;
    }
    landscape_photo_means(mean, out);
    *report = r;
    return STATUS_OK;
}
