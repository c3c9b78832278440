/* render/atmosphere.c: looks up what a path, the sky and the sun are, between the tables' points and visibilities. */
#include "render/atmosphere_private.h"

const AirBand air_tabled[air_tabled_count] = {AIR_B, AIR_G, AIR_R, AIR_NIR, AIR_MWIR, AIR_LWIR};

const char *air_band_name(AirBand band)
{
    static const char *const name[AIR_BAND_COUNT] = {"b", "g", "r", "pan", "nir", "mwir", "lwir"};
    return band >= 0 && band < AIR_BAND_COUNT ? name[band] : "?";
}

int air_tabled_index(AirBand band)
{
    for (int i = 0; i < air_tabled_count; i++)
        if (air_tabled[i] == band) return i;
    return -1;
}

/* ---- between visibilities ---------------------------------------------------------------------- */

/* Beyond the tables' visibilities haze goes on by the same straight line in 1 / visibility, this far. */
static const double visibility_below = 0.4, visibility_above = 2.2;

void atmosphere_visibilities(const Atmosphere *atmosphere, double *low_m, double *high_m)
{
    *low_m = atmosphere->slice[0].visibility_m * visibility_below;
    *high_m = atmosphere->slice[atmosphere->slices - 1].visibility_m * visibility_above;
}

void blend_at(Blend *out, const Atmosphere *atmosphere, double visibility_m)
{
    double low_m, high_m;
    atmosphere_visibilities(atmosphere, &low_m, &high_m);
    const double v_m = clamp(visibility_m, low_m, high_m);
    const Slice *slice = atmosphere->slice;
    if (atmosphere->slices == 1) {
        *out = (Blend){slice, slice, 0, slice->visibility_m / v_m, 0};
        return;
    }
    int i = 0;
    while (i + 2 < atmosphere->slices && v_m > slice[i + 1].visibility_m) i++;
    const double a = 1 / slice[i].visibility_m, b = 1 / slice[i + 1].visibility_m, x = (1 / v_m - a) / (b - a);
    *out = (Blend){&slice[i], &slice[i + 1], clamp(x, 0, 1), 1 - x, x};
}

static double sum_at(const Profile *profile, const double *per_m, const double *sum, double height_m)
{
    double t;
    const int i = interval_of(&t, profile->height_m, profile->nodes, height_m);
    const double step_m = t * (profile->height_m[i + 1] - profile->height_m[i]);
    return sum[i] + step_m * (per_m[i] + t / 2 * (per_m[i + 1] - per_m[i]));
}

static double value_at(const Profile *profile, const double *per_m, double height_m)
{
    double t;
    const int i = interval_of(&t, profile->height_m, profile->nodes, height_m);
    return per_m[i] + t * (per_m[i + 1] - per_m[i]);
}

/* Mean of a profile between two heights. */
static double mean_of(const Profile *profile, const double *per_m, const double *sum, double a_m, double b_m)
{
    const double top_m = profile->height_m[profile->nodes - 1];
    a_m = clamp(a_m, 0, top_m);
    b_m = clamp(b_m, 0, top_m);
    if (fabs(a_m - b_m) < 1) return value_at(profile, per_m, (a_m + b_m) / 2);
    return (sum_at(profile, per_m, sum, b_m) - sum_at(profile, per_m, sum, a_m)) / (b_m - a_m);
}

/* Beyond the tables' visibilities haze never falls below this share of the clearest table's. */
static double haze_floor(double haze, double clearest) { return fmax(haze, 0.1 * clearest); }

double blend_mean_extinction(const Blend *blend, AirBand band, double a_m, double b_m)
{
    const Profile *low = &blend->low->profile, *high = &blend->high->profile;
    const double haze_low = mean_of(low, low->haze_per_m[band], low->haze_sum[band], a_m, b_m);
    double clear = mean_of(low, low->clear_per_m[band], low->clear_sum[band], a_m, b_m);
    if (low == high) return clear + blend->haze_low * haze_low;
    const double haze_high = mean_of(high, high->haze_per_m[band], high->haze_sum[band], a_m, b_m);
    clear += blend->share * (mean_of(high, high->clear_per_m[band], high->clear_sum[band], a_m, b_m) - clear);
    return clear + haze_floor(blend->haze_low * haze_low + blend->haze_high * haze_high, haze_high);
}

static double blend_of(const Blend *blend, double low, double high) { return low + blend->share * (high - low); }

/* ---- a path -------------------------------------------------------------------------------------- */

int path_emission_weight(const PathTable *table)
{
    int best = 0;
    for (int w = 1; w < table->weights; w++)
        if (!best || fabs(table->weight_temp_k[w] - 280) < fabs(table->weight_temp_k[best] - 280)) best = w;
    return best;
}

/* Two weights and the share of the second for a temperature: straight in its logarithm. */
static int weight_at(double *share, const PathTable *table, double temp_k)
{
    *share = 0;
    if (table->weights < 3) return table->weights - 1;
    double t;
    const int i = interval_of(&t, table->weight_temp_k + 1, table->weights - 1, temp_k);
    const double a = table->weight_temp_k[i + 1], b = table->weight_temp_k[i + 2];
    *share = clamp(log(fmax(temp_k, a) / a) / log(b / a), 0, 1);
    return i + 1;
}

/* One band's stencils in both slices. */
typedef struct Look {
    const Blend     *blend;
    const PathTable *low, *high;
    Stencil          at_low, at_high;
} Look;

static void look_at(Look *out, const Blend *blend, const PathTable *low, const PathTable *high, const AirPath *path)
{
    out->blend = blend;
    out->low = low;
    out->high = high;
    stencil_at(&out->at_low, low, path->observer_m, path->target_m, path->range_m);
    if (low != high) stencil_at(&out->at_high, high, path->observer_m, path->target_m, path->range_m);
}

static double look_value(const Look *look, int value_low, int value_high)
{
    const double low = stencil_value(&look->at_low, look->low, value_low);
    if (look->low == look->high) return low;
    return blend_of(look->blend, low, stencil_value(&look->at_high, look->high, value_high));
}

double blend_ln_ratio(const Blend *blend, AirBand band, const AirPath *path, int weight)
{
    Look look;
    look_at(&look, blend, &blend->low->path[band], &blend->high->path[band], path);
    return look_value(&look, weight, weight);
}

static double ln_ratio_of_temp(const Look *look, double temp_k)
{
    double s, t;
    const int a = weight_at(&s, look->low, temp_k), b = weight_at(&t, look->high, temp_k);
    double low = stencil_value(&look->at_low, look->low, a);
    if (s > 0) low += s * (stencil_value(&look->at_low, look->low, a + 1) - low);
    if (look->low == look->high) return low;
    double high = stencil_value(&look->at_high, look->high, b);
    if (t > 0) high += t * (stencil_value(&look->at_high, look->high, b + 1) - high);
    return blend_of(look->blend, low, high);
}

static AirPath sane_path(const Blend *blend, const AirPath *path)
{
    const Profile *profile = &blend->low->profile;
    const double top_m = profile->height_m[profile->nodes - 1];
    AirPath p = *path;
    p.observer_m = clamp(p.observer_m, 0, top_m);
    p.target_m = clamp(p.target_m, 0, top_m);
    p.range_m = fmax(p.range_m, fabs(p.target_m - p.observer_m));
    return p;
}

static double scattered(const Atmosphere *atmosphere, const Blend *blend, AirBand band, const AirPath *path)
{
    const double estimate = scatter_estimate(atmosphere, blend, band, path);
    const PathTable *low = &blend->low->scattered, *high = &blend->high->scattered;
    if (low->rows == 0 || high->rows == 0) return estimate;
    Look look;
    look_at(&look, blend, low, high, path);
    double ratio[2];
    for (int k = 0; k < 2; k++) {
        const PathTable *table = k ? high : low;
        const Stencil *stencil = k ? &look.at_high : &look.at_low;
        ratio[k] = ratio[0];
        if (k && low == high) break;
        double s, a;
        const int i = interval_of(&s, table->sun_x, table->suns, slant_x(path->sun_zenith_rad));
        const int j = interval_of(&a, table->azimuth_deg, table->azimuths, path->rel_azimuth_rad / rad_per_deg);
        double sum = 0;
        for (int corner = 0; corner < 4; corner++) {
            const double share = (corner & 1 ? s : 1 - s) * (corner & 2 ? a : 1 - a);
            if (share == 0) continue;
            const int node = (i + (corner & 1)) * table->azimuths + j + (corner >> 1);
            sum += share * stencil_value(stencil, table, node * air_scattered_count + air_tabled_index(band));
        }
        ratio[k] = sum;
    }
    return estimate * fmax(blend_of(blend, ratio[0], ratio[1]), 0);
}

static void tabled_path(PathAir *out, const Atmosphere *atmosphere, const Blend *blend, AirBand band,
                        const AirPath *path, double temp_k)
{
    *out = (PathAir){.transmittance = 1, .sun_transmittance = 1};
    if (!(path->range_m > 0)) return;
    Look look;
    look_at(&look, blend, &blend->low->path[band], &blend->high->path[band], path);
    const double plain = path->range_m * blend_mean_extinction(blend, band, path->observer_m, path->target_m);
    out->sun_transmittance = out->transmittance = exp(-plain * exp(look_value(&look, 0, 0)));
    if (air_band_is_thermal(band)) {
        out->transmittance = exp(-plain * exp(ln_ratio_of_temp(&look, temp_k)));
        const int low = path_emission_weight(look.low), high = path_emission_weight(look.high);
        const double depth = plain * exp(look_value(&look, low, high));
        out->thermal_w_m2_sr = exp(look_value(&look, look.low->weights, look.high->weights)) * -expm1(-depth);
    }
    if (path->sun_zenith_rad <= pi_rad / 2 && air_tabled_index(band) < air_scattered_count)
        out->scattered_w_m2_sr = scattered(atmosphere, blend, band, path);
}

static double fold_azimuth(double rad)
{
    return fabs(remainder(rad, 2 * pi_rad));
}

void atmosphere_path(PathAir *out, const Atmosphere *atmosphere, double visibility_m, AirBand band, const AirPath *path,
                     double temp_k)
{
    Blend blend;
    blend_at(&blend, atmosphere, visibility_m);
    AirPath p = sane_path(&blend, path);
    p.rel_azimuth_rad = fold_azimuth(p.rel_azimuth_rad);
    if (band != AIR_PAN) {
        tabled_path(out, atmosphere, &blend, band, &p, temp_k);
        return;
    }
    *out = (PathAir){0};
    const double *top = atmosphere->sun_top_w_m2;
    for (AirBand part = AIR_B; part <= AIR_R; part++) {
        PathAir one;
        tabled_path(&one, atmosphere, &blend, part, &p, temp_k);
        out->sun_transmittance += top[part] / top[AIR_PAN] * one.sun_transmittance;
        out->scattered_w_m2_sr += one.scattered_w_m2_sr;
    }
    out->transmittance = out->sun_transmittance;
}

/* ---- sky and sun ----------------------------------------------------------------------------------- */

void blend_sun(SunAir *out, const Atmosphere *atmosphere, const Blend *blend, AirBand band, double observer_m,
               double sun_zenith_rad)
{
    *out = (SunAir){0};
    if (!(sun_zenith_rad <= pi_rad / 2)) return;
    double low[2 * air_tabled_count], high[2 * air_tabled_count];
    const double at[2] = {observer_m, slant_x(sun_zenith_rad)}, top = atmosphere->sun_top_w_m2[band];
    const int i = air_tabled_index(band), d = i + air_tabled_count;
    grid_at(low, &blend->low->sun, at);
    double depth = exp(low[i]), diffuse = exp(low[d]);
    if (blend->high != blend->low) {
        grid_at(high, &blend->high->sun, at);
        const double clearest = exp(high[i]), clearest_diffuse = exp(high[d]);
        depth = fmax(blend->haze_low * depth + blend->haze_high * clearest, 0.3 * clearest);
        diffuse = clamp(blend->haze_low * diffuse + blend->haze_high * clearest_diffuse, 0.3 * clearest_diffuse, 1);
    }
    out->direct_normal_w_m2 = top * exp(-depth);
    out->diffuse_horizontal_w_m2 = top * diffuse;
}

void atmosphere_sun(SunAir *out, const Atmosphere *atmosphere, double visibility_m, AirBand band, double observer_m,
                    double sun_zenith_rad)
{
    Blend blend;
    blend_at(&blend, atmosphere, visibility_m);
    if (band != AIR_PAN) {
        blend_sun(out, atmosphere, &blend, band, observer_m, sun_zenith_rad);
        return;
    }
    *out = (SunAir){0};
    for (AirBand part = AIR_B; part <= AIR_R; part++) {
        SunAir one;
        blend_sun(&one, atmosphere, &blend, part, observer_m, sun_zenith_rad);
        out->direct_normal_w_m2 += one.direct_normal_w_m2;
        out->diffuse_horizontal_w_m2 += one.diffuse_horizontal_w_m2;
    }
}

static double sky_scattered(const Atmosphere *atmosphere, const Blend *blend, AirBand band, const double at[4],
                            const double angle_rad[3])
{
    double low[air_scattered_count], high[air_scattered_count];
    grid_at(low, &blend->low->sky_scattered, at);
    grid_at(high, &blend->high->sky_scattered, at);
    const int i = air_tabled_index(band);
    return fmax(blend_of(blend, low[i], high[i]), 0) *
           scatter_estimate_sky(atmosphere, blend, band, at[0], angle_rad[0], angle_rad[1], angle_rad[2]);
}

void atmosphere_sky(SkyAir *out, const Atmosphere *atmosphere, double visibility_m, AirBand band, double observer_m,
                    double zenith_rad, double sun_zenith_rad, double rel_azimuth_rad)
{
    Blend blend;
    blend_at(&blend, atmosphere, visibility_m);
    const double angle_rad[3] = {clamp(zenith_rad, 0, pi_rad / 2), sun_zenith_rad, fold_azimuth(rel_azimuth_rad)};
    const double top_m = blend.low->profile.height_m[blend.low->profile.nodes - 1];
    const double at[4] = {clamp(observer_m, 0, top_m), slant_x(angle_rad[0]), slant_x(angle_rad[1]),
                          angle_rad[2] / rad_per_deg};
    *out = (SkyAir){0};
    if (air_band_is_thermal(band)) {
        double low[2], high[2];
        grid_at(low, &blend.low->sky_thermal, at);
        grid_at(high, &blend.high->sky_thermal, at);
        const int i = band == AIR_LWIR;
        out->thermal_w_m2_sr = exp(blend_of(&blend, low[i], high[i]));
    }
    if (!(sun_zenith_rad <= pi_rad / 2) || band == AIR_LWIR) return;
    for (AirBand part = band == AIR_PAN ? AIR_B : band; part <= (band == AIR_PAN ? AIR_R : band); part++)
        out->scattered_w_m2_sr += sky_scattered(atmosphere, &blend, part, at, angle_rad);
}

double atmosphere_longwave_down(const Atmosphere *atmosphere, double visibility_m)
{
    Blend blend;
    blend_at(&blend, atmosphere, visibility_m);
    return blend_of(&blend, blend.low->longwave_down_w_m2, blend.high->longwave_down_w_m2);
}

double atmosphere_temp_k(const Atmosphere *atmosphere, double height_m)
{
    double temp_k;
    grid_at(&temp_k, &atmosphere->temperature, &height_m);
    return temp_k;
}
