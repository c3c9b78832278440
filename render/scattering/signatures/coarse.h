/* render/scattering/signatures/coarse.h: coarse signatures: cheap ones for wide bins, for while finer ones are made.
 *
 * A target shines over aspects in lobes of lambda / 2 over its size, which a wide bin cannot hold; what it can hold is
 * how much each piece of the target scatters in the mean over the bin. Of single mirrors, flat or curved, that mean
 * does not depend on the frequency: peaks grow as lobes narrow. So a coarse signature is that of a lower frequency, at
 * which the lobe of a cell of 0.1 m is about as wide as the bin, and its centres have the paths of the frequency in
 * use: lobes as narrow as they are, and of the right strength in the mean. Corners, which send back over wide angles,
 * grow with the frequency; what comes by two mirrors and more is scaled by a power of it, fitted to a tank and a truck
 * at 35 GHz.
 *
 *     bins        15 degrees, about the target's axes: its sides shine in the middle of one; of any range
 *     frequency   8 GHz, or the radar's own where that is lower
 *     centres     sums alone: no moments, which hold for a narrow bin
 *     joints      at rest: a turret that turns does not make another
 *     models      with chords 1 cm from their curves
 *     tubes       at least 48 over the radius of the target's sphere, whatever its curvature, none divided; no edges
 *
 * Error of the cross section's mean over a third of a fine bin: coarse_error_db, measured (tests/render/test_coarse.c).
 */
#ifndef RENDER_SCATTERING_SIGNATURES_COARSE_H
#define RENDER_SCATTERING_SIGNATURES_COARSE_H

#include "render/scattering/signatures/bins.h"
#include "render/scattering/signatures/signature.h"

enum { coarse_most_bins = 256 };

/* Their frequency at most. */
double coarse_hz(void);
/* The middle of the wide bin that an antenna is in. */
void coarse_bin(ScatterAntenna *middle, const ScatterAntenna *antenna);
/* Sets what coarse signatures have of their own. */
void coarse_tubes(TubeConfig *tubes, SignatureCells *cells);
/* Makes a signature of frequency_hz one for antennas of the wide bin and for_hz. */
void coarse_widen(Signature *signature, double frequency_hz, double for_hz);
/* Middles of the bins that targets near the ground are seen in, from 20 degrees below to 50 above, the likeliest first;
 * returns how many. */
int coarse_bins(ScatterAntenna bin[coarse_most_bins]);
/* Standard deviation of the cross section's mean over a third of a fine bin, against fine signatures, dB. */
double coarse_error_db(void);
/* Chord error of the models that they are made of: lobes of theirs are wide. */
double coarse_sag_m(void);

#endif
