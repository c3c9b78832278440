/* render/scattering/signatures/given_signature.c: reads signatures that are given and lists of them, and looks them up.
 */
#include "render/scattering/signatures/given_signature.h"
#include "pitviper_table.h"

#include <stdlib.h>

enum { most_rows = 1 << 22 };
enum { HH, HV, VH, VV, polarisations };
enum { AZIMUTH, ELEVATION, FREQUENCY, axes };

typedef struct GivenScatterer {
    double         p[3];
    double complex s[polarisations]; /* m */
    double         azimuth_rad, azimuth_half_rad, elevation_rad, elevation_half_rad;
} GivenScatterer;

/* Ascending values along one axis of the grid, deg and GHz. */
typedef struct GivenAxis {
    int     count;
    double *at;
    bool    round; /* azimuths: the last is followed by the first */
} GivenAxis;

struct GivenSignature {
    int             scatterers; /* 0: a grid */
    GivenScatterer *scatterer;
    GivenAxis       axis[axes];
    bool            has_phase;
    double complex *s; /* [azimuth][elevation][frequency][polarisations]; m; without phase: dBsm */
};

const char *given_signature_path(const char *name)
{
    static const char mark[] = "given:";
    return name && strncmp(name, mark, sizeof mark - 1) == 0 ? name + sizeof mark - 1 : NULL;
}

/* ---- reading ---------------------------------------------------------------------------------------- */

static const char of_signatures[] = "etc/reference/radar_given.md explains the columns; repeat those of one "
                                    "polarisation as hh and vv where only one was measured";

static double complex of_dbsm(double dbsm, double phase_rad)
{
    return sqrt(pow(10, dbsm / 10) / (4 * pi_rad)) * CMPLX(cos(phase_rad), sin(phase_rad));
}

/* A place on the target, and what it returns. A polarisation that is not given has NaN. */
typedef struct ScattererRow {
    double p[3], dbsm[polarisations], phase_rad[polarisations];
    double azimuth_rad, azimuth_wide_rad, elevation_rad, elevation_wide_rad;
} ScattererRow;

#define SCATTERER(member) TABLE_AT(ScattererRow, member)
#define ANGLE(lowest, highest, without)                                                                                \
    .low = lowest, .high = highest, .unit = rad_per_deg, .absent = TABLE_OPTIONAL, .otherwise = without
#define DBSM(when) .low = -200, .high = 100, .absent = when, .otherwise = NAN

static const TableColumn scatterer_columns[] = {
    {"x_m", TABLE_DOUBLE, SCATTERER(p[0]), .low = -1000, .high = 1000},
    {"y_m", TABLE_DOUBLE, SCATTERER(p[1]), .low = -1000, .high = 1000},
    {"z_m", TABLE_DOUBLE, SCATTERER(p[2]), .low = -1000, .high = 1000},
    {"hh_dbsm", TABLE_DOUBLE, SCATTERER(dbsm[HH]), DBSM(TABLE_EMPTY)},
    {"hv_dbsm", TABLE_DOUBLE, SCATTERER(dbsm[HV]), DBSM(TABLE_OPTIONAL)},
    {"vh_dbsm", TABLE_DOUBLE, SCATTERER(dbsm[VH]), DBSM(TABLE_OPTIONAL)},
    {"vv_dbsm", TABLE_DOUBLE, SCATTERER(dbsm[VV]), DBSM(TABLE_EMPTY)},
    {"hh_deg", TABLE_DOUBLE, SCATTERER(phase_rad[HH]), ANGLE(-1e6, 1e6, 0)},
    {"hv_deg", TABLE_DOUBLE, SCATTERER(phase_rad[HV]), ANGLE(-1e6, 1e6, 0)},
    {"vh_deg", TABLE_DOUBLE, SCATTERER(phase_rad[VH]), ANGLE(-1e6, 1e6, 0)},
    {"vv_deg", TABLE_DOUBLE, SCATTERER(phase_rad[VV]), ANGLE(-1e6, 1e6, 0)},
    {"az_deg", TABLE_DOUBLE, SCATTERER(azimuth_rad), ANGLE(-720, 720, 0)},
    {"az_width_deg", TABLE_DOUBLE, SCATTERER(azimuth_wide_rad), ANGLE(0, 360, 360)},
    {"el_deg", TABLE_DOUBLE, SCATTERER(elevation_rad), ANGLE(-90, 90, 0)},
    {"el_width_deg", TABLE_DOUBLE, SCATTERER(elevation_wide_rad), ANGLE(0, 180, 180)},
};
static const TableFormat scatterer_format = {
    "signature", scatterer_columns, sizeof scatterer_columns / sizeof *scatterer_columns, .next = of_signatures};

static Status read_scatterers(GivenSignature *g, TableRows *rows)
{
    Status status = table_rows_use(rows, &scatterer_format);
    g->scatterer = calloc((size_t)rows->table.rows + 1, sizeof *g->scatterer);
    if (!g->scatterer) return STATUS_NO_MEMORY;
    for (int i = 0; i < rows->table.rows && status == STATUS_OK; i++) {
        GivenScatterer *s = &g->scatterer[i];
        ScattererRow    row = {0};
        status = table_rows_get(&row, rows, i);
        if (status != STATUS_OK) break;
        memcpy(s->p, row.p, sizeof s->p);
        for (int p = 0; p < polarisations; p++)
            if (!isnan(row.dbsm[p])) s->s[p] = of_dbsm(row.dbsm[p], row.phase_rad[p]);
        if (isnan(row.dbsm[HV])) s->s[HV] = s->s[VH];
        if (isnan(row.dbsm[VH])) s->s[VH] = s->s[HV];
        s->azimuth_rad = row.azimuth_rad, s->azimuth_half_rad = 0.5 * row.azimuth_wide_rad;
        s->elevation_rad = row.elevation_rad, s->elevation_half_rad = 0.5 * row.elevation_wide_rad;
    }
    g->scatterers = rows->table.rows;
    return status;
}

static int ascending(const void *a, const void *b)
{
    const double p = *(const double *)a, q = *(const double *)b;
    return (p > q) - (p < q);
}

/* The values in one column of rows of numbers, `columns` each. */
static Status fill_axis(GivenAxis *axis, const double *number, int columns, int rows)
{
    axis->at = calloc((size_t)rows + 1, sizeof *axis->at);
    if (!axis->at) return STATUS_NO_MEMORY;
    for (int i = 0; i < rows; i++) axis->at[i] = number[(size_t)i * (size_t)columns];
    qsort(axis->at, (size_t)rows, sizeof *axis->at, ascending);
    for (int i = 0; i < rows; i++)
        if (i == 0 || axis->at[i] > axis->at[axis->count - 1]) axis->at[axis->count++] = axis->at[i];
    return STATUS_OK;
}

static double widest_step(const GivenAxis *axis)
{
    double widest = 0;
    for (int i = 1; i < axis->count; i++) widest = fmax(widest, axis->at[i] - axis->at[i - 1]);
    return widest;
}

static int index_of(const GivenAxis *axis, double at)
{
    const double *found = bsearch(&at, axis->at, (size_t)axis->count, sizeof *axis->at, ascending);
    return (int)(found - axis->at);
}

/* Values of one row: fields (x, y), or decibels x of each polarisation; NaN: not given. */
static void take_values(double complex *s, const double x[polarisations], const double y[polarisations], bool has_phase)
{
    for (int p = 0; p < polarisations; p++)
        s[p] = !isnan(x[p]) ? CMPLX(x[p], has_phase ? y[p] : 0) : has_phase ? 0 : -200;
    if (isnan(x[HV])) s[HV] = s[VH];
    if (isnan(x[VH])) s[VH] = s[HV];
}

/* Neighbours in azimuth whose fields do not follow one another cannot be interpolated. */
static void warn_of_coarse_steps(const GivenSignature *g, const Table *table)
{
    const size_t one = (size_t)g->axis[ELEVATION].count * (size_t)g->axis[FREQUENCY].count * polarisations;
    double       along = 0, whole = 0;
    for (size_t i = 0; g->has_phase && i < one * (size_t)(g->axis[AZIMUTH].count - 1); i++) {
        along += creal(g->s[i] * conj(g->s[i + one]));
        whole += cabs(g->s[i]) * cabs(g->s[i + one]);
    }
    if (whole > 0 && along < 0.5 * whole)
        log_warn(
            "signature: %s: fields of neighbouring azimuths differ too much to be interpolated (their correlation is %.2f, and "
            "should be above 0.5); give a finer grid, or dBsm alone",
            table->path, along / whole);
}

/* Numbers of a row of a grid: axes; fields, or decibels (x), and their imaginary parts (y). */
enum { AT_X = axes, AT_Y = AT_X + polarisations, grid_numbers = AT_Y + polarisations };

#define FIELD(k, when, without)                                                                                        \
    TABLE_DOUBLE, TABLE_AT_NUMBER(k), .low = -1e6, .high = 1e6, .absent = when, .otherwise = without
#define AXES                                                                                                           \
    {"az_deg", TABLE_DOUBLE, TABLE_AT_NUMBER(AZIMUTH), .low = -720, .high = 720},                                      \
        {"el_deg", TABLE_DOUBLE, TABLE_AT_NUMBER(ELEVATION), .low = -90, .high = 90},                                  \
    {                                                                                                                  \
        "f_ghz", TABLE_DOUBLE, TABLE_AT_NUMBER(FREQUENCY), .low = 0.1, .high = 300                                     \
    }

static const TableColumn field_columns[grid_numbers] = {
    AXES,
    {"hh_re_m", FIELD(AT_X + HH, TABLE_EMPTY, NAN)},
    {"hv_re_m", FIELD(AT_X + HV, TABLE_OPTIONAL, NAN)},
    {"vh_re_m", FIELD(AT_X + VH, TABLE_OPTIONAL, NAN)},
    {"vv_re_m", FIELD(AT_X + VV, TABLE_OPTIONAL, NAN)},
    {"hh_im_m", FIELD(AT_Y + HH, TABLE_EMPTY, 0)},
    {"hv_im_m", FIELD(AT_Y + HV, TABLE_OPTIONAL, 0)},
    {"vh_im_m", FIELD(AT_Y + VH, TABLE_OPTIONAL, 0)},
    {"vv_im_m", FIELD(AT_Y + VV, TABLE_EMPTY, 0)},
};
static const TableColumn decibel_columns[grid_numbers] = {
    AXES,
    {"hh_dbsm", TABLE_DOUBLE, TABLE_AT_NUMBER(AT_X + HH), DBSM(TABLE_EMPTY)},
    {"hv_dbsm", TABLE_DOUBLE, TABLE_AT_NUMBER(AT_X + HV), DBSM(TABLE_OPTIONAL)},
    {"vh_dbsm", TABLE_DOUBLE, TABLE_AT_NUMBER(AT_X + VH), DBSM(TABLE_OPTIONAL)},
    {"vv_dbsm", TABLE_DOUBLE, TABLE_AT_NUMBER(AT_X + VV), DBSM(TABLE_EMPTY)},
};
static const TableFormat field_format = {"signature", field_columns, grid_numbers, .next = of_signatures},
                         decibel_format = {"signature", decibel_columns, AT_Y, .next = of_signatures};

static Status fill_grid(GivenSignature *g, const TableRows *rows, const double *numbers, const bool read[polarisations])
{
    const int        count = rows->table.rows, columns = rows->format->count;
    const GivenAxis *az = &g->axis[AZIMUTH], *el = &g->axis[ELEVATION], *f = &g->axis[FREQUENCY];
    const double     span_deg = az->at[az->count - 1] - az->at[0];
    const long long  cells = (long long)az->count * el->count * f->count;
    if (!(span_deg <= 360 + 1e-9))
        return table_rows_refuse(rows, 0, NULL, "azimuths span more than 360 degrees; give each look once");
    if (cells != count)
        return table_rows_lack(rows,
                               "%d rows for %d azimuths, %d elevations and %d frequencies, which need %lld; give each "
                               "combination once",
                               count, az->count, el->count, f->count, cells);
    g->axis[AZIMUTH].round = az->count > 2 && 360 - span_deg <= 1.5 * widest_step(az);
    g->s = calloc((size_t)cells * polarisations, sizeof *g->s);
    uint8_t *met = calloc((size_t)cells, 1);
    Status   status = g->s && met ? STATUS_OK : STATUS_NO_MEMORY;
    for (int i = 0; i < count && status == STATUS_OK; i++) {
        const double *at = numbers + (size_t)i * (size_t)columns;
        const size_t  cell =
            ((size_t)index_of(az, at[AZIMUTH]) * (size_t)el->count + (size_t)index_of(el, at[ELEVATION])) *
                (size_t)f->count +
            (size_t)index_of(f, at[FREQUENCY]);
        if (met[cell]) status = table_rows_refuse(rows, i, NULL, "this look and frequency were given before");
        met[cell] = 1;
        double x[polarisations];
        for (int p = 0; p < polarisations; p++) x[p] = read[p] ? at[AT_X + p] : NAN;
        take_values(g->s + polarisations * cell, x, at + AT_Y, g->has_phase);
    }
    free(met);
    return status;
}

static Status read_grid(GivenSignature *g, TableRows *rows)
{
    bool    read[polarisations] = {true, true, true, true};
    double *numbers = NULL;
    g->has_phase = table_rows_has(rows, "hh_re_m") && table_rows_has(rows, "hh_im_m");
    Status status = table_rows_use(rows, g->has_phase ? &field_format : &decibel_format);
    for (int p = 0; p < polarisations && g->has_phase; p++) /* a real part alone is none */
        read[p] = table_rows_has(rows, field_columns[AT_Y + p].name);
    if (status == STATUS_OK) status = table_rows_numbers(&numbers, rows);
    for (int a = 0; a < axes && status == STATUS_OK; a++)
        status = fill_axis(&g->axis[a], numbers + a, rows->format->count, rows->table.rows);
    if (status == STATUS_OK) status = fill_grid(g, rows, numbers, read);
    free(numbers);
    if (status == STATUS_OK) warn_of_coarse_steps(g, &rows->table);
    return status;
}

Status given_signature_open(GivenSignature **out, const char *path)
{
    static const TableFormat any = {"signature",           NULL, 0, .next = of_signatures, .least_rows = 1,
                                    .most_rows = most_rows};
    TableRows                rows = {0};
    GivenSignature          *g = calloc(1, sizeof *g);
    if (!g) return STATUS_NO_MEMORY;
    Status status = table_rows_open(&rows, &any, path);
    if (status == STATUS_OK) status = table_rows_has(&rows, "x_m") ? read_scatterers(g, &rows) : read_grid(g, &rows);
    table_rows_close(&rows);
    if (status == STATUS_OK) *out = g;
    else given_signature_close(g);
    return status;
}

void given_signature_close(GivenSignature *g)
{
    if (!g) return;
    for (int a = 0; a < axes; a++) free(g->axis[a].at);
    free(g->scatterer);
    free(g->s);
    free(g);
}

/* ---- at a look -------------------------------------------------------------------------------------- */

/* The two values of an axis that a value lies between. */
typedef struct Between {
    int    low, high;
    double share; /* of high */
} Between;

/* False: the value is beyond the ends of the axis by more than `beyond`. */
static bool between(Between *out, const GivenAxis *axis, double at, double beyond)
{
    const int last = axis->count - 1;
    if (!(at >= axis->at[0] - beyond && at <= axis->at[last] + beyond)) return false;
    int low = 0, high = last;
    while (high - low > 1) {
        const int middle = low + (high - low) / 2;
        if (axis->at[middle] <= at) low = middle;
        else high = middle;
    }
    *out = (Between){low, high, high > low ? clamp((at - axis->at[low]) / (axis->at[high] - axis->at[low]), 0, 1) : 0};
    return true;
}

static bool between_azimuths(Between *out, const GivenAxis *axis, double at)
{
    const double first = axis->at[0], last = axis->at[axis->count - 1], step = widest_step(axis);
    double       turned = at - 360 * floor((at - first) / 360); /* first .. first + 360 */
    if (turned > last && axis->round) {
        *out = (Between){axis->count - 1, 0, (turned - last) / (first + 360 - last)};
        return true;
    }
    const double beyond = axis->count > 1 ? 0.5 * step : 0.5;
    if (turned > last + beyond) turned -= 360;
    return between(out, axis, turned, beyond);
}

static double azimuth_of(const ScatterAntenna *antenna) { return atan2(antenna->u[1], antenna->u[0]); }
static double elevation_of(const ScatterAntenna *antenna) { return asin(clamp(-antenna->u[2], -1, 1)); }

static bool find(Between at[axes], const GivenSignature *g, const ScatterAntenna *antenna, double frequency_hz)
{
    const GivenAxis *el = &g->axis[ELEVATION], *f = &g->axis[FREQUENCY];
    const double     ghz = 1e-9 * frequency_hz, first = f->at[0], last = f->at[f->count - 1];
    if (!(ghz >= 0.95 * first && ghz <= 1.05 * last)) return false;
    return between_azimuths(&at[AZIMUTH], &g->axis[AZIMUTH], azimuth_of(antenna) / rad_per_deg) &&
           between(&at[ELEVATION], el, elevation_of(antenna) / rad_per_deg,
                   el->count > 1 ? 0.5 * widest_step(el) : 2.5) &&
           between(&at[FREQUENCY], f, clamp(ghz, first, last), 0);
}

static void grid_field(ScatterMatrix *out, const GivenSignature *g, const Between at[axes])
{
    double complex sum[polarisations] = {0};
    for (int corner = 0; corner < 8; corner++) {
        size_t cell = 0;
        double weight = 1;
        for (int a = 0; a < axes; a++) {
            const bool high = corner >> a & 1;
            cell = cell * (size_t)g->axis[a].count + (size_t)(high ? at[a].high : at[a].low);
            weight *= high ? at[a].share : 1 - at[a].share;
        }
        for (int p = 0; p < polarisations && weight > 0; p++) sum[p] += weight * g->s[polarisations * cell + (size_t)p];
    }
    for (int p = 0; p < polarisations && !g->has_phase; p++)
        sum[p] = creal(sum[p]) > -199.9 ? of_dbsm(creal(sum[p]), 0) : 0;
    *out = (ScatterMatrix){sum[HH], sum[HV], sum[VH], sum[VV]};
}

static bool scatterer_shows(const GivenScatterer *s, const ScatterAntenna *antenna)
{
    const double turn = remainder(azimuth_of(antenna) - s->azimuth_rad, 2 * pi_rad),
                 up = elevation_of(antenna) - s->elevation_rad;
    return fabs(turn) <= s->azimuth_half_rad + 1e-12 && fabs(up) <= s->elevation_half_rad + 1e-12;
}

bool given_signature_knows(const GivenSignature *g, const ScatterAntenna *antenna, double frequency_hz)
{
    Between at[axes];
    return g->scatterers > 0 || find(at, g, antenna, frequency_hz);
}

void given_signature_field(ScatterMatrix *s, const GivenSignature *g, const ScatterAntenna *antenna,
                           double frequency_hz)
{
    const double k = 2 * pi_rad * frequency_hz / light_mps;
    Between      at[axes];
    *s = (ScatterMatrix){0};
    if (g->scatterers == 0 && find(at, g, antenna, frequency_hz)) grid_field(s, g, at);
    for (int i = 0; i < g->scatterers; i++) {
        const GivenScatterer *one = &g->scatterer[i];
        double                way[3];
        if (!scatterer_shows(one, antenna)) continue;
        const double complex turn = cexp(-I * k * 2 * scatter_path(way, antenna, one->p));
        s->hh += one->s[HH] * turn, s->hv += one->s[HV] * turn, s->vh += one->s[VH] * turn, s->vv += one->s[VV] * turn;
    }
}

static Status grow(Centres *out, int count)
{
    if (count <= out->capacity) return STATUS_OK;
    ScatterCentre *centre = realloc(out->centre, (size_t)count * sizeof *centre);
    if (!centre) return STATUS_NO_MEMORY;
    out->centre = centre;
    out->capacity = count;
    return STATUS_OK;
}

static double amplitude_of(const ScatterMatrix *s)
{
    const double complex of[polarisations] = {s->hh, s->hv, s->vh, s->vv};
    double               power = 0;
    for (int p = 0; p < polarisations; p++) power += creal(of[p]) * creal(of[p]) + cimag(of[p]) * cimag(of[p]);
    return sqrt(0.5 * power);
}

static void add(Centres *out, const ScatterMatrix *s, const double p[3], double path_m)
{
    const double amplitude = amplitude_of(s);
    if (!(amplitude > 0)) return;
    out->centre[out->count++] = (ScatterCentre){.path_m = path_m,
                                                .p = {p[0], p[1], p[2]},
                                                .s = *s,
                                                .weight = amplitude,
                                                .bounce = 1,
                                                .part = -1,
                                                .strongest = amplitude};
}

Status given_signature_centres(Centres *out, const GivenSignature *g, const ScatterAntenna *antenna,
                               double frequency_hz)
{
    static const double origin[3];
    out->count = 0;
    out->tubes_same_m2 = out->tubes_cross_m2 = 0;
    const Status status = grow(out, g->scatterers > 0 ? g->scatterers : 1);
    if (status != STATUS_OK) return status;
    if (g->scatterers == 0) {
        ScatterMatrix s;
        given_signature_field(&s, g, antenna, frequency_hz);
        add(out, &s, origin, 0);
    }
    for (int i = 0; i < g->scatterers; i++) {
        const GivenScatterer *one = &g->scatterer[i];
        const ScatterMatrix   s = {one->s[HH], one->s[HV], one->s[VH], one->s[VV]};
        double                way[3];
        if (scatterer_shows(one, antenna)) add(out, &s, one->p, 2 * scatter_path(way, antenna, one->p));
    }
    return STATUS_OK;
}

/* ---- the list: which entities have one ------------------------------------------------------------------ */

enum { by_any, by_model, by_id };

typedef struct GivenRow {
    int             by;
    DisEntityId     id;
    char            model[model_name_size];
    GivenSignature *signature;
} GivenRow;

struct GivenList {
    int       count;
    GivenRow *row;
};

typedef struct ListRow {
    const char *entity, *signature;
} ListRow;

static const TableColumn list_columns[] = {
    {"entity", .type = TABLE_CELL, TABLE_AT(ListRow, entity)},
    {"signature", .type = TABLE_CELL, TABLE_AT(ListRow, signature)},
};
static const TableFormat list_format = {"radar.given", list_columns, 2,
                                        .next = "etc/reference/radar_given.md explains the columns"};

static Status take_row(GivenRow *out, const TableRows *rows, int number)
{
    ListRow      row;
    const char  *slash = strrchr(rows->table.path, '/');
    char         path[4096];
    const Status status = table_rows_get(&row, rows, number);
    if (status != STATUS_OK) return status;
    const char *entity = row.entity, *file = row.signature;
    if (!*entity || !*file)
        return table_rows_refuse(rows, number, NULL, "entity or signature is empty; * stands for all entities");
    out->by = strcmp(entity, "*") == 0 ? by_any : dis_entity_id_parse(&out->id, entity) ? by_id : by_model;
    if (snprintf(out->model, sizeof out->model, "%s", entity) >= (int)sizeof out->model)
        return table_rows_refuse(rows, number, NULL, "the name of a model is too long; see `pitviper model list`");
    const int folder = slash && *file != '/' ? (int)(slash - rows->table.path) + 1 : 0;
    if (snprintf(path, sizeof path, "%.*s%s", folder, rows->table.path, file) >= (int)sizeof path)
        return table_rows_refuse(rows, number, NULL, "the path of the signature is too long");
    return given_signature_open(&out->signature, path);
}

Status given_list_open(GivenList **out, const char *path)
{
    TableRows  rows = {0};
    GivenList *list = calloc(1, sizeof *list);
    if (!list) return STATUS_NO_MEMORY;
    Status status = table_rows_open(&rows, &list_format, path);
    if (status == STATUS_OK) list->row = calloc((size_t)rows.table.rows + 1, sizeof *list->row);
    if (status == STATUS_OK && !list->row) status = STATUS_NO_MEMORY;
    for (int i = 0; status == STATUS_OK && i < rows.table.rows; i++)
        status = take_row(&list->row[list->count++], &rows, i);
    table_rows_close(&rows);
    if (status == STATUS_OK) *out = list;
    else given_list_close(list);
    return status;
}

void given_list_close(GivenList *list)
{
    if (!list) return;
    for (int i = 0; i < list->count; i++) given_signature_close(list->row[i].signature);
    free(list->row);
    free(list);
}

const GivenSignature *given_list_find(const GivenList *list, DisEntityId id, const char *model)
{
    const GivenRow *best = NULL;
    for (int i = 0; list && i < list->count; i++) {
        const GivenRow *row = &list->row[i];
        const bool      is_it = row->by == by_any || (row->by == by_id ? dis_entity_id_compare(row->id, id) == 0
                                                                       : strcmp(row->model, model) == 0);
        if (is_it && (!best || row->by > best->by)) best = row;
    }
    return best ? best->signature : NULL;
}
