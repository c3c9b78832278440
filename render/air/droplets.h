/* render/air/droplets.h: rain, snow and fog in the optical and infrared bands, added to the air of the tables.
 *
 * Drops lie in flat layers from the ground up, each even within itself. Of a frame they are worked out once:
 * extinction, scattered share and its mean cosine by band, and the light at the bottom and the top of each layer by two
 * streams (delta-Eddington). A path then has the depth of its part in each layer, exactly, on top of the tables' depth,
 * since drops are nearly grey within a band; and sends what drops scatter (single scattering of the sun by Henyey and
 * Greenstein's phase function, plus diffuse light by Eddington's phase function) and emit, at the air's
 * temperature.
 *
 *   rain   1.076 R^0.67 dB/km in every band, R in mm/h (ITU-R P.1814); below 360 m above the freezing level (P.839), as
 *          the radar has it. Drops are large against the wavelength: bands differ by 2.3 % (droplets_table.c).
 *   snow   below 0 C at the ground, the same rate as water equivalent: (5.42e-5 w + 5.4958776) R^1.38 dB/km where it is
 * dry, below -1 C, (1.023e-4 w + 3.7855466) R^0.72 where it is wet, w the wavelength in nm (P.1814; P.1817, table 2);
 *          scattered shares are rain's; below 2 km (estimate).
 *   fog    below 2 km of visibility, 300 m deep, as for the radar: see droplets_haze_m. Bands by droplets_table.c.
 *
 * Errors: of the rate formulas a factor of two (of snow three) for real spectra of drops. A fog's extinction changes
 * within 8-12 um by a factor of two (radiation) about its mean. Light by two streams is within some 10 % of the truth
 * where fog is thick, and knows no bright ring of light scattered more than once. tests/render/test_droplets.c has the
 * formulas. */
#ifndef RENDER_AIR_DROPLETS_H
#define RENDER_AIR_DROPLETS_H

#include "render/air/atmosphere.h"
#include "terrain/weather/weather.h"

enum { droplet_layers = 2, droplet_bands = AIR_BAND_COUNT };

/* Diffuse light at a height: what goes down at a cosine c from the vertical has the radiance mean + c lean. */
typedef struct DropletGlow {
    double mean_w_m2_sr, lean_w_m2_sr;
} DropletGlow;

/* Pairs: values at its bottom and its top. */
typedef struct DropletLayer {
    double      bottom_m, top_m; /* above the model's 0 km */
    double      per_m[AIR_BAND_COUNT], albedo[AIR_BAND_COUNT], asymmetry[AIR_BAND_COUNT];
    double      fade[AIR_BAND_COUNT];        /* decades in e by which diffuse light falls off from side to side */
    double      sun_w_m2[AIR_BAND_COUNT][2]; /* direct, on a plane facing it */
    DropletGlow diffuse[AIR_BAND_COUNT][2];  /* the sun's scattered light */
    DropletGlow colder[2][2]; /* mwir, lwir: thermal light less that of a black body of air temperature */
} DropletLayer;

typedef struct Droplets {
    int          layers; /* 0: none */
    DropletLayer layer[droplet_layers];
    double       clear_per_m[AIR_BAND_COUNT]; /* the tables' air at the ground, a level kilometre */
    double       sun_up; /* cosine of the zenith angle of a flat layer's sun, 1/40 at the horizon */
} Droplets;

/* Whether there are any. */
static inline bool droplets_fall(const Weather *weather)
{
    return weather->rain_mm_h > 0 || (weather->visibility_m < 2000 && weather->fog != WEATHER_FOG_NONE);
}
/* Visibility whose haze is in the air beside the drops, m: the weather's own from 2 km up, or where its fog is none.
 * Below, haze gives way to drops: 1 / haze falls evenly from 1 / 2 km at 2 km to 1 / 5 km at 1 km of visibility and
 * stays there; drops take out the rest of 3.912 / visibility at 0.55 um. */
double droplets_haze_m(double visibility_m, WeatherFog fog);
/* Extinction at 0.55 um of the fog alone, 1/m. */
double droplets_fog_per_m(const Weather *weather);
/* Of rain or snow, by the air's temperature at the ground, 1/m. wavelength_m: of snow. */
double droplets_fall_per_m(const Weather *weather, double wavelength_m);
/* Height up to which it rains or snows, m. */
double droplets_fall_top_m(const Atmosphere *atmosphere, const Weather *weather);

/* What weather makes of the air: layers and their optics, without light. weather->air_temp_k: a number. */
void droplets_of(Droplets *out, const Atmosphere *atmosphere, const Weather *weather, double sun_zenith_rad);

/* The extinction of the tables' air beside them. */
void droplets_beside(Droplets *droplets, const AirDay *day);

/* Sunlight above a layer, or below: direct on a plane facing the sun, diffuse on a level plane. */
typedef struct DropletSun {
    double direct_w_m2, diffuse_w_m2;
} DropletSun;
/* The light of a band at the ground, from what would be there without drops; fills in the layers' own light. Ground
 * that reflects a fifth, as in the tables. */
DropletSun droplets_sun(Droplets *droplets, AirBand band, DropletSun without);
/* Clouds dim the light in the layers by these factors. */
void droplets_under_clouds(Droplets *droplets, double direct, double diffuse);
/* Thermal light of the layers of mwir or lwir: of the sky above and of the ground less the air's black body. Returns
 * the share of the sky's that is left at the ground. */
double droplets_thermal(Droplets *droplets, AirBand band, double sky_w_m2_sr, double ground_w_m2_sr);
/* Transmittance of the direct sun down to a height. */
double droplets_sun_passed(const Droplets *droplets, AirBand band, double height_m);

#endif
