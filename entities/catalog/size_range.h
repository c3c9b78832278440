/* entities/catalog/size_range.h: which lengths things have, as the catalog knows them, and what to do about a model
 * that is far from them: a file whose unit was taken wrongly is a hundred times too large or small. */
#ifndef ENTITIES_CATALOG_SIZE_RANGE_H
#define ENTITIES_CATALOG_SIZE_RANGE_H

#include "entities/import/model_import.h"

/* Of the largest side of each thing: the least and the most, and who they are. */
typedef struct SizeRange {
    double low_m, high_m; /* high_m 0: there is none of the kind */
    char low[64], high[64];
} SizeRange;

/* Makes it hold a thing of that size; who: its name. */
void size_range_take(SizeRange *range, double size_m, const char *who);
/* Of the built-in shape that a name has in it as a word (tank.glb, my-tank_2.obj); false: it has none. */
bool size_range_named(SizeRange *out, const char *name);
/* Largest side of a model, m. */
double size_of_model(const Model *model);
/* False where a model's largest side is beyond `slack` times the range. Else `advice`: the sidecar's `scale` that would
 * bring it there, or that none of the usual units does. */
bool size_is_odd(char advice[200], double largest_m, const SizeRange *range, double slack, const ModelImport *import);

#endif
