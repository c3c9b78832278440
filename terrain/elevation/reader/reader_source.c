/* terrain/elevation/reader/reader_source.c: which files GDAL may be given: it opens by name, and what lies beside a
 * file with it. */
#include "terrain/elevation/reader/reader_private.h"

#include "pitviper_file.h"

#include <dirent.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <strings.h>
#include <sys/stat.h>

static char only_within[PATH_MAX]; /* the only folder whose files are read; empty: any folder */
static char from_folders[4 * PATH_MAX];
bool        reader_by_name = true;

void reader_source_begin(const char *within, const char *from)
{
    snprintf(only_within, sizeof only_within, "%s", within);
    snprintf(from_folders, sizeof from_folders, "%s", from);
}

/* ---- names ------------------------------------------------------------------------------------------ */

static bool is_there(const char *path)
{
    struct stat about;
    return stat(path, &about) == 0;
}

static bool is_file(const char *path)
{
    struct stat about;
    return stat(path, &about) == 0 && S_ISREG(about.st_mode);
}

/* The file behind one of GDAL's own names, such as /vsizip/ARCHIVE/NAME or NETCDF:"FILE":VARIABLE. Returns false when
 * there is none. */
static bool file_of_name(char out[PATH_MAX], const char *name)
{
    const char *at = name;
    while (strncmp(at, "/vsi", 4) == 0 && !is_there(at)) {
        const char *slash = strchr(at + 1, '/');
        if (!slash) return false;
        at = slash + 1;
    }
    if ((size_t)snprintf(out, PATH_MAX, "%s", at) >= PATH_MAX) return false;
    if (at == name && is_there(name)) return true;
    for (;;) { /* looks for the archive that contains the name */
        if (is_file(out)) return true;
        char *slash = strrchr(out, '/');
        if (!slash || slash == out) break;
        *slash = 0;
    }
    for (const char *part = name; *part;) {
        const size_t length = strcspn(part, ":\"");
        if (length > 0 && length < strlen(name)) {
            char bare[PATH_MAX];
            snprintf(bare, sizeof bare, "%.*s", (int)length, part);
            if (file_of_name(out, bare)) return true;
        }
        part += length + (part[length] != 0);
    }
    return false;
}

/* The folder that a name lies in, as it is written. */
static void folder_of(char out[PATH_MAX], const char *path)
{
    const char *slash = strrchr(path, '/');
    if (!slash) snprintf(out, PATH_MAX, ".");
    else snprintf(out, PATH_MAX, "%.*s", slash == path ? 1 : (int)(slash - path), path);
}

/* Whether a path lies below a folder, after links are followed. */
static bool is_below(const char *path, const char *folder)
{
    char whole[PATH_MAX], top[PATH_MAX];
    if (!realpath(path, whole) || !realpath(folder, top)) return false;
    const size_t length = strlen(top);
    return strcmp(top, "/") == 0 || (strncmp(whole, top, length) == 0 && (whole[length] == '/' || whole[length] == 0));
}

static bool is_below_one(const char *path, const char *folders)
{
    char folder[wire_path_size];
    bool too_long = false;
    for (const char *at = folders; reader_next_name(folder, &at, &too_long);)
        if (is_below(path, folder)) return true;
    return false;
}

/* Length of a file's name without its last ending. */
static size_t stem_of(const char **name, const char *path)
{
    const char *slash = strrchr(path, '/');
    *name = slash ? slash + 1 : path;
    const char *dot = strrchr(*name, '.');
    return dot ? (size_t)(dot - *name) : strlen(*name);
}

/* Whether a file is read along with its owner, as x.tif.aux.xml, x.tfw and x.prj are with x.tif; links among these are
 * as trusted as the owner. */
static bool is_beside(const char *path, const char *owner)
{
    char        a[PATH_MAX], b[PATH_MAX];
    const char *name, *other;
    folder_of(a, path);
    folder_of(b, owner);
    const size_t stem = stem_of(&name, owner);
    (void)stem_of(&other, path);
    return strcmp(a, b) == 0 && strncmp(name, other, stem) == 0 && (other[stem] == '.' || other[stem] == 0);
}

/* ---- what may be opened at all ------------------------------------------------------------------------ */

typedef struct Names {
    char **name;
    int    count;
    bool   no_memory;
} Names;

static void add(Names *names, const char *name)
{
    char **more = realloc(names->name, ((size_t)names->count + 2) * sizeof *more);
    if (more) names->name = more;
    char *copy = more ? strdup(name) : NULL;
    if (!copy) {
        names->no_memory = true;
        return;
    }
    names->name[names->count++] = copy;
    names->name[names->count] = NULL;
}

/* Adds the targets of a folder's links: of all its files, or of those beside one file. */
static void add_links(Names *names, const char *folder, const char *beside)
{
    char path[PATH_MAX], whole[PATH_MAX];
    DIR *directory = opendir(folder);
    for (struct dirent *entry; directory && (entry = readdir(directory));) {
        struct stat about;
        if (entry->d_type == DT_REG || entry->d_type == DT_DIR) continue;
        if (snprintf(path, sizeof path, "%s/%s", folder, entry->d_name) >= (int)sizeof path) continue;
        const char  *name;
        const size_t stem = beside ? stem_of(&name, beside) : 0;
        if (beside && strncmp(entry->d_name, name, stem) != 0) continue;
        if (lstat(path, &about) == 0 && S_ISLNK(about.st_mode) && realpath(path, whole)) add(names, whole);
    }
    if (directory) closedir(directory);
}

char **reader_source_folders(const char *paths)
{
    Names names = {0};
    char  path[wire_path_size], file[PATH_MAX], folder[PATH_MAX];
    bool  too_long = false;
    if (*only_within) {
        add(&names, only_within);
    } else {
        for (const char *at = from_folders; reader_next_name(path, &at, &too_long);) add(&names, path);
        for (const char *at = paths; reader_next_name(path, &at, &too_long);) {
            struct stat  about;
            RasterChoice choice;
            const char  *why;
            (void)raster_choice_take(&choice, &why, path); /* errors in it are reported when the file is opened */
            if (stat(path, &about) == 0 && S_ISDIR(about.st_mode)) {
                add(&names, path);
                add_links(&names, path, NULL);
                continue;
            }
            if (!file_of_name(file, path)) continue;
            folder_of(folder, file);
            add(&names, folder);
            add_links(&names, folder, file);
            if (realpath(file, folder) && lstat(file, &about) == 0 &&
                S_ISLNK(about.st_mode)) { /* a VRT's files may lie there */
                char real[PATH_MAX];
                folder_of(real, folder);
                add(&names, real);
            }
        }
    }
    if (!names.no_memory && names.count > 0) return names.name;
    for (int k = 0; k < names.count; k++) free(names.name[k]);
    free(names.name);
    return names.no_memory ? NULL : calloc(1, sizeof(char *));
}

/* ---- one by one ------------------------------------------------------------------------------------ */

/* GDAL looks for a coordinate system, world file, overviews and notes beside a file, under its name or another ending.
 */
static bool beside_may_be_opened(const char *path, const char *key)
{
    static _Thread_local char plain[wire_path_size]; /* the folder checked last, if it holds only files and folders */
    char                      full[wire_path_size], why[file_why_size];
    const char               *name;
    const size_t              stem = stem_of(&name, path);
    const int                 folder = (int)(name - path);
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
        if (strncasecmp(entry->d_name, name, stem) != 0 || (entry->d_name[stem] != '.' && entry->d_name[stem] != 0))
            continue;
        good = file_is_regular(why, full);
        if (!good) log_error("%s: %s is read with what lies beside it: cannot read %s: %s", key, path, full, why);
    }
    if (directory) closedir(directory);
    if (odd || !directory) *plain = 0;
    return good;
}

static const char outside_store[] = "it lies outside the folder of the store that is made again of it";

bool reader_file_allowed(const char *path, const char *key)
{
    struct stat about;
    char        why[file_why_size];
    snprintf(why, sizeof why, "%s", outside_store);
    if ((!*only_within || is_below(path, only_within)) && (stat(path, &about) != 0 || file_is_regular(why, path)))
        return beside_may_be_opened(path, key);
    log_error("%s: cannot read %s: %s", key, path, why);
    return false;
}

bool reader_part_allowed(const char *path, const char *owner, const char *key)
{
    char file[PATH_MAX], own[PATH_MAX], folder[PATH_MAX], real[PATH_MAX], why[file_why_size];
    if (*only_within) return reader_file_allowed(path, key);
    const bool named = file_of_name(file, path);
    bool       within = named && (is_beside(file, owner) || is_below_one(file, from_folders));
    if (named && !within && file_of_name(own, owner)) {
        folder_of(folder, own);
        within = is_below(file, folder);
        if (!within && realpath(own, real)) { /* the file is a link into the folder */
            folder_of(folder, real);
            within = is_below(file, folder);
        }
    }
    if (!within) {
        log_error(
            "%s: %s names %s, which %s; where you trust that, terrain.sources_from (terrain import: --sources-from) names "
            "folders that it may read",
            key, owner, path, named ? "lies outside its folder" : "is no file");
        return false;
    }
    if (is_there(path) && !file_is_regular(why, path)) {
        log_error("%s: cannot read %s: %s", key, path, why);
        return false;
    }
    return beside_may_be_opened(path, key);
}
