/* tests/terrain/vector_lab.h: a folder of files with vectors on a hill, made by hand and by ogr2ogr, and opened as
 * culture. */
#ifndef TESTS_TERRAIN_VECTOR_LAB_H
#define TESTS_TERRAIN_VECTOR_LAB_H

#include "tests/terrain/raster_lab.h"

#include "terrain/earth/geodesy.h"
#include "terrain/from_files/culture_import.h"
#include "terrain/elevation/vector.h"
#include "terrain/surface.h"
#include "terrain/woods/plant.h"

#include <sys/stat.h>

static char       folder[64];
static LocalFrame frame;

static const double lat0 = 47.05, lon0 = 13.02;

/* A hill that leans to the north-east; nothing north of 12 km. */
static inline double hill(void *user, double x_m, double y_m)
{
    (void)user;
    if (y_m > 12000) return (double)NAN;
    return 640 + 0.03 * x_m - 0.02 * y_m - (x_m * x_m + y_m * y_m) / 12.74e6;
}

static inline int open_lab(void **state)
{
    (void)state;
    strcpy(folder, "/tmp/pitviper-culture-XXXXXX");
    if (!mkdtemp(folder)) return 1;
    return local_frame_at(&frame, &(Geodetic){lat0 * rad_per_deg, lon0 * rad_per_deg, 600}) != STATUS_OK;
}

static inline int close_lab(void **state)
{
    char line[128];
    (void)state;
    snprintf(line, sizeof line, "rm -rf %s", folder);
    return system(line) != 0;
}

static inline void path_of(char out[128], const char *name) { snprintf(out, 128, "%s/%s", folder, name); }

static inline void save(const char *name, const char *text)
{
    char path[128];
    path_of(path, name);
    FILE *file = fopen(path, "w");
    CHECK(file && fputs(text, file) >= 0 && fclose(file) == 0);
}

/* Runs a program on files of the folder. */
static inline void convert(const char *arguments)
{
    char line[512];
    snprintf(line, sizeof line, "cd %s && ogr2ogr %s >log 2>&1", folder, arguments);
    if (system(line) != 0) fail_msg("ogr2ogr %s", arguments);
}

static inline bool has_judge(void) { return system("command -v ogr2ogr >/dev/null") == 0; }

/* Without ogr2ogr a test is skipped; where all judges are wanted that is a failure. */
static inline void need_judge(void)
{
    if (has_judge()) return;
    if (getenv("CI")) fail_msg("no ogr2ogr: etc/setup --tests installs it");
    skip();
}

static inline Status open_names(Culture *c, CultureReport *r, const char *names, const char *trees)
{
    char all[1024] = "", table[128] = "", *at = all;
    for (const char *name = names; *name;) {
        const size_t length = strcspn(name, ",");
        const bool   own = *name != '/' && !strstr(name, ":/");
        at += snprintf(at, (size_t)(all + sizeof all - at), "%s%s%s%.*s", at > all ? "," : "", own ? folder : "",
                       own ? "/" : "", (int)length, name);
        name += length + (name[length] != 0);
    }
    if (trees) path_of(table, trees);
    return culture_open(
        c, r, &(CultureFiles){.buildings = all, .trees = table, .frame = &frame, .ground = hill, .half_m = 16000});
}

/* Longitude and latitude of a place on the hill, in degrees, by ECEF. */
static inline void degrees_of(double out[2], double x_m, double y_m)
{
    double       p_ecef[3];
    Geodetic     g;
    const double z_m = hill(NULL, x_m, y_m);
    ecef_from_enu(p_ecef, &frame, (const double[3]){x_m, y_m, isnan(z_m) ? 300 : z_m});
    CHECK(geodetic_from_ecef(&g, p_ecef) == STATUS_OK);
    out[0] = g.lon_rad / rad_per_deg, out[1] = g.lat_rad / rad_per_deg;
}

static char text[1 << 16];
static int  used;

static inline void add(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    used += vsnprintf(text + used, sizeof text - (size_t)used, format, arguments);
    va_end(arguments);
    CHECK(used < (int)sizeof text);
}

static inline void begin_file(void)
{
    used = 0;
    add("{\"type\":\"FeatureCollection\",\"features\":[\n");
}

static inline void add_feature(const char *type, const char *opens, const char *closes, const char *properties,
                               const double (*p)[2], int count)
{
    add("%s{\"type\":\"Feature\",\"properties\":{%s},\"geometry\":{\"type\":\"%s\",\"coordinates\":%s",
        used > 50 ? ",\n" : "", properties, type, opens);
    for (int k = 0; k < count; k++) {
        double deg[2];
        degrees_of(deg, p[k][0], p[k][1]);
        add("%s[%.12f,%.12f]", k ? "," : "", deg[0], deg[1]);
    }
    add("%s}}", closes);
}

static inline void end_file(const char *name)
{
    add("\n]}\n");
    save(name, text);
}

#endif
