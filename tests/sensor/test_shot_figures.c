/* What a frame of the radar says of itself before any echo: where the window is and what is followed, the ground's rate
 * and its notch, the air, what is within beam and window, and what moves. Against figures by hand. labels: physics */
#include "tests/sensor/radar_scene.h"

#include "render/scattering/paths/attenuation.h"
#include "render/scattering/paths/radar_path.h"
#include "render/scattering/signatures/coarse.h"
#include "sensor/radar/seeker_radar_private.h"

static const double ball_m = 0.3, high_m = 120;
static Landscape    land;
static char         table[text_file_size];
static GasLines     gases;

/* Radars of the table, each made when it is first asked for. */
static struct {
    const char  *name;
    SeekerRadar *radar;
} kept[] = {{"h", NULL}, {"v", NULL}, {"free", NULL}, {"fmcw", NULL}, {"w", NULL}, {"ka", NULL}};
enum { radars = sizeof kept / sizeof *kept };

static int open_stage(void **state)
{
    (void)state;
    char            path[4096], water[4096];
    LandscapeConfig config = landscape_default_config();
    config.half_width_m = 500;
    config.horizon_m = 20000;
    config.relief_m = 0;
    scene_folder();
    FILE *file = scene_obj("ball", NULL);
    scene_sphere_of(file, 1, ball_m, 0, 0, 0, 72);
    CHECK(fclose(file) == 0);
    scene_open((const char *const[]){"ball"}, 1);
    CHECK(atmosphere_open(&stage.world.atmosphere, "us1976") == STATUS_OK);
    CHECK(landscape_create(&land, &config, &stage.world.frame, NULL, 0, NULL, 0) == STATUS_OK);
    text_file(table,
              "name,waveform,centre_ghz,bandwidth_mhz,samples,pulses,repeat_khz,pulse_us,power_w,loss_db,dish_m,taper,"
              "transmit,noise_figure_db,phase_noise_deg,iq_gain_db,iq_phase_deg,bits,range_window,doppler_window,pfa,"
              "compensated,far_km,mti,source\n"
              "h,lfm,16.5,20,64,16,4,50,2000,6,0.6,1,h,3.5,0,0,0,0,hamming,hann,1e-6,1,0,2,s\n"
              "v,lfm,16.5,20,64,16,4,50,2000,6,0.6,1,v,3.5,0,0,0,0,hamming,hann,1e-6,1,0,2,s\n"
              "free,lfm,16.5,20,64,16,4,50,2000,6,0.6,1,h,3.5,0,0,0,0,hamming,hann,1e-6,0,0,2,s\n"
              "fmcw,fmcw,16.5,20,64,16,1,900,2000,6,0.6,1,h,3.5,0,0,0,0,hamming,hann,1e-6,1,0,2,s\n"
              "w,lfm,210,20,64,16,4,50,2000,6,0.06,1,h,3.5,0,0,0,0,hamming,hann,1e-6,1,0,2,s\n"
              "ka,lfm,199,20,64,16,4,50,2000,6,0.06,1,h,3.5,0,0,0,0,hamming,hann,1e-6,1,0,2,s\n");
    CHECK(etc_path(path, sizeof path, "radar/oxygen_lines.csv") &&
          etc_path(water, sizeof water, "radar/water_lines.csv") && gas_lines_read(&gases, path, water) == STATUS_OK);
    return 0;
}

static int close_stage(void **state)
{
    (void)state;
    for (int i = 0; i < radars; i++) seeker_radar_destroy(kept[i].radar);
    remove(table);
    landscape_destroy(&land);
    scene_close();
    return 0;
}

static SeekerRadar *radar_of(const char *name)
{
    int i = 0;
    while (strcmp(kept[i].name, name) != 0) CHECK(++i < radars);
    if (!kept[i].radar)
        CHECK(seeker_radar_create(&kept[i].radar, &(SeekerRadarConfig){.preset = name,
                                                                       .table = table,
                                                                       .catalog = stage.catalog_path,
                                                                       .isa = "avx2",
                                                                       .seed = 1}) == STATUS_OK);
    return kept[i].radar;
}

/* The antenna at (1000, 0, high), its axis to the west and down by a sine. */
static void look_west(double down_sine)
{
    const double level = sqrt(1 - down_sine * down_sine);
    const double r[9] = {0, -down_sine, -level, 1, 0, 0, 0, -level, -down_sine};
    stage.view.p_enu[2] = high_m;
    memcpy(stage.view.r_enu_from_cam, r, sizeof r);
    stage.snapshot.count = 0;
    memcpy(stage.scene.v_enu_mps, (double[3]){-200, 30, -20}, sizeof stage.scene.v_enu_mps);
    memset(stage.scene.reference_v_enu_mps, 0, sizeof stage.scene.reference_v_enu_mps);
    stage.scene.reference_m = scene_range_m;
    arena_reset(stage.arena);
}

/* Width of the beam at half power, by halving. */
static double width_rad(const Antenna *a)
{
    double low = 0, high = 1.5 * a->wavelength_m / a->diameter_m;
    for (int i = 0; i < 60; i++) {
        const double middle = 0.5 * (low + high);
        if (pow(antenna_gain(a, middle, 0).sum, 2) > 0.5 * antenna_peak_gain(a)) low = middle;
        else high = middle;
    }
    return 2 * asin(low);
}

static void windows_and_rates(void **state)
{
    (void)state;
    static const char *const name[] = {"h", "free", "fmcw"};
    for (int i = 0; i < 3; i++) {
        SeekerRadar *radar = radar_of(name[i]);
        const double lambda_m = light_mps / 16.5e9, blind_mps = 0.5 * lambda_m * (i == 2 ? 1000 : 4000);
        look_west(0);
        memcpy(stage.scene.reference_v_enu_mps, (double[3]){-7, 5, 3}, sizeof stage.scene.reference_v_enu_mps);
        const RadarFrame *f = scene_measure(radar);
        /* to the west by 200 m/s: still ground nears so fast, what moves west by 7 nears by 193 */
        CHECK_NEAR(f->ground_rate_mps, -200, 1e-9);
        CHECK_NEAR(f->reference_rate_mps, i == 1 ? 0 : -193, 1e-9);
        CHECK_NEAR(f->reference_m, i == 2 ? 64 * light_mps / (4 * 20e6) : 1000, 1e-9);
        CHECK_NEAR(f->timing.blind_mps, blind_mps, 1e-9);
        CHECK_NEAR(f->notch_mps, hypot(30, 20) * width_rad(&radar->preset.antenna) + 2 * blind_mps / 16, 1e-6);
        CHECK(f->aim_m == 1000 && f->v_enu_mps[1] == 30 && f->aim_v_enu_mps[0] == -7 && f->number == 1);

        /* without an aim: to the ground ahead; without either 1000 m */
        stage.scene.reference_m = NAN;
        CHECK_NEAR(scene_measure(radar)->reference_m, i == 2 ? 64 * light_mps / (4 * 20e6) : 1000, 1e-9);
        if (i == 0) {
            double ground_m = elevation_height(&land.elevation, 400, 0, NULL);
            look_west(0.2);
            stage.scene.reference_m = NAN;
            stage.view.p_enu[2] = ground_m + 100, stage.world.landscape = &land;
            f = scene_measure(radar);
            stage.world.landscape = NULL;
            CHECK_NEAR(f->reference_m, 500, 0.5); /* 100 m over 0.2 */
        }
    }
}

/* Loss of the air from the antenna's height to that of the window's middle, above the ground there; fog of 300 m up to
 * 200 GHz; polarised as transmitted. */
static void the_air_between(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double      f_ghz, tilt_rad;
        bool        fog;
    } of[] = {{"h", 16.5, 0, true}, {"v", 16.5, 0.5 * pi_rad, true}, {"ka", 199, 0, true}, {"w", 210, 0, false}};
    for (int i = 0; i < 4; i++)
        for (int foggy = 0; foggy < 2; foggy++)
            for (int up = 0; up < 2; up++) {
                RadarAir     air;
                RadarLoss    loss;
                SeekerRadar *radar = radar_of(of[i].name);
                stage.weather = weather_default();
                stage.weather.rain_mm_h = 5;
                stage.weather.visibility_m = foggy ? 300 : 20000;
                look_west(up ? -0.4 : 0);
                if (up) { /* the ground below the window's middle: 700 m lower than the origin */
                    stage.world.landscape = &land;
                    stage.scene.reference_m = 1100;
                }
                const double range_m = up ? 1100 : 1000;
                const double base_m =
                    up ? elevation_height(&land.elevation, 1000 - range_m * sqrt(1 - 0.16), 0, NULL) : 0;
                CHECK(radar_air_of(&air, stage.world.atmosphere, &stage.weather) == STATUS_OK);
                if (of[i].fog && foggy) air.liquid[0] = (RadarLiquid){0, 300, fog_liquid_g_m3(300)};
                radar_path_loss(&loss,
                                &(RadarPath){high_m - base_m, high_m + (up ? 0.4 * range_m : 0) - base_m, range_m,
                                             of[i].f_ghz, of[i].tilt_rad},
                                &gases, &air);
                const RadarFrame *f = scene_measure(radar);
                CHECK_NEAR(f->air_db / radar_loss_db(&loss), 1, 1e-9);
                CHECK_NEAR(f->reference_m, range_m, 0);
                stage.world.landscape = NULL;
            }
    stage.weather = weather_default();
}

/* Entities within a sine of 16 / u of the axis, times the scene's reach, and of the window, each grown by their radius,
 * and no nearer than its double. */
static void who_is_in_sight(void **state)
{
    (void)state;
    SeekerRadar *radar = radar_of("h");
    const double u = pi_rad * 0.6 * 16.5e9 / light_mps, window_m = 64 * light_mps / (4 * 20e6);
    look_west(0);
    const double radius_m = catalog_model(stage.catalog, 1)->radius_m;
    CHECK(catalog_model_count(stage.catalog) == 2 && radius_m >= ball_m);
    static const double reach[] = {0, 1, 2};
    for (int i = 0; i < 3; i++)
        for (int beyond = 0; beyond < 2; beyond++) {
            const double sine = fmax(reach[i], 1) * 16 / u + radius_m / 1000 + (beyond ? 1e-5 : -1e-5);
            look_west(0);
            stage.scene.reach = reach[i];
            scene_add(0, 1000 - 1000 * sqrt(1 - sine * sine), 1000 * sine, high_m);
            CHECK(scene_measure(radar)->targets == (beyond ? 0 : 1));
        }
    stage.scene.reach = 0;
    for (int far = 0; far < 2; far++)
        for (int beyond = 0; beyond < 2; beyond++) {
            const double off_m = window_m + radius_m + (beyond ? 0.01 : -0.01);
            look_west(0);
            scene_add(0, far ? -off_m : off_m, 0, high_m);
            const RadarFrame *f = scene_measure(radar);
            CHECK(f->targets == (beyond ? 0 : 1));
            if (!beyond) CHECK_NEAR(f->target[0].range_m, 1000 + (far ? off_m : -off_m), 1e-6);
        }
    for (int near = 0; near < 2; near++) {
        look_west(0);
        stage.scene.reference_m = 20;
        scene_add(0, 1000 - radius_m * (near ? 1.99 : 2.01), 0, high_m);
        CHECK(scene_measure(radar)->targets == (near ? 0 : 1));
    }
    look_west(0);
    scene_add(0, 0, 0, high_m);
    stage.scene.hidden = 0; /* the host itself */
    CHECK(scene_measure(radar)->targets == 0);
    stage.scene.hidden = -1;
}

/* A sphere of pi a^2 that nears with the ground is found where it is, and does not move; one whose rate is off by less
 * than the notch does not, by more does. */
static void what_moves_beyond_the_notch(void **state)
{
    (void)state;
    SeekerRadar *radar = radar_of("h");
    look_west(0);
    const double        notch_mps = scene_measure(radar)->notch_mps;
    static const double of[] = {0, -0.85, 0.85, -1.15, 1.15};
    for (int i = 0; i < 5; i++) {
        look_west(0);
        SnapshotEntity *e = scene_add(0, 20, 5, high_m - 3);
        const double    v[3] = {-of[i] * notch_mps, 0, 0}; /* to the west: away */
        m3_mul_v3(e->v_ecef_mps, stage.world.frame.r_ecef_from_enu, v);
        const RadarFrame *f = scene_measure(radar);
        CHECK(f->targets == 1 && f->detections > 0);
        const Detection *d = &f->detection[0];
        const double     range_m = sqrt(980 * 980 + 5 * 5 + 3 * 3);
        /* rate of still ground there: -v.d; the target's own is added along the line of sight */
        const double ground = -(200 * 980 + 30 * 5 + 20 * 3) / range_m,
                     want = ground + of[i] * notch_mps * 980 / range_m;
        printf("%5.2f notches: found at %.2f of %.2f m, %.2f of %.2f m/s, %.3f m2, %s\n", of[i], d->range_m, range_m,
               d->range_rate_mps, want, d->rcs_m2, d->moving ? "moves" : "still");
        CHECK_NEAR(d->range_rate_mps, want, 0.3);
        CHECK(d->moving == (fabs(of[i]) > 1));
        CHECK_NEAR(d->cos_right, 5 / range_m, 5e-4);
        CHECK_NEAR(d->cos_down, 3 / range_m, 5e-4);
        CHECK_NEAR(d->range_m, range_m - ball_m, 1);
        CHECK_NEAR(10 * log10(d->rcs_m2 / (pi_rad * ball_m * ball_m)), 0, 0.5);
    }
}

/* How signatures are made for a radar: bins of 0.3 degrees, half a ray a wavelength, up to 1 GiB; for its band and its
 * interval. Cells of ground: half of a cell of range, c / (4 B), so that each of these has several. */
static void what_it_is_made_with(void **state)
{
    (void)state;
    SeekerRadar           *radar = radar_of("h");
    const SignaturesConfig c = seeker_radar_signatures(&radar->preset, 2e-3, "avx2");
    CHECK(c.frequency_hz == 16.5e9 && c.bandwidth_hz == 20e6 && c.warp_m == 2e-3 && c.rays_per_wavelength == 0.5);
    CHECK_NEAR(c.aspect_rad, 0.3 * pi_rad / 180, 1e-15);
    CHECK_NEAR(c.interval_s, 16 / 4000.0, 1e-15);
    CHECK(c.most_octets == 1073741824 && c.splits == 0 && c.coarse_for_hz == 0 && !c.background);
    CHECK_NEAR(radar->cells.side_m, light_mps / (4 * 20e6), 1e-9);
}

/* Heights are taken as 0 .. 20 km above the ground, ranges as 1000 km at most; what is lost a metre stays so beyond. */
static void air_of_long_paths(void **state)
{
    (void)state;
    static const struct {
        double eye_m, down_sine, range_m, a_m, b_m, of_m;
    } c[] = {{120, 0, 1.05e6, 120, 120, 1e6}, {25000, 0, 5e4, 20000, 20000, 5e4}, {120, -0.4, 1e5, 120, 20000, 1e5},
             {-50, 0, 2e4, 0, 0, 2e4},        {21000, 0.4, 6e4, 20000, 0, 6e4},   {19000, 0.1, 2e4, 19000, 17000, 2e4}};
    SeekerRadar *radar = radar_of("h");
    for (int i = 0; i < 6; i++) {
        RadarAir  air;
        RadarLoss loss;
        look_west(c[i].down_sine);
        stage.view.p_enu[2] = c[i].eye_m;
        stage.scene.reference_m = c[i].range_m;
        CHECK(radar_air_of(&air, stage.world.atmosphere, &stage.weather) == STATUS_OK);
        air.liquid[0] = (RadarLiquid){0, 300, fog_liquid_g_m3(stage.weather.visibility_m)};
        radar_path_loss(&loss, &(RadarPath){c[i].a_m, c[i].b_m, c[i].of_m, 16.5, 0}, &gases, &air);
        CHECK_NEAR(scene_measure(radar)->air_db / radar_loss_db(&loss), 1, 1e-9);
    }
}

/* What a node without contacts prepares: every model of the snapshot that has a shape, with its damage, in all coarse
 * bins; nothing before it is opened. */
static void coarse_ones_are_prepared(void **state)
{
    (void)state;
    static ScatterAntenna bin[coarse_most_bins];
    const int             bins = coarse_bins(bin);
    SeekerRadar          *radar = radar_of("free");
    look_west(0);
    scene_add(0, 0, 0, 0), scene_add(0, 50, 0, 0), scene_add(0, 90, 0, 0);
    stage.entity[2].appearance = 3 << 3; /* damage 3; beyond the snapshot's end */
    stage.entity[0].model = -1;          /* of no model: skipped, and those after it are not */
    stage.snapshot.count = 2;
    CHECK(seeker_radar_prepare(radar, stage.catalog, &stage.snapshot) == STATUS_OK);
    CHECK(seeker_radar_prepared(radar).waiting == 0 && seeker_radar_prepared(radar).made == 0 && !radar->coarse);
    radar->fine.background = true; /* as a node has it */
    CHECK(radar_coarse_open(radar) == STATUS_OK && radar->coarse);
    const Signatures *opened = radar->coarse;
    CHECK(radar_coarse_open(radar) == STATUS_OK && radar->coarse == opened);
    CHECK(seeker_radar_prepared(radar).waiting == 0);
    CHECK(seeker_radar_prepare(radar, stage.catalog, &stage.snapshot) == STATUS_OK);
    const RadarPrepared p = seeker_radar_prepared(radar);
    printf("%d bins: %d made, %d wait\n", bins, p.made, p.waiting);
    CHECK(p.made + p.waiting <= bins && p.waiting > bins / 2); /* more may be made between the two */
    stage.snapshot.count = 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(windows_and_rates),        cmocka_unit_test(the_air_between),
        cmocka_unit_test(who_is_in_sight),          cmocka_unit_test(what_moves_beyond_the_notch),
        cmocka_unit_test(what_it_is_made_with),     cmocka_unit_test(air_of_long_paths),
        cmocka_unit_test(coarse_ones_are_prepared),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
