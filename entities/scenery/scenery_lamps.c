/* entities/scenery/scenery_lamps.c: finds lamps in the meshes of scenery, and says when they are lit. */
#include "entities/scenery/scenery_lamps.h"

#include <stdlib.h>

enum { draw_type = 601, draw_window, draw_bed, draw_rise };

typedef struct Lamps {
    Scenery     *scenery;
    SceneryLamp *lamp;
    int          count, room, left_out;
    uint64_t     seed;
    Status       status;
} Lamps;

static void add(Lamps *to, const SceneryLamp *lamp)
{
    if (to->count >= scenery_most_lamps) {
        to->left_out++;
        return;
    }
    if (to->count >= to->room) {
        const int    room = to->room ? 2 * to->room : 256;
        SceneryLamp *larger = realloc(to->lamp, (size_t)room * sizeof *larger);
        if (!larger) {
            to->status = STATUS_NO_MEMORY;
            return;
        }
        to->lamp = larger, to->room = room;
    }
    to->lamp[to->count++] = *lamp;
}

/* Near-normal, of standard deviation 1, from two uniform numbers; within 2.45. */
static double spread(uint64_t seed, uint32_t stream, uint64_t id)
{
    return sqrt(6.0) * (random_uniform(seed, stream, 0, id) + random_uniform(seed, stream, 1, id) - 1);
}

static void to_enu(double p[3], const SceneryObject *o, const double p_body[3])
{
    m3_mul_v3(p, o->r_enu_from_body, p_body);
    for (int k = 0; k < 3; k++) p[k] += o->p_enu[k];
}

/* A pane is two triangles, one after the other, with two corners in common. */
static bool is_pane(double middle[3], double n[3], double *area_m2, const Model *m, int facet)
{
    const uint32_t *a = m->triangle[facet], *b = m->triangle[facet + 1];
    double          u[3], v[3], low[3], high[3];
    int             shared = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) shared += a[i] == b[j];
    if (shared != 2) return false;
    v3_sub(u, m->vertex[a[1]], m->vertex[a[0]]), v3_sub(v, m->vertex[a[2]], m->vertex[a[0]]);
    v3_cross(n, u, v);
    *area_m2 = sqrt(v3_dot(n, n)); /* of both: a rectangle */
    for (int k = 0; k < 3; k++) low[k] = INFINITY, high[k] = -INFINITY;
    for (int i = 0; i < 6; i++) {
        const double *p = m->vertex[i < 3 ? a[i] : b[i - 3]];
        for (int k = 0; k < 3; k++) low[k] = fmin(low[k], p[k]), high[k] = fmax(high[k], p[k]);
    }
    for (int k = 0; k < 3; k++) middle[k] = 0.5 * (low[k] + high[k]);
    return v3_normalize(n, n);
}

static void panes(Lamps *to, int object, const ModelPart *part, uint64_t dwelling)
{
    const SceneryObject *o = &to->scenery->object[object];
    const Model         *m = &to->scenery->model[o->model];
    SceneryLamp          l = {.kind = LAMP_WINDOW, .object = object, .facets = 2};
    const double         bed_h = 22.7 + 1.0 * spread(to->seed, draw_bed, dwelling);
    l.bed_h = (float)fmod(bed_h, 24);
    l.rise_h = (float)(6.7 + 0.9 * spread(to->seed, draw_rise, dwelling));
    l.type = (float)random_uniform(to->seed, draw_type, 0, dwelling);
    for (int t = part->first_triangle; t + 1 < part->first_triangle + part->triangle_count; t++) {
        double middle[3], n[3], area_m2;
        if (!is_pane(middle, n, &area_m2, m, t)) continue;
        l.facet = t, l.area_m2 = (float)area_m2;
        l.draw = (float)random_uniform(to->seed, draw_window, (uint32_t)(t - part->first_triangle), dwelling);
        to_enu(l.p, o, middle);
        m3_mul_v3(l.n, o->r_enu_from_body, n);
        add(to, &l);
        t++;
    }
}

/* The head of a post: it shines down from its lower side. */
static void head(Lamps *to, int object, const ModelPart *part, uint64_t record)
{
    const SceneryObject *o = &to->scenery->object[object];
    const Model         *m = &to->scenery->model[o->model];
    double               low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    double               down_m2 = 0;
    SceneryLamp          l = {.kind = LAMP_STREET, .object = object, .facet = part->first_triangle, .n = {0, 0, -1}};
    for (int t = part->first_triangle; t < part->first_triangle + part->triangle_count; t++) {
        double u[3], v[3], n[3];
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++) {
                const double at = m->vertex[m->triangle[t][i]][k];
                low[k] = fmin(low[k], at), high[k] = fmax(high[k], at);
            }
        v3_sub(u, m->vertex[m->triangle[t][1]], m->vertex[m->triangle[t][0]]);
        v3_sub(v, m->vertex[m->triangle[t][2]], m->vertex[m->triangle[t][0]]);
        v3_cross(n, u, v);
        down_m2 += 0.5 * fmax(n[2], 0);
    }
    if (!(down_m2 > 0)) return;
    const double under[3] = {0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), high[2]};
    to_enu(l.p, o, under);
    l.facets = part->triangle_count, l.area_m2 = (float)down_m2;
    l.type = (float)random_uniform(to->seed, draw_type, 1, record);
    add(to, &l);
}

static void built(Lamps *to, int object)
{
    const Scenery *s = to->scenery;
    const int      model = s->object[object].model;
    const Model   *m = &s->model[model];
    const int      first = s->part_first ? s->part_first[model] : -1;
    for (int p = 0; p < m->part_count; p++) {
        const uint64_t record = first >= 0 ? s->part_of[first + p] : s->object[object].id;
        if (m->part[p].damage_hidden >> s->object[object].damage & 1) continue;
        if (m->part[p].role == HEAT_WINDOW) panes(to, object, &m->part[p], record);
        else if (strcmp(m->part[p].name, "lamp") == 0) head(to, object, &m->part[p], record);
    }
}

/* The middle of both headlamps, in the body's axes. */
static void headlamps(Lamps *to, int object)
{
    static const double  at_m = 0.65, lamp_m2 = 0.02;
    const SceneryObject *o = &to->scenery->object[object];
    const Model         *m = &to->scenery->model[o->model];
    const SceneryLamp    l = {
           .kind = LAMP_VEHICLE,
           .object = object,
           .facet = -1,
           .p = {m->box_high[0], 0.5 * (m->box_low[1] + m->box_high[1]), -fmin(at_m, 0.5 * m->height_m)},
           .n = {1, 0, 0},
           .area_m2 = (float)(2 * lamp_m2),
           .type = (float)random_uniform(to->seed, draw_type, 2, o->id)};
    add(to, &l);
}

static int in_order(const void *pa, const void *pb)
{
    const SceneryLamp *a = pa, *b = pb;
    return a->object != b->object ? (a->object > b->object) - (a->object < b->object)
                                  : (a->facet > b->facet) - (a->facet < b->facet);
}

Status scenery_add_lamps(Scenery *s, uint64_t seed)
{
    Lamps to = {.scenery = s, .seed = seed};
    for (int k = 0; k < s->objects; k++)
        if (s->object[k].kind == SCENERY_BUILDINGS) built(&to, k);
    for (int k = 0; k < s->movers; k++) {
        const uint8_t class = s->object[s->mover[k].object].class;
        if (class >= CLUTTER_CAR && class <= CLUTTER_TRACTOR) headlamps(&to, s->mover[k].object);
    }
    if (to.status != STATUS_OK) {
        free(to.lamp);
        return to.status;
    }
    if (to.left_out > 0)
        log_warn("scenery: more lamps than there is room for are dark: most=%d dark=%d", (int)scenery_most_lamps,
                 to.left_out);
    if (to.count > 0) qsort(to.lamp, (size_t)to.count, sizeof *to.lamp, in_order);
    free(s->lamp);
    s->lamp = to.lamp, s->lamps = to.count;
    return STATUS_OK;
}

/* ---- when --------------------------------------------------------------------------------------- */

static double hours_after(double hour, double from_h) { return fmod(hour - from_h + 48, 24); }

bool scenery_lamp_lit(const SceneryLamp *l, double sun_up, double hour)
{
    /* of the windows of a dwelling: while people are up, at night, and before the sun is up */
    static const double evening = 0.4, night = 0.02, morning = 0.25, noon_h = 12;
    if (l->kind == LAMP_STREET) return sun_up < lamps_street_sun_up;
    if (sun_up >= lamps_home_sun_up) return false;
    if (l->kind == LAMP_VEHICLE) return true;
    const double at = hours_after(hour, noon_h), bed = hours_after((double)l->bed_h, noon_h);
    const double rise = hours_after((double)l->rise_h, noon_h);
    return (double)l->draw < (at < bed ? evening : at < rise ? night : morning);
}

double scenery_solar_hour(const double d[3], double lat_rad)
{
    const double west = -d[0], up = d[2] * cos(lat_rad) - d[1] * sin(lat_rad);
    return fmod(12 + atan2(west, up) * 12 / pi_rad + 24, 24);
}

int scenery_lamp_of(const Scenery *s, int object, int facet)
{
    int low = 0, high = s->lamps;
    while (low < high) { /* the first beyond */
        const int          middle = low + (high - low) / 2;
        const SceneryLamp *l = &s->lamp[middle];
        if (l->object > object || (l->object == object && l->facet > facet)) high = middle;
        else low = middle + 1;
    }
    const SceneryLamp *l = low > 0 ? &s->lamp[low - 1] : NULL;
    const bool         of = l && l->object == object && (l->facet < 0 || facet < l->facet + l->facets);
    return of ? low - 1 : -1;
}
