/* render/scattering/built/thing_table.h: mean radar cross sections of shapes of clutter by aspect, from
 * etc/radar/things.csv. */
#ifndef RENDER_SCATTERING_BUILT_THING_TABLE_H
#define RENDER_SCATTERING_BUILT_THING_TABLE_H

#include "render/scattering/clutter/clutter.h"

enum { thing_rows_most = 64, thing_aspects = 7 /* 0, 30 .. 180 degrees from the nose */ };

typedef struct ThingRow {
    char   name[32]; /* of a model */
    double dbsm[CLUTTER_BAND_COUNT][thing_aspects];
} ThingRow;

typedef struct ThingTable {
    int      count;
    ThingRow row[thing_rows_most];
    double   hv; /* power of HV over that of VV, of all */
} ThingTable;

/* Each shape must have a row for each band; failures are logged and leave *out as it was. */
Status thing_table_open(ThingTable *out, const char *path);
/* NULL: none of that name. */
const ThingRow *thing_row(const ThingTable *table, const char *name);
/* Mean cross section, m^2, of a shape that is the same on both sides, in a direction in body axes (x forward, z down);
 * between aspects linear in dB. */
double thing_rcs_m2(const ThingRow *row, ClutterBand band, const double u_body[3]);

#endif
