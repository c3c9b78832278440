/* render/light/surface_light.c: see surface_light.h. Formulas, and why they are, stand in optical.c, thermal.c and
 * materials.c; here are the forms of them that keep their digits in float. */
#include "render/light/surface_light.h"

#include "render/light/optical.h"
#include "terrain/eight.h"

enum GlossValue { gloss_share, gloss_roughness, gloss_per_roughness, gloss_smooth2, gloss_slope2, gloss_values };

static const double water_index2 = 1.7673876858061457; /* of a reflectance of 0.02, below which most ground is */

/* ---- once a frame ------------------------------------------------------------------------- */

static void fill_row(float rho[surface_light_bands], float gloss[surface_light_bands], const Material *m)
{
    const double roughness = (double)m->roughness, smooth = 1 - fmin(roughness, 1);
    for (int c = 0; c < optical_channel_count; c++) rho[c] = m->rho[c];
    rho[AIR_MWIR] = m->rho_mwir, rho[AIR_LWIR] = m->rho_lwir;
    gloss[gloss_share] = m->gloss;
    gloss[gloss_roughness] = m->roughness;
    gloss[gloss_per_roughness] = (float)(1 / fmax(roughness, 0.01));
    gloss[gloss_smooth2] = (float)(smooth * smooth);
    gloss[gloss_slope2] = (float)material_slope2(roughness);
}

Status surface_light_prepare(SurfaceLight *out, const Air *air, const Materials *materials, Arena *arena)
{
    memset(out, 0, sizeof *out);
    out->air = air;
    out->rho = arena_alloc(arena, (size_t)materials->count, sizeof *out->rho);
    out->gloss = arena_alloc(arena, (size_t)materials->count, sizeof *out->gloss);
    if (!out->rho || !out->gloss) return STATUS_NO_MEMORY;
    for (int m = 0; m < materials->count; m++) fill_row(out->rho[m], out->gloss[m], &materials->material[m]);
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        const AirSky *sky = &air->light.sky[b];
        for (int i = 0; i <= air_plane_ups; i++)
            for (int a = 0; a <= air_plane_azimuths; a++) out->plane[i][a][b] = air->light.plane_w_m2[b][i][a];
        for (int i = 0; i <= air_sky_ups; i++) {
            out->thermal[i][b] = sky->thermal_w_m2_sr[i];
            for (int a = 0; a <= air_sky_azimuths; a++) out->scattered[i][a][b] = sky->scattered_w_m2_sr[i][a];
        }
        for (int i = 0; i < air_sky_angles + 2; i++) out->around_sun[i][b] = sky->around_sun[i];
        out->level_w_m2_sr[b] = b >= AIR_MWIR ? (float)air->light.ground_w_m2_sr[b]
                                              : (float)(optical_ground_w_m2(b, air, materials) / pi_rad);
        out->sun_w_m2[b] = b == AIR_LWIR ? 0 : (float)air->light.sun_w_m2[b];
        if (out->sun_w_m2[b] > 0) out->any_sun = true;
    }
    return STATUS_OK;
}

/* ---- places in the tables ------------------------------------------------------------------- */

typedef struct Three { Eight x, y, z; } Three;

static inline Eight dot(Three a, Three b) { return eight_fma(a.x, b.x, eight_fma(a.y, b.y, a.z * b.z)); }
static inline Eight zero(void) { return _mm256_setzero_ps(); }
static inline Eight one(void) { return eight_all(1); }
static inline Eight square(Eight a) { return a * a; }

/* Eight places in steps of a table: lower nodes and shares of the upper ones. */
typedef struct Steps {
    EightInt at;
    Eight    share;
} Steps;

static inline Steps steps_of(Eight x, int most)
{
    const Eight inside = eight_clamp(x, 0, most), at = eight_min(eight_floor(inside), eight_all(most - 1));
    return (Steps){eight_to_ints(at), inside - at};
}

/* The arc cosine of +-(1 - less), by what is missing to 1: Abramowitz & Stegun 4.4.45, within 7e-5. */
static inline Eight arc_cosine(Eight less, Eight negative)
{
    const Eight x = one() - less;
    Eight       p = eight_fma(x, eight_all(-0.0187293), eight_all(0.0742610));
    p = eight_fma(x, p, eight_all(-0.2121144));
    p = eight_fma(x, p, eight_all(1.5707288)) * eight_sqrt(less);
    return eight_pick(negative, eight_all(pi_rad) - p, p);
}

/* Angle of a direction's azimuth from the sun's, 0 .. pi; 0 where either has none. By the cross product, since the
 * cosine of a small angle has lost half its digits. */
static inline Eight azimuth_from_sun(Three d, Three sun)
{
    const Eight n2 = (d.x * d.x + d.y * d.y) * (sun.x * sun.x + sun.y * sun.y);
    const Eight along = d.x * sun.x + d.y * sun.y, across = d.x * sun.y - d.y * sun.x;
    const Eight has = eight_more(n2, eight_all(1e-20)), n = eight_sqrt(n2);
    /* 1 - |cos| = sin^2 / (1 + |cos|) */
    const Eight less = square(across) / (eight_max(n2, eight_all(1e-20)) + n * eight_abs(along));
    return eight_and(arc_cosine(eight_min(less, one()), eight_less(along, zero())), has);
}

/* Values of all bands at eight places between nodes of a table of rows, a band after the other. */
static inline void look_up(Eight out[8], const float *table, int row, Steps up, Steps aside)
{
    int32_t at[8];
    float   u[8], v[8];
    _mm256_storeu_si256((EightInt *)at, _mm256_add_epi32(_mm256_mullo_epi32(up.at, eight_int(row)), aside.at));
    eight_store(u, up.share), eight_store(v, aside.share);
    for (int k = 0; k < 8; k++) {
        const float *low = table + (ptrdiff_t)at[k] * surface_light_bands, *high = low + row * surface_light_bands;
        const Eight  a = _mm256_set1_ps(v[k]);
        out[k] = eight_mix(eight_mix(eight_load(low), eight_load(low + 8), a),
                           eight_mix(eight_load(high), eight_load(high + 8), a), _mm256_set1_ps(u[k]));
    }
}

static inline void light_on_plane(Eight out[8], const SurfaceLight *light, Three n, Three sun)
{
    const Eight z = eight_clamp(n.z, -1, 1), x = eight_all(0.5 * air_plane_ups) * eight_sqrt(one() - eight_abs(z));
    const Eight open = eight_all(0.5) * (one() + z);
    const Steps up = steps_of(eight_pick(eight_less(z, zero()), x, eight_all(air_plane_ups) - x), air_plane_ups);
    const Steps azimuth =
        steps_of(azimuth_from_sun(n, sun) * eight_all(air_plane_azimuths / pi_rad), air_plane_azimuths);
    look_up(out, light->plane[0][0], air_plane_azimuths + 1, up, azimuth);
    eight_turn(out);
    for (int b = 0; b < AIR_BAND_COUNT; b++) out[b] = out[b] * open;
}

/* Sky in the direction d, nothing about the sun finer than blur_rad. */
static inline void sky_towards(Eight out[8], const SurfaceLight *light, Three d, Three sun, Eight blur_rad)
{
    const Steps up = steps_of(eight_sqrt(eight_clamp(d.z, 0, 1)) * eight_all(air_sky_ups), air_sky_ups);
    const Steps azimuth = steps_of(azimuth_from_sun(d, sun) * eight_all(air_sky_azimuths / pi_rad), air_sky_azimuths);
    const Three chord = {d.x - sun.x, d.y - sun.y, d.z - sun.z};
    const Eight c2 = eight_min(dot(chord, chord) * eight_all(0.25), one()), over = eight_more(c2, eight_all(0.5));
    const Eight less = eight_pick(over, eight_all(2) - c2 - c2, c2 + c2);
    const Eight angle =
        eight_pick(eight_less(c2, eight_all(0.01)), eight_sqrt(c2) * eight_all(2), arc_cosine(less, over));
    const Eight blurred = eight_min(eight_max(angle, blur_rad), eight_all(pi_rad));
    const Steps ring =
        steps_of(eight_sqrt(blurred * eight_all(1 / pi_rad)) * eight_all(air_sky_angles), air_sky_angles);
    look_up(out, light->scattered[0][0], air_sky_azimuths + 1, up, azimuth);
    int32_t height[8], angles[8];
    float   u[8], a[8];
    _mm256_storeu_si256((EightInt *)height, up.at), _mm256_storeu_si256((EightInt *)angles, ring.at);
    eight_store(u, up.share), eight_store(a, ring.share);
    for (int k = 0; k < 8; k++) {
        const float *around = light->around_sun[angles[k]], *thermal = light->thermal[height[k]];
        const Eight  bright = eight_mix(eight_load(around), eight_load(around + 8), _mm256_set1_ps(a[k]));
        out[k] =
            eight_fma(out[k], bright, eight_mix(eight_load(thermal), eight_load(thermal + 8), _mm256_set1_ps(u[k])));
    }
    eight_turn(out);
}

/* ---- gloss ---------------------------------------------------------------------------------- */

static inline Eight dielectric(Eight index2, Eight cosine)
{
    const Eight inside = eight_sqrt(index2 - one() + cosine * cosine);
    const Eight a = cosine - inside, b = cosine + inside, c = index2 * cosine - inside, d = index2 * cosine + inside;
    return eight_all(0.5) * (square(a * d) + square(b * c)) / square(b * d);
}

/* material_fresnel; water: dielectric(water_index2, cosine), which is most ground's whatever the band. */
static inline Eight fresnel(Eight gloss_rho, Eight smooth2, Eight cosine, Eight water)
{
    const Eight cover = eight_min(gloss_rho * eight_all(50), one()), normal = eight_max(gloss_rho, eight_all(0.02));
    Eight       reflected = water;
    if (eight_bits(eight_more(gloss_rho, eight_all(0.02)))) {
        const Eight root = eight_sqrt(normal), index = (one() + root) / (one() - root);
        const Eight metal = eight_clamp((normal - eight_all(0.2)) * eight_all(10), 0, 1);
        const Eight away = one() - cosine, away5 = square(square(away)) * away;
        const Eight other =
            eight_pick(eight_more(gloss_rho, eight_all(0.02)), dielectric(index * index, cosine), water);
        reflected = eight_mix(other, eight_fma(one() - normal, away5, normal), metal);
        reflected = eight_pick(eight_less(metal, one()), reflected, eight_fma(one() - normal, away5, normal));
    }
    const Eight all = eight_fma(cover * smooth2, reflected - normal, gloss_rho);
    return eight_and(eight_pick(eight_less(gloss_rho, one()), all, one()), eight_more(gloss_rho, zero()));
}

static inline Eight smith(Eight per_slope, Eight cosine)
{
    const Eight sine2 = one() - cosine * cosine;
    const Eight a = cosine * per_slope / eight_sqrt(eight_max(sine2, eight_all(1e-12)));
    const Eight part = a * eight_fma(eight_all(2.181), a, eight_all(3.535)) /
                       eight_fma(a, eight_fma(eight_all(2.577), a, eight_all(2.276)), one());
    return eight_pick(eight_or(eight_more(a, eight_all(1.6)), eight_less(sine2, eight_all(1e-12))), one(), part);
}

/* material_lobe towards the sun; the tangent by a cross product, for smooth water. */
static inline Eight lobe(Eight slope2, Three n, Three eye, Three sun, Eight n_eye, Eight n_sun)
{
    Three half = {eye.x + sun.x, eye.y + sun.y, eye.z + sun.z};
    const Eight length2 = eight_max(dot(half, half), eight_all(1e-20)), n_half = dot(n, half);
    const Three cross = {n.y * half.z - n.z * half.y, n.z * half.x - n.x * half.z, n.x * half.y - n.y * half.x};
    const Eight tangent2 = dot(cross, cross) / eight_max(n_half * n_half, eight_all(1e-20));
    const Eight per_slope2 = one() / slope2, n_half2 = n_half * n_half / length2;
    const Eight seen = eight_and(eight_and(eight_more(n_eye, zero()), eight_more(n_sun, zero())),
                                 eight_less(tangent2, eight_all(40) * slope2));
    if (!eight_bits(seen)) return zero();
    const Eight slopes = eight_exp2(tangent2 * per_slope2 * eight_all(-1.4426950408889634)) * per_slope2 /
                         (eight_all(pi_rad) * n_half2 * n_half2);
    const Eight per_slope = eight_sqrt(per_slope2);
    return eight_and(slopes * smith(per_slope, n_eye) * smith(per_slope, n_sun) / (eight_all(4) * n_eye), seen);
}

/* ---- eight hits ------------------------------------------------------------------------------ */

/* Eight rows of a table by material, turned: of one material as a rule. */
static inline void material_rows(Eight out[8], float (*table)[surface_light_bands], const uint16_t material[8],
                                 bool same)
{
    if (same) {
        for (int k = 0; k < 8; k++) out[k] = _mm256_set1_ps(table[material[0]][k]);
        return;
    }
    for (int k = 0; k < 8; k++) out[k] = eight_load(table[material[k]]);
    eight_turn(out);
}

static void shade_eight(float *const out[AIR_BAND_COUNT], const SurfaceLight *light, const SurfaceBlock *b, int i)
{
    const Hits *hits = b->hits;
    const Rays *rays = b->rays;
    const Air  *air  = light->air;
    uint16_t    material[8] = {0};
    const int   some = hits->count - i < 8 ? hits->count - i : 8;
    memcpy(material, b->material + i, (size_t)some * sizeof *material);
    const __m128i rows = _mm_loadu_si128((const __m128i *)material);
    const bool    same = _mm_movemask_epi8(_mm_cmpeq_epi16(rows, _mm_set1_epi16((short)material[0]))) == 0xffff;
    Eight rho[8], of[8], plane[8], sky[8];
    material_rows(rho, light->rho, material, same);
    material_rows(of, light->gloss, material, same);
    const bool glossy = eight_bits(eight_more(of[gloss_share], zero())) != 0;

    const Three sun = {eight_all(air->light.sun_d_enu[0]), eight_all(air->light.sun_d_enu[1]), eight_all(air->light.sun_d_enu[2])};
    const Three n = {eight_load(hits->n_enu[0] + i), eight_load(hits->n_enu[1] + i), eight_load(hits->n_enu[2] + i)};
    const Three d = {eight_of_doubles(rays->d_enu[0] + i), eight_of_doubles(rays->d_enu[1] + i),
                     eight_of_doubles(rays->d_enu[2] + i)};
    const Three eye = {zero() - d.x, zero() - d.y, zero() - d.z};
    const Eight lit = _mm256_castsi256_ps(_mm256_cmpeq_epi32(eight_of_bytes(b->shadow + i), eight_int(0)));
    const Eight n_eye = eight_max(dot(n, eye), zero()), n_sun = eight_and(eight_max(dot(n, sun), zero()), lit);
    const Eight below = eight_all(0.5 * pi_rad) * (one() - n.z), per_pi = eight_all(1 / pi_rad);
    light_on_plane(plane, light, n, sun);

    Eight sees_sky = zero(), glint = zero(), water_eye = zero(), water_half = zero(), half = zero();
    if (glossy) {
        const Eight twice = n_eye + n_eye;
        const Three mirror = {eight_fma(twice, n.x, d.x), eight_fma(twice, n.y, d.y), eight_fma(twice, n.z, d.z)};
        sees_sky = eight_clamp(eight_fma(eight_all(0.5) * mirror.z, of[gloss_per_roughness], eight_all(0.5)), 0, 1);
        sky_towards(sky, light, mirror, sun, of[gloss_roughness] + of[gloss_roughness]);
        water_eye = dielectric(eight_all(water_index2), eight_min(n_eye, one()));
        if (light->any_sun && eight_bits(eight_more(n_sun, zero()))) {
            glint = lobe(of[gloss_slope2], n, eye, sun, n_eye, n_sun);
            half = eight_sqrt(eight_max(eight_all(0.5) * (one() + dot(eye, sun)), zero()));
            water_half = dielectric(eight_all(water_index2), eight_min(half, one()));
        }
    }
    for (int band = 0; band < AIR_BAND_COUNT; band++) {
        if (!out[band]) continue;
        const Veils *veil = &b->veils[band];
        const Eight level = _mm256_set1_ps(light->level_w_m2_sr[band]),
                    sun_w_m2 = _mm256_set1_ps(light->sun_w_m2[band]);
        const Eight all_rho =
            band >= AIR_MWIR ? rho[band] : eight_min(rho[band] * eight_load(b->texture[band] + i), one());
        Eight around =
            b->around_w_m2[band] ? eight_load(b->around_w_m2[band] + i) : eight_fma(level, below, plane[band]);
        if (b->open[band]) around = around * eight_load(b->open[band] + i);
        Eight diffuse = all_rho, mirrored = zero(), mirrors = zero(), flash = zero();
        if (glossy) {
            const Eight gloss_rho = all_rho * of[gloss_share];
            mirrors = fresnel(gloss_rho, of[gloss_smooth2], eight_min(n_eye, one()), water_eye);
            diffuse = eight_and((all_rho - gloss_rho) * (one() - mirrors) / (one() - gloss_rho),
                                eight_less(gloss_rho, one()));
            mirrored = mirrors * eight_mix(level, sky[band], sees_sky);
            if (eight_bits(eight_more(glint, zero())))
                flash = fresnel(gloss_rho, of[gloss_smooth2], eight_min(half, one()), water_half) * glint;
        }
        const Eight reflected = eight_fma(diffuse * per_pi, around, mirrored);
        const Eight sunlit = eight_fma(diffuse * per_pi, n_sun, flash) * sun_w_m2;
        Eight seen = eight_fma(reflected, eight_load(veil->air_transmittance + i), eight_load(veil->added_w_m2_sr + i));
        seen = eight_fma(sunlit, eight_load(veil->sun_transmittance + i), seen);
        if (band >= AIR_MWIR) {
            const PlanckTable *planck = band == AIR_MWIR ? air->light.planck_mwir : air->light.planck_lwir;
            float              emitted[8];
            planck_table_radiance8(emitted, planck, b->temp_k + i);
            seen =
                eight_fma((one() - diffuse - mirrors) * eight_load(emitted), eight_load(veil->transmittance + i), seen);
        }
        eight_store(out[band] + i, seen);
    }
}

void surface_light_shade(float *const out[AIR_BAND_COUNT], const SurfaceLight *light, const SurfaceBlock *block)
{
    const Hits *hits = block->hits;
    for (int i = 0; i < hits->count; i += 8) {
        bool any = false;
        for (int k = i; k < i + 8 && k < hits->count; k++) any |= hits->range_m[k] < INFINITY;
        if (any) shade_eight(out, light, block, i);
    }
}
