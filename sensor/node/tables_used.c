/* sensor/node/tables_used.c: the tables and models that a run reads, each with its SHA-256. */
#include "sensor/node/tables_used.h"

#include <dirent.h>
#include <stdlib.h>
#include <unistd.h>

enum { path_size = 4096 };

static void add(TablesUsed *out, const char *name, const char *path)
{
    TableUsed *t = &out->table[out->count];
    for (int i = 0; i < out->count; i++)
        if (strcmp(out->table[i].name, name) == 0) return;
    if (out->count == tables_used_max || access(path, R_OK) != 0) return;
    snprintf(t->name, sizeof t->name, "%s", name);
    if (sha256_file(t->sha256, path) == STATUS_OK) out->count++;
}

static int is_csv(const struct dirent *entry)
{
    const size_t n = strlen(entry->d_name);
    return n > 4 && strcmp(entry->d_name + n - 4, ".csv") == 0;
}

static void add_csv_of(TablesUsed *out, const char *folder, const char *prefix)
{
    struct dirent **entry;
    char            path[path_size], name[table_used_name_size];
    const int       count = scandir(folder, &entry, is_csv, alphasort);
    for (int i = 0; i < count; i++) {
        snprintf(path, sizeof path, "%.3500s/%.255s", folder, entry[i]->d_name);
        snprintf(name, sizeof name, "%s%.120s", prefix, entry[i]->d_name);
        add(out, name, path);
        free(entry[i]);
    }
    if (count >= 0) free(entry);
}

static int is_plain(const struct dirent *entry) { return entry->d_name[0] != '.'; }

/* Path and hash of every *.csv below folder, a line each, in the order of their names. */
static void list_files(FILE *to, const char *folder, const char *below, int depth)
{
    struct dirent **entry;
    char            path[path_size], inside[path_size], hash[sha256_text_size];
    const int       count = depth < 4 ? scandir(folder, &entry, is_plain, alphasort) : -1;
    for (int i = 0; i < count; i++) {
        snprintf(path, sizeof path, "%.3500s/%.255s", folder, entry[i]->d_name);
        snprintf(inside, sizeof inside, "%.3500s%.255s", below, entry[i]->d_name);
        if (is_csv(entry[i])) {
            if (sha256_file(hash, path) == STATUS_OK) fprintf(to, "%s %s\n", inside, hash);
        } else if (entry[i]->d_type == DT_DIR) {
            strcat(inside, "/");
            list_files(to, path, inside, depth + 1);
        }
        free(entry[i]);
    }
    if (count >= 0) free(entry);
}

/* Some sixty files, as one table. */
static void add_folder(TablesUsed *out, const char *name)
{
    char       folder[path_size], *text = NULL;
    size_t     octets = 0;
    TableUsed *t      = &out->table[out->count];
    if (out->count == tables_used_max || !etc_path(folder, sizeof folder, name) || access(folder, R_OK) != 0) return;
    FILE *list = open_memstream(&text, &octets);
    if (!list) return;
    list_files(list, folder, "", 0);
    snprintf(t->name, sizeof t->name, "%s", name);
    if (fclose(list) == 0 && octets > 0 && sha256_bytes(t->sha256, text, octets) == STATUS_OK) out->count++;
    free(text);
}

/* Files of the column `model`, beside the catalog, and what lies beside each of them with the ending .yaml. */
static void add_models(TablesUsed *out, const char *catalog)
{
    Table       table;
    char        path[path_size], name[table_used_name_size];
    const char *slash  = strrchr(catalog, '/');
    const int   folder = slash ? (int)(slash - catalog) + 1 : 0;
    if (table_open(&table, catalog) != STATUS_OK) return;
    const int column = table_column(&table, "model");
    for (int row = 0; column >= 0 && row < table.rows; row++) {
        const char *model = table_text(&table, row, column);
        if (!strpbrk(model, "./") || strlen(model) >= sizeof name - 8) continue;
        const int before = *model == '/' ? 0 : folder;
        snprintf(path, sizeof path, "%.*s%s", before, catalog, model);
        add(out, model, path);
        const size_t stem = strcspn(strrchr(model, '/') ? strrchr(model, '/') : model, ".") +
                            (size_t)((strrchr(model, '/') ? strrchr(model, '/') : model) - model);
        snprintf(name, sizeof name, "%.*s.yaml", (int)stem, model);
        snprintf(path, sizeof path, "%.*s%s", before, catalog, name);
        add(out, name, path);
    }
    table_close(&table);
}

void tables_used(TablesUsed *out, const Config *config, const char *catalog)
{
    char folder[path_size], name[table_used_name_size];
    out->count = 0;
    if (etc_path(folder, sizeof folder, "atmosphere")) {
        folder[strlen(folder) - strlen("/atmosphere")] = 0;
        add_csv_of(out, folder, "");
    }
    if (etc_path(folder, sizeof folder, "atmosphere")) add_csv_of(out, folder, "atmosphere/");
    snprintf(name, sizeof name, "atmosphere/%.100s", config->weather.atmosphere);
    add_folder(out, name);
    if (*config->sensor.table) {
        const char *slash = strrchr(config->sensor.table, '/');
        snprintf(name, sizeof name, "%.150s", slash ? slash + 1 : config->sensor.table);
        add(out, name, config->sensor.table);
    }
    add_models(out, catalog);
}
