/* terrain/import/terrain_options.c: the options of an import, by name; as a text, and back. */
#include "terrain/import/terrain_import.h"

#include "terrain/elevation/raster.h"

#include <sys/stat.h>
#include <unistd.h>

typedef enum Kind { LIST, NUMBER, PAIR, SIZE, CHOICE, SAYS } Kind; /* SAYS: a text that raster.h reads after a name */

#define TEXT_AT(member) offsetof(TerrainOptions, member), sizeof(((TerrainOptions *)0)->member)

static const struct Row {
    const char *name;
    Kind        kind;
    size_t      offset, size;
    double      low, high, initial;
    const char *why;
} rows[] = {
    {"elevation", LIST, TEXT_AT(elevation), 0, 0, 0, "a list of files within 16 383 octets"},
    {"surface", LIST, TEXT_AT(surface), 0, 0, 0, "a list of files within 16 383 octets"},
    {"cover", LIST, TEXT_AT(cover), 0, 0, 0, "a list of files within 16 383 octets"},
    {"photo", LIST, TEXT_AT(photo), 0, 0, 0, "a list of files within 16 383 octets"},
    {"canopy-height", LIST, TEXT_AT(canopy_height), 0, 0, 0, "a file, or FILE:BAND"},
    {"canopy-cover", LIST, TEXT_AT(canopy_cover), 0, 0, 0, "a file, or FILE:BAND"},
    {"buildings", LIST, TEXT_AT(buildings), 0, 0, 0, "one file whose name ends in .geojson"},
    {"cover-table", LIST, TEXT_AT(cover_table), 0, 0, 0, "worldcover, nlcd, fbfm40, dynamicworld, corine, or a CSV"},
    {"geoid", LIST, TEXT_AT(geoid), 0, 0, 0, "a file in PROJ's .gtx form"},
    {"sources-from", LIST, TEXT_AT(sources_from), 0, 0, 0, "a list of folders"},
    {"vertical", CHOICE, TEXT_AT(vertical), 0, 0, ELEVATION_BY_FILE, "auto, geoid or ellipsoid"},
    {"unit", SAYS, TEXT_AT(unit), 0, 0, 0, "a unit of length: m, dm, cm, ft, us-ft"},
    {"srs", SAYS, TEXT_AT(srs), 0, 0, 0, "a coordinate system by its number: EPSG:32633, or EPSG:32633+5773"},
    {"nodata", SAYS, TEXT_AT(nodata), 0, 0, 0, "a number, or none"},
    {"spacing", NUMBER, TEXT_AT(spacing_m), 0.06, 1000, 0, "metres in 0.06 .. 1000"},
    {"origin", PAIR, TEXT_AT(origin_deg), -360, 360, NAN, "LAT,LON: degrees in -90 .. 90 and -360 .. 360"},
    {"size", SIZE, TEXT_AT(size_km), 0.01, 1000, 0, "KMxKM, east by north, each in 0.01 .. 1000"},
    {"horizon", NUMBER, TEXT_AT(horizon_km), 1, 400, 100, "kilometres in 1 .. 400"},
    {"most-gb", NUMBER, TEXT_AT(most_gb), 0.001, 1e6, 16, "gigabytes in 0.001 .. 1000000"},
};
enum { row_count = sizeof rows / sizeof *rows };

static const char *const verticals[] = {"auto", "geoid", "ellipsoid"};

void terrain_options_default(TerrainOptions *out)
{
    *out = (TerrainOptions){.origin_deg = {NAN, NAN}, .horizon_km = 100, .most_gb = 16};
}

/* Reads two numbers with a separator between them. */
static bool pair_of(double out[2], const char *text, char separator)
{
    char        first[64];
    const char *at = strchr(text, separator);
    if (!at || at - text >= (long)sizeof first) return false;
    memcpy(first, text, (size_t)(at - text));
    first[at - text] = 0;
    return text_to_double(&out[0], first) && text_to_double(&out[1], at + 1);
}

static bool take_list(char *to, size_t size, const char *value, bool add)
{
    const size_t have = add ? strlen(to) : 0, more = strlen(value);
    if (value[strspn(value, ", ")] == 0 || strpbrk(value, "\n\r") || have + more + 2 > size) return false;
    if (have > 0) to[have] = ',';
    memcpy(to + have + (have > 0), value, more + 1);
    return true;
}

/* A name that files of other kinds do not have: a store's options have it written. */
static bool is_one_geojson(const char *value)
{
    static const char ending[] = ".geojson";
    const size_t      length = strlen(value);
    return length >= sizeof ending && !strpbrk(value, ",@") && strcmp(value + length - strlen(ending), ending) == 0;
}

bool terrain_options_set(TerrainOptions *o, const char **why, const char *name, const char *value)
{
    for (int k = 0; k < row_count; k++) {
        const struct Row *row = &rows[k];
        char             *at = (char *)o + row->offset;
        double            number[2];
        if (strcmp(name, row->name) != 0) continue;
        *why = row->why;
        switch (row->kind) {
        case LIST:
            if (at == o->buildings && !is_one_geojson(value)) return false;
            return take_list(at, row->size, value, k < 4);
        case CHOICE:
            for (int v = 0; v < 3; v++)
                if (strcmp(value, verticals[v]) == 0) {
                    o->vertical = (ElevationVertical)v;
                    return true;
                }
            return false;
        case SAYS: {
            RasterChoice c = {0};
            char         text[160];
            const bool   bare = strcmp(name, "unit") == 0;
            if (snprintf(text, sizeof text, "%s%s%s", bare ? "" : name, bare ? "" : "=", value) >= (int)sizeof text ||
                strlen(value) >= row->size || (bare && !(raster_unit_m(value) > 0)) || !raster_choice_add(&c, text))
                return false;
            strcpy(at, value);
            return true;
        }
        case NUMBER:
            if (!text_to_double(number, value) || !(number[0] >= row->low && number[0] <= row->high)) return false;
            memcpy(at, number, sizeof *number);
            return true;
        case PAIR:
            if (!pair_of(number, value, ',') || !(fabs(number[0]) <= 90 && fabs(number[1]) <= row->high)) return false;
            break;
        case SIZE:
            if (!pair_of(number, value, 'x')) return false;
            for (int c = 0; c < 2; c++)
                if (!(number[c] >= row->low && number[c] <= row->high)) return false;
            break;
        }
        memcpy(at, number, sizeof number);
        return true;
    }
    *why = "no option of an import";
    return false;
}

const char *terrain_options_fault(const TerrainOptions *o)
{
    if (!*o->elevation && !*o->surface) return "names no elevation: give a terrain model, or --surface";
    if (*o->buildings && !*o->surface)
        return "names a file of buildings, which are found in surface models: give --surface";
    return NULL;
}

/* ---- as a text ------------------------------------------------------------------------------- */

/* The next name of a list, without the spaces around it. Returns false when none is left, or when it is too long (*at
 * is then not at the end). */
static bool next_name(char name[terrain_path_size], const char **at)
{
    for (; **at;) {
        const size_t length = strcspn(*at, ",");
        size_t       skip = strspn(*at, " "), end = length;
        if (skip > length) skip = length;
        while (end > skip && (*at)[end - 1] == ' ') end--;
        if (end - skip >= terrain_path_size) return false;
        memcpy(name, *at + skip, end - skip);
        name[end - skip] = 0;
        *at += length + ((*at)[length] == ',');
        if (*name) return true;
    }
    return false;
}

/* Makes names of files in a list absolute, whatever follows them; other names are GDAL's own and stay. */
static bool absolute_list(char *out, size_t size, const char *list)
{
    char        folder[terrain_path_size], name[terrain_path_size], bare[terrain_path_size];
    size_t      used = 0;
    const char *at = list;
    if (!getcwd(folder, sizeof folder)) return false;
    *out = 0;
    while (next_name(name, &at)) {
        struct stat  about;
        RasterChoice choice;
        const char  *why;
        memcpy(bare, name, sizeof bare);
        (void)raster_choice_take(&choice, &why, bare);
        const bool relative = stat(bare, &about) == 0 && *name != '/';
        const int  n = snprintf(out + used, size - used, "%s%s%s%s", used ? "," : "", relative ? folder : "",
                               relative ? "/" : "", name);
        if (n < 0 || (size_t)n >= size - used) return false;
        used += (size_t)n;
    }
    return *at == 0;
}

bool terrain_options_sources(char *out, size_t out_size, const TerrainOptions *o, const char *list)
{
    char         name[terrain_path_size], text[160];
    size_t       used = 0;
    RasterChoice all = {0};
    const char  *at = list;
    if (*o->unit) raster_choice_add(&all, o->unit);
    if (*o->srs && snprintf(text, sizeof text, "srs=%s", o->srs) > 0) raster_choice_add(&all, text);
    if (*o->nodata && snprintf(text, sizeof text, "nodata=%s", o->nodata) > 0) raster_choice_add(&all, text);
    *out = 0;
    while (next_name(name, &at)) {
        if (used > 0) {
            if (used + 1 >= out_size) return false;
            out[used++] = ',';
        }
        if (!raster_choice_write(out + used, out_size - used, name, &all)) return false;
        used += strlen(out + used);
    }
    return *at == 0;
}

bool terrain_options_text(char *out, size_t out_size, const TerrainOptions *o)
{
    size_t used = 0;
    *out = 0;
    for (int k = 0; k < row_count; k++) {
        const struct Row *row = &rows[k];
        const char       *at = (const char *)o + row->offset;
        char              value[terrain_paths_size] = "";
        double            number[2] = {0};
        switch (row->kind) {
        case LIST:
            if (strcmp(row->name, "cover-table") == 0 && !strpbrk(at, "./")) snprintf(value, sizeof value, "%s", at);
            else if (!absolute_list(value, sizeof value, at)) return false;
            break;
        case CHOICE:
            if (o->vertical != ELEVATION_BY_FILE) snprintf(value, sizeof value, "%s", verticals[o->vertical]);
            break;
        case SAYS:
            snprintf(value, sizeof value, "%s", at);
            break;
        case NUMBER:
            memcpy(number, at, sizeof *number);
            if (number[0] != row->initial) snprintf(value, sizeof value, "%.17g", number[0]);
            break;
        default:
            memcpy(number, at, sizeof number);
            if (row->kind == PAIR ? !isnan(number[0]) : number[0] != 0)
                snprintf(value, sizeof value, "%.17g%c%.17g", number[0], row->kind == PAIR ? ',' : 'x', number[1]);
            break;
        }
        if (!*value) continue;
        const int n = snprintf(out + used, out_size - used, "%s %s\n", row->name, value);
        if (n < 0 || (size_t)n >= out_size - used) return false;
        used += (size_t)n;
    }
    return true;
}

bool terrain_options_parse(TerrainOptions *out, const char **why, int *line, const char *text)
{
    TerrainOptions o;
    terrain_options_default(&o);
    *line = 0;
    for (const char *at = text; *at;) {
        char         name[32], value[terrain_paths_size];
        const size_t length = strcspn(at, "\n"), word = strcspn(at, " \n");
        *why = "no option of an import";
        ++*line;
        if (length > 0) {
            if (word >= sizeof name || word >= length || length - word - 1 >= sizeof value) return false;
            memcpy(name, at, word);
            name[word] = 0;
            memcpy(value, at + word + 1, length - word - 1);
            value[length - word - 1] = 0;
            if (!terrain_options_set(&o, why, name, value)) return false;
        }
        at += length + (at[length] == '\n');
    }
    *why = terrain_options_fault(&o);
    if (*why) return false;
    *out = o;
    return true;
}
