/* render/scattering/clutter/clutter.c: draws the scatterers of the ground's cells, sees them from an antenna, and
 * keeps them. */
#include "render/scattering/clutter/clutter.h"

#include <assert.h>
#include <pthread.h>
#include <stdlib.h>

static const uint32_t speckle_stream = 0x434c5500, place_stream = 0x434c5520, texture_stream = 0x434c5540,
                      leaf_stream = 0x434c5560;

/* ---- cells -------------------------------------------------------------------------------------------- */

/* Returns the index of the first cell whose centre is at or beyond x. */
static int64_t first_from(double x_m, double side_m)
{
    assert(fabs(x_m) <= side_m * 0x1p30);
    return (int64_t)ceil(x_m / side_m - 0.5);
}

size_t clutter_cells(ClutterCell *out, size_t capacity, const ClutterGrid *grid, int level, const double low_m[2],
                     const double high_m[2])
{
    const double  side_m = clutter_side(grid, level);
    const int64_t x0 = first_from(low_m[0], side_m), x1 = first_from(high_m[0], side_m);
    const int64_t y0 = first_from(low_m[1], side_m), y1 = first_from(high_m[1], side_m);
    size_t        count = 0;
    for (int64_t y = y0; y < y1; y++)
        for (int64_t x = x0; x < x1; x++, count++)
            if (count < capacity) out[count] = (ClutterCell){(int32_t)x, (int32_t)y, level};
    return count;
}

typedef struct Split {
    ClutterCell       *out;
    size_t             capacity, count;
    const ClutterGrid *grid;
    const double      *low_m, *high_m, *from_m;
    double             share;
} Split;

static double outside(double x, double low, double high) { return x < low ? low - x : x > high ? x - high : 0; }

/* Whether a cell of this side is small enough for all places of a square. */
static bool suits(const Split *s, double side_m, double west_m, double south_m, double width_m)
{
    const double x_m = outside(s->from_m[0], west_m, west_m + width_m);
    const double y_m = outside(s->from_m[1], south_m, south_m + width_m);
    return side_m * side_m <= s->share * s->share * (x_m * x_m + y_m * y_m);
}

static void take(Split *s, ClutterCell cell)
{
    double centre_m[2];
    clutter_centre(centre_m, s->grid, &cell);
    for (int a = 0; a < 2; a++)
        if (!(centre_m[a] >= s->low_m[a] && centre_m[a] < s->high_m[a])) return;
    if (s->count < s->capacity) s->out[s->count] = cell;
    s->count++;
}

static void split(Split *s, ClutterCell cell)
{
    const double side_m = clutter_side(s->grid, cell.level);
    const double west_m = cell.x * side_m, south_m = cell.y * side_m;
    /* its descendants' centres are inside it */
    if (west_m >= s->high_m[0] || south_m >= s->high_m[1] || west_m + side_m <= s->low_m[0] ||
        south_m + side_m <= s->low_m[1])
        return;
    if (cell.level == 0 || suits(s, side_m, west_m, south_m, side_m)) {
        take(s, cell);
        return;
    }
    const bool last = cell.level == 1 || suits(s, 0.5 * side_m, west_m, south_m, side_m); /* no quarter is divided */
    for (int k = 0; k < 4; k++) {
        const ClutterCell quarter = {2 * cell.x + k % 2, 2 * cell.y + k / 2, cell.level - 1};
        if (last) take(s, quarter);
        else split(s, quarter);
    }
}

size_t clutter_cells_at(ClutterCell *out, size_t capacity, const ClutterGrid *grid, const double low_m[2],
                        const double high_m[2], const double from_m[2], double share)
{
    Split        s = {out, capacity, 0, grid, low_m, high_m, from_m, share};
    const int    last = clutter_levels - 1;
    const double side_m = clutter_side(grid, last);
    for (int a = 0; a < 2; a++)
        assert(fabs(low_m[a]) <= grid->side_m * 0x1p30 && fabs(high_m[a]) <= grid->side_m * 0x1p30);
    for (double y = floor(low_m[1] / side_m); y * side_m < high_m[1]; y++)
        for (double x = floor(low_m[0] / side_m); x * side_m < high_m[0]; x++)
            split(&s, (ClutterCell){(int32_t)x, (int32_t)y, last});
    return s.count;
}

void clutter_centre(double p_m[2], const ClutterGrid *grid, const ClutterCell *cell)
{
    const double side_m = clutter_side(grid, cell->level);
    p_m[0] = (cell->x + 0.5) * side_m;
    p_m[1] = (cell->y + 0.5) * side_m;
}

/* Index of a cell's numbers: its column above, the number's own place below; its row is the frame. */
static uint64_t first_index(const ClutterCell *cell) { return (uint64_t)(uint32_t)cell->x << 32; }

void clutter_place(double p_m[2], const ClutterGrid *grid, const ClutterCell *cell)
{
    const double side_m = clutter_side(grid, cell->level);
    for (uint32_t a = 0; a < 2; a++)
        p_m[a] = ((a == 0 ? cell->x : cell->y) + random_uniform(grid->seed, place_stream + (uint32_t)cell->level,
                                                                (uint32_t)cell->y, first_index(cell) + a)) *
                 side_m;
}

/* ---- texture -------------------------------------------------------------------------------------------- */

/* Value at a place of a standard normal field. It is the sum of the values at four by four nodes of a lattice, with
 * Gaussian weights whose squares sum to 1, so that each value is exactly normal and the gamma distribution of the
 * texture exact. A node comes and goes with a weight of 3e-4. The correlation is nearly exp(-(distance / length)^2),
 * and 0 from four lengths on. */
static double deviate_at(uint64_t seed, double length_m, const double p_m[2])
{
    enum { nodes = 4 };
    double weight[2][nodes], first[2];
    for (int a = 0; a < 2; a++) {
        const double at = p_m[a] / length_m;
        double       square = 0;
        first[a] = floor(at) - 1;
        for (int k = 0; k < nodes; k++) {
            const double away = at - (first[a] + k);
            weight[a][k] = exp(-2 * away * away);
            square += weight[a][k] * weight[a][k];
        }
        for (int k = 0; k < nodes; k++) weight[a][k] /= sqrt(square);
    }
    /* columns count from 2^31, so that those of a row follow one another */
    const uint64_t column = (uint64_t)(int64_t)first[0] + 0x80000000u;
    double         sum = 0;
    for (int y = 0; y < nodes; y++) {
        double normal[nodes], row = 0;
        random_normals(normal, nodes, seed, texture_stream, (uint32_t)(int64_t)(first[1] + y), column);
        for (int x = 0; x < nodes; x++) row += weight[0][x] * normal[x];
        sum += weight[1][y] * row;
    }
    return sum;
}

/* Scale of a cell's deviations. All of a cell has the texture of one place in it, so means over many cells would vary
 * more than those of the field: by (1 - V^2) / count, where V^2 is the share of its variance that the mean of a cell
 * keeps. Scaled, they vary alike. The scale is 1 for cells much smaller than the texture, and 0.96, 0.75, 0.43 for
 * cells of 1, 2, 4 of its lengths. */
static double level_share(double side_m, double length_m)
{
    const double a = side_m / length_m, field = pi_rad / (a * a);
    /* kept: the mean of exp(-d^2) over a square; a series replaces its closed form where that cancels */
    const double kept = a < 1e-2 ? 1 - a * a / 6 : (sqrt(pi_rad) * a * erf(a) + expm1(-a * a)) / (a * a);
    return sqrt(field / (field + 1 - kept * kept));
}

double clutter_texture_at(const ClutterGrid *grid, const ClutterRow *row, int level, const double p_m[2])
{
    if (isinf(row->nu)) return 1;
    const double share = level_share(clutter_side(grid, level), row->texture_m);
    return 1 + share * (clutter_texture(row, deviate_at(grid->seed, row->texture_m, p_m)) - 1);
}

/* ---- scatterers ------------------------------------------------------------------------------------------- */

enum {
    still = clutter_still_terms,
    moving = clutter_terms - still,
    of_term = 9,
    of_velocity = 4,
    normals = clutter_terms * of_term + moving * of_velocity
};

/* Draws a scatterer from n standard normal values. texture: the mean power over all draws. */
static void draw_from(ClutterScatterer *out, const ClutterRow *row, const double normal[normals], double texture)
{
    const double power = 0.5 * texture;
    const double unlike = sqrt(1 - row->rho * row->rho), hh = sqrt(row->hh), hv = sqrt(row->hv);
    for (int m = 0; m < clutter_terms; m++) {
        const double *n = normal + of_term * m, size = sqrt(power / (m < still ? still : moving));
        for (int c = 0; c < 2; c++) {
            out->vv[m][c] = (float)(size * n[c]);
            out->hh[m][c] = (float)(size * hh * (row->rho * n[c] + unlike * n[2 + c]));
            out->hv[m][c] = (float)(size * hv * n[4 + c]);
        }
        for (int a = 0; a < 3; a++) out->offset_m[m][a] = (float)(row->extent_m * n[6 + a]);
    }
    for (int m = 0; m < moving; m++) {
        const double *n = normal + of_term * clutter_terms + of_velocity * m;
        out->velocity[m] = (float)(n[0] * n[1] + n[2] * n[3]); /* two-sided exponential of spread 1, exactly */
    }
}

static void draw(ClutterScatterer *out, const ClutterGrid *grid, const ClutterRow *row, const ClutterCell *cell)
{
    double normal[normals], p_m[2];
    clutter_place(p_m, grid, cell);
    random_normals(normal, normals, grid->seed, speckle_stream + (uint32_t)cell->level, (uint32_t)cell->y,
                   first_index(cell));
    draw_from(out, row, normal, clutter_texture_at(grid, row, cell->level, p_m));
}

void clutter_draw_leaf(ClutterScatterer *out, const ClutterRow *row, uint64_t seed, uint32_t crown, uint32_t number)
{
    double normal[normals];
    random_normals(normal, normals, seed, leaf_stream, crown, (uint64_t)number * normals);
    draw_from(out, row, normal, 1);
}

void clutter_draw(ClutterScatterer *out, const ClutterGrid *grid, const ClutterTable *table, ClutterBand band,
                  int count, const ClutterCell *cell, const uint8_t *surface)
{
    for (int i = 0; i < count; i++) draw(&out[i], grid, &table->row[surface[i]][band], &cell[i]);
}

/* Multiplies z by re + i im, without the tests for infinity of a complex product. */
static inline double complex turned(const float z[2], double re, double im)
{
    return CMPLX((double)z[0] * re - (double)z[1] * im, (double)z[0] * im + (double)z[1] * re);
}

/* Adds the terms first .. end - 1 of a scatterer, seen from direction u, to s. k2: twice the wave number, rad/m;
 * moved_m: how far those that move have moved; size: the amplitude of each. */
static void add_terms(ScatterMatrix *s, const ClutterScatterer *from, int first, int end, const double u[3], double k2,
                      double moved_m, double size)
{
    for (int m = first; m < end; m++) {
        const float *offset_m = from->offset_m[m];
        const double gone_m = m < clutter_still_terms ? 0 : moved_m * (double)from->velocity[m - clutter_still_terms];
        const double towards_m =
            u[0] * (double)offset_m[0] + u[1] * (double)offset_m[1] + u[2] * (double)offset_m[2] + gone_m;
        const double re = size * cos(k2 * towards_m), im = size * sin(k2 * towards_m);
        s->vv += turned(from->vv[m], re, im);
        s->hh += turned(from->hh[m], re, im);
        s->hv += turned(from->hv[m], re, im);
    }
}

void clutter_see(ScatterMatrix *out, const ClutterGrid *grid, const ClutterTable *table,
                 const ClutterScatterer *scatterer, const ClutterGround *ground, const ClutterLook *look)
{
    const double  wavelength_m = light_mps / look->frequency_hz, k2 = 4 * pi_rad / wavelength_m;
    ClutterBand   band;
    ClutterMotion motion[SURFACE_COUNT];
    const bool    in_band = clutter_band_of(&band, look->frequency_hz);
    assert(in_band);
    if (!in_band) return;
    for (int s = 0; s < SURFACE_COUNT; s++)
        motion[s] = clutter_motion(&table->row[s][band], look->frequency_hz, look->wind_mps);

    for (int i = 0; i < ground->count; i++) {
        const ClutterMotion *moves = &motion[ground->surface[i]];
        const double n_enu[3] = {(double)ground->n_enu[0][i], (double)ground->n_enu[1][i], (double)ground->n_enu[2][i]};
        double       u[3];
        for (int a = 0; a < 3; a++) u[a] = look->antenna_enu[a] - ground->p_enu[a][i];
        out[i] = (ScatterMatrix){0};
        if (!v3_normalize(u, u)) continue;
        const double side_m = clutter_side(grid, ground->cell[i].level), sine = v3_dot(n_enu, u);
        if (!(sine > 0 && n_enu[2] > 0)) continue;
        const double sigma0 = clutter_sigma0(&table->row[ground->surface[i]][band], asin(fmin(sine, 1)), wavelength_m);
        const double size = sqrt(sigma0 * side_m * side_m / (4 * pi_rad * n_enu[2]));
        add_terms(&out[i], &scatterer[i], 0, clutter_still_terms, u, k2, 0, size * sqrt(moves->still));
        if (moves->still < 1)
            add_terms(&out[i], &scatterer[i], clutter_still_terms, clutter_terms, u, k2, moves->spread_mps * look->t_s,
                      size * sqrt(1 - moves->still));
        out[i].vh = out[i].hv;
    }
}

void clutter_see_leaf(ScatterMatrix *out, const ClutterScatterer *scatterer, const ClutterMotion *motion,
                      double sigma_m2, const double p_enu[3], const ClutterLook *look)
{
    const double k2 = 4 * pi_rad * look->frequency_hz / light_mps, size = sqrt(sigma_m2 / (4 * pi_rad));
    double       u[3];
    v3_sub(u, look->antenna_enu, p_enu);
    *out = (ScatterMatrix){0};
    if (!v3_normalize(u, u)) return;
    add_terms(out, scatterer, 0, clutter_still_terms, u, k2, 0, size * sqrt(motion->still));
    if (motion->still < 1)
        add_terms(out, scatterer, clutter_still_terms, clutter_terms, u, k2, motion->spread_mps * look->t_s,
                  size * sqrt(1 - motion->still));
    out->vh = out->hv;
}

/* ---- scatterers kept ---------------------------------------------------------------------------- */

enum { sets = 1 << 15, ways = 4, locks = 64 };

/* One way of a set. */
typedef struct Entry {
    ClutterCell      cell;
    uint8_t          surface;
    bool             used;
    ClutterScatterer scatterer;
} Entry;

struct ClutterCache {
    Entry (*set)[ways];
    uint8_t        *next;        /* [sets]: the way that is given up next */
    pthread_mutex_t lock[locks]; /* of set % locks */
};

Status clutter_cache_create(ClutterCache **out)
{
    ClutterCache *c = calloc(1, sizeof *c);
    if (!c) return STATUS_NO_MEMORY;
    for (int i = 0; i < locks; i++) pthread_mutex_init(&c->lock[i], NULL);
    c->set = calloc(sets, sizeof *c->set);
    c->next = calloc(sets, sizeof *c->next);
    if (!c->set || !c->next) {
        clutter_cache_destroy(c);
        return STATUS_NO_MEMORY;
    }
    *out = c;
    return STATUS_OK;
}

void clutter_cache_destroy(ClutterCache *c)
{
    if (!c) return;
    for (int i = 0; i < locks; i++) pthread_mutex_destroy(&c->lock[i]);
    free(c->set);
    free(c->next);
    free(c);
}

/* Neighbours are in different sets: a field of 256 x 128 cells of a level fills all of them once. */
static int set_of(const ClutterCell *cell)
{
    const uint32_t x = (uint32_t)cell->x, y = (uint32_t)cell->y, level = (uint32_t)cell->level;
    return (int)(((x & 255) | (y & 127) << 8) ^ (x >> 8) * 0x9E5u ^ (y >> 7) * 0x6A7Bu ^ level * 0x3D1Fu) & (sets - 1);
}

static bool find(ClutterScatterer *out, ClutterCache *c, const ClutterCell *cell, uint8_t surface)
{
    const int set = set_of(cell), lock = set % locks;
    bool      found = false;
    pthread_mutex_lock(&c->lock[lock]);
    for (int w = 0; w < ways && !found; w++) {
        const Entry *e = &c->set[set][w];
        found = e->used && e->surface == surface && e->cell.x == cell->x && e->cell.y == cell->y &&
                e->cell.level == cell->level;
        if (found) *out = e->scatterer;
    }
    pthread_mutex_unlock(&c->lock[lock]);
    return found;
}

static void keep(ClutterCache *c, const ClutterScatterer *scatterer, const ClutterCell *cell, uint8_t surface)
{
    const int set = set_of(cell), lock = set % locks;
    pthread_mutex_lock(&c->lock[lock]);
    c->set[set][c->next[set]] = (Entry){*cell, surface, true, *scatterer};
    c->next[set] = (uint8_t)((c->next[set] + 1) % ways);
    pthread_mutex_unlock(&c->lock[lock]);
}

void clutter_cache_draw(ClutterScatterer *out, ClutterCache *cache, const ClutterKind *kind, int count,
                        const ClutterCell *cell, const uint8_t *surface)
{
    if (!cache) {
        clutter_draw(out, kind->grid, kind->table, kind->band, count, cell, surface);
        return;
    }
    for (int i = 0; i < count; i++) {
        if (find(&out[i], cache, &cell[i], surface[i])) continue;
        clutter_draw(&out[i], kind->grid, kind->table, kind->band, 1, &cell[i], &surface[i]);
        keep(cache, &out[i], &cell[i], surface[i]);
    }
}
