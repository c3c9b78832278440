/* sensor/node/stop.h: stops a command on Ctrl-C, SIGTERM or SIGHUP. */
#ifndef SENSOR_NODE_STOP_H
#define SENSOR_NODE_STOP_H

#include <stdbool.h>

/* From here on the first SIGINT, SIGTERM or SIGHUP requests a stop, and the second ends the program at once, in case
 * a disk or a device hangs. SIGINT counts even where it was ignored, as shells do for background jobs of a script.
 * SIGHUP stays ignored under nohup. A signal may be delivered to any thread and ends no wait: poll regularly. */
void stop_by_signals(void);
bool stop_asked(void);
/* 128 plus the number of the stop signal, as in a shell's exit status: 130 for Ctrl-C, 143 for SIGTERM, 129 for
 * SIGHUP; 0: none. */
int  stop_exit_code(void);

#endif
