/* sensor/score/tracks_counts.c: bounded lists of truths, tracks and pairs of them, found by key. */
#include "sensor/score/tracks_private.h"

#include <stdlib.h>

static uint64_t key_of(const TracksList *list, int row)
{
    uint64_t key;
    memcpy(&key, (const char *)list->item + (size_t)row * list->size, sizeof key);
    return key;
}

/* The entry of a key, or the empty one where it would be. */
static uint32_t *entry_of(const TracksList *list, uint64_t salt, uint64_t key)
{
    uint64_t h = (key ^ salt) * 0x9e3779b97f4a7c15u;
    h = ((h ^ h >> 32) + salt) * 0xd6e8feb86659fd93u;
    h ^= h >> 32;
    uint32_t at = (uint32_t)h & list->index.mask;
    while (list->index.entry[at] && key_of(list, (int)list->index.entry[at] - 1) != key)
        at = (at + 1) & list->index.mask;
    return &list->index.entry[at];
}

static void enter_all(TracksList *list, uint64_t salt)
{
    memset(list->index.entry, 0, ((size_t)list->index.mask + 1) * sizeof *list->index.entry);
    for (int i = 0; i < list->count; i++) *entry_of(list, salt, key_of(list, i)) = (uint32_t)i + 1;
}

static bool grow(TracksList *list, uint64_t salt)
{
    const int capacity = list->capacity ? 2 * list->capacity : 64;
    void     *item = realloc(list->item, (size_t)capacity * list->size);
    if (!item) return false;
    list->item = item;
    uint32_t *entry = calloc(2 * (size_t)capacity, sizeof *entry);
    if (!entry) return false;
    free(list->index.entry);
    list->capacity = capacity;
    list->index = (TracksIndex){entry, 2 * (uint32_t)capacity - 1};
    enter_all(list, salt);
    return true;
}

void *tracks_list_find(const TracksList *list, uint64_t salt, uint64_t key)
{
    if (!list->count) return NULL;
    const uint32_t row = *entry_of(list, salt, key);
    return row ? (char *)list->item + (size_t)(row - 1) * list->size : NULL;
}

void *tracks_list_add(TracksList *list, uint64_t salt, uint64_t key, int most)
{
    void *there = tracks_list_find(list, salt, key);
    if (there || list->count >= most) return there;
    if (list->count == list->capacity && !grow(list, salt)) return NULL;
    *entry_of(list, salt, key) = (uint32_t)list->count + 1;
    void *item = (char *)list->item + (size_t)list->count++ * list->size;
    memset(item, 0, list->size);
    memcpy(item, &key, sizeof key);
    return item;
}

void tracks_list_free(TracksList *list)
{
    free(list->item);
    free(list->index.entry);
    *list = (TracksList){.size = list->size};
}

void tracks_list_keep(TracksList *list, uint64_t salt, bool (*keep)(const void *item, const void *user),
                      const void *user)
{
    int kept = 0;
    for (int i = 0; i < list->count; i++) {
        char *item = (char *)list->item + (size_t)i * list->size;
        if (!keep(item, user)) continue;
        memmove((char *)list->item + (size_t)kept++ * list->size, item, list->size);
    }
    list->count = kept;
    enter_all(list, salt);
}

/* ---- pairs and tracks ------------------------------------------------------------------------ */

static int by_value(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* The value that a quarter of the items do not exceed. */
static Status lowest_quarter(uint64_t *out, const TracksList *list, uint64_t (*value)(const void *item))
{
    uint64_t *all = malloc((size_t)list->count * sizeof *all);
    if (!all) return STATUS_NO_MEMORY;
    for (int i = 0; i < list->count; i++) all[i] = value((const char *)list->item + (size_t)i * list->size);
    qsort(all, (size_t)list->count, sizeof *all, by_value);
    *out = all[(list->count - 1) / 4];
    free(all);
    return STATUS_OK;
}

static uint64_t met_of(const void *pair) { return ((const TracksPairCount *)pair)->met; }
static bool     met_more(const void *pair, const void *than) { return met_of(pair) > *(const uint64_t *)than; }

static Status pair_of(TracksPairCount **out, Tracks *t, int truth, uint32_t track)
{
    const uint64_t key = (uint64_t)truth << 32 | track;
    *out = tracks_list_add(&t->pairs, t->salt, key, tracks_pairs_most);
    if (*out) return STATUS_OK;
    if (t->pairs.count < tracks_pairs_most) return STATUS_NO_MEMORY;
    uint64_t least;
    if (lowest_quarter(&least, &t->pairs, met_of) != STATUS_OK) return STATUS_NO_MEMORY;
    const int before = t->pairs.count;
    for (int i = 0; i < before; i++) {
        const TracksPairCount *pair = &((const TracksPairCount *)t->pairs.item)[i];
        if (pair->met <= least) t->sum.idtp_dropped += pair->met;
    }
    tracks_list_keep(&t->pairs, t->salt, met_more, &least);
    t->sum.pairs_dropped += (uint64_t)(before - t->pairs.count);
    *out = tracks_list_add(&t->pairs, t->salt, key, tracks_pairs_most);
    return *out ? STATUS_OK : STATUS_NO_MEMORY;
}

Status tracks_count_pair(Tracks *t, int truth, uint32_t track)
{
    TracksPairCount *pair;
    const Status     status = pair_of(&pair, t, truth, track);
    if (status == STATUS_OK) pair->met++;
    return status;
}

static uint64_t last_frame_of(const void *track) { return ((const TracksOpen *)track)->last_frame; }
static bool seen_later(const void *track, const void *than) { return last_frame_of(track) > *(const uint64_t *)than; }

void tracks_close(TracksScore *score, const TracksOpen *track)
{
    score->tracks++;
    if (!track->matched) {
        score->tracks_false++;
        return;
    }
    score->purity += (double)track->best / track->answers;
    score->length += track->answers;
    if (track->answers > score->length_most) score->length_most = track->answers;
}

static Status open_of(TracksOpen **out, Tracks *t, uint32_t track)
{
    *out = tracks_list_add(&t->open, t->salt, track, tracks_open_most);
    if (*out) return STATUS_OK;
    if (t->open.count < tracks_open_most) return STATUS_NO_MEMORY;
    uint64_t last;
    if (lowest_quarter(&last, &t->open, last_frame_of) != STATUS_OK) return STATUS_NO_MEMORY;
    const int before = t->open.count;
    for (int i = 0; i < before; i++) {
        const TracksOpen *open = &((const TracksOpen *)t->open.item)[i];
        if (open->last_frame <= last) tracks_close(&t->sum, open);
    }
    tracks_list_keep(&t->open, t->salt, seen_later, &last);
    t->sum.tracks_ended += (uint64_t)(before - t->open.count);
    *out = tracks_list_add(&t->open, t->salt, track, tracks_open_most);
    return *out ? STATUS_OK : STATUS_NO_MEMORY;
}

Status tracks_count_answer(Tracks *t, uint32_t track)
{
    TracksOpen  *open;
    const Status status = open_of(&open, t, track);
    if (status != STATUS_OK) return status;
    open->answers++;
    open->last_frame = t->frame;
    return STATUS_OK;
}

Status tracks_count_match(Tracks *t, int truth, uint32_t track)
{
    TracksPairCount *pair;
    TracksOpen      *open;
    Status           status = pair_of(&pair, t, truth, track);
    if (status != STATUS_OK || (status = open_of(&open, t, track)) != STATUS_OK) return status;
    pair->matched++;
    open->matched++;
    if (pair->matched > open->best) open->best = pair->matched;
    return STATUS_OK;
}
