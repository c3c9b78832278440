/* sensor/radar/radar_targets.c: the echoes of entities: their scattering centres, each with the motion of its part. */
#include "sensor/radar/seeker_radar_private.h"

#include "render/radar/radar_equation.h"
#include "render/radar/signature_error.h"

/* ---- polarisation and motion ---------------------------------------------------------------------- */

static void basis_of(double h_enu[3], double v_enu[3], const Target *t)
{
    double h[3], v[3];
    scatter_basis(h, v, t->antenna.u);
    m3_mul_v3(h_enu, t->r_enu_from_body, h);
    m3_mul_v3(v_enu, t->r_enu_from_body, v);
}

/* Rate at which a node turns by itself, rad/s: it rolls, or spins. */
static double spin_of(const Target *t, int node, double forward_mps)
{
    const ModelNode *of = &t->of->node[node];
    return of->roll_radius_m > 0 ? forward_mps / of->roll_radius_m : t->entity->drives.engine > 0 ? of->spin_rps_moving : 0;
}

void making_target_velocity(double v_enu[3], const Target *t, int node, const double p_body[3])
{
    const SnapshotEntity *e = t->entity;
    double                v_body[3], turned[3];
    v3_cross(v_body, e->w_body_rps, p_body);
    m3_tmul_v3(turned, t->r_enu_from_body, t->v_enu_mps); /* body */
    for (int n = node; n >= 0; n = t->of->node[n].parent) {
        const double rate = spin_of(t, n, turned[0]);
        if (rate == 0) continue;
        double axis[3], lever[3], more[3];
        m3_mul_v3(axis, t->pose[n].r_body_from_node, t->of->node[n].axis);
        v3_scale(axis, rate, axis);
        v3_sub(lever, p_body, t->pose[n].p_body);
        v3_cross(more, axis, lever);
        v3_add(v_body, v_body, more);
    }
    m3_mul_v3(turned, t->r_enu_from_body, v_body);
    v3_add(v_enu, t->v_enu_mps, turned);
}

/* ---- one entity ------------------------------------------------------------------------------------- */

/* Keeps it if it is among the strongest, which are in order. */
static void note_strongest(RadarTruth *truth, const RadarScatterer *of)
{
    int at = truth->strongest_count;
    while (at > 0 && of->hh_m2 + of->vv_m2 > truth->strongest[at - 1].hh_m2 + truth->strongest[at - 1].vv_m2) at--;
    if (at == radar_strongest || !(of->hh_m2 + of->vv_m2 > 0)) return;
    if (truth->strongest_count < radar_strongest) truth->strongest_count++;
    memmove(&truth->strongest[at + 1], &truth->strongest[at], (size_t)(truth->strongest_count - 1 - at) * sizeof *of);
    truth->strongest[at] = *of;
}

static void add_turned(ScatterMatrix *sum, const ScatterMatrix *s, double complex turn)
{
    sum->hh += s->hh * turn, sum->hv += s->hv * turn, sum->vh += s->vh * turn, sum->vv += s->vv * turn;
}

/* power: of the centres, HH and VV together, as cross section. */
static void add_error(RadarTruth *truth, const Centres *centres, const double complex field[3], double power_m2)
{
    SignatureError error;
    signature_error(&error, centres);
    for (int p = 0; p < 3; p++)
        truth->rcs_error_db[p] = truth->given ? NAN : signature_error_db(field[p], p == 2 ? error.cross_m2 : error.same_m2);
    truth->map_error = truth->given ? NAN : 8 * pi_rad * error.same_m2 / power_m2 + signature_cells_error();
}

static void add_truth(RadarTruth *truth, const Making *m, const Target *t, const Sight *sight, const Centres *centres,
                      const bool *seen, const double h_enu[3], const double v_enu[3])
{
    const double  k = 2 * pi_rad / m->preset->antenna.wavelength_m;
    ScatterMatrix whole = {0}, in_sight = {0};
    double        power = 0, seen_power = 0;
    for (int i = 0; i < centres->count; i++) {
        const ScatterCentre *c = &centres->centre[i];
        const double complex phase = CMPLX(cos(k * c->path_m), -sin(k * c->path_m));
        ScatterMatrix        s = c->s;
        add_turned(&whole, &s, phase);
        if (seen[i]) add_turned(&in_sight, &s, phase);
        scatter_turn(&s, h_enu, v_enu, m->right);
        const RadarScatterer one = {4 * pi_rad * scatter_power(s.hh), 4 * pi_rad * scatter_power(s.vv), {c->p[0], c->p[1], c->p[2]}, c->bounce,
                                    c->part, seen[i]};
        power += one.hh_m2 + one.vv_m2;
        if (seen[i]) seen_power += one.hh_m2 + one.vv_m2;
        note_strongest(truth, &one);
    }
    scatter_turn(&whole, h_enu, v_enu, m->right);
    scatter_turn(&in_sight, h_enu, v_enu, m->right);
    const double complex of[3] = {whole.hh, whole.vv, whole.hv};
    for (int p = 0; p < 3; p++) truth->rcs_m2[p] = 4 * pi_rad * scatter_power(of[p]);
    truth->centres = centres->count;
    add_error(truth, centres, of, power);
    truth->visible = power > 0 ? seen_power / power : 0;

    const RadarPreset *preset = m->preset;
    double complex     amplitude[interval_channels];
    making_amplitudes(amplitude, m, sight, &in_sight);
    truth->snr = scatter_power(amplitude[CHANNEL_SUM]) /
                 (receiver_noise_w(&preset->receiver, &preset->wave) * interval_noise_share(m->radar->plan));
    truth->range_rate_mps = making_range_rate(m, sight, t->v_enu_mps);
    truth->appears_m = making_appears_m(m, sight, truth->range_rate_mps);
}

/* *found false: its signature is still to be made. */
static Status find_centres(bool *found, Making *m, Target *t, RadarTruth *truth)
{
    SeekerRadar          *r = m->radar;
    const double          centre_hz = m->preset->wave.centre_hz;
    const GivenSignature *given = given_list_find(r->given, t->entity->id, t->of->name);
    const SignatureLook   direct = signature_look(&t->antenna);
    const Signature      *signature;
    *found = true;
    truth->given = given && given_signature_knows(given, &t->antenna, centre_hz);
    if (truth->given) return given_signature_centres(&r->centres, given, &t->antenna, centre_hz);
    const Status status = signatures_find(&signature, r->signatures, t->model, t->joint, snapshot_damage(t->entity), &direct, m->pool);
    if (status != STATUS_OK) return status;
    *found = signature != NULL;
    t->pose = signatures_pose(r->signatures);
    return signature ? centres_make(&r->centres, signature, &t->antenna, &t->antenna) : STATUS_OK;
}

enum { block_centres = 512 };

typedef struct PointJob {
    const Making  *making;
    const Target  *target;
    const Sight   *sight;              /* of the target's origin */
    ScatterCentre *centre;             /* [count]; turned to the antenna's axes */
    RadarPoint    *point;              /* [count] */
    double         h_enu[3], v_enu[3];
    int            count;
} PointJob;

static void point_block(void *user, int worker, int task)
{
    const PointJob *job = user;
    const Making   *m = job->making;
    const Target   *t = job->target;
    const double    pulse_s = 1 / m->preset->wave.repeat_hz, room_m = 2 * t->of->radius_m;
    const int       end = (task + 1) * block_centres < job->count ? (task + 1) * block_centres : job->count;
    (void)worker;
    for (int i = task * block_centres; i < end; i++) {
        ScatterCentre *c = &job->centre[i];
        RadarPoint    *q = &job->point[i];
        Sight          to;
        m3_mul_v3(q->p_enu, t->r_enu_from_body, c->p);
        v3_add(q->p_enu, q->p_enu, t->p_enu);
        making_sight(&to, m, q->p_enu, 0);
        making_target_velocity(q->v_enu_mps, t, c->part < 0 ? -1 : t->of->part[c->part].node, c->p);
        scatter_turn(&c->s, job->h_enu, job->v_enu, m->right);
        q->same = m->preset->transmits_h ? c->s.hh : c->s.vv;
        q->other = m->preset->transmits_h ? c->s.vh : c->s.hv;
        q->share = 1;
        q->path_m = 2 * (job->sight->range_m - m->reference_m) + c->path_m;
        q->path_per_pulse_m = 2 * (making_range_rate(m, &to, q->v_enu_mps) - m->reference_rate_mps) * pulse_s;
        q->widest = m->widest + room_m / job->sight->range_m;
        q->room_m = room_m;
        q->own = m->after_s != 0;
    }
}

static Status add_target(Making *m, Target *t, const Sight *sight, RadarTruth *truth)
{
    SeekerRadar  *r = m->radar;
    ScatterMatrix field;
    bool          found;
    radar_antenna(&t->antenna, m->p_enu, t->p_enu, t->r_enu_from_body);
    *truth = (RadarTruth){.entity = t->index, .range_m = sight->range_m, .cos_right = sight->cos_right, .cos_down = sight->cos_down};
    Status status = find_centres(&found, m, t, truth);
    if (status != STATUS_OK) return status;
    if (!found) m->missing++;
    if (m->missing > 0) return truth->given ? STATUS_OK : making_bounce(m, t, NULL, truth); /* the rest is asked for alone */
    bool *seen = arena_alloc(m->arena, (size_t)r->centres.count + 1, sizeof *seen);
    if (!seen) return STATUS_NO_MEMORY;
    status = radar_sight_centres(seen, m, t->index, t->p_enu, t->r_enu_from_body, &r->centres);
    if (status != STATUS_OK) return status;

    double h_enu[3], v_enu[3];
    int    count = 0;
    basis_of(h_enu, v_enu, t);
    add_truth(truth, m, t, sight, &r->centres, seen, h_enu, v_enu);
    centres_field(&field, &r->centres, m->preset->wave.centre_hz);
    for (int i = 0; i < r->centres.count; i++)
        if (seen[i]) r->centres.centre[count++] = r->centres.centre[i];
    PointJob job = {m, t, sight, r->centres.centre, points_room(&r->points, count + 1), {0}, {0}, count};
    if (!job.point) return STATUS_NO_MEMORY;
    memcpy(job.h_enu, h_enu, sizeof h_enu);
    memcpy(job.v_enu, v_enu, sizeof v_enu);
    const int blocks = (count + block_centres - 1) / block_centres;
    if (m->pool) pool_run(m->pool, blocks, point_block, &job);
    else for (int b = 0; b < blocks; b++) point_block(&job, 0, b);
    r->points.count += count;
    return truth->given || !(truth->visible > 0) ? STATUS_OK : making_bounce(m, t, &field, truth);
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
    m3_tmul_v3(t->v_enu_mps, frame->r_ecef_from_enu, e->v_ecef_mps);
    v3_add_scaled(t->p_enu, t->p_enu, m->after_s, t->v_enu_mps);
    making_sight(sight, m, t->p_enu, shown->radius_m);
    const double sine = making_off_axis(m, sight), room = shown->radius_m / fmax(sight->range_m, 1);
    if (!sight->within || sine > m->widest + room || sight->range_m < 2 * shown->radius_m) return STATUS_OK;
    t->model = catalog_find(m->radar->catalog, e->type, &origin, NULL);
    t->of = catalog_model(m->radar->catalog, t->model);
    m3_tmul(t->r_enu_from_body, frame->r_ecef_from_enu, e->r_ecef_from_body);
    NodePose *pose = arena_alloc(m->arena, (size_t)t->of->node_count + 1, sizeof *pose);
    t->joint = arena_alloc(m->arena, (size_t)t->of->node_count + 1, sizeof *t->joint);
    if (!pose || !t->joint) return STATUS_NO_MEMORY;
    snapshot_pose(pose, t->joint, m->scene->snapshot, t->index, t->of);
    if (m->scene->joint) memcpy(t->joint, m->scene->joint + e->first_node, (size_t)t->of->node_count * sizeof *t->joint);
    *taken = true;
    return STATUS_OK;
}

static Status each_target(Making *m, RadarTruth **truth, int *count)
{
    const Snapshot *snapshot = m->scene->snapshot;
    Status          status = STATUS_OK;
    *truth = arena_alloc(m->arena, (size_t)snapshot->count + 1, sizeof **truth);
    *count = 0;
    if (!*truth) return STATUS_NO_MEMORY;
    for (int i = 0; i < snapshot->count && status == STATUS_OK; i++) {
        Target t = {.entity = &snapshot->entity[i], .index = i};
        Sight  sight;
        bool   taken;
        status = take_target(&taken, m, &t, &sight);
        if (status == STATUS_OK && taken) status = add_target(m, &t, &sight, &(*truth)[(*count)++]);
    }
    return status;
}

Status making_targets(Making *m)
{
    RadarTruth  *truth;
    const Status status = each_target(m, &truth, &m->frame->targets);
    m->frame->target = truth;
    m->radar->target_points = m->radar->points.count;
    return status;
}

Status making_targets_anew(Making *beam)
{
    RadarTruth *truth;
    int         count;
    return each_target(beam, &truth, &count);
}
