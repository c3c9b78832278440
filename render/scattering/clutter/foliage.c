/* render/scattering/clutter/foliage.c: crowns in squares, and the loss of a ray in them. */
#include "render/scattering/clutter/foliage_private.h"

#include <stdlib.h>

enum { squares_most = 4000000 };

/* ---- crowns -------------------------------------------------------------------------------------- */

static uint8_t class_of(PlantKind kind)
{
    if (!plant_is_tree(kind)) return SURFACE_SCRUB;
    return kind == PLANT_PINE ? SURFACE_FOREST_CONIFER : SURFACE_FOREST_BROADLEAF;
}

static FoliageCrown crown_of(const Plant *plant, const Plants *plants)
{
    const PlantShape *shape = &plants->shape[plant->kind][plant_whole];
    const double      low = clamp((double)shape->crown_low, 0, 0.95), middle = 0.5 * (low + 1);
    double            axis[3][3], scale[2];
    FoliageCrown      crown;
    plant_axes(axis, scale, plant, NULL);
    for (int k = 0; k < 3; k++) crown.centre_m[k] = plant->p_m[k] + (float)(scale[1] * middle * axis[2][k]);
    crown.across_m = (float)(scale[0] * (double)shape->crown_radius);
    crown.up_m = (float)(0.5 * scale[1] * (1 - low));
    crown.surface = class_of((PlantKind)plant->kind);
    return crown;
}

/* The squares that a crown reaches into. */
typedef struct Reach {
    int x0, x1, y0, y1;
} Reach;

static Reach reach_of(const Foliage *f, const FoliageCrown *c)
{
    const double x = (double)c->centre_m[0], y = (double)c->centre_m[1], r = (double)c->across_m;
    return (Reach){foliage_square_at(x - r, f->side_m, f->nx), foliage_square_at(x + r, f->side_m, f->nx),
                   foliage_square_at(y - r, f->side_m, f->ny), foliage_square_at(y + r, f->side_m, f->ny)};
}

static Status list_crowns(Foliage *f)
{
    const size_t squares = (size_t)f->nx * (size_t)f->ny;
    f->first = calloc(squares + 1, sizeof *f->first);
    f->top_m = malloc(squares * sizeof *f->top_m);
    if (!f->first || !f->top_m) return STATUS_NO_MEMORY;
    for (size_t s = 0; s < squares; s++) f->top_m[s] = -INFINITY;
    uint32_t *first = f->first + 1; /* first[s]: where square s is filled next, and so ends up at its end */
    for (int pass = 0; pass < 2; pass++) {
        for (int i = 0; i < f->count; i++) {
            const FoliageCrown *c = &f->crown[i];
            const Reach         r = reach_of(f, c);
            for (int y = r.y0; y <= r.y1; y++)
                for (int x = r.x0; x <= r.x1; x++) {
                    const size_t s = (size_t)y * (size_t)f->nx + (size_t)x;
                    if (pass == 0) first[s]++;
                    else f->listed[first[s]++] = (uint32_t)i;
                    f->top_m[s] = fmaxf(f->top_m[s], c->centre_m[2] + c->up_m);
                }
        }
        if (pass == 1) break;
        uint32_t sum = 0;
        for (size_t s = 0; s < squares; s++) {
            const uint32_t here = first[s];
            first[s] = sum;
            sum += here;
        }
        f->listed = malloc(((size_t)sum + 1) * sizeof *f->listed);
        if (!f->listed) return STATUS_NO_MEMORY;
    }
    return STATUS_OK;
}

Status foliage_create(Foliage **out, const Woods *woods, const Plants *plants, const ClutterTable *table,
                      ClutterBand band)
{
    Foliage *f = calloc(1, sizeof *f);
    if (!f) return STATUS_NO_MEMORY;
    memcpy(f->origin_enu, woods->origin_enu, sizeof f->origin_enu);
    f->woods = woods;
    f->count = woods->count;
    f->wide_m[0] = woods->nx * woods_square_m, f->wide_m[1] = woods->ny * woods_square_m;
    for (int s = 0; s < SURFACE_COUNT; s++) f->db_m[s] = table->row[s][band].foliage_db_m;
    for (f->side_m = 16; ceil(f->wide_m[0] / f->side_m) * ceil(f->wide_m[1] / f->side_m) > squares_most;)
        f->side_m *= 2;
    f->nx = (int)fmax(ceil(f->wide_m[0] / f->side_m), 1);
    f->ny = (int)fmax(ceil(f->wide_m[1] / f->side_m), 1);
    f->crown = malloc(((size_t)f->count + 1) * sizeof *f->crown);
    if (f->crown)
        for (int i = 0; i < f->count; i++) f->crown[i] = crown_of(&woods->plant[i], plants);
    const Status status = f->crown ? list_crowns(f) : STATUS_NO_MEMORY;
    if (status == STATUS_OK) *out = f;
    else foliage_destroy(f);
    return status;
}

void foliage_destroy(Foliage *f)
{
    if (!f) return;
    free(f->crown);
    free(f->first);
    free(f->listed);
    free(f->top_m);
    free(f);
}

const Woods        *foliage_woods(const Foliage *f) { return f->woods; }
int                 foliage_count(const Foliage *f) { return f->count; }
const FoliageCrown *foliage_crown(const Foliage *f, int index) { return &f->crown[index]; }
const double       *foliage_origin(const Foliage *f) { return f->origin_enu; }

bool foliage_reaches(const Foliage *f, double x_m, double y_m)
{
    const double x = x_m - f->origin_enu[0], y = y_m - f->origin_enu[1];
    return x >= 0 && y >= 0 && x < f->wide_m[0] && y < f->wide_m[1] && woods_is_planted(f->woods, x_m, y_m);
}

int foliage_in(int *index, int most, const Foliage *f, const double low_m[2], const double high_m[2])
{
    double low[2], high[2];
    int    count = 0;
    for (int k = 0; k < 2; k++) low[k] = low_m[k] - f->origin_enu[k], high[k] = high_m[k] - f->origin_enu[k];
    for (int y = foliage_square_at(low[1], f->side_m, f->ny); y <= foliage_square_at(high[1], f->side_m, f->ny); y++)
        for (int x = foliage_square_at(low[0], f->side_m, f->nx); x <= foliage_square_at(high[0], f->side_m, f->nx);
             x++) {
            const size_t s = (size_t)y * (size_t)f->nx + (size_t)x;
            for (uint32_t at = f->first[s]; at < f->first[s + 1]; at++) {
                const FoliageCrown *c = &f->crown[f->listed[at]];
                const double        cx = (double)c->centre_m[0], cy = (double)c->centre_m[1];
                /* a crown is listed in each square that it reaches into, and counted in the square of its middle */
                if (foliage_square_at(cx, f->side_m, f->nx) != x || foliage_square_at(cy, f->side_m, f->ny) != y)
                    continue;
                if (!(cx >= low[0] && cx < high[0] && cy >= low[1] && cy < high[1])) continue;
                if (count < most) index[count] = (int)f->listed[at];
                count++;
            }
        }
    return count;
}

/* ---- along a ray --------------------------------------------------------------------------------- */

/* Length of a stretch that is in a crown. */
static double length_in(const FoliageCrown *c, const Stretch *s)
{
    const double across = 1 / (double)c->across_m, up = 1 / (double)c->up_m;
    double       p[3], d[3], middle_m, half_m;
    for (int k = 0; k < 3; k++) {
        const double scale = k < 2 ? across : up;
        p[k] = (s->o[k] - (double)c->centre_m[k]) * scale;
        d[k] = s->d[k] * scale;
    }
    return line_meets_crown(&middle_m, &half_m, p, d) ? stretch_within(middle_m, half_m, s->from_m, s->to_m) : 0;
}

/* The part of a ray in one square: a crown that reaches into several is met once along the whole. */
static void add_square(double depth_m[SURFACE_COUNT], const Foliage *f, const Stretch *ray, int x, int y)
{
    const size_t s = (size_t)y * (size_t)f->nx + (size_t)x;
    Stretch      here;
    if (f->first[s] == f->first[s + 1] || !stretch_in_square(&here, f, ray, x, y)) return;
    for (uint32_t at = f->first[s]; at < f->first[s + 1]; at++) {
        const FoliageCrown *c = &f->crown[f->listed[at]];
        depth_m[c->surface] += length_in(c, &here);
    }
}

double foliage_loss_db(double *depth_m, const Foliage *f, const double o_enu[3], const double d_enu[3], double range_m)
{
    double  depth[SURFACE_COUNT] = {0};
    Stretch ray;
    int     first, last, west, east;
    if (depth_m) *depth_m = 0;
    if (!stretch_open(&ray, f, o_enu, d_enu, range_m)) return 0;
    /* row by row, the columns that the ray passes in each */
    stretch_rows(&first, &last, f, &ray);
    for (int y = first; y <= last; y++) {
        if (!stretch_columns(&west, &east, f, &ray, y)) continue;
        for (int x = west; x <= east; x++) add_square(depth, f, &ray, x, y);
    }
    return foliage_db_of(depth_m, f, depth);
}
