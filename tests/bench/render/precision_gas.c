/* tests/bench/render/precision_gas.c: the number of grey gases that stand for hot CO2 in 3.4 .. 4.8 um, over a quarter
 * to four times 0.02 atm m. */
#include "tests/bench/suites.h"

#include "render/smoke/smoke.h"
#include "tests/bench/bench.h"

enum { settings = 4, columns = 5, temperatures = 3, rays = columns * temperatures };
static const double times[columns] = {0.25, 0.5, 1, 2, 4}, temp_k[temperatures] = {700, 1100, 1500};
static const double middle_atm_m = 0.02;

/* Narrow-band model (25 cm-1, Malkmus lines, parameters of Soufiani & Taine 1997), evaluated outside this program. */
static const double model[temperatures][columns] = {{0.1464, 0.1738, 0.1984, 0.2221, 0.2453},
                                                    {0.1505, 0.1890, 0.2208, 0.2483, 0.2732},
                                                    {0.1440, 0.1951, 0.2365, 0.2687, 0.2962}};

typedef struct GasSet {
    int    gases; /* hot_gas_terms: smoke_gas_through itself */
    double weight[temperatures][2][hot_gas_terms], rate[temperatures][hot_gas_terms];
    double seen[rays];
} GasSet;

/* Rates of the terms, as a thin column of each has them. */
static void rates(double rate[hot_gas_terms])
{
    static const double thin_atm_m = 1e-9;
    for (int j = 0; j < hot_gas_terms; j++) {
        double    one[2][hot_gas_terms] = {{0}};
        HotGasRay ray;
        smoke_gas_start(&ray);
        one[0][j] = 1;
        rate[j] =
            smoke_gas_through(&ray, HOT_GAS_MWIR, (HotGasColumn){thin_atm_m, 0}, (const double(*)[hot_gas_terms])one) /
            thin_atm_m;
    }
}

/* Neighbours made one, such that the column of the middle keeps its emissivity; a single one is a body of weight 1. */
static void make_gases(GasSet *s)
{
    double all[hot_gas_terms];
    rates(all);
    for (int t = 0; t < temperatures; t++) {
        smoke_gas_weights(s->weight[t], HOT_GAS_MWIR, temp_k[t]);
        const int each = hot_gas_terms / s->gases;
        for (int g = 0; g < s->gases && s->gases < hot_gas_terms; g++) {
            double weight = 0, seen = 0;
            for (int j = g * each; j < (g + 1) * each; j++) {
                weight += s->weight[t][0][j];
                seen -= s->weight[t][0][j] * expm1(-all[j] * middle_atm_m);
            }
            if (s->gases == 1) weight = 1;
            s->weight[t][0][g] = weight;
            s->rate[t][g] = weight > 0 ? -log1p(-seen / weight) / middle_atm_m : 0;
        }
    }
}

static void cross(void *user)
{
    GasSet *s = user;
    for (int t = 0; t < temperatures; t++)
        for (int c = 0; c < columns; c++) {
            const double atm_m = times[c] * middle_atm_m;
            double       seen = 0;
            if (s->gases == hot_gas_terms) {
                HotGasRay ray;
                smoke_gas_start(&ray);
                seen = smoke_gas_through(&ray, HOT_GAS_MWIR, (HotGasColumn){atm_m, 0},
                                         (const double(*)[hot_gas_terms])s->weight[t]);
            }
            for (int g = 0; g < s->gases && s->gases < hot_gas_terms; g++)
                seen += s->weight[t][0][g] * (1 - exp(-s->rate[t][g] * atm_m));
            s->seen[t * columns + c] = seen;
        }
    bench_keep(s->seen);
}

Status bench_precision_gas(Bench *bench)
{
    static const int         gases[settings] = {1, 2, 4, hot_gas_terms};
    static const char *const name[settings] = {"1, right in the middle", "2", "4", "8"};
    static GasSet            set[settings];
    BenchWork                work[settings];
    BenchSetting             point[settings] = {0};
    for (int k = 0; k < settings; k++) {
        set[k].gases = gases[k];
        make_gases(&set[k]);
        cross(&set[k]);
        for (int i = 0; i < rays; i++)
            bench_worst(&point[k].error, 100 * fabs(set[k].seen[i] / model[i / columns][i % columns] - 1));
        work[k] = (BenchWork){cross, &set[k], rays};
        point[k].setting = name[k];
        point[k].is_default = k == settings - 1;
    }
    bench_tunable(bench,
                  &(BenchTunable){"grey gases of hot gas", "render/smoke/smoke.h",
                                  "emissivity of CO2 on a ray, one band", "%",
                                  "largest, a quarter to four times 0.02 atm m, narrow-band model", 10},
                  work, point, settings);
    return STATUS_OK;
}
