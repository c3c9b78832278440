/* render/frame/thin_lines.c: antennas, wires and edge-on plates on the image, by boxes about them. */
#include "render/frame/thin_lines.h"

#include "render/parts/parts.h"

/* Pieces narrower than a pixel have boxes narrower than this: about a square bar the box may stand on its edge. */
static const double thin_box_px = 2;

/* Where a box lies on the image: the ends of the axis that is longest there, and its width across it, px. */
typedef struct ThinLine {
    double end_px[2][2], width_px;
} ThinLine;

/* False: not all of it is in front of the eye, or it is a point. */
static bool line_of_box(ThinLine *out, const View *view, const PosedNode *node, const ThinBox *box)
{
    double along_px[3][2], end_px[3][2][2], longest_px = 0;
    int    longest = 0;
    for (int a = 0; a < 3; a++) {
        for (int s = 0; s < 2; s++) {
            double p_node[3], p_enu[3], p_cam[3];
            v3_add_scaled(p_node, box->centre, s ? box->half[a] : -box->half[a], box->axis[a]);
            m3_mul_v3(p_enu, node->r_enu_from_node, p_node);
            v3_add(p_enu, p_enu, node->p_enu);
            v3_sub(p_enu, p_enu, view->p_enu);
            m3_tmul_v3(p_cam, view->r_enu_from_cam, p_enu);
            if (!(p_cam[2] > 0)) return false;
            view_project(end_px[a][s], view, p_cam);
        }
        for (int k = 0; k < 2; k++) along_px[a][k] = end_px[a][1][k] - end_px[a][0][k];
        const double length_px = sqrt(along_px[a][0] * along_px[a][0] + along_px[a][1] * along_px[a][1]);
        if (length_px > longest_px) longest_px = length_px, longest = a;
    }
    if (!(longest_px > 0 && longest_px < 1e6)) return false;
    memcpy(out->end_px, end_px[longest], sizeof out->end_px);
    out->width_px = 0;
    for (int a = 0; a < 3; a++)
        out->width_px += fabs(along_px[a][0] * along_px[longest][1] - along_px[a][1] * along_px[longest][0]) / longest_px;
    return true;
}

/* Marks the pixels that come within half the line's width of it. */
static void mark_line(Job *job, const ThinLine *line, uint8_t flag)
{
    const View  *view = &job->request->view;
    const double dx = line->end_px[1][0] - line->end_px[0][0], dy = line->end_px[1][1] - line->end_px[0][1];
    const int    axis = fabs(dx) >= fabs(dy) ? 0 : 1; /* along which its pixels are counted */
    const int    size[2] = {view->width, view->height};
    const double slope = axis ? dx / dy : dy / dx, half_px = 0.5 * line->width_px;
    const double low = fmin(line->end_px[0][axis], line->end_px[1][axis]) - half_px;
    const double high = fmax(line->end_px[0][axis], line->end_px[1][axis]) + half_px;
    /* along the other axis, over all of a pixel's length */
    const double reach = half_px * sqrt(1 + slope * slope) + 0.5 * fabs(slope);
    for (int k = (int)clamp(floor(low), 0, size[axis]); k < (int)clamp(ceil(high), 0, size[axis]); k++) {
        const double on = line->end_px[0][!axis] + (k + 0.5 - line->end_px[0][axis]) * slope;
        const int    from = (int)clamp(floor(on - reach), 0, size[!axis]), to = (int)clamp(ceil(on + reach), 0, size[!axis]);
        for (int l = from; l < to; l++)
            job->refine[axis ? pixel_index(job, l, k) : pixel_index(job, k, l)] |= flag;
    }
}

void mark_thin_lines(Job *job, int index, uint8_t flag)
{
    const PosedEntity *entity = visibility_posed(job->scene.visibility, index);
    for (int n = 0; entity->model >= 0 && n < entity->node_count; n++) {
        int            count;
        const ThinBox *box = parts_node_thin(&entity->node[n], &count);
        for (int k = 0; k < count; k++) {
            ThinLine line;
            if (line_of_box(&line, &job->request->view, &entity->node[n], &box[k]) && line.width_px < thin_box_px) mark_line(job, &line, flag);
        }
    }
}
