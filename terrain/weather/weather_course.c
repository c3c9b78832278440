/* terrain/weather/weather_course.c: weather at a time: a clear day's course, or rows of a file and what lies between.
 */
#include "terrain/weather/weather_private.h"

#include <stdlib.h>
#include <time.h>

typedef enum CourseKind { COURSE_CONSTANT, COURSE_CLEAR, COURSE_ROWS } CourseKind;

struct WeatherCourse {
    CourseKind          kind;
    WeatherCourseConfig config;
    double              vapour_pa; /* vapour pressure of a clear day */
    WeatherRows         rows;
    char                about[640];
};

static const double radiation_gap_s = 3 * 3600; /* longer gaps in radiation are not filled */

/* ---- clear day: times of the sun ------------------------------------------------------------ */

/* Solar noon, Unix time, and length of the day, of the sun's centre without refraction, 0 .. 24 h, on the given day of
 * local mean solar time. Source: Astronomical Almanac, page C5, "Low precision formulas for the Sun's coordinates",
 * 0.01 degree in 1950 .. 2050: noon within 3 s, sunrise within half a minute but near polar day and night. */
static void noon_of(double *noon_s, double *length_h, const WeatherCourseConfig *config, double day)
{
    const double mean_noon_s = (day + 0.5 - config->longitude_rad / (2 * pi_rad)) * weather_day_s;
    const double n = (mean_noon_s - 946728000) / weather_day_s; /* days from 2000-01-01T12 */
    const double mean_rad = (280.460 + 0.9856474 * n) * rad_per_deg, g = (357.528 + 0.9856003 * n) * rad_per_deg;
    const double lambda = mean_rad + (1.915 * sin(g) + 0.020 * sin(2 * g)) * rad_per_deg;
    const double epsilon = (23.439 - 0.0000004 * n) * rad_per_deg;
    const double alpha = atan2(cos(epsilon) * sin(lambda), cos(lambda));
    const double sin_delta = sin(epsilon) * sin(lambda), cos_delta = sqrt(1 - sin_delta * sin_delta);
    const double time_equation_rad = remainder(mean_rad - alpha, 2 * pi_rad);
    *noon_s = mean_noon_s - time_equation_rad / (2 * pi_rad) * weather_day_s;
    /* cos H = -tan(latitude) tan(declination), computed without a division by 0 at the poles */
    const double top = -sin(config->latitude_rad) * sin_delta, bottom = cos(config->latitude_rad) * cos_delta;
    *length_h = top >= bottom ? 0 : top <= -bottom ? 24 : acos(top / bottom) * 24 / pi_rad;
}

/* ---- clear day: Parton & Logan -------------------------------------------------------------- */

static const double lag_max_h = 1.86, lag_min_h = -0.17,
                    night_decay = 2.20; /* the paper's a, c and b for air at 150 cm */

/* One day's course, from its minimum to that of the next day. */
typedef struct Cycle {
    double min_s;    /* Unix time of the minimum */
    double day_h;    /* time from the minimum to sunset */
    double period_h; /* half a period of the sine */
    double range;    /* share of the nominal range: 1; less towards polar night and within 5 degrees of a pole */
} Cycle;

static Cycle cycle_of(const WeatherCourseConfig *config, double day)
{
    double noon_s, length_h;
    noon_of(&noon_s, &length_h, config, day);
    const double shape_h = clamp(length_h, 4, 20);
    return (Cycle){.min_s = noon_s + (lag_min_h - shape_h / 2) * 3600,
                   .day_h = shape_h - lag_min_h,
                   .period_h = shape_h + 2 * (lag_max_h - lag_min_h),
                   .range =
                       fmin(1, length_h / 4) * fmin(1, (pi_rad / 2 - fabs(config->latitude_rad)) / (5 * rad_per_deg))};
}

/* Mean of a cycle above its minimum, as a share of the nominal range. night_h: time from sunset to the next minimum. */
static double cycle_mean(const Cycle *c, double night_h)
{
    const double end = sin(pi_rad * c->day_h / c->period_h), left = exp(-night_decay);
    const double by_day = c->period_h / pi_rad * (1 - cos(pi_rad * c->day_h / c->period_h));
    const double by_night = night_h * end * ((1 - left) / night_decay - left) / (1 - left);
    return c->range * (by_day + by_night) / (c->day_h + night_h);
}

/* Share of the nominal range by which the air is above its daily mean, -1 .. 1. */
static double clear_share(const WeatherCourseConfig *config, double unix_s)
{
    const double lon_s = config->longitude_rad / (2 * pi_rad) * weather_day_s;
    double       day = floor((unix_s + lon_s) / weather_day_s);
    Cycle        c[4]; /* cycles of yesterday, today, and the two days after */
    c[1] = cycle_of(config, day);
    if (unix_s < c[1].min_s) c[1] = cycle_of(config, --day);
    for (int i = 0; i < 4; i++)
        if (i != 1) c[i] = cycle_of(config, day + i - 1);

    double mean[3];
    for (int i = 0; i < 3; i++) mean[i] = cycle_mean(&c[i], (c[i + 1].min_s - c[i].min_s) / 3600 - c[i].day_h);
    /* the mean changes from day to day: at a minimum it is that of both days, or the course would step there; 6 u (1 -
     * u) has a mean of 1, so that the whole cycle's is still its own */
    const double u = (unix_s - c[1].min_s) / (c[2].min_s - c[1].min_s);
    const double at_min = 0.5 * (mean[0] + mean[1]), at_next = 0.5 * (mean[1] + mean[2]);
    const double mean_here = (1 - u) * at_min + u * at_next + 6 * u * (1 - u) * (mean[1] - 0.5 * (at_min + at_next));

    const double since_h = (unix_s - c[1].min_s) / 3600;
    double       above;
    if (since_h < c[1].day_h) {
        above = sin(pi_rad * since_h / c[1].period_h);
    } else { /* displaced so that it reaches 0 at the next minimum; in the paper it ends 1/9 of the way above that */
        const double night_h = (c[2].min_s - c[1].min_s) / 3600 - c[1].day_h, left = exp(-night_decay);
        above = sin(pi_rad * c[1].day_h / c[1].period_h) *
                (exp(-night_decay * (since_h - c[1].day_h) / night_h) - left) / (1 - left);
    }
    return c[1].range * above - mean_here;
}

/* ---- rows: between and beyond them ---------------------------------------------------------- */

/* Second of a year of 365 days; 29 February is the 28th. Source: Hinnant, "chrono-compatible low-level date
 * algorithms": years from March, in eras of 400. */
static double second_of_year(double local_s)
{
    const long long days = (long long)floor(local_s / weather_day_s), d = days - 11017; /* from 2000-03-01 */
    const long long era = (d >= 0 ? d : d - 146096) / 146097, of_era = d - era * 146097;
    const long long year = (of_era - of_era / 1460 + of_era / 36524 - of_era / 146096) / 365;
    long long       day = of_era - (365 * year + year / 4 - year / 100); /* 0: 1 March, 364: 28 February */
    if (day > 364) day = 364;
    return (double)((day + 59) % 365) * weather_day_s + (local_s - (double)days * weather_day_s);
}

/* The two rows that a time lies between. */
typedef struct Between {
    int    a, b;  /* rows */
    double u;     /* 0: at a, 1: at b */
    double gap_s; /* time from a to b */
} Between;

static Between between(const WeatherRows *rows, double unix_s)
{
    const double *time_s = rows->time_s;
    const int     last = rows->count - 1;
    const double  first_s = time_s[0], last_s = time_s[last];
    double        t_s = unix_s;
    if (rows->each_year) {
        t_s = second_of_year(unix_s + rows->utc_offset_s);
    } else if (last_s - first_s >= weather_day_s) { /* repeats the first or the last 24 h of the file */
        if (t_s < first_s) t_s = first_s + (t_s - first_s - weather_day_s * floor((t_s - first_s) / weather_day_s));
        if (t_s > last_s) t_s = last_s + (t_s - last_s - weather_day_s * ceil((t_s - last_s) / weather_day_s));
    } else {
        t_s = clamp(t_s, first_s, last_s);
    }

    int low = -1, high = last; /* the last row not after t_s */
    while (low < high) {
        const int middle = low + (high - low + 1) / 2;
        if (time_s[middle] <= t_s) low = middle;
        else high = middle - 1;
    }
    Between at = {low, low + 1, 0, 0};
    if (low >= 0 && (time_s[low] == t_s || (low == last && !rows->each_year))) {
        at.b = low;
        return at;
    }
    if (low < 0 && !rows->each_year) return (Between){0, 0, 0, 0};
    const double a_s = low < 0 ? last_s - weather_year_s : time_s[low];
    const double b_s = low == last ? first_s + weather_year_s : time_s[low + 1];
    if (low < 0) at.a = last;
    if (low == last) at.b = 0;
    at.gap_s = b_s - a_s;
    at.u = (t_s - a_s) / at.gap_s;
    return at;
}

static bool is_radiation(int column)
{
    return column == WEATHER_DIRECT || column == WEATHER_DIFFUSE || column == WEATHER_LONGWAVE;
}

static bool is_mean(int column) { return is_radiation(column) || column == WEATHER_RAIN_MM_H; }

static double mix(int column, double a, double b, double u)
{
    if (column != WEATHER_WIND_FROM_RAD) return a + u * (b - a);
    const double turned = a + u * remainder(b - a, 2 * pi_rad); /* turns the short way round */
    return turned - 2 * pi_rad * floor(turned / (2 * pi_rad));
}

static double value_at(const WeatherRows *rows, int column, const Between *at)
{
    const double *value = rows->value[column];
    if (at->a == at->b) return value[at->a];
    if (is_radiation(column) && at->gap_s > radiation_gap_s) return NAN;
    return mix(column, value[at->a], value[at->b], at->u);
}

/* Fills rows without a value between rows a and b, which have one; b may lie beyond the last row, in the next year. */
static void fill_run(WeatherRows *rows, int column, int a, int b)
{
    double      *value = rows->value[column];
    const int    n = rows->count;
    const double a_s = rows->time_s[a], gap_s = rows->time_s[b % n] + (b >= n ? weather_year_s : 0) - a_s;
    if (is_radiation(column) && gap_s > radiation_gap_s) return;
    for (int i = a + 1; i < b; i++) {
        const double t_s = rows->time_s[i % n] + (i >= n ? weather_year_s : 0);
        value[i % n] = mix(column, value[a], value[b % n], (t_s - a_s) / gap_s);
    }
}

/* Fills in values that are not given, linear between those that are; gaps in radiation only up to 3 h. */
static void fill_gaps(WeatherRows *rows, int column)
{
    double *value = rows->value[column];
    int     first = -1, before = -1;
    for (int i = 0; i < rows->count; i++) {
        if (isnan(value[i])) continue;
        if (before >= 0 && i > before + 1) fill_run(rows, column, before, i);
        if (first < 0) first = i;
        before = i;
    }
    if (rows->each_year) {
        if (rows->count > 1 && before + 1 < first + rows->count) fill_run(rows, column, before, first + rows->count);
    } else if (!is_radiation(column)) {
        for (int i = 0; i < first; i++) value[i] = value[first];
        for (int i = before + 1; i < rows->count; i++) value[i] = value[before];
    }
}

static void rows_at(Weather *w, const WeatherRows *rows, double unix_s)
{
    /* a mean over the time before the row counts for the middle of that time */
    const Between at = between(rows, unix_s);
    const Between at_mean = rows->mean_s > 0 ? between(rows, unix_s + 0.5 * rows->mean_s) : at;
    double *const out[weather_columns] = {
        [WEATHER_AIR_K] = &w->air_temp_k,
        [WEATHER_HUMIDITY] = &w->humidity,
        [WEATHER_PRESSURE_MBAR] = &w->pressure_mbar,
        [WEATHER_WIND_MPS] = &w->wind_mps,
        [WEATHER_WIND_FROM_RAD] = &w->wind_from_rad,
        [WEATHER_CLOUD] = &w->cloud,
        [WEATHER_VISIBILITY_M] = &w->visibility_m,
        [WEATHER_RAIN_MM_H] = &w->rain_mm_h,
        [WEATHER_DIRECT] = &w->direct_w_m2,
        [WEATHER_DIFFUSE] = &w->diffuse_w_m2,
        [WEATHER_LONGWAVE] = &w->longwave_w_m2,
    };
    for (int c = 0; c < weather_columns; c++)
        if (rows->value[c]) *out[c] = value_at(rows, c, is_mean(c) ? &at_mean : &at);
}

void weather_at(Weather *out, const WeatherCourse *course, double unix_s)
{
    const WeatherCourseConfig *config = &course->config;
    const double               t_s = isfinite(unix_s) ? clamp(unix_s, -1e12, 1e12) : 0;
    Weather                    w = config->base;
    if (course->kind == COURSE_ROWS) {
        rows_at(&w, &course->rows, t_s);
    } else if (course->kind == COURSE_CLEAR) {
        w.air_temp_k = clamp(w.air_temp_k + config->air_range_k * clear_share(config, t_s), 220, 330);
        w.humidity = fmin(1, course->vapour_pa / weather_saturation_pa(w.air_temp_k));
    }
    *out = w;
}

/* ---- open and close ------------------------------------------------------------------------- */

static Status check_config(const WeatherCourseConfig *config)
{
    const Weather *b = &config->base;
    const struct {
        const char *name;
        double      value, low, high;
    } limit[] = {
        {"air_temp_k", b->air_temp_k, 220, 330},
        {"visibility_m", b->visibility_m, 100, 300000},
        {"pressure_mbar", b->pressure_mbar, 300, 1100},
        {"wind_mps", b->wind_mps, 0, 60},
        {"wind_from_rad", b->wind_from_rad, -2 * pi_rad, 2 * pi_rad},
        {"humidity", b->humidity, 0, 1},
        {"cloud", b->cloud, 0, 1},
        {"rain_mm_h", b->rain_mm_h, 0, 300},
        {"air_range_k", config->air_range_k, 0, 60},
        {"longitude_rad", config->longitude_rad, -2 * pi_rad, 2 * pi_rad},
        {"latitude_rad", config->latitude_rad, -pi_rad / 2, pi_rad / 2},
    };
    for (size_t i = 0; i < sizeof limit / sizeof *limit; i++)
        if (!(limit[i].value >= limit[i].low && limit[i].value <= limit[i].high)) {
            log_error("weather: %s: %g is not in %g .. %g", limit[i].name, limit[i].value, limit[i].low, limit[i].high);
            return STATUS_BAD_VALUE;
        }
    return STATUS_OK;
}

static void utc_text(char out[32], double unix_s)
{
    const time_t at = (time_t)floor(unix_s);
    struct tm    parts;
    if (!gmtime_r(&at, &parts) || !strftime(out, 32, "%Y-%m-%dT%H:%M:%SZ", &parts)) snprintf(out, 32, "?");
}

static void year_text(char out[32], double second)
{
    char whole[32];
    utc_text(whole, 365 * weather_day_s + second); /* 1971, a year of 365 days */
    snprintf(out, 32, "%.5s %.5s", whole + 5, whole + 11);
}

/* Great-circle distance on a sphere of 6371 km (haversine). */
static double distance_km(double lat_a, double lon_a, double lat_b, double lon_b)
{
    const double s = sin((lat_b - lat_a) / 2), o = sin((lon_b - lon_a) / 2);
    return 2 * 6371 * asin(fmin(1, sqrt(s * s + cos(lat_a) * cos(lat_b) * o * o)));
}

static const char *const column_name[weather_columns] = {"air temperature", "humidity", "pressure",   "wind speed",
                                                         "wind direction",  "cloud",    "visibility", "rain",
                                                         "direct",          "diffuse",  "longwave"};

static void describe_rows(WeatherCourse *course, const char *path)
{
    const WeatherRows *rows = &course->rows;
    char              *about = course->about;
    const size_t       size = sizeof course->about;
    const double       first_s = rows->time_s[0], last_s = rows->time_s[rows->count - 1];
    char               from[32], to[32], name[192];
    text_show(name, sizeof name, path, false);
    if (rows->each_year) {
        year_text(from, first_s);
        year_text(to, last_s);
        snprintf(about, size, "%s: %s of %s, UTC%+g h: %d rows from %s to %s, repeated each year", name, rows->format,
                 *rows->place ? rows->place : "an unnamed station", rows->utc_offset_s / 3600, rows->count, from, to);
    } else {
        utc_text(from, first_s);
        utc_text(to, last_s);
        snprintf(about, size, "%s: %s: %d rows from %s to %s, %s", name, rows->format, rows->count, from, to,
                 last_s - first_s >= weather_day_s ? "before them the first 24 h repeated, after them the last"
                                                   : "the first and the last hold beyond them");
    }
    if (rows->leap_rows > 0)
        snprintf(about + strlen(about), size - strlen(about), "; %d rows of 29 February left out", rows->leap_rows);
    if (isfinite(rows->latitude_rad)) {
        const double km = distance_km(course->config.latitude_rad, course->config.longitude_rad, rows->latitude_rad,
                                      rows->longitude_rad);
        snprintf(about + strlen(about), size - strlen(about), "; %.0f km away", km);
        if (km > 100)
            log_warn("weather: %s: its station is %.0f km from the terrain: its radiation follows another sun", path,
                     km);
    }
    const char *before = "; not in the file: ";
    for (int c = 0; c < weather_columns; c++)
        if (!rows->value[c]) {
            snprintf(about + strlen(about), size - strlen(about), "%s%s", before, column_name[c]);
            before = ", ";
        }
}

static void warn_of_gaps(const WeatherRows *rows, const char *path)
{
    double widest_s = rows->each_year ? rows->time_s[0] + weather_year_s - rows->time_s[rows->count - 1] : 0;
    for (int i = 1; i < rows->count; i++) widest_s = fmax(widest_s, rows->time_s[i] - rows->time_s[i - 1]);
    if (widest_s > radiation_gap_s)
        log_warn(
            "weather: %s: up to %.3g h without a row: air temperature is linear there, radiation is not taken from "
            "the file",
            path, widest_s / 3600);
}

static Status open_rows(WeatherCourse *course, const char *path)
{
    const Status status = weather_file_read(&course->rows, path);
    if (status != STATUS_OK) return status;
    course->kind = COURSE_ROWS;
    for (int c = 0; c < weather_columns; c++)
        if (course->rows.value[c]) fill_gaps(&course->rows, c);
    warn_of_gaps(&course->rows, path);
    describe_rows(course, path);
    return STATUS_OK;
}

Status weather_course_open(WeatherCourse **out, const char *day, const WeatherCourseConfig *config)
{
    Status status = check_config(config);
    if (status != STATUS_OK) return status;
    WeatherCourse *course = calloc(1, sizeof *course);
    if (!course) return STATUS_NO_MEMORY;
    course->config = *config;

    const Weather *base = &config->base;
    if (strcmp(day, "constant") == 0) {
        course->kind = COURSE_CONSTANT;
        snprintf(course->about, sizeof course->about, "constant: %.2f K at all times", base->air_temp_k);
    } else if (strcmp(day, "clear") == 0) {
        course->kind = COURSE_CLEAR;
        course->vapour_pa = base->humidity * weather_saturation_pa(base->air_temp_k);
        snprintf(course->about, sizeof course->about,
                 "clear day, every day: mean %.2f K, range %g K (Parton & Logan 1981), vapour pressure %.0f Pa",
                 base->air_temp_k, config->air_range_k, course->vapour_pa);
    } else {
        status = open_rows(course, day);
        if (status != STATUS_OK) goto fail;
    }
    *out = course;
    return STATUS_OK;

fail:
    weather_course_close(course);
    return status;
}

void weather_course_close(WeatherCourse *course)
{
    if (!course) return;
    weather_rows_close(&course->rows);
    free(course);
}

const char *weather_course_about(const WeatherCourse *course) { return course->about; }
