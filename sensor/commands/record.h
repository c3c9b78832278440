/* sensor/commands/record.h: `pitviper record -o LOG`: records an exercise from the network into a capture file. */
#ifndef SENSOR_COMMANDS_RECORD_H
#define SENSOR_COMMANDS_RECORD_H

/* argv[0] is "record". Until SIGINT, SIGTERM, SIGHUP or another signal that would end it, --for or --count. 0: recorded, even if nothing; 1: the file
 * cannot be written or the network not received; 2: usage. */
int record_command(int argc, char **argv);

#endif
