/* render/radar/field.h: a target's scattered field from its list of hits.
 *
 * What this gives is the part of the rays, S_rays; whole: S_rays + S_edges. */
#ifndef RENDER_RADAR_FIELD_H
#define RENDER_RADAR_FIELD_H

#include "render/radar/tubes.h"

/* S [count] at frequencies first_hz + i step_hz. tx, rx NULL: the list's own antennas; else moved a little from them:
 * 0.1 degree costs -54 dB of the largest S near. Four and more frequencies by recurrence, within 1e-9 of the
 * amplitude; the first frequency must be above 0, the step not below. The same bits for any number of threads. pool
 * may be NULL. */
Status field_sweep(ScatterMatrix *s, int count, double first_hz, double step_hz, const TubeHits *hits,
                   const ScatterAntenna *tx, const ScatterAntenna *rx, Pool *pool);
Status field_at(ScatterMatrix *s, double frequency_hz, const TubeHits *hits, Pool *pool);

/* 4 pi |s|^2 in dB over 1 m^2; -INFINITY for 0. */
double rcs_dbsm(double complex s);

#endif
