/* sensor/publish/coco_mask.h: masks in COCO's compressed run lengths, as public readers (pycocotools) expect them.
 *
 * Runs go down the columns, the first one of pixels that are not in the mask (0 when the first pixel is). From the
 * fourth run on it is coded as its difference to the run two before. Each number is written five bits at a time, the
 * lowest first, with a sixth bit when more follow and the sign in the last group's highest, as the character 48 +
 * group. */
#ifndef SENSOR_PUBLISH_COCO_MASK_H
#define SENSOR_PUBLISH_COCO_MASK_H

#include "pitviper.h"

/* Extent of a value in a plane. */
typedef struct MaskExtent {
    long long pixels;
    int       box[4]; /* first column, first row, last column + 1, last row + 1; no pixels: all 0 */
} MaskExtent;

/* extent[k] of value k + 1 for each k < count, in one pass. Larger values are ignored. */
void mask_extents(MaskExtent *extent, int count, const uint32_t *plane, int width, int height);

enum { mask_run_characters = 7 };
/* Characters that hold the text of any mask of this extent, including its terminator. */
size_t mask_text_size(const MaskExtent *extent);
/* The pixels of this value. text: mask_text_size characters. */
void   mask_text(char *text, const uint32_t *plane, uint32_t value, int width, int height, const MaskExtent *extent);
/* All pixels of the extent's box, which is not empty and lies within the image. */
void   mask_box_text(char *text, int width, int height, const MaskExtent *extent);

#endif
