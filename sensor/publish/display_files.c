/* sensor/publish/display_files.c: display images of a band's detector, its raw counts, and the preview of truth. */
#include "sensor/publish/frame_files.h"

#include "sensor/detector/colour.h"
#include "sensor/detector/noise3d.h"
#include "sensor/detector/quantise.h"
#include "sensor/publish/image_file.h"
#include "sensor/publish/truth_preview.h"

#include <stdlib.h>

/* The planes that a band's detector receives; returns how many. */
static int band_radiance(const float *plane[3], const Picture *p, int band)
{
    int n = 0;
    if (band == BAND_MWIR || band == BAND_LWIR) {
        plane[0] = band == BAND_MWIR ? p->mwir : p->lwir;
        return plane[0] != NULL;
    }
    while (band == BAND_OPTICAL && n < 3 && p->optical[n]) {
        plane[n] = p->optical[n];
        n++;
    }
    return n;
}

static double mean_radiance(const Picture *picture, int band)
{
    const float *plane[3];
    const size_t count  = (size_t)picture->width * (size_t)picture->height;
    const int    planes = band_radiance(plane, picture, band);
    double       sum    = 0;
    for (int c = 0; c < planes; c++)
        for (size_t i = 0; i < count; i++) sum += plane[c][i];
    return planes ? fmax(0, sum / ((double)count * planes)) : 0;
}

/* Without a sensor: a share of the image's mean in each optical channel. */
static double optical_sigma(const Picture *picture, const Config *config)
{
    return config->detector.noise * config->detector.noise_optical * mean_radiance(picture, BAND_OPTICAL);
}

void frame_expose(TruthNoise *noise, Chain *const chain[BAND_COUNT], const Picture *picture, const Config *config)
{
    const float *plane[3];
    *noise = (TruthNoise){.netd_mwir_k = config->detector.noise * config->detector.netd_mwir_k,
                          .netd_lwir_k = config->detector.noise * config->detector.netd_lwir_k};
    for (int b = 0; b < BAND_COUNT; b++)
        if (chain[b] && band_radiance(plane, picture, b)) chain_expose(chain[b], plane);
    noise->optical_w_m2_sr = optical_sigma(picture, config);
    if (chain[BAND_OPTICAL])
        noise->optical_w_m2_sr = chain_sigma(chain[BAND_OPTICAL], 0, mean_radiance(picture, BAND_OPTICAL));
    for (int b = BAND_MWIR; b <= BAND_LWIR; b++) {
        double      *netd_k = b == BAND_MWIR ? &noise->netd_mwir_k : &noise->netd_lwir_k, low_m, high_m, slope;
        const double mean   = mean_radiance(picture, b);
        if (!chain[b] || !(mean > 0)) continue;
        preset_band(&low_m, &high_m, (Band)b, OPTICAL_PAN, -1);
        planck_band(low_m, high_m, planck_band_inverse(low_m, high_m, mean), &slope);
        *netd_k = chain_sigma(chain[b], 0, mean) / slope;
    }
}

/* The display of one band: gain and level, quantisation; and noise, without a sensor. In radiance, or in counts of
 * the band's sensor. */
static DetectorConfig detector_of(const FrameFiles *frame, int band)
{
    const Config  *c     = frame->config;
    const Chain   *chain = frame->chain[band];
    DetectorConfig d     = detector_default_config();
    d.bits               = c->detector.bits;
    d.gain               = c->detector.gain;
    d.offset             = c->detector.offset;
    d.auto_level         = strcmp(c->detector.level, "auto") == 0;
    if (band == BAND_OPTICAL) {
        d.display_gamma = true;
        if (!chain) d.min_span = 1e-3; /* W/(m2 sr): grey surfaces below some 4 lux; a night is displayed dark */
        d.noise_sigma   = optical_sigma(frame->noise_of ? frame->noise_of : frame->picture, c);
        d.level_low     = 0;
        d.level_high    = c->detector.optical_high_w_m2_sr;
    } else {
        const bool   mwir = band == BAND_MWIR;
        double       low_m, high_m, slope; /* W/(m2 sr K) at 300 K, where the figure is defined */
        preset_band(&low_m, &high_m, (Band)band, OPTICAL_PAN, -1);
        const double at_300_k = planck_band(low_m, high_m, 300, &slope);
        d.noise_sigma = c->detector.noise * slope * (mwir ? c->detector.netd_mwir_k : c->detector.netd_lwir_k);
        d.min_span    = 2 * slope; /* never stretch less than 2 K over the display */
        d.level_low   = planck_band(low_m, high_m, mwir ? c->detector.mwir_low_k : c->detector.lwir_low_k, NULL);
        d.level_high  = planck_band(low_m, high_m, mwir ? c->detector.mwir_high_k : c->detector.lwir_high_k, NULL);
        if (chain)
            d.min_span = chain_counts_at(chain, 0, at_300_k + d.min_span) - chain_counts_at(chain, 0, at_300_k);
    }
    if (chain) {
        d.level_low  = chain_counts_at(chain, 0, d.level_low);
        d.level_high = chain_counts_at(chain, 0, d.level_high);
    }
    return d;
}

/* White balance for the light of this frame, in radiance or in counts. Photons of a band are in proportion to its
 * radiance, so white is taken at a radiance that any sensor can count. */
static DisplayColour colour_of(const FrameFiles *frame)
{
    const Chain  *chain = frame->chain[BAND_OPTICAL];
    const double *white = frame->picture->white_w_m2_sr, mean = (white[0] + white[1] + white[2]) / 3;
    DisplayColour colour;
    if (!chain || !(mean > 0)) {
        display_colour(&colour, white, chain ? chain_counts_at(chain, 0, 0) : 0, INFINITY);
        return colour;
    }
    const double zero = chain_counts_at(chain, 0, 0);
    double       counts[3];
    for (int c = 0; c < 3; c++) counts[c] = chain_counts_at(chain, c, white[c] / mean) - zero;
    display_colour(&colour, counts, zero, chain_full(chain) - zero);
    return colour;
}

static Status write_raw(const FrameFiles *frame, int band, int planes)
{
    const Chain *chain = frame->chain[band];
    const int    w     = frame->picture->width, h = frame->picture->height;
    const size_t count = (size_t)w * (size_t)h;
    char         path[frame_path_size];
    if (!frame_path(path, frame, "raw", band_name((Band)band), "png")) return STATUS_BAD_VALUE;
    if (planes == 1) return image_write_png(path, chain_counts(chain, 0), w, h, 1, 16);
    uint16_t *rgb = malloc(3 * count * sizeof *rgb);
    if (!rgb) return STATUS_NO_MEMORY;
    for (int c = 0; c < 3; c++)
        for (size_t i = 0; i < count; i++) rgb[3 * i + (size_t)c] = chain_counts(chain, c)[i];
    const Status status = image_write_png(path, rgb, w, h, 3, 16);
    free(rgb);
    return status;
}

/* The input of a display of a band, before its level: counts or radiance with noise, of R G B balanced. noisy:
 * memory for three planes. Returns gain and level of this frame alone. */
static DetectorLevel detect(const float *out[3], int *planes, DetectorConfig *detector, float *noisy,
                            const FrameFiles *frame, int band)
{
    const Picture *p     = frame->picture;
    const size_t   count = (size_t)p->width * (size_t)p->height;
    Chain         *chain = frame->chain[band];
    const float   *in[3] = {NULL, NULL, NULL};
    *planes   = band_radiance(in, p, band);
    *detector = detector_of(frame, band);
    for (int c = 0; c < 3; c++) out[c] = noisy + (size_t)c * count;
    if (chain) {
        chain_run(chain, in, &p->small, frame->frame, frame->rate_px_s);
        for (int c = 0; c < *planes; c++) out[c] = chain_values(chain, c);
    } else {
        for (int c = 0; c < *planes; c++)
            detector_noise(noisy + (size_t)c * count, in[c], 0, count, detector->noise_sigma,
                           (uint64_t)frame->config->seed, (uint32_t)(3 * band + c), (uint32_t)frame->frame);
    }
    if (*planes == 3) {
        float *const        coloured[3] = {noisy, noisy + count, noisy + 2 * count};
        const DisplayColour colour      = colour_of(frame);
        display_colour_apply(coloured, out, count, &colour);
        for (int c = 0; c < 3; c++) out[c] = coloured[c];
        /* counts of a white whose mean over the bands is 1 W/(m2 sr) */
        if (chain && colour.white > 0)
            detector->level_high = colour.zero + colour.white * frame->config->detector.optical_high_w_m2_sr;
    }
    return detector_level(detector, out, *planes, count);
}

/* One task per band at a time, frame after frame: the state of the level is its own. */
static DetectorLevel follow_level(FrameLevel *state, DetectorLevel now, double time_s, double agc_s)
{
    if (!state->known) state->level = now;
    detector_level_follow(&state->level, now, time_s - state->time_s, agc_s);
    state->known  = true;
    state->time_s = time_s;
    return state->level;
}

static bool level_remembers(const FrameFiles *frame)
{
    return strcmp(frame->config->detector.level, "auto") == 0 && frame->config->detector.agc_s > 0;
}

Status display_levels(DisplayLevels *now, const FrameFiles *frame)
{
    const size_t count = (size_t)frame->picture->width * (size_t)frame->picture->height;
    const float *out[3];
    int          planes;
    DetectorConfig detector;
    *now = (DisplayLevels){.time_s = frame->time_s};
    if (!level_remembers(frame)) return STATUS_OK;
    float *noisy = malloc(count * 3 * sizeof *noisy);
    if (!noisy) return STATUS_NO_MEMORY;
    for (int b = 0; b < BAND_COUNT; b++) {
        if (!(frame->request->bands & detector_bands & 1u << b)) continue;
        now->level[b] = detect(out, &planes, &detector, noisy, frame, b);
        now->bands |= 1u << b;
    }
    free(noisy);
    return STATUS_OK;
}

void display_follow(FrameLevel level[BAND_COUNT], const DisplayLevels *now, double agc_s)
{
    for (int b = 0; b < BAND_COUNT; b++)
        if (now->bands >> b & 1) follow_level(&level[b], now->level[b], now->time_s, agc_s);
}

/* Runs the band's detector; display image and raw counts, as requested. */
Status display_write(const FrameFiles *frame, int band)
{
    char           path[frame_path_size];
    const Picture *p      = frame->picture;
    const size_t   count  = (size_t)p->width * (size_t)p->height;
    const int      bits   = band == BAND_COUNT ? 8 : frame->config->detector.bits;
    const bool     rgb    = band == BAND_COUNT || (band == BAND_OPTICAL && p->optical[1]);
    uint8_t       *shown  = malloc(count * 6);
    float         *noisy  = malloc(count * 3 * sizeof *noisy);
    Status         status = STATUS_NO_MEMORY;
    if (!shown || !noisy) goto done;
    status = STATUS_OK;

    if (band == BAND_COUNT) {
        truth_preview(shown, p->range_m, p->entity, p->normal[2], count, frame->snapshot);
    } else if (band == BAND_RADAR) {
        detector_display_db(shown, p->radar, count, detector_radar_range_db, bits);
    } else {
        const float   *out[3];
        int            planes;
        DetectorConfig detector;
        DetectorLevel  level = detect(out, &planes, &detector, noisy, frame, band);
        if (frame->chain[band] && frame->config->detector.raw) status = write_raw(frame, band, planes);
        if (detector.auto_level)
            level = follow_level(&frame->level[band], level, frame->time_s, frame->config->detector.agc_s);
        frame->level[band].shown = level;
        if (rgb)
            detector_display_rgb(shown, out, count, &detector, level);
        else
            detector_display(shown, out[0], count, &detector, level);
    }
    if (frame->png && status == STATUS_OK)
        status = frame_path(path, frame, "frames", band < BAND_COUNT ? band_name((Band)band) : "truth", "png")
                     ? image_write_png(path, shown, p->width, p->height, rgb ? 3 : 1, bits)
                     : STATUS_BAD_VALUE;

done:
    free(shown);
    free(noisy);
    return status;
}
