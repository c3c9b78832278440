/* The way from a radar's antenna to a place: directions, the range window and its folds, sectors, range rates, and the
 * radar equation, against geometry and formulas by hand. labels: physics */
#include "tests/check.h"

#include "sensor/radar/seeker_radar_private.h"

static const double c_mps = 299792458.0;

/* 10 GHz, 100 MHz: a window of 191.9 m; folds 7494.8 m. */
static RadarPreset preset = {.wave = {.kind = WAVEFORM_LFM,
                                      .centre_hz = 10e9,
                                      .bandwidth_hz = 1e8,
                                      .pulse_s = 20e-6,
                                      .repeat_hz = 2e4,
                                      .samples = 128,
                                      .pulses = 64},
                             .antenna = {.diameter_m = 0.3, .taper = 1, .wavelength_m = 0.0299792458},
                             .power_w = 40,
                             .loss = 2};
static SeekerRadar radar;
static View        view = {.p_enu = {100, 200, 50}};
static RadarScene  scene = {.view = &view, .v_enu_mps = {30, -10, 5}};
static RadarFrame  frame = {.reference_m = 3000};

static RadarShot shot_by_hand(void)
{
    return (RadarShot){.radar = &radar,
                       .scene = &scene,
                       .preset = &preset,
                       .frame = &frame,
                       .p_enu = {100, 200, 50},
                       .right = {0.8, -0.6, 0},
                       .down = {0, 0, -1},
                       .ahead = {0.6, 0.8, 0},
                       .reference_m = 3000,
                       .half_window_m = 90,
                       .reach = 1};
}

/* A place so far away, right of the axis by az and down by el. */
static void place(double p[3], const RadarShot *shot, double range_m, double az_deg, double el_deg)
{
    const double az = az_deg * rad_per_deg, el = el_deg * rad_per_deg;
    for (int k = 0; k < 3; k++)
        p[k] = shot->p_enu[k] +
               range_m * (cos(el) * (cos(az) * shot->ahead[k] + sin(az) * shot->right[k]) + sin(el) * shot->down[k]);
}

static Sight sight_of(const RadarShot *shot, double range_m, double az_deg, double el_deg, double more_m)
{
    Sight  s;
    double p[3];
    place(p, shot, range_m, az_deg, el_deg);
    shot_sight(&s, shot, p, more_m);
    return s;
}

static void directions_and_windows(void **state)
{
    (void)state;
    RadarShot   shot = shot_by_hand();
    const Sight s = sight_of(&shot, 2950, 11, 7, 0);
    CHECK_NEAR(s.range_m, 2950, 1e-9);
    CHECK_NEAR(s.cos_right, cos(7 * rad_per_deg) * sin(11 * rad_per_deg), 1e-12);
    CHECK_NEAR(s.cos_down, sin(7 * rad_per_deg), 1e-12);
    CHECK_NEAR(v3_length(s.d_enu), 1, 1e-12);
    CHECK(s.within);
    static const struct {
        double range_m, more_m, sweep_m, far_m, az_deg;
        bool   within;
    } of[] = {{3089.9, 0, 0, 0, 0, true},
              {3090.1, 0, 0, 0, 0, false},
              {2910.1, 0, 0, 0, 0, true},
              {2909.9, 0, 0, 0, 0, false},
              {3099.9, 10, 0, 0, 0, true},
              {3100.1, 10, 0, 0, 0, false},
              {3104.9, 10, 5, 0, 0, true},
              {3105.1, 10, 5, 0, 0, false},
              {3000, 0, 0, 0, 89.9, true},
              {3000, 0, 0, 0, 90.1, false},
              {3000 + 7494.8, 0, 0, 0, 0, false},
              {3000 + 7494.8, 0, 0, 2e4, 0, true},
              {3000 + 7584, 0, 0, 2e4, 0, true},
              {3000 + 7586, 0, 0, 2e4, 0, false},
              {3000 + 7405.6, 0, 0, 2e4, 0, true},
              {3000 + 7403, 0, 0, 2e4, 0, false},
              {3000 + 7494.8, 0, 0, 10490, 0, false},
              {3000 + 7494.8, 10, 0, 10490, 0, true},
              {3000 + 2 * 7494.8, 0, 0, 2e4, 0, true}};
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        shot.sweep_m = of[i].sweep_m, preset.far_m = of[i].far_m;
        if (sight_of(&shot, of[i].range_m, of[i].az_deg, 0, of[i].more_m).within != of[i].within)
            fail_msg("%g m, %g degrees, case %d", of[i].range_m, of[i].az_deg, (int)i);
    }
    preset.far_m = 0;
}

/* Off a staring axis: the sine of the angle. Off a sector: of the angle to its nearest axis. */
static void angles_off_an_axis_and_a_sector(void **state)
{
    (void)state;
    RadarShot shot = shot_by_hand();
    Sight     s = sight_of(&shot, 3000, 11, 7, 0);
    CHECK_NEAR(shot_off_axis(&shot, &s), sin(acos(cos(11 * rad_per_deg) * cos(7 * rad_per_deg))), 1e-12);
    shot.sector_half_rad = 10 * rad_per_deg;
    static const double of[][3] = {{7, 3, 0}, {13, 0, 3}, {-15, 0, 5}, {13, 4, 3}, {-10, -2, 0}}; /* az, el, beyond */
    for (int i = 0; i < 5; i++) {
        const double el = of[i][1] * rad_per_deg, beyond = of[i][2] * rad_per_deg;
        s = sight_of(&shot, 3000, of[i][0], of[i][1], 0);
        CHECK_NEAR(shot_off_axis(&shot, &s), sin(acos(cos(beyond) * cos(el))), 1e-12);
    }
}

/* Range rates along the line of sight; an echo is displaced by f T / B of what the receiver does not follow, and folds
 * over at the window's ends. */
static void rates_displace(void **state)
{
    (void)state;
    RadarShot    shot = shot_by_hand();
    const double v[3] = {40, 60, -7}, coupling_s = 10e9 * 20e-6 / 1e8, window_m = c_mps * 128 / 2e8;
    Sight        s = sight_of(&shot, 3020, 0, 0, 0);
    CHECK_NEAR(shot_range_rate(&shot, &s, v), (40 - 30) * 0.6 + (60 + 10) * 0.8, 1e-9);
    shot.reference_rate_mps = 1000;
    CHECK_NEAR(shot_appears_m(&shot, &s, 4000), 3020 + coupling_s * 3000, 1e-9);
    preset.wave.uncompensated = true;
    CHECK_NEAR(shot_appears_m(&shot, &s, 4000), 3020 + coupling_s * 4000, 1e-9);
    preset.wave.uncompensated = false;
    s = sight_of(&shot, 3090, 0, 0, 0);
    CHECK_NEAR(shot_appears_m(&shot, &s, 11000), 3090 + coupling_s * 10000 - window_m, 1e-9);
}

/* P G^2 l^2 sigma / ((4 pi)^3 R^4 L) times the air's loss there and back; G: the pattern's power in that direction.
 * The difference channels have the ratio of the patterns; the fourth what returns in the other polarisation. */
static void echoes_obey_the_radar_equation(void **state)
{
    (void)state;
    RadarShot         shot = shot_by_hand();
    const Sight       s = sight_of(&shot, 3000, 0.8, -1.1, 0);
    const double      l = 0.0299792458, r = 3000;
    const AntennaGain g = antenna_gain(&preset.antenna, s.cos_right, s.cos_down);
    ScatterMatrix     m = {.hh = 2 + I, .vv = -I, .hv = 0.5, .vh = 0.25 * I};
    double complex    a[interval_channels];
    shot.air_np_m = 4e-5;
    for (int h = 0; h < 2; h++) {
        const double complex own = h ? m.hh : m.vv, other = h ? m.vh : m.hv;
        preset.transmits_h = h;
        shot_amplitudes(a, &shot, &s, &m);
        const double sigma = 4 * pi_rad * (creal(own) * creal(own) + cimag(own) * cimag(own));
        const double want_w =
            40 * pow(g.sum, 4) * l * l * sigma / (pow(4 * pi_rad, 3) * pow(r, 4) * 2) * exp(-2 * 4e-5 * r);
        CHECK_NEAR(pow(cabs(a[CHANNEL_SUM]), 2) / want_w, 1, 1e-12);
        CHECK_NEAR(carg(a[CHANNEL_SUM] / own), 0, 1e-12);
        CHECK(cabs(a[CHANNEL_RIGHT] / a[CHANNEL_SUM] - g.right / g.sum) < 1e-12);
        CHECK(cabs(a[CHANNEL_DOWN] / a[CHANNEL_SUM] - g.down / g.sum) < 1e-12);
        CHECK(cabs(a[CHANNEL_CROSS] / a[CHANNEL_SUM] - other / own) < 1e-12);
        /* FMCW: less by what of the sweep is over when the echo arrives */
        const double whole = cabs(a[CHANNEL_SUM]);
        preset.wave.kind = WAVEFORM_FMCW;
        shot_amplitudes(a, &shot, &s, &m);
        CHECK_NEAR(cabs(a[CHANNEL_SUM]) / whole, fmax(1 - 2 * r / c_mps / 20e-6, 0), 1e-12);
        preset.wave.kind = WAVEFORM_LFM;
    }
    preset.transmits_h = false;
}

/* The first zero of J_(taper + 1)(pi d / lambda sine), to the five figures that it is known to; 1 for an antenna that
 * has none. */
static void nulls_are_zeros_of_bessel_functions(void **state)
{
    (void)state;
    const RadarShot shot = shot_by_hand();
    for (int taper = 0; taper < 3; taper++) {
        double low = 2, high = 3.9 + 1.25 * taper;
        for (int i = 0; i < 60; i++) {
            const double middle = 0.5 * (low + high);
            if (jn(taper + 1, middle) > 0) low = middle;
            else high = middle;
        }
        preset.antenna.taper = taper;
        CHECK_NEAR(shot_null(&shot) * pi_rad * 0.3 / 0.0299792458 / low, 1, 2e-5);
    }
    preset.antenna.diameter_m = 0.01;
    CHECK(shot_null(&shot) == 1);
    preset.antenna.diameter_m = 0.3, preset.antenna.taper = 1;
}

static void positions_turn_to_the_right(void **state)
{
    (void)state;
    RadarShot shot = shot_by_hand(), turned;
    double    p[3], d[3];
    shot.sector_half_rad = 0.5, shot.sweep_m = 9, shot.window_rate_mps = -70;
    shot_position(&turned, &shot, 20 * rad_per_deg, 0.25);
    place(p, &shot, 1, 20, 0);
    v3_sub(d, p, shot.p_enu);
    CHECK_NEAR(v3_dot(turned.ahead, d), 1, 1e-12);
    CHECK_NEAR(v3_dot(turned.ahead, turned.right), 0, 1e-12);
    CHECK_NEAR(v3_dot(turned.right, shot.ahead), -sin(20 * rad_per_deg), 1e-12);
    for (int k = 0; k < 3; k++) CHECK_NEAR(turned.p_enu[k], shot.p_enu[k] + 0.25 * scene.v_enu_mps[k], 1e-12);
    CHECK_NEAR(turned.reference_m, 3000 - 17.5, 1e-12);
    CHECK_NEAR(turned.near_m, 2982.5 - 90, 1e-12);
    CHECK_NEAR(turned.far_m, 2982.5 + 90, 1e-12);
    CHECK(turned.sector_half_rad == 0 && turned.sweep_m == 0 && turned.after_s == 0.25);
    preset.far_m = 15e3;
    shot_position(&turned, &shot, 0, 0);
    CHECK(turned.near_m == 0 && turned.far_m == 15e3);
    preset.far_m = 0;
}

/* Whatever level ground the main lobe lights within the window lies in the rectangle: looks down, sectors, heights. */
static void the_lit_ground_is_in_its_rectangle(void **state)
{
    (void)state;
    for (int i = 0; i < 600; i++) {
        RadarShot    shot = shot_by_hand();
        const double turn = 2 * pi_rad * random_uniform(1, 0, 0, (uint64_t)i), tilt = 0.02 + 0.05 * (i % 20);
        const double half[] = {0, 0.2, 0.6}, r = 500 + 4000 * random_uniform(1, 1, 0, (uint64_t)i);
        double       low[2], high[2];
        shot.ahead[0] = cos(tilt) * cos(turn), shot.ahead[1] = cos(tilt) * sin(turn), shot.ahead[2] = -sin(tilt);
        shot.right[0] = sin(turn), shot.right[1] = -cos(turn), shot.right[2] = 0;
        v3_cross(shot.down, shot.ahead, shot.right);
        CHECK(shot.down[2] < 0);
        frame.reference_m = shot.reference_m = r;
        shot.sector_half_rad = half[i % 3];
        shot.near_m = r - 90, shot.far_m = r + 90;
        shot.base_m = 50 - r * sin(tilt);
        shot_lit_rectangle(low, high, &shot);
        for (int k = 0; k < 60; k++) {
            const double out = asin(shot_null(&shot)) / rad_per_deg;
            const double az =
                shot.sector_half_rad / rad_per_deg * (2 * random_uniform(2, (uint32_t)i, 0, (uint64_t)k) - 1);
            const double about = 2 * pi_rad * k / 60;
            RadarShot    beam;
            double       p[3], d[3];
            shot_position(&beam, &shot, az * rad_per_deg, 0);
            place(p, &beam, 1, out * cos(about), out * sin(about));
            v3_sub(d, p, beam.p_enu);
            const double range_m = (50 - shot.base_m) / -d[2];
            if (!(d[2] < 0 && range_m > shot.near_m && range_m < shot.far_m)) continue;
            for (int a = 0; a < 2; a++) {
                const double at = beam.p_enu[a] + range_m * d[a];
                CHECK(at >= low[a] && at <= high[a]);
            }
        }
    }
    frame.reference_m = 3000;
}

/* Looking north-east, 0.3 rad down, over a sector of 0.2 rad to either side, from 900 m above the ground, 2600 .. 3200
 * m away: at most sqrt(3200^2 - 900^2) m on level ground and 50 m and 2 % of the reference range more, at least
 * sqrt(2600^2 - 900^2) less that; to either side the pattern's first null over the level part of the axis less the
 * null, and the sector's half seen from above. */
static void the_rectangle_by_hand(void **state)
{
    (void)state;
    RadarShot    shot = shot_by_hand();
    const double tilt = 0.3, azimuth = 0.25 * pi_rad, null_rad = asin(0.9 * shot_null(&shot));
    const double wide = null_rad / (cos(tilt) - null_rad) + atan(tan(0.2) / cos(tilt)), more_m = 50 + 0.02 * 2900;
    const double far_m = sqrt(3200.0 * 3200 - 900 * 900) + more_m, near_m = sqrt(2600.0 * 2600 - 900 * 900) - more_m;
    double       low[2], high[2];
    shot.ahead[0] = shot.ahead[1] = cos(tilt) * sqrt(0.5), shot.ahead[2] = -sin(tilt);
    shot.reach = 0.9, shot.sector_half_rad = 0.2, shot.base_m = 50 - 900, shot.near_m = 2600, shot.far_m = 3200;
    frame.reference_m = 2900;
    shot_lit_rectangle(low, high, &shot);
    frame.reference_m = 3000;
    /* the least at the sides of the near end, the most at a side of the far end; nine directions have both and more */
    for (int k = 0; k < 2; k++) {
        double most = 0;
        for (int i = -4; i <= 4; i++) most = fmax(most, cos(azimuth + wide * i / 4));
        CHECK_NEAR(low[k], view.p_enu[k] + near_m * cos(azimuth + wide), 1e-6);
        CHECK_NEAR(high[k], view.p_enu[k] + far_m * most, 1e-6);
    }
    /* nearly straight down, level 0.04: as if it were 0.05, and that less the null 0.05 as well */
    const double steep = acos(0.04), sides = asin(0.5 * shot_null(&shot)) / 0.05 + atan(tan(0.01) / 0.05);
    shot.ahead[0] = shot.ahead[1] = 0.04 * sqrt(0.5), shot.ahead[2] = -sin(steep), shot.sector_half_rad = 0.01,
    shot.reach = 0.5;
    frame.reference_m = 2900;
    shot_lit_rectangle(low, high, &shot);
    frame.reference_m = 3000;
    CHECK(sides < pi_rad);
    for (int k = 0; k < 2; k++) {
        double least = 1;
        for (int i = -4; i <= 4; i++) least = fmin(least, cos(azimuth + sides * i / 4));
        CHECK_NEAR(low[k], view.p_enu[k] + (least < 0 ? far_m : near_m) * least, 1e-6);
    }
}

/* Positions: the middle one and as many to either side as reach the sector's end. */
static void sectors_are_planned(void **state)
{
    (void)state;
    SectorPlan   plan;
    const double width = antenna_width_rad(&preset.antenna);
    static const struct {
        double steps, share;
        int    positions;
    } of[] = {{10, 0.5, 11},
              {10.1, 0.5, 13},
              {9.9, 0.5, 11},
              {0.3, 0.8, 3},
              {1000, 0.01, 1001},
              /* a step that rounding alone makes is none; one of a ten-millionth of the sector is */
              {10 + 1e-10, 0.5, 11},
              {10 + 2e-7, 0.5, 13}};
    for (int i = 0; i < 7; i++) {
        CHECK(radar_sector_plan(&plan, &preset, of[i].steps * of[i].share * width, of[i].share) == STATUS_OK);
        CHECK(plan.positions == of[i].positions);
        CHECK_NEAR(plan.step_rad, of[i].share * width, 1e-12);
        CHECK_NEAR(plan.interval_s, 64 / 2e4, 1e-15);
    }
    CHECK(radar_sector_plan(&plan, &preset, 1000.1 * 0.01 * width, 0.01) == STATUS_BAD_VALUE);
    CHECK(radar_sector_plan(&plan, &preset, 0, 0.5) == STATUS_OK && plan.positions == 1);
    /* 2^27 samples in all are as many as there may be: of 1 position 2^20 pulses of 128, of 3 too many */
    preset.wave.pulses = 1 << 27 >> 7;
    CHECK(radar_sector_plan(&plan, &preset, 0.3 * width, 0.8) == STATUS_BAD_VALUE);
    preset.wave.pulses = 349525; /* 3 x 349525 x 128 = 2^27 - 128 */
    CHECK(radar_sector_plan(&plan, &preset, 0.3 * width, 0.8) == STATUS_OK && plan.positions == 3);
    preset.wave.pulses++;
    CHECK(radar_sector_plan(&plan, &preset, 0.3 * width, 0.8) == STATUS_BAD_VALUE);
    preset.wave.pulses = 64;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(directions_and_windows),
        cmocka_unit_test(angles_off_an_axis_and_a_sector),
        cmocka_unit_test(rates_displace),
        cmocka_unit_test(echoes_obey_the_radar_equation),
        cmocka_unit_test(nulls_are_zeros_of_bessel_functions),
        cmocka_unit_test(positions_turn_to_the_right),
        cmocka_unit_test(the_lit_ground_is_in_its_rectangle),
        cmocka_unit_test(the_rectangle_by_hand),
        cmocka_unit_test(sectors_are_planned),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
