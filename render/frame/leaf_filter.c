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
        if (!(job->smoothed[k] = arena_alloc(arena, px, sizeof(float)))) return STATUS_NO_MEMORY;
    return STATUS_OK;
}

/* Pixels of a tile and of one row and column about it that show plants, or gaps between them: ground beside a plant.
 * False: the tile has none. */
static bool find_leaves(bool leaf[halo_side][halo_side], const Job *job, const Tile *tile)
{
    const Picture *p = job->picture;
    bool           plant[reach_side][reach_side] = {{false}}, any = false;
    for (int y = tile->y0 > 2 ? tile->y0 - 2 : 0; y < tile->y1 + 2 && y < p->height; y++)
        for (int x = tile->x0 > 2 ? tile->x0 - 2 : 0; x < tile->x1 + 2 && x < p->width; x++) {
            any |= plant[y - tile->y0 + 2][x - tile->x0 + 2] = picture_shows_plant(p, pixel_index(job, x, y));
        }
    for (int j = 0; any && j < halo_side; j++)
        for (int i = 0; i < halo_side; i++) {
            const int x = tile->x0 + i - 1, y = tile->y0 + j - 1;
            leaf[j][i] = plant[j + 1][i + 1];
            if (leaf[j][i] || x < 0 || y < 0 || x >= p->width || y >= p->height) continue;
            const size_t px = pixel_index(job, x, y);
            leaf[j][i] = p->cover[px] != SURFACE_NONE && !p->entity[px] &&
                         (plant[j][i + 1] || plant[j + 2][i + 1] || plant[j + 1][i] || plant[j + 1][i + 2]);
        }
    return any;
}

/* A pool task: a tile, into Job.smoothed. */
static void smooth_tile(void *user, int worker, int task)
{
    static const float of[9] = {1, 2, 1, 2, 11, 2, 1, 2, 1}; /* frame_private.h */
    const Job         *job = user;
    const Tile         tile = tile_of(job, task);
    const int          width = job->picture->width;
    bool               leaf[halo_side][halo_side];
    (void)worker;
    if (!(job->leafy[task] = find_leaves(leaf, job, &tile))) return;
    for (int y = tile.y0; y < tile.y1; y++)
        for (int x = tile.x0; x < tile.x1; x++) {
            const size_t px = pixel_index(job, x, y);
            float        weight[9] = {0, 0, 0, 0, 1}, sum = 0;
            if (leaf[y - tile.y0 + 1][x - tile.x0 + 1] && !job->refine[px]) {
                for (int k = 0; k < 9; k++)
                    sum += weight[k] = leaf[y - tile.y0 + k / 3][x - tile.x0 + k % 3] ? of[k] : 0;
                for (int k = 0; k < 9; k++) weight[k] /= sum;
                if (record_in_box(job, x, y, x + 1, y + 1)) record_smoothed(job, weight);
            }
            for (int c = 0; c < job->channels; c++) {
                const float *value = picture_plane(job->picture, job->channel[c].plane) + px;
                float        mean = weight[4] * value[0];
                for (int k = 0; sum > 0 && k < 9; k++)
                    if (k != 4 && weight[k] > 0) mean += weight[k] * value[(k / 3 - 1) * width + k % 3 - 1];
                job->smoothed[c][px] = mean;
            }
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
