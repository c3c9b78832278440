/* render/air/droplets_private.h: the optics of drops by wavelength. */
#ifndef RENDER_AIR_DROPLETS_PRIVATE_H
#define RENDER_AIR_DROPLETS_PRIVATE_H

#include "render/air/droplets.h"

typedef enum DropletKind { droplet_radiation, droplet_advection, droplet_rain, droplet_kinds } DropletKind;

/* extinction: over that at 0.55 um; albedo: the share of it that is scattered; asymmetry: the mean cosine of the
 * scattering angle. */
typedef struct DropletRow {
    double wavelength_m, extinction, albedo, asymmetry;
} DropletRow;

enum { droplet_rows = 38 };
extern const DropletRow droplet_table[droplet_kinds][droplet_rows]; /* rising wavelengths */

/* The mean over a band, weighted by its response, or all wavelengths between its edges alike; straight between the
 * rows, the end's beyond. */
DropletRow droplet_optics(DropletKind kind, AirBand band);

#endif
