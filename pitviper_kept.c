/* pitviper_kept.c: values of the cache's entries, to octets and back (pitviper_kept.h). */
#include "pitviper_kept.h"

#include <math.h>
#include <stdlib.h>

void kept_pass(Kept *k, void *value, size_t octets)
{
    if ((k->to || k->from) && octets > k->most - k->count) k->good = false;
    if (!k->good || octets == 0) return;
    if (k->to) memcpy(k->to + k->count, value, octets);
    if (k->from) memcpy(value, k->from + k->count, octets);
    k->count += octets;
}

void kept_doubles(Kept *k, double *value, size_t count)
{
    kept_pass(k, value, count * sizeof *value);
    for (size_t i = 0; k->from && k->good && i < count; i++) k->good = isfinite(value[i]);
}

void kept_floats(Kept *k, float *value, size_t count)
{
    kept_pass(k, value, count * sizeof *value);
    for (size_t i = 0; k->from && k->good && i < count; i++) k->good = isfinite(value[i]);
}

bool kept_read(KeptValues *values, void *user, const void *octets, size_t count)
{
    Kept k = {.from = octets, .most = count, .good = true};
    values(&k, user);
    return k.good && k.count == count;
}

void *kept_write(size_t *count, KeptValues *values, void *user)
{
    Kept counted = {.good = true};
    values(&counted, user);
    Kept k = {.to = malloc(counted.count + 1), .most = counted.count, .good = true};
    if (!k.to) return NULL;
    values(&k, user);
    *count = k.count;
    return k.to;
}

bool kept_fetch(KeptValues *values, void *user, Cache *cache, CacheKey *key)
{
    void  *octets;
    size_t count;
    if (!cache_fetch(&octets, &count, cache, key)) return false;
    const bool good = kept_read(values, user, octets, count);
    free(octets);
    return good;
}

void kept_keep(KeptValues *values, void *user, Cache *cache, const CacheKey *key)
{
    size_t count = 0;
    void  *octets = cache && *key->name ? kept_write(&count, values, user) : NULL;
    if (octets) cache_keep(cache, key, octets, count);
    free(octets);
}
