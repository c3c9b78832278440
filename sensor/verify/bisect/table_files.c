/* sensor/verify/bisect/table_files.c: the files of two folders of tables, and those in which they differ. */
#include "sensor/verify/bisect/bisect_private.h"
#include "pitviper_sha256.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

enum { files_most = 4000, depth_most = 8, file_most = 64 << 20 };

/* Pages, scripts and pictures are no tables. */
static bool is_table(const char *name)
{
    static const char *const others[] = {".md", ".py", ".svg", ".html", ".sh", ".c", ".h"};
    const char              *dot = strrchr(name, '.');
    if (!dot) return false;
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (strcasecmp(dot, others[i]) == 0) return false;
    return true;
}

static int is_shown(const struct dirent *entry) { return entry->d_name[0] != '.'; }

static TableFile *find_file(const TableFiles *files, const char *name)
{
    for (int i = 0; i < files->count; i++)
        if (strcmp(files->file[i].name, name) == 0) return &files->file[i];
    return NULL;
}

/* Notes one file of OLD or NEW. */
static Status add_file(TableFiles *out, const char *name, bool new)
{
    TableFile *f = find_file(out, name);
    if (!f) {
        if (out->count == files_most) {
            log_error("regress: bisect: more than %d files of tables; name a folder of tables alone", files_most);
            return STATUS_BAD_VALUE;
        }
        if (out->count % 256 == 0) {
            TableFile *more = realloc(out->file, (size_t)(out->count + 256) * sizeof *more);
            if (!more) return STATUS_NO_MEMORY;
            out->file = more;
        }
        char *copy = strdup(name);
        if (!copy) return STATUS_NO_MEMORY;
        f = &out->file[out->count++];
        *f = (TableFile){.name = copy};
    }
    if (new) f->in_new = true;
    else f->in_old = true;
    return STATUS_OK;
}

/* below: the folder's own name in the folder of tables, with a slash, or "". */
static Status list(TableFiles *out, const char *folder, const char *below, bool new, int depth)
{
    struct dirent **entry;
    char            path[bisect_path_size], name[512];
    struct stat     about;
    Status          status = STATUS_OK;
    snprintf(path, sizeof path, "%s/%s", folder, below);
    const int count = scandir(path, &entry, is_shown, alphasort);
    if (count < 0) {
        log_error("regress: bisect: cannot read the folder %s: %s", path, strerror(errno));
        return STATUS_IO;
    }
    for (int i = 0; i < count; i++) {
        const bool fits = snprintf(name, sizeof name - 1, "%s%s", below, entry[i]->d_name) < (int)sizeof name - 1 &&
                          snprintf(path, sizeof path, "%s/%s", folder, name) < (int)sizeof path;
        if (status == STATUS_OK && fits && stat(path, &about) == 0) {
            if (S_ISREG(about.st_mode) && is_table(name)) status = add_file(out, name, new);
            if (S_ISDIR(about.st_mode) && depth < depth_most)
                status = list(out, folder, strcat(name, "/"), new, depth + 1);
        }
        free(entry[i]);
    }
    free(entry);
    return status;
}

static int by_name(const void *a, const void *b)
{
    return strcmp(((const TableFile *)a)->name, ((const TableFile *)b)->name);
}

static bool is_csv(const char *name)
{
    const size_t n = strlen(name);
    return n > 4 && strcasecmp(name + n - 4, ".csv") == 0;
}

/* Splits a table that differs into its rows, where that can be done. */
static Status find_rows(TableFile *f, const char *old_path, const char *new_path)
{
    char  *was = NULL, *is = NULL;
    size_t octets[2] = {0};
    Status status = text_read_file(&was, &octets[0], "regress", old_path, file_most);
    if (status == STATUS_OK) status = text_read_file(&is, &octets[1], "regress", new_path, file_most);
    if (status == STATUS_OK && (strlen(was) != octets[0] || strlen(is) != octets[1])) f->whole = "it is no text";
    else if (status == STATUS_OK) status = row_changes_of(&f->rows, &f->whole, was, is);
    if (status == STATUS_UNSUPPORTED) status = STATUS_OK;
    else if (status == STATUS_OK && !f->whole) {
        f->by_rows = true;
        f->differs = f->rows.count > 0; /* else in comments */
    }
    free(was);
    free(is);
    return status;
}

static Status compare(TableFile *f, const char *old_folder, const char *new_folder)
{
    char was[sha256_text_size], is[sha256_text_size], old_path[bisect_path_size], new_path[bisect_path_size];
    f->differs = true;
    if (!f->in_old || !f->in_new) return STATUS_OK;
    snprintf(old_path, sizeof old_path, "%s/%s", old_folder, f->name);
    snprintf(new_path, sizeof new_path, "%s/%s", new_folder, f->name);
    Status status = sha256_file(was, old_path);
    if (status == STATUS_OK) status = sha256_file(is, new_path);
    if (status != STATUS_OK) {
        log_error("regress: bisect: cannot read %s of both folders of tables", f->name);
        return status;
    }
    f->differs = strcmp(was, is) != 0;
    return f->differs && is_csv(f->name) ? find_rows(f, old_path, new_path) : STATUS_OK;
}

Status table_files_read(TableFiles *out, const char *old_folder, const char *new_folder)
{
    TableFiles files = {0};
    Status     status = list(&files, old_folder, "", false, 0);
    if (status == STATUS_OK) status = list(&files, new_folder, "", true, 0);
    if (files.count) qsort(files.file, (size_t)files.count, sizeof *files.file, by_name);
    for (int i = 0; i < files.count && status == STATUS_OK; i++)
        status = compare(&files.file[i], old_folder, new_folder);
    if (status == STATUS_OK) *out = files;
    else table_files_free(&files);
    return status;
}

void table_files_free(TableFiles *files)
{
    for (int i = 0; i < files->count; i++) {
        if (files->file[i].by_rows) row_changes_free(&files->file[i].rows);
        free(files->file[i].name);
    }
    free(files->file);
    *files = (TableFiles){0};
}

/* The name in the folder of tables of a path as a run said it, whose folders may be links; NULL: it is elsewhere. The
 * caller frees it. */
static char *name_in(const char *folder, const char *path)
{
    const size_t n = strlen(folder);
    const char  *slash = strrchr(path, '/');
    char *above = slash ? strndup(path, (size_t)(slash - path)) : NULL, *real = above ? realpath(above, NULL) : NULL;
    char *name = NULL;
    if (real && strncmp(real, folder, n) == 0 && (real[n] == '/' || !real[n]) &&
        asprintf(&name, "%s%s%s", real[n] ? real + n + 1 : "", real[n] ? "/" : "", slash + 1) < 0)
        name = NULL;
    free(above);
    free(real);
    return name;
}

void table_files_note_read(TableFiles *files, const char *folder, const char *stderr_path)
{
    static const char head[] = "table: ";
    char             *text = NULL;
    size_t            octets;
    if (text_read_file(&text, &octets, "regress", stderr_path, file_most) != STATUS_OK) return;
    for (char *line = text, *next; *line; line = next) {
        const size_t length = strcspn(line, "\n");
        next = line + length + (line[length] == '\n');
        line[length] = 0;
        char *end =
            strncmp(line, head, strlen(head)) == 0 ? strrchr(line, ':') : NULL; /* behind it the number of rows */
        if (!end || end < line + strlen(head)) continue;
        *end = 0;
        char      *name = name_in(folder, line + strlen(head));
        TableFile *file = name ? find_file(files, name) : NULL;
        if (file) file->is_read = true;
        free(name);
    }
    free(text);
}
