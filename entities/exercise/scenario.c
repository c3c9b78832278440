/* entities/exercise/scenario.c: YAML -> Scenario, by tables; then checks across keys. */
#include "entities/exercise/scenario.h"

#include <stdlib.h>

/* ---- keys ------------------------------------------------------------------------------------- */

#define ROW(...)       SETTING_ROW(Scenario, __VA_ARGS__)
#define GROUP_ROW(...) SETTING_ROW(ScenarioGroup, __VA_ARGS__)
#define SHOT_ROW(...)  SETTING_ROW(ScenarioShot, __VA_ARGS__)

static const Setting group_keys[] = {SCENARIO_GROUP(GROUP_ROW)}, shot_keys[] = {SCENARIO_SHOT(SHOT_ROW)},
                     keys[] = {SCENARIO_ROWS(ROW)};
enum {
    key_count = sizeof keys / sizeof *keys,
    group_key_count = sizeof group_keys / sizeof *group_keys,
    shot_key_count = sizeof shot_keys / sizeof *shot_keys
};

/* ---- items -------------------------------------------------------------------------------------- */

static ScenarioGroup default_group(void) { return (ScenarioGroup){SCENARIO_GROUP(SETTING_DEFAULT)}; }

static ScenarioShot default_shot(void) { return (ScenarioShot){SCENARIO_SHOT(SETTING_DEFAULT)}; }

/* Capacity for one more, doubled at each power of two. NULL: too many, or no memory. */
static void *grown(void **items, int count, int most, size_t size)
{
    if (count >= most) return NULL;
    if ((count & (count - 1)) == 0) {
        void *more = realloc(*items, (size_t)(count ? 2 * count : 1) * size);
        if (!more) return NULL;
        *items = more;
    }
    return (char *)*items + (size_t)count * size;
}

static void *add_group(void *owner)
{
    Scenario      *s = owner;
    void          *room = s->group;
    ScenarioGroup *item = grown(&room, s->group_count, scenario_max_groups, sizeof *item);
    s->group = room;
    if (!item) return NULL;
    *item = default_group();
    s->group_count++;
    return item;
}

static void *add_shot(void *owner)
{
    Scenario     *s = owner;
    void         *room = s->shot;
    ScenarioShot *item = grown(&room, s->shot_count, scenario_max_shots, sizeof *item);
    s->shot = room;
    if (!item) return NULL;
    *item = default_shot();
    s->shot_count++;
    return item;
}

#define ALL_KEYS "`pitviper exercise --keys`"
static const SettingTable group_table = {.module = "scenario",
                                         .row = group_keys,
                                         .count = group_key_count,
                                         .line_at = offsetof(ScenarioGroup, line),
                                         .all_keys = ALL_KEYS};
static const SettingTable shot_table = {.module = "scenario",
                                        .row = shot_keys,
                                        .count = shot_key_count,
                                        .line_at = offsetof(ScenarioShot, line),
                                        .all_keys = ALL_KEYS};
static const SettingList  lists[] = {{"vehicles", &group_table, add_group}, {"shots", &shot_table, add_shot}};
static const SettingTable table = {
    .module = "scenario", .row = keys, .count = key_count, .list = lists, .list_count = 2, .all_keys = ALL_KEYS};

static Scenario default_scenario(void) { return (Scenario){SCENARIO_ROWS(SETTING_DEFAULT)}; }

/* A number as short as it reads back equal. */
static void shortest(char out[32], double value)
{
    int digits = 6;
    do snprintf(out, 32, "%.*g", digits, value);
    while (strtod(out, NULL) != value && digits++ < 17);
}

void scenario_place_text(char out[scenario_place_size], const Scenario *s)
{
    char lat[32], lon[32], height[32];
    shortest(lat, s->place.lat_deg), shortest(lon, s->place.lon_deg), shortest(height, s->place.height_m);
    snprintf(out, scenario_place_size, "%.24s,%.24s,%.24s", lat, lon, height);
}

const char *scenario_hide_name(enum ScenarioHide hide)
{
    static const char *const names[] = {"none",   "open",   "tree-line", "wood", "hedge",
                                        "hollow", "beside", "building",  "wall"};
    return names[hide];
}

/* ---- checks across keys ------------------------------------------------------------------------- */

bool scenario_type_parse(DisEntityType *out, const char *text)
{
    static const int most[7] = {255, 255, 65535, 255, 255, 255, 255};
    int              field[7] = {0}, count = 0;
    for (const char *at = text;; at++) {
        int digits = 0;
        for (; *at >= '0' && *at <= '9' && digits < 6; at++, digits++) field[count] = 10 * field[count] + (*at - '0');
        if (digits == 0 || field[count] > most[count]) return false;
        count++;
        if (!*at || count == 7) {
            if (*at || count < 7) return false;
            break;
        }
        if (*at != '.') return false;
    }
    *out = (DisEntityType){(uint8_t)field[0], (uint8_t)field[1], (uint16_t)field[2], (uint8_t)field[3],
                           (uint8_t)field[4], (uint8_t)field[5], (uint8_t)field[6]};
    return true;
}

int scenario_group_size(const Scenario *scenario, const ScenarioGroup *group)
{
    if (group->count == 1) return 1;
    return (int)clamp(rint(group->count * scenario->scale), 1, scenario_max_entities + 1);
}

static int munitions(const ScenarioShot *shot) { return shot->entity ? shot->rounds : 0; }

bool scenario_ids(int *ids, const Scenario *scenario)
{
    enum { all = 65534 };
    bool      taken[all] = {false}, fits = true;
    const int groups = scenario->group_count, items = groups + scenario->shot_count;
    /* those that name theirs first */
    for (int pass = 0; pass < 2 && fits; pass++) {
        int next = 1;
        for (int i = 0; i < items && fits; i++) {
            const int named = i < groups ? scenario->group[i].id : scenario->shot[i - groups].id;
            const int size = i < groups ? scenario_group_size(scenario, &scenario->group[i])
                                        : munitions(&scenario->shot[i - groups]);
            if (size == 0) ids[i] = 0;
            if ((named != 0) != (pass == 0) || size == 0) continue;
            int first = named ? named : next;
            for (int k = 0; !named && k < size && first + k < all; k++)
                if (taken[first + k]) first += k + 1, k = -1;
            fits = first + size <= all;
            for (int k = 0; k < size && fits; k++) {
                fits = !taken[first + k];
                taken[first + k] = true;
            }
            ids[i] = first;
            if (!named) next = first + size;
        }
    }
    return fits;
}

bool scenario_find(int *group, int *member, const Scenario *scenario, const int *ids, const char *name)
{
    const char *blank = strrchr(name, ' ');
    long long   id;
    if (!blank || !text_to_long(&id, blank + 1)) return false;
    for (int g = 0; g < scenario->group_count; g++) {
        const ScenarioGroup *each = &scenario->group[g];
        if (strlen(each->name) != (size_t)(blank - name) || strncmp(each->name, name, (size_t)(blank - name)) != 0)
            continue;
        if (id < ids[g] || id >= ids[g] + scenario_group_size(scenario, each)) continue;
        *group = g;
        *member = (int)(id - ids[g]);
        return true;
    }
    return false;
}

static bool type_fits(const Scenario *s, int line, const char *key, const char *type)
{
    DisEntityType parsed;
    /* a name is looked up by cast_create; digits alone are a typing error */
    if (*type && !(type[0] >= '0' && type[0] <= '9')) return true;
    if (scenario_type_parse(&parsed, type)) return true;
    char shown[128];
    text_escape(shown, sizeof shown, type, strlen(type));
    log_error("scenario: %s:%d: %s: type: '%s' is neither seven numbers with dots, 1.1.222.1.1.1.0, nor a model of "
              "etc/catalog.csv",
              s->path, line, key, shown);
    return false;
}

static bool hide_fits(const Scenario *s, const ScenarioGroup *group)
{
    const char *wrong = NULL;
    if (group->hide == SCENARIO_HIDE_NONE) wrong = *group->beside ? "beside: needs hide: beside" : NULL;
    else if (!s->ground.planted) wrong = "hide: needs ground.planted: true, whose plants are known";
    else if (!s->ground.buildings && (group->hide == SCENARIO_HIDE_BUILDING || group->hide == SCENARIO_HIDE_WALL))
        wrong = "hide: building and wall need ground.buildings: true";
    else if (group->route_m.count != 2) wrong = "hide: needs one place in route_m, near which it stands";
    else if ((group->hide == SCENARIO_HIDE_BESIDE) != (*group->beside != 0))
        wrong = "hide: beside and beside: NAME ID need each other";
    if (wrong) log_error("scenario: %s:%d: vehicles: %s", s->path, group->line, wrong);
    return !wrong;
}

static bool group_fits(const Scenario *s, const ScenarioGroup *group)
{
    const int numbers = group->route_m.count;
    if (numbers < 2 || numbers % 2 != 0) {
        log_error("scenario: %s:%d: vehicles: route_m: %d numbers; give [[x, y], ...], at least one place", s->path,
                  group->line, numbers);
        return false;
    }
    if (numbers == 4 && group->loop) {
        log_error("scenario: %s:%d: vehicles: loop: needs at least three places in route_m", s->path, group->line);
        return false;
    }
    if (!hide_fits(s, group)) return false;
    const int places = numbers / 2;
    for (int i = 0; places > 1 && i < places - (group->loop ? 0 : 1); i++) {
        const double *a = &group->route_m.number[2 * i], *b = &group->route_m.number[2 * ((i + 1) % places)];
        if (hypot(a[0] - b[0], a[1] - b[1]) >= 0.1) continue;
        log_error("scenario: %s:%d: vehicles: route_m: place %d is less than 0.1 m from the next; leave one out%s",
                  s->path, group->line, i + 1, i == places - 1 ? ", a loop closes by itself" : "");
        return false;
    }
    if (places > 1 && 0.25 * group->unsteady_m > 0.9 * group->speed_mps) {
        log_error("scenario: %s:%d: vehicles: unsteady_m: more than 3.6 x speed_mps would drive backwards", s->path,
                  group->line);
        return false;
    }
    if (group->leaves_s <= group->appears_s) {
        log_error("scenario: %s:%d: vehicles: leaves_s is not after appears_s", s->path, group->line);
        return false;
    }
    return type_fits(s, group->line, "vehicles", group->type);
}

static bool name_fits(const Scenario *s, const int *ids, int line, const char *list, const char *key, const char *name)
{
    int group, member;
    if (scenario_find(&group, &member, s, ids, name)) return true;
    char shown[128];
    text_escape(shown, sizeof shown, name, strlen(name));
    const ScenarioGroup *first = s->group_count ? s->group : NULL;
    log_error("scenario: %s:%d: %s: %s: there is no '%s'; an entity is called by name and id%s%.*s%s", s->path, line,
              list, key, shown, first ? ", for example '" : "", first ? scenario_name_size : 0,
              first ? first->name : "", first ? " N'" : "");
    return false;
}

/* What it stands beside stands itself, and does not hide. */
static bool beside_fits(const Scenario *s, const int *ids, const ScenarioGroup *group)
{
    int at, member;
    if (!*group->beside) return true;
    if (!name_fits(s, ids, group->line, "vehicles", "beside", group->beside)) return false;
    scenario_find(&at, &member, s, ids, group->beside);
    if (s->group[at].hide == SCENARIO_HIDE_NONE && s->group[at].route_m.count == 2) return true;
    log_error("scenario: %s:%d: vehicles: beside: '%s' moves or hides itself; name what stands at its route_m", s->path,
              group->line, group->beside);
    return false;
}

static bool shot_fits(const Scenario *s, const int *ids, const ScenarioShot *shot)
{
    if (!name_fits(s, ids, shot->line, "shots", "from", shot->from)) return false;
    if (*shot->at && !name_fits(s, ids, shot->line, "shots", "at", shot->at)) return false;
    if ((*shot->at != 0) == (shot->at_m.count != 0) || (shot->at_m.count != 0 && shot->at_m.count != 2)) {
        log_error("scenario: %s:%d: shots: give either at: NAME ID, or at_m: [x, y]", s->path, shot->line);
        return false;
    }
    if (*shot->at && strcmp(shot->at, shot->from) == 0) {
        log_error("scenario: %s:%d: shots: at: '%s' shoots at itself", s->path, shot->line, shot->at);
        return false;
    }
    if (!*shot->at && !*shot->flies && shot->hit == SCENARIO_HIT_ENTITY) {
        log_error("scenario: %s:%d: shots: hit: a place is not an entity; use hit: ground, or miss", s->path,
                  shot->line);
        return false;
    }
    if (shot->sight_noise_mrad > 0 && !(shot->sight_memory > 0)) {
        log_error("scenario: %s:%d: shots: sight_noise_mrad: true rates have no noise; give sight_memory too, as 0.7",
                  s->path, shot->line);
        return false;
    }
    if (shot->sight_late_s > 200 * fmax(shot->sight_every_s, 0.001)) {
        log_error("scenario: %s:%d: shots: sight_late_s: %g s is more than 200 measurements, at sight_every_s of %g",
                  s->path, shot->line, shot->sight_late_s, shot->sight_every_s);
        return false;
    }
    if (shot->launch_m.count != 0 && shot->launch_m.count != 3) {
        log_error("scenario: %s:%d: shots: launch_m: %d numbers; give [forward, right, down]", s->path, shot->line,
                  shot->launch_m.count);
        return false;
    }
    return type_fits(s, shot->line, "shots", shot->type);
}

static bool date_fits(const Scenario *s, const char *key, const char *text)
{
    double unix_s;
    if (!*text || (text_to_unix_s(&unix_s, text) && unix_s >= 0)) return true;
    char shown[128];
    text_escape(shown, sizeof shown, text, strlen(text));
    log_error("scenario: %s: %s: '%s' is not UTC like 2024-06-21T18:00:00Z, 1970 .. 2100", s->path, key, shown);
    return false;
}

static bool counts_fit(const Scenario *s)
{
    long long entities = 0, rounds = 0, flown = 0;
    for (int i = 0; i < s->group_count; i++) entities += scenario_group_size(s, &s->group[i]);
    for (int i = 0; i < s->shot_count; i++) {
        entities += munitions(&s->shot[i]);
        rounds += s->shot[i].rounds;
        flown += *s->shot[i].flies ? s->shot[i].rounds : 0;
    }
    if (flown > scenario_max_flown) {
        log_error("scenario: %s: shots: %lld rounds fly (flies); at most %d", s->path, flown, scenario_max_flown);
        return false;
    }
    if (entities <= scenario_max_entities && rounds <= scenario_max_rounds) return true;
    log_error("scenario: %s: %lld entities and %lld rounds; at most %d and %d (vehicles: count, shots: rounds, scale)",
              s->path, entities, rounds, scenario_max_entities, scenario_max_rounds);
    return false;
}

static const double least_bad_s = 1e-3; /* as many as ticks at the highest rate: with 1e-20 a tick would not end */

Status scenario_check(const Scenario *s)
{
    if (!date_fits(s, "dis.date", s->dis.date) || !date_fits(s, "dis.clock", s->dis.clock)) return STATUS_BAD_VALUE;
    if (s->dis.updates && s->dis.version == 5) {
        log_error("scenario: %s: dis.updates: version 5 has no Entity State Update; say dis.version 6 or 7", s->path);
        return STATUS_BAD_VALUE;
    }
    if (s->faults.bad_every_s > 0 && s->faults.bad_every_s < least_bad_s) {
        log_error("scenario: %s: faults.bad_every_s: %g is neither 0 nor in %g .. 1e6 s", s->path,
                  s->faults.bad_every_s, least_bad_s);
        return STATUS_BAD_VALUE;
    }
    for (int i = 0; i < s->group_count; i++)
        if (!group_fits(s, &s->group[i])) return STATUS_BAD_VALUE;
    if (!counts_fit(s)) return STATUS_BAD_VALUE;
    int *ids = calloc((size_t)(s->group_count + s->shot_count) + 1, sizeof *ids);
    if (!ids) return STATUS_NO_MEMORY;
    bool fits = scenario_ids(ids, s);
    if (!fits) log_error("scenario: %s: entity numbers are given twice or above 65533 (id, count)", s->path);
    for (int i = 0; i < s->shot_count && fits; i++) fits = shot_fits(s, ids, &s->shot[i]);
    for (int i = 0; i < s->group_count && fits; i++) fits = beside_fits(s, ids, &s->group[i]);
    free(ids);
    return fits ? STATUS_OK : STATUS_BAD_VALUE;
}

/* ---- the file ------------------------------------------------------------------------------------ */

/* A group of nets for each group that has them: so many, where its members are. */
static Status add_nets(Scenario *s)
{
    const int groups = s->group_count;
    for (int g = 0; g < groups; g++) {
        if (!s->group[g].net) continue;
        ScenarioGroup *net = add_group(s);
        if (!net) {
            log_error("scenario: %s: more than %d groups with their nets", s->path, scenario_max_groups);
            return STATUS_BAD_VALUE;
        }
        *net = s->group[g];
        snprintf(net->name, sizeof net->name, "Net");
        snprintf(net->type, sizeof net->type, "net");
        net->over = g + 1;
        net->id = 0;
        net->engine = net->net = net->parked = false;
        net->turret = SCENARIO_TURRET_NONE, net->dust = SCENARIO_DUST_NONE;
        net->appearance = 0;
        net->hide = SCENARIO_HIDE_NONE, net->beside[0] = 0;
    }
    return STATUS_OK;
}

Status scenario_read(Scenario *out, const char *path)
{
    Scenario s = default_scenario();
    *out = (Scenario){0};
    snprintf(s.path, sizeof s.path, "%s", path);
    Status status = settings_read(&s, NULL, &table, path);
    if (status == STATUS_OK) status = add_nets(&s);
    if (status == STATUS_OK) status = scenario_check(&s);
    if (status == STATUS_OK) *out = s;
    else scenario_destroy(&s);
    return status;
}

Status scenario_set(Scenario *scenario, const char *key, const char *value, const char *source)
{
    return settings_set(scenario, NULL, &table, key, value, source);
}

static Status none_named(const char *list, const char *name, const char *source)
{
    char shown[128];
    text_escape(shown, sizeof shown, name, strlen(name));
    log_error("scenario: %s: there are no %s with name: '%s'", source, list, shown);
    return STATUS_BAD_VALUE;
}

Status scenario_set_group(Scenario *scenario, const char *name, const char *key, const char *value, const char *source)
{
    bool any = false;
    if (strcmp(key, "net") == 0 || strcmp(key, "name") == 0) {
        log_error("scenario: %s: %s: is of the file alone", source, key);
        return STATUS_BAD_VALUE;
    }
    for (int g = 0; g < scenario->group_count; g++) {
        ScenarioGroup *group = &scenario->group[g];
        const bool     over = group->over && strcmp(scenario->group[group->over - 1].name, name) == 0;
        if (over) { /* nets are where what they cover is, and as many */
            const char *const same[] = {"count", "columns", "route_m", "appears_s", "leaves_s", "leaves"};
            bool              taken = false;
            for (size_t k = 0; k < sizeof same / sizeof *same; k++) taken |= strcmp(key, same[k]) == 0;
            if (taken && settings_set(group, NULL, &group_table, key, value, source) != STATUS_OK)
                return STATUS_BAD_VALUE;
            continue;
        }
        if (group->over || strcmp(group->name, name) != 0) continue;
        const Status status = settings_set(group, NULL, &group_table, key, value, source);
        if (status != STATUS_OK) return status;
        any = true;
    }
    if (any) return STATUS_OK;
    return none_named("vehicles", name, source);
}

Status scenario_set_shot(Scenario *scenario, const char *name, const char *key, const char *value, const char *source)
{
    bool any = false;
    for (int i = 0; i < scenario->shot_count; i++) {
        ScenarioShot *shot = &scenario->shot[i];
        if (strcmp(shot->name, name) != 0) continue;
        const Status status = settings_set(shot, NULL, &shot_table, key, value, source);
        if (status != STATUS_OK) return status;
        any = true;
    }
    if (any) return STATUS_OK;
    return none_named("shots", name, source);
}

/* LIST.NAME.key, with list: `vehicles.` or `shots.`; the name may hold dots. False: it is of no item of that list. */
static bool split_key(char name[scenario_name_size], const char **key, const char *text, const char *list)
{
    const char *dot = strrchr(text, '.'), *from = text + strlen(list);
    if (strncmp(text, list, strlen(list)) != 0 || dot <= from || dot - from >= scenario_name_size) return false;
    memcpy(name, from, (size_t)(dot - from));
    name[dot - from] = 0;
    *key = dot + 1;
    return true;
}

Status scenario_set_any(Scenario *scenario, const char *key, const char *value, const char *source)
{
    char        name[scenario_name_size];
    const char *of_item;
    if (split_key(name, &of_item, key, "vehicles.")) return scenario_set_group(scenario, name, of_item, value, source);
    if (split_key(name, &of_item, key, "shots.")) return scenario_set_shot(scenario, name, of_item, value, source);
    return scenario_set(scenario, key, value, source);
}

bool scenario_key_type(SettingType *out, const char *key)
{
    char                name[scenario_name_size];
    const char         *of_item = key;
    const SettingTable *of = split_key(name, &of_item, key, "vehicles.") ? &group_table
                             : split_key(name, &of_item, key, "shots.")  ? &shot_table
                                                                         : &table;
    const int           row = settings_find(of, of_item);
    if (row < 0) return false;
    *out = of->row[row].type;
    return true;
}

void scenario_destroy(Scenario *scenario)
{
    free(scenario->group);
    free(scenario->shot);
    *scenario = (Scenario){0};
}

void scenario_write_keys(FILE *to)
{
    const Scenario      s = default_scenario();
    const ScenarioGroup group = default_group();
    const ScenarioShot  shot = default_shot();
    settings_write(to, &table, &s, NULL);
    fputs("\nvehicles:  # a list, `- name: ...`; each item has\n", to);
    settings_write(to, &group_table, &group, NULL);
    fputs("\nshots:  # a list, `- from: ...`; each item has\n", to);
    settings_write(to, &shot_table, &shot, NULL);
}
