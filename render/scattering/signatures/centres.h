/* render/scattering/signatures/centres.h: the scattering centres of a target as its antennas see them now, from its
 * signature (signature.h): each with its path, and what it scatters along it; and how wrong their field is.
 *
 * Over a coherent interval in which the line of sight turns by turn_rad, phases within a centre part by
 * across_phase_rad turn_rad / (width of the bin), and over the band by path_phase_rad (tests/render/test_centres.c). */
#ifndef RENDER_SCATTERING_SIGNATURES_CENTRES_H
#define RENDER_SCATTERING_SIGNATURES_CENTRES_H

#include "render/scattering/signatures/signature.h"

typedef struct ScatterCentre {
    double        path_m;    /* two-way: S exp(-j k path) is its share of the field */
    double        p[3];      /* target frame, m: mean of its paths' first and last points, by amplitude */
    ScatterMatrix s;         /* m, at the centre frequency */
    double        weight;    /* sum of its amplitudes, m */
    int           bounce;    /* mirrors of its strongest hit; 0: an edge */
    int           part;      /* of the model, of its strongest hit or edge */
    double        strongest; /* amplitude of the strongest point, m */
} ScatterCentre;

typedef struct Centres {
    int            count, capacity;
    ScatterCentre *centre;                        /* in the order of the signature's */
    double         tubes_same_m2, tubes_cross_m2; /* Signature */
} Centres;

/* out: zeroed, or of an earlier call, whose memory is used again. tx, rx: the antennas now, in the signature's bin.
 * pool may be NULL. */
Status centres_make(Centres *out, const Signature *signature, const ScatterAntenna *tx, const ScatterAntenna *rx,
                    Pool *pool);
void   centres_free(Centres *centres);
/* Sums the field of all centres at a frequency of the band. */
void centres_field(ScatterMatrix *out, const Centres *centres, double frequency_hz);

/* ---- error -------------------------------------------------------------------------------------- */

/* How wrong the field of a list of hits is, by the grid of tubes that made it and the bin of aspect that it serves.
 *
 * A tube that is cut by an edge, or whose mirrors part, is wrong by a share of its own field, with a phase of its
 * own; so the squares of the tubes' fields add up to the square of the error, however the fields themselves
 * interfere. The share is measured (tank, 10 and 35 GHz); held-out models and frequencies are within a factor of
 * two of it (tests/render/test_signature_error.c). What physical optics and the model leave out is not in it. */

/* Mean square of the field's error, m2: of the co-polarised (HH or VV) and of the cross-polarised part. */
typedef struct SignatureError {
    double same_m2, cross_m2;
} SignatureError;

/* Error of the centres of a list of hits; that of a given signature is 0. */
void signature_error(SignatureError *out, const Centres *centres);
/* Standard deviation in dB of a cross section, of a field s with an error of mean square error_m2: 10 log10(1 +
 * sqrt(2 e) / |s|), which for small errors is that of a sum of vectors of random phase. NaN for s = 0. */
double signature_error_db(double complex s, double error_m2);

#endif
