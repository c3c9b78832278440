/* sensor/commands/plant_judge.h: what plants hide, by rays, for an exercise that places vehicles among them. */
#ifndef SENSOR_COMMANDS_PLANT_JUDGE_H
#define SENSOR_COMMANDS_PLANT_JUDGE_H

#include "entities/exercise/hide_judge.h"

typedef struct PlantJudge PlantJudge;

/* Plants as a node with default settings has them. They are grown at the first use, in some seconds. */
Status plant_judge_create(PlantJudge **out, const char *isa);
void   plant_judge_destroy(PlantJudge *judge); /* accepts NULL */
/* For cast_create_judged; the judge must outlive it. */
HideJudge plant_judge_hide(PlantJudge *judge);

#endif
