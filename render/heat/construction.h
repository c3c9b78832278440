/* render/heat/construction.h: what parts of buildings and works are built of, for their heat: rows of
 * etc/constructions.csv, which gives sources. */
#ifndef RENDER_HEAT_CONSTRUCTION_H
#define RENDER_HEAT_CONSTRUCTION_H

#include "entities/models/model.h"
#include "render/heat/column_private.h"

/* What is behind the innermost layer.
 *   heated    a room kept at room_day_k from 6 to 22 h of the place's mean solar time, else at room_night_k; never
 *             colder than a day's mean of the air and 3 K, as without heating (CIBSE TM41: base temperature of 15.5 C
 *             for rooms of 18.5 C)
 *   unheated  a room of its own: its air and what stands in it, of room_j_m2k per area of the envelope, between the
 *             inner faces of this construction to the north, east, south, west and up, and the outer air by room_w_m2k
 *   flue      gas of room_day_k and room_night_k, while a day's mean of the air is below 15 C (the heating limit of
 *             DIN 4108-6); otherwise the outer air
 *   back      the outer air and sky of the other side, the whole of one temperature: sheet, rails, wires
 *   none      nothing: no heat goes through */
typedef enum ConstructionInside {
    BEHIND_HEATED,
    BEHIND_UNHEATED,
    BEHIND_FLUE,
    BEHIND_BACK,
    BEHIND_NONE,
} ConstructionInside;

/* Elements of its columns: the first at the outer face and at each layer's, and their growth. */
static const double wall_first_m = 0.003, wall_growth = 1.3;

enum { construction_most_layers = column_most_layers, construction_most = 128 };

typedef struct Construction {
    char               name[40];
    char               part[24], material[32]; /* empty: any; material: a piece of the name */
    HeatRole           role;
    bool               any_role;
    ConstructionInside inside;
    int                layers;
    ColumnLayer        layer[construction_most_layers]; /* from outside in */
    double             inside_w_m2k;                    /* of the inner face; of a room with radiation */
    double             room_day_k, room_night_k, room_j_m2k, room_w_m2k;
    double             rough;       /* factor on the forced part of the film of glass (Walton 1983) */
    double             absorptance; /* NaN: the material's */
} Construction;

/* A material of layers (etc/construction_layers.csv), or a void of a given resistance. */
typedef struct LayerMaterial {
    char   name[32];
    double conductivity_w_mk, density_kg_m3, heat_capacity_j_kgk;
    double resistance_m2k_w; /* of a void, whatever its thickness; 0: it is none */
} LayerMaterial;

enum { construction_most_materials = 128 };

typedef struct Constructions {
    int          count;
    Construction row[construction_most]; /* the last: of any part */
} Constructions;

/* layers_path: etc/construction_layers.csv. Failures are logged with file, line, column and what is accepted. */
Status constructions_open(Constructions *out, const char *path, const char *layers_path);
Status constructions_open_etc(Constructions *out); /* of the folder etc */
/* Row of a part: the first whose part and role are its own, or any, and whose material is a piece of its material's
 * name (brick: of brick_red too). The last fits all. */
int constructions_find(const Constructions *of, const char *part, HeatRole role, const char *material);
int constructions_named(const Constructions *of, const char *name); /* -1: none */

#endif
