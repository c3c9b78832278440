/* sensor/commands/plant_judge.c: rays against the plants of a place where something is to hide. */
#include "sensor/commands/plant_judge.h"

#include "render/trace/plants/forest.h"
#include "sensor/settings/config.h"

#include <stdlib.h>

struct PlantJudge {
    Plants     *plants;
    Woods       seedling; /* the prototypes' scenes are of this forest, which the others stand beside */
    Forest     *grown, *forest;
    Arena      *arena;
    const char *isa;
};

static const double focal_px = 6900; /* of the default sensor: 720 px over 6 degrees */

Status plant_judge_create(PlantJudge **out, const char *isa)
{
    PlantJudge *j = calloc(1, sizeof *j);
    if (!j) return STATUS_NO_MEMORY;
    j->isa = isa;
    j->arena = arena_create();
    *out = j;
    if (j->arena) return STATUS_OK;
    plant_judge_destroy(j);
    *out = NULL;
    return STATUS_NO_MEMORY;
}

static Status grow(PlantJudge *j)
{
    const Config       config = config_default();
    const ForestConfig forest = {
        .leaves = config.terrain.woods_leaves, .fine = true, .level1_px = config.terrain.woods_level1_px};
    if (j->grown) return STATUS_OK;
    Status status = plants_create(&j->plants, plants_seed, NULL);
    if (status == STATUS_OK) status = woods_of_class(&j->seedling, SURFACE_SCRUB, 1, 1, 1);
    if (status == STATUS_OK) status = forest_create(&j->grown, &j->seedling, j->plants, &forest, j->isa);
    return status;
}

static void judge_end(void *user)
{
    PlantJudge *j = user;
    forest_destroy(j->forest);
    j->forest = NULL;
}

static Status judge_begin(void *user, const Woods *woods)
{
    PlantJudge  *j = user;
    const Status status = grow(j);
    judge_end(j);
    return status == STATUS_OK ? forest_create_beside(&j->forest, j->grown, woods) : status;
}

static Status judge_dark(void *user, uint8_t *dark, const double eye_enu[3], int count, const double *const o_enu[3],
                         const double *const d_enu[3], double far_m)
{
    PlantJudge  *j = user;
    const double still[2] = {0, 0};
    double       far[1024];
    ForestFrame  frame = {0};
    if (count > 1024) return STATUS_BAD_VALUE;
    for (int k = 0; k < count; k++) far[k] = far_m, dark[k] = 0;
    arena_reset(j->arena);
    Status status = forest_frame_open(&frame, j->forest, eye_enu, focal_px, 0, 0, still, NULL, j->arena);
    if (status == STATUS_OK) forest_any_hits(dark, &frame, count, o_enu, d_enu, far, NULL);
    forest_frame_close(&frame);
    return status;
}

void plant_judge_destroy(PlantJudge *j)
{
    if (!j) return;
    forest_destroy(j->forest);
    forest_destroy(j->grown);
    woods_destroy(&j->seedling);
    plants_destroy(j->plants);
    arena_destroy(j->arena);
    free(j);
}

HideJudge plant_judge_hide(PlantJudge *j) { return (HideJudge){j, judge_begin, judge_end, judge_dark}; }
