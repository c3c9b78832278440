/* tests/fuzz/fuzz_kept.c: any octets as what the cache keeps of canopies, stands of far woods, invented ground,
 * patches, texels of hit tables and light of quads, past its checksum. What is taken has the same octets again. */
#include "tests/fuzz/fuzz_seed.h"

#include "entities/models/patches.h"
#include "render/light/far_woods.h"
#include "render/trace/plants/forest_private.h"
#include "terrain/invented/ways_private.h"

#include <stdlib.h>

const int fuzz_rounds = 20000;

enum { kinds = 6, rows = 9, texels_quads = 1000, light_groups = 50 };

/* One of a kind, without values, or with those of a seed. */
typedef struct Any {
    Canopy         *canopy;
    WoodStand      *stand;
    InventedTerrain ground;
    Patches         patches;
    uint32_t       *texel; /* of one way */
    float (*share)[2];
} Any;

static const Model model = {.node_count = 2, .part_count = 2};

static bool any_create(Any *a, int kind)
{
    *a = (Any){0};
    if (kind == 0) return canopy_create_bare(&a->canopy, &(Woods){.nx = 1, .ny = 1}) == STATUS_OK;
    if (kind == 4) return (a->texel = calloc(table_side * table_side, sizeof *a->texel)) != NULL;
    if (kind == 5) return (a->share = calloc(light_groups, sizeof *a->share)) != NULL;
    return kind != 1 || far_stand_create_bare(&a->stand) == STATUS_OK;
}

static void any_destroy(Any *a)
{
    canopy_destroy(a->canopy);
    far_stand_destroy(a->stand);
    invented_free(&a->ground);
    patches_destroy(&a->patches);
    free(a->texel), free(a->share);
}

static void values(Kept *kept, void *user, int kind)
{
    Any *a = user;
    if (kind == 0) canopy_kept_values(kept, a->canopy);
    if (kind == 1) far_stand_kept_values(kept, &(StandKept){a->stand, rows});
    if (kind == 2) invented_kept_values(kept, &a->ground);
    if (kind == 3) patches_kept_values(kept, &(PatchesKept){&a->patches, &model});
    if (kind == 4) kept_texels_values(kept, &(KeptTexels){a->texel, 1, texels_quads, 0});
    if (kind == 5) kept_light_values(kept, &(KeptLight){a->share, light_groups});
}
static void              canopy(Kept *kept, void *user) { values(kept, user, 0); }
static void              stand(Kept *kept, void *user) { values(kept, user, 1); }
static void              ground(Kept *kept, void *user) { values(kept, user, 2); }
static void              patches(Kept *kept, void *user) { values(kept, user, 3); }
static void              texels(Kept *kept, void *user) { values(kept, user, 4); }
static void              light(Kept *kept, void *user) { values(kept, user, 5); }
static KeptValues *const of[kinds] = {canopy, stand, ground, patches, texels, light};

/* A level of four posts, a sea with a grid, a way and one of each that it has. */
static void fill_ground(InventedTerrain *t)
{
    const ElevationGrid grid = {2, 2, -5, -5, 10, 0, 0.25};
    Ways               *w = calloc(1, sizeof *w);
    if (!w || elevation_level_create(&t->elevation, 0, &grid) != STATUS_OK) abort();
    t->ground.ways = w;
    t->elevation.level[0].plain = true;
    elevation_build_pyramids(&t->elevation);
    t->ground.coast = (Coast){.sea_count = 1, .land_count = 2, .sea = calloc(1, 16), .land = calloc(2, 16)};
    w->side_m[0] = w->side_m[1] = w->index_m = w->coarse_m = 10;
    w->nx = w->ny = w->segments = w->ponds = w->plots = w->ways = w->villages = 1;
    w->cx = w->cy = 2;
    w->segment = calloc(1, sizeof *w->segment), w->pond = calloc(1, sizeof *w->pond);
    w->plot = calloc(1, sizeof *w->plot);
    w->start = calloc(2, sizeof *w->start), w->item = calloc(4, sizeof *w->item), w->wet = calloc(4, sizeof *w->wet);
    if (!w->start || !w->item) abort();
    w->start[1] = WAY_ITEMS;
    for (uint32_t k = 0; k < WAY_ITEMS; k++) w->item[k] = k << 28;
}

static void fill_patches(Patches *p)
{
    *p = (Patches){.count = 2, .links = 1, .bodies = 2, .parts = 2};
    p->patch = calloc(2, sizeof *p->patch), p->link = calloc(1, sizeof *p->link);
    p->body_of_part = calloc(2, sizeof *p->body_of_part), p->first_of_body = calloc(3, sizeof *p->first_of_body);
    p->body_of_node = calloc(2, sizeof *p->body_of_node);
    if (!p->link || !p->body_of_part || !p->first_of_body) abort();
    p->link[0].b = p->body_of_part[1] = p->first_of_body[1] = 1, p->first_of_body[2] = 2;
}

/* A few lines: hits, one of the first quad and the last and each depth, and texels in which nothing is. */
static void fill_texels(uint32_t *texel, uint32_t index)
{
    for (uint32_t k = 0; k < 4 + index % 16; k++) {
        uint32_t *line = texel + (k * 37 + index) % table_side * table_side;
        line[0] = line[63 + k] = table_nothing;
        line[127] = (uint32_t)-table_depth_steps << table_quad_bits | 2;
        line[64 - k] = (uint32_t)table_depth_steps << table_quad_bits | (texels_quads + 1);
    }
}

static void fill_light(float (*share)[2])
{
    for (int k = 0; k < light_groups; k++) share[k][0] = share[k][1] = k % 3 ? (float)k / light_groups : -1;
}

/* By the first octet: a kind. */
size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    const int kind = (int)(index % kinds);
    Any       a;
    size_t    count = 0;
    if (!any_create(&a, kind)) abort();
    if (kind == 2) fill_ground(&a.ground);
    if (kind == 3) fill_patches(&a.patches);
    if (kind == 4) fill_texels(a.texel, index / kinds);
    if (kind == 5) fill_light(a.share);
    void *octets = kept_write(&count, of[kind], &a);
    if (!octets || count >= fuzz_seed_octets) abort();
    out[0] = (uint8_t)kind;
    memcpy(out + 1, octets, count);
    free(octets);
    any_destroy(&a);
    return 1 + count;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    Any    a;
    size_t count = 0;
    if (size == 0 || !any_create(&a, *data % kinds)) return 0;
    if (kept_read(of[*data % kinds], &a, data + 1, size - 1)) {
        void *again = kept_write(&count, of[*data % kinds], &a);
        if (!again || count != size - 1 || memcmp(again, data + 1, count) != 0) abort();
        free(again);
    }
    any_destroy(&a);
    return 0;
}
