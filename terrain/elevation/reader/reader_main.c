/* terrain/elevation/reader/reader_main.c: `pitviper-rasters`: loads GDAL once, and forks a process for each set of
 * rasters, which reads it for the program under confinement, one thread a channel (raster_child.h). It ends when the
 * program's end of its socket closes, and each of those with it. */
#include "pitviper_confine.h"
#include "terrain/elevation/raster_child.h"
#include "terrain/elevation/reader/reader_private.h"

#include <cpl_conv.h>
#include <cpl_string.h>
#include <errno.h>
#include <ogr_srs_api.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

static RasterSet                  set;
static bool                       vectors; /* the process reads vectors, no rasters */
static WireChannel               *channels;
static int                        sockets[wire_channels];
static _Thread_local WireChannel *here; /* channel of the request that this thread works at */
static _Thread_local size_t       said; /* octets of its log so far */

void reader_works_at(const char *path)
{
    if (!here) return;
    snprintf(here->at, sizeof here->at, "%s", path);
    __atomic_fetch_add(&here->alive, 1, __ATOMIC_RELAXED);
}

/* Adds a line to the log that the program gets; lines that do not fit are left out. */
static void say(void *user, LogLevel level, const char *line)
{
    (void)user;
    const size_t octets = strlen(line) + 1;
    if (!here || said + octets + 2 > sizeof here->log) return;
    here->log[said] = (char)('0' + level);
    memcpy(here->log + said + 1, line, octets);
    said += octets + 1;
    here->log[said] = 0;
}

/* ---- confinement --------------------------------------------------------------------------------------- */

/* Folders of files that GDAL, PROJ and the C library open by themselves while they read: tables, and modules for
 * character sets. */
static char **own_folders(void)
{
    static const char *const fixed[] = {"/usr/share/gdal", "/usr/share/proj", "/usr/lib/x86_64-linux-gnu/gconv",
                                        "/usr/lib/aarch64-linux-gnu/gconv", "/usr/lib64/gconv"};
    static const char *const named[] = {"GDAL_DATA", "PROJ_DATA", "PROJ_LIB"};
    char                   **list = NULL;
    for (size_t k = 0; k < sizeof fixed / sizeof *fixed; k++) list = CSLAddString(list, fixed[k]);
    for (size_t k = 0; k < sizeof named / sizeof *named; k++) {
        char *folder = getenv(named[k]), *rest = NULL;
        char *copy = folder ? strdup(folder) : NULL;
        for (char *at = copy ? strtok_r(copy, ":", &rest) : NULL; at; at = strtok_r(NULL, ":", &rest))
            list = CSLAddString(list, at);
        free(copy);
    }
    char **proj = OSRGetPROJSearchPaths();
    for (int k = 0; proj && proj[k]; k++) list = CSLAddString(list, proj[k]);
    CSLDestroy(proj);
    return list;
}

static Status confine(const char *paths, bool within, const char *key)
{
    char   why[confine_why_size];
    char **folders = reader_source_folders(paths), **own = own_folders();
    if (!folders) return STATUS_NO_MEMORY;
    for (int k = 0; folders[k]; k++) own = CSLAddString(own, folders[k]);
    if (!own) return STATUS_NO_MEMORY;
    confine_limits((uint64_t)raster_most_memory_mb * 1000000);
    int count = 0;
    while (own[count]) count++;
    const bool held = confine_files(why, (const char *const *)own, count);
    reader_by_name = !held || within;
    if (!held) log_detail("%s: files are kept within their folders by name alone: %s", key, why);
    if (confine_calls(why)) return STATUS_OK;
    log_error(
        "%s: files from outside are not read without confinement, which this system refuses: %s; allow seccomp filters",
        key, why);
    return STATUS_IO;
}

/* ---- requests ------------------------------------------------------------------------------------------ */

static void *serve_channel(void *number);

static Status open_set(WireChannel *c, const char *key)
{
    const char *here_now = (const char *)c->data, *paths = here_now + strlen(here_now) + 1;
    const char *within = paths + strlen(paths) + 1, *from = within + strlen(within) + 1;
    char       *copy = strdup(paths);
    if (!copy) return STATUS_NO_MEMORY;
    if (*here_now && chdir(here_now) != 0)
        log_detail("%s: %s: %s", key, here_now, strerror(errno)); /* names may be absolute */
    Status status = reader_prepare();
    reader_source_begin(within, from);
    if (status == STATUS_OK) status = confine(copy, *within, key);
    for (intptr_t n = 1; n < wire_channels && status == STATUS_OK; n++) {
        pthread_t thread;
        if (pthread_create(&thread, NULL, serve_channel, (void *)n) != 0) status = STATUS_NO_MEMORY;
    }
    vectors = c->request.ask == WIRE_VECTORS;
    if (status == STATUS_OK && vectors) {
        WireVectors found;
        status = reader_vectors_open(&found, copy, key);
        if (status == STATUS_OK) memcpy(c->data, &found, sizeof found);
    } else if (status == STATUS_OK) status = reader_set_open(&set, copy, key);
    free(copy);
    c->reply.count = set.count;
    return status;
}

static Status tell_features(WireChannel *c)
{
    WireBox box;
    memcpy(&box, c->data, sizeof box);
    return reader_features(c->data, &c->reply.count, &box, c->request.key);
}

static Status tell_raster(WireChannel *c, const Raster *r)
{
    const RasterStated *t = &r->stated;
    const RasterChoice *u = &r->choice;
    WireRaster          w = {.posting_m = {r->posting_m[0], r->posting_m[1]},
                             .metres_per_unit = r->metres_per_unit,
                             .data_share = r->data_share,
                             .width = r->width,
                             .height = r->height,
                             .bands = r->bands,
                             .vertical = (int32_t)u->vertical,
                             .order = r->order,
                             .row_block = r->row_block,
                             .sheet_count = r->sheet_count,
                             .ellipsoidal = r->ellipsoidal,
                             .bytes = r->bytes,
                             .whole = r->whole,
                             .sparse = r->sparse,
                             .crs_unit_m = t->crs_unit_m,
                             .unit_of_crs = t->unit_of_crs,
                             .down = t->down,
                             .coloured = t->coloured,
                             .grey = t->grey,
                             .has_nodata = t->has_nodata,
                             .nodata = t->nodata,
                             .band = u->band,
                             .sense = u->sense,
                             .has_void = u->has_void,
                             .no_void = u->no_void,
                             .void_value = u->void_value};
    memcpy(w.type, t->type, sizeof w.type);
    memcpy(w.unit, t->unit, sizeof w.unit);
    memcpy(w.crs, t->crs, sizeof w.crs);
    memcpy(w.crs_unit, t->crs_unit, sizeof w.crs_unit);
    memcpy(w.vertical_name, t->vertical, sizeof w.vertical_name);
    memcpy(w.chosen_unit, u->unit, sizeof w.chosen_unit);
    memcpy(c->data, &w, sizeof w);
    return STATUS_OK;
}

static Status tell_sheets(WireChannel *c, const Raster *r)
{
    size_t at = 0;
    int    n = c->request.first;
    for (; n < r->sheet_count; n++) {
        const RasterSheet *s = &r->sheet[n];
        const size_t       octets = strlen(s->path) + 1;
        const WireSheet    w = {s->x0, s->y0, s->width, s->height, s->band, (int32_t)octets};
        if (wire_data_octets - at < sizeof w + octets + 8) break;
        memcpy(c->data + at, &w, sizeof w);
        memcpy(c->data + at + sizeof w, s->path, octets);
        at += sizeof w + (octets + 7) / 8 * 8;
    }
    c->reply.count = n - c->request.first;
    return STATUS_OK;
}

static Status answer(WireChannel *c)
{
    const WireRequest *q = &c->request;
    if (q->ask == WIRE_OPEN || q->ask == WIRE_VECTORS)
        return set.count || vectors ? STATUS_BAD_VALUE : open_set(c, q->key);
    if (q->ask == WIRE_FEATURES) return vectors ? tell_features(c) : STATUS_BAD_VALUE;
    if (q->raster < 0 || q->raster >= set.count) return STATUS_BAD_VALUE;
    Raster limited = set.raster[q->raster]; /* voids are numbers outside of the range in this request */
    limited.low = q->low, limited.high = q->high;
    const Raster *raster = &limited;
    switch ((WireAsk)q->ask) {
    case WIRE_RASTER:
        return tell_raster(c, raster);
    case WIRE_SHEETS:
        return tell_sheets(c, raster);
    case WIRE_PX_FROM_EARTH:
    case WIRE_EARTH_FROM_PX: {
        double *x = (double *)(void *)c->data;
        (q->ask == WIRE_PX_FROM_EARTH ? reader_px_from_earth : reader_earth_from_px)(raster, q->count, x, x + q->count);
        return STATUS_OK;
    }
    case WIRE_UNIFORM:
        c->reply.uniform = reader_uniform(&c->reply.value, raster, q->first,
                                          (RasterWindow){q->x0, q->y0, q->width, q->height}, q->key);
        return STATUS_OK;
    case WIRE_READ:
        if (raster->sparse)
            c->reply.uniform = reader_uniform(&c->reply.value, raster, q->first,
                                              (RasterWindow){q->x0, q->y0, q->width, q->height}, q->key);
        if (c->reply.uniform) return STATUS_OK;
        return reader_read((float *)(void *)c->data, raster, q->first,
                           (RasterWindow){q->x0, q->y0, q->width, q->height}, q->key);
    case WIRE_READ_BYTES: {
        uint8_t *valid = c->data + (size_t)q->width * (size_t)q->height * (size_t)q->count;
        return reader_read_bytes(c->data, valid, raster, q->first, q->count,
                                 (RasterWindow){q->x0, q->y0, q->width, q->height}, q->key);
    }
    default:
        return STATUS_BAD_VALUE;
    }
}

static void *serve_channel(void *number)
{
    const intptr_t n = (intptr_t)number;
    const int      socket = sockets[n];
    thread_flush_denormals();
    for (here = &channels[n];;) {
        char          octet;
        const ssize_t got = read(socket, &octet, 1);
        if (got < 0 && errno == EINTR) continue;
        if (got != 1) _exit(0); /* the program does not need this process any more, or has ended */
        said = 0;
        here->log[0] = 0;
        here->reply = (WireReply){.status = STATUS_IO};
        here->reply.status = (int32_t)answer(here);
        if (write(socket, &octet, 1) != 1) _exit(0);
    }
}

/* ---- processes ----------------------------------------------------------------------------------------- */

/* Runs in the process of one set: opens it, and answers requests. */
static void read_set(const int descriptor[wire_descriptors], pid_t parent)
{
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(0);
    close(wire_orders);
    memcpy(sockets, descriptor, sizeof sockets);
    channels =
        mmap(NULL, wire_channels * sizeof *channels, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor[wire_channels], 0);
    close(descriptor[wire_channels]);
    if (channels == MAP_FAILED) _exit(3);
    log_set_sink(say, NULL);
    log_set_level(LOG_DETAIL);
    serve_channel(NULL);
}

/* Reads the next order. Returns false when the program has ended. descriptor[0] is -1 when no descriptors came with the
 * order. */
static bool next_order(WireOrder *order, int descriptor[wire_descriptors])
{
    struct iovec text = {order, sizeof *order};
    union {
        struct cmsghdr header;
        char           octets[CMSG_SPACE(wire_descriptors * sizeof(int))];
    } control;
    struct msghdr message = {
        .msg_iov = &text, .msg_iovlen = 1, .msg_control = &control, .msg_controllen = sizeof control};
    ssize_t got;
    do got = recvmsg(wire_orders, &message, MSG_CMSG_CLOEXEC);
    while (got < 0 && errno == EINTR);
    const struct cmsghdr *c = got > 0 ? CMSG_FIRSTHDR(&message) : NULL;
    descriptor[0] = -1;
    if (c && c->cmsg_type == SCM_RIGHTS && c->cmsg_len == CMSG_LEN(wire_descriptors * sizeof(int)))
        memcpy(descriptor, CMSG_DATA(c), wire_descriptors * sizeof(int));
    return got == (ssize_t)sizeof *order;
}

int main(void)
{
    static const int left_to_the_program[] = {SIGHUP,  SIGINT,  SIGQUIT, SIGTERM, SIGUSR1,
                                              SIGUSR2, SIGALRM, SIGPIPE, SIGTSTP};
    const pid_t      self = getpid();
    WireOrder        order;
    int              descriptor[wire_descriptors];
    for (size_t k = 0; k < sizeof left_to_the_program / sizeof *left_to_the_program; k++)
        signal(left_to_the_program[k], SIG_IGN);
    signal(SIGCHLD, SIG_DFL);
    close_range(wire_orders + 1, ~0u, 0);
    log_suppress(true); /* errors are reported by the process that is asked for a set */
    (void)reader_prepare();
    log_suppress(false);
    while (next_order(&order, descriptor)) {
        int32_t answer = -EINVAL;
        int     how = 0;
        if (order.kind == WIRE_START && descriptor[0] >= 0) {
            const pid_t process = fork();
            if (process == 0) read_set(descriptor, self);
            answer = process > 0 ? (int32_t)process : -errno;
            for (int n = 0; n < wire_descriptors; n++) close(descriptor[n]);
        } else if (order.kind == WIRE_END && order.process > 0) {
            kill(order.process, SIGKILL); /* a process that has ended already keeps its own status */
            while (waitpid(order.process, &how, 0) < 0 && errno == EINTR) {
            }
            answer = how;
        }
        if (write(wire_orders, &answer, sizeof answer) != (ssize_t)sizeof answer) break;
    }
    _exit(0);
}
