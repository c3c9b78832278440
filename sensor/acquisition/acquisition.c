/* sensor/acquisition/acquisition.c: resolved cycles and the TTP value, from curves of a sensor that are made once. */
#include "sensor/acquisition/acquisition.h"

#include "sensor/acquisition/observer_eye.h"

/* Frequencies of the nodes, evenly in their logarithm. Below the first a target would be a thousand pixels high. */
static const double first_cyc_px = 1e-3, last_cyc_px = 0.5;
/* Root hertz: what makes the model's thresholds those that observers had. */
static const double alpha_root_hz = 169.6;

AcquisitionObserver acquisition_default_observer(void)
{
    return (AcquisitionObserver){
        .snr = 2.5, .frame_hz = 30, .eye_s = 0.2, .picture_rad = 0.4, .luminance_cd_m2 = 34.26, .scene = NAN};
}

static double pixel_mrad(const Acquisition *of) { return 1e3 * of->observer.picture_rad / of->preset.height_px; }

/* Power that the display's square pixels and the eye pass, at a frequency in cycles a pixel. */
static double passed(const Acquisition *of, double eye_mrad_px, double f)
{
    const double h = mtf_sinc(f) * eye_transfer(f / eye_mrad_px, of->observer.luminance_cd_m2);
    return h * h;
}

/* Power spectrum, of variance 1, of noise whose correlation is exp(-x / reach); white where that is within a pixel. */
static double line_spectrum(double reach_px, double f)
{
    const double w = 2 * pi_rad * reach_px * f;
    return reach_px > 0.5 ? 2 * reach_px / (1 + w * w) : 1;
}

/* Integrals over positive and negative frequencies of what is passed; the noise is white, or along the lines. */
static void all_frequencies(Acquisition *of)
{
    /* the eye passes less than 1e-7 beyond 6 cycles a milliradian. Evenly in the logarithm, since lines' noise has long
     * waves, and these from far below a picture's width */
    enum { steps = 4000 };
    const double eye_mrad_px = pixel_mrad(of), low = log(1e-7), high = log(6 * eye_mrad_px),
                 step = (high - low) / steps;
    of->all = of->all_line = 0;
    for (int i = 0; i <= steps; i++) {
        const double f = exp(low + i * step), power = 2 * passed(of, eye_mrad_px, f) * f * step * (i % steps ? 1 : 0.5);
        of->all += power;
        of->all_line += power * line_spectrum(of->preset.line_noise_px, f);
    }
}

void acquisition_node(AcquisitionNode *n, const Acquisition *of, double f_cyc_px)
{
    /* the channel's power is below 1e-17 beyond a factor of e^3 */
    enum { steps = 60 };
    static const double reach = 3;
    const SensorPreset *p = &of->preset;
    const double        eye_mrad_px = pixel_mrad(of), step = 2 * reach / steps, per_deg = 1e3 * rad_per_deg;
    const double        field_deg = eye_mrad_px / per_deg * sqrt(p->width_px * p->height_px);
    const double        ctf = eye_threshold(f_cyc_px / eye_mrad_px * per_deg, of->observer.luminance_cd_m2, field_deg);
    *n = (AcquisitionNode){.f_cyc_px = f_cyc_px};
    mrtd_bars(&n->bars, p, f_cyc_px);
    for (int axis = 0; axis < 2; axis++) {
        const double h = n->bars.mtf[axis] * mtf_sinc(f_cyc_px);
        n->threshold[axis] = h > 1e-6 ? ctf / h : INFINITY; /* beyond the first zero: not resolved */
    }
    for (int i = 0; i <= steps; i++) {
        const double f = f_cyc_px * exp(i * step - reach), b = eye_channel(f, f_cyc_px);
        const double power = 2 * b * b * passed(of, eye_mrad_px, f) * f * step;
        n->seen += power;
        n->seen_line += power * line_spectrum(of->preset.line_noise_px, f);
    }
}

void acquisition_prepare(Acquisition *out, const SensorPreset *p, const AcquisitionObserver *observer)
{
    out->preset = *p;
    out->observer = *observer;
    if (isnan(observer->scene)) out->observer.scene = p->band == BAND_OPTICAL ? 1 : 5;
    all_frequencies(out);
    const double step = log(last_cyc_px / first_cyc_px) / (acquisition_nodes - 1);
    for (int i = 0; i < acquisition_nodes; i++)
        acquisition_node(&out->node[i], out, i + 1 < acquisition_nodes ? first_cyc_px * exp(i * step) : last_cyc_px);
}

/* ---- cycles ---------------------------------------------------------------------------------------- */

/* Where a straight line in logarithms between two nodes has this value. */
static double between(double f0, double y0, double f1, double y1, double y)
{
    if (!(y1 < INFINITY)) return f0;
    return f0 * exp(log(f1 / f0) * log(y / y0) / log(y1 / y0));
}

double acquisition_cycles_px(const Acquisition *of, const MrtdNoise *noise, double contrast)
{
    const MrtdObserver observer = {.snr = of->observer.snr, .frames = of->observer.frame_hz * of->observer.eye_s};
    double             above_k[2] = {INFINITY, INFINITY}, cycles[2] = {0, 0};
    const double       c = fabs(contrast);
    Mrtd               at;
    if (!(c > 0)) return isnan(contrast) ? NAN : 0;
    for (int i = acquisition_nodes - 1; i >= 0 && !(cycles[0] > 0 && cycles[1] > 0); i--) {
        const double f = of->node[i].f_cyc_px;
        mrtd_at(&at, &of->node[i].bars, noise, &observer);
        for (int axis = 0; axis < 2; axis++) {
            if (!(cycles[axis] > 0) && at.all_k[axis] <= c)
                cycles[axis] = i + 1 == acquisition_nodes
                                   ? f
                                   : between(f, at.all_k[axis], of->node[i + 1].f_cyc_px, above_k[axis], c);
            above_k[axis] = at.all_k[axis];
        }
    }
    return sqrt(cycles[0] * cycles[1]);
}

/* ---- TTP ------------------------------------------------------------------------------------------- */

/* Noise that the eye's channel sees at a node, squared, per hertz, in the contrast's unit. */
static void noise_seen(double out2[2], const Acquisition *of, const AcquisitionNode *n, const MrtdNoise *noise)
{
    const AcquisitionObserver *o = &of->observer;
    const double *kind2 = noise->kind_e2, moving = 1 / o->frame_hz, fixed = o->eye_s, unit2 = noise->per_unit_e;
    const double  frames = fmax(o->frame_hz * o->eye_s, 1),
                 line2 = noise->line_e2 * fixed / fmin(frames, line_scan_pool);
    const double white = noise->tvh_e2 * moving + (kind2[NOISE_VH] + noise->gain_e2) * fixed;
    out2[0] = (white * of->all + kind2[NOISE_TH] * moving + kind2[NOISE_H] * fixed) * n->seen +
              line2 * n->seen_line * of->all;
    out2[1] = (white * of->all + kind2[NOISE_TV] * moving + (kind2[NOISE_V] + noise->row_gain_e2) * fixed) * n->seen +
              line2 * n->seen * of->all_line;
    for (int axis = 0; axis < 2; axis++) out2[axis] /= unit2 * unit2;
}

void acquisition_threshold(double ctf[2], const Acquisition *of, const AcquisitionNode *n, const MrtdNoise *noise)
{
    const double by = alpha_root_hz / of->observer.scene;
    double       seen2[2];
    noise_seen(seen2, of, n, noise);
    for (int axis = 0; axis < 2; axis++) ctf[axis] = n->threshold[axis] * sqrt(1 + by * by * seen2[axis]);
}

/* The trapezium of f sqrt(C / CTF) over a step of ln f, of y = C / CTF at its ends: as far as y is above 1. */
static double part(double f0, double y0, double f1, double y1)
{
    const double wide = log(f1 / f0);
    if (y0 <= 1 && y1 <= 1) return 0;
    if (y0 > 1 && y1 > 1) return 0.5 * wide * (f0 * sqrt(y0) + f1 * sqrt(y1));
    const double high = y0 > 1 ? y0 : y1, low = y0 > 1 ? y1 : y0, from = y0 > 1 ? f0 : f1;
    const double share = low > 0 ? log(high) / log(high / low) : 0, to = from * exp((y0 > 1 ? 1 : -1) * share * wide);
    return 0.5 * share * wide * (from * sqrt(high) + to);
}

double acquisition_ttp_px(const Acquisition *of, const MrtdNoise *noise, double contrast)
{
    double sum[2] = {0, 0}, before[2] = {0, 0};
    if (!(fabs(contrast) > 0)) return isnan(contrast) ? NAN : 0;
    const double c = fmin(fabs(contrast) / (2 * of->observer.scene), 1);
    for (int i = 0; i < acquisition_nodes; i++) {
        const AcquisitionNode *n = &of->node[i];
        double                 ctf[2];
        acquisition_threshold(ctf, of, n, noise);
        for (int axis = 0; axis < 2; axis++) {
            const double y = c / ctf[axis];
            if (i > 0) sum[axis] += part(of->node[i - 1].f_cyc_px, before[axis], n->f_cyc_px, y);
            before[axis] = y;
        }
    }
    return sqrt(sum[0] * sum[1]);
}
