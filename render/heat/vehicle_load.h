/* render/heat/vehicle_load.h: what heats and cools the nodes of an entity at a moment.
 *
 * At a patch: sun by rays past its own parts and its neighbours, with the ground's shade; sky and ground light;
 * longwave of sky, of ground (in the open, and in its own shade below it), of its other patches, at their
 * temperatures of the step's beginning, and of its neighbours (vehicle_near.h); convection by wind and its own
 * speed, to the air's recovery temperature, and where an exhaust flows past it, its own or a neighbour's, to that
 * (jet_path.h); what is behind it (etc/heat.csv).
 *
 * Tracks and wheels that stand touch the ground as two bodies do that are brought together (Carslaw & Jaeger 2.4,
 * contact of half-spaces): 2 e / sqrt(pi t) W/(m2 K), e of skin and ground in series, t the time that ground has
 * been under it: the print's length over the speed, an hour for one that stands; in series with gaps between. In
 * motion all of a track or tyre has its share of the print.
 *
 * Ships and submarines, and vehicles in water, meet it below its surface, at its temperature, by a film of natural
 * convection and of a turbulent plate 10 m long (Incropera & DeWitt 9.6, 7.2: Nu = 0.1 Ra^(1/3), 0.037 Re^0.8
 * Pr^(1/3), water of 288 K), instead of air, sun and radiation.
 *
 *     film plate_film_w_m2k (surface_flux.h), with air density^0.8 above
 *     recovery 0.85 v^2 / (2 cp): between the laminar sqrt(Pr) = 0.84 and the turbulent Pr^(1/3) = 0.89 */
#ifndef RENDER_HEAT_VEHICLE_LOAD_H
#define RENDER_HEAT_VEHICLE_LOAD_H

#include "entities/table/snapshot.h"
#include "render/heat/neighbours.h"
#include "render/heat/patch_view.h"
#include "render/heat/vehicle_shape.h"

/* Weather and ground about a place. */
typedef struct PlaceHeat {
    double air_k, air_density;         /* at its height; over that at sea level */
    double wind_enu_mps[3];
    double direct_w_m2, diffuse_w_m2, longwave_w_m2; /* facing the sun; on level ground; down on level ground */
    double sun_d_enu[3];
    double ground_k, under_k;          /* in the open; in the shade of the entity */
    double ground_rho;                 /* reflectance for sunlight */
    double above_m;                    /* of the place over the ground or the water */
    double water_k;                    /* surface of water there, or of the sea nearby */
    bool   water;                      /* it is water */
} PlaceHeat;

/* An entity as it is posed at a time, with what is about it. */
typedef struct VehicleMoment {
    const SnapshotEntity *entity;
    const Model          *model;
    const VehicleShape   *shape;
    PosedEntity           posed;
    PatchPose             pose;
    NodePose             *node;
    double               *joint;
    double                p_enu[3], v_enu_mps[3];
    float                *lit;      /* [patches]: patch_view_sun */
    float                *gas_k, *gas_mps; /* [patches]: of exhaust that flows past, over the air; vehicle_loads fills them */
    float                *sent_w_m2; /* [patches]: sunlight that they reflect; vehicle_loads fills it */
    const NearView       *near;     /* [patches]: what its neighbours take of its views; NULL: nothing */
    float                *near_w_m2, *near_sun_w_m2; /* [patches]: of what is seen of them, on average: longwave, sunlight */
    const JetPath        *jet[near_jet_most];        /* of neighbours; from its own origin */
    const PosedEntity    *shade[near_sun_most];      /* neighbours before its sun; likewise */
    int                   jets, shades;
    PlaceHeat             place;
    bool                  afloat;   /* in water, as vehicle_loads finds it */
} VehicleMoment;

/* load[shape->nodes]. view[patches]; temp_k[shape->nodes]: of the patches that others see. */
void vehicle_loads(NetworkLoad *load, VehicleMoment *moment, const PatchView *view, const double *temp_k, const EntityDrives *drives);
/* Sets the conductances of the shape's network to engine and cabin. */
void vehicle_links(const VehicleShape *shape, const EntityDrives *drives);
/* Exhaust of an entity whose origin is at p_enu. */
void vehicle_jet(JetPath *out, const ExhaustJet *exhaust, const double p_enu[3], const double r_enu_from_body[9],
                 const double v_enu_mps[3], const PlaceHeat *place);
/* Of the air that is stopped at a surface, over the air. */
double vehicle_recovery_k(double speed_mps);

#endif
