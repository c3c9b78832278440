/* render/air/atmosphere.c: evaluates paths, the sky and the sun between the tables' points and visibilities. */
#include "render/air/atmosphere_private.h"

const AirBand air_tabled[air_tabled_count] = {AIR_B, AIR_G, AIR_R, AIR_NIR, AIR_MWIR, AIR_LWIR};

const char *air_band_name(AirBand band)
{
    return band < AIR_BAND_COUNT && *channel_in(band)->name ? channel_in(band)->name : "?";
}

void air_band_edges(double *low_m, double *high_m, AirBand band)
{
    *low_m = channel_in(band)->low_m;
    *high_m = channel_in(band)->high_m;
}

int air_tabled_index(AirBand band)
{
    for (int i = 0; i < air_tabled_count; i++)
        if (air_tabled[i] == band) return i;
    return -1;
}

/* ---- between visibilities ---------------------------------------------------------------------- */

void atmosphere_visibilities(const Atmosphere *atmosphere, double *low_m, double *high_m)
{
    *low_m = atmosphere->low_m;
    *high_m = atmosphere->high_m;
}

void blend_at(Blend *out, const Atmosphere *atmosphere, double visibility_m)
{
    const double v_m = clamp(visibility_m, atmosphere->low_m, atmosphere->high_m);
    const Slice *slice = atmosphere->slice;
    if (atmosphere->slices == 1) {
        *out = (Blend){slice, slice, 0, slice->visibility_m / v_m, 0};
        return;
    }
    int i = 0;
    while (i + 2 < atmosphere->slices && v_m > slice[i + 1].visibility_m) i++;
    const double a = 1 / slice[i].visibility_m, b = 1 / slice[i + 1].visibility_m;
    const double x = clamp((1 / v_m - a) / (b - a), 0, 1);
    *out = (Blend){&slice[i], &slice[i + 1], x, 1 - x, x};
}

static double value_at(const AirColumn *column, const double *value, double height_m)
{
    double    t;
    const int i = interval_of(&t, column->height_m, column->nodes, height_m);
    return value[i] + t * (value[i + 1] - value[i]);
}

static double sum_at(const AirColumn *column, const double *value, const double *sum, double height_m)
{
    double       t;
    const int    i = interval_of(&t, column->height_m, column->nodes, height_m);
    const double step_m = t * (column->height_m[i + 1] - column->height_m[i]);
    return sum[i] + step_m * (value[i] + t / 2 * (value[i + 1] - value[i]));
}

static double mean_of(const AirColumn *column, const double *value, const double *sum, double a_m, double b_m)
{
    const double top_m = column->height_m[column->nodes - 1];
    a_m = clamp(a_m, 0, top_m);
    b_m = clamp(b_m, 0, top_m);
    if (fabs(a_m - b_m) < 1) return value_at(column, value, (a_m + b_m) / 2);
    return (sum_at(column, value, sum, b_m) - sum_at(column, value, sum, a_m)) / (b_m - a_m);
}

double column_mean(const AirColumn *column, AirBand band, double a_m, double b_m)
{
    return mean_of(column, column->per_m[band], column->sum[band], a_m, b_m);
}

double column_scatter(const AirColumn *column, AirBand band, double height_m)
{
    return value_at(column, column->scatter_per_m[band], height_m);
}

static double blend_haze(const Blend *blend, double low, double high)
{
    return blend->haze_low * low + blend->haze_high * high;
}

double blend_haze_mean(const Blend *blend, AirBand band, double a_m, double b_m)
{
    const double low = column_mean(&blend->low->haze, band, a_m, b_m);
    if (blend->low == blend->high) return blend->haze_low * low;
    return blend_haze(blend, low, column_mean(&blend->high->haze, band, a_m, b_m));
}

double blend_haze_scatter(const Blend *blend, AirBand band, double height_m)
{
    const double low = column_scatter(&blend->low->haze, band, height_m);
    if (blend->low == blend->high) return blend->haze_low * low;
    return blend_haze(blend, low, column_scatter(&blend->high->haze, band, height_m));
}

static double blend_of(const Blend *blend, double low, double high) { return low + blend->share * (high - low); }

double black_air(const Atmosphere *atmosphere, AirBand band, double height_m)
{
    return planck_table_radiance(atmosphere->planck[band == AIR_LWIR], atmosphere_temp_k(atmosphere, height_m));
}

double mean_black(const Atmosphere *atmosphere, AirBand band, double a_m, double b_m)
{
    const AirColumn *clear = &atmosphere->clear;
    const int        i = band == AIR_LWIR;
    return mean_of(clear, clear->black_per_m[i], clear->black_sum[i], a_m, b_m) / column_mean(clear, band, a_m, b_m);
}

/* ---- a path -------------------------------------------------------------------------------------- */

int path_emission_weight(const PathTable *table)
{
    int best = 0;
    for (int w = 1; w < table->weights; w++)
        if (!best || fabs(table->weight_temp_k[w] - 280) < fabs(table->weight_temp_k[best] - 280)) best = w;
    return best;
}

double path_weight_value(const PathTable *table, const Stencil *at, double temp_k)
{
    if (isnan(temp_k) || table->weights < 2) return stencil_value(at, table, 0);
    if (table->weights == 2) return stencil_value(at, table, 1);
    double       t;
    const int    i = 1 + interval_of(&t, table->weight_temp_k + 1, table->weights - 1, temp_k);
    const double a = 1 / table->weight_temp_k[i], b = 1 / table->weight_temp_k[i + 1];
    const double share = clamp((1 / temp_k - a) / (b - a), 0, 1), low = stencil_value(at, table, i);
    return share > 0 ? low + share * (stencil_value(at, table, i + 1) - low) : low;
}

/* All inputs of a band's path, computed once. */
typedef struct Look {
    const Atmosphere *atmosphere;
    const Blend      *blend;
    AirBand           band;
    Stencil           clear, low, high;
    double            clear_plain, haze_plain; /* depths from the columns alone */
} Look;

static void add_plain(Look *out, const AirPath *piece, double share)
{
    const double sag_m = mean_chord_error_m(piece->range_m), a_m = piece->observer_m - sag_m,
                 b_m = piece->target_m - sag_m, length_m = share * piece->range_m;
    if (!(share > 0)) return;
    out->clear_plain += length_m * column_mean(&out->atmosphere->clear, out->band, a_m, b_m);
    if (out->blend) out->haze_plain += length_m * blend_haze_mean(out->blend, out->band, a_m, b_m);
}

static void look_at(Look *out, const Atmosphere *atmosphere, const Blend *blend, AirBand band, const AirPath *path)
{
    AirPath   piece[air_pieces_max];
    const int pieces = air_leg_pieces(piece, path);
    *out = (Look){.atmosphere = atmosphere, .blend = blend, .band = band};
    stencil_at(&out->clear, &atmosphere->clear_path[band], path->observer_m, path->target_m, path->range_m);
    if (blend) stencil_at(&out->low, &blend->low->path[band], path->observer_m, path->target_m, path->range_m);
    if (blend && blend->low != blend->high)
        stencil_at(&out->high, &blend->high->path[band], path->observer_m, path->target_m, path->range_m);
    add_plain(out, path, pieces > 1 ? 1 - air_pieces_share(path) : 1);
    for (int i = 0; i < pieces && pieces > 1; i++) add_plain(out, &piece[i], air_pieces_share(path));
}

static double look_depth(const Look *look, double temp_k)
{
    const Blend     *blend = look->blend;
    const AirBand    band = look->band;
    const PathTable *clear = &look->atmosphere->clear_path[band];
    double           depth = look->clear_plain * exp(path_weight_value(clear, &look->clear, temp_k));
    if (!blend) return depth;
    double haze = path_weight_value(&blend->low->path[band], &look->low, temp_k);
    if (blend->low != blend->high)
        haze = blend_of(blend, haze, path_weight_value(&blend->high->path[band], &look->high, temp_k));
    return depth + look->haze_plain * fmax(haze, 0);
}

/* ln of the ratio of the radiance of the path, if it were opaque, to mean_black. */
static double look_ln_opaque(const Look *look)
{
    const Blend     *blend = look->blend;
    const PathTable *low = &blend->low->path[look->band], *high = &blend->high->path[look->band];
    const double     value = stencil_value(&look->low, low, low->weights);
    return low == high ? value : blend_of(blend, value, stencil_value(&look->high, high, high->weights));
}

void clear_depths(double *out, const Atmosphere *atmosphere, AirBand band, const AirPath *path, const double *temp_k,
                  int temps)
{
    Look look;
    look_at(&look, atmosphere, NULL, band, path);
    for (int t = 0; t < temps; t++) out[t] = look_depth(&look, temp_k[t]);
}

double path_depth(const Atmosphere *atmosphere, const Blend *blend, AirBand band, const AirPath *path, double temp_k)
{
    Look look;
    look_at(&look, atmosphere, blend, band, path);
    return look_depth(&look, temp_k);
}

/* Of the tables of paths. */
static double top_of(const Atmosphere *atmosphere)
{
    const PathTable *table = &atmosphere->clear_path[AIR_B];
    return fmin(table->axis[0][table->nodes[0] - 1], table->axis[1][table->nodes[1] - 1]);
}

/* The legs of a path, of which heights and range are made possible. */
static AirLegs legs_of(const Atmosphere *atmosphere, const AirPath *path)
{
    AirPath p = *path;
    p.observer_m = fmax(p.observer_m, 0);
    p.target_m = fmax(p.target_m, 0);
    p.range_m = fmax(p.range_m, fabs(p.target_m - p.observer_m));
    p.rel_azimuth_rad = fabs(remainder(p.rel_azimuth_rad, 2 * pi_rad));
    return air_legs(&p, top_of(atmosphere));
}

double scattered_value(const PathTable *table, const Stencil *at, double sun_x, double azimuth_deg, int tabled)
{
    double    s, a, sum = 0;
    const int i = interval_of(&s, table->sun_x, table->suns, sun_x);
    const int j = interval_of(&a, table->azimuth_deg, table->azimuths, azimuth_deg);
    for (int corner = 0; corner < 4; corner++) {
        const double share = (corner & 1 ? s : 1 - s) * (corner & 2 ? a : 1 - a);
        if (share == 0) continue;
        const int node = (i + (corner & 1)) * table->azimuths + j + (corner >> 1);
        sum += share * stencil_value(at, table, node * air_tabled_count + tabled);
    }
    return sum;
}

/* Ratio of scattered light to its estimate, of one visibility. */
static double scattered_ratio(const PathTable *table, AirBand band, const AirPath *path)
{
    Stencil stencil;
    stencil_at(&stencil, table, path->observer_m, -path_up(path), path->range_m);
    return scattered_value(table, &stencil, slant_x(path->sun_zenith_rad), path->rel_azimuth_rad / rad_per_deg,
                           air_tabled_index(band));
}

static double scattered(const Atmosphere *atmosphere, const Blend *blend, AirBand band, const AirPath *path,
                        double depth)
{
    ScatterParts parts;
    scatter_parts(&parts, atmosphere, blend, band, path, depth);
    double ratio = scattered_ratio(&blend->low->scattered, band, path);
    if (blend->low != blend->high) ratio = blend_of(blend, ratio, scattered_ratio(&blend->high->scattered, band, path));
    return fmax(ratio, 0) *
           scatter_estimate(&parts, atmosphere, band, path_up(path), path->sun_zenith_rad, path->rel_azimuth_rad);
}

/* Optical depths of a leg or path, for sunlight, the emitter and the air's own emission; and its radiance. */
typedef struct PathDepths {
    double sun, emitted, own, thermal_w_m2_sr, scattered_w_m2_sr;
} PathDepths;

static PathDepths single_depths(const Atmosphere *atmosphere, const Blend *blend, AirBand band, const AirPath *leg,
                                double temp_k)
{
    PathDepths out = {0};
    Look       look;
    look_at(&look, atmosphere, blend, band, leg);
    out.sun = out.emitted = look_depth(&look, NAN);
    if (!air_band_is_thermal(band)) return out;
    const PathTable *table = &blend->low->path[band];
    out.emitted = look_depth(&look, temp_k);
    out.own = look_depth(&look, table->weight_temp_k[path_emission_weight(table)]);
    out.thermal_w_m2_sr =
        exp(look_ln_opaque(&look)) * mean_black(atmosphere, band, leg->observer_m, leg->target_m) * -expm1(-out.own);
    return out;
}

/* A leg in pieces scatters as each of them if it were alone. */
static PathDepths leg_depths(const Atmosphere *atmosphere, const Blend *blend, AirBand band, const AirPath *leg,
                             double temp_k)
{
    AirPath    piece[air_pieces_max];
    const int  pieces = air_leg_pieces(piece, leg);
    PathDepths out = single_depths(atmosphere, blend, band, leg, temp_k);
    double     left = 1, scatters = 0;
    if (leg->sun_zenith_rad > pi_rad / 2) return out;
    out.scattered_w_m2_sr = scattered(atmosphere, blend, band, leg, out.sun);
    if (pieces == 1) return out;
    for (int i = 0; i < pieces; i++) {
        const double depth = single_depths(atmosphere, blend, band, &piece[i], temp_k).sun;
        scatters += left * scattered(atmosphere, blend, band, &piece[i], depth);
        left *= exp(-depth);
    }
    out.scattered_w_m2_sr = mixed(out.scattered_w_m2_sr, scatters, air_pieces_share(leg));
    return out;
}

static void tabled_path(PathAir *out, const Atmosphere *atmosphere, const Blend *blend, AirBand band,
                        const AirPath *path, double temp_k)
{
    const AirLegs legs_are = legs_of(atmosphere, path), *legs = &legs_are;
    PathDepths    way = {0};
    if (legs->count > 0) way = leg_depths(atmosphere, blend, band, &legs->leg[0], temp_k);
    if (legs->count > 1) {
        const PathDepths behind = leg_depths(atmosphere, blend, band, &legs->leg[1], temp_k);
        const double     tangent_m = legs->leg[0].target_m;
        way.scattered_w_m2_sr += behind.scattered_w_m2_sr * exp(-way.sun);
        way.thermal_w_m2_sr += behind.thermal_w_m2_sr * air_legs_passed(band, tangent_m, way.own, behind.own);
        way.sun = air_legs_depth(band, tangent_m, way.sun, behind.sun);
        way.emitted = air_legs_depth(band, tangent_m, way.emitted, behind.emitted);
        if (legs->cut < 1) {
            const PathDepths whole = leg_depths(atmosphere, blend, band, &legs->whole, temp_k);
            way.scattered_w_m2_sr = mixed(whole.scattered_w_m2_sr, way.scattered_w_m2_sr, legs->cut);
            way.thermal_w_m2_sr = mixed(whole.thermal_w_m2_sr, way.thermal_w_m2_sr, legs->cut);
            way.sun = mixed(whole.sun, way.sun, legs->cut);
            way.emitted = mixed(whole.emitted, way.emitted, legs->cut);
        }
    }
    if (air_band_is_thermal(band) && legs->count > 0) {
        const double eye_m = fmax(path->observer_m, 0), up = air_ray_up(path);
        way.thermal_w_m2_sr += air_above_top(atmosphere, blend, band, eye_m, up, top_of(atmosphere));
        double factor[2];
        air_limb_factors(factor, atmosphere, blend, eye_m, up, path->range_m);
        way.thermal_w_m2_sr *= factor[band == AIR_LWIR];
    }
    *out = (PathAir){exp(-way.emitted), exp(-way.sun), way.thermal_w_m2_sr, way.scattered_w_m2_sr};
}

void atmosphere_path(PathAir *out, const Atmosphere *atmosphere, double visibility_m, AirBand band, const AirPath *path,
                     double temp_k)
{
    Blend blend;
    blend_at(&blend, atmosphere, visibility_m);
    if (band != AIR_PAN) {
        tabled_path(out, atmosphere, &blend, band, path, temp_k);
        return;
    }
    *out = (PathAir){0};
    const double *top = atmosphere->sun_top_w_m2;
    for (AirBand part = AIR_B; part <= AIR_R; part++) {
        PathAir one;
        tabled_path(&one, atmosphere, &blend, part, path, temp_k);
        out->sun_transmittance += top[part] / top[AIR_PAN] * one.sun_transmittance;
        out->scattered_w_m2_sr += one.scattered_w_m2_sr;
    }
    out->transmittance = out->sun_transmittance;
}

/* ---- sky and sun ----------------------------------------------------------------------------------- */

/* ln depth and ln (diffuse / top) of a visibility. */
static void slice_sun(double out[2], const Atmosphere *atmosphere, const Slice *slice, AirBand band, double observer_m,
                      double slant)
{
    const double at[2] = {observer_m, slant};
    if (!atmosphere->mix) {
        grid_some(out, &slice->sun, at, air_tabled_index(band), air_tabled_count, 2);
        return;
    }
    double    t, high[2];
    const int i = interval_of(&t, slice->sun.axis[0], slice->sun.nodes[0], observer_m);
    sun_node(out, atmosphere, slice, band, i, slant);
    if (!(t > 0)) return;
    sun_node(high, atmosphere, slice, band, i + 1, slant);
    for (int k = 0; k < 2; k++) out[k] += t * (high[k] - out[k]);
}

void blend_sun(SunAir *out, const Atmosphere *atmosphere, const Blend *blend, AirBand band, double observer_m,
               double sun_zenith_rad)
{
    *out = (SunAir){0};
    if (!(sun_zenith_rad <= pi_rad / 2)) return;
    double       low[2], high[2]; /* ln depth, ln (diffuse / top) */
    const double slant = slant_x(sun_zenith_rad), top = atmosphere->sun_top_w_m2[band];
    slice_sun(low, atmosphere, blend->low, band, observer_m, slant);
    double depth = exp(low[0]), diffuse = exp(low[1]);
    if (blend->high != blend->low) {
        slice_sun(high, atmosphere, blend->high, band, observer_m, slant);
        const double clearest = exp(high[0]), clearest_diffuse = exp(high[1]);
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
    double low, high;
    grid_some(&low, &blend->low->sky_scattered, at, air_tabled_index(band), 1, 1);
    grid_some(&high, &blend->high->sky_scattered, at, air_tabled_index(band), 1, 1);
    ScatterParts parts;
    scatter_parts_sky(&parts, atmosphere, blend, band, at[0], angle_rad[0], angle_rad[1]);
    return fmax(blend_of(blend, low, high), 0) *
           scatter_estimate(&parts, atmosphere, band, cos(angle_rad[0]), angle_rad[1], angle_rad[2]);
}

static SkyAir sky_above(const Atmosphere *atmosphere, const Blend *blend, AirBand band, double observer_m,
                        const double angle_rad[3])
{
    SkyAir       out = {0};
    const double at[4] = {observer_m, slant_x(angle_rad[0]), slant_x(angle_rad[1]), angle_rad[2] / rad_per_deg};
    if (air_band_is_thermal(band))
        out.thermal_w_m2_sr = air_sky_thermal(atmosphere, blend, band, observer_m, angle_rad[0]);
    if (angle_rad[1] <= pi_rad / 2) out.scattered_w_m2_sr = sky_scattered(atmosphere, blend, band, at, angle_rad);
    return out;
}

void atmosphere_sky(SkyAir *out, const Atmosphere *atmosphere, double visibility_m, AirBand band, double observer_m,
                    double zenith_rad, double sun_zenith_rad, double rel_azimuth_rad)
{
    Blend blend;
    blend_at(&blend, atmosphere, visibility_m);
    const double eye_m = fmax(observer_m, 0), up = cos(zenith_rad);
    const bool   below = up < 0 && eye_m > 0;
    const double angle_rad[3] = {clamp(zenith_rad, 0, pi_rad / 2), sun_zenith_rad,
                                 fabs(remainder(rel_azimuth_rad, 2 * pi_rad))};
    /* below the horizontal: the air to the lowest point, and the level sky behind it */
    AirPath      path = air_path_down(eye_m, up);
    const double tangent_m = path.target_m;
    path.sun_zenith_rad = sun_zenith_rad, path.rel_azimuth_rad = rel_azimuth_rad;
    const AirLegs legs = below ? legs_of(atmosphere, &path) : (AirLegs){0}; /* which asks for tables of paths */
    *out = (SkyAir){0};
    for (AirBand part = band == AIR_PAN ? AIR_B : band; part <= (band == AIR_PAN ? AIR_R : band); part++) {
        const SkyAir sky = sky_above(atmosphere, &blend, part, tangent_m, angle_rad);
        PathDepths   way = {0};
        if (legs.count > 0) way = leg_depths(atmosphere, &blend, part, &legs.leg[0], NAN);
        double thermal = way.thermal_w_m2_sr + sky.thermal_w_m2_sr * air_legs_sky_passed(part, tangent_m, way.own);
        if (below && air_band_is_thermal(part)) {
            thermal += air_above_top(atmosphere, &blend, part, eye_m, up, top_of(atmosphere));
            double factor[2];
            air_limb_factors(factor, atmosphere, &blend, eye_m, up, INFINITY);
            thermal *= factor[part == AIR_LWIR];
        }
        out->thermal_w_m2_sr += thermal;
        out->scattered_w_m2_sr += way.scattered_w_m2_sr + sky.scattered_w_m2_sr * exp(-way.sun);
    }
}

double atmosphere_longwave_down(const Atmosphere *atmosphere, double visibility_m)
{
    static const double sigma_w_m2_k4 = 5.670374419184429e-8; /* Stefan and Boltzmann's */
    const Vapour       *v = atmosphere->vapour;
    const VapourMix    *mix = atmosphere->mix;
    Blend               blend;
    blend_at(&blend, atmosphere, visibility_m);
    const double model_w_m2 = blend_of(&blend, blend.low->longwave_down_w_m2, blend.high->longwave_down_w_m2);
    if (!mix) return model_w_m2;
    /* over a black sky of the ground's temperature, each of its own */
    const VapourProfile *own = &v->profile[atmosphere->vapour_profile];
    const double         black_w_m2 = sigma_w_m2_k4 * pow(own->temp_k, 4);
    double               now = 0;
    for (int k = 0; k < mix->nodes; k++)
        now += mix->share[0][k] * (double)vapour_node(v, mix->node[k])[vapour_longwave_at] /
               (sigma_w_m2_k4 * pow(v->profile[mix->profile[mix->of[k]]].temp_k, 4));
    return sigma_w_m2_k4 * pow(mix->temp_k, 4) *
           emissivity_in(model_w_m2 / black_w_m2, (double)vapour_node(v, own->own)[vapour_longwave_at] / black_w_m2,
                         now);
}

double atmosphere_temp_k(const Atmosphere *atmosphere, double height_m)
{
    double temp_k;
    grid_at(&temp_k, &atmosphere->temperature, &height_m);
    return temp_k;
}
