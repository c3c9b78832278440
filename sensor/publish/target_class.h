/* sensor/publish/target_class.h: the target class of an entity, for training and scoring recognisers: a small fixed
 * table of names and numbers.
 *
 * The class is a function of the entity type alone, by the categories of SISO-REF-010: neither the log nor
 * etc/catalog.csv, nor the order of appearance changes a number. Numbers begin with 1 and have no gaps; once
 * published a number keeps its name, and new ones are added at the end (tests/sensor/test_target_class.c holds the
 * list a second time). They are the category ids of coco.json; truth.jsonl has the names.
 *
 * Names are those of public target recognition data (tank, apc, truck, helicopter). An apc is any armoured fighting
 * vehicle on wheels or tracks, infantry fighting vehicles too: the category does not tell them apart. */
#ifndef SENSOR_PUBLISH_TARGET_CLASS_H
#define SENSOR_PUBLISH_TARGET_CLASS_H

#include "dis/pdu.h"

/* How many; numbers are 1 .. target_class_count(). */
int         target_class_count(void);
const char *target_class_name(int number);
const char *target_class_group(int number); /* COCO's supercategory */
/* `other` if no category matches. */
int         target_class(DisEntityType type);

#endif
