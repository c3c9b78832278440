/* The ring of frames in shared memory, its writer against the public header's reader: order, what is missed, torn
 * copies, several readers at once, a writer that restarts, dies, or finds its name taken, no room, and headers that
 * lie. The memory itself is the same pages, so a race would be one here too. */
#include "tests/check.h"

#include "sensor/publish/memory/memory_ring_private.h"
#include "sensor/settings/config.h"

#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <sys/wait.h>

enum { wide = 101, high = 33, counts_wide = 51, room = 4 }; /* 13332 and 3366 octets: neither is a multiple of 8 */

static char ring_name[64];

static MemoryRingOf ring_of(int slots)
{
    return (MemoryRingOf){.name = ring_name,
                          .slots = slots,
                          .target_room = room,
                          .truth = true,
                          .config_sha256 = "abc",
                          .detections_port = 3456,
                          .plane_count = 2,
                          .plane = {{.band = 2,
                                     .type = PITVIPER_PLANE_FLOAT32,
                                     .width = wide,
                                     .height = high,
                                     .band_name = "lwir",
                                     .name = "Y",
                                     .unit = "W/(m2 sr)"},
                                    {.band = 1,
                                     .type = PITVIPER_PLANE_UINT16,
                                     .width = counts_wide,
                                     .height = high,
                                     .bits = 14,
                                     .band_name = "mwir",
                                     .name = "Y",
                                     .unit = "counts"}}};
}

static MemoryRing *make_ring(int slots)
{
    MemoryRing        *ring = NULL;
    const MemoryRingOf of = ring_of(slots);
    CHECK(memory_ring_create(&ring, &of) == STATUS_OK);
    return ring;
}

/* Frame `number`: all of its values follow from it. */
static void put(MemoryRing *ring, int number)
{
    float    radiance[high * wide];
    uint16_t counts[high * counts_wide];
    for (int i = 0; i < high * wide; i++) radiance[i] = (float)(number + i);
    for (int i = 0; i < high * counts_wide; i++) counts[i] = (uint16_t)(number + i);
    PitviperMemoryRecord *r = memory_ring_record(ring);
    PitviperMemoryTarget *t = memory_ring_targets(ring);
    *r = (PitviperMemoryRecord){.frame = number,
                                .time_s = 0.1 * number,
                                .seed = -number,
                                .host = "1:2:3",
                                .target_count = (uint32_t)(number % (room + 1))};
    for (int i = 0; i < room; i++) t[i] = (PitviperMemoryTarget){.entity = (uint16_t)(i + 1), .range_m = number};
    memory_ring_put(ring, (const void *const[]){radiance, counts});
}

/* Whether what was taken is one frame and no mixture. */
static bool whole(const PitviperMemory *m)
{
    const int       number = m->record.frame;
    const float    *radiance = pitviper_memory_plane(m, 0);
    const uint16_t *counts = pitviper_memory_plane(m, 1);
    bool            good = m->record.seed == -number && m->record.time_s == 0.1 * number &&
                m->record.target_count == (uint32_t)(number % (room + 1));
    for (int i = 0; i < high * wide; i++) good &= radiance[i] == (float)(number + i);
    for (int i = 0; i < high * counts_wide; i++) good &= counts[i] == (uint16_t)(number + i);
    for (uint32_t i = 0; i < m->record.target_count; i++) {
        PitviperMemoryTarget t;
        good &= pitviper_memory_target(&t, m, i) && t.entity == i + 1 && t.range_m == number;
    }
    return good;
}

static void open_reader(PitviperMemory *m) { CHECK(pitviper_memory_open(m, ring_name) == 0); }

static bool name_is_there(void)
{
    char path[96];
    snprintf(path, sizeof path, "/dev/shm/%s", ring_name);
    return access(path, F_OK) == 0;
}

static void frames_come_in_order_or_newest_first(void **state)
{
    (void)state;
    PitviperMemory       m, late;
    PitviperMemoryTarget t;
    MemoryRing          *ring = make_ring(4);
    open_reader(&m);
    CHECK(m.header.slot_count == 4 && m.header.plane_count == 2 && m.header.kind == PITVIPER_MEMORY_TRUTH);
    CHECK(m.header.writer_pid == getpid() && m.header.detections_port == 3456);
    CHECK(strcmp(m.plane[1].unit, "counts") == 0 && m.plane[1].bits == 14);
    CHECK(pitviper_memory_wait(&m, 0) == 0 && pitviper_memory_take_next(&m) == 0 && !pitviper_memory_plane(&m, 0));
    for (int n = 0; n < 3; n++) put(ring, n);
    CHECK(pitviper_memory_wait(&m, 0) == 1);
    for (int n = 0; n < 3; n++) CHECK(pitviper_memory_take_next(&m) == 1 && m.record.frame == n && whole(&m));
    CHECK(pitviper_memory_take_next(&m) == 0 && whole(&m) && m.missed == 0 && m.record.written_ns > 0);
    CHECK(!pitviper_memory_plane(&m, 2) && !pitviper_memory_target(&t, &m, 2));
    for (int n = 3; n < 13; n++) put(ring, n); /* ten, of which four are held */
    CHECK(pitviper_memory_take_next(&m) == 1 && m.record.frame == 9 && whole(&m) && m.missed == 6);
    CHECK(pitviper_memory_take_newest(&m) == 1 && m.record.frame == 12 && whole(&m) && m.missed == 8);
    open_reader(&late); /* later: begins with the oldest that is there, or the newest */
    CHECK(pitviper_memory_take_next(&late) == 1 && late.record.frame == 9 && late.missed == 0 && whole(&late));
    CHECK(pitviper_memory_take_newest(&late) == 1 && late.record.frame == 12 && late.missed == 2);
    pitviper_memory_close(&late);
    pitviper_memory_close(&m);
    memory_ring_close(ring);
    CHECK(!name_is_there());
}

static void what_is_being_written_is_not_taken(void **state)
{
    (void)state;
    PitviperMemory m;
    uint64_t       sequence;
    MemoryRing    *ring = make_ring(2);
    open_reader(&m);
    put(ring, 0);
    const unsigned char *slot = pitviper_memory_in_place(&m, &sequence);
    CHECK(slot && sequence == 1 && pitviper_memory_is_intact(slot, sequence));
    put(ring, 1);
    CHECK(pitviper_memory_is_intact(slot, sequence));
    put(ring, 2);
    CHECK(!pitviper_memory_is_intact(slot, sequence));
    /* the slot of the newest, as in the middle of a copy: the writer alone can do that, through a mapping of its own */
    char path[96];
    snprintf(path, sizeof path, "/dev/shm/%s", ring_name);
    const int file = open(path, O_RDWR);
    uint64_t *lock = mmap(NULL, m.size, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    CHECK(file >= 0 && lock != MAP_FAILED);
    lock[m.header.slot_offset / 8] = 2 * 3 - 1;
    CHECK(pitviper_memory_wait(&m, 0) == 1 && pitviper_memory_take_newest(&m) == 0);
    CHECK(pitviper_memory_take_next(&m) == 1 && m.record.frame == 1 && whole(&m));
    lock[m.header.slot_offset / 8] = 2 * 3;
    CHECK(pitviper_memory_take_newest(&m) == 1 && m.record.frame == 2 && whole(&m));
    munmap(lock, m.size);
    close(file);
    pitviper_memory_close(&m);
    memory_ring_close(ring);
}

static void a_reader_can_change_nothing(void **state)
{
    (void)state;
    PitviperMemory m;
    MemoryRing    *ring = make_ring(2);
    open_reader(&m);
    CHECK(write(m.file, "x", 1) < 0 && ftruncate(m.file, 0) != 0);
    CHECK(mprotect((void *)(uintptr_t)m.at, m.size, PROT_READ | PROT_WRITE) != 0);
    struct stat status;
    CHECK(fstat(m.file, &status) == 0 && (status.st_mode & 0777) == 0600);
    pitviper_memory_close(&m);
    memory_ring_close(ring);
}

/* ---- readers at once ---------------------------------------------------------------------------------- */

enum { readers = 4, many = 8000 };

typedef struct Reading {
    pthread_t thread;
    int       number, frames, ended;
    bool      good;
    uint64_t  missed, torn;
} Reading;

static atomic_int begun; /* readers that have read a frame */

/* Of each kind: in order, newest, a slow one, and one that comes again and again. */
static void *read_all(void *user)
{
    Reading       *r = user;
    PitviperMemory m;
    int            last = -1;
    r->good = pitviper_memory_open(&m, ring_name) == 0;
    while (r->good && (r->ended = pitviper_memory_wait(&m, 10000)) == 1) {
        if ((r->number == 0 ? pitviper_memory_take_next(&m) : pitviper_memory_take_newest(&m)) != 1) continue;
        r->good &= whole(&m) && m.record.frame > last;
        last = m.record.frame;
        if (r->frames++ == 0) atomic_fetch_add(&begun, 1);
        if (r->number == 2) usleep(300);
        if (r->number == 3 && r->frames % 64 == 0) {
            pitviper_memory_close(&m);
            last = -1; /* the newest one may be taken again */
            if (pitviper_memory_open(&m, ring_name) != 0) {
                r->ended = PITVIPER_MEMORY_ENDED; /* closed meanwhile */
                return NULL;
            }
        }
    }
    r->missed = m.missed;
    r->torn = m.torn;
    pitviper_memory_close(&m);
    return NULL;
}

static void many_readers_see_whole_frames(void **state)
{
    (void)state;
    Reading     reading[readers] = {{0}};
    MemoryRing *ring = make_ring(2);
    atomic_store(&begun, 0);
    for (int i = 0; i < readers; i++) {
        reading[i].number = i;
        CHECK(pthread_create(&reading[i].thread, NULL, read_all, &reading[i]) == 0);
    }
    for (int n = 0; n < many; n++) put(ring, n);
    for (int k = 0; k < 120000 && atomic_load(&begun) < readers; k++) usleep(1000); /* the last frame stays */
    memory_ring_close(ring);
    for (int i = 0; i < readers; i++) {
        pthread_join(reading[i].thread, NULL);
        CHECK(reading[i].good && reading[i].ended == PITVIPER_MEMORY_ENDED);
        print_message("reader %d: %d frames, %llu missed, %llu torn\n", i, reading[i].frames,
                      (unsigned long long)reading[i].missed, (unsigned long long)reading[i].torn);
    }
    CHECK(reading[0].frames > 0 && reading[1].frames > 0);
}

/* ---- names, deaths ---------------------------------------------------------------------------------------- */

/* A process that writes frames 0 and 1 and is killed. */
static pid_t killed_writer(void)
{
    int  ready[2];
    char octet;
    CHECK(pipe(ready) == 0);
    const pid_t child = fork();
    if (child == 0) {
        MemoryRing        *ring = NULL;
        const MemoryRingOf of = ring_of(2);
        if (memory_ring_create(&ring, &of) != STATUS_OK) _exit(1);
        put(ring, 0);
        put(ring, 1);
        if (write(ready[1], "x", 1) != 1) _exit(1);
        for (;;) pause();
    }
    CHECK(child > 0 && read(ready[0], &octet, 1) == 1);
    close(ready[0]);
    close(ready[1]);
    return child;
}

static void a_ring_of_the_dead_is_replaced(void **state)
{
    (void)state;
    PitviperMemory m, again;
    const pid_t    child = killed_writer();
    open_reader(&m);
    CHECK(pitviper_memory_take_newest(&m) == 1 && m.record.frame == 1 && whole(&m));
    CHECK(pitviper_memory_wait(&m, 0) == 0);
    kill(child, SIGKILL);
    waitpid(child, NULL, 0);
    CHECK(pitviper_memory_wait(&m, -1) == PITVIPER_MEMORY_ENDED && name_is_there());
    CHECK(pitviper_memory_open(&again, ring_name) == PITVIPER_MEMORY_ENDED);
    MemoryRing *ring = make_ring(3);
    put(ring, 7);
    CHECK(pitviper_memory_wait(&m, 0) == PITVIPER_MEMORY_ENDED && whole(&m)); /* what it has taken stays */
    open_reader(&again);
    CHECK(again.header.epoch != m.header.epoch && again.header.writer_pid == getpid());
    CHECK(pitviper_memory_take_newest(&again) == 1 && again.record.frame == 7);
    pitviper_memory_close(&again);
    pitviper_memory_close(&m);
    memory_ring_close(ring);
    CHECK(!name_is_there());
    CHECK(pitviper_memory_open(&m, ring_name) == PITVIPER_MEMORY_ABSENT);
}

static void a_name_in_use_is_refused(void **state)
{
    (void)state;
    PitviperMemory     m;
    const MemoryRingOf of = ring_of(3);
    MemoryRing        *ring = make_ring(2), *other = NULL;
    log_set_sink(check_listen, NULL);
    CHECK(memory_ring_create(&other, &of) == STATUS_BAD_VALUE);
    CHECK(strstr(check_said, "in use by a living node") && strstr(check_said, "--memory"));
    put(ring, 5);
    open_reader(&m);
    CHECK(pitviper_memory_take_newest(&m) == 1 && whole(&m));
    pitviper_memory_close(&m);
    memory_ring_close(ring);

    char path[96]; /* what is no ring stays as it is */
    snprintf(path, sizeof path, "/dev/shm/%s", ring_name);
    FILE *file = fopen(path, "w");
    CHECK(file && fputs("not a ring", file) > 0 && fclose(file) == 0);
    CHECK(memory_ring_create(&other, &of) == STATUS_BAD_VALUE && strstr(check_said, "is not a ring of frames"));
    CHECK(pitviper_memory_open(&m, ring_name) == PITVIPER_MEMORY_REFUSED && name_is_there());
    remove(path);
    log_set_sink(NULL, NULL);
    CHECK(pitviper_memory_open(&m, "") == PITVIPER_MEMORY_ABSENT);
    CHECK(pitviper_memory_open(&m, "../etc") == PITVIPER_MEMORY_ABSENT);
}

static void no_room_is_said_at_the_start(void **state)
{
    (void)state;
    MemoryRing  *ring = NULL;
    MemoryRingOf of = ring_of(64);
    char         path[128];
    of.plane[0].width = of.plane[0].height = 65536; /* 1.1 TB */
    log_set_sink(check_listen, NULL);
    CHECK(memory_ring_create(&ring, &of) == STATUS_IO && !ring);
    CHECK(strstr(check_said, "no room") && strstr(check_said, "publish.memory_slots"));
    log_set_sink(NULL, NULL);
    snprintf(path, sizeof path, "/dev/shm/.pitviper-%s-%d", ring_name, (int)getpid());
    CHECK(!name_is_there() && access(path, F_OK) != 0); /* nothing is left behind */
}

static void headers_that_lie_are_refused(void **state)
{
    (void)state;
    static const struct {
        size_t   at, size;
        uint64_t value;
    } lie[] = {{0, 1, 'X'},
               {8, 4, 0x04030201},
               {12, 2, 2},
               {12, 2, 0},
               {16, 4, 312},
               {16, 4, 321},
               {20, 4, 8},
               {24, 4, 0},
               {24, 4, 1 << 20},
               {28, 4, 575},
               {32, 8, 1ull << 40},
               {32, 8, 64},
               {40, 8, UINT64_MAX - 7},
               {40, 8, 4},
               {48, 8, UINT64_MAX - 63},
               {48, 8, 1},
               {56, 8, 0},
               {56, 8, UINT64_MAX / 2},
               {56, 8, 1ull << 63},
               {64, 8, ~0ull},
               {64, 8, 1 << 20},
               {72, 4, 0},
               {72, 4, UINT32_MAX},
               {76, 4, 0},
               {76, 4, 17},
               {80, 4, UINT32_MAX},
               /* the first plane: band, type, width, height, offset */
               {320, 4, 4},
               {324, 4, 3},
               {324, 4, 0},
               {328, 4, 0},
               {328, 4, UINT32_MAX},
               {332, 4, 65537},
               {332, 4, 60000},
               {336, 8, UINT64_MAX - 7},
               {336, 8, 1}};
    static uint8_t good[1 << 16];
    PitviperMemory m;
    MemoryRing    *ring = make_ring(2);
    put(ring, 3);
    open_reader(&m);
    const size_t size = m.size;
    CHECK(size < sizeof good);
    memcpy(good, m.at, size);
    pitviper_memory_close(&m);
    memory_ring_close(ring);
    for (size_t i = 0; i <= sizeof lie / sizeof *lie; i++) {
        const int file = memfd_create("lie", 0);
        CHECK(file >= 0 && write(file, good, size) == (ssize_t)size);
        if (i < sizeof lie / sizeof *lie)
            CHECK(pwrite(file, &lie[i].value, lie[i].size, (off_t)lie[i].at) == (ssize_t)lie[i].size);
        const int result = pitviper_memory_open_file(&m, file);
        if (i == sizeof lie / sizeof *lie) {
            CHECK(result == 0 && pitviper_memory_take_newest(&m) == 1 && whole(&m) && m.record.frame == 3);
            pitviper_memory_close(&m);
        } else if (result != PITVIPER_MEMORY_REFUSED) {
            fail_msg("octet %zu = %llu: %d", lie[i].at, (unsigned long long)lie[i].value, result);
        }
    }
    const int file = memfd_create("short", 0);
    CHECK(write(file, good, 319) == 319 && pitviper_memory_open_file(&m, file) == PITVIPER_MEMORY_REFUSED);
}

static void settings_are_checked(void **state)
{
    (void)state;
    static const struct {
        const char *key, *value, *said;
    } bad[] = {{"publish.memory", "a/b", "letters, digits"},
               {"publish.memory", ".hidden", "begins with"},
               {"publish.memory", "-x", "begins with"},
               {"publish.memory", "a b", "letters, digits"}};
    log_set_sink(check_listen, NULL);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        Config config = config_default();
        CHECK(config_set(&config, bad[i].key, bad[i].value, "test") == STATUS_OK);
        CHECK(config_check(&config) == STATUS_BAD_VALUE && strstr(check_said, bad[i].said));
    }
    Config config = config_default();
    CHECK(config_set(&config, "publish.memory", "seeker_1.a-b", "test") == STATUS_OK);
    CHECK(config_check(&config) == STATUS_OK);
    CHECK(config_set(&config, "publish.memory_planes", "counts", "test") == STATUS_OK);
    CHECK(config_check(&config) == STATUS_BAD_VALUE && strstr(check_said, "sensor.preset"));
    CHECK(config_set(&config, "sensor.preset", "staring_lwir", "test") == STATUS_OK);
    CHECK(config_check(&config) == STATUS_OK);
    log_set_sink(NULL, NULL);
}

int main(void)
{
    snprintf(ring_name, sizeof ring_name, "pitviper-test-%d", (int)getpid());
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_come_in_order_or_newest_first),
        cmocka_unit_test(what_is_being_written_is_not_taken),
        cmocka_unit_test(a_reader_can_change_nothing),
        cmocka_unit_test(a_ring_of_the_dead_is_replaced),
        cmocka_unit_test(a_name_in_use_is_refused),
        cmocka_unit_test(no_room_is_said_at_the_start),
        cmocka_unit_test(headers_that_lie_are_refused),
        cmocka_unit_test(many_readers_see_whole_frames),
        cmocka_unit_test(settings_are_checked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
