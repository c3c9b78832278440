/* entities/exercise/scenario.c: YAML -> Scenario, by tables; then checks across keys. */
#include "entities/exercise/scenario.h"

#include <stdlib.h>

/* ---- keys ------------------------------------------------------------------------------------- */

#define AT(member)    SETTING_AT(Scenario, member)
#define GROUP(member) SETTING_AT(ScenarioGroup, member)
#define SHOT(member)  SETTING_AT(ScenarioShot, member)

static const Setting group_keys[] = {
    {"name", SETTING_TEXT, GROUP(name), 0, 0, NULL, "", "marking; the id is appended"},
    {"type", SETTING_TEXT, GROUP(type), 0, 0, NULL, "",
     "kind.domain.country.category.subcategory.specific.extra, or a model of etc/catalog.csv"},
    {"id", SETTING_INT, GROUP(id), 0, 65533, NULL, "", "entity number of the first; 0: the next free one"},
    {"force", SETTING_INT, GROUP(force), 0, 255, NULL, "", "1 friendly, 2 opposing, 3 neutral"},
    {"count", SETTING_INT, GROUP(count), 1, 50000, NULL, "", "number of entities"},
    {"columns", SETTING_INT, GROUP(columns), 1, 1000, NULL, "", "side by side"},
    {"spacing_m", SETTING_DOUBLE, GROUP(spacing_m), 0, 1e4, NULL, "m",
     "distance from each entity to the next one behind it"},
    {"column_m", SETTING_DOUBLE, GROUP(column_m), 0, 1e4, NULL, "m", "distance between columns"},
    {"spread_m", SETTING_DOUBLE, GROUP(spread_m), 0, 1e4, NULL, "m",
     "largest random displacement from their places, along and across"},
    {"behind_m", SETTING_DOUBLE, GROUP(behind_m), -1e5, 1e5, NULL, "m",
     "distance of the first entity behind the start of the route"},
    {"route_m", SETTING_NUMBERS, GROUP(route_m), -50000, 50000, NULL, "m", "[[x, y], ...] east and north of the place"},
    {"loop", SETTING_BOOL, GROUP(loop), 0, 1, NULL, "", "the route is repeated"},
    {"speed_mps", SETTING_DOUBLE, GROUP(speed_mps), 0, 2000, NULL, "m/s", ""},
    {"unsteady_m", SETTING_DOUBLE, GROUP(unsteady_m), 0, 100, NULL, "m",
     "amplitude of the motion ahead and behind of its place; period 25 s"},
    {"heading_deg", SETTING_DOUBLE, GROUP(heading_deg), -360, 360, NULL, "deg",
     "of entities that stand, clockwise from north"},
    {"height_m", SETTING_DOUBLE, GROUP(height_m), -1000, 100000, NULL, "m", "above the ground at each point"},
    {"start_s", SETTING_DOUBLE, GROUP(start_s), 0, 1e6, NULL, "s",
     "stands until then; absent: moves from the beginning"},
    {"stop_s", SETTING_DOUBLE, GROUP(stop_s), 0, 1e6, NULL, "s",
     "begins to stop then; absent: at the end of the route"},
    {"appears_s", SETTING_DOUBLE, GROUP(appears_s), 0, 1e6, NULL, "s", "no report before then"},
    {"leaves_s", SETTING_DOUBLE, GROUP(leaves_s), 0, 1e6, NULL, "s", "no report afterwards"},
    {"leaves", SETTING_TEXT, GROUP(leaves), 0, 0, "silent|deactivated|removed", "", "how it leaves"},
    {"turret", SETTING_TEXT, GROUP(turret), 0, 0, "none|still|swing", "",
     "articulation reported for primary turret and gun"},
    {"dust", SETTING_TEXT, GROUP(dust), 0, 0, "auto|none|small|medium|large", "", "dust trail reported while it moves"},
    {"engine", SETTING_BOOL, GROUP(engine), 0, 1, NULL, "", "runs"},
    {"parked", SETTING_BOOL, GROUP(parked), 0, 1, NULL, "", "an aircraft stands on the ground"},
    {"appearance", SETTING_INT, GROUP(appearance), 0, 2147483647, NULL, "", "further appearance bits, as one number"},
    {"dead_reckoning", SETTING_INT, GROUP(dead_reckoning), 0, 9, NULL, "",
     "algorithm 1 .. 9; 0: as dis.dead_reckoning"},
};

static const Setting shot_keys[] = {
    {"from", SETTING_TEXT, SHOT(from), 0, 0, NULL, "", "the entity that shoots, `NAME ID`"},
    {"at", SETTING_TEXT, SHOT(at), 0, 0, NULL, "", "the target, `NAME ID`"},
    {"at_m", SETTING_NUMBERS, SHOT(at_m), -50000, 50000, NULL, "m", "[x, y] of a place, instead of a target"},
    {"time_s", SETTING_DOUBLE, SHOT(time_s), 0, 1e6, NULL, "s", "of the first"},
    {"rounds", SETTING_INT, SHOT(rounds), 1, scenario_max_rounds, NULL, "", "so many"},
    {"every_s", SETTING_DOUBLE, SHOT(every_s), 0.01, 1e6, NULL, "s", "time between rounds"},
    {"entity", SETTING_BOOL, SHOT(entity), 0, 1, NULL, "", "the munition sends Entity States while it flies"},
    {"name", SETTING_TEXT, SHOT(name), 0, 0, NULL, "", "its marking, with the id behind it"},
    {"id", SETTING_INT, SHOT(id), 0, 65533, NULL, "", "its entity number; 0: the next free one"},
    {"type", SETTING_TEXT, SHOT(type), 0, 0, NULL, "", "entity type of the munition"},
    {"force", SETTING_INT, SHOT(force), 0, 255, NULL, "", "of what flies"},
    {"launch_m", SETTING_NUMBERS, SHOT(launch_m), -100, 100, NULL, "m",
     "[forward, right, down] of the shooter's origin"},
    {"launch_mps", SETTING_DOUBLE, SHOT(launch_mps), 1, 5000, NULL, "m/s", "speed at launch"},
    {"boost_mps", SETTING_DOUBLE, SHOT(boost_mps), 0, 5000, NULL, "m/s", "speed that its motor adds"},
    {"boost_s", SETTING_DOUBLE, SHOT(boost_s), 0.01, 100, NULL, "s", "time constant of the boost"},
    {"drag_mps2", SETTING_DOUBLE, SHOT(drag_mps2), 0, 100, NULL, "m/s2", "what it loses"},
    {"loft_m", SETTING_DOUBLE, SHOT(loft_m), 0, 5000, NULL, "m", "above the straight line at half way"},
    {"weave_m", SETTING_DOUBLE, SHOT(weave_m), 0, 100, NULL, "m", "about it"},
    {"hit", SETTING_TEXT, SHOT(hit), 0, 0, "entity|ground|miss", "",
     "the entity, the ground beside it, or past it into the air"},
    {"damage", SETTING_TEXT, SHOT(damage), 0, 0, "none|slight|moderate|destroyed", "",
     "damage of the entity that is hit"},
    {"silent_s", SETTING_DOUBLE, SHOT(silent_s), 0, 1000, NULL, "s", "time between its last Entity State and its end"},
    {"dead_reckoning", SETTING_INT, SHOT(dead_reckoning), 0, 9, NULL, "", "algorithm 1 .. 9; 0: as dis.dead_reckoning"},
};

static const Setting keys[] = {
    {"duration_s", SETTING_DOUBLE, AT(duration_s), 0, 1e6, NULL, "s", ""},
    {"seed", SETTING_LONG, AT(seed), 0, 1e15, NULL, "", "seed of all random numbers"},
    {"scale", SETTING_DOUBLE, AT(scale), 0.0001, 1000, NULL, "", "factor of every count above 1"},
    {"place.lat_deg", SETTING_DOUBLE, AT(place.lat_deg), -90, 90, NULL, "deg", "where x and y are 0"},
    {"place.lon_deg", SETTING_DOUBLE, AT(place.lon_deg), -180, 180, NULL, "deg", ""},
    {"place.height_m", SETTING_DOUBLE, AT(place.height_m), -400, 8000, NULL, "m",
     "height of synthetic ground above the ellipsoid"},
    {"place.turn_deg", SETTING_DOUBLE, AT(place.turn_deg), -360, 360, NULL, "deg",
     "rotation of all routes and places, clockwise"},
    {"ground.swell_m", SETTING_DOUBLE, AT(ground.swell_m), 0, 20, NULL, "m",
     "height of the swells of synthetic ground, which are 0.4 to 0.6 km long"},
    {"ground.store", SETTING_PATH, AT(ground.store), 0, 0, NULL, "",
     "terrain store of real ground (`pitviper terrain import`), instead of ground.elevation; empty: none"},
    {"ground.elevation", SETTING_PATHS, AT(ground.elevation), 0, 0, NULL, "",
     "files and folders of real ground, separated by commas, or a list; empty: synthetic ground"},
    {"ground.vertical", SETTING_TEXT, AT(ground.vertical), 0, 0, "file|geoid|ellipsoid", "",
     "vertical datum of their heights"},
    {"ground.geoid", SETTING_PATH, AT(ground.geoid), 0, 0, NULL, "", "geoid grid; empty: EGM96 of proj-data"},
    {"ground.smooth_m", SETTING_DOUBLE, AT(ground.smooth_m), 0.5, 30, NULL, "m",
     "vehicles do not follow bumps of real ground that are shorter than this"},
    {"dis.version", SETTING_INT, AT(dis.version), 5, 7, NULL, "", ""},
    {"dis.exercise", SETTING_INT, AT(dis.exercise), 0, 255, NULL, "", ""},
    {"dis.site", SETTING_INT, AT(dis.site), 1, 65533, NULL, "", ""},
    {"dis.application", SETTING_INT, AT(dis.application), 1, 65533, NULL, "", ""},
    {"dis.bundle", SETTING_BOOL, AT(dis.bundle), 0, 1, NULL, "", "several PDUs in a datagram"},
    {"dis.mtu", SETTING_INT, AT(dis.mtu), 576, 65000, NULL, "octets", "largest bundle"},
    {"dis.fillers", SETTING_BOOL, AT(dis.fillers), 0, 1, NULL, "",
     "an Attribute or Data PDU after each PDU, as some simulators send"},
    {"dis.updates", SETTING_BOOL, AT(dis.updates), 0, 1, NULL, "",
     "Entity State Update between heartbeats; versions 6 and 7"},
    {"dis.stamps", SETTING_TEXT, AT(dis.stamps), 0, 0,
     "relative|absolute|none|constant|counter|milliseconds|microseconds|unix|half-rate|double-rate", "",
     "kind of time stamps; all but the first two are errors that senders are known to make"},
    {"dis.stamp_s", SETTING_DOUBLE, AT(dis.stamp_s), 0, 3600, NULL, "s",
     "time past the hour at which relative time stamps begin"},
    {"dis.date", SETTING_TEXT, AT(dis.date), 0, 0, NULL, "",
     "UTC of the beginning in a recording, 2024-06-21T18:00:00Z"},
    {"dis.clock", SETTING_TEXT, AT(dis.clock), 0, 0, NULL, "",
     "a Start/Resume PDU first, with this UTC as simulation time"},
    {"dis.heartbeat_s", SETTING_DOUBLE, AT(dis.heartbeat_s), 0.1, 3600, NULL, "s", ""},
    {"dis.threshold_m", SETTING_DOUBLE, AT(dis.threshold_m), 0.01, 1000, NULL, "m",
     "error of dead reckoning at which a report is sent"},
    {"dis.threshold_deg", SETTING_DOUBLE, AT(dis.threshold_deg), 0.01, 180, NULL, "deg", ""},
    {"dis.dead_reckoning", SETTING_INT, AT(dis.dead_reckoning), 1, 9, NULL, "", "algorithm of entities that name none"},
    {"dis.rate_hz", SETTING_DOUBLE, AT(dis.rate_hz), 1, 1000, NULL, "Hz", "update rate of the simulator"},
    {"dis.announce_per_s", SETTING_DOUBLE, AT(dis.announce_per_s), 1, 1e6, NULL, "1/s",
     "rate of first reports, so that a large exercise does not begin with a burst"},
    {"faults.bad_every_s", SETTING_DOUBLE, AT(faults.bad_every_s), 0, 1e6, NULL, "s",
     "a malformed PDU, of 14 kinds in turn, 0.001 s apart at least; 0: none"},
    {"faults.loss", SETTING_DOUBLE, AT(faults.loss), 0, 1, NULL, "", "share of datagrams lost"},
    {"faults.duplicate", SETTING_DOUBLE, AT(faults.duplicate), 0, 1, NULL, "", "share sent twice"},
    {"faults.reorder", SETTING_DOUBLE, AT(faults.reorder), 0, 1, NULL, "", "share overtaken by the next one"},
};
enum {
    key_count = sizeof keys / sizeof *keys,
    group_key_count = sizeof group_keys / sizeof *group_keys,
    shot_key_count = sizeof shot_keys / sizeof *shot_keys
};

/* ---- items -------------------------------------------------------------------------------------- */

static ScenarioGroup default_group(void)
{
    return (ScenarioGroup){.name = "Entity",
                           .type = "tank",
                           .count = 1,
                           .columns = 1,
                           .force = 1,
                           .spacing_m = 40,
                           .column_m = 40,
                           .engine = true,
                           .start_s = NAN,
                           .stop_s = NAN,
                           .appears_s = NAN,
                           .leaves_s = NAN,
                           .leaves = "deactivated",
                           .turret = "none",
                           .dust = "auto"};
}

static ScenarioShot default_shot(void)
{
    return (ScenarioShot){.name = "Missile",
                          .type = "missile",
                          .force = 1,
                          .rounds = 1,
                          .every_s = 6,
                          .launch_mps = 65,
                          .boost_mps = 280,
                          .boost_s = 0.6,
                          .drag_mps2 = 5,
                          .loft_m = 3,
                          .weave_m = 0.8,
                          .entity = true,
                          .hit = "entity",
                          .damage = "destroyed"};
}

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

static Scenario default_scenario(void)
{
    return (Scenario){.duration_s = 30,
                      .scale = 1,
                      .seed = 1,
                      .place = {.lat_deg = 36, .lon_deg = -123, .height_m = 120},
                      .ground = {.swell_m = 1.5, .smooth_m = 2, .vertical = "file"},
                      .dis = {.site = 1,
                              .application = 3001,
                              .exercise = 1,
                              .version = 7,
                              .mtu = 1400,
                              .dead_reckoning = 4,
                              .stamps = "relative",
                              .stamp_s = 1350,
                              .heartbeat_s = 5,
                              .threshold_m = 1,
                              .threshold_deg = 3,
                              .rate_hz = 60,
                              .announce_per_s = 4000}};
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

static bool name_fits(const Scenario *s, const int *ids, int line, const char *key, const char *name)
{
    int group, member;
    if (scenario_find(&group, &member, s, ids, name)) return true;
    char shown[128];
    text_escape(shown, sizeof shown, name, strlen(name));
    const ScenarioGroup *first = s->group_count ? s->group : NULL;
    log_error("scenario: %s:%d: shots: %s: there is no '%s'; an entity is called by name and id%s%.*s%s", s->path, line,
              key, shown, first ? ", for example '" : "", first ? scenario_name_size : 0, first ? first->name : "",
              first ? " N'" : "");
    return false;
}

static bool shot_fits(const Scenario *s, const int *ids, const ScenarioShot *shot)
{
    if (!name_fits(s, ids, shot->line, "from", shot->from)) return false;
    if (*shot->at && !name_fits(s, ids, shot->line, "at", shot->at)) return false;
    if ((*shot->at != 0) == (shot->at_m.count != 0) || (shot->at_m.count != 0 && shot->at_m.count != 2)) {
        log_error("scenario: %s:%d: shots: give either at: NAME ID, or at_m: [x, y]", s->path, shot->line);
        return false;
    }
    if (*shot->at && strcmp(shot->at, shot->from) == 0) {
        log_error("scenario: %s:%d: shots: at: '%s' shoots at itself", s->path, shot->line, shot->at);
        return false;
    }
    if (!*shot->at && strcmp(shot->hit, "entity") == 0) {
        log_error("scenario: %s:%d: shots: hit: a place is not an entity; use hit: ground, or miss", s->path,
                  shot->line);
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
    long long entities = 0, rounds = 0;
    for (int i = 0; i < s->group_count; i++) entities += scenario_group_size(s, &s->group[i]);
    for (int i = 0; i < s->shot_count; i++) {
        entities += munitions(&s->shot[i]);
        rounds += s->shot[i].rounds;
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
    free(ids);
    return fits ? STATUS_OK : STATUS_BAD_VALUE;
}

/* ---- the file ------------------------------------------------------------------------------------ */

Status scenario_read(Scenario *out, const char *path)
{
    Scenario s = default_scenario();
    *out = (Scenario){0};
    snprintf(s.path, sizeof s.path, "%s", path);
    Status status = settings_read(&s, NULL, &table, path);
    if (status == STATUS_OK) status = scenario_check(&s);
    if (status == STATUS_OK) *out = s;
    else scenario_destroy(&s);
    return status;
}

Status scenario_set(Scenario *scenario, const char *key, const char *value, const char *source)
{
    return settings_set(scenario, NULL, &table, key, value, source);
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
