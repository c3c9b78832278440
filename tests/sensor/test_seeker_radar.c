/* The radar of a seeker over ground: its power against an integral over the ground that the test makes itself, its
 * place in Doppler, and the same bits whatever made them. labels: physics slow */
#include "tests/sensor/seeker_ground.h"

static void ground_has_the_power_of_its_integral(void **state)
{
    (void)state;
    int    cells;
    double far_share;
    CHECK_NEAR(ground_over_integral_db(&cells, &far_share, 3), 0, 0.3);
    CHECK(far_share == 0);
}

/* Ground ahead moves against the antenna at v.d; the reference is followed at the axis' rate: the middle row. */
static void ground_is_where_it_must_be_in_doppler(void **state)
{
    (void)state;
    const double      v[3] = {150, 150, -60};
    const Weather     weather = weather_default();
    SeekerRadar      *radar = open_radar(3);
    RadarScene        scene = scene_of(v, 1, &weather);
    const RadarFrame *frame;
    arena_reset(stage.arena);
    CHECK(seeker_radar_measure(&frame, radar, &scene, stage.pool, stage.arena) == STATUS_OK);
    const double *r = stage.view.r_enu_from_cam;
    CHECK_NEAR(frame->reference_rate_mps, -(v[0] * r[2] + v[1] * r[5] + v[2] * r[8]), 1e-9);
    double power = 0, moment = 0;
    for (int y = 0; y < frame->map.rows; y++)
        for (int x = 0; x < frame->map.columns; x++) {
            const double complex c = frame->map.cell[(size_t)y * (size_t)frame->map.columns + (size_t)x];
            power += creal(c * conj(c));
            moment += creal(c * conj(c)) * (y - frame->map.rows / 2);
        }
    CHECK(fabs(moment / power) < 1);

    /* none of it moves, and the canceller, locked to it, leaves little: its rates differ by some 2 m/s of 86 */
    double profile_w = 0, mti_w = 0;
    for (int x = 0; x < frame->map.columns; x++) profile_w += frame->profile_w[x], mti_w += frame->mti_w[x];
    printf("canceller of the ground: %.1f dB; %d detections\n", 10 * log10(profile_w / mti_w), frame->detections);
    CHECK(frame->detections > 0 && 10 * log10(profile_w / mti_w) > 15);
    for (int i = 0; i < frame->detections; i++) CHECK(!frame->detection[i].moving);
    CHECK_NEAR(frame->timing.interval_s, 64 / 20e3, 1e-12);
    seeker_radar_destroy(radar);
}

/* A receiver that follows the range alone: the ground approaches at some 220 m/s, and the map of 64 rows spans 85.655.
 */
static void a_rate_not_followed_is_on_the_map(void **state)
{
    (void)state;
    static const char text[] =
        "name,waveform,centre_ghz,bandwidth_mhz,samples,pulses,repeat_khz,pulse_us,power_w,loss_db,dish_m,taper,transmit,"
        "noise_figure_db,phase_noise_deg,iq_gain_db,iq_phase_deg,bits,range_window,doppler_window,pfa,compensated,far_km,mti,source\n"
        "mine,lfm,35,500,512,64,20,20,30,5,0.18,1,v,5,0,0,0,0,taylor:5:40,hann,1e-6,0,0,3,test\n";
    const double  v[3] = {150, 150, -60};
    const Weather weather = weather_default();
    char          path[text_file_size];
    text_file(path, text);
    preset = "mine", own_table = path;
    SeekerRadar *radar = open_radar(3);
    preset = "seeker_35", own_table = NULL;
    remove(path);
    const RadarScene  scene = scene_of(v, 1, &weather);
    const RadarFrame *frame;
    arena_reset(stage.arena);
    CHECK(seeker_radar_measure(&frame, radar, &scene, stage.pool, stage.arena) == STATUS_OK);
    const double down = 250.0 / 900, rate = -(150 * sqrt(2) * sqrt(1 - down * down) + 60 * down), span = 85.65499;
    const int    want = 32 + (int)lround((rate - span * nearbyint(rate / span)) / span * 64);
    double       most = 0;
    int          at = -1;
    for (int y = 0; y < 64; y++) {
        double power = 0;
        for (int x = 0; x < 512; x++) {
            const double complex c = frame->map.cell[y * 512 + x];
            power += creal(c * conj(c));
        }
        if (power > most) most = power, at = y;
    }
    CHECK(frame->reference_rate_mps == 0 && abs(at - want) <= 1 && want != 32);
    CHECK_NEAR(frame->ground_rate_mps, rate, 1e-9);
    for (int i = 0; i < frame->detections; i++) CHECK(!frame->detection[i].moving);
    seeker_radar_destroy(radar);
}

static void the_same_bits(void **state)
{
    (void)state;
    const double      v[3] = {200, 100, -60};
    const Weather     weather = weather_default();
    SeekerRadar      *radar = open_radar(3), *other = open_radar(3);
    RadarScene        scene = scene_of(v, 7, &weather);
    const RadarFrame *first, *again, *alone;
    arena_reset(stage.arena);
    CHECK(seeker_radar_measure(&first, radar, &scene, stage.pool, stage.arena) == STATUS_OK);
    scene.number = 8;
    CHECK(seeker_radar_measure(&again, radar, &scene, NULL, stage.arena) == STATUS_OK);
    const size_t octets =
        interval_channels * (size_t)first->map.rows * (size_t)first->map.columns * sizeof *first->map.cell;
    CHECK(memcmp(first->map.cell, again->map.cell, octets) != 0); /* other noise */
    scene.number = 7;
    CHECK(seeker_radar_measure(&again, radar, &scene, NULL, stage.arena) == STATUS_OK);
    CHECK(seeker_radar_measure(&alone, other, &scene, stage.pool, stage.arena) == STATUS_OK);
    CHECK(memcmp(first->map.cell, again->map.cell, octets) == 0 &&
          memcmp(first->map.cell, alone->map.cell, octets) == 0);
    CHECK(first->targets == 0);
    seeker_radar_destroy(radar);
    seeker_radar_destroy(other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ground_has_the_power_of_its_integral),
        cmocka_unit_test(ground_is_where_it_must_be_in_doppler),
        cmocka_unit_test(a_rate_not_followed_is_on_the_map),
        cmocka_unit_test(the_same_bits),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
