/* sensor/node/run/host_run.h: shared by replay and run: from received datagrams to choices, a world, a session,
 * run.json. */
#ifndef SENSOR_NODE_RUN_HOST_RUN_H
#define SENSOR_NODE_RUN_HOST_RUN_H

#include "dis/network/udp.h"
#include "sensor/node/clock/frame_clock.h"
#include "sensor/node/run/made_world.h"
#include "sensor/node/run/world_note.h"
#include "sensor/node/session/session.h"
#include "sensor/settings/options.h"
#include "sensor/settings/tables_used.h"

typedef struct Run Run;
struct Run {
    Options               options;
    DisLog                view;    /* the log to play; borrowed */
    double                until_s; /* causal: arrival time of the last datagram used by the choices */
    bool                  noted;   /* the recording says what its world was made from: world_note */
    WorldNote             world_note;
    bool                  stopped;  /* by a signal, before the last frame */
    uint64_t              own;      /* datagrams of this node, ignored */
    const DisLogCounters *link;     /* NULL: live */
    LiveCounters         *live;     /* NULL: a replay */
    const char           *log_name; /* in run.json */
    char                  config_sha256[sha256_text_size], log_sha256[sha256_text_size];
    unsigned              bands;
    int                   exercise; /* -1: all */
    DisHeader             first;    /* of the first usable Entity State: version and exercise of what is sent */
    MadeWorld            *made;     /* log, survey, catalog, world, threads; the caller's, or by run_made */
    bool                  owns;     /* made */
    Choices               choices;  /* shared by all hosts */
    Sensors               sensors;
    TablesUsed            tables; /* in run.json */
    /* Whether there are frames to be rendered, before the world is set up; may be NULL. */
    Status (*check)(Run *run, const Player *player, const HostPlan *plan, const FrameGrid *grid);
    /* Renders the frames. */
    Status (*frames)(Run *run, Session *session, Player *player, const HostPlan *plan, const FrameGrid *grid);
    void (*publish)(void *user, const Frame *frame);        /* may be NULL */
    void (*note)(void *user, const char *text);             /* into the recording; may be NULL */
    unsigned (*choose)(void *user, const FrameTime *frame); /* SessionShared.choose; may be NULL */
    DisSend           *send;   /* sends the Data PDUs of publish.dis; NULL: they are not sent */
    DisSend           *report; /* sends what a missile of the node's own (flight.missile) says; NULL: it is not sent */
    void              *user;   /* passed to these six */
    FrameClock        *clock;  /* the command's, of `frames`; NULL where none are made */
    struct CigiNode   *cigi;   /* SessionShared.cigi; the command's */
    struct FlightLoop *flight; /* SessionShared.flight; likewise */
};

/* Where settings are chosen for a frame time: how fast this machine is, into quality.machine_factor, and among the
 * choices. Some tenths of a second. */
Status run_measure_machine(Run *run);
/* Bands, sensors, hash of the configuration: before anything is received. */
Status run_prepare(Run *run);
/* Makes run->made, where the caller gave none. */
Status run_made(Run *run);
/* Finds exercise and survey from the received datagrams, and opens catalog and pool. from: what the world follows
 * from (made_basis). */
Status run_survey(Run *run, const DisLog *heard, const DisLog *from);
/* Host, aim and span of a host as run_host has them: what is wrong with them is logged, in a second. */
Status run_check(Run *run, const DisEntityId *host);
/* Runs one host, with its own ground and frame, and its own folder when there are several. host NULL: the configured or
 * chosen one. */
Status run_host(Run *run, const DisEntityId *host);
/* run.json of a live run that ended before it heard an entity, without a frame; nothing where an earlier run's products
 * are, which stay until a first frame. */
Status run_unheard(Run *run);
void   run_close(Run *run);
/* Names the folder for the products of one host. */
enum { run_folder_size = 4096 };
void run_folder(char out[run_folder_size], const Options *options, DisEntityId host);

/* The addresses of the configuration: where a node listens, where it and a replay send. The port is exercise.port, or
 * 3000 where that is chosen or any. */
DisUdpConfig run_network(const Config *config);

/* The destination, for messages. */
enum { run_network_to_size = dis_udp_address_size + 16 };
void run_network_to(char out[run_network_to_size], const DisUdpConfig *udp);

#endif
