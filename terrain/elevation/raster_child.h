/* terrain/elevation/raster_child.h: the process that reads a set of rasters: started, asked, and given up when it ends or
 * does not answer. */
#ifndef TERRAIN_ELEVATION_RASTER_CHILD_H
#define TERRAIN_ELEVATION_RASTER_CHILD_H

#include "terrain/elevation/raster_wire.h"

enum { raster_most_memory_mb = 4000 }; /* what the reader may take on top of its libraries */

typedef struct RasterChild RasterChild;

/* Some 50 ms. STATUS_IO, logged. */
Status raster_child_start(RasterChild **out, const char *key);
void   raster_child_stop(RasterChild *child); /* accepts NULL; no request may be under way */

/* A channel that no thread uses; waits for one. */
WireChannel *raster_child_take(RasterChild *child);
void         raster_child_give(RasterChild *child, WireChannel *channel);
/* The channel's request, answered: what the reader had to say is logged, and the reply copied. STATUS_IO: the reader has
 * ended or did nothing for too long, which is logged once and ends it for good, or a stop was asked for (work_stop_when).
 * Status of the reply itself: reply->status, one of Status. */
Status raster_child_ask(RasterChild *child, WireChannel *channel, WireReply *reply);
/* A reply cannot be what a reader sends: logged once, and the reader is ended. STATUS_BAD_VALUE. */
Status raster_child_distrust(RasterChild *child, WireChannel *channel);

/* For tests. Seconds without a sign of life after which a reader is given up; 0: as at the start, 120. Another program in the
 * place of pitviper-rasters, NULL: that again; no set may be open. */
void   raster_child_patience(double s);
void   raster_child_program(const char *path);

#endif
