#include "sensor/node/player.h"

#include "dis/exercise_clock.h"

#include <stdlib.h>

typedef struct Event {
    double         counts_s, t_s; /* from when it counts; its own exercise time */
    uint32_t       order;         /* in the file */
    DisHeader      header;
    const uint8_t *pdu;           /* in the log */
} Event;

struct Player {
    int         count, next;
    Event      *event;
    DisCounters counters; /* drops again, as the survey counted them already: not reported */
};

static int compare_events(const void *a, const void *b)
{
    const Event *p = a, *q = b;
    if (p->counts_s != q->counts_s) return p->counts_s < q->counts_s ? -1 : 1;
    return p->order < q->order ? -1 : p->order > q->order;
}

static Status add_event(Player *player, int *capacity, const Event *event)
{
    if (player->count == *capacity) {
        const int larger = *capacity ? 2 * *capacity : 4096;
        Event    *grown  = realloc(player->event, (size_t)larger * sizeof *grown);
        if (!grown) return STATUS_NO_MEMORY;
        player->event = grown;
        *capacity     = larger;
    }
    player->event[player->count++] = *event;
    return STATUS_OK;
}

Status player_create(Player **out, const DisLog *log, int exercise, bool causal)
{
    Player        *player = calloc(1, sizeof *player);
    ExerciseClock *clock  = NULL;
    Status         status = STATUS_NO_MEMORY;
    int            capacity = 0;
    double         tie_s = NAN, latest_s = -INFINITY; /* exercise time - capture time of the first PDU */

    if (!player) return STATUS_NO_MEMORY;
    status = exercise_clock_create(&clock);
    if (status != STATUS_OK) goto fail;

    for (int i = 0; i < log->count; i++) {
        const DisDatagram *datagram = &log->datagram[i];
        const uint8_t     *at       = datagram->bytes;
        Event              event;
        while (dis_next_pdu(&event.header, &event.pdu, &at, datagram->bytes + datagram->octets, &player->counters)) {
            if (exercise >= 0 && event.header.exercise != exercise) continue;
            event.t_s = exercise_clock_pdu_time(clock, &event.header, event.pdu, datagram->capture_s);
            if (isnan(event.t_s)) continue;
            if (isnan(tie_s)) tie_s = event.t_s - datagram->capture_s;
            latest_s       = fmax(latest_s, datagram->capture_s + tie_s);
            event.counts_s = causal ? latest_s : event.t_s;
            event.order    = (uint32_t)player->count;
            status         = add_event(player, &capacity, &event);
            if (status != STATUS_OK) goto fail;
        }
    }
    if (player->count > 1) qsort(player->event, (size_t)player->count, sizeof *player->event, compare_events);
    exercise_clock_destroy(clock);
    *out = player;
    return STATUS_OK;

fail:
    exercise_clock_destroy(clock);
    player_destroy(player);
    return status;
}

void player_destroy(Player *player)
{
    if (!player) return;
    free(player->event);
    free(player);
}

void player_feed(Player *player, EntityTable *table, double t_s)
{
    for (; player->next < player->count && player->event[player->next].counts_s <= t_s; player->next++) {
        const Event *event = &player->event[player->next];
        entity_table_pdu(table, &event->header, event->pdu, event->t_s, &player->counters);
    }
    entity_table_expire(table, t_s);
}
