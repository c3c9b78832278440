/* tests/terrain/buildings_lab.h: a folder, and records read as a node reads them. */
#ifndef TESTS_TERRAIN_BUILDINGS_LAB_H
#define TESTS_TERRAIN_BUILDINGS_LAB_H

#include "tests/check.h"

#include "terrain/from_files/culture_import.h"
#include "terrain/import/terrain_import.h"

#include <unistd.h>

static char folder[temp_path_size];

static inline int set_up(void **state)
{
    (void)state;
    strcpy(folder, "/tmp/pitviper-buildings-XXXXXX");
    return mkdtemp(folder) ? 0 : 1;
}

static inline int tear_down(void **state)
{
    (void)state;
    char line[temp_path_size + 16];
    snprintf(line, sizeof line, "rm -rf %s", folder);
    return system(line);
}

static inline void path_of(char out[temp_name_size], const char *name)
{
    snprintf(out, temp_name_size, "%s/%s", folder, name);
}

static inline double ground_of(void *user, double x_m, double y_m)
{
    return elevation_height(&((const TerrainStore *)user)->elevation, x_m, y_m, NULL);
}

static inline Culture read_back(CultureReport *report, const char *path, const TerrainStore *store)
{
    const CultureFiles from = {
        .buildings = path, .frame = &store->frame, .ground = ground_of, .user = (void *)store, .half_m = 30000};
    Culture culture = {0};
    assert_int_equal(culture_open(&culture, report, &from), STATUS_OK);
    return culture;
}

#endif
