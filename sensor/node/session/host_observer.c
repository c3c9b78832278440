/* sensor/node/session/host_observer.c: an eye that is no entity: it circles the aim. */
#include "sensor/node/session/session_private.h"

#include "sensor/node/choices/choices.h"
#include "sensor/node/session/aim_error.h"

#include <stdlib.h>

typedef struct Observer {
    HostMotion motion;
    LocalFrame about; /* east, north and up of its circle: at the aim, wherever in the world that is */
} Observer;

/* Places the observer on a circle about the aim, clockwise from above, starting in the south; never below the ground.
 * aim_about: the aim, in the circle's frame. */
static void observer_position(double p_ecef[3], double aim_about[3], const Observer *o, double t_s)
{
    const Session    *s = o->motion.s;
    const Config     *config = s->shared->config;
    const LocalFrame *frame = &s->shared->world->frame;
    const double      azimuth_rad = pi_rad + config->observer.rate_dps * rad_per_deg * (t_s - s->plan.start_s);
    double            p_about[3], p_enu[3], p_aim_ecef[3];
    memcpy(p_aim_ecef, s->p_aim_ecef, sizeof p_aim_ecef);
    session_aim_at(p_aim_ecef, s, t_s);
    enu_from_ecef(aim_about, &o->about, p_aim_ecef);
    p_about[0] = aim_about[0] + config->observer.range_m * sin(azimuth_rad);
    p_about[1] = aim_about[1] + config->observer.range_m * cos(azimuth_rad);
    p_about[2] = aim_about[2] + config->observer.height_m;
    ecef_from_enu(p_ecef, &o->about, p_about);
    enu_from_ecef(p_enu, frame, p_ecef);
    const double ground_m = elevation_height(&s->shared->world->landscape->elevation, p_enu[0], p_enu[1], NULL);
    if (!(p_enu[2] < ground_m + 20)) return;
    p_enu[2] = ground_m + 20;
    ecef_from_enu(p_ecef, frame, p_enu);
}

/* False: it is where it looks. */
static bool observer_camera(double r_enu_from_cam[9], const double p_ecef[3], const double aim_about[3],
                            const Observer *o, double t_s)
{
    const Session *s = o->motion.s;
    double         p_about[3], d_about[3], r_about_from_cam[9], r_enu_from_about[9], tangent[2];
    enu_from_ecef(p_about, &o->about, p_ecef);
    v3_sub(d_about, aim_about, p_about);
    view_upright(r_about_from_cam, d_about);
    m3_tmul(r_enu_from_about, s->shared->world->frame.r_ecef_from_enu, o->about.r_ecef_from_enu);
    m3_mul(r_enu_from_cam, r_enu_from_about, r_about_from_cam);
    aim_error_at(tangent, s->shared->config, s->plan.aim, t_s);
    aim_error_turn(r_enu_from_cam, tangent);
    return v3_length(d_about) > 0;
}

static bool observer_eye(Eye *eye, HostMotion *motion, Snapshot *snapshot, double t_s)
{
    (void)snapshot;
    const Session      *s = motion->s;
    static const double half_s = 0.005; /* velocity by difference: it follows the aim, and the terrain */
    const Observer     *o = (const Observer *)motion;
    double              before_ecef[3], after_ecef[3], aim_about[3], r_before[9], r_after[9];
    observer_position(before_ecef, aim_about, o, t_s - half_s);
    observer_camera(r_before, before_ecef, aim_about, o, t_s - half_s);
    observer_position(after_ecef, aim_about, o, t_s + half_s);
    observer_camera(r_after, after_ecef, aim_about, o, t_s + half_s);
    seeker_turn_rate(eye->w_cam_rps, r_before, r_after, 2 * half_s);
    observer_position(eye->state.p_ecef, aim_about, o, t_s);
    for (int k = 0; k < 3; k++) eye->state.v_ecef_mps[k] = (after_ecef[k] - before_ecef[k]) / (2 * half_s);
    if (!observer_camera(eye->view.r_enu_from_cam, eye->state.p_ecef, aim_about, o, t_s)) return false;
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
    Observer *o = malloc(sizeof *o);
    if (!o) return STATUS_NO_MEMORY;
    *o = (Observer){{s, observer_tick, observer_is_there, observer_eye, observer_destroy, NULL},
                    s->shared->world->frame};
    double   p_ecef[3];
    Geodetic place;
    if (choice_aim_place(p_ecef, s->shared->survey, &s->plan) && geodetic_from_ecef(&place, p_ecef) == STATUS_OK) {
        const Status status = local_frame_at(&o->about, &(Geodetic){place.lat_rad, place.lon_rad, 0});
        if (status != STATUS_OK) {
            free(o);
            return status;
        }
    }
    *out = &o->motion;
    session_name_host(s);
    return STATUS_OK;
}
