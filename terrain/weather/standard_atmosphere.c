/* terrain/weather/standard_atmosphere.c: the layers of the U.S. Standard Atmosphere, 1976. */
#include "terrain/weather/standard_atmosphere.h"

static const double sphere_m = 6356766, gravity_mps2 = 9.80665;
static const double gas_j_kgk = 8314.32 / 28.9644, heats = 1.4; /* dry air; ratio of its specific heats */

typedef struct Layer {
    double base_m, temp_k, lapse_k_m, pressure_pa; /* geopotential metres */
} Layer;

/* Pressures follow from the first by the formula below; test_standard_atmosphere.c holds that layers join. */
static const Layer layers[] = {
    {0, 288.15, -0.0065, 101325},
    {11000, 216.65, 0, 22632.06397346293},
    {20000, 216.65, 0.001, 5474.88866967778},
    {32000, 228.65, 0.0028, 868.0186847552274},
    {47000, 270.65, 0, 110.90630555496588},
    {51000, 270.65, -0.0028, 66.93887311868727},
    {71000, 214.65, -0.002, 3.9564204280407287},
    {84852, 186.946, 0, 0.3733835899762158},
};

void standard_atmosphere(StandardAir *out, double height_msl_m)
{
    const double height_m = fmax(height_msl_m, -5000);
    const double level_m = sphere_m * height_m / (sphere_m + height_m);
    int          k = sizeof layers / sizeof *layers - 1;
    while (k > 0 && level_m < layers[k].base_m) k--;
    const Layer *l = &layers[k];
    const double up_m = level_m - l->base_m;
    out->temp_k = l->temp_k + l->lapse_k_m * up_m;
    out->pressure_pa =
        l->pressure_pa * (l->lapse_k_m == 0 ? exp(-gravity_mps2 * up_m / (gas_j_kgk * l->temp_k))
                                            : pow(l->temp_k / out->temp_k, gravity_mps2 / (gas_j_kgk * l->lapse_k_m)));
    out->density_kg_m3 = out->pressure_pa / (gas_j_kgk * out->temp_k);
    out->sound_mps = sqrt(heats * gas_j_kgk * out->temp_k);
}
