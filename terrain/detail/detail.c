/* terrain/detail/detail.c: noise of the ground at places: octaves evaluated once each, and mixed by class into
 * reflectance, temperature, backscatter and slopes.
 *
 * An octave is a lattice of random values, interpolated with weights whose squares sum to 1, so that its variance is 1
 * at lattice points and between them; each lattice is turned by its own angle, so that none shows as a grid. Every
 * lattice point has two uncorrelated values: one is of the albedo and the height, and what of temperature and
 * backscatter does not follow the albedo is of the other. */
#include "terrain/detail/detail.h"
#include "terrain/invented/invented_eight.h"

/* ---- an octave ---------------------------------------------------------------------------------- */

/* Weights of the two lattice points along an axis, and how fast the share of the second rises. */
typedef struct AxisWeights {
    F32x8 first, second, rise;
} AxisWeights;

/* sin (pi s / 2), 0 .. 1, within 1.1e-4 */
static inline F32x8 quarter_sine(F32x8 s)
{
    const F32x8 s2 = s * s;
    return s * f32x8_fma(s2, f32x8_fma(s2, f32x8_set(0.0727102), f32x8_set(-0.6432292)), f32x8_set(1.5706268));
}

static inline AxisWeights axis_weights(F32x8 t)
{
    const F32x8 s = t * t * (f32x8_set(3) - f32x8_set(2) * t), one = f32x8_set(1);
    return (AxisWeights){quarter_sine(one - s), quarter_sine(s), f32x8_set(3 * pi_rad) * t * (one - t)};
}

/* Two values of a mixed word, each of deviation 1: sum and difference of its halves, as integers. */
static inline void values_of_word(F32x8 *first, F32x8 *second, I32x8 h)
{
    h = i32x8_mul(i32x8_xor(h, i32x8_shift_right(h, 16)), i32x8_set(0x7feb352d));
    h = i32x8_mul(i32x8_xor(h, i32x8_shift_right(h, 15)), i32x8_set((int)0x846ca68bu));
    const I32x8 high = _mm256_srai_epi32(h, 16), low = _mm256_srai_epi32(_mm256_slli_epi32(h, 16), 16);
    const F32x8 unit = f32x8_set(3.7377083e-5); /* sqrt(6) / 65536: deviation of a half is 65536 / sqrt(12) */
    *first = f32x8_of_ints(i32x8_add(high, low)) * unit;
    if (second) *second = f32x8_of_ints(i32x8_sub(high, low)) * unit;
}

/* odd multipliers whose lattice of equal words has no vector shorter than 35 000 cells */
static const uint32_t east_step = 0x9e3779b1u, north_step = 0x85ebca77u;

/* values_of_word of the corners SW, SE, NW, NE of one cell, each in all lanes. */
static inline void corners_of_word(F32x8 first[4], F32x8 *second, I32x8 sw, int east, int north)
{
    const I32x8 word =
        i32x8_add(sw, _mm256_setr_epi32(0, east, north, (int)((unsigned)east + (unsigned)north), 0, 0, 0, 0));
    F32x8 one, two;
    values_of_word(&one, second ? &two : NULL, word);
    for (int k = 0; k < 4; k++) {
        first[k] = _mm256_permutevar8x32_ps(one, i32x8_set(k));
        if (second) second[k] = _mm256_permutevar8x32_ps(two, i32x8_set(k));
    }
}

typedef struct Octave {
    F32x8 first, second;    /* two noise values, each of deviation 1 */
    F32x8 slope_x, slope_y; /* slope of the first, per metre */
} Octave;

static const struct {
    double cosine, sine;
} turn[detail_octaves] = {/* cosine and sine of n + 1 times the golden angle */
                          {-0.73736887807831974, 0.67549029426152385}, {0.087425724716959877, -0.99617104086482777},
                          {0.60843886097886257, 0.79360075129169594},  {-0.98471348531542868, -0.17418195037931164},
                          {0.84375529481239719, -0.53672805262632273}, {-0.25960430490148856, 0.9657150743757783},
                          {-0.4609070247133692, -0.88744842924525458}, {0.93932129632411809, 0.34303863087410202}};

/* two: whether the second value is computed; slopes: whether the slopes are. */
static inline Octave octave_eight(uint64_t seed, int n, const double x_m[8], const double y_m[8], bool two, bool slopes)
{
    const I32x8  east = i32x8_set((int)east_step), north = i32x8_set((int)north_step);
    const double c = turn[n].cosine, s = turn[n].sine;
    double       u_m[8], v_m[8];
    for (int k = 0; k < 8; k += 4) {
        const F64x4 x = f64x4_loadu(x_m + k), y = f64x4_loadu(y_m + k);
        f64x4_storeu(u_m + k, x * f64x4_set(c) + y * f64x4_set(s));
        f64x4_storeu(v_m + k, y * f64x4_set(c) - x * f64x4_set(s));
    }
    const Lattice     u = lattice_of(u_m, 1 / detail_octave_m[n]), v = lattice_of(v_m, 1 / detail_octave_m[n]);
    const AxisWeights a = axis_weights(u.share), b = axis_weights(v.share);
    const I32x8       key = i32x8_set((int)(uint32_t)(invented_hash(seed + (uint64_t)n, 0, 0) >> 32));
    const I32x8       sw = i32x8_add(key, i32x8_add(i32x8_mul(u.cell, east), i32x8_mul(v.cell, north)));
    const I32x8       nw = i32x8_add(sw, north);
    F32x8             first[4], second[4];
    const I32x8       word[4] = {sw, i32x8_add(sw, east), nw, i32x8_add(nw, east)};
    if (f32x8_bits(i32x8_equal(sw, _mm256_permutevar8x32_epi32(sw, i32x8_set(0)))) == 0xff) {
        corners_of_word(first, two ? second : NULL, sw, (int)east_step, (int)north_step); /* all are in one cell */
    } else {
        for (int k = 0; k < 4; k++) values_of_word(&first[k], two ? &second[k] : NULL, word[k]);
    }

    Octave      out = {.second = f32x8_set(0), .slope_x = f32x8_set(0), .slope_y = f32x8_set(0)};
    const F32x8 south = f32x8_fma(a.first, first[0], a.second * first[1]);
    const F32x8 top = f32x8_fma(a.first, first[2], a.second * first[3]);
    out.first = f32x8_fma(b.first, south, b.second * top);
    if (two)
        out.second = f32x8_fma(b.first, f32x8_fma(a.first, second[0], a.second * second[1]),
                               b.second * f32x8_fma(a.first, second[2], a.second * second[3]));
    if (slopes) { /* second' = rise first, first' = -rise second */
        const F32x8 per_m = f32x8_set(1 / detail_octave_m[n]);
        const F32x8 south_u = a.first * first[1] - a.second * first[0],
                    top_u = a.first * first[3] - a.second * first[2];
        const F32x8 along_u = a.rise * f32x8_fma(b.first, south_u, b.second * top_u) * per_m;
        const F32x8 along_v = b.rise * (b.first * top - b.second * south) * per_m;
        out.slope_x = along_u * f32x8_set(c) - along_v * f32x8_set(s);
        out.slope_y = along_u * f32x8_set(s) + along_v * f32x8_set(c);
    }
    return out;
}

/* ---- weights ------------------------------------------------------------------------------------ */

/* Nodes of the footprints of eight places, and how far they are beyond them. */
typedef struct Nodes {
    int32_t class[8], size[8], elongation[8];
    float size_share[8], elongation_share[8];
    bool  same; /* the eight places share class and nodes */
} Nodes;

/* Nodes are equally spaced between powers of 2: exponent and mantissa of a float are their position. Of eight. */
static inline I32x8 find_node(float share[8], F32x8 x, int per_doubling_log2, int least_log2, int nodes)
{
    const int   shift = 23 - per_doubling_log2;
    const F32x8 at_least = f32x8_max(x, f32x8_set(ldexp(1, least_log2))); /* NaN becomes the least */
    const I32x8 bits = i32x8_sub(_mm256_castps_si256(at_least), i32x8_set((127 + least_log2) << 23));
    const I32x8 node = i32x8_shift_right(bits, shift), last = i32x8_set(nodes - 2);
    const F32x8 beyond = i32x8_greater(node, last);
    const F32x8 in_node = f32x8_of_ints(i32x8_and(bits, i32x8_set((1 << shift) - 1))) * f32x8_set(ldexp(1, -shift));
    f32x8_store(share, f32x8_select(beyond, f32x8_set(1), in_node));
    return i32x8_select(beyond, last, node);
}

static void find_nodes(Nodes *out, int some, const uint8_t *surface, const float *across_m, const float *along_m)
{
    float across[8], along[8];
    for (int k = 0; k < 8; k++) {
        const int  at = k < some ? k : 0; /* places beyond the last repeat the first */
        const bool known = surface[at] > SURFACE_NONE && surface[at] < SURFACE_COUNT;
        across[k] = across_m[at], along[k] = along_m[at];
        out->class[k] = known ? surface[at] : SURFACE_NONE;
    }
    const F32x8 wide = f32x8_load(across), first = f32x8_set(1);
    const F32x8 longer = f32x8_select(f32x8_greater(wide, f32x8_set(0)), f32x8_load(along) / wide, first);
    const I32x8 size = find_node(out->size_share, wide, 2, detail_least_log2, detail_sizes);
    const I32x8 elongation = find_node(out->elongation_share, longer, 1, 0, detail_longs),
                class = i32x8_load(out->class);
    const I32x8 lane = i32x8_set(0);
    const F32x8 equal = f32x8_and(i32x8_equal(class, _mm256_permutevar8x32_epi32(class, lane)),
                                  f32x8_and(i32x8_equal(size, _mm256_permutevar8x32_epi32(size, lane)),
                                            i32x8_equal(elongation, _mm256_permutevar8x32_epi32(elongation, lane))));
    i32x8_store(out->size, size), i32x8_store(out->elongation, elongation);
    out->same = f32x8_bits(equal) == 0xff;
}

/* Finds the octaves for which any of the places has a weight, in each field. */
static void used_octaves(uint8_t used[detail_fields], const DetailTable *t, const Nodes *nodes)
{
    uint32_t all = 0;
    _Static_assert(detail_fields == sizeof all, "the fields of a node are read as one word");
    for (int k = 0; k < (nodes->same ? 1 : 8); k++) {
        const uint8_t(*at)[detail_longs][detail_fields] = &t->used[nodes->class[k]][nodes->size[k]];
        for (int corner = 0; corner < 4; corner++) {
            uint32_t word;
            memcpy(&word, at[corner >> 1][nodes->elongation[k] + (corner & 1)], sizeof word);
            all |= word;
        }
    }
    memcpy(used, &all, sizeof all);
}

static inline F32x8 between(F32x8 low_low, F32x8 low_high, F32x8 high_low, F32x8 high_high, F32x8 size,
                            F32x8 elongation)
{
    return f32x8_lerp(f32x8_lerp(low_low, low_high, elongation), f32x8_lerp(high_low, high_high, elongation), size);
}

/* Weights of the eight octaves at eight places. */
static void find_weights(F32x8 out[detail_octaves], const DetailTable *t, const Nodes *nodes, DetailField f,
                         unsigned used)
{
    if (nodes->same) {
        const DetailWeights(*at)[detail_longs] = &t->weights[nodes->class[0]][nodes->size[0]];
        const int   j = nodes->elongation[0];
        const F32x8 size = f32x8_load(nodes->size_share), elongation = f32x8_load(nodes->elongation_share);
        for (unsigned left = used; left; left &= left - 1) {
            const int n = __builtin_ctz(left);
            out[n] =
                between(_mm256_set1_ps(at[0][j].of[f][n]), _mm256_set1_ps(at[0][j + 1].of[f][n]),
                        _mm256_set1_ps(at[1][j].of[f][n]), _mm256_set1_ps(at[1][j + 1].of[f][n]), size, elongation);
        }
        return;
    }
    for (int k = 0; k < 8; k++) {
        const DetailWeights(*at)[detail_longs] = &t->weights[nodes->class[k]][nodes->size[k]];
        const int j = nodes->elongation[k];
        out[k] = between(f32x8_load(at[0][j].of[f]), f32x8_load(at[0][j + 1].of[f]), f32x8_load(at[1][j].of[f]),
                         f32x8_load(at[1][j + 1].of[f]), _mm256_set1_ps(nodes->size_share[k]),
                         _mm256_set1_ps(nodes->elongation_share[k]));
    }
    f32x8_transpose(out);
}

static inline F32x8 of_class(const float table[SURFACE_COUNT][detail_fields], const Nodes *nodes, DetailField f)
{
    if (nodes->same) return _mm256_set1_ps(table[nodes->class[0]][f]);
    return _mm256_setr_ps(table[nodes->class[0]][f], table[nodes->class[1]][f], table[nodes->class[2]][f],
                          table[nodes->class[3]][f], table[nodes->class[4]][f], table[nodes->class[5]][f],
                          table[nodes->class[6]][f], table[nodes->class[7]][f]);
}

/* ---- eight places ------------------------------------------------------------------------------- */

/* Sum of a field's octaves, and its variance. */
typedef struct FieldSum {
    unsigned used;
    F32x8    weight[detail_octaves], value, variance;
} FieldSum;

static inline void add_octave(FieldSum *sum, F32x8 noise, F32x8 weight)
{
    sum->value = f32x8_fma(weight, noise, sum->value);
    sum->variance = f32x8_fma(weight, weight, sum->variance);
}

static inline F32x8 skewed(const FieldSum *sum, F32x8 bend)
{
    return f32x8_fma(bend, sum->value * sum->value - sum->variance, sum->value);
}

typedef struct Eight {
    float albedo[8], warmth_k[8], radar[8], slope_x[8], slope_y[8];
} Eight;

/* What a photograph of these pixels does not contain of an octave's deviation; 1 without a photograph (cell 0). The
 * mean over a square of side a leaves s^2 / (s^2 + a^2 / 6) of the variance of a covariance as wide as a Gaussian of
 * deviation s; the rest is finer than the pixels. */
static inline F32x8 beyond_photo(int n, F32x8 cell_m)
{
    const double width_m = detail_octave_width * detail_octave_m[n];
    const F32x8  lost = cell_m * cell_m * f32x8_set(1.0 / 6), rest = lost / (lost + f32x8_set(width_m * width_m));
    return f32x8_select(f32x8_greater(cell_m, f32x8_set(0)), f32x8_sqrt(rest), f32x8_set(1));
}

/* wanted: bits of DetailField; photo_m: side of the photograph's pixels at each place, 0: none there; NULL: nowhere. */
static void details(Eight *out, const DetailTable *t, uint64_t seed, const Nodes *nodes, unsigned wanted,
                    const double x_m[8], const double y_m[8], const float photo_m[8])
{
    FieldSum sum[detail_fields];
    F32x8    slope_x = f32x8_set(0), slope_y = f32x8_set(0);
    unsigned used = 0;
    uint8_t  octaves[detail_fields];
    used_octaves(octaves, t, nodes);
    for (int f = 0; f < detail_fields; f++) {
        sum[f].value = sum[f].variance = f32x8_set(0);
        sum[f].used = wanted >> f & 1 ? octaves[f] : 0;
        if (sum[f].used) find_weights(sum[f].weight, t, nodes, (DetailField)f, sum[f].used);
        used |= sum[f].used;
    }
    const F32x8 warmth_first = of_class(t->follows, nodes, DETAIL_WARMTH),
                warmth_second = of_class(t->apart, nodes, DETAIL_WARMTH);
    const F32x8 radar_first = of_class(t->follows, nodes, DETAIL_RADAR),
                radar_second = of_class(t->apart, nodes, DETAIL_RADAR);
    for (unsigned left = used; left; left &= left - 1) {
        const int    n = __builtin_ctz(left);
        const bool   warmth = sum[DETAIL_WARMTH].used >> n & 1, radar = sum[DETAIL_RADAR].used >> n & 1;
        const bool   height = sum[DETAIL_HEIGHT].used >> n & 1;
        const Octave octave = octave_eight(seed, n, x_m, y_m, warmth || radar, height);
        if (sum[DETAIL_ALBEDO].used >> n & 1) {
            F32x8 weight = sum[DETAIL_ALBEDO].weight[n];
            if (photo_m) weight = weight * beyond_photo(n, f32x8_load(photo_m));
            add_octave(&sum[DETAIL_ALBEDO], octave.first, weight);
        }
        if (warmth)
            add_octave(&sum[DETAIL_WARMTH], f32x8_fma(warmth_first, octave.first, warmth_second * octave.second),
                       sum[DETAIL_WARMTH].weight[n]);
        if (radar)
            add_octave(&sum[DETAIL_RADAR], f32x8_fma(radar_first, octave.first, radar_second * octave.second),
                       sum[DETAIL_RADAR].weight[n]);
        if (height) {
            const F32x8 weight = sum[DETAIL_HEIGHT].weight[n];
            add_octave(&sum[DETAIL_HEIGHT], octave.first, weight);
            slope_x = f32x8_fma(weight, octave.slope_x, slope_x);
            slope_y = f32x8_fma(weight, octave.slope_y, slope_y);
        }
    }
    F32x8 value[detail_fields];
    for (int f = 0; f < detail_fields; f++) value[f] = skewed(&sum[f], of_class(t->bend, nodes, (DetailField)f));
    f32x8_store(out->albedo, f32x8_clamp(f32x8_set(1) + value[DETAIL_ALBEDO], 0.05, 8));
    f32x8_store(out->warmth_k, value[DETAIL_WARMTH]);
    f32x8_store(out->radar, f32x8_clamp(f32x8_set(1) + value[DETAIL_RADAR], 0.02, 50));
    /* d (g + k g^2) = (1 + 2 k g) dg */
    const F32x8 twice = f32x8_set(2) * of_class(t->bend, nodes, DETAIL_HEIGHT);
    const F32x8 steeper = f32x8_fma(twice, sum[DETAIL_HEIGHT].value, f32x8_set(1));
    f32x8_store(out->slope_x, slope_x * steeper);
    f32x8_store(out->slope_y, slope_y * steeper);
}

/* ---- lists of places ---------------------------------------------------------------------------- */

static void fill_even(const GroundDetail *out, int first, int some)
{
    for (int k = first; k < first + some; k++) {
        if (out->albedo) out->albedo[k] = 1;
        if (out->warmth_k) out->warmth_k[k] = 0;
        if (out->radar) out->radar[k] = 1;
        if (out->slope_x) out->slope_x[k] = out->slope_y[k] = 0;
    }
}

static void store_eight(const GroundDetail *out, int first, int some, const Eight *from)
{
    const size_t bytes = (size_t)some * sizeof(float);
    if (out->albedo) memcpy(out->albedo + first, from->albedo, bytes);
    if (out->warmth_k) memcpy(out->warmth_k + first, from->warmth_k, bytes);
    if (out->radar) memcpy(out->radar + first, from->radar, bytes);
    if (out->slope_x) memcpy(out->slope_x + first, from->slope_x, bytes);
    if (out->slope_y) memcpy(out->slope_y + first, from->slope_y, bytes);
}

void detail_at(const GroundDetail *out, const DetailTable *table, const Landscape *landscape, int count,
               const uint8_t *surface, const double *x_m, const double *y_m, const GroundFootprint *footprint)
{
    uint64_t seed;
    (void)landscape_seed(&seed, landscape);
    seed += 20;
    const bool     photo = out->albedo && landscape_has_photo(landscape);
    const unsigned wanted =
        (unsigned)(out->albedo != NULL) << DETAIL_ALBEDO | (unsigned)(out->warmth_k != NULL) << DETAIL_WARMTH |
        (unsigned)(out->radar != NULL) << DETAIL_RADAR | (unsigned)(out->slope_x != NULL) << DETAIL_HEIGHT;
    for (int first = 0; first < count; first += 8) {
        double x[8] = {0}, y[8] = {0};
        float  photo_m[8];
        uint8_t class[8] = {0};
        Nodes     nodes;
        Eight     eight;
        unsigned  known = 0;
        const int some = count - first < 8 ? count - first : 8;
        for (int k = 0; k < some && table; k++) {
            const bool place = isfinite(x_m[first + k]) && isfinite(y_m[first + k]);
            const bool there = place && surface[first + k] > SURFACE_NONE && surface[first + k] < SURFACE_COUNT;
            if (place) x[k] = x_m[first + k], y[k] = y_m[first + k];
            if (there) class[k] = surface[first + k];
            known |= (unsigned)there << k;
        }
        if (!known) {
            fill_even(out, first, some);
            continue;
        }
        find_nodes(&nodes, some, class, footprint->across_m + first, footprint->along_m + first);
        if (photo) landscape_photo_cells(photo_m, landscape, x, y, known);
        details(&eight, table, seed, &nodes, wanted, x, y, photo ? photo_m : NULL);
        store_eight(out, first, some, &eight);
    }
    if (table) detail_ways(out, landscape, count, surface, x_m, y_m, footprint->along_m);
}
