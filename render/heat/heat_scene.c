/* render/heat/heat_scene.c: the temperature of the ground of one frame: shade of the hours before, and marks. */
#include "render/heat/heat_scene.h"

static double with_mark(double temp_k, const HeatScene *scene, const MarkedGround *mark, int kind, const double n_enu[3],
                        double taken, double open, double dark)
{
    const HeatNow *now = scene->now;
    if (mark->loose > 0 && ground_kind_loosens(kind))
        temp_k += mark->loose * (heat_ground_k(now, SURFACE_PLOUGHED, n_enu, taken, open, dark) - temp_k);
    if (mark->burnt > 0) temp_k += mark->burnt * (heat_ground_k(now, ground_burnt, n_enu, taken, open, 1) - temp_k);
    return temp_k + mark->add_k;
}

void heat_scene_grounds_k(double temp_k[heat_lanes], double lifted_k[heat_lanes], const HeatScene *scene, const GroundPlaces *at)
{
    const HeatNow *now = scene->now;
    HeatPlaces     place;
    memcpy(place.n_enu, at->n_enu, sizeof place.n_enu);
    memcpy(place.dark, at->dark, sizeof place.dark);
    for (int k = 0; k < heat_lanes; k++) {
        uint8_t shadow[shadow_most_slots];
        place.kind[k] = now->kind_of[at->surface[k]];
        place.open[k] = 1, place.taken[k] = 0;
        if (!scene->shadow) continue;
        shadow_map_at(shadow, &place.open[k], scene->shadow, at->p_enu[0][k], at->p_enu[1][k]);
        const double n_enu[3] = {at->n_enu[0][k], at->n_enu[1][k], at->n_enu[2][k]};
        place.taken[k] = heat_taken(now, place.kind[k], n_enu, shadow);
    }
    heat_grounds_k(temp_k, now, &place);
    for (int k = 0; k < heat_lanes; k++) {
        const double unlit_k = (double)now->table.dark_k[place.kind[k]][heat_ups - 1];
        lifted_k[k] = temp_k[k] > unlit_k ? temp_k[k] - unlit_k : 0;
    }
    for (int k = 0; k < heat_lanes && scene->marks; k++) {
        const double p_enu[3] = {at->p_enu[0][k], at->p_enu[1][k], at->p_enu[2][k]};
        const double n_enu[3] = {at->n_enu[0][k], at->n_enu[1][k], at->n_enu[2][k]};
        MarkedGround mark;
        if (mark_heat_at(&mark, scene->marks, place.kind[k], p_enu, n_enu, 1 - place.taken[k]))
            temp_k[k] = with_mark(temp_k[k], scene, &mark, place.kind[k], n_enu, place.taken[k], place.open[k], at->dark[k]);
    }
}

double heat_scene_ground_k(double *lifted_k, const HeatScene *scene, int surface, const double p_enu[3], const double n_enu[3],
                           double dark)
{
    GroundPlaces at;
    double       temps_k[heat_lanes], lifts_k[heat_lanes];
    for (int k = 0; k < heat_lanes; k++) {
        for (int c = 0; c < 3; c++) at.p_enu[c][k] = p_enu[c], at.n_enu[c][k] = n_enu[c];
        at.surface[k] = surface, at.dark[k] = dark;
    }
    heat_scene_grounds_k(temps_k, lifts_k, scene, &at);
    *lifted_k = lifts_k[0];
    return temps_k[0];
}
