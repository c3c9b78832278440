/* Entries of the cache: whole or absent, whatever is done to their files; its room is bounded. */
#include "tests/check.h"

#include "pitviper_cache.h"

#include <dirent.h>
#include <fcntl.h>
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
    /* what is no file: nothing waits, nothing is followed */
    keep(c, 10, 50);
    CHECK(rename(path, other) == 0 && symlink(other, path) == 0 && !fetch(&key, c, 10, 50) && access(other, F_OK) == 0);
    CHECK(mkfifo(path, 0600) == 0 && !fetch(&key, c, 10, 50));
    CHECK(mkdir(path, 0700) == 0 && !fetch(&key, c, 10, 50));
    rmdir(path);
    keep(c, 10, 50);
    CHECK(fetch(&key, c, 10, 50));
    log_set_level(LOG_WARN);
    cache_close(c);
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
    snprintf(path, sizeof path, "%s/x.1.aside", folder);
    fclose(fopen(path, "w"));
    const struct timespec old[2] = {{1, 0}, {1, 0}};
    CHECK(utimensat(AT_FDCWD, path, old, 0) == 0);
    keep(c, 31, 10);
    CHECK(access(path, F_OK) != 0);
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
        for (int k = 0; k < 20; k++) whole += fetch(&key, c, 40, large); /* CHECKs that it is whole */
        for (int k = 0; k < 2; k++)
            CHECK(writer[k] > 0 && kill(writer[k], SIGKILL) == 0 && waitpid(writer[k], NULL, 0) > 0);
    }
    CHECK(whole > 0 && cache_counters(c).damaged == 0);
    cache_close(c);
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(keys_differ),
        cmocka_unit_test(what_is_kept_is_fetched),
        cmocka_unit_test(damage_is_found),
        cmocka_unit_test(least_recently_used_go),
        cmocka_unit_test(killed_and_side_by_side),
        cmocka_unit_test(without_room_or_folder),
    };
    if (!temp_folder(folder)) return 1;
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    empty_folder();
    return failed;
}
