/* sensor/node/session/host_observer.c: an eye that is no entity: it circles the aim. */
#include "sensor/node/session/session_private.h"

#include <stdlib.h>

/* Places the observer on a circle about the aim, clockwise from above, starting in the south; never below the ground.
 */
static void observer_position(double p_ecef[3], double aim_enu[3], const Session *s, double t_s)
{
    const Config     *config = s->shared->config;
    const LocalFrame *frame = &s->shared->world->frame;
    const double      azimuth_rad = pi_rad + config->observer.rate_dps * rad_per_deg * (t_s - s->plan.start_s);
    double            p_enu[3], p_aim_ecef[3];
    memcpy(p_aim_ecef, s->p_aim_ecef, sizeof p_aim_ecef);
    session_aim_at(p_aim_ecef, s, t_s);
    enu_from_ecef(aim_enu, frame, p_aim_ecef);
    p_enu[0] = aim_enu[0] + config->observer.range_m * sin(azimuth_rad);
    p_enu[1] = aim_enu[1] + config->observer.range_m * cos(azimuth_rad);
    p_enu[2] = aim_enu[2] + config->observer.height_m;
    const double ground_m = elevation_height(&s->shared->world->landscape->elevation, p_enu[0], p_enu[1], NULL);
    if (p_enu[2] < ground_m + 20) p_enu[2] = ground_m + 20;
    ecef_from_enu(p_ecef, frame, p_enu);
}

/* False: it is where it looks. */
static bool observer_camera(double r_enu_from_cam[9], const double p_ecef[3], const double aim_enu[3],
                            const LocalFrame *frame)
{
    double p_enu[3], d_enu[3];
    enu_from_ecef(p_enu, frame, p_ecef);
    v3_sub(d_enu, aim_enu, p_enu);
    view_upright(r_enu_from_cam, d_enu);
    return v3_length(d_enu) > 0;
}

static bool observer_eye(Eye *eye, HostMotion *motion, Snapshot *snapshot, double t_s)
{
    (void)snapshot;
    const Session      *s = motion->s;
    static const double half_s = 0.005; /* velocity by difference: it follows the aim, and the terrain */
    const LocalFrame   *frame = &s->shared->world->frame;
    double              before_ecef[3], after_ecef[3], aim_enu[3], r_before[9], r_after[9];
    observer_position(before_ecef, aim_enu, s, t_s - half_s);
    observer_camera(r_before, before_ecef, aim_enu, frame);
    observer_position(after_ecef, aim_enu, s, t_s + half_s);
    observer_camera(r_after, after_ecef, aim_enu, frame);
    seeker_turn_rate(eye->w_cam_rps, r_before, r_after, 2 * half_s);
    observer_position(eye->state.p_ecef, aim_enu, s, t_s);
    for (int k = 0; k < 3; k++) eye->state.v_ecef_mps[k] = (after_ecef[k] - before_ecef[k]) / (2 * half_s);
    if (!observer_camera(eye->view.r_enu_from_cam, eye->state.p_ecef, aim_enu, frame)) return false;
    eye->hidden = eye->state.host_index = -1;
    eye->aim_known = true;
    memcpy(eye->p_aim_ecef, s->p_aim_ecef, sizeof eye->p_aim_ecef);
    session_aim_at(eye->p_aim_ecef, s, t_s);
    session_finish_eye(eye, s);
    memcpy(eye->r_ecef_from_body, eye->state.r_ecef_from_cam, sizeof eye->r_ecef_from_body);
    return true;
}

static void observer_tick(HostMotion *motion, double t_s)
{
    Session *s = motion->s;
    s->aim_known |= session_aim_at(s->p_aim_ecef, s, t_s); /* gone: the last position is kept */
}

static bool observer_is_there(const HostMotion *motion)
{
    (void)motion;
    return true;
}

static void observer_destroy(HostMotion *motion) { free(motion); }

Status session_host_observer(HostMotion **out, Session *s)
{
    *out = malloc(sizeof **out);
    if (!*out) return STATUS_NO_MEMORY;
    **out = (HostMotion){s, observer_tick, observer_is_there, observer_eye, observer_destroy};
    session_name_host(s);
    return STATUS_OK;
}
