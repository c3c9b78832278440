/* tests/fuzz/run_corpus.c: drives the fuzz entry points where there is no fuzzer: fuzz_tests TARGET [FILE|FOLDER ...].
 *
 * With files or folders of files named: each of them, as a fuzzer left them. Without: its own seeds, spoilt in ways
 * that depend on a counter alone, so that a failure comes again. */
#include "tests/fuzz/fuzz_seed.h"

#include "pitviper.h"

#include <dirent.h>
#include <stdlib.h>

/* Every fuzz_TARGET.c, its names of fuzz_seed.h with TARGET in them; the list and its length are
 * tests/CMakeLists.txt's. */
typedef struct Target {
    const char *name;
    int (*one)(const uint8_t *data, size_t size);
    size_t (*seed)(uint8_t *out, uint32_t index);
    const int *rounds;
} Target;
#define X(name)                                                                                                        \
    int              name##_one(const uint8_t *data, size_t size);                                                     \
    size_t           name##_seed(uint8_t *out, uint32_t index);                                                        \
    extern const int name##_rounds;
FUZZ_TARGETS
#undef X
#define X(name) {#name, name##_one, name##_seed, &name##_rounds},
static const Target targets[] = {FUZZ_TARGETS};

static const Target *target;
static int           inputs;

/* In memory of exactly its size: a sanitizer sees the first octet too many. */
static void run_exactly(const uint8_t *data, size_t size)
{
    uint8_t *exact = malloc(size ? size : 1);
    if (!exact) abort();
    memcpy(exact, data, size);
    target->one(exact, size);
    free(exact);
    inputs++;
}

static int run_file(const char *path)
{
    FILE *file = fopen(path, "rb");
    if (!file) {
        perror(path);
        return 1;
    }
    uint8_t *data = NULL;
    size_t   size = 0, capacity = 0, got = 0;
    do {
        size += got;
        if (size == capacity) {
            capacity = capacity ? 2 * capacity : 1 << 16;
            uint8_t *grown = realloc(data, capacity);
            if (!grown) abort();
            data = grown;
        }
        got = fread(data + size, 1, capacity - size, file);
    } while (got > 0);
    const int failed = ferror(file) != 0;
    fclose(file);
    if (failed) fprintf(stderr, "%s: cannot be read\n", path);
    else run_exactly(data, size);
    free(data);
    return failed;
}

static int not_hidden(const struct dirent *entry) { return entry->d_name[0] != '.'; }

/* Every file of a folder, in order of name; said before it runs, for a crash says nothing itself. */
static int run_path(const char *path)
{
    struct dirent **entry;
    const int       count = scandir(path, &entry, not_hidden, alphasort);
    int             failed = 0;
    if (count < 0) return run_file(path);
    for (int i = 0; i < count; i++) {
        char full[4096];
        if ((size_t)snprintf(full, sizeof full, "%s/%s", path, entry[i]->d_name) >= sizeof full) abort();
        puts(entry[i]->d_name);
        fflush(stdout);
        failed |= run_file(full);
        free(entry[i]);
    }
    free(entry);
    return failed;
}

/* Flips, overwrites with values on edges, cuts, repeats and removes. */
static size_t spoil(uint8_t *data, size_t size, uint32_t round)
{
    static const uint8_t  edge[] = {0, 1, 7, 8, 11, 12, 127, 128, 143, 144, 254, 255};
    static const uint32_t key[2] = {0xF022, 0};
    uint32_t              word[4] = {0};
    random_u32x4(word, (const uint32_t[4]){round, 0, 0, 0}, key);
    const uint32_t changes = word[0] % 6; /* none: the seed itself */
    for (uint32_t i = 1; i <= changes && size; i++) {
        random_u32x4(word, (const uint32_t[4]){round, i, 0, 0}, key);
        const size_t at = word[0] % size, octets = word[1] % (size - at) + 1;
        switch (word[2] % 8) {
        case 0:
            data[at] ^= (uint8_t)(1 << word[3] % 8);
            break;
        case 1:
            data[at] = edge[word[3] % sizeof edge];
            break;
        case 2:
            data[at] = (uint8_t)word[3];
            break;
        case 3:
            data[word[0] % (size < 128 ? size : 128)] = (uint8_t)word[3];
            break; /* where the headers are */
        case 4:
            size = at;
            break;
        case 5:
            memmove(data + at, data + at + octets, size - at - octets);
            size -= octets;
            break;
        case 6:
            if (size + octets > fuzz_seed_octets) break;
            memmove(data + at + octets, data + at, size - at);
            size += octets;
            break;
        default:
            memset(data + at, (int)word[3] & 255, octets < 8 ? octets : 8);
            break;
        }
    }
    return size;
}

int main(int argc, char **argv)
{
    static uint8_t data[fuzz_seed_octets];
    int            failed = 0;
    for (size_t i = 0; argc > 1 && i < sizeof targets / sizeof *targets; i++)
        if (strcmp(targets[i].name, argv[1]) == 0) target = &targets[i];
    if (!target) {
        fputs("usage: fuzz_tests TARGET [FILE|FOLDER ...]\n", stderr);
        return 2;
    }
    for (int i = 2; i < argc; i++) failed |= run_path(argv[i]);
    for (int round = 0; argc < 3 && round < *target->rounds; round++) {
        const size_t size = target->seed(data, (uint32_t)round);
        run_exactly(data, spoil(data, size, (uint32_t)round));
    }
    printf("%d inputs\n", inputs);
    return failed || inputs == 0;
}
