/* render/scattering/built/pieces.c: cuts triangles into pieces along a grid of their plane. */
#include "render/scattering/built/pieces.h"

static const double most_cells = 1 << 20, least_share = 1e-6;

double piece_plane(PiecePlane *out, const double corner[3][3])
{
    double a[3], b[3], n[3];
    v3_sub(a, corner[1], corner[0]);
    v3_sub(b, corner[2], corner[0]);
    v3_cross(n, a, b);
    const double twice = v3_length(n);
    if (!(twice > 0 && isfinite(twice))) return 0;
    v3_scale(out->n, 1 / twice, n);
    const double level = hypot(out->n[0], out->n[1]);
    if (level > 1e-6) {
        out->s[0] = -out->n[1] / level, out->s[1] = out->n[0] / level, out->s[2] = 0;
    } else {
        out->s[0] = 1, out->s[1] = out->s[2] = 0;
    }
    v3_cross(out->t, out->n, out->s);
    out->offset_m = v3_dot(out->n, corner[0]);
    return 0.5 * twice;
}

/* A convex polygon in the plane. Cuts only ever add one corner. */
typedef struct Outline {
    int    count;
    double p[piece_corners_most + 1][2];
} Outline;

/* Parts an outline at the line where axis a is at_m: below and above it. */
static void part(Outline *below, Outline *above, const Outline *of, int a, double at_m)
{
    below->count = above->count = 0;
    for (int i = 0; i < of->count; i++) {
        const double *p = of->p[i], *q = of->p[i + 1 == of->count ? 0 : i + 1];
        if (p[a] <= at_m) memcpy(below->p[below->count++], p, sizeof *of->p);
        if (p[a] >= at_m) memcpy(above->p[above->count++], p, sizeof *of->p);
        if ((p[a] < at_m && q[a] > at_m) || (p[a] > at_m && q[a] < at_m)) {
            const double share = (at_m - p[a]) / (q[a] - p[a]);
            double       cut[2];
            cut[a] = at_m;
            cut[1 - a] = p[1 - a] + share * (q[1 - a] - p[1 - a]);
            memcpy(below->p[below->count++], cut, sizeof cut);
            memcpy(above->p[above->count++], cut, sizeof cut);
        }
    }
}

/* Area and centroid about the first corner, so that far planes lose no digits. */
static void measure(Piece *out)
{
    const double *o = out->corner[0];
    double        sum = 0, moment[2] = {0, 0};
    for (int i = 1; i + 1 < out->corners; i++) {
        const double a[2] = {out->corner[i][0] - o[0], out->corner[i][1] - o[1]},
                     b[2] = {out->corner[i + 1][0] - o[0], out->corner[i + 1][1] - o[1]};
        const double twice = a[0] * b[1] - a[1] * b[0];
        sum += twice;
        for (int k = 0; k < 2; k++) moment[k] += twice * (a[k] + b[k]) / 3;
    }
    out->area_m2 = 0.5 * sum;
    for (int k = 0; k < 2; k++) out->middle[k] = o[k] + (sum > 0 ? moment[k] / sum : 0);
}

static void give(const Outline *of, int32_t i, int32_t j, double least_m2, PieceTake *take, void *user)
{
    Piece piece = {.i = i, .j = j, .corners = of->count};
    if (of->count < 3 || of->count > piece_corners_most) return;
    memcpy(piece.corner, of->p, (size_t)of->count * sizeof *of->p);
    measure(&piece);
    if (piece.area_m2 > least_m2) take(user, &piece);
}

/* The triangle in the plane's axes, and the box about it in cells. */
static void flatten(Outline *out, double low[2], double high[2], const PiecePlane *plane, const double corner[3][3],
                    const double side_m[2])
{
    out->count = 3;
    low[0] = low[1] = INFINITY, high[0] = high[1] = -INFINITY;
    for (int v = 0; v < 3; v++) {
        out->p[v][0] = v3_dot(corner[v], plane->s);
        out->p[v][1] = v3_dot(corner[v], plane->t);
        for (int k = 0; k < 2; k++) {
            low[k] = fmin(low[k], floor(out->p[v][k] / side_m[k]));
            high[k] = fmax(high[k], floor(out->p[v][k] / side_m[k]));
        }
    }
}

double pieces_bound(const PiecePlane *plane, const double corner[3][3], const double side_m[2])
{
    Outline outline;
    double  low[2], high[2];
    flatten(&outline, low, high, plane, corner, side_m);
    return (high[0] - low[0] + 1) * (high[1] - low[1] + 1);
}

bool pieces_cut(const PiecePlane *plane, const double corner[3][3], const double side_m[2], PieceTake *take, void *user)
{
    Outline      left, row, rest, cell;
    double       low[2], high[2];
    const double least_m2 = least_share * side_m[0] * side_m[1];
    flatten(&left, low, high, plane, corner, side_m);
    if (!((high[0] - low[0] + 1) * (high[1] - low[1] + 1) <= most_cells) || !(fabs(low[0]) < 1e9) ||
        !(fabs(low[1]) < 1e9))
        return false;
    for (double j = low[1]; j <= high[1] && left.count >= 3; j++) {
        Outline above;
        part(&row, &above, &left, 1, (j + 1) * side_m[1]);
        left = above;
        rest = row;
        for (double i = low[0]; i <= high[0] && rest.count >= 3; i++) {
            Outline beyond;
            part(&cell, &beyond, &rest, 0, (i + 1) * side_m[0]);
            rest = beyond;
            give(&cell, (int32_t)i, (int32_t)j, least_m2, take, user);
        }
    }
    return true;
}
