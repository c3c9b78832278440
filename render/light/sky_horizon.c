/* render/light/sky_horizon.c: the light that horizons of buildings leave. */
#include "render/light/sky_horizon_private.h"

#include "pitviper_simd.h"

static const double before_cells = 1.2;
/* behind_m: a place may be so far behind the nearest wall's plane, as below eaves, and is before it. */
static const float behind_m = 0.6f, least_away_m = 0.02f, no_end_m = 1e3f;

static const HorizonCell *cell_at(const SkyHorizons *h, int i, int j)
{
    if (i < 0 || j < 0 || i >= h->tiles_x * horizon_tile_side || j >= h->tiles_y * horizon_tile_side) return NULL;
    const unsigned x = (unsigned)i, y = (unsigned)j, side = horizon_tile_side;
    const int      tile = h->tile_of[y / side * (unsigned)h->tiles_x + x / side];
    return tile < 0 ? NULL : &h->cell[(size_t)tile * horizon_tile_cells + y % side * side + x % side];
}

/* Sums of four vectors. */
static inline __m128 sums_over_ground(F32x8 a, F32x8 b, F32x8 c, F32x8 d)
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

static bool is_level(const float n[3]) { return n[2] > 0.5f; }

/* A place's surface, along sectors, and the sun. */
typedef struct Facet {
    F32x8 aside, behind, up, all; /* normal along them and against, and up; light of an open sky */
    F32x8 before_m;               /* how far the cells are before the place along them */
    F32x8 sunny, deep; /* of walls there that face us: cosine of the sun, and depth of their shadow in their heights */
    bool  level;       /* rather than upright */
    float sun_enu[2], per_sun_up;
    const float (*facing_enu)[2];
} Facet;

/* What hides the sky of a place, by sectors: light that it takes, of that what walls in the sun show (times its cosine)
 * and what their own shadow shades; and how high what stands close is, m. */
typedef struct Hidden {
    F32x8 light, lit, shaded, close_high;
} Hidden;

/* Whether nothing about a cell hides any sky; one with a wall near hides some. */
static inline bool is_open(const HorizonCell *cell)
{
    uint64_t slopes;
    _Static_assert(sizeof slopes == sizeof cell->slope, "eight octets");
    memcpy(&slopes, cell->slope, sizeof slopes);
    return slopes == 0 && cell->wall_rise == 0;
}

/* The four cells about a place, its share of each, and how far east and north of each it is, which the nearest walls
 * know. */
typedef struct Four {
    const HorizonCell *cell[4];
    float              weight[4], east_m[4], north_m[4];
} Four;

/* Cells that something covers say nothing where others do. */
static inline void leave_covered(Four *f)
{
    float left = 0;
    bool  covered = false;
    for (int k = 0; k < 4; k++) covered = covered || f->cell[k]->covered;
    if (!covered) return;
    for (int k = 0; k < 4; k++)
        if (!f->cell[k]->covered) left += f->weight[k];
    if (!(left > 0.02f)) return;
    for (int k = 0; k < 4; k++) f->weight[k] = f->cell[k]->covered ? 0 : f->weight[k] / left;
}

/* A place somewhat before its surface, so that its cell is not that of what it is on; false: away from buildings. */
static inline bool find_cells(Four *out, const SkyHorizons *h, double x_m, double y_m, const float n[3])
{
    static const HorizonCell nothing = {.ground_m = 0};
    const double             x = (x_m - h->x0_m) / h->cell_m + before_cells * (double)n[0];
    const double             y = (y_m - h->y0_m) / h->cell_m + before_cells * (double)n[1];
    const int                side = horizon_tile_side;
    if (!(x >= 0 && y >= 0 && x < h->tiles_x * side && y < h->tiles_y * side)) return false;
    const int   i = (int)x, j = (int)y;
    const float u = (float)(x - i), v = (float)(y - j);
    out->cell[0] = cell_at(h, i, j);
    for (int k = 1; k < 4; k++) /* mostly of one tile */
        out->cell[k] = out->cell[0] && i % side < side - 1 && j % side < side - 1
                           ? out->cell[0] + (k & 1) + (k >> 1) * side
                           : cell_at(h, i + (k & 1), j + (k >> 1));
    if (!out->cell[0] && !out->cell[1] && !out->cell[2] && !out->cell[3]) return false;
    out->weight[0] = (1 - u) * (1 - v), out->weight[1] = u * (1 - v);
    out->weight[2] = (1 - u) * v, out->weight[3] = u * v;
    const double east_m = x_m - h->x0_m - i * h->cell_m, north_m = y_m - h->y0_m - j * h->cell_m;
    for (int k = 0; k < 4; k++) {
        if (!out->cell[k]) out->cell[k] = &nothing;
        out->east_m[k] = (float)(k & 1 ? east_m - h->cell_m : east_m);
        out->north_m[k] = (float)(k >> 1 ? north_m - h->cell_m : north_m);
    }
    leave_covered(out);
    return true;
}

/* Light of a sky that is as bright everywhere, on a plane, of the part of a sector above a horizon of tangent rise /
 * run: the integrals over elevation h .. pi/2 of cos^2 and of sin cos. */
static inline F32x8 above(F32x8 rise, F32x8 run, const Facet *f)
{
    const F32x8 one = f32x8_set(1);
    const F32x8 steep = f32x8_less(run, rise), t = f32x8_min(rise, run) / f32x8_max(rise, run);
    const F32x8 arc = t * (f32x8_set(0.7853982) + f32x8_set(0.273) * (one - t)); /* arc tangent, within 0.004 */
    const F32x8 angle = f32x8_select(steep, arc, f32x8_set(0.5 * pi_rad) - arc); /* of the sky above */
    const F32x8 per = rise / f32x8_fma(rise, rise, run * run);
    return f32x8_max(f32x8_fma(f->aside, angle - run * per, f->up * (one - rise * per)), f32x8_set(0));
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

/* What cells say of a place, by sectors, as sums over their shares. */
typedef struct Horizon {
    F32x8 rest, sine2, high; /* share that no nearest wall fills; there squared sine of the elevation, and of that times
                              * how high above the ground what makes it is, in steps */
    F32x8 walls, wall_sine2, lit, deep; /* share that nearest walls fill; there the same of their edges, cosine of the
                                         * sun on them, and depth of their shadows in their heights */
    F32x8 close_high;                   /* how high what stands close is, in steps */
} Horizon;

/* The nearest walls of four cells from a place, those that it sees: azimuth of their normals, and of their ends from
 * there, left ones first, in sectors; tangent of the edge square before the place; cosine of the sun on them and depth
 * of their shadows in their heights. */
typedef struct Walls {
    unsigned seen; /* bits of cells */
    float    facing[4], end[8], edge[4], lit[4], deep[4];
} Walls;

/* Arc tangent of y / x, x > 0, in sectors; within 0.005. */
static F32x8 sectors_of(F32x8 y, F32x8 x)
{
    const F32x8 a = f32x8_abs(y), one = f32x8_set(1), low = f32x8_min(a, x) / f32x8_max(a, x);
    const F32x8 arc = low * f32x8_fma(f32x8_set(0.3476), one - low, one), steep = f32x8_less(x, a);
    const F32x8 size = f32x8_select(steep, f32x8_set(2) - arc, arc);
    return f32x8_or(size, f32x8_and(y, f32x8_set(-0.0)));
}

/* How high the place is over the ground of each, m; 0 below. */
static inline __m128 over_ground(const HorizonCell *const cell[4], float z_m)
{
    const __m128 over_m =
        _mm_set1_ps(z_m) - _mm_setr_ps(cell[0]->ground_m, cell[1]->ground_m, cell[2]->ground_m, cell[3]->ground_m);
    return _mm_max_ps(over_m, _mm_setzero_ps());
}

static inline void walls_of(Walls *out, const Four *four, float z_m, const Facet *f)
{
    __m128 row[4], far[4], n[2];
    for (int k = 0; k < 4; k++) { /* HorizonCell's octets from `covered` on */
        const F32x8 all = f32x8_of_ints(i32x8_of_bytes(&four->cell[k]->covered));
        row[k] = _mm256_castps256_ps128(all), far[k] = _mm256_extractf128_ps(all, 1);
    }
    _MM_TRANSPOSE4_PS(row[0], row[1], row[2], row[3]); /* covered, facing, away, rise */
    _MM_TRANSPOSE4_PS(far[0], far[1], far[2], far[3]); /* left, right */
    for (int c = 0; c < 2; c++)
        n[c] = _mm_setr_ps(f->facing_enu[four->cell[0]->wall_facing][c], f->facing_enu[four->cell[1]->wall_facing][c],
                           f->facing_enu[four->cell[2]->wall_facing][c], f->facing_enu[four->cell[3]->wall_facing][c]);
    const __m128 none = _mm_setzero_ps(), step_m = _mm_set1_ps((float)horizon_wall_step_m);
    const __m128 east_m = _mm_loadu_ps(four->east_m), north_m = _mm_loadu_ps(four->north_m);
    const __m128 away_m = row[2] * _mm_set1_ps((float)horizon_away_step_m) + n[0] * east_m + n[1] * north_m;
    const __m128 rise_m = row[3] * step_m - over_ground(four->cell, z_m), right_m = n[0] * north_m - n[1] * east_m;
    const __m128 seen = _mm_and_ps(_mm_and_ps(_mm_cmpgt_ps(row[3], none), _mm_cmpgt_ps(rise_m, none)),
                                   _mm_cmpgt_ps(away_m, _mm_set1_ps(-behind_m)));
    out->seen = (unsigned)_mm_movemask_ps(seen);
    if (!out->seen) return;
    const __m128 there_m = _mm_max_ps(away_m, _mm_set1_ps(least_away_m)), on = _mm_set1_ps(255);
    __m128       end_m[2];
    for (int e = 0; e < 2; e++)
        end_m[e] = _mm_blendv_ps(far[e] * step_m, _mm_set1_ps(no_end_m), _mm_cmpge_ps(far[e], on));
    const __m128 sun = n[0] * _mm_set1_ps(f->sun_enu[0]) + n[1] * _mm_set1_ps(f->sun_enu[1]);
    f32x8_store(out->end, sectors_of(_mm256_set_m128(end_m[1] - right_m, none - end_m[0] - right_m),
                                     _mm256_set_m128(there_m, there_m)));
    _mm_storeu_ps(out->facing, row[1] * _mm_set1_ps(1.0f / 32));
    _mm_storeu_ps(out->edge, rise_m / there_m);
    _mm_storeu_ps(out->lit, _mm_max_ps(sun, none));
    _mm_storeu_ps(out->deep, _mm_max_ps(none - sun, none) * _mm_set1_ps(f->per_sun_up));
}

/* sin^2 of the elevation of a wall's edge so many sectors aside. edge: its tangent square before the place. */
static F32x8 sine2_to(F32x8 sectors, F32x8 edge)
{
    const F32x8 angle = sectors * f32x8_set(0.25 * pi_rad), angle2 = angle * angle;
    const F32x8 slant = f32x8_fma(angle2, f32x8_fma(angle2, f32x8_set(0.03705), f32x8_set(-0.4967)), f32x8_set(1));
    const F32x8 tangent = f32x8_clamp(edge * slant, 0, 1e3), tangent2 = tangent * tangent;
    return tangent2 / (f32x8_set(1) + tangent2);
}

/* What of each sector a cell's wall fills, and there the mean of sin^2 of its edge's elevation. */
static inline F32x8 wall_fills(F32x8 *sine2, const Walls *walls, int cell)
{
    static const float number[8] = {-4, -3, -2, -1, 0, 1, 2, 3};
    const F32x8        half = f32x8_set(0.5), edge = _mm256_set1_ps(walls->edge[cell]);
    /* sectors' middles from where the wall is square before the place, -4 .. 4 */
    F32x8 at = f32x8_load(number) - _mm256_set1_ps(walls->facing[cell]);
    at = at - f32x8_set(8) * f32x8_floor(f32x8_fma(at, f32x8_set(0.125), half));
    const F32x8 from = f32x8_max(at - half, _mm256_set1_ps(walls->end[cell]));
    const F32x8 to = f32x8_min(at + half, _mm256_set1_ps(walls->end[4 + cell]));
    const F32x8 filled = f32x8_clamp(to - from, 0, 1);
    const F32x8 mid = half * (from + to), aside = f32x8_set(0.28867513) * filled; /* Gauss's two places */
    *sine2 = half * (sine2_to(mid - aside, edge) + sine2_to(mid + aside, edge));
    return filled;
}

/* Between cells sin^2 is linear, as is the light that level ground loses. */
static inline void horizon_of(Horizon *out, const Four *four, float z_m, const Facet *f, bool own)
{
    const F32x8 none = f32x8_set(0);
    Walls       walls;
    walls_of(&walls, four, z_m, f);
    *out = (Horizon){none, none, none, none, none, none, none, none};
    for (int k = 0; k < 4; k++) {
        const HorizonCell *cell = four->cell[k];
        const F32x8        weight = _mm256_set1_ps(four->weight[k]);
        const F32x8 s = f32x8_of_ints(i32x8_of_bytes(cell->slope)), up = f32x8_of_ints(i32x8_of_bytes(cell->height));
        F32x8       rest = weight, close = f32x8_greater(s, f32x8_set(0.24 * 255));
        if (walls.seen >> k & 1) {
            F32x8       edge2;
            const F32x8 fills = wall_fills(&edge2, &walls, k), filled = weight * fills;
            rest = rest - filled, out->walls = out->walls + filled;
            out->wall_sine2 = f32x8_fma(filled, edge2, out->wall_sine2);
            out->lit = f32x8_fma(filled, _mm256_set1_ps(walls.lit[k]), out->lit);
            out->deep = f32x8_fma(filled, _mm256_set1_ps(walls.deep[k]), out->deep);
            close = f32x8_or(close, f32x8_greater(fills, f32x8_set(0.5)));
        }
        const F32x8 sine2 = rest * (s * s);
        out->rest = out->rest + rest, out->sine2 = out->sine2 + sine2, out->high = f32x8_fma(sine2, up, out->high);
        if (own) out->close_high = out->close_high + f32x8_and(weight * up, close);
    }
}

/* What a horizon hides of a place so high above the ground. Cells are before the place: what makes the horizon is as
 * much farther from it. With sine and cosine s and c its tangent is s / c / (1 + s / c before / high) (1 - over /
 * high), rise / run with nothing divided yet. Nearest walls are known from the place itself. */
static inline void hidden_by(Hidden *out, const Horizon *h, float over_m, const Facet *f, bool lit)
{
    const F32x8 one = f32x8_set(1), none = f32x8_set(0), least = f32x8_set(1e-6), most = f32x8_set(1 - 1e-6);
    const F32x8 sine2 = f32x8_min(h->sine2 * f32x8_set(1 / (255.0 * 255)) / f32x8_max(h->rest, least), most);
    /* no more than theirs, if rounded */
    const F32x8 high = f32x8_set(horizon_height_step_m * (1 - 1e-6)) * h->high / f32x8_max(h->sine2, least);
    const F32x8 s = f32x8_sqrt(sine2), c = f32x8_sqrt(one - sine2);
    const F32x8 rise = s * f32x8_max(high - _mm256_set1_ps(over_m > 0 ? over_m : 0), none);
    const F32x8 run = f32x8_max(f32x8_fma(s, f->before_m, c * high), least);
    const F32x8 per_wall = one / f32x8_max(h->walls, least), edge2 = f32x8_min(h->wall_sine2 * per_wall, most);
    const F32x8 edge = f32x8_sqrt(edge2), level = f32x8_sqrt(one - edge2);
    const F32x8 far = h->rest * f32x8_max(f->all - above(rise, run, f), none);
    const F32x8 near = f32x8_max(f->all - above(f32x8_max(edge, least), level, f), none);
    out->light = f32x8_fma(h->walls, near, far);
    out->close_high = f32x8_set(horizon_height_step_m) * h->close_high;
    out->lit = out->shaded = none;
    if (!lit) return;
    out->lit = f32x8_fma(near, h->lit, far * f->sunny);
    out->shaded = f32x8_fma(h->walls * near, shade_of(f, edge / level, h->deep * per_wall),
                            far * shade_of(f, rise / run, f->deep));
}

static inline void facet(Facet *f, const SkyHorizons *h, const float n[3], const SkyHorizonLight *light)
{
    const F32x8 east = f32x8_load(sine), north = f32x8_load(cosine), none = f32x8_set(0);
    f->aside = f32x8_fma(_mm256_set1_ps(n[0]), east, _mm256_set1_ps(n[1]) * north);
    f->behind = f32x8_max(none - f->aside, none);
    f->before_m = f32x8_max(f->aside, none) * f32x8_set(before_cells * h->cell_m);
    f->up = _mm256_set1_ps(n[2]);
    f->all = f32x8_max(f32x8_fma(f->aside, f32x8_set(0.5 * pi_rad), f->up), none);
    f->sunny = f->deep = none;
    f->level = is_level(n);
    f->sun_enu[0] = f->sun_enu[1] = f->per_sun_up = 0;
    f->facing_enu = (const float(*)[2])h->facing_enu;
    if (!light) return;
    const F32x8 sun_east = _mm256_set1_ps(light->sun_enu[0]), sun_north = _mm256_set1_ps(light->sun_enu[1]);
    const F32x8 along = f32x8_fma(sun_east, east, sun_north * north);
    for (int c = 0; c < 2; c++) f->sun_enu[c] = light->sun_enu[c];
    f->per_sun_up = light->sun_enu[2] > 0.02f ? 1 / light->sun_enu[2] : 0;
    f->sunny = f32x8_max(none - along, none);
    f->deep = f32x8_max(along, none) * _mm256_set1_ps(f->per_sun_up);
}

/* light: NULL: the sun is not asked for. own: what is behind the place is. */
static inline Seen seen_from(const Four *four, const SkyHorizons *h, float z_m, const float n[3],
                             const SkyHorizonLight *light, bool own)
{
    Seen    seen = {.share = 1};
    Hidden  all;
    Horizon horizon;
    Facet   f;
    float   over_m = 0, sum[4], more[4];
    bool    hides = false;
    for (int k = 0; k < 4; k++) hides = hides || !is_open(four->cell[k]);
    if (!hides) return seen;
    for (int k = 0; k < 4; k++) over_m = fmaf(four->weight[k], z_m - four->cell[k]->ground_m, over_m);
    facet(&f, h, n, light);
    horizon_of(&horizon, four, z_m, &f, own);
    hidden_by(&all, &horizon, over_m, &f, light != NULL);
    _mm_storeu_ps(sum, sums_over_ground(all.light, all.lit, all.shaded, f.all));
    if (sum[3] > 1e-4f) seen.share = 1 - sum[0] / sum[3], seen.lit = sum[1] / sum[3], seen.shaded = sum[2] / sum[3];
    if (own) {
        const F32x8 none = f32x8_set(0);
        _mm_storeu_ps(more, sums_over_ground(f.behind, f.behind * all.close_high, none, none));
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

/* Of a hit: by what to multiply its light, by AirBand, and of the ground before it that below has (1: nothing). */
typedef struct Factors {
    float of[8], sunny[8];
    bool  open, shaded; /* whether they are 1 each */
} Factors;

static void factors_of(Factors *out, const SkyHorizons *h, const SkyHorizonLight *light, const Hits *hits, int i)
{
    const F32x8 sky = f32x8_load(light->sky), level = f32x8_load(light->level);
    const float n[3] = {hits->n_enu[0][i], hits->n_enu[1][i], hits->n_enu[2][i]}, z_m = (float)hits->p_enu[2][i];
    const bool  own = hits->kind[i] == hit_scenery;
    Four        four;
    out->open = true, out->shaded = false;
    if (!find_cells(&four, h, hits->p_enu[0][i], hits->p_enu[1][i], n)) return;
    const Seen  seen = seen_from(&four, h, z_m, n, light, own);
    const float above_m = own ? z_m - ground_under(h, hits->p_enu[0][i], hits->p_enu[1][i], z_m) : 0;
    const float shade = own ? own_shade(light, &seen, n, above_m) : 0;
    if (seen.share == 1 && shade == 0) return;
    out->open = false, out->shaded = shade > 0;
    const F32x8 up = _mm256_set1_ps(0.5f * (1 + n[2])), down = _mm256_set1_ps(0.5f * (1 - n[2])) * level;
    const F32x8 open = f32x8_max(sky * up + down, f32x8_set(1e-20));
    /* what lights the foot of a wall is the ground before it, which has as little of the sky as this place */
    const float hidden = 1 - seen.share, before = is_level(n) ? hidden * hidden : 0;
    const F32x8 walls = _mm256_set1_ps(hidden) * f32x8_load(light->wall) +
                        _mm256_set1_ps(seen.lit) * f32x8_load(light->sunlit_wall) -
                        _mm256_set1_ps(seen.shaded) * f32x8_load(light->wall_by_sun) -
                        _mm256_set1_ps(before) * f32x8_load(light->wall_by_sky);
    const F32x8 left = f32x8_set(1) - _mm256_set1_ps(shade) * f32x8_load(light->level_sun);
    f32x8_store(out->of, (up * f32x8_fma(_mm256_set1_ps(seen.share), sky, walls) + down * left) / open);
    f32x8_store(out->sunny, left);
}

bool sky_horizon_open(float (*factor)[hits_capacity], float (*below)[hits_capacity], const SkyHorizons *h,
                      const SkyHorizonLight *light, unsigned air_bands, const Hits *hits)
{
    bool any = false;
    for (int i = 0; i < hits->count; i++) {
        Factors f;
        if (hits->kind[i] != hit_ground && hits->kind[i] != hit_scenery) continue;
        factors_of(&f, h, light, hits, i);
        if (f.open) continue;
        for (unsigned b = 0; b < AIR_BAND_COUNT; b++)
            if (air_bands >> b & 1) factor[b][i] *= f.of[b];
        if (!f.shaded) continue;
        for (unsigned b = 0; b < AIR_BAND_COUNT; b++)
            if (air_bands >> b & 1) below[b][i] *= f.sunny[b];
        any = true;
    }
    return any;
}
