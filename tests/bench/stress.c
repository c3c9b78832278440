/* tests/bench/stress.c: rows of stress cases; random numbers and models for them. */
#include "tests/bench/stress.h"

#include <stdlib.h>

void stress_cases(Bench *bench, const StressCase *cases, int count, void *user)
{
    for (int k = 0; k < count; k++) {
        const StressCase *c = &cases[k];
        bench_progress(bench, c->what);
        const double start_s = wall_clock_s();
        BenchRow     row = bench_row(c->what);
        row.error = c->figure(user, bench_quick(bench));
        row.median = row.best = wall_clock_s() - start_s;
        row.unit = "s";
        row.error_limit = c->limit;
        row.error_unit = c->unit;
        row.against = c->against;
        bench_add(bench, &row);
    }
}

/* ---- numbers ---------------------------------------------------------------------------------- */

double stress_uniform(Dice *dice, double low, double high)
{
    return low + (high - low) * random_uniform(1995, dice->stream, 0, dice->index++);
}

double stress_log_uniform(Dice *dice, double low, double high)
{
    return exp(stress_uniform(dice, log(low), log(high)));
}

void stress_direction(double d[3], Dice *dice)
{
    do
        for (int c = 0; c < 3; c++) d[c] = stress_uniform(dice, -1, 1);
    while (!(v3_length(d) < 1 && v3_normalize(d, d)));
}

void stress_any_rotation(double r[9], Dice *dice)
{
    double x[3], y[3], z[3];
    stress_direction(x, dice);
    do stress_direction(y, dice);
    while (!(fabs(v3_dot(x, y)) < 0.9));
    v3_cross(z, x, y);
    v3_normalize(z, z);
    v3_cross(y, z, x);
    for (int c = 0; c < 3; c++) r[3 * c] = x[c], r[3 * c + 1] = y[c], r[3 * c + 2] = z[c];
}

void stress_off_rotation(double *worst, const double r[9])
{
    double product[9], cross[3];
    m3_tmul(product, r, r);
    v3_cross(cross, r, r + 3);
    for (int k = 0; k < 9; k++) bench_worse(worst, product[k] - (k % 4 == 0));
    for (int k = 0; k < 3; k++) bench_worse(worst, cross[k] - r[6 + k]);
}

/* ---- models ----------------------------------------------------------------------------------- */

Status stress_model(Model *m, int vertices, int triangles)
{
    *m = (Model){.name = "stress", .node_count = 1, .part_count = 1};
    m->node = calloc(1, sizeof *m->node);
    m->part = calloc(1, sizeof *m->part);
    m->vertex = calloc((size_t)vertices, sizeof *m->vertex);
    m->normal = calloc((size_t)vertices, sizeof *m->normal);
    m->triangle = calloc((size_t)triangles, sizeof *m->triangle);
    m->triangle_part = calloc((size_t)triangles, sizeof *m->triangle_part);
    if (!m->node || !m->part || !m->vertex || !m->normal || !m->triangle || !m->triangle_part) {
        stress_model_free(m);
        return STATUS_NO_MEMORY;
    }
    m->node[0].parent = -1;
    m3_identity(m->node[0].r_parent_from_node);
    return STATUS_OK;
}

void stress_model_free(Model *m)
{
    free(m->node);
    free(m->part);
    free(m->vertex);
    free(m->normal);
    free(m->triangle);
    free(m->triangle_part);
    *m = (Model){0};
}

static int add_vertex(Model *m, double x, double y, double z)
{
    double n[3] = {x, y, z};
    m->vertex[m->vertex_count][0] = x, m->vertex[m->vertex_count][1] = y, m->vertex[m->vertex_count][2] = z;
    if (!v3_normalize(n, n)) n[0] = 1;
    for (int c = 0; c < 3; c++) m->normal[m->vertex_count][c] = (float)n[c];
    return m->vertex_count++;
}

static void join(Model *m, int a, int b, int c)
{
    uint32_t *t = m->triangle[m->triangle_count++];
    t[0] = (uint32_t)a, t[1] = (uint32_t)b, t[2] = (uint32_t)c;
    m->part[0].triangle_count++;
}

void stress_triangle(Model *m, const double a[3], const double b[3], const double c[3])
{
    const int first = add_vertex(m, a[0], a[1], a[2]);
    add_vertex(m, b[0], b[1], b[2]);
    add_vertex(m, c[0], c[1], c[2]);
    join(m, first, first + 1, first + 2);
}

void stress_box(Model *m, const double low[3], const double high[3])
{
    static const int face[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    const int        first = m->vertex_count;
    for (int v = 0; v < 8; v++)
        add_vertex(m, v & 1 ? high[0] : low[0], v & 2 ? high[1] : low[1], v & 4 ? high[2] : low[2]);
    for (int f = 0; f < 6; f++) {
        join(m, first + face[f][0], first + face[f][1], first + face[f][2]);
        join(m, first + face[f][0], first + face[f][2], first + face[f][3]);
    }
}

void stress_sphere(Model *m, double radius_m, int bands)
{
    const int around = 2 * bands, first = m->vertex_count, last = first + 2 + (bands - 2) * around;
    add_vertex(m, 0, 0, -radius_m);
    add_vertex(m, 0, 0, radius_m);
    for (int b = 1; b < bands; b++)
        for (int a = 0; a < around; a++) {
            const double polar = pi_rad * b / bands, azimuth = 2 * pi_rad * a / around,
                         across_m = radius_m * sin(polar);
            add_vertex(m, across_m * cos(azimuth), across_m * sin(azimuth), -radius_m * cos(polar));
        }
    for (int a = 0; a < around; a++) {
        const int next = (a + 1) % around;
        join(m, first, first + 2 + next, first + 2 + a);
        join(m, first + 1, last + a, last + next);
        for (int b = 0; b + 2 < bands; b++) {
            const int p = first + 2 + b * around;
            join(m, p + a, p + next, p + around + next);
            join(m, p + a, p + around + next, p + around + a);
        }
    }
}
