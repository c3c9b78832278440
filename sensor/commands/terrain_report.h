/* sensor/commands/terrain_report.h: what `pitviper terrain import` read and made, in words or as JSON. */
#ifndef SENSOR_COMMANDS_TERRAIN_REPORT_H
#define SENSOR_COMMANDS_TERRAIN_REPORT_H

#include "terrain/import/terrain_import.h"

struct json_t;

typedef struct SourceLines {
    bool           json; /* kept until the end; else printed when they are added, before the files are used */
    struct json_t *list; /* private; NULL: none */
} SourceLines;

void   source_lines_add(SourceLines *lines, const ElevationSurvey *survey);
void   source_lines_free(SourceLines *lines);
/* STATUS_NO_MEMORY: nothing was printed. */
Status terrain_report(const char *store, const TerrainReport *report, double seconds, const SourceLines *lines);

#endif
