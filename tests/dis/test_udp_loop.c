/* tests/dis/test_udp_loop.c: datagrams by loopback, against plain sockets: every kind of address, order and arrival
 * times, the rule that closes a tick while a flood runs, and that what was lost is counted.
 *
 * PITVIPER_TEST_INTERFACE and PITVIPER_TEST_BROADCAST name an interface and its broadcast for the tests that many hear:
 * tests/system/test_network.sh makes one that nobody else has. */
#include "tests/dis/udp_peer.h"

#include "dis/network/udp.h"

#include <errno.h>
#include <linux/filter.h>
#include <pthread.h>
#include <stdatomic.h>

static uint8_t payload[dis_max_datagram + 1];

static DisUdpConfig config_for(const char *address, const char *interface, int port)
{
    DisUdpConfig config = dis_udp_default_config();
    snprintf(config.address, sizeof config.address, "%s", address);
    snprintf(config.interface, sizeof config.interface, "%s", interface);
    config.port = port;
    return config;
}

static Status open_quietly(DisUdp **out, const DisUdpConfig *config)
{
    check_said[0] = 0;
    log_set_sink(check_listen, NULL);
    const Status status = dis_udp_open(out, config);
    log_set_sink(NULL, NULL);
    return status;
}

static DisUdp *open_unicast(int port)
{
    const DisUdpConfig config = config_for("127.0.0.1", "", port);
    DisUdp            *udp = NULL;
    CHECK(dis_udp_open(&udp, &config) == STATUS_OK);
    return udp;
}

static bool take(DisArrival *out, DisUdp *udp)
{
    return dis_udp_wait(udp, dis_udp_now_ns() + peer_patience_ns) && dis_udp_take(out, udp, INT64_MAX);
}

static uint32_t number_of(const DisArrival *arrival)
{
    uint32_t number;
    CHECK(arrival->octets >= sizeof number);
    memcpy(&number, arrival->bytes, sizeof number);
    return number;
}

static bool send_number(int peer, uint32_t number, size_t octets)
{
    memcpy(payload, &number, sizeof number);
    return send(peer, payload, octets, 0) == (ssize_t)octets;
}

static const char *test_interface(void)
{
    const char *name = getenv("PITVIPER_TEST_INTERFACE");
    return name ? name : "lo";
}

/* ---- every kind of address ----------------------------------------------------------------------------- */

static void unicast(bool v6)
{
    static const size_t sizes[] = {0, 1, 144, 1400, 9000, 65507};
    const DisUdpConfig  config = config_for(v6 ? "::1" : "127.0.0.1", "", free_port());
    const int           peer = peer_socket(v6, config.port);
    DisUdp             *udp;
    if (peer < 0 || open_quietly(&udp, &config) != STATUS_OK) {
        CHECK(v6);
        printf("skipped: no IPv6 here (%s)\n", check_said);
        skip();
    }
    for (size_t i = 0; i < sizeof payload; i++) payload[i] = (uint8_t)(i * 7 + (i >> 8));

    struct sockaddr_in6 self;
    socklen_t           octets = sizeof self;
    CHECK(getsockname(peer, (struct sockaddr *)&self, &octets) == 0);
    uint8_t from[16] = {[10] = 0xFF, [11] = 0xFF, [12] = 127, [15] = 1};
    if (v6) memcpy(from, &self.sin6_addr, sizeof from);

    int64_t before_ns = dis_udp_now_ns(), sum = 0;
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        DisArrival a;
        CHECK(send(peer, payload, sizes[i], 0) == (ssize_t)sizes[i]);
        CHECK(take(&a, udp) && a.octets == sizes[i] && memcmp(a.bytes, payload, sizes[i]) == 0);
        CHECK(a.capture_ns >= before_ns && a.capture_ns <= dis_udp_now_ns());
        CHECK(memcmp(a.from, from, sizeof from) == 0 && a.from_port == ntohs(self.sin6_port));
        before_ns = a.capture_ns;
        sum += (int64_t)sizes[i];
    }
    const DisUdpCounters counters = dis_udp_counters(udp);
    CHECK(counters.datagrams == sizeof sizes / sizeof *sizes && (int64_t)counters.octets == sum);
    CHECK(counters.lost_kernel == 0 && counters.lost_queue == 0);
    close(peer);
    dis_udp_close(udp);
}

static void unicast_v4_arrives_whole(void **state)
{
    (void)state;
    unicast(false);
}

static void unicast_v6_arrives_whole(void **state)
{
    (void)state;
    unicast(true);
}

static void a_peer_is_answered_by_whoever_calls(void **state)
{
    (void)state;
    const DisUdpConfig config = config_for("192.0.2.1", "", free_port()); /* kept for documents: nobody's here */
    const int          peer = peer_socket(false, config.port);
    DisUdp            *udp, *second = NULL;
    DisArrival         a;
    CHECK(open_quietly(&udp, &config) == STATUS_OK);
    CHECK(send(peer, payload, 7, 0) == 7 && take(&a, udp) && a.octets == 7);
    CHECK(open_quietly(&second, &config) == STATUS_IO && second == NULL);
    close(peer);
    dis_udp_close(udp);
}

/* Two that listen and one that sends: both hear, each all of it. other: an address at the same port that they must not
 * hear; NULL: there is none. */
static void shared(const char *address, const char *other)
{
    const char        *interface = test_interface();
    const DisUdpConfig config = config_for(address, interface, free_port());
    DisUdp            *a = NULL, *b = NULL, *sender = NULL;
    DisArrival         at_a, at_b;
    const uint8_t      word[3] = {5, 6, 7};
    if (open_quietly(&a, &config) != STATUS_OK || open_quietly(&b, &config) != STATUS_OK) {
        printf("skipped: %s\n", check_said);
        dis_udp_close(a);
        skip();
    }
    CHECK(dis_udp_open_sender(&sender, &config) == STATUS_OK);
    if (dis_udp_send(sender, word, sizeof word) != STATUS_OK) {
        printf("skipped: this kernel has no way to %s on %s: %s\n", address, interface, strerror(errno));
        dis_udp_close(sender);
        dis_udp_close(b);
        dis_udp_close(a);
        skip();
    }
    CHECK(take(&at_a, a) && at_a.octets == 3 && memcmp(at_a.bytes, word, 3) == 0);
    CHECK(take(&at_b, b) && at_b.octets == 3 && memcmp(at_b.bytes, word, 3) == 0);
    if (other) {
        /* somebody of this machine does hear it, so it does come in */
        const DisUdpConfig elsewhere = config_for(other, interface, config.port);
        DisUdp            *stranger;
        DisArrival         at_stranger;
        CHECK(dis_udp_open(&stranger, &elsewhere) == STATUS_OK);
        CHECK(dis_udp_send(stranger, word, 2) == STATUS_OK);
        CHECK(take(&at_stranger, stranger) && at_stranger.octets == 2);
        dis_udp_close(stranger);
    }
    /* a listener sends too, and hears itself; what came first would have come first */
    CHECK(dis_udp_send(a, word, 1) == STATUS_OK);
    CHECK(take(&at_a, a) && at_a.octets == 1);
    CHECK(take(&at_b, b) && at_b.octets == 1);
    CHECK(dis_udp_counters(a).sent == 1 && dis_udp_counters(sender).sent == 1);
    dis_udp_close(sender);
    dis_udp_close(b);
    dis_udp_close(a);
}

static void multicast_v4_is_heard_by_all_of_the_group(void **state)
{
    (void)state;
    shared("239.1.2.3", "239.1.2.4");
}

static void no_loopback(void)
{
    if (strcmp(test_interface(), "lo") != 0) return;
    printf("skipped: Linux brings no IPv6 multicast back on lo; tests/system/test_network.sh has another interface\n");
    skip();
}

static void multicast_v6_is_heard_by_all_of_the_group(void **state)
{
    (void)state;
    no_loopback();
    shared("ff15::d15", "ff15::d16");
}

static void link_local_multicast_v6_needs_its_interface(void **state)
{
    (void)state;
    const DisUdpConfig nowhere = config_for("ff02::d15", "", free_port());
    DisUdp            *udp;
    CHECK(open_quietly(&udp, &nowhere) == STATUS_BAD_VALUE && strstr(check_said, "lo"));
    no_loopback();
    shared("ff02::d15", "ff02::d16");
}

static void broadcast_is_heard_by_all(void **state)
{
    (void)state;
    const char *address = getenv("PITVIPER_TEST_BROADCAST");
    shared(address ? address : "127.255.255.255", NULL);
}

static void broadcast_to_nowhere_in_particular_is_heard_by_all(void **state)
{
    (void)state;
    shared("", NULL);
}

/* ---- arrival times ---------------------------------------------------------------------------------------- */

typedef struct Flood {
    int         peer;
    uint32_t    sent;
    atomic_bool stop;
    pthread_t   thread;
} Flood;

/* Some ten thousand a second: several in each tick, and no more than a sanitizer's build can take. */
static void *flood_loop(void *user)
{
    Flood *flood = user;
    while (!atomic_load(&flood->stop)) {
        if (send(flood->peer, &flood->sent, sizeof flood->sent, 0) == sizeof flood->sent) flood->sent++;
        if (flood->sent % 4 == 0) usleep(200);
    }
    return NULL;
}

static void flood_begin(Flood *flood, int port)
{
    *flood = (Flood){.peer = peer_socket(false, port)};
    CHECK(flood->peer >= 0 && pthread_create(&flood->thread, NULL, flood_loop, flood) == 0);
}

static void flood_end(Flood *flood)
{
    atomic_store(&flood->stop, true);
    pthread_join(flood->thread, NULL);
    close(flood->peer);
}

/* Everything sent is off the socket or counted as lost; then what waits is no more than a take away. */
static DisUdpCounters settled(DisUdp *udp, uint64_t sent)
{
    const int64_t  until_ns = dis_udp_now_ns() + peer_patience_ns;
    DisUdpCounters counters;
    while (counters = dis_udp_counters(udp), counters.datagrams + counters.lost_kernel < sent) {
        if (dis_udp_now_ns() > until_ns)
            fail_msg("%llu of %llu came", (unsigned long long)counters.datagrams, (unsigned long long)sent);
        usleep(1000);
    }
    return counters;
}

static void a_tick_stays_closed_under_a_flood(void **state)
{
    (void)state;
    const int  port = free_port();
    DisUdp    *udp = open_unicast(port);
    Flood      flood;
    DisArrival a;
    int64_t    closed_ns = 0, last_ns = 0, next = 0;
    uint64_t   taken = 0;
    flood_begin(&flood, port);
    for (int tick = 0; tick < 300; tick++) {
        CHECK(dis_udp_wait(udp, dis_udp_now_ns() + peer_patience_ns));
        /* every third tick ends before now: what came since must wait, though it is in the queue */
        const int64_t until_ns = dis_udp_now_ns() - (tick % 3 == 0 ? 200000 : 0);
        if (until_ns <= closed_ns) continue;
        dis_udp_close_tick(udp, until_ns);
        while (dis_udp_take(&a, udp, until_ns)) {
            CHECK(a.capture_ns > closed_ns && a.capture_ns <= until_ns && a.capture_ns >= last_ns);
            CHECK(number_of(&a) >= next);
            last_ns = a.capture_ns;
            next = (int64_t)number_of(&a) + 1;
            taken++;
        }
        closed_ns = until_ns;
        usleep(100);
        CHECK(!dis_udp_take(&a, udp, until_ns)); /* whatever came meanwhile */
    }
    flood_end(&flood);
    const DisUdpCounters counters = settled(udp, flood.sent);
    while (dis_udp_take(&a, udp, INT64_MAX)) {
        CHECK(a.capture_ns > closed_ns && a.capture_ns >= last_ns && number_of(&a) >= next);
        last_ns = a.capture_ns;
        next = (int64_t)number_of(&a) + 1;
        taken++;
    }
    CHECK(taken > 300);
    CHECK(counters.datagrams + counters.lost_kernel == flood.sent && taken + counters.lost_queue == counters.datagrams);
    dis_udp_close(udp);
}

static void what_comes_after_its_tick_stands_right_behind_it(void **state)
{
    (void)state;
    const int     port = free_port(), peer = peer_socket(false, port);
    DisUdp       *udp = open_unicast(port);
    const int64_t hour_ns = 3600000000000;
    const int64_t until_ns = dis_udp_now_ns() + hour_ns; /* later than any stamp of the kernel */
    DisArrival    a;
    CHECK(send_number(peer, 1, 8) && dis_udp_wait(udp, dis_udp_now_ns() + peer_patience_ns));
    dis_udp_close_tick(udp, until_ns);
    CHECK(send_number(peer, 2, 8) && send_number(peer, 3, 8));
    settled(udp, 3);
    CHECK(dis_udp_take(&a, udp, until_ns) && number_of(&a) == 1 && a.capture_ns < until_ns - hour_ns / 2);
    CHECK(!dis_udp_take(&a, udp, until_ns));
    for (uint32_t number = 2; number <= 3; number++)
        CHECK(dis_udp_take(&a, udp, until_ns + 1) && number_of(&a) == number && a.capture_ns == until_ns + 1);
    dis_udp_close_tick(udp, until_ns - hour_ns); /* an earlier tick opens nothing again */
    CHECK(send_number(peer, 4, 8));
    CHECK(take(&a, udp) && a.capture_ns == until_ns + 1);
    close(peer);
    dis_udp_close(udp);
}

/* What has come to the socket when a tick closes is in that tick, though the thread had no time for it yet: bursts of
 * several batches, closed at once. The kernel may finish a delivery after the call that sent it, so not all need be. */
static void a_closing_tick_empties_the_socket(void **state)
{
    (void)state;
    enum { rounds = 100, burst = 200 };
    const int  port = free_port(), peer = peer_socket(false, port);
    DisUdp    *udp = open_unicast(port);
    DisArrival a;
    uint32_t   sent = 0, taken = 0, in_time = 0;
    for (int round = 0; round < rounds; round++) {
        for (int i = 0; i < burst; i++) CHECK(send_number(peer, sent++, 100));
        const int64_t until_ns = dis_udp_now_ns();
        dis_udp_close_tick(udp, until_ns);
        for (; dis_udp_take(&a, udp, until_ns); taken++, in_time++) CHECK(number_of(&a) == taken);
        settled(udp, sent);
        for (; dis_udp_take(&a, udp, INT64_MAX); taken++) CHECK(a.capture_ns > until_ns && number_of(&a) == taken);
    }
    CHECK(taken == sent && in_time > sent / 2);
    close(peer);
    dis_udp_close(udp);
}

static void waiting_ends(void **state)
{
    (void)state;
    const int  port = free_port(), peer = peer_socket(false, port);
    DisUdp    *udp = open_unicast(port);
    DisArrival a;
    CHECK(!dis_udp_wait(udp, 0) && !dis_udp_wait(udp, INT64_MIN)); /* long past */
    const int64_t until_ns = dis_udp_now_ns() + 20000000;
    CHECK(!dis_udp_wait(udp, until_ns) && dis_udp_now_ns() >= until_ns);
    CHECK(send_number(peer, 1, 4) && dis_udp_wait(udp, INT64_MAX));
    CHECK(dis_udp_wait(udp, 0) && dis_udp_take(&a, udp, INT64_MAX) && !dis_udp_wait(udp, 0));
    close(peer);
    dis_udp_close(udp);
}

/* ---- losses ------------------------------------------------------------------------------------------------ */

typedef struct Tapped {
    uint64_t count;
    int64_t  last;
    bool     disordered;
} Tapped;

static void tap(void *user, const DisArrival *a)
{
    Tapped *t = user;
    t->disordered |= number_of(a) <= t->last;
    t->last = number_of(a);
    t->count++;
}

static void a_full_queue_keeps_the_oldest_and_counts_the_rest(void **state)
{
    (void)state;
    Tapped tapped = {.last = -1};
    enum { sent = 1000, octets = 1000, room = 131072 / 1056 }; /* 32 + 1000 in units of 32 */
    DisUdpConfig config = config_for("127.0.0.1", "", free_port());
    config.queue_octets = 131072;
    DisUdp    *udp;
    DisArrival a;
    const int  peer = peer_socket(false, config.port);
    CHECK(dis_udp_open(&udp, &config) == STATUS_OK);
    dis_udp_tap(udp, tap, &tapped);
    for (uint32_t i = 0; i < sent; i++) CHECK(send_number(peer, i, octets));
    DisUdpCounters counters = settled(udp, sent);
    CHECK(counters.datagrams + counters.lost_kernel == sent && counters.octets == counters.datagrams * octets);
    int64_t  last = -1;
    uint64_t taken = 0;
    while (dis_udp_take(&a, udp, INT64_MAX)) {
        CHECK(number_of(&a) > last && a.octets == octets);
        last = number_of(&a);
        taken++;
    }
    CHECK(taken == room && taken + counters.lost_queue == counters.datagrams);
    if (!counters.lost_kernel) CHECK(last == room - 1); /* the oldest */
    dis_udp_tap(udp, NULL, NULL);
    CHECK(tapped.count == counters.datagrams && !tapped.disordered); /* also those that found no room */
    CHECK(send_number(peer, sent, octets) && take(&a, udp) && number_of(&a) == sent); /* and it goes on */
    CHECK(tapped.count == counters.datagrams);
    close(peer);
    dis_udp_close(udp);
}

static void what_was_taken_stays_until_the_next_take(void **state)
{
    (void)state;
    DisUdpConfig config = config_for("127.0.0.1", "", free_port());
    config.queue_octets = 131072;
    DisUdp    *udp;
    DisArrival a;
    const int  peer = peer_socket(false, config.port);
    CHECK(dis_udp_open(&udp, &config) == STATUS_OK);
    memset(payload, 0, sizeof payload);
    CHECK(send_number(peer, 7, 1000) && take(&a, udp));
    memset(payload, 0xEE, sizeof payload);
    for (uint32_t i = 0; i < 1000; i++) CHECK(send_number(peer, 0xEEEEEEEE, 1000));
    CHECK(settled(udp, 1001).lost_queue > 0);
    CHECK(number_of(&a) == 7);
    for (int k = 4; k < 1000; k++) CHECK(a.bytes[k] == 0);
    close(peer);
    dis_udp_close(udp);
}

static void the_queue_wraps_with_any_sizes(void **state)
{
    (void)state;
    DisUdpConfig config = config_for("127.0.0.1", "", free_port());
    config.queue_octets = 131072 + 17; /* need not be whole units */
    DisUdp    *udp;
    DisArrival a = {0};
    const int  peer = peer_socket(false, config.port);
    CHECK(dis_udp_open(&udp, &config) == STATUS_OK);
    uint64_t index = 0;
    uint32_t sent = 0, next = 0;
    for (int round = 0; round < 400; round++) {
        /* at most 8 of 4000, or one of any size: they always fit beside one that is held */
        const bool large = round % 5 == 0;
        const int  count = large ? 1 : 1 + (int)(8 * random_uniform(1, 2, 3, index++));
        uint32_t   octets[8];
        for (int i = 0; i < count; i++) {
            octets[i] = 4 + (uint32_t)((large ? 61000 : 4000) * random_uniform(1, 2, 3, index++));
            for (uint32_t k = 4; k < octets[i]; k++) payload[k] = (uint8_t)(k * sent);
            CHECK(send_number(peer, sent++, octets[i]));
        }
        settled(udp, sent);
        for (int i = 0; i < count; i++) {
            CHECK(dis_udp_take(&a, udp, INT64_MAX) && a.octets == octets[i] && number_of(&a) == next);
            for (uint32_t k = 4; k < octets[i]; k++) CHECK(a.bytes[k] == (uint8_t)(k * next));
            next++;
        }
    }
    const DisUdpCounters counters = dis_udp_counters(udp);
    CHECK(counters.datagrams == sent && counters.lost_queue == 0 && counters.lost_kernel == 0);
    close(peer);
    dis_udp_close(udp);
}

static void what_the_kernel_dropped_is_counted(void **state)
{
    (void)state;
    /* a filter that lets nothing through counts as the full socket does: in the socket's drops */
    struct sock_filter      refuse[] = {{.code = BPF_RET | BPF_K, .k = 0}};
    const struct sock_fprog program = {1, refuse};
    const int               port = free_port(), peer = peer_socket(false, port), none = 0;
    DisUdp                 *udp = open_unicast(port);
    DisArrival              a;
    const int               inner = socket_at_port(port);
    CHECK(inner >= 0);
    if (setsockopt(inner, SOL_SOCKET, SO_ATTACH_FILTER, &program, sizeof program) != 0) {
        printf("skipped: this kernel takes no socket filter: %s\n", strerror(errno));
        close(peer);
        dis_udp_close(udp);
        skip();
    }
    for (uint32_t i = 0; i < 10; i++) CHECK(send_number(peer, i, 100));
    const DisUdpCounters counters = settled(udp, 10); /* with nothing arriving that could bring the count */
    CHECK(counters.lost_kernel == 10 && counters.datagrams == 0);
    CHECK(setsockopt(inner, SOL_SOCKET, SO_DETACH_FILTER, &none, sizeof none) == 0);
    CHECK(send_number(peer, 10, 100) && take(&a, udp) && number_of(&a) == 10);
    CHECK(dis_udp_counters(udp).lost_kernel == 10 && dis_udp_counters(udp).datagrams == 1);
    close(peer);
    dis_udp_close(udp);
}

static void a_small_socket_buffer_loses_nothing_uncounted(void **state)
{
    (void)state;
    const int port = free_port(), peer = peer_socket(false, port), least = 1;
    DisUdp   *udp = open_unicast(port);
    CHECK(setsockopt(socket_at_port(port), SOL_SOCKET, SO_RCVBUF, &least, sizeof least) == 0);
    for (uint32_t i = 0; i < 20000; i++) CHECK(send_number(peer, i, 200));
    const DisUdpCounters counters = settled(udp, 20000);
    CHECK(counters.datagrams + counters.lost_kernel == 20000);
    DisArrival a;
    int64_t    last = -1;
    uint64_t   taken = 0;
    while (dis_udp_take(&a, udp, INT64_MAX)) {
        CHECK(number_of(&a) > last);
        last = number_of(&a);
        taken++;
    }
    CHECK(taken == counters.datagrams && counters.lost_queue == 0);
    close(peer);
    dis_udp_close(udp);
}

static void what_cannot_be_sent_is_counted(void **state)
{
    (void)state;
    const DisUdpConfig config = config_for("127.0.0.1", "", free_port());
    DisUdp            *sender;
    CHECK(dis_udp_open_sender(&sender, &config) == STATUS_OK);
    CHECK(dis_udp_send(sender, payload, 65508) == STATUS_IO); /* more than IPv4 carries */
    CHECK(dis_udp_send(sender, payload, 100) == STATUS_OK);   /* nobody listens: the network does not say */
    CHECK(dis_udp_send(sender, payload, 100) == STATUS_OK);
    const DisUdpCounters counters = dis_udp_counters(sender);
    CHECK(counters.sent == 2 && counters.send_failed == 1 && counters.datagrams == 0);
    uint8_t to[16];
    dis_udp_destination(to, sender);
    CHECK(memcmp(to, (const uint8_t[16]){[10] = 0xFF, [11] = 0xFF, [12] = 127, [15] = 1}, 16) == 0);
    dis_udp_close(sender);
}

/* ---- life --------------------------------------------------------------------------------------------------- */

static void it_stops_in_the_middle_of_a_flood(void **state)
{
    (void)state;
    const int port = free_port();
    Flood     flood;
    flood_begin(&flood, port); /* into the void first */
    for (int i = 0; i < 30; i++) {
        DisArrival a;
        DisUdp    *udp = open_unicast(port);
        CHECK(take(&a, udp));
        if (i % 2) dis_udp_close_tick(udp, dis_udp_now_ns());
        dis_udp_close(udp);
    }
    flood_end(&flood);
    dis_udp_close(NULL);
}

typedef struct Talker {
    DisUdp   *udp;
    pthread_t thread;
} Talker;

static void *talk(void *user)
{
    static const uint8_t word[64];
    for (int i = 0; i < 500; i++) CHECK(dis_udp_send(((Talker *)user)->udp, word, sizeof word) == STATUS_OK);
    return NULL;
}

static void many_may_send_while_one_takes(void **state)
{
    (void)state;
    DisUdp    *udp = open_unicast(free_port()); /* sends to itself */
    Talker     talker[4];
    DisArrival a;
    for (int i = 0; i < 4; i++) {
        talker[i].udp = udp;
        CHECK(pthread_create(&talker[i].thread, NULL, talk, &talker[i]) == 0);
    }
    for (int i = 0; i < 2000; i++) CHECK(take(&a, udp) && a.octets == 64);
    for (int i = 0; i < 4; i++) pthread_join(talker[i].thread, NULL);
    CHECK(dis_udp_counters(udp).sent == 2000 && dis_udp_counters(udp).datagrams == 2000);
    dis_udp_close(udp);
}

static void what_cannot_be_is_said(void **state)
{
    (void)state;
    static const struct {
        const char *address, *interface;
        int         port, ttl, queue;
        const char *says;
    } wrong[] = {
        {"", "", 0, 1, 1 << 20, "0 is not in 1 .. 65535"},
        {"", "", 65536, 1, 1 << 20, "65536 is not in"},
        {"", "", 3000, 256, 1 << 20, "256 is not in 0 .. 255"},
        {"", "", 3000, 1, 100, "100 is not in"},
        {"", "nosuch0", 3000, 1, 1 << 20, "`nosuch0`"},
        {"localhost", "", 3000, 1, 1 << 20, "`localhost`"},
        {"300.1.1.1", "", 3000, 1, 1 << 20, "`300.1.1.1`"},
        {"::ffff:127.0.0.1", "", 3000, 1, 1 << 20, "`::ffff:127.0.0.1`"},
        {"0.0.0.0", "", 3000, 1, 1 << 20, "`0.0.0.0`"},
    };
    DisUdp *udp = NULL;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        DisUdpConfig config = config_for(wrong[i].address, wrong[i].interface, wrong[i].port);
        config.ttl = wrong[i].ttl;
        config.queue_octets = wrong[i].queue;
        CHECK(open_quietly(&udp, &config) == STATUS_BAD_VALUE && udp == NULL);
        if (!strstr(check_said, wrong[i].says)) fail_msg("'%s' does not say '%s'", check_said, wrong[i].says);
    }
    /* an address of our own is nobody else's at the same time */
    const DisUdpConfig config = config_for("127.0.0.1", "", free_port());
    char               port[16];
    DisUdp            *first = open_unicast(config.port);
    snprintf(port, sizeof port, "%d", config.port);
    CHECK(open_quietly(&udp, &config) == STATUS_IO && udp == NULL);
    CHECK(strstr(check_said, "127.0.0.1") && strstr(check_said, port) && strstr(check_said, "another port"));
    dis_udp_close(first);
    CHECK(open_quietly(&udp, &config) == STATUS_OK);
    dis_udp_close(udp);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(unicast_v4_arrives_whole),
        cmocka_unit_test(unicast_v6_arrives_whole),
        cmocka_unit_test(a_peer_is_answered_by_whoever_calls),
        cmocka_unit_test(multicast_v4_is_heard_by_all_of_the_group),
        cmocka_unit_test(multicast_v6_is_heard_by_all_of_the_group),
        cmocka_unit_test(link_local_multicast_v6_needs_its_interface),
        cmocka_unit_test(broadcast_is_heard_by_all),
        cmocka_unit_test(broadcast_to_nowhere_in_particular_is_heard_by_all),
        cmocka_unit_test(a_tick_stays_closed_under_a_flood),
        cmocka_unit_test(what_comes_after_its_tick_stands_right_behind_it),
        cmocka_unit_test(a_closing_tick_empties_the_socket),
        cmocka_unit_test(waiting_ends),
        cmocka_unit_test(a_full_queue_keeps_the_oldest_and_counts_the_rest),
        cmocka_unit_test(what_was_taken_stays_until_the_next_take),
        cmocka_unit_test(the_queue_wraps_with_any_sizes),
        cmocka_unit_test(what_the_kernel_dropped_is_counted),
        cmocka_unit_test(a_small_socket_buffer_loses_nothing_uncounted),
        cmocka_unit_test(what_cannot_be_sent_is_counted),
        cmocka_unit_test(it_stops_in_the_middle_of_a_flood),
        cmocka_unit_test(many_may_send_while_one_takes),
        cmocka_unit_test(what_cannot_be_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
