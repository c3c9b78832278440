/* sensor/node/stop.h: how a command that goes on until it is told to ends: by Ctrl-C, or a signal that asks for it. */
#ifndef SENSOR_NODE_STOP_H
#define SENSOR_NODE_STOP_H

#include <stdbool.h>

/* From here on the first SIGINT, SIGTERM or SIGHUP asks to stop, and the second ends the program the hard way, should a
 * disk or a device hang. SIGINT counts even where it was ignored: so shells start what runs in the background of a
 * script. nohup's SIGHUP stays ignored. A signal may come to any thread and ends no wait: look now and then. */
void stop_by_signals(void);
bool stop_asked(void);
/* 128 and the number of the signal that asked, as a shell says it of what a signal ended: 130 of Ctrl-C, 143 of
 * SIGTERM, 129 of SIGHUP; 0: none has. */
int  stop_exit_code(void);

#endif
