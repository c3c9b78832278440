/* sensor/node/player/player.h: received datagrams, of a log or of a live node: fed to an entity table in order of
 * time, and which of them open an exercise.
 *
 * By stamp: a PDU counts from its own time stamp on, whenever it was received; all must be added before the first is
 * fed. Causal: it counts from its arrival, and may be added on arrival. Exercise time is arrival time plus an
 * offset, which the first PDU fixes. */
#ifndef SENSOR_NODE_PLAYER_PLAYER_H
#define SENSOR_NODE_PLAYER_PLAYER_H

#include "dis/capture/log.h"
#include "entities/table/entity_table.h"
#include "sensor/settings/config.h"

typedef struct Player Player;

/* exercise: only PDUs of this id are used; -1: of all. */
Status player_create(Player **out, int exercise, bool causal);
void   player_destroy(Player *player);

/* Next datagram in order of arrival. keep: its octets are copied, else they must outlive the player. */
Status player_add(Player *player, const DisDatagram *datagram, bool keep);
/* All datagrams of a log, which must outlive the player: a PDU takes 64 octets, and is read again from a log on
 * disk when it is fed. */
Status player_add_log(Player *player, const DisLog *log);

/* By stamp: from now on that log, in place of the one before, of which it differs only after from_s, in what counts
 * later. It must outlive the player, as the one before. */
Status player_change_log(Player *player, const DisLog *log, double from_s);

/* Feeds everything that counts at or before t_s and was not fed before. Timed-out entities are removed by the
 * caller, on a time grid of its own: so the table does not depend on which frames are rendered. Fails for want of
 * memory, before it feeds anything. */
Status player_feed(Player *player, EntityTable *table, double t_s);

/* Exercise time of a datagram's arrival; NaN before the first PDU. */
double player_time_s(const Player *player, double capture_s);
/* Everything that counts at t_s arrived at or before this Unix time, to the last bit. */
double player_arrival_s(const Player *player, double t_s);
/* The exercise time from which the newest PDU that was fed counts; -INFINITY: none yet. */
double player_fed_s(const Player *player);
double player_last_s(const Player *player); /* exercise time of the latest arrival; -inf before the first */

/* Gives the target of the latest Fire that names this munition. */
bool player_target(DisEntityId *target, const Player *player, DisEntityId munition);
/* Whether the munition detonated (munitions_burst), and sent no report after a silence since. */
bool player_spent(const Player *player, DisEntityId munition);
/* The munition that is the host now, of those fed. munition: in and out (0:0:0: none so far). A guided one
 * (SISO-REF-010, category 1) that is in the table and has not detonated stays; else the guided one received first of
 * those in the table; else the present one, while it is in the table; else, unless a guided one has flown, the one
 * received first that is neither guided nor fixed and moves. None becomes the host that was not heard within 4 s or has
 * detonated. Fixed ones (category 3: mines) are never the host. False, and nothing changed: there is none. Of each kind
 * the latest 256 are stored. */
bool player_munition(DisEntityId *munition, bool *guided, const Player *player, const EntityTable *table);

/* Fire PDUs and munitions dropped for newer ones, since only the latest are stored. */
void player_forgotten(uint64_t *shots, uint64_t *munitions, const Player *player);

const DisCounters *player_counters(const Player *player); /* all PDUs added, and those of them that the table
                                                           * rejected */

/* ---- the opening of a causal run -------------------------------------------------------------------- */

/* The choices of a causal run are based on the datagrams received up to exercise.listen_s after the first usable
 * Entity State. A live node and `replay --causal` of its recording select the same ones by the same rule. The
 * exercise begins with that Entity State, or at most player_opening_before datagrams earlier (a Start/Resume with the
 * time of day comes first): a long silence needs no more memory. */
enum { player_opening_before = 1024 };

/* Whether this node sent the datagram, by the sender of its first PDU (node.site, node.application). */
bool player_own(const DisDatagram *datagram, const Config *config);
/* Removes this node's own datagrams from a log; returns how many. */
int player_drop_own(DisLog *log, const Config *config);

/* Whether a PDU is an Entity State with a usable entity id and position. */
bool player_usable(const DisHeader *header, const uint8_t *pdu);
/* Whether a datagram contains one, of the configured exercise if there is one. header: its header; may be NULL. */
bool player_starts(DisHeader *header, const DisDatagram *datagram, const Config *config);
/* Arrival time, Unix s, at which listening ends when this datagram starts it. */
double player_listens_until_s(const DisDatagram *starts, const Config *config);

/* Applies the rule to a complete log. view: the log from the beginning of the exercise; heard: those of its datagrams
 * that were received in time for the choices. Both borrow from the log. False: no datagram starts the exercise. */
bool player_opening(DisLog *view, DisLog *heard, double *until_s, const DisLog *log, const Config *config);
/* The same of another node's listening, until *until_s; NaN: as above. */
bool player_opening_until(DisLog *view, DisLog *heard, double *until_s, const DisLog *log, const Config *config);

#endif
