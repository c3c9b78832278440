/* render/scattering/signatures/signature.h: the field of a target from one bin of aspect, as few scattering centres
 * that serve every antenna in the bin and every frequency of a band.
 *
 * Hits and edges of a field are summed over cells: along the path as long as phases part by path_phase_rad at the
 * ends of the band, across the line of sight as wide as they part by across_phase_rad at the edge of the bin, apart
 * for each node that moves by itself, and on nodes that spin or roll as long as they part by spin_phase_rad by their
 * range rates. A cell keeps, beside the sum of its paths, their first moments across the
 * line of sight: what it scatters towards an antenna elsewhere in the bin follows to first order, so that the error
 * is 0.4 across_phase_rad^2 of a cell of random phases, where sums alone leave across_phase_rad / 6^0.5. It is of the
 * amplitudes that cancel in it: on large curved faces, more of what is left.
 *
 * Most cells hold next to nothing: the weakest, which have weak_share of all squares of amplitudes, are summed over
 * cells weak_times as wide instead, but of no more range rates.
 *
 * Numbers are as they are written to files: sums as 16 bits of the largest of a cell, moments as 8. What is made on
 * the spot goes through the same rounding, so a field has the same bits wherever it comes from. */
#ifndef RENDER_SCATTERING_SIGNATURES_SIGNATURE_H
#define RENDER_SCATTERING_SIGNATURES_SIGNATURE_H

#include "render/scattering/field/total_field.h"

typedef struct SignatureCells {
    double frequency_hz, bandwidth_hz; /* centre, and band about it */
    double turn_rad;                   /* full width of the bin */
    double path_phase_rad, across_phase_rad;
    double interval_s;     /* that centres are to stand for; 0: what spins and rolls stands still */
    double spin_phase_rad; /* of what spins as its model says, or rolls at 20 m/s, over the interval */
    double weak_share;     /* 0: all cells are of one size */
    int    weak_times;
} SignatureCells;
/* Phases of 0.2, 0.2 and 1 rad; a hundredth over cells four times as wide. */
SignatureCells signature_default_cells(double frequency_hz, double bandwidth_hz, double turn_rad, double interval_s);

/* Most that the error of those cells may be: its power over the power of their centres. */
double signature_cells_error(void);

typedef struct SignatureCentre {
    int32_t path;       /* cell along the path */
    float   path_share; /* 0 .. 1: its path is (path + path_share) path_step_m, that at which its phase turns over the
                           band */
    float    p[3];      /* target frame, m: mean of its paths' first and last points, by amplitude */
    float    half[3];   /* from there to the mean of the last points, m */
    float    scale;     /* m: s[i] scale / 32767: real and imaginary of hh, hv, vh, vv along that path */
    float    moment_scale;      /* m^2: moment[x][i] moment_scale / 127, x: right and up of the bin's middle */
    float    weight, strongest; /* m: sum of its amplitudes, and the largest */
    int16_t  s[8];
    int8_t   moment[2][8];
    uint16_t part;   /* of the model, of its strongest hit or edge */
    uint8_t  bounce; /* mirrors of the strongest hit; 0: an edge */
    uint8_t  zero;
} SignatureCentre; /* 84 octets, no gaps */

typedef struct Signature {
    ScatterAntenna tx, rx; /* of the bin's middle */
    double         frequency_hz, bandwidth_hz;
    double         path_step_m;
    double         right[3], up[3]; /* across the line of sight */
    double         tubes_same_m2,
        tubes_cross_m2; /* squares of the hits' own fields, added up: mean of HH and VV, of HV and VH */
    int              count;
    SignatureCentre *centre; /* in the order in which hits, then edges meet their cells */
} Signature;

/* out: zeroed. target: whose field it is, as posed; NULL: all parts move as one. */
Status signature_make(Signature *out, const TotalField *field, const RadarTarget *target, const SignatureCells *cells);
void   signature_free(Signature *signature); /* frees and zeroes; accepts zeroes */
/* Fills what follows from the antennas and the cells. */
void signature_axes(Signature *out, const SignatureCells *cells);
/* Whether all numbers are finite and within what signature_make gives; parts: of the model. */
bool signature_is_sound(const Signature *signature, int parts);

#endif
