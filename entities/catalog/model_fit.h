/* entities/catalog/model_fit.h: whether a model from a file has its expected size; if not, which axes or
 * which unit of the file would give it. */
#ifndef ENTITIES_CATALOG_MODEL_FIT_H
#define ENTITIES_CATALOG_MODEL_FIT_H

#include "entities/import/model_import.h"

typedef struct ModelFit {
    bool   fits;
    int    axis[3];     /* body axis as loaded (0 forward, 1 right, 2 up) that would have to be forward, right, up */
    double factor;      /* on all lengths, 0: none explains it */
    char   advice[320]; /* what to write into the sidecar */
} ModelFit;

/* want: the requested size, 0 where unknown. tolerance: largest factor between two lengths that agree, above 1. */
void model_fit(ModelFit *out, const Model *model, const ModelImport *import, const ModelSize *want, double tolerance);

#endif
