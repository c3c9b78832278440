/* sensor/probe.c: `pitviper probe` for detectors: MTF, NETD, three-dimensional noise and MRTD as rows of CSV. */
#include "sensor/probe.h"

#include "sensor/acquisition/acquisition.h"
#include "sensor/acquisition/observer_eye.h"
#include "sensor/detector/chain.h"
#include "sensor/detector/mrtd.h"
#include "sensor/detector/array_noise.h"
#include "sensor/detector/photons.h"
#include "sensor/detector/preset.h"
#include "sensor/settings/sensors.h"

#include <stdlib.h>

static double or_else(const ProbeValue *value, double otherwise)
{
    return isnan(value->number) ? otherwise : value->number;
}

static bool whole(double x, double low, double high) { return x >= low && x <= high && floor(x) == x; }

/* ---- mtf -------------------------------------------------------------------------------------- */

static const char *mtf_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    (void)state;
    const double   wavelength_um = in[0].number, f_number = in[1].number, pitch_um = in[3].number, f = in[6].number;
    const MtfChain chain = {.cutoff_cyc_px = pitch_um / (wavelength_um * f_number),
                            .obscuration = or_else(&in[2], 0),
                            .footprint_px = 1,
                            .places = 1,
                            .smear_px = {or_else(&in[4], 0), 0},
                            .jitter_px = or_else(&in[5], 0)};
    if (!(wavelength_um > 0 && f_number > 0 && pitch_um > 0))
        return "wavelength_um, f_number and pitch_um must be above 0";
    if (!(chain.obscuration >= 0 && chain.obscuration <= 0.95)) return "obscuration must be in 0 .. 0.95";
    if (!(chain.smear_px[0] >= 0 && chain.jitter_px >= 0)) return "smear_px and jitter_px must not be negative";
    out[0].number = mtf_optics(&chain, f, 0);
    out[1].number = mtf_footprint(&chain, f, 0);
    out[2].number = mtf_smear(&chain, f, 0);
    out[3].number = mtf_jitter(&chain, f, 0);
    out[4].number = mtf_chain(&chain, f, 0);
    return NULL;
}

/* ---- netd ------------------------------------------------------------------------------------- */

static const char *netd_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    (void)state;
    const PhotonDetector d = {.low_m = in[0].number * 1e-6,
                              .high_m = in[1].number * 1e-6,
                              .f_number = in[3].number,
                              .transmission = in[4].number,
                              .qe = in[5].number,
                              .pitch_m = in[6].number * 1e-6,
                              .integration_s = in[7].number * 1e-3,
                              .dark_e = or_else(&in[8], 0),
                              .read_e = or_else(&in[9], 0)};
    if (!(d.low_m > 0 && d.high_m > d.low_m)) return "lo_um must be above 0 and below hi_um";
    if (!(in[2].number > 0)) return "temp_k must be above 0";
    if (!(d.f_number > 0 && d.pitch_m > 0 && d.integration_s > 0))
        return "f_number, pitch_um and integration_ms must be above 0";
    if (!(d.transmission > 0 && d.transmission <= 1 && d.qe > 0 && d.qe <= 1))
        return "transmission and qe must be in 0 .. 1";
    if (!(d.dark_e >= 0 && d.read_e >= 0)) return "dark_e and read_e must not be negative";
    out[0].number = photon_electrons(&d, in[2].number, &out[1].number);
    out[2].number = 1e3 * photon_netd_k(&d, in[2].number, 0, 0);
    return NULL;
}

/* ---- noise ------------------------------------------------------------------------------------ */

static bool read_sigmas(Noise3d *out, const ProbeValue *in)
{
    for (int k = 0; k < noise_axes; k++) {
        out->sigma[k] = or_else(&in[k], 0);
        if (!(out->sigma[k] >= 0)) return false;
    }
    return true;
}

static const char *noise_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    (void)state;
    Noise3d      noise;
    const double seed = or_else(&in[10], 1);
    for (int k = 0; k < 3; k++)
        if (!whole(in[k].number, 0, 1e9)) return "frame, row and column must be whole numbers in 0 .. 1000000000";
    if (!read_sigmas(&noise, in + 3)) return "a sigma must not be negative";
    if (!whole(seed, 0, 2147483647)) return "seed must be a whole number in 0 .. 2147483647";
    out[0].number = noise3d_at(&noise, (uint64_t)seed, 0, (int)in[0].number, (int)in[1].number, (int)in[2].number);
    return NULL;
}

static const char *noise3d_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    (void)state;
    Noise3d      noise, got;
    const double seed = or_else(&in[10], 1), size = in[0].number * in[1].number * in[2].number;
    for (int k = 0; k < 3; k++)
        if (!whole(in[k].number, 2, 4096)) return "frames, rows and columns must be whole numbers in 2 .. 4096";
    if (size > 1 << 26) return "frames x rows x columns must be at most 67108864";
    if (!read_sigmas(&noise, in + 3)) return "a sigma must not be negative";
    if (!whole(seed, 0, 2147483647)) return "seed must be a whole number in 0 .. 2147483647";

    const int    frames = (int)in[0].number, rows = (int)in[1].number, columns = (int)in[2].number;
    const size_t plane = (size_t)rows * (size_t)columns;
    float       *cube = calloc((size_t)frames * plane, sizeof *cube);
    double      *line = malloc((size_t)columns * sizeof *line);
    Status       status = cube && line ? STATUS_OK : STATUS_NO_MEMORY;
    for (int k = 0; k < frames && status == STATUS_OK; k++) {
        noise3d_add_fixed(cube + (size_t)k * plane, columns, rows, &noise, (uint64_t)seed, 0);
        noise3d_add_moving(cube + (size_t)k * plane, columns, rows, &noise, &(NoiseDraw){(uint64_t)seed, 0, k}, line);
    }
    if (status == STATUS_OK) status = noise3d_estimate(&got, cube, frames, rows, columns);
    free(cube);
    free(line);
    if (status != STATUS_OK) return "out of memory";
    for (int k = 0; k < noise_axes; k++) out[k].number = got.sigma[k];
    return NULL;
}

/* ---- mrtd ------------------------------------------------------------------------------------- */

/* Opens `mrtd [SHEET]`: it takes every row of the sheet, in place of a preset of etc/sensors.csv. */
static Status mrtd_open(void **state, int argc, char **argv)
{
    if (argc > 2) {
        log_error("mrtd: usage: probe mrtd [SHEET]: a sensor's data sheet (sensor.table) in place of the presets of "
                  "the rows");
        return STATUS_BAD_VALUE;
    }
    if (argc < 2) return STATUS_OK;
    SensorPreset *p = malloc(sizeof *p);
    if (!p) return STATUS_NO_MEMORY;
    const Status status = preset_read_sheet(p, argv[1]);
    if (status == STATUS_OK) *state = p;
    else free(p);
    return status;
}

static const char *mrtd_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    char               path[4096];
    SensorPreset       p;
    Mrtd               mrtd;
    const double       f = in[1].number, rate_hz = or_else(&in[2], 30), eye_s = or_else(&in[3], 0.2);
    const MrtdObserver observer = {
        .snr = or_else(&in[4], 2.5), .frames = rate_hz * eye_s, .temp_k = or_else(&in[5], 300)};
    if (state) p = *(const SensorPreset *)state;
    else if (!etc_path(path, sizeof path, "sensors.csv") || preset_read(&p, path, in[0].text) != STATUS_OK)
        return "preset is not a sensor of etc/sensors.csv";
    if (p.band == BAND_OPTICAL) return "the sensor is not thermal";
    if (!(f > 0 && f <= 0.5)) return "f_cyc_px must be above 0 and at most 0.5";
    if (!(rate_hz > 0 && rate_hz <= 1e5 && eye_s > 0 && eye_s <= 1e3))
        return "frame_hz and eye_s must be in 0 .. 100000 and 0 .. 1000";
    if (!(observer.snr > 0 && observer.temp_k >= 180 && observer.temp_k <= 1500))
        return "snr must be above 0, temp_k in 180 .. 1500";
    mrtd_predict(&mrtd, &p, f, &observer);
    const double pixel_mrad = 1e3 / view_focal_px((int)p.width_px, p.hfov_deg * rad_per_deg);
    out[0].number = f / pixel_mrad;
    for (int axis = 0; axis < 2; axis++) {
        out[1 + axis].number = mrtd.all_k[axis] < INFINITY ? mrtd.all_k[axis] : NAN;
        out[3 + axis].number = mrtd.first_k[axis] < INFINITY ? mrtd.first_k[axis] : NAN;
        out[5 + axis].number = mrtd.mtf[axis];
    }
    return NULL;
}

/* ---- an observer --------------------------------------------------------------------------------- */

static const char *eye_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    (void)state;
    const double f = in[0].number, luminance_cd_m2 = or_else(&in[1], 34.26), field_deg = or_else(&in[2], 25);
    if (!(f > 0 && f <= 1000)) return "f_cyc_deg must be above 0 and at most 1000";
    if (!(luminance_cd_m2 >= 0.01 && luminance_cd_m2 <= 1e4 && field_deg > 0 && field_deg <= 180))
        return "luminance_cd_m2 must be in 0.01 .. 10000, field_deg above 0 and at most 180";
    out[0].number = eye_threshold(f, luminance_cd_m2, field_deg);
    out[1].number = eye_transfer(f / rad_per_deg * 1e-3, luminance_cd_m2);
    return NULL;
}

typedef struct Observed {
    char        name[64];
    Acquisition curves;
} Observed;

static Status observed_open(void **state, int argc, char **argv)
{
    (void)argv;
    if (argc > 1) {
        log_error("acquisition: usage: probe acquisition, without arguments");
        return STATUS_BAD_VALUE;
    }
    *state = calloc(1, sizeof(Observed));
    return *state ? STATUS_OK : STATUS_NO_MEMORY;
}

static const char *observed_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    char         path[4096];
    SensorPreset p;
    Observed    *o = state;
    MrtdNoise    noise;
    const double contrast = in[1].number, level = in[2].number, temp_k = isnan(level) ? 288 : level;
    if (!etc_path(path, sizeof path, "sensors.csv") || preset_read(&p, path, in[0].text) != STATUS_OK)
        return "preset is not a sensor of etc/sensors.csv";
    sensors_alone(&p);
    if (strcmp(o->name, p.name) != 0) { /* the curves of the row before */
        const AcquisitionObserver observer = acquisition_default_observer();
        acquisition_prepare(&o->curves, &p, &observer);
        snprintf(o->name, sizeof o->name, "%s", p.name);
    }
    if (p.band == BAND_OPTICAL) {
        const double signal_e = isnan(level) ? chain_exposed_share * preset_photons(&p).well_e : level;
        if (!(signal_e > 0 && signal_e <= 1e12)) return "level must be electrons above 0, at most 1e12";
        mrtd_noise_reflected(&noise, &p, signal_e, 0);
    } else if (!(temp_k >= 180 && temp_k <= 1500)) return "level must be a background of 180 .. 1500 K";
    else mrtd_noise_emitted(&noise, &p, temp_k);
    out[0].number = acquisition_cycles_px(&o->curves, &noise, contrast);
    out[1].number = acquisition_ttp_px(&o->curves, &noise, contrast);
    return NULL;
}

#define SIGMAS "sigma_tvh,sigma_tv?,sigma_th?,sigma_vh?,sigma_t?,sigma_v?,sigma_h?,seed?"

const Probe sensor_probes[] = {
    {.name = "mtf",
     .help = "modulation transfer of optics, a pixel's footprint, smear and jitter, along one axis",
     .in = "wavelength_um,f_number,obscuration?,pitch_um,smear_px?,jitter_px?,f_cyc_px",
     .out = "mtf_optics,mtf_detector,mtf_smear,mtf_jitter,mtf",
     .row = mtf_row},
    {.name = "netd",
     .help = "electrons from a black body and the noise equivalent temperature difference of their counting",
     .in = "lo_um,hi_um,temp_k,f_number,transmission,qe,pitch_um,integration_ms,dark_e?,read_e?",
     .out = "electrons,electrons_per_k,netd_mk",
     .row = netd_row},
    {.name = "noise",
     .help = "three-dimensional noise (D'Agostino & Webb) at one pixel of one frame",
     .in = "frame,row,column," SIGMAS,
     .out = "noise",
     .row = noise_row},
    {.name = "noise3d",
     .help = "generates frames of three-dimensional noise and estimates their components, unbiased",
     .in = "frames,rows,columns," SIGMAS,
     .out = "est_tvh,est_tv,est_th,est_vh,est_t,est_v,est_h",
     .row = noise3d_row},
    {.name = "mrtd",
     .help = "minimum resolvable temperature difference of four-bar targets (FLIR92's formulation), vertical and "
             "horizontal bars; first: only their first harmonic",
     .arguments = "[SHEET]",
     .in = "preset$?,f_cyc_px,frame_hz?,eye_s?,snr?,temp_k?",
     .out = "f_cyc_mrad,mrtd_v_bars_k,mrtd_h_bars_k,first_v_bars_k,first_h_bars_k,mtf_h,mtf_v",
     .open = mrtd_open,
     .row = mrtd_row,
     .close = free},
    {.name = "eye",
     .help = "contrast threshold of an observer's eyes in front of a display (Barten 1990), and their transfer",
     .in = "f_cyc_deg,luminance_cd_m2?,field_deg?",
     .out = "threshold,transfer",
     .row = eye_row},
    {.name = "acquisition",
     .help = "what an observer of a sensor resolves at a contrast (K; reflected light: a share): cycles a pixel by the "
             "MRTD, and TTP a pixel; level: K of the background, or its electrons",
     .in = "preset$,contrast,level?",
     .out = "cycles_px,ttp_px",
     .open = observed_open,
     .row = observed_row,
     .close = free},
};
const int sensor_probe_count = sizeof sensor_probes / sizeof *sensor_probes;
