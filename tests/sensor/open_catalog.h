/* tests/sensor/open_catalog.h: the catalog of etc, open for all tests of a file: cmocka's set-up and tear-down. */
#ifndef TESTS_SENSOR_OPEN_CATALOG_H
#define TESTS_SENSOR_OPEN_CATALOG_H

#include "entities/catalog/catalog.h"

static Catalog *catalog;

static int open_catalog(void **state)
{
    (void)state;
    char path[512];
    return etc_path(path, sizeof path, "catalog.csv") && catalog_open(&catalog, path, 0.05) == STATUS_OK ? 0 : -1;
}

static int close_catalog(void **state)
{
    (void)state;
    catalog_close(catalog);
    return 0;
}

#endif
