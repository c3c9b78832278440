/* entities/effects/exhaust_jet.h: the gas of an engine where it leaves a model. */
#ifndef ENTITIES_EFFECTS_EXHAUST_JET_H
#define ENTITIES_EFFECTS_EXHAUST_JET_H

#include "pitviper.h"

typedef struct ExhaustJet {
    double at_body[3], d_body[3];    /* from the centre of the model's base; unit */
    double radius_m, speed_mps;      /* of the jet */
    double excess_k;                 /* over the air, mixed with that of its first metre */
} ExhaustJet;

#endif
