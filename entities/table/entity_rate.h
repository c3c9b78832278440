/* entities/table/entity_rate.h: how many entities a sender (site and application) may add to the table a second: a
 * token bucket a sender, full at first, that holds as many as one second gives.
 *
 * So a sender that reports all its entities at once is accepted, and one that keeps creating ids is held to the limit.
 * 4096 senders are remembered; beyond that the oldest is dropped, and starts with a full bucket if it returns. The
 * result depends on the order of the calls and their times alone. */
#ifndef ENTITIES_TABLE_ENTITY_RATE_H
#define ENTITIES_TABLE_ENTITY_RATE_H

#include "dis/pdu.h"

typedef struct EntityRate EntityRate;

/* new_per_s: at least 1. Memory is fixed when it is made. */
Status entity_rate_create(EntityRate **out, double new_per_s);
void   entity_rate_destroy(EntityRate *rate);
/* One more of this sender at t_s: whether it is admitted, and then counted. Decreasing times add no tokens. */
bool   entity_rate_take(EntityRate *rate, DisEntityId id, double t_s);

#endif
