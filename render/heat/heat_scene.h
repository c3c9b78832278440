/* render/heat/heat_scene.h: the heat of the ground in one frame. */
#ifndef RENDER_HEAT_HEAT_SCENE_H
#define RENDER_HEAT_HEAT_SCENE_H

#include "render/heat/mark_heat.h"
#include "render/heat/shadow_map.h"

typedef struct HeatScene {
    const HeatNow   *now;
    const ShadowMap *shadow; /* NULL: nothing shaded it */
    const MarkHeat  *marks;  /* NULL: none */
} HeatScene;

/* Places of the ground side by side: class, place, normal, and absorptance over that of the kind. */
typedef struct GroundPlaces {
    int    surface[heat_lanes];
    double p_enu[3][heat_lanes], n_enu[3][heat_lanes], dark[heat_lanes];
} GroundPlaces;

/* Temperatures of the ground, K, at the height of the weather's thermometer, and how far the sun of the past lifted them. A
 * lane's depends on its place alone. */
void heat_scene_grounds_k(double temp_k[heat_lanes], double lifted_k[heat_lanes], const HeatScene *scene, const GroundPlaces *at);

/* The same of one place. */
double heat_scene_ground_k(double *lifted_k, const HeatScene *scene, int surface, const double p_enu[3], const double n_enu[3],
                           double dark);

#endif
