/* render/trace/parts/parts_patches.c: patches of a node: neighbouring triangles that share one of Embree's boxes. */
#include "render/trace/parts/parts_private.h"

#include <stdlib.h>

static const double patch_much_the_same = 0.75; /* surface of its box at most, over the sum of theirs */

static void measure(float height_m[3], const NodeMesh *mesh, int t)
{
    double edge[3][3], normal[3];
    for (int c = 0; c < 3; c++) v3_sub(edge[c], parts_corner(mesh, t, (c + 1) % 3), parts_corner(mesh, t, c));
    v3_cross(normal, edge[0], edge[1]);
    for (int c = 0; c < 3; c++) {
        const double side_m = v3_length(edge[c]);
        height_m[c] = side_m > 0 ? (float)(v3_length(normal) / side_m) : 0;
    }
}

/* Half the surface of a box; 0: an empty one. */
static double half_surface_m2(const double low[3], const double high[3])
{
    const double x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
    return x >= 0 ? x * y + y * z + z * x : 0;
}

/* A box about a patch; one of its triangles without area is never hit. */
static void bound(double low[3], double high[3], const Patch *patch)
{
    for (int x = 0; x < 3; x++) low[x] = INFINITY, high[x] = -INFINITY;
    for (int k = 0; k < patch->count; k++) {
        const float *height_m = patch->height_m[k];
        if (!(height_m[0] > 0 && height_m[1] > 0 && height_m[2] > 0)) continue;
        for (int c = 0; c < 3; c++) {
            const double *corner = patch->corner[k ? patch->second[c] : c];
            for (int x = 0; x < 3; x++) {
                low[x] = corner[x] < low[x] ? corner[x] : low[x];
                high[x] = corner[x] > high[x] ? corner[x] : high[x];
            }
        }
    }
}

/* A patch of one triangle, and a box about it. */
static void begin_patch(Patch *patch, double low[3], double high[3], const NodeMesh *mesh, int t)
{
    *patch = (Patch){.triangle = mesh->triangle[t], .count = 1};
    for (int c = 0; c < 3; c++) memcpy(patch->corner[c], parts_corner(mesh, t, c), sizeof patch->corner[c]);
    memcpy(patch->corner[3], patch->corner[0], sizeof patch->corner[3]);
    measure(patch->height_m[0], mesh, t);
    bound(low, high, patch);
}

/* Whether another triangle has two of its corners, to the bit: then it gets the fourth. */
static bool joins(Patch *patch, const NodeMesh *mesh, int t)
{
    int others = 0;
    for (int c = 0; c < 3; c++) {
        const double *corner = parts_corner(mesh, t, c);
        int           same = 0;
        while (same < 3 && memcmp(patch->corner[same], corner, sizeof patch->corner[same]) != 0) same++;
        patch->second[c] = (uint8_t)same;
        if (same < 3) continue;
        memcpy(patch->corner[3], corner, sizeof patch->corner[3]);
        others++;
    }
    return others <= 1;
}

/* The patch from a triangle on. Neighbours in the list whose boxes are much the same, as are those of a quad's two
 * triangles, make one: half as many boxes to pass through, and triangles that are tested together lie together. */
static void take_patch(Patch *out, const NodeMesh *mesh, int t)
{
    double low[3], high[3], next_low[3], next_high[3];
    Patch  next;
    begin_patch(out, low, high, mesh, t);
    if (t + 1 == mesh->triangle_count || mesh->triangle[t + 1] != mesh->triangle[t] + 1) return;
    begin_patch(&next, next_low, next_high, mesh, t + 1);
    const double sum_m2 = half_surface_m2(low, high) + half_surface_m2(next_low, next_high);
    for (int x = 0; x < 3; x++) low[x] = fmin(low[x], next_low[x]), high[x] = fmax(high[x], next_high[x]);
    if (!(half_surface_m2(low, high) <= patch_much_the_same * sum_m2)) return;
    Patch both = *out;
    if (!joins(&both, mesh, t + 1)) return;
    *out = both;
    out->count = 2;
    memcpy(out->height_m[1], next.height_m[0], sizeof out->height_m[1]);
}

Status parts_list_patches(NodeMesh *mesh)
{
    Patch patch;
    for (int t = 0; t < mesh->triangle_count; t += patch.count, mesh->patch_count++) take_patch(&patch, mesh, t);
    mesh->patch = aligned_alloc(_Alignof(Patch), (size_t)mesh->patch_count * sizeof *mesh->patch);
    if (!mesh->patch) return STATUS_NO_MEMORY;
    for (int t = 0, k = 0; k < mesh->patch_count; t += mesh->patch[k++].count) take_patch(&mesh->patch[k], mesh, t);
    return STATUS_OK;
}

void parts_bound_patch(double low[3], double high[3], const NodeMesh *mesh, uint32_t patch)
{
    bound(low, high, &mesh->patch[patch]);
}

bool parts_node_patch(double box[2][3], const PosedNode *node, int k)
{
    if (k >= node->mesh->patch_count) return false;
    parts_bound_patch(box[0], box[1], node->mesh, (uint32_t)k);
    return true;
}
