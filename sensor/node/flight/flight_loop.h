/* sensor/node/flight/flight_loop.h: a missile that flies by what is seen in the frames of its own seeker, in lockstep.
 *
 * The missile is the session's host: sensor/node/session/host_flight.c steps it on the session's grid of 10 ms, ten
 * steps of 1 ms each, and gives each frame the eye at its time. What was seen in a frame becomes a line of sight
 * through the camera of that frame (loop_sights.c) and guides from late_s after the frame's time on. The clock
 * (sensor/node/clock/flight_clock.h) makes no frame before every sight is known that guides before it, so the flight
 * follows from the answers alone, not from when they came: the wall clock decides only whether an answer counts as
 * missing. Times are exercise time, s; ticks count its milliseconds. */
#ifndef SENSOR_NODE_FLIGHT_FLIGHT_LOOP_H
#define SENSOR_NODE_FLIGHT_FLIGHT_LOOP_H

#include "dis/pdu/decode.h"
#include "entities/flight/engagement.h"
#include "entities/flight/flight.h"
#include "entities/flight/miss.h"
#include "entities/flight/sight_filter.h"
#include "sensor/publish/answers/answers.h"

#include <pthread.h>

enum { loop_waiting_most = 256, loop_tick_ms = 10 };

typedef enum LoopSource {
    LOOP_TRUE,     /* the line of sight to the centre of the target as the frame shows it, its rate and range */
    LOOP_ANSWERS,  /* of a recogniser, by UDP */
    LOOP_RECORDED, /* as a flight before had them: loop_sights_read */
    LOOP_RADAR,    /* the direction, range and range rate of a detection of the node's radar */
    LOOP_GIVEN,    /* whole lines of sight, of an operator, or noted in a recording: loop_push, loop_sights_direct */
} LoopSource;

/* What was seen in a frame. */
typedef enum LoopVerdict {
    LOOP_SEEN,    /* at px */
    LOOP_EMPTY,   /* the answer has no detection */
    LOOP_OUTSIDE, /* none near the line of sight that was expected */
    LOOP_NONE,    /* no answer in time */
    loop_verdict_count,
} LoopVerdict;
extern const char *const loop_verdict_name[loop_verdict_count];

/* The camera of a frame. */
typedef struct LoopCamera {
    double t_s, p_ecef[3], v_ecef_mps[3], r_ecef_from_cam[9];
    View   view;
    /* of the target: its centre and velocity, for LOOP_TRUE */
    bool   target_known;
    double target_ecef[3], target_v_ecef_mps[3];
} LoopCamera;

typedef struct LoopFrame { /* of which it is not known yet what was seen */
    int        number;
    double     asked_s; /* wall clock */
    LoopCamera camera;
} LoopFrame;

typedef struct LoopRow { /* a row of sights.csv */
    int         frame;
    LoopVerdict sight;
    double      px[2]; /* NaN unless seen */
} LoopRow;

typedef struct LoopAnswer {
    bool   there; /* the first answer to its frame */
    int    count;
    double px[answer_detections_most][2], score[answer_detections_most];
} LoopAnswer;

typedef struct LoopUsable { /* a line of sight, and from when on it guides */
    double      from_s;
    FlightSight sight;
} LoopUsable;

/* What a radar detected, where it is: sensor/radar/detect_private.h has the rest. */
typedef struct LoopEcho {
    double d_cam[3]; /* unit */
    double range_m, closing_mps, snr;
} LoopEcho;

typedef struct FlightLoop FlightLoop;
typedef struct LoopScene  LoopScene;

/* What a node does about its missile; each may be NULL. */
typedef struct FlightHooks {
    void *user;
    /* Before a frame at t_s, and before anything is flown to it. */
    void (*boundary)(void *user, double t_s);
    /* Before it is flown to a tick of 10 ms. */
    void (*before)(void *user, double tick_s);
    /* Not launched yet: it is, at launch_tick, which has come at this tick: from where, and how fast. False: not now.
     */
    bool (*launch)(void *user, const LoopScene *scene, double tick_s, const double target_ecef[3]);
    /* It has flown to a tick. */
    void (*flown)(void *user, const LoopScene *scene, double tick_s);
    /* Before the eye of a frame at t_s is asked for. */
    void (*look)(void *user, double t_s);
    /* A line of sight was taken. */
    void (*sight)(void *user, const LoopUsable *usable);
} FlightHooks;

struct FlightLoop {
    /* ---- given */
    LoopSource         source;
    const FlightHooks *hooks; /* NULL: none */
    DisEntityId        id, target;
    Missile            missile; /* its fuze_m is the distance at which it counts as a hit */
    FlightWorld        world;
    int64_t            launch_tick;
    double             p_ecef[3], v_ecef_mps[3]; /* launch */
    double             late_s, memory;           /* memory: of the sight filter */
    double             limit_s, start_s;         /* wall clock: longest wait for an answer, and for the first */
    /* Whether the recogniser has ended; then nothing is waited for. NULL: it is not asked. */
    bool (*gone)(void *user);
    void *user;
    /* ---- as it flies */
    bool         over;                                    /* by its hooks: the last of a salvo has ended */
    bool         launched, ended, out_of_memory, strange; /* strange: a recording that lacks a frame */
    FlightEnd    end;
    FlightState  state;
    double       end_s, end_ecef[3]; /* impact, or the last grid point */
    bool         hit;
    Miss         miss;
    double       most_lateral_mps2;
    int64_t      guided, coasted; /* steps */
    double       target_ecef[3];  /* at the last tick; valid if target_known */
    bool         target_known;
    FlightState *track; /* [track_count], each tick of 10 ms from the launch on */
    int          track_count, track_room;
    /* ---- sights */
    LoopCamera  eye; /* of the last frame */
    int         frames;
    double      least_from_s;              /* no sight that is taken now guides before */
    LoopUsable  usable[loop_waiting_most]; /* a ring: the newest is usable[(usable_count - 1) % most] */
    int64_t     usable_count;
    SightFilter filter;
    LoopRow    *row; /* [row_count], read for LOOP_RECORDED, else written */
    int         row_count, row_room;
    int         verdicts[loop_verdict_count];
    double      gone_s; /* wall clock; 0: it has not ended */
    /* ---- shared with the thread that receives answers, which writes the inbox and the two counts alone */
    pthread_mutex_t lock;
    pthread_cond_t  arrived;
    LoopFrame       waiting[loop_waiting_most]; /* a ring: from `first` on, [count], by ascending number */
    LoopAnswer      inbox[loop_waiting_most];   /* of the frame at the same place */
    int             first, count, settled;      /* settled: frames up to this one have their verdict; -1: none */
    uint64_t late, unasked; /* refused: answers to such frames; to those of which nothing was asked, of all missiles */
};

Status flight_loop_begin(FlightLoop *loop); /* after `given` is filled in, all else 0 */
void   flight_loop_free(FlightLoop *loop);
/* The next missile of a salvo, after the end of the one before, which leaves nothing: its `given` may be changed then.
 * Answers to frames of the one before are refused. */
void flight_loop_next(FlightLoop *loop);

/* Where an entity is, as the world of the session has it. */
typedef struct LoopBody {
    double p_ecef[3], v_ecef_mps[3], r_ecef_from_body[9];
} LoopBody;

/* Ground and entities as the world of the session has them. */
struct LoopScene {
    void *user;
    /* False: there is none below. */
    bool (*ground_at)(double on_ecef[3], double normal_ecef[3], void *user, const double p_ecef[3]);
    /* NULL: not asked. */
    bool (*body_at)(LoopBody *out, void *user, DisEntityId id, double t_s);
    /* Its own Fire or Detonation, for what is seen of it; NULL: not told. */
    void (*fired)(void *user, const DisFire *fire, double t_s);
    void (*burst)(void *user, const DisDetonation *burst, double t_s);
};

/* Flies on to a tick of the session, which is t_s. target_ecef: the target's centre then; NULL: it is not there. */
void flight_loop_tick(FlightLoop *loop, const LoopScene *scene, double t_s, const double target_ecef[3]);
/* Where it is at t_s, not before the last tick, without flying on. False: it is not in flight. */
bool flight_loop_at(FlightState *out, const FlightLoop *loop, double t_s);

/* ---- loop_sights.c ---- */

/* A frame has been made with loop->eye as its camera. */
void loop_sights_frame(FlightLoop *loop, int number);
/* An AnswersTaken; user: the loop. */
void loop_sights_taken(void *loop, const Answer *answer);
/* Warns of answers to frames of which nothing was asked, if there were any. After the last answer. */
void loop_sights_say_refused(const FlightLoop *loop);
/* Settles what was seen in every frame whose sight guides before t_s. False: an answer is still waited for; a
 * hundredth of a second has passed. */
bool loop_sights_settle(FlightLoop *loop, double t_s);
/* Live: settles what has been answered by now, which guides from t_s on; frames before the newest answer, and those
 * older than 1 s, have none. Does not wait. */
void loop_sights_arrived(FlightLoop *loop, double t_s);
/* LOOP_RADAR: what the radar detected in the frame that loop->eye has just seen. */
void loop_sights_echoes(FlightLoop *loop, const LoopEcho *echo, int count);
/* A line of sight that is known as a whole. */
void loop_push(FlightLoop *loop, const LoopUsable *usable);
/* A direction measured from the eye of the last frame, a unit vector, whose rate the filter makes. Range and closing
 * speed NaN: not known. */
bool loop_sights_direct(FlightLoop *loop, const double los_ecef[3], double range_m, double closing_mps);
/* The sight that guides at t_s; NULL: none. */
const FlightSight *loop_sights_at(const FlightLoop *loop, double t_s);
/* sights.csv: frame, sight, column_px, row_px. */
Status loop_sights_write(const FlightLoop *loop, const char *path);
Status loop_sights_read(FlightLoop *loop, const char *path);

#endif
