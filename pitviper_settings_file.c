/* pitviper_settings_file.c: YAML files: the subset that is allowed, and a file into a struct by its table; libyaml
 * keeps line numbers for messages. */

#include "pitviper_settings_private.h"
#include "pitviper_file.h"

#include <errno.h>
#include <stdlib.h>
#include <yaml.h>

/* ---- the subset of YAML that input files may use, checked before parsing ----------------------- */

/* The time of libyaml is quadratic in the depth of nesting, the number of anchors and the number of directives:
 * seconds, or hours, for a megabyte. */
enum { most_depth = 32, most_anchors = 256, most_directives = 8 };

typedef struct Tally {
    int depth, anchors, documents;
} Tally;

static const char *too_much(Tally *tally, const yaml_event_t *event)
{
    const yaml_char_t *anchor = NULL;
    switch (event->type) {
    case YAML_DOCUMENT_START_EVENT:
        tally->documents++;
        break;
    case YAML_SCALAR_EVENT:
        anchor = event->data.scalar.anchor;
        break;
    case YAML_SEQUENCE_START_EVENT:
        anchor = event->data.sequence_start.anchor, tally->depth++;
        break;
    case YAML_MAPPING_START_EVENT:
        anchor = event->data.mapping_start.anchor, tally->depth++;
        break;
    case YAML_SEQUENCE_END_EVENT:
    case YAML_MAPPING_END_EVENT:
        tally->depth--;
        break;
    default:
        break;
    }
    tally->anchors += anchor != NULL;
    return tally->depth > most_depth       ? "lists and mappings nest deeper than 32"
           : tally->anchors > most_anchors ? "more than 256 anchors"
           : tally->documents > 1          ? "a second document; only one is read"
                                           : NULL;
}

Status yaml_check(const char *module, const char *path, const char *text, size_t octets)
{
    yaml_parser_t parser;
    yaml_event_t  event;
    Tally         tally = {0};
    const char   *reason = NULL;
    int           line = 1, directives = 0;
    bool          more = true;
    Status        status = STATUS_OK;

    for (size_t i = 0; i < octets && !reason; i++) {
        directives += text[i] == '%' && (i == 0 || strchr("\r\n", text[i - 1]));
        reason = !text[i] ? "holds a NUL octet; is it UTF-8 text?" : NULL;
        if (directives > most_directives) reason = "more than 8 directives";
        line += text[i] == '\n';
    }
    if (!reason) {
        if (!yaml_parser_initialize(&parser)) return STATUS_NO_MEMORY;
        yaml_parser_set_input_string(&parser, (const unsigned char *)text, octets);
        while (more && !reason && (more = yaml_parser_parse(&parser, &event))) {
            more = event.type != YAML_STREAM_END_EVENT;
            reason = too_much(&tally, &event);
            line = (int)event.start_mark.line + 1;
            yaml_event_delete(&event);
        }
        if (parser.error == YAML_MEMORY_ERROR) status = STATUS_NO_MEMORY;
        else if (parser.error) reason = parser.problem, line = (int)parser.problem_mark.line + 1;
        yaml_parser_delete(&parser);
    }
    if (!reason) return status;
    log_error("%s: %s:%d: %s", module, path, line, reason);
    return STATUS_BAD_VALUE;
}

/* ---- values ------------------------------------------------------------------------------------ */

typedef struct Reading {
    const char      *path, *file; /* file: paths are relative to its folder */
    yaml_document_t *document;
    int             *wrong; /* number of values refused so far; all are reported, up to most_wrong */
} Reading;

enum { key_size = 160, source_size = 512, words_size = 512, list_size = 4096, most_wrong = 50 };

/* Whether reading goes on after a value with this status. *worst becomes the status of the whole. */
static bool goes_on(Status *worst, const Reading *r, Status status)
{
    if (status == STATUS_OK) return true;
    *worst = status;
    return status == STATUS_BAD_VALUE && ++*r->wrong < most_wrong;
}

static int line_of(const yaml_node_t *node) { return (int)node->start_mark.line + 1; }

static bool holds_nul(const yaml_node_t *node)
{
    return strlen((const char *)node->data.scalar.value) != node->data.scalar.length;
}

static const char *text_of(const yaml_node_t *node)
{
    return holds_nul(node) ? "\\0" : (const char *)node->data.scalar.value; /* a NUL inside makes the value invalid */
}

/* The node's text, for messages. */
static const char *shown(const yaml_node_t *node)
{
    return node->type == YAML_MAPPING_NODE ? "{...}" : node->type == YAML_SEQUENCE_NODE ? "[...]" : text_of(node);
}

/* Reads [1, 2, [3, 4]] as numbers in a row. */
static bool flatten(NumberList *out, const Reading *r, const Setting *row, const yaml_node_t *node, int depth)
{
    if (node->type == YAML_SCALAR_NODE)
        return out->count < number_list_capacity && settings_number(&out->number[out->count++], row, text_of(node));
    if (node->type != YAML_SEQUENCE_NODE || depth == 2) return false;
    for (const yaml_node_item_t *item = node->data.sequence.items.start; item < node->data.sequence.items.top; item++)
        if (!flatten(out, r, row, yaml_document_get_node(r->document, *item), depth + 1)) return false;
    return true;
}

static Status fill_numbers(void *out, const Reading *r, const SettingTable *table, const Setting *row,
                           const yaml_node_t *value, const char *source)
{
    NumberList list = {0};
    if (!flatten(&list, r, row, value, 0)) {
        char range[64] = "";
        if (!isnan(row->low)) snprintf(range, sizeof range, " in %g .. %g %s", row->low, row->high, row->unit);
        log_error("%s: %s: %s%s: needs a list of at most %d numbers%s", table->module, source, settings_prefix(table),
                  row->name, number_list_capacity, range);
        return STATUS_BAD_VALUE;
    }
    memcpy((char *)out + row->offset, &list, sizeof list);
    return STATUS_OK;
}

/* ---- keys read by the table itself -------------------------------------------------------------- */

static Status say_own(const Reading *r, const SettingTable *table, const Setting *row, const yaml_node_t *node,
                      const char *complaint)
{
    char text[160];
    text_escape(text, sizeof text, shown(node), strnlen(shown(node), 60));
    log_error("%s: %s:%d: %s%s: '%s' is %s%s", table->module, r->path, line_of(node), settings_prefix(table), row->name,
              text, complaint ? complaint : "not ", complaint ? "" : row->choices);
    return STATUS_BAD_VALUE;
}

/* Fills one key. key: that of an entry of a map; else NULL. words: taken instead of the value's text. */
static Status fill_one(void *out, const Reading *r, const SettingTable *table, const Setting *row,
                       const yaml_node_t *key, const yaml_node_t *value, const char *words)
{
    const yaml_node_t *part[2] = {value, key};
    SettingValue       v = {.text = words, .line = line_of(key ? key : value)};
    const char        *complaint = NULL;
    for (int i = 0; i < (key ? 2 : 1); i++)
        if (!(i == 0 && words) && (part[i]->type != YAML_SCALAR_NODE || holds_nul(part[i])))
            return say_own(r, table, row, part[i], NULL);
    if (!words) v.text = text_of(value);
    if (key) v.key = text_of(key);
    const Status status = table->own(&complaint, out, row, &v);
    return status == STATUS_BAD_VALUE ? say_own(r, table, row, v.wrong_key ? key : value, complaint) : status;
}

/* Joins a list of words to one text with blanks between; returns false where it is not a list of words. */
static bool join(char out[words_size], const Reading *r, const yaml_node_t *sequence)
{
    size_t n = 0;
    *out = 0;
    for (const yaml_node_item_t *item = sequence->data.sequence.items.start; item < sequence->data.sequence.items.top;
         item++) {
        const yaml_node_t *node = yaml_document_get_node(r->document, *item);
        if (node->type != YAML_SCALAR_NODE || holds_nul(node) || strpbrk(text_of(node), " \t")) return false;
        n += (size_t)snprintf(out + n, words_size - n, "%s%s", n ? " " : "", text_of(node));
        if (n >= words_size) return false;
    }
    return true;
}

static Status fill_own(void *out, const Reading *r, const SettingTable *table, const Setting *row,
                       const yaml_node_t *value)
{
    char       words[words_size];
    const bool list = value->type == YAML_SEQUENCE_NODE, map = value->type == YAML_MAPPING_NODE;
    Status     status = STATUS_OK;
    if (map != (row->type == SETTING_MAP) || (list && row->type == SETTING_OWN && !join(words, r, value)))
        return say_own(r, table, row, value, NULL);
    if (map) {
        for (const yaml_node_pair_t *pair = value->data.mapping.pairs.start;
             pair < value->data.mapping.pairs.top &&
             goes_on(&status, r,
                     fill_one(out, r, table, row, yaml_document_get_node(r->document, pair->key),
                              yaml_document_get_node(r->document, pair->value), NULL));
             pair++) {
        }
    } else if (list && row->type == SETTING_EACH) {
        for (const yaml_node_item_t *item = value->data.sequence.items.start;
             item < value->data.sequence.items.top &&
             goes_on(&status, r, fill_one(out, r, table, row, NULL, yaml_document_get_node(r->document, *item), NULL));
             item++) {
        }
    } else {
        status = fill_one(out, r, table, row, NULL, value, list ? words : NULL);
    }
    return status;
}

/* ---- keys ---------------------------------------------------------------------------------------- */

/* `[a, b]` of a key that takes `a,b`: its texts with commas between. */
static Status fill_listed(void *out, const Reading *r, const SettingTable *table, const Setting *row,
                          const yaml_node_t *sequence, const char *source)
{
    char   list[list_size] = "";
    size_t n = 0;
    for (const yaml_node_item_t *item = sequence->data.sequence.items.start; item < sequence->data.sequence.items.top;
         item++) {
        const yaml_node_t *node = yaml_document_get_node(r->document, *item);
        const char        *text = node->type == YAML_SCALAR_NODE ? text_of(node) : "";
        if (!*text || strchr(text, ',')) {
            char said[64];
            text_escape(said, sizeof said, shown(node), strnlen(shown(node), 60));
            log_error("%s: %s: %s%s: '%s' is not one item: a list is [a, b], or a,b", table->module, source,
                      settings_prefix(table), row->name, said);
            return STATUS_BAD_VALUE;
        }
        n += (size_t)snprintf(list + n, sizeof list - n, "%s%s", n ? "," : "", text);
        if (n >= sizeof list) {
            log_error("%s: %s: %s%s: the list is longer than %zu characters", table->module, source,
                      settings_prefix(table), row->name, sizeof list - 1);
            return STATUS_BAD_VALUE;
        }
    }
    return settings_store(out, table, row, list, source, r->file);
}

static Status fill_value(void *out, const Reading *r, const SettingTable *table, const Setting *row,
                         const yaml_node_t *value, const char *source)
{
    if (row->type == SETTING_OWN || row->type == SETTING_EACH || row->type == SETTING_MAP)
        return fill_own(out, r, table, row, value);
    if (row->type == SETTING_NUMBERS && value->type == YAML_SEQUENCE_NODE)
        return fill_numbers(out, r, table, row, value, source);
    if ((row->type == SETTING_WORDS || row->type == SETTING_PATHS || row->type == SETTING_NAME_OR_PATHS) &&
        value->type == YAML_SEQUENCE_NODE)
        return fill_listed(out, r, table, row, value, source);
    if (value->type != YAML_SCALAR_NODE) {
        char accepted[512], said[64];
        settings_accepted(accepted, sizeof accepted, row);
        text_escape(said, sizeof said, shown(value), strlen(shown(value)));
        log_error("%s: %s: %s%s needs one value, not '%s': %s", table->module, source, settings_prefix(table),
                  row->name, said, accepted);
        return STATUS_BAD_VALUE;
    }
    return settings_store(out, table, row, text_of(value), source, r->file);
}

/* Fills a struct from a mapping. The recursion ends, as an item's table holds only lists that are written in the
 * program, whatever aliases a file has. */
static Status fill_mapping(void *out, bool *given, bool *seen, const Reading *r, const SettingTable *table,
                           const char *section, const yaml_node_t *mapping);

static Status fill_list(void *out, const Reading *r, const SettingTable *table, const SettingList *list,
                        const yaml_node_t *sequence)
{
    const yaml_node_item_t *at = sequence->data.sequence.items.start, *end = sequence->data.sequence.items.top;
    Status                  worst = STATUS_OK;
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
        if (!goes_on(&worst, r, status)) return worst;
    }
    return worst;
}

/* The list that a key names; -1: it names none. */
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
                       const char *section, const yaml_node_pair_t *pair)
{
    const yaml_node_t *name = yaml_document_get_node(r->document, pair->key);
    const yaml_node_t *value = yaml_document_get_node(r->document, pair->value);
    char               full[key_size], source[source_size];
    snprintf(source, sizeof source, "%s:%d", r->path, line_of(name));
    if (name->type != YAML_SCALAR_NODE) {
        log_error("%s: %s: a key must be a word", table->module, source);
        return STATUS_BAD_VALUE;
    }
    snprintf(full, sizeof full, "%s%s%s", section, *section ? "." : "", text_of(name));
    if (is_section(table, full)) {
        if (value->type == YAML_MAPPING_NODE) return fill_mapping(out, given, seen, r, table, full, value);
        /* a section without keys is allowed */
        if (value->type == YAML_SCALAR_NODE && !*text_of(value)) return STATUS_OK;
    }
    const int list = find_list(table, full), row = settings_find(table, full);
    if (row < 0 && list < 0) return settings_say_unknown(table, source, full);
    bool *met = &seen[row >= 0 ? row : table->count + list];
    if (*met) {
        log_error("%s: %s: %s%s is given twice", table->module, source, settings_prefix(table), full);
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
    Status                  worst = STATUS_OK;
    for (; pair < end; pair++) {
        const Status status = fill_key(out, given, seen, r, table, section, pair);
        if (!goes_on(&worst, r, status)) return worst;
    }
    return worst;
}

/* ---- a file --------------------------------------------------------------------------------------- */

static Status load(yaml_document_t *document, const SettingTable *table, const char *path, const char *text,
                   size_t octets)
{
    yaml_parser_t parser;
    Status        status = yaml_check(table->module, path, text, octets);
    if (status != STATUS_OK) return status;
    if (!yaml_parser_initialize(&parser)) return STATUS_NO_MEMORY;
    yaml_parser_set_input_string(&parser, (const unsigned char *)text, octets);
    if (!yaml_parser_load(&parser, document)) {
        log_error("%s: %s:%d: %s", table->module, path, (int)parser.problem_mark.line + 1,
                  parser.problem ? parser.problem : "not YAML");
        status = STATUS_BAD_VALUE;
    }
    yaml_parser_delete(&parser);
    return status;
}

static Status fill_document(void *out, bool *given, const SettingTable *table, const char *path, const char *file,
                            yaml_document_t *document)
{
    const yaml_node_t *root = yaml_document_get_root_node(document);
    int                wrong = 0;
    const Reading      reading = {path, file, document, &wrong};
    if (!root) return STATUS_OK;
    if (root->type != YAML_MAPPING_NODE) {
        log_error("%s: %s:%d: expected %s", table->module, path, line_of(root),
                  strchr(table->row[0].name, '.') ? "`section:` and keys below it" : "`key: value` lines");
        return STATUS_BAD_VALUE;
    }
    bool *seen = calloc((size_t)(table->count + table->list_count), sizeof *seen);
    if (!seen) return STATUS_NO_MEMORY;
    const Status status = fill_mapping(out, given, seen, &reading, table, "", root);
    if (wrong >= most_wrong)
        log_error("%s: %s: too many errors; correct these first, the rest of the file has not been read", table->module,
                  path);
    free(seen);
    return status;
}

static Status parse_as(void *out, bool *given, const SettingTable *table, const char *path, const char *file,
                       const char *text, size_t octets)
{
    yaml_document_t document;
    Status          status = load(&document, table, path, text, octets);
    if (status != STATUS_OK) return status;
    status = fill_document(out, given, table, path, file, &document);
    yaml_document_delete(&document);
    return status;
}

Status settings_parse(void *out, bool *given, const SettingTable *table, const char *path, const char *text,
                      size_t octets)
{
    return parse_as(out, given, table, path, path, text, octets);
}

Status settings_read(void *out, bool *given, const SettingTable *table, const char *path)
{
    return settings_read_as(out, given, table, path, path);
}

Status settings_read_as(void *out, bool *given, const SettingTable *table, const char *path, const char *file)
{
    char  *text;
    size_t octets;
    Status status = file_read_whole(&text, &octets, table->module, path, settings_file_octets, FILE_FROM_SHELL);
    if (status != STATUS_OK) return status;
    status = parse_as(out, given, table, path, file, text, octets);
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
        else if (value->type == YAML_MAPPING_NODE && is_section(table, full))
            line = line_in(table, document, full, name, value);
    }
    return line;
}

int settings_line(const SettingTable *table, const char *name, const char *path)
{
    char           *text;
    size_t          octets;
    yaml_document_t document;
    int             line = 0;
    if (file_read_whole(&text, &octets, table->module, path, settings_file_octets, FILE_FROM_SHELL) != STATUS_OK)
        return 0;
    if (load(&document, table, path, text, octets) == STATUS_OK) {
        const yaml_node_t *root = yaml_document_get_root_node(&document);
        if (root && root->type == YAML_MAPPING_NODE) line = line_in(table, &document, "", name, root);
        yaml_document_delete(&document);
    }
    free(text);
    return line;
}
