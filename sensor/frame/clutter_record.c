/* sensor/frame/clutter_record.c: clutter that a frame shows, and its fields in truth.jsonl. */
#include "sensor/frame/clutter_record.h"

#include "sensor/frame/record_fields.h"

#include <inttypes.h>
#include <stdio.h>

Status clutter_records(const ClutterRecord **out, int *count, const Picture *picture, const Scenery *scenery,
                       Arena *arena)
{
    *out = NULL, *count = 0;
    if (!scenery || picture->scenery_count == 0) return STATUS_OK;
    ClutterRecord *record = arena_alloc(arena, (size_t)picture->scenery_count, sizeof *record);
    if (!record) return STATUS_NO_MEMORY;
    for (int k = 0; k < picture->scenery_count; k++) {
        const SceneryPixels *px = &picture->scenery[k];
        const SceneryObject *object = &scenery->object[px->object];
        ClutterRecord       *r = &record[k];
        *r = (ClutterRecord){.class_name = scenery_class_name((SceneryClass)object->class),
                             .pixels = px->visible,
                             .range_m = px->range_m,
                             .temp_k = px->hottest_k,
                             .instance = px->object + 1,
                             .class_number = (SceneryClass)object->class};
        snprintf(r->id, sizeof r->id, "%016" PRIx64, object->id);
        memcpy(r->box, px->box, sizeof r->box);
    }
    *out = record, *count = picture->scenery_count;
    return STATUS_OK;
}

#define OF_CLUTTER(member) FIELD_MEMBER(ClutterRecord, member)

static const Field clutter_rows[] = {
    {"class", "", "", "",
     "car, van, lorry, tractor, generator, machine, trailer, wreck, fire, heap, animal, rock, "
     "crates, tent, bale or container",
     OF_CLUTTER(class_name), FIELD_EXACT, .newer = true},
    {"id", "", "16 hexadecimal digits", "", "the same in every frame, and in every run of the same seed and table",
     OF_CLUTTER(id), FIELD_EXACT, .newer = true},
    {"pixels", "px", "", "", "its visible area, which may be a part of one", OF_CLUTTER(pixels),
     FIELD_WITHIN(0.1, 0.02), .newer = true, .channel = FIELD_TARGETS},
    {"box_px", "px", "image: first column, first row, last column + 1, last row + 1", "",
     "bounding box of what is seen of it", OF_CLUTTER(box), FIELD_EXACT, .newer = true, .channel = FIELD_TARGETS},
    {"range_m", "m", "", "", "from the sensor to its nearest sample", OF_CLUTTER(range_m), FIELD_WITHIN(0.05, 0),
     .newer = true, .channel = FIELD_TARGETS},
    {"temp_k", "K", "", "where no band needs temperatures", "temperature of its hottest surface that is seen",
     OF_CLUTTER(temp_k), FIELD_WITHIN(0.5, 0), .newer = true, .channel = FIELD_TEMP},
    {"instance", "", "from 1", "", "its value in plane `instance` of the truth EXR, where the pixel has no entity",
     OF_CLUTTER(instance), .newer = true},
};
const FieldTable clutter_fields = FIELD_TABLE(clutter_rows);
