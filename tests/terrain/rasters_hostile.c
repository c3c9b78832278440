/* tests/terrain/rasters_hostile.c: in the place of a reader of rasters: a file has taken it over, and its answers are
 * spoilt: of sound ones to begin with a field, some octets or all of it, one more often than another, while the program
 * reads them. */
#include "terrain/elevation/raster_child.h"

#include <limits.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <unistd.h>

static uint64_t state;

static uint32_t chance(uint32_t below)
{
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(state >> 33) % below;
}

static int32_t odd_number(void)
{
    static const int32_t some[] = {0,     1,     -1,        2,           3,           64,      4096,   65535,
                                   65536, 65537, 100000000, INT_MAX / 4, INT_MAX - 1, INT_MAX, INT_MIN};
    return chance(4) ? some[chance(sizeof some / sizeof *some)] : (int32_t)(chance(1u << 31) - (1u << 30));
}

static void spoil(void *what, size_t octets)
{
    uint8_t       *at = what;
    const uint32_t times = 1 + chance(3);
    for (uint32_t n = 0; n < times; n++) {
        const int32_t odd = odd_number();
        const size_t  place = chance((uint32_t)octets / 4) * 4;
        if (chance(3)) memcpy(at + place, &odd, sizeof odd);
        else at[chance((uint32_t)octets)] = (uint8_t)chance(256);
    }
}

static void answer(WireChannel *c)
{
    static const double bad[] = {0, -1, 1e308, (double)INFINITY, (double)NAN};
    const WireRequest  *q = &c->request;
    c->reply = (WireReply){.status = STATUS_OK, .count = 1 + (int32_t)chance(2)};
    WireRaster raster = {.posting_m = {1, 1},
                         .metres_per_unit = 1,
                         .data_share = 1,
                         .width = 40,
                         .height = 30,
                         .bands = 1,
                         .order = 1,
                         .row_block = 64,
                         .sheet_count = 1 + (int32_t)chance(3),
                         .sparse = (uint8_t)chance(2)};
    if (q->ask == WIRE_RASTER) {
        memcpy(c->data, &raster, sizeof raster);
        if (chance(3) == 0) spoil(c->data, sizeof raster);
        if (chance(6) == 0) memcpy(c->data + 8 * chance(4), &bad[chance(5)], 8);
    } else if (q->ask == WIRE_SHEETS) {
        const WireSheet sheet = {0, 0, 40, 30, 0, 8};
        for (int n = 0; n < 3; n++) {
            memcpy(c->data + n * 32, &sheet, sizeof sheet);
            memcpy(c->data + n * 32 + 24, "a/b.tif", 8);
        }
        c->reply.count = 1;
        if (chance(3) == 0) spoil(c->data, 96);
        if (chance(6) == 0) memset(c->data, 0xff, wire_data_octets);
    } else if (q->ask == WIRE_VECTORS) {
        const WireVectors v = {{{13, 47, 14, 48}}, 1, 1};
        memcpy(c->data, &v, sizeof v);
        if (chance(3) == 0) spoil(c->data, sizeof v);
        if (chance(6) == 0) memcpy(c->data + 8 * chance(4), &bad[chance(5)], 8);
    } else if (q->ask == WIRE_FEATURES) {
        static bool told; /* what there is, which a sound reader says once */
        size_t      at = 0;
        c->reply.count = told && chance(6) ? 0 : (int32_t)chance(5);
        told = true;
        for (int n = 0; n < 4; n++) {
            const WireFeature f = {
                .octets = sizeof f + 48 + 24, .shape = WIRE_POLYGON, .corners = 3, .tags = 1, .texts = 20};
            const double place[6] = {0.2269, 0.8204, 0.22691, 0.8204, 0.22691, 0.82041};
            memcpy(c->data + at, &f, sizeof f);
            memcpy(c->data + at + sizeof f, place, sizeof place);
            memcpy(c->data + at + sizeof f + 48, "building\0apartments", 20);
            at += f.octets;
        }
        if (chance(3) == 0) spoil(c->data, at);
        if (chance(6) == 0) memcpy(c->data + 40 + 8 * chance(6), &bad[chance(5)], 8);
        if (chance(20) == 0) memset(c->data, 0xff, wire_data_octets);
    } else if (q->ask >= WIRE_PX_FROM_EARTH) {
        for (size_t n = 0; n < 4096; n++) c->data[n] = (uint8_t)chance(256);
        c->reply.uniform = (int32_t)chance(2);
        c->reply.value = (float)bad[chance(5)];
    }
    if (chance(8) == 0) spoil(&c->reply, sizeof c->reply);
    if (chance(6) == 0) memset(c->at, 'x', sizeof c->at); /* no end */
    if (chance(3) == 0) {
        for (size_t n = 0; n < sizeof c->log; n++) c->log[n] = (char)(chance(4) ? 0x20 + chance(0x60) : chance(256));
        c->log[0] = (char)('0' + chance(6));
    }
    if (chance(40) == 0) _exit(7);
    if (chance(150) == 0) pause();
}

static void serve(const int descriptor[wire_descriptors])
{
    char         octet;
    WireChannel *channels =
        mmap(NULL, wire_channels * sizeof *channels, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor[wire_channels], 0);
    if (channels == MAP_FAILED) _exit(3);
    (void)!ftruncate(descriptor[wire_channels], 4096); /* the program would fault: the size is sealed */
    const pid_t spoiler = fork();
    if (spoiler == 0) /* answers change under the program's eyes */
        for (;;) {
            if (getppid() == 1) _exit(0);
            state++;
            spoil(&channels[0].reply, sizeof channels[0].reply);
            spoil(channels[0].data, 128);
            usleep(50);
        }
    while (read(descriptor[0], &octet, 1) == 1) {
        answer(&channels[0]);
        if (write(descriptor[0], &octet, chance(200) ? 1 : 0) < 0) break;
    }
    kill(spoiler, SIGKILL);
    _exit(0);
}

int main(void)
{
    static uint64_t started;
    for (;;) {
        WireOrder    order;
        struct iovec text = {&order, sizeof order};
        union {
            struct cmsghdr header;
            char           octets[CMSG_SPACE(wire_descriptors * sizeof(int))];
        } control;
        struct msghdr message = {
            .msg_iov = &text, .msg_iovlen = 1, .msg_control = &control, .msg_controllen = sizeof control};
        int descriptor[wire_descriptors], how = 0;
        if (recvmsg(wire_orders, &message, 0) != (ssize_t)sizeof order) return 0;
        int32_t answered = 0;
        if (order.kind == WIRE_START) {
            memcpy(descriptor, CMSG_DATA(CMSG_FIRSTHDR(&message)), sizeof descriptor);
            state = 977 * ++started;
            const pid_t process = fork();
            if (process == 0) {
                setpgid(0, 0);
                close(wire_orders);
                serve(descriptor);
            }
            answered = (int32_t)process;
            for (int n = 0; n < wire_descriptors; n++) close(descriptor[n]);
        } else {
            kill(-order.process, SIGKILL);
            kill(order.process, SIGKILL);
            waitpid(order.process, &how, 0);
            answered = how;
        }
        if (write(wire_orders, &answered, sizeof answered) < 0) return 0;
    }
}
