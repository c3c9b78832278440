/* A beam that scans with each waveform but that of test_scan.c: the azimuth and range of a sphere, and its pixel, from
 * a still antenna and from one that flies. labels: physics */
#include "tests/sensor/scan_stage.h"

static double line[sector_azimuths_most]; /* power over azimuth */

static const double near_m = 600; /* within the window of fmcw_94 */

static void place_near(double azimuth)
{
    static const double still[3] = {0, 0, 0};
    SnapshotEntity     *e = &stage.entity[0];
    double              p[3];
    place_sphere(0, azimuth, still);
    enu_from_ecef(p, &stage.world.frame, e->p_ecef);
    for (int k = 0; k < 2; k++) p[k] *= near_m / range_m;
    ecef_from_enu(e->p_ecef, &stage.world.frame, p);
}

/* share: of the beam's width, that its azimuth may be off. */
static void find_sphere(const char *preset, double sector_deg, double azimuth, double speed, double share)
{
    const Weather weather = weather_default();
    SeekerRadar  *radar = open_radar(preset, sector_deg, 0.25, false);
    place_near(azimuth);
    RadarScene scene = scene_of(speed, &weather);
    scene.reference_m = near_m;
    for (int i = 0; i < rows_px * columns_px; i++) stage.range_m[i] = (float)(near_m - radius_m);
    scene.range_m = stage.range_m;
    arena_reset(stage.arena);
    const RadarFrame  *frame = measure(radar, &scene, stage.pool);
    const RadarSector *s = frame->scan;
    CHECK(s && s->plan.positions > 8);
    over_range(line, s->power_w, s->plan.positions, s->columns);
    const int    peak = peak_of(line, s->plan.positions);
    const double found = (vertex_of(line, peak) - s->plan.positions / 2) * s->plan.step_rad;
    /* on paper: two-way pattern over range to the fourth, at each position */
    double paper[sector_positions_most] = {0}, there_m[sector_positions_most];
    for (int i = 0; i < s->plan.positions; i++) {
        const double from_middle = i - s->plan.positions / 2, gone_m = speed * from_middle * s->plan.interval_s;
        const double x = near_m * cos(azimuth) - gone_m, y = near_m * sin(azimuth);
        there_m[i] = hypot(x, y) - radius_m;
        const double off = from_middle * s->plan.step_rad - atan2(y, x);
        paper[i] = pow(aperture_field(&frame->preset->antenna, off) / there_m[i], 4);
    }
    const int    best = peak_of(paper, s->plan.positions);
    const double want = (vertex_of(paper, best) - s->plan.positions / 2) * s->plan.step_rad;
    const double beam = two_way_width(&frame->preset->antenna), cell_m = frame->map.metre_per_column;
    const int    column = peak_of(s->power_w + (size_t)peak * (size_t)s->columns, s->columns);
    const double after_s = (peak - s->plan.positions / 2) * s->plan.interval_s;
    /* the receiver follows the reference, but for the window of fmcw, which begins at the antenna */
    const double followed_m = frame->preset->wave.kind == WAVEFORM_FMCW ? 0 : frame->reference_rate_mps * after_s;
    const double at_m = frame->reference_m + followed_m + (column - s->columns / 2) * cell_m;
    /* the pixel that shows it has the power of the nearest position's peak, but for what the beam loses between two */
    const size_t pixel = rows_px / 2 * columns_px + (size_t)lround(columns_px / 2 + 500 * tan(azimuth));
    const double peak_w = s->power_w[(size_t)peak * (size_t)s->columns + (size_t)column];
    const double pixel_db = 10 * log10((double)s->view_w[pixel] / peak_w);
    printf("%s, %g m/s, %d positions in %.2f s: azimuth %+.4f of the beam off, range %+.2f of a cell, pixel %+.2f dB\n",
           preset, speed, s->plan.positions, s->plan.positions * s->plan.interval_s, (found - want) / beam,
           (at_m - there_m[peak]) / cell_m, pixel_db);
    CHECK(speed == 0 || fabs(want - azimuth) > 0.002 * beam); /* so that the test tells */
    CHECK_NEAR(found, want, share * beam);
    CHECK_NEAR(at_m, there_m[peak], 0.75 * cell_m);
    CHECK(pixel_db > -2 && pixel_db < 1);
    seeker_radar_destroy(radar);
}

static void fmcw(void **state)
{
    (void)state;
    find_sphere("fmcw_94", 4, 0.44 * rad_per_deg, 0, 0.005);
    find_sphere("fmcw_94", 4, 1.2 * rad_per_deg, 200, 0.02);
}

static void stepped_frequency(void **state)
{
    (void)state;
    find_sphere("stepped_35", 10, 1.23 * rad_per_deg, 0, 0.005);
    find_sphere("stepped_35", 10, 3 * rad_per_deg, 100, 0.02);
}

static void pulse_doppler(void **state)
{
    (void)state;
    find_sphere("pulse_doppler_ku", 8, 0.87 * rad_per_deg, 0, 0.005);
    find_sphere("pulse_doppler_ku", 8, 2.5 * rad_per_deg, 250, 0.02);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fmcw),
        cmocka_unit_test(stepped_frequency),
        cmocka_unit_test(pulse_doppler),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
