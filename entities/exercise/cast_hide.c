/* entities/exercise/cast_hide.c: places of the entities that hide, and of the nets over entities. */
#include "entities/exercise/cast_private.h"

#include "entities/exercise/hide.h"
#include "terrain/culture/culture_give_way.h"
#include "terrain/culture/culture_ground.h"

#include <stdlib.h>

/* Of the landscape's own ENU, as hide_find has them; and back: x and y of the plane of the place. */
static void to_landscape(double out[3], const Cast *cast, double x_m, double y_m)
{
    const double p_enu[3] = {x_m, y_m, exercise_ground_at(NULL, &cast->ground, x_m, y_m)};
    double       p_ecef[3];
    ecef_from_enu(p_ecef, &cast->ground.frame, p_enu);
    enu_from_ecef(out, &cast->ground.stored.frame, p_ecef);
}

static void from_landscape(double *x_m, double *y_m, const Cast *cast, const double p_land[3])
{
    double p_ecef[3], p_enu[3];
    ecef_from_enu(p_ecef, &cast->ground.stored.frame, p_land);
    enu_from_ecef(p_enu, &cast->ground.frame, p_ecef);
    *x_m = p_enu[0], *y_m = p_enu[1];
}

static const Model *model_of(const Catalog *catalog, DisEntityType type)
{
    return catalog_model(catalog, catalog_find(catalog, type, NULL, NULL));
}

/* What is named by `beside`, on the landscape. */
static Status box_of(HideBox *out, const Cast *cast, int entity, const Catalog *catalog)
{
    const Model *model = model_of(catalog, cast->entity[entity].type);
    CastPose     pose;
    cast_pose(&pose, cast, entity, 0);
    double p_land[3];
    to_landscape(p_land, cast, pose.p_enu[0], pose.p_enu[1]);
    const double level = fmax(hypot(pose.r_enu_from_body[0], pose.r_enu_from_body[3]), 1e-9);
    *out = (HideBox){.p_enu = {p_land[0], p_land[1], p_land[2]},
                     .nose = {pose.r_enu_from_body[0] / level, pose.r_enu_from_body[3] / level}};
    return hide_shape_open(&out->shape, model);
}

typedef struct Hiding {
    Cast          *cast;
    const int     *ids, *first;
    const Catalog *catalog;
    HideSight      sight;
    double (*taken)[2]; /* [cast->hidden_count] of the landscape */
    HideWorld world;
    int       left_out; /* as HideFound's, the most of any vehicle */
} Hiding;

static double planned_of(const Scenario *s, const ScenarioGroup *g, int entity)
{
    if (!isnan(g->occlusion)) return g->occlusion;
    return g->hide == SCENARIO_HIDE_OPEN ? 0 : 0.1 + 0.8 * random_uniform((uint64_t)s->seed, 10, 0, (uint64_t)entity);
}

static Status hide_one(Hiding *h, const HideGround *ground, int group, int entity, const double about_land[3])
{
    Cast                *cast = h->cast;
    const Scenario      *s = cast->scenario;
    const ScenarioGroup *g = &s->group[group];
    HideBox              box = {0};
    HideFound            found = {0};
    HideWish             wish = {.kind = g->hide,
                                 .about_m = {about_land[0], about_land[1]},
                                 .within_m = g->hide_m,
                                 .occlusion = planned_of(s, g, entity),
                                 .heading_rad = (g->heading_deg + s->place.turn_deg) * rad_per_deg, /* NaN: drawn */
                                 .taken = (const double(*)[2])h->taken,
                                 .taken_count = cast->hidden_count,
                                 .seed = (uint64_t)s->seed,
                                 .number = (uint64_t)entity};
    if (g->hide == SCENARIO_HIDE_BESIDE) {
        int at, member;
        scenario_find(&at, &member, s, h->ids, g->beside);
        const Status status = box_of(&box, cast, h->first[at] + member, h->catalog);
        if (status != STATUS_OK) return status;
        wish.beside = &box;
    }
    const Status shaped = hide_shape_open(&wish.shape, model_of(h->catalog, cast->entity[entity].type));
    const bool   any = shaped == STATUS_OK && hide_find(&found, ground, &wish, &h->sight);
    hide_shape_close(&box.shape);
    hide_shape_close(&wish.shape);
    if (shaped != STATUS_OK) return shaped;
    if (!any) {
        log_error("scenario: %s:%d: vehicles: hide: within %g m of route_m there is no room at a place of kind %s; try "
                  "hide_m, another place or another ground.seed",
                  s->path, g->line, g->hide_m, scenario_hide_name(g->hide));
        return STATUS_BAD_VALUE;
    }
    if (found.left_out > h->left_out) h->left_out = found.left_out;
    CastHidden *own = &cast->hidden[cast->hidden_count];
    *own = (CastHidden){.planned = wish.occlusion, .judged = found.occlusion, .entity = entity, .fit = found.fit};
    own->heading_rad = found.heading_rad;
    from_landscape(&own->x_m, &own->y_m, cast, found.pose.p_enu);
    for (int k = 0; k < 2; k++) h->taken[cast->hidden_count][k] = found.pose.p_enu[k];
    cast->entity[entity].own = cast->hidden_count++;
    return STATUS_OK;
}

static Status hide_group(Hiding *h, int group)
{
    static const double  sight_m = 320; /* so far plants can hide what is not low on the horizon */
    Cast                *cast = h->cast;
    const Scenario      *s = cast->scenario;
    const ScenarioGroup *g = &s->group[group];
    Status               status = STATUS_OK;
    if (g->hide == SCENARIO_HIDE_NONE) return STATUS_OK;
    if (cast->entity[h->first[group]].carriage != CARRIAGE_LAND) {
        log_error("scenario: %s:%d: vehicles: hide: what hides is a vehicle on land", s->path, g->line);
        return STATUS_BAD_VALUE;
    }
    for (int k = 0; k < scenario_group_size(s, g) && status == STATUS_OK; k++) {
        const int  entity = h->first[group] + k;
        HideGround ground = {0};
        CastPose   pose;
        double     about_land[3];
        cast_pose(&pose, cast, entity, 0); /* its place in the formation */
        to_landscape(about_land, cast, pose.p_enu[0], pose.p_enu[1]);
        status = hide_ground_open(&ground, &h->world, about_land, g->hide_m + sight_m);
        if (status == STATUS_OK) status = hide_one(h, &ground, group, entity, about_land);
        hide_ground_close(&ground);
    }
    return status;
}

/* A net has the size of what it covers, and its place. */
static void lay_nets(Hiding *h, int group)
{
    static const struct {
        double long_m, high_m; /* the longest and highest that it covers */
    } size[] = {{6.5, 2.4}, {10.8, 3.3}};
    Cast                *cast = h->cast;
    const ScenarioGroup *g = &cast->scenario->group[group];
    if (!g->over) return;
    for (int k = 0; k < scenario_group_size(cast->scenario, g); k++) {
        CastEntity       *net = &cast->entity[h->first[group] + k];
        const CastEntity *under = &cast->entity[h->first[g->over - 1] + k];
        const Model      *model = model_of(h->catalog, under->type);
        int               which = 0;
        while (which < 2 && (model->length_m > size[which].long_m || model->height_m > size[which].high_m)) which++;
        net->type.subcategory = (uint8_t)(which + 1);
        net->own = under->own;
    }
}

/* What is built makes room for vehicles that stand where they are told or drive, as it does in a node that replays
 * their log. */
static Status clear_routes(Cast *cast, const Catalog *catalog)
{
    enum { most_steps = 4000 };
    static const double step_s = 0.5, room_m = 0.25;
    const int           steps = (int)clamp(cast->scenario->duration_s / step_s, 1, most_steps);
    const double        dt_s = cast->scenario->duration_s / steps;
    DrivenPath         *path = malloc((size_t)steps * sizeof *path);
    Status              status = path ? STATUS_OK : STATUS_NO_MEMORY;
    int                 all = 0;
    for (int n = 0; n < cast->entity_count && status == STATUS_OK; n++) {
        const CastEntity *e = &cast->entity[n];
        const Model      *m = model_of(catalog, e->type);
        double            last[3];
        int               count = 0, taken;
        CastPose          pose;
        if (e->carriage != CARRIAGE_LAND || cast->scenario->group[e->group].hide != SCENARIO_HIDE_NONE ||
            cast->scenario->group[e->group].over)
            continue;
        for (int k = 0; k <= steps; k++) {
            double here[3];
            cast_pose(&pose, cast, n, k * dt_s);
            to_landscape(here, cast, pose.p_enu[0], pose.p_enu[1]);
            if (k == 0) memcpy(last, here, sizeof last);
            const bool moved = hypot(here[0] - last[0], here[1] - last[1]) > 0.5;
            if (k > 0 && !moved && k < steps) continue;
            if (count < steps)
                path[count++] =
                    (DrivenPath){{last[0], last[1]},
                                 {here[0], here[1]},
                                 (moved ? 0.5 * m->width_m : 0.5 * hypot(m->length_m, m->width_m)) + room_m};
            memcpy(last, here, sizeof last);
        }
        status = culture_give_way(&cast->ground.culture, &taken, path, count);
        all += taken;
    }
    free(path);
    if (all > 0)
        log_warn("scenario: %d buildings, walls and other works make room for vehicles at and along route_m; the node "
                 "that shows them leaves them out too",
                 all);
    return status;
}

Status cast_hide(Cast *cast, const int *ids, const int *first, const Catalog *catalog, const HideJudge *judge)
{
    const Scenario *s = cast->scenario;
    const Culture  *culture = cast->ground.culture.index ? &cast->ground.culture : NULL;
    Hiding          h = {cast,
                         ids,
                         first,
                         catalog,
                         hide_sight(s),
                         NULL,
                         {&cast->ground.stored, (uint64_t)s->ground.seed, culture, judge},
                         0};
    Status          status = STATUS_OK;
    int             hidden = 0;
    for (int g = 0; g < s->group_count; g++)
        hidden += s->group[g].hide != SCENARIO_HIDE_NONE ? scenario_group_size(s, &s->group[g]) : 0;
    cast->hidden = calloc((size_t)hidden + 1, sizeof *cast->hidden);
    h.taken = calloc((size_t)hidden + 1, sizeof *h.taken);
    if (!cast->hidden || !h.taken) status = STATUS_NO_MEMORY;
    if (status == STATUS_OK && culture) status = clear_routes(cast, catalog);
    if (status == STATUS_OK && culture) culture_lay(&cast->ground.stored, culture);
    for (int g = 0; g < s->group_count && status == STATUS_OK; g++) status = hide_group(&h, g);
    for (int g = 0; g < s->group_count && status == STATUS_OK; g++) lay_nets(&h, g);
    if (status == STATUS_OK && h.left_out > 0)
        log_warn(
            "scenario: hide: up to %d plants and walls' triangles between a vehicle and the observer are not looked "
            "at, more than are (%d, %d); next: a higher seen.height_m",
            h.left_out, hide_plants_most, hide_solids_most);
    free(h.taken);
    return status;
}
