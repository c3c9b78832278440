/* render/frame/sampling.c: which pixels get rays of their own (RenderRequest.sampling), and what the others show: the
 * mean of those beside them that have. Whatever an entity may touch is whole: every pixel has its rays. */
#include "render/frame/frame_private.h"

/* Pixels about an entity's box that are whole: plants that hide parts of it are refined within three (edges.c). */
static const double about_px = 4;

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

bool sampling_traces(const Job *job, int x, int y)
{
    if (!job->whole || job->whole[pixel_index(job, x, y)]) return true;
    return job->request->sampling == SAMPLING_CHECKERBOARD ? !((x + y) & 1) : !(x & 1 || y & 1);
}

/* Pixels beside one without rays that have some: places in the planes. */
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

void sampling_fill_tile(void *user, int worker, int task)
{
    const Job *job = user;
    const Tile tile = tile_of(job, task);
    size_t     donor[4];
    (void)worker;
    for (int y = tile.y0; y < tile.y1; y++)
        for (int x = tile.x0; x < tile.x1; x++) {
            if (sampling_traces(job, x, y)) continue;
            const int    donors = find_donors(donor, job, x, y);
            const size_t px = pixel_index(job, x, y);
            for (int plane = 0; plane < picture_plane_count; plane++) {
                float *value = picture_plane(job->picture, plane), sum = 0;
                for (int k = 0; value && k < donors; k++) sum += value[donor[k]];
                if (value && donors > 0) value[px] = sum / (float)donors;
            }
            if (job->picture->entity && donors > 0) copy_truth(job, px, donor[0]);
        }
}
