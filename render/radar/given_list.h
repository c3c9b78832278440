/* render/radar/given_list.h: which entities scatter by a signature that is given, by a CSV file with a row each.
 *
 *     entity,signature
 *     tank,measured/tank_ka.csv
 *     1:1:7,decoy.csv
 *
 * entity: a DIS entity id, the name of a model, or * for all; what names an entity wins over a model, that over *.
 * signature: a file of given_signature.h, relative to this one's folder. */
#ifndef RENDER_RADAR_GIVEN_LIST_H
#define RENDER_RADAR_GIVEN_LIST_H

#include "dis/pdu/pdu.h"
#include "render/radar/given_signature.h"

typedef struct GivenList GivenList;

/* Reads every signature. STATUS_BAD_VALUE, STATUS_IO, STATUS_NO_MEMORY: logged with file and line. */
Status given_list_open(GivenList **out, const char *path);
void   given_list_close(GivenList *list); /* accepts NULL */
/* NULL: none is given. list may be NULL. model: its name. */
const GivenSignature *given_list_find(const GivenList *list, DisEntityId id, const char *model);

#endif
