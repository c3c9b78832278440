/* entities/survey/survey.h: one pass over a whole log before the first frame: munitions, targets, ground fixes. The
 * defaults of replay (host, aim, ground, time of day) are chosen from it. */
#ifndef ENTITIES_SURVEY_SURVEY_H
#define ENTITIES_SURVEY_SURVEY_H

#include "dis/capture/log.h"
#include "dis/clock/exercise_clock.h"
#include "dis/pdu/decode.h"

/* One round or missile from its Fire to its Detonation. */
typedef struct Shot {
    DisEntityId firing, target, munition; /* as in Fire; a target of 0:0:0 means unknown */
    double      fire_s;                   /* NaN: no Fire received */
    double      detonation_s;             /* NaN: no Detonation received */
    double      p_burst_ecef[3];
    DisEntityId hit; /* target named by the Detonation; 0:0:0: none */
    uint8_t     result;
    float       charge_kg; /* of the Detonation's descriptor: effect_charge_kg */
} Shot;

/* One report of where an entity was: 72 octets, and a long log has millions. */
typedef struct TrackPoint {
    double  t_s;
    double  p_ecef[3], v_ecef_mps[3]; /* velocity in world axes, whatever the algorithm */
    float   euler_rad[3];             /* psi, theta, phi as reported: survey_point_rotation */
    bool    frozen, deactivated;
    bool    engine : 1; /* its power-plant bit */
    bool    paused : 1; /* a Stop/Freeze names it before its next report, or still holds it */
    uint8_t damage;     /* its damage bits: 0 none .. 3 destroyed */
} TrackPoint;

typedef struct Track {
    DisEntityId   id;
    DisEntityType type;
    char          marking[12];
    uint8_t       force;
    int           count;
    TrackPoint   *point; /* in order of time; of a munition with a later Detonation the last point is the burst */
} Track;

enum { survey_times_most = 65536 };

typedef struct Survey {
    int    track_count, shot_count;
    Track *track;              /* sorted by id */
    Shot  *shot;               /* in order of fire (else detonation) time */
    int   *shot_by_munition;   /* [shot_count] of shot, sorted by munition, then by time; NULL: not made */
    double first_s, last_s;    /* exercise time of the first and last PDU; NaN: none */
    double clock_start_unix_s; /* Unix time of exercise time 0 from Start/Resume; NaN: none received */
    double absolute_unix_s; /* Unix time of exercise time 0 from absolute stamps with a credible capture date (1990 ..
                               2100, but not the round 1e9 s of 2001-09-09), if at least two and more than half of them
                               agree within 10 s; NaN: they do not */
    int absolute_stamps, absolute_left_out; /* number of absolute stamps, and how many of them disagree */
    ExerciseClockAnomalies doubts;          /* senders with rejected time stamps */
    DisCounters            counters;        /* all received and dropped PDUs, whole log */
    double                *datagram_s; /* exercise time of the first PDU of each datagram [log->count, of a long log
                                        * the first survey_times_most]; NaN: none */
    uint64_t refused;                  /* track points dropped because of the memory bound */
    uint64_t late;                     /* reports left out because they are older than the ones before them */
} Survey;

/* Reads every PDU of the log once. exercise: only this exercise id; -1: all. */
Status       survey_log(Survey *out, const DisLog *log, int exercise);
void         survey_destroy(Survey *survey);
const Track *survey_track(const Survey *survey, DisEntityId id); /* NULL: no report of it was received */
/* The first shot of that munition; NULL: none received. O(log shots). */
const Shot *survey_shot(const Survey *survey, DisEntityId munition);

/* Where a track was at t_s, between its reports (cubic in position, shortest turn in attitude); held at the
 * ends. For a replay's own host only: a live node does not have the next report. */
typedef struct TrackPose {
    double p_ecef[3], v_ecef_mps[3], r_ecef_from_body[9];
} TrackPose;
void survey_track_at(TrackPose *out, const Track *track, double t_s);
/* Whether a track knows more of t_s than its reports up to then: t_s is not after the last one, and no Stop/Freeze
 * comes between the reports on both sides of it, whose time tells when it stood. */
bool survey_track_knows(const Track *track, double t_s);
void survey_point_rotation(double r_ecef_from_body[9], const TrackPoint *point);
/* Between two rotations, u 0 .. 1: the shortest turn at an even rate. */
void survey_turn(double out[9], const double r0[9], const double r1[9], double u);

/* ---- shots: which Detonation ended which Fire; for the survey alone ------------------------- */

/* One Fire or Detonation as received. */
typedef struct WarfareEvent {
    double      t_s;
    DisEntityId firing, target, munition;
    DisEventId  event;
    double      p_ecef[3]; /* Detonation */
    uint8_t     result;
    float       charge_kg;
    bool        is_detonation;
} WarfareEvent;

/* A Detonation belongs to the latest Fire before it of the same munition id that has none yet (ids are used again; the
 * event id decides where it can), else to that of the same event id. One received twice within half a second is one.
 * event is put in order of time. *shots is malloc'ed, in order of fire (else detonation) time. */
Status survey_join_shots(Shot **shots, int *shot_count, WarfareEvent *event, int count);
/* Computes the numbers of the shots sorted by munition, then by number; malloc'ed. */
Status survey_order_shots(int **by_munition, const Shot *shot, int count);

#endif
