/* render/effects.c: the light of a puff: its own by Planck, the sun's and the surroundings' by its albedo.
 *
 * Source of a grey medium (Kirchhoff): (1 - albedo) Planck(T) + albedo * mean of what arrives. The sun arrives with a
 * phase function (Henyey and Greenstein, 1941) and, as multiple scattering fills a cloud, in veil_orders orders, each
 * with half the share, half the asymmetry and half the depth of the one before (Wrenninge, Kulla, Lundqvist 2013): an
 * approximation for pictures, that leaves a thick white cloud lit from behind the eye at a reflectance of about 0.4. */
#include "render/effects.h"

#include <stdlib.h>

static const double band_low_m[effect_band_count] = {0.4e-6, 0.5e-6, 0.6e-6, 0.4e-6, 0.7e-6, 3.4e-6, 8e-6};
static const double band_high_m[effect_band_count] = {0.5e-6, 0.6e-6, 0.7e-6, 0.7e-6, 1.1e-6, 4.8e-6, 12e-6};

_Static_assert((int)effect_band_count == (int)veil_bands, "a volume's bands are the effects'");
_Static_assert((int)effect_band_b == (int)optical_channel_b && (int)effect_band_pan == (int)optical_channel_pan &&
               (int)optical_channel_count <= (int)effect_band_mwir, "optical channels come first, in one order");

static double phase_per_sr(double asymmetry, double cosine)
{
    const double g2 = asymmetry * asymmetry, base = 1 + g2 - 2 * asymmetry * cosine;
    return (1 - g2) / (4 * pi_rad * base * sqrt(base));
}

/* Below 900 K nothing shows in the visible that a display could: under 1e-5 W/(m2 sr). */
static double glow_w_m2_sr(int band, double temp_k)
{
    if (band < effect_band_mwir && temp_k < 900) return 0;
    return planck_band(band_low_m[band], band_high_m[band], temp_k, NULL);
}

/* What falls on a puff in one band: direct sun, and mean radiances from above and below. */
typedef struct Light {
    double sun_w_m2, above_w_m2_sr, below_w_m2_sr;
    Veil   veil;
    double glow_w_m2_sr;
} Light;

static Light light_in(const Air *air, const float *ground_rho, int band, double range_m, double temp_k)
{
    Light light = {.glow_w_m2_sr = 0};
    if (band == effect_band_mwir) {
        light = (Light){air->sun_mwir_w_m2, air->sky_mean_mwir_w_m2_sr, air->ground_mwir_w_m2_sr,
                        air_veil_mwir(air, range_m), planck_table_radiance(air->planck_mwir, temp_k)};
    } else if (band == effect_band_lwir) {
        light = (Light){0, air->sky_mean_lwir_w_m2_sr, air->ground_lwir_w_m2_sr, air_veil_lwir(air, range_m),
                        planck_table_radiance(air->planck_lwir, temp_k)};
    } else if (band < (int)optical_channel_count) {
        const double sun_up = fmax(air->sun_d_enu[2], 0), sky = air->sky_w_m2[band] / pi_rad;
        light = (Light){air->sun_w_m2[band], sky,
                        ground_rho[band] * (air->sun_w_m2[band] * sun_up / pi_rad + sky),
                        air_veil_optical(air, band, range_m), glow_w_m2_sr(band, temp_k)};
    }
    return light;
}

static void light_volume(VeilVolume *v, const EffectLaw *law, const Air *air, const float *ground_rho, double temp_k,
                         const double d_eye_enu[3], unsigned bands)
{
    const double cosine = v3_dot(d_eye_enu, air->sun_d_enu); /* forward: the sun behind the puff */
    for (int b = 0; b < effect_band_count; b++) {
        if (!(bands >> b & 1)) continue;
        const Light  light = light_in(air, ground_rho, b, v->range_m, temp_k);
        const double albedo = law->albedo[b], through = light.veil.transmittance;
        v->source[b] = light.veil.added_w_m2_sr +
                       through * ((1 - albedo) * light.glow_w_m2_sr +
                                  albedo * 0.5 * (light.above_w_m2_sr + light.below_w_m2_sr));
        v->from_top[b] = through * albedo * 0.5 * (light.above_w_m2_sr - light.below_w_m2_sr);
        double share = through * albedo * light.sun_w_m2, asymmetry = b < effect_band_mwir ? law->asymmetry : 0;
        for (int order = 0; order < veil_orders; order++) {
            v->sun[b][order] = share * phase_per_sr(asymmetry, cosine);
            share *= 0.5;
            asymmetry *= 0.5;
        }
    }
}

/* ---- order -------------------------------------------------------------------------------- */

typedef struct Placed {
    VeilVolume volume;
    uint32_t   group;
    int        index; /* in the snapshot: decides between equals */
} Placed;

static int by_group(const void *a, const void *b)
{
    const Placed *p = a, *q = b;
    if (p->group != q->group) return p->group < q->group ? -1 : 1;
    return (p->index > q->index) - (p->index < q->index);
}

static int by_range(const void *a, const void *b)
{
    const Placed *p = a, *q = b;
    if (p->volume.range_m != q->volume.range_m) return p->volume.range_m < q->volume.range_m ? -1 : 1;
    return (p->index > q->index) - (p->index < q->index);
}

/* Depth of a cloud's other puffs before the sun, at each one's centre. */
static void shade_group(Placed *first, int count, unsigned bands)
{
    for (int i = 0; i < count; i++)
        for (int k = 0; k < count; k++) {
            if (k == i) continue;
            VeilVolume       *to = &first[i].volume;
            const VeilVolume *from = &first[k].volume;
            const double      column_m = veil_column_m(from, to->p_enu, to->d_sun_enu, 0, INFINITY);
            if (!(column_m > 0)) continue;
            for (int b = 0; b < veil_bands; b++)
                if (bands >> b & 1) to->sun_depth[b] += from->extinction_per_m[b] * column_m;
        }
}

/* Whether any of it can fall into the picture, or shade what does: a cone about the corners, widened. */
static bool may_matter(const View *view, const EffectVolume *v)
{
    const double reach = 3 * fmax(v->along_m, v->across_m) + 20, half_x = 0.5 * view->width / view->focal_px;
    const double half_y = 0.5 * view->height / view->focal_px, tangent = sqrt(half_x * half_x + half_y * half_y);
    double off[3], cam[3];
    v3_sub(off, v->p_enu, view->p_enu);
    m3_tmul_v3(cam, view->r_enu_from_cam, off);
    if (cam[2] < -reach) return false;
    const double secant = sqrt(1 + tangent * tangent);
    return (sqrt(cam[0] * cam[0] + cam[1] * cam[1]) - fmax(cam[2], 0) * tangent) <= reach * secant;
}

Status effects_scene(EffectScene *out, const Snapshot *snapshot, const LocalFrame *frame, const View *view,
                     const Air *air, const float *ground_rho, unsigned bands, Arena *arena)
{
    *out = (EffectScene){0};
    if (snapshot->puff_count == 0 || !snapshot->effect_table || bands == 0) return STATUS_OK;
    Placed *placed = arena_alloc(arena, (size_t)snapshot->puff_count, sizeof *placed);
    if (!placed) return STATUS_NO_MEMORY;

    int count = 0;
    for (int i = 0; i < snapshot->puff_count; i++) {
        const EffectPuff *puff = &snapshot->puff[i];
        const EffectLaw  *law = &snapshot->effect_table->law[puff->kind];
        EffectVolume      volume;
        if (!effect_volume(&volume, snapshot->effect_table, puff, &air->weather, frame)) continue;
        if (!may_matter(view, &volume)) continue;

        VeilVolume *v = &placed[count].volume;
        double      d_eye_enu[3];
        *v = (VeilVolume){.along_m = volume.along_m, .across_m = volume.across_m, .billow = law->billow};
        memcpy(v->p_enu, volume.p_enu, sizeof v->p_enu);
        memcpy(v->axis_enu, volume.axis_enu, sizeof v->axis_enu);
        memcpy(v->d_sun_enu, air->sun_d_enu, sizeof v->d_sun_enu);
        memcpy(v->extinction_per_m, volume.extinction_per_m, sizeof v->extinction_per_m);
        v3_sub(d_eye_enu, volume.p_enu, view->p_enu);
        v->range_m = v3_length(d_eye_enu);
        if (!v3_normalize(d_eye_enu, d_eye_enu)) d_eye_enu[2] = 1;
        for (int k = 0; k < 3; k++) v->pattern[k] = 256 * random_uniform(puff->seed, 80, 0, (uint64_t)k);
        v->pattern[2] -= 0.25 * puff->age_s; /* it rolls upwards through its own outline */
        light_volume(v, law, air, ground_rho, volume.temp_k, d_eye_enu, bands);
        placed[count].group = puff->group;
        placed[count].index = i;
        count++;
    }
    qsort(placed, (size_t)count, sizeof *placed, by_group);
    for (int first = 0, end; first < count; first = end) {
        for (end = first + 1; end < count && placed[end].group == placed[first].group;) end++;
        shade_group(placed + first, end - first, bands);
    }
    qsort(placed, (size_t)count, sizeof *placed, by_range);
    VeilVolume *volume = arena_alloc(arena, (size_t)count + 1, sizeof *volume);
    if (!volume) return STATUS_NO_MEMORY;
    for (int i = 0; i < count; i++) volume[i] = placed[i].volume;
    *out = (EffectScene){count, volume};
    return STATUS_OK;
}
