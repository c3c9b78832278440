/* sensor/commands/terrain_again.h: `pitviper terrain again STORE`: makes a store again with the options that it has. */
#ifndef SENSOR_COMMANDS_TERRAIN_AGAIN_H
#define SENSOR_COMMANDS_TERRAIN_AGAIN_H

/* argv[0] = "pitviper terrain again". 0: done; 1: it has no options, or could not be made; 2: usage; 128 + a signal's
 * number: stopped, and as it was. */
int terrain_again_command(int argc, char **argv);

#endif
