/* sensor/radar/beam.c: what one position of the beam receives of a frame's points.
 *
 * A position is a Making with an axis of its own, an instant of its own (after_s, from the frame's time) and the
 * antenna where it is then; points have moved by their own velocities. A path and its growth are those at the frame's
 * time plus the change of the range of the point since: exact for what moves evenly. Entities are seen anew, as their
 * aspect changes; so is rain. */
#include "sensor/radar/seeker_radar_private.h"

enum { block = 1024 };

void beam_at(Making *out, const Making *m, double azimuth_rad, double after_s)
{
    const double c = cos(azimuth_rad), s = sin(azimuth_rad);
    *out = *m;
    out->scan_half_rad = out->sweep_m = 0;
    out->after_s = after_s;
    out->reference_m = m->reference_m + m->window_rate_mps * after_s;
    making_reach(out);
    for (int k = 0; k < 3; k++) {
        out->p_enu[k] = m->p_enu[k] + m->scene->v_enu_mps[k] * after_s;
        out->right[k] = c * m->right[k] - s * m->ahead[k];
        out->ahead[k] = c * m->ahead[k] + s * m->right[k];
    }
}

/* False: it is left out. */
static bool echo_of(Echo *e, const Making *beam, const RadarPoint *q)
{
    double p[3];
    Sight  sight;
    v3_add_scaled(p, q->p_enu, q->own ? 0 : beam->after_s, q->v_enu_mps);
    making_sight(&sight, beam, p, q->room_m);
    if (!sight.within || making_off_axis(beam, &sight) > q->widest) return false;
    const ScatterMatrix s = {.hh = q->same, .vv = q->same, .hv = q->other, .vh = q->other};
    making_amplitudes(e->amplitude, beam, &sight, &s);
    for (int k = 0; k < interval_channels; k++) e->amplitude[k] *= q->share;
    e->path_m = q->path_m;
    e->path_per_pulse_m = q->path_per_pulse_m;
    if (beam->after_s == 0 || q->own) return true;
    double at_frame[3];
    v3_sub(at_frame, q->p_enu, beam->scene->view->p_enu);
    const double was_m = v3_length(at_frame), rate_mps = making_range_rate(beam, &sight, q->v_enu_mps);
    v3_scale(at_frame, 1 / fmax(was_m, 1e-3), at_frame);
    const double was_mps = v3_dot(at_frame, q->v_enu_mps) - v3_dot(at_frame, beam->scene->v_enu_mps);
    e->path_m += 2 * ((sight.range_m - was_m) - beam->window_rate_mps * beam->after_s);
    e->path_per_pulse_m += 2 * (rate_mps - was_mps) / beam->preset->wave.repeat_hz;
    return true;
}

typedef struct BeamJob {
    const Making *beam;
    int           first, end;
    bool          sum_alone;
    Echo         *echo;               /* those of block b from b * block on */
    int           kept[beam_batch / block];
} BeamJob;

static void echo_block(void *user, int worker, int task)
{
    BeamJob  *job = user;
    const int first = job->first + task * block, end = first + block < job->end ? first + block : job->end;
    Echo     *e = job->echo + (size_t)task * block;
    (void)worker;
    int kept = 0;
    for (int i = first; i < end; i++) {
        if (!echo_of(&e[kept], job->beam, &job->beam->radar->points.point[i])) continue;
        if (job->sum_alone)
            for (int c = CHANNEL_SUM + 1; c < interval_channels; c++) e[kept].amplitude[c] = 0;
        kept++;
    }
    job->kept[task] = kept;
}

Status beam_echoes(Making *beam, bool sum_alone)
{
    SeekerRadar *r = beam->radar;
    const int    lasting = r->points.count, from = beam->after_s == 0 ? 0 : r->target_points;
    Status       status = making_rain(beam);
    if (status == STATUS_OK && beam->after_s != 0) status = making_targets_anew(beam);
    if (status != STATUS_OK || beam->missing > 0) return status;
    for (int first = from; first < r->points.count; first += beam_batch) {
        const int end = first + beam_batch < r->points.count ? first + beam_batch : r->points.count;
        const int blocks = (end - first + block - 1) / block;
        BeamJob   job = {.beam = beam, .first = first, .end = end, .sum_alone = sum_alone, .echo = r->batch};
        if (beam->pool) pool_run(beam->pool, blocks, echo_block, &job);
        else for (int b = 0; b < blocks; b++) echo_block(&job, 0, b);
        int kept = 0; /* moved together: one call for all */
        for (int b = 0; b < blocks; b++) {
            if (kept != b * block)
                memmove(r->batch + kept, r->batch + (size_t)b * block, (size_t)job.kept[b] * sizeof *r->batch);
            kept += job.kept[b];
        }
        echo_add(r->echoes, r->batch, kept, beam->pool);
    }
    r->points.count = lasting;
    return echo_status(r->echoes);
}
