/* sensor/node/session/session_crowd.c: reports of entities that did not fit. */
#include "sensor/node/session/session_private.h"

void session_report_crowd(Session *s, int left_out)
{
    static const double   remind_s = 60;
    const EntityCounters *c = entity_table_counters(s->table);
    const Config         *config = s->shared->config;
    const uint64_t        given_up = c->evicted + c->refused;
    const double          now_s = wall_clock_s();
    DisEntityId           sender;
    if (given_up > s->crowd.given_up && !(now_s - s->crowd.given_up_s < remind_s)) {
        const int most = entity_table_largest_sender(&sender, s->table);
        log_warn(
            "host %s: the table of %d entities is full: %llu gave way to others, %llu were not taken in; %u:%u has "
            "the most, %d; near the host, and what goes on reporting, stays (entities.capacity)",
            s->host_text, config->entities.capacity, (unsigned long long)c->evicted, (unsigned long long)c->refused,
            sender.site, sender.application, most);
        s->crowd.given_up = given_up;
        s->crowd.given_up_s = now_s;
    }
    if (left_out == 0) return;
    if (!(now_s - s->crowd.left_out_s < remind_s)) {
        log_warn(
            "host %s: %d entities are not in the pictures, the farthest from it; the nearest %d are (entities.shown)",
            s->host_text, left_out, config->entities.shown);
        s->crowd.left_out_s = now_s;
    }
    s->result.frames_crowded++;
    if (left_out > s->result.most_left_out) s->result.most_left_out = left_out;
}
