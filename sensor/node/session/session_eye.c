/* sensor/node/session/session_eye.c: position and direction of the sensor. */
#include "sensor/node/session/session_private.h"

#include "dis/pdu/pdu.h"
#include "sensor/node/session/seeker_private.h"

#include <stdio.h>

/* Between two of these, poses and snapshots omit timed-out entities: they are never visible. */
enum { expire_ticks = seeker_ticks_per_s / 10 };

/* The centre of the aim at t_s; false when it is absent. */
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

/* Whether a replay knows the munition's next report at t_s, and may interpolate; a causal one may not. */
static bool tracked(const Session *s, double t_s)
{
    const Track *track = survey_track(s->shared->survey, s->plan.host);
    return s->plan.munition && !s->shared->config->causal && track && t_s <= track->point[track->count - 1].t_s;
}

/* Pose of the host at t_s, and of its nodes where the sensor is mounted on one. */
static bool host_pose(SnapshotEntity *host, const Session *s, double t_s)
{
    const SessionShared *shared = s->shared;
    if (!entity_table_pose_nodes(host, s->mount.on_part ? s->node : NULL, s->joint, s->table,
                                 entity_table_find(s->table, s->plan.host), t_s))
        return false;
    if (tracked(s, t_s)) {
        TrackPose pose;
        Origin    origin;
        survey_track_at(&pose, survey_track(shared->survey, s->plan.host), t_s);
        const int    model = catalog_find(shared->catalog, host->type, &origin, NULL);
        const double down_m = origin == ORIGIN_CENTRE ? 0.5 * catalog_model(shared->catalog, model)->height_m : 0;
        for (int k = 0; k < 3; k++) host->p_ecef[k] = pose.p_ecef[k] + down_m * pose.r_ecef_from_body[3 * k + 2];
        memcpy(host->v_ecef_mps, pose.v_ecef_mps, sizeof host->v_ecef_mps);
        memcpy(host->r_ecef_from_body, pose.r_ecef_from_body, sizeof host->r_ecef_from_body);
        host->age_s = 0;
    }
    return true;
}

/* Where the sensor is on its host, and which way its mount points. */
typedef struct Mounted {
    SnapshotEntity host;
    double         p_ecef[3], r_ecef_from_mount[9];
} Mounted;

/* Finds where the sensor is mounted, once per model. */
static void find_node(Session *s, const Model *model, int index)
{
    if (s->mount_model == index) return;
    s->mount_model = index;
    s->mount_at = seeker_mount_node(&s->mount, model);
    if (s->mount_at != mount_missing) return;
    char   names[400];
    size_t n = 0;
    *names = 0;
    for (int i = 0; i < model->node_count && n + 1 < sizeof names; i++)
        if (strncmp(model->node[i].name, "wheel", 5) != 0) /* a tank has a dozen and more */
            n += (size_t)snprintf(names + n, sizeof names - n, "%s%s", n ? ", " : "", model->node[i].name);
    if (n >= sizeof names) snprintf(names + sizeof names - 5, 5, " ...");
    log_warn("host %s: sensor.mount: its model %s has no part '%s', so the sensor sits as with auto; it has: %s",
             s->host_text, model->name, s->mount.part, names);
    s->mount_at = mount_body;
}

static void mounted_on(Mounted *out, Session *s)
{
    const Model *model = catalog_model(s->shared->catalog, out->host.model);
    find_node(s, model, out->host.model);
    seeker_mount_place(out->p_ecef, out->r_ecef_from_mount, &s->mount, &out->host, model, s->node, s->mount_at);
}

static bool mounted(Mounted *out, Session *s, double t_s)
{
    if (!host_pose(&out->host, s, t_s)) return false;
    mounted_on(out, s);
    return true;
}

/* Does the same for a tick later, as far as it is known at t_s: by dead reckoning from the same report, so that the
 * next report does not make the camera jump. At the end of a replay's track it is extrapolated. */
static bool mounted_ahead(Mounted *out, Session *s, const Mounted *now, double t_s)
{
    static const double step_s = 1.0 / seeker_ticks_per_s;
    if (!tracked(s, t_s) || tracked(s, t_s + step_s)) return mounted(out, s, t_s + step_s);
    SnapshotEntity before;
    double         turn[9];
    if (!host_pose(&before, s, t_s - step_s)) return false;
    out->host = now->host;
    v3_add_scaled(out->host.p_ecef, now->host.p_ecef, step_s, now->host.v_ecef_mps);
    m3_tmul(turn, before.r_ecef_from_body, now->host.r_ecef_from_body);
    m3_mul(out->host.r_ecef_from_body, now->host.r_ecef_from_body, turn);
    mounted_on(out, s);
    return true;
}

/* Begins anew with gimbal, aim and model, for a new host. */
static void take_host(Session *s, DisEntityId host, bool guided)
{
    const bool         first = dis_entity_id_is_none(s->plan.host);
    const SeekerConfig config = s->seeker.config;
    s->plan.host = host;
    s->seeker = (Seeker){.config = config};
    s->mount_model = -1;
    s->limit_reported = false;
    s->limit_tick = -1;
    if (!*s->shared->config->exercise.aim) {
        s->plan.aim = (DisEntityId){0};
        s->aim_known = false;
    }
    dis_entity_id_text(s->host_text, host);
    session_note_host(s);
    log_info("host: %s, %s %s munition", s->host_text, first ? "the first" : "the next",
             guided ? "guided" : "unguided");
}

/* Finds a host that has not appeared yet or that follows one that left, and a munition's target by its Fire PDU. */
static void find_host(Session *s)
{
    HostPlan   *plan = &s->plan;
    DisEntityId host = plan->host;
    bool        guided;
    if (plan->any_munition && player_munition(&host, &guided, s->player, s->table) &&
        dis_entity_id_compare(host, plan->host) != 0)
        take_host(s, host, guided);
    if (dis_entity_id_is_none(plan->aim) && !dis_entity_id_is_none(plan->host) &&
        player_target(&plan->aim, s->player, plan->host)) {
        char aim[dis_id_text_size];
        dis_entity_id_text(aim, plan->aim);
        log_info("aim: %s, the target of its Fire PDU", aim);
    }
    const Shot *shot =
        s->shared->config->causal || !plan->any_munition ? NULL : survey_shot(s->shared->survey, plan->host);
    if (shot && dis_entity_id_is_none(plan->aim) && !dis_entity_id_is_none(shot->hit)) plan->aim = shot->hit;
}

void session_keep(Session *s)
{
    const HostPlan *plan = &s->plan;
    entity_table_focus(s->table, dis_entity_id_is_none(plan->host) ? plan->aim : plan->host, plan->aim);
}

/* Attitude of the mount in the axes of the local frame, whose vertical is the one that upright refers to. */
static void enu_axes(double r_enu_from_mount[9], const Session *s, const Mounted *at)
{
    m3_tmul(r_enu_from_mount, s->shared->world->frame.r_ecef_from_enu, at->r_ecef_from_mount);
}

static void turn_gimbal(Seeker *seeker, const Session *s, const Mounted *at, const double p_aim_ecef[3])
{
    double d_mount[3] = {1, 0, 0}, r_enu_from_mount[9];
    if (s->aim_known) {
        double d_ecef[3];
        v3_sub(d_ecef, p_aim_ecef, at->p_ecef);
        m3_tmul_v3(d_mount, at->r_ecef_from_mount, d_ecef);
    }
    seeker_step(seeker, d_mount);
    enu_axes(r_enu_from_mount, s, at);
    seeker_roll(seeker, r_enu_from_mount);
}

/* Reports the gimbal limit when it is reached or left, and at most once a second. */
static void report_limit(Session *s, double t_s)
{
    char aim[dis_id_text_size] = "its aim";
    if (s->seeker.at_limit == s->limit_reported) return;
    if (s->limit_tick >= 0 && s->tick - s->limit_tick < seeker_ticks_per_s) return;
    s->limit_reported = s->seeker.at_limit;
    s->limit_tick = s->tick;
    if (!dis_entity_id_is_none(s->plan.aim)) dis_entity_id_text(aim, s->plan.aim);
    if (s->limit_reported)
        log_warn("host %s: %s is beyond its gimbal at %.2f s: %.1f deg off the axis, the limit is %g "
                 "(sensor.gimbal_limit_deg, sensor.mount_yaw_deg); it looks as far as it can",
                 s->host_text, aim, t_s, s->seeker.off_rad / rad_per_deg, s->seeker.config.limit_rad / rad_per_deg);
    else log_info("host %s: %s is within reach of its gimbal from %.2f s on", s->host_text, aim, t_s);
}

/* A seeker that has burst follows nothing: its direction stays as it was. */
static bool past_impact(const Session *s) { return s->plan.munition && player_spent(s->player, s->plan.host); }

static void step_gimbal(Session *s, double t_s)
{
    Mounted at;
    if (past_impact(s)) return;
    s->aim_known |= aim_pose(s->p_aim_ecef, s, t_s); /* gone: the last position is kept */
    if (!mounted(&at, s, t_s)) return;
    turn_gimbal(&s->seeker, s, &at, s->p_aim_ecef);
    report_limit(s, t_s);
}

/* Computes the camera's rotation and the sensor's motion from its position a tick later. */
static void camera_motion(Eye *eye, Session *s, const Mounted *now, double t_s)
{
    static const double step_s = 1.0 / seeker_ticks_per_s;
    Mounted             next;
    Seeker              seeker = s->seeker;
    double              p_aim_ecef[3], r_enu_from_mount[9], r_next[9], lever[2][3];
    memcpy(eye->state.v_ecef_mps, now->host.v_ecef_mps, sizeof eye->state.v_ecef_mps);
    if (!seeker.started || !mounted_ahead(&next, s, now, t_s)) return;
    /* its own motion is the host's at t_s; only the part due to the host's rotation is a difference */
    v3_sub(lever[0], now->p_ecef, now->host.p_ecef);
    v3_sub(lever[1], next.p_ecef, next.host.p_ecef);
    for (int k = 0; k < 3; k++) eye->state.v_ecef_mps[k] += (lever[1][k] - lever[0][k]) / step_s;
    if (!aim_pose(p_aim_ecef, s, t_s + step_s)) memcpy(p_aim_ecef, s->p_aim_ecef, sizeof p_aim_ecef);
    if (!past_impact(s)) turn_gimbal(&seeker, s, &next, p_aim_ecef);
    enu_axes(r_enu_from_mount, s, &next);
    seeker_camera(r_next, &seeker, r_enu_from_mount);
    seeker_turn_rate(eye->w_cam_rps, eye->view.r_enu_from_cam, r_next, step_s);
}

static void feed(Session *s, double t_s)
{
    session_note_failure(s, "times of the recording", player_feed(s->player, s->table, t_s));
}

/* State that outlasts a frame changes at ticks alone: it does not depend on which frames are rendered. */
void session_advance(Session *s, double t_s)
{
    /* a quotient is rounded correctly, so that tick 35 is 0.35 to the bit; 35 * 0.01 is more */
    for (double tick_s; (tick_s = (double)s->tick / seeker_ticks_per_s) <= t_s; s->tick++) {
        feed(s, tick_s);
        if (s->tick % expire_ticks == 0) entity_table_expire(s->table, tick_s);
        if (s->shared->config->causal || s->plan.any_munition) find_host(s);
        session_keep(s);
        session_heat_warm(s, tick_s);
        step_gimbal(s, tick_s);
    }
    feed(s, t_s);
}

static void finish_eye(Eye *eye, const Session *s)
{
    const Config     *config = s->shared->config;
    const LocalFrame *frame = &s->shared->world->frame;
    eye->view.width = config->sensor.width_px;
    eye->view.height = config->sensor.height_px;
    eye->view.focal_px = view_focal_px(config->sensor.width_px, config->sensor.hfov_deg * rad_per_deg);
    eye->view.lens = s->shared->sensors->lens;
    enu_from_ecef(eye->view.p_enu, frame, eye->state.p_ecef);
    m3_mul(eye->state.r_ecef_from_cam, frame->r_ecef_from_enu, eye->view.r_enu_from_cam);
}

static bool host_eye(Eye *eye, Session *s, Snapshot *snapshot, double t_s)
{
    Mounted   at;
    const int index = snapshot ? snapshot_find(snapshot, s->plan.host) : -1;
    if ((snapshot && index < 0) || !mounted(&at, s, t_s)) return false;

    const SnapshotEntity *host = &at.host;
    if (snapshot) { /* the interpolated pose is the host's in every product: its shadow starts from there */
        SnapshotEntity *shown = &snapshot->entity[index];
        memcpy(shown->p_ecef, host->p_ecef, sizeof shown->p_ecef);
        memcpy(shown->v_ecef_mps, host->v_ecef_mps, sizeof shown->v_ecef_mps);
        memcpy(shown->r_ecef_from_body, host->r_ecef_from_body, sizeof shown->r_ecef_from_body);
        shown->age_s = host->age_s;
    }

    double r_enu_from_mount[9];
    enu_axes(r_enu_from_mount, s, &at);
    memcpy(eye->state.p_ecef, at.p_ecef, sizeof eye->state.p_ecef);
    memcpy(eye->r_ecef_from_body, host->r_ecef_from_body, sizeof eye->r_ecef_from_body);
    seeker_camera(eye->view.r_enu_from_cam, &s->seeker, r_enu_from_mount);
    camera_motion(eye, s, &at, t_s);
    eye->hidden = eye->state.host_index = index;
    eye->at_limit = s->seeker.at_limit;
    eye->aim_known = s->aim_known;
    memcpy(eye->p_aim_ecef, s->p_aim_ecef, sizeof eye->p_aim_ecef);
    finish_eye(eye, s);
    return true;
}

/* Places the observer on a circle about the aim, clockwise from above, starting in the south; never below the ground.
 */
static void observer_position(double p_ecef[3], double aim_enu[3], const Session *s, double t_s)
{
    const Config     *config = s->shared->config;
    const LocalFrame *frame = &s->shared->world->frame;
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
    view_upright(r_enu_from_cam, d_enu);
}

static bool observer_eye(Eye *eye, const Session *s, double t_s)
{
    static const double half_s = 0.005; /* velocity by difference: it follows the aim, and the terrain */
    const LocalFrame   *frame = &s->shared->world->frame;
    double              before_ecef[3], after_ecef[3], p_enu[3], aim_enu[3], d_enu[3], r_before[9], r_after[9];
    observer_position(before_ecef, aim_enu, s, t_s - half_s);
    observer_camera(r_before, before_ecef, aim_enu, frame);
    observer_position(after_ecef, aim_enu, s, t_s + half_s);
    observer_camera(r_after, after_ecef, aim_enu, frame);
    seeker_turn_rate(eye->w_cam_rps, r_before, r_after, 2 * half_s);
    observer_position(eye->state.p_ecef, aim_enu, s, t_s);
    for (int k = 0; k < 3; k++) eye->state.v_ecef_mps[k] = (after_ecef[k] - before_ecef[k]) / (2 * half_s);
    enu_from_ecef(p_enu, frame, eye->state.p_ecef);
    v3_sub(d_enu, aim_enu, p_enu);
    if (!(v3_length(d_enu) > 0)) return false;
    view_upright(eye->view.r_enu_from_cam, d_enu);
    eye->hidden = eye->state.host_index = -1;
    eye->aim_known = true;
    memcpy(eye->p_aim_ecef, s->p_aim_ecef, sizeof eye->p_aim_ecef);
    aim_pose(eye->p_aim_ecef, s, t_s);
    finish_eye(eye, s);
    memcpy(eye->r_ecef_from_body, eye->state.r_ecef_from_cam, sizeof eye->r_ecef_from_body);
    return true;
}

bool session_observes(const Session *s) { return dis_entity_id_is_none(s->plan.host) && !s->plan.any_munition; }

bool session_host_is_there(const Session *s)
{
    return session_observes(s) || entity_table_alive(s->table, entity_table_find(s->table, s->plan.host));
}

bool session_eye(Eye *eye, Session *s, Snapshot *snapshot, double t_s)
{
    *eye = (Eye){.hidden = -1};
    return session_observes(s) ? observer_eye(eye, s, t_s) : host_eye(eye, s, snapshot, t_s);
}
