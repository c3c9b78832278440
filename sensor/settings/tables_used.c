/* sensor/settings/tables_used.c: the tables and models that a run reads, each with its SHA-256. */
#include "sensor/settings/tables_used.h"
#include "pitviper_table.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <unistd.h>

enum { path_size = 4096 };

static Status add(TablesUsed *out, const char *name, const char *path)
{
    TableUsed *t = &out->table[out->count];
    for (int i = 0; i < out->count; i++)
        if (strcmp(out->table[i].name, name) == 0) return STATUS_OK;
    if (out->count == tables_used_max || access(path, R_OK) != 0) return STATUS_OK;
    snprintf(t->name, sizeof t->name, "%s", name);
    const Status status = sha256_file(t->sha256, path);
    out->count += status == STATUS_OK;
    return status == STATUS_NO_MEMORY ? status : STATUS_OK;
}

/* Other failures of scandir mean that the folder does not exist. */
static Status scanned(int count) { return count < 0 && errno == ENOMEM ? STATUS_NO_MEMORY : STATUS_OK; }

static int is_csv(const struct dirent *entry)
{
    const size_t n = strlen(entry->d_name);
    return n > 4 && strcmp(entry->d_name + n - 4, ".csv") == 0;
}

static Status add_csv_of(TablesUsed *out, const char *folder, const char *prefix)
{
    struct dirent **entry;
    char            path[path_size], name[table_used_name_size];
    const int       count = scandir(folder, &entry, is_csv, alphasort);
    Status          status = scanned(count);
    for (int i = 0; i < count; i++) {
        snprintf(path, sizeof path, "%.3500s/%.255s", folder, entry[i]->d_name);
        snprintf(name, sizeof name, "%s%.120s", prefix, entry[i]->d_name);
        if (status == STATUS_OK) status = add(out, name, path);
        free(entry[i]);
    }
    if (count >= 0) free(entry);
    return status;
}

static int is_plain(const struct dirent *entry) { return entry->d_name[0] != '.'; }

/* Lists path and hash of every *.csv below the folder, a line each, sorted by name. */
static Status list_files(FILE *to, const char *folder, const char *below, int depth)
{
    struct dirent **entry;
    char            path[path_size], inside[path_size], hash[sha256_text_size];
    if (depth == 4) return STATUS_OK;
    const int count = scandir(folder, &entry, is_plain, alphasort);
    Status    status = scanned(count);
    for (int i = 0; i < count; i++) {
        snprintf(path, sizeof path, "%.3500s/%.255s", folder, entry[i]->d_name);
        snprintf(inside, sizeof inside, "%.3500s%.255s", below, entry[i]->d_name);
        if (status == STATUS_OK && is_csv(entry[i])) {
            const Status hashed = sha256_file(hash, path);
            if (hashed == STATUS_OK) fprintf(to, "%s %s\n", inside, hash);
            else if (hashed == STATUS_NO_MEMORY) status = hashed;
        } else if (status == STATUS_OK && entry[i]->d_type == DT_DIR) {
            strcat(inside, "/");
            status = list_files(to, path, inside, depth + 1);
        }
        free(entry[i]);
    }
    if (count >= 0) free(entry);
    return status;
}

/* Adds a folder of some sixty files as one entry: the hash of lines of their paths and hashes. own: its path; NULL: it
 * is the one of that name in etc. */
static Status add_folder(TablesUsed *out, const char *name, const char *own)
{
    char       folder[path_size], *text = NULL;
    size_t     octets = 0;
    TableUsed *t = &out->table[out->count];
    const bool found =
        own ? snprintf(folder, sizeof folder, "%s", own) < (int)sizeof folder : etc_path(folder, sizeof folder, name);
    if (out->count == tables_used_max || !found || access(folder, R_OK) != 0) return STATUS_OK;
    FILE *list = open_memstream(&text, &octets);
    if (!list) return STATUS_NO_MEMORY;
    Status     status = list_files(list, folder, "", 0);
    const bool whole = !ferror(list);
    if ((fclose(list) != 0 || !whole) && status == STATUS_OK) status = STATUS_NO_MEMORY;
    snprintf(t->name, sizeof t->name, "%s", name);
    if (status == STATUS_OK && octets > 0) {
        status = sha256_bytes(t->sha256, text, octets);
        out->count += status == STATUS_OK;
    }
    free(text);
    return status;
}

/* Adds the model files of the catalog, relative to it, and the sidecar of each. */
static Status add_models(TablesUsed *out, const char *catalog)
{
    static const TableColumn column = {"model", .absent = TABLE_LATER, .type = TABLE_CELL, .size = sizeof(char *)};
    static const TableFormat format = {"catalog", &column, 1, .next = "etc/catalog.csv explains the columns"};
    TableRows                rows;
    char                     path[path_size], name[table_used_name_size];
    const char              *slash = strrchr(catalog, '/');
    const int                folder = slash ? (int)(slash - catalog) + 1 : 0;
    Status                   status = table_rows_open(&rows, &format, catalog);
    if (status != STATUS_OK) return status;
    for (int row = 0; row < rows.table.rows && status == STATUS_OK; row++) {
        const char *model = table_rows_text(&rows, row, "model");
        if (!strpbrk(model, "./") || strlen(model) >= sizeof name - 8) continue;
        const int before = *model == '/' ? 0 : folder;
        snprintf(path, sizeof path, "%.*s%s", before, catalog, model);
        status = add(out, model, path);
        const size_t stem = strcspn(strrchr(model, '/') ? strrchr(model, '/') : model, ".") +
                            (size_t)((strrchr(model, '/') ? strrchr(model, '/') : model) - model);
        snprintf(name, sizeof name, "%.*s.yaml", (int)stem, model);
        snprintf(path, sizeof path, "%.*s%s", before, catalog, name);
        if (status == STATUS_OK) status = add(out, name, path);
    }
    table_rows_close(&rows);
    return status;
}

/* Adds a file of the user's, by its name in its folder. */
static Status add_in(TablesUsed *out, const char *folder, const char *path)
{
    char        name[table_used_name_size];
    const char *slash = strrchr(path, '/');
    snprintf(name, sizeof name, "%s%.150s", folder, slash ? slash + 1 : path);
    return add(out, name, path);
}

Status tables_used(TablesUsed *out, const Config *config, const char *catalog)
{
    char   folder[path_size], name[table_used_name_size];
    Status status = STATUS_OK;
    out->count = 0;
    if (etc_path(folder, sizeof folder, "atmosphere")) {
        char vapour[path_size + 16];
        snprintf(vapour, sizeof vapour, "%s/vapour.bin", folder);
        status = add_csv_of(out, folder, "atmosphere/");
        if (status == STATUS_OK) status = add(out, "atmosphere/vapour.bin", vapour);
        folder[strlen(folder) - strlen("/atmosphere")] = 0;
        if (status == STATUS_OK) status = add_csv_of(out, folder, "");
    }
    if (status == STATUS_OK && strcmp(config->radar.preset, "none") != 0 && etc_path(folder, sizeof folder, "radar"))
        status = add_csv_of(out, folder, "radar/");
    if (status == STATUS_OK && *config->radar.given) status = add_in(out, "radar/", config->radar.given);
    snprintf(name, sizeof name, "atmosphere/%.100s", config->weather.atmosphere);
    const char *own = strpbrk(config->weather.atmosphere, "/.") ? config->weather.atmosphere : NULL;
    if (status == STATUS_OK) status = add_folder(out, name, own);
    if (*config->radar.table && status == STATUS_OK) status = add_in(out, "radar/", config->radar.table);
    if (*config->exercise.cigi_types && status == STATUS_OK) status = add_in(out, "cigi/", config->exercise.cigi_types);
    if (*config->sensor.table && status == STATUS_OK) status = add_in(out, "", config->sensor.table);
    if (strpbrk(config->weather.day, "/.") && status == STATUS_OK)
        status = add_in(out, "weather/", config->weather.day);
    return status == STATUS_OK ? add_models(out, catalog) : status;
}

Status tables_given(TablesUsed *out, const Config *config)
{
    return *config->heat.given ? add_in(out, "heat/", config->heat.given) : STATUS_OK;
}
