/* render/trace/scenery/scenery_heights_private.h: how high what stands reaches, on a grid over the ground, which tells
 * of most rays towards the sun that they pass above all of it before anything is traced. */
#ifndef RENDER_TRACE_SCENERY_SCENERY_HEIGHTS_PRIVATE_H
#define RENDER_TRACE_SCENERY_SCENERY_HEIGHTS_PRIVATE_H

#include "render/trace/parts/parts.h"

typedef struct SceneryHeights SceneryHeights;

/* Of the objects whose model is not -1, in the arena. *out NULL: there are none, or they are too far apart. Memory:
 * 1 KiB a tile of 32 m with something in it or beside it, 8 octets one without. STATUS_NO_MEMORY. */
Status scenery_heights_create(SceneryHeights **out, const PosedEntity *posed, int objects, Arena *arena);
/* Lists the rays, ascending, that may meet something on their way in this direction without end; the others do not.
 * heights: NULL: all may. list: room for count. Not finite: may. */
int scenery_heights_below(int *list, const SceneryHeights *heights, const double *const o_enu[3], int count,
                          const double d_enu[3]);

#endif
