/* render/frame/target_grid_picture.c: composites the sampled small targets over the finished pixels, estimates their
 * errors and adds them to the targets of the picture. */
#include "render/frame/frame_private.h"
#include "render/frame/render.h"

void target_grids_cover(Job *job)
{
    for (int n = 0; n < job->footprints; n++) {
        const TargetGrid *f = &job->footprint[n];
        for (int y = f->y0, k = 0; y < f->y1; y++)
            for (int x = f->x0; x < f->x1; x++, k++) {
                const size_t px = pixel_index(job, x, y);
                if (!(f->area[k] > 0)) continue;
                job->before[px] += (float)f->before[k];
                /* float sums, in a fixed order; two targets that overlap share the pixel, and their own samples
                 * resolve which is in front */
                job->picture->covered[px] = fminf(job->picture->covered[px] + (float)f->area[k], 1);
                if (f->area[k] > 0.5 * job->picture->covered[px]) job->coverer[px] = f->entity;
            }
    }
}

/* ---- errors ----------------------------------------------------------------------------------- */

/* Squared differences of neighbouring cells: as the picture shows them, beside the pixels behind them, and of the
 * target's own radiance. */
static void cell_pairs(double sums[2], const TargetGrid *f, const Job *job, int plane)
{
    const float *value = picture_plane(job->picture, plane);
    const int    beside[2] = {1, f->columns};
    sums[0] = sums[1] = 0;
    for (int cell = 0; cell < f->columns * f->rows; cell++)
        for (int k = 0; k < 2; k++) {
            if (k == 0 ? cell % f->columns == f->columns - 1 : cell / f->columns == f->rows - 1) continue;
            const int other = cell + beside[k], here = f->met[cell] ? cell : other;
            if (!f->met[cell] && !f->met[other]) continue;
            double own = f->cell[plane][here], shown = own;
            if (f->met[cell] && f->met[other]) {
                shown = own -= f->cell[plane][other];
            } else {
                const int column = (int)(f->box[0] + (here % f->columns + 0.5) * (f->box[2] - f->box[0]) / f->columns);
                const int row = (int)(f->box[1] + (here / f->columns + 0.5) * (f->box[3] - f->box[1]) / f->rows);
                if (column >= f->x0 && column < f->x1 && row >= f->y0 && row < f->y1)
                    shown -= (double)value[pixel_index(job, column, row)];
            }
            sums[0] += shown * shown;
            sums[1] += own * own;
        }
}

/* Share of a pixel that its own samples stand for: what small targets, and what hides them, leave. */
static double own_share(const Job *job, size_t px)
{
    return fmax(0, 1 - (double)job->picture->covered[px] - (double)job->before[px]);
}

/* Beside a target's silhouette the pixel's mean is used: its error is the pixel's own share times the rest, times the
 * variation of the ground there, for which the difference of the neighbours is taken. */
static double hidden_ground(const TargetGrid *f, const Job *job, const float *value)
{
    double sum = 0;
    for (int y = f->y0; y < f->y1; y++)
        for (int x = f->x0; x < f->x1; x++) {
            const size_t px = pixel_index(job, x, y);
            const double own = own_share(job, px), share = own * (1 - own);
            if (job->coverer[px] == f->entity && share > 0)
                sum += share * share * picture_contrast(job->picture, value, x, y);
        }
    return sum;
}

void target_grids_error(Job *job)
{
    for (int n = 0; n < job->footprints; n++) {
        const TargetGrid *f = &job->footprint[n];
        const int         cells = f->columns * f->rows;
        if (cells == 0) continue;
        const double cell_px = (f->box[2] - f->box[0]) * (f->box[3] - f->box[1]) / cells;
        for (int plane = 0; plane < picture_plane_count; plane++) {
            double sums[2];
            if (!f->cell[plane]) continue;
            cell_pairs(sums, f, job, plane);
            job->target_variance[plane] += mean_variance_factor * cell_px * cell_px * sums[0] +
                                           hidden_ground(f, job, picture_plane(job->picture, plane));
            if (job->picture->target)
                job->picture->target[f->entity].radiance_error[plane] = cell_px * sqrt(mean_variance_factor * sums[1]);
        }
    }
}

static void put_truth_on(const Job *job, const TargetGrid *f, int k, size_t px)
{
    Picture               *picture = job->picture;
    const TargetGridTruth *t = &f->truth[k];
    if (!(f->area[k] > 0.5)) return;
    picture->entity[px] = (uint32_t)f->entity + 1;
    picture->range_m[px] = t->range_m;
    picture->part[px] = t->part;
    picture->material[px] = t->material;
    picture->cover[px] = SURFACE_NONE;
    if (picture->instance) picture->instance[px] = 0;
    picture->temp_k[px] = t->temp_k;
    for (int a = 0; a < 3; a++) picture->normal[a][px] = t->normal[a];
}

/* The cells and the light of their pixels beside them, before the targets' own is added. */
static void hand_over(const Job *job, TargetGrid *f)
{
    SmallTargets *small = &job->picture->small;
    if (!(f->visible > 0)) return;
    SmallTarget *t = &small->target[small->count++];
    *t = (SmallTarget){.columns = f->columns,
                       .rows = f->rows,
                       .x0 = f->x0,
                       .y0 = f->y0,
                       .x1 = f->x1,
                       .y1 = f->y1,
                       .met = f->met,
                       .area = f->area};
    memcpy(t->box_px, f->box, sizeof t->box_px);
    for (int plane = 0; plane < picture_plane_count; plane++) {
        const float *value = picture_plane(job->picture, plane);
        if (!f->behind[plane]) continue;
        for (int y = f->y0, k = 0; y < f->y1; y++)
            for (int x = f->x0; x < f->x1; x++, k++) {
                const size_t px = pixel_index(job, x, y);
                const float  open = 1 - job->picture->covered[px];
                f->behind[plane][k] = open > 0 ? value[px] / open : 0;
            }
        t->cell[plane] = f->cell[plane];
        t->behind[plane] = f->behind[plane];
    }
}

/* Factor of the light of what hides small targets: targets that overlap may be hidden by the same leaf. */
static double before_share(const Job *job, size_t px)
{
    const double open = 1 - (double)job->picture->covered[px], before = (double)job->before[px];
    return before > open ? open / before : 1;
}

/* A pixel's own mean, scaled to its share, and the light of what hides small targets there. */
static void put_beside(const Job *job, const TargetGrid *f, int k, size_t px, bool own)
{
    const double share = before_share(job, px);
    for (int plane = 0; plane < picture_plane_count; plane++) {
        float *value = picture_plane(job->picture, plane);
        if (!value) continue;
        if (!own) value[px] += (float)(share * f->before_sum[plane][k]);
        else if (job->coverer[px] == f->entity) value[px] *= (float)own_share(job, px);
    }
}

static void put_target(const Job *job, const TargetGrid *f, int k, size_t px)
{
    for (int plane = 0; plane < picture_plane_count; plane++) {
        float *value = picture_plane(job->picture, plane);
        if (value) value[px] += (float)f->sum[plane][k];
    }
    if (f->truth) put_truth_on(job, f, k, px);
}

static void record_part(const Job *job, const TargetGrid *f, size_t px, PixelStepKind step)
{
    if (step == PIXEL_TARGET) record_composite(job, step, f->entity, 1);
    else if (step == PIXEL_BEFORE) record_composite(job, step, f->entity, before_share(job, px));
    else if (job->coverer[px] == f->entity) record_composite(job, step, f->entity, own_share(job, px));
}

void target_grids_composite(Job *job)
{
    /* a pixel may hold parts of several targets */
    for (PixelStepKind step = PIXEL_BESIDE; step <= PIXEL_TARGET; step++) {
        for (int n = 0; n < job->footprints && step == PIXEL_TARGET && job->request->hand_over_cells; n++)
            hand_over(job, &job->footprint[n]);
        for (int n = 0; n < job->footprints; n++) {
            const TargetGrid *f = &job->footprint[n];
            for (int y = f->y0, k = 0; y < f->y1; y++)
                for (int x = f->x0; x < f->x1; x++, k++) {
                    const size_t px = pixel_index(job, x, y);
                    if (!(f->area[k] > 0)) continue;
                    if (record_in_box(job, x, y, x + 1, y + 1)) record_part(job, f, px, step);
                    if (step == PIXEL_TARGET) put_target(job, f, k, px);
                    else put_beside(job, f, k, px, step == PIXEL_BESIDE);
                }
        }
    }
}

static void gather_one(TargetPixels *target, const Job *job, const TargetGrid *f)
{
    target->small = true;
    target->visible = f->visible;
    target->amodal = f->amodal;
    target->occluded_ground = f->hidden_ground;
    target->occluded_entity = f->hidden_entity;
    target->occluded_plants = f->hidden_plants;
    target->occluded_scenery = f->hidden_scenery;
    for (int b = 0; b < BAND_COUNT; b++) target->veiled[b] = f->visible > 0 ? f->veiled[b] / f->visible : 0;
    memcpy(target->amodal_box, f->amodal_box, sizeof f->amodal_box);
    for (int y = f->y0, k = 0; y < f->y1; y++)
        for (int x = f->x0; x < f->x1; x++, k++) {
            if (!(f->area[k] > 0)) continue;
            grow_pixel_box(target->box, x, y);
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

void target_grids_sample(const Job *job)
{
    for (int n = 0; n < job->footprints; n++)
        gather_one(&job->picture->target[job->footprint[n].entity], job, &job->footprint[n]);
}
