/* render/trace/visibility/visibility_image.c: entities on the image: the view-frustum cull of a block of pixels, and
 * bounding boxes. */
#include "render/trace/visibility/visibility_private.h"

/* ---- view-frustum cull of a block --------------------------------------------------------- */

/* The four sides of a block's pyramid and the plane of the eye, ENU: dot(n, p) >= d within. */
static void pyramid_planes(double plane[5][4], const View *view, const double box_px[4])
{
    double tangent[4];
    view_box_tangents(tangent, view, box_px);
    const double side[5][3] = {
        {1, 0, -tangent[0]}, {0, 1, -tangent[1]}, {-1, 0, tangent[2]}, {0, -1, tangent[3]}, {0, 0, 1}};
    for (int p = 0; p < 5; p++) {
        double n_cam[3], n_enu[3];
        v3_scale(n_cam, 1 / v3_length(side[p]), side[p]);
        m3_mul_v3(n_enu, view->r_enu_from_cam, n_cam);
        memcpy(plane[p], n_enu, sizeof n_enu);
        plane[p][3] = v3_dot(n_enu, view->p_enu);
    }
}

/* The entities of list[count] whose bounding sphere meets the block's pyramid. */
static int spheres_in_block(int *list, int count, const Visibility *v, const View *view, const double box_px[4])
{
    /* tangents of the block's four sides, and what turns an offset from a side into a distance */
    double tangent[4];
    view_box_tangents(tangent, view, box_px);
    const double left = tangent[0], top = tangent[1], right = tangent[2], bottom = tangent[3];
    const double per_left = 1 / sqrt(1 + left * left), per_right = 1 / sqrt(1 + right * right);
    const double per_top = 1 / sqrt(1 + top * top), per_bottom = 1 / sqrt(1 + bottom * bottom);
    int          kept = 0;
    for (int i = 0; i < count; i++) {
        const int          k = list[i];
        const PosedEntity *entity = visibility_posed(v, k);
        double             from_eye[3], c_cam[3];
        v3_sub(from_eye, entity->centre_enu, view->p_enu);
        from_eye[2] += visibility_lift(v, k);
        m3_tmul_v3(c_cam, view->r_enu_from_cam, from_eye);
        /* margin for rounding, a thousand times its maximum */
        const double r = entity->radius_m + 1e-6 + 1e-12 * v3_length(c_cam);
        if (c_cam[2] < -r || (c_cam[0] - left * c_cam[2]) * per_left < -r ||
            (right * c_cam[2] - c_cam[0]) * per_right < -r || (c_cam[1] - top * c_cam[2]) * per_top < -r ||
            (bottom * c_cam[2] - c_cam[1]) * per_bottom < -r)
            continue;
        list[kept++] = k;
    }
    return kept;
}

static int list_all(int *list, const Visibility *v)
{
    int count = 0;
    for (int k = 0; k < v->count; k++)
        if (v->loose[k]) list[count++] = k;
    return count;
}

int visibility_block_entities(int *list, const Visibility *v, const View *view, const double box_px[4], int hidden,
                              VisibilityCounters *counters)
{
    const bool by_tree = skips(v->skips_off, SKIP_TREE) && skips(v->skips_off, SKIP_BLOCK);
    int        count = 0, listed = 0;
    if (by_tree) {
        double plane[5][4];
        pyramid_planes(plane, view, box_px);
        count = broad_phase_in_planes(list, v->tree, (const double(*)[4])plane, 5);
        counters->skipped[SKIP_TREE] += (uint64_t)(v->drawable - count);
    } else {
        count = list_all(list, v);
    }
    for (int k = 0; k < count; k++)
        if (list[k] != hidden && visibility_posed(v, list[k])->model >= 0) list[listed++] = list[k];
    count = listed;
    if (skips(v->skips_off, SKIP_BLOCK)) listed = spheres_in_block(list, count, v, view, box_px);
    counters->skipped[SKIP_BLOCK] += (uint64_t)(count - listed);
    return listed;
}

/* ---- boxes on the image ------------------------------------------------------------------- */

static void grow_image_box(double box_px[4], const double at_px[2])
{
    for (int a = 0; a < 2; a++) {
        box_px[a] = at_px[a] < box_px[a] ? at_px[a] : box_px[a];
        box_px[a + 2] = at_px[a] > box_px[a + 2] ? at_px[a] : box_px[a + 2];
    }
}

static void project_between(double at_px[2], const View *view, const double a[3], const double b[3], double t)
{
    const double p_cam[3] = {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
    view_project(at_px, view, p_cam);
}

/* Through a lens an edge is bowed, and may reach beyond its ends: its extremes by samples and the parabola through the
 * three about the farthest, good to 0.01 px of a bow of 10 px. */
static void grow_by_bowed_edge(double box_px[4], const View *view, const double a[3], const double b[3])
{
    enum { parts = 16 };
    double at_px[parts + 1][2], middle_px[2];
    project_between(at_px[0], view, a, b, 0);
    project_between(at_px[1], view, a, b, 1);
    project_between(middle_px, view, a, b, 0.5);
    bool may = false;
    for (int c = 0; c < 2; c++) {
        /* four times how far the middle is from between the ends: more than a smooth bow can reach */
        const double room_px = 4 * fabs(middle_px[c] - 0.5 * (at_px[0][c] + at_px[1][c]));
        may |= fmin(at_px[0][c], at_px[1][c]) - room_px < box_px[c] ||
               fmax(at_px[0][c], at_px[1][c]) + room_px > box_px[c + 2];
    }
    if (!may) return;
    for (int n = 0; n <= parts; n++) {
        project_between(at_px[n], view, a, b, (double)n / parts);
        grow_image_box(box_px, at_px[n]);
    }
    for (int n = 1; n < parts; n++) {
        double top_px[2] = {at_px[n][0], at_px[n][1]};
        for (int c = 0; c < 2; c++) {
            const double before = at_px[n - 1][c] - at_px[n][c], after = at_px[n + 1][c] - at_px[n][c],
                         bend = before + after;
            if (before * after > 0) top_px[c] -= (after - before) * (after - before) / (8 * bend);
        }
        grow_image_box(box_px, top_px);
    }
}

static void grow_by_bowed_edges(double box_px[4], const PosedEntity *entity, double lift_m, const View *view)
{
    for (int k = 0; k < entity->node_count; k++) {
        const PosedNode *node = &entity->node[k];
        double           r_cam_from_node[9], from_eye[3], p_cam[3], triangle[3][3], corner[3][3];
        m3_tmul(r_cam_from_node, view->r_enu_from_cam, node->r_enu_from_node);
        v3_sub(from_eye, node->p_enu, view->p_enu);
        from_eye[2] += lift_m;
        m3_tmul_v3(p_cam, view->r_enu_from_cam, from_eye);
        for (int n = 0; parts_node_triangle(triangle, node, n); n++) {
            for (int c = 0; c < 3; c++) {
                m3_mul_v3(corner[c], r_cam_from_node, triangle[c]);
                v3_add(corner[c], corner[c], p_cam);
            }
            for (int c = 0; c < 3; c++) grow_by_bowed_edge(box_px, view, corner[c], corner[(c + 1) % 3]);
        }
    }
}

/* Widens the box by the projections of count points of a node; false: one is not in front of the eye. */
static bool grow_by_points(double box_px[4], const View *view, const double r_cam_from_node[9], const double p_cam[3],
                           const double (*point)[3], int count)
{
    for (int c = 0; c < count; c++) {
        double at[3], image_px[2];
        m3_mul_v3(at, r_cam_from_node, point[c]);
        v3_add(at, at, p_cam);
        if (!(at[2] > 0)) return false;
        view_project(image_px, view, at);
        grow_image_box(box_px, image_px);
    }
    return true;
}

/* Whether all of a box lies within box_px: its corners, in the node's axes. */
static bool lies_within(const double box_px[4], const View *view, const double r_cam_from_node[9],
                        const double p_cam[3], const double corner[8][3])
{
    double around[4] = {INFINITY, INFINITY, -INFINITY, -INFINITY};
    return grow_by_points(around, view, r_cam_from_node, p_cam, corner, 8) && around[0] > box_px[0] &&
           around[1] > box_px[1] && around[2] < box_px[2] && around[3] < box_px[3];
}

/* The vertices of a node but for blocks of them whose boxes lie within box_px already; through a lens, where straight
 * lines are not, all. */
static bool grow_by_node(double box_px[4], const View *view, const PosedNode *node, double lift_m, bool first)
{
    const bool lens = view_has_lens(view);
    int        count;
    const double(*corner)[3] = parts_node_corners(node, &count);
    double r_cam_from_node[9], from_eye[3], p_cam[3], box[8][3];
    m3_tmul(r_cam_from_node, view->r_enu_from_cam, node->r_enu_from_node);
    v3_sub(from_eye, node->p_enu, view->p_enu);
    from_eye[2] += lift_m;
    m3_tmul_v3(p_cam, view->r_enu_from_cam, from_eye);
    if (!first && !lens && count > 8) {
        parts_node_box(box, node);
        if (lies_within(box_px, view, r_cam_from_node, p_cam, (const double(*)[3])box)) return true;
    }
    for (int from = 0; from < count; from += parts_block_corners) {
        const int many = count - from < parts_block_corners ? count - from : parts_block_corners;
        if (from > 0 && !lens && many > 8) {
            parts_block_box(box, node, from / parts_block_corners);
            if (lies_within(box_px, view, r_cam_from_node, p_cam, (const double(*)[3])box)) continue;
        }
        if (!grow_by_points(box_px, view, r_cam_from_node, p_cam, corner + from, many)) return false;
    }
    return true;
}

/* The largest node is the first: most others lie within its box. */
bool visibility_project_box(double box_px[4], const Visibility *v, const View *view, int index)
{
    const PosedEntity *entity = visibility_posed(v, index);
    double             box[4] = {INFINITY, INFINITY, -INFINITY, -INFINITY};
    if (entity->model < 0) return false;
    const int    largest = parts_largest_node(entity);
    const double lift_m = visibility_lift(v, index);
    for (int n = 0; n < entity->node_count; n++) {
        const PosedNode *node = &entity->node[n == 0 ? largest : n <= largest ? n - 1 : n];
        if (!grow_by_node(box, view, node, lift_m, n == 0)) return false;
    }
    if (view_has_lens(view)) grow_by_bowed_edges(box, entity, lift_m, view);
    memcpy(box_px, box, sizeof box);
    return true;
}
