/* entities/scenery/scenery_points.c: works at a place: poles, lamps, signs, tanks, silos, containers, heaps, stacks,
 * chimneys, masts.
 *
 * Sizes are the records'; what they leave open is estimated after what is usual: poles of 0.24 m at their foot, lattice
 * bars of 0.08 m, ribs of containers 36 mm deep (ISO 668 containers; here every 0.9 m, a third of the true number). */
#include "entities/scenery/scenery_buildings_private.h"

static const double foot_m = 0.3; /* into the ground */

static const char *one_of(const char *const *of, int count, uint64_t id)
{
    const int k = (int)(record_random(id, 1) * count);
    return of[k < count ? k : count - 1];
}

void cell_pole(CellMesh *cell, int slot, const double at[3], double high_m, double radius_m)
{
    const double rz[4][2] = {{0, at[2] - foot_m}, {1, at[2] - foot_m}, {0.7, at[2] + high_m}, {0, at[2] + high_m}};
    const double half[2] = {radius_m, radius_m};
    cell_round(cell, slot, at, half, 0, rz, 4, 6);
}

/* Four legs that draw together, with rungs and a diagonal on each side of every panel. */
void cell_lattice(CellMesh *cell, int slot, const double at[3], const double along[2], double high_m, double low_half_m,
                  double top_half_m)
{
    static const double bar_m = 0.04;
    static const int    side[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    const int           panels = (int)clamp(ceil(high_m / fmax(2.2 * (low_half_m + top_half_m), 1)), 1, 24);
    double              low[4][3], high[4][3];
    for (int j = 0; j < panels; j++) {
        for (int e = 0; e < 2; e++) {
            const double share = (double)(j + e) / panels, half = low_half_m + share * (top_half_m - low_half_m);
            for (int k = 0; k < 4; k++) {
                double *p = e ? high[k] : low[k];
                p[0] = at[0] + half * (side[k][0] * along[0] - side[k][1] * along[1]);
                p[1] = at[1] + half * (side[k][0] * along[1] + side[k][1] * along[0]);
                p[2] = at[2] + share * high_m - (j + e == 0 ? foot_m : 0);
            }
        }
        for (int k = 0; k < 4; k++) {
            const int l = (k + 1) % 4;
            cell_bar(cell, slot, low[k], high[k], 1.5 * bar_m);
            cell_bar(cell, slot, high[k], high[l], bar_m);
            cell_bar(cell, slot, j % 2 ? low[k] : low[l], j % 2 ? high[l] : high[k], bar_m);
        }
    }
}

/* ---- the kinds ------------------------------------------------------------------------------------ */

/* A place of a point: its middle, and its axes along its length and across. */
typedef struct Spot {
    double p[3], along[2];
} Spot;

static void lamp(CellMesh *cell, const CulturePoint *q, const Spot *s)
{
    const int    post = cell_part(cell, "post", "metal_steel_galvanized", HEAT_PASSIVE);
    const int    head = cell_part(cell, "lamp", "sheet_white", HEAT_PASSIVE);
    const double high_m = q->size_m[2], top[3] = {s->p[0], s->p[1], s->p[2] + high_m - 0.1};
    const double end[3] = {top[0] + 1.2 * s->along[0], top[1] + 1.2 * s->along[1], top[2] + 0.05};
    cell_pole(cell, post, s->p, high_m, 0.08);
    cell_bar(cell, post, top, end, 0.03);
    const double middle[2] = {end[0], end[1]};
    cell_box(cell, head, middle, s->along, 0.3, 0.12, end[2] - 0.09, end[2] + 0.06);
}

static void sign(CellMesh *cell, const CulturePoint *q, const Spot *s)
{
    static const char *const of[4] = {"sheet_white", "container_blue", "container_red", "sheet_white"};
    const int                post = cell_part(cell, "post", "metal_steel_galvanized", HEAT_PASSIVE);
    const int                plate = cell_part(cell, "plate", one_of(of, 4, q->id), HEAT_PASSIVE);
    const double             high_m = q->size_m[2], wide_m = q->size_m[0], deep_m = fmin(0.75 * wide_m, 0.6 * high_m);
    /* along its length, beside its post, which would else cut through it */
    const double beside[2] = {s->p[0] - 0.06 * s->along[1], s->p[1] + 0.06 * s->along[0]};
    cell_pole(cell, post, s->p, high_m, 0.04);
    cell_box(cell, plate, beside, s->along, 0.5 * wide_m, 0.015, s->p[2] + high_m - deep_m, s->p[2] + high_m);
}

static void tank(CellMesh *cell, const CulturePoint *q, const Spot *s, bool silo)
{
    static const char *const tanks[3] = {"sheet_white", "sheet_grey", "metal_aluminium_bare"};
    static const char *const silos[3] = {"metal_steel_galvanized", "concrete", "sheet_green"};
    const int    slot = cell_part(cell, silo ? "silo" : "tank", one_of(silo ? silos : tanks, 3, q->id), HEAT_PASSIVE);
    const double high_m = q->size_m[2], half[2] = {0.5 * (double)q->size_m[0], 0.5 * (double)q->size_m[1]};
    const double cone_m = fmin(silo ? 0.45 * (half[0] + half[1]) : 0.06 * (half[0] + half[1]), 0.4 * high_m);
    const double z = s->p[2], rz[4][2] = {{0, z - foot_m}, {1, z - foot_m}, {1, z + high_m - cone_m}, {0, z + high_m}};
    cell_round(cell, slot, s->p, half, (double)q->heading_rad, rz, 4, half[0] + half[1] > 4 ? 24 : 12);
}

static void container(CellMesh *cell, const CulturePoint *q, const Spot *s)
{
    static const char *const of[4] = {"container_red", "container_blue", "container_green", "paint_grey"};
    static const double      deep_m = 0.036;
    const int                slot = cell_part(cell, "container", one_of(of, 4, q->id), HEAT_PASSIVE);
    const double             half = 0.5 * (double)q->size_m[0], across = 0.5 * (double)q->size_m[1];
    const int                ribs = (int)clamp(floor(2 * half / 0.9), 1, 7);
    double                   p[64][2];
    int                      n = 0;
    for (int side = -1; side <= 1; side += 2) /* along the right side, back along the left */
        for (int k = 0; k < 4 * ribs + 2; k++) {
            static const double at[4] = {0.15, 0.3, 0.7, 0.85}; /* of a pitch: where the sheet goes in and out */
            const double        u = k == 0 ? 0 : k > 4 * ribs ? ribs : (k - 1) / 4 + at[(k - 1) % 4];
            const bool          is_in = k > 0 && k <= 4 * ribs && ((k - 1) % 4 == 1 || (k - 1) % 4 == 2);
            const double along = -side * (2 * half * u / ribs - half), out = side * (across - (is_in ? deep_m : 0));
            p[n][0] = s->p[0] + along * s->along[0] - out * s->along[1];
            p[n][1] = s->p[1] + along * s->along[1] + out * s->along[0];
            n++;
        }
    cell_prism(cell, slot, (const double(*)[2])p, n, s->p[2], s->p[2] + (double)q->size_m[2]);
}

/* A cone with a rounded top whose sides waver by its id. */
void cell_heap(CellMesh *cell, int slot, const double at[3], const double along[2], const double half[2], double high_m,
               uint64_t id)
{
    enum { sides = 12, rings = 4 };
    static const double radius[rings] = {1, 0.75, 0.45, 0.15}, high[rings] = {0, 0.35, 0.75, 1};
    double              p[rings][sides][3];
    for (int j = 0; j < rings; j++)
        for (int k = 0; k < sides; k++) {
            const double a = 2 * pi_rad * k / sides;
            const double wave = 1 - 0.25 * record_random(id, (uint32_t)(16 + j * sides + k)) * (j > 0 && j < 3);
            const double u = radius[j] * wave * cos(a) * half[0];
            const double v = radius[j] * wave * sin(a) * half[1];
            p[j][k][0] = at[0] + u * along[0] - v * along[1];
            p[j][k][1] = at[1] + u * along[1] + v * along[0];
            p[j][k][2] = at[2] + high[j] * high_m;
        }
    double foot[sides][3], under[sides][3];
    for (int k = 0; k < sides; k++) {
        memcpy(foot[k], p[0][k], sizeof foot[k]);
        foot[k][2] -= foot_m;
    }
    for (int k = 0; k < sides; k++) memcpy(under[k], foot[sides - 1 - k], sizeof under[k]);
    cell_face(cell, slot, (const double(*)[3])under, sides);
    cell_face(cell, slot, (const double(*)[3])p[rings - 1], sides);
    for (int j = -1; j + 1 < rings; j++)
        for (int k = 0; k < sides; k++) {
            const int     l = (k + 1) % sides;
            const double *a = j < 0 ? foot[k] : p[j][k], *b = j < 0 ? foot[l] : p[j][l];
            const double *c = p[j + 1][l], *d = p[j + 1][k];
            const double  t[3][3] = {{a[0], a[1], a[2]}, {b[0], b[1], b[2]}, {c[0], c[1], c[2]}};
            const double  o[3][3] = {{a[0], a[1], a[2]}, {c[0], c[1], c[2]}, {d[0], d[1], d[2]}};
            cell_face(cell, slot, t, 3);
            cell_face(cell, slot, o, 3);
        }
}

static void heap(CellMesh *cell, const CulturePoint *q, const Spot *s)
{
    static const char *const of[4] = {"rubble", "soil_loam_brown", "soil_plowed_dark", "sand_quartz"};
    const double             half[2] = {0.5 * (double)q->size_m[0], 0.5 * (double)q->size_m[1]};
    cell_heap(cell, cell_part(cell, "heap", one_of(of, 4, q->id), HEAT_PASSIVE), s->p, s->along, half,
              (double)q->size_m[2], q->id);
}

/* Layers of blocks, each a little out of place. */
static void stack(CellMesh *cell, const CulturePoint *q, const Spot *s)
{
    static const char *const of[3] = {"straw_bales", "wood_pine", "timber_weathered"};
    const int                slot = cell_part(cell, "heap", one_of(of, 3, q->id), HEAT_PASSIVE);
    const double             high_m = q->size_m[2];
    const int                layers = (int)clamp(floor(high_m / 0.8 + 0.5), 1, 6);
    for (int k = 0; k < layers; k++) {
        const double inset = 0.06 * (double)q->size_m[0] * record_random(q->id, (uint32_t)(8 + k));
        const double z0 = s->p[2] + k * high_m / layers - (k == 0 ? foot_m : 0);
        cell_box(cell, slot, s->p, s->along, 0.5 * (double)q->size_m[0] - inset,
                 0.5 * (double)q->size_m[1] - 0.3 * inset, z0, s->p[2] + (k + 1) * high_m / layers);
    }
}

/* Round and tapered, hollow at its mouth. */
static void chimney(CellMesh *cell, const CulturePoint *q, const Spot *s)
{
    static const char *const of[3] = {"brick_red", "concrete", "brick_brown"};
    const bool               used = record_random(q->id, 2) < 0.5;
    const int                slot = cell_part(cell, "chimney", one_of(of, 3, q->id), used ? HEAT_FLUE : HEAT_PASSIVE);
    const double             z = s->p[2], top = z + (double)q->size_m[2], deep_m = fmin(2, 0.2 * (double)q->size_m[2]);
    const double             half[2] = {0.5 * (double)q->size_m[0], 0.5 * (double)q->size_m[1]};
    const double             rz[6][2] = {{0, z - foot_m}, {1, z - foot_m},     {0.65, top},
                                         {0.5, top},      {0.5, top - deep_m}, {0, top - deep_m}};
    cell_round(cell, slot, s->p, half, (double)q->heading_rad, rz, 6, 16);
}

void point_make(CellMesh *cell, const CulturePoint *q, const double origin[3])
{
    const Spot   s = {{q->x_m - origin[0], q->y_m - origin[1], (double)q->base_m - origin[2]},
                      {sin((double)q->heading_rad), cos((double)q->heading_rad)}};
    const double high_m = q->size_m[2], half_m = 0.25 * ((double)q->size_m[0] + (double)q->size_m[1]);
    cell_begin(cell, q->id);
    switch ((CulturePointKind)q->kind) {
    case CULTURE_POLE:
        cell_pole(cell, cell_part(cell, "post", "timber_stained", HEAT_PASSIVE), s.p, high_m, fmin(half_m, 0.12));
        break;
    case CULTURE_LAMP:
        lamp(cell, q, &s);
        break;
    case CULTURE_SIGN:
        sign(cell, q, &s);
        break;
    case CULTURE_TANK:
        tank(cell, q, &s, false);
        break;
    case CULTURE_SILO:
        tank(cell, q, &s, true);
        break;
    case CULTURE_CONTAINER:
        container(cell, q, &s);
        break;
    case CULTURE_HEAP:
        heap(cell, q, &s);
        break;
    case CULTURE_STACK:
        stack(cell, q, &s);
        break;
    case CULTURE_CHIMNEY:
        chimney(cell, q, &s);
        break;
    case CULTURE_MAST:
        cell_lattice(cell, cell_part(cell, "post", "metal_steel_galvanized", HEAT_PASSIVE), s.p, s.along, high_m,
                     half_m, 0.5 * half_m);
        break;
    case CULTURE_POINT_KINDS:
        break;
    }
    cell_end(cell);
}
