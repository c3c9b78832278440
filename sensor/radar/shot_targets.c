/* sensor/radar/shot_targets.c: the echoes of entities: their scattering centres, each with the motion of its part. */
#include "sensor/radar/seeker_radar_private.h"
#include "render/scattering/paths/radar_path.h"

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
    return of->roll_radius_m > 0          ? forward_mps / of->roll_radius_m
           : t->entity->drives.engine > 0 ? of->spin_rps_moving
                                          : 0;
}

bool shot_target_spins(const Target *t, int node, double forward_mps)
{
    for (int n = node; n >= 0; n = t->of->node[n].parent)
        if (spin_of(t, n, forward_mps) != 0) return true;
    return false;
}

void shot_target_velocity(double v_enu[3], const Target *t, int node, const double p_body[3])
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

/* A centre as the antenna sees it, turned to its axes. */
typedef struct CentreView {
    double complex same, other; /* received as transmitted, and in the other polarisation */
    double complex wave;        /* exp(-j k path) */
    double         hh_m2, vv_m2;
} CentreView;

/* Keeps a scatterer if it is among the strongest, which are in order. */
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

/* power: that of the centres as a cross section, HH and VV together. */
static void add_error(RadarTruth *truth, const Centres *centres, const double complex field[3], double power_m2)
{
    SignatureError error;
    signature_error(&error, centres);
    for (int p = 0; p < 3; p++)
        truth->rcs_error_db[p] =
            truth->given ? NAN : signature_error_db(field[p], p == 2 ? error.cross_m2 : error.same_m2);
    truth->map_error = truth->given ? NAN : 8 * pi_rad * error.same_m2 / power_m2 + signature_cells_error();
    if (!truth->coarse) return;
    for (int p = 0; p < 3; p++) truth->rcs_error_db[p] = coarse_error_db();
    truth->map_error = 2; /* phases of no relation */
}

/* The centres of one entity, in blocks. */
typedef struct CentreJob {
    const RadarShot     *shot;
    const Target        *target;
    const Sight         *sight;  /* of the target's origin */
    const ScatterCentre *centre; /* [count] */
    CentreView          *view;   /* [count] */
    const int           *shown;  /* [points]: the centres in sight */
    RadarPoint          *point;  /* [points] */
    bool                *spins;  /* [points] */
    double (*x)[merge_axes];
    double h_enu[3], v_enu[3];
    int    count, points;
} CentreJob;

/* field: that of the target, in the bases of its body. */
static void add_truth(RadarTruth *truth, ScatterMatrix *field, const CentreJob *job, const bool *seen)
{
    const RadarShot  *shot = job->shot;
    const Centres    *centres = &shot->radar->centres;
    const CentreView *view = job->view;
    ScatterMatrix     in_sight = {0};
    double            power = 0, seen_power = 0;
    *field = (ScatterMatrix){0};
    for (int i = 0; i < centres->count; i++) {
        const ScatterCentre *c = &centres->centre[i];
        add_turned(field, &c->s, view[i].wave);
        if (seen[i]) add_turned(&in_sight, &c->s, view[i].wave);
        const RadarScatterer one = {view[i].hh_m2, view[i].vv_m2, {c->p[0], c->p[1], c->p[2]},
                                    c->bounce,     c->part,       seen[i]};
        power += one.hh_m2 + one.vv_m2;
        if (seen[i]) seen_power += one.hh_m2 + one.vv_m2;
        note_strongest(truth, &one);
    }
    ScatterMatrix whole = *field;
    scatter_turn(&whole, job->h_enu, job->v_enu, shot->right);
    scatter_turn(&in_sight, job->h_enu, job->v_enu, shot->right);
    const double complex of[3] = {whole.hh, whole.vv, whole.hv};
    for (int p = 0; p < 3; p++) truth->rcs_m2[p] = 4 * pi_rad * scatter_power(of[p]);
    truth->centres = centres->count;
    add_error(truth, centres, of, power);
    truth->visible = power > 0 ? seen_power / power : 0;

    const RadarPreset *preset = shot->preset;
    double complex     amplitude[interval_channels];
    shot_amplitudes(amplitude, shot, job->sight, &in_sight);
    truth->snr = scatter_power(amplitude[CHANNEL_SUM]) / (interval_receiver_noise_w(&preset->receiver, &preset->wave) *
                                                          interval_noise_share(shot->radar->plan));
    truth->range_rate_mps = shot_range_rate(shot, job->sight, job->target->v_enu_mps);
    truth->appears_m = shot_appears_m(shot, job->sight, truth->range_rate_mps);
}

/* *found false: its signature is still to be made. */
static Status find_centres(bool *found, RadarShot *shot, Target *t, RadarTruth *truth)
{
    SeekerRadar          *r = shot->radar;
    const double          centre_hz = shot->preset->wave.centre_hz;
    const GivenSignature *given = given_list_find(r->given, t->entity->id, t->of->name);
    const SignatureLook   direct = signature_look(&t->antenna);
    const Signature      *signature;
    *found = true;
    truth->given = given && given_signature_knows(given, &t->antenna, centre_hz);
    if (truth->given) return given_signature_centres(&r->centres, given, &t->antenna, centre_hz);
    Signatures  *of = shot->coarse ? r->coarse : r->signatures;
    const Status status =
        signatures_find(&signature, of, t->model, t->joint, snapshot_damage(t->entity), &direct, shot->pool);
    if (status != STATUS_OK) return status;
    *found = signature != NULL;
    truth->coarse = shot->coarse;
    t->pose = signatures_pose(of);
    return signature ? centres_make(&r->centres, signature, &t->antenna, &t->antenna, shot->pool) : STATUS_OK;
}

enum { block_centres = 512 };

static void view_block(void *user, int worker, int task)
{
    const CentreJob *job = user;
    const RadarShot *shot = job->shot;
    const double     k = 2 * pi_rad / shot->preset->antenna.wavelength_m;
    const int        end = (task + 1) * block_centres < job->count ? (task + 1) * block_centres : job->count;
    (void)worker;
    for (int i = task * block_centres; i < end; i++) {
        const ScatterCentre *c = &job->centre[i];
        ScatterMatrix        s = c->s;
        scatter_turn(&s, job->h_enu, job->v_enu, shot->right);
        job->view[i] = (CentreView){shot->preset->transmits_h ? s.hh : s.vv, shot->preset->transmits_h ? s.vh : s.hv,
                                    CMPLX(cos(k * c->path_m), -sin(k * c->path_m)), 4 * pi_rad * scatter_power(s.hh),
                                    4 * pi_rad * scatter_power(s.vv)};
    }
}

static void point_block(void *user, int worker, int task)
{
    const CentreJob *job = user;
    const RadarShot *shot = job->shot;
    const Target    *t = job->target;
    const double     pulse_s = 1 / shot->preset->wave.repeat_hz, room_m = 2 * t->of->radius_m;
    double           ahead_mps[3];
    m3_tmul_v3(ahead_mps, t->r_enu_from_body, t->v_enu_mps);
    const int end = (task + 1) * block_centres < job->points ? (task + 1) * block_centres : job->points;
    (void)worker;
    for (int i = task * block_centres; i < end; i++) {
        const ScatterCentre *c = &job->centre[job->shown[i]];
        RadarPoint          *q = &job->point[i];
        Sight                to;
        m3_mul_v3(q->p_enu, t->r_enu_from_body, c->p);
        v3_add(q->p_enu, q->p_enu, t->p_enu);
        shot_sight(&to, shot, q->p_enu, 0);
        const int node = c->part < 0 ? -1 : t->of->part[c->part].node;
        shot_target_velocity(q->v_enu_mps, t, node, c->p);
        job->spins[i] = shot_target_spins(t, node, ahead_mps[0]);
        q->same = job->view[job->shown[i]].same;
        q->other = job->view[job->shown[i]].other;
        q->share = 1;
        q->path_m = 2 * (job->sight->range_m - shot->reference_m) + c->path_m;
        q->path_per_pulse_m = 2 * (shot_range_rate(shot, &to, q->v_enu_mps) - shot->reference_rate_mps) * pulse_s;
        q->widest = shot->widest + room_m / job->sight->range_m;
        q->room_m = room_m;
        q->own = shot->after_s != 0;
        q->source = 0;
        memcpy(job->x[i], (double[merge_axes]){q->path_m, q->path_per_pulse_m, to.cos_right, to.cos_down},
               sizeof job->x[i]);
    }
}

static void in_blocks(CentreJob *job, int count, void (*block)(void *user, int worker, int task))
{
    const int blocks = (count + block_centres - 1) / block_centres;
    if (job->shot->pool) pool_run(job->shot->pool, blocks, block, job);
    else
        for (int b = 0; b < blocks; b++) block(job, 0, b);
}

/* points: the target's, among those of the radar, to be made fewer once all are there. */
static Status add_target(RadarShot *shot, Target *t, const Sight *sight, RadarTruth *truth, TargetPoints *points)
{
    SeekerRadar  *r = shot->radar;
    ScatterMatrix field;
    bool          found;
    radar_antenna(&t->antenna, shot->p_enu, t->p_enu, t->r_enu_from_body);
    *truth = (RadarTruth){
        .entity = t->index, .range_m = sight->range_m, .cos_right = sight->cos_right, .cos_down = sight->cos_down};
    Status status = find_centres(&found, shot, t, truth);
    if (status != STATUS_OK) return status;
    if (!found) shot->missing++;
    if (shot->missing > 0)
        return truth->given ? STATUS_OK : shot_bounce(shot, t, NULL, truth); /* the rest is asked for alone */
    const size_t n = (size_t)r->centres.count + 1;
    bool        *seen = arena_alloc(shot->arena, n, sizeof *seen);
    int         *shown = arena_alloc(shot->arena, n, sizeof *shown);
    CentreJob    job = {.shot = shot,
                        .target = t,
                        .sight = sight,
                        .centre = r->centres.centre,
                        .count = r->centres.count,
                        .view = arena_alloc(shot->arena, n, sizeof *job.view),
                        .shown = shown,
                        .point = radar_points_room(&r->points, (int)n),
                        .spins = arena_alloc(shot->arena, n, sizeof *job.spins),
                        .x = arena_alloc(shot->arena, n, sizeof *job.x)};
    if (!seen || !shown || !job.view || !job.point || !job.spins || !job.x) return STATUS_NO_MEMORY;
    status = shot_sees_centres(seen, shot, t->index, t->p_enu, t->r_enu_from_body, &r->centres);
    if (status != STATUS_OK) return status;
    basis_of(job.h_enu, job.v_enu, t);
    in_blocks(&job, job.count, view_block);
    add_truth(truth, &field, &job, seen);
    for (int i = 0; i < job.count; i++)
        if (seen[i]) shown[job.points++] = i;
    in_blocks(&job, job.points, point_block);
    *points = (TargetPoints){
        .first = r->points.count, .count = job.points, .x = (const double(*)[merge_axes])job.x, .spins = job.spins};
    r->points.count += job.points;
    return truth->given || !(truth->visible > 0) ? STATUS_OK : shot_bounce(shot, t, &field, truth);
}

/* taken: false when this radar cannot see it. */
static Status take_target(bool *taken, RadarShot *shot, Target *t, Sight *sight)
{
    const SnapshotEntity *e = t->entity;
    const LocalFrame     *frame = &shot->scene->world->frame;
    Origin                origin;
    *taken = false;
    if (t->index == shot->scene->hidden) return STATUS_OK;
    const Model *shown = catalog_model(shot->scene->world->catalog, e->model);
    if (!catalog_has_shape(shot->scene->world->catalog, e->model)) return STATUS_OK;
    enu_from_ecef(t->p_enu, frame, e->p_ecef);
    m3_tmul_v3(t->v_enu_mps, frame->r_ecef_from_enu, e->v_ecef_mps);
    v3_add_scaled(t->p_enu, t->p_enu, shot->after_s, t->v_enu_mps);
    shot_sight(sight, shot, t->p_enu, shown->radius_m);
    const double sine = shot_off_axis(shot, sight), room = shown->radius_m / fmax(sight->range_m, 1);
    if (!sight->within || sine > shot->widest + room || sight->range_m < 2 * shown->radius_m) return STATUS_OK;
    const Catalog *catalog = shot->coarse ? shot->radar->coarse_catalog : shot->radar->catalog;
    t->model = catalog_find(catalog, e->type, &origin, NULL);
    t->of = catalog_model(catalog, t->model);
    m3_tmul(t->r_enu_from_body, frame->r_ecef_from_enu, e->r_ecef_from_body);
    NodePose *pose = arena_alloc(shot->arena, (size_t)t->of->node_count + 1, sizeof *pose);
    t->joint = arena_alloc(shot->arena, (size_t)t->of->node_count + 1, sizeof *t->joint);
    if (!pose || !t->joint) return STATUS_NO_MEMORY;
    snapshot_pose(pose, t->joint, shot->scene->snapshot, t->index, t->of);
    if (shot->scene->joint)
        memcpy(t->joint, shot->scene->joint + e->first_node, (size_t)t->of->node_count * sizeof *t->joint);
    *taken = true;
    return STATUS_OK;
}

typedef struct MergeJob {
    const RadarShot *shot;
    TargetPoints    *points; /* [targets] */
} MergeJob;

static void merge_target(void *user, int worker, int task)
{
    const MergeJob *job = user;
    (void)worker;
    shot_merge_points(&job->points[task], job->shot);
}

/* Makes the points of each target fewer, and closes the gaps. */
static void merge_targets(RadarShot *shot, TargetPoints *points, int count)
{
    RadarPoints *all = &shot->radar->points;
    MergeJob     job = {shot, points};
    if (shot->scene->apart || count == 0) return;
    if (shot->pool) pool_run(shot->pool, count, merge_target, &job);
    else
        for (int i = 0; i < count; i++) merge_target(&job, 0, i);
    all->count = points[0].first;
    for (int i = 0; i < count; i++) {
        memmove(all->point + all->count, all->point + points[i].first, (size_t)points[i].count * sizeof *all->point);
        all->count += points[i].count;
    }
}

static Status each_target(RadarShot *shot, RadarTruth **truth, int *count)
{
    enum { waiting_most = 1 << 18 }; /* points that wait to be made fewer together */
    const Snapshot *snapshot = shot->scene->snapshot;
    Status          status = STATUS_OK;
    int             merged = 0; /* targets whose points are fewer by now */
    TargetPoints   *points = arena_alloc(shot->arena, (size_t)snapshot->count + 1, sizeof *points);
    *truth = arena_alloc(shot->arena, (size_t)snapshot->count + 1, sizeof **truth);
    *count = 0;
    if (!*truth || !points) return STATUS_NO_MEMORY;
    for (int i = 0; i < snapshot->count && status == STATUS_OK; i++) {
        Target t = {.entity = &snapshot->entity[i], .index = i};
        Sight  sight;
        bool   taken;
        status = take_target(&taken, shot, &t, &sight);
        if (status != STATUS_OK || !taken) continue;
        points[*count].first = shot->radar->points.count;
        status = add_target(shot, &t, &sight, &(*truth)[*count], &points[*count]);
        ++*count;
        if (status != STATUS_OK || shot->radar->points.count - points[merged].first < waiting_most) continue;
        merge_targets(shot, points + merged, *count - merged);
        merged = *count;
    }
    if (status == STATUS_OK) merge_targets(shot, points + merged, *count - merged);
    return status;
}

Status shot_targets(RadarShot *shot)
{
    RadarTruth  *truth;
    const Status status = each_target(shot, &truth, &shot->frame->targets);
    shot->frame->target = truth;
    shot->frame->echoes = shot->radar->target_points = shot->radar->points.count;
    return status;
}

Status shot_targets_anew(RadarShot *beam)
{
    RadarTruth *truth;
    int         count;
    return each_target(beam, &truth, &count);
}
