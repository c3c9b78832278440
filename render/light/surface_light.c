/* render/light/surface_light.c: radiance of ground and parts, eight hits at a time (surface_light.h). The formulas and
 * their reasons are in optical.c, thermal.c and materials.c; here are forms of them that are accurate in float. */
#include "render/light/surface_light.h"

#include "render/light/optical.h"
#include "pitviper_simd.h"

enum GlossValue {
    gloss_share,
    gloss_roughness,
    gloss_per_roughness,
    gloss_smooth2,
    gloss_slope2,
    gloss_pane,
    gloss_values
};

static const double water_index2 = 1.7673876858061457; /* of a reflectance of 0.02, below which most ground is */

/* ---- once a frame ------------------------------------------------------------------------- */

static void fill_tau(float tau[surface_light_bands], const Material *m)
{
    for (int c = 0; c < optical_channel_count; c++) tau[c] = m->tau[c];
    tau[AIR_MWIR] = m->tau_mwir, tau[AIR_LWIR] = m->tau_lwir;
}

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
    gloss[gloss_pane] = material_is_pane(m);
}

Status surface_light_prepare(SurfaceLight *out, const Air *air, const Materials *materials, Arena *arena)
{
    memset(out, 0, sizeof *out);
    out->air = air;
    const int rows = materials->count + materials->more;
    out->rho = arena_alloc(arena, (size_t)rows, sizeof *out->rho);
    out->gloss = arena_alloc(arena, (size_t)rows, sizeof *out->gloss);
    if (!out->rho || !out->gloss) return STATUS_NO_MEMORY;
    for (int m = 0; m < rows; m++) fill_row(out->rho[m], out->gloss[m], &materials->material[m]);
    if (materials_let_through(materials)) {
        out->tau = arena_alloc(arena, (size_t)rows, sizeof *out->tau);
        if (!out->tau) return STATUS_NO_MEMORY;
        for (int m = 0; m < rows; m++) fill_tau(out->tau[m], &materials->material[m]);
    }
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
    }
    return STATUS_OK;
}

/* ---- positions in the tables ---------------------------------------------------------------- */

typedef struct Three {
    F32x8 x, y, z;
} Three;

static inline F32x8 dot(Three a, Three b) { return f32x8_fma(a.x, b.x, f32x8_fma(a.y, b.y, a.z * b.z)); }
static inline F32x8 zero(void) { return _mm256_setzero_ps(); }
static inline F32x8 one(void) { return f32x8_set(1); }
static inline F32x8 square(F32x8 a) { return a * a; }

/* F32x8 positions in steps of a table: lower nodes and shares of the upper ones. */
typedef struct Steps {
    I32x8 at;
    F32x8 share;
} Steps;

static inline Steps steps_of(F32x8 x, int most)
{
    const F32x8 inside = f32x8_clamp(x, 0, most), at = f32x8_min(f32x8_floor(inside), f32x8_set(most - 1));
    return (Steps){i32x8_truncate(at), inside - at};
}

/* The arc cosine of +-(1 - less), from the difference to 1: Abramowitz & Stegun 4.4.45, within 7e-5. */
static inline F32x8 arc_cosine(F32x8 less, F32x8 negative)
{
    const F32x8 x = one() - less;
    F32x8       p = f32x8_fma(x, f32x8_set(-0.0187293), f32x8_set(0.0742610));
    p = f32x8_fma(x, p, f32x8_set(-0.2121144));
    p = f32x8_fma(x, p, f32x8_set(1.5707288)) * f32x8_sqrt(less);
    return f32x8_select(negative, f32x8_set(pi_rad) - p, p);
}

/* Angle of a direction's azimuth from the sun's, 0 .. pi; 0 where either has none. By the cross product, since the
 * cosine of a small angle has lost half its digits. */
static inline F32x8 azimuth_from_sun(Three d, Three sun)
{
    const F32x8 n2 = (d.x * d.x + d.y * d.y) * (sun.x * sun.x + sun.y * sun.y);
    const F32x8 along = d.x * sun.x + d.y * sun.y, across = d.x * sun.y - d.y * sun.x;
    const F32x8 has = f32x8_greater(n2, f32x8_set(1e-20)), n = f32x8_sqrt(n2);
    /* 1 - |cos| = sin^2 / (1 + |cos|) */
    const F32x8 less = square(across) / (f32x8_max(n2, f32x8_set(1e-20)) + n * f32x8_abs(along));
    return f32x8_and(arc_cosine(f32x8_min(less, one()), f32x8_less(along, zero())), has);
}

/* Values of all bands at eight positions between nodes of a table of rows, one band after the other. */
static inline void look_up(F32x8 out[8], const float *table, int row, Steps up, Steps aside)
{
    int32_t at[8];
    float   u[8], v[8];
    _mm256_storeu_si256((I32x8 *)at, _mm256_add_epi32(_mm256_mullo_epi32(up.at, i32x8_set(row)), aside.at));
    f32x8_store(u, up.share), f32x8_store(v, aside.share);
    for (int k = 0; k < 8; k++) {
        const float *low = table + (ptrdiff_t)at[k] * surface_light_bands, *high = low + row * surface_light_bands;
        const F32x8  a = _mm256_set1_ps(v[k]);
        out[k] = f32x8_lerp(f32x8_lerp(f32x8_load(low), f32x8_load(low + 8), a),
                            f32x8_lerp(f32x8_load(high), f32x8_load(high + 8), a), _mm256_set1_ps(u[k]));
    }
}

static inline void light_on_plane(F32x8 out[8], const SurfaceLight *light, Three n, Three sun)
{
    const F32x8 z = f32x8_clamp(n.z, -1, 1), x = f32x8_set(0.5 * air_plane_ups) * f32x8_sqrt(one() - f32x8_abs(z));
    const F32x8 open = f32x8_set(0.5) * (one() + z);
    const Steps up = steps_of(f32x8_select(f32x8_less(z, zero()), x, f32x8_set(air_plane_ups) - x), air_plane_ups);
    const Steps azimuth =
        steps_of(azimuth_from_sun(n, sun) * f32x8_set(air_plane_azimuths / pi_rad), air_plane_azimuths);
    look_up(out, light->plane[0][0], air_plane_azimuths + 1, up, azimuth);
    f32x8_transpose(out);
    for (int b = 0; b < AIR_BAND_COUNT; b++) out[b] = out[b] * open;
}

/* Sky in the direction d, blurred about the sun to blur_rad. */
static inline void sky_towards(F32x8 out[8], const SurfaceLight *light, Three d, Three sun, F32x8 blur_rad)
{
    const Steps up = steps_of(f32x8_sqrt(f32x8_clamp(d.z, 0, 1)) * f32x8_set(air_sky_ups), air_sky_ups);
    const Steps azimuth = steps_of(azimuth_from_sun(d, sun) * f32x8_set(air_sky_azimuths / pi_rad), air_sky_azimuths);
    const Three chord = {d.x - sun.x, d.y - sun.y, d.z - sun.z};
    const F32x8 c2 = f32x8_min(dot(chord, chord) * f32x8_set(0.25), one()), over = f32x8_greater(c2, f32x8_set(0.5));
    const F32x8 less = f32x8_select(over, f32x8_set(2) - c2 - c2, c2 + c2);
    const F32x8 angle =
        f32x8_select(f32x8_less(c2, f32x8_set(0.01)), f32x8_sqrt(c2) * f32x8_set(2), arc_cosine(less, over));
    const F32x8 blurred = f32x8_min(f32x8_max(angle, blur_rad), f32x8_set(pi_rad));
    const Steps ring =
        steps_of(f32x8_sqrt(blurred * f32x8_set(1 / pi_rad)) * f32x8_set(air_sky_angles), air_sky_angles);
    look_up(out, light->scattered[0][0], air_sky_azimuths + 1, up, azimuth);
    int32_t height[8], angles[8];
    float   u[8], a[8];
    _mm256_storeu_si256((I32x8 *)height, up.at), _mm256_storeu_si256((I32x8 *)angles, ring.at);
    f32x8_store(u, up.share), f32x8_store(a, ring.share);
    for (int k = 0; k < 8; k++) {
        const float *around = light->around_sun[angles[k]], *thermal = light->thermal[height[k]];
        const F32x8  bright = f32x8_lerp(f32x8_load(around), f32x8_load(around + 8), _mm256_set1_ps(a[k]));
        out[k] =
            f32x8_fma(out[k], bright, f32x8_lerp(f32x8_load(thermal), f32x8_load(thermal + 8), _mm256_set1_ps(u[k])));
    }
    f32x8_transpose(out);
}

/* ---- gloss ---------------------------------------------------------------------------------- */

static inline F32x8 dielectric(F32x8 index2, F32x8 cosine)
{
    const F32x8 inside = f32x8_sqrt(index2 - one() + cosine * cosine);
    const F32x8 a = cosine - inside, b = cosine + inside, c = index2 * cosine - inside, d = index2 * cosine + inside;
    return f32x8_set(0.5) * (square(a * d) + square(b * c)) / square(b * d);
}

/* material_fresnel; water: dielectric(water_index2, cosine), which is most ground's whatever the band. */
static inline F32x8 fresnel(F32x8 gloss_rho, F32x8 smooth2, F32x8 cosine, F32x8 water)
{
    const F32x8 cover = f32x8_min(gloss_rho * f32x8_set(50), one()), normal = f32x8_max(gloss_rho, f32x8_set(0.02));
    F32x8       reflected = water;
    if (f32x8_bits(f32x8_greater(gloss_rho, f32x8_set(0.02)))) {
        const F32x8 root = f32x8_sqrt(normal), index = (one() + root) / (one() - root);
        const F32x8 metal = f32x8_clamp((normal - f32x8_set(0.2)) * f32x8_set(10), 0, 1);
        const F32x8 away = one() - cosine, away5 = square(square(away)) * away;
        const F32x8 other =
            f32x8_select(f32x8_greater(gloss_rho, f32x8_set(0.02)), dielectric(index * index, cosine), water);
        reflected = f32x8_lerp(other, f32x8_fma(one() - normal, away5, normal), metal);
        reflected = f32x8_select(f32x8_less(metal, one()), reflected, f32x8_fma(one() - normal, away5, normal));
    }
    const F32x8 all = f32x8_fma(cover * smooth2, reflected - normal, gloss_rho);
    return f32x8_and(f32x8_select(f32x8_less(gloss_rho, one()), all, one()), f32x8_greater(gloss_rho, zero()));
}

/* material_pane. */
static inline F32x8 pane(F32x8 rho, F32x8 smooth2, F32x8 cosine)
{
    const F32x8 root = f32x8_sqrt(rho / (f32x8_set(2) - rho)), index2 = square((one() + root) / (one() - root));
    const F32x8 inside = f32x8_sqrt(index2 - one() + cosine * cosine), steep = index2 * cosine;
    const F32x8 s = square((cosine - inside) / (cosine + inside)), p = square((steep - inside) / (steep + inside));
    return f32x8_fma(smooth2, s / (one() + s) + p / (one() + p) - rho, rho);
}

static inline F32x8 smith(F32x8 per_slope, F32x8 cosine)
{
    const F32x8 sine2 = one() - cosine * cosine;
    const F32x8 a = cosine * per_slope / f32x8_sqrt(f32x8_max(sine2, f32x8_set(1e-12)));
    const F32x8 part = a * f32x8_fma(f32x8_set(2.181), a, f32x8_set(3.535)) /
                       f32x8_fma(a, f32x8_fma(f32x8_set(2.577), a, f32x8_set(2.276)), one());
    return f32x8_select(f32x8_or(f32x8_greater(a, f32x8_set(1.6)), f32x8_less(sine2, f32x8_set(1e-12))), one(), part);
}

/* material_lobe towards the sun; the tangent by a cross product, for smooth water. */
static inline F32x8 lobe(F32x8 slope2, Three n, Three eye, Three sun, F32x8 n_eye, F32x8 n_sun)
{
    Three       half = {eye.x + sun.x, eye.y + sun.y, eye.z + sun.z};
    const F32x8 length2 = f32x8_max(dot(half, half), f32x8_set(1e-20)), n_half = dot(n, half);
    const Three cross = {n.y * half.z - n.z * half.y, n.z * half.x - n.x * half.z, n.x * half.y - n.y * half.x};
    const F32x8 tangent2 = dot(cross, cross) / f32x8_max(n_half * n_half, f32x8_set(1e-20));
    const F32x8 per_slope2 = one() / slope2, n_half2 = n_half * n_half / length2;
    const F32x8 seen = f32x8_and(f32x8_and(f32x8_greater(n_eye, zero()), f32x8_greater(n_sun, zero())),
                                 f32x8_less(tangent2, f32x8_set(40) * slope2));
    if (!f32x8_bits(seen)) return zero();
    const F32x8 slopes = f32x8_exp2(tangent2 * per_slope2 * f32x8_set(-1.4426950408889634)) * per_slope2 /
                         (f32x8_set(pi_rad) * n_half2 * n_half2);
    const F32x8 per_slope = f32x8_sqrt(per_slope2);
    return f32x8_and(slopes * smith(per_slope, n_eye) * smith(per_slope, n_sun) / (f32x8_set(4) * n_eye), seen);
}

/* ---- eight hits ------------------------------------------------------------------------------ */

/* F32x8 rows of a table by material, transposed: usually of one material. */
static inline void material_rows(F32x8 out[8], float (*table)[surface_light_bands], const uint16_t material[8],
                                 bool same)
{
    if (same) {
        for (int k = 0; k < 8; k++) out[k] = _mm256_set1_ps(table[material[0]][k]);
        return;
    }
    for (int k = 0; k < 8; k++) out[k] = f32x8_load(table[material[k]]);
    f32x8_transpose(out);
}

/* The far side of leaves: what shines through them. */
typedef struct FarSide {
    bool  any; /* some of the eight lets light through; else the rest is not set */
    F32x8 tau[8], plane[8], n_sun, below, leaf;
} FarSide;

static inline void far_side(FarSide *far, const SurfaceLight *light, const uint16_t material[8], bool same, Three n,
                            Three sun, F32x8 lit)
{
    far->any = false;
    if (!light->tau) return;
    material_rows(far->tau, light->tau, material, same);
    const F32x8 through = f32x8_greater(far->tau[AIR_NIR], zero());
    if (!f32x8_bits(through)) return;
    const Three back = {zero() - n.x, zero() - n.y, zero() - n.z};
    far->any = true;
    light_on_plane(far->plane, light, back, sun);
    far->n_sun = f32x8_and(f32x8_max(dot(back, sun), zero()), lit);
    far->below = f32x8_set(0.5 * pi_rad) * (one() + n.z);
    far->leaf = through;
}

/* Irradiance of a plane whose normal rises by up, of open sky and open ground (render/light/canopy.h). */
static inline F32x8 among_plants(const CanopyLight *c, int band, int i, F32x8 up, F32x8 sky_w_m2, F32x8 ground_w_m2)
{
    const F32x8 sees_sky = f32x8_load(c->up + i), sees_ground = f32x8_load(c->down + i), half = f32x8_set(0.5);
    const F32x8 sees_leaves = one() - half * (sees_sky * (one() + up) + sees_ground * (one() - up));
    return sees_sky * sky_w_m2 + sees_ground * f32x8_load(c->ground[band] + i) * ground_w_m2 +
           sees_leaves * f32x8_load(c->leaves_w_m2[band] + i);
}

/* mirror_sky_factor of render/light/optical.h. */
static inline F32x8 mirrored_sky(F32x8 sky_w_m2, F32x8 open_w_m2, double level_w_m2)
{
    const F32x8 least = f32x8_set(fmax(mirror_least_share * level_w_m2, 1e-30));
    return f32x8_clamp(one() + (sky_w_m2 - open_w_m2) / f32x8_max(open_w_m2, least), 0, 100);
}

static void shade_eight(float *const out[AIR_BAND_COUNT], const SurfaceLight *light, const SurfaceBlock *b, int i)
{
    const Hits *hits = b->hits;
    const Rays *rays = b->rays;
    const Air  *air = light->air;
    uint16_t    material[8] = {0};
    const int   some = hits->count - i < 8 ? hits->count - i : 8;
    memcpy(material, b->material + i, (size_t)some * sizeof *material);
    const __m128i rows = _mm_loadu_si128((const __m128i *)material);
    const bool    same = _mm_movemask_epi8(_mm_cmpeq_epi16(rows, _mm_set1_epi16((short)material[0]))) == 0xffff;
    F32x8         rho[8], of[8], plane[8], sky[8];
    material_rows(rho, light->rho, material, same);
    material_rows(of, light->gloss, material, same);
    const bool glossy = f32x8_bits(f32x8_greater(of[gloss_share], zero())) != 0;
    const bool panes = f32x8_bits(f32x8_greater(of[gloss_pane], zero())) != 0;
    bool       sunlit_band = false; /* some band that is asked for shows the sun */
    for (int band = 0; band < AIR_BAND_COUNT; band++) sunlit_band |= out[band] && light->sun_w_m2[band] > 0;

    const Three sun = {f32x8_set(air->light.sun_d_enu[0]), f32x8_set(air->light.sun_d_enu[1]),
                       f32x8_set(air->light.sun_d_enu[2])};
    const Three n = {f32x8_load(hits->n_enu[0] + i), f32x8_load(hits->n_enu[1] + i), f32x8_load(hits->n_enu[2] + i)};
    const Three d = {f32x8_of_doubles(rays->d_enu[0] + i), f32x8_of_doubles(rays->d_enu[1] + i),
                     f32x8_of_doubles(rays->d_enu[2] + i)};
    const Three eye = {zero() - d.x, zero() - d.y, zero() - d.z};
    const F32x8 arrives = f32x8_load(b->sun + i), lit = f32x8_greater(arrives, zero());
    const F32x8 n_eye = f32x8_max(dot(n, eye), zero()), n_sun = f32x8_and(f32x8_max(dot(n, sun), zero()), lit);
    const F32x8 below = f32x8_set(0.5 * pi_rad) * (one() - n.z), per_pi = f32x8_set(1 / pi_rad);
    light_on_plane(plane, light, n, sun);

    FarSide far;
    far_side(&far, light, material, same, n, sun, lit);

    F32x8 sees_sky = zero(), glint = zero(), water_eye = zero(), water_half = zero(), half = zero();
    if (glossy) {
        const F32x8 twice = n_eye + n_eye;
        const Three mirror = {f32x8_fma(twice, n.x, d.x), f32x8_fma(twice, n.y, d.y), f32x8_fma(twice, n.z, d.z)};
        sees_sky = f32x8_clamp(f32x8_fma(f32x8_set(0.5) * mirror.z, of[gloss_per_roughness], f32x8_set(0.5)), 0, 1);
        sky_towards(sky, light, mirror, sun, of[gloss_roughness] + of[gloss_roughness]);
        water_eye = dielectric(f32x8_set(water_index2), f32x8_min(n_eye, one()));
        if (sunlit_band && f32x8_bits(f32x8_greater(n_sun, zero()))) {
            glint = lobe(of[gloss_slope2], n, eye, sun, n_eye, n_sun);
            half = f32x8_sqrt(f32x8_max(f32x8_set(0.5) * (one() + dot(eye, sun)), zero()));
            water_half = dielectric(f32x8_set(water_index2), f32x8_min(half, one()));
        }
    }
    for (int band = 0; band < AIR_BAND_COUNT; band++) {
        if (!out[band]) continue;
        const AirPaths *veil = &b->veils[band];
        const F32x8     level = _mm256_set1_ps(light->level_w_m2_sr[band]),
                    sun_w_m2 = _mm256_set1_ps(light->sun_w_m2[band]);
        F32x8 all_rho = band >= AIR_MWIR ? rho[band] : f32x8_min(rho[band] * f32x8_load(b->texture[band] + i), one());
        F32x8 through = zero();
        if (far.any) { /* a bright leaf returns no more than it gets */
            through = far.tau[band];
            if (band < AIR_MWIR) {
                const F32x8 both = f32x8_max(rho[band] + through, f32x8_set(1e-6));
                const F32x8 bright = f32x8_min(f32x8_load(b->texture[band] + i), one() / both);
                all_rho = f32x8_select(far.leaf, rho[band] * bright, all_rho);
                through = through * bright;
            }
        }
        const bool  among = b->canopy && band < AIR_MWIR && !b->around_w_m2[band];
        F32x8       around = b->around_w_m2[band] ? f32x8_load(b->around_w_m2[band] + i)
                             : among              ? among_plants(b->canopy, band, i, n.z, plane[band], level * below)
                                                  : f32x8_fma(level, below, plane[band]);
        const F32x8 level_w_m2 = level * below;
        F32x8       mirror_sky = one(), mirror_level = level;
        if (glossy && (b->below[band] || b->open[band])) {
            const F32x8 factor = b->below[band] ? f32x8_load(b->below[band] + i) : one();
            F32x8       open = around;
            if (b->open[band]) open = f32x8_load(b->open[band] + i) * (plane[band] + level_w_m2);
            mirror_sky = mirrored_sky(open - factor * level_w_m2, plane[band], air->light.sky_w_m2[band]);
            if (far.any && !b->open[band]) mirror_sky = f32x8_select(far.leaf, one(), mirror_sky);
            if (b->mirror_sky[band]) mirror_sky = f32x8_load(b->mirror_sky[band] + i);
            if (b->mirror_sky_found[band]) f32x8_store(b->mirror_sky_found[band] + i, mirror_sky);
            mirror_level = factor * level;
        }
        if (b->open[band]) around = around * f32x8_load(b->open[band] + i);
        F32x8 diffuse = all_rho, mirrored = zero(), mirrors = zero(), flash = zero();
        if (glossy) {
            const F32x8 gloss_rho = all_rho * of[gloss_share];
            mirrors = fresnel(gloss_rho, of[gloss_smooth2], f32x8_min(n_eye, one()), water_eye);
            diffuse = f32x8_and((all_rho - gloss_rho) * (one() - mirrors) / (one() - gloss_rho),
                                f32x8_less(gloss_rho, one()));
            const bool shines = f32x8_bits(f32x8_greater(glint, zero())) != 0;
            if (shines) flash = fresnel(gloss_rho, of[gloss_smooth2], f32x8_min(half, one()), water_half) * glint;
            if (panes && band < AIR_MWIR) {
                const F32x8 is = f32x8_greater(of[gloss_pane], zero());
                mirrors = f32x8_select(is, pane(gloss_rho, of[gloss_smooth2], f32x8_min(n_eye, one())), mirrors);
                if (shines)
                    flash = f32x8_select(is, pane(gloss_rho, of[gloss_smooth2], f32x8_min(half, one())) * glint, flash);
            }
            mirrored = mirrors * f32x8_lerp(mirror_level, mirror_sky * sky[band], sees_sky);
        }
        F32x8 reflected = f32x8_fma(diffuse * per_pi, around, mirrored);
        F32x8 sunlit = f32x8_fma(diffuse * per_pi, n_sun, flash) * (sun_w_m2 * arrives);
        if (far.any) {
            F32x8 behind = b->around_w_m2[band] ? zero()
                           : among ? among_plants(b->canopy, band, i, zero() - n.z, far.plane[band], level * far.below)
                                   : f32x8_fma(level, far.below, far.plane[band]);
            if (b->open[band]) behind = behind * f32x8_load(b->open[band] + i);
            reflected = f32x8_fma(through * per_pi, behind, reflected);
            sunlit = f32x8_fma(through * per_pi * far.n_sun, sun_w_m2 * arrives, sunlit);
        }
        F32x8 seen = f32x8_fma(reflected, f32x8_load(veil->air_transmittance + i), f32x8_load(veil->added_w_m2_sr + i));
        seen = f32x8_fma(sunlit, f32x8_load(veil->sun_transmittance + i), seen);
        if (band >= AIR_MWIR) {
            const PlanckTable *planck = band == AIR_MWIR ? air->light.planck_mwir : air->light.planck_lwir;
            float              emitted[8];
            planck_table_radiance8(emitted, planck, b->temp_k + i);
            seen = f32x8_fma((one() - diffuse - mirrors - through) * f32x8_load(emitted),
                             f32x8_load(veil->transmittance + i), seen);
        }
        f32x8_store(out[band] + i, seen);
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
