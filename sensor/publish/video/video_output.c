/* sensor/publish/video/video_output.c: the outputs of an encoded video: a file, cut back to its last whole frame when
 * a write fails, or a stream over UDP. */
#include "sensor/publish/video/video_output_private.h"
#include "pitviper_output.h"

#include <errno.h>
#include <stdlib.h>
#include <unistd.h>
#include <arpa/inet.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>

/* ---- a file -------------------------------------------------------------------------------------- */

enum { path_size = 4096 };

/* A video's file, which survives a disk that is full for a while.
 *
 * What is written between two marks is there as a whole or not at all: after a failure the file ends at the last
 * mark. */
typedef struct VideoFile {
    int     fd;
    int     error;                 /* errno of the last failure */
    bool    dropping;              /* until the next mark */
    int64_t position, end, marked; /* of writes; of the file; at the last mark */
    char    path[path_size];
} VideoFile;

/* Replaces what is there. Logged. */
static Status video_file_open(VideoFile **out, const char *path)
{
    VideoFile *f = calloc(1, sizeof *f);
    if (!f) return STATUS_NO_MEMORY;
    f->fd = snprintf(f->path, sizeof f->path, "%s", path) < (int)sizeof f->path ? output_open(path, 0)
                                                                                : (errno = ENAMETOOLONG, -1);
    if (f->fd < 0) {
        log_error("video: cannot write %s: %s; choose another name with --video", path, output_reason(errno));
        free(f);
        return STATUS_IO;
    }
    *out = f;
    return STATUS_OK;
}

static bool write_all(VideoFile *f, const uint8_t *bytes, size_t count)
{
    while (count > 0) {
        const ssize_t n = pwrite(f->fd, bytes, count, f->position);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) {
            f->error = n < 0 ? errno : ENOSPC;
            return false;
        }
        bytes += n;
        count -= (size_t)n;
        f->position += n;
        if (f->position > f->end) f->end = f->position;
    }
    return true;
}

/* False: it failed; what follows up to the next mark is dropped. */
static bool video_file_write(VideoFile *f, const uint8_t *bytes, size_t count)
{
    if (f->dropping) return false;
    if (write_all(f, bytes, count)) return true;
    f->dropping = true;
    if (ftruncate(f->fd, f->marked) != 0) f->error = errno;
    f->position = f->end = f->marked;
    return false;
}

static bool video_file_seek(VideoFile *f, int64_t position)
{
    if (position < 0 || position > f->end) return false;
    f->position = position;
    return true;
}

/* Returns whether everything since the last mark is in the file. */
static bool video_file_mark(VideoFile *f)
{
    const bool whole = !f->dropping;
    f->dropping = false;
    f->marked = f->end;
    return whole;
}

/* Gives the reason of the last failure. */
static const char *video_file_error(const VideoFile *f) { return strerror(f->error); }

/* Logged. NULL is valid. */
static Status video_file_close(VideoFile *f)
{
    if (!f) return STATUS_OK;
    const bool good = close(f->fd) == 0;
    if (!good) log_error("video: cannot write %s: %s", f->path, strerror(errno));
    free(f);
    return good ? STATUS_OK : STATUS_IO;
}

/* ---- MPEG-TS over UDP ---------------------------------------------------------------------------- */

/* Sources: ip(7), udp(7). A connected socket learns that its receiver is absent (ICMP) with a later send, which then
 * fails and sends nothing: that datagram is sent again at once. */

enum { send_buffer_octets = 4 << 20, url_size = 40 };
/* Without a refusal for so long the receiver is there again: routers limit how often they report. */
static const double back_after_s = 2;

struct VideoUdp {
    int                socket;
    struct sockaddr_in to;
    bool               connected;
    char               url[url_size];
    StreamCounters     counters;
    bool               away;           /* reported */
    double             refused_s;      /* wall clock: the last refusal */
    uint64_t           refused_before; /* when it was reported: refused, and without a route */
};

static bool set_flag(int socket, int level, int name, int value)
{
    return setsockopt(socket, level, name, &value, sizeof value) == 0;
}

/* Without a route sends fail until there is one. */
static bool is_no_route(int error)
{
    return error == ENETUNREACH || error == EHOSTUNREACH || error == ENETDOWN || error == EHOSTDOWN;
}

/* 0, or the error. */
static int connect_to(VideoUdp *u)
{
    u->connected = connect(u->socket, (const struct sockaddr *)&u->to, sizeof u->to) == 0;
    return u->connected ? 0 : errno;
}

static bool choose_interface(const VideoUdp *u, const char *interface)
{
    const struct ip_mreqn through = {.imr_ifindex = (int)if_nametoindex(interface)};
    return through.imr_ifindex && setsockopt(u->socket, IPPROTO_IP, IP_MULTICAST_IF, &through, sizeof through) == 0;
}

static uint64_t unsent(const StreamCounters *c) { return c->refused + c->no_route; }

/* Adds its counters to others; NULL: nowhere. Warns if not one datagram left. NULL is valid. */
static void video_udp_close(VideoUdp *u, StreamCounters *sum)
{
    if (!u) return;
    const StreamCounters *c = &u->counters;
    if (unsent(c) || c->lost)
        log_info("video: %s: datagrams: sent=%llu refused=%llu no_route=%llu lost=%llu", u->url,
                 (unsigned long long)c->sent, (unsigned long long)c->refused, (unsigned long long)c->no_route,
                 (unsigned long long)c->lost);
    if (c->sent == 0 && c->no_route)
        log_warn(
            "video: %s: there was never a route to it, so nothing was sent; check publish.stream and this machine's "
            "network (ip route get ADDRESS)",
            u->url);
    if (sum) {
        sum->sent += c->sent;
        sum->refused += c->refused;
        sum->no_route += c->no_route;
        sum->lost += c->lost;
    }
    if (u->socket >= 0) close(u->socket);
    free(u);
}

Status video_udp_open(VideoUdp **out, const StreamUrl *to, const char *interface, int ttl)
{
    const bool  group = publish_stream_multicast(to);
    const char *failed = NULL;
    VideoUdp   *u = calloc(1, sizeof *u);
    if (!u) return STATUS_NO_MEMORY;
    u->to = (struct sockaddr_in){.sin_family = AF_INET, .sin_port = htons(to->port)};
    memcpy(&u->to.sin_addr, to->address, sizeof to->address);
    snprintf(u->url, sizeof u->url, "udp://%u.%u.%u.%u:%u", to->address[0], to->address[1], to->address[2],
             to->address[3], to->port);
    u->socket = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (u->socket < 0) failed = "open a socket for";
    else if (group && *interface && !choose_interface(u, interface)) failed = "use network.interface for";
    else if (!set_flag(u->socket, IPPROTO_IP, IP_MULTICAST_TTL, ttl) ||
             !set_flag(u->socket, IPPROTO_IP, IP_MULTICAST_LOOP, 1) ||
             !set_flag(u->socket, SOL_SOCKET, SO_BROADCAST, 1))
        failed = "set the options of";
    const int reached = failed ? 0 : connect_to(u);
    if (reached && !is_no_route(reached)) {
        failed = "connect to";
        errno = reached;
    }
    if (failed) {
        log_error("video: cannot %s %s: %s", failed, u->url, strerror(errno));
        video_udp_close(u, NULL);
        return STATUS_IO;
    }
    set_flag(u->socket, SOL_SOCKET, SO_SNDBUF, send_buffer_octets); /* what the system allows is enough */
    *out = u;
    return STATUS_OK;
}

/* 0, or the error. */
static int try_send(VideoUdp *u, const uint8_t *bytes, size_t count)
{
    const int away = u->connected ? 0 : connect_to(u);
    return away ? away : send(u->socket, bytes, count, MSG_DONTWAIT | MSG_NOSIGNAL) >= 0 ? 0 : errno;
}

static void note_refused(VideoUdp *u, int error)
{
    u->refused_s = wall_clock_s();
    if (!u->away) {
        u->away = true;
        u->refused_before = unsent(&u->counters);
        if (error == ECONNREFUSED) log_info("video: %s: no program receives it at present; sending goes on", u->url);
        else log_warn("video: %s: no route to it: %s; sending goes on, for when there is one", u->url, strerror(error));
    }
    if (error == ECONNREFUSED) u->counters.refused++;
    else u->counters.no_route++;
}

static void note_sent(VideoUdp *u)
{
    u->counters.sent++;
    if (!u->away || wall_clock_s() - u->refused_s < back_after_s) return;
    u->away = false;
    log_info("video: %s: received again; %llu datagrams were not", u->url,
             (unsigned long long)(unsent(&u->counters) - u->refused_before));
}

/* count: at most 7 packets of 188 octets. */
static void video_udp_send(VideoUdp *u, const uint8_t *bytes, size_t count)
{
    int error = try_send(u, bytes, count);
    if (error == ECONNREFUSED) { /* of an earlier datagram; this one was not sent */
        note_refused(u, error);
        error = try_send(u, bytes, count);
    }
    if (error == 0) note_sent(u);
    else if (error == ECONNREFUSED || is_no_route(error)) note_refused(u, error);
    else u->counters.lost++;
}

/* ---- an output of either kind -------------------------------------------------------------------- */

static bool to_network(void *user, const uint8_t *bytes, size_t count)
{
    video_udp_send(user, bytes, count);
    return true;
}

static bool to_file(void *user, const uint8_t *bytes, size_t count) { return video_file_write(user, bytes, count); }
static bool seek_file(void *user, int64_t position) { return video_file_seek(user, position); }

static bool is_due(const VideoOutput *o) { return o->udp || !o->patient || wall_clock_s() >= o->retry.off_s; }

bool video_output_needs_key(const VideoOutput *o) { return (o->needs_key || !o->transport) && is_due(o); }

static void drop(VideoOutput *o)
{
    video_transport_close(o->transport, false);
    o->transport = NULL;
    if (o->file) video_file_close(o->file);
    o->file = NULL;
}

static Status open_output(VideoOutput *o, const Encoder *encoder)
{
    TransportConfig config = {
        .container = o->kind, .klv = o->klv, .title = o->title, .sink = {to_network, NULL, o->udp}};
    Status status = STATUS_OK;
    if (!o->udp) {
        status = video_file_open(&o->file, o->path);
        config.sink = (TransportSink){to_file, o->kind == VIDEO_TS ? NULL : seek_file, o->file};
    }
    if (status == STATUS_OK) status = video_transport_open(&o->transport, &config, encoder);
    if (status == STATUS_IO && o->file) log_error("video: cannot write %s: %s", o->path, video_file_error(o->file));
    if (status == STATUS_OK && o->file) video_file_mark(o->file);
    if (status != STATUS_OK) drop(o);
    return status;
}

/* Nothing can be decoded before a key frame. */
static bool begins(const VideoOutput *o, const VideoUnit *unit)
{
    return unit->packet.key || (!o->needs_key && o->transport);
}

static Status put(VideoOutput *o, const Encoder *encoder, const VideoUnit *unit)
{
    if (!begins(o, unit)) return STATUS_IO;
    Status status = o->transport ? STATUS_OK : open_output(o, encoder);
    if (status != STATUS_OK) return status;
    status = video_transport_put(o->transport, &unit->packet, unit->pts_90k, unit->klv, unit->klv_count);
    /* after a failure: whether the disk takes it is known at once */
    if (status == STATUS_OK && o->file && o->needs_key) status = video_transport_flush(o->transport);
    if (o->file && !video_file_mark(o->file)) status = STATUS_IO;
    o->needs_key = status != STATUS_OK;
    if (status != STATUS_OK && o->file) {
        log_error("video: cannot write %s: %s", o->path, video_file_error(o->file));
        video_transport_forget_positions(o->transport);
    }
    return status;
}

Status video_output_put(VideoOutput *o, const Encoder *encoder, const VideoUnit *unit)
{
    if (o->udp) {
        put(o, encoder, unit);
        return STATUS_OK;
    }
    if (!o->patient) return put(o, encoder, unit);
    const bool   due = begins(o, unit) && retry_due(&o->retry);
    const Status status = due ? put(o, encoder, unit) : STATUS_IO;
    if (!due) o->needs_key = true; /* it lacks a frame */
    retry_done(&o->retry, due, status);
    return STATUS_OK;
}

Status video_output_close(VideoOutput *o)
{
    Status status = STATUS_OK;
    if (o->transport) {
        status = video_transport_close(o->transport, true);
        o->transport = NULL;
    }
    if (o->file) {
        if (!video_file_mark(o->file) || status != STATUS_OK) {
            log_error("video: cannot write the end of %s: %s", o->path, video_file_error(o->file));
            status = STATUS_IO;
        }
        const Status closed = video_file_close(o->file);
        if (status == STATUS_OK) status = closed;
        o->file = NULL;
    }
    video_udp_close(o->udp, o->sent);
    o->udp = NULL;
    return o->patient ? STATUS_OK : status;
}
