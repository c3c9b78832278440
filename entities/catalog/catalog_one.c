/* entities/catalog/catalog_one.c: a catalog of one model for all entity types. */
#include "entities/catalog/catalog.h"
#include "pitviper_output.h"

#include "entities/import/model_import.h"
#include "entities/parametric/parametric.h"

#include <stdlib.h>
#include <unistd.h>

Status catalog_open_one(Catalog **out, int *model, const char *name, double sag_m)
{
    char   path[temp_path_size];
    char  *real = model_is_path(name) ? realpath(name, NULL) : NULL;
    Status status = STATUS_IO;
    if (!model_is_path(name) && !parametric_known(name)) return model_say_unknown(name);
    if (!temp_file(path, ".csv")) {
        free(real);
        return STATUS_IO;
    }
    FILE *file = output_file(path, 0);
    if (file) {
        fputs("type,model,origin\n*,\"", file);
        for (const char *c = real ? real : name; *c; c++) fputs(*c == '"' ? "\"\"" : (const char[]){*c, 0}, file);
        fputs("\",base\n", file);
        if (fclose(file) == 0) status = catalog_open(out, path, sag_m);
    } else {
        log_error("model: cannot write %s", path);
    }
    unlink(path);
    free(real);
    if (status == STATUS_OK) *model = catalog_find(*out, (DisEntityType){.kind = 1}, NULL, NULL);
    return status;
}
