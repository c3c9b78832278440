/* tests/bench/render/stability_heat.c: the ground's heat under stress: conduction over all sizes, all of the ground in
 * weathers at the ends of what there is; and networks of thermal nodes. */
#include "tests/bench/suites.h"
#include "tests/bench/stress.h"
#include "tests/scenes/heat_day.h"
#include "render/heat/heat_network_private.h"

#include <stdlib.h>

/* ---- conduction -------------------------------------------------------------------------------- */

typedef struct Around {
    double film_w_m2k, emissivity, temp_k;
} Around;

static double around_flux(double *falls, double temp_k, const void *law)
{
    const Around *a = law;
    *falls = a->film_w_m2k + 4 * a->emissivity * stefan_w_m2k4 * pow(fabs(temp_k), 3);
    return a->film_w_m2k * (a->temp_k - temp_k) + a->emissivity * stefan_w_m2k4 * (pow(a->temp_k, 4) - pow(temp_k, 4));
}

static void around_law(void *law, double share, const void *user)
{
    (void)share;
    *(Around *)law = *(const Around *)user;
}

typedef struct Worst {
    double excess, energy; /* shares: of the range; of the heat that moved */
} Worst;

/* Conducts heat for twenty steps in ground of one temperature with surroundings of another. */
static void conduct(Worst *worst, const ColumnLayer *layer, int layers, double first_m, double begin_k,
                    const Around *around, double dt_s)
{
    Column      column;
    ColumnState state;
    if (column_create(&column, layer, layers, first_m, 1.5) != STATUS_OK) {
        worst->excess = INFINITY;
        return;
    }
    column_start(&state, &column, begin_k);
    const ColumnBoundary b = {around_flux, around_law, around, 0, 0.001};
    const double         low_k = fmin(begin_k, around->temp_k), high_k = fmax(begin_k, around->temp_k),
                 range_k = high_k - low_k;
    const double begin_j_m2 = column_heat_j_m2(&state, &column);
    const double gross_w_m2 = around->film_w_m2k * high_k + around->emissivity * stefan_w_m2k4 * pow(high_k, 4);
    double       turned = 0, last = begin_j_m2;
    for (int s = 0; s < 20; s++) {
        column_step(&state, &column, NULL, &b, dt_s);
        for (int i = 0; i < column.nodes; i++) /* 5e-3: rounding, where there is no range */
            bench_worse(&worst->excess,
                        fmax(fmax(low_k - state.temp_k[i], state.temp_k[i] - high_k), 0) / (range_k + 5e-3) +
                            0 * state.temp_k[i]);
        const double now = column_heat_j_m2(&state, &column);
        turned += fabs(now - last);
        last = now;
    }
    /* of what went either way: at equilibrium nothing moves, and 1 um conducts 1e9 W/m2 per kelvin of rounding */
    bench_worse(&worst->energy,
                fabs(last - begin_j_m2 - state.heat_j_m2) / (turned + 20 * dt_s * gross_w_m2 + 1e-8 * begin_j_m2));
}

static Worst conduct_all(bool quick)
{
    static const double temps_k[] = {1, 300, 2000}, thick_m[] = {1e-6, 1e-3, 1}, dt_s[] = {1e-3, 1, 600, 1e5},
                        conducts[] = {0.02, 1, 400};
    Worst worst = {0, 0};
    Dice  dice = {.stream = 70};
    for (int a = 0; a < 9; a++)
        for (int t = 0; t < 3; t++)
            for (int d = 0; d < 4; d++)
                for (int k = 0; k < 3; k++)
                    conduct(&worst, &(ColumnLayer){thick_m[t], conducts[k], 2e6}, 1, thick_m[t] / 4, temps_k[a / 3],
                            &(Around){5, 0.9, temps_k[a % 3]}, dt_s[d]);
    for (int n = quick ? 200 : 4000; n > 0; n--) {
        ColumnLayer layer[3];
        const int   layers = 1 + n % 3;
        double      thinnest_m = INFINITY;
        for (int l = 0; l < layers; l++) {
            layer[l] = (ColumnLayer){stress_log_uniform(&dice, 1e-6, 1), stress_log_uniform(&dice, 0.02, 400),
                                     stress_log_uniform(&dice, 1e4, 4.2e6)};
            thinnest_m = fmin(thinnest_m, layer[l].thickness_m);
        }
        conduct(&worst, layer, layers, fmax(0.3 * thinnest_m, 1e-6), stress_log_uniform(&dice, 1, 2000),
                &(Around){stress_log_uniform(&dice, 0.1, 1000), stress_uniform(&dice, 0, 1),
                          stress_log_uniform(&dice, 1, 2000)},
                stress_log_uniform(&dice, 1e-3, 1e5));
    }
    return worst;
}

typedef struct HeatStress {
    GroundKinds kinds;
    Arena      *arena;
    Worst       worst; /* of conduct_all, with which the first case begins */
} HeatStress;

static double out_of_range(void *user, bool quick)
{
    HeatStress *s = user;
    s->worst = conduct_all(quick);
    return 100 * s->worst.excess;
}

static double energy_lost(void *user, bool quick)
{
    (void)quick;
    return ((HeatStress *)user)->worst.energy;
}

/* ---- all of the ground -------------------------------------------------------------------------- */

static const struct {
    const char *name;
    double      latitude_deg, declination_deg;
} suns[] = {{"polar day", 80, 23.4}, {"polar night", 80, -23.4}, {"sun at the zenith", 23.4, 23.4}};
enum { extreme_days = 3 * 2 * 2 };

static HeatDay extreme_day(int n)
{
    return (HeatDay){.latitude_rad = suns[n % 3].latitude_deg * rad_per_deg,
                     .declination_rad = suns[n % 3].declination_deg * rad_per_deg,
                     .wind_mps = n / 3 % 2 ? 60 : 0,
                     .air_k = n / 6 ? 330 : 220,
                     .humidity = n / 6 ? 0.1 : 0.8};
}

static HeatConfig config_of(const HeatDay *day, double step_s, int facets, double unix_s, Pool *pool)
{
    HeatConfig c = heat_default_config();
    c.step_s = step_s, c.facets = facets, c.unix_s = unix_s, c.weather = heat_day, c.user = day, c.pool = pool;
    return c;
}

/* Values that are not finite, or beyond 150 .. 400 K. */
static double wrong_values(const HeatNow *now, Dice *dice)
{
    const GroundHeatTable *t = &now->table;
    double                 wrong = 0;
    for (int k = 1; k < ground_kinds; k++) {
        for (int i = 0; i < t->facets * t->facets; i++) wrong += !(t->sun_k[k][i] >= 150 && t->sun_k[k][i] <= 400);
        for (int i = 0; i < heat_ups; i++)
            wrong += !(t->shade_k[k][i] >= 150 && t->shade_k[k][i] <= 400) +
                     !(t->dark_k[k][i] >= 150 && t->dark_k[k][i] <= 400);
        wrong += !(t->hidden_k[k] >= 150 && t->hidden_k[k] <= 400);
        for (int s = 0; s < now->slots; s++) wrong += !isfinite(t->slot_k[k][s]);
        for (int n = 0; n < 20; n++) {
            uint8_t shadow[heat_day_slots] = {0};
            double  normal[3];
            stress_direction(normal, dice);
            for (int s = 0; s < now->slots; s++) shadow[s] = (uint8_t)stress_uniform(dice, 0, 256);
            const double taken = heat_taken(now, k, normal, shadow),
                         temp_k = heat_ground_k(now, k, normal, taken, stress_uniform(dice, 0, 1), 1);
            wrong += !(taken >= 0 && taken <= 1) + !(temp_k >= 150 && temp_k <= 400);
        }
    }
    return wrong;
}

/* Computes the error over hours_h from the beginning. */
static double wrong_of(const HeatStress *s, const HeatConfig *config, double hours_h, int looks)
{
    Heat  *heat = NULL;
    Dice   dice = {.stream = 71};
    double wrong = 0;
    if (heat_create(&heat, &s->kinds, config, NULL, 0) != STATUS_OK) return INFINITY;
    for (int i = 0; i <= looks; i++) {
        HeatNow *now;
        arena_reset(s->arena);
        if (heat_now(&now, heat, config->unix_s + 3600 * hours_h * i / looks, s->arena) != STATUS_OK) wrong = INFINITY;
        else wrong += wrong_values(now, &dice);
    }
    heat_destroy(heat);
    return wrong;
}

static double extremes(void *user, bool quick)
{
    double wrong = 0;
    for (int n = 0; n < extreme_days; n++) {
        const HeatDay day = extreme_day(n);
        HeatConfig    c = config_of(&day, quick ? 3600 : 600, quick ? 3 : 7, heat_day_unix_s + 6 * 3600, NULL);
        c.spin_up_s = quick ? 12 * 3600 : 2 * 86400;
        wrong += wrong_of(user, &c, quick ? 8 : 24, 4);
    }
    return wrong;
}

static double grids_and_dates(void *user, bool quick)
{
    static const double steps_s[] = {60, 3600}, dates_s[] = {-631152000 + 0.25, 3786912000 - 1e-3};
    static const int    facets[] = {3, 17};
    double              wrong = 0;
    for (int n = 0; n < 8; n++) {
        const HeatDay day = extreme_day(2 + 3 * (n % 4));
        const double  step_s = steps_s[n & 1];
        HeatConfig    c = config_of(&day, step_s, facets[n >> 1 & 1], dates_s[n >> 2], NULL);
        if (quick && (n == 2 || n == 4 || n == 6)) continue; /* many columns, many steps; half of the rest */
        c.spin_up_s = quick ? (step_s < 3600 ? 1800 : 4 * 3600) : step_s < 3600 ? 6 * 3600 : 86400;
        wrong += wrong_of(user, &c, step_s < 3600 ? 0.2 : 6, 2);
    }
    return wrong;
}

static size_t now_octets(const HeatNow *now, const void *part[3], size_t octets[3])
{
    part[0] = &now->table, octets[0] = sizeof now->table;
    part[1] = now->past, octets[1] = sizeof now->past;
    part[2] = now->slot_d_enu, octets[2] = sizeof now->slot_d_enu;
    return 3;
}

static double now_differs(const HeatNow *a, const HeatNow *b)
{
    const void *pa[3], *pb[3];
    size_t      na[3], nb[3];
    double      different = a->slots != b->slots;
    now_octets(b, pb, nb);
    for (size_t k = now_octets(a, pa, na); k-- > 0;)
        for (size_t i = 0; i < na[k]; i++) different += ((const char *)pa[k])[i] != ((const char *)pb[k])[i];
    return different;
}

static double threads_agree(void *user, bool quick)
{
    HeatStress *s = user;
    Heat       *heat[2] = {NULL, NULL};
    Pool       *pool = NULL;
    HeatDay     day = heat_day_default();
    HeatConfig  c = config_of(&day, 1800, quick ? 3 : 7, heat_day_unix_s + 9 * 3600, NULL);
    double      different = pool_create(&pool, 7) == STATUS_OK ? 0 : INFINITY;
    c.spin_up_s = 86400;
    arena_reset(s->arena);
    for (int k = 0; k < 2 && different == 0; k++, c.pool = pool)
        if (heat_create(&heat[k], &s->kinds, &c, NULL, 0) != STATUS_OK) different = INFINITY;
    for (int i = 0; i < 6 && isfinite(different); i++) {
        HeatNow *now[2];
        for (int k = 0; k < 2 && isfinite(different); k++)
            if (heat_now(&now[k], heat[k], c.unix_s + 1000 * i, s->arena) != STATUS_OK) different = INFINITY;
        if (isfinite(different)) different += now_differs(now[0], now[1]);
    }
    heat_destroy(heat[0]);
    heat_destroy(heat[1]);
    pool_destroy(pool);
    return different;
}

/* Moves one object to times in any order, and compares it with an object of its own for each time. */
static double back_in_time(void *user, bool quick)
{
    static const double at_s[] = {20000, 100, 0, 7300, 7300, -1e6, 3599.5, 20000, 1};
    HeatStress         *s = user;
    Heat               *heat = NULL;
    HeatDay             day = heat_day_default();
    HeatConfig          c = config_of(&day, quick ? 3600 : 600, 3, heat_day_unix_s + 9 * 3600 + 17, NULL);
    double              different = 0;
    c.spin_up_s = 86400;
    if (heat_create(&heat, &s->kinds, &c, NULL, 0) != STATUS_OK) return INFINITY;
    for (size_t i = 0; i < sizeof at_s / sizeof *at_s; i++) {
        Heat    *fresh = NULL;
        HeatNow *now[2];
        arena_reset(s->arena);
        Status status = heat_create(&fresh, &s->kinds, &c, NULL, 0);
        if (status == STATUS_OK) status = heat_now(&now[0], heat, c.unix_s + at_s[i], s->arena);
        if (status == STATUS_OK) status = heat_now(&now[1], fresh, c.unix_s + at_s[i], s->arena);
        different += status == STATUS_OK ? now_differs(now[0], now[1]) : INFINITY;
        heat_destroy(fresh);
    }
    heat_destroy(heat);
    return different;
}

Status bench_stability_heat(Bench *bench)
{
    static const StressCase cases[] = {
        {"heat: 1 K to 2000 K, layers of 1 um to 1 m, steps of 1 ms to 1e5 s", out_of_range, 2, "% of the range",
         "between the ground and its surroundings"},
        {"heat: the same: energy", energy_lost, 1e-6, "exchanged", "stored against let in"},
        {"heat: polar day and night, zenith, 0 and 60 m/s, 220 and 330 K", extremes, 0, "values", "150 .. 400 K"},
        {"heat: 1950 and 2090, steps of 60 and 3600 s, 3 and 17 facets", grids_and_dates, 0, "values", "150 .. 400 K"},
        {"heat: seven threads", threads_agree, 0, "octets differ", "no pool"},
        {"heat: back and forth in time", back_in_time, 0, "octets differ", "straight to each time"},
    };
    static HeatStress s;
    s.arena = arena_create();
    const Status status = s.arena ? heat_day_kinds(&s.kinds) : STATUS_NO_MEMORY;
    if (status == STATUS_OK) stress_cases(bench, cases, sizeof cases / sizeof *cases, &s);
    arena_destroy(s.arena);
    return status;
}

/* ---- networks ----------------------------------------------------------------------------------- */

/* Plates of 0.1 mm to 1 m, joined at random, from 1 K to 2000 K. */

enum { plates = 24, flows = 48 };

typedef struct NetworkStress {
    double energy, excess; /* worst: shares of the heat exchanged; K beyond what is around */
} NetworkStress;

static int another(Dice *dice, int a) { return (a + 1 + (int)stress_uniform(dice, 0, plates - 1)) % plates; }

static void step_once(NetworkStress *worst, Dice *dice)
{
    double          capacity_j_k[plates], temp_k[plates], low_k = INFINITY, high_k = 0, heat_j = 0, gross_w = 0;
    NetworkLink     link[flows];
    NetworkExchange exchange[flows];
    NetworkLoad     load[plates];
    Network        *n = NULL;
    for (int i = 0; i < plates; i++) {
        const double area_m2 = stress_log_uniform(dice, 0.03, 25);
        capacity_j_k[i] = fmin(fmax(area_m2 * stress_log_uniform(dice, 1e-4, 1) * 3.9e6, 10), 1e8);
        temp_k[i] = stress_log_uniform(dice, 1, 2000);
        load[i] = (NetworkLoad){.film_w_k = area_m2 * stress_log_uniform(dice, 0.1, 1000),
                                .fluid_k = stress_log_uniform(dice, 1, 2000)};
        low_k = fmin(low_k, fmin(temp_k[i], load[i].fluid_k)), high_k = fmax(high_k, fmax(temp_k[i], load[i].fluid_k));
        gross_w += load[i].film_w_k * load[i].fluid_k;
    }
    for (int k = 0; k < flows; k++) {
        const int a = k % plates;
        link[k] = (NetworkLink){a, another(dice, a), stress_log_uniform(dice, 1e-3, 1e4)};
        exchange[k] = (NetworkExchange){a, another(dice, a), stress_log_uniform(dice, 1e-6, 25)};
    }
    Status       status = heat_network_create(&n, &(NetworkShape){plates, flows, flows, capacity_j_k, link, exchange});
    const double dt_s = stress_log_uniform(dice, 1e-3, 1e5),
                 before_j = status == STATUS_OK ? heat_network_heat_j(n, temp_k) : 0;
    if (status == STATUS_OK) status = heat_network_step(temp_k, &heat_j, n, load, NULL, dt_s);
    if (status != STATUS_OK) {
        worst->energy = worst->excess = INFINITY;
    } else {
        const double lost_j = heat_network_heat_j(n, temp_k) - before_j - heat_j;
        bench_worse(&worst->energy, fabs(lost_j) / (fabs(heat_j) + gross_w * dt_s + 1e-8 * before_j));
        for (int i = 0; i < plates; i++)
            bench_worse(&worst->excess, fmax(fmax(low_k - temp_k[i], temp_k[i] - high_k), 0));
    }
    heat_network_destroy(n);
}

static double network_energy(void *user, bool quick)
{
    NetworkStress *worst = user;
    Dice           dice = {.stream = 75};
    for (int n = quick ? 100 : 2000; n > 0; n--) step_once(worst, &dice);
    return worst->energy;
}

static double network_excess(void *user, bool quick)
{
    (void)quick;
    return ((NetworkStress *)user)->excess;
}

Status bench_stability_network(Bench *bench)
{
    static const StressCase cases[] = {
        {"network: 1 K to 2000 K, plates of 0.1 mm to 1 m, steps of 1 ms to 1e5 s: energy", network_energy, 1e-6,
         "exchanged", "stored against let in"},
        {"network: the same: temperatures", network_excess, 0.01, "K", "between the nodes and their surroundings"},
    };
    static NetworkStress worst;
    stress_cases(bench, cases, sizeof cases / sizeof *cases, &worst);
    return STATUS_OK;
}
