/* entities/catalog/catalog_private.h: the catalog's rows and models, for the files of this folder. */
#ifndef ENTITIES_CATALOG_CATALOG_PRIVATE_H
#define ENTITIES_CATALOG_CATALOG_PRIVATE_H

#include "entities/catalog/catalog.h"

#include <pthread.h>
#include <stdatomic.h>

enum { catalog_type_fields = 7, catalog_any = -1 };

typedef struct CatalogRow {
    int       field[catalog_type_fields]; /* catalog_any: a star */
    int       length;                     /* fields up to and including the last one named */
    int       named;                      /* fields that are not a star */
    int       order;                      /* its place in the file */
    int       model;
    Origin    origin;
    bool      own; /* from the user's catalog, which takes precedence */
    int       line;
    ModelSize size; /* size in the row, which for a model from a file is the expected size */
    char     *note; /* may be NULL */
} CatalogRow;

/* A model of the catalog. A built-in shape is built coarsely when the catalog is opened, once for all sizes of it:
 * nodes and parts, with their materials and heat, depend on neither size nor facets. With fine facets and in its size
 * it is built at the first look-up of one of its types: an exercise uses some ten of two hundred models. */
typedef struct CatalogModel {
    char            *source;    /* its built-in name, or its file's path */
    ModelSize        size;      /* size asked for; zeroes: the shape's own */
    int              shape;     /* index of the model with the same shape whose `first` is used */
    int              same_name; /* index of the first model of the same name */
    ModelImport     *import;    /* of a model from a file; else NULL */
    Model            first;     /* set where shape is the own index: a coarse build, or the model from a file */
    _Atomic(Model *) fine;      /* fine build; NULL: not asked for yet, or from a file */
    atomic_bool      failed;    /* there was no memory for the fine build */
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
