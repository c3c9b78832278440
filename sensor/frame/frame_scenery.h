/* sensor/frame/frame_scenery.h: what stands in a frame's world (buildings, works, clutter), made from all that it
 * follows from: by the choices of a run, and again by a frame file. */
#ifndef SENSOR_FRAME_FRAME_SCENERY_H
#define SENSOR_FRAME_FRAME_SCENERY_H

#include "entities/scenery/scenery.h"
#include "entities/scenery/scenery_buildings.h"
#include "entities/scenery/scenery_clutter.h"
#include "terrain/culture/culture.h"
#include "terrain/culture/culture_give_way.h"
#include "terrain/culture/culture_invented.h"

typedef enum CultureFrom {
    CULTURE_FROM_NOTHING,
    CULTURE_FROM_SEED,    /* invented: SceneryPlan.invented */
    CULTURE_FROM_RECORDS, /* of files: FrameScenery.culture is given */
    CULTURE_FROMS
} CultureFrom;

/* With landscape, records and tables: all that scenery follows from. */
typedef struct SceneryPlan {
    CultureFrom   from;
    CultureConfig invented;
    double        clutter;             /* times the density of its table; 0: none */
    char          clutter_table[1024]; /* name or path (clutter_table_path); empty: countryside */
    uint64_t      clutter_seed;
    double        south_west_m[2], north_east_m[2]; /* ENU: where clutter stands */
    bool          lamps, smoke;                     /* lamps are lit by night; what burns smokes */
    int           harms;                            /* of buildings, by Detonations and entities: */
    BuildingHarm  harm[building_harms_most];
} SceneryPlan;

typedef struct FrameScenery {
    SceneryPlan plan;
    Culture     culture;  /* indexed; empty: nothing is built */
    int         gave_way; /* records of invented culture that are not there for what is driven */
    int         drivens;  /* given: where vehicles are, on ground that has not been told of them */
    DrivenPath *driven;   /* [drivens]; owned */
    Scenery     scenery;
} FrameScenery;

/* Makes the scenery of a plan, clear of what is driven, and its culture unless that is given, over a landscape on which
 * no culture is laid yet. The same plan, records and landscape give the same bits. frame_scenery_free after success and
 * failure. */
Status frame_scenery_make(FrameScenery *out, const SceneryPlan *plan, const Landscape *landscape);
/* The culture of a plan alone, where it is invented: frame_scenery_make then takes it. */
Status frame_scenery_culture(FrameScenery *out, const SceneryPlan *plan, const Landscape *landscape);
void   frame_scenery_free(FrameScenery *scenery); /* accepts zeroes */
/* ENU z of a landscape, for what asks for the ground; user: the landscape. */
double frame_scenery_ground(void *user, double x_m, double y_m);

/* What there is of each. */
typedef struct SceneryCounts {
    int objects, models, driving;
    int cells;                           /* objects that are pieces of ground with all that is built there */
    int buildings, lines, points, trees; /* records of culture */
    int clutter, of_class[CLUTTER_CLASSES];
    int lamps[LAMP_KINDS];
    int damaged; /* buildings that come to damage in the course of the exercise */
} SceneryCounts;
void frame_scenery_count(SceneryCounts *out, const FrameScenery *scenery);

#endif
