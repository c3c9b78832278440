/* terrain/elevation/reader/reader_vector.c: features of files with vectors, one after the other: their points, lines
 * and polygons as longitudes and latitudes, and their attributes as texts. */
#include "terrain/elevation/reader/reader_private.h"

#include <ogr_api.h>
#include <stdlib.h>
#include <strings.h>
#include <sys/stat.h>

enum { most_files = 256, most_layers = 1024, most_depth = 8, most_name = 64, most_value = 255, most_hstore = 16384 };

/* Formats that neither name other files nor write: what else GDAL reads is refused by name. */
static const char *const drivers[] = {"GeoJSON", "GeoJSONSeq", "ESRI Shapefile", "GPKG", "FlatGeobuf", NULL};

typedef struct VectorFile {
    GDALDatasetH         file;
    char                *path;
    OGRSpatialReferenceH crs; /* named by the user; NULL: that of each layer */
    int                  layers;
} VectorFile;

static VectorFile           vector[most_files];
static int                  vectors;
static OGRSpatialReferenceH earth;

/* What is read at the moment. */
static struct {
    int                          file, layer; /* the next ones */
    OGRLayerH                    from;        /* NULL: none yet, or all are done */
    OGRCoordinateTransformationH earth_from_crs;
    OGRFeatureH                  feature; /* whose parts are being sent; NULL: none */
    int                          of_file;
    int                          part;        /* the next */
    GIntBig                      all, passed; /* features of the layer, -1: not known; those that were got of it */
    WireEnd                      end;
} at;

/* ---- opening -------------------------------------------------------------------------------------- */

/* GDAL takes many names for more than a file's: an address, a database, a text that is itself the data. */
static bool is_a_file(const char *path, const char *key)
{
    struct stat about;
    const bool  archive = strncmp(path, "/vsizip/", 8) == 0 || strncmp(path, "/vsigzip/", 9) == 0;
    const char *foreign = reader_foreign(path);
    if (foreign) log_error("%s: cannot read %s: %s", key, path, foreign);
    else if (!archive && stat(path, &about) != 0)
        log_error("%s: cannot read %s: there is no such file; files with vectors are local ones", key, path);
    else if (!archive && !S_ISREG(about.st_mode))
        log_error("%s: cannot read %s: it is no file; name the files in it (a Shapefile by its .shp)", key, path);
    else return reader_file_allowed(path, key);
    return false;
}

static bool named_crs(VectorFile *f, const RasterChoice *choice, const char *key)
{
    if (!*choice->srs) return true;
    f->crs = OSRNewSpatialReference(NULL);
    if (f->crs && OSRSetFromUserInput(f->crs, choice->srs) == OGRERR_NONE) {
        OSRSetAxisMappingStrategy(f->crs, OAMS_TRADITIONAL_GIS_ORDER);
        return true;
    }
    log_error("%s: %s: '%s' is no coordinate system that PROJ knows: %s; EPSG:32633 is one", key, f->path, choice->srs,
              reader_reason("unknown"));
    return false;
}

/* Transformation from a layer's coordinate system; NULL, logged: it has none. */
static OGRCoordinateTransformationH to_earth(const VectorFile *f, OGRLayerH layer, const char *key)
{
    OGRSpatialReferenceH crs = f->crs ? f->crs : OGR_L_GetSpatialRef(layer);
    if (!crs) {
        log_error("%s: %s does not say its coordinate system; %s@srs=EPSG:nnnn does (or ogr2ogr -a_srs EPSG:nnnn)", key,
                  f->path, f->path);
        return NULL;
    }
    OGRCoordinateTransformationH by = OCTNewCoordinateTransformation(crs, earth);
    if (!by)
        log_error("%s: no way from the coordinate system of %s to WGS 84: %s; ogr2ogr -t_srs EPSG:4326 OUT.gpkg %s",
                  key, f->path, reader_reason("unknown to PROJ"), f->path);
    return by;
}

/* In place, to degrees; NaN where there is no such place. */
static void to_degrees(OGRCoordinateTransformationH by, int count, double *x, double *y)
{
    OCTTransform(by, count, x, y, NULL);
    for (int k = 0; k < count; k++)
        if (!isfinite(x[k]) || !isfinite(y[k]) || fabs(y[k]) > 90 || fabs(x[k]) > 1e4) x[k] = y[k] = NAN;
}

/* Adds a layer's extent to the box. */
static void add_extent(WireBox *box, OGRLayerH layer, OGRCoordinateTransformationH by)
{
    OGREnvelope e;
    if (OGR_L_GetExtent(layer, &e, 1) != OGRERR_NONE) return;
    double x[4] = {e.MinX, e.MaxX, e.MinX, e.MaxX}, y[4] = {e.MinY, e.MinY, e.MaxY, e.MaxY};
    to_degrees(by, 4, x, y);
    for (int k = 0; k < 4; k++) {
        if (isnan(x[k])) continue;
        box->deg[0] = fmin(box->deg[0], x[k]), box->deg[1] = fmin(box->deg[1], y[k]);
        box->deg[2] = fmax(box->deg[2], x[k]), box->deg[3] = fmax(box->deg[3], y[k]);
    }
}

static Status open_one(WireVectors *out, char *path, const char *key)
{
    RasterChoice choice;
    const char  *why = NULL;
    VectorFile   f = {0};
    if (!raster_choice_take(&choice, &why, path)) {
        log_error("%s: %s: %s", key, path, why);
        return STATUS_BAD_VALUE;
    }
    if (!is_a_file(path, key)) return STATUS_IO;
    reader_works_at(path);
    f.path = strdup(path);
    if (!f.path) return STATUS_NO_MEMORY;
    f.file = GDALOpenEx(path, GDAL_OF_VECTOR | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR, drivers, NULL, NULL);
    vector[vectors++] = f;
    if (!f.file) {
        log_error("%s: cannot read %s: %s; GeoJSON, Shapefile, GeoPackage and FlatGeobuf are read: ogr2ogr OUT.gpkg %s "
                  "makes a GeoPackage",
                  key, path, reader_reason("it is of no format with vectors that is read"), path);
        return STATUS_IO;
    }
    VectorFile *kept = &vector[vectors - 1];
    if (!named_crs(kept, &choice, key)) return STATUS_BAD_VALUE;
    kept->layers = GDALDatasetGetLayerCount(f.file);
    if (kept->layers > most_layers) {
        log_error("%s: %s has %d layers, more than %d; `ogr2ogr OUT.gpkg %s LAYER ...` takes those that are needed",
                  key, path, kept->layers, (int)most_layers, path);
        return STATUS_BAD_VALUE;
    }
    out->files++;
    for (int k = 0; k < kept->layers; k++) {
        OGRLayerH layer = GDALDatasetGetLayer(f.file, k);
        if (!layer || (OGR_L_GetFeatureCount(layer, 0) == 0 && !OGR_L_GetSpatialRef(layer))) continue;
        OGRCoordinateTransformationH by = to_earth(kept, layer, key);
        if (!by) return STATUS_BAD_VALUE;
        reader_works_at(path);
        add_extent(&out->box, layer, by);
        OCTDestroyCoordinateTransformation(by);
        out->layers++;
    }
    return STATUS_OK;
}

Status reader_vectors_open(WireVectors *out, const char *paths, const char *key)
{
    WireVectors found = {.box = {{INFINITY, INFINITY, -INFINITY, -INFINITY}}};
    Status      status = STATUS_OK;
    char        path[wire_path_size];
    bool        too_long = false;
    reader_quiet();
    earth = OSRNewSpatialReference(NULL);
    if (!earth || OSRImportFromEPSG(earth, 4326) != OGRERR_NONE) status = STATUS_NO_MEMORY;
    if (status == STATUS_OK) OSRSetAxisMappingStrategy(earth, OAMS_TRADITIONAL_GIS_ORDER);
    for (const char *next = paths; status == STATUS_OK && reader_next_name(path, &next, &too_long);) {
        if (vectors < most_files) {
            status = open_one(&found, path, key);
            continue;
        }
        log_error("%s: more than %d files; ogr2ogr -append puts them into one GeoPackage", key, (int)most_files);
        status = STATUS_BAD_VALUE;
    }
    if (status == STATUS_OK && (too_long || found.files == 0)) {
        log_error("%s: %s", key, too_long ? "the name of a file is too long" : "names no file");
        status = STATUS_BAD_VALUE;
    }
    reader_loud();
    if (!(found.box.deg[0] <= found.box.deg[2]))
        for (int k = 0; k < 4; k++) found.box.deg[k] = NAN;
    if (status == STATUS_OK) *out = found;
    return status;
}

/* ---- layers ---------------------------------------------------------------------------------------- */

/* Limits a layer to what reaches into a box, by the box's outline in the layer's coordinates, and a little more. */
static void limit(OGRLayerH layer, OGRSpatialReferenceH crs, const WireBox *box)
{
    enum { side = 8, count = 4 * side };
    double x[count], y[count], low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int k = 0; k < 4; k++)
        if (!isfinite(box->deg[k])) return;
    OGRCoordinateTransformationH by = OCTNewCoordinateTransformation(earth, crs);
    if (!by) return;
    for (int edge = 0; edge < 4; edge++)
        for (int k = 0; k < side; k++) {
            const double along = (double)k / (side - 1);
            x[edge * side + k] =
                edge < 2 ? box->deg[0] + along * (box->deg[2] - box->deg[0]) : box->deg[edge == 2 ? 0 : 2];
            y[edge * side + k] = edge < 2 ? box->deg[edge ? 3 : 1] : box->deg[1] + along * (box->deg[3] - box->deg[1]);
        }
    OCTTransform(by, count, x, y, NULL);
    OCTDestroyCoordinateTransformation(by);
    bool whole = true;
    for (int k = 0; k < count; k++) {
        whole = whole && isfinite(x[k]) && isfinite(y[k]);
        low[0] = fmin(low[0], x[k]), high[0] = fmax(high[0], x[k]);
        low[1] = fmin(low[1], y[k]), high[1] = fmax(high[1], y[k]);
    }
    const double more = 0.05 * fmax(high[0] - low[0], high[1] - low[1]);
    if (whole && more > 0)
        OGR_L_SetSpatialFilterRect(layer, low[0] - more, low[1] - more, high[0] + more, high[1] + more);
}

static void leave_layer(void)
{
    if (at.all > at.passed) at.end.outside += at.all - at.passed;
    if (at.earth_from_crs) OCTDestroyCoordinateTransformation(at.earth_from_crs);
    at.earth_from_crs = NULL;
    at.from = NULL;
}

/* Goes on to the next layer; false: there is none. */
static bool next_layer(const WireBox *box, const char *key)
{
    for (; at.file < vectors; at.file++, at.layer = 0)
        while (at.layer < vector[at.file].layers) {
            const VectorFile *f = &vector[at.file];
            OGRLayerH         layer = GDALDatasetGetLayer(f->file, at.layer++);
            if (!layer || (OGR_L_GetFeatureCount(layer, 0) == 0 && !OGR_L_GetSpatialRef(layer))) continue;
            at.earth_from_crs = to_earth(f, layer, key);
            if (!at.earth_from_crs) continue;
            at.all = OGR_L_GetFeatureCount(layer, 0), at.passed = 0;
            limit(layer, f->crs ? f->crs : OGR_L_GetSpatialRef(layer), box);
            OGR_L_ResetReading(layer);
            at.from = layer, at.of_file = at.file;
            return true;
        }
    return false;
}

/* ---- features -------------------------------------------------------------------------------------- */

/* Where parts are written. */
typedef struct Batch {
    uint8_t *data;
    size_t   used;
    int32_t  count;
    int      part;  /* number of the part that is looked at */
    bool     full;  /* this one did not fit */
    bool     found; /* the feature has a point, line or polygon */
} Batch;

static size_t put_text(char *to, const char *text, size_t most)
{
    const size_t octets = strnlen(text, most);
    memcpy(to, text, octets);
    to[octets] = 0;
    return octets + 1;
}

static void say_cut(void)
{
    static bool said;
    if (!said)
        log_warn(
            "%s: a feature has more attributes than are read, %d: the others are ignored; `ogr2ogr -select NAME,...` "
            "keeps those that are needed",
            vector[at.of_file].path, (int)wire_most_tags);
    said = true;
}

/* Names and values of the attributes that are set, as many as fit. */
static size_t put_tags(char *to, int32_t *tags, OGRFeatureH feature)
{
    OGRFeatureDefnH of_layer = OGR_L_GetLayerDefn(at.from);
    const int       fields = OGR_FD_GetFieldCount(of_layer);
    size_t          used = 0;
    *tags = 0;
    for (int k = 0; k < fields; k++) {
        if (!OGR_F_IsFieldSetAndNotNull(feature, k)) continue;
        const char *name = OGR_Fld_GetNameRef(OGR_FD_GetFieldDefn(of_layer, k));
        const char *value = OGR_F_GetFieldAsString(feature, k);
        if (!name || !value || !*name || !*value) continue;
        const bool   several = strcasecmp(name, "other_tags") == 0 || strcasecmp(name, "tags") == 0;
        const size_t most = several ? most_hstore : most_value;
        if (*tags == wire_most_tags || used + most_name + most + 2 > wire_most_texts) {
            say_cut();
            break;
        }
        used += put_text(to + used, name, most_name);
        used += put_text(to + used, value, most);
        ++*tags;
    }
    return used;
}

/* Places of a curve, rad. */
static void put_places(double *place, OGRGeometryH curve, int first, int count)
{
    static double x[wire_most_corners], y[wire_most_corners];
    for (int k = 0; k < count; k++) {
        double z;
        OGR_G_GetPoint(curve, first + k, &x[k], &y[k], &z);
    }
    to_degrees(at.earth_from_crs, count, x, y);
    for (int k = 0; k < count; k++) place[2 * k] = x[k] * rad_per_deg, place[2 * k + 1] = y[k] * rad_per_deg;
}

/* Inner rings that are sent: as many as there is room for. */
typedef struct Inner {
    int          rings, corners;
    int32_t      count[wire_most_rings + 1];
    OGRGeometryH ring[wire_most_rings];
} Inner;

static void find_inner(Inner *out, OGRGeometryH polygon)
{
    out->rings = out->corners = 0;
    for (int k = 1; k < OGR_G_GetGeometryCount(polygon) && out->rings < wire_most_rings; k++) {
        OGRGeometryH ring = OGR_G_GetGeometryRef(polygon, k);
        const int    count = ring ? OGR_G_GetPointCount(ring) - 1 : 0; /* the last repeats the first */
        if (count < 3 || count > wire_most_corners - out->corners) continue;
        out->ring[out->rings] = ring, out->count[out->rings++] = count;
        out->corners += count;
    }
    out->count[out->rings] = 0;
}

/* Writes a part of corners first .. first + count - 1 of a curve; none when it does not fit. polygon: whose outer ring
 * the curve is; NULL: of none. */
static void put_part(Batch *b, WireShape shape, OGRGeometryH curve, int first, int count, OGRGeometryH polygon)
{
    static Inner inner;
    const int    number = b->part++;
    WireFeature  f = {.shape = (int32_t)shape,
                      .corners = count <= wire_most_corners ? count : 0,
                      .holes = polygon ? OGR_G_GetGeometryCount(polygon) - 1 : 0,
                      .file = at.of_file,
                      .part = number,
                      .number = at.end.features};
    if (b->full || number < at.part) return;
    b->found = true;
    inner.rings = inner.corners = 0;
    if (polygon && f.corners > 0) find_inner(&inner, polygon);
    f.rings = inner.rings, f.ring_corners = inner.corners;
    const size_t sizes = ((size_t)inner.rings * sizeof *inner.count + 7) / 8 * 8;
    const size_t places = 2 * sizeof(double) * (size_t)(f.corners + f.ring_corners) + sizes;
    if (wire_data_octets - b->used < sizeof f + places + wire_most_texts + 8) {
        b->full = true;
        return;
    }
    uint8_t *to = b->data + b->used;
    double  *place = (double *)(void *)(to + sizeof f);
    if (f.corners > 0) put_places(place, curve, first, f.corners);
    place += 2 * f.corners;
    for (int k = 0; k < inner.rings; place += 2 * inner.count[k++]) put_places(place, inner.ring[k], 0, inner.count[k]);
    if (sizes) memcpy(place, inner.count, sizes);
    const size_t texts = put_tags((char *)to + sizeof f + places, &f.tags, at.feature);
    f.texts = (int32_t)texts;
    f.octets = (uint32_t)(sizeof f + places + (texts + 7) / 8 * 8);
    memset(to + sizeof f + places + texts, 0, f.octets - sizeof f - places - texts);
    memcpy(to, &f, sizeof f);
    b->used += f.octets;
    b->count++;
    at.part = number + 1;
}

static void put_line(Batch *b, OGRGeometryH line)
{
    const int count = OGR_G_GetPointCount(line);
    for (int first = 0; first + 1 < count && !b->full; first += wire_most_corners - 1)
        put_part(b, WIRE_LINE, line, first, count - first < wire_most_corners ? count - first : wire_most_corners,
                 NULL);
}

static void put_geometry(Batch *b, OGRGeometryH g, int depth)
{
    if (!g || depth > most_depth || b->full) return;
    switch (OGR_GT_Flatten(OGR_G_GetGeometryType(g))) {
    case wkbPoint:
        if (OGR_G_GetPointCount(g) == 1) put_part(b, WIRE_POINT, g, 0, 1, NULL);
        return;
    case wkbLineString:
        put_line(b, g);
        return;
    case wkbPolygon:
    case wkbTriangle: {
        const int    rings = OGR_G_GetGeometryCount(g);
        OGRGeometryH outer = rings > 0 ? OGR_G_GetGeometryRef(g, 0) : NULL;
        const int    corners = outer ? OGR_G_GetPointCount(outer) : 0;
        if (corners > 3) put_part(b, WIRE_POLYGON, outer, 0, corners - 1, g); /* the last repeats the first */
        return;
    }
    case wkbMultiPoint:
    case wkbMultiLineString:
    case wkbMultiPolygon:
    case wkbGeometryCollection:
    case wkbPolyhedralSurface:
    case wkbTIN:
        for (int k = 0; k < OGR_G_GetGeometryCount(g) && !b->full; k++)
            put_geometry(b, OGR_G_GetGeometryRef(g, k), depth + 1);
        return;
    default:
        return;
    }
}

static void put_feature(Batch *b)
{
    OGRGeometryH g = OGR_F_GetGeometryRef(at.feature), straight = NULL;
    if (g && OGR_G_HasCurveGeometry(g, 0)) g = straight = OGR_G_GetLinearGeometry(g, 0, NULL);
    b->part = 0;
    b->found = at.part > 0;
    put_geometry(b, g, 0);
    if (straight) OGR_G_DestroyGeometry(straight);
}

Status reader_features(uint8_t *data, int32_t *count, const WireBox *box, const char *key)
{
    Batch b = {.data = data};
    reader_quiet();
    while (!b.full && (at.from || next_layer(box, key))) {
        if (!at.feature) {
            reader_works_at(vector[at.of_file].path);
            CPLErrorReset();
            at.feature = OGR_L_GetNextFeature(at.from);
            at.part = 0;
        }
        if (!at.feature) {
            if (CPLGetLastErrorType() >= CE_Failure)
                log_warn("%s: %s: read no further than feature %lld: %s; ogr2ogr OUT.gpkg %s says what of it is whole",
                         key, vector[at.of_file].path, (long long)at.end.features, reader_reason("it is damaged"),
                         vector[at.of_file].path);
            leave_layer();
            continue;
        }
        put_feature(&b);
        if (b.full) break;
        if (!b.found) at.end.shapeless++;
        at.end.features++, at.passed++;
        OGR_F_Destroy(at.feature);
        at.feature = NULL;
    }
    reader_loud();
    *count = b.count;
    if (b.count == 0) memcpy(data, &at.end, sizeof at.end);
    return STATUS_OK;
}
