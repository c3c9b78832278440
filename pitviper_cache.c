/* pitviper_cache.c: entries of the cache: their names, files, and the room that they take. */
#include "pitviper_cache.h"

#include "pitviper_file.h"
#include "pitviper_output.h"

#include <errno.h>
#include <fcntl.h>
#include <gnu/libc-version.h>
#include <link.h>
#include <pthread.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { path_size = 4096, head_octets = 80, sum_octets = 64 };
static const char   magic[8] = {'P', 'V', 'K', 'E', 'P', 'T', '1', '\n'};
static const time_t stale_s = 3600; /* what a killed writer left is older */

struct Cache {
    char            folder[path_size];
    size_t          most_octets;
    pthread_mutex_t mutex; /* of the rest */
    CacheCounters   counters;
    bool            said; /* that it failed */
    unsigned        written;
};

/* ---- names ------------------------------------------------------------------------------------------ */

/* Adds the build id of the executable, which is loaded first. Without one nothing is kept. */
static int add_build_id(struct dl_phdr_info *about, size_t size, void *user)
{
    CacheKey *key = user;
    (void)size;
    for (int i = 0; i < about->dlpi_phnum; i++) {
        const ElfW(Phdr) *part = &about->dlpi_phdr[i];
        if (part->p_type != PT_NOTE) continue;
        const char *at = (const char *)(about->dlpi_addr + part->p_vaddr), *end = at + part->p_memsz;
        while (end - at >= (ptrdiff_t)sizeof(ElfW(Nhdr))) {
            ElfW(Nhdr) note;
            memcpy(&note, at, sizeof note);
            const char *name = at + sizeof note, *value = name + (note.n_namesz + 3) / 4 * 4;
            if (note.n_type == NT_GNU_BUILD_ID && note.n_namesz == 4 && memcmp(name, "GNU", 4) == 0) {
                key->good = key->good && sha256_add(key->digest, value, note.n_descsz);
                return 1;
            }
            at = value + (note.n_descsz + 3) / 4 * 4;
        }
    }
    return -1; /* the first has none */
}

CacheKey cache_key(const char *what)
{
    CacheKey key = {.digest = sha256_begin()};
    key.good = key.digest;
    const char   *libc = gnu_get_libc_version();
    const uint8_t processor[] = {__builtin_cpu_supports("avx2") != 0, __builtin_cpu_supports("fma") != 0,
                                 __builtin_cpu_supports("avx512f") != 0};
    cache_key_add(&key, what, strlen(what) + 1);
    cache_key_add(&key, libc, strlen(libc) + 1);
    cache_key_add(&key, processor, sizeof processor);
    if (key.good && dl_iterate_phdr(add_build_id, &key) != 1) key.good = false;
    return key;
}

void cache_key_add(CacheKey *key, const void *octets, size_t count)
{
    key->good = key->good && (count == 0 || sha256_add(key->digest, octets, count));
}

static void end_key(CacheKey *key)
{
    *key->name = 0;
    if (key->digest && sha256_end(key->name, key->digest, key->good) != STATUS_OK) *key->name = 0;
    key->digest = NULL;
}

/* ---- the folder ------------------------------------------------------------------------------------- */

static bool default_folder(char out[path_size])
{
    const char *cache = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
    int         n = 0;
    if (cache && *cache == '/') n = snprintf(out, path_size, "%s/pitviper", cache);
    else if (home && *home == '/') n = snprintf(out, path_size, "%s/.cache/pitviper", home);
    return n > 0 && n < path_size;
}

static void make_room(const Cache *c);

Cache *cache_open(const char *folder, size_t most_octets)
{
    Cache *c = calloc(1, sizeof *c);
    if (!c) return NULL;
    const bool named = *folder ? snprintf(c->folder, path_size, "%s", folder) < path_size : default_folder(c->folder);
    c->most_octets = most_octets;
    if (named && output_folder(c->folder) == 0 && pthread_mutex_init(&c->mutex, NULL) == 0) {
        make_room(c); /* most_octets may be less than it was */
        return c;
    }
    if (named)
        log_warn("cache: %s cannot be made: %s; everything is made anew in every run (cache.folder names another, "
                 "cache.on: off is silent)",
                 c->folder, output_reason(errno));
    else log_detail("cache: there is no home to keep it in: everything is made anew (cache.folder)");
    free(c);
    return NULL;
}

void cache_close(Cache *c)
{
    if (!c) return;
    log_detail("cache: %s: %llu fetched, %llu made, %llu damaged, %llu not written", c->folder,
               (unsigned long long)c->counters.fetched, (unsigned long long)c->counters.made,
               (unsigned long long)c->counters.damaged, (unsigned long long)c->counters.failed);
    pthread_mutex_destroy(&c->mutex);
    free(c);
}

CacheCounters cache_counters(Cache *c)
{
    pthread_mutex_lock(&c->mutex);
    const CacheCounters counters = c->counters;
    pthread_mutex_unlock(&c->mutex);
    return counters;
}

static void count(Cache *c, uint64_t *counter)
{
    pthread_mutex_lock(&c->mutex);
    ++*counter;
    pthread_mutex_unlock(&c->mutex);
}

/* Whether this failure is the first. */
static bool first(Cache *c)
{
    pthread_mutex_lock(&c->mutex);
    const bool is_first = !c->said;
    c->said = true;
    pthread_mutex_unlock(&c->mutex);
    return is_first;
}

/* ---- reading ---------------------------------------------------------------------------------------- */

bool cache_entry_read(size_t *at, size_t *count, const char name[sha256_text_size], const void *file, size_t octets)
{
    const char *begin = file;
    uint64_t    said;
    char        sum[sha256_text_size];
    if (octets < head_octets + sum_octets || memcmp(begin, magic, sizeof magic) != 0 ||
        memcmp(begin + sizeof magic, name, sum_octets) != 0)
        return false;
    memcpy(&said, begin + head_octets - sizeof said, sizeof said);
    if (said != octets - head_octets - sum_octets) return false;
    if (sha256_bytes(sum, begin, octets - sum_octets) != STATUS_OK ||
        memcmp(sum, begin + octets - sum_octets, sum_octets) != 0)
        return false;
    *at = head_octets;
    *count = (size_t)said;
    return true;
}

/* *out, *octets: of the whole file; NULL: it cannot be read. there: something is. */
static bool read_file(char **out, size_t *octets, bool *there, const Cache *c, const char *path)
{
    struct stat about;
    *out = NULL;
    *there = lstat(path, &about) == 0;
    if (!*there || !S_ISREG(about.st_mode) || about.st_size < 0 || (uint64_t)about.st_size > c->most_octets)
        return false;
    char      why[file_why_size];
    const int file = file_open(why, NULL, path, FILE_FROM_DISK);
    *there = file >= 0 || lstat(path, &about) == 0; /* another process may remove it */
    if (file < 0) return false;
    *octets = (size_t)about.st_size;
    *out = malloc(*octets + 1);
    const bool whole = *out && file_read(file, *out, *octets + 1) == (long)*octets;
    if (whole) futimens(file, NULL); /* used now */
    close(file);
    return whole;
}

bool cache_fetch(void **octets, size_t *count_of, Cache *c, CacheKey *key)
{
    char   path[path_size + 80], *file;
    size_t size, at;
    bool   there;
    end_key(key);
    if (!c || !*key->name) return false;
    snprintf(path, sizeof path, "%s/%s.kept", c->folder, key->name);
    if (read_file(&file, &size, &there, c, path) && cache_entry_read(&at, count_of, key->name, file, size)) {
        memmove(file, file + at, *count_of);
        *octets = file;
        count(c, &c->counters.fetched);
        return true;
    }
    free(file);
    if (!there) return false;
    log_warn("cache: %s is damaged: what it held is made anew", path);
    count(c, &c->counters.damaged);
    output_remove(path);
    return false;
}

/* ---- writing ---------------------------------------------------------------------------------------- */

typedef struct Kept {
    char            name[sha256_text_size + 40];
    off_t           octets;
    struct timespec used;
} Kept;

static int by_use(const void *a, const void *b)
{
    const struct timespec *p = &((const Kept *)a)->used, *q = &((const Kept *)b)->used;
    return p->tv_sec != q->tv_sec ? (p->tv_sec > q->tv_sec) - (p->tv_sec < q->tv_sec)
                                  : (p->tv_nsec > q->tv_nsec) - (p->tv_nsec < q->tv_nsec);
}

static void remove_from(const Cache *c, const char *name)
{
    char path[path_size + sizeof((Kept *)0)->name + 2];
    snprintf(path, sizeof path, "%s/%s", c->folder, name);
    output_remove(path);
}

static bool ends_with(const char *name, const char *end)
{
    const size_t n = strlen(name), m = strlen(end);
    return n >= m && strcmp(name + n - m, end) == 0;
}

/* Removes the least recently used beyond most_octets, and what killed writers left. */
static void make_room(const Cache *c)
{
    Kept          *kept = NULL;
    int            entries = 0, room = 0;
    uint64_t       total = 0;
    DIR           *folder = output_list(c->folder);
    struct dirent *entry;
    while (folder && (entry = readdir(folder))) {
        struct stat about;
        const bool  aside = ends_with(entry->d_name, ".aside");
        if ((!aside && !ends_with(entry->d_name, ".kept")) || strlen(entry->d_name) >= sizeof kept->name ||
            fstatat(dirfd(folder), entry->d_name, &about, AT_SYMLINK_NOFOLLOW) != 0)
            continue;
        if (aside && time(NULL) - about.st_mtime > stale_s) remove_from(c, entry->d_name);
        if (aside) continue;
        if (entries == room) {
            const int larger = room ? 2 * room : 64;
            Kept     *grown = realloc(kept, (size_t)larger * sizeof *grown);
            if (!grown) break;
            kept = grown;
            room = larger;
        }
        kept[entries] = (Kept){.octets = about.st_size, .used = about.st_mtim};
        strcpy(kept[entries++].name, entry->d_name);
        total += (uint64_t)about.st_size;
    }
    if (folder) closedir(folder);
    if (entries > 1) qsort(kept, (size_t)entries, sizeof *kept, by_use);
    for (int i = 0; i < entries && total > c->most_octets; i++) {
        remove_from(c, kept[i].name);
        total -= (uint64_t)kept[i].octets;
    }
    free(kept);
}

static bool write_entry(FILE *file, const char *name, const void *octets, size_t size)
{
    Sha256        *digest = sha256_begin();
    const uint64_t said = size;
    char           sum[sha256_text_size];
    const void    *piece[] = {magic, name, &said, octets};
    const size_t   long_as[] = {sizeof magic, sum_octets, sizeof said, size};
    bool           good = digest;
    for (int i = 0; i < 4 && digest; i++)
        good = good && fwrite(piece[i], 1, long_as[i], file) == long_as[i] &&
               (long_as[i] == 0 || sha256_add(digest, piece[i], long_as[i]));
    if (digest && sha256_end(sum, digest, good) != STATUS_OK) good = false;
    return good && fwrite(sum, 1, sum_octets, file) == sum_octets;
}

void cache_keep(Cache *c, const CacheKey *key, const void *octets, size_t size)
{
    char path[path_size + 80], aside[path_size + 160];
    if (!c || !*key->name) return;
    count(c, &c->counters.made);
    if (size > c->most_octets / 2) return;
    pthread_mutex_lock(&c->mutex);
    const unsigned number = c->written++;
    pthread_mutex_unlock(&c->mutex);
    snprintf(path, sizeof path, "%s/%s.kept", c->folder, key->name);
    snprintf(aside, sizeof aside, "%s/%s.%ld.%u.aside", c->folder, key->name, (long)getpid(), number);
    errno = 0;
    FILE *file = output_file(aside, 0);
    bool  good = file && write_entry(file, key->name, octets, size);
    int   error = errno;
    if (file && fclose(file) != 0 && good) good = false, error = errno;
    if (good && output_rename(aside, path) != 0) good = false, error = errno;
    if (good) {
        make_room(c);
        return;
    }
    if (file) output_remove(aside);
    count(c, &c->counters.failed);
    if (first(c))
        log_warn("cache: %s cannot be written: %s; what it would keep is made anew in every run (cache.folder names "
                 "another, cache.on: off is silent)",
                 c->folder, output_reason(error));
}
