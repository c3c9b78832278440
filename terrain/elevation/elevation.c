/* terrain/elevation/elevation.c: memory and look-up of the nested grids. The header defines the surface. */
#include "terrain/elevation/elevation.h"

#include <stdlib.h>
#include <sys/mman.h>

/* Zeroed heights. A ray touches a few of hundreds of megabytes: large arrays use huge pages where available, or half of
 * a look-up would be the TLB miss. NULL: no memory. */
static void *heights_create(size_t count, size_t size)
{
    static const size_t page = (size_t)1 << 21;
    const size_t        bytes = count * size;
    if (bytes < 2 * page) return calloc(count, size);
    void *heights = aligned_alloc(page, (bytes + page - 1) / page * page);
    if (!heights) return NULL;
    madvise(heights, bytes, MADV_HUGEPAGE); /* advisory: without huge pages only the run time changes */
    return memset(heights, 0, bytes);
}

Status elevation_level_describe(ElevationLevel *out, int nx, int ny, double x0_m, double y0_m, double spacing_m,
                                double z0_m, double step_m)
{
    if (nx < 2 || ny < 2 || nx > elevation_most_posts || ny > elevation_most_posts) return STATUS_BAD_VALUE;
    if (!(spacing_m > 0 && step_m > 0) || !isfinite(spacing_m) || !isfinite(step_m)) return STATUS_BAD_VALUE;
    if (!isfinite(x0_m) || !isfinite(y0_m) || !isfinite(z0_m)) return STATUS_BAD_VALUE;

    ElevationLevel level = {.nx = nx, .ny = ny, .x0_m = x0_m, .y0_m = y0_m, .spacing_m = spacing_m,
                            .z0_m = z0_m, .step_m = step_m, .plain = true};
    level.tiles_x = (nx - 2) / elevation_tile_cells + 1;
    level.tiles_y = (ny - 2) / elevation_tile_cells + 1;
    if (elevation_level_stored(&level) > INT32_MAX) return STATUS_BAD_VALUE;
    for (int k = 0, w = nx - 1, h = ny - 1;; k++, w = (w + 1) / 2, h = (h + 1) / 2) {
        level.pyramid_nx[k] = w;
        level.pyramid_ny[k] = h;
        level.pyramid_count = k + 1;
        if (w == 1 && h == 1 && k >= elevation_pyramid_first) break; /* 65535 cells halve to one in 16 steps */
    }
    *out = level;
    return STATUS_OK;
}

size_t elevation_level_stored(const ElevationLevel *level)
{
    return (size_t)level->tiles_x * (size_t)level->tiles_y * elevation_tile_posts;
}

static void free_arrays(ElevationLevel *level)
{
    if (level->borrowed) return;
    free(level->tile);
    free(level->stored);
    for (int k = 0; k < elevation_pyramid_levels; k++) {
        free(level->pyramid[k]);
        free(level->rise[k]);
    }
}

Status elevation_level_create(Elevation *elevation, int index, int nx, int ny, double x0_m, double y0_m,
                              double spacing_m, double z0_m, double step_m)
{
    ElevationLevel level;
    if (index < 0 || index >= elevation_max_levels) return STATUS_BAD_VALUE;
    const Status status = elevation_level_describe(&level, nx, ny, x0_m, y0_m, spacing_m, z0_m, step_m);
    if (status != STATUS_OK) return status;

    level.tile   = calloc((size_t)level.tiles_x * (size_t)level.tiles_y, sizeof *level.tile);
    level.stored = heights_create(elevation_level_stored(&level), sizeof *level.stored);
    bool whole = level.tile && level.stored;
    for (int k = elevation_pyramid_first; k < level.pyramid_count && whole; k++) {
        const size_t nodes = (size_t)level.pyramid_nx[k] * (size_t)level.pyramid_ny[k];
        level.pyramid[k]   = heights_create(nodes, sizeof **level.pyramid);
        if (k >= elevation_rise_level) level.rise[k] = heights_create(nodes, sizeof **level.rise);
        whole = level.pyramid[k] && (k < elevation_rise_level || level.rise[k]);
    }
    if (!whole) {
        free_arrays(&level);
        return STATUS_NO_MEMORY;
    }

    elevation->level[index] = level;
    if (elevation->level_count <= index) elevation->level_count = index + 1;
    return STATUS_OK;
}

void elevation_destroy(Elevation *elevation)
{
    if (!elevation) return;
    for (int n = 0; n < elevation_max_levels; n++) free_arrays(&elevation->level[n]);
    *elevation = (Elevation){0};
}

double elevation_height(const Elevation *elevation, double x_m, double y_m, double normal_enu[3])
{
    for (int n = 0; n < elevation->level_count; n++) {
        const ElevationLevel *level = &elevation->level[n];
        const double fx = (x_m - level->x0_m) / level->spacing_m, fy = (y_m - level->y0_m) / level->spacing_m;
        if (!(fx >= 0 && fy >= 0 && fx <= level->nx - 1 && fy <= level->ny - 1)) continue;

        /* the northern and eastern outline belong to the last cell */
        const int    i = fx < level->nx - 1 ? (int)fx : level->nx - 2;
        const int    j = fy < level->ny - 1 ? (int)fy : level->ny - 2;
        const double u = fx - i, v = fy - j;

        int32_t post[4];
        elevation_cell(post, level, i, j);
        const double sw = level->z0_m + level->step_m * post[0], se = level->z0_m + level->step_m * post[1];
        const double nw = level->z0_m + level->step_m * post[2], ne = level->z0_m + level->step_m * post[3];
        const double du = u >= v ? se - sw : ne - nw, dv = u >= v ? ne - se : nw - sw;
        if (normal_enu) {
            const double s = level->spacing_m, length = sqrt(du * du + dv * dv + s * s);
            normal_enu[0] = -du / length;
            normal_enu[1] = -dv / length;
            normal_enu[2] = s / length;
        }
        return sw + u * du + v * dv;
    }
    return NAN;
}
