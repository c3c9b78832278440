/* entities/scenery/scenery_building.c: one building of a culture: its place in the cell, roof, walls, chimneys, vents.
 */
#include "entities/scenery/scenery_buildings_private.h"
#include "terrain/culture/courtyards.h"

#include <stdlib.h>

/* How far walls go into the ground: half a metre under the lowest ground along them. */
static double skirt(const BuildingWork *w)
{
    static const double least_m = 0.5, most_m = 20;
    double              lowest_m = 0;
    for (int k = 0; k < w->n && w->ground_m; k++) {
        const double z_m = w->ground_m(w->user, w->p[k][0] + w->origin[0], w->p[k][1] + w->origin[1]);
        if (isfinite(z_m)) lowest_m = fmin(lowest_m, z_m - w->origin[2] - w->base_m);
    }
    return fmin(least_m - lowest_m, most_m);
}

/* Whether a place is inside the outline, and not nearer than this to its sides. */
static bool is_well_inside(const BuildingWork *w, const double at[2], double least_m)
{
    bool in = false;
    for (int k = 0; k < w->n; k++) {
        const double *a = w->p[k], *b = w->p[(k + 1) % w->n], d[2] = {b[0] - a[0], b[1] - a[1]};
        const double  q[2] = {at[0] - a[0], at[1] - a[1]};
        const double  t = clamp((q[0] * d[0] + q[1] * d[1]) / (d[0] * d[0] + d[1] * d[1]), 0, 1);
        if (hypot(q[0] - t * d[0], q[1] - t * d[1]) < least_m) return false;
        if ((a[1] > at[1]) != (b[1] > at[1]) && at[0] < a[0] + (at[1] - a[1]) * d[0] / d[1]) in = !in;
    }
    return in;
}

static void chimneys(BuildingWork *w)
{
    static const double over_m = 0.9;
    const int           count = w->b->chimneys > 4 ? 4 : w->b->chimneys;
    const char *material = w->b->wall_fabric == FABRIC_STONE ? fabric_material(FABRIC_STONE, w->b->id) : "brick_red";
    if (count == 0) return;
    const int slot =
        cell_part(w->cell, "chimney", material, w->b->heated && w->b->damage < 2 ? HEAT_FLUE : HEAT_PASSIVE);
    const double d[2] = {w->ridge[1][0] - w->ridge[0][0], w->ridge[1][1] - w->ridge[0][1]}, length = hypot(d[0], d[1]);
    const double along[2] = {length > 0.01 ? d[0] / length : 1, length > 0.01 ? d[1] / length : 0};
    for (int k = 0; k < count; k++) {
        /* at the ends of the ridge, a metre inside of them, and evenly between */
        const double from = fmin(1.4, 0.5 * length),
                     share = count > 1 ? (double)k / (count - 1) : record_random(w->b->id, 5);
        const double u = length > 2.8 ? from + share * (length - 2 * from)
                                      : (k + 0.5) * length / count + (k - 0.5 * (count - 1)) * 1.0;
        const double at[2] = {w->ridge[0][0] + u * along[0], w->ridge[0][1] + u * along[1]};
        if (!is_well_inside(w, at, 0.45)) continue;
        cell_box(w->cell, slot, at, along, 0.32, 0.28, w->ridge_top_m - 0.9, w->ridge_top_m + over_m);
    }
}

/* Of halls: along the ridge. */
static void vents(BuildingWork *w)
{
    const double d[2] = {w->ridge[1][0] - w->ridge[0][0], w->ridge[1][1] - w->ridge[0][1]}, length = hypot(d[0], d[1]);
    if (w->b->use != BUILDING_HALL) return;
    const int    slot = cell_part(w->cell, "roof", "sheet_grey", HEAT_PASSIVE);
    const double along[2] = {length > 0.01 ? d[0] / length : 1, length > 0.01 ? d[1] / length : 0};
    const int    count = length > 6 ? (int)fmin(length / 6, 16) : 1;
    for (int k = 0; k < count; k++) {
        const double u = (k + 0.5) * length / count;
        const double at[2] = {w->ridge[0][0] + u * along[0], w->ridge[0][1] + u * along[1]};
        if (!is_well_inside(w, at, 0.75)) continue;
        cell_box(w->cell, slot, at, along, 0.5, 0.5, w->ridge_top_m - 0.4, w->ridge_top_m + 0.6);
    }
}

void building_gutters(BuildingWork *w, const RoofPlan *plan, const bool *gable, double z)
{
    static const double half_m = 0.045, least_m = 0.5;
    const bool          lived_in = w->b->use == BUILDING_HOUSE || w->b->use == BUILDING_FLATS;
    if (!lived_in || w->b->damage > 1 || w->b->roof_fabric == FABRIC_THATCH) return;
    const int slot = cell_part(w->cell, "gutter", "sheet_grey", HEAT_PASSIVE);
    for (int k = 0; k < plan->corners; k++) {
        const double *a = plan->node[k], *b = plan->node[(k + 1) % plan->corners];
        const double  d[2] = {b[0] - a[0], b[1] - a[1]}, length_m = hypot(d[0], d[1]);
        if ((gable && gable[k]) || length_m < least_m) continue;
        const double out[2] = {half_m * d[1] / length_m, -half_m * d[0] / length_m};
        cell_bar(w->cell, slot, (const double[3]){a[0] + out[0], a[1] + out[1], z},
                 (const double[3]){b[0] + out[0], b[1] + out[1], z}, half_m);
    }
}

void building_make(CellMesh *cell, const Culture *culture, const Building *b, const double origin[3],
                   SceneryGround *ground_m, void *user)
{
    BuildingWork w = {.culture = culture, .b = b, .cell = cell, .n = b->corners, .ground_m = ground_m, .user = user};
    w.p = malloc((size_t)w.n * sizeof *w.p);
    if (!w.p) {
        cell->status = STATUS_NO_MEMORY;
        return;
    }
    memcpy(w.origin, origin, sizeof w.origin);
    for (int k = 0; k < w.n; k++)
        for (int c = 0; c < 2; c++) w.p[k][c] = culture->corner_m[b->first_corner + k][c] - origin[c];
    w.base_m = (double)b->base_m - origin[2];
    bool *slit = malloc((size_t)w.n * sizeof *slit);
    if (!slit) cell->status = STATUS_NO_MEMORY;
    else if (courtyards_slits(slit, (const double(*)[2])w.p, w.n) > 0) w.slit = slit;
    w.skirt_m = skirt(&w);
    cell_begin(cell, b->id);
    const HeatRole role = b->heated && b->damage < 2 ? HEAT_DWELLING : HEAT_PASSIVE;
    w.wall = cell_part(cell, "wall", fabric_material(b->wall_fabric, b->id), role);
    w.roof = cell_part(cell, "roof", fabric_material(b->roof_fabric, b->id), role);
    w.lid = b->damage > 1 ? cell_part(cell, "wall", "masonry_sooted", HEAT_PASSIVE) : w.wall;
    if (b->damage > 2) {
        building_ruin(&w);
    } else {
        building_roof(&w);
        building_walls(&w);
        chimneys(&w);
        vents(&w);
    }
    cell_end(cell);
    free(w.p), free(slit);
}
