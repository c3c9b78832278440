/* dis/head/head_link.c: the socket of a head tracker, and the thread that takes its datagrams. */
#include "dis/head/head_link.h"

#include "dis/network/host_port.h"

#include <arpa/inet.h>
#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

struct HeadLink {
    int             socket;
    pthread_t       thread;
    bool            running;
    pthread_mutex_t lock; /* protects the following */
    bool            any, ends;
    HeadPose        newest;
    HeadCounters    counters;
};

bool head_address_good(const char *address_port)
{
    HostPort address;
    return host_port_parse(&address, address_port);
}

static void take(HeadLink *link, const uint8_t *octets, size_t count)
{
    HeadPose pose;
    HeadDrop drop = head_pose_read(&pose, octets, count);
    pthread_mutex_lock(&link->lock);
    if (drop == HEAD_GOOD && link->any && !head_newer(pose.sequence, link->newest.sequence)) drop = HEAD_OLD;
    if (drop == HEAD_GOOD) link->newest = pose;
    link->any |= drop == HEAD_GOOD;
    link->counters.datagrams[drop]++;
    pthread_mutex_unlock(&link->lock);
}

static void *receive(void *user)
{
    enum { most = 2048 };
    HeadLink *link = user;
    uint8_t   octets[most];
    for (;;) {
        const ssize_t got = recv(link->socket, octets, sizeof octets, MSG_TRUNC);
        pthread_mutex_lock(&link->lock);
        const bool ends = link->ends;
        pthread_mutex_unlock(&link->lock);
        if (ends || (got < 0 && errno != EINTR && errno != EAGAIN)) return NULL;
        if (got >= 0) take(link, octets, (size_t)got <= sizeof octets ? (size_t)got : 0); /* longer: of no size */
    }
}

static bool start(HeadLink *link)
{
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    link->running = pthread_create(&link->thread, NULL, receive, link) == 0;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return link->running;
}

Status head_link_open(HeadLink **out, const char *address_port)
{
    static const struct timeval look = {.tv_usec = 200000}; /* whether it ends */
    HostPort                    own;
    HeadLink                   *link = calloc(1, sizeof *link);
    if (!link) return STATUS_NO_MEMORY;
    link->socket = -1;
    pthread_mutex_init(&link->lock, NULL);
    if (!host_port_parse(&own, address_port)) {
        log_error("head: '%s' is not ADDRESS:PORT with a numeric address of this machine, for example 127.0.0.1:5010",
                  address_port);
        head_link_close(link, NULL);
        return STATUS_BAD_VALUE;
    }
    link->socket = socket(own.any.sa_family, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (link->socket < 0 || setsockopt(link->socket, SOL_SOCKET, SO_RCVTIMEO, &look, sizeof look) != 0 ||
        bind(link->socket, &own.any, host_port_size(&own)) != 0 || !start(link)) {
        log_error("head: cannot listen on %s: %s; choose another address or port (exercise.head)", address_port,
                  strerror(errno));
        head_link_close(link, NULL);
        return STATUS_IO;
    }
    *out = link;
    return STATUS_OK;
}

void head_link_close(HeadLink *link, HeadCounters *counters)
{
    if (!link) return;
    pthread_mutex_lock(&link->lock);
    link->ends = true;
    pthread_mutex_unlock(&link->lock);
    if (link->socket >= 0)
        shutdown(link->socket, SHUT_RD); /* wakes its thread, though it says that it is not connected */
    if (link->running) pthread_join(link->thread, NULL);
    if (link->socket >= 0) close(link->socket);
    if (counters) *counters = link->counters;
    pthread_mutex_destroy(&link->lock);
    free(link);
}

bool head_link_newest(HeadPose *out, HeadLink *link)
{
    pthread_mutex_lock(&link->lock);
    const bool any = link->any;
    if (any) *out = link->newest;
    pthread_mutex_unlock(&link->lock);
    return any;
}
