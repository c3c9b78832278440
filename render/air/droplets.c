/* render/air/droplets.c: the layers of rain, snow and fog of a weather, and the light in them. */
#include "render/air/droplets.h"

#include "render/air/droplets_private.h"

static const double zero_k = 273.15, db_per_neper = 4.342944819032518, contrast = 3.912; /* ln 50: 2 % */
static const double fog_top_m = 300; /* as in sensor/radar/seeker_radar.c: of fogs 100 .. 500 m deep */
static const double snow_top_m = 2000, ground_albedo = 0.2;

/* ---- by wavelength ---------------------------------------------------------------------------- */

static DropletRow row_at(DropletKind kind, double wavelength_m)
{
    const DropletRow *row = droplet_table[kind];
    int               i = 0;
    while (i + 2 < droplet_rows && wavelength_m > row[i + 1].wavelength_m) i++;
    const double t =
        clamp((wavelength_m - row[i].wavelength_m) / (row[i + 1].wavelength_m - row[i].wavelength_m), 0, 1);
    return (DropletRow){wavelength_m, row[i].extinction + t * (row[i + 1].extinction - row[i].extinction),
                        row[i].albedo + t * (row[i + 1].albedo - row[i].albedo),
                        row[i].asymmetry + t * (row[i + 1].asymmetry - row[i].asymmetry)};
}

DropletRow droplet_optics(DropletKind kind, AirBand band)
{
    enum { steps = 16 };
    const SpectralBand      seen = channel_band(band);
    const SpectralResponse *r = seen.response;
    const double            low_m = seen.low_m, high_m = seen.high_m;
    double                  extinct = 0, scattered = 0, forward = 0, weight = 0;
    for (int i = 0; i < (r ? r->nodes : steps); i++) {
        const DropletRow row = row_at(kind, r ? r->node_m[i] : low_m + (high_m - low_m) * (i + 0.5) / steps);
        const double     w = r ? r->weight_m[i] : 1.0 / steps;
        weight += w;
        extinct += w * row.extinction;
        scattered += w * row.extinction * row.albedo;
        forward += w * row.extinction * row.albedo * row.asymmetry;
    }
    return (DropletRow){0.5 * (low_m + high_m), extinct / weight, scattered / extinct, forward / scattered};
}

/* ---- amounts ---------------------------------------------------------------------------------- */

double droplets_haze_m(double visibility_m, WeatherFog fog)
{
    static const double clear_m = 2000, thick_m = 1000, least_m = 5000;
    if (fog == WEATHER_FOG_NONE || !(visibility_m < clear_m)) return visibility_m;
    const double share = fmin((clear_m - visibility_m) / (clear_m - thick_m), 1);
    return 1 / (1 / clear_m + share * (1 / least_m - 1 / clear_m));
}

double droplets_fog_per_m(const Weather *weather)
{
    const double v_m = weather->visibility_m;
    return contrast * fmax(1 / v_m - 1 / droplets_haze_m(v_m, weather->fog), 0);
}

double droplets_fall_per_m(const Weather *weather, double wavelength_m)
{
    static const double wet_from_k = 272.15;
    const double        r = weather->rain_mm_h, nm = wavelength_m * 1e9, t_k = weather->air_temp_k;
    if (!(r > 0)) return 0;
    const double db_km = t_k >= zero_k       ? 1.076 * pow(r, 0.67)
                         : t_k >= wet_from_k ? (1.023e-4 * nm + 3.7855466) * pow(r, 0.72)
                                             : (5.42e-5 * nm + 5.4958776) * pow(r, 1.38);
    return db_km * 1e-3 / db_per_neper;
}

/* The profile is that of the radar's air (render/scattering/paths/radar_path.c): what the ground's air differs from the
 * model's fades with height. */
double droplets_fall_top_m(const Atmosphere *atmosphere, const Weather *weather)
{
    static const double step_m = 100, above_m = 360, fade_m = 2000, highest_m = 20000; /* P.839 */
    const double        model_k = atmosphere_temp_k(atmosphere, 0), warmer_k = weather->air_temp_k - model_k;
    if (weather->air_temp_k < zero_k) return snow_top_m;
    double high_k = NAN;
    for (double h_m = highest_m; h_m >= 0; h_m -= step_m) {
        const double t_k = atmosphere_temp_k(atmosphere, h_m) + warmer_k * exp(-h_m / fade_m);
        if (t_k >= zero_k) return h_m + above_m + (high_k < zero_k ? step_m * (t_k - zero_k) / (t_k - high_k) : 0);
        high_k = t_k;
    }
    return above_m;
}

static DropletKind fog_kind(const Weather *weather)
{
    static const double calm_mps = 3; /* radiation fog needs less wind */
    if (weather->fog == WEATHER_FOG_AUTO) return weather->wind_mps < calm_mps ? droplet_radiation : droplet_advection;
    return weather->fog == WEATHER_FOG_RADIATION ? droplet_radiation : droplet_advection;
}

/* Adds drops of one kind to a layer: depths add, scattered shares and cosines are means by what they weigh. */
static void add_drops(DropletLayer *layer, AirBand band, double per_m, const DropletRow *optics)
{
    const double scattered = layer->per_m[band] * layer->albedo[band], more = per_m * optics->albedo;
    if (!(per_m > 0)) return;
    layer->asymmetry[band] = (scattered * layer->asymmetry[band] + more * optics->asymmetry) / (scattered + more);
    layer->per_m[band] += per_m;
    layer->albedo[band] = (scattered + more) / layer->per_m[band];
}

/* ---- two streams ------------------------------------------------------------------------------ */

/* A layer in one band by the delta-Eddington form of two streams: Joseph, Wiscombe & Weinman, J. Atmos. Sci. 33 (1976)
 * 2452; formulas of Meador & Weaver, J. Atmos. Sci. 37 (1980) 630. */
typedef struct Streams {
    double depth, albedo, asymmetry; /* scaled */
    double g1, g2, k, fade;          /* fade: e^-(k depth) */
    double reflected, passed;        /* of diffuse light */
} Streams;

static Streams streams_of(const DropletLayer *layer, AirBand band)
{
    Streams      s = {0};
    const double g = layer->asymmetry[band], w = fmin(layer->albedo[band], 1 - 1e-6), f = g * g;
    s.depth = (1 - w * f) * layer->per_m[band] * (layer->top_m - layer->bottom_m);
    s.albedo = (1 - f) * w / (1 - w * f), s.asymmetry = g / (1 + g);
    s.g1 = (7 - s.albedo * (4 + 3 * s.asymmetry)) / 4, s.g2 = -(1 - s.albedo * (4 - 3 * s.asymmetry)) / 4;
    s.k = sqrt(s.g1 * s.g1 - s.g2 * s.g2), s.fade = exp(-s.k * s.depth);
    const double under = s.k + s.g1 + (s.k - s.g1) * s.fade * s.fade;
    s.reflected = fmax(s.g2 * (1 - s.fade * s.fade) / under, 0), s.passed = 2 * s.k * s.fade / under;
    return s;
}

/* Shares of a sun's light on a level plane that are sent back, and that pass, direct light included. */
static void streams_sun(double *reflected, double *passed, const Streams *s, double sun_up)
{
    const double k = s->k, e = s->fade;
    const double mu = fabs(k * sun_up - 1) < 1e-4 ? sun_up * 0.999 : sun_up, x = exp(-s->depth / mu); /* not 0 / 0 */
    const double g3 = (2 - 3 * s->asymmetry * mu) / 4, g4 = 1 - g3;
    const double a1 = s->g1 * g4 + s->g2 * g3, a2 = s->g1 * g3 + s->g2 * g4;
    const double share = s->albedo / ((1 - k * k * mu * mu) * (k + s->g1 + (k - s->g1) * e * e));
    const double back =
        (1 - k * mu) * (a2 + k * g3) - (1 + k * mu) * (a2 - k * g3) * e * e - 2 * k * (g3 - a2 * mu) * x * e;
    const double on =
        x * ((1 + k * mu) * (a1 + k * g4) - (1 - k * mu) * (a1 - k * g4) * e * e) - 2 * k * (g4 + a1 * mu) * e;
    *reflected = clamp(share * back, 0, 1);
    *passed = clamp(x - share * on, 0, 1);
}

/* Of two streams' radiances: their mean, and the lean that gives these two fluxes. */
static DropletGlow glow_of(double down_w_m2_sr, double up_w_m2_sr)
{
    return (DropletGlow){0.5 * (down_w_m2_sr + up_w_m2_sr), 0.75 * (down_w_m2_sr - up_w_m2_sr)};
}

static double layer_depth(const DropletLayer *layer, AirBand band)
{
    return layer->per_m[band] * (layer->top_m - layer->bottom_m);
}

DropletSun droplets_sun(Droplets *droplets, AirBand band, DropletSun without)
{
    Streams    stream[droplet_layers];
    double     below[droplet_layers + 1] = {ground_albedo}; /* reflectance of what is below a layer; above all */
    DropletSun sun = without;
    for (int i = 0; i < droplets->layers; i++) {
        stream[i] = streams_of(&droplets->layer[i], band);
        below[i + 1] =
            stream[i].reflected + stream[i].passed * stream[i].passed * below[i] / (1 - stream[i].reflected * below[i]);
    }
    for (int i = droplets->layers - 1; i >= 0; i--) {
        DropletLayer *layer = &droplets->layer[i];
        const double  up = droplets->sun_up;
        double        back, on;
        streams_sun(&back, &on, &stream[i], up);
        const double onto = sun.direct_w_m2 * up, direct = sun.direct_w_m2 * exp(-layer_depth(layer, band) / up);
        const double down = (onto * on + sun.diffuse_w_m2 * stream[i].passed) / (1 - stream[i].reflected * below[i]);
        const double risen = onto * back + sun.diffuse_w_m2 * stream[i].reflected + down * below[i] * stream[i].passed;
        const double diffuse = fmax(down - direct * up, 0);
        layer->sun_w_m2[band][1] = sun.direct_w_m2, layer->sun_w_m2[band][0] = direct;
        layer->diffuse[band][1] = glow_of(sun.diffuse_w_m2 / pi_rad, risen / pi_rad);
        layer->diffuse[band][0] = glow_of(diffuse / pi_rad, down * below[i] / pi_rad);
        sun = (DropletSun){direct, diffuse};
    }
    return sun;
}

void droplets_under_clouds(Droplets *droplets, double direct, double diffuse)
{
    for (int i = 0; i < droplets->layers; i++)
        for (int b = 0; b < AIR_BAND_COUNT; b++)
            for (int end = 0; end < 2; end++) {
                droplets->layer[i].sun_w_m2[b][end] *= direct;
                droplets->layer[i].diffuse[b][end].mean_w_m2_sr *= diffuse;
                droplets->layer[i].diffuse[b][end].lean_w_m2_sr *= diffuse;
            }
}

/* Less a black body of air temperature the light in a layer has no source but its sides. */
double droplets_thermal(Droplets *droplets, AirBand band, double sky_w_m2_sr, double ground_w_m2_sr)
{
    double passed = 1;
    for (int i = droplets->layers - 1; i >= 0; i--) {
        DropletLayer *layer = &droplets->layer[i];
        const Streams s = streams_of(layer, band);
        const double  above = sky_w_m2_sr * passed;
        DropletGlow  *colder = layer->colder[band - AIR_MWIR];
        colder[1] = glow_of(above, above * s.reflected + ground_w_m2_sr * s.passed);
        colder[0] = glow_of(above * s.passed + ground_w_m2_sr * s.reflected, ground_w_m2_sr);
        passed *= s.passed;
    }
    return passed;
}

double droplets_sun_passed(const Droplets *droplets, AirBand band, double height_m)
{
    double depth = 0;
    for (int i = 0; i < droplets->layers; i++) {
        const DropletLayer *layer = &droplets->layer[i];
        depth += layer->per_m[band] * fmax(layer->top_m - fmax(height_m, layer->bottom_m), 0);
    }
    return depth > 0 ? exp(-depth / droplets->sun_up) : 1;
}

/* ---- the layers ------------------------------------------------------------------------------- */

void droplets_of(Droplets *out, const Atmosphere *atmosphere, const Weather *weather, double sun_zenith_rad)
{
    const double fog_per_m = droplets_fog_per_m(weather), c = fmax(cos(fmin(sun_zenith_rad, pi_rad / 2)), 0);
    const bool   fog = fog_per_m > 0, falls = weather->rain_mm_h > 0;
    *out = (Droplets){.sun_up = c + 0.025 * exp(-11 * c)}; /* Rozenberg's air mass, as in atmosphere_private.h */
    if (!fog && !falls) return;
    const double fall_m = falls ? droplets_fall_top_m(atmosphere, weather) : 0, fog_m = fog ? fog_top_m : 0;
    const double low_m = falls && fog ? fmin(fall_m, fog_m) : fmax(fall_m, fog_m), high_m = fmax(fall_m, fog_m);
    out->layers = high_m > low_m ? 2 : 1;
    out->layer[0].top_m = out->layer[1].bottom_m = low_m, out->layer[1].top_m = high_m;
    for (AirBand b = 0; b < AIR_BAND_COUNT; b++) {
        const DropletRow of_fog = droplet_optics(fog_kind(weather), b), of_rain = droplet_optics(droplet_rain, b);
        for (int i = 0; i < out->layers; i++) {
            DropletLayer *layer = &out->layer[i];
            if (layer->top_m <= fog_m) add_drops(layer, b, fog_per_m * of_fog.extinction, &of_fog);
            if (layer->top_m <= fall_m)
                add_drops(layer, b, droplets_fall_per_m(weather, of_rain.wavelength_m), &of_rain);
            const Streams s = streams_of(layer, b);
            layer->fade[b] = s.k * s.depth;
        }
    }
}

void droplets_beside(Droplets *droplets, const AirDay *day)
{
    const AirPath level = {.range_m = 1000};
    DayPath       path;
    air_day_path(&path, day, &level);
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        droplets->clear_per_m[b] = (b < AIR_MWIR ? path.sun[b] : path.own[b - AIR_MWIR]) / level.range_m;
}
