/* render/scattering/built/thing_table.c: reads etc/radar/things.csv. */
#include "render/scattering/built/thing_table.h"

#include "pitviper_table.h"

static const double cross_db = -10; /* HV over VV of vehicles: estimate, between tubes' -14 and -6 dB */

typedef struct Row {
    char   name[32];
    int    band;
    double dbsm[thing_aspects];
} Row;

static const char *band_named(int k) { return clutter_band_name((ClutterBand)k); }

#define ASPECT(deg, k)                                                                                                 \
    {                                                                                                                  \
        "dbsm_" #deg, TABLE_DOUBLE, offsetof(Row, dbsm) + (k) * sizeof(double), sizeof(double), .low = -60, .high = 60 \
    }
static const TableColumn columns[] = {
    {"name", TABLE_NAME, TABLE_AT(Row, name), .absent = TABLE_REQUIRED},
    {"band", TABLE_NAMED, TABLE_AT(Row, band), .low = 0, .high = CLUTTER_BAND_COUNT - 1, .named = band_named},
    ASPECT(0, 0),
    ASPECT(30, 1),
    ASPECT(60, 2),
    ASPECT(90, 3),
    ASPECT(120, 4),
    ASPECT(150, 5),
    ASPECT(180, 6),
};
static const TableFormat format = {"radar things", columns, sizeof columns / sizeof *columns,
                                   .next = "etc/radar/things.csv explains the columns",
                                   .most_rows = thing_rows_most * CLUTTER_BAND_COUNT};

typedef struct Reading {
    ThingTable table;
    unsigned   bands[thing_rows_most]; /* that a row has */
} Reading;

static Status take_row(void *user, const void *read, const TableRows *rows, int number)
{
    const Row *row = read;
    Reading   *to = user;
    int        i = 0;
    while (i < to->table.count && strcmp(to->table.row[i].name, row->name) != 0) i++;
    if (i == thing_rows_most) return table_rows_refuse(rows, number, "name", "no more than %d shapes", thing_rows_most);
    if (i == to->table.count) memcpy(to->table.row[to->table.count++].name, row->name, sizeof row->name);
    if (to->bands[i] >> row->band & 1)
        return table_rows_refuse(rows, number, "band", "a band that %s has no row of yet", row->name);
    to->bands[i] |= 1u << row->band;
    memcpy(to->table.row[i].dbsm[row->band], row->dbsm, sizeof row->dbsm);
    return STATUS_OK;
}

Status thing_table_open(ThingTable *out, const char *path)
{
    Reading reading = {.table.hv = pow(10, cross_db / 10)};
    Row     row;
    Status  status = table_each(&format, path, &row, sizeof row, take_row, &reading);
    for (int i = 0; i < reading.table.count && status == STATUS_OK; i++)
        if (reading.bands[i] != (1u << CLUTTER_BAND_COUNT) - 1) {
            log_error("%s: %s: %s has not a row for each of Ku, Ka and W; %s", format.module, path,
                      reading.table.row[i].name, format.next);
            status = STATUS_BAD_VALUE;
        }
    if (status == STATUS_OK) *out = reading.table;
    return status;
}

const ThingRow *thing_row(const ThingTable *table, const char *name)
{
    for (int i = 0; i < table->count; i++)
        if (strcmp(table->row[i].name, name) == 0) return &table->row[i];
    return NULL;
}

double thing_rcs_m2(const ThingRow *row, ClutterBand band, const double u_body[3])
{
    const double aspect = atan2(fabs(u_body[1]), u_body[0]) / (30 * rad_per_deg);
    const int    i = (int)clamp(floor(aspect), 0, thing_aspects - 2);
    const double share = clamp(aspect - i, 0, 1), *db = row->dbsm[band];
    return pow(10, 0.1 * (db[i] + share * (db[i + 1] - db[i])));
}
