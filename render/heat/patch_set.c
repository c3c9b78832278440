/* render/heat/patch_set.c: see patch_set.h. */
#include "render/heat/patch_set.h"

#include <stdlib.h>

Status patch_set_create(PatchSet *out, int models)
{
    PatchSet set = {models, calloc((size_t)models + 1, sizeof *set.of), calloc((size_t)models + 1, sizeof *set.cut)};
    if (!set.of || !set.cut) {
        patch_set_destroy(&set);
        return STATUS_NO_MEMORY;
    }
    *out = set;
    return STATUS_OK;
}

void patch_set_destroy(PatchSet *set)
{
    for (int m = 0; set->of && m < set->models; m++) patches_destroy(&set->of[m]);
    free(set->of);
    free(set->cut);
    *set = (PatchSet){0};
}

Status patch_set_need(PatchSet *set, int index, const Model *model)
{
    if (index < 0 || index >= set->models || set->cut[index]) return STATUS_OK;
    const Status status = patches_create(&set->of[index], model);
    set->cut[index] = status == STATUS_OK;
    return status;
}
