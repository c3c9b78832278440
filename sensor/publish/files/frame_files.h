/* sensor/publish/files/frame_files.h: one frame's images into OUT/frames/<band>/NNNNNN.exr and .png: radiance at the
 * aperture, and the display behind the detector. Raw counts of a band with a sensor: OUT/raw/<band>/NNNNNN.png, 16
 * bits. */
#ifndef SENSOR_PUBLISH_FILES_FRAME_FILES_H
#define SENSOR_PUBLISH_FILES_FRAME_FILES_H

#include "sensor/frame/frame.h"
#include "entities/table/snapshot.h"

typedef struct FrameFiles {
    const char          *out; /* folder of this host; exists, with its subfolders */
    const Config        *config;
    const World         *world;
    const Picture       *picture;
    const Snapshot      *snapshot;
    const RenderRequest *request;
    const char          *host, *config_sha256;
    int                  frame;
    double               time_s, unix_s;
    bool                 png, raw; /* displays; raw counts, where there are any */
    const FrameDisplay  *display;  /* [BAND_COUNT]; displays of bands and truth, if png */
} FrameFiles;

/* Bands with a detector: all but radar. */
enum { detector_bands = ((1 << BAND_COUNT) - 1) & ~(1 << BAND_RADAR) };

/* OUT must leave frame_path_room characters for the paths below it; a longer one is refused, logged.
 *     folder            creates OUT, or logs why not; its content stays
 *     check             whether anything in OUT keeps a run from writing its products: a link, a file where a folder
 *                       belongs, permissions; logged. Changes nothing
 *     earlier           whether OUT holds a product of an earlier run that would be lost, and its path
 *     clear             removes the products of an earlier run from OUT, of all bands; nothing else
 *     clear_videos      the same of a folder of videos of bands
 *     prepare           clear, and creates OUT and the folders below it for these bands, and for raw counts of those
 *                       in raw; a clear message when the place cannot be written. No bands: OUT alone. bands: with
 *                       frame_truth, truth too
 *     prepare_displays  only for the products of frame_files_write_displays; clears nothing */
enum { frame_path_size = 4096, frame_path_room = 64, frame_truth = 1 << BAND_COUNT };
Status frame_files_folder(const char *out);
Status frame_files_check(const char *out);
bool   frame_files_earlier(char found[frame_path_size], const char *out);
void   frame_files_clear(const char *out);
void   frame_files_clear_videos(const char *folder);
Status frame_files_prepare(const char *out, unsigned bands, unsigned raw);
Status frame_files_prepare_displays(const char *out, unsigned bands, unsigned raw);
/* Folders below OUT for each frame's other images (sensor/publish/consumers/consume_pairs.h). */
enum { pair_folders = 3 };
extern const char *const pair_folder[pair_folders];
/* Whether any plane of truth is written to files. */
bool frame_files_truth(const Config *config);
/* Writes all files of the frame, one task per file. hash: over all planes, before encoding; NULL: none. */
Status frame_files_write(char hash[sha256_text_size], const FrameFiles *frame, Pool *pool);
/* Only the products of detectors: display images and raw counts of its bands. */
Status frame_files_write_displays(const FrameFiles *frame, Pool *pool);
/* OUT/FOLDER/NAME/NNNNNN.ENDING. False, logged: it is too long. */
bool frame_path(char path[frame_path_size], const FrameFiles *frame, const char *folder, const char *name,
                const char *ending);

/* UTC as image files have it, YYYY:MM:DD HH:MM:SS. */
void frame_date(char out[32], double unix_s);

/* ---- displays (display_files.c) ---------------------------------------------------------------- */

/* Writes the band's display image and its raw counts, as requested. BAND_COUNT: the preview of truth. */
Status frame_files_write_display(const FrameFiles *frame, int band);

/* Truth as a preview image: one colour per entity, over range shading. rgb: [count][3]. Ground: grey by range, light
 * near and dark far, logarithmic between the nearest and the farthest finite range. Sky (range not finite): dark blue.
 * Entities (plane: snapshot index + 1): a colour that depends on the id alone, so that it stays from frame to frame; an
 * index beyond the snapshot: white. normal_up (the plane nz; may be NULL) shades both. */
void frame_files_preview(uint8_t *rgb, const float *range_m, const uint32_t *entity, const float *normal_up,
                         size_t count, const Snapshot *snapshot);

#endif
