/* render/scattering/signatures/coarse.c: what coarse signatures are made with. */
#include "render/scattering/signatures/coarse.h"

static const double coarse_hz = 8e9, aspect_rad = 15 * rad_per_deg, rays_per_radius = 48, curve_m = 100;
static const double mirrors_power = 0.3; /* of the frequency: amplitude by two mirrors and more */

SignaturesConfig coarse_config(const SignaturesConfig *fine)
{
    SignaturesConfig config = *fine;
    config.frequency_hz = fmin(fine->frequency_hz, coarse_hz);
    config.interval_s *= fine->frequency_hz / config.frequency_hz; /* what spins is told apart as finely */
    config.aspect_rad = aspect_rad;
    config.splits = 0;
    config.coarse_for_hz = fine->frequency_hz;
    config.most_octets = (size_t)1 << 28;
    config.store = (SignatureStore){0};
    return config;
}

void coarse_tubes(TubeConfig *tubes, SignatureCells *cells)
{
    tubes->rays_per_radius = rays_per_radius;
    tubes->curve_m = curve_m;
    cells->turn_rad = 0; /* as wide as cells can be */
}

void coarse_widen(Signature *signature, const SignaturesConfig *config)
{
    const float grows = (float)pow(config->coarse_for_hz / config->frequency_hz, mirrors_power);
    for (int i = 0; i < signature->count; i++) {
        SignatureCentre *c = &signature->centre[i];
        if (c->bounce > 1) c->scale *= grows;
        c->moment_scale = 0;
        memset(c->moment, 0, sizeof c->moment);
    }
}

/* A bin is met by steps of a quarter of its side. */
static int add_row(ScatterAntenna bin[coarse_most_bins], int count, double elevation_rad, double side_rad)
{
    for (double az = -pi_rad; az < pi_rad && count < coarse_most_bins; az += 0.25 * side_rad) {
        const double   c = cos(elevation_rad);
        ScatterAntenna middle;
        bool           known = false;
        signature_bin(&middle, &(ScatterAntenna){{c * cos(az), c * sin(az), sin(elevation_rad)}, INFINITY}, side_rad);
        for (int i = 0; i < count && !known; i++) known = memcmp(&bin[i], &middle, sizeof middle) == 0;
        if (!known) bin[count++] = middle;
    }
    return count;
}

int coarse_bins(ScatterAntenna bin[coarse_most_bins], double side_rad)
{
    static const double row[] = {-0.5, -1.5, -2.5, 0.5}; /* middles, over the side; body axes: z is down */
    int                 count = 0;
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) count = add_row(bin, count, row[i] * side_rad, side_rad);
    return count;
}

double coarse_error_db(void) { return 8; }
double coarse_sag_m(void) { return 0.01; }
