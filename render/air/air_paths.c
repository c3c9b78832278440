/* render/air/air_paths.c: transmittance and path radiance for thousands of samples a frame: eight at a time, all
 * bands from one computation of the table position. A sample's result depends on its own path alone. */
#include "render/air/air_private.h"

#include "pitviper_simd.h"

static inline F32x8 mul(F32x8 a, F32x8 b) { return a * b; }
static inline F32x8 add(F32x8 a, F32x8 b) { return a + b; }
static inline F32x8 sub(F32x8 a, F32x8 b) { return a - b; }
/* NaN, as the unused end of a block may hold, becomes low. */
static inline F32x8 within(F32x8 x, F32x8 low, F32x8 high) { return f32x8_min(f32x8_max(x, low), high); }

/* ---- ends of eight paths, in steps of the table ------------------------------------------------ */

typedef struct Places {
    _Alignas(32) int node[8], turn_node[8], heat_node[8]; /* lower height, nearer range; lower slope, nearer share
                                                           * of the path, lower azimuth; node of the lower
                                                           * temperature */
    _Alignas(32) float height[8], range[8], slope[8], share[8], turn[8]; /* shares of the upper nodes */
    F32x8 temp, near; /* near: range over the table's nearest, .. 1 */
} Places;

/* The part of each path of a block that is in the tables' air: its length, and the rate of climb where it begins. */
typedef struct Parts {
    _Alignas(32) float air_m[hits_capacity], climb[hits_capacity];
} Parts;

/* Constants for all eights of a block. */
typedef struct Look {
    const AirTable *table;
    __m128i         row_shift;
    __m256i         row_mask;
    F32x8           eye_m, down_m, row_share, height_most_m, per_fall_m, per_climb_m, per_longest_m;
    F32x8 sun_east, sun_north, slope_low, slope_steps, slope_edge, slope_steps_above, turn_low, turn_steps, turn_most;
    F32x8 temp_low, per_ln_temp; /* of each step of emitter_temp_k */
} Look;

static Look look_from(const Air *air)
{
    const AirTable *table = air->table;
    const double    level = hypot(air->light.sun_d_enu[0], air->light.sun_d_enu[1]), eye_m = air_from_m(air);
    const float     top_m = air_step_up(air_low_m, table->rows, table->row_shift);
    float           temp_low[8] = {0}, per_ln_temp[8] = {0};
    for (int k = 0; k < air_temps - 1; k++) {
        temp_low[k] = (float)emitter_temp_k[k];
        per_ln_temp[k] = (float)(1 / log(emitter_temp_k[k + 1] / emitter_temp_k[k]));
    }
    return (Look){.table = table,
                  .temp_low = _mm256_loadu_ps(temp_low),
                  .per_ln_temp = _mm256_loadu_ps(per_ln_temp),
                  .row_shift = _mm_cvtsi32_si128(table->row_shift),
                  .row_mask = _mm256_set1_epi32((1 << table->row_shift) - 1),
                  .row_share = f32x8_set(ldexp(1, -table->row_shift)),
                  .height_most_m = _mm256_set1_ps(nextafterf(top_m, 0)),
                  .eye_m = f32x8_set(eye_m),
                  .down_m = f32x8_set(-eye_m),
                  .per_fall_m = f32x8_set(1 / fmax(eye_m, air_least_fall_m)),
                  .per_longest_m = f32x8_set(1 / air_longest_m(air)),
                  .per_climb_m = f32x8_set(1 / fmax(air_top_m - eye_m, 1e-3)),
                  .sun_east = f32x8_set(level > 1e-10 ? air->light.sun_d_enu[0] / level : 1),
                  .sun_north = f32x8_set(level > 1e-10 ? air->light.sun_d_enu[1] / level : 0),
                  .slope_low = f32x8_set((double)table->slope_low),
                  .slope_steps = f32x8_set((double)table->slope_steps),
                  .slope_edge = f32x8_set((double)table->slope_edge),
                  .slope_steps_above = f32x8_set((double)table->slope_steps_above),
                  .turn_low = f32x8_set((double)table->turn_low),
                  .turn_steps = f32x8_set((double)table->turn_steps),
                  .turn_most = f32x8_set(table->turns - 1e-3)};
}

static inline __m256i bits_above(F32x8 x, double low)
{
    return _mm256_sub_epi32(_mm256_castps_si256(x), _mm256_castps_si256(f32x8_set(low)));
}

static inline __m256i row_times(__m256i i, int row) { return _mm256_mullo_epi32(i, _mm256_set1_epi32(row)); }

static inline void find_places(Places *p, const Look *look, const Parts *parts, const Rays *rays, int i)
{
    const F32x8 dx = f32x8_of_doubles(rays->d_enu[0] + i), dy = f32x8_of_doubles(rays->d_enu[1] + i);
    const F32x8 far_m = _mm256_set1_ps(nextafterf((float)air_far_m, 0)); /* (1 << air_octaves) nearest ones */
    const F32x8 at = within(_mm256_load_ps(parts->air_m + i), f32x8_set(0), far_m),
                level2 = f32x8_fma(dx, dx, mul(dy, dy));
    const F32x8 climb = _mm256_load_ps(parts->climb + i), one = f32x8_set(1);
    /* the tangent plane leaves the Earth along the path */
    const F32x8 bend = mul(sub(one, mul(climb, climb)), f32x8_set(0.5 / earth_radius_m));
    const F32x8 rise_m = _mm256_max_ps(mul(at, f32x8_fma(at, bend, climb)), look->down_m);

    /* height and range from the bits of the floats */
    const F32x8   h = _mm256_min_ps(add(add(look->eye_m, rise_m), f32x8_set(air_low_m)), look->height_most_m);
    const F32x8   r = mul(at, f32x8_set(1 / air_near_m));
    const __m256i hb = bits_above(_mm256_max_ps(h, f32x8_set(air_low_m)), air_low_m);
    const __m256i rb = bits_above(_mm256_max_ps(r, f32x8_set(1)), 1);
    const __m256i hi = _mm256_srl_epi32(hb, look->row_shift), ri = _mm256_srli_epi32(rb, air_range_shift);
    _mm256_store_ps(p->height, mul(_mm256_cvtepi32_ps(_mm256_and_si256(hb, look->row_mask)), look->row_share));
    const __m256i rest = _mm256_and_si256(rb, _mm256_set1_epi32((1 << air_range_shift) - 1));
    _mm256_store_ps(p->range, mul(_mm256_cvtepi32_ps(rest), f32x8_set(1.0 / (1 << air_range_shift))));
    _mm256_store_si256((__m256i *)p->node, _mm256_add_epi32(row_times(hi, air_range_row), ri));
    p->near = _mm256_min_ps(r, f32x8_set(1));

    const F32x8   rise = _mm256_div_ps(rise_m, _mm256_max_ps(at, f32x8_set(1e-3)));
    const F32x8   root = _mm256_or_ps(_mm256_sqrt_ps(f32x8_abs(rise)), _mm256_and_ps(rise, f32x8_set(-0.0)));
    const F32x8   below = mul(sub(_mm256_min_ps(root, look->slope_edge), look->slope_low), look->slope_steps);
    const F32x8   above = mul(_mm256_max_ps(sub(root, look->slope_edge), f32x8_set(0)), look->slope_steps_above);
    const F32x8   s = within(add(below, above), f32x8_set(0), f32x8_set(air_slopes - 1e-3));
    const __m256i si = _mm256_cvttps_epi32(s);
    /* range over the complete path, which ends at the ground or the top, and within its limits */
    const F32x8 per_m = _mm256_blendv_ps(look->per_climb_m, look->per_fall_m, rise);
    const F32x8 gone =
        within(mul(f32x8_abs(rise_m), per_m), mul(at, look->per_longest_m), mul(at, f32x8_set(1 / air_shortest_way_m)));
    const F32x8 w =
        within(mul(_mm256_sqrt_ps(gone), f32x8_set(air_shares)), f32x8_set(0), f32x8_set(air_shares - 1e-3));
    const __m256i wi = _mm256_cvttps_epi32(w);
    const F32x8   level = _mm256_sqrt_ps(_mm256_max_ps(level2, f32x8_set(1e-12)));
    const F32x8   cosine = _mm256_div_ps(f32x8_fma(dx, look->sun_east, mul(dy, look->sun_north)), level);
    const F32x8   turn = _mm256_sqrt_ps(_mm256_max_ps(sub(f32x8_set(1), cosine), f32x8_set(0)));
    const F32x8   a = within(mul(sub(turn, look->turn_low), look->turn_steps), f32x8_set(0), look->turn_most);
    const __m256i ai = _mm256_cvttps_epi32(a);
    _mm256_store_ps(p->slope, sub(s, _mm256_cvtepi32_ps(si)));
    _mm256_store_ps(p->share, sub(w, _mm256_cvtepi32_ps(wi)));
    _mm256_store_ps(p->turn, sub(a, _mm256_cvtepi32_ps(ai)));
    const __m256i slope_node = _mm256_add_epi32(row_times(si, air_share_row), wi);
    _mm256_store_si256((__m256i *)p->turn_node, _mm256_add_epi32(row_times(ai, air_slope_nodes), slope_node));
}

/* Emitters by their own temperature; NaN counts as the coldest. ln(t / a) is 2 atanh((t - a) / (t + a)), of which three
 * terms leave 1e-4 over the widest step. */
static inline void find_temps(Places *p, const Look *look, const float *temp_k)
{
    const F32x8 t =
        within(_mm256_loadu_ps(temp_k), f32x8_set(emitter_temp_k[0]), f32x8_set(emitter_temp_k[air_temps - 1]));
    __m256i k = _mm256_setzero_si256();
    for (int step = 1; step < air_temps - 1; step++) /* true is -1 */
        k = _mm256_sub_epi32(k, _mm256_castps_si256(_mm256_cmp_ps(t, f32x8_set(emitter_temp_k[step]), _CMP_GE_OQ)));
    const F32x8 a = _mm256_permutevar8x32_ps(look->temp_low, k);
    const F32x8 z = _mm256_div_ps(sub(t, a), add(t, a)), z2 = mul(z, z);
    const F32x8 ln = mul(z, f32x8_fma(z2, f32x8_fma(z2, f32x8_set(0.4), f32x8_set(2.0 / 3)), f32x8_set(2)));
    p->temp = mul(ln, _mm256_permutevar8x32_ps(look->per_ln_temp, k));
    _mm256_store_si256((__m256i *)p->heat_node,
                       _mm256_add_epi32(row_times(k, air_nodes), _mm256_load_si256((const __m256i *)p->node)));
}

/* ---- values of the table ------------------------------------------------------------------------- */

/* Eight rows of four to four values of eight. */
static inline void turn_four(F32x8 out[4], const __m128 row[8])
{
    F32x8 pair[4];
    for (int j = 0; j < 4; j++) pair[j] = _mm256_set_m128(row[j + 4], row[j]);
    const F32x8 a = _mm256_unpacklo_ps(pair[0], pair[1]), b = _mm256_unpackhi_ps(pair[0], pair[1]);
    const F32x8 c = _mm256_unpacklo_ps(pair[2], pair[3]), d = _mm256_unpackhi_ps(pair[2], pair[3]);
    out[0] = _mm256_shuffle_ps(a, c, 0x44), out[1] = _mm256_shuffle_ps(a, c, 0xee);
    out[2] = _mm256_shuffle_ps(b, d, 0x44), out[3] = _mm256_shuffle_ps(b, d, 0xee);
}

/* Two neighbouring nodes, interpolated by the share of a sample: the first four values and the second four. */
static inline __m128 along(F32x8 pair, float share)
{
    const __m128 near = _mm256_castps256_ps128(pair), far = _mm256_extractf128_ps(pair, 1);
    return _mm_fmadd_ps(_mm_set1_ps(share), _mm_sub_ps(far, near), near);
}

static inline void depths(F32x8 out[air_lights], const AirLight *light, const Places *p)
{
    __m128 row[8];
    for (int j = 0; j < 8; j++) {
        const float *low = light->depth[p->node[j]], *high = low + air_range_row * air_lights;
        row[j] =
            along(f32x8_lerp(_mm256_loadu_ps(low), _mm256_loadu_ps(high), _mm256_set1_ps(p->height[j])), p->range[j]);
    }
    turn_four(out, row);
}

static inline void scattered_sources(F32x8 out[air_lights], const AirLight *light, const Places *p)
{
    __m128       row[8];
    const float *nodes = light->log2_source[0][0];
    for (int j = 0; j < 8; j++) {
        const float *low = nodes + p->turn_node[j] * air_lights, *high = low + air_slope_nodes * air_lights;
        const F32x8  turn = _mm256_set1_ps(p->turn[j]);
        const F32x8  a = f32x8_lerp(_mm256_loadu_ps(low), _mm256_loadu_ps(high), turn);
        const F32x8  b = f32x8_lerp(_mm256_loadu_ps(low + air_share_row * air_lights),
                                    _mm256_loadu_ps(high + air_share_row * air_lights), turn);
        row[j] = along(f32x8_lerp(a, b, _mm256_set1_ps(p->slope[j])), p->share[j]);
    }
    turn_four(out, row);
    for (int k = 0; k < air_lights; k++) out[k] = f32x8_exp2(out[k]);
}

/* Values of both thermal bands, one after the other. */
static inline void heats(F32x8 out[2 * air_warm_values], const AirHeat *heat, const Places *p)
{
    enum { values = 2 * air_warm_values };
    F32x8        row[8], pair[8];
    const float *nodes = heat->value[0][0]; /* of all temperatures */
    for (int j = 0; j < 8; j++) {
        const float *low = nodes + p->heat_node[j] * values, *high = low + air_range_row * values;
        const F32x8  height = _mm256_set1_ps(p->height[j]);
        row[j] = f32x8_lerp(f32x8_lerp(_mm256_loadu_ps(low), _mm256_loadu_ps(high), height),
                            f32x8_lerp(_mm256_loadu_ps(low + values), _mm256_loadu_ps(high + values), height),
                            _mm256_set1_ps(p->range[j]));
    }
    for (int j = 0; j < 8; j += 4) {
        const F32x8 a = _mm256_unpacklo_ps(row[j], row[j + 1]), b = _mm256_unpackhi_ps(row[j], row[j + 1]);
        const F32x8 c = _mm256_unpacklo_ps(row[j + 2], row[j + 3]), d = _mm256_unpackhi_ps(row[j + 2], row[j + 3]);
        pair[j] = _mm256_shuffle_ps(a, c, 0x44), pair[j + 1] = _mm256_shuffle_ps(a, c, 0xee);
        pair[j + 2] = _mm256_shuffle_ps(b, d, 0x44), pair[j + 3] = _mm256_shuffle_ps(b, d, 0xee);
    }
    for (int k = 0; k < 4; k++) {
        out[k] = _mm256_permute2f128_ps(pair[k], pair[k + 4], 0x20);
        out[k + 4] = _mm256_permute2f128_ps(pair[k], pair[k + 4], 0x31);
    }
}

static inline F32x8 transmit(F32x8 depth, const Places *p)
{
    return f32x8_exp2(sub(f32x8_set(0), mul(p->near, depth)));
}

static inline void store_path(AirPaths *out, int i, F32x8 emitted, F32x8 sun, F32x8 own, F32x8 added)
{
    _mm256_storeu_ps(out->transmittance + i, emitted);
    _mm256_storeu_ps(out->sun_transmittance + i, sun);
    _mm256_storeu_ps(out->air_transmittance + i, own);
    _mm256_storeu_ps(out->added_w_m2_sr + i, added);
}

/* Eight paths, from sample i on, in the bands whose out is not NULL. */
static void path_lanes(AirPaths *const out[AIR_BAND_COUNT], const Look *look, const Parts *parts, const Rays *rays,
                       const float *temp_k, int i)
{
    const AirTable *table = look->table;
    Places          p;
    find_places(&p, look, parts, rays, i);

    F32x8 mwir_sun = f32x8_set(0), mwir_scattered = f32x8_set(0);
    for (int g = 0; g < table->lights; g++) {
        const AirLight *light = table->light[g];
        F32x8           depth[air_lights], source[air_lights];
        bool            any = false;
        for (int k = 0; k < light->bands; k++) any |= out[light->band[k]] != NULL;
        if (!any) continue;
        depths(depth, light, &p);
        for (int k = 0; k < air_lights; k++) source[k] = f32x8_set(0);
        if (table->scattered) scattered_sources(source, light, &p);
        for (int k = 0; k < light->bands; k++) {
            const AirBand band = light->band[k];
            if (!out[band]) continue;
            const F32x8 sun = transmit(depth[k], &p), added = mul(sub(f32x8_set(1), sun), source[k]);
            if (band == AIR_MWIR) mwir_sun = sun, mwir_scattered = added;
            else store_path(out[band], i, sun, sun, sun, added);
        }
    }
    if (!out[AIR_MWIR] && !out[AIR_LWIR]) return;
    if (temp_k) {
        find_temps(&p, look, temp_k + i);
    } else {
        memcpy(p.heat_node, p.node, sizeof p.heat_node);
        p.temp = f32x8_set(0);
    }
    F32x8 value[2 * air_warm_values];
    heats(value, table->heat, &p);
    for (int t = 0; t < 2; t++) {
        const AirBand band = t ? AIR_LWIR : AIR_MWIR;
        const F32x8  *v = value + t * air_warm_values;
        if (!out[band]) continue;
        const F32x8 own = transmit(v[air_warm_own], &p);
        const F32x8 sun = band == AIR_MWIR && table->scattered ? mwir_sun : own;
        const F32x8 emitted = temp_k ? transmit(f32x8_lerp(v[air_warm_low], v[air_warm_high], p.temp), &p) : sun;
        F32x8       added = mul(sub(f32x8_set(1), own), v[air_warm_source]);
        if (band == AIR_MWIR) added = add(added, mwir_scattered);
        store_path(out[band], i, emitted, sun, own, added);
    }
}

/* ---- a block -------------------------------------------------------------------------------------- */

/* Distance to the round ground at height 0 along a ray that meets nothing nearer; INFINITY: it passes above. */
static float ground_beyond(double eye_m, double climb)
{
    const double r_m = earth_radius_m + eye_m, down_m = -r_m * climb, above = eye_m * (2 * earth_radius_m + eye_m);
    const double disc = down_m * down_m - above;
    return climb < 0 && disc >= 0 ? (float)(above / (down_m + sqrt(disc))) : INFINITY;
}

/* What of a path is below the tables' top: from where it enters the air, to its end or where it leaves it. */
static void cut_at_top(Parts *parts, int i, double eye_m, double climb, double range_m)
{
    const double from_m = air_entry_m(eye_m, climb), r_m = earth_radius_m + eye_m;
    parts->air_m[i] = 0;
    if (!(from_m < range_m)) return;
    double there = climb;
    if (from_m > 0) air_height_along(eye_m, climb, from_m, &there);
    const double half2 = r_m * r_m * climb * climb - (eye_m - air_top_m) * (2 * earth_radius_m + eye_m + air_top_m);
    const double out_m = sqrt(fmax(half2, 0)) - r_m * climb;
    parts->air_m[i] = (float)(fmin(range_m, out_m) - from_m), parts->climb[i] = (float)there;
}

static void find_ranges(float *range_m, Parts *parts, const Air *air, const Hits *hits, const Rays *rays)
{
    const double eye_m = air->eye_height_m;
    const bool   above = eye_m > air_top_m;
    for (int i = 0; i < hits->count; i++) {
        const double o_enu[3] = {rays->o_enu[0][i], rays->o_enu[1][i], rays->o_enu[2][i]};
        const double d_enu[3] = {rays->d_enu[0][i], rays->d_enu[1][i], rays->d_enu[2][i]};
        const double climb = air_climb(o_enu, d_enu);
        range_m[i] = hits->range_m[i] < INFINITY ? (float)hits->range_m[i] : ground_beyond(eye_m, climb);
        parts->air_m[i] = range_m[i], parts->climb[i] = (float)climb;
        /* a path that climbs by less than this stays in the air */
        const double at_m = (double)range_m[i];
        if (at_m < INFINITY && (above || eye_m + at_m * (climb + at_m / (2 * earth_radius_m)) > air_top_m))
            cut_at_top(parts, i, eye_m, climb, at_m);
    }
}

static bool any_ends(const float *range_m)
{
    return _mm256_movemask_ps(_mm256_cmp_ps(_mm256_loadu_ps(range_m), f32x8_set(INFINITY), _CMP_LT_OQ)) != 0;
}

static void path_homogeneous(AirPaths *out, const Air *air, AirBand band, const Hits *hits)
{
    const float radiance = air->sky_eye[band].thermal_w_m2_sr[0];
    for (int i = 0; i < hits->count; i++) {
        const float tau = (float)exp(-air->even_per_m * fmin(hits->range_m[i], 1e12));
        out->range_m[i] = (float)hits->range_m[i];
        out->transmittance[i] = out->sun_transmittance[i] = out->air_transmittance[i] =
            out->range_m[i] < INFINITY ? tau : 0;
        out->added_w_m2_sr[i] = (1 - out->transmittance[i]) * radiance;
    }
}

/* What the air above the tables' top adds to paths that end below it. */
static void add_above(AirPaths *out, const Air *air, int thermal, const Hits *hits, const Rays *rays)
{
    for (int i = 0; i < hits->count; i++) {
        const double o_enu[3] = {rays->o_enu[0][i], rays->o_enu[1][i], rays->o_enu[2][i]};
        const double d_enu[3] = {rays->d_enu[0][i], rays->d_enu[1][i], rays->d_enu[2][i]};
        if (out->range_m[i] < INFINITY && out->air_transmittance[i] < 1)
            out->added_w_m2_sr[i] +=
                (float)air_above_there(air, thermal, air_climb(o_enu, d_enu), (double)out->added_w_m2_sr[i]);
    }
}

void air_paths_clear(AirPaths *const out[AIR_BAND_COUNT], const Air *air, const Hits *hits, const Rays *rays,
                     const float *temp_k)
{
    if (!air->table) {
        for (int b = 0; b < AIR_BAND_COUNT; b++)
            if (out[b]) path_homogeneous(out[b], air, (AirBand)b, hits);
        return;
    }
    const Look look = look_from(air);
    float      range_m[hits_capacity];
    Parts      parts;
    find_ranges(range_m, &parts, air, hits, rays);
    for (int i = hits->count; i < hits_capacity && i % 8 != 0; i++) range_m[i] = parts.air_m[i] = parts.climb[i] = 0;
    for (int i = 0; i < hits->count; i += 8)
        if (any_ends(range_m + i)) path_lanes(out, &look, &parts, rays, temp_k, i);

    for (int b = 0; b < AIR_BAND_COUNT; b++)
        if (out[b]) memcpy(out[b]->range_m, range_m, (size_t)hits->count * sizeof *range_m);
    for (int k = 0; k < 2 && air->eye_height_m > air_top_m; k++)
        if (out[AIR_MWIR + k]) add_above(out[AIR_MWIR + k], air, k, hits, rays);
    for (int i = 0; i < hits->count; i++) {
        if (range_m[i] < INFINITY) continue;
        const double o_enu[3] = {rays->o_enu[0][i], rays->o_enu[1][i], rays->o_enu[2][i]};
        const double d_enu[3] = {rays->d_enu[0][i], rays->d_enu[1][i], rays->d_enu[2][i]};
        const double climb = air_climb(o_enu, d_enu);
        SkyPlace     place;
        air_sky_place(&place, air->light.sun_d_enu, d_enu, climb);
        const LimbPlace limb = climb < 0 ? air_limb_place(air->eye_height_m, climb) : (LimbPlace){0};
        for (int b = 0; b < AIR_BAND_COUNT; b++) {
            if (!out[b]) continue;
            out[b]->transmittance[i] = out[b]->sun_transmittance[i] = out[b]->air_transmittance[i] = 0;
            out[b]->added_w_m2_sr[i] = (float)(climb < 0 ? air_limb_there(air, b, &limb, &place)
                                                         : daylight_sky_there(&air->sky_eye[b], &place));
        }
    }
}

void air_paths_of(AirPaths out[AIR_BAND_COUNT], const Air *air, unsigned bands, const Hits *hits, const Rays *rays,
                  const float *temp_k)
{
    AirPaths *wanted[AIR_BAND_COUNT];
    for (int b = 0; b < AIR_BAND_COUNT; b++) wanted[b] = bands >> b & 1 ? &out[b] : NULL;
    air_paths_clear(wanted, air, hits, rays, temp_k);
    droplets_on_paths(wanted, air, hits, rays);
}

void air_path(AirPaths *out, const Air *air, AirBand band, const Hits *hits, const Rays *rays, const float *temp_k)
{
    AirPaths *wanted[AIR_BAND_COUNT] = {NULL};
    wanted[band] = out;
    air_paths_clear(wanted, air, hits, rays, temp_k);
    droplets_on_paths(wanted, air, hits, rays);
}
