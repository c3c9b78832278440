/* render/light/hemisphere.h: irradiance of each hit from sky and surroundings by hemisphere sampling: rays over the
 * hemisphere, two bounces.
 *
 * The quick form of render/light/optical.c and thermal.c takes sky and level ground by a surface's tilt; this one
 * includes the actual surroundings: a shadowed wall, a warm engine deck, the darkness under a hull. Each direction
 * is traced to its hit, which is lit by the sun or emits, and from there in one more direction; that second hit is
 * lit by the quick form. All hits count as diffuse. Cost: 2 x samples first hits and shadow rays a hit. The error
 * falls with samples^-0.5 or faster; test_hemisphere.c compares it with two other renderers. */
#ifndef RENDER_LIGHT_HEMISPHERE_H
#define RENDER_LIGHT_HEMISPHERE_H

#include "render/air/air.h"
#include "render/heat/vehicle_heat.h"
#include "render/trace/visibility/visibility.h"

enum { hemisphere_samples_max = 4096 };

typedef struct HemisphereScene {
    const Visibility *visibility;
    const Air        *air;
    const Materials  *materials;
    const PatchSet   *patches; /* NULL: parts are as warm as the air */
    const Snapshot   *snapshot;
} HemisphereScene;

struct SkyNotes; /* render/light/sky_visibility.h */

typedef struct HemisphereLight {
    float w_m2[AIR_BAND_COUNT][hits_capacity];  /* irradiance on the hit's own shading normal; 0 for sky. Of leaves: and
                                                 * that on their far side, material_through of it */
    float below[AIR_BAND_COUNT][hits_capacity]; /* hemisphere_below of it; of leaves and sky: 1 */
} HemisphereLight;

/* bands: 1 << AirBand, those to fill. samples: 1 .. hemisphere_samples_max directions a hit, spread evenly over the
 * hemisphere. key: a number for each hit; same key, same directions, independent of the other hits. */
void hemisphere_light(HemisphereLight *out, const HemisphereScene *scene, const Hits *hits, unsigned bands, int samples,
                      const uint64_t *key, VisibilityCounters *counters);

/* Change of the light of open sky and level, sunlit ground at a point by nearby parts and shadows. */
typedef struct HemisphereChange {
    float w_m2[AIR_BAND_COUNT];       /* irradiance, exact less open; of the bands requested, else 0 */
    float below_w_m2[AIR_BAND_COUNT]; /* of that: from directions below the horizontal */
    float blocked, sunlit; /* shares of its directions that meet something, and that meet sunlit surfaces; the
                            * latter of points on the ground, or where a band needs it */
    float inside;          /* of those that met parts, the share met from within: a point inside a body has 1 */
} HemisphereChange;

/* Factor on the radiance of level, open ground for what a surface sees below the horizontal, 0 .. 100: its mean there,
 * weighted by the cosine from the normal. change_w_m2: irradiance from below, less that of level ground; up: of the
 * normal. A surface that hardly sees the ground has hardly a direction to judge it by: below an eighth of its
 * hemisphere the factor tends to 1. */
double hemisphere_below(double change_w_m2, double ground_w_m2_sr, double up);

enum { hemisphere_change_bounces = 3 };

/* What may change the light, and how finely that is sampled. */
typedef struct HemisphereNear {
    unsigned      bands;        /* 1 << AirBand */
    int           samples;      /* directions a point */
    double        reach_m;      /* at each bounce only what is nearer counts */
    int           listed;       /* number of entities that count */
    const int    *list;         /* [listed]: must include all that are nearer than bounces x reach_m */
    const double *list_reach_m; /* [listed]: a point on the ground is sampled only towards entities that are nearer than
                                 * this beyond their sphere */
} HemisphereNear;

/* out[hits->count]. From points on the ground the ground is not traced: only parts change their light. notes: where
 * meetings are kept (render/light/sky_visibility.h), the same bits; NULL: nowhere. Three bounces; the open form is
 * subtracted direction by direction, so that points with an unobstructed sky get 0, without noise. The bright ring
 * about the sun has separate directions, since it would cause most of the noise. */
void hemisphere_change(HemisphereChange *out, const HemisphereScene *scene, const Hits *hits,
                       const HemisphereNear *near, const uint64_t *key, struct SkyNotes *notes,
                       VisibilityCounters *counters);

#endif
