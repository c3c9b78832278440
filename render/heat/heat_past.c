/* render/heat/heat_past.c: what the flux of earlier hours, such as the shade of a vehicle that has left, does to the
 * temperature of the surface now. */
#include "render/heat/heat_private.h"

typedef struct Linear {
    double falls_w_m2k;
} Linear;
static const double pulse_base_k = 1000; /* a linear law knows no zero; so that no temperature falls below it */
static const double pulse_j_m2 = 1e4;

static double linear_flux(double *falls, double temp_k, const void *law)
{
    const Linear *l = law;
    *falls = l->falls_w_m2k;
    return -l->falls_w_m2k * (temp_k - pulse_base_k);
}
static void linear_law(void *law, double share, const void *user)
{
    (void)share;
    *(Linear *)law = *(const Linear *)user;
}

void heat_pulse_start(ColumnState *out, const Column *c)
{
    column_start(out, c, pulse_base_k);
    out->temp_k[0] += pulse_j_m2 / c->capacity_j_m2k[0];
}

double heat_pulse_step(ColumnState *state, const Column *c, double falls, double dt_s)
{
    const ColumnBoundary b = {linear_flux, linear_law, &(Linear){falls}, 0, 1e-4 * pulse_j_m2 / c->capacity_j_m2k[0]};
    const double         before = state->heat_j_m2;
    column_step(state, c, NULL, &b, dt_s);
    return (before - state->heat_j_m2) / falls / pulse_j_m2;
}

/* Intervals of the past, newest first: ten minutes for three hours, half hours to six, hours to a day and more; no less
 * than a step. */
static int past_intervals(Interval out[heat_past], const Heat *h)
{
    const double step_s = h->config.step_s;
    int64_t      to = h->index;
    int          count = 0;
    while (count < heat_past) {
        const double  age_s = (double)(h->index - to) * step_s;
        const double  wide_s = age_s < 3 * 3600 ? 600 : age_s < 6 * 3600 ? 1800 : 3600;
        const int64_t wide = (int64_t)fmax(1, round(wide_s / step_s));
        if (age_s >= 30 * 3600 || to - wide < h->first || h->index - to + wide >= history) break;
        out[count++] = (Interval){to - wide, to};
        to -= wide;
    }
    return count;
}

/* K now for 1 W/m2 over each interval: what a pulse of heat, marched back in time, gives off through the surface. */
void heat_past_respond(void *user, int worker, int kind)
{
    const PastJob    *job = user;
    const Heat       *h = job->heat;
    const Column     *c = &h->layers[kind];
    const GroundKind *k = &h->kinds.kind[kind];
    ColumnState       state;
    (void)worker;
    if (kind == SURFACE_NONE) return;
    heat_pulse_start(&state, c);
    for (int i = 0; i < job->count; i++) {
        const Interval *p = &job->interval[i];
        double          falls = 0, direct = 0, diffuse = 0, loss = 0;
        const double    count = (double)(p->to - p->from + 1);
        for (int64_t t = p->from; t <= p->to; t++) {
            const Sky *sky = &h->sky[place_of(t)];
            falls += (double)h->state[kind].falls_w_m2k[place_of(t)] / count;
            direct += sky->direct_w_m2 / count, diffuse += sky->diffuse_w_m2 / count, loss += sky->loss_w_m2 / count;
        }
        const double per_w_m2 = heat_pulse_step(&state, c, falls, (double)(p->to - p->from) * h->config.step_s);
        job->past->watt_k[kind][i] = (float)per_w_m2;
        job->past->sun_k[kind][i] = (float)(per_w_m2 * k->absorptance * direct);
        job->past->sky_k[kind][i] = (float)(per_w_m2 * (k->absorptance * diffuse - k->emissivity * loss));
    }
}

/* All but the responses. */
int heat_past_begin(Heat *h, HeatPast *out, Interval interval[heat_past])
{
    const int count = past_intervals(interval, h);
    *out = (HeatPast){.count = count};
    for (int i = 0; i < count; i++) {
        const Interval *p = &interval[i];
        out->unix_s[i] = 0.5 * (double)(p->from + p->to) * h->config.step_s;
        out->span_s[i] = (double)(p->to - p->from) * h->config.step_s;
        GroundWeather w;
        h->config.weather(&w, out->unix_s[i], h->config.user);
        memcpy(out->sun_d_enu[i], w.sun_d_enu, sizeof w.sun_d_enu);
    }
    for (int k = 1; k < ground_kinds; k++) /* of the first element: its half and its conductance have the same size */
    {
        const Column *c = &h->layers[k];
        const double  capacity = c->capacity_j_m2k[0], conductance = c->conductance_w_m2k[0];
        const double  apart_m = c->depth_m[1] - c->depth_m[0]; /* conductivity over capacity of the volume */
        out->effusivity[k] = (float)sqrt(2 * capacity * conductance);
        out->diffusivity[k] = (float)(conductance * apart_m * apart_m / (2 * capacity));
    }
    return count;
}
