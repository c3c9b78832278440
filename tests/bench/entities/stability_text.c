/* tests/bench/entities/stability_text.c: every number in input text, at the limits of floating point and beyond: keys
 * of scenarios, cells of tables, columns of probes. Each must be rejected with a message, or the results must be
 * finite. */
#include "tests/bench/suites.h"
#include "tests/bench/stress.h"
#include "pitviper_output.h"

#include "dis/pdu/decode.h"
#include "entities/traces/effect_puffs.h"
#include "entities/exercise/exercise.h"
#include "render/heat/part_table.h"
#include "entities/probe.h"
#include "terrain/probe.h"

#include <stdlib.h>

static const char *const texts[] = {"inf",
                                    "-inf",
                                    "nan",
                                    "1e999",
                                    "-1e999",
                                    "1.7976931348623157e308",
                                    "-1.7976931348623157e308",
                                    "3.4028235e38",
                                    "-3.4028235e38",
                                    "5e-324",
                                    "-5e-324",
                                    "1e-310",
                                    "1e-400",
                                    "0",
                                    "-0",
                                    "0x1p3",
                                    "99999999999999999999",
                                    ".inf",
                                    ".nan",
                                    "2147483648",
                                    "-1",
                                    "1e-20"};
enum { text_count = sizeof texts / sizeof *texts };

static char heard[512];
static void listen(void *user, LogLevel level, const char *line)
{
    (void)user;
    if (level == LOG_ERROR) snprintf(heard, sizeof heard, "%s", line);
}

/* ---- scenarios ------------------------------------------------------------------------------ */

typedef struct Heard {
    double wrong;
    int    pdus;
} Heard;

/* Sink of the exercise; every Entity State must be valid for geodesy. */
static bool take_datagram(void *user, double t_s, const uint8_t *bytes, size_t octets)
{
    Heard         *h = user;
    DisCounters    counters = {0};
    DisHeader      header;
    const uint8_t *pdu, *at = bytes;
    DisDrop        why;
    static DisPdu  decoded;
    h->wrong += !isfinite(t_s);
    while (dis_next_pdu(&header, &pdu, &at, bytes + octets, &counters) && ++h->pdus < 200) {
        if (header.type != dis_pdu_entity_state || dis_decode(&decoded, pdu, header.length) != STATUS_OK) continue;
        const DisEntityState *s = &decoded.entity_state;
        h->wrong += !dis_entity_state_is_usable(&why, s);
        for (int c = 0; c < 3; c++) h->wrong += !isfinite(s->acceleration_mps2[c]) || !isfinite(s->angular_rate_rps[c]);
    }
    return h->pdus < 200;
}

/* Whether an accepted scenario sends valid PDUs for its first moments. */
static bool scenario_is_sound(const Scenario *scenario)
{
    Cast     *cast = NULL;
    Exercise *exercise = NULL;
    Heard     h = {0};
    heard[0] = 0;
    Status status = cast_create(&cast, scenario);
    if (status == STATUS_OK) status = exercise_create(&exercise, cast, 1.7e9, take_datagram, &h);
    for (int step = 0; status == STATUS_OK && step < 40 && exercise_step(exercise); step++) continue;
    exercise_destroy(exercise);
    cast_destroy(cast);
    return status == STATUS_OK ? h.wrong == 0 : heard[0] != 0;
}

/* What a line of vehicles and one of shots need; [0] the key, [1] its value. */
static const char *const vehicle_keys[][2] = {{"name", "A"},
                                              {"id", "1"},
                                              {"type", "1.1.222.1.1.1.0"},
                                              {"route_m", "[[0, 0], [200, 50], [300, 300]]"},
                                              {"speed_mps", "10"}};
static const char *const shot_keys[][2] = {
    {"from", "A 1"}, {"at", "B 2"}, {"entity", "true"}, {"type", "2.2.225.1.1.3.0"}, {"time_s", "0.1"}};

/* One item with this key at this value, whether it was there or not. */
static void write_item(FILE *to, const char *const (*keys)[2], int count, const char *key, const char *value)
{
    bool there = false;
    fputs("  - {", to);
    for (int k = 0; k < count; k++) {
        const bool same = strcmp(keys[k][0], key) == 0;
        there |= same;
        if (strcmp(keys[k][0], "at") == 0 && strcmp(key, "at_m") == 0) fputs("hit: ground, ", to);
        else fprintf(to, "%s: %s, ", keys[k][0], same ? value : keys[k][1]);
    }
    if (!there && *key) fprintf(to, "%s: %s", key, value);
    fputs("}\n", to);
}

static bool write_scenario(const char *path, const char *section, const char *key, const char *value)
{
    const bool vehicle = strcmp(section, "vehicles") == 0, shot = strcmp(section, "shots") == 0;
    FILE      *to = output_file(path, 0);
    if (!to) return false;
    if (!vehicle && !shot && *section) fprintf(to, "%s: {%s: %s}\n", section, key, value);
    else if (!vehicle && !shot) fprintf(to, "%s: %s\n", key, value);
    fputs("vehicles:\n", to);
    write_item(to, vehicle_keys, sizeof vehicle_keys / sizeof *vehicle_keys, vehicle ? key : "", value);
    fputs("  - {name: B, type: 1.1.222.1.1.1.0, id: 2, route_m: [[300, 400]]}\nshots:\n", to);
    write_item(to, shot_keys, sizeof shot_keys / sizeof *shot_keys, shot ? key : "", value);
    return fclose(to) == 0;
}

/* Every key listed by `pitviper exercise --keys`, with every text that is a number, or nearly. */
static Status scenarios(Bench *bench, const char *path)
{
    char  *keys = NULL, section[64] = "", *rest = NULL;
    size_t octets = 0;
    double bad = 0, refused = 0, cases = 0;
    int    number = 0;
    FILE  *to = open_memstream(&keys, &octets);
    if (!to) return STATUS_NO_MEMORY;
    scenario_write_keys(to);
    if (fclose(to) != 0) return STATUS_NO_MEMORY;
    log_set_sink(listen, NULL);
    for (char *line = strtok_r(keys, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest)) {
        const char  *name = line + strspn(line, " #");
        const size_t length = strspn(name, "abcdefghijklmnopqrstuvwxyz_");
        char         key[64], value[128];
        if (length == 0 || length >= sizeof key || name[length] != ':') continue; /* its help */
        snprintf(key, sizeof key, "%.*s", (int)length, name);
        if (name == line && (!name[length + 1] || strstr(name, "# a list"))) {
            snprintf(section, sizeof section, "%s", key);
            continue;
        }
        if (strcmp(key, "elevation") == 0 || strcmp(key, "geoid") == 0) continue; /* names of files */
        const bool places = strcmp(key, "route_m") == 0, place = strcmp(key, "at_m") == 0,
                   offset = strcmp(key, "launch_m") == 0;
        for (int t = 0; t < text_count; t++) {
            if (bench_quick(bench) && number++ % 5 != 0) continue;
            snprintf(value, sizeof value,
                     places   ? "[[0, 0], [%s, 50]]"
                     : place  ? "[%s, 50]"
                     : offset ? "[1, %s, 0]"
                              : "%s",
                     texts[t]);
            Scenario s;
            heard[0] = 0;
            if (!write_scenario(path, section, key, value)) bad = INFINITY;
            const bool taken = scenario_read(&s, path) == STATUS_OK;
            const bool good = taken ? scenario_is_sound(&s) : heard[0] != 0;
            cases++;
            refused += !taken;
            bad += !good;
            scenario_destroy(&s);
        }
    }
    log_set_sink(NULL, NULL);
    free(keys);
    if (!(refused > 0.3 * cases && refused < 0.9 * cases))
        bad = INFINITY; /* some of these texts are good, most are none */
    bench_stress(bench, "scenario: each key at extremes: silent, or an exercise not finite", bad, 0, "files",
                 "an error line, or finite PDUs");
    return STATUS_OK;
}

/* ---- tables --------------------------------------------------------------------------------- */

static bool effects_are_sound(const char *path)
{
    static const double age[] = {0, 1e-9, 0.01, 0.5, 5, 60};
    const Weather       weather = weather_default();
    const Geodetic      origin = {0, 0, 0};
    LocalFrame          frame;
    EffectTable         table;
    if (effect_table_open(&table, path) != STATUS_OK) return heard[0] != 0;
    if (local_frame_at(&frame, &origin) != STATUS_OK) return false;
    for (int kind = 0; kind < EFFECT_KIND_COUNT; kind++)
        for (size_t a = 0; a < sizeof age / sizeof *age; a++) {
            const EffectPuff puff = {.kind = (EffectKind)kind,
                                     .age_s = age[a],
                                     .p_ecef = {6378137, 0, 0},
                                     .up_ecef = {1, 0, 0},
                                     .axis_ecef = {0, 1, 0},
                                     .throw_mps = {3, 2, 1},
                                     .throw_s = 0.3,
                                     .scale = 2,
                                     .mass_kg = 1};
            EffectVolume     v;
            if (!isfinite(effect_life_s(&table, puff.kind, puff.scale))) return false;
            if (!effect_volume(&v, &table, &puff, &weather, &frame)) continue;
            bool sound = v3_is_finite(v.p_enu) && isfinite(v.along_m) && v.across_m > 0 && isfinite(v.across_m) &&
                         isfinite(v.temp_k);
            for (int b = 0; b < effect_band_count; b++)
                sound = sound && isfinite(v.extinction_per_m[b]) && v.extinction_per_m[b] >= 0;
            if (!sound) return false;
        }
    return true;
}

static bool heat_is_sound(const char *path)
{
    PartTable table;
    if (part_table_roles(&table, path) != STATUS_OK) return heard[0] != 0;
    for (int r = 0; r < HEAT_ROLE_COUNT; r++) {
        const PartRow *row = &table.role[r];
        if (!(row->thickness_m > 0 && row->inside_w_m2k >= 0 && row->running_w_m2k >= 0 && row->drive_value >= 0))
            return false;
    }
    return true;
}

/* Each cell of a table of etc/ in turn: every one that is a number. */
static Status table_cells(Bench *bench, double *bad, const char *name, bool (*is_sound)(const char *path),
                          const char *path)
{
    enum { most = 1 << 20 };
    char   from[512], *whole = NULL;
    size_t octets;
    int    number = 0;
    if (!etc_path(from, sizeof from, name)) return STATUS_BAD_VALUE;
    const Status status = text_read_file(&whole, &octets, "bench", from, most);
    if (status != STATUS_OK) return status;
    const char *at = whole;
    while (*at == '#' || *at == '\n') at += strcspn(at, "\n") + 1;
    at += strcspn(at, "\n"); /* behind the header */
    for (; *at; at += strcspn(at, ",\n")) {
        at += strspn(at, ", \n");
        const size_t length = strcspn(at, ",\n");
        char         cell[64];
        double       value;
        snprintf(cell, sizeof cell, "%.*s", length < sizeof cell ? (int)length : 0, at);
        if (!text_to_double(&value, cell)) continue;
        for (int t = 0; t < text_count; t++) {
            if (number++ % (bench_quick(bench) ? 37 : 7) != 0) continue;
            FILE *to = output_file(path, 0);
            if (!to) *bad = INFINITY;
            else fprintf(to, "%.*s%s%s", (int)(at - whole), whole, texts[t], at + length);
            if (to && fclose(to) != 0) *bad = INFINITY;
            heard[0] = 0;
            *bad += !is_sound(path);
        }
    }
    free(whole);
    return STATUS_OK;
}

static Status tables(Bench *bench, const char *path)
{
    double bad = 0;
    log_set_sink(listen, NULL);
    Status status = table_cells(bench, &bad, "effects.csv", effects_are_sound, path);
    if (status == STATUS_OK) status = table_cells(bench, &bad, "heat.csv", heat_is_sound, path);
    log_set_sink(NULL, NULL);
    if (status == STATUS_OK)
        bench_stress(bench, "effects.csv, heat.csv: each cell at extremes: silent, or not finite", bad, 0, "files",
                     "an error line, or finite puffs");
    return status;
}

/* ---- probes --------------------------------------------------------------------------------- */

static const struct {
    const char *probe, *header, *row;
} probe_rows[] = {
    {"sun", "utc,lat_deg,lon_deg,h_m,pressure_mbar,temp_c,delta_t_s", "2026-06-21T10:00:00Z,36,-123,100,1010,10,69"},
    {"geoid", "lat_deg,lon_deg", "36,-123"},
    {"geodesy", "lat_deg,lon_deg,h_m,origin_lat_deg,origin_lon_deg,origin_h_m", "36,-123,100,35,-122,0"},
    {"geodesy", "x_m,y_m,z_m,origin_lat_deg,origin_lon_deg,origin_h_m", "6378137,10,20,35,-122,0"},
    {"deadreckon",
     "algorithm,x_m,y_m,z_m,psi_rad,theta_rad,phi_rad,vx_mps,vy_mps,vz_mps,ax_mps2,ay_mps2,az_mps2,wx_rps,wy_rps,wz_"
     "rps,dt_s",
     "8,6378137,0,0,0.1,0.2,0.3,5,6,7,0.1,0.2,0.3,0.1,0.2,0.3,5"},
};

static const Probe *find_probe(const char *name)
{
    for (int k = 0; k < terrain_probe_count; k++)
        if (strcmp(terrain_probes[k].name, name) == 0) return &terrain_probes[k];
    for (int k = 0; k < entities_probe_count; k++)
        if (strcmp(entities_probes[k].name, name) == 0) return &entities_probes[k];
    return NULL;
}

/* Rows of output with neither an error nor finite numbers in every result column. */
static double unsound_rows(char *answer, int inputs, int rows)
{
    double bad = 0;
    char  *rest = NULL, *cell[64];
    int    seen = 0;
    for (char *line = strtok_r(answer, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest), seen++) {
        const int cells = text_split(cell, 64, line);
        if (seen == 0) continue;
        bool sound = cells > inputs + 1 && cells <= 64;
        if (sound && !*cell[cells - 1])
            for (int c = inputs; c < cells - 1; c++) {
                double value;
                sound = sound && text_to_double(&value, cell[c]);
            }
        bad += !sound;
    }
    return seen == rows + 1 ? bad : INFINITY;
}

static Status probes(Bench *bench)
{
    double bad = 0;
    Status status = STATUS_OK;
    for (size_t k = 0; k < sizeof probe_rows / sizeof *probe_rows && status == STATUS_OK; k++) {
        const Probe *probe = find_probe(probe_rows[k].probe);
        char        *question = NULL, *answer = NULL, name[32], *argv[] = {name, NULL};
        size_t       asked = 0, answered = 0;
        int          columns = 1, rows = 1;
        if (!probe) return STATUS_BAD_VALUE;
        snprintf(name, sizeof name, "%s", probe->name);
        for (const char *at = probe_rows[k].row; *at; at++) columns += *at == ',';
        FILE *to = open_memstream(&question, &asked);
        if (!to) return STATUS_NO_MEMORY;
        fprintf(to, "%s\n%s\n", probe_rows[k].header, probe_rows[k].row);
        for (int c = 0; c < columns; c++) {
            const char *at = probe_rows[k].row;
            for (int skip = 0; skip < c; skip++) at += strcspn(at, ",") + 1;
            const char *behind = at + strcspn(at, ",");
            /* one column, and all from it on */
            for (int t = 0; t < text_count; t++, rows++)
                fprintf(to, "%.*s%s%s\n", (int)(at - probe_rows[k].row), probe_rows[k].row, texts[t], behind);
            for (int t = 0; t < text_count; t++, rows++) {
                fprintf(to, "%.*s", (int)(at - probe_rows[k].row), probe_rows[k].row);
                for (int rest = c; rest < columns; rest++)
                    fprintf(to, "%s%c", texts[t], rest + 1 < columns ? ',' : '\n');
            }
        }
        if (fclose(to) != 0) status = STATUS_NO_MEMORY;
        FILE *in = status == STATUS_OK ? fmemopen(question, asked, "r") : NULL,
             *out = open_memstream(&answer, &answered);
        if (!in || !out) status = STATUS_NO_MEMORY;
        else status = probe_run(probe, 1, argv, in, out);
        if (in) fclose(in);
        if (out) fclose(out);
        if (status == STATUS_OK) bad += unsound_rows(answer, columns, rows);
        free(question);
        free(answer);
    }
    if (status == STATUS_OK)
        bench_stress(bench, "probes: each column at extremes: neither a reason nor finite", bad, 0, "rows",
                     "an error, or finite results");
    return status;
}

Status bench_stability_text(Bench *bench)
{
    char path[temp_path_size];
    if (!temp_file(path, "")) return STATUS_IO;
    bench_progress(bench, "scenarios, tables, probes");
    Status status = scenarios(bench, path);
    if (status == STATUS_OK) status = tables(bench, path);
    if (status == STATUS_OK) status = probes(bench);
    remove(path);
    return status;
}
