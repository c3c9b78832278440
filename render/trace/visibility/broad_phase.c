/* render/trace/visibility/broad_phase.c: builds the tree over spheres, and finds what lies in a volume. */
#include "render/trace/visibility/broad_phase_private.h"

#include <limits.h>
#include <stdlib.h>

enum { bitmap_bits = 1 << 18 };

/* ---- building ----------------------------------------------------------------------------------- */

typedef struct Ordered {
    uint64_t key;
    int      of;
} Ordered;

/* Every third bit. */
static uint64_t spread(uint64_t x)
{
    x &= 0x1fffff;
    x = (x | x << 32) & 0x1f00000000ffff;
    x = (x | x << 16) & 0x1f0000ff0000ff;
    x = (x | x << 8) & 0x100f00f00f00f00f;
    x = (x | x << 4) & 0x10c30c30c30c30c3;
    return (x | x << 2) & 0x1249249249249249;
}

/* Radix sort, eleven bits a pass; a pass in which all are alike is left out. Equal keys keep their order. Returns the
 * array that holds the result. */
static Ordered *sort_by_key(Ordered *from, Ordered *to, int count)
{
    enum { digits = 1 << 11 };
    for (int shift = 0; shift < 3 * morton_bits; shift += 11) {
        int start[digits] = {0}, at = 0;
        for (int i = 0; i < count; i++) start[from[i].key >> shift & (digits - 1)]++;
        if (start[from[0].key >> shift & (digits - 1)] == count) continue;
        for (int digit = 0; digit < digits; digit++) {
            const int here = start[digit];
            start[digit] = at;
            at += here;
        }
        for (int i = 0; i < count; i++) to[start[from[i].key >> shift & (digits - 1)]++] = from[i];
        Ordered *const swap = from;
        from = to;
        to = swap;
    }
    return from;
}

static bool is_sphere(const double s[4])
{
    return isfinite(s[0]) && isfinite(s[1]) && isfinite(s[2]) && isfinite(s[3]) && s[3] >= 0;
}

static void join(Box *box, const Box *a, const Box *b)
{
    for (int c = 0; c < 3; c++) {
        box->low[c] = a->low[c] < b->low[c] ? a->low[c] : b->low[c];
        box->high[c] = a->high[c] > b->high[c] ? a->high[c] : b->high[c];
    }
}

Status broad_phase_create(BroadPhase **out, const int *item, const double (*sphere)[4], int count, Arena *arena)
{
    BroadPhase *tree = arena_alloc(arena, 1, sizeof *tree);
    Ordered    *order = arena_alloc(arena, (size_t)count + 1, sizeof *order);
    Ordered    *scratch = arena_alloc(arena, (size_t)count + 1, sizeof *scratch);
    double      low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, per_m[3];
    int         kept = 0;
    if (!tree || !order || !scratch) return STATUS_NO_MEMORY;
    for (int i = 0; i < count; i++) {
        if (!is_sphere(sphere[i])) continue;
        order[kept++].of = i;
        for (int c = 0; c < 3; c++) {
            low[c] = sphere[i][c] < low[c] ? sphere[i][c] : low[c];
            high[c] = sphere[i][c] > high[c] ? sphere[i][c] : high[c];
        }
    }
    for (int c = 0; c < 3; c++) {
        const double wide_m = high[c] - low[c];
        per_m[c] = wide_m > 0 && wide_m < INFINITY ? ((1 << morton_bits) - 1) / wide_m : 0;
    }
    for (int k = 0; k < kept; k++) {
        const double *s = sphere[order[k].of];
        for (int c = 0; c < 3; c++) order[k].key |= spread((uint64_t)((s[c] - low[c]) * per_m[c])) << c;
    }
    if (kept > 0) order = sort_by_key(order, scratch, kept);

    tree->count = kept;
    for (tree->leaves = 1; tree->leaves * leaf_items < kept;) tree->leaves *= 2;
    tree->node = arena_alloc(arena, 2 * (size_t)tree->leaves, sizeof *tree->node);
    tree->item = arena_alloc(arena, (size_t)kept + 1, sizeof *tree->item);
    tree->sphere = arena_alloc(arena, (size_t)kept + 1, sizeof *tree->sphere);
    tree->box = arena_alloc(arena, (size_t)kept + 1, sizeof *tree->box);
    tree->ray_node = arena_alloc(arena, 2 * (size_t)tree->leaves, sizeof *tree->ray_node);
    if (!tree->node || !tree->item || !tree->sphere || !tree->box || !tree->ray_node) return STATUS_NO_MEMORY;
    for (int k = 0; k < kept; k++) {
        tree->item[k] = item[order[k].of];
        memcpy(tree->sphere[k], sphere[order[k].of], sizeof tree->sphere[k]);
        tree->box[k] = box_of_sphere(tree->sphere[k]);
    }
    for (int leaf = 0; leaf < tree->leaves; leaf++) {
        Box *box = &tree->node[tree->leaves + leaf];
        *box = empty_box;
        for (int k = leaf * leaf_items; k < (leaf + 1) * leaf_items && k < kept; k++) join(box, box, &tree->box[k]);
    }
    for (int n = tree->leaves - 1; n > 0; n--) join(&tree->node[n], &tree->node[2 * n], &tree->node[2 * n + 1]);
    memcpy(tree->ray_node, tree->node, 2 * (size_t)tree->leaves * sizeof *tree->node);
    *out = tree;
    return STATUS_OK;
}

void broad_phase_tighten(BroadPhase *tree, BroadBox *box_of, void *user)
{
    for (int k = 0; k < tree->count; k++) {
        Box *box = &tree->box[k], tight;
        if (!box_of(user, tree->item[k], tight.low, tight.high)) continue;
        for (int c = 0; c < 3; c++) {
            const double room_m = 1e-6 + 1e-10 * (fabs(tight.low[c]) + fabs(tight.high[c]));
            box->low[c] = tight.low[c] - room_m > box->low[c] ? tight.low[c] - room_m : box->low[c];
            box->high[c] = tight.high[c] + room_m < box->high[c] ? tight.high[c] + room_m : box->high[c];
        }
    }
    for (int leaf = 0; leaf < tree->leaves; leaf++) {
        Box *box = &tree->ray_node[tree->leaves + leaf];
        *box = empty_box;
        for (int k = leaf * leaf_items; k < (leaf + 1) * leaf_items && k < tree->count; k++)
            join(box, box, &tree->box[k]);
    }
    for (int n = tree->leaves - 1; n > 0; n--)
        join(&tree->ray_node[n], &tree->ray_node[2 * n], &tree->ray_node[2 * n + 1]);
}

int broad_phase_count(const BroadPhase *tree) { return tree->count; }

/* ---- volume queries ----------------------------------------------------------------------------- */

static int compare_items(const void *a, const void *b)
{
    const int p = *(const int *)a, q = *(const int *)b;
    return (p > q) - (p < q);
}

/* Sorts the list, by a bitmap of the range of its items where that is short enough. */
static void sort_items(int *list, int count)
{
    uint64_t bitmap[bitmap_bits / 64];
    if (count < 2) return;
    if (count <= 16) {
        for (int i = 1; i < count; i++) {
            const int here = list[i];
            int       at = i;
            for (; at > 0 && list[at - 1] > here; at--) list[at] = list[at - 1];
            list[at] = here;
        }
        return;
    }
    int low = list[0], high = list[0];
    for (int i = 1; i < count; i++) {
        low = list[i] < low ? list[i] : low;
        high = list[i] > high ? list[i] : high;
    }
    if ((int64_t)high - low >= bitmap_bits) {
        qsort(list, (size_t)count, sizeof *list, compare_items);
        return;
    }
    const int words = (high - low) / 64 + 1;
    memset(bitmap, 0, (size_t)words * sizeof *bitmap);
    for (int i = 0; i < count; i++) bitmap[(list[i] - low) / 64] |= UINT64_C(1) << ((list[i] - low) % 64);
    for (int w = 0, at = 0; w < words; w++)
        for (uint64_t left = bitmap[w]; left; left &= left - 1) list[at++] = low + 64 * w + __builtin_ctzll(left);
}

/* A query: whether the box of a node may hold something of it, and whether an item is. */
typedef struct Query {
    bool (*may_hold)(const void *of, const BroadPhase *tree, int node);
    bool (*takes)(const void *of, const BroadPhase *tree, int k);
    const void *of;
} Query;

/* Lists the items that a query takes, in the order of the tree; -1: there are more than most. */
static inline __attribute__((always_inline)) int walk(int *list, int most, const BroadPhase *tree, const Query *query)
{
    int stack[deepest], depth = 0, count = 0;
    if (tree->count == 0) return 0;
    stack[depth++] = 1;
    while (depth > 0) {
        const int n = stack[--depth];
        if (!query->may_hold(query->of, tree, n)) continue;
        if (n < tree->leaves) {
            stack[depth++] = 2 * n + 1;
            stack[depth++] = 2 * n;
            continue;
        }
        const int first = (n - tree->leaves) * leaf_items;
        for (int k = first; k < first + leaf_items && k < tree->count; k++) {
            if (!query->takes(query->of, tree, k)) continue;
            if (count == most) return -1;
            list[count++] = tree->item[k];
        }
    }
    return count;
}

/* ---- within planes ------------------------------------------------------------------------------ */

typedef struct InPlanes {
    const double (*plane)[4];
    int              planes;
    const BroadLift *lift;
} InPlanes;

/* Whether a box lies beyond a plane. */
static bool box_beyond(const Box *box, const double plane[4])
{
    double farthest = 0;
    for (int c = 0; c < 3; c++) farthest += plane[c] * (plane[c] > 0 ? box->high[c] : box->low[c]);
    return farthest < plane[3];
}

static bool box_in_planes(const Box *box, const InPlanes *q)
{
    for (int p = 0; p < q->planes; p++)
        if (box_beyond(box, q->plane[p])) return false;
    return true;
}

static bool is_box(const Box *box) { return box->low[0] <= box->high[0]; }

static bool node_in_planes(const void *of, const BroadPhase *tree, int n)
{
    return is_box(&tree->node[n]) && box_in_planes(&tree->node[n], of);
}

static bool sphere_in_planes(const void *of, const BroadPhase *tree, int k)
{
    const InPlanes *q = of;
    const double   *s = tree->sphere[k];
    const double    room_m = 1e-6 + 1e-9 * s[3] + 1e-10 * (fabs(s[0]) + fabs(s[1]) + fabs(s[2]));
    for (int p = 0; p < q->planes; p++)
        if (v3_dot(q->plane[p], s) + s[3] + room_m < q->plane[p][3]) return false;
    return true;
}

int broad_phase_in_planes(int *list, const BroadPhase *tree, const double (*plane)[4], int planes)
{
    const int count =
        walk(list, INT_MAX, tree, &(Query){node_in_planes, sphere_in_planes, &(InPlanes){plane, planes, NULL}});
    sort_items(list, count);
    return count;
}

static bool raised_in_planes(const Box *box, const InPlanes *q)
{
    if (!q->lift) return box_in_planes(box, q);
    const Box above = raised(box, q->lift);
    return box_in_planes(&above, q);
}

static bool ray_node_in_planes(const void *of, const BroadPhase *tree, int n)
{
    return is_box(&tree->ray_node[n]) && raised_in_planes(&tree->ray_node[n], of);
}

static bool item_box_in_planes(const void *of, const BroadPhase *tree, int k)
{
    return raised_in_planes(&tree->box[k], of);
}

int broad_phase_some_in_planes(int *list, int most, const BroadPhase *tree, const BroadLift *lift,
                               const double (*plane)[4], int planes)
{
    return walk(list, most, tree, &(Query){ray_node_in_planes, item_box_in_planes, &(InPlanes){plane, planes, lift}});
}

/* ---- near a box --------------------------------------------------------------------------------- */

typedef struct NearBox {
    const double *low, *high;
    double        more_m;
} NearBox;

static bool boxes_touch(const Box *box, const NearBox *q)
{
    for (int c = 0; c < 3; c++)
        if (!(box->low[c] - q->more_m <= q->high[c] && box->high[c] + q->more_m >= q->low[c])) return false;
    return true;
}

static bool node_touches(const void *of, const BroadPhase *tree, int n) { return boxes_touch(&tree->node[n], of); }

static bool sphere_touches(const void *of, const BroadPhase *tree, int k)
{
    const Box box = box_of_sphere(tree->sphere[k]);
    return boxes_touch(&box, of);
}

int broad_phase_near_box(int *list, const BroadPhase *tree, const double low[3], const double high[3], double more_m)
{
    const int count = walk(list, INT_MAX, tree, &(Query){node_touches, sphere_touches, &(NearBox){low, high, more_m}});
    sort_items(list, count);
    return count;
}

/* ---- swept along a direction -------------------------------------------------------------------- */

typedef struct Swept {
    const double *centre, *d;
    double        radius_m;
} Swept;

/* Whether a ray along d from within a sphere may meet a box, by the sphere round that. */
static bool swept_may_meet(const void *of, const BroadPhase *tree, int n)
{
    const Swept *q = of;
    const Box   *box = &tree->node[n];
    double       m[3], across[3], square = 0;
    if (!is_box(box)) return false;
    for (int c = 0; c < 3; c++) {
        const double half = 0.5 * (box->high[c] - box->low[c]);
        m[c] = 0.5 * (box->high[c] + box->low[c]) - q->centre[c];
        square += half * half;
    }
    const double reach_m = (q->radius_m + sqrt(square)) * (1 + 1e-9) + 1e-6, along = v3_dot(m, q->d);
    v3_add_scaled(across, m, -along, q->d);
    return along > -reach_m && v3_dot(across, across) < reach_m * reach_m;
}

static bool swept_meets(const void *of, const BroadPhase *tree, int k)
{
    const Swept  *q = of;
    const double *s = tree->sphere[k];
    double        m[3], across[3];
    v3_sub(m, s, q->centre);
    const double room_m = 1e-6 + 1e-10 * (fabs(s[0]) + fabs(s[1]) + fabs(s[2]));
    const double reach_m = (q->radius_m + s[3]) * (1 + 1e-9) + room_m;
    const double along = v3_dot(m, q->d);
    v3_add_scaled(across, m, -along, q->d);
    return along > -reach_m && v3_dot(across, across) < reach_m * reach_m;
}

int broad_phase_swept(int *list, int most, const BroadPhase *tree, const double centre[3], double radius_m,
                      const double d[3])
{
    return walk(list, most, tree, &(Query){swept_may_meet, swept_meets, &(Swept){centre, d, radius_m}});
}
