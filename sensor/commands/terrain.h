/* sensor/commands/terrain.h: `pitviper terrain`: makes a terrain store from files, or describes one. */
#ifndef SENSOR_COMMANDS_TERRAIN_H
#define SENSOR_COMMANDS_TERRAIN_H

/* 0: done; 1: failed; 2: wrong usage; 128 plus the signal: stopped. */
int terrain_command(int argc, char **argv);

#endif
