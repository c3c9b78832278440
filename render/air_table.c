/* render/air_table.c: the paths of a frame, collapsed from the tables of an atmosphere, and asked for by thousands.
 *
 * The eye's height, the sun and the visibility are a frame's own, so of a path only its far end's height, its length
 * and its azimuth from the sun are left. Extinction and mean source vary slowly in the first two (render/air_private.h)
 * and are linear between nodes; tests/render/test_air.c holds the sum of it against atmosphere_path(). */
#include "render/air_private.h"

#include <immintrin.h>

/* Temperatures of emitters for which transmittance is kept; between them it is linear in temperature, outside the
 * nearest counts. */
static const double emitter_temp_k[air_temps] = {250, 300, 400, 600, 1000};

static double node_height_m(int i) { return air_top_m * i * i / (air_heights * air_heights); }

static double node_range_m(int i) { return air_near_m * pow(air_far_m / air_near_m, (double)i / air_ranges); }

/* ---- once a frame -------------------------------------------------------------------------- */

/* Scattered light is asked for at every second slope and share of the way, since each answer is an integral along the
 * path, and drawn between them by cubics. */
enum {
    slope_stride = 2,
    share_stride = 2,
    coarse_slopes = air_slopes / slope_stride,
    coarse_shares = air_shares / share_stride
};
/* The whole way ends at the ground or the tables' top, and after 100 km, where little more light is to come. From less
 * than 200 m up it goes on along the ground, as if from there: the air below is much the same. */
static const double shortest_way_m = 10, longest_way_m = 100e3, least_fall_m = 200;

typedef struct TableJob {
    Air *air;
    TableInput in;
    float (*coarse)[air_path_azimuths + 1][coarse_slopes + 1][coarse_shares + 1]; /* [AIR_BAND_COUNT] */
} TableJob;

static double extinction(double transmittance, double range_m)
{
    return -log(clamp(transmittance, 1e-30, 1)) / range_m;
}

/* Radiance over what the path takes away; a clear path has no source. */
static double mean_source(double radiance_w_m2_sr, double transmittance)
{
    return transmittance < 1 - 1e-12 ? radiance_w_m2_sr / (1 - transmittance) : 0;
}

static AirPath path_to(const TableJob *job, int height, int range)
{
    AirPath path = {.observer_m = job->air->eye_height_m,
                    .target_m = node_height_m(height),
                    .sun_zenith_rad = job->in.sun_zenith_rad};
    /* shorter than straight up or down there is no path: the nodes hold that one */
    path.range_m = fmax(node_range_m(range), fabs(path.target_m - path.observer_m) * 1.0001);
    return path;
}

static void fill_node(AirTable *table, const TableJob *job, AirBand band, int height, int range)
{
    const Air *air = job->air;
    const int node = height * (air_ranges + 1) + range;
    AirPath path = path_to(job, height, range);
    PathAir here;
    path.sun_zenith_rad = pi_rad; /* its scattered light is not asked for */
    atmosphere_path(&here, job->in.atmosphere, air->weather.visibility_m, band, &path, air->weather.air_temp_k);
    table->extinction_sun_per_m[node] = (float)extinction(here.sun_transmittance, path.range_m);
    if (!table->thermal) return;
    table->extinction_air_per_m[node] = (float)extinction(here.transmittance, path.range_m);
    table->thermal_w_m2_sr[node] =
        (float)mean_source(here.thermal_w_m2_sr * job->in.thermal_scale[band - AIR_MWIR], here.transmittance);
    for (int t = 0; t < air_temps; t++) {
        atmosphere_path(&here, job->in.atmosphere, air->weather.visibility_m, band, &path, emitter_temp_k[t]);
        table->extinction_temp_per_m[t][node] = (float)extinction(here.transmittance, path.range_m);
    }
}

/* A node too near for its height holds the same path as the next one that is. */
static bool too_near(const Air *air, int height, int range)
{
    return node_range_m(range) < fabs(node_height_m(height) - air->eye_height_m) * 1.0001;
}

static void copy_node(AirTable *table, int to, int from)
{
    table->extinction_sun_per_m[to] = table->extinction_sun_per_m[from];
    table->extinction_air_per_m[to] = table->extinction_air_per_m[from];
    table->thermal_w_m2_sr[to] = table->thermal_w_m2_sr[from];
    for (int t = 0; t < air_temps; t++) table->extinction_temp_per_m[t][to] = table->extinction_temp_per_m[t][from];
}

/* One height of one band. */
static void fill_row(void *user, int worker, int task)
{
    (void)worker;
    const TableJob *job = user;
    const int height = task % (air_heights + 1);
    const AirBand band = (AirBand)(task / (air_heights + 1));
    AirTable *table = job->air->table[band];
    if (!table) return;
    for (int r = 0; r <= air_ranges; r++) {
        if (r > 0 && too_near(job->air, height, r) && too_near(job->air, height, r - 1))
            copy_node(table, height * (air_ranges + 1) + r, height * (air_ranges + 1) + r - 1);
        else
            fill_node(table, job, band, height, r);
    }
}

/* One slope of one band's scattered light. */
static void fill_slope(void *user, int worker, int task)
{
    (void)worker;
    const TableJob *job = user;
    const int i = task % (coarse_slopes + 1);
    const AirBand band = (AirBand)(task / (coarse_slopes + 1));
    const AirTable *table = job->air->table[band];
    if (!table || !table->scattered) return;
    const double eye_m = job->air->eye_height_m,
                 s = (double)(table->slope_low + (float)(i * slope_stride) / table->slope_steps);
    const double slope = clamp(s * fabs(s), -1, 1);
    /* to the ground, or out of the tables' air; never quite nothing */
    const double whole_m = slope < 0 ? fmax(eye_m, least_fall_m) : air_top_m - eye_m;
    const double end_m = clamp(whole_m / fmax(fabs(slope), 1e-9), shortest_way_m, longest_way_m);
    for (int a = 0; a <= table->azimuth_planes; a++)
        for (int c = 0; c <= coarse_shares; c++) {
            float *at = &job->coarse[band][a][i][c];
            const double share = fmax((double)c / coarse_shares, 0.01); /* not quite nothing */
            AirPath path = {.observer_m = eye_m,
                            .range_m = share * share * end_m,
                            .sun_zenith_rad = job->in.sun_zenith_rad,
                            .rel_azimuth_rad = (double)(table->azimuth_low_rad + a / table->azimuth_planes_per_rad)};
            path.target_m = clamp(eye_m + slope * path.range_m, 0, air_top_m);
            PathAir here;
            atmosphere_path(&here, job->in.atmosphere, job->air->weather.visibility_m, band, &path,
                            job->air->weather.air_temp_k);
            *at = (float)log(
                fmax(mean_source(here.scattered_w_m2_sr * job->in.scattered_scale, here.sun_transmittance), 1e-30));
        }
}

/* The four points about fine step i, at the ends straight on, and the share. */
static double four_about(int at[4], int i, int stride, int steps)
{
    const int low = i / stride < steps ? i / stride : steps - 1;
    for (int k = 0; k < 4; k++) at[k] = low - 1 + k < 0 ? 0 : low - 1 + k > steps ? steps : low - 1 + k;
    return (double)(i - low * stride) / stride;
}

/* One azimuth of one band, from coarse to fine. */
static void refine_plane(void *user, int worker, int task)
{
    (void)worker;
    const TableJob *job = user;
    const int a = task % (air_path_azimuths + 1);
    AirTable *table = job->air->table[task / (air_path_azimuths + 1)];
    if (!table || !table->scattered || a > table->azimuth_planes) return;
    const float(*coarse)[coarse_shares + 1] =
        (const float(*)[coarse_shares + 1]) job->coarse[task / (air_path_azimuths + 1)][a];
    for (int h = 0; h <= air_slopes; h++) {
        int rows[4];
        const double th = four_about(rows, h, slope_stride, coarse_slopes);
        for (int r = 0; r <= air_shares; r++) {
            int columns[4];
            const double tr = four_about(columns, r, share_stride, coarse_shares);
            double along[4];
            for (int k = 0; k < 4; k++) {
                const float *row = coarse[rows[k]];
                along[k] = cubic_between(row[columns[0]], row[columns[1]], row[columns[2]], row[columns[3]], tr);
            }
            const double value = cubic_between(along[0], along[1], along[2], along[3], th);
            table->ln_scattered[a][h * (air_shares + 1) + r] = (float)value;
        }
    }
}

static void run(Pool *pool, int count, PoolTask *task, void *user)
{
    if (pool)
        pool_run(pool, count, task, user);
    else
        for (int i = 0; i < count; i++) task(user, 0, i);
}

Status air_tables_fill(Air *air, const TableInput *input, Pool *pool, Arena *arena)
{
    TableJob job = {.air = air, .in = *input};
    job.coarse = arena_alloc(arena, AIR_BAND_COUNT, sizeof *job.coarse);
    if (!job.coarse) return STATUS_NO_MEMORY;
    const double slope_low = copysign(sqrt(fabs(input->slope_low)), input->slope_low);
    const double slope_high = fmax(copysign(sqrt(fabs(input->slope_high)), input->slope_high), slope_low + 1e-3);
    /* a step of 15 degrees at most, of a third of the view at least */
    const double span_rad = fmax(input->azimuth_high_rad - input->azimuth_low_rad, 1e-3);
    const int planes = (int)clamp(ceil(span_rad * air_path_azimuths / pi_rad - 1e-9), 3, air_path_azimuths);
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        if (!(input->bands >> b & 1)) continue;
        AirTable *table = air->table[b] = arena_alloc(arena, 1, sizeof *table);
        if (!table) return STATUS_NO_MEMORY;
        table->thermal = b >= AIR_MWIR;
        /* sunlight is below a thousandth of what 8-12 um emits */
        table->scattered = b != AIR_LWIR && input->scattered_scale > 0;
        table->slope_low = (float)slope_low;
        table->slope_steps = (float)(air_slopes / (slope_high - slope_low));
        table->azimuth_planes = planes;
        table->azimuth_low_rad = (float)input->azimuth_low_rad;
        table->azimuth_planes_per_rad = (float)(planes / span_rad);
    }
    run(pool, AIR_BAND_COUNT * (air_heights + 1), fill_row, &job);
    run(pool, AIR_BAND_COUNT * (coarse_slopes + 1), fill_slope, &job);
    run(pool, AIR_BAND_COUNT * (air_path_azimuths + 1), refine_plane, &job);
    return STATUS_OK;
}

/* ---- thousands of times a frame: eight paths at once ----------------------------------------- */

typedef __m256 Eight;

static inline Eight all(double x) { return _mm256_set1_ps((float)x); }
static inline Eight mul(Eight a, Eight b) { return _mm256_mul_ps(a, b); }
static inline Eight add(Eight a, Eight b) { return _mm256_add_ps(a, b); }
static inline Eight sub(Eight a, Eight b) { return _mm256_sub_ps(a, b); }
static inline Eight between(Eight a, Eight b, Eight t) { return add(a, mul(t, sub(b, a))); }
/* NaN, as the unused end of a block may hold, becomes low. */
static inline Eight within(Eight x, Eight low, Eight high) { return _mm256_min_ps(_mm256_max_ps(x, low), high); }

static inline Eight narrow(const double *p)
{
    return _mm256_set_m128(_mm256_cvtpd_ps(_mm256_loadu_pd(p + 4)), _mm256_cvtpd_ps(_mm256_loadu_pd(p)));
}

/* e^x for x < 88, relative error below 2e-7 (Cephes expf's polynomial); below -87 as there. */
static inline Eight exp_eight(Eight x)
{
    x = _mm256_max_ps(x, all(-87));
    const Eight n = _mm256_round_ps(mul(x, all(1.44269504088896)), _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
    const Eight r = add(sub(x, mul(n, all(0.693359375))), mul(n, all(2.12194440e-4)));
    Eight p = add(mul(all(1.9875691500e-4), r), all(1.3981999507e-3));
    p = add(mul(p, r), all(8.3334519073e-3));
    p = add(mul(p, r), all(4.1665795894e-2));
    p = add(mul(p, r), all(1.6666665459e-1));
    p = add(mul(p, r), all(5.0000001201e-1));
    const __m256i power = _mm256_slli_epi32(_mm256_add_epi32(_mm256_cvtps_epi32(n), _mm256_set1_epi32(127)), 23);
    return mul(add(add(mul(p, mul(r, r)), r), all(1)), _mm256_castsi256_ps(power));
}

/* log2 of positive normal numbers, absolute error below 2e-5: exponent, and 2 atanh((m - 1) / (m + 1)) / ln 2 with the
 * mantissa m in sqrt(1/2) .. sqrt(2). */
static inline Eight log2_eight(Eight x)
{
    const __m256i root = _mm256_set1_epi32(0x3f3504f3), shifted = _mm256_sub_epi32(_mm256_castps_si256(x), root);
    const Eight exponent = _mm256_cvtepi32_ps(_mm256_srai_epi32(shifted, 23));
    const Eight m =
        _mm256_castsi256_ps(_mm256_add_epi32(_mm256_and_si256(shifted, _mm256_set1_epi32(0x007fffff)), root));
    const Eight s = _mm256_div_ps(sub(m, all(1)), add(m, all(1))), s2 = mul(s, s);
    return add(exponent, mul(s, add(all(2.8853901), mul(s2, add(all(0.96179670), mul(s2, all(0.5770780)))))));
}

/* Abramowitz & Stegun 4.4.45, within 7e-5 rad. */
static inline Eight acos_eight(Eight c)
{
    const Eight sign = _mm256_and_ps(c, all(-0.0)), x = _mm256_min_ps(_mm256_andnot_ps(all(-0.0), c), all(1));
    const Eight p =
        add(all(1.5707288), mul(x, add(all(-0.2121144), mul(x, sub(all(0.0742610), mul(x, all(0.0187293)))))));
    const Eight a = mul(_mm256_sqrt_ps(sub(all(1), x)), p);
    return _mm256_blendv_ps(a, sub(all(3.14159265358979), a), sign);
}

/* Where eight paths end, in the tables' own steps. */
typedef struct Places {
    __m256i node, slope_node;          /* lower height, nearer range; lower slope, nearer share of the way */
    Eight height, range, slope, share; /* shares of the others */
    Eight range_m;
} Places;

/* Distance to the round ground at height 0 along a ray that meets nothing nearer; INFINITY: it passes above. With u the
 * rate of climb, height = eye + u r + (1 - d_up^2) r^2 / (2 Earth's radius). */
static float ground_beyond(double eye_m, double climb, double bend_per_m)
{
    if (!(climb < 0)) return INFINITY;
    const double disc = climb * climb - 4 * bend_per_m * eye_m;
    return disc >= 0 ? (float)(2 * eye_m / (-climb + sqrt(disc))) : INFINITY;
}

static void find_ranges(float *range_m, const Air *air, const Hits *hits, const Rays *rays)
{
    for (int i = 0; i < hits->count; i++) {
        range_m[i] = (float)hits->range_m[i];
        if (range_m[i] < INFINITY) continue;
        const double climb =
            rays->d_enu[2][i] +
            (rays->o_enu[0][i] * rays->d_enu[0][i] + rays->o_enu[1][i] * rays->d_enu[1][i]) / earth_radius_m;
        range_m[i] =
            ground_beyond(air->eye_height_m, climb, (1 - rays->d_enu[2][i] * rays->d_enu[2][i]) / (2 * earth_radius_m));
    }
}

static inline void find_places(Places *p, const Air *air, const AirTable *table, const float *range_m, const Rays *rays,
                               int i)
{
    const Eight dx = narrow(rays->d_enu[0] + i), dy = narrow(rays->d_enu[1] + i), dz = narrow(rays->d_enu[2] + i);
    const Eight ox = narrow(rays->o_enu[0] + i), oy = narrow(rays->o_enu[1] + i);
    p->range_m = _mm256_loadu_ps(range_m + i);
    const Eight r = within(p->range_m, all(air_near_m), all(air_far_m));
    /* the tangent plane leaves the Earth: by the eye's own distance from the origin, and along the path. Past the
     * tables' nearest range only height counts, so the path's own range is taken for it */
    const Eight at = _mm256_min_ps(p->range_m, r), per_earth = all(1 / earth_radius_m);
    const Eight climb = add(dz, mul(add(mul(ox, dx), mul(oy, dy)), per_earth));
    const Eight bend = mul(add(mul(dx, dx), mul(dy, dy)), all(0.5 / earth_radius_m));
    const Eight h = _mm256_max_ps(add(all(air->eye_height_m), mul(at, add(climb, mul(at, bend)))), all(0));

    const Eight hs =
        within(mul(_mm256_sqrt_ps(h), all(air_heights / sqrt(air_top_m))), all(0), all(air_heights - 1e-3));
    const Eight steps = all(air_ranges * 0.69314718055994531 / log(air_far_m / air_near_m));
    const Eight rs = within(mul(sub(log2_eight(r), all(log2(air_near_m))), steps), all(0), all(air_ranges - 1e-3));
    const __m256i hi = _mm256_cvttps_epi32(hs), ri = _mm256_cvttps_epi32(rs);
    /* between nodes linear in height, not in its root */
    const Eight h0 = _mm256_cvtepi32_ps(hi);
    p->height = _mm256_div_ps(sub(mul(hs, hs), mul(h0, h0)), add(add(h0, h0), all(1)));
    p->range = sub(rs, _mm256_cvtepi32_ps(ri));
    p->node = _mm256_add_epi32(_mm256_mullo_epi32(hi, _mm256_set1_epi32(air_ranges + 1)), ri);

    const Eight rise_m = sub(h, all(air->eye_height_m)), rise = _mm256_div_ps(rise_m, _mm256_max_ps(at, all(1e-3)));
    const Eight sign = _mm256_and_ps(rise, all(-0.0)), root = _mm256_sqrt_ps(_mm256_andnot_ps(all(-0.0), rise));
    const Eight ss =
        within(mul(sub(_mm256_or_ps(root, sign), all((double)table->slope_low)), all((double)table->slope_steps)),
               all(0), all(air_slopes - 1e-3));
    const __m256i si = _mm256_cvttps_epi32(ss);
    p->slope = sub(ss, _mm256_cvtepi32_ps(si));
    const Eight whole_m =
        _mm256_blendv_ps(all(air_top_m - air->eye_height_m), all(fmax(air->eye_height_m, least_fall_m)), rise);
    const Eight steep = _mm256_max_ps(_mm256_andnot_ps(all(-0.0), rise), all(1e-9));
    const Eight end_m = within(_mm256_div_ps(whole_m, steep), all(shortest_way_m), all(longest_way_m));
    const Eight ws =
        within(mul(_mm256_sqrt_ps(_mm256_div_ps(at, end_m)), all(air_shares)), all(0), all(air_shares - 1e-3));
    const __m256i wi = _mm256_cvttps_epi32(ws);
    p->share = sub(ws, _mm256_cvtepi32_ps(wi));
    p->slope_node = _mm256_add_epi32(_mm256_mullo_epi32(si, _mm256_set1_epi32(air_shares + 1)), wi);
}

/* Between four neighbours of a plane whose rows are this long. */
static inline Eight look_up_in(const float *plane, int row, __m256i node, Eight across, Eight along)
{
    const Eight a = _mm256_i32gather_ps(plane, node, 4), b = _mm256_i32gather_ps(plane + 1, node, 4);
    const Eight c = _mm256_i32gather_ps(plane + row, node, 4), d = _mm256_i32gather_ps(plane + row + 1, node, 4);
    return between(between(a, b, along), between(c, d, along), across);
}

static inline Eight look_up(const float *plane, __m256i node, const Places *p)
{
    return look_up_in(plane, air_ranges + 1, node, p->height, p->range);
}

static inline Eight transmit(const float *plane, const Places *p)
{
    return exp_eight(sub(all(0), mul(p->range_m, look_up(plane, p->node, p))));
}

/* Emitters by their own temperature; NaN counts as the coldest. */
static inline Eight transmit_emitted(const AirTable *table, const Places *p, Eight temp_k)
{
    const Eight t = within(temp_k, all(emitter_temp_k[0]), all(emitter_temp_k[air_temps - 1]));
    Eight from = all(emitter_temp_k[0]), per_k = all(1 / (emitter_temp_k[1] - emitter_temp_k[0]));
    __m256i plane = _mm256_setzero_si256();
    for (int k = 1; k < air_temps - 1; k++) {
        const Eight above = _mm256_cmp_ps(t, all(emitter_temp_k[k]), _CMP_GE_OQ);
        from = _mm256_blendv_ps(from, all(emitter_temp_k[k]), above);
        per_k = _mm256_blendv_ps(per_k, all(1 / (emitter_temp_k[k + 1] - emitter_temp_k[k])), above);
        plane = _mm256_blendv_epi8(plane, _mm256_set1_epi32(k * air_nodes), _mm256_castps_si256(above));
    }
    const __m256i node = _mm256_add_epi32(p->node, plane);
    const float *planes = table->extinction_temp_per_m[0];
    const Eight q = between(look_up(planes, node, p), look_up(planes + air_nodes, node, p), mul(sub(t, from), per_k));
    return exp_eight(sub(all(0), mul(p->range_m, q)));
}

/* Sunlight scattered into the paths, over what the paths take away. */
static inline Eight scattered_source(const AirTable *table, const Places *p, const Rays *rays, int i, Eight sun_east,
                                     Eight sun_north)
{
    const Eight dx = narrow(rays->d_enu[0] + i), dy = narrow(rays->d_enu[1] + i);
    const Eight level = _mm256_sqrt_ps(_mm256_max_ps(add(mul(dx, dx), mul(dy, dy)), all(1e-12)));
    const Eight azimuth = acos_eight(_mm256_div_ps(add(mul(dx, sun_east), mul(dy, sun_north)), level));
    const Eight s =
        within(mul(sub(azimuth, all((double)table->azimuth_low_rad)), all((double)table->azimuth_planes_per_rad)),
               all(0), all(table->azimuth_planes - 1e-3));
    const __m256i plane = _mm256_cvttps_epi32(s);
    const __m256i node = _mm256_add_epi32(p->slope_node, _mm256_mullo_epi32(plane, _mm256_set1_epi32(air_slope_nodes)));
    const float *low = table->ln_scattered[0], *high = low + air_slope_nodes;
    return exp_eight(between(look_up_in(low, air_shares + 1, node, p->slope, p->share),
                             look_up_in(high, air_shares + 1, node, p->slope, p->share),
                             sub(s, _mm256_cvtepi32_ps(plane))));
}

static void veils_even(Veils *out, const Air *air, AirBand band, const Hits *hits)
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

void air_veils(Veils *out, const Air *air, AirBand band, const Hits *hits, const Rays *rays, const float *temp_k)
{
    const AirTable *table = air->table[band];
    if (!table) {
        veils_even(out, air, band, hits);
        return;
    }
    const double level = hypot(air->sun_d_enu[0], air->sun_d_enu[1]);
    const Eight sun_east = all(level > 1e-10 ? air->sun_d_enu[0] / level : 1);
    const Eight sun_north = all(level > 1e-10 ? air->sun_d_enu[1] / level : 0);
    find_ranges(out->range_m, air, hits, rays);

    for (int i = 0; i < hits->count; i += 8) {
        Places p;
        find_places(&p, air, table, out->range_m, rays, i);
        Eight added = all(0), sun = all(0);
        if (table->scattered || !table->thermal) sun = transmit(table->extinction_sun_per_m, &p);
        if (table->scattered) added = mul(sub(all(1), sun), scattered_source(table, &p, rays, i, sun_east, sun_north));
        Eight own = sun, emitted = sun;
        if (table->thermal) {
            own = transmit(table->extinction_air_per_m, &p);
            added = add(added, mul(sub(all(1), own), look_up(table->thermal_w_m2_sr, p.node, &p)));
            if (temp_k) emitted = transmit_emitted(table, &p, _mm256_loadu_ps(temp_k + i));
            if (!table->scattered) sun = own;
        }
        _mm256_storeu_ps(out->sun_transmittance + i, sun);
        _mm256_storeu_ps(out->air_transmittance + i, own);
        _mm256_storeu_ps(out->transmittance + i, emitted);
        _mm256_storeu_ps(out->added_w_m2_sr + i, added);
    }
    for (int i = 0; i < hits->count; i++) {
        if (out->range_m[i] < INFINITY) continue;
        const double d_enu[3] = {rays->d_enu[0][i], rays->d_enu[1][i], rays->d_enu[2][i]};
        out->transmittance[i] = out->sun_transmittance[i] = out->air_transmittance[i] = 0;
        out->added_w_m2_sr[i] = (float)air_sky_table(&air->sky_eye[band], air->sun_d_enu, d_enu);
    }
}
