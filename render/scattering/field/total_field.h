/* render/scattering/field/total_field.h: all that a target scatters at one look: ray tubes, edges, and flat faces
 * in closed form, S = S_rays + S_edges + S_polygons; the last where TubeConfig.polygon_faces asks for it, else 0:
 * what sums hits and edges by itself (signature.h, ground_bounce.h) needs it to be 0.
 *
 * Edges are those between parts of metal, coated or not, that are there in the target's state of damage. A look is
 * traced once and serves many frequencies, and antennas moved a little, as field_sweep says of the list of hits. */
#ifndef RENDER_SCATTERING_FIELD_TOTAL_FIELD_H
#define RENDER_SCATTERING_FIELD_TOTAL_FIELD_H

#include "render/scattering/field/edge_field.h"
#include "render/scattering/field/polygons.h"
#include "render/scattering/field/tubes.h"

typedef struct TotalField {
    TubeHits     hits;
    EdgeSegments edges; /* up to half more than the tubes' frequency */
    Polygons     polygons;
} TotalField;

/* out: zeroed, or of an earlier call. edges: false leaves them out. Statuses as tubes_trace. */
Status total_field_trace(TotalField *out, const RadarTarget *target, const ScatterAntenna *tx, const ScatterAntenna *rx,
                         const TubeConfig *config, bool edges, Pool *pool);
/* As field_sweep. */
Status total_field_sweep(ScatterMatrix *s, int count, double first_hz, double step_hz, const TotalField *field,
                         const ScatterAntenna *tx, const ScatterAntenna *rx, Pool *pool);
void   total_field_free(TotalField *field); /* accepts zeroes */

/* ---- the part of the rays, S_rays, from a list of hits ------------------------------------------ */

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
