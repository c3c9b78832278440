/* Ground beyond the fold of a seeker's radar, and ground that wind moves. labels: physics slow */
#include "tests/sensor/seeker_ground.h"

/* A window of 1499 m about 500 m, ground from 1270 m on: all that is received folds over; about 1499 m it is not heard.
 */
static void ground_folds_over(void **state)
{
    (void)state;
    int    cells;
    double far_share;
    preset = "pulse_doppler_ku", height_m = 250, aim_m = 1850, reference_m = 500;
    const double db = ground_over_integral_db(&cells, &far_share, 6);
    preset = "seeker_35", height_m = 250, aim_m = reference_m = 900;
    CHECK_NEAR(db, 0, 0.3);
    CHECK(far_share > 0.99);
}

/* Between two frames leaves move: the maps' correlation is the law's, weighted by the power of each class of ground. */
static void wind_decorrelates_the_ground(void **state)
{
    (void)state;
    enum { lags = 3, seeds = 4 };
    static const double lag_s[lags] = {0.001, 0.004, 1};
    const double        v[3] = {0, 0, 0}, wind_mps = 5;
    const Weather       weather = weather_default();
    double              along[lags] = {0}, power = 0, want[lags], far_w;
    for (uint64_t seed = 1; seed <= seeds; seed++) {
        SeekerRadar      *radar = open_windy_radar(seed, wind_mps), *calm = open_radar(seed);
        RadarScene        scene = scene_of(v, (uint32_t)seed, &weather);
        const RadarFrame *first, *later;
        arena_reset(stage.arena);
        CHECK(seeker_radar_measure(&first, radar, &scene, stage.pool, stage.arena) == STATUS_OK);
        const size_t cells = (size_t)first->map.rows * (size_t)first->map.columns;
        for (size_t i = 0; i < cells; i++) power += creal(first->map.cell[i] * conj(first->map.cell[i]));
        for (int l = 0; l < lags; l++) {
            scene.t_s = lag_s[l];
            CHECK(seeker_radar_measure(&later, radar, &scene, stage.pool, stage.arena) == STATUS_OK);
            for (size_t i = 0; i < cells; i++) along[l] += creal(later->map.cell[i] * conj(first->map.cell[i]));
            want[l] = power_by_integral(&far_w, first, lag_s[l], wind_mps) / power_by_integral(&far_w, first, 0, 0);
        }
        /* in a calm nothing moves */
        scene.t_s = 0;
        CHECK(seeker_radar_measure(&first, calm, &scene, stage.pool, stage.arena) == STATUS_OK);
        scene.t_s = 1;
        CHECK(seeker_radar_measure(&later, calm, &scene, stage.pool, stage.arena) == STATUS_OK);
        CHECK(memcmp(first->map.cell, later->map.cell, cells * sizeof *first->map.cell) == 0);
        seeker_radar_destroy(radar);
        seeker_radar_destroy(calm);
    }
    for (int l = 0; l < lags; l++) {
        print_message("ground in wind of %.0f m/s, %g s later: correlation %.3f, by the law %.3f\n", wind_mps, lag_s[l],
                      along[l] / power, want[l]);
        /* 4 standard errors of some 1000 independent cells */
        CHECK_NEAR(along[l] / power, want[l], 0.13);
    }
    CHECK(want[0] - want[1] > 0.13 && want[1] - want[2] > 0.13); /* three that differ */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ground_folds_over),
        cmocka_unit_test(wind_decorrelates_the_ground),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
