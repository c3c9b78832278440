/* render/heat/kept_heat.h: temperatures of entities' networks in a file, over a restart of a node.
 *
 *     entity,model,unix_s,node_k
 *     1:1:7,tank,1782043200.5,291.2 290.75 ...
 *
 * One row an entity, one number a node of its network. */
#ifndef RENDER_HEAT_KEPT_HEAT_H
#define RENDER_HEAT_KEPT_HEAT_H

#include "dis/pdu/pdu.h"

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
Status kept_heat_open(KeptHeat **out, const char *path);
void   kept_heat_close(KeptHeat *kept); /* accepts NULL */
/* NULL: there is none of this entity, model and number of nodes. */
const KeptNodes *kept_heat_find(const KeptHeat *kept, DisEntityId id, const char *model, int nodes);
/* Written to PATH.part and renamed. STATUS_IO, logged. */
Status kept_heat_save(const KeptNodes *nodes, int count, const char *path);

#endif
