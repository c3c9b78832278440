/* sensor/quality/trial_private.h: the scene of measurements: bare ground, vehicles on it, the sun of a summer noon, a
 * view. */
#ifndef SENSOR_QUALITY_TRIAL_PRIVATE_H
#define SENSOR_QUALITY_TRIAL_PRIVATE_H

#include "entities/table/entity_table.h"
#include "render/frame/render.h"
#include "render/frame/world.h"
#include "sensor/truth/truth.h"
#include "sensor/frame/plane.h"

typedef struct TrialScene {
    const Landscape *landscape; /* not its own */
    Catalog         *catalog;
    World            world;
    EntityTable     *table;
    WorldVehicles   *vehicles;   /* of trial_warm */
    int              past_parts; /* WorldVehiclesConfig */
    double           unix_s, sun_now_s;
} TrialScene;

/* vehicles: this many in rows of five, 40 m apart, around the origin, turrets and guns rotated; types: used in turn. */
Status trial_scene_open(TrialScene *out, const Landscape *landscape, const char *catalog_path,
                        const DisEntityType *types, int type_count, int vehicles);
/* Warms its ground again, as config says. */
Status trial_scene_warm(TrialScene *scene, const HeatConfig *config);
/* Temperatures of the scene's entities into its snapshot. From then on the scene must stay where it is. */
Status trial_warm(TrialScene *scene, Snapshot *snapshot, Arena *arena);
void   trial_scene_close(TrialScene *scene);

/* Where trial_scene_place puts an entity at the scene's time: this far east and north of the origin, and this high
 * above the ground. */
typedef struct TrialPlace {
    DisEntityType type;
    int           number;                             /* 1 .. 65535: the entity */
    double        east_m, north_m, above_m, turn_rad; /* turn: heading, from north towards east */
    uint32_t      appearance;
} TrialPlace;
Status trial_scene_place(const TrialScene *scene, const TrialPlace *place);

/* Gives a view of the origin from this far south of it and this high above it. */
View trial_view(const TrialScene *scene, double back_m, double above_m, double hfov_rad, int width, int height);

/* What a node asks for with the default settings (sensor/node/session/session_frame.c): all bands and planes of
 * truth, antialiasing, the estimate of its error, low plants where the world has a forest, and the radar's profile
 * about range_m. */
RenderRequest trial_default_request(const TrialScene *scene, const View *view, double range_m);

/* The stages of a frame, in order. A stage that several threads work on has the mean of their times, so that on one
 * thread the stages add up to the frame. The passes (STAGE_BASE, STAGE_EDGES) split the same time by the kind of
 * sample. */
typedef enum TrialStage {
    STAGE_FRAME,
    STAGE_SNAPSHOT,
    STAGE_AIR,
    STAGE_PREPARE,
    STAGE_VISIBILITY,
    STAGE_SUN,
    STAGE_SHADE,
    STAGE_RADAR,
    STAGE_REST, /* of the pixels: truth planes, areas of targets, edges found */
    STAGE_TRUTH,
    STAGE_FOOTPRINTS,
    STAGE_BASE,
    STAGE_EDGES,
    TRIAL_STAGE_COUNT
} TrialStage;

/* One frame as a node renders it, up to the planes; all in the arena, which is reset first. */
typedef struct TrialFrame {
    const TrialScene *scene;
    RenderRequest     request;
    Pool             *pool;
    Arena            *arena;
    Status            status;
    Snapshot          snapshot;
    Sun               sun;
    Air               air;
    Picture           picture;
    int               targets;
    double            stage_s[TRIAL_STAGE_COUNT];
} TrialFrame;

/* user: a TrialFrame. */
void trial_frame(void *user);
/* Hashes every plane of its picture. */
Status trial_frame_hash(char out[sha256_text_size], const TrialFrame *frame);

#endif
