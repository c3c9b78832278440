/* sensor/regress/verdict.h: a run held against its record, channel by channel, in the order in which the data is made:
 * what fails first is the probable cause of what fails after it. */
#ifndef SENSOR_REGRESS_VERDICT_H
#define SENSOR_REGRESS_VERDICT_H

#include "sensor/publish/json_values.h"
#include "sensor/regress/case.h"
#include "sensor/regress/compare.h"
#include "sensor/regress/frame.h"

/* In the way of the data. */
typedef enum Channel {
    CHANNEL_SIZE,     /* of the pictures and of the range profile: other sizes are not compared any further */
    CHANNEL_COUNTERS, /* of PDUs, drops, entities, events: run.json */
    CHANNEL_TIME,     /* which frames there are, and when */
    CHANNEL_POSE,     /* host and sensor: truth.jsonl */
    CHANNEL_SUN,      /* as seen from the host: truth.jsonl */
    CHANNEL_MOTION,   /* who is there, and where by dead reckoning: targets of truth.jsonl */
    CHANNEL_ENTITY, CHANNEL_PART, CHANNEL_RANGE, CHANNEL_NORMAL,
    CHANNEL_TARGETS,  /* how much of each is seen, and what hides it: truth.jsonl */
    CHANNEL_MATERIAL,
    CHANNEL_TEMP, CHANNEL_OPTICAL, CHANNEL_MWIR, CHANNEL_LWIR, CHANNEL_RADAR, CHANNEL_PROFILE,
    CHANNEL_SIGNALS,  /* contrast, SNR, intensity of each target: truth.jsonl */
    CHANNEL_ERROR,    /* what the node says its own error is: truth.jsonl */
    CHANNEL_COUNT
} Channel;

typedef struct ChannelResult {
    bool         there, failed;
    char         line[512];     /* what there is to say; empty: nothing */
    /* of pictures: the worst plane of the worst frame */
    bool         picture;
    int          frame;
    FramePlane   plane;
    int          bounce;        /* of a profile, which has no plane: FRAME_PLANES */
    PlaneVerdict verdict;
    double       limit, relative; /* absolute, and of the expected */
    double       allowed;      /* share of pixels that may be beyond */
    const char  *unit;
    int          diffs;         /* of texts: how many fields */
} ChannelResult;

typedef struct Verdict {
    ChannelResult channel[CHANNEL_COUNT];
    int           first;        /* that failed; -1: none */
    bool          same_build;   /* version, libraries, ISA as in the record */
    bool          other_log;    /* what was replayed is not what was recorded: its writer may be the cause */
    char          remarks[16384]; /* lines: what is other than when it was recorded: tables, settings, log, build, choices */
} Verdict;

const char *channel_name(Channel channel);
const char *channel_about(Channel channel); /* what it is, in a few words */
/* A value of a plane as a user reads it: with its unit; "below 100 K"; "no surface"; "no number". digits: 1 .. 9. */
void        channel_value(char out[64], Channel channel, double value, int digits);

/* A frame of both, as the report shows it: in the channel's unit. Freed by the caller with free. */
typedef struct ChannelPlanes {
    int    width, height;
    float *expected, *got, *difference;
} ChannelPlanes;
/* The plane that the result names. False when memory is out. */
bool channel_planes(ChannelPlanes *out, const ChannelResult *result, const RecordFrame *expected,
                    const RecordFrame *got, const Tolerance *tolerance);

/* Reads both folders. STATUS_BAD_VALUE or STATUS_IO, logged: a file of either cannot be read. */
Status verdict_of(Verdict *out, const Case *c, const char *record, const char *run);

/* ---- in parts, for tests ---------------------------------------------------------------------- */

/* Planes of one frame; keeps the worse of what is in the results and what is found. edges_allowed: as of other
 * libraries. */
void verdict_frame(ChannelResult result[CHANNEL_COUNT], const RecordFrame *expected, const RecordFrame *got,
                   const Tolerance *tolerance, bool edges_allowed);
/* A line of truth.jsonl. */
void verdict_truth(ChannelResult result[CHANNEL_COUNT], int frame, const JsonValues *expected, const JsonValues *got,
                   double factor);
/* run.json: counters. */
void verdict_counters(ChannelResult result[CHANNEL_COUNT], const JsonValues *expected, const JsonValues *got);

#endif
