/* pitviper_settings.c: YAML by libyaml, whose documents know their lines; ranges, units and help by our tables. */
#include "pitviper.h"

#include <errno.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>
#include <yaml.h>

/* ---- one value ------------------------------------------------------------------------------ */

int settings_find(const SettingTable *table, const char *name)
{
    for (int i = 0; i < table->count; i++)
        if (strcmp(table->row[i].name, name) == 0) return i;
    return -1;
}

/* Slips of the finger between two words: a letter more, less, other, or two changed about. Words of 63 letters at most. */
enum { word_size = 64 };
static int slips(const char *a, const char *b)
{
    int       row[3][word_size], n = (int)strlen(b);
    const int m = (int)strlen(a);
    if (m >= word_size || n >= word_size) return word_size;
    for (int j = 0; j <= n; j++) row[0][j] = j;
    for (int i = 1; i <= m; i++) {
        int *now = row[i % 3];
        const int *above = row[(i + 2) % 3], *before = row[(i + 1) % 3];
        now[0] = i;
        for (int j = 1; j <= n; j++) {
            const int other = above[j - 1] + (a[i - 1] != b[j - 1]), missing = above[j] + 1, more = now[j - 1] + 1;
            now[j] = other < missing ? other : missing;
            if (more < now[j]) now[j] = more;
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] && before[j - 2] + 1 < now[j])
                now[j] = before[j - 2] + 1;
        }
    }
    return row[m % 3][n];
}

/* The key that was meant: the nearest of two slips at most, one in short words; or the same key of another section. */
static const char *meant(const SettingTable *table, const char *name)
{
    const char *best = NULL, *point = strrchr(name, '.'), *last = point ? point + 1 : name;
    int         least = strlen(name) < 6 ? 2 : 3;
    for (int i = 0; i < table->count + table->list_count; i++) {
        const char *key = i < table->count ? table->row[i].name : table->list[i - table->count].name;
        const int   n   = slips(name, key);
        if (n < least) {
            least = n;
            best  = key;
        }
    }
    for (int i = 0; !best && i < table->count; i++) {
        const char *dot = strchr(table->row[i].name, '.');
        if (strcmp(last, dot ? dot + 1 : table->row[i].name) == 0) best = table->row[i].name;
    }
    return best;
}

static Status say_unknown(const SettingTable *table, const char *source, const char *name)
{
    char        shown[160];
    const char *best = meant(table, name);
    text_escape(shown, sizeof shown, name, strlen(name));
    log_error("%s: %s: no such key: %s%s%s%s", table->module, source, shown,
              best ? "; did you mean " : table->all_keys ? "; all keys: " : "",
              best ? best : table->all_keys ? table->all_keys : "", best ? "?" : "");
    return STATUS_BAD_VALUE;
}

static bool is_choice(const char *choices, const char *value)
{
    const size_t length = strlen(value);
    if (strchr(value, '|')) return false;
    for (const char *at = choices; at; at = strchr(at, '|'), at = at ? at + 1 : NULL)
        if (strncmp(at, value, length) == 0 && (at[length] == '|' || !at[length])) return true;
    return false;
}

static const char *kind_of(const Setting *row)
{
    switch (row->type) {
    case SETTING_DOUBLE: return "a number";
    case SETTING_NUMBERS: return "numbers";
    default: return "a whole number";
    }
}

static void say_bad(const SettingTable *table, const char *source, const Setting *row, const char *value)
{
    char shown[160];
    text_escape(shown, sizeof shown, value, strnlen(value, sizeof shown));
    if (row->choices)
        log_error("%s: %s: %s: '%s' is not one of %s", table->module, source, row->name, shown, row->choices);
    else if (row->type == SETTING_TEXT || settings_is_path(row))
        log_error("%s: %s: %s: '%s' is longer than %zu characters", table->module, source, row->name, shown,
                  row->size - 1);
    else if (row->type == SETTING_BOOL)
        log_error("%s: %s: %s: '%s' is not true or false", table->module, source, row->name, shown);
    else if (isnan(row->low))
        log_error("%s: %s: %s: '%s' is not %s", table->module, source, row->name, shown, kind_of(row));
    else
        log_error("%s: %s: %s: '%s' is not %s in %.10g .. %.10g%s%s", table->module, source, row->name, shown, kind_of(row),
                  row->low, row->high, *row->unit ? " " : "", row->unit);
}

static bool number_of(double *out, const Setting *row, const char *value)
{
    double number;
    if (!text_to_double(&number, value)) return false;
    if (!isnan(row->low) && !(number >= row->low && number <= row->high)) return false;
    *out = number;
    return true;
}

/* Numbers separated by spaces or commas. */
static bool numbers_of(NumberList *out, const Setting *row, const char *value)
{
    NumberList list = {0};
    char       word[64];
    for (const char *at = value; *(at += strspn(at, " ,"));) {
        const size_t length = strcspn(at, " ,");
        if (length >= sizeof word || list.count == number_list_capacity) return false;
        memcpy(word, at, length);
        word[length] = 0;
        if (!number_of(&list.number[list.count++], row, word)) return false;
        at += length;
    }
    *out = list;
    return true;
}

/* ---- paths ---------------------------------------------------------------------------------- */

bool settings_is_path(const Setting *row)
{
    return row->type == SETTING_PATH || row->type == SETTING_PATHS || row->type == SETTING_NAME_OR_PATH;
}

/* Characters of the folder that paths in this file are relative to, with its slash. A file that is none of a folder's
 * (a pipe, /dev/stdin) has none: they are relative to the current folder. */
static size_t folder_of(const char *file)
{
    struct stat about;
    const char *slash = file ? strrchr(file, '/') : NULL;
    if (!slash || (stat(file, &about) == 0 && !S_ISREG(about.st_mode))) return 0;
    return (size_t)(slash - file) + 1;
}

/* Each path behind the folder it is relative to. False: it does not fit. */
static bool place_paths(char *out, size_t out_size, SettingType type, const char *value, const char *file)
{
    const size_t folder = folder_of(file);
    size_t       n = 0;
    char        *made = calloc(out_size, 1);
    bool         fits = made != NULL;
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
    free(made);
    return fits;
}

/* Of a path that is there its real one; else with the current folder before it. */
static bool absolute(char *out, size_t out_size, const char *path)
{
    char       *real = realpath(path, NULL), here[4096];
    const char *folder = path[0] == '/' || real ? "" : getcwd(here, sizeof here);
    const int   n = folder ? snprintf(out, out_size, "%s%s%s", folder, *folder ? "/" : "", real ? real : path) : -1;
    free(real);
    return n >= 0 && n < (int)out_size;
}

void settings_absolute(void *out, const SettingTable *table)
{
    for (int i = 0; i < table->count; i++) {
        const Setting *row = &table->row[i];
        char          *at = (char *)out + row->offset, *made, one[4096];
        size_t         n = 0;
        if (!settings_is_path(row) || !*at || (row->type == SETTING_NAME_OR_PATH && !strpbrk(at, "/."))) continue;
        if (!(made = calloc(row->size, 1))) return;
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
        free(made);
    }
}

/* ---- one value, stored ----------------------------------------------------------------------- */

/* file: where it stands; NULL: on a command line. */
static Status store(void *out, const SettingTable *table, const Setting *row, const char *value, const char *source,
                    const char *file)
{
    char      *at = (char *)out + row->offset;
    double     number;
    long long  whole;
    NumberList list;
    switch (row->type) {
    case SETTING_DOUBLE:
        if (!number_of(&number, row, value)) break;
        memcpy(at, &number, sizeof number);
        return STATUS_OK;
    case SETTING_INT:
    case SETTING_LONG:
        if (!text_to_long(&whole, value) || !((double)whole >= row->low && (double)whole <= row->high)) break;
        if (row->type == SETTING_LONG) {
            memcpy(at, &whole, sizeof whole);
        } else {
            const int small = (int)whole;
            memcpy(at, &small, sizeof small);
        }
        return STATUS_OK;
    case SETTING_BOOL:
        if (strcmp(value, "true") != 0 && strcmp(value, "false") != 0) break;
        *(bool *)at = value[0] == 't';
        return STATUS_OK;
    case SETTING_PATH:
    case SETTING_PATHS:
    case SETTING_NAME_OR_PATH:
        if (!place_paths(at, row->size, row->type, value, file)) break;
        return STATUS_OK;
    case SETTING_TEXT:
        if (strlen(value) >= row->size || (row->choices && !is_choice(row->choices, value))) break;
        memset(at, 0, row->size);
        strcpy(at, value);
        return STATUS_OK;
    case SETTING_NUMBERS:
        if (!numbers_of(&list, row, value)) break;
        memcpy(at, &list, sizeof list);
        return STATUS_OK;
    }
    say_bad(table, source, row, value);
    return STATUS_BAD_VALUE;
}

Status settings_set(void *out, bool *given, const SettingTable *table, const char *name, const char *value,
                    const char *source)
{
    return settings_set_from(out, given, table, name, value, source, NULL);
}

Status settings_set_from(void *out, bool *given, const SettingTable *table, const char *name, const char *value,
                         const char *source, const char *file)
{
    const int row = settings_find(table, name);
    if (row < 0) return say_unknown(table, source, name);
    const Status status = store(out, table, &table->row[row], value, source, file);
    if (status == STATUS_OK && given) given[row] = true;
    return status;
}

/* ---- a file --------------------------------------------------------------------------------- */

typedef struct Reading {
    const char      *path, *file; /* file: whose folder paths are relative to */
    yaml_document_t *document;
} Reading;

enum { key_size = 160, source_size = 512 };

static int line_of(const yaml_node_t *node) { return (int)node->start_mark.line + 1; }

static const char *text_of(const yaml_node_t *node)
{
    const char *text = (const char *)node->data.scalar.value;
    return strlen(text) == node->data.scalar.length ? text : "\\0"; /* a NUL inside: no value of ours */
}

/* [1, 2, [3, 4]] as numbers in a row. */
static bool flatten(NumberList *out, const Reading *r, const Setting *row, const yaml_node_t *node, int depth)
{
    if (node->type == YAML_SCALAR_NODE)
        return out->count < number_list_capacity && number_of(&out->number[out->count++], row, text_of(node));
    if (node->type != YAML_SEQUENCE_NODE || depth == 2) return false;
    for (const yaml_node_item_t *item = node->data.sequence.items.start; item < node->data.sequence.items.top; item++)
        if (!flatten(out, r, row, yaml_document_get_node(r->document, *item), depth + 1)) return false;
    return true;
}

static Status fill_value(void *out, const Reading *r, const SettingTable *table, const Setting *row,
                         const yaml_node_t *value, const char *source)
{
    if (row->type == SETTING_NUMBERS && value->type == YAML_SEQUENCE_NODE) {
        NumberList list = {0};
        if (!flatten(&list, r, row, value, 0)) {
            char range[64] = "";
            if (!isnan(row->low)) snprintf(range, sizeof range, " in %g .. %g %s", row->low, row->high, row->unit);
            log_error("%s: %s: %s: needs a list of at most %d numbers%s", table->module, source, row->name,
                      number_list_capacity, range);
            return STATUS_BAD_VALUE;
        }
        memcpy((char *)out + row->offset, &list, sizeof list);
        return STATUS_OK;
    }
    if (value->type != YAML_SCALAR_NODE) {
        log_error("%s: %s: %s needs one value", table->module, source, row->name);
        return STATUS_BAD_VALUE;
    }
    return store(out, table, row, text_of(value), source, r->file);
}

/* Ends: an item's table holds only lists that are written in the program, whatever aliases a file has. */
static Status fill_mapping(void *out, bool *given, bool *seen, const Reading *r, const SettingTable *table,
                           const char *section, const yaml_node_t *mapping);

static Status fill_list(void *out, const Reading *r, const SettingTable *table, const SettingList *list,
                        const yaml_node_t *sequence)
{
    const yaml_node_item_t *at = sequence->data.sequence.items.start, *end = sequence->data.sequence.items.top;
    for (; at < end; at++) {
        const yaml_node_t *node = yaml_document_get_node(r->document, *at);
        if (node->type != YAML_MAPPING_NODE) {
            log_error("%s: %s:%d: %s: expected `- key: value` and more keys below", table->module, r->path,
                      line_of(node), list->name);
            return STATUS_BAD_VALUE;
        }
        errno = 0;
        void *item = list->add(out);
        if (!item && errno == ENOMEM) return STATUS_NO_MEMORY;
        bool *seen = calloc((size_t)(list->item->count + list->item->list_count), sizeof *seen);
        if (!item || !seen) {
            if (!item) log_error("%s: %s:%d: %s: no room for more", table->module, r->path, line_of(node), list->name);
            free(seen);
            return item ? STATUS_NO_MEMORY : STATUS_BAD_VALUE;
        }
        if (list->item->line_at) *(int *)((char *)item + list->item->line_at) = line_of(node);
        const Status status = fill_mapping(item, NULL, seen, r, list->item, "", node);
        free(seen);
        if (status != STATUS_OK) return status;
    }
    return STATUS_OK;
}

/* Which list a key names; -1: none. */
static int find_list(const SettingTable *table, const char *name)
{
    for (int i = 0; i < table->list_count; i++)
        if (strcmp(table->list[i].name, name) == 0) return i;
    return -1;
}

static bool is_section(const SettingTable *table, const char *name)
{
    const size_t length = strlen(name);
    for (int i = 0; i < table->count; i++)
        if (strncmp(table->row[i].name, name, length) == 0 && table->row[i].name[length] == '.') return true;
    return false;
}

static Status fill_key(void *out, bool *given, bool *seen, const Reading *r, const SettingTable *table,
                       const char *section, const yaml_node_t *name, const yaml_node_t *value)
{
    char full[key_size], source[source_size];
    snprintf(source, sizeof source, "%s:%d", r->path, line_of(name));
    if (name->type != YAML_SCALAR_NODE) {
        log_error("%s: %s: a key must be a word", table->module, source);
        return STATUS_BAD_VALUE;
    }
    const char *word = text_of(name);
    if (value->type == YAML_MAPPING_NODE && !*section && is_section(table, word))
        return fill_mapping(out, given, seen, r, table, word, value);
    /* `section:` with nothing below it */
    if (value->type == YAML_SCALAR_NODE && !*section && !*text_of(value) && is_section(table, word)) return STATUS_OK;

    snprintf(full, sizeof full, "%s%s%s", section, *section ? "." : "", word);
    const int list = find_list(table, full), row = settings_find(table, full);
    if (row < 0 && list < 0) return say_unknown(table, source, full);
    bool *met = &seen[row >= 0 ? row : table->count + list];
    if (*met) {
        log_error("%s: %s: %s is given twice", table->module, source, full);
        return STATUS_BAD_VALUE;
    }
    *met = true;
    if (list >= 0) {
        if (value->type == YAML_SEQUENCE_NODE) return fill_list(out, r, table, &table->list[list], value);
        log_error("%s: %s: %s: expected a list, `- key: value` and more keys below", table->module, source, full);
        return STATUS_BAD_VALUE;
    }
    const Status status = fill_value(out, r, table, &table->row[row], value, source);
    if (status == STATUS_OK && given) given[row] = true;
    return status;
}

static Status fill_mapping(void *out, bool *given, bool *seen, const Reading *r, const SettingTable *table,
                           const char *section, const yaml_node_t *mapping)
{
    const yaml_node_pair_t *pair = mapping->data.mapping.pairs.start, *end = mapping->data.mapping.pairs.top;
    for (; pair < end; pair++) {
        const Status status = fill_key(out, given, seen, r, table, section,
                                       yaml_document_get_node(r->document, pair->key),
                                       yaml_document_get_node(r->document, pair->value));
        if (status != STATUS_OK) return status;
    }
    return STATUS_OK;
}

static Status fill_document(void *out, bool *given, const SettingTable *table, const char *path, const char *file,
                            yaml_document_t *document)
{
    const yaml_node_t *root = yaml_document_get_root_node(document);
    const Reading      reading = {path, file, document};
    if (!root) return STATUS_OK;
    if (root->type != YAML_MAPPING_NODE) {
        log_error("%s: %s:%d: expected `section:` and keys below it", table->module, path, line_of(root));
        return STATUS_BAD_VALUE;
    }
    bool *seen = calloc((size_t)(table->count + table->list_count), sizeof *seen);
    if (!seen) return STATUS_NO_MEMORY;
    const Status status = fill_mapping(out, given, seen, &reading, table, "", root);
    free(seen);
    return status;
}

static Status parse(void *out, bool *given, const SettingTable *table, const char *path, const char *file,
                    const char *text, size_t octets)
{
    yaml_parser_t   parser;
    yaml_document_t document;
    Status          status = yaml_check(table->module, path, text, octets);
    if (status != STATUS_OK) return status;
    if (!yaml_parser_initialize(&parser)) return STATUS_NO_MEMORY;
    yaml_parser_set_input_string(&parser, (const unsigned char *)text, octets);
    if (!yaml_parser_load(&parser, &document)) {
        log_error("%s: %s:%d: %s", table->module, path, (int)parser.problem_mark.line + 1,
                  parser.problem ? parser.problem : "not YAML");
        yaml_parser_delete(&parser);
        return STATUS_BAD_VALUE;
    }
    status = fill_document(out, given, table, path, file, &document);
    yaml_document_delete(&document);
    yaml_parser_delete(&parser);
    return status;
}

Status settings_read(void *out, bool *given, const SettingTable *table, const char *path)
{
    return settings_read_as(out, given, table, path, path);
}

Status settings_read_as(void *out, bool *given, const SettingTable *table, const char *path, const char *file)
{
    char  *text;
    size_t octets;
    Status status = text_read_file(&text, &octets, table->module, path, settings_file_octets);
    if (status != STATUS_OK) return status;
    status = parse(out, given, table, path, file, text, octets);
    free(text);
    if (status == STATUS_OK) log_detail("%s: read %s", table->module, path);
    return status;
}

static int line_in(const SettingTable *table, yaml_document_t *document, const char *section, const char *name,
                   const yaml_node_t *mapping)
{
    const yaml_node_pair_t *pair = mapping->data.mapping.pairs.start, *end = mapping->data.mapping.pairs.top;
    int                     line = 0;
    for (; pair < end && line == 0; pair++) {
        char               full[key_size];
        const yaml_node_t *key = yaml_document_get_node(document, pair->key);
        const yaml_node_t *value = yaml_document_get_node(document, pair->value);
        if (key->type != YAML_SCALAR_NODE) continue;
        snprintf(full, sizeof full, "%s%s%s", section, *section ? "." : "", text_of(key));
        if (strcmp(full, name) == 0) line = line_of(key);
        else if (!*section && value->type == YAML_MAPPING_NODE && is_section(table, full))
            line = line_in(table, document, full, name, value);
    }
    return line;
}

int settings_line(const SettingTable *table, const char *name, const char *path)
{
    char           *text;
    size_t          octets;
    yaml_parser_t   parser;
    yaml_document_t document;
    int             line = 0;
    if (text_read_file(&text, &octets, table->module, path, settings_file_octets) != STATUS_OK) return 0;
    if (yaml_check(table->module, path, text, octets) == STATUS_OK && yaml_parser_initialize(&parser)) {
        yaml_parser_set_input_string(&parser, (const unsigned char *)text, octets);
        if (yaml_parser_load(&parser, &document)) {
            const yaml_node_t *root = yaml_document_get_root_node(&document);
            if (root && root->type == YAML_MAPPING_NODE) line = line_in(table, &document, "", name, root);
            yaml_document_delete(&document);
        }
        yaml_parser_delete(&parser);
    }
    free(text);
    return line;
}

/* ---- out again ------------------------------------------------------------------------------ */

/* As it reads back; returns what snprintf does. */
static int value_text(char *out, size_t out_size, const Setting *row, const void *from, const char *number_format)
{
    const char *at = (const char *)from + row->offset;
    double      number;
    long long   whole;
    int         small, n = 0;
    const NumberList *list;
    switch (row->type) {
    case SETTING_DOUBLE:
        memcpy(&number, at, sizeof number);
        return snprintf(out, out_size, number_format, number);
    case SETTING_INT:
        memcpy(&small, at, sizeof small);
        return snprintf(out, out_size, "%d", small);
    case SETTING_LONG:
        memcpy(&whole, at, sizeof whole);
        return snprintf(out, out_size, "%lld", whole);
    case SETTING_BOOL: return snprintf(out, out_size, "%s", *(const bool *)at ? "true" : "false");
    case SETTING_TEXT:
    case SETTING_PATH:
    case SETTING_PATHS:
    case SETTING_NAME_OR_PATH: return snprintf(out, out_size, "%s", at);
    case SETTING_NUMBERS:
        list = (const NumberList *)at;
        n    = snprintf(out, out_size, "[");
        for (int i = 0; i < list->count; i++) {
            n += snprintf(out + n, (size_t)n < out_size ? out_size - (size_t)n : 0, "%s", i ? ", " : "");
            n += snprintf(out + n, (size_t)n < out_size ? out_size - (size_t)n : 0, number_format, list->number[i]);
        }
        return n + snprintf(out + n, (size_t)n < out_size ? out_size - (size_t)n : 0, "]");
    }
    return 0;
}

enum { value_size = 32 * number_list_capacity }; /* more than any text */

void settings_text(char *out, size_t out_size, const SettingTable *table, const void *from)
{
    char   value[value_size];
    size_t n = 0;
    *out = 0;
    for (int i = 0; i < table->count && n < out_size; i++) {
        value_text(value, sizeof value, &table->row[i], from, "%.17g");
        n += (size_t)snprintf(out + n, out_size - n, "%s=%s\n", table->row[i].name, value);
    }
}

/* The shortest of 6, 9 or 17 digits that reads back as the same number. */
static void readable(char *out, size_t out_size, const Setting *row, const void *from)
{
    static const char *const formats[] = {"%g", "%.9g", "%.17g"};
    double want, got;
    for (int i = 0; i < 3; i++) {
        value_text(out, out_size, row, from, formats[i]);
        if (row->type != SETTING_DOUBLE) return;
        memcpy(&want, (const char *)from + row->offset, sizeof want);
        if (text_to_double(&got, out) && got == want) return;
    }
}

/* Words that YAML takes as they stand. */
static bool is_plain(const char *text)
{
    if (!*text || strchr("-?:,[]{}#&*!|>'\"%@` ", text[0])) return false;
    return !strstr(text, ": ") && !strstr(text, " #") && text[strlen(text) - 1] != ' ';
}

static void put_quoted(FILE *to, const char *text)
{
    fputc('\'', to);
    for (; *text; text++) fputs(*text == '\'' ? "\'\'" : (const char[]){*text, 0}, to);
    fputc('\'', to);
}

void settings_write(FILE *to, const SettingTable *table, const void *from, const bool *shown)
{
    char value[value_size], section[64] = "";
    for (int i = 0; i < table->count; i++) {
        const Setting *row   = &table->row[i];
        const char    *point = strchr(row->name, '.'), *key = point ? point + 1 : row->name;
        const size_t   length = point ? (size_t)(point - row->name) : 0;
        const char    *indent = point ? "  " : "";
        double         number = 0;
        if (strncmp(section, row->name, length) != 0 || section[length]) {
            snprintf(section, sizeof section, "%.*s", (int)length, row->name);
            if (length) fprintf(to, "\n%s:\n", section);
            else fputc('\n', to);
        }
        fprintf(to, "%s# %s", indent, row->help);
        if (row->choices) fprintf(to, "%s%s", *row->help ? "; " : "", row->choices);
        else if (row->type == SETTING_BOOL) fprintf(to, "%strue or false", *row->help ? "; " : "");
        else if (row->type != SETTING_TEXT && !settings_is_path(row) && !isnan(row->low))
            fprintf(to, "%s%g .. %g%s%s", *row->help ? "; " : "", row->low, row->high, *row->unit ? " " : "",
                    row->unit);
        else if (*row->unit) fprintf(to, "%s%s", *row->help ? "; " : "", row->unit);
        fputc('\n', to);

        readable(value, sizeof value, row, from);
        if (row->type == SETTING_DOUBLE) memcpy(&number, (const char *)from + row->offset, sizeof number);
        const bool unset = isnan(number), hidden = unset || (shown && !shown[i]);
        fprintf(to, "%s%s%s:%s", indent, hidden ? "# " : "", key, unset ? "" : " ");
        if ((row->type == SETTING_TEXT || settings_is_path(row)) && !is_plain(value)) put_quoted(to, value);
        else fputs(unset ? "" : value, to);
        fputc('\n', to);
    }
}
