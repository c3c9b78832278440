/* sensor/node/run/made_world.h: what a run makes before its first frame, in layers that a later run of the same process
 * takes over: hosts of one replay, variants of a sweep.
 *
 * A layer has a key: a hash of all that it follows from. The settings that it may depend on are named in one line
 * (config_part), and those that make it see no others; survey, evidence, frame and tables are in the key by their
 * content. It is made again when its key differs, and with it all layers above; but a log and a
 * survey leave the catalog, and ground of terrain.place, which follow from neither. The lines of its choices are kept
 * with it, so that every run prints them. Bits do not depend on what was taken over (tests/system/test_sweep_share.sh).
 * Changed files of models and terrain are not detected; changed tables are. */
#ifndef SENSOR_NODE_RUN_MADE_WORLD_H
#define SENSOR_NODE_RUN_MADE_WORLD_H

#include "render/frame/world.h"
#include "sensor/node/choices/choices.h"
#include "sensor/settings/tables_used.h"

typedef enum MadeLayer {
    MADE_LOG,     /* its datagrams: by file, port, own ids */
    MADE_SURVEY,  /* by log and exercise */
    MADE_CATALOG, /* by models.* and the tables */
    MADE_GROUND,  /* by terrain.*, seed, origin, evidence */
    MADE_CULTURE, /* what people built, and clutter: by the ground and their square */
    MADE_WOODS,   /* where plants stand: by the ground, what is built, and their square */
    MADE_MODELS,  /* what rays meet: models, plants, materials */
    MADE_AIR,     /* atmosphere */
    MADE_WARM,    /* ground warmed up to exercise time 0 */
    MADE_LAYERS
} MadeLayer;

typedef struct MadeWorld {
    Cache       *cache; /* of the disk; NULL: none */
    Pool        *pool;
    int          threads; /* of pool */
    DisLog       log;
    char         log_sha256[sha256_text_size];
    uint64_t     own;    /* datagrams of this node, which are not in the log */
    Survey       survey; /* what hosts and aims are chosen by */
    Survey       basis;  /* what the world follows from, where it is another: made_basis */
    bool         has_basis;
    DisDatagram *retimed; /* the log's datagrams by the other of packet times and times by stamps; NULL: they are one */
    Catalog     *catalog;
    Landscape    landscape;
    GroundContact contact;
    FrameScenery  scenery;
    WoodsChoice   woods;
    World         world;
    Config        part[MADE_LAYERS];                  /* the settings that a layer was made by */
    Choices       said[MADE_LAYERS];                  /* its lines */
    char          key[MADE_LAYERS][sha256_text_size]; /* empty: not made */
    int           made[MADE_LAYERS];                  /* how often, since it was created */
} MadeWorld;

Status made_world_create(MadeWorld **out);
void   made_world_destroy(MadeWorld *made); /* accepts NULL */

/* Opens and hashes the log, without this node's own datagrams. Again only where the file, by its inode, size and times,
 * or what is taken of it differs; a pipe always. *own: how many were left out. */
Status made_log(MadeWorld *made, const char *path, const Config *config);
/* heard: what the choices are made by. Kept where it is all of made->log, of the same exercise. */
Status made_survey(MadeWorld *made, const DisLog *heard, int exercise);
/* What ground, plants and roads follow from: all of a recording, causal or not, or what a live node had heard when it
 * made them. heard: what the survey is of, which is taken where `from` is the same. */
Status made_basis(MadeWorld *made, const DisLog *from, const DisLog *heard, int exercise);
/* The log by packet times, or by times that keep pace with its stamps, whatever a replay takes. */
DisLog        made_log_by(const MadeWorld *made, const Config *config, bool packet_times);
const Survey *made_basis_survey(const MadeWorld *made);
Status        made_catalog(MadeWorld *made, const Config *config, const TablesUsed *tables);
Status        made_pool(MadeWorld *made, int threads);
/* Opens the cache of the disk, unless it is open or cache.on is off. A failure is logged, and costs time alone. */
void made_cache(MadeWorld *made, const Config *config);

/* What the world follows from, beside survey and catalog. */
typedef struct MadeOf {
    const Config      *config;
    const TablesUsed  *tables;
    const HostPlan    *plan;
    const LocalFrame  *frame;
    const WoodsSquare *square;
    double             unix_s; /* of exercise time 0 */
    const char        *isa;
} MadeOf;
/* Makes or takes over ground, woods, models, air and warmth; adds the lines of their choices. */
Status made_world(MadeWorld *made, Choices *choices, const MadeOf *of);

#endif
