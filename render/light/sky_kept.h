/* render/light/sky_kept.h: what the paths from sample points met, kept from frame to frame.
 *
 * A point's paths (hemisphere_change) meet the same things as long as the point stays and nothing moves that they could
 * meet; only the light of what they met changes, with the sun, the sky and the temperatures, and is computed anew. So
 * the meetings are kept, not the light, and a frame has the same bits whether they were kept or traced, whatever came
 * before it (tests/sensor/test_sky_kept.c).
 *
 * A point is known by its place, its normal and the key of its random directions. Beside its meetings the box of all its
 * rays is kept, and a hash of 64 bits of the poses, to the bit, of every entity near that box: an entity that moves,
 * turns a joint, loses a part, appears, goes or changes its place in the snapshot changes it, and the point is traced
 * again. Rays towards the sun follow it and are never kept. Points are kept only where all that is near has stood
 * since the frame before: what moves costs nothing to remember.
 *
 * One frame at a time uses the store, others go without. Its memory is bounded: when it is full, what the frame did not
 * use goes, and if that is not enough nothing is added. */
#ifndef RENDER_LIGHT_SKY_KEPT_H
#define RENDER_LIGHT_SKY_KEPT_H

#include "render/visibility/visibility.h"

typedef struct SkyKept      SkyKept;      /* of a world */
typedef struct SkyKeptFrame SkyKeptFrame; /* its use by a frame */
typedef struct SkyNotes     SkyNotes;     /* of a thread of the frame */

enum { sky_kept_octets = 32 << 20 }; /* some 60,000 points */

/* STATUS_NO_MEMORY. octets: of all that is kept, at most. */
Status sky_kept_create(SkyKept **out, size_t octets);
void   sky_kept_destroy(SkyKept *kept); /* accepts NULL */
/* What is kept: points, and octets. */
void   sky_kept_size(size_t out[2], SkyKept *kept);

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
    uint32_t facet, entity;
    uint16_t material, part, model;
    uint8_t  kind, inside, surface;
    uint8_t  sample, bounce;
} SkyMet;

/* All that the paths of a point met, path by path, each from its first bounce; after the last one of bounce sky_met_end. */
enum { sky_met_end = 255 };
/* Of every hit; NULL: not kept, or no longer true. */
void sky_notes_find(const SkyMet *known[hits_capacity], SkyNotes *notes, const Hits *hits, const uint64_t *key, int samples);
void sky_met_load(Hits *hits, Rays *rays, int i, const SkyMet *met);

/* Of points that are traced now, 0 .. points - 1. Rays: all but those towards the sun, whether they are traced or
 * known to meet nothing. */
void sky_notes_begin(SkyNotes *notes, int points);
void sky_notes_ray(SkyNotes *notes, int point, const double o_enu[3], const double d_enu[3], double reach_m);
void sky_notes_met(SkyNotes *notes, int point, int sample, int bounce, const Hits *hits, const Rays *rays, int i);
/* Keeps those that are not known yet; hits, key: of the points. reach_m: of their first rays. */
void sky_notes_keep(SkyNotes *notes, const Hits *hits, const uint64_t *key, int samples, double reach_m,
                    const SkyMet *const *known);

#endif
