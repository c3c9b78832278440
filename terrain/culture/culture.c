/* terrain/culture/culture.c: the records of what people built, as they are added. */
#include "terrain/culture/culture_private.h"

#include <stdlib.h>

void culture_free(Culture *culture)
{
    free(culture->corner_m), free(culture->building), free(culture->line), free(culture->point), free(culture->tree);
    culture_index_free(culture);
    *culture = (Culture){0};
}

/* Room for `more` elements behind the `count` of an array. */
static Status grow(void *array, int *room, size_t size, int count, int more, int most)
{
    void **const data = array;
    if (more > most - count) {
        log_error("culture: more than %d records of a kind; take a smaller area", most);
        return STATUS_BAD_VALUE;
    }
    if (count + more <= *room) return STATUS_OK;
    const int wanted = count + more > 2 * *room ? count + more : 2 * *room;
    void     *larger = realloc(*data, (size_t)wanted * size);
    if (!larger) return STATUS_NO_MEMORY;
    *data = larger, *room = wanted;
    return STATUS_OK;
}

static Status grow_records(Culture *c, void *array, int kind, size_t size, int count)
{
    return grow(array, &c->room[kind], size, count, 1, culture_most_records);
}

static bool is_place(double x_m, double y_m)
{
    return fabs(x_m) <= culture_farthest_m && fabs(y_m) <= culture_farthest_m;
}

static bool are_places(const double (*corner_m)[2], int corners)
{
    for (int k = 0; k < corners; k++)
        if (!is_place(corner_m[k][0], corner_m[k][1])) return false;
    return true;
}

/* Twice the signed area of a triangle, positive when it turns left. */
static double turn_m2(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

double culture_area_m2(const double (*corner_m)[2], int corners)
{
    double sum = 0;
    for (int k = 1; k + 1 < corners; k++) sum += turn_m2(corner_m[0], corner_m[k], corner_m[k + 1]);
    return 0.5 * sum;
}

/* Whether segments ab and cd have a point in common. */
static bool they_meet(const double a[2], const double b[2], const double c[2], const double d[2])
{
    const double abc = turn_m2(a, b, c), abd = turn_m2(a, b, d), cda = turn_m2(c, d, a), cdb = turn_m2(c, d, b);
    if (((abc > 0) == (abd > 0) && abc != 0 && abd != 0) || ((cda > 0) == (cdb > 0) && cda != 0 && cdb != 0))
        return false;
    for (int k = 0; k < 2; k++)
        if (fmax(a[k], b[k]) < fmin(c[k], d[k]) || fmax(c[k], d[k]) < fmin(a[k], b[k])) return false;
    return true;
}

/* An edge of an outline, from corner `first` on, and what it spans along the outline's longer side. */
typedef struct Edge {
    double low_m, high_m;
    int    first;
} Edge;

static int lower_first(const void *a, const void *b)
{
    const Edge *p = a, *q = b;
    return p->low_m < q->low_m ? -1 : p->low_m > q->low_m ? 1 : p->first - q->first;
}

/* Whether two edges that are not neighbours meet. Edges are compared with those alone whose spans overlap, up to 256
 * times a corner: 10 ms for 4096 corners, whatever they are. An outline so tangled that this is not enough, which takes
 * more than 512 corners, counts as one that crosses itself. */
static bool crosses_itself(const double (*p)[2], int n)
{
    static const long tests_a_corner = 256;
    Edge              edge[culture_outline_most];
    double            low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int k = 0; k < n; k++)
        for (int c = 0; c < 2; c++) low[c] = fmin(low[c], p[k][c]), high[c] = fmax(high[c], p[k][c]);
    const int along = high[1] - low[1] > high[0] - low[0];
    for (int k = 0; k < n; k++) {
        const double a = p[k][along], b = p[(k + 1) % n][along];
        edge[k] = (Edge){fmin(a, b), fmax(a, b), k};
    }
    qsort(edge, (size_t)n, sizeof *edge, lower_first);
    long left = tests_a_corner * n;
    for (int i = 0; i < n; i++)
        for (int k = i + 1; k < n && edge[k].low_m <= edge[i].high_m; k++) {
            const int a = edge[i].first, b = edge[k].first, apart = a > b ? a - b : b - a;
            if (left-- == 0) return true;
            if (apart > 1 && apart < n - 1 && they_meet(p[a], p[(a + 1) % n], p[b], p[(b + 1) % n])) return true;
        }
    return false;
}

/* Drops corners that repeat, that lie on the line between their neighbours within a millimetre, or from which the
 * outline goes back the way it came. Returns how many are left. What dropping a corner lays bare is looked at again,
 * eight times at most. */
static int thin_out(double (*p)[2], int n)
{
    enum { most_rounds = 8 };
    static const double nearest_m = 1e-3;
    bool                dropped = true;
    for (int round = 0; dropped && n >= 3 && round < most_rounds; round++) {
        int kept = 0;
        for (int k = 0; k < n; k++) {
            const double *before = kept > 0 ? p[kept - 1] : p[n - 1], *after = p[(k + 1) % n];
            const double  length_m = hypot(after[0] - before[0], after[1] - before[1]);
            const bool    repeats = hypot(p[k][0] - before[0], p[k][1] - before[1]) < nearest_m;
            const bool    straight = fabs(turn_m2(before, p[k], after)) < nearest_m * length_m;
            if (repeats || straight || length_m < nearest_m) continue;
            p[kept][0] = p[k][0], p[kept][1] = p[k][1], kept++;
        }
        dropped = kept < n;
        n = kept;
    }
    return n;
}

/* Whether a height over the ground is one that anything built has. */
static bool is_height(float m) { return m > 0 && m <= culture_highest_m; }

static const double least_m2 = 1; /* of an outline */

/* Whether the numbers of a record are in their ranges; of a building or line its corners are another matter. */
static bool is_building(const Building *b)
{
    return isfinite(b->base_m) && is_height(b->eaves_m) && is_height(b->ridge_m) && b->ridge_m >= b->eaves_m &&
           isfinite(b->ridge_rad) && b->use < BUILDING_USES && b->roof < ROOF_SHAPES && b->wall_fabric < FABRICS &&
           b->roof_fabric < FABRICS && b->damage <= 3;
}

static bool is_line(const CultureLine *l)
{
    return l->width_m >= 0 && l->width_m <= culture_widest_m && l->height_m >= 0 && l->height_m <= culture_highest_m &&
           l->kind < CULTURE_LINE_KINDS;
}

static bool is_point(const CulturePoint *p)
{
    const float *s = p->size_m;
    return is_place(p->x_m, p->y_m) && isfinite(p->base_m) && isfinite(p->heading_rad) && s[0] > 0 &&
           s[0] <= culture_widest_m && s[1] > 0 && s[1] <= culture_widest_m && is_height(s[2]) &&
           p->kind < CULTURE_POINT_KINDS;
}

static bool is_tree(const CultureTree *t) { return is_place(t->x_m, t->y_m) && t->height_m >= 0 && t->height_m <= 200; }

Status culture_add_building(Culture *c, const Building *building, const double (*corner_m)[2], int corners)
{
    if (corners < 3 || corners > culture_outline_most || !are_places(corner_m, corners) || !is_building(building)) {
        c->left_out++;
        return STATUS_OK;
    }
    Status status = grow(&c->corner_m, &c->room[0], sizeof *c->corner_m, c->corners, corners, culture_most_corners);
    if (status == STATUS_OK) status = grow_records(c, &c->building, 1, sizeof *c->building, c->buildings);
    if (status != STATUS_OK) return status;
    double(*own)[2] = c->corner_m + c->corners;
    memcpy(own, corner_m, (size_t)corners * sizeof *own);
    const int    left = thin_out(own, corners);
    const double area_m2 = left < 3 ? 0 : culture_area_m2((const double(*)[2])own, left);
    if (fabs(area_m2) < least_m2 || crosses_itself((const double(*)[2])own, left)) {
        c->left_out++;
        return STATUS_OK;
    }
    for (int k = 1, n = left - 1; area_m2 < 0 && k < n; k++, n--) { /* the first corner stays the first */
        const double x_m = own[k][0], y_m = own[k][1];
        own[k][0] = own[n][0], own[k][1] = own[n][1];
        own[n][0] = x_m, own[n][1] = y_m;
    }
    c->building[c->buildings] = *building;
    c->building[c->buildings].first_corner = c->corners;
    c->building[c->buildings++].corners = left;
    c->corners += left;
    return STATUS_OK;
}

Status culture_add_line(Culture *c, const CultureLine *line, const double (*corner_m)[2], int corners)
{
    if (corners < 2 || corners > culture_outline_most || !are_places(corner_m, corners) || !is_line(line)) {
        c->left_out++;
        return STATUS_OK;
    }
    Status status = grow(&c->corner_m, &c->room[0], sizeof *c->corner_m, c->corners, corners, culture_most_corners);
    if (status == STATUS_OK) status = grow_records(c, &c->line, 2, sizeof *c->line, c->lines);
    if (status != STATUS_OK) return status;
    memcpy(c->corner_m + c->corners, corner_m, (size_t)corners * sizeof *corner_m);
    c->line[c->lines] = *line;
    c->line[c->lines].first_corner = c->corners;
    c->line[c->lines++].corners = corners;
    c->corners += corners;
    return STATUS_OK;
}

Status culture_add_point(Culture *c, const CulturePoint *point)
{
    if (!is_point(point)) {
        c->left_out++;
        return STATUS_OK;
    }
    const Status status = grow_records(c, &c->point, 3, sizeof *c->point, c->points);
    if (status == STATUS_OK) c->point[c->points++] = *point;
    return status;
}

Status culture_add_tree(Culture *c, const CultureTree *tree)
{
    if (!is_tree(tree)) {
        c->left_out++;
        return STATUS_OK;
    }
    const Status status = grow_records(c, &c->tree, 4, sizeof *c->tree, c->trees);
    if (status == STATUS_OK) c->tree[c->trees++] = *tree;
    return status;
}

/* ---- records from elsewhere ---------------------------------------------------------------------- */

static const double (*corners_of(const Culture *c, int first, int count, int least))[2]
{
    const bool there = first >= 0 && count >= least && count <= culture_outline_most && first <= c->corners - count;
    const double(*p)[2] = there ? (const double(*)[2])c->corner_m + first : NULL;
    return p && are_places(p, count) ? p : NULL;
}

const char *culture_fault(const Culture *c)
{
    if (c->corners > culture_most_corners || c->buildings > culture_most_records || c->lines > culture_most_records ||
        c->points > culture_most_records || c->trees > culture_most_records)
        return "numbers of records of culture";
    for (int n = 0; n < c->buildings; n++) {
        const Building *b = &c->building[n];
        const double(*p)[2] = corners_of(c, b->first_corner, b->corners, 3);
        if (!p || !is_building(b)) return "a building";
        if (!(culture_area_m2(p, b->corners) >= least_m2) || crosses_itself(p, b->corners))
            return "outline of a building";
    }
    for (int n = 0; n < c->lines; n++)
        if (!corners_of(c, c->line[n].first_corner, c->line[n].corners, 2) || !is_line(&c->line[n])) return "a line";
    for (int n = 0; n < c->points; n++)
        if (!is_point(&c->point[n])) return "a point of culture";
    for (int n = 0; n < c->trees; n++)
        if (!is_tree(&c->tree[n])) return "a tree of culture";
    return NULL;
}

/* ---- keys --------------------------------------------------------------------------------------- */

void culture_key_add(CacheKey *key, const Culture *c)
{
    if (!c) return;
    const int32_t count[] = {c->corners, c->buildings, c->lines, c->points, c->trees};
    _Static_assert(sizeof(Building) == 40, "no padding");
    cache_key_add(key, count, sizeof count);
    cache_key_add(key, c->corner_m, (size_t)c->corners * sizeof *c->corner_m);
    cache_key_add(key, c->building, (size_t)c->buildings * sizeof *c->building);
    for (int n = 0; n < c->lines; n++) {
        const CultureLine *l = &c->line[n];
        const int32_t      whole[] = {l->first_corner, l->corners, l->kind, l->surface};
        const float        number[] = {l->width_m, l->height_m};
        cache_key_add(key, &l->id, sizeof l->id);
        cache_key_add(key, whole, sizeof whole);
        cache_key_add(key, number, sizeof number);
    }
    for (int n = 0; n < c->points; n++) {
        const CulturePoint *p = &c->point[n];
        const double        number[] = {p->x_m,
                                        p->y_m,
                                        (double)p->base_m,
                                        (double)p->heading_rad,
                                        (double)p->size_m[0],
                                        (double)p->size_m[1],
                                        (double)p->size_m[2]};
        const int32_t       kind = p->kind;
        cache_key_add(key, &p->id, sizeof p->id);
        cache_key_add(key, number, sizeof number);
        cache_key_add(key, &kind, sizeof kind);
    }
    for (int n = 0; n < c->trees; n++) {
        const CultureTree *t = &c->tree[n];
        const double       number[] = {t->x_m, t->y_m, (double)t->height_m};
        const int32_t      whole[] = {t->kind, t->mark};
        cache_key_add(key, &t->id, sizeof t->id);
        cache_key_add(key, number, sizeof number);
        cache_key_add(key, whole, sizeof whole);
    }
}
