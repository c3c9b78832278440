/* sensor/node/session/session.h: the seeker of one host over an exercise: frame after frame, rendered and published. */
#ifndef SENSOR_NODE_SESSION_SESSION_H
#define SENSOR_NODE_SESSION_SESSION_H

#include "dis/head/head_link.h"
#include "entities/table/entity_table.h"
#include "render/frame/render.h"
#include "sensor/node/choices/choices.h"
#include "sensor/node/clock/frame_clock.h"
#include "sensor/node/player/player.h"
#include "sensor/publish/dis/consume_dis.h"
#include "sensor/instruments/instrument.h"
#include "sensor/frame/publish_counters.h"
#include "sensor/frame/plane.h"
#include "sensor/frame/records.h"
#include "pitviper.h"

/* Shared by all hosts of one run. */
typedef struct SessionShared {
    const Config                *config;
    const Survey                *survey;
    const Catalog               *catalog;
    World                       *world;
    Pool                        *pool;
    double                       unix_s; /* Unix time of exercise time 0 */
    unsigned                     bands;
    bool                         no_skip;
    GroundContact                contact; /* which entities are clamped to the world's ground */
    bool                         live;    /* a file that cannot be written does not end the session */
    const char                  *config_sha256;
    const Sensors               *sensors;
    const InstrumentKind *const *instruments;        /* instrument_kinds */
    void (*publish)(void *user, const Frame *frame); /* called for each frame; NULL: not */
    void             *user;
    const DisOf      *dis;                      /* Data PDUs of each frame, its clock being the player; NULL: none */
    const FrameClock *clock;                    /* one on the wall: a latency ledger is kept, and streams are left out
                                                 * when late; NULL: none */
    int                 save_count;             /* frames that are also written as frame files, ascending */
    const int          *save;                   /* [save_count] */
    const WoodsConfig  *woods;                  /* of the world's plants; NULL: none */
    const FrameScenery *scenery;                /* what stands there; may be empty */
    const char         *isa;                    /* as tracer_create */
    void (*note)(void *user, const char *text); /* into the live recording; NULL: there is none; user: as above */
    const char *notes;                          /* of the recording that is played, DisLog.notes; NULL: none */
    /* What a frame of a live node gives up (frame_verdict.h), chosen before it is rendered, and noted. NULL: nothing;
     * user: as above. */
    unsigned (*choose)(void *user, const FrameTime *frame);
    struct CigiNode   *cigi;    /* a host that gives time and eye, frame by frame, and waits for each; NULL: none */
    struct FlightLoop *flight;  /* a missile whose seeker this is, flown by what is seen of the frames; NULL: none */
    bool               several; /* hosts, one after the other: what has a name of its own gets the host's too */
} SessionShared;

enum { session_stages = 6, session_frames_kept = 1000000, session_hosts_kept = 64 };
extern const char *const session_stage_name[session_stages];

/* Lists hold the first session_frames_kept frames; a live node may render more. */
typedef struct SessionResult {
    bool            begun; /* it has files: what an earlier run left is gone */
    int             frames;
    int             listed;
    int             buried;                        /* frames with the sensor below the ground */
    int             at_limit;                      /* frames whose aim was beyond the gimbal limit */
    int             frames_crowded, most_left_out; /* frames without all entities; the most that one frame lacks */
    int             host_count;                    /* the first session_hosts_kept hosts, in order */
    char            host[session_hosts_kept][dis_id_text_size];
    InstrumentCount instrument[instruments_most]; /* frames that lack one */
    int             frames_reduced;               /* frames of less quality than was set */
    AnswerCounters  answers;                      /* of a recogniser; when closed */
    SentCounters    sent;                         /* likewise: streams, ring of frames, projector */
    HeadCounters    head;                         /* likewise: of a head tracker */
    int files_failed, files_left_out;   /* live: frames without files, for disk errors, for time; when closed */
    int(*number);                       /* [listed] */
    char (*hash)[sha256_text_size];     /* [listed] */
    double (*stage_ms)[session_stages]; /* [listed] */
    LatencySummary latency;             /* when closed; of a session with a ledger */
    RenderCounters counters;
    EntityCounters entities;
    EffectCounters effects;
    uint64_t       shots_forgotten, munitions_forgotten; /* player_forgotten */
} SessionResult;

typedef struct Session Session;

/* Opens a session. It makes its files at once where `out` has no products of an earlier run; else these stay until the
 * first frame takes their place. The player and shared must outlive the session. */
Status session_open(Session **out, const SessionShared *shared, const HostPlan *plan, Player *player,
                    const char *folder);
/* Processes everything up to its t_s, which must not decrease, then renders the frame. shown: false when the host is
 * absent. */
Status session_frame(bool *shown, Session *session, const FrameTime *frame);
/* So far. */
const SessionResult *session_result(const Session *session);
int                  session_entities(const Session *session); /* entities present */
uint64_t session_over_rate(const Session *session); /* reports of new entities above the rate: entities.new_per_s */
/* What a live session has made ready of the entities heard, and how much is still to be made. */
typedef struct SessionReady {
    int entities, models, signatures, waiting;
} SessionReady;
SessionReady session_ready(const Session *session);
/* Whether it has a missile, and the last of its salvo has ended. */
bool session_flight_over(const Session *session);
/* Frames that consumers were not given so far, as latency_lost. */
uint64_t    session_lost(char out[latency_lost_size], const Session *session);
const char *session_host(const Session *session); /* id as text, `observer`, or `munition` while there is none */
/* The caller frees the session's result with session_result_free; NULL: it is freed too. */
Status session_close(Session *session, SessionResult *result);
void   session_result_free(SessionResult *result);

#endif
