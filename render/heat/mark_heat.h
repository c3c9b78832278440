/* render/heat/mark_heat.h: what entities left in the ground's heat: shadows of those that stood there, trails, burnt ground.
 *
 * A stand hid the sun along its box's shadow, and sky, while it stood: each past interval of HeatPast that it overlaps
 * gives kelvins by the kind's response, scaled as the shade of heat.h is: sun hidden all day, or all of the sky hidden, are the
 * columns that see none. A track was rubbed warm once, by a pulse of heat that the same response lets
 * fade, and lies loosened: some of the way to ploughed ground, for good. A burst burnt its ground but for the crater, which is loose soil,
 * and left heat.
 * The exhaust of what stands warms the ground that it reaches (jet_path.h, in still air: what reaches the ground does so within
 * metres of the outlet, before a wind bends it): a flux by the film of its speed (vehicle_heat.h) that falls as the ground warms, through
 * the kind's response; ground that the sun has made warmer than the gas is not cooled, and the gas' radiation is left out.
 * Estimates: the loosened share (0.6 of tracks, 0.3 of wheels), the burnt edge. */
#ifndef RENDER_HEAT_MARK_HEAT_H
#define RENDER_HEAT_MARK_HEAT_H

#include "entities/table/snapshot.h"
#include "render/heat/heat.h"
#include "terrain/earth/geodesy.h"

typedef struct MarkHeat MarkHeat;

/* Of the snapshot's marks, in the arena. exercise_s: Unix time of exercise time 0. *out NULL: there are none. */
Status mark_heat_create(MarkHeat **out, const GroundMarks *marks, const LocalFrame *frame, double exercise_s, double unix_s,
                        const HeatNow *now, Arena *arena);

/* At a place of the ground: its kind may be mixed with another, and its temperature changed. */
typedef struct MarkedGround {
    double add_k;      /* to the temperature of the kind */
    double loose;      /* share of ploughed ground */
    double burnt;      /* share of burnt ground */
} MarkedGround;

/* lit: share of the past sun that relief and plants left. False: no marks near; out is zero then. */
bool mark_heat_at(MarkedGround *out, const MarkHeat *marks, int kind, const double p_enu[3], const double n_enu[3], double lit);

#endif
