/* terrain/surface.c: classes of the ground by the names that etc/surfaces.csv and the products use, and from the codes
 * of land cover files. */
#include "terrain/surface.h"

const char *surface_name(SurfaceClass surface)
{
    static const char *const name[SURFACE_COUNT] = {
        [SURFACE_NONE] = "none",
        [SURFACE_GRASS] = "grass",
        [SURFACE_DRY_GRASS] = "dry_grass",
        [SURFACE_CROP] = "crop",
        [SURFACE_BARE_SOIL] = "bare_soil",
        [SURFACE_PLOUGHED] = "ploughed",
        [SURFACE_TRACK] = "track",
        [SURFACE_ROCK] = "rock",
        [SURFACE_SCRUB] = "scrub",
        [SURFACE_WATER] = "water",
        [SURFACE_BUILT] = "built",
        [SURFACE_ROAD] = "road",
        [SURFACE_SAND] = "sand",
        [SURFACE_SNOW] = "snow",
        [SURFACE_WETLAND] = "wetland",
        [SURFACE_FOREST_BROADLEAF] = "forest_broadleaf",
        [SURFACE_FOREST_CONIFER] = "forest_conifer",
    };
    return surface >= 0 && surface < SURFACE_COUNT ? name[surface] : "none";
}

SurfaceClass surface_find(const char *name)
{
    for (int s = SURFACE_NONE + 1; s < SURFACE_COUNT; s++)
        if (strcmp(surface_name((SurfaceClass)s), name) == 0) return (SurfaceClass)s;
    return SURFACE_NONE;
}

const char *surface_named(int surface) { return surface_name((SurfaceClass)surface); }

/* ---- codes of files ------------------------------------------------------------------------------ */

typedef struct CodeRow {
    int          code;
    SurfaceClass surface;
} CodeRow;

static Status take_code(void *user, const void *row, const TableRows *rows, int number)
{
    SurfaceTable  *t = user;
    const CodeRow *r = row;
    if (t->known[r->code]) return table_rows_refuse(rows, number, NULL, "a second row of code %d", r->code);
    t->known[r->code] = true;
    t->surface[r->code] = (uint8_t)r->surface;
    return STATUS_OK;
}

/* Reads a CSV with columns code and surface; logs what is wrong with it. */
static Status surface_table_read(SurfaceTable *out, const char *path)
{
    static const TableColumn columns[] = {
        {"code", TABLE_INT, TABLE_AT(CodeRow, code), .low = 0, .high = surface_codes_most - 1},
        {"surface", TABLE_NAMED, TABLE_AT(CodeRow, surface), SURFACE_OR_NONE}};
    static const TableFormat format = {"cover", columns, 2, .next = "etc/cover_nlcd.csv is an example"};
    CodeRow                  row;
    SurfaceTable             table = {0};
    const Status             status = table_each(&format, path, &row, sizeof row, take_code, &table);
    if (status == STATUS_OK) *out = table;
    return status;
}

static const char *const built_in[] = {"worldcover", "nlcd", "fbfm40", "dynamicworld", "corine"};

Status surface_table_choose(SurfaceTable *out, const char **name, const char *asked,
                            const long histogram[surface_codes_most])
{
    char path[4096], file[64];
    bool named = false;
    for (size_t k = 0; k < sizeof built_in / sizeof *built_in; k++) named |= strcmp(asked, built_in[k]) == 0;
    if (*asked) {
        *name = asked;
        if (!named) return surface_table_read(out, asked);
        snprintf(file, sizeof file, "cover_%s.csv", asked);
        return etc_path(path, sizeof path, file) ? surface_table_read(out, path) : STATUS_BAD_VALUE;
    }
    long best = -1;
    for (size_t k = 0; k < sizeof built_in / sizeof *built_in; k++) {
        SurfaceTable table;
        long         known = 0;
        snprintf(file, sizeof file, "cover_%s.csv", built_in[k]);
        if (!etc_path(path, sizeof path, file)) return STATUS_BAD_VALUE;
        const Status status = surface_table_read(&table, path);
        if (status != STATUS_OK) return status;
        for (int c = 1; c < surface_codes_most; c++) known += table.known[c] ? histogram[c] : 0;
        if (known <= best) continue;
        best = known;
        *out = table;
        *name = built_in[k];
    }
    return STATUS_OK;
}

Status surface_table_check(const char *path)
{
    SurfaceTable table;
    return surface_table_read(&table, path);
}
