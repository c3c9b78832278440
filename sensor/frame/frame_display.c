/* sensor/frame/frame_display.c: bands behind their detectors, with gain and level. */
#include "sensor/frame/frame_display.h"

#include "sensor/detector/display_values.h"
#include "sensor/detector/array_noise.h"

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
    const size_t count = (size_t)picture->width * (size_t)picture->height;
    const int    planes = band_radiance(plane, picture, band);
    double       sum = 0;
    for (int c = 0; c < planes; c++)
        for (size_t i = 0; i < count; i++) sum += plane[c][i];
    return planes ? fmax(0, sum / ((double)count * planes)) : 0;
}

/* Noise without a sensor: a share of the image's mean in each optical channel. */
static double optical_sigma(const Picture *picture, const Config *config)
{
    return config->detector.noise * config->detector.noise_optical * mean_radiance(picture, BAND_OPTICAL);
}

/* Least light that a camera without a data sheet resolves, W/(m2 sr): a twentieth of the least span of its display.
 * Grey surfaces give it at some 0.2 lux; ordinary colour cameras end at 0.1 to 0.5 lux. */
static const double optical_least_span = 1e-3, optical_dark_sigma = 5e-5;

/* Dry ground and roofs in the sun stay below 350 K; engines, exhausts and fires do not. In channels of reflected
 * sunlight nothing is told by it. */
static const double hottest_ground_k = 350;

Status camera_open(Camera *out, const Sensors *sensors, const Config *config, bool noise)
{
    const int places = render_places(config->sensor.samples, config_adaptive(config) ? config->sensor.edge_samples : 0);
    Status    status = STATUS_OK;
    *out = (Camera){.chain = {NULL}};
    for (int b = 0; b < BAND_COUNT && status == STATUS_OK; b++) {
        SensorPreset preset = sensors->preset[b];
        if (!noise) preset.noise_scale = 0;
        if (sensors->has[b])
            status = chain_create(&out->chain[b], &preset, config->sensor.width_px, config->sensor.height_px, places,
                                  (uint64_t)config->seed);
    }
    if (status != STATUS_OK) camera_close(out);
    return status;
}

Status camera_observe(Camera *camera, const Sensors *sensors, const Config *config)
{
    const AcquisitionObserver observer = acquisition_default_observer();
    for (int b = 0; b < BAND_COUNT; b++) {
        if (!sensors->has[b]) continue;
        SensorPreset preset = sensors->preset[b];
        preset.width_px = config->sensor.width_px;
        preset.height_px = config->sensor.height_px;
        if (!camera->observed[b]) camera->observed[b] = malloc(sizeof *camera->observed[b]);
        if (!camera->observed[b]) return STATUS_NO_MEMORY;
        acquisition_prepare(camera->observed[b], &preset, &observer);
    }
    return STATUS_OK;
}

/* The noise that an observer sees at this mean radiance. Of R, G and B it is that of G, which is lower in their mean.
 */
static void noise_observed(MrtdNoise *out, const Camera *camera, int band, double mean_w_m2_sr)
{
    const Chain        *chain = camera->chain[band];
    const SensorPreset *p = &camera->observed[band]->preset;
    const bool          colours = band == BAND_OPTICAL && p->optical == OPTICAL_RGB;
    double              exposure, slope, per_unit_e;
    const double        signal_e = chain_signal_e(&exposure, chain, colours ? 1 : 0, mean_w_m2_sr);
    per_unit_e = signal_e;
    if (band != BAND_OPTICAL) {
        const SpectralBand seen = preset_seen((Band)band, OPTICAL_PAN, -1);
        planck_seen(&seen, planck_seen_inverse(&seen, mean_w_m2_sr), &slope);
        per_unit_e = (chain_signal_e(NULL, chain, 0, 1.001 * mean_w_m2_sr) - signal_e) / (0.001 * mean_w_m2_sr) * slope;
    }
    mrtd_noise_of(out, p, signal_e, per_unit_e, exposure);
    if (colours) out->per_unit_e *= sqrt(3);
}

void camera_close(Camera *camera)
{
    for (int b = 0; b < BAND_COUNT; b++) {
        chain_destroy(camera->chain[b]);
        free(camera->observed[b]);
    }
    *camera = (Camera){.chain = {NULL}};
}

void camera_expose(TruthNoise *noise, Camera *camera, const Picture *picture, const Config *config)
{
    Chain *const *chain = camera->chain;
    const float  *plane[3];
    *noise = (TruthNoise){.netd_mwir_k = config->detector.noise * config->detector.netd_mwir_k,
                          .netd_lwir_k = config->detector.noise * config->detector.netd_lwir_k};
    for (int b = 0; b < BAND_COUNT; b++)
        if (chain[b] && band_radiance(plane, picture, b)) chain_expose(chain[b], plane);
    noise->optical_w_m2_sr = fmax(optical_sigma(picture, config), optical_dark_sigma);
    for (int b = BAND_OPTICAL; b <= BAND_LWIR; b++) {
        const double mean = chain[b] ? mean_radiance(picture, b) : 0;
        if (chain[b] && b == BAND_OPTICAL) noise->optical_w_m2_sr = chain_sigma(chain[b], 0, mean);
        if (!(mean > 0)) continue;
        if (b != BAND_OPTICAL) {
            double            *netd_k = b == BAND_MWIR ? &noise->netd_mwir_k : &noise->netd_lwir_k, slope;
            const SpectralBand seen = preset_seen((Band)b, OPTICAL_PAN, -1);
            planck_seen(&seen, planck_seen_inverse(&seen, mean), &slope);
            *netd_k = chain_sigma(chain[b], 0, mean) / slope;
        }
        noise->observed[b] = camera->observed[b];
        if (camera->observed[b]) noise_observed(&noise->bars[b], camera, b, mean);
    }
}

/* How a band is displayed: its gain, level and quantisation, and its noise where there is no sensor. In radiance, or in
 * counts of the band's sensor. */
static DetectorConfig detector_of(const DisplaysOf *of, int band)
{
    const Config  *c = of->config;
    const Chain   *chain = of->camera->chain[band];
    DetectorConfig d = detector_default_config();
    d.bits = c->detector.bits;
    d.gain = c->detector.gain;
    d.offset = c->detector.offset;
    d.auto_level = c->detector.level != DISPLAY_LEVEL_MANUAL;
    d.step = chain != NULL;
    if (band == BAND_OPTICAL) {
        d.display_gamma = true;
        if (!chain) d.min_span = optical_least_span; /* grey surfaces below some 4 lux; a night is displayed dark */
        d.noise_sigma = optical_sigma(of->noise_of ? of->noise_of : of->picture, c);
        d.level_low = 0;
        d.level_high = c->detector.optical_high_w_m2_sr;
    } else {
        const bool         mwir = band == BAND_MWIR;
        double             slope; /* W/(m2 sr K) at 300 K, where the figure is defined */
        const SpectralBand seen = preset_seen((Band)band, OPTICAL_PAN, -1);
        const double       at_300_k = planck_seen(&seen, 300, &slope);
        d.noise_sigma = c->detector.noise * slope * (mwir ? c->detector.netd_mwir_k : c->detector.netd_lwir_k);
        d.highlight = 1.5; /* with fire on up to half of the pixels normal noise keeps 0.56 of its contrast */
        d.fire_from = seen.low_m > 2.9e-6 ? planck_seen(&seen, hottest_ground_k, NULL) : INFINITY;
        d.plateau = c->detector.level == DISPLAY_LEVEL_PLATEAU ? c->detector.plateau : 0;
        d.min_span = 2 * slope; /* never stretch less than 2 K over the display */
        d.level_low = planck_seen(&seen, mwir ? c->detector.mwir_low_k : c->detector.lwir_low_k, NULL);
        d.level_high = planck_seen(&seen, mwir ? c->detector.mwir_high_k : c->detector.lwir_high_k, NULL);
        if (chain) d.min_span = chain_counts_at(chain, 0, at_300_k + d.min_span) - chain_counts_at(chain, 0, at_300_k);
        if (chain && d.fire_from < INFINITY)
            d.fire_from = fmin(chain_counts_at(chain, 0, d.fire_from), chain_full(chain));
    }
    if (chain) {
        d.level_low = chain_counts_at(chain, 0, d.level_low);
        d.level_high = chain_counts_at(chain, 0, d.level_high);
    }
    return d;
}

/* White balance for the light of this frame, in radiance or in counts. Photons of a band are in proportion to its
 * radiance, so white is taken at a radiance that any sensor can count. */
static DisplayColour colour_of(const DisplaysOf *of)
{
    const Chain  *chain = of->camera->chain[BAND_OPTICAL];
    const double *white = of->picture->white_w_m2_sr, mean = (white[0] + white[1] + white[2]) / 3;
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

/* Without a sensor: radiance with noise, of `count` pixels. */
static void add_noise(float *const memory[3], const FrameDisplay *d, const DisplaysOf *of, int band, size_t first,
                      size_t count)
{
    const float *in[3] = {NULL, NULL, NULL};
    band_radiance(in, of->picture, band);
    for (int c = 0; c < d->planes; c++)
        detector_noise(memory[c] + first, in[c] + first, first, count, d->detector.noise_sigma,
                       &(NoiseDraw){(uint64_t)of->config->seed, (uint32_t)(3 * band + c), (int)of->frame});
}

/* Prepares the input of a band's display, before its level: counts, or radiance with noise; R G B are balanced. */
static void detect(FrameDisplay *out, float *const memory[3], const DisplaysOf *of, int band)
{
    const Picture *p = of->picture;
    const size_t   count = (size_t)p->width * (size_t)p->height;
    Chain         *chain = of->camera->chain[band];
    const float   *in[3] = {NULL, NULL, NULL}, *seen[3];
    band_radiance(in, p, band);
    if (chain) chain_run(chain, in, &p->small, of->frame, of->rate_px_s);
    for (int c = 0; c < out->planes; c++) {
        seen[c] = chain ? chain_values(chain, c) : memory[c];
        out->plane[c] = memory[c];
    }
    if (out->planes == 3) {
        const DisplayColour colour = colour_of(of);
        display_colour_apply(memory, seen, count, &colour);
        /* counts of a white whose mean over the bands is 1 W/(m2 sr) */
        if (chain && colour.white > 0)
            out->detector.level_high = colour.zero + colour.white * of->config->detector.optical_high_w_m2_sr;
    } else if (chain) {
        memcpy(memory[0], seen[0], count * sizeof *memory[0]);
    }
}

/* Sets the level of one band, frame after frame; each band has its own state. */
static void set_level(FrameDisplay *d, FrameLevel *state, double time_s, double agc_s, size_t count)
{
    const double step_s = time_s - state->time_s;
    if (d->detector.plateau > 0) {
        detector_plateau(&d->curve, &d->detector, d->plane[0], count);
        if (!state->known) state->curve = d->curve;
        detector_plateau_follow(&state->curve, &state->quick, &d->curve, step_s, agc_s);
        d->curve = state->curve;
        d->level = (DetectorLevel){d->curve.value[0], d->curve.value[curve_steps]};
    } else {
        d->level = detector_level(&d->detector, d->plane, d->planes, count);
        if (!d->detector.auto_level) return;
        if (!state->known) state->level = d->level;
        detector_level_follow(&state->level, &state->quick, d->level, step_s, agc_s);
        d->level = state->level;
    }
    state->known = true;
    state->time_s = time_s;
}

/* ---- of a frame ------------------------------------------------------------------------------- */

typedef struct DisplayJobs {
    const DisplaysOf *of;
    FrameDisplay     *display;
    float            *memory[BAND_COUNT][3];
    uint16_t         *counts[BAND_COUNT][3];
    int               count, band[BAND_COUNT];
} DisplayJobs;

/* Makes the noise of some rows of a band; a task each, so that one band alone uses all threads. */
enum { noise_rows = 32 };

static int noise_tasks(const Picture *p) { return (p->height + noise_rows - 1) / noise_rows; }

static void run_noise(void *user, int worker, int task)
{
    DisplayJobs      *jobs = user;
    const DisplaysOf *of = jobs->of;
    const Picture    *p = of->picture;
    const int         band = jobs->band[task / noise_tasks(p)], row = task % noise_tasks(p) * noise_rows;
    const int         rows = p->height - row < noise_rows ? p->height - row : noise_rows;
    (void)worker;
    if (!of->camera->chain[band])
        add_noise(jobs->memory[band], &jobs->display[band], of, band, (size_t)row * (size_t)p->width,
                  (size_t)rows * (size_t)p->width);
}

static void run_job(void *user, int worker, int task)
{
    DisplayJobs      *jobs = user;
    const DisplaysOf *of = jobs->of;
    const int         band = jobs->band[task];
    const size_t      count = (size_t)of->picture->width * (size_t)of->picture->height;
    FrameDisplay     *d = &jobs->display[band];
    (void)worker;
    detect(d, jobs->memory[band], of, band);
    set_level(d, &of->camera->level[band], of->time_s, of->config->detector.agc_s, count);
    for (int c = 0; c < d->planes && jobs->counts[band][c]; c++) {
        memcpy(jobs->counts[band][c], chain_counts(of->camera->chain[band], c), count * sizeof(uint16_t));
        d->counts[c] = jobs->counts[band][c];
    }
}

Status frame_displays_make(FrameDisplay display[BAND_COUNT], const DisplaysOf *of, unsigned bands, Pool *pool,
                           Arena *arena)
{
    const Picture *p = of->picture;
    const size_t   count = (size_t)p->width * (size_t)p->height;
    const float   *in[3];
    TruthNoise     ignored;
    DisplayJobs    jobs = {.of = of, .display = display};
    memset(display, 0, BAND_COUNT * sizeof *display);
    if (bands >> BAND_RADAR & 1 && p->radar)
        display[BAND_RADAR] = (FrameDisplay){.planes = 1, .plane = {p->radar}, .decibels = true};
    for (int b = 0; b < BAND_COUNT; b++) {
        FrameDisplay *d = &display[b];
        if (b == BAND_RADAR || !(bands >> b & 1) || (d->planes = band_radiance(in, p, b)) == 0) continue;
        jobs.band[jobs.count++] = b;
        for (int c = 0; c < d->planes; c++) {
            if (!(jobs.memory[b][c] = arena_alloc(arena, count, sizeof(float)))) return STATUS_NO_MEMORY;
            if (!of->counts || !of->camera->chain[b]) continue;
            if (!(jobs.counts[b][c] = arena_alloc(arena, count, sizeof(uint16_t)))) return STATUS_NO_MEMORY;
            d->count_bits = (int)lround(log2(chain_full(of->camera->chain[b]) + 1));
        }
    }
    camera_expose(&ignored, of->camera, p, of->config);
    for (int k = 0; k < jobs.count; k++) display[jobs.band[k]].detector = detector_of(of, jobs.band[k]);
    pool_run(pool, jobs.count * noise_tasks(p), run_noise, &jobs);
    pool_run(pool, jobs.count, run_job, &jobs);
    return STATUS_OK;
}

void frame_display_quantise(void *out, const FrameDisplay *display, size_t count, int bits)
{
    DetectorConfig detector = display->detector;
    detector.bits = bits > 8 ? 16 : 8;
    if (display->decibels) detector_display_db(out, display->plane[0], count, detector_radar_range_db, detector.bits);
    else if (display->planes == 3) detector_display_rgb(out, display->plane, count, &detector, display->level);
    else if (detector.plateau > 0) detector_display_curve(out, display->plane[0], count, &detector, &display->curve);
    else detector_display(out, display->plane[0], count, &detector, display->level);
    uint16_t *value = out;
    if (bits > 8 && bits < 16)
        for (size_t i = 0; i < count * (size_t)display->planes; i++) value[i] >>= 16 - bits;
}
