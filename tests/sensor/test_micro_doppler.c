/* Micro-Doppler of what spins and rolls, and the cross-polarised channel, through the whole chain: a blade's flash
 * fills the range rates up to that of its tip, a wheel's those from its road contact to its top; a dihedral rolled by
 * 45 degrees returns the other polarisation. labels: physics slow */
#include "tests/sensor/radar_scene.h"

#include "render/scattering/field/radar_target_private.h"
#include "sensor/radar/window_private.h"

enum { BLADE, WHEEL, DIHEDRAL, PLATES };
static const double blade_m = 2, spin_rps = 6, wheel_m = 0.5, speed_mps = 8, plate_a_m = 0.3, plate_b_m = 0.4,
                    screen_m = 0.4, wall_m = 0.2;

static void quad(FILE *file, int first, double p[4][3])
{
    for (int i = 0; i < 4; i++) fprintf(file, "v %.9f %.9f %.9f\n", p[i][0], -p[i][2], p[i][1]);
    fprintf(file, "f %d %d %d %d\n", first, first + 1, first + 2, first + 3);
}

static int open_stage(void **state)
{
    (void)state;
    static const char *const model[] = {"blade", "wheel", "dihedral", "plates"};
    char                     sidecar[256];
    scene_folder();
    /* across the line of sight when at rest, 2 m to either side of its axis, which is upright; a body too small to
     * matter */
    snprintf(sidecar, sizeof sidecar, "joints:\n  - {nodes: \"blade*\", pivot: 0 0 0, axis: down, spin_rpm: %.9f}\n",
             spin_rps * 30 / pi_rad);
    FILE *file = scene_obj("blade", sidecar);
    int next = scene_box(file, "body", 1, (const double[3]){-1, -0.002, -1}, (const double[3]){-0.996, 0.002, -0.996});
    scene_box(file, "blade", next, (const double[3]){-0.01, -blade_m, -0.05}, (const double[3]){0.01, blade_m, 0.05});
    CHECK(fclose(file) == 0);
    snprintf(sidecar, sizeof sidecar, "joints:\n  - {nodes: \"wheel*\", pivot: centre, roll_radius: %.9f}\n", wheel_m);
    file = scene_obj("wheel", sidecar);
    next = scene_box(file, "body", 1, (const double[3]){-1, -0.002, 1}, (const double[3]){-0.996, 0.002, 1.004});
    scene_box(file, "wheel", next, (const double[3]){-0.01, -0.1, 0}, (const double[3]){0.01, 0.1, 2 * wheel_m});
    CHECK(fclose(file) == 0);
    /* two plates that meet at right angles in a line through the origin, rolled by 45 degrees, open to the front */
    file = scene_obj("dihedral", NULL);
    fputs("o dihedral\n", file);
    const double h = sqrt(0.5), along[3] = {0, h, h}, across[3] = {0, -h, h};
    for (int side = 0; side < 2; side++) {
        double p[4][3];
        for (int i = 0; i < 4; i++)
            for (int k = 0; k < 3; k++) {
                const double arm = (k == 0 ? h : 0) + (side ? 1 : -1) * h * across[k];
                p[side ? 3 - i : i][k] =
                    (i == 0 || i == 3 ? -0.5 : 0.5) * plate_b_m * along[k] + (i >= 2 ? plate_a_m : 0) * arm;
            }
        quad(file, 1 + 4 * side, p);
    }
    CHECK(fclose(file) == 0);
    /* two square plates, one behind the other; the first is gone from the destroyed one */
    file = scene_obj("plates", "damage:\n  destroyed: {hide: [screen]}\n");
    for (int behind = 0; behind < 2; behind++) {
        const double half = 0.5 * (behind ? wall_m : screen_m), x = behind ? -1 : 1;
        double       p[4][3] = {{x, -half, -half}, {x, half, -half}, {x, half, half}, {x, -half, half}};
        fputs(behind ? "o wall\n" : "o screen\n", file);
        quad(file, 1 + 4 * behind, p);
    }
    CHECK(fclose(file) == 0);
    scene_open(model, 4);
    return 0;
}

static int close_stage(void **state)
{
    (void)state;
    scene_close();
    return 0;
}

/* Power of each row of the map, over all ranges. */
static void spectrum_of(double *power, const RadarFrame *f)
{
    for (int y = 0; y < f->map.rows; y++) {
        power[y] = 0;
        for (int x = 0; x < f->map.columns; x++) {
            const double complex c = f->map.cell[(size_t)y * (size_t)f->map.columns + (size_t)x];
            power[y] += creal(c) * creal(c) + cimag(c) * cimag(c);
        }
    }
}

/* Range rates at which the spectrum of a line that is even from low to high falls to half of its mean within, a quarter
 * of its width from either end away. */
static void edges_of(double edge_mps[2], double *ripple_db, double *outside_db, const RadarFrame *f, double low_mps,
                     double high_mps)
{
    double       power[256], mean = 0, most = 0, outside = 0;
    const double step = f->map.mps_per_row;
    const int    middle = f->map.rows / 2, low = middle + (int)lround((low_mps - f->reference_rate_mps) / step),
              high = middle + (int)lround((high_mps - f->reference_rate_mps) / step), quarter = (high - low) / 4;
    CHECK(f->map.rows <= 256 && low > 8 && high < f->map.rows - 8);
    spectrum_of(power, f);
    for (int y = low + quarter; y <= high - quarter; y++) mean += power[y] / (high - low - 2 * quarter + 1);
    for (int y = low + quarter; y <= high - quarter; y++) most = fmax(most, fabs(10 * log10(power[y] / mean)));
    for (int end = 0; end < 2; end++) {
        const int way = end ? 1 : -1;
        int       y = end ? high - quarter : low + quarter;
        while (power[y + way] > 0.25 * mean) y += way; /* at the edge amplitudes are halved */
        const double share = (power[y] - 0.25 * mean) / (power[y] - power[y + way]);
        edge_mps[end] = f->reference_rate_mps + (y + way * share - middle) * step;
    }
    /* more than four cells outside: the Doppler window's main lobe ends there */
    for (int y = 0; y < f->map.rows; y++)
        if (y < low - 4 || y > high + 4) outside = fmax(outside, power[y]);
    *ripple_db = most;
    *outside_db = 10 * log10(outside / mean);
}

/* The tip's rate is spin times length: a spectrum 2 v / lambda to either side. */
static void a_blade_flashes_up_to_its_tip(void **state)
{
    (void)state;
    SeekerRadar *radar = scene_radar("search_ku", NULL);
    double       edge[2], ripple_db, outside_db;
    stage.snapshot.count = 0;
    SnapshotEntity *e = scene_add(BLADE, 0, 0, 0);
    e->drives.engine = 1;
    arena_reset(stage.arena);
    const RadarFrame *f = scene_measure(radar);
    const double      tip = blade_m * spin_rps;
    edges_of(edge, &ripple_db, &outside_db, f, -tip, tip);
    const double hz = 2 / f->preset->antenna.wavelength_m;
    print_message(
        "a blade whose tip moves at %.2f m/s: edges at %.2f and %.2f m/s (%.0f and %.0f Hz, 2 v / lambda %.0f), cells of %.2f; "
        "uneven by %.1f dB; beyond %.1f dB\n",
        tip, edge[0], edge[1], edge[0] * hz, edge[1] * hz, tip * hz, f->map.mps_per_row, ripple_db, outside_db);
    CHECK_NEAR(edge[0], -tip, 2 * f->map.mps_per_row);
    CHECK_NEAR(edge[1], tip, 2 * f->map.mps_per_row);
    CHECK(outside_db < -15);
    /* standing, all of it is at rest */
    e->drives.engine = 0;
    arena_reset(stage.arena);
    f = scene_measure(radar);
    double power[256], still = 0, all = 0;
    spectrum_of(power, f);
    for (int y = 0; y < f->map.rows; y++) all += power[y], still += abs(y - f->map.rows / 2) <= 3 ? power[y] : 0;
    CHECK(still > 0.999 * all);
    seeker_radar_destroy(radar);
}

/* Of a plate about the axle of a wheel that rolls towards the radar: the road contact stands still, the top moves at
 * twice the speed. */
static void a_wheel_is_still_where_it_stands(void **state)
{
    (void)state;
    SeekerRadar *radar = scene_radar("search_ku", NULL);
    double       edge[2], ripple_db, outside_db;
    const double v_enu_mps[3] = {speed_mps, 0, 0}, low = -2 * speed_mps, high = 0;
    stage.snapshot.count = 0;
    SnapshotEntity *e = scene_add(WHEEL, 0, 0, -wheel_m);
    m3_mul_v3(e->v_ecef_mps, stage.world.frame.r_ecef_from_enu, v_enu_mps);
    stage.scene.reference_v_enu_mps[0] = speed_mps;
    arena_reset(stage.arena);
    const RadarFrame *f = scene_measure(radar);
    stage.scene.reference_v_enu_mps[0] = 0;
    CHECK_NEAR(f->reference_rate_mps, -speed_mps, 1e-9);
    edges_of(edge, &ripple_db, &outside_db, f, low, high);
    print_message("a wheel at %.1f m/s: edges at %.2f and %.2f m/s; uneven by %.1f dB; beyond %.1f dB\n", speed_mps,
                  edge[0], edge[1], ripple_db, outside_db);
    CHECK_NEAR(edge[0], low, 2 * f->map.mps_per_row);
    CHECK_NEAR(edge[1], high, 2 * f->map.mps_per_row);
    CHECK(outside_db < -15);
    seeker_radar_destroy(radar);
}

/* 8 pi a^2 b^2 / lambda^2, all of it in the other polarisation. */
static void a_rolled_dihedral_turns_the_polarisation(void **state)
{
    (void)state;
    SeekerRadar *radar = scene_radar("search_ku", NULL);
    stage.snapshot.count = 0;
    scene_add(DIHEDRAL, 0, 0, 0);
    arena_reset(stage.arena);
    const RadarFrame *f = scene_measure(radar);
    const double      wave = f->preset->antenna.wavelength_m,
                 want = 10 * log10(8 * pi_rad * pow(plate_a_m * plate_b_m / wave, 2));
    const size_t plane = (size_t)f->map.rows * (size_t)f->map.columns;
    double       most[2] = {0, 0}, pulse[2] = {0, 0};
    for (size_t i = 0; i < plane; i++) {
        most[0] = fmax(most[0], cabs(f->map.cell[i]));
        most[1] = fmax(most[1], cabs(f->map.cell[CHANNEL_CROSS * plane + i]));
    }
    for (int x = 0; x < f->map.columns; x++)
        for (int p = 0; p < 2; p++) pulse[p] = fmax(pulse[p], cabs(f->profile[p * f->map.columns + x]));
    const double map_db = 20 * log10(most[1] / most[0]), profile_db = 20 * log10(pulse[1] / pulse[0]);
    print_message(
        "a dihedral rolled by 45 degrees: HV %.2f dBsm, on paper %.2f; HH %.2f; cross over co-polarised %.1f dB in the map, %.1f in "
        "the profile\n",
        10 * log10(f->target[0].rcs_m2[2]), want, 10 * log10(f->target[0].rcs_m2[0]), map_db, profile_db);
    CHECK_NEAR(10 * log10(f->target[0].rcs_m2[2]), want, 0.3);
    CHECK(f->target[0].rcs_m2[0] < 0.01 * f->target[0].rcs_m2[2]);
    CHECK_NEAR(map_db, 10 * log10(f->target[0].rcs_m2[2] / f->target[0].rcs_m2[0]), 1);
    CHECK(profile_db > 15);
    seeker_radar_destroy(radar);
}

/* 4 pi A^2 / lambda^2 of the plate in front; of a wreck, whose front plate is gone, that of the one behind: a quarter
 * of the area, 12 dB less. Slight and moderate damage hide nothing. What was made for one is not taken for another. */
static void a_wreck_lacks_what_its_damage_hides(void **state)
{
    (void)state;
    static const int damage[] = {0, 3, 1, 0, 2, 3};
    SeekerRadar     *radar = scene_radar("search_ku", NULL);
    for (int k = 0; k < 6; k++) {
        stage.snapshot.count = 0;
        SnapshotEntity *e = scene_add(PLATES, 0, 0, 0);
        e->appearance = (uint32_t)damage[k] << 3;
        arena_reset(stage.arena);
        const RadarFrame *f = scene_measure(radar);
        const double      side_m = damage[k] == 3 ? wall_m : screen_m, wave = f->preset->antenna.wavelength_m,
                     want = 10 * log10(4 * pi_rad * pow(side_m * side_m / wave, 2));
        print_message("damage %d: %.2f dBsm, on paper %.2f\n", damage[k], 10 * log10(f->target[0].rcs_m2[0]), want);
        CHECK_NEAR(10 * log10(f->target[0].rcs_m2[0]), want, 0.3);
        CHECK_NEAR(10 * log10(f->target[0].rcs_m2[1]), want, 0.3);
    }
    seeker_radar_destroy(radar);
}

/* Nor are there its edges: four of each plate, of which eight or four are left. */
static void a_wreck_lacks_its_hidden_edges(void **state)
{
    (void)state;
    static const int want[] = {8, 8, 8, 4};
    RadarTarget     *target;
    stage.snapshot.count = 0;
    const int model = scene_add(PLATES, 0, 0, 0)->model;
    CHECK(radar_target_create(&target, catalog_model(stage.catalog, model), NULL, "avx2") == STATUS_OK);
    for (int damage = 0; damage < 4; damage++) {
        radar_target_pose(target, NULL, damage);
        assert_int_equal(target->wedge_count, want[damage]);
    }
    radar_target_destroy(target);
}

/* Signal to noise of a plate's truth and of what is detected of it, by Skolnik's equation and the preset's own figures:
 * P G^2 lambda^2 sigma / ((4 pi)^3 R^4 L), times the energy of all pulses over k 290 K F, less what the two windows
 * lose; its cross section, range and closing speed. */
static void truth_and_detection_are_the_radar_equations(void **state)
{
    (void)state;
    SeekerRadar *radar = scene_radar("search_ku", NULL);
    const double v_enu_mps[3] = {speed_mps, 0, 0};
    stage.snapshot.count = 0;
    SnapshotEntity *e = scene_add(PLATES, 0, 0, 0);
    m3_mul_v3(e->v_ecef_mps, stage.world.frame.r_ecef_from_enu, v_enu_mps);
    arena_reset(stage.arena);
    const RadarFrame  *f = scene_measure(radar);
    const RadarPreset *p = f->preset;
    const RadarTruth  *t = &f->target[0];
    const double       wave = p->antenna.wavelength_m, n = p->antenna.taper;
    const double       gain = (2 * n + 1) / ((n + 1) * (n + 1)) * pow(pi_rad * p->antenna.diameter_m / wave, 2);
    WindowFigures      figures[2];
    double             weight[2][4096], bins = 1;
    for (int axis = 0; axis < 2; axis++) {
        const int count = axis ? p->wave.pulses : p->wave.samples;
        CHECK(count <= 4096 &&
              window_weights(weight[axis], count, axis ? &p->doppler_window : &p->range_window) == STATUS_OK);
        CHECK(window_figures(&figures[axis], weight[axis], count) == STATUS_OK);
        bins *= figures[axis].noise_bins;
    }
    const double rcs_m2 = t->rcs_m2[p->transmits_h ? 0 : 1];
    const double received_w =
        p->power_w * gain * gain * wave * wave * rcs_m2 / (pow(4 * pi_rad, 3) * pow(scene_range_m, 4) * p->loss);
    const double noise_j = 1.380649e-23 * 290 * p->receiver.noise_figure;
    const double want_db = 10 * log10(received_w * p->wave.pulse_s * p->wave.pulses / noise_j / bins);
    print_message(
        "a plate of %.2f dBsm at 1 km: signal to noise %.2f dB, on paper %.2f; detected: %.2f dB, %.2f dBsm\n",
        10 * log10(rcs_m2), 10 * log10(t->snr), want_db, 10 * log10(f->detection[0].snr),
        10 * log10(f->detection[0].rcs_m2));
    CHECK_NEAR(10 * log10(t->snr), want_db, 1e-3);
    CHECK_NEAR(10 * log10(f->detection[0].rcs_m2), 10 * log10(rcs_m2), 0.2);
    CHECK_NEAR(t->range_m, scene_range_m, 1e-6);
    CHECK_NEAR(t->range_rate_mps, -speed_mps, 1e-6); /* it comes nearer */
    CHECK_NEAR(f->detection[0].range_rate_mps, -speed_mps, 0.2 * f->map.mps_per_row);
    /* its plate is 1 m before its origin; and it appears nearer or farther by the waveform's coupling */
    CHECK_NEAR(f->detection[0].range_m, t->appears_m - 1, 0.2 * f->map.metre_per_column);
    CHECK_NEAR(t->appears_m - t->range_m, -speed_mps * p->wave.centre_hz * p->wave.pulse_s / p->wave.bandwidth_hz,
               1e-6);
    seeker_radar_destroy(radar);
}

/* What moves across the axis spreads the ground's range rate over the beam: 5 m/s across (3 to the right, 4 down),
 * whatever goes along, times the beam's width at half power, and two cells of Doppler. Looking west, right is north. */
static void the_notch_is_as_wide_as_the_beam(void **state)
{
    (void)state;
    SeekerRadar *radar = scene_radar("search_ku", NULL);
    const double v[3] = {-20, 3, -4};
    stage.snapshot.count = 0;
    memcpy(stage.scene.v_enu_mps, v, sizeof v);
    arena_reset(stage.arena);
    const RadarFrame  *f = scene_measure(radar);
    const RadarPreset *p = f->preset;
    memset(stage.scene.v_enu_mps, 0, sizeof v);
    const double cell_mps = 0.5 * p->antenna.wavelength_m * p->wave.repeat_hz / p->wave.pulses;
    CHECK_NEAR(f->map.mps_per_row, cell_mps, 1e-9);
    CHECK_NEAR(f->notch_mps, 5 * antenna_width_rad(&p->antenna) + 2 * cell_mps, 1e-9);
    CHECK_NEAR(f->ground_rate_mps, -20, 1e-9); /* it comes nearer */
    seeker_radar_destroy(radar);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_blade_flashes_up_to_its_tip),
        cmocka_unit_test(a_wheel_is_still_where_it_stands),
        cmocka_unit_test(a_rolled_dihedral_turns_the_polarisation),
        cmocka_unit_test(a_wreck_lacks_what_its_damage_hides),
        cmocka_unit_test(a_wreck_lacks_its_hidden_edges),
        cmocka_unit_test(truth_and_detection_are_the_radar_equations),
        cmocka_unit_test(the_notch_is_as_wide_as_the_beam),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
