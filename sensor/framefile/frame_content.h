/* sensor/framefile/frame_content.h: the content of a frame file: all inputs of render(), and the hashes of its
 * planes. */
#ifndef SENSOR_FRAMEFILE_FRAME_CONTENT_H
#define SENSOR_FRAMEFILE_FRAME_CONTENT_H

#include "entities/catalog/catalog.h"
#include "sensor/publish/frame.h"
#include "sensor/publish/plane_hash.h"
#include "sensor/settings/tables_used.h"
#include "sensor/truth/truth.h"
#include "terrain/landscape/landscape_parts.h"

enum { frame_models_max = 4096, frame_file_entities_max = 1 << 20 };

/* A model in the snapshot. */
typedef struct FrameModel {
    int  model, node_count;          /* of the catalog that the frame was rendered with */
    char name[model_name_size];
    char sha256[sha256_text_size];   /* of its nodes, parts and facets */
} FrameModel;

/* The results. The statistics are of the finite values alone: they show by how much a plane differs when its hash
 * does. */
typedef struct FramePlane {
    char   name[frame_plane_name_size]; /* lwir/Y, truth/range_m ... as named in hashes of frames */
    char   sha256[sha256_text_size]; /* of this plane by itself (plane_hash) */
    double finite, mean, low, high;
} FramePlane;

/* What a radar was given besides, and what it made. */
typedef struct FrameRadar {
    double   v_enu_mps[3];            /* of the antenna */
    bool     has_aim;
    double   aim_m, aim_v_enu_mps[3];
    uint32_t number;                  /* for its noise */
    int      joint_count;
    double  *joint;                   /* [snapshot.node_count] */
    char     map_sha256[sha256_text_size];
    int      detections;              /* in all */
} FrameRadar;

typedef struct FrameFile {
    const char    *version, *host, *config_sha256; /* of the program; of the frame */
    const char    *settings;         /* YAML as config_read accepts it; without terrain files */
    int            frame;
    double         time_s, unix_s;   /* exercise time; Unix time of exercise time 0 */
    TablesUsed     tables;
    int            model_count;
    FrameModel    *model;
    Snapshot       snapshot;         /* effect_table: the reader's to fill in */
    RenderRequest  request;
    EyeState       eye;
    double         r_ecef_from_body[9];
    double         rate_px_s[2];     /* image motion of the scene, for detectors */
    bool           at_limit, all_on_ground;
    LandscapeParts ground;
    bool           planted;          /* the ground has plants, grown again from: */
    WoodsConfig    woods;            /* its store is the ground's */
    bool           measured;         /* a radar did: */
    FrameRadar     radar;
    char           frame_sha256[sha256_text_size];
    int            plane_count;
    FramePlane    *plane;
} FrameFile;

#endif
