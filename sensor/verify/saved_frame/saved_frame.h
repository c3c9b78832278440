/* sensor/verify/saved_frame/saved_frame.h: one frame as a file: all inputs of render(), and the hashes of its
 * results, so that another machine renders it again without log, network or elevation files. The format:
 * etc/FRAME_FILE.md.
 *
 * Data of every installation (tables of etc/, models) are identified by their hashes alone; settings, snapshot,
 * request, view and ground are in the file. */
#ifndef SENSOR_VERIFY_SAVED_FRAME_SAVED_FRAME_H
#define SENSOR_VERIFY_SAVED_FRAME_SAVED_FRAME_H

#include "entities/catalog/catalog.h"
#include "sensor/frame/frame.h"
#include "sensor/frame/frame_scenery.h"
#include "sensor/frame/plane.h"
#include "sensor/settings/tables_used.h"
#include "sensor/truth/truth.h"
#include "terrain/ground/landscape_parts.h"
#include "sensor/verify/saved_frame/chunks_private.h"

enum { saved_models_max = 4096, saved_entities_max = 1 << 20 };

/* A model in the snapshot. */
typedef struct SavedModel {
    int  model, node_count; /* of the catalog that the frame was rendered with */
    char name[model_name_size];
    char sha256[sha256_text_size]; /* of its nodes, parts and facets */
} SavedModel;

/* The results. The statistics are of the finite values alone: they show by how much a plane differs when its hash
 * does. */
typedef struct SavedPlane {
    char   name[frame_plane_name_size]; /* lwir/Y, truth/range_m ... as named in hashes of frames */
    char   sha256[sha256_text_size];    /* of this plane by itself (plane_hash) */
    double finite, mean, low, high;
} SavedPlane;

/* What a radar was given besides the scene, and what it made. */
typedef struct SavedRadar {
    double   v_enu_mps[3]; /* of the antenna */
    bool     has_aim;
    double   aim_m, aim_v_enu_mps[3];
    uint32_t number; /* for its noise */
    int      joint_count;
    double  *joint; /* [snapshot.node_count] */
    char     map_sha256[sha256_text_size];
    int      detections; /* in all */
    bool     coarse;     /* with coarse signatures */
} SavedRadar;

/* What scenery follows from. Its heat is not kept: it follows from scenery, weather and time, whatever frames were
 * rendered before (render/heat/scenery_heat.h). */
typedef struct SavedScenery {
    SceneryPlan plan;
    Culture     culture; /* CULTURE_FROM_RECORDS: as it came from files, not indexed */
    int         drivens; /* FrameScenery.driven */
    DrivenPath *driven;
    int         objects; /* of the scenery made of it, and its hash, by which a difference is noticed: */
    char        sha256[sha256_text_size];
} SavedScenery;

typedef struct SavedFrame {
    const char    *version, *host, *config_sha256; /* of the program; of the frame */
    const char    *settings;                       /* YAML as config_read accepts it; without terrain files */
    int            frame;
    double         time_s, unix_s; /* exercise time; Unix time of exercise time 0 */
    TablesUsed     tables;
    int            model_count;
    SavedModel    *model;
    Snapshot       snapshot; /* effect_table: the reader's to fill in */
    RenderRequest  request;
    EyeState       eye;
    double         r_ecef_from_body[9];
    double         rate_px_s[2]; /* image motion of the scene, for detectors */
    double         ground_km2;   /* as in FrameRecord */
    bool           at_limit, all_on_ground;
    LandscapeParts ground;
    char           ground_sha256[sha256_text_size]; /* of the octets that were read as the ground */
    bool           planted;                         /* the ground has plants, grown again from: */
    WoodsConfig    woods;                           /* its store is the ground's */
    bool           built;                           /* the world has scenery, made again from: */
    SavedScenery   scenery;
    bool           measured; /* a radar did: */
    SavedRadar     radar;
    char           frame_sha256[sha256_text_size];
    int            plane_count;
    SavedPlane    *plane;
} SavedFrame;

/* Writes the file's octets. kept: the part of terrain from files that is stored (ground_cutout_private.h); NULL: all of
 * it. */
struct GroundCutout;
Status saved_frame_pack(ByteSink *out, const SavedFrame *file, const struct GroundCutout *kept);
/* From octets that may be hostile: every count bounded, every value in its range, so that world and render() can use
 * it once its models are known to agree. All in the arena. Errors are logged with the path. */
Status saved_frame_parse(SavedFrame *out, const uint8_t *bytes, size_t count, const char *path, Arena *arena);

/* Hashes the nodes, parts and facets of a model. */
Status saved_model_sha256(char out[sha256_text_size], const Model *model);
/* Hashes the models of a scenery, its objects, states, movers and lamps. */
Status saved_scenery_sha256(char out[sha256_text_size], const Scenery *scenery);

#endif
