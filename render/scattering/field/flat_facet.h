/* render/scattering/field/flat_facet.h: what a square metre of a flat surface radiates by physical optics, for surfaces
 * that are too many and too large for ray tubes: walls and roofs. */
#ifndef RENDER_SCATTERING_FIELD_FLAT_FACET_H
#define RENDER_SCATTERING_FIELD_FLAT_FACET_H

#include "render/scattering/radar_surfaces.h"
#include "render/scattering/scatter.h"

/* Field over the area of a facet of one phase, m / m^2: times its area, and times the mean of exp(-j k path) over it,
 * that is its part of S (scatter.h). Of backscatter from metal at the normal j k / 2 pi in magnitude. n        unit
 * normal, on the side of the transmitter tx, rx   seen from the facet: their directions alone count 0 where either is
 * behind the facet. Source: Stratton and Chu's integral with Fresnel's currents (currents_private.h), as of ray tubes
 * and polygons. */
void flat_facet_field(ScatterMatrix *per_m2, const RadarSurface *surface, double k, const double n[3],
                      const ScatterAntenna *tx, const ScatterAntenna *rx);

#endif
