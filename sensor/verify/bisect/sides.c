/* sensor/verify/bisect/sides.c: what OLD and NEW name on the command line of a bisection. */
#include "sensor/verify/bisect/bisect_private.h"

#include <errno.h>
#include <stdlib.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

const char *side_kind_name(SideKind kind)
{
    static const char *const names[] = {"programs", "tables", "settings"};
    return names[kind];
}

/* FOLDER/name as an absolute path, where it is a file (or an executable, or a folder). */
static bool find(char out[case_path_size], const char *folder, const char *name, int mode)
{
    char        path[case_path_size];
    struct stat about;
    if (snprintf(path, sizeof path, "%s/%s", folder, name) >= (int)sizeof path) return false;
    char      *real = realpath(path, NULL);
    const bool is = real && strlen(real) < case_path_size && stat(real, &about) == 0 && access(real, mode) == 0 &&
                    (S_ISREG(about.st_mode) || S_ISDIR(about.st_mode));
    if (is) strcpy(out, real);
    free(real);
    return is;
}

static void cut_last(char *path)
{
    char *slash = strrchr(path, '/');
    if (slash) *slash = 0;
}

/* A folder of tables is known by its catalog. */
static bool tables_in(char out[case_path_size], const char *folder, const char *below)
{
    char name[64], catalog[case_path_size];
    snprintf(name, sizeof name, "%s%scatalog.csv", below, *below ? "/" : "");
    if (!find(catalog, folder, name, R_OK)) return false;
    snprintf(name, sizeof name, "%s", *below ? below : ".");
    return find(out, folder, name, R_OK);
}

static Status open_folder(Side *s)
{
    static const char *const programs[] = {"pitviper", "bin/pitviper"}, *const below[] = {"", "share/pitviper", "etc"};
    struct stat about;
    for (int i = 0; i < 2; i++)
        if (find(s->program, s->given, programs[i], X_OK) && stat(s->program, &about) == 0 && S_ISREG(about.st_mode)) {
            s->kind = SIDE_PROGRAM;
            return STATUS_OK;
        }
    for (int i = 0; i < 3; i++)
        if (tables_in(s->tables, s->given, below[i])) {
            s->kind = SIDE_TABLES;
            return STATUS_OK;
        }
    log_error("regress: bisect: %s: holds neither a program (pitviper, bin/pitviper) nor tables (catalog.csv, "
              "share/pitviper/catalog.csv); name an installation, a build folder, or a folder of tables such as etc",
              s->given);
    return STATUS_BAD_VALUE;
}

/* An executable that is not named as settings are. */
static bool is_program(const char *path)
{
    const char *dot = strrchr(path, '.');
    return access(path, X_OK) == 0 && !(dot && (strcasecmp(dot, ".yaml") == 0 || strcasecmp(dot, ".yml") == 0));
}

Status side_open(Side *out, const char *given, const char *tables)
{
    Side        s = {.given = given};
    struct stat about;
    Status      status = STATUS_OK;
    char       *real = realpath(given, NULL);
    if (!real || stat(real, &about) != 0) {
        log_error("regress: bisect: %s: %s; name a program, a folder of tables, or a file of settings", given,
                  strerror(errno));
        free(real);
        return STATUS_BAD_VALUE;
    }
    if (strlen(real) > case_path_size - 300) {
        log_error("regress: bisect: %.200s...: the path is too long; change to a nearer folder", given);
        status = STATUS_BAD_VALUE;
    } else if (S_ISDIR(about.st_mode)) {
        status = open_folder(&s);
    } else if (!S_ISREG(about.st_mode)) {
        log_error("regress: bisect: %s: is no regular file or folder; name a program, a folder of tables, or a file of "
                  "settings",
                  given);
        status = STATUS_BAD_VALUE;
    } else {
        s.kind = is_program(real) ? SIDE_PROGRAM : SIDE_SETTINGS;
        strcpy(s.kind == SIDE_PROGRAM ? s.program : s.settings, real);
    }
    free(real);
    if (status == STATUS_OK && tables && s.kind == SIDE_PROGRAM && !tables_in(s.tables, tables, "")) {
        log_error("regress: bisect: %s: is no folder of tables: it has no catalog.csv; name one such as etc or "
                  "share/pitviper",
                  tables);
        status = STATUS_BAD_VALUE;
    }
    if (status == STATUS_OK) *out = s;
    return status;
}

Status side_find_tables(Side *side, const char *stderr_path, const char *option)
{
    static const char head[] = "table: ", tail[] = "/channels.csv: ";
    char             *text = NULL, beside[case_path_size];
    size_t            octets;
    if (*side->tables) return STATUS_OK;
    const Status status = text_read_file(&text, &octets, "regress", stderr_path, 64 << 20);
    if (status != STATUS_OK) return status;
    for (char *line = text; *line && !*side->tables;) {
        const size_t length = strcspn(line, "\n");
        char        *next = line + length + (line[length] == '\n');
        line[length] = 0;
        char *end = strncmp(line, head, strlen(head)) == 0 ? strstr(line, tail) : NULL;
        if (end) {
            *end = 0;
            if (!tables_in(side->tables, line + strlen(head), "")) *side->tables = 0;
        }
        line = next;
    }
    free(text);
    if (*side->tables) return STATUS_OK;
    snprintf(beside, sizeof beside, "%s", side->program);
    cut_last(beside);
    cut_last(beside);
    if (tables_in(side->tables, beside, "share/pitviper")) return STATUS_OK;
    log_error("regress: bisect: %s does not say where its tables are; name their folder with %s", side->given, option);
    return STATUS_BAD_VALUE;
}
