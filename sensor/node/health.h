/* sensor/node/health.h: why a live node is silent, said once when the reason changes, with what helps.
 *
 * What is heard, shown, sent, lost and left out are five topics, each with a reason of its own that is a function of
 * the counters alone. A reason must last before it is said: heartbeats may be 5 s apart. */
#ifndef SENSOR_NODE_HEALTH_H
#define SENSOR_NODE_HEALTH_H

#include "dis/log.h"
#include "sensor/publish/records.h"

typedef enum HealthTopic { HEALTH_RECEIVE, HEALTH_RENDER, HEALTH_SEND, HEALTH_LOSS, HEALTH_PACE, HEALTH_TOPICS } HealthTopic;

typedef enum HealthReason {
    HEALTH_FINE,
    HEALTH_AWAY,           /* the network is not there, which dis/udp.h says */
    HEALTH_OTHER_EXERCISE, /* PDUs of other exercises, none of the one to hear */
    HEALTH_NO_ENTITY,      /* PDUs of the right one, no Entity State that can be used */
    HEALTH_OWN,            /* datagrams from this node's own site and application alone */
    HEALTH_JUNK,           /* datagrams without one well-formed PDU */
    HEALTH_NOTHING,
    HEALTH_NO_HOST,        /* the host was asked for by its id, and not heard so far */
    HEALTH_HOST_GONE,
    HEALTH_NO_MUNITION,    /* none flies so far */
    HEALTH_MUNITION_GONE,
    HEALTH_NO_TRAFFIC,          /* frames are made, and there is no entity to be seen */
    HEALTH_NO_VIEW,        /* entities, none in the field of view */
    HEALTH_HIDDEN,         /* some in it, no part of any can be seen */
    HEALTH_NOT_SENT,       /* the system takes no datagram */
    HEALTH_LOST,           /* datagrams came too fast */
    HEALTH_LATE,           /* frames left out */
    HEALTH_EARLY,          /* nothing is wrong, it ended before the first frame */
} HealthReason;

typedef enum HealthHost { HEALTH_OBSERVER, HEALTH_BY_ID, HEALTH_MUNITION } HealthHost;

/* Times are a wall clock's, s. */
typedef struct HealthSample {
    double     now_s;
    /* heard since the last Entity State that could be used, or since the beginning */
    double     usable_s, any_s; /* when that was; of the latest datagram, whatever it was */
    uint64_t   usable;          /* how many there were, ever */
    uint64_t   junk, own;       /* datagrams */
    uint64_t   pdus;            /* of the exercise to hear */
    uint64_t   other[256];      /* PDUs by exercise, of the others */
    uint8_t    type;            /* of the latest PDU in pdus */
    bool       away;
    /* shown */
    bool       making;          /* the choices are made, frames follow */
    HealthHost host;
    uint64_t   frames, missing; /* made; due since the last of them, and the host was not there */
    double     frame_s;         /* of the last frame, or when making began */
    int        entities;        /* in the table */
    uint64_t   over_rate;       /* reports of new ones that came too fast */
    int        others;          /* of the last frame: but for the host */
    double     nearest_m;       /* of them, from the eye; NaN: not computed */
    double     in_view_s, visible_s; /* last frame with an entity in view, with a visible part; or when making began */
    /* sent */
    bool       publishes;
    uint64_t   sent, failed, unsent; /* unsent: failed since the last that was sent */
    double     failing_s;       /* when the first of those did */
    int        error;           /* errno of the latest */
    /* lost, left out */
    uint64_t   lost_kernel, lost_queue, late;
    double     lost_s, late_s;  /* when there were more last; -INFINITY: never */
} HealthSample;

HealthReason health_evaluate(HealthTopic topic, const HealthSample *sample);
/* Of a run without one frame: the first thing that is wrong, however short it lasted. */
HealthReason health_final(const HealthSample *sample);

/* What the lines name. */
typedef struct HealthNames {
    const char *where;          /* `239.1.2.3 port 3000 on eth0` */
    const char *to;             /* where it sends */
    int         exercise;       /* to hear; -1: any */
    int         site, application;
    const char *host;           /* as asked for, or the present one */
} HealthNames;

/* What is wrong and what to do, one line; empty for HEALTH_FINE. */
enum { health_text_size = 640 };
void        health_text(char out[health_text_size], HealthReason reason, const HealthSample *sample,
                        const HealthNames *names);
const char *health_name(HealthReason reason); /* a few words */

/* ---- a node's own ----------------------------------------------------------------------------------- */

typedef struct Health {
    HealthSample sample;
    HealthReason now[HEALTH_TOPICS], said[HEALTH_TOPICS]; /* said: the last that is no HEALTH_FINE */
    double       said_s[HEALTH_TOPICS];
    bool         open[HEALTH_TOPICS]; /* that it is over was not said */
    DisCounters  ignored;             /* of parsing */
} Health;

void health_begin(Health *health, double now_s);
void health_own(Health *health, double now_s); /* a datagram of this node's own site and application */
/* A datagram of others. exercise: the one to hear; -1: any. checked: only a report with a usable place counts. */
void health_received(Health *health, const DisDatagram *datagram, int exercise, bool checked, double now_s);
void health_making(Health *health, double now_s); /* the choices are made, the first frame is due */
/* A frame that was made. */
void health_frame(Health *health, const FrameRecord *frame, double now_s);
/* Reads the counters, and says what changed; nothing twice within a minute. */
void health_check(Health *health, const LiveCounters *counters, const HealthNames *names, double now_s);
/* `12 entities  5.0 frames/s  0 late  34 ms  0 lost  nothing heard` */
enum { health_line_size = 160 };
void health_line(char out[health_line_size], const Health *health, double frames_hz, double latency_s);

#endif
