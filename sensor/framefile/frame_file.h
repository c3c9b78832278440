/* sensor/framefile/frame_file.h: one frame as a file: all inputs of render(), and the hashes of its results, so that
 * another machine renders it again without log, network or elevation files. The format: etc/FRAME_FILE.md.
 *
 * Data of every installation (tables of etc/, models) are identified by their hashes alone; settings, snapshot,
 * request, view and ground are in the file. */
#ifndef SENSOR_FRAMEFILE_FRAME_FILE_H
#define SENSOR_FRAMEFILE_FRAME_FILE_H

#include "sensor/framefile/chunks.h"
#include "sensor/framefile/frame_content.h"

/* The file's octets. kept: of terrain from files, the part that is stored (ground_cutout.h); NULL: all of it. */
struct GroundCutout;
Status frame_file_pack(ByteSink *out, const FrameFile *file, const struct GroundCutout *kept);
/* From octets that may be hostile: every count bounded, every value in its range, so that world and render() can use
 * it once its models are known to agree. All in the arena. Errors are logged with the path. */
Status frame_file_parse(FrameFile *out, const uint8_t *bytes, size_t count, const char *path, Arena *arena);

/* SHA-256 of a model's nodes, parts and facets. */
Status frame_model_sha256(char out[sha256_text_size], const Model *model);

#endif
