/* sensor/node/cigi/cigi_types.h: what the entity types of a CIGI host mean, by a table (etc/cigi_types.csv): CIGI's are
 * numbers that host and image generator agree on. */
#ifndef SENSOR_NODE_CIGI_CIGI_TYPES_H
#define SENSOR_NODE_CIGI_CIGI_TYPES_H

#include "dis/pdu/pdu.h"

enum { cigi_types_most = 1024 };

typedef struct CigiType {
    int           number; /* of Entity Control: 1 .. 65535 */
    DisEntityType type;
    int           force; /* of DIS: 0 other, 1 friendly, 2 opposing, 3 neutral */
} CigiType;

typedef struct CigiTypes {
    int      count;
    CigiType row[cigi_types_most];
} CigiTypes;

/* path: empty: etc/cigi_types.csv. STATUS_BAD_VALUE or STATUS_IO, logged with file, line and column. */
Status cigi_types_read(CigiTypes *out, const char *path);
/* NULL: there is no such row. */
const CigiType *cigi_types_find(const CigiTypes *types, int number);

#endif
