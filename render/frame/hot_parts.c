/* render/frame/hot_parts.c: marks the pixels on hot parts of clutter, which get more rays than others.
 *
 * An exhaust pipe of a decimetre is narrower than a pixel from 300 m on, and in 3.4 .. 4.8 um it outshines all else of
 * its thing by a factor of 100. One ray a pixel misses it most times, and where it meets it the whole pixel is as hot:
 * things would be dark or shine by chance, where a target's exhaust is always found (target_grid.c). So the pixels of
 * the boxes about such parts are sampled hot_samples a side, those of the nearest things first, as far as the rays of a
 * frame go. */
#include "render/frame/frame_private.h"
#include "render/trace/parts/parts.h"

#include <stdlib.h>

static const double stands_s = 1800; /* an exhaust of 4 mm steel is near the air's temperature by then */
static const double wide_px = 8;     /* a part wider than this is met by samples, and its edges are found */
enum { rays_share = 2 };             /* at most half as many of these rays as the picture has pixels */

/* A thing with hot parts that may be seen. */
typedef struct HotThing {
    double range_m;
    int    object;
} HotThing;

/* Whether a part of a model is hot in this state. */
static bool is_hot(const SceneryState *state, const ModelPart *part)
{
    if (state->drives.burning > 0) return true; /* flames, embers, and the drum or heap about them */
    return state->drives.engine > 0 && part->role == HEAT_EXHAUST;
}

static bool has_hot_parts(const Scenery *s, int object)
{
    const SceneryObject *o = &s->object[object];
    if (o->kind != SCENERY_CLUTTER || o->state < 0 || o->model < 0) return false;
    const SceneryState *state = &s->state[o->state];
    return state->drives.burning > 0 || (state->drives.engine > 0 && state->stood_s < stands_s);
}

static int by_range(const void *pa, const void *pb)
{
    const HotThing *a = pa, *b = pb;
    if (a->range_m != b->range_m) return a->range_m < b->range_m ? -1 : 1;
    return (a->object > b->object) - (a->object < b->object);
}

/* Whether a thing's sphere may be on the image, and the range of its middle. */
static bool in_view(double *range_m, const View *view, const PosedEntity *posed)
{
    double offset_enu[3], p_cam[3], at_px[2];
    v3_sub(offset_enu, posed->centre_enu, view->p_enu);
    m3_tmul_v3(p_cam, view->r_enu_from_cam, offset_enu);
    *range_m = v3_length(offset_enu);
    if (!(p_cam[2] > 2 * posed->radius_m)) return false;
    view_project(at_px, view, p_cam);
    const double reach_px = 2 * view->focal_px * posed->radius_m / p_cam[2] + 2;
    return at_px[0] > -reach_px && at_px[1] > -reach_px && at_px[0] < view->width + reach_px &&
           at_px[1] < view->height + reach_px;
}

/* Grows a box on the image by a part's corners; false: some of it is behind the eye. */
static bool grow_by_part(double box[4], const Job *job, const Model *model, int part, const PosedNode *node,
                         double lift_m)
{
    const View *view = &job->request->view;
    const int   first = model->part[part].first_triangle, end = first + model->part[part].triangle_count;
    for (int t = first; t < end; t++)
        for (int c = 0; c < 3; c++) {
            double p_enu[3], p_cam[3], at_px[2];
            m3_mul_v3(p_enu, node->r_enu_from_node, model->vertex[model->triangle[t][c]]);
            v3_add(p_enu, p_enu, node->p_enu);
            v3_sub(p_enu, p_enu, view->p_enu);
            p_enu[2] += lift_m;
            m3_tmul_v3(p_cam, view->r_enu_from_cam, p_enu);
            if (!(p_cam[2] > 0)) return false;
            view_project(at_px, view, p_cam);
            for (int k = 0; k < 2; k++) {
                box[k] = fmin(box[k], at_px[k]);
                box[k + 2] = fmax(box[k + 2], at_px[k]);
            }
        }
    return true;
}

/* The box of a thing's hot parts on the image; false: they are wide, elsewhere, or not all in front of the eye. */
static bool box_of(double box[4], const Job *job, const SceneryFrame *frame, int object, Arena *arena)
{
    const Scenery     *s = scenery_frame_of(frame);
    const PosedEntity *posed = scenery_frame_posed(frame, object);
    const Model       *model = &s->model[s->object[object].model];
    const View        *view = &job->request->view;
    NodePose          *pose = arena_alloc(arena, (size_t)model->node_count, sizeof *pose);
    if (!pose) return false;
    model_pose(pose, model, NULL);
    box[0] = box[1] = INFINITY, box[2] = box[3] = -INFINITY;
    for (int p = 0; p < model->part_count; p++) {
        PosedNode node = {0};
        if (!is_hot(&s->state[s->object[object].state], &model->part[p])) continue;
        const NodePose *at = &pose[model->part[p].node];
        m3_mul(node.r_enu_from_node, posed->r_enu_from_body, at->r_body_from_node);
        m3_mul_v3(node.p_enu, posed->r_enu_from_body, at->p_body);
        v3_add(node.p_enu, node.p_enu, posed->p_enu);
        if (!grow_by_part(box, job, model, p, &node, scenery_frame_lift(frame, object))) return false;
    }
    return box[2] > 0 && box[3] > 0 && box[0] < view->width && box[1] < view->height &&
           fmin(box[2] - box[0], box[3] - box[1]) < wide_px;
}

/* Marks a box's pixels; returns how many. */
static int64_t mark(Job *job, const double box[4])
{
    const View *view = &job->request->view;
    const int   x0 = (int)fmax(0, floor(box[0])), x1 = (int)fmin(view->width, ceil(box[2]));
    const int   y0 = (int)fmax(0, floor(box[1])), y1 = (int)fmin(view->height, ceil(box[3]));
    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x1; x++) {
            const size_t px = pixel_index(job, x, y);
            job->refine[px] |= refine_all;
            job->hot[px] = 1;
        }
    return (int64_t)(x1 - x0) * (y1 - y0);
}

Status mark_hot_parts(Job *job, Arena *arena)
{
    const SceneryFrame *frame = scenery_frame_in(job->scene.visibility);
    const Scenery      *s = frame ? scenery_frame_of(frame) : NULL;
    const View         *view = &job->request->view;
    int                 hot = 0, count = 0;
    for (int k = 0; s && k < s->objects; k++) hot += has_hot_parts(s, k);
    if (hot == 0) return STATUS_OK;
    HotThing *thing = arena_alloc(arena, (size_t)hot, sizeof *thing);
    if (!thing) return STATUS_NO_MEMORY;
    for (int k = 0; k < s->objects; k++) {
        if (!has_hot_parts(s, k)) continue;
        const PosedEntity *posed = scenery_frame_posed(frame, k);
        if (posed->model < 0) continue;
        thing[count].object = k;
        count += in_view(&thing[count].range_m, view, posed);
    }
    if (count == 0) return STATUS_OK;
    const size_t pixels = (size_t)view->width * (size_t)view->height;
    job->hot = arena_alloc(arena, pixels, sizeof *job->hot);
    if (!job->hot) return STATUS_NO_MEMORY;
    qsort(thing, (size_t)count, sizeof *thing, by_range);
    int64_t room = (int64_t)pixels / (rays_share * hot_samples * hot_samples);
    for (int k = 0; k < count && room > 0; k++) {
        double box[4];
        if (box_of(box, job, frame, thing[k].object, arena)) room -= mark(job, box);
    }
    return STATUS_OK;
}
