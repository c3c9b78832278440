/* sensor/publish/truth_preview.h: truth as a preview image: one colour per entity, over range shading. */
#ifndef SENSOR_PUBLISH_TRUTH_PREVIEW_H
#define SENSOR_PUBLISH_TRUTH_PREVIEW_H

#include "entities/table/snapshot.h"

/* rgb: [count][3]. Ground: grey by range, light near and dark far, logarithmic between the nearest and the
 * farthest finite range. Sky (range not finite): dark blue. Entities (plane: snapshot index + 1): a colour
 * that depends on the id alone, so that it stays from frame to frame; an index beyond the snapshot: white.
 * normal_up (the plane nz; may be NULL) shades both. */
void truth_preview(uint8_t *rgb, const float *range_m, const uint32_t *entity, const float *normal_up, size_t count,
                   const Snapshot *snapshot);

#endif
