/* render/trace/parts/parts_patches.c: patches of a node: neighbouring triangles that share one of Embree's boxes. */
#include "render/trace/parts/parts_private.h"

#include <stdlib.h>

enum { patch_most = 2 };                        /* facets of a patch */
static const double patch_much_the_same = 0.75; /* surface of its box at most, over the sum of theirs */

static bool has_area(const Facet *f) { return f->height_m[0] > 0 && f->height_m[1] > 0 && f->height_m[2] > 0; }

/* Widens a box by a facet; one without area is never hit. */
static void include_facet(double low[3], double high[3], const Facet *f)
{
    for (int k = 0; k < 3 && has_area(f); k++)
        for (int x = 0; x < 3; x++) {
            low[x] = f->corner[k][x] < low[x] ? f->corner[k][x] : low[x];
            high[x] = f->corner[k][x] > high[x] ? f->corner[k][x] : high[x];
        }
}

void parts_bound_patch(double low[3], double high[3], const NodeMesh *mesh, uint32_t patch)
{
    for (int x = 0; x < 3; x++) low[x] = INFINITY, high[x] = -INFINITY;
    for (uint32_t f = mesh->patch[patch]; f < mesh->patch[patch + 1]; f++) include_facet(low, high, &mesh->facet[f]);
}

/* Half the surface of a box; 0: an empty one. */
static double half_surface_m2(const double low[3], const double high[3])
{
    const double x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
    return x >= 0 ? x * y + y * z + z * x : 0;
}

/* Neighbours in the list whose boxes are much the same, as are those of a quad's two triangles, make a patch: half as
 * many boxes to pass through, and facets that are tested together lie together. */
Status parts_list_patches(NodeMesh *mesh)
{
    double low[3] = {0}, high[3] = {0}, patch_m2 = 0; /* of the patch that is being made */
    mesh->patch = calloc((size_t)mesh->triangle_count + 1, sizeof *mesh->patch);
    if (!mesh->patch) return STATUS_NO_MEMORY;
    for (int t = 0; t < mesh->triangle_count; t++) {
        double own_low[3] = {INFINITY, INFINITY, INFINITY}, own_high[3] = {-INFINITY, -INFINITY, -INFINITY};
        include_facet(own_low, own_high, &mesh->facet[t]);
        const double own_m2 = half_surface_m2(own_low, own_high);
        const int    held = mesh->patch_count ? t - (int)mesh->patch[mesh->patch_count - 1] : patch_most;
        if (held < patch_most) {
            double both[2][3];
            for (int x = 0; x < 3; x++) both[0][x] = fmin(low[x], own_low[x]), both[1][x] = fmax(high[x], own_high[x]);
            const double both_m2 = half_surface_m2(both[0], both[1]);
            if (both_m2 <= patch_much_the_same * (patch_m2 + own_m2)) {
                memcpy(low, both[0], sizeof low), memcpy(high, both[1], sizeof high);
                patch_m2 = both_m2;
                continue;
            }
        }
        mesh->patch[mesh->patch_count++] = (uint32_t)t;
        memcpy(low, own_low, sizeof low), memcpy(high, own_high, sizeof high);
        patch_m2 = own_m2;
    }
    mesh->patch[mesh->patch_count] = (uint32_t)mesh->triangle_count;
    return STATUS_OK;
}

bool parts_node_patch(double box[2][3], const PosedNode *node, int k)
{
    if (k >= node->mesh->patch_count) return false;
    parts_bound_patch(box[0], box[1], node->mesh, (uint32_t)k);
    return true;
}
