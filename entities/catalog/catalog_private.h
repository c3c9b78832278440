/* entities/catalog/catalog_private.h: the catalog's rows and models, for the files of this folder. */
#ifndef ENTITIES_CATALOG_CATALOG_PRIVATE_H
#define ENTITIES_CATALOG_CATALOG_PRIVATE_H

#include "entities/catalog/catalog.h"

#include <pthread.h>
#include <stdatomic.h>

enum { catalog_type_fields = 7, catalog_any = -1 };

typedef struct CatalogRow {
    int       field[catalog_type_fields]; /* catalog_any: a star */
    int       length;                     /* fields up to the last one named */
    int       named;                      /* fields that are not a star */
    int       order;                      /* in the file */
    int       model;
    Origin    origin;
    bool      own; /* of the user's catalog, which takes precedence */
    int       line;
    ModelSize size; /* from the row; of a file: its expected size */
    char     *note; /* may be NULL */
} CatalogRow;

/* A model of the catalog. A built-in shape is built coarsely when the catalog is opened, once for all sizes of it:
 * nodes and parts, with their materials and heat, depend on neither size nor facets. With fine facets and in its size
 * it is built at the first look-up of one of its types: an exercise uses some ten of two hundred models. */
typedef struct CatalogModel {
    char            *source;    /* its built-in name, or its file */
    ModelSize        size;      /* zeroes: its own */
    int              shape;     /* index of the entry of which this is another size: `first` */
    int              same_name; /* index of the first of the same name */
    ModelImport     *import;    /* of a file, else NULL */
    Model            first;     /* of shape == own index alone: coarse, or of a file */
    _Atomic(Model *) fine;      /* NULL: not asked for yet, or of a file */
    atomic_bool      failed;    /* no memory when it was asked for */
} CatalogModel;

struct Catalog {
    int              row_count, model_count;
    char            *own_path, *path;
    CatalogRow      *row;
    CatalogModel    *model; /* model[0]: unknown */
    double           sag_m;
    pthread_mutex_t *building;
};

/* Reports a model from a file whose size differs from the size in its row. Where the row has none it is compared with
 * the program's own row for such types. */
void catalog_warn_sizes(const Catalog *catalog);

#endif
