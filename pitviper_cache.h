/* pitviper_cache.h: results that their inputs decide, kept on disk between runs.
 *
 * An entry's name is the SHA-256 of all that its octets follow from: what it is, its inputs, the executable and the
 * libraries that compute (their build ids), and the versions of the C library's functions, which the processor and the
 * environment choose. So an entry is never wrong for being old; what does not fit has another name.
 * FOLDER/NAME.kept, little-endian, as all that this program runs on:
 *
 *     octets 0  "PVKEPT1\n"   8  NAME, 64 hexadecimal digits   72  count, 64 bits   80  count octets   end  SHA-256 of
 * all
 *
 * Entries are written beside their name and renamed, so that several processes may share a folder; the least recently
 * used are removed beyond its size, and so is what killed writers left. Of a folder that cannot be written, what is in
 * it is used. A cache that cannot be used costs time alone: that is said once. */
#ifndef PITVIPER_CACHE_H
#define PITVIPER_CACHE_H

#include "pitviper_sha256.h"

typedef struct Cache Cache;

/* folder: made if it is not there; empty: $XDG_CACHE_HOME/pitviper, else ~/.cache/pitviper. NULL: it cannot be used, or
 * there is no such place; logged. */
Cache *cache_open(const char *folder, size_t most_octets);
void   cache_close(Cache *cache); /* accepts NULL */

/* An entry that is looked for. */
typedef struct CacheKey {
    Sha256 *digest; /* NULL: no memory; such an entry is not kept */
    bool    good;
    char    name[sha256_text_size]; /* cache_fetch; empty: none */
} CacheKey;
CacheKey cache_key(const char *what);
void     cache_key_add(CacheKey *key, const void *octets, size_t count); /* without padding and pointers */

/* Ends the key, and reads the entry of its name. *octets: the caller frees them. False: there is none, or none that can
 * be read, which is said. cache NULL:
 * false. Thread-safe, as cache_keep. */
bool cache_fetch(void **octets, size_t *count, Cache *cache, CacheKey *key);
/* Writes the entry. cache NULL, or a key without a name: nothing. */
void cache_keep(Cache *cache, const CacheKey *key, const void *octets, size_t count);

/* damaged: entries that were removed for their contents; failed: those that could not be written. */
typedef struct CacheCounters {
    uint64_t fetched, made, damaged, failed;
} CacheCounters;
CacheCounters cache_counters(Cache *cache);

/* The octets of a file into those of its entry. False: it is not one of this name. *at: where in the file. */
bool cache_entry_read(size_t *at, size_t *count, const char name[sha256_text_size], const void *file, size_t octets);

#endif
