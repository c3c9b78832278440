/* terrain/bare_earth/take_apart_fill.c: gaps of the ground filled over a pyramid of blocks, coarse to fine. */
#include "terrain/bare_earth/take_apart_private.h"

#include <stdlib.h>

enum { max_levels = 16 };

typedef struct Level {
    int    nx, ny;
    float *value; /* NAN: not known */
    bool  *given; /* a cell with values below it, which stays as it is */
} Level;

static float mean_of_known(const Level *l, int x, int y)
{
    float sum = 0, count = 0;
    for (int j = y - 1; j <= y + 1; j++)
        for (int i = x - 1; i <= x + 1; i++) {
            if (i < 0 || j < 0 || i >= l->nx || j >= l->ny) continue;
            const float v = l->value[(size_t)j * (size_t)l->nx + (size_t)i];
            if (isnan(v)) continue;
            const float weight = i == x || j == y ? 2 : 1;
            sum += weight * v, count += weight;
        }
    return count > 0 ? sum / count : NAN;
}

/* Gives cells next to known ones a value. */
static void grow(const Level *l, float *next)
{
    const size_t n = (size_t)l->nx * (size_t)l->ny;
    for (int y = 0; y < l->ny; y++)
        for (int x = 0; x < l->nx; x++) {
            const size_t c = (size_t)y * (size_t)l->nx + (size_t)x;
            next[c] = isnan(l->value[c]) ? mean_of_known(l, x, y) : l->value[c];
        }
    memcpy(l->value, next, n * sizeof *next);
}

/* One Jacobi step of Laplace's equation on the cells that are not given. */
static void relax(const Level *l, float *next)
{
    const int nx = l->nx, ny = l->ny;
    for (int y = 0; y < ny; y++)
        for (int x = 0; x < nx; x++) {
            const size_t c = (size_t)y * (size_t)nx + (size_t)x;
            const float *v = l->value + c;
            next[c] = *v;
            if (l->given[c] || isnan(*v)) continue;
            float sum = 0, count = 0;
            if (x > 0 && !isnan(v[-1])) sum += v[-1], count++;
            if (x < nx - 1 && !isnan(v[1])) sum += v[1], count++;
            if (y > 0 && !isnan(v[-nx])) sum += v[-nx], count++;
            if (y < ny - 1 && !isnan(v[nx])) sum += v[nx], count++;
            if (count > 0) next[c] = sum / count;
        }
    memcpy(l->value, next, (size_t)nx * (size_t)ny * sizeof *next);
}

/* Fills from the coarser level, linear between its centres: weights 9 3 3 1. */
static void refine(const Level *fine, const Level *coarse)
{
    for (int y = 0; y < fine->ny; y++)
        for (int x = 0; x < fine->nx; x++) {
            float *v = fine->value + (size_t)y * (size_t)fine->nx + (size_t)x;
            if (!isnan(*v)) continue;
            const int   i0 = x / 2, j0 = y / 2, i1 = i0 + (x % 2 ? 1 : -1), j1 = j0 + (y % 2 ? 1 : -1);
            const float weight[4] = {9, 3, 3, 1};
            const int   at[4][2] = {{i0, j0}, {i1, j0}, {i0, j1}, {i1, j1}};
            float       sum = 0, count = 0;
            for (int k = 0; k < 4; k++) {
                if (at[k][0] < 0 || at[k][1] < 0 || at[k][0] >= coarse->nx || at[k][1] >= coarse->ny) continue;
                const float u = coarse->value[(size_t)at[k][1] * (size_t)coarse->nx + (size_t)at[k][0]];
                if (!isnan(u)) sum += weight[k] * u, count += weight[k];
            }
            if (count > 0) *v = sum / count;
        }
}

/* Computes the coarser level as means of 2 x 2. */
static void coarsen(const Level *coarse, const Level *fine)
{
    for (int y = 0; y < coarse->ny; y++)
        for (int x = 0; x < coarse->nx; x++) {
            float sum = 0, count = 0;
            for (int k = 0; k < 4; k++) {
                const int i = 2 * x + k % 2, j = 2 * y + k / 2;
                if (i >= fine->nx || j >= fine->ny) continue;
                const float v = fine->value[(size_t)j * (size_t)fine->nx + (size_t)i];
                if (!isnan(v)) sum += v, count++;
            }
            const size_t c = (size_t)y * (size_t)coarse->nx + (size_t)x;
            coarse->value[c] = count > 0 ? sum / count : NAN;
            coarse->given[c] = count > 0;
        }
}

/* Fills over levels up to a coarsest one. near: with relaxation, which makes the filling harmonic. */
static Status fill(float *value, const Blocks *blocks, double coarsest_m, bool near)
{
    Level        level[max_levels] = {{.nx = blocks->nx, .ny = blocks->ny, .value = value}};
    int          levels = 1;
    const size_t all = (size_t)blocks->nx * (size_t)blocks->ny;
    size_t       total = all;
    for (double side_m = blocks->block_m; side_m < coarsest_m && levels < max_levels; side_m *= 2, levels++) {
        Level *l = level + levels;
        l->nx = (level[levels - 1].nx + 1) / 2, l->ny = (level[levels - 1].ny + 1) / 2;
        total += (size_t)l->nx * (size_t)l->ny;
    }
    float *space = malloc(total * sizeof *space); /* the coarser levels, then one level's next */
    bool  *given = malloc(total * sizeof *given);
    if (!space || !given) {
        free(space), free(given);
        return STATUS_NO_MEMORY;
    }
    float *next = space + (total - all), *free_value = space;
    bool  *free_given = given;
    for (int k = 0; k < levels; k++) {
        const size_t n = (size_t)level[k].nx * (size_t)level[k].ny;
        level[k].given = free_given, free_given += n;
        if (k > 0) level[k].value = free_value, free_value += n;
        if (k == 0)
            for (size_t c = 0; c < n; c++) given[c] = !isnan(value[c]);
        if (k > 0) coarsen(&level[k], &level[k - 1]);
    }

    /* relaxation steps of each level; three reach the middle of a roof 100 m wide */
    static const int relaxations[] = {4, 3, 2, 2};
    for (int k = 0; near && k < 3; k++) grow(&level[levels - 1], next);
    for (int k = levels - 1; k >= 0; k--) {
        if (k < levels - 1) refine(&level[k], &level[k + 1]);
        for (int n = 0; near && n < relaxations[k < 3 ? k : 3]; n++) relax(&level[k], next);
    }
    free(space), free(given);
    return STATUS_OK;
}

Status take_apart_fill(float *value, const Blocks *blocks)
{
    Status status = fill(value, blocks, 12, true);
    /* what is left lies far from any ground, within voids: it depends on the window */
    if (status == STATUS_OK) status = fill(value, blocks, 65536, false);
    return status;
}
