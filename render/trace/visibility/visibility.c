/* render/trace/visibility/visibility.c: first hits of rays, by a list of what they can meet. */
#include "render/trace/visibility/visibility_private.h"

/* The shading normal follows the curved surface that the facets approximate; where it faces away from the ray it is
 * turned back to edge-on. */
void visibility_store_normals(Hits *hits, int i, const double n_geo[3], const double n_enu[3], const double d_enu[3])
{
    double       n[3] = {n_enu[0], n_enu[1], n_enu[2]};
    const double away = v3_dot(n, d_enu);
    if (away > 0) {
        v3_add_scaled(n, n, -away, d_enu);
        if (!v3_normalize(n, n)) v3_scale(n, 1, n_geo);
    }
    for (int c = 0; c < 3; c++) {
        hits->n_geo[c][i] = (float)n_geo[c];
        hits->n_enu[c][i] = (float)n[c];
    }
}

/* What a ray that meets nothing has, but for places and normals: those are written one by one. */
static void clear_hits(Hits *hits)
{
    const size_t n = (size_t)hits->count;
    memset(hits->kind, hit_sky, n * sizeof *hits->kind);
    memset(hits->material, 0, n * sizeof *hits->material);
    memset(hits->entity, 0, n * sizeof *hits->entity);
    memset(hits->facet, 0, n * sizeof *hits->facet);
    memset(hits->part, 0, n * sizeof *hits->part);
    memset(hits->model, 0, n * sizeof *hits->model);
    memset(hits->inside, 0, n * sizeof *hits->inside);
    memset(hits->surface, 0, n * sizeof *hits->surface);
    memset(hits->instance, 0, n * sizeof *hits->instance);
    memset(hits->radius_m, 0, n * sizeof *hits->radius_m);
    for (int i = 0; i < hits->count; i++) hits->albedo[i] = hits->open_up[i] = hits->open_down[i] = 1;
}

/* ---- the list -------------------------------------------------------------------------------- */

Status visibility_add(Visibility *v, const TraceEntry *entry, const void *self)
{
    const int    place = v->entries;
    const size_t octets = (entry->found_octets + 63) / 64 * 64;
    int          k = place;
    if (place >= trace_entries || v->found_octets + octets > trace_found_octets) return STATUS_NO_MEMORY;
    for (; k > 0 && v->entry[v->in_turn[k - 1]].of->turn > entry->turn; k--) v->in_turn[k] = v->in_turn[k - 1];
    v->in_turn[k] = place;
    v->entry[place] = (ListedEntry){entry, self, v->found_octets};
    v->found_octets += octets;
    v->entries++;
    return STATUS_OK;
}

const void *visibility_self(const Visibility *v, const TraceEntry *entry)
{
    for (int k = 0; k < v->entries; k++)
        if (v->entry[k].of == entry) return v->entry[k].self;
    return NULL;
}

/* Asks an entry, and takes its hits where they are nearer, or as near and it is the earlier in the list. */
static void ask_entry(double *range_m, TraceBlock *block, const ListedEntry *entry, int place, unsigned char *found)
{
    const int count = block->rays->count;
    double    next_m[hits_capacity];
    for (int i = 0; i < count; i++) { /* an earlier one is to find what is as near: it searches to just beyond */
        const double near_m = place + 1 < block->met[i] ? range_m[i] * (1 + 1e-12) : range_m[i];
        block->limit_m[i] = block->met[i] ? near_m : block->rays->far_m[i];
    }
    entry->of->first_hits(next_m, found + entry->found, block, entry->self);
    for (int i = 0; i < count; i++) {
        const bool taken = next_m[i] < range_m[i] || (next_m[i] == range_m[i] && place + 1 < block->met[i]);
        range_m[i] = taken ? next_m[i] : range_m[i];
        block->met[i] = (uint8_t)(taken ? place + 1 : block->met[i]);
    }
}

/* Ranges of first hits, and which entry has them. only: this entry alone; NULL: all. */
static void find_first(double *range_m, TraceBlock *block, const TraceEntry *only, unsigned char *found)
{
    const Visibility *v = block->v;
    const int         count = block->rays->count;
    memset(block->met, 0, (size_t)count);
    for (int i = 0; i < count; i++) range_m[i] = INFINITY;
    for (int k = 0; k < v->entries; k++) {
        const int place = v->in_turn[k];
        if (!only || v->entry[place].of == only) ask_entry(range_m, block, &v->entry[place], place, found);
    }
}

/* only: as find_first. */
static void first_hit(Hits *hits, TraceBlock *block, const TraceEntry *only)
{
    const Visibility          *v = block->v;
    const Rays                *rays = block->rays;
    const int                  count = rays->count;
    int                        list[hits_capacity];
    _Alignas(64) unsigned char found[trace_found_octets];

    const double *const o[3] = {rays->o_enu[0], rays->o_enu[1], rays->o_enu[2]};
    const double *const d[3] = {rays->d_enu[0], rays->d_enu[1], rays->d_enu[2]};
    block->o_enu = o, block->d_enu = d;
    hits->count = count;
    hits->columns = rays->columns;
    find_first(hits->range_m, block, only, found);
    clear_hits(hits);
    for (int i = 0; i < count; i++) {
        const bool sky = !block->met[i];
        for (int c = 0; c < 3; c++) hits->p_enu[c][i] = sky ? 0 : o[c][i] + hits->range_m[i] * d[c][i];
        for (int c = 0; c < 3 && sky; c++) hits->n_geo[c][i] = hits->n_enu[c][i] = 0;
    }
    for (int i = 0; i < count && rays->bent; i++)
        hits->p_enu[2][i] -= ray_drop(v, rays, i, block->met[i] ? hits->range_m[i] : 0);
    for (int place = 0; place < v->entries; place++) {
        const ListedEntry *entry = &v->entry[place];
        int                listed = 0;
        for (int i = 0; i < count; i++) {
            list[listed] = i;
            listed += block->met[i] == place + 1;
        }
        if (listed > 0) entry->of->finish(hits, list, listed, found + entry->found, block, entry->self);
    }
}

void visibility_first_hit(Hits *hits, const Visibility *v, const Rays *rays, RayEntities among,
                          VisibilityCounters *counters)
{
    TraceBlock block;
    block.v = v, block.rays = rays, block.among = &among, block.counters = counters;
    first_hit(hits, &block, NULL);
}

void visibility_first_range(double *range_m, uint32_t *entity, const Visibility *v, const Rays *rays, RayEntities among,
                            VisibilityCounters *counters)
{
    _Alignas(64) unsigned char found[trace_found_octets];
    const double *const        o[3] = {rays->o_enu[0], rays->o_enu[1], rays->o_enu[2]};
    const double *const        d[3] = {rays->d_enu[0], rays->d_enu[1], rays->d_enu[2]};
    TraceBlock                 block;
    block.v = v, block.rays = rays, block.among = &among, block.counters = counters;
    block.o_enu = o, block.d_enu = d;
    find_first(range_m, &block, NULL, found);
    for (int i = 0; i < rays->count; i++) {
        const ListedEntry *of = block.met[i] ? &v->entry[block.met[i] - 1] : NULL;
        entity[i] = of && of->of == &trace_parts ? parts_found_entity(found + of->found, i) : 0;
    }
}

void visibility_first_part(Hits *hits, const Visibility *v, const Rays *rays, RayEntities among,
                           VisibilityCounters *counters)
{
    TraceBlock block;
    block.v = v, block.rays = rays, block.among = &among, block.counters = counters;
    first_hit(hits, &block, &trace_parts);
}

/* ---- the names of the skips ------------------------------------------------------------------ */

static const struct {
    const char *name, *what;
} rows[SKIP_COUNT] = {
    [SKIP_BLOCK] = {"block", "entities outside a block of pixels: block-entity pairs"},
    [SKIP_SPHERE] = {"sphere", "entities missed or hidden, by their sphere: ray-entity pairs"},
    [SKIP_PART] = {"part", "parts missed, by box and sphere: ray-part pairs"},
    [SKIP_GROUND_BEHIND] = {"ground_behind", "ground behind the part that was met: rays"},
    [SKIP_GROUND_BELOW] = {"ground_below", "ground below a block of rays that all met parts: rays"},
    [SKIP_GROUND_WALK] = {"ground_walk", "ground walked together with neighbours: rays"},
    [SKIP_SUN_SPHERE] = {"sun_sphere", "entities that sun rays miss: ray-entity pairs"},
    [SKIP_SUN_STOPPED] = {"sun_stopped", "ground and plants behind what stops the sun: rays"},
    [SKIP_SUN_CLEAR] = {"sun_clear", "ground too low to stop the sun: rays"},
    [SKIP_AMODAL] = {"amodal", "entities with nothing behind what was met: ray-entity pairs"},
    [SKIP_CELL] = {"cell", "samples beside a small target: rays"},
    [SKIP_RETRACE] = {"retrace", "first rays of refined pixels, known from their planes: rays"},
    [SKIP_SMOKE] = {"smoke", "smoke and dust outside a block of pixels: block-volume pairs"},
    [SKIP_LIGHT] = {"light", "light of places near vehicles, asked for once a frame: hits that may share it"},
    [SKIP_TREE] = {"tree", "entities left out by the tree of their spheres: block-entity, ray-entity pairs"},
    [SKIP_KEPT] = {"kept", "what paths from sample points meet, kept from earlier frames: points"},
    [SKIP_SCENERY] = {"scenery", "scenery left out by the trees of its boxes: ray-object pairs"},
};

const char *visibility_skip_name(Skip skip) { return rows[skip].name; }
const char *visibility_skip_what(Skip skip) { return rows[skip].what; }
