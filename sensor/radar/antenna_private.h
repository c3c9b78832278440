/* sensor/radar/antenna_private.h: pattern of a seeker's dish: sum beam, and the two difference beams of monopulse.
 *
 * Circular aperture of diameter d, illuminated (1 - r^2)^taper in amplitude, r over its radius; the difference
 * beams' illumination is that times x or y, so that all patterns have closed forms (Skolnik, Introduction to Radar
 * Systems, 3rd ed., 9.2, for the sum; the differences are its derivatives):
 *
 *     sum         L(taper + 1, u)                                      L(m, u) = 2^m m! J_m(u) / u^m,  L(m, 0) = 1
 *     difference  u_x sqrt(taper + 1) / (taper + 2) L(taper + 2, u)    u = k d / 2 sin(angle), u_x its part along x
 *
 * each for the same power over the aperture, so that noise is the same in all three channels. The true differences
 * are 90 degrees behind the sum; here they are turned back, so that the ratio difference / sum of one target is
 * real, of the sign of its angle. No feed's shadow, surface error or cross-polarised lobes. */
#ifndef SENSOR_RADAR_ANTENNA_PRIVATE_H
#define SENSOR_RADAR_ANTENNA_PRIVATE_H

#include "pitviper.h"

typedef struct Antenna {
    double diameter_m;
    int    taper; /* 0: uniform, 1, 2 */
    double wavelength_m;
} Antenna;

typedef struct AntennaGain {
    double sum, right, down; /* amplitude (voltage) gains over an isotropic antenna, one way; right, down: signed */
} AntennaGain;

/* u of the patterns for a direction whose sine off the axis is 1: pi diameter / wavelength. */
double antenna_u_per_sine(const Antenna *antenna);
/* Gains in a direction, given by its cosines along the antenna's right and down axes. Behind the antenna they are 0. */
AntennaGain antenna_gain(const Antenna *antenna, double cos_right, double cos_down);
/* Power gain on the axis: efficiency (2 taper + 1) / (taper + 1)^2 times (pi d / wavelength)^2. */
double antenna_peak_gain(const Antenna *antenna);
/* Full width between half-power directions, one way, rad; within 1e-9. */
double antenna_width_rad(const Antenna *antenna);
/* Both ways: between directions where the product of both ways' gains is half of its peak. To 1e-9. */
double antenna_two_way_width_rad(const Antenna *antenna);
/* Direction cosines of one target from the ratios of the differences to the sum, where it is within the first zero
 * of the sum: the result's length is at most that zero's. */
void antenna_direction(double *cos_right, double *cos_down, const Antenna *antenna, double right, double down);

#endif
