/* entities/traces/vehicle_traces.c: trail and dust of a vehicle that drives, by its model. */
#include "entities/traces/vehicle_traces.h"

static const double gravity_mps2 = 9.80665;

double vehicle_effect_scale(const Model *model)
{
    return clamp(cbrt(model->length_m * model->width_m * model->height_m / 40), 0.25, 4);
}

void vehicle_dust(EffectSource *source, const Model *model, double below_m)
{
    source->kind = EFFECT_DUST;
    source->at_body[0] = model->box_low[0];
    source->at_body[2] = below_m - 0.3;
    source->spread_body[1] = 0.4 * model->width_m;
}

GroundTrack vehicle_track(const Model *model, bool tracked)
{
    const double resistance = tracked ? 0.05 : 0.03, t_m3 = tracked ? 0.9 : 0.35, share = tracked ? 0.16 : 0.1;
    const double in_ground = 0.5;
    const double width_m = share * model->width_m;
    const double weight_n = 1000 * t_m3 * model->length_m * model->width_m * model->height_m * gravity_mps2;
    const double heat_j_m2 = width_m > 0 ? in_ground * resistance * weight_n / (2 * width_m) : 0;
    return (GroundTrack){.width_m = (float)width_m,
                         .apart_m = (float)(model->width_m - width_m),
                         .heat_j_m2 = (float)fmin(heat_j_m2, 1e6),
                         .tracked = tracked};
}
