/* sensor/frame/frame.c: the pool of frames, and the planes of a frame by name. */
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

/* ---- the planes of an image: the one list of the fields of a Picture for all code that works on planes  */

typedef struct PlaneList {
    FrameArray *plane;
    int         count, width, height;
} PlaneList;

static void add(PlaneList *list, const char *group, PlaneKind kind, const char *name, const char *unit, PlaneType type,
                const void *values)
{
    if (values)
        list->plane[list->count++] = (FrameArray){.group = group,
                                                  .name = name,
                                                  .unit = unit,
                                                  .kind = kind,
                                                  .type = type,
                                                  .axes = 2,
                                                  .axis = {"row", "column"},
                                                  .size = {list->height, list->width},
                                                  .values = values};
}

int frame_planes(FrameArray plane[frame_max_planes], const Picture *p, const RenderRequest *request)
{
    static const char *const rgb[3] = {"R", "G", "B"}, *const normal[3] = {"nx", "ny", "nz"};
    static const char *const truth = "truth", *const radiance = "W/(m2 sr)", *const relative = "relative";
    static const char *const radar_model = "pseudo-radar";
    const char *const        wavelengths_um = request->optical == OPTICAL_RGB   ? "R 0.6-0.7, G 0.5-0.6, B 0.4-0.5"
                                              : request->optical == OPTICAL_NIR ? channel_in(SPECTRAL_NIR)->edges_um
                                                                                : channel_in(SPECTRAL_PAN)->edges_um;
    PlaneList                list = {plane, 0, p->width, p->height};
    for (int k = 0; k < picture_plane_count; k++) {
        const Band band = k < picture_mwir ? BAND_OPTICAL : (Band)(BAND_OPTICAL + 1 + k - picture_mwir);
        if (!(request->bands >> band & 1)) continue;
        add(&list, band_name(band), PLANE_RADIANCE, k < picture_mwir && p->optical[1] ? rgb[k] : "Y",
            band == BAND_RADAR ? relative : radiance, PLANE_F32, picture_plane(p, k));
        if (list.count == 0) continue;
        FrameArray *added = &plane[list.count - 1];
        if (band == BAND_OPTICAL) added->wavelengths_um = wavelengths_um;
        if (band == BAND_RADAR) added->model = radar_model;
    }
    add(&list, truth, PLANE_TRUTH, "range_m", "m", PLANE_F32, p->range_m);
    add(&list, truth, PLANE_TRUTH, "entity", "", PLANE_U32, p->entity);
    add(&list, truth, PLANE_TRUTH, "part", "", PLANE_U32, p->part);
    add(&list, truth, PLANE_TRUTH, "material", "", PLANE_U32, p->material);
    if (p->instance) { /* a world without plants has neither */
        add(&list, truth, PLANE_TRUTH, "instance", "", PLANE_U32, p->instance);
        add(&list, truth, PLANE_TRUTH, "cover", "", PLANE_U8, p->cover);
    }
    add(&list, truth, PLANE_TRUTH, "temp_k", "K", PLANE_F32, p->temp_k);
    for (int k = 0; k < 3; k++) add(&list, truth, PLANE_TRUTH, normal[k], "", PLANE_F32, p->normal[k]);
    if (p->profile)
        plane[list.count++] = (FrameArray){.group = band_name(BAND_RADAR),
                                           .name = "profile",
                                           .unit = relative,
                                           .model = radar_model,
                                           .kind = PLANE_PROFILE,
                                           .type = PLANE_F64,
                                           .axes = 2,
                                           .axis = {"bin", "bounce"},
                                           .size = {request->profile_bins, radar_bounces},
                                           .values = p->profile};
    return list.count;
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
