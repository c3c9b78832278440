/* Trunks and branches against closed forms: the film of a cylinder, sides in balance, a cylinder that cools. Over a
 * day: test_branch.c. labels: physics */
#include "tests/scenes/paper_day.h"

static const BranchKind pine = {1, 0.2, 550 * 2000.0, 0.7, 0.95};

/* Zukauskas (Advances in Heat Transfer 8, 1972), air: Nu = 0.51 Re^0.5 Pr^0.37 to 1000, 0.26 Re^0.6 Pr^0.37 to 2e5. */
static void film_of_a_cylinder(void **state)
{
    (void)state;
    static const double radius_m[] = {0.004, 0.012, 0.04, 0.12, 0.3}, wind_mps[] = {1, 3, 8};
    for (int r = 0; r < 5; r++)
        for (int w = 0; w < 3; w++) {
            const double re = wind_mps[w] * 2 * radius_m[r] / 1.5e-5;
            const double nu = re < 1000  ? 0.51 * sqrt(re) * pow(0.71, 0.37)
                              : re < 2e5 ? 0.26 * pow(re, 0.6) * pow(0.71, 0.37)
                                         : 0.076 * pow(re, 0.7) * pow(0.71, 0.37);
            CHECK_NEAR(heat_branch_film_w_m2k(radius_m[r], wind_mps[w]) / (nu * 0.025 / (2 * radius_m[r])), 1, 0.25);
        }
    /* Churchill & Bernstein, J. Heat Transfer 99, 1977 (Incropera & DeWitt eq. 7.54), worked out in Python for air of
     * Pr 0.71, 1.5e-5 m2/s, 0.025 W/(m K): Nu = 0.3 + 0.62 Re^(1/2) Pr^(1/3) / (1 + (0.4 / Pr)^(2/3))^(1/4)
     * (1 + (Re / 282000)^(5/8))^(4/5), Re = 533, 4800, 128000, 320000; calm air as that of 0.3 m/s, Re = 12000. */
    static const double film[][3] = {{0.004, 1, 36.5438825354537},
                                     {0.012, 3, 37.54503606642444},
                                     {0.12, 8, 26.52983649744248},
                                     {0.3, 8, 20.596519370516678},
                                     {0.3, 0, 2.472590970226595}};
    for (int i = 0; i < 5; i++) CHECK_NEAR(heat_branch_film_w_m2k(film[i][0], film[i][1]), film[i][2], 1e-9);
}

/* What a branch comes to in weather that does not change, by the balances of its sides. Mean: film (T - air) + e sigma
 * T^4 is what arrives: of the direct sun a quarter on branches that point everywhere, flat / pi on an upright trunk
 * (flat: the sun's level component); half of what sky and ground each send, the ground 0.15 of its light. A side that
 * goes as cosine of the angle is warmer by gain / (film + 4 e sigma T^3 + k / R), of twice the angle with 2 k / R: the
 * fields r and r^2 of a disc. Gains of the sun: a d / 2; of the sky over the ground, where it points everywhere: half
 * of their difference; of twice the angle, of an upright trunk: 2 / (3 pi) a flat. Trunks stand above 30 mm. Eight
 * rings hold the fields of sides to 2 %. */
static void sides_in_balance(void **state)
{
    (void)state;
    static const double     up_m[2][3] = {{0.8, 0.36, 0.48}, {0.6, -0.48, -0.64}};
    static const BranchKind wood[2] = {{1, 0.5, 1e4, 0.7, 0.95}, {1, 3, 1e4, 0.4, 0.6}};
    for (int c = 0; c < 16; c++) {
        const bool          upright = c & 1, down = c & 2;
        const BranchKind   *k = &wood[c / 4 % 2];
        const double        share = c < 8 ? 1 : 0.5, *d = up_m[down], radius_m = upright ? 0.0302 : 0.0298;
        const GroundWeather w = {.air = {285, 900, 101325, 2.5, 2, 10},
                                 .direct_w_m2 = 800,
                                 .diffuse_w_m2 = 120,
                                 .longwave_w_m2 = 300,
                                 .sun_d_enu = {d[0], d[1], d[2]}};
        Branch              b;
        BranchSides         got;
        heat_branch_start(&b, k, radius_m, 290);
        for (int s = 0; s < 60; s++) heat_branch_step(&b, &w, share, 295, 600);
        heat_branch_sides(&got, &b);
        const double film = heat_branch_film_w_m2k(radius_m, 2.5), direct = down ? 0 : share * 800, a = k->absorptance,
                     e = k->emissivity, flat = hypot(d[0], d[1]), t = (double)got.mean_k;
        const double sky = a * 120 + e * 300,
                     ground = a * 0.15 * (direct * (down ? 0 : d[2]) + 120) + e * stefan_w_m2k4 * pow(295, 4);
        CHECK_NEAR(film * (t - 285) + e * stefan_w_m2k4 * pow(t, 4),
                   a * direct * (upright ? flat / pi_rad : 0.25) + 0.5 * (sky + ground), 2e-3);
        const double loss = film + 4 * e * stefan_w_m2k4 * t * t * t, side = loss + k->conductivity_w_mk / radius_m,
                     twice = (loss + 2 * k->conductivity_w_mk / radius_m) * 3 * pi_rad / 2;
        for (int i = 0; i < 3; i++) {
            const double gain = i < 2 || !upright ? 0.5 * a * direct * d[i] : 0,
                         more = i == 2 && !upright ? 0.5 * (sky - ground) : 0;
            CHECK_NEAR((double)got.side_k[i], (gain + more) / side, 0.02 * fabs((gain + more) / side) + 1e-5);
        }
        const double narrow = upright ? a * direct * flat / twice : 0, ns = narrow / (flat * flat);
        CHECK_NEAR((double)got.twice_k[0], ns * (d[0] * d[0] - d[1] * d[1]), 0.02 * narrow + 1e-5);
        CHECK_NEAR((double)got.twice_k[1], ns * 2 * d[0] * d[1], 0.02 * narrow + 1e-5);
    }
}

/* A cylinder in air that turned colder: Incropera & DeWitt, eq. 5.52 and table 5.1 for Bi = film R / k = 1: middle over
 * start 1.2071 exp(-1.2558^2 Fo), face over middle J0(1.2558) = 0.6425. From Fo = 0.4 to 1, a first ring of an eighth.
 */
static void a_cylinder_cools(void **state)
{
    (void)state;
    const double        r = 0.12, film = heat_branch_film_w_m2k(r, 4), fo_s = r * r / (film * r) * 1e6; /* of Fo = 1 */
    const BranchKind    wood = {1, film * r, 1e6, 0, 0};
    const GroundWeather w = {.air = {280, 900, 101325, 4, 2, 10}, .sun_d_enu = {0, 0, 1}};
    Branch              b;
    heat_branch_start(&b, &wood, r, 290);
    for (int s = 1; s <= 1000; s++) {
        heat_branch_step(&b, &w, 1, 280, fo_s / 1000);
        if (s % 200 || s < 400) continue;
        const double middle = 1.2071 * exp(-1.2558 * 1.2558 * s / 1000), share = (b.face_k[0] - 280) / 10;
        CHECK_NEAR(share, 0.6425 * middle, 0.01 * 0.6425 * middle);
        CHECK_NEAR((b.part[0][branch_rings - 1] - 280) / 10, middle, 0.01 * middle);
    }
}

/* Steps of more than five minutes are taken in equal parts of at most that. */
static void long_steps_are_taken_in_parts(void **state)
{
    (void)state;
    static const double dt_s[] = {300, 300.0002, 600, 601, 900};
    static const int    parts[] = {1, 2, 2, 3, 3};
    GroundWeather       w;
    paper_weather(&w, paper_unix_s + 36000, &paper_summer);
    for (int c = 0; c < 5; c++) {
        Branch whole, part;
        heat_branch_start(&whole, &pine, 0.05, 285);
        heat_branch_start(&part, &pine, 0.05, 285);
        heat_branch_step(&whole, &w, 1, 290, dt_s[c]);
        for (int k = 0; k < parts[c]; k++) heat_branch_step(&part, &w, 1, 290, dt_s[c] / parts[c]);
        CHECK(memcmp(whole.part, part.part, sizeof part.part) == 0);
        CHECK(memcmp(whole.face_k, part.face_k, sizeof part.face_k) == 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(film_of_a_cylinder), cmocka_unit_test(sides_in_balance),
                                       cmocka_unit_test(a_cylinder_cools),
                                       cmocka_unit_test(long_steps_are_taken_in_parts)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
