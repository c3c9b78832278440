/* terrain/ground/ground_image.c: rasters of land cover classes and of a photograph, resampled into ENU, and read at
 * points. */
#include "terrain/ground/ground_image.h"

#include "terrain/elevation/raster.h"

#include <stdlib.h>

/* ---- places of cells in a raster -------------------------------------------------------------- */

/* A window of square cells, and pixels of a raster at the corners of blocks of cells. */
typedef struct Window {
    double x0_m, y0_m, cell_m;
    int    nx, ny;
} Window;

enum { block_cells = 32 };

/* Finds the raster's pixel under each cell's centre, for a row of blocks at a time. It is exact at the corners of
 * blocks, on the ground itself, and linear between (over 32 cells of 1 m the lean of a 100 m cliff 8 km away would
 * cause an error of 0.1 m). */
typedef struct Finder {
    const Raster     *raster;
    const Elevation  *elevation;
    const LocalFrame *frame;
    Window            window;
    double           *x, *y;       /* [2][blocks + 1] */
    int               blocks, row; /* blocks in a row; number of the row that is loaded */
} Finder;

static Status finder_create(Finder *f, const Raster *raster, const Elevation *elevation, const LocalFrame *frame,
                            const Window *window)
{
    *f = (Finder){.raster = raster, .elevation = elevation, .frame = frame, .window = *window, .row = -1};
    f->blocks = (window->nx - 1) / block_cells + 1;
    f->x = malloc(4 * (size_t)(f->blocks + 1) * sizeof *f->x);
    if (!f->x) return STATUS_NO_MEMORY;
    f->y = f->x + 2 * (f->blocks + 1);
    return STATUS_OK;
}

static void finder_load(Finder *f, int row)
{
    const int corners = f->blocks + 1;
    for (int side = 0; side < 2; side++)
        for (int c = 0; c < corners; c++) {
            double p_enu[3] = {f->window.x0_m + c * block_cells * f->window.cell_m,
                               f->window.y0_m + (row + side) * block_cells * f->window.cell_m, 0},
                   p_ecef[3];
            Geodetic     place = {NAN, NAN, 0};
            const double z_m = elevation_height(f->elevation, p_enu[0], p_enu[1], NULL);
            p_enu[2] = isfinite(z_m) ? z_m : 0;
            ecef_from_enu(p_ecef, f->frame, p_enu);
            (void)geodetic_from_ecef(&place, p_ecef);
            f->x[side * corners + c] = place.lon_rad;
            f->y[side * corners + c] = place.lat_rad;
        }
    raster_px_from_earth(f->raster, 2 * corners, f->x, f->y);
    f->row = row;
}

/* The pixel under the centre of a cell. */
static void finder_at(double px[2], Finder *f, int i, int j)
{
    if (j / block_cells != f->row) finder_load(f, j / block_cells);
    const int     corners = f->blocks + 1, c = i / block_cells;
    const double  u = (i % block_cells + 0.5) / block_cells, v = (j % block_cells + 0.5) / block_cells;
    const double *of[2] = {f->x, f->y};
    for (int k = 0; k < 2; k++) {
        const double *a = of[k] + c, *b = a + corners;
        const double  south = a[0] + u * (a[1] - a[0]), north = b[0] + u * (b[1] - b[0]);
        px[k] = south + v * (north - south);
    }
}

static void finder_free(Finder *f) { free(f->x); }

/* The range of the raster's pixels that one row of blocks can touch; returns false when there are none. Reading row by
 * row saves memory. */
static bool finder_bounds(int box[4], Finder *f, int row)
{
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    finder_load(f, row);
    for (int c = 0; c < 2 * (f->blocks + 1); c++) {
        if (!isfinite(f->x[c]) || !isfinite(f->y[c])) continue;
        low[0] = fmin(low[0], f->x[c]);
        high[0] = fmax(high[0], f->x[c]);
        low[1] = fmin(low[1], f->y[c]);
        high[1] = fmax(high[1], f->y[c]);
    }
    if (!(high[0] > 0 && high[1] > 0 && low[0] < f->raster->width && low[1] < f->raster->height)) return false;
    box[0] = (int)fmax(floor(low[0]) - 2, 0);
    box[1] = (int)fmax(floor(low[1]) - 2, 0);
    box[2] = (int)fmin(ceil(high[0]) + 3, f->raster->width);
    box[3] = (int)fmin(ceil(high[1]) + 3, f->raster->height);
    return box[2] - box[0] > 1 && box[3] - box[1] > 1;
}

/* The ENU rectangle about the origin that a raster covers, no wider than `half_m` each way, in whole blocks. */
static bool window_of(Window *out, const Raster *raster, const LocalFrame *frame, double cell_m, double half_m)
{
    double low[2], high[2];
    raster_enu_box(low, high, raster, frame, 0);
    const double margin_m =
        0.01 * (high[0] - low[0]) + 10 * cell_m; /* room for heights, which appear displaced outwards */
    int n[2];
    for (int c = 0; c < 2; c++) {
        low[c] = floor(fmax(low[c] - margin_m, -half_m) / cell_m) * cell_m;
        high[c] = fmin(high[c] + margin_m, half_m);
        if (!(high[c] > low[c])) return false;
        n[c] = ((int)((high[c] - low[c]) / cell_m) / block_cells + 1) * block_cells;
    }
    *out = (Window){low[0], low[1], cell_m, n[0], n[1]};
    return true;
}

static const char cover_key[] = "terrain.cover", photo_key[] = "terrain.orthophoto";

/* ---- cover ---------------------------------------------------------------------------------- */

/* Opens a set whose pixels must be bytes or whole numbers: the usual error is elevation given for the wrong key, and
 * its pixels are floats. */
static Status open_whole(RasterSet *set, const char *paths, const char *key, const char *what)
{
    const Status status = raster_set_open(set, paths, key);
    for (int k = 0; status == STATUS_OK && k < set->count; k++) {
        if (set->raster[k].whole) continue;
        log_error("%s: %s holds numbers with fractions, not %s; is it elevation (terrain.elevation)?", key,
                  set->raster[k].sheet[0].path, what);
        raster_set_close(set);
        *set = (RasterSet){0};
        return STATUS_BAD_VALUE;
    }
    return status;
}

/* code [ny][nx]: one more than the file's code; 0 where nothing is known. */
static Status cover_codes(uint16_t *code, const Window *window, const Raster *raster, int band,
                          const Elevation *elevation, const LocalFrame *frame)
{
    Finder f;
    Status status = finder_create(&f, raster, elevation, frame, window);
    for (int j0 = 0; status == STATUS_OK && j0 < window->ny; j0 += block_cells) {
        int box[4];
        if (!finder_bounds(box, &f, j0 / block_cells)) continue;
        const size_t w = (size_t)(box[2] - box[0]), h = (size_t)(box[3] - box[1]);
        float       *px = malloc(w * h * sizeof *px);
        status = px ? raster_read(px, raster, band, (RasterWindow){box[0], box[1], (int)w, (int)h}, cover_key)
                    : STATUS_NO_MEMORY;
        for (int j = j0; status == STATUS_OK && j < j0 + block_cells && j < window->ny; j++)
            for (int i = 0; i < window->nx; i++) {
                double at[2];
                finder_at(at, &f, i, j);
                const double x = floor(at[0]) - box[0], y = floor(at[1]) - box[1];
                if (!(x >= 0 && y >= 0 && x < (double)w && y < (double)h)) continue;
                const float value = px[(size_t)y * w + (size_t)x];
                uint16_t   *to = &code[(size_t)j * (size_t)window->nx + (size_t)i];
                if (value >= 0 && value < surface_codes_most && (value > 0 ? *to <= 1 : *to == 0))
                    *to = (uint16_t)(value + 1);
            }
        free(px);
    }
    finder_free(&f);
    return status;
}

Status cover_grid_read(CoverGrid out[cover_windows], CoverReport *report, const char *paths, const char *table,
                       int band, const Elevation *elevation, const LocalFrame *frame)
{
    static const double most_cells[cover_windows] = {16e6, 4e6};
    RasterSet           set = {0};
    CoverGrid           grid[cover_windows] = {{0}};
    uint16_t           *code[cover_windows] = {NULL};
    CoverReport         r = {0};
    SurfaceTable        chosen;
    Status              status = open_whole(&set, paths, cover_key, "classes");
    if (status != STATUS_OK) return status;
    const Raster *first = &set.raster[0];
    r.band = band > 0 ? band : first->bands >= 8 ? 4 : 1;
    r.posting_m = fmin(first->posting_m[0], first->posting_m[1]);
    for (int k = 0; k < set.count; k++)
        if (r.band > set.raster[k].bands) {
            log_error("%s: %s has %d bands, not %d; set terrain.cover_band", cover_key, set.raster[k].sheet[0].path,
                      set.raster[k].bands, r.band);
            status = STATUS_BAD_VALUE;
            goto done;
        }
    const double cell_m = fmax(rint(r.posting_m * 4) / 4, 0.25);
    for (int w = 0; w < cover_windows; w++) {
        const double size_m = w ? 8 * cell_m : cell_m;
        double       low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
        for (int k = 0; k < set.count; k++) {
            Window one;
            if (!window_of(&one, &set.raster[k], frame, size_m, 0.5 * sqrt(most_cells[w]) * size_m)) continue;
            low[0] = fmin(low[0], one.x0_m);
            low[1] = fmin(low[1], one.y0_m);
            high[0] = fmax(high[0], one.x0_m + one.nx * size_m);
            high[1] = fmax(high[1], one.y0_m + one.ny * size_m);
        }
        if (!(high[0] > low[0])) continue;
        CoverGrid *g = &grid[w];
        *g = (CoverGrid){.x0_m = low[0], .y0_m = low[1], .cell_m = size_m};
        g->nx = (int)((high[0] - low[0]) / size_m) + 1;
        g->ny = (int)((high[1] - low[1]) / size_m) + 1;
        g->surface = calloc((size_t)g->nx * (size_t)g->ny, 1);
        code[w] = calloc((size_t)g->nx * (size_t)g->ny, sizeof *code[w]);
        status = g->surface && code[w] ? STATUS_OK : STATUS_NO_MEMORY;
        const Window window = {g->x0_m, g->y0_m, size_m, g->nx, g->ny};
        for (int k = 0; status == STATUS_OK && k < set.count; k++)
            status = cover_codes(code[w], &window, &set.raster[k], r.band, elevation, frame);
        if (status != STATUS_OK) goto done;
    }
    long histogram[surface_codes_most] = {0}, classed = 0, of_class[SURFACE_COUNT] = {0};
    for (int w = 0; w < cover_windows; w++)
        for (size_t n = 0; n < (size_t)grid[w].nx * (size_t)grid[w].ny; n++)
            if (code[w][n]) histogram[code[w][n] - 1]++;
    status = surface_table_choose(&chosen, &r.table, table, histogram);
    if (status != STATUS_OK) goto done;
    for (int w = 0; w < cover_windows; w++)
        for (size_t n = 0; n < (size_t)grid[w].nx * (size_t)grid[w].ny; n++) {
            const uint16_t of_file = code[w][n];
            if (of_file > 1 && !chosen.known[of_file - 1] && w == 0) r.unknown++;
            grid[w].surface[n] = of_file ? chosen.surface[of_file - 1] : SURFACE_NONE;
            if (w == 0) of_class[grid[w].surface[n]]++;
        }
    for (int s = 1; s < SURFACE_COUNT; s++) classed += of_class[s];
    for (int s = 1; s < SURFACE_COUNT; s++) r.share[s] = classed ? (double)of_class[s] / (double)classed : 0;
    if (classed == 0) {
        log_error("%s: none of the codes of %s about the action is in the table %s; set terrain.cover_table", cover_key,
                  first->sheet[0].path, r.table);
        status = STATUS_BAD_VALUE;
        goto done;
    }
    memcpy(out, grid, sizeof grid);
    memset(grid, 0, sizeof grid);
    *report = r;
done:
    for (int w = 0; w < cover_windows; w++) free(code[w]);
    cover_grid_free(grid);
    raster_set_close(&set);
    return status;
}

void cover_grid_free(CoverGrid grid[cover_windows])
{
    for (int w = 0; w < cover_windows; w++) {
        if (!grid[w].borrowed) free(grid[w].surface);
        grid[w] = (CoverGrid){0};
    }
}

SurfaceClass cover_grid_at(const CoverGrid grid[cover_windows], double x_m, double y_m)
{
    for (int w = 0; w < cover_windows; w++) {
        const CoverGrid *g = &grid[w];
        const double     x = (x_m - g->x0_m) / g->cell_m, y = (y_m - g->y0_m) / g->cell_m;
        if (!(g->surface && x >= 0 && y >= 0 && x < g->nx && y < g->ny)) continue;
        const SurfaceClass surface = (SurfaceClass)g->surface[(size_t)y * (size_t)g->nx + (size_t)x];
        if (surface > SURFACE_NONE && surface < SURFACE_COUNT)
            return surface; /* a damaged store may hold other values */
    }
    return SURFACE_NONE;
}

/* ---- photograph ----------------------------------------------------------------------------- */

static int by_value(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return x < y ? -1 : x > y;
}

/* White level of samples wider than a byte: the 99.9th percentile over a few rows of the whole image. */
static Status white_of(double *white, const Raster *raster, int bands)
{
    enum { rows = 64 };
    const size_t w = (size_t)raster->width;
    float       *some = malloc(rows * w * sizeof *some);
    Status       status = some ? STATUS_OK : STATUS_NO_MEMORY;
    *white = 0;
    for (int b = 1; status == STATUS_OK && b <= bands; b++) {
        size_t kept = 0;
        for (int r = 0; status == STATUS_OK && r < rows; r++)
            status =
                raster_read(some + (size_t)r * w, raster, b,
                            (RasterWindow){0, (int)((int64_t)r * raster->height / rows), raster->width, 1}, photo_key);
        for (size_t n = 0; status == STATUS_OK && n < rows * w; n++)
            if (isfinite(some[n])) some[kept++] = some[n];
        if (status != STATUS_OK || kept == 0) continue;
        qsort(some, kept, sizeof *some, by_value);
        *white = fmax(*white, some[(size_t)(0.999 * (double)(kept - 1))]);
    }
    free(some);
    if (!(*white > 0)) *white = 1;
    return status;
}

/* Pixels of a box of a raster; w x h for each band. */
typedef struct PhotoBox {
    float *px[3];
    int    bands, w, h;
    bool   bytes;
    double white; /* white level of samples wider than a byte */
} PhotoBox;

/* The colour of one cell: bilinear between pixel centres, in linear light, held at the rim. */
static void photo_cell(uint8_t to[4], const PhotoBox *box, double x, double y)
{
    const int w = box->w, h = box->h, bands = box->bands;
    x = clamp(x - 0.5, 0, w - 1);
    y = clamp(y - 0.5, 0, h - 1);
    const int    a = (int)x < w - 1 ? (int)x : w - 2, b = (int)y < h - 1 ? (int)y : h - 2;
    const double u = x - a, v = y - b, weight[4] = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
    uint8_t      value[3] = {0};
    for (int k = 0; k < bands; k++) {
        const float *q = box->px[k] + (size_t)b * (size_t)w + (size_t)a, four[4] = {q[0], q[1], q[w], q[w + 1]};
        double       sum = 0;
        for (int n = 0; n < 4; n++) {
            if (!isfinite(four[n])) return;
            sum +=
                weight[n] * (box->bytes ? (double)photo_linear((uint8_t)clamp(four[n], 0, 255)) : four[n] / box->white);
        }
        value[k] = photo_encoded((float)clamp(sum, 0, 1));
    }
    for (int k = 0; k < 3; k++) to[k] = value[bands == 3 ? k : 0];
    to[3] = 255;
}

static Status photo_pixels(uint8_t *rgba, const Photo *p, const Raster *raster, const Elevation *elevation,
                           const LocalFrame *frame)
{
    const Window window = {p->x0_m, p->y0_m, p->cell_m, p->nx[0], p->ny[0]};
    const int    bands = raster->bands >= 3 ? 3 : 1;
    double       white = 255;
    Finder       f;
    Status       status = raster->bytes ? STATUS_OK : white_of(&white, raster, bands);
    if (status != STATUS_OK) return status;
    status = finder_create(&f, raster, elevation, frame, &window);
    for (int j0 = 0; status == STATUS_OK && j0 < window.ny; j0 += block_cells) {
        int box[4];
        if (!finder_bounds(box, &f, j0 / block_cells)) continue;
        const int w = box[2] - box[0], h = box[3] - box[1];
        PhotoBox  some = {.bands = bands, .w = w, .h = h, .bytes = raster->bytes, .white = white};
        for (int b = 0; status == STATUS_OK && b < bands; b++) {
            float *px = some.px[b] = malloc((size_t)w * (size_t)h * sizeof *px);
            status =
                px ? raster_read(px, raster, b + 1, (RasterWindow){box[0], box[1], w, h}, photo_key) : STATUS_NO_MEMORY;
        }
        for (int j = j0; status == STATUS_OK && j < j0 + block_cells && j < window.ny; j++)
            for (int i = 0; i < window.nx; i++) {
                uint8_t *to = rgba + 4 * ((size_t)j * (size_t)window.nx + (size_t)i);
                double   at[2];
                if (to[3]) continue; /* an earlier, finer photograph covers it */
                finder_at(at, &f, i, j);
                if (at[0] >= 0 && at[1] >= 0 && at[0] < raster->width && at[1] < raster->height)
                    photo_cell(to, &some, at[0] - box[0], at[1] - box[1]);
            }
        for (int b = 0; b < 3; b++) free(some.px[b]);
    }
    finder_free(&f);
    return status;
}

/* Makes the blocks of all mips; rgba is overwritten by the smaller mips. */
static Status photo_from_pixels(Photo *p, uint8_t *rgba)
{
    for (int k = 0; k < p->mips; k++) {
        const int    nx = p->nx[k], ny = p->ny[k];
        const size_t row = 4 * (size_t)nx;
        p->block[k] = malloc(photo_block_count(p, k) * sizeof **p->block);
        if (!p->block[k]) return STATUS_NO_MEMORY;
        for (int j = 0; j < ny; j += 4)
            photo_block_row(p->block[k] + (size_t)(j / 4) * photo_blocks_across(nx), rgba + (size_t)j * row, nx,
                            ny - j < 4 ? ny - j : 4);
        for (int j = 0; k + 1 < p->mips && j < ny;
             j += 2) /* each row of the next mip ends before the pixels that are still needed */
            photo_halve_row(rgba + (size_t)(j / 2) * 4 * (size_t)p->nx[k + 1], rgba + (size_t)j * row,
                            j + 1 < ny ? rgba + (size_t)(j + 1) * row : NULL, nx);
    }
    return STATUS_OK;
}

Status photo_read(Photo *out, double *posting_m, const char *paths, const Elevation *elevation, const LocalFrame *frame)
{
    static const double most_cells = 36e6;
    RasterSet           set = {0};
    Photo               p = {0};
    Window              window;
    uint8_t            *rgba = NULL;
    Status              status = open_whole(&set, paths, photo_key, "a photograph");
    if (status != STATUS_OK) return status;
    const Raster *first = &set.raster[0];
    *posting_m = fmin(first->posting_m[0], first->posting_m[1]);
    p.cell_m = *posting_m;
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int k = 0; k < set.count; k++) {
        if (!window_of(&window, &set.raster[k], frame, p.cell_m, 0.5 * sqrt(most_cells) * p.cell_m)) continue;
        low[0] = fmin(low[0], window.x0_m);
        low[1] = fmin(low[1], window.y0_m);
        high[0] = fmax(high[0], window.x0_m + window.nx * p.cell_m);
        high[1] = fmax(high[1], window.y0_m + window.ny * p.cell_m);
    }
    if (!(high[0] > low[0])) {
        log_error("%s: %s does not reach the action; name a photograph of the place, or leave it out", photo_key,
                  first->sheet[0].path);
        status = STATUS_BAD_VALUE;
        goto done;
    }
    p.x0_m = low[0];
    p.y0_m = low[1];
    p.nx[0] = (int)((high[0] - low[0]) / p.cell_m + 0.5);
    p.ny[0] = (int)((high[1] - low[1]) / p.cell_m + 0.5);
    p.mips = photo_mips(p.nx, p.ny);
    rgba = calloc((size_t)p.nx[0] * (size_t)p.ny[0], 4);
    status = rgba ? STATUS_OK : STATUS_NO_MEMORY;
    for (int k = 0; status == STATUS_OK && k < set.count; k++)
        status = photo_pixels(rgba, &p, &set.raster[k], elevation, frame);
    if (status == STATUS_OK) status = photo_from_pixels(&p, rgba);
    if (status != STATUS_OK) goto done;
    *out = p;
    p = (Photo){0};
done:
    free(rgba);
    photo_free(&p);
    raster_set_close(&set);
    return status;
}
