/* entities/survey/shot.h: one round or missile from its Fire to its Detonation. */
#ifndef ENTITIES_SURVEY_SHOT_H
#define ENTITIES_SURVEY_SHOT_H

#include "dis/pdu.h"

typedef struct Shot {
    DisEntityId firing, target, munition; /* as in Fire; target 0:0:0 when unknown */
    double      fire_s;                   /* NaN: no Fire received */
    double      detonation_s;             /* NaN: no Detonation received */
    double      p_burst_ecef[3];
    DisEntityId hit;                      /* target of the Detonation, 0:0:0: none */
    uint8_t     result;
} Shot;

#endif
