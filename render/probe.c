#include "render/probe.h"

#include "render/atmosphere.h"
#include "render/planck.h"

#include <stdlib.h>

static const char *planck_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    (void)state;
    const double low_m = in[0].number * 1e-6, high_m = in[1].number * 1e-6, temp_k = in[2].number;
    if (!(low_m > 0 && high_m > low_m)) return "lo_um must be above 0 and below hi_um";
    if (!(temp_k > 0)) return "temp_k must be above 0";
    out[0].number = planck_band(low_m, high_m, temp_k, &out[1].number);
    return NULL;
}

/* ---- atmosphere -------------------------------------------------------------------------------- */

enum { probe_models_max = 8 };

/* Models are opened when a row first names them and kept; one that failed is kept as NULL. */
typedef struct AtmosphereProbe {
    int         count;
    char        name[probe_models_max][64];
    Atmosphere *model[probe_models_max];
} AtmosphereProbe;

static Status atmosphere_probe_open(void **state, int argc, char **argv)
{
    (void)argc;
    (void)argv;
    *state = calloc(1, sizeof(AtmosphereProbe));
    return *state ? STATUS_OK : STATUS_NO_MEMORY;
}

static void atmosphere_probe_close(void *state)
{
    AtmosphereProbe *probe = state;
    for (int i = 0; i < probe->count; i++) atmosphere_close(probe->model[i]);
    free(probe);
}

static const char *find_model(Atmosphere **out, AtmosphereProbe *probe, const char *name)
{
    int i = 0;
    while (i < probe->count && strcmp(probe->name[i], name) != 0) i++;
    if (i == probe->count) {
        if (i == probe_models_max || strlen(name) >= sizeof probe->name[i]) return "too many models, or name too long";
        if (atmosphere_open(&probe->model[i], name) != STATUS_OK) probe->model[i] = NULL;
        snprintf(probe->name[i], sizeof probe->name[i], "%s", name);
        probe->count++;
    }
    *out = probe->model[i];
    return *out ? NULL : "no such model, or its tables are spoilt (see the log)";
}

static const char *atmosphere_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    Atmosphere *model;
    const char *why = find_model(&model, state, in[0].text);
    if (why) return why;
    AirBand band = AIR_B;
    while (band < AIR_BAND_COUNT && strcmp(air_band_name(band), in[2].text) != 0) band++;
    if (band == AIR_BAND_COUNT) return "band must be b, g, r, pan, nir, mwir or lwir";
    const double visibility_m = in[1].number * 1e3, temp_k = in[6].number;
    if (!(visibility_m > 0)) return "visibility_km must be above 0";
    const bool sun = isfinite(in[7].number);
    const AirPath path = {in[3].number, in[4].number, in[5].number * 1e3, sun ? in[7].number * rad_per_deg : pi_rad,
                          isfinite(in[8].number) ? in[8].number * rad_per_deg : 0};
    if (!(path.observer_m >= 0 && path.target_m >= 0)) return "heights must be at or above the ground";
    /* a range rounded to print may fall short of a vertical path by its last digit */
    if (!(path.range_m > 0 && path.range_m >= 0.9999 * fabs(path.observer_m - path.target_m)))
        return "range_km must be above 0 and no less than the heights are apart";
    if (!(temp_k > 0)) return "temp_k must be above 0";
    PathAir air;
    atmosphere_path(&air, model, visibility_m, band, &path, temp_k);
    out[0].number = air.transmittance;
    out[1].number = air.thermal_w_m2_sr;
    out[2].number = air.sun_transmittance;
    if (sun) out[3].number = air.scattered_w_m2_sr;
    return NULL;
}

const Probe render_probes[] = {
    {.name = "planck", .help = "in-band radiance of a black body and its derivative in temperature",
     .in = "lo_um,hi_um,temp_k", .out = "radiance_w_m2_sr,dldt", .row = planck_row},
    {.name = "atmosphere", .help = "transmittance and path radiance from the tables of etc/atmosphere",
     .in = "model$,visibility_km,band$,observer_m,target_m,range_km,temp_k,sun_zenith_deg?,rel_azimuth_deg?",
     .out = "tau,path_radiance,sun_tau,scattered", .open = atmosphere_probe_open,
     .row = atmosphere_row, .close = atmosphere_probe_close},
};
const int render_probe_count = sizeof render_probes / sizeof *render_probes;
