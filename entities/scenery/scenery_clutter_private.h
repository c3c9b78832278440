/* entities/scenery/scenery_clutter_private.h: how clutter is placed, for the files that do it.
 *
 * clutter_table.c   etc/clutter.csv
 * clutter_ground.c  what is free: evidence, ways, culture, surface, slope
 * clutter_areas.c   things by area: animals, rocks, machines in the fields
 * clutter_lines.c   things beside roads, and what drives on them
 * clutter_drives.c  what drives on a line, there and back; off the ways too
 * clutter_ruts.c    the lines of wheels behind what came over soil and stands
 * clutter_yards.c   things about houses, barns and halls, and in the open of yards
 * clutter_variants.c  shapes in their paints and sizes
 * clutter_settle.c  conflicts between things, and limits
 * clutter_objects.c models, states and objects of the scenery */
#ifndef ENTITIES_SCENERY_CLUTTER_PRIVATE_H
#define ENTITIES_SCENERY_CLUTTER_PRIVATE_H

#include "entities/scenery/scenery_clutter.h"
#include "terrain/invented/invented.h"

#include "pitviper_table.h"

/* ---- the table -------------------------------------------------------------------------------- */

typedef enum ClutterWhere {
    /* lines: a kilometre of them */
    CLUTTER_ON_ROAD,
    CLUTTER_ON_LANE,
    CLUTTER_ON_TRACK,
    /* yards: each */
    CLUTTER_AT_HOUSE,
    CLUTTER_AT_BARN,
    CLUTTER_AT_HALL,
    /* open yards: a hectare of them */
    CLUTTER_IN_FARMYARD, /* unpaved */
    CLUTTER_IN_WORKS,    /* paved */
    /* areas: km2 of them */
    CLUTTER_IN_FIELD,   /* crop, ploughed and bare soil */
    CLUTTER_IN_PASTURE, /* grass, green or dry */
    CLUTTER_IN_SCRUB,
    CLUTTER_IN_FOREST,
    CLUTTER_AT_EDGE, /* field or pasture within clutter_edge_m of another of the areas */
    CLUTTER_ON_ROCK,
    CLUTTER_ON_SAND,
    CLUTTER_IN_BUILT,
    CLUTTER_PLACES,
    CLUTTER_YARDS = CLUTTER_AT_HOUSE,
    CLUTTER_AREAS = CLUTTER_IN_FIELD,
} ClutterWhere;

static const double clutter_edge_m = 12;
static const double clutter_margin_m = 24; /* things that far outside of the square may stand in others' way */

/* Kinds of line that is driven: those of ways, and over soil off the ways. */
enum { clutter_off_ways = CLUTTER_YARDS, clutter_line_kinds };

/* Mean speeds on roads, lanes and tracks without traffic, and off the ways: a minor rural road, a village's lane with
 * its 30 km/h, a track of gravel, a field. Estimates; each way has its own, within a fifth. */
static const double clutter_speed_mps[clutter_line_kinds] = {60 / 3.6, 30 / 3.6, 15 / 3.6, 20 / 3.6};

/* What heats a thing of a row. */
typedef enum ClutterHeat {
    CLUTTER_COLD,   /* sun and air alone */
    CLUTTER_ENGINE, /* an engine: running, stopped lately, or cold */
    CLUTTER_WORKS,  /* an engine that is under load where it runs: of machines at work */
    CLUTTER_DRIVES, /* drives along its way */
    CLUTTER_LIVES,  /* an animal */
    CLUTTER_BURNS,  /* flames or embers */
    CLUTTER_HEATS
} ClutterHeat;

enum { clutter_most_rows = 256, clutter_most_variants = 8, clutter_cell_octets = 96 };

typedef struct ClutterRow {
    int class; /* SceneryClass */
    char         shape[model_name_size];
    char         paint[clutter_cell_octets]; /* materials of the part `body` and what shares its material; empty: own */
    ClutterWhere where;
    double       density;                         /* per km, yard or km2 */
    double       reach_m;                         /* from the middle of the exercise; 0: everywhere */
    double       group_low, group_high, spread_m; /* things of a group, and their standard deviation about its middle */
    double       length_low_m, length_high_m;     /* of the shape; 0: its own */
    ClutterHeat  heat;
    double       running, recent; /* shares whose engine runs, and stopped lately; the rest is cold */
} ClutterRow;

typedef struct ClutterTable {
    int        rows;
    ClutterRow row[clutter_most_rows];
} ClutterTable;

Status clutter_table_read(ClutterTable *out, const char *path);

/* ---- what is placed --------------------------------------------------------------------------- */

/* A thing that wants a place, before conflicts with others. */
typedef struct ClutterThing {
    uint64_t rank; /* of two in conflict the lower stays; also the id */
    int      row, variant, mode;
    double   x_m, y_m, heading_rad;
    float    radius_m;         /* about its middle, in plan */
    int      path, path_count; /* of what drives: of ClutterWork.path; count 0: it stands */
    float    speed_mps, phase_m;
} ClutterThing;

/* What a thing does: modes of a SceneryState. */
enum {
    clutter_mode_cold,
    clutter_mode_idles,
    clutter_mode_works,
    clutter_mode_lives,
    clutter_mode_burns,
    clutter_mode_drives,                                             /* one a kind of line */
    clutter_mode_stopped = clutter_mode_drives + clutter_line_kinds, /* one a step of time */
    clutter_modes = clutter_mode_stopped + clutter_stops,
};

/* A shape in one paint and size. */
typedef struct ClutterVariant {
    const ClutterRow *row;
    char              paint[32];
    double            length_m;  /* 0: the shape's own */
    float             size_m[3]; /* length, width, height */
    int               model;     /* of the scenery; -1: not built yet */
    int               same;      /* the first variant of this shape, paint and size, whose model and states it shares */
} ClutterVariant;

typedef struct ClutterSpots ClutterSpots; /* clutter_ground.c */

typedef struct ClutterWork {
    const ClutterConfig *config;
    ClutterTable         table;
    int                  variants;
    ClutterVariant      *variant;
    int                  first_variant[clutter_most_rows + 1]; /* those of a row */
    ClutterSpots        *spots;
    int                  things, room;
    ClutterThing        *thing;
    int                  paths, path_room;
    double (*path)[3];
    uint8_t *path_loose; /* [paths]; Scenery.path_loose */
    int      left_out;   /* for want of states */
} ClutterWork;

/* ---- the ground: clutter_ground.c ------------------------------------------------------------- */

Status clutter_spots_create(ClutterSpots **out, const ClutterConfig *config);
void   clutter_spots_destroy(ClutterSpots *spots); /* accepts NULL */
/* Whether a place is of one of the areas. */
bool clutter_is_area(const Landscape *landscape, ClutterWhere where, double x_m, double y_m);
/* Whether a disc about a place keeps clear of reported vehicles and, up to height_m, of clear lines. */
bool clutter_keeps_clear(const ClutterSpots *spots, double x_m, double y_m, double radius_m, double height_m);
/* Whether a thing of these sizes can stand: dry ground below, slope, clear, nothing built but yards, off the lanes of
 * ways. */
bool clutter_can_stand(const ClutterSpots *spots, double x_m, double y_m, double heading_rad, const float size_m[3]);
/* Pose on the ground: the plane through the ground below its ends and sides; upright: only its heading turns it. */
bool clutter_pose(double p_enu[3], double r_enu_from_body[9], const Landscape *landscape, double x_m, double y_m,
                  double heading_rad, const float size_m[3], bool upright);

/* ---- what drives: clutter_drives.c -------------------------------------------------------------- */

enum { clutter_most_riders = 64 };

typedef struct ClutterLine {
    double (*p)[2]; /* [count] */
    int      count, kind;
    double   half_m, length_m;
    uint64_t key;
} ClutterLine;

void clutter_line_measure(ClutterLine *line);
/* Lets these drive along a line, there half of half_m right of its middle and back on the other side: sorts them, sets
 * their places, paths and speeds, and adds those within more_m of the square. As many as find room. */
Status clutter_add_riders(ClutterWork *work, const ClutterLine *line, ClutterThing *rider, int riders, double more_m);
/* Whether a vehicle may pass a place: the exercise needs no room there. */
bool clutter_may_pass(const ClutterWork *work, const double p[2]);
/* How far from where it is at exercise time 0 something drives that does so off the ways. */
static const double clutter_off_ways_m = 420;
/* A thing that drives off the ways, about a place; none where there is no room. */
Status clutter_place_off_ways(ClutterWork *work, int row, uint64_t h, double x_m, double y_m);

/* ---- who places: a file each ------------------------------------------------------------------ */

Status clutter_place_areas(ClutterWork *work);
Status clutter_place_lines(ClutterWork *work);
Status clutter_place_yards(ClutterWork *work);

/* ---- what becomes of them --------------------------------------------------------------------- */

Status clutter_make_variants(ClutterWork *work);
/* A model in its paint: that of the first part that is painted, else of the first part, and of all that share it. */
Status clutter_build_variant(Model *out, const ClutterVariant *v, double sag_m);
/* Sorts things by rank, and leaves those in the square that stay. */
Status clutter_settle(ClutterWork *work);
Status clutter_into_scenery(Scenery *scenery, ClutterWork *work);
/* The ruts of a thing that came over soil and stands, as object of the scenery; room: of SceneryRut. Returns how many.
 */
int clutter_ruts_of(SceneryRut *out, int room, const ClutterWork *work, const ClutterThing *thing, int object);
enum { clutter_ruts_each = 8 };

/* ---- numbers and lists: scenery_clutter.c ------------------------------------------------------- */

/* Numbers of a thing: well mixed, of its row, two numbers of its place and a counter. */
uint64_t             clutter_hash(const ClutterWork *work, int row, int64_t i, int64_t j, uint64_t k);
static inline double clutter_unit(uint64_t h, uint64_t k) { return invented_unit(invented_hash(h, (int64_t)k, 77)); }
/* Poisson number of this mean, of a uniform; at most 10000. */
int clutter_poisson(double mean, double unit);
int clutter_variant_of(const ClutterWork *work, int row, uint64_t h);
/* Whether there are as many things as a square may have, before conflicts: no more are looked for. */
enum { clutter_most_things = 1 << 19 };
static inline bool clutter_is_full(const ClutterWork *work) { return work->things >= clutter_most_things; }
/* Appends a thing; draws what it does from its rank. Nothing where it is full. */
Status clutter_add(ClutterWork *work, ClutterThing thing);
/* Whether a place is in the square that is asked for, grown by more_m. */
bool clutter_in_square(const ClutterConfig *config, double x_m, double y_m, double more_m);

#endif
