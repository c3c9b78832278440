/* tests/alloc/fail_alloc.c: an allocation of the program's own fails, once, at a place of one's choice. Preloaded:
 *
 *     FAIL_ALLOC_LIST=FILE   a line for each place the program allocates from: its name and the calls that led there
 *     FAIL_ALLOC=PLACE       the first allocation there fails; FILE then has the line `failed PLACE`
 *     FAIL_ALLOC_STAYS=1     and so do all that follow, wherever they are
 *
 * A place is the chain of the four innermost return addresses within the program itself: a helper that everybody calls
 * is as many places as it has callers. What libraries allocate for themselves is theirs. tests/system/test_alloc.sh */
#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif
#include <errno.h>
#include <execinfo.h>
#include <fcntl.h>
#include <link.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

void        *__libc_malloc(size_t size);
void        *__libc_calloc(size_t count, size_t size);
void        *__libc_realloc(void *old, size_t size);
void        *__libc_memalign(size_t alignment, size_t size);
void         _ZSt17__throw_bad_allocv(void) __attribute__((noreturn)); /* of libstdc++ */
#pragma weak _ZSt17__throw_bad_allocv

/* list_octets: lines, then zeros; where the next line goes at the end. */
enum { list_octets = 1 << 21, depth_most = 4, unwound_most = 24, places_most = 1 << 16 };

static uintptr_t          base, text_begin, text_end;
static char              *list; /* FILE in memory, shared by all processes: one that is confined may write no file */
static uint64_t           chosen;
static bool               has_chosen, stays;
static atomic_bool        failed;
static _Thread_local bool busy;
static _Atomic uint64_t   seen[places_most];

static int find_text(struct dl_phdr_info *info, size_t size, void *user)
{
    (void)size;
    (void)user;
    base = info->dlpi_addr;
    for (int i = 0; i < info->dlpi_phnum; i++) {
        const ElfW(Phdr) *p = &info->dlpi_phdr[i];
        if (p->p_type != PT_LOAD || !(p->p_flags & PF_X)) continue;
        text_begin = base + p->p_vaddr;
        text_end = text_begin + p->p_memsz;
    }
    return 1; /* the program itself is the first */
}

__attribute__((constructor)) static void begin(void)
{
    void       *warm[2];
    const char *path = getenv("FAIL_ALLOC_LIST"), *place = getenv("FAIL_ALLOC");
    busy = true;
    backtrace(warm, 2); /* loads what it needs, which allocates */
    if (path) {
        const int file = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0644);
        void     *shared = file >= 0 && ftruncate(file, list_octets) == 0
                               ? mmap(NULL, list_octets, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0)
                               : MAP_FAILED;
        if (shared == MAP_FAILED) abort();
        close(file);
        list = shared;
    }
    if (place) {
        chosen = strtoull(place, NULL, 16);
        has_chosen = true;
    }
    stays = getenv("FAIL_ALLOC_STAYS") != NULL;
    busy = false;
    if (path || place) dl_iterate_phdr(find_text, NULL);
}

static void say(const char *line, int length)
{
    if (!list || length <= 0) return;
    const uint64_t at =
        atomic_fetch_add((_Atomic uint64_t *)(void *)(list + list_octets - sizeof(uint64_t)), (uint64_t)length);
    if (at + (uint64_t)length > list_octets - sizeof(uint64_t)) abort();
    memcpy(list + at, line, (size_t)length);
}

/* False when this place was met before. */
static bool is_new(uint64_t place)
{
    for (uint64_t i = place % places_most;; i = (i + 1) % places_most) {
        uint64_t none = 0;
        if (seen[i] == place) return false;
        if (atomic_compare_exchange_strong(&seen[i], &none, place)) return true;
    }
}

/* Whether the call that returns to `caller` is to fail. */
static bool fails(const void *caller)
{
    if ((uintptr_t)caller < text_begin || (uintptr_t)caller >= text_end || busy) return false;
    if (failed) return stays;
    busy = true;
    void     *at[unwound_most];
    const int count = backtrace(at, unwound_most);
    uint64_t  place = UINT64_C(0xcbf29ce484222325);
    uintptr_t chain[depth_most];
    int       depth = 0;
    for (int i = 0; i < count && depth < depth_most; i++) {
        if ((uintptr_t)at[i] < text_begin || (uintptr_t)at[i] >= text_end) continue;
        chain[depth++] = (uintptr_t)at[i] - base;
        place = (place ^ chain[depth - 1]) * UINT64_C(0x100000001b3);
    }
    const bool hit = has_chosen && !failed && place == chosen;
    char       line[160];
    int        length = 0;
    if (hit) {
        failed = true;
        length = snprintf(line, sizeof line, "failed %016llx\n", (unsigned long long)place);
    } else if (!has_chosen && is_new(place)) {
        length = snprintf(line, sizeof line, "%016llx", (unsigned long long)place);
        for (int i = 0; i < depth; i++)
            length += snprintf(line + length, sizeof line - (size_t)length, " %lx", (long)chain[i]);
        line[length++] = '\n';
    }
    say(line, length);
    busy = false;
    if (hit) errno = ENOMEM;
    return hit;
}

#define FAILS fails(__builtin_return_address(0))

void *malloc(size_t size) { return FAILS ? NULL : __libc_malloc(size); }
void *calloc(size_t count, size_t size) { return FAILS ? NULL : __libc_calloc(count, size); }
void *realloc(void *old, size_t size) { return FAILS ? NULL : __libc_realloc(old, size); }
void *aligned_alloc(size_t alignment, size_t size) { return FAILS ? NULL : __libc_memalign(alignment, size); }

int posix_memalign(void **out, size_t alignment, size_t size)
{
    void *got = FAILS ? NULL : __libc_memalign(alignment, size);
    if (got) *out = got;
    return got ? 0 : ENOMEM;
}

char *strdup(const char *text)
{
    const size_t size = strlen(text) + 1;
    char        *copy = FAILS ? NULL : __libc_malloc(size);
    return copy ? memcpy(copy, text, size) : NULL;
}

char *strndup(const char *text, size_t most)
{
    const size_t length = strnlen(text, most);
    char        *copy = FAILS ? NULL : __libc_malloc(length + 1);
    if (!copy) return NULL;
    copy[length] = 0;
    return memcpy(copy, text, length);
}

/* operator new and operator new[]: our C++ has its vectors inline, and so their callers in the program */
void *_Znwm(size_t size);
void *_Znam(size_t size);

void *_Znwm(size_t size)
{
    void *got = FAILS ? NULL : __libc_malloc(size ? size : 1);
    if (!got) _ZSt17__throw_bad_allocv();
    return got;
}

void *_Znam(size_t size)
{
    void *got = FAILS ? NULL : __libc_malloc(size ? size : 1);
    if (!got) _ZSt17__throw_bad_allocv();
    return got;
}
