/* entities/import/model_files.c: a model by its name: a built-in shape, or the files that it is read from, its own and
 * its sidecar. */
#include "entities/import/model_import_private.h"

#include "entities/shapes/parametric.h"
#include "pitviper_file.h"

#include <ctype.h>
#include <strings.h>
#include <sys/stat.h>

void import_split_extension(char out[16], size_t *stem, const char *path)
{
    size_t length = strlen(path);
    out[0] = 0;
    if (length > 3 && strcasecmp(path + length - 3, ".gz") == 0) length -= 3;
    *stem = length;
    for (size_t at = length; at > 0 && path[at - 1] != '/'; at--)
        if (path[at - 1] == '.') {
            const size_t count = length - at;
            if (count >= 16) return;
            for (size_t i = 0; i < count; i++) out[i] = (char)tolower((unsigned char)path[at + i]);
            out[count] = 0;
            *stem = at - 1;
            return;
        }
}

/* A sidecar beside a model is read if it is there, and refused if it is no file. */
static bool is_there(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 && !S_ISDIR(info.st_mode);
}

bool model_is_path(const char *name) { return strpbrk(name, "/.") != NULL; }

Status import_find_files(ModelImport *report, Sidecar *sidecar, const char *path)
{
    char   extension[16];
    size_t stem;
    if (strlen(path) >= sizeof report->file - 8) {
        log_error("model: the path is longer than %zu characters: %.60s...", sizeof report->file - 8, path);
        return STATUS_BAD_VALUE;
    }
    import_split_extension(extension, &stem, path);
    if (strcmp(extension, "yaml") == 0 || strcmp(extension, "yml") == 0) {
        snprintf(report->sidecar, sizeof report->sidecar, "%s", path);
        const Status status = sidecar_read(sidecar, path);
        if (status != STATUS_OK) return status;
        if (!sidecar->file[0]) {
            log_error("sidecar: %s: file: is missing: which model it is for (or name the model's file instead)", path);
            return STATUS_BAD_VALUE;
        }
        const char *slash = strrchr(path, '/');
        const int   folder = sidecar->file[0] == '/' || !slash ? 0 : (int)(slash - path) + 1;
        if ((size_t)snprintf(report->file, sizeof report->file, "%.*s%s", folder, path, sidecar->file) >=
            sizeof report->file) {
            log_error("sidecar: %s: file: the path is too long", path);
            return STATUS_BAD_VALUE;
        }
    } else {
        snprintf(report->file, sizeof report->file, "%s", path);
        snprintf(report->sidecar, sizeof report->sidecar, "%.*s.yaml", (int)stem, path);
        if (is_there(report->sidecar)) {
            const Status status = sidecar_read(sidecar, report->sidecar);
            if (status != STATUS_OK) return status;
        } else {
            report->sidecar[0] = 0;
        }
    }
    struct stat info;
    char        why[file_why_size];
    if (!file_is_regular(why, report->file)) {
        log_error("model: cannot open: file=%s: %s", report->file, why);
        return STATUS_IO;
    }
    if (stat(report->file, &info) == 0 && info.st_size <= import_max_octets) {
        report->octets = info.st_size;
        return STATUS_OK;
    }
    log_error("model: cannot read: file=%s: larger than 256 MiB", report->file);
    return STATUS_BAD_VALUE;
}

/* ---- by name ----------------------------------------------------------------------------------- */

Status model_say_unknown(const char *name)
{
    WordMeant meant = word_meant(name);
    for (int i = 0; i < parametric_count(); i++) word_consider(&meant, parametric_name(i));
    log_error(
        "model: no built-in model of this name: '%s'; `pitviper model list` lists them, a file's name has a dot or "
        "a slash in it%s",
        name, word_hint(&meant));
    return STATUS_UNSUPPORTED;
}

Status model_open(Model *out, ModelImport *report, bool *imported, const char *name, double sag_m)
{
    *imported = model_is_path(name);
    if (*imported) return model_import(out, report, name);
    return parametric_known(name) ? parametric_build(out, name, sag_m) : model_say_unknown(name);
}
