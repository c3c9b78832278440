/* dis/network/udp.c: the receiving thread, its queue, and the rule that closes a tick.
 *
 * Three locks, in this order. receive: which thread may take from the socket and give out arrival times (the thread, or
 * for a moment the one that closes a tick). sending: the socket itself, which is replaced after a loss of the network.
 * queue: the ring and the counters, held for a few copies only. */
#include "dis/network/udp.h"
#include "dis/clock/steady_clock.h"
#include "dis/network/udp_private.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/sock_diag.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <sys/eventfd.h>
#include <time.h>
#include <unistd.h>

enum {
    batch = 64,
    buffer_octets = dis_max_datagram + 1,
    control_octets = 128,
    pause_ms = 100,
    check_interval_ms = 1000
};

static const int64_t ns_per_s = 1000000000;

struct DisUdp {
    int              socket, wake; /* wake: an eventfd that ends the thread; -1 in a sender */
    DisSocketAddress to;
    char             name[dis_udp_where_size];
    DisUdpConfig     config;
    DisTie           tie;
    DisLink          link; /* belongs to the receiving thread; of a sender: guarded by `sending` */
    pthread_mutex_t
            sending;    /* guards the socket and its destination, which are replaced under this lock and `receive` */
    int64_t checked_ns; /* only in a sender: time of the last link check */

    /* guarded by `receive` */
    pthread_mutex_t  receive;
    pthread_cond_t   turn;    /* the tick is closed, the thread may continue */
    int64_t          last_ns; /* no arrival time is below this */
    SteadyClock      clock;
    bool             complained;
    DisUdpTap        tap; /* NULL: none */
    void            *tap_user;
    struct mmsghdr   message[batch];
    struct iovec     vector[batch];
    DisSocketAddress from[batch];
    uint8_t         *buffer; /* [batch][buffer_octets] */
    _Alignas(struct cmsghdr) uint8_t control[batch][control_octets];

    /* guarded by `queue` */
    pthread_mutex_t queue;
    pthread_cond_t  arrived;
    bool            taker_waits;
    DisRing         ring;
    uint32_t        kernel_drops; /* the kernel's own counter of drops, modulo 2^32 */
    DisUdpCounters  counters;

    atomic_bool          closing, stopping;
    atomic_uint_fast64_t sent, send_failed;
    atomic_int           send_error, away; /* errno of the latest failed send; state of the link */
    bool                 running;
    pthread_t            thread;
};

DisUdpConfig dis_udp_default_config(void)
{
    return (DisUdpConfig){.port = dis_port, .ttl = 1, .queue_octets = 32 << 20};
}

void dis_udp_where(char out[dis_udp_where_size], const DisUdpConfig *config)
{
    snprintf(out, dis_udp_where_size, "%s port %d%s%s", config->address[0] ? config->address : "all addresses",
             config->port, config->interface[0] ? " on " : "", config->interface);
}

int64_t dis_udp_now_ns(void) { return steady_clock_now_ns(); }

void dis_udp_sleep_until(int64_t until_ns)
{
    const struct timespec until = steady_clock_monotonic(until_ns);
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL);
}

void dis_udp_destination(uint8_t to[16], const DisUdp *udp)
{
    DisUdp *u = (DisUdp *)udp; /* to take a lock, which needs the object not to be const */
    pthread_mutex_lock(&u->sending);
    dis_socket_address_octets16(to, &u->to);
    pthread_mutex_unlock(&u->sending);
}

/* ---- the queue: all under its lock ----------------------------------------------------------------- */

static void put_arrival(DisUdp *u, const DisRingRecord *head, const uint8_t *bytes)
{
    u->counters.datagrams++;
    u->counters.octets += head->octets;
    if (!dis_ring_put(&u->ring, head, bytes)) u->counters.lost_queue++;
}

/* Drops are reported with datagrams and on query, so an older count may arrive after a newer one. */
static void note_drops(DisUdp *u, uint32_t drops)
{
    const uint32_t more = drops - u->kernel_drops;
    if (more > INT32_MAX) return;
    u->kernel_drops = drops;
    u->counters.lost_kernel += more;
}

bool dis_udp_take(DisArrival *out, DisUdp *u, int64_t until_ns)
{
    pthread_mutex_lock(&u->queue);
    const DisRingRecord *record = dis_ring_take(&u->ring, until_ns);
    if (record) {
        *out = (DisArrival){.capture_ns = record->capture_ns,
                            .octets = record->octets,
                            .bytes = (const uint8_t *)(record + 1),
                            .from_port = record->from_port};
        memcpy(out->from, record->from, sizeof out->from);
    }
    pthread_mutex_unlock(&u->queue);
    return record;
}

bool dis_udp_wait(DisUdp *u, int64_t until_ns)
{
    const struct timespec until = steady_clock_monotonic(until_ns);
    pthread_mutex_lock(&u->queue);
    while (!dis_ring_waits(&u->ring)) {
        u->taker_waits = true;
        if (pthread_cond_timedwait(&u->arrived, &u->queue, &until) != 0) break;
    }
    u->taker_waits = false;
    const bool waits = dis_ring_waits(&u->ring);
    pthread_mutex_unlock(&u->queue);
    return waits;
}

DisUdpCounters dis_udp_counters(const DisUdp *udp)
{
    DisUdp   *u = (DisUdp *)udp; /* the call changes only locks and the kernel's count, nothing that the caller sees */
    uint32_t  info[SK_MEMINFO_VARS] = {0};
    socklen_t octets = sizeof info;
    pthread_mutex_lock(&u->sending); /* the socket must not be replaced while the kernel's count is read from it */
    const bool told = u->wake >= 0 && getsockopt(u->socket, SOL_SOCKET, SO_MEMINFO, info, &octets) == 0 &&
                      octets > SK_MEMINFO_DROPS * sizeof *info;
    pthread_mutex_lock(&u->queue);
    if (told) note_drops(u, info[SK_MEMINFO_DROPS]);
    DisUdpCounters counters = u->counters;
    pthread_mutex_unlock(&u->queue);
    pthread_mutex_unlock(&u->sending);
    counters.sent = atomic_load(&u->sent);
    counters.send_failed = atomic_load(&u->send_failed);
    counters.send_error = atomic_load(&u->send_error);
    counters.away = atomic_load(&u->away) != DIS_LINK_UP;
    return counters;
}

/* ---- the socket: all under the receive lock ---------------------------------------------------------- */

/* Reads the control messages of a datagram: its arrival time, and the number of drops. */
static void read_control(int64_t *kernel_ns, uint32_t *drops, bool *dropped, struct msghdr *header)
{
    for (struct cmsghdr *c = CMSG_FIRSTHDR(header); c; c = CMSG_NXTHDR(header, c)) {
        if (c->cmsg_level != SOL_SOCKET) continue;
        if (c->cmsg_type == SCM_TIMESTAMPNS) {
            struct timespec came;
            memcpy(&came, CMSG_DATA(c), sizeof came);
            *kernel_ns = (int64_t)came.tv_sec * ns_per_s + came.tv_nsec;
        } else if (c->cmsg_type == SO_RXQ_OVFL) {
            memcpy(drops, CMSG_DATA(c), sizeof *drops);
            *dropped = true;
        }
    }
}

/* Checks for a step of the system clock, and so of the kernel's time stamps; logs a step above one second. */
static ClockReading look_at_clock(DisUdp *u)
{
    const ClockReading now = steady_clock_reading();
    const double       set_s = 1e-9 * (double)steady_clock_look(&u->clock, now);
    if (fabs(set_s) >= 1)
        log_warn("udp: the system's clock was set %s by %.0f s; arrival times go on without that step",
                 set_s > 0 ? "forward" : "back", fabs(set_s));
    return now;
}

/* Receives up to one batch without blocking. Returns the number of datagrams, or -1 after a failure. *newest_ns: the
 * latest kernel time stamp among them. */
static int receive_batch(DisUdp *u, int64_t *newest_ns)
{
    for (int i = 0; i < batch; i++) {
        u->vector[i] = (struct iovec){u->buffer + (size_t)i * buffer_octets, buffer_octets};
        u->message[i].msg_hdr = (struct msghdr){.msg_name = &u->from[i],
                                                .msg_namelen = sizeof u->from[i],
                                                .msg_iov = &u->vector[i],
                                                .msg_iovlen = 1,
                                                .msg_control = u->control[i],
                                                .msg_controllen = control_octets};
    }
    const int came = recvmmsg(u->socket, u->message, batch, MSG_DONTWAIT, NULL);
    if (came < 0) return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR ? 0 : -1;

    const ClockReading now = look_at_clock(u);
    *newest_ns = 0;
    DisRingRecord record[batch];
    uint32_t      drops = 0;
    bool          dropped = false;
    for (int i = 0; i < came; i++) {
        struct msghdr *header = &u->message[i].msg_hdr;
        int64_t        kernel_ns = 0;
        read_control(&kernel_ns, &drops, &dropped, header);
        kernel_ns = kernel_ns ? steady_clock_of_stamp(&u->clock, kernel_ns, now) : dis_udp_now_ns();
        if (kernel_ns > *newest_ns) *newest_ns = kernel_ns;
        if (kernel_ns > u->last_ns) u->last_ns = kernel_ns;
        record[i] = (DisRingRecord){.capture_ns = u->last_ns, .octets = u->message[i].msg_len};
        if (header->msg_namelen >= sizeof u->from[i].v4) {
            const bool v6 = u->from[i].any.sa_family == AF_INET6;
            dis_socket_address_octets16(record[i].from, &u->from[i]);
            record[i].from_port = ntohs(v6 ? u->from[i].v6.sin6_port : u->from[i].v4.sin_port);
        }
        if (u->tap) {
            DisArrival arrival = {.capture_ns = record[i].capture_ns,
                                  .octets = record[i].octets,
                                  .bytes = u->vector[i].iov_base,
                                  .from_port = record[i].from_port};
            memcpy(arrival.from, record[i].from, sizeof arrival.from);
            u->tap(u->tap_user, &arrival);
        }
    }
    pthread_mutex_lock(&u->queue);
    if (dropped) note_drops(u, drops); /* the last datagram has the newest count */
    for (int i = 0; i < came; i++) put_arrival(u, &record[i], u->vector[i].iov_base);
    if (u->taker_waits && dis_ring_waits(&u->ring)) pthread_cond_signal(&u->arrived);
    pthread_mutex_unlock(&u->queue);
    return came;
}

/* Logs a lost network once; receiving resumes when the network is back. */
static void complain(DisUdp *u)
{
    const int error = errno;
    if (!u->complained) log_warn("udp: cannot receive on %s: %s; trying on", u->name, strerror(error));
    u->complained = true;
}

/* ---- loss and return of the network: under the receive lock, in a sender under sending ------------------------ */

/* Replaces the old socket under the same descriptor, so that no other code changes. Returns false when that is not
 * possible now. */
static bool remake_socket(DisUdp *u)
{
    int              made;
    DisSocketAddress to;
    DisTie           tie;
    const bool       listens = u->link.listens;
    log_suppress(true); /* messages are suppressed, since this is retried each second */
    const Status status = dis_udp_socket(&made, &to, &tie, &u->config, listens);
    log_suppress(false);
    if (status != STATUS_OK) return false;
    if (listens) {
        dis_udp_counters(u); /* reads what the old socket had lost */
        pthread_mutex_lock(&u->sending);
        pthread_mutex_lock(&u->queue);
        u->kernel_drops = 0;
        pthread_mutex_unlock(&u->queue);
    }
    dup3(made, u->socket, O_CLOEXEC);
    u->to = to;
    u->tie = tie;
    if (listens) pthread_mutex_unlock(&u->sending);
    close(made);
    u->link.lost = false;
    return true;
}

/* Returns true when the link works now. */
static bool check_link(DisUdp *u)
{
    bool remake;
    dis_link_read(&u->link, u->socket, &u->to, &u->tie);
    dis_link_report(&u->link, u->name, &u->config);
    dis_link_check(&u->link, &remake, u->socket, &u->to, &u->tie, &u->config);
    if (remake) {
        const bool made = remake_socket(u);
        if (made) dis_link_check(&u->link, &remake, u->socket, &u->to, &u->tie, &u->config);
        else u->link.lost = true;
    }
    dis_link_report(&u->link, u->name, &u->config);
    const DisLinkState state = u->link.lost ? DIS_LINK_GONE : u->link.state;
    atomic_store(&u->away, (int)state);
    return state == DIS_LINK_UP;
}

static void *receive_loop(void *user)
{
    DisUdp       *u = user;
    struct pollfd what[3] = {{.fd = u->socket, .events = POLLIN},
                             {.fd = u->wake, .events = POLLIN},
                             {.fd = u->link.watch, .events = POLLIN}};
    int64_t       checked_ns = dis_udp_now_ns();
    while (!atomic_load(&u->stopping)) {
        int64_t       newest_ns;
        const int     ready = poll(what, 3, dis_link_unreported(&u->link) ? pause_ms : check_interval_ms);
        const int64_t now_ns = dis_udp_now_ns();
        if (ready == 0 || what[2].revents || llabs(now_ns - checked_ns) >= check_interval_ms * 1000000ll) {
            pthread_mutex_lock(&u->receive);
            check_link(u);
            pthread_mutex_unlock(&u->receive);
            checked_ns = now_ns;
        }
        if (ready <= 0 || !what[0].revents) continue;
        pthread_mutex_lock(&u->receive);
        /* a flood must not delay the thread that closes a tick */
        while (atomic_load(&u->closing)) pthread_cond_wait(&u->turn, &u->receive);
        const bool failed = receive_batch(u, &newest_ns) < 0;
        if (failed) complain(u);
        pthread_mutex_unlock(&u->receive);
        if (failed) poll(&what[1], 1, pause_ms);
    }
    return NULL;
}

void dis_udp_close_tick(DisUdp *u, int64_t until_ns)
{
    const int64_t called_ns = dis_udp_now_ns();
    int64_t       newest_ns;
    assert(until_ns < INT64_MAX);
    atomic_store(&u->closing, true);
    pthread_mutex_lock(&u->receive);
    /* until the socket is empty, or until its datagrams arrived after the call, since a flood would never end */
    while (receive_batch(u, &newest_ns) == batch && newest_ns <= called_ns) {
    }
    if (u->last_ns <= until_ns) u->last_ns = until_ns + 1;
    atomic_store(&u->closing, false);
    pthread_cond_signal(&u->turn);
    pthread_mutex_unlock(&u->receive);
}

void dis_udp_tap(DisUdp *u, DisUdpTap tap, void *user)
{
    atomic_store(&u->closing, true);
    pthread_mutex_lock(&u->receive);
    u->tap = tap;
    u->tap_user = user;
    atomic_store(&u->closing, false);
    pthread_cond_signal(&u->turn);
    pthread_mutex_unlock(&u->receive);
}

/* ---- sending ------------------------------------------------------------------------------------------ */

static bool send_once(DisUdp *u, const uint8_t *bytes, size_t octets)
{
    ssize_t sent;
    do
        sent = sendto(u->socket, bytes, octets, MSG_DONTWAIT | MSG_NOSIGNAL, &u->to.any,
                      dis_socket_address_octets(&u->to));
    while (sent < 0 && errno == EINTR);
    return sent >= 0;
}

/* Whether a sender may send now. After a failure it checks the link, and again later, to notice its return. A listener
 * has a thread for that. */
static bool sender_may_go_on(DisUdp *u)
{
    const int64_t now_ns = dis_udp_now_ns();
    if (u->link.listens || llabs(now_ns - u->checked_ns) < pause_ms * 1000000ll) return false;
    u->checked_ns = now_ns;
    return check_link(u);
}

Status dis_udp_send(DisUdp *u, const uint8_t *bytes, size_t octets)
{
    pthread_mutex_lock(&u->sending);
    bool      sent = send_once(u, bytes, octets);
    const int error = errno;
    if (!sent && sender_may_go_on(u)) sent = send_once(u, bytes, octets);
    else if (sent && atomic_load(&u->away)) sender_may_go_on(u);
    pthread_mutex_unlock(&u->sending);
    if (!sent) {
        atomic_store(&u->send_error, error);
        atomic_fetch_add(&u->send_failed, 1);
        errno = error;
        return STATUS_IO;
    }
    atomic_fetch_add(&u->sent, 1);
    return STATUS_OK;
}

/* ---- open and close
 * ------------------------------------------------------------------------------------------------- */

/* The thread blocks signals: the main thread handles them. */
static bool start_thread(DisUdp *u)
{
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    u->running = pthread_create(&u->thread, NULL, receive_loop, u) == 0;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return u->running;
}

static DisUdp *make(const DisUdpConfig *config)
{
    DisUdp *u = calloc(1, sizeof *u);
    if (!u) return NULL;
    u->socket = u->wake = u->link.watch = -1;
    u->config = *config;
    dis_udp_where(u->name, config);
    pthread_mutex_init(&u->sending, NULL);
    pthread_mutex_init(&u->receive, NULL);
    pthread_mutex_init(&u->queue, NULL);
    pthread_cond_init(&u->turn, NULL);
    pthread_condattr_t monotonic;
    pthread_condattr_init(&monotonic);
    pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
    pthread_cond_init(&u->arrived, &monotonic);
    pthread_condattr_destroy(&monotonic);
    u->clock = steady_clock();
    return u;
}

Status dis_udp_open_sender(DisUdp **out, const DisUdpConfig *config)
{
    DisUdp *u = make(config);
    if (!u) return STATUS_NO_MEMORY;
    const Status status = dis_udp_socket(&u->socket, &u->to, &u->tie, config, false);
    if (status != STATUS_OK) {
        dis_udp_close(u);
        return status;
    }
    check_link(u);
    *out = u;
    return STATUS_OK;
}

Status dis_udp_open(DisUdp **out, const DisUdpConfig *config)
{
    DisUdp *u = make(config);
    if (!u) return STATUS_NO_MEMORY;
    u->link.listens = true;
    u->link.watch =
        dis_link_watch(); /* created before the socket, so that changes while the socket is made are reported */
    Status status = dis_udp_socket(&u->socket, &u->to, &u->tie, config, true);
    if (status != STATUS_OK) goto fail;
    check_link(u);

    const bool ring = dis_ring_create(&u->ring, (uint64_t)config->queue_octets) == STATUS_OK;
    u->buffer = malloc((size_t)batch * buffer_octets);
    if (!ring || !u->buffer) {
        log_error("udp: no memory for a queue of %d octets; ask for less", config->queue_octets);
        status = STATUS_NO_MEMORY;
        goto fail;
    }
    u->wake = eventfd(0, EFD_CLOEXEC);
    if (u->wake < 0 || !start_thread(u)) {
        log_error("udp: cannot start the thread that listens on %s: %s", u->name, strerror(errno));
        status = STATUS_IO;
        goto fail;
    }
    *out = u;
    return STATUS_OK;

fail:
    dis_udp_close(u);
    return status;
}

void dis_udp_close(DisUdp *u)
{
    if (!u) return;
    if (u->running) {
        const uint64_t one = 1;
        atomic_store(&u->stopping, true);
        while (write(u->wake, &one, sizeof one) < 0 && errno == EINTR) {
        }
        pthread_join(u->thread, NULL);
    }
    if (u->socket >= 0) close(u->socket);
    if (u->wake >= 0) close(u->wake);
    if (u->link.watch >= 0) close(u->link.watch);
    pthread_mutex_destroy(&u->sending);
    pthread_cond_destroy(&u->arrived);
    pthread_cond_destroy(&u->turn);
    pthread_mutex_destroy(&u->queue);
    pthread_mutex_destroy(&u->receive);
    free(u->buffer);
    dis_ring_destroy(&u->ring);
    free(u);
}
