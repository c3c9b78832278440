/* entities/scenery/scenery_buildings.h: the buildings and works of a culture, as meshes.
 *
 * Ground is cut into square cells; what stands in one (a building by the middle of its outline, a point by its place, a
 * line piece by piece) is one Model and one SceneryObject of kind SCENERY_BUILDINGS, with state -1. Model axes: x
 * north, y east, z down, origin at the middle of the cell at the lowest base in it; the object's pose turns them into
 * ENU. A cell whose parts or triangles would be too many for one model is several.
 *
 * Parts: a record has one for each name, material and role; Scenery.part_of has the record's id. Which there are:
 * etc/reference/terrain.md ("Buildings and works as meshes").
 *
 * Closed: all parts of a record together are closed shells (every directed edge has its reverse): panes and doors close
 * the openings of walls, so a single part need not be closed; model_check holds, model_validate does not. */
#ifndef ENTITIES_SCENERY_SCENERY_BUILDINGS_H
#define ENTITIES_SCENERY_SCENERY_BUILDINGS_H

#include "entities/scenery/scenery.h"
#include "terrain/culture/culture.h"

static const double scenery_cell_m = 128;
static const double scenery_overhang_m = 0.4; /* of roofs, across the wall; less where a corner is sharp */

/* ENU z of the ground at a place; NaN: not known there. */
typedef double SceneryGround(void *user, double x_m, double y_m);

/* Appends the cells of all buildings, lines and points of a culture (culture_index was called: else doors know no
 * drives). The same records give the same bits. ground_m: NULL: as high as the bases. STATUS_NO_MEMORY, or
 * more than 2^25 records and pieces of lines or 2^27 triangles: STATUS_BAD_VALUE, logged: the scenery holds what it
 * held. */
Status scenery_add_buildings(Scenery *scenery, const Culture *culture, SceneryGround *ground_m, void *user);

/* What a building comes to. */
typedef struct BuildingHarm {
    uint64_t building; /* Building.id */
    double   t_s;
    uint8_t  damage; /* 1 .. 3 */
} BuildingHarm;
enum { building_harms_most = 256 };

/* The same with buildings whose damage changes: each is an object of its own behind the cells, whose model has the
 * building in all four states, hidden in all but one (ModelPart.damage_hidden). Scenery.harm says when. harm of
 * buildings that are not there is left out. */
Status scenery_add_harmed_buildings(Scenery *scenery, const Culture *culture, const BuildingHarm *harm, int harms,
                                    SceneryGround *ground_m, void *user);

#endif
