/* render/heat/vehicle_shape.h: the thermal network of a model: nodes through the skin of each patch, its engine and
 * its cabin.
 *
 * Thin metal is one node; what conducts badly, and the wall of a gun, has nodes at four depths, the first at the
 * surface. Conduction along the skin and across joints follows from the geometry of patches; bolted and welded
 * joints have a third of it (an estimate). What of a patch lies inside the model is no skin of it; a patch that does
 * so as a whole is mass inside. A part's skin is as thick as its sidecar says, or as its role's row. Fuel meets the
 * engine by its return line, and the skin of hull or airframe by the share of it that tanks touch. */
#ifndef RENDER_HEAT_VEHICLE_SHAPE_H
#define RENDER_HEAT_VEHICLE_SHAPE_H

#include "entities/models/patches.h"
#include "render/heat/network.h"
#include "render/heat/part_table.h"
#include "render/materials/materials.h"

typedef struct SkinNode {
    PartRow row;
    int     surface, inner;    /* nodes; the same where the skin is thin */
    int     inside_link;       /* to engine or cabin; -1: none */
    double  area_m2, open_m2;  /* of the node; of that what meets the outside: all of it, or nothing */
    double  ground_m2, rolls_m2; /* on level ground as it stands; as it rolls: of the whole body, in proportion to area */
    double  print_m;           /* side of the body's print on the ground */
    double  effusivity;        /* root of conductivity, density and heat capacity, J/(m2 K s^1/2) */
    double  absorptance, emissivity;
    double  friction;          /* share of the row's drive_value */
} SkinNode;

typedef struct VehicleShape {
    const Patches *patches;
    MachineRow     machine;
    int            nodes, links, engine, cabin, fuel; /* nodes; -1: it has none */
    int            fuel_link;  /* between engine and fuel; -1: none */
    double        *capacity_j_k;
    NetworkLink   *link;
    SkinNode      *skin;       /* [patches->count] */
    int            gun_body[2];/* of patches: what fires small, large charges; -1: none */
    double         gun_m2[2];  /* their areas */
    Network       *network;
    double        *conductance_w_k; /* [links]: scratch of the moment */
} VehicleShape;

/* patches must outlive it. index: of the model in the catalog. */
Status vehicle_shape_create(VehicleShape *out, const Patches *patches, const Model *model, int index, const PartTable *table,
                            const Materials *materials);
void   vehicle_shape_destroy(VehicleShape *shape); /* accepts zeroes */
#endif
