/* render/parts/tracer.h: the geometry of every model, ready to be traced; lives across frames. */
#ifndef RENDER_PARTS_TRACER_H
#define RENDER_PARTS_TRACER_H

#include "entities/catalog/catalog.h"

/* An Embree device and the scenes of the models. */
typedef struct Tracer Tracer;

/* isa: NULL or "" leaves the choice to Embree; else "avx512", "avx2", "sse4.2" (passed as its isa setting). */
Status tracer_create(Tracer **out, const Catalog *catalog, const char *isa);
void   tracer_destroy(Tracer *tracer);

#endif
