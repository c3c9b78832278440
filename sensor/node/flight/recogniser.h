/* sensor/node/flight/recogniser.h: a recogniser as a child of this process, by a shell, in a process group of its own.
 */
#ifndef SENSOR_NODE_FLIGHT_RECOGNISER_H
#define SENSOR_NODE_FLIGHT_RECOGNISER_H

#include "pitviper.h"

#include <sys/types.h>

typedef struct Recogniser {
    pid_t pid;    /* 0: not started, or ended */
    bool  ended;  /* by itself, or by another's signal */
    int   status; /* as waitpid has it, when ended */
} Recogniser;

/* command: for /bin/sh; its standard output goes to standard error. In its environment are PITVIPER_MEMORY, the name of
 * the ring of frames, PITVIPER_PORT, that answers go to, and PITVIPER_OUT, the folder of the frames. STATUS_IO, logged.
 */
Status recogniser_start(Recogniser *out, const char *command, const char *memory, int port, const char *folder);
/* Whether it has ended; said once, by user: a Recogniser. */
bool recogniser_gone(void *user);
/* Waits a little, asks it to end (SIGTERM), and ends it and what it started (SIGKILL). */
void recogniser_stop(Recogniser *recogniser);

#endif
