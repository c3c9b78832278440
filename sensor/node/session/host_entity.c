/* sensor/node/session/host_entity.c: an eye on an entity of the exercise: which one, its mount and its gimbal. */
#include "sensor/node/session/session_private.h"

#include "dis/pdu/pdu.h"
#include "sensor/node/session/aim_error.h"
#include "sensor/node/session/seeker_private.h"

#include <stdio.h>
#include <stdlib.h>

typedef struct EntityHost {
    HostMotion motion;
    Session   *s;
    Seeker     seeker;
    Mount      mount;
    int        mount_model, mount_at; /* mount_at: as seeker_mount_node, of that model; -1: none yet */
    NodePose  *node;                  /* poses and joint values of the host's nodes, [most nodes of a model] */
    double    *joint;
    bool       limit_reported; /* last report of the gimbal limit, and its tick */
    int64_t    limit_tick;
} EntityHost;

/* Whether a replay knows the munition's next report at t_s, and may interpolate; a causal one may not. */
static bool tracked(const EntityHost *h, double t_s)
{
    const Track *track = survey_track(h->s->shared->survey, h->s->plan.host);
    return h->s->plan.munition && !h->s->shared->config->exercise.causal && track && survey_track_knows(track, t_s);
}

/* Pose of the host at t_s, and of its nodes where the sensor is mounted on one. */
static bool host_pose(SnapshotEntity *host, const EntityHost *h, double t_s)
{
    const SessionShared *shared = h->s->shared;
    if (!entity_table_pose_nodes(host, h->mount.on_part ? h->node : NULL, h->joint, h->s->table,
                                 entity_table_find(h->s->table, h->s->plan.host), t_s))
        return false;
    if (tracked(h, t_s)) {
        TrackPose pose;
        Origin    origin;
        survey_track_at(&pose, survey_track(shared->survey, h->s->plan.host), t_s);
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
static void find_node(EntityHost *h, const Model *model, int index)
{
    if (h->mount_model == index) return;
    h->mount_model = index;
    h->mount_at = seeker_mount_node(&h->mount, model);
    if (h->mount_at != mount_missing) return;
    char   names[400];
    size_t n = 0;
    *names = 0;
    for (int i = 0; i < model->node_count && n + 1 < sizeof names; i++)
        if (strncmp(model->node[i].name, "wheel", 5) != 0) /* a tank has a dozen and more */
            n += (size_t)snprintf(names + n, sizeof names - n, "%s%s", n ? ", " : "", model->node[i].name);
    if (n >= sizeof names) snprintf(names + sizeof names - 5, 5, " ...");
    log_warn("host %s: sensor.mount: its model %s has no part '%s', so the sensor sits as with auto; it has: %s",
             h->s->host_text, model->name, h->mount.part, names);
    h->mount_at = mount_body;
}

static void mounted_on(Mounted *out, EntityHost *h)
{
    const Model *model = catalog_model(h->s->shared->catalog, out->host.model);
    find_node(h, model, out->host.model);
    seeker_mount_place(out->p_ecef, out->r_ecef_from_mount, &h->mount, &out->host, model, h->node, h->mount_at);
}

static bool mounted(Mounted *out, EntityHost *h, double t_s)
{
    if (!host_pose(&out->host, h, t_s)) return false;
    mounted_on(out, h);
    return true;
}

/* Does the same for a tick later, as far as it is known at t_s: by dead reckoning from the same report, so that the
 * next report does not make the camera jump. At the end of a replay's track it is extrapolated. */
static bool mounted_ahead(Mounted *out, EntityHost *h, const Mounted *now, double t_s)
{
    static const double step_s = 1.0 / seeker_ticks_per_s;
    if (!tracked(h, t_s) || tracked(h, t_s + step_s)) return mounted(out, h, t_s + step_s);
    SnapshotEntity before;
    double         turn[9];
    if (!host_pose(&before, h, t_s - step_s)) return false;
    out->host = now->host;
    v3_add_scaled(out->host.p_ecef, now->host.p_ecef, step_s, now->host.v_ecef_mps);
    m3_tmul(turn, before.r_ecef_from_body, now->host.r_ecef_from_body);
    m3_mul(out->host.r_ecef_from_body, now->host.r_ecef_from_body, turn);
    mounted_on(out, h);
    return true;
}

/* Begins anew with gimbal, aim and model, for a new host. */
static void take_host(EntityHost *h, DisEntityId host, bool guided)
{
    const bool         first = dis_entity_id_is_none(h->s->plan.host);
    const SeekerConfig config = h->seeker.config;
    h->s->plan.host = host;
    h->seeker = (Seeker){.config = config};
    h->mount_model = -1;
    h->limit_reported = false;
    h->limit_tick = -1;
    if (!*h->s->shared->config->exercise.aim) {
        h->s->plan.aim = (DisEntityId){0};
        h->s->aim_known = false;
    }
    session_name_host(h->s);
    log_info("host: %s, %s %s munition", h->s->host_text, first ? "the first" : "the next",
             guided ? "guided" : "unguided");
}

/* Finds a host that has not appeared yet or that follows one that left, and a munition's target by its Fire PDU. */
static void find_host(EntityHost *h)
{
    HostPlan   *plan = &h->s->plan;
    DisEntityId host = plan->host;
    bool        guided;
    if (plan->any_munition && player_munition(&host, &guided, h->s->player, h->s->table) &&
        dis_entity_id_compare(host, plan->host) != 0)
        take_host(h, host, guided);
    if (dis_entity_id_is_none(plan->aim) && !dis_entity_id_is_none(plan->host) &&
        player_target(&plan->aim, h->s->player, plan->host)) {
        char aim[dis_id_text_size];
        dis_entity_id_text(aim, plan->aim);
        log_info("aim: %s, the target of its Fire PDU", aim);
    }
    const Shot *shot = h->s->shared->config->exercise.causal || !plan->any_munition
                           ? NULL
                           : survey_shot(h->s->shared->survey, plan->host);
    if (shot && dis_entity_id_is_none(plan->aim) && !dis_entity_id_is_none(shot->hit)) plan->aim = shot->hit;
}

/* Attitude of the mount in the axes of the local frame, whose vertical is the one that upright refers to. */
static void enu_axes(double r_enu_from_mount[9], const EntityHost *h, const Mounted *at)
{
    m3_tmul(r_enu_from_mount, h->s->shared->world->frame.r_ecef_from_enu, at->r_ecef_from_mount);
}

static void turn_gimbal(Seeker *seeker, const EntityHost *h, const Mounted *at, const double p_aim_ecef[3])
{
    double d_mount[3] = {1, 0, 0}, r_enu_from_mount[9];
    if (h->s->aim_known) {
        double d_ecef[3];
        v3_sub(d_ecef, p_aim_ecef, at->p_ecef);
        m3_tmul_v3(d_mount, at->r_ecef_from_mount, d_ecef);
    }
    seeker_step(seeker, d_mount);
    enu_axes(r_enu_from_mount, h, at);
    seeker_roll(seeker, r_enu_from_mount);
}

/* Reports the gimbal limit when it is reached or left, and at most once a second. */
static void report_limit(EntityHost *h, double t_s)
{
    char aim[dis_id_text_size] = "its aim";
    if (h->seeker.at_limit == h->limit_reported) return;
    if (h->limit_tick >= 0 && h->s->tick - h->limit_tick < seeker_ticks_per_s) return;
    h->limit_reported = h->seeker.at_limit;
    h->limit_tick = h->s->tick;
    if (!dis_entity_id_is_none(h->s->plan.aim)) dis_entity_id_text(aim, h->s->plan.aim);
    if (h->limit_reported)
        log_warn("host %s: %s is beyond its gimbal at %.2f s: %.1f deg off the axis, the limit is %g "
                 "(sensor.gimbal_limit_deg, sensor.mount_yaw_deg); it looks as far as it can",
                 h->s->host_text, aim, t_s, h->seeker.off_rad / rad_per_deg, h->seeker.config.limit_rad / rad_per_deg);
    else log_info("host %s: %s is within reach of its gimbal from %.2f s on", h->s->host_text, aim, t_s);
}

/* A seeker that has burst follows nothing: its direction stays as it was. */
static bool past_impact(const EntityHost *h)
{
    return h->s->plan.munition && player_spent(h->s->player, h->s->plan.host);
}

static void host_tick(HostMotion *motion, double t_s)
{
    EntityHost *h = (EntityHost *)motion;
    Session    *s = motion->s;
    Mounted     at;
    if (s->shared->config->exercise.causal || s->plan.any_munition) find_host(h);
    if (past_impact(h)) return;
    s->aim_known |= session_aim_at(s->p_aim_ecef, s, t_s); /* gone: the last position is kept */
    if (!mounted(&at, h, t_s)) return;
    turn_gimbal(&h->seeker, h, &at, s->p_aim_ecef);
    report_limit(h, t_s);
}

/* The camera at a time, which misses the aim. */
static void pointed(double r_enu_from_cam[9], const EntityHost *h, const Seeker *seeker,
                    const double r_enu_from_mount[9], double t_s)
{
    double tangent[2];
    seeker_camera(r_enu_from_cam, seeker, r_enu_from_mount);
    aim_error_at(tangent, h->s->shared->config, h->s->plan.host, t_s);
    aim_error_turn(r_enu_from_cam, tangent);
}

/* Computes the camera's rotation and the sensor's motion from its position a tick later. */
static void camera_motion(Eye *eye, EntityHost *h, const Mounted *now, double t_s)
{
    static const double step_s = 1.0 / seeker_ticks_per_s;
    Mounted             next;
    Seeker              seeker = h->seeker;
    double              p_aim_ecef[3], r_enu_from_mount[9], r_next[9], lever[2][3];
    memcpy(eye->state.v_ecef_mps, now->host.v_ecef_mps, sizeof eye->state.v_ecef_mps);
    if (!seeker.started || !mounted_ahead(&next, h, now, t_s)) return;
    /* its own motion is the host's at t_s; only the part due to the host's rotation is a difference */
    v3_sub(lever[0], now->p_ecef, now->host.p_ecef);
    v3_sub(lever[1], next.p_ecef, next.host.p_ecef);
    for (int k = 0; k < 3; k++) eye->state.v_ecef_mps[k] += (lever[1][k] - lever[0][k]) / step_s;
    if (!session_aim_at(p_aim_ecef, h->s, t_s + step_s)) memcpy(p_aim_ecef, h->s->p_aim_ecef, sizeof p_aim_ecef);
    if (!past_impact(h)) turn_gimbal(&seeker, h, &next, p_aim_ecef);
    enu_axes(r_enu_from_mount, h, &next);
    pointed(r_next, h, &seeker, r_enu_from_mount, t_s + step_s);
    seeker_turn_rate(eye->w_cam_rps, eye->view.r_enu_from_cam, r_next, step_s);
}

static bool host_eye(Eye *eye, HostMotion *motion, Snapshot *snapshot, double t_s)
{
    EntityHost *h = (EntityHost *)motion;
    Mounted     at;
    const int   index = snapshot ? snapshot_find(snapshot, h->s->plan.host) : -1;
    if ((snapshot && index < 0) || !mounted(&at, h, t_s)) return false;

    const SnapshotEntity *host = &at.host;
    if (snapshot) { /* the interpolated pose is the host's in every product: its shadow starts from there */
        SnapshotEntity *shown = &snapshot->entity[index];
        memcpy(shown->p_ecef, host->p_ecef, sizeof shown->p_ecef);
        memcpy(shown->v_ecef_mps, host->v_ecef_mps, sizeof shown->v_ecef_mps);
        memcpy(shown->r_ecef_from_body, host->r_ecef_from_body, sizeof shown->r_ecef_from_body);
        shown->age_s = host->age_s;
    }

    double r_enu_from_mount[9];
    enu_axes(r_enu_from_mount, h, &at);
    memcpy(eye->state.p_ecef, at.p_ecef, sizeof eye->state.p_ecef);
    memcpy(eye->r_ecef_from_body, host->r_ecef_from_body, sizeof eye->r_ecef_from_body);
    pointed(eye->view.r_enu_from_cam, h, &h->seeker, r_enu_from_mount, t_s);
    camera_motion(eye, h, &at, t_s);
    eye->hidden = eye->state.host_index = index;
    eye->at_limit = h->seeker.at_limit;
    eye->aim_known = h->s->aim_known;
    memcpy(eye->p_aim_ecef, h->s->p_aim_ecef, sizeof eye->p_aim_ecef);
    session_finish_eye(eye, h->s);
    return true;
}

static bool host_is_there(const HostMotion *motion)
{
    const Session *s = motion->s;
    return entity_table_alive(s->table, entity_table_find(s->table, s->plan.host));
}

static void host_destroy(HostMotion *motion)
{
    EntityHost *h = (EntityHost *)motion;
    free(h->node);
    free(h->joint);
    free(h);
}

Status session_host_entity(HostMotion **out, Session *s)
{
    const Config  *config = s->shared->config;
    const Catalog *catalog = s->shared->catalog;
    EntityHost    *h = calloc(1, sizeof *h);
    int            most_nodes = 1;
    if (!h) return STATUS_NO_MEMORY;
    for (int m = 0; m < catalog_model_count(catalog); m++) {
        const int nodes = catalog_model(catalog, m)->node_count;
        most_nodes = nodes > most_nodes ? nodes : most_nodes;
    }
    h->motion = (HostMotion){s, host_tick, host_is_there, host_eye, host_destroy, NULL};
    h->s = s;
    h->seeker.config =
        (SeekerConfig){config->sensor.gimbal_limit_deg * rad_per_deg, config->sensor.gimbal_rate_dps * rad_per_deg,
                       config->sensor.gimbal_lag_s, config->sensor.mount_roll_deg * rad_per_deg};
    h->mount = seeker_mount(config);
    h->mount_model = -1;
    h->limit_tick = -1;
    h->node = calloc((size_t)most_nodes, sizeof *h->node);
    h->joint = calloc((size_t)most_nodes, sizeof *h->joint);
    *out = &h->motion;
    if (!h->node || !h->joint) return STATUS_NO_MEMORY;
    session_name_host(s);
    return STATUS_OK;
}
