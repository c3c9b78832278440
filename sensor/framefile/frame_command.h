/* sensor/framefile/frame_command.h: `pitviper frame FILE`. */
#ifndef SENSOR_FRAMEFILE_FRAME_COMMAND_H
#define SENSOR_FRAMEFILE_FRAME_COMMAND_H

int frame_command(int argc, char **argv);

#endif
