/* entities/import/sidecar.c: the sidecar's YAML into plain values, every key by a table. */
#include "entities/import/sidecar.h"

#include <stdlib.h>
#include <yaml.h>

typedef struct Reader {
    const char *path;
    yaml_document_t *document;
    Sidecar *sidecar;
    const char *accepted; /* of the key that is being read */
} Reader;

static int line_of(const yaml_node_t *node) { return (int)node->start_mark.line + 1; }

/* The value as a user wrote it, harmless and short. */
static const char *shown(char out[128], const yaml_node_t *node)
{
    if (node->type == YAML_MAPPING_NODE) return "{...}";
    if (node->type == YAML_SEQUENCE_NODE) return "[...]";
    const size_t length = node->data.scalar.length;
    text_escape(out, 128, (const char *)node->data.scalar.value, length > 60 ? 60 : length);
    return out;
}

static Status bad_value(const Reader *r, const yaml_node_t *node, const char *key, const char *accepted)
{
    char text[128];
    log_error("sidecar: %s:%d: %s: '%s' is not %s", r->path, line_of(node), key, shown(text, node), accepted);
    return STATUS_BAD_VALUE;
}

/* The scalar's text, or NULL for anything else and for text with a NUL in it. */
static const char *scalar(const yaml_node_t *node)
{
    if (node->type != YAML_SCALAR_NODE) return NULL;
    const char *text = (const char *)node->data.scalar.value;
    return strlen(text) == node->data.scalar.length ? text : NULL;
}

static bool copy_text(char *out, size_t size, const char *text)
{
    if (!text || !*text || strlen(text) >= size) return false;
    strcpy(out, text);
    return true;
}

/* `count` finite numbers with blanks between, or a YAML list of them. */
static bool read_numbers(double *out, int count, const Reader *r, const yaml_node_t *node)
{
    if (node->type == YAML_SEQUENCE_NODE) {
        if (node->data.sequence.items.top - node->data.sequence.items.start != count) return false;
        for (int i = 0; i < count; i++) {
            const char *text = scalar(yaml_document_get_node(r->document, node->data.sequence.items.start[i]));
            if (!text || !text_to_double(out + i, text)) return false;
        }
        return true;
    }
    const char *at = scalar(node);
    for (int i = 0; i < count; i++) {
        char word[64];
        if (!at) return false;
        at += strspn(at, " \t");
        const size_t length = strcspn(at, " \t");
        if (length == 0 || length >= sizeof word) return false;
        memcpy(word, at, length);
        word[length] = 0;
        if (!text_to_double(out + i, word)) return false;
        at += length;
    }
    return at[strspn(at, " \t")] == 0;
}

static bool numbers_within(const double *value, int count, double low, double high)
{
    for (int i = 0; i < count; i++)
        if (!(value[i] >= low && value[i] <= high)) return false;
    return true;
}

/* ---- words ------------------------------------------------------------------------------------- */

/* SISO-REF-010, articulated parts, type classes (from memory); ten of each, 32 apart. */
static const struct {
    const char *name;
    uint32_t first;
    int numbers;
} classes[] = {
    {"primary_turret", 4096, 10},  {"primary_gun", 4416, 10},        {"primary_launcher", 4736, 10},
    {"primary_defence", 5056, 10}, {"primary_radar", 5376, 10},      {"secondary_turret", 5696, 10},
    {"secondary_gun", 6016, 10},   {"secondary_launcher", 6336, 10}, {"secondary_defence", 6656, 10},
    {"secondary_radar", 6976, 10},
};
#define CLASS_ACCEPTED "primary_ or secondary_ and turret, gun, launcher, defence or radar, then _1 .. " \
                                     "_10, or a multiple of 32 in 1024 .. 8160"

static bool read_class(uint32_t *out, const char *text)
{
    long long number;
    if (text_to_long(&number, text)) {
        if (number < 1024 || number > 8160 || number % 32 != 0) return false;
        *out = (uint32_t)number;
        return true;
    }
    for (size_t i = 0; i < sizeof classes / sizeof *classes; i++) {
        const size_t length = strlen(classes[i].name);
        if (strncmp(text, classes[i].name, length) != 0 || text[length] != '_') continue;
        const char *tail = text + length + 1;
        if (*tail < '0' || *tail > '9' || !text_to_long(&number, tail)) return false;
        if (number < 1 || number > classes[i].numbers) return false;
        *out = classes[i].first + 32 * (uint32_t)(number - 1);
        return true;
    }
    return false;
}

const char *sidecar_class_text(char out[32], uint32_t dis_class)
{
    for (size_t i = 0; i < sizeof classes / sizeof *classes; i++) {
        const uint32_t number = (dis_class - classes[i].first) / 32;
        if (dis_class < classes[i].first || number >= (uint32_t)classes[i].numbers) continue;
        snprintf(out, 32, "%s_%u", classes[i].name, number + 1);
        return out;
    }
    return NULL;
}

static const struct {
    const char *name;
    uint32_t metric;
} metrics[] = {{"position", 1}, {"extension", 3}, {"x", 5},          {"y", 7},
               {"z", 9},        {"azimuth", 11},  {"elevation", 13}, {"rotation", 15}};

const char *sidecar_metric_text(uint32_t dis_metric)
{
    for (size_t i = 0; i < sizeof metrics / sizeof *metrics; i++)
        if (metrics[i].metric == dis_metric) return metrics[i].name;
    return NULL;
}

static bool read_metric(uint32_t *out, const char *text)
{
    for (size_t i = 0; i < sizeof metrics / sizeof *metrics; i++)
        if (strcmp(metrics[i].name, text) == 0) {
            *out = metrics[i].metric;
            return true;
        }
    return false;
}

/* +x, -Z: a unit vector along an axis of the file. */
static bool read_axis_word(double out[3], const char *word, size_t length)
{
    if (length != 2 || (word[0] != '+' && word[0] != '-')) return false;
    const char letter = (char)(word[1] | 0x20);
    if (letter < 'x' || letter > 'z') return false;
    memset(out, 0, 3 * sizeof *out);
    out[letter - 'x'] = word[0] == '+' ? 1 : -1;
    return true;
}

/* Right-handed about: yaw body down (clockwise from above), pitch body right (nose up), roll body forward. */
static bool read_body_axis(double out[3], const char *text)
{
    static const struct {
        const char *name;
        double axis[3];
    } words[] = {
        {"yaw", {0, 0, 1}},   {"pitch", {0, 1, 0}}, {"roll", {1, 0, 0}}, {"forward", {1, 0, 0}}, {"back", {-1, 0, 0}},
        {"right", {0, 1, 0}}, {"left", {0, -1, 0}}, {"up", {0, 0, -1}},  {"down", {0, 0, 1}},
    };
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (strcmp(words[i].name, text) == 0) {
            memcpy(out, words[i].axis, 3 * sizeof *out);
            return true;
        }
    return false;
}

/* ---- keys ---------------------------------------------------------------------------------------- */

typedef struct Key {
    const char *name, *type, *accepted, *help; /* accepted: values, with their unit and range */
    /* joint: NULL for a key at the top; key: its whole name, for messages */
    Status (*read)(Reader *r, SidecarJoint *joint, const char *key, const yaml_node_t *value);
} Key;

/* Every key of the mapping once, by the table. */
static Status read_mapping(Reader *r, const Key *key, int key_count, SidecarJoint *joint, const char *where,
                           const yaml_node_t *mapping)
{
    uint64_t seen = 0;
    for (const yaml_node_pair_t *pair = mapping->data.mapping.pairs.start; pair < mapping->data.mapping.pairs.top;
         pair++) {
        const yaml_node_t *name = yaml_document_get_node(r->document, pair->key);
        const yaml_node_t *value = yaml_document_get_node(r->document, pair->value);
        const char *text = scalar(name);
        char full[192], safe[128];
        int k = 0;
        while (k < key_count && !(text && strcmp(key[k].name, text) == 0)) k++;
        snprintf(full, sizeof full, "%s%s", where, shown(safe, name));
        if (k == key_count) {
            char accepted[400];
            size_t n = 0;
            for (int i = 0; i < key_count && n < sizeof accepted; i++)
                n += (size_t)snprintf(accepted + n, sizeof accepted - n, "%s%s", i ? ", " : "", key[i].name);
            log_error("sidecar: %s:%d: no such key: %s; there are %s", r->path, line_of(name), full, accepted);
            return STATUS_BAD_VALUE;
        }
        if (seen >> k & 1) {
            log_error("sidecar: %s:%d: %s is given twice", r->path, line_of(name), full);
            return STATUS_BAD_VALUE;
        }
        seen |= UINT64_C(1) << k;
        r->accepted = key[k].accepted;
        const Status status = key[k].read(r, joint, full, value);
        if (status != STATUS_OK) return status;
    }
    return STATUS_OK;
}

static Status add_rule(Reader *r, SidecarRules *rules, const char *key, const yaml_node_t *pattern,
                       const yaml_node_t *value, int damage)
{
    SidecarRule rule = {.line = line_of(pattern), .damage = damage};
    if (!copy_text(rule.pattern, sizeof rule.pattern, scalar(pattern)))
        return bad_value(r, pattern, key, "a pattern of 1 .. 95 characters");
    if (value && !copy_text(rule.value, sizeof rule.value, scalar(value)))
        return bad_value(r, value, key, "a name of 1 .. 31 characters");
    for (int i = 0; i < rules->count; i++)
        if (value && rules->rule[i].damage == damage && strcmp(rules->rule[i].pattern, rule.pattern) == 0) {
            log_error("sidecar: %s:%d: %s: pattern '%s' is given twice", r->path, rule.line, key, rule.pattern);
            return STATUS_BAD_VALUE;
        }
    if (rules->count == sidecar_max_rules) {
        log_error("sidecar: %s:%d: %s: more than %d patterns", r->path, rule.line, key, sidecar_max_rules);
        return STATUS_BAD_VALUE;
    }
    if ((rules->count & (rules->count - 1)) == 0) { /* room for a power of two */
        SidecarRule *grown = realloc(rules->rule, (rules->count ? 2 * (size_t)rules->count : 1) * sizeof *grown);
        if (!grown) return STATUS_NO_MEMORY;
        rules->rule = grown;
    }
    rules->rule[rules->count++] = rule;
    return STATUS_OK;
}

/* One pattern, or a list of them. */
static Status read_list(Reader *r, SidecarRules *rules, const char *key, const yaml_node_t *value, int damage)
{
    if (value->type == YAML_SCALAR_NODE) return add_rule(r, rules, key, value, NULL, damage);
    if (value->type != YAML_SEQUENCE_NODE) return bad_value(r, value, key, "a pattern or a list of them");
    Status status = STATUS_OK;
    for (const yaml_node_item_t *item = value->data.sequence.items.start;
         item < value->data.sequence.items.top && status == STATUS_OK; item++)
        status = add_rule(r, rules, key, yaml_document_get_node(r->document, *item), NULL, damage);
    return status;
}

static Status read_rules(Reader *r, SidecarRules *rules, const char *key, const yaml_node_t *value, int damage)
{
    if (value->type != YAML_MAPPING_NODE) return bad_value(r, value, key, "`pattern: name` for each");
    Status status = STATUS_OK;
    for (const yaml_node_pair_t *pair = value->data.mapping.pairs.start;
         pair < value->data.mapping.pairs.top && status == STATUS_OK; pair++)
        status = add_rule(r, rules, key, yaml_document_get_node(r->document, pair->key),
                          yaml_document_get_node(r->document, pair->value), damage);
    return status;
}

/* ---- a joint ------------------------------------------------------------------------------------- */

#define READ_JOINT(name) static Status name(Reader *r, SidecarJoint *j, const char *key, const yaml_node_t *value)

READ_JOINT(joint_name)
{
    return copy_text(j->name, sizeof j->name, scalar(value)) ? STATUS_OK
                                                             : bad_value(r, value, key, r->accepted);
}

READ_JOINT(joint_parent)
{
    return copy_text(j->parent, sizeof j->parent, scalar(value)) ? STATUS_OK
                                                                 : bad_value(r, value, key, r->accepted);
}

READ_JOINT(joint_nodes)
{
    if (value->type == YAML_SCALAR_NODE) {
        j->pattern_count = 1;
        return copy_text(j->pattern[0], sizeof j->pattern[0], scalar(value)) ? STATUS_OK
                                                                             : bad_value(r, value, key, r->accepted);
    }
    if (value->type != YAML_SEQUENCE_NODE) return bad_value(r, value, key, r->accepted);
    const ptrdiff_t count = value->data.sequence.items.top - value->data.sequence.items.start;
    if (count < 1 || count > sidecar_max_patterns) return bad_value(r, value, key, r->accepted);
    for (; j->pattern_count < count; j->pattern_count++) {
        const yaml_node_t *item =
            yaml_document_get_node(r->document, value->data.sequence.items.start[j->pattern_count]);
        if (!copy_text(j->pattern[j->pattern_count], sizeof j->pattern[0], scalar(item)))
            return bad_value(r, item, key, r->accepted);
    }
    return STATUS_OK;
}

READ_JOINT(joint_each)
{
    const char *text = scalar(value);
    j->each = text && strcmp(text, "true") == 0;
    return j->each || (text && strcmp(text, "false") == 0) ? STATUS_OK : bad_value(r, value, key, r->accepted);
}

READ_JOINT(joint_pivot)
{
    const char *text = scalar(value);
    j->pivot = PIVOT_GIVEN;
    if (text && strcmp(text, "node") == 0)
        j->pivot = PIVOT_NODE;
    else if (text && strcmp(text, "centre") == 0)
        j->pivot = PIVOT_CENTRE;
    else if (!read_numbers(j->p_pivot_file, 3, r, value) || !numbers_within(j->p_pivot_file, 3, -1e9, 1e9))
        return bad_value(r, value, key, r->accepted);
    return STATUS_OK;
}

READ_JOINT(joint_axis)
{
    const char *text = scalar(value);
    j->axis = AXIS_BODY;
    if (text && read_body_axis(j->axis_xyz, text)) return STATUS_OK;
    j->axis = AXIS_FILE;
    if (text && read_axis_word(j->axis_xyz, text, strlen(text))) return STATUS_OK;
    if (read_numbers(j->axis_xyz, 3, r, value) && numbers_within(j->axis_xyz, 3, -1e9, 1e9) &&
        v3_length(j->axis_xyz) > 1e-9 && v3_normalize(j->axis_xyz, j->axis_xyz))
        return STATUS_OK;
    return bad_value(r, value, key, r->accepted);
}

READ_JOINT(joint_class)
{
    const char *text = scalar(value);
    return text && read_class(&j->dis_class, text) ? STATUS_OK : bad_value(r, value, key, r->accepted);
}

READ_JOINT(joint_metric)
{
    const char *text = scalar(value);
    if (text && read_metric(&j->dis_metric, text)) return STATUS_OK;
    return bad_value(r, value, key, r->accepted);
}

static Status read_limits(Reader *r, SidecarJoint *j, const char *key, const yaml_node_t *value, double most)
{
    double limit[2];
    if (!read_numbers(limit, 2, r, value) || !numbers_within(limit, 2, -most, most) || !(limit[0] <= limit[1]))
        return bad_value(r, value, key, r->accepted);
    if (j->has_limits) {
        log_error("sidecar: %s:%d: %s: limits are given in degrees and in metres; a joint turns or slides", r->path,
                  line_of(value), key);
        return STATUS_BAD_VALUE;
    }
    j->has_limits = true;
    j->low = limit[0];
    j->high = limit[1];
    return STATUS_OK;
}

READ_JOINT(joint_limits_deg)
{
    const Status status = read_limits(r, j, key, value, 3600);
    j->low *= rad_per_deg;
    j->high *= rad_per_deg;
    return status;
}

READ_JOINT(joint_limits_m)
{
    j->slides = true;
    return read_limits(r, j, key, value, 1000);
}

READ_JOINT(joint_rest_deg)
{
    if (!read_numbers(&j->rest, 1, r, value) || !numbers_within(&j->rest, 1, -360, 360))
        return bad_value(r, value, key, r->accepted);
    j->rest *= rad_per_deg;
    return STATUS_OK;
}

READ_JOINT(joint_spin_rpm)
{
    if (!read_numbers(&j->spin_rps, 1, r, value) || !numbers_within(&j->spin_rps, 1, -1e5, 1e5))
        return bad_value(r, value, key, r->accepted);
    j->spin_rps *= 2 * pi_rad / 60;
    return STATUS_OK;
}

READ_JOINT(joint_roll_radius)
{
    const char *text = scalar(value);
    j->roll_radius_m = -1;
    if (text && strcmp(text, "auto") == 0) return STATUS_OK;
    if (!read_numbers(&j->roll_radius_m, 1, r, value) || !numbers_within(&j->roll_radius_m, 1, 0.01, 10))
        return bad_value(r, value, key, r->accepted);
    return STATUS_OK;
}

static const Key joint_keys[] = {
    {"name", "text", "a name of 1 .. 95 characters",
     "as other joints name it in parent; else the node's own name", joint_name},
    {"nodes", "patterns", "1 .. 16 patterns of 1 .. 95 characters",
     "which nodes move, with all below them; needed", joint_nodes},
    {"parent", "text", "the name of a joint", "what it is carried by; else by the file's hierarchy", joint_parent},
    {"each", "bool", "true or false", "every node that matches is a joint of its own", joint_each},
    {"pivot", "word or 3 numbers", "node, centre, or x y z in -1e9 .. 1e9 units of the file",
     "what it turns about; node: where the node stands", joint_pivot},
    {"axis", "word or 3 numbers",
     "yaw, pitch, roll, forward, back, right, left, up, down, +x .. -z, or x y z not all 0",
     "else by metric: azimuth yaw, elevation pitch", joint_axis},
    {"class", "word or number", CLASS_ACCEPTED, "of the articulated parameter of DIS that moves it", joint_class},
    {"metric", "word", "one of position, extension, x, y, z, azimuth, elevation, rotation",
     "and its metric", joint_metric},
    {"limits_deg", "2 numbers", "low high in -3600 .. 3600 deg, low <= high", "of what turns", joint_limits_deg},
    {"limits_m", "2 numbers", "low high in -1000 .. 1000 m, low <= high", "of what slides", joint_limits_m},
    {"rest_deg", "number", "a number in -360 .. 360 deg", "value at which the file draws it", joint_rest_deg},
    {"spin_rpm", "number", "a number in -1e5 .. 1e5 turns a minute",
     "turns by itself while the entity is active: rotors", joint_spin_rpm},
    {"roll_radius", "word or number", "auto or a number in 0.01 .. 10 m",
     "of a wheel: turns as the vehicle travels; auto: by its size",
     joint_roll_radius},
};

/* What the keys of one joint demand of each other. */
static Status check_joint(const Reader *r, SidecarJoint *j)
{
    const char *what = NULL;
    if (j->pattern_count == 0)
        what = "nodes: is missing: which nodes move";
    else if (j->dis_metric && j->dis_metric < 11 && !j->slides)
        what = "metric: a length needs limits_m";
    else if (j->dis_metric >= 11 && j->slides)
        what = "metric: an angle, but limits_m says that it slides";
    else if (!j->dis_class != !j->dis_metric)
        what = "class and metric belong together; one is missing";
    else if (j->slides && (j->rest != 0 || j->spin_rps != 0 || j->roll_radius_m != 0))
        what = "rest_deg, spin_rpm and roll_radius are of joints that turn, limits_m of those that slide";
    else if (j->spin_rps != 0 && j->axis == AXIS_DEFAULT)
        what = "axis: is missing: about what spin_rpm turns";
    else if (j->each && j->pivot == PIVOT_GIVEN)
        what = "pivot: one place for each of many joints; node or centre is accepted";
    else if (j->each && j->name[0])
        what = "name: one name for each of many joints; leave it out";
    if (what) {
        log_error("sidecar: %s:%d: joints: %s", r->path, j->line, what);
        return STATUS_BAD_VALUE;
    }
    return STATUS_OK;
}

/* ---- keys at the top ------------------------------------------------------------------------------- */

#define READ_TOP(name) static Status name(Reader *r, SidecarJoint *j, const char *key, const yaml_node_t *value)

READ_TOP(top_file)
{
    (void)j;
    return copy_text(r->sidecar->file, sizeof r->sidecar->file, scalar(value))
               ? STATUS_OK
               : bad_value(r, value, key, r->accepted);
}

READ_TOP(top_name)
{
    (void)j;
    return copy_text(r->sidecar->name, sizeof r->sidecar->name, scalar(value))
               ? STATUS_OK
               : bad_value(r, value, key, r->accepted);
}

READ_TOP(top_scale)
{
    (void)j;
    double *scale = &r->sidecar->scale_m;
    if (!read_numbers(scale, 1, r, value) || !numbers_within(scale, 1, 1e-6, 1e6))
        return bad_value(r, value, key, r->accepted);
    return STATUS_OK;
}

READ_TOP(top_axes)
{
    (void)j;
    Sidecar *s = r->sidecar;
    const char *text = scalar(value);
    const char *second = text ? strchr(text, ' ') : NULL;
    s->has_axes = second && read_axis_word(s->forward, text, (size_t)(second - text)) &&
                  read_axis_word(s->up, second + 1, strlen(second + 1)) && v3_dot(s->forward, s->up) == 0;
    return s->has_axes ? STATUS_OK
                       : bad_value(r, value, key, r->accepted);
}

READ_TOP(top_origin)
{
    (void)j;
    Sidecar *s = r->sidecar;
    const char *text = scalar(value);
    if (text && strcmp(text, "auto") == 0) return STATUS_OK;
    s->has_origin = read_numbers(s->p_origin_file, 3, r, value) && numbers_within(s->p_origin_file, 3, -1e9, 1e9);
    return s->has_origin ? STATUS_OK : bad_value(r, value, key, r->accepted);
}

READ_TOP(top_crease)
{
    (void)j;
    double *crease = &r->sidecar->crease_rad;
    if (!read_numbers(crease, 1, r, value) || !numbers_within(crease, 1, 0, 180))
        return bad_value(r, value, key, r->accepted);
    *crease *= rad_per_deg;
    return STATUS_OK;
}

READ_TOP(top_drop)
{
    (void)j;
    return read_list(r, &r->sidecar->drop, key, value, 0);
}

READ_TOP(top_materials)
{
    (void)j;
    return read_rules(r, &r->sidecar->materials, key, value, 0);
}

READ_TOP(top_node_materials)
{
    (void)j;
    return read_rules(r, &r->sidecar->node_materials, key, value, 0);
}

READ_TOP(top_roles)
{
    (void)j;
    SidecarRules *roles = &r->sidecar->roles;
    const Status status = read_rules(r, roles, key, value, 0);
    if (status != STATUS_OK) return status;
    for (int i = 0; i < roles->count; i++) {
        HeatRole role;
        if (heat_role_find(&role, roles->rule[i].value)) continue;
        char accepted[256];
        size_t n = 0;
        for (int k = 0; k < HEAT_ROLE_COUNT && n < sizeof accepted; k++)
            n +=
                (size_t)snprintf(accepted + n, sizeof accepted - n, "%s%s", k ? ", " : "", heat_role_name((HeatRole)k));
        log_error("sidecar: %s:%d: %s: '%s' is not one of %s", r->path, roles->rule[i].line, key, roles->rule[i].value,
                  accepted);
        return STATUS_BAD_VALUE;
    }
    return STATUS_OK;
}

static Status read_damage_state(Reader *r, int state, const char *where, const yaml_node_t *mapping)
{
    bool seen[2] = {false, false};
    if (mapping->type != YAML_MAPPING_NODE) return bad_value(r, mapping, where, "`hide:` and `materials:`");
    for (const yaml_node_pair_t *pair = mapping->data.mapping.pairs.start; pair < mapping->data.mapping.pairs.top;
         pair++) {
        const yaml_node_t *name = yaml_document_get_node(r->document, pair->key);
        const yaml_node_t *value = yaml_document_get_node(r->document, pair->value);
        const char *text = scalar(name);
        char full[96];
        const bool hide = text && strcmp(text, "hide") == 0;
        if (!hide && !(text && strcmp(text, "materials") == 0)) return bad_value(r, name, where, "hide or materials");
        snprintf(full, sizeof full, "%s.%s", where, text);
        if (seen[hide]) {
            log_error("sidecar: %s:%d: %s is given twice", r->path, line_of(name), full);
            return STATUS_BAD_VALUE;
        }
        seen[hide] = true;
        const Status status = hide ? read_list(r, &r->sidecar->damage_hide, full, value, state)
                                   : read_rules(r, &r->sidecar->damage_materials, full, value, state);
        if (status != STATUS_OK) return status;
    }
    return STATUS_OK;
}

READ_TOP(top_damage)
{
    static const char *const name[model_damage_states] = {"none", "slight", "moderate", "destroyed"};
    (void)j;
    bool seen[model_damage_states] = {false};
    if (value->type != YAML_MAPPING_NODE)
        return bad_value(r, value, key, r->accepted);
    for (const yaml_node_pair_t *pair = value->data.mapping.pairs.start; pair < value->data.mapping.pairs.top; pair++) {
        const yaml_node_t *word = yaml_document_get_node(r->document, pair->key);
        const char *text = scalar(word);
        char full[64];
        int state = 1;
        while (state < model_damage_states && !(text && strcmp(text, name[state]) == 0)) state++;
        if (state == model_damage_states) return bad_value(r, word, key, "one of slight, moderate, destroyed");
        snprintf(full, sizeof full, "damage.%s", text);
        if (seen[state]) {
            log_error("sidecar: %s:%d: %s is given twice", r->path, line_of(word), full);
            return STATUS_BAD_VALUE;
        }
        seen[state] = true;
        const Status status = read_damage_state(r, state, full, yaml_document_get_node(r->document, pair->value));
        if (status != STATUS_OK) return status;
    }
    return STATUS_OK;
}

READ_TOP(top_joints)
{
    (void)j;
    Sidecar *s = r->sidecar;
    if (value->type != YAML_SEQUENCE_NODE) return bad_value(r, value, key, r->accepted);
    const ptrdiff_t count = value->data.sequence.items.top - value->data.sequence.items.start;
    if (count > sidecar_max_joints) return bad_value(r, value, key, r->accepted);
    s->joint = calloc((size_t)count + 1, sizeof *s->joint);
    if (!s->joint) return STATUS_NO_MEMORY;
    for (; s->joint_count < count; s->joint_count++) {
        const yaml_node_t *item = yaml_document_get_node(r->document, value->data.sequence.items.start[s->joint_count]);
        SidecarJoint *joint = &s->joint[s->joint_count];
        if (item->type != YAML_MAPPING_NODE) return bad_value(r, item, key, "a joint: `- {nodes: ...}`");
        joint->line = line_of(item);
        Status status =
            read_mapping(r, joint_keys, (int)(sizeof joint_keys / sizeof *joint_keys), joint, "joints.", item);
        if (status == STATUS_OK) status = check_joint(r, joint);
        if (status != STATUS_OK) return status;
    }
    return STATUS_OK;
}

static const Key top_keys[] = {
    {"file", "path", "a path of 1 .. 511 characters",
     "the model, where it is not named as the sidecar; relative to it", top_file},
    {"name", "text", "a name of 1 .. 95 characters", "as truth says it; else the file's name", top_name},
    {"scale", "number", "a number in 1e-06 .. 1e+06 metres a unit",
     "0.001: the file is in millimetres; else 1", top_scale},
    {"axes", "2 words", "two different of +x -x +y -y +z -z: forward and up, as in '+x +z'",
     "of the file; else as its format is used", top_axes},
    {"origin", "word or 3 numbers", "auto, or x y z in -1e9 .. 1e9 units of the file",
     "centre of the base, in the file; auto: under the middle of what does not move",
     top_origin},
    {"crease_deg", "number", "a number in 0 .. 180 deg",
     "sharper edges stay sharp where the file has no normals; else 30", top_crease},
    {"drop", "patterns", "patterns of 1 .. 95 characters", "nodes that are not there", top_drop},
    {"joints", "list", "a list, a joint a line: `- {nodes: ...}`", "what moves; their keys are below", top_joints},
    {"materials", "pattern: name", "rows of etc/materials.csv or of models.materials, 1 .. 31 characters",
     "by the names of the file's materials", top_materials},
    {"node_materials", "pattern: name", "the same", "by node, before materials", top_node_materials},
    {"roles", "pattern: name", "rows of etc/heat.csv", "what warms the part", top_roles},
    {"damage", "mapping", "slight, moderate or destroyed, and what shows it",
     "each with hide: [patterns] and materials: {pattern: name}", top_damage},
};

/* ---- the file --------------------------------------------------------------------------------------- */

Sidecar sidecar_default(void) { return (Sidecar){.crease_rad = 30 * rad_per_deg}; }

void sidecar_close(Sidecar *s)
{
    SidecarRules *rules[] = {&s->drop,  &s->materials,   &s->node_materials,
                             &s->roles, &s->damage_hide, &s->damage_materials};
    for (size_t i = 0; i < sizeof rules / sizeof *rules; i++) free(rules[i]->rule);
    free(s->joint);
    memset(s, 0, sizeof *s);
}

Status sidecar_parse(Sidecar *out, const char *path, const char *text, size_t octets)
{
    Sidecar filled = sidecar_default();
    yaml_parser_t parser;
    yaml_document_t document;
    Reader r = {.path = path, .document = &document, .sidecar = &filled};
    Status status = yaml_check("sidecar", path, text, octets);

    if (status != STATUS_OK) return status;
    snprintf(filled.path, sizeof filled.path, "%s", path);
    if (!yaml_parser_initialize(&parser)) return STATUS_NO_MEMORY;
    yaml_parser_set_input_string(&parser, (const unsigned char *)text, octets);
    if (!yaml_parser_load(&parser, &document)) {
        log_error("sidecar: %s:%d: %s", path, (int)parser.problem_mark.line + 1,
                  parser.problem ? parser.problem : "not YAML");
        status = STATUS_BAD_VALUE;
    } else {
        const yaml_node_t *root = yaml_document_get_root_node(&document);
        if (root && root->type == YAML_MAPPING_NODE) {
            status = read_mapping(&r, top_keys, (int)(sizeof top_keys / sizeof *top_keys), NULL, "", root);
        } else if (root) {
            log_error("sidecar: %s:%d: expected `key: value` lines", path, line_of(root));
            status = STATUS_BAD_VALUE;
        }
        yaml_document_delete(&document);
    }
    yaml_parser_delete(&parser);
    if (status == STATUS_OK)
        *out = filled;
    else
        sidecar_close(&filled);
    return status;
}

Status sidecar_read(Sidecar *out, const char *path)
{
    char  *text;
    size_t octets;
    Status status = text_read_file(&text, &octets, "sidecar", path, sidecar_max_octets);
    if (status != STATUS_OK) return status;
    status = sidecar_parse(out, path, text, octets);
    free(text);
    return status;
}

/* ---- the keys, for people ------------------------------------------------------------------------- */

static void write_keys(FILE *to, const Key *key, size_t count, const char *before)
{
    for (size_t i = 0; i < count; i++)
        fprintf(to, "  %s%s: %s\n      %s\n      %s\n", before, key[i].name, key[i].type, key[i].accepted, key[i].help);
}

void sidecar_write_keys(FILE *to)
{
    fputs("Keys of a sidecar, NAME.yaml beside a model's file: what each takes, its range and its meaning.\n"
          "A pattern has * and ?, and is held against a node's name and against its path from the root.\n\n", to);
    write_keys(to, top_keys, sizeof top_keys / sizeof *top_keys, "");
    fputs("\nKeys of a joint, `- {nodes: ...}` below joints:\n\n", to);
    write_keys(to, joint_keys, sizeof joint_keys / sizeof *joint_keys, "joints.");
    fputs("\nroles: ", to);
    for (int k = 0; k < HEAT_ROLE_COUNT; k++) fprintf(to, "%s%s", k ? ", " : "", heat_role_name((HeatRole)k));
    fputc('\n', to);
}
