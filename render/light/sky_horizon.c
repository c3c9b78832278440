/* render/light/sky_horizon.c: the light that horizons of buildings leave. */
#include "render/light/sky_horizon_private.h"

#include "pitviper_simd.h"

static const double before_cells = 1.2;

static const HorizonCell *cell_at(const SkyHorizons *h, int i, int j)
{
    if (i < 0 || j < 0 || i >= h->tiles_x * horizon_tile_side || j >= h->tiles_y * horizon_tile_side) return NULL;
    const int tile = h->tile_of[j / horizon_tile_side * h->tiles_x + i / horizon_tile_side];
    return tile < 0 ? NULL
                    : &h->cell[(size_t)tile * horizon_tile_cells +
                               (size_t)(j % horizon_tile_side * horizon_tile_side + i % horizon_tile_side)];
}

static float sum8(F32x8 x)
{
    float each[8], sum = 0;
    f32x8_store(each, x);
    for (int k = 0; k < 8; k++) sum += each[k];
    return sum;
}

/* sum8 of eight vectors side by side, to the same bits: lane after lane. */
static F32x8 sums8(const F32x8 x[8])
{
    F32x8 pair[8], four[8], sum;
    for (int k = 0; k < 4; k++) {
        pair[2 * k] = _mm256_unpacklo_ps(x[2 * k], x[2 * k + 1]);
        pair[2 * k + 1] = _mm256_unpackhi_ps(x[2 * k], x[2 * k + 1]);
    }
    for (int k = 0; k < 8; k += 4)
        for (int i = 0; i < 2; i++) {
            four[k + 2 * i] = _mm256_shuffle_ps(pair[k + i], pair[k + i + 2], 0x44);
            four[k + 2 * i + 1] = _mm256_shuffle_ps(pair[k + i], pair[k + i + 2], 0xee);
        }
    sum = _mm256_permute2f128_ps(four[0], four[4], 0x20);
    for (int k = 1; k < 4; k++) sum = sum + _mm256_permute2f128_ps(four[k], four[k + 4], 0x20);
    for (int k = 0; k < 4; k++) sum = sum + _mm256_permute2f128_ps(four[k], four[k + 4], 0x31);
    return sum;
}

/* Light of a sky that is as bright everywhere, on a plane, of the part of a sector above a horizon of this tangent: the
 * integrals over elevation h .. pi/2 of cos^2 and of sin cos. */
static F32x8 above(F32x8 tangent, F32x8 aside, F32x8 up)
{
    const F32x8 one = f32x8_set(1), low = f32x8_less(tangent, one), per = one / f32x8_max(tangent, f32x8_set(1e-6));
    const F32x8 t = f32x8_select(low, tangent, per);
    const F32x8 arc = t * (f32x8_set(0.7853982) + f32x8_set(0.273) * (one - t)); /* arc tangent, within 0.004 */
    const F32x8 left = f32x8_select(low, f32x8_set(0.5 * pi_rad) - arc, arc),
                cosine2 = one / f32x8_fma(tangent, tangent, one);
    return f32x8_max(aside * (left - tangent * cosine2) + up * cosine2, f32x8_set(0));
}

static float ground_under(const SkyHorizons *h, double x_m, double y_m, float z_m)
{
    const HorizonCell *cell = cell_at(h, (int)((x_m - h->x0_m) / h->cell_m), (int)((y_m - h->y0_m) / h->cell_m));
    return cell ? cell->ground_m : z_m;
}

/* What a place sees, of a sky that is as bright everywhere. */
typedef struct Seen {
    float share;      /* that arrives */
    float lit;        /* of what buildings fill: mean cosine of the sun on their walls */
    float shaded;     /* of what buildings fill: share whose walls face ground in their shadow, for that ground's sun */
    float own_high_m; /* of what is behind the place */
} Seen;

static const float sine[8] = {0, 0.70710678f, 1, 0.70710678f, 0, -0.70710678f, -1, -0.70710678f};
static const float cosine[8] = {1, 0.70710678f, 0, -0.70710678f, -1, -0.70710678f, 0, 0.70710678f};

typedef struct Facet {
    F32x8 aside, behind, up, all; /* of sectors: normal along them and against; open light */
    F32x8 sunny, shaded; /* of the walls there that face us: cosine of the sun, share of their ground that is shaded */
    float open;
} Facet;

/* Whether nothing about a cell hides any sky. */
static bool is_open(const HorizonCell *cell)
{
    uint64_t slopes;
    _Static_assert(sizeof slopes == sizeof cell->slope, "eight octets");
    memcpy(&slopes, cell->slope, sizeof slopes);
    return slopes == 0;
}

/* What one cell leaves and hides, for a place at this height. before_m: the cell is that far before the place, along
 * the normal: what makes its horizon is as much farther from the place. own: what is behind it, else it stays. */
static void cell_seen(F32x8 *left, F32x8 *lit, F32x8 *shaded, F32x8 *own, const HorizonCell *cell, float z_m,
                      const Facet *f, double before_m)
{
    const F32x8 code = f32x8_of_ints(i32x8_of_bytes(cell->slope)) * f32x8_set(1.0 / 255);
    const F32x8 high = f32x8_of_ints(i32x8_of_bytes(cell->height)) * f32x8_set(horizon_height_step_m);
    const F32x8 over = _mm256_set1_ps(z_m - cell->ground_m > 0 ? z_m - cell->ground_m : 0);
    const F32x8 near = code / f32x8_sqrt(f32x8_max(f32x8_set(1) - code * code, f32x8_set(1e-6)));
    const F32x8 more = f32x8_fma(near * f32x8_set(before_m), f32x8_max(f->aside, f32x8_set(0)) / high, f32x8_set(1));
    const F32x8 tangent = near / more * f32x8_clamp(f32x8_set(1) - over / high, 0, 1);
    *left = f32x8_min(above(tangent, f->aside, f->up), f->all);
    *lit = (f->all - *left) * f->sunny;
    *shaded = (f->all - *left) * f->shaded;
    *own = f32x8_and(high * f->behind, f32x8_greater(code, f32x8_set(0.24)));
}

/* Adds four cells, of these weights. own: what is behind the place is asked for. */
static void add_cells(Seen *to, const HorizonCell *const cell[4], const float weight[4], float z_m, const Facet *f,
                      double before_m, bool own)
{
    F32x8 first[8], second[8]; /* what is left and lit, what is shaded and behind */
    float sum[8], more[8];
    bool  some = false;
    for (int k = 0; k < 4; k++) {
        first[k] = f->all, first[4 + k] = second[k] = second[4 + k] = f32x8_set(0); /* where nothing hides any sky */
        if (!cell[k] || !(f->open > 1e-4f) || is_open(cell[k])) continue;
        cell_seen(&first[k], &first[4 + k], &second[k], &second[4 + k], cell[k], z_m, f, before_m);
        some = true;
    }
    if (some) f32x8_store(sum, sums8(first)), f32x8_store(more, sums8(second));
    for (int k = 0; k < 4; k++) {
        if (!cell[k] || !(f->open > 1e-4f)) {
            to->share += weight[k];
            continue;
        }
        to->share += weight[k] * (some ? sum[k] : f->open) / f->open;
        if (!some) continue;
        to->lit += weight[k] * sum[4 + k] / f->open;
        to->shaded += weight[k] * more[k] / f->open;
        if (own) to->own_high_m += weight[k] * more[4 + k];
    }
}

/* A place somewhat before its surface, so that its cell is not that of what it is on. light: NULL: the sun is not asked
 * for. own: what is behind the place is. */
static Seen seen_at(const SkyHorizons *h, double x_m, double y_m, float z_m, const float n[3],
                    const SkyHorizonLight *light, bool own)
{
    const double x = (x_m - h->x0_m) / h->cell_m + before_cells * (double)n[0];
    const double y = (y_m - h->y0_m) / h->cell_m + before_cells * (double)n[1];
    const Seen   all = {.share = 1};
    Seen         seen = {0};
    Facet        f;
    if (!(x >= 0 && y >= 0 && x < h->tiles_x * horizon_tile_side && y < h->tiles_y * horizon_tile_side)) return all;
    const int          i = (int)x, j = (int)y;
    const HorizonCell *cell[4] = {cell_at(h, i, j), cell_at(h, i + 1, j), cell_at(h, i, j + 1),
                                  cell_at(h, i + 1, j + 1)};
    if (!cell[0] && !cell[1] && !cell[2] && !cell[3]) return all;
    const F32x8 east = f32x8_load(sine), north = f32x8_load(cosine), none = f32x8_set(0);
    f.aside = f32x8_fma(_mm256_set1_ps(n[0]), east, _mm256_set1_ps(n[1]) * north);
    f.up = _mm256_set1_ps(n[2]);
    f.behind = f32x8_max(none - f.aside, none);
    const float behind = sum8(f.behind);
    f.behind = f.behind * _mm256_set1_ps(behind > 0.1f ? 1 / behind : 0);
    f.sunny = f.shaded = none;
    if (light) {
        const F32x8 sun_east = _mm256_set1_ps(light->sun_enu[0]), sun_north = _mm256_set1_ps(light->sun_enu[1]);
        f.sunny = f32x8_max(none - f32x8_fma(sun_east, east, sun_north * north), none);
        f.shaded = f32x8_load(light->shaded);
    }
    f.all = above(none, f.aside, f.up);
    f.open = sum8(f.all);
    const float u = (float)(x - i), v = (float)(y - j),
                weight[4] = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
    add_cells(&seen, cell, weight, z_m, &f, before_cells * h->cell_m, own);
    return seen;
}

double sky_horizon_share(const SkyHorizons *h, const double p_enu[3], const double n_enu[3])
{
    const float n[3] = {(float)n_enu[0], (float)n_enu[1], (float)n_enu[2]};
    return (double)seen_at(h, p_enu[0], p_enu[1], (float)p_enu[2], n, NULL, false).share;
}

void sky_horizon_light(SkyHorizonLight *out, const SkyHorizons *h, const Air *air,
                       const double level_w_m2[AIR_BAND_COUNT])
{
    const Daylight *light = &air->light;
    const double    up = fmax(light->sun_d_enu[2], 0);
    *out = (SkyHorizonLight){.sky = {0}};
    for (int c = 0; c < 3 && up > 0; c++) out->sun_enu[c] = (float)light->sun_d_enu[c];
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        const double sky = light->sky_w_m2[b], sun = b >= AIR_MWIR ? 0 : light->sun_w_m2[b];
        out->sky[b] = (float)sky, out->level[b] = (float)level_w_m2[b];
        /* in the thermal bands about as warm as the ground */
        out->wall[b] = (float)(b >= AIR_MWIR ? level_w_m2[b] : 0.5 * h->wall_rho[b] * (sky + level_w_m2[b]));
        out->sunlit_wall[b] = (float)(b >= AIR_MWIR ? 0 : h->wall_rho[b] * sun);
        out->level_sun[b] = (float)(sun * up > 0 ? sun * up / (sun * up + sky) : 0);
        out->wall_by_sun[b] = b >= AIR_MWIR ? 0 : (float)(0.5 * h->wall_rho[b] * level_w_m2[b]) * out->level_sun[b];
    }
    /* A wall without ends that is turned away from the sun: its shadow is away / up times its height deep, and fills
     * of the ground that a place on it sees 1 - z / sqrt(z^2 + deep^2), on the mean over the wall this. */
    for (int s = 0; s < sky_horizon_sectors && up > 0.02; s++) {
        const float deep = fmaxf(out->sun_enu[0] * sine[s] + out->sun_enu[1] * cosine[s], 0) / out->sun_enu[2];
        out->shaded[s] = 1 + deep - sqrtf(1 + deep * deep);
    }
}

/* Of the ground that a wall sees, the share in the shadow of its own building: a strip without ends before it. */
static float own_shade(const SkyHorizonLight *light, const Seen *seen, const float n[3], float above_m)
{
    const float away = -(n[0] * light->sun_enu[0] + n[1] * light->sun_enu[1]);
    if (!(away > 0 && light->sun_enu[2] > 0.02f && seen->own_high_m > 0)) return 0;
    const float deep_m = seen->own_high_m * away / light->sun_enu[2], z_m = above_m > 0.1f ? above_m : 0.1f;
    return 1 - z_m / sqrtf(z_m * z_m + deep_m * deep_m);
}

void sky_horizon_open(float (*factor)[hits_capacity], const SkyHorizons *h, const SkyHorizonLight *light,
                      unsigned air_bands, const Hits *hits)
{
    const F32x8 sky = f32x8_load(light->sky), level = f32x8_load(light->level), wall = f32x8_load(light->wall);
    const F32x8 sunlit = f32x8_load(light->sunlit_wall), level_sun = f32x8_load(light->level_sun);
    const F32x8 by_sun = f32x8_load(light->wall_by_sun);
    for (int i = 0; i < hits->count; i++) {
        if (hits->kind[i] != hit_ground && hits->kind[i] != hit_scenery) continue;
        const float n[3] = {hits->n_enu[0][i], hits->n_enu[1][i], hits->n_enu[2][i]};
        const float z_m = (float)hits->p_enu[2][i];
        const Seen seen = seen_at(h, hits->p_enu[0][i], hits->p_enu[1][i], z_m, n, light, hits->kind[i] == hit_scenery);
        float      of[8], shade = 0;
        if (hits->kind[i] == hit_scenery && seen.own_high_m > 0)
            shade = own_shade(light, &seen, n, z_m - ground_under(h, hits->p_enu[0][i], hits->p_enu[1][i], z_m));
        if (seen.share == 1 && shade == 0) continue;
        const F32x8 up = _mm256_set1_ps(0.5f * (1 + n[2])), down = _mm256_set1_ps(0.5f * (1 - n[2])) * level;
        const F32x8 open = f32x8_max(sky * up + down, f32x8_set(1e-20));
        const F32x8 walls = _mm256_set1_ps(1 - seen.share) * wall + _mm256_set1_ps(seen.lit) * sunlit -
                            _mm256_set1_ps(seen.shaded) * by_sun;
        const F32x8 below = down * (f32x8_set(1) - _mm256_set1_ps(shade) * level_sun);
        f32x8_store(of, (up * f32x8_fma(_mm256_set1_ps(seen.share), sky, walls) + below) / open);
        for (int b = 0; b < AIR_BAND_COUNT; b++)
            if (air_bands >> b & 1) factor[b][i] *= of[b];
    }
}
