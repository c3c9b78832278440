/* entities/catalog/model_info.h: `pitviper model info` and `model list`: the contents of a model; the available
 * models. */
#ifndef ENTITIES_CATALOG_MODEL_INFO_H
#define ENTITIES_CATALOG_MODEL_INFO_H

#include "entities/catalog/catalog.h"

/* argv[1] is "info". 0: done; 1: the model cannot be had; 2: wrong usage. */
int model_info_command(int argc, char **argv);
/* Every built-in shape, then every row of the catalog that is not hidden by an earlier one, a line each. */
Status model_list(FILE *to, const char *catalog_path);

#endif
