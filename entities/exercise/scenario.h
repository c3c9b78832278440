/* entities/exercise/scenario.h: a scenario file: place, entities, routes, shots, and how they are reported on the
 * network. A small YAML file; etc/scenarios/demo.yaml shows every common key, etc/scenarios/README.md all.
 *
 * A plain struct: absent keys have their defaults. cast.h makes entities of it, exercise.h sends them. */
#ifndef ENTITIES_EXERCISE_SCENARIO_H
#define ENTITIES_EXERCISE_SCENARIO_H

#include "dis/pdu/pdu.h"
#include "pitviper_settings.h"

enum {
    scenario_name_size = 24,
    scenario_type_size = 40,
    scenario_path_size = 1024,
    scenario_max_groups = 1000,
    scenario_max_shots = 1000,
    scenario_max_entities = 50000, /* clones and munitions included */
    scenario_max_rounds = 20000,
    scenario_max_flown = 256, /* rounds that fly: each keeps some 10 kB a second */
};

/* The keys, as pitviper_settings.h says; those of an item of `vehicles`, then of `shots`. */
/* clang-format off */
#define SCENARIO_GROUP(ROW) \
    ROW(TEXT, , name, "Entity", scenario_name_size, "", "marking; the id is appended") \
    ROW(TEXT, , type, "tank", scenario_type_size, "", \
        "kind.domain.country.category.subcategory.specific.extra, or a model of etc/catalog.csv") \
    ROW(INT, , id, 0, 0, 65533, "", "entity number of the first; 0: the next free one") \
    ROW(INT, , force, 1, 0, 255, "", "1 friendly, 2 opposing, 3 neutral") \
    ROW(INT, , count, 1, 1, 50000, "", "number of entities") \
    ROW(INT, , columns, 1, 1, 1000, "", "side by side") \
    ROW(DOUBLE, , spacing_m, 40, 0, 1e4, "m", "distance from each entity to the next one behind it") \
    ROW(DOUBLE, , column_m, 40, 0, 1e4, "m", "distance between columns") \
    ROW(DOUBLE, , spread_m, 0, 0, 1e4, "m", "largest random displacement from their places, along and across") \
    ROW(DOUBLE, , behind_m, 0, -1e5, 1e5, "m", "distance of the first entity behind the start of the route") \
    ROW(NUMBERS, , route_m, {0}, -50000, 50000, "m", "[[x, y], ...] east and north of the place") \
    ROW(BOOL, , loop, false, "the route is repeated") \
    ROW(DOUBLE, , speed_mps, 0, 0, 2000, "m/s", "") \
    ROW(DOUBLE, , unsteady_m, 0, 0, 100, "m", "amplitude of the motion ahead and behind of its place; period 25 s") \
    ROW(DOUBLE, , heading_deg, NAN, -360, 360, "deg", \
        "of entities that stand, clockwise from north; absent: north, and of those with hide drawn for each") \
    ROW(CHOICE, , hide, SCENARIO_HIDE_NONE, ScenarioHide, \
        (SCENARIO_HIDE_NONE, "none")(SCENARIO_HIDE_OPEN, "open")(SCENARIO_HIDE_TREE_LINE, "tree-line") \
        (SCENARIO_HIDE_WOOD, "wood")(SCENARIO_HIDE_HEDGE, "hedge")(SCENARIO_HIDE_HOLLOW, "hollow") \
        (SCENARIO_HIDE_BESIDE, "beside")(SCENARIO_HIDE_BUILDING, "building")(SCENARIO_HIDE_WALL, "wall"), \
        "where each stands near route_m, on ground.planted: in the open, before or behind the edge of a wood, in it, " \
        "at a hedge, in a hollow, beside an entity of this scenario, behind a building or a wall of ground.buildings; none: " \
        "at route_m") \
    ROW(DOUBLE, , hide_m, 150, 5, 1000, "m", "largest distance from route_m of what hides") \
    ROW(DOUBLE, , occlusion, NAN, 0, 0.95, "", \
        "share of each that is to be hidden from the observer of seen; absent: drawn in 0.1 .. 0.9 for each, and in the " \
        "open none") \
    ROW(TEXT, , beside, "", 2 * scenario_name_size, "", "of hide: beside: a building, a wall ..., `NAME ID`") \
    ROW(BOOL, , net, false, "a camouflage net over each, an entity of its own (etc/catalog.csv: net)") \
    ROW(DOUBLE, , height_m, 0, -1000, 100000, "m", "above the ground at each point") \
    ROW(DOUBLE, , start_s, NAN, 0, 1e6, "s", "stands until then; absent: moves from the beginning") \
    ROW(DOUBLE, , stop_s, NAN, 0, 1e6, "s", "begins to stop then; absent: at the end of the route") \
    ROW(DOUBLE, , appears_s, NAN, 0, 1e6, "s", "no report before then") \
    ROW(DOUBLE, , leaves_s, NAN, 0, 1e6, "s", "no report afterwards") \
    ROW(CHOICE, , leaves, SCENARIO_LEAVES_DEACTIVATED, ScenarioLeaves, \
        (SCENARIO_LEAVES_SILENT, "silent")(SCENARIO_LEAVES_DEACTIVATED, "deactivated") \
        (SCENARIO_LEAVES_REMOVED, "removed"), \
        "how it leaves") \
    ROW(CHOICE, , turret, SCENARIO_TURRET_NONE, ScenarioTurret, \
        (SCENARIO_TURRET_NONE, "none")(SCENARIO_TURRET_STILL, "still")(SCENARIO_TURRET_SWING, "swing"), \
        "articulation reported for primary turret and gun") \
    ROW(CHOICE, , dust, SCENARIO_DUST_AUTO, ScenarioDust, \
        (SCENARIO_DUST_AUTO, "auto")(SCENARIO_DUST_NONE, "none")(SCENARIO_DUST_SMALL, "small") \
        (SCENARIO_DUST_MEDIUM, "medium")(SCENARIO_DUST_LARGE, "large"), \
        "dust trail reported while it moves") \
    ROW(BOOL, , engine, true, "runs") \
    ROW(DOUBLE, , engine_off_s, NAN, 0, 1e6, "s", "the engine is stopped then; absent: it runs on") \
    ROW(BOOL, , parked, false, "an aircraft stands on the ground") \
    ROW(INT, , appearance, 0, 0, 2147483647, "", "further appearance bits, as one number") \
    ROW(INT, , dead_reckoning, 0, 0, 9, "", "algorithm 1 .. 9; 0: as dis.dead_reckoning")

#define SCENARIO_SHOT(ROW) \
    ROW(TEXT, , from, "", 2 * scenario_name_size, "", "the entity that shoots, `NAME ID`") \
    ROW(TEXT, , at, "", 2 * scenario_name_size, "", "the target, `NAME ID`") \
    ROW(NUMBERS, , at_m, {0}, -50000, 50000, "m", "[x, y] of a place, instead of a target") \
    ROW(DOUBLE, , time_s, 0, 0, 1e6, "s", "of the first") \
    ROW(INT, , rounds, 1, 1, scenario_max_rounds, "", "so many") \
    ROW(DOUBLE, , every_s, 6, 0.01, 1e6, "s", "time between rounds") \
    ROW(BOOL, , entity, true, "the munition sends Entity States while it flies") \
    ROW(TEXT, , name, "Missile", scenario_name_size, "", "its marking, with the id behind it") \
    ROW(INT, , id, 0, 0, 65533, "", "its entity number; 0: the next free one") \
    ROW(TEXT, , type, "missile", scenario_type_size, "", "entity type of the munition") \
    ROW(INT, , force, 1, 0, 255, "", "of what flies") \
    ROW(NUMBERS, , launch_m, {0}, -100, 100, "m", "[forward, right, down] of the shooter's origin") \
    ROW(DOUBLE, , launch_mps, 65, 1, 5000, "m/s", "speed at launch") \
    ROW(DOUBLE, , boost_mps, 280, 0, 5000, "m/s", "speed that its motor adds") \
    ROW(DOUBLE, , boost_s, 0.6, 0.01, 100, "s", "time constant of the boost") \
    ROW(DOUBLE, , drag_mps2, 5, 0, 100, "m/s2", "what it loses") \
    ROW(DOUBLE, , loft_m, 3, 0, 5000, "m", "above the straight line at half way") \
    ROW(DOUBLE, , weave_m, 0.8, 0, 100, "m", "about it") \
    ROW(CHOICE, , hit, SCENARIO_HIT_ENTITY, ScenarioHit, \
        (SCENARIO_HIT_ENTITY, "entity")(SCENARIO_HIT_GROUND, "ground")(SCENARIO_HIT_MISS, "miss"), \
        "the entity, the ground beside it, or past it into the air") \
    ROW(CHOICE, , damage, SCENARIO_DAMAGE_DESTROYED, ScenarioDamage, \
        (SCENARIO_DAMAGE_NONE, "none")(SCENARIO_DAMAGE_SLIGHT, "slight")(SCENARIO_DAMAGE_MODERATE, "moderate") \
        (SCENARIO_DAMAGE_DESTROYED, "destroyed"), \
        "damage of the entity that is hit") \
    ROW(TEXT, , flies, "", 32, "", \
        "row of the table of missiles by which it flies, with true sight of its target, and hits or not; empty: along " \
        "the line that launch_mps, boost_*, drag_mps2, loft_m, weave_m and hit say") \
    ROW(DOUBLE, , sight_every_s, 0, 0, 10, "s", "of flies: time between measurements of the line of sight; 0: 1 ms") \
    ROW(DOUBLE, , sight_late_s, 0, 0, 5, "s", "of flies: age of a measurement when it arrives") \
    ROW(DOUBLE, , sight_error_m, 0, 0, 100, "m", \
        "of flies: standard deviation of the point that is sighted, about the aim point, in each of two axes across the " \
        "line of sight; drawn for each round, which keeps it") \
    ROW(DOUBLE, , sight_memory, 0, 0, 0.99, "", \
        "of flies: above 0, directions alone are measured, and a fading-memory filter, in which a measurement weighs this " \
        "times as much as the next, makes rates of them; 0: true rates and range") \
    ROW(DOUBLE, , sight_noise_mrad, 0, 0, 50, "mrad", \
        "of flies with sight_memory: standard deviation of each direction, in each of two axes") \
    ROW(DOUBLE, , hit_m, 2, 0, 50, "m", "of flies: it goes off so near its aim point, or at its fuze's distance") \
    ROW(DOUBLE, , silent_s, 0, 0, 1000, "s", "time between its last Entity State and its end") \
    ROW(INT, , dead_reckoning, 0, 0, 9, "", "algorithm 1 .. 9; 0: as dis.dead_reckoning")

#define SCENARIO_ROWS(ROW) \
    SCENARIO_TOP(ROW) SCENARIO_PLACE(ROW) SCENARIO_GROUND(ROW) SCENARIO_SEEN(ROW) SCENARIO_DIS(ROW) \
    SCENARIO_FAULTS(ROW)

#define SCENARIO_TOP(ROW) \
    ROW(DOUBLE, , duration_s, 30, 0, 1e6, "s", "") \
    ROW(LONG, , seed, 1, 0, 1e15, "", "seed of all random numbers") \
    ROW(DOUBLE, , scale, 1, 0.0001, 1000, "", "factor of every count above 1") \
    ROW(PATH, , missiles, "", scenario_path_size, "table of missiles, for shots with flies; empty: etc/missiles.csv")

#define SCENARIO_PLACE(ROW) \
    ROW(DOUBLE, place., lat_deg, 36, -90, 90, "deg", "where x and y are 0") \
    ROW(DOUBLE, place., lon_deg, -123, -180, 180, "deg", "") \
    ROW(DOUBLE, place., height_m, 120, -500, 9000, "m", "height of synthetic ground above the ellipsoid") \
    ROW(DOUBLE, place., turn_deg, 0, -360, 360, "deg", "rotation of all routes and places, clockwise")

#define SCENARIO_GROUND(ROW) \
    ROW(DOUBLE, ground., swell_m, 1.5, 0, 20, "m", \
        "height of the swells of synthetic ground, which are 0.4 to 0.6 km long") \
    ROW(BOOL, ground., planted, false, \
        "the synthetic ground and the plants of a node with terrain.place, of the same seed, on which entities can hide") \
    ROW(BOOL, ground., buildings, true, \
        "of ground.planted: what is built on it too, as a node with terrain.buildings=invented has it") \
    ROW(LONG, ground., seed, 1, 0, 2147483647, "", "of ground.planted: the node's seed") \
    ROW(DOUBLE, ground., relief_m, 15, 0, 200, "m", "of ground.planted: the node's terrain.relief_m") \
    ROW(DOUBLE, ground., spacing_m, 4, 1, 30, "m", "of ground.planted: the node's terrain.spacing_m") \
    ROW(PATH, ground., store, "", 1024, \
        "terrain store of real ground (`pitviper terrain import`), instead of ground.elevation; empty: none") \
    ROW(PATHS, ground., elevation, "", scenario_path_size, \
        "files and folders of real ground, separated by commas, or a list; empty: synthetic ground") \
    ROW(CHOICE, ground., vertical, SCENARIO_VERTICAL_FILE, ScenarioVertical, \
        (SCENARIO_VERTICAL_FILE, "file")(SCENARIO_VERTICAL_GEOID, "geoid")(SCENARIO_VERTICAL_ELLIPSOID, "ellipsoid"), \
        "vertical datum of their heights") \
    ROW(PATH, ground., geoid, "", scenario_path_size, "geoid grid; empty: EGM96 of proj-data") \
    ROW(DOUBLE, ground., smooth_m, 2, 0.5, 30, "m", \
        "vehicles do not follow bumps of real ground that are shorter than this")

/* Whence hidden entities are looked at, each of them alike: as observer.* of a node at the start of its orbit. */
#define SCENARIO_SEEN(ROW) \
    ROW(DOUBLE, seen., bearing_deg, 180, -360, 360, "deg", \
        "of the observer that entities hide from, from each of them, clockwise from north") \
    ROW(DOUBLE, seen., range_m, 600, 10, 100000, "m", "its ground distance from each") \
    ROW(DOUBLE, seen., height_m, 250, 1, 20000, "m", "its height above each")

#define SCENARIO_DIS(ROW) \
    ROW(INT, dis., version, 7, 5, 7, "", "") \
    ROW(INT, dis., exercise, 1, 0, 255, "", "") \
    ROW(INT, dis., site, 1, 1, 65533, "", "") \
    ROW(INT, dis., application, 3001, 1, 65533, "", "") \
    ROW(BOOL, dis., bundle, false, "several PDUs in a datagram") \
    ROW(INT, dis., mtu, 1400, 576, 65000, "octets", "largest bundle") \
    ROW(BOOL, dis., fillers, false, "an Attribute or Data PDU after each PDU, as some simulators send") \
    ROW(BOOL, dis., updates, false, "Entity State Update between heartbeats; versions 6 and 7") \
    ROW(CHOICE, dis., stamps, SCENARIO_STAMPS_RELATIVE, ScenarioStamps, \
        (SCENARIO_STAMPS_RELATIVE, "relative")(SCENARIO_STAMPS_ABSOLUTE, "absolute")(SCENARIO_STAMPS_NONE, "none") \
        (SCENARIO_STAMPS_CONSTANT, "constant")(SCENARIO_STAMPS_COUNTER, "counter") \
        (SCENARIO_STAMPS_MILLISECONDS, "milliseconds")(SCENARIO_STAMPS_MICROSECONDS, "microseconds") \
        (SCENARIO_STAMPS_UNIX, "unix")(SCENARIO_STAMPS_HALF_RATE, "half-rate") \
        (SCENARIO_STAMPS_DOUBLE_RATE, "double-rate"), \
        "kind of time stamps; all but the first two are errors that senders are known to make") \
    ROW(DOUBLE, dis., stamp_s, 1350, 0, 3600, "s", "time past the hour at which relative time stamps begin") \
    ROW(TEXT, dis., date, "", 32, "", "UTC of the beginning in a recording, 2024-06-21T18:00:00Z") \
    ROW(TEXT, dis., clock, "", 32, "", "a Start/Resume PDU first, with this UTC as simulation time") \
    ROW(DOUBLE, dis., heartbeat_s, 5, 0.1, 3600, "s", "") \
    ROW(DOUBLE, dis., threshold_m, 1, 0.01, 1000, "m", "error of dead reckoning at which a report is sent") \
    ROW(DOUBLE, dis., threshold_deg, 3, 0.01, 180, "deg", "") \
    ROW(INT, dis., dead_reckoning, 4, 1, 9, "", "algorithm of entities that name none") \
    ROW(DOUBLE, dis., rate_hz, 60, 1, 1000, "Hz", "update rate of the simulator") \
    ROW(DOUBLE, dis., announce_per_s, 4000, 1, 1e6, "1/s", \
        "rate of first reports, so that a large exercise does not begin with a burst")

#define SCENARIO_FAULTS(ROW) \
    ROW(DOUBLE, faults., bad_every_s, 0, 0, 1e6, "s", \
        "a malformed PDU, of 14 kinds in turn, 0.001 s apart at least; 0: none") \
    ROW(DOUBLE, faults., loss, 0, 0, 1, "", "share of datagrams lost") \
    ROW(DOUBLE, faults., duplicate, 0, 0, 1, "", "share sent twice") \
    ROW(DOUBLE, faults., reorder, 0, 0, 1, "", "share overtaken by the next one")

/* One line of `vehicles`: one entity, or many of one kind on one route. x east, y north of the place, metres. */
typedef struct ScenarioGroup {
    SCENARIO_GROUP(SETTING_MEMBER) /* name: marking, and for shots `NAME ID`; route_m: smooth through its points */
    int line;                      /* line in the file */
    int over;                      /* nets alone: number of the group that they are over, plus 1; else 0 */
} ScenarioGroup;

/* One line of `shots`: a missile or rounds. at empty: at_m counts. */
typedef struct ScenarioShot {
    SCENARIO_SHOT(SETTING_MEMBER)
    int line;
} ScenarioShot;

typedef struct Scenario {
    char path[scenario_path_size];
    SCENARIO_TOP(SETTING_MEMBER)
    struct { SCENARIO_PLACE(SETTING_MEMBER) } place;
    struct { SCENARIO_GROUND(SETTING_MEMBER) } ground;
    struct { SCENARIO_SEEN(SETTING_MEMBER) } seen;
    struct { SCENARIO_DIS(SETTING_MEMBER) } dis;
    struct { SCENARIO_FAULTS(SETTING_MEMBER) } faults;
    int            group_count, shot_count;
    ScenarioGroup *group; /* [group_count] */
    ScenarioShot  *shot;  /* [shot_count] */
} Scenario;
/* clang-format on */

/* Reads and checks a file: ranges, types, routes, names in shots. No side effects beyond the log. On failure one line
 * is logged with file, line, key, value, range; *out is then empty. No other file is opened. */
Status scenario_read(Scenario *out, const char *path);
/* One key above the lists as a command line gives it, `dis.version`, 5. On failure *scenario is unchanged. */
Status scenario_set(Scenario *scenario, const char *key, const char *value, const char *source);
/* A key of an item of vehicles, by the item's name: of all items of that name. STATUS_BAD_VALUE, logged: there is none,
 * or as scenario_set. `net` is a key of the file alone. */
Status scenario_set_group(Scenario *scenario, const char *name, const char *key, const char *value, const char *source);
/* The same of an item of shots, by the name of its munition. */
Status scenario_set_shot(Scenario *scenario, const char *name, const char *key, const char *value, const char *source);
/* A key as a command line or an axis of a sweep gives it: `seed`, `dis.version`, or `vehicles.NAME.key` of all
 * vehicles of that name, `shots.NAME.key`. */
Status scenario_set_any(Scenario *scenario, const char *key, const char *value, const char *source);
/* Of which type such a key is; false: there is none. */
bool scenario_key_type(SettingType *out, const char *key);
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

const char *scenario_hide_name(enum ScenarioHide hide);
/* The place as the setting terrain.place of a node has it, which reads back equal: 50.1,8.6,120. */
enum { scenario_place_size = 80 };
void scenario_place_text(char out[scenario_place_size], const Scenario *scenario);
/* `1.1.222.1.1.1.0`; true when all seven are there. */
bool scenario_type_parse(DisEntityType *out, const char *text);

#endif
