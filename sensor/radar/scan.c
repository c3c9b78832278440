/* sensor/radar/scan.c: the positions of a scanning beam, one after the other. */
#include "sensor/radar/scan_private.h"

enum { stream_scan = 0x3d800000 }; /* noise of position i: from here + 2 i */

/* One position's pulses, compressed, and their mean power. */
static void keep_position(ScanWork *w, const Interval *interval, int i)
{
    SeekerRadar    *r = w->making->radar;
    const size_t    row = (size_t)interval->wave.samples, plane = row * (size_t)interval->wave.pulses;
    double complex *pulse = r->scan_pulse + (size_t)i * plane;
    interval_compress(r->plan, interval, 1, NULL);
    for (int n = 0; n < interval->wave.pulses; n++) interval_pulse(pulse + (size_t)n * row, r->plan, CHANNEL_SUM, n);
    interval_profile(w->scan->power_w + (size_t)i * row, r->plan, CHANNEL_SUM);
}

static Status measure_positions(ScanWork *w, Interval *middle)
{
    Making         *m = w->making;
    const ScanPlan *plan = &w->scan->plan;
    const Waveform *wave = &middle->wave;
    SeekerRadar    *r = m->radar;
    Interval        interval = {.wave = *wave};
    ReceiverReport  report;
    keep_position(w, middle, plan->positions / 2);
    interval.sample = middle->sample; /* not needed any more */
    for (int i = 0; i < plan->positions; i++) {
        const int from_middle = i - plan->positions / 2;
        beam_at(&w->beam[i], m, from_middle * plan->step_rad, from_middle * plan->interval_s);
        if (from_middle == 0) continue;
        arena_reset(r->position);
        w->beam[i].arena = r->position;
        const Status status = beam_echoes(&w->beam[i], true);
        m->missing += w->beam[i].missing;
        if (status != STATUS_OK || m->missing > 0) return status;
        echo_sum(interval.sample, r->echoes);
        receiver_apply(&report, &interval, &m->preset->receiver, r->seed, stream_scan + 2u * (uint32_t)i,
                       m->scene->number);
        keep_position(w, &interval, i);
    }
    return STATUS_OK;
}

/* Figures of the windows: noise in a cell of the profile, width in Doppler. */
static Status know_windows(ScanWork *w)
{
    const RadarPreset *p = w->making->preset;
    const int          samples = p->wave.samples, pulses = p->wave.pulses;
    WindowFigures      figures = {.width_3db = 1};
    double             sum = 0, squares = 0;
    double            *range = arena_alloc(w->making->arena, (size_t)samples, sizeof *range);
    w->weight = arena_alloc(w->making->arena, (size_t)pulses, sizeof *w->weight);
    if (!range || !w->weight) return STATUS_NO_MEMORY;
    Status status = window_weights(range, samples, &p->range_window);
    if (status == STATUS_OK) status = window_weights(w->weight, pulses, &p->doppler_window);
    if (status == STATUS_OK && pulses >= 4) status = window_figures(&figures, w->weight, pulses);
    if (status != STATUS_OK) return status;
    for (int i = 0; i < samples; i++) sum += range[i], squares += range[i] * range[i];
    w->scan->noise_w = receiver_noise_w(&p->receiver, &p->wave) * squares / (sum * sum);
    w->scan->sharp_noise_w = receiver_noise_w(&p->receiver, &p->wave) * interval_noise_share(w->making->radar->plan);
    sum = 0;
    for (int i = 0; i < pulses; i++) sum += w->weight[i];
    for (int i = 0; i < pulses; i++) w->weight[i] /= sum;
    w->width_bins = figures.width_3db;
    return STATUS_OK;
}

Status making_scan(Making *m, Interval *middle)
{
    const RadarPreset *p = m->preset;
    const ScanPlan     plan = m->radar->scan;
    RadarScan         *scan = arena_alloc(m->arena, 1, sizeof *scan);
    ScanWork           w = {.making = m, .scan = scan, .beamwidth_rad = antenna_width_rad(&p->antenna),
                            .metre_per_column = m->frame->map.metre_per_column};
    w.beam = arena_alloc(m->arena, (size_t)plan.positions, sizeof *w.beam);
    if (!scan || !w.beam) return STATUS_NO_MEMORY;
    *scan = (RadarScan){.plan = plan, .columns = p->wave.samples, .beam_rad = antenna_two_way_width_rad(&p->antenna)};
    scan->power_w = arena_alloc(m->arena, (size_t)plan.positions * (size_t)scan->columns, sizeof *scan->power_w);
    if (!scan->power_w) return STATUS_NO_MEMORY;
    Status status = know_windows(&w);
    if (status == STATUS_OK) status = measure_positions(&w, middle);
    if (status != STATUS_OK || m->missing > 0) return status;
    status = scan_sharpen(&w);
    if (status == STATUS_OK && m->scene->range_m) status = scan_pixels(&w);
    if (status == STATUS_OK) m->frame->scan = scan;
    return status;
}
