/* terrain/landscape/elevation_import.c: terrain from files in memory: all levels at once, corrected by fixes. */
#include "terrain/landscape/elevation_import_private.h"

enum { most_side_0 = 6 << 10 }; /* 36 M posts */
static const double most_read_gb = 1024; /* decoded: an hour; a file of 300 octets may ask for a million times as much */

static Status refuse_vast(const Import *m)
{
    double px = 0;
    for (int k = 0; k < m->set.count; k++) px += elevation_import_reads_px(m, k);
    if (1e-9 * sizeof(float) * px <= most_read_gb) return STATUS_OK;
    log_error("terrain.elevation: %s and what else is named: %.0f GB to decode, more than %.0f; gdal_translate -srcwin cuts out what is "
              "needed, -tr makes its pixels larger", m->set.raster[0].sheet[0].path, 1e-9 * sizeof(float) * px, most_read_gb);
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
    curve_of_frame(&m.curve, frame);
    Status status = elevation_import_open(&m);
    if (status == STATUS_OK) status = elevation_import_choose(&m, &r);
    if (status == STATUS_OK) status = refuse_vast(&m);
    if (status != STATUS_OK) goto done;
    elevation_import_plan(&m, most_side_0);
    m.geoid_m = m.geoid.n_m ? geoid_height_m(&m.geoid, frame->origin.lat_rad, frame->origin.lon_rad) : 0;
    status    = elevation_import_levels(&m, true, &view);
    if (status == STATUS_OK && fix_count > 0) status = elevation_import_correct(&m, fix, fix_count, &r.correction_m);
    for (int k = m.level_count - 1; status == STATUS_OK && k >= 0; k--) {
        Field *z = &m.level[k].z;
        status   = view_bend(z->v, &m, z, 0, z->ny);
        if (status == STATUS_OK && !m.level[k].outermost) view_join(z->v, z, 0, z->ny, &m.level[k + 1].z);
    }
    if (status == STATUS_OK) status = levels_store_fine(&elevation, m.level, m.level_count);
    const Patch *patch = &view.patch[m.main];
    if (status == STATUS_OK && patch->mips > 0 && r.correction_m == 0 && patch->factor == 1 && patch->nx[0] > 1 &&
        patch->ny[0] > 1) {
        status = samples_draw(&samples, &m, patch, 0, 2 * samples_places, samples_places);
        if (status == STATUS_OK) status = samples_measure(&r, &samples, &elevation);
    }
    if (status != STATUS_OK) goto done;

    r.voids = patch->voids;
    elevation_import_describe(&r, &m);
    *report   = r;
    *out      = elevation;
    elevation = (Elevation){0};

done:
    elevation_destroy(&elevation);
    samples_free(&samples);
    view_free(&view);
    for (int k = 0; k < elevation_max_levels; k++) field_destroy(&m.level[k].z);
    geoid_close(&m.geoid);
    raster_set_close(&m.set);
    return status;
}
