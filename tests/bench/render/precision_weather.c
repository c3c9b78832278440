/* tests/bench/render/precision_weather.c: the air by the weather at the ground against values that others computed:
 * LOWTRAN7's own atmospheres, longwave formulas, rain, the sun that heats, the sky below the horizontal. */
#include "tests/bench/suites.h"

#include "tests/bench/bench.h"
#include "tests/bench/render/air_bench.h"

/* Air at the ground of LOWTRAN7's atmospheres, vapour in ppmv at a pressure; in haze of 23 km the transmittance of
 * level paths of 2, 5 and 10 km: of sunlight in 0.7-1.1 um, of 300 K in 3.4-4.8 and 8-12 um. */
static const struct {
    double temp_k, ppmv, hpa, tau[3][3];
} lowtran[] = {
    {299.7,
     25930,
     1013,
     {{0.706173, 0.48789, 0.280216}, {0.389646, 0.228994, 0.118985}, {0.438627, 0.15798, 0.0335074}}},
    {294.2,
     18760,
     1013,
     {{0.720661, 0.501992, 0.290253}, {0.422583, 0.265557, 0.148707}, {0.575701, 0.295026, 0.105837}}},
    {272.2, 4316, 1018, {{0.768396, 0.552001, 0.328093}, {0.508422, 0.37491, 0.25758}, {0.850842, 0.718897, 0.55974}}},
    {287.2,
     11940,
     1010,
     {{0.738968, 0.520701, 0.304193}, {0.459905, 0.3102, 0.189403}, {0.704347, 0.468781, 0.250903}}},
    {257.2, 1405, 1013, {{0.788699, 0.574779, 0.346356}, {0.537155, 0.414552, 0.30302}, {0.90903, 0.82502, 0.716156}}},
    {288.2,
     7745,
     1013,
     {{0.755445, 0.539045, 0.319148}, {0.486794, 0.346891, 0.228148}, {0.79742, 0.625655, 0.434387}}},
};

static double worst_tau(AirBench *s, AirBand band)
{
    static const double range_m[] = {2000, 5000, 10000};
    double              worst = 0;
    for (size_t i = 0; i < sizeof lowtran / sizeof *lowtran; i++) {
        const Atmosphere *air;
        const AirState    state = {23000, lowtran[i].temp_k,
                                   lowtran[i].ppmv * 1e-6 * lowtran[i].hpa * 100 / (461.52 * lowtran[i].temp_k)};
        arena_reset(s->arena);
        if (atmosphere_in(&air, s->atmosphere, &state, 1u << band, s->arena) != STATUS_OK) return INFINITY;
        for (int r = 0; r < 3; r++) {
            const AirPath path = {0, 0, range_m[r], pi_rad, 0};
            PathAir       got;
            atmosphere_path(&got, air, 23000, band, &path, 300);
            bench_worse(&worst, (band == AIR_NIR ? got.sun_transmittance : got.transmittance) -
                                    lowtran[i].tau[band - AIR_NIR][r]);
        }
    }
    return fabs(worst);
}

/* Prata, Q. J. R. Meteorol. Soc. 122 (1996): emissivity 1 - (1 + w) exp(-sqrt(1.2 + 3 w)), w = 46.5 e / T, e in hPa. */
static double worst_longwave(AirBench *s)
{
    static const double state[][2] = {{308, 0.15}, {308, 0.5}, {308, 0.85}, {293, 0.3}, {293, 0.8}, {278, 0.7}};
    double              worst = 0;
    for (size_t i = 0; i < sizeof state / sizeof *state; i++) {
        const Atmosphere *air;
        Weather           weather = weather_default();
        weather.air_temp_k = state[i][0], weather.humidity = state[i][1];
        arena_reset(s->arena);
        if (daylight_air(&air, s->atmosphere, &weather, 1u << AIR_LWIR, s->arena) != STATUS_OK) return INFINITY;
        const double e_hpa = state[i][1] * weather_saturation_pa(state[i][0]) / 100;
        const double w = 46.5 * e_hpa / state[i][0], black = 5.670374e-8 * pow(state[i][0], 4);
        const double want = (1 - (1 + w) * exp(-sqrt(1.2 + 3 * w))) * black;
        const double got = atmosphere_longwave_down(air, 23000) * pow(state[i][0] / atmosphere_temp_k(air, 0), 4);
        bench_worse(&worst, 100 * (got / want - 1));
    }
    return fabs(worst);
}

/* ITU-R P.1814: 1.076 R^0.67 dB/km in every band. */
static double worst_rain(AirBench *s)
{
    static const double rate_mm_h[] = {0.5, 2, 20, 100};
    double              worst = 0;
    for (size_t i = 0; i < sizeof rate_mm_h / sizeof *rate_mm_h; i++) {
        Droplets drops;
        Weather  weather = weather_default();
        weather.rain_mm_h = rate_mm_h[i];
        droplets_of(&drops, s->atmosphere, &weather, 0.9);
        for (int b = 0; b < AIR_BAND_COUNT; b++) {
            const double db_km = drops.layer[0].per_m[b] * 1000 * 10 / log(10);
            bench_worse(&worst, db_km - 1.076 * pow(rate_mm_h[i], 0.67));
        }
    }
    return fabs(worst);
}

/* Direct light facing the sun by Bird (pvlib 0.16.1), 15 mm of water, at sea level, from 25 degrees up; optical depths
 * of LOWTRAN7's haze (tests/render/test_solar.c). */
static double worst_sun(AirBench *s)
{
    static const double row[][3] = {{50e3, 90, 896.7}, {50e3, 60, 862.4}, {50e3, 40, 783.3}, {50e3, 25, 654.8},
                                    {23e3, 90, 793.5}, {23e3, 60, 750.2}, {23e3, 40, 652.6}, {23e3, 25, 501.5}};
    double              worst = 0;
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        const SolarAir air = {row[i][0], 15, 0};
        SunAir         sun;
        atmosphere_solar(&sun, s->atmosphere, &air, (90 - row[i][1]) * rad_per_deg);
        bench_worse(&worst, 100 * (sun.direct_normal_w_m2 / row[i][2] - 1));
    }
    return fabs(worst);
}

Status bench_precision_weather(Bench *bench)
{
    static const char *const lowtran_is =
        "LOWTRAN7's six atmospheres, 2-10 km, by temperature and vapour at the ground";
    AirBench     s;
    const Status status = air_bench_open(&s);
    if (status == STATUS_OK) {
        bench_progress(bench, "weather");
        bench_stress(bench, "weather: transmittance, 0.7-1.1 um", worst_tau(&s, AIR_NIR), 0.004, "", lowtran_is);
        bench_stress(bench, "weather: transmittance, 3.4-4.8 um", worst_tau(&s, AIR_MWIR), 0.004, "", lowtran_is);
        bench_stress(bench, "weather: transmittance, 8-12 um", worst_tau(&s, AIR_LWIR), 0.004, "", lowtran_is);
        bench_stress(bench, "weather: longwave light of a clear sky, 5-35 C", worst_longwave(&s), 10, "%",
                     "Prata (1996)");
        bench_stress(bench, "weather: rain of 0.5-100 mm/h, every band", worst_rain(&s), 0.005, "dB/km",
                     "ITU-R P.1814");
        bench_stress(bench, "weather: direct sun of all wavelengths, 25-90 degrees up", worst_sun(&s), 8, "%",
                     "Bird (pvlib), same haze and water");
    } else {
        log_error("bench: precision: weather: %s", status_name(status));
    }
    air_bench_close(&s);
    return status;
}
