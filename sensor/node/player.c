/* sensor/node/player.c: PDUs in order of time into the entity table, each decoded once, when it is fed. */
#include "sensor/node/player.h"

#include "dis/datagram.h"
#include "dis/enumerations.h"
#include "dis/exercise_clock.h"

#include <stdlib.h>

enum { shots_kept = 1024, munitions_kept = 256 };

typedef struct Event {
    double          counts_s; /* time from which it counts */
    ExerciseInstant instant;  /* its own exercise time */
    uint32_t       order;
    uint16_t       length;
    uint8_t        type;
    bool           kept;
    union {
        const uint8_t *octets;
        size_t         at; /* in the stored octets */
    };
} Event;

/* Received ids of one kind: a ring of the latest. */
typedef struct Munitions {
    DisEntityId id[munitions_kept];
    uint64_t    count;
} Munitions;

typedef struct Aimed {
    DisEntityId munition, target;
} Aimed;

struct Player {
    bool           causal, sorted, whole;
    int            exercise, count, next, capacity;
    uint32_t       order;
    Event         *event;
    uint8_t       *octets; /* of the octets stored until they are fed */
    size_t         octets_used, octets_capacity;
    ExerciseClock *clock;
    double         tie_s, latest_s; /* exercise time - arrival time; of the latest arrival */
    double         fed_s;           /* counts_s of the newest event fed */
    DisCounters    counters;
    DisPdu         pdu;                          /* the PDU being fed */
    Aimed          aimed[shots_kept];            /* rings: the latest */
    uint64_t       shots;
    Munitions      guided, unguided;
    int            anomalies_reported;
};

Status player_create(Player **out, int exercise, bool causal)
{
    Player *player = calloc(1, sizeof *player);
    if (!player) return STATUS_NO_MEMORY;
    player->exercise = exercise;
    player->causal   = causal;
    player->tie_s    = NAN;
    player->latest_s = -INFINITY;
    player->fed_s    = -INFINITY;
    const Status status = exercise_clock_create(&player->clock);
    if (status == STATUS_OK) *out = player;
    else player_destroy(player);
    return status;
}

void player_destroy(Player *player)
{
    if (!player) return;
    exercise_clock_destroy(player->clock);
    free(player->octets);
    free(player->event);
    free(player);
}

/* ---- input -------------------------------------------------------------------------------------- */

static Status add_event(Player *player, const Event *event)
{
    if (player->count == player->capacity) {
        const int larger = player->capacity ? 2 * player->capacity : 4096;
        Event    *grown  = realloc(player->event, (size_t)larger * sizeof *grown);
        if (!grown) return STATUS_NO_MEMORY;
        player->event    = grown;
        player->capacity = larger;
    }
    player->event[player->count++] = *event;
    player->sorted                 = false;
    return STATUS_OK;
}

static Status keep_octets(size_t *at, Player *player, const uint8_t *pdu, size_t count)
{
    if (player->octets_used + count > player->octets_capacity) {
        const size_t larger = 2 * (player->octets_capacity + count) + 65536;
        uint8_t     *grown  = realloc(player->octets, larger);
        if (!grown) return STATUS_NO_MEMORY;
        player->octets          = grown;
        player->octets_capacity = larger;
    }
    *at = player->octets_used;
    memcpy(player->octets + *at, pdu, count);
    player->octets_used += count;
    return STATUS_OK;
}

/* Counts stamps that are not a clock; of a live sender it is reported once, of a log by the survey. */
static void note_anomalies(Player *player, bool say)
{
    const ExerciseClockAnomalies *doubts = exercise_clock_anomalies(player->clock);
    char                       text[exercise_clock_anomaly_text_size];
    player->counters.stamps_doubted = doubts->by_arrival;
    for (; player->anomalies_reported < doubts->count; player->anomalies_reported++) {
        if (!say) continue;
        exercise_clock_anomaly_text(text, sizeof text, &doubts->sender[player->anomalies_reported]);
        log_warn("run: %s", text);
    }
}

Status player_add(Player *player, const DisDatagram *datagram, bool keep)
{
    const uint8_t *at = datagram->bytes, *pdu;
    Event          event = {.kept = keep};
    DisHeader      header;
    player->counters.datagrams++;
    while (dis_next_pdu(&header, &pdu, &at, datagram->bytes + datagram->octets, &player->counters)) {
        if (player->exercise >= 0 && header.exercise != player->exercise) {
            player->counters.dropped[DIS_DROP_OTHER_EXERCISE]++;
            continue;
        }
        event.instant = exercise_clock_pdu_instant(player->clock, &header, pdu, datagram->capture_s);
        if (isnan(event.instant.t_s)) continue;
        note_anomalies(player, keep);
        if (isnan(player->tie_s)) player->tie_s = event.instant.t_s - datagram->capture_s;
        player->latest_s = fmax(player->latest_s, datagram->capture_s + player->tie_s);
        event.counts_s   = player->causal ? player->latest_s : event.instant.t_s;
        event.order      = player->order++;
        event.length     = header.length;
        event.type       = header.type;
        Status status    = STATUS_OK;
        if (keep) status = keep_octets(&event.at, player, pdu, header.length);
        else event.octets = pdu;
        if (status == STATUS_OK) status = add_event(player, &event);
        if (status != STATUS_OK) return status;
    }
    return STATUS_OK;
}

Status player_add_log(Player *player, const DisLog *log)
{
    Status status = STATUS_OK;
    for (int i = 0; i < log->count && status == STATUS_OK; i++) status = player_add(player, &log->datagram[i], false);
    return status;
}

/* ---- output ------------------------------------------------------------------------------------- */

static int compare_events(const void *a, const void *b)
{
    const Event *p = a, *q = b;
    if (p->counts_s != q->counts_s) return p->counts_s < q->counts_s ? -1 : 1;
    return p->order < q->order ? -1 : p->order > q->order;
}

static void note_fire(Player *player, const DisFire *fire)
{
    if (dis_entity_id_is_none(fire->munition) || dis_entity_id_is_none(fire->target)) return;
    player->aimed[player->shots++ % shots_kept] = (Aimed){fire->munition, fire->target};
}

static bool munition_known(const Munitions *m, DisEntityId id)
{
    for (uint64_t i = 0; i < m->count && i < munitions_kept; i++)
        if (dis_entity_id_compare(m->id[i], id) == 0) return true;
    return false;
}

static bool moves(const float velocity_mps[3])
{
    double sum = 0;
    for (int i = 0; i < 3; i++) sum += (double)velocity_mps[i] * (double)velocity_mps[i];
    return sum > munition_still_mps * munition_still_mps; /* false for NaN */
}

/* Guided ones from their first report on; others from the first in which they move. */
static void note_munition(Player *player, const DisEntityState *state)
{
    const bool guided = state->type.category == dis_munition_guided;
    if (state->type.kind != dis_kind_munition || state->type.category == dis_munition_fixed) return;
    if (!guided && !moves(state->velocity_mps)) return;
    Munitions *m = guided ? &player->guided : &player->unguided;
    if (!munition_known(m, state->id)) m->id[m->count++ % munitions_kept] = state->id;
}

/* Decoded here, once: until then a PDU is stored as octets. */
static void feed_event(Player *player, EntityTable *table, const Event *event)
{
    const uint8_t *octets = event->kept ? player->octets + event->at : event->octets;
    DisPdu        *pdu    = &player->pdu;
    const Status   status = dis_decode(pdu, octets, event->length);
    if (status != STATUS_OK) {
        if (isfinite(event->instant.t_s)) dis_count_refused(&player->counters, event->type, status);
        return;
    }
    if (player->causal) entity_table_arrival(table, event->counts_s, event->instant.by_stamp);
    entity_table_pdu(table, pdu, event->instant.t_s, &player->counters);
    if (pdu->type == dis_pdu_fire) note_fire(player, &pdu->fire);
    if (pdu->type == dis_pdu_entity_state) note_munition(player, &pdu->entity_state);
}

/* All of a recording is here: its senders' clocks are known. */
static void settle_times(Player *player)
{
    player->whole = true;
    exercise_clock_whole(player->clock);
    for (int i = 0; i < player->count; i++) {
        exercise_clock_whole_time(player->clock, &player->event[i].instant);
        player->event[i].counts_s = player->event[i].instant.t_s;
    }
    player->counters.stamps_doubted = exercise_clock_anomalies(player->clock)->by_arrival;
}

void player_feed(Player *player, EntityTable *table, double t_s)
{
    if (!player->causal && !player->whole) settle_times(player);
    if (!player->sorted && !player->causal && player->count > 1)
        qsort(player->event, (size_t)player->count, sizeof *player->event, compare_events);
    player->sorted = true; /* arrivals are ordered already */
    for (; player->next < player->count && player->event[player->next].counts_s <= t_s; player->next++) {
        feed_event(player, table, &player->event[player->next]);
        player->fed_s = player->event[player->next].counts_s;
    }
    if (player->causal && player->next == player->count) { /* of a live node only datagrams not yet fed take memory */
        player->next = player->count = 0;
        player->octets_used          = 0;
    }
}

/* ---- queries ----------------------------------------------------------------------------------- */

double player_time_s(const Player *player, double capture_s) { return capture_s + player->tie_s; }
double player_last_s(const Player *player) { return player->latest_s; }
double player_fed_s(const Player *player) { return player->fed_s; }

double player_arrival_s(const Player *player, double t_s)
{
    double capture_s = t_s - player->tie_s;
    /* the difference is rounded; the sum decides */
    while (capture_s + player->tie_s > t_s) capture_s = nextafter(capture_s, -INFINITY);
    for (double next_s; (next_s = nextafter(capture_s, INFINITY)) + player->tie_s <= t_s;) capture_s = next_s;
    return capture_s;
}

bool player_target(DisEntityId *target, const Player *player, DisEntityId munition)
{
    const uint64_t kept = player->shots < shots_kept ? player->shots : shots_kept;
    for (uint64_t i = 1; i <= kept; i++) {
        const Aimed *aimed = &player->aimed[(player->shots - i) % shots_kept];
        if (dis_entity_id_compare(aimed->munition, munition) != 0) continue;
        *target = aimed->target;
        return true;
    }
    return false;
}

static bool is_there(const EntityTable *table, DisEntityId id)
{
    return entity_table_alive(table, entity_table_find(table, id));
}

static bool first_there(DisEntityId *id, const Munitions *m, const EntityTable *table)
{
    const uint64_t kept = m->count < munitions_kept ? m->count : munitions_kept;
    for (uint64_t i = m->count - kept; i < m->count; i++) {
        if (!is_there(table, m->id[i % munitions_kept])) continue;
        *id = m->id[i % munitions_kept];
        return true;
    }
    return false;
}

bool player_munition(DisEntityId *munition, bool *guided, const Player *player, const EntityTable *table)
{
    DisEntityType type;
    const bool    there = !dis_entity_id_is_none(*munition) &&
                       entity_table_type(&type, table, entity_table_find(table, *munition));
    /* by its type, not by whether it is among the latest: a salvo must not move the sensor to another host */
    *guided = there && type.kind == dis_kind_munition && type.category == dis_munition_guided;
    if (*guided) return true;
    if (first_there(munition, &player->guided, table)) return *guided = true;
    return there || first_there(munition, &player->unguided, table);
}

static uint64_t beyond(uint64_t count, uint64_t kept) { return count > kept ? count - kept : 0; }

void player_forgotten(uint64_t *shots, uint64_t *munitions, const Player *player)
{
    *shots     = beyond(player->shots, shots_kept);
    *munitions = beyond(player->guided.count, munitions_kept) + beyond(player->unguided.count, munitions_kept);
}

const DisCounters *player_counters(const Player *player) { return &player->counters; }
