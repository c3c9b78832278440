/* sensor/node/woods_choice.h: where plants stand in a run: about the aim, clear of what the exercise says.
 *
 * On invented ground no plant stands on the path of anything on the ground, where a burst hit it, or where a flight or
 * the line of sight of a shot that hit passes low, as far as these are known when the world is made. Real trees stay;
 * entities that begin within a trunk are counted. */
#ifndef SENSOR_NODE_WOODS_CHOICE_H
#define SENSOR_NODE_WOODS_CHOICE_H

#include "sensor/node/choices.h"
#include "terrain/woods/woods.h"

typedef struct WoodsChoice {
    bool        on;                  /* terrain.woods */
    WoodsConfig config;
    WoodsPath  *path;                /* config.path */
    Woods       woods;
    int         entities, in_trunks; /* on the ground at their first report; of these within a trunk */
} WoodsChoice;

/* The landscape must outlive it. With terrain.woods off: not on, nothing is done. woods_choice_free after success and
 * failure. */
Status choose_woods(WoodsChoice *out, Choices *choices, const Survey *survey, const Config *config,
                    const Landscape *landscape, const Catalog *catalog, const HostPlan *plan, Pool *pool);
void   woods_choice_free(WoodsChoice *woods);

#endif
