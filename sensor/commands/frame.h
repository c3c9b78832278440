/* sensor/commands/frame.h: `pitviper frame FILE`. */
#ifndef SENSOR_COMMANDS_FRAME_H
#define SENSOR_COMMANDS_FRAME_H

int frame_command(int argc, char **argv);

#endif
