/* sensor/frame/clutter_record.h: clutter that a frame shows, for truth.jsonl: what is no target, and may look like one.
 */
#ifndef SENSOR_FRAME_CLUTTER_RECORD_H
#define SENSOR_FRAME_CLUTTER_RECORD_H

#include "entities/scenery/scenery.h"
#include "render/frame/picture.h"

enum {
    clutter_id_size = 17,
    coco_clutter_category = 200, /* of coco.json: the same whatever classes targets have */
};

typedef struct ClutterRecord {
    const char  *class_name;          /* scenery_class_name */
    char         id[clutter_id_size]; /* SceneryObject.id, 16 hexadecimal digits */
    double       pixels;              /* area, parts of pixels too */
    int          box[4];              /* first column, first row, last column + 1, last row + 1 */
    double       range_m;             /* of its nearest sample */
    double       temp_k;              /* its hottest surface that is seen, K; NaN: not known */
    int          instance;            /* its value in plane `instance` */
    SceneryClass class_number;
} ClutterRecord;

/* Of a picture with truth; in the order of Scenery.object. scenery: the world's; NULL: none. STATUS_NO_MEMORY. */
Status clutter_records(const ClutterRecord **out, int *count, const Picture *picture, const Scenery *scenery,
                       Arena *arena);

#endif
