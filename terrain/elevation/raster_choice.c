/* terrain/elevation/raster_choice.c: reads the options that a user puts behind the name of a raster: band, unit, no
 * data, reference system. */
#include "terrain/elevation/raster.h"

#include <strings.h>
#include <sys/stat.h>

double raster_unit_m(const char *name)
{
    static const struct {
        const char *name;
        double      metres;
    } units[] = {{"m", 1},
                 {"metre", 1},
                 {"metres", 1},
                 {"meter", 1},
                 {"meters", 1},
                 {"dm", 0.1},
                 {"decimetre", 0.1},
                 {"decimeter", 0.1},
                 {"cm", 0.01},
                 {"centimetre", 0.01},
                 {"centimeter", 0.01},
                 {"mm", 0.001},
                 {"millimetre", 0.001},
                 {"millimeter", 0.001},
                 {"km", 1000},
                 {"kilometre", 1000},
                 {"kilometer", 1000},
                 {"ft", 0.3048},
                 {"foot", 0.3048},
                 {"feet", 0.3048},
                 {"international foot", 0.3048},
                 {"us-ft", 1200.0 / 3937},
                 {"ftUS", 1200.0 / 3937},
                 {"US survey foot", 1200.0 / 3937},
                 {"US_survey_foot", 1200.0 / 3937},
                 {"foot_us", 1200.0 / 3937},
                 {"yd", 0.9144},
                 {"yard", 0.9144},
                 {"fathom", 1.8288}};
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (strcasecmp(name, units[i].name) == 0) return units[i].metres;
    return 0;
}

static bool is_there(const char *path)
{
    struct stat about;
    return stat(path, &about) == 0;
}

/* Whether it is AUTHORITY:CODE or AUTHORITY:CODE+CODE. Nothing else is passed to PROJ, which might open a file or ask a
 * server. */
static bool is_srs(const char *text)
{
    const size_t word = strspn(text, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz");
    if (word == 0 || text[word] != ':') return false;
    const char  *code = text + word + 1;
    const size_t digits = strspn(code, "0123456789");
    if (digits == 0 || code[digits] == 0) return digits > 0;
    const size_t more = strspn(code + digits + 1, "0123456789");
    return code[digits] == '+' && more > 0 && code[digits + 1 + more] == 0;
}

static bool take_one(RasterChoice *c, const char **why, const char *text)
{
    if (strcmp(text, "geoid") == 0) c->vertical = RASTER_VERTICAL_GEOID;
    else if (strcmp(text, "ellipsoid") == 0) c->vertical = RASTER_VERTICAL_ELLIPSOID;
    else if (strcmp(text, "down") == 0) c->sense = -1;
    else if (strcmp(text, "up") == 0) c->sense = 1;
    else if (strcmp(text, "nodata=none") == 0) c->no_void = true;
    else if (strncmp(text, "nodata=", 7) == 0) {
        c->has_void = text_to_double(&c->void_value, text + 7);
        *why = "nodata= needs a number, or `none`";
        return c->has_void;
    } else if (strncmp(text, "srs=", 4) == 0) {
        *why = "srs= needs a coordinate system by its number: EPSG:32633, or EPSG:32633+5773 with heights";
        return is_srs(text + 4) && snprintf(c->srs, sizeof c->srs, "%s", text + 4) < (int)sizeof c->srs;
    } else if (strncmp(text, "part=", 5) == 0) {
        *why = "part= needs the name of a grid in the file, of at most 63 octets";
        return text[5] && snprintf(c->part, sizeof c->part, "%s", text + 5) < (int)sizeof c->part;
    } else if (strlen(text) < sizeof c->unit && raster_unit_m(text) > 0) strcpy(c->unit, text);
    else {
        *why =
            "after @ there is geoid, ellipsoid, a unit (m, dm, cm, ft, us-ft), up, down, nodata=N, nodata=none, srs=EPSG:N or part=NAME";
        return false;
    }
    return true;
}

bool raster_choice_add(RasterChoice *to, const char *text)
{
    RasterChoice c = *to;
    const char  *why;
    const bool   good = take_one(&c, &why, text);
    if (good) *to = c;
    return good;
}

/* Takes `:N` off the end of a path where what remains is a file. */
static bool is_there_with_band(int *band, char *path)
{
    char     *colon = strrchr(path, ':');
    long long number;
    if (is_there(path)) return true;
    if (!colon || !text_to_long(&number, colon + 1) || number < 1 || number > 65535) return false;
    *colon = 0;
    if (is_there(path)) *band = (int)number;
    else *colon = ':';
    return *colon == 0;
}

bool raster_choice_take(RasterChoice *out, const char **why, char *path)
{
    RasterChoice c = {0};
    char        *end = NULL; /* where the file's name ends */
    *out = c;
    if (is_there_with_band(&out->band, path)) return true;
    for (char *at = strchr(path, '@'); at && !end; at = strchr(at + 1, '@')) {
        *at = 0;
        if (is_there_with_band(&c.band, path)) end = at;
        else *at = '@';
    }
    bool good = true;
    for (char *at = end; at && good;) {
        char *next = strchr(at + 1, '@');
        if (next) *next = 0;
        good = take_one(&c, why, at + 1);
        at = next;
    }
    for (char *at = end ? NULL : strrchr(path, '@'); at && take_one(&c, why, at + 1); at = strrchr(path, '@'))
        *at = 0; /* this is not a file's name but one of GDAL's own, such as a subdataset's */
    *out = c;
    return good;
}

bool raster_choice_write(char *out, size_t out_size, const char *name, const RasterChoice *all)
{
    RasterChoice own;
    const char  *why;
    char         bare[4096], number[40];
    if (snprintf(bare, sizeof bare, "%s", name) >= (int)sizeof bare) return false;
    (void)raster_choice_take(&own, &why, bare); /* errors in it are reported when the file is opened */
    const bool unit = *all->unit && !*own.unit, srs = *all->srs && !*own.srs;
    const bool own_void = own.has_void || own.no_void;
    snprintf(number, sizeof number, "%.17g", all->void_value);
    return snprintf(out, out_size, "%s%s%s%s%s%s%s%s", name, unit ? "@" : "", unit ? all->unit : "", srs ? "@srs=" : "",
                    srs ? all->srs : "", all->has_void && !own_void ? "@nodata=" : "",
                    all->has_void && !own_void ? number : "",
                    all->no_void && !own_void ? "@nodata=none" : "") < (int)out_size;
}
