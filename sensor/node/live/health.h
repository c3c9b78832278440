/* sensor/node/live/health.h: why a live node receives, renders or sends nothing: reported once when the reason changes,
 * with the remedy.
 *
 * Receiving, rendering, sending, losses and dropped frames are five topics, each with a reason of its own that is a
 * function of the counters alone. A reason must persist before it is reported: heartbeats may be 5 s apart. */
#ifndef SENSOR_NODE_LIVE_HEALTH_H
#define SENSOR_NODE_LIVE_HEALTH_H

#include "dis/capture/log.h"
#include "sensor/frame/records.h"

typedef enum HealthTopic {
    HEALTH_RECEIVE,
    HEALTH_RENDER,
    HEALTH_SEND,
    HEALTH_LOSS,
    HEALTH_PACE,
    HEALTH_TOPICS
} HealthTopic;

typedef enum HealthReason {
    HEALTH_FINE,
    HEALTH_AWAY,           /* the network is not available, which dis/network/udp.h reports */
    HEALTH_OTHER_EXERCISE, /* PDUs of other exercises, none of the configured one */
    HEALTH_NO_ENTITY,      /* PDUs of the configured exercise, no usable Entity State */
    HEALTH_OWN,            /* datagrams from this node's own site and application alone */
    HEALTH_JUNK,           /* datagrams without one well-formed PDU */
    HEALTH_NOTHING,
    HEALTH_NO_HOST, /* the host was given by its id, and has not been received */
    HEALTH_HOST_GONE,
    HEALTH_NO_MUNITION, /* none in flight so far */
    HEALTH_MUNITION_GONE,
    HEALTH_NO_TRAFFIC, /* frames are rendered, but there are no entities */
    HEALTH_NO_VIEW,    /* entities, none in the field of view */
    HEALTH_HIDDEN,     /* targets in the view, none of them visible */
    HEALTH_NOT_SENT,   /* the system accepts no datagram */
    HEALTH_LOST,       /* datagrams arrived faster than they were read */
    HEALTH_LATE,       /* frames dropped */
    HEALTH_EARLY,      /* no fault: the run ended before the first frame */
} HealthReason;

typedef enum HealthHost { HEALTH_OBSERVER, HEALTH_BY_ID, HEALTH_MUNITION } HealthHost;

/* Times are of a wall clock, s. */
typedef struct HealthSample {
    double now_s;
    /* received since the last usable Entity State, or since the beginning */
    double   usable_s, any_s;         /* times of the latest usable one, and of the latest datagram of any kind */
    uint64_t usable;                  /* total */
    uint64_t junk, own;               /* datagrams */
    uint64_t pdus;                    /* of the configured exercise */
    uint64_t other[256];              /* PDUs of other exercises, by exercise */
    uint64_t dropped[DIS_DROP_COUNT]; /* of all datagrams, by reason */
    uint8_t  type;                    /* of the latest PDU in pdus */
    bool     away;
    /* rendered */
    bool       rendering; /* the choices are made, frames follow */
    HealthHost host;
    uint64_t   frames, missing;      /* rendered; due since the last one while the host was absent */
    double     frame_s;              /* of the last frame, or when rendering began */
    int        entities;             /* in the table */
    int        preparing;            /* things that are being made before frames need them */
    uint64_t   over_rate;            /* reports of new ones above the rate limit */
    int        others;               /* of the last frame: except the host */
    double     nearest_m;            /* range to the nearest of them; NaN: not computed */
    double     in_view_s, visible_s; /* last frame with an entity in view, with a visible part; or when rendering
                                      * began */
    /* sent */
    bool     publishes;
    uint64_t sent, failed, unsent; /* unsent: failures since the last successful one */
    double   failing_s;            /* when the first of these failures occurred */
    int      error;                /* errno of the latest */
    /* lost, dropped */
    uint64_t lost_kernel, lost_queue, late;
    double   lost_s, late_s; /* when their number last grew; -INFINITY: never */
} HealthSample;

HealthReason health_evaluate(HealthTopic topic, const HealthSample *sample);
/* The first fault of a run without any frame, however short it lasted. */
HealthReason health_final(const HealthSample *sample);

/* What the messages name. */
typedef struct HealthNames {
    const char *where;    /* `239.1.2.3 port 3000 on eth0` */
    const char *to;       /* destination */
    int         exercise; /* exercise to receive; -1: any */
    int         site, application;
    const char *host; /* as requested, or the present one */
} HealthNames;

/* Writes the fault and its remedy in one line, empty for HEALTH_FINE. */
enum { health_text_size = 640 };
void health_text(char out[health_text_size], HealthReason reason, const HealthSample *sample, const HealthNames *names);
const char *health_name(HealthReason reason); /* a few words */

/* ---- a node's own ----------------------------------------------------------------------------------- */

typedef struct Health {
    HealthSample sample;
    HealthReason now[HEALTH_TOPICS], said[HEALTH_TOPICS]; /* said: the last one reported, other than HEALTH_FINE */
    double       said_s[HEALTH_TOPICS];
    bool         open[HEALTH_TOPICS]; /* its end has not been reported */
} Health;

void health_begin(Health *health, double now_s);
void health_own(Health *health, double now_s); /* a datagram of this node's own site and application */
/* Takes note of a datagram of another sender. exercise: the configured one; -1: any. checked: only a report with a
 * usable position counts. */
void health_received(Health *health, const DisDatagram *datagram, int exercise, bool checked, double now_s);
void health_rendering(Health *health, double now_s); /* the choices are made, the first frame is due */
/* A frame that was rendered. */
void health_frame(Health *health, const FrameRecord *frame, double now_s);
/* Evaluates the counters and reports changes; no message twice within a minute. */
void health_check(Health *health, const LiveCounters *counters, const HealthNames *names, double now_s);
/* `12 entities  kept 4.9 of 5 frames/s  checkerboard  0 late  34 ms  0 lost  nothing heard`, with what the last frame
 * gave up; `preparing 12` while that many things are still to be made, `left out: video_file 12`
 * when consumers do not keep up. */
typedef struct HealthPace {
    double      kept_hz, rate_hz; /* frames with all bands; those asked for, 0: not known yet */
    const char *step;             /* NULL: it gave up nothing */
    double      latency_s;        /* NAN: none */
    const char *left_out;         /* frames that consumers were not given, `video_file 12`; empty: none */
} HealthPace;
enum { health_line_size = 384 };
void health_line(char out[health_line_size], const Health *health, const HealthPace *pace);

/* Says which consumers do not keep up: at once, then once a minute while they lose more. last: what is not said yet. */
typedef struct HealthLosses {
    uint64_t said;
    double   said_s; /* 0: never */
} HealthLosses;
void health_losses(HealthLosses *losses, uint64_t lost, const char *left_out, double now_s, bool last);

/* The last lines of `pitviper run`. own: datagrams heard that the node itself had sent. */
void health_summary(const LiveCounters *counters, const HealthSample *sample, uint64_t own);

#endif
