/* render/scattering/paths/ground_bounce.c: the table of the ground, images in it and what of a target sees them,
 * and the sum of the paths. */
#include "render/scattering/paths/ground_bounce.h"

#include "pitviper_table.h"

#include <stdlib.h>

typedef struct Row {
    SurfaceClass surface;
    double       frequency_hz, e1, e2, rms_m;
    int          waves;
} Row;

static const TableColumn columns[] = {
    {"surface", TABLE_NAMED, TABLE_AT(Row, surface), SURFACE_NAMED},
    {"f_ghz", TABLE_DOUBLE, TABLE_AT(Row, frequency_hz), .low = 0.1, .high = 1000, .unit = 1e9},
    {"eps_re", TABLE_DOUBLE, TABLE_AT(Row, e1), .low = 1, .high = 1000},
    {"eps_im", TABLE_DOUBLE, TABLE_AT(Row, e2), .low = 0, .high = 1e6},
    {"rms_mm", TABLE_DOUBLE, TABLE_AT(Row, rms_m), .low = 0, .high = 1e5, .unit = 1e-3},
    {"heights", TABLE_CHOICE, TABLE_AT(Row, waves), .choices = "gaussian, waves"},
};
static const TableFormat format = {"radar ground", columns, sizeof columns / sizeof *columns,
                                   .next = "etc/radar/ground.csv explains the columns"};

static Status take_row(void *user, const void *read, const TableRows *rows, int number)
{
    const Row *row = read;
    GroundRow *to = &((GroundTable *)user)->row[row->surface];
    const bool waves = row->waves == 1;
    if (to->points > 0 && (to->rms_m != row->rms_m || to->waves != waves))
        return table_rows_refuse(rows, number, NULL, "rms_mm and heights must be those of the surface's first row");
    if (to->points == ground_points)
        return table_rows_refuse(rows, number, NULL, "more than 8 frequencies of a surface");
    if (to->points > 0 && !(row->frequency_hz > to->frequency_hz[to->points - 1]))
        return table_rows_refuse(rows, number, "f_ghz", "above that of the surface's row before");
    to->rms_m = row->rms_m;
    to->waves = waves;
    to->frequency_hz[to->points] = row->frequency_hz;
    to->e1[to->points] = row->e1;
    to->e2[to->points++] = row->e2;
    return STATUS_OK;
}

Status ground_table_open(GroundTable *out, const char *path)
{
    GroundTable table = {0};
    Row         row;
    Status      status = table_each(&format, path, &row, sizeof row, take_row, &table);
    for (int s = SURFACE_NONE + 1; s < SURFACE_COUNT && status == STATUS_OK; s++)
        if (table.row[s].points == 0) {
            log_error("%s: %s: no row of surface %s; %s", format.module, path, surface_name((SurfaceClass)s),
                      format.next);
            status = STATUS_BAD_VALUE;
        }
    if (status != STATUS_OK) return status;
    table.row[SURFACE_NONE] = table.row[SURFACE_BARE_SOIL];
    *out = table;
    return STATUS_OK;
}

GroundSurface ground_surface(const GroundRow *row, double frequency_hz)
{
    const double *f = row->frequency_hz;
    int           p = 0;
    while (p < row->points - 1 && f[p + 1] < frequency_hz) p++;
    double e1 = row->e1[p], e2 = row->e2[p];
    if (p < row->points - 1) {
        const double share = clamp(log(frequency_hz / f[p]) / log(f[p + 1] / f[p]), 0, 1);
        e1 += share * (row->e1[p + 1] - e1);
        e2 += share * (row->e2[p + 1] - e2);
    }
    return (GroundSurface){CMPLX(e1, -e2), row->rms_m, row->waves};
}

/* Computes exp(-x) I0(x) for x >= 0, to 2e-7. Source: Abramowitz and Stegun 9.8.1, 9.8.2. */
static double scaled_i0(double x)
{
    static const double small[] = {1, 3.5156229, 3.0899424, 1.2067492, 0.2659732, 0.0360768, 0.0045813};
    static const double large[] = {0.39894228,  0.01328592, 0.00225319,  -0.00157565, 0.00916281,
                                   -0.02057706, 0.02635537, -0.01647633, 0.00392377};
    const bool          near = x < 3.75;
    const double        t = near ? x * x / (3.75 * 3.75) : 3.75 / x;
    double              sum = 0;
    for (int i = near ? 6 : 8; i >= 0; i--) sum = sum * t + (near ? small[i] : large[i]);
    return near ? sum * exp(-x) : sum / sqrt(x);
}

double ground_roughness(double rms_m, bool waves, double k, double sin_grazing)
{
    const double phase = k * rms_m * sin_grazing, x = 2 * phase * phase;
    return waves ? scaled_i0(x) : exp(-x);
}

void ground_reflection(double complex *te, double complex *tm, const GroundSurface *surface, double k,
                       double sin_grazing)
{
    const double rough = ground_roughness(surface->rms_m, surface->waves, k, sin_grazing);
    fresnel_half_space(te, tm, surface->eps, sin_grazing);
    *te *= rough, *tm *= rough;
}

/* ---- images in the ground, and what of a target sees them --------------------------------------- */

enum { chunk = 256 };

static const double sunk_m = 1e-3; /* beneath the plane by no more: on it */
static const double lift_m = 2e-4; /* as that of tubes: past faces that touch the ground */

void ground_plane(GroundPlane *out, const double p_ground[3], const double n_ground[3], const double p_target[3],
                  const double r_from_body[9])
{
    double from[3];
    v3_sub(from, p_target, p_ground);
    m3_tmul_v3(out->n, r_from_body, n_ground);
    v3_normalize(out->n, out->n);
    out->height_m = v3_dot(from, n_ground) / v3_length(n_ground);
}

/* Mirrors a direction at the ground. Applied to the direction to an image, it gives the direction from the ground to
 * the antenna. */
static void mirror(double out[3], const double d[3], const GroundPlane *plane)
{
    v3_add_scaled(out, d, -2 * v3_dot(plane->n, d), plane->n);
}

double ground_image(ScatterAntenna *image, const ScatterAntenna *antenna, const GroundPlane *plane)
{
    const double along = v3_dot(plane->n, antenna->u), r_m = antenna->range_m, h_m = plane->height_m;
    if (isinf(r_m)) {
        mirror(image->u, antenna->u, plane);
        v3_normalize(image->u, image->u);
        image->range_m = r_m;
        return 2 * h_m * along;
    }
    double p[3];
    v3_scale(p, r_m, antenna->u);
    v3_add_scaled(p, p, -2 * (r_m * along + h_m), plane->n);
    image->range_m = v3_length(p);
    v3_scale(image->u, 1 / image->range_m, p);
    return 4 * h_m * (r_m * along + h_m) / (image->range_m + r_m); /* difference of squares over the sum of lengths */
}

/* ---- what sees the image ---------------------------------------------------------------------------- */

typedef struct Hide {
    const TotalField  *field;
    const RadarTarget *target;
    const GroundPlane *plane;
    const bool        *image;
    uint8_t           *hidden; /* [hits, then edges] */
    size_t             count;
} Hide;

static void point_of(double p[3], const TotalField *field, size_t i, int end)
{
    const TubeHits *h = &field->hits;
    if (i >= h->count) {
        memcpy(p, field->edges.segment[i - h->count].p, 3 * sizeof *p);
        return;
    }
    for (int c = 0; c < 3; c++) p[c] = (double)(end ? h->last[c][i] : h->first[c][i]);
}

/* Tests the rays from where the line to the image crosses the plane to the antenna. */
static void hide_chunk(void *user, int worker, int task)
{
    const Hide           *hide = user;
    const size_t          first = (size_t)task * chunk, left = hide->count - first;
    const int             count = left < chunk ? (int)left : chunk;
    const ScatterAntenna *antenna[2] = {&hide->field->hits.tx, &hide->field->hits.rx};
    double                o[3][chunk], d[3][chunk], far_m[chunk];
    int                   list[chunk];
    (void)worker;
    for (int end = 0; end < 2; end++) {
        int asked = 0;
        for (int i = 0; i < count; i++) {
            double p[3], way[3], up[3];
            point_of(p, hide->field, first + (size_t)i, end);
            const double above_m = ground_above_m(hide->plane, p);
            scatter_path(way, antenna[end], p);
            const double sink = -v3_dot(hide->plane->n, way);
            if (above_m < -sunk_m || (hide->image[end] && !(sink > 0))) hide->hidden[first + (size_t)i] = 1;
            if (!hide->image[end] || hide->hidden[first + (size_t)i]) continue;
            mirror(up, way, hide->plane);
            const double down_m = fmax(above_m, 0) / sink;
            for (int c = 0; c < 3; c++) {
                o[c][i] = p[c] + down_m * way[c] + lift_m * up[c];
                d[c][i] = up[c];
            }
            far_m[i] = INFINITY;
            list[asked++] = i;
        }
        const double *const from[3] = {o[0], o[1], o[2]}, *const to[3] = {d[0], d[1], d[2]};
        parts_any_hits(hide->hidden + first, &hide->target->entity, from, to, far_m, list, asked, false);
    }
}

static void keep_seen(TotalField *field, const uint8_t *hidden)
{
    TubeHits    *h = &field->hits;
    const size_t hits = h->count;
    size_t       kept = 0;
    for (size_t i = 0; i <= hits && hits > 0; i++) { /* the one of no amplitude behind the last, too */
        if (i < hits && hidden[i]) continue;
        h->path_m[kept] = h->path_m[i];
        for (int s = 0; s < 2; s++) h->slope_m[s][kept] = h->slope_m[s][i];
        for (int p = 0; p < 8; p++) h->amplitude[p][kept] = h->amplitude[p][i];
        for (int c = 0; c < 3; c++) h->first[c][kept] = h->first[c][i], h->last[c][kept] = h->last[c][i];
        h->bounce[kept] = h->bounce[i];
        h->part[kept++] = h->part[i];
    }
    h->count = hits > 0 ? kept - 1 : 0;
    int edges = 0;
    for (int i = 0; i < field->edges.count; i++)
        if (!hidden[hits + (size_t)i]) field->edges.segment[edges++] = field->edges.segment[i];
    field->edges.count = edges;
}

Status ground_hide(TotalField *field, const RadarTarget *target, const GroundPlane *plane, const bool image[2],
                   Pool *pool)
{
    Hide      hide = {field, target, plane, image, NULL, field->hits.count + (size_t)field->edges.count};
    const int chunks = (int)((hide.count + chunk - 1) / chunk);
    hide.hidden = calloc(hide.count + 1, 1);
    if (!hide.hidden) return STATUS_NO_MEMORY;
    if (pool) pool_run(pool, chunks, hide_chunk, &hide);
    else
        for (int t = 0; t < chunks; t++) hide_chunk(&hide, 0, t);
    keep_seen(field, hide.hidden);
    free(hide.hidden);
    return STATUS_OK;
}

/* ---- legs by way of the ground, and the sum of the four paths ----------------------------------- */

const double ground_least_coherence = 1e-3;

/* The antenna's axes for a wave from it that returns in direction u. */
static void antenna_axes(double axis[2][3], const double u[3], const double right[3])
{
    double h[3], v[3];
    v3_add_scaled(axis[0], right, -v3_dot(right, u), u);
    if (!v3_normalize(axis[0], axis[0])) {
        scatter_basis(h, v, u);
        memcpy(axis[0], h, sizeof h);
    }
    v3_cross(axis[1], u, axis[0]);
}

void ground_leg_direct(GroundLeg *out, const ScatterAntenna *antenna, const double right[3])
{
    double basis[2][3], axis[2][3];
    scatter_basis(basis[0], basis[1], antenna->u);
    antenna_axes(axis, antenna->u, right);
    *out = (GroundLeg){.spread = 1, .coherence = 1};
    for (int p = 0; p < 2; p++)
        for (int a = 0; a < 2; a++) out->m[p][a] = v3_dot(basis[p], axis[a]);
}

bool ground_leg_image(GroundLeg *out, const GroundMirror *from, const GroundSurface *surface, double k,
                      const double right[3])
{
    const ScatterAntenna *antenna = from->antenna, *image = from->image;
    const GroundPlane    *plane = from->plane;
    double                u[3], basis[2][3], axis[2][3], d[3], across[3], before[3], after[3], d_out[3];
    double complex        te, tm;
    mirror(u, image->u, plane);
    const double sine = v3_dot(plane->n, u);
    if (!(sine > 0)) return false;
    ground_reflection(&te, &tm, surface, k, fmin(sine, 1));
    scatter_basis(basis[0], basis[1], image->u);
    antenna_axes(axis, u, right);
    v3_scale(d, -1, u);
    v3_scale(d_out, -1, image->u);
    v3_cross(across, d, plane->n);
    if (!(v3_length(across) > 1e-9)) memcpy(across, axis[0], sizeof across); /* straight down: any */
    v3_normalize(across, across);
    v3_cross(before, d, across);
    v3_cross(after, d_out, across);
    *out = (GroundLeg){.extra_m = from->extra_m,
                       .spread = isinf(antenna->range_m) ? 1 : antenna->range_m / image->range_m,
                       .coherence = fmax(cabs(te), cabs(tm))};
    for (int p = 0; p < 2; p++)
        for (int a = 0; a < 2; a++)
            out->m[p][a] = te * (v3_dot(axis[a], across) * v3_dot(basis[p], across)) +
                           tm * (v3_dot(axis[a], before) * v3_dot(basis[p], after));
    return true;
}

void ground_through(ScatterMatrix *out, const ScatterMatrix *s, const GroundLeg *receive, const GroundLeg *transmit)
{
    const double complex in[2][2] = {{s->hh, s->hv}, {s->vh, s->vv}};
    double complex       half[2][2], through[2][2];
    for (int q = 0; q < 2; q++)
        for (int a = 0; a < 2; a++) half[q][a] = in[q][0] * transmit->m[0][a] + in[q][1] * transmit->m[1][a];
    for (int b = 0; b < 2; b++)
        for (int a = 0; a < 2; a++) through[b][a] = receive->m[0][b] * half[0][a] + receive->m[1][b] * half[1][a];
    *out = (ScatterMatrix){through[0][0], through[0][1], through[1][0], through[1][1]};
}

static void add(ScatterMatrix *to, const ScatterMatrix *s, double complex share)
{
    to->hh += share * s->hh, to->hv += share * s->hv, to->vh += share * s->vh, to->vv += share * s->vv;
}

void ground_sum(ScatterMatrix *out, const GroundFields *s, const GroundLeg *direct, const GroundLeg *image, double k)
{
    ScatterMatrix        sum, part;
    const double complex e = image->spread * cexp(-I * k * image->extra_m);
    ground_through(&sum, &s->direct, direct, direct);
    ground_through(&part, &s->once, image, direct);
    add(&sum, &part, e);
    add(&sum, &(ScatterMatrix){part.hh, part.vh, part.hv, part.vv}, e); /* the other way round: the transpose */
    ground_through(&part, &s->twice, image, image);
    add(&sum, &part, e * e);
    *out = sum;
}

void ground_reflection_point(double p[3], const ScatterAntenna *image, const GroundPlane *plane)
{
    v3_scale(p, plane->height_m / fmax(-v3_dot(plane->n, image->u), 1e-9), image->u);
}
