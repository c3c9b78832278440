/* tests/bench/sensor/quality_woods.c: woods about the vehicles of the quality scenes. */
#include "tests/bench/sensor/quality_woods.h"

#include "sensor/settings/config.h"

/* A third of the density of `bench woods`: half to two thirds of the pixels are plants, in the demonstration 21 to 46
 * %. */
static const double trees_per_m2 = 0.005;
static const double cleared_m = 6; /* about a vehicle */

Status quality_woods_plant(Woods *woods, QualityMeasure *lab)
{
    const Config       config = config_default();
    const ForestConfig forest = {.leaves = true,
                                 .level1_px = config.terrain.woods_level1_px,
                                 .fine = true,
                                 .sway = config.terrain.woods_sway,
                                 .tables = config.terrain.woods_tables};
    const HeatConfig   heat = heat_default_config();
    WoodsStand         stand = {.landscape = &lab->ground,
                                .east_m = quality_measure_east_m,
                                .north_m = quality_measure_north_m,
                                .trees = (int)(trees_per_m2 * quality_measure_east_m * quality_measure_north_m)};
    Snapshot           snapshot;
    arena_reset(lab->arena);
    Status status = entity_table_snapshot(&snapshot, lab->scene.table, lab->scene.sun_now_s + 0.5, lab->arena);
    for (int k = 0; status == STATUS_OK && k < snapshot.count && k < woods_stand_clear; k++) {
        double p_enu[3];
        enu_from_ecef(p_enu, &lab->ground.frame, snapshot.entity[k].p_ecef);
        stand.clear[stand.clears++] = (WoodsPath){{p_enu[0], p_enu[1]}, {p_enu[0], p_enu[1]}, cleared_m, cleared_m};
    }
    if (status == STATUS_OK) status = woods_stand_create(woods, &stand, lab->many);
    if (status == STATUS_OK) status = world_plant(&lab->scene.world, woods, &forest, NULL, lab->many);
    return status == STATUS_OK ? trial_scene_warm(&lab->scene, &heat) : status;
}
