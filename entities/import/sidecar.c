/* entities/import/sidecar.c: the sidecar's YAML into plain values, by tables of settings. */
#include "entities/import/sidecar.h"
#include "pitviper_settings.h"

#include <stdlib.h>

/* `count` finite numbers with blanks between, each within a range. */
static bool read_numbers(double *out, int count, const char *text, double low, double high)
{
    for (int i = 0; i < count; i++) {
        char word[64];
        text += strspn(text, " \t");
        const size_t length = strcspn(text, " \t");
        if (length == 0 || length >= sizeof word) return false;
        memcpy(word, text, length);
        word[length] = 0;
        if (!text_to_double(out + i, word) || !(out[i] >= low && out[i] <= high)) return false;
        text += length;
    }
    return text[strspn(text, " \t")] == 0;
}

static bool copy_text(char *out, size_t size, const char *text)
{
    if (!*text || strlen(text) >= size) return false;
    strcpy(out, text);
    return true;
}

/* ---- words ------------------------------------------------------------------------------------- */

/* SISO-REF-010, articulated parts, type classes (from memory); ten of each, 32 apart. */
static const struct {
    const char *name;
    uint32_t    first;
    int         numbers;
} classes[] = {
    {"primary_turret", 4096, 10},  {"primary_gun", 4416, 10},        {"primary_launcher", 4736, 10},
    {"primary_defence", 5056, 10}, {"primary_radar", 5376, 10},      {"secondary_turret", 5696, 10},
    {"secondary_gun", 6016, 10},   {"secondary_launcher", 6336, 10}, {"secondary_defence", 6656, 10},
    {"secondary_radar", 6976, 10},
};
#define CLASS_ACCEPTED                                                                                                 \
    "primary_ or secondary_ and turret, gun, launcher, defence or radar, then _1 .. "                                  \
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
    uint32_t    metric;
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
        double      axis[3];
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

/* ---- a joint ------------------------------------------------------------------------------------- */

static bool read_limits(SidecarJoint *j, const char *text, double most, double unit)
{
    double limit[2];
    if (!read_numbers(limit, 2, text, -most, most) || !(limit[0] <= limit[1])) return false;
    j->has_limits = true;
    j->low = limit[0] * unit;
    j->high = limit[1] * unit;
    return true;
}

static bool read_pivot(SidecarJoint *j, const char *text)
{
    j->pivot = strcmp(text, "node") == 0 ? PIVOT_NODE : strcmp(text, "centre") == 0 ? PIVOT_CENTRE : PIVOT_GIVEN;
    return j->pivot != PIVOT_GIVEN || read_numbers(j->p_pivot_file, 3, text, -1e9, 1e9);
}

static bool read_axis(SidecarJoint *j, const char *text)
{
    j->axis = AXIS_BODY;
    if (read_body_axis(j->axis_xyz, text)) return true;
    j->axis = AXIS_FILE;
    return read_axis_word(j->axis_xyz, text, strlen(text)) ||
           (read_numbers(j->axis_xyz, 3, text, -1e9, 1e9) && v3_length(j->axis_xyz) > 1e-9 &&
            v3_normalize(j->axis_xyz, j->axis_xyz));
}

static Status joint_own(const char **complaint, void *out, const Setting *row, SettingValue *value)
{
    SidecarJoint *j = out;
    const char   *text = value->text;
    bool          fine = false;
    switch (row->offset) {
    case offsetof(SidecarJoint, pattern):
        fine =
            j->pattern_count < sidecar_max_patterns && copy_text(j->pattern[j->pattern_count], model_name_size, text);
        j->pattern_count += fine;
        break;
    case offsetof(SidecarJoint, pivot):
        fine = read_pivot(j, text);
        break;
    case offsetof(SidecarJoint, axis):
        fine = read_axis(j, text);
        break;
    case offsetof(SidecarJoint, dis_class):
        fine = read_class(&j->dis_class, text);
        break;
    case offsetof(SidecarJoint, dis_metric):
        fine = read_metric(&j->dis_metric, text);
        break;
    case offsetof(SidecarJoint, roll_radius_m):
        j->roll_radius_m = -1;
        fine = strcmp(text, "auto") == 0 || read_numbers(&j->roll_radius_m, 1, text, 0.01, 10);
        break;
    case offsetof(SidecarJoint, low):    /* limits_deg */
    case offsetof(SidecarJoint, slides): /* limits_m */
        if (j->has_limits) {
            *complaint = "a second pair of limits, in degrees and in metres; a joint turns or slides";
            return STATUS_BAD_VALUE;
        }
        j->slides = row->offset == offsetof(SidecarJoint, slides);
        fine = j->slides ? read_limits(j, text, 1000, 1) : read_limits(j, text, 3600, rad_per_deg);
        break;
    }
    return fine ? STATUS_OK : STATUS_BAD_VALUE;
}

#define OWN(type, member) SETTING_OWN, SETTING_AT(type, member), 0, 0

static const Setting joint_keys[] = {
    {"name", SETTING_TEXT, SETTING_AT(SidecarJoint, name), 0, 0, NULL, "",
     "as other joints name it in parent; else the node's own name"},
    {"nodes", SETTING_EACH, SETTING_AT(SidecarJoint, pattern), 0, 0, "1 .. 16 patterns of 1 .. 95 characters", "",
     "which nodes move, with all below them; needed"},
    {"parent", SETTING_TEXT, SETTING_AT(SidecarJoint, parent), 0, 0, NULL, "",
     "the joint that carries it; else by the file's hierarchy"},
    {"each", SETTING_BOOL, SETTING_AT(SidecarJoint, each), 0, 0, NULL, "",
     "every node that matches is a joint of its own"},
    {"pivot", OWN(SidecarJoint, pivot), "node, centre, or x y z in -1e9 .. 1e9 units of the file", "",
     "what it turns about; node: where the node stands"},
    {"axis", OWN(SidecarJoint, axis),
     "yaw, pitch, roll, forward, back, right, left, up, down, +x .. -z, or x y z not all 0", "",
     "else by metric: azimuth yaw, elevation pitch"},
    {"class", OWN(SidecarJoint, dis_class), CLASS_ACCEPTED, "", "of the articulated parameter of DIS that moves it"},
    {"metric", OWN(SidecarJoint, dis_metric), "one of position, extension, x, y, z, azimuth, elevation, rotation", "",
     "and its metric"},
    {"limits_deg", OWN(SidecarJoint, low), "low high in -3600 .. 3600 deg, low <= high", "", "of what turns"},
    {"limits_m", OWN(SidecarJoint, slides), "low high in -1000 .. 1000 m, low <= high", "", "of what slides"},
    {"rest_deg", SETTING_DOUBLE, SETTING_AT(SidecarJoint, rest), -360, 360, NULL, "deg",
     "value at which the file draws it"},
    {"spin_rpm", SETTING_DOUBLE, SETTING_AT(SidecarJoint, spin_rps), -1e5, 1e5, NULL, "turns a minute",
     "turns by itself while the entity is active: rotors"},
    {"roll_radius", OWN(SidecarJoint, roll_radius_m), "auto or a number in 0.01 .. 10 m", "",
     "of a wheel: turns as the vehicle travels; auto: by its size"},
};
static const SettingTable joint_table = {.module = "sidecar",
                                         .row = joint_keys,
                                         .count = sizeof joint_keys / sizeof *joint_keys,
                                         .line_at = offsetof(SidecarJoint, line),
                                         .all_keys = "`pitviper model --keys`",
                                         .prefix = "joints.",
                                         .own = joint_own};

/* Degrees and turns a minute to radians, and what the keys of one joint demand of each other. */
static Status finish_joint(const Sidecar *s, SidecarJoint *j)
{
    const char *what = NULL;
    j->rest *= rad_per_deg;
    j->spin_rps *= 2 * pi_rad / 60;
    if (j->pattern_count == 0) what = "nodes: is missing: which nodes move";
    else if (j->dis_metric && j->dis_metric < 11 && !j->slides) what = "metric: a length needs limits_m";
    else if (j->dis_metric >= 11 && j->slides) what = "metric: an angle, but limits_m says that it slides";
    else if (!j->dis_class != !j->dis_metric) what = "class and metric belong together; one is missing";
    else if (j->slides && (j->rest != 0 || j->spin_rps != 0 || j->roll_radius_m != 0))
        what = "rest_deg, spin_rpm and roll_radius are of joints that turn, limits_m of those that slide";
    else if (j->spin_rps != 0 && j->axis == AXIS_DEFAULT) what = "axis: is missing: about what spin_rpm turns";
    else if (j->each && j->pivot == PIVOT_GIVEN)
        what = "pivot: one place for each of many joints; node or centre is accepted";
    else if (j->each && j->name[0]) what = "name: one name for each of many joints; leave it out";
    if (what) log_error("sidecar: %s:%d: joints: %s", s->path, j->line, what);
    return what ? STATUS_BAD_VALUE : STATUS_OK;
}

static void *add_joint(void *owner)
{
    Sidecar *s = owner;
    if (!s->joint) s->joint = calloc(sidecar_max_joints, sizeof *s->joint);
    return s->joint && s->joint_count < sidecar_max_joints ? &s->joint[s->joint_count++] : NULL;
}

/* ---- keys at the top ------------------------------------------------------------------------------- */

static const char *heat_roles(void)
{
    static _Thread_local char text[256];
    size_t                    n = (size_t)snprintf(text, sizeof text, "not one of ");
    for (int k = 0; k < HEAT_ROLE_COUNT && n < sizeof text; k++)
        n += (size_t)snprintf(text + n, sizeof text - n, "%s%s", k ? ", " : "", heat_role_name((HeatRole)k));
    return text;
}

/* damage: the state it belongs to; 0: none. */
static Status add_rule(const char **complaint, SidecarRules *rules, SettingValue *value, int damage)
{
    SidecarRule rule = {.line = value->line, .damage = damage};
    value->wrong_key = value->key != NULL;
    *complaint = "not a pattern of 1 .. 95 characters";
    if (!copy_text(rule.pattern, sizeof rule.pattern, value->key ? value->key : value->text)) return STATUS_BAD_VALUE;
    *complaint = "given twice";
    for (int i = 0; i < rules->count; i++)
        if (value->key && rules->rule[i].damage == damage && strcmp(rules->rule[i].pattern, rule.pattern) == 0)
            return STATUS_BAD_VALUE;
    *complaint = "one pattern too many; there may be 4096";
    if (rules->count == sidecar_max_rules) return STATUS_BAD_VALUE;
    value->wrong_key = false;
    *complaint = "not a name of 1 .. 31 characters";
    if (value->key && !copy_text(rule.value, sizeof rule.value, value->text)) return STATUS_BAD_VALUE;
    if ((rules->count & (rules->count - 1)) == 0) { /* capacity: a power of two */
        SidecarRule *grown = realloc(rules->rule, (rules->count ? 2 * (size_t)rules->count : 1) * sizeof *grown);
        if (!grown) return STATUS_NO_MEMORY;
        rules->rule = grown;
    }
    rules->rule[rules->count++] = rule;
    return STATUS_OK;
}

static bool read_axes(Sidecar *s, const char *text)
{
    const char *second = strchr(text, ' ');
    return second && read_axis_word(s->forward, text, (size_t)(second - text)) &&
           read_axis_word(s->up, second + 1, strlen(second + 1)) && v3_dot(s->forward, s->up) == 0;
}

static Status top_own(const char **complaint, void *out, const Setting *row, SettingValue *value)
{
    Sidecar *s = out;
    HeatRole role;
    double   thickness_mm;
    switch (row->offset) {
    case offsetof(Sidecar, has_axes):
        return (s->has_axes = read_axes(s, value->text)) ? STATUS_OK : STATUS_BAD_VALUE;
    case offsetof(Sidecar, has_origin):
        s->has_origin = strcmp(value->text, "auto") != 0;
        return !s->has_origin || read_numbers(s->p_origin_file, 3, value->text, -1e9, 1e9) ? STATUS_OK
                                                                                           : STATUS_BAD_VALUE;
    case offsetof(Sidecar, roles):
        if (heat_role_find(&role, value->text)) break;
        *complaint = heat_roles();
        return STATUS_BAD_VALUE;
    case offsetof(Sidecar, thickness):
        if (read_numbers(&thickness_mm, 1, value->text, 0.1, 1000)) break;
        *complaint = "not a thickness in 0.1 .. 1000 mm";
        return STATUS_BAD_VALUE;
    }
    return add_rule(complaint, (SidecarRules *)(void *)((char *)out + row->offset), value, (int)row->low);
}

/* A row's lower end is the state of damage that its rules belong to. */
#define RULES(kind, member, damage) kind, SETTING_AT(Sidecar, member), damage, 0
#define PATTERNS                    "a pattern or a list of them"
#define NAMES                       "`pattern: name` for each, a row of etc/materials.csv or of models.materials, 1 .. 31 characters"
#define DAMAGE(name, state)                                                                                            \
    {"damage." name ".hide", RULES(SETTING_EACH, damage_hide, state), PATTERNS, "", "what is gone in this state"},     \
    {                                                                                                                  \
        "damage." name ".materials", RULES(SETTING_MAP, damage_materials, state), NAMES, "",                           \
            "and what looks otherwise"                                                                                 \
    }

static const Setting top_keys[] = {
    {"file", SETTING_TEXT, SETTING_AT(Sidecar, file), 0, 0, NULL, "",
     "the model, where it is not named as the sidecar; relative to it"},
    {"name", SETTING_TEXT, SETTING_AT(Sidecar, name), 0, 0, NULL, "", "as truth says it; else the file's name"},
    {"scale", SETTING_DOUBLE, SETTING_AT(Sidecar, scale_m), 1e-6, 1e6, NULL, "metres a unit",
     "0.001: the file is in millimetres; else as the file or its format says"},
    {"axes", OWN(Sidecar, has_axes), "two different of +x -x +y -y +z -z: forward and up, as in '+x +z'", "",
     "of the file; else as it says, or as its format is used"},
    {"origin", OWN(Sidecar, has_origin), "auto, or x y z in -1e9 .. 1e9 units of the file", "",
     "centre of the base, in the file; auto: under the middle of what does not move"},
    {"crease_deg", SETTING_DOUBLE, SETTING_AT(Sidecar, crease_rad), 0, 180, NULL, "deg",
     "sharper edges stay sharp where the file has no normals; else 30"},
    {"drop", RULES(SETTING_EACH, drop, 0), PATTERNS, "", "nodes that are not there"},
    {"materials", RULES(SETTING_MAP, materials, 0), NAMES, "", "by the names of the file's materials"},
    {"node_materials", RULES(SETTING_MAP, node_materials, 0), NAMES, "", "by node, before materials"},
    {"roles", RULES(SETTING_MAP, roles, 0), "`pattern: name` for each, a row of etc/heat.csv", "",
     "what warms the part"},
    {"thickness_mm", RULES(SETTING_MAP, thickness, 0), "`pattern: number` for each, 0.1 .. 1000 mm", "mm",
     "of the part's skin, by node; else by role, as etc/heat.csv says"},
    DAMAGE("slight", 1),
    DAMAGE("moderate", 2),
    DAMAGE("destroyed", 3),
};
static const SettingList  lists[] = {{"joints", &joint_table, add_joint}};
static const SettingTable table = {.module = "sidecar",
                                   .row = top_keys,
                                   .count = sizeof top_keys / sizeof *top_keys,
                                   .list = lists,
                                   .list_count = 1,
                                   .all_keys = "`pitviper model --keys`",
                                   .own = top_own};

/* ---- the file --------------------------------------------------------------------------------------- */

static const double crease_deg = 30;

Sidecar sidecar_default(void) { return (Sidecar){.crease_rad = crease_deg * rad_per_deg}; }

void sidecar_close(Sidecar *s)
{
    SidecarRules *rules[] = {&s->drop,      &s->materials,   &s->node_materials,  &s->roles,
                             &s->thickness, &s->damage_hide, &s->damage_materials};
    for (size_t i = 0; i < sizeof rules / sizeof *rules; i++) free(rules[i]->rule);
    free(s->joint);
    memset(s, 0, sizeof *s);
}

Status sidecar_parse(Sidecar *out, const char *path, const char *text, size_t octets)
{
    Sidecar filled = {.crease_rad = crease_deg}; /* in degrees until it is read */
    snprintf(filled.path, sizeof filled.path, "%s", path);
    Status status = settings_parse(&filled, NULL, &table, path, text, octets);
    filled.crease_rad *= rad_per_deg;
    for (int j = 0; j < filled.joint_count && status == STATUS_OK; j++)
        status = finish_joint(&filled, &filled.joint[j]);
    if (status == STATUS_OK) *out = filled;
    else sidecar_close(&filled);
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

void sidecar_write_keys(FILE *to)
{
    fputs("Keys of a sidecar, NAME.yaml beside a model's file: what each takes, its range and its meaning.\n"
          "A pattern has * and ?, and is held against a node's name and against its path from the root.\n\n",
          to);
    settings_write_keys(to, &table);
    fputs("\nKeys of a joint, `- {nodes: ...}` below joints:\n\n", to);
    settings_write_keys(to, &joint_table);
    fputs("\nroles: ", to);
    for (int k = 0; k < HEAT_ROLE_COUNT; k++) fprintf(to, "%s%s", k ? ", " : "", heat_role_name((HeatRole)k));
    fputc('\n', to);
}
