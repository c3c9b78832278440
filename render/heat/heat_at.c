/* render/heat/heat_at.c: temperatures at places, from the tables of one frame. */

#include "pitviper_simd.h"
#include "render/heat/heat.h"

/* ---- ground ----------------------------------------------------------------------------------- */

static inline F64x4 lanes_of_table(const float *table, __m128i at)
{
    return _mm256_cvtps_pd(_mm_i32gather_ps(table, at, sizeof *table));
}

static inline F64x4 clamp4(F64x4 x, double low, double high) /* NaN: high */
{
    return f64x4_max(f64x4_min(x, f64x4_set(high)), f64x4_set(low));
}

/* Interpolates a kind's table in the height of the normal: node is the lower one, share the way to the next. */
static inline F64x4 by_up(const float table[ground_kinds][heat_ups], __m128i node, F64x4 share)
{
    const F64x4 low = lanes_of_table(&table[0][0], node), high = lanes_of_table(&table[0][1], node);
    return low + share * (high - low);
}

void heat_grounds_k(double temp_k[heat_lanes], const HeatNow *now, const HeatPlaces *place)
{
    const GroundHeatTable *t = &now->table;
    const __m128i          kind = _mm_loadu_si128((const __m128i *)place->kind);
    const F64x4            none = f64x4_set(0), one = f64x4_set(1), last = f64x4_set(t->facets - 1);
    const F64x4 nx = f64x4_loadu(place->n_enu[0]), ny = f64x4_loadu(place->n_enu[1]), nz = f64x4_loadu(place->n_enu[2]);
    /* coordinates of the normal on the square of facets, -1 .. 1; below the horizon: the wall of that side */
    const F64x4 sum = f64x4_abs(nx) + f64x4_abs(ny) + f64x4_max(nz, none);
    const F64x4 over = f64x4_and(f64x4_less(none, sum), one / sum);
    const F64x4 x = f64x4_set(0.5) * ((nx + ny) * over + one) * last,
                y = f64x4_set(0.5) * ((nx - ny) * over + one) * last;
    const __m128i i = _mm256_cvttpd_epi32(clamp4(x, 0, t->facets - 2)),
                  j = _mm256_cvttpd_epi32(clamp4(y, 0, t->facets - 2));
    const __m128i facets = _mm_set1_epi32(t->facets), of_kind = _mm_set1_epi32(heat_most_facets * heat_most_facets);
    const __m128i at = _mm_add_epi32(_mm_mullo_epi32(kind, of_kind), _mm_add_epi32(_mm_mullo_epi32(j, facets), i));
    const __m128i above = _mm_add_epi32(at, facets);
    const float  *sun = &t->sun_k[0][0];
    const F64x4 in_x = x - f64x4_of_ints(i), low_west = lanes_of_table(sun, at), high_west = lanes_of_table(sun, above);
    const F64x4 low = low_west + in_x * (lanes_of_table(sun + 1, at) - low_west);
    const F64x4 high = high_west + in_x * (lanes_of_table(sun + 1, above) - high_west);
    const F64x4 sun_k = low + (y - f64x4_of_ints(j)) * (high - low);
    const F64x4 up = clamp4(nz, 0, 1) * f64x4_set(heat_ups - 1);
    const __m128i node = _mm256_cvttpd_epi32(f64x4_min(up, f64x4_set(heat_ups - 2)));
    const __m128i of_up = _mm_add_epi32(_mm_mullo_epi32(kind, _mm_set1_epi32(heat_ups)), node);
    const F64x4   share = up - f64x4_of_ints(node);
    const F64x4   shade_k = by_up(t->shade_k, of_up, share), dark_k = by_up(t->dark_k, of_up, share);
    const F64x4   hidden_k = lanes_of_table(t->hidden_k, kind), dark = f64x4_loadu(place->dark);
    const F64x4   lit_k = sun_k + f64x4_loadu(place->taken) * (shade_k - sun_k),
                seen_k = dark_k + dark * (lit_k - dark_k);
    const F64x4 closed = one - f64x4_loadu(place->open);
    f64x4_storeu(temp_k, seen_k + closed * (hidden_k - (dark_k + dark * (shade_k - dark_k))));
}

double heat_ground_k(const HeatNow *now, int kind, const double n_enu[3], double taken, double open, double dark)
{
    HeatPlaces place;
    double     temp_k[heat_lanes];
    for (int k = 0; k < heat_lanes; k++) {
        for (int c = 0; c < 3; c++) place.n_enu[c][k] = n_enu[c];
        place.kind[k] = kind, place.taken[k] = taken, place.open[k] = open, place.dark[k] = dark;
    }
    heat_grounds_k(temp_k, now, &place);
    return temp_k[0];
}

/* Sums over the slots, eight side by side: of the past sun on a normal, and of that in the shade, times 255. */
static inline void past_sums(F32x8 *all, F32x8 *taken, const HeatNow *now, int kind, const double n_enu[3],
                             const uint8_t *shadow)
{
    const float *weight = now->table.slot_k[kind];
    const F32x8  nx = f32x8_set(n_enu[0]), ny = f32x8_set(n_enu[1]), nz = f32x8_set(n_enu[2]), none = f32x8_set(0);
    *all = *taken = none;
    for (int s = 0; s < now->slots; s += 8) {
        const F32x8 along =
            f32x8_fma(nx, f32x8_load(now->slot_d_enu[0] + s),
                      f32x8_fma(ny, f32x8_load(now->slot_d_enu[1] + s), nz * f32x8_load(now->slot_d_enu[2] + s)));
        const F32x8 k = f32x8_max(along, none) * f32x8_load(weight + s);
        *all = *all + k;
        *taken = f32x8_fma(k, f32x8_of_ints(i32x8_of_bytes(shadow + s)), *taken);
    }
}

double heat_taken(const HeatNow *now, int kind, const double n_enu[3], const uint8_t *shadow)
{
    F32x8 all, taken;
    float sum[2][8];
    past_sums(&all, &taken, now, kind, n_enu, shadow);
    f32x8_store(sum[0], all);
    f32x8_store(sum[1], taken);
    double total = 0, lost = 0;
    for (int i = 0; i < 8; i++) total += (double)sum[0][i], lost += (double)sum[1][i];
    return total > 1e-3 ? fmin(lost / (255 * total), 1) : 0; /* both are rounded */
}

/* heat_taken of places side by side, to the same bits. */
static void find_taken(HeatPlaces *place, const HeatNow *now, uint8_t shadow[heat_lanes][shadow_most_slots])
{
    F32x8 sum[8]; /* of each lane all, then what was taken; turned, lanes by eighth */
    F64x4 total = f64x4_set(0), lost = total;
    _Static_assert(heat_lanes == 4, "sums of four lanes, twice, are eight");
    for (int k = 0; k < heat_lanes; k++) {
        const double n_enu[3] = {place->n_enu[0][k], place->n_enu[1][k], place->n_enu[2][k]};
        past_sums(&sum[k], &sum[heat_lanes + k], now, place->kind[k], n_enu, shadow[k]);
    }
    f32x8_transpose(sum);
    for (int i = 0; i < 8; i++) {
        total = total + _mm256_cvtps_pd(_mm256_castps256_ps128(sum[i]));
        lost = lost + _mm256_cvtps_pd(_mm256_extractf128_ps(sum[i], 1));
    }
    const F64x4 share = f64x4_min(lost / (f64x4_set(255) * total), f64x4_set(1));
    f64x4_storeu(place->taken, f64x4_and(f64x4_less(f64x4_set(1e-3), total), share));
}

void heat_scales(double *sun, double *sky, const HeatNow *now, int kind)
{
    const HeatPast *p = &now->past[1];
    const double    shade_k = (double)now->table.shade_k[kind][heat_ups - 1];
    const double    sunlit_k = heat_ground_k(now, kind, (const double[3]){0, 0, 1}, 0, 1, 1);
    double          sun_k = 0, sky_k = 0;
    for (int i = 0; i < p->count; i++) {
        sun_k += (double)p->sun_k[kind][i] * fmax(p->sun_d_enu[i][2], 0);
        sky_k += (double)p->sky_k[kind][i];
    }
    *sun = fabs(sun_k) > 0.5 ? clamp((sunlit_k - shade_k) / sun_k, 0.5, 2) : 1;
    *sky = fabs(sky_k) > 0.5 ? clamp((shade_k - (double)now->table.hidden_k[kind]) / sky_k, 0.5, 2) : 1;
}

/* ---- bark ------------------------------------------------------------------------------------- */

double heat_branch_k(const HeatNow *now, int material, double radius_m, const double n_enu[3], double open)
{
    int    kind = 0, r = 0;
    double k[2];
    if (now->branches == 0) return NAN;
    for (int i = 0; i < now->branches; i++)
        if (now->branch_material[i] == material) kind = i;
    const double radius = clamp(radius_m, branch_radius_m[0], branch_radius_m[branch_radii - 1]);
    while (r < branch_radii - 2 && radius > branch_radius_m[r + 1]) r++;
    const double share = log(radius / branch_radius_m[r]) / log(branch_radius_m[r + 1] / branch_radius_m[r]);
    for (int i = 0; i < 2; i++) {
        const BranchSides *s = now->table.branch[kind][r + i];
        const double       shade_k = branch_side_k(&s[1], n_enu);
        k[i] = shade_k + open * (branch_side_k(&s[0], n_enu) - shade_k);
    }
    return k[0] + share * (k[1] - k[0]);
}

/* ---- the temperature of the ground of one frame ---------------------------------------------- */

/* The temperature of the ground of one frame: shade of the hours before, and marks. */

static double with_mark(double temp_k, const HeatScene *scene, const MarkedGround *mark, int kind,
                        const double n_enu[3], double taken, double open, double dark)
{
    const HeatNow *now = scene->now;
    if (mark->loose > 0 && ground_kind_loosens(kind))
        temp_k += mark->loose * (heat_ground_k(now, SURFACE_PLOUGHED, n_enu, taken, open, dark) - temp_k);
    if (mark->burnt > 0) temp_k += mark->burnt * (heat_ground_k(now, ground_burnt, n_enu, taken, open, 1) - temp_k);
    return temp_k + mark->add_k;
}

void heat_scene_grounds_k(double temp_k[heat_lanes], double lifted_k[heat_lanes], const HeatScene *scene,
                          const GroundPlaces *at)
{
    const HeatNow *now = scene->now;
    HeatPlaces     place;
    uint8_t        shadow[heat_lanes][shadow_most_slots];
    bool           shaded = false;
    memcpy(place.n_enu, at->n_enu, sizeof place.n_enu);
    memcpy(place.dark, at->dark, sizeof place.dark);
    for (int k = 0; k < heat_lanes; k++) {
        place.kind[k] = now->kind_of[at->surface[k]];
        place.open[k] = 1, place.taken[k] = 0;
        if (scene->shadow)
            shaded |= heat_shadow_at(shadow[k], &place.open[k], scene->shadow, at->p_enu[0][k], at->p_enu[1][k]);
    }
    if (shaded) find_taken(&place, now, shadow);
    heat_grounds_k(temp_k, now, &place);
    for (int k = 0; k < heat_lanes; k++) {
        const double unlit_k = (double)now->table.dark_k[place.kind[k]][heat_ups - 1];
        lifted_k[k] = temp_k[k] > unlit_k ? temp_k[k] - unlit_k : 0;
    }
    for (int k = 0; k < heat_lanes && scene->marks; k++) {
        const double p_enu[3] = {at->p_enu[0][k], at->p_enu[1][k], at->p_enu[2][k]};
        const double n_enu[3] = {at->n_enu[0][k], at->n_enu[1][k], at->n_enu[2][k]};
        MarkedGround mark;
        if (heat_marks_at(&mark, scene->marks, place.kind[k], p_enu, n_enu, 1 - place.taken[k]))
            temp_k[k] =
                with_mark(temp_k[k], scene, &mark, place.kind[k], n_enu, place.taken[k], place.open[k], at->dark[k]);
    }
}

double heat_scene_ground_k(double *lifted_k, const HeatScene *scene, int surface, const double p_enu[3],
                           const double n_enu[3], double dark)
{
    GroundPlaces at;
    double       temps_k[heat_lanes], lifts_k[heat_lanes];
    for (int k = 0; k < heat_lanes; k++) {
        for (int c = 0; c < 3; c++) at.p_enu[c][k] = p_enu[c], at.n_enu[c][k] = n_enu[c];
        at.surface[k] = surface, at.dark[k] = dark;
    }
    heat_scene_grounds_k(temps_k, lifts_k, scene, &at);
    *lifted_k = lifts_k[0];
    return temps_k[0];
}
