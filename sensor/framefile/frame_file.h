/* sensor/framefile/frame_file.h: one frame as a file: all that render() takes, and the hashes of what came out, so that
 * another machine renders it again without log, network or elevation files. The format: etc/FRAME_FILE.md.
 *
 * What every installation has (tables of etc/, models) goes by its hash alone; settings, snapshot, request, eye and
 * ground are in the file. */
#ifndef SENSOR_FRAMEFILE_FRAME_FILE_H
#define SENSOR_FRAMEFILE_FRAME_FILE_H

#include "entities/catalog/catalog.h"
#include "sensor/framefile/chunks.h"
#include "sensor/publish/frame.h"
#include "sensor/publish/plane_hash.h"
#include "sensor/settings/tables_used.h"
#include "sensor/truth/truth.h"
#include "terrain/landscape/landscape_parts.h"

enum { frame_models_max = 4096, frame_file_entities_max = 1 << 20 };

/* A model that the snapshot holds. */
typedef struct FrameModel {
    int  model, node_count;          /* of the catalog that the frame was made with */
    char name[model_name_size];
    char sha256[sha256_text_size];   /* of its nodes, parts and facets */
} FrameModel;

/* What came out. The figures are of the finite values alone: by how much a plane differs when its hash does. */
typedef struct FramePlane {
    char   name[frame_plane_name_size]; /* lwir/Y, truth/range_m ... as hashes of frames name them */
    char   sha256[sha256_text_size]; /* of this plane by itself (plane_hash) */
    double finite, mean, low, high;
} FramePlane;

typedef struct FrameFile {
    const char    *version, *host, *config_sha256; /* of the program; of the frame */
    const char    *settings;         /* YAML as config_read takes it; without files of ground */
    int            frame;
    double         time_s, unix_s;   /* exercise time; Unix time of exercise time 0 */
    TablesUsed     tables;
    int            model_count;
    FrameModel    *model;
    Snapshot       snapshot;         /* effect_table: the reader's to fill in */
    RenderRequest  request;
    EyeState       eye;
    double         r_ecef_from_body[9];
    double         rate_px_s[2];     /* how the scene moves over the picture, for detectors */
    bool           at_limit, all_on_ground;
    LandscapeParts ground;
    char           frame_sha256[sha256_text_size];
    int            plane_count;
    FramePlane    *plane;
} FrameFile;

/* The file's octets. kept: of a ground of files, the part that is stored (ground_cutout.h); NULL: all of it. */
struct GroundCutout;
Status frame_file_pack(ByteSink *out, const FrameFile *file, const struct GroundCutout *kept);
/* From octets that may be hostile: every count bounded, every figure within its range, so that world and render() can
 * be given it once its models are known to agree. All in the arena. Logs what is wrong as the path's. */
Status frame_file_parse(FrameFile *out, const uint8_t *bytes, size_t count, const char *path, Arena *arena);

/* SHA-256 of a model's nodes, parts and facets. */
Status frame_model_sha256(char out[sha256_text_size], const Model *model);

#endif
