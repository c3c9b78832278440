/* render/frame/shade_private.h: rays -> hits -> radiance, one channel of light each.
 *
 * The input is a list of rays, the output arrays of hits and of radiance along the rays. The code does not depend on
 * the use of the samples: pixels of a picture, cells of a target grid, or pixels re-sampled for the error estimate.
 * A sample's result depends on its own ray (and key) alone, not on the others of the list. */
#ifndef RENDER_FRAME_SHADE_PRIVATE_H
#define RENDER_FRAME_SHADE_PRIVATE_H

#include "render/frame/picture.h"
#include "render/frame/world.h"
#include "render/light/hemisphere.h"
#include "render/light/lamps.h"
#include "render/light/sky_visibility.h"
#include "render/light/surface_light.h"
#include "render/light/thermal.h"
#include "render/smoke/smoke.h"

/* The scene of a frame, shared by its threads. */
typedef struct ShadeScene {
    const World       *world;
    const Snapshot    *snapshot;
    const Air         *air;
    const Visibility  *visibility;
    const Visibility  *bare;    /* the same without plants */
    const Visibility  *full;    /* the same with every plant at its full detail */
    ForestFrame        plants;  /* where visibility has some */
    EffectScene        effects; /* smoke, dust, flames and bursts */
    SurfaceLight       surface_light;
    FarWoodsFrame     *far;           /* NULL: no woods were left out */
    const SkyHorizons *horizons;      /* NULL: buildings hide no sky */
    SkyHorizonLight    horizon_light; /* with horizons */
    LampLight         *lamps;         /* NULL: none is lit */
    SkyVisibility     *sky;           /* NULL: sky and ground irradiance follow from the surface tilt alone */
    int                sky_samples;   /* directions of hemisphere sampling a hit; 0: the quick form */
    const int         *all_volumes;   /* 0, 1, 2 ...: all of the effects */
    int                hidden_entity; /* snapshot index of the entity whose parts these rays do not meet; -1: none */
} ShadeScene;

/* Poses the snapshot and prepares its plants, light and smoke, seen from the eye of this view. scene: world, snapshot
 * and air are set; all else is written, sky as NULL.
 * channels: 1 << AirBand, those that will be requested. pool may be NULL: one thread. What is set, and all other
 * arguments, must outlive it; the arena owns its memory. shade_scene_close before the arena is reset, after a failure
 * as well. */
Status shade_scene_create(ShadeScene *scene, const RenderRequest *request, unsigned channels, Pool *pool, Arena *arena);
void   shade_scene_close(ShadeScene *scene);

/* A list of samples: inputs and results. Arrays of `capacity`, of the arena they came from. */
typedef struct Samples {
    int capacity;
    /* inputs */
    Rays              rays;
    unsigned          channels;    /* 1 << AirBand: those to fill in radiance */
    bool              radar;       /* radar returns, too */
    bool              temperature; /* temp_k even where no thermal channel needs it */
    double            per_rad;     /* samples a radian: at range r one covers r / per_rad across */
    const uint64_t   *key;         /* a key a sample that seeds its random choices; with sky_samples only */
    const int        *volume;      /* indices into effects.volume that these rays may meet, nearest first */
    int               volumes;
    const EntityHits *known; /* of the rays, where one entity was traced alone; NULL: none */
    /* results */
    Hits         hits;
    float       *sun;                      /* share of the direct sun that arrives, 0 .. 1; the same in all channels */
    float       *temp_k;                   /* NaN: sky */
    float       *radiance[AIR_BAND_COUNT]; /* at the eye, W/(m2 sr); of the requested channels */
    float       *radar_power;              /* sum over the bounces, relative */
    SmokeRays    smoke;                    /* transmittance and radiance of smoke and dust before the hits */
    RadarReturns returns;
} Samples;

/* Allocates arrays of `capacity` samples, at most hits_capacity. STATUS_NO_MEMORY: of the arena. */
Status shade_samples_create(Samples *out, int capacity, Arena *arena);

/* The terms of a block's light and temperatures, of the record of a pixel (pixel_record.h has their meaning), and
 * memory to find them: shade_terms.c. */
typedef struct ShadeTerms {
    float  emitted[AIR_BAND_COUNT][hits_capacity], reflected[AIR_BAND_COUNT][hits_capacity];
    float  sunlit[AIR_BAND_COUNT][hits_capacity], sky[AIR_BAND_COUNT][hits_capacity];
    float  ground[AIR_BAND_COUNT][hits_capacity], lamps[AIR_BAND_COUNT][hits_capacity];
    double beyond[AIR_BAND_COUNT], disc[AIR_BAND_COUNT][hits_capacity];
    float  air_k[hits_capacity], still_k[hits_capacity], sunlit_k[hits_capacity], detailed_k[hits_capacity];
    /* working memory */
    AirPaths     path[AIR_BAND_COUNT];
    SurfaceLight light;
    CanopyLight  canopy;
    Hits         hits;
    float        none[hits_capacity], one[hits_capacity], mirror_sky[AIR_BAND_COUNT][hits_capacity];
} ShadeTerms;

void shade_terms_light(ShadeTerms *terms, const ShadeScene *scene, const Samples *s, const SurfaceBlock *block);
void shade_terms_heat(ShadeTerms *terms, const ShadeScene *scene, const Samples *s, const PartTemps *parts,
                      const float *photo, const float *warmth_k);

/* The lamps that are lit, of a scene with visibility and air. */
Status shade_lamps_open(ShadeScene *scene, Arena *arena);
/* Adds their light to radiance at the eye, before smoke: out, path: by channel. noted: what they add at the surface
 * [AIR_BAND_COUNT]; NULL: not wanted. Nothing is done where none is lit. */
void shade_lamps_add(float *const out[AIR_BAND_COUNT], const ShadeScene *scene, const Samples *s,
                     const uint16_t *material, const float (*texture)[hits_capacity], const AirPaths *path,
                     float (*noted)[hits_capacity]);

/* A thread's own working memory. */
typedef struct Shader {
    SkyWorker         *sky; /* with ShadeScene.sky */
    AirPaths           air[AIR_BAND_COUNT];
    float              texture[optical_channel_count][hits_capacity];   /* relative brightness of the ground */
    float              across_m[hits_capacity], along_m[hits_capacity]; /* a sample's footprint on the ground */
    float              warmth_k[hits_capacity], radar[hits_capacity];   /* the ground's detail: GroundDetail */
    float              slope_x[hits_capacity], slope_y[hits_capacity];
    bool               sloped;                  /* some slope is not 0 */
    float              n_enu[3][hits_capacity]; /* normals as stored, while those of the hits are bent */
    float              photo[hits_capacity];    /* brightness of the photograph over that of its class; 1: none */
    HemisphereLight    gathered;                /* with sky_samples only */
    SkyOpen            open;
    bool               any_open; /* `open` has factors of these hits */
    CanopyLight        canopy;
    bool               any_canopy; /* `canopy` is of these hits */
    bool               any_far;    /* some of these hits lie in far woods; else the rest is not set */
    FarPlaces          far;
    uint16_t           far_material[hits_capacity];
    float              far_sun[hits_capacity], far_k[hits_capacity], of_far[hits_capacity];
    ShadeTerms        *terms; /* of these hits; NULL: not wanted */
    VisibilityCounters counters;
    double             visibility_s, shadow_s, shade_s, radar_s;
} Shader;

/* First hits of the rays; list: entities that they may meet (visibility_block_entities), count -1: any. */
void shade_samples_trace(Shader *shader, const ShadeScene *scene, Samples *s, const int *list, int listed);
/* Rays to the sun from the hits, where a channel shows shadows. */
void shade_samples_sun(Shader *shader, const ShadeScene *scene, Samples *s);
/* Smoke and dust before the hits; shade_samples_light calls it, too. */
void shade_samples_smoke(const ShadeScene *scene, Samples *s);
/* Temperatures, and the light of every channel, for hits whose sun share is already known. */
void shade_samples_light(Shader *shader, const ShadeScene *scene, Samples *s);
/* All steps: from the rays to their light. */
void shade_samples_shade(Shader *shader, const ShadeScene *scene, Samples *s, const int *list, int listed);

/* After shade_samples_light: the same light without tables: the air computed path by path (air_paths_directly), in
 * double (optical_shade, thermal_shade). Replaces radiance; direct: memory for it. */
void shade_samples_light_directly(Shader *shader, const ShadeScene *scene, Samples *s, AirPaths direct[AIR_BAND_COUNT]);

/* Share of a sample's light that smoke absorbs in a channel, 0 .. 1; 0 for channels that were not requested. */
static inline double samples_smoke_taken(const Samples *s, int channel, int i)
{
    if (!s->smoke.any || channel < 0 || !(s->channels >> channel & 1)) return 0;
    return 1 - (double)s->smoke.transmittance[channel][i];
}

#endif
