/* render/heat/part_table.c: reads etc/heat.csv and etc/heat_machines.csv (part_table.h). */
#include "render/heat/part_table.h"

#include "pitviper_table.h"

/* ---- roles -------------------------------------------------------------------------------- */

typedef struct RoleRow {
    HeatRole role;
    PartRow  part;
} RoleRow;

#define ROLE(member)    TABLE_AT(RoleRow, member)
#define MACHINE(member) TABLE_AT(MachineRow, member)

static const char *role_named(int role) { return heat_role_name((HeatRole)role); }

static const TableColumn role_columns[] = {
    {"role", TABLE_NAMED, ROLE(role), .high = HEAT_ROLE_COUNT - 1, .named = role_named, .key = true},
    {"thickness_mm", TABLE_DOUBLE, ROLE(part.thickness_m), .low = 0.1, .high = 1000, .unit = 1e-3},
    {"inside", TABLE_CHOICE, ROLE(part.inside),
     .choices = "none, engine, cabin, exhaust, turbine, motor, body, room, flue, grain, fire, ember, "
                "smoulder"},
    {"inside_w_m2k", TABLE_DOUBLE, ROLE(part.inside_w_m2k), .low = 0, .high = 1e4},
    {"running_w_m2k", TABLE_DOUBLE, ROLE(part.running_w_m2k), .low = 0, .high = 1e4},
    {"drive", TABLE_CHOICE, ROLE(part.drive), .choices = "none, motion, firing"},
    {"drive_value", TABLE_DOUBLE, ROLE(part.drive_value), .low = 0, .high = 1e7},
};
static const TableFormat role_format = {"heat", role_columns, sizeof role_columns / sizeof *role_columns, .every = true,
                                        .next = "etc/heat.csv explains the columns"};

static Status take_role(void *user, const void *read, const TableRows *rows, int number)
{
    const RoleRow *row = read;
    (void)rows, (void)number;
    ((PartTable *)user)->role[row->role] = row->part;
    return STATUS_OK;
}

Status part_table_roles(PartTable *out, const char *path)
{
    RoleRow row;
    return table_each(&role_format, path, &row, sizeof row, take_role, out);
}

/* ---- machines ----------------------------------------------------------------------------- */

static const TableColumn machine_columns[] = {
    {"model", .type = TABLE_NAME, MACHINE(model)},
    {"engine_kw", TABLE_DOUBLE, MACHINE(engine_w), .low = 0, .high = 1e6, .unit = 1e3},
    {"engine_kj_k", TABLE_DOUBLE, MACHINE(engine_j_k), .low = 1e-3, .high = 1e7, .unit = 1e3},
    {"engine_k", TABLE_DOUBLE, MACHINE(engine_k), .low = 200, .high = 500},
    {"exhaust_k", TABLE_DOUBLE, MACHINE(exhaust_k), .low = 200, .high = 2500},
    {"cabin_kj_k", TABLE_DOUBLE, MACHINE(cabin_j_k), .low = 1e-3, .high = 1e7, .unit = 1e3},
    {"cabin_w", TABLE_DOUBLE, MACHINE(cabin_w), .low = 0, .high = 1e7},
    {"fuel_kj_k", TABLE_DOUBLE, MACHINE(fuel_j_k), .low = 0, .high = 1e7, .unit = 1e3, .absent = TABLE_LATER},
    {"fuel_w_k", TABLE_DOUBLE, MACHINE(fuel_w_k), .low = 0, .high = 1e5, .absent = TABLE_LATER},
};
static const TableFormat machine_format = {"heat",
                                           machine_columns,
                                           sizeof machine_columns / sizeof *machine_columns,
                                           .next = "etc/heat_machines.csv explains the columns",
                                           .least_rows = 1,
                                           .most_rows = part_table_most};

static Status take_machine(void *user, const void *read, const TableRows *rows, int number)
{
    PartTable        *table = user;
    const MachineRow *row = read;
    table->machine[table->machines++] = *row;
    return number < rows->table.rows - 1 || strcmp(row->model, "*") == 0
               ? STATUS_OK
               : table_rows_refuse(rows, number, "model", "*: the last row must be that of all other models");
}

Status part_table_machines(PartTable *out, const char *path)
{
    MachineRow row;
    out->machines = 0;
    return table_each(&machine_format, path, &row, sizeof row, take_machine, out);
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
