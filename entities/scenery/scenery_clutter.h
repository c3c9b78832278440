/* entities/scenery/scenery_clutter.h: clutter by seed: civil vehicles, machines, animals, rocks, fires and what else
 * etc/clutter.csv lists, placed on ground that nothing else takes.
 *
 * A pure function of table, seed, landscape, culture and evidence: what stands at a place does not depend on the square
 * that is asked for, so squares side by side repeat nothing and leave nothing out (limits aside). Nothing stands within
 * clutter_clear_m of a place where a vehicle of the exercise was reported, below or in a clear line, in a building or
 * on anything else of the culture, on the lanes of a way, in water, or in other clutter. */
#ifndef ENTITIES_SCENERY_SCENERY_CLUTTER_H
#define ENTITIES_SCENERY_SCENERY_CLUTTER_H

#include "entities/scenery/scenery.h"
#include "terrain/culture/culture.h"
#include "terrain/ground/landscape.h"

static const double clutter_clear_m = 12; /* between a reported place and the edge of what stands */

enum {
    clutter_most_objects = 100000,
    clutter_most_movers = 1024,
    clutter_headings = 16, /* states are solved at headings of 22.5 degrees; poses keep their own */
    clutter_stops = 6,     /* steps of the times since an engine stopped, equal in their logarithm */
};
/* Times since an engine stopped, of what stopped lately: log-uniform between these. */
static const double clutter_stop_least_s = 120, clutter_stop_most_s = 86400;

typedef struct ClutterConfig {
    double           density; /* times what the table says, 0 .. 20; 0: no clutter */
    uint64_t         seed;
    double           south_west_m[2], north_east_m[2]; /* ENU: what stands in this rectangle, at most 65 km a side */
    const Landscape *landscape;
    const Culture   *culture;          /* indexed; NULL: none, then the plots of an invented landscape have houses */
    const LandscapeEvidence *evidence; /* NULL: that of the landscape */
    const char              *table;    /* name or path, as of clutter_table_path; NULL: countryside */
    int    most;         /* objects, 0 .. clutter_most_objects; of more those of lowest rank, a number of each place */
    int    most_driving; /* of them, 0 .. clutter_most_movers */
    int    most_states;  /* that are solved for heat; with more, headings and times since a stop are told apart less */
    double sag_m;        /* chord error of the shapes */
} ClutterConfig;

/* Density 1, 100000 objects, 256 that drive, 256 states, 0.01 m; the rest is zero. */
ClutterConfig clutter_default_config(void);

/* The file of a table: countryside and rear_area are those of etc; what else there is, with a `.` or `/` in it, is a
 * path. False, and logged: neither, or no etc. */
bool clutter_table_path(char *out, size_t size, const char *named);
/* Whether a table can be used; logs what is wrong with it. */
Status scenery_clutter_check(const char *path);
/* Appends models, objects, states and movers. Models are added for what stands alone. 0.1 s for 1000 objects on 10 km2.
 * STATUS_BAD_VALUE: the table, or a figure of the configuration. On failure the scenery is as it was. */
Status scenery_add_clutter(Scenery *scenery, const ClutterConfig *config);

#endif
