/* entities/import/import_surface.c: default surface of a part: material, heat, normals. */
#include "entities/import/model_import_private.h"
#include "pitviper_table.h"

#include <ctype.h>
#include <stdlib.h>

/* ---- materials ---------------------------------------------------------------------------------------- */

typedef struct PaintRow {
    const char *name;
    float       rgb[3];
} PaintRow;

static Status read_paints(ImportPaints *paints, const char *path)
{
    static const TableColumn columns[] = {{"name", .type = TABLE_CELL, TABLE_AT(PaintRow, name)},
                                          {"rho_r", TABLE_FLOAT, TABLE_AT(PaintRow, rgb[0]), .high = 1},
                                          {"rho_g", TABLE_FLOAT, TABLE_AT(PaintRow, rgb[1]), .high = 1},
                                          {"rho_b", TABLE_FLOAT, TABLE_AT(PaintRow, rgb[2]), .high = 1}};
    static const TableFormat format = {"model", columns, 4, .next = "etc/materials.csv explains the columns"};
    TableRows                rows;
    Status                   status = table_rows_open(&rows, &format, path);
    if (status != STATUS_OK) return status;
    const size_t most = (size_t)paints->count + (size_t)rows.table.rows + 1;
    char(*names)[32] = realloc(paints->name, most * sizeof *names);
    if (names) paints->name = names;
    float(*rgb)[3] = realloc(paints->rgb, most * sizeof *rgb);
    if (rgb) paints->rgb = rgb;
    if (!names || !rgb) status = STATUS_NO_MEMORY;
    for (int r = 0; r < rows.table.rows && status == STATUS_OK; r++) {
        PaintRow row;
        int      at = 0; /* the user's own row replaces one of the same name in its place, since of two equal ones the
                            first counts */
        status = table_rows_get(&row, &rows, r);
        if (status != STATUS_OK) break;
        while (at < paints->count && strcmp(paints->name[at], row.name) != 0) at++;
        snprintf(paints->name[at], sizeof paints->name[0], "%s", row.name);
        memcpy(paints->rgb[at], row.rgb, sizeof row.rgb);
        paints->count += at == paints->count;
    }
    table_rows_close(&rows);
    return status;
}

Status import_paints_open(ImportPaints *out)
{
    char         path[4096];
    const char  *own = etc_own("materials.csv");
    ImportPaints paints = {0};
    if (!etc_path(path, sizeof path, "materials.csv")) return STATUS_BAD_VALUE;
    Status status = read_paints(&paints, path);
    if (status == STATUS_OK && own) status = read_paints(&paints, own);
    if (status == STATUS_OK) *out = paints;
    else import_paints_close(&paints);
    return status;
}

void import_paints_close(ImportPaints *paints)
{
    free(paints->name);
    free(paints->rgb);
    memset(paints, 0, sizeof *paints);
}

bool import_paints_have(const ImportPaints *paints, const char *name)
{
    for (int i = 0; i < paints->count; i++)
        if (strcmp(paints->name[i], name) == 0) return true;
    return false;
}

/* Where a word ends in the text, ignoring case; 0: it is not there. The rightmost counts, since the last word is the
 * most specific. */
static size_t word_end(const char *text, const char *word)
{
    size_t       end = 0;
    const size_t length = strlen(word);
    for (const char *at = text; (at = strcasestr(at, word)); at++) end = (size_t)(at - text) + length;
    return end;
}

const char *import_paint_guess(ImportMaterialSource *source, const ImportPaints *paints, const ImportMaterial *material)
{
    static const struct {
        const char *word, *material;
    } words[] = {
        {"glass", "glass_window"},
        {"window", "glass_window"},
        {"lens", "glass_window"},
        {"rubber", "rubber_black"},
        {"tyre", "rubber_black"},
        {"tire", "rubber_black"},
        {"canvas", "canvas"},
        {"tarp", "canvas"},
        {"wood", "wood_pine"},
        {"aluminium", "metal_aluminium_bare"},
        {"aluminum", "metal_aluminium_bare"},
        {"steel", "steel_worn"},
        {"track", "steel_worn"},
        {"bark", "bark_oak"},
        {"foliage", "leaf_deciduous"},
        {"leaves", "leaf_deciduous"},
        {"leaf", "leaf_deciduous"},
        {"brick", "brick_red"},
        {"concrete", "concrete"},
        {"olive", "paint_olive"},
        {"sand", "paint_sand"},
        {"tan", "paint_sand"},
    };
    /* colours of painted or bare things; a part is never guessed to be grass */
    static const char *const painted[] = {"paint_olive",       "paint_sand", "paint_grey", "paint_white_missile",
                                          "paint_black_gloss", "steel_worn", "metal_dark", "rubber_black",
                                          "wood_pine",         "brick_red"};
    const char              *best = NULL;
    size_t                   end = 0;
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        const size_t at = word_end(material->name, words[i].word);
        if (at <= end || !import_paints_have(paints, words[i].material)) continue;
        end = at;
        best = words[i].material;
    }
    *source = MATERIAL_BY_NAME;
    if (best) return best;
    double least = INFINITY;
    for (int i = 0; i < paints->count && material->has_colour; i++) {
        double distance = 0;
        bool   candidate = false;
        for (size_t k = 0; k < sizeof painted / sizeof *painted; k++)
            candidate |= strcmp(painted[k], paints->name[i]) == 0;
        if (!candidate) continue;
        for (int c = 0; c < 3; c++)
            distance += (material->rgb[c] - paints->rgb[i][c]) * (material->rgb[c] - paints->rgb[i][c]);
        if (!(distance < least)) continue;
        least = distance;
        best = paints->name[i];
    }
    *source = best ? MATERIAL_BY_COLOUR : MATERIAL_BY_DEFAULT;
    return best ? best : "paint_olive";
}

/* ---- heat ------------------------------------------------------------------------------------------------ */

HeatRole import_role_guess(const char *path)
{
    static const struct {
        const char *word;
        HeatRole    role;
    } words[] = {
        {"exhaust", HEAT_EXHAUST},    {"muffler", HEAT_EXHAUST}, {"engine", HEAT_ENGINE_DECK},
        {"grille", HEAT_ENGINE_DECK}, {"turret", HEAT_TURRET},   {"gun", HEAT_GUN},
        {"barrel", HEAT_GUN},         {"track", HEAT_TRACK},     {"wheel", HEAT_WHEEL},
        {"tyre", HEAT_WHEEL},         {"tire", HEAT_WHEEL},      {"rotor", HEAT_ROTOR},
        {"turbine", HEAT_TURBINE},    {"cabin", HEAT_CABIN},     {"hull", HEAT_HULL},
    };
    HeatRole role = HEAT_PASSIVE;
    size_t   end = 0;
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        const size_t at = word_end(path, words[i].word);
        if (at <= end) continue;
        end = at;
        role = words[i].role;
    }
    return role;
}

/* ---- normals ------------------------------------------------------------------------------------------------ */

enum { smooth_max_fan = 256 }; /* triangles about one point; beyond it every one keeps its own plane */

typedef struct Point {
    double p[3];
    int    corner;
} Point;

static int point_order(const void *a, const void *b)
{
    const Point *p = a, *q = b;
    for (int i = 0; i < 3; i++) {
        if (p->p[i] < q->p[i]) return -1;
        if (p->p[i] > q->p[i]) return 1;
    }
    return p->corner - q->corner;
}

/* The angle of a triangle at its corner k: how much of the fan about the point it fills. */
static double corner_angle(const double (*corner)[3], int c)
{
    const int first = c / 3 * 3;
    double    a[3], b[3];
    v3_sub(a, corner[first + (c + 1) % 3], corner[c]);
    v3_sub(b, corner[first + (c + 2) % 3], corner[c]);
    if (!v3_normalize(a, a) || !v3_normalize(b, b)) return 0;
    return acos(clamp(v3_dot(a, b), -1, 1));
}

int import_smooth(double (*vertex)[3], float (*normal)[3], uint32_t (*triangle)[3], const double (*corner)[3],
                  int triangle_count, double crease_rad)
{
    const int    corners = 3 * triangle_count;
    const double least = cos(crease_rad) - 1e-9;
    int          count = 0;
    Point       *point = malloc((size_t)corners * sizeof *point);
    double(*plane)[3] = malloc((size_t)triangle_count * sizeof *plane);
    if (!point || !plane) {
        count = -1;
        goto done;
    }
    for (int t = 0; t < triangle_count; t++) {
        double a[3], b[3], n[3];
        v3_sub(a, corner[3 * t + 1], corner[3 * t]);
        v3_sub(b, corner[3 * t + 2], corner[3 * t]);
        v3_cross(n, a, b);
        if (!v3_normalize(plane[t], n)) plane[t][0] = 1, plane[t][1] = plane[t][2] = 0;
    }
    for (int c = 0; c < corners; c++) {
        for (int i = 0; i < 3; i++) point[c].p[i] = corner[c][i] + 0.0; /* turns -0 into 0 */
        point[c].corner = c;
    }
    qsort(point, (size_t)corners, sizeof *point, point_order);
    for (int from = 0, to; from < corners; from = to) {
        for (to = from + 1; to < corners && memcmp(point[to].p, point[from].p, sizeof point[to].p) == 0; to++) {
        }
        const int first = count; /* vertices at this place */
        for (int i = from; i < to; i++) {
            const int c = point[i].corner;
            double    sum[3] = {0, 0, 0};
            float     n[3];
            if (to - from <= smooth_max_fan)
                for (int k = from; k < to; k++) {
                    const int other = point[k].corner;
                    if (v3_dot(plane[other / 3], plane[c / 3]) >= least)
                        v3_add_scaled(sum, sum, corner_angle(corner, other), plane[other / 3]);
                }
            if (!v3_normalize(sum, sum)) memcpy(sum, plane[c / 3], sizeof sum);
            for (int k = 0; k < 3; k++) n[k] = (float)sum[k];
            int v = first;
            while (v < count && count - first <= smooth_max_fan && memcmp(normal[v], n, sizeof n) != 0) v++;
            if (v == count || count - first > smooth_max_fan) {
                v = count++;
                memcpy(vertex[v], point[i].p, sizeof vertex[v]);
                memcpy(normal[v], n, sizeof n);
            }
            triangle[c / 3][c % 3] = (uint32_t)v;
        }
    }
done:
    free(point);
    free(plane);
    return count;
}
