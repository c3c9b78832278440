/* render/radar/total_field.h: all that a target scatters at one look: ray tubes, edges, and flat faces in closed form,
 * S = S_rays + S_edges + S_polygons; the last where TubeConfig.polygon_faces asks for it, else 0: what sums
 * hits and edges by itself (signature.h, ground_bounce.h) needs it to be 0.
 *
 * Edges are those between parts of metal, coated or not, that are there in the target's state of damage. A look is
 * traced once and serves many frequencies, and antennas moved a little, as field.h says of the list of hits. */
#ifndef RENDER_RADAR_TOTAL_FIELD_H
#define RENDER_RADAR_TOTAL_FIELD_H

#include "render/radar/edges.h"
#include "render/radar/field.h"
#include "render/radar/polygons.h"

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

#endif
