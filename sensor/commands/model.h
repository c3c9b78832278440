/* sensor/commands/model.h: `pitviper model`: lists models, prints the parts of one, or renders it. */
#ifndef SENSOR_COMMANDS_MODEL_H
#define SENSOR_COMMANDS_MODEL_H

#include "entities/catalog/catalog.h"

/* 0: done; 1: the model cannot be loaded; 2: wrong usage. */
int model_command(int argc, char **argv);
/* A PNG of the model (a built-in name, a file or a sidecar) from eight sides, every 45 degrees, with a scale. */
Status model_show(const char *name, double sag_m, const char *out);

#endif
