/* render/smoke/smoke_effects.c: the radiance of smoke puffs: thermal emission by Planck, scattered light of sun and
 * surroundings by the albedo.
 *
 * Source of a grey medium (Kirchhoff): (1 - albedo) Planck(T) + albedo * mean incident radiance. In a thick cloud the
 * incident radiance is its own: of the thermal bands the albedo goes from that of a grain, where it is thin, to that of
 * a half space of such grains (van de Hulst 1980, its fit for isotropic scattering). Sunlight is
 * scattered with a phase function (Henyey and Greenstein, 1941) and, as multiple scattering fills a cloud, in
 * smoke_scatter_orders orders, each with half the share, half the asymmetry and half the depth of the one before
 * (Wrenninge, Kulla, Lundqvist 2013): an approximation; a thick white cloud lit from behind the eye gets a
 * reflectance of about 0.4. */
#include "render/smoke/smoke.h"
#include "terrain/earth/refraction.h"

#include <stdlib.h>

_Static_assert((int)effect_band_count == (int)smoke_bands, "a volume's bands are the effects'");
_Static_assert((int)effect_band_count == (int)AIR_BAND_COUNT && (int)effect_band_pan == (int)AIR_PAN &&
                   (int)effect_band_mwir == (int)AIR_MWIR && (int)optical_channel_count == (int)effect_band_mwir,
               "effects, air and materials have their bands in one order");

static double phase_per_sr(double asymmetry, double cosine)
{
    const double g2 = asymmetry * asymmetry, base = 1 + g2 - 2 * asymmetry * cosine;
    return (1 - g2) / (4 * pi_rad * base * sqrt(base));
}

/* Below 500 K emission up to 1.1 um is negligible, and by Wien's law as small elsewhere: under 2e-5 W/(m2 sr). */
static double glow_w_m2_sr(int band, double temp_k)
{
    const SpectralBand seen = channel_band((ChannelPlace)band);
    if (band < effect_band_mwir && temp_k < 500 * fmin(1, 1.1e-6 / seen.high_m)) return 0;
    return planck_seen(&seen, temp_k, NULL);
}

typedef struct Placed {
    SmokeVolume        volume;
    const EffectModel *law;
    double             d_eye_enu[3], temp_k; /* from the eye to its centre */
    double             co2_kg_m3, h2o_kg_m3; /* at the centre */
    SmokeGas          *gas;                  /* volume.gas */
    uint32_t           group;
    int                index; /* index in the snapshot: order of equals */
} Placed;

double smoke_thick_albedo(double albedo)
{
    const double s = sqrt(1 - albedo);
    return (1 - s) * (1 - 0.139 * s) / (1 + 1.17 * s);
}

/* Share that a volume of such grains scatters of what falls onto it, by its own optical depth. */
static double thermal_albedo(double albedo, double depth)
{
    return albedo + (smoke_thick_albedo(albedo) - albedo) * -expm1(-depth);
}

/* Source terms of one volume in one band. i: its air path. */
static void light_volume(Placed *p, int band, const Air *air, const float *ground_rho, const AirPaths *veils, int i)
{
    SmokeVolume *v = &p->volume;
    const bool   optical = band < effect_band_mwir;
    const double through_m = (v->even ? 2 : 16.0 / 15) * v->across_m; /* column of its middle, of unit density there */
    const double grain = p->law->albedo[band], sun_w_m2 = air->light.sun_w_m2[band];
    const double albedo = optical ? grain : thermal_albedo(grain, v->extinction_per_m[band] * through_m);
    /* mean radiances from above and below: thermal ground emits, ground in daylight reflects */
    const double above = air->light.sky_w_m2[band] / pi_rad;
    const double below = optical ? ground_rho[band] * (sun_w_m2 * fmax(air->light.sun_d_enu[2], 0) / pi_rad + above)
                                 : air->light.ground_w_m2_sr[band];
    const double lit = veils->air_transmittance[i] * albedo * 0.5, glow = glow_w_m2_sr(band, p->temp_k);
    v->source[band] = veils->added_w_m2_sr[i] + lit * (above + below) + veils->transmittance[i] * (1 - albedo) * glow;
    if (p->gas && !optical)
        p->gas->source[band == effect_band_lwir] = veils->added_w_m2_sr[i] + veils->transmittance[i] * glow;
    v->from_top[band] = lit * (above - below);

    const double cosine = v3_dot(p->d_eye_enu, air->light.sun_d_enu); /* forward: the sun behind the puff */
    double       share = veils->sun_transmittance[i] * grain * sun_w_m2, asymmetry = optical ? p->law->asymmetry : 0;
    for (int order = 0; order < smoke_scatter_orders; order++) {
        v->sun[band][order] = share * phase_per_sr(asymmetry, cosine);
        share *= 0.5;
        asymmetry *= 0.5;
    }
}

/* The air paths from the eye to all centres, as many at a time as a block holds. */
static Status light_volumes(Placed *placed, int count, const View *view, const Air *air, const float *ground_rho,
                            unsigned bands, Arena *arena)
{
    Rays     *rays = arena_alloc(arena, 1, sizeof *rays);
    Hits     *hits = arena_alloc(arena, 1, sizeof *hits);
    AirPaths *veils = arena_alloc(arena, 1, sizeof *veils);
    float     temp_k[hits_capacity];
    if (!rays || !hits || !veils) return STATUS_NO_MEMORY;
    for (int first = 0; first < count; first += hits_capacity) {
        Placed *some = placed + first;
        hits->count = rays->count = count - first < hits_capacity ? count - first : hits_capacity;
        for (int i = 0; i < rays->count; i++) {
            for (int k = 0; k < 3; k++) {
                rays->o_enu[k][i] = view->p_enu[k];
                rays->d_enu[k][i] = some[i].d_eye_enu[k];
                hits->p_enu[k][i] = some[i].volume.p_enu[k];
            }
            hits->range_m[i] = some[i].volume.range_m;
            temp_k[i] = (float)some[i].temp_k;
        }
        for (int b = 0; b < effect_band_count; b++) {
            if (!(bands >> b & 1)) continue;
            air_path(veils, air, (AirBand)b, hits, rays, b < effect_band_mwir ? NULL : temp_k);
            for (int i = 0; i < rays->count; i++) light_volume(&some[i], b, air, ground_rho, veils, i);
        }
    }
    return STATUS_OK;
}

/* ---- order -------------------------------------------------------------------------------- */

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

/* Optical depth of a cloud's other puffs towards the sun, at each puff's centre. */
static void shade_group(Placed *first, int count, unsigned bands)
{
    for (int i = 0; i < count; i++)
        for (int k = 0; k < count; k++) {
            if (k == i) continue;
            SmokeVolume       *to = &first[i].volume;
            const SmokeVolume *from = &first[k].volume;
            const double       column_m = smoke_column_m(from, to->p_enu, to->d_sun_enu, 0, INFINITY);
            if (!(column_m > 0)) continue;
            for (int b = 0; b < smoke_bands; b++)
                if (bands >> b & 1) to->sun_depth[b] += from->extinction_per_m[b] * column_m;
        }
}

/* The gas of puffs, and what the air's CO2 leaves of its radiation on the way to the eye. */
static Status add_gas(Placed *placed, int count, unsigned bands, double eye_up_m, Arena *arena)
{
    static const double   air_scale_m = 8000;
    static const unsigned thermal = 1u << effect_band_mwir | 1u << effect_band_lwir;
    int                   of = 0;
    for (int i = 0; i < count && bands & thermal; i++) of += placed[i].co2_kg_m3 + placed[i].h2o_kg_m3 > 0;
    if (of == 0) return STATUS_OK;
    SmokeGas *gas = arena_alloc(arena, (size_t)of, sizeof *gas);
    if (!gas) return STATUS_NO_MEMORY;
    for (int i = 0; i < count; i++) {
        Placed *p = &placed[i];
        if (!(p->co2_kg_m3 + p->h2o_kg_m3 > 0)) continue;
        const double up_m = fmax(0.5 * (eye_up_m + p->volume.p_enu[2]), 0);
        const double air_m = p->volume.range_m * exp(-up_m / air_scale_m); /* at sea-level density */
        *gas = (SmokeGas){.co2_atm = smoke_gas_atm_m(p->co2_kg_m3, hot_gas_co2_molar_kg, p->temp_k),
                          .h2o_atm = smoke_gas_atm_m(p->h2o_kg_m3, hot_gas_h2o_molar_kg, p->temp_k)};
        for (int which = 0; which < 2; which++) smoke_gas_weights(gas->weight[which], (HotGasBand)which, p->temp_k);
        smoke_gas_passed_at(gas->passed, p->temp_k, air_m);
        p->gas = gas++;
        p->volume.gas = p->gas;
    }
    return STATUS_OK;
}

/* View-frustum cull, including shadows: whether any of it can fall into the picture, or shade what does: a cone
 * about the corners, widened. */
static bool may_matter(const View *view, const EffectVolume *v)
{
    double half[2], off[3], cam[3];
    view_half_tangents(half, view);
    const double reach = 3 * fmax(v->along_m, v->across_m) + 20, tangent = sqrt(half[0] * half[0] + half[1] * half[1]);
    v3_sub(off, v->p_enu, view->p_enu);
    m3_tmul_v3(cam, view->r_enu_from_cam, off);
    if (cam[2] < -reach) return false;
    const double secant = sqrt(1 + tangent * tangent);
    return (sqrt(cam[0] * cam[0] + cam[1] * cam[1]) - fmax(cam[2], 0) * tangent) <= reach * secant;
}

/* Drops those without extinction in any requested band: gas in the optical ones. */
static int keep_visible(Placed *placed, int count, unsigned bands)
{
    int kept = 0;
    for (int i = 0; i < count; i++) {
        double most = 0;
        for (int b = 0; b < effect_band_count; b++)
            if (bands >> b & 1) most = fmax(most, placed[i].volume.extinction_per_m[b]);
        if (most > 0 || placed[i].gas) placed[kept++] = placed[i];
    }
    return kept;
}

Status smoke_effects_scene(EffectScene *out, const Snapshot *snapshot, const EffectView *seen, const Air *air,
                           Arena *arena)
{
    const View    *view = seen->view;
    const unsigned bands = seen->bands;
    *out = (EffectScene){0};
    if (snapshot->puff_count == 0 || !snapshot->effect_table || bands == 0) return STATUS_OK;
    Placed *placed = arena_alloc_raw(arena, (size_t)snapshot->puff_count, sizeof *placed);
    if (!placed) return STATUS_NO_MEMORY;

    int count = 0;
    for (int i = 0; i < snapshot->puff_count; i++) {
        const EffectPuff  *puff = &snapshot->puff[i];
        const EffectModel *law = &snapshot->effect_table->law[puff->kind];
        EffectVolume       volume;
        if (seen->hidden >= 0 && snapshot_owns_puff(snapshot, seen->hidden, puff)) continue;
        if (!effect_volume(&volume, snapshot->effect_table, puff, &air->light.weather, seen->frame)) continue;
        if (!may_matter(view, &volume)) continue;

        SmokeVolume *v = &placed[count].volume;
        double      *d_eye_enu = placed[count].d_eye_enu;
        *v = (SmokeVolume){.along_m = volume.along_m, .across_m = volume.across_m, .billow = law->billow};
        memcpy(v->p_enu, volume.p_enu, sizeof v->p_enu);
        v->p_enu[2] += refraction_drop(seen->bend_per_m, view->p_enu, volume.p_enu); /* as the eye sees it */
        memcpy(v->axis_enu, volume.axis_enu, sizeof v->axis_enu);
        memcpy(v->d_sun_enu, air->light.sun_d_enu, sizeof v->d_sun_enu);
        memcpy(v->extinction_per_m, volume.extinction_per_m, sizeof v->extinction_per_m);
        v3_sub(d_eye_enu, v->p_enu, view->p_enu);
        v->range_m = v3_length(d_eye_enu);
        if (!v3_normalize(d_eye_enu, d_eye_enu)) d_eye_enu[2] = 1;
        for (int k = 0; k < 3; k++) v->pattern[k] = 256 * random_uniform(puff->seed, 80, 0, (uint64_t)k);
        v->pattern[2] -= 0.25 * puff->age_s; /* its pattern moves upwards through its own outline */
        placed[count].law = law;
        const double air_k = air->light.weather.air_temp_k;
        const double lifted_k = air->light.ground_k > 0 ? volume.ground_share * (air->light.ground_k - air_k) : 0;
        placed[count].temp_k = volume.temp_k + lifted_k + daylight_temp_at(&air->light, volume.p_enu) - air_k;
        v->shades_per_m = volume.extinction_per_m[effect_band_pan] *
                          (1 - law->albedo[effect_band_pan] * law->asymmetry * law->asymmetry);
        placed[count].group = puff->group;
        placed[count].co2_kg_m3 = volume.co2_kg_m3;
        placed[count].h2o_kg_m3 = volume.h2o_kg_m3;
        placed[count].gas = NULL;
        placed[count].index = i;
        count++;
    }
    qsort(placed, (size_t)count, sizeof *placed, by_group);
    for (int first = 0, end; first < count; first = end) {
        for (end = first + 1; end < count && placed[end].group == placed[first].group;) end++;
        shade_group(placed + first, end - first, bands);
    }
    Status status = add_gas(placed, count, bands, view->p_enu[2], arena);
    if (status != STATUS_OK) return status;
    count = keep_visible(placed, count, bands);
    status = light_volumes(placed, count, view, air, seen->ground_rho, bands, arena);
    if (status != STATUS_OK) return status;
    qsort(placed, (size_t)count, sizeof *placed, by_range);
    SmokeVolume *volume = arena_alloc(arena, (size_t)count + 1, sizeof *volume);
    if (!volume) return STATUS_NO_MEMORY;
    for (int i = 0; i < count; i++) volume[i] = placed[i].volume;
    *out = (EffectScene){count, volume};
    return STATUS_OK;
}
