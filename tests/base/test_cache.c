/* Entries of the cache: whole or absent, whatever is done to their files; its room is bounded. */
#include "tests/check.h"

#include "pitviper_cache.h"
#include "pitviper_output.h"

#include <dirent.h>
#include <fcntl.h>
#include <grp.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

static char folder[temp_path_size];

enum { large = 1 << 20 };

static uint8_t octet_of(int which, size_t i) { return (uint8_t)((i * 2654435761u >> 7) + (size_t)which); }

static CacheKey key_of(int which)
{
    CacheKey key = cache_key("test");
    cache_key_add(&key, &which, sizeof which);
    return key;
}

static bool fetch(CacheKey *key, Cache *cache, int which, size_t size)
{
    uint8_t *octets = NULL;
    size_t   count = 0;
    *key = key_of(which);
    if (!cache_fetch((void **)&octets, &count, cache, key)) return false;
    bool same = count == size;
    for (size_t i = 0; i < count && same; i++) same = octets[i] == octet_of(which, i);
    free(octets);
    CHECK(same);
    return true;
}

static void keep(Cache *cache, int which, size_t size)
{
    uint8_t *octets = malloc(size + 1);
    CacheKey key;
    CHECK(octets);
    for (size_t i = 0; i < size; i++) octets[i] = octet_of(which, i);
    CHECK(!fetch(&key, cache, which, size));
    cache_keep(cache, &key, octets, size);
    free(octets);
}

static void path_of(char out[temp_path_size + 80], int which)
{
    CacheKey key;
    uint8_t *octets;
    size_t   count;
    key = key_of(which);
    if (cache_fetch((void **)&octets, &count, NULL, &key)) free(octets);
    snprintf(out, temp_path_size + 80, "%s/%s.kept", folder, key.name);
}

static size_t octets_in_folder(int *files)
{
    size_t         total = 0;
    DIR           *list = opendir(folder);
    struct dirent *entry;
    *files = 0;
    while (list && (entry = readdir(list))) {
        struct stat about;
        CHECK(fstatat(dirfd(list), entry->d_name, &about, AT_SYMLINK_NOFOLLOW) == 0);
        if (!S_ISREG(about.st_mode)) continue;
        total += (size_t)about.st_size;
        ++*files;
    }
    closedir(list);
    return total;
}

/* Files that a writer left. */
static int asides(void)
{
    int            count = 0;
    DIR           *list = opendir(folder);
    struct dirent *entry;
    while (list && (entry = readdir(list))) count += strstr(entry->d_name, ".aside") != NULL;
    closedir(list);
    return count;
}

static void empty_folder(void)
{
    DIR           *list = opendir(folder);
    struct dirent *entry;
    while (list && (entry = readdir(list)))
        if (*entry->d_name != '.') unlinkat(dirfd(list), entry->d_name, 0);
    closedir(list);
    rmdir(folder);
}

static void what_is_kept_is_fetched(void **state)
{
    CacheKey key;
    Cache   *a = cache_open(folder, 64 << 20), *b = cache_open(folder, 64 << 20);
    (void)state;
    CHECK(a && b);
    keep(a, 1, 1000), keep(a, 2, 0), keep(a, 3, large);
    CHECK(fetch(&key, a, 1, 1000) && fetch(&key, b, 1, 1000) && fetch(&key, b, 2, 0) && fetch(&key, b, 3, large));
    CHECK(!fetch(&key, b, 4, 0));
    CHECK(cache_counters(a).made == 3 && cache_counters(b).fetched == 3);
    CHECK(!fetch(&key, NULL, 1, 1000));
    cache_keep(NULL, &key, "", 0);
    cache_close(a), cache_close(b);
}

/* Every octet of a small entry, and every length. */
static void damage_is_found(void **state)
{
    char     path[temp_path_size + 80], octets[400];
    CacheKey key;
    Cache   *c = cache_open(folder, 64 << 20);
    (void)state;
    log_set_level(LOG_ERROR);
    path_of(path, 10);
    keep(c, 10, 50);
    FILE        *file = fopen(path, "rb");
    const size_t size = file ? fread(octets, 1, sizeof octets, file) : 0;
    CHECK(size == 80 + 50 + 64);
    fclose(file);
    for (size_t at = 0; at < 2 * size; at++) { /* a bit flipped; then cut short, and nothing at all */
        const size_t length = at < size ? size : at - size;
        CHECK((file = fopen(path, "wb")));
        if (at < size) octets[at] = (char)(octets[at] ^ 1 << at % 8);
        CHECK(fwrite(octets, 1, length, file) == length && fclose(file) == 0);
        if (at < size) octets[at] = (char)(octets[at] ^ 1 << at % 8);
        CHECK(!fetch(&key, c, 10, 50) && access(path, F_OK) != 0);
    }
    CHECK(cache_counters(c).damaged == 2 * size);
    /* an entry under another's name */
    char other[temp_path_size + 80];
    path_of(other, 11);
    keep(c, 10, 50);
    CHECK(rename(path, other) == 0 && !fetch(&key, c, 11, 50));
    log_set_level(LOG_WARN);
    cache_close(c);
}

/* Nothing of these is waited for, followed or called damaged; what it is is said once, and the next entry written takes
 * its place. */
static void what_is_no_file(void **state)
{
    static const struct {
        char        what; /* l: a link, s: to itself, p: a FIFO, n: to a device, d: a folder */
        const char *said;
    } there[] = {
        {'l', "symbolic link"}, {'s', "symbolic link"}, {'n', "symbolic link"}, {'p', "FIFO"}, {'d', "directory"}};
    char     path[temp_path_size + 80], other[temp_path_size + 80];
    CacheKey key;
    (void)state;
    log_set_level(LOG_WARN);
    log_set_sink(check_listen, NULL);
    path_of(path, 12), path_of(other, 13);
    Cache *c = cache_open(folder, 64 << 20);
    keep(c, 12, 50);
    CHECK(rename(path, other) == 0);
    cache_close(c);
    for (int k = 0; k < (int)(sizeof there / sizeof *there); k++) {
        const char what = there[k].what;
        CHECK((c = cache_open(folder, 64 << 20)));
        if (what == 'p') CHECK(mkfifo(path, 0600) == 0);
        else if (what == 'd') CHECK(mkdir(path, 0700) == 0);
        else CHECK(symlink(what == 'l' ? other : what == 's' ? path : "/dev/zero", path) == 0);
        *check_said = 0;
        CHECK(!fetch(&key, c, 12, 50));
        CHECK(strstr(check_said, "cannot be read") && strstr(check_said, there[k].said));
        *check_said = 0;
        CHECK(!fetch(&key, c, 12, 50) && !*check_said && access(other, F_OK) == 0);
        keep(c, 12, 50);
        CHECK(fetch(&key, c, 12, 50) == (what != 'd') && cache_counters(c).damaged == 0);
        CHECK(cache_counters(c).failed == (what == 'd'));
        if (what == 'd') CHECK(strstr(check_said, "cannot be written") && rmdir(path) == 0);
        else CHECK(unlink(path) == 0);
        cache_close(c);
    }
    log_set_sink(NULL, NULL);
    unlink(other);
}

/* Becomes a user without rights: permissions do not bind root. */
static bool become_nobody(void)
{
    return geteuid() != 0 ||
           (setgroups(0, NULL) == 0 && setresgid(65534, 65534, 65534) == 0 && setresuid(65534, 65534, 65534) == 0);
}

/* What is in a folder that cannot be written is used, an entry that may not be opened is told from a damaged one. */
static void read_only(void **state)
{
    char        path[temp_path_size + 80];
    struct stat about;
    int         ended, files[2];
    (void)state;
    Cache *c = cache_open(folder, 64 << 20);
    keep(c, 60, 1000), keep(c, 61, 1000);
    cache_close(c);
    path_of(path, 61);
    octets_in_folder(&files[0]);
    CHECK(stat(folder, &about) == 0 && chmod(path, 0) == 0 && chmod(folder, 0555) == 0);
    const pid_t child = fork();
    if (child == 0) {
        CacheKey key;
        if (!become_nobody()) _exit(77);
        log_set_level(LOG_WARN);
        log_set_sink(check_listen, NULL);
        c = cache_open(folder, 64 << 20);
        bool good = c && strstr(check_said, "cannot be written") && strstr(check_said, "what is in it is used");
        *check_said = 0;
        good = good && fetch(&key, c, 60, 1000) && !fetch(&key, c, 62, 10) && !*check_said;
        cache_keep(c, &key, "0123456789", 10);
        good = good && !fetch(&key, c, 62, 10) && !*check_said && cache_counters(c).failed == 0;
        good = good && !fetch(&key, c, 61, 1000) && strstr(check_said, "cannot be read: Permission denied");
        good = good && cache_counters(c).damaged == 0 && cache_counters(c).fetched == 1;
        cache_close(c);
        _exit(good ? 0 : 1);
    }
    CHECK(waitpid(child, &ended, 0) == child && WIFEXITED(ended));
    CHECK(chmod(folder, about.st_mode & 0777) == 0 && chmod(path, 0600) == 0);
    octets_in_folder(&files[1]);
    CHECK(files[0] == files[1] && (WEXITSTATUS(ended) == 0 || WEXITSTATUS(ended) == 77));
    if (WEXITSTATUS(ended) == 77) skip(); /* root who cannot become another */
}

static void least_recently_used_go(void **state)
{
    int      files;
    char     path[temp_path_size + 80];
    CacheKey key;
    Cache   *c = cache_open(folder, 8 << 20);
    (void)state;
    for (int k = 20; k < 26; k++) {
        keep(c, k, large);
        path_of(path, k);
        const struct timespec used[2] = {{k, 0}, {k, 0}}; /* long ago, one after the other */
        CHECK(utimensat(AT_FDCWD, path, used, 0) == 0);
    }
    CHECK(fetch(&key, c, 20, large)); /* used now */
    for (int k = 26; k < 30; k++) keep(c, k, large);
    CHECK(octets_in_folder(&files) <= 8 << 20);
    CHECK(fetch(&key, c, 20, large) && fetch(&key, c, 29, large) && !fetch(&key, c, 21, large));
    keep(c, 30, 5 << 20); /* more than half of the room is not kept */
    CHECK(!fetch(&key, c, 30, 5 << 20));
    /* what killed writers left */
    char living[sizeof path];
    snprintf(path, sizeof path, "%s/x.1.aside", folder), snprintf(living, sizeof living, "%s/x.2.aside", folder);
    fclose(fopen(path, "w"));
    const int writer = output_open(living, 0);
    keep(c, 31, 10);
    CHECK(writer >= 0 && access(path, F_OK) != 0 && access(living, F_OK) == 0);
    close(writer);
    keep(c, 32, 10);
    CHECK(access(living, F_OK) != 0);
    cache_close(c);
    /* with less room than before: the older ones go, and none is called damaged */
    CHECK(octets_in_folder(&files) > 3 * large && (c = cache_open(folder, large / 2)));
    CHECK(octets_in_folder(&files) <= large / 2);
    CHECK(!fetch(&key, c, 20, large) && fetch(&key, c, 31, 10) && cache_counters(c).damaged == 0);
    cache_close(c);
}

static void write_for_ever(int which)
{
    Cache *c = cache_open(folder, 1 << 30);
    char   path[temp_path_size + 80];
    for (;;) {
        uint8_t *octets = malloc(large);
        CacheKey key = key_of(which);
        size_t   count;
        void    *kept;
        path_of(path, which);
        if (!octets) _exit(2);
        for (size_t i = 0; i < large; i++) octets[i] = octet_of(which, i);
        if (cache_fetch(&kept, &count, c, &key)) free(kept);
        cache_keep(c, &key, octets, large);
        free(octets);
    }
}

static void killed_and_side_by_side(void **state)
{
    CacheKey key;
    Cache   *c = cache_open(folder, 1 << 30);
    int      whole = 0;
    (void)state;
    for (int round = 0; round < 20; round++) {
        pid_t writer[2];
        for (int k = 0; k < 2; k++)
            if ((writer[k] = fork()) == 0) write_for_ever(40);
        for (int k = 0; whole == 0 && k < 20000; k++) { /* the first entry, however late its writer begins */
            const struct timespec ms = {0, 1000000};
            nanosleep(&ms, NULL);
            whole += fetch(&key, c, 40, large);
        }
        for (int k = 0; k < 20; k++) whole += fetch(&key, c, 40, large); /* CHECKs that it is whole */
        for (int k = 0; k < 2; k++)
            CHECK(writer[k] > 0 && kill(writer[k], SIGKILL) == 0 && waitpid(writer[k], NULL, 0) > 0);
    }
    CHECK(whole > 0 && cache_counters(c).damaged == 0);
    cache_close(c);
    c = cache_open(folder, 1 << 30); /* what they were writing is removed */
    CHECK(c && asides() == 0);
    cache_close(c);
}

/* Several processes that write and evict in one small folder: what is fetched is whole, nothing breaks. */
static void writers_that_evict(void **state)
{
    enum { processes = 3, rounds = 60, room = 4 * large };
    pid_t child[processes];
    int   ended, files;
    (void)state;
    for (int p = 0; p < processes; p++) {
        if ((child[p] = fork()) != 0) continue;
        Cache   *c = cache_open(folder, room);
        uint8_t *octets = malloc(large);
        int      whole = 0;
        for (int n = 0; n < rounds && c && octets; n++) {
            const int which = 70 + (5 * n + p) % 9;
            CacheKey  key;
            if (fetch(&key, c, which, large)) whole++;
            else {
                for (size_t i = 0; i < large; i++) octets[i] = octet_of(which, i);
                cache_keep(c, &key, octets, large);
            }
        }
        const CacheCounters n = cache_counters(c);
        _exit(n.damaged == 0 && n.failed == 0 && (uint64_t)whole == n.fetched && n.made + n.fetched == rounds ? 0 : 1);
    }
    for (int p = 0; p < processes; p++)
        CHECK(waitpid(child[p], &ended, 0) == child[p] && WIFEXITED(ended) && WEXITSTATUS(ended) == 0);
    cache_close(cache_open(folder, room));
    CHECK(octets_in_folder(&files) <= room && asides() == 0);
}

static void without_room_or_folder(void **state)
{
    char path[temp_path_size + 80];
    (void)state;
    snprintf(path, sizeof path, "%s/file", folder);
    fclose(fopen(path, "w"));
    snprintf(path, sizeof path, "%s/file/below", folder);
    log_set_level(LOG_ERROR);
    CHECK(cache_open(path, 1 << 20) == NULL);
    const pid_t child = fork();
    if (child == 0) {
        const struct rlimit less = {large / 2, large / 2};
        Cache              *c = cache_open(folder, 1 << 30);
        CacheKey            key;
        int                 files[2];
        signal(SIGXFSZ, SIG_IGN);
        if (!c || setrlimit(RLIMIT_FSIZE, &less) != 0) _exit(2);
        octets_in_folder(&files[0]);
        keep(c, 50, large);
        keep(c, 51, large);
        octets_in_folder(&files[1]);
        const bool good = cache_counters(c).failed == 2 && files[0] == files[1] && !fetch(&key, c, 50, large);
        keep(c, 52, 1000);
        _exit(good && fetch(&key, c, 52, 1000) ? 0 : 1);
    }
    int ended;
    CHECK(waitpid(child, &ended, 0) == child && WIFEXITED(ended) && WEXITSTATUS(ended) == 0);
    log_set_level(LOG_WARN);
}

static void keys_differ(void **state)
{
    CacheKey a = cache_key("one"), b = cache_key("two"), c = cache_key("one");
    void    *octets;
    size_t   count;
    (void)state;
    cache_key_add(&c, "x", 1);
    cache_fetch(&octets, &count, NULL, &a), cache_fetch(&octets, &count, NULL, &b),
        cache_fetch(&octets, &count, NULL, &c);
    CHECK(strlen(a.name) == 64 && strcmp(a.name, b.name) != 0 && strcmp(a.name, c.name) != 0);
}

/* ---- what the environment changes ---------------------------------------------------------------------- */

static const char printing[] = "PITVIPER_TEST_CACHE_KEY";

/* Prints the name of a key and what the C library's functions compute. */
static int print_key(void)
{
    CacheKey      key = cache_key("one");
    void         *octets;
    size_t        count;
    static double value[20000][5];
    char          sum[sha256_text_size];
    cache_fetch(&octets, &count, NULL, &key);
    for (int i = 0; i < 20000; i++) {
        volatile double x = 0.0037 * (i + 1);
        value[i][0] = sin(x), value[i][1] = exp(x), value[i][2] = pow(x, 0.3), value[i][3] = atan(x),
        value[i][4] = log(x);
    }
    if (sha256_bytes(sum, value, sizeof value) != STATUS_OK) return 1;
    printf("%s %s\n", key.name, sum);
    return 0;
}

static void printed_with(char out[2][sha256_text_size], const char *environment)
{
    char          command[temp_path_size + 200], self[temp_path_size];
    const ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
    CHECK(length > 0);
    self[length] = 0;
    snprintf(command, sizeof command, "%s %s=1 '%s' test_cache", environment, printing, self);
    FILE *from = popen(command, "r");
    CHECK(from && fscanf(from, "%64s %64s", out[0], out[1]) == 2);
    pclose(from);
}

/* GLIBC_TUNABLES chooses among versions of sin, exp ...: where their values differ, keys do, and else they do not. */
static void other_functions_are_other_keys(void **state)
{
    static const char *const environment[] = {"", "GLIBC_TUNABLES=glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2,-AVX",
                                              "GLIBC_TUNABLES=glibc.malloc.check=0"};
    char                     printed[3][2][sha256_text_size];
    (void)state;
    for (int k = 0; k < 3; k++) {
        printed_with(printed[k], environment[k]);
        CHECK((strcmp(printed[k][0], printed[0][0]) == 0) == (strcmp(printed[k][1], printed[0][1]) == 0));
    }
}

int main(void)
{
    if (getenv(printing)) return print_key(); /* other_functions_are_other_keys starts it so */
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(keys_differ),
        cmocka_unit_test(what_is_kept_is_fetched),
        cmocka_unit_test(other_functions_are_other_keys),
        cmocka_unit_test(damage_is_found),
        cmocka_unit_test(what_is_no_file),
        cmocka_unit_test(read_only),
        cmocka_unit_test(least_recently_used_go),
        cmocka_unit_test(killed_and_side_by_side),
        cmocka_unit_test(writers_that_evict),
        cmocka_unit_test(without_room_or_folder),
    };
    if (!temp_folder(folder)) return 1;
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    empty_folder();
    return failed;
}
