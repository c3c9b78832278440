/* terrain/weather/weather_file.c: reads weather files: EPW, TMY3, and tables of our own.
 *
 * Sources: EnergyPlus 24.1, Auxiliary Programs, "EnergyPlus Weather File (EPW) Data Dictionary"; Wilcox & Marion, Users
 * Manual for TMY3 Data Sets, NREL/TP-581-43156 (2008), table 1-1 and 1-2. */
#include "terrain/weather/weather_private.h"

#include <stdlib.h>
#include <strings.h>

enum { most_octets = 1 << 26, most_rows = 1000000, most_cells = 128 };

/* Fields that are read as columns are, and from which a column is computed. */
enum { field_dew_point_k = weather_columns, field_opaque_cloud, field_rain_h, field_count };

/* A number in a row: the index where its value goes, and how its unit is converted. */
typedef struct Field {
    const char *name;
    int         column;
    double      low, high;    /* range as written in the file */
    double      scale, shift; /* value = scale * number + shift */
    double
        missing; /* > 0: numbers from this upwards mean missing; < 0: numbers from this downwards; 0: no number does */
    int cell;    /* its cell in a row; -1: the file does not have it */
} Field;

typedef struct Reader {
    const char  *path;
    char        *next;             /* the text that is not read yet */
    int          line;             /* number of the last line */
    char        *cell[most_cells]; /* cells of the last line */
    int          cells;            /* number of cells, which may exceed most_cells */
    int          capacity;         /* rows that memory was allocated for */
    WeatherRows *rows;
} Reader;

/* ---- lines and cells ---------------------------------------------------------------------- */

/* Reads the next line; returns NULL when there is none. */
static char *next_line(Reader *r)
{
    char *line = r->next;
    if (!line || !*line) return NULL;
    r->next = strchr(line, '\n');
    if (r->next) *r->next++ = 0;
    r->line++;
    return line;
}

static bool split(Reader *r, char *line)
{
    r->cells = text_split(r->cell, most_cells, line);
    if (r->cells >= 0) return true;
    log_error("weather: %s:%d: a quote is not closed", r->path, r->line);
    return false;
}

/* Reads the next line that is neither blank nor a comment. Returns false when there is none, or *status is not
 * STATUS_OK. */
static bool next_row(Reader *r, bool comments, Status *status)
{
    for (char *line; (line = next_line(r));) {
        line += strspn(line, " \t\r");
        if (!*line || (comments && *line == '#')) continue;
        *status = split(r, line) ? STATUS_OK : STATUS_BAD_VALUE;
        return *status == STATUS_OK;
    }
    *status = STATUS_OK;
    return false;
}

static const char *cell_text(const Reader *r, int cell)
{
    return cell >= 0 && cell < r->cells && cell < most_cells ? r->cell[cell] : "";
}

static Status bad_number(const Reader *r, const char *name, const char *text, double low, double high)
{
    log_error("weather: %s:%d: column %s: '%.80s' is not a number in %g .. %g", r->path, r->line, name, text, low,
              high);
    return STATUS_BAD_VALUE;
}

static Status number_of(double *out, const Reader *r, const char *name, int cell, double low, double high)
{
    const char *text = cell_text(r, cell);
    double      value;
    if (!text_to_double(&value, text) || !(value >= low && value <= high)) return bad_number(r, name, text, low, high);
    *out = value;
    return STATUS_OK;
}

/* value[field_count]: NaN where the row does not give it. */
static Status fields_of(double *value, const Reader *r, const Field *field, int count)
{
    for (int i = 0; i < field_count; i++) value[i] = NAN;
    for (int i = 0; i < count; i++) {
        const Field *f = &field[i];
        const char  *text = cell_text(r, f->cell);
        double       number;
        if (!*text) continue;
        if (!text_to_double(&number, text)) return bad_number(r, f->name, text, f->low, f->high);
        if ((f->missing > 0 && number >= f->missing) || (f->missing < 0 && number <= f->missing)) continue;
        if (!(number >= f->low && number <= f->high)) return bad_number(r, f->name, text, f->low, f->high);
        value[f->column] = f->scale * number + f->shift;
    }
    return STATUS_OK;
}

/* Computes what follows from other fields of the row, and corrects what files write beyond the ranges of Weather. */
static void finish_fields(double *value)
{
    if (isnan(value[WEATHER_HUMIDITY])) /* NaN stays where either temperature is not given */
        value[WEATHER_HUMIDITY] =
            weather_saturation_pa(value[field_dew_point_k]) / weather_saturation_pa(value[WEATHER_AIR_K]);
    if (isnan(value[WEATHER_CLOUD])) value[WEATHER_CLOUD] = value[field_opaque_cloud];
    if (value[field_rain_h] > 1) value[WEATHER_RAIN_MM_H] /= value[field_rain_h];
    if (value[WEATHER_RAIN_MM_H] > 300) value[WEATHER_RAIN_MM_H] = 300; /* NREL's 703165TY has 508 mm in an hour */
    if (value[WEATHER_LONGWAVE] <= 0) value[WEATHER_LONGWAVE] = NAN;    /* files without longwave radiation hold 0 */
    if (value[WEATHER_HUMIDITY] > 1) value[WEATHER_HUMIDITY] = 1;
    if (value[WEATHER_DIRECT] < 0) value[WEATHER_DIRECT] = 0; /* instruments have offsets at night */
    if (value[WEATHER_DIFFUSE] < 0) value[WEATHER_DIFFUSE] = 0;
    value[WEATHER_VISIBILITY_M] = clamp(value[WEATHER_VISIBILITY_M], 100, 300000);
}

static Status add_row(Reader *r, double time_s, const double *value)
{
    WeatherRows *rows = r->rows;
    const int    at = rows->count;
    if (at > 0 && !(time_s > rows->time_s[at - 1])) {
        log_error("weather: %s:%d: its time is not after that of the row before", r->path, r->line);
        return STATUS_BAD_VALUE;
    }
    if (at >= r->capacity) {
        log_error("weather: %s:%d: more than %d rows", r->path, r->line, most_rows);
        return STATUS_BAD_VALUE;
    }
    rows->time_s[at] = time_s;
    for (int c = 0; c < weather_columns; c++) rows->value[c][at] = value[c];
    rows->count++;
    return STATUS_OK;
}

/* ---- typical years ------------------------------------------------------------------------ */

static const int month_days[12] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};

/* hour 1 .. 24 ends at the row's time. Returns false when there is no such date; 29 February is one, with a time of -1.
 * */
static bool time_in_year(double *time_s, int month, int day, int hour)
{
    if (month < 1 || month > 12 || day < 1 || day > month_days[month - 1] + (month == 2) || hour < 1 || hour > 24)
        return false;
    int days = day - 1;
    for (int m = 0; m < month - 1; m++) days += month_days[m];
    *time_s = month == 2 && day == 29 ? -1 : days * weather_day_s + hour * 3600.0;
    return true;
}

/* Name and place of the station, from the cells of the last line. */
static Status station_of(const Reader *r, int name, int latitude, int longitude, int utc_offset)
{
    double lat_deg, lon_deg, offset_h;
    Status status = number_of(&lat_deg, r, "latitude", latitude, -90, 90);
    if (status == STATUS_OK) status = number_of(&lon_deg, r, "longitude", longitude, -180, 180);
    if (status == STATUS_OK) status = number_of(&offset_h, r, "time zone", utc_offset, -12, 14);
    if (status != STATUS_OK) return status;
    text_show(r->rows->place, sizeof r->rows->place, cell_text(r, name), false);
    r->rows->latitude_rad = lat_deg * rad_per_deg;
    r->rows->longitude_rad = lon_deg * rad_per_deg;
    r->rows->utc_offset_s = offset_h * 3600;
    r->rows->each_year = true;
    r->rows->mean_s = 3600;
    return STATUS_OK;
}

static Status add_row_of_year(Reader *r, const char *date, int month, int day, int hour, const Field *field, int count)
{
    double time_s, value[field_count];
    if (!time_in_year(&time_s, month, day, hour)) {
        log_error("weather: %s:%d: '%.80s' is no month 1 .. 12, day and hour 1 .. 24", r->path, r->line, date);
        return STATUS_BAD_VALUE;
    }
    const Status status = fields_of(value, r, field, count);
    if (status != STATUS_OK) return status;
    if (time_s < 0) {
        r->rows->leap_rows++;
        return STATUS_OK;
    }
    finish_fields(value);
    return add_row(r, time_s, value);
}

/* ---- EPW ---------------------------------------------------------------------------------- */

static Status read_epw(Reader *r)
{
    static const Field field[] = {
        {"dry bulb temperature", WEATHER_AIR_K, -53.15, 56.85, 1, 273.15, 99.9, 6},
        {"dew point temperature", field_dew_point_k, -100, 70, 1, 273.15, 99.9, 7},
        {"relative humidity", WEATHER_HUMIDITY, 0, 110, 0.01, 0, 999, 8},
        {"atmospheric station pressure", WEATHER_PRESSURE_MBAR, 30000, 110000, 0.01, 0, 999999, 9},
        {"horizontal infrared radiation", WEATHER_LONGWAVE, 0, 1000, 1, 0, 9999, 12},
        {"direct normal radiation", WEATHER_DIRECT, 0, 1500, 1, 0, 9999, 14},
        {"diffuse horizontal radiation", WEATHER_DIFFUSE, 0, 1500, 1, 0, 9999, 15},
        {"wind direction", WEATHER_WIND_FROM_RAD, 0, 360, rad_per_deg, 0, 999, 20},
        {"wind speed", WEATHER_WIND_MPS, 0, 60, 1, 0, 999, 21},
        {"total sky cover", WEATHER_CLOUD, 0, 10, 0.1, 0, 99, 22},
        {"opaque sky cover", field_opaque_cloud, 0, 10, 0.1, 0, 99, 23},
        {"visibility", WEATHER_VISIBILITY_M, 0, 9999, 1000, 0, 9999, 24},
        {"liquid precipitation depth", WEATHER_RAIN_MM_H, 0, 999, 1, 0, 999, 33},
        {"liquid precipitation quantity", field_rain_h, 0, 99, 1, 0, 99, 34},
    };
    static const char data_periods[] = "DATA PERIODS,";
    enum { header_lines = 8, least_cells = 16 };

    r->rows->format = "EPW";
    if (!split(r, next_line(r))) return STATUS_BAD_VALUE;
    Status status = station_of(r, 1, 6, 7, 8);
    if (status != STATUS_OK) return status;
    char *line = NULL;
    while (r->line < header_lines && (line = next_line(r))) {
    }
    if (!line || strncasecmp(line, data_periods, sizeof data_periods - 1) != 0) {
        log_error("weather: %s:%d: an EPW file has `%s...` in line %d", r->path, r->line, data_periods, header_lines);
        return STATUS_BAD_VALUE;
    }
    double per_hour;
    if (!split(r, line)) return STATUS_BAD_VALUE;
    status = number_of(&per_hour, r, "number of records per hour", 2, 1, 60);
    if (status == STATUS_OK && per_hour != 1) {
        log_error("weather: %s:%d: %g records per hour; only hourly EPW files are read", r->path, r->line, per_hour);
        status = STATUS_UNSUPPORTED;
    }
    if (status != STATUS_OK) return status;

    while (next_row(r, false, &status)) {
        double month, day, hour;
        char   date[64];
        if (r->cells < least_cells) {
            log_error("weather: %s:%d: %d columns; a row of an EPW file has 35, at least %d", r->path, r->line,
                      r->cells, least_cells);
            return STATUS_BAD_VALUE;
        }
        status = number_of(&month, r, "month", 1, 1, 12);
        if (status == STATUS_OK) status = number_of(&day, r, "day", 2, 1, 31);
        if (status == STATUS_OK) status = number_of(&hour, r, "hour", 3, 1, 24);
        if (status != STATUS_OK) return status;
        snprintf(date, sizeof date, "%g, %g, %g", month, day, hour);
        const bool whole = month == floor(month) && day == floor(day) && hour == floor(hour);
        status =
            add_row_of_year(r, date, whole ? (int)month : 0, (int)day, (int)hour, field, sizeof field / sizeof *field);
        if (status != STATUS_OK) return status;
    }
    return status;
}

/* ---- tables whose header names the columns -------------------------------------------------- */

/* Sets the cell of each field whose name is in the last line. other: names that are accepted but are not fields, up to
 * a NULL; NULL: any name is accepted. */
static Status find_columns(Reader *r, Field *field, int count, const char *const *other)
{
    if (r->cells > most_cells) {
        log_error("weather: %s:%d: more than %d columns", r->path, r->line, most_cells);
        return STATUS_BAD_VALUE;
    }
    for (int i = 0; i < count; i++) field[i].cell = -1;
    for (int c = 0; c < r->cells; c++) {
        const char *name = r->cell[c];
        int         found = 0, twice = 0;
        for (int i = 0; i < count; i++)
            if (strcmp(field[i].name, name) == 0) {
                twice = field[i].cell >= 0;
                field[i].cell = c;
                found = 1;
            }
        if (!other) continue; /* other people's files have columns that are not used here */
        for (int i = 0; other[i]; i++) found |= strcmp(other[i], name) == 0;
        for (int i = 0; i < c; i++) twice |= strcmp(r->cell[i], name) == 0;
        if (!found || twice) {
            char known[512] = "";
            for (int i = 0; other[i]; i++)
                snprintf(known + strlen(known), sizeof known - strlen(known), "%s ", other[i]);
            for (int i = 0; i < count; i++)
                snprintf(known + strlen(known), sizeof known - strlen(known), "%s ", field[i].name);
            if (twice) log_error("weather: %s:%d: column %.80s is given twice", r->path, r->line, name);
            else log_error("weather: %s:%d: no such column: '%.80s'; there are: %s", r->path, r->line, name, known);
            return STATUS_BAD_VALUE;
        }
    }
    return STATUS_OK;
}

static int column_called(const Reader *r, const char *name)
{
    for (int c = 0; c < r->cells && c < most_cells; c++)
        if (strcmp(r->cell[c], name) == 0) return c;
    return -1;
}

static bool row_is_as_wide(const Reader *r, int columns)
{
    if (r->cells == columns) return true;
    log_error("weather: %s:%d: %d columns where the header has %d", r->path, r->line, r->cells, columns);
    return false;
}

static const char tmy3_date[] = "Date (MM/DD/YYYY)", tmy3_time[] = "Time (HH:MM)";

static Status read_tmy3(Reader *r)
{
    Field field[] = {
        {"Dry-bulb (C)", WEATHER_AIR_K, -53.15, 56.85, 1, 273.15, -9900, 0},
        {"Dew-point (C)", field_dew_point_k, -100, 70, 1, 273.15, -9900, 0},
        {"RHum (%)", WEATHER_HUMIDITY, 0, 110, 0.01, 0, -9900, 0},
        {"Pressure (mbar)", WEATHER_PRESSURE_MBAR, 300, 1100, 1, 0, -9900, 0},
        {"DNI (W/m^2)", WEATHER_DIRECT, 0, 1500, 1, 0, -9900, 0},
        {"DHI (W/m^2)", WEATHER_DIFFUSE, 0, 1500, 1, 0, -9900, 0},
        {"Wdir (degrees)", WEATHER_WIND_FROM_RAD, 0, 360, rad_per_deg, 0, -9900, 0},
        {"Wspd (m/s)", WEATHER_WIND_MPS, 0, 60, 1, 0, -9900, 0},
        {"TotCld (tenths)", WEATHER_CLOUD, 0, 10, 0.1, 0, -9900, 0},
        {"OpqCld (tenths)", field_opaque_cloud, 0, 10, 0.1, 0, -9900, 0},
        {"Hvis (m)", WEATHER_VISIBILITY_M, 0, 1e6, 1, 0, -9900, 0},
        {"Lprecip depth (mm)", WEATHER_RAIN_MM_H, 0, 9999, 1, 0, -9900, 0},
        {"Lprecip quantity (hr)", field_rain_h, 0, 99, 1, 0, -9900, 0},
    };
    enum { fields = sizeof field / sizeof *field };

    r->rows->format = "TMY3";
    if (!split(r, next_line(r))) return STATUS_BAD_VALUE;
    Status status = station_of(r, 1, 4, 5, 3);
    if (status != STATUS_OK) return status;
    if (!next_row(r, false, &status)) return status;
    status = find_columns(r, field, fields, NULL);
    if (status != STATUS_OK) return status;
    const int date_at = column_called(r, tmy3_date), time_at = column_called(r, tmy3_time), columns = r->cells;
    if (field[0].cell < 0 || time_at < 0) {
        log_error("weather: %s:%d: a TMY3 file has the columns '%s' and '%s'", r->path, r->line, tmy3_time,
                  field[0].name);
        return STATUS_BAD_VALUE;
    }
    while (next_row(r, false, &status)) {
        int  month = 0, day = 0, year = 0, hour = 0, minute = 0, date_end = 0, time_end = 0;
        char date[64];
        if (!row_is_as_wide(r, columns)) return STATUS_BAD_VALUE;
        const char *d = cell_text(r, date_at), *t = cell_text(r, time_at);
        snprintf(date, sizeof date, "%s %s", d, t);
        if (sscanf(d, "%2d/%2d/%4d%n", &month, &day, &year, &date_end) != 3 || d[date_end] ||
            sscanf(t, "%2d:%2d%n", &hour, &minute, &time_end) != 2 || t[time_end] || minute != 0)
            month = 0; /* such a date does not exist */
        status = add_row_of_year(r, date, month, day, hour, field, fields);
        if (status != STATUS_OK) return status;
    }
    return status;
}

/* ---- our own ------------------------------------------------------------------------------ */

static Status read_plain(Reader *r)
{
    Field field[] = {
        {"air_temp_c", WEATHER_AIR_K, -53.15, 56.85, 1, 273.15, 0, 0},
        {"air_temp_k", WEATHER_AIR_K, 220, 330, 1, 0, 0, 0},
        {"humidity_pct", WEATHER_HUMIDITY, 0, 110, 0.01, 0, 0, 0},
        {"pressure_hpa", WEATHER_PRESSURE_MBAR, 300, 1100, 1, 0, 0, 0},
        {"wind_mps", WEATHER_WIND_MPS, 0, 60, 1, 0, 0, 0},
        {"wind_from_deg", WEATHER_WIND_FROM_RAD, 0, 360, rad_per_deg, 0, 0, 0},
        {"direct_w_m2", WEATHER_DIRECT, -20, 1500, 1, 0, 0, 0},
        {"diffuse_w_m2", WEATHER_DIFFUSE, -20, 1500, 1, 0, 0, 0},
        {"longwave_w_m2", WEATHER_LONGWAVE, 0, 1000, 1, 0, 0, 0},
        {"rain_mm_h", WEATHER_RAIN_MM_H, 0, 300, 1, 0, 0, 0},
        {"cloud", WEATHER_CLOUD, 0, 1, 1, 0, 0, 0},
        {"visibility_m", WEATHER_VISIBILITY_M, 100, 300000, 1, 0, 0, 0},
    };
    static const char *const times[] = {"time_utc", "unix_s", NULL};
    static const double      first_s = -2208988800, last_s = 4133980799; /* 1900 .. 2100 */
    enum { fields = sizeof field / sizeof *field };

    r->rows->format = "CSV";
    Status status;
    if (!next_row(r, true, &status)) {
        if (status == STATUS_OK) log_error("weather: %s: no header line", r->path);
        return STATUS_BAD_VALUE;
    }
    status = find_columns(r, field, fields, times);
    if (status != STATUS_OK) return status;
    const int utc_at = column_called(r, times[0]), unix_at = column_called(r, times[1]), columns = r->cells;
    if ((utc_at < 0) == (unix_at < 0) || (field[0].cell < 0) == (field[1].cell < 0)) {
        log_error("weather: %s:%d: one of the columns time_utc and unix_s is needed, and one of air_temp_c and "
                  "air_temp_k",
                  r->path, r->line);
        return STATUS_BAD_VALUE;
    }
    while (next_row(r, true, &status)) {
        double time_s, value[field_count];
        if (!row_is_as_wide(r, columns)) return STATUS_BAD_VALUE;
        if (unix_at >= 0) {
            status = number_of(&time_s, r, times[1], unix_at, first_s, last_s);
        } else if (!text_to_unix_s(&time_s, cell_text(r, utc_at))) {
            log_error("weather: %s:%d: column time_utc: '%.80s' is no time like 2016-01-01T00:30:00Z in 1900 .. 2100",
                      r->path, r->line, cell_text(r, utc_at));
            status = STATUS_BAD_VALUE;
        }
        if (status == STATUS_OK) status = fields_of(value, r, field, fields);
        if (status != STATUS_OK) return status;
        finish_fields(value);
        status = add_row(r, time_s, value);
        if (status != STATUS_OK) return status;
    }
    return status;
}

/* ---- any of them ---------------------------------------------------------------------------- */

static Status allocate(WeatherRows *rows, int capacity)
{
    rows->time_s = calloc((size_t)capacity, sizeof *rows->time_s);
    bool ok = rows->time_s != NULL;
    for (int c = 0; c < weather_columns; c++) {
        rows->value[c] = calloc((size_t)capacity, sizeof **rows->value);
        ok = ok && rows->value[c];
    }
    return ok ? STATUS_OK : STATUS_NO_MEMORY;
}

/* Frees the columns for which no row has a value. */
static void drop_empty(WeatherRows *rows)
{
    for (int c = 0; c < weather_columns; c++) {
        int i = 0;
        while (i < rows->count && isnan(rows->value[c][i])) i++;
        if (i < rows->count) continue;
        free(rows->value[c]);
        rows->value[c] = NULL;
    }
}

void weather_rows_close(WeatherRows *rows)
{
    free(rows->time_s);
    for (int c = 0; c < weather_columns; c++) free(rows->value[c]);
    memset(rows, 0, sizeof *rows);
}

Status weather_file_read(WeatherRows *out, const char *path)
{
    char  *text;
    size_t octets;
    Status status = text_read_file(&text, &octets, "weather", path, most_octets);
    if (status != STATUS_OK) return status;

    WeatherRows rows = {.latitude_rad = NAN, .longitude_rad = NAN};
    Reader      r = {.path = path, .next = text, .rows = &rows};
    if (strlen(text) != octets) {
        log_error("weather: %s: holds a NUL octet; is it a text file?", path);
        status = STATUS_BAD_VALUE;
        goto fail;
    }
    int lines = 1;
    for (const char *c = text; *c && lines < most_rows; c++) lines += *c == '\n';
    r.capacity = lines;
    status = allocate(&rows, lines);
    if (status != STATUS_OK) goto fail;

    if (strncmp(r.next, "\xEF\xBB\xBF", 3) == 0) r.next += 3;
    const char *second = strchr(r.next, '\n');
    if (strncasecmp(r.next, "LOCATION,", 9) == 0) status = read_epw(&r);
    else if (second && strncmp(second + 1, tmy3_date, sizeof tmy3_date - 1) == 0) status = read_tmy3(&r);
    else status = read_plain(&r);
    if (status != STATUS_OK) goto fail;

    drop_empty(&rows);
    if (!rows.value[WEATHER_AIR_K]) {
        log_error("weather: %s: no row has an air temperature", path);
        status = STATUS_BAD_VALUE;
        goto fail;
    }
    free(text);
    *out = rows;
    return STATUS_OK;

fail:
    free(text);
    weather_rows_close(&rows);
    return status;
}
