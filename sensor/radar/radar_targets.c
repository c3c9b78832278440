/* sensor/radar/radar_targets.c: the echoes of entities: their scattering centres, each with the motion of its part. */
#include "sensor/radar/seeker_radar_private.h"

#include "render/radar/radar_equation.h"

enum { sight_points = 27 };

/* An entity at work. */
typedef struct Target {
    const SnapshotEntity *entity;
    int            index, model;            /* in the snapshot; in the radar's catalog */
    const Model   *of;
    double         p_enu[3], v_enu_mps[3], r_enu_from_body[9];
    ScatterAntenna antenna;                 /* seen from it */
    const NodePose *pose;                   /* [node_count], body axes, as in its list of hits */
    double        *joint;
} Target;

/* ---- polarisation and motion ---------------------------------------------------------------------- */

static void basis_of(double h_enu[3], double v_enu[3], const Target *t)
{
    double h[3], v[3];
    scatter_basis(h, v, t->antenna.u);
    m3_mul_v3(h_enu, t->r_enu_from_body, h);
    m3_mul_v3(v_enu, t->r_enu_from_body, v);
}

/* Velocity of a point of a node, ENU: of the entity, its turning, and what spins and rolls on it. */
static void velocity_of(double v_enu[3], const Target *t, int node, const double p_body[3])
{
    const SnapshotEntity *e = t->entity;
    double                v_body[3], turned[3];
    v3_cross(v_body, e->w_body_rps, p_body);
    m3_tmul_v3(turned, t->r_enu_from_body, t->v_enu_mps); /* body */
    for (int n = node; n >= 0; n = t->of->node[n].parent) {
        const ModelNode *of = &t->of->node[n];
        const double     rate = of->roll_radius_m > 0 ? turned[0] / of->roll_radius_m
                                : e->drives.engine > 0 ? of->spin_rps_moving
                                                       : 0;
        if (rate == 0) continue;
        double axis[3], lever[3], more[3];
        m3_mul_v3(axis, t->pose[n].r_body_from_node, of->axis);
        v3_scale(axis, rate, axis);
        v3_sub(lever, p_body, t->pose[n].p_body);
        v3_cross(more, axis, lever);
        v3_add(v_body, v_body, more);
    }
    m3_mul_v3(turned, t->r_enu_from_body, v_body);
    v3_add(v_enu, t->v_enu_mps, turned);
}

/* ---- what is in its way --------------------------------------------------------------------------- */

/* Share of the sight lines to points of its box that nothing but itself meets before. */
static double visible_share(const Making *m, const Target *t, const Model *model)
{
    static _Thread_local Rays rays;
    static _Thread_local Hits hits;
    VisibilityCounters        counters = {0};
    double                    box[2][3];
    for (int k = 0; k < 3; k++) {
        box[0][k] = model->box_low[k];
        box[1][k] = model->box_high[k];
    }
    rays.count = sight_points;
    rays.columns = 0;
    for (int i = 0; i < sight_points; i++) {
        const int at[3] = {i % 3, i / 3 % 3, i / 9};
        double    p_body[3], p[3], d[3];
        for (int k = 0; k < 3; k++) p_body[k] = box[0][k] + (box[1][k] - box[0][k]) * (at[k] + 0.5) / 3;
        m3_mul_v3(p, t->r_enu_from_body, p_body);
        v3_add(p, p, t->p_enu);
        v3_sub(d, p, m->scene->view->p_enu);
        rays.far_m[i] = v3_length(d);
        v3_normalize(d, d);
        for (int k = 0; k < 3; k++) {
            rays.o_enu[k][i] = m->scene->view->p_enu[k];
            rays.d_enu[k][i] = d[k];
        }
    }
    visibility_first_hit(&hits, m->visibility, &rays, NULL, -1, m->scene->hidden, &counters);
    bool hidden[sight_points] = {false};
    for (int i = 0; i < hits.count; i++) {
        const int ray = hit_ray(&hits, i);
        if (hits.kind[i] != hit_sky && hits.range_m[i] < rays.far_m[i] && (int)hits.entity[i] != t->index + 1) hidden[ray] = true;
    }
    int seen = 0;
    for (int i = 0; i < sight_points; i++) seen += !hidden[i];
    return (double)seen / sight_points;
}

/* ---- one entity ------------------------------------------------------------------------------------- */

static void add_truth(RadarTruth *truth, const Making *m, const Target *t, const Sight *sight, const Centres *centres,
                      const double h_enu[3], const double v_enu[3])
{
    const double  k = 2 * pi_rad / m->preset->antenna.wavelength_m;
    ScatterMatrix whole = {0};
    for (int i = 0; i < centres->count; i++) {
        const ScatterCentre *c = &centres->centre[i];
        const double complex phase = cexp(-I * k * c->path_m);
        ScatterMatrix        s = c->s;
        whole.hh += s.hh * phase, whole.hv += s.hv * phase, whole.vh += s.vh * phase, whole.vv += s.vv * phase;
        scatter_turn(&s, h_enu, v_enu, m->right);
        const double vv_m2 = 4 * pi_rad * pow(cabs(s.vv), 2);
        if (vv_m2 > truth->strongest_m2) {
            truth->strongest_m2 = vv_m2;
            memcpy(truth->strongest_body, c->p, sizeof c->p);
            truth->strongest_bounce = c->bounce;
            truth->strongest_part = c->part;
        }
    }
    scatter_turn(&whole, h_enu, v_enu, m->right);
    const double complex of[3] = {whole.hh, whole.vv, whole.hv};
    for (int p = 0; p < 3; p++) truth->rcs_m2[p] = 4 * pi_rad * pow(cabs(of[p]), 2);
    truth->centres = centres->count;

    const RadarPreset *preset = m->preset;
    double complex     amplitude[interval_channels];
    making_amplitudes(amplitude, m, sight, &whole);
    const double share = truth->visible * pow(cabs(amplitude[CHANNEL_SUM]), 2);
    truth->snr = share / (receiver_noise_w(&preset->receiver, &preset->wave) * interval_noise_share(m->radar->plan));
    truth->range_rate_mps = making_range_rate(m, sight, t->v_enu_mps);
}

static Status add_target(Making *m, Target *t, const Sight *sight, RadarTruth *truth)
{
    const RadarPreset *p = m->preset;
    const TotalField  *field;
    SeekerRadar       *r = m->radar;
    const double       interval_s = p->wave.pulses / p->wave.repeat_hz, pulse_s = 1 / p->wave.repeat_hz;
    double             across_mps[3], v[3];
    radar_antenna(&t->antenna, m->scene->view->p_enu, t->p_enu, t->r_enu_from_body);
    *truth = (RadarTruth){.entity = t->index, .range_m = sight->range_m, .cos_right = sight->cos_right, .cos_down = sight->cos_down,
                          .visible = visible_share(m, t, t->of)};
    Status status = signatures_find(&field, r->signatures, t->model, t->joint, snapshot_damage(t->entity), &t->antenna, m->pool);
    if (status != STATUS_OK) return status;
    t->pose = signatures_target(r->signatures)->pose;

    v3_sub(v, t->v_enu_mps, m->scene->v_enu_mps);
    v3_add_scaled(across_mps, v, -v3_dot(v, sight->d_enu), sight->d_enu);
    const double span_s = interval_s + 2 * making_wait_s(m, sight);
    const double turn_rad = span_s * (v3_length(across_mps) / sight->range_m + v3_length(t->entity->w_body_rps));
    status = centres_make(&r->centres, field, &t->antenna, &t->antenna,
                          &(CentresConfig){.frequency_hz = p->wave.centre_hz, .bandwidth_hz = p->wave.bandwidth_hz,
                                           .turn_rad = turn_rad, .phase_rad = 0.1});
    if (status != STATUS_OK) return status;

    double h_enu[3], v_enu[3];
    basis_of(h_enu, v_enu, t);
    add_truth(truth, m, t, sight, &r->centres, h_enu, v_enu);
    if (!(truth->visible > 0)) return STATUS_OK;
    RadarPoint *point = points_room(&r->points, r->centres.count);
    if (!point) return STATUS_NO_MEMORY;
    const double room_m = 2 * t->of->radius_m, widest = m->widest + room_m / sight->range_m;
    for (int i = 0; i < r->centres.count; i++) {
        ScatterCentre *c = &r->centres.centre[i];
        RadarPoint    *q = &point[i];
        Sight          to;
        m3_mul_v3(q->p_enu, t->r_enu_from_body, c->p);
        v3_add(q->p_enu, q->p_enu, t->p_enu);
        making_sight(&to, m, q->p_enu, 0);
        velocity_of(q->v_enu_mps, t, t->of->part[c->part].node, c->p);
        scatter_turn(&c->s, h_enu, v_enu, m->right);
        q->same = p->transmits_h ? c->s.hh : c->s.vv;
        q->other = p->transmits_h ? c->s.vh : c->s.hv;
        q->share = sqrt(truth->visible);
        q->path_m = 2 * (sight->range_m - m->frame->reference_m) + c->path_m;
        q->path_per_pulse_m = 2 * (making_range_rate(m, &to, q->v_enu_mps) - m->frame->reference_rate_mps) * pulse_s;
        q->widest = widest;
        q->room_m = room_m;
    }
    r->points.count += r->centres.count;
    return STATUS_OK;
}

/* False: it cannot be seen by this radar. */
static Status take_target(bool *taken, Making *m, Target *t, Sight *sight)
{
    const SnapshotEntity *e = t->entity;
    const LocalFrame     *frame = &m->scene->world->frame;
    Origin                origin;
    *taken = false;
    if (t->index == m->scene->hidden) return STATUS_OK;
    const Model *shown = catalog_model(m->scene->world->catalog, e->model);
    if (!catalog_has_shape(m->scene->world->catalog, e->model)) return STATUS_OK;
    enu_from_ecef(t->p_enu, frame, e->p_ecef);
    making_sight(sight, m, t->p_enu, shown->radius_m);
    const double sine = making_off_axis(m, sight), room = shown->radius_m / fmax(sight->range_m, 1);
    if (!sight->within || sine > m->widest + room || sight->range_m < 2 * shown->radius_m) return STATUS_OK;
    t->model = catalog_find(m->radar->catalog, e->type, &origin, NULL);
    t->of = catalog_model(m->radar->catalog, t->model);
    m3_tmul_v3(t->v_enu_mps, frame->r_ecef_from_enu, e->v_ecef_mps);
    m3_tmul(t->r_enu_from_body, frame->r_ecef_from_enu, e->r_ecef_from_body);
    NodePose *pose = arena_alloc(m->arena, (size_t)t->of->node_count + 1, sizeof *pose);
    t->joint = arena_alloc(m->arena, (size_t)t->of->node_count + 1, sizeof *t->joint);
    if (!pose || !t->joint) return STATUS_NO_MEMORY;
    snapshot_pose(pose, t->joint, m->scene->snapshot, t->index, t->of);
    *taken = true;
    return STATUS_OK;
}

Status making_targets(Making *m)
{
    const Snapshot *snapshot = m->scene->snapshot;
    RadarTruth     *truth = arena_alloc(m->arena, (size_t)snapshot->count + 1, sizeof *truth);
    Status          status = truth ? STATUS_OK : STATUS_NO_MEMORY;
    m->frame->target = truth;
    for (int i = 0; i < snapshot->count && status == STATUS_OK; i++) {
        Target t = {.entity = &snapshot->entity[i], .index = i};
        Sight  sight;
        bool   taken;
        status = take_target(&taken, m, &t, &sight);
        if (status == STATUS_OK && taken) status = add_target(m, &t, &sight, &truth[m->frame->targets++]);
    }
    return status;
}
