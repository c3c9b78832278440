/* dis/clock/exercise_clock_private.h: what the clock remembers of each sender: where its PDUs are in exercise time
 * (exercise_clock.c), whether its stamps are those of a clock (exercise_clock_check.c), and its delays
 * (delay_line.c). */
#ifndef DIS_CLOCK_EXERCISE_CLOCK_PRIVATE_H
#define DIS_CLOCK_EXERCISE_CLOCK_PRIVATE_H

#include "dis/clock/exercise_clock.h"

/* ---- delays: delay_line.c ------------------------------------------------------------------------ */

/* The least delay of a sender's datagrams over its own time: lower convex hull of (stamp, arrival - stamp), after Moon,
 * Skelly and Towsley, Estimation and removal of clock skew from network delay measurements, INFOCOM 1999.
 *
 * Queues only ever delay, so the clocks' difference is the lower edge of the points; what lies above it is jitter.
 * After N datagrams with uniform jitter J the edge is J / N too high in the mean, and more than 3 J / N once in 20
 * times: so is the least of N such delays, and nothing else is known (tests/sensor/test_time_stamps.c). Its slope, the
 * clocks' drift, is taken only where it exceeds what jitter makes of one. A change below 0.1 ms is not applied: so
 * exact recordings keep the offset of their first PDU to the bit. Depends on the order of the calls only. */
enum { delay_line_vertices = 16 };

typedef struct DelayLine {
    int      count; /* number of the hull's vertices, which are in the order of x */
    double   x_s[delay_line_vertices + 1], y_s[delay_line_vertices + 1];
    uint64_t points;
    double   mean_x_s, mean_y_s;
    double   offset_s, slope, at_s; /* the correction that is applied: offset_s + slope (x - at_s) */
} DelayLine;

/* x_s: the sender's own time; y_s: arrival time less x_s. */
void                 delay_line_begin(DelayLine *line, double x_s, double y_s);
void                 delay_line_add(DelayLine *line, double x_s, double y_s);
static inline double delay_line_at(const DelayLine *line, double x_s)
{
    return line->offset_s + line->slope * (x_s - line->at_s);
}
/* Slope of the hull's edge below the middle of the points, and the time from its first vertex to its last. */
double delay_line_edge(double *span_s, double *middle_s, const DelayLine *line);

/* ---- trend: delay_line.c ------------------------------------------------------------------------------------ */

/* The straight line through the points by least squares: finds a clock at another rate from its first few PDUs. */
typedef struct DelayTrend {
    uint64_t points;
    double   first_x_s, last_x_s;
    double   latest_x_s, latest_y_s; /* the point that was added last */
    double   mean_x_s, mean_y_s, xx, xy, yy;
} DelayTrend;

/* PDUs of one datagram with one stamp are one point. */
void delay_trend_add(DelayTrend *trend, double x_s, double y_s);
/* Slope and its standard error; false: fewer than three points, or all of one stamp. */
bool   delay_trend_slope(double *slope, double *error, const DelayTrend *trend);
double delay_trend_scatter(const DelayTrend *trend); /* standard deviation about the line, s */
/* The ratio of slope to standard error that chance exceeds once in ten thousand times, given that number of points. */
double delay_trend_critical(uint64_t points);

/* ---- senders ----------------------------------------------------------------------------------- */

enum {
    slot_count = 8192,    /* a power of two, at most half full */
    memory_slots = 16384, /* entities remembered for the check; a later one replaces an earlier one */
};

static const double leave_s =
    5.0; /* stamps farther ahead or behind than this are not valid (IEEE 1278.1, timestamp ahead/behind) */
/* Stamps at another rate are rejected once they have gained gain_s. drift: largest drift of a clock, s a second. */
static const double gain_s = 0.15, drift = 1e-4;
static const double vote_s = 2.0; /* the first span over which the rate of stamps is checked */

typedef struct Moment {
    uint32_t stamp;
    double   capture_s;
} Moment;

/* How stamps are tied to exercise time. */
typedef struct Tie {
    uint32_t stamp;
    double   t_s;
} Tie;

typedef enum Standing { SENDER_NEW, SENDER_PROVEN, SENDER_INCONSISTENT } Standing;

/* Whose scale a sender's stamps are on: its own, that of the sender that set the epoch, that of all absolute stamps. */
typedef enum Scale { SCALE_OWN, SCALE_EPOCH, SCALE_ABSOLUTE } Scale;

typedef struct Sender {
    uint32_t key;          /* site, application */
    bool     used, founds; /* founds: the sender's delays are those of its scale */
    uint8_t  standing, scale;
    uint8_t  failures; /* number of rejections, most_failures at most */
    uint8_t  odd;      /* consecutive reports that deviate from the reference */
    uint8_t  agree;    /* consecutive passed checks, votes_needed at most */
    uint8_t  switches; /* consecutive changes from one of two clocks to the other */
    bool     shared;   /* it has been reported as two senders */
    bool     on_other;
    bool     renewed;               /* the trend does not hold all PDUs since the tie */
    int      doubt;                 /* index into the clock's anomalies; -1: never rejected, or list full */
    uint32_t segment, next_segment; /* numbers of its segment and of the next one, of PDUs that may begin it; 0: none */
    uint32_t latest_stamp;
    Tie      tie;
    DelayLine  line;                /* delays since the tie */
    DelayTrend trend;               /* trend of the delays since the mark */
    double     mark_s, next_vote_s; /* capture times: when the check's span begins; when the next check is due */
    Moment     first, one, other;   /* one, other: the latest PDU by each of two clocks */
    uint64_t   pdus;
} Sender;

/* The last report kept of an entity; it arrived still_least_s or more after the one kept before it. */
typedef struct Memory {
    uint64_t key_plus_1; /* 0: none */
    Moment   last;
    int      repeats; /* how many reports in a row had the same stamp as the one before */
} Memory;

/* A time over which a sender's stamps were valid. */
typedef struct Segment {
    uint32_t  number;
    uint8_t   scale;
    Tie       tie;
    DelayLine line;
} Segment;

struct ExerciseClock {
    bool                   started, first_is_absolute, scales[3]; /* scales: whether each scale has a founder */
    double                 start_s;                               /* exercise time of the first PDU */
    double                 start_capture_s;                       /* when that PDU was captured */
    double                 last_capture_s;
    int                    senders;
    uint32_t               segments; /* begun */
    ExerciseClockAnomalies doubts;
    DelayLine              founder[3]; /* delays of each scale's founder; that of SCALE_OWN is not used */
    Tie                    absolute;   /* how stamps of SCALE_ABSOLUTE are tied */
    Segment               *valid;      /* valid segments, in the order of their numbers once the recording is whole */
    int                    valid_count, valid_capacity;
    bool                   lost_segment; /* a segment was lost because memory ran out */
    Sender                 slot[slot_count];
    Memory                 memory[memory_slots];
};

/* ---- exercise_clock.c: placing --------------------------------------------------------------------- */

/* The nearest number of whole hours, s. */
double exercise_clock_whole_hours(double of_s);
/* The time of a stamp by a tie. The stamp is taken the shorter way round the hour, then whole hours are added to come
 * nearest to the reference. */
double exercise_clock_tied_time(const Tie *tie, uint32_t stamp, double ruler_s);
/* A sender's own time as exercise time. */
double exercise_clock_shifted_time(const ExerciseClock *clock, Scale scale, const DelayLine *own, double t_s);
/* Ties the sender to exercise time anew; this PDU begins a segment. may_found: the sender's delays may become those of
 * its scale. */
void exercise_clock_tie(ExerciseClock *clock, Sender *sender, Moment now, double ruler_s, bool may_found);
/* Keeps the sender's segment as one over which its stamps were valid. */
void exercise_clock_keep(ExerciseClock *clock, const Sender *sender);

/* ---- exercise_clock_check.c ----------------------------------------------------------------------- */

/* Remembers a report, and returns how many reports of its entity in a row had the stamp of the one before. One such
 * report may be a datagram received twice (of a bundle, as many entities); two show a clock that stands still. */
int exercise_clock_stands_still(ExerciseClock *clock, uint64_t entity_key, Moment now);
/* Checks a stamped PDU of a known sender, and returns its time. entity: the sender's entity that it reports; -1: none.
 * */
ExerciseInstant exercise_clock_judge(ExerciseClock *clock, Sender *sender, Moment now, int entity, double ruler_s);

#endif
