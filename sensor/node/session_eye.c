/* sensor/node/session_eye.c: where the eye is, and where it looks. */
#include "sensor/node/session_private.h"

#include "dis/enumerations.h"
#include "sensor/node/scene_rate.h"

/* nobody sees the silent meanwhile: poses and snapshots leave them out */
enum { expire_ticks = seeker_ticks_per_s / 10 };

/* The middle of the aim at t_s; false when it is not there. */
static bool aim_pose(double p_ecef[3], const Session *s, double t_s)
{
    SnapshotEntity aim;
    if (dis_entity_id_is_none(s->plan.aim) ||
        !entity_table_pose(&aim, s->table, entity_table_find(s->table, s->plan.aim), t_s))
        return false;
    const double height_m = catalog_model(s->shared->catalog, aim.model)->height_m;
    for (int k = 0; k < 3; k++) p_ecef[k] = aim.p_ecef[k] - 0.5 * height_m * aim.r_ecef_from_body[3 * k + 2];
    return true;
}

/* Pose of the host at t_s. A replay knows a munition's next report, where there is one, and may interpolate; a
 * causal one may not. */
static bool host_pose(SnapshotEntity *host, const Session *s, double t_s)
{
    const SessionShared *shared = s->shared;
    if (!entity_table_pose(host, s->table, entity_table_find(s->table, s->plan.host), t_s)) return false;
    const Track *track = survey_track(shared->survey, s->plan.host);
    if (s->plan.munition && !shared->config->causal && t_s <= track->point[track->count - 1].t_s) {
        TrackPose pose;
        Origin    origin;
        track_at(&pose, track, t_s);
        const int    model  = catalog_find(shared->catalog, host->type, &origin, NULL);
        const double down_m = origin == ORIGIN_CENTRE ? 0.5 * catalog_model(shared->catalog, model)->height_m : 0;
        for (int k = 0; k < 3; k++) host->p_ecef[k] = pose.p_ecef[k] + down_m * pose.r_ecef_from_body[3 * k + 2];
        memcpy(host->v_ecef_mps, pose.v_ecef_mps, sizeof host->v_ecef_mps);
        memcpy(host->r_ecef_from_body, pose.r_ecef_from_body, sizeof host->r_ecef_from_body);
        host->age_s = 0;
    }
    return true;
}

/* A munition's eye is in its nose, a platform's on its roof. */
static void eye_of(double p_ecef[3], const Session *s, const SnapshotEntity *host)
{
    const Model *model       = catalog_model(s->shared->catalog, host->model);
    double       eye_body[3] = {0, 0, -(model->height_m + 0.3)}, lever_ecef[3];
    if (host->type.kind == dis_kind_munition) {
        eye_body[0] = model->box_high[0];
        eye_body[2] = -0.5 * model->height_m;
    }
    m3_mul_v3(lever_ecef, host->r_ecef_from_body, eye_body);
    v3_add(p_ecef, host->p_ecef, lever_ecef);
}

/* Who was still to come: the host, and a munition's target by its Fire. */
static void find_host(Session *s)
{
    HostPlan *plan = &s->plan;
    if (plan->any_munition && dis_entity_id_is_none(plan->host) && player_munition(&plan->host, s->player, s->table)) {
        dis_entity_id_text(s->host_text, plan->host);
        log_info("host: %s, the first munition", s->host_text);
    }
    if (dis_entity_id_is_none(plan->aim) && !dis_entity_id_is_none(plan->host) &&
        player_target(&plan->aim, s->player, plan->host)) {
        char aim[dis_id_text_size];
        dis_entity_id_text(aim, plan->aim);
        log_info("aim: %s, the target of its Fire PDU", aim);
    }
}

static void step_gimbal(Session *s, double t_s)
{
    SnapshotEntity host;
    s->aim_known |= aim_pose(s->p_aim_ecef, s, t_s); /* gone: the last place is kept */
    if (!host_pose(&host, s, t_s)) {
        s->ticks = 0;
        return;
    }
    double d_body[3] = {1, 0, 0};
    if (s->aim_known) {
        double p_ecef[3], d_ecef[3];
        eye_of(p_ecef, s, &host);
        v3_sub(d_ecef, s->p_aim_ecef, p_ecef);
        m3_tmul_v3(d_body, host.r_ecef_from_body, d_ecef);
    }
    seeker_step(&s->seeker, d_body);
    memcpy(s->r_ecef_from_cam[0], s->r_ecef_from_cam[1], sizeof s->r_ecef_from_cam[0]);
    seeker_camera(s->r_ecef_from_cam[1], &s->seeker, host.r_ecef_from_body);
    if (s->ticks < 2) s->ticks++;
}

/* What lasts beyond a frame changes at ticks alone: it does not depend on which frames are made. */
void session_advance(Session *s, double t_s)
{
    /* a quotient is rounded correctly, so that tick 35 is 0.35 to the bit; 35 * 0.01 is more */
    for (double tick_s; (tick_s = (double)s->tick / seeker_ticks_per_s) <= t_s; s->tick++) {
        player_feed(s->player, s->table, tick_s);
        if (s->tick % expire_ticks == 0) entity_table_expire(s->table, tick_s);
        if (s->shared->config->causal) find_host(s);
        step_gimbal(s, tick_s);
    }
    player_feed(s->player, s->table, t_s);
}

static void finish_eye(Eye *eye, const Session *s)
{
    const Config     *config = s->shared->config;
    const LocalFrame *frame  = &s->shared->world->frame;
    eye->view.width          = config->sensor.width_px;
    eye->view.height         = config->sensor.height_px;
    eye->view.focal_px       = view_focal_px(config->sensor.width_px, config->sensor.hfov_deg * rad_per_deg);
    eye->view.lens           = s->shared->sensors->lens;
    enu_from_ecef(eye->view.p_enu, frame, eye->state.p_ecef);
    m3_mul(eye->state.r_ecef_from_cam, frame->r_ecef_from_enu, eye->view.r_enu_from_cam);
}

static bool host_eye(Eye *eye, const Session *s, Snapshot *snapshot, double t_s)
{
    SnapshotEntity host;
    const int      index = snapshot_find(snapshot, s->plan.host);
    if (index < 0 || !host_pose(&host, s, t_s)) return false;

    /* the interpolated pose is the host's in every product: it casts its shadow from there */
    SnapshotEntity *shown = &snapshot->entity[index];
    memcpy(shown->p_ecef, host.p_ecef, sizeof shown->p_ecef);
    memcpy(shown->v_ecef_mps, host.v_ecef_mps, sizeof shown->v_ecef_mps);
    memcpy(shown->r_ecef_from_body, host.r_ecef_from_body, sizeof shown->r_ecef_from_body);
    shown->age_s = host.age_s;

    double r_enu_from_body[9];
    m3_tmul(r_enu_from_body, s->shared->world->frame.r_ecef_from_enu, host.r_ecef_from_body);
    eye_of(eye->state.p_ecef, s, &host);
    memcpy(eye->state.v_ecef_mps, host.v_ecef_mps, sizeof eye->state.v_ecef_mps);
    memcpy(eye->r_ecef_from_body, host.r_ecef_from_body, sizeof eye->r_ecef_from_body);
    seeker_camera(eye->view.r_enu_from_cam, &s->seeker, r_enu_from_body);
    eye->hidden = eye->state.host_index = index;
    eye->at_limit                       = s->seeker.at_limit;
    eye->aim_known                      = s->aim_known;
    memcpy(eye->p_aim_ecef, s->p_aim_ecef, sizeof eye->p_aim_ecef);
    if (s->ticks == 2)
        turn_rate(eye->w_cam_rps, s->r_ecef_from_cam[0], s->r_ecef_from_cam[1], 1.0 / seeker_ticks_per_s);
    finish_eye(eye, s);
    return true;
}

/* On a circle about the aim, clockwise from above, starting in the south; never in the ground. */
static void observer_place(double p_ecef[3], double aim_enu[3], const Session *s, double t_s)
{
    const Config     *config = s->shared->config;
    const LocalFrame *frame  = &s->shared->world->frame;
    const double      azimuth_rad = pi_rad + config->observer.rate_dps * rad_per_deg * (t_s - s->plan.start_s);
    double            p_enu[3], p_aim_ecef[3];
    memcpy(p_aim_ecef, s->p_aim_ecef, sizeof p_aim_ecef);
    aim_pose(p_aim_ecef, s, t_s);
    enu_from_ecef(aim_enu, frame, p_aim_ecef);
    p_enu[0] = aim_enu[0] + config->observer.range_m * sin(azimuth_rad);
    p_enu[1] = aim_enu[1] + config->observer.range_m * cos(azimuth_rad);
    p_enu[2] = aim_enu[2] + config->observer.height_m;
    const double ground_m = elevation_height(&s->shared->world->landscape->elevation, p_enu[0], p_enu[1], NULL);
    if (p_enu[2] < ground_m + 20) p_enu[2] = ground_m + 20;
    ecef_from_enu(p_ecef, frame, p_enu);
}

static void observer_camera(double r_enu_from_cam[9], const double p_ecef[3], const double aim_enu[3],
                            const LocalFrame *frame)
{
    double p_enu[3], d_enu[3];
    enu_from_ecef(p_enu, frame, p_ecef);
    v3_sub(d_enu, aim_enu, p_enu);
    camera_upright(r_enu_from_cam, d_enu);
}

static bool observer_eye(Eye *eye, const Session *s, double t_s)
{
    static const double half_s = 0.005; /* velocity by difference: it rides with the aim, and over the hills */
    const LocalFrame   *frame  = &s->shared->world->frame;
    double              before_ecef[3], after_ecef[3], p_enu[3], aim_enu[3], d_enu[3], r_before[9], r_after[9];
    observer_place(before_ecef, aim_enu, s, t_s - half_s);
    observer_camera(r_before, before_ecef, aim_enu, frame);
    observer_place(after_ecef, aim_enu, s, t_s + half_s);
    observer_camera(r_after, after_ecef, aim_enu, frame);
    turn_rate(eye->w_cam_rps, r_before, r_after, 2 * half_s);
    observer_place(eye->state.p_ecef, aim_enu, s, t_s);
    for (int k = 0; k < 3; k++) eye->state.v_ecef_mps[k] = (after_ecef[k] - before_ecef[k]) / (2 * half_s);
    enu_from_ecef(p_enu, frame, eye->state.p_ecef);
    v3_sub(d_enu, aim_enu, p_enu);
    if (!v3_normalize(d_enu, d_enu)) return false;
    camera_upright(eye->view.r_enu_from_cam, d_enu);
    eye->hidden = eye->state.host_index = -1;
    eye->aim_known                      = true;
    memcpy(eye->p_aim_ecef, s->p_aim_ecef, sizeof eye->p_aim_ecef);
    aim_pose(eye->p_aim_ecef, s, t_s);
    finish_eye(eye, s);
    memcpy(eye->r_ecef_from_body, eye->state.r_ecef_from_cam, sizeof eye->r_ecef_from_body);
    return true;
}

bool session_eye(Eye *eye, Session *s, Snapshot *snapshot, double t_s)
{
    *eye = (Eye){.hidden = -1};
    const bool observer = dis_entity_id_is_none(s->plan.host) && !s->plan.any_munition;
    return observer ? observer_eye(eye, s, t_s) : host_eye(eye, s, snapshot, t_s);
}
