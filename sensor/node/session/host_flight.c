/* sensor/node/session/host_flight.c: an eye in the nose of a missile that flies by what is seen in its frames. */
#include "sensor/node/session/session_private.h"

#include "sensor/node/session/aim_error.h"

#include <stdlib.h>

static bool ground_at(double on_ecef[3], double normal_ecef[3], void *user, const double p_ecef[3])
{
    const World *world = ((const Session *)user)->shared->world;
    double       p[3], normal[3] = {0, 0, 1};
    if (!world->landscape) return false;
    enu_from_ecef(p, &world->frame, p_ecef);
    p[2] = elevation_height(&world->landscape->elevation, p[0], p[1], normal);
    if (!isfinite(p[2])) return false;
    ecef_from_enu(on_ecef, &world->frame, p);
    m3_mul_v3(normal_ecef, world->frame.r_ecef_from_enu, normal);
    return true;
}

static bool body_at(LoopBody *out, void *user, DisEntityId id, double t_s)
{
    const Session *s = user;
    SnapshotEntity e;
    if (!entity_table_pose(&e, s->table, entity_table_find(s->table, id), t_s)) return false;
    memcpy(out->p_ecef, e.p_ecef, sizeof out->p_ecef);
    memcpy(out->v_ecef_mps, e.v_ecef_mps, sizeof out->v_ecef_mps);
    memcpy(out->r_ecef_from_body, e.r_ecef_from_body, sizeof out->r_ecef_from_body);
    return true;
}

/* A node's own PDUs are ignored when they come back, so its own world is told here. The first takes the place of an
 * earlier run's products. */
static void fired(void *user, const DisFire *fire, double t_s)
{
    Session *s = user;
    session_note_failure(s, "files", session_begin_files(s));
    entity_table_fire(s->table, fire, t_s);
}

static void burst(void *user, const DisDetonation *burst, double t_s)
{
    entity_table_detonation(((Session *)user)->table, burst, t_s);
}

/* The next missile of a salvo has taken the frame. */
static void follow_round(Session *s)
{
    const FlightLoop *loop = s->shared->flight;
    if (dis_entity_id_compare(s->plan.host, loop->id) == 0) return;
    s->plan.host = loop->id;
    s->plan.aim = loop->target;
    session_name_host(s);
}

static void flight_tick(HostMotion *motion, double t_s)
{
    Session        *s = motion->s;
    const LoopScene scene = {s, ground_at, body_at, fired, burst};
    follow_round(s);
    const bool there = session_aim_at(s->p_aim_ecef, s, t_s); /* gone: the last position is kept */
    s->aim_known |= there;
    flight_loop_tick(s->shared->flight, &scene, t_s, there ? s->p_aim_ecef : NULL);
    follow_round(s);
}

static bool flight_is_there(const HostMotion *motion)
{
    const FlightLoop *loop = motion->s->shared->flight;
    return loop->launched && !loop->ended;
}

/* The camera looks where the seeker's gimbal points, upright but for sensor.mount_roll_deg, and misses that by
 * sensor.aim_offset and sensor.walk_deg: its attitude is known all the same. */
static void look(double r_enu_from_cam[9], const Session *s, const FlightState *state, double t_s)
{
    const Config *config = s->shared->config;
    const double  roll_rad = config->sensor.mount_roll_deg * rad_per_deg, c = cos(roll_rad), e = sin(roll_rad);
    double        d_enu[3], tangent[2];
    m3_tmul_v3(d_enu, s->shared->world->frame.r_ecef_from_enu, state->gaze_ecef);
    view_upright(r_enu_from_cam, d_enu);
    for (int i = 0; i < 3 && roll_rad != 0; i++) {
        const double right = r_enu_from_cam[3 * i], down = r_enu_from_cam[3 * i + 1];
        r_enu_from_cam[3 * i] = c * right + e * down;
        r_enu_from_cam[3 * i + 1] = c * down - e * right;
    }
    aim_error_at(tangent, config, s->plan.host, t_s);
    aim_error_turn(r_enu_from_cam, tangent);
}

static void keep_camera(LoopCamera *c, const Eye *eye, const Session *s, double t_s)
{
    SnapshotEntity target;
    *c = (LoopCamera){.t_s = t_s, .view = eye->view};
    memcpy(c->p_ecef, eye->state.p_ecef, sizeof c->p_ecef);
    memcpy(c->v_ecef_mps, eye->state.v_ecef_mps, sizeof c->v_ecef_mps);
    memcpy(c->r_ecef_from_cam, eye->state.r_ecef_from_cam, sizeof c->r_ecef_from_cam);
    c->target_known = session_aim_at(c->target_ecef, s, t_s) &&
                      entity_table_pose(&target, s->table, entity_table_find(s->table, s->plan.aim), t_s);
    if (c->target_known) memcpy(c->target_v_ecef_mps, target.v_ecef_mps, sizeof c->target_v_ecef_mps);
}

static bool flight_eye(Eye *eye, HostMotion *motion, Snapshot *snapshot, double t_s)
{
    static const double step_s = 0.01;
    Session            *s = motion->s;
    FlightLoop         *loop = s->shared->flight;
    FlightState         now, then;
    double              r_then[9];
    if (snapshot && loop->hooks && loop->hooks->look) loop->hooks->look(loop->hooks->user, t_s);
    if (!flight_loop_at(&now, loop, t_s)) return false;
    look(eye->view.r_enu_from_cam, s, &now, t_s);
    if (flight_loop_at(&then, loop, t_s + step_s)) {
        look(r_then, s, &then, t_s + step_s);
        seeker_turn_rate(eye->w_cam_rps, eye->view.r_enu_from_cam, r_then, step_s);
    }
    memcpy(eye->state.p_ecef, now.p_ecef, sizeof eye->state.p_ecef);
    memcpy(eye->state.v_ecef_mps, now.v_ecef_mps, sizeof eye->state.v_ecef_mps);
    memcpy(eye->r_ecef_from_body, now.r_ecef_from_body, sizeof eye->r_ecef_from_body);
    eye->hidden = eye->state.host_index = -1;
    eye->aim_known = s->aim_known;
    memcpy(eye->p_aim_ecef, s->p_aim_ecef, sizeof eye->p_aim_ecef);
    session_aim_at(eye->p_aim_ecef, s, t_s);
    session_finish_eye(eye, s);
    if (snapshot) keep_camera(&loop->eye, eye, s, t_s);
    return true;
}

void session_flight_seen(Session *s, const Frame *frame)
{
    enum { most = 256 };
    FlightLoop       *loop = s->shared->flight;
    const RadarFrame *radar = frame->record.radar;
    LoopEcho          echo[most];
    int               count = 0;
    loop_sights_frame(loop, frame->number);
    if (loop->source != LOOP_RADAR || !radar) return;
    for (int i = 0; i < radar->detections && count < most; i++) {
        const Detection *d = &radar->detection[i];
        const double     ahead2 = 1 - d->cos_right * d->cos_right - d->cos_down * d->cos_down;
        if (!(ahead2 > 0)) continue;
        echo[count++] = (LoopEcho){{d->cos_right, d->cos_down, sqrt(ahead2)}, d->range_m, -d->range_rate_mps, d->snr};
    }
    loop_sights_echoes(loop, echo, count);
}

static void flight_destroy(HostMotion *motion) { free(motion); }

Status session_host_flight(HostMotion **out, Session *s)
{
    HostMotion *host = malloc(sizeof *host);
    if (!host) return STATUS_NO_MEMORY;
    *host = (HostMotion){s, flight_tick, flight_is_there, flight_eye, flight_destroy, NULL};
    *out = host;
    s->plan.host = s->shared->flight->id;
    s->plan.aim = s->shared->flight->target;
    session_name_host(s);
    return STATUS_OK;
}
