/* sensor/quality/quality_measure.h: measures sampling settings, in scenes of 20 vehicles on synthetic terrain that
 * are seen from seven places. `pitviper bench quality` measures all rows of the table so, and a node the first one,
 * as its machine factor. */
#ifndef SENSOR_QUALITY_QUALITY_MEASURE_H
#define SENSOR_QUALITY_QUALITY_MEASURE_H

#include "sensor/quality/trial_private.h"

typedef struct QualityMeasure {
    Landscape  ground;
    TrialScene scene;
    Pool      *pool, *many; /* of the threads asked for; of all processors */
    Arena     *arena, *reference_arena;
    int        width, height;
    bool       quick;
} QualityMeasure;

/* The settings of one row: as RenderRequest. */
typedef struct QualitySettings {
    int samples, edge_samples, target_samples;
} QualitySettings;

/* The fastest settings, the first row of every table: machines are compared by their time. */
static const QualitySettings quality_quickest = {1, 0, 0};

enum { quality_measure_views = 7, quality_measure_east_m = 2000, quality_measure_north_m = 4000 };

/* quality_measure_close must follow even on failure. quick: small images. */
Status     quality_measure_open(QualityMeasure *out, int threads, bool quick);
void       quality_measure_close(QualityMeasure *measure);
TrialFrame quality_measure_frame(const QualityMeasure *measure, int view, QualitySettings settings);

/* Larger images for times, except where quick; the cost of small targets is the same in any. */
void quality_measure_enlarge(QualityMeasure *measure);
/* The timed views, once, in s per megapixel, by the thread's CPU clock, which does not count other programs on the
 * machine, or by the wall clock. NaN: a frame failed. */
double quality_measure_time(const QualityMeasure *measure, QualitySettings settings, bool wall);

/* The machine factor: this machine's time of the table's first row, on this many threads, divided by the table's, to
 * two digits. It takes about two seconds, mostly for the scenes. STATUS_BAD_VALUE, logged: the table's first row is not
 * the fastest settings. */
Status quality_machine_factor(double *factor, const char *table_path, int threads);

#endif
