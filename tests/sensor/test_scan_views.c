/* A scan sharpened by Doppler, against lambda R / (2 v T sin psi), and on the pixels of the frame: spheres at places
 * that the test knows. labels: physics */
#include "tests/sensor/scan_stage.h"

static double line[sector_azimuths_most]; /* power over azimuth */

static const double speed_mps = 200, off_rad = 14 * rad_per_deg;

/* lambda R / (2 v T sin psi) over R. */
static double on_paper_rad(const RadarFrame *frame)
{
    const double interval_s = 128 / 4000.0, lambda_m = 299792458.0 / 16.5e9;
    CHECK(frame->preset->wave.pulses == 128 && frame->preset->wave.repeat_hz == 4000);
    return lambda_m / (2 * speed_mps * interval_s * sin(off_rad));
}

static double window_width(const RadarFrame *frame)
{
    WindowFigures figures;
    double        weight[128];
    CHECK(window_weights(weight, 128, &frame->preset->doppler_window) == STATUS_OK);
    CHECK(window_figures(&figures, weight, 128) == STATUS_OK);
    return figures.width_3db;
}

static void doppler_sharpens_as_on_paper(void **state)
{
    (void)state;
    static const double still[3] = {0, 0, 0};
    const Weather       weather = weather_default();
    SeekerRadar        *radar = open_radar("search_ku", 32, 0.5, false);
    place_sphere(0, off_rad, still);
    RadarScene scene = scene_of(speed_mps, &weather);
    arena_reset(stage.arena);
    const RadarFrame  *frame = measure(radar, &scene, stage.pool);
    const RadarSector *s = frame->scan;
    const double       first = -(s->plan.positions / 2) * s->plan.step_rad, paper = on_paper_rad(frame);
    const double       bins = window_width(frame);
    over_range(line, s->sharp_w, s->azimuths, s->columns);
    const int    peak = peak_of(line, s->azimuths);
    const double found = first + vertex_of(line, peak) * s->azimuth_step_rad;
    const double width = width_of(line, s->azimuths, peak) * s->azimuth_step_rad;
    const size_t at = (size_t)peak * (size_t)s->columns + (size_t)(s->columns / 2);
    printf("sharpened: at %.4f deg, want %.4f; %.3f mrad at half power, %.3f on paper; product %.3f m, paper %.3f m\n",
           found / rad_per_deg, off_rad / rad_per_deg, 1e3 * width, 1e3 * bins * paper, s->resolution_m[at],
           bins * paper * range_m);
    CHECK_NEAR(found, off_rad, 0.05 * bins * paper);
    CHECK_NEAR(width / bins, paper, 0.1 * paper);
    CHECK(s->sharpened[at] == 1);
    CHECK_NEAR(s->resolution_m[at], bins * paper * range_m, 0.02 * bins * paper * range_m);

    /* ahead it gains nothing: the real beam stands there, and is said to; to both sides of it, it sharpens */
    const size_t ahead = (size_t)(s->azimuths / 2) * (size_t)s->columns + (size_t)(s->columns / 2);
    CHECK(s->sharpened[ahead] == 0 && s->sharpened[(size_t)(s->columns / 2)] == 1);
    CHECK_NEAR(s->resolution_m[ahead], s->beam_rad * range_m, 1e-6 * range_m);
    const size_t middle = (size_t)(s->plan.positions / 2) * (size_t)s->columns + (size_t)(s->columns / 2);
    CHECK_NEAR(s->sharp_w[ahead] / s->power_w[middle], 1, 1e-9);

    /* two, nearer than the beam is wide: one in the real beam, two sharpened */
    const double apart = 1.8 * bins * paper;
    CHECK(apart < 0.75 * s->beam_rad);
    place_sphere(0, off_rad - 0.5 * apart, still);
    place_sphere(1, off_rad + 0.5 * apart, still);
    frame = measure(radar, &scene, stage.pool);
    s = frame->scan;
    over_range(line, s->power_w, s->plan.positions, s->columns);
    const double greatest = line[peak_of(line, s->plan.positions)];
    int          humps = 0;
    for (int i = 1; i < s->plan.positions - 1; i++) /* above a hundredth of the greatest: no side lobes */
        humps += line[i] > line[i - 1] && line[i] >= line[i + 1] && line[i] > 0.01 * greatest;
    CHECK(humps == 1);
    over_range(line, s->sharp_w, s->azimuths, s->columns);
    for (int side = -1; side <= 1; side += 2) {
        const double want = off_rad + side * 0.5 * apart;
        const int    begin = (int)((off_rad + (side < 0 ? -apart : 0) - first) / s->azimuth_step_rad);
        const int    count = (int)(apart / s->azimuth_step_rad), one = begin + peak_of(line + begin, count);
        const double at_one = first + vertex_of(line, one) * s->azimuth_step_rad;
        const double between = line[(int)lround((off_rad - first) / s->azimuth_step_rad)];
        printf("of two: at %.4f deg, want %.4f; between them %.1f dB\n", at_one / rad_per_deg, want / rad_per_deg,
               10 * log10(between / line[one]));
        CHECK_NEAR(at_one, want, 0.1 * bins * paper);
        CHECK(between < 0.25 * line[one]);
    }
    seeker_radar_destroy(radar);
}

/* Every pixel shows something at the sphere's range but for a few: its picture is that of the scan over azimuth. */
static void pixels_have_the_value_of_their_range_and_azimuth(void **state)
{
    (void)state;
    const double        v[3] = {25, 0, 0}; /* recedes; 5 m by the time the beam is there */
    static const double still[3] = {0, 0, 0};
    const Weather       weather = weather_default();
    SeekerRadar        *radar = open_radar("search_ku", 32, 0.5, false);
    for (int moves = 0; moves < 2; moves++) {
        place_sphere(0, off_rad, moves ? v : still);
        RadarScene scene = scene_of(speed_mps, &weather);
        scene.range_m = stage.range_m;
        scene.entity = stage.shown;
        for (int i = 0; i < rows_px * columns_px; i++) {
            stage.range_m[i] = (float)(range_m - radius_m);
            stage.shown[i] = moves ? 1 : 0;
        }
        const int beyond = 2 * columns_px, sky = 3 * columns_px; /* two rows of other things */
        for (int x = 0; x < columns_px; x++) {
            stage.range_m[beyond + x] = (float)(range_m + 100);
            stage.range_m[sky + x] = INFINITY;
        }
        arena_reset(stage.arena);
        const RadarSector *s = measure(radar, &scene, stage.pool)->scan;
        CHECK(s->width == columns_px && s->height == rows_px);
        const int    middle = (rows_px / 2) * columns_px;
        const double want = 0.5 * columns_px + 500 * tan(off_rad) - 0.5; /* index of the pixel whose centre is there */
        double       real[columns_px], sharp[columns_px];
        for (int x = 0; x < columns_px; x++) {
            real[x] = isnan(s->view_w[middle + x]) ? 0 : s->view_w[middle + x];
            sharp[x] = isnan(s->view_sharp_w[middle + x]) ? 0 : s->view_sharp_w[middle + x];
            CHECK(isnan(s->view_w[sky + x]) && isnan(s->view_sharp_w[sky + x]));
        }
        const double beam_px = 500 * s->beam_rad / pow(cos(off_rad), 2);
        const double at_real = vertex_of(real, peak_of(real, columns_px));
        const double at_sharp = vertex_of(sharp, peak_of(sharp, columns_px));
        printf("%s: on pixel %.2f in the real beam, %.2f sharpened, want %.2f; the beam is %.1f pixels wide\n",
               moves ? "moving" : "still", at_real, at_sharp, want, beam_px);
        CHECK(real[0] == 0 && real[columns_px - 1] == 0); /* out of the sector */
        const int px = (int)lround(want);
        CHECK(s->view_w[beyond + px] < 1e-3 * real[px]);
        /* what moves goes through cells of range, and loses more and less between them */
        CHECK_NEAR(at_real, want, (moves ? 0.1 : 0.03) * beam_px);
        if (!moves) CHECK_NEAR(at_sharp, want, 0.5); /* Doppler displaces what moves */
    }
    seeker_radar_destroy(radar);
}

/* A fifth of a step from a position the cubic is farthest off: by 2.15 % of the beamwidth for a dish of taper 1. */
static void between_positions_the_beam_is_nearly_a_gaussian(void **state)
{
    (void)state;
    static const double still[3] = {0, 0, 0};
    const Weather       weather = weather_default();
    SeekerRadar        *radar = open_radar("search_ku", 32, 0.5, false);
    SectorPlan          plan;
    RadarPreset         preset;
    char                path[4096];
    CHECK(etc_path(path, sizeof path, "radars.csv") && radar_preset_read(&preset, path, "search_ku") == STATUS_OK);
    CHECK(radar_sector_plan(&plan, &preset, 32 * rad_per_deg, 0.5) == STATUS_OK);
    const double azimuth = 3.2 * plan.step_rad, want = 0.5 * columns_px + 500 * tan(azimuth) - 0.5;
    place_sphere(0, azimuth, still);
    RadarScene scene = scene_of(0, &weather);
    for (int i = 0; i < rows_px * columns_px; i++) stage.range_m[i] = (float)(range_m - radius_m);
    scene.range_m = stage.range_m;
    arena_reset(stage.arena);
    const RadarSector *s = measure(radar, &scene, stage.pool)->scan;
    double             real[columns_px];
    for (int x = 0; x < columns_px; x++) real[x] = isnan(s->view_w[x]) ? 0 : s->view_w[x];
    const double error_rad = (vertex_of(real, peak_of(real, columns_px)) - want) / 500 * pow(cos(azimuth), 2);
    printf("between positions: %.2f %% of the beamwidth off\n", 100 * error_rad / (2 * plan.step_rad));
    CHECK_NEAR(error_rad / (2 * plan.step_rad), 0, 0.03);
    seeker_radar_destroy(radar);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(doppler_sharpens_as_on_paper),
        cmocka_unit_test(pixels_have_the_value_of_their_range_and_azimuth),
        cmocka_unit_test(between_positions_the_beam_is_nearly_a_gaussian),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
