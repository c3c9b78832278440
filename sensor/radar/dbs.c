/* sensor/radar/dbs.c: a scan looked up for one place; Doppler beam sharpening; its picture over range and azimuth, and
 * over the frame's pixels. */
#include "sensor/radar/scan_private.h"

enum { cells_a_resolution = 3, finer_most = 64 };

/* ---- one place ---------------------------------------------------------------------------------- */

/* Range cell of the place in a position, and the direction to it then. -1: not within the window. */
static int column_of(Sight *sight, const ScanWork *w, int position, const double p_enu[3], const double v_enu_mps[3])
{
    const Making *beam = &w->beam[position];
    double        p[3];
    v3_add_scaled(p, p_enu, beam->after_s, v_enu_mps);
    making_sight(sight, beam, p, 0);
    const double appears_m = making_appears_m(beam, sight, making_range_rate(beam, sight, v_enu_mps));
    const double at = floor((appears_m - beam->reference_m) / w->metre_per_column + w->scan->columns / 2 + 0.5);
    return sight->within && at >= 0 && at < w->scan->columns ? (int)at : -1;
}

/* Power of the real beam at x positions from the first. */
static bool real_beam(double *power_w, const ScanWork *w, double x, const double p_enu[3], const double v_enu_mps[3])
{
    const RadarScan *s = w->scan;
    const int        last = s->plan.positions - 1, base = (int)clamp(floor(x), 0, last > 0 ? last - 1 : 0);
    const double     f = clamp(x - base, 0, 1);
    double           ln[4];
    for (int k = 0; k < 4; k++) {
        Sight     sight;
        const int i = base - 1 + k < 0 ? 0 : base - 1 + k > last ? last : base - 1 + k;
        const int column = column_of(&sight, w, i, p_enu, v_enu_mps);
        if (column < 0) return false;
        ln[k] = log(fmax(s->power_w[(size_t)i * (size_t)s->columns + (size_t)column], 1e-300));
    }
    const double b = 0.5 * (ln[2] - ln[0]), c = ln[0] - 2.5 * ln[1] + 2 * ln[2] - 0.5 * ln[3];
    const double d = 1.5 * (ln[1] - ln[2]) + 0.5 * (ln[3] - ln[0]);
    *power_w = exp(ln[1] + f * (b + f * (c + f * d)));
    return true;
}

/* At which position, from the first and between two, the beam's axis has the azimuth that the place has by then. Each
 * step brings it nearer by the place's rate over that of the scan. NAN: never ahead. */
static double position_of(const ScanWork *w, const double p_enu[3], const double v_enu_mps[3])
{
    enum { steps = 8 };
    const Making   *m = w->making;
    const ScanPlan *plan = &w->scan->plan;
    const double    middle = plan->positions / 2;
    double          x = middle;
    if (plan->positions == 1) return 0;
    for (int i = 0; i < steps; i++) {
        const double t_s = (clamp(x, 0, plan->positions - 1) - middle) * plan->interval_s;
        double       to[3];
        v3_sub(to, p_enu, m->p_enu);
        v3_add_scaled(to, to, t_s, v_enu_mps);
        v3_add_scaled(to, to, -t_s, m->scene->v_enu_mps);
        const double ahead = v3_dot(to, m->ahead);
        if (!(ahead > 0)) return NAN;
        x = atan2(v3_dot(to, m->right), ahead) / plan->step_rad + middle;
    }
    return x;
}

/* How fast the range rate of still ground changes over azimuth, m/s a radian, turn_rad from a direction. */
static double rate_slope(const Making *m, const double d_enu[3], double turn_rad)
{
    double        across[3];
    const double *v = m->scene->v_enu_mps;
    v3_cross(across, m->down, d_enu);
    const double inward = v3_dot(m->down, d_enu) * v3_dot(v, m->down) - v3_dot(v, d_enu);
    return -(cos(turn_rad) * v3_dot(v, across) + sin(turn_rad) * inward);
}

/* Resolution in azimuth by Doppler; INFINITY: it does not sharpen here. */
static double sharp_rad(const ScanWork *w, const double d_enu[3])
{
    const Making   *m = w->making;
    const Waveform *wave = &m->preset->wave;
    const double    lambda_m = m->preset->antenna.wavelength_m, lobe = w->beamwidth_rad;
    const double    slope = rate_slope(m, d_enu, 0);
    if (!(slope * rate_slope(m, d_enu, lobe) > 0 && slope * rate_slope(m, d_enu, -lobe) > 0)) return INFINITY;
    if (2 * lobe * fabs(slope) > 0.5 * lambda_m * wave->repeat_hz) return INFINITY;
    const double width = w->width_bins * lambda_m * wave->repeat_hz / (2 * wave->pulses * fabs(slope));
    return width < w->scan->beam_rad ? width : INFINITY;
}

/* A position's pulses summed for still ground in a direction. */
static double sum_power(const ScanWork *w, int position, int column, const Sight *sight)
{
    static const double still[3] = {0, 0, 0};
    const Making   *beam = &w->beam[position];
    const Waveform *wave = &beam->preset->wave;
    const size_t    row = (size_t)wave->samples;
    const double complex *pulse = beam->radar->scan_pulse + (size_t)position * row * (size_t)wave->pulses + column;
    const double    rate_mps = making_range_rate(beam, sight, still) - beam->frame->reference_rate_mps;
    const double    phase = 2 * pi_rad / beam->preset->antenna.wavelength_m * (2 * rate_mps / wave->repeat_hz);
    const double complex turn = cexp(I * phase);
    double complex  sum = 0, back = 1;
    for (int n = 0; n < wave->pulses; n++) {
        sum += w->weight[n] * pulse[(size_t)n * row] * back;
        back *= turn;
    }
    const double peak = antenna_gain(&beam->preset->antenna, 0, 0).sum;
    const double loss = pow(antenna_gain(&beam->preset->antenna, sight->cos_right, 0).sum / peak, 4);
    return (creal(sum) * creal(sum) + cimag(sum) * cimag(sum)) / loss;
}

bool scan_look(ScanLook *out, const ScanWork *w, const double p_enu[3], const double v_enu_mps[3])
{
    const Making    *m = w->making;
    const RadarScan *s = w->scan;
    double           to[3];
    v3_sub(to, p_enu, m->p_enu);
    const double range_m = v3_length(to), x = position_of(w, p_enu, v_enu_mps);
    if (!(x >= -0.5 && x <= s->plan.positions - 0.5)) return false;
    if (!real_beam(&out->beam_w, w, x, p_enu, v_enu_mps)) return false;
    v3_scale(to, 1 / range_m, to);
    const double width_rad = sharp_rad(w, to), level = sqrt(fmax(1 - pow(v3_dot(to, m->down), 2), 0));
    out->sharpened = isfinite(width_rad);
    out->resolution_m = range_m * level * (out->sharpened ? width_rad : s->beam_rad);
    out->sharp_w = out->beam_w;
    if (!out->sharpened) return true;
    Sight     sight;
    const int position = (int)clamp(floor(x + 0.5), 0, s->plan.positions - 1);
    const int column = column_of(&sight, w, position, p_enu, v_enu_mps);
    if (column < 0) return false;
    out->sharp_w = sum_power(w, position, column, &sight);
    return true;
}

/* ---- the picture over range and azimuth ------------------------------------------------------------ */

/* The place at a range and azimuth on level ground: its direction is turned up or down from the antenna's plane to
 * where it has the height of the reference point. */
static void level_place(double p_enu[3], const Making *m, double azimuth_rad, double range_m)
{
    double along[3];
    for (int k = 0; k < 3; k++) along[k] = cos(azimuth_rad) * m->ahead[k] + sin(azimuth_rad) * m->right[k];
    const double drop = m->aim_m * m->ahead[2] / fmax(range_m, 1e-3), reach = hypot(along[2], m->down[2]);
    const double middle = atan2(m->down[2], along[2]), off = acos(clamp(drop / fmax(reach, 1e-12), -1, 1));
    const double first = remainder(middle + off, 2 * pi_rad), second = remainder(middle - off, 2 * pi_rad);
    const double tilt = fabs(first) < fabs(second) ? first : second;
    for (int k = 0; k < 3; k++) p_enu[k] = m->p_enu[k] + range_m * (cos(tilt) * along[k] + sin(tilt) * m->down[k]);
}

static void sharpen_azimuth(void *user, int worker, int task)
{
    const ScanWork     *w = user;
    RadarScan          *s = w->scan;
    static const double still[3] = {0, 0, 0};
    const double        azimuth = task * s->azimuth_step_rad - (s->plan.positions / 2) * s->plan.step_rad;
    (void)worker;
    for (int x = 0; x < s->columns; x++) {
        const size_t at = (size_t)task * (size_t)s->columns + (size_t)x;
        const double range_m = w->making->frame->reference_m + (x - s->columns / 2) * w->metre_per_column;
        double       p[3];
        ScanLook     look;
        s->sharp_w[at] = NAN;
        s->resolution_m[at] = NAN;
        s->sharpened[at] = 0;
        if (!(range_m > 0)) continue;
        level_place(p, w->making, azimuth, range_m);
        if (!scan_look(&look, w, p, still)) continue;
        s->sharp_w[at] = look.sharp_w;
        s->resolution_m[at] = (float)look.resolution_m;
        s->sharpened[at] = look.sharpened;
    }
}

/* Azimuths to a step between positions: some for the finest resolution at the reference range. */
static int finer(const ScanWork *w)
{
    const RadarScan *s = w->scan;
    double           finest = s->beam_rad;
    for (int i = 0; i < s->plan.positions; i++) {
        double p[3], d[3];
        level_place(p, w->making, (i - s->plan.positions / 2) * s->plan.step_rad, w->making->frame->reference_m);
        v3_sub(d, p, w->making->p_enu);
        v3_normalize(d, d);
        finest = fmin(finest, sharp_rad(w, d));
    }
    const int room = s->plan.positions > 1 ? (scan_azimuths_most - 1) / (s->plan.positions - 1) : 1;
    return (int)clamp(ceil(cells_a_resolution * s->plan.step_rad / finest), 1, room < finer_most ? room : finer_most);
}

Status scan_sharpen(ScanWork *w)
{
    RadarScan   *s = w->scan;
    Arena       *arena = w->making->arena;
    const int    steps = finer(w);
    s->azimuths = (s->plan.positions - 1) * steps + 1;
    s->azimuth_step_rad = s->plan.step_rad / steps;
    const size_t cells = (size_t)s->azimuths * (size_t)s->columns;
    s->sharp_w = arena_alloc(arena, cells, sizeof *s->sharp_w);
    s->resolution_m = arena_alloc(arena, cells, sizeof *s->resolution_m);
    s->sharpened = arena_alloc(arena, cells, sizeof *s->sharpened);
    if (!s->sharp_w || !s->resolution_m || !s->sharpened) return STATUS_NO_MEMORY;
    if (w->making->pool) pool_run(w->making->pool, s->azimuths, sharpen_azimuth, w);
    else for (int a = 0; a < s->azimuths; a++) sharpen_azimuth(w, 0, a);
    size_t count = 0;
    for (size_t i = 0; i < cells; i++) count += s->sharpened[i];
    s->sharpened_share = (double)count / (double)cells;
    return STATUS_OK;
}

/* ---- the frame's pixels ------------------------------------------------------------------------------ */

static void look_row(void *user, int worker, int y)
{
    const ScanWork   *w = user;
    const RadarScene *scene = w->making->scene;
    const LocalFrame *frame = &scene->world->frame;
    RadarScan        *s = w->scan;
    (void)worker;
    for (int x = 0; x < s->width; x++) {
        const size_t at = (size_t)y * (size_t)s->width + (size_t)x;
        const uint32_t entity = scene->entity ? scene->entity[at] : 0;
        double       d[3], p[3], v[3] = {0, 0, 0};
        ScanLook     look = {0};
        s->view_w[at] = s->view_sharp_w[at] = NAN;
        if (!isfinite(scene->range_m[at])) continue;
        view_ray(d, scene->view, x + 0.5, y + 0.5);
        v3_add_scaled(p, scene->view->p_enu, scene->range_m[at], d);
        if (entity > 0) m3_tmul_v3(v, frame->r_ecef_from_enu, scene->snapshot->entity[entity - 1].v_ecef_mps);
        if (!scan_look(&look, w, p, v)) continue;
        s->view_w[at] = (float)look.beam_w;
        s->view_sharp_w[at] = (float)look.sharp_w;
    }
}

Status scan_pixels(ScanWork *w)
{
    RadarScan   *s = w->scan;
    const View  *view = w->making->scene->view;
    const size_t pixels = (size_t)view->width * (size_t)view->height;
    s->width = view->width;
    s->height = view->height;
    s->view_w = arena_alloc(w->making->arena, pixels, sizeof *s->view_w);
    s->view_sharp_w = arena_alloc(w->making->arena, pixels, sizeof *s->view_sharp_w);
    if (!s->view_w || !s->view_sharp_w) return STATUS_NO_MEMORY;
    if (w->making->pool) pool_run(w->making->pool, s->height, look_row, w);
    else for (int y = 0; y < s->height; y++) look_row(w, 0, y);
    return STATUS_OK;
}
