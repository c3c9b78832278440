/* dis/cigi/cigi_session.c: the lockstep of a CIGI host and this image generator, as a state machine. */
#include "dis/cigi/cigi_session.h"

#include <assert.h>

CigiSessionConfig cigi_session_default_config(void)
{
    return (CigiSessionConfig){.repeat_s = 0.25, .silent_s = 5, .ahead_s = 600};
}

int64_t cigi_unwrap(int64_t last_ticks, uint32_t stamp)
{
    return last_ticks + (int32_t)(stamp - (uint32_t)(uint64_t)last_ticks);
}

/* ---- what is sent ------------------------------------------------------------------------------- */

/* Start of Frame of the present number with the answers that wait. */
static void make_start(CigiSession *s, double now_s)
{
    const CigiPacket start = {.id = cigi_start_of_frame,
                              .of.start_of_frame = {.status = s->status,
                                                    .mode = s->mode,
                                                    .timestamp_valid = s->timed,
                                                    .ig_frame = s->ig_frame,
                                                    .timestamp = s->stamp,
                                                    .last_host_frame = s->host_frame}};
    s->out_octets = cigi_write(s->out, sizeof s->out, &start, CIGI_BIG_ENDIAN);
    memcpy(s->out + s->out_octets, s->answer, s->answer_octets);
    s->out_octets += s->answer_octets;
    s->answer_octets = 0;
    s->to_send = s->waits = true;
    s->sent_s = now_s;
}

void cigi_session_begin(CigiSession *s, const CigiSessionConfig *config, double now_s)
{
    *s = (CigiSession){.config = *config, .mode = cigi_mode_standby, .ig_frame = 1, .heard_s = now_s};
    make_start(s, now_s);
}

static uint8_t *host_bits(CigiPacket *response)
{
    switch (response->id) {
    case cigi_hat_hot_response:
        return &response->of.hat_hot_response.host_frame;
    case cigi_hat_hot_extended_response:
        return &response->of.hat_hot_extended_response.host_frame;
    case cigi_los_response:
        return &response->of.los_response.host_frame;
    case cigi_los_extended_response:
        return &response->of.los_extended_response.host_frame;
    default:
        return NULL;
    }
}

bool cigi_session_answer(CigiSession *s, const CigiPacket *response)
{
    enum { start_octets = 24 };
    CigiPacket     packet = *response;
    uint8_t *const bits = host_bits(&packet);
    if (bits) *bits = s->host_frame & 15;
    const size_t room = sizeof s->answer - start_octets - s->answer_octets;
    const size_t octets = cigi_write(s->answer + s->answer_octets, room, &packet, CIGI_BIG_ENDIAN);
    s->answer_octets += octets;
    s->events.unanswered += octets == 0;
    return octets > 0;
}

void cigi_session_delivered(CigiSession *s, double now_s)
{
    assert(!s->waits);
    s->ig_frame = s->ig_frame == UINT32_MAX ? 1 : s->ig_frame + 1; /* 0 is that of a host that has received none */
    make_start(s, now_s);
}

bool cigi_session_send(const uint8_t **datagram, size_t *octets, CigiSession *s)
{
    if (!s->to_send) return false;
    s->to_send = false;
    *datagram = s->out;
    *octets = s->out_octets;
    return true;
}

static void send_again(CigiSession *s, double now_s)
{
    s->to_send = true;
    s->sent_s = now_s;
    s->events.repeats++;
}

bool cigi_session_look(CigiSession *s, double now_s)
{
    if (!s->waits) { /* a frame takes as long as it takes: the host is not silent, but waits */
        s->heard_s = now_s;
        return false;
    }
    if (now_s - s->sent_s >= s->config.repeat_s) send_again(s, now_s);
    if (!s->heard || s->silent || now_s - s->heard_s < s->config.silent_s) return false;
    s->silent = true;
    s->events.silences++;
    return true;
}

/* ---- what is received --------------------------------------------------------------------------- */

/* Order of a frame's number in numbers that wrap: < 0 before, 0 the same. */
static int32_t number_order(uint32_t a, uint32_t b) { return (int32_t)(a - b); }

/* Whether the host has begun anew: its numbers go back in mode Reset/Standby, or farther than the network mixes up the
 * order of datagrams. */
static bool restarted(const CigiSession *s, const CigiIgControl *c)
{
    enum { mixed_up = 64 };
    const int32_t ahead = number_order(c->host_frame, s->host_frame);
    return ahead < -mixed_up || (ahead < 0 && c->mode == cigi_mode_standby);
}

/* Whether it answers a Start of Frame before the present one. A host that does not say which it answers, as those
 * before 3.2, answers the present one. */
static bool answers_older(const CigiSession *s, const CigiIgControl *c)
{
    return c->last_ig_frame != 0 && number_order(c->last_ig_frame, s->ig_frame) < 0;
}

/* Takes the host's time; false: the frame has none, or one before the last, or far after it. */
static bool take_time(CigiSession *s, const CigiIgControl *c)
{
    int64_t ticks;
    if (c->timestamp_valid) {
        ticks = s->timed ? cigi_unwrap(s->ticks, c->timestamp) : (int64_t)c->timestamp;
    } else {
        s->events.unstamped++;
        s->news |= CIGI_NEWS_UNSTAMPED;
        if (!(s->config.unstamped_ticks > 0)) return false;
        ticks = s->timed ? s->ticks + llround(s->config.unstamped_ticks) : 0;
    }
    if (s->timed && ticks < s->ticks) {
        s->events.time_back++;
        s->news |= CIGI_NEWS_TIME_BACK;
        return false;
    }
    if (s->timed && !s->rested && (double)(ticks - s->ticks) > s->config.ahead_s * cigi_ticks_per_s) {
        s->events.time_ahead++;
        s->news |= CIGI_NEWS_TIME_AHEAD;
        return false;
    }
    s->rested = false;
    s->ticks = ticks;
    s->stamp = (uint32_t)(uint64_t)ticks;
    return s->timed = true;
}

/* The numbers of the host's frames that are missing before this one. */
static void count_lost(CigiSession *s, const CigiIgControl *c)
{
    const int32_t ahead = number_order(c->host_frame, s->host_frame);
    if (ahead <= 1) return;
    s->events.lost += (uint64_t)(ahead - 1);
    s->news |= CIGI_NEWS_LOST;
}

static CigiEvent new_frame(CigiSession *s, const CigiIgControl *c)
{
    const bool extra = !s->waits || (s->heard && answers_older(s, c));
    s->reads = true;
    s->host_frame = c->host_frame;
    s->heard = true;
    if (extra) {
        s->events.extra++;
        return CIGI_EXTRA;
    }
    if (c->mode != s->mode) {
        s->mode = c->mode;
        s->news |= CIGI_NEWS_MODE;
    }
    s->waits = s->to_send = false;
    s->rested |= s->mode == cigi_mode_standby;
    const bool makes = s->mode != cigi_mode_standby && take_time(s, c);
    if (makes) s->events.frames++;
    else s->events.idle++;
    return makes ? CIGI_DUE : CIGI_IDLE;
}

CigiEvent cigi_session_receive(CigiSession *s, const uint8_t *datagram, size_t octets, double now_s)
{
    CigiPacket first;
    s->news = 0;
    s->reads = false;
    if (cigi_open(&s->reader, &first, &s->counters, datagram, octets, CIGI_FROM_HOST) != STATUS_OK) return CIGI_REFUSED;
    CigiIgControl *const c = &first.of.ig_control;
    if (c->mode == cigi_mode_maintenance) c->mode = s->mode; /* no host may ask for it */
    if (s->silent) s->news |= CIGI_NEWS_BACK;
    s->silent = false;
    s->heard_s = now_s;
    if (!s->heard) {
        s->news |= CIGI_NEWS_FIRST;
    } else if (restarted(s, c)) {
        s->news |= CIGI_NEWS_RESTARTED;
        s->events.restarts++;
        s->timed = false;
        s->ticks = 0;
    } else if (c->host_frame == s->host_frame) {
        s->events.repeated++;
        if (s->waits && !s->to_send) send_again(s, now_s);
        return CIGI_REPEATED;
    } else if (number_order(c->host_frame, s->host_frame) < 0) {
        s->events.old++;
        return CIGI_OLD;
    } else {
        count_lost(s, c);
    }
    return new_frame(s, c);
}

unsigned cigi_session_news(const CigiSession *s) { return s->news; }

bool cigi_session_packet(CigiPacket *out, CigiSession *s)
{
    return s->reads && cigi_next(out, &s->reader, &s->counters);
}

double cigi_session_time_s(const CigiSession *s) { return (double)s->ticks / cigi_ticks_per_s; }

uint8_t cigi_session_mode(const CigiSession *s) { return s->mode; }
