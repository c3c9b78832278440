/* render/scattering/field/total_field.h: all that a target scatters at one look: ray tubes, edges, and flat faces
 * in closed form, S = S_rays + S_edges + S_polygons; the last where TubeConfig.polygon_faces asks for it, else 0:
 * what sums hits and edges by itself (signature.h, ground_bounce.h) needs it to be 0.
 *
 * Edges are those between parts of metal, coated or not, that are there in the target's state of damage. A look is
 * traced once and serves many frequencies, and antennas moved a little, as field_sweep says of the list of hits. */
#ifndef RENDER_SCATTERING_FIELD_TOTAL_FIELD_H
#define RENDER_SCATTERING_FIELD_TOTAL_FIELD_H

#include "render/scattering/field/tubes.h"
#include "render/scattering/field/edge_field_private.h"

/* The frequencies first_hz + i step_hz of a sweep, i = 0 .. count - 1, and its antennas: NULL for those that the
 * field was traced with, else moved a little from them. */
typedef struct FrequencySweep {
    int                   count;
    double                first_hz, step_hz;
    const ScatterAntenna *tx, *rx;
} FrequencySweep;

/* ---- flat faces, S_polygons (polygons.c) --------------------------------------------------------- */

/* The first bounce off flat faces that are wholly seen, in closed form.
 *
 * The physical-optics integral over a flat polygon whose phase is linear is a sum over its edges. Here each of the
 * triangles of a face has its own: with the phases x = k path at its corners, and a and c those farthest apart,
 *
 *     mean of exp(-j x) = 2 j (E(a, b) - E(b, c)) / (a - c),     E(p, q) = exp(-j (p + q) / 2) sinc((p - q) / 2)
 *
 * which holds at the specular direction, along edges and in between. Paths at corners are those of spherical waves,
 * so sides that triangles share cancel; triangles are halved until a path is linear along each of their sides.
 *
 * A face counts where every ray of a grid over it and along its borders, from either antenna, meets it first. Faces
 * partly hidden or curved are left to ray tubes, and so are the later mirrors of every path: tubes go on from all
 * faces. Whole faces and not triangles, so that what tubes sum has no other borders than its real edges.
 *
 * Only on targets of few flat faces (TubeConfig.polygon_faces). A convex body of them takes no tubes at all: some
 * hundred rays in place of ten thousands, and no error. Corner reflectors take a little less time and are as near a
 * fine grid (-76 .. -83 dB of the power). Of a vehicle's two thousand faces those that are wholly seen give 13 .. 22 %
 * of the first bounce; later mirrors and hidden faces rule, so the error of a look is the same and its time no
 * less (bench precision).
 *
 * For a look and its frequencies, not for signatures: those add up what lies in cells of a few wavelengths, and a
 * face is larger than a cell. Cut into pieces that small it would be as many as the tubes that it replaces.
 *
 * Polarisation, surfaces and S are those of tubes (currents_private.h, scatter.h); edge_field_private.h adds to either
 * alike. Against the transform of a triangle and a direct integral near a plate: tests/render/test_polygons.c. Source:
 * Gordon, IEEE Trans. Antennas Propag. 23(4), 590, 1975. */
typedef struct Polygon {
    double   corner[3][3]; /* target frame, m; of a triangle */
    double   path_m[3];    /* two-way, at the corners */
    double   amplitude[8]; /* real and imaginary of hh, hv, vh, vv, m^2 */
    uint32_t triangle;     /* of the model */
} Polygon;

typedef struct Polygons {
    ScatterAntenna tx, rx;
    int            count, capacity;
    Polygon       *polygon;
    uint8_t       *whole; /* [triangle_count]: the triangle's first bounce is here and not in tubes */
    int            whole_size;
    long long      rays; /* of the test of visibility */
    bool           all;  /* nothing is left for tubes: a convex body, all of whose faces on this side are here */
} Polygons;

/* out: zeroed, or of an earlier call. config: as for tubes_trace; with uneven surfaces, last_only or keep_hidden, and
 * where an antenna is out of range or there are more faces than polygon_faces, nothing is found. The same bits for any
 * number of threads. */
Status polygons_find(Polygons *out, const RadarTarget *target, const ScatterAntenna *tx, const ScatterAntenna *rx,
                     const TubeConfig *config, Pool *pool);
/* Adds the polygons' field to S [sweep->count], a matrix a frequency. */
Status polygons_sweep(ScatterMatrix *s, const FrequencySweep *sweep, const Polygons *polygons, Pool *pool);
void   polygons_free(Polygons *polygons); /* frees and zeroes; accepts zeroes */

/* Mean of exp(-j x) over a triangle along which x is linear, from its corners. Within 1e-12. */
double complex polygon_mean(const double x[3]);

typedef struct TotalField {
    TubeHits     hits;
    EdgeSegments edges; /* up to half more than the tubes' frequency */
    Polygons     polygons;
} TotalField;

/* Traces a look. out is zeroed, or holds the result of an earlier call. edges false: edges are left out. Returns the
 * statuses of tubes_trace. */
Status total_field_trace(TotalField *out, const RadarTarget *target, const ScatterAntenna *tx, const ScatterAntenna *rx,
                         const TubeConfig *config, bool edges, Pool *pool);
/* Fills S as field_sweep does, with the edges and polygons added. */
Status total_field_sweep(ScatterMatrix *s, const FrequencySweep *sweep, const TotalField *field, Pool *pool);
void   total_field_free(TotalField *field); /* accepts zeroes */

/* ---- the part of the rays, S_rays, from a list of hits ------------------------------------------ */

/* Fills S [sweep->count], a matrix a frequency. Antennas moved by
 * 0.1 degree cost -54 dB of the largest S near. Four and more frequencies by recurrence, within 1e-9 of the
 * amplitude; the first frequency must be above 0, the step not below. The same bits for any number of threads. pool
 * may be NULL. */
Status field_sweep(ScatterMatrix *s, const FrequencySweep *sweep, const TubeHits *hits, Pool *pool);
Status field_at(ScatterMatrix *s, double frequency_hz, const TubeHits *hits, Pool *pool);

/* Cross section 4 pi |s|^2 in dB over 1 m^2; -INFINITY for 0. */
double rcs_dbsm(double complex s);

#endif
