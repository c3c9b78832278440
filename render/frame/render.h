/* render/frame/render.h: a picture is a pure function of (world, snapshot, request). */
#ifndef RENDER_FRAME_RENDER_H
#define RENDER_FRAME_RENDER_H

#include "render/frame/picture.h"
#include "render/frame/world.h"
#include "render/light/thermal.h"

/* Number of different positions along a row (or column) of a pixel over which an edge is averaged: n^2 for the
 * rotated grid of n x n rays that edges get. The footprint of a detector must not reduce it again
 * (sensor/detector/blur.h). */
int render_places(int samples, int edge_samples);

/* An entity whose model is -1 keeps its index in the snapshot and is not drawn: no pixel, no shadow, no echo. */
Status render(Picture *out, const World *world, const Snapshot *snapshot, const RenderRequest *request,
              const Air *air, Pool *pool, Arena *arena);

#endif
