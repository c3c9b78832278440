/* tests/tools/set_clock.c: preloaded: while the file SET_CLOCK_WHEN is there the system's clock is SET_CLOCK_S seconds
 * off, as the program sees it: clock_gettime, sleeps by that clock, and the kernel's stamps of datagrams. */
#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

static const long ns_per_s = 1000000000;

static int call(clockid_t id, struct timespec *out)
{
    static int (*next)(clockid_t, struct timespec *);
    if (!next) *(void **)&next = dlsym(RTLD_NEXT, "clock_gettime");
    return next(id, out);
}

/* By how many seconds it is set at this moment. */
static long set_s(void)
{
    const char *when = getenv("SET_CLOCK_WHEN"), *by_s = getenv("SET_CLOCK_S");
    return when && by_s && access(when, F_OK) == 0 ? atol(by_s) : 0;
}

int clock_gettime(clockid_t id, struct timespec *out)
{
    const int failed = call(id, out);
    if (!failed && id == CLOCK_REALTIME) out->tv_sec += set_s();
    return failed;
}

/* The kernel's clock was not set: its instant is another. A sleeper is not told while it sleeps, so in small steps. */
int clock_nanosleep(clockid_t id, int flags, const struct timespec *request, struct timespec *left)
{
    static int (*next)(clockid_t, int, const struct timespec *, struct timespec *);
    if (!next) *(void **)&next = dlsym(RTLD_NEXT, "clock_nanosleep");
    if (id != CLOCK_REALTIME || !(flags & TIMER_ABSTIME)) return next(id, flags, request, left);
    for (;;) {
        const struct timespec step = {0, ns_per_s / 100};
        struct timespec       now;
        clock_gettime(CLOCK_REALTIME, &now);
        if (now.tv_sec > request->tv_sec || (now.tv_sec == request->tv_sec && now.tv_nsec >= request->tv_nsec))
            return 0;
        next(CLOCK_MONOTONIC, 0, &step, NULL);
    }
}

int recvmmsg(int socket, struct mmsghdr *message, unsigned count, int flags, struct timespec *timeout)
{
    static int (*next)(int, struct mmsghdr *, unsigned, int, struct timespec *);
    if (!next) *(void **)&next = dlsym(RTLD_NEXT, "recvmmsg");
    const int came = next(socket, message, count, flags, timeout);
    for (int i = 0; i < came; i++)
        for (struct cmsghdr *c = CMSG_FIRSTHDR(&message[i].msg_hdr); c; c = CMSG_NXTHDR(&message[i].msg_hdr, c)) {
            struct timespec stamp;
            if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SCM_TIMESTAMPNS) continue;
            memcpy(&stamp, CMSG_DATA(c), sizeof stamp);
            stamp.tv_sec += set_s();
            memcpy(CMSG_DATA(c), &stamp, sizeof stamp);
        }
    return came;
}
