/* terrain/landscape/cover_table.c: from the codes of land cover files to surface classes. */
#include "terrain/landscape/cover_table.h"

Status cover_table_read(CoverTable *out, const char *path)
{
    Table  table = {0};
    Status status = table_open(&table, path);
    if (status != STATUS_OK) return status;
    CoverTable t = {0};
    const int code_column = table_column(&table, "code"), surface_column = table_column(&table, "surface");
    status = STATUS_BAD_VALUE;
    if (code_column < 0 || surface_column < 0) {
        log_error("cover: %s needs the columns code and surface", path);
        goto done;
    }
    for (int row = 0; row < table.rows; row++) {
        double      code;
        const char *name = table_text(&table, row, surface_column);
        if (table_number(&code, &table, row, code_column, 0, cover_codes_most - 1) != STATUS_OK) goto done;
        const SurfaceClass surface = surface_find(name);
        if (code != floor(code) || t.known[(int)code] || (surface == SURFACE_NONE && strcmp(name, "none") != 0)) {
            log_error(
                "cover: %s:%d: code %g is not whole, given twice, or its surface '%s' unknown; terrain/surface.h and "
                "etc/surfaces.csv list them",
                path, table.line[row + 1], code, name);
            goto done;
        }
        t.known[(int)code]   = true;
        t.surface[(int)code] = (uint8_t)surface;
    }
    *out   = t;
    status = STATUS_OK;
done:
    table_close(&table);
    return status;
}

static const char *const built_in[] = {"worldcover", "nlcd", "fbfm40", "dynamicworld", "corine"};

/* The table with most of the pixels' codes; of equals the first. */
Status cover_table_choose(CoverTable *out, const char **name, const char *asked, const long histogram[cover_codes_most])
{
    char path[4096], file[64];
    bool named = false;
    for (size_t k = 0; k < sizeof built_in / sizeof *built_in; k++) named |= strcmp(asked, built_in[k]) == 0;
    if (*asked) {
        *name = asked;
        if (!named) return cover_table_read(out, asked);
        snprintf(file, sizeof file, "cover_%s.csv", asked);
        return etc_path(path, sizeof path, file) ? cover_table_read(out, path) : STATUS_BAD_VALUE;
    }
    long best = -1;
    for (size_t k = 0; k < sizeof built_in / sizeof *built_in; k++) {
        CoverTable table;
        long       known = 0;
        snprintf(file, sizeof file, "cover_%s.csv", built_in[k]);
        if (!etc_path(path, sizeof path, file)) return STATUS_BAD_VALUE;
        const Status status = cover_table_read(&table, path);
        if (status != STATUS_OK) return status;
        for (int c = 1; c < cover_codes_most; c++) known += table.known[c] ? histogram[c] : 0;
        if (known <= best) continue;
        best  = known;
        *out  = table;
        *name = built_in[k];
    }
    return STATUS_OK;
}
