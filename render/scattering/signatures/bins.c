/* render/scattering/signatures/bins.c: the middles of bins. */
#include "render/scattering/signatures/bins.h"

void signature_bin(ScatterAntenna *middle, const ScatterAntenna *antenna, double aspect_rad)
{
    const double elevation = asin(clamp(antenna->u[2], -1, 1)), azimuth = atan2(antenna->u[1], antenna->u[0]);
    const double el = clamp(aspect_rad * (floor(elevation / aspect_rad) + 0.5), -0.5 * pi_rad, 0.5 * pi_rad);
    const double bins = fmax(1, nearbyint(2 * pi_rad * cos(el) / aspect_rad)), width = 2 * pi_rad / bins;
    const double az = width * (fmin(floor((azimuth + pi_rad) / width), bins - 1) + 0.5) - pi_rad;
    middle->u[0] = cos(el) * cos(az);
    middle->u[1] = cos(el) * sin(az);
    middle->u[2] = sin(el);
    middle->range_m = isinf(antenna->range_m) ? INFINITY : exp2(nearbyint(4 * log2(antenna->range_m)) / 4);
}

static const double plane_rad = 1 * rad_per_deg, plane_m = 0.02;

void signature_look_bin(SignatureLook *middle, const SignatureLook *look, double aspect_rad)
{
    memset(middle, 0, sizeof *middle);
    signature_bin(&middle->tx, &look->tx, aspect_rad);
    signature_bin(&middle->rx, &look->rx, aspect_rad);
    if (!look->image[0] && !look->image[1]) return;
    const ScatterAntenna normal = {{look->plane.n[0], look->plane.n[1], look->plane.n[2]}, INFINITY};
    ScatterAntenna       of;
    signature_bin(&of, &normal, plane_rad);
    memcpy(middle->image, look->image, sizeof look->image);
    memcpy(middle->plane.n, of.u, sizeof of.u);
    middle->plane.height_m = plane_m * nearbyint(look->plane.height_m / plane_m);
}

SignatureLook signature_look(const ScatterAntenna *antenna) { return (SignatureLook){.tx = *antenna, .rx = *antenna}; }
