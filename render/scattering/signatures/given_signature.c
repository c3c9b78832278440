/* render/scattering/signatures/given_signature.c: reads signatures that are given and lists of them, and looks them up.
 */
#include "render/scattering/signatures/given_signature.h"

#include <stdlib.h>

enum { most_rows = 1 << 22 };
enum { HH, HV, VH, VV, polarisations };
enum { AZIMUTH, ELEVATION, FREQUENCY, axes };

static const char *const polarisation_name[polarisations] = {"hh", "hv", "vh", "vv"};

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

static Status complain(const Table *table, int row, const char *what)
{
    log_error("signature: %s:%d: %s", table->path, table->line[row + 1], what);
    return STATUS_BAD_VALUE;
}

/* A number of a column that may be missing or empty. */
static Status optional(double *out, const Table *table, int row, int column, double low, double high, double otherwise)
{
    *out = otherwise;
    return column < 0 || !*table_text(table, row, column) ? STATUS_OK
                                                          : table_number(out, table, row, column, low, high);
}

static int column_of(const Table *table, int p, const char *what)
{
    char name[16];
    snprintf(name, sizeof name, "%s_%s", polarisation_name[p], what);
    return table_column(table, name);
}

static double complex of_dbsm(double dbsm, double phase_rad)
{
    return sqrt(pow(10, dbsm / 10) / (4 * pi_rad)) * CMPLX(cos(phase_rad), sin(phase_rad));
}

static Status need(const Table *table, const int *column, const char *names)
{
    if (column[HH] >= 0 && column[VV] >= 0) return STATUS_OK;
    log_error("signature: %s: needs the columns %s; repeat one of them where only one polarisation was measured",
              table->path, names);
    return STATUS_BAD_VALUE;
}

static Status read_scatterers(GivenSignature *g, const Table *table)
{
    static const char *const place[3] = {"x_m", "y_m", "z_m"};
    int                      at[3], power[polarisations], phase[polarisations];
    if (!table_columns(at, table, place, 3, "signature")) return STATUS_BAD_VALUE;
    for (int p = 0; p < polarisations; p++)
        power[p] = column_of(table, p, "dbsm"), phase[p] = column_of(table, p, "deg");
    const int look[4] = {table_column(table, "az_deg"), table_column(table, "az_width_deg"),
                         table_column(table, "el_deg"), table_column(table, "el_width_deg")};
    Status    status = need(table, power, "hh_dbsm and vv_dbsm");
    g->scatterer = calloc((size_t)table->rows + 1, sizeof *g->scatterer);
    if (!g->scatterer) return STATUS_NO_MEMORY;
    for (int i = 0; i < table->rows && status == STATUS_OK; i++) {
        GivenScatterer *s = &g->scatterer[i];
        double          dbsm[polarisations], deg[polarisations], of[4];
        for (int k = 0; k < 3 && status == STATUS_OK; k++)
            status = table_number(&s->p[k], table, i, at[k], -1000, 1000);
        for (int p = 0; p < polarisations && status == STATUS_OK; p++) {
            status = optional(&dbsm[p], table, i, power[p], -200, 100, NAN);
            if (status == STATUS_OK) status = optional(&deg[p], table, i, phase[p], -1e6, 1e6, 0);
            if (status == STATUS_OK && !isnan(dbsm[p])) s->s[p] = of_dbsm(dbsm[p], deg[p] * rad_per_deg);
        }
        if (status == STATUS_OK) status = optional(&of[0], table, i, look[0], -720, 720, 0);
        if (status == STATUS_OK) status = optional(&of[1], table, i, look[1], 0, 360, 360);
        if (status == STATUS_OK) status = optional(&of[2], table, i, look[2], -90, 90, 0);
        if (status == STATUS_OK) status = optional(&of[3], table, i, look[3], 0, 180, 180);
        if (status != STATUS_OK) break;
        if (power[HV] < 0 || isnan(dbsm[HV])) s->s[HV] = s->s[VH];
        if (power[VH] < 0 || isnan(dbsm[VH])) s->s[VH] = s->s[HV];
        s->azimuth_rad = of[0] * rad_per_deg, s->azimuth_half_rad = 0.5 * of[1] * rad_per_deg;
        s->elevation_rad = of[2] * rad_per_deg, s->elevation_half_rad = 0.5 * of[3] * rad_per_deg;
    }
    g->scatterers = table->rows;
    return status;
}

static int ascending(const void *a, const void *b)
{
    const double p = *(const double *)a, q = *(const double *)b;
    return (p > q) - (p < q);
}

static Status read_axis(GivenAxis *axis, const Table *table, int column, double low, double high)
{
    axis->at = calloc((size_t)table->rows + 1, sizeof *axis->at);
    if (!axis->at) return STATUS_NO_MEMORY;
    for (int i = 0; i < table->rows; i++) {
        const Status status = table_number(&axis->at[i], table, i, column, low, high);
        if (status != STATUS_OK) return status;
    }
    qsort(axis->at, (size_t)table->rows, sizeof *axis->at, ascending);
    for (int i = 0; i < table->rows; i++)
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

/* Reads the values of one row: fields, or decibels of each polarisation. */
static Status read_values(double complex *s, const Table *table, int row, const int re[polarisations],
                          const int im[polarisations], const int power[polarisations], bool has_phase)
{
    Status status = STATUS_OK;
    bool   is_there[polarisations];
    for (int p = 0; p < polarisations && status == STATUS_OK; p++) {
        double x = NAN, y = 0;
        if (has_phase) {
            status = optional(&x, table, row, im[p] < 0 ? -1 : re[p], -1e6, 1e6, NAN);
            if (status == STATUS_OK) status = optional(&y, table, row, im[p], -1e6, 1e6, 0);
        } else {
            status = optional(&x, table, row, power[p], -200, 100, NAN);
        }
        is_there[p] = !isnan(x);
        s[p] = is_there[p] ? CMPLX(x, y) : has_phase ? 0 : -200;
    }
    if (status == STATUS_OK && !is_there[HV]) s[HV] = s[VH];
    if (status == STATUS_OK && !is_there[VH]) s[VH] = s[HV];
    return status;
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

static Status read_grid(GivenSignature *g, const Table *table)
{
    static const char *const name[axes] = {"az_deg", "el_deg", "f_ghz"};
    static const double      low[axes] = {-720, -90, 0.1}, high[axes] = {720, 90, 300};
    int                      column[axes], re[polarisations], im[polarisations], power[polarisations];
    if (!table_columns(column, table, name, axes, "signature")) return STATUS_BAD_VALUE;
    for (int p = 0; p < polarisations; p++)
        re[p] = column_of(table, p, "re_m"), im[p] = column_of(table, p, "im_m"),
        power[p] = column_of(table, p, "dbsm");
    g->has_phase = re[HH] >= 0 && im[HH] >= 0;
    Status status = g->has_phase ? need(table, im, "hh_re_m, hh_im_m, vv_re_m and vv_im_m")
                                 : need(table, power, "hh_dbsm and vv_dbsm, or hh_re_m, hh_im_m, vv_re_m and vv_im_m");
    for (int a = 0; a < axes && status == STATUS_OK; a++)
        status = read_axis(&g->axis[a], table, column[a], low[a], high[a]);
    if (status != STATUS_OK) return status;
    const GivenAxis *az = &g->axis[AZIMUTH], *el = &g->axis[ELEVATION], *f = &g->axis[FREQUENCY];
    const double     span_deg = az->at[az->count - 1] - az->at[0];
    const long long  cells = (long long)az->count * el->count * f->count;
    if (!(span_deg <= 360 + 1e-9))
        return complain(table, 0, "azimuths span more than 360 degrees; give each look once");
    if (cells != table->rows) {
        log_error(
            "signature: %s: %d rows for %d azimuths, %d elevations and %d frequencies, which need %lld; give each combination "
            "once",
            table->path, table->rows, az->count, el->count, f->count, cells);
        return STATUS_BAD_VALUE;
    }
    g->axis[AZIMUTH].round = az->count > 2 && 360 - span_deg <= 1.5 * widest_step(az);
    g->s = calloc((size_t)cells * polarisations, sizeof *g->s);
    uint8_t *met = calloc((size_t)cells, 1);
    if (!g->s || !met) status = STATUS_NO_MEMORY;
    for (int i = 0; i < table->rows && status == STATUS_OK; i++) {
        double at[axes];
        for (int a = 0; a < axes && status == STATUS_OK; a++)
            status = table_number(&at[a], table, i, column[a], low[a], high[a]);
        if (status != STATUS_OK) break;
        const size_t cell =
            ((size_t)index_of(az, at[AZIMUTH]) * (size_t)el->count + (size_t)index_of(el, at[ELEVATION])) *
                (size_t)f->count +
            (size_t)index_of(f, at[FREQUENCY]);
        if (met[cell]) status = complain(table, i, "this look and frequency were given before");
        met[cell] = 1;
        if (status == STATUS_OK)
            status = read_values(g->s + polarisations * cell, table, i, re, im, power, g->has_phase);
    }
    free(met);
    if (status == STATUS_OK) warn_of_coarse_steps(g, table);
    return status;
}

Status given_signature_open(GivenSignature **out, const char *path)
{
    Table           table = {0};
    GivenSignature *g = calloc(1, sizeof *g);
    if (!g) return STATUS_NO_MEMORY;
    Status status = table_open(&table, path);
    if (status == STATUS_OK && (table.rows < 1 || table.rows > most_rows)) {
        log_error("signature: %s: %d rows; it needs 1 to %d", path, table.rows, most_rows);
        status = STATUS_BAD_VALUE;
    }
    if (status == STATUS_OK)
        status = table_column(&table, "x_m") >= 0 ? read_scatterers(g, &table) : read_grid(g, &table);
    table_close(&table);
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

static Status complain_of_list(const Table *table, int row, const char *what)
{
    log_error("radar.given: %s:%d: %s", table->path, table->line[row + 1], what);
    return STATUS_BAD_VALUE;
}

static Status take_row(GivenRow *out, const Table *table, int row, const int column[2])
{
    const char *entity = table_text(table, row, column[0]), *file = table_text(table, row, column[1]);
    const char *slash = strrchr(table->path, '/');
    char        path[4096];
    if (!*entity || !*file)
        return complain_of_list(table, row, "entity or signature is empty; * stands for all entities");
    out->by = strcmp(entity, "*") == 0 ? by_any : dis_entity_id_parse(&out->id, entity) ? by_id : by_model;
    if (snprintf(out->model, sizeof out->model, "%s", entity) >= (int)sizeof out->model)
        return complain_of_list(table, row, "the name of a model is too long; see `pitviper model list`");
    const int folder = slash && *file != '/' ? (int)(slash - table->path) + 1 : 0;
    if (snprintf(path, sizeof path, "%.*s%s", folder, table->path, file) >= (int)sizeof path)
        return complain_of_list(table, row, "the path of the signature is too long");
    return given_signature_open(&out->signature, path);
}

Status given_list_open(GivenList **out, const char *path)
{
    static const char *const name[2] = {"entity", "signature"};
    int                      column[2];
    Table                    table = {0};
    GivenList               *list = calloc(1, sizeof *list);
    if (!list) return STATUS_NO_MEMORY;
    Status status = table_open(&table, path);
    if (status == STATUS_OK && !table_columns(column, &table, name, 2, "radar.given")) status = STATUS_BAD_VALUE;
    if (status == STATUS_OK) list->row = calloc((size_t)table.rows + 1, sizeof *list->row);
    if (status == STATUS_OK && !list->row) status = STATUS_NO_MEMORY;
    for (int i = 0; status == STATUS_OK && i < table.rows; i++)
        status = take_row(&list->row[list->count++], &table, i, column);
    table_close(&table);
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
