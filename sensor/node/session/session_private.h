/* sensor/node/session/session_private.h: the state of a session between frames. */
#ifndef SENSOR_NODE_SESSION_SESSION_PRIVATE_H
#define SENSOR_NODE_SESSION_SESSION_PRIVATE_H

#include "render/frame/world.h"
#include "sensor/frame/frame_world.h"
#include "sensor/node/session/frame_verdict.h"
#include "sensor/node/session/seeker_private.h"
#include "sensor/node/flight/flight_loop.h"
#include "sensor/node/player/player.h"
#include "sensor/node/session/session.h"
#include "sensor/publish/consumers/consumers.h"
#include "sensor/publish/consumers/consumer.h"
#include "sensor/publish/klv/consume_klv.h"
#include "sensor/publish/answers/answers.h"
#include "sensor/instruments/camera.h"

/* Of entities; without a band that shows temperatures there are none. */
typedef struct SessionHeat {
    GivenHeat     *given;    /* NULL: none */
    KeptHeat      *kept;     /* of a run before; NULL: none */
    WorldVehicles *vehicles; /* NULL: parts are as warm as the air */
    Arena         *arena;    /* of the snapshot of a tick */
    uint64_t       changes;  /* entity_table_changes at the last */
} SessionHeat;

/* The last reports of a full table, and of entities that are not shown. */
typedef struct SessionCrowd {
    uint64_t given_up;
    double   given_up_s, left_out_s; /* wall clock */
} SessionCrowd;

/* What is made ready, live. */
typedef struct SessionMadeReady {
    bool  *built; /* [models of the catalog]: by the tracer */
    Arena *arena; /* of a snapshot */
    double next_s;
    int    entities, models, unbuilt;
} SessionMadeReady;

typedef struct HostMotion HostMotion;

struct Session {
    const SessionShared *shared;
    HostPlan             plan; /* host and aim are filled in when they are received */
    char                 out[4096];
    char                 host_text[dis_id_text_size];
    bool                 opened; /* everything is open */
    EntityTable         *table;
    Player              *player; /* the caller's */
    SessionHeat          heat;
    SessionCrowd         crowd;
    SessionMadeReady     ready;
    Status               advance_status; /* the first failure of what outlasts a frame: frames fail with it */
    HostMotion          *host;
    HeadLink            *head;          /* a head tracker that turns its eye; NULL: none, or of a recording */
    int64_t              tick;          /* the next one */
    double               p_aim_ecef[3]; /* last known */
    bool                 aim_known;
    Instruments          instruments;
    FrameVerdicts       *verdicts; /* of the recording that is played; NULL: none */
    Consumers            consumers;
    unsigned             raw;     /* bands of whose raw counts there are files */
    Answers             *answers; /* received; NULL: none */
    Geoid                geoid;   /* for metadata; n_m NULL: none */
    unsigned             wants;   /* of all consumers */
    FramePool           *frames;
    Latency             *latency;      /* NULL: none is kept */
    double               fed_s;        /* of the last frame in it: player_fed_s */
    Pool                *publish_pool; /* of the publishing thread; NULL: publishing is done in this one */
    int                  queued;       /* frames that queues hold, at most */
    QueueCounters        written[5];   /* live: each kind of files; when closed */
    int                  lines_failed; /* live: lines of truth.jsonl; when closed */
    int                  published;    /* frames that all consumers have received: used by the publishing thread */
    Status               listed;       /* of the result's lists: used by the publishing thread */
    SessionResult        result;
    int                  capacity; /* of the result's lists */
};

typedef struct Eye {
    EyeState state;
    View     view;
    double   r_ecef_from_body[9];
    int      hidden; /* snapshot index of the host; -1 */
    bool     at_limit, aim_known;
    double   p_aim_ecef[3];
    double   w_cam_rps[3]; /* how the camera turns, in its own axes */
    bool     turned;       /* by a head tracker: head */
    HeadPose head;
} Eye;

/* How the eye moves: an entity of the table, an observer. One implementation is a struct that begins with this; it
 * names its host by session_name_host when it knows it. */
struct HostMotion {
    Session *s;
    /* State that outlasts a frame: called on a fixed grid of exercise time, whatever frames there are. */
    void (*tick)(HostMotion *host, double tick_s);
    bool (*is_there)(const HostMotion *host); /* false: no image will be rendered */
    /* As session_eye; eye: nothing is filled in yet. */
    bool (*eye)(Eye *eye, HostMotion *host, Snapshot *snapshot, double t_s);
    void (*destroy)(HostMotion *host);
    /* Before each frame, at its time, after the ticks; NULL: nothing. */
    void (*begin)(HostMotion *host, double t_s);
};

/* An entity of the table, or munitions one after the other, and a sensor mounted on it with a gimbal. *out may be there
 * after a failure, to be destroyed. */
Status session_host_entity(HostMotion **out, Session *s);
/* A stand-off observer. */
Status session_host_observer(HostMotion **out, Session *s);
/* A missile that flies by what is seen in its own frames (sensor/node/flight/flight_loop.h). */
Status session_host_flight(HostMotion **out, Session *s);
/* Its loop has the frame that was made, with what its radar detected. */
void session_flight_seen(Session *s, const Frame *frame);
/* As a CIGI host says. */
Status session_host_cigi(HostMotion **out, Session *s);
/* Puts a head tracker on a host, which it takes over, also on failure. */
Status session_host_head(HostMotion **host, Session *s);

/* Names the host of the plan, and adds it to the result's list, once. */
void session_name_host(Session *s);
/* The centre of the aim at t_s; false when it is absent. */
bool session_aim_at(double p_ecef[3], const Session *s, double t_s);
/* Position and direction of the sensor at t_s, not before the last tick. The pose of a host that is an entity is
 * written into the snapshot; NULL: into none. False: the host is absent. */
bool session_eye(Eye *eye, Session *s, Snapshot *snapshot, double t_s);
/* What follows from state.p_ecef and view.r_enu_from_cam. */
void session_finish_eye(Eye *eye, const Session *s);
/* The first failure of what outlasts a frame; logged. */
void session_note_failure(Session *s, const char *what, Status status);
/* Lists a frame that all consumers have received; called in the publishing thread. */
void session_list_frame(void *session, const Frame *frame);
/* Reports entities that did not fit: at once, and then once a minute while there are more. */
void session_report_crowd(Session *s, int left_out);

Status session_heat_open(Session *s);
void   session_heat_warm(Session *s, double tick_s); /* at each tick */
void   session_heat_report(const Session *s);
Status session_heat_keep(const Session *s); /* for a later run, if there is a file to keep it in */
void   session_heat_close(Session *s);

Status session_ready_open(Session *s);
void   session_prepare(Session *s, double t_s); /* before each frame */
void   session_ready_close(Session *s);

/* Feeds everything that counts by t_s and moves the host, on a fixed grid of exercise time. */
void session_advance(Session *s, double t_s);
/* Sets the entities that a full table keeps: host and aim, and those near the host, else near the aim. */
void session_keep(Session *s);
/* One frame, of all but what its consumers do. shown: false when the host is absent. left_out: entities that are not
 * in it. */
Status session_make_frame(bool *shown, int *left_out, Frame *f, Session *s, const FrameTime *when);
/* Makes the folders and files of the products, once, in place of those of an earlier run. */
Status session_begin_files(Session *s);
/* The consumers of this session's frames, from the configuration; and a pool for as many frames as they need. done:
 * each frame that all consumers have received. */
Status session_consumers(Session *s, FrameDone *done);

#endif
