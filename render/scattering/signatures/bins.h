/* render/scattering/signatures/bins.h: what a signature is for: bins of aspect and range of its antennas.
 *
 * Bins are aspect_rad wide in elevation and about as wide across, and a factor of 2^(1/4) in range. */
#ifndef RENDER_SCATTERING_SIGNATURES_BINS_H
#define RENDER_SCATTERING_SIGNATURES_BINS_H

#include "render/scattering/paths/ground_bounce.h"

/* What a signature is for: antennas in the target's frame. */
typedef struct SignatureLook {
    ScatterAntenna tx, rx;
    bool           image[2]; /* whether transmitter, receiver is an image in the ground (ground_bounce.h) */
    GroundPlane    plane;    /* where one is. Kept for a degree of its normal and 2 cm of its height */
} SignatureLook;

/* The look of a transmitter and receiver at one place, with nothing by way of the ground. */
SignatureLook signature_look(const ScatterAntenna *antenna);
/* The middle of the bin that an antenna is in. */
void signature_bin(ScatterAntenna *middle, const ScatterAntenna *antenna, double aspect_rad);
/* The middles of a look's bins; what does not count for it is zero. */
void signature_look_bin(SignatureLook *middle, const SignatureLook *look, double aspect_rad);

#endif
