/* sensor/node/run/run_scenery.c: what stands in the world, in run.json. */
#include "sensor/node/run/run_record_private.h"

#define OF_COUNTS(member) FIELD_MEMBER(SceneryCounts, member)

/* Classes of clutter, which begin at 1. */
static const void *next_class(FieldAt *at, int i)
{
    const SceneryCounts *n = at->of;
    return i + 1 < CLUTTER_CLASSES ? field_keyed(at, scenery_class_name((SceneryClass)(i + 1)), &n->of_class[i + 1])
                                   : NULL;
}

static const Field class_rows[] = {
    {"CLUTTER", "", "", "", "things", .item = next_class, .kind = FIELD_OF_INT},
};

static const Field lamp_rows[] = {
    {"windows", "", "", "", "panes of heated dwellings", OF_COUNTS(lamps[LAMP_WINDOW])},
    {"street", "", "", "", "of streets and yards", OF_COUNTS(lamps[LAMP_STREET])},
    {"vehicles", "", "", "", "pairs of headlamps of vehicles that drive", OF_COUNTS(lamps[LAMP_VEHICLE])},
};

static const Field scenery_rows[] = {
    {"objects", "", "", "", "squares of ground with buildings and works, and things of clutter", OF_COUNTS(objects)},
    {"models", "", "", "", "meshes that they share", OF_COUNTS(models)},
    {"buildings", "", "", "", "buildings", OF_COUNTS(buildings)},
    {"damaged", "", "", "", "of these, buildings that come to damage, by Detonations or as an entity's",
     OF_COUNTS(damaged)},
    {"lines", "", "", "", "walls, fences, power lines, bridges, roads and rivers", OF_COUNTS(lines)},
    {"points", "", "", "", "poles, tanks, masts and other works at a place", OF_COUNTS(points)},
    {"trees", "", "", "", "trees of terrain.trees", OF_COUNTS(trees)},
    {"clutter", "", "", "", "things of clutter", OF_COUNTS(clutter)},
    {"classes", "", "", "", "of these, by class", FIELD_OBJECT(class_rows)},
    {"driving", "", "", "", "of these, vehicles that drive", OF_COUNTS(driving)},
    {"lamps", "", "", "", "that are lit by night, each at its hours: terrain.lamps", FIELD_OBJECT(lamp_rows)},
};
const FieldTable run_scenery_fields = {scenery_rows, sizeof scenery_rows / sizeof *scenery_rows};

const void *run_scenery_of(const void *of)
{
    const RunRecord *r = of;
    return r->has_scenery ? &r->scenery : NULL;
}

void run_count_scenery(RunRecord *record)
{
    const MadeWorld *made = record->run->made; /* NULL: nothing was heard */
    if (!made) return;
    record->has_scenery = made->scenery.plan.from != CULTURE_FROM_NOTHING || made->scenery.plan.clutter > 0;
    frame_scenery_count(&record->scenery, &made->scenery);
}
