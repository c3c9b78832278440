/* sensor/verify/bisect/differences.c: in what OLD and NEW differ: programs, files and rows of tables, keys of settings.
 */
#include "sensor/verify/bisect/bisect_private.h"
#include "pitviper_sha256.h"

#include <stdlib.h>

/* ---- the list ------------------------------------------------------------------------------------- */

/* part: of level_parts; file: of level_files. */
static Status add(Differences *d, Difference one, int part, int file)
{
    if (d->count == differences_most) {
        log_error("regress: bisect: more than %d differences; bring the two versions nearer", differences_most);
        return STATUS_BAD_VALUE;
    }
    if (d->count % 256 == 0) {
        Difference *more = realloc(d->difference, (size_t)(d->count + 256) * sizeof *more);
        if (!more) return STATUS_NO_MEMORY;
        d->difference = more;
    }
    one.group[level_parts] = part;
    one.group[level_files] = file;
    one.group[level_all] = d->count;
    d->difference[d->count++] = one;
    return STATUS_OK;
}

static Status add_tables(Differences *d)
{
    const int room = differences_most / 2; /* beyond, a file is tried as a whole */
    Status    status = table_files_read(&d->tables, d->old.tables, d->new.tables);
    for (int i = 0; i < d->tables.count && status == STATUS_OK; i++) {
        TableFile *f = &d->tables.file[i];
        if (!f->differs) continue;
        if (f->by_rows && d->count + f->rows.count > room) {
            row_changes_free(&f->rows);
            f->by_rows = false;
            f->whole = "the tables differ in too many rows";
        }
        if (!f->by_rows) status = add(d, (Difference){.kind = OF_FILE, .file = i}, 1, 2 + i);
        for (int row = 0; f->by_rows && row < f->rows.count && status == STATUS_OK; row++)
            status = add(d, (Difference){.kind = OF_ROW, .file = i, .row = row}, 1, 2 + i);
    }
    return status;
}

static Status add_programs(Differences *d, bool generator)
{
    char   was[sha256_text_size], is[sha256_text_size];
    Status status = sha256_file(was, d->old.program);
    if (status == STATUS_OK) status = sha256_file(is, d->new.program);
    if (status != STATUS_OK) {
        log_error("regress: bisect: cannot read the programs %s and %s", d->old.given, d->new.given);
        return status;
    }
    if (strcmp(was, is) != 0) {
        status = add(d, (Difference){.kind = OF_PROGRAM}, 0, 0);
        if (status == STATUS_OK && generator) status = add(d, (Difference){.kind = OF_GENERATOR}, 0, 1);
    }
    return status == STATUS_OK ? add_tables(d) : status;
}

/* ---- settings ------------------------------------------------------------------------------------- */

/* Keys that change no image, but write, send or listen somewhere. */
static bool is_apart(const char *key)
{
    static const char *const apart[] = {"network.", "publish.", "record.", "cache."};
    for (size_t i = 0; i < sizeof apart / sizeof *apart; i++)
        if (strncmp(key, apart[i], strlen(apart[i])) == 0) return true;
    return false;
}

/* The settings of the case, as replay reads them. */
static Status read_case(Config *out, const Case *c)
{
    char path[case_path_size + 32], named[case_path_size], reason[256];
    *out = config_default();
    snprintf(path, sizeof path, "%.4080s/case.yaml", c->folder);
    if (*c->config_file) {
        if (case_path(named, reason, c, c->config_file)) return config_read(out, named);
        log_error("regress: %s: config_file: %s", path, reason);
        return STATUS_BAD_VALUE;
    }
    if (!*c->config) return STATUS_OK;
    return config_parse(out, c->config, path);
}

static Status add_keys(Differences *d, const Case *c)
{
    char   was[config_value_size], is[config_value_size];
    Config of_case;
    Status status = read_case(&of_case, c);
    d->from = d->to = of_case;
    if (status == STATUS_OK) status = config_read(&d->from, d->old.settings);
    if (status == STATUS_OK) status = config_read(&d->to, d->new.settings);
    for (int key = 0; key < config_keys() && status == STATUS_OK; key++) {
        if (is_apart(config_key(key))) {
            config_take(&d->from, &of_case, key);
            config_take(&d->to, &of_case, key);
            continue;
        }
        config_value(was, &d->from, key);
        config_value(is, &d->to, key);
        if (strcmp(was, is) == 0 && d->from.given[key] == d->to.given[key]) continue;
        status = add(d, (Difference){.kind = OF_KEY, .key = key}, 2, 2 + key);
    }
    return status;
}

Status differences_find(Differences *d, const Case *c, bool generator)
{
    Status status = d->old.kind == SIDE_PROGRAM  ? add_programs(d, generator)
                    : d->old.kind == SIDE_TABLES ? add_tables(d)
                                                 : add_keys(d, c);
    if (status == STATUS_NO_MEMORY) log_error("regress: bisect: out of memory");
    return status;
}

void differences_free(Differences *d)
{
    table_files_free(&d->tables);
    free(d->difference);
    d->difference = NULL;
    d->count = 0;
}

/* ---- in words ----------------------------------------------------------------------------------- */

static void say_file(char *out, size_t out_size, const Differences *d, const Difference *one)
{
    const TableFile *f = &d->tables.file[one->file];
    if (!f->in_old) snprintf(out, out_size, "table %.200s, which is new", f->name);
    else if (!f->in_new) snprintf(out, out_size, "table %.200s, which was removed", f->name);
    else if (f->whole) snprintf(out, out_size, "table %.200s (as a whole: %s)", f->name, f->whole);
    else if (f->by_rows)
        snprintf(out, out_size, "table %.200s, %d row%s", f->name, f->rows.count, f->rows.count == 1 ? "" : "s");
    else snprintf(out, out_size, "table %.200s", f->name);
}

static void say_key(char *out, size_t out_size, const Differences *d, int key)
{
    char was[config_value_size], is[config_value_size];
    config_value(was, &d->from, key);
    config_value(is, &d->to, key);
    if (strcmp(was, is) != 0) snprintf(out, out_size, "setting %s is '%.150s', was '%.150s'", config_key(key), is, was);
    else
        snprintf(out, out_size, "setting %s is %s as '%.150s', its default", config_key(key),
                 d->to.given[key] ? "given" : "no longer given", is);
}

void differences_say(char *out, size_t out_size, const Differences *d, int index, int level)
{
    char              row[600];
    const Difference *one = &d->difference[index];
    const bool        tables = one->kind == OF_FILE || one->kind == OF_ROW;
    if (level == level_parts && one->kind != OF_KEY) snprintf(out, out_size, tables ? "its tables" : "the program");
    else if (one->kind == OF_PROGRAM) snprintf(out, out_size, "the program that renders (replay)");
    else if (one->kind == OF_GENERATOR) snprintf(out, out_size, "the program that makes the exercise (exercise)");
    else if (one->kind == OF_KEY) say_key(out, out_size, d, one->key);
    else if (one->kind == OF_FILE || level == level_files) say_file(out, out_size, d, one);
    else {
        row_changes_say(row, sizeof row, &d->tables.file[one->file].rows, one->row);
        snprintf(out, out_size, "table %.200s, %s", d->tables.file[one->file].name, row);
    }
}
