/* entities/catalog/model_info.h: `pitviper model info` and `model list`: the contents of a model; the available
 * models. */
#ifndef ENTITIES_CATALOG_MODEL_INFO_H
#define ENTITIES_CATALOG_MODEL_INFO_H

#include "entities/catalog/catalog.h"

/* Prints what a built-in model or a file holds; size: of a file it is compared with, 0: not given. Exit code: 0, or 1
 * when the model cannot be had, which is logged. */
int model_info(const char *name, const ModelSize *size, double sag_m);
/* Every built-in shape, then every row of the catalog that is not hidden by an earlier one, a line each. */
Status model_list(FILE *to, const char *catalog_path);

#endif
