/* entities/catalog/model_info.h: `pitviper model info` and `model list`: the contents of a model; the available
 * models. */
#ifndef ENTITIES_CATALOG_MODEL_INFO_H
#define ENTITIES_CATALOG_MODEL_INFO_H

#include "entities/catalog/catalog.h"
#include "entities/catalog/model_size_private.h"
#include "entities/import/model_import.h"

/* A model and what is known about it. */
typedef struct ModelInfo {
    Model       model;
    ModelImport import; /* set for a model from a file */
    bool        imported;
    ModelEdges  edges;
    bool        sized; /* a size was given; fit: whether the file has it */
    ModelFit    fit;
    bool        odd;         /* its size is that of nothing in the catalog, or not that of its name */
    char        advice[500]; /* what to do about the size */
} ModelInfo;

/* Opens a built-in model or a file. size: a built-in one is scaled to it, and a file is compared with it; 0: not given.
 * Errors are logged; an odd size is a warning. */
Status model_info_open(ModelInfo *out, const char *name, const ModelSize *size, double sag_m);
void   model_info_print(const ModelInfo *info);
void   model_info_close(ModelInfo *info);
/* `+x`: the file's axis that is forward (0) or up (1) of the model. */
const char *model_info_axis(char out[4], const ModelImport *import, int which);
/* Every built-in shape, then every row of the catalog that is not hidden by an earlier one, a line each. */
Status model_list(FILE *to, const char *catalog_path);

#endif
