/* render/light/sky_visibility_private.h: a frame's sample points, shared by sky_visibility.c (the ground) and
 * sky_entities.c. */
#ifndef RENDER_LIGHT_SKY_VISIBILITY_PRIVATE_H
#define RENDER_LIGHT_SKY_VISIBILITY_PRIVATE_H

#include <stdatomic.h>

#include "render/light/sky_visibility.h"
#include "render/trace/parts/parts.h"

enum {
    known_slots = 1 << 15, /* of a block: more than 1024 hits x 4 places x 4 levels */
    lattice_steps = 4,     /* the ground's finest lattice: 2^-4 m */
    coarsest_log2_m = 4,
};
static const double look_m = 50; /* farther objects do not change the light of a point */
/* Whatever a path from a point may meet at any of its bounces is within this: the light of a point must not depend on
 * the block of hits that it was computed for. */
static const double paths_m = hemisphere_change_bounces * 50; /* x look_m */

/* Result of a point. */
typedef struct SkyAnswer {
    float factor[8];               /* by AirBand, and one to spare */
    float blocked, sunlit, inside; /* as HemisphereChange; inside 1: the point is not valid */
} SkyAnswer;

/* Points on an entity, in columns; where nothing of it was met the normal is 0. */
enum { SPOT_X, SPOT_Y, SPOT_Z, SPOT_NORMAL_X, SPOT_NORMAL_Y, SPOT_NORMAL_Z, SPOT_PART, spot_values };
typedef struct SkySpots {
    float *value[spot_values]; /* m, ENU, from the entity's centre; and which part */
    float (*factor)[8];        /* by AirBand, and one to spare */
    float (*below)[8];         /* SkyOpen.below, likewise */
} SkySpots;

/* An entity of the frame. */
typedef struct SkyEntity {
    int      index;           /* in the snapshot */
    int      columns, rows;   /* of its grid; 0: not on the image */
    bool     of_body;         /* the grid is seen from the middle of its aspect's bin, else from the eye */
    double   low[2], step[2]; /* px on the image; of_body: m along across_enu from the entity's place */
    double   from_enu[3], across_enu[2][3]; /* of_body: unit vectors, towards where the grid is seen from and across */
    double   pitch_m;                       /* of the grid at its distance */
    SkySpots spot;                          /* [rows * columns], and eight more */
    int      first_task, tasks;
    atomic_int taken, done; /* of its tasks */
} SkyEntity;

struct SkyVisibility {
    SkyVisibilityScene scene;
    int                count, on_image;
    int               *grid_of; /* [entities]: index into entity + 1 of those on the image; 0: of none */
    SkyEntity         *entity;  /* [on_image] */
    double             cells_per_m[coarsest_log2_m + lattice_steps + 1]; /* by step */
    int               *task_entity, *task_first;                         /* [tasks] */
    int                tasks;
    double             px_rad;
    double             level_w_m2[AIR_BAND_COUNT]; /* of open, level ground */
    SkyKeptFrame      *keeper;                     /* NULL: nothing is kept for other frames */
    _Atomic uint64_t  *cached_key;                 /* [cached_slots]; 0: free */
    _Atomic uint8_t   *cached_done;                /* [cached_slots]: 1: the place may be read */
    SkyAnswer         *kept;
};

typedef struct SkySlot {
    uint64_t  key;
    bool      known;
    SkyAnswer place;
} SkySlot;

/* A hit on the ground near an entity. */
typedef struct SkyHit {
    int8_t step, last_step; /* log2 of the cell, m: from the first down to the last */
    bool   force;           /* close to a body: always at the finest cells */
    float  weight;          /* 0: none near */
} SkyHit;

/* The cell used last of each size: neighbouring hits lie in it. */
typedef struct SkyCell {
    int64_t        column, row;
    uint32_t       block;
    bool           known, differ, any_inside; /* all corners known; they agree; of those */
    const SkySlot *corner[4];
} SkyCell;

/* The step at which hits of a finest cell ended. */
typedef struct SkyEnd {
    double   column, row;
    uint32_t block;
    int8_t   from, last, step;
    bool     force;
} SkyEnd;

struct SkyWorker {
    SkyEnd           end;
    SkyCell          cell[coarsest_log2_m + lattice_steps + 1];
    SkySlot         *slot;       /* [known_slots] */
    uint32_t        *slot_block; /* [known_slots]: number of the block in which it was written: others are free */
    uint32_t         block;
    int              queue[known_slots], queued; /* slots to be evaluated */
    SkyHit           hit[hits_capacity];
    Hits             places, met;
    Rays             rays;
    uint64_t         key[hits_capacity];
    HemisphereChange change[hits_capacity];
    SkyNotes        *notes;        /* NULL: nothing is kept */
    int             *near;         /* [entities] */
    double          *near_reach_m; /* of each: distance from its box within which the ground is treated */
    int8_t          *near_step;    /* of each: first_step_of */
};

/* Ratio of the light at a point of this normal to that in the open. */
void sky_answer(SkyAnswer *out, const SkyVisibility *v, const double n_enu[3], const HemisphereChange *change);
void sky_box_grow(double box[2][3], const Hits *hits, int i);
/* Entities whose spheres, grown by more_m (and their reach), touch the box, into w->near and the related arrays. */
int sky_list_near(SkyWorker *w, const SkyVisibility *v, double box[2][3], double more_m, bool with_reach);

/* sky_entities.c. The grid over the visible part of the box; tasks of all grids; a hit's factors. */
Status sky_entities_grid(SkyEntity *e, const SkyVisibility *v, const PosedEntity *posed, const double box_px[4],
                         Arena *arena);
Status sky_entities_tasks(SkyVisibility *v, Arena *arena);
/* Asks for the points of every entity that the hits show. */
void sky_entities_complete(const SkyVisibility *v, SkyWorker *w, const Hits *hits);
void sky_entities_open(SkyOpen *out, int i, const SkyVisibility *v, const Hits *hits);

#endif
