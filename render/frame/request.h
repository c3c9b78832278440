/* render/frame/request.h: the parameters of a frame. */
#ifndef RENDER_FRAME_REQUEST_H
#define RENDER_FRAME_REQUEST_H

#include "render/scene/view.h"

typedef struct RenderRequest {
    View     view;
    unsigned bands;          /* 1 << Band, the bands that have consumers */
    bool     truth;          /* id, part, material, range, normal, temperature planes and target counts */
    OpticalChannels optical;
    double   lateral[2]; /* lateral colour of R G B: magnification of R, and of B, over that of G, less 1 */
    int      sky_samples;    /* directions a hit over which light from sky and surroundings is sampled; 0: the quick
                              * form */
    bool     sky_visibility; /* with the quick form: nearby objects hide sky and ground
                              * (render/light/sky_visibility.h) */
    int      samples;        /* a side: samples^2 rays a pixel, on a rotated grid, box-averaged. 1 .. 16 */
    int      edge_samples;   /* the same where neighbours disagree, 2 .. 16; not above samples: nowhere */
    int      target_samples; /* rays a side over the whole of a target that is small on the image, 8 .. 256; 0: as
                              * all others */
    int      hidden_entity;  /* snapshot index of the entity whose parts the eye does not see (they cast shadows);
                              * -1: none */
    unsigned skips_off;      /* 1 << Skip (render/scene/skip.h): skips to disable; must give the same bits */
    bool     budget;         /* estimate the error of the planes: Picture.budget */
    bool     hand_over_cells; /* keep the samples of small targets for a detector behind optics: Picture.small */
    double   t_s;            /* exercise time: plants sway by it */
    double   low_plants_m;   /* low plants stand within this of the eye; 0: none */
    double   profile_near_m, profile_bin_m; /* radar range profile */
    int      profile_bins;
} RenderRequest;

#endif
