/* sensor/framefile/frame_tables.h: the tables that a frame depends on: those of run.json, and the user's own. */
#ifndef SENSOR_FRAMEFILE_FRAME_TABLES_H
#define SENSOR_FRAMEFILE_FRAME_TABLES_H

#include "sensor/settings/tables_used.h"

/* As tables_used; models.catalog and models.materials are listed by these names. catalog: that of etc/. */
Status frame_tables(TablesUsed *out, const Config *config, const char *catalog);

#endif
