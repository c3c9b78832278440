/* terrain/import/terrain_cover.c: what covers the ground of a terrain store: classes, photograph, canopy, beside rows
 * of its level 0. */
#include "terrain/import/terrain_import_private.h"

#include <stdlib.h>

/* ---- what covers the ground ------------------------------------------------------------------ */

static double ground_z(void *user, double x_m, double y_m) { return elevation_stream_around(user, x_m, y_m); }

static GroundView view_of(const StoreImport *m, const char *key)
{
    return (GroundView){&m->frame, ground_z, m->first, m->pool, key};
}

double import_finest_m(const RasterSet *set)
{
    return set->count ? fmin(set->raster[0].posting_m[0], set->raster[0].posting_m[1]) : 0;
}

/* The rows of a grid that lie beside rows row0 .. row0 + rows - 1 of level 0; each row comes up once. */
static bool rows_of(CellRows *out, int *first, const StoreGrid *g, const StoreImport *m, int row0, int rows)
{
    if (g->nx == 0) return false;
    const double y_m = (m->level.j0 - 0.5) * m->level.spacing_m, s = m->level.spacing_m;
    const bool   last = row0 + rows == m->level.ny;
    const double from = ceil((y_m + row0 * s - g->y0_m) / g->cell_m - 1e-6);
    const double to = last ? g->ny : ceil((y_m + (row0 + rows) * s - g->y0_m) / g->cell_m - 1e-6);
    const int    a = (int)clamp(from, 0, g->ny), b = (int)clamp(to, 0, g->ny);
    if (b <= a) return false;
    *out = (CellRows){g->nx, b - a, g->x0_m, g->y0_m + a * g->cell_m, g->cell_m};
    *first = a;
    return true;
}

/* Reads the wide window of classes, which comes first, since its codes choose the table. */
Status import_cover_wide(StoreImport *m)
{
    const StoreGrid *g = &m->plan.surface[1];
    if (g->nx == 0 && m->cover.count) {
        log_error("terrain import: --cover: %s does not reach the terrain; leave it out, or name one of the place",
                  m->cover.raster[0].sheet[0].path);
        return STATUS_BAD_VALUE;
    }
    if (g->nx == 0) return STATUS_OK;
    const Raster    *raster = &m->cover.raster[0];
    const CellRows   cells = {g->nx, g->ny, g->x0_m, g->y0_m, g->cell_m};
    const GroundView view = view_of(m, "terrain import: --cover");
    const size_t     count = (size_t)g->nx * (size_t)g->ny;
    uint16_t        *code = calloc(count, sizeof *code);
    uint8_t         *surface = malloc(count);
    long             histogram[surface_codes_most] = {0};
    m->cover_band = raster->sheet[0].band ? 0 : raster->bands >= 8 ? 4 : 1;
    Status status =
        code && surface ? ground_rows_codes(code, &m->cover, m->cover_band, &cells, &view) : STATUS_NO_MEMORY;
    for (size_t n = 0; status == STATUS_OK && n < count; n++)
        if (code[n]) histogram[code[n] - 1]++;
    if (status == STATUS_OK) status = surface_table_choose(&m->table, &m->r.cover.table, m->o->cover_table, histogram);
    long known = 0;
    for (size_t n = 0; status == STATUS_OK && n < count; n++) {
        surface[n] = code[n] ? m->table.surface[code[n] - 1] : SURFACE_NONE;
        known += surface[n] != SURFACE_NONE;
    }
    if (status == STATUS_OK && known == 0) {
        log_error("terrain import: --cover: none of the codes of %s is in the table %s; give --cover-table",
                  raster->sheet[0].path, m->r.cover.table);
        status = STATUS_BAD_VALUE;
    }
    if (status == STATUS_OK) status = store_write_surface(m->writer, 1, g->ny, surface);
    m->r.cover.posting_m = import_finest_m(&m->cover);
    m->r.cover.band = raster->sheet[0].band ? raster->sheet[0].band : m->cover_band;
    free(code);
    free(surface);
    return status;
}

/* Classes of a strip: that of the file; built-up where a building stands; grass under crowns where the file has none.
 * */
Status import_cover(StoreImport *m, int row0, int rows, const SurfaceStrip *strip)
{
    CellRows cells;
    int      first;
    if (!rows_of(&cells, &first, &m->plan.surface[0], m, row0, rows)) return STATUS_OK;
    const size_t count = (size_t)cells.nx * (size_t)cells.rows;
    uint16_t    *of_file = m->cover.count ? calloc(count, sizeof *of_file) : NULL;
    uint8_t     *code = calloc(count, 1);
    Status       status = code && (of_file || !m->cover.count) ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK && of_file) {
        const GroundView view = view_of(m, "terrain import: --cover");
        status = ground_rows_codes(of_file, &m->cover, m->cover_band, &cells, &view);
        for (size_t n = 0; n < count; n++) {
            m->r.cover.unknown += of_file[n] > 1 && !m->table.known[of_file[n] - 1];
            code[n] = of_file[n] ? m->table.surface[of_file[n] - 1] : SURFACE_NONE;
        }
    }
    free(of_file);
    for (size_t n = 0; strip && status == STATUS_OK && n < count; n++) { /* cells and posts are one to one */
        if (strip->kind[n] == CELL_BUILDING) code[n] = SURFACE_BUILT;
        else if (strip->kind[n] == CELL_TREE && code[n] == SURFACE_NONE) code[n] = SURFACE_GRASS;
    }
    long of_class[256] = {0};
    for (size_t n = 0; status == STATUS_OK && n < count; n++) of_class[code[n]]++;
    for (int s = 1; s < SURFACE_COUNT; s++)
        m->r.cover.share[s] += (double)of_class[s]; /* counts, which are turned into shares at the end */
    if (status == STATUS_OK) status = store_write_surface(m->writer, 0, cells.rows, code);
    free(code);
    return status;
}

Status import_albedo(StoreImport *m, int row0, int rows)
{
    enum { some_rows = 512 }; /* rows at a time, where pixels are finer than posts */
    CellRows all;
    int      first;
    if (!rows_of(&all, &first, &m->plan.albedo, m, row0, rows)) return STATUS_OK;
    const GroundView view = view_of(m, "terrain import: --photo");
    Status           status = STATUS_OK;
    for (int j = 0; j < all.rows && status == STATUS_OK; j += some_rows) {
        CellRows cells = all;
        cells.rows = all.rows - j < some_rows ? all.rows - j : some_rows;
        cells.y0_m = all.y0_m + j * all.cell_m;
        uint8_t *rgba = calloc((size_t)cells.nx * (size_t)cells.rows, 4);
        status = rgba ? ground_rows_colours(rgba, &m->photo, &cells, &view) : STATUS_NO_MEMORY;
        if (status == STATUS_OK) status = store_write_albedo(m->writer, cells.rows, rgba);
        free(rgba);
    }
    return status;
}

/* ---- canopy ---------------------------------------------------------------------------------- */

/* Finds the unit of the canopy's heights: that which the file states. Without one, whole numbers above 80 cannot be
 * metres: LANDFIRE's are tenths of them. */
Status import_canopy_look(StoreImport *m)
{
    const RasterSet *set = &m->canopy_height;
    enum { rows = 64 };
    if (set->count == 0) return STATUS_OK;
    const Raster *raster = &set->raster[0];
    const int     band = raster->sheet[0].band ? raster->sheet[0].band : 1;
    const char   *unit = *raster->choice.unit ? raster->choice.unit : raster->stated.unit;
    if (*unit) {
        m->r.canopy_scale_m = raster_unit_m(unit);
        if (m->r.canopy_scale_m > 0) return STATUS_OK;
        log_error(
            "terrain import: --canopy-height: %s: its unit is '%s', which is no length that is known here; say it: "
            "%s@m, or %s@dm",
            raster->sheet[0].path, unit, raster->sheet[0].path, raster->sheet[0].path);
        return STATUS_BAD_VALUE;
    }
    float *some = malloc((size_t)raster->width * sizeof *some), most = 0;
    Status status = some ? STATUS_OK : STATUS_NO_MEMORY;
    for (int r = 0; r < rows && status == STATUS_OK; r++) {
        status = raster_read(some, raster, band,
                             (RasterWindow){0, (int)((int64_t)r * raster->height / rows), raster->width, 1},
                             "terrain import: --canopy-height");
        for (int i = 0; i < raster->width && status == STATUS_OK; i++) most = some[i] > most ? some[i] : most;
    }
    free(some);
    m->r.canopy_scale_m = raster->whole && most > 80 ? 0.1 : 1;
    return status;
}

static Status canopy_of_file(StoreImport *m, bool height, int row0, int rows)
{
    const RasterSet *set = height ? &m->canopy_height : &m->canopy_cover;
    CellRows         cells;
    int              first;
    const StoreGrid *g = height ? &m->plan.canopy_height : &m->plan.canopy_cover;
    if (!rows_of(&cells, &first, g, m, row0, rows)) return STATUS_OK;
    const GroundView view = view_of(m, height ? "terrain import: --canopy-height" : "terrain import: --canopy-cover");
    const size_t     count = (size_t)cells.nx * (size_t)cells.rows;
    const double     scale = height ? m->r.canopy_scale_m / store_canopy_height_m : 0.01 / store_canopy_cover;
    float           *value = malloc(count * sizeof *value);
    uint8_t         *octet = malloc(count);
    Status           status = value && octet ? STATUS_OK : STATUS_NO_MEMORY;
    for (size_t n = 0; status == STATUS_OK && n < count; n++) value[n] = NAN;
    if (status == STATUS_OK) status = ground_rows_numbers(value, set, 0, &cells, &view);
    for (size_t n = 0; status == STATUS_OK && n < count; n++)
        octet[n] = (uint8_t)(value[n] > 0 ? fmin(rint((double)value[n] * scale), height ? 255 : 100) : 0);
    if (status == STATUS_OK)
        status = (height ? store_write_canopy_height : store_write_canopy_cover)(m->writer, cells.rows, octet);
    free(value);
    free(octet);
    return status;
}

/* Canopy from the crowns that were found: in each cell the greatest height, or the share of its posts. */
static Status canopy_of_strip(StoreImport *m, bool height, int row0, int rows, const SurfaceStrip *strip)
{
    CellRows         cells;
    int              first;
    const StoreGrid *g = height ? &m->plan.canopy_height : &m->plan.canopy_cover;
    if (!rows_of(&cells, &first, g, m, row0, rows)) return STATUS_OK;
    const int nx = m->level.nx, side = (int)lrint(g->cell_m / m->level.spacing_m);
    uint8_t  *octet = calloc((size_t)cells.nx * (size_t)cells.rows, 1);
    if (!octet) return STATUS_NO_MEMORY;
    for (int j = 0; j < cells.rows; j++)
        for (int i = 0; i < cells.nx; i++) {
            double most_m = 0;
            int    trees = 0, posts = 0;
            for (int b = j * side; b < (j + 1) * side && b < rows; b++)
                for (int a = i * side; a < (i + 1) * side && a < nx; a++) {
                    const size_t at = (size_t)b * (size_t)nx + (size_t)a;
                    posts++;
                    trees += strip->kind[at] == CELL_TREE;
                    most_m = fmax(most_m, (double)strip->canopy_m[at]);
                }
            octet[(size_t)j * (size_t)cells.nx + (size_t)i] =
                (uint8_t)(height ? fmin(rint(most_m / store_canopy_height_m), 255)
                                 : rint(100.0 * trees / (posts + !posts)));
        }
    const Status status = (height ? store_write_canopy_height : store_write_canopy_cover)(m->writer, cells.rows, octet);
    free(octet);
    return status;
}

Status import_canopy(StoreImport *m, int row0, int rows, const SurfaceStrip *strip)
{
    Status status = STATUS_OK;
    for (int height = 0; height < 2 && status == STATUS_OK; height++) {
        if ((height ? &m->canopy_height : &m->canopy_cover)->count) status = canopy_of_file(m, height, row0, rows);
        else if (strip) status = canopy_of_strip(m, height, row0, rows, strip);
    }
    return status;
}
