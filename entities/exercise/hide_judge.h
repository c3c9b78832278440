/* entities/exercise/hide_judge.h: who can tell what plants hide: a tracer of a room above, which entities do not know.
 */
#ifndef ENTITIES_EXERCISE_HIDE_JUDGE_H
#define ENTITIES_EXERCISE_HIDE_JUDGE_H

#include "terrain/woods/woods.h"

typedef struct HideJudge {
    void *user;
    /* Woods that the following rays are of, until end. */
    Status (*begin)(void *user, const Woods *woods);
    void (*end)(void *user);
    /* dark[k] 1: a plant is met by the ray within far_m; the rays belong to an eye at eye_enu. */
    Status (*dark)(void *user, uint8_t *dark, const double eye_enu[3], int count, const double *const o_enu[3],
                   const double *const d_enu[3], double far_m);
} HideJudge;

#endif
