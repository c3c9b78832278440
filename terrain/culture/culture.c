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

static bool are_finite(const double (*corner_m)[2], int corners)
{
    for (int k = 0; k < corners; k++)
        if (!isfinite(corner_m[k][0]) || !isfinite(corner_m[k][1])) return false;
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

static bool crosses_itself(const double (*p)[2], int n)
{
    for (int i = 0; i < n; i++)
        for (int k = i + 2; k < n; k++)
            if ((i > 0 || k + 1 < n) && they_meet(p[i], p[i + 1], p[k], p[(k + 1) % n])) return true;
    return false;
}

/* Drops corners that repeat, or lie on the line between their neighbours within a millimetre. Returns how many are
 * left. */
static int thin_out(double (*p)[2], int n)
{
    static const double nearest_m = 1e-3;
    for (bool dropped = true; dropped && n >= 3;) {
        int kept = 0;
        for (int k = 0; k < n; k++) {
            const double *before = kept > 0 ? p[kept - 1] : p[n - 1], *after = p[(k + 1) % n];
            const double  length_m = hypot(after[0] - before[0], after[1] - before[1]);
            const bool    repeats = hypot(p[k][0] - before[0], p[k][1] - before[1]) < nearest_m;
            const bool    straight = length_m > nearest_m && fabs(turn_m2(before, p[k], after)) < nearest_m * length_m;
            if (repeats || straight) continue;
            p[kept][0] = p[k][0], p[kept][1] = p[k][1], kept++;
        }
        dropped = kept < n;
        n = kept;
    }
    return n;
}

Status culture_add_building(Culture *c, const Building *building, const double (*corner_m)[2], int corners)
{
    static const double least_m2 = 1;
    if (corners < 3 || corners > culture_outline_most || !are_finite(corner_m, corners) ||
        !isfinite(building->base_m) || !(building->eaves_m > 0) || !(building->ridge_m >= building->eaves_m) ||
        !isfinite(building->ridge_m) || !isfinite(building->ridge_rad)) {
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
    for (int k = 0; area_m2 < 0 && k < left / 2; k++) {
        const double x_m = own[k][0], y_m = own[k][1];
        own[k][0] = own[left - 1 - k][0], own[k][1] = own[left - 1 - k][1];
        own[left - 1 - k][0] = x_m, own[left - 1 - k][1] = y_m;
    }
    c->building[c->buildings] = *building;
    c->building[c->buildings].first_corner = c->corners;
    c->building[c->buildings++].corners = left;
    c->corners += left;
    return STATUS_OK;
}

Status culture_add_line(Culture *c, const CultureLine *line, const double (*corner_m)[2], int corners)
{
    if (corners < 2 || corners > culture_outline_most || !are_finite(corner_m, corners) || !(line->width_m >= 0) ||
        !(line->height_m >= 0) || !isfinite(line->width_m) || !isfinite(line->height_m) ||
        line->kind >= CULTURE_LINE_KINDS) {
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
    const float *s = point->size_m;
    if (!isfinite(point->x_m) || !isfinite(point->y_m) || !isfinite(point->base_m) || !isfinite(point->heading_rad) ||
        !(s[0] > 0 && s[1] > 0 && s[2] > 0) || !isfinite(s[0] + s[1] + s[2]) || point->kind >= CULTURE_POINT_KINDS) {
        c->left_out++;
        return STATUS_OK;
    }
    const Status status = grow_records(c, &c->point, 3, sizeof *c->point, c->points);
    if (status == STATUS_OK) c->point[c->points++] = *point;
    return status;
}

Status culture_add_tree(Culture *c, const CultureTree *tree)
{
    if (!isfinite(tree->x_m) || !isfinite(tree->y_m) || !(tree->height_m >= 0) || !isfinite(tree->height_m)) {
        c->left_out++;
        return STATUS_OK;
    }
    const Status status = grow_records(c, &c->tree, 4, sizeof *c->tree, c->trees);
    if (status == STATUS_OK) c->tree[c->trees++] = *tree;
    return status;
}
