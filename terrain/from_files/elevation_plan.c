/* terrain/from_files/elevation_plan.c: which files there are, and the levels that show them. */

#include "terrain/from_files/elevation_import_private.h"

static const char key[] = "terrain.elevation";
enum { outer_half_posts = 1024, last_half_posts = 2048 };

Status elevation_import_open(Import *m)
{
    RasterSet *opened = m->files->opened;
    if (opened && opened->count) {
        m->set = *opened;
        *opened = (RasterSet){0};
    } else {
        const Status status = raster_set_open(&m->set, m->files->paths, key);
        if (status != STATUS_OK) return status;
    }
    if (m->set.count > import_most_grids) {
        log_error("%s: the files lie on %d different grids, more than %d; gdalbuildvrt joins them", key, m->set.count,
                  (int)import_most_grids);
        return STATUS_BAD_VALUE;
    }
    bool wants_geoid = false;
    m->grids = m->set.count;
    for (int k = 0; k < m->grids; k++) {
        Raster         *raster = &m->set.raster[k];
        Grid           *g = &m->grid[k];
        ElevationSurvey survey;
        const Status    status = elevation_survey(&survey, raster, key, m->pool);
        if (status != STATUS_OK) return status;
        g->raster = raster;
        g->units[0] = raster->posting_m[0];
        g->units[1] = raster->posting_m[1];
        g->ellipsoidal = raster->choice.vertical != RASTER_VERTICAL_BY_CRS
                             ? raster->choice.vertical == RASTER_VERTICAL_ELLIPSOID
                         : m->files->vertical == ELEVATION_BY_FILE ? raster->ellipsoidal
                                                                   : m->files->vertical == ELEVATION_ELLIPSOID;
        wants_geoid |= !g->ellipsoidal;
        survey.ellipsoidal = g->ellipsoidal;
        if (m->files->heard) m->files->heard(m->files->heard_user, &survey);
        /* width over which it fades into the coarser grid around, in posts of that */
        g->short_m =
            k + 1 < m->grids ? 8 * fmax(m->set.raster[k + 1].posting_m[0], m->set.raster[k + 1].posting_m[1]) : 0;
        g->long_m = 30000; /* preliminary, until its edge has been measured */
    }
    return wants_geoid ? geoid_open(&m->geoid, m->files->geoid_path) : STATUS_OK;
}

double elevation_import_reads_px(const Import *m, int grid)
{
    const Raster *raster = &m->set.raster[grid];
    double        px = raster->data_share;
    for (int c = 0; c < 2; c++) {
        const double size = c ? raster->height : raster->width;
        px *= fmin(size, 2 * m->files->horizon_m / raster->posting_m[c] + 2);
    }
    return px;
}

static int round_out(double posts)
{
    return (int)(posts < 0 ? floor(posts / level_ratio) : ceil(posts / level_ratio)) * level_ratio;
}

/* Signed distance of a grid's nearest edge from the origin, positive inside the grid; and the distance of its farthest
 * edge. */
static void grid_reach(double reach_m[2], const Raster *raster, const LocalFrame *frame)
{
    double x = frame->origin.lon_rad, y = frame->origin.lat_rad;
    raster_px_from_earth(raster, 1, &x, &y);
    const double west = (x - 0.5) * raster->posting_m[0], east = (raster->width - 0.5 - x) * raster->posting_m[0];
    const double north = (y - 0.5) * raster->posting_m[1], south = (raster->height - 0.5 - y) * raster->posting_m[1];
    const double nearest = fmin(fmin(west, east), fmin(north, south));
    const double out_x = fmax(fmax(-west, -east), 0), out_y = fmax(fmax(-north, -south), 0);
    reach_m[0] = out_x > 0 || out_y > 0 || !isfinite(nearest) ? -hypot(out_x, out_y) : nearest;
    reach_m[1] = fmax(fmax(west, east), fmax(north, south));
    if (!isfinite(x) || !isfinite(y)) reach_m[0] = -INFINITY;
}

Status elevation_import_choose(Import *m, ElevationReport *report)
{
    static const double nearest_m = 20000;
    double              best_m = -INFINITY;
    m->main = -1;
    report->reach_m[0] = -INFINITY;
    report->reach_m[1] = 0;
    for (int k = 0; k < m->grids; k++) {
        double reach_m[2];
        grid_reach(reach_m, m->grid[k].raster, m->frame);
        if (m->main < 0 && reach_m[0] > 0) m->main = k;
        best_m = fmax(best_m, reach_m[0]);
        report->reach_m[0] = fmax(report->reach_m[0], reach_m[0]);
        report->reach_m[1] = fmax(report->reach_m[1], reach_m[1]);
    }
    if (m->main >= 0) return STATUS_OK;
    if (!(best_m > -nearest_m)) {
        log_error("%s: the action is at %.4f, %.4f degrees, %.0f km from the nearest data; name sheets that hold it",
                  key, m->frame->origin.lat_rad / rad_per_deg, m->frame->origin.lon_rad / rad_per_deg, -best_m * 1e-3);
        return STATUS_BAD_VALUE;
    }
    for (int k = 0; k < m->grids; k++) {
        double reach_m[2];
        grid_reach(reach_m, m->grid[k].raster, m->frame);
        if (reach_m[0] == best_m) m->main = k;
    }
    return STATUS_OK;
}

static void set_window(WorkLevel *level, double spacing_m, int i0, int i1, int j0, int j1)
{
    *level = (WorkLevel){.z = {spacing_m, i0, j0, i1 - i0 + 1, j1 - j0 + 1, NULL}, .hole_i1 = -1};
}

void elevation_import_plan(Import *m, int most_side)
{
    enum { least_ring = 2 * level_ratio, margin = 32 };
    const Raster *raster = m->grid[m->main].raster;
    double        s = m->files->spacing_m > 0 ? m->files->spacing_m : fmin(raster->posting_m[0], raster->posting_m[1]);
    s = fmax(rint(s * 64) / 64,
             0x1p-4); /* dyadic, so that every post's place is exact; near a pole pixels are narrower */

    double low[2], high[2];
    int    first[2], last[2];
    raster_enu_box(low, high, raster, m->frame, 0.5);
    for (int k = 0; k < m->grids; k++) { /* grids of about the same posting belong to the main grid */
        double other_low[2], other_high[2];
        if (fmin(m->grid[k].units[0], m->grid[k].units[1]) > 2 * s || k == m->main) continue;
        raster_enu_box(other_low, other_high, m->grid[k].raster, m->frame, 0.5);
        for (int c = 0; c < 2; c++) {
            low[c] = fmin(low[c], other_low[c]);
            high[c] = fmax(high[c], other_high[c]);
        }
    }
    const int half = most_side / 2 / level_ratio * level_ratio - level_ratio;
    for (int c = 0; c < 2; c++) {
        if (m->files->size_m[c] > 0) { /* centred on the origin, whether there are data or not */
            low[c] = -0.5 * m->files->size_m[c] + margin * s;
            high[c] = 0.5 * m->files->size_m[c] - margin * s;
        }
        const double a = fmin(low[c] / s, 0) - margin, b = fmax(high[c] / s, 0) + margin;
        first[c] = round_out(fmax(a, -half));
        last[c] = round_out(fmin(b, half));
    }
    set_window(&m->level[0], s, first[0], last[0], first[1], last[1]);
    m->level_count = 1;
    while (m->level_count < elevation_max_levels) {
        const WorkLevel *in = &m->level[m->level_count - 1];
        const int        i1 = in->z.i0 + in->z.nx - 1, j1 = in->z.j0 + in->z.ny - 1;
        const double     narrowest = fmin(fmin(-in->z.i0, i1), fmin(-in->z.j0, j1)) *
                                 s; /* the least distance to an edge, as data may be one long strip */
        if (narrowest >= m->files->horizon_m && !(m->streamed && m->level_count == 1)) break;
        s *= level_ratio;
        const bool ends = m->level_count == elevation_max_levels - 1 || outer_half_posts * s >= m->files->horizon_m;
        const int  wide = round_out(fmin(ends ? last_half_posts : outer_half_posts, m->files->horizon_m / s));
        WorkLevel *level = &m->level[m->level_count++];
        int        w[4] = {-wide, wide, -wide, wide};
        const int  need[4] = {round_out(in->z.i0 / level_ratio - least_ring), round_out(i1 / level_ratio + least_ring),
                              round_out(in->z.j0 / level_ratio - least_ring), round_out(j1 / level_ratio + least_ring)};
        for (int e = 0; e < 4; e++)
            if (e & 1 ? need[e] > w[e] : need[e] < w[e]) w[e] = need[e];
        set_window(level, s, w[0], w[1], w[2], w[3]);
        level->hole_i0 = in->z.i0 / level_ratio;
        level->hole_i1 = i1 / level_ratio;
        level->hole_j0 = in->z.j0 / level_ratio;
        level->hole_j1 = j1 / level_ratio;
        if (ends) break;
    }
    m->level[m->level_count - 1].outermost = true;
    for (int k = 0; k < m->level_count; k++) m->spacing_m[k] = m->level[k].z.spacing_m;
}

/* ---- heights of whole levels: every grid is read once for all of them ------------------------------------ */

RasterPatchSource elevation_import_source(const Import *m, int grid)
{
    const Raster *raster = m->grid[grid].raster;
    const double  a = elevation_lowest_m / raster->metres_per_unit, b = elevation_highest_m / raster->metres_per_unit;
    return (RasterPatchSource){
        .raster = raster, .band = 1, .low = fmin(a, b), .high = fmax(a, b), .key = key, .pool = m->pool};
}

/* Measures mean and spread of each grid's outline, for blending beyond it and for the height beyond the coarsest. */
static bool measure_edges(Import *m, const View *view)
{
    bool any = false;
    for (int k = 0; k < m->grids; k++) {
        Grid              *g = &m->grid[k];
        const RasterPatch *p = &view->patch[k];
        const int          nx = p->nx[0], ny = p->ny[0];
        double             sum = 0, low = INFINITY, high = -INFINITY;
        long               count = 0;
        if (p->mips == 0) continue;
        for (int j = 0; j < ny; j++)
            for (int i = 0; i < nx; i++) {
                if (j > 0 && j < ny - 1 && i > 0 && i < nx - 1) i = nx - 1;
                const double h_m = (double)p->v[0][(size_t)j * (size_t)nx + (size_t)i] * g->raster->metres_per_unit;
                sum += h_m;
                low = fmin(low, h_m);
                high = fmax(high, h_m);
                count++;
            }
        m->base_h_m = sum / (double)count + (g->ellipsoidal ? 0 : m->geoid_m);
        g->long_m = clamp(15 * (high - low), 2000, 30000); /* the blending slopes by one in fifteen */
        any = true;
    }
    return any;
}

/* Reads every grid's windows in one pass over its files. */
static Status read_all(View view[elevation_max_levels], const Import *m, int first)
{
    Status status = STATUS_OK;
    for (int grid = 0; grid < m->grids && status == STATUS_OK; grid++) {
        RasterPatchWindow window[elevation_max_levels];
        RasterPatch       patch[elevation_max_levels] = {0};
        int               of[elevation_max_levels], count = 0;
        for (int k = first; k < m->level_count; k++) {
            if (!view_window(&window[count], &view[k], m, grid)) continue;
            of[count++] = k;
        }
        const RasterPatchSource source = elevation_import_source(m, grid);
        if (count > 0) status = raster_patches_read(patch, window, count, &source);
        for (int n = 0; n < count && status == STATUS_OK; n++) view[of[n]].patch[grid] = patch[n];
    }
    return status;
}

Status elevation_import_levels(Import *m, bool with_0, View *finest)
{
    View      view[elevation_max_levels] = {0};
    const int first = with_0 || m->level_count == 1 ? 0 : 1;
    Status    status = STATUS_OK;
    for (int k = first; k < m->level_count && status == STATUS_OK; k++)
        status = view_create(&view[k], m, &m->level[k].z, 0, m->level[k].z.ny);
    if (status == STATUS_OK) status = read_all(view, m, first);
    for (int k = m->level_count - 1; k >= first && status == STATUS_OK; k--) {
        WorkLevel *level = &m->level[k];
        Field     *z = &level->z;
        if (level->outermost && !measure_edges(m, &view[k])) {
            log_error("%s: no post of the named files holds a height; gdalinfo -mm says what they hold", key);
            status = STATUS_BAD_VALUE;
        }
        if (status == STATUS_OK && (k > 0 || with_0))
            status = levels_field_create(z, z->spacing_m, z->i0, z->j0, z->nx, z->ny);
        if (status == STATUS_OK && (k > 0 || with_0)) status = view_heights(z->v, &view[k], m);
    }
    if (status == STATUS_OK) {
        *finest = view[first];
        view[first] = (View){0};
    }
    for (int k = 0; k < elevation_max_levels; k++) view_free(&view[k]);
    return status;
}

void elevation_import_describe(ElevationReport *r, const Import *m)
{
    const Grid *main_grid = &m->grid[m->main];
    r->sheets = 0;
    for (int k = 0; k < m->set.count; k++) r->sheets += m->set.raster[k].sheet_count;
    r->grids = m->grids;
    r->posting_m = fmin(main_grid->units[0], main_grid->units[1]);
    r->spacing_m = m->spacing_m[0];
    r->width_m[0] = (m->level[0].z.nx - 1) * m->spacing_m[0];
    r->width_m[1] = (m->level[0].z.ny - 1) * m->spacing_m[0];
    r->blend_m = m->grid[m->grids - 1].long_m;
    r->beyond_h_m = m->base_h_m;
    r->ellipsoidal = main_grid->ellipsoidal;
    r->geoid_m = r->ellipsoidal ? 0 : m->geoid_m;
}
