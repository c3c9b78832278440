/* The standard atmosphere against the tables of U.S. Standard Atmosphere, 1976 (geometric heights), and hydrostatics.
 * labels: physics */
#include "tests/check.h"

#include "terrain/weather/standard_atmosphere.h"

static void tables_of_the_standard(void **state)
{
    (void)state;
    /* height, temperature K, pressure Pa, density kg/m3, speed of sound m/s; as printed, of five digits: a unit of the
     * last one is 1e-4 of a number that begins with 1 */
    static const double row[][5] = {
        {-1000, 294.651, 1.1393e5, 1.3470, 344.11},    {0, 288.150, 1.01325e5, 1.2250, 340.29},
        {1000, 281.651, 8.9876e4, 1.1117, 336.43},     {5000, 255.676, 5.4048e4, 7.3643e-1, 320.55},
        {10000, 223.252, 2.6500e4, 4.1351e-1, 299.53}, {20000, 216.650, 5.5293e3, 8.8910e-2, 295.07},
        {30000, 226.509, 1.1970e3, 1.8410e-2, 301.71}, {50000, 270.650, 7.9779e1, 1.0269e-3, 329.80},
        {70000, 219.585, 5.2209, 8.2829e-5, 297.06},   {80000, 198.639, 1.0524, 1.8458e-5, 282.54},
    };
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        StandardAir air;
        standard_atmosphere(&air, row[i][0]);
        CHECK_NEAR(air.temp_k, row[i][1], 0.0011);
        CHECK_NEAR(air.pressure_pa / row[i][2], 1, 1e-4);
        CHECK_NEAR(air.density_kg_m3 / row[i][3], 1, 1e-4);
        CHECK_NEAR(air.sound_mps, row[i][4], 0.006);
    }
}

/* dp/dZ = -rho g0 (r / (r + Z))^2 everywhere, over the edges of layers too, so that the layers join. */
static void pressure_carries_the_air_above(void **state)
{
    (void)state;
    for (double z = -4000; z < 95000; z += 371) {
        StandardAir low, high, here;
        standard_atmosphere(&low, z - 1);
        standard_atmosphere(&high, z + 1);
        standard_atmosphere(&here, z);
        const double share = 6356766 / (6356766 + z);
        CHECK_NEAR((low.pressure_pa - high.pressure_pa) / (2 * here.density_kg_m3 * 9.80665 * share * share), 1, 1e-4);
    }
    /* either side of each base, to the last bits */
    static const double base_m[] = {11000, 20000, 32000, 47000, 51000, 71000, 84852};
    for (int k = 0; k < 7; k++) {
        const double z = 6356766 * base_m[k] / (6356766 - base_m[k]);
        StandardAir  below, above;
        standard_atmosphere(&below, z * (1 - 1e-12));
        standard_atmosphere(&above, z * (1 + 1e-12));
        CHECK_NEAR(below.pressure_pa / above.pressure_pa, 1, 1e-10);
        CHECK_NEAR(below.temp_k, above.temp_k, 1e-9);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tables_of_the_standard),
        cmocka_unit_test(pressure_carries_the_air_above),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
