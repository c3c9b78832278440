/* render/air/atmosphere_limb.c: what the air of paths that go down from an eye sends: the air above the tables' top,
 * and the model's factors on what its tables of flat layers make of them (limb.csv). */
#include "render/air/atmosphere_private.h"

Status limb_open(Atmosphere *atmosphere, const char *folder)
{
    static const GridColumn axis[3] = {{"visibility_m", 1, 1e6}, {"observer_m", 0, height_max_m}, {"place", 0, 2}};
    static const GridColumn factor[2] = {{"mwir", 0.01, 100}, {"lwir", 0.01, 100}};
    char                    path[1024];
    const Status            status = atmosphere_file(path, folder, "limb.csv");
    return status == STATUS_OK ? grid_open(&atmosphere->limb, path, axis, 3, factor, 2) : status;
}

/* The visibility on the table's axis, of which factors are linear in 1 / visibility. */
static double visibility_at(const Grid *limb, const Blend *blend)
{
    const double  per_m = blend->haze_low / blend->low->visibility_m + blend->haze_high / blend->high->visibility_m;
    const double *axis = limb->axis[0];
    for (int i = 0; i + 1 < limb->nodes[0]; i++)
        if (per_m * axis[i + 1] > 1 || i + 2 == limb->nodes[0])
            return mixed(axis[i], axis[i + 1], clamp((1 / axis[i] - per_m) / (1 / axis[i] - 1 / axis[i + 1]), 0, 1));
    return axis[0];
}

void air_limb_factors(double out[2], const Atmosphere *atmosphere, const Blend *blend, double observer_m, double up,
                      double range_m)
{
    const Grid *limb = &atmosphere->limb;
    out[0] = out[1] = 1;
    if (!limb->value || !(up < 0) || !(observer_m > limb->axis[1][0])) return;
    const double r_m = earth_radius_m + observer_m, edge2_m2 = observer_m * (2 * earth_radius_m + observer_m);
    const double down_m = -up * r_m, over = down_m * down_m / edge2_m2; /* to the lowest point; 1 at the Earth's edge */
    double       whole_m = down_m, place = 1 - sqrt(fmax(1 - over, 0)), factor[2];
    if (over > 1) { /* to the ground */
        whole_m = edge2_m2 / (down_m + sqrt(down_m * down_m - edge2_m2));
        place = 2 - whole_m / sqrt(edge2_m2);
    }
    const double at[3] = {visibility_at(limb, blend), observer_m, place};
    grid_at(factor, limb, at);
    const double way = range_m < whole_m ? range_m / whole_m : 1;
    for (int k = 0; k < 2; k++) out[k] = mixed(1, factor[k], way * way);
}

double air_sky_thermal(const Atmosphere *atmosphere, const Blend *blend, AirBand band, double observer_m,
                       double zenith_rad)
{
    const double at[2] = {observer_m, slant_x(zenith_rad)};
    double       low, high;
    grid_some(&low, &blend->low->sky_thermal, at, band == AIR_LWIR, 1, 1);
    grid_some(&high, &blend->high->sky_thermal, at, band == AIR_LWIR, 1, 1);
    return exp(mixed(low, high, blend->share)) * black_air(atmosphere, band, observer_m);
}

double air_above_top(const Atmosphere *atmosphere, const Blend *blend, AirBand band, double observer_m, double up,
                     double top_m)
{
    if (!(observer_m > top_m) || !(up < 0)) return 0;
    const double from_m = fmax(top_m, air_tangent_m(observer_m, up));
    const double level = sqrt(fmax(1 - up * up, 0)) * (earth_radius_m + observer_m) / (earth_radius_m + from_m);
    const double sky = air_sky_thermal(atmosphere, blend, band, from_m, asin(fmin(level, 1))),
                 behind = air_sky_thermal(atmosphere, blend, band, observer_m, acos(-up));
    return fmax(sky - behind, 0);
}
