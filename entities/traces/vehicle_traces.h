/* entities/traces/vehicle_traces.h: what a vehicle that drives leaves behind it, by its model: the two lines of its
 * trail and the place and amount of its dust. The same for entities and for what drives of scenery. */
#ifndef ENTITIES_TRACES_VEHICLE_TRACES_H
#define ENTITIES_TRACES_VEHICLE_TRACES_H

#include "entities/models/model.h"
#include "entities/traces/effect_history.h"
#include "entities/traces/ground_marks.h"

/* Share of the mass that a row of etc/effects.csv gives off: of no, a small, a medium and a large trail (the sizes of
 * the appearance field of DIS). Estimate. */
static const double vehicle_trail_rate[4] = {0, 0.35, 1, 2.5};

/* Scale of its flames, smoke and dust: 1 for a vehicle of 40 m3. */
double vehicle_effect_scale(const Model *model);

/* Puts a source of dust behind the wheels: kind, place and spread, body axes. below_m: along body z from the source's
 * position down to the base of the model. */
void vehicle_dust(EffectSource *source, const Model *model, double below_m);

/* Widths and friction heat of a piece of its trail; the rest is zero. Rolling resistance of 5 % of the weight for
 * tracks and 3 % for tyres on soil: middle of the ranges in Wong, Theory of Ground Vehicles. Estimates: weight by the
 * bounding box (a tank of 59 m3: 53 t; a lorry of 55 m3: 19 t), width of a track or tyre as a share of the vehicle's,
 * and half of the heat in the ground. Within a factor of two. */
GroundTrack vehicle_track(const Model *model, bool tracked);

#endif
