/* sensor/node/cigi/cigi_scene.h: what a CIGI host says of entities and views, and where a view's eye is by it.
 *
 * Entity axes: forward, right, down; yaw, pitch and roll turn them, in this order, from north, east, down at the place
 * of the entity, or from its parent's axes. A view's axes are turned likewise from those of its entity. Heights are
 * above the ellipsoid of WGS 84. */
#ifndef SENSOR_NODE_CIGI_CIGI_SCENE_H
#define SENSOR_NODE_CIGI_CIGI_SCENE_H

#include "dis/cigi/cigi.h"

enum { cigi_entities_most = 256, cigi_views_most = 32 };

/* The last of each; those beyond the capacity are refused. Zeroed: none. */
typedef struct CigiScene {
    int               entity_count, view_count;
    CigiEntityControl entity[cigi_entities_most];
    CigiRateControl   rate[cigi_entities_most];  /* of that entity */
    bool              rated[cigi_entities_most]; /* whether Rate Control was sent for it */
    CigiViewControl   view[cigi_views_most];     /* group: that of its View Definition */
    uint64_t          refused;                   /* out of range, or beyond the capacity */
} CigiScene;

/* Entity Control, Rate Control, View Control and View Definition; others change nothing. Rate Control of an articulated
 * part, and of an entity that was not reported, changes nothing either. False: refused. */
bool cigi_scene_take(CigiScene *scene, const CigiPacket *packet);

/* Place and attitude of an entity. False: it, or a parent, was never reported, or parents go in a circle. */
bool cigi_scene_entity(double p_ecef[3], double r_ecef_from_body[9], const CigiScene *scene, uint16_t id);
/* Velocity of an entity, and how it turns, in ECEF, as Rate Control says. False: it does not, or the entity is attached
 * to another. */
bool cigi_scene_rates(double v_ecef_mps[3], double w_ecef_rps[3], const CigiScene *scene, uint16_t id);
/* Velocity of a view's eye, which is mounted on its entity. False: as above. */
bool cigi_scene_view_rates(double v_ecef_mps[3], double w_ecef_rps[3], const CigiScene *scene, uint16_t view);
/* Whether an entity is that of the view, or a parent of it. */
bool cigi_scene_carries(const CigiScene *scene, uint16_t view, uint16_t id);
/* Of a view's eye; a view that no View Control was sent for is on entity 0, along its axes. */
bool cigi_scene_view(double p_ecef[3], double r_ecef_from_view[9], const CigiScene *scene, uint16_t view);
/* A place of a request: latitude and longitude in degrees and height, or by_entity: an offset in an entity's axes. Its
 * axes, for directions, are north, east, down, or the entity's. */
bool cigi_scene_place(double p_ecef[3], double r_ecef_from_axes[9], const CigiScene *scene, const double p[3],
                      bool by_entity, uint16_t entity);

#endif
