/* sensor/detector/subpixel_private.h: small targets through the optics and the detector footprint at their subpixel
 * positions.
 *
 * A pixel of the image contains a target's light, but not its position within the pixel, so that a later blur cannot
 * use it: a target of 0.44 px would be placed at the centre of a pixel, whatever the optics (centroid wrong by 0.17
 * px rms). So small targets come with their cells (SmallTarget), and each adds the correction of the path through the
 * plane - whole pixels, then blur.h:
 *
 *     electrons of the cells, less those of what they hide, onto nodes of 1/8 px; to both neighbours by distance, which
 *     keeps the centroid
 *     a node's electrons x (continuous point spread from the node to each pixel's centre, less what the plane makes of
 *     them)
 *
 * The difference of the two decays within a few pixels, tails and all, so that 17 x 17 pixels about a node are
 * enough; the continuous one has the optics, the true detector footprint, smear and jitter with all frequencies to 4
 * cycles a pixel, and so aliases as the samples of a real detector do. Cells and their background are converted to
 * electrons separately: a hot target of a hundredth of a pixel is converted at its own temperature, not as a
 * slightly warmer pixel.
 *
 * Against an ideal sampled sensor, 0.1 .. 4 px, every preset: tests/sensor/test_centroid.c. Light from beyond the
 * image's edge is not included; the point spread is mirrored there, as in blur.h. */
#ifndef SENSOR_DETECTOR_SUBPIXEL_PRIVATE_H
#define SENSOR_DETECTOR_SUBPIXEL_PRIVATE_H

#include "render/frame/render.h"
#include "sensor/detector/blur_private.h"
#include "sensor/detector/photons.h"

typedef struct SubPixel SubPixel;

/* chain: as the plane's blur has it; its smear is not used, since it changes per frame. STATUS_NO_MEMORY. One user
 * at a time. */
Status subpixel_create(SubPixel **out, const MtfChain *chain);
void   subpixel_destroy(SubPixel *s);

/* A plane of the image, and how its radiance becomes electrons. */
typedef struct SubPixelPlane {
    float             *electrons; /* [height][width] */
    double            *more;      /* filled: what is to be added after the blur */
    int                width, height;
    int                plane; /* of the targets' cells */
    const PhotonTable *photons;
    double             exposure; /* factor of the electrons */
} SubPixelPlane;

/* Sets the electrons of pixels with small targets, from their background and their cells, and all of `more`. 0.7 ms
 * where smear has changed, then 0.15 ms per target of less than a pixel, 2 ms for one of 16 x 16. No allocation. */
void subpixel_targets(SubPixel *s, const SubPixelPlane *p, const SmallTargets *targets, const double smear_px[2]);

#endif
