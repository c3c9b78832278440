/* render/heat/vehicle_heat.h: temperatures of entities over an exercise, and of the patches of their models. */
#ifndef RENDER_HEAT_VEHICLE_HEAT_H
#define RENDER_HEAT_VEHICLE_HEAT_H

#include "entities/models/patches.h"
#include "entities/table/snapshot.h"
#include "dis/pdu/pdu.h"
#include "render/heat/given_heat.h"
#include "render/heat/vehicle_load_private.h"
#include "render/heat/view_memory.h"
#include "render/trace/parts/parts.h"

/* ---- patches --------------------------------------------------------------------------------- */

/* The patches of models (entities/models/patches.h), each cut at its first use, or ahead of
 * it by a thread of its own. */

typedef struct PatchSet {
    int               models;
    Patches          *of;    /* [models] */
    bool             *cut;   /* [models] */
    struct PatchCut **ahead; /* [models]: being cut; NULL: not */
    Cache            *cache; /* where they are kept; NULL after heat_patches_create: nowhere */
    ViewMemory       *seen;  /* by poses of these models; NULL: nothing is remembered */
} PatchSet;

Status heat_patches_create(PatchSet *out, int models);
void   heat_patches_destroy(PatchSet *set); /* accepts zeroes */
/* One thread at a time. model: the built one, not its coarse form. STATUS_NO_MEMORY. */
Status heat_patches_need(PatchSet *set, int index, const Model *model);
/* Begins to cut a model in another thread, for which heat_patches_need then waits. Where there is none to be had, that
 * cuts it. */
void heat_patches_begin(PatchSet *set, int index, const Model *model);

/* Temperature of an entity's surface at a place of one of its parts, of node axes, K; NAN: none is known. Its model
 * must have been needed. */
static inline double patch_set_temp_k(const PatchSet *set, const Snapshot *snapshot, int entity, int part,
                                      const double p_node[3], const double n_node[3])
{
    const SnapshotEntity *e = &snapshot->entity[entity];
    if (e->first_patch < 0 || e->model < 0 || e->model >= set->models || !set->cut[e->model]) return NAN;
    const Patches *patches = &set->of[e->model];
    if (e->patches != patches->count) return NAN; /* of a file, for another model */
    return patches_value(patches, snapshot->patch_k + e->first_patch, part, p_node, n_node);
}

/* ---- entities over an exercise --------------------------------------------------------------- */

/* Temperatures of entities over an exercise: what stays of their engine, motion, shots
 * and of the sun of the hours before.
 *
 * Each entity is a thermal network of the patches of its model (vehicle_load_private.h). Its state advances at ticks of
 * exercise time, whatever frames are rendered: at once when its drives change, otherwise in steps that double from
 * first_step_s to step_s. Between two times of its own its patches lie on straight lines to what its present drives
 * lead to. So temperatures are a function of the log, the settings and the time.
 *
 * What a patch takes and gives: vehicle_load_private.h; what neighbours do to each other: vehicle_state_private.h.
 * Within a tick all that read another's temperatures read those of its beginning, so the order of work decides nothing.
 *
 * Work is done in pieces, those that have waited longest first, and no more of it in any 0.1 s of exercise time than
 * window_us (vehicle_heat_private.h), but for what neighbours add to a piece: at most eight that are posed, four jets
 * that are followed. The first tick, before any frame, has no limit. So no frame pays for a crowd that appears at once:
 * an entity is as warm as the air until its past is worked out.
 *
 * Before its first report an entity is taken to have stood there for a day with its engine stopped, and for its last
 * hour to have done what it then does: in single steps of the solver (tests/render/test_vehicle_heat_error.c).
 * Munitions and expendables start as warm as the air that flows past them. One whose temperatures were kept less
 * than three hours before (vehicle_heat.h) begins with those, and is taken to have done since then what it then does.
 */

/* present: the time of the tick; else earlier, when a ground as warm as the air will do. */
typedef Status VehiclePlace(PlaceHeat *out, const void *user, double unix_s, const double p_enu[3], bool present);

typedef struct VehicleHeatConfig {
    double        first_step_s, step_s; /* 1; 30 */
    double        window_us;            /* of work in 0.1 s of exercise time; INFINITY: no limit */
    double        unix_s;               /* of exercise time 0 */
    int           past_parts;           /* of each span of a past; above 1: with error control too; 0: 1 */
    int           capacity;             /* entities at most, by id; others stay as warm as the air, and are counted */
    bool          alone;                /* all are too far apart to be neighbours: none are looked for */
    VehiclePlace *place;
    const void   *user;
} VehicleHeatConfig;

typedef struct VehicleHeat VehicleHeat;

/* The world's own; they outlive it. */
typedef struct VehicleHeatWorld {
    const Catalog    *catalog; /* NULL: all models of the tracer have a shape, but for those that are NULL */
    const Materials  *materials;
    const PartTable  *table;
    const LocalFrame *frame;
    Tracer           *tracer;
    PatchSet         *patches;
    const GivenHeat  *given; /* shown instead, where it has a part; NULL: nothing is given */
    const KeptHeat   *kept;  /* of a run before; NULL: none */
} VehicleHeatWorld;

typedef struct VehicleHeatCounters {
    uint64_t steps, begun, left_out;
    uint64_t neighbours_left_out; /* beyond the numbers of vehicle_load_private.h, at each look for them */
    uint64_t failed;              /* steps that the solver gave up; the entity stays as it was */
    double   spent_s, longest_s;  /* wall clock; of the longest tick */
} VehicleHeatCounters;

Status vehicle_heat_create(VehicleHeat **out, const VehicleHeatConfig *config, const VehicleHeatWorld *world);
void   vehicle_heat_destroy(VehicleHeat *heat); /* accepts NULL */
/* At a time not before the last. */
Status vehicle_heat_tick(VehicleHeat *heat, const Snapshot *snapshot);
/* Another window_us from the next tick on. */
void vehicle_heat_limit(VehicleHeat *heat, double window_us);
/* Whether work is left for the next tick. */
bool vehicle_heat_waits(const VehicleHeat *heat);
/* Fills first_patch and patch_k of a snapshot at or after the last tick. */
Status                     vehicle_heat_show(const VehicleHeat *heat, Snapshot *snapshot, Arena *arena);
const VehicleHeatCounters *vehicle_heat_counters(const VehicleHeat *heat);
size_t                     vehicle_heat_bytes(const VehicleHeat *heat);

/* Network of an entity at its last own time: nodes, and heat that came from outside since it began, J. NULL: it has
 * none. */
typedef struct VehicleNodes {
    const VehicleShape *shape;
    const double       *temp_k; /* [shape->nodes] */
    double              heat_in_j, t_s;
} VehicleNodes;
/* What heat_kept_open reads, of all that are shown. */
Status vehicle_heat_keep(const VehicleHeat *heat, const char *path);

/* Error that steps and the past's single steps leave in a patch's temperature, K, rms: within a factor of 2 of a
 * solution in small steps in nine of ten (tests/render/test_vehicle_heat_error.c). */
static inline double vehicle_heat_error_k(double temp_k, double air_k)
{
    return 0.038 + 0.0045 * fmax(fabs(temp_k - air_k) - 15, 0);
}

bool vehicle_heat_nodes(VehicleNodes *out, const VehicleHeat *heat, DisEntityId id);

#endif
