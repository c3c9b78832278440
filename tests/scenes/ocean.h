/* tests/scenes/ocean.h: open sea out to 420 km about any place, and the round Earth beyond it. */
#ifndef TESTS_SCENES_OCEAN_H
#define TESTS_SCENES_OCEAN_H

#include "terrain/ground/landscape.h"

static const double ocean_outline_m = 420e3; /* of the mesh, from its origin, east and north */

/* 0.3 s. out is to be destroyed. */
static inline Status ocean_create(Landscape *out, LocalFrame *frame, const Geodetic *origin)
{
    LandscapeConfig         config = landscape_default_config();
    const CoastPlace        ship = {0, 0, true};
    const LandscapeEvidence evidence = {.place_count = 1, .place = &ship};
    config.half_width_m = 500;
    const Status status = local_frame_at(frame, origin);
    return status == STATUS_OK ? landscape_create_from(out, &config, frame, &evidence) : status;
}

#endif
