/* sensor/node/choices/harm_choice.c: which buildings an exercise damages, and when: by bursts near them, and by
 * entities of kind 5 (cultural feature) that stand for them.
 *
 * A burst of W kg (effect_charge_kg) damages to the distance R = k W^(1/3) / (1 + (3175 / W)^2)^(1/6) of a wall or
 * roof, with k = 5.6 to destruction (half of the walls of a brick house and more), 9.6 to what cannot be lived in, 28
 * to broken panes and tiles: Jarrett, Ann. N. Y. Acad. Sci. 152 (1968), with the factors of Gilbert, Lees & Scilly,
 * Loss Prevention Bulletin (1994), typed from knowledge. Nothing else is asked: what a wall is of, what it shields,
 * where a round went in. */
#include "sensor/node/choices/choices.h"

#include "entities/traces/effect_history.h"

#include <stdlib.h>

enum { bursts_most = 4096 };        /* the first */
static const double widest_m = 500; /* of a wider building a burst beyond this from its first corner is not asked */

typedef struct Harms {
    BuildingHarm *harm;
    int           count, room;
} Harms;

static Status add(Harms *to, uint64_t building, double t_s, int damage)
{
    if (to->count == to->room) {
        const int     room = to->room ? 2 * to->room : 64;
        BuildingHarm *larger = realloc(to->harm, (size_t)room * sizeof *larger);
        if (!larger) return STATUS_NO_MEMORY;
        to->harm = larger, to->room = room;
    }
    to->harm[to->count++] = (BuildingHarm){building, t_s, (uint8_t)damage};
    return STATUS_OK;
}

double choice_harm_radius(double charge_kg, int damage)
{
    static const double k[4] = {0, 28, 9.6, 5.6};
    const double        heavy = 3175 / charge_kg;
    return charge_kg > 0 && damage > 0 && damage < 4 ? k[damage] * cbrt(charge_kg) / pow(1 + heavy * heavy, 1.0 / 6)
                                                     : 0;
}

/* Distance of a place from a building's outline, 0 in it; and from its ridge or floor, m. */
static double distance_m(const Culture *c, const Building *b, const double p[3])
{
    double square = INFINITY;
    bool   in = false;
    for (int k = 0; k < b->corners; k++) {
        const double *u = c->corner_m[b->first_corner + k], *v = c->corner_m[b->first_corner + (k + 1) % b->corners];
        const double  d[2] = {v[0] - u[0], v[1] - u[1]}, q[2] = {p[0] - u[0], p[1] - u[1]};
        const double  along = clamp((q[0] * d[0] + q[1] * d[1]) / fmax(d[0] * d[0] + d[1] * d[1], 1e-12), 0, 1);
        const double  x = q[0] - along * d[0], y = q[1] - along * d[1];
        square = fmin(square, x * x + y * y);
        if ((u[1] > p[1]) != (v[1] > p[1]) && p[0] < u[0] + (p[1] - u[1]) * d[0] / d[1]) in = !in;
    }
    const double above = fmax(p[2] - (double)(b->base_m + b->ridge_m), 0),
                 below = fmax((double)b->base_m - 3 - p[2], 0);
    return hypot(in ? 0 : sqrt(square), above + below);
}

int choice_burst_damage(const Culture *culture, int building, const double p_enu[3], double charge_kg)
{
    const double away_m = distance_m(culture, &culture->building[building], p_enu);
    for (int damage = 3; damage > 0; damage--)
        if (away_m <= choice_harm_radius(charge_kg, damage)) return damage;
    return 0;
}

static Status by_burst(Harms *to, const Culture *culture, const Shot *shot, const LocalFrame *frame)
{
    const double charge_kg = (double)shot->charge_kg, reach_m = choice_harm_radius(charge_kg, 1);
    double       p[3];
    if (!isfinite(shot->detonation_s) || effect_result_is_none(shot->result) || !(charge_kg > 0)) return STATUS_OK;
    enu_from_ecef(p, frame, shot->p_burst_ecef);
    for (int k = 0; k < culture->buildings; k++) {
        const Building *b = &culture->building[k];
        const double   *corner = culture->corner_m[b->first_corner];
        if (!(hypot(corner[0] - p[0], corner[1] - p[1]) < reach_m + widest_m)) continue;
        const int damage = choice_burst_damage(culture, k, p, charge_kg);
        if (damage > b->damage && add(to, b->id, shot->detonation_s, damage) != STATUS_OK) return STATUS_NO_MEMORY;
    }
    return STATUS_OK;
}

int choice_building_of(const Culture *culture, const Catalog *catalog, DisEntityType type, int model,
                       const double p_enu[3])
{
    if (type.kind != dis_kind_cultural_feature || !culture->index || culture->buildings == 0) return -1;
    if (model >= 0 && strcmp(catalog_model(catalog, model)->name, "building") != 0) return -1; /* a net, a wall */
    return culture_building_at(culture, p_enu[0], p_enu[1], 0);
}

static Status by_entity(Harms *to, const Culture *culture, const Track *track, const ChoiceBasis *basis,
                        const LocalFrame *frame)
{
    if (track->count == 0 || track->type.kind != dis_kind_cultural_feature) return STATUS_OK;
    Origin    origin;
    int       matched, was = 0;
    const int model = catalog_find(basis->catalog, track->type, &origin, &matched);
    for (int k = 0; k < track->count; k++) {
        const TrackPoint *point = &track->point[k];
        double            p[3];
        if (point->damage <= was) continue;
        enu_from_ecef(p, frame, point->p_ecef);
        const int building = choice_building_of(culture, basis->catalog, track->type, model, p);
        was = point->damage;
        if (building >= 0 && add(to, culture->building[building].id, point->t_s, was) != STATUS_OK)
            return STATUS_NO_MEMORY;
    }
    return STATUS_OK;
}

static int in_order(const void *pa, const void *pb)
{
    const BuildingHarm *a = pa, *b = pb;
    if (a->t_s != b->t_s) return (a->t_s > b->t_s) - (a->t_s < b->t_s);
    if (a->building != b->building) return (a->building > b->building) - (a->building < b->building);
    return (a->damage < b->damage) - (a->damage > b->damage);
}

/* Leaves out what makes nothing worse. */
static void put_worse(SceneryPlan *plan, const Harms *all)
{
    int left_out = 0;
    for (int k = 0; k < all->count; k++) {
        const BuildingHarm *h = &all->harm[k];
        bool                known = false;
        for (int n = 0; n < plan->harms; n++)
            known |= plan->harm[n].building == h->building && plan->harm[n].damage >= h->damage;
        if (known) continue;
        if (plan->harms < building_harms_most) plan->harm[plan->harms++] = *h;
        else left_out++;
    }
    if (left_out > 0)
        log_warn("scenery: more than %d times that a building is damaged: the last are left out: left_out=%d",
                 (int)building_harms_most, left_out);
}

Status choice_harm(SceneryPlan *plan, const Culture *culture, const ChoiceBasis *basis, const LocalFrame *frame)
{
    const Survey *survey = basis->survey;
    Harms         all = {0};
    Status        status = STATUS_OK;
    plan->harms = 0;
    if (!culture->index || culture->buildings == 0 || !survey) return STATUS_OK;
    for (int k = 0; k < survey->shot_count && k < bursts_most && status == STATUS_OK; k++)
        status = by_burst(&all, culture, &survey->shot[k], frame);
    for (int k = 0; k < survey->track_count && status == STATUS_OK; k++)
        status = by_entity(&all, culture, &survey->track[k], basis, frame);
    if (status == STATUS_OK && all.count > 1) qsort(all.harm, (size_t)all.count, sizeof *all.harm, in_order);
    if (status == STATUS_OK) put_worse(plan, &all);
    free(all.harm);
    return status;
}

bool choice_harm_hash(Sha256 *digest, const Survey *survey)
{
    bool good = true;
    for (int k = 0; k < survey->shot_count && k < bursts_most && good; k++) {
        const Shot *s = &survey->shot[k];
        if (!isfinite(s->detonation_s)) continue;
        const double of[] = {s->detonation_s,    s->p_burst_ecef[0],   s->p_burst_ecef[1],
                             s->p_burst_ecef[2], (double)s->charge_kg, s->result};
        good = sha256_add(digest, of, sizeof of);
    }
    for (int k = 0; k < survey->track_count && good; k++) {
        const Track *t = &survey->track[k];
        for (int n = 0; n < t->count && t->type.kind == dis_kind_cultural_feature && good; n++) {
            const TrackPoint *p = &t->point[n];
            const double      of[] = {p->t_s, p->p_ecef[0], p->p_ecef[1], p->p_ecef[2], p->damage};
            if (p->damage > 0) good = sha256_add(digest, of, sizeof of);
        }
    }
    return good;
}
