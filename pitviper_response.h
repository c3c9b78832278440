/* pitviper_response.h: how a channel weighs the wavelengths between its edges: all alike, or by a response of one's own
 * (a file that etc/channels.csv names): straight lines between its points, nothing beyond them. */
#ifndef PITVIPER_RESPONSE_H
#define PITVIPER_RESPONSE_H

#include "pitviper.h"

enum { response_points_most = 512, response_nodes_most = 2432 };

/* Integral over wavelength of response times f: the sum of weight_m[i] f(node_m[i]). Gauss-Legendre, four nodes a piece
 * of at most 5 % of its wavelength, two of at most 0.5 %: within 1e-8 for black bodies from 180 K and 1 um on
 * (tests/render/test_planck.c). */
typedef struct SpectralResponse {
    int    points, nodes;
    double at_m[response_points_most], value[response_points_most]; /* 0 .. 1, the greatest is 1 */
    double node_m[response_nodes_most], weight_m[response_nodes_most];
} SpectralResponse;

/* columns wavelength_um (0.3 .. 30, rising) and response; failures are logged with file and line. response_close
 * accepts NULL. */
Status response_open(SpectralResponse **out, const char *path);
void   response_close(SpectralResponse *response);

/* What is seen of a spectrum; response NULL: all between the edges. */
typedef struct SpectralBand {
    double                  low_m, high_m;
    const SpectralResponse *response;
} SpectralBand;

#endif
