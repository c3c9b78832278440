/* sensor/node/cigi/cigi_node.c: datagrams of a node's CIGI host: into its lockstep, its scene and its answers. */
#include "sensor/node/cigi/cigi_node.h"

#include <inttypes.h>
#include <stdlib.h>

Status cigi_node_open(CigiNode **out, const Config *config, const char *log)
{
    const CigiSessionConfig session = cigi_session_default_config();
    CigiNode               *node = calloc(1, sizeof *node);
    if (!node) return STATUS_NO_MEMORY;
    Status     status = cigi_types_read(&node->drawn.types, config->exercise.cigi_types);
    const bool recorded = log && cigi_link_recorded(config->exercise.cigi);
    node->port = config->exercise.cigi_port;
    if (status == STATUS_OK)
        status = recorded ? cigi_recorded_open(&node->recorded, log, node->port)
                          : cigi_link_open(&node->link, config->exercise.cigi, node->port);
    if (status != STATUS_OK) {
        cigi_node_close(node);
        return status;
    }
    node->view = (uint16_t)config->exercise.cigi_view;
    node->drawn.site = (uint16_t)config->node.site;
    node->drawn.application = (uint16_t)config->node.application;
    node->drawn.by_arrival = config->exercise.causal;
    node->hfov_deg = config->sensor.hfov_deg;
    cigi_session_begin(&node->session, &session, wall_clock_s());
    if (recorded) log_info("cigi: the eye and the frames are those of the host in %s", log);
    else
        log_info("cigi: in step with the host at %s; it is listened to on port %d, and has the eye (view %d)",
                 config->exercise.cigi, config->exercise.cigi_port, config->exercise.cigi_view);
    *out = node;
    return STATUS_OK;
}

/* ---- what was counted --------------------------------------------------------------------------- */

static void say_counted(const CigiNode *node)
{
    const CigiSessionCounters *e = &node->session.events;
    const CigiCounters        *c = &node->session.counters;
    log_info("cigi: %" PRIu64 " frames asked for, %" PRIu64
             " of the host without a picture; Start of Frame sent again %" PRIu64
             " times; of the host's datagrams %" PRIu64 " repeated, %" PRIu64 " old, %" PRIu64 " ahead; %" PRIu64
             " of its frames lost",
             e->frames, e->idle, e->repeats, e->repeated, e->old, e->extra, e->lost);
    for (int i = 0; i < CIGI_DROP_COUNT; i++)
        if (c->dropped[i]) log_warn("cigi: %" PRIu64 " dropped: %s", c->dropped[i], cigi_drop_cause((CigiDrop)i));
    for (int i = 0; i < 256; i++)
        if (c->skipped[i])
            log_warn("cigi: %" PRIu64 " packets of id %d, which this program does not read, are skipped", c->skipped[i],
                     i);
    if (node->scene.refused)
        log_warn("cigi: %" PRIu64 " entities and views are out of range, or too many", node->scene.refused);
    if (node->drawn.unmapped)
        log_warn("cigi: %" PRIu64 " entities have a type that the table of types has not, and are not drawn "
                 "(exercise.cigi_types)",
                 node->drawn.unmapped);
    if (node->requests_lost + e->unanswered)
        log_warn("cigi: %" PRIu64 " requests did not fit into a frame (%d), or its answers into a datagram",
                 node->requests_lost + e->unanswered, cigi_requests_most);
    if (node->link && cigi_link_foreign(node->link) + cigi_link_unsent(node->link))
        log_warn("cigi: %" PRIu64 " datagrams of others than the host are not used; %" PRIu64 " could not be sent",
                 cigi_link_foreign(node->link), cigi_link_unsent(node->link));
}

void cigi_node_close(CigiNode *node)
{
    if (!node) return;
    if (node->link || node->recorded) say_counted(node);
    cigi_recorded_close(node->recorded);
    cigi_link_close(node->link);
    free(node);
}

/* ---- what is sent ------------------------------------------------------------------------------- */

static void send_due(CigiNode *node)
{
    const uint8_t *datagram;
    size_t         octets;
    if (cigi_session_send(&datagram, &octets, &node->session) && node->link)
        cigi_link_send(node->link, datagram, octets);
}

static void answer(CigiNode *node, const CigiPacket *request, const CigiGround *ground)
{
    CigiPacket response;
    if (cigi_answer(&response, request, &node->scene, ground, node->session.ig_frame))
        cigi_session_answer(&node->session, &response);
}

void cigi_node_delivered(CigiNode *node, const CigiGround *ground)
{
    for (int i = 0; i < node->standing_count; i++) {
        CigiStanding *s = &node->standing[i];
        if (s->left-- > 0) continue;
        answer(node, &s->request, ground);
        s->left = s->period - 1;
    }
    for (int i = 0; i < node->requests; i++) answer(node, &node->request[i], ground);
    node->requests = 0;
    cigi_session_delivered(&node->session, wall_clock_s());
    send_due(node);
}

/* ---- what is received --------------------------------------------------------------------------- */

static void once(bool *said, const char *text)
{
    if (!*said) log_warn("cigi: %s", text);
    *said = true;
}

static void take_view_definition(CigiNode *node, const CigiViewDefinition *d)
{
    if (d->view != node->view || !d->left_on || !d->right_on) return;
    if (fabs((double)d->right_deg - (double)d->left_deg - node->hfov_deg) < 0.01) return;
    if (!node->other_fov)
        log_warn("cigi: the host's View Definition is %g deg wide, the sensor %g: the sensor's stays (sensor.hfov_deg)",
                 (double)d->right_deg - (double)d->left_deg, node->hfov_deg);
    node->other_fov = true;
}

/* The period of a request, and which it is: HAT/HOT and Line of Sight number theirs apart. */
static int period_of(uint32_t *which, const CigiPacket *packet)
{
    enum { of_heights = 1 << 16, of_sights = 2 << 16 };
    const CigiHatHotRequest     *height = &packet->of.hat_hot_request;
    const CigiLosSegmentRequest *segment = &packet->of.los_segment_request;
    const CigiLosVectorRequest  *vector = &packet->of.los_vector_request;
    *which = 0;
    switch (packet->id) {
    case cigi_hat_hot_request:
        return *which = of_heights | height->id, height->period;
    case cigi_los_segment_request:
        return *which = of_sights | segment->id, segment->period;
    case cigi_los_vector_request:
        return *which = of_sights | vector->id, vector->period;
    default:
        return 0;
    }
}

/* A request with a period stands until another of its number comes. */
static void keep_request(CigiNode *node, const CigiPacket *packet)
{
    uint32_t  which, other;
    const int period = period_of(&which, packet);
    for (int i = 0; which && i < node->standing_count; i++) {
        period_of(&other, &node->standing[i].request);
        if (other == which) node->standing[i--] = node->standing[--node->standing_count];
    }
    const bool stands = period > 0;
    if (stands && node->standing_count < cigi_requests_most)
        node->standing[node->standing_count++] = (CigiStanding){*packet, period, 0};
    else if (!stands && node->requests < cigi_requests_most) node->request[node->requests++] = *packet;
    else node->requests_lost++;
}

static void take_packet(CigiNode *node, const CigiPacket *packet)
{
    switch (packet->id) {
    case cigi_view_definition:
        take_view_definition(node, &packet->of.view_definition);
        break;
    case cigi_los_segment_request:
    case cigi_los_vector_request:
    case cigi_hat_hot_request:
    case cigi_sensor_control:
        keep_request(node, packet);
        break;
    default:
        break;
    }
    cigi_scene_take(&node->scene, packet);
}

static void say_news(CigiNode *node)
{
    const CigiSession       *s = &node->session;
    static const char *const mode[] = {"Reset/Standby", "Operate", "Debug", "maintenance"};
    const unsigned           news = cigi_session_news(s);
    if (news & CIGI_NEWS_FIRST) log_info("cigi: the host is heard, frame %" PRIu32, s->host_frame);
    if (news & CIGI_NEWS_RESTARTED) log_warn("cigi: the host has begun anew, frame %" PRIu32, s->host_frame);
    if (news & CIGI_NEWS_MODE) log_info("cigi: the host asks for mode %s", mode[cigi_session_mode(s)]);
    if (news & CIGI_NEWS_BACK) log_info("cigi: the host is heard again");
    if (news & CIGI_NEWS_TIME_BACK && s->events.time_back == 1)
        log_warn("cigi: the host's time went back, before %.5f s: its frames have no picture until it is later",
                 cigi_session_time_s(s));
    if (news & CIGI_NEWS_TIME_AHEAD && s->events.time_ahead == 1)
        log_warn(
            "cigi: the host's time went ahead by more than %g s, from %.5f s: its frames have no picture until it is "
            "nearer, or the host was in mode Reset/Standby",
            s->config.ahead_s, cigi_session_time_s(s));
    if (news & CIGI_NEWS_UNSTAMPED)
        once(&node->unstamped, "the host's time stamps are not valid: its frames have no picture");
}

/* Once, where a host that never answers may have another address or port. */
static void say_unheard(CigiNode *node)
{
    const CigiSession *s = &node->session;
    if (node->asked_s == 0) node->asked_s = wall_clock_s();
    if (s->heard || node->unheard || node->recorded || wall_clock_s() - node->asked_s < s->config.silent_s) return;
    node->unheard = true;
    log_warn(
        "cigi: no host has answered Start of Frame for %g s; it is sent on: exercise.cigi and exercise.cigi_port say "
        "where to and from",
        s->config.silent_s);
}

/* The host's next datagram, which goes into the recording. */
static bool receive(const uint8_t **datagram, size_t *octets, CigiNode *node, double wait_s)
{
    uint8_t  from[16];
    uint16_t port;
    if (node->recorded) {
        node->over = !cigi_recorded_take(datagram, octets, node->recorded);
        return !node->over;
    }
    if (!cigi_link_receive(datagram, octets, node->link, wait_s)) return false;
    node->received++;
    cigi_link_host(from, &port, node->link);
    if (node->tap.datagram) node->tap.datagram(node->tap.user, from, port, *datagram, *octets);
    return true;
}

double cigi_node_offset_s(const CigiNode *node) { return cigi_recorded_offset_s(node->recorded); }

void cigi_node_note_offset(const CigiNode *node, double offset_s)
{
    char text[cigi_time_note_size];
    cigi_time_note_text(text, &(CigiTimeNote){node->received, offset_s, node->port});
    if (node->tap.note) node->tap.note(node->tap.user, text);
}

CigiEvent cigi_node_wait(CigiNode *node, const CigiGround *ground, double wait_s)
{
    CigiSession   *s = &node->session;
    const uint8_t *datagram;
    size_t         octets;
    CigiPacket     packet;
    send_due(node);
    say_unheard(node);
    const bool heard = receive(&datagram, &octets, node, wait_s);
    CigiEvent  event = heard ? cigi_session_receive(s, datagram, octets, wall_clock_s()) : CIGI_REFUSED;
    if (event != CIGI_REFUSED) say_news(node);
    if (heard && cigi_session_news(s) & CIGI_NEWS_RESTARTED) node->standing_count = node->requests = 0;
    while (heard && cigi_session_packet(&packet, s)) take_packet(node, &packet);
    if (event == CIGI_IDLE) cigi_node_delivered(node, ground);
    if (cigi_session_look(s, wall_clock_s()))
        log_warn("cigi: the host has been silent for %g s; Start of Frame %" PRIu32 " is sent again until it answers",
                 s->config.silent_s, s->ig_frame);
    send_due(node);
    return event;
}

bool cigi_node_fix(CigiNode *node, double t_s)
{
    CigiFix fix = {.t_s = t_s};
    if (!cigi_scene_view(fix.p_ecef, fix.r_ecef_from_view, &node->scene, node->view)) {
        once(&node->unseen, "the host has not said where the eye is: Entity Control of the entity that its view is on");
        return false;
    }
    fix.rated = cigi_scene_view_rates(fix.v_ecef_mps, fix.w_ecef_rps, &node->scene, node->view);
    node->fix[1] = node->fix[0];
    node->fix[0] = fix;
    node->fixes = node->fixes < 2 ? node->fixes + 1 : 2;
    return true;
}
