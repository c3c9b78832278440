/* pitviper_kept.h: values of an entry of the cache (pitviper_cache.h), which one function writes and reads.
 *
 * The function passes each value in turn: while an entry is written they are its octets, one after the other; while it
 * is read they are set to them. It is called twice to write: first to count. What it is to read from may be damaged, so
 * it checks what it has read (kept_check), and passes no more values than it has room for. */
#ifndef PITVIPER_KEPT_H
#define PITVIPER_KEPT_H

#include "pitviper_cache.h"

typedef struct Kept {
    char       *to;   /* NULL while octets are counted, or read */
    const char *from; /* NULL while they are counted, or written */
    size_t      count, most;
    bool        good; /* so far */
} Kept;
typedef void KeptValues(Kept *kept, void *user);

static inline bool kept_is_read(const Kept *kept) { return kept->from; }
/* While an entry is read, what it says is wrong unless `is`. */
static inline void kept_check(Kept *kept, bool is) { kept->good = kept->good && (!kept->from || is); }
/* Whether there is so much left to read: before room is made for it. True while an entry is written. */
static inline bool kept_has(Kept *kept, size_t octets)
{
    kept_check(kept, octets <= kept->most - kept->count); /* where it is read */
    return kept->good;
}
/* Values without padding and pointers. Where there are too few octets, or a check has failed, they stay as they are. */
void kept_pass(Kept *kept, void *value, size_t octets);
/* The same of numbers that are finite. */
void kept_doubles(Kept *kept, double *value, size_t count);
void kept_floats(Kept *kept, float *value, size_t count);

/* Reads the entry of a key, which it ends (cache_fetch). False: there is none, or it is not one of these values: what
 * was passed is to be made anew then. */
bool kept_fetch(KeptValues *values, void *user, Cache *cache, CacheKey *key);
/* Writes the entry. */
void kept_keep(KeptValues *values, void *user, Cache *cache, const CacheKey *key);
/* Octets as an entry's: whether they are just these values. */
bool kept_read(KeptValues *values, void *user, const void *octets, size_t count);
/* The octets of these values, or NULL: no memory. The caller frees them. */
void *kept_write(size_t *count, KeptValues *values, void *user);

#endif
