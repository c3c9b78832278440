/* sensor/node/cigi/cigi_drawn.h: a CIGI host's own entities as entities of the exercise: seen, and targets in the
 * truth. */
#ifndef SENSOR_NODE_CIGI_CIGI_DRAWN_H
#define SENSOR_NODE_CIGI_CIGI_DRAWN_H

#include "entities/table/entity_table.h"
#include "sensor/node/cigi/cigi_scene.h"
#include "sensor/node/cigi/cigi_types.h"

/* One that is in the entity table. */
typedef struct CigiShown {
    uint16_t id;
    bool     stays;                         /* in this frame, too */
    double   t_s, p_ecef[3], v_ecef_mps[3]; /* at the last frame */
} CigiShown;

typedef struct CigiDrawn {
    CigiTypes types;
    uint16_t  site, application; /* of this node: its entity N is site:application:N */
    bool      by_arrival;        /* exercise.causal: entity_table_arrival is called */
    int       count;
    CigiShown shown[cigi_entities_most];
    uint64_t  unmapped;            /* entities whose type has no row; each once */
    uint8_t   told[(1 << 16) / 8]; /* a bit an entity: it was counted there */
} CigiDrawn;

/* Reports to the table, at the time of a frame, every active entity whose type has a row, except those that carry the
 * view, and ends those that are no longer so. Velocity and turning are those of Rate Control, else differences of
 * frames that are at most 1 s apart. Entity 0, and those that DIS has no number for (65534, 65535), are not drawn.
 * Fails for want of memory. */
Status cigi_drawn_show(CigiDrawn *drawn, EntityTable *table, const CigiScene *scene, uint16_t view, double t_s);

#endif
