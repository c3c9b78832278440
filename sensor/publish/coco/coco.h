/* sensor/publish/coco/coco.h: coco.json, the COCO detection format (cocodataset.org, pycocotools): a second writer of
 * the record that truth.jsonl is written from.
 *
 *     images       one per frame and band; file_name relative to the folder of coco.json; id 4 frame + number of the
 *                  band among optical, mwir, lwir, radar, from 1 on
 *     annotations  one per image and target of which something is visible; id from 1 on. iscrowd and ignore 0: a
 *                  target to be found. segmentation: its pixels in the truth plane `entity`, compressed run lengths
 *                  (below); bbox [x, y, w, h]: their box, the first pixel is 0; area: their
 *                  number. iscrowd and ignore 1: an ignore region, in which a detection of the class is neither right
 *                  nor wrong: the target is below a limit in this image (CocoLimits), or fills no pixel by more than
 *                  half. segmentation, bbox, area: the whole box of the pixels that show any part of it, since a
 *                  detection counts as within by the share of its own area. ignored_as: the first of `no_mask`,
 *                  `small`, `hidden`, `faint` that holds. plane_value: its value in the truth plane; pixels: area with
 *                  parts of pixels; snr and contrast: of the image's band; bbox_amodal: of all of it, hidden parts and
 *                  what lies outside the image too; the others as in truth.jsonl
 *     categories   all of sensor/frame/target_record.h, whatever is visible: sets can be joined; and `clutter`, where
 *                  there is an annotation of it (coco_clutter)
 *
 * A target that is hidden is in truth.jsonl only. Written frame by frame to coco.json.part, and renamed when complete;
 * memory does not grow with the number of frames. */
#ifndef SENSOR_PUBLISH_COCO_COCO_H
#define SENSOR_PUBLISH_COCO_COCO_H

#include "sensor/frame/records.h"

typedef struct Coco Coco;

/* Below these a target is no annotation but an ignore region. A share that is unknown fits no limit; an snr that is
 * (TargetBand) is of a target without surroundings or an image without noise, and fits any. */
typedef struct CocoLimits {
    int    min_pixels;  /* 1 or more: of the mask */
    double min_visible; /* 0 .. 1: of the target's area on the image */
    double min_snr;     /* 0 or more: of its snr without the sign, in the image's band */
} CocoLimits;

/* ending: that of the image files, "png" or "exr". */
Status coco_open(Coco **out, const char *folder, const char *ending, CocoLimits limits, const char *config_sha256,
                 long long seed);
/* Opens FOLDER/coco.json, before the first frame. */
Status coco_begin(Coco *coco);
/* entity: the truth plane of the frame, [height][width], with snapshot index + 1. STATUS_IO, logged. */
Status coco_frame(Coco *coco, const FrameRecord *record, const uint32_t *entity);
/* What the frame's record has of clutter, as annotations of the category coco_clutter_category in each image. They have
 * `class` and `clutter` (its id) where those of targets have `entity` and `type`. plane: [height][width], 1 + index of
 * record->clutter; 0: none of it. STATUS_IO, logged. */
Status coco_clutter(Coco *coco, const FrameRecord *record, const uint32_t *plane);
/* Joins the parts and renames the file; after a failure, or when this one fails (STATUS_IO, logged), there is none.
 * NULL is valid. */
Status coco_close(Coco *coco);

/* ---- masks --------------------------------------------------------------------------------------- */

/* Masks in COCO's compressed run lengths, as public readers (pycocotools) expect them.
 *
 * Runs go down the columns, the first one of pixels that are not in the mask (0 when the first pixel is). From the
 * fourth run on it is coded as its difference to the run two before. Each number is written five bits at a time, the
 * lowest first, with a sixth bit when more follow and the sign in the last group's highest, as the character 48 +
 * group. */

/* Where a value lies in a plane. */
typedef struct CocoMaskExtent {
    long long pixels;
    int       box[4]; /* first column, first row, last column + 1, last row + 1; no pixels: all 0 */
} CocoMaskExtent;

/* extent[k] of value k + 1 for each k < count, in one pass. Larger values are ignored. */
void coco_mask_extents(CocoMaskExtent *extent, int count, const uint32_t *plane, int width, int height);

enum { coco_mask_run_characters = 7 };
/* Characters that hold the text of any mask of this extent, including its terminator. */
size_t coco_mask_text_size(const CocoMaskExtent *extent);
/* Writes the mask of the pixels of this value. text: coco_mask_text_size characters. */
void coco_mask_text(char *text, const uint32_t *plane, uint32_t value, int width, int height,
                    const CocoMaskExtent *extent);
/* All pixels of the extent's box, which is not empty and lies within the image. */
void coco_mask_box_text(char *text, int width, int height, const CocoMaskExtent *extent);

#endif
