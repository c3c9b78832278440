/* entities/traces/effect_puffs.h: flames, smoke, dust and bursts as puffs: composition and development over time.
 *
 * A puff is emitted at one position and time; its state is a closed form of its age. Nothing is integrated from frame
 * to frame, so times can be evaluated in any order. etc/effects.csv has the parameters and their accuracy. Sources and
 * times of puffs: effect_history.h. Rendering: render/smoke/smoke.h. */
#ifndef ENTITIES_TRACES_EFFECT_PUFFS_H
#define ENTITIES_TRACES_EFFECT_PUFFS_H

#include "pitviper_channels.h"
#include "terrain/earth/geodesy.h"
#include "terrain/weather/weather.h"

typedef enum EffectKind {
    EFFECT_MUZZLE_FLASH,
    EFFECT_MUZZLE_SMOKE,
    EFFECT_LAUNCH_FLASH,
    EFFECT_LAUNCH_SMOKE,
    EFFECT_BURST_FLASH,
    EFFECT_FIREBALL,
    EFFECT_BURST_SMOKE,
    EFFECT_BURST_DUST,
    EFFECT_SPARKS,
    EFFECT_FLAME,
    EFFECT_SMOKE,
    EFFECT_ENGINE_SMOKE,
    EFFECT_DUST,
    EFFECT_CONTRAIL,
    EFFECT_MOTOR_PLUME,
    EFFECT_MOTOR_SMOKE,
    EFFECT_AFTERBURNER,
    EFFECT_EXHAUST,
    EFFECT_TURBINE_EXHAUST,
    EFFECT_JET_EXHAUST,
    EFFECT_FLARE_FIRE,
    EFFECT_WOOD_SMOKE,     /* of open fires of clutter */
    EFFECT_SMOULDER_SMOKE, /* of heaps that smoulder */
    EFFECT_KIND_COUNT
} EffectKind;

/* Places of channels (pitviper_channels.h); pan is the mean of b, g and r. */
enum {
    effect_band_b = SPECTRAL_B,
    effect_band_g = SPECTRAL_G,
    effect_band_r = SPECTRAL_R,
    effect_band_pan = SPECTRAL_PAN,
    effect_band_nir = SPECTRAL_NIR,
    effect_band_mwir = SPECTRAL_MWIR,
    effect_band_lwir = SPECTRAL_LWIR,
    effect_band_count = SPECTRAL_PLACES
};

/* One row of etc/effects.csv. */
typedef struct EffectModel {
    double extinction_m2_kg[effect_band_count], albedo[effect_band_count];
    double asymmetry;
    double asymmetry_ir; /* of the thermal bands, whose extinction and albedo here are without the forward peak */
    double mass_kg;      /* mass of a puff; of emissions by entities, mass a second */
    double radius_start_m, radius_end_m, grow_s, spread_mps;
    double rise_mps, rise_s;
    double temp_rise_k, cool_s;
    double life_s;
    double time_power;
    double billow;
    double ground_share;         /* of the difference of ground and air at birth, which fades with cool_s */
    double co2_share, h2o_share; /* shares of the mass that are hot gas, which emits and absorbs in the thermal bands */
} EffectModel;

typedef struct EffectTable {
    EffectModel law[EFFECT_KIND_COUNT];
} EffectTable;

/* Every kind must have its row. Failures are logged with file, line and range. */
Status effect_table_open(EffectTable *out, const char *path);

/* One puff at one instant, as a Snapshot holds it: still without wind, which is the weather's. */
typedef struct EffectPuff {
    EffectKind kind;
    uint64_t   owner;        /* entity_key + 1 of its owner (snapshot_owns_puff); 0: none */
    uint32_t   group;        /* the same for puffs of one cloud or trail, which shade each other */
    uint32_t   seed;         /* seed of its pattern */
    double     age_s;        /* >= 0; 0 for puffs attached to an entity */
    double     p_ecef[3];    /* place where it was emitted */
    double     up_ecef[3];   /* unit */
    double     throw_mps[3]; /* ECEF, initial velocity; decays with throw_s */
    double     throw_s;
    double     scale;        /* scale of lengths: W^(1/3) */
    double     mass_kg;      /* its mass before thinning */
    double     axis_ecef[3]; /* unit vector; the spheroid's axis */
    double     along_m;      /* least half length along the axis; 0: the puff is a sphere */
    bool       grounded;     /* it was emitted above_m above the snapshot's ground there */
    double     above_m;
} EffectPuff;

/* A spheroid whose density falls off as (1 - q^2)^2 from its centre to its surface (q = 1). */
typedef struct EffectVolume {
    double p_enu[3], axis_enu[3];
    double along_m, across_m;                   /* half axes, along the axis and across it */
    double temp_k, ground_share;                /* and so much of the difference of the ground below to the air */
    double extinction_per_m[effect_band_count]; /* extinction at the centre, without gas */
    double co2_kg_m3, h2o_kg_m3;                /* density of gases at the centre */
} EffectVolume;

/* Time for which a puff of this kind and scale is visible. */
double effect_life_s(const EffectTable *table, EffectKind kind, double scale);
/* False when it has ended. The wind carries a free puff at its full speed from the first moment:
 * drift = wind age, exactly. */
bool effect_volume(EffectVolume *out, const EffectTable *table, const EffectPuff *puff, const Weather *weather,
                   const LocalFrame *frame);

/* The gas of an engine, where it leaves a model. */
typedef struct ExhaustJet {
    double at_body[3], d_body[3]; /* place relative to the centre of the model's base; unit direction */
    double radius_m, speed_mps;   /* radius and speed of the jet */
    double excess_k;              /* temperature above that of the air, once mixed with the air of the first metre */
} ExhaustJet;

#endif
