/* sensor/commands/sweep/sweep_file.c: reads the axes of a sweep; the settings of each variant. */
#include "sensor/commands/sweep/sweep_private.h"

#include <stdlib.h>
#include <yaml.h>

typedef struct Reading {
    const char      *path;
    yaml_document_t *document;
    const Config    *base;
    Sweep           *sweep;
} Reading;

static int         line_of(const yaml_node_t *node) { return (int)node->start_mark.line + 1; }
static const char *text_of(const yaml_node_t *node) { return (const char *)node->data.scalar.value; }

static Status refuse(const Reading *r, const yaml_node_t *node, const char *key, const char *what)
{
    char shown[160] = "";
    if (node->type == YAML_SCALAR_NODE) text_escape(shown, sizeof shown, text_of(node), strlen(text_of(node)));
    log_error("sweep: %s:%d: %s: %s%s%s%s", r->path, line_of(node), key, *shown ? "'" : "", shown,
              *shown ? "' "
                       ""
                     : "",
              what);
    return STATUS_BAD_VALUE;
}

/* ---- axes ------------------------------------------------------------------------------------- */

static Status try_value(const Reading *r, const char *key, const char *value, int line)
{
    char   source[512];
    Config tried = *r->base;
    snprintf(source, sizeof source, "%s:%d", r->path, line);
    if (sweep_scenario_key(key)) return sweep_scenario_try(r->sweep->scenario, key, value, source);
    return config_set_from(&tried, key, value, source, r->path);
}

/* Writes [a, b] as a,b. False: it is no list of single words. */
static bool join(char out[sweep_value_size], const Reading *r, const yaml_node_t *node)
{
    size_t n = 0;
    if (node->type != YAML_SEQUENCE_NODE) return false;
    for (const yaml_node_item_t *item = node->data.sequence.items.start; item < node->data.sequence.items.top; item++) {
        const yaml_node_t *word = yaml_document_get_node(r->document, *item);
        if (word->type != YAML_SCALAR_NODE || !*text_of(word) || strchr(text_of(word), ',')) return false;
        n += (size_t)snprintf(out + n, sweep_value_size - n, "%s%s", n ? "," : "", text_of(word));
        if (n >= sweep_value_size) return false;
    }
    return n > 0;
}

static Status add_value(SweepAxis *axis, const Reading *r, const yaml_node_t *node)
{
    char        list[sweep_value_size];
    const char *value = list;
    if (node->type == YAML_SCALAR_NODE) value = text_of(node);
    else if (!join(list, r, node) || !(sweep_scenario_key(axis->key) || config_takes_list(axis->key)))
        return refuse(r, node, axis->key,
                      "needs single values, or lists of words where the key takes a list: [[optical, lwir], [lwir]]");
    const Status status = try_value(r, axis->key, value, line_of(node));
    if (status != STATUS_OK) return status;
    if (strlen(value) >= sweep_value_size) return refuse(r, node, axis->key, "is too long");
    if (!(axis->value[axis->count] = strdup(value))) return STATUS_NO_MEMORY;
    axis->count++;
    return STATUS_OK;
}

/* Reads a range, {from: 2, to: 6}. */
static Status read_range(SweepAxis *axis, const Reading *r, const yaml_node_t *node)
{
    const char *form = "needs a list of values, or {from: LOW, to: HIGH}";
    bool        from = false, to = false;
    if (sweep_key_kind(axis->key) == CONFIG_WORD)
        return refuse(r, node, axis->key,
                      "is not a number; only lists of "
                      "values");
    for (const yaml_node_pair_t *pair = node->data.mapping.pairs.start; pair < node->data.mapping.pairs.top; pair++) {
        const yaml_node_t *name = yaml_document_get_node(r->document, pair->key);
        const yaml_node_t *value = yaml_document_get_node(r->document, pair->value);
        if (name->type != YAML_SCALAR_NODE || value->type != YAML_SCALAR_NODE) return refuse(r, node, axis->key, form);
        const bool is_from = strcmp(text_of(name), "from") == 0, is_to = strcmp(text_of(name), "to") == 0;
        if (!(is_from || is_to) || (is_from && from) || (is_to && to)) return refuse(r, name, axis->key, form);
        const Status status = try_value(r, axis->key, text_of(value), line_of(value));
        if (status != STATUS_OK) return status;
        if (!text_to_double(is_from ? &axis->low : &axis->high, text_of(value)))
            return refuse(r, value, axis->key, form);
        from |= is_from;
        to |= is_to;
    }
    if (!from || !to) return refuse(r, node, axis->key, form);
    if (r->sweep->mode != SWEEP_RANDOM)
        return refuse(r, node, axis->key,
                      "only `mode: random` draws between from and "
                      "to");
    if (!(axis->low <= axis->high)) return refuse(r, node, axis->key, "from is above to");
    axis->whole = sweep_key_kind(axis->key) == CONFIG_WHOLE;
    return STATUS_OK;
}

static Status read_axis(const Reading *r, const char *key, const yaml_node_t *name, const yaml_node_t *node)
{
    Sweep *sweep = r->sweep;
    for (int i = 0; i < sweep->axis_count; i++)
        if (strcmp(sweep->axis[i].key, key) == 0) return refuse(r, name, key, "is given twice");
    if (sweep->axis_count == sweep_axes_max) return refuse(r, name, key, "is the 65th axis; at most 64");
    if (sweep_key_kind(key) == CONFIG_NONE) return try_value(r, key, "", line_of(name)); /* names the nearest */

    SweepAxis *axis = &sweep->axis[sweep->axis_count];
    *axis = (SweepAxis){.line = line_of(name)};
    snprintf(axis->key, sizeof axis->key, "%s", key);
    sweep->axis_count++;
    if (node->type == YAML_MAPPING_NODE) return read_range(axis, r, node);
    const bool   list = node->type == YAML_SEQUENCE_NODE;
    const size_t count = list ? (size_t)(node->data.sequence.items.top - node->data.sequence.items.start) : 1;
    if (count == 0) return refuse(r, node, key, "an empty list");
    if (count > sweep_variants_max) return refuse(r, node, key, "more than 10000 values");
    if (!(axis->value = calloc(count, sizeof *axis->value))) return STATUS_NO_MEMORY;
    if (!list) return add_value(axis, r, node);
    for (size_t i = 0; i < count; i++) {
        const Status status =
            add_value(axis, r, yaml_document_get_node(r->document, node->data.sequence.items.start[i]));
        if (status != STATUS_OK) return status;
    }
    return STATUS_OK;
}

/* Reads the axes of a section. section: "" at the top of the file; in a section only keys are allowed. */
static Status read_axes(const Reading *r, const char *section, const yaml_node_t *mapping)
{
    if (mapping->type != YAML_MAPPING_NODE) return refuse(r, mapping, "axes", "needs `key: [values]` below it");
    for (const yaml_node_pair_t *pair = mapping->data.mapping.pairs.start; pair < mapping->data.mapping.pairs.top;
         pair++) {
        const yaml_node_t *name = yaml_document_get_node(r->document, pair->key);
        const yaml_node_t *node = yaml_document_get_node(r->document, pair->value);
        char               key[96];
        if (name->type != YAML_SCALAR_NODE) return refuse(r, name, "axes", "a key must be a word");
        if ((size_t)snprintf(key, sizeof key, "%s%s%s", section, *section ? "." : "", text_of(name)) >= sizeof key)
            return refuse(r, name, "axes", "unknown key: too long");
        const bool   below = !*section && node->type == YAML_MAPPING_NODE && sweep_key_kind(key) == CONFIG_NONE;
        const Status status = below ? read_axes(r, key, node) : read_axis(r, key, name, node);
        if (status != STATUS_OK) return status;
    }
    return STATUS_OK;
}

/* ---- the file --------------------------------------------------------------------------------- */

static Status read_whole(long long *out, const Reading *r, const char *key, const yaml_node_t *node, long long low,
                         long long high)
{
    char range[80];
    snprintf(range, sizeof range, "is not a whole number in %lld .. %lld", low, high);
    if (node->type == YAML_SCALAR_NODE && text_to_long(out, text_of(node)) && *out >= low && *out <= high)
        return STATUS_OK;
    return refuse(r, node, key, range);
}

static Status read_mode(const Reading *r, const yaml_node_t *node)
{
    static const char *const modes[] = {"grid", "zip", "random"};
    for (int i = 0; node->type == YAML_SCALAR_NODE && i < 3; i++)
        if (strcmp(text_of(node), modes[i]) == 0) {
            r->sweep->mode = (SweepMode)i;
            return STATUS_OK;
        }
    return refuse(r, node, "mode", "is not one of grid|zip|random");
}

/* Reads the axes last, wherever they are in the file: what is accepted depends on the mode. */
static Status read_root(Reading *r, const yaml_node_t *root)
{
    static const char *const keys[] = {"mode", "count", "draw", "axes"};
    const yaml_node_t       *value[4] = {NULL};
    long long                count = 0;
    Status                   status = STATUS_OK;
    if (!root || root->type != YAML_MAPPING_NODE) {
        log_error("sweep: %s:1: expected `axes:` and keys with lists of values below it", r->path);
        return STATUS_BAD_VALUE;
    }
    for (const yaml_node_pair_t *pair = root->data.mapping.pairs.start; pair < root->data.mapping.pairs.top; pair++) {
        const yaml_node_t *name = yaml_document_get_node(r->document, pair->key);
        int                k = 0;
        while (k < 4 && !(name->type == YAML_SCALAR_NODE && strcmp(text_of(name), keys[k]) == 0)) k++;
        if (k == 4)
            return refuse(r, name, "no such key",
                          "accepted are mode, count, draw and axes; settings go below "
                          "axes");
        if (value[k]) return refuse(r, name, keys[k], "is given twice");
        value[k] = yaml_document_get_node(r->document, pair->value);
    }
    if (value[0]) status = read_mode(r, value[0]);
    if (status == STATUS_OK && value[1]) status = read_whole(&count, r, "count", value[1], 1, sweep_variants_max);
    if (status == STATUS_OK && value[2]) status = read_whole(&r->sweep->draw, r, "draw", value[2], 0, 2147483647);
    if (status != STATUS_OK) return status;
    const bool random = r->sweep->mode == SWEEP_RANDOM;
    if (!random && value[1]) return refuse(r, value[1], "count", "applies to `mode: random` only");
    if (!random && value[2]) return refuse(r, value[2], "draw", "applies to `mode: random` only");
    if (random && !value[1])
        return refuse(r, root, "count",
                      "is missing: number of draws of `mode: random`, 1 .. "
                      "10000");
    r->sweep->count = (int)count;
    if (value[1]) r->sweep->count_line = line_of(value[1]);
    if (!value[3]) return refuse(r, root, "axes", "are missing: keys with lists of values");
    return read_axes(r, "", value[3]);
}

static Status count_variants(const Reading *r)
{
    Sweep           *sweep = r->sweep;
    long long        product = 1, longest = 1;
    const SweepAxis *first = NULL;
    if (sweep->axis_count == 0) {
        log_error("sweep: %s: axes: is empty; nothing to vary", r->path);
        return STATUS_BAD_VALUE;
    }
    for (int i = 0; i < sweep->axis_count && sweep->mode != SWEEP_RANDOM; i++) {
        const SweepAxis *axis = &sweep->axis[i];
        if (product <= sweep_variants_max) product *= axis->count; /* no more than 1e8 */
        if (sweep->mode == SWEEP_ZIP && axis->count > 1) {
            if (first && axis->count != first->count) {
                log_error("sweep: %s:%d: %s: has %d values, but %s has %d; `mode: zip` needs lists of equal "
                          "length",
                          r->path, axis->line, axis->key, axis->count, first->key, first->count);
                return STATUS_BAD_VALUE;
            }
            first = axis;
            longest = axis->count;
        }
    }
    if (sweep->mode == SWEEP_RANDOM) return sweep_draw(sweep, r->path);
    if (sweep->mode == SWEEP_GRID && product > sweep_variants_max) {
        log_error("sweep: %s: the grid has more than %d variants; shorten a list, or draw from it with `mode: random` "
                  "and "
                  "`count`",
                  r->path, sweep_variants_max);
        return STATUS_BAD_VALUE;
    }
    sweep->count = (int)(sweep->mode == SWEEP_ZIP ? longest : product);
    return STATUS_OK;
}

static Status parse(Reading *r, const char *text, size_t octets)
{
    yaml_parser_t   parser;
    yaml_document_t document;
    Status          status = yaml_check("sweep", r->path, text, octets);
    if (status != STATUS_OK) return status;
    if (!yaml_parser_initialize(&parser)) return STATUS_NO_MEMORY;
    yaml_parser_set_input_string(&parser, (const unsigned char *)text, octets);
    if (!yaml_parser_load(&parser, &document)) {
        log_error("sweep: %s:%d: "
                  "%s",
                  r->path, (int)parser.problem_mark.line + 1, parser.problem ? parser.problem : "not YAML");
        yaml_parser_delete(&parser);
        return STATUS_BAD_VALUE;
    }
    r->document = &document;
    status = read_root(r, yaml_document_get_root_node(&document));
    if (status == STATUS_OK) status = count_variants(r);
    yaml_document_delete(&document);
    yaml_parser_delete(&parser);
    return status;
}

Status sweep_read(Sweep *out, const char *path, const Config *base) { return sweep_read_of(out, path, base, NULL); }

Status sweep_read_of(Sweep *out, const char *path, const Config *base, const char *scenario)
{
    char   *text;
    size_t  octets;
    Reading reading = {.path = path, .base = base, .sweep = out};
    *out = (Sweep){.scenario = scenario, .path = path, .draw = 1};
    Status status = text_read_file(&text, &octets, "sweep", path, settings_file_octets);
    if (status != STATUS_OK) return status;
    status = parse(&reading, text, octets);
    free(text);
    if (status != STATUS_OK) sweep_close(out);
    return status;
}

void sweep_close(Sweep *sweep)
{
    for (int i = 0; i < sweep->axis_count; i++) {
        for (int k = 0; k < sweep->axis[i].count; k++) free(sweep->axis[i].value[k]);
        free(sweep->axis[i].value);
        free(sweep->axis[i].kind_of);
        free(sweep->axis[i].first_of);
    }
    free(sweep->draw_of);
    *sweep = (Sweep){0};
}

/* ---- variants --------------------------------------------------------------------------------- */

void sweep_value(char out[sweep_value_size], const Sweep *sweep, int variant, int axis)
{
    const SweepAxis *a = &sweep->axis[axis];
    int              choice = a->count > 1 ? variant : 0, below = 1; /* zip */
    if (sweep->mode == SWEEP_RANDOM) {
        sweep_drawn_value(out, sweep, sweep->draw_of[variant], axis);
        return;
    }
    if (sweep->mode == SWEEP_GRID) {
        for (int i = axis + 1; i < sweep->axis_count; i++) below *= sweep->axis[i].count;
        choice = variant / below % a->count;
    }
    snprintf(out, sweep_value_size, "%s", a->value[choice]);
}

Status sweep_config(Config *out, const Sweep *sweep, const Config *base, int variant)
{
    char   value[sweep_value_size], source[64];
    Status status = STATUS_OK;
    *out = *base;
    for (int i = 0; i < sweep->axis_count && status == STATUS_OK; i++) {
        if (sweep_scenario_key(sweep->axis[i].key)) continue;
        sweep_value(value, sweep, variant, i);
        snprintf(source, sizeof source, "variant %d", variant + 1);
        status = config_set_from(out, sweep->axis[i].key, value, source, sweep->path);
    }
    return status;
}
