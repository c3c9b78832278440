/* entities/models/patches.c: the patches of a model: how finely its bodies are cut, and the figures of each patch. */
#include "entities/models/patches_private.h"

#include <stdlib.h>

static const double small_share = 0.02;  /* cells with less than this share of their body's area join another cell, */
static const double small_m2 = 0.01;     /* and so do cells smaller than this beside larger ones */
static const double facing_least = 1e-6; /* mean normals shorter than this have no direction */
static const double better =
    0.9; /* a fit must be better by this factor to be preferred, since mirrored cells fit equally */
static const double open_least = 0.01; /* share of a patch; when less of it is outside, it counts as inside */
static const double sinkage_m = 0.02;  /* what is lower than this over the base, and faces the ground by a cosine of */
static const double facing_ground = 0.5; /* this, touches it: a tyre of 0.5 m radius over 0.28 m; estimate */
enum { candidates = 16 };                /* points of a patch from among which some are chosen */

/* Ways to cut bodies, from fine to coarse. */
static const struct Fineness {
    double one_below; /* bodies whose boxes have less than this share of the sum of all boxes' surfaces are one patch */
    int    lengths;   /* most lengths that a body is cut into */
    bool   sides;     /* false: only the underside is apart from all other sides */
} fineness[] = {{0, 4, true},    {0.0025, 4, true}, {0.005, 4, true}, {0.01, 4, true},  {0.01, 2, true},
                {0.01, 1, true}, {0.02, 1, true},   {0.04, 1, true},  {0.04, 1, false}, {2, 1, true}};
enum { finenesses = sizeof fineness / sizeof fineness[0] };

/* Sums over the surface of a cell or a patch, in the axes of its body. */
typedef struct Sums {
    double area_m2;
    double p[3];   /* area times position */
    double n[3];   /* area times normal */
    double square; /* area times squared distance from the origin */
} Sums;

static void add_piece(Sums *sums, const Facet *f, const Piece *piece, double weight)
{
    double o[3];
    facet_point(o, f, piece->at[0]);
    const double area = weight * f->area_m2 * piece->share;
    sums->area_m2 += area;
    v3_add_scaled(sums->n, sums->n, area, f->n);
    for (int i = 1; i + 1 < piece->corners; i++) {
        double a[3], b[3], one[3], other[3], cross[3], sum[3];
        facet_point(a, f, piece->at[i]);
        facet_point(b, f, piece->at[i + 1]);
        v3_sub(one, a, o);
        v3_sub(other, b, o);
        v3_cross(cross, one, other);
        const double part = weight * 0.5 * v3_length(cross);
        v3_add(sum, a, b);
        v3_add(sum, sum, o);
        v3_add_scaled(sums->p, sums->p, part / 3, sum);
        /* second moment of a triangle: a twelfth of the area times this */
        sums->square += part / 12 * (v3_dot(o, o) + v3_dot(a, a) + v3_dot(b, b) + v3_dot(sum, sum));
    }
}

/* ---- cells to patches ------------------------------------------------------------------------- */

static void sum_cells(Sums (*cell)[cells_most], Cutter *c)
{
    memset(cell, 0, (size_t)c->bodies * sizeof *cell);
    for (int t = 0; t < c->model->triangle_count; t++) {
        const int b = c->body_of_part[c->model->triangle_part[t]];
        Facet     f;
        Piece     piece[cells_most];
        if (!facet_read(&f, c, t)) continue;
        const int pieces = facet_cut(piece, &f, &c->body[b]);
        for (int i = 0; i < pieces; i++) add_piece(&cell[b][piece[i].cell], &f, &piece[i], 1);
    }
    for (int b = 0; b < c->bodies; b++) {
        c->body[b].area_m2 = 0;
        for (int k = 0; k < cells_most; k++) c->body[b].area_m2 += cell[b][k].area_m2;
    }
}

static void join_sums(Sums *to, const Sums *from)
{
    to->area_m2 += from->area_m2;
    to->square += from->square;
    v3_add(to->p, to->p, from->p);
    v3_add(to->n, to->n, from->n);
}

/* How badly a small cell and a kept one go together: by position, relative to the body's size, and by direction. */
static double mismatch(const Sums *small, const Sums *kept, double size_m)
{
    double p[3], q[3], d[3], n[3], o[3];
    v3_scale(p, 1 / small->area_m2, small->p);
    v3_scale(q, 1 / kept->area_m2, kept->p);
    v3_sub(d, p, q);
    const bool directed = v3_normalize(n, small->n) && v3_normalize(o, kept->n);
    return v3_length(d) / size_m + 0.25 * (1 - (directed ? v3_dot(n, o) : 0));
}

static bool is_one(const Body *body, const struct Fineness *how, double boxes_m2)
{
    return !(body->box_m2 >= how->one_below * boxes_m2);
}

/* The number of patches to expect of a body, a box with ends at its ends. Unlike the true count it hardly depends on
 * the chord error, so coarse and fine builds of a model are cut alike. */
static int expected(const Body *body, const struct Fineness *how, double boxes_m2)
{
    const int lengths = body->lengths < how->lengths ? body->lengths : how->lengths;
    if (is_one(body, how, boxes_m2)) return 1;
    if (!how->sides) return body->faces == 3 ? 1 : 2 * lengths;
    return body->faces == 3 ? 3 : 2 + 4 * lengths;
}

/* Maps the cells of a body to its patches. */
static void map_cells(Body *body, const Sums cell[cells_most], const struct Fineness *how, double boxes_m2)
{
    Sums       group[cells_most] = {{0}};
    int        group_of[cells_most], patch_of[cells_most];
    const bool one = is_one(body, how, boxes_m2);
    const int  lengths = body->lengths < how->lengths ? body->lengths : how->lengths;
    for (int k = 0; k < cells_most; k++) {
        int face = k / lengths_most, along = k % lengths_most;
        if (one) {
            face = along = 0;
        } else {
            along = along < body->lengths ? along * lengths / body->lengths : 0;
            if (!how->sides)
                face = body->faces == 6 &&
                       face % faces_most == 4; /* the sides: only the face along +z, down, stays apart */
        }
        group_of[k] = face * lengths_most + along;
        join_sums(&group[group_of[k]], &cell[k]);
    }
    double largest = 0, size_m = 0;
    for (int k = 0; k < cells_most; k++) largest = fmax(largest, group[k].area_m2);
    for (int i = 0; i < 3; i++) size_m = fmax(size_m, body->box_high[i] - body->box_low[i]);
    const double least = fmax(small_share * body->area_m2, fmin(small_m2, largest));
    body->count = 0;
    for (int k = 0; k < cells_most; k++)
        patch_of[k] = group[k].area_m2 > 0 && group[k].area_m2 >= least ? body->count++ : -1;
    if (body->count == 0) patch_of[0] = body->count++; /* the body has no area at all */
    for (int k = 0; k < cells_most; k++) {
        const int g = group_of[k];
        body->map[k] = patch_of[g] >= 0 ? patch_of[g] : 0;
        if (patch_of[g] >= 0 || !(group[g].area_m2 > 0)) continue;
        double best = INFINITY;
        for (int kept = 0; kept < cells_most; kept++) {
            if (patch_of[kept] < 0) continue;
            const double bad = mismatch(&group[g], &group[kept], size_m);
            if (!(bad < best * better)) continue;
            best = bad;
            body->map[k] = patch_of[kept];
        }
    }
}

/* Chooses the grouping and the cuts; fills the cutter. */
static Status cut_model(int *count, Cutter *c)
{
    Sums(*cell)[cells_most] = malloc(patches_most * sizeof *cell);
    if (!cell) return STATUS_NO_MEMORY;
    Status status = STATUS_OK;
    *count = 0;
    for (int g = BY_MATERIAL; g < GROUPINGS && *count == 0 && status == STATUS_OK; g++) {
        if (!patches_group(c, (Grouping)g)) continue;
        if (g == BY_ROLE) status = patches_choose_nodes(c);
        if (status != STATUS_OK) break;
        patches_measure_bodies(c);
        sum_cells(cell, c);
        double boxes_m2 = 0;
        for (int b = 0; b < c->bodies; b++) boxes_m2 += c->body[b].box_m2;
        for (int i = 0; i < finenesses && *count == 0; i++) {
            int sum = 0, expect = 0;
            for (int b = 0; b < c->bodies; b++) {
                map_cells(&c->body[b], cell[b], &fineness[i], boxes_m2);
                c->body[b].first = sum;
                sum += c->body[b].count;
                expect += expected(&c->body[b], &fineness[i], boxes_m2);
            }
            const bool fits = expect <= c->wanted || i == finenesses - 1;
            if (fits && sum <= patches_most) *count = sum;
        }
    }
    free(cell);
    return status;
}

/* ---- figures of patches ----------------------------------------------------------------------- */

/* Points that divide a patch into equal areas in the order of its triangles. */
typedef struct Candidates {
    int    count;
    double seen_m2;
    double p[candidates][3], n[candidates][3];
} Candidates;

/* Whether a point of a triangle, in the axes of its body, is inside the model. */
static bool is_hidden(const Cutter *c, int triangle, const double p[3], const double n[3])
{
    const NodePose *pose = &c->pose[c->body[c->body_of_part[c->model->triangle_part[triangle]]].node];
    double          p_body[3], n_body[3];
    patches_moved(p_body, pose, p);
    m3_mul_v3(n_body, pose->r_body_from_node, n);
    return hidden_at(c->hidden, triangle, p_body, n_body);
}

/* Adds points of a triangle. weight: the triangle's share of patch_m2. On a triangle that is partly hidden it takes
 * points that are not hidden, where some tries find any. */
static void add_candidates(Candidates *c, double patch_m2, const Facet *f, const Piece *piece, double weight,
                           const Cutter *cutter, int triangle)
{
    static const double golden = 0.6180339887498949, silver = 0.4142135623730950;
    static const int    tries = 48;
    double              whole = 0;
    for (int i = 1; i + 1 < piece->corners; i++) {
        const double *o = piece->at[0], *a = piece->at[i], *b = piece->at[i + 1];
        const double  share = (a[1] - o[1]) * (b[2] - o[2]) - (a[2] - o[2]) * (b[1] - o[1]);
        const double  area = weight * f->area_m2 * fmax(0, share);
        for (; c->count < candidates; c->count++) {
            const double ahead = patch_m2 * (c->count + 0.5) / candidates - c->seen_m2 - whole;
            if (!(ahead < area)) break;
            /* points are drawn uniformly over the triangle, and inside it */
            bool found = false;
            for (int t = 0; t < tries && !found; t++) {
                const double s = sqrt(clamp(t ? fmod(ahead / area + t * silver, 1) : ahead / area, 0.01, 0.99));
                const double u = 0.05 + 0.9 * fmod((c->count + t) * golden + 0.5, 1);
                double       at[3];
                for (int k = 0; k < 3; k++) at[k] = (1 - s) * o[k] + s * ((1 - u) * a[k] + u * b[k]);
                facet_point(c->p[c->count], f, at);
                memcpy(c->n[c->count], f->n, sizeof f->n);
                found = !(weight < 1 && is_hidden(cutter, triangle, c->p[c->count], f->n));
            }
            if (found || c->count == 0) continue;
            memcpy(c->p[c->count], c->p[c->count - 1], sizeof c->p[0]);
            memcpy(c->n[c->count], c->n[c->count - 1], sizeof c->n[0]);
        }
        whole += area;
    }
    c->seen_m2 += whole;
}

/* Coordinate 0 .. 5 of a candidate: its position, then its direction, scaled to lengths. */
static double coordinate(const Candidates *c, int i, int axis, double reach_m)
{
    return axis < 3 ? c->p[i][axis] : reach_m * c->n[i][axis - 3];
}

/* Sorts by the coordinate that varies most. */
static void sort_widest(const Candidates *c, int *index, int count, double reach_m)
{
    int    widest = 0;
    double most = -1;
    for (int axis = 0; axis < 6; axis++) {
        double low = INFINITY, high = -INFINITY;
        for (int i = 0; i < count; i++) {
            low = fmin(low, coordinate(c, index[i], axis, reach_m));
            high = fmax(high, coordinate(c, index[i], axis, reach_m));
        }
        if (high - low > most * (1 + 1e-6)) {
            most = high - low;
            widest = axis;
        }
    }
    for (int i = 1; i < count; i++) {
        const int    moved = index[i];
        const double key = coordinate(c, moved, widest, reach_m);
        int          k = i;
        for (; k > 0 && coordinate(c, index[k - 1], widest, reach_m) > key; k--) index[k] = index[k - 1];
        index[k] = moved;
    }
}

/* Halves the candidates by the widest coordinate, then the halves, and takes the middle candidate of each quarter. */
static void choose_points(Patch *patch, const Candidates *c)
{
    int index[candidates], quarter = candidates / patch_points;
    for (int i = 0; i < candidates; i++) index[i] = i < c->count ? i : c->count > 0 ? i % c->count : 0;
    sort_widest(c, index, candidates, patch->reach_m);
    for (int half = 0; half < 2; half++) sort_widest(c, index + half * candidates / 2, candidates / 2, patch->reach_m);
    for (int q = 0; q < patch_points; q++) {
        const int *own = index + q * quarter;
        double     best = INFINITY;
        int        chosen = own[0];
        for (int i = 0; i < quarter; i++) {
            double sum = 0; /* sum of squared distances to the others, which is least in the middle */
            for (int k = 0; k < quarter; k++)
                for (int axis = 0; axis < 6; axis++) {
                    const double d =
                        coordinate(c, own[i], axis, patch->reach_m) - coordinate(c, own[k], axis, patch->reach_m);
                    sum += d * d;
                }
            if (!(sum < best * (1 - 1e-9))) continue;
            best = sum;
            chosen = own[i];
        }
        memcpy(patch->point_node[q], c->p[chosen], sizeof c->p[chosen]);
        memcpy(patch->point_n_node[q], c->n[chosen], sizeof c->n[chosen]);
    }
}

/* Computes a patch's figures. sums: over what is not hidden, or over all where open_share is 0. */
static void finish_patch(Patch *patch, const Body *body, const Sums *sums, const Candidates *c, const NodePose *pose)
{
    static const double up_body[3] = {0, 0, -1};
    patch->node = body->node;
    patch->part = body->part;
    patch->role = body->role;
    m3_tmul_v3(patch->n_node, pose->r_body_from_node, up_body);
    if (sums->area_m2 > 0) {
        double n[3];
        v3_scale(patch->p_node, 1 / sums->area_m2, sums->p);
        v3_scale(n, 1 / sums->area_m2, sums->n);
        patch->facing = fmin(1, v3_length(n));
        if (patch->facing > facing_least) v3_normalize(patch->n_node, n);
        patch->reach_m = sqrt(fmax(0, sums->square / sums->area_m2 - v3_dot(patch->p_node, patch->p_node)));
        choose_points(patch, c);
    } else {
        for (int i = 0; i < patch_points; i++) memcpy(patch->point_n_node[i], patch->n_node, sizeof patch->n_node);
    }
}

/* The share of a triangle where a value that is linear over it is at least 0. */
static double share_above(const double value[3])
{
    for (int k = 0; k < 3; k++) { /* one corner alone on its side of 0 */
        const double a = value[k], b = value[(k + 1) % 3], c = value[(k + 2) % 3];
        if ((a >= 0) == (b >= 0) || (b >= 0) != (c >= 0)) continue;
        const double alone = a / (a - b) * (a / (a - c));
        return a >= 0 ? alone : 1 - alone;
    }
    return value[0] >= 0;
}

/* Share of a triangle that lies on level ground under the base. */
static double share_on_ground(const Facet *f, const NodePose *pose)
{
    double n_body[3], above[3];
    m3_mul_v3(n_body, pose->r_body_from_node, f->n);
    if (!(n_body[2] > facing_ground)) return 0;
    for (int k = 0; k < 3; k++) {
        double p_body[3];
        patches_moved(p_body, pose, f->p[k]);
        above[k] = p_body[2] + sinkage_m;
    }
    return share_above(above);
}

/* Sums over all of a patch, and over what is not hidden. */
typedef struct PatchSums {
    Sums   all, open;
    double ground_m2;
} PatchSums;

static void measure_triangle(PatchSums *sums, Candidates *found, const Patches *out, const Cutter *c, int t, int pass)
{
    const Body     *body = &c->body[c->body_of_part[c->model->triangle_part[t]]];
    const NodePose *pose = &c->pose[body->node];
    Facet           f;
    Piece           piece[cells_most];
    if (!facet_read(&f, c, t)) return;
    const int    pieces = facet_cut(piece, &f, body);
    const double open = hidden_open(c->hidden, t), on_ground = pass == 0 ? open * share_on_ground(&f, pose) : 0;
    for (int i = 0; i < pieces; i++) {
        const int  patch = body->first + body->map[piece[i].cell];
        PatchSums *s = &sums[patch];
        if (pass == 0) {
            add_piece(&s->all, &f, &piece[i], 1);
            if (open > 0) add_piece(&s->open, &f, &piece[i], open);
            s->ground_m2 += on_ground * f.area_m2 * piece[i].share;
        } else if (out->patch[patch].open_share > 0) {
            add_candidates(&found[patch], s->open.area_m2, &f, &piece[i], open, c, t);
        } else {
            add_candidates(&found[patch], s->all.area_m2, &f, &piece[i], 1, c, t); /* the patch is inside as a whole */
        }
    }
}

static Status measure_patches(Patches *out, const Cutter *c)
{
    PatchSums  *sums = calloc((size_t)out->count, sizeof *sums);
    Candidates *found = calloc((size_t)out->count, sizeof *found);
    const bool  enough = sums && found;
    for (int pass = 0; pass < 2 && enough; pass++) {
        for (int t = 0; t < c->model->triangle_count; t++) measure_triangle(sums, found, out, c, t, pass);
        for (int i = 0; i < out->count && pass == 0; i++) {
            const double share = sums[i].all.area_m2 > 0 ? sums[i].open.area_m2 / sums[i].all.area_m2 : 0;
            out->patch[i].area_m2 = sums[i].all.area_m2;
            out->patch[i].open_share = share >= open_least ? share : 0;
            out->patch[i].ground_m2 = share >= open_least ? sums[i].ground_m2 : 0;
        }
    }
    for (int b = 0; b < c->bodies && enough; b++)
        for (int i = c->body[b].first; i < c->body[b].first + c->body[b].count; i++)
            finish_patch(&out->patch[i], &c->body[b], out->patch[i].open_share > 0 ? &sums[i].open : &sums[i].all,
                         &found[i], &c->pose[c->body[b].node]);
    free(sums);
    free(found);
    return enough ? STATUS_OK : STATUS_NO_MEMORY;
}

/* ---- creation --------------------------------------------------------------------------------- */

void patches_destroy(Patches *patches)
{
    free(patches->patch);
    free(patches->link);
    free(patches->body_of_part);
    free(patches->first_of_body);
    free(patches->body_of_node);
    memset(patches, 0, sizeof *patches);
}

static Status fill(Patches *out, Cutter *c)
{
    Status status = hidden_create(&c->hidden, c->model, c->pose);
    if (status == STATUS_OK) status = cut_model(&out->count, c);
    if (status != STATUS_OK) return status;
    out->bodies = c->bodies;
    out->patch = calloc((size_t)out->count, sizeof *out->patch);
    out->first_of_body = calloc((size_t)out->bodies + 1, sizeof *out->first_of_body);
    if (!out->patch || !out->first_of_body) return STATUS_NO_MEMORY;
    for (int b = 0; b < c->bodies; b++) out->first_of_body[b] = c->body[b].first;
    out->first_of_body[out->bodies] = out->count;
    status = measure_patches(out, c);
    return status == STATUS_OK ? patches_link(out, c) : status;
}

Status patches_create(Patches *out, const Model *model) { return patches_create_of(out, model, patches_wanted); }

Status patches_create_of(Patches *out, const Model *model, int wanted)
{
    memset(out, 0, sizeof *out);
    Status  status = STATUS_NO_MEMORY;
    Cutter *c = calloc(1, sizeof *c);
    if (!c) return status;
    c->model = model;
    c->wanted = wanted;
    c->pose = calloc((size_t)model->node_count, sizeof *c->pose);
    c->body_of_part = calloc((size_t)model->part_count, sizeof *c->body_of_part);
    if (c->pose && c->body_of_part) {
        model_pose(c->pose, model, NULL);
        status = fill(out, c);
    }
    out->parts = model->part_count;
    out->body_of_part = c->body_of_part;
    out->body_of_node = c->body_of_node;
    if (status != STATUS_OK) patches_destroy(out);
    hidden_destroy(c->hidden);
    free(c->pose);
    free(c);
    return status;
}

/* ---- values ----------------------------------------------------------------------------------- */

double patches_value(const Patches *patches, const float *value, int part, const double p_node[3],
                     const double n_node[3])
{
    /* Inverse squared distance; a quarter of the squared reach rounds its peak. What faces more than one way has a
     * weight in all directions too, up to `all_ways`: all around a tyre, as against its flat sides. */
    static const double rounding = 0.25, tiny_m2 = 1e-6, all_ways = 0.1, one_way = 0.8;
    if (part < 0 || part >= patches->parts) return value[0];
    const int    first = patches->first_of_body[patches->body_of_part[part]];
    const int    end = patches->first_of_body[patches->body_of_part[part] + 1];
    const double base = (double)value[first];
    if (end - first == 1) return base;
    double p[3] = {p_node[0], p_node[1], p_node[2]}, n[3] = {n_node[0], n_node[1], n_node[2]};
    if (patches->body_of_node) {
        patches_moved(p, &patches->body_of_node[part], p_node);
        m3_mul_v3(n, patches->body_of_node[part].r_body_from_node, n_node);
    }
    /* differences from the first: a constant comes out exactly */
    double sum = 0, weights = 0, nearest_m2 = INFINITY, nearest = 0;
    for (int i = first; i < end; i++) {
        const Patch *k = &patches->patch[i];
        double       d[3];
        v3_sub(d, p, k->p_node);
        const double m2 = v3_dot(d, d), cosine = v3_dot(n, k->n_node), ahead = cosine > 0 ? cosine * cosine : 0;
        const double blunt = k->facing < one_way ? all_ways * (one_way - k->facing) / one_way : 0;
        const double w =
            k->open_share * (k->facing * ahead * ahead + blunt) / (m2 + rounding * k->reach_m * k->reach_m + tiny_m2);
        const double more = (double)value[i] - base;
        sum += w * more;
        weights += w;
        if (m2 < nearest_m2) {
            nearest_m2 = m2;
            nearest = more;
        }
    }
    return base + (weights > 1e-30 ? sum / weights : nearest);
}
