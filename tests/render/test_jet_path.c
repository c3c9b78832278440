/* Exhaust jets, against published laws of jets and plumes: speed on the axis, fluxes, rise in a wind; places off the
 * axis. labels: physics */
#include "tests/check.h"

#include "render/heat/vehicle_load_private.h"

static const double ahead[3] = {1, 0, 0}, origin[3] = {0, 0, 0}, still[3] = {0, 0, 0};

/* Place on the axis where x is reached, or the last. */
static const JetPoint *at_x(const JetPath *path, double x_m)
{
    for (int i = 0; i < path->count; i++)
        if (path->point[i].p_enu[0] >= x_m) return &path->point[i];
    return &path->point[path->count - 1];
}

/* Pope, Turbulent Flows (2000), 5.1: U0/U = (x/D - 4)/5.8 .. 6.1. A scalar falls a tenth to a sixth lower: one profile
 * serves both here. */
static void free_jets_decay_as_measured(void **state)
{
    (void)state;
    const ExhaustJet jet = {.radius_m = 0.1, .speed_mps = 200, .excess_k = 30}; /* hardly buoyant */
    JetPath          path;
    jet_path(&path, &jet, origin, ahead, still, 288);
    for (double x_m = 3; x_m <= 8; x_m += 1) {
        const JetPoint *p = at_x(&path, x_m);
        const double    away = p->p_enu[0] / 0.2 - 4;
        if (getenv("SHOW"))
            print_message("%.2f m: %.3f, %.3f\n", p->p_enu[0], p->speed_mps / 200 * away, p->excess_k / 30 * away);
        CHECK_NEAR(p->speed_mps / 200 * away, 5.95, 0.6);
        CHECK_NEAR(p->excess_k / 30 * away, 5.95 * 0.88, 1.2);
        CHECK(fabs(p->p_enu[1]) < 1e-12 && p->p_enu[2] > 0 && p->p_enu[2] < 0.05);
    }
    CHECK(path.point[path.count - 1].excess_k >= 1);
}

/* Briggs (1984), bent-over plume with momentum: rise^3 = 3 Fm x/(0.6 U)^2 + 1.5 F x^2/(0.36 U^3), widening by 0.6 of
 * its rise. */
static void hot_gas_rises_in_a_wind_as_briggs_says(void **state)
{
    (void)state;
    const ExhaustJet jet = {.radius_m = 0.1, .speed_mps = 4, .excess_k = 600};
    const double     wind[3] = {4, 0, 0}, up[3] = {0, 0, 1}, air_k = 288;
    const double     flux = 9.80665 * jet.speed_mps * 0.01 * jet.excess_k / (air_k + jet.excess_k);
    JetPath          path;
    jet_path(&path, &jet, origin, up, wind, air_k);
    int compared = 0;
    for (int i = 0; i < path.count; i++) {
        const JetPoint *p = &path.point[i];
        const double    x_m = p->p_enu[0], mass = 0.01 * jet.speed_mps * air_k / (air_k + jet.excess_k), wide_m = 0.6;
        const double    from_m = sqrt(mass / wind[0]) / wide_m; /* its own width at the source */
        const double    cube = pow(from_m, 3) + 3 * mass * jet.speed_mps * x_m / pow(wide_m * wind[0], 2) +
                            1.5 * flux * x_m * x_m / (wide_m * wide_m * pow(wind[0], 3));
        const double rise_m = cbrt(cube) - from_m;
        if (getenv("SHOW")) print_message("%.2f m: %.3f over %.3f\n", p->p_enu[0], p->p_enu[2], rise_m);
        if (x_m < 1) continue;
        CHECK_NEAR(p->p_enu[2] / rise_m, 1, 0.15);
        compared++;
    }
    CHECK(compared > 3);
}

/* A horizontal jet of a diesel rises past two metres within six; a wind bends it; both keep their heat. */
static void wind_bends_and_heat_is_kept(void **state)
{
    (void)state;
    const ExhaustJet jet = {.radius_m = 0.12, .speed_mps = 12, .excess_k = 380};
    const double     side[3] = {0, 3, 0};
    JetPath          calm, bent;
    jet_path(&calm, &jet, origin, ahead, still, 288);
    jet_path(&bent, &jet, origin, ahead, side, 288);
    CHECK(at_x(&calm, 6)->p_enu[2] > 2);
    CHECK(calm.count > 10 && bent.count > 10 && bent.point[bent.count - 1].p_enu[1] > 2);
    const double given = 288.0 / 668 * 0.12 * 0.12 * 12 * 380;
    for (int i = 12; i < bent.count; i++) {
        const JetPoint *p = &bent.point[i];
        const double    k = 0.5 * p->excess_k, density = 288 / (288 + k), mps = 0.5 * p->speed_mps;
        if (!(p->speed_mps < 12 - 1e-9) || !(p->excess_k < 380 - 1e-9)) continue;
        CHECK_NEAR(density * p->radius_m * p->radius_m * mps * k / given, 1, 1e-6);
    }
}

static void places_off_the_axis(void **state)
{
    (void)state;
    const ExhaustJet jet = {.radius_m = 0.1, .speed_mps = 50, .excess_k = 300};
    JetPath          path;
    double           on_k, off_k, wall_k, speed_mps, from[3];
    jet_path(&path, &jet, origin, ahead, still, 288);
    const JetPoint *p = at_x(&path, 2);
    const double    off[3] = {p->p_enu[0], p->radius_m, p->p_enu[2]}, behind[3] = {-0.05, 0, 0}, away[3] = {2, 30, 0};
    CHECK(jet_path_at(&on_k, &speed_mps, from, &path, p->p_enu, false));
    CHECK_NEAR(on_k, p->excess_k, 1e-9);
    CHECK(from[0] < p->p_enu[0] - 2 * path.point[0].radius_m && from[0] > 0);
    CHECK(jet_path_at(&off_k, &speed_mps, NULL, &path, off, false));
    CHECK_NEAR(off_k / on_k, exp(-2), 0.03);
    CHECK(jet_path_at(&wall_k, &speed_mps, NULL, &path, off, true));
    CHECK_NEAR(wall_k / off_k, 2, 1e-9);
    CHECK(!jet_path_at(&off_k, &speed_mps, NULL, &path, behind, true) && off_k == 0);
    CHECK(!jet_path_at(&off_k, &speed_mps, NULL, &path, away, true) && off_k == 0);
}

/* Nothing, extremes and nonsense end, and give finite numbers. */
static void hostile_jets(void **state)
{
    (void)state;
    static const double value[] = {0, 1e-9, 0.1, 1000, 1e9, INFINITY, NAN, -1};
    enum { values = sizeof value / sizeof *value };
    for (int i = 0; i < values * values * values; i++) {
        const ExhaustJet jet = {.radius_m = value[i % values],
                                .speed_mps = value[i / values % values],
                                .excess_k = value[i / values / values]};
        const double     wind[3] = {value[i % values], 0, 0};
        JetPath          path;
        double           k, mps;
        jet_path(&path, &jet, origin, ahead, wind, 288);
        CHECK(path.count >= 0 && path.count <= jet_points);
        if (jet_path_at(&k, &mps, NULL, &path, origin, true)) CHECK(isfinite(k) && k >= 1);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(free_jets_decay_as_measured),
        cmocka_unit_test(hot_gas_rises_in_a_wind_as_briggs_says),
        cmocka_unit_test(wind_bends_and_heat_is_kept),
        cmocka_unit_test(places_off_the_axis),
        cmocka_unit_test(hostile_jets),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
