/* render/light/canopy.h: how much diffuse light reaches a place among plants, in closed form.
 *
 * The leaves of a stand are taken for level layers: leaf area index L above a place, of leaves of every direction
 * (G = 1/2), let through 2 E3(G L) of an even sky (Monsi & Saeki 1953; Ross 1981). What leaves scatter onwards is light
 * as well: in a band where they absorb 1 - w the layers count as sqrt(1 - w) of their area (Goudriaan 1977). L comes from
 * a grid of cells over the woods, between crown base and top a share of it. A hit on a plant has the less of this and
 * of what its own plant leaves it (PlantQuad.sky): an estimate. Thermal bands: leaves radiate as much as they hide, and
 * the factor is 1. Trunks, and the side from which light comes, are left out. */
#ifndef RENDER_LIGHT_CANOPY_H
#define RENDER_LIGHT_CANOPY_H

#include "render/air/air.h"
#include "render/materials/materials.h"
#include "render/plants/plants.h"
#include "render/scene/hits.h"
#include "terrain/woods/woods.h"

typedef struct Canopy Canopy;

/* 4 octets a cell of 64 m2. leaves: false: deciduous plants are bare, and let all through. */
Status canopy_create(Canopy **out, const Woods *woods, const Plants *plants, bool leaves, Pool *pool);
void   canopy_destroy(Canopy *canopy);

/* Leaf area index above a place, height_m above its ground. */
double canopy_leaf_area_above(const Canopy *canopy, double x_m, double y_m, double height_m);
/* 2 E3(x), x >= 0: within 1e-4. */
double canopy_gap(double x);

/* Factors of the diffuse light on a plane at each hit, of the channels (1 << AirBand): multiplied into factor. */
void canopy_open(float (*factor)[hits_capacity], const Canopy *canopy, const Landscape *landscape,
                 const Materials *materials, const Hits *hits, unsigned channels);

#endif
