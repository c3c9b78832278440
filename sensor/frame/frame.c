/* sensor/frame/frame.c: the pool of frames, and the planes of a frame as arrays. */
#include "sensor/frame/frame.h"
#include "pitviper_channels.h"

#include <pthread.h>
#include <stdlib.h>

/* ---- frames, counted, in a pool ------------------------------------------------------------------ */

struct FramePool {
    int             count;
    Frame          *frame; /* [count] */
    pthread_mutex_t lock;  /* of the frames' reference counts */
    pthread_cond_t  released;
};

Status frame_pool_create(FramePool **out, int frames)
{
    FramePool *pool = calloc(1, sizeof *pool);
    if (!pool) return STATUS_NO_MEMORY;
    pthread_mutex_init(&pool->lock, NULL);
    pthread_cond_init(&pool->released, NULL);
    pool->frame = calloc((size_t)frames, sizeof *pool->frame);
    bool whole = pool->frame != NULL;
    for (int i = 0; i < frames && whole; i++) {
        pool->count = i + 1;
        pool->frame[i].pool = pool;
        whole = (pool->frame[i].arena = arena_create()) != NULL;
    }
    if (whole) *out = pool;
    else frame_pool_destroy(pool);
    return whole ? STATUS_OK : STATUS_NO_MEMORY;
}

void frame_pool_destroy(FramePool *pool)
{
    if (!pool) return;
    for (int i = 0; i < pool->count; i++) arena_destroy(pool->frame[i].arena);
    pthread_cond_destroy(&pool->released);
    pthread_mutex_destroy(&pool->lock);
    free(pool->frame);
    free(pool);
}

static Frame *free_one(FramePool *pool)
{
    for (int i = 0; i < pool->count; i++)
        if (pool->frame[i].holds == 0) return &pool->frame[i];
    return NULL;
}

Frame *frame_pool_take(FramePool *pool)
{
    Frame *frame;
    pthread_mutex_lock(&pool->lock);
    while (!(frame = free_one(pool))) pthread_cond_wait(&pool->released, &pool->lock);
    frame->holds = 1;
    pthread_mutex_unlock(&pool->lock);
    Arena *arena = frame->arena;
    arena_reset(arena);
    *frame = (Frame){.arena = arena, .pool = pool, .holds = 1};
    return frame;
}

void frame_hold(Frame *frame)
{
    pthread_mutex_lock(&frame->pool->lock);
    frame->holds++;
    pthread_mutex_unlock(&frame->pool->lock);
}

void frame_release(Frame *frame)
{
    if (!frame) return;
    FramePool *pool = frame->pool;
    pthread_mutex_lock(&pool->lock);
    if (--frame->holds == 0) pthread_cond_signal(&pool->released);
    pthread_mutex_unlock(&pool->lock);
}

const FrameOutput *frame_output(const Frame *frame, const InstrumentKind *kind)
{
    for (int i = 0; i < frame->outputs; i++)
        if (frame->output[i].kind == kind) return &frame->output[i];
    return NULL;
}

/* ---- the planes of an image ---------------------------------------------------------------------- */

int frame_planes(FrameArray plane[frame_max_planes], const Picture *p, const RenderRequest *request)
{
    const char *const wavelengths_um = request->optical == OPTICAL_RGB   ? "R 0.6-0.7, G 0.5-0.6, B 0.4-0.5"
                                       : request->optical == OPTICAL_NIR ? channel_in(SPECTRAL_NIR)->edges_um
                                                                         : channel_in(SPECTRAL_PAN)->edges_um;
    int               count = 0;
    for (int k = 0; k < plane_row_count; k++) {
        const PlaneRow *row = &plane_rows[k];
        const void     *values = plane_values(row, p);
        if (!values || !plane_of_bands(row, request->bands, request->optical)) continue;
        FrameArray *a = &plane[count++];
        *a = (FrameArray){.group = plane_group(row),
                          .name = row->name,
                          .unit = row->unit,
                          .kind = row->kind,
                          .type = row->type,
                          .axes = 2,
                          .axis = {"row", "column"},
                          .size = {p->height, p->width},
                          .values = values};
        if (plane_band(row) == BAND_RADAR) a->model = "pseudo-radar";
        if (plane_band(row) == BAND_OPTICAL) a->wavelengths_um = wavelengths_um;
        if (row->kind != PLANE_PROFILE) continue;
        a->axis[0] = "bin", a->axis[1] = "bounce";
        a->size[0] = request->profile_bins, a->size[1] = radar_bounces;
    }
    return count;
}

Plane frame_plane(char name[frame_plane_name_size], const FrameArray *p)
{
    int rows = 1;
    for (int k = 0; k + 1 < p->axes; k++) rows *= p->size[k];
    snprintf(name, frame_plane_name_size, "%s/%s", p->group, p->name);
    return (Plane){name, p->type, p->axes > 0 ? p->size[p->axes - 1] : 1, rows, p->values};
}

Status frame_sha256(FrameView *view)
{
    Plane plane[frame_max_planes];
    char  name[frame_max_planes][frame_plane_name_size];
    if (*view->sha256) return STATUS_OK;
    for (int i = 0; i < view->plane_count; i++) plane[i] = frame_plane(name[i], &view->plane[i]);
    return plane_hash(view->sha256, plane, view->plane_count);
}
