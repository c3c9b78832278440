/* tests/bench/sensor/node_process.h: pitviper as another process, for the benches of a live node. */
#ifndef TESTS_BENCH_SENSOR_NODE_PROCESS_H
#define TESTS_BENCH_SENSOR_NODE_PROCESS_H

#include "pitviper.h"

#include <sys/resource.h>
#include <sys/types.h>

/* argument: NULL at the end. Redirects standard output and error to these. -1: it did not start. */
pid_t node_start(const char *const *argument, int out, int err);
/* Waits for its exit code; after the timeout the process is killed, and -1 returned. */
int node_finish(pid_t child, double within_s, struct rusage *usage);
/* Waits until it has printed this text, or for the timeout. */
bool node_hears(int from, const char *text, double within_s);

/* Finds the number after the first such key that follows the other keys. NaN: it is not there. */
double node_number(const char *text, const char *const *key, int keys);
#define NUMBER_AT(text, ...)                                                                                           \
    node_number(text, (const char *const[]){__VA_ARGS__}, sizeof((const char *[]){__VA_ARGS__}) / sizeof(char *))

#endif
