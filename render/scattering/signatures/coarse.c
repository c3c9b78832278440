/* render/scattering/signatures/coarse.c: what coarse signatures are made with. */
#include "render/scattering/signatures/coarse.h"

static const double rays_per_radius = 48, curve_m = 100;
static const double mirrors_power = 0.3; /* of the frequency: amplitude by two mirrors and more */

void coarse_tubes(TubeConfig *tubes, SignatureCells *cells)
{
    tubes->rays_per_radius = rays_per_radius;
    tubes->curve_m = curve_m;
    cells->turn_rad = 0; /* as wide as cells can be */
}

void coarse_widen(Signature *signature, double frequency_hz, double for_hz)
{
    const float grows = (float)pow(for_hz / frequency_hz, mirrors_power);
    for (int i = 0; i < signature->count; i++) {
        SignatureCentre *c = &signature->centre[i];
        if (c->bounce > 1) c->scale *= grows;
        c->moment_scale = 0;
        memset(c->moment, 0, sizeof c->moment);
    }
}

void coarse_bin(ScatterAntenna *middle, const ScatterAntenna *antenna)
{
    const double side = 15 * rad_per_deg, elevation = asin(clamp(antenna->u[2], -1, 1));
    const double el = side * nearbyint(elevation / side) + 0.0, azimuth = atan2(antenna->u[1], antenna->u[0]);
    const double bins = fmax(1, 4 * nearbyint(0.5 * pi_rad * cos(el) / side)), width = 2 * pi_rad / bins;
    const double i = nearbyint(azimuth / width), az = width * (i >= 0.5 * bins ? i - bins : i) + 0.0; /* no -0 */
    *middle = (ScatterAntenna){{cos(el) * cos(az), cos(el) * sin(az), sin(el)}, INFINITY};
}

/* Adds the bins of a row, which are met by steps of a quarter of their side. */
static int add_row(ScatterAntenna bin[coarse_most_bins], int count, double elevation_rad)
{
    const double step_rad = 3 * rad_per_deg, c = cos(elevation_rad);
    for (double az = -pi_rad; az < pi_rad && count < coarse_most_bins; az += step_rad) {
        ScatterAntenna middle;
        bool           known = false;
        coarse_bin(&middle, &(ScatterAntenna){{c * cos(az), c * sin(az), sin(elevation_rad)}, INFINITY});
        for (int i = 0; i < count && !known; i++) known = memcmp(&bin[i], &middle, sizeof middle) == 0;
        if (!known) bin[count++] = middle;
    }
    return count;
}

int coarse_bins(ScatterAntenna bin[coarse_most_bins])
{
    static const double row_deg[] = {0, -15, -30, 15, -45}; /* middles; body axes: z is down */
    int                 count = 0;
    for (size_t i = 0; i < sizeof row_deg / sizeof *row_deg; i++) count = add_row(bin, count, row_deg[i] * rad_per_deg);
    return count;
}

double coarse_hz(void) { return 8e9; }
double coarse_error_db(void) { return 8; } /* the worst of what was measured, etc/reference/radar_seeker.md */
double coarse_sag_m(void) { return 0.01; }
