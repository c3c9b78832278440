/* render/radar/warp.h: plates that are not quite plane: a smooth random height over a part's surface.
 *
 * A sum of waves through the node's space, of random direction and phase for each part, wave numbers about 2 pi over
 * the length: nearly normal heights. Real plates and skins depart from their drawing by a millimetre or so over half a
 * metre, which is nothing at 3 GHz, and at 94 GHz decides how bright flat faces and corners are. */
#ifndef RENDER_RADAR_WARP_H
#define RENDER_RADAR_WARP_H

#include "pitviper.h"

enum { warp_waves = 12 };

typedef struct Warp {
    double amplitude_m;                /* of each wave; 0: none */
    double k[warp_waves][3];           /* rad/m */
    double phase_rad[warp_waves];
} Warp;

/* rms_m >= 0, length_m > 0. A function of its arguments alone. */
void warp_make(Warp *out, double rms_m, double length_m, uint64_t seed, int part);
/* Height, m, its gradient, and its second derivatives, row by row, 1/m. */
void warp_at(double *height_m, double gradient[3], double bend[9], const Warp *warp, const double p[3]);

#endif
