/* entities/scenery/scenery.h: what stands in the world and takes no part in the exercise, ready to be seen: buildings
 * and works (of terrain/culture), and clutter: civil vehicles, machines, animals, rocks, fires. */
#ifndef ENTITIES_SCENERY_SCENERY_H
#define ENTITIES_SCENERY_SCENERY_H

#include "entities/models/model.h"
#include "entities/table/snapshot.h"

typedef enum SceneryKind {
    SCENERY_BUILDINGS, /* a cell of ground with its buildings and works, one mesh */
    SCENERY_CLUTTER,   /* one thing; a class of SceneryClass */
} SceneryKind;

/* Of clutter, as truth names them. */
typedef enum SceneryClass {
    CLUTTER_NONE, /* not clutter */
    CLUTTER_CAR,
    CLUTTER_VAN,
    CLUTTER_LORRY,
    CLUTTER_TRACTOR,
    CLUTTER_GENERATOR,
    CLUTTER_MACHINE, /* excavator, combine */
    CLUTTER_TRAILER,
    CLUTTER_WRECK,
    CLUTTER_FIRE, /* open fire, burning barrel */
    CLUTTER_HEAP, /* smouldering: dung, charcoal, refuse */
    CLUTTER_ANIMAL,
    CLUTTER_ROCK, /* and dry bare slopes */
    CLUTTER_CRATES,
    CLUTTER_TENT,
    CLUTTER_BALE,
    CLUTTER_CONTAINER, /* freight container that stands in a yard */
    CLUTTER_CLASSES
} SceneryClass;
const char *scenery_class_name(SceneryClass of); /* "car" ... */

/* What heats a kind of clutter: solved once for all objects that share it, as an entity of that model which has always
 * done the same */
typedef struct SceneryState {
    int          model; /* of Scenery.model */
    EntityDrives drives;
    float        heading_rad; /* clockwise from north */
    float        stood_s;     /* time since its engine stopped; 0: it runs, or never ran */
} SceneryState;

typedef struct SceneryObject {
    uint64_t id;                /* the same in every run */
    uint8_t  kind;              /* SceneryKind */
    uint8_t class;              /* SceneryClass */
    uint8_t damage;             /* as an entity's */
    int     model;              /* of Scenery.model */
    int     state;              /* of Scenery.state; -1: its parts are as warm as their constructions (of buildings) */
    double  p_enu[3];           /* of the model's origin: centre of its base */
    double  r_enu_from_body[9]; /* body axes: x forward, y right, z down */
} SceneryObject;

/* An object that drives: its pose is scenery_pose's. */
typedef struct SceneryMover {
    int    object;       /* of Scenery.object, whose own pose is that at exercise time 0 */
    int    first, count; /* of Scenery.path_enu: a closed polyline on the ground */
    double speed_mps, phase_m;
} SceneryMover;

/* One straight piece of the way by which an object came that stands. */
typedef struct SceneryRut {
    int    object;
    float  came_s;             /* how long before exercise time 0 it came */
    double a_enu[3], b_enu[3]; /* middle between its wheels, on the ground */
} SceneryRut;

/* What lights by night (entities/scenery/scenery_lamps.h). */
typedef enum SceneryLampKind { LAMP_WINDOW, LAMP_STREET, LAMP_VEHICLE, LAMP_KINDS } SceneryLampKind;
typedef struct SceneryLamp {
    uint8_t kind;                /* SceneryLampKind */
    int     object;              /* of Scenery.object */
    int     facet, facets;       /* of its model: which shine; facet -1: two discs on the front of a vehicle */
    double  p[3], n[3];          /* middle of what shines, and the way it faces: ENU; of vehicles body axes */
    float   area_m2, type;       /* type: 0 .. 1, which type of lamp it is */
    float   draw, bed_h, rise_h; /* of windows: when it is lit */
} SceneryLamp;

/* From t_s of exercise time on an object that stands has this damage, the worst of those up to then. */
typedef struct SceneryHarm {
    int     object;
    double  t_s;
    uint8_t damage; /* 1 .. 3 */
} SceneryHarm;

typedef struct Scenery {
    int            models, objects, states, movers, paths, lamps;
    Model         *model;  /* [models]; immutable */
    SceneryObject *object; /* [objects] */
    SceneryState  *state;
    SceneryMover  *mover;
    double (*path_enu)[3];  /* [paths] */
    uint8_t    *path_loose; /* [paths]; 1: what wheels loosen and raise dust from, from this corner to the next */
    int         ruts;
    SceneryRut *rut; /* [ruts]; what stands came along them */
    /* of the parts of buildings: the record each belongs to, model by model: part p of model m is of building
     * part_of[part_first[m] + p] (Building.id); 0: of none */
    uint64_t    *part_of;
    int         *part_first; /* [models]; -1: its parts are of no building */
    SceneryLamp *lamp;       /* [lamps], by object and facet */
    bool         smokes;     /* what burns of clutter (entities/scenery/scenery_smoke.h) */
    int          harms;
    SceneryHarm *harm; /* [harms] */
} Scenery;

/* What is looked at: all within a cone. */
typedef struct SceneryCone {
    double p_enu[3], d_enu[3]; /* eye; unit vector along its axis */
    double tangent;            /* of the half angle */
} SceneryCone;

void scenery_free(Scenery *scenery); /* accepts zeroes */

/* Moves r and p of an object that drives to where it is at a time; others keep their own. */
void scenery_pose(double p_enu[3], double r_enu_from_body[9], const Scenery *scenery, const SceneryMover *mover,
                  double t_s);

/* Damage of an object at a time: its own, or what it came to by then. O(harms). */
int scenery_damage(const Scenery *scenery, int object, double t_s);

#endif
