/* render/light/thermal.c: surface temperatures, and their radiance at the aperture.
 *
 * Temperatures follow exposure, not the present shadow: a surface takes the sunlight its slope would get unobstructed,
 * in steady balance with the wind of the moment. Layered conduction with a history of shadow is not modelled.
 *
 * Radiance = emissivity Planck(T) + (1 - emissivity) surroundings + sunlight, each attenuated by the air path
 * according to its own spectrum. In a closed isothermal cavity every surface has the radiance Planck(T), whatever
 * its material (tests/render/test_thermal.c). */
#include "render/light/thermal.h"

#include "render/light/plant_heat.h"
#include "render/materials/surface_balance.h"
#include "pitviper_simd.h"

/* ---- temperature -------------------------------------------------------------------------- */

/* A part without a heat source of its own. Steel conducts and holds heat for an hour, so every face shares in the
 * heat of the whole: 0.3 of the sun on level ground for a face that faces down, 0.7 for one that faces up (a guess,
 * that puts a green tank at 10 .. 20 K above the air at noon and keeps a turning vehicle from reversing its
 * temperatures). */
static double passive_part_k(const Air *air, double air_temp_k, const Material *material, double n_up,
                             double sun_level_w_m2, double film)
{
    const double emissivity = 1 - material->rho_lwir;
    const double up = 0.5 * (1 + n_up);
    const double gain_w_m2 = material->solar_absorptance * sun_level_w_m2 * (0.3 + 0.4 * up) -
                             emissivity * air->light.longwave_loss_w_m2 * up;
    return air_temp_k + gain_w_m2 / (film + emission_w_m2_k(emissivity, air_temp_k));
}

/* Constants of a class: its excess in this wind, and the temperatures between which it is valid. */
typedef struct GroundDay {
    float rise_k[SURFACE_COUNT], fall_k[SURFACE_COUNT], least_k[SURFACE_COUNT], most_k[SURFACE_COUNT];
} GroundDay;

static void ground_day(GroundDay *out, const Air *air, const Materials *materials)
{
    static const double melts_k = 273.15, sea_freezes_k = 271.35;
    for (int s = 0; s < SURFACE_COUNT; s++) {
        const Material *m = &materials->material[materials->surface[s]];
        const double    other = emission_w_m2_k(1 - m->rho_lwir, air->light.weather.air_temp_k) +
                             daily_wave_w_m2_k(m->conductivity_w_mk, m->density_kg_m3, m->heat_capacity_j_kgk);
        const double share = ground_heat_share(air->light.weather.wind_mps, other);
        out->rise_k[s]  = (float)(share * materials->ground_rise_k[s]);
        out->fall_k[s]  = (float)(share * materials->ground_fall_k[s]);
        out->least_k[s] = s == SURFACE_WATER ? (float)sea_freezes_k : 0;
        out->most_k[s]  = s == SURFACE_SNOW ? (float)melts_k : INFINITY;
    }
}

/* Temperature of the air at eight hits: straight between the nodes, as air_temp_at. */
static F32x8 air_k8(const Air *air, const Hits *hits, int first)
{
    const F32x8    x = f32x8_of_doubles(hits->p_enu[0] + first), y = f32x8_of_doubles(hits->p_enu[1] + first);
    const F32x8    level = f32x8_of_doubles(hits->p_enu[2] + first) - f32x8_set(air->light.zero_z_m);
    const F32x8    height_m = f32x8_fma(f32x8_fma(x, x, y * y), f32x8_set(1 / (2 * 6371e3)), level);
    const F32x8    at = f32x8_clamp(height_m * f32x8_set(1 / air_warmer_step_m), air_warmer_low, air_warmer_nodes - 1);
    const I32x8 node = i32x8_truncate(f32x8_clamp(at, 0, air_warmer_nodes - 2));
    const F32x8    low = f32x8_gather(air->light.warmer_k, node), high = f32x8_gather(air->light.warmer_k + 1, node);
    return f32x8_lerp(low, high, at - f32x8_of_ints(node)) + f32x8_set(air->light.weather.air_temp_k);
}

/* Ground by class, with the sun on its own slope, and the class's noise in kelvins (etc/ground_detail.csv; by day the
 * sun makes it stronger: twice that of the night at 800 W/m2, an estimate). The noise stands for all that differs
 * within a class: moisture, cover, conduction, reflectance; once heat is computed from such properties they replace
 * it, and never are both added. Darkness is therefore taken from the photograph alone, which shows what the noise does
 * not contain: half of its relative brightness becomes relative warmth (a guess), within 0.6 .. 1.4, since a white
 * roof is six times as bright as its class's mean, and by that relation would be colder than the air at noon. Eight
 * hits at once, within 3e-5 K; what is not ground becomes air. */
static void ground_k8(float temp_k[8], const Air *air, const GroundDay *day, F32x8 air_k, const uint8_t surface[8],
                      const float *const n_enu[3], const float photo[8], const float warmth_k[8])
{
    const I32x8 class = i32x8_of_bytes(surface);
    const F32x8    along = f32x8_fma(f32x8_load(n_enu[0]), f32x8_set(air->light.sun_d_enu[0]),
                                     f32x8_fma(f32x8_load(n_enu[1]), f32x8_set(air->light.sun_d_enu[1]),
                                               f32x8_load(n_enu[2]) * f32x8_set(air->light.sun_d_enu[2])));
    const F32x8 rise = f32x8_gather(day->rise_k, class), fall = f32x8_gather(day->fall_k, class);
    const F32x8 level = (f32x8_set(1) + f32x8_load(n_enu[2])) * f32x8_set(0.5 * air->light.solar_diffuse_w_m2);
    const F32x8 slope_kw_m2 =
        f32x8_fma(f32x8_max(along, f32x8_set(0)), f32x8_set(air->light.solar_direct_w_m2), level) * f32x8_set(1e-3);
    const F32x8 dark = f32x8_set(1.5) - f32x8_set(0.5) * f32x8_clamp(f32x8_load(photo), 0.6, 1.4);
    const F32x8 noise_k = f32x8_load(warmth_k) * f32x8_fma(slope_kw_m2, f32x8_set(1.25), f32x8_set(1));
    const F32x8 above = noise_k + f32x8_fma(rise * slope_kw_m2, dark, fall * f32x8_set(-1e-2 *
                                                                                       air->light.longwave_loss_w_m2));
    const F32x8 least = f32x8_gather(day->least_k, class), most = f32x8_gather(day->most_k, class);
    f32x8_store(temp_k, f32x8_min(f32x8_max(above + air_k, least), most));
}

void thermal_temperature(float *temp_k, const Air *air, const Materials *materials, const Catalog *catalog,
                         const Snapshot *snapshot, const Hits *hits, const uint16_t *material, const float *photo,
                         const float *warmth_k)
{
    const double sun_level_w_m2 = air->light.solar_direct_w_m2 * fmax(air->light.sun_d_enu[2], 0) + air->light.solar_diffuse_w_m2;
    const double film = film_w_m2_k(air->light.weather.wind_mps);
    GroundDay    day;
    ground_day(&day, air, materials);

    for (int first = 0; first < hits->count; first += 8) {
        const float *const n_enu[3] = {hits->n_enu[0] + first, hits->n_enu[1] + first, hits->n_enu[2] + first};
        const int          some = hits->count - first < 8 ? hits->count - first : 8;
        uint8_t            surface[8] = {0};
        float              found[8], air_k[8];
        for (int k = 0; k < some; k++)
            surface[k] = hits->surface[first + k] < SURFACE_COUNT ? hits->surface[first + k] : SURFACE_NONE;
        const F32x8 there_k = air_k8(air, hits, first);
        f32x8_store(air_k, there_k);
        ground_k8(found, air, &day, there_k, surface, n_enu, photo + first, warmth_k + first);
        for (int k = 0; k < some; k++) {
            const int i = first + k;
            temp_k[i] = found[k];
            if (!(hits->range_m[i] < INFINITY)) {
                temp_k[i] = NAN;
            } else if (hits->kind[i] == hit_plant) {
                const Material *m = &materials->material[material[i]];
                const double    n[3] = {hits->n_enu[0][i], hits->n_enu[1][i], hits->n_enu[2][i]};
                temp_k[i] = (float)(m->tau[optical_channel_nir] > 0
                                        ? leaf_temp_k(&air->light, m, (double)air_k[k], (double)hits->open_up[i])
                                        : bark_temp_k(&air->light, m, (double)air_k[k], n, (double)hits->radius_m[i],
                                                      (double)hits->open_up[i]));
            } else if (hits->entity[i]) {
                const HeatRole  role = catalog_model(catalog, hits->model[i])->part[hits->part[i] - 1].role;
                const double    above_k = snapshot->entity[hits->entity[i] - 1].heat[role];
                const Material *m = &materials->material[material[i]];
                temp_k[i] = (float)(passive_part_k(air, (double)air_k[k], m, (double)hits->n_enu[2][i], sun_level_w_m2,
                                                  film) + above_k);
            }
        }
    }
}

/* ---- radiance ----------------------------------------------------------------------------- */

float thermal_beyond(Band band, const Air *air, const double d_enu[3], const AirPaths *v, int i)
{
    const AirBand air_band = band == BAND_MWIR ? AIR_MWIR : AIR_LWIR;
    double seen = air->light.ground_w_m2_sr[air_band] * v->air_transmittance[i] + v->added_w_m2_sr[i];
    if (band == BAND_MWIR && !(v->range_m[i] < INFINITY)) seen += air->sun_eye_w_m2[AIR_MWIR] * daylight_sun_disc(&air->light, d_enu);
    return (float)seen;
}

void thermal_shade(float *out, Band band, const Air *air, const Materials *materials, const Hits *hits,
                   const Rays *rays, const uint16_t *material, const float *temp_k, const float *sun,
                   const float *around_w_m2, const AirPaths *veils, const Facing *facing)
{
    const bool mwir = band == BAND_MWIR;
    const AirBand air_band = mwir ? AIR_MWIR : AIR_LWIR;
    const PlanckTable *planck = mwir ? air->light.planck_mwir : air->light.planck_lwir;
    const double ground_w_m2_sr = air->light.ground_w_m2_sr[air_band];
    /* the sun's share of 8-12 um is below a thousandth of what the scene emits, and left out */
    const double sun_w_m2 = mwir ? air->light.sun_w_m2[AIR_MWIR] : 0;
    AirPaths own;
    if (!veils) air_path(&own, air, air_band, hits, rays, temp_k);
    const AirPaths *v = veils ? veils : &own;
    Facing found;
    if (!facing) {
        daylight_facing(&found, &air->light, materials, hits, rays, material);
        facing = &found;
    }

    for (int i = 0; i < hits->count; i++) {
        const double d_enu[3] = {rays->d_enu[0][i], rays->d_enu[1][i], rays->d_enu[2][i]};
        if (!(hits->range_m[i] < INFINITY)) {
            out[i] = thermal_beyond(band, air, d_enu, v, i);
            continue;
        }
        const Material *m = &materials->material[material[i]];
        const double n_enu[3] = {hits->n_enu[0][i], hits->n_enu[1][i], hits->n_enu[2][i]};
        const double n_eye = fmax(-v3_dot(n_enu, d_enu), 0);
        double diffuse, lobe_rho;
        material_split(&diffuse, &lobe_rho, mwir ? m->rho_mwir : m->rho_lwir, m->gloss, m->roughness, n_eye);

        /* Kirchhoff, at this angle: emissivity = 1 - reflectance */
        const double tau = mwir ? m->tau_mwir : m->tau_lwir;
        const double emitted = (1 - diffuse - lobe_rho - tau) * planck_table_radiance(planck, temp_k[i]);
        /* diffuse: sky and ground as far as the surface faces them; gloss: the mirror direction */
        const double around = around_w_m2 ? around_w_m2[i] / pi_rad
                                          : daylight_plane_there(&air->light, air_band, &facing->plane[i]) / pi_rad +
                                                ground_w_m2_sr * 0.5 * (1 - n_enu[2]);
        double reflected = diffuse * around;
        if (tau > 0 && !around_w_m2)
            reflected += tau / pi_rad * daylight_far_side(&air->light, air_band, n_enu, ground_w_m2_sr * pi_rad);
        if (lobe_rho > 0) {
            double mirror_enu[3];
            v3_add_scaled(mirror_enu, d_enu, 2 * n_eye, n_enu);
            const double sees_sky = clamp(0.5 + 0.5 * mirror_enu[2] / fmax(m->roughness, 0.01), 0, 1);
            const double sky = daylight_sky_there(&air->light.sky[air_band], &facing->mirror[i]);
            reflected += lobe_rho * (sees_sky * sky + (1 - sees_sky) * ground_w_m2_sr);
        }
        double sunlit = 0;
        const double lit = sun ? (double)sun[i] : 1;
        if (sun_w_m2 > 0 && lit > 0) {
            const double n_sun = v3_dot(n_enu, air->light.sun_d_enu);
            if (n_sun > 0) {
                sunlit = diffuse * n_sun / pi_rad;
                if (lobe_rho > 0) {
                    const double eye_enu[3] = {-d_enu[0], -d_enu[1], -d_enu[2]};
                    const double cosine = sqrt(fmax(0.5 * (1 + v3_dot(eye_enu, air->light.sun_d_enu)), 0));
                    sunlit += material_fresnel((mwir ? m->rho_mwir : m->rho_lwir) * m->gloss, m->roughness, cosine) *
                              material_lobe(m->roughness, n_enu, eye_enu, air->light.sun_d_enu);
                }
                sunlit *= sun_w_m2 * lit;
            } else if (tau > 0) {
                sunlit = tau * -n_sun / pi_rad * sun_w_m2 * lit;
            }
        }
        out[i] = (float)(emitted * v->transmittance[i] + reflected * v->air_transmittance[i] +
                         sunlit * v->sun_transmittance[i] + v->added_w_m2_sr[i]);
    }
}
