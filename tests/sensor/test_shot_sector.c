/* A scan of one point echo far above the noise: the power of the real beam at and between its positions, what Doppler
 * sharpens and where it does not, where the sector ends; by the antenna's pattern and the waveform's figures. labels:
 * physics */
#include "tests/sensor/radar_scene.h"

#include "sensor/radar/seeker_radar_private.h"
#include "sensor/radar/window_private.h"

enum { samples = 64, most_pulses = 128, columns_px = 201 };
static const double far_m = 3000, lambda_m = 0.299792458 / 16.5, point_rad = 10 * rad_per_deg;

static SeekerRadar radar;
static int         pulses = most_pulses;
static double      tilt_rad; /* of the axis, down */
static RadarFrame  frame;
static float       range_px[columns_px];

static int open_stage(void **state)
{
    (void)state;
    scene_folder();
    FILE *file = scene_obj("box", NULL);
    scene_box(file, "box", 1, (const double[3]){-1, -1, -1}, (const double[3]){1, 1, 1});
    CHECK(fclose(file) == 0);
    scene_open((const char *const[]){"box"}, 1);
    return 0;
}

static int close_stage(void **state)
{
    (void)state;
    scene_close();
    return 0;
}

static void close_radar(void)
{
    echo_grid_destroy(radar.echoes);
    interval_plan_destroy(radar.plan);
    free(radar.sector_pulse);
    free(radar.batch);
    free(radar.points.point);
    arena_destroy(radar.position);
}

static void open_radar(double repeat_hz, int rows)
{
    pulses = rows;
    radar = (SeekerRadar){.preset = {.wave = {.kind = WAVEFORM_LFM,
                                              .centre_hz = 16.5e9,
                                              .bandwidth_hz = 20e6,
                                              .pulse_s = 5e-6,
                                              .repeat_hz = repeat_hz,
                                              .samples = samples,
                                              .pulses = pulses},
                                     .range_window = {.kind = WINDOW_HAMMING},
                                     .doppler_window = {.kind = WINDOW_HANN},
                                     .antenna = {.diameter_m = 0.6, .taper = 1, .wavelength_m = 0.299792458 / 16.5},
                                     .receiver = {.noise_figure = 1},
                                     .power_w = 40e6, /* noise: a millionth and less of the echo */
                                     .loss = 2}};
    const RadarPreset *p = &radar.preset;
    CHECK(echo_grid_create(&radar.echoes, &p->wave) == STATUS_OK);
    CHECK(interval_plan_create(&radar.plan, &p->wave, &p->range_window, &p->doppler_window) == STATUS_OK);
    CHECK(radar_sector_plan(&radar.sector, p, 24 * rad_per_deg, 0.5) == STATUS_OK);
    radar.sector_pulse = malloc((size_t)radar.sector.positions * samples * (size_t)pulses * sizeof *radar.sector_pulse);
    radar.batch = malloc(beam_batch * sizeof *radar.batch);
    radar.position = arena_create();
    CHECK(radar.sector_pulse && radar.batch && radar.position);
}

/* From the origin to the east, the point 10 degrees to the right of it, which is south, at 3000 m; pixels look at 3000
 * m all over a row, the one 80 to the right of the middle at an azimuth. */
static const RadarSector *scan(double speed_mps, double azimuth_rad)
{
    const double at[3] = {far_m * cos(point_rad), -far_m * sin(point_rad), 0};
    arena_reset(stage.arena);
    stage.view = (View){.width = columns_px,
                        .height = 1,
                        .focal_px = 80 / tan(azimuth_rad),
                        .r_enu_from_cam = {0, 0, 1, -1, 0, 0, 0, -1, 0}};
    for (int x = 0; x < columns_px; x++) range_px[x] = (float)far_m;
    stage.scene.v_enu_mps[0] = speed_mps, stage.scene.v_enu_mps[1] = stage.scene.v_enu_mps[2] = 0;
    stage.scene.range_m = range_px, stage.scene.entity = NULL;
    const Waveform *wave = &radar.preset.wave;
    const double    rate_mps = -speed_mps * cos(point_rad);
    frame = (RadarFrame){.reference_m = far_m, .reference_rate_mps = -speed_mps};
    RadarShot shot = {.radar = &radar,
                      .scene = &stage.scene,
                      .preset = &radar.preset,
                      .frame = &frame,
                      .arena = stage.arena,
                      .right = {0, -1, 0},
                      .down = {-sin(tilt_rad), 0, -cos(tilt_rad)},
                      .ahead = {cos(tilt_rad), 0, -sin(tilt_rad)},
                      .aim_m = far_m,
                      .reference_m = far_m,
                      .reference_rate_mps = -speed_mps,
                      .window_rate_mps = -speed_mps,
                      .half_window_m = samples * light_mps / (4 * 20e6),
                      .reach = 1,
                      .widest = 1};
    radar.points.count = 0, radar.target_points = 0;
    RadarPoint *q = radar_points_room(&radar.points, 1);
    CHECK(q);
    *q = (RadarPoint){
        .same = 3, .share = 1, .widest = 1, .path_per_pulse_m = 2 * (rate_mps + speed_mps) / wave->repeat_hz};
    memcpy(q->p_enu, at, sizeof at);
    radar.points.count = 1;
    Interval interval = {
        .wave = *wave,
        .sample = arena_alloc(stage.arena, interval_channels * samples * (size_t)pulses, sizeof *interval.sample)};
    RadarShot beam;
    CHECK(interval.sample);
    shot_position(&beam, &shot, 0, 0);
    CHECK(shot_echoes(&beam, false) == STATUS_OK);
    echo_sum(interval.sample, radar.echoes);
    frame.map.cell = arena_alloc(stage.arena, interval_channels * samples * (size_t)pulses, sizeof *frame.map.cell);
    CHECK(frame.map.cell);
    interval_process(&frame.map, radar.plan, &interval, NULL);
    CHECK(shot_sector(&shot, &interval) == STATUS_OK && frame.scan);
    return frame.scan;
}

/* Received on the axis from 4 pi 9 m2 at 3000 m; and the share of it so far off the axis. */
static double on_axis_w(void)
{
    const double g = antenna_gain(&radar.preset.antenna, 0, 0).sum;
    return 9 * lambda_m * lambda_m * 40e6 / 2 / pow(4 * pi_rad * far_m * far_m, 2) * pow(g, 4);
}

static double off_axis(double rad)
{
    return pow(antenna_gain(&radar.preset.antenna, sin(rad), 0).sum / antenna_gain(&radar.preset.antenna, 0, 0).sum, 4);
}

/* At rest all positions see the point in the middle cell, by the pattern's fourth power; between them the cubic through
 * their logarithms is within 0.05 of a beamwidth; half a step beyond the last there is nothing. */
static void the_real_beam(void **state)
{
    (void)state;
    open_radar(4000, most_pulses);
    const SectorPlan  *plan = &radar.sector;
    const double       edge = plan->positions / 2 + 0.525; /* in steps */
    const RadarSector *s = scan(0, edge * plan->step_rad);
    CHECK(s->columns == samples && s->plan.positions > 15 && plan->positions % 2 == 1);
    CHECK(frame.map.metre_per_column == light_mps / (2 * 20e6));
    int checked = 0;
    for (int i = 0; i < plan->positions; i++) {
        const double off = (i - plan->positions / 2) * plan->step_rad - point_rad;
        for (int x = 0; x < samples; x += 8) {
            const double w = s->power_w[i * samples + x] / on_axis_w();
            if (x == samples / 2) CHECK_NEAR(w, off_axis(off), 1e-3);
            else CHECK(w < 1e-3); /* hamming: side lobes below -42 dB */
        }
        checked += fabs(off) < plan->step_rad;
    }
    CHECK(checked == 2);
    for (int x = 0; x < columns_px; x++) {
        const double az = atan((x - columns_px / 2) / stage.view.focal_px), steps = az / plan->step_rad;
        const bool   in = fabs(steps) <= plan->positions / 2 + 0.5;
        CHECK(isnan(s->view_w[x]) == !in && isnan(s->view_sharp_w[x]) == !in);
        if (!in || fabs(az - point_rad) > 1.2 * plan->step_rad) continue;
        CHECK_NEAR((double)s->view_w[x] / on_axis_w(), off_axis(az - point_rad), 0.05);
        CHECK(s->view_sharp_w[x] == s->view_w[x]); /* nothing moves: nothing is sharpened */
    }
    CHECK(isnan(s->view_w[columns_px / 2 + 80]) && !isnan(s->view_w[columns_px / 2 + 79]));
    CHECK(isnan(s->view_w[columns_px / 2 - 80]) && !isnan(s->view_w[columns_px / 2 - 79]));
    CHECK(s->sharpened_share == 0);
    close_radar();
}

/* What a place at 3000 m has of the point, over what the point has on the axis at 3000 m. The position is that whose
 * axis is nearest to the place's azimuth by then. The antenna has moved on, and the window's middle with it: the
 * point's echo is nearer, beside the place's cell in range and in Doppler, and the beam's gain is taken as for the
 * place. */
static double expected(double speed_mps, double azimuth_rad)
{
    const SectorPlan *plan = &radar.sector;
    const double      azimuth[2] = {azimuth_rad, point_rad};
    double            x = 0, r_m[2], rate_mps[2], off_rad[2];
    for (int i = 0; i < 20; i++) {
        const double ahead_m = far_m * cos(azimuth_rad) - speed_mps * x * plan->interval_s;
        x = atan(far_m * sin(azimuth_rad) / ahead_m) / plan->step_rad;
    }
    const double t_s = floor(x + 0.5) * plan->interval_s;
    for (int i = 0; i < 2; i++) {
        const double ahead_m = far_m * cos(azimuth[i]) - speed_mps * t_s, aside_m = far_m * sin(azimuth[i]);
        r_m[i] = hypot(ahead_m, aside_m);
        rate_mps[i] = -speed_mps * ahead_m / r_m[i];
        off_rad[i] = atan(aside_m / ahead_m) - floor(x + 0.5) * plan->step_rad;
    }
    const double middle_m = far_m - speed_mps * t_s, cell_m = light_mps / (2 * 20e6);
    const double cells = (r_m[1] - middle_m) / cell_m - floor((r_m[0] - middle_m) / cell_m + 0.5);
    const double bins = 2 * (rate_mps[1] - rate_mps[0]) / lambda_m * plan->interval_s;
    return pow(far_m / r_m[1], 4) * off_axis(off_rad[1]) / off_axis(off_rad[0]) *
           pow(interval_lobe(radar.plan, false, cells) * interval_lobe(radar.plan, true, bins), 2);
}

/* At the point and half a width of the window in Doppler beside it, lambda repeat / (2 pulses v sin azimuth) a bin.
 * Resolution is that width; the real beam's where it is wider than that, and within a beamwidth of where the rate has
 * its least. */
static void sharpened_by_doppler(void **state)
{
    (void)state;
    WindowFigures figures;
    double        weight[most_pulses];
    open_radar(4000, most_pulses);
    CHECK(window_weights(weight, pulses, &radar.preset.doppler_window) == STATUS_OK);
    CHECK(window_figures(&figures, weight, pulses) == STATUS_OK);
    const double speed = 200, bin = lambda_m * 4000 / (2 * pulses * speed);
    const double width = figures.width_3db * bin / sin(point_rad);
    for (int side = -1; side <= 1; side++) {
        const RadarSector *s = scan(speed, point_rad + side * 0.5 * width);
        const double       w = (double)s->view_sharp_w[columns_px / 2 + 80] / on_axis_w();
        printf("sharpened, %+.1f widths off the point: %.3f of its power\n", 0.5 * side, w);
        CHECK_NEAR(w / expected(speed, point_rad + side * 0.5 * width), 1, 0.015);
        if (side) continue;
        const double beam = antenna_two_way_width_rad(&radar.preset.antenna);
        const double lobe = antenna_width_rad(&radar.preset.antenna);
        int          count = 0, wide = 0;
        CHECK_NEAR(s->beam_rad, beam, 1e-12);
        for (int a = 0; a < s->azimuths; a++) {
            const double az = a * s->azimuth_step_rad - s->plan.positions / 2 * s->plan.step_rad;
            const double here = figures.width_3db * bin / fabs(sin(az)), at = fabs(az);
            const size_t cell = (size_t)a * samples + samples / 2;
            count += s->sharpened[cell];
            if (isnan(s->resolution_m[cell])) continue;
            if (at < lobe * 0.999 || here > beam * 1.001) {
                CHECK(!s->sharpened[cell]);
                CHECK_NEAR((double)s->resolution_m[cell] / (far_m * beam), 1, 1e-5);
                wide++;
            } else if (at > lobe * 1.001 && here < beam * 0.999) {
                CHECK(s->sharpened[cell]);
                CHECK_NEAR((double)s->resolution_m[cell] / (far_m * here), 1, 1e-5);
            }
        }
        CHECK(count > 20 && wide > 3);
        /* three azimuths at least to the finest resolution */
        const double finest = figures.width_3db * bin / sin(s->plan.positions / 2 * s->plan.step_rad);
        CHECK_NEAR(s->azimuth_step_rad * ceil(3 * s->plan.step_rad / finest), s->plan.step_rad, 1e-12);
        CHECK(s->azimuths == (s->plan.positions - 1) * (int)ceil(3 * s->plan.step_rad / finest) + 1);
        double sharp = 0;
        for (size_t i = 0; i < (size_t)s->azimuths * samples; i++) sharp += s->sharpened[i];
        CHECK_NEAR(s->sharpened_share, sharp / (s->azimuths * samples), 1e-12);
    }
    close_radar();
    /* rates over two beamwidths beyond a quarter of a wavelength a pulse fold over: none is sharpened */
    open_radar(4000, 32);
    for (int i = 0; i < 2; i++) {
        const double       lobe = antenna_width_rad(&radar.preset.antenna), slope = 0.25 * lambda_m * 4000 / lobe;
        const RadarSector *s = scan((i ? 1.01 : 0.99) * slope / sin(point_rad), point_rad);
        const size_t       cell =
            (size_t)lround((point_rad + s->plan.positions / 2 * s->plan.step_rad) / s->azimuth_step_rad);
        const double az = (double)cell * s->azimuth_step_rad - s->plan.positions / 2 * s->plan.step_rad;
        CHECK_NEAR(sin(az) / sin(point_rad), 1, 5e-3);
        CHECK(s->sharpened[cell * samples + samples / 2] == (i == 0));
    }
    close_radar();
}

/* Range rate of still ground in a direction that is turned about the antenna's down axis, as the antenna moves. */
static double rate_of(const double to[3], double turn_rad, const double v[3])
{
    const double down[3] = {-sin(tilt_rad), 0, -cos(tilt_rad)}, along = v3_dot(to, down);
    double       across[3], level[3], d[3];
    v3_cross(across, down, to);
    v3_add_scaled(level, to, -along, down);
    v3_scale(d, cos(turn_rad), level);
    v3_add_scaled(d, d, sin(turn_rad), across);
    v3_add_scaled(d, d, along, down);
    return -v3_dot(v, d);
}

/* An axis that looks down by 20 degrees: each cell stands for a place as high as where the axis meets 3000 m, at its
 * azimuth about the antenna's own down axis. Its resolution follows from how the rate changes with that azimuth, found
 * here by differences. */
static void a_tilted_scan(void **state)
{
    (void)state;
    WindowFigures figures;
    double        weight[most_pulses];
    open_radar(4000, most_pulses);
    CHECK(window_weights(weight, pulses, &radar.preset.doppler_window) == STATUS_OK);
    CHECK(window_figures(&figures, weight, pulses) == STATUS_OK);
    tilt_rad = 20 * rad_per_deg;
    const RadarSector *s = scan(180, point_rad);
    const double       v[3] = {180, 0, 0}, ahead[3] = {cos(tilt_rad), 0, -sin(tilt_rad)}, right[3] = {0, -1, 0};
    const double       down[3] = {-sin(tilt_rad), 0, -cos(tilt_rad)};
    const double       lobe = antenna_width_rad(&radar.preset.antenna),
                 beam = antenna_two_way_width_rad(&radar.preset.antenna);
    int sharp = 0, real = 0;
    for (int a = 0; a < s->azimuths; a += 3)
        for (int x = 8; x < samples; x += 16) {
            const double az = a * s->azimuth_step_rad - s->plan.positions / 2 * s->plan.step_rad;
            const double r_m = far_m + (x - samples / 2) * light_mps / (2 * 20e6);
            const size_t cell = (size_t)a * samples + (size_t)x;
            if (isnan(s->resolution_m[cell])) continue;
            /* turned down from the antenna's plane until it is 3000 sin 20 m lower, by halving */
            double to[3], low = -0.5, high = 0.5;
            for (int i = 0; i < 60; i++) {
                const double turn = 0.5 * (low + high);
                for (int k = 0; k < 3; k++)
                    to[k] = cos(turn) * (cos(az) * ahead[k] + sin(az) * right[k]) + sin(turn) * down[k];
                if (to[2] * r_m > -far_m * sin(tilt_rad)) low = turn;
                else high = turn;
            }
            const double h = 1e-5, level = sqrt(1 - pow(v3_dot(to, down), 2));
            double       slope[3];
            for (int k = 0; k < 3; k++)
                slope[k] = (rate_of(to, (k - 1) * lobe + h, v) - rate_of(to, (k - 1) * lobe - h, v)) / (2 * h);
            const double width = figures.width_3db * lambda_m * 4000 / (2 * pulses * fabs(slope[1]));
            const bool clear = slope[0] * slope[1] > 0 && slope[1] * slope[2] > 0, near = fabs(width / beam - 1) < 1e-3;
            if (near || fabs(slope[0]) < 0.05 || fabs(slope[2]) < 0.05) continue;
            CHECK(s->sharpened[cell] == (clear && width < beam));
            *(s->sharpened[cell] ? &sharp : &real) += 1;
            CHECK_NEAR((double)s->resolution_m[cell] / (r_m * level * (s->sharpened[cell] ? width : beam)), 1, 1e-4);
        }
    printf("tilted: %d cells sharpened, %d not\n", sharp, real);
    CHECK(sharp > 20 && real > 3);
    tilt_rad = 0;
    close_radar();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_real_beam),
        cmocka_unit_test(sharpened_by_doppler),
        cmocka_unit_test(a_tilted_scan),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
