/* render/light/hemisphere.c: hemisphere sampling, see hemisphere.h. Directions are cosine-distributed, so that the
 * irradiance is pi times the mean radiance; the first bounce by a Fibonacci lattice with a random rotation for each
 * hit, the second at random. */
#include "render/light/hemisphere.h"

#include "render/light/optical.h"
#include "render/parts/parts.h"
#include "render/light/thermal.h"

enum { bounces = 2, change_bounces = 3, stream_first = 40, stream_next = 41,
       stream_change = 42, stream_side = 43 }; /* streams of random numbers, used here only */

static const double golden_ratio = 0.61803398874989485, leave_offset_m = 1e-3; /* the latter as visibility_shadow's */

typedef struct Paths {
    Rays rays;
    Hits hits;
    int of_hit[hits_capacity], of_sample[hits_capacity];
    int of_path[hits_capacity]; /* its index among those that started together */
    float share[AIR_BAND_COUNT][hits_capacity]; /* share of the radiance met next that reaches the hit */
    float texture[hits_capacity], warmth_k[hits_capacity], temp_k[hits_capacity];
    float sun[hits_capacity]; /* share of the direct sun that arrives */
    bool from_ground[hits_capacity]; /* hemisphere_change: the ground's own light is kept unchanged */
} Paths;

/* Two directions at right angles to n and to each other. */
static void axes_across(double t[3], double b[3], const double n[3])
{
    t[0] = t[1] = t[2] = 0;
    t[fabs(n[0]) < 0.6 ? 0 : 1] = 1;
    v3_add_scaled(t, t, -v3_dot(t, n), n);
    v3_normalize(t, t);
    v3_cross(b, n, t);
}

/* Whether a ray may meet the box of a listed entity within reach. */
static bool may_meet(const HemisphereScene *scene, const double o_enu[3], const double d_enu[3], double reach_m,
                     const int *list, int listed)
{
    for (int k = 0; k < listed; k++) {
        const PosedEntity *e = visibility_posed(scene->visibility, list[k]);
        double             offset[3], o[3], d[3], near_m = 0, far_m = reach_m;
        if (e->model < 0) continue;
        v3_sub(offset, e->centre_enu, o_enu);
        const double along = v3_dot(offset, d_enu), square = v3_dot(offset, offset) - along * along;
        if (square > e->radius_m * e->radius_m || along < -e->radius_m || along > reach_m + e->radius_m) continue;
        v3_sub(offset, o_enu, e->p_enu);
        m3_tmul_v3(o, e->r_enu_from_body, offset);
        m3_tmul_v3(d, e->r_enu_from_body, d_enu);
        for (int c = 0; c < 3; c++) {
            const double per = 1 / d[c], a = (e->box_low[c] - o[c]) * per, b = (e->box_high[c] - o[c]) * per;
            const double in_m = a < b ? a : b, out_m = a < b ? b : a;
            /* a ray along a face gives NaN there, which leaves the interval as it is; fmax would be a call */
            near_m = in_m > near_m ? in_m : near_m;
            far_m  = out_m < far_m ? out_m : far_m;
        }
        if (near_m <= far_m + 1e-6) return true;
    }
    return false;
}

static bool ray_may_meet(const HemisphereScene *scene, const Rays *rays, int i, double reach_m, const int *list, int listed)
{
    const double o_enu[3] = {rays->o_enu[0][i], rays->o_enu[1][i], rays->o_enu[2][i]};
    const double d_enu[3] = {rays->d_enu[0][i], rays->d_enu[1][i], rays->d_enu[2][i]};
    return may_meet(scene, o_enu, d_enu, reach_m, list, listed);
}

/* Origins of the rays that leave a hit. */
typedef struct Base {
    double n_enu[3], n_geo[3], t_enu[3], b_enu[3], o_enu[3];
} Base;

static void base_at(Base *out, const Hits *hits, int from)
{
    for (int k = 0; k < 3; k++) {
        out->n_enu[k] = hits->n_enu[k][from];
        out->n_geo[k] = hits->n_geo[k][from];
        out->o_enu[k] = hits->p_enu[k][from] + leave_offset_m * out->n_geo[k];
    }
    axes_across(out->t_enu, out->b_enu, out->n_enu);
}

/* Adds a cosine-distributed ray about the normal: u in [0, 1), turn: cosine and sine. */
static int leave_base(Rays *rays, const Base *base, double u, const double turn[2])
{
    const double s = sqrt(u), c = sqrt(1 - u);
    const int at = rays->count++;
    double d_enu[3];
    for (int k = 0; k < 3; k++)
        d_enu[k] = c * base->n_enu[k] + s * (turn[0] * base->t_enu[k] + turn[1] * base->b_enu[k]);
    v3_normalize(d_enu, d_enu);
    /* an interpolated normal sends some rays into the facet itself: they are mirrored out of it */
    const double out = v3_dot(d_enu, base->n_geo);
    if (out < 0) v3_add_scaled(d_enu, d_enu, -2 * out, base->n_geo);
    for (int k = 0; k < 3; k++) {
        rays->o_enu[k][at] = base->o_enu[k];
        rays->d_enu[k][at] = d_enu[k];
    }
    rays->far_m[at] = INFINITY;
    return at;
}

/* Adds a ray that leaves hit `from` of hits, of a leaf from its far side; u, v in [0, 1). */
static int leave(Rays *rays, const Hits *hits, int from, bool far, double u, double v)
{
    Base base;
    base_at(&base, hits, from);
    for (int k = 0; far && k < 3; k++) {
        base.n_enu[k] = -base.n_enu[k], base.n_geo[k] = -base.n_geo[k];
        base.o_enu[k] = hits->p_enu[k][from] + leave_offset_m * base.n_geo[k];
    }
    return leave_base(rays, &base, u, (const double[2]){cos(2 * pi_rad * v), sin(2 * pi_rad * v)});
}

static double reflectance(const Material *m, AirBand band)
{
    return band == AIR_MWIR ? m->rho_mwir : band == AIR_LWIR ? m->rho_lwir : m->rho[band];
}

/* Half of the paths that meet a leaf continue on its far side, and count double. */
static float side_share(const Material *m, AirBand band, bool far)
{
    return 2 * (far ? (float)material_through(m, (int)band) : 1);
}

/* What all paths of a block met: materials, temperatures, shadows. */
static void resolve(Paths *p, const HemisphereScene *scene, unsigned bands, const int *list, int listed, bool parts_alone,
                    VisibilityCounters *counters)
{
    const PartTemps parts = {scene->snapshot, scene->patches, scene->visibility};
    if (parts_alone) visibility_first_part(&p->hits, scene->visibility, &p->rays, list, listed, counters);
    else visibility_first_hit(&p->hits, scene->visibility, &p->rays, list, listed, -1, counters);
    for (int i = 0; i < p->hits.count; i++) {
        p->texture[i] = 1, p->warmth_k[i] = 0;
    }
    uint8_t dark[hits_capacity] = {0};
    if (scene->air->light.sun_d_enu[2] > 0)
        visibility_shadow(dark, scene->visibility, &p->hits, scene->air->light.sun_d_enu, counters);
    for (int i = 0; i < p->hits.count; i++) p->sun[i] = dark[i] ? 0 : 1;
    if (bands & (1 << AIR_MWIR | 1 << AIR_LWIR))
        thermal_temperature(p->temp_k, scene->air, scene->materials, scene->patches ? &parts : NULL, &p->hits,
                            p->hits.material, p->sun, p->texture, p->warmth_k);
}

/* Radiance of level, open ground. */
static double ground_radiance(const HemisphereScene *scene, AirBand band)
{
    return band >= AIR_MWIR ? scene->air->light.ground_w_m2_sr[band]
                            : optical_ground_w_m2((int)band, scene->air, scene->materials) / pi_rad;
}

/* Radiance that path i carries from its hit, in one band; *rho: the share of that hit's own surroundings still to be
 * added. */
static double met(double *rho, const Paths *p, int i, const HemisphereScene *scene, AirBand band, double ground, bool last)
{
    const Air *air = scene->air;
    *rho = 0;
    if (!(p->hits.range_m[i] < INFINITY)) {
        const double d_enu[3] = {p->rays.d_enu[0][i], p->rays.d_enu[1][i], p->rays.d_enu[2][i]};
        return d_enu[2] < 0 ? ground : daylight_sky_light(&air->light, band, d_enu);
    }
    const Material *m = &scene->materials->material[p->hits.material[i]];
    const double n_enu[3] = {p->hits.n_enu[0][i], p->hits.n_enu[1][i], p->hits.n_enu[2][i]};
    *rho = reflectance(m, band);
    const double tau = *rho * material_through(m, (int)band);
    double radiance = 0;
    if (band >= AIR_MWIR)
        radiance =
            (1 - *rho - tau) * planck_table_radiance(band == AIR_MWIR ? air->light.planck_mwir : air->light.planck_lwir, p->temp_k[i]);
    if (p->sun[i] > 0 && band != AIR_LWIR)
        radiance += *rho / pi_rad * air->light.sun_w_m2[band] * fmax(v3_dot(n_enu, air->light.sun_d_enu), 0) * (double)p->sun[i];
    if (tau > 0 && p->sun[i] > 0 && band != AIR_LWIR)
        radiance += tau / pi_rad * air->light.sun_w_m2[band] * fmax(-v3_dot(n_enu, air->light.sun_d_enu), 0) * (double)p->sun[i];
    if (last) radiance += *rho * (daylight_on_plane(&air->light, band, n_enu) / pi_rad + ground * 0.5 * (1 - n_enu[2]));
    if (last && tau > 0) radiance += tau / pi_rad * daylight_far_side(&air->light, band, n_enu, ground * pi_rad);
    return radiance;
}

/* Follows one block of paths to its end and adds their radiance: each path's first, then path by path, so that block
 * boundaries change no bit. */
static void follow(double sum[AIR_BAND_COUNT][hits_capacity], Paths *p, const HemisphereScene *scene, unsigned bands,
                   const uint64_t *key, VisibilityCounters *counters)
{
    double    ground[AIR_BAND_COUNT] = {0}, brought[AIR_BAND_COUNT][hits_capacity] = {{0}};
    int       of_hit[hits_capacity];
    const int started = p->rays.count;
    for (int i = 0; i < started; i++) p->of_path[i] = i, of_hit[i] = p->of_hit[i];
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        if (bands >> b & 1) ground[b] = ground_radiance(scene, (AirBand)b);

    for (int bounce = 0; bounce < bounces && p->rays.count > 0; bounce++) {
        const bool last = bounce == bounces - 1;
        resolve(p, scene, bands, NULL, -1, false, counters);
        float rho[AIR_BAND_COUNT][hits_capacity];
        for (int b = 0; b < AIR_BAND_COUNT; b++) {
            if (!(bands >> b & 1)) continue;
            for (int i = 0; i < p->hits.count; i++) {
                double left;
                brought[b][p->of_path[i]] += p->share[b][i] * met(&left, p, i, scene, (AirBand)b, ground[b], last);
                rho[b][i] = (float)left;
            }
        }
        if (last) break;
        /* paths that met something continue, compacted; no slot is read after a later path was written to it */
        p->rays.count = 0;
        for (int i = 0; i < p->hits.count; i++) {
            if (!(p->hits.range_m[i] < INFINITY)) continue;
            const uint64_t to = key[p->of_hit[i]];
            const uint32_t draw = (uint32_t)(2 * p->of_sample[i]);
            const Material *m = &scene->materials->material[p->hits.material[i]];
            const bool leaf = material_is_leaf(m), far = leaf && random_uniform(0, stream_side, draw, to) < 0.5;
            const int at = leave(&p->rays, &p->hits, i, far, random_uniform(0, stream_next, draw, to),
                                 random_uniform(0, stream_next, draw + 1, to));
            p->of_hit[at] = p->of_hit[i], p->of_sample[at] = p->of_sample[i], p->of_path[at] = p->of_path[i];
            for (int b = 0; b < AIR_BAND_COUNT; b++)
                if (bands >> b & 1) p->share[b][at] = p->share[b][i] * rho[b][i] * (leaf ? side_share(m, (AirBand)b, far) : 1);
        }
    }
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        if (bands >> b & 1)
            for (int i = 0; i < started; i++) sum[b][of_hit[i]] += brought[b][i];
}

void hemisphere_light(HemisphereLight *out, const HemisphereScene *scene, const Hits *hits, unsigned bands, int samples,
                  const uint64_t *key, VisibilityCounters *counters)
{
    Paths paths;
    double sum[AIR_BAND_COUNT][hits_capacity] = {{0}};

    paths.rays.count = paths.rays.columns = 0;
    for (int i = 0; i < hits->count; i++) {
        if (!(hits->range_m[i] < INFINITY)) continue;
        const double u0 = random_uniform(0, stream_first, 0, key[i]), v0 = random_uniform(0, stream_first, 1, key[i]);
        const Material *m = &scene->materials->material[hits->material[i]];
        for (int n = 0; n < (material_is_leaf(m) ? 2 * samples : samples); n++) {
            const bool   far = n >= samples;
            const int    k = far ? n - samples : n;
            const double v = v0 + k * golden_ratio;
            const int at = leave(&paths.rays, hits, i, far, (k + u0) / samples, v - floor(v));
            paths.of_hit[at] = i, paths.of_sample[at] = n;
            for (int b = 0; b < AIR_BAND_COUNT; b++) paths.share[b][at] = far ? (float)material_through(m, b) : 1;
            if (paths.rays.count < hits_capacity) continue;
            follow(sum, &paths, scene, bands, key, counters);
            paths.rays.count = 0;
        }
    }
    if (paths.rays.count > 0) follow(sum, &paths, scene, bands, key, counters);
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        if (bands >> b & 1)
            for (int i = 0; i < hits->count; i++) out->w_m2[b][i] = (float)(sum[b][i] * pi_rad / samples);
}

/* ---- change of light by nearby objects -------------------------------------------------------- */

/* The bright ring about the sun is sampled apart from the rest of the sky: it is a few per cent of the sky's light
 * within 1 % of the directions, and would cause most of the noise. ring_w_m2 is the excess of the sky there over its
 * radiance at the ring's edge, on a plane facing the sun. A hit has separate directions towards the ring; surfaces
 * met by later bounces receive it where the sun shines on them. */
enum { ring_node = 6, ring_directions = 4, ring_sample = -1 };
static const double ring_rad = 3.14159265358979323846 * ring_node * ring_node / (air_sky_angles * air_sky_angles);

typedef struct Open {
    bool   ring; /* the sun is up */
    double across_enu[2][3]; /* with the sun's direction, a right-angled triad */
    double ring_w_m2[AIR_BAND_COUNT];
    double ground[AIR_BAND_COUNT]; /* radiance of level, open ground */
} Open;

static double ring_radiance(const AirSky *sky, const SkyPlace *at, const SkyPlace *edge)
{
    return daylight_sky_there(sky, at) - daylight_sky_there(sky, edge);
}

/* At the edge of the ring, for a direction within it. */
static SkyPlace ring_edge(const SkyPlace *at)
{
    SkyPlace edge = *at;
    if (edge.angle < ring_node) edge.angle = ring_node, edge.angle_share = 0;
    return edge;
}

static void ring_direction(double d_enu[3], const Open *open, const double sun_d_enu[3], double off_rad,
                           double turn_rad)
{
    const double c = cos(off_rad), x = sin(off_rad) * cos(turn_rad), y = sin(off_rad) * sin(turn_rad);
    for (int k = 0; k < 3; k++) d_enu[k] = c * sun_d_enu[k] + x * open->across_enu[0][k] + y * open->across_enu[1][k];
}

static void open_light(Open *out, const HemisphereScene *scene, unsigned bands)
{
    enum { offs = 16, turns = 3 };
    const Air    *air = scene->air;
    const double *sun = air->light.sun_d_enu;
    *out = (Open){.ring = sun[2] > 0};
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        if (bands >> b & 1) out->ground[b] = ground_radiance(scene, (AirBand)b);
    if (!out->ring) return;
    axes_across(out->across_enu[0], out->across_enu[1], sun);
    for (int i = 0; i < offs * turns; i++) {
        const double off_rad = ring_rad * (i / turns + 0.5) / offs;
        double       d_enu[3];
        ring_direction(d_enu, out, sun, off_rad, 2 * pi_rad * (i % turns) / turns);
        if (d_enu[2] < 0) continue;
        SkyPlace at;
        daylight_sky_place(&at, &air->light, d_enu);
        const SkyPlace edge = ring_edge(&at);
        const double   sr = 2 * pi_rad * ring_rad * sin(off_rad) / (offs * turns);
        for (int b = 0; b < AIR_BAND_COUNT; b++)
            if (bands >> b & 1) out->ring_w_m2[b] += ring_radiance(&air->light.sky_light[b], &at, &edge) * cos(off_rad) * sr;
    }
}

typedef struct Change {
    double w_m2[AIR_BAND_COUNT];
    int blocked, sunlit, parts, inside;
} Change;

static void count_first(Change *to, const Paths *p, int i, const HemisphereScene *scene)
{
    const Hits *hits = &p->hits;
    to->blocked++;
    to->parts += hits->entity[i] != 0;
    to->inside += hits->inside[i];
    double along = 0;
    for (int c = 0; c < 3; c++) along += hits->n_enu[c][i] * scene->air->light.sun_d_enu[c];
    to->sunlit += p->sun[i] > 0 && along > 0;
}

static void follow_change(Change *sum, Paths *p, const HemisphereScene *scene, unsigned bands, double reach_m,
                          const Open *open, const uint64_t *key, const int *list, int listed,
                          VisibilityCounters *counters)
{
    double    brought[AIR_BAND_COUNT][hits_capacity];
    int       of_hit[hits_capacity];
    const int started = p->rays.count;
    for (int b = 0; b < AIR_BAND_COUNT; b++) memset(brought[b], 0, (size_t)started * sizeof *brought[b]);
    for (int i = 0; i < started; i++) p->of_path[i] = i, of_hit[i] = p->of_hit[i];

    for (int bounce = 0; bounce < change_bounces && p->rays.count > 0; bounce++) {
        for (int i = 0; i < p->rays.count; i++) p->rays.far_m[i] = reach_m;
        bool parts_alone = true; /* from the ground, the ground is not traced */
        for (int i = 0; i < p->rays.count; i++) parts_alone &= p->from_ground[i];
        resolve(p, scene, bands, list, listed, parts_alone, counters);
        const int count = p->hits.count;
        p->rays.count = 0;
        for (int i = 0; i < count; i++) {
            const int of = p->of_hit[i];
            if (!(p->hits.range_m[i] < INFINITY)) continue;
            if (p->from_ground[i] && !p->hits.entity[i]) continue;
            if (p->of_sample[i] == ring_sample) {
                for (int b = 0; b < AIR_BAND_COUNT; b++)
                    if (bands >> b & 1) brought[b][p->of_path[i]] -= p->share[b][i];
                continue;
            }
            if (bounce == 0) count_first(&sum[of], p, i, scene);
            const double d_enu[3] = {p->rays.d_enu[0][i], p->rays.d_enu[1][i], p->rays.d_enu[2][i]};
            const double n_enu[3] = {p->hits.n_enu[0][i], p->hits.n_enu[1][i], p->hits.n_enu[2][i]};
            float        share[AIR_BAND_COUNT];
            PlanePlace   plane;
            SkyPlace     sky;
            daylight_plane_place(&plane, &scene->air->light, n_enu);
            if (d_enu[2] >= 0) {
                daylight_sky_place(&sky, &scene->air->light, d_enu);
                if (open->ring) sky = ring_edge(&sky);
            }
            const double ring = (1 - (double)p->sun[i]) * fmax(v3_dot(n_enu, scene->air->light.sun_d_enu), 0) / pi_rad;
            for (int b = 0; b < AIR_BAND_COUNT; b++) {
                if (!(bands >> b & 1)) continue;
                double       rho;
                const double ground = open->ground[b];
                const double shown = met(&rho, p, i, scene, (AirBand)b, ground, false) +
                                     rho * (daylight_plane_there(&scene->air->light, (AirBand)b, &plane) / pi_rad +
                                            ground * 0.5 * (1 - n_enu[2]) - ring * open->ring_w_m2[b]);
                const double behind = d_enu[2] < 0 ? ground : daylight_sky_there(&scene->air->light.sky_light[b], &sky);
                brought[b][p->of_path[i]] += p->share[b][i] * (shown - behind);
                share[b] = 2 * p->share[b][i] * (float)rho;
            }
            /* half of them continue with double weight; compacted: no slot is read after a later path was written to
             * it */
            if (bounce == change_bounces - 1 || (p->of_sample[i] >> bounce & 1)) continue;
            const uint64_t to = key[of];
            const uint32_t draw = (uint32_t)(2 * (p->of_sample[i] * change_bounces + bounce));
            const int at = leave(&p->rays, &p->hits, i, false, random_uniform(0, stream_change, draw, to),
                                 random_uniform(0, stream_change, draw + 1, to));
            /* from the ground, too, only parts change the light */
            if (!p->hits.entity[i] && !ray_may_meet(scene, &p->rays, at, reach_m, list, listed)) {
                p->rays.count = at;
                continue;
            }
            p->of_hit[at] = of, p->of_sample[at] = p->of_sample[i], p->of_path[at] = p->of_path[i];
            p->from_ground[at] = !p->hits.entity[i];
            for (int b = 0; b < AIR_BAND_COUNT; b++)
                if (bands >> b & 1) p->share[b][at] = share[b];
        }
    }
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        if (bands >> b & 1)
            for (int i = 0; i < started; i++) sum[of_hit[i]].w_m2[b] += brought[b][i];
}

enum { close_most = 64 };

/* The listed entities within whose reach a point lies. */
static int list_close(int close[close_most], const HemisphereScene *scene, const Hits *hits, int i,
                      const double *list_reach_m, const int *list, int listed)
{
    int count = 0;
    for (int k = 0; k < listed && count < close_most; k++) {
        const PosedEntity *e = visibility_posed(scene->visibility, list[k]);
        const double       far_m = e->radius_m + list_reach_m[k];
        double             square = 0;
        for (int c = 0; c < 3; c++) {
            const double off_m = e->centre_enu[c] - hits->p_enu[c][i];
            square += off_m * off_m;
        }
        if (square < far_m * far_m) close[count++] = list[k];
    }
    return count;
}

/* Adds ray n of those towards the ring; its shares are what is lost when it meets something; -1: it points into the
 * surface or below the horizon. */
static int leave_to_ring(Paths *p, const Hits *hits, int from, const HemisphereScene *scene, unsigned bands,
                         const Open *open, int n, int samples, double u, double v)
{
    const double off_rad = ring_rad * (n + u) / ring_directions;
    const double n_enu[3] = {hits->n_enu[0][from], hits->n_enu[1][from], hits->n_enu[2][from]};
    double       d_enu[3];
    ring_direction(d_enu, open, scene->air->light.sun_d_enu, off_rad, 2 * pi_rad * (v + n * golden_ratio));
    const double along = v3_dot(d_enu, n_enu);
    if (along <= 0 || d_enu[2] < 0) return -1;
    const int at = p->rays.count++;
    for (int k = 0; k < 3; k++) {
        p->rays.o_enu[k][at] = hits->p_enu[k][from] + leave_offset_m * hits->n_geo[k][from];
        p->rays.d_enu[k][at] = d_enu[k];
    }
    SkyPlace place;
    daylight_sky_place(&place, &scene->air->light, d_enu);
    const SkyPlace edge = ring_edge(&place);
    const double   share = along * 2 * ring_rad * sin(off_rad) * samples / ring_directions;
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        if (bands >> b & 1)
            p->share[b][at] = (float)(share * ring_radiance(&scene->air->light.sky_light[b], &place, &edge));
    return at;
}

/* Rotates by the angle whose cosine and sine are `by`: rounding stays below 1e-13 over all directions of a point. */
static void v2_turn(double turn[2], const double by[2])
{
    const double x = turn[0] * by[0] - turn[1] * by[1];
    turn[1] = turn[0] * by[1] + turn[1] * by[0];
    turn[0] = x;
}

void hemisphere_change(HemisphereChange *out, const HemisphereScene *scene, const Hits *hits, unsigned bands, int samples,
                   double reach_m, const double *list_reach_m, const uint64_t *key, const int *list, int listed,
                   VisibilityCounters *counters)
{
    Paths  paths;
    Open   open;
    Change sum[hits_capacity];
    const double golden_turn[2] = {cos(2 * pi_rad * golden_ratio), sin(2 * pi_rad * golden_ratio)};
    open_light(&open, scene, bands);
    memset(sum, 0, (size_t)hits->count * sizeof *sum);
    paths.rays.count = paths.rays.columns = 0;
    for (int i = 0; i < hits->count; i++) {
        const double u0 = random_uniform(0, stream_first, 0, key[i]), v0 = random_uniform(0, stream_first, 1, key[i]);
        int          close[close_most];
        const int    closes = hits->entity[i] ? 0 : list_close(close, scene, hits, i, list_reach_m, list, listed);
        double       turn[2] = {cos(2 * pi_rad * v0), sin(2 * pi_rad * v0)};
        Base         base;
        base_at(&base, hits, i);
        for (int k = 0; k < samples + (open.ring ? ring_directions : 0); k++) {
            const int at = k < samples ? leave_base(&paths.rays, &base, (k + u0) / samples, turn)
                                       : leave_to_ring(&paths, hits, i, scene, bands, &open, k - samples, samples,
                                                       u0, v0);
            v2_turn(turn, golden_turn);
            if (at < 0) continue;
            if (!hits->entity[i] && !ray_may_meet(scene, &paths.rays, at, reach_m, close, closes)) {
                paths.rays.count = at; /* would contribute nothing */
                continue;
            }
            paths.of_hit[at] = i;
            paths.from_ground[at] = !hits->entity[i];
            paths.of_sample[at] = k < samples ? k : ring_sample;
            for (int b = 0; b < AIR_BAND_COUNT && k < samples; b++) paths.share[b][at] = 1;
            if (paths.rays.count < hits_capacity) continue;
            follow_change(sum, &paths, scene, bands, reach_m, &open, key, list, listed, counters);
            paths.rays.count = 0;
        }
    }
    if (paths.rays.count > 0)
        follow_change(sum, &paths, scene, bands, reach_m, &open, key, list, listed, counters);
    for (int i = 0; i < hits->count; i++) {
        const Change *s = &sum[i];
        out[i] = (HemisphereChange){.blocked = (float)s->blocked / (float)samples,
                                .sunlit = (float)s->sunlit / (float)samples,
                                .inside = s->parts ? (float)s->inside / (float)s->parts : 0};
        for (int b = 0; b < AIR_BAND_COUNT; b++) out[i].w_m2[b] = (float)(s->w_m2[b] * pi_rad / samples);
    }
}
