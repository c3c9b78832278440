/* tests/bench/render/precision_limb.c: what the round air sends to an eye, against sums over its shells. */
#include "tests/bench/suites.h"

#include "tests/bench/bench.h"
#include "tests/bench/render/air_bench.h"

enum { skies = 6, grounds = 5, looks = skies + grounds };

/* Some of tests/data/limb.csv: rays below the horizontal that pass the Earth, by the height of their lowest point, then
 * air and black ground of the model's air temperature behind it, by range; W/(m2 sr) in 3.4-4.8 and 8-12 um. Sums of
 * etc/atmosphere/make/limb.py (--sums) over some 60 shells: Planck's radiance times what LOWTRAN7 loses of its
 * transmittance, at places that none of the program's tables were made from. */
static const struct {
    bool   summer; /* midlat_summer; else us1976 */
    double visibility_m, eye_m, lowest_m[skies], range_m[grounds], w_m2_sr[2][looks];
} shells[] = {
    {false,
     23000,
     1000,
     {846.4, 518.4, 270.4, 102.4, 14.4, 0.5},
     {101596.4, 84663.7, 62086.7, 39509.7, 1000.1},
     {{0.66085, 0.67122, 0.67622, 0.67922, 0.68064, 0.68087, 0.68114, 0.68237, 0.68671, 0.69684, 0.78945},
      {28.224, 28.575, 28.741, 28.834, 28.876, 28.883, 28.89, 28.929, 29.069, 29.392, 31.287}}},
    {false,
     23000,
     10000,
     {8465.0, 5186.0, 2705.5, 1024.7, 144.1, 1.0},
     {321389.5, 267824.6, 196404.7, 124984.8, 10001.0},
     {{0.032399, 0.070051, 0.11618, 0.14222, 0.15134, 0.15269, 0.1539, 0.161, 0.18347, 0.22818, 0.49228},
      {3.0234, 7.7284, 17.02, 19.416, 19.909, 19.978, 20.04, 20.406, 21.488, 23.338, 29.72}}},
    {false,
     23000,
     20000,
     {16932.1, 10375.8, 5414.2, 2050.9, 288.4, 2.0},
     {454691.5, 378909.6, 277867.1, 176824.5, 20002.0},
     {{0.012986, 0.017123, 0.048605, 0.10226, 0.12152, 0.12399, 0.12613, 0.13794, 0.17038, 0.22584, 0.46997},
      {1.8908, 2.2569, 6.2421, 16.654, 17.833, 17.958, 18.067, 18.655, 20.1, 22.171, 28.685}}},
    {false,
     23000,
     99900,
     {84655.9, 51982.1, 27166.8, 10301.6, 1449.7, 10.1},
     {1019388.9, 849490.7, 622959.9, 396429.0, 99910.0},
     {{2.333e-06, 0.01247, 0.035173, 0.039627, 0.12623, 0.1395, 0.14872, 0.18522, 0.24797, 0.32005, 0.47323},
      {4.3765e-05, 0.10961, 2.0872, 2.883, 17.198, 17.914, 18.375, 19.994, 22.226, 24.361, 28.195}}},
    {true,
     5000,
     10000,
     {8465.0, 5186.0, 2705.5, 1024.7, 144.1, 1.0},
     {321389.5, 267824.6, 196404.7, 124984.8, 10001.0},
     {{0.067248, 0.13342, 0.19741, 0.22398, 0.2325, 0.23374, 0.23487, 0.24183, 0.26491, 0.31349, 0.63497},
      {4.5015, 12.124, 21.25, 22.308, 22.646, 22.692, 22.735, 22.998, 23.818, 25.356, 32.51}}},
    {true,
     5000,
     50000,
     {42345.3, 25968.8, 13558.6, 5138.0, 722.8, 5.0},
     {719775.0, 599812.5, 439862.5, 279912.5, 50005.0},
     {{0.053947, 0.055493, 0.05459, 0.12165, 0.20031, 0.20598, 0.21073, 0.23471, 0.28947, 0.36724, 0.60494},
      {0.96565, 2.6843, 3.0145, 11.117, 20.133, 20.351, 20.53, 21.372, 23.048, 25.175, 30.964}}},
};
enum { eyes = sizeof shells / sizeof *shells };

/* What an eye sees along its look k: the sky, or the air and the ground behind it. */
static double seen(const AirBench *s, const Atmosphere *air, int eye, int k, AirBand band)
{
    static const double earth_m = 6371e3;
    const double        eye_m = shells[eye].eye_m, ground_k = shells[eye].summer ? 294.2 : 288.2;
    if (k < skies) {
        SkyAir       sky;
        const double down_rad = acos((earth_m + shells[eye].lowest_m[k]) / (earth_m + eye_m));
        atmosphere_sky(&sky, air, shells[eye].visibility_m, band, eye_m, 0.5 * pi_rad + down_rad, pi_rad, 0);
        return sky.thermal_w_m2_sr;
    }
    PathAir       way;
    const AirPath path = {eye_m, 0, shells[eye].range_m[k - skies], pi_rad, 0};
    atmosphere_path(&way, air, shells[eye].visibility_m, band, &path, ground_k);
    return way.thermal_w_m2_sr + way.transmittance * planck_table_radiance(s->planck[band - AIR_MWIR], ground_k);
}

/* The largest error, %, where there is more than a twentieth of the eye's brightest sky. */
static double worst_look(const AirBench *s, const Atmosphere *summer, AirBand band, bool ground)
{
    double worst = 0;
    for (int e = 0; e < eyes; e++) {
        const double     *want = shells[e].w_m2_sr[band - AIR_MWIR];
        const Atmosphere *air = shells[e].summer ? summer : s->atmosphere;
        for (int k = ground ? skies : 0; k < (ground ? looks : skies); k++)
            if (want[k] >= 0.05 * want[skies - 1]) bench_worse(&worst, 100 * (seen(s, air, e, k, band) / want[k] - 1));
    }
    return fabs(worst);
}

Status bench_precision_limb(Bench *bench)
{
    static const char *const sums = "sums over shells (LOWTRAN7), eyes at 1-99.9 km, two models";
    Atmosphere              *summer = NULL;
    AirBench                 s;
    Status                   status = air_bench_open(&s);
    if (status == STATUS_OK) status = atmosphere_open(&summer, "midlat_summer");
    if (status == STATUS_OK) {
        bench_progress(bench, "limb");
        bench_stress(bench, "limb: sky past the Earth, 3.4-4.8 um", worst_look(&s, summer, AIR_MWIR, false), 2, "%",
                     sums);
        bench_stress(bench, "limb: sky past the Earth, 8-12 um", worst_look(&s, summer, AIR_LWIR, false), 2, "%", sums);
        bench_stress(bench, "limb: ground to the horizon, 3.4-4.8 um", worst_look(&s, summer, AIR_MWIR, true), 3, "%",
                     sums);
        bench_stress(bench, "limb: ground to the horizon, 8-12 um", worst_look(&s, summer, AIR_LWIR, true), 3, "%",
                     sums);
    } else {
        log_error("bench: precision: limb: %s", status_name(status));
    }
    atmosphere_close(summer);
    air_bench_close(&s);
    return status;
}
