/* render/air/atmosphere.h: the tables of etc/atmosphere: transmittance and radiance of paths, the sky and the sun in a
 * standard atmosphere.
 *
 * Exact here means: at a table's points it returns the table; between them its errors are those that
 * tests/render/test_atmosphere.c measures against points the tables do not hold. One path at a time and to the
 * table's own accuracy; what a frame needs (one eye, one sun, a third of a million paths) is reduced from this once
 * a frame by render/air/air.c. etc/atmosphere/README.md defines the format, which is independent of the radiative
 * transfer program that made the tables. Every function is a pure function of its arguments and may be called from
 * any thread. */
#ifndef RENDER_AIR_ATMOSPHERE_H
#define RENDER_AIR_ATMOSPHERE_H

#include "pitviper_channels.h"

/* The indices of channels (pitviper_channels.h) by their standard names; the channel at each is that of the run. */
typedef ChannelPlace AirBand;
#define AIR_B          SPECTRAL_B
#define AIR_G          SPECTRAL_G
#define AIR_R          SPECTRAL_R
#define AIR_PAN        SPECTRAL_PAN
#define AIR_NIR        SPECTRAL_NIR
#define AIR_MWIR       SPECTRAL_MWIR
#define AIR_LWIR       SPECTRAL_LWIR
#define AIR_BAND_COUNT SPECTRAL_PLACES
const char *air_band_name(AirBand band);
/* Band limits, in vacuum. */
void air_band_edges(double *low_m, double *high_m, AirBand band);

typedef struct Atmosphere Atmosphere;

/* model: us1976, midlat_summer, or any other that etc/atmosphere holds; all of its visibilities are read. Failures
 * (no such model, a malformed row, a point missing) are logged with file and line. */
Status atmosphere_open(Atmosphere **out, const char *model);
/* The same for one visibility alone, m: it reads only the neighbouring tables and is valid at no other visibility. */
Status atmosphere_open_at(Atmosphere **out, const char *model, double visibility_m);
void   atmosphere_close(Atmosphere *atmosphere);
/* The model to open for a weather at the ground. A folder with weathers.csv (folder, air_temp_k, vapour_g_m3) is a set
 * of models: the one whose air is nearest, with 5 K as far as a fifth of the vapour; any other model is itself. Logged:
 * a table that is wrong; a set and a temp_k of NaN. */
Status atmosphere_nearest(char *out, size_t out_size, const char *model, double temp_k, double vapour_kg_m3);
/* Air at the ground: temp_k NaN: the model's own air. */
typedef struct AirState {
    double visibility_m, temp_k, vapour_kg_m3;
} AirState;
/* Whether the air of a model follows the temperature and the water vapour at the ground: us1976 and midlat_summer do, a
 * user's own tables are what they are. */
bool atmosphere_follows_weather(const Atmosphere *atmosphere);
/* The same of one band: channels that vapour.bin does not have keep the air of the tables. */
bool atmosphere_band_follows(const Atmosphere *atmosphere, AirBand band);
/* Water vapour at the ground of the model's own air; NaN: its tables do not say. */
double atmosphere_vapour_kg_m3(const Atmosphere *atmosphere);
/* The model's air under a weather, valid for all functions here at that visibility alone; clear air by
 * etc/atmosphere/vapour.bin, haze the model's, swollen by the humidity. It lives in the arena and uses the model, which
 * is returned itself where it does not follow. bands: 1 << AirBand, those whose paths are asked for. A pure function of
 * the state, continuous in all of it. STATUS_NO_MEMORY. */
Status atmosphere_in(const Atmosphere **out, const Atmosphere *model, const AirState *state, unsigned bands,
                     Arena *arena);
/* Valid visibilities, m; outside them the nearest is used: 0.4 of the least to 2.2 of the greatest that has a table.
 * Between tables and beyond them haze's extinction at the model's own heights (temperature.csv) is a straight line in
 * 1 / visibility, between these heights one in its logarithm (render/air/atmosphere_slices.c). */
void atmosphere_visibilities(const Atmosphere *atmosphere, double *low_m, double *high_m);

static const double earth_radius_m = 6371e3;

/* Where a straight ray of this length ends above the round Earth, and the rate of climb there. */
static inline double air_height_along(double eye_m, double climb, double along_m, double *climb_there)
{
    const double r_m = earth_radius_m + eye_m, rise = along_m * (along_m + 2 * r_m * climb);
    const double there_m = sqrt(fmax(r_m * r_m + rise, 0));
    if (climb_there) *climb_there = (along_m + r_m * climb) / there_m;
    return eye_m + rise / (r_m + there_m);
}

/* One straight path over a round Earth. Heights above the model's ground (its 0 km), of both ends; the
 * path may go up, down or along, or pass a lowest point between its ends (atmosphere_legs.c). Any range: below the
 * tables' shortest depth is in proportion to range, beyond the longest too. */
typedef struct AirPath {
    double observer_m, target_m; /* from 0 (clamped) up; above the top of the tables, 20 km, there is no air */
    double range_m;              /* raised to |target_m - observer_m|; 0: empty path */
    double sun_zenith_rad;       /* for scattered sunlight; > pi / 2: none */
    double rel_azimuth_rad;      /* between the view and the sun, 0: towards the sun */
} AirPath;

typedef struct PathAir {
    double transmittance;     /* weighted by Planck(temp_k) in the thermal bands, by the sun elsewhere */
    double sun_transmittance; /* weighted by sunlight: of what is reflected */
    double thermal_w_m2_sr;   /* path radiance by emission */
    double scattered_w_m2_sr; /* path radiance by scattered sunlight, single and multiple */
} PathAir;

/* temp_k: of the emitter, 200 .. 3000, clamped. About 0.5 us at night and 3 us by day, pan three times that. */
void atmosphere_path(PathAir *out, const Atmosphere *atmosphere, double visibility_m, AirBand band, const AirPath *path,
                     double temp_k);

/* To space, zenith_rad 0 .. pi. Below the horizontal the ray passes its lowest point, at the ground at most, and goes
 * on up from there: the air to that point, and behind it the level sky from there. */
typedef struct SkyAir {
    double thermal_w_m2_sr, scattered_w_m2_sr;
} SkyAir;
void atmosphere_sky(SkyAir *out, const Atmosphere *atmosphere, double visibility_m, AirBand band, double observer_m,
                    double zenith_rad, double sun_zenith_rad, double rel_azimuth_rad);

typedef struct SunAir {
    double direct_normal_w_m2;      /* facing the sun, at 1 AU */
    double diffuse_horizontal_w_m2; /* scattered sunlight from the whole sky on a level plane */
} SunAir;
void atmosphere_sun(SunAir *out, const Atmosphere *atmosphere, double visibility_m, AirBand band, double observer_m,
                    double sun_zenith_rad);

/* Thermal irradiance of the whole sky on a level plane, all wavelengths, W/m2, at the ground. */
double atmosphere_longwave_down(const Atmosphere *atmosphere, double visibility_m);
/* Sunlight of all wavelengths at the ground, for temperatures, of etc/atmosphere/solar.csv whatever the model. Direct
 * and diffuse light are columns of their own: of direct light 0.40 is visible with the sun overhead, 0.11 with it 7
 * degrees up. Smooth in all four arguments, each of which is clamped to the table's nodes; errors between these, and of
 * what the table says: etc/atmosphere/README.md. */
typedef struct SolarAir {
    double visibility_m, water_mm; /* at the ground; water vapour above it, kg/m2 */
    double ground_m;               /* of the ground above the sea */
} SolarAir;
/* At 1 AU; sun_zenith_rad 0 .. pi / 2. About a microsecond. */
void atmosphere_solar(SunAir *out, const Atmosphere *atmosphere, const SolarAir *air, double sun_zenith_rad);
/* Water vapour above the ground, mm, of that at the ground, by a scale height of 2.25 km. The six atmospheres of
 * LOWTRAN have 2.1 to 2.4 km (mean of five 2.27) and 3.5 km (subarctic winter, 4 mm); the US standard above 2.3 km
 * has 1.9. 10 % of water is 0.5 to 0.7 % of direct light. */
static inline double solar_water_mm(double vapour_kg_m3) { return 2250 * vapour_kg_m3; }
/* Air temperature of the model at a height, K. */
double atmosphere_temp_k(const Atmosphere *atmosphere, double height_m);

/* An atmosphere at one visibility and one sun position, for the hundreds of evaluations of
 * a frame.
 *
 * The results of atmosphere_path and atmosphere_sky (within 1e-12 of them: tests/render/test_atmosphere_day.c), at a
 * tenth of the cost: the sun's position is looked up in every table once, a point of a path serves all bands, a path
 * all azimuths and all temperatures. */

enum { day_temps_max = 8, day_azimuths_max = 16 };

typedef struct AirDay AirDay;

/* bands: 1 << AirBand, those to be computed; sun_zenith_rad: > pi / 2: nothing is scattered. temp_k: of emitters,
 * [temps]. Lives in the arena; a pure function of its arguments. STATUS_NO_MEMORY. 20 to 50 us. */
Status air_day_at(const AirDay **out, const Atmosphere *atmosphere, double visibility_m, double sun_zenith_rad,
                  unsigned bands, const double *temp_k, int temps, Arena *arena);

/* Of one path: ln(1 / tau). */
typedef struct DayPath {
    double sun[AIR_BAND_COUNT];       /* of sunlight */
    double emitted[2][day_temps_max]; /* of emitters; mwir, lwir */
    double own[2];                    /* of the air's own emission */
    double thermal_w_m2_sr[2];        /* the air's own radiance */
} DayPath;
void air_day_path(DayPath *out, const AirDay *day, const AirPath *path);

/* Scattered sunlight of one path at several azimuths from the sun, 0 .. pi; sun: as DayPath's. */
void air_day_scattered(double (*w_m2_sr)[AIR_BAND_COUNT], double sun[AIR_BAND_COUNT], const AirDay *day,
                       const AirPath *path, const double *azimuth_rad, int azimuths);

/* The sky at one zenith angle, 0 .. pi, and several azimuths; thermal: mwir, lwir. */
void air_day_sky(double (*w_m2_sr)[AIR_BAND_COUNT], double thermal_w_m2_sr[2], const AirDay *day, double observer_m,
                 double zenith_rad, const double *azimuth_rad, int azimuths);

#endif
