/* sensor/verify/regress/verdict.h: a run's JSON and planes read back, and compared with its baseline, channel
 * by channel, in the order of the data path: the first that fails is the probable cause of those after it. */
#ifndef SENSOR_VERIFY_REGRESS_VERDICT_H
#define SENSOR_VERIFY_REGRESS_VERDICT_H

#include "pitviper.h"
#include "render/frame/planes.h"
#include "sensor/frame/field.h"
#include "sensor/verify/regress/case.h"

/* ---- values of JSON (json_values.c) ---------------------------------------------------------- */

/* The JSON of this program is read back as a flat list of paths and values.
 *
 *     {"frame":3,"targets":[{"entity":"1:3001:12","box_px":[4,5]}]}
 *
 * gives `frame`, `targets[1:3001:12].entity`, `targets[1:3001:12].box_px[0]`, `...[1]`: an element of a list is
 * named by its `entity` where it has one, else by its index. Sorted by path. */
typedef struct JsonValue {
    char  *path;
    char  *text;   /* NULL: a number; true and false are 1 and 0, null is NaN */
    double number; /* of a text: NaN */
} JsonValue;

typedef struct JsonValues {
    int        count, capacity;
    JsonValue *value; /* [count] */
} JsonValues;

enum { json_values_most = 4000000 };

/* Any bytes. STATUS_BAD_VALUE, logged as the module's with source and position: not one JSON object, keys given twice,
 * deeper than 16, longer paths than 500, more values than json_values_most. On failure *out is empty. */
Status json_values_read(JsonValues *out, const char *text, size_t octets, const char *module, const char *source);
void   json_values_free(JsonValues *values);
const JsonValue *json_values_find(const JsonValues *values, const char *path); /* NULL: absent */
/* Makes a text of the object of `text` without these top-level keys, formatted as run.json. *out: freed by the caller
 * with free. STATUS_BAD_VALUE, logged: it is not a JSON object. */
Status json_text_without(char **out, const char *text, size_t octets, const char *const *key, int keys,
                         const char *module, const char *source);

/* All recorded planes of one frame, from the folder of a run or from the EXR of
 * a baseline.
 *
 * A baseline is small because its numbers are rounded, below the tolerances of case_default; a run is rounded the same
 * way before it is compared, so that equal runs have zero difference. One step of each is in render/frame/planes.c: of
 * ranges 1.5e-5 relative at most, of optical radiance 0.8 %, of thermal 0.03 K apparent at 300 K, of radar 0.03 dB.
 *
 * In the file a number is its count of steps, less that of its left neighbour, so that deflate finds small numbers
 * (half the size of rounded floats): see record_code_plane. 96 x 64 in all bands is some 45 kB a frame. */

/* A plane of a baseline: its place among those that are compared (plane_recorded of render/frame/planes.h). */
typedef int RecordPlane;

enum { record_no_plane = planes_most, frame_bounces = 3, frame_size_max = 8192, frame_bins_max = 65536 };

typedef struct RecordFrame {
    int       number, width, height;
    float    *number_plane[planes_most]; /* [height][width]; NULL: absent, or a plane of ids */
    uint32_t *id_plane[planes_most];     /* entity, part, material */
    int       bins;                      /* 0: no profile */
    double    near_m, bin_m;             /* middle of the first bin; spacing */
    float    *profile[frame_bounces];    /* [bins] */
    char      date[32];                  /* of the exercise, as EXR writes it */
    char     *material_names;            /* comma-separated: the k-th is material k; NULL: an older baseline */
} RecordFrame;

RecordPlane record_plane(const char *name);       /* by its channel in the baseline; record_no_plane: none */
const char *record_plane_name(RecordPlane plane); /* channel in the baseline */
bool        record_plane_is_id(RecordPlane plane);

/* Frame `number` of a replay, rounded. STATUS_IO, logged, when it is missing. */
Status record_frame_from_run(RecordFrame *out, const char *folder, int number);
/* The same of record/. like: only a frame of that size and number of bins is read; else STATUS_BAD_VALUE, logged. */
Status record_frame_from_record(RecordFrame *out, const char *folder, const RecordFrame *like);
/* The sizes in record/, from the headers of its files, without reading planes. bins 0: there is no profile. */
typedef struct RecordFrameSize {
    int width, height, bins;
} RecordFrameSize;
Status record_frame_size(RecordFrameSize *out, const char *folder, int number);
/* Renames the materials of `frame` as `like` numbers them, by name; a name that only `frame` has gets a number beyond
 * those of `like`. Nothing changes where one of them has no names. STATUS_NO_MEMORY. */
Status record_frame_rename_materials(RecordFrame *frame, const RecordFrame *like);
Status record_frame_write(const char *folder, const RecordFrame *frame);
void   record_frame_free(RecordFrame *frame);

/* Rounding in whole steps. Infinity and NaN have reserved numbers; -0 is 0. record_value is the inverse. */
int32_t record_steps(const PlaneRounding *rounding, float value);
float   record_value(const PlaneRounding *rounding, int32_t steps);
/* Differences to the left neighbour, as stored in the file; and the inverse. Must not alias. */
void record_code_plane(uint32_t *coded, const float *value, int width, int height, const PlaneRounding *rounding);
void record_decode_plane(float *value, const uint32_t *coded, int width, int height, const PlaneRounding *rounding);

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
    size_t unmatched;     /* pixels where only one is finite, or infinities or NaN differ */
    int    column, row;   /* first pixel with this max; -1: nothing differs */
    double expected, got; /* there */
} PlaneVerdict;

/* The limit of a pixel is absolute + relative |expected|. ignored: the difference counts as 0 where it is not 0; may be
 * NULL. */
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
/* Converts power to dB relative to `full`, at least -span_db. */
void verdict_plane_to_db(float *out, const float *power, size_t count, double full, double span_db);

/* ---- a run --------------------------------------------------------------------------------------- */

/* The channels, in the order of the data path. */
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
    CHANNEL_SCORES,  /* detection, false alarms, average precision of a recogniser, which follow from all before */
    CHANNEL_ERROR,   /* the run's estimate of its own error: truth.jsonl */
    CHANNEL_COUNT
} Channel;

typedef struct ChannelResult {
    bool there, failed;
    char line[512]; /* message; empty: none */
    /* for planes: the worst plane of the worst frame */
    bool         picture;
    int          frame;
    RecordPlane  plane;
    int          bounce; /* of a profile, whose plane is record_no_plane */
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
/* Writes a value of a plane as text with its unit, or "below 100 K", "no surface", "not a number", "out of range".
 * digits: 1 .. 9. */
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
/* Which fields of two records are compared, and how. */
typedef struct FieldRule {
    const FieldTable *table;
    FieldChannel      channel; /* of fields that have none; FIELD_APART: they are not compared */
    bool              exact;   /* numbers are equal; else within a tolerance, times this factor: */
    double            factor;
} FieldRule;
void verdict_fields(ChannelResult result[CHANNEL_COUNT], int frame, const JsonValues *expected, const JsonValues *got,
                    const FieldRule *rule);
/* A line of truth.jsonl. */
void verdict_truth(ChannelResult result[CHANNEL_COUNT], int frame, const JsonValues *expected, const JsonValues *got,
                   double factor);
/* scores.json: rates by the case's tolerances, in all bands together and in each. */
void verdict_scores(ChannelResult *result, const JsonValues *expected, const JsonValues *got,
                    const Tolerance *tolerance);
/* run.json: counters. */
void verdict_counters(ChannelResult result[CHANNEL_COUNT], const JsonValues *expected, const JsonValues *got);

#endif
