/* terrain/from_files/culture_rules.c: etc/culture_tags.csv: what attributes mean, and what those of a feature say. */
#include "terrain/from_files/culture_import_private.h"
#include "pitviper_table.h"

#include <stdlib.h>
#include <strings.h>

static const char *const use_names[] = {"house", "flats", "barn", "shed", "hall", "church"};
static const char *const roof_names[] = {"flat", "gabled", "hipped", "pyramidal", "skillion"};
static const char *const fabric_names[] = {"brick", "render", "stone", "timber", "concrete",
                                           "sheet", "tile",   "slate", "felt",   "thatch"};
static const char *const line_names[] = {"wall", "fence", "wire_fence", "power_line", "bridge",
                                         "road", "track", "water",      "yard"};
static const char *const point_names[] = {"pole",      "lamp", "sign",  "tank",    "silo",
                                          "container", "heap", "stack", "chimney", "mast"};
static const char *const way_names[] = {"along", "across"};
#define NAMES(list) list, sizeof list / sizeof *list
_Static_assert(sizeof use_names / sizeof *use_names == BUILDING_USES &&
                   sizeof roof_names / sizeof *roof_names == ROOF_SHAPES &&
                   sizeof fabric_names / sizeof *fabric_names == FABRICS &&
                   sizeof line_names / sizeof *line_names == CULTURE_LINE_KINDS &&
                   sizeof point_names / sizeof *point_names == CULTURE_POINT_KINDS,
               "a name of each");

static const char *name_of(const char *const *names, size_t count, int k)
{
    return k >= 0 && k < (int)count ? names[k] : "none";
}

const char *culture_use_name(int use) { return name_of(NAMES(use_names), use); }
const char *culture_roof_name(int roof) { return name_of(NAMES(roof_names), roof); }
const char *culture_fabric_name(int fabric) { return name_of(NAMES(fabric_names), fabric); }
const char *culture_line_name(int kind) { return name_of(NAMES(line_names), kind); }
const char *culture_point_name(int kind) { return name_of(NAMES(point_names), kind); }

enum { name_most = 256 };

static int find_name(const char *const *names, size_t count, const char *name)
{
    for (size_t k = 0; k < count; k++)
        if (strcmp(names[k], name) == 0) return (int)k;
    return -1;
}

/* ---- the table -------------------------------------------------------------------------------------- */

static const TableColumn columns[] = {
    {"key", TABLE_NAME, TABLE_AT(CultureRule, key), .key = false},
    {"value", TABLE_NAME, TABLE_AT(CultureRule, value), .key = false},
    {"makes", TABLE_CHOICE, TABLE_AT(CultureRule, makes),
     .choices =
         "building, use, line, point, tree, tree_row, nothing, height, eaves, levels, "
         "roof_height, roof_levels, width, lanes, direction, roof, roof_way, ridge, chimneys, heated, wall, cover, ground, plant, bridge, hidden, "
         "ruined, marked, id, tags"},
    {"kind", TABLE_NAME, TABLE_AT(CultureRule, kind_name), .absent = TABLE_EMPTY},
    {"height_m", TABLE_DOUBLE, TABLE_AT(CultureRule, height_m), .low = 0, .high = 850, .absent = TABLE_EMPTY},
    {"width_m", TABLE_DOUBLE, TABLE_AT(CultureRule, width_m), .low = 0, .high = 100, .absent = TABLE_EMPTY},
    {"surface", TABLE_NAMED, TABLE_AT(CultureRule, surface), SURFACE_OR_NONE, .absent = TABLE_EMPTY},
};
static const TableFormat format = {.module = "culture",
                                   .column = columns,
                                   .count = sizeof columns / sizeof *columns,
                                   .next = "the head of etc/culture_tags.csv explains the columns",
                                   .least_rows = 1,
                                   .most_rows = 4096};

/* The number of a kind by what the rule makes; -2: it is none. */
static int kind_of(const CultureRule *r)
{
    if (!*r->kind_name) return r->makes == MAKES_LINE || r->makes == MAKES_POINT || r->makes == MAKES_USE ? -2 : -1;
    int kind = -1;
    switch ((RuleMakes)r->makes) {
    case MAKES_BUILDING:
    case MAKES_USE:
        kind = find_name(NAMES(use_names), r->kind_name);
        break;
    case MAKES_LINE:
        kind = find_name(NAMES(line_names), r->kind_name);
        break;
    case MAKES_POINT:
        kind = find_name(NAMES(point_names), r->kind_name);
        break;
    case MAKES_TREE:
    case MAKES_TREE_ROW:
    case MAKES_PLANT:
        kind = (int)culture_plant(r->kind_name);
        if (kind == PLANT_STANDING) kind = -1;
        break;
    case MAKES_ROOF:
        kind = find_name(NAMES(roof_names), r->kind_name);
        break;
    case MAKES_ROOF_WAY:
        kind = find_name(NAMES(way_names), r->kind_name);
        break;
    case MAKES_WALL:
    case MAKES_COVER:
        kind = find_name(NAMES(fabric_names), r->kind_name);
        break;
    default:
        break;
    }
    return kind < 0 ? -2 : kind;
}

/* Letters as names of attributes are compared by: case aside, and `_` for `:`, which Shapefiles cannot have. */
static char letter_of(char c) { return c >= 'A' && c <= 'Z' ? (char)(c + 'a' - 'A') : c == ':' ? '_' : c; }

static int compare_names(const char *a, const char *b, size_t most)
{
    for (size_t k = 0; k < most; k++) {
        const unsigned char x = (unsigned char)letter_of(a[k]), y = (unsigned char)letter_of(b[k]);
        if (x != y || !x) return x - y;
    }
    return 0;
}

static Status take(void *user, const void *row, const TableRows *rows, int number)
{
    CultureRules *rules = user;
    CultureRule  *rule = &rules->rule[rules->count];
    *rule = *(const CultureRule *)row;
    rule->kind = kind_of(rule);
    rule->next = -1;
    if (rule->kind == -2) return table_rows_refuse(rows, number, "kind", "a kind of what the row makes");
    if ((rule->makes == MAKES_LINE || rule->makes == MAKES_POINT) && !(rule->width_m > 0))
        return table_rows_refuse(rows, number, "width_m", "a width");
    if (rule->makes == MAKES_POINT && !(rule->height_m > 0))
        return table_rows_refuse(rows, number, "height_m", "a height");
    rules->count++;
    return STATUS_OK;
}

/* Chains the rules of each key in their order, and sorts the keys. */
static void sort(CultureRules *rules)
{
    for (int n = 0; n < rules->count; n++) {
        int at = 0, order = 1;
        while (at < rules->keys &&
               (order = compare_names(rules->rule[n].key, rules->rule[rules->key[at]].key, name_most)) > 0)
            at++;
        if (at < rules->keys && order == 0) {
            int last = rules->key[at];
            while (rules->rule[last].next >= 0) last = rules->rule[last].next;
            rules->rule[last].next = n;
            continue;
        }
        memmove(rules->key + at + 1, rules->key + at, (size_t)(rules->keys++ - at) * sizeof *rules->key);
        rules->key[at] = n;
    }
}

Status culture_rules_open(CultureRules *out, const char *given)
{
    char         own[512];
    const char  *path = given ? given : own;
    CultureRule  row;
    CultureRules rules = {0};
    if (!given && !etc_path(own, sizeof own, "culture_tags.csv")) {
        log_error("culture: path of the tables is too long; set PITVIPER_ETC to a shorter one");
        return STATUS_BAD_VALUE;
    }
    rules.rule = calloc((size_t)format.most_rows, sizeof *rules.rule);
    rules.key = calloc((size_t)format.most_rows, sizeof *rules.key);
    const Status status =
        rules.rule && rules.key ? table_each(&format, path, &row, sizeof row, take, &rules) : STATUS_NO_MEMORY;
    if (status == STATUS_OK) {
        sort(&rules);
        *out = rules;
    } else culture_rules_close(&rules);
    return status;
}

void culture_rules_close(CultureRules *rules)
{
    free(rules->rule), free(rules->key);
    *rules = (CultureRules){0};
}

/* ---- a feature's -------------------------------------------------------------------------------------- */

/* The first rule of a key; -1: none. A Shapefile cuts names to ten letters. */
static int find_key(const CultureRules *rules, const char *name)
{
    enum { cut = 10 };
    int low = 0, high = rules->keys - 1;
    while (low <= high) {
        const int middle = (low + high) / 2,
                  order = compare_names(name, rules->rule[rules->key[middle]].key, name_most);
        if (order == 0) return rules->key[middle];
        if (order < 0) high = middle - 1;
        else low = middle + 1;
    }
    if (strlen(name) != cut) return -1;
    for (int n = 0; n < rules->keys; n++)
        if (compare_names(name, rules->rule[rules->key[n]].key, cut) == 0) return rules->key[n];
    return -1;
}

static bool is_no(const char *value)
{
    static const char *const no[] = {"", "no", "none", "0", "f", "false"};
    for (size_t k = 0; k < sizeof no / sizeof *no; k++)
        if (strcasecmp(value, no[k]) == 0) return true;
    return false;
}

/* A number of 0 is one that a file does not know, but for a direction, and of what records alone say. */
static bool fits(const CultureRule *rule, const char *value)
{
    if (strcmp(rule->value, "*") == 0) {
        const int makes = rule->makes;
        return makes == MAKES_DIRECTION || makes == MAKES_RIDGE || makes == MAKES_CHIMNEYS || makes == MAKES_HEATED ||
               !is_no(value);
    }
    return strcasecmp(rule->value, value) == 0;
}

/* Whether a rule can make something of a shape. */
static bool can_make(const CultureRule *rule, VectorShape shape)
{
    const bool ring = rule->makes == MAKES_TREE_ROW || rule->kind == CULTURE_WALL || rule->kind == CULTURE_FENCE ||
                      rule->kind == CULTURE_WIRE_FENCE;
    switch ((RuleMakes)rule->makes) {
    case MAKES_BUILDING:
        return shape == VECTOR_POLYGON;
    case MAKES_POINT:
        return shape != VECTOR_LINE;
    case MAKES_TREE:
        return shape == VECTOR_POINT;
    case MAKES_LINE:
    case MAKES_TREE_ROW:
        return shape == VECTOR_LINE || (shape == VECTOR_POLYGON && ring);
    default:
        return false;
    }
}

static void set_what(CultureFacts *f, const CultureRule *rule)
{
    f->known = true;
    for (int shape = VECTOR_POINT; shape <= VECTOR_POLYGON; shape++)
        if (can_make(rule, (VectorShape)shape) && (!f->what[shape] || rule < f->what[shape])) f->what[shape] = rule;
}

static void set_number(CultureFacts *f, double *to, bool (*read)(double *, const char *), const char *value)
{
    double number;
    if (!read(&number, value)) f->unread++;
    else if (isnan(*to)) *to = number;
}

static void apply(CultureFacts *f, const CultureRule *rule, const char *value)
{
    switch ((RuleMakes)rule->makes) {
    case MAKES_HEIGHT:
        set_number(f, &f->height_m, culture_metres, value);
        break;
    case MAKES_EAVES:
        set_number(f, &f->eaves_m, culture_metres, value);
        break;
    case MAKES_LEVELS:
        set_number(f, &f->levels, culture_number, value);
        break;
    case MAKES_ROOF_HEIGHT:
        set_number(f, &f->roof_height_m, culture_metres, value);
        break;
    case MAKES_ROOF_LEVELS:
        set_number(f, &f->roof_levels, culture_number, value);
        break;
    case MAKES_WIDTH:
        set_number(f, &f->width_m, culture_metres, value);
        break;
    case MAKES_LANES:
        set_number(f, &f->lanes, culture_number, value);
        break;
    case MAKES_DIRECTION:
        if (isnan(f->direction_rad))
            (void)culture_direction(&f->direction_rad, value); /* of lamps and signs it is words */
        break;
    case MAKES_USE:
        if (f->use < 0) f->use = rule->kind;
        break;
    case MAKES_ROOF:
        f->roof = rule->kind;
        break;
    case MAKES_ROOF_WAY:
        f->roof_way = rule->kind;
        break;
    case MAKES_RIDGE:
        set_number(f, &f->ridge_rad, culture_number, value);
        break;
    case MAKES_CHIMNEYS:
        set_number(f, &f->chimneys, culture_number, value);
        break;
    case MAKES_HEATED:
        f->heated = !is_no(value);
        break;
    case MAKES_WALL:
        f->wall = rule->kind;
        break;
    case MAKES_COVER:
        f->cover = rule->kind;
        break;
    case MAKES_GROUND:
        f->ground = rule->surface;
        break;
    case MAKES_PLANT:
        f->plant = rule->kind;
        break;
    case MAKES_BRIDGE:
        f->bridge = true;
        break;
    case MAKES_HIDDEN:
        f->hidden = true;
        break;
    case MAKES_RUINED:
        f->ruined = true;
        break;
    case MAKES_MARKED:
        f->mark = culture_mark(value) < PLANT_MARKS ? culture_mark(value) : MARK_WHITE;
        break;
    case MAKES_ID:
        f->id = culture_mix(culture_mix_seed, value, strlen(value));
        break;
    default:
        set_what(f, rule);
    }
}

/* Every rule that fits an attribute is applied; of those of one meaning for the same attribute the first alone, as `*`
 * stands behind the words. */
static void apply_tag(CultureFacts *f, const CultureRules *rules, const char *name, const char *value, int depth)
{
    uint32_t met = 0;
    _Static_assert(MAKES_COUNT <= 32, "a bit of each");
    for (int n = find_key(rules, name); n >= 0; n = rules->rule[n].next) {
        const CultureRule *rule = &rules->rule[n];
        if (!fits(rule, value)) continue;
        if (rule->makes == MAKES_TAGS) {
            char        key[culture_text_size], text[culture_text_size];
            const char *at = value;
            for (int k = 0; depth == 0 && k < 256 && culture_pair(key, text, &at); k++)
                apply_tag(f, rules, key, text, depth + 1);
            continue;
        }
        const uint32_t bit = rule->makes <= MAKES_NOTHING && rule->makes != MAKES_USE ? 1u : 1u << rule->makes;
        if (met & bit) continue;
        met |= bit;
        apply(f, rule, value);
    }
}

void culture_facts(CultureFacts *out, const CultureRules *rules, int tags, const char *const *name,
                   const char *const *value)
{
    *out = (CultureFacts){.use = -1,
                          .roof = -1,
                          .wall = -1,
                          .cover = -1,
                          .ground = -1,
                          .plant = -1,
                          .roof_way = -1,
                          .heated = -1,
                          .eaves_m = NAN,
                          .ridge_rad = NAN,
                          .chimneys = NAN,
                          .height_m = NAN,
                          .levels = NAN,
                          .roof_height_m = NAN,
                          .roof_levels = NAN,
                          .width_m = NAN,
                          .lanes = NAN,
                          .direction_rad = NAN};
    for (int k = 0; k < tags; k++) apply_tag(out, rules, name[k], value[k], 0);
}
