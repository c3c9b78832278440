/* terrain/culture/culture.h: what people built on the ground, as records: buildings with outlines and heights, walls,
 * fences, lines, things at a place. From files, from a surface model, or
 * invented. What they look like: entities/scenery. */
#ifndef TERRAIN_CULTURE_CULTURE_H
#define TERRAIN_CULTURE_CULTURE_H

#include "pitviper_cache.h"

typedef enum BuildingUse {
    BUILDING_HOUSE,  /* lived in: windows, door, chimney */
    BUILDING_FLATS,  /* lived in, several levels; offices, schools too */
    BUILDING_BARN,   /* of a farm: large doors, no windows, not heated */
    BUILDING_SHED,   /* small, not heated: garages, huts */
    BUILDING_HALL,   /* of industry: sheet walls, roller doors, vents */
    BUILDING_CHURCH, /* tall, unheated */
    BUILDING_USES
} BuildingUse;

/* As OpenStreetMap's roof:shape has them; others count as the nearest. */
typedef enum RoofShape {
    ROOF_FLAT,
    ROOF_GABLED,    /* two slopes, ridge along ridge_rad */
    ROOF_HIPPED,    /* four slopes */
    ROOF_PYRAMIDAL, /* slopes from all walls to one point */
    ROOF_SKILLION,  /* one slope, falling towards ridge_rad */
    ROOF_SHAPES
} RoofShape;

/* What a wall or roof is covered with; etc/constructions.csv has the optics and layers of each. */
typedef enum BuildingFabric {
    FABRIC_BRICK,
    FABRIC_RENDER, /* plaster over masonry */
    FABRIC_STONE,
    FABRIC_TIMBER,
    FABRIC_CONCRETE,
    FABRIC_SHEET, /* metal */
    FABRIC_TILE,  /* of roofs, as all that follow */
    FABRIC_SLATE,
    FABRIC_FELT, /* bitumen on a flat roof */
    FABRIC_THATCH,
    FABRICS
} BuildingFabric;

typedef struct Building {
    uint64_t id;                    /* the same in every run: of its source and place */
    int      first_corner, corners; /* of Culture.corner_m: its outline, counter-clockwise from above, not closed */
    float    base_m;                /* ENU z of its floor: the lowest ground along its outline */
    float    eaves_m, ridge_m;      /* heights of eaves and of the highest edge of the roof over base_m */
    float    ridge_rad;             /* direction of the ridge, counter-clockwise from east */
    uint8_t  use, roof, wall_fabric, roof_fabric; /* BuildingUse, RoofShape, BuildingFabric */
    uint8_t  levels;                              /* storeys with windows, 1 .. 100 */
    bool     heated;
    uint8_t  chimneys; /* 0 .. 4 */
    uint8_t  damage;   /* 0 .. 3, as an entity's */
} Building;

typedef enum CultureLineKind {
    CULTURE_WALL,       /* masonry, height_m by width_m */
    CULTURE_FENCE,      /* posts and rails */
    CULTURE_WIRE_FENCE, /* posts and mesh */
    CULTURE_POWER_LINE, /* wires between its corners, on poles there */
    CULTURE_BRIDGE,     /* a deck of width_m at the height of its ends, on piers */
    CULTURE_ROAD,       /* ground of a surface, width_m wide; height_m 0, as of all that follow */
    CULTURE_TRACK,
    CULTURE_WATER, /* rivers, canals */
    CULTURE_YARD,  /* ground of a farm or works, on which vehicles stand */
    CULTURE_LINE_KINDS
} CultureLineKind;

typedef struct CultureLine {
    uint64_t id;
    int      first_corner, corners; /* of Culture.corner_m, in order */
    float    width_m, height_m;
    uint8_t  kind;    /* CultureLineKind */
    uint8_t  surface; /* SurfaceClass of ground that it covers; SURFACE_NONE: it covers none */
} CultureLine;

typedef enum CulturePointKind {
    CULTURE_POLE,      /* wood, of a line or a lamp */
    CULTURE_LAMP,      /* a pole that lights at night */
    CULTURE_SIGN,      /* a plate on a post */
    CULTURE_TANK,      /* upright cylinder */
    CULTURE_SILO,      /* tall cylinder with a cone */
    CULTURE_CONTAINER, /* freight container, of its size */
    CULTURE_HEAP,      /* cone of gravel, dung or earth */
    CULTURE_STACK,     /* hay bales, timber, pallets: a block */
    CULTURE_CHIMNEY,   /* of industry */
    CULTURE_MAST,      /* lattice */
    CULTURE_POINT_KINDS
} CulturePointKind;

typedef struct CulturePoint {
    uint64_t id;
    double   x_m, y_m;    /* ENU */
    float    base_m;      /* ENU z of its foot */
    float    heading_rad; /* clockwise from north: of its length */
    float    size_m[3];   /* length, width, height */
    uint8_t  kind;        /* CulturePointKind */
} CulturePoint;

/* A tree of a table or file (terrain.trees). */
typedef struct CultureTree {
    uint64_t id;
    double   x_m, y_m;
    float    height_m; /* 0: its kind's mean */
    uint8_t  kind;     /* PlantKind of terrain/woods/plant.h */
    uint8_t  mark;     /* PlantMark: what its trunk is painted with */
} CultureTree;

/* All of it, in a landscape's ENU, m. Arrays grow by culture_add_*; order is that of adding, and no result depends on
 * threads. */
typedef struct Culture {
    int corners, buildings, lines, points, trees;
    double (*corner_m)[2];
    Building            *building;
    CultureLine         *line;
    CulturePoint        *point;
    CultureTree         *tree;
    int                  room[5];            /* allocated: corners, buildings, lines, points, trees */
    int                  left_out, repaired; /* records that could not be used; those that were mended */
    struct CultureIndex *index;              /* of culture_index; NULL: none yet */
} Culture;

enum {
    culture_most_corners = 1 << 24,
    culture_most_records = 1 << 21, /* of each kind */
    culture_outline_most = 4096,    /* corners of one outline or line */
};
static const double culture_farthest_m = 1e6;                         /* from the origin, along each axis */
static const float  culture_highest_m = 850, culture_widest_m = 1000; /* of anything; of lines and points */

void culture_free(Culture *culture); /* accepts zeroes */
/* Of an outline, signed: positive when its corners go counter-clockwise. About its first corner, so that far ones lose
 * no digits; 0 of fewer than three. */
double culture_area_m2(const double (*corner_m)[2], int corners);
/* Append a record with its corners; first_corner and corners are set. An outline is turned counter-clockwise, repeated
 * and collinear corners are dropped; one that crosses itself, has no area (under 1 m2) or is not finite is left out and
 * counted, as is any record with a number outside the ranges above. STATUS_NO_MEMORY, or beyond the limits above:
 * STATUS_BAD_VALUE, logged. */
Status culture_add_building(Culture *culture, const Building *building, const double (*corner_m)[2], int corners);
Status culture_add_line(Culture *culture, const CultureLine *line, const double (*corner_m)[2], int corners);
Status culture_add_point(Culture *culture, const CulturePoint *point);
Status culture_add_tree(Culture *culture, const CultureTree *tree);

/* Of records that were filled in elsewhere: which of them is not as culture_add_* leaves it; NULL: all are. */
const char *culture_fault(const Culture *culture);

/* ---- look-ups by place, after culture_index ----------------------------------------------------- */

/* Some 12 octets a cell that a record reaches into; its cells grow until that is at most 100 MB and 96 octets for each
 * building, point and piece of a line between two corners. */
Status culture_index(Culture *culture);
/* The building whose outline, grown by more_m, holds a place; -1: none. Of several the first. Thread-safe. */
int culture_building_at(const Culture *culture, double x_m, double y_m, double more_m);
/* Whether anything built (buildings, lines, points; lines by half their width) is within more_m of a place: nothing
 * grows there. */
bool culture_is_near(const Culture *culture, double x_m, double y_m, double more_m);
/* The same but for yards: nothing can be parked there. */
bool culture_is_in_way(const Culture *culture, double x_m, double y_m, double more_m);
/* The surface that the last line with one over a place has; SURFACE_NONE: none. */
int culture_surface_at(const Culture *culture, double x_m, double y_m);
/* Whether a line with a surface reaches within more_m of a place. */
bool culture_surface_near(const Culture *culture, double x_m, double y_m, double more_m);
/* The first line of a kind that reaches within more_m of a place; -1: none. */
int culture_line_near(const Culture *culture, CultureLineKind kind, double x_m, double y_m, double more_m);

/* ---- what follows from it ------------------------------------------------------------------------ */

/* Adds every record to the key of something that follows from them. culture may be NULL: nothing is added. */
void culture_key_add(CacheKey *key, const Culture *culture);

#endif
