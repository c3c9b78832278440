/* entities/catalog/catalog.h: maps an entity type to its model, from etc/catalog.csv by the longest match, and the
 * models themselves, one of each shape and size. Built-in ones are built at the first look-up of one of their types. */
#ifndef ENTITIES_CATALOG_CATALOG_H
#define ENTITIES_CATALOG_CATALOG_H

#include "dis/pdu/pdu.h"
#include "entities/catalog/model_size_private.h"
#include "entities/models/model.h"

/* What the sender's position refers to. */
typedef enum Origin { ORIGIN_BASE, ORIGIN_CENTRE } Origin;

typedef struct Catalog Catalog;

/* path: a CSV with the columns type, model, origin, and perhaps length_m, width_m, height_m (ModelSize; empty: in
 * proportion, all empty: the shape's own size; of a file: its expected size, with a warning when it differs)
 * and note; type is dotted with `*` as wildcard, e.g.
 * `1.1.225.1.*.*.*`, and stars at the end may be left out. Of the rows that agree with a type the one named deepest
 * wins (`1.1.*.1` before `1.1.225`: the category determines more of the shape than the country), then the one with
 * fewer stars, then the earlier. model: a built-in name, or a file (a dot or a slash in it; relative to the catalog's
 * folder), see entities/import/model_import.h; `none`: entities of the type are not rendered; `chaff`: to radar
 * alone a cloud of dipoles.
 * Rows of the user's own catalog (etc_own of catalog.csv) take precedence over all of these. Its
 * files are relative to its own folder.
 * A malformed row: STATUS_BAD_VALUE, file and line logged. sag_m: as
 * parametric_build. */
Status catalog_open(Catalog **out, const char *path, double sag_m);
/* One model for all entity types. name: a built-in name, or a file relative to the current folder. Rows of the user's
 * own catalog would still precede it. */
Status catalog_open_one(Catalog **out, int *model, const char *name, double sag_m);
void   catalog_close(Catalog *catalog);
/* The number of models: one for each shape and size; those of one shape have one name. */
int catalog_model_count(const Catalog *catalog);
/* False: entities of this model are received and tracked, but not rendered. */
bool catalog_has_shape(const Catalog *catalog, int model);
/* Whether a model is a cloud of chaff, which has no shape either: only the radar sees it. */
bool catalog_is_chaff(const Catalog *catalog, int model);
/* The first model of the same name: identifies a class of targets independent of size. */
int catalog_class(const Catalog *catalog, int model);
/* The model, after catalog_find has returned it. Before that, a coarse form of its shape in the shape's own size, whose
 * nodes and parts have the model's number, names, materials and heat. Both live as long as the catalog. */
const Model *catalog_model(const Catalog *catalog, int model);
/* Whether catalog_model returns the model itself. */
bool catalog_is_built(const Catalog *catalog, int model);
/* Length, width and height (ModelSize) that a model has, or will have once it is built. */
void catalog_size(double size_m[3], const Catalog *catalog, int model);
/* The range of sizes of the program's own rows of a kind and domain; < 0: of any. */
void catalog_size_range(SizeRange *out, const Catalog *catalog, int kind, int domain);

/* A row, in search order. */
typedef struct CatalogRowInfo {
    char        type[48];     /* 1.1.225.1.*.*.* */
    int         kind, domain; /* -1: any */
    int         model, line;
    bool        own;
    const char *path, *note, *source; /* source: the model's built-in name, or its file */
} CatalogRowInfo;
int  catalog_row_count(const Catalog *catalog);
void catalog_row(CatalogRowInfo *out, const Catalog *catalog, int row);

/* The model of a type. It never fails: an unmatched type gets the `unknown` model, number 0. matched (may be NULL): how
 * many leading fields of the type the row covers, up to the last it names; 0 for an unmatched type. The model is built
 * at the first call; without memory its coarse form stays, which is logged. Any number of threads may call it. */
int catalog_find(const Catalog *catalog, DisEntityType type, Origin *origin, int *matched);

#endif
