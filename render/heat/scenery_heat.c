/* render/heat/scenery_heat.c: which construction or state each part of scenery has, and its temperatures in a frame
 * (scenery_heat.h). */
#include "render/heat/scenery_heat_private.h"

#include <stdlib.h>

SceneryHeatConfig scenery_heat_default_config(void)
{
    SceneryHeatConfig c = {.heat = heat_default_config()};
    c.heat.facets = 17;
    return c;
}

/* ---- walls of parts, movers of objects ------------------------------------------------------------ */

/* The wall of a part, a new one if it is the first of its construction and material. Beyond scenery_most_walls: the
 * last. */
static int wall_of(SceneryHeat *h, const ModelPart *part, int material, bool *full)
{
    SceneryWalls *w = &h->walls;
    const int     row = constructions_find(&h->constructions, part->name, part->role, part->material);
    for (int i = 0; i < w->count; i++)
        if (w->wall[i].row == row && w->wall[i].material == material) return i;
    if (w->count == scenery_most_walls) {
        *full = true;
        return w->count - 1;
    }
    w->wall[w->count] = (SceneryWall){.row = row, .material = material};
    return w->count++;
}

static Status find_walls(SceneryHeat *h, const bool *needed)
{
    const Scenery *s = h->scenery;
    bool           full = false;
    for (int m = 0; m < s->models; m++) {
        const Model *model = &s->model[m];
        for (int p = 0; p < model->part_count; p++) {
            int *out = &h->part_wall[h->part_first[m] + p];
            *out = -1;
            if (!needed[m]) continue;
            const int material = materials_find(h->config.materials, model->part[p].material);
            if (material < 0) {
                log_error("scenery: %s: part %s is of %s, which is no row of etc/materials.csv", model->name,
                          model->part[p].name, model->part[p].material);
                return STATUS_BAD_VALUE;
            }
            *out = wall_of(h, &model->part[p], material, &full);
        }
    }
    if (full)
        log_warn("scenery: more than %d constructions and materials: others are as warm as the last: "
                 "fewer materials in etc/constructions.csv would be all solved",
                 (int)scenery_most_walls);
    return STATUS_OK;
}

/* Normals that parts of an object have, by its triangles and their corners. */
static void use_normals(SceneryHeat *h, const SceneryObject *o)
{
    const Model *model = &h->scenery->model[o->model];
    for (int t = 0; t < model->triangle_count; t++) {
        const int       part = model->triangle_part[t], wall = h->part_wall[h->part_first[o->model] + part];
        const uint32_t *corner = model->triangle[t];
        double          a[3], b[3], n[4][3], n_enu[3];
        if (wall < 0) continue;
        v3_sub(a, model->vertex[corner[1]], model->vertex[corner[0]]);
        v3_sub(b, model->vertex[corner[2]], model->vertex[corner[0]]);
        v3_cross(n[3], a, b);
        for (int k = 0; k < 3; k++)
            for (int i = 0; i < 3; i++) n[k][i] = (double)model->normal[corner[k]][i];
        for (int k = 0; k < 4; k++) {
            m3_mul_v3(n_enu, o->r_enu_from_body, n[k]);
            if (v3_normalize(n_enu, n_enu)) scenery_walls_use(h->walls.wall[wall].used, h->config.heat.facets, n_enu);
        }
    }
}

static Status number_parts(SceneryHeat *h)
{
    const Scenery *s = h->scenery;
    SceneryWalls  *w = &h->walls;
    bool          *needed = calloc((size_t)s->models + 1, sizeof *needed);
    Status         status = needed ? STATUS_OK : STATUS_NO_MEMORY;
    h->part_first = calloc((size_t)s->models + 1, sizeof *h->part_first);
    h->mover_of = malloc(((size_t)s->objects + 1) * sizeof *h->mover_of);
    if (!h->part_first || !h->mover_of) status = STATUS_NO_MEMORY;
    for (int m = 0; m < s->models && status == STATUS_OK; m++)
        h->part_first[m + 1] = h->part_first[m] + s->model[m].part_count;
    if (status == STATUS_OK) h->part_wall = calloc((size_t)h->part_first[s->models] + 1, sizeof *h->part_wall);
    if (!h->part_wall) status = STATUS_NO_MEMORY;
    for (int k = 0; k < s->objects && status == STATUS_OK; k++) {
        needed[s->object[k].model] |= s->object[k].state < 0;
        h->mover_of[k] = -1;
    }
    for (int k = 0; k < s->movers && status == STATUS_OK; k++) h->mover_of[s->mover[k].object] = k;
    if (status == STATUS_OK) status = find_walls(h, needed);
    for (int i = 0; i < w->count && status == STATUS_OK; i++) {
        w->wall[i].used = calloc((size_t)w->columns, sizeof *w->wall[i].used);
        if (!w->wall[i].used) status = STATUS_NO_MEMORY;
    }
    for (int k = 0; k < s->objects && status == STATUS_OK; k++)
        if (s->object[k].state < 0) use_normals(h, &s->object[k]);
    free(needed);
    return status;
}

/* ---- life -------------------------------------------------------------------------------------- */

static Status create(SceneryHeat **out, const SceneryHeatConfig *config, const Scenery *scenery)
{
    const HeatConfig *c = &config->heat;
    const double      steps = c->spin_up_s / c->step_s;
    if (!(c->facets >= 3 && c->facets <= scenery_most_facets && c->facets % 2 == 1 && c->step_s >= 60 &&
          c->step_s <= 3600 && steps >= 1 && steps <= 1e5 && fabs(c->unix_s) < 1e11))
        return STATUS_BAD_VALUE;
    if (scenery->states > scenery_most_states) {
        log_error("scenery: %d states of clutter: at most %d: fewer headings, or fewer kinds", scenery->states,
                  (int)scenery_most_states);
        return STATUS_BAD_VALUE;
    }
    SceneryHeat *h = calloc(1, sizeof *h);
    if (!h) return STATUS_NO_MEMORY;
    h->config = *config, h->scenery = scenery;
    h->constructions = *config->constructions;
    h->ground = *config->ground;
    h->config.constructions = &h->constructions, h->config.ground = &h->ground;
    h->walls.config = h->states.config = &h->config;
    h->walls.columns = c->facets * c->facets + heat_ups;
    h->states.scenery = scenery;
    h->walls.wall = calloc(scenery_most_walls, sizeof *h->walls.wall);
    if (!h->walls.wall) {
        free(h);
        return STATUS_NO_MEMORY;
    }
    *out = h;
    return STATUS_OK;
}

static Status open_all(SceneryHeat **out, SceneryHeat *h, Status status)
{
    if (status == STATUS_OK) status = scenery_walls_open(&h->walls, h->config.materials);
    if (status == STATUS_OK) status = scenery_states_open(&h->states, &h->walls);
    if (status == STATUS_OK) *out = h;
    else scenery_heat_destroy(h);
    return status;
}

Status scenery_heat_create(SceneryHeat **out, const SceneryHeatConfig *config, const Scenery *scenery)
{
    SceneryHeat *h;
    const Status status = create(&h, config, scenery);
    return status == STATUS_OK ? open_all(out, h, number_parts(h)) : status;
}

Status scenery_heat_wall(SceneryHeat **out, const SceneryHeatConfig *config, int construction, int material)
{
    static const Scenery none;
    SceneryHeat         *h;
    Status               status = create(&h, config, &none);
    if (status != STATUS_OK) return status;
    SceneryWall *wall = h->walls.wall;
    *wall = (SceneryWall){.row = construction, .material = material};
    wall->used = malloc((size_t)h->walls.columns * sizeof *wall->used);
    if (!wall->used) status = STATUS_NO_MEMORY;
    for (int c = 0; wall->used && c < h->walls.columns; c++) wall->used[c] = true;
    h->walls.count = 1;
    return open_all(out, h, status);
}

void scenery_heat_destroy(SceneryHeat *h)
{
    if (!h) return;
    scenery_states_close(&h->states);
    scenery_walls_close(&h->walls);
    free(h->part_first), free(h->part_wall), free(h->mover_of);
    free(h);
}

size_t scenery_heat_bytes(const SceneryHeat *h)
{
    return sizeof *h + scenery_walls_bytes(&h->walls) + scenery_states_bytes(&h->states);
}

/* ---- in a frame -------------------------------------------------------------------------------- */

static Status blend_walls(SceneryTemps *t, const SceneryHeat *h, double unix_s, Arena *arena)
{
    const SceneryWalls *w = &h->walls;
    const WallsTable   *a = &w->table[0], *b = &w->table[1];
    const size_t        faces = (size_t)w->count * (size_t)w->columns;
    const double        share = scenery_walls_share(w, unix_s);
    float              *face_k = arena_alloc(arena, faces + 1, sizeof *face_k);
    if (!face_k) return STATUS_NO_MEMORY;
    for (size_t i = 0; i < faces; i++) face_k[i] = a->face_k[i] + (float)share * (b->face_k[i] - a->face_k[i]);
    t->face_k = face_k, t->share = share;
    t->air_k = a->air_k + share * (b->air_k - a->air_k);
    t->sun_k = arena_alloc(arena, (size_t)w->count + 1, sizeof *t->sun_k);
    if (!t->sun_k) return STATUS_NO_MEMORY;
    for (int i = 0; i < w->count; i++)
        for (int s = 0; s < w->slots; s++)
            t->sun_k[i][s] = a->sun_k[i][s] + (float)share * (b->sun_k[i][s] - a->sun_k[i][s]);
    return STATUS_OK;
}

Status scenery_temps_at(SceneryTemps **out, SceneryHeat *h, double unix_s, Arena *arena)
{
    const Scenery *s = h->scenery;
    if (!(fabs(unix_s) < 1e11)) return STATUS_BAD_VALUE;
    SceneryTemps *t = arena_alloc(arena, 1, sizeof *t);
    if (!t) return STATUS_NO_MEMORY;
    *t = (SceneryTemps){.heat = h, .unix_s = unix_s};
    Status status = scenery_states_advance(&h->states, &h->walls, unix_s);
    scenery_walls_advance(&h->walls, unix_s);
    if (status == STATUS_OK) status = blend_walls(t, h, unix_s, arena);
    if (status == STATUS_OK) status = scenery_states_show(&t->patch_k, &t->first, &h->states, unix_s, arena);
    if (status == STATUS_OK) t->r_enu_from_body = arena_alloc(arena, (size_t)s->movers + 1, sizeof *t->r_enu_from_body);
    if (status != STATUS_OK || !t->r_enu_from_body) return status == STATUS_OK ? STATUS_NO_MEMORY : status;
    for (int k = 0; k < s->movers; k++) {
        double p_enu[3];
        scenery_pose(p_enu, t->r_enu_from_body[k], s, &s->mover[k], unix_s - h->config.heat.unix_s);
    }
    scenery_walls_ahead(&h->walls);
    *out = t;
    return STATUS_OK;
}

/* Between the four nodes about a normal: bilinear, but in two triangles where the hemisphere is folded between them
 * (n_east or n_north changes sign), along the fold, for what faces one of the four winds lies on it. */
static double blend(const float *at, int cell, int facets, const double s[2])
{
    const double a = (double)at[0], b = (double)at[1], c = (double)at[facets], d = (double)at[facets + 1];
    const int    i = cell % facets, j = cell / facets;
    if (i == j) return s[0] >= s[1] ? a + s[0] * (b - a) + s[1] * (d - b) : a + s[1] * (c - a) + s[0] * (d - c);
    if (i + j == facets - 2)
        return s[0] + s[1] <= 1 ? a + s[0] * (b - a) + s[1] * (c - a) : d + (1 - s[0]) * (c - d) + (1 - s[1]) * (b - d);
    const double low = a + s[0] * (b - a), high = c + s[0] * (d - c);
    return low + s[1] * (high - low);
}

/* Kelvins that the sun of the day past has left on a normal, by the wall's memory; and the share of them that shade
 * took (of 255 of each slot; NULL: none). */
static double sun_of_day(double *taken, const SceneryTemps *t, int wall, const double n_enu[3], const uint8_t *shadow)
{
    const SceneryWalls *w = &t->heat->walls;
    double              all = 0, lost = 0;
    for (int s = 0; s < w->slots; s++) {
        const double k = scenery_walls_cosine(w, wall, s, n_enu) * (double)t->sun_k[wall][s];
        all += k, lost += shadow ? k * shadow[s] : 0;
    }
    *taken = all > 1e-3 ? clamp(lost / (255 * all), 0, 1) : 0;
    return all;
}

/* In the sun, and in its shade, where it leaves all but sun_k of this normal to the facets: that has a kink where it
 * grazes. */
static void facets_k(double *lit_k, double *shade_k, const SceneryTemps *t, int wall, const double n_enu[3],
                     double sun_k)
{
    const SceneryWalls *w = &t->heat->walls;
    const int           facets = t->heat->config.heat.facets;
    const float        *k = t->face_k + (size_t)wall * (size_t)w->columns;
    double              share[2];
    const int           cell = scenery_facet(share, facets, n_enu);
    const double        up = clamp(n_enu[2], 0, 1) * (heat_ups - 1);
    const int           node = (int)fmin(up, heat_ups - 2);
    const float        *shade = k + facets * facets + node;
    *shade_k = (double)shade[0] + (up - node) * (double)(shade[1] - shade[0]);
    *lit_k = n_enu[2] > -0.999 ? blend(k + cell, cell, facets, share) + sun_k : *shade_k;
}

void scenery_wall_seen(WallSeen *out, const SceneryTemps *t, const double n_enu[3], double taken)
{
    const SceneryHeat  *h = t->heat;
    const SceneryWalls *w = &h->walls;
    const WallsTable   *a = &w->table[0], *b = &w->table[1];
    double              sun_k, shade_k, none, ground_k = 0;
    GroundWeather       weather;
    WallFlux            flux;
    h->config.heat.weather(&weather, t->unix_s, h->config.heat.user);
    for (int k = about_grass; k <= about_paved; k++)
        ground_k += 0.5 * (a->about_k[k] + t->share * (b->about_k[k] - a->about_k[k]));
    facets_k(&sun_k, &shade_k, t, 0, n_enu, sun_of_day(&none, t, 0, n_enu, NULL));
    const WallFace  face = {{n_enu[0], n_enu[1], n_enu[2]}, 1 - taken};
    const WallPlace place = {&weather, ground_k, w->ground_rho};
    wall_flux(&flux, &w->wall[0].kind, &place, &face);
    const double temp_k = sun_k + taken * (shade_k - sun_k);
    *out = (WallSeen){.temp_k = temp_k,
                      .behind_k = a->behind_k[0] + t->share * (b->behind_k[0] - a->behind_k[0]),
                      .air_k = weather.air.temp_k,
                      .ground_k = ground_k,
                      .absorbed_w_m2 = flux.absorbed_w_m2,
                      .direct_w_m2 = weather.direct_w_m2,
                      .diffuse_w_m2 = weather.diffuse_w_m2,
                      .longwave_w_m2 = weather.longwave_w_m2,
                      .film_w_m2k = wall_film_w_m2k(&flux, temp_k, n_enu[2])};
}

/* With all of the sun of the day past, and with none of it; returns the share of it that was taken. Before a wall the
 * map is asked a cell out of it, for its own cell may be as high as its roof. */
static double wall_in_sun(double *lit_k, double *shade_k, const SceneryTemps *t, int wall, const SceneryObject *o,
                          const double p_body[3], const double n_enu[3])
{
    static const double roof_up = 0.5;
    const SceneryHeat  *h = t->heat;
    uint8_t             shadow[shadow_most_slots];
    double              taken, open;
    if (h->config.shadow) {
        double p_enu[3];
        m3_mul_v3(p_enu, o->r_enu_from_body, p_body);
        v3_add(p_enu, p_enu, o->p_enu);
        v3_add_scaled(p_enu, p_enu, n_enu[2] < roof_up ? heat_shadow_cell_m(h->config.shadow) : 0, n_enu);
        heat_shadow_at(shadow, &open, h->config.shadow, p_enu[0], p_enu[1]);
    }
    const double sun_k = sun_of_day(&taken, t, wall, n_enu, h->config.shadow ? shadow : NULL);
    facets_k(lit_k, shade_k, t, wall, n_enu, sun_k);
    return taken;
}

static double wall_k(const SceneryTemps *t, int wall, const SceneryObject *o, const double p_body[3],
                     const double n_enu[3])
{
    double       lit_k, shade_k;
    const double taken = wall_in_sun(&lit_k, &shade_k, t, wall, o, p_body, n_enu);
    return lit_k + taken * (shade_k - lit_k);
}

/* A place of clutter in the axes of its part's node, and the patches there; NULL: none are known. */
static const Patches *patches_at(double p_node[3], double n_node[3], const SceneryTemps *t, int object, int part,
                                 const double p_body[3], const double n_enu[3])
{
    const SceneryHeat   *h = t->heat;
    const SceneryObject *o = &h->scenery->object[object];
    if (!t->first || t->first[o->state] < 0) return NULL;
    const int       mover = h->mover_of[object], first = h->states.entity[o->state].first_node;
    const double   *r = mover >= 0 ? t->r_enu_from_body[mover] : o->r_enu_from_body;
    const NodePose *node = &h->states.node[first + h->scenery->model[o->model].part[part].node];
    double          n_body[3], from[3];
    m3_tmul_v3(n_body, r, n_enu);
    v3_sub(from, p_body, node->p_body);
    m3_tmul_v3(p_node, node->r_body_from_node, from);
    m3_tmul_v3(n_node, node->r_body_from_node, n_body);
    return &h->states.patches.of[h->scenery->state[o->state].model];
}

double scenery_temp_k(const SceneryTemps *t, int object, int part, const double p_body[3], const double n_enu[3])
{
    const SceneryHeat   *h = t->heat;
    const SceneryObject *o = &h->scenery->object[object];
    double               p_node[3], n_node[3];
    if (part < 0 || part >= h->scenery->model[o->model].part_count) return t->air_k;
    if (o->state < 0) return wall_k(t, h->part_wall[h->part_first[o->model] + part], o, p_body, n_enu);
    const Patches *patches = patches_at(p_node, n_node, t, object, part, p_body, n_enu);
    return patches ? patches_value(patches, t->patch_k + t->first[o->state], part, p_node, n_node) : t->air_k;
}

/* ---- where it comes from ----------------------------------------------------------------------- */

/* Keeps the largest shares; the temperature is linear in those of the patches. */
static void find_sources(SceneryHeatOf *out, const Patches *patches, const float *patch_k, int part,
                         const double p_node[3], const double n_node[3])
{
    float one[patches_most] = {0};
    for (int k = 0; k < patches->count && k < patches_most; k++) {
        one[k] = 1;
        const double share = patches_value(patches, one, part, p_node, n_node);
        one[k] = 0;
        if (!(share > 0)) continue;
        int at = out->patches < scenery_most_sources ? out->patches++ : scenery_most_sources - 1;
        if (at == scenery_most_sources - 1 && out->patch[at].share >= share) continue;
        for (; at > 0 && out->patch[at - 1].share < share; at--) out->patch[at] = out->patch[at - 1];
        out->patch[at].index = k, out->patch[at].share = share;
        out->patch[at].role = patches->patch[k].role, out->patch[at].temp_k = (double)patch_k[k];
    }
}

void scenery_heat_of(SceneryHeatOf *out, const SceneryTemps *t, int object, int part, const double p_body[3],
                     const double n_enu[3])
{
    const SceneryHeat   *h = t->heat;
    const SceneryObject *o = &h->scenery->object[object];
    double               p_node[3], n_node[3];
    *out = (SceneryHeatOf){.sun_k = NAN, .shade_k = NAN, .behind_k = NAN};
    if (part < 0 || part >= h->scenery->model[o->model].part_count) return;
    if (o->state < 0) {
        const int           wall = h->part_wall[h->part_first[o->model] + part];
        const SceneryWalls *w = &h->walls;
        const double        a_k = w->table[0].behind_k[wall], b_k = w->table[1].behind_k[wall];
        out->of = &w->wall[wall].kind.of;
        out->taken = wall_in_sun(&out->sun_k, &out->shade_k, t, wall, o, p_body, n_enu);
        out->behind_k = a_k + t->share * (b_k - a_k);
        return;
    }
    out->state = &h->scenery->state[o->state];
    const Patches *patches = patches_at(p_node, n_node, t, object, part, p_body, n_enu);
    if (patches) find_sources(out, patches, t->patch_k + t->first[o->state], part, p_node, n_node);
}
