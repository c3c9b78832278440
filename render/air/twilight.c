/* render/air/twilight.c: skylight with the sun below 5 degrees, by band, over that with the sun there. */
#include "render/air/air_private.h"
#include "render/air/atmosphere_private.h"

/* Decades of a clear sky's light on level ground, lx, without a moon: Janiczek & DeYoung, Computer Programs for Sun and
 * Moon Illuminance, USNO Circular 171 (1987), after Brown, Natural Illumination Charts (1952); in Vallado, Fundamentals
 * of Astrodynamics, table 5-1. Polynomials in the elevation over 90 degrees; their pieces meet within 0.005. 759 lx at
 * the horizon, 3.4 at the end of civil twilight, 0.0081 of nautical, 0.00065 of astronomical and by night. */
static double illuminance_decades(double elevation_deg)
{
    static const double piece[3][5] = {{-0.8, 2.88, 21.81, -258.11, -858.36},
                                       {-5, 2.70, 12.17, -431.69, -1899.83},
                                       {-12, 13.84, 262.72, 1447.42, 2797.93}};
    static const double level[4] = {2.88, 22.26, -207.64, 1034.30};
    const double       *of = level, x = fmax(elevation_deg, -18) / 90;
    for (int i = 0; i < 3; i++)
        if (elevation_deg < piece[i][0]) of = piece[i] + 1;
    return of[0] + x * (of[1] + x * (of[2] + x * of[3]));
}

/* Decades of the light of a wavelength over that of 0.55 um, both over their values at the horizon. To 6 degrees by
 * etc/atmosphere/make/twilight.py: ozone takes yellow and red from sunlight that passes level through its layer. To 12
 * degrees, where more and more is scattered repeatedly, as at 6: measured twilight stays blue there (Johnsen et al., J.
 * Exp. Biol. 209, 2006). By night airglow and stars: B 22.6, V 21.6, R 20.9, I 19.7 mag per square arcsecond (Patat,
 * A&A 400, 2003) by Bessell's fluxes, 6.32, 3.63, 2.18, 1.13e-9 erg/(s cm2 A): 0.69, 1, 1.14, 1.79 per wavelength,
 * over 1.53 (0.45 um), 0.78 and 0.42 (0.87 um) at the horizon. What hydroxyl radiates beyond 1 um is not in it. */
enum { colours = 5, depressions = 9 };
static const double colour_um[colours] = {0.45, 0.55, 0.65, 0.87, 1.35};
static const double depression_deg[depressions] = {0, 1, 2, 3, 4, 5, 6, 12, 18};
static const double colour_decades[depressions][colours] = {
    {0, 0, 0, 0, 0},
    {0.032, 0, 0.002, -0.011, -0.103},
    {0.060, 0, 0.017, 0.018, -0.149},
    {0.086, 0, 0.043, 0.106, -0.094},
    {0.123, 0, 0.045, 0.183, 0.066},
    {0.143, 0, 0.016, 0.161, 0.130},
    {0.121, 0, 0.007, 0.158, 0.230},
    {0.121, 0, 0.007, 0.158, 0.230},
    {-0.344, 0, 0.167, 0.625, 0.625},
};

static double colour_at(double depression, double um)
{
    double    down, along;
    const int i = interval_of(&down, depression_deg, depressions, depression);
    const int k = interval_of(&along, colour_um, colours, um);
    double    value[2];
    for (int j = 0; j < 2; j++)
        value[j] = colour_decades[i + j][k] + along * (colour_decades[i + j][k + 1] - colour_decades[i + j][k]);
    return pow(10, value[0] + down * (value[1] - value[0]));
}

static double sky_at(const Atmosphere *atmosphere, double visibility_m, AirBand band, double zenith_rad)
{
    SunAir sun;
    atmosphere_sun(&sun, atmosphere, visibility_m, band, 0, zenith_rad);
    return sun.diffuse_horizontal_w_m2;
}

/* Of a band, over its light with the sun at the horizon. */
static double below_horizon(AirBand band, double depression, double level)
{
    double low_m, high_m;
    air_band_edges(&low_m, &high_m, band);
    return level * colour_at(depression, 0.5e6 * (low_m + high_m));
}

void twilight(double scale[AIR_BAND_COUNT], const Atmosphere *atmosphere, double visibility_m, double elevation_rad,
              unsigned bands)
{
    for (int b = 0; b < AIR_BAND_COUNT; b++) scale[b] = 1;
    const double elevation_deg = elevation_rad / rad_per_deg, depression = fmin(fmax(-elevation_deg, 0), 18);
    if (elevation_deg >= twilight_begins_deg) return;
    const double zenith_rad = 0.5 * pi_rad - fmax(elevation_rad, 0),
                 begins_rad = (90 - twilight_begins_deg) * rad_per_deg;
    /* shares of blue and red in the illuminance at the horizon, which the curve holds whatever the colour */
    const double blue = 0.107, red = 0.151;
    const double level =
        elevation_deg < 0
            ? pow(10, illuminance_decades(elevation_deg) - illuminance_decades(0)) /
                  (1 - blue - red + blue * colour_at(depression, 0.45) + red * colour_at(depression, 0.65))
            : 1;
    for (int b = 0; b < AIR_LWIR; b++) {
        if (!((bands | 1 << AIR_PAN) >> b & 1)) continue;
        const double from = sky_at(atmosphere, visibility_m, (AirBand)b, begins_rad);
        double       now = 0;
        if (b == AIR_PAN && elevation_deg < 0)
            for (AirBand part = AIR_B; part <= AIR_R; part++)
                now += sky_at(atmosphere, visibility_m, part, zenith_rad) * below_horizon(part, depression, level);
        else
            now = sky_at(atmosphere, visibility_m, (AirBand)b, zenith_rad) *
                  (elevation_deg < 0 ? below_horizon((AirBand)b, depression, level) : 1);
        scale[b] = from > 0 ? now / from : 0;
    }
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        if (b == AIR_LWIR || !((bands | 1 << AIR_PAN) >> b & 1)) scale[b] = scale[AIR_PAN];
}
