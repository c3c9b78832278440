/* sensor/node/player.h: a log fed to an entity table in order of time.
 *
 * Normally a PDU counts from its own time stamp on, whenever it was received. Causal: it counts from when it
 * was received, as it would live. */
#ifndef SENSOR_NODE_PLAYER_H
#define SENSOR_NODE_PLAYER_H

#include "dis/log.h"
#include "entities/entity_table.h"

typedef struct Player Player;

/* exercise: only this id; -1: all. The log must outlive the player. */
Status player_create(Player **out, const DisLog *log, int exercise, bool causal);
void   player_destroy(Player *player);
/* Everything that counts at or before t_s and was not fed before. */
void   player_feed(Player *player, EntityTable *table, double t_s);

#endif
