/* render/light/hemisphere.c: hemisphere sampling, see hemisphere.h. Directions are cosine-distributed, so that the
 * irradiance is pi times the mean radiance; the first bounce by a Fibonacci lattice with a random rotation for each
 * hit, the second at random. */
#include "render/light/hemisphere_private.h"

#include "render/light/optical.h"
#include "render/light/thermal.h"

enum { bounces = 2 };

void hemisphere_axes_across(double t[3], double b[3], const double n[3])
{
    t[0] = t[1] = t[2] = 0;
    t[fabs(n[0]) < 0.6 ? 0 : 1] = 1;
    v3_add_scaled(t, t, -v3_dot(t, n), n);
    v3_normalize(t, t);
    v3_cross(b, n, t);
}

void hemisphere_base_at(Base *out, const Hits *hits, int from)
{
    for (int k = 0; k < 3; k++) {
        out->n_enu[k] = hits->n_enu[k][from];
        out->n_geo[k] = hits->n_geo[k][from];
        out->o_enu[k] = hits->p_enu[k][from] + leave_offset_m * out->n_geo[k];
    }
    hemisphere_axes_across(out->t_enu, out->b_enu, out->n_enu);
}

int hemisphere_leave_base(Rays *rays, const Base *base, double u, const double turn[2])
{
    const double s = sqrt(u), c = sqrt(1 - u);
    const int    at = rays->count++;
    double       d_enu[3];
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

int hemisphere_leave(Rays *rays, const Hits *hits, int from, bool far, double u, double v)
{
    Base base;
    hemisphere_base_at(&base, hits, from);
    for (int k = 0; far && k < 3; k++) {
        base.n_enu[k] = -base.n_enu[k], base.n_geo[k] = -base.n_geo[k];
        base.o_enu[k] = hits->p_enu[k][from] + leave_offset_m * base.n_geo[k];
    }
    return hemisphere_leave_base(rays, &base, u, (const double[2]){cos(2 * pi_rad * v), sin(2 * pi_rad * v)});
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

void hemisphere_light_met(Paths *p, const HemisphereScene *scene, unsigned bands, bool shadows,
                          VisibilityCounters *counters)
{
    const PartTemps parts = {scene->snapshot, scene->patches, scene->visibility};
    for (int i = 0; i < p->hits.count; i++) {
        p->texture[i] = 1, p->warmth_k[i] = 0;
    }
    uint8_t dark[hits_capacity] = {0};
    if (shadows && scene->air->light.sun_d_enu[2] > 0)
        visibility_shadow(dark, scene->visibility, &p->hits, scene->air->light.sun_d_enu, counters);
    for (int i = 0; i < p->hits.count; i++) p->sun[i] = dark[i] ? 0 : 1;
    if (bands & (1 << AIR_MWIR | 1 << AIR_LWIR))
        thermal_temperature(p->temp_k, scene->air, scene->materials, &parts, &p->hits, p->hits.material, p->sun,
                            p->texture, p->warmth_k);
}

double hemisphere_ground_radiance(const HemisphereScene *scene, AirBand band)
{
    return band >= AIR_MWIR ? scene->air->light.ground_w_m2_sr[band]
                            : optical_ground_w_m2((int)band, scene->air, scene->materials) / pi_rad;
}

double hemisphere_met(double *rho, const Paths *p, int i, const HemisphereScene *scene, AirBand band, double ground,
                      bool last)
{
    const Air *air = scene->air;
    *rho = 0;
    if (!(p->hits.range_m[i] < INFINITY)) {
        const double d_enu[3] = {p->rays.d_enu[0][i], p->rays.d_enu[1][i], p->rays.d_enu[2][i]};
        return d_enu[2] < 0 ? ground : daylight_sky(&air->light, band, d_enu);
    }
    const Material *m = &scene->materials->material[p->hits.material[i]];
    const double    n_enu[3] = {p->hits.n_enu[0][i], p->hits.n_enu[1][i], p->hits.n_enu[2][i]};
    *rho = reflectance(m, band);
    const double tau = *rho * material_through(m, (int)band);
    double       radiance = 0;
    if (band >= AIR_MWIR)
        radiance =
            (1 - *rho - tau) *
            planck_table_radiance(band == AIR_MWIR ? air->light.planck_mwir : air->light.planck_lwir, p->temp_k[i]);
    if (p->sun[i] > 0 && band != AIR_LWIR)
        radiance += *rho / pi_rad * air->light.sun_w_m2[band] * fmax(v3_dot(n_enu, air->light.sun_d_enu), 0) *
                    (double)p->sun[i];
    if (tau > 0 && p->sun[i] > 0 && band != AIR_LWIR)
        radiance += tau / pi_rad * air->light.sun_w_m2[band] * fmax(-v3_dot(n_enu, air->light.sun_d_enu), 0) *
                    (double)p->sun[i];
    if (last) radiance += *rho * (daylight_on_plane(&air->light, band, n_enu) / pi_rad + ground * 0.5 * (1 - n_enu[2]));
    if (last && tau > 0) radiance += tau / pi_rad * daylight_far_side(&air->light, band, n_enu, ground * pi_rad);
    return radiance;
}

double hemisphere_below(double change_w_m2, double ground_w_m2_sr, double up)
{
    static const double least_share = 1.0 / 16; /* of a hemisphere; half of it lies below a wall's horizontal */
    const double        ground_w_m2 = ground_w_m2_sr * pi_rad * fmax(0.5 * (1 - up), least_share);
    return ground_w_m2 > 0 ? clamp(1 + change_w_m2 / ground_w_m2, 0, 100) : 1;
}

/* Of all paths from a hit, and of those that left below the horizontal: the latter less level ground's radiance. */
typedef struct Sums {
    double all[AIR_BAND_COUNT][hits_capacity], below[AIR_BAND_COUNT][hits_capacity];
} Sums;

/* Follows one block of paths to its end and adds their radiance: each path's first, then path by path, so that block
 * boundaries change no bit. */
static void follow(Sums *sum, Paths *p, const HemisphereScene *scene, unsigned bands, const uint64_t *key,
                   VisibilityCounters *counters)
{
    double    ground[AIR_BAND_COUNT] = {0}, brought[AIR_BAND_COUNT][hits_capacity] = {{0}};
    int       of_hit[hits_capacity];
    bool      down[hits_capacity];
    const int started = p->rays.count;
    for (int i = 0; i < started; i++) p->of_path[i] = i, of_hit[i] = p->of_hit[i], down[i] = p->rays.d_enu[2][i] < 0;
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        if (bands >> b & 1) ground[b] = hemisphere_ground_radiance(scene, (AirBand)b);

    for (int bounce = 0; bounce < bounces && p->rays.count > 0; bounce++) {
        const bool last = bounce == bounces - 1;
        visibility_first_hit(&p->hits, scene->visibility, &p->rays, visibility_all_but(-1), counters);
        hemisphere_light_met(p, scene, bands, true, counters);
        float rho[AIR_BAND_COUNT][hits_capacity];
        for (int b = 0; b < AIR_BAND_COUNT; b++) {
            if (!(bands >> b & 1)) continue;
            for (int i = 0; i < p->hits.count; i++) {
                double left;
                brought[b][p->of_path[i]] +=
                    p->share[b][i] * hemisphere_met(&left, p, i, scene, (AirBand)b, ground[b], last);
                rho[b][i] = (float)left;
            }
        }
        if (last) break;
        /* paths that met something continue, compacted; no slot is read after a later path was written to it */
        p->rays.count = 0;
        for (int i = 0; i < p->hits.count; i++) {
            if (!(p->hits.range_m[i] < INFINITY)) continue;
            const uint64_t  to = key[p->of_hit[i]];
            const uint32_t  draw = (uint32_t)(2 * p->of_sample[i]);
            const Material *m = &scene->materials->material[p->hits.material[i]];
            const bool      leaf = material_is_leaf(m), far = leaf && random_uniform(0, stream_side, draw, to) < 0.5;
            const int       at = hemisphere_leave(&p->rays, &p->hits, i, far, random_uniform(0, stream_next, draw, to),
                                                  random_uniform(0, stream_next, draw + 1, to));
            p->of_hit[at] = p->of_hit[i], p->of_sample[at] = p->of_sample[i], p->of_path[at] = p->of_path[i];
            for (int b = 0; b < AIR_BAND_COUNT; b++)
                if (bands >> b & 1)
                    p->share[b][at] = p->share[b][i] * rho[b][i] * (leaf ? side_share(m, (AirBand)b, far) : 1);
        }
    }
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        if (bands >> b & 1)
            for (int i = 0; i < started; i++) {
                sum->all[b][of_hit[i]] += brought[b][i];
                if (down[i]) sum->below[b][of_hit[i]] += brought[b][i] - ground[b];
            }
}

void hemisphere_light(HemisphereLight *out, const HemisphereScene *scene, const Hits *hits, unsigned bands, int samples,
                      const uint64_t *key, VisibilityCounters *counters)
{
    Paths paths;
    Sums  sum = {0};

    paths.rays.count = paths.rays.columns = 0;
    paths.rays.bent = false;
    for (int i = 0; i < hits->count; i++) {
        if (!(hits->range_m[i] < INFINITY)) continue;
        const double u0 = random_uniform(0, stream_first, 0, key[i]), v0 = random_uniform(0, stream_first, 1, key[i]);
        const Material *m = &scene->materials->material[hits->material[i]];
        for (int n = 0; n < (material_is_leaf(m) ? 2 * samples : samples); n++) {
            const bool   far = n >= samples;
            const int    k = far ? n - samples : n;
            const double v = v0 + k * golden_ratio;
            const int    at = hemisphere_leave(&paths.rays, hits, i, far, (k + u0) / samples, v - floor(v));
            paths.of_hit[at] = i, paths.of_sample[at] = n;
            for (int b = 0; b < AIR_BAND_COUNT; b++) paths.share[b][at] = far ? (float)material_through(m, b) : 1;
            if (paths.rays.count < hits_capacity) continue;
            follow(&sum, &paths, scene, bands, key, counters);
            paths.rays.count = 0;
        }
    }
    if (paths.rays.count > 0) follow(&sum, &paths, scene, bands, key, counters);
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        if (!(bands >> b & 1)) continue;
        const double ground = hemisphere_ground_radiance(scene, (AirBand)b);
        for (int i = 0; i < hits->count; i++) {
            const bool met = hits->range_m[i] < INFINITY;
            out->w_m2[b][i] = (float)(sum.all[b][i] * pi_rad / samples);
            out->below[b][i] = 1;
            if (met && !material_is_leaf(&scene->materials->material[hits->material[i]]))
                out->below[b][i] =
                    (float)hemisphere_below(sum.below[b][i] * pi_rad / samples, ground, (double)hits->n_enu[2][i]);
        }
    }
}
