/* render/radar/radar_model.c: opens a target by its name. */
#include "render/radar/radar_model.h"

#include "entities/import/model_import.h"
#include "render/radar/shapes.h"

Status radar_model_open(RadarModel *out, const char *name, const RadarMaterials *materials, double sag_m)
{
    RadarModel  m = {0};
    ModelImport report;
    bool        imported;
    Status      status = shape_is_named(name) ? shape_build(&m.model, name, sag_m)
                                              : model_open(&m.model, &report, &imported, name, sag_m);
    if (status == STATUS_OK) status = radar_target_create(&m.target, &m.model, materials, "avx2");
    if (status != STATUS_OK) {
        model_destroy(&m.model);
        return status;
    }
    *out = m;
    out->target->model = &out->model;
    return STATUS_OK;
}

void radar_model_close(RadarModel *m)
{
    radar_target_destroy(m->target);
    model_destroy(&m->model);
    *m = (RadarModel){0};
}
