/* terrain/elevation/raster_source.c: which files GDAL may be given: it opens by name, and what lies beside a file with it. */
#include "terrain/elevation/raster_source.h"

#include "pitviper_file.h"

#include <dirent.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <strings.h>
#include <sys/stat.h>

enum { path_size = 4096 };

static char only_within[PATH_MAX]; /* empty: anywhere */

void raster_stay_within(const char *folder) { snprintf(only_within, sizeof only_within, "%s", folder ? folder : ""); }

bool raster_stays_within(void) { return *only_within != 0; }

static bool is_within(const char *path)
{
    char         whole[PATH_MAX];
    const size_t length = strlen(only_within);
    return length == 0 || (realpath(path, whole) && strncmp(whole, only_within, length) == 0 &&
                           (whole[length] == '/' || strcmp(only_within, "/") == 0));
}

/* GDAL looks for a coordinate system, world file, overviews and notes beside a file, under its name or another ending. */
static bool beside_may_be_opened(const char *path, const char *key)
{
    static _Thread_local char plain[path_size]; /* the last folder that holds files and folders alone */
    char           full[path_size], why[file_why_size];
    const char    *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path, *dot = strrchr(name, '.');
    const size_t   stem = dot ? (size_t)(dot - name) : strlen(name);
    const int      folder = slash ? (int)(slash - path) + 1 : 0;
    snprintf(full, sizeof full, "%.*s", folder ? folder : 1, folder ? path : ".");
    if (strcmp(full, plain) == 0) return true;
    DIR *directory = opendir(full);
    bool good = true, odd = false;
    snprintf(plain, sizeof plain, "%s", full);
    for (struct dirent *entry; good && directory && (entry = readdir(directory));) {
        struct stat about;
        if (entry->d_type == DT_REG || entry->d_type == DT_DIR) continue;
        snprintf(full, sizeof full, "%.*s%s", folder, path, entry->d_name);
        if (stat(full, &about) != 0 || S_ISDIR(about.st_mode) || S_ISREG(about.st_mode)) continue;
        odd = true;
        if (strncasecmp(entry->d_name, name, stem) != 0 || (entry->d_name[stem] != '.' && entry->d_name[stem] != 0)) continue;
        good = file_is_regular(why, full);
        if (!good) log_error("%s: %s is read with what lies beside it: cannot read %s: %s", key, path, full, why);
    }
    if (directory) closedir(directory);
    if (odd || !directory) *plain = 0;
    return good;
}

bool raster_file_allowed(const char *path, const char *key)
{
    struct stat about;
    char        why[file_why_size] = "it lies outside the folder of the store that is made again of it";
    if (is_within(path) && (stat(path, &about) != 0 || file_is_regular(why, path))) return beside_may_be_opened(path, key);
    log_error("%s: cannot read %s: %s", key, path, why);
    return false;
}
