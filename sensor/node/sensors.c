#include "sensor/node/sensors.h"

#include "render/render.h"

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
    p->smear       = config->detector.smear;
    p->optical     = config_optical(config);
    preset_refresh(p);
}

static void apply_raster(Config *config, const SensorPreset *p)
{
    if (!config_given(config, "sensor.width_px") && !config_given(config, "sensor.height_px")) {
        config->sensor.width_px  = (int)p->width_px;
        config->sensor.height_px = (int)p->height_px;
    }
    if (!config_given(config, "sensor.hfov_deg")) config->sensor.hfov_deg = p->hfov_deg;
}

static Status add_sensor(Sensors *s, const char *name, unsigned bands)
{
    char         path[4096];
    SensorPreset p;
    if (!etc_path(path, sizeof path, "sensors.csv")) return STATUS_BAD_VALUE;
    const Status status = preset_read(&p, path, name);
    if (status != STATUS_OK) return status;
    if (s->has[p.band]) {
        log_error("replay: sensor.preset: %s and %s are both for %s; choose one", s->preset[p.band].name, name,
                  band_name(p.band));
        return STATUS_BAD_VALUE;
    }
    if (!(bands >> p.band & 1)) {
        log_error("replay: sensor.preset: %s is for %s, which sensor.bands does not name", name, band_name(p.band));
        return STATUS_BAD_VALUE;
    }
    s->has[p.band]    = true;
    s->preset[p.band] = p;
    return STATUS_OK;
}

/* Noise that a sensor makes itself is not set beside it. */
static Status one_noise(const Sensors *s, const Config *config)
{
    static const char *const key[BAND_COUNT] = {"detector.noise_optical", "detector.netd_mwir_k", "detector.netd_lwir_k"};
    for (int b = 0; b < BAND_COUNT; b++)
        if (s->has[b] && key[b] && config_given(config, key[b])) {
            log_error("replay: %s: the noise of %s is that of its sensor, %s; leave one of them out (detector.noise is a "
                      "factor of both)", key[b], band_name((Band)b), s->preset[b].name);
            return STATUS_BAD_VALUE;
        }
    return STATUS_OK;
}

Status sensors_choose(Sensors *out, Choices *choices, Config *config, unsigned bands)
{
    Sensors s = {0};
    char    list[sizeof config->sensor.preset];
    bool    first = true;
    *out          = s;
    if (strcmp(config->sensor.preset, "none") == 0) return STATUS_OK;
    strcpy(list, config->sensor.preset);
    char *save = NULL;
    for (char *name = strtok_r(list, ",", &save); name; name = strtok_r(NULL, ",", &save)) {
        const Status added = add_sensor(&s, name, bands);
        if (added != STATUS_OK) return added;
        for (int b = 0; b < BAND_COUNT && first; b++)
            if (s.has[b]) apply_raster(config, &s.preset[b]);
        first = false;
    }
    if (first) {
        log_error("replay: sensor.preset: '%s' names no sensor; `none` or names of etc/sensors.csv",
                  config->sensor.preset);
        return STATUS_BAD_VALUE;
    }
    const Status status = one_noise(&s, config);
    if (status != STATUS_OK) return status;
    for (int b = 0; b < BAND_COUNT; b++) {
        SensorPreset *p = &s.preset[b];
        if (!s.has[b]) continue;
        apply_settings(p, config);
        const double step_e = p->photons.well_e / (exp2(p->bits) - 1);
        char         netd[40] = "";
        if (b != BAND_OPTICAL)
            snprintf(netd, sizeof netd, ", NEdT %.3g mK at 300 K", 1e3 * photon_netd_k(&p->photons, 300, step_e, 0));
        choice_add(choices, "%s: %s, F/%.3g, %.3g um pitch, %.4g ms%s, %g bits of %.4g electrons%s (sensor.preset)",
                   band_name((Band)b), p->name, p->photons.f_number, 1e6 * p->photons.pitch_m,
                   1e3 * p->photons.integration_s, p->auto_exposure ? " at most" : "", p->bits, step_e, netd);
    }
    *out = s;
    return STATUS_OK;
}

Status sensors_chains(Chain *chain[BAND_COUNT], const Sensors *sensors, const Config *config)
{
    const int places = render_places(config->sensor.samples, config_adaptive(config) ? config->sensor.edge_samples : 0);
    Status    status = STATUS_OK;
    for (int b = 0; b < BAND_COUNT && status == STATUS_OK; b++)
        if (sensors->has[b])
            status = chain_create(&chain[b], &sensors->preset[b], config->sensor.width_px, config->sensor.height_px,
                                  places, (uint64_t)config->seed);
    return status;
}
