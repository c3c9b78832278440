/* A beam that scans: spheres at places that the test knows, widths against an integral over the aperture; ground
 * against a beam that stares. The same bits: test_scan_bits.c. labels: physics */
#include "tests/sensor/scan_stage.h"

#include "render/scattering/paths/radar_path.h"

static double line[sector_azimuths_most]; /* power over azimuth */

static void a_point_has_its_azimuth_and_the_beam_its_width(void **state)
{
    (void)state;
    static const double still[3] = {0, 0, 0};
    const Weather       weather = weather_default();
    const double        azimuth = 1.23 * rad_per_deg;
    SeekerRadar        *radar = open_radar("search_ku", 8, 0.1, false);
    place_sphere(0, azimuth, still);
    const RadarScene scene = scene_of(0, &weather);
    arena_reset(stage.arena);
    const RadarFrame  *frame = measure(radar, &scene, stage.pool);
    const RadarSector *s = frame->scan;
    CHECK(s && s->plan.positions % 2 == 1);
    over_range(line, s->power_w, s->plan.positions, s->columns);
    const int    peak = peak_of(line, s->plan.positions);
    const double found = (vertex_of(line, peak) - s->plan.positions / 2) * s->plan.step_rad;
    const double width = width_of(line, s->plan.positions, peak) * s->plan.step_rad;
    const double want = two_way_width(&frame->preset->antenna);
    const int    column = peak_of(s->power_w + (size_t)peak * (size_t)s->columns, s->columns);
    printf("point at %.4f deg, want %.4f; width %.4f deg, two-way pattern %.4f, product %.4f\n", found / rad_per_deg,
           azimuth / rad_per_deg, width / rad_per_deg, want / rad_per_deg, s->beam_rad / rad_per_deg);
    CHECK_NEAR(found, azimuth, 0.005 * want);
    CHECK_NEAR(width, want, 0.01 * want);
    CHECK_NEAR(s->beam_rad, want, 1e-4 * want);
    CHECK_NEAR((column - s->columns / 2) * frame->map.metre_per_column, -radius_m, 0.5 * frame->map.metre_per_column);
    seeker_radar_destroy(radar);
}

/* Antenna and target move on from position to position: the peak is where the beam's axis and the line of sight to
 * the target meet. */
static void what_moves_is_met_where_it_is_then(void **state)
{
    (void)state;
    const double  v[3] = {-20, -60, 0}, speed = 250, azimuth = 8 * rad_per_deg;
    const Weather weather = weather_default();
    SeekerRadar  *radar = open_radar("search_ku", 24, 0.25, false);
    place_sphere(0, azimuth, v);
    const RadarScene scene = scene_of(speed, &weather);
    arena_reset(stage.arena);
    const RadarFrame  *frame = measure(radar, &scene, stage.pool);
    const RadarSector *s = frame->scan;
    over_range(line, s->power_w, s->plan.positions, s->columns);
    const int    peak = peak_of(line, s->plan.positions);
    const double found = (vertex_of(line, peak) - s->plan.positions / 2) * s->plan.step_rad;
    /* on paper: two-way pattern over range to the fourth, at each position */
    double paper[sector_positions_most] = {0}, range_then_m[sector_positions_most];
    for (int i = 0; i < s->plan.positions; i++) {
        const double from_middle = i - s->plan.positions / 2, t_s = from_middle * s->plan.interval_s;
        const double x = range_m * cos(azimuth) + (v[0] - speed) * t_s, y = range_m * sin(azimuth) - v[1] * t_s;
        const double off = from_middle * s->plan.step_rad - atan2(y, x);
        range_then_m[i] = hypot(x, y) - radius_m;
        paper[i] = pow(aperture_field(&frame->preset->antenna, off) / range_then_m[i], 4);
    }
    const double met = (vertex_of(paper, peak_of(paper, s->plan.positions)) - s->plan.positions / 2) * s->plan.step_rad;
    const int    column = peak_of(s->power_w + (size_t)peak * (size_t)s->columns, s->columns);
    const double after_s = (peak - s->plan.positions / 2) * s->plan.interval_s;
    const double followed_m = frame->reference_m + frame->reference_rate_mps * after_s;
    printf("met at %.4f deg, want %.4f (%.4f at the frame's time)\n", found / rad_per_deg, met / rad_per_deg,
           azimuth / rad_per_deg);
    CHECK(fabs(met - azimuth) > 0.2 * s->beam_rad); /* so that the test tells */
    CHECK_NEAR(found, met, 0.02 * s->beam_rad);
    const double cell_m = frame->map.metre_per_column;
    CHECK_NEAR(followed_m + (column - s->columns / 2) * cell_m, range_then_m[peak], 0.75 * cell_m);
    seeker_radar_destroy(radar);
}

/* The pixel of a sphere has its power whether the receiver follows the rate of 246 m/s or not, though pulses of 200 us
 * displace it by some 40 m then: pictures are looked up where echoes appear. */
static void pixels_are_looked_up_where_echoes_appear(void **state)
{
    (void)state;
    static const double still[3] = {0, 0, 0};
    static const char   head[] =
        "name,waveform,centre_ghz,bandwidth_mhz,samples,pulses,repeat_khz,pulse_us,power_w,loss_db,dish_m,taper,"
        "transmit,noise_figure_db,phase_noise_deg,iq_gain_db,iq_phase_deg,bits,range_window,doppler_window,pfa,"
        "compensated,far_km,mti,source\n";
    const Weather weather = weather_default();
    const double  azimuth = atan(88.0 / 500);
    place_sphere(0, azimuth, still);
    for (int followed = 0; followed < 2; followed++) {
        char         path[text_file_size], text[1024];
        SeekerRadar *radar;
        snprintf(text, sizeof text,
                 "%smine,lfm,16.5,20,512,128,4,200,2000,6,0.6,1,h,3.5,0,0,0,0,hamming,chebyshev:60,"
                 "1e-6,%d,0,2,test\n",
                 head, followed);
        text_file(path, text);
        const SeekerRadarConfig config = {.preset = "mine",
                                          .table = path,
                                          .catalog = stage.catalog_path,
                                          .isa = "avx2",
                                          .scan_rad = 24 * rad_per_deg,
                                          .scan_step = 0.25,
                                          .seed = 3};
        CHECK(seeker_radar_create(&radar, &config) == STATUS_OK);
        remove(path);
        RadarScene scene = scene_of(250, &weather);
        for (int i = 0; i < rows_px * columns_px; i++) stage.range_m[i] = (float)(range_m - radius_m);
        scene.range_m = stage.range_m;
        arena_reset(stage.arena);
        const RadarFrame  *frame = measure(radar, &scene, stage.pool);
        const RadarPreset *preset = frame->preset;
        const double       gain = antenna_gain(&preset->antenna, 0, 0).sum;
        /* the antenna has come nearer by the time that the beam is there */
        const double    after_s = azimuth / frame->scan->plan.step_rad * frame->scan->plan.interval_s;
        const double    then_m = range_m - 250 * cos(azimuth) * after_s;
        const RadarLink link = {preset->power_w, gain * gain, gain * gain, preset->antenna.wavelength_m,
                                then_m,          preset->loss};
        const double    want_w = radar_received_w(&link, frame->target[0].rcs_m2[0]) * pow(10, -0.2 * frame->air_db);
        const size_t    at = rows_px / 2 * columns_px + 288;
        const double    beam_db = 10 * log10((double)frame->scan->view_w[at] / want_w);
        const double    sharp_db = 10 * log10((double)frame->scan->view_sharp_w[at] / want_w);
        printf("rate %s: real beam %.2f dB, sharpened %.2f dB over the radar equation; appears %.1f m off\n",
               followed ? "followed" : "not followed", beam_db, sharp_db, frame->target[0].appears_m - range_m);
        CHECK(followed || frame->target[0].appears_m - range_m < -30);
        /* Hamming's window leaves 1.8 dB at the edge of a cell */
        CHECK(beam_db > -2.2 && beam_db < 0.5 && sharp_db > -2.2 && sharp_db < 0.5);
        seeker_radar_destroy(radar);
    }
}

/* From a still antenna each position sees what a beam sees that stares there: the same ground, to the sector's ends. */
static void a_position_is_a_beam_that_stares_there(void **state)
{
    (void)state;
    const Weather weather = weather_default();
    SeekerRadar  *radar = open_radar("seeker_35", 24, 0.5, true), *stares = open_radar("seeker_35", 0, 0.5, true);
    stage.snapshot.count = 0;
    RadarScene   scene = scene_of(0, &weather);
    const double r[9] = {0, -0.2, sqrt(0.96), -1, 0, 0, 0, -sqrt(0.96), -0.2};
    memcpy(stage.view.r_enu_from_cam, r, sizeof r);
    scene.reference_m = eye_m / 0.2;
    arena_reset(stage.arena);
    const RadarSector *s = measure(radar, &scene, stage.pool)->scan;
    for (int i = 0; i < s->plan.positions; i += s->plan.positions / 2) {
        const double azimuth = (i - s->plan.positions / 2) * s->plan.step_rad, c = cos(azimuth), n = sin(azimuth);
        for (int k = 0; k < 3; k++) {
            stage.view.r_enu_from_cam[3 * k] = c * r[3 * k] - n * r[3 * k + 2];
            stage.view.r_enu_from_cam[3 * k + 2] = c * r[3 * k + 2] + n * r[3 * k];
        }
        const RadarFrame *there = measure(stares, &scene, stage.pool);
        double            apart = 0, all = 0;
        for (int x = 0; x < s->columns; x++) {
            apart += fabs(s->power_w[(size_t)i * (size_t)s->columns + (size_t)x] - there->profile_w[x]);
            all += there->profile_w[x];
        }
        printf("position %d, %.1f deg: %.1e off the beam that stares there\n", i, azimuth / rad_per_deg, apart / all);
        CHECK(apart < 0.01 * all);
    }
    seeker_radar_destroy(radar);
    seeker_radar_destroy(stares);
}

/* What is refused: more positions than there is room for. */
static void too_fine_a_scan_is_refused(void **state)
{
    (void)state;
    RadarPreset preset;
    SectorPlan  plan;
    char        path[4096];
    CHECK(etc_path(path, sizeof path, "radars.csv") && radar_preset_read(&preset, path, "search_ku") == STATUS_OK);
    CHECK(radar_sector_plan(&plan, &preset, 160 * rad_per_deg, 0.05) == STATUS_BAD_VALUE);
    CHECK(radar_sector_plan(&plan, &preset, 160 * rad_per_deg, 0.5) == STATUS_OK && plan.positions % 2 == 1);
    CHECK((plan.positions - 1) * plan.step_rad >= 160 * rad_per_deg);
    CHECK((plan.positions - 3) * plan.step_rad < 160 * rad_per_deg);
    CHECK(radar_sector_plan(&plan, &preset, 0, 0.5) == STATUS_OK && plan.positions == 1);
}

/* What a position leaves out: two-way power of ground beyond the null, over all, for ground lit evenly; and of one
 * target beyond u = 16. By sums over the aperture. */
static void little_is_left_out(void **state)
{
    (void)state;
    for (int taper = 0; taper <= 2; taper++) {
        static const double null_u[] = {3.8317, 5.1356, 6.3802};
        static const double most_beyond[] = {5e-4, 2e-5, 2e-6}, most_far[] = {2e-6, 2e-8, 1e-9};
        const Antenna       a = {.diameter_m = 0.18, .taper = taper, .wavelength_m = 0.0085};
        const double        per_u = a.wavelength_m / (pi_rad * a.diameter_m);
        double              beyond = 0, all = 0, far = 0;
        for (double u = 0.01; u < 40; u += 0.02) {
            const double power = pow(aperture_field(&a, asin(u * per_u)), 4);
            all += power; /* a strip of ground at one range: over azimuth alone */
            if (u > null_u[taper]) beyond += power;
            if (u > 16) far = fmax(far, power);
        }
        printf("taper %d: ground beyond the null %.1f dB, entities beyond u = 16 below %.1f dB\n", taper,
               10 * log10(beyond / all), 10 * log10(far));
        CHECK(beyond / all < most_beyond[taper]);
        CHECK(far < most_far[taper]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_point_has_its_azimuth_and_the_beam_its_width),
        cmocka_unit_test(what_moves_is_met_where_it_is_then),
        cmocka_unit_test(pixels_are_looked_up_where_echoes_appear),
        cmocka_unit_test(a_position_is_a_beam_that_stares_there),
        cmocka_unit_test(too_fine_a_scan_is_refused),
        cmocka_unit_test(little_is_left_out),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
