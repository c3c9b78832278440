/* render/light/hemisphere.h: what sky and surroundings send to each hit, by asking them: rays over the hemisphere, two bounces.
 *
 * The quick form of render/light/optical.c and thermal.c sees sky and level ground by a surface's tilt; this one sees what
 * really stands there: a shadowed wall, a warm engine deck, the dark under a hull. Each direction is followed to what
 * it meets, lit by the sun or emitting by itself, and from there in one more direction; what that meets is lit the
 * quick way. Everything met counts as diffuse. Cost: 2 x samples first hits and shadow rays a hit. The error falls with
 * samples^-0.5 or faster; test_gather.c holds it against two other renderers. */
#ifndef RENDER_LIGHT_HEMISPHERE_H
#define RENDER_LIGHT_HEMISPHERE_H

#include "render/air/air.h"
#include "render/visibility/visibility.h"

enum { hemisphere_samples_max = 4096 };

typedef struct HemisphereScene {
    const Visibility *visibility;
    const Air        *air;
    const Materials  *materials;
    const Catalog    *catalog;   /* NULL where no entity shows: temperatures of parts come from their model */
    const Snapshot   *snapshot;
} HemisphereScene;

typedef struct HemisphereLight {
    float w_m2[AIR_BAND_COUNT][hits_capacity]; /* irradiance on the hit's own shading normal; 0 for sky */
} HemisphereLight;

/* bands: 1 << AirBand, those to fill. samples: 1 .. hemisphere_samples_max directions a hit, spread evenly over the
 * hemisphere. key: a number for each hit; same key, same directions, in whatever company. */
void hemisphere_light(HemisphereLight *out, const HemisphereScene *scene, const Hits *hits, unsigned bands, int samples,
                  const uint64_t *key, VisibilityCounters *counters);

/* What parts and shadows close by change of the light that a place would get from open sky and level, sunlit ground. */
typedef struct HemisphereChange {
    float w_m2[AIR_BAND_COUNT]; /* irradiance, exact less open; of the bands asked for, else 0 */
    float blocked, sunlit;      /* shares of its directions that meet something, and that meet what the sun shines on */
    float inside;               /* of those that met parts, the share met from within: a place inside a body has 1 */
} HemisphereChange;

/* out[hits->count]. Only what is nearer than reach_m counts, and of the listed entities alone, which must hold all of
 * those; places on the ground look only towards those within whose own reach, list_reach_m[listed] beyond their
 * sphere, they lie. From places on the ground the ground is not looked for: only parts change their light. Three
 * bounces; the open form is subtracted direction by direction, so that places which see nothing but open sky get 0,
 * without noise. The bright ring about the sun has directions of its own, for it would be most of the noise. */
void hemisphere_change(HemisphereChange *out, const HemisphereScene *scene, const Hits *hits, unsigned bands, int samples,
                   double reach_m, const double *list_reach_m, const uint64_t *key, const int *list, int listed,
                   VisibilityCounters *counters);

#endif
