/* terrain/landscape/raster_window.c: a window of ENU, and the positions of its cells in a raster. */
#include "terrain/landscape/raster_window.h"

#include <stdlib.h>

Status finder_create(Finder *f, const Raster *raster, const Elevation *elevation, const LocalFrame *frame,
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
                               f->window.y0_m + (row + side) * block_cells * f->window.cell_m, 0}, p_ecef[3];
            Geodetic place = {NAN, NAN, 0};
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

void finder_at(double px[2], Finder *f, int i, int j)
{
    if (j / block_cells != f->row) finder_load(f, j / block_cells);
    const int    corners = f->blocks + 1, c = i / block_cells;
    const double u = (i % block_cells + 0.5) / block_cells, v = (j % block_cells + 0.5) / block_cells;
    const double *of[2] = {f->x, f->y};
    for (int k = 0; k < 2; k++) {
        const double *a = of[k] + c, *b = a + corners;
        const double  south = a[0] + u * (a[1] - a[0]), north = b[0] + u * (b[1] - b[0]);
        px[k] = south + v * (north - south);
    }
}

void finder_free(Finder *f)
{
    free(f->x);
}

bool finder_bounds(int box[4], Finder *f, int row)
{
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    finder_load(f, row);
    for (int c = 0; c < 2 * (f->blocks + 1); c++) {
        if (!isfinite(f->x[c]) || !isfinite(f->y[c])) continue;
        low[0]  = fmin(low[0], f->x[c]);
        high[0] = fmax(high[0], f->x[c]);
        low[1]  = fmin(low[1], f->y[c]);
        high[1] = fmax(high[1], f->y[c]);
    }
    if (!(high[0] > 0 && high[1] > 0 && low[0] < f->raster->width && low[1] < f->raster->height)) return false;
    box[0] = (int)fmax(floor(low[0]) - 2, 0);
    box[1] = (int)fmax(floor(low[1]) - 2, 0);
    box[2] = (int)fmin(ceil(high[0]) + 3, f->raster->width);
    box[3] = (int)fmin(ceil(high[1]) + 3, f->raster->height);
    return box[2] - box[0] > 1 && box[3] - box[1] > 1;
}

bool window_of(Window *out, const Raster *raster, const LocalFrame *frame, double cell_m, double half_m)
{
    double low[2], high[2];
    raster_enu_box(low, high, raster, frame, 0);
    const double margin_m = 0.01 * (high[0] - low[0]) + 10 * cell_m; /* heights lean outwards */
    int n[2];
    for (int c = 0; c < 2; c++) {
        low[c]  = floor(fmax(low[c] - margin_m, -half_m) / cell_m) * cell_m;
        high[c] = fmin(high[c] + margin_m, half_m);
        if (!(high[c] > low[c])) return false;
        n[c] = ((int)((high[c] - low[c]) / cell_m) / block_cells + 1) * block_cells;
    }
    *out = (Window){low[0], low[1], cell_m, n[0], n[1]};
    return true;
}
