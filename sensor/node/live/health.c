/* sensor/node/live/health.c: from counters to a reason, from a reason to a message. */
#include "sensor/node/live/health.h"

#include "dis/pdu/decode.h"
#include "sensor/node/player/player.h"

#include <errno.h>
#include <stdio.h>

/* The heartbeat interval is 5 s: after that long without it, other traffic decides. */
static const double quiet_s = 5, nothing_s = 10, hostless_s = 5, unseen_s = 10, failing_s = 1, trouble_s = 60;
static const double remind_s = 60;

/* ---- reasons ------------------------------------------------------------------------------------------- */

static uint64_t others(const HealthSample *s)
{
    uint64_t sum = 0;
    for (int e = 0; e < 256; e++) sum += s->other[e];
    return sum;
}

static HealthReason hear(const HealthSample *s, double patience)
{
    const double silent_s = s->now_s - s->usable_s;
    if (s->away) return HEALTH_AWAY;
    /* until they have timed out: stationary entities may report once a minute */
    if ((s->rendering && s->entities > 0) || silent_s < quiet_s * patience) return HEALTH_FINE;
    if (s->now_s - s->any_s >= nothing_s && patience > 0) return HEALTH_NOTHING;
    if (s->pdus) return HEALTH_NO_ENTITY;
    if (others(s)) return HEALTH_OTHER_EXERCISE;
    if (s->junk) return HEALTH_JUNK;
    if (s->own && s->usable == 0) return HEALTH_OWN;
    return patience > 0 ? HEALTH_FINE : HEALTH_NOTHING;
}

static HealthReason show(const HealthSample *s, double patience)
{
    if (!s->rendering) return HEALTH_FINE;
    if (s->missing > 0 && s->now_s - s->frame_s >= hostless_s * patience) {
        if (s->host == HEALTH_MUNITION) return s->frames ? HEALTH_MUNITION_GONE : HEALTH_NO_MUNITION;
        if (s->host == HEALTH_BY_ID) return s->frames ? HEALTH_HOST_GONE : HEALTH_NO_HOST;
    }
    if (s->frames == 0 || s->now_s - s->frame_s >= hostless_s) return HEALTH_FINE;
    if (s->now_s - s->in_view_s >= unseen_s) return s->others ? HEALTH_NO_VIEW : HEALTH_NO_TRAFFIC;
    return s->now_s - s->visible_s >= unseen_s ? HEALTH_HIDDEN : HEALTH_FINE;
}

HealthReason health_evaluate(HealthTopic topic, const HealthSample *s)
{
    switch (topic) {
    case HEALTH_RECEIVE:
        return hear(s, 1);
    case HEALTH_RENDER:
        return show(s, 1);
    case HEALTH_SEND:
        return s->publishes && s->unsent > 0 && s->now_s - s->failing_s >= failing_s ? HEALTH_NOT_SENT : HEALTH_FINE;
    case HEALTH_LOSS:
        return s->now_s - s->lost_s < trouble_s ? HEALTH_LOST : HEALTH_FINE;
    case HEALTH_PACE:
        return s->now_s - s->late_s < trouble_s ? HEALTH_LATE : HEALTH_FINE;
    default:
        return HEALTH_FINE;
    }
}

HealthReason health_final(const HealthSample *s)
{
    HealthReason reason = s->usable && !s->away ? HEALTH_FINE : hear(s, 0);
    if (reason == HEALTH_FINE) reason = show(s, 0);
    return reason == HEALTH_FINE ? HEALTH_EARLY : reason;
}

/* ---- lines ---------------------------------------------------------------------------------------------- */

const char *health_name(HealthReason reason)
{
    switch (reason) {
    case HEALTH_FINE:
        return "";
    case HEALTH_AWAY:
        return "the network is gone";
    case HEALTH_OTHER_EXERCISE:
        return "other exercises only";
    case HEALTH_NO_ENTITY:
        return "no entity heard";
    case HEALTH_OWN:
        return "hears itself only";
    case HEALTH_JUNK:
        return "malformed datagrams only";
    case HEALTH_NOTHING:
        return "nothing heard";
    case HEALTH_NO_HOST:
        return "host not heard";
    case HEALTH_HOST_GONE:
        return "host gone";
    case HEALTH_NO_MUNITION:
        return "no munition flies";
    case HEALTH_MUNITION_GONE:
        return "munition gone";
    case HEALTH_NO_TRAFFIC:
        return "no entity there";
    case HEALTH_NO_VIEW:
        return "none in view";
    case HEALTH_HIDDEN:
        return "none visible";
    case HEALTH_NOT_SENT:
        return "not sent";
    case HEALTH_LOST:
        return "datagrams lost";
    case HEALTH_LATE:
        return "frames late";
    case HEALTH_EARLY:
        return "ended early";
    }
    return "";
}

static DisDrop most_dropped(const HealthSample *s)
{
    int most = 0;
    for (int i = 1; i < DIS_DROP_COUNT; i++)
        if (s->dropped[i] > s->dropped[most]) most = i;
    return (DisDrop)most;
}

/* Lists the exercises with the most PDUs, as in `2 (14 PDUs), 7 (1)`, and returns the first of them. */
static int list_exercises(char *out, size_t size, const HealthSample *s)
{
    enum { most = 4 };
    bool   listed[256] = {false};
    size_t n = 0;
    int    first = 0;
    *out = 0;
    for (int k = 0; k <= most && n < size; k++) {
        int best = -1;
        for (int e = 0; e < 256; e++)
            if (!listed[e] && s->other[e] && (best < 0 || s->other[e] > s->other[best])) best = e;
        if (best < 0) break;
        listed[best] = true;
        if (k == 0) first = best;
        if (k == most) n += (size_t)snprintf(out + n, size - n, " ...");
        else
            n += (size_t)snprintf(out + n, size - n, "%s%d (%llu%s)", k ? ", " : "", best,
                                  (unsigned long long)s->other[best], k ? "" : " PDUs");
    }
    return first;
}

/* Gives the remedy for an error of the operating system. */
static const char *send_advice(int error)
{
    switch (error) {
    case ENETUNREACH:
    case EHOSTUNREACH:
    case EADDRNOTAVAIL:
        return "; no route leads there: --interface NAME or another --address (127.255.255.255: within this machine)";
    case EPERM:
    case EACCES:
        return "; a firewall or the user's rights forbid it (`nft list ruleset`)";
    case ENETDOWN:
    case ENODEV:
    case ENXIO:
        return "; the interface is down or gone (`ip link`)";
    case ENOBUFS:
    case EAGAIN:
        return "; the interface cannot send that fast: a lower --rate or fewer --bands";
    case EMSGSIZE:
        return "; the interface takes only shorter ones (`ip link`: mtu)";
    default:
        return "; --interface and --address say where to, --set publish.dis=off sends nothing";
    }
}

void health_text(char out[health_text_size], HealthReason reason, const HealthSample *s, const HealthNames *n)
{
    char         exercises[120];
    const size_t size = health_text_size;
    switch (reason) {
    case HEALTH_FINE:
        *out = 0;
        break;
    case HEALTH_AWAY:
        snprintf(out, size, "the network of %s is not there (`ip address` shows what is)", n->where);
        break;
    case HEALTH_OTHER_EXERCISE: {
        const int first = list_exercises(exercises, sizeof exercises, s);
        snprintf(out, size,
                 "only other exercises are heard on %s: %s; this node hears exercise %d: "
                 "--set exercise.exercise=%d hears that one, -2 all",
                 n->where, exercises, n->exercise, first);
        break;
    }
    case HEALTH_NO_ENTITY:
        snprintf(out, size,
                 "DIS is heard on %s, but no Entity State with a usable place: %llu PDUs, the latest "
                 "of type %d (%s); `pitviper record --for 10 -o heard.pcapng`, then `pitviper inspect heard.pcapng` "
                 "shows them",
                 n->where, (unsigned long long)s->pdus, s->type, dis_pdu_type_name(s->type));
        break;
    case HEALTH_OWN:
        snprintf(out, size,
                 "all %llu datagrams heard on %s come from %d:%d, this node's own site and "
                 "application, and are ignored: another node or simulator uses them too; --set node.application=%d",
                 (unsigned long long)s->own, n->where, n->site, n->application,
                 n->application < 65533 ? n->application + 1 : 1);
        break;
    case HEALTH_JUNK: {
        const DisDrop why = most_dropped(s);
        const bool    header = why != DIS_DROP_SHORT_HEADER && why != DIS_DROP_BAD_VERSION;
        snprintf(out, size,
                 "only what is %s is heard on %s: %llu malformed datagrams, most with %s; %s; `pitviper record "
                 "--for 10 -o heard.pcapng` keeps them to look at",
                 header ? "malformed DIS" : "no DIS", n->where, (unsigned long long)s->junk, dis_drop_cause(why),
                 header ? "their sender is to set it right"
                        : "another port may carry the exercise (--port, --address)");
        break;
    }
    case HEALTH_NOTHING:
        snprintf(out, size,
                 "nothing heard on %s for %.0f s; `pitviper record --for 5 -o heard.pcapng` shows "
                 "what comes at all; --port, --address and --interface say where",
                 n->where, s->now_s - s->any_s);
        break;
    case HEALTH_NO_HOST:
        snprintf(out, size,
                 "host %s is not heard so far, and no frame is made until it is; %d other entities "
                 "are heard (--host ID of one of them, munition or observer)",
                 n->host, s->entities);
        break;
    case HEALTH_HOST_GONE:
        snprintf(out, size,
                 "host %s is gone, and no frame is made until it is back; %d other entities are there "
                 "(--host ID of one of them, munition or observer)",
                 n->host, s->entities);
        break;
    case HEALTH_NO_MUNITION:
        snprintf(out, size,
                 "no munition flies so far, and no frame is made until one does; %d entities are heard "
                 "(--host observer looks at them meanwhile, --host ID rides on one)",
                 s->entities);
        break;
    case HEALTH_MUNITION_GONE:
        snprintf(out, size,
                 "%s is gone and no other munition flies: no frame is made until one does (--host "
                 "observer looks at the %d entities meanwhile)",
                 n->host, s->entities);
        break;
    case HEALTH_NO_TRAFFIC:
        snprintf(out, size, "frames show no entity: none but the host is there (`pitviper record` keeps what comes)");
        break;
    case HEALTH_NO_VIEW:
        snprintf(out, size,
                 "frames show no entity: none of %d is in the field of view, the nearest is %.1f km away "
                 "(--set exercise.aim=ID looks at one, sensor.hfov_deg widens, --host observer circles one)",
                 s->others, 1e-3 * s->nearest_m);
        break;
    case HEALTH_HIDDEN:
        snprintf(out, size,
                 "frames show no entity: what is in the field of view is hidden by the ground, the water "
                 "or others (--host ID of another, --set observer.height_m or exercise.aim)");
        break;
    case HEALTH_NOT_SENT:
        snprintf(out, size, "publish.dis: nothing can be sent to %s: %s%s", n->to, strerror(s->error),
                 send_advice(s->error));
        break;
    case HEALTH_LOST:
        snprintf(out, size,
                 "datagrams lost: in the kernel %llu, in the queue %llu; a larger network.queue_mb or "
                 "net.core.rmem_max, or a higher sensor.rate_hz, helps",
                 (unsigned long long)s->lost_kernel, (unsigned long long)s->lost_queue);
        break;
    case HEALTH_LATE:
        snprintf(out, size,
                 "frames left out: %llu, their time had passed; a smaller --size, fewer --bands or a "
                 "lower --rate helps",
                 (unsigned long long)s->late);
        break;
    case HEALTH_EARLY:
        snprintf(out, size,
                 "entities were heard, and it ended before the first frame was due; a longer --for, or "
                 "a shorter exercise.listen_s");
        break;
    }
}

/* ---- a node's own ---------------------------------------------------------------------------------------- */

void health_begin(Health *h, double now_s)
{
    *h = (Health){.sample = {.now_s = now_s,
                             .usable_s = now_s,
                             .any_s = now_s,
                             .frame_s = now_s,
                             .in_view_s = now_s,
                             .visible_s = now_s,
                             .lost_s = -INFINITY,
                             .late_s = -INFINITY,
                             .nearest_m = NAN}};
    for (int t = 0; t < HEALTH_TOPICS; t++) h->said_s[t] = -INFINITY;
}

void health_own(Health *h, double now_s)
{
    h->sample.own++;
    h->sample.any_s = now_s;
}

void health_received(Health *h, const DisDatagram *datagram, int exercise, bool checked, double now_s)
{
    HealthSample  *s = &h->sample;
    DisHeader      header;
    const uint8_t *at = datagram->bytes, *pdu, *end = at + datagram->octets;
    bool           any = false, usable = false;
    DisCounters    counters = {0};
    while (dis_next_pdu(&header, &pdu, &at, end, &counters)) {
        any = true;
        if (exercise >= 0 && header.exercise != exercise) {
            s->other[header.exercise]++;
            continue;
        }
        s->pdus++;
        s->type = header.type;
        usable |= header.type == dis_pdu_entity_state && (!checked || player_usable(&header, pdu));
    }
    s->any_s = now_s;
    s->junk += !any;
    for (int i = 0; i < DIS_DROP_COUNT; i++) s->dropped[i] += counters.dropped[i];
    if (!usable) return;
    s->usable++;
    s->usable_s = now_s;
    s->junk = s->own = s->pdus = 0;
    memset(s->other, 0, sizeof s->other);
    memset(s->dropped, 0, sizeof s->dropped);
}

void health_rendering(Health *h, double now_s)
{
    HealthSample *s = &h->sample;
    s->rendering = true;
    s->frame_s = s->in_view_s = s->visible_s = now_s;
}

void health_frame(Health *h, const FrameRecord *frame, double now_s)
{
    HealthSample *s = &h->sample;
    bool          visible = false;
    s->frames++;
    s->missing = 0;
    s->frame_s = now_s;
    s->others = frame->snapshot->count - (frame->host != NULL);
    if (!frame->target) s->in_view_s = s->visible_s = now_s; /* not computed: nothing to report of it */
    for (int i = 0; i < frame->target_count; i++) visible |= frame->target[i].pixels > 0;
    if (frame->target_count > 0) s->in_view_s = now_s;
    if (visible) s->visible_s = now_s;
    if (frame->target_count > 0 || s->others == 0) return;
    s->nearest_m = INFINITY;
    for (int i = 0; i < frame->snapshot->count; i++) {
        double d[3];
        if (&frame->snapshot->entity[i] == frame->host) continue;
        v3_sub(d, frame->snapshot->entity[i].p_ecef, frame->p_eye_ecef);
        s->nearest_m = fmin(s->nearest_m, v3_length(d));
    }
}

static void read_counters(HealthSample *s, const LiveCounters *c)
{
    if (c->lost_kernel + c->lost_queue > s->lost_kernel + s->lost_queue) s->lost_s = s->now_s;
    if (c->frames_late > s->late) s->late_s = s->now_s;
    s->lost_kernel = c->lost_kernel;
    s->lost_queue = c->lost_queue;
    s->late = c->frames_late;
    if (s->unsent == 0) s->failing_s = s->now_s;
    s->unsent = c->sent > s->sent ? 0 : s->unsent + c->send_failed - s->failed;
    s->sent = c->sent;
    s->failed = c->send_failed;
}

/* No message twice within a minute. The end of a condition is reported where no other message is due. */
static void say(Health *h, HealthTopic topic, const HealthNames *names)
{
    const HealthReason  reason = h->now[topic];
    const HealthSample *s = &h->sample;
    char                text[health_text_size];
    if (reason == HEALTH_AWAY) return;
    if (reason == HEALTH_FINE) {
        if (h->open[topic] && topic == HEALTH_SEND) log_info("run: publish.dis: sending to %s again", names->to);
        if (h->open[topic] && topic == HEALTH_RECEIVE && s->rendering)
            log_info("run: entities are heard on %s again", names->where);
        h->open[topic] = false;
        return;
    }
    if (reason == h->said[topic] && s->now_s - h->said_s[topic] < remind_s) return;
    health_text(text, reason, s, names);
    log_warn("run: %s", text);
    h->said[topic] = reason;
    h->said_s[topic] = s->now_s;
    h->open[topic] = true;
}

void health_check(Health *h, const LiveCounters *counters, const HealthNames *names, double now_s)
{
    h->sample.now_s = now_s;
    read_counters(&h->sample, counters);
    for (int t = 0; t < HEALTH_TOPICS; t++) {
        const HealthReason reason = health_evaluate((HealthTopic)t, &h->sample);
        if (reason == h->now[t]) continue;
        h->now[t] = reason;
        say(h, (HealthTopic)t, names);
    }
}

void health_line(char out[health_line_size], const Health *h, const HealthPace *pace)
{
    const HealthSample *s = &h->sample;
    size_t              n = (size_t)snprintf(out, health_line_size, "%d entities", s->entities);
    if (pace->rate_hz > 0)
        n +=
            (size_t)snprintf(out + n, health_line_size - n, "  kept %.1f of %g frames/s", pace->kept_hz, pace->rate_hz);
    if (pace->step) n += (size_t)snprintf(out + n, health_line_size - n, "  %s", pace->step);
    n += (size_t)snprintf(out + n, health_line_size - n, "  %llu late", (unsigned long long)s->late);
    if (isfinite(pace->latency_s))
        n += (size_t)snprintf(out + n, health_line_size - n, "  %.0f ms", 1e3 * pace->latency_s);
    n += (size_t)snprintf(out + n, health_line_size - n, "  %llu lost",
                          (unsigned long long)(s->lost_kernel + s->lost_queue));
    if (s->over_rate > 0 && n < health_line_size)
        n += (size_t)snprintf(out + n, health_line_size - n, "  %llu over rate", (unsigned long long)s->over_rate);
    if (s->preparing > 0 && n < health_line_size)
        n += (size_t)snprintf(out + n, health_line_size - n, "  preparing %d", s->preparing);
    if (*pace->left_out && n < health_line_size)
        n += (size_t)snprintf(out + n, health_line_size - n, "  left out: %s", pace->left_out);
    for (int t = 0; t < HEALTH_LOSS && n < health_line_size; t++)
        if (h->now[t] != HEALTH_FINE)
            n += (size_t)snprintf(out + n, health_line_size - n, "  %s", health_name(h->now[t]));
}

void health_losses(HealthLosses *l, uint64_t lost, const char *left_out, double now_s, bool last)
{
    if (lost == l->said || (!last && l->said_s > 0 && now_s - l->said_s < remind_s)) return;
    log_warn(
        "run: do not keep up with the frames: %s left out; the others get theirs (latency_ms in run.json counts them)",
        left_out);
    l->said = lost;
    l->said_s = now_s;
}

/* ---- at the end: what a run heard, made, kept and could not write ----------------------------------- */

void health_summary(const LiveCounters *c, const HealthSample *s, uint64_t own)
{
    static const double enough_share = 0.5; /* of the frames asked for: fewer are worth a warning */
    char                sent[80] = "";
    if (s->publishes)
        snprintf(sent, sizeof sent, "; PDUs sent %llu, not sent %llu", (unsigned long long)c->sent,
                 (unsigned long long)c->send_failed);
    const uint64_t frames = s->frames;
    log_info("run: %llu datagrams heard, %llu of them our own; lost %llu; frames made %llu, left out %llu%s",
             (unsigned long long)c->datagrams, (unsigned long long)own,
             (unsigned long long)(c->lost_kernel + c->lost_queue), (unsigned long long)frames,
             (unsigned long long)c->frames_late, sent);
    const double share = record_live_kept_share(c, frames);
    if (frames > 0 && share < enough_share)
        log_warn(
            "run: kept %.3g of %g frames a second, fewer than half: lower sensor.rate_hz (--rate), the size, or the "
            "quality (quality.budget, sensor.samples), or render fewer bands",
            share * c->rate_hz, c->rate_hz);
    else if (frames > 0) log_info("run: kept %.3g of %g frames a second", share * c->rate_hz, c->rate_hz);
    if (c->files_failed || c->files_left_out)
        log_warn("run: frames without their files: %llu for want of time, %llu could not be written; --no-png or "
                 "--no-files leaves more time",
                 (unsigned long long)c->files_left_out, (unsigned long long)c->files_failed);
}
