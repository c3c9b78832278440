/* sensor/commands/range/range_private.h: ranges at which a sensor's observer detects, recognises and identifies a
 * target: over range as a table and a plot. */
#ifndef SENSOR_COMMANDS_RANGE_RANGE_PRIVATE_H
#define SENSOR_COMMANDS_RANGE_RANGE_PRIVATE_H

#include "render/air/atmosphere.h"
#include "sensor/acquisition/acquisition.h"
#include "sensor/acquisition/criteria.h"

enum { range_methods = 2, range_rows = 201 };
typedef enum RangeMethod { BY_JOHNSON, BY_TTP } RangeMethod;

typedef struct RangeScene {
    double      size_m;     /* root of the target's area */
    double      contrast;   /* at the target: K, or its difference over the background's radiance */
    double      observer_m; /* above the ground; the target's middle is 1 m above it */
    double      sun_rad;    /* above the horizon: lights a background of reflectance 0.2, in reflective bands */
    double      visibility_m;
    const char *air; /* a model of etc/atmosphere */
    double      at50[range_methods][acquisition_tasks];
    double      far_m; /* of the last row; NaN: where detection is rare */
} RangeScene;

typedef struct RangePoint {
    double range_m, transmittance;
    double contrast; /* apparent */
    double cycles, ttp_v;
    double p[range_methods][acquisition_tasks];
} RangePoint;

typedef struct RangeCourse {
    SensorPreset preset;
    RangeScene   scene;
    AirBand      band;
    double       pixel_rad, background_k, lit_w_m2_sr; /* lit: radiance of a sunlit background */
    Atmosphere  *atmosphere;
    Acquisition  curves;
    RangePoint   row[range_rows]; /* even steps of range, from one step on */
} RangeCourse;

/* course: zeroes, with preset and scene. On failure, logged, range_course_close is still due. */
Status range_course_make(RangeCourse *course);
void   range_course_close(RangeCourse *course);
void   range_at(RangePoint *out, const RangeCourse *course, double range_m);
/* The farthest range with that probability, to 1e-4 of itself; 0: less near by; INFINITY: more at the last row too. */
double range_of(const RangeCourse *course, RangeMethod method, AcquisitionTask task, double probability);

/* ---- range_plot.c ------------------------------------------------------------------------------- */

/* course and about, the line below the title. */
typedef struct RangeText {
    const RangeCourse *course;
    const char        *about;
} RangeText;
void                     range_plot(FILE *to, const void *text);
void                     range_csv(FILE *to, const void *text);
extern const char *const range_task_names[acquisition_tasks];

#endif
