/* tests/sensor/test_cigi_clock.c: the clock of a CIGI host, this test being the host on loopback: frame times and ends
 * against lists by hand, heights on ground that is a plane. */
#include "tests/check.h"
#include "dis/cigi/cigi_datagram.h"
#include "sensor/node/clock/cigi_clock.h"

#include <arpa/inet.h>
#include <sys/socket.h>

static int       udp;
static CigiClock c;
static uint32_t  frame_number;

static int open_port(int *number)
{
    struct sockaddr_in here = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t          size = sizeof here;
    const int          opened = socket(AF_INET, SOCK_DGRAM, 0);
    CHECK(opened >= 0 && bind(opened, (struct sockaddr *)&here, size) == 0);
    CHECK(getsockname(opened, (struct sockaddr *)&here, &size) == 0);
    *number = ntohs(here.sin_port);
    return opened;
}

static int node_port;

static void begin(double from_s, double to_s)
{
    Config config = config_default();
    int    host_port;
    udp = open_port(&host_port);
    close(open_port(&node_port));
    snprintf(config.exercise.cigi, sizeof config.exercise.cigi, "127.0.0.1:%d", host_port);
    config.exercise.cigi_port = node_port;
    config.exercise.cigi_view = 2;
    c = cigi_clock(NULL);
    CHECK(cigi_node_open(&c.node, &config, NULL) == STATUS_OK);
    c.from_s = from_s;
    c.to_s = to_s;
    frame_number = 0;
}

static void end(void)
{
    cigi_node_close(c.node);
    close(udp);
}

static bool stamped = true; /* what the host says is with a valid time */

/* The host's next datagram: IG Control and what is given, 0 or 1 packet. */
static void say_as(uint8_t mode, double t_s, const CigiPacket *more)
{
    const struct sockaddr_in to = {
        .sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK), .sin_port = htons((uint16_t)node_port)};
    const CigiPacket control = {.id = cigi_ig_control,
                                .of.ig_control = {.mode = mode,
                                                  .timestamp_valid = stamped,
                                                  .host_frame = ++frame_number,
                                                  .timestamp = (uint32_t)llround(t_s * cigi_ticks_per_s)}};
    uint8_t          out[128];
    size_t           octets = cigi_write(out, sizeof out, &control, CIGI_LITTLE_ENDIAN);
    if (more) octets += cigi_write(out + octets, sizeof out - octets, more, CIGI_LITTLE_ENDIAN);
    CHECK(sendto(udp, out, octets, 0, (const struct sockaddr *)&to, sizeof to) == (ssize_t)octets);
}
static void say(double t_s, const CigiPacket *more) { say_as(cigi_mode_operate, t_s, more); }

static const CigiPacket eye = {.id = cigi_entity_control, .of.entity_control = {.state = 1, .p = {0, 0, 500}}};

/* The clock's answer once there is one other than that it is early and the host has been heard; `early`: it may be. */
static ClockAnswer wait_for(FrameTime *frame, bool early)
{
    const uint64_t heard = c.node->session.counters.datagrams;
    for (;;) {
        CHECK(c.clock.next(frame, &c.clock) == CLOCK_DUE);
        const ClockAnswer answer = c.clock.wait(frame, &c.clock);
        if (answer != CLOCK_EARLY || (early && c.node->session.counters.datagrams > heard)) return answer;
    }
}

/* The number of the Start of Frame that comes next; packet: the first packet behind it, id 0: none. */
static uint32_t heartbeat(CigiPacket *behind)
{
    uint8_t       in[2048];
    CigiCounters  counters = {0};
    CigiReader    reader;
    CigiPacket    start;
    const ssize_t octets = recv(udp, in, sizeof in, 0);
    CHECK(octets > 0);
    CHECK(cigi_open(&reader, &start, &counters, in, (size_t)octets, CIGI_FROM_IG) == STATUS_OK);
    if (behind && !cigi_next(behind, &reader, &counters)) behind->id = 0;
    return start.of.start_of_frame.ig_frame;
}

static void frames_are_those_of_the_host(void **state)
{
    (void)state;
    FrameTime frame;
    begin(10, 20);
    say_as(cigi_mode_standby, 0, NULL);
    CHECK(wait_for(&frame, true) == CLOCK_EARLY);
    CHECK(heartbeat(NULL) == 1 && heartbeat(NULL) == 2);
    say(9, NULL); /* it has not said where the eye is */
    CHECK(wait_for(&frame, true) == CLOCK_EARLY && heartbeat(NULL) == 3);
    say(9.99, &eye); /* before the first frame that there is */
    CHECK(wait_for(&frame, true) == CLOCK_EARLY && heartbeat(NULL) == 4);
    static const double times_s[] = {10, 10.00001, 10.5, 10.5, 19.99999, 20};
    for (int i = 0; i < 6; i++) {
        say(times_s[i], &eye);
        CHECK(wait_for(&frame, false) == CLOCK_DUE && frame.number == i && frame.late_s == 0 && frame.dropped == 0);
        CHECK_NEAR(frame.t_s, times_s[i], 1e-12);
        CHECK(recv(udp, &(char){0}, 1, MSG_DONTWAIT) < 0); /* nothing is said before the frame is made */
        c.clock.done(&c.clock, &frame);
        CHECK(heartbeat(NULL) == 5 + (uint32_t)i);
    }
    say(20.00001, &eye);
    CHECK(wait_for(&frame, false) == CLOCK_END);
    end();
}

static void a_host_that_begins_anew_before_the_last_frame_ends_it(void **state)
{
    (void)state;
    FrameTime frame;
    for (int later = 0; later < 2; later++) {
        begin(0, INFINITY);
        frame_number = 500;
        say(8, &eye);
        CHECK(wait_for(&frame, false) == CLOCK_DUE);
        c.clock.done(&c.clock, &frame);
        frame_number = 0;
        say_as(cigi_mode_standby, 0, NULL);
        CHECK(wait_for(&frame, true) == CLOCK_EARLY);
        say(later ? 8.5 : 1, &eye);
        CHECK(wait_for(&frame, false) == (later ? CLOCK_DUE : CLOCK_END));
        if (later) CHECK(frame.number == 1 && frame.t_s == 8.5);
        end();
    }
}

static int  warnings;
static void count_warnings(void *user, LogLevel level, const char *line)
{
    (void)user;
    if (level == LOG_WARN && strstr(line, "cigi: the host")) warnings++;
}

/* Frames without a valid time, times that go back, and such that go ahead by an hour: each is said once, however many
 * come, and whatever modes are between; a host with valid stamps is not complained of. */
static void what_is_wrong_with_time_is_said_once(void **state)
{
    (void)state;
    enum { unstamped, back, ahead, well };
    FrameTime frame;
    log_set_sink(count_warnings, NULL);
    for (int what = unstamped; what <= well; what++) {
        begin(0, INFINITY);
        warnings = 0;
        say(100, &eye);
        CHECK(wait_for(&frame, false) == CLOCK_DUE);
        c.clock.done(&c.clock, &frame);
        for (int i = 0; i < 12; i++) {
            stamped = what != unstamped;
            say_as(i % 4 == 3 ? cigi_mode_standby : cigi_mode_operate,
                   what == back    ? 50
                   : what == ahead ? 3800
                                   : 100,
                   &eye);
            stamped = true;
            const ClockAnswer answer = wait_for(&frame, true);
            CHECK(answer == (what == well && i % 4 != 3 ? CLOCK_DUE : CLOCK_EARLY) || (what == ahead && i >= 4));
            if (answer == CLOCK_DUE) c.clock.done(&c.clock, &frame);
        }
        CHECK(warnings == (what != well));
        end();
    }
    log_set_sink(NULL, NULL);
}

/* One answer to a request, behind the next Start of Frame. */
static void ask(CigiPacket *answer, const CigiPacket *request)
{
    FrameTime frame;
    say(frame_number, request);
    CHECK(wait_for(&frame, false) == CLOCK_DUE);
    c.clock.done(&c.clock, &frame);
    while (heartbeat(answer) < frame_number + 1) {
    }
}

/* Posts of height 0 at the tangent plane of latitude and longitude 0: the plane x = 6378137 of ECEF. A place l east of
 * it on the equator has its surface at a / cos l - a above the ellipsoid, and the normal leans by l to the west. */
static Landscape  landscape;
static LocalFrame here;

static void plane(void)
{
    LandscapeConfig     config = landscape_default_config();
    const ElevationGrid grid = {.nx = 2001, .ny = 201, .x0_m = -10000, .y0_m = -1000, .spacing_m = 10, .step_m = 0.01};
    CHECK(local_frame_at(&here, &(Geodetic){0}) == STATUS_OK);
    CHECK(landscape_create(&landscape, &config, &here, NULL, 0, NULL, 0) == STATUS_OK);
    elevation_destroy(&landscape.elevation);
    CHECK(elevation_level_create(&landscape.elevation, 0, &grid) == STATUS_OK);
    elevation_build_pyramids(&landscape.elevation);
}

static void heights_are_those_of_the_ground(void **state)
{
    (void)state;
    const double                            a_m = 6378137;
    FrameTime                               frame;
    CigiPacket                              answer;
    CigiPacket                              request = {.id = cigi_hat_hot_request,
                                                       .of.hat_hot_request = {.id = 31, .type = cigi_request_extended, .p = {0, 0.05, 500}}};
    CigiHatHotRequest *const                r = &request.of.hat_hot_request;
    const CigiHatHotExtendedResponse *const x = &answer.of.hat_hot_extended_response;
    plane();
    begin(0, INFINITY);
    say(1, &eye);
    CHECK(wait_for(&frame, false) == CLOCK_DUE && heartbeat(NULL) == 1);
    c.clock.done(&c.clock, &frame);
    ask(&answer, &request);
    CHECK(answer.id == cigi_hat_hot_extended_response && x->id == 31 && !x->valid); /* there is no ground */
    CHECK(x->host_frame == 2);
    c.ground = (CigiGround){&landscape, &here};
    for (int k = 0; k < 4; k++) {
        const double l_deg = 0.02 * k, hot_m = a_m / cos(l_deg * rad_per_deg) - a_m;
        r->p[1] = l_deg;
        ask(&answer, &request);
        CHECK(x->valid);
        CHECK_NEAR(x->hot_m, hot_m, 1e-6);
        CHECK_NEAR(x->hat_m, 500 - hot_m, 1e-6);
        CHECK_NEAR(x->normal_elevation_deg, 90 - l_deg, 1e-5);
        if (k) CHECK_NEAR(x->normal_azimuth_deg, -90, 1e-3);
        CHECK(x->material == (uint32_t)landscape_surface(&landscape, a_m * tan(l_deg * rad_per_deg), 0));
    }
    r->p[1] = 0.1; /* 11 km: beyond the posts */
    ask(&answer, &request);
    CHECK(!x->valid && x->hot_m == 0);
    r->type = cigi_request_hot;
    r->p[1] = 0.02;
    ask(&answer, &request);
    CHECK(answer.id == cigi_hat_hot_response && answer.of.hat_hot_response.valid && answer.of.hat_hot_response.hot);
    CHECK_NEAR(answer.of.hat_hot_response.height_m, a_m / cos(0.02 * rad_per_deg) - a_m, 1e-6);
    end();
    landscape_destroy(&landscape);
}

/* The same plane, from 500 m over its origin: straight down 500 m, by 30 degrees down 1000 m, whatever the azimuth; a
 * place 1 m above it is seen, one 1 m below it is hidden by the ground where the line crosses x = a. */
static void lines_of_sight_end_at_the_ground(void **state)
{
    (void)state;
    const double                         a_m = 6378137, l_rad = 0.05 * rad_per_deg, hot_m = a_m / cos(l_rad) - a_m;
    FrameTime                            frame;
    CigiPacket                           answer;
    const CigiLosResponse *const         short_form = &answer.of.los_response;
    const CigiLosExtendedResponse *const x = &answer.of.los_extended_response;
    plane();
    begin(0, INFINITY);
    say(1, &eye);
    CHECK(wait_for(&frame, false) == CLOCK_DUE && heartbeat(NULL) == 1);
    c.clock.done(&c.clock, &frame);

    CigiPacket                  along = {.id = cigi_los_vector_request,
                                         .of.los_vector_request = {.id = 8, .elevation_deg = -90, .most_m = 5000, .from = {0, 0, 500}}};
    CigiLosVectorRequest *const v = &along.of.los_vector_request;
    ask(&answer, &along);
    CHECK(answer.id == cigi_los_response && short_form->id == 8 && !short_form->valid); /* there is no ground */
    c.ground = (CigiGround){&landscape, &here};
    ask(&answer, &along);
    CHECK(short_form->valid && !short_form->entity_valid && short_form->count == 1);
    CHECK_NEAR(short_form->range_m, 500, 1e-6);
    v->extended = true;
    v->elevation_deg = -30;
    for (int k = 0; k < 4; k++) {
        v->azimuth_deg = 90 * (float)k;
        ask(&answer, &along);
        CHECK(answer.id == cigi_los_extended_response && x->valid && x->range_valid && x->alpha == 255);
        CHECK_NEAR(x->range_m, 1000, 1e-5);
        const double east_m = k % 2 ? (k == 1 ? 1 : -1) * 1000 * cos(30 * rad_per_deg) : 0;
        CHECK_NEAR(x->p[1], atan2(east_m, a_m) / rad_per_deg, 1e-10);
        if (k % 2) CHECK_NEAR(x->p[2], hypot(a_m, east_m) - a_m, 1e-5);
        else CHECK(k == 0 ? x->p[0] > 0 : x->p[0] < 0); /* north, south */
        CHECK_NEAR(x->normal_elevation_deg, 90, 0.02);
    }
    v->least_m = 1001; /* an intersection before the least range */
    ask(&answer, &along);
    CHECK(x->valid && !x->range_valid && x->range_m == 0);
    v->least_m = 0;
    v->most_m = 999;
    ask(&answer, &along);
    CHECK(!x->range_valid);
    v->from_entity = true; /* entity 0 is at latitude and longitude 0, 500 m: straight down from 100 m below it */
    v->elevation_deg = -90;
    v->from[2] = 100;
    ask(&answer, &along);
    CHECK_NEAR(x->range_m, 400, 1e-5);

    CigiPacket                   to = {.id = cigi_los_segment_request,
                                       .of.los_segment_request = {.id = 9, .from = {0, 0, 500}, .to = {0, 0.05, hot_m + 1}}};
    CigiLosSegmentRequest *const g = &to.of.los_segment_request;
    ask(&answer, &to);
    CHECK(answer.id == cigi_los_response && short_form->id == 9 && short_form->visible && !short_form->valid);
    g->to[2] = hot_m; /* on the ground */
    ask(&answer, &to);
    CHECK(short_form->visible);
    g->to[2] = hot_m - 1;
    ask(&answer, &to);
    CHECK(!short_form->visible && short_form->valid);
    const double r_m = a_m + hot_m - 1, drop_m = 500 + a_m - r_m * cos(l_rad);
    CHECK_NEAR(short_form->range_m, hypot(drop_m, r_m * sin(l_rad)) * 500 / drop_m, 1e-4);
    g->to_entity = g->other_entity = true; /* an entity that was never reported */
    g->destination_entity = 77;
    ask(&answer, &to);
    CHECK(!short_form->visible && !short_form->valid);
    end();
    landscape_destroy(&landscape);
}

/* A request with a period of 3 is answered at once, and again after 3, 6 ... frames, until another of its number comes.
 */
static void requests_with_a_period_stand(void **state)
{
    (void)state;
    FrameTime  frame;
    CigiPacket answer;
    CigiPacket request = {.id = cigi_hat_hot_request, .of.hat_hot_request = {.id = 5, .period = 3, .p = {0, 0, 500}}};
    const CigiPacket         sight = {.id = cigi_los_vector_request, .of.los_vector_request = {.id = 5}};
    CigiHatHotRequest *const r = &request.of.hat_hot_request;
    begin(0, INFINITY);
    say(1, &eye);
    CHECK(wait_for(&frame, false) == CLOCK_DUE && heartbeat(NULL) == 1);
    c.clock.done(&c.clock, &frame);
    ask(&answer, &request);
    CHECK(answer.id == cigi_hat_hot_response && answer.of.hat_hot_response.id == 5);
    for (int i = 1; i <= 7; i++) {
        ask(&answer, &eye);
        CHECK(answer.id == (i % 3 == 0 ? cigi_hat_hot_response : 0));
    }
    ask(&answer, &sight); /* of the same number, and another kind: both stay apart */
    CHECK(answer.id == cigi_los_response);
    ask(&answer, &eye); /* the ninth */
    CHECK(answer.id == cigi_hat_hot_response);
    r->period = 0;
    ask(&answer, &request);
    CHECK(answer.id == cigi_hat_hot_response);
    for (int i = 0; i < 6; i++) {
        ask(&answer, &eye);
        CHECK(answer.id == 0);
    }
    r->period = 1;
    for (int i = 0; i < cigi_requests_most + 3; i++) {
        r->id = (uint16_t)(100 + i);
        ask(&answer, &request);
    }
    CHECK(c.node->requests_lost == 3 && c.node->standing_count == cigi_requests_most);
    frame_number = 0;
    say_as(cigi_mode_standby, 0, &request); /* a host that begins anew asks anew */
    CHECK(wait_for(&frame, true) == CLOCK_EARLY && c.node->standing_count == 1);
    CHECK(c.clock.wait(&frame, &c.clock) == CLOCK_EARLY && c.node->standing_count == 1);
    end();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_are_those_of_the_host),
        cmocka_unit_test(a_host_that_begins_anew_before_the_last_frame_ends_it),
        cmocka_unit_test(what_is_wrong_with_time_is_said_once),
        cmocka_unit_test(heights_are_those_of_the_ground),
        cmocka_unit_test(lines_of_sight_end_at_the_ground),
        cmocka_unit_test(requests_with_a_period_stand),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
