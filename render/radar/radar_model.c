/* render/radar/radar_model.c: opens a target by its name. */
#include "render/radar/radar_model.h"

#include "entities/import/model_import.h"
#include "render/radar/shapes.h"

Status radar_model_open(RadarModel *out, const char *name, const RadarMaterials *materials, double sag_m)
{
    ModelImport report;
    bool        imported = false;
    *out = (RadarModel){0};
    Status status = shape_is_named(name) ? shape_build(&out->model, name, sag_m)
                                         : model_open(&out->model, &report, &imported, name, sag_m);
    if (status == STATUS_OK && imported) model_import_say(&report, &out->model);
    if (status == STATUS_OK) status = radar_target_create(&out->target, &out->model, materials, "avx2");
    if (status != STATUS_OK) radar_model_close(out);
    return status;
}

void radar_model_close(RadarModel *m)
{
    radar_target_destroy(m->target);
    model_destroy(&m->model);
    *m = (RadarModel){0};
}
