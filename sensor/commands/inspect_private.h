/* sensor/commands/inspect_private.h: the two output formats of `pitviper inspect`. exercise: only this one; -1: all. */
#ifndef SENSOR_COMMANDS_INSPECT_PRIVATE_H
#define SENSOR_COMMANDS_INSPECT_PRIVATE_H

#include "dis/log.h"

Status inspect_summary(const DisLog *log, const char *path, int exercise);
void   inspect_tsv(const DisLog *log, const char *path, int exercise, bool full); /* full: all columns */

#endif
