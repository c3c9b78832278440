/* The points that one shot makes of rain, plants and chaff, and their echoes in a later position of the beam: places,
 * powers, velocities and paths against the volumes and laws that they stand for. labels: physics */
#include "tests/render/hand_plants.h"
#include "tests/sensor/radar_scene.h"

#include "render/scattering/clutter/volume_scatter.h"
#include "sensor/radar/seeker_radar_private.h"

enum { across = 12, plants = across * across };

static const double   lambda_m = 0.299792458 / 16.5, null_sine = 5.1356 / (pi_rad * 0.5 / (0.299792458 / 16.5));
static SeekerRadar    radar;
static RadarFrame     frame;
static World          planted;
static Woods          woods;
static Plant          plant[plants];
static double complex sample[interval_channels * 16 * 64];

static int open_stage(void **state)
{
    (void)state;
    char path[4096];
    scene_folder();
    FILE *file = scene_obj("box", NULL);
    scene_box(file, "box", 1, (const double[3]){-1, -1, -1}, (const double[3]){1, 1, 1});
    CHECK(fclose(file) == 0);
    scene_open((const char *const[]){"box"}, 1);
    CHECK(atmosphere_open(&stage.world.atmosphere, "us1976") == STATUS_OK);
    radar = (SeekerRadar){.preset = {.wave = {.kind = WAVEFORM_LFM,
                                              .centre_hz = 16.5e9,
                                              .bandwidth_hz = 5e8,
                                              .pulse_s = 1e-6,
                                              .repeat_hz = 2e4,
                                              .samples = 64,
                                              .pulses = 16},
                                     .antenna = {.diameter_m = 0.5, .taper = 1, .wavelength_m = 0.299792458 / 16.5},
                                     .power_w = 40,
                                     .loss = 2},
                          .ground = true,
                          .in_band = true,
                          .band = CLUTTER_KU,
                          .chaff_dipoles = 2e6,
                          .seed = 7};
    CHECK(etc_path(path, sizeof path, "radar/clutter.csv") && clutter_table_open(&radar.clutter, path) == STATUS_OK);
    CHECK(echo_grid_create(&radar.echoes, &radar.preset.wave) == STATUS_OK);
    radar.batch = malloc(beam_batch * sizeof *radar.batch);
    CHECK(radar.batch);
    /* plants of 6 to 8 m, 7 m apart, so that no two crowns meet, about a place 300 m north */
    hand_grow(true, 0.1);
    woods = hand_stand(plant, plants, (const double[3]){-42, 258, 0}, 0);
    for (int i = 0; i < plants; i++) {
        plant[i].p_m[0] = (float)(7 * (i % across) + 3.5), plant[i].p_m[1] = (float)(7 * (i / across) + 3.5);
        plant[i].p_m[2] = 0;
        plant[i].height = (uint16_t)(600 + i % 3 * 100), plant[i].width = 100;
    }
    woods.nx = woods.ny = 2;
    static uint32_t first[5] = {0, plants, plants, plants, plants};
    woods.first = first;
    planted = stage.world;
    return forest_create(&planted.forest, &woods, &hand_plants, &(ForestConfig){.leaves = true}, "avx2") == STATUS_OK
               ? 0
               : -1;
}

static int close_stage(void **state)
{
    (void)state;
    echo_grid_destroy(radar.echoes);
    leaf_cache_destroy(radar.leaves);
    foliage_destroy(radar.foliage);
    free(radar.batch);
    free(radar.points.point);
    forest_destroy(planted.forest);
    scene_close();
    return 0;
}

/* 60 m above the plain, towards a place 300 m north and 3 m high. */
static RadarShot shot_of(const World *world, double half_window_m)
{
    static const double v_enu_mps[3] = {40, 100, -10};
    Visibility         *visibility;
    const double        p[3] = {0, 0, 60}, to[3] = {0, 300, -57}, range_m = v3_length(to);
    arena_reset(stage.arena);
    radar.points.count = 0;
    frame = (RadarFrame){.reference_m = range_m};
    stage.scene.world = world;
    memcpy(stage.scene.v_enu_mps, v_enu_mps, sizeof v_enu_mps);
    memcpy(stage.view.p_enu, p, sizeof p);
    CHECK(visibility_create(&visibility, world->tracer, NULL, &world->frame, &stage.snapshot, 0, stage.arena) ==
          STATUS_OK);
    return (RadarShot){.radar = &radar,
                       .scene = &stage.scene,
                       .preset = &radar.preset,
                       .visibility = visibility,
                       .frame = &frame,
                       .arena = stage.arena,
                       .p_enu = {0, 0, 60},
                       .right = {1, 0, 0},
                       .down = {0, to[2] / range_m, -to[1] / range_m},
                       .ahead = {0, to[1] / range_m, to[2] / range_m},
                       .reference_m = range_m,
                       .reference_rate_mps = -90,
                       .half_window_m = half_window_m,
                       .near_m = range_m - half_window_m,
                       .far_m = range_m + half_window_m,
                       .reach = 1,
                       .widest = 0.3};
}

static double power_m2(double complex s) { return 4 * pi_rad * (creal(s) * creal(s) + cimag(s) * cimag(s)); }

/* Range, cosines and unit direction of a place. */
static double seen_at(double d[3], double *right, double *down, const RadarShot *s, const double p[3])
{
    v3_sub(d, p, s->p_enu);
    const double range_m = v3_length(d);
    v3_scale(d, 1 / range_m, d);
    *right = v3_dot(d, s->right), *down = v3_dot(d, s->down);
    return range_m;
}

/* What every point has: its way against the reference's, and how that grows from pulse to pulse. */
static void check_paths(const RadarShot *s, double widest)
{
    for (int i = 0; i < radar.points.count; i++) {
        const RadarPoint *q = &radar.points.point[i];
        double            d[3], right, down, v[3];
        const double      range_m = seen_at(d, &right, &down, s, q->p_enu);
        v3_sub(v, q->v_enu_mps, stage.scene.v_enu_mps);
        CHECK_NEAR(q->path_m, 2 * (range_m - s->reference_m), 1e-9);
        CHECK_NEAR(q->path_per_pulse_m, 2 * (v3_dot(v, d) + 90) / 2e4, 1e-12);
        CHECK(q->share == 1 && q->room_m == 0 && q->own == (s->after_s != 0));
        CHECK_NEAR(q->widest / widest, 1, 2e-5);
        CHECK(fabs(range_m - s->reference_m) < s->half_window_m + light_mps / (4 * 5e8)); /* a slice of rain is whole */
    }
}

/* ---- rain ---------------------------------------------------------------------------------------- */

/* One scatterer in each of 4 rings by 8 sectors of each slice of half a cell; powers by the volume of the cone: back
 * 2 pi (1 - cos) (far^3 - near^3) / 3; velocities: wind, fall and 1 m/s rms each way. Sums of 3000 exponential powers:
 * 2 %. */
static void rain_fills_the_main_lobe(void **state)
{
    (void)state;
    stage.weather.rain_mm_h = 10, stage.weather.wind_mps = 8, stage.weather.wind_from_rad = 240 * rad_per_deg;
    CHECK(radar_air_of(&radar.air, stage.world.atmosphere, &stage.weather) == STATUS_OK);
    RadarShot s = shot_of(&stage.world, 7.51); /* 15.02 m: 101 slices of c / (4 B) = 0.1499 m */
    CHECK(shot_rain(&s) == STATUS_OK);
    CHECK(radar.points.count == 101 * 32);
    check_paths(&s, 1.001 * null_sine);
    const double wind[3] = {8 * sin(60 * rad_per_deg), 8 * cos(60 * rad_per_deg), 0}; /* blows to 60 degrees */
    double       sum = 0, other = 0, mean[3] = {0}, square[3] = {0}, off[3] = {0}, fall = 0;
    for (int i = 0; i < radar.points.count; i++) {
        const RadarPoint *q = &radar.points.point[i];
        double            d[3], right, down;
        const double      range_m = seen_at(d, &right, &down, &s, q->p_enu), step_m = light_mps / (4 * 5e8);
        const double      at[3] = {(range_m - s.near_m) / step_m, 4 * pow(hypot(right, down) / null_sine, 2),
                                   8 * fmod(atan2(down, right) + 2 * pi_rad, 2 * pi_rad) / (2 * pi_rad)};
        const int         cell[3] = {i / 32, i % 32 / 8, i % 8};
        for (int k = 0; k < 3; k++) {
            if (!(at[k] > cell[k] - 1e-4 && at[k] < cell[k] + 1 + 1e-4)) fail_msg("point %d: %g", i, at[k]);
            off[k] += (at[k] - cell[k]) / radar.points.count;
        }
        sum += power_m2(q->same), other += power_m2(q->other);
        for (int k = 0; k < 3; k++) {
            mean[k] += (q->v_enu_mps[k] - wind[k]) / radar.points.count;
            square[k] += pow(q->v_enu_mps[k] - wind[k], 2) / radar.points.count;
        }
    }
    RainScatter rain;
    GasState    air;
    radar_air_at(&air, &radar.air, 0);
    CHECK(rain_scatter(&rain, 16.5, air.temp_k, 10));
    for (int i = 0; i < 1000; i++) fall += rain_fall_mps(&rain, (i + 0.5) / 1000) / 1000;
    const double volume_m3 =
        2 * pi_rad * (1 - cos(asin(null_sine))) * (pow(s.near_m + 101 * light_mps / 2e9, 3) - pow(s.near_m, 3)) / 3;
    printf("rain: %.3f of its power, cross %.4f, wind off by %.3f %.3f, falls %.2f of %.2f m/s, rms %.3f %.3f\n",
           sum / (rain.back_1_m * volume_m3), other / sum, mean[0], mean[1], -mean[2], fall, sqrt(square[0]),
           sqrt(square[1]));
    CHECK_NEAR(frame.rain_1_m / rain.back_1_m, 1, 1e-12);
    CHECK_NEAR(sum / (rain.back_1_m * volume_m3), 1, 0.06);
    CHECK_NEAR(other / sum / pow(10, -2.5), 1, 0.08);
    for (int k = 0; k < 3; k++) CHECK_NEAR(off[k], 0.5, 0.02);
    for (int k = 0; k < 2; k++) {
        CHECK_NEAR(mean[k], 0, 0.06);
        CHECK_NEAR(square[k], 1, 0.08);
    }
    CHECK_NEAR(-mean[2], fall, 0.1);

    /* another draw for another number, time or axis; no rain above its top, nor nearer than 10 m, and at most 4096
     * slices */
    const double was = radar.points.point[0].p_enu[0];
    stage.scene.number++;
    s = shot_of(&stage.world, 7.51);
    CHECK(shot_rain(&s) == STATUS_OK && radar.points.point[0].p_enu[0] != was);
    const double then = radar.points.point[0].p_enu[0];
    stage.scene.t_s += 1;
    s = shot_of(&stage.world, 7.51);
    CHECK(shot_rain(&s) == STATUS_OK && radar.points.point[0].p_enu[0] != then);
    stage.scene.number--, stage.scene.t_s -= 1;
    s = shot_of(&stage.world, 7.51);
    CHECK(shot_rain(&s) == STATUS_OK && radar.points.point[0].p_enu[0] == was);
    radar.air.rain_top_m = 4, s = shot_of(&stage.world, 7.51), s.base_m = -1;
    CHECK(shot_rain(&s) == STATUS_OK && radar.points.count > 1000 && radar.points.count < 2200);
    for (int i = 0; i < radar.points.count; i++) CHECK(radar.points.point[i].p_enu[2] < 3);
    radar.air.rain_top_m = 4000, s = shot_of(&stage.world, 2000), s.near_m = 0, s.far_m = 10 + 819.2;
    CHECK(shot_rain(&s) == STATUS_OK && radar.points.count == 4096 * 32);
    double nearest_m = INFINITY, farthest_m = 0;
    for (int i = 0; i < radar.points.count; i++) {
        const double range_m = s.reference_m + 0.5 * radar.points.point[i].path_m;
        nearest_m = fmin(nearest_m, range_m), farthest_m = fmax(farthest_m, range_m);
    }
    CHECK(nearest_m > 10 && nearest_m < 10.1 && farthest_m > 829 && farthest_m < 829.2);
    /* drops are taken as no colder than 273.15 K and no warmer than 323.15 K */
    const double at_ground_k = radar.air.temp_k[0];
    for (int hot = 0; hot < 2; hot++) {
        radar.air.temp_k[0] = hot ? 325 : 270, s = shot_of(&stage.world, 7.51);
        CHECK(shot_rain(&s) == STATUS_OK && rain_scatter(&rain, 16.5, hot ? 323.15 : 273.15, 10));
        CHECK_NEAR(frame.rain_1_m / rain.back_1_m, 1, 1e-12);
    }
    radar.air.temp_k[0] = at_ground_k;
    radar.air.rain_mm_h = 0, s = shot_of(&stage.world, 7.51);
    CHECK(shot_rain(&s) == STATUS_OK && radar.points.count == 0);
}

/* ---- plants ---------------------------------------------------------------------------------------- */

/* Points even over each crown's spheroid that have its power: 2 alpha gamma by volume, alpha the loss in nepers. Crowns
 * that the beam and the window cut have fewer. */
static void crowns_are_filled(void **state)
{
    (void)state;
    RadarShot s = shot_of(&planted, 24);
    CHECK(shot_volume_open(&s) == STATUS_OK && shot_volume(&s) == STATUS_OK);
    check_paths(&s, null_sine);
    int    lit = 0, whole = 0, some = 0;
    double got_m2 = 0, want_m2 = 0, other_m2 = 0, want_other_m2 = 0, cubed = 0, upright = 0, along = 0;
    for (int i = 0; i < plants; i++) {
        const FoliageCrown *c = foliage_crown(radar.foliage, i);
        const double        axes[3] = {(double)c->across_m, (double)c->across_m, (double)c->up_m};
        const double        room_m = fmax(axes[0], axes[2]), o[3] = {-42, 258, 0};
        double              middle[3], d[3], right, down;
        int                 inside = 0;
        for (int k = 0; k < 3; k++) middle[k] = o[k] + (double)c->centre_m[k];
        const double range_m = seen_at(d, &right, &down, &s, middle), off = hypot(right, down);
        const bool   in = fabs(range_m - s.reference_m) < 24 + room_m && off < null_sine + room_m / range_m;
        const bool   all = fabs(range_m - s.reference_m) < 24 - room_m && off < null_sine - room_m / range_m;
        double       power = 0, cross = 0;
        for (int k = 0; k < radar.points.count; k++) {
            const RadarPoint *q = &radar.points.point[k];
            double            u[3];
            for (int x = 0; x < 3; x++) u[x] = (q->p_enu[x] - middle[x]) / axes[x];
            const double r = v3_length(u);
            if (r > 1 + 1e-6) continue;
            inside++;
            power += power_m2(q->same), cross += power_m2(q->other);
            if (!all) continue;
            cubed += pow(r, 3), upright += u[2] * u[2] / (r * r), along += u[0] * u[0] / (r * r);
        }
        lit += in, whole += all, some += inside;
        CHECK(in || inside == 0);
        if (!all) continue;
        CHECK(inside == 64);
        const ClutterRow *row = &radar.clutter.row[c->surface][CLUTTER_KU];
        const double      back = 2 * log(10) / 10 * row->foliage_db_m * row->gamma;
        const double      sigma_m2 = back * 4 / 3.0 * pi_rad * axes[0] * axes[1] * axes[2];
        got_m2 += power, want_m2 += sigma_m2, other_m2 += cross, want_other_m2 += sigma_m2 * row->hv;
    }
    const double n = 64.0 * whole;
    printf("%d crowns, %d whole: %.3f of their power, cross %.3f; r^3 %.3f, up^2 %.3f, east^2 %.3f\n", lit, whole,
           got_m2 / want_m2, other_m2 / want_other_m2, cubed / n, upright / n, along / n);
    /* those kept from the shot before, and those that nothing was kept of, are the same */
    const size_t octets = (size_t)radar.points.count * sizeof *radar.points.point;
    RadarPoint  *before = malloc(octets);
    CHECK(before && radar.leaves);
    memcpy(before, radar.points.point, octets);
    for (int kept = 1; kept >= 0; kept--) {
        LeafCache *leaves = radar.leaves;
        s = shot_of(&planted, 24);
        CHECK(shot_volume_open(&s) == STATUS_OK);
        radar.leaves = kept ? leaves : NULL;
        CHECK(shot_volume(&s) == STATUS_OK && (size_t)radar.points.count * sizeof *before == octets);
        for (int k = 0; k < radar.points.count; k++) {
            const RadarPoint *a = &radar.points.point[k], *b = &before[k];
            CHECK(memcmp(a->p_enu, b->p_enu, sizeof a->p_enu) == 0 && a->same == b->same && a->other == b->other &&
                  a->path_m == b->path_m);
        }
        radar.leaves = leaves;
    }
    free(before);
    CHECK(frame.crowns == lit && some == radar.points.count && whole > 10 && whole < lit - 10);
    CHECK_NEAR(got_m2 / want_m2, 1, 0.08);
    CHECK_NEAR(other_m2 / want_other_m2, 1, 0.08);
    CHECK_NEAR(cubed / n, 0.5, 0.03);
    CHECK_NEAR(upright / n, 1 / 3.0, 0.03);
    CHECK_NEAR(along / n, 1 / 3.0, 0.03);

    /* 8 crown radii over a cell of 0.3 m: 16 m / 0.3 m = 53, so 64; with cells of 3 m the least, 8; loss: of the crowns
     * on the way, as foliage.h has it */
    radar.preset.wave.bandwidth_hz = 5e7;
    s = shot_of(&planted, 24);
    CHECK(shot_volume(&s) == STATUS_OK && radar.points.count < some / 7 && radar.points.count > some / 9);
    radar.preset.wave.bandwidth_hz = 5e8;
    Sight sight;
    shot_sight(&sight, &s, (const double[3]){3.5, 330, 1}, 0);
    const double db = foliage_loss_db(NULL, radar.foliage, s.p_enu, sight.d_enu, sight.range_m);
    CHECK(db > 1);
    CHECK_NEAR(shot_volume_np(&s, &sight), db * log(10) / 10, 1e-12);
    /* the least power of two, from 8, that is 8 of the widest crown's radii over a cell: 64 of 63, 128 of 65 */
    double widest_m = 0;
    int    of[2];
    radar.preset.wave.samples = 128;
    for (int i = 0; i < plants; i++) widest_m = fmax(widest_m, (double)foliage_crown(radar.foliage, i)->across_m);
    for (int i = 0; i < 2; i++) {
        radar.preset.wave.bandwidth_hz = (i ? 65 : 63) * 0.5 * light_mps / (8 * widest_m);
        s = shot_of(&planted, 24);
        CHECK(shot_volume(&s) == STATUS_OK);
        of[i] = radar.points.count;
    }
    CHECK_NEAR((double)of[0] / some, 1, 0.01);
    CHECK_NEAR((double)of[1] / some, 2, 0.05);
    /* or that 48 crowns have 48 in each step of the window, whichever are fewer: of 64 steps 64 a crown */
    radar.preset.wave.samples = 64;
    s = shot_of(&planted, 24);
    CHECK(shot_volume(&s) == STATUS_OK && frame.crowns == 48);
    CHECK_NEAR((double)radar.points.count / some, 1, 0.01);
    radar.preset.wave.bandwidth_hz = 5e8;
    s = shot_of(&planted, 24);
    /* without ground no plants, and without woods no foliage */
    radar.ground = false, s = shot_of(&planted, 24);
    CHECK(shot_volume(&s) == STATUS_OK && radar.points.count == 0);
    radar.ground = true, s = shot_of(&stage.world, 24);
    CHECK(shot_volume_open(&s) == STATUS_OK && !radar.foliage);
}

/* ---- chaff ----------------------------------------------------------------------------------------- */

static void put(SnapshotChaff *chaff, const double p_enu[3], const double v_enu_mps[3])
{
    *chaff = (SnapshotChaff){.id = {1, 2, 3}, .age_s = 5};
    ecef_from_enu(chaff->p_ecef, &stage.world.frame, p_enu);
    m3_mul_v3(chaff->v_ecef_mps, stage.world.frame.r_ecef_from_enu, v_enu_mps);
}

/* Gaussian, of the radius that its age gives; 0.151 lambda^2 a dipole and a third of it cross-polarised; 32 points in a
 * cell over six radii. One reported at rest has drifted with the wind, and fallen by 0.3 m/s. */
static void clouds_of_chaff(void **state)
{
    (void)state;
    static const double at[3] = {1, 300, 5}, moves[3] = {3, -2, 1}, rests[3] = {0};
    const double        r_m = 1 + 7 * (1 - exp(-5)) + 0.3 * 5;
    const double        wind[3] = {8 * sin(60 * rad_per_deg), 8 * cos(60 * rad_per_deg), -0.3};
    SnapshotChaff       chaff;
    stage.snapshot.chaff = &chaff, stage.snapshot.chaff_count = 1;
    for (int still = 0; still < 2; still++) {
        const double *v = still ? wind : moves;
        double        mean[3] = {0}, square[3] = {0}, vm[3] = {0}, vs[3] = {0}, same = 0, other = 0;
        put(&chaff, at, still ? rests : moves);
        RadarShot s = shot_of(&stage.world, 90);
        CHECK(shot_volume_open(&s) == STATUS_OK && shot_volume(&s) == STATUS_OK && frame.clouds == 1);
        const int n = radar.points.count;
        CHECK(n == (int)ceil(192 * r_m / (light_mps / 1e9)));
        check_paths(&s, 0.3);
        for (int i = 0; i < n; i++) {
            const RadarPoint *q = &radar.points.point[i];
            same += power_m2(q->same), other += power_m2(q->other);
            for (int k = 0; k < 3; k++) {
                const double off = q->p_enu[k] - at[k] - (still ? 5 * v[k] : 0), dv = q->v_enu_mps[k] - v[k];
                mean[k] += off / n, square[k] += off * off / n, vm[k] += dv / n, vs[k] += dv * dv / n;
            }
        }
        printf("chaff of %d points: power %.3f, cross %.3f; rms %.2f %.2f %.2f of %.2f m, %.3f %.3f %.3f m/s\n", n,
               same / (0.151 * lambda_m * lambda_m * 2e6), other / same, sqrt(square[0]), sqrt(square[1]),
               sqrt(square[2]), r_m, sqrt(vs[0]), sqrt(vs[1]), sqrt(vs[2]));
        CHECK_NEAR(same / (0.151 * lambda_m * lambda_m * 2e6), 1, 0.06);
        CHECK_NEAR(other / same, 1 / 3.0, 0.03);
        for (int k = 0; k < 3; k++) {
            CHECK_NEAR(mean[k], 0, 0.05 * r_m);
            CHECK_NEAR(sqrt(square[k]) / r_m, 1, 0.04);
            CHECK_NEAR(vm[k], 0, 0.03);
            CHECK_NEAR(sqrt(vs[k]) / (k < 2 ? 0.5 : hypot(0.5, 0.07)), 1, 0.04);
        }
        /* through its middle N lambda^2 / (2 pi) over 2 pi r^2, half of it at the middle itself */
        for (int half = 0; half < 2; half++) {
            Sight  sight;
            double to[3], p[3];
            for (int k = 0; k < 3; k++) to[k] = at[k] + (still ? 5 * v[k] : 0) - s.p_enu[k];
            v3_add_scaled(p, s.p_enu, half ? 1 : 1.5, to);
            shot_sight(&sight, &s, p, 0);
            const double np = 2e6 * lambda_m * lambda_m / (2 * pi_rad) / (2 * pi_rad * r_m * r_m) * (half ? 0.5 : 1);
            CHECK_NEAR(shot_volume_np(&s, &sight) / np, 1, 1e-6);
        }
    }
    /* five radii beyond the window, and off the beam, there is none; few points for wide cells, many for narrow ones */
    static const double high[2] = {0.99, 1.01};
    for (int i = 0; i < 2; i++) {
        RadarShot    s = shot_of(&stage.world, 30);
        const double beyond_m = 30 + high[i] * 5 * r_m;
        double       p[3];
        v3_add_scaled(p, s.p_enu, s.reference_m + beyond_m, s.ahead);
        put(&chaff, p, moves);
        CHECK(shot_volume_open(&s) == STATUS_OK && shot_volume(&s) == STATUS_OK && frame.clouds == (i == 0));
        s = shot_of(&stage.world, 30);
        const double sine = 0.3 + high[i] * 5 * r_m / s.reference_m;
        v3_scale(p, s.reference_m * sqrt(1 - sine * sine), s.ahead);
        v3_add_scaled(p, p, s.reference_m * sine, s.right);
        v3_add(p, p, s.p_enu);
        put(&chaff, p, moves);
        CHECK(shot_volume_open(&s) == STATUS_OK && shot_volume(&s) == STATUS_OK && frame.clouds == (i == 0));
        radar.preset.wave.bandwidth_hz = i ? 5e9 : 5e6;
        s = shot_of(&stage.world, 1000);
        put(&chaff, at, moves);
        CHECK(shot_volume_open(&s) == STATUS_OK && shot_volume(&s) == STATUS_OK);
        CHECK(radar.points.count == (i ? 16384 : 512));
        radar.preset.wave.bandwidth_hz = 5e8;
    }
    /* as many clouds as are counted, whatever lies behind them */
    SnapshotChaff two[2];
    put(&two[0], at, moves);
    put(&two[1], at, moves);
    stage.snapshot.chaff = two, stage.snapshot.chaff_count = 2;
    for (int of = 1; of <= 2; of++) {
        RadarShot s = shot_of(&stage.world, 90);
        CHECK(shot_volume_open(&s) == STATUS_OK && s.chaff_count == 2);
        s.chaff_count = of;
        CHECK(shot_volume(&s) == STATUS_OK && frame.clouds == of);
    }
    stage.snapshot.chaff_count = 0;
}

/* ---- echoes in a position of the beam ----------------------------------------------------------------- */

/* A point that moves, in a position 20 ms later: amplitude by the radar equation in its direction then, its path and
 * growth by the change of the range; of one's own those that it says. */
static void echoes_in_a_later_position(void **state)
{
    (void)state;
    const double k = 2 * pi_rad / lambda_m, after_s = 0.02;
    for (int own = 0; own < 2; own++) {
        RadarShot s = shot_of(&stage.world, 40), beam;
        s.window_rate_mps = -90, s.air_np_m = 1e-3;
        RadarPoint *q = radar_points_room(&radar.points, 6);
        CHECK(q);
        *q = (RadarPoint){.p_enu = {4, 295, 8},
                          .v_enu_mps = {-30, 20, 60},
                          .path_m = 0.7,
                          .path_per_pulse_m = 1e-4,
                          .same = 2 - I,
                          .other = 0.3 * I,
                          .share = 0.7,
                          .widest = 0.05,
                          .own = own};
        for (int i = 1; i < 6; i++) q[i] = q[0];
        q[1].widest = 1e-3;                    /* off the axis by more */
        q[2].p_enu[1] += 60;                   /* beyond the window */
        q[3].p_enu[1] += 55, q[3].room_m = 90; /* likewise, but for its room */
        q[3].same = q[3].other = 0;
        q[4].widest = 0.001, q[5].p_enu[1] = 200;
        radar.points.count = 6;
        radar.target_points = 0;
        shot_position(&beam, &s, 0.01, after_s);
        beam.reach = 1;
        CHECK(shot_echoes(&beam, false) == STATUS_OK && radar.points.count == 6);
        memset(sample, 0, sizeof sample);
        echo_sum(sample, radar.echoes);

        double was[3], now[3], v[3], p[3], d[3], right, down;
        v3_sub(was, q->p_enu, s.p_enu);
        v3_sub(v, q->v_enu_mps, stage.scene.v_enu_mps);
        v3_add_scaled(p, q->p_enu, own ? 0 : after_s, q->v_enu_mps);
        v3_sub(now, p, beam.p_enu);
        const double r_m = v3_length(now), rate_was = v3_dot(was, v) / v3_length(was), rate = v3_dot(now, v) / r_m;
        const double path_m = 0.7 + (own ? 0 : 2 * (r_m - v3_length(was) + 90 * after_s));
        const double growth_m = 1e-4 + (own ? 0 : 2 * (rate - rate_was) / 2e4);
        seen_at(d, &right, &down, &beam, p);
        const AntennaGain    g = antenna_gain(&radar.preset.antenna, right, down);
        const double         unit = 0.7 * lambda_m * sqrt(40 / 2.0) / (4 * pi_rad * r_m * r_m) * exp(-1e-3 * r_m);
        const double complex a[interval_channels] = {unit * g.sum * g.sum * (2 - I), unit * g.sum * g.right * (2 - I),
                                                     unit * g.sum * g.down * (2 - I), unit * g.sum * g.sum * 0.3 * I};
        CHECK(CHANNEL_SUM == 0 && CHANNEL_RIGHT == 1 && CHANNEL_DOWN == 2 && CHANNEL_CROSS == 3);
        CHECK(fabs(g.right) > 0.01 * g.sum && fabs(g.down) > 0.01 * g.sum);
        for (int ch = 0; ch < interval_channels; ch++)
            for (int n = 0; n < 16; n++) {
                const double complex want = a[ch] * cexp(-I * k * (path_m + (n - 7.5) * growth_m));
                CHECK_NEAR(cabs(sample[(ch * 16 + n) * 64 + 32] - want) / cabs(a[ch]), 0, 1e-3);
            }
        /* the sum channel alone; nothing of points that come before those of targets are seen anew */
        shot_position(&beam, &s, 0.01, after_s);
        CHECK(shot_echoes(&beam, true) == STATUS_OK);
        memset(sample, 0, sizeof sample);
        echo_sum(sample, radar.echoes);
        for (int ch = 1; ch < interval_channels; ch++) CHECK(sample[ch * 16 * 64 + 32] == 0);
        CHECK(cabs(sample[32]) > 0.9 * cabs(a[0]));
        radar.target_points = 1;
        CHECK(shot_echoes(&beam, true) == STATUS_OK);
        memset(sample, 0, sizeof sample);
        echo_sum(sample, radar.echoes);
        CHECK(sample[32] == 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rain_fills_the_main_lobe),
        cmocka_unit_test(crowns_are_filled),
        cmocka_unit_test(clouds_of_chaff),
        cmocka_unit_test(echoes_in_a_later_position),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
