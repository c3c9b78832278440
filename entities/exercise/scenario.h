/* entities/exercise/scenario.h: a scenario file: place, entities, routes, shots, and how they are reported on the
 * network. A small YAML file; etc/scenarios/demo.yaml shows every common key, etc/scenarios/README.md all.
 *
 * A plain struct: absent keys have their defaults. cast.h makes entities of it, exercise.h sends them. */
#ifndef ENTITIES_EXERCISE_SCENARIO_H
#define ENTITIES_EXERCISE_SCENARIO_H

#include "dis/pdu/pdu.h"

enum {
    scenario_name_size = 24,
    scenario_type_size = 40,
    scenario_path_size = 1024,
    scenario_max_groups = 1000,
    scenario_max_shots = 1000,
    scenario_max_entities = 50000, /* clones and munitions included */
    scenario_max_rounds = 20000,
};

/* One line of `vehicles`: one entity, or many of one kind on one route. x east, y north of the place, metres. */
typedef struct ScenarioGroup {
    char name[scenario_name_size]; /* marking and name for shots: `NAME ID` */
    int  line;                     /* line in the file */
    char type[scenario_type_size]; /* seven numbers with dots, or a model of etc/catalog.csv */
    int  id, count, columns, force,
        dead_reckoning; /* id 0: the next free one; dead_reckoning 0: the one of section dis */
    double     spacing_m, column_m, spread_m, behind_m;
    NumberList route_m; /* x, y, x, y ... smooth through them; a single point: stationary */
    bool       loop, engine, parked;
    double     speed_mps, unsteady_m, heading_deg, height_m;
    double     start_s, stop_s, appears_s, leaves_s; /* NaN: moving from the beginning, to the end of the route, ... */
    char       leaves[16], turret[8], dust[8];
    int        appearance; /* more bits */
} ScenarioGroup;

/* One line of `shots`: a missile or rounds. */
typedef struct ScenarioShot {
    char       name[scenario_name_size], type[scenario_type_size];
    int        line;
    char       from[2 * scenario_name_size], at[2 * scenario_name_size]; /* `NAME ID` of both; at empty: at_m counts */
    NumberList at_m, launch_m; /* x, y of a place; forward, right, down of the firing entity */
    int        id, force, rounds, dead_reckoning;
    double     time_s, every_s, launch_mps, boost_mps, boost_s, drag_mps2, loft_m, weave_m, silent_s;
    char       hit[8], damage[12];
    bool       entity; /* whether its munition sends Entity States */
} ScenarioShot;

typedef struct Scenario {
    char      path[scenario_path_size];
    double    duration_s, scale;
    long long seed;
    struct {
        double lat_deg, lon_deg, height_m, turn_deg;
    } place;
    struct {
        double swell_m, smooth_m;
        char   store[1024];
        char   elevation[scenario_path_size], geoid[scenario_path_size], vertical[12];
    } ground;
    struct {
        int    site, application, exercise, version, mtu, dead_reckoning;
        bool   bundle, fillers, updates;
        char   stamps[16], clock[32], date[32];
        double stamp_s, heartbeat_s, threshold_m, threshold_deg, rate_hz, announce_per_s;
    } dis;
    struct {
        double bad_every_s, loss, duplicate, reorder;
    } faults;
    int            group_count, shot_count;
    ScenarioGroup *group; /* [group_count] */
    ScenarioShot  *shot;  /* [shot_count] */
} Scenario;

/* Reads and checks a file: ranges, types, routes, names in shots. No side effects beyond the log. On failure one line
 * is logged with file, line, key, value, range; *out is then empty. No other file is opened. */
Status scenario_read(Scenario *out, const char *path);
/* One key above the lists as a command line gives it, `dis.version`, 5. On failure *scenario is unchanged. */
Status scenario_set(Scenario *scenario, const char *key, const char *value, const char *source);
/* Repeats the checks across keys, after scenario_set. */
Status scenario_check(const Scenario *scenario);
void   scenario_destroy(Scenario *scenario); /* accepts zeroes */
/* Every key, with range and default, as text for people. */
void scenario_write_keys(FILE *to);

/* How many of a group there are: count, times `scale` where count is above 1. */
int scenario_group_size(const Scenario *scenario, const ScenarioGroup *group);
/* Finds the group, and the member of it, that `NAME ID` means; ids: the first id of each group [group_count]. */
bool scenario_find(int *group, int *member, const Scenario *scenario, const int *ids, const char *name);
/* First id of each group [group_count], then of each shot [shot_count]. False: above 65533, or given twice. */
bool scenario_ids(int *ids, const Scenario *scenario);

/* `1.1.222.1.1.1.0`; true when all seven are there. */
bool scenario_type_parse(DisEntityType *out, const char *text);

#endif
