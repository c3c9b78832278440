/* pitviper_settings_paths.c: names of files in settings: relative to the file that gives them, or made absolute. */
#include "pitviper_settings_private.h"

#include "pitviper_file.h"

#include <assert.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

enum { paths_most = 4096 }; /* largest setting of paths */

bool settings_is_path(const Setting *row)
{
    return row->type == SETTING_PATH || row->type == SETTING_PATHS || row->type == SETTING_NAME_OR_PATH;
}

/* Characters of the folder that paths in this file are relative to, with its slash. A file without a folder (a pipe,
 * /dev/stdin) has none: they are relative to the current folder. */
static size_t folder_of(const char *file)
{
    struct stat about;
    const char *slash = file ? strrchr(file, '/') : NULL;
    if (!slash || (stat(file, &about) == 0 && !S_ISREG(about.st_mode))) return 0;
    return (size_t)(slash - file) + 1;
}

/* Each path behind the folder it is relative to. False: it does not fit. */
bool settings_place_paths(char *out, size_t out_size, SettingType type, const char *value, const char *file)
{
    const size_t folder = folder_of(file);
    size_t       n = 0;
    char         made[paths_most] = {0};
    bool         fits = true;
    assert(out_size <= sizeof made);
    for (const char *at = value; fits && *at;) {
        const size_t blanks = type == SETTING_PATHS ? strspn(at, " ") : 0;
        const size_t length = type == SETTING_PATHS ? strcspn(at, ",") : strlen(at);
        const bool   name = type == SETTING_NAME_OR_PATH && !strpbrk(value, "/.");
        const size_t before = blanks < length && at[blanks] != '/' && !name ? folder : 0;
        fits = n + before + length + 1 < out_size;
        if (!fits) break;
        if (before) memcpy(made + n, file, before);
        memcpy(made + n + before, at + (blanks < length ? blanks : length), blanks < length ? length - blanks : 0);
        n += before + (blanks < length ? length - blanks : 0);
        if (at[length]) made[n++] = ',';
        at += length + (at[length] != 0);
    }
    if (fits) memcpy(out, made, out_size);
    return fits;
}

/* The real path of an existing one; else with the current folder prepended. */
static bool absolute(char *out, size_t out_size, const char *path)
{
    char       *real = realpath(path, NULL), here[4096];
    const char *folder = path[0] == '/' || real ? "" : getcwd(here, sizeof here);
    const int   n = folder ? snprintf(out, out_size, "%s%s%s", folder, *folder ? "/" : "", real ? real : path) : -1;
    free(real);
    return n >= 0 && n < (int)out_size;
}

static bool is_among(const char *name, const char *names)
{
    const size_t length = strlen(name);
    for (const char *at = names; (at = strstr(at, name)); at += length)
        if ((at == names || at[-1] == ',') && (at[length] == 0 || at[length] == ',')) return true;
    return false;
}

bool settings_paths_good(const void *from, const SettingTable *table, const char *outputs)
{
    for (int i = 0; i < table->count; i++) {
        const Setting *row = &table->row[i];
        const char    *at  = (const char *)from + row->offset;
        if (!settings_is_path(row) || is_among(row->name, outputs)) continue;
        if (row->type == SETTING_NAME_OR_PATH && !strpbrk(at, "/.")) continue;
        while (*at) {
            const size_t length = row->type == SETTING_PATHS ? strcspn(at, ",") : strlen(at);
            char         path[4096], why[file_why_size];
            struct stat  about;
            snprintf(path, sizeof path, "%.*s", (int)length, at);
            at += length + (at[length] != 0);
            if (stat(path, &about) != 0 || S_ISREG(about.st_mode) || S_ISDIR(about.st_mode)) continue;
            file_is_regular(why, path);
            log_error("%s: %s: cannot read %s: %s", table->module, row->name, path, why);
            return false;
        }
    }
    return true;
}

void settings_absolute(void *out, const SettingTable *table)
{
    for (int i = 0; i < table->count; i++) {
        const Setting *row = &table->row[i];
        char          *at = (char *)out + row->offset, made[paths_most] = {0}, one[4096];
        size_t         n = 0;
        if (!settings_is_path(row) || !*at || (row->type == SETTING_NAME_OR_PATH && !strpbrk(at, "/."))) continue;
        assert(row->size <= sizeof made);
        bool fits = true;
        for (const char *from = at; fits && *from;) {
            const size_t length = row->type == SETTING_PATHS ? strcspn(from, ",") : strlen(from);
            char         path[4096];
            fits = length < sizeof path;
            if (!fits) break;
            snprintf(path, sizeof path, "%.*s", (int)length, from);
            if (!length || !absolute(one, sizeof one, path)) snprintf(one, sizeof one, "%s", path);
            n += (size_t)snprintf(made + n, row->size - n, "%s%s", one, from[length] ? "," : "");
            fits = n < row->size;
            from += length + (from[length] != 0);
        }
        if (fits) memcpy(at, made, row->size);
    }
}
