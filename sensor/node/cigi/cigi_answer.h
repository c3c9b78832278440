/* sensor/node/cigi/cigi_answer.h: answers to a CIGI host's requests, from the ground. */
#ifndef SENSOR_NODE_CIGI_CIGI_ANSWER_H
#define SENSOR_NODE_CIGI_CIGI_ANSWER_H

#include "sensor/node/cigi/cigi_scene.h"
#include "terrain/earth/geodesy.h"
#include "terrain/ground/landscape.h"

/* The ground that answers are taken from. landscape NULL: there is none. */
typedef struct CigiGround {
    const Landscape  *landscape;
    const LocalFrame *frame;
} CigiGround;

/* The answer to HAT/HOT, Line of Sight and Sensor Control packets. Heights of terrain are above the ellipsoid; beyond
 * the ground, and by an entity that was not reported, an answer is not valid. Lines of sight are straight, and met by
 * the ground alone, not by plants, buildings or entities; a sensor is always searching: this node has no tracker.
 * False: nothing is to be said. */
bool cigi_answer(CigiPacket *out, const CigiPacket *request, const CigiScene *scene, const CigiGround *ground,
                 uint32_t ig_frame);

#endif
