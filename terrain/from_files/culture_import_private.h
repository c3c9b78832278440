/* terrain/from_files/culture_import_private.h: from attributes and places of files to records of culture: what its
 * parts share. */
#ifndef TERRAIN_FROM_FILES_CULTURE_IMPORT_PRIVATE_H
#define TERRAIN_FROM_FILES_CULTURE_IMPORT_PRIVATE_H

#include "terrain/elevation/vector.h"
#include "terrain/from_files/culture_import.h"
#include "terrain/surface.h"
#include "terrain/woods/plant.h"

/* ---- culture_texts.c: values of attributes, which are other people's texts ---- */

/* A length: `12`, `12.5 m`, `3,5`, `39 ft`, `39'6"`, `5 ft 6 in`, `120 cm`. False: it is none. */
bool culture_metres(double *out_m, const char *text);
/* A number without unit, `2`, `2.5`, `2,5`; of several, `2;3`, the first. */
bool culture_number(double *out, const char *text);
/* A compass direction, clockwise from north: `135`, `135°`, `NW`, `north`. */
bool culture_direction(double *out_rad, const char *text);
/* The next pair of names and values in `"key"=>"value","key"=>"value"` (hstore) or `{"key": "value"}` (JSON), into
 * name and value (cut), from *at on, which moves behind it. False: there is none. */
enum { culture_text_size = 256 };
bool culture_pair(char name[culture_text_size], char value[culture_text_size], const char **at);

/* ---- culture_rules.c: etc/culture_tags.csv ---- */

/* The words of its column `makes`, in their order. */
typedef enum RuleMakes {
    MAKES_BUILDING,
    MAKES_USE,
    MAKES_LINE,
    MAKES_POINT,
    MAKES_TREE,
    MAKES_TREE_ROW,
    MAKES_NOTHING,
    MAKES_HEIGHT, /* numbers and words, as all that follow */
    MAKES_EAVES,
    MAKES_LEVELS,
    MAKES_ROOF_HEIGHT,
    MAKES_ROOF_LEVELS,
    MAKES_WIDTH,
    MAKES_LANES,
    MAKES_DIRECTION,
    MAKES_ROOF,
    MAKES_ROOF_WAY,
    MAKES_RIDGE, /* its direction */
    MAKES_CHIMNEYS,
    MAKES_HEATED,
    MAKES_WALL,
    MAKES_COVER,
    MAKES_GROUND,
    MAKES_PLANT,
    MAKES_BRIDGE,
    MAKES_HIDDEN,
    MAKES_RUINED,
    MAKES_MARKED,
    MAKES_ID,
    MAKES_TAGS,
    MAKES_COUNT
} RuleMakes;

typedef struct CultureRule {
    char   key[32], value[48];
    int    makes; /* RuleMakes */
    char   kind_name[24];
    int    kind;              /* by makes: BuildingUse, CultureLineKind ..., an index of the words there; -1: empty */
    double height_m, width_m; /* 0: empty */
    int    surface;           /* SurfaceClass */
    int    next;              /* the next rule of the same key; -1: none */
} CultureRule;

typedef struct CultureRules {
    int          count, keys;
    CultureRule *rule; /* [count] in the file's order */
    int         *key;  /* [keys] the first rule of each key, by name */
} CultureRules;

/* path NULL: that of etc/. Failures are logged with file and line. */
Status culture_rules_open(CultureRules *out, const char *path);
void   culture_rules_close(CultureRules *rules); /* accepts zeroes */

/* What a feature's attributes say. Numbers are NAN, words -1, where they say nothing. */
typedef struct CultureFacts {
    const CultureRule *what[VECTOR_POLYGON + 1]; /* what it is as a point, line or polygon; NULL: none of these */
    bool               known;                    /* some rule says what it is, perhaps something else */
    int                use, roof, wall, cover, ground, plant;
    int                roof_way; /* 0: along, 1: across */
    int                heated;   /* 0, 1 */
    double    height_m, eaves_m, ridge_rad, chimneys, levels, roof_height_m, roof_levels, width_m, lanes, direction_rad;
    bool      bridge, hidden, ruined;
    PlantMark mark;
    int       unread; /* numbers that are none */
    uint64_t  id;     /* 0: none */
} CultureFacts;

void culture_facts(CultureFacts *out, const CultureRules *rules, int tags, const char *const *name,
                   const char *const *value);

/* Well mixed bits of numbers (FNV-1a), for ids. */
static inline uint64_t culture_mix(uint64_t seed, const void *octets, size_t count)
{
    const uint8_t *at = octets;
    for (size_t k = 0; k < count; k++) seed = (seed ^ at[k]) * 0x100000001b3u;
    return seed;
}
static const uint64_t culture_mix_seed = 0xcbf29ce484222325u;

/* ---- culture_building.c ---- */

/* All of a building but its outline, place and id, from its facts and its outline in ENU. mended: how many numbers
 * could not be a building's and were left aside. hollow: the outline goes round courtyards. */
void culture_building_make(Building *out, HeightFrom *from, int *mended, const CultureFacts *facts,
                           const double (*corner_m)[2], int corners, double area_m2, bool hollow);
/* Sides of the smallest rectangle about an outline that has an edge of it for a side, longer first, and the direction
 * of the longer, counter-clockwise from east. */
void culture_rectangle(double side_m[2], double *along_rad, const double (*corner_m)[2], int corners);

/* ---- culture_import.c ---- */

/* ENU x and y of a place on the ground. */
void culture_place(double p_m[2], const CultureFiles *from, double lon_rad, double lat_rad);

/* ---- culture_known.c ---- */

typedef enum KnownList { KNOWN_BUILDING, KNOWN_LINE, KNOWN_POINT, KNOWN_TREE } KnownList;
typedef struct KnownRecord {
    int32_t list, number; /* number: in its list, from 1; 0: the slot is free */
} KnownRecord;

/* Records of a culture by where they are. Zeroes: none; slot is to be freed. */
typedef struct CultureKnown {
    size_t       room, count; /* room: a power of two */
    KnownRecord *slot;        /* [room] */
} CultureKnown;

/* Adds the last record of a list, which only grows. *again: there is one like it, of its kind and with its corners to
 * the bit; then it is not added. */
Status culture_known_take(bool *again, CultureKnown *known, const Culture *culture, KnownList list);
/* Indexes the culture; leaves out poles and masts that carry a power line, whose corners are poles. */
Status culture_leave_poles(Culture *culture, CultureReport *report);

/* ---- culture_trees.c ---- */

Status culture_trees_read(Culture *culture, CultureReport *report, const CultureFiles *from);
/* The kind of plant of a name; PLANT_STANDING: none that stands by itself. */
PlantKind culture_plant(const char *name);
PlantMark culture_mark(const char *word); /* PLANT_MARKS: no such word */

#endif
