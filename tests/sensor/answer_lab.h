/* tests/sensor/answer_lab.h: a receiver of answers on a free port, and a camera whose lines of sight are on paper. */
#ifndef TESTS_SENSOR_ANSWER_LAB_H
#define TESTS_SENSOR_ANSWER_LAB_H

#include "tests/check.h"

#include "sensor/publish/answers/answers.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

enum { answer_width = 64, answer_height = 48, answer_focal_px = 100 };

static const AnswerScope answer_scope = {1 << BAND_LWIR, answer_width, answer_height};
/* At the equator and the zero meridian, 1000 m up: axes east, north and up are y, z and x of ECEF. It looks north. */
static const double north_ecef_from_cam[9] = {0, -1, 0, 1, 0, 0, 0, 0, 1};

static inline AnswerCamera camera_north(void)
{
    RenderRequest     request = {.view = {.width = answer_width, .height = answer_height, .focal_px = answer_focal_px}};
    const FrameRecord record = {.request = &request, .p_eye_ecef = {6378137.0 + 1000, 0, 0}};
    FrameRecord       of = record;
    AnswerCamera      camera;
    memcpy(of.r_ecef_from_cam, north_ecef_from_cam, sizeof of.r_ecef_from_cam);
    answer_camera(&camera, &of);
    return camera;
}

static inline void tell_frame(Answers *to, int number, double time_s, double unix_s, double rendered_s,
                              double instant_s)
{
    const AnswerFrame frame = {number, time_s, unix_s, rendered_s, instant_s, camera_north()};
    answers_frame(to, &frame);
}

static inline uint64_t answers_in_all(Answers *to)
{
    AnswerCounters count;
    uint64_t       all = 0;
    answers_counters(to, &count);
    for (int i = 0; i < ANSWER_REASONS; i++) all += answer_datagrams(&count, (AnswerReason)i);
    return all;
}

/* Sends one, and waits until it has been counted. */
static inline void deliver(Answers *to, int socket_of, int port, const void *octets, size_t size)
{
    const struct sockaddr_in node = {
        .sin_family = AF_INET, .sin_port = htons((uint16_t)port), .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    const uint64_t before = answers_in_all(to);
    CHECK(sendto(socket_of, octets, size, 0, (const struct sockaddr *)&node, sizeof node) == (ssize_t)size);
    for (int i = 0; i < 1000000 && answers_in_all(to) == before; i++) usleep(100);
    CHECK(answers_in_all(to) == before + 1);
}

/* On a free port. */
static inline Answers *open_answers(int *port, const char *folder)
{
    Answers *to = NULL;
    *port = 20000 + (int)getpid() % 20000;
    for (int i = 0; i < 50 && !to; i++) answers_open(&to, &(AnswersOf){++*port, answer_scope});
    CHECK(to && (!folder || answers_record(to, folder) == STATUS_OK));
    return to;
}

#endif
