/* render/frame/sampling.c: which pixels get rays of their own (RenderRequest.sampling), and what the others show: the
 * mean of those beside them that have and show the same kind of surface. Whatever an entity or smoke may touch is
 * whole: every pixel has its rays; and so has a pixel between sky and what is not, or across a step in depth of the
 * ground. */
#include "render/frame/frame_private.h"

/* Pixels about an entity's box that are whole: plants that hide parts of it are refined within three (edges.c). */
static const double about_px = 4;
/* Ranges of ground beside ground that differ by more than this factor are a crest before what lies behind it. */
static const float crest = 1.5F;

static void mark_whole(Job *job, const double box[4])
{
    const View *view = &job->request->view;
    const int   x0 = (int)clamp(floor(box[0] - about_px), 0, view->width);
    const int   x1 = (int)clamp(ceil(box[2] + about_px), 0, view->width);
    const int   y0 = (int)clamp(floor(box[1] - about_px), 0, view->height);
    const int   y1 = (int)clamp(ceil(box[3] + about_px), 0, view->height);
    for (int y = y0; y < y1; y++)
        if (x1 > x0) memset(&job->whole[pixel_index(job, x0, y)], 1, (size_t)(x1 - x0));
}

/* Whether an entity without a box may be seen: part of it is behind the eye, and part in front. */
static bool about_the_eye(const Job *job, int index)
{
    const SnapshotEntity *entity = &job->scene.snapshot->entity[index];
    const View           *view = &job->request->view;
    double                p_enu[3], offset_enu[3];
    if (job->boxes[index].projected || index == job->request->hidden_entity || entity->model < 0) return false;
    enu_from_ecef(p_enu, &job->scene.world->frame, entity->p_ecef);
    v3_sub(offset_enu, p_enu, view->p_enu);
    return v3_length(offset_enu) < 2 * catalog_model(job->scene.world->catalog, entity->model)->radius_m;
}

void sampling_mark(Job *job)
{
    const View *view = &job->request->view;
    if (!job->whole) return;
    for (int i = 0; i < job->scene.snapshot->count; i++) {
        if (job->boxes[i].projected) mark_whole(job, job->boxes[i].projected_box);
        else if (about_the_eye(job, i)) mark_whole(job, (const double[4]){0, 0, view->width, view->height});
    }
    const size_t px = (size_t)view->width * (size_t)view->height;
    for (size_t k = 0; job->refine && k < px; k++) job->whole[k] |= job->refine[k] != 0; /* shadows of small targets */
}

/* Whether a ray passes by a ball about a volume, with a margin for roundings: a test that saves most exact ones. */
static bool passes_ball(const SmokeVolume *v, const double o_enu[3], const double d_enu[3])
{
    const double reach_m = v->along_m > v->across_m ? v->along_m : v->across_m;
    double       off[3];
    v3_sub(off, v->p_enu, o_enu);
    const double along = v3_dot(off, d_enu), square = v3_dot(off, off);
    return square - along * along > reach_m * reach_m * 1.001 + 1e-9 * square;
}

/* Whether a ray of a pixel meets some of the listed volumes. */
static bool meets_smoke(const Job *job, const int *list, int count, int x, int y)
{
    const View *view = &job->request->view;
    const int   n = job->request->samples;
    for (int s = 0; s < n * n; s++) {
        double place[2], d_enu[3];
        sample_place(place, n, s);
        view_ray(d_enu, view, x + place[0], y + place[1]);
        for (int k = 0; k < count; k++) {
            const SmokeVolume *v = &job->scene.effects.volume[list[k]];
            if (passes_ball(v, view->p_enu, d_enu)) continue;
            if (smoke_column_m(v, view->p_enu, d_enu, 0, INFINITY) > 0) return true;
        }
    }
    return false;
}

void sampling_mark_smoke(Worker *w, Job *job, const Tile *tile)
{
    const EffectScene *effects = &job->scene.effects;
    if (effects->count == 0) return;
    const int count = smoke_cull_block(w->volume, effects->volume, effects->count, &job->request->view, tile->x0,
                                       tile->y0, tile->x1, tile->y1);
    for (int y = tile->y0; count > 0 && y < tile->y1; y++)
        for (int x = tile->x0; x < tile->x1; x++) {
            const size_t px = pixel_index(job, x, y);
            if (!job->whole[px]) job->whole[px] = meets_smoke(job, w->volume, count, x, y);
        }
}

bool sampling_traces(const Job *job, int x, int y)
{
    if (!job->whole || job->whole[pixel_index(job, x, y)]) return true;
    return job->request->sampling == SAMPLING_CHECKERBOARD ? !((x + y) & 1) : !(x & 1 || y & 1);
}

/* ---- pixels without rays ------------------------------------------------------------------------- */

/* Pixels beside one without rays that have some: places in the planes. There is one at least. */
static int find_donors(size_t donor[4], const Job *job, int x, int y)
{
    static const int beside[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}},
                     about[4][2] = {{-1, -1}, {1, -1}, {-1, 1}, {1, 1}};
    const View *view = &job->request->view;
    /* of a quarter, a pixel in an odd row and column has its four at its corners */
    const bool corners = job->request->sampling == SAMPLING_QUARTER && x & 1 && y & 1;
    int        count = 0;
    for (int k = 0; k < 4; k++) {
        const int xd = x + (corners ? about : beside)[k][0], yd = y + (corners ? about : beside)[k][1];
        if (xd < 0 || yd < 0 || xd >= view->width || yd >= view->height || !sampling_traces(job, xd, yd)) continue;
        donor[count++] = pixel_index(job, xd, yd);
    }
    return count;
}

/* Whether no mean of these stands for what lies between them: a horizon, the outline of a crown on the sky, a crest.
 * Plants before plants or ground are another matter: they vary from pixel to pixel, and the mean is the best guess. So
 * it is of two classes of ground: a class that most of them have has no smaller error (pitviper bench precision). */
static bool lie_apart(const Picture *p, const size_t donor[4], int donors)
{
    float near_m = INFINITY, far_m = 0;
    bool  plants = false;
    for (int k = 0; k < donors; k++) {
        const float range_m = p->range_m[donor[k]];
        near_m = range_m < near_m ? range_m : near_m;
        far_m = range_m > far_m ? range_m : far_m;
        plants |= picture_shows_plant(p, donor[k]);
    }
    if (!(far_m < INFINITY)) return near_m < INFINITY;
    return !plants && far_m > crest * near_m;
}

/* Whether a pixel without rays has a whole checkerboard about it, and no plant beside it. */
static bool has_grain(const Job *job, const size_t donor[4], int donors, int x, int y)
{
    const View *view = &job->request->view;
    if (job->request->sampling != SAMPLING_CHECKERBOARD || x < 2 || y < 2 || x + 2 >= view->width ||
        y + 2 >= view->height)
        return false;
    for (int k = 0; k < donors; k++)
        if (picture_shows_plant(job->picture, donor[k])) return false;
    return true;
}

/* Value between the pixels of a checkerboard, more along the direction in which it changes less: ground seen at a
 * flat angle lies in rows, and in the plain mean of four a line of one row is dots. width: of the plane. */
static float along_grain(const float *v, int width)
{
    const int   w = width;
    const float across = fabsf(v[-1] - v[1]) + 0.5F * (fabsf(v[-w - 2] - v[-w]) + fabsf(v[-w] - v[-w + 2]) +
                                                       fabsf(v[w - 2] - v[w]) + fabsf(v[w] - v[w + 2]));
    const float down = fabsf(v[-w] - v[w]) + 0.5F * (fabsf(v[-2 * w - 1] - v[-1]) + fabsf(v[-1] - v[2 * w - 1]) +
                                                     fabsf(v[-2 * w + 1] - v[1]) + fabsf(v[1] - v[2 * w + 1]));
    const float both = across * across + down * down, share = both > 0 ? down * down / both : 0.5F;
    return 0.5F * (share * (v[-1] + v[1]) + (1 - share) * (v[-w] + v[w]));
}

bool sampling_fills(const Job *job, int x, int y)
{
    size_t donor[4];
    return !sampling_traces(job, x, y) && !lie_apart(job->picture, donor, find_donors(donor, job, x, y));
}

/* Truth is that of one of them: there is no mean of two surfaces. */
static void copy_truth(const Job *job, size_t to, size_t from)
{
    const Picture *p = job->picture;
    p->range_m[to] = p->range_m[from];
    p->entity[to] = p->entity[from];
    p->part[to] = p->part[from];
    p->material[to] = p->material[from];
    p->cover[to] = p->cover[from];
    if (p->instance) p->instance[to] = p->instance[from];
    p->temp_k[to] = p->temp_k[from];
    for (int c = 0; c < 3; c++) p->normal[c][to] = p->normal[c][from];
    if (job->sun) job->sun[to] = job->sun[from];
}

static float mean_of(const float *plane, const size_t donor[4], int donors)
{
    float sum = 0;
    for (int n = 0; n < donors; n++) sum += plane[donor[n]];
    return sum / (float)donors;
}

void sampling_fill_tile(void *user, int worker, int task)
{
    const Job *job = user;
    Worker    *w = job->worker[worker];
    const Tile tile = tile_of(job, task);
    size_t     donor[4];
    float     *plane[picture_plane_count];
    int        planes = 0;
    for (int k = 0; k < picture_plane_count; k++)
        if (picture_plane(job->picture, k)) plane[planes++] = picture_plane(job->picture, k);
    w->block.pixels = w->block.columns = 0;
    for (int y = tile.y0; y < tile.y1; y++)
        for (int x = tile.x0; x < tile.x1; x++) {
            if (sampling_traces(job, x, y)) continue;
            const int    donors = find_donors(donor, job, x, y);
            const size_t px = pixel_index(job, x, y);
            if (lie_apart(job->picture, donor, donors)) {
                pixels_add(&w->block, x, y);
                continue;
            }
            if (has_grain(job, donor, donors, x, y)) {
                for (int k = 0; k < planes; k++) plane[k][px] = along_grain(plane[k] + px, job->picture->width);
            } else {
                for (int k = 0; k < planes; k++) plane[k][px] = mean_of(plane[k], donor, donors);
            }
            copy_truth(job, px, donor[0]);
        }
    base_others(w, job, &tile);
}
