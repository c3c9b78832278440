/* sensor/node/player/player.c: PDUs in order of time into the entity table, each decoded once, when it is fed; and
 * which datagrams open a causal run. */
#include "sensor/node/player/player.h"

#include "dis/pdu/decode.h"
#include "dis/pdu/pdu.h"
#include "dis/clock/exercise_clock.h"
#include "dis/capture/log.h"
#include "sensor/node/player/munitions.h"

#include <assert.h>
#include <stdlib.h>

typedef enum Where { IN_LOG, ON_DISK, KEPT } Where;

typedef struct Event {
    double          counts_s; /* time from which it counts */
    ExerciseInstant instant;  /* its own exercise time */
    uint32_t        order;
    uint16_t        length;
    uint8_t         type, where;
    union {
        const uint8_t *octets; /* in the log */
        uint64_t       at;     /* on disk, or in the stored octets */
    };
} Event;

struct Player {
    bool           causal, sorted, whole;
    int            exercise, count, next, capacity;
    uint32_t       order;
    Event         *event;
    uint8_t       *octets; /* of the octets stored until they are fed */
    size_t         octets_used, octets_capacity;
    const DisLog  *log; /* whose datagrams were added; NULL: none */
    ExerciseClock *clock;
    double         tie_s, latest_s; /* exercise time - arrival time; of the latest arrival */
    double         fed_s;           /* counts_s of the newest event fed */
    double         now_s;           /* until which it was fed */
    double         skip_s;          /* what counts until then was fed from a log before */
    DisCounters    counters;
    DisPdu         pdu; /* the PDU being fed */
    Munitions      munitions;
    int            anomalies_reported;
};

Status player_create(Player **out, int exercise, bool causal)
{
    Player *player = calloc(1, sizeof *player);
    if (!player) return STATUS_NO_MEMORY;
    player->exercise = exercise;
    player->causal = causal;
    player->tie_s = NAN;
    player->latest_s = -INFINITY;
    player->fed_s = -INFINITY;
    player->now_s = player->skip_s = -INFINITY;
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
        Event    *grown = realloc(player->event, (size_t)larger * sizeof *grown);
        if (!grown) return STATUS_NO_MEMORY;
        player->event = grown;
        player->capacity = larger;
    }
    player->event[player->count++] = *event;
    player->sorted = false;
    return STATUS_OK;
}

static Status keep_octets(size_t *at, Player *player, const uint8_t *pdu, size_t count)
{
    if (player->octets_used + count > player->octets_capacity) {
        const size_t larger = 2 * (player->octets_capacity + count) + 65536;
        uint8_t     *grown = realloc(player->octets, larger);
        if (!grown) return STATUS_NO_MEMORY;
        player->octets = grown;
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
    char                          text[exercise_clock_anomaly_text_size];
    player->counters.stamps_doubted = doubts->by_arrival;
    for (; player->anomalies_reported < doubts->count; player->anomalies_reported++) {
        if (!say) continue;
        exercise_clock_anomaly_text(text, sizeof text, &doubts->sender[player->anomalies_reported]);
        log_warn("run: %s", text);
    }
}

static Status store(Player *player, Event *event, const DisDatagram *datagram, const uint8_t *pdu)
{
    Status status = STATUS_OK;
    event->order = player->order++;
    if (event->where == KEPT) {
        size_t at = 0;
        status = keep_octets(&at, player, pdu, event->length);
        event->at = at;
    } else if (event->where == ON_DISK) {
        event->at += (uint64_t)(pdu - datagram->bytes);
    } else {
        event->octets = pdu;
    }
    return status == STATUS_OK ? add_event(player, event) : status;
}

/* Stores the PDUs of a datagram. place: where its octets are. */
static Status hear(Player *player, const DisDatagram *datagram, const Event *place)
{
    const uint8_t *at = datagram->bytes, *pdu;
    DisHeader      header;
    player->counters.datagrams++;
    while (dis_next_pdu(&header, &pdu, &at, datagram->bytes + datagram->octets, &player->counters)) {
        Event event = *place;
        if (player->exercise >= 0 && header.exercise != player->exercise) {
            player->counters.dropped[DIS_DROP_OTHER_EXERCISE]++;
            continue;
        }
        event.instant = exercise_clock_pdu_instant(player->clock, &header, pdu, datagram->capture_s);
        if (isnan(event.instant.t_s)) continue;
        note_anomalies(player, place->where == KEPT);
        if (isnan(player->tie_s)) player->tie_s = event.instant.t_s - datagram->capture_s;
        player->latest_s = fmax(player->latest_s, datagram->capture_s + player->tie_s);
        event.counts_s = player->causal ? player->latest_s : event.instant.t_s;
        event.length = header.length;
        event.type = header.type;
        const Status status = store(player, &event, datagram, pdu);
        if (status != STATUS_OK) return status;
    }
    return STATUS_OK;
}

Status player_add(Player *player, const DisDatagram *datagram, bool keep)
{
    const Event place = {.where = keep ? KEPT : IN_LOG};
    return hear(player, datagram, &place);
}

Status player_add_log(Player *player, const DisLog *log)
{
    Status status = STATUS_OK;
    player->log = log;
    for (int i = 0; i < log->count && status == STATUS_OK; i++) {
        const DisDatagram *entry = &log->datagram[i], datagram = dis_log_datagram(log, i);
        const bool         disk = entry->packet & dis_datagram_on_disk;
        const Event        place = {.where = disk ? ON_DISK : IN_LOG, .at = disk ? entry->at : 0};
        status = hear(player, &datagram, &place);
    }
    return status;
}

Status player_change_log(Player *player, const DisLog *log, double from_s)
{
    ExerciseClock *clock = NULL;
    Status         status = exercise_clock_create(&clock);
    assert(!player->causal);
    if (status != STATUS_OK) return status;
    exercise_clock_destroy(player->clock);
    player->clock = clock;
    player->count = player->next = 0;
    player->whole = false;
    player->counters = (DisCounters){0};
    player->skip_s = from_s;
    return player_add_log(player, log);
}

/* ---- output ------------------------------------------------------------------------------------- */

static int compare_events(const void *a, const void *b)
{
    const Event *p = a, *q = b;
    if (p->counts_s != q->counts_s) return p->counts_s < q->counts_s ? -1 : 1;
    return p->order < q->order ? -1 : p->order > q->order;
}

/* Decodes a PDU, which is stored as octets until then, and feeds it. */
static void feed_event(Player *player, EntityTable *table, const Event *event)
{
    const uint8_t *octets = event->where == KEPT      ? player->octets + event->at
                            : event->where == ON_DISK ? dis_log_file_octets(player->log->file, event->at, event->length)
                                                      : event->octets;
    DisPdu        *pdu = &player->pdu;
    if (!octets) return; /* the log says so */
    const Status status = dis_decode(pdu, octets, event->length);
    if (status != STATUS_OK) {
        if (isfinite(event->instant.t_s)) dis_count_refused(&player->counters, event->type, status);
        return;
    }
    if (player->causal) entity_table_arrival(table, event->counts_s, event->instant.by_stamp);
    entity_table_pdu(table, pdu, event->instant.t_s, &player->counters);
    if (pdu->type == dis_pdu_fire) munitions_fire(&player->munitions, &pdu->fire);
    if (pdu->type == dis_pdu_entity_state) munitions_report(&player->munitions, &pdu->entity_state, event->counts_s);
    if (pdu->type == dis_pdu_detonation)
        munitions_burst(&player->munitions, &pdu->detonation, table, event->instant.t_s, event->counts_s);
}

/* Settles the times of all PDUs, once all of a recording is here: the clocks of its senders are known then. */
static Status settle_times(Player *player)
{
    const Status status = exercise_clock_whole(player->clock);
    if (status != STATUS_OK) return status;
    player->whole = true;
    for (int i = 0; i < player->count; i++) {
        exercise_clock_whole_time(player->clock, &player->event[i].instant);
        player->event[i].counts_s = player->event[i].instant.t_s;
    }
    player->counters.stamps_doubted = exercise_clock_anomalies(player->clock)->by_arrival;
    return STATUS_OK;
}

Status player_feed(Player *player, EntityTable *table, double t_s)
{
    if (!player->causal && !player->whole) {
        const Status status = settle_times(player);
        if (status != STATUS_OK) return status;
    }
    if (!player->sorted && !player->causal && player->count > 1)
        qsort(player->event, (size_t)player->count, sizeof *player->event, compare_events);
    player->sorted = true; /* arrivals are ordered already */
    player->now_s = fmax(player->now_s, t_s);
    while (player->next < player->count && player->event[player->next].counts_s <= player->skip_s) player->next++;
    for (; player->next < player->count && player->event[player->next].counts_s <= t_s; player->next++) {
        feed_event(player, table, &player->event[player->next]);
        player->fed_s = player->event[player->next].counts_s;
    }
    if (player->causal && player->next == player->count) { /* of a live node only datagrams not yet fed take memory */
        player->next = player->count = 0;
        player->octets_used = 0;
    }
    return STATUS_OK;
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
    return munitions_target(target, &player->munitions, munition);
}

bool player_spent(const Player *player, DisEntityId munition) { return munitions_spent(&player->munitions, munition); }

bool player_munition(DisEntityId *munition, bool *guided, const Player *player, const EntityTable *table)
{
    return munitions_host(munition, guided, &player->munitions, table, player->now_s);
}

void player_forgotten(uint64_t *shots, uint64_t *munitions, const Player *player)
{
    munitions_forgotten(shots, munitions, &player->munitions);
}

const DisCounters *player_counters(const Player *player) { return &player->counters; }

/* ---- the opening: the datagrams on which the choices of a causal run are based ---------------------- */

bool player_own(const DisDatagram *datagram, const Config *config)
{
    DisCounters    ignored = {0};
    DisHeader      header;
    uint16_t       sender[2];
    const uint8_t *at = datagram->bytes, *pdu;
    return dis_next_pdu(&header, &pdu, &at, datagram->bytes + datagram->octets, &ignored) &&
           dis_pdu_sender(sender, &header, pdu) && sender[0] == config->node.site &&
           sender[1] == config->node.application;
}

int player_drop_own(DisLog *log, const Config *config)
{
    int kept = 0;
    for (int i = 0; i < log->count; i++) {
        const DisDatagram datagram = dis_log_datagram(log, i);
        if (!player_own(&datagram, config)) log->datagram[kept++] = log->datagram[i];
    }
    const int own = log->count - kept;
    log->count = kept;
    return own;
}

bool player_usable(const DisHeader *header, const uint8_t *pdu)
{
    DisPdu  decoded;
    DisDrop why;
    return header->type == dis_pdu_entity_state && dis_decode(&decoded, pdu, header->length) == STATUS_OK &&
           dis_entity_state_is_usable(&why, &decoded.entity_state);
}

bool player_starts(DisHeader *out, const DisDatagram *datagram, const Config *config)
{
    DisCounters    ignored = {0};
    DisHeader      header;
    const uint8_t *at = datagram->bytes, *pdu;
    while (dis_next_pdu(&header, &pdu, &at, datagram->bytes + datagram->octets, &ignored)) {
        if (config->exercise.exercise >= 0 && header.exercise != config->exercise.exercise) continue;
        if (!player_usable(&header, pdu)) continue;
        if (out) *out = header;
        return true;
    }
    return false;
}

double player_listens_until_s(const DisDatagram *starts, const Config *config)
{
    return starts->capture_s + config->exercise.listen_s;
}

bool player_opening(DisLog *view, DisLog *heard, double *until_s, const DisLog *log, const Config *config)
{
    *until_s = NAN;
    return player_opening_until(view, heard, until_s, log, config);
}

bool player_opening_until(DisLog *view, DisLog *heard, double *until_s, const DisLog *log, const Config *config)
{
    int starts = 0, end;
    for (; starts < log->count; starts++) {
        const DisDatagram datagram = dis_log_datagram(log, starts);
        if (player_starts(NULL, &datagram, config)) break;
    }
    if (starts == log->count) return false;
    if (isnan(*until_s)) *until_s = player_listens_until_s(&log->datagram[starts], config);
    for (end = starts; end < log->count && log->datagram[end].capture_s <= *until_s;) end++;
    const int begin = starts > player_opening_before ? starts - player_opening_before : 0;
    *view = *log;
    view->datagram += begin;
    view->count -= begin;
    *heard = *view;
    heard->count = end - begin;
    return true;
}
