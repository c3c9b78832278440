/* entities/effects/heat.c: first-order heat levels by role, exact between reports. See the header. */
#include "entities/effects/heat.h"

#include "dis/enumerations.h"

static const double moving_mps = 0.3;       /* above the jitter of reports of a stationary vehicle */
static const double engine_after_stop_s = 120; /* crews halt with the engine on; estimate */
static const double full_speed_mps = 10;    /* estimate: a vehicle's usual off-road speed */
static const double idle_engine = 0.6;      /* estimate */
static const double shot_s = 1;             /* heat.csv gives the gun's warm-up against this */
static const double burn_s = 2;             /* a TOW's launch and flight motors together: under 2 s */
static const double flare_s = 4; /* decoy flares of the MJU class burn for 3 .. 5 s; estimate */
static const double most_queued_shots_s = 60;
/* Turbulent recovery factor Pr^(1/3) is 0.89, laminar sqrt(Pr) 0.84; 0.85 of the stagnation rise v^2/(2 cp) */
static const double recovery = 0.85, cp_air_j_kg_k = 1005;

/* ---- table -------------------------------------------------------------------------------- */

static bool driver_by_name(HeatDriver *out, const char *name)
{
    static const char *const names[HEAT_DRIVER_COUNT] = {"none",   "engine", "motion", "firing",
                                                         "flight", "burn",   "speed",  "life",
                                                         "pyrotechnic", "burning"};
    for (int d = 0; d < HEAT_DRIVER_COUNT; d++) {
        if (strcmp(names[d], name) == 0) {
            *out = (HeatDriver)d;
            return true;
        }
    }
    return false;
}

static bool role_by_name(int *out, const char *name)
{
    for (int r = 0; r < HEAT_ROLE_COUNT; r++) {
        if (strcmp(heat_role_name((HeatRole)r), name) == 0) {
            *out = r;
            return true;
        }
    }
    return false;
}

static Status read_row(HeatTable *heat, bool seen[HEAT_ROLE_COUNT], const Table *table, int row, const int column[5])
{
    const char *role_name = table_text(table, row, column[0]), *driver_name = table_text(table, row, column[1]);
    const int line = table->line[row + 1];
    int role;

    if (!role_by_name(&role, role_name)) {
        log_error("heat: no such role: file=%s line=%d role=\"%s\"", table->path, line, role_name);
        return STATUS_BAD_VALUE;
    }
    if (seen[role]) {
        log_error("heat: a second row for a role: file=%s line=%d role=%s", table->path, line, role_name);
        return STATUS_BAD_VALUE;
    }
    seen[role] = true;
    if (!driver_by_name(&heat->driver[role], driver_name)) {
        log_error("heat: no such driver: file=%s line=%d driver=\"%s\" want=none, engine, motion, firing, flight, "
                  "burn, speed, life, pyrotechnic or burning", table->path, line, driver_name);
        return STATUS_BAD_VALUE;
    }
    Status status = table_number(&heat->rise_k[role], table, row, column[2], 0, 2000);
    if (status == STATUS_OK) status = table_number(&heat->warm_up_s[role], table, row, column[3], 0.01, 1e6);
    if (status == STATUS_OK) status = table_number(&heat->cool_down_s[role], table, row, column[4], 0.01, 1e6);
    return status;
}

Status heat_table_open(HeatTable *out, const char *path)
{
    static const char *const names[5] = {"role", "driver", "rise_k", "warm_up_s", "cool_down_s"};
    HeatTable heat = {0};
    bool      seen[HEAT_ROLE_COUNT] = {false};
    Table     table = {0};
    int       column[5];
    Status    status = table_open(&table, path);

    if (status != STATUS_OK) return status;
    for (int c = 0; c < 5; c++) {
        column[c] = table_column(&table, names[c]);
        if (column[c] < 0) {
            log_error("heat: a column is missing: file=%s column=%s", path, names[c]);
            status = STATUS_BAD_VALUE;
        }
    }
    for (int row = 0; row < table.rows && status == STATUS_OK; row++)
        status = read_row(&heat, seen, &table, row, column);
    for (int role = 0; role < HEAT_ROLE_COUNT && status == STATUS_OK; role++) {
        if (seen[role]) continue;
        log_error("heat: a role has no row: file=%s role=%s", path, heat_role_name((HeatRole)role));
        status = STATUS_BAD_VALUE;
    }
    table_close(&table);
    if (status == STATUS_OK) *out = heat;
    return status;
}

/* ---- drives ------------------------------------------------------------------------------- */

/* Two bits, 3 = destroyed, in the same place for every platform domain, for buildings, and (fatally injured) for
 * life forms. */
static bool is_destroyed(const HeatEvidence *evidence)
{
    const int kind = evidence->type.kind;
    return (kind == dis_kind_platform || kind == dis_kind_life_form || kind == dis_kind_cultural_feature) &&
           (evidence->appearance >> dis_appearance_damage_shift & 3) == dis_damage_destroyed;
}

/* Sets every drive given by a report; firing and burning continue by their own times. */
static void set_drives(HeatState *state, const HeatEvidence *evidence, double t_s)
{
    const bool platform = evidence->type.kind == dis_kind_platform,
               air = platform && evidence->type.domain == dis_domain_air;
    const bool alive = !is_destroyed(evidence), was_moving = state->moving;
    const double ground_drive = clamp(evidence->speed_mps / full_speed_mps, 0, 1);
    HeatDrive *drive = state->drive;

    state->moving = platform && evidence->speed_mps > moving_mps;
    if (state->moving || was_moving) state->moved_s = t_s;

    HeatDrive engine = {0, INFINITY};
    if (!alive) engine.value = 0;
    else if (air) engine.value = 1;
    else if (state->moving) engine.value = idle_engine + (1 - idle_engine) * ground_drive;
    else if (platform && evidence->appearance >> dis_appearance_power_plant_bit & 1) engine.value = idle_engine;
    else if (platform && t_s < state->moved_s + engine_after_stop_s)
        engine = (HeatDrive){idle_engine, state->moved_s + engine_after_stop_s};
    drive[HEAT_DRIVER_ENGINE] = engine;

    drive[HEAT_DRIVER_MOTION] = (HeatDrive){state->moving && !air ? ground_drive : 0, INFINITY};
    drive[HEAT_DRIVER_FLIGHT] = (HeatDrive){air && alive, INFINITY};
    const bool lives = evidence->type.kind == dis_kind_life_form || evidence->type.kind == dis_kind_cultural_feature;
    drive[HEAT_DRIVER_LIFE] = (HeatDrive){lives && alive, INFINITY};
    /* in kelvin here: each role's rise_k turns it into a level */
    const double recovery_k = recovery * evidence->speed_mps * evidence->speed_mps / (2 * cp_air_j_kg_k);
    drive[HEAT_DRIVER_SPEED] = (HeatDrive){recovery_k, INFINITY};
    const bool flames = platform && evidence->appearance >> dis_appearance_flaming_bit & 1;
    drive[HEAT_DRIVER_BURNING] = (HeatDrive){flames, INFINITY};
    state->destroyed = platform && !alive; /* only machines burn out */
}

static double drive_level(const HeatTable *table, int role, double value)
{
    if (table->driver[role] != HEAT_DRIVER_SPEED) return value;
    return table->rise_k[role] > 0 ? clamp(value / table->rise_k[role], 0, 1) : 0;
}

/* ---- levels ------------------------------------------------------------------------------- */

/* A level never crosses its drive, so one time constant serves the whole step. */
static double approach(double level, double drive, double dt_s, const HeatTable *table, int role)
{
    if (level == drive || !(dt_s > 0)) return level;
    const double tau_s = drive > level ? table->warm_up_s[role] : table->cool_down_s[role];
    return drive + (level - drive) * exp(-dt_s / tau_s);
}

static double level_at(const HeatState *state, const HeatTable *table, int role, double t_s)
{
    const HeatDrive drive = state->drive[table->driver[role]];
    const double    value = drive_level(table, role, drive.value);
    const double    until_s = drive.until_s > state->t_s ? drive.until_s : state->t_s;
    const double    end_s = until_s < t_s ? until_s : t_s;

    const double at_end = approach(state->level[role], value, end_s - state->t_s, table, role);
    return approach(at_end, 0, t_s - end_s, table, role);
}

static void advance(HeatState *state, const HeatTable *table, double t_s)
{
    if (!(t_s > state->t_s)) return;
    for (int role = 0; role < HEAT_ROLE_COUNT; role++) state->level[role] = level_at(state, table, role, t_s);
    state->t_s = t_s;
}

void heat_begin(HeatState *state, const HeatTable *table, const HeatEvidence *evidence, double t_s, double ambient_s)
{
    const bool munition = evidence->type.kind == dis_kind_munition;

    *state = (HeatState){.t_s = t_s, .moved_s = -INFINITY};
    set_drives(state, evidence, t_s);
    if (munition) heat_launch(state, table, t_s);
    else if (evidence->type.kind == dis_kind_expendable)
        state->drive[HEAT_DRIVER_PYROTECHNIC] = (HeatDrive){1, t_s + flare_s};
    else
        for (int role = 0; role < HEAT_ROLE_COUNT; role++) {
            const double drive = drive_level(table, role, state->drive[table->driver[role]].value);
            state->level[role] = approach(0, drive, ambient_s, table, role);
        }
}

void heat_report(HeatState *state, const HeatTable *table, const HeatEvidence *evidence, double t_s)
{
    advance(state, table, t_s);
    const bool was_destroyed = state->destroyed;
    set_drives(state, evidence, t_s);
    /* destroyed while observed: hot at once; repaired: cold */
    if (state->destroyed != was_destroyed) state->level[HEAT_WRECK] = state->destroyed;
}

void heat_fire(HeatState *state, const HeatTable *table, double t_s)
{
    advance(state, table, t_s);
    HeatDrive *firing = &state->drive[HEAT_DRIVER_FIRING];
    const double from_s = firing->value > 0 ? fmax(t_s, firing->until_s) : t_s;
    *firing = (HeatDrive){1, fmin(from_s + shot_s, t_s + most_queued_shots_s)};
}

void heat_launch(HeatState *state, const HeatTable *table, double t_s)
{
    advance(state, table, t_s);
    state->drive[HEAT_DRIVER_BURN] = (HeatDrive){1, t_s + burn_s};
}

void heat_at(float rise_k[HEAT_ROLE_COUNT], const HeatState *state, const HeatTable *table, uint32_t roles, double t_s)
{
    const double at_s = t_s > state->t_s ? t_s : state->t_s;
    for (int role = 0; role < HEAT_ROLE_COUNT; role++) {
        rise_k[role] = 0;
        if (roles >> role & 1) rise_k[role] = (float)(table->rise_k[role] * level_at(state, table, role, at_s));
    }
    const double wreck_k = table->rise_k[HEAT_WRECK] * level_at(state, table, HEAT_WRECK, at_s);
    for (int role = 0; wreck_k > 0 && role < HEAT_ROLE_COUNT; role++) rise_k[role] += (float)wreck_k;
}

uint32_t heat_roles(const Model *model, const HeatTable *table)
{
    uint32_t roles = 0;
    for (int p = 0; p < model->part_count; p++)
        if (table->driver[model->part[p].role] != HEAT_DRIVER_NONE) roles |= UINT32_C(1) << model->part[p].role;
    return roles;
}

double heat_runs_until(const HeatState *state)
{
    const HeatDrive engine = state->drive[HEAT_DRIVER_ENGINE];
    return engine.value > 0 ? engine.until_s : -INFINITY;
}

double heat_engine(const HeatState *state, double t_s)
{
    const HeatDrive engine = state->drive[HEAT_DRIVER_ENGINE];
    return t_s < engine.until_s ? engine.value : 0;
}

bool heat_grain_burns(const HeatState *state, double t_s)
{
    const HeatDrive grain = state->drive[HEAT_DRIVER_PYROTECHNIC];
    return grain.value > 0 && t_s < grain.until_s;
}
