/* pitviper_cache.c: entries of the cache: their names, files, and the room that they take. */
#include "pitviper_cache.h"

#include "pitviper_file.h"
#include "pitviper_output.h"

#include <dlfcn.h>
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
static const char magic[8] = {'P', 'V', 'K', 'E', 'P', 'T', '1', '\n'};

struct Cache {
    char            folder[path_size];
    size_t          most_octets;
    bool            read_only;
    pthread_mutex_t mutex; /* of the rest */
    CacheCounters   counters;
    bool            said_unwritten, said_unread;
    unsigned        written;
};

/* ---- names ------------------------------------------------------------------------------------------ */

/* The program, and the libraries among those it is linked with whose code computes what is kept. Libraries that are
 * loaded later are not among them: a key is the same whenever it is made. */
static bool computes(const char *path)
{
    static const char *const library[] = {"libm.so", "libembree3.so", "libGeographicLib.so", "liberfa.so"};
    const char              *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    for (size_t k = 0; k < sizeof library / sizeof *library; k++)
        if (strncmp(name, library[k], strlen(library[k])) == 0) return true;
    return false;
}

typedef struct BuildIds {
    Sha256 *digest;
    int     objects; /* looked at; the executable is the first */
    bool    good;
} BuildIds;

/* Adds the build id of a loaded object that computes. An executable without one keeps nothing. */
static int add_build_id(struct dl_phdr_info *about, size_t size, void *user)
{
    BuildIds  *ids = user;
    const bool program = ids->objects++ == 0;
    bool       found = false;
    (void)size;
    if (!program && !computes(about->dlpi_name)) return 0;
    for (int i = 0; i < about->dlpi_phnum && !found; i++) {
        const ElfW(Phdr) *part = &about->dlpi_phdr[i];
        if (part->p_type != PT_NOTE) continue;
        const char *at = (const char *)(about->dlpi_addr + part->p_vaddr), *end = at + part->p_memsz;
        while (end - at >= (ptrdiff_t)sizeof(ElfW(Nhdr)) && !found) {
            ElfW(Nhdr) note;
            memcpy(&note, at, sizeof note);
            const char *name = at + sizeof note, *value = name + (note.n_namesz + 3) / 4 * 4;
            found = note.n_type == NT_GNU_BUILD_ID && note.n_namesz == 4 && memcmp(name, "GNU", 4) == 0;
            if (found) ids->good = ids->good && sha256_add(ids->digest, value, note.n_descsz);
            at = value + (note.n_descsz + 3) / 4 * 4;
        }
    }
    ids->good = ids->good && (found || !program);
    return 0;
}

/* Which of its versions of the mathematical functions the C library chose, by the processor and the environment
 * (GLIBC_TUNABLES=glibc.cpu.hwcaps=-FMA): sixteen of these differ in last bits, each for one argument in a thousand to
 * ten thousand. Where in their library they are says it of those that are chosen when they are linked; their values say
 * it of the others, and of a library that was put before. */
static bool add_functions(Sha256 *digest)
{
    static double (*const function[])(double) = {sin,  cos,  tan,  asin, acos,  atan,  exp,  exp2, log,  log2,
                                                 sinh, cosh, tanh, cbrt, expm1, log1p, sqrt, erf,  erfc, log10};
    static float (*const single[])(float) = {sinf, cosf, tanf, expf, exp2f, logf, log2f, atanf};
    enum { doubles = sizeof function / sizeof *function, singles = sizeof single / sizeof *single, places = 1024 };
    double value[doubles + 3];
    float  narrow[singles + 1];
    bool   good = true;
    for (int f = 0; f < doubles + singles && good; f++) {
        void    *address;
        Dl_info  where;
        uint64_t offset = 0;
        memcpy(&address, f < doubles ? (const void *)&function[f] : (const void *)&single[f - doubles], sizeof address);
        if (dladdr(address, &where)) offset = (uint64_t)((const char *)address - (const char *)where.dli_fbase);
        good = sha256_add(digest, &offset, sizeof offset);
    }
    for (int k = 0; k < places && good; k++) {
        volatile double       x = (k + 0.5) / places + 1e-4 * (k % 7);
        const volatile double y = 1 + 30 * x;
        for (int f = 0; f < doubles; f++)
            value[f] = function[f](function[f] == asin || function[f] == acos ? 0.9 * x : y);
        value[doubles] = pow(y, x), value[doubles + 1] = atan2(x, y), value[doubles + 2] = hypot(x, y);
        for (int f = 0; f < singles; f++) narrow[f] = single[f]((float)y);
        narrow[singles] = powf((float)y, (float)x);
        good = sha256_add(digest, value, sizeof value) && sha256_add(digest, narrow, sizeof narrow);
    }
    return good;
}

static char           machine[sha256_text_size]; /* what computes, the same for the whole process; empty: not known */
static pthread_once_t machine_found = PTHREAD_ONCE_INIT;

static void find_machine(void)
{
    BuildIds      ids = {.digest = sha256_begin()};
    const char   *libc = gnu_get_libc_version();
    const uint8_t processor[] = {__builtin_cpu_supports("avx2") != 0, __builtin_cpu_supports("fma") != 0,
                                 __builtin_cpu_supports("avx512f") != 0};
    if (!ids.digest) return;
    ids.good = true;
    dl_iterate_phdr(add_build_id, &ids);
    const bool good = ids.good && sha256_add(ids.digest, libc, strlen(libc) + 1) &&
                      sha256_add(ids.digest, processor, sizeof processor) && add_functions(ids.digest);
    if (sha256_end(machine, ids.digest, good) != STATUS_OK) *machine = 0;
}

CacheKey cache_key(const char *what)
{
    pthread_once(&machine_found, find_machine);
    CacheKey key = {.digest = sha256_begin()};
    key.good = key.digest && *machine;
    cache_key_add(&key, what, strlen(what) + 1);
    cache_key_add(&key, machine, sizeof machine);
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

static bool is_folder(const char *path)
{
    struct stat about;
    return stat(path, &about) == 0 && S_ISDIR(about.st_mode);
}

Cache *cache_open(const char *folder, size_t most_octets)
{
    Cache *c = calloc(1, sizeof *c);
    if (!c) return NULL;
    const bool named = *folder ? snprintf(c->folder, path_size, "%s", folder) < path_size : default_folder(c->folder);
    const bool writable = named && output_folder(c->folder) == 0;
    const int  error = errno;
    c->most_octets = most_octets;
    c->read_only = named && !writable && is_folder(c->folder);
    if ((writable || c->read_only) && pthread_mutex_init(&c->mutex, NULL) == 0) {
        if (writable) make_room(c); /* most_octets may be less than it was */
        else
            log_warn("cache: %s cannot be written: %s; what is in it is used, and nothing new is kept (cache.folder "
                     "names another, cache.on: off is silent)",
                     c->folder, output_reason(error));
        return c;
    }
    if (named)
        log_warn("cache: %s cannot be made: %s; everything is made anew in every run (cache.folder names another, "
                 "cache.on: off is silent)",
                 c->folder, output_reason(error));
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

/* Whether this failure is the first; said: of the cache's. */
static bool first(Cache *c, bool *said)
{
    pthread_mutex_lock(&c->mutex);
    const bool is_first = !*said;
    *said = true;
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

typedef enum Found { FOUND_NONE, FOUND_FILE, FOUND_UNREAD } Found;

/* FOUND_FILE: *out, *octets; the caller frees it. FOUND_UNREAD: something is there, why says what keeps it from being
 * read. What is no regular file is not opened, and a link not followed. A file that went meanwhile is none, and so is
 * one that is larger than the cache or than the memory. */
static Found read_file(char **out, size_t *octets, char why[file_why_size], const Cache *c, const char *path)
{
    struct stat about, opened;
    if (lstat(path, &about) != 0) {
        snprintf(why, file_why_size, "%s", strerror(errno));
        return errno == ENOENT ? FOUND_NONE : FOUND_UNREAD;
    }
    if (S_ISLNK(about.st_mode)) {
        snprintf(why, file_why_size, "it is a symbolic link, and none is followed here");
        return FOUND_UNREAD;
    }
    const int file = file_open(why, NULL, path, FILE_FROM_DISK);
    if (file < 0) return lstat(path, &about) == 0 ? FOUND_UNREAD : FOUND_NONE;
    const bool same = fstat(file, &opened) == 0 && opened.st_ino == about.st_ino && opened.st_dev == about.st_dev;
    Found      found = FOUND_NONE;
    if (same && (uint64_t)opened.st_size <= c->most_octets && (*out = malloc((size_t)opened.st_size + 1))) {
        const long got = file_read(file, *out, (size_t)opened.st_size + 1);
        *octets = got > 0 ? (size_t)got : 0;
        found = got < 0 ? FOUND_UNREAD : FOUND_FILE;
        if (got < 0) snprintf(why, file_why_size, "%s", strerror(errno)), free(*out);
        else futimens(file, NULL); /* used now */
    }
    close(file);
    return found;
}

bool cache_fetch(void **octets, size_t *count_of, Cache *c, CacheKey *key)
{
    char   path[path_size + 80], why[file_why_size], *file;
    size_t size, at;
    end_key(key);
    if (!c || !*key->name) return false;
    snprintf(path, sizeof path, "%s/%s.kept", c->folder, key->name);
    const Found found = read_file(&file, &size, why, c, path);
    if (found == FOUND_UNREAD && first(c, &c->said_unread))
        log_warn("cache: %s cannot be read: %s; what it would hold is made anew", path, why);
    if (found != FOUND_FILE) return false;
    if (cache_entry_read(&at, count_of, key->name, file, size)) {
        memmove(file, file + at, *count_of);
        *octets = file;
        count(c, &c->counters.fetched);
        return true;
    }
    free(file);
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

/* Whether it is gone. left: only a file that no process is writing. */
static bool remove_from(const Cache *c, const char *name, bool left)
{
    char path[path_size + sizeof((Kept *)0)->name + 2];
    snprintf(path, sizeof path, "%s/%s", c->folder, name);
    return left ? output_remove_left(path) : output_remove(path) == 0 || errno == ENOENT;
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
            fstatat(dirfd(folder), entry->d_name, &about, AT_SYMLINK_NOFOLLOW) != 0 || !S_ISREG(about.st_mode))
            continue;
        if (aside) remove_from(c, entry->d_name, true);
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
    for (int i = 0; i < entries && total > c->most_octets; i++)
        if (remove_from(c, kept[i].name, false)) total -= (uint64_t)kept[i].octets;
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

/* Writes the entry beside its name, and renames it. The file stays locked until then, by which a sweep knows that its
 * writer lives. Returns 0, or the error. */
static int write_aside(const char *aside, const char *path, const CacheKey *key, const void *octets, size_t size)
{
    errno = 0;
    FILE *file = output_file(aside, 0);
    if (!file) return errno;
    const int locked = dup(fileno(file));
    bool      good = locked >= 0 && write_entry(file, key->name, octets, size);
    int       error = errno;
    if (fclose(file) != 0 && good) good = false, error = errno;
    if (good && output_rename(aside, path) != 0) good = false, error = errno;
    if (!good) output_remove(aside);
    if (locked >= 0) close(locked);
    return good ? 0 : error ? error : EIO;
}

void cache_keep(Cache *c, const CacheKey *key, const void *octets, size_t size)
{
    char            path[path_size + 80], aside[path_size + 160];
    struct timespec now = {0};
    if (!c || !*key->name) return;
    count(c, &c->counters.made);
    if (c->read_only || size > c->most_octets / 2) return;
    pthread_mutex_lock(&c->mutex);
    const unsigned number = c->written++;
    pthread_mutex_unlock(&c->mutex);
    clock_gettime(CLOCK_REALTIME, &now); /* process numbers repeat among containers that share a folder */
    snprintf(path, sizeof path, "%s/%s.kept", c->folder, key->name);
    snprintf(aside, sizeof aside, "%s/%s.%ld.%u.%ld.aside", c->folder, key->name, (long)getpid(), number, now.tv_nsec);
    const int error = write_aside(aside, path, key, octets, size);
    if (error == 0) {
        make_room(c);
        return;
    }
    count(c, &c->counters.failed);
    if (first(c, &c->said_unwritten))
        log_warn("cache: %s cannot be written: %s; what it would keep is made anew in every run (cache.folder names "
                 "another, cache.on: off is silent)",
                 c->folder, output_reason(error));
}
