/* sensor/framefile/frame_file.h: one frame as a file: all that render() takes, and the hashes of what came out, so that
 * another machine renders it again without log, network or elevation files. The format: etc/FRAME_FILE.md.
 *
 * What every installation has (tables of etc/, models) goes by its hash alone; settings, snapshot, request, eye and
 * ground are in the file. */
#ifndef SENSOR_FRAMEFILE_FRAME_FILE_H
#define SENSOR_FRAMEFILE_FRAME_FILE_H

#include "sensor/framefile/chunks.h"
#include "sensor/framefile/frame_content.h"

/* The file's octets. kept: of a ground of files, the part that is stored (ground_cutout.h); NULL: all of it. */
struct GroundCutout;
Status frame_file_pack(ByteSink *out, const FrameFile *file, const struct GroundCutout *kept);
/* From octets that may be hostile: every count bounded, every figure within its range, so that world and render() can
 * be given it once its models are known to agree. All in the arena. Logs what is wrong as the path's. */
Status frame_file_parse(FrameFile *out, const uint8_t *bytes, size_t count, const char *path, Arena *arena);

/* SHA-256 of a model's nodes, parts and facets. */
Status frame_model_sha256(char out[sha256_text_size], const Model *model);

#endif
