/* render/radar/radar_model.h: a target by its name: a built-in model, a model's file, or a shape of shapes.h. */
#ifndef RENDER_RADAR_RADAR_MODEL_H
#define RENDER_RADAR_RADAR_MODEL_H

#include "render/radar/target.h"

/* Stays where it was opened: the target points to the model. */
typedef struct RadarModel {
    Model        model;
    RadarTarget *target;
} RadarModel;

/* Curved surfaces of built-in models and shapes are within sag_m of their facets; a file is as fine as it is.
 * materials: of radar_materials_load, must outlive it. Logs. */
Status radar_model_open(RadarModel *out, const char *name, const RadarMaterials *materials, double sag_m);
void   radar_model_close(RadarModel *m); /* accepts zeroes */

#endif
