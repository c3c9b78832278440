/* terrain/elevation.c: store and look-up of the nested grids. The surface itself is defined in the header. */
#include "terrain/elevation.h"

#include <stdlib.h>
#include <sys/mman.h>

/* Zeroed heights. A ray touches a few of hundreds of megabytes: what is large lies on large pages where the system
 * has them, or half of a look would be looking up its page. NULL: no memory. */
static uint16_t *heights_create(size_t count)
{
    static const size_t page = (size_t)1 << 21;
    const size_t        bytes = count * sizeof(uint16_t);
    if (bytes < 2 * page) return calloc(count, sizeof(uint16_t));
    void *heights = aligned_alloc(page, (bytes + page - 1) / page * page);
    if (!heights) return NULL;
    madvise(heights, bytes, MADV_HUGEPAGE); /* a wish: where it is not granted nothing changes but the time */
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
    level.post = heights_create((size_t)nx * ny);
    bool whole = level.post != NULL;
    for (int w = nx - 1, h = ny - 1; whole; w = (w + 1) / 2, h = (h + 1) / 2) {
        const int k = level.pyramid_count;
        level.pyramid[k] = heights_create((size_t)w * h);
        level.pyramid_nx[k] = w;
        level.pyramid_ny[k] = h;
        whole = level.pyramid[k] != NULL;
        level.pyramid_count += whole;
        if (w == 1 && h == 1) break; /* 32767 cells halve to one in 15 steps: 16 entries are enough */
    }
    if (!whole) {
        free(level.post);
        for (int k = 0; k < level.pyramid_count; k++) free(level.pyramid[k]);
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

void elevation_build_pyramids(Elevation *elevation)
{
    for (int n = 0; n < elevation->level_count; n++) {
        ElevationLevel *level = &elevation->level[n];
        if (!level->post) continue;
        cell_maxima(level);
        for (int k = 1; k < level->pyramid_count; k++)
            halve_maxima(level->pyramid[k], level->pyramid_nx[k], level->pyramid_ny[k], level->pyramid[k - 1],
                         level->pyramid_nx[k - 1], level->pyramid_ny[k - 1]);
    }
}

void elevation_destroy(Elevation *elevation)
{
    if (!elevation) return;
    for (int n = 0; n < elevation_max_levels; n++) {
        free(elevation->level[n].post);
        for (int k = 0; k < elevation_pyramid_levels; k++) free(elevation->level[n].pyramid[k]);
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
