/* render/frame/request.h: what is asked of a frame. */
#ifndef RENDER_FRAME_REQUEST_H
#define RENDER_FRAME_REQUEST_H

#include "render/scene/view.h"

typedef struct RenderRequest {
    View     view;
    unsigned bands;          /* 1 << Band, those somebody consumes */
    bool     truth;          /* id, part, material, range, normal, temperature planes and target counts */
    OpticalChannels optical;
    double   lateral[2]; /* lateral colour of R G B: magnification of R, and of B, over that of G, less 1 */
    int      sky_samples;    /* directions a hit in which sky and surroundings are asked for light; 0: the quick form */
    bool     sky_visibility; /* with the quick form: what stands near hides sky and ground (render/light/sky_visibility.h) */
    int      samples;        /* a side: samples^2 rays a pixel, on a turned grid, box-averaged. 1 .. 16 */
    int      edge_samples;   /* the same where neighbours disagree, 2 .. 16; not above samples: nowhere */
    int      target_samples; /* rays a side over the whole of a target that is small on the image, 8 .. 256; 0: as all */
    int      hidden_entity;  /* snapshot index whose parts the eye does not see (they cast shadows); -1: none */
    unsigned skips_off;      /* 1 << Skip (render/scene/skip.h): not left out but computed; must give the same bits */
    bool     budget;         /* estimate how wrong the planes are: Picture.budget */
    bool     hand_over_cells; /* of small targets, to a detector behind optics: Picture.small */
    double   profile_near_m, profile_bin_m; /* radar range profile */
    int      profile_bins;
} RenderRequest;

#endif
