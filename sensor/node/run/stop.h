/* sensor/node/run/stop.h: stops a command on Ctrl-C, SIGTERM, SIGHUP and what else would end it. */
#ifndef SENSOR_NODE_RUN_STOP_H
#define SENSOR_NODE_RUN_STOP_H

#include <stdbool.h>

/* From here on the first signal that would end the program requests a stop, and a second of its kind ends it at once,
 * in case a disk or a device hangs: SIGINT, SIGTERM, SIGHUP, SIGUSR1 and SIGUSR2 (batch systems announce the end of a
 * job's time so), SIGXCPU, timers and real-time signals. SIGINT counts even where it was ignored, as shells do for
 * background jobs of a script. The others stay ignored where they were, as SIGHUP under nohup. SIGQUIT ends the
 * program at once. A signal may be delivered to any thread and ends no wait: poll regularly. A wait for a pipe
 * (pitviper_file.h) does. Calls stop_outlive_readers. */
void stop_by_signals(void);
/* Makes the program finish its products when the reader of its output goes (`| head`) or a file reaches its limit
 * (ulimit -f): the write fails instead of ending the program. */
void stop_outlive_readers(void);
bool stop_asked(void);
/* Exit code after a stop signal, 128 plus its number as in a shell: 130 for Ctrl-C, 143 for SIGTERM, 129 for SIGHUP,
 * 138 for SIGUSR1; 0: there was none. */
int stop_exit_code(void);

#endif
