/* entities/traces/exhaust.c: where an engine's gas leaves a model, and the puffs behind it. */
#include "entities/traces/exhaust.h"

#include "entities/traces/vehicle_traces.h"

/* Where a model's exhaust gas leaves, and in which direction, body axes: the middle of the outlet parts at rest, and
 * the axis along which they lie farthest out, but never downwards. Returns false where no part is an outlet. */
static bool outlet_of(double at_body[3], double d_body[3], const Model *model, HeatRole role)
{
    double sum[3] = {0}, far = -1;
    int    count = 0, axis = 0;
    for (int p = 0; p < model->part_count; p++) {
        const ModelPart *part = &model->part[p];
        if (part->role != role) continue;
        for (int c = 0; c < 3 * part->triangle_count; c++) {
            double at[3];
            model_corner(at, model, part, c);
            v3_add(sum, sum, at);
            count++;
        }
    }
    if (count == 0) return false;
    v3_scale(at_body, 1.0 / count, sum);
    double sign = -1;
    for (int k = 0; k < 3; k++) {
        const double middle = 0.5 * (model->box_low[k] + model->box_high[k]);
        const double half = fmax(0.5 * (model->box_high[k] - model->box_low[k]), 0.01);
        const double off = (at_body[k] - middle) / half;
        if (k == 2 && off > 0) continue;
        if (fabs(off) > far) far = fabs(off), axis = k, sign = off > 0 ? 1 : -1;
    }
    v3_scale(d_body, 0, d_body);
    d_body[axis] = sign;
    return true;
}

bool exhaust_outlet(ExhaustJet *jet, const Model *model, bool turbine, const EffectTable *table)
{
    const EffectModel *law = &table->law[turbine ? EFFECT_TURBINE_EXHAUST : EFFECT_EXHAUST];
    jet->radius_m = law->radius_start_m * (turbine ? 1 : vehicle_effect_scale(model));
    jet->speed_mps = turbine ? 40 : 12;
    jet->excess_k = law->temp_rise_k;
    return outlet_of(jet->at_body, jet->d_body, model, turbine ? HEAT_TURBINE : HEAT_EXHAUST);
}

int exhaust_behind(EffectPuff *out, const ExhaustSource *e, const EffectTable *table, double t_s)
{
    enum { puffs = exhaust_puffs };
    const EffectKind    kind = e->kind;
    const EffectModel  *law = &table->law[kind];
    const double        drive = e->drive, scale = e->scale;
    const double        jet_mps = e->jet->speed_mps;
    static const double jet_decay_s = 0.12;
    double              at_ecef[3], d_ecef[3];
    if (!(drive > 0)) return 0;
    const uint64_t key = e->key;
    const double   interval_s = law->life_s / (puffs + 0.5), begun = floor(t_s / interval_s);
    const double   phase = t_s / interval_s - begun;
    m3_mul_v3(at_ecef, e->r_ecef_from_body, e->jet->at_body);
    m3_mul_v3(d_ecef, e->r_ecef_from_body, e->jet->d_body);
    for (int k = 0; k < puffs; k++) {
        EffectPuff *puff = &out[k];
        *puff = (EffectPuff){.kind = kind,
                             .owner = key + 1,
                             .group = (uint32_t)(key * 31 + kind),
                             .throw_s = jet_decay_s,
                             .seed = (uint32_t)((int64_t)begun - k),
                             .scale = scale,
                             .age_s = (k + phase + 0.5) * interval_s};
        puff->mass_kg = law->mass_kg * scale * scale * drive * interval_s * (k == 0 ? phase : 1);
        v3_add(puff->p_ecef, e->p_ecef, at_ecef);
        v3_add_scaled(puff->p_ecef, puff->p_ecef, -puff->age_s, e->v_ecef_mps);
        v3_scale(puff->up_ecef, 1 / v3_length(e->p_ecef), e->p_ecef);
        /* a puff is as long as the way to the next puff, seen from the outlet, so that puffs join */
        const double early = exp(-(puff->age_s - 0.5 * interval_s) / jet_decay_s);
        const double jet_m = jet_mps * jet_decay_s * early * -expm1(-interval_s / jet_decay_s);
        const double left_s = interval_s - jet_m / jet_mps; /* multiplied by the outlet's speed */
        double       way[3];
        for (int i = 0; i < 3; i++) {
            puff->throw_mps[i] = jet_mps * d_ecef[i] + e->v_ecef_mps[i];
            way[i] = jet_m * d_ecef[i] - left_s * e->v_ecef_mps[i];
        }
        puff->along_m = 0.6 * v3_length(way);
        if (!v3_normalize(puff->axis_ecef, way)) memcpy(puff->axis_ecef, d_ecef, sizeof puff->axis_ecef);
    }
    return puffs;
}
