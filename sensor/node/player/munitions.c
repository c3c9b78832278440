/* sensor/node/player/munitions.c: munitions that were received, their Fires and Detonations. */
#include "sensor/node/player/munitions.h"

#include "dis/pdu/pdu.h"

/* A munition that was not heard for this long does not become the host. */
static const double munition_silent_s = 4;
/* Limits for a burst that names no ids, for differences of clocks and dead reckoning. Beyond the second distance a
 * munition is taken to fly on. */
static const double burst_slack_s = 0.1, burst_near_m = 10, burst_far_m = 50;

static bool same(DisEntityId a, DisEntityId b) { return dis_entity_id_compare(a, b) == 0; }

void munitions_fire(Munitions *m, const DisFire *fire)
{
    const Aimed shot = {fire->munition, fire->target, fire->firing, fire->event};
    if (dis_entity_id_is_none(fire->munition)) m->unnamed[m->unnamed_shots++ % shots_kept] = shot;
    else m->aimed[m->shots++ % shots_kept] = shot;
}

/* The munition's place in the ring; -1: it is not there. */
static int ring_index(const MunitionRing *ring, DisEntityId id)
{
    for (int i = 0; (uint64_t)i < ring->count && i < munitions_kept; i++)
        if (same(ring->id[i], id)) return i;
    return -1;
}

static double length2(const double v[3]) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; }

static bool moves(const float velocity_mps[3])
{
    const double v[3] = {velocity_mps[0], velocity_mps[1], velocity_mps[2]};
    return length2(v) > munition_still_mps * munition_still_mps; /* false for NaN */
}

static bool flies_on(const MunitionRing *ring, int i, const DisEntityState *state)
{
    double away[3];
    for (int k = 0; k < 3; k++) away[k] = state->p_ecef[k] - ring->p_burst_ecef[i][k];
    return ring->by_place[i] && length2(away) > burst_far_m * burst_far_m;
}

/* Guided munitions count from their first report on, others from the first in which they move. */
void munitions_report(Munitions *m, const DisEntityState *state, double counts_s)
{
    const bool guided = state->type.category == dis_munition_guided;
    if (state->type.kind != dis_kind_munition || state->type.category == dis_munition_fixed) return;
    if (!guided && !moves(state->velocity_mps)) return;
    MunitionRing *ring = guided ? &m->guided : &m->unguided;
    const int     known = ring_index(ring, state->id), i = known >= 0 ? known : (int)(ring->count++ % munitions_kept);
    /* heard again after a silence, the id is another munition's */
    if (known < 0 || counts_s - ring->heard_s[i] > munition_silent_s || flies_on(ring, i, state))
        ring->spent[i] = false;
    ring->id[i] = state->id;
    ring->heard_s[i] = counts_s;
}

/* ---- bursts ------------------------------------------------------------------------------------- */

static bool contradicts(DisEntityId a, DisEntityId b)
{
    return !dis_entity_id_is_none(a) && !dis_entity_id_is_none(b) && !same(a, b);
}

/* The latest Fire of a ring with this event and firing entity; NULL: there is none, or the event has no number. */
static const Aimed *shot_of(const Aimed ring[shots_kept], uint64_t count, const DisDetonation *burst)
{
    for (uint64_t i = 1; burst->event.number && i <= count && i <= shots_kept; i++) {
        const Aimed *a = &ring[(count - i) % shots_kept];
        if (a->event.number == burst->event.number && a->event.site == burst->event.site &&
            a->event.application == burst->event.application && !contradicts(a->firing, burst->firing))
            return a;
    }
    return NULL;
}

static const Aimed *shot_with(const Munitions *m, DisEntityId munition)
{
    for (uint64_t i = 1; i <= m->shots && i <= shots_kept; i++) {
        const Aimed *a = &m->aimed[(m->shots - i) % shots_kept];
        if (same(a->munition, munition)) return a;
    }
    return NULL;
}

static void burst_by_id(Munitions *m, DisEntityId munition)
{
    MunitionRing *const kind[] = {&m->guided, &m->unguided};
    for (int k = 0; k < 2; k++) {
        const int i = ring_index(kind[k], munition);
        if (i < 0) continue;
        kind[k]->spent[i] = true;
        kind[k]->by_place[i] = false;
    }
}

/* Distance from a burst to an entity's path; INFINITY: the entity is not in the table. */
static double miss_m(const EntityTable *table, DisEntityId id, const double p_ecef[3], double t_s)
{
    SnapshotEntity at;
    double         to[3], along = 0;
    if (!entity_table_pose(&at, table, entity_table_find(table, id), t_s)) return INFINITY;
    for (int k = 0; k < 3; k++) to[k] = p_ecef[k] - at.p_ecef[k];
    const double speed2 = length2(at.v_ecef_mps);
    for (int k = 0; k < 3; k++) along += to[k] * at.v_ecef_mps[k];
    const double off_s = speed2 > 0 ? clamp(along / speed2, -burst_slack_s, burst_slack_s) : 0;
    for (int k = 0; k < 3; k++) to[k] -= at.v_ecef_mps[k] * off_s;
    return sqrt(length2(to));
}

static void burst_by_place(Munitions *m, const DisDetonation *burst, const EntityTable *table, double t_s,
                           double counts_s)
{
    MunitionRing *const kind[] = {&m->guided, &m->unguided}, *ring = NULL;
    int                 nearest = -1;
    double              least_m = burst_near_m;
    for (int k = 0; k < 2; k++)
        for (int i = 0; (uint64_t)i < kind[k]->count && i < munitions_kept; i++) {
            if (kind[k]->spent[i] || counts_s - kind[k]->heard_s[i] > munition_silent_s) continue;
            const double off_m = miss_m(table, kind[k]->id[i], burst->p_ecef, t_s);
            if (!(off_m <= least_m)) continue;
            const Aimed *shot = shot_with(m, kind[k]->id[i]);
            if (shot && contradicts(shot->firing, burst->firing)) continue;
            least_m = off_m;
            ring = kind[k];
            nearest = i;
        }
    if (nearest < 0) return;
    ring->spent[nearest] = ring->by_place[nearest] = true;
    memcpy(ring->p_burst_ecef[nearest], burst->p_ecef, sizeof ring->p_burst_ecef[nearest]);
}

void munitions_burst(Munitions *m, const DisDetonation *burst, const EntityTable *table, double t_s, double counts_s)
{
    const Aimed *shot;
    if (!dis_entity_id_is_none(burst->munition)) burst_by_id(m, burst->munition);
    else if ((shot = shot_of(m->aimed, m->shots, burst))) burst_by_id(m, shot->munition);
    else if (!shot_of(m->unnamed, m->unnamed_shots, burst)) burst_by_place(m, burst, table, t_s, counts_s);
}

/* ---- queries ------------------------------------------------------------------------------------ */

bool munitions_target(DisEntityId *target, const Munitions *m, DisEntityId munition)
{
    for (uint64_t i = 1; i <= m->shots && i <= shots_kept; i++) {
        const Aimed *a = &m->aimed[(m->shots - i) % shots_kept];
        if (!same(a->munition, munition) || dis_entity_id_is_none(a->target)) continue;
        *target = a->target;
        return true;
    }
    return false;
}

bool munitions_spent(const Munitions *m, DisEntityId munition)
{
    const int guided = ring_index(&m->guided, munition), other = ring_index(&m->unguided, munition);
    return (guided >= 0 && m->guided.spent[guided]) || (other >= 0 && m->unguided.spent[other]);
}

static bool is_there(const EntityTable *table, DisEntityId id)
{
    return entity_table_alive(table, entity_table_find(table, id));
}

/* Finds the munition received first, of those that are in the table and still fly. */
static bool first_there(DisEntityId *id, const MunitionRing *ring, const EntityTable *table, double now_s)
{
    const uint64_t kept = ring->count < munitions_kept ? ring->count : munitions_kept;
    for (uint64_t i = ring->count - kept; i < ring->count; i++) {
        const uint64_t k = i % munitions_kept;
        if (ring->spent[k] || now_s - ring->heard_s[k] > munition_silent_s || !is_there(table, ring->id[k])) continue;
        *id = ring->id[k];
        return true;
    }
    return false;
}

bool munitions_host(DisEntityId *munition, bool *guided, const Munitions *m, const EntityTable *table, double now_s)
{
    DisEntityType type;
    const bool    there =
        !dis_entity_id_is_none(*munition) && entity_table_type(&type, table, entity_table_find(table, *munition));
    /* by its type, not by whether it is among the latest: a salvo must not move the sensor to another host */
    *guided = there && type.kind == dis_kind_munition && type.category == dis_munition_guided;
    const bool spent = there && munitions_spent(m, *munition);
    if (*guided && !spent) return true;
    if (first_there(munition, &m->guided, table, now_s)) return *guided = true;
    if (there && (!spent || m->guided.count > 0)) return true;
    if (m->guided.count > 0) return false; /* its own burst, not a shell's flight, ends what a guided one shows */
    return first_there(munition, &m->unguided, table, now_s) || there;
}

static uint64_t beyond(uint64_t count, uint64_t kept) { return count > kept ? count - kept : 0; }

void munitions_forgotten(uint64_t *shots, uint64_t *munitions, const Munitions *m)
{
    *shots = beyond(m->shots, shots_kept);
    *munitions = beyond(m->guided.count, munitions_kept) + beyond(m->unguided.count, munitions_kept);
}
