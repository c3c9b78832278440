/* terrain/landscape/landscape_import.c: elevation, land cover and photograph files -> one landscape. */
#include "terrain/landscape/landscape_import.h"

#include "terrain/landscape/landscape_private.h"

#include <stdlib.h>

/* A rough guess: trees end at some 3900 m within 30 degrees of the equator, and at the sea at 70. */
double landscape_treeline_m(double lat_rad)
{
    return clamp(3900 - 97.5 * (fabs(lat_rad) / rad_per_deg - 30), 0, 3900);
}

Status landscape_import(Landscape *out, LandscapeReport *report, const LandscapeFiles *files, const LocalFrame *frame,
                        const GroundFix *fix, int fix_count)
{
    Landscape       landscape = {.frame = *frame};
    LandscapeReport r = {0};
    Cover          *cover = calloc(1, sizeof *cover);
    if (!cover) return STATUS_NO_MEMORY;
    landscape.cover = cover;
    Status status = elevation_import(&landscape.elevation, &r.elevation, &files->elevation, frame, fix, fix_count);
    if (status != STATUS_OK) goto fail;

    landscape.config = (LandscapeConfig){.seed = files->seed, .spacing_m = r.elevation.spacing_m,
                                         .half_width_m = 0.5 * fmax(r.elevation.width_m[0], r.elevation.width_m[1]),
                                         .horizon_m = files->elevation.horizon_m};
    cover->seed       = landscape_hash(files->seed, 2, 0);
    cover->real       = true;
    cover->geoid_m    = r.elevation.geoid_m;
    cover->treeline_m = landscape_treeline_m(frame->origin.lat_rad);
    curve_of_frame(&cover->curve, frame);
    if (*files->cover)
        status = cover_grid_read(cover->grid, &r.cover, files->cover, files->cover_table, files->cover_band,
                                 &landscape.elevation, frame);
    if (status == STATUS_OK && *files->photo)
        status = photo_read(&cover->photo, &r.photo_posting_m, files->photo, &landscape.elevation, frame);
    if (status != STATUS_OK) goto fail;
    cover_measure_photo(&landscape);
    *out    = landscape;
    *report = r;
    return STATUS_OK;

fail:
    landscape_destroy(&landscape);
    return status;
}
