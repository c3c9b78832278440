/* entities/scenery/scenery_traces.c: dust and marks of clutter that drives, and marks of what came and stands. */
#include "entities/scenery/scenery_traces.h"

#include "entities/scenery/scenery_puffs_private.h"
#include "entities/traces/vehicle_traces.h"

/* ---- where it drove ----------------------------------------------------------------------------- */

static double edge_m(const Scenery *s, const SceneryMover *m, int k, double along[3])
{
    const double(*path)[3] = (const double(*)[3])s->path_enu + m->first;
    v3_sub(along, path[(k + 1) % m->count], path[k]);
    return v3_length(along);
}

/* Times follow from the numbers of rounds and corners, not from t_s: stretches of two frames are the same to the bit
 * but for the one that it is on. */
int scenery_driven(SceneryStretch *out, int most, const Scenery *s, const SceneryMover *m, double t_s, double span_s)
{
    double along[3], length_m = 0, at_m = 0;
    int    edge = 0, count = 0;
    for (int k = 0; k < m->count; k++) length_m += edge_m(s, m, k, along);
    if (!(length_m > 0) || !(m->speed_mps > 0)) return 0;
    double       round = floor((m->phase_m + m->speed_mps * t_s) / length_m);
    const double here_m = m->phase_m + m->speed_mps * t_s - round * length_m;
    const double first_s = t_s - fmin(span_s, length_m / m->speed_mps);
    for (double piece_m; edge + 1 < m->count && at_m + (piece_m = edge_m(s, m, edge, along)) <= here_m; edge++)
        at_m += piece_m;
    while (count < most) {
        const double piece_m = edge_m(s, m, edge, along);
        const double a_s = (round * length_m + at_m - m->phase_m) / m->speed_mps, took_s = piece_m / m->speed_mps;
        const double from_s = fmax(a_s, first_s), to_s = fmin(a_s + took_s, t_s);
        if (to_s > from_s) {
            SceneryStretch *o = &out[count++];
            const double   *corner = s->path_enu[m->first + edge];
            *o = (SceneryStretch){.a_s = from_s, .b_s = to_s};
            o->loose = s->path_loose && s->path_loose[m->first + edge];
            v3_add_scaled(o->a_enu, corner, (from_s - a_s) / took_s, along);
            v3_add_scaled(o->b_enu, corner, (to_s - a_s) / took_s, along);
        }
        if (a_s <= first_s) break;
        if (edge-- == 0) edge = m->count - 1, round--, at_m = length_m;
        at_m -= edge_m(s, m, edge, along);
        if (edge == 0) at_m = 0;
    }
    return count;
}

static bool any_loose(const Scenery *s, const SceneryMover *m)
{
    bool loose = false;
    for (int k = 0; k < m->count && s->path_loose && !loose; k++) loose = s->path_loose[m->first + k];
    return loose;
}

/* Movers with soil on their way, in view, the nearest first. */
static Status movers_near(SceneryNear **out, int *count, const Scenery *s, const SceneryCone *seen, double t_s,
                          double beside_m, double reach_m, int most, Arena *arena)
{
    *count = 0;
    *out = arena_alloc(arena, (size_t)s->movers + 1, sizeof **out);
    if (!*out) return STATUS_NO_MEMORY;
    for (int k = 0; k < s->movers; k++) {
        double p_enu[3], r[9];
        if (!any_loose(s, &s->mover[k])) continue;
        scenery_pose(p_enu, r, s, &s->mover[k], t_s);
        (*out)[*count].which = k;
        *count += scenery_in_cone(&(*out)[*count].range_m, seen, p_enu, beside_m, reach_m);
    }
    *count = scenery_nearest(*out, *count, most);
    return STATUS_OK;
}

/* ---- dust --------------------------------------------------------------------------------------- */

static void dust_of(EffectSource *out, const Scenery *s, const SceneryMover *m, const SceneryStretch *way,
                    const LocalFrame *frame)
{
    static const double   raises_at_mps = 10;
    static const uint64_t no_entity = UINT64_C(1) << 63;
    const SceneryObject  *o = &s->object[m->object];
    const Model          *model = &s->model[o->model];
    double                forward[3], right[3], down[3], r_enu_from_body[9], v_enu_mps[3];
    v3_sub(v_enu_mps, way->b_enu, way->a_enu);
    v3_scale(v_enu_mps, 1 / (way->b_s - way->a_s), v_enu_mps);
    v3_scale(forward, 1 / v3_length(v_enu_mps), v_enu_mps);
    if (!v3_normalize(right, (const double[3]){forward[1], -forward[0], 0})) right[0] = 1, right[1] = 0, right[2] = 0;
    v3_cross(down, forward, right);
    for (int k = 0; k < 3; k++)
        r_enu_from_body[3 * k] = forward[k], r_enu_from_body[3 * k + 1] = right[k],
                            r_enu_from_body[3 * k + 2] = down[k];
    *out = (EffectSource){.key = o->id | no_entity,
                          .from_s = way->a_s,
                          .to_s = way->b_s,
                          .motion = {.algorithm = 2},
                          .motion_s = way->a_s,
                          .hold_s = way->b_s - way->a_s,
                          .speed_mps = m->speed_mps,
                          .scale = vehicle_effect_scale(model),
                          .rate = vehicle_trail_rate[1] * fmin(pow(m->speed_mps / raises_at_mps, 1.5), 2)};
    vehicle_dust(out, model, 0);
    ecef_from_enu(out->motion.p_ecef, frame, way->a_enu);
    m3_mul_v3(out->motion.v_mps, frame->r_ecef_from_enu, v_enu_mps);
    m3_mul(out->motion.r_ecef_from_body, frame->r_ecef_from_enu, r_enu_from_body);
}

Status scenery_dust(Snapshot *s, const Scenery *scenery, const LocalFrame *frame, const SceneryCone *seen, Arena *arena)
{
    static const double trail_m = 250; /* as far as dust hangs behind what is fast, in a wind */
    SceneryNear        *near;
    int                 count, sources = 0;
    if (scenery->movers == 0 || !s->effect_table || !scenery->smokes) return STATUS_OK;
    Status status =
        movers_near(&near, &count, scenery, seen, s->t_s, trail_m, scenery_dusts_m, scenery_dusts_most, arena);
    if (status != STATUS_OK || count == 0) return status;
    EffectSource *source = arena_alloc(arena, (size_t)count * scenery_trail_pieces, sizeof *source);
    if (!source) return STATUS_NO_MEMORY;
    for (int k = 0; k < count; k++) {
        const SceneryMover *m = &scenery->mover[near[k].which];
        SceneryStretch      way[scenery_trail_pieces];
        const Model        *model = &scenery->model[scenery->object[m->object].model];
        const double        life_s = effect_life_s(s->effect_table, EFFECT_DUST, vehicle_effect_scale(model));
        const int           ways = scenery_driven(way, scenery_trail_pieces, scenery, m, s->t_s, life_s);
        for (int n = 0; n < ways; n++) {
            if (!way[n].loose) continue;
            dust_of(&source[sources], scenery, m, &way[n], frame);
            if (n == 0) source[sources].to_s = INFINITY; /* it goes on: a puff may be of this very moment */
            sources++;
        }
    }
    return scenery_add_puffs(s, source, sources, arena);
}

/* ---- marks -------------------------------------------------------------------------------------- */

static bool is_tracked(const Model *model)
{
    bool tracked = false;
    for (int p = 0; p < model->part_count; p++) tracked |= model->part[p].role == HEAT_TRACK;
    return tracked;
}

typedef struct Marks {
    GroundTrack      *track;
    int               count;
    const Scenery    *scenery;
    const LocalFrame *frame;
} Marks;

static void put(Marks *m, int object, const double a_enu[3], const double b_enu[3], double a_s, double b_s)
{
    const Model *model = &m->scenery->model[m->scenery->object[object].model];
    GroundTrack *track = &m->track[m->count++];
    *track = vehicle_track(model, is_tracked(model));
    ecef_from_enu(track->a_ecef, m->frame, a_enu);
    ecef_from_enu(track->b_ecef, m->frame, b_enu);
    track->a_s = a_s, track->b_s = b_s;
}

static Status ruts_near(SceneryNear **out, int *count, const Scenery *s, const double eye_enu[3], Arena *arena)
{
    *count = 0;
    *out = arena_alloc(arena, (size_t)s->ruts + 1, sizeof **out);
    if (!*out) return STATUS_NO_MEMORY;
    for (int k = 0; k < s->ruts; k++) {
        double to[3];
        v3_sub(to, s->rut[k].b_enu, eye_enu);
        (*out)[*count] = (SceneryNear){v3_length(to), k};
        *count += (*out)[*count].range_m < scenery_tracks_m;
    }
    if (*count > scenery_ruts_most) *count = scenery_nearest(*out, *count, scenery_ruts_most);
    return STATUS_OK;
}

Status scenery_marks(GroundMarks *out, const GroundMarks *own, const Scenery *s, const LocalFrame *frame,
                     const double eye_enu[3], double t_s, Arena *arena)
{
    static const double came_mps = 3; /* of what came and stands */
    SceneryNear        *mover, *rut;
    int                 movers, ruts;
    *out = *own;
    if (s->movers == 0 && s->ruts == 0) return STATUS_OK;
    const SceneryCone about = {.p_enu = {eye_enu[0], eye_enu[1], eye_enu[2]}};
    Status            status =
        movers_near(&mover, &movers, s, &about, t_s, scenery_tracks_m, scenery_tracks_m, scenery_trails_most, arena);
    if (status == STATUS_OK) status = ruts_near(&rut, &ruts, s, eye_enu, arena);
    if (status != STATUS_OK || movers + ruts == 0) return status;
    const size_t room = (size_t)own->tracks + (size_t)movers * scenery_trail_pieces + (size_t)ruts;
    Marks        marks = {.count = own->tracks, .scenery = s, .frame = frame};
    marks.track = arena_alloc(arena, room, sizeof *marks.track);
    if (!marks.track) return STATUS_NO_MEMORY;
    if (own->tracks) memcpy(marks.track, own->track, (size_t)own->tracks * sizeof *marks.track);
    for (int k = 0; k < movers; k++) {
        SceneryStretch      way[scenery_trail_pieces];
        const SceneryMover *m = &s->mover[mover[k].which];
        const int           ways = scenery_driven(way, scenery_trail_pieces, s, m, t_s, INFINITY);
        for (int n = 0; n < ways; n++)
            if (way[n].loose) put(&marks, m->object, way[n].a_enu, way[n].b_enu, way[n].a_s, way[n].b_s);
    }
    for (int k = 0; k < ruts; k++) {
        const SceneryRut *r = &s->rut[rut[k].which];
        double            along[3];
        v3_sub(along, r->b_enu, r->a_enu);
        const double b_s = -(double)r->came_s;
        put(&marks, r->object, r->a_enu, r->b_enu, b_s - v3_length(along) / came_mps, b_s);
    }
    out->track = marks.track, out->tracks = marks.count;
    return STATUS_OK;
}
