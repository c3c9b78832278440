/* sensor/radar/radar_hidden.c: what is before the places that an antenna looks at. */
#include "sensor/radar/seeker_radar_private.h"

void making_hidden(bool *hidden, const Making *m, const double from_enu[3], const Sight *sight,
                   const double *slack_m, int count, int own)
{
    static _Thread_local Rays rays;
    static _Thread_local Hits hits;
    VisibilityCounters        counters = {0};
    rays.count = count;
    rays.columns = 0;
    for (int i = 0; i < count; i++) {
        hidden[i] = false;
        rays.far_m[i] = sight[i].range_m;
        for (int k = 0; k < 3; k++) {
            rays.o_enu[k][i] = from_enu[k];
            rays.d_enu[k][i] = sight[i].d_enu[k];
        }
    }
    visibility_first_hit(&hits, m->visibility, &rays, NULL, -1, m->scene->hidden, &counters);
    for (int i = 0; i < hits.count; i++) {
        const int  ray = hit_ray(&hits, i);
        const bool before = hits.kind[i] != hit_sky && sight[ray].range_m - hits.range_m[i] > slack_m[ray];
        if (before && (own < 0 || (int)hits.entity[i] != own + 1)) hidden[ray] = true;
    }
}
