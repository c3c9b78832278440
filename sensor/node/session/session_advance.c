/* sensor/node/session/session_advance.c: what happens between frames, and what the eyes of all hosts share.
 */
#include "sensor/node/session/session_private.h"

/* Between two of these, poses and snapshots omit timed-out entities: they are never visible. */
enum { expire_ticks = seeker_ticks_per_s / 10 };

void session_name_host(Session *s)
{
    SessionResult *r = &s->result;
    choice_host_name(s->host_text, &s->plan);
    if (dis_entity_id_is_none(s->plan.host) && s->plan.any_munition) return;
    for (int i = 0; i < r->host_count; i++)
        if (strcmp(r->host[i], s->host_text) == 0) return;
    if (r->host_count == session_hosts_kept) return;
    _Static_assert(sizeof r->host[0] == sizeof s->host_text, "one text");
    memcpy(r->host[r->host_count++], s->host_text, sizeof s->host_text);
}

bool session_aim_at(double p_ecef[3], const Session *s, double t_s)
{
    SnapshotEntity aim;
    if (dis_entity_id_is_none(s->plan.aim) ||
        !entity_table_pose(&aim, s->table, entity_table_find(s->table, s->plan.aim), t_s))
        return false;
    const double height_m = catalog_model(s->shared->catalog, aim.model)->height_m;
    for (int k = 0; k < 3; k++) p_ecef[k] = aim.p_ecef[k] - 0.5 * height_m * aim.r_ecef_from_body[3 * k + 2];
    return true;
}

bool session_eye(Eye *eye, Session *s, Snapshot *snapshot, double t_s)
{
    *eye = (Eye){.hidden = -1};
    return s->host->eye(eye, s->host, snapshot, t_s);
}

void session_finish_eye(Eye *eye, const Session *s)
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

void session_keep(Session *s)
{
    const HostPlan *plan = &s->plan;
    entity_table_focus(s->table, dis_entity_id_is_none(plan->host) ? plan->aim : plan->host, plan->aim);
}

void session_note_failure(Session *s, const char *what, Status status)
{
    if (status == STATUS_OK || s->advance_status != STATUS_OK) return;
    log_error("%s: %s", what, status_name(status));
    s->advance_status = status;
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
        s->host->tick(s->host, tick_s);
        session_keep(s);
        session_heat_warm(s, tick_s);
    }
    feed(s, t_s);
}
