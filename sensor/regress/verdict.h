/* sensor/regress/verdict.h: a run compared with its baseline, channel by channel, in the order of the data path: the
 * first that fails is the probable cause of those after it. */
#ifndef SENSOR_REGRESS_VERDICT_H
#define SENSOR_REGRESS_VERDICT_H

#include "sensor/publish/json_values.h"
#include "sensor/regress/case.h"
#include "sensor/regress/compare.h"
#include "sensor/regress/frame.h"

/* In the order of the data path. */
typedef enum Channel {
    CHANNEL_SIZE,     /* of the images and the range profile: frames of different size are not compared further */
    CHANNEL_COUNTERS, /* of PDUs, drops, entities, events: run.json */
    CHANNEL_TIME,     /* which frames there are, and when */
    CHANNEL_POSE,     /* host and sensor: truth.jsonl */
    CHANNEL_SUN,      /* as seen from the host: truth.jsonl */
    CHANNEL_MOTION,   /* which entities there are, and their dead-reckoned positions: targets of truth.jsonl */
    CHANNEL_ENTITY, CHANNEL_PART, CHANNEL_RANGE, CHANNEL_NORMAL,
    CHANNEL_TARGETS,  /* visible fraction and box of each, and what occludes it: truth.jsonl */
    CHANNEL_MATERIAL,
    CHANNEL_TEMP, CHANNEL_OPTICAL, CHANNEL_MWIR, CHANNEL_LWIR, CHANNEL_RADAR, CHANNEL_PROFILE,
    CHANNEL_SIGNALS,  /* contrast, SNR, intensity of each target: truth.jsonl */
    CHANNEL_ERROR,    /* the run's estimate of its own error: truth.jsonl */
    CHANNEL_COUNT
} Channel;

typedef struct ChannelResult {
    bool         there, failed;
    char         line[512];     /* message; empty: none */
    /* of planes: the worst plane of the worst frame */
    bool         picture;
    int          frame;
    FramePlane   plane;
    int          bounce;        /* of a profile, which has no plane: FRAME_PLANES */
    PlaneVerdict verdict;
    double       limit, relative; /* absolute, and of the expected */
    double       allowed;      /* share of pixels that may be beyond */
    const char  *unit;
    int          diffs;         /* of fields of truth.jsonl or run.json: how many differ */
} ChannelResult;

typedef struct Verdict {
    ChannelResult channel[CHANNEL_COUNT];
    int           first;        /* first channel that failed; -1: none */
    bool          same_build;   /* version, libraries and ISA are those of the baseline */
    bool          other_log;    /* the log is not that of the baseline: its generator may be the cause */
    char remarks[16384]; /* lines: inputs that differ from the baseline's: tables, settings, log, build, choices */
} Verdict;

const char *channel_name(Channel channel);
const char *channel_about(Channel channel); /* a short description */
/* A value of a plane as text with its unit, or "below 100 K", "no surface", "not a number", "out of range". digits:
 * 1 .. 9. */
void        channel_value(char out[64], Channel channel, double value, int digits);

/* A plane of baseline and run in the channel's unit, for the report. Freed by the caller with free. */
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

/* Planes of one frame; keeps the worse of the present result and the one found. edges_allowed: ids of edge pixels may
 * differ (different libraries or ISA). */
void verdict_frame(ChannelResult result[CHANNEL_COUNT], const RecordFrame *expected, const RecordFrame *got,
                   const Tolerance *tolerance, bool edges_allowed);
/* A line of truth.jsonl. */
void verdict_truth(ChannelResult result[CHANNEL_COUNT], int frame, const JsonValues *expected, const JsonValues *got,
                   double factor);
/* run.json: counters. */
void verdict_counters(ChannelResult result[CHANNEL_COUNT], const JsonValues *expected, const JsonValues *got);

#endif
