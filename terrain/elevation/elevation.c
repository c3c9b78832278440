/* terrain/elevation/elevation.c: store and look-up of the nested grids. The surface itself is defined in the header. */
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

Status elevation_level_create(Elevation *elevation, int index, int nx, int ny, double x0_m, double y0_m,
                              double spacing_m, double z0_m, double step_m)
{
    if (index < 0 || index >= elevation_max_levels || nx < 2 || ny < 2 || nx > 32768 || ny > 32768)
        return STATUS_BAD_VALUE;
    if (!(spacing_m > 0 && step_m > 0) || !isfinite(spacing_m) || !isfinite(step_m)) return STATUS_BAD_VALUE;
    if (!isfinite(x0_m) || !isfinite(y0_m) || !isfinite(z0_m)) return STATUS_BAD_VALUE;

    ElevationLevel level = {.nx = nx, .ny = ny, .x0_m = x0_m, .y0_m = y0_m,
                            .spacing_m = spacing_m, .z0_m = z0_m, .step_m = step_m};
    level.post = heights_create((size_t)nx * ny, sizeof *level.post);
    bool whole = level.post != NULL;
    for (int w = nx - 1, h = ny - 1; whole; w = (w + 1) / 2, h = (h + 1) / 2) {
        const int k = level.pyramid_count;
        level.pyramid[k] = heights_create((size_t)w * h, sizeof **level.pyramid);
        level.pyramid_nx[k] = w;
        level.pyramid_ny[k] = h;
        whole = level.pyramid[k] != NULL;
        level.pyramid_count += whole;
        if (whole && k >= elevation_rise_level) {
            level.rise[k] = heights_create((size_t)w * h, sizeof **level.rise);
            whole = level.rise[k] != NULL;
        }
        if (w == 1 && h == 1) break; /* 32767 cells halve to one in 15 steps: 16 entries are enough */
    }
    if (!whole) {
        free(level.post);
        for (int k = 0; k < level.pyramid_count; k++) {
            free(level.pyramid[k]);
            free(level.rise[k]);
        }
        return STATUS_NO_MEMORY;
    }

    elevation->level[index] = level;
    if (elevation->level_count <= index) elevation->level_count = index + 1;
    return STATUS_OK;
}

static inline uint16_t max_u16(uint16_t a, uint16_t b)
{
    return a > b ? a : b;
}

static void cell_maxima(ElevationLevel *level)
{
    const int nx = level->nx, w = nx - 1;
    for (int j = 0; j < level->ny - 1; j++) {
        const uint16_t *restrict south = level->post + (size_t)j * nx;
        const uint16_t *restrict north = south + nx;
        uint16_t *restrict       out = level->pyramid[0] + (size_t)j * w;
        for (int i = 0; i < w; i++)
            out[i] = max_u16(max_u16(south[i], south[i + 1]), max_u16(north[i], north[i + 1]));
    }
}

static void halve_maxima(uint16_t *restrict out, int out_w, int out_h, const uint16_t *restrict in, int w, int h)
{
    for (int j = 0; j < out_h; j++) {
        const uint16_t *a = in + (size_t)(2 * j) * w;
        const uint16_t *b = 2 * j + 1 < h ? a + w : a;
        for (int i = 0; i < w / 2; i++)
            out[(size_t)j * out_w + i] = max_u16(max_u16(a[2 * i], a[2 * i + 1]), max_u16(b[2 * i], b[2 * i + 1]));
        if (w % 2) out[(size_t)j * out_w + out_w - 1] = max_u16(a[w - 1], b[w - 1]);
    }
}

/* Rise from a to b into `to`, from b to a into `from`, of count edges. */
static void steepest(uint16_t *restrict to, uint16_t *restrict from, const uint16_t *a, const uint16_t *b, int count)
{
    for (int i = 0; i < count; i++) {
        const uint16_t up = (uint16_t)(b[i] > a[i] ? b[i] - a[i] : 0), down = (uint16_t)(a[i] > b[i] ? a[i] - b[i] : 0);
        to[i]   = max_u16(to[i], up);
        from[i] = max_u16(from[i], down);
    }
}

/* The first level of rises, a row of nodes at a time: first the steepest of each column of edges, then of a node's. */
static void cell_rises(ElevationLevel *level)
{
    enum { k = elevation_rise_level, side = 1 << k, chunk = 64 * side };
    for (int node_j = 0; node_j < level->pyramid_ny[k]; node_j++)
        for (int i0 = 0; i0 < level->nx - 1; i0 += chunk) {
            uint16_t       steep[4][chunk + 1] = {{0}};
            const int      edges = level->nx - 1 - i0 < chunk ? level->nx - 1 - i0 : chunk;
            const int      j0 = node_j << k, j1 = j0 + side < level->ny - 1 ? j0 + side : level->ny - 1;
            ElevationRise *out = level->rise[k] + (size_t)node_j * level->pyramid_nx[k] + (i0 >> k);
            for (int j = j0; j <= j1; j++) {
                const uint16_t *row = level->post + (size_t)j * level->nx + i0;
                steepest(steep[0], steep[1], row, row + 1, edges);
                if (j < j1) steepest(steep[2], steep[3], row, row + level->nx, edges + 1);
            }
            for (int i = 0; i < edges; i += side) {
                const int last = i + side < edges ? i + side : edges;
                uint16_t  most[4] = {0};
                for (int c = 0; c < 4; c++)
                    for (int n = i; n < last + (c >= 2); n++) most[c] = max_u16(most[c], steep[c][n]);
                out[i >> k] = (ElevationRise){most[0], most[1], most[2], most[3]};
            }
        }
}

static void halve_rises(ElevationLevel *level, int k)
{
    const int w = level->pyramid_nx[k - 1], h = level->pyramid_ny[k - 1];
    for (int j = 0; j < level->pyramid_ny[k]; j++)
        for (int i = 0; i < level->pyramid_nx[k]; i++) {
            ElevationRise most = {0};
            for (int n = 0; n < 4; n++) {
                const int at_i = 2 * i + n % 2, at_j = 2 * j + n / 2;
                if (at_i >= w || at_j >= h) continue;
                const ElevationRise *part = &level->rise[k - 1][(size_t)at_j * w + at_i];
                most.east  = max_u16(most.east, part->east);
                most.west  = max_u16(most.west, part->west);
                most.north = max_u16(most.north, part->north);
                most.south = max_u16(most.south, part->south);
            }
            level->rise[k][(size_t)j * level->pyramid_nx[k] + i] = most;
        }
}

void elevation_build_pyramids(Elevation *elevation)
{
    for (int n = 0; n < elevation->level_count; n++) {
        ElevationLevel *level = &elevation->level[n];
        if (!level->post) continue;
        cell_maxima(level);
        for (int k = 1; k < level->pyramid_count; k++)
            halve_maxima(level->pyramid[k], level->pyramid_nx[k], level->pyramid_ny[k], level->pyramid[k - 1],
                         level->pyramid_nx[k - 1], level->pyramid_ny[k - 1]);
        if (level->pyramid_count > elevation_rise_level) cell_rises(level);
        for (int k = elevation_rise_level + 1; k < level->pyramid_count; k++) halve_rises(level, k);
    }
}

void elevation_destroy(Elevation *elevation)
{
    if (!elevation) return;
    for (int n = 0; n < elevation_max_levels; n++) {
        free(elevation->level[n].post);
        for (int k = 0; k < elevation_pyramid_levels; k++) {
            free(elevation->level[n].pyramid[k]);
            free(elevation->level[n].rise[k]);
        }
    }
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

        const uint16_t *south = level->post + (size_t)j * level->nx + i, *north = south + level->nx;
        const double    sw = level->z0_m + level->step_m * south[0], se = level->z0_m + level->step_m * south[1];
        const double    nw = level->z0_m + level->step_m * north[0], ne = level->z0_m + level->step_m * north[1];
        const double    du = u >= v ? se - sw : ne - nw, dv = u >= v ? ne - se : nw - sw;
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
