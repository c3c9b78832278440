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

/* Temperature of ground of a class at a place, K, at the height of the weather's thermometer, and how far the sun of the past
 * lifted it. dark: its absorptance over that of its kind. */
static inline double heat_scene_ground_k(double *lifted_k, const HeatScene *scene, int surface, const double p_enu[3],
                                         const double n_enu[3], double dark)
{
    const HeatNow *now = scene->now;
    const int      kind = now->kind_of[surface];
    uint8_t        shadow[shadow_most_slots];
    double         open = 1, taken = 0;
    if (scene->shadow) {
        shadow_map_at(shadow, &open, scene->shadow, p_enu[0], p_enu[1]);
        taken = heat_taken(now, kind, n_enu, shadow);
    }
    double       temp_k = heat_ground_k(now, kind, n_enu, taken, open, dark);
    MarkedGround mark;
    *lifted_k = fmax(temp_k - (double)now->table.dark_k[kind][heat_ups - 1], 0);
    if (!scene->marks || !mark_heat_at(&mark, scene->marks, kind, p_enu, n_enu, 1 - taken)) return temp_k;
    if (mark.loose > 0 && ground_kind_loosens(kind))
        temp_k += mark.loose * (heat_ground_k(now, SURFACE_PLOUGHED, n_enu, taken, open, dark) - temp_k);
    if (mark.burnt > 0) temp_k += mark.burnt * (heat_ground_k(now, ground_burnt, n_enu, taken, open, 1) - temp_k);
    return temp_k + mark.add_k;
}

#endif
