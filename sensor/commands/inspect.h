/* sensor/commands/inspect.h: `pitviper inspect LOG`: entities, their times and events, senders, and malformed PDUs. */
#ifndef SENSOR_COMMANDS_INSPECT_H
#define SENSOR_COMMANDS_INSPECT_H

/* argv[0] = "inspect". 0: done; 1: the log cannot be read or the output not written; 2: usage. */
int inspect_command(int argc, char **argv);

#endif
