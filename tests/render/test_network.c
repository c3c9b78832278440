/* Networks of thermal nodes, against closed forms (mpmath; Carslaw & Jaeger, Conduction of Heat in Solids, 1959) in one
 * call over the whole time; energy, memory of earlier steps, extremes. labels: physics */
#include "tests/check.h"
#include "render/heat/heat_network_private.h"

enum { most = 64 };

static Network *made(int nodes, const double *capacity_j_k, int links, const NetworkLink *link, int exchanges,
                     const NetworkExchange *exchange)
{
    Network *n = NULL;
    CHECK(heat_network_create(&n, &(NetworkShape){nodes, links, exchanges, capacity_j_k, link, exchange}) == STATUS_OK);
    CHECK(heat_network_nodes(n) == nodes);
    return n;
}

static void two_nodes(void **state)
{
    (void)state;
    const double      capacity_j_k[] = {5e4, 2e5};
    const NetworkLoad none[2] = {{0}};
    double            temp_k[] = {400, 290};
    Network          *n = made(2, capacity_j_k, 1, &(NetworkLink){0, 1, 40}, 0, NULL);
    CHECK(heat_network_step(temp_k, NULL, n, none, NULL, 600) == STATUS_OK);
    CHECK_NEAR(temp_k[0], 360.29542397627, 0.01);
    CHECK_NEAR(temp_k[1], 299.92614400593, 0.01);
    heat_network_destroy(n);
}

static void engine_and_hull(void **state)
{
    (void)state;
    const double      capacity_j_k[] = {1e5, 4e5};
    const NetworkLoad load[2] = {{.heat_w = 5000}, {.film_w_k = 80, .fluid_k = 290}};
    double            temp_k[] = {290, 290};
    Network          *n = made(2, capacity_j_k, 1, &(NetworkLink){1, 0, 60}, 0, NULL);
    CHECK(heat_network_step(temp_k, NULL, n, load, NULL, 3600) == STATUS_OK);
    CHECK_NEAR(temp_k[0], 373.63537380, 0.01);
    CHECK_NEAR(temp_k[1], 308.48284736, 0.01);
    CHECK(heat_network_step(temp_k, NULL, n, load, NULL, 1e6) == STATUS_OK);
    CHECK_NEAR(temp_k[0], 290 + 5000 / 80.0 + 5000 / 60.0, 0.01);
    CHECK_NEAR(temp_k[1], 290 + 5000 / 80.0, 0.01);
    heat_network_destroy(n);
}

/* 1 m2, to nothing and to surroundings of 280 K: as a load, and as a held node. */
static void radiating_steel(void **state)
{
    (void)state;
    const double          capacity_j_k[] = {39250, INFINITY}, sky_w = 0.9 * 5.670374419184429e-8 * pow(280, 4);
    const NetworkExchange sky = {0, 1, 0.9};
    const NetworkLoad     emits[1] = {{.emits_m2 = 0.9}}, under_sky[1] = {{.heat_w = sky_w, .emits_m2 = 0.9}};
    const NetworkLoad     none[2] = {{0}};
    double                temp_k[2] = {400, 280};
    Network              *n = made(1, capacity_j_k, 0, NULL, 0, NULL);
    CHECK(heat_network_step(temp_k, NULL, n, emits, NULL, 3600) == STATUS_OK);
    CHECK_NEAR(temp_k[0], 323.02835379, 0.01);
    temp_k[0] = 400;
    CHECK(heat_network_step(temp_k, NULL, n, under_sky, NULL, 600) == STATUS_OK);
    CHECK_NEAR(temp_k[0], 386.196673986, 0.01);
    heat_network_destroy(n);
    n = made(2, capacity_j_k, 0, NULL, 1, &sky);
    temp_k[0] = 400;
    CHECK(heat_network_step(temp_k, NULL, n, none, NULL, 600) == STATUS_OK);
    CHECK_NEAR(temp_k[0], 386.196673986, 0.01);
    temp_k[0] = 400;
    CHECK(heat_network_step(temp_k, NULL, n, none, NULL, 3600) == STATUS_OK);
    CHECK_NEAR(temp_k[0], 342.826760707, 0.01);
    CHECK(temp_k[1] == 280);
    heat_network_destroy(n);
}

/* Half of a slab, Bi = 1, as a chain of elements with nodes at their faces; second order in their number. */
static void slab(void **state)
{
    (void)state;
    double error[2][2];
    for (int fine = 0; fine < 2; fine++) {
        const int   elements = fine ? 40 : 10;
        double      capacity_j_k[most], temp_k[most], heat_j = 0;
        NetworkLink link[most];
        NetworkLoad load[most] = {{.film_w_k = 10, .fluid_k = 300}};
        for (int i = 0; i <= elements; i++) {
            capacity_j_k[i] = 0.1 * 1e6 / elements * (i % elements ? 1 : 0.5);
            temp_k[i] = 400;
            link[i] = (NetworkLink){i, i + 1, elements / 0.1};
        }
        Network     *n = made(elements + 1, capacity_j_k, elements, link, 0, NULL);
        const double before_j = heat_network_heat_j(n, temp_k);
        CHECK(heat_network_step(temp_k, &heat_j, n, load, NULL, 0.5 * 0.1 * 0.1 * 1e6) == STATUS_OK);
        CHECK_NEAR(heat_network_heat_j(n, temp_k) - before_j, heat_j, 1e-9 * fabs(heat_j));
        error[fine][0] = temp_k[0] - 350.452192790;
        error[fine][1] = temp_k[elements] - 377.252638342;
        heat_network_destroy(n);
    }
    for (int k = 0; k < 2; k++) {
        CHECK_NEAR(error[0][k], 0, 0.1);
        CHECK_NEAR(error[1][k], error[0][k] / 16, 0.003);
    }
}

/* C T' = heat + film (fluid - T), heat and fluid rising with time; then a film that rises from none. */
static void loads_that_change(void **state)
{
    (void)state;
    const double      capacity_j_k[] = {1e4}, dt_s = 900;
    const NetworkLoad from[1] = {{.heat_w = 100, .film_w_k = 5, .fluid_k = 280}};
    const NetworkLoad to[1] = {{.heat_w = 1000, .film_w_k = 5, .fluid_k = 310}};
    double            temp_k[1] = {300}, heat_j = 7;
    Network          *n = made(1, capacity_j_k, 0, NULL, 0, NULL);
    CHECK(heat_network_step(temp_k, &heat_j, n, from, to, dt_s) == STATUS_OK);
    const double tau_s = 2000, drive_k = 300, slope_k_s = (1000.0 / 5 + 310 - drive_k) / dt_s; /* of what T follows */
    const double want_k = drive_k + slope_k_s * (dt_s - tau_s) + slope_k_s * tau_s * exp(-dt_s / tau_s);
    CHECK_NEAR(temp_k[0], want_k, 0.001);
    CHECK_NEAR(heat_j - 7, 1e4 * (temp_k[0] - 300), 1e-5);
    const NetworkLoad still[1] = {{.fluid_k = 280}}, windy[1] = {{.film_w_k = 20, .fluid_k = 280}};
    temp_k[0] = 300;
    CHECK(heat_network_step(temp_k, NULL, n, still, windy, dt_s) == STATUS_OK);
    CHECK_NEAR(temp_k[0], 280 + 20 * exp(-0.5 * 20 * dt_s / 1e4), 0.01);
    heat_network_destroy(n);
}

/* ---- a vehicle-like network ---------------------------------------------------------------------- */

static double dice(int stream, int i) { return random_uniform(1942, (uint32_t)stream, 0, (uint64_t)i); }
static double dice_between(double low, double high, int stream, int i)
{
    return low * pow(high / low, dice(stream, i));
}

typedef struct Vehicle {
    double          capacity_j_k[most];
    NetworkLink     link[3 * most];
    NetworkExchange exchange[3 * most];
    NetworkLoad     load[most];
    double          temp_k[most];
} Vehicle;

static Network *random_vehicle(Vehicle *v, double low_j_k, double high_j_k, double low_k, double high_k, int held)
{
    for (int i = 0; i < most; i++) {
        v->capacity_j_k[i] = i < held ? INFINITY : dice_between(low_j_k, high_j_k, 0, i);
        v->temp_k[i] = dice_between(low_k, high_k, 1, i);
        v->load[i] = (NetworkLoad){500 * dice(2, i), 20 * dice(3, i), dice_between(low_k, high_k, 4, i), dice(5, i)};
    }
    for (int k = 0; k < 3 * most; k++) {
        const int a = k % most;
        v->link[k] = (NetworkLink){a, (a + 1 + (int)(5 * dice(6, k))) % most, dice_between(0.01, 1000, 7, k)};
        const int b = (a + 1 + (int)((most - 1) * dice(8, k))) % most;
        v->exchange[k] = (NetworkExchange){a, b, dice_between(1e-6, 10, 9, k)};
    }
    return made(most, v->capacity_j_k, 3 * most, v->link, 3 * most, v->exchange);
}

static void an_enclosure_of_one_temperature_stays(void **state)
{
    (void)state;
    static Vehicle v;
    Network       *n = random_vehicle(&v, 1e3, 1e6, 290, 290, 1);
    for (int i = 0; i < most; i++) v.load[i] = (NetworkLoad){.film_w_k = 20 * dice(3, i), .fluid_k = 290};
    for (int k = 0; k < 4; k++) CHECK(heat_network_step(v.temp_k, NULL, n, v.load, NULL, pow(10, 2 + k)) == STATUS_OK);
    for (int i = 0; i < most; i++) CHECK_NEAR(v.temp_k[i], 290, 1e-9);
    heat_network_destroy(n);
}

static void energy_is_kept(void **state)
{
    (void)state;
    static Vehicle v;
    for (int held = 0; held < 4; held += 3) {
        Network     *n = random_vehicle(&v, 1e3, 1e6, 250, 500, held);
        const double before_j = heat_network_heat_j(n, v.temp_k);
        double       heat_j = 0, turned_j = 0;
        for (int s = 0; s < 100; s++) {
            NetworkLoad  to[most];
            const double last_j = heat_j;
            for (int i = 0; i < most; i++)
                to[i] = (NetworkLoad){500 * dice(2, i + s), 20 * dice(3, i + s), 290, dice(5, i + s)};
            CHECK(heat_network_step(v.temp_k, &heat_j, n, v.load, to, 30) == STATUS_OK);
            memcpy(v.load, to, sizeof to);
            turned_j += fabs(heat_j - last_j);
        }
        CHECK(turned_j > 1e6);
        CHECK_NEAR((heat_network_heat_j(n, v.temp_k) - before_j - heat_j) / turned_j, 0, 1e-9);
        heat_network_destroy(n);
    }
}

static void held_nodes_stay(void **state)
{
    (void)state;
    static Vehicle v;
    Network       *n = random_vehicle(&v, 1e3, 1e6, 250, 500, 5);
    double         temp_k[most], heat_j = 3;
    memcpy(temp_k, v.temp_k, sizeof temp_k);
    v.load[0].heat_w = 1e9; /* a held node takes no notice */
    CHECK(heat_network_step(temp_k, &heat_j, n, v.load, NULL, 1000) == STATUS_OK);
    for (int i = 0; i < most; i++) CHECK((temp_k[i] == v.temp_k[i]) == (i < 5));
    heat_network_destroy(n);
    const double all[2] = {INFINITY, INFINITY};
    n = made(2, all, 1, &(NetworkLink){0, 1, 10}, 1, &(NetworkExchange){0, 1, 10});
    CHECK(heat_network_heat_j(n, temp_k) == 0);
    heat_j = 3;
    CHECK(heat_network_step(temp_k, &heat_j, n, v.load, NULL, 1000) == STATUS_OK && heat_j == 3);
    heat_network_destroy(n);
}

static void earlier_steps_are_forgotten(void **state)
{
    (void)state;
    static Vehicle      v;
    static const double dt_s[] = {1e5, 30, 1e-3, 1e3, 30, 7};
    double              area_m2[3 * most];
    for (int k = 0; k < 3 * most; k++) area_m2[k] = dice_between(1e-3, 10, 10, k);
    Network *used = random_vehicle(&v, 10, 1e8, 1, 2000, 2);
    for (int s = 0; s < 6; s++) {
        double   temp_k[2][most], heat_j[2] = {0, 0};
        Network *fresh = random_vehicle(&v, 10, 1e8, 1, 2000, 2);
        memcpy(temp_k[0], v.temp_k, sizeof v.temp_k);
        memcpy(temp_k[1], v.temp_k, sizeof v.temp_k);
        if (s >= 3) heat_network_exchange(used, area_m2);
        if (s >= 3) heat_network_exchange(fresh, area_m2);
        CHECK(heat_network_step(temp_k[0], &heat_j[0], used, v.load, NULL, dt_s[s]) == STATUS_OK);
        CHECK(heat_network_step(temp_k[1], &heat_j[1], fresh, v.load, NULL, dt_s[s]) == STATUS_OK);
        CHECK(memcmp(temp_k[0], temp_k[1], sizeof temp_k[0]) == 0 && heat_j[0] == heat_j[1]);
        v.temp_k[0] = NAN; /* and failures are */
        CHECK(heat_network_step(v.temp_k, NULL, used, v.load, NULL, 1) == STATUS_BAD_VALUE);
        heat_network_destroy(fresh);
    }
    heat_network_destroy(used);
}

/* 1 K to 2000 K, capacities of 10 to 1e8 J/K, steps of 1e-3 to 1e5 s: between the least and the most around. */
static void extremes(void **state)
{
    (void)state;
    static const double temps_k[] = {1, 300, 2000}, dt_s[] = {1e-3, 1, 600, 1e5}, capacity_j_k[] = {10, 1e5, 1e8};
    static Vehicle      v;
    for (int n = 0; n < 3 * 3 * 4 * 4; n++) {
        const int    c = n / 36;
        const double begin_k = temps_k[n % 3], around_k = temps_k[n / 3 % 3];
        const double low_k = fmin(begin_k, around_k), high_k = fmax(begin_k, around_k);
        const double least_j_k = c < 3 ? capacity_j_k[c] : 10, greatest_j_k = c < 3 ? capacity_j_k[c] : 1e8;
        Network     *net = random_vehicle(&v, least_j_k, greatest_j_k, begin_k, begin_k, 0);
        double       heat_j = 0;
        const double before_j = heat_network_heat_j(net, v.temp_k);
        for (int i = 0; i < most; i++)
            v.load[i] = (NetworkLoad){.film_w_k = dice_between(1e-3, 1e4, 3, i), .fluid_k = around_k};
        CHECK(heat_network_step(v.temp_k, &heat_j, net, v.load, NULL, dt_s[n / 9 % 4]) == STATUS_OK);
        for (int i = 0; i < most; i++)
            CHECK(v.temp_k[i] > low_k - 0.01 && v.temp_k[i] < high_k + 0.01 && v.temp_k[i] > 0);
        CHECK_NEAR(heat_network_heat_j(net, v.temp_k) - before_j, heat_j, 1e-6 * fabs(heat_j) + 1e-12 * before_j);
        heat_network_destroy(net);
    }
}

static void a_plate_under_open_sky_never_reaches_nothing(void **state)
{
    (void)state;
    const double      capacity_j_k[] = {10};
    const NetworkLoad load[1] = {{.emits_m2 = 10}}, drain[1] = {{.heat_w = -1e4}};
    double            temp_k[1] = {2000};
    Network          *n = made(1, capacity_j_k, 0, NULL, 0, NULL);
    CHECK(heat_network_step(temp_k, NULL, n, load, NULL, 1e5) == STATUS_OK);
    CHECK_NEAR(temp_k[0], pow(pow(2000, -3) + 3 * 5.670374419184429e-8 * 1e5, -1 / 3.0), 0.001);
    const double before_k = temp_k[0];
    CHECK(heat_network_step(temp_k, NULL, n, drain, NULL, 100) == STATUS_BAD_VALUE && temp_k[0] == before_k);
    heat_network_destroy(n);
}

static void wrong_shapes_and_steps_are_refused(void **state)
{
    (void)state;
    Network              *n = NULL;
    const double          good[] = {1, 2}, bad[][2] = {{0, 1}, {1, -1}, {NAN, 1}, {-INFINITY, 1}, {1e308, 1e308}};
    const NetworkLink     links[] = {{0, 2, 1}, {-1, 0, 1}, {1, 1, 1}, {0, 1, NAN}, {0, 1, -1}, {0, 1, INFINITY}};
    const NetworkExchange exchanges[] = {{2, 0, 1}, {0, -1, 1}, {0, 0, 1}, {0, 1, NAN}, {0, 1, -1}, {0, 1, INFINITY}};
    CHECK(heat_network_create(&n, &(NetworkShape){.nodes = 0, .capacity_j_k = good}) == STATUS_BAD_VALUE);
    CHECK(heat_network_create(&n, &(NetworkShape){.nodes = 2, .links = -1, .capacity_j_k = good}) == STATUS_BAD_VALUE);
    for (int k = 0; k < 5; k++)
        CHECK(heat_network_create(&n, &(NetworkShape){.nodes = 2, .capacity_j_k = bad[k]}) == STATUS_BAD_VALUE);
    for (int k = 0; k < 6; k++) {
        CHECK(heat_network_create(&n, &(NetworkShape){2, 1, 0, good, &links[k], NULL}) == STATUS_BAD_VALUE);
        CHECK(heat_network_create(&n, &(NetworkShape){2, 0, 1, good, NULL, &exchanges[k]}) == STATUS_BAD_VALUE);
    }
    CHECK(n == NULL);
    heat_network_destroy(NULL);
    n = made(2, good, 1, &(NetworkLink){0, 1, 3}, 0, NULL);
    static const double      wrong_dt_s[] = {0, -1, NAN, INFINITY}, wrong_k[] = {0, -5, NAN, INFINITY};
    static const NetworkLoad load[2] = {{.heat_w = 0}};
    static const NetworkLoad wrong[][2] = {
        {{.heat_w = NAN}}, {{.film_w_k = -1}}, {{.film_w_k = 1}, {.fluid_k = NAN}}, {{.emits_m2 = -1}}};
    double temp_k[2] = {300, 310};
    for (int k = 0; k < 4; k++) {
        CHECK(heat_network_step(temp_k, NULL, n, load, NULL, wrong_dt_s[k]) == STATUS_BAD_VALUE);
        CHECK(heat_network_step(temp_k, NULL, n, wrong[k], NULL, 1) == STATUS_BAD_VALUE);
        CHECK(heat_network_step(temp_k, NULL, n, load, wrong[k], 1) == STATUS_BAD_VALUE);
        CHECK(heat_network_step((double[]){300, wrong_k[k]}, NULL, n, load, NULL, 1) == STATUS_BAD_VALUE);
    }
    CHECK(temp_k[0] == 300 && temp_k[1] == 310);
    heat_network_destroy(n);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(two_nodes),
        cmocka_unit_test(engine_and_hull),
        cmocka_unit_test(radiating_steel),
        cmocka_unit_test(slab),
        cmocka_unit_test(loads_that_change),
        cmocka_unit_test(an_enclosure_of_one_temperature_stays),
        cmocka_unit_test(energy_is_kept),
        cmocka_unit_test(held_nodes_stay),
        cmocka_unit_test(earlier_steps_are_forgotten),
        cmocka_unit_test(extremes),
        cmocka_unit_test(a_plate_under_open_sky_never_reaches_nothing),
        cmocka_unit_test(wrong_shapes_and_steps_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
