/* sensor/commands/terrain_info.h: `pitviper terrain info STORE`: what is in a terrain store, and pictures of it. */
#ifndef SENSOR_COMMANDS_TERRAIN_INFO_H
#define SENSOR_COMMANDS_TERRAIN_INFO_H

/* argv[0] = "pitviper terrain info". 0: done; 1: the store cannot be read, or the pictures not written; 2: usage. */
int terrain_info_command(int argc, char **argv);

#endif
