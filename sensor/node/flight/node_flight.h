/* sensor/node/flight/node_flight.h: the missile that a node flies itself, in an exercise that others make: `run --fly`,
 * and a replay of what that recorded.
 *
 * Everything that acts on the world acts at a frame: before one, what has been answered by then is taken, and guides
 * from its time on; a launch, and the hand-over from a missile that has ended to the next of a salvo, is at one. Each
 * such act is noted in the recording (flight_note.h). A replay of a recording with such notes flies by them; one of
 * another recording flies anew, by truth or by its radar. Fire, Entity States and Detonation are sent, and written with
 * the time of the exercise's arrival to DIR/flight.pcapng; DIR/flight.csv has a row a missile. */
#ifndef SENSOR_NODE_FLIGHT_NODE_FLIGHT_H
#define SENSOR_NODE_FLIGHT_NODE_FLIGHT_H

#include "sensor/node/flight/flight_loop.h"
#include "sensor/settings/config.h"

enum { node_flight_rounds_most = 64 }; /* as flight.rounds */

typedef struct NodeFlight NodeFlight;

typedef struct NodeFlightOf {
    const Config *config;
    const char   *folder; /* made by the first launch's time */
    DisEntityId   target;
    uint8_t       version, exercise; /* as in the exercise */
    bool          live;
    const char   *notes;                        /* of the recording that is replayed, DisLog.notes; NULL: none */
    void         *user;                         /* of note and send */
    void (*note)(void *user, const char *text); /* into the recording; NULL: there is none */
    Status (*send)(void *user, const uint8_t *pdu, size_t octets); /* NULL: nothing is sent */
    const void *clock;
    double (*arrival_s)(const void *clock, double t_s); /* Unix time at which an exercise time is over */
} NodeFlightOf;

/* Whether the settings ask for one. */
static inline bool node_flight_asked(const Config *config) { return *config->flight.missile != 0; }
/* Whether no setting is given that a missile's own gimbal and place overrule; else logged. */
bool flight_mount_good(const Config *config);
/* Before anything is received: settings that do not go together, and the row. STATUS_BAD_VALUE, logged. */
Status node_flight_check(const Config *config, bool live);
Status node_flight_open(NodeFlight **out, const NodeFlightOf *of);
/* For SessionShared.flight. */
FlightLoop *node_flight_loop(NodeFlight *flight);
/* Writes what is left, and says what came of each. NULL is valid. */
Status node_flight_close(NodeFlight *flight);

#endif
