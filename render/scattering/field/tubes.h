/* render/scattering/field/tubes.h: ray tubes: shooting and bouncing rays with physical optics, as a list of hits.
 *
 * A grid of tubes is shot from the transmitter over what it can see of the target; each facet that a tube meets,
 * after up to `bounces` mirrors, radiates physical-optics currents to the receiver if nothing is in between. The list
 * holds what frequency does not change, so total_field.h makes the field at many frequencies, and at small changes of
 * aspect, from one list.
 *
 * Tubes carry ray differentials: their cross-section, its spreading (from the range, and from curved mirrors by the
 * vertex normals), caustics, and the slope of the phase over the footprint. Points and paths are double. The grid is
 * turned and shifted by a hash of the look, so no edge is ever along it. The same target, look and config give the
 * same bits, for any number of threads.
 *
 * Tubes whose neighbours met something else are divided (tubes_split.c): the list then holds smaller ones from that
 * mirror on. Two grids of a tank at 10 GHz differ by -34 dB of its power, by -25 with splits 0 (test_tubes_split.c).
 *
 * Left out: diffraction at edges (edge_field_private.h), creeping waves, what passes through thin materials; currents
 * on the side that is turned away from the receiver, so forward scatter (bistatic angles beyond some 120 degrees) is
 * not computed.
 *
 * Source: Ling, Chou & Lee, IEEE Trans. Antennas Propag. 37(2), 194, 1989; ray differentials: Igehy, SIGGRAPH 1999. */
#ifndef RENDER_SCATTERING_FIELD_TUBES_H
#define RENDER_SCATTERING_FIELD_TUBES_H

#include "render/scattering/field/radar_target_private.h"

enum { tubes_splits_most = 5, polygon_faces_few = 64 };

typedef struct TubeConfig {
    double frequency_hz; /* sets materials and spacing: the highest, or the centre, of the frequencies to be computed */
    double rays_per_wavelength; /* 1.25: a sphere of ka 800 is within 0.1 dB; with 1 within 0.15 */
    double rays_per_radius;     /* at least this many over the radius of the target's sphere: edges are cut in steps
                                 * of a tube, whose error is that of its share of the target; 128 */
    double curve_m;             /* smallest radius of curvature to resolve, spacing <= sqrt(lambda curve / 16), though
                                 * not below lambda / 8; 0: the target's own */
    int      splits;            /* how often a tube is divided in four where it and its neighbours part: 0 .. 5; 2 */
    double   cuts_per_radius;   /* tubes of less than that sphere's radius over this are not divided; 768 */
    double   split_rad;         /* least phase by which they part, > 0; 0.5 */
    int      bounces;           /* 8 */
    bool     last_only;         /* only the last mirror of a path radiates: the handbook's corner reflectors */
    bool     keep_hidden;       /* bistatic: receivers behind a part see it all the same; for tests */
    double   warp_m, warp_length_m; /* surfaces uneven by this height, rms, over this length (Warp); 0, 0.5 */
    uint64_t warp_seed;
    uint64_t seed;          /* of the grid */
    int      polygon_faces; /* total_field_trace sums flat faces in closed form (polygons.c) on targets of at
                             * most so many of them; 0: on none, as for signatures; polygon_faces_few */
} TubeConfig;

TubeConfig tubes_default_config(double frequency_hz);

/* The hits of a look. Their field is S = -(j k / 2 pi) sum of amplitude sinc(k slope_0) sinc(k slope_1) exp(-j k path).
 */
typedef struct TubeHits {
    ScatterAntenna tx, rx;
    double         frequency_hz, spacing_m;
    long long      rays;               /* that were shot, also for divided tubes and at the tiles' borders */
    size_t         count, capacity;    /* behind the last hit there is one more of no amplitude */
    double        *path_m;             /* two-way, less that over the phase centre; see scatter.h */
    float         *slope_m[2];         /* half the change of path over the footprint's sides */
    float         *amplitude[8];       /* real and imaginary of hh, hv, vh, vv, m^2 */
    float         *first[3], *last[3]; /* points of the path, target frame */
    uint8_t       *bounce;             /* 1: the first */
    uint16_t      *part;               /* of the model, at the last point */
} TubeHits;

/* out: zeroed, or of an earlier call, whose memory is used again. rx may be tx. STATUS_BAD_VALUE, logged: an antenna
 * within the target, or a number that is not finite; STATUS_UNSUPPORTED, logged: more than 2^28 rays or 2^26 hits. */
Status tubes_trace(TubeHits *out, const RadarTarget *target, const ScatterAntenna *tx, const ScatterAntenna *rx,
                   const TubeConfig *config, Pool *pool);
/* What is left to tubes where flat faces are summed whole. */
typedef struct TubeRest {
    const uint8_t *whole; /* [triangle_count]: the first mirror does not radiate there, tubes go on; NULL: nowhere */
    bool           none;  /* no tube is shot at all */
} TubeRest;
Status tubes_trace_rest(TubeHits *out, const RadarTarget *target, const ScatterAntenna *tx, const ScatterAntenna *rx,
                        const TubeConfig *config, const TubeRest *rest, Pool *pool);
void   tubes_free(TubeHits *hits);

/* ---- uneven surfaces ---------------------------------------------------------------------------- */

/* Plates that are not quite plane: a smooth random height over a part's surface.
 *
 * A sum of waves through the node's space, of random direction and phase for each part, wave numbers about 2 pi over
 * the length: nearly normal heights. Real plates and skins depart from their drawing by a millimetre or so over half a
 * metre, which is nothing at 3 GHz, and at 94 GHz decides how bright flat faces and corners are. */
enum { warp_waves = 12 };

typedef struct Warp {
    double amplitude_m;      /* of each wave; 0: none */
    double k[warp_waves][3]; /* rad/m */
    double phase_rad[warp_waves];
} Warp;

/* Makes an unevenness. rms_m >= 0, length_m > 0. The result depends on the arguments alone. */
void tubes_warp_make(Warp *out, double rms_m, double length_m, uint64_t seed, int part);
/* Gives the height of an unevenness, m, its gradient, and its second derivatives row by row, 1/m. */
void tubes_warp_at(double *height_m, double gradient[3], double bend[9], const Warp *warp, const double p[3]);

#endif
