/* render/heat/ground_kinds.h: what the ground of each surface class is made of (etc/ground_heat.csv). */
#ifndef RENDER_HEAT_GROUND_KINDS_H
#define RENDER_HEAT_GROUND_KINDS_H

#include "render/heat/ground_column.h"
#include "render/materials/materials.h"

/* A SurfaceClass is its own kind; ground that only heat knows follows. */
enum { ground_forest_floor = SURFACE_COUNT, ground_burnt, ground_kinds };

typedef struct GroundKinds {
    GroundKind kind[ground_kinds]; /* [SURFACE_NONE] is as bare soil */
} GroundKinds;

/* path: etc/ground_heat.csv. Every kind must have its row; failures are logged with file, line, column and range. */
Status      ground_kinds_open(GroundKinds *out, const char *path, const Materials *materials);
const char *ground_kind_name(int kind);
/* Soil and what grows on it, that tracks and wheels tear open. */
static inline bool ground_kind_loosens(int kind)
{
    return (kind >= SURFACE_GRASS && kind <= SURFACE_TRACK) || kind == SURFACE_SCRUB || kind == SURFACE_WETLAND ||
           kind == ground_forest_floor;
}
int         ground_kind_find(const char *name); /* -1: none */

#endif
