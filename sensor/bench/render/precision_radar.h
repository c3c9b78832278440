/* sensor/bench/render/precision_radar.h: between the files of the radar's benchmarks of precision. */
#ifndef SENSOR_BENCH_RENDER_PRECISION_RADAR_H
#define SENSOR_BENCH_RENDER_PRECISION_RADAR_H

#include "render/radar/target.h"
#include "sensor/bench/bench.h"

/* Edges, lists used at other aspects, centres instead of hits. */
Status precision_radar_reuse(Bench *bench, RadarTarget *tank, Pool *pool);
/* Flat faces by ray tubes and in closed form. */
Status precision_radar_polygons(Bench *bench, const RadarMaterials *materials, Pool *pool);

#endif
