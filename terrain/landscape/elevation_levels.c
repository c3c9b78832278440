/* terrain/landscape/elevation_levels.c: heights of whole levels of posts from files: every grid is read once for all of
 * them. */
#include "terrain/landscape/elevation_import_private.h"

static const char key[] = "terrain.elevation";

PatchSource elevation_import_source(const Import *m, int grid)
{
    const Raster *raster = m->grid[grid].raster;
    const double  a = elevation_lowest_m / raster->metres_per_unit, b = elevation_highest_m / raster->metres_per_unit;
    return (PatchSource){.raster = raster, .band = 1, .low = fmin(a, b), .high = fmax(a, b), .key = key, .pool = m->pool};
}

/* Mean and spread of each grid's outline: for the blending from it, and the height beyond the coarsest. */
static bool measure_edges(Import *m, const View *view)
{
    bool any = false;
    for (int k = 0; k < m->grids; k++) {
        Grid        *g = &m->grid[k];
        const Patch *p = &view->patch[k];
        const int    nx = p->nx[0], ny = p->ny[0];
        double       sum = 0, low = INFINITY, high = -INFINITY;
        long         count = 0;
        if (p->mips == 0) continue;
        for (int j = 0; j < ny; j++)
            for (int i = 0; i < nx; i++) {
                if (j > 0 && j < ny - 1 && i > 0 && i < nx - 1) i = nx - 1;
                const double h_m = (double)p->v[0][(size_t)j * (size_t)nx + (size_t)i] * g->raster->metres_per_unit;
                sum += h_m;
                low  = fmin(low, h_m);
                high = fmax(high, h_m);
                count++;
            }
        m->base_h_m = sum / (double)count + (g->ellipsoidal ? 0 : m->geoid_m);
        g->long_m   = clamp(15 * (high - low), 2000, 30000); /* a slope of one in fifteen */
        any         = true;
    }
    return any;
}

/* Every grid's windows in one pass over its files. */
static Status read_all(View view[elevation_max_levels], const Import *m, int first)
{
    Status status = STATUS_OK;
    for (int grid = 0; grid < m->grids && status == STATUS_OK; grid++) {
        PatchWindow window[elevation_max_levels];
        Patch       patch[elevation_max_levels] = {0};
        int         of[elevation_max_levels], count = 0;
        for (int k = first; k < m->level_count; k++) {
            if (!view_window(&window[count], &view[k], m, grid)) continue;
            of[count++] = k;
        }
        const PatchSource source = elevation_import_source(m, grid);
        if (count > 0) status = patches_read(patch, window, count, &source);
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
            status = field_create(z, z->spacing_m, z->i0, z->j0, z->nx, z->ny);
        if (status == STATUS_OK && (k > 0 || with_0)) status = view_heights(z->v, &view[k], m);
    }
    if (status == STATUS_OK) {
        *finest     = view[first];
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
    r->grids       = m->grids;
    r->posting_m   = fmin(main_grid->units[0], main_grid->units[1]);
    r->spacing_m   = m->spacing_m[0];
    r->width_m[0]  = (m->level[0].z.nx - 1) * m->spacing_m[0];
    r->width_m[1]  = (m->level[0].z.ny - 1) * m->spacing_m[0];
    r->blend_m     = m->grid[m->grids - 1].long_m;
    r->beyond_h_m  = m->base_h_m;
    r->ellipsoidal = main_grid->ellipsoidal;
    r->geoid_m     = r->ellipsoidal ? 0 : m->geoid_m;
}
