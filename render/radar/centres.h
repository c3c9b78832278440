/* render/radar/centres.h: the scattering centres of a target as its antennas see them now, from its signature
 * (signature.h): each with its path, and what it scatters along it.
 *
 * Over a coherent interval in which the line of sight turns by turn_rad, phases within a centre part by
 * across_phase_rad turn_rad / (width of the bin), and over the band by path_phase_rad (tests/render/test_centres.c). */
#ifndef RENDER_RADAR_CENTRES_H
#define RENDER_RADAR_CENTRES_H

#include "render/radar/signature.h"

typedef struct ScatterCentre {
    double        path_m;     /* two-way: S exp(-j k path) is its share of the field */
    double        p[3];       /* target frame, m: mean of its paths' first and last points, by amplitude */
    ScatterMatrix s;          /* m, at the centre frequency */
    double        weight;     /* sum of its amplitudes, m */
    int           bounce;     /* mirrors of its strongest hit; 0: an edge */
    int           part;       /* of the model, of its strongest hit or edge */
    double        strongest;  /* amplitude of that, m */
} ScatterCentre;

typedef struct Centres {
    int            count, capacity;
    ScatterCentre *centre;    /* in the order of the signature's */
    double         tubes_same_m2, tubes_cross_m2; /* Signature */
} Centres;

/* out: zeroed, or of an earlier call, whose memory is used again. tx, rx: the antennas now, in the signature's bin. pool
 * may be NULL. */
Status centres_make(Centres *out, const Signature *signature, const ScatterAntenna *tx, const ScatterAntenna *rx,
                    Pool *pool);
void   centres_free(Centres *centres);
/* Their whole field at a frequency of the band. */
void   centres_field(ScatterMatrix *out, const Centres *centres, double frequency_hz);

#endif
