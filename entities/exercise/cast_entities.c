/* entities/exercise/cast_entities.c: from a scenario to its entities (Cast): types, routes, formations, joints, then
 * the shots. */
#include "entities/exercise/cast_private.h"

#include "dis/pdu/pdu.h"
#include "pitviper_table.h"

#include <stdlib.h>

/* ---- types ------------------------------------------------------------------------------------ */

typedef struct TypeRow {
    const char *type, *model;
} TypeRow;

static const TableColumn type_columns[] = {{"type", .type = TABLE_CELL, TABLE_AT(TypeRow, type)},
                                           {"model", .type = TABLE_CELL, TABLE_AT(TypeRow, model)}};
static const TableFormat type_format = {"catalog", type_columns, 2, .next = "etc/catalog.csv explains the columns"};

/* Whether a row's type is of any country: of a whole category, not of one vehicle that looks like it. */
static bool is_of_any_country(const char *type)
{
    for (int dots = 0; *type && dots < 2; type++) dots += *type == '.';
    return *type == '*';
}

/* The first row of the catalog with this model that is of any country, else the first; its wildcards become 0. */
static bool type_of_model(DisEntityType *out, const TableRows *catalog, const char *model)
{
    int best = -1;
    for (int row = 0; row < catalog->table.rows; row++) {
        if (strcmp(table_rows_text(catalog, row, "model"), model) != 0) continue;
        if (best < 0) best = row;
        if (!is_of_any_country(table_rows_text(catalog, row, "type"))) continue;
        best = row;
        break;
    }
    if (best < 0) return false;
    char text[scenario_type_size], *to = text;
    int  fields = 1;
    for (const char *at = table_rows_text(catalog, best, "type"); *at && to < text + sizeof text - 16; at++) {
        fields += *at == '.';
        *to++ = *at == '*' ? '0' : *at;
    }
    for (; fields < 7; fields++) *to++ = '.', *to++ = '0';
    *to = 0;
    return scenario_type_parse(out, text);
}

static bool find_type(DisEntityType *out, const Cast *cast, const TableRows *catalog, int line, const char *list,
                      const char *type)
{
    if (scenario_type_parse(out, type) || type_of_model(out, catalog, type)) return true;
    char shown[128], known[512];
    int  n = 0;
    text_escape(shown, sizeof shown, type, strlen(type));
    known[0] = 0;
    for (int row = 0; row < catalog->table.rows; row++) {
        const char *model = table_rows_text(catalog, row, "model");
        bool        met = false;
        for (int k = 0; k < row && !met; k++) met = strcmp(table_rows_text(catalog, k, "model"), model) == 0;
        if (!met && n < (int)sizeof known - 80)
            n += snprintf(known + n, sizeof known - (size_t)n, "%s%.64s", n ? ", " : "", model);
    }
    log_error("scenario: %s:%d: %s: type: '%s' is neither seven numbers with dots nor one of %s (etc/catalog.csv)",
              cast->scenario->path, line, list, shown, known);
    return false;
}

static Carriage carriage_of(DisEntityType type)
{
    enum { sea = 3, undersea = 4 };
    if (type.kind == dis_kind_munition) return CARRIAGE_MUNITION;
    if (type.kind == dis_kind_life_form) return CARRIAGE_LIFE;
    if (type.kind == dis_kind_platform && type.domain == dis_domain_air)
        return (type.category >= 20 && type.category <= 26) || (type.category >= 90 && type.category <= 92)
                   ? CARRIAGE_ROTARY
                   : CARRIAGE_FIXED_WING;
    if (type.kind == dis_kind_platform && (type.domain == sea || type.domain == undersea)) return CARRIAGE_SEA;
    return CARRIAGE_LAND;
}

/* ---- joints ----------------------------------------------------------------------------------- */

/* Primary turret, gun and launcher of the type's model; offset of its joints, -1: none, -2: no memory. */
static int joints_of(Cast *cast, const Catalog *catalog, DisEntityType type)
{
    const Model *model = catalog_model(catalog, catalog_find(catalog, type, NULL, NULL));
    CastJoint    joint[cast_max_joints] = {{0}};
    int          count = 0;
    for (int n = 0; n < model->node_count && count < cast_max_joints; n++) {
        const ModelNode *node = &model->node[n];
        const bool       turret = node->dis_class == 4096 && node->dis_metric == 11;
        const bool       gun = (node->dis_class == 4416 || node->dis_class == 4736) && node->dis_metric == 13;
        if (turret || gun) joint[count++] = (CastJoint){node->dis_class, node->dis_metric, node->low, node->high};
    }
    if (count == 0) return -1;
    CastJoint *more = realloc(cast->joint, ((size_t)cast->joint_count + cast_max_joints) * sizeof *more);
    if (!more) return -2;
    cast->joint = more;
    memcpy(more + cast->joint_count, joint, sizeof joint);
    cast->joint_count += cast_max_joints;
    return cast->joint_count - cast_max_joints;
}

/* ---- routes ----------------------------------------------------------------------------------- */

static void turned(double out[2], const Scenario *s, const double xy[2])
{
    const double c = cos(s->place.turn_deg * rad_per_deg), d = sin(s->place.turn_deg * rad_per_deg);
    out[0] = c * xy[0] + d * xy[1];
    out[1] = c * xy[1] - d * xy[0];
}

/* Over real ground a path may meet a ridge between its points: it then goes over what lies within a hundredth or so of
 * its length ahead and behind, at its height. One that stays above half its height everywhere is left as it is. */
static Status over_ridges(Route *route, const ExerciseGround *ground, double height_m)
{
    enum { points = 120, fine = 8, samples = points * fine };
    double    *z = malloc((samples + 1) * sizeof *z), point[points + 1][3];
    bool       clear = true;
    RoutePoint at;
    if (!z) return STATUS_NO_MEMORY;
    for (int n = 0; n <= samples; n++) {
        route_at(&at, route, route->length_m * n / samples);
        z[n] = exercise_ground_at(NULL, ground, at.p[0], at.p[1]) + height_m;
        clear &= at.p[2] > z[n] - 0.5 * height_m;
    }
    for (int i = 0; i <= points && !clear; i++) {
        route_at(&at, route, route->length_m * i / points);
        memcpy(point[i], at.p, sizeof point[i]);
        for (int n = fine * (i - 1); n <= fine * (i + 1); n++) {
            const int m = route->loop ? (n + samples) % samples : (int)clamp(n, 0, samples);
            point[i][2] = n == fine * (i - 1) ? z[m] : fmax(point[i][2], z[m]);
        }
    }
    free(z);
    if (clear || route->length_m < points) return STATUS_OK;
    Route        higher = {0};
    const Status status = route_create(&higher, (const double(*)[3])point, points + !route->loop, route->loop);
    if (status != STATUS_OK) return status;
    route_destroy(route);
    *route = higher;
    return STATUS_OK;
}

static Status make_route(Cast *cast, int group, bool flies)
{
    const Scenario      *s = cast->scenario;
    const ScenarioGroup *g = &s->group[group];
    double               point[route_max_points][3];
    int                  count = g->route_m.count / 2;
    for (int i = 0; i < count; i++) {
        turned(point[i], s, &g->route_m.number[2 * i]);
        point[i][2] = flies ? exercise_ground_at(NULL, &cast->ground, point[i][0], point[i][1]) + g->height_m : 0;
    }
    if (count == 1) { /* stationary: a metre of route gives its heading */
        const double heading_rad = ((isnan(g->heading_deg) ? 0 : g->heading_deg) + s->place.turn_deg) * rad_per_deg;
        memcpy(point[1], point[0], sizeof point[1]);
        point[1][0] += sin(heading_rad);
        point[1][1] += cos(heading_rad);
        count = 2;
    }
    Route       *route = &cast->route[group];
    const Status status = route_create(route, (const double(*)[3])point, count, g->loop);
    return status == STATUS_OK && flies && cast->ground.real ? over_ridges(route, &cast->ground, g->height_m) : status;
}

/* When a group starts to stop: as given, or so that its first entity stops at the end of the route. */
static double stop_time(const Cast *cast, int group, Carriage carriage)
{
    const ScenarioGroup *g = &cast->scenario->group[group];
    if (!isnan(g->stop_s)) return g->stop_s;
    if (g->loop || g->speed_mps <= 0 || carriage == CARRIAGE_FIXED_WING) return INFINITY;
    const double way_m = cast->route[group].length_m + g->behind_m - 0.5 * cast_ramp_s * g->speed_mps;
    if (isnan(g->start_s)) return way_m / g->speed_mps;
    return g->start_s + fmax(way_m / g->speed_mps + 0.5 * cast_ramp_s, cast_ramp_s);
}

/* ---- all entities ----------------------------------------------------------------------------- */

/* Nets are in the formation of what they cover. */
static Status cast_nets(Cast *cast, const ScenarioGroup *g, int first, int first_id, const CastEntity *like, int size)
{
    int under = 0;
    for (int k = 0; k < g->over - 1; k++) under += scenario_group_size(cast->scenario, &cast->scenario->group[k]);
    for (int k = 0; k < size; k++) {
        CastEntity e = *like;
        e.number = (uint16_t)(first_id + k);
        e.behind_m = cast->entity[under + k].behind_m;
        e.aside_m = cast->entity[under + k].aside_m;
        cast->entity[first + k] = e;
    }
    return STATUS_OK;
}

static Status cast_group(Cast *cast, int group, int first, int first_id, const TableRows *types, const Catalog *catalog)
{
    const Scenario      *s = cast->scenario;
    const ScenarioGroup *g = &s->group[group];
    CastEntity           e = {.force = (uint8_t)g->force,
                              .group = group,
                              .round = -1,
                              .joints = -1,
                              .own = -1,
                              .hit_s = INFINITY,
                              .rest_s = INFINITY,
                              .algorithm = (uint8_t)(g->dead_reckoning ? g->dead_reckoning : s->dis.dead_reckoning)};
    if (!find_type(&e.type, cast, types, g->line, "vehicles", g->type)) return STATUS_BAD_VALUE;
    e.carriage = carriage_of(e.type);
    if (g->parked && (e.carriage == CARRIAGE_ROTARY || e.carriage == CARRIAGE_FIXED_WING)) e.carriage = CARRIAGE_LAND;
    if (e.carriage == CARRIAGE_MUNITION) {
        log_error("scenario: %s:%d: vehicles: type: '%s' is a munition; those fly by a shot", s->path, g->line,
                  g->type);
        return STATUS_BAD_VALUE;
    }
    const bool flies = e.carriage == CARRIAGE_ROTARY || e.carriage == CARRIAGE_FIXED_WING;
    Status     status = make_route(cast, group, flies);
    if (status != STATUS_OK) return status;
    cast->stop_s[group] = stop_time(cast, group, e.carriage);
    if (g->turret != SCENARIO_TURRET_NONE && (e.joints = joints_of(cast, catalog, e.type)) == -2)
        return STATUS_NO_MEMORY;

    const int size = scenario_group_size(s, g);
    if (g->over) return cast_nets(cast, g, first, first_id, &e, size);
    for (int k = 0; k < size; k++) {
        const uint64_t at = 2 * (uint64_t)(first + k);
        const double   u = 2 * random_uniform((uint64_t)s->seed, 4, 0, at) - 1;
        const double   v = 2 * random_uniform((uint64_t)s->seed, 4, 0, at + 1) - 1;
        e.number = (uint16_t)(first_id + k);
        e.behind_m = (float)(g->behind_m + k / g->columns * g->spacing_m + u * g->spread_m);
        e.aside_m = (float)((k % g->columns - 0.5 * (g->columns - 1)) * g->column_m + v * g->spread_m);
        cast->entity[first + k] = e;
    }
    return STATUS_OK;
}

static Status cast_shot(Cast *cast, int shot, int *entity, int *round, int first_id, const TableRows *types)
{
    const Scenario     *s = cast->scenario;
    const ScenarioShot *each = &s->shot[shot];
    DisEntityType       type;
    if (!find_type(&type, cast, types, each->line, "shots", each->type)) return STATUS_BAD_VALUE;
    for (int k = 0; k < each->rounds; k++, (*round)++) {
        cast->round[*round] = (CastRound){.shot = shot,
                                          .munition = -1,
                                          .target = -1,
                                          .type = type,
                                          .fire_s = each->time_s + k * each->every_s,
                                          .impact_s = INFINITY,
                                          .flight = -1};
        if (!each->entity) continue;
        cast->entity[*entity] =
            (CastEntity){.type = type,
                         .number = (uint16_t)(first_id + k),
                         .force = (uint8_t)each->force,
                         .carriage = CARRIAGE_MUNITION,
                         .algorithm = (uint8_t)(each->dead_reckoning ? each->dead_reckoning : s->dis.dead_reckoning),
                         .group = -1,
                         .round = *round,
                         .joints = -1,
                         .own = -1,
                         .hit_s = INFINITY,
                         .rest_s = INFINITY};
        cast->round[*round].munition = (*entity)++;
    }
    return STATUS_OK;
}

static bool needs_models(const Scenario *s)
{
    for (int i = 0; i < s->group_count; i++)
        if (s->group[i].turret != SCENARIO_TURRET_NONE || s->group[i].hide != SCENARIO_HIDE_NONE || s->group[i].over)
            return true;
    return s->ground.planted && s->ground.buildings; /* which make room for them */
}

static Status fill(Cast *cast, int *ids, int *first, const HideJudge *judge)
{
    static const double coarse_chord_error_m = 0.1; /* joints, and roughly what is seen of a shape */
    const Scenario     *s = cast->scenario;
    char                path[4096];
    TableRows           types;
    Catalog            *catalog = NULL;
    int                 entity = 0, round = 0;
    if (!etc_path(path, sizeof path, "catalog.csv")) return STATUS_BAD_VALUE;
    Status status = table_rows_open(&types, &type_format, path);
    if (status != STATUS_OK) return status;
    if (needs_models(s)) status = catalog_open(&catalog, path, coarse_chord_error_m);
    for (int g = 0; g < s->group_count && status == STATUS_OK; g++) {
        first[g] = entity;
        status = cast_group(cast, g, entity, ids[g], &types, catalog);
        entity += scenario_group_size(s, &s->group[g]);
    }
    for (int i = 0; i < s->shot_count && status == STATUS_OK; i++)
        status = cast_shot(cast, i, &entity, &round, ids[s->group_count + i], &types);
    if (status == STATUS_OK && catalog) status = cast_hide(cast, ids, first, catalog, judge);
    if (catalog) catalog_close(catalog);
    table_rows_close(&types);
    return status == STATUS_OK ? cast_solve_shots(cast, ids, first) : status;
}

Status cast_create(Cast **out, const Scenario *scenario) { return cast_create_judged(out, scenario, NULL); }

static Status create(Cast **out, const Scenario *scenario, const HideJudge *judge, bool held)
{
    Cast *cast = calloc(1, sizeof *cast);
    if (!cast) return STATUS_NO_MEMORY;
    cast->scenario = scenario;
    cast->held = held;
    for (int i = 0; i < scenario->group_count; i++)
        cast->entity_count += scenario_group_size(scenario, &scenario->group[i]);
    for (int i = 0; i < scenario->shot_count; i++) {
        cast->round_count += scenario->shot[i].rounds;
        if (scenario->shot[i].entity) cast->entity_count += scenario->shot[i].rounds;
    }
    const size_t groups = (size_t)scenario->group_count, items = groups + (size_t)scenario->shot_count;
    cast->entity = calloc((size_t)cast->entity_count + 1, sizeof *cast->entity);
    cast->round = calloc((size_t)cast->round_count + 1, sizeof *cast->round);
    cast->route = calloc(groups + 1, sizeof *cast->route);
    cast->stop_s = calloc(groups + 1, sizeof *cast->stop_s);
    int *ids = calloc(items + 1, sizeof *ids), *first = calloc(groups + 1, sizeof *first);

    const bool whole = cast->entity && cast->round && cast->route && cast->stop_s && ids && first;
    Status     status = whole ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK && !scenario_ids(ids, scenario)) status = STATUS_BAD_VALUE;
    if (status == STATUS_OK) status = exercise_ground_create(&cast->ground, scenario);
    if (status == STATUS_OK) status = fill(cast, ids, first, judge);
    free(ids);
    free(first);
    if (status == STATUS_OK) *out = cast;
    else cast_destroy(cast);
    return status;
}

Status cast_create_judged(Cast **out, const Scenario *scenario, const HideJudge *judge)
{
    return create(out, scenario, judge, false);
}

Status cast_create_held(Cast **out, const Scenario *scenario, const HideJudge *judge)
{
    return create(out, scenario, judge, true);
}

void cast_destroy(Cast *cast)
{
    if (!cast) return;
    for (int g = 0; cast->route && g < cast->scenario->group_count; g++) route_destroy(&cast->route[g]);
    exercise_ground_destroy(&cast->ground);
    free(cast->entity);
    free(cast->round);
    free(cast->joint);
    free(cast->route);
    free(cast->stop_s);
    free(cast->hidden);
    for (int k = 0; k < cast->flight_count; k++) free(cast->flight[k].sample);
    free(cast->flight);
    free(cast);
}
