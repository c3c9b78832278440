/* render/heat/given_heat.h: temperatures that come from files: given by the user, or kept over a restart. */
#ifndef RENDER_HEAT_GIVEN_HEAT_H
#define RENDER_HEAT_GIVEN_HEAT_H

#include "dis/pdu/pdu.h"
#include "entities/models/model.h"

/* ---- given ----------------------------------------------------------------------------------- */

/* Temperatures of parts that the user gives, measured or from another program, instead of
 * the network's: a CSV file with one row for each part and time.
 *
 *     entity,part,t_s,temp_k
 *     tank,engine_deck,0,296
 *     tank,engine_deck,600,331.5
 *     1:1:7,*,0,290
 *
 * entity: a DIS entity id, the name of a model, or * for all; part: the name of a part, a role of etc/heat.csv, or *.
 * t_s: exercise time (time_s of truth.jsonl); temp_k: 1 .. 4000. Straight lines between rows, the first and last
 * temperature before and after them. What names an entity wins over a model, that over *; then the part over its role,
 * that over *. */

typedef struct GivenHeat GivenHeat;

/* Rows of one entity and part must have ascending times; others may lie between them. STATUS_BAD_VALUE, STATUS_IO,
 * STATUS_NO_MEMORY, logged with file and line. */
Status given_heat_open(GivenHeat **out, const char *path);
void   given_heat_close(GivenHeat *given); /* accepts NULL */

/* What a part is given: -1: nothing. *rank: the higher, the closer it is named. */
int    given_heat_find(int *rank, const GivenHeat *given, DisEntityId id, const Model *model, int part);
double given_heat_k(const GivenHeat *given, int index, double t_s);

/* ---- kept over a restart --------------------------------------------------------------------- */

/* Temperatures of entities' networks in a file, over a restart of a node.
 *
 *     entity,model,unix_s,node_k
 *     1:1:7,tank,1782043200.5,291.2 290.75 ...
 *
 * One row an entity, one number a node of its network. */

typedef struct KeptHeat KeptHeat;

/* One entity. */
typedef struct KeptNodes {
    DisEntityId   id;
    const char   *model;
    double        unix_s;
    int           nodes;
    const double *temp_k; /* [nodes] */
} KeptNodes;

/* Every value is checked: STATUS_BAD_VALUE, STATUS_IO, STATUS_NO_MEMORY, logged with file and line. Of two rows of one
 * entity the first counts. */
Status heat_kept_open(KeptHeat **out, const char *path);
void   heat_kept_close(KeptHeat *kept); /* accepts NULL */
/* NULL: there is none of this entity, model and number of nodes. */
const KeptNodes *heat_kept_find(const KeptHeat *kept, DisEntityId id, const char *model, int nodes);
/* Written to PATH.part and renamed. STATUS_IO, logged. */
Status heat_kept_save(const KeptNodes *nodes, int count, const char *path);

#endif
