/* sensor/verify/regress/verdict.h: a run compared with its baseline, channel by channel, in the order of the data
 * path: the first that fails is the probable cause of those after it. */
#ifndef SENSOR_VERIFY_REGRESS_VERDICT_H
#define SENSOR_VERIFY_REGRESS_VERDICT_H

#include "sensor/frame/json_values.h"
#include "sensor/verify/regress/case.h"
#include "sensor/verify/regress/record_frame.h"

/* ---- two planes ---------------------------------------------------------------------------------- */

/* Comparison of two planes. Pure functions, no allocation.
 *
 * A pixel is beyond when not |got - expected| <= limit; equal infinities, and NaN against NaN, differ by 0; one that is
 * finite against one that is not by infinity. */

typedef struct PlaneVerdict {
    size_t compared, beyond;
    double share;         /* beyond / compared; 0 of none */
    double max;           /* of the difference; infinity when anything finite met what is not */
    double rms;           /* of the differences that are finite */
    size_t unmatched;     /* those where only one is finite, or infinities or NaN differ */
    int    column, row;   /* first pixel with this max; -1: nothing differs */
    double expected, got; /* there */
} PlaneVerdict;

/* The limit of a pixel is absolute + relative |expected|. ignored: pixels left out where not 0, whose difference is 0;
 * may be NULL. */
typedef struct PlaneLimits {
    double         absolute, relative;
    const uint8_t *ignored;
} PlaneLimits;

/* difference: got - expected [height][width], may be NULL. */
void verdict_compare_numbers(PlaneVerdict *out, float *difference, const float *expected, const float *got, int width,
                             int height, const PlaneLimits *limits);
/* Every difference counts as beyond, with max 1. allowed: pixels that may differ and are only counted in *edges (which
 * may be NULL); NULL: none. */
void verdict_compare_ids(PlaneVerdict *out, size_t *edges, const uint32_t *expected, const uint32_t *got, int width,
                         int height, const uint8_t *allowed);
/* 1 where one of the four neighbours has another id, in either plane; adds to what is there. Returns how many are 1. */
size_t verdict_mark_edges(uint8_t *edge, const uint32_t *expected, const uint32_t *got, int width, int height);

/* Lower bound of apparent temperatures, also for zero radiance: the radiance of a body of 100 K in 8-12 um is
 * 1e-4 of one of 300 K (in 3-5 um 1.3e-9), below any detector's noise, and no radiance has no temperature. */
static const double apparent_floor_k = 100;
/* Radiance to apparent temperature, K, apparent_floor_k at least; NaN of what is no radiance (NaN, infinite, below 0).
 * low_m .. high_m: the band. */
void verdict_plane_to_kelvin(float *out, const float *radiance_w_m2_sr, size_t count, double low_m, double high_m);
/* Power to dB relative to `full`, at least -span_db. */
void verdict_plane_to_db(float *out, const float *power, size_t count, double full, double span_db);

/* ---- a run --------------------------------------------------------------------------------------- */

/* In the order of the data path. */
typedef enum Channel {
    CHANNEL_SIZE,     /* of the images and the range profile: frames of different size are not compared further */
    CHANNEL_COUNTERS, /* of PDUs, drops, entities, events: run.json */
    CHANNEL_TIME,     /* which frames there are, and when */
    CHANNEL_POSE,     /* host and sensor: truth.jsonl */
    CHANNEL_SUN,      /* as seen from the host: truth.jsonl */
    CHANNEL_MOTION,   /* which entities there are, and their dead-reckoned positions: targets of truth.jsonl */
    CHANNEL_ENTITY,
    CHANNEL_PART,
    CHANNEL_RANGE,
    CHANNEL_NORMAL,
    CHANNEL_TARGETS, /* visible fraction and box of each, and what occludes it: truth.jsonl */
    CHANNEL_MATERIAL,
    CHANNEL_TEMP,
    CHANNEL_OPTICAL,
    CHANNEL_MWIR,
    CHANNEL_LWIR,
    CHANNEL_RADAR,
    CHANNEL_PROFILE,
    CHANNEL_SIGNALS, /* contrast, SNR, intensity of each target: truth.jsonl */
    CHANNEL_ERROR,   /* the run's estimate of its own error: truth.jsonl */
    CHANNEL_COUNT
} Channel;

typedef struct ChannelResult {
    bool there, failed;
    char line[512]; /* message; empty: none */
    /* of planes: the worst plane of the worst frame */
    bool         picture;
    int          frame;
    RecordPlane  plane;
    int          bounce; /* of a profile, which has no plane: FRAME_PLANES */
    PlaneVerdict verdict;
    double       limit, relative; /* absolute, and of the expected */
    double       allowed;         /* share of pixels that may be beyond */
    const char  *unit;
    int          diffs; /* of fields of truth.jsonl or run.json: how many differ */
} ChannelResult;

typedef struct Verdict {
    ChannelResult channel[CHANNEL_COUNT];
    int           first;      /* first channel that failed; -1: none */
    bool          same_build; /* version, libraries and ISA are those of the baseline */
    bool          other_log;  /* the log is not that of the baseline: its generator may be the cause */
    char remarks[16384];      /* lines: inputs that differ from the baseline's: tables, settings, log, build, choices */
} Verdict;

const char *verdict_channel_name(Channel channel);
const char *verdict_channel_about(Channel channel); /* a short description */
/* A value of a plane as text with its unit, or "below 100 K", "no surface", "not a number", "out of range". digits:
 * 1 .. 9. */
void verdict_channel_value(char out[64], Channel channel, double value, int digits);

/* A plane of baseline and run in the channel's unit, for the report. Freed by the caller with free. */
typedef struct ChannelPlanes {
    int    width, height;
    float *expected, *got, *difference;
} ChannelPlanes;
/* The plane that the result names. False when memory is out. */
bool verdict_channel_planes(ChannelPlanes *out, const ChannelResult *result, const RecordFrame *expected,
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
