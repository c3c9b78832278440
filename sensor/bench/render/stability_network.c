/* sensor/bench/render/stability_network.c: networks of thermal nodes under stress: plates of 0.1 mm to 1 m, joined at
 * random, from 1 K to 2000 K. */
#include "sensor/bench/render/stability.h"

#include "render/heat/network.h"

enum { plates = 24, flows = 48 };

typedef struct Stress {
    double energy, excess; /* worst: shares of the heat exchanged; K beyond what is around */
} Stress;

static int another(Dice *dice, int a) { return (a + 1 + (int)dice_uniform(dice, 0, plates - 1)) % plates; }

static void one(Stress *worst, Dice *dice)
{
    double          capacity_j_k[plates], temp_k[plates], low_k = INFINITY, high_k = 0, heat_j = 0, gross_w = 0;
    NetworkLink     link[flows];
    NetworkExchange exchange[flows];
    NetworkLoad     load[plates];
    Network        *n = NULL;
    for (int i = 0; i < plates; i++) {
        const double area_m2 = dice_log(dice, 0.03, 25);
        capacity_j_k[i] = fmin(fmax(area_m2 * dice_log(dice, 1e-4, 1) * 3.9e6, 10), 1e8);
        temp_k[i] = dice_log(dice, 1, 2000);
        load[i] = (NetworkLoad){.film_w_k = area_m2 * dice_log(dice, 0.1, 1000), .fluid_k = dice_log(dice, 1, 2000)};
        low_k = fmin(low_k, fmin(temp_k[i], load[i].fluid_k)), high_k = fmax(high_k, fmax(temp_k[i], load[i].fluid_k));
        gross_w += load[i].film_w_k * load[i].fluid_k;
    }
    for (int k = 0; k < flows; k++) {
        const int a = k % plates;
        link[k] = (NetworkLink){a, another(dice, a), dice_log(dice, 1e-3, 1e4)};
        exchange[k] = (NetworkExchange){a, another(dice, a), dice_log(dice, 1e-6, 25)};
    }
    Status       status = network_create(&n, &(NetworkShape){plates, flows, flows, capacity_j_k, link, exchange});
    const double dt_s = dice_log(dice, 1e-3, 1e5), before_j = status == STATUS_OK ? network_heat_j(n, temp_k) : 0;
    if (status == STATUS_OK) status = network_step(temp_k, &heat_j, n, load, NULL, dt_s);
    if (status != STATUS_OK) {
        worst->energy = worst->excess = INFINITY;
    } else {
        const double lost_j = network_heat_j(n, temp_k) - before_j - heat_j;
        bench_worse(&worst->energy, fabs(lost_j) / (fabs(heat_j) + gross_w * dt_s + 1e-8 * before_j));
        for (int i = 0; i < plates; i++)
            bench_worse(&worst->excess, fmax(fmax(low_k - temp_k[i], temp_k[i] - high_k), 0));
    }
    network_destroy(n);
}

static double energy(void *user, bool quick)
{
    Stress *worst = user;
    Dice    dice = {.stream = 75};
    for (int n = quick ? 100 : 2000; n > 0; n--) one(worst, &dice);
    return worst->energy;
}

static double excess(void *user, bool quick)
{
    (void)quick;
    return ((Stress *)user)->excess;
}

Status stability_network(Bench *bench)
{
    static const StabilityCase cases[] = {
        {"network: 1 K to 2000 K, plates of 0.1 mm to 1 m, steps of 1 ms to 1e5 s: energy", energy, 1e-6, "exchanged",
         "stored against let in"},
        {"network: the same: temperatures", excess, 0.01, "K", "between the nodes and their surroundings"},
    };
    static Stress worst;
    stability_cases(bench, cases, sizeof cases / sizeof *cases, &worst);
    return STATUS_OK;
}
