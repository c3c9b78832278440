/* render/light/optical.c: sunlight and skylight at the aperture: reflected by the surface hit, then attenuated by the
 * air.
 *
 * A surface reflects diffusely and, as far as it is glossy, in a lobe: the sun by its own width, the sky by the
 * mirror direction. Without hemisphere sampling, sky and ground light every surface according to its tilt alone, and
 * nearby objects do not hide them; a mirror shows sky or ground, as bright as its neighbours leave them. */
#include "render/light/optical.h"

double optical_ground_w_m2(int channel, const Air *air, const Materials *materials)
{
    return materials->ground_rho[channel] *
           (air->light.sun_w_m2[channel] * fmax(air->light.sun_d_enu[2], 0) + air->light.sky_w_m2[channel]);
}

void optical_white(double w_m2_sr[3], const Air *air)
{
    static const AirBand rgb[3] = {AIR_R, AIR_G, AIR_B};
    for (int c = 0; c < 3; c++)
        w_m2_sr[c] =
            (air->light.sun_w_m2[rgb[c]] * fmax(air->light.sun_d_enu[2], 0) + air->light.sky_w_m2[rgb[c]]) / pi_rad;
}

float optical_beyond(int channel, const Air *air, double ground_w_m2, const double d_enu[3], const AirPaths *v, int i)
{
    double seen = ground_w_m2 / pi_rad * v->sun_transmittance[i] + v->added_w_m2_sr[i];
    if (!(v->range_m[i] < INFINITY)) seen += air->sun_eye_w_m2[channel] * daylight_sun_disc(&air->light, d_enu);
    return (float)seen;
}

void optical_shade(float *out, int channel, const Air *air, const Materials *materials, const Hits *hits,
                   const Rays *rays, const uint16_t *material, const float *texture, const float *sun,
                   const float *around_w_m2, const MirrorLight *mirror, const AirPaths *veils, const Facing *facing)
{
    const AirBand band = (AirBand)channel;
    const double *sun_d_enu = air->light.sun_d_enu, sun_w_m2 = air->light.sun_w_m2[channel];
    const double  ground_w_m2 = optical_ground_w_m2(channel, air, materials);
    AirPaths      own;
    if (!veils) air_path(&own, air, band, hits, rays, NULL);
    const AirPaths *v = veils ? veils : &own;
    const float    *mirror_sky = mirror ? mirror->sky : NULL, *mirror_below = mirror ? mirror->below : NULL;
    Facing          found;
    if (!facing) {
        daylight_facing(&found, &air->light, materials, hits, rays, material);
        facing = &found;
    }

    for (int i = 0; i < hits->count; i++) {
        const double d_enu[3] = {rays->d_enu[0][i], rays->d_enu[1][i], rays->d_enu[2][i]};
        if (!(hits->range_m[i] < INFINITY)) {
            out[i] = optical_beyond(channel, air, ground_w_m2, d_enu, v, i);
            continue;
        }
        const Material *m = &materials->material[material[i]];
        const double    n_enu[3] = {hits->n_enu[0][i], hits->n_enu[1][i], hits->n_enu[2][i]};
        double          rho = fmin(m->rho[channel] * texture[i], 1), tau = 0;
        if (m->tau[channel] > 0) { /* a bright leaf returns no more than it gets */
            const double bright = fmin(texture[i], 1 / ((double)m->rho[channel] + (double)m->tau[channel]));
            rho = m->rho[channel] * bright, tau = m->tau[channel] * bright;
        }
        const double lit = sun ? (double)sun[i] : 1, n_sun = lit > 0 ? fmax(v3_dot(n_enu, sun_d_enu), 0) : 0;
        const double around = around_w_m2 ? around_w_m2[i]
                                          : daylight_plane_there(&air->light, band, &facing->plane[i]) +
                                                ground_w_m2 * 0.5 * (1 - n_enu[2]);
        const double irradiance_w_m2 = sun_w_m2 * n_sun * lit + around;

        double radiance;
        if (!(m->gloss > 0)) {
            radiance = rho * irradiance_w_m2 / pi_rad;
            if (tau > 0) { /* a leaf: what falls on its far side shines through */
                const double behind = around_w_m2 ? 0 : daylight_far_side(&air->light, band, n_enu, ground_w_m2);
                radiance += tau / pi_rad * (sun_w_m2 * lit * fmax(-v3_dot(n_enu, sun_d_enu), 0) + behind);
            }
        } else {
            const double n_eye = fmax(-v3_dot(n_enu, d_enu), 0);
            double       diffuse, lobe_rho;
            const bool   pane = material_is_pane(m);
            if (pane) diffuse = 0, lobe_rho = material_pane(rho, m->roughness, n_eye);
            else material_split(&diffuse, &lobe_rho, rho, m->gloss, m->roughness, n_eye);
            radiance = diffuse * irradiance_w_m2 / pi_rad;

            double mirror_enu[3];
            v3_add_scaled(mirror_enu, d_enu, 2 * n_eye, n_enu);
            /* a rough lobe near the horizon includes some of both */
            const double sees_sky = clamp(0.5 + 0.5 * mirror_enu[2] / fmax(m->roughness, 0.01), 0, 1);
            double       seen = (1 - sees_sky) * ground_w_m2 / pi_rad * (mirror_below ? (double)mirror_below[i] : 1);
            if (sees_sky > 0)
                seen += sees_sky * daylight_sky_there(&air->light.sky[band], &facing->mirror[i]) *
                        (mirror_sky ? (double)mirror_sky[i] : 1);
            radiance += lobe_rho * seen;

            if (n_sun > 0) {
                const double eye_enu[3] = {-d_enu[0], -d_enu[1], -d_enu[2]};
                const double lobe = material_lobe(m->roughness, n_enu, eye_enu, sun_d_enu);
                if (lobe > 0) {
                    /* at the facet: half the angle between eye and sun */
                    const double cosine = sqrt(fmax(0.5 * (1 + v3_dot(eye_enu, sun_d_enu)), 0));
                    const double mirrors = pane ? material_pane(rho, m->roughness, cosine)
                                                : material_fresnel(rho * m->gloss, m->roughness, cosine);
                    radiance += mirrors * lobe * sun_w_m2 * lit;
                }
            }
        }
        out[i] = (float)(radiance * v->sun_transmittance[i] + v->added_w_m2_sr[i]);
    }
}
