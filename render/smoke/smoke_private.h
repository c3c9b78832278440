/* render/smoke/smoke_private.h: where rays cross the spheroids of smoke. */
#ifndef RENDER_SMOKE_SMOKE_PRIVATE_H
#define RENDER_SMOKE_SMOKE_PRIVATE_H

#include "render/smoke/smoke.h"

/* A ray inside a volume, in whose axes it is a unit ball. */
typedef struct Chord {
    double middle_m, half_m; /* parameter of closest approach to the centre, half the chord inside */
    double rate2;            /* |d|^2 in the ball's units: density is (rate2 (half^2 - u^2))^2 */
} Chord;

/* Column between two distances along the ray, of unit peak density, m. */
double smoke_chord_column(const Chord *chord, bool even, double from_m, double to_m);

typedef struct Crossing {
    const SmokeVolume *volume;
    Chord              chord;
    double             from_m, to_m, factor; /* factor: of the noise pattern, on the whole column */
    double             source[smoke_bands];
} Crossing;

/* What of a volume no ray changes: scale of its axes to a ball's, and directions in the ball's units. */
typedef struct SmokeBall {
    double across_per_m, more_per_m; /* along the axis: by so much more */
    double sun[3], up[3], up_length;
} SmokeBall;

enum { smoke_set_most = 512 };

/* Volumes prepared for several rays. The places of a ray that may cross them are found four at a time. */
typedef struct SmokeSet {
    int                count;
    const SmokeVolume *volume[smoke_set_most];
    SmokeBall          ball[smoke_set_most];
    double p_enu[3][smoke_set_most], reach2_m2[smoke_set_most]; /* of a ball about it, squared, and a margin */
} SmokeSet;

void smoke_set_fill(SmokeSet *set, const SmokeVolume *volume, const int *list, int count);
/* Places in the set of the volumes whose balls a ray meets, in order. */
int smoke_set_near(int near[smoke_set_most], const SmokeSet *set, const double o_enu[3], const double d_enu[3]);

/* A ray through up to four volumes: near[0 .. count - 1] of the set. Adds those that it crosses before far_m, in order,
 * with their sources; returns how many. */
typedef struct SmokeRay {
    const double *o_enu, *d_enu;
    double        far_m;
    unsigned      bands;
} SmokeRay;
int smoke_cross(Crossing out[4], const SmokeSet *set, const int *near, int count, const SmokeRay *ray);

#endif
