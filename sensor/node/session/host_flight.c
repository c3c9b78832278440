/* sensor/node/session/host_flight.c: an eye in the nose of a missile that flies by what is seen in its frames. */
#include "sensor/node/session/session_private.h"

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

static void flight_tick(HostMotion *motion, double t_s)
{
    Session        *s = motion->s;
    const LoopScene scene = {s, ground_at};
    const bool      there = session_aim_at(s->p_aim_ecef, s, t_s); /* gone: the last position is kept */
    s->aim_known |= there;
    flight_loop_tick(s->shared->flight, &scene, t_s, there ? s->p_aim_ecef : NULL);
}

static bool flight_is_there(const HostMotion *motion)
{
    const FlightLoop *loop = motion->s->shared->flight;
    return loop->launched && !loop->ended;
}

/* The camera looks where the seeker's gimbal points, upright. */
static void look(double r_enu_from_cam[9], const Session *s, const FlightState *state)
{
    double d_enu[3];
    m3_tmul_v3(d_enu, s->shared->world->frame.r_ecef_from_enu, state->gaze_ecef);
    view_upright(r_enu_from_cam, d_enu);
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
    if (!flight_loop_at(&now, loop, t_s)) return false;
    look(eye->view.r_enu_from_cam, s, &now);
    if (flight_loop_at(&then, loop, t_s + step_s)) {
        look(r_then, s, &then);
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
