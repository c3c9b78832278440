/* sensor/radar/shot_sector.c: a beam that scans a sector: its positions are measured one after the other; then its
 * pictures over range and azimuth, sharpened by Doppler, and over the frame's pixels. */
#include "sensor/radar/seeker_radar_private.h"

typedef struct SectorWork {
    RadarShot   *shot;
    RadarSector *sector;
    RadarShot   *beam;          /* [positions] */
    double      *weight;        /* [pulses]: Doppler window, over its sum */
    double       width_bins;    /* of that window at half power */
    double       beamwidth_rad; /* one way */
    double       metre_per_column;
} SectorWork;

/* What the sector has for a place that is at p_enu at the frame's time and moves evenly. */
typedef struct SectorLook {
    double beam_w, sharp_w, resolution_m;
    bool   sharpened;
} SectorLook;

enum { cells_a_resolution = 3, finer_most = 64 };

/* ---- one place ---------------------------------------------------------------------------------- */

/* The range cell of the place in a position, and the direction to the place then. -1: it is not within the window. */
static int column_of(Sight *sight, const SectorWork *w, int position, const double p_enu[3], const double v_enu_mps[3])
{
    const RadarShot *beam = &w->beam[position];
    double           p[3];
    v3_add_scaled(p, p_enu, beam->after_s, v_enu_mps);
    shot_sight(sight, beam, p, 0);
    const double appears_m = shot_appears_m(beam, sight, shot_range_rate(beam, sight, v_enu_mps));
    const double at = floor((appears_m - beam->reference_m) / w->metre_per_column + w->sector->columns / 2 + 0.5);
    return sight->within && at >= 0 && at < w->sector->columns ? (int)at : -1;
}

/* Computes the power of the real beam at positions counted from the first. */
static bool real_beam(double *power_w, const SectorWork *w, double x, const double p_enu[3], const double v_enu_mps[3])
{
    const RadarSector *s = w->sector;
    const int          last = s->plan.positions - 1, base = (int)clamp(floor(x), 0, last > 0 ? last - 1 : 0);
    const double       f = clamp(x - base, 0, 1);
    double             ln[4];
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
static double position_of(const SectorWork *w, const double p_enu[3], const double v_enu_mps[3])
{
    enum { steps = 8 };
    const RadarShot  *shot = w->shot;
    const SectorPlan *plan = &w->sector->plan;
    const double      middle = plan->positions / 2;
    double            x = middle;
    if (plan->positions == 1) return 0;
    for (int i = 0; i < steps; i++) {
        const double t_s = (clamp(x, 0, plan->positions - 1) - middle) * plan->interval_s;
        double       to[3];
        v3_sub(to, p_enu, shot->p_enu);
        v3_add_scaled(to, to, t_s, v_enu_mps);
        v3_add_scaled(to, to, -t_s, shot->scene->v_enu_mps);
        const double ahead = v3_dot(to, shot->ahead);
        if (!(ahead > 0)) return NAN;
        x = atan2(v3_dot(to, shot->right), ahead) / plan->step_rad + middle;
    }
    return x;
}

/* How fast the range rate of still ground changes over azimuth, m/s a radian, turn_rad from a direction. */
static double rate_slope(const RadarShot *shot, const double d_enu[3], double turn_rad)
{
    double        across[3];
    const double *v = shot->scene->v_enu_mps;
    v3_cross(across, shot->down, d_enu);
    const double inward = v3_dot(shot->down, d_enu) * v3_dot(v, shot->down) - v3_dot(v, d_enu);
    return -(cos(turn_rad) * v3_dot(v, across) + sin(turn_rad) * inward);
}

/* Resolution in azimuth by Doppler; INFINITY: it does not sharpen here. */
static double sharp_rad(const SectorWork *w, const double d_enu[3])
{
    const RadarShot *shot = w->shot;
    const Waveform  *wave = &shot->preset->wave;
    const double     lambda_m = shot->preset->antenna.wavelength_m, lobe = w->beamwidth_rad;
    const double     slope = rate_slope(shot, d_enu, 0);
    if (!(slope * rate_slope(shot, d_enu, lobe) > 0 && slope * rate_slope(shot, d_enu, -lobe) > 0)) return INFINITY;
    if (2 * lobe * fabs(slope) > 0.5 * lambda_m * wave->repeat_hz) return INFINITY;
    const double width = w->width_bins * lambda_m * wave->repeat_hz / (2 * wave->pulses * fabs(slope));
    return width < w->sector->beam_rad ? width : INFINITY;
}

/* Sums the pulses of a position as for still ground in a direction. */
static double sum_power(const SectorWork *w, int position, int column, const Sight *sight)
{
    static const double   still[3] = {0, 0, 0};
    const RadarShot      *beam = &w->beam[position];
    const Waveform       *wave = &beam->preset->wave;
    const size_t          row = (size_t)wave->samples;
    const double complex *pulse = beam->radar->sector_pulse + (size_t)position * row * (size_t)wave->pulses + column;
    const double          rate_mps = shot_range_rate(beam, sight, still) - beam->frame->reference_rate_mps;
    const double          phase = 2 * pi_rad / beam->preset->antenna.wavelength_m * (2 * rate_mps / wave->repeat_hz);
    const double complex  turn = cexp(I * phase);
    double complex        sum = 0, back = 1;
    for (int n = 0; n < wave->pulses; n++) {
        sum += w->weight[n] * pulse[(size_t)n * row] * back;
        back *= turn;
    }
    const double peak = antenna_gain(&beam->preset->antenna, 0, 0).sum;
    const double loss = pow(antenna_gain(&beam->preset->antenna, sight->cos_right, 0).sum / peak, 4);
    return (creal(sum) * creal(sum) + cimag(sum) * cimag(sum)) / loss;
}

/* Fills a look. False: it is out of the sector or the window. */
static bool look_at(SectorLook *out, const SectorWork *w, const double p_enu[3], const double v_enu_mps[3])
{
    const RadarShot   *shot = w->shot;
    const RadarSector *s = w->sector;
    double             to[3];
    v3_sub(to, p_enu, shot->p_enu);
    const double range_m = v3_length(to), x = position_of(w, p_enu, v_enu_mps);
    if (!(x >= -0.5 && x <= s->plan.positions - 0.5)) return false;
    if (!real_beam(&out->beam_w, w, x, p_enu, v_enu_mps)) return false;
    v3_scale(to, 1 / range_m, to);
    const double width_rad = sharp_rad(w, to), level = sqrt(fmax(1 - pow(v3_dot(to, shot->down), 2), 0));
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
static void level_place(double p_enu[3], const RadarShot *shot, double azimuth_rad, double range_m)
{
    double along[3];
    for (int k = 0; k < 3; k++) along[k] = cos(azimuth_rad) * shot->ahead[k] + sin(azimuth_rad) * shot->right[k];
    const double drop = shot->aim_m * shot->ahead[2] / fmax(range_m, 1e-3), reach = hypot(along[2], shot->down[2]);
    const double middle = atan2(shot->down[2], along[2]), off = acos(clamp(drop / fmax(reach, 1e-12), -1, 1));
    const double first = remainder(middle + off, 2 * pi_rad), second = remainder(middle - off, 2 * pi_rad);
    const double tilt = fabs(first) < fabs(second) ? first : second;
    for (int k = 0; k < 3; k++)
        p_enu[k] = shot->p_enu[k] + range_m * (cos(tilt) * along[k] + sin(tilt) * shot->down[k]);
}

static void sharpen_azimuth(void *user, int worker, int task)
{
    const SectorWork   *w = user;
    RadarSector        *s = w->sector;
    static const double still[3] = {0, 0, 0};
    const double        azimuth = task * s->azimuth_step_rad - (s->plan.positions / 2) * s->plan.step_rad;
    (void)worker;
    for (int x = 0; x < s->columns; x++) {
        const size_t at = (size_t)task * (size_t)s->columns + (size_t)x;
        const double range_m = w->shot->frame->reference_m + (x - s->columns / 2) * w->metre_per_column;
        double       p[3];
        SectorLook   look;
        s->sharp_w[at] = NAN;
        s->resolution_m[at] = NAN;
        s->sharpened[at] = 0;
        if (!(range_m > 0)) continue;
        level_place(p, w->shot, azimuth, range_m);
        if (!look_at(&look, w, p, still)) continue;
        s->sharp_w[at] = look.sharp_w;
        s->resolution_m[at] = (float)look.resolution_m;
        s->sharpened[at] = look.sharpened;
    }
}

/* Azimuths to a step between positions: some for the finest resolution at the reference range. */
static int finer(const SectorWork *w)
{
    const RadarSector *s = w->sector;
    double             finest = s->beam_rad;
    for (int i = 0; i < s->plan.positions; i++) {
        double p[3], d[3];
        level_place(p, w->shot, (i - s->plan.positions / 2) * s->plan.step_rad, w->shot->frame->reference_m);
        v3_sub(d, p, w->shot->p_enu);
        v3_normalize(d, d);
        finest = fmin(finest, sharp_rad(w, d));
    }
    const int room = s->plan.positions > 1 ? (sector_azimuths_most - 1) / (s->plan.positions - 1) : 1;
    return (int)clamp(ceil(cells_a_resolution * s->plan.step_rad / finest), 1, room < finer_most ? room : finer_most);
}

/* Sharpens the picture: fills the arrays of the sector. */
static Status sharpen(SectorWork *w)
{
    RadarSector *s = w->sector;
    Arena       *arena = w->shot->arena;
    const int    steps = finer(w);
    s->azimuths = (s->plan.positions - 1) * steps + 1;
    s->azimuth_step_rad = s->plan.step_rad / steps;
    const size_t cells = (size_t)s->azimuths * (size_t)s->columns;
    s->sharp_w = arena_alloc(arena, cells, sizeof *s->sharp_w);
    s->resolution_m = arena_alloc(arena, cells, sizeof *s->resolution_m);
    s->sharpened = arena_alloc(arena, cells, sizeof *s->sharpened);
    if (!s->sharp_w || !s->resolution_m || !s->sharpened) return STATUS_NO_MEMORY;
    if (w->shot->pool) pool_run(w->shot->pool, s->azimuths, sharpen_azimuth, w);
    else
        for (int a = 0; a < s->azimuths; a++) sharpen_azimuth(w, 0, a);
    size_t count = 0;
    for (size_t i = 0; i < cells; i++) count += s->sharpened[i];
    s->sharpened_share = (double)count / (double)cells;
    return STATUS_OK;
}

/* ---- the frame's pixels ------------------------------------------------------------------------------ */

static void look_row(void *user, int worker, int y)
{
    const SectorWork *w = user;
    const RadarScene *scene = w->shot->scene;
    const LocalFrame *frame = &scene->world->frame;
    RadarSector      *s = w->sector;
    (void)worker;
    for (int x = 0; x < s->width; x++) {
        const size_t   at = (size_t)y * (size_t)s->width + (size_t)x;
        const uint32_t entity = scene->entity ? scene->entity[at] : 0;
        double         d[3], p[3], v[3] = {0, 0, 0};
        SectorLook     look = {0};
        s->view_w[at] = s->view_sharp_w[at] = NAN;
        if (!isfinite(scene->range_m[at])) continue;
        view_ray(d, scene->view, x + 0.5, y + 0.5);
        v3_add_scaled(p, scene->view->p_enu, scene->range_m[at], d);
        if (entity > 0) m3_tmul_v3(v, frame->r_ecef_from_enu, scene->snapshot->entity[entity - 1].v_ecef_mps);
        if (!look_at(&look, w, p, v)) continue;
        s->view_w[at] = (float)look.beam_w;
        s->view_sharp_w[at] = (float)look.sharp_w;
    }
}

static Status look_at_pixels(SectorWork *w)
{
    RadarSector *s = w->sector;
    const View  *view = w->shot->scene->view;
    const size_t pixels = (size_t)view->width * (size_t)view->height;
    s->width = view->width;
    s->height = view->height;
    s->view_w = arena_alloc(w->shot->arena, pixels, sizeof *s->view_w);
    s->view_sharp_w = arena_alloc(w->shot->arena, pixels, sizeof *s->view_sharp_w);
    if (!s->view_w || !s->view_sharp_w) return STATUS_NO_MEMORY;
    if (w->shot->pool) pool_run(w->shot->pool, s->height, look_row, w);
    else
        for (int y = 0; y < s->height; y++) look_row(w, 0, y);
    return STATUS_OK;
}

/* ---- positions -------------------------------------------------------------------------------------- */

enum { stream_scan = 0x3d800000 }; /* noise of position i: from here + 2 i */

/* Keeps the compressed pulses of one position, and their mean power. */
static void keep_position(SectorWork *w, const Interval *interval, int i)
{
    SeekerRadar    *r = w->shot->radar;
    const size_t    row = (size_t)interval->wave.samples, plane = row * (size_t)interval->wave.pulses;
    double complex *pulse = r->sector_pulse + (size_t)i * plane;
    interval_compress(r->plan, interval, 1, NULL);
    for (int n = 0; n < interval->wave.pulses; n++) interval_pulse(pulse + (size_t)n * row, r->plan, CHANNEL_SUM, n);
    interval_profile(w->sector->power_w + (size_t)i * row, r->plan, CHANNEL_SUM);
}

static Status measure_positions(SectorWork *w, Interval *middle)
{
    RadarShot        *shot = w->shot;
    const SectorPlan *plan = &w->sector->plan;
    const Waveform   *wave = &middle->wave;
    SeekerRadar      *r = shot->radar;
    Interval          interval = {.wave = *wave, .pool = shot->pool};
    ReceiverReport    report;
    keep_position(w, middle, plan->positions / 2);
    interval.sample = middle->sample; /* not needed any more */
    for (int i = 0; i < plan->positions; i++) {
        const int from_middle = i - plan->positions / 2;
        shot_position(&w->beam[i], shot, from_middle * plan->step_rad, from_middle * plan->interval_s);
        if (from_middle == 0) continue;
        arena_reset(r->position);
        w->beam[i].arena = r->position;
        const Status status = shot_echoes(&w->beam[i], true);
        shot->missing += w->beam[i].missing;
        if (status != STATUS_OK || shot->missing > 0) return status;
        echo_sum(interval.sample, r->echoes);
        interval_receive(&report, &interval, &shot->preset->receiver, r->seed, stream_scan + 2u * (uint32_t)i,
                         shot->scene->number);
        keep_position(w, &interval, i);
    }
    return STATUS_OK;
}

/* Figures of the windows: noise in a cell of the profile, width in Doppler. */
static Status know_windows(SectorWork *w)
{
    const RadarPreset *p = w->shot->preset;
    const int          samples = p->wave.samples, pulses = p->wave.pulses;
    WindowFigures      figures = {.width_3db = 1};
    double             sum = 0, squares = 0;
    double            *range = arena_alloc(w->shot->arena, (size_t)samples, sizeof *range);
    w->weight = arena_alloc(w->shot->arena, (size_t)pulses, sizeof *w->weight);
    if (!range || !w->weight) return STATUS_NO_MEMORY;
    Status status = window_weights(range, samples, &p->range_window);
    if (status == STATUS_OK) status = window_weights(w->weight, pulses, &p->doppler_window);
    if (status == STATUS_OK && pulses >= 4) status = window_figures(&figures, w->weight, pulses);
    if (status != STATUS_OK) return status;
    for (int i = 0; i < samples; i++) sum += range[i], squares += range[i] * range[i];
    w->sector->noise_w = interval_receiver_noise_w(&p->receiver, &p->wave) * squares / (sum * sum);
    w->sector->sharp_noise_w =
        interval_receiver_noise_w(&p->receiver, &p->wave) * interval_noise_share(w->shot->radar->plan);
    sum = 0;
    for (int i = 0; i < pulses; i++) sum += w->weight[i];
    for (int i = 0; i < pulses; i++) w->weight[i] /= sum;
    w->width_bins = figures.width_3db;
    return STATUS_OK;
}

Status shot_sector(RadarShot *shot, Interval *middle)
{
    const RadarPreset *p = shot->preset;
    const SectorPlan   plan = shot->radar->sector;
    RadarSector       *sector = arena_alloc(shot->arena, 1, sizeof *sector);
    SectorWork         w = {.shot = shot,
                            .sector = sector,
                            .beamwidth_rad = antenna_width_rad(&p->antenna),
                            .metre_per_column = shot->frame->map.metre_per_column};
    w.beam = arena_alloc(shot->arena, (size_t)plan.positions, sizeof *w.beam);
    if (!sector || !w.beam) return STATUS_NO_MEMORY;
    *sector =
        (RadarSector){.plan = plan, .columns = p->wave.samples, .beam_rad = antenna_two_way_width_rad(&p->antenna)};
    sector->power_w =
        arena_alloc(shot->arena, (size_t)plan.positions * (size_t)sector->columns, sizeof *sector->power_w);
    if (!sector->power_w) return STATUS_NO_MEMORY;
    Status status = know_windows(&w);
    if (status == STATUS_OK) status = measure_positions(&w, middle);
    if (status != STATUS_OK || shot->missing > 0) return status;
    status = sharpen(&w);
    if (status == STATUS_OK && shot->scene->range_m) status = look_at_pixels(&w);
    if (status == STATUS_OK) shot->frame->scan = sector;
    return status;
}

/* ---- how many positions ------------------------------------------------------------------------------- */

Status radar_sector_plan(SectorPlan *out, const RadarPreset *preset, double sector_rad, double step_share)
{
    const Waveform *wave = &preset->wave;
    *out = (SectorPlan){.positions = 1, .interval_s = wave->pulses / wave->repeat_hz};
    if (!(sector_rad > 0)) return STATUS_OK;
    out->step_rad = step_share * antenna_width_rad(&preset->antenna);
    const double side = ceil(0.5 * sector_rad / out->step_rad - 1e-9), all = 2 * side + 1;
    if (all > sector_positions_most || all * wave->pulses * wave->samples > 1 << 27) {
        log_error("radar: a scan of %.1f degrees is %.0f positions of %s; choose a smaller radar.scan_deg or a larger "
                  "radar.scan_step (at most %d positions, 2^27 samples in all)",
                  sector_rad / rad_per_deg, all, preset->name, sector_positions_most);
        return STATUS_BAD_VALUE;
    }
    out->positions = (int)all;
    return STATUS_OK;
}
