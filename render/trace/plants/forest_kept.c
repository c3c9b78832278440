/* render/trace/plants/forest_kept.c: what rays find of prototypes, texels of tables and light of quads, from the cache
 * and into it.
 *
 * Each value is a pure function of its prototype, so an entry is right whatever share of the values it has, and the
 * picture is the same with it and without. An entry is fetched when the first of its values is asked for that is not
 * there, so that only the elevations that a run looks from are read. */
#include "render/trace/plants/forest_private.h"

#include <stdio.h>
#include <stdlib.h>

enum { way_texels = table_side * table_side, row_texels = table_azimuths * way_texels, words = table_side / 64 };
_Static_assert(table_side % 64 == 0, "whole words of bits");

struct ForestKept {
    Cache    *cache;
    char      name[sha256_text_size]; /* of the prototypes */
    bool      fine;                   /* which of their shapes */
    ShapeKept of[PLANT_STANDING];
};

/* ---- octets of texels --------------------------------------------------------------------------- */

static bool is_hit(uint32_t texel, int quads)
{
    const uint32_t of = texel & table_quad_mask;
    const int32_t  depth = (int32_t)texel >> table_quad_bits;
    return of >= 2 && of < (uint32_t)quads + 2 && depth >= -table_depth_steps && depth <= table_depth_steps;
}

static inline bool has(const uint64_t set[words], int k) { return set[k >> 6] >> (k & 63) & 1; }

static int count_of(const uint64_t set[words])
{
    int count = 0;
    for (int w = 0; w < words; w++) count += __builtin_popcountll(set[w]);
    return count;
}

static bool is_within(const uint64_t set[words], const uint64_t all[words])
{
    uint64_t beyond = 0;
    for (int w = 0; w < words; w++) beyond |= set[w] & ~all[w];
    return !beyond;
}

/* Returns how many texels are known. line NULL: what is read is only checked. */
static uint32_t pass_line(Kept *kept, uint32_t *line, int quads)
{
    uint64_t known[words] = {0}, met[words] = {0};
    uint32_t hit[table_side];
    int      hits = 0;
    for (int x = 0; x < table_side && !kept_is_read(kept); x++) {
        if (line[x] == table_unset) continue;
        known[x >> 6] |= UINT64_C(1) << (x & 63);
        if (line[x] == table_nothing) continue;
        met[x >> 6] |= UINT64_C(1) << (x & 63);
        hit[hits++] = line[x];
    }
    kept_pass(kept, known, sizeof known);
    kept_pass(kept, met, sizeof met);
    kept_check(kept, count_of(known) > 0 && is_within(met, known));
    if (kept_is_read(kept)) hits = count_of(met);
    kept_pass(kept, hit, (size_t)hits * sizeof *hit);
    for (int x = 0, k = 0; x < table_side && kept_is_read(kept) && kept->good; x++) {
        if (!has(known, x)) continue;
        const uint32_t texel = has(met, x) ? hit[k++] : table_nothing;
        kept_check(kept, texel == table_nothing || is_hit(texel, quads));
        if (line) __atomic_store_n(&line[x], texel, __ATOMIC_RELAXED);
    }
    return (uint32_t)count_of(known);
}

static bool is_blank(const uint32_t line[table_side])
{
    uint32_t any = 0;
    for (int x = 0; x < table_side; x++) any |= line[x];
    return any == table_unset;
}

void kept_texels_values(Kept *kept, void *user)
{
    KeptTexels *t = user;
    for (int way = 0; way < t->ways && kept->good; way++) {
        uint32_t *texel = t->texel ? t->texel + (size_t)way * way_texels : NULL;
        uint64_t  lines[words] = {0};
        for (int y = 0; y < table_side && !kept_is_read(kept); y++)
            if (!is_blank(texel + y * table_side)) lines[y >> 6] |= UINT64_C(1) << (y & 63);
        kept_pass(kept, lines, sizeof lines);
        for (int y = 0; y < table_side && kept->good; y++)
            if (has(lines, y)) t->known += pass_line(kept, texel ? texel + y * table_side : NULL, t->quads);
    }
}

/* ---- octets of light ---------------------------------------------------------------------------- */

void kept_light_values(Kept *kept, void *user)
{
    const KeptLight *l = user;
    kept_floats(kept, l->share[0], (size_t)l->groups * 2);
    for (int k = 0; k < l->groups && kept->good; k++) {
        const float up = l->share[k][0], down = l->share[k][1];
        kept_check(kept, (up >= 0 && up <= 1 && down >= 0 && down <= 1) || (up == -1 && down == -1));
    }
}

/* The end of the group of alike quads that begins at one. */
static int group_end(const PlantShape *shape, int first)
{
    int end = first + 1;
    while (end < shape->quads && plant_quads_alike(shape, end - 1, end)) end++;
    return end;
}

static int groups_of(const PlantShape *shape)
{
    int groups = 0;
    for (int q = 0; q < shape->quads; q = group_end(shape, q)) groups++;
    return groups;
}

/* ---- a part, and the scene's own values --------------------------------------------------------- */

/* A part's values beside the scene's. */
typedef struct Values {
    KeptTexels  texels; /* of ways of one elevation; texel NULL: of light */
    KeptLight   light;
    void       *user; /* one of them */
    KeptValues *pass;
} Values;

static void clear(Values *v)
{
    if (v->texels.texel) memset(v->texels.texel, 0, row_texels * sizeof *v->texels.texel);
    for (int g = 0; g < v->light.groups; g++) v->light.share[g][0] = v->light.share[g][1] = -1;
}

static void close_values(Values *v)
{
    free(v->texels.texel);
    free(v->light.share);
}

/* False: there is no memory. */
static bool open_values(Values *v, const ShapeKept *k, int part)
{
    const PlantShape *shape = k->shape->shape;
    *v = (Values){.pass = kept_texels_values, .user = &v->texels};
    if (part == kept_light) {
        v->pass = kept_light_values, v->user = &v->light;
        v->light.groups = groups_of(shape);
        v->light.share = malloc(((size_t)v->light.groups + 1) * sizeof *v->light.share);
        if (!v->light.share) return false;
    } else {
        v->texels = (KeptTexels){malloc(row_texels * sizeof(uint32_t)), table_azimuths, k->shape->quads, 0};
        if (!v->texels.texel) return false;
    }
    clear(v);
    return true;
}

static uint32_t *row_of(const ShapeKept *k, int row) { return k->table->level[0] + (size_t)row * row_texels; }

/* Adds those of the scene. Returns how many these are. */
static uint32_t add_texels(KeptTexels *t, const uint32_t *row)
{
    uint32_t known = 0;
    for (int at = 0; at < row_texels; at++) {
        const uint32_t texel = __atomic_load_n(&row[at], __ATOMIC_RELAXED);
        if (texel == table_unset) continue;
        t->texel[at] = texel;
        known++;
    }
    return known;
}

static uint32_t put_light(PlantShape *shape, const KeptLight *l)
{
    uint32_t known = 0;
    for (int g = 0, first = 0, end; g < l->groups; g++, first = end) {
        end = group_end(shape, first);
        if (l->share[g][0] < 0) continue;
        for (int q = first; q < end; q++) plant_open_set(&shape->quad[q], l->share[g]);
        known++;
    }
    return known;
}

static uint32_t add_light(KeptLight *l, const PlantShape *shape)
{
    uint32_t known = 0;
    float    share[2];
    for (int g = 0, first = 0; g < l->groups; g++, first = group_end(shape, first)) {
        if (!plant_open_get(share, &shape->quad[first])) continue;
        memcpy(l->share[g], share, sizeof share);
        known++;
    }
    return known;
}

static uint32_t add(Values *v, const ShapeKept *k, int part)
{
    return part == kept_light ? add_light(&v->light, k->shape->shape) : add_texels(&v->texels, row_of(k, part));
}

/* ---- between runs ------------------------------------------------------------------------------- */

static CacheKey key_of(const ShapeKept *k, int part)
{
    const int32_t number[] = {k->kind, part, k->all->fine};
    CacheKey      key = cache_key("what rays find of a prototype");
    cache_key_add(&key, k->all->name, strlen(k->all->name));
    cache_key_add(&key, number, sizeof number);
    return key;
}

static void say_wrong(const ShapeKept *k, int part)
{
    log_warn("forest: an entry of the cache with the %s of the %s is whole but has values that the plant cannot have: "
             "they are found anew",
             part == kept_light ? "light" : "hit table", plant_name((PlantKind)k->kind));
}

/* Texels go straight into the table, once all are known to be good. */
static void take_texels(ShapeKept *k, int part, const void *octets, size_t count)
{
    KeptTexels checked = {NULL, table_azimuths, k->shape->quads, 0}, row = checked;
    row.texel = row_of(k, part);
    if (kept_read(kept_texels_values, &checked, octets, count) && kept_read(kept_texels_values, &row, octets, count))
        __atomic_store_n(&k->part[part].known, row.known, __ATOMIC_RELAXED);
    else say_wrong(k, part);
}

static void take_light(ShapeKept *k, const void *octets, size_t count)
{
    PlantShape *shape = (PlantShape *)(uintptr_t)k->shape->shape; /* its light alone changes */
    Values      v;
    const bool  open = open_values(&v, k, kept_light);
    if (open && kept_read(v.pass, v.user, octets, count))
        __atomic_store_n(&k->part[kept_light].known, put_light(shape, &v.light), __ATOMIC_RELAXED);
    else if (open) say_wrong(k, kept_light);
    close_values(&v);
}

static void take(ShapeKept *k, int part)
{
    CacheKey key = key_of(k, part);
    void    *octets;
    size_t   count;
    if (!cache_fetch(&octets, &count, k->all->cache, &key)) return;
    if (part == kept_light) take_light(k, octets, count);
    else take_texels(k, part, octets, count);
    free(octets);
}

void shape_kept_take(ShapeKept *k, int part)
{
    pthread_mutex_lock(&k->lock);
    if (!shape_kept_is_taken(k, part)) {
        take(k, part);
        __atomic_store_n(&k->part[part].taken, 1, __ATOMIC_RELEASE);
    }
    pthread_mutex_unlock(&k->lock);
}

/* So many new values at least are worth an entry: some 2 ms of tracing. */
static uint32_t least_of(int part) { return part == kept_light ? 32 : 1024; }

/* Writes the entry again, with what other programs have put there meanwhile. */
static void write_part(ShapeKept *k, int part, Values *v)
{
    CacheKey key = key_of(k, part);
    clear(v);
    if (!kept_fetch(v->pass, v->user, k->all->cache, &key)) clear(v);
    const uint32_t known = add(v, k, part);
    kept_keep(v->pass, v->user, k->all->cache, &key);
    __atomic_store_n(&k->part[part].known, known, __ATOMIC_RELAXED);
    __atomic_store_n(&k->part[part].fresh, 0, __ATOMIC_RELAXED);
}

/* Writes a part of which a thirty-second is new. */
static void keep(ShapeKept *k, int part)
{
    KeptPart *p = &k->part[part];
    Values    v;
    if (__atomic_load_n(&p->fresh, __ATOMIC_RELAXED) < least_of(part)) return; /* each is counted, some twice */
    pthread_mutex_lock(&k->lock);
    const uint32_t known = __atomic_load_n(&p->known, __ATOMIC_RELAXED);
    if (open_values(&v, k, part)) {
        const uint32_t all = add(&v, k, part);
        if (all >= known + least_of(part) && all - known >= all / 32) write_part(k, part, &v);
    }
    close_values(&v);
    pthread_mutex_unlock(&k->lock);
}

void forest_keep_found(const Forest *forest)
{
    ForestKept *all = forest->kept;
    for (int kind = 0; all && kind < PLANT_STANDING; kind++)
        for (int part = 0; part < kept_parts; part++) keep(&all->of[kind], part);
}

/* To write a part of two megabytes takes 10 ms, to trace its texels a hundred; and it has doubled since it was last
 * written. So a run that is killed loses half of what it found at most, but for the first. */
void forest_kept_after_frame(const Forest *forest)
{
    ForestKept *all = forest->kept;
    for (int kind = 0; all && kind < PLANT_STANDING; kind++)
        for (int part = 0; part < kept_parts; part++) {
            const KeptPart *p = &all->of[kind].part[part];
            const uint32_t  fresh = __atomic_load_n(&p->fresh, __ATOMIC_RELAXED);
            if (fresh < 64 * least_of(part) || fresh < __atomic_load_n(&p->known, __ATOMIC_RELAXED)) continue;
            keep(&all->of[kind], part);
            return;
        }
}

/* ---- life --------------------------------------------------------------------------------------- */

void forest_keep(Forest *forest, const PlantsKept *kept)
{
    if (!kept->cache || !*kept->name || forest->kept) return;
    ForestKept *all = calloc(1, sizeof *all);
    if (!all) return; /* nothing is kept */
    all->cache = kept->cache, all->fine = forest->config.fine;
    snprintf(all->name, sizeof all->name, "%s", kept->name);
    for (int kind = 0; kind < PLANT_STANDING; kind++) {
        ShapeKept  *k = &all->of[kind];
        ShapeScene *shape = &forest->shape[kind][forest_finest(forest)];
        k->all = all, k->kind = kind, k->shape = shape, k->table = forest->table[kind];
        pthread_mutex_init(&k->lock, NULL);
        if (k->table) k->table->kept = k;
        if (shape->pattern) shape->kept = k;
    }
    forest->kept = all;
}

void forest_kept_destroy(Forest *forest)
{
    ForestKept *all = forest->kept;
    if (!all) return;
    forest_keep_found(forest);
    for (int kind = 0; kind < PLANT_STANDING; kind++) pthread_mutex_destroy(&all->of[kind].lock);
    free(all);
    forest->kept = NULL;
}
