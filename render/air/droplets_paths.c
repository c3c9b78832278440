/* render/air/droplets_paths.c: rain, snow and fog on the paths of a frame, and in its sky.
 *
 * Path by path, on what the tables give (air_paths.c, and air.c without tables): the tables have no edge at a layer's
 * top. The depth of the drops is exact; how the light of the air itself divides between what is before drops and what
 * is behind them follows an exponential of its extinction with height, by which only that light's share in front is
 * estimated. */
#include "render/air/air_private.h"

static const double clear_scale_m = 2000; /* height in which vapour and haze fall by e: estimate */

enum { cuts_max = 2 * (droplet_layers + 1) + 2 }; /* heights, the lowest point, the end */

/* A straight piece within one layer, or in none. */
typedef struct Part {
    int    layer;                     /* -1: none */
    double from_m, length_m, clear_m; /* clear_m: length of air like that of the ground with as much in it */
} Part;

typedef struct DropletRay {
    double eye_m, climb, cosine; /* cosine of the angle between it and the sun */
    int    parts;
    Part   part[cuts_max];
} DropletRay;

static double clear_length_m(double a_m, double b_m, double length_m)
{
    const double a = exp(-fmax(a_m, 0) / clear_scale_m), b = exp(-fmax(b_m, 0) / clear_scale_m);
    return length_m * (fabs(b_m - a_m) > 1 ? clear_scale_m * (a - b) / (b_m - a_m) : a);
}

static int add_cut(double *cut, int cuts, double at_m, double end_m)
{
    if (!(at_m > 0 && at_m < end_m)) return cuts;
    int i = cuts;
    for (; i > 0 && cut[i - 1] > at_m; i--) cut[i] = cut[i - 1];
    cut[i] = at_m;
    return cuts + 1;
}

/* Distances along the ray to a height, sorted into the cuts where they are on it. */
static int cut_at(double *cut, int cuts, const DropletRay *ray, double height_m, double end_m)
{
    const double r_m = earth_radius_m + ray->eye_m, middle_m = -r_m * ray->climb;
    const double rise = (height_m - ray->eye_m) * (2 * earth_radius_m + ray->eye_m + height_m);
    const double disc = middle_m * middle_m + rise;
    if (!(disc > 0)) return cuts;
    /* the root that does not cancel, and its partner by their product */
    const double far = middle_m + copysign(sqrt(disc), middle_m), root[2] = {far, far != 0 ? -rise / far : 0};
    return add_cut(cut, add_cut(cut, cuts, root[0], end_m), root[1], end_m);
}

/* false: no drops on it. range_m: INFINITY: to space. */
static bool ray_through(DropletRay *ray, const Droplets *droplets, double range_m)
{
    double cut[cuts_max] = {0}, begin_m = 0;
    int    cuts = 0;
    bool   wet = false;
    for (int i = 0; i < droplets->layers; i++) cuts = cut_at(cut, cuts, ray, droplets->layer[i].top_m, range_m);
    cuts = cut_at(cut, cuts, ray, air_top_m, range_m);
    cuts = add_cut(cut, cuts, -(earth_radius_m + ray->eye_m) * ray->climb, range_m); /* its lowest point */
    if (range_m < INFINITY) cut[cuts++] = range_m;
    ray->parts = 0;
    for (int i = 0; i < cuts; begin_m = cut[i++]) {
        Part        *part = &ray->part[ray->parts++];
        const double middle_m = air_height_along(ray->eye_m, ray->climb, 0.5 * (begin_m + cut[i]), NULL);
        *part = (Part){.layer = -1, .from_m = begin_m, .length_m = cut[i] - begin_m};
        part->clear_m = clear_length_m(air_height_along(ray->eye_m, ray->climb, begin_m, NULL),
                                       air_height_along(ray->eye_m, ray->climb, cut[i], NULL), part->length_m);
        for (int k = droplets->layers - 1; k >= 0; k--)
            if (middle_m < droplets->layer[k].top_m) part->layer = k;
        wet |= part->layer >= 0;
    }
    return wet;
}

/* Diffuse light that falls off from both sides of a layer, scattered into a ray that climbs so; share: of the way up.
 */
static double between_sides(const DropletGlow glow[2], double fade, double share, double leans)
{
    const double side[2] = {glow[0].mean_w_m2_sr + leans * glow[0].lean_w_m2_sr,
                            glow[1].mean_w_m2_sr + leans * glow[1].lean_w_m2_sr};
    if (!(fade > 1e-3)) return side[0] + share * (side[1] - side[0]);
    const double whole = -expm1(-2 * fade);
    return (side[1] * exp(-fade * (1 - share)) * -expm1(-2 * fade * share) +
            side[0] * exp(-fade * share) * -expm1(-2 * fade * (1 - share))) /
           whole;
}

/* What of a band's light is asked for. */
enum { ask_scattered = 1, ask_thermal = 2 };
static unsigned lights_of(int b) { return (b != AIR_LWIR ? ask_scattered : 0u) | (b >= AIR_MWIR ? ask_thermal : 0u); }

/* What a layer's drops send along a ray that sees them at this height, as if they were opaque. */
static double drops_send(const Daylight *light, const DropletLayer *layer, int b, unsigned lights, double height_m,
                         const DropletRay *ray)
{
    const double share = clamp((height_m - layer->bottom_m) / (layer->top_m - layer->bottom_m), 0, 1);
    const double albedo = layer->albedo[b], g = layer->asymmetry[b], leans = g * ray->climb, cosine = ray->cosine;
    double       sent = 0;
    if (lights & ask_scattered) {
        const double to_sun = fmax(1 + g * g - 2 * g * cosine, 1e-6), phase = (1 - g * g) / (to_sun * sqrt(to_sun));
        const double above = layer->per_m[b] * (layer->top_m - layer->bottom_m) * (1 - share);
        const double sun = layer->sun_w_m2[b][1] > 0 ? layer->sun_w_m2[b][1] * exp(-above / light->droplets.sun_up) : 0;
        sent = albedo * light->sky_scale[b] *
               (phase * sun / (4 * pi_rad) + fmax(between_sides(layer->diffuse[b], layer->fade[b], share, leans), 0));
    }
    if (!(lights & ask_thermal)) return sent;
    const double step = clamp(height_m / air_warmer_step_m, 0, air_warmer_nodes - 1.001), t = step - (int)step;
    const double low_k = (double)light->warmer_k[(int)step], high_k = (double)light->warmer_k[(int)step + 1];
    return sent +
           planck_table_radiance(b == AIR_MWIR ? light->planck_mwir : light->planck_lwir,
                                 light->weather.air_temp_k + low_k + t * (high_k - low_k)) +
           albedo * between_sides(layer->colder[b - AIR_MWIR], layer->fade[b], share, leans);
}

/* Transmittance of the drops on a ray; added: the air's own radiance before, and with them after. */
static double ray_drops(double *added_w_m2_sr, const DropletRay *ray, const Daylight *light, int b, unsigned lights)
{
    const Droplets *droplets = &light->droplets;
    double          clear = 0, left = 1, passed = 1, sum = 0;
    for (int i = 0; i < ray->parts; i++) clear += ray->part[i].clear_m * droplets->clear_per_m[b];
    const double source = clear > 1e-9 ? *added_w_m2_sr / -expm1(-clear) : 0;
    for (int i = 0; i < ray->parts; i++) {
        const Part         *p = &ray->part[i];
        const DropletLayer *layer = p->layer < 0 ? NULL : &droplets->layer[p->layer];
        const double air = p->clear_m * droplets->clear_per_m[b], drops = layer ? layer->per_m[b] * p->length_m : 0;
        const double depth = air + drops, lost = -expm1(-depth);
        double       sent = source;
        if (drops > 0) {
            /* where the light that arrives begins, in the mean */
            const double at = depth > 1e-3 ? 1 / depth - exp(-depth) / lost : 0.5 - depth / 12;
            const double seen_m = air_height_along(ray->eye_m, ray->climb, p->from_m + at * p->length_m, NULL);
            sent = (air * source + drops * drops_send(light, layer, b, lights, seen_m, ray)) / depth;
        }
        sum += left * lost * sent;
        left *= 1 - lost, passed *= exp(-drops);
    }
    *added_w_m2_sr = clear > 1e-9 ? sum : sum + *added_w_m2_sr * passed;
    return passed;
}

void droplets_on_paths(AirPaths *const out[AIR_BAND_COUNT], const Air *air, const Hits *hits, const Rays *rays)
{
    const Droplets *droplets = &air->light.droplets;
    int             first = 0;
    if (droplets->layers == 0 || !air->table) return;
    while (first < AIR_BAND_COUNT && !out[first]) first++;
    for (int i = 0; i < hits->count && first < AIR_BAND_COUNT; i++) {
        const double o_enu[3] = {rays->o_enu[0][i], rays->o_enu[1][i], rays->o_enu[2][i]};
        const double d_enu[3] = {rays->d_enu[0][i], rays->d_enu[1][i], rays->d_enu[2][i]};
        DropletRay   ray = {.eye_m = air->eye_height_m,
                            .climb = air_climb(o_enu, d_enu),
                            .cosine = clamp(v3_dot(d_enu, air->light.sun_d_enu), -1, 1)};
        if (!ray_through(&ray, droplets, (double)out[first]->range_m[i])) continue;
        for (int b = first; b < AIR_BAND_COUNT; b++) {
            if (!out[b]) continue;
            double      added = (double)out[b]->added_w_m2_sr[i];
            const float passed = (float)ray_drops(&added, &ray, &air->light, b, lights_of(b));
            out[b]->transmittance[i] *= passed, out[b]->sun_transmittance[i] *= passed;
            out[b]->air_transmittance[i] *= passed, out[b]->added_w_m2_sr[i] = (float)added;
        }
    }
}

/* Rows of the sky that have neither the sun's distance nor twilight nor clouds in them yet. */
void droplets_in_sky(double (*w_m2_sr)[AIR_BAND_COUNT], double thermal_w_m2_sr[2], const Daylight *light,
                     unsigned bands, double zenith_rad, const double *azimuth_rad, int azimuths)
{
    const double up = cos(zenith_rad), z = light->day_zenith_rad;
    if (light->droplets.layers == 0) return;
    DropletRay ray = {.climb = fmax(up, 1e-6)};
    if (!ray_through(&ray, &light->droplets, INFINITY)) return;
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        if (!(bands >> b & 1)) continue;
        const double scale = light->scattered_scale[b] * light->cloud_sky;
        if (b >= AIR_MWIR) {
            const PlanckTable *planck = b == AIR_MWIR ? light->planck_mwir : light->planck_lwir;
            const double       clear = light->thermal_scale[b - AIR_MWIR] * (1 - light->cloud_thermal),
                         cloud = light->cloud_thermal * planck_table_radiance(planck, light->weather.air_temp_k);
            double *raw = &thermal_w_m2_sr[b - AIR_MWIR], seen = *raw * clear + cloud;
            ray_drops(&seen, &ray, light, b, ask_thermal);
            if (clear > 0) *raw = (seen - cloud) / clear;
        }
        for (int a = 0; a < azimuths && b < AIR_LWIR && scale > 0; a++) {
            ray.cosine = up * cos(z) + sin(zenith_rad) * sin(z) * cos(azimuth_rad[a]);
            double seen = w_m2_sr[a][b] * scale;
            ray_drops(&seen, &ray, light, b, ask_scattered);
            w_m2_sr[a][b] = seen / scale;
        }
    }
}
