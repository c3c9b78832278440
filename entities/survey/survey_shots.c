/* entities/survey/survey_shots.c: matches Fire and Detonation offline, with the whole log at hand. */
#include "entities/survey/survey.h"
#include "entities/table/entity_index.h"

#include <stdlib.h>

static const double same_s = 0.5;      /* a PDU repeated within this time is one */
static const double clock_slack_s = 1; /* a Detonation may be stamped by another sender's clock than the Fire */
enum { most_tries = 64 };              /* candidates checked; the limit bounds the cost of a hostile log */

/* A Fire by one of its keys; sorted by key, then by time. */
typedef struct FireKey {
    uint64_t key;
    double   t_s;
    int      fire; /* index of the event */
} FireKey;

static uint64_t munition_key(const WarfareEvent *e) { return entity_key(e->munition); }

static uint64_t event_key(const WarfareEvent *e)
{
    return (uint64_t)e->event.site << 32 | (uint64_t)e->event.application << 16 | e->event.number;
}

static int by_time(const void *a, const void *b)
{
    const WarfareEvent *x = a, *y = b;
    if (x->t_s != y->t_s) return x->t_s < y->t_s ? -1 : 1;
    /* at one instant the Fire comes first; then by id, so that the order is the same in every C library */
    if (x->is_detonation != y->is_detonation) return x->is_detonation ? 1 : -1;
    const int order = dis_entity_id_compare(x->munition, y->munition);
    if (order != 0) return order;
    return event_key(x) < event_key(y) ? -1 : event_key(x) > event_key(y);
}

static int by_key(const void *a, const void *b)
{
    const FireKey *x = a, *y = b;
    if (x->key != y->key) return x->key < y->key ? -1 : 1;
    if (x->t_s != y->t_s) return x->t_s < y->t_s ? -1 : 1;
    return (x->fire > y->fire) - (x->fire < y->fire);
}

/* Where fires of this key with a time up to t_s end. */
static int keys_end(const FireKey *list, int count, uint64_t key, double t_s)
{
    int low = 0, high = count;
    while (low < high) {
        const int middle = low + (high - low) / 2;
        if (list[middle].key < key || (list[middle].key == key && list[middle].t_s <= t_s)) low = middle + 1;
        else high = middle;
    }
    return low;
}

static bool same_event(const WarfareEvent *a, const WarfareEvent *b)
{
    return munition_key(a) == munition_key(b) && event_key(a) == event_key(b) &&
           dis_entity_id_compare(a->firing, b->firing) == 0 && fabs(a->t_s - b->t_s) <= same_s;
}

typedef struct Joining {
    const WarfareEvent *event;
    int                 count, fires;
    FireKey            *by_munition, *by_event;
    int                *partner; /* of each event: index of the other, -1 none, -2 a repeat */
} Joining;

static bool contradicts(DisEntityId a, DisEntityId b)
{
    return !dis_entity_id_is_none(a) && !dis_entity_id_is_none(b) && dis_entity_id_compare(a, b) != 0;
}

/* The latest fire of the key up to slack_s after the detonation without a detonation so far, and consistent with its
 * munition and firing entity; of the same event id if same_number. -1: none; -2: the fire was ended by the same
 * detonation, received before. */
static int open_fire(const Joining *j, const FireKey *list, uint64_t key, int detonation, bool same_number,
                     double slack_s)
{
    const WarfareEvent *d = j->event + detonation;
    const int           end = keys_end(list, j->fires, key, d->t_s + slack_s);

    for (int i = end - 1; i >= 0 && i >= end - most_tries && list[i].key == key; i--) {
        const WarfareEvent *f = j->event + list[i].fire;
        const int           partner = j->partner[list[i].fire];
        if (contradicts(f->munition, d->munition) || contradicts(f->firing, d->firing)) continue;
        if (same_number && event_key(f) != event_key(d)) continue;
        if (partner >= 0 && same_event(j->event + partner, d)) return -2;
        if (partner == -1) return list[i].fire;
    }
    return -1;
}

/* The most certain match first: both ids, then the munition's, each before the detonation; then by a clock that is
 * behind. */
static void join_detonation(Joining *j, int detonation)
{
    const WarfareEvent *d = j->event + detonation;
    const bool          has_munition = !dis_entity_id_is_none(d->munition), has_number = event_key(d) != 0;
    int                 fire = -1;

    if (has_munition && has_number)
        fire = open_fire(j, j->by_munition, munition_key(d), detonation, true, clock_slack_s);
    if (has_munition && fire == -1) fire = open_fire(j, j->by_munition, munition_key(d), detonation, false, 0);
    if (has_munition && fire == -1)
        fire = open_fire(j, j->by_munition, munition_key(d), detonation, false, clock_slack_s);
    if (has_number && fire == -1) fire = open_fire(j, j->by_event, event_key(d), detonation, true, clock_slack_s);
    j->partner[detonation] = fire;
    if (fire >= 0) j->partner[fire] = detonation;
}

static Shot shot_of(const Joining *j, int e)
{
    const WarfareEvent *first = j->event + e;
    const WarfareEvent *end = first->is_detonation ? first : j->partner[e] >= 0 ? j->event + j->partner[e] : NULL;
    Shot                shot = {.firing = first->firing,
                                .target = first->target,
                                .munition = first->munition,
                                .fire_s = first->is_detonation ? NAN : first->t_s,
                                .detonation_s = NAN,
                                .p_burst_ecef = {NAN, NAN, NAN}};
    if (end) {
        if (dis_entity_id_is_none(shot.munition)) shot.munition = end->munition;
        if (dis_entity_id_is_none(shot.firing)) shot.firing = end->firing;
        shot.detonation_s = end->t_s;
        memcpy(shot.p_burst_ecef, end->p_ecef, sizeof shot.p_burst_ecef);
        shot.hit = end->target;
        shot.result = end->result;
        shot.charge_kg = end->charge_kg;
    }
    return shot;
}

Status survey_join_shots(Shot **shots, int *shot_count, WarfareEvent *event, int count)
{
    Status  status = STATUS_NO_MEMORY;
    Joining j = {.event = event, .count = count};
    Shot   *shot = calloc((size_t)count + 1, sizeof *shot);

    j.by_munition = calloc((size_t)count + 1, sizeof *j.by_munition);
    j.by_event = calloc((size_t)count + 1, sizeof *j.by_event);
    j.partner = calloc((size_t)count + 1, sizeof *j.partner);
    if (!shot || !j.by_munition || !j.by_event || !j.partner) goto done;

    if (count > 0) qsort(event, (size_t)count, sizeof *event, by_time); /* none: event may be NULL */
    for (int e = 0; e < count; e++) {
        j.partner[e] = -1;
        if (event[e].is_detonation) continue;
        j.by_munition[j.fires] = (FireKey){munition_key(event + e), event[e].t_s, e};
        j.by_event[j.fires++] = (FireKey){event_key(event + e), event[e].t_s, e};
    }
    qsort(j.by_munition, (size_t)j.fires, sizeof *j.by_munition, by_key);
    qsort(j.by_event, (size_t)j.fires, sizeof *j.by_event, by_key);
    for (int f = 1; f < j.fires; f++) {
        const int before = j.by_event[f - 1].fire, here = j.by_event[f].fire;
        if (j.by_event[f].key != 0 && same_event(event + before, event + here)) j.partner[here] = -2;
    }
    for (int e = 0; e < count; e++)
        if (event[e].is_detonation) join_detonation(&j, e);

    /* in order of time, since events are: a matched detonation is listed with its fire */
    int n = 0;
    for (int e = 0; e < count; e++)
        if (j.partner[e] != -2 && !(event[e].is_detonation && j.partner[e] >= 0)) shot[n++] = shot_of(&j, e);
    *shots = shot;
    *shot_count = n;
    shot = NULL;
    status = STATUS_OK;

done:
    free(j.by_munition);
    free(j.by_event);
    free(j.partner);
    free(shot);
    return status;
}

/* ---- by munition ---------------------------------------------------------------------------------- */

typedef struct ShotKey {
    uint64_t key;
    int      shot;
} ShotKey;

static int by_shot_key(const void *a, const void *b)
{
    const ShotKey *x = a, *y = b;
    if (x->key != y->key) return x->key < y->key ? -1 : 1;
    return (x->shot > y->shot) - (x->shot < y->shot);
}

Status survey_order_shots(int **by_munition, const Shot *shot, int count)
{
    ShotKey *key = malloc(((size_t)count + 1) * sizeof *key);
    int     *order = malloc(((size_t)count + 1) * sizeof *order);
    if (!key || !order) {
        free(key);
        free(order);
        return STATUS_NO_MEMORY;
    }
    for (int i = 0; i < count; i++) key[i] = (ShotKey){entity_key(shot[i].munition), i};
    qsort(key, (size_t)count, sizeof *key, by_shot_key);
    for (int i = 0; i < count; i++) order[i] = key[i].shot;
    free(key);
    *by_munition = order;
    return STATUS_OK;
}
