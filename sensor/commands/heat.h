/* sensor/commands/heat.h: `pitviper heat`: a vehicle's temperatures over a clear day. */
#ifndef SENSOR_COMMANDS_HEAT_H
#define SENSOR_COMMANDS_HEAT_H

/* 0: done; 1: it could not be; 2: wrong usage. */
int heat_command(int argc, char **argv);

#endif
