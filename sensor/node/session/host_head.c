/* sensor/node/session/host_head.c: an eye that a head tracker turns, on whatever carries it: an entity, or an observer.
 *
 * A pose holds from a frame's time on, and for it alone the tracker is asked; so frames follow from the poses and their
 * times, which the recording has. */
#include "sensor/node/session/session_private.h"

#include "entities/motion/dead_reckoning.h"
#include "sensor/node/session/head_notes.h"

#include <stdlib.h>
#include <strings.h>

/* Octets of notes that a reader of recordings keeps (dis/capture/log_pcap.c), less some for others' notes. */
enum { notes_room = 60000000 };

typedef struct HeadHost {
    HostMotion  motion;
    HostMotion *under;     /* what carries the eye; its own */
    HeadNotes  *played;    /* poses of the recording that is played; NULL: live */
    bool        on_entity; /* else an observer carries it */
    HeadNote    now, before;
    int         poses; /* 0: none yet; 1: now; 2: before, too */
    bool        fresh; /* now is that of the present frame, and of none before it */
    double      frame_s;
    uint64_t    noted; /* octets */
} HeadHost;

/* ---- which pose ------------------------------------------------------------------------------------ */

static void note_pose(HeadHost *h, const HeadNote *note)
{
    const SessionShared *shared = h->motion.s->shared;
    char                 text[head_note_size];
    if (!shared->note || h->noted > notes_room) return;
    head_note_text(text, note);
    h->noted += strlen(text) + 1;
    shared->note(shared->user, text);
    if (h->noted > notes_room)
        log_warn(
            "head: the recording has no room for further poses: a replay holds the last one from here on; a new run "
            "records on");
}

/* The pose of the frame at t_s, of a live node: the newest that has come. */
static void newest_pose(HeadHost *h, double t_s)
{
    HeadNote note = {.t_s = t_s};
    h->fresh = head_link_newest(&note.pose, h->motion.s->head) &&
               (h->poses == 0 || note.pose.sequence != h->now.pose.sequence);
    if (!h->fresh) return;
    h->before = h->now;
    h->now = note;
    h->poses = h->poses == 0 ? 1 : 2;
    note_pose(h, &note);
}

static void played_pose(HeadHost *h, double t_s)
{
    const int at = head_notes_at(h->played, t_s);
    h->poses = at < 0 ? 0 : at == 0 ? 1 : 2;
    if (at >= 0) h->now = h->played->note[at];
    if (at > 0) h->before = h->played->note[at - 1];
    h->fresh = at >= 0 && h->now.t_s == t_s;
}

/* ---- where it looks --------------------------------------------------------------------------------- */

/* How fast it moves, by the sender's clock, of two poses in a row; 0 where they are too far apart, and of one that is
 * held. */
typedef struct HeadRate {
    double turn_dps[3]; /* of yaw, pitch, roll */
    double v_ecef_mps[3];
} HeadRate;

static bool place_of(double p_ecef[3], const HeadPose *pose)
{
    const double turns = round(pose->lon_deg / 360);
    return ecef_from_geodetic(p_ecef, NULL,
                              &(Geodetic){pose->lat_deg * rad_per_deg, (pose->lon_deg - 360 * turns) * rad_per_deg,
                                          pose->height_m}) == STATUS_OK;
}

static HeadRate rate_of(const HeadHost *h)
{
    static const double longest_s = 0.5;
    const HeadPose     *a = &h->before.pose, *b = &h->now.pose;
    const double        step_s = 1e-6 * (double)(int64_t)(b->time_us - a->time_us);
    HeadRate            rate = {0};
    double              p_a[3], p_b[3];
    if (h->poses < 2 || !h->fresh || a->flags != b->flags || !(step_s > 0 && step_s <= longest_s)) return rate;
    const double change_deg[3] = {b->yaw_deg - a->yaw_deg, b->pitch_deg - a->pitch_deg, b->roll_deg - a->roll_deg};
    for (int k = 0; k < 3; k++) rate.turn_dps[k] = remainder(change_deg[k], 360) / step_s;
    if (b->flags & HEAD_PLACED && place_of(p_a, a) && place_of(p_b, b))
        for (int k = 0; k < 3; k++) rate.v_ecef_mps[k] = (p_b[k] - p_a[k]) / step_s;
    return rate;
}

/* Axes forward, right and down of what carries the eye, or north, east and down where it is. carried: its eye. */
static void axes_of(double r_ecef_from_axes[9], const HeadHost *h, const Eye *carried, const double p_ecef[3])
{
    static const int of_cam[3] = {2, 0, 1}, of_enu[3] = {1, 0, 2};
    const bool       relative = h->now.pose.flags & HEAD_RELATIVE;
    double           r_ecef_from_enu[9];
    Geodetic         place;
    if (relative && h->on_entity) {
        memcpy(r_ecef_from_axes, carried->r_ecef_from_body, 9 * sizeof *r_ecef_from_axes);
        return;
    }
    if (!relative && (geodetic_from_ecef(&place, p_ecef) != STATUS_OK ||
                      ecef_from_geodetic((double[3]){0}, r_ecef_from_enu, &place) != STATUS_OK))
        memcpy(r_ecef_from_enu, h->motion.s->shared->world->frame.r_ecef_from_enu, sizeof r_ecef_from_enu);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            r_ecef_from_axes[3 * i + k] = relative ? carried->state.r_ecef_from_cam[3 * i + of_cam[k]]
                                                   : (k == 2 ? -1 : 1) * r_ecef_from_enu[3 * i + of_enu[k]];
}

/* The camera since_s after the frame. */
static void camera_at(double r_ecef_from_cam[9], const HeadHost *h, const Eye *carried, const double p_ecef[3],
                      const HeadRate *rate, double since_s)
{
    const HeadPose *p = &h->now.pose;
    double          r_axes[9], turn[9], r_view[9];
    axes_of(r_axes, h, carried, p_ecef);
    r_ecef_from_body_euler(turn, (p->yaw_deg + rate->turn_dps[0] * since_s) * rad_per_deg,
                           (p->pitch_deg + rate->turn_dps[1] * since_s) * rad_per_deg,
                           (p->roll_deg + rate->turn_dps[2] * since_s) * rad_per_deg);
    m3_mul(r_view, r_axes, turn);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) r_ecef_from_cam[3 * i + k] = r_view[3 * i + (k + 1) % 3];
}

/* What carries the eye, step_s later; where that is not known, as it is. */
static Eye carried_at(HeadHost *h, const Eye *now, double t_s)
{
    Eye then = {.hidden = -1};
    return h->under->eye(&then, h->under, NULL, t_s) ? then : *now;
}

static bool head_eye(Eye *eye, HostMotion *motion, Snapshot *snapshot, double t_s)
{
    static const double half_s = 0.005;
    HeadHost           *h = (HeadHost *)motion;
    Session            *s = motion->s;
    double              r_before[9], r_after[9], r_cam[9];
    if (!h->under->eye(eye, h->under, snapshot, t_s)) return false;
    if (snapshot) {
        h->frame_s = t_s;
        if (h->played) played_pose(h, t_s);
        else newest_pose(h, t_s);
    }
    if (h->poses == 0) return true;
    const HeadPose *p = &h->now.pose;
    const HeadRate  rate = rate_of(h);
    const double    since_s = t_s - h->frame_s;
    const Eye       carried = *eye;
    if (p->flags & HEAD_PLACED && place_of(eye->state.p_ecef, p)) {
        for (int k = 0; k < 3; k++) {
            eye->state.v_ecef_mps[k] = rate.v_ecef_mps[k];
            eye->state.p_ecef[k] += since_s * rate.v_ecef_mps[k];
        }
        eye->hidden = eye->state.host_index = -1; /* it may see what carried it */
    }
    const Eye earlier = carried_at(h, &carried, t_s - half_s), later = carried_at(h, &carried, t_s + half_s);
    camera_at(r_before, h, &earlier, eye->state.p_ecef, &rate, since_s - half_s);
    camera_at(r_after, h, &later, eye->state.p_ecef, &rate, since_s + half_s);
    camera_at(r_cam, h, &carried, eye->state.p_ecef, &rate, since_s);
    seeker_turn_rate(eye->w_cam_rps, r_before, r_after, 2 * half_s);
    m3_tmul(eye->view.r_enu_from_cam, s->shared->world->frame.r_ecef_from_enu, r_cam);
    eye->at_limit = false;
    session_finish_eye(eye, s);
    eye->view.focal_px *= p->zoom;
    eye->turned = true;
    eye->head = *p;
    if (!h->on_entity || p->flags & HEAD_PLACED)
        memcpy(eye->r_ecef_from_body, eye->state.r_ecef_from_cam, sizeof eye->r_ecef_from_body);
    return true;
}

static void head_tick(HostMotion *motion, double t_s)
{
    HeadHost *h = (HeadHost *)motion;
    h->under->tick(h->under, t_s);
}

static void head_begin(HostMotion *motion, double t_s)
{
    HeadHost *h = (HeadHost *)motion;
    if (h->under->begin) h->under->begin(h->under, t_s);
}

static bool head_is_there(const HostMotion *motion)
{
    const HeadHost *h = (const HeadHost *)motion;
    return h->under->is_there(h->under);
}

static void head_destroy(HostMotion *motion)
{
    HeadHost *h = (HeadHost *)motion;
    if (h->under) h->under->destroy(h->under);
    free(h->played);
    free(h);
}

Status session_host_head(HostMotion **host, Session *s)
{
    const Config *config = s->shared->config;
    HeadHost     *h = calloc(1, sizeof *h);
    if (!h) return STATUS_NO_MEMORY;
    h->motion = (HostMotion){s, head_tick, head_is_there, head_eye, head_destroy, head_begin};
    h->under = *host;
    h->on_entity = s->plan.any_munition || !dis_entity_id_is_none(s->plan.host);
    *host = &h->motion;
    if (s->shared->flight) {
        log_error("head: a missile in the loop has no operator who turns its eye; leave exercise.head out");
        return STATUS_BAD_VALUE;
    }
    if (!s->shared->live) {
        const Status status = head_notes_read(&h->played, s->shared->notes);
        if (status != STATUS_OK || h->played) return status;
        log_error(
            "head: this recording holds no poses of a head: only those that `pitviper run --head` records as pcapng do; "
            "leave exercise.head out");
        return STATUS_BAD_VALUE;
    }
    const size_t length = strlen(config->record.path);
    if (length > 5 && strcasecmp(config->record.path + length - 5, ".pcap") == 0)
        log_warn("head: %s has no room for poses (pcap), and its replay none; name it .pcapng", config->record.path);
    const Status status = head_link_open(&s->head, config->exercise.head);
    if (status == STATUS_OK) log_info("head: poses are taken on %s", config->exercise.head);
    return status;
}
