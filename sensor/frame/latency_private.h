/* sensor/frame/latency_private.h: the latency ledger: when the data of a frame arrived, and when each step of the frame
 * and each of its consumers was done with it.
 *
 * All times are wall_clock_s, a steady clock. The last latency_frames frames are kept, and statistics of all; memory is
 * allocated once. Thread-safe: consumers report from their own threads. */
#ifndef SENSOR_FRAME_LATENCY_PRIVATE_H
#define SENSOR_FRAME_LATENCY_PRIVATE_H

#include "pitviper.h"

enum {
    latency_consumers_max = 24,
    latency_name_size = 24,
    latency_frames = 16,
    latency_edges = 31, /* 0.01 ms .. 10 s, five a decade */
    latency_bins = 902  /* of a fine histogram: 100 a decade */
};

typedef enum LatencyStage {
    LATENCY_ARRIVAL_TO_POSE,
    LATENCY_POSE_TO_RENDER,
    LATENCY_RENDER,
    LATENCY_DISPLAY,
    LATENCY_STAGE_COUNT
} LatencyStage;
extern const char *const latency_stage_name[LATENCY_STAGE_COUNT];

/* The times of one frame; 0: there is no such time. instant: when the frame's exercise time arrived here; arrived:
 * that of the newest datagram that the frame used; fresh: no earlier frame used this datagram. Only fresh frames are in
 * the statistics, since a silent exercise is no latency. */
typedef struct LatencyTimes {
    double instant_s, arrived_s, posed_s, render_s, rendered_s;
    bool   fresh;
} LatencyTimes;

/* The latencies of one frame, ms; NaN: there is none. Those of displays and of a consumer count from the end of
 * rendering; NaN: not done. */
typedef struct LatencyLine {
    double stage_ms[LATENCY_STAGE_COUNT];
    int    consumers;
    char   name[latency_consumers_max][latency_name_size];
    double done_ms[latency_consumers_max];
} LatencyLine;

/* Percentiles are upper limits, at most 2.4 % above the exact nearest rank. */
typedef struct LatencyFigures {
    uint64_t count, left_out;                   /* left_out: of a consumer, frames that it was not given */
    double   median_ms, p95_ms, p99_ms, max_ms; /* NaN: count is 0 */
    uint64_t histogram[latency_edges + 1];      /* below the first edge; between edges; from the last on */
} LatencyFigures;

/* Times counted in fine bins; all 0: none yet. */
typedef struct LatencyHistogram {
    uint64_t count, left_out;
    double   max_ms;
    uint64_t bin[latency_bins];
} LatencyHistogram;

/* Counts one time; NaN: none. */
void latency_count(LatencyHistogram *histogram, double ms);
void latency_figures(LatencyFigures *out, const LatencyHistogram *histogram);

/* The latencies of all frames so far. */
typedef struct LatencySummary {
    double         edge_ms[latency_edges];
    LatencyFigures stage[LATENCY_STAGE_COUNT];
    int            consumers;
    char           name[latency_consumers_max][latency_name_size];
    LatencyFigures consumer[latency_consumers_max];
} LatencySummary;

typedef struct Latency Latency;

Status latency_create(Latency **out);
void   latency_destroy(Latency *latency); /* NULL is valid */
/* Announces one more consumer of this name; before the first frame. Consumers of one name are done when the last of
 * them is. A name of NULL, or one too many, is not kept in the ledger. */
void latency_expect(Latency *latency, const char *name);

/* A rendered frame, before its consumers get it; returns its key. */
uint64_t latency_begin(Latency *latency, const LatencyTimes *times);
/* The displays of the frame are made, now. */
void latency_displayed(Latency *latency, uint64_t key, double rendered_s);
/* A consumer of that name has returned, now; or did not get the frame. Also of frames no longer kept. */
void latency_done(Latency *latency, uint64_t key, double rendered_s, const char *name);
/* The same of one that was done at wall_clock_s done_s, and reports it later. */
void latency_done_at(Latency *latency, uint64_t key, double rendered_s, const char *name, double done_s);
void latency_left_out(Latency *latency, uint64_t key, const char *name);
/* Whether no consumer of this frame is outstanding. True also for one no longer kept. */
bool latency_complete(Latency *latency, uint64_t key);
/* The frame so far. */
void latency_line(LatencyLine *out, Latency *latency, uint64_t key);
void latency_summary(LatencySummary *out, Latency *latency);
/* How many frames consumers were not given so far, in all, and of each: `video_file 12, latest 3`. */
enum { latency_lost_size = 160 };
uint64_t latency_lost(char out[latency_lost_size], Latency *latency);

#endif
