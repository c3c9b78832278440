/* tests/tools/fail_encoder.c: FFmpeg's encoders fail for a while. Preloaded:
 *
 *     FAIL_ENCODER=FROM,COUNT   that many calls of avcodec_send_frame return an error, from call FROM (0: the first) on
 *
 * tests/system/test_publish_failures.sh */
#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif
#include <dlfcn.h>
#include <errno.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

int avcodec_send_frame(void *context, const void *frame);

static atomic_long calls;

int avcodec_send_frame(void *context, const void *frame)
{
    static int (*next)(void *, const void *);
    long        from = 0, count = 0;
    const char *when = getenv("FAIL_ENCODER");
    const long  call = atomic_fetch_add(&calls, 1);
    if (!next) *(void **)&next = dlsym(RTLD_NEXT, "avcodec_send_frame");
    if (when && sscanf(when, "%ld,%ld", &from, &count) == 2 && call >= from && call < from + count) return -EIO;
    return next(context, frame);
}
