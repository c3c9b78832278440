/* sensor/detector/subpixel.h: small targets through the optics and the footprint from where they lie within a pixel.
 *
 * A picture's pixel holds a target's light, but not where in the pixel it lies, and no blur afterwards knows: a target
 * of 0.44 px would be placed at the centre of a pixel, whatever the optics (centroid wrong by 0.17 px rms). So small
 * targets come with their cells (SmallTarget), and each adds what the plane's own way - whole pixels, then blur.h -
 * gets wrong:
 *
 *     electrons of the cells, less those of what they hide, onto nodes of 1/8 px; to both neighbours by distance, which
 *     keeps the centroid
 *     a node's electrons x (continuous point spread from the node to each pixel's centre, less what the plane makes of
 *     them)
 *
 * The difference of the two dies away within a few pixels, tails and all, so that 17 x 17 pixels about a node are
 * enough; the continuous one has the optics, the true footprint, smear and jitter with all frequencies to 4 cycles a
 * pixel, and so aliases as the samples of a real detector do. What cells and what is behind them give is turned into
 * electrons each by itself: a hot target of a hundredth of a pixel is counted as hot, not as a pixel that is a little
 * warmer.
 *
 * Against an ideal sampled sensor, 0.1 .. 4 px, every preset: tests/sensor/test_centroid.c. What lies beyond the
 * picture's edge gives nothing; the point spread is mirrored there, as in blur.h. */
#ifndef SENSOR_DETECTOR_SUBPIXEL_H
#define SENSOR_DETECTOR_SUBPIXEL_H

#include "render/frame/render.h"
#include "sensor/detector/mtf.h"
#include "sensor/detector/photons.h"

typedef struct SubPixel SubPixel;

/* chain: as the plane's blur has it; its smear is left out, it changes by frame. STATUS_NO_MEMORY. One user at a
 * time. */
Status subpixel_create(SubPixel **out, const MtfChain *chain);
void   subpixel_destroy(SubPixel *s);

/* Electrons of a plane [height][width], of pixels with small targets in them, made from what is behind them and their
 * cells; what the blur must add afterwards goes into more, which is set. exposure: factor of the electrons. 0.7 ms
 * where smear has changed, then 0.15 ms a target of less than a pixel, 2 ms one of 16 x 16. No allocation. */
void subpixel_targets(SubPixel *s, float *electrons, double *more, int width, int height, const SmallTargets *targets,
                      int plane, const PhotonTable *photons, double exposure, const double smear_px[2]);

#endif
