/* render/footprint.c: targets that are small on the image, sampled over their own boxes.
 *
 * A target of a few pixels, or of a hundredth of one, falls between the samples of the pixels or does not, and
 * flickers. Here its box on the image is divided into cells, always so many across the target whatever its size, and
 * each is sampled once. The pattern moves with the target, not with the pixels: what it adds up to does not change as
 * the target crosses them. A cell's result goes to the pixels it lies over by their shares of its area, exactly, so
 * that the sum over pixels is that over the target. The pixels' own samples do not see small targets; in the end a
 * pixel is its own value times what the footprints leave of it, plus the footprints.
 *
 * Behind a target the pixel's mean stands for what the target hides: right where the ground is even over a pixel. */
#include "render/footprint_private.h"

/* Below this both ways (or this one way and four times as much the other) the footprint is the better of the two: edge
 * samples, 1 / 16 px apart along an axis, are wrong by up to 1 / 16 px of width, 0.4 % of 16 px. */
static const double small_px = 16;

/* ---- planning ------------------------------------------------------------------------------- */

static bool is_small(const TargetPixels *t)
{
    const double w = t->projected_box[2] - t->projected_box[0], h = t->projected_box[3] - t->projected_box[1];
    return t->projected && fmin(w, h) < small_px && fmax(w, h) < 4 * small_px;
}

static int in_twos(double cells) { return footprint_coarse * (int)ceil(cells / footprint_coarse); }

static Status plan_one(Footprint *f, const Job *job, int index, Arena *arena)
{
    const View *view = &job->request->view;
    f->entity = index;
    memcpy(f->box, job->boxes[index].projected_box, sizeof f->box);
    const double w = f->box[2] - f->box[0], h = f->box[3] - f->box[1];
    /* never fewer than the edges of larger targets get */
    const int per_px = looks_for_edges(job->request) ? job->request->edge_samples : job->request->samples;
    if (w > 0 && h > 0) {
        f->columns = in_twos(fmax(job->request->target_samples, ceil(w) * per_px));
        f->rows    = in_twos(fmax(job->request->target_samples, ceil(h) * per_px));
    }
    f->x0 = (int)fmax(0, floor(f->box[0])), f->x1 = (int)fmin(view->width, ceil(f->box[2]));
    f->y0 = (int)fmax(0, floor(f->box[1])), f->y1 = (int)fmin(view->height, ceil(f->box[3]));
    const size_t pixels = (size_t)(f->x1 - f->x0) * (size_t)(f->y1 - f->y0);
    bool         ok = (f->area = arena_alloc(arena, pixels, sizeof(double))) != NULL;
    for (int k = 0; k < picture_plane_count; k++)
        if (picture_plane(job->picture, k)) ok = (f->sum[k] = arena_alloc(arena, pixels, sizeof(double))) && ok;
    if (job->picture->entity) {
        ok = (f->truth = arena_alloc(arena, pixels, sizeof *f->truth)) && ok;
        for (size_t i = 0; ok && i < pixels; i++) f->truth[i].square_px = INFINITY;
    }
    if (job->picture->target)
        ok = (f->hidden_by = arena_alloc(arena, (size_t)job->snapshot->count, sizeof(double))) && ok;
    return ok ? STATUS_OK : STATUS_NO_MEMORY;
}

Status footprints_plan(Job *job, Arena *arena)
{
    const size_t px = (size_t)job->picture->width * (size_t)job->picture->height;
    int          count = 0;
    for (int i = 0; i < job->snapshot->count; i++) count += job->is_small[i] = is_small(&job->boxes[i]);
    if (count == 0) return STATUS_OK;
    job->footprint = arena_alloc(arena, (size_t)count, sizeof *job->footprint);
    job->picture->covered   = arena_alloc(arena, px, sizeof *job->picture->covered);
    job->coverer   = arena_alloc(arena, px, sizeof *job->coverer);
    job->footprint_turn = arena_alloc(arena, (size_t)count, sizeof *job->footprint_turn);
    if (!job->footprint || !job->footprint_turn || !job->picture->covered || !job->coverer) return STATUS_NO_MEMORY;
    Status status = STATUS_OK;
    for (int i = 0; i < job->snapshot->count && status == STATUS_OK; i++)
        if (job->is_small[i]) status = plan_one(&job->footprint[job->footprints++], job, i, arena);
    /* the largest first, so that no worker is left with one when the others are done */
    for (int n = 0; n < job->footprints; n++) {
        const Footprint *f = &job->footprint[n];
        int              at = n;
        for (; at > 0; at--) {
            const Footprint *before = &job->footprint[job->footprint_turn[at - 1]];
            if (before->columns * before->rows >= f->columns * f->rows) break;
            job->footprint_turn[at] = job->footprint_turn[at - 1];
        }
        job->footprint_turn[at] = n;
    }
    return status;
}

/* ---- into the picture ----------------------------------------------------------------------- */

void footprint_box(double box_px[4], const Footprint *f) { memcpy(box_px, f->box, sizeof f->box); }

void footprint_grow_box(void *user, const Footprint *f, int pixel, int x, int y, double area)
{
    (void)f, (void)pixel, (void)area;
    int *box = user;
    box[0] = box[2] == 0 || x < box[0] ? x : box[0];
    box[1] = box[3] == 0 || y < box[1] ? y : box[1];
    box[2] = x + 1 > box[2] ? x + 1 : box[2];
    box[3] = y + 1 > box[3] ? y + 1 : box[3];
}

void footprints_cover(Job *job)
{
    for (int n = 0; n < job->footprints; n++) {
        const Footprint *f = &job->footprint[n];
        for (int y = f->y0, k = 0; y < f->y1; y++)
            for (int x = f->x0; x < f->x1; x++, k++) {
                const size_t px = pixel_index(job, x, y);
                if (!(f->area[k] > 0)) continue;
                /* float sums, one order; two that overlap share the pixel, and their own samples saw to it */
                job->picture->covered[px] = fminf(job->picture->covered[px] + (float)f->area[k], 1);
                if (f->area[k] > 0.5 * job->picture->covered[px]) job->coverer[px] = f->entity;
            }
    }
}

static void put_truth_on(const Job *job, const Footprint *f, int k, size_t px)
{
    Picture              *picture = job->picture;
    const FootprintTruth *t = &f->truth[k];
    if (!(f->area[k] > 0.5)) return;
    picture->entity[px]   = (uint32_t)f->entity + 1;
    picture->range_m[px]  = t->range_m;
    picture->part[px]     = t->part;
    picture->material[px] = t->material;
    picture->temp_k[px]   = t->temp_k;
    for (int a = 0; a < 3; a++) picture->normal[a][px] = t->normal[a];
}

void footprints_put_on(Job *job)
{
    /* first all that they hide, then all that they show: a pixel may hold parts of several */
    for (int show = 0; show < 2; show++)
        for (int n = 0; n < job->footprints; n++) {
            const Footprint *f = &job->footprint[n];
            for (int y = f->y0, k = 0; y < f->y1; y++)
                for (int x = f->x0; x < f->x1; x++, k++) {
                    const size_t px = pixel_index(job, x, y);
                    if (!(f->area[k] > 0)) continue;
                    for (int plane = 0; plane < picture_plane_count; plane++) {
                        float *value = picture_plane(job->picture, plane);
                        if (!value) continue;
                        if (show) value[px] += (float)f->sum[plane][k];
                        else if (job->coverer[px] == f->entity) value[px] *= 1 - job->picture->covered[px];
                    }
                    if (show && f->truth) put_truth_on(job, f, k, px);
                }
        }
}

static void gather_one(TargetPixels *target, const Job *job, const Footprint *f)
{
    target->small           = true;
    target->visible         = f->visible;
    target->amodal          = f->amodal;
    target->occluded_ground = f->hidden_ground;
    target->occluded_entity = f->hidden_entity;
    for (int b = 0; b < BAND_COUNT; b++) target->veiled[b] = f->visible > 0 ? f->veiled[b] / f->visible : 0;
    memcpy(target->amodal_box, f->amodal_box, sizeof f->amodal_box);
    double most = 0;
    for (int i = 0; i < job->snapshot->count; i++)
        if (f->hidden_by[i] > most) most = f->hidden_by[i], target->occluder = i;
    for (int y = f->y0, k = 0; y < f->y1; y++)
        for (int x = f->x0; x < f->x1; x++, k++) {
            if (!(f->area[k] > 0)) continue;
            footprint_grow_box(target->box, f, k, x, y, f->area[k]);
            target->peak_area = fmax(target->peak_area, f->area[k]);
            for (int plane = 0; plane < picture_plane_count; plane++) {
                if (!f->sum[plane]) continue;
                target->radiance[plane] += f->sum[plane][k] * pixel_cosine3(&job->request->view, x, y);
                target->mean[plane] += f->sum[plane][k];
            }
        }
    for (int plane = 0; plane < picture_plane_count && f->visible > 0; plane++) {
        target->mean[plane] /= f->visible;
        target->variance[plane] = fmax(0, f->square[plane] / f->visible - target->mean[plane] * target->mean[plane]);
    }
}

void footprints_gather(const Job *job)
{
    for (int n = 0; n < job->footprints; n++)
        gather_one(&job->picture->target[job->footprint[n].entity], job, &job->footprint[n]);
}
