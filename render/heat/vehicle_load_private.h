/* render/heat/vehicle_load_private.h: the thermal network of a model, and what heats and cools it at a moment. */
#ifndef RENDER_HEAT_VEHICLE_LOAD_PRIVATE_H
#define RENDER_HEAT_VEHICLE_LOAD_PRIVATE_H

#include "entities/traces/effect_puffs.h"
#include "dis/pdu/pdu.h"
#include "pitviper.h"
#include "entities/models/patches.h"
#include "render/trace/parts/parts.h"
#include "render/heat/heat_network_private.h"
#include "render/heat/part_table.h"
#include "render/materials/materials.h"
#include "entities/table/snapshot.h"

/* ---- jets ------------------------------------------------------------------------------------ */

/* Where the exhaust of an engine goes, and how warm and fast it is there: a round jet that mixes with
 * the air, bends with its flow and rises.
 *
 * Balances of mass, momentum and heat along the jet's axis, with one value across it (Hoult & Weil 1972, Atmospheric
 * Environment 6, 513): air enters at 0.08 of the difference in speed along the axis (round jets: Fischer et al. 1979,
 * 0.0535 for a Gaussian profile, times the root of two) and 0.6 of the flow across it. Across the axis a Gaussian of
 * the same flux. The former grows to that over the first 13 diameters (Hill 1972, J. Fluid Mech. 51, 773). Error: speed
 * on the axis of a free jet within 10 % of what is measured (Pope 2000), rise of a hot one in a wind within 15 % of
 * Briggs's law (tests/render/test_jet_path.c). Swirl, the wake of the vehicle and rotor wash are not known. */

enum { jet_points = 64, jet_run = 8, jet_boxes = jet_points / jet_run };

typedef struct JetPoint {
    double p_enu[3];            /* on the axis */
    double way_enu[3], per_m2;  /* to the next point; 1 over its square */
    double radius_m;            /* where excess and speed are exp(-2) of those on the axis */
    double excess_k, speed_mps; /* on the axis; excess: over the air */
} JetPoint;

/* About all of a jet, or a run of it, that is warmer than the air by 1 K or more. */
typedef struct JetBox {
    double low_m[3], high_m[3];
} JetBox;

typedef struct JetPath {
    int      count;
    JetPoint point[jet_points];
    double   widest;              /* squared radii from the axis, beyond which it is nowhere warmer by 1 K */
    JetBox   box, run[jet_boxes]; /* run[k]: between points jet_run k and jet_run (k + 1) */
} JetPath;

/* From p_enu, leaving in direction d_enu, in air that flows at flow_enu_mps: in axes that move with the outlet. Ends
 * where it is less than 1 K over the air. */
void jet_path(JetPath *out, const ExhaustJet *jet, const double p_enu[3], const double d_enu[3],
              const double flow_enu_mps[3], double air_k);

/* At a place. wall: it is on the ground or a skin, behind which there is a mirrored jet. False: no warmer there. from:
 * the point of the axis two radii upstream, or the outlet: where what flows past comes from (may be NULL). */
bool jet_path_at(double *excess_k, double *speed_mps, double from_enu[3], const JetPath *path, const double p_enu[3],
                 bool wall);

/* ---- neighbours ------------------------------------------------------------------------------ */

/* Which other entities matter to the heat of one: those that fill its view, stand before
 * its sun, or blow their exhaust on it.
 *
 * Bodies are spheres about their origins that hold every pose. The share of a view that a body fills is at most
 * (radius / distance)^2, the view factor of a sphere before a plate that faces it; distance is from the nearest
 * place of the entity's own sphere, and at least the radius. Largest shares first, ties by id. */

enum {
    near_seen_most = 8,
    near_sun_most = 8,
    near_jet_most = 4,
    near_most = near_seen_most + near_sun_most + near_jet_most
};

typedef enum NearWhy { NEAR_SEEN = 1, NEAR_SUN = 2, NEAR_JET = 4 } NearWhy;

typedef struct NearBody {
    DisEntityId id;
    double      p_enu[3], v_enu_mps[3];
    double      radius_m; /* 0: it counts as no neighbour */
    double      jet_m;    /* how far its exhaust may reach; 0: it has none */
} NearBody;

typedef struct Neighbour {
    int      body;
    unsigned why;         /* NearWhy */
    double   share, fill; /* at most, of a view; (radius / distance of origins)^2 */
} Neighbour;

typedef struct Neighbours {
    int       count, left_out; /* left_out: beyond the numbers above */
    Neighbour of[near_most];   /* largest shares first */
} Neighbours;

/* body[count], by id. sun_d_enu: towards the sun; below the horizon it has none. resting: of those alone that do not
 * move against it, by 1 m/s. */
void vehicle_neighbours_find(Neighbours *out, const NearBody *body, int count, int me, const double sun_d_enu[3],
                             bool resting);

/* ---- what patches see ------------------------------------------------------------------------ */

/* What each patch of an entity sees, by rays against its own parts as they are posed: sky,
 * ground, the ground beneath it, other patches, and the sun.
 *
 * Shares are of the hemisphere over the patch, weighted by the cosine: 12 rays from each of four points, the same
 * for every entity. Error: some 0.05 of a share (tests/render/test_vehicle_heat.c). What other entities take of that
 * is seen apart from it, by the same rays: tests/render/test_vehicle_neighbours.c. A patch that lies inside the
 * model (open_share 0) sees nothing: all its shares are 0. */

enum { patch_view_rays = 12, patch_partners = 8, patch_near_rays = 24, near_partners = 6, patch_others = 8 };

typedef struct PatchView {
    float   sky, ground, under; /* under: ground within the outline of the entity, in its shade */
    uint8_t partners;           /* the rest: other patches, at most so many; shares add up to 1 */
    uint8_t partner[patch_partners];
    float   share[patch_partners];
} PatchView;

/* What other entities take of a patch's view, in rays of patch_points patch_near_rays. */
typedef struct NearView {
    uint8_t sky, ground, under, own; /* that met these before, own: its entity's parts; the sum met others */
    uint8_t partners;                /* patches of others, at most so many: the most seen ones stand for all */
    uint8_t slot[near_partners], patch[near_partners], rays[near_partners]; /* slot: which of the others */
} NearView;

/* An entity as it is posed now, at the origin of ENU. */
typedef struct PatchPose {
    const Patches     *patches;
    const Model       *model;
    const PosedEntity *posed; /* at p_enu 0; another one: from there */
    const NodePose    *node;
    double             r_enu_from_body[9];
    double             above_m; /* of its base over the ground */
} PatchPose;

void vehicle_view_look(PatchView *out, const PatchPose *pose, int patch);
/* other[others]: at most patch_others; NULL among them: gone. Of these, patches, model and posed are read. */
void vehicle_view_near(NearView *out, const PatchPose *pose, int patch, const PatchPose *const *other, int others);
/* out[patches->count]. Share of the direct sun that each patch takes: mean cosine of its points, 0 where its own
 * parts, or others, are between. */
void vehicle_view_sun(float *out, const PatchPose *pose, const double sun_d_enu[3], const PosedEntity *const *other,
                      int others);
/* Of a jet that flows past a patch: means over its points, 0 where its own parts are between them and the jet
 * upstream. */
void vehicle_view_gas(float *excess_k, float *speed_mps, const PatchPose *pose, int patch, const JetPath *path);
/* Unit normal of a patch, ENU. */
void vehicle_view_normal(double n_enu[3], const PatchPose *pose, int patch);

/* ---- the network of a model ------------------------------------------------------------------ */

/* The thermal network of a model: nodes through the skin of each patch, its engine and
 * its cabin.
 *
 * Thin metal is one node; what conducts badly, and the wall of a gun, has nodes at four depths, the first at the
 * surface. Conduction along the skin and across joints follows from the geometry of patches; bolted and welded
 * joints have a third of it (an estimate). What of a patch lies inside the model is no skin of it; a patch that does
 * so as a whole is mass inside. A part's skin is as thick as its sidecar says, or as its role's row. Fuel meets the
 * engine by its return line, and the skin of hull or airframe by the share of it that tanks touch. */

typedef struct SkinNode {
    PartRow row;
    int     surface, inner;   /* nodes; the same where the skin is thin */
    int     inside_link;      /* to engine or cabin; -1: none */
    double  area_m2, open_m2; /* of the node; of that what meets the outside: all of it, or nothing */
    double  ground_m2,
        rolls_m2;      /* on level ground as it stands; as it rolls: of the whole body, in proportion to area */
    double print_m;    /* side of the body's print on the ground */
    double effusivity; /* root of conductivity, density and heat capacity, J/(m2 K s^1/2) */
    double absorptance, emissivity;
    double friction; /* share of the row's drive_value */
} SkinNode;

typedef struct VehicleShape {
    const Patches *patches;
    MachineRow     machine;
    int            nodes, links, engine, cabin, fuel; /* nodes; -1: it has none */
    int            fuel_link;                         /* between engine and fuel; -1: none */
    double        *capacity_j_k;
    NetworkLink   *link;
    SkinNode      *skin;        /* [patches->count] */
    int            gun_body[2]; /* of patches: what fires small, large charges; -1: none */
    double         gun_m2[2];   /* their areas */
    Network       *network;
    double        *conductance_w_k; /* [links]: scratch of the moment */
} VehicleShape;

/* patches must outlive it. index: of the model in the catalog. */
Status vehicle_shape_create(VehicleShape *out, const Patches *patches, const Model *model, int index,
                            const PartTable *table, const Materials *materials);
void   vehicle_shape_destroy(VehicleShape *shape); /* accepts zeroes */

/* ---- loads ----------------------------------------------------------------------------------- */

/* What heats and cools the nodes of an entity at a moment.
 *
 * At a patch: sun by rays past its own parts and its neighbours, with the ground's shade; sky and ground light;
 * longwave of sky, of ground (in the open, and in its own shade below it), of its other patches, at their
 * temperatures of the step's beginning, and of its neighbours (vehicle_state_private.h); convection by wind and its own
 * speed, to the air's recovery temperature, and where an exhaust flows past it, its own or a neighbour's, to that
 * (vehicle_load_private.h); what is behind it (etc/heat.csv).
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
 *     film plate_film_w_m2k (surface_flux_private.h), with air density^0.8 above
 *     recovery 0.85 v^2 / (2 cp): between the laminar sqrt(Pr) = 0.84 and the turbulent Pr^(1/3) = 0.89 */

/* Weather and ground about a place. */
typedef struct PlaceHeat {
    double air_k, air_density; /* at its height; over that at sea level */
    double wind_enu_mps[3];
    double direct_w_m2, diffuse_w_m2, longwave_w_m2; /* facing the sun; on level ground; down on level ground */
    double sun_d_enu[3];
    double ground_k, under_k; /* in the open; in the shade of the entity */
    double ground_rho;        /* reflectance for sunlight */
    double above_m;           /* of the place over the ground or the water */
    double water_k;           /* surface of water there, or of the sea nearby */
    bool   water;             /* it is water */
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
    float                *lit;       /* [patches]: vehicle_view_sun */
    float          *gas_k, *gas_mps; /* [patches]: of exhaust that flows past, over the air; vehicle_loads fills them */
    float          *sent_w_m2;       /* [patches]: sunlight that they reflect; vehicle_loads fills it */
    const NearView *near;            /* [patches]: what its neighbours take of its views; NULL: nothing */
    float          *near_w_m2, *near_sun_w_m2; /* [patches]: of what is seen of them, on average: longwave, sunlight */
    const JetPath  *jet[near_jet_most];        /* of neighbours; from its own origin */
    const PosedEntity *shade[near_sun_most];   /* neighbours before its sun; likewise */
    int                jets, shades;
    PlaceHeat          place;
    bool               afloat; /* in water, as vehicle_loads finds it */
} VehicleMoment;

/* load[shape->nodes]. view[patches]; temp_k[shape->nodes]: of the patches that others see. */
void vehicle_loads(NetworkLoad *load, VehicleMoment *moment, const PatchView *view, const double *temp_k,
                   const EntityDrives *drives);
/* Sets the conductances of the shape's network to engine and cabin. */
void vehicle_links(const VehicleShape *shape, const EntityDrives *drives);
/* Exhaust of an entity whose origin is at p_enu. */
void vehicle_jet(JetPath *out, const ExhaustJet *exhaust, const double p_enu[3], const double r_enu_from_body[9],
                 const double v_enu_mps[3], const PlaceHeat *place);
/* Of the air that is stopped at a surface, over the air. */
double vehicle_recovery_k(double speed_mps);

#endif
