/* The radar's volumes through the whole chain: rain, chaff and a corner reflector against integrals and closed
 * forms that the test makes itself; statistics, Doppler, polarisation. labels: physics */
#include "tests/sensor/radar_volume.h"

static void rain_has_the_power_of_its_integral(void **state)
{
    (void)state;
    enum { seeds = 4, every = 2 };
    static double sample[seeds * 512 / every];
    Weather       weather = weather_default();
    double        got_w = 0, want_w = 0, eta = NAN, mean = NAN, variance = NAN;
    double        row = 0, row2 = 0, power = 0, cross = 0, phase = 0;
    int           samples = 0;
    weather.rain_mm_h = 10;
    weather.wind_mps = 8;
    weather.wind_from_rad = 225 * rad_per_deg; /* from behind */
    const double      elevation = 30 * rad_per_deg;
    const RadarFrame *frame = NULL;
    for (uint64_t seed = 1; seed <= seeds; seed++) {
        SeekerRadar *radar = open_radar(seed, false);
        RadarScene   scene = look(elevation, 100, (uint32_t)seed, &weather);
        arena_reset(stage.arena);
        frame = measure(radar, &scene);
        got_w += power_w(frame);
        /* over the sphere about the axis; along the range it goes by 1 / R^2 and the air */
        if (seed == 1) eta = rain_by_hand(&mean, &variance, 35, atmosphere_temp_k(stage.world.atmosphere, 0), 10);
        CHECK_NEAR(frame->rain_1_m / eta, 1, 2e-3);
        const WindowFigures figures = range_figures(frame);
        const double        window_m = 0.5 * 512 * frame->map.metre_per_column,
                     wavelength_m = frame->preset->antenna.wavelength_m;
        double pattern = 0, along = 0;
        for (double a = 1e-4; a < 0.5; a += 2e-4)
            pattern += 2 * pi_rad * sin(a) * 2e-4 * pow(antenna_gain(&frame->preset->antenna, sin(a), 0).sum, 4);
        for (double r = reference_m - window_m + 0.5; r < reference_m + window_m; r++)
            along += pow(10, -0.2 * frame->air_db * r / reference_m) / (r * r);
        want_w += frame->preset->power_w * wavelength_m * wavelength_m / pow(4 * pi_rad, 3) / frame->preset->loss *
                  eta * pattern * along;
        /* intensities of one pulse, over their means */
        for (int i = 0; i < 512; i += every) {
            const double r = reference_m + (i - 256) * frame->map.metre_per_column;
            const double mean_w = frame->preset->power_w * wavelength_m * wavelength_m / pow(4 * pi_rad, 3) /
                                  frame->preset->loss * eta * pattern *
                                  pow(10, -0.2 * frame->air_db * r / reference_m) / (r * r) *
                                  frame->map.metre_per_column * figures.noise_bins;
            const double         noise_w = frame->receiver.noise_w * figures.noise_bins / 512;
            const double complex z = frame->profile[i];
            sample[samples++] = creal(z * conj(z)) / (mean_w + noise_w);
        }
        const size_t cells = (size_t)frame->map.rows * (size_t)frame->map.columns;
        double       floor_w = frame->receiver.noise_w * frame->map.noise_share;
        for (size_t c = 0; c < cells; c++) {
            const double complex z = frame->map.cell[c], x = frame->map.cell[CHANNEL_CROSS * cells + c];
            const double         w = creal(z * conj(z)) - floor_w,
                         at = (double)(c / (size_t)frame->map.columns) - frame->map.rows / 2;
            power += w, row += w * at, row2 += w * at * at;
            cross += creal(x * conj(x)) - floor_w;
        }
        phase = pow(frame->preset->receiver.phase_noise_rad, 2) * frame->map.rows * frame->map.rows / 12;
        seeker_radar_destroy(radar);
    }
    printf("rain: %.3f dB over its integral, cross-polarised %.1f dB\n", db(got_w / want_w), db(cross / power));
    CHECK_NEAR(db(got_w / want_w), 0, 0.3);
    CHECK_NEAR(db(cross / power), -25, 0.6);
    /* the wind carries it away, falling drops come nearer: both by the cosine to the axis */
    const double rate = row / power * frame->map.mps_per_row, want = 8 * cos(elevation) - mean * sin(elevation);
    /* Hann's window spreads by 1/3 of a row squared, the oscillator's phase noise its small share over all rows */
    const double width2 = (row2 / power - row * row / power / power - 1.0 / 3 - phase) * pow(frame->map.mps_per_row, 2);
    const double want2 = 1 + variance * sin(elevation) * sin(elevation);
    printf("Doppler of rain: %.2f m/s (%.2f), rms width %.2f m/s (%.2f)\n", rate, want, sqrt(width2), sqrt(want2));
    CHECK_NEAR(rate, want, 0.15);
    CHECK_NEAR(sqrt(width2), sqrt(want2), 0.15);
    qsort(sample, (size_t)samples, sizeof *sample, by_value);
    double worst = 0;
    for (int i = 0; i < samples; i++) {
        const double below = -expm1(-sample[i]);
        worst = fmax(worst, fmax(fabs(below - (double)i / samples), fabs(below - (i + 1.0) / samples)));
    }
    printf("rain's intensities against exponential: D sqrt(n) %.2f\n", worst * sqrt(samples));
    CHECK(worst * sqrt(samples) < 1.63); /* Kolmogorov and Smirnov: 1 % */
}

static void rain_and_fog_take_what_itu_says(void **state)
{
    (void)state;
    Weather      weather = weather_default();
    SeekerRadar *radar = open_radar(1, false);
    RadarScene   scene = look(0, 100, 1, &weather);
    arena_reset(stage.arena);
    const double clear_db = measure(radar, &scene)->air_db;
    weather.rain_mm_h = 25;
    const double rain_db = measure(radar, &scene)->air_db - clear_db;
    CHECK_NEAR(rain_db, 0.9 * rain_attenuation(35, 25, 0, 0.5 * pi_rad), 1e-6);
    weather.rain_mm_h = 0;
    weather.visibility_m = 200;
    const double fog_db = measure(radar, &scene)->air_db - clear_db;
    CHECK_NEAR(fog_db /
                   (0.9 * fog_liquid_g_m3(200) * cloud_attenuation(35, atmosphere_temp_k(stage.world.atmosphere, 100))),
               1, 0.01);
    scene = look(0, 290, 1, &weather); /* near its top, 300 m over the ground */
    const double high_db = measure(radar, &scene)->air_db;
    weather.visibility_m = weather_default().visibility_m;
    CHECK_NEAR((high_db - measure(radar, &scene)->air_db) / fog_db, 1, 0.03); /* droplets are 1 K colder */
    weather.visibility_m = 200;
    scene = look(0, 320, 1, &weather); /* above the fog */
    CHECK(fabs(measure(radar, &scene)->air_db - clear_db) < 0.01);
    seeker_radar_destroy(radar);
}

/* A look down: what is behind the ground does not return. */
static void rain_behind_the_ground_is_hidden(void **state)
{
    (void)state;
    Weather      weather = weather_default();
    SeekerRadar *radar = open_radar(1, false);
    weather.rain_mm_h = 10;
    RadarScene scene = look(-60 * rad_per_deg, reference_m * sin(60 * rad_per_deg), 1, &weather);
    arena_reset(stage.arena);
    const RadarFrame *frame = measure(radar, &scene);
    const double      noise_w = frame->receiver.noise_w * range_figures(frame).noise_bins / 512;
    double            near = 0, far = 0;
    for (int i = 0; i < 80; i++) near += frame->profile_w[60 + i] - noise_w, far += frame->profile_w[400 + i] - noise_w;
    printf("rain behind the ground: %.1f dB of that before it\n", db(fabs(far) / near));
    CHECK(db(fabs(far) / near) < -20); /* the far edge of the main lobe, 43 m behind, sees some */
    seeker_radar_destroy(radar);
}

/* Powers of the map's sum and cross-polarised channels, noise taken off, and the first moments of the first. */
typedef struct Moments {
    double power, cross, rate_mps, range_m;
} Moments;

static void add_moments(Moments *to, const RadarFrame *frame)
{
    const size_t cells = (size_t)frame->map.rows * (size_t)frame->map.columns;
    const double floor_w = frame->receiver.noise_w * frame->map.noise_share;
    for (size_t c = 0; c < cells; c++) {
        const double complex z = frame->map.cell[c], x = frame->map.cell[CHANNEL_CROSS * cells + c];
        const double         w = creal(z * conj(z)) - floor_w;
        to->power += w, to->cross += creal(x * conj(x)) - floor_w;
        to->rate_mps += w * ((double)(c / (size_t)frame->map.columns) - frame->map.rows / 2) * frame->map.mps_per_row;
        to->range_m +=
            w * ((double)(c % (size_t)frame->map.columns) - frame->map.columns / 2) * frame->map.metre_per_column;
    }
}

/* Mean rates of chaff: its air is turbulent by 0.5 m/s. Echoes of a cell interfere, so that each is one of power 0 and
 * more: 8 looks at 16 steps of range or more are 128 of them, and their mean is known to 0.5 / sqrt(128) = 0.044 m/s.
 */
static const double chaff_rate_known_mps = 2 * 0.044;

static void chaff_has_its_cross_section(void **state)
{
    (void)state;
    enum { looks = 12 };
    const Weather weather = weather_default();
    const double  v[3] = {12 * sqrt(0.5), 12 * sqrt(0.5), 0};
    SnapshotChaff chaff;
    Moments       got = {0};
    double        power = 0, want_w = 0, l = 0;
    Snapshot      snapshot = {.chaff_count = 1, .chaff = &chaff};
    SeekerRadar  *radar = open_radar(1, false);
    for (uint32_t number = 1; number <= looks; number++) {
        RadarScene scene = look(0, 400, number, &weather);
        scene.snapshot = &snapshot;
        put_chaff(&chaff, reference_m, 2, v);
        arena_reset(stage.arena);
        const RadarFrame *frame = measure(radar, &scene);
        CHECK(frame->clouds == 1);
        /* 0.1515 lambda^2 a dipole, over the cloud's Gaussian across the beam; so thin that it takes 0.3 % of itself */
        const double radius = 1 + 7 * (1 - exp(-2.)) + 0.6;
        double       mean = 0;
        l = frame->preset->antenna.wavelength_m;
        for (double s = 0.01; s < 6 * radius; s += 0.02)
            mean += s * 0.02 / (radius * radius) * exp(-0.5 * s * s / radius / radius) *
                    pow(antenna_gain(&frame->preset->antenna, s / reference_m, 0).sum, 4);
        want_w += radar_received_w(&(RadarLink){frame->preset->power_w, 1, 1, l, reference_m, frame->preset->loss}, 1) *
                  mean * pow(10, -0.2 * frame->air_db) * 0.1515 * l * l * 1e6;
        power += power_w(frame);
        add_moments(&got, frame);
    }
    printf("chaff of %.1f m2: %.3f dB of its mean cross section; cross-polarised %.2f dB, %.2f m/s\n",
           1e6 * 0.1515 * l * l, db(power / want_w), db(got.cross / got.power), got.rate_mps / got.power);
    CHECK_NEAR(db(power / want_w), 0, 0.3);
    CHECK_NEAR(got.cross / got.power, 1.0 / 3, 0.03);
    CHECK_NEAR(got.rate_mps / got.power, 12, chaff_rate_known_mps);
    seeker_radar_destroy(radar);
}

/* Reported at rest ten seconds ago, 30 m before the reference, in wind of 3 m/s from behind. */
static void chaff_at_rest_is_left_to_the_wind(void **state)
{
    (void)state;
    Weather       weather = weather_default();
    SnapshotChaff chaff;
    Moments       got = {0};
    Snapshot      snapshot = {.chaff_count = 1, .chaff = &chaff};
    SeekerRadar  *radar = open_radar(1, false);
    weather.wind_from_rad = 225 * rad_per_deg;
    for (uint32_t number = 1; number <= 8; number++) {
        RadarScene scene = look(0, 400, number, &weather);
        scene.snapshot = &snapshot;
        put_chaff(&chaff, reference_m - 30, 10, (const double[3]){0, 0, 0});
        arena_reset(stage.arena);
        add_moments(&got, measure(radar, &scene));
    }
    printf("chaff in the wind: %.2f m/s, %.1f m from where it should be\n", got.rate_mps / got.power,
           got.range_m / got.power);
    CHECK_NEAR(got.rate_mps / got.power, 3, chaff_rate_known_mps);
    CHECK_NEAR(got.range_m / got.power, 0, 1.5);
    seeker_radar_destroy(radar);
}

/* Still air, seen from below at 80 degrees: ten seconds ago it was 3 m higher, and falls at 0.3 m/s. */
static void chaff_falls(void **state)
{
    (void)state;
    Weather       weather = weather_default();
    SnapshotChaff chaff;
    Moments       got = {0};
    Snapshot      snapshot = {.chaff_count = 1, .chaff = &chaff};
    SeekerRadar  *radar = open_radar(1, false);
    weather.wind_mps = 0;
    for (uint32_t number = 1; number <= 8; number++) {
        RadarScene scene = look(80 * rad_per_deg, 400, number, &weather);
        scene.snapshot = &snapshot;
        put_chaff(&chaff, reference_m + 3, 10, (const double[3]){0, 0, 0});
        arena_reset(stage.arena);
        add_moments(&got, measure(radar, &scene));
    }
    printf("chaff that falls: %.2f m/s, %.1f m from where it should be\n", got.rate_mps / got.power,
           got.range_m / got.power);
    CHECK_NEAR(got.rate_mps / got.power, -0.3 * sin(80 * rad_per_deg), chaff_rate_known_mps);
    CHECK_NEAR(got.range_m / got.power, 0, 1.5);
    seeker_radar_destroy(radar);
}

/* ---- a corner reflector ----------------------------------------------------------------------------- */

typedef struct Corner {
    SnapshotEntity entity;
    SnapshotJoints joints;
    Snapshot       snapshot;
} Corner;

/* Its middle on the boresight at the reference, heading north: the antenna, in the south-west and 35.3 degrees up, is
 * on the axis of an octant. */
static void put_corner(Corner *c)
{
    static const double r_enu_from_body[9] = {0, 1, 0, 1, 0, 0, 0, 0, -1};
    const DisEntityType type = {8, 3, 225, 5, 0, 0, 0};
    const double       *r = stage.view.r_enu_from_cam;
    double              p[3];
    *c = (Corner){.entity = {.id = {1, 1, 9}, .type = type, .model = catalog_find(stage.catalog, type, NULL, NULL)}};
    CHECK(strcmp(catalog_model(stage.catalog, c->entity.model)->name, "corner_reflector") == 0);
    for (int k = 0; k < 3; k++) p[k] = stage.view.p_enu[k] + reference_m * r[3 * k + 2] - (k == 2 ? 0.5 : 0);
    ecef_from_enu(c->entity.p_ecef, &stage.world.frame, p);
    m3_mul(c->entity.r_ecef_from_body, stage.world.frame.r_ecef_from_enu, r_enu_from_body);
    c->snapshot = (Snapshot){.count = 1, .entity = &c->entity, .joints = &c->joints};
}

static double strongest_m2(const RadarFrame *frame)
{
    CHECK(frame->targets == 1 && frame->detections > 0);
    CHECK_NEAR(frame->detection[0].range_m, reference_m, 0.3);
    return frame->detection[0].rcs_m2;
}

static void corners_return_what_the_handbook_says(void **state)
{
    (void)state;
    const Weather weather = weather_default();
    const double  up = asin(sqrt(1.0 / 3)), radius = 11; /* of the cloud after 10 s */
    SeekerRadar  *radar, *thick;
    Corner        corner;
    SnapshotChaff chaff;
    RadarScene    scene = look(-up, reference_m * sin(up) + 200, 1, &weather);
    radar = open_radar(1, false);
    CHECK(seeker_radar_create(&thick, &(SeekerRadarConfig){.preset = "seeker_35",
                                                           .catalog = stage.catalog_path,
                                                           .isa = "avx2",
                                                           .seed = 1,
                                                           .chaff_dipoles = 4.5e7}) == STATUS_OK);
    put_corner(&corner);
    scene.snapshot = &corner.snapshot;
    arena_reset(stage.arena);
    const RadarFrame *frame = measure(radar, &scene);
    const double      l = frame->preset->antenna.wavelength_m, want = 4 * pi_rad * pow(0.5, 4) / (3 * l * l),
                 got = strongest_m2(frame);
    printf("trihedral of 0.5 m: %.2f dB of 4 pi a^4 / 3 lambda^2 = %.1f dBsm\n", db(got / want), db(want));
    CHECK_NEAR(db(got / want), 0, 0.5);
    /* behind a cloud of chaff, 300 m before it */
    corner.snapshot.chaff = &chaff, corner.snapshot.chaff_count = 1;
    put_chaff(&chaff, reference_m - 300, 10, (const double[3]){0.1, 0, 0});
    const double behind = strongest_m2(measure(thick, &scene));
    const double taken_db = 2 * 4.5e7 / (2 * pi_rad * radius * radius) * l * l / (2 * pi_rad) * 10 / log(10);
    printf("behind chaff: %.3f dB less, %.3f by hand\n", db(got / behind), taken_db);
    CHECK_NEAR(db(got / behind), taken_db, 0.1);
    seeker_radar_destroy(radar);
    seeker_radar_destroy(thick);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rain_has_the_power_of_its_integral),    cmocka_unit_test(rain_and_fog_take_what_itu_says),
        cmocka_unit_test(rain_behind_the_ground_is_hidden),      cmocka_unit_test(chaff_has_its_cross_section),
        cmocka_unit_test(chaff_at_rest_is_left_to_the_wind),     cmocka_unit_test(chaff_falls),
        cmocka_unit_test(corners_return_what_the_handbook_says),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
