/* entities/traces/exhaust.h: the hot gas behind the outlet of an engine that runs, as puffs. The same for entities and
 * for scenery. */
#ifndef ENTITIES_TRACES_EXHAUST_H
#define ENTITIES_TRACES_EXHAUST_H

#include "entities/models/model.h"
#include "entities/traces/effect_puffs.h"

/* Where a model's exhaust leaves, and how; turbine: through its turbine's outlet. False: it has none, and only
 * at_body and d_body are left as they are. Speeds of jets (12 m/s of an engine, 40 m/s of a turbine) are estimates. */
bool exhaust_outlet(ExhaustJet *jet, const Model *model, bool turbine, const EffectTable *table);

typedef struct ExhaustSource {
    EffectKind        kind; /* EFFECT_EXHAUST or EFFECT_TURBINE_EXHAUST */
    const ExhaustJet *jet;
    uint64_t          key;          /* owner of the puffs, less 1 */
    double            drive, scale; /* drive: the engine's share of full power; 0: there is no gas */
    const double     *p_ecef, *r_ecef_from_body, *v_ecef_mps; /* of the model's origin, now */
} ExhaustSource;

enum { exhaust_puffs = 5 };
/* A jet that mixes with the air, as puffs at equal intervals of age; the first one is still growing. Each left the
 * outlet where it was at that time, and keeps the outlet's and the jet's speed for a moment; then wind and buoyancy
 * carry it (effect_volume). A function of the source and t_s alone. Returns how many: exhaust_puffs, or 0. */
int exhaust_behind(EffectPuff *out, const ExhaustSource *source, const EffectTable *table, double t_s);

#endif
