/* sensor/commands/model.h: `pitviper model`: what models there are, what one is made of, what it looks like. */
#ifndef SENSOR_COMMANDS_MODEL_H
#define SENSOR_COMMANDS_MODEL_H

#include "entities/catalog/catalog.h"

/* 0: done; 1: the model cannot be had; 2: wrong usage. */
int model_command(int argc, char **argv);
/* A PNG of the model (a built-in name, a file or a sidecar) from eight sides, every 45 degrees, with a scale. */
Status model_show(const char *name, double sag_m, const char *out);

#endif
