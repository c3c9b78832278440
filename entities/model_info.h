/* entities/model_info.h: `pitviper model`: what a model is made of. */
#ifndef ENTITIES_MODEL_INFO_H
#define ENTITIES_MODEL_INFO_H

/* argv[0] is "model". 0: done; 1: the model cannot be had; 2: wrong usage. */
int model_command(int argc, char **argv);

#endif
