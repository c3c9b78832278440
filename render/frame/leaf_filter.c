/* render/frame/leaf_filter.c: radiance of plants, smoothed from pixel to pixel. */
#include "render/frame/frame_private.h"

enum { halo_side = tile_side_samples + 2, reach_side = halo_side + 2 };

Status leaf_filter_prepare(Job *job, Arena *arena)
{
    const size_t px = (size_t)job->picture->width * (size_t)job->picture->height;
    if (!job->picture->instance || !looks_for_edges(job->request) || job->request->samples > 1) return STATUS_OK;
    job->leafy = arena_alloc(arena, (size_t)job->tiles_x * (size_t)job->tiles_y, sizeof *job->leafy);
    job->smoothed = arena_alloc(arena, picture_radar, sizeof *job->smoothed);
    if (!job->smoothed || !job->leafy) return STATUS_NO_MEMORY;
    for (int k = 0; k < job->channels; k++)
        if (!(job->smoothed[k] = arena_alloc_raw(arena, px, sizeof(float)))) return STATUS_NO_MEMORY;
    return STATUS_OK;
}

/* Pixels of a tile and of one row and column about it that show plants, or gaps between them: ground beside a plant.
 * False: the tile has none. */
static bool find_leaves(uint8_t leaf[halo_side][halo_side], const Job *job, const Tile *tile)
{
    const Picture *p = job->picture;
    uint8_t        plant[reach_side][reach_side] = {{0}}, any = 0;
    const int      x0 = tile->x0 > 2 ? tile->x0 - 2 : 0, x1 = tile->x1 + 2 < p->width ? tile->x1 + 2 : p->width;
    for (int y = tile->y0 > 2 ? tile->y0 - 2 : 0; y < tile->y1 + 2 && y < p->height; y++) {
        uint8_t        *row = &plant[y - tile->y0 + 2][x0 - tile->x0 + 2];
        const uint32_t *instance = p->instance + pixel_index(job, x0, y), *part = p->part + pixel_index(job, x0, y);
        for (int k = 0; k < x1 - x0; k++) any |= row[k] = instance[k] && !part[k]; /* picture_shows_plant */
    }
    for (int j = 0; any && j < halo_side; j++)
        for (int i = 0; i < halo_side; i++) {
            const int x = tile->x0 + i - 1, y = tile->y0 + j - 1;
            leaf[j][i] = plant[j + 1][i + 1];
            if (leaf[j][i] || !(plant[j][i + 1] | plant[j + 2][i + 1] | plant[j + 1][i] | plant[j + 1][i + 2]))
                continue;
            if (x < 0 || y < 0 || x >= p->width || y >= p->height) continue;
            const size_t px = pixel_index(job, x, y);
            leaf[j][i] = p->cover[px] != SURFACE_NONE && !p->entity[px];
        }
    return any;
}

enum { beside_count = 9, beside_own = 4 };

/* Weights of the 3 x 3 pixels about each of a row, with those that are not smoothed of themselves alone. */
typedef struct RowWeights {
    float of[beside_count][tile_side_samples];
} RowWeights;

static void weigh_row(RowWeights *out, const uint8_t leaf[halo_side][halo_side], const uint8_t *refined, int j,
                      int count)
{
    static const float of[beside_count] = {1, 2, 1, 2, 11, 2, 1, 2, 1}; /* frame_private.h */
    float              sum[tile_side_samples] = {0};
    uint8_t            smoothed[tile_side_samples];
    for (int i = 0; i < count; i++) smoothed[i] = leaf[j + 1][i + 1] && !refined[i];
    for (int k = 0; k < beside_count; k++) {
        const uint8_t *beside = &leaf[j + k / 3][k % 3];
        for (int i = 0; i < count; i++) {
            out->of[k][i] = beside[i] & smoothed[i] ? of[k] : 0;
            sum[i] += out->of[k][i];
        }
    }
    for (int i = 0; i < count; i++) {
        out->of[beside_own][i] = smoothed[i] ? of[beside_own] : 1;
        sum[i] = smoothed[i] ? sum[i] : 1;
    }
    for (int k = 0; k < beside_count; k++)
        for (int i = 0; i < count; i++) out->of[k][i] /= sum[i];
}

/* A row of `count` pixels from x, y on, of one plane. */
static void smooth_row(float *restrict out, const Job *job, const float *plane, const RowWeights *weight, int x, int y,
                       int count)
{
    const int    width = job->picture->width, height = job->picture->height;
    const float *here = plane + pixel_index(job, x, y);
    for (int i = 0; i < count; i++) out[i] = weight->of[beside_own][i] * here[i];
    for (int k = 0; k < beside_count; k++) {
        const int    dx = k % 3 - 1, dy = k / 3 - 1;
        const float *of = weight->of[k];
        if (k == beside_own || y + dy < 0 || y + dy >= height) continue;
        const int    first = (x + dx < 0), end = (x + count + dx > width) ? count - 1 : count;
        const float *value = plane + pixel_index(job, x + first + dx, y + dy);
        for (int i = first; i < end; i++) {
            const float more = out[i] + of[i] * value[i - first];
            out[i] = of[i] > 0 ? more : out[i];
        }
    }
}

/* A pool task: a tile, into Job.smoothed. */
static void smooth_tile(void *user, int worker, int task)
{
    const Job         *job = user;
    const Tile         tile = tile_of(job, task);
    const int          count = tile.x1 - tile.x0;
    uint8_t            leaf[halo_side][halo_side];
    RowWeights         weight;
    const float       *plane[picture_radar];
    PixelRecord *const record = job->request->record;
    (void)worker;
    if (!(job->leafy[task] = find_leaves(leaf, job, &tile))) return;
    for (int c = 0; c < job->channels; c++) plane[c] = picture_plane(job->picture, job->channel[c].plane);
    for (int y = tile.y0; y < tile.y1; y++) {
        const size_t px = pixel_index(job, tile.x0, y);
        weigh_row(&weight, (const uint8_t(*)[halo_side])leaf, job->refine + px, y - tile.y0, count);
        for (int c = 0; c < job->channels; c++)
            smooth_row(job->smoothed[c] + px, job, plane[c], &weight, tile.x0, y, count);
        if (!record_in_box(job, tile.x0, y, tile.x1, y + 1)) continue;
        const int i = record->x - tile.x0;
        float     of[beside_count];
        for (int k = 0; k < beside_count; k++) of[k] = weight.of[k][i];
        if (leaf[y - tile.y0 + 1][i + 1] && !job->refine[px + (size_t)i]) record_smoothed(job, of);
    }
}

/* A pool task: a tile, back into the planes. */
static void keep_tile(void *user, int worker, int task)
{
    const Job   *job = user;
    const Tile   tile = tile_of(job, task);
    const size_t octets = (size_t)(tile.x1 - tile.x0) * sizeof(float);
    (void)worker;
    if (!job->leafy[task]) return;
    for (int c = 0; c < job->channels; c++)
        for (int y = tile.y0; y < tile.y1; y++) {
            const size_t px = pixel_index(job, tile.x0, y);
            memcpy(picture_plane(job->picture, job->channel[c].plane) + px, job->smoothed[c] + px, octets);
        }
}

void leaf_filter(Job *job, Pool *pool)
{
    pool_run(pool, job->tiles_x * job->tiles_y, smooth_tile, job);
    pool_run(pool, job->tiles_x * job->tiles_y, keep_tile, job);
}
