/* sensor/radar/radar_canopy.c: the echoes of plants, from within their crowns. */
#include "sensor/radar/radar_volume.h"

enum { points_most = 400000, least_each = 8, most_each = 256, stream_leaf = 0x43414e00 };

static const double sight_slack_m = 0.05;

typedef struct Canopy {
    const int    *crown;
    int           each;
    double        null;
    ClutterMotion motion[SURFACE_COUNT];
} Canopy;

static int make_crown(RadarPoint *out, const Making *m, void *user, int task)
{
    static _Thread_local VolumePoint point[most_each];
    const Canopy       *canopy = user;
    const SeekerRadar  *r = m->radar;
    const uint32_t      index = (uint32_t)canopy->crown[task];
    const FoliageCrown *crown = foliage_crown(r->foliage, (int)index);
    const double       *origin = foliage_origin(r->foliage), *eye = m->scene->view->p_enu;
    const ClutterRow   *row = &r->clutter.row[crown->surface][r->band];
    const double        across = (double)crown->across_m, up = (double)crown->up_m;
    const double        sigma_m2 = clutter_foliage_volume(row) * 4 / 3.0 * pi_rad * across * across * up / canopy->each;
    const ClutterLook   look = {{eye[0], eye[1], eye[2]}, m->preset->wave.centre_hz, m->scene->t_s, r->wind_mps};
    int                 count = 0;
    for (int i = 0; i < canopy->each; i++) {
        VolumePoint *to = &point[count];
        double       u[3], p[3];
        for (uint64_t k = 0; k < 3; k++) u[k] = random_uniform(r->seed, stream_leaf, index, 3 * (uint64_t)i + k);
        const double radius = cbrt(u[0]), z = 2 * u[1] - 1, level = sqrt(1 - z * z), turn = 2 * pi_rad * u[2];
        p[0] = origin[0] + (double)crown->centre_m[0] + across * radius * level * cos(turn);
        p[1] = origin[1] + (double)crown->centre_m[1] + across * radius * level * sin(turn);
        p[2] = origin[2] + (double)crown->centre_m[2] + up * radius * z;
        making_sight(&to->sight, m, p, 0);
        if (!to->sight.within || making_off_axis(m, &to->sight) > canopy->null) continue;
        ClutterScatterer leaf;
        clutter_draw_leaf(&leaf, row, r->seed, index, (uint32_t)i);
        clutter_see_leaf(&to->s, &leaf, &canopy->motion[crown->surface], sigma_m2, p, &look);
        to->turns = true;
        memset(to->v_enu_mps, 0, sizeof to->v_enu_mps);
        count++;
    }
    return count > 0 ? making_keep(out, point, count, m, sight_slack_m, canopy->null) : 0;
}

/* So many points a crown that some four are in each step of range across the widest of them, fewer where there would be
 * too many of them: by powers of two. */
Status making_canopy(Making *m)
{
    const SeekerRadar *r = m->radar;
    Canopy             canopy = {.null = making_null(m)};
    double             low_m[2], high_m[2], widest_m = 0;
    making_lit_rectangle(low_m, high_m, m);
    const int count = foliage_in(NULL, 0, r->foliage, low_m, high_m);
    int      *crown = arena_alloc(m->arena, (size_t)count + 1, sizeof *crown);
    if (!crown) return STATUS_NO_MEMORY;
    foliage_in(crown, count, r->foliage, low_m, high_m);
    int lit = 0;
    for (int i = 0; i < count; i++) {
        const FoliageCrown *c = foliage_crown(r->foliage, crown[i]);
        const double       *origin = foliage_origin(r->foliage), room_m = fmax((double)c->across_m, (double)c->up_m);
        double              p[3];
        Sight               sight;
        for (int k = 0; k < 3; k++) p[k] = origin[k] + (double)c->centre_m[k];
        making_sight(&sight, m, p, room_m);
        const double room = room_m / fmax(sight.range_m, 1);
        if (!sight.within || making_off_axis(m, &sight) > canopy.null + room) continue;
        widest_m = fmax(widest_m, (double)c->across_m);
        crown[lit++] = crown[i];
    }
    if (lit == 0) return STATUS_OK;
    canopy.crown = crown;
    canopy.each = least_each;
    const double cell_m = 0.5 * light_mps / m->preset->wave.bandwidth_hz;
    const double want = fmin(4 * 2 * widest_m / cell_m, (double)points_most / lit);
    while (canopy.each < want && canopy.each < most_each) canopy.each *= 2;
    for (int s = 0; s < SURFACE_COUNT; s++)
        canopy.motion[s] = clutter_motion(&r->clutter.row[s][r->band], m->preset->wave.centre_hz, r->wind_mps);
    m->frame->crowns = lit;
    return making_points(m, lit, canopy.each, make_crown, &canopy);
}
