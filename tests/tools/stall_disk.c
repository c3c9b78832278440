/* tests/tools/stall_disk.c: a disk that hangs, for the files of one name. Preloaded:
 *
 *     STALL_NAME=.ts STALL_WHILE=FILE   writes to files whose path ends with that do not return while FILE exists
 *
 * pwrite and fflush alone: videos and lines are written with them. tests/system/test_stall.sh */
#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void stall(int file)
{
    char          link[64], path[4096];
    const char   *name = getenv("STALL_NAME"), *until = getenv("STALL_WHILE");
    const ssize_t count =
        snprintf(link, sizeof link, "/proc/self/fd/%d", file) > 0 ? readlink(link, path, sizeof path - 1) : -1;
    if (!name || !until || count < 0) return;
    path[count] = 0;
    const size_t octets = strlen(path), ending = strlen(name);
    if (octets < ending || strcmp(path + octets - ending, name) != 0) return;
    while (access(until, F_OK) == 0) usleep(10000);
}

ssize_t pwrite(int file, const void *bytes, size_t count, off_t at)
{
    static ssize_t (*next)(int, const void *, size_t, off_t);
    if (!next) *(void **)&next = dlsym(RTLD_NEXT, "pwrite");
    stall(file);
    return next(file, bytes, count, at);
}

int fflush(FILE *file)
{
    static int (*next)(FILE *);
    if (!next) *(void **)&next = dlsym(RTLD_NEXT, "fflush");
    if (file) stall(fileno(file));
    return next(file);
}
