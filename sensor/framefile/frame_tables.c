/* sensor/framefile/frame_tables.c: tables of etc/ and of the user, by SHA-256. */
#include "sensor/framefile/frame_tables.h"

static Status add_own(TablesUsed *out, const char *name, const char *path)
{
    if (!*path || out->count == tables_used_max) return STATUS_OK;
    TableUsed *t = &out->table[out->count];
    snprintf(t->name, sizeof t->name, "%s", name);
    const Status status = sha256_file(t->sha256, path);
    out->count += status == STATUS_OK;
    return status;
}

Status frame_tables(TablesUsed *out, const Config *config, const char *catalog)
{
    Status status = tables_used(out, config, catalog);
    if (status == STATUS_OK) status = add_own(out, "models.catalog", config->models.catalog);
    if (status == STATUS_OK) status = add_own(out, "models.materials", config->models.materials);
    return status;
}
