/* sensor/detector/chain.c: the stages of a detector in order, from radiance to raw counts. */
#include "sensor/detector/chain.h"

#include "render/materials/planck.h"
#include "sensor/detector/array_noise.h"
#include "sensor/detector/blur_private.h"
#include "sensor/detector/line_scan_private.h"
#include "sensor/detector/display_values.h"
#include "sensor/detector/subpixel_private.h"

#include <stdlib.h>

typedef struct Channel {
    PhotonTable *photons;
    float       *fixed; /* v, h and vh noise, unit of sigma_ref_e */
    float       *gain;  /* NULL: none */
    uint8_t     *bad, *patched;
    uint16_t    *count;
    float       *value;
    Blur        *blur;
    SubPixel    *sub;
} Channel;

struct Chain {
    SensorPreset preset;
    int          width, height, channels;
    uint64_t     seed;
    double       exposure;    /* of the integration time, 0 .. 1 */
    double       sigma_ref_e; /* rms temporal noise that the ratios refer to */
    double       step_e;
    uint16_t     full;
    Channel      channel[3];
    double      *more;               /* [height][width]: what small targets add to a channel */
    float       *work, *line, *pool; /* pool: [line_scan_pool][height][width], or NULL */
    double      *columns;
    ChainWatch  *watch; /* NULL: none */
};

static bool has_fixed(const SensorPreset *p)
{
    return p->ratio.sigma[NOISE_V] > 0 || p->ratio.sigma[NOISE_H] > 0 || p->ratio.sigma[NOISE_VH] > 0;
}

double chain_wavelength_m(const SensorPreset *p, int channel)
{
    static const double ground_k = 300, sun_k = 5772; /* the sun: IAU 2015 resolution B3 */
    const SpectralBand  seen = preset_seen(p->band, p->optical, channel);
    return photon_seen_wavelength_m(&seen, p->band == BAND_OPTICAL ? sun_k : ground_k);
}

static Status channel_create(Channel *c, const Chain *chain, int index, int places)
{
    const SensorPreset *p = &chain->preset;
    const int           w = chain->width, h = chain->height;
    const size_t        count = (size_t)w * (size_t)h;
    const uint32_t      stream = (uint32_t)(3 * p->band + index);
    PhotonDetector      photons = p->photons;
    if (chain->channels == 3) preset_band(&photons.low_m, &photons.high_m, p->band, p->optical, index);
    Status status = photon_table_create(&c->photons, &photons, p->band != BAND_OPTICAL);
    if (status != STATUS_OK) return status;
    const double   wavelength_m = chain_wavelength_m(p, chain->channels == 3 ? index : -1);
    const MtfChain mtf = {.cutoff_cyc_px = p->photons.pitch_m / (wavelength_m * p->photons.f_number),
                          .obscuration = p->obscuration,
                          .footprint_px = p->footprint,
                          .places = places,
                          .jitter_px = p->jitter_px};
    status = blur_create(&c->blur, w, h, &mtf);
    if (status == STATUS_OK) status = subpixel_create(&c->sub, &mtf);
    if (status != STATUS_OK) return status;
    c->count = calloc(count, sizeof *c->count);
    c->value = calloc(count, sizeof *c->value);
    if (!c->count || !c->value) return STATUS_NO_MEMORY;
    if (has_fixed(p)) {
        c->fixed = calloc(count, sizeof *c->fixed);
        if (!c->fixed) return STATUS_NO_MEMORY;
        noise3d_add_fixed(c->fixed, w, h, &p->ratio, chain->seed, stream);
    }
    if (p->prnu > 0) {
        c->gain = malloc(count * sizeof *c->gain);
        if (!c->gain) return STATUS_NO_MEMORY;
        for (size_t i = 0; i < count; i++) {
            const size_t detector = p->scan.by_columns ? i / (size_t)w : i; /* a row is one detector's */
            c->gain[i] = (float)fmax(0, 1 + p->noise_scale * p->prnu *
                                                random_normal(chain->seed, 0x3c000000u + stream, 0, detector));
        }
    }
    if (p->bad_share > 0) {
        c->bad = malloc(count);
        c->patched = calloc(count, 1); /* PIXEL_GOOD */
        if (!c->bad || !c->patched) return STATUS_NO_MEMORY;
        bad_pixels_make(c->bad, w, h, p->bad_share, p->bad_clustered, chain->seed, stream);
        for (size_t i = 0; i < count; i++)
            if (random_uniform(chain->seed, 0x3c800000u + stream, 0, i) < p->bad_patched) c->patched[i] = c->bad[i];
    }
    return STATUS_OK;
}

Status chain_create(Chain **out, const SensorPreset *preset, int width, int height, int places, uint64_t seed)
{
    const size_t count = (size_t)width * (size_t)height;
    Chain       *c = calloc(1, sizeof *c);
    if (!c) return STATUS_NO_MEMORY;
    const PhotonDetector *d = &c->preset.photons;
    c->preset = *preset;
    c->preset.photons = preset_photons(preset);
    c->width = width;
    c->height = height;
    c->channels = preset->band == BAND_OPTICAL && preset->optical == OPTICAL_RGB ? 3 : 1;
    c->seed = seed;
    c->exposure = 1;
    c->full = (uint16_t)((1u << (int)preset->bits) - 1);
    c->step_e = d->well_e / c->full;
    const double level_e = preset->auto_exposure ? chain_exposed_share * d->well_e : photon_electrons(d, 300, NULL);
    c->sigma_ref_e = sqrt(level_e + d->dark_e + d->read_e * d->read_e);

    Status status = STATUS_OK;
    c->work = calloc(count, sizeof *c->work);
    c->line = calloc((size_t)(width > height ? width : height) + line_scan_taps, sizeof *c->line);
    c->columns = calloc((size_t)width, sizeof *c->columns);
    c->more = calloc(count, sizeof *c->more);
    if (!c->work || !c->line || !c->columns || !c->more) status = STATUS_NO_MEMORY;
    if (preset->line_noise > 0 && status == STATUS_OK) {
        c->pool = malloc(line_scan_pool * count * sizeof *c->pool);
        if (!c->pool) status = STATUS_NO_MEMORY;
        for (int k = 0; c->pool && k < line_scan_pool; k++) {
            const LineNoise noise = {preset->line_noise_px, seed, (uint32_t)preset->band, k};
            line_scan_noise(c->pool + (size_t)k * count, width, height, &preset->scan, &noise);
        }
    }
    for (int k = 0; k < c->channels && status == STATUS_OK; k++) status = channel_create(&c->channel[k], c, k, places);
    if (status != STATUS_OK) {
        chain_destroy(c);
        return status;
    }
    *out = c;
    return STATUS_OK;
}

void chain_destroy(Chain *c)
{
    if (!c) return;
    for (int k = 0; k < 3; k++) {
        photon_table_destroy(c->channel[k].photons);
        free(c->channel[k].fixed);
        free(c->channel[k].gain);
        free(c->channel[k].bad);
        free(c->channel[k].patched);
        free(c->channel[k].count);
        free(c->channel[k].value);
        blur_destroy(c->channel[k].blur);
        subpixel_destroy(c->channel[k].sub);
    }
    free(c->work);
    free(c->more);
    free(c->line);
    free(c->pool);
    free(c->columns);
    free(c);
}

const uint16_t *chain_counts(const Chain *c, int channel) { return c->channel[channel].count; }
const float    *chain_values(const Chain *c, int channel) { return c->channel[channel].value; }
double          chain_step_e(const Chain *c) { return c->step_e; }
double          chain_full(const Chain *c) { return c->full; }

/* ---- figures ---------------------------------------------------------------------------------- */

double chain_signal_e(double *exposure, const Chain *c, int channel, double radiance)
{
    if (exposure) *exposure = c->exposure;
    return c->exposure * photon_table_electrons(c->channel[channel].photons, radiance);
}

double chain_counts_at(const Chain *c, int channel, double radiance)
{
    const PhotonDetector *d = &c->preset.photons;
    return (c->exposure * (photon_table_electrons(c->channel[channel].photons, radiance) + d->dark_e)) / c->step_e;
}

/* Rms of all noise at this many electrons of signal. */
static double sigma_e(const Chain *c, double signal_e)
{
    const SensorPreset   *p = &c->preset;
    const PhotonDetector *d = &p->photons;
    double                pattern = p->line_noise * p->line_noise;
    for (int k = NOISE_TV; k < noise_axes; k++) pattern += p->ratio.sigma[k] * p->ratio.sigma[k];
    const double temporal = signal_e + c->exposure * d->dark_e + d->read_e * d->read_e;
    const double gain_e = p->prnu * signal_e;
    const double all = temporal + pattern * c->sigma_ref_e * c->sigma_ref_e + gain_e * gain_e;
    return sqrt(p->noise_scale * p->noise_scale * all + c->step_e * c->step_e / 12);
}

double chain_sigma(const Chain *c, int channel, double radiance)
{
    const PhotonTable *photons = c->channel[channel].photons;
    if (!(radiance > 0)) radiance = 1e-6;
    const double signal = c->exposure * photon_table_electrons(photons, radiance);
    const double above = c->exposure * photon_table_electrons(photons, 1.001 * radiance);
    return sigma_e(c, signal) * 0.001 * radiance / (above - signal);
}

double chain_netd_k(const Chain *c, double temp_k)
{
    const PhotonDetector *d = &c->preset.photons;
    const SpectralBand    seen = {d->low_m, d->high_m, d->response};
    double                slope;
    const double          radiance = planck_seen(&seen, temp_k, &slope);
    return chain_sigma(c, 0, radiance) / slope;
}

/* ---- a frame ---------------------------------------------------------------------------------- */

void chain_expose(Chain *c, const float *const radiance[])
{
    const PhotonDetector *d = &c->preset.photons;
    const size_t          count = (size_t)c->width * (size_t)c->height;
    double                most = 0; /* the brightest channel's mean */
    c->exposure = 1;
    if (!c->preset.auto_exposure) return;
    for (int k = 0; k < c->channels; k++) {
        double sum = 0;
        for (size_t i = 0; i < count; i++) sum += isfinite(radiance[k][i]) ? fmax(0, radiance[k][i]) : 0;
        most = fmax(most, photon_table_electrons(c->channel[k].photons, sum / (double)count) + d->dark_e);
    }
    if (most > chain_exposed_share * d->well_e) c->exposure = chain_exposed_share * d->well_e / most;
}

/* Notes the watched pixel's electrons after a stage. */
static void note(const Chain *c, int index, ChainStage stage, const float *e)
{
    ChainWatch *w = c->watch;
    if (!w) return;
    w->value[index][stage] = (double)e[w->px];
    w->has[index] |= 1u << stage;
}

void chain_watch(Chain *c, ChainWatch *watch) { c->watch = watch; }

static void run_channel(Chain *c, int index, const float *radiance, const SmallTargets *small, int frame,
                        const double rate_px_s[2])
{
    const SensorPreset   *p = &c->preset;
    const PhotonDetector *d = &p->photons;
    Channel              *ch = &c->channel[index];
    const int             w = c->width, h = c->height;
    const size_t          count = (size_t)w * (size_t)h;
    const uint32_t        stream = (uint32_t)(3 * p->band + index);
    const NoiseDraw       draw = {c->seed, stream, frame};
    float                *e = ch->value;

    for (size_t i = 0; i < count; i++) e[i] = (float)(c->exposure * photon_table_electrons(ch->photons, radiance[i]));
    note(c, index, CHAIN_ELECTRONS, e);

    /* the motion of the sweep itself passes over a detector within a stage's integration time; the scene's own
     * motion, which the stages do not follow, over all stages, which integrate one after the other */
    const double sweep_px = p->scan.by_columns ? c->exposure * d->integration_s / fmax(p->tdi, 1) / p->scan.line_s : 0;
    const double moving_px[2] = {sweep_px + (p->smear ? rate_px_s[0] * c->exposure * d->integration_s : 0),
                                 p->smear ? rate_px_s[1] * c->exposure * d->integration_s : 0};
    const int    plane = p->band == BAND_MWIR   ? picture_mwir
                         : p->band == BAND_LWIR ? picture_lwir
                                                : picture_optical + index;
    const bool   few = small && small->count > 0;
    const SubPixelPlane fine = {.electrons = e,
                                .more = c->more,
                                .width = w,
                                .height = h,
                                .plane = plane,
                                .photons = ch->photons,
                                .exposure = c->exposure};
    if (few) subpixel_targets(ch->sub, &fine, small, moving_px);
    if (few) note(c, index, CHAIN_SMALL_TARGETS, e);
    blur_apply_with(ch->blur, e, e, moving_px, few ? c->more : NULL);
    note(c, index, CHAIN_OPTICS, e);
    if (p->smear && p->scan.line_s > 0 && (rate_px_s[0] != 0 || rate_px_s[1] != 0)) {
        line_scan_resample(c->work, e, w, h, &p->scan, rate_px_s, c->line);
        memcpy(e, c->work, count * sizeof *e);
        note(c, index, CHAIN_LINES, e);
    }

    const double dark_e = c->exposure * d->dark_e, floor_e = d->read_e * d->read_e, scale = p->noise_scale;
    for (size_t i = 0; ch->gain && i < count; i++) e[i] *= ch->gain[i];
    if (ch->gain) note(c, index, CHAIN_GAIN, e);
    if (scale > 0) {
        const double pattern_e = scale * c->sigma_ref_e;
        for (int r = 0; r < h; r++)
            for (int k = 0; k < w; k++) {
                const size_t i = (size_t)r * (size_t)w + (size_t)k;
                const double sigma = scale * sqrt((e[i] > 0 ? e[i] : 0) + dark_e + floor_e);
                e[i] = (float)(e[i] + dark_e + sigma * noise3d_unit(NOISE_TVH, c->seed, stream, frame, r, k));
            }
        note(c, index, CHAIN_NOISE, e);
        if (ch->fixed)
            for (size_t i = 0; i < count; i++) e[i] = (float)(e[i] + pattern_e * ch->fixed[i]);
        const Noise3d moving = {.sigma = {[NOISE_TV] = pattern_e * p->ratio.sigma[NOISE_TV],
                                          [NOISE_TH] = pattern_e * p->ratio.sigma[NOISE_TH],
                                          [NOISE_T] = pattern_e * p->ratio.sigma[NOISE_T]}};
        noise3d_add_moving(e, w, h, &moving, &draw, c->columns);
        if (c->pool) {
            const float *line = c->pool + (size_t)(frame % line_scan_pool) * count;
            for (size_t i = 0; i < count; i++) e[i] = (float)(e[i] + pattern_e * p->line_noise * line[i]);
        }
        note(c, index, CHAIN_PATTERN, e);
    } else {
        for (size_t i = 0; i < count; i++) e[i] = (float)(e[i] + dark_e);
        note(c, index, CHAIN_NOISE, e);
    }
    /* the path of the scan passes a column in line_s active / width, or in line_s; cut-off x that time */
    const double active = p->scan.active > 0 ? p->scan.active : 1;
    line_scan_couple(e, w, h, &p->scan, p->scan.by_columns ? p->ac_per_line : p->ac_per_line * active / w);
    note(c, index, CHAIN_AC_COUPLED, e);

    detector_counts(ch->count, e, count, c->step_e, c->full);
    if (ch->bad) {
        bad_pixels_insert(ch->count, ch->bad, w, h, c->full, &draw);
        bad_pixels_replace(ch->count, ch->patched, w, h);
    }
    for (size_t i = 0; i < count; i++) ch->value[i] = ch->count[i];
    note(c, index, CHAIN_COUNTS, ch->value);
    if (c->watch) c->watch->defect = ch->bad ? ch->bad[c->watch->px] : PIXEL_GOOD, c->watch->exposure = c->exposure;
}

void chain_run(Chain *c, const float *const radiance[], const SmallTargets *small, int frame, const double rate_px_s[2])
{
    for (int k = 0; k < c->channels; k++) run_channel(c, k, radiance[k], small, frame, rate_px_s);
}
