/* render/trace/visibility/broad_phase_rays.c: packets of rays through the tree over spheres. */
#include "render/trace/visibility/broad_phase_private.h"

#include <immintrin.h>

typedef __m256d Four;

typedef struct Slabs {
    Four o[3][broad_packet / 4], per[3][broad_packet / 4]; /* 1 / d; 1e30 for a ray along the slab */
    int  fours;
} Slabs;

static void slabs_of(Slabs *s, const BroadRays *rays)
{
    const Four sign = _mm256_set1_pd(-0.0), one = _mm256_set1_pd(1), least = _mm256_set1_pd(1e-30);
    s->fours = 0;
    for (int f = 0; f < broad_packet / 4; f++) {
        for (int c = 0; c < 3; c++) {
            const Four d = _mm256_load_pd(rays->d[c] + 4 * f);
            const Four along = _mm256_cmp_pd(_mm256_andnot_pd(sign, d), least, _CMP_LT_OQ);
            s->o[c][f] = _mm256_load_pd(rays->o[c] + 4 * f);
            s->per[c][f] = _mm256_blendv_pd(one / d, _mm256_set1_pd(1e30), along);
        }
        for (int k = 4 * f; k < 4 * f + 4; k++)
            if (rays->limit_m[k] >= 0) s->fours = f + 1;
    }
}

/* Where the first of the rays enters the box within its limit; INFINITY: none does. */
static double entry_m(const Slabs *s, const BroadRays *rays, const double low[3], const double high[3])
{
    Four nearest = _mm256_set1_pd(INFINITY);
    if (!(low[0] <= high[0])) return INFINITY;
    for (int f = 0; f < s->fours; f++) {
        Four in = _mm256_setzero_pd(), out = _mm256_set1_pd(INFINITY);
        for (int c = 0; c < 3; c++) {
            const Four a = (_mm256_set1_pd(low[c]) - s->o[c][f]) * s->per[c][f];
            const Four b = (_mm256_set1_pd(high[c]) - s->o[c][f]) * s->per[c][f];
            /* the second operand stays where the first is no number */
            in = _mm256_max_pd(_mm256_min_pd(a, b), in);
            out = _mm256_min_pd(_mm256_max_pd(a, b), out);
        }
        /* a rounding of the products: nothing is missed by it */
        in = in * _mm256_set1_pd(1 - 1e-11);
        const Four limit = _mm256_load_pd(rays->limit_m + 4 * f);
        const Four meets = _mm256_and_pd(_mm256_cmp_pd(in, out, _CMP_LE_OQ), _mm256_cmp_pd(in, limit, _CMP_LE_OQ));
        nearest = _mm256_min_pd(nearest, _mm256_blendv_pd(_mm256_set1_pd(INFINITY), in, meets));
    }
    double each[4];
    _mm256_storeu_pd(each, nearest);
    return fmin(fmin(each[0], each[1]), fmin(each[2], each[3]));
}

static double largest_limit(const BroadRays *rays)
{
    double largest = -1;
    for (int k = 0; k < broad_packet; k++) largest = rays->limit_m[k] > largest ? rays->limit_m[k] : largest;
    return largest;
}

/* Boxes that rays are tested with, and by how much they are larger. */
typedef struct Boxes {
    const Box       *node, *item; /* item: NULL: those of the spheres */
    double           more_m;
    const BroadLift *lift;
} Boxes;

static double entry_of(const Slabs *slabs, const BroadRays *rays, const Box *box, const Boxes *of)
{
    double low[3], high[3];
    if (of->lift && box->low[0] <= box->high[0]) {
        const Box at = raised(box, of->lift);
        return entry_m(slabs, rays, at.low, at.high);
    }
    if (of->more_m == 0) return entry_m(slabs, rays, box->low, box->high);
    for (int c = 0; c < 3; c++) low[c] = box->low[c] - of->more_m, high[c] = box->high[c] + of->more_m;
    return entry_m(slabs, rays, low, high);
}

/* Those of a leaf that may be met, nearest first. */
static void visit_leaf(const BroadPhase *tree, int leaf, const Boxes *boxes, const Slabs *slabs, BroadRays *rays,
                       BroadVisit *visit, void *user)
{
    struct {
        double entry_m;
        int    item;
    } met[leaf_items];
    int       count = 0;
    const int first = leaf * leaf_items;
    for (int k = first; k < first + leaf_items && k < tree->count; k++) {
        const Box    box = boxes->item ? boxes->item[k] : box_of_sphere(tree->sphere[k]);
        const double at_m = entry_of(slabs, rays, &box, boxes);
        if (!(at_m < INFINITY)) continue;
        int to = count++;
        for (; to > 0 && met[to - 1].entry_m > at_m; to--) met[to] = met[to - 1];
        met[to].entry_m = at_m, met[to].item = tree->item[k];
    }
    for (int k = 0; k < count; k++)
        if (k == 0 || met[k].entry_m <= largest_limit(rays)) visit(user, met[k].item);
}

static void walk(const BroadPhase *tree, const Boxes *boxes, BroadRays *rays, BroadVisit *visit, void *user)
{
    struct {
        double entry_m;
        int    node;
    } stack[2 * deepest];
    Slabs slabs;
    int   depth = 0;
    if (tree->count == 0) return;
    slabs_of(&slabs, rays);
    stack[depth].entry_m = entry_of(&slabs, rays, &boxes->node[1], boxes);
    stack[depth++].node = 1;
    while (depth > 0) {
        const double at_m = stack[--depth].entry_m;
        const int    n = stack[depth].node;
        if (!(at_m < INFINITY && at_m <= largest_limit(rays))) continue;
        if (n >= tree->leaves) {
            visit_leaf(tree, n - tree->leaves, boxes, &slabs, rays, visit, user);
            continue;
        }
        double side_m[2];
        for (int k = 0; k < 2; k++) side_m[k] = entry_of(&slabs, rays, &boxes->node[2 * n + k], boxes);
        const int first = side_m[1] < side_m[0];
        for (int k = 0; k < 2; k++) { /* the nearer is taken from the stack first */
            const int side = k == 0 ? !first : first;
            if (!(side_m[side] < INFINITY)) continue;
            stack[depth].entry_m = side_m[side];
            stack[depth++].node = 2 * n + side;
        }
    }
}

void broad_phase_rays(const BroadPhase *tree, BroadRays *rays, BroadVisit *visit, void *user)
{
    broad_phase_rays_raised(tree, NULL, rays, visit, user);
}

void broad_phase_rays_raised(const BroadPhase *tree, const BroadLift *lift, BroadRays *rays, BroadVisit *visit,
                             void *user)
{
    const Boxes boxes = {.node = tree->ray_node, .item = tree->box, .lift = lift};
    walk(tree, &boxes, rays, visit, user);
}

void broad_phase_rays_near(const BroadPhase *tree, BroadRays *rays, double more_m, BroadVisit *visit, void *user)
{
    const Boxes boxes = {.node = tree->node, .more_m = more_m};
    walk(tree, &boxes, rays, visit, user);
}
