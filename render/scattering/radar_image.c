/* render/scattering/radar_image.c: metal as mirrors, followed for a few bounces.
 *
 * The source is at the eye. A mirror sends the power of an eye ray into a lobe about the mirror direction (the lobe
 * stands for antenna cone and roughness together); its contribution is the lobe's value in the direction back to the
 * eye, if the eye is visible from there. The whole ray continues along the mirror direction to the next mirror, where
 * the same is computed. Energy is conserved: each exit's lobe integrates to 1, times the mirrors' own reflectances. A
 * path ends at ground and at any surface that is not a mirror.
 *
 * Diffuse backscatter: sigma0 = gamma sin(grazing) is area of cross section by area of ground. A ray of solid angle
 * w at range R lights R^2 w / sin(grazing) of it, and a cross section spreads over 4 pi: gamma / (4 pi) of the ray's
 * power comes back a steradian, at any grazing angle. That is the constant-gamma model, in the same unit as the
 * lobe. */
#include "render/scattering/radar_image.h"

double radar_lobe(double lobe_rad, double cosine)
{
    if (!(cosine > 0)) return 0;
    const double s2 = clamp(0.5 * lobe_rad * lobe_rad, 0.5e-18, 0.5e12); /* neither 0 / 0 nor infinity times 0 */
    return exp((cosine - 1) / s2) / (2 * pi_rad * s2 * -expm1(-1 / s2));
}

/* Below this the lobe's value is negligible (its peak is 1 / (pi lobe_rad^2)), and the ray back to the eye is not
 * worth tracing. exp(-40) of the peak. */
static bool lobe_is_dark(double lobe_rad, double cosine) { return !(1 - cosine < 20 * lobe_rad * lobe_rad); }

/* The paths that are still followed, as arrays. The ray that leaves the last mirror is in Block.onward. */
typedef struct Paths {
    int    count;
    int    sample[hits_capacity];      /* of the eye ray it started as */
    double reflectance[hits_capacity]; /* of all mirrors so far */
    double travelled_m[hits_capacity]; /* from the eye to the last mirror */
} Paths;

/* Adds a ray that starts at a mirror, a millimetre clear of it along its own normal. */
static void add_ray(Rays *rays, const double p_enu[3], const double n_geo[3], const double d_enu[3], double far_m)
{
    const int k = rays->count++;
    for (int a = 0; a < 3; a++) {
        rays->o_enu[a][k] = p_enu[a] + 1e-3 * n_geo[a];
        rays->d_enu[a][k] = d_enu[a];
    }
    rays->far_m[k] = far_m;
}

/* Computes the mirror direction at hit k of a ray along d_enu. False: a shading normal tilts it into the surface. */
static bool mirror(double out_enu[3], const Hits *hits, int k, const double d_enu[3])
{
    const double n_enu[3] = {hits->n_enu[0][k], hits->n_enu[1][k], hits->n_enu[2][k]};
    const double n_geo[3] = {hits->n_geo[0][k], hits->n_geo[1][k], hits->n_geo[2][k]};
    v3_add_scaled(out_enu, d_enu, -2 * v3_dot(d_enu, n_enu), n_enu);
    /* normals are floats: normalise again */
    return v3_normalize(out_enu, out_enu) && v3_dot(out_enu, n_geo) > 0;
}

/* One block: what its paths are followed through, and its working memory. */
typedef struct Block {
    const RadarConfig  *config;
    const Visibility   *visibility;
    const Materials    *materials;
    const Rays         *rays;   /* from the eye */
    int                 hidden; /* as in RayEntities */
    VisibilityCounters *counters;
    Rays                onward, back;
    Hits                met, between;
    Paths               paths;
    int                 back_sample[hits_capacity];
    double              back_power[hits_capacity];
    double              back_slant_m[hits_capacity];
} Block;

/* The first bounce: visible from the eye by construction. Starts the paths that continue. */
static void first_bounce(RadarReturns *out, Block *s, const Hits *hits)
{
    const Rays *rays = s->rays;
    s->paths.count = s->onward.count = 0;
    s->onward.columns = s->back.columns = 0; /* rays of no picture's rows */
    s->onward.bent = s->back.bent = false;
    for (int i = 0; i < hits->count; i++) {
        if (!(hits->range_m[i] < INFINITY)) continue;
        const Material *m = &s->materials->material[hits->material[i]];
        double          power = m->radar_gamma / (4 * pi_rad);
        if (m->metal > 0) {
            const double d_enu[3] = {rays->d_enu[0][i], rays->d_enu[1][i], rays->d_enu[2][i]};
            double       exit_enu[3];
            if (mirror(exit_enu, hits, i, d_enu)) {
                power += m->metal * radar_lobe(s->config->lobe_rad, -v3_dot(exit_enu, d_enu));

                const int    k = s->paths.count++;
                const double p_enu[3] = {hits->p_enu[0][i], hits->p_enu[1][i], hits->p_enu[2][i]};
                const double n_geo[3] = {hits->n_geo[0][i], hits->n_geo[1][i], hits->n_geo[2][i]};
                s->paths.sample[k] = i;
                s->paths.reflectance[k] = m->metal;
                s->paths.travelled_m[k] = hits->range_m[i];
                add_ray(&s->onward, p_enu, n_geo, exit_enu, INFINITY);
            }
        }
        out->power[0][i] = (float)power;
        out->slant_m[0][i] = (float)hits->range_m[i];
    }
}

/* One more bounce of all paths: their hits, the power that returns to the eye, and the paths that continue. The
 * return of bounces beyond the last that is reported is added to that one. */
static void next_bounce(RadarReturns *out, int nth, Block *s)
{
    const RadarConfig *config = s->config;
    const Rays        *rays = s->rays;
    const bool         beyond = nth >= radar_bounces;
    const int          bounce = beyond ? radar_bounces - 1 : nth;
    visibility_first_hit(&s->met, s->visibility, &s->onward, visibility_all_but(s->hidden), s->counters);

    Paths *paths = &s->paths;
    int    going = 0;
    s->back.count = 0;
    Rays *onward = &s->onward;
    for (int k = 0; k < paths->count; k++) {
        if (!(s->met.range_m[k] < INFINITY)) continue;
        const Material *m = &s->materials->material[s->met.material[k]];
        if (!(m->metal > 0)) continue;
        const double d_enu[3] = {onward->d_enu[0][k], onward->d_enu[1][k], onward->d_enu[2][k]};
        double       exit_enu[3];
        if (!mirror(exit_enu, &s->met, k, d_enu)) continue;

        const int    sample = paths->sample[k];
        const double reflectance = paths->reflectance[k] * m->metal;
        const double travelled_m = paths->travelled_m[k] + s->met.range_m[k];
        const double p_enu[3] = {s->met.p_enu[0][k], s->met.p_enu[1][k], s->met.p_enu[2][k]};
        const double n_geo[3] = {s->met.n_geo[0][k], s->met.n_geo[1][k], s->met.n_geo[2][k]};

        const double eye_enu[3] = {rays->o_enu[0][sample], rays->o_enu[1][sample], rays->o_enu[2][sample]};
        double       home_enu[3];
        v3_sub(home_enu, eye_enu, p_enu);
        const double home_m = v3_length(home_enu);
        if (!beyond) out->slant_m[bounce][sample] = (float)(0.5 * (travelled_m + home_m));
        if (v3_normalize(home_enu, home_enu)) {
            const double cosine = v3_dot(exit_enu, home_enu);
            if (!lobe_is_dark(config->lobe_rad, cosine) && v3_dot(home_enu, n_geo) > 0) {
                s->back_sample[s->back.count] = sample;
                s->back_slant_m[s->back.count] = 0.5 * (travelled_m + home_m);
                s->back_power[s->back.count] = reflectance * radar_lobe(config->lobe_rad, cosine);
                add_ray(&s->back, p_enu, n_geo, home_enu, home_m);
            }
        }
        /* in place: `going` never passes k, and ray k has been read */
        paths->sample[going] = sample;
        paths->reflectance[going] = reflectance;
        paths->travelled_m[going] = travelled_m;
        onward->count = going++;
        add_ray(onward, p_enu, n_geo, exit_enu, INFINITY);
    }
    paths->count = onward->count = going;
    if (s->back.count == 0) return;

    visibility_first_hit(&s->between, s->visibility, &s->back, visibility_all_but(s->hidden), s->counters);
    for (int k = 0; k < s->back.count; k++) {
        if (s->between.range_m[k] < INFINITY) continue;
        const int    i = s->back_sample[k];
        const double held = (double)out->power[bounce][i], more = s->back_power[k];
        if (beyond && more > 0)
            out->slant_m[bounce][i] =
                (float)((held * (double)out->slant_m[bounce][i] + more * s->back_slant_m[k]) / (held + more));
        out->power[bounce][i] += (float)more;
    }
}

void radar_shade(RadarReturns *out, const RadarConfig *config, const RadarRays *from, VisibilityCounters *counters)
{
    Block s; /* its working memory is written before it is read, so not cleared: it is large */
    s.config = config, s.visibility = from->visibility, s.materials = from->materials;
    s.rays = from->rays, s.hidden = from->hidden, s.counters = counters;
    for (int b = 0; b < radar_bounces; b++) {
        memset(out->power[b], 0, (size_t)from->hits->count * sizeof out->power[b][0]);
        memset(out->slant_m[b], 0, (size_t)from->hits->count * sizeof out->slant_m[b][0]);
    }
    first_bounce(out, &s, from->hits);
    for (int b = 1; b < radar_mirrors + config->more_bounces && s.paths.count > 0; b++) next_bounce(out, b, &s);
}
