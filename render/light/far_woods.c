/* render/light/far_woods.c: shows the ground of distant woods as their canopy (far_woods.h). */
#include "render/light/far_woods.h"

#include "render/heat/heat.h"
#include "render/light/optical.h"
#include "render/light/thermal.h"

#include <stdio.h>
#include <stdlib.h>

static const SurfaceClass class_of[far_stands] = {SURFACE_FOREST_BROADLEAF, SURFACE_FOREST_CONIFER};
static const double       density_of[far_densities] = {0.4, 1.2}, hides = 2.5;

/* ---- once ------------------------------------------------------------------------------------- */

/* Half of what leaves scatter, as the row's reflectance: the tables say what is seen against it. */
static Material row_of(const WoodStand *stand)
{
    Material m = stand->leaf;
    for (int c = 0; c < optical_channel_count; c++)
        m.rho[c] = fmaxf(0.5f * (stand->leaf.rho[c] + stand->leaf.tau[c]), 0.01f), m.tau[c] = 0;
    m.rho_mwir = 0.5f * (m.rho_mwir + m.tau_mwir), m.rho_lwir = 0.5f * (m.rho_lwir + m.tau_lwir);
    m.tau_mwir = m.tau_lwir = m.gloss = 0;
    m.roughness = 1;
    return m;
}

static Status add_rows(FarWoods *far, Materials *materials)
{
    Material *larger = realloc(materials->material, (size_t)(materials->count + far_stands) * sizeof *larger);
    if (!larger) return STATUS_NO_MEMORY;
    materials->material = larger, materials->more = far_stands;
    for (int k = 0; k < far_stands; k++) {
        far->row[k] = materials->count + k;
        larger[far->row[k]] = row_of(far->stand[k][far_densities - 1]);
        snprintf(larger[far->row[k]].name, sizeof larger->name, "canopy_of_%s", k ? "conifers" : "broadleaves");
    }
    return STATUS_OK;
}

/* Everything that the stands follow from, beside their classes and densities, which are the program's. */
static CacheKey key_of(const Forest *forest, const Materials *materials, bool leaves, const PlantsKept *kept)
{
    const ForestConfig config = forest_config(forest);
    const double       number[] = {leaves,      config.leaves,   config.level1_px, config.sway,
                                   config.fine, config.all_fine, config.tables};
    char               path[512], sha256[sha256_text_size] = "";
    CacheKey           key = cache_key("stands of far woods");
    if (!etc_path(path, sizeof path, "woods.csv") || sha256_file(sha256, path) != STATUS_OK) key.good = false;
    cache_key_add(&key, kept->name, strlen(kept->name));
    cache_key_add(&key, sha256, sizeof sha256);
    cache_key_add(&key, number, sizeof number);
    canopy_key_add_plants(&key, materials);
    return key;
}

typedef struct StandsKept {
    FarWoods *far;
    int       rows;
} StandsKept;

static void values(Kept *kept, void *user)
{
    const StandsKept *s = user;
    for (int k = 0; k < far_stands * far_densities; k++)
        far_stand_kept_values(kept, &(StandKept){s->far->stand[k / far_densities][k % far_densities], s->rows});
}

static void free_stands(FarWoods *far)
{
    for (int k = 0; k < far_stands * far_densities; k++) {
        far_stand_destroy(far->stand[k / far_densities][k % far_densities]);
        far->stand[k / far_densities][k % far_densities] = NULL;
    }
}

static bool fetch(FarWoods *far, int rows, Cache *cache, CacheKey *key)
{
    for (int k = 0; k < far_stands * far_densities; k++)
        if (far_stand_create_bare(&far->stand[k / far_densities][k % far_densities]) != STATUS_OK) return false;
    return kept_fetch(values, &(StandsKept){far, rows}, cache, key);
}

Status far_woods_create(FarWoods **out, const Woods *woods, const Forest *forest, Materials *materials, bool leaves,
                        const PlantsKept *kept, Pool *pool)
{
    *out = NULL;
    if (!woods->low) return STATUS_OK;
    CacheKey  key = {.digest = NULL};
    FarWoods *far = calloc(1, sizeof *far);
    Status    status = far ? STATUS_OK : STATUS_NO_MEMORY;
    bool      there = false;
    if (far && kept->cache) {
        key = key_of(forest, materials, leaves, kept);
        there = fetch(far, materials->count, kept->cache, &key);
        if (!there) free_stands(far);
    }
    for (int k = 0; k < far_stands * far_densities && status == STATUS_OK && !there; k++)
        status = far_stand_create(&far->stand[k / far_densities][k % far_densities], class_of[k / far_densities],
                                  density_of[k % far_densities], forest, materials, leaves, pool);
    if (status == STATUS_OK && !there) kept_keep(values, &(StandsKept){far, materials->count}, kept->cache, &key);
    if (status == STATUS_OK) status = add_rows(far, materials);
    if (status == STATUS_OK) far->woods = woods, *out = far;
    else far_woods_destroy(far);
    return status;
}

void far_woods_destroy(FarWoods *far)
{
    if (!far) return;
    free_stands(far);
    free(far);
}

double far_woods_top_m(const FarWoods *far, int stand) { return far->stand[stand][far_densities - 1]->top_m; }

/* ---- once a frame: light ---------------------------------------------------------------------- */

/* The place among the tables of this sun, and what falls on a tilted plane for each view. */
typedef struct Sunlight {
    const Air       *air;
    const Materials *materials;
    double           sin_sun, sun_share;
    int              sun; /* lower node */
} Sunlight;

/* One view and azimuth. */
typedef struct Look {
    const WoodStand *stand;
    const StandView *view;
    StandLit         lit;
    CanopyPlace      among, on_ground;
    double           through;      /* of the direct sun, to the ground that is seen, by the heat's map */
    double           n_leaf[2][3]; /* mean normals of leaves: of the side that is seen, of the other one */
    double           n_bark[3];
} Look;

static double between(double low, double high, double share) { return low + share * (high - low); }

static void place_between(CanopyPlace *out, const CanopyPlace *p, double share)
{
    *out = (CanopyPlace){.up = between(p[0].up, p[1].up, share),
                         .down = between(p[0].down, p[1].down, share),
                         .up_from_ground = between(p[0].up_from_ground, p[1].up_from_ground, share),
                         .sun_here = between(p[0].sun_here, p[1].sun_here, share),
                         .sun_on_ground = between(p[0].sun_on_ground, p[1].sun_on_ground, share)};
}

/* The mean of normals that lean towards the eye. */
static void normal_of(double n[3], const double mean[2], double azimuth_rad)
{
    const double raw[3] = {mean[0] * cos(azimuth_rad), mean[0] * sin(azimuth_rad), mean[1]};
    if (!v3_normalize(n, raw)) n[0] = n[1] = 0, n[2] = 1;
}

/* Thickets shade glades, which stands that are everywhere as dense lack: found beside planted woods (test_far_woods.c).
 */
static double past_thickets(double sin_sun)
{
    static const double takes = 0.015;
    return sin_sun > 0 ? exp(-takes * sqrt(1 - fmin(sin_sun * sin_sun, 1)) / sin_sun) : 1;
}

static Look look_of(const Sunlight *s, const WoodStand *stand, int view, int azimuth)
{
    Look            look = {.stand = stand, .view = &stand->view[view]};
    const double    x = s->air->light.sun_d_enu[0], y = s->air->light.sun_d_enu[1];
    const double    towards_rad = atan2(y, x) + far_stand_azimuth(azimuth); /* the eye */
    const StandLit *a = &stand->lit[view][s->sun][azimuth], *b = &stand->lit[view][s->sun + 1][azimuth];
    const double    share = s->sun_share, past = past_thickets(s->sin_sun);
    look.lit =
        (StandLit){past * between(a->leaf, b->leaf, share), past * between(a->leaf_front, b->leaf_front, share),
                   past * between(a->leaf_back, b->leaf_back, share),
                   past * between(a->bark_front, b->bark_front, share), past * between(a->ground, b->ground, share)};
    place_between(&look.among, &look.view->among[s->sun], s->sun_share);
    place_between(&look.on_ground, &look.view->on_ground[s->sun], s->sun_share);
    look.through = between(look.view->ground_through[s->sun], look.view->ground_through[s->sun + 1], s->sun_share);
    normal_of(look.n_leaf[0], look.view->leaf.n, towards_rad);
    for (int c = 0; c < 3; c++) look.n_leaf[1][c] = -look.n_leaf[0][c];
    normal_of(look.n_bark, look.view->bark.n, towards_rad);
    return look;
}

/* Sky on a plane over what it faces of it, W/m2. */
static double sky_at(const Sunlight *s, AirBand band, const double n[3])
{
    PlanePlace p;
    daylight_plane_place(&p, &s->air->light, n);
    p.open = 1;
    return daylight_plane_there(&s->air->light, band, &p);
}

/* Irradiance of one side of an organ by sky, ground and leaves; up and down are the shares of sky and ground. */
static double around(double up, double down, double all, double sky_w_m2, double ground_w_m2, double leaves_w_m2)
{
    return up * sky_w_m2 + down * ground_w_m2 + fmax(all - up - down, 0) * leaves_w_m2;
}

/* Radiance times pi in an optical channel: of what comes from all around, and of direct sun. */
static void optical_of(double *shaded, double *sunlit, const Look *l, const Sunlight *s, int channel,
                       const Material *ground)
{
    const AirBand     band = (AirBand)channel;
    const StandOrgan *leaf = &l->view->leaf, *bark = &l->view->bark;
    const Material   *m = &l->stand->leaf, *wood = &l->stand->bark;
    const double      sun_w_m2 = s->air->light.sun_w_m2[channel], sky_w_m2 = s->air->light.sky_w_m2[channel];
    const double      land = (double)s->materials->ground_rho[channel];
    double            below_w_m2, floor_w_m2;
    const double      leaves =
        canopy_exitance(&below_w_m2, l->stand->canopy, &l->among, channel, sun_w_m2, sky_w_m2, s->sin_sun, land);
    const double near_ground =
        canopy_exitance(&floor_w_m2, l->stand->canopy, &l->on_ground, channel, sun_w_m2, sky_w_m2, s->sin_sun, land);
    below_w_m2 *= land;
    const double both = leaf->bright;
    *shaded = (double)m->rho[channel] *
                  around(leaf->front_up, leaf->front_down, both, sky_at(s, band, l->n_leaf[0]), below_w_m2, leaves) +
              (double)m->tau[channel] *
                  around(leaf->back_up, leaf->back_down, both, sky_at(s, band, l->n_leaf[1]), below_w_m2, leaves) +
              (double)wood->rho[channel] * around(bark->front_up, bark->front_down, bark->bright,
                                                  sky_at(s, band, l->n_bark), below_w_m2, leaves);
    *shaded +=
        l->view->ground * (double)ground->rho[channel] * around(l->view->ground_up, 0, 1, sky_w_m2, 0, near_ground);
    *sunlit = sun_w_m2 * ((double)m->rho[channel] * l->lit.leaf_front + (double)m->tau[channel] * l->lit.leaf_back +
                          (double)wood->rho[channel] * l->lit.bark_front +
                          (double)ground->rho[channel] * l->lit.ground * s->sin_sun);
}

/* ---- once a frame: heat ----------------------------------------------------------------------- */

/* Temperatures of what is seen, K, each with its share. */
typedef struct Warm {
    double leaf_k[2], bark_k, ground_k; /* leaves: in the shade, in the sun */
    double leaf[2];
} Warm;

static double ground_k(const Look *l, const Air *air, int surface)
{
    static const double level[3] = {0, 0, 1};
    uint8_t             shadow[shadow_most_slots] = {0};
    if (!air->heat) return air->light.weather.air_temp_k;
    const HeatNow *now = air->heat->now;
    const int      kind = now->kind_of[surface];
    if (!air->heat->shadow) return heat_ground_k(now, kind, level, 0, 1, 1);
    for (int k = 0; k < now->slots; k++) {
        double    share;
        const int at = far_stand_at_sun(&share, asin(clamp((double)now->slot_d_enu[2][k], 0, 1)));
        shadow[k] =
            (uint8_t)lround(255 * (1 - between(l->view->ground_through[at], l->view->ground_through[at + 1], share)));
    }
    return heat_ground_k(now, kind, level, heat_taken(now, kind, level, shadow), l->view->ground_open, 1);
}

/* Mean temperature of the bark of branches of every tilt, whose sides are weighted by their cosine to the eye. */
static double bark_k(const Look *l, const HeatNow *now)
{
    static const double turned_deg[5] = {-65, -35, 0, 35, 65}, tilt[3] = {-0.6, 0, 0.6};
    const double        azimuth_rad = atan2(l->n_bark[1], l->n_bark[0]);
    double              sum = 0, weights = 0;
    for (int k = 0; k < 15; k++) {
        const double turned_rad = turned_deg[k % 5] * rad_per_deg,
                     up = clamp(l->view->bark.n[1] + tilt[k / 5], -0.95, 0.95);
        const double level = sqrt(1 - up * up), weight = cos(turned_rad) * level;
        const double n[3] = {level * cos(azimuth_rad + turned_rad), level * sin(azimuth_rad + turned_rad), up};
        sum += weight * heat_branch_k(now, l->stand->bark_row, l->view->bark.radius_m, n, l->view->bark.open);
        weights += weight;
    }
    return sum / weights;
}

static Warm warm_of(const Look *l, const Air *air, int surface, bool sunlit)
{
    const double air_k = air->light.weather.air_temp_k;
    Warm         w = {.bark_k = air_k};
    w.leaf[1] = sunlit && air->light.sun_d_enu[2] > 0 ? l->lit.leaf : 0;
    w.leaf[0] = l->view->leaf.share - w.leaf[1];
    for (int k = 0; k < 2; k++)
        w.leaf_k[k] = thermal_leaf_k(&air->light, &l->stand->leaf, air_k, l->view->leaf.open, k);
    if (air->heat && air->heat->now->branches > 0) w.bark_k = bark_k(l, air->heat->now);
    w.ground_k = ground_k(l, air, surface);
    return w;
}

/* Radiance of them and of what they reflect of sky and ground, in LWIR. */
static double thermal_of(const Look *l, const Sunlight *s, const Warm *w, const Material *ground)
{
    const PlanckTable *planck = s->air->light.planck_lwir;
    const Material    *m = &l->stand->leaf, *wood = &l->stand->bark;
    const StandOrgan  *leaf = &l->view->leaf, *bark = &l->view->bark;
    const double floor = s->air->light.ground_w_m2_sr[AIR_LWIR], rho = (double)m->rho_lwir, tau = (double)m->tau_lwir;
    const double up = 0.5 * (1 + leaf->n[1]), bark_up = 0.5 * (1 + bark->n[1]);
    const double sky[3] = {sky_at(s, AIR_LWIR, l->n_leaf[0]) / pi_rad, sky_at(s, AIR_LWIR, l->n_leaf[1]) / pi_rad,
                           sky_at(s, AIR_LWIR, l->n_bark) / pi_rad};
    double       sum = 0;
    for (int k = 0; k < 2; k++) sum += w->leaf[k] * (1 - rho - tau) * planck_table_radiance(planck, w->leaf_k[k]);
    sum += bark->share * (1 - (double)wood->rho_lwir) * planck_table_radiance(planck, w->bark_k);
    sum += l->view->ground * (1 - (double)ground->rho_lwir) * planck_table_radiance(planck, w->ground_k);
    sum += leaf->share * (rho * (up * sky[0] + (1 - up) * floor) + tau * ((1 - up) * sky[1] + up * floor));
    sum += bark->share * (double)wood->rho_lwir * (bark_up * sky[2] + (1 - bark_up) * floor);
    return sum + l->view->ground * (double)ground->rho_lwir * s->air->light.sky_w_m2[AIR_LWIR] / pi_rad;
}

/* ---- once a frame: nodes ---------------------------------------------------------------------- */

static bool has_band(const Air *air, AirBand band)
{
    return air->light.sky_w_m2[band] > 0 || air->light.sun_w_m2[band] > 0;
}

/* Level ground of the row's own reflectance and of a share of the sun, that shows the same. */
static void fill_node(FarNode *out, const Look *l, const Sunlight *s, const Material *row, int surface)
{
    static const double least_sin = 0.01;
    const Material     *ground = &s->materials->material[s->materials->surface[surface]];
    const Daylight     *light = &s->air->light;
    const Material     *m = &l->stand->leaf, *wood = &l->stand->bark;
    const double        level = fmax(s->sin_sun, least_sin);
    *out = (FarNode){0};
    const double mwir = (double)m->rho_mwir * l->lit.leaf_front + (double)m->tau_mwir * l->lit.leaf_back +
                        (double)wood->rho_mwir * l->lit.bark_front +
                        (double)ground->rho_mwir * l->lit.ground * s->sin_sun;
    out->sun = s->sin_sun > 0 && row->rho_mwir > 0 ? (float)(mwir / (double)row->rho_mwir / level) : 0;
    out->radar =
        (float)(l->view->leaf.share * (double)m->radar_gamma + l->view->bark.share * (double)wood->radar_gamma +
                l->view->ground * (double)ground->radar_gamma);
    for (int c = 0; c < optical_channel_count; c++) {
        double shaded, sunlit;
        if (!has_band(s->air, (AirBand)c)) continue;
        optical_of(&shaded, &sunlit, l, s, c, ground);
        const double sky_w_m2 = light->sky_w_m2[c], sun_w_m2 = light->sun_w_m2[c] * s->sin_sun * (double)out->sun;
        if (sky_w_m2 > 0) out->reflects[0][c] = (float)(shaded / ((double)row->rho[c] * sky_w_m2));
        if (sky_w_m2 + sun_w_m2 > 0)
            out->reflects[1][c] = (float)((shaded + sunlit) / ((double)row->rho[c] * (sky_w_m2 + sun_w_m2)));
    }
    for (int k = 0; k < 2; k++) {
        const Warm   w = warm_of(l, s->air, surface, k);
        const double rho = (double)row->rho_lwir, sky = light->sky_w_m2[AIR_LWIR] / pi_rad;
        double       temp_k = (w.leaf[0] * w.leaf_k[0] + w.leaf[1] * w.leaf_k[1] + l->view->bark.share * w.bark_k +
                         l->view->ground * w.ground_k);
        if (has_band(s->air, AIR_LWIR))
            temp_k = planck_table_temp(light->planck_lwir, (thermal_of(l, s, &w, ground) - rho * sky) / (1 - rho));
        out->warmer_k[k] = (float)(temp_k - light->weather.air_temp_k);
    }
}

Status far_woods_frame(FarWoodsFrame **out, const FarWoods *far, const Air *air, const Materials *materials,
                       Arena *arena)
{
    *out = NULL;
    if (!far) return STATUS_OK;
    FarWoodsFrame *f = arena_alloc(arena, 1, sizeof *f);
    if (!f) return STATUS_NO_MEMORY;
    Sunlight s = {.air = air, .materials = materials, .sin_sun = fmax(air->light.sun_d_enu[2], 0)};
    s.sun = far_stand_at_sun(&s.sun_share, asin(clamp(air->light.sun_d_enu[2], 0, 1)));
    f->far = far;
    for (int c = 0; c < optical_channel_count; c++)
        f->sky_w_m2[c] = air->light.sky_w_m2[c], f->sun_w_m2[c] = air->light.sun_w_m2[c] * s.sin_sun;
    f->sun_azimuth_rad = atan2(air->light.sun_d_enu[1], air->light.sun_d_enu[0]);
    for (int n = 0; n < far_stands * far_densities * stand_views * stand_azimuths; n++) {
        const int a = n % stand_azimuths, v = n / stand_azimuths % stand_views;
        const int p = n / (stand_azimuths * stand_views) % far_densities,
                  k = n / (stand_azimuths * stand_views * far_densities);
        const Look look = look_of(&s, far->stand[k][p], v, a);
        for (int g = 0; g < far_grounds; g++)
            fill_node(&f->node[k][p][g][v][a], &look, &s, &materials->material[far->row[k]],
                      g ? SURFACE_SCRUB : class_of[k]);
    }
    *out = f;
    return STATUS_OK;
}

/* ---- hits ------------------------------------------------------------------------------------- */

bool far_woods_find(FarPlaces *out, const FarWoods *far, const ForestFrame *plants, const Hits *hits)
{
    bool any = false;
    woods_not_standing(out->stand, out->cover, out->density, far->woods, hits->count, hits->surface, hits->p_enu[0],
                       hits->p_enu[1]);
    for (int i = 0; i < hits->count; i++) {
        out->stand[i] = !out->stand[i] || hits->kind[i] != hit_ground ? 0
                        : out->stand[i] == SURFACE_FOREST_CONIFER     ? 2
                                                                      : 1;
        out->planted[i] = 0;
        if (out->stand[i] && plants && plants->far)
            out->planted[i] = (float)forest_far_share(plants, hits->p_enu[0][i], hits->p_enu[1][i]);
        if (!(out->planted[i] < 1)) out->stand[i] = 0;
        any |= out->stand[i] > 0;
    }
    return any;
}

/* Adds of a node what is its share. */
static void add_node(FarNode *sum, const FarNode *n, float share)
{
    for (int k = 0; k < 2; k++) {
        for (int c = 0; c < optical_channel_count; c++) sum->reflects[k][c] += share * n->reflects[k][c];
        sum->warmer_k[k] += share * n->warmer_k[k];
    }
    sum->sun += share * n->sun, sum->radar += share * n->radar;
}

/* Interpolates the node of a hit between those of the dense stand (its share is dense) and of the sparse one. */
static void look_there(FarNode *out, const FarWoodsFrame *f, int stand, float dense, double to_eye, const Hits *hits,
                       const Rays *rays, int i)
{
    double       up_share, azimuth_share;
    const double from_sun_rad =
        remainder(atan2(-rays->d_enu[1][i], -rays->d_enu[0][i]) - f->sun_azimuth_rad, 2 * pi_rad);
    const int v = far_stand_at_view(&up_share, asin(clamp(to_eye, 0, 1))),
              a = far_stand_at_azimuth(&azimuth_share, fabs(from_sun_rad));
    const int   g = hits->surface[i] != class_of[stand];
    const float u = (float)up_share, w = (float)azimuth_share;
    *out = (FarNode){0};
    for (int p = 0; p < far_densities; p++) {
        const float    of = p ? dense : 1 - dense;
        const FarNode *low = &f->node[stand][p][g][v][a], *high = &f->node[stand][p][g][v + 1][a];
        add_node(out, &low[0], of * (1 - u) * (1 - w)), add_node(out, &low[1], of * (1 - u) * w);
        add_node(out, &high[0], of * u * (1 - w)), add_node(out, &high[1], of * u * w);
    }
}

/* Share of the canopy at a place, and that of the dense stand in it: by the density, or by the cover of a canopy layer.
 */
static float canopy_share(float *dense, const FarWoods *far, int stand, double cover, double density, double to_eye)
{
    const double along = hides / fmax(to_eye, 0.2);
    const double open = exp(-along * density), sparse_open = exp(-along * density_of[0]),
                 dense_open = exp(-along * density_of[1]);
    *dense = 1;
    if (cover >= 0)
        return (float)fmin(cover / fmax(1 - far->stand[stand][far_densities - 1]->view[stand_views - 1].ground, 0.1),
                           1);
    *dense = (float)clamp((sparse_open - open) / (sparse_open - dense_open), 0, 1);
    return (float)clamp((1 - open) / (1 - sparse_open), 0, 1);
}

/* Open ground between the crowns of a sparse canopy: over what the row shows of the canopy's light. */
static float open_too(const FarWoodsFrame *f, int c, float share, float reflects, float open, float lit, float sun)
{
    const float sky_w_m2 = (float)f->sky_w_m2[c], sun_w_m2 = (float)f->sun_w_m2[c] * lit;
    const float of_row_w_m2 = sky_w_m2 + sun_w_m2 * sun;
    if (!(share < 1) || !(of_row_w_m2 > 0)) return reflects;
    return share * reflects + (1 - share) * open * (sky_w_m2 + sun_w_m2) / of_row_w_m2;
}

void far_woods_apply(const FarInputs *in, const FarWoodsFrame *f, const Materials *materials, const Hits *hits,
                     const Rays *rays)
{
    for (int i = 0; i < hits->count; i++) {
        FarNode   node;
        float     dense;
        const int stand = in->places->stand[i] - 1;
        in->of_far[i] = 0;
        if (stand < 0) continue;
        const Material *row = &materials->material[f->far->row[stand]], *own = &materials->material[hits->material[i]];
        const float     lit = in->sun[i];
        double          to_eye = 0; /* cosine from the ground's normal */
        for (int c = 0; c < 3; c++) to_eye -= (double)hits->n_geo[c][i] * rays->d_enu[c][i];
        const float share =
            (1 - in->places->planted[i]) *
            canopy_share(&dense, f->far, stand, (double)in->places->cover[i], (double)in->places->density[i], to_eye);
        look_there(&node, f, stand, dense, to_eye, hits, rays, i);
        for (int c = 0; c < optical_channel_count; c++) {
            if (!in->texture[c]) continue;
            const float reflects = node.reflects[0][c] + lit * (node.reflects[1][c] - node.reflects[0][c]);
            in->texture[c][i] *= open_too(f, c, share, reflects, own->rho[c] / row->rho[c], lit, node.sun);
        }
        in->material[i] = (uint16_t)f->far->row[stand];
        in->far_sun[i] = lit * node.sun;
        if (own->radar_gamma > 0) in->radar[i] *= share * node.radar / own->radar_gamma + (1 - share);
        in->warmer_k[i] = node.warmer_k[0] + lit * (node.warmer_k[1] - node.warmer_k[0]);
        in->of_far[i] = share;
    }
}
