/* render/light/thermal.c: surface temperatures, and their radiance at the aperture.
 *
 * Ground and parts remember (render/heat/heat.h, vehicle_heat.h); leaves are in balance with the sun of the moment.
 *
 * Radiance = emissivity Planck(T) + (1 - emissivity) surroundings + sunlight, each attenuated by the air path
 * according to its own spectrum. In a closed isothermal cavity every surface has the radiance Planck(T), whatever
 * its material (tests/render/test_thermal.c). */

#include "render/light/thermal.h"
#include "render/heat/heat.h"
#include "render/trace/scenery/scenery_tracer.h"
#include "pitviper_simd.h"
#include "pitviper.h"
#include "terrain/weather/weather.h"

/* ---- leaves ---------------------------------------------------------------------------------- */

static const double heat_j_mol_k = 29.3, vapour_j_mol = 44000; /* of air; of water's evaporation */
static const double pressure_pa = 101325;
static const double leaf_m = 0.05, least_wind_mps = 0.3; /* free convection takes over below */

/* What the balance has alike for every leaf of a frame. */
typedef struct LeafAir {
    double direct_w_m2, is_day, diffuse_w_m2, longwave_loss_w_m2, dryness;
    double layer, layer_resistance; /* mol/(m2 s) of heat, one side; m2 s/mol of vapour */
} LeafAir;

static LeafAir leaf_air(const Daylight *light)
{
    const double wind_mps = fmax(light->weather.wind_mps, least_wind_mps);
    const double layer = 1.4 * 0.135 * sqrt(wind_mps / (0.72 * leaf_m));
    return (LeafAir){.direct_w_m2 = light->solar_direct_w_m2,
                     .is_day = light->sun_d_enu[2] > 0,
                     .diffuse_w_m2 = light->solar_diffuse_w_m2,
                     .longwave_loss_w_m2 = light->longwave_loss_w_m2,
                     .dryness = 1 - light->weather.humidity,
                     .layer = layer,
                     .layer_resistance = 1 / (1.09 * layer)};
}

/* Longwave emission of a kelvin more, W/(m2 K): 5 at 288 K. */
static inline double emission_w_m2_k(double emissivity, double temp_k)
{
    return 4 * emissivity * 5.670374419184429e-8 * temp_k * temp_k * temp_k;
}

/* What the temperature of one leaf follows from, as thermal_leaf_k has it. */
typedef struct Leaf {
    double air_k, vapour_pa; /* vapour_pa: saturation over water there */
    double open, lit, absorptance, emissivity;
} Leaf;

static inline double leaf_k(const LeafAir *a, Leaf leaf)
{
    const double sun_w_m2 = leaf.lit * 0.5 * a->direct_w_m2 * a->is_day + leaf.open * a->diffuse_w_m2;
    const double light = sun_w_m2 / 250, full = light < 1 ? light : 1; /* by half of full sunlight */
    const double stomata = 0.2 * (0.05 + 0.95 * full);
    const double vapour = 1 / (1 / stomata + a->layer_resistance);
    /* slope of the saturation, Pa/K: Tetens, as in Campbell & Norman (1998), eq. 3.8 */
    const double c = leaf.air_k - 273.15, slope = leaf.vapour_pa * 17.502 * 240.97 / ((240.97 + c) * (240.97 + c));
    const double gain = leaf.absorptance * sun_w_m2 - leaf.emissivity * a->longwave_loss_w_m2 * leaf.open -
                        vapour_j_mol * vapour * a->dryness * leaf.vapour_pa / pressure_pa;
    const double loss = 2 * heat_j_mol_k * a->layer + 2 * emission_w_m2_k(leaf.emissivity, leaf.air_k) +
                        vapour_j_mol * vapour * slope / pressure_pa;
    return leaf.air_k + gain / loss;
}

static inline double emissivity_of(const Material *m) { return 1 - (double)m->rho_lwir - (double)m->tau_lwir; }

double thermal_leaf_k(const Daylight *light, const Material *m, double air_temp_k, double open, double lit)
{
    const LeafAir a = leaf_air(light);
    return leaf_k(&a, (Leaf){.air_k = air_temp_k,
                             .vapour_pa = weather_saturation_pa(air_temp_k),
                             .open = open,
                             .lit = lit,
                             .absorptance = (double)m->solar_absorptance,
                             .emissivity = emissivity_of(m)});
}

/* Leaves of a block, in arrays. */
typedef struct Leaves {
    int    count, hit[hits_capacity];
    double air_k[hits_capacity], vapour_pa[hits_capacity], open[hits_capacity], lit[hits_capacity];
    double absorptance[hits_capacity], emissivity[hits_capacity], temp_k[hits_capacity];
} Leaves;

static void leaves_add(Leaves *to, int hit, const Material *m, double air_k, double open, double lit)
{
    const int n = to->count++;
    to->hit[n] = hit;
    to->air_k[n] = air_k, to->open[n] = open, to->lit[n] = lit;
    to->absorptance[n] = (double)m->solar_absorptance, to->emissivity[n] = emissivity_of(m);
}

static void leaves_k(float *temp_k, const Daylight *light, Leaves *l)
{
    const LeafAir a = leaf_air(light);
    for (int n = 0; n < l->count; n++) l->vapour_pa[n] = weather_saturation_pa(l->air_k[n]);
    for (int n = 0; n < l->count; n++)
        l->temp_k[n] = leaf_k(
            &a, (Leaf){l->air_k[n], l->vapour_pa[n], l->open[n], l->lit[n], l->absorptance[n], l->emissivity[n]});
    for (int n = 0; n < l->count; n++) temp_k[l->hit[n]] = (float)l->temp_k[n];
}

/* ---- temperature -------------------------------------------------------------------------- */

/* Temperature of a part at a hit, from the patches about it; that of the air where no patch is known. */
static double part_k(const PartTemps *parts, double air_k, const Hits *hits, int i)
{
    const double n_enu[3] = {(double)hits->n_geo[0][i], (double)hits->n_geo[1][i], (double)hits->n_geo[2][i]};
    double       p_node[3], n_node[3];
    if (!parts || !parts->patches || !parts->snapshot->patch_k) return air_k;
    visibility_on_part(p_node, n_node, parts->visibility, hits, i, n_enu);
    const double temp_k =
        patch_set_temp_k(parts->patches, parts->snapshot, (int)hits->entity[i] - 1, hits->part[i] - 1, p_node, n_node);
    return isfinite(temp_k) ? temp_k : air_k;
}

static void outward_normal(double n_enu[3], const Hits *hits, int i)
{
    const double side = hits->inside[i] ? -1 : 1;
    for (int k = 0; k < 3; k++) n_enu[k] = side * (double)hits->n_geo[k][i];
}

bool thermal_scenery_of(SceneryHeatOf *out, const Air *air, const Visibility *visibility, const Hits *hits, int i)
{
    const SceneryFrame *scenery = scenery_frame_in(visibility);
    double              n_enu[3], p_body[3], n_body[3];
    if (!air->heat || !air->heat->scenery || !scenery) return false;
    outward_normal(n_enu, hits, i);
    scenery_frame_on_body(p_body, n_body, scenery, hits, i, n_enu);
    scenery_heat_of(out, air->heat->scenery, (int)hits->instance[i] - 1, hits->part[i] - 1, p_body, n_enu);
    return true;
}

/* Temperature of scenery at a hit, over the air of its height; that of the air where none is known. */
static double scenery_k(const Air *air, const SceneryFrame *scenery, double air_k, const Hits *hits, int i)
{
    double n_enu[3], p_body[3], n_body[3];
    if (!air->heat || !air->heat->scenery || !scenery) return air_k;
    outward_normal(n_enu, hits, i);
    scenery_frame_on_body(p_body, n_body, scenery, hits, i, n_enu);
    const double temp_k =
        scenery_temp_k(air->heat->scenery, (int)hits->instance[i] - 1, hits->part[i] - 1, p_body, n_enu);
    return isfinite(temp_k) ? temp_k + air_k - air->light.weather.air_temp_k : air_k;
}

/* Temperature of the air at eight hits: straight between the nodes, as air_temp_at. */
static F32x8 air_k8(const Air *air, const Hits *hits, int first)
{
    const F32x8 x = f32x8_of_doubles(hits->p_enu[0] + first), y = f32x8_of_doubles(hits->p_enu[1] + first);
    const F32x8 level = f32x8_of_doubles(hits->p_enu[2] + first) - f32x8_set(air->light.zero_z_m);
    const F32x8 height_m = f32x8_fma(f32x8_fma(x, x, y * y), f32x8_set(1 / (2 * 6371e3)), level);
    const F32x8 at = f32x8_clamp(height_m * f32x8_set(1 / air_warmer_step_m), air_warmer_low, air_warmer_nodes - 1);
    const I32x8 node = i32x8_truncate(f32x8_clamp(at, 0, air_warmer_nodes - 2));
    const F32x8 low = f32x8_gather(air->light.warmer_k, node), high = f32x8_gather(air->light.warmer_k + 1, node);
    return f32x8_lerp(low, high, at - f32x8_of_ints(node)) + f32x8_set(air->light.weather.air_temp_k);
}

/* Temperature of wood at a hit, by the sun of the day (air->heat; where that is NULL, it is as warm as the air). */
static double wood_k(const Air *air, int material, double air_k, const Hits *hits, int i)
{
    const double n[3] = {(double)hits->n_enu[0][i], (double)hits->n_enu[1][i], (double)hits->n_enu[2][i]};
    if (!air->heat || air->heat->now->branches == 0) return air_k;
    return heat_branch_k(air->heat->now, material, (double)hits->radius_m[i], n, (double)hits->open_up[i]) + air_k -
           air->light.weather.air_temp_k;
}

/* Replaces the air temperature that temp_k holds at the listed hits by that of the ground; with the class's noise in
 * kelvins (etc/ground_detail.csv), twice that of the night where the sun has lifted it by 16 K, an estimate. The noise
 * stands for what differs within a class: moisture, cover, reflectance. Darkness is therefore taken from the photograph
 * alone, which shows what the noise does not contain: half of its relative brightness becomes relative absorptance (a
 * guess), within 0.6 .. 1.4. Snow is no warmer than it melts, the sea no colder than it freezes. */
static void grounds_k(float *temp_k, const Air *air, const Hits *hits, const int *list, int count, const float *photo,
                      const float *warmth_k)
{
    static const double melts_k = 273.15, sea_freezes_k = 271.35;
    for (int first = 0; first < count; first += heat_lanes) {
        const int    some = count - first < heat_lanes ? count - first : heat_lanes;
        GroundPlaces at;
        double       here_k[heat_lanes], lifted_k[heat_lanes];
        for (int k = 0; k < heat_lanes; k++) {
            const int i = list[first + (k < some ? k : 0)];
            for (int c = 0; c < 3; c++) at.p_enu[c][k] = hits->p_enu[c][i], at.n_enu[c][k] = (double)hits->n_enu[c][i];
            at.surface[k] = hits->surface[i];
            at.dark[k] = 1.5 - 0.5 * clamp((double)photo[i], 0.6, 1.4);
        }
        heat_scene_grounds_k(here_k, lifted_k, air->heat, &at);
        for (int k = 0; k < some; k++) {
            const int i = list[first + k];
            double    ground_k = here_k[k] + ((double)temp_k[i] - air->light.weather.air_temp_k);
            ground_k += (double)warmth_k[i] * (1 + lifted_k[k] / 16);
            if (hits->surface[i] == SURFACE_SNOW && !(ground_k < melts_k)) ground_k = melts_k;
            if (hits->surface[i] == SURFACE_WATER && !(ground_k > sea_freezes_k)) ground_k = sea_freezes_k;
            temp_k[i] = (float)ground_k;
        }
    }
}

void thermal_temperature(float *temp_k, const Air *air, const Materials *materials, const PartTemps *parts,
                         const Hits *hits, const uint16_t *material, const float *sun, const float *photo,
                         const float *warmth_k)
{
    const SceneryFrame *scenery = parts ? scenery_frame_in(parts->visibility) : NULL;
    int                 ground[hits_capacity], grounds = 0;
    Leaves              leaves;
    leaves.count = 0;
    for (int first = 0; first < hits->count; first += 8) {
        const int some = hits->count - first < 8 ? hits->count - first : 8;
        float     air_k[8];
        f32x8_store(air_k, air_k8(air, hits, first));
        for (int k = 0; k < some; k++) {
            const int       i = first + k;
            const double    here_k = (double)air_k[k];
            const Material *m = &materials->material[material[i]];
            if (!(hits->range_m[i] < INFINITY)) {
                temp_k[i] = NAN;
            } else if (hits->kind[i] == hit_plant && material_is_leaf(m)) {
                const double open = (double)hits->open_up[i];
                leaves_add(&leaves, i, m, here_k, open, sun ? (double)sun[i] : open);
            } else if (hits->kind[i] == hit_plant) {
                temp_k[i] = (float)wood_k(air, material[i], here_k, hits, i);
            } else if (hits->kind[i] == hit_scenery) {
                temp_k[i] = (float)scenery_k(air, scenery, here_k, hits, i);
            } else if (hits->entity[i]) {
                temp_k[i] = (float)part_k(parts, here_k, hits, i);
            } else if (!air->heat || hits->surface[i] == SURFACE_NONE) {
                temp_k[i] = (float)(here_k + (double)warmth_k[i]);
            } else {
                temp_k[i] = air_k[k];
                ground[grounds++] = i;
            }
        }
    }
    leaves_k(temp_k, &air->light, &leaves);
    grounds_k(temp_k, air, hits, ground, grounds, photo, warmth_k);
}

/* ---- radiance ----------------------------------------------------------------------------- */

float thermal_beyond(Band band, const Air *air, const double d_enu[3], const AirPaths *v, int i)
{
    const AirBand air_band = band == BAND_MWIR ? AIR_MWIR : AIR_LWIR;
    double        seen = air->light.ground_w_m2_sr[air_band] * v->air_transmittance[i] + v->added_w_m2_sr[i];
    if (band == BAND_MWIR && !(v->range_m[i] < INFINITY))
        seen += air->sun_eye_w_m2[AIR_MWIR] * daylight_sun_disc(&air->light, d_enu);
    return (float)seen;
}

void thermal_shade(float *out, Band band, const Air *air, const Materials *materials, const Hits *hits,
                   const Rays *rays, const uint16_t *material, const float *temp_k, const float *sun,
                   const float *around_w_m2, const MirrorLight *mirror, const AirPaths *veils, const Facing *facing)
{
    const bool         mwir = band == BAND_MWIR;
    const AirBand      air_band = mwir ? AIR_MWIR : AIR_LWIR;
    const PlanckTable *planck = mwir ? air->light.planck_mwir : air->light.planck_lwir;
    const double       ground_w_m2_sr = air->light.ground_w_m2_sr[air_band];
    /* the sun's share of 8-12 um is below a thousandth of what the scene emits, and left out */
    const double sun_w_m2 = mwir ? air->light.sun_w_m2[AIR_MWIR] : 0;
    AirPaths     own;
    if (!veils) air_path(&own, air, air_band, hits, rays, temp_k);
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
            out[i] = thermal_beyond(band, air, d_enu, v, i);
            continue;
        }
        const Material *m = &materials->material[material[i]];
        const double    n_enu[3] = {hits->n_enu[0][i], hits->n_enu[1][i], hits->n_enu[2][i]};
        const double    n_eye = fmax(-v3_dot(n_enu, d_enu), 0);
        double          diffuse, lobe_rho;
        material_split(&diffuse, &lobe_rho, mwir ? m->rho_mwir : m->rho_lwir, m->gloss, m->roughness, n_eye);

        /* Kirchhoff, at this angle: emissivity = 1 - reflectance */
        const double tau = mwir ? m->tau_mwir : m->tau_lwir;
        const double emitted = (1 - diffuse - lobe_rho - tau) * planck_table_radiance(planck, temp_k[i]);
        /* diffuse: sky and ground as far as the surface faces them; gloss: the mirror direction */
        const double around = around_w_m2 ? around_w_m2[i] / pi_rad
                                          : daylight_plane_there(&air->light, air_band, &facing->plane[i]) / pi_rad +
                                                ground_w_m2_sr * 0.5 * (1 - n_enu[2]);
        double       reflected = diffuse * around;
        if (tau > 0 && !around_w_m2)
            reflected += tau / pi_rad * daylight_far_side(&air->light, air_band, n_enu, ground_w_m2_sr * pi_rad);
        if (lobe_rho > 0) {
            double mirror_enu[3];
            v3_add_scaled(mirror_enu, d_enu, 2 * n_eye, n_enu);
            const double sees_sky = clamp(0.5 + 0.5 * mirror_enu[2] / fmax(m->roughness, 0.01), 0, 1);
            const double sky = daylight_sky_there(&air->light.sky[air_band], &facing->mirror[i]) *
                               (mirror_sky ? (double)mirror_sky[i] : 1);
            const double ground = ground_w_m2_sr * (mirror_below ? (double)mirror_below[i] : 1);
            reflected += lobe_rho * (sees_sky * sky + (1 - sees_sky) * ground);
        }
        double       sunlit = 0;
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
