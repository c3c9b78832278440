/* sensor/settings/sensors.c: assigns sensors to bands from sensor.preset and sensor.table, and sets the lens. */
#include "sensor/settings/sensors.h"

#include "render/frame/render.h"
#include "sensor/detector/preset.h"

static void over(double *field, double setting, double unit)
{
    if (!isnan(setting)) *field = setting * unit;
}

static void apply_settings(SensorPreset *p, const Config *config)
{
    over(&p->photons.f_number, config->detector.f_number, 1);
    over(&p->obscuration, config->detector.obscuration, 1);
    over(&p->photons.integration_s, config->detector.integration_ms, 1e-3);
    over(&p->jitter_px, config->detector.jitter_px, 1);
    over(&p->bad_share, config->detector.bad_share, 1);
    over(&p->ac_per_line, config->detector.ac_per_line, 1);
    over(&p->line_noise, config->detector.line_noise, 1);
    p->noise_scale = config->detector.noise;
    p->smear = config->detector.smear;
    p->optical = config_optical(config);
    preset_refresh(p);
}

static void apply_raster(Config *config, const SensorPreset *p)
{
    if (!config_given(config, "sensor.width_px") && !config_given(config, "sensor.height_px")) {
        config->sensor.width_px = (int)p->width_px;
        config->sensor.height_px = (int)p->height_px;
    }
    if (!config_given(config, "sensor.hfov_deg")) config->sensor.hfov_deg = p->hfov_deg;
}

Status sensors_find(SensorPreset *out, const char *name)
{
    char        path[4096];
    const char *own = etc_own("sensors.csv"), *from = path;
    if (!etc_path(path, sizeof path, "sensors.csv")) return STATUS_BAD_VALUE;
    if (own) {
        bool         has;
        const Status opened = preset_has(&has, own, name);
        if (opened != STATUS_OK) return opened;
        if (has) from = own;
    }
    return preset_read(out, from, name);
}

void sensors_alone(SensorPreset *p)
{
    channels_standard();
    if (p->channel && !p->channel->standard) channel_choose(p->channel);
    p->optical = p->channel && p->channel->place == SPECTRAL_NIR ? OPTICAL_NIR : OPTICAL_PAN;
    preset_refresh(p);
}

/* name: that of a preset; NULL: the sheet of sensor.table is added. */
static Status add_sensor(Sensors *s, const Config *config, const char *name, unsigned bands)
{
    SensorPreset p;
    const char  *key = name ? "sensor.preset" : "sensor.table";
    const Status status = name ? sensors_find(&p, name) : preset_read_sheet(&p, config->sensor.table);
    if (status == STATUS_BAD_VALUE && *config_where(config, key))
        log_error("config: %s%s: see the error above", config_where(config, key), key);
    if (status != STATUS_OK) return status;
    if (s->has[p.band]) {
        log_error("replay: %s: %s and %s are both for %s; choose one", key, s->preset[p.band].name, p.name,
                  band_name(p.band));
        return STATUS_BAD_VALUE;
    }
    const bool seen = p.channel ? channel_in(p.channel->place) == p.channel
                                : p.band != BAND_OPTICAL || channel_in(SPECTRAL_NIR)->standard;
    if (!(bands >> p.band & 1) || (name && !seen)) {
        log_error("replay: %s: %s is for %s, which sensor.bands does not name", key, p.name,
                  p.channel ? p.channel->name : "optical");
        return STATUS_BAD_VALUE;
    }
    s->has[p.band] = true;
    s->preset[p.band] = p;
    if (!name) s->sheet_band = p.band;
    return STATUS_OK;
}

/* The first preset decides raster and field of view. */
static Status take_sensor(Sensors *s, int *first_band, Config *config, const char *name, unsigned bands)
{
    const Status status = add_sensor(s, config, name, bands);
    if (status != STATUS_OK || *first_band >= 0) return status;
    for (int b = 0; b < BAND_COUNT; b++)
        if (s->has[b]) apply_raster(config, &s->preset[ *first_band = b]);
    return status;
}

/* Refuses a noise setting for a band whose sensor has its own noise. */
static Status one_noise(const Sensors *s, const Config *config)
{
    static const char *const key[BAND_COUNT] = {"detector.noise_optical", "detector.netd_mwir_k",
                                                "detector.netd_lwir_k"};
    for (int b = 0; b < BAND_COUNT; b++)
        if (s->has[b] && key[b] && config_given(config, key[b])) {
            log_error("replay: %s: the noise of %s is set by its sensor, %s; remove one of them (detector.noise is a "
                      "factor on both)",
                      key[b], band_name((Band)b), s->preset[b].name);
            return STATUS_BAD_VALUE;
        }
    return STATUS_OK;
}

/* first: NULL without a preset. */
static Status choose_lens(Sensors *s, Choices *choices, const Config *config, const SensorPreset *first)
{
    const double given[7] = {config->sensor.lens_k1,  config->sensor.lens_k2, config->sensor.lens_k3,
                             config->sensor.lens_p1,  config->sensor.lens_p2, config->sensor.lateral_r,
                             config->sensor.lateral_b};
    const double focal_px = view_focal_px(config->sensor.width_px, config->sensor.hfov_deg * rad_per_deg);
    const double half[2] = {0.5 * config->sensor.width_px / focal_px, 0.5 * config->sensor.height_px / focal_px};
    double       value[7] = {0};
    for (int k = 0; k < 5; k++) value[k] = first ? first->lens[k] : 0;
    for (int k = 0; k < 2; k++) value[5 + k] = first ? first->lateral[k] : 0;
    for (int k = 0; k < 7; k++) over(&value[k], given[k], 1);
    memcpy(s->lateral, value + 5, sizeof s->lateral);
    if (view_lens_make(&s->lens, value, value + 3, half) != STATUS_OK) {
        log_error(
            "replay: the distortion of the lens (k1=%g, k2=%g, k3=%g, p1=%g, p2=%g) is not invertible within a field "
            "of view of %.4g x "
            "%.4g degrees, or compresses it tenfold; give smaller sensor.lens_k1 .. sensor.lens_p2",
            value[0], value[1], value[2], value[3], value[4], 2 * atan(half[0]) / rad_per_deg,
            2 * atan(half[1]) / rad_per_deg);
        return STATUS_BAD_VALUE;
    }
    double corner[2] = {half[0], half[1]};
    if (s->lens.reach > 0) view_lens_back(corner, &s->lens, half[0], half[1]);
    if (s->lens.reach > 0)
        choice_add(choices,
                   "lens: k1=%.4g k2=%.4g k3=%.4g p1=%.4g p2=%.4g: %+.2f %% at the corner (sensor.lens_k1 ...)",
                   value[0], value[1], value[2], value[3], value[4],
                   100 * (hypot(half[0], half[1]) / hypot(corner[0], corner[1]) - 1));
    if (value[5] != 0 || value[6] != 0)
        choice_add(choices,
                   "lateral colour: R %+.3g px and B %+.3g px against G at the edge of the image (sensor.lateral_r)",
                   0.5 * config->sensor.width_px * value[5], 0.5 * config->sensor.width_px * value[6]);
    return STATUS_OK;
}

Status sensors_choose(Sensors *out, Choices *choices, Config *config, unsigned bands)
{
    Sensors    s = {0};
    char       list[sizeof config->sensor.preset];
    int        first_band = -1;
    const bool named = strcmp(config->sensor.preset, "none") != 0;
    Status     status = STATUS_OK;
    *out = s;
    if (!named && !*config_sheet(config)) return choose_lens(out, choices, config, NULL);
    if (*config_sheet(config)) status = take_sensor(&s, &first_band, config, NULL, bands);
    strcpy(list, named ? config->sensor.preset : "");
    char *save = NULL;
    for (char *name = strtok_r(list, ",", &save); name && status == STATUS_OK; name = strtok_r(NULL, ",", &save))
        status = take_sensor(&s, &first_band, config, name, bands);
    if (status != STATUS_OK) return status;
    if (first_band < 0) {
        log_error("replay: sensor.preset: '%s' is empty; `none` or names of etc/sensors.csv", config->sensor.preset);
        return STATUS_BAD_VALUE;
    }
    status = one_noise(&s, config);
    if (status == STATUS_OK) status = choose_lens(&s, choices, config, &s.preset[first_band]);
    if (status != STATUS_OK) return status;
    for (int b = 0; b < BAND_COUNT; b++) {
        SensorPreset *p = &s.preset[b];
        if (!s.has[b]) continue;
        apply_settings(p, config);
        const PhotonDetector photons = preset_photons(p);
        const double         step_e = p->photons.well_e / (exp2(p->bits) - 1);
        char                 netd[40] = "";
        if (b != BAND_OPTICAL)
            snprintf(netd, sizeof netd, ", NEdT %.3g mK at 300 K", 1e3 * photon_netd_k(&photons, 300, step_e, 0));
        choice_add(choices, "%s: %s, F/%.3g, %.3g um pitch, %.4g ms%s, %g bits of %.4g electrons%s (%s)",
                   band_name((Band)b), p->name, p->photons.f_number, 1e6 * p->photons.pitch_m,
                   1e3 * p->photons.integration_s, p->auto_exposure ? " at most" : "", p->bits, step_e, netd,
                   b > 0 && b == s.sheet_band ? "sensor.table" : "sensor.preset");
    }
    *out = s;
    return STATUS_OK;
}
