/* render/air_table.c: the paths of a frame, collapsed from the tables of an atmosphere, and asked for by thousands.
 *
 * The eye's height, the sun and the visibility are a frame's own, so of a path only its far end's height, its length and
 * its azimuth from the sun are left. Extinction and mean source vary slowly in the first two (render/air_private.h) and
 * are linear between nodes; tests/render/test_air.c holds the sum of it against atmosphere_path(). */
#include "render/air_private.h"

/* Temperatures of emitters for which transmittance is kept; between them it is linear in temperature, outside the nearest
 * counts. */
static const double emitter_temp_k[air_temps] = {250, 300, 400, 600, 1000};

static double node_height_m(int i) { return air_top_m * i * i / (air_heights * air_heights); }

static double node_range_m(int i) { return air_near_m * pow(air_far_m / air_near_m, (double)i / air_ranges); }

/* ---- once a frame -------------------------------------------------------------------------- */

/* Scattered light is asked for at every second height and every fourth range, since each answer is an integral along
 * the path, and drawn between them by cubics. */
enum { height_stride = 2, range_stride = 4, coarse_heights = air_heights / height_stride,
       coarse_ranges = air_ranges / range_stride };

typedef struct TableJob {
    Air        *air;
    TableInput  in;
    float     (*coarse)[air_path_azimuths + 1][coarse_heights + 1][coarse_ranges + 1]; /* [AIR_BAND_COUNT] */
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
    AirPath path = {.observer_m = job->air->eye_height_m, .target_m = node_height_m(height),
                    .sun_zenith_rad = job->in.sun_zenith_rad};
    /* shorter than straight up or down there is no path: the nodes hold that one */
    path.range_m = fmax(node_range_m(range), fabs(path.target_m - path.observer_m) * 1.0001);
    return path;
}

static void fill_node(AirTable *table, const TableJob *job, AirBand band, int height, int range)
{
    const Air *air = job->air;
    const int  node = height * (air_ranges + 1) + range;
    AirPath    path = path_to(job, height, range);
    PathAir    here;
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
    for (int t = 0; t < air_temps; t++)
        table->extinction_temp_per_m[t][to] = table->extinction_temp_per_m[t][from];
}

/* One height of one band. */
static void fill_row(void *user, int worker, int task)
{
    (void)worker;
    const TableJob *job = user;
    const int       height = task % (air_heights + 1);
    const AirBand   band = (AirBand)(task / (air_heights + 1));
    AirTable       *table = job->air->table[band];
    if (!table) return;
    for (int r = 0; r <= air_ranges; r++) {
        if (r > 0 && too_near(job->air, height, r) && too_near(job->air, height, r - 1))
            copy_node(table, height * (air_ranges + 1) + r, height * (air_ranges + 1) + r - 1);
        else
            fill_node(table, job, band, height, r);
    }
    if (!table->scattered || height % height_stride) return;
    float(*coarse)[coarse_heights + 1][coarse_ranges + 1] = job->coarse[band];
    for (int a = table->azimuth_low; a <= table->azimuth_high; a++)
        for (int c = 0; c <= coarse_ranges; c++) {
            float *at = &coarse[a][height / height_stride][c];
            if (c > 0 && too_near(job->air, height, c * range_stride) &&
                too_near(job->air, height, (c - 1) * range_stride)) {
                *at = at[-1];
                continue;
            }
            AirPath path = path_to(job, height, c * range_stride);
            path.rel_azimuth_rad = a * pi_rad / air_path_azimuths;
            PathAir here;
            atmosphere_path(&here, job->in.atmosphere, job->air->weather.visibility_m, band, &path,
                            job->air->weather.air_temp_k);
            *at = (float)mean_source(here.scattered_w_m2_sr * job->in.scattered_scale, here.sun_transmittance);
        }
}

/* The four points about fine step i, at the ends straight on, and the share. */
static double four_about(int at[4], int i, int stride, int steps)
{
    const int low = i / stride < steps ? i / stride : steps - 1;
    for (int k = 0; k < 4; k++) at[k] = low - 1 + k < 0 ? 0 : low - 1 + k > steps ? steps : low - 1 + k;
    return (double)(i - low * stride) / stride;
}

/* One azimuth of one band, from coarse to fine. Heights are equal steps of their root here. */
static void refine_plane(void *user, int worker, int task)
{
    (void)worker;
    const TableJob *job = user;
    const int       a = task % (air_path_azimuths + 1);
    AirTable       *table = job->air->table[task / (air_path_azimuths + 1)];
    if (!table || !table->scattered || a < table->azimuth_low || a > table->azimuth_high) return;
    const float(*coarse)[coarse_ranges + 1] = (const float(*)[coarse_ranges + 1])job->coarse[task / (air_path_azimuths + 1)][a];
    for (int h = 0; h <= air_heights; h++) {
        int rows[4];
        const double th = four_about(rows, h, height_stride, coarse_heights);
        for (int r = 0; r <= air_ranges; r++) {
            int columns[4];
            const double tr = four_about(columns, r, range_stride, coarse_ranges);
            double along[4];
            for (int k = 0; k < 4; k++) {
                const float *row = coarse[rows[k]];
                along[k] = cubic_between(row[columns[0]], row[columns[1]], row[columns[2]], row[columns[3]], tr);
            }
            const double value = cubic_between(along[0], along[1], along[2], along[3], th);
            table->scattered_w_m2_sr[a][h * (air_ranges + 1) + r] = (float)fmax(value, 0);
        }
    }
}

static void run(Pool *pool, int count, PoolTask *task, void *user)
{
    if (pool) pool_run(pool, count, task, user);
    else
        for (int i = 0; i < count; i++) task(user, 0, i);
}

Status air_tables_fill(Air *air, const TableInput *input, Pool *pool, Arena *arena)
{
    TableJob job = {.air = air, .in = *input};
    job.coarse = arena_alloc(arena, AIR_BAND_COUNT, sizeof *job.coarse);
    if (!job.coarse) return STATUS_NO_MEMORY;
    const double per_rad = air_path_azimuths / pi_rad;
    const int    low = (int)clamp(floor(input->azimuth_low_rad * per_rad), 0, air_path_azimuths - 1);
    const int    high = (int)clamp(ceil(input->azimuth_high_rad * per_rad), low + 1, air_path_azimuths);
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        if (!(input->bands >> b & 1)) continue;
        AirTable *table = air->table[b] = arena_alloc(arena, 1, sizeof *table);
        if (!table) return STATUS_NO_MEMORY;
        table->thermal = b >= AIR_MWIR;
        /* sunlight is below a thousandth of what 8-12 um emits */
        table->scattered    = b != AIR_LWIR && input->scattered_scale > 0;
        table->azimuth_low  = low;
        table->azimuth_high = high;
    }
    run(pool, AIR_BAND_COUNT * (air_heights + 1), fill_row, &job);
    run(pool, AIR_BAND_COUNT * (air_path_azimuths + 1), refine_plane, &job);
    return STATUS_OK;
}

/* ---- thousands of times a frame: loops that vectorise ---------------------------------------- */

/* e^x for x <= 0, relative error below 2e-7 (Cephes expf's polynomial); 0 below -87. */
static inline float exp_quick(float x)
{
    const float floor_x = x > -87.0f ? x : -87.0f;
    const float n = (float)(int)(floor_x * 1.44269504f - 0.5f); /* to the nearest, since x <= 0 */
    const float r = floor_x - n * 0.693359375f + n * 2.12194440e-4f;
    const float p = ((((1.9875691500e-4f * r + 1.3981999507e-3f) * r + 8.3334519073e-3f) * r + 4.1665795894e-2f) * r +
                     1.6666665459e-1f) * r + 5.0000001201e-1f;
    union { int32_t i; float f; } two_n = {.i = ((int32_t)n + 127) << 23};
    return (p * r * r + r + 1) * two_n.f;
}

/* log2 of a positive normal float, absolute error below 2e-5: exponent, and 2 atanh((m - 1) / (m + 1)) / ln 2. */
static inline float log2_quick(float x)
{
    union { float f; int32_t i; } bits = {.f = x};
    const int32_t shifted = bits.i - 0x3f3504f3; /* mantissa into sqrt(1/2) .. sqrt(2) */
    const float   exponent = (float)(shifted >> 23);
    union { int32_t i; float f; } mantissa = {.i = (shifted & 0x007fffff) + 0x3f3504f3};
    const float s = (mantissa.f - 1) / (mantissa.f + 1), s2 = s * s;
    return exponent + s * (2.8853901f + s2 * (0.96179670f + s2 * 0.5770780f));
}

static inline float acos_quick(float c)
{
    const float x = fminf(fabsf(c), 1);
    const float a = sqrtf(1 - x) * (1.5707288f + x * (-0.2121144f + x * (0.0742610f - x * 0.0187293f)));
    return c < 0 ? 3.14159265f - a : a;
}

/* Where every path of a block ends, in the tables' own steps. */
typedef struct Places {
    int32_t node[hits_capacity];                               /* lower height, nearer range */
    float   height[hits_capacity], range[hits_capacity];       /* shares of the other two */
    int32_t turn[hits_capacity];                               /* first node of the lower azimuth's plane */
    float   azimuth[hits_capacity];                            /* share of the upper one */
} Places;

/* Distance to the round ground at height 0 along a ray that meets nothing nearer; INFINITY: it passes above. With u the
 * rate of climb, height = eye + u r + (1 - d_up^2) r^2 / (2 Earth's radius). */
static float ground_beyond(double eye_m, double climb, double bend_per_m)
{
    if (!(climb < 0)) return INFINITY;
    const double disc = climb * climb - 4 * bend_per_m * eye_m;
    return disc >= 0 ? (float)(2 * eye_m / (-climb + sqrt(disc))) : INFINITY;
}

static void find_places(Places *p, float *range_m, const Air *air, const AirTable *table, const Hits *hits,
                        const Rays *rays, int count)
{
    const float azimuth_low = (float)table->azimuth_low, azimuth_high = (float)table->azimuth_high - 1e-3f;
    const float height_steps = (float)(air_heights / sqrt(air_top_m));
    const float range_steps = (float)(air_ranges * log(2) / log(air_far_m / air_near_m));
    const float range_origin = (float)(log2(air_near_m) * range_steps);
    const float near_m = (float)air_near_m, far_m = (float)air_far_m, eye_m = (float)air->eye_height_m;
    const double level = hypot(air->sun_d_enu[0], air->sun_d_enu[1]);
    const float sun_east = level > 1e-10 ? (float)(air->sun_d_enu[0] / level) : 1;
    const float sun_north = level > 1e-10 ? (float)(air->sun_d_enu[1] / level) : 0;

    for (int i = 0; i < count; i++) {
        range_m[i] = (float)hits->range_m[i];
        if (range_m[i] < INFINITY) continue;
        const double climb = rays->d_enu[2][i] + (rays->o_enu[0][i] * rays->d_enu[0][i] +
                                                  rays->o_enu[1][i] * rays->d_enu[1][i]) / earth_radius_m;
        range_m[i] = ground_beyond(air->eye_height_m, climb,
                                   (1 - rays->d_enu[2][i] * rays->d_enu[2][i]) / (2 * earth_radius_m));
    }
    for (int i = 0; i < count; i++) {
        const float dx = (float)rays->d_enu[0][i], dy = (float)rays->d_enu[1][i], flat2 = dx * dx + dy * dy;
        const float r = fminf(fmaxf(range_m[i], near_m), far_m);
        /* the tangent plane leaves the Earth: by the eye's own distance from the origin, and along the path */
        const float climb = (float)(rays->d_enu[2][i] +
                                    (rays->o_enu[0][i] * rays->d_enu[0][i] + rays->o_enu[1][i] * rays->d_enu[1][i]) *
                                        (1 / earth_radius_m));
        const float h = fmaxf(eye_m + r * (climb + r * flat2 * (float)(0.5 / earth_radius_m)), 0);

        const float hs = fminf(sqrtf(h) * height_steps, (float)air_heights - 1e-3f);
        const float rs = fminf(log2_quick(r) * range_steps - range_origin, (float)air_ranges - 1e-3f);
        const int   hi = (int)hs, ri = rs > 0 ? (int)rs : 0;
        /* between nodes linear in height, not in its root */
        const float h0 = (float)hi, of_cell = (hs * hs - h0 * h0) / (2 * h0 + 1);
        p->node[i]   = hi * (air_ranges + 1) + ri;
        p->height[i] = of_cell;
        p->range[i]  = rs - (float)ri;

        const float c = (dx * sun_east + dy * sun_north) / sqrtf(fmaxf(flat2, 1e-12f));
        const float as =
            fminf(fmaxf(acos_quick(c) * (float)(air_path_azimuths / 3.14159265), azimuth_low), azimuth_high);
        p->turn[i]    = (int)as * air_nodes;
        p->azimuth[i] = as - (float)(int)as;
    }
}

static inline float look_up(const float *plane, int node, float height, float range)
{
    const float *q = plane + node;
    const float  low = q[0] + range * (q[1] - q[0]);
    const float  high = q[air_ranges + 1] + range * (q[air_ranges + 2] - q[air_ranges + 1]);
    return low + height * (high - low);
}

static void transmit(float *out, const float *plane, const Places *p, const float *range_m, int count)
{
    for (int i = 0; i < count; i++)
        out[i] = exp_quick(-range_m[i] * look_up(plane, p->node[i], p->height[i], p->range[i]));
}

/* Emitters by their own temperature. */
static void transmit_emitted(float *out, const AirTable *table, const Places *p, const float *range_m,
                             const float *temp_k, int count)
{
    const float *planes = table->extinction_temp_per_m[0];
    for (int i = 0; i < count; i++) {
        float t = temp_k[i] > (float)emitter_temp_k[0] ? temp_k[i] : (float)emitter_temp_k[0]; /* NaN: the first */
        t = fminf(t, (float)emitter_temp_k[air_temps - 1]);
        int   low = 0;
        float from_k = (float)emitter_temp_k[0], to_k = (float)emitter_temp_k[1];
        for (int k = 1; k < air_temps - 1; k++) {
            const bool above = t >= (float)emitter_temp_k[k];
            low    = above ? k : low;
            from_k = above ? (float)emitter_temp_k[k] : from_k;
            to_k   = above ? (float)emitter_temp_k[k + 1] : to_k;
        }
        const int   node = p->node[i] + low * air_nodes;
        const float a = look_up(planes, node, p->height[i], p->range[i]);
        const float b = look_up(planes, node + air_nodes, p->height[i], p->range[i]);
        out[i] = exp_quick(-range_m[i] * (a + (t - from_k) / (to_k - from_k) * (b - a)));
    }
}

static void veils_even(Veils *out, const Air *air, AirBand band, const Hits *hits)
{
    const float radiance = air->sky_eye[band].radiance_w_m2_sr[0][0];
    for (int i = 0; i < hits->count; i++) {
        const float tau = exp_quick(-(float)(air->even_per_m * fmin(hits->range_m[i], 1e12)));
        out->range_m[i] = (float)hits->range_m[i];
        out->transmittance[i] = out->sun_transmittance[i] = out->air_transmittance[i] =
            out->range_m[i] < INFINITY ? tau : 0;
        out->added_w_m2_sr[i] = (1 - out->transmittance[i]) * radiance;
    }
}

void air_veils(Veils *out, const Air *air, AirBand band, const Hits *hits, const Rays *rays, const float *temp_k)
{
    const AirTable *table = air->table[band];
    const int count = hits->count;
    if (!table) {
        veils_even(out, air, band, hits);
        return;
    }
    if (count <= 0) return;
    Places p;
    find_places(&p, out->range_m, air, table, hits, rays, count);

    transmit(out->sun_transmittance, table->extinction_sun_per_m, &p, out->range_m, count);
    if (table->scattered) {
        const float *planes = table->scattered_w_m2_sr[0];
        for (int i = 0; i < count; i++) {
            const int   node = p.node[i] + p.turn[i];
            const float a = look_up(planes, node, p.height[i], p.range[i]);
            const float b = look_up(planes, node + air_nodes, p.height[i], p.range[i]);
            out->added_w_m2_sr[i] = (1 - out->sun_transmittance[i]) * (a + p.azimuth[i] * (b - a));
        }
    } else {
        memset(out->added_w_m2_sr, 0, (size_t)count * sizeof *out->added_w_m2_sr);
    }
    if (table->thermal) {
        transmit(out->air_transmittance, table->extinction_air_per_m, &p, out->range_m, count);
        for (int i = 0; i < count; i++)
            out->added_w_m2_sr[i] += (1 - out->air_transmittance[i]) *
                                     look_up(table->thermal_w_m2_sr, p.node[i], p.height[i], p.range[i]);
        if (temp_k) transmit_emitted(out->transmittance, table, &p, out->range_m, temp_k, count);
        else memcpy(out->transmittance, out->sun_transmittance, (size_t)count * sizeof(float));
    } else {
        memcpy(out->air_transmittance, out->sun_transmittance, (size_t)count * sizeof(float));
        memcpy(out->transmittance, out->sun_transmittance, (size_t)count * sizeof(float));
    }
    for (int i = 0; i < count; i++) {
        if (out->range_m[i] < INFINITY) continue;
        const double d_enu[3] = {rays->d_enu[0][i], rays->d_enu[1][i], rays->d_enu[2][i]};
        out->transmittance[i] = out->sun_transmittance[i] = out->air_transmittance[i] = 0;
        out->added_w_m2_sr[i] = (float)air_sky_table(&air->sky_eye[band], air->sun_d_enu, d_enu);
    }
}
