/* render/light/hemisphere_private.h: paths over the hemisphere of a hit, shared by hemisphere.c (their light) and
 * hemisphere_change.c (its change by what is near). */
#ifndef RENDER_LIGHT_HEMISPHERE_PRIVATE_H
#define RENDER_LIGHT_HEMISPHERE_PRIVATE_H

#include "render/light/hemisphere.h"

enum {
    stream_first = 40,
    stream_next = 41,
    stream_change = 42,
    stream_side = 43
}; /* streams of random numbers, used
    * by these files only */

static const double golden_ratio = 0.61803398874989485, leave_offset_m = 1e-3; /* the latter as visibility_shadow's */

typedef struct Paths {
    Rays  rays;
    Hits  hits;
    int   of_hit[hits_capacity], of_sample[hits_capacity];
    int   of_path[hits_capacity];               /* its index among those that started together */
    float share[AIR_BAND_COUNT][hits_capacity]; /* share of the radiance met next that reaches the hit */
    float texture[hits_capacity], warmth_k[hits_capacity], temp_k[hits_capacity];
    float sun[hits_capacity];         /* share of the direct sun that arrives */
    bool  from_ground[hits_capacity]; /* hemisphere_change: the ground's own light is kept unchanged */
} Paths;

/* Two directions at right angles to n and to each other. */
void hemisphere_axes_across(double t[3], double b[3], const double n[3]);

/* Origins of the rays that leave a hit. */
typedef struct Base {
    double n_enu[3], n_geo[3], t_enu[3], b_enu[3], o_enu[3];
} Base;
void hemisphere_base_at(Base *out, const Hits *hits, int from);

/* Adds a cosine-distributed ray about the normal: u in [0, 1), turn: cosine and sine. Returns its index. */
int hemisphere_leave_base(Rays *rays, const Base *base, double u, const double turn[2]);
/* Adds a ray that leaves hit `from` of hits, of a leaf from its far side; u, v in [0, 1). */
int hemisphere_leave(Rays *rays, const Hits *hits, int from, bool far, double u, double v);

/* Shadows and temperatures of what all paths of a block met. shadows: false where nothing asks whether the sun shines
 * there. */
void hemisphere_light_met(Paths *p, const HemisphereScene *scene, unsigned bands, bool shadows,
                          VisibilityCounters *counters);
/* Radiance of level, open ground. */
double hemisphere_ground_radiance(const HemisphereScene *scene, AirBand band);
/* Radiance that path i carries from its hit, in one band; *rho: the share of that hit's own surroundings still to be
 * added. */
double hemisphere_met(double *rho, const Paths *p, int i, const HemisphereScene *scene, AirBand band, double ground,
                      bool last);

#endif
