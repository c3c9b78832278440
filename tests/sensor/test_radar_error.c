/* The error estimate of a radar's map: what gridding leaves against sums by hand, an echo that is displaced against one
 * measured there, shares of a map whose energy is known. labels: physics */
#include "tests/sensor/scan_stage.h"

#include "sensor/radar/echo.h"
#include "sensor/truth/frame_error.h"

enum { samples = 128, pulses = 64, echoes = 20, all = interval_channels * pulses * samples };

/* rms over all samples, of echoes of many rates: those at rest have 1e-6. */
static void gridding_leaves_as_much(void **state)
{
    (void)state;
    static double complex got[all];
    const Waveform        wave = {.centre_hz = 94e9,
                                  .bandwidth_hz = 500e6,
                                  .pulse_s = 2e-5,
                                  .repeat_hz = 2e4,
                                  .samples = samples,
                                  .pulses = pulses};
    const double step_hz = wave.bandwidth_hz / samples, row_s = 1 / wave.repeat_hz, step_s = wave.pulse_s / samples;
    double       error = 0, power = 0;
    EchoGrid    *grid;
    CHECK(echo_grid_create(&grid, &wave) == STATUS_OK);
    for (int i = 0; i < echoes; i++) {
        const double rate_mps = 80 * (random_uniform(3, 0, 0, (uint64_t)i) - 0.5); /* of the path: 20 m/s of range */
        const Echo   echo = {.path_m = 60 * (random_uniform(3, 0, 1, (uint64_t)i) - 0.5),
                             .amplitude = {1, 0, 0, 0},
                             .path_per_pulse_m = rate_mps * row_s};
        echo_add(grid, &echo, 1, NULL);
        echo_sum(got, grid);
        for (int n = 0; n < pulses; n++)
            for (int m = 0; m < samples; m++) {
                const double t_s = (n - 0.5 * (pulses - 1)) * row_s + (m - samples / 2) * step_s;
                const double path_m = echo.path_m + rate_mps * t_s;
                const double turn = -2 * pi_rad / light_mps * (wave.centre_hz + (m - samples / 2) * step_hz) * path_m;
                const double complex off = got[n * samples + m] - CMPLX(cos(turn), sin(turn));
                error += creal(off) * creal(off) + cimag(off) * cimag(off);
                power += 1;
            }
    }
    const double rms = sqrt(error / power);
    printf("gridding leaves %.1e of the amplitude, estimated %.1e\n", rms, radar_error_of_gridding());
    CHECK(rms < 2 * radar_error_of_gridding() && rms > radar_error_of_gridding() / 2);
    echo_grid_destroy(grid);
}

static double energy_of(const RangeDoppler *map)
{
    double sum = 0;
    for (int i = 0; i < map->rows * map->columns; i++) sum += creal(map->cell[i] * conj(map->cell[i]));
    return sum;
}

static const RadarFrame *measure_at(SeekerRadar *radar, const RadarScene *scene, double further_m)
{
    double              p_enu[3];
    SnapshotEntity     *e = &stage.entity[0];
    const LocalFrame   *frame = &stage.world.frame;
    static const double still[3] = {0, 0, 0};
    place_sphere(0, 0, still);
    enu_from_ecef(p_enu, frame, e->p_ecef);
    p_enu[0] += further_m;
    ecef_from_enu(e->p_ecef, frame, p_enu);
    return measure(radar, scene, stage.pool);
}

/* A sphere that is almost all of the map: its energy is that of its signal to noise, so the share is its own.
 * Displaced, it changes the map by what is estimated of a correction as long in space as its component here. */
static void a_sphere_has_its_own_share_and_moves(void **state)
{
    (void)state;
    const Weather    weather = weather_default();
    SeekerRadar     *radar = open_radar("search_ku", 0, 0.5, false);
    const RadarScene scene = scene_of(0, &weather);
    RadarError       error, moved;
    place_sphere(0, 0, (const double[3]){0, 0, 0});
    arena_reset(stage.arena);
    const RadarFrame *frame = measure_at(radar, &scene, 0);
    const RadarTruth *t = &frame->target[0];
    CHECK(frame->targets == 1);
    radar_error(&error, frame, &stage.snapshot);
    /* of HH, which is transmitted: 10 log10(1 + sqrt(2) error / field) */
    const double tubes = (pow(10, 0.1 * t->rcs_error_db[0]) - 1) / sqrt(2);
    const double own = hypot(tubes, sqrt(signature_cells_error()));
    printf("own error %.2e of the field; of the map %.2e by tubes, %.2e by centres, %.2e by gridding, in all %.2e\n",
           own, error.share[ERROR_SAMPLING], error.share[ERROR_LEVEL_OF_DETAIL], error.share[ERROR_TABLES],
           error.share[ERROR_TOTAL]);
    printf("of the cross section: %.3f dB by tubes, %.3f in all\n", error.db[ERROR_SAMPLING], error.db[ERROR_TOTAL]);
    CHECK_NEAR(error.share[ERROR_TOTAL] / own, 1, 0.05); /* noise, phase noise, errors of I and Q are in the map too */
    CHECK_NEAR(error.share[ERROR_DEAD_RECKONING], 0, 0);
    CHECK(isnan(error.share[ERROR_HEAT]) && isnan(error.db[ERROR_HEAT]) && isnan(error.db[ERROR_DEAD_RECKONING]));
    CHECK_NEAR(error.db[ERROR_SAMPLING], t->rcs_error_db[0], 1e-9);
    CHECK(error.db[ERROR_TOTAL] > error.db[ERROR_SAMPLING]);

    for (int i = 1; i <= 4; i++) {
        const double      cells = 0.4 * i, way_m = cells * frame->map.metre_per_column;
        const RadarFrame *there = measure_at(radar, &scene, way_m);
        double complex    both = 0;
        for (int k = 0; k < frame->map.rows * frame->map.columns; k++)
            both += frame->map.cell[k] * conj(there->map.cell[k]);
        const double a = energy_of(&frame->map), b = energy_of(&there->map), change = (a + b - 2 * cabs(both)) / a;
        stage.entity[0].drift_m = sqrt(3) * way_m;
        radar_error(&moved, frame, &stage.snapshot);
        printf("displaced by %.1f cells: %.4f of the map's rms, estimated %.4f\n", cells, sqrt(change),
               moved.share[ERROR_DEAD_RECKONING]);
        CHECK_NEAR(moved.share[ERROR_DEAD_RECKONING] / sqrt(change), 1, 0.1);
        CHECK_NEAR(moved.share[ERROR_TOTAL], hypot(error.share[ERROR_TOTAL], moved.share[ERROR_DEAD_RECKONING]), 1e-12);
        CHECK(moved.db[ERROR_TOTAL] == error.db[ERROR_TOTAL]);
    }
    stage.entity[0].drift_m = 0;

    /* without an entity nothing is left but gridding */
    RadarFrame alone = *frame;
    alone.targets = 0;
    radar_error(&error, &alone, &stage.snapshot);
    CHECK_NEAR(error.share[ERROR_TOTAL], radar_error_of_gridding(), 1e-12);
    CHECK(isnan(error.db[ERROR_TOTAL]));
    seeker_radar_destroy(radar);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gridding_leaves_as_much),
        cmocka_unit_test(a_sphere_has_its_own_share_and_moves),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
