/* sensor/quality/lab.h: the scenes in which sampling settings are measured: 20 vehicles on synthetic terrain, seen from
 * seven places. `pitviper bench quality` measures the table there, and the machine factor its first row. */
#ifndef SENSOR_QUALITY_LAB_H
#define SENSOR_QUALITY_LAB_H

#include "sensor/quality/trial.h"

typedef struct QualityLab {
    Landscape  ground;
    TrialScene scene;
    Pool      *pool, *many;            /* of the threads asked for; of all processors */
    Arena     *arena, *reference_arena;
    int        width, height;
    bool       quick;
} QualityLab;

/* The settings of one row: as RenderRequest. */
typedef struct QualitySettings {
    int samples, edge_samples, target_samples;
} QualitySettings;

/* The fastest settings, the first row of every table: machines are compared by their time. */
static const QualitySettings quality_quickest = {1, 0, 0};

enum { quality_lab_views = 7, quality_lab_east_m = 2000, quality_lab_north_m = 4000 };

/* quality_lab_close must follow even on failure. quick: small images. */
Status quality_lab_open(QualityLab *out, int threads, bool quick);
void   quality_lab_close(QualityLab *lab);
TrialFrame quality_lab_frame(const QualityLab *lab, int view, QualitySettings settings);

/* Larger images for times, except where quick; the cost of small targets is the same in any. */
void   quality_lab_enlarge(QualityLab *lab);
/* The timed views, once, in s per megapixel, by the thread's CPU clock, which does not count other programs on the
 * machine, or by the wall clock. NaN: a frame failed. */
double quality_lab_time(const QualityLab *lab, QualitySettings settings, bool wall);

#endif
