/* render/frame/planes.h: the one list of planes: where a picture has each one, and what is said of it. Making, files,
 * hashes, shared memory, help, the choice of planes and regression walk it: a new plane is a row (etc/ADDING.md). */
#ifndef RENDER_FRAME_PLANES_H
#define RENDER_FRAME_PLANES_H

#include "render/frame/picture.h"
#include "render/frame/plane_type.h"
#include "render/materials/materials.h"

typedef enum PlaneKind { PLANE_RADIANCE, PLANE_TRUTH, PLANE_PROFILE } PlaneKind;
/* Of a world without plants: there as in any; made, and not listed; neither. */
typedef enum PlanePlants { PLANTS_OR_NOT, PLANTS_LIST, PLANTS_MAKE } PlanePlants;

/* To that many bits of mantissa (1 .. 22), or to the nearest multiple of a step. Both 0: as it is. */
typedef struct PlaneRounding {
    int    bits; /* 0: by step */
    double step;
} PlaneRounding;

typedef struct PlaneRow {
    const char *group, *name; /* the folder of its file, and its channel there; of the standard channels of light */
    PlaneKind   kind;
    PlaneType   type;                          /* F32 numbers; U32, U8 numbers of things, 0: none */
    const char *unit, *frame, *absent, *about; /* as ReferenceField (sensor/reference/reference.h) */
    unsigned    bands;                         /* 1 << Band: it is there with any of them; 0: truth of every request */
    bool        rgb;                           /* of the optical band with three colours; else with one */
    PlanePlants plants;
    size_t      at; /* in a Picture, of the pointer to its values; unless made */
    /* Made when its file is written, and in no hash of a frame: out [height][width]. NULL: as rendered. */
    void (*make)(float *out, const struct PlaneRow *row, const Picture *picture, const Materials *materials);
    const char *choice;           /* of truth: its name in publish.planes, which planes side by side may share */
    const char *record, *verdict; /* its name in a baseline of regress, and the channel of a verdict, with its
                                     tolerance (sensor/verify/regress/verdict_planes.c). NULL: it is not compared */
    PlaneRounding rounding;       /* there */
} PlaneRow;

/* 1 << row. */
typedef uint64_t PlaneSet;
enum { planes_most = 48 };

/* In the order in which a frame lists them: bands, truth, profile. */
extern const PlaneRow plane_rows[];
extern const int      plane_row_count;

int plane_find(const char *group, const char *name); /* row; -1: none */
/* The i-th that a baseline of regress has: truth, then bands, which a run may lack. NULL at the end. */
const PlaneRow *plane_recorded(int i);
PlaneSet    planes_named(const char *choice, size_t length); /* none: 0; all that have a name: planes_named("", 0) */
const char *plane_group(const PlaneRow *row);                /* as this run names its channels of light */
Band        plane_band(const PlaneRow *row);                 /* the first of its bands; BAND_COUNT: of all */
const void *plane_values(const PlaneRow *row, const Picture *picture); /* NULL: not there, or not listed */
/* Whether a request has the bands, or colours, that it is of. */
bool plane_of_bands(const PlaneRow *row, unsigned bands, OpticalChannels optical);

/* Planes for a request, all 0; truth planes where truth is requested and where edges are looked for. instances:
 * the world has plants or scenery.
 * STATUS_NO_MEMORY: of the arena. */
Status planes_create(Picture *out, const RenderRequest *request, int entities, bool instances, Arena *arena);
/* Removes from the picture the planes that only the search for edges needed. */
void planes_forget_truth(Picture *picture);

#endif
