/* render/light/sky_horizon.c: the light that horizons of buildings leave. */
#include "render/light/sky_horizon_private.h"

#include "pitviper_simd.h"

static const double before_cells = 1.2;

static const HorizonCell *cell_at(const SkyHorizons *h, int i, int j)
{
    if (i < 0 || j < 0 || i >= h->tiles_x * horizon_tile_side || j >= h->tiles_y * horizon_tile_side) return NULL;
    const unsigned x = (unsigned)i, y = (unsigned)j, side = horizon_tile_side;
    const int      tile = h->tile_of[y / side * (unsigned)h->tiles_x + x / side];
    return tile < 0 ? NULL : &h->cell[(size_t)tile * horizon_tile_cells + y % side * side + x % side];
}

/* Sums of four vectors. */
static inline __m128 sums_of_four(F32x8 a, F32x8 b, F32x8 c, F32x8 d)
{
    const F32x8 halves = _mm256_hadd_ps(_mm256_hadd_ps(a, b), _mm256_hadd_ps(c, d));
    return _mm_add_ps(_mm256_castps256_ps128(halves), _mm256_extractf128_ps(halves, 1));
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

/* Whether nothing about a cell hides any sky. */
static inline bool is_open(const HorizonCell *cell)
{
    uint64_t slopes;
    _Static_assert(sizeof slopes == sizeof cell->slope, "eight octets");
    memcpy(&slopes, cell->slope, sizeof slopes);
    return slopes == 0;
}

/* The four cells about a place, and its share of each. */
typedef struct Four {
    const HorizonCell *cell[4];
    float              weight[4];
} Four;

/* A place somewhat before its surface, so that its cell is not that of what it is on; false: away from buildings. */
static inline bool find_cells(Four *out, const SkyHorizons *h, double x_m, double y_m, const float n[3])
{
    const double x = (x_m - h->x0_m) / h->cell_m + before_cells * (double)n[0];
    const double y = (y_m - h->y0_m) / h->cell_m + before_cells * (double)n[1];
    if (!(x >= 0 && y >= 0 && x < h->tiles_x * horizon_tile_side && y < h->tiles_y * horizon_tile_side)) return false;
    const int   i = (int)x, j = (int)y;
    const float u = (float)(x - i), v = (float)(y - j);
    out->cell[0] = cell_at(h, i, j), out->cell[1] = cell_at(h, i + 1, j);
    out->cell[2] = cell_at(h, i, j + 1), out->cell[3] = cell_at(h, i + 1, j + 1);
    out->weight[0] = (1 - u) * (1 - v), out->weight[1] = u * (1 - v);
    out->weight[2] = (1 - u) * v, out->weight[3] = u * v;
    return out->cell[0] || out->cell[1] || out->cell[2] || out->cell[3];
}

/* The horizon of a place, of sectors. */
typedef struct Horizon {
    F32x8 sine2, high;  /* squared sine of its elevation; what makes it, above the ground, by what it hides, m */
    F32x8 close_high;   /* the same of what stands close, without weights, m */
    float ground_m, of; /* sums of the cells' grounds and of their shares */
} Horizon;

/* Between the cells sin^2 is linear, as is the light that level ground loses. False: nothing hides any sky. */
static inline bool horizon_between(Horizon *out, const Four *four, bool close)
{
    F32x8 sine2 = f32x8_set(0), high = sine2, close_high = sine2;
    float ground_m = 0, of = 0;
    bool  some = false;
    for (int k = 0; k < 4; k++) {
        const HorizonCell *cell = four->cell[k];
        if (!cell) continue;
        const F32x8 weight = _mm256_set1_ps(four->weight[k]);
        const F32x8 s = f32x8_of_ints(i32x8_of_bytes(cell->slope)), up = f32x8_of_ints(i32x8_of_bytes(cell->height));
        const F32x8 share = weight * (s * s);
        sine2 = sine2 + share, high = f32x8_fma(share, up, high);
        if (close) close_high = close_high + f32x8_and(weight * up, f32x8_greater(s, f32x8_set(0.24 * 255)));
        ground_m = fmaf(four->weight[k], cell->ground_m, ground_m), of += four->weight[k];
        some = some || !is_open(cell);
    }
    out->high = f32x8_set(horizon_height_step_m * (1 - 1e-6)) * high /
                f32x8_max(sine2, f32x8_set(1e-6)); /* no more
                                                    * than theirs, if rounded */
    out->sine2 = f32x8_min(sine2 * f32x8_set(1 / (255.0 * 255)), f32x8_set(1 - 1e-6));
    out->close_high = f32x8_set(horizon_height_step_m) * close_high;
    out->ground_m = ground_m, out->of = of;
    return some;
}

/* The normal along sectors and up, how far the cells are before the place along them, m, and light of an open sky. */
typedef struct Facet {
    F32x8 aside, before_m, up, all;
} Facet;

/* Light that the horizon hides of each sector, of a sky that is as bright everywhere, for a place this high above the
 * ground. Cells are before the place: what makes the horizon is as much farther from it.
 *
 * The tangent of the horizon, s / c / (1 + s / c before / high) (1 - over / high) with sine and cosine s and c, is
 * rise / run with nothing divided yet; the light above it is the integrals over elevation h .. pi/2 of cos^2 and of
 * sin cos. */
static inline F32x8 hidden_by(const Horizon *h, float over_m, const Facet *f)
{
    const F32x8 one = f32x8_set(1), none = f32x8_set(0), s = f32x8_sqrt(h->sine2), c = f32x8_sqrt(one - h->sine2);
    const F32x8 rise = s * f32x8_max(h->high - _mm256_set1_ps(over_m > 0 ? over_m : 0), none);
    const F32x8 run = f32x8_max(f32x8_fma(s, f->before_m, c * h->high), f32x8_set(1e-6));
    const F32x8 steep = f32x8_less(run, rise), t = f32x8_min(rise, run) / f32x8_max(rise, run);
    const F32x8 arc = t * (f32x8_set(0.7853982) + f32x8_set(0.273) * (one - t)); /* arc tangent, within 0.004 */
    const F32x8 angle = f32x8_select(steep, arc, f32x8_set(0.5 * pi_rad) - arc); /* of the sky above */
    const F32x8 per = rise / f32x8_fma(rise, rise, run * run);
    const F32x8 above = f32x8_fma(f->aside, angle - run * per, f->up * (one - rise * per));
    return f32x8_max(f->all - f32x8_max(above, none), none);
}

/* light: NULL: the sun is not asked for. own: what is behind the place is. */
static inline Seen seen_from(const Four *four, const SkyHorizons *h, float z_m, const float n[3],
                             const SkyHorizonLight *light, bool own)
{
    const F32x8 east = f32x8_load(sine), north = f32x8_load(cosine), none = f32x8_set(0);
    F32x8       sunny = none, shaded = none, behind = none;
    float       sum[4], more[4];
    Seen        seen = {.share = 1};
    Facet       f;
    Horizon     horizon;
    if (!horizon_between(&horizon, four, own)) return seen;
    f.aside = f32x8_fma(_mm256_set1_ps(n[0]), east, _mm256_set1_ps(n[1]) * north);
    f.before_m = f32x8_max(f.aside, none) * f32x8_set(before_cells * h->cell_m);
    f.up = _mm256_set1_ps(n[2]);
    f.all = f32x8_max(f32x8_fma(f.aside, f32x8_set(0.5 * pi_rad), f.up), none);
    const F32x8 hidden = hidden_by(&horizon, z_m - horizon.ground_m / horizon.of, &f);
    if (light) {
        const F32x8 sun_east = _mm256_set1_ps(light->sun_enu[0]), sun_north = _mm256_set1_ps(light->sun_enu[1]);
        sunny = hidden * f32x8_max(none - f32x8_fma(sun_east, east, sun_north * north), none);
        shaded = hidden * f32x8_load(light->shaded);
    }
    if (own) behind = f32x8_max(none - f.aside, none);
    _mm_storeu_ps(sum, sums_of_four(hidden, sunny, shaded, f.all));
    if (sum[3] > 1e-4f) seen.share = 1 - sum[0] / sum[3], seen.lit = sum[1] / sum[3], seen.shaded = sum[2] / sum[3];
    if (own) {
        _mm_storeu_ps(more, sums_of_four(behind, behind * horizon.close_high, none, none));
        if (more[0] > 0.1f && sum[3] > 1e-4f) seen.own_high_m = more[1] / more[0];
    }
    return seen;
}

double sky_horizon_share(const SkyHorizons *h, const double p_enu[3], const double n_enu[3])
{
    const float n[3] = {(float)n_enu[0], (float)n_enu[1], (float)n_enu[2]};
    Four        four;
    if (!find_cells(&four, h, p_enu[0], p_enu[1], n)) return 1;
    return (double)seen_from(&four, h, (float)p_enu[2], n, NULL, false).share;
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
        Four        four;
        if (!find_cells(&four, h, hits->p_enu[0][i], hits->p_enu[1][i], n)) continue;
        const Seen seen = seen_from(&four, h, z_m, n, light, hits->kind[i] == hit_scenery);
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
