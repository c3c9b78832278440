/* render/optical.c: what the eye gets of sun and sky: reflected by what was hit, then through the air.
 *
 * A surface reflects diffusely and, as far as it is glossy, in a lobe: the sun by its own width, the sky by the
 * mirror direction. Sky and ground light every surface by the share of each that it faces; what stands around
 * does not hide them (no ambient occlusion yet), and a mirror shows sky or ground, not its neighbours. */
#include "render/optical.h"

void optical_shade(float *out, int channel, const Air *air, const Materials *materials, const Hits *hits,
                   const Rays *rays, const uint16_t *material, const float *texture, const uint8_t *shadow)
{
    const double *sun_d_enu = air->sun_d_enu;
    const double sun_w_m2 = air->sun_w_m2[channel], sky_w_m2 = air->sky_w_m2[channel];
    /* light that comes up from level, sunlit ground */
    const double ground_w_m2 = materials->ground_rho[channel] * (sun_w_m2 * fmax(sun_d_enu[2], 0) + sky_w_m2);
    const double extinction_per_m = air->extinction_per_m[channel], horizon_w_m2_sr = air->horizon_w_m2_sr[channel];

    for (int i = 0; i < hits->count; i++) {
        const double d_enu[3] = {rays->d_enu[0][i], rays->d_enu[1][i], rays->d_enu[2][i]};
        if (!(hits->range_m[i] < INFINITY)) {
            out[i] = (float)(air_sky_optical(air, channel, d_enu) + sun_w_m2 * air_sun_disc(air, d_enu));
            continue;
        }
        const Material *m = &materials->material[material[i]];
        const double n_enu[3] = {hits->n_enu[0][i], hits->n_enu[1][i], hits->n_enu[2][i]};
        const double rho = fmin(m->rho[channel] * texture[i], 1);
        const double n_sun = shadow[i] ? 0 : fmax(v3_dot(n_enu, sun_d_enu), 0);
        const double faces_sky = 0.5 * (1 + n_enu[2]);
        const double irradiance_w_m2 = sun_w_m2 * n_sun + sky_w_m2 * faces_sky + ground_w_m2 * (1 - faces_sky);

        double radiance;
        const double gloss_rho = rho * m->gloss;
        if (!(gloss_rho > 0)) {
            radiance = rho * irradiance_w_m2 / pi_rad;
        } else {
            const double n_eye = fmax(-v3_dot(n_enu, d_enu), 0);
            const double fresnel = material_fresnel(gloss_rho, m->roughness, n_eye);
            /* what the lobe takes at grazing angles the diffuse share gives up: their sum never passes 1 */
            const double left = gloss_rho < 1 ? (1 - fresnel) / (1 - gloss_rho) : 0;
            radiance = (rho - gloss_rho) * left * irradiance_w_m2 / pi_rad;

            double mirror_enu[3];
            v3_add_scaled(mirror_enu, d_enu, 2 * n_eye, n_enu);
            /* a rough lobe near the horizon sees some of both */
            const double sees_sky = clamp(0.5 + 0.5 * mirror_enu[2] / fmax(m->roughness, 0.01), 0, 1);
            double seen = (1 - sees_sky) * ground_w_m2 / pi_rad;
            if (sees_sky > 0) seen += sees_sky * air_sky_optical(air, channel, mirror_enu);
            radiance += fresnel * seen;

            if (n_sun > 0) {
                const double eye_enu[3] = {-d_enu[0], -d_enu[1], -d_enu[2]};
                const double lobe = material_lobe(m->roughness, n_enu, eye_enu, sun_d_enu);
                if (lobe > 0) {
                    /* at the facet: half the angle between eye and sun */
                    const double cosine = sqrt(fmax(0.5 * (1 + v3_dot(eye_enu, sun_d_enu)), 0));
                    radiance += material_fresnel(gloss_rho, m->roughness, cosine) * lobe * sun_w_m2;
                }
            }
        }
        /* air_veil_optical, with the channel's constants taken out of the loop */
        const double tau = exp(-extinction_per_m * hits->range_m[i]);
        out[i] = (float)(radiance * tau + (1 - tau) * horizon_w_m2_sr);
    }
}
