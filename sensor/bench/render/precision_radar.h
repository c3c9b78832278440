/* sensor/bench/render/precision_radar.h: between the files of the radar's benchmarks of precision. */
#ifndef SENSOR_BENCH_RENDER_PRECISION_RADAR_H
#define SENSOR_BENCH_RENDER_PRECISION_RADAR_H

#include "render/scattering/field/radar_target.h"
#include "sensor/bench/bench.h"

/* Root of the power of the difference over the power, over so many frequencies or looks, co-polarised, %. */
double precision_radar_off(const ScatterMatrix *got, const ScatterMatrix *want, int count);
/* Edges, lists used at other aspects, centres instead of hits. */
Status precision_radar_reuse(Bench *bench, RadarTarget *tank, Pool *pool);
/* Flat faces by ray tubes and in closed form. */
Status precision_radar_polygons(Bench *bench, const RadarMaterials *materials, Pool *pool);

#endif
