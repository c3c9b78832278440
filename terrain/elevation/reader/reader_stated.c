/* terrain/elevation/reader/reader_stated.c: type, unit, direction and coordinate system of a band, as its file has them. */
#include "terrain/elevation/reader/reader_private.h"

#include <gdal.h>
#include <ogr_srs_api.h>
#include <strings.h>

static void say(char *to, size_t size, const char *text) { snprintf(to, size, "%s", text ? text : ""); }

static bool axis_is_down(OGRSpatialReferenceH crs, const char *part, int axis)
{
    OGRAxisOrientation way = OAO_Other;
    OSRGetAxis(crs, part, axis, &way);
    return way == OAO_Down;
}

static void state_crs(RasterStated *s, OGRSpatialReferenceH crs)
{
    char        *unit = NULL;
    const char  *part = OSRIsCompound(crs) ? "COMPD_CS|VERT_CS" : "VERT_CS";
    const char  *vertical = OSRGetAttrValue(crs, part, 0);
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

void reader_state(RasterStated *out, void *file, int number, void *crs)
{
    RasterStated          s = {0};
    const GDALRasterBandH band = GDALGetRasterBand(file, number);
    const GDALDataType    type = GDALGetRasterDataType(band);
    const GDALColorInterp colour = GDALGetRasterColorInterpretation(band);
    int                   has_nodata = 0, has_scale = 0;
    say(s.type, sizeof s.type, GDALGetDataTypeName(type));
    say(s.unit, sizeof s.unit, GDALGetRasterUnitType(band));
    s.nodata     = GDALGetRasterNoDataValue(band, &has_nodata);
    s.has_nodata = has_nodata != 0;
    if (!s.has_nodata) s.nodata = 0;
    s.down     = grows_down(band);
    s.coloured = colour == GCI_PaletteIndex || (colour >= GCI_RedBand && colour <= GCI_LightnessBand && colour != GCI_AlphaBand);
    const double scale = GDALGetRasterScale(band, &has_scale);
    state_crs(&s, crs);
    s.grey = type == GDT_Byte && !s.coloured && !*s.unit && !*s.vertical && !(has_scale && scale != 1);
    *out = s;
}
