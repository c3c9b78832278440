/* entities/scenery/scenery.c: names of clutter, and where what drives is. */
#include "entities/scenery/scenery.h"

#include <stdlib.h>

const char *scenery_class_name(SceneryClass of)
{
    static const char *const name[CLUTTER_CLASSES] = {"none",    "car",     "van",   "lorry", "tractor",  "generator",
                                                      "machine", "trailer", "wreck", "fire",  "heap",     "animal",
                                                      "rock",    "crates",  "tent",  "bale",  "container"};
    return of < CLUTTER_CLASSES ? name[of] : "none";
}

void scenery_free(Scenery *scenery)
{
    for (int k = 0; k < scenery->models; k++) model_destroy(&scenery->model[k]);
    free(scenery->model), free(scenery->object), free(scenery->state), free(scenery->mover);
    free(scenery->path_enu), free(scenery->path_loose), free(scenery->rut), free(scenery->part_of),
        free(scenery->part_first), free(scenery->lamp), free(scenery->harm);
    *scenery = (Scenery){0};
}

void scenery_pose(double p_enu[3], double r_enu_from_body[9], const Scenery *scenery, const SceneryMover *mover,
                  double t_s)
{
    const double(*path)[3] = (const double(*)[3])scenery->path_enu + mover->first;
    double length_m = 0;
    for (int k = 0; k < mover->count; k++) {
        const double *a = path[k], *b = path[(k + 1) % mover->count];
        length_m += sqrt((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]) + (b[2] - a[2]) * (b[2] - a[2]));
    }
    double left_m = length_m > 0 ? fmod(mover->phase_m + mover->speed_mps * t_s, length_m) : 0;
    left_m += left_m < 0 ? length_m : 0;
    for (int k = 0; k < mover->count; k++) {
        const double *a = path[k], *b = path[(k + 1) % mover->count];
        double        along[3], forward[3], right[3], down[3];
        v3_sub(along, b, a);
        const double piece_m = sqrt(v3_dot(along, along));
        if (left_m > piece_m && k + 1 < mover->count) {
            left_m -= piece_m;
            continue;
        }
        v3_add_scaled(p_enu, a, piece_m > 0 ? fmin(left_m / piece_m, 1) : 0, along);
        if (!v3_normalize(forward, along)) forward[0] = 0, forward[1] = 1, forward[2] = 0;
        if (!v3_normalize(right, (const double[3]){forward[1], -forward[0], 0}))
            right[0] = 1, right[1] = 0, right[2] = 0;
        v3_cross(down, forward, right);
        for (int r = 0; r < 3; r++)
            r_enu_from_body[3 * r] = forward[r], r_enu_from_body[3 * r + 1] = right[r],
                                r_enu_from_body[3 * r + 2] = down[r];
        return;
    }
}

int scenery_damage(const Scenery *scenery, int object, double t_s)
{
    int damage = scenery->object[object].damage;
    for (int k = 0; k < scenery->harms; k++) {
        const SceneryHarm *h = &scenery->harm[k];
        if (h->object == object && h->t_s <= t_s && h->damage > damage) damage = h->damage;
    }
    return damage;
}
