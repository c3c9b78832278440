/* render/radar/ground_plane.c: images in the ground, and what of a target sees them. */
#include "render/radar/ground_plane.h"

#include <stdlib.h>

enum { chunk = 256 };

static const double sunk_m = 1e-3;  /* beneath the plane by no more: on it */
static const double lift_m = 2e-4;  /* as that of tubes: past faces that touch the ground */

void ground_plane(GroundPlane *out, const double p_ground[3], const double n_ground[3], const double p_target[3],
                  const double r_from_body[9])
{
    double from[3];
    v3_sub(from, p_target, p_ground);
    m3_tmul_v3(out->n, r_from_body, n_ground);
    v3_normalize(out->n, out->n);
    out->height_m = v3_dot(from, n_ground) / v3_length(n_ground);
}

void ground_mirror(double out[3], const double d[3], const GroundPlane *plane)
{
    v3_add_scaled(out, d, -2 * v3_dot(plane->n, d), plane->n);
}

double ground_image(ScatterAntenna *image, const ScatterAntenna *antenna, const GroundPlane *plane)
{
    const double along = v3_dot(plane->n, antenna->u), r_m = antenna->range_m, h_m = plane->height_m;
    if (isinf(r_m)) {
        ground_mirror(image->u, antenna->u, plane);
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

/* From where the line to the image crosses the plane, to the antenna. */
static void hide_chunk(void *user, int worker, int task)
{
    const Hide          *hide = user;
    const size_t         first = (size_t)task * chunk, left = hide->count - first;
    const int            count = left < chunk ? (int)left : chunk;
    const ScatterAntenna *antenna[2] = {&hide->field->hits.tx, &hide->field->hits.rx};
    double               o[3][chunk], d[3][chunk], far_m[chunk];
    int                  list[chunk];
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
            ground_mirror(up, way, hide->plane);
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
    Hide hide = {field, target, plane, image, NULL, field->hits.count + (size_t)field->edges.count};
    const int chunks = (int)((hide.count + chunk - 1) / chunk);
    hide.hidden = calloc(hide.count + 1, 1);
    if (!hide.hidden) return STATUS_NO_MEMORY;
    if (pool) pool_run(pool, chunks, hide_chunk, &hide);
    else for (int t = 0; t < chunks; t++) hide_chunk(&hide, 0, t);
    keep_seen(field, hide.hidden);
    free(hide.hidden);
    return STATUS_OK;
}
