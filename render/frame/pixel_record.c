/* render/frame/pixel_record.c: adds up again what the passes did to one pixel. */
#include "render/frame/pixel_record.h"

#include <stdlib.h>

void pixel_record_open(PixelRecord *out, int x, int y)
{
    *out = (PixelRecord){.x = x, .y = y};
    pthread_mutex_init(&out->lock, NULL);
}

void pixel_record_sort(PixelRecord *record)
{
    for (int i = 1; i < record->samples; i++) {
        const PixelSample one = record->sample[i];
        int               at = i;
        for (; at > 0 && record->sample[at - 1].group > one.group; at--) record->sample[at] = record->sample[at - 1];
        if (at < i) record->sample[at] = one;
    }
}

void pixel_record_close(PixelRecord *record)
{
    free(record->step);
    free(record->sample);
    record->step = NULL, record->sample = NULL;
    record->steps = record->samples = record->step_room = record->sample_room = 0;
}

/* ---- added up again ------------------------------------------------------------------------------ */

float pixel_light_sum(const PixelLight *l, AirBand channel, bool met)
{
    float seen;
    if (met) { /* as surface_light.c */
        seen = fmaf(l->reflected, l->air_transmittance, l->path);
        seen = fmaf(l->sunlit, l->sun_transmittance, seen);
        if (channel >= AIR_MWIR) seen = fmaf(l->emitted, l->transmittance, seen);
        if (l->lamps > 0) seen = fmaf(l->lamps, l->air_transmittance, seen); /* shade_lamps.c */
    } else {                                                                 /* as optical_beyond, thermal_beyond */
        seen = (float)(l->beyond * (double)l->beyond_transmittance + (double)l->path + l->disc);
    }
    return l->smoky ? seen * l->smoke_transmittance + l->smoke : seen;
}

static double value_of(const PixelRecord *r, const PixelSample *s, int plane)
{
    for (int c = 0; c < r->channels; c++)
        if (r->channel[c].plane == plane)
            return (double)pixel_light_sum(&s->light[r->channel[c].channel], r->channel[c].channel,
                                           s->range_m < INFINITY);
    double sum = 0; /* the radar's bounces */
    for (int b = 0; b < radar_bounces; b++) sum += (double)s->radar[b];
    return (double)(float)sum;
}

/* Sum over a step's samples of weight and value; plain: the weights are all alike, and come last. */
static double sum_of(double *coefficient, const PixelRecord *r, const PixelStep *step, int plane, double share)
{
    const bool plain = step->kind == PIXEL_MEAN && !step->several;
    double     sum = 0;
    for (int i = 0; i < r->samples; i++) {
        const PixelSample *s = &r->sample[i];
        if (s->group != step->group) continue;
        sum += plain ? value_of(r, s, plane) : s->weight * value_of(r, s, plane);
        if (coefficient) coefficient[i] = share * s->weight;
    }
    return plain ? sum * (1.0 / (step->n * step->n)) : sum;
}

static void scale(double *coefficient, double *beside, int samples, double factor)
{
    for (int i = 0; coefficient && i < samples; i++) coefficient[i] *= factor;
    if (beside) *beside *= factor;
}

float pixel_record_value(double *coefficient, double *beside, const PixelRecord *r, int plane, int steps)
{
    float value = NAN;
    for (int i = 0; coefficient && i < r->samples; i++) coefficient[i] = 0;
    if (beside) *beside = 0;
    for (int k = 0; k < steps && k < r->steps; k++) {
        const PixelStep *step = &r->step[k];
        if (!(step->planes >> plane & 1)) continue;
        switch (step->kind) {
        case PIXEL_MEAN: {
            scale(coefficient, beside, r->samples, 1 - step->share);
            const double mean = sum_of(coefficient, r, step, plane, step->share);
            value = (float)(step->share == 1 ? mean : (1 - step->share) * (double)value + step->share * mean);
            break;
        }
        case PIXEL_SMOOTHED: {
            float mean = step->weight[4] * value;
            scale(coefficient, beside, r->samples, (double)step->weight[4]);
            for (int n = 0; n < 9; n++) {
                if (n == 4 || !(step->weight[n] > 0)) continue;
                mean += step->weight[n] * step->value[plane][n];
                if (beside) *beside += (double)step->weight[n] * (double)step->value[plane][n];
            }
            value = mean;
            break;
        }
        case PIXEL_BESIDE:
            value *= (float)step->share;
            scale(coefficient, beside, r->samples, step->share);
            break;
        case PIXEL_BEFORE:
            value += (float)(step->share * sum_of(coefficient, r, step, plane, step->share));
            break;
        case PIXEL_TARGET:
            value += (float)sum_of(coefficient, r, step, plane, 1);
            break;
        }
    }
    return value;
}
