/* entities/catalog/model_size_private.h: whether a model has the size that it should have: as others of its kind have,
 * or as expected. */
#ifndef ENTITIES_CATALOG_MODEL_SIZE_PRIVATE_H
#define ENTITIES_CATALOG_MODEL_SIZE_PRIVATE_H

#include "entities/import/model_import.h"

/* ---- sizes of a kind -------------------------------------------------------------------------- */

/* Which lengths things have, as the catalog knows them, and what to do about a model that is far from them: a file
 * whose unit was taken wrongly is a hundred times too large or small. */

/* The range of the largest sides of things, and the names of the smallest and the largest thing. */
typedef struct SizeRange {
    double low_m, high_m; /* high_m 0: there is none of the kind */
    char   low[64], high[64];
} SizeRange;

/* Widens the range to hold a thing of that size; who: its name. */
void model_size_range_take(SizeRange *range, double size_m, const char *who);
/* The size of the built-in shape whose name stands in `name` as a word (tank.glb, my-tank_2.obj); false: none does. */
bool model_size_range_named(SizeRange *out, const char *name);
/* Largest side of a model, m. */
double model_size_largest_m(const Model *model);
/* Whether a model's largest side is beyond `slack` times the range. Then `advice` says which `scale` in the sidecar
 * would bring it there, or that none of the usual units does. */
bool model_size_is_odd(char advice[200], double largest_m, const SizeRange *range, double slack,
                       const ModelImport *import);

/* ---- an expected size ----------------------------------------------------------------------- */

/* Whether a model from a file has its expected size; if not, which axes or which unit of the file would give it. */

typedef struct ModelFit {
    bool fits;
    int axis[3]; /* for each of forward, right, up: the body axis as loaded (0 forward, 1 right, 2 up) that it should be
                  */
    double factor;      /* factor on all lengths that would fit; 0: none does */
    char   advice[400]; /* what to write into the sidecar */
} ModelFit;

/* want: the requested size, 0 where unknown. tolerance: largest factor between two lengths that agree, above 1. */
void model_fit(ModelFit *out, const Model *model, const ModelImport *import, const ModelSize *want, double tolerance);

#endif
