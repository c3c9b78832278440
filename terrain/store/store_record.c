/* terrain/store/store_record.c: the options that a store was made with, as a record that is found and checked by itself:
 * also in a file that was cut, has a damaged header, or was written by another version. */
#include "terrain/store/store_format.h"

#include "pitviper_file.h"

#include <stdlib.h>
#include <unistd.h>

/* MARK HASH LENGTH\n OPTIONS: the same in every version. It lies in the header's texts, before any section. */
static const char mark[] = "terrain-import-options ";
enum { record_most = store_page + 2 * store_most_text };

static uint64_t record_hash(const char *options, size_t length) { return store_hash(3, options, length); }

char *store_record(const char *options)
{
    char        *out = NULL;
    size_t       octets = 0;
    const size_t length = strlen(options);
    FILE        *to = open_memstream(&out, &octets);
    if (!to) return NULL;
    fprintf(to, "%s%016llx %zu\n%s", mark, (unsigned long long)record_hash(options, length), length, options);
    const bool whole = !ferror(to);
    if (fclose(to) == 0 && whole) return out;
    free(out);
    return NULL;
}

/* Options within a record of `size` octets, which a 0 ends; NULL: damaged. */
static const char *options_of(const char *record, size_t size, size_t *length)
{
    unsigned long long hash;
    int                at = 0;
    if (strncmp(record, mark, sizeof mark - 1) != 0) return NULL;
    if (sscanf(record + sizeof mark - 1, "%16llx %7zu%n", &hash, length, &at) < 2 || at == 0) return NULL;
    const size_t from = sizeof mark - 1 + (size_t)at;
    if (from >= size || record[from] != '\n' || *length == 0 || *length > size - from - 1) return NULL;
    return record_hash(record + from + 1, *length) == hash ? record + from + 1 : NULL;
}

const char *store_record_options(const char *text)
{
    size_t      length;
    const char *options = options_of(text, strlen(text), &length);
    return options ? options : text;
}

char *store_recall(const char *path)
{
    char      *all = malloc(record_most + 1), *out = NULL;
    char       why[file_why_size];
    const int  file = file_open(why, NULL, path, FILE_FROM_DISK);
    const long size = all && file >= 0 ? file_read(file, all, record_most) : 0;
    if (file >= 0) close(file);
    if (size > (long)sizeof store_magic && memcmp(all, store_magic, sizeof store_magic) == 0) {
        all[size] = 0;
        const char *end = all + size;
        for (char *at = all; !out && (at = memmem(at, (size_t)(end - at), mark, sizeof mark - 1)); at++) {
            size_t      length;
            const char *options = options_of(at, (size_t)(end - at), &length);
            if (options) out = strndup(options, length);
        }
    }
    free(all);
    return out;
}
