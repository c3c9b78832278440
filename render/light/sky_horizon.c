/* render/light/sky_horizon.c: the light that horizons of buildings leave. */
#include "render/light/sky_horizon_private.h"

#include "pitviper_simd.h"

/* behind_m: a place may be so far behind the nearest wall's plane, as below eaves, and is before it. */
static const double before_cells = 1.2, behind_m = 0.6, least_away_m = 0.02;

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

static bool is_level(const float n[3]) { return n[2] > 0.5f; }

typedef struct Facet {
    F32x8  aside, behind, up, all; /* of sectors: normal along them and against; open light */
    F32x8  sunny, deep; /* of walls there that face us: cosine of the sun, and depth of their shadow in their heights */
    float  open;
    bool   level; /* rather than upright */
    double sun_enu[2], per_sun_up;
    const double (*facing_enu)[2];
} Facet;

/* Whether nothing about a cell hides any sky. */
static bool is_open(const HorizonCell *cell)
{
    uint64_t slopes;
    _Static_assert(sizeof slopes == sizeof cell->slope, "eight octets");
    memcpy(&slopes, cell->slope, sizeof slopes);
    return slopes == 0 && cell->wall_rise == 0;
}

/* A cell's nearest wall from a place: what of each sector it fills, and the tangent of its edge there. */
typedef struct WallSeen {
    F32x8 filled, tangent;
    float lit, deep; /* cosine of the sun on it, depth of its shadow in its heights */
} WallSeen;

/* Arc tangent of y / x, x > 0, in sectors; within 0.005. */
static float sectors_of(float y, float x)
{
    const float a = fabsf(y), low = a < x ? a / x : x / a, arc = low * (1 + 0.3476f * (1 - low));
    return copysignf(a < x ? arc : 2 - arc, y);
}

/* sin^2 of the elevation of a wall's edge so many sectors aside. edge: its tangent square before the place. */
static F32x8 sine2_to(F32x8 sectors, F32x8 edge)
{
    const F32x8 angle = sectors * f32x8_set(0.25 * pi_rad), angle2 = angle * angle;
    const F32x8 slant = f32x8_fma(angle2, f32x8_fma(angle2, f32x8_set(0.03705), f32x8_set(-0.4967)), f32x8_set(1));
    const F32x8 tangent = f32x8_clamp(edge * slant, 0, 1e3), tangent2 = tangent * tangent;
    return tangent2 / (f32x8_set(1) + tangent2);
}

static void wall_seen(WallSeen *out, const HorizonCell *cell, float z_m, const Facet *f, const double off_m[2])
{
    static const float number[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    const F32x8        half = f32x8_set(0.5), none = f32x8_set(0), one = f32x8_set(1);
    const double      *n = f->facing_enu[cell->wall_facing], sun = n[0] * f->sun_enu[0] + n[1] * f->sun_enu[1];
    const double       there_m = cell->wall_away * horizon_away_step_m + n[0] * off_m[0] + n[1] * off_m[1];
    const double       over_m = fmax((double)(z_m - cell->ground_m), 0);
    const double       rise_m = cell->wall_rise * horizon_wall_step_m - over_m;
    *out = (WallSeen){none, none, (float)fmax(sun, 0), (float)(fmax(-sun, 0) * f->per_sun_up)};
    if (!(rise_m > 0 && there_m > -behind_m)) return;
    const float  away_m = (float)fmax(there_m, least_away_m), right_m = (float)(n[0] * off_m[1] - n[1] * off_m[0]);
    const double left = cell->wall_left == 255 ? 1e3 : cell->wall_left * horizon_wall_step_m;
    const double right = cell->wall_right == 255 ? 1e3 : cell->wall_right * horizon_wall_step_m;
    const F32x8  first = _mm256_set1_ps(sectors_of(-(float)left - right_m, away_m));
    const F32x8  last = _mm256_set1_ps(sectors_of((float)right - right_m, away_m));
    /* sectors' middles from where the wall is square before the place, -4 .. 4 */
    F32x8 at = f32x8_load(number) - f32x8_set(cell->wall_facing / 32.0 + 4);
    at = at - f32x8_set(8) * f32x8_floor(f32x8_fma(at, f32x8_set(0.125), half));
    const F32x8 from = f32x8_max(at - half, first), to = f32x8_min(at + half, last);
    out->filled = f32x8_clamp(to - from, 0, 1);
    const F32x8 mid = half * (from + to), aside = f32x8_set(0.28867513) * out->filled,
                edge = f32x8_set(rise_m / (double)away_m);
    const F32x8 sine2 = half * (sine2_to(mid - aside, edge) + sine2_to(mid + aside, edge)); /* Gauss's two places */
    out->tangent = f32x8_sqrt(sine2 / (one - sine2));
}

/* Of the ground before a wall, as it shines on level ground at r of its heights: what its shadow covers of what is seen
 * by the half of it, of its light, that is the lower, z of its heights up: cos h of that is the mean of 1 and cos of
 * its top's. deep: of the shadow, in its heights. */
static F32x8 shade_before(F32x8 tangent, F32x8 deep)
{
    const F32x8 one = f32x8_set(1), half = f32x8_set(0.5);
    const F32x8 t = f32x8_max(tangent, f32x8_set(0.05)); /* farther off it stays, and 1 - cos h is rounded away */
    const F32x8 middle = f32x8_fma(half, one / f32x8_sqrt(f32x8_fma(t, t, one)), half);
    const F32x8 z = f32x8_sqrt(one - middle * middle) / (middle * t);
    return one - z / f32x8_sqrt(f32x8_fma(deep, deep, z * z));
}

/* On a place that is upright the mean over the wall's height. */
static F32x8 shade_of(const Facet *f, F32x8 tangent, F32x8 deep)
{
    const F32x8 one = f32x8_set(1);
    if (f->level) return shade_before(tangent, deep);
    return one + deep - f32x8_sqrt(f32x8_fma(deep, deep, one));
}

/* What one cell leaves and hides, for a place at this height. before_m: the cell is that far before the place, along
 * the normal: what makes its horizon is as much farther from the place. off_m: the place is this far east and north of
 * the cell, which the nearest wall knows. own: what is behind it, else it stays. */
static void cell_seen(F32x8 *left, F32x8 *lit, F32x8 *shaded, F32x8 *own, const HorizonCell *cell, float z_m,
                      const Facet *f, double before_m, const double off_m[2])
{
    const F32x8 one = f32x8_set(1);
    const F32x8 code = f32x8_of_ints(i32x8_of_bytes(cell->slope)) * f32x8_set(1.0 / 255);
    const F32x8 high = f32x8_of_ints(i32x8_of_bytes(cell->height)) * f32x8_set(horizon_height_step_m);
    const F32x8 over = _mm256_set1_ps(z_m - cell->ground_m > 0 ? z_m - cell->ground_m : 0);
    const F32x8 near = code / f32x8_sqrt(f32x8_max(one - code * code, f32x8_set(1e-6)));
    const F32x8 more = f32x8_fma(near * f32x8_set(before_m), f32x8_max(f->aside, f32x8_set(0)) / high, one);
    const F32x8 tangent = near / more * f32x8_clamp(one - over / high, 0, 1);
    F32x8       behind = f32x8_greater(code, f32x8_set(0.24));
    *left = f32x8_min(above(tangent, f->aside, f->up), f->all);
    *lit = (f->all - *left) * f->sunny;
    *shaded = (f->all - *left) * shade_of(f, tangent, f->deep);
    if (cell->wall_rise > 0) {
        WallSeen wall;
        wall_seen(&wall, cell, z_m, f, off_m);
        const F32x8 open = f32x8_min(above(wall.tangent, f->aside, f->up), f->all), fills = f->all - open;
        *left = f32x8_lerp(*left, open, wall.filled);
        *lit = f32x8_lerp(*lit, fills * _mm256_set1_ps(wall.lit), wall.filled);
        *shaded = f32x8_lerp(*shaded, fills * shade_of(f, wall.tangent, _mm256_set1_ps(wall.deep)), wall.filled);
        behind = f32x8_or(behind, f32x8_greater(wall.filled, f32x8_set(0.5)));
    }
    *own = f32x8_and(high * f->behind, behind);
}

/* What four cells know of a place. off_m: as cell_seen. own: what is behind the place is asked for. */
static void add_cells(Seen *to, const HorizonCell *const cell[4], const float weight[4], float z_m, const Facet *f,
                      double before_m, const double off_m[4][2], bool own)
{
    F32x8 first[8], second[8]; /* what is left and lit, what is shaded and behind */
    float sum[8], more[8];
    bool  some = false;
    for (int k = 0; k < 4; k++) {
        first[k] = f->all, first[4 + k] = second[k] = second[4 + k] = f32x8_set(0); /* where nothing hides any sky */
        if (!cell[k] || !(f->open > 1e-4f) || is_open(cell[k]) || !(weight[k] > 0)) continue;
        cell_seen(&first[k], &first[4 + k], &second[k], &second[4 + k], cell[k], z_m, f, before_m, off_m[k]);
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

/* Cells that something covers say nothing where others do. */
static void leave_covered(float weight[4], const HorizonCell *const cell[4])
{
    float left = 0;
    for (int k = 0; k < 4; k++)
        if (!cell[k] || !cell[k]->covered) left += weight[k];
    if (!(left > 0.02f) || left == 1) return;
    for (int k = 0; k < 4; k++) weight[k] = !cell[k] || !cell[k]->covered ? weight[k] / left : 0;
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
    f.sunny = f.deep = none;
    f.level = is_level(n);
    f.sun_enu[0] = f.sun_enu[1] = f.per_sun_up = 0;
    f.facing_enu = (const double(*)[2])h->facing_enu;
    if (light) {
        const F32x8 sun_east = _mm256_set1_ps(light->sun_enu[0]), sun_north = _mm256_set1_ps(light->sun_enu[1]);
        const F32x8 along = f32x8_fma(sun_east, east, sun_north * north);
        for (int c = 0; c < 2; c++) f.sun_enu[c] = (double)light->sun_enu[c];
        f.per_sun_up = light->sun_enu[2] > 0.02f ? 1 / (double)light->sun_enu[2] : 0;
        f.sunny = f32x8_max(none - along, none);
        f.deep = f32x8_max(along, none) * f32x8_set(f.per_sun_up);
    }
    f.all = above(none, f.aside, f.up);
    f.open = sum8(f.all);
    const float u = (float)(x - i), v = (float)(y - j);
    float       weight[4] = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
    double      off_m[4][2];
    for (int k = 0; k < 4; k++) {
        off_m[k][0] = x_m - h->x0_m - (i + (k & 1)) * h->cell_m;
        off_m[k][1] = y_m - h->y0_m - (j + (k >> 1)) * h->cell_m;
    }
    leave_covered(weight, cell);
    add_cells(&seen, cell, weight, z_m, &f, before_cells * h->cell_m, (const double(*)[2])off_m, own);
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
        out->wall_by_sky[b] = b >= AIR_MWIR ? 0 : (float)(0.5 * h->wall_rho[b] * level_w_m2[b]) - out->wall_by_sun[b];
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

bool sky_horizon_open(float (*factor)[hits_capacity], float (*below)[hits_capacity], const SkyHorizons *h,
                      const SkyHorizonLight *light, unsigned air_bands, const Hits *hits)
{
    bool        any = false;
    const F32x8 sky = f32x8_load(light->sky), level = f32x8_load(light->level), wall = f32x8_load(light->wall);
    const F32x8 sunlit = f32x8_load(light->sunlit_wall), level_sun = f32x8_load(light->level_sun);
    const F32x8 by_sun = f32x8_load(light->wall_by_sun), by_sky = f32x8_load(light->wall_by_sky);
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
        /* what lights the foot of a wall is the ground before it, which has as little of the sky as this place */
        const float hidden = 1 - seen.share, before = is_level(n) ? hidden * hidden : 0;
        const F32x8 walls = _mm256_set1_ps(hidden) * wall + _mm256_set1_ps(seen.lit) * sunlit -
                            _mm256_set1_ps(seen.shaded) * by_sun - _mm256_set1_ps(before) * by_sky;
        const F32x8 left = f32x8_set(1) - _mm256_set1_ps(shade) * level_sun;
        float       sunny[8];
        f32x8_store(of, (up * f32x8_fma(_mm256_set1_ps(seen.share), sky, walls) + down * left) / open);
        f32x8_store(sunny, left);
        for (int b = 0; b < AIR_BAND_COUNT; b++)
            if (air_bands >> b & 1) factor[b][i] *= of[b], below[b][i] *= sunny[b];
        any |= shade > 0;
    }
    return any;
}
