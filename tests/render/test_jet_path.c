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

/* The balances of vehicle_load_private.h's text, solved in Python by Runge and Kutta's fourth order in 4000 steps: air
 * enters at 0.08 of the difference in speed along the axis, over the first 26 radii in proportion, and 0.6 of the flow
 * across it; weight of what is lighter than air of 288 K. Rows: metres along the axis, place, radius, excess and speed
 * on the axis: a free jet, one in a wind on the slant, a slow one of flames upright in a wind. */
static void jets_follow_their_balances(void **state)
{
    (void)state;
    static const struct {
        ExhaustJet jet;
        double     d[3], flow_mps[3], at[4][7];
    } c[] = {{{.radius_m = 0.1, .speed_mps = 50, .excess_k = 300},
              {1, 0, 0},
              {0, 0, 0},
              {{1, 0.999996, 0, 0.00225127, 0.143305, 300, 50},
               {2.6, 2.59984, 0, 0.0226081, 0.35287, 131.904, 21.9903},
               {5, 4.99558, 0, 0.156146, 0.763603, 57.5364, 9.63468},
               {8, 7.9476, 0, 0.671341, 1.24617, 34.0907, 5.87957}}},
             {{.radius_m = 0.15, .speed_mps = 20, .excess_k = 200},
              {0.6, 0.8, 0},
              {-2, 1, 0.5},
              {{1, 0.473068, 0.872452, 0.0482404, 0.534112, 92.507, 9.34371},
               {3, -0.0493091, 2.65379, 0.574239, 1.53393, 20.1945, 4.62802},
               {6, -2.02277, 4.63418, 1.64566, 2.14984, 10.1103, 4.62652}}},
             {{.radius_m = 0.1, .speed_mps = 4, .excess_k = 600},
              {0, 0, 1},
              {4, 0, 0},
              {{0.3, 0.267312, 0, 0.113236, 0.186542, 161.26, 4},
               {0.8, 0.758996, 0, 0.203587, 0.239696, 82.0443, 4},
               {1.5, 1.45197, 0, 0.302378, 0.299079, 48.7776, 4}}}};
    for (int k = 0; k < 3; k++) {
        JetPath path;
        jet_path(&path, &c[k].jet, origin, c[k].d, c[k].flow_mps, 288);
        for (int r = 0; r < 4 && c[k].at[r][0] > 0; r++) {
            const double *want = c[k].at[r];
            double        way_m = 0;
            int           i = 0;
            for (; i + 2 < path.count && way_m + v3_length(path.point[i].way_enu) < want[0]; i++)
                way_m += v3_length(path.point[i].way_enu);
            const JetPoint *a = &path.point[i], *b = a + 1;
            const double    share = (want[0] - way_m) / v3_length(a->way_enu);
            CHECK(share >= 0 && share <= 1);
            for (int x = 0; x < 3; x++)
                CHECK_NEAR(a->p_enu[x] + share * (b->p_enu[x] - a->p_enu[x]), want[1 + x],
                           x == 2 ? 0.03 * want[3] + 0.002 * want[0] : 0.02 * want[0]);
            CHECK_NEAR(a->radius_m + share * (b->radius_m - a->radius_m), want[4], 0.02 * want[4]);
            CHECK_NEAR(a->excess_k + share * (b->excess_k - a->excess_k), want[5], 0.03 * want[5]);
            CHECK_NEAR(a->speed_mps + share * (b->speed_mps - a->speed_mps), want[6], 0.03 * want[6]);
        }
    }
}

/* The same balances by the midpoint rule in steps of 0.4 radii, in Python: what a path's points are, on the slant in a
 * wind. Rows: place, radius, excess, speed. */
static void points_by_the_midpoint_rule(void **state)
{
    (void)state;
    static const struct {
        int    point;
        double at[6];
    } c[] = {{1, {0.0357570571, 0.0481811474, 9.95468447e-05, 0.161580172, 200, 20}},
             {5, {0.203084488, 0.292177672, 0.00422384712, 0.23589727, 200, 20}},
             {10, {0.473310927, 0.867361323, 0.0471214882, 0.529527479, 93.4222283, 9.42595988}},
             {15, {0.0908118381, 2.45614636, 0.488619485, 1.45469831, 22.3652689, 4.66336131}},
             {20, {-2.22340002, 4.79751565, 1.74844718, 2.19306817, 9.69598176, 4.63264343}},
             {25, {-5.89436108, 7.47311257, 3.62424106, 2.86231064, 5.55946146, 4.70956238}}};
    const double flow_mps[3] = {-2, 1, 0.5}, d[3] = {0.6, 0.8, 0};
    JetPath      path;
    jet_path(&path, &(ExhaustJet){.radius_m = 0.15, .speed_mps = 20, .excess_k = 200}, origin, d, flow_mps, 288);
    CHECK(path.count > 25);
    for (size_t k = 0; k < sizeof c / sizeof *c; k++) {
        const JetPoint *p = &path.point[c[k].point];
        const double    is[6] = {p->p_enu[0], p->p_enu[1], p->p_enu[2], p->radius_m, p->excess_k, p->speed_mps};
        for (int x = 0; x < 6; x++) CHECK_NEAR(is[x], c[k].at[x], 1e-8 * fmax(1, fabs(c[k].at[x])));
        double way2_m2 = 0;
        for (int x = 0; x < 3; x++) {
            CHECK_NEAR(p->way_enu[x], p[1].p_enu[x] - p->p_enu[x], 1e-12);
            way2_m2 += p->way_enu[x] * p->way_enu[x];
        }
        CHECK_NEAR(p->per_m2 * way2_m2, 1, 1e-12);
    }
}

/* A jet ends where it is less than 1 K over the air; before a wall a Gaussian of twice its excess is 1 K at the square
 * root of ln(2 excess) / 2 radii, which its boxes hold: of a jet that does not bend, about all points of a run. */
static void where_jets_end(void **state)
{
    (void)state;
    double  least_k = INFINITY, k, mps;
    JetPath path;
    for (int i = 0; i < 60; i++) {
        const ExhaustJet jet = {.radius_m = 0.05, .speed_mps = 3, .excess_k = 4 + 0.1 * i};
        const double     side[3] = {0, 3, 0};
        jet_path(&path, &jet, origin, ahead, side, 288);
        CHECK(path.count > 2 && path.count < jet_points && path.point[path.count - 1].excess_k >= 1);
        least_k = fmin(least_k, path.point[path.count - 1].excess_k);
        CHECK_NEAR(path.widest, 0.5 * log(2 * jet.excess_k), 1e-8);
    }
    CHECK(least_k < 1.05);
    const ExhaustJet jet = {.radius_m = 0.1, .speed_mps = 200, .excess_k = 30},
                     slow = {.radius_m = 0.1, .speed_mps = 0.5, .excess_k = 30};
    jet_path(&path, &jet, origin, ahead, still, 288);
    for (int r = 0; r * jet_run + jet_run < path.count; r++) {
        const JetPoint *first = &path.point[r * jet_run], *last = &path.point[(r + 1) * jet_run];
        const double    reach_m = last->radius_m * sqrt(0.5 * log(2 * first->excess_k));
        CHECK_NEAR(path.run[r].low_m[0], first->p_enu[0] - reach_m, 1e-9);
        CHECK_NEAR(path.run[r].high_m[0], last->p_enu[0] + reach_m, 1e-9);
        CHECK_NEAR(path.run[r].high_m[1], reach_m, 1e-9);
        CHECK(path.box.low_m[1] <= -reach_m && path.box.high_m[1] >= reach_m);
        const double edge[3] = {last->p_enu[0], 0.99 * last->radius_m * sqrt(0.5 * log(2 * last->excess_k)),
                                last->p_enu[2]},
                     out[3] = {edge[0], edge[1] * 1.02 / 0.99, edge[2]};
        CHECK(jet_path_at(&k, &mps, NULL, &path, edge, true) && k >= 1 &&
              !jet_path_at(&k, &mps, NULL, &path, out, true));
    }
    jet_path(&path, &slow, origin, ahead, still, 288);
    CHECK(path.count > 10);
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
        cmocka_unit_test(jets_follow_their_balances),
        cmocka_unit_test(points_by_the_midpoint_rule),
        cmocka_unit_test(where_jets_end),
        cmocka_unit_test(hostile_jets),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
