/* render/radar/centres.h: a target's hits and edges, summed over cells into few scattering centres for one coherent
 * interval.
 *
 * Cells are boxes over the path and the two directions across the line of sight. Within a cell phases are added at
 * the centre of the band and of the interval; between those and the band's or the interval's ends they part by at
 * most phase_rad each, so that a profile or a map made from the centres is that of the field to about phase_rad /
 * sqrt(6) of a cell's amplitude (tests/render/test_centres.c). Centres are in the order in which hits, then edges
 * meet their cells: the same bits for the same field. */
#ifndef RENDER_RADAR_CENTRES_H
#define RENDER_RADAR_CENTRES_H

#include "render/radar/total_field.h"

typedef struct ScatterCentre {
    double        path_m;     /* two-way, of its cell: S exp(-j k path) is its share of the field */
    double        p[3];       /* target frame, m: mean of its paths' first and last points, by amplitude */
    ScatterMatrix s;          /* m, at the centre frequency */
    double        weight;     /* sum of its amplitudes, m */
    int           bounce;     /* mirrors of its strongest hit; 0: an edge */
    int           part;       /* of the model, of its strongest hit or edge */
    double        strongest;  /* amplitude of that, m */
} ScatterCentre;

typedef struct CentresConfig {
    double frequency_hz;      /* centre */
    double bandwidth_hz;      /* of the band about it */
    double turn_rad;          /* how much the line of sight turns over the interval */
    double phase_rad;         /* that a cell may span from its middle, 0.1 */
    const double *part_turn_rad; /* how much each part of the model turns besides, over the interval: wheels, rotors; NULL: none
                                  * does. What turns has cells of its own, as fine as that needs */
} CentresConfig;

typedef struct Centres {
    int            count, capacity;
    ScatterCentre *centre;
    int32_t       *slot;      /* of a hash table, a power of two long */
    int            slots;
    double         tubes_same_m2, tubes_cross_m2; /* squares of the hits' own fields, added up: mean of HH and VV, of HV and VH */
} Centres;

/* out: zeroed, or of an earlier call, whose memory is used again. tx, rx: the antennas now, NULL: those of the
 * field. */
Status centres_make(Centres *out, const TotalField *field, const ScatterAntenna *tx, const ScatterAntenna *rx,
                    const CentresConfig *config);
void   centres_free(Centres *centres);

#endif
