/* sensor/commands/range/range_course.c: contrast through the air, and what an observer makes of it, over range. */
#include "sensor/commands/range/range_private.h"

#include "sensor/detector/chain.h"

static const double target_m = 1, background_reflectance = 0.2, nearest_m = 1, farthest_m = 2e5;

/* Of the channel that a preset is for. */
static AirBand band_of(const SensorPreset *p)
{
    if (p->channel) return p->channel->place;
    return p->band == BAND_MWIR ? AIR_MWIR : p->band == BAND_LWIR ? AIR_LWIR : AIR_PAN;
}

/* Electrons of a background of this radiance, with the exposure that it gets, in a reflective band. */
static void expose(MrtdNoise *noise, const SensorPreset *p, double radiance_w_m2_sr)
{
    static const double  hc_j_m = 6.62607015e-34 * 299792458.0;
    const PhotonDetector d = preset_photons(p);
    const double         full_e = photon_etendue(&d) * radiance_w_m2_sr * chain_wavelength_m(p, -1) / hc_j_m;
    const double         wanted_e = chain_exposed_share * d.well_e;
    const double         exposure = p->auto_exposure ? fmin(1, wanted_e / (full_e + d.dark_e)) : 1;
    mrtd_noise_reflected(noise, p, exposure * full_e, exposure);
}

void range_at(RangePoint *out, const RangeCourse *c, double range_m)
{
    const RangeScene *s = &c->scene;
    const AirPath     path = {.observer_m = s->observer_m,
                              .target_m = target_m,
                              .range_m = range_m,
                              .sun_zenith_rad = 0.5 * pi_rad - s->sun_rad,
                              .rel_azimuth_rad = 0.5 * pi_rad};
    PathAir           air;
    MrtdNoise         noise;
    atmosphere_path(&air, c->atmosphere, s->visibility_m, c->band, &path, c->background_k);
    out->range_m = range_m;
    if (c->preset.band == BAND_OPTICAL) {
        const double seen = c->lit_w_m2_sr * air.sun_transmittance, all = seen + air.scattered_w_m2_sr;
        out->transmittance = air.sun_transmittance;
        out->contrast = all > 0 ? s->contrast * seen / all : 0;
        expose(&noise, &c->preset, all);
    } else {
        out->transmittance = air.transmittance;
        out->contrast = s->contrast * air.transmittance;
        mrtd_noise_emitted(&noise, &c->preset, c->background_k);
    }
    const double size_px = s->size_m / (range_m * c->pixel_rad);
    out->cycles = size_px * acquisition_cycles_px(&c->curves, &noise, out->contrast);
    out->ttp_v = size_px * acquisition_ttp_px(&c->curves, &noise, out->contrast);
    for (int task = 0; task < acquisition_tasks; task++) {
        out->p[BY_JOHNSON][task] = johnson_probability(out->cycles / s->at50[BY_JOHNSON][task]);
        out->p[BY_TTP][task] = ttp_probability(out->ttp_v / s->at50[BY_TTP][task]);
    }
}

/* Where detection, by both methods, is as rare as one in five. */
static double far_enough(const RangeCourse *c)
{
    RangePoint at;
    for (double range_m = 200; range_m < farthest_m; range_m *= 1.1) {
        range_at(&at, c, range_m);
        if (at.p[BY_JOHNSON][TASK_DETECT] < 0.2 && at.p[BY_TTP][TASK_DETECT] < 0.2) return range_m;
    }
    return farthest_m;
}

/* Rounds up to one or two figures, so that rows are at round ranges. */
static double round_up(double range_m)
{
    const double unit = pow(10, floor(log10(range_m)) - 1);
    return 2 * unit * ceil(range_m / (2 * unit) - 1e-9);
}

Status range_course_make(RangeCourse *c)
{
    const RangeScene         *s = &c->scene;
    const AcquisitionObserver observer = acquisition_default_observer();
    const Status              status = atmosphere_open_at(&c->atmosphere, s->air, s->visibility_m);
    if (status != STATUS_OK) return status;
    SunAir sun;
    c->band = band_of(&c->preset);
    c->pixel_rad = 1 / view_focal_px((int)c->preset.width_px, c->preset.hfov_deg * rad_per_deg);
    c->background_k = atmosphere_temp_k(c->atmosphere, 0);
    atmosphere_sun(&sun, c->atmosphere, s->visibility_m, c->band, 0, 0.5 * pi_rad - s->sun_rad);
    c->lit_w_m2_sr =
        background_reflectance / pi_rad * (sun.direct_normal_w_m2 * sin(s->sun_rad) + sun.diffuse_horizontal_w_m2);
    acquisition_prepare(&c->curves, &c->preset, &observer);
    const double far_m = isnan(s->far_m) ? round_up(far_enough(c)) : s->far_m;
    for (int i = 0; i < range_rows; i++) range_at(&c->row[i], c, i ? far_m * i / (range_rows - 1) : nearest_m);
    return STATUS_OK;
}

void range_course_close(RangeCourse *c)
{
    atmosphere_close(c->atmosphere);
    c->atmosphere = NULL;
}

double range_of(const RangeCourse *c, RangeMethod method, AcquisitionTask task, double probability)
{
    int last = range_rows - 1;
    while (last >= 0 && c->row[last].p[method][task] < probability) last--;
    if (last < 0) return 0;
    if (last == range_rows - 1) return INFINITY;
    double     low_m = c->row[last].range_m, high_m = c->row[last + 1].range_m;
    RangePoint at;
    while (high_m - low_m > 1e-4 * low_m) {
        const double middle_m = 0.5 * (low_m + high_m);
        range_at(&at, c, middle_m);
        if (at.p[method][task] >= probability) low_m = middle_m;
        else high_m = middle_m;
    }
    return 0.5 * (low_m + high_m);
}
