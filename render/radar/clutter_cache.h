/* render/radar/clutter_cache.h: the ground's scatterers, kept from frame to frame: drawing one costs some 2 us, finding
 * it again 0.1 us. They are functions of their cells, so what is kept changes no bit. 36 MB for 131072. */
#ifndef RENDER_RADAR_CLUTTER_CACHE_H
#define RENDER_RADAR_CLUTTER_CACHE_H

#include "render/radar/clutter.h"

typedef struct ClutterCache ClutterCache;

/* For one grid, table and band. */
Status clutter_cache_create(ClutterCache **out);
void   clutter_cache_destroy(ClutterCache *cache); /* accepts NULL */
/* As clutter_draw; cache NULL: just that. Any number of threads. */
void   clutter_cache_draw(ClutterScatterer *out, ClutterCache *cache, const ClutterGrid *grid, const ClutterTable *table,
                          ClutterBand band, int count, const ClutterCell *cell, const uint8_t *surface);
/* Scatterers drawn and found so far. */
void   clutter_cache_counters(uint64_t out[2], ClutterCache *cache);

#endif
