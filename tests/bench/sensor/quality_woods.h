/* tests/bench/sensor/quality_woods.h: woods about the vehicles of the quality scenes. */
#ifndef TESTS_BENCH_SENSOR_QUALITY_WOODS_H
#define TESTS_BENCH_SENSOR_QUALITY_WOODS_H

#include "sensor/quality/quality_measure.h"
#include "tests/scenes/woods_stand.h"

/* Plants trees over all of the scene's ground but the vehicles' places, and warms the scene. woods_destroy after it. */
Status quality_woods_plant(Woods *woods, QualityMeasure *lab);

#endif
