/* sensor/commands/rcs.h: `pitviper rcs`: a target's radar cross section over aspect. */
#ifndef SENSOR_COMMANDS_RCS_H
#define SENSOR_COMMANDS_RCS_H

/* 0: done; 1: it could not be; 2: wrong usage. */
int rcs_command(int argc, char **argv);

#endif
