/* entities/scenery/scenery_buildings_private.h: what the files that make buildings and works share.
 *
 * Places are in a cell's local ENU (east, north, up from its origin), m, double; cell_take turns them into the model's
 * axes. */
#ifndef ENTITIES_SCENERY_SCENERY_BUILDINGS_PRIVATE_H
#define ENTITIES_SCENERY_SCENERY_BUILDINGS_PRIVATE_H

#include "entities/scenery/scenery_buildings.h"

/* ---- outlines (scenery_outline.c) ----------------------------------------------------------------- */

/* Cuts a simple counter-clockwise polygon into n - 2 triangles (indices, counter-clockwise), by ears, the least
 * slender first. false: a triangle had to be turned over (a polygon that crosses itself); it still has n - 2 triangles
 * then. Without memory: false, status STATUS_NO_MEMORY, which is else left alone. O(n^2) for usual outlines. */
bool outline_triangulate(int (*triangle)[3], Status *status, const double (*p)[2], int n);
/* Moves every edge outwards by out_m (negative: inwards), corners mitred. false: the result would cross itself or lose
 * an edge. still [n]: edges that stay where they are; NULL: none. */
bool outline_offset(double (*to)[2], const double (*p)[2], int n, double out_m, const bool *still);
/* The longest mitre of a corner, in units of the distance that edges move. */
double outline_longest_mitre(const double (*p)[2], int n);

/* ---- roofs' plans (scenery_skeleton.c) ------------------------------------------------------------ */

enum { roof_plan_corners = 256 };

/* The straight skeleton of an outline: where equal slopes from all eaves meet. */
typedef struct RoofPlan {
    int nodes, faces, corners;
    double (*node)[3]; /* x, y, and time: distance from the eaves whose slopes meet there; the first are the corners */
    int   *first;      /* [faces + 1] of index */
    int   *index;      /* nodes of faces, counter-clockwise from above (of gables: from outside) */
    int   *edge;       /* [faces]: from which corner on the edge goes that the face rises from; -1: a flat top */
    double most_time_m;
} RoofPlan;

/* gable [n]: edges that stand still, whose face is upright; NULL: none. No two neighbours may be gables. false: no plan
 * of positive faces was found (or too many corners); out is empty. status: STATUS_NO_MEMORY when memory was out. */
bool roof_plan_make(RoofPlan *out, Status *status, const double (*p)[2], int n, const bool *gable);
void roof_plan_free(RoofPlan *plan);

/* ---- a cell's mesh (scenery_cell.c) --------------------------------------------------------------- */

enum { cell_slots = 24 };

typedef struct CellMesh {
    Model     model;
    int       vertex_room, triangle_room, part_room, id_room, pending_room, pendings;
    Status    status;
    uint64_t *id; /* [model.part_count]: of its record */
    /* of the record being made: its parts and their triangles, in any order */
    uint64_t  record;
    int       slots;
    ModelPart slot[cell_slots];
    uint32_t (*pending)[4]; /* three vertices and the slot */
} CellMesh;

void cell_begin(CellMesh *cell, uint64_t id);
/* The slot of a part of this name, material and role in the record being made. */
int      cell_part(CellMesh *cell, const char *name, const char *material, HeatRole role);
void     cell_end(CellMesh *cell);
uint32_t cell_vertex(CellMesh *cell, const double p[3], const double n[3]);
void     cell_triangle(CellMesh *cell, int slot, uint32_t a, uint32_t b, uint32_t c);
/* A flat polygon, counter-clockwise seen from outside; nothing when it has no area. */
void cell_face(CellMesh *cell, int slot, const double (*p)[3], int n);
/* An upright prism, closed: outline n <= 64 of the local plane, from z0 to z1. */
void cell_prism(CellMesh *cell, int slot, const double (*p)[2], int n, double z0, double z1);
/* A box: middle of its base, half sizes along u and across (unit, horizontal), from z0 to z1. */
void cell_box(CellMesh *cell, int slot, const double middle[2], const double along[2], double half_along,
              double half_across, double z0, double z1);
void cell_mesh_free(CellMesh *cell);

/* ---- solids of works (scenery_solids.c) ----------------------------------------------------------- */

/* A place on a line: left: horizontal, to the left of its way, longer than 1 where the line turns (mitred). */
typedef struct Station {
    double p[3], left[2];
} Station;

/* A rectangle across a line: its middle to the left, half its width, from low to high. */
typedef struct Section {
    double across_m, half_m, low_m, high_m;
} Section;

/* A closed band along n >= 2 stations. */
void cell_sweep(CellMesh *cell, int slot, const Station *station, int n, const Section *of);
/* A bar of square section between two points. */
void cell_bar(CellMesh *cell, int slot, const double from[3], const double to[3], double half_m);
/* A body of revolution about an upright axis, or an elliptic one: radius (in units of half, along the heading and
 * across) and height of a meridian from the axis at the bottom to the axis at the top; sides <= 64. */
void cell_round(CellMesh *cell, int slot, const double middle[2], const double half[2], double heading_rad,
                const double (*rz)[2], int n, int sides);
/* Makes the model: parts in the order of their records. */
Status cell_take(Model *out, uint64_t **id, CellMesh *cell, const char *name);

/* ---- what things are made of (scenery_fabrics.c) -------------------------------------------------- */

/* Rows of etc/materials.csv, varied by id. */
const char *fabric_material(int fabric, uint64_t id);
const char *door_material(uint64_t id);
const char *frame_material(uint64_t id);
/* A number of 0 .. 1 that follows from an id and a stream. */
double record_random(uint64_t id, uint32_t stream);

/* ---- buildings ------------------------------------------------------------------------------------ */

/* A building being made. */
typedef struct BuildingWork {
    const Culture  *culture;
    const Building *b;
    CellMesh       *cell;
    int             n;
    double (*p)[2];                 /* outline in the cell's plane */
    bool          *slit;            /* [n]: sides of slits to courtyards; NULL: there are none */
    double         base_m;          /* in the cell's height */
    double         top_m;           /* of the walls' upright part over the base: what roofs leave */
    double         skirt_m;         /* how far walls go into the ground */
    int            wall, roof, lid; /* slots; lid: what closes walls under the roof */
    int            holes;           /* faces of the roof so far, each with random numbers of its own */
    SceneryGround *ground_m;        /* in ENU */
    void          *user;
    double         origin[3];                /* of the cell in ENU */
    double         ridge[2][2], ridge_top_m; /* the highest line of the roof, for chimneys */
} BuildingWork;

/* Adds the roof and what of the walls is over top_m, with its lid, and the floor; sets top_m. */
void building_roof(BuildingWork *w);
/* A gutter of zinc sheet along the eaves of what people live in, just outside of the slab's edge at height z. */
void building_gutters(BuildingWork *w, const RoofPlan *plan, const bool *gable, double z);
/* Adds the walls to top_m, with windows and doors. */
void building_walls(BuildingWork *w);
/* All that is left of a destroyed building. */
void building_ruin(BuildingWork *w);
void building_make(CellMesh *cell, const Culture *culture, const Building *b, const double origin[3],
                   SceneryGround *ground_m, void *user);

/* A heap of a material, elliptic: middle of its foot, half sizes along and across. */
void cell_heap(CellMesh *cell, int slot, const double at[3], const double along[2], const double half[2], double high_m,
               uint64_t id);

/* ---- works (scenery_points.c, scenery_lines.c) ---------------------------------------------------- */

void cell_pole(CellMesh *cell, int slot, const double at[3], double high_m, double radius_m);
void cell_lattice(CellMesh *cell, int slot, const double at[3], const double along[2], double high_m, double low_half_m,
                  double top_half_m);
void point_make(CellMesh *cell, const CulturePoint *point, const double origin[3]);

/* Ground under works. */
typedef struct WorksGround {
    SceneryGround *ground_m;
    void          *user;
    double         origin[3]; /* of the cell in ENU */
} WorksGround;

/* Into how many pieces a line is cut; 0: nothing of it is seen. Piece k is between stations k and k + 1. */
int line_pieces(const Culture *culture, const CultureLine *line);
/* Where a walk along a line is: at this corner, with so many pieces before it; zeroes: at its beginning. */
typedef struct LineCursor {
    int corner, before;
} LineCursor;

void line_piece_middle(double xy_m[2], LineCursor *at, const Culture *culture, const CultureLine *line, int piece);
/* Makes pieces first .. first + count - 1 of a line. */
void line_make(CellMesh *cell, const Culture *culture, const CultureLine *line, int first, int count,
               const WorksGround *ground);

#endif
