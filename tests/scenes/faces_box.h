/* tests/scenes/faces_box.h: a painted box of 4 x 2 x 1.5 m over flat, diffuse ground under the sun and the sky of an
 * atmosphere, without air before the eye: what other renderers see the same. */
#ifndef TESTS_SCENES_FACES_BOX_H
#define TESTS_SCENES_FACES_BOX_H

#include "tests/scenes/stress_world.h"

enum { faces_width = 160, faces_height = 108, faces_channels = 4 };

static const AirBand faces_channel[faces_channels] = {AIR_R, AIR_G, AIR_B, AIR_NIR};

typedef struct FacesKind {
    const char *model; /* of the atmosphere */
    double      visibility_m, sun_rad, lift_m;
    const char *ground; /* a material */
    bool        glossy; /* else the paint is diffuse */
} FacesKind;

typedef struct FacesBox {
    StressWorld w;
    Daylight    light;
    View        view[2]; /* from the sun's side and from the other */
    double      lift_m, heading, ground_m;
    double      ground_rho[faces_channels], box_rho[faces_channels], box_gloss[2]; /* share and roughness */
} FacesBox;

/* out must stay where it is. Also after a failure it is to be closed. */
Status faces_box_open(FacesBox *out, const FacesKind *kind, int threads);
void   faces_box_close(FacesBox *box);
/* Into w.picture, red, green, blue or the infrared channel; samples: of the hemisphere; 0: contact shadows. */
bool faces_box_see(FacesBox *box, int view, bool infrared, int samples);

#endif
