/* entities/flight/missile.c: reads rows of etc/missiles.csv or of a table like it. */
#include "entities/flight/missile.h"

#include "pitviper_table.h"

/* A row as it is in the file. */
typedef struct Row {
    Missile     m;
    const char *name, *source;
    double      diameter_m;
} Row;

static const double standard_mps2 = 9.80665;

static const char guidances[] = "pn, augmented, pursuit, command, loft";

const char *missile_guidance_name(MissileGuidance guidance)
{
    static const char *const name[] = {"pn", "augmented", "pursuit", "command", "loft"};
    return name[guidance];
}

#define FIELD(member) TABLE_AT(Row, member)

static const TableColumn columns[] = {
    {"name", .type = TABLE_CELL, FIELD(name)},
    {"source", .type = TABLE_CELL, FIELD(source)},
    {"guidance", TABLE_CHOICE, FIELD(m.guidance), .choices = guidances},
    {"mass_kg", TABLE_DOUBLE, FIELD(m.mass_kg), .low = 0.1, .high = 20000},
    {"diameter_mm", TABLE_DOUBLE, FIELD(diameter_m), .low = 10, .high = 3000, .unit = 1e-3},
    {"launch_mps", TABLE_DOUBLE, FIELD(m.launch_mps), .low = 0, .high = 2000},
    {"ignite_s", TABLE_DOUBLE, FIELD(m.ignite_s), .low = 0, .high = 60},
    {"boost_kg", TABLE_DOUBLE, FIELD(m.burn_kg[0]), .low = 0, .high = 15000},
    {"boost_n", TABLE_DOUBLE, FIELD(m.thrust_n[0]), .low = 0, .high = 2e6},
    {"boost_s", TABLE_DOUBLE, FIELD(m.burn_s[0]), .low = 0, .high = 600},
    {"sustain_kg", TABLE_DOUBLE, FIELD(m.burn_kg[1]), .low = 0, .high = 15000},
    {"sustain_n", TABLE_DOUBLE, FIELD(m.thrust_n[1]), .low = 0, .high = 2e6},
    {"sustain_s", TABLE_DOUBLE, FIELD(m.burn_s[1]), .low = 0, .high = 600},
    {"cd_m0", TABLE_DOUBLE, FIELD(m.drag[0]), .low = 0, .high = 5},
    {"cd_m080", TABLE_DOUBLE, FIELD(m.drag[1]), .low = 0, .high = 5},
    {"cd_m095", TABLE_DOUBLE, FIELD(m.drag[2]), .low = 0, .high = 5},
    {"cd_m105", TABLE_DOUBLE, FIELD(m.drag[3]), .low = 0, .high = 5},
    {"cd_m120", TABLE_DOUBLE, FIELD(m.drag[4]), .low = 0, .high = 5},
    {"cd_m200", TABLE_DOUBLE, FIELD(m.drag[5]), .low = 0, .high = 5},
    {"cd_m300", TABLE_DOUBLE, FIELD(m.drag[6]), .low = 0, .high = 5},
    {"cd_m500", TABLE_DOUBLE, FIELD(m.drag[7]), .low = 0, .high = 5},
    {"lift_per_rad", TABLE_DOUBLE, FIELD(m.lift_slope), .low = 0, .high = 200},
    {"attack_deg", TABLE_DOUBLE, FIELD(m.most_attack_rad), .low = 0, .high = 45, .unit = rad_per_deg},
    {"lateral_g", TABLE_DOUBLE, FIELD(m.most_lateral_mps2), .low = 0, .high = 100, .unit = standard_mps2},
    {"lag_s", TABLE_DOUBLE, FIELD(m.lag_s), .low = 0.01, .high = 10},
    {"damping", TABLE_DOUBLE, FIELD(m.damping), .low = 0, .high = 5},
    {"gain", TABLE_DOUBLE, FIELD(m.gain), .low = 0, .high = 20},
    {"gravity_share", TABLE_DOUBLE, FIELD(m.gravity_share), .low = 0, .high = 2},
    {"guide_after_s", TABLE_DOUBLE, FIELD(m.guide_after_s), .low = 0, .high = 600},
    {"loft_deg", TABLE_DOUBLE, FIELD(m.loft_rad), .low = 0, .high = 80, .unit = rad_per_deg},
    {"loft_m", TABLE_DOUBLE, FIELD(m.loft_m), .low = 0, .high = 20000},
    {"dive_deg", TABLE_DOUBLE, FIELD(m.dive_rad), .low = 0, .high = 80, .unit = rad_per_deg},
    {"gimbal_deg", TABLE_DOUBLE, FIELD(m.gimbal_rad), .low = 0, .high = 120, .unit = rad_per_deg},
    {"gimbal_rate_dps", TABLE_DOUBLE, FIELD(m.gimbal_rate_rps), .low = 0, .high = 1000, .unit = rad_per_deg},
    {"field_deg", TABLE_DOUBLE, FIELD(m.field_rad), .low = 0, .high = 180, .unit = rad_per_deg},
    {"memory_s", TABLE_DOUBLE, FIELD(m.memory_s), .low = 0.001, .high = 60},
    {"fuze_m", TABLE_DOUBLE, FIELD(m.fuze_m), .low = 0, .high = 100},
    {"life_s", TABLE_DOUBLE, FIELD(m.life_s), .low = 1, .high = 600},
};
static const TableFormat format = {"missiles", columns, sizeof columns / sizeof *columns, .least_rows = 1,
                                   .next = "etc/missiles.csv explains the columns"};

/* Times that end a burn lie on the grid of 1 ms. */
static bool on_grid(double t_s) { return fabs(1000 * t_s - round(1000 * t_s)) < 1e-6; }

static Status read_row(Missile *out, const TableRows *rows, int number)
{
    Row      row = {0};
    Status   status = table_rows_get(&row, rows, number);
    Missile *m = &row.m;
    if (status != STATUS_OK) return status;
    if (!*row.name || strlen(row.name) >= sizeof m->name)
        return table_rows_refuse(rows, number, "name", "1 .. %zu letters", sizeof m->name - 1);
    snprintf(m->name, sizeof m->name, "%s", row.name);
    m->area_m2 = pi_rad / 4 * row.diameter_m * row.diameter_m;
    static const char *const kg[] = {"boost_kg", "sustain_kg"}, *const s[] = {"boost_s", "sustain_s"};
    for (int k = 0; k < missile_stages; k++) {
        if (!on_grid(m->burn_s[k])) return table_rows_refuse(rows, number, s[k], "whole milliseconds");
        if (m->burn_s[k] == 0 && (m->burn_kg[k] > 0 || m->thrust_n[k] > 0))
            return table_rows_refuse(rows, number, s[k], "above 0, for a motor with mass or thrust");
        if (m->burn_kg[k] > 0.9 * m->mass_kg)
            return table_rows_refuse(rows, number, kg[k], "up to 0.9 of mass_kg: %g", 0.9 * m->mass_kg);
    }
    if (!on_grid(m->ignite_s)) return table_rows_refuse(rows, number, "ignite_s", "whole milliseconds");
    if (m->burn_kg[0] + m->burn_kg[1] > 0.9 * m->mass_kg)
        return table_rows_refuse(rows, number, "mass_kg", "a tenth more than boost_kg and sustain_kg together");
    if (m->damping > 0 && m->damping < 0.1)
        return table_rows_refuse(rows, number, "damping", "0 (first order), or 0.1 .. 5");
    if (m->guidance != MISSILE_COMMAND && !(m->gimbal_rad > 0 && m->gimbal_rate_rps > 0 && m->field_rad > 0))
        return table_rows_refuse(rows, number, "gimbal_deg",
                                 "above 0, with gimbal_rate_dps and field_deg: %s has a seeker",
                                 missile_guidance_name(m->guidance));
    if (m->guidance == MISSILE_LOFT && !(m->loft_rad > 0 && m->dive_rad > 0))
        return table_rows_refuse(rows, number, "loft_deg", "above 0, with dive_deg, for loft");
    *out = *m;
    return STATUS_OK;
}

Status missile_read(Missile *out, const char *path, const char *name)
{
    TableRows rows;
    int       row;
    Status    status = table_rows_open(&rows, &format, path);
    if (status != STATUS_OK) return status;
    status = table_rows_find(&row, &rows, name, "missile", "", "");
    if (status == STATUS_OK) status = read_row(out, &rows, row);
    table_rows_close(&rows);
    return status;
}

Status missile_read_all(Missile *out, int most, int *count, const char *path)
{
    TableRows rows;
    Status    status = table_rows_open(&rows, &format, path);
    if (status != STATUS_OK) return status;
    for (int row = 0; row < rows.table.rows && status == STATUS_OK; row++) {
        Missile m;
        status = read_row(&m, &rows, row);
        if (status == STATUS_OK && row < most) out[row] = m;
    }
    if (status == STATUS_OK) *count = rows.table.rows;
    table_rows_close(&rows);
    return status;
}
