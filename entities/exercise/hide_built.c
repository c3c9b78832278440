/* entities/exercise/hide_built.c: buildings and works near a place, as triangles. */
#include "entities/exercise/hide_built.h"

#include "entities/scenery/scenery_buildings.h"

#include <stdlib.h>

static double ground_of(void *user, double x_m, double y_m)
{
    return elevation_height(&((const Landscape *)user)->elevation, x_m, y_m, NULL);
}

static bool is_about(const double p_m[2], const double about_m[2], double half_m)
{
    return fabs(p_m[0] - about_m[0]) <= half_m && fabs(p_m[1] - about_m[1]) <= half_m;
}

/* The records that are there: of lines those with some corner, with ground that they cover, which doors look for. */
static Status take_records(Culture *out, const Culture *from, const double about_m[2], double half_m)
{
    Status status = STATUS_OK;
    for (int n = 0; n < from->buildings && status == STATUS_OK; n++) {
        const Building *b = &from->building[n];
        const double(*p)[2] = (const double(*)[2])from->corner_m + b->first_corner;
        if (is_about(p[0], about_m, half_m)) status = culture_add_building(out, b, p, b->corners);
    }
    for (int n = 0; n < from->lines && status == STATUS_OK; n++) {
        const CultureLine *l = &from->line[n];
        const double(*p)[2] = (const double(*)[2])from->corner_m + l->first_corner;
        bool near = false;
        for (int k = 0; k < l->corners; k++) near |= is_about(p[k], about_m, half_m);
        if (near) status = culture_add_line(out, l, p, l->corners);
    }
    for (int n = 0; n < from->points && status == STATUS_OK; n++) {
        const CulturePoint *q = &from->point[n];
        if (is_about((const double[2]){q->x_m, q->y_m}, about_m, half_m)) status = culture_add_point(out, q);
    }
    return status == STATUS_OK ? culture_index(out) : status;
}

static Status take_triangles(HideSolids *out, const Scenery *s)
{
    size_t all = 1;
    for (int k = 0; k < s->objects; k++) all += (size_t)s->model[s->object[k].model].triangle_count;
    out->corner = malloc(all * sizeof *out->corner), out->about = malloc(all * sizeof *out->about);
    if (!out->corner || !out->about || all > INT32_MAX) return STATUS_NO_MEMORY;
    for (int k = 0; k < s->objects; k++) {
        const SceneryObject *o = &s->object[k];
        const Model         *m = &s->model[o->model];
        for (int t = 0; t < m->triangle_count; t++, out->count++) {
            double(*p)[3] = out->corner[out->count], *a = out->about[out->count];
            a[0] = a[1] = a[2] = 0;
            for (int c = 0; c < 3; c++) {
                m3_mul_v3(p[c], o->r_enu_from_body, m->vertex[m->triangle[t][c]]);
                v3_add(p[c], p[c], o->p_enu);
                a[0] += p[c][0] / 3, a[1] += p[c][1] / 3;
            }
            for (int c = 0; c < 3; c++) a[2] = fmax(a[2], hypot(p[c][0] - a[0], p[c][1] - a[1]));
        }
    }
    return STATUS_OK;
}

Status hide_solids_open(HideSolids *out, const Culture *culture, const Landscape *landscape, const double about_m[2],
                        double half_m)
{
    Culture near = {0};
    Scenery scenery = {0};
    *out = (HideSolids){0};
    if (!culture || !culture->index) return STATUS_OK;
    Status status = take_records(&near, culture, about_m, half_m);
    if (status == STATUS_OK) status = scenery_add_buildings(&scenery, &near, ground_of, (void *)landscape);
    if (status == STATUS_OK) status = take_triangles(out, &scenery);
    scenery_free(&scenery);
    culture_free(&near);
    if (status != STATUS_OK) hide_solids_close(out);
    return status;
}

void hide_solids_close(HideSolids *s)
{
    free(s->corner), free(s->about);
    *s = (HideSolids){0};
}

int hide_solids_along(int list[hide_solids_most], const HideSolids *s, const double p_enu[3], double radius_m,
                      const double d_enu[3], double range_m)
{
    static const double tallest_m = 60; /* over the place: of chimneys, masts and what stands on higher ground */
    const double        level = fmax(hypot(d_enu[0], d_enu[1]), 1e-9);
    const double        long_m = fmin(level * range_m, tallest_m * level / fmax(d_enu[2], 0.02));
    int                 count = 0;
    for (int t = 0; t < s->count; t++) {
        const double dx = s->about[t][0] - p_enu[0], dy = s->about[t][1] - p_enu[1], beside = radius_m + s->about[t][2];
        const double along = (dx * d_enu[0] + dy * d_enu[1]) / level;
        const double across = fabs(dx * d_enu[1] - dy * d_enu[0]) / level;
        if (across <= beside && along >= -beside && along <= long_m + beside) {
            if (count < hide_solids_most) list[count] = t;
            count++;
        }
    }
    return count;
}

/* Moeller and Trumbore, "Fast, minimum storage ray/triangle intersection", 1997. */
bool hide_triangle_meets(const double corner[3][3], const double o[3], const double d[3])
{
    double u[3], v[3], p[3], q[3], s[3];
    v3_sub(u, corner[1], corner[0]), v3_sub(v, corner[2], corner[0]);
    v3_cross(p, d, v);
    const double det = v3_dot(u, p);
    if (fabs(det) < 1e-12) return false;
    v3_sub(s, o, corner[0]);
    const double a = v3_dot(s, p) / det;
    v3_cross(q, s, u);
    const double b = v3_dot(d, q) / det;
    return a >= 0 && b >= 0 && a + b <= 1 && v3_dot(v, q) / det > 0;
}

bool hide_solids_meet(const HideSolids *s, const int *list, int count, const double p_enu[3], const double d_enu[3])
{
    for (int k = 0; k < count; k++)
        if (hide_triangle_meets((const double(*)[3])s->corner[list[k]], p_enu, d_enu)) return true;
    return false;
}
