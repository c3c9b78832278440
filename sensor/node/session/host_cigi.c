/* sensor/node/session/host_cigi.c: an eye whose place and attitude a CIGI host says, frame by frame. */
#include "sensor/node/session/session_private.h"

#include "sensor/node/cigi/cigi_node.h"

#include <stdlib.h>

/* Camera axes, right, down and along the boresight, of a view's: forward, right, down. */
static void camera_axes(double r_ecef_from_cam[9], const double r_ecef_from_view[9])
{
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) r_ecef_from_cam[3 * i + k] = r_ecef_from_view[3 * i + (k + 1) % 3];
}

/* r turned by w dt in its own axes (Rodrigues). */
static void turn_on(double out[9], const double r[9], const double w_rps[3], double dt_s)
{
    const double rate = v3_length(w_rps), angle = rate * dt_s;
    double       k[3], turn[9];
    memcpy(out, r, 9 * sizeof *out);
    if (!(rate > 0)) return;
    v3_scale(k, 1 / rate, w_rps);
    const double c = cos(angle), s = sin(angle);
    const double cross[9] = {0, -k[2], k[1], k[2], 0, -k[0], -k[1], k[0], 0};
    for (int i = 0; i < 9; i++) turn[i] = (i % 4 == 0 ? c : 0) + (1 - c) * k[i / 3] * k[i % 3] + s * cross[i];
    m3_mul(out, r, turn);
}

/* Where the eye is at t_s: at a frame of the host as it said, about it as it moves by its Rate Control, else since the
 * frame before; of a host whose frames are more than longest_s apart that is not known. */
static bool cigi_eye(Eye *eye, HostMotion *motion, Snapshot *snapshot, double t_s)
{
    static const double longest_s = 1;
    Session            *s = motion->s;
    const CigiNode     *node = s->shared->cigi;
    const CigiFix      *now = &node->fix[0], *before = &node->fix[1];
    double              r_cam[9], r_before[9], r_then[9];
    (void)snapshot;
    if (node->fixes == 0) return false;
    const double step_s = now->t_s - before->t_s, since_s = t_s - now->t_s;
    camera_axes(r_cam, now->r_ecef_from_view);
    if (now->rated) {
        m3_tmul_v3(eye->w_cam_rps, r_cam, now->w_ecef_rps);
        memcpy(eye->state.v_ecef_mps, now->v_ecef_mps, sizeof eye->state.v_ecef_mps);
    } else if (node->fixes == 2 && step_s > 0 && step_s <= longest_s) {
        camera_axes(r_before, before->r_ecef_from_view);
        seeker_turn_rate(eye->w_cam_rps, r_before, r_cam, step_s);
        for (int k = 0; k < 3; k++) eye->state.v_ecef_mps[k] = (now->p_ecef[k] - before->p_ecef[k]) / step_s;
    }
    turn_on(r_then, r_cam, eye->w_cam_rps, since_s);
    m3_tmul(eye->view.r_enu_from_cam, s->shared->world->frame.r_ecef_from_enu, r_then);
    for (int k = 0; k < 3; k++) eye->state.p_ecef[k] = now->p_ecef[k] + since_s * eye->state.v_ecef_mps[k];
    eye->hidden = eye->state.host_index = -1;
    eye->aim_known = s->aim_known;
    memcpy(eye->p_aim_ecef, s->p_aim_ecef, sizeof eye->p_aim_ecef);
    session_aim_at(eye->p_aim_ecef, s, t_s);
    session_finish_eye(eye, s);
    memcpy(eye->r_ecef_from_body, now->r_ecef_from_view, sizeof eye->r_ecef_from_body);
    return true;
}

static void cigi_tick(HostMotion *motion, double t_s)
{
    Session *s = motion->s;
    s->aim_known |= session_aim_at(s->p_aim_ecef, s, t_s); /* gone: the last position is kept */
}

static void cigi_begin(HostMotion *motion, double t_s)
{
    Session        *s = motion->s;
    CigiNode *const node = s->shared->cigi;
    session_note_failure(s, "entities of the CIGI host",
                         cigi_drawn_show(&node->drawn, s->table, &node->scene, node->view, t_s));
}

static bool cigi_is_there(const HostMotion *motion) { return motion->s->shared->cigi->fixes > 0; }

static void cigi_destroy(HostMotion *motion) { free(motion); }

Status session_host_cigi(HostMotion **out, Session *s)
{
    HostMotion *host = malloc(sizeof *host);
    if (!host) return STATUS_NO_MEMORY;
    *host = (HostMotion){s, cigi_tick, cigi_is_there, cigi_eye, cigi_destroy, cigi_begin};
    *out = host;
    session_name_host(s);
    return STATUS_OK;
}
