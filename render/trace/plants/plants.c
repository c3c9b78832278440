/* render/trace/plants/plants.c: grows the prototype of every kind at all levels, and brings them to a height of 1 m.
 */
#include "render/trace/plants/plants_private.h"

#include <stdlib.h>

/* ---- quads, one by one ------------------------------------------------------------------------ */

double grow_draw(Growth *g, double low, double high)
{
    return low + (high - low) * random_uniform(g->seed, (uint32_t)g->kind, 0, g->drawn++);
}

double grow_draw_fine(Growth *g, double low, double high)
{
    return low + (high - low) * random_uniform(g->seed, (uint32_t)g->kind, 1, g->drawn_fine++);
}

static PlantQuad *add_quad(Growth *g, PlantQuad **list, int *count, int *room)
{
    if (*count == *room) {
        const int  more = *room ? 2 * *room : 1024;
        PlantQuad *larger = realloc(*list, (size_t)more * sizeof *larger);
        if (!larger) {
            g->lost = true;
            return NULL;
        }
        *list = larger, *room = more;
    }
    PlantQuad *quad = &(*list)[(*count)++];
    *quad = (PlantQuad){.open_up = 1, .open_down = 1};
    return quad;
}

/* Two unit vectors at right angles to d and to each other. */
static void across(double u[3], double v[3], const double d[3])
{
    const double up[3] = {0, 0, 1}, east[3] = {1, 0, 0};
    v3_cross(u, fabs(d[2]) < 0.9 ? up : east, d);
    v3_normalize(u, u);
    v3_cross(v, d, u);
}

void grow_piece(Growth *g, const double a[3], const double b[3], double radius_a, double radius_b, int sides)
{
    double d[3], u[3], v[3], ring[2][6][3], n[6][3];
    v3_sub(d, b, a);
    if (!v3_normalize(d, d)) return;
    across(u, v, d);
    for (int k = 0; k < sides; k++) {
        const double turn = 2 * pi_rad * k / sides, c = cos(turn), s = sin(turn);
        for (int x = 0; x < 3; x++) {
            n[k][x] = c * u[x] + s * v[x];
            ring[0][k][x] = a[x] - 0.5 * radius_a * d[x] + radius_a * n[k][x];
            ring[1][k][x] = b[x] + 0.5 * radius_b * d[x] + radius_b * n[k][x];
        }
    }
    for (int k = 0; k < sides; k++) {
        const int  next = (k + 1) % sides;
        PlantQuad *q = add_quad(g, &g->bark, &g->bark_quads, &g->bark_room);
        if (!q) return;
        q->organ = PLANT_BARK;
        q->piece = (uint16_t)g->pieces;
        q->radius = (float)(0.5 * (radius_a + radius_b));
        for (int x = 0; x < 3; x++) {
            q->corner[0][x] = (float)ring[0][k][x], q->corner[1][x] = (float)ring[0][next][x];
            q->corner[2][x] = (float)ring[1][next][x], q->corner[3][x] = (float)ring[1][k][x];
            q->n[0][x] = q->n[3][x] = (float)n[k][x], q->n[1][x] = q->n[2][x] = (float)n[next][x];
        }
    }
    g->pieces++;
}

void grow_card(Growth *g, const double at[3], const double along[3], const double n[3], const double size[2],
               int outline)
{
    const double length = size[0], width = size[1];
    double       v[3], u[3], face[3];
    memcpy(v, along, sizeof v);
    if (!v3_normalize(v, v)) return;
    v3_cross(u, v, n);
    if (!v3_normalize(u, u)) across(u, face, v);
    v3_cross(face, u, v);
    PlantQuad *q = add_quad(g, &g->leaf, &g->leaves, &g->leaf_room);
    if (!q) return;
    q->organ = PLANT_LEAF;
    q->outline = (uint8_t)outline;
    q->piece = (uint16_t)(g->sprays - 1);
    for (int x = 0; x < 3; x++) {
        const double left = at[x] - 0.5 * width * u[x], right = at[x] + 0.5 * width * u[x];
        q->corner[0][x] = (float)left, q->corner[1][x] = (float)right;
        q->corner[2][x] = (float)(right + length * v[x]), q->corner[3][x] = (float)(left + length * v[x]);
        for (int k = 0; k < 4; k++) q->n[k][x] = (float)face[x];
    }
}

void grow_leaf(Growth *g, const double at[3], const double along[3], const double n[3], double length, double width)
{
    const int outline = (int)(grow_draw(g, 0, 1) * plant_outlines);
    g->sprays++;
    if (g->level == plant_fine && g->kind < PLANT_STANDING) grow_spray(g, at, along, n, length, width);
    else grow_card(g, at, along, n, (const double[2]){length, width}, outline);
}

void grow_facet(Growth *g, const double corner[3][3])
{
    PlantQuad *q = add_quad(g, &g->bark, &g->bark_quads, &g->bark_room);
    double     e1[3], e2[3], n[3];
    if (!q) return;
    v3_sub(e1, corner[1], corner[0]), v3_sub(e2, corner[2], corner[0]);
    v3_cross(n, e1, e2);
    v3_normalize(n, n);
    q->organ = PLANT_STONE;
    q->piece = (uint16_t)g->pieces++;
    q->radius = 0.3f;
    for (int k = 0; k < 4; k++)
        for (int x = 0; x < 3; x++) q->corner[k][x] = (float)corner[k < 3 ? k : 2][x], q->n[k][x] = (float)n[x];
}

/* ---- a shape ---------------------------------------------------------------------------------- */

static double card_area(const PlantQuad *q)
{
    double u[3], v[3], n[3];
    for (int x = 0; x < 3; x++)
        u[x] = (double)(q->corner[1][x] - q->corner[0][x]), v[x] = (double)(q->corner[3][x] - q->corner[0][x]);
    v3_cross(n, u, v);
    return v3_length(n);
}

static int compare_radii(const void *a, const void *b)
{
    const float p = *(const float *)a, q = *(const float *)b;
    return (p > q) - (p < q);
}

static double leaf_area(const PlantShape *shape, const double share[plant_outlines])
{
    double area = 0;
    for (int q = shape->bark_quads; q < shape->quads; q++)
        area += card_area(&shape->quad[q]) * share[shape->quad[q].outline];
    return area;
}

static double top(const PlantShape *shape)
{
    double high = 0;
    for (int q = 0; q < shape->quads; q++)
        for (int k = 0; k < 4; k++) high = fmax(high, (double)shape->quad[q].corner[k][2]);
    return high;
}

/* Makes every card larger or smaller about its stalk, so that the area of all leaves of a plant 1 m high is `wanted`.
 */
static void scale_cards(PlantShape *shape, const double share[plant_outlines], double wanted)
{
    const double by = top(shape) * sqrt(wanted / leaf_area(shape, share));
    for (int q = shape->bark_quads; q < shape->quads; q++) {
        PlantQuad *quad = &shape->quad[q];
        for (int x = 0; x < 3; x++) {
            const double stalk = 0.5 * ((double)quad->corner[0][x] + (double)quad->corner[1][x]);
            for (int k = 0; k < 4; k++) quad->corner[k][x] = (float)(stalk + by * ((double)quad->corner[k][x] - stalk));
        }
    }
}

/* Height 1 m, boxes, leaf area and crown. */
static Status finish_shape(PlantShape *out, const double share[plant_outlines])
{
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int q = 0; q < out->quads; q++)
        for (int k = 0; k < 4; k++)
            for (int x = 0; x < 3; x++) {
                low[x] = fminf(low[x], out->quad[q].corner[k][x]), high[x] = fmaxf(high[x], out->quad[q].corner[k][x]);
            }
    const float scale = 1 / high[2];
    float      *radius = malloc(((size_t)out->leaves + 1) * sizeof *radius);
    double      lowest = 1;
    if (!radius) return STATUS_NO_MEMORY;
    for (int x = 0; x < 3; x++) out->low[x] = low[x] * scale, out->high[x] = high[x] * scale;
    for (int q = 0, leaf = 0; q < out->quads; q++) {
        PlantQuad *quad = &out->quad[q];
        for (int k = 0; k < 12; k++) quad->corner[k / 3][k % 3] *= scale;
        quad->radius *= scale;
        if (quad->organ != PLANT_LEAF) continue;
        const double x = 0.5 * (double)(quad->corner[0][0] + quad->corner[2][0]);
        const double y = 0.5 * (double)(quad->corner[0][1] + quad->corner[2][1]);
        lowest = fmin(lowest, (double)quad->corner[0][2]);
        radius[leaf++] = (float)sqrt(x * x + y * y);
    }
    qsort(radius, (size_t)out->leaves, sizeof *radius, compare_radii);
    out->leaf_area = (float)leaf_area(out, share);
    out->crown_low = (float)lowest;
    out->crown_radius = out->leaves > 0 ? radius[out->leaves * 9 / 10] : 0;
    free(radius);
    return STATUS_OK;
}

typedef struct Nursery {
    Plants  *plants;
    uint64_t seed;
    Status   status[PLANT_KINDS];
} Nursery;

/* Takes the quads of a growth. */
static Status take_quads(PlantShape *out, const Growth *g)
{
    out->quads = g->bark_quads + g->leaves, out->bark_quads = g->bark_quads, out->pieces = g->pieces,
    out->leaves = g->leaves;
    if (g->lost || out->quads == 0 || !(out->quad = malloc((size_t)out->quads * sizeof *out->quad)))
        return STATUS_NO_MEMORY;
    if (g->bark_quads) memcpy(out->quad, g->bark, (size_t)g->bark_quads * sizeof *g->bark);
    if (g->leaves) memcpy(out->quad + g->bark_quads, g->leaf, (size_t)g->leaves * sizeof *g->leaf);
    return STATUS_OK;
}

static double mean_of(const double share[plant_outlines])
{
    double sum = 0;
    for (int k = 0; k < plant_outlines; k++) sum += share[k] / plant_outlines;
    return sum;
}

/* The fine level last: its leaf area is that of the whole one. */
static Status grow_levels(Plants *plants, int kind, uint64_t seed)
{
    static const int order[plant_levels] = {plant_whole, plant_simple, plant_fine};
    double           outline[plant_outlines], pattern[plant_outlines];
    double           height = 1;
    Status           status = STATUS_OK;
    for (int k = 0; k < plant_outlines; k++) {
        outline[k] = (double)plants->outline_area[kind][k];
        pattern[k] = kind < PLANT_STANDING ? (double)plants->pattern[kind][k].area : outline[k];
    }
    for (int l = 0; l < plant_levels && status == STATUS_OK; l++) {
        const int     level = order[l];
        const double *share = level == plant_fine ? pattern : outline;
        PlantShape   *out = &plants->shape[kind][level];
        Growth        g = {.seed = seed,
                           .kind = kind,
                           .level = level,
                           .outline_area = mean_of(outline),
                           .pattern_area = mean_of(pattern),
                           .height = height};
        if (kind < PLANT_TREES) grow_tree(&g);
        else grow_low_plant(&g);
        status = take_quads(out, &g);
        free(g.bark), free(g.leaf);
        for (int k = 0; k < 3 && status == STATUS_OK && level == plant_fine && kind < PLANT_STANDING; k++)
            scale_cards(out, share,
                        (double)plants->shape[kind][plant_whole].leaf_area); /* which moves the top a little */
        if (status == STATUS_OK && level == plant_whole) height = top(out);
        if (status == STATUS_OK) status = finish_shape(out, share);
        for (int q = 0; status == STATUS_OK && q < out->quads && level == plant_fine && kind < PLANT_STANDING; q++)
            out->quad[q].open_up = out->quad[q].open_down = -1;
    }
    return status;
}

static void grow_kind(void *user, int worker, int kind)
{
    Nursery *n = user;
    (void)worker;
    for (int k = 0; k < plant_outlines; k++) {
        LeafOutline *outline = &n->plants->outline[kind][k];
        plant_outline(outline, (PlantKind)kind, k, n->seed);
        n->plants->outline_area[kind][k] = (float)plant_outline_area(outline);
        if (kind < PLANT_STANDING) plant_pattern(&n->plants->pattern[kind][k], (PlantKind)kind, k, n->seed);
    }
    n->status[kind] = grow_levels(n->plants, kind, n->seed);
}

Status plants_create(Plants **out, uint64_t seed, Pool *pool)
{
    Nursery n = {.plants = calloc(1, sizeof *n.plants), .seed = seed};
    if (!n.plants) return STATUS_NO_MEMORY;
    n.plants->patterned = PLANT_STANDING;
    if (!(n.plants->pattern = calloc(PLANT_STANDING, sizeof *n.plants->pattern))) {
        free(n.plants);
        return STATUS_NO_MEMORY;
    }
    if (pool) pool_run(pool, PLANT_KINDS, grow_kind, &n);
    else
        for (int kind = 0; kind < PLANT_KINDS; kind++) grow_kind(&n, 0, kind);
    for (int kind = 0; kind < PLANT_KINDS; kind++)
        if (n.status[kind] != STATUS_OK) {
            plants_destroy(n.plants);
            return STATUS_NO_MEMORY;
        }
    *out = n.plants;
    return STATUS_OK;
}

void plants_destroy(Plants *plants)
{
    if (!plants) return;
    for (int kind = 0; kind < PLANT_KINDS; kind++)
        for (int level = 0; level < plant_levels; level++) free(plants->shape[kind][level].quad);
    free(plants->pattern);
    free(plants);
}
