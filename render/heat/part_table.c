/* render/heat/part_table.c: reads etc/heat.csv and etc/heat_machines.csv (part_table.h). */
#include "render/heat/part_table.h"

static bool find_name(int *out, const char *const *names, int count, const char *name)
{
    for (int i = 0; i < count; i++) {
        if (strcmp(names[i], name) != 0) continue;
        *out = i;
        return true;
    }
    return false;
}

static bool columns_of(int *column, const Table *table, const char *const *names, int count)
{
    for (int c = 0; c < count; c++) {
        column[c] = table_column(table, names[c]);
        if (column[c] >= 0) continue;
        log_error("heat: a column is missing: file=%s column=%s", table->path, names[c]);
        return false;
    }
    return true;
}

/* ---- roles -------------------------------------------------------------------------------- */

static Status read_role(PartTable *out, bool seen[HEAT_ROLE_COUNT], const Table *table, int row, const int column[7])
{
    static const char *const insides[INSIDE_COUNT] = {"none",  "engine", "cabin", "exhaust", "turbine",
                                                      "motor", "body",   "room",  "flue",    "grain"};
    static const char *const drives[PART_DRIVE_COUNT] = {"none", "motion", "firing"};
    const char              *name = table_text(table, row, column[0]), *inside_name = table_text(table, row, column[2]),
               *drive_name = table_text(table, row, column[5]);
    const int line = table->line[row + 1];
    HeatRole  role;
    int       inside, drive;
    double    thickness_mm;

    if (!heat_role_find(&role, name)) {
        log_error("heat: no such role: file=%s line=%d role=\"%s\"", table->path, line, name);
        return STATUS_BAD_VALUE;
    }
    if (seen[role]) {
        log_error("heat: a second row for a role: file=%s line=%d role=%s", table->path, line, name);
        return STATUS_BAD_VALUE;
    }
    seen[role] = true;
    if (!find_name(&inside, insides, INSIDE_COUNT, inside_name)) {
        log_error(
            "heat: no such inside: file=%s line=%d inside=\"%s\" want=none, engine, cabin, exhaust, turbine, motor, "
            "body, room, flue or grain",
            table->path, line, inside_name);
        return STATUS_BAD_VALUE;
    }
    if (!find_name(&drive, drives, PART_DRIVE_COUNT, drive_name)) {
        log_error("heat: no such drive: file=%s line=%d drive=\"%s\" want=none, motion or firing", table->path, line,
                  drive_name);
        return STATUS_BAD_VALUE;
    }
    PartRow *to = &out->role[role];
    *to = (PartRow){.inside = (PartInside)inside, .drive = (PartDrive)drive};
    Status status = table_number(&thickness_mm, table, row, column[1], 0.1, 1000);
    if (status == STATUS_OK) status = table_number(&to->inside_w_m2k, table, row, column[3], 0, 1e4);
    if (status == STATUS_OK) status = table_number(&to->running_w_m2k, table, row, column[4], 0, 1e4);
    if (status == STATUS_OK) status = table_number(&to->drive_value, table, row, column[6], 0, 1e7);
    if (status == STATUS_OK) to->thickness_m = 1e-3 * thickness_mm;
    return status;
}

Status part_table_roles(PartTable *out, const char *path)
{
    static const char *const names[7] = {"role",          "thickness_mm", "inside",     "inside_w_m2k",
                                         "running_w_m2k", "drive",        "drive_value"};
    bool                     seen[HEAT_ROLE_COUNT] = {false};
    Table                    table = {0};
    int                      column[7];
    Status                   status = table_open(&table, path);

    if (status != STATUS_OK) return status;
    if (!columns_of(column, &table, names, 7)) status = STATUS_BAD_VALUE;
    for (int row = 0; row < table.rows && status == STATUS_OK; row++)
        status = read_role(out, seen, &table, row, column);
    for (int role = 0; role < HEAT_ROLE_COUNT && status == STATUS_OK; role++) {
        if (seen[role]) continue;
        log_error("heat: a role has no row: file=%s role=%s", path, heat_role_name((HeatRole)role));
        status = STATUS_BAD_VALUE;
    }
    table_close(&table);
    return status;
}

/* ---- machines ----------------------------------------------------------------------------- */

static Status read_machine(MachineRow *to, const Table *table, int row, const int column[9])
{
    static const struct {
        double low, high;
    } range[8] = {{0, 1e6}, {1e-3, 1e7}, {200, 500}, {200, 2500}, {1e-3, 1e7}, {0, 1e7}, {0, 1e7}, {0, 1e5}};
    static const double unit[8] = {1e3, 1e3, 1, 1, 1e3, 1, 1e3, 1};
    double *const       value[8] = {&to->engine_w,  &to->engine_j_k, &to->engine_k, &to->exhaust_k,
                                    &to->cabin_j_k, &to->cabin_w,    &to->fuel_j_k, &to->fuel_w_k};
    const char         *name = table_text(table, row, column[0]);
    if (strlen(name) == 0 || strlen(name) >= sizeof to->model) {
        log_error("heat: name of a model empty or too long: file=%s line=%d", table->path, table->line[row + 1]);
        return STATUS_BAD_VALUE;
    }
    strcpy(to->model, name);
    for (int c = 0; c < 8; c++) {
        const Status status = table_number(value[c], table, row, column[c + 1], range[c].low, range[c].high);
        if (status != STATUS_OK) return status;
        *value[c] *= unit[c];
    }
    return STATUS_OK;
}

Status part_table_machines(PartTable *out, const char *path)
{
    static const char *const names[9] = {"model",      "engine_kw", "engine_kj_k", "engine_k", "exhaust_k",
                                         "cabin_kj_k", "cabin_w",   "fuel_kj_k",   "fuel_w_k"};
    Table                    table = {0};
    int                      column[9];
    Status                   status = table_open(&table, path);

    out->machines = 0;
    if (status != STATUS_OK) return status;
    if (!columns_of(column, &table, names, 9)) status = STATUS_BAD_VALUE;
    if (status == STATUS_OK && (table.rows < 1 || table.rows > part_table_most)) {
        log_error("heat: too few or too many rows: file=%s rows=%d want=1 .. %d", path, table.rows,
                  (int)part_table_most);
        status = STATUS_BAD_VALUE;
    }
    for (int row = 0; row < table.rows && status == STATUS_OK; row++)
        status = read_machine(&out->machine[out->machines++], &table, row, column);
    if (status == STATUS_OK && strcmp(out->machine[out->machines - 1].model, "*") != 0) {
        log_error("heat: the last row must be *, for all other models: file=%s", path);
        status = STATUS_BAD_VALUE;
    }
    table_close(&table);
    return status;
}

Status part_table_open(PartTable *out, const char *parts_path, const char *machines_path)
{
    PartTable table = {0};
    Status    status = part_table_roles(&table, parts_path);
    if (status == STATUS_OK) status = part_table_machines(&table, machines_path);
    if (status == STATUS_OK) *out = table;
    return status;
}

MachineRow part_table_machine(const PartTable *table, const Model *model)
{
    static const double least_m3 = 0.05;
    for (int i = 0; i < table->machines - 1; i++)
        if (strcmp(table->machine[i].model, model->name) == 0) return table->machine[i];
    MachineRow   row = table->machine[table->machines - 1];
    const double m3 = fmax(model->length_m * model->width_m * model->height_m, least_m3);
    row.engine_w *= m3, row.engine_j_k *= m3, row.cabin_j_k *= m3, row.cabin_w *= m3;
    row.fuel_j_k *= m3, row.fuel_w_k *= m3;
    return row;
}
