/* terrain/invented/field.c: smooth height fields as uniform cubic B-splines.
 *
 * A spline on control points L apart is also one on points L/2 apart (knot insertion), so the landscape is
 * made from the horizon inwards: refine, add hills of that wavelength, pull the fixes in at that wavelength,
 * cut to the window that is still wanted, and again. Each octave costs four times the one before, so all of
 * them cost little more than the last. Pulling is multilevel B-spline approximation (Lee, Wolberg and Shin,
 * IEEE Trans. Visualization and Computer Graphics 3(3), 1997, equations 3 to 5). */
#include "terrain/invented/invented_private.h"

#include <stdlib.h>

static int half_down(int i) { return i >= 0 ? i / 2 : -((1 - i) / 2); }

/* Rows refined west to east: even points take (1 6 1) / 8 of their neighbours, odd ones (1 1) / 2. */
static void refine_row(float *restrict out, int i0, int nx, const float *restrict c, int c_i0)
{
    int n = 0;
    if (i0 & 1) {
        const float *p = c + half_down(i0) - c_i0;
        out[n++] = 0.5f * (p[0] + p[1]);
    }
    const float *p = c + half_down(i0 + n) - c_i0;
    const int    pairs = (nx - n) / 2;
    for (int k = 0; k < pairs; k++) {
        out[n + 2 * k] = 0.125f * (p[k - 1] + 6 * p[k] + p[k + 1]);
        out[n + 2 * k + 1] = 0.5f * (p[k] + p[k + 1]);
    }
    n += 2 * pairs;
    if (n < nx) out[n] = 0.125f * (p[pairs - 1] + 6 * p[pairs] + p[pairs + 1]);
}

static void mix_rows_161(float *restrict out, int n, const float *restrict a, const float *restrict b,
                         const float *restrict c)
{
    for (int i = 0; i < n; i++) out[i] = 0.125f * (a[i] + 6 * b[i] + c[i]);
}

static void mix_rows_11(float *restrict out, int n, const float *restrict a, const float *restrict b)
{
    for (int i = 0; i < n; i++) out[i] = 0.5f * (a[i] + b[i]);
}

Status field_refine(Field *out, const Field *coarse, int i0, int j0, int nx, int ny)
{
    Field  fine, rows;
    Status status = levels_field_create(&fine, coarse->spacing_m / 2, i0, j0, nx, ny);
    if (status != STATUS_OK) return status;
    const int row0 = half_down(j0) - 1, row1 = half_down(j0 + ny - 1) + 1;
    status = levels_field_create(&rows, coarse->spacing_m, i0, row0, nx, row1 - row0 + 1);
    if (status != STATUS_OK) {
        levels_field_destroy(&fine);
        return status;
    }

    for (int j = row0; j <= row1; j++)
        refine_row(rows.v + (size_t)(j - row0) * nx, i0, nx, coarse->v + (size_t)(j - coarse->j0) * coarse->nx,
                   coarse->i0);
    for (int j = j0; j < j0 + ny; j++) {
        const float *b = rows.v + (size_t)(half_down(j) - row0) * nx;
        float       *to = fine.v + (size_t)(j - j0) * nx;
        if (j & 1) mix_rows_11(to, nx, b, b + nx);
        else mix_rows_161(to, nx, b - nx, b, b + nx);
    }
    levels_field_destroy(&rows);
    *out = fine;
    return STATUS_OK;
}

static void knot_row(float *restrict out, int n, const float *restrict south, const float *restrict mid,
                     const float *restrict north)
{
    const float w = 1.0f / 36;
    for (int i = 0; i < n; i++) {
        const float corners = south[i - 1] + south[i + 1] + north[i - 1] + north[i + 1];
        const float sides = south[i] + north[i] + mid[i - 1] + mid[i + 1];
        out[i] = w * (corners + 4 * sides + 16 * mid[i]);
    }
}

Status field_posts(Field *out, const Field *spline, int i0, int j0, int nx, int ny)
{
    Field        posts;
    const Status status = levels_field_create(&posts, spline->spacing_m, i0, j0, nx, ny);
    if (status != STATUS_OK) return status;
    for (int j = 0; j < ny; j++) {
        const float *mid = spline->v + (size_t)(j0 + j - spline->j0) * spline->nx + (i0 - spline->i0);
        knot_row(posts.v + (size_t)j * nx, nx, mid - spline->nx, mid, mid + spline->nx);
    }
    *out = posts;
    return STATUS_OK;
}

/* Sets the first of the four control points that x depends on, and their weights. Returns false outside of the window.
 * */
static bool spline_weights(double w[4], int *first, double x_m, double spacing_m, int i0, int nx)
{
    const double f = x_m / spacing_m, cell = floor(f), t = f - cell;
    if (!(cell - 1 >= i0 && cell + 2 <= i0 + nx - 1)) return false;
    *first = (int)cell - 1 - i0;
    w[0] = (1 - t) * (1 - t) * (1 - t) / 6;
    w[1] = (3 * t * t * t - 6 * t * t + 4) / 6;
    w[2] = (-3 * t * t * t + 3 * t * t + 3 * t + 1) / 6;
    w[3] = t * t * t / 6;
    return true;
}

/* Value of a spline; NaN outside of its window. */
static double field_spline_at(const Field *spline, double x_m, double y_m)
{
    double wx[4], wy[4], sum = 0;
    int    i, j;
    if (!spline_weights(wx, &i, x_m, spline->spacing_m, spline->i0, spline->nx)) return NAN;
    if (!spline_weights(wy, &j, y_m, spline->spacing_m, spline->j0, spline->ny)) return NAN;
    for (int b = 0; b < 4; b++) {
        const float *c = spline->v + (size_t)(j + b) * spline->nx + i;
        sum += wy[b] * (wx[0] * c[0] + wx[1] * c[1] + wx[2] * c[2] + wx[3] * c[3]);
    }
    return sum;
}

/* Bilinear value of a field, held at its edges. */
static double field_bilinear(const Field *field, double x_m, double y_m)
{
    const double fx = clamp(x_m / field->spacing_m - field->i0, 0, field->nx - 1);
    const double fy = clamp(y_m / field->spacing_m - field->j0, 0, field->ny - 1);
    const int    i = fx < field->nx - 1 ? (int)fx : field->nx - 2, j = fy < field->ny - 1 ? (int)fy : field->ny - 2;
    const double u = fx - i, v = fy - j;
    const float *s = field->v + (size_t)j * field->nx + i, *n = s + field->nx;
    return (1 - v) * ((1 - u) * s[0] + u * s[1]) + v * ((1 - u) * n[0] + u * n[1]);
}

/* Independent control points of deviation s give a spline of rms 0.479 s: the mean over a cell of the sum of
 * squared weights is 151/315 along each axis. */
void field_add_hills(Field *spline, uint64_t seed, double rms_m, const Calm *calm)
{
    const double span_m = rms_m * (315.0 / 151.0) * sqrt(12.0); /* width of a uniform distribution of that deviation */
    if (!(rms_m > 0)) return;
    for (int j = 0; j < spline->ny; j++) {
        float *row = spline->v + (size_t)j * spline->nx;
        for (int i = 0; i < spline->nx; i++) {
            const double u = invented_unit(invented_hash(seed, spline->i0 + i, spline->j0 + j)) - 0.5;
            double       a = span_m * u;
            if (calm->factor.v)
                a *= field_bilinear(&calm->factor, (spline->i0 + i) * spline->spacing_m,
                                    (spline->j0 + j) * spline->spacing_m);
            row[i] += (float)a;
        }
    }
}

/* Adds the smoothest correction on these control points. A ceiling pulls only where the field is above it.
 * Sums are kept in two sparse arrays: calloc's untouched pages cost nothing. */
Status field_pull(Field *spline, const FieldAim *aim, int count)
{
    if (!count) return STATUS_OK;
    const size_t points = (size_t)spline->nx * spline->ny;
    float       *num = calloc(points, sizeof *num), *den = calloc(points, sizeof *den);
    if (!num || !den) {
        free(num);
        free(den);
        return STATUS_NO_MEMORY;
    }

    /* pass 0 sums at control points, pass 1 applies each sum once */
    for (int n = 0; n < count; n++) {
        double wx[4], wy[4];
        int    i, j;
        if (!spline_weights(wx, &i, aim[n].x_m, spline->spacing_m, spline->i0, spline->nx)) continue;
        if (!spline_weights(wy, &j, aim[n].y_m, spline->spacing_m, spline->j0, spline->ny)) continue;
        const double off_m = aim[n].h_m - field_spline_at(spline, aim[n].x_m, aim[n].y_m);
        if (aim[n].ceiling && !(off_m < 0)) continue;

        double sum_x = 0, sum_y = 0;
        for (int k = 0; k < 4; k++) {
            sum_x += wx[k] * wx[k];
            sum_y += wy[k] * wy[k];
        }
        for (int b = 0; b < 4; b++)
            for (int a = 0; a < 4; a++) {
                const size_t at = (size_t)(j + b) * spline->nx + i + a;
                const double w = wx[a] * wy[b];
                num[at] += (float)(w * w * (w * off_m / (sum_x * sum_y)));
                den[at] += (float)(w * w);
            }
    }
    for (int n = 0; n < count; n++) {
        double w[4];
        int    i, j;
        if (!spline_weights(w, &i, aim[n].x_m, spline->spacing_m, spline->i0, spline->nx)) continue;
        if (!spline_weights(w, &j, aim[n].y_m, spline->spacing_m, spline->j0, spline->ny)) continue;
        for (int b = 0; b < 4; b++)
            for (int a = 0; a < 4; a++) {
                const size_t at = (size_t)(j + b) * spline->nx + i + a;
                if (den[at] > 1e-12f) spline->v[at] += num[at] / den[at];
                den[at] = 0;
            }
    }
    free(num);
    free(den);
    return STATUS_OK;
}

/* Distance to the nearest fix by two chamfer sweeps (steps 1 and sqrt 2: 8 % long at worst, of no account
 * here), then a quarter of the relief at a fix and all of it 1500 m away. */
Status calm_create(Calm *out, const FixSet *fixes, double cell_m)
{
    static const double reach_m = 1500, least = 0.25;
    enum { most_cells = 512 };

    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int n = 0; n < fixes->count; n++) {
        const FixRow *row = &fixes->row[n];
        if (row->dropped) continue;
        low[0] = fmin(low[0], row->x_m);
        low[1] = fmin(low[1], row->y_m);
        high[0] = fmax(high[0], row->x_m);
        high[1] = fmax(high[1], row->y_m);
    }
    *out = (Calm){0};
    if (!(low[0] <= high[0])) return STATUS_OK;

    const double wide_m = fmax(high[0] - low[0], high[1] - low[1]) + 2 * reach_m;
    while (wide_m / cell_m > most_cells) cell_m *= 2;
    const int    i0 = (int)floor((low[0] - reach_m) / cell_m) - 1, i1 = (int)ceil((high[0] + reach_m) / cell_m) + 1;
    const int    j0 = (int)floor((low[1] - reach_m) / cell_m) - 1, j1 = (int)ceil((high[1] + reach_m) / cell_m) + 1;
    Field        d;
    const Status status = levels_field_create(&d, cell_m, i0, j0, i1 - i0 + 1, j1 - j0 + 1);
    if (status != STATUS_OK) return status;

    const int nx = d.nx, ny = d.ny;
    for (int n = 0; n < nx * ny; n++) d.v[n] = (float)(2 * reach_m);
    for (int n = 0; n < fixes->count; n++)
        if (!fixes->row[n].dropped) {
            const int i = (int)lround(fixes->row[n].x_m / cell_m) - i0,
                      j = (int)lround(fixes->row[n].y_m / cell_m) - j0;
            d.v[(size_t)j * nx + i] = 0;
        }
    const float side = (float)cell_m, slant = (float)(cell_m * sqrt(2.0));
    for (int j = 1; j < ny - 1; j++)
        for (int i = 1; i < nx - 1; i++) {
            float *p = d.v + (size_t)j * nx + i;
            *p = fminf(fminf(fminf(*p, p[-1] + side), p[-nx] + side), fminf(p[-nx - 1] + slant, p[-nx + 1] + slant));
        }
    for (int j = ny - 2; j > 0; j--)
        for (int i = nx - 2; i > 0; i--) {
            float *p = d.v + (size_t)j * nx + i;
            *p = fminf(fminf(fminf(*p, p[1] + side), p[nx] + side), fminf(p[nx + 1] + slant, p[nx - 1] + slant));
        }
    for (int n = 0; n < nx * ny; n++) d.v[n] = (float)(least + (1 - least) * smooth_step(0, reach_m, d.v[n]));
    out->factor = d;
    return STATUS_OK;
}

/* ---- correction of real ground ------------------------------------------------------------------ */

Status invented_correct(WorkLevel *level, int levels, const LocalFrame *frame, double horizon_m, const GroundFix *fix,
                        int fix_count, double *largest_m)
{
    enum { margin = 6 };
    static const double widest_m = 16384;
    FixSet              set = {0};
    FieldAim           *aim = NULL;
    Field               spline = {0};
    int                 count = 0;
    Status              status = fix_set_create(&set, frame, fix, fix_count, horizon_m);
    if (status != STATUS_OK) return status;
    status = STATUS_NO_MEMORY;
    aim = malloc(((size_t)set.count + 1) * sizeof *aim);
    if (!aim) goto done;
    double reach_m = 0;
    for (int n = 0; n < set.count; n++) {
        const FixRow *row = &set.row[n];
        int           corner[3];
        double        weight[3], h_m = NAN;
        if (row->dropped) continue;
        for (int k = 0; k < levels && !isfinite(h_m); k++)
            h_m = levels_height(&level[k].z, row->x_m, row->y_m, corner, weight);
        if (!isfinite(h_m)) continue;
        aim[count++] = (FieldAim){row->x_m, row->y_m, row->h_m - h_m, false};
        reach_m = fmax(reach_m, fmax(fabs(row->x_m), fabs(row->y_m)));
    }
    status = STATUS_OK;
    if (count == 0) goto done;

    const double least_m = fmax(8, 4 * level[0].z.spacing_m), half_m = fmin(reach_m + 2 * widest_m, horizon_m);
    double       spacing_m = widest_m;
    int          half = (int)ceil(half_m / spacing_m) + margin;
    status = levels_field_create(&spline, spacing_m, -half, -half, 2 * half + 1, 2 * half + 1);
    for (;;) {
        if (status == STATUS_OK) status = field_pull(&spline, aim, count);
        if (status != STATUS_OK) goto done;
        half = (int)ceil((reach_m + 8 * spacing_m) / spacing_m) * 2 + margin;
        if (half > spline.nx - 1 - 8) half = spline.nx - 1 - 8;
        if (spacing_m / 2 < least_m || (double)half * half > 4e6) break;
        Field fine;
        status = field_refine(&fine, &spline, -half, -half, 2 * half + 1, 2 * half + 1);
        if (status != STATUS_OK) goto done;
        levels_field_destroy(&spline);
        spline = fine;
        spacing_m /= 2;
    }
    /* there are no data beyond the finest window, so the correction fades to 0 over its last eighth */
    const double edge_m = (half - margin) * spline.spacing_m;
    for (int k = 0; k < levels; k++) {
        Field *z = &level[k].z;
        for (int j = 0; j < z->ny; j++)
            for (int i = 0; i < z->nx; i++) {
                const double x_m = (z->i0 + i) * z->spacing_m, y_m = (z->j0 + j) * z->spacing_m;
                const double out_m = fmax(fabs(x_m), fabs(y_m));
                if (out_m >= edge_m) continue;
                const double by_m =
                    field_spline_at(&spline, x_m, y_m) * (1 - smooth_step(0.875 * edge_m, edge_m, out_m));
                if (!isfinite(by_m)) continue;
                z->v[(size_t)j * (size_t)z->nx + (size_t)i] += (float)by_m;
                *largest_m = fmax(*largest_m, fabs(by_m));
            }
    }
done:
    levels_field_destroy(&spline);
    free(aim);
    fix_set_destroy(&set);
    return status;
}
