/* render/heat/scenery_heat_private.h: the heat of scenery over an exercise, shared by scenery_heat.c (who has which
 * temperatures), scenery_walls.c (its constructions) and scenery_states.c (its clutter). */
#ifndef RENDER_HEAT_SCENERY_HEAT_PRIVATE_H
#define RENDER_HEAT_SCENERY_HEAT_PRIVATE_H

#include "render/heat/heat_private.h"
#include "render/heat/scenery_heat.h"
#include "render/heat/vehicle_heat.h"
#include "render/heat/wall_column_private.h"

/* ---- constructions: scenery_walls.c ------------------------------------------------------------ */

/* A construction of one material that some part has. Its columns: facet by facet, then by n_up in the shade. */
typedef struct SceneryWall {
    int           row, material; /* of the constructions, of the materials */
    WallKind      kind;
    ColumnFactors factors[2][heat_halvings]; /* of step_s and of half hours, and of their halves */
    bool         *used;                      /* [columns]: some part faces there; others are not stepped */
    int          *nearest;                   /* [columns]: a used column, itself if it is used */
    size_t        first;                     /* of its temperatures in WallsState.temp_k: face by face that is used */
    float         memory[heat_day_slots];    /* K now for 1 W/m2 over a half hour so many half hours ago */
} SceneryWall;

enum { about_grass, about_paved, about_hidden, about_columns }; /* level; hidden: grass that sees neither sun nor sky */

/* All that advances. */
typedef struct WallsState {
    int64_t      index; /* time of the grid */
    double       day_k; /* a day's mean of the air */
    GroundColumn about[about_columns];
    double      *temp_k;                      /* [temps]: of all nodes of the faces of all walls */
    double       room_k[scenery_most_walls];  /* of unheated rooms */
    float        direct_w_m2[heat_day_slots]; /* facing the sun, by half hours of UTC */
} WallsState;

/* At a time of the grid, or between two. */
typedef struct WallsTable {
    double air_k, about_k[about_columns], behind_k[scenery_most_walls];
    float *face_k; /* [walls * columns]; of facets less sun_k times the cosines of their normal */
    float  sun_k[scenery_most_walls][heat_day_slots]; /* K now for the direct sun of a slot, per unit cosine */
} WallsTable;

typedef struct SceneryWalls {
    const SceneryHeatConfig *config;
    int                      count, columns;
    size_t                   temps;
    SceneryWall             *wall; /* [count] */
    Column                   layers[about_columns];
    ColumnFactors            factors[2][about_columns][heat_halvings];
    double                   ground_rho;
    Course                   course; /* while it is warmed up */
    int64_t                  first, begun_index, shown;
    GroundWeather            weather[2]; /* at the state's time, and a step on, as far as that is worked at */
    double                   about_k[2]; /* temperature of the ground about, at both */
    int                      ahead;      /* parts of the next step that are done */
    WallsState               now, begun; /* now may be within a step: ahead */
    WallsTable               table[2];   /* a step before shown, and at shown */
    int                      slots, slot_of[heat_day_slots];
    float                    slot_d_enu[3][heat_day_slots];
} SceneryWalls;

/* walls: zeroes with config, count, wall (row, material, used) and columns. */
Status scenery_walls_open(SceneryWalls *walls, const Materials *materials);
void   scenery_walls_close(SceneryWalls *walls); /* accepts zeroes */
/* Until the table holds unix_s, which may be before the last. */
void scenery_walls_advance(SceneryWalls *walls, double unix_s);
/* Of the sun of a slot on a wall's normal; both sides' of what has two. */
static inline double scenery_walls_cosine(const SceneryWalls *w, int wall, int slot, const double n_enu[3])
{
    const double along = (double)w->slot_d_enu[0][slot] * n_enu[0] + (double)w->slot_d_enu[1][slot] * n_enu[1] +
                         (double)w->slot_d_enu[2][slot] * n_enu[2];
    return w->wall[wall].kind.of.inside == BEHIND_BACK ? fabs(along) : fmax(along, 0);
}
/* Works ahead at the next step: what a frame pays. */
void scenery_walls_ahead(SceneryWalls *walls);
/* At a time that the table holds. */
double scenery_walls_share(const SceneryWalls *walls, double unix_s);
size_t scenery_walls_bytes(const SceneryWalls *walls);
/* The columns whose facets hold a normal. */
void scenery_walls_use(bool *used, int facets, const double n_enu[3]);
/* Column of the four about a normal, and shares along both axes; below the horizon: the wall of that side. */
int scenery_facet(double share[2], int facets, const double n_enu[3]);

/* ---- clutter: scenery_states.c ----------------------------------------------------------------- */

/* The open place at one time, without the ground. */
typedef struct TimedPlace {
    double    unix_s; /* NaN: none */
    PlaceHeat place;
} TimedPlace;

enum { times_kept = 256 };

typedef struct SceneryStates {
    const SceneryHeatConfig *config;
    const Scenery           *scenery;
    const SceneryWalls      *walls; /* the ground below them */
    Tracer                  *tracer;
    PatchSet                 patches;
    Materials                materials; /* the config's, with rows of these models' parts */
    NodePose                *node;      /* of all states, at rest */
    VehicleHeat             *heat;
    Snapshot                 snapshot;
    SnapshotEntity          *entity; /* [states] */
    double                   at_s;   /* exercise time of the last tick */
    TimedPlace              *place;  /* [times_kept]: states ask for the same times, one after the other */
} SceneryStates;

Status scenery_states_open(SceneryStates *states, SceneryWalls *walls);
void   scenery_states_close(SceneryStates *states); /* accepts zeroes */
/* Ticks up to unix_s; walls are advanced along. */
Status scenery_states_advance(SceneryStates *states, SceneryWalls *walls, double unix_s);
/* Temperatures of patches, in the arena; first[states]: -1: none are known. */
Status scenery_states_show(float **patch_k, int **first, SceneryStates *states, double unix_s, Arena *arena);
size_t scenery_states_bytes(const SceneryStates *states);

/* ---- both -------------------------------------------------------------------------------------- */

struct SceneryHeat {
    SceneryHeatConfig config;
    const Scenery    *scenery;
    Constructions     constructions;
    GroundKinds       ground;
    SceneryWalls      walls;
    SceneryStates     states;
    int              *part_first; /* [models + 1] of part_wall */
    int              *part_wall;  /* [parts of all models]: of walls.wall */
    int              *mover_of;   /* [objects]: of scenery->mover; -1: it stands */
};

struct SceneryTemps {
    const SceneryHeat *heat;
    double             unix_s, share, air_k; /* share: between the walls' tables */
    const float       *face_k;               /* [walls * columns]: as WallsTable's */
    float             *patch_k;
    int               *first;       /* [states] of patch_k */
    double (*r_enu_from_body)[9];   /* [movers] */
    float (*sun_k)[heat_day_slots]; /* [walls]; NULL: nothing is shaded */
};

#endif
