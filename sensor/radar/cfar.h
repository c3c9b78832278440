/* sensor/radar/cfar.h: detection at a constant rate of false alarms in power that noise or clutter fills.
 *
 * A cell is compared with the mean of training cells about it (cell averaging), or with the k-th smallest of them
 * (ordered statistic, which a second target among them disturbs less). In exponentially distributed power of one
 * mean the rate of false alarms is exact:
 *
 *     cell averaging   pfa = (1 + a / N)^-N                          threshold = a mean
 *     ordered          pfa = prod_{i < k} (N - i) / (N - i + a)      threshold = a (k-th smallest)
 *
 * Sources: Finn & Johnson, RCA Review 29, 1968; Rohling, IEEE Trans. AES-19(4), 1983. */
#ifndef SENSOR_RADAR_CFAR_H
#define SENSOR_RADAR_CFAR_H

#include "pitviper.h"

/* training 1 .. 100000 cells, pfa in 0 .. 1 exclusive; else NaN. Relative error 1e-12. */
double cfar_multiplier(int training, double pfa);
/* rank 1 .. training. Relative error 1e-12. */
double cfar_ordered_multiplier(int training, int rank, double pfa);
/* Probability that cell averaging detects a target whose power is exponential with mean snr times that of the noise, in
 * one look (Swerling 1). */
double cfar_detection(int training, double pfa, double snr);

typedef struct CfarConfig {
    double pfa;                        /* in a cell, above 0, below 1 */
    int    guard[2], training[2];      /* cells on each side in rows and columns: guard are left out, training beyond them counted */
    double ordered;                    /* 0: cell averaging; else the rank's share of the training cells, 0 .. 1 */
    bool   wrap_rows;                  /* rows go round: Doppler */
} CfarConfig;

typedef struct CfarHit {
    int    row, column;
    double power, floor;               /* of the cell; mean power of noise there by the training cells */
} CfarHit;

/* power[rows][columns], not below 0. The cells over their threshold that are greatest among their eight neighbours
 * (equal ones: the first), in order of row and column: at most `most`; returns how many there are, or -1: no memory
 * or a bad configuration. Cells with fewer than 4 training cells within the plane are never hits. */
int cfar_detect(CfarHit *out, int most, const CfarConfig *config, const double *power, int rows, int columns);

#endif
