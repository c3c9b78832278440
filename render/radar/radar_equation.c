/* render/radar/radar_equation.c: the radar equation as power and as voltage. */
#include "render/radar/radar_equation.h"

static bool valid(const RadarLink *l)
{
    return l->transmitted_w > 0 && l->transmit_gain > 0 && l->receive_gain > 0 && l->wavelength_m > 0 &&
           l->range_m > 0 && l->loss >= 1;
}

double radar_received_w(const RadarLink *link, double rcs_m2)
{
    const double four_pi = 4 * pi_rad, w_m = link->wavelength_m, r2 = link->range_m * link->range_m;
    if (!valid(link) || !(rcs_m2 >= 0)) return NAN;
    return link->transmitted_w * link->transmit_gain * link->receive_gain * w_m * w_m * rcs_m2 /
           (four_pi * four_pi * four_pi * r2 * r2 * link->loss);
}

double complex radar_voltage(const RadarLink *link, double complex scattering_m, double complex path)
{
    if (!valid(link)) return CMPLX(NAN, NAN);
    const double waves = 2 * link->range_m / link->wavelength_m;
    const double phase = -2 * pi_rad * (waves - floor(waves)); /* whole waves first: R is a million of them */
    const double size = sqrt(link->transmitted_w * link->transmit_gain * link->receive_gain / link->loss) *
                        link->wavelength_m / (4 * pi_rad * link->range_m * link->range_m);
    return size * CMPLX(cos(phase), sin(phase)) * scattering_m * path;
}

double radar_noise_w(double bandwidth_hz, double noise_factor)
{
    static const double boltzmann_j_k = 1.380649e-23;
    if (!(bandwidth_hz > 0 && noise_factor >= 1)) return NAN;
    return boltzmann_j_k * 290 * bandwidth_hz * noise_factor;
}
