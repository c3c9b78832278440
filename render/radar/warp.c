/* render/radar/warp.c: a smooth random height over a part's surface. */
#include "render/radar/warp.h"

void warp_make(Warp *out, double rms_m, double length_m, uint64_t seed, int part)
{
    const uint32_t stream = 95, frame = (uint32_t)part;
    out->amplitude_m = rms_m * sqrt(2.0 / warp_waves);
    for (int w = 0; w < warp_waves; w++) {
        const uint64_t at = 4 * (uint64_t)w;
        const double   z = 2 * random_uniform(seed, stream, frame, at) - 1, across = sqrt(fmax(0, 1 - z * z));
        const double   turn = 2 * pi_rad * random_uniform(seed, stream, frame, at + 1);
        const double   k = 2 * pi_rad / length_m * (0.5 + random_uniform(seed, stream, frame, at + 2));
        out->k[w][0] = k * across * cos(turn);
        out->k[w][1] = k * across * sin(turn);
        out->k[w][2] = k * z;
        out->phase_rad[w] = 2 * pi_rad * random_uniform(seed, stream, frame, at + 3);
    }
}

void warp_at(double *height_m, double gradient[3], double bend[9], const Warp *warp, const double p[3])
{
    *height_m = 0;
    memset(gradient, 0, 3 * sizeof *gradient);
    memset(bend, 0, 9 * sizeof *bend);
    for (int w = 0; w < warp_waves; w++) {
        const double *k = warp->k[w], phase = v3_dot(k, p) + warp->phase_rad[w];
        const double  c = warp->amplitude_m * cos(phase), s = warp->amplitude_m * sin(phase);
        *height_m += c;
        for (int i = 0; i < 3; i++) {
            gradient[i] -= s * k[i];
            for (int j = 0; j < 3; j++) bend[3 * i + j] -= c * k[i] * k[j];
        }
    }
}
