/* sensor/commands/model/model_stage.h: one model on level ground under a clear sky: what commands need that draw a
 * model. */
#ifndef SENSOR_COMMANDS_MODEL_MODEL_STAGE_H
#define SENSOR_COMMANDS_MODEL_MODEL_STAGE_H

#include "render/frame/render.h"

typedef struct ModelStageConfig {
    const char  *name;  /* of the model: built in, or a file */
    double       sag_m; /* as parametric_build */
    Geodetic     origin;
    double       begin_s; /* Unix time of exercise time 0: the ground is warmed up until then, as on a clear day */
    SurfaceClass surface; /* that it stands on; SURFACE_NONE: any */
} ModelStageConfig;

typedef struct ModelStage {
    Landscape landscape;
    Catalog  *catalog;
    World     world;
    Pool     *pool;
    Arena    *arena, *air_arena; /* for one image; for what several images share. The caller resets them */
    Air       air;
    int       model;               /* of the catalog */
    double    begin_s, place_m[2]; /* Unix time; east and north of the origin */
} ModelStage;

/* stage: zeroes. On failure, logged, model_stage_close is still due. */
Status model_stage_open(ModelStage *stage, const ModelStageConfig *config);
void   model_stage_close(ModelStage *stage); /* accepts zeroes */
/* Gives the place of the model: on the ground. */
void model_stage_place(double p_enu[3], const ModelStage *stage);
/* Puts the model on the ground at exercise time 0, its nose turned by turn_rad from east towards north. */
Status model_stage_put(Snapshot *out, SnapshotEntity *entity, const ModelStage *stage, double turn_rad);
/* Fills stage->air: the sun, the atmosphere and the ground's heat at a time, for the view of a request. */
Status model_stage_light(ModelStage *stage, const RenderRequest *request, double unix_s);

#endif
