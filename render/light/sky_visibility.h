/* render/light/sky_visibility.h: the share of the open-sky light that arrives near vehicles and buildings, and what
 * frames keep of it. */
#ifndef RENDER_LIGHT_SKY_VISIBILITY_H
#define RENDER_LIGHT_SKY_VISIBILITY_H

#include "render/trace/visibility/visibility.h"
#include "render/light/hemisphere.h"
#include "render/scene/view.h"
#include "terrain/ground/landscape.h"

/* ---- what is kept from frame to frame -------------------------------------------------------- */

/* What the paths from sample points met, kept from frame to frame.
 *
 * A point's paths (hemisphere_change) meet the same things as long as the point stays and nothing moves that they could
 * meet; only the light of what they met changes, with the sun, the sky and the temperatures, and is computed anew. So
 * the meetings are kept, not the light, and a frame has the same bits whether they were kept or traced, whatever came
 * before it (tests/sensor/test_sky_kept.c).
 *
 * A point is known by its place, its normal and the key of its random directions. Beside its meetings the box of all
 * its rays is kept, and a hash of 64 bits of the poses, to the bit, of every entity near that box: an entity that
 * moves, turns a joint, loses a part, appears, goes or changes its place in the snapshot changes it, and the point is
 * traced again. Rays towards the sun follow it and are never kept. Points are kept only where all that is near has
 * stood since the frame before: what moves costs nothing to remember.
 *
 * One frame at a time uses the store, others go without. Its memory is bounded: when it is full, what the frame did not
 * use goes, and if that is not enough nothing is added. */

typedef struct SkyKept      SkyKept;      /* of a world */
typedef struct SkyKeptFrame SkyKeptFrame; /* its use by a frame */
typedef struct SkyNotes     SkyNotes;     /* of a thread of the frame */

enum { sky_kept_octets = 32 << 20 }; /* some 60,000 points */

/* STATUS_NO_MEMORY. octets: of all that is kept, at most. */
Status sky_kept_create(SkyKept **out, size_t octets);
void   sky_kept_destroy(SkyKept *kept); /* accepts NULL */
/* What is kept: points, and octets. */
void sky_kept_size(size_t out[2], SkyKept *kept);

/* *out NULL: kept is NULL, or another frame uses it. world: a hash of what else the meetings depend on. visibility and
 * arena must outlive the frame. */
Status sky_kept_begin(SkyKeptFrame **out, SkyKept *kept, const Visibility *visibility, uint64_t world, Arena *arena);
Status sky_notes_create(SkyNotes **out, SkyKeptFrame *frame, Arena *arena);
/* When no thread is at it any more: what the threads noted is kept. Returns the points that the frame found. Accepts
 * NULL. */
uint64_t sky_kept_end(SkyKeptFrame *frame);

/* What a path met at one of its bounces: a row of Hits, without plants, and the ray's direction. */
typedef struct SkyMet {
    double   p_enu[3], d_enu[3];
    float    n_geo[3], n_enu[3];
    uint32_t facet, entity, instance;
    uint16_t material, part, model;
    uint8_t  kind, inside, surface;
    uint8_t  sample, bounce;
} SkyMet;

/* All that the paths of a point met, path by path, each from its first bounce; after the last one of bounce
 * sky_met_end. */
enum { sky_met_end = 255 };
/* Of every hit; NULL: not kept, or no longer true. */
void sky_notes_find(const SkyMet *known[hits_capacity], SkyNotes *notes, const Hits *hits, const uint64_t *key,
                    int samples);
void sky_met_load(Hits *hits, Rays *rays, int i, const SkyMet *met);

/* Of points that are traced now, 0 .. points - 1. Rays: all but those towards the sun, whether they are traced or
 * known to meet nothing. */
void sky_notes_begin(SkyNotes *notes, int points);
void sky_notes_ray(SkyNotes *notes, int point, const double o_enu[3], const double d_enu[3], double reach_m);
void sky_notes_met(SkyNotes *notes, int point, int sample, int bounce, const Hits *hits, const Rays *rays, int i);
/* Keeps those that are not known yet; hits, key: of the points. reach_m: of their first rays. */
void sky_notes_keep(SkyNotes *notes, const Hits *hits, const uint64_t *key, int samples, double reach_m,
                    const SkyMet *const *known);

/* ---- contact shadows ------------------------------------------------------------------------- */

/* Share of the open-sky light that reaches points near vehicles and buildings.
 *
 * By its tilt alone a surface would receive the whole sky above it and level, sunlit ground below. Beside a vehicle,
 * under a hull and on a side that faces the vehicle's own shadow that is wrong by factors. Here hemisphere sampling at
 * a set of sample points finds the obstructions (hemisphere_change), and a hit takes the factor interpolated between
 * the points about it:
 *
 *   ground    points of a square lattice that is fixed to the ground, finer where their values differ and never finer
 *             than the picture's resolution; computed when a hit needs them, cached for the frame
 *   entities  the surface of each on a grid over its box, some 2.75 px apart, at least 3 x 3 and at most 48 x 48,
 *             computed when a hit first needs one of them, by all threads that do; a hit takes those about it that face
 *             its way. The grid stands on the body, across the middle of a bin of aspects (5 to 10 degrees) and at the
 *             nearest of spacings a half octave apart, so that it is the same while the eye stays within these. On
 *             entities too large for that (132 px) it lies over the box on the image
 *
 * The value of a point depends on the scene and the view only, so it is the same whichever thread computes it. What its
 * paths meet is kept from frame to frame while nothing near moves (SkyKept); its light never. The
 * ground is treated only within reach of an entity: beyond, it hides less than 2 % of a level plane's sky. Sky hidden
 * by terrain is not included. A gloss shows what is left of sky and of level ground, each by its mean: how bright the
 * shadow before a side is, not where it ends.
 *
 * Error against hemisphere_light, means of 5 x 5 px (tests/sensor/test_sky_visibility.c): 1 to 4 % rms on shadowed
 * ground, 11 to 20 % where less than 40 % of the open light comes, 5 to 15 % on sides away from the sun (24 % in the
 * hollows of a tank's running gear). Whole faces of a box: within 5 % of a path tracer
 * (tests/system/test_faces_judge.sh). */

typedef struct SkyVisibility SkyVisibility; /* of a frame; shared by its threads */
typedef struct SkyWorker     SkyWorker;     /* of a thread */

typedef struct SkyVisibilityScene {
    HemisphereScene  gather;
    const Landscape *landscape; /* NULL: no ground */
    const View      *view;
    const double (*box_px)[4]; /* [entities]: on the image, as TargetPixels.projected_box; NaN: not on the image */
    unsigned air_bands;        /* 1 << AirBand: all that the frame may need */
    unsigned skips_off;
    int      hidden_entity; /* index of the entity whose parts the eye does not see; -1: none */
    SkyKept *kept;          /* of earlier frames, over the same ground and materials; NULL: none */
} SkyVisibilityScene;

/* The scene's parts must outlive it. STATUS_NO_MEMORY: of the arena. */
Status sky_visibility_create(SkyVisibility **out, const SkyVisibilityScene *scene, Arena *arena);
Status sky_worker_create(SkyWorker **out, const SkyVisibility *v, Arena *arena);
/* When its threads are done: what they found is kept. Accepts NULL. */
void sky_visibility_close(SkyVisibility *v, VisibilityCounters *counters);

/* Evaluates the points on every entity beforehand, in so many tasks for a pool; hits ask for those of entities that
 * they show otherwise. The same bits. */
int  sky_visibility_tasks(const SkyVisibility *v);
void sky_visibility_task(const SkyVisibility *v, SkyWorker *worker, int task);

typedef struct SkyOpen {
    float factor[AIR_BAND_COUNT][hits_capacity]; /* factor on the light that the tilt alone gives; 1 where nothing
                                                  * is near */
    float below[AIR_BAND_COUNT][hits_capacity];  /* hemisphere_below */
    bool  any_below;                             /* else of every hit 1, and not set */
} SkyOpen;

/* False: nothing near any of the hits, and nothing written; else the factors of the frame's bands. */
bool sky_visibility_open(SkyOpen *out, const SkyVisibility *v, SkyWorker *worker, const Hits *hits,
                         VisibilityCounters *counters);

#endif
