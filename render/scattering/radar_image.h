/* render/scattering/radar_image.h: the pseudo-radar picture: metal as a mirror, the source at the eye, a stated lobe.
 *
 * Relative units (model=pseudo-radar), never dBsm. From each eye hit a mirror path is followed for up to six
 * bounces; its weight is the value of an energy-conserving lobe about its exit direction, towards the eye. Bounces
 * are reported separately, those beyond the third together with it: they are rare, and some vehicles send a sixth of
 * their power by five (bench precision, mirrors of a radar path). Ground and rough surfaces add diffuse backscatter. */
#ifndef RENDER_SCATTERING_RADAR_IMAGE_H
#define RENDER_SCATTERING_RADAR_IMAGE_H

#include "render/air/air.h"
#include "render/trace/visibility/visibility.h"

enum { radar_bounces = 3 /* that are reported */, radar_mirrors = 6 /* that are followed */ };

typedef struct RadarConfig {
    double lobe_rad;     /* rms half width of the exit lobe: antenna cone and surface roughness together; 0.05 */
    int    more_bounces; /* followed beyond radar_mirrors; below 0: fewer. For benchmarks */
} RadarConfig;

typedef struct RadarReturns {
    float power[radar_bounces][hits_capacity];   /* relative, per unit solid angle of the eye ray */
    float slant_m[radar_bounces][hits_capacity]; /* half the whole path; the last: its mean by power */
} RadarReturns;

/* Share of the power that leaves an exit lobe about a direction into one at an angle of this cosine to it,
 * 1/sr: exp(-(1 - cosine) / s^2) over a hemisphere, s^2 = lobe_rad^2 / 2; its integral over that hemisphere is
 * 1 exactly, its mean square angle lobe_rad^2 (to lobe_rad^2 / 3, relative). 0 beyond a right angle. Below 1e-9 and
 * beyond 1e6 rad those count. */
double radar_lobe(double lobe_rad, double cosine);

/* Eye rays and their first hits, and what the paths after them are followed through. */
typedef struct RadarRays {
    const Visibility *visibility;
    const Materials  *materials;
    const Hits       *hits;
    const Rays       *rays;   /* from the eye */
    int               hidden; /* as in RayEntities */
} RadarRays;

/* Total of a sample = sum of power over the bounces. It takes some 350 KB of stack. */
void radar_shade(RadarReturns *out, const RadarConfig *config, const RadarRays *from, VisibilityCounters *counters);

#endif
