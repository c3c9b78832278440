/* terrain/elevation/reader/reader_sheet.c: what one file is: its grid and coordinate system, and type, unit and
 * direction of a band, as the file has them or the user names them. */
#include "terrain/elevation/reader/reader_private.h"

#include <strings.h>

/* most_side: sheets lie within 1e8 px of the first, so that sums stay in an int */
enum { path_size = wire_path_size, most_side = 100000000 };

/* ---- what it says of a band ------------------------------------------------------------------ */

static void say(char *to, size_t size, const char *text) { snprintf(to, size, "%s", text ? text : ""); }

static bool axis_is_down(OGRSpatialReferenceH crs, const char *part, int axis)
{
    OGRAxisOrientation way = OAO_Other;
    OSRGetAxis(crs, part, axis, &way);
    return way == OAO_Down;
}

static void state_crs(RasterStated *s, OGRSpatialReferenceH crs)
{
    char       *unit = NULL;
    const char *part = OSRIsCompound(crs) ? "COMPD_CS|VERT_CS" : "VERT_CS";
    const char *vertical = OSRGetAttrValue(crs, part, 0);
    say(s->crs, sizeof s->crs, OSRGetName(crs));
    if (OSRIsProjected(crs)) {
        s->crs_unit_m = OSRGetLinearUnits(crs, &unit);
        say(s->crs_unit, sizeof s->crs_unit, unit);
    }
    if (!vertical) vertical = OSRGetAttrValue(crs, "VERT_CS", 0);
    say(s->vertical, sizeof s->vertical, vertical);
    if (vertical && !*s->unit) {
        unit = NULL;
        if (OSRGetTargetLinearUnits(crs, "VERT_CS", &unit) > 0) say(s->unit, sizeof s->unit, unit);
        s->unit_of_crs = *s->unit != 0;
    }
    s->down |= vertical ? axis_is_down(crs, "VERT_CS", 0) : OSRGetAxesCount(crs) == 3 && axis_is_down(crs, NULL, 2);
}

/* A NetCDF file says `positive: down` of a depth. */
static bool grows_down(GDALRasterBandH band)
{
    const char *positive = GDALGetMetadataItem(band, "positive", NULL);
    return positive && strcasecmp(positive, "down") == 0;
}

static void state(RasterStated *out, void *file, int number, void *crs)
{
    RasterStated          s = {0};
    const GDALRasterBandH band = GDALGetRasterBand(file, number);
    const GDALDataType    type = GDALGetRasterDataType(band);
    const GDALColorInterp colour = GDALGetRasterColorInterpretation(band);
    int                   has_nodata = 0, has_scale = 0;
    say(s.type, sizeof s.type, GDALGetDataTypeName(type));
    say(s.unit, sizeof s.unit, GDALGetRasterUnitType(band));
    s.nodata = GDALGetRasterNoDataValue(band, &has_nodata);
    s.has_nodata = has_nodata != 0;
    if (!s.has_nodata) s.nodata = 0;
    s.down = grows_down(band);
    s.coloured =
        colour == GCI_PaletteIndex || (colour >= GCI_RedBand && colour <= GCI_LightnessBand && colour != GCI_AlphaBand);
    const double scale = GDALGetRasterScale(band, &has_scale);
    state_crs(&s, crs);
    s.grey = type == GDT_Byte && !s.coloured && !*s.unit && !*s.vertical && !(has_scale && scale != 1);
    *out = s;
}

/* ---- the sheet ------------------------------------------------------------------------------ */

/* The coordinate system that the user names, or else the file's; NULL, logged: there is none. */
static OGRSpatialReferenceH crs_of(const RasterChoice *choice, GDALDatasetH file, const char *path, const char *key)
{
    const OGRSpatialReferenceH stated = GDALGetSpatialRef(file);
    if (!*choice->srs) {
        if (!stated)
            log_error(
                "%s: %s does not say its coordinate system; %s@srs=EPSG:nnnn does (or gdal_edit.py -a_srs EPSG:nnnn)",
                key, path, path);
        return stated ? OSRClone(stated) : NULL;
    }
    OGRSpatialReferenceH named = OSRNewSpatialReference(NULL);
    if (named && OSRSetFromUserInput(named, choice->srs) == OGRERR_NONE) return named;
    log_error("%s: %s: '%s' is no coordinate system that PROJ knows: %s; EPSG:32633 is one", key, path, choice->srs,
              reader_reason("unknown"));
    if (named) OSRDestroySpatialReference(named);
    return NULL;
}

/* Whether a file says where its pixels are. GDAL gives one that does not the corner (0, 0) and pixels of 1. */
static bool is_placed(double transform[6], GDALDatasetH file)
{
    static const double nothing[6] = {0, 1, 0, 0, 0, 1};
    double              inverse[6], mirrored[6];
    if (GDALGetGeoTransform(file, transform) != CE_None || !GDALInvGeoTransform(transform, inverse)) return false;
    memcpy(mirrored, transform, sizeof mirrored);
    mirrored[5] = fabs(mirrored[5]);
    return memcmp(mirrored, nothing, sizeof nothing) != 0;
}

/* GDAL's name of a grid in a file, `NETCDF:"a.nc":height`, and its own, `height`; NULL: this line of the list names
 * none. */
static const char *part_of(const char **own, const char *line)
{
    const char *name = strstr(line, "_NAME=");
    if (!name) return NULL;
    const char *colon = strrchr(name, ':');
    *own = colon ? colon + 1 : name + 6;
    return name + 6;
}

bool reader_choose_part(char path[path_size], GDALDatasetH file, const char *asked, const char *key)
{
    char      **part = GDALGetMetadata(file, "SUBDATASETS");
    char        names[400] = "";
    const char *own;
    for (int k = 0; part && part[k]; k++) {
        const char *name = part_of(&own, part[k]);
        if (!name) continue;
        if (strcmp(own, asked) == 0 && strlen(name) < path_size) {
            strcpy(path, name);
            return true;
        }
        const size_t used = strlen(names);
        snprintf(names + used, sizeof names - used, "%s%s", used ? ", " : "", own);
    }
    log_error("%s: %s holds several grids, %s: %s; choose one: %s@part=NAME", key, path,
              *asked ? "but none that is called so" : "and none is chosen", *names ? names : "none that can be named",
              path);
    return false;
}

Status reader_describe(SheetOpened *out, GDALDatasetH file, const RasterChoice *choice, const char *path,
                       const char *key)
{
    SheetOpened o = {.width = GDALGetRasterXSize(file),
                     .height = GDALGetRasterYSize(file),
                     .bands = GDALGetRasterCount(file),
                     .choice = *choice};
    if (o.bands < 1 || o.width < 2 || o.height < 2) {
        log_error("%s: %s holds %d bands of %d x %d pixels; a sheet needs a band and 2 x 2", key, path, o.bands,
                  o.width, o.height);
        return STATUS_BAD_VALUE;
    }
    if (o.width > most_side || o.height > most_side) {
        log_error("%s: %s has %d x %d pixels, more than %d a side; gdal_translate -srcwin cuts out what is needed", key,
                  path, o.width, o.height, (int)most_side);
        return STATUS_BAD_VALUE;
    }
    if (choice->band > o.bands) {
        log_error("%s: %s has %d bands, not %d; gdalinfo %s lists them", key, path, o.bands, choice->band, path);
        return STATUS_BAD_VALUE;
    }
    if (!is_placed(o.transform, file)) {
        log_error("%s: %s does not say where its corners are; gdal_translate -a_ullr W N E S %s OUT.tif", key, path,
                  path);
        return STATUS_BAD_VALUE;
    }
    o.crs = crs_of(choice, file, path, key);
    if (!o.crs) return STATUS_BAD_VALUE;
    const int             number = choice->band ? choice->band : 1;
    const GDALRasterBandH band = GDALGetRasterBand(file, number);
    state(&o.stated, file, number, o.crs);
    o.ellipsoidal = !OSRIsCompound(o.crs) && OSRGetAxesCount(o.crs) == 3;
    o.bytes = GDALGetRasterDataType(band) == GDT_Byte;
    o.whole = GDALDataTypeIsInteger(GDALGetRasterDataType(band));
    int block_x = 0, block_y = 0;
    GDALGetBlockSize(band, &block_x, &block_y);
    for (o.row_block = 64; o.row_block < block_y && o.row_block < 1024;) o.row_block *= 2;
    const double unit_m = raster_unit_m(*choice->unit ? choice->unit : o.stated.unit);
    const bool   down = choice->sense ? choice->sense < 0 : o.stated.down;
    o.metres_per_unit = (unit_m > 0 ? unit_m : 1) * (down ? -1 : 1);
    OSRStripVertical(o.crs);
    OSRDemoteTo2D(o.crs, NULL);
    OSRSetAxisMappingStrategy(o.crs, OAMS_TRADITIONAL_GIS_ORDER);
    *out = o;
    return STATUS_OK;
}
