/* render/heat/patch_set.c: see patch_set.h. */
#include "render/heat/patch_set.h"

#include <pthread.h>
#include <stdlib.h>

typedef struct PatchCut {
    pthread_t    thread;
    const Model *model;
    Patches      patches;
    Status       status;
} PatchCut;

Status patch_set_create(PatchSet *out, int models)
{
    PatchSet set = {models, calloc((size_t)models + 1, sizeof *set.of), calloc((size_t)models + 1, sizeof *set.cut),
                    calloc((size_t)models + 1, sizeof *set.ahead)};
    if (!set.of || !set.cut || !set.ahead) {
        patch_set_destroy(&set);
        return STATUS_NO_MEMORY;
    }
    *out = set;
    return STATUS_OK;
}

static void *cut(void *user)
{
    PatchCut *c = user;
    thread_flush_denormals();
    c->status = patches_create(&c->patches, c->model);
    return NULL;
}

void patch_set_begin(PatchSet *set, int index, const Model *model)
{
    if (index < 0 || index >= set->models || set->cut[index] || set->ahead[index]) return;
    PatchCut *c = calloc(1, sizeof *c);
    if (!c) return;
    c->model = model;
    if (pthread_create(&c->thread, NULL, cut, c) == 0) set->ahead[index] = c;
    else free(c);
}

/* Waits for a model that is being cut. */
static Status take(PatchSet *set, int index)
{
    PatchCut *c = set->ahead[index];
    pthread_join(c->thread, NULL);
    const Status status = c->status;
    if (status == STATUS_OK) set->of[index] = c->patches;
    set->ahead[index] = NULL;
    free(c);
    return status;
}

void patch_set_destroy(PatchSet *set)
{
    for (int m = 0; set->ahead && m < set->models; m++)
        if (set->ahead[m]) take(set, m);
    for (int m = 0; set->of && m < set->models; m++) patches_destroy(&set->of[m]);
    free(set->of);
    free(set->cut);
    free(set->ahead);
    *set = (PatchSet){0};
}

Status patch_set_need(PatchSet *set, int index, const Model *model)
{
    if (index < 0 || index >= set->models || set->cut[index]) return STATUS_OK;
    const Status status = set->ahead[index] ? take(set, index) : patches_create(&set->of[index], model);
    set->cut[index] = status == STATUS_OK;
    return status;
}
