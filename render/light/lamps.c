/* render/light/lamps.c: the lamps that are lit at one time, and the light that they give. */
#include "render/light/lamps.h"

enum { cells_a_side = 512 };

/* A lamp that is lit, in double: one place, one axis. */
typedef struct Source {
    double          p_enu[3], n_enu[3];
    double          candela;                   /* along the axis */
    double          reach2_m2, area_m2, power; /* power: of the cosine off the axis */
    SceneryLampKind kind;
    const LampType *type;
} Source;

struct LampLight {
    const Scenery      *scenery;
    const SceneryFrame *frame;
    int                *source_of; /* [scenery->lamps]: index + 1 of source; 0: dark */
    int                 count, columns, rows;
    Source             *source;
    double              low[2], cell_m;
    int                *first;  /* [columns * rows + 1] of listed */
    int                *listed; /* sources that reach into each cell, ascending */
};

static const double vehicle_dip = 0.01, vehicle_above = 0.02, vehicle_disc_m = 0.08, vehicle_half_gauge = 0.36;

/* ---- what is lit --------------------------------------------------------------------------------- */

static void take_source(Source *out, const SceneryLamp *l, const LampType *type, const SceneryFrame *frame)
{
    *out = (Source){.kind = (SceneryLampKind)l->kind, .type = type, .area_m2 = (double)l->area_m2, .power = 1};
    memcpy(out->p_enu, l->p, sizeof l->p), memcpy(out->n_enu, l->n, sizeof l->n);
    if (l->kind == LAMP_WINDOW) out->candela = type->luminance_cd_m2 * out->area_m2;
    else out->candela = type->flux_lm / pi_rad;
    if (l->kind == LAMP_VEHICLE) {
        const PosedEntity *e = scenery_frame_posed(frame, l->object);
        const double       aim[3] = {l->n[0], l->n[1], l->n[2] + vehicle_dip};
        m3_mul_v3(out->p_enu, e->r_enu_from_body, l->p);
        for (int k = 0; k < 3; k++) out->p_enu[k] += e->p_enu[k];
        m3_mul_v3(out->n_enu, e->r_enu_from_body, aim);
        if (!v3_normalize(out->n_enu, out->n_enu)) out->n_enu[0] = 1;
        out->power = log(0.5) / log(cos(type->beam_rad));
        out->candela = type->flux_lm * (out->power + 1) / (2 * pi_rad);
    }
    const double reach_m = fmin(sqrt(out->candela / lamp_least_lx), lamp_farthest_m[l->kind]);
    out->reach2_m2 = reach_m * reach_m;
}

static int cell_of(const LampLight *light, int axis, double at_m)
{
    const int    most = (axis ? light->rows : light->columns) - 1;
    const double cell = floor((at_m - light->low[axis]) / light->cell_m);
    return (int)clamp(cell, 0, most);
}

static Status list_cells(LampLight *light, Arena *arena)
{
    double high[2] = {-INFINITY, -INFINITY};
    light->low[0] = light->low[1] = INFINITY;
    for (int k = 0; k < light->count; k++)
        for (int a = 0; a < 2; a++) {
            const double reach_m = sqrt(light->source[k].reach2_m2);
            light->low[a] = fmin(light->low[a], light->source[k].p_enu[a] - reach_m);
            high[a] = fmax(high[a], light->source[k].p_enu[a] + reach_m);
        }
    light->cell_m = fmax(8, fmax(high[0] - light->low[0], high[1] - light->low[1]) / cells_a_side);
    light->columns = (int)((high[0] - light->low[0]) / light->cell_m) + 1;
    light->rows = (int)((high[1] - light->low[1]) / light->cell_m) + 1;
    const size_t cells = (size_t)light->columns * (size_t)light->rows;
    light->first = arena_alloc(arena, cells + 2, sizeof *light->first);
    if (!light->first) return STATUS_NO_MEMORY;
    memset(light->first, 0, (cells + 2) * sizeof *light->first);
    for (int pass = 0; pass < 2; pass++) {
        for (int k = 0; k < light->count; k++) {
            const Source *s = &light->source[k];
            const double  reach_m = sqrt(s->reach2_m2);
            const int     x0 = cell_of(light, 0, s->p_enu[0] - reach_m), x1 = cell_of(light, 0, s->p_enu[0] + reach_m);
            const int     y0 = cell_of(light, 1, s->p_enu[1] - reach_m), y1 = cell_of(light, 1, s->p_enu[1] + reach_m);
            for (int y = y0; y <= y1; y++)
                for (int x = x0; x <= x1; x++) {
                    int *at = &light->first[(size_t)y * (size_t)light->columns + (size_t)x + 1];
                    if (pass == 0) at[1]++;
                    else light->listed[(*at)++] = k;
                }
        }
        if (pass == 1) break;
        for (size_t c = 2; c <= cells + 1; c++) light->first[c] += light->first[c - 1];
        light->listed = arena_alloc(arena, (size_t)light->first[cells + 1] + 1, sizeof *light->listed);
        if (!light->listed) return STATUS_NO_MEMORY;
    }
    return STATUS_OK;
}

/* A house that was hit is dark. */
static bool is_whole(const Scenery *scenery, const SceneryFrame *frame, int object)
{
    const PosedEntity *e = scenery_frame_posed(frame, object);
    return e->model >= 0 && e->damage <= scenery->object[object].damage;
}

Status lamp_light_create(LampLight **out, const LampTypes *types, const SceneryFrame *frame, const double sun_d_enu[3],
                         double lat_rad, Arena *arena)
{
    *out = NULL;
    const Scenery *scenery = frame ? scenery_frame_of(frame) : NULL;
    if (!scenery || scenery->lamps == 0 || sun_d_enu[2] >= lamps_home_sun_up) return STATUS_OK;
    const double hour = scenery_solar_hour(sun_d_enu, lat_rad);
    LampLight   *light = arena_alloc(arena, 1, sizeof *light);
    if (!light) return STATUS_NO_MEMORY;
    *light = (LampLight){.scenery = scenery, .frame = frame};
    light->source_of = arena_alloc(arena, (size_t)scenery->lamps, sizeof *light->source_of);
    if (!light->source_of) return STATUS_NO_MEMORY;
    for (int k = 0; k < scenery->lamps; k++) {
        const SceneryLamp *l = &scenery->lamp[k];
        const bool         lit =
            lamp_type_of(types, l) && scenery_lamp_lit(l, sun_d_enu[2], hour) && is_whole(scenery, frame, l->object);
        light->source_of[k] = lit ? ++light->count : 0;
    }
    if (light->count == 0) return STATUS_OK;
    light->source = arena_alloc(arena, (size_t)light->count, sizeof *light->source);
    if (!light->source) return STATUS_NO_MEMORY;
    for (int k = 0; k < scenery->lamps; k++)
        if (light->source_of[k])
            take_source(&light->source[light->source_of[k] - 1], &scenery->lamp[k],
                        lamp_type_of(types, &scenery->lamp[k]), frame);
    const Status status = list_cells(light, arena);
    if (status == STATUS_OK) *out = light;
    return status;
}

int lamp_light_count(const LampLight *light) { return light ? light->count : 0; }

/* ---- light that falls on something ---------------------------------------------------------------- */

/* Intensity along a unit direction, cd. */
static double intensity(const Source *s, const double d_enu[3])
{
    const double along = v3_dot(s->n_enu, d_enu);
    if (!(along > 0)) return 0;
    if (s->kind != LAMP_VEHICLE) return s->candela * along;
    return s->candela * pow(along, s->power) * (d_enu[2] > 0 ? vehicle_above : 1);
}

/* lx on a plane. */
static double lux_of(const Source *s, const double p_enu[3], const double n_enu[3])
{
    double d[3], r2;
    v3_sub(d, p_enu, s->p_enu);
    r2 = v3_dot(d, d);
    const double falls = -v3_dot(n_enu, d);
    if (!(r2 < s->reach2_m2) || !(falls > 0)) return 0;
    const double r_m = sqrt(r2), part = r2 / s->reach2_m2, taper = 1 - part * part;
    v3_scale(d, 1 / r_m, d);
    return intensity(s, d) * (falls / r_m) / (r2 + s->area_m2 / pi_rad) * taper * taper;
}

/* Sources about a place. */
static int sources_at(const int **list, const LampLight *light, const double p_enu[3])
{
    const double x = (p_enu[0] - light->low[0]) / light->cell_m, y = (p_enu[1] - light->low[1]) / light->cell_m;
    if (!(x >= 0 && y >= 0 && x < light->columns && y < light->rows)) return 0;
    const size_t cell = (size_t)y * (size_t)light->columns + (size_t)x;
    *list = light->listed + light->first[cell];
    return light->first[cell + 1] - light->first[cell];
}

double lamp_light_lux(const LampLight *light, const double p_enu[3], const double n_enu[3])
{
    const int *list = NULL;
    const int  count = light ? sources_at(&list, light, p_enu) : 0;
    double     sum = 0;
    for (int k = 0; k < count; k++) sum += lux_of(&light->source[list[k]], p_enu, n_enu);
    return sum;
}

void lamp_light_irradiance(double w_m2[optical_channel_count], const LampLight *light, const double p_enu[3],
                           const double n_enu[3])
{
    const int *list = NULL;
    const int  count = light ? sources_at(&list, light, p_enu) : 0;
    for (int c = 0; c < optical_channel_count; c++) w_m2[c] = 0;
    for (int k = 0; k < count; k++) {
        const Source *s = &light->source[list[k]];
        const double  lux = lux_of(s, p_enu, n_enu);
        for (int c = 0; c < optical_channel_count && lux > 0; c++) w_m2[c] += lux * s->type->w_lm[c];
    }
}

/* ---- what shines itself ----------------------------------------------------------------------------- */

/* Whether a hit on a vehicle is on one of its lamps. */
static bool on_headlamp(const LampLight *light, const SceneryLamp *l, const Hits *hits, int i)
{
    const double n_enu[3] = {hits->n_geo[0][i], hits->n_geo[1][i], hits->n_geo[2][i]};
    double       p[3], n[3];
    scenery_frame_on_body(p, n, light->frame, hits, i, n_enu);
    const Model *m = &light->scenery->model[light->scenery->object[l->object].model];
    const double y = fabs(p[1] - l->p[1]) - vehicle_half_gauge * m->width_m, z = p[2] - l->p[2];
    return n[0] > 0.3 && p[0] > 0.4 * l->p[0] && y * y + z * z < vehicle_disc_m * vehicle_disc_m;
}

/* cd/m2 of a hit along its ray, and the lamp's type; 0: it is dark. */
static double luminance(const LampType **type, const LampLight *light, const Hits *hits, const Rays *rays, int i)
{
    if (hits->kind[i] != hit_scenery) return 0;
    const int lamp = scenery_lamp_of(light->scenery, (int)hits->instance[i] - 1, (int)hits->facet[i]);
    if (lamp < 0 || !light->source_of[lamp]) return 0;
    const Source *s = &light->source[light->source_of[lamp] - 1];
    const double  n_enu[3] = {hits->n_geo[0][i], hits->n_geo[1][i], hits->n_geo[2][i]};
    *type = s->type;
    if (s->kind == LAMP_VEHICLE) {
        const double back_enu[3] = {-rays->d_enu[0][i], -rays->d_enu[1][i], -rays->d_enu[2][i]};
        return on_headlamp(light, &light->scenery->lamp[lamp], hits, i)
                   ? intensity(s, back_enu) / (2 * pi_rad * vehicle_disc_m * vehicle_disc_m)
                   : 0;
    }
    return v3_dot(n_enu, s->n_enu) > 0.5 ? s->candela / s->area_m2 : 0;
}

void lamp_light_at(double w_m2_sr[optical_channel_count], const LampLight *light, const Materials *materials,
                   uint16_t material, const float *const texture[AIR_BAND_COUNT], unsigned channels, const Hits *hits,
                   const Rays *rays, int i)
{
    for (int c = 0; c < optical_channel_count; c++) w_m2_sr[c] = 0;
    if (!(hits->range_m[i] < INFINITY)) return;
    const double    p_enu[3] = {hits->p_enu[0][i], hits->p_enu[1][i], hits->p_enu[2][i]};
    const double    n_enu[3] = {hits->n_enu[0][i], hits->n_enu[1][i], hits->n_enu[2][i]};
    const Material *m = &materials->material[material];
    const LampType *type = NULL;
    lamp_light_irradiance(w_m2_sr, light, p_enu, n_enu);
    const double own_cd_m2 = luminance(&type, light, hits, rays, i);
    for (int c = 0; c < optical_channel_count; c++) {
        const double rho =
            channels >> c & 1 ? fmin((double)m->rho[c] * (texture[c] ? (double)texture[c][i] : 1), 1) : 0;
        w_m2_sr[c] *= rho / pi_rad;
        if (own_cd_m2 > 0) w_m2_sr[c] += own_cd_m2 * type->w_lm[c];
    }
}
