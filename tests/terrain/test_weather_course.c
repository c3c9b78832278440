/* Weather over time: values between rows by hand, typical years, spin-up, missing values, a clear day's course against
 * its definition and ERFA's sun, and refusal of bad rows. labels: physics */
#include "tests/check.h"

#include "terrain/earth/sun.h"
#include "terrain/weather/weather.h"

static const double day_s = 86400;
static const double new_year_2016_s = 1451606400; /* 2016-01-01T00:00:00Z, a leap year */

static WeatherCourseConfig config_of(double lat_deg, double lon_deg)
{
    WeatherCourseConfig c = {.base = weather_default(),
                             .air_range_k = 12,
                             .longitude_rad = lon_deg * rad_per_deg,
                             .latitude_rad = lat_deg * rad_per_deg};
    c.base.rain_mm_h = 0.5;
    return c;
}

/* From a text; closed by the caller. */
static WeatherCourse *course_of(const char *text, const WeatherCourseConfig *config)
{
    char           path[text_file_size];
    WeatherCourse *course = NULL;
    text_file(path, text);
    log_set_level(LOG_ERROR); /* of hours without rows, which most of these have */
    const Status status = weather_course_open(&course, path, config);
    log_set_level(LOG_WARN);
    remove(path);
    CHECK(status == STATUS_OK);
    return course;
}

static Weather at(const WeatherCourse *course, double unix_s)
{
    Weather w;
    weather_at(&w, course, unix_s);
    return w;
}

/* That it is refused, with all of these words in one logged line. */
static void refused_as(Status want, const char *text, const char *word, const char *other)
{
    const WeatherCourseConfig config = config_of(50, 10);
    char                      path[text_file_size];
    WeatherCourse            *course = NULL;
    text_file(path, text);
    *check_said = 0;
    log_set_sink(check_listen, NULL);
    const Status status = weather_course_open(&course, path, &config);
    log_set_sink(NULL, NULL);
    remove(path);
    if (status != want || course || !strstr(check_said, word) || !strstr(check_said, other) ||
        !strstr(check_said, path))
        fail_msg("%.300s: status %d, said: %s; want %s, %s", text, status, check_said, word, other);
}
static void refused(const char *text, const char *word, const char *other)
{
    refused_as(STATUS_BAD_VALUE, text, word, other);
}

/* ---- constant ------------------------------------------------------------------------------- */

static void constant_is_base(void **state)
{
    (void)state;
    const WeatherCourseConfig config = config_of(50, 10);
    WeatherCourse            *course;
    CHECK(weather_course_open(&course, "constant", &config) == STATUS_OK);
    const double times[] = {0, -1e9, 1.5e9, 1e300, NAN, INFINITY};
    for (size_t i = 0; i < sizeof times / sizeof *times; i++) {
        const Weather w = at(course, times[i]);
        CHECK(w.air_temp_k == 288.15 && w.humidity == 0.6 && w.rain_mm_h == 0.5 && isnan(w.direct_w_m2));
    }
    CHECK(strstr(weather_course_about(course), "constant"));
    weather_course_close(course);
    weather_course_close(NULL);
}

static void config_is_checked(void **state)
{
    (void)state;
    WeatherCourse *course = NULL;
    log_set_sink(check_listen, NULL);
    for (int i = 0; i < 8; i++) {
        WeatherCourseConfig c = config_of(50, 10);
        double *const       field[] = {&c.base.air_temp_k, &c.base.air_temp_k, &c.air_range_k, &c.latitude_rad,
                                       &c.longitude_rad,   &c.base.humidity,   &c.base.cloud,  &c.base.wind_mps};
        const double        bad[] = {NAN, 400, -1, 2, NAN, 1.01, NAN, -1};
        *field[i] = bad[i];
        *check_said = 0;
        CHECK(weather_course_open(&course, "clear", &c) == STATUS_BAD_VALUE && !course &&
              strstr(check_said, "is not in"));
    }
    const WeatherCourseConfig good = config_of(50, 10);
    CHECK(weather_course_open(&course, "/nonexistent/weather.epw", &good) == STATUS_IO && !course);
    CHECK(weather_course_open(&course, "", &good) != STATUS_OK && !course);
    log_set_sink(NULL, NULL);
}

/* ---- a clear day ------------------------------------------------------------------------------ */

/* 60 dates over 40 years, and ten latitudes: no step anywhere, the mean, the range, the times of its ends. */
static void clear_day(void **state)
{
    (void)state;
    static const double lats[] = {-90, -78, -66, -50, -20, 0, 35, 52, 69, 90};
    double              worst_mean_k = 0, worst_step_k = 0, worst_range_k = 0, worst_max_h = 0;
    for (int d = 0; d < 60; d++)
        for (size_t l = 0; l < sizeof lats / sizeof *lats; l++) {
            WeatherCourseConfig config = config_of(lats[l], -179 + 6.0 * d);
            config.air_range_k = 20;
            WeatherCourse *course;
            CHECK(weather_course_open(&course, "clear", &config) == STATUS_OK);
            const double from_s = 631152000 + day_s * floor(249.7 * d); /* 1990 .. 2030 */
            double       sum_k = 0, low_k = 1e9, high_k = 0, high_s = 0, before_k = at(course, from_s).air_temp_k;
            for (int minute = 1; minute <= 1440; minute++) {
                const Weather w = at(course, from_s + 60 * minute);
                CHECK(isfinite(w.air_temp_k) && w.humidity > 0 && w.humidity <= 1);
                worst_step_k = fmax(worst_step_k, fabs(w.air_temp_k - before_k));
                before_k = w.air_temp_k;
                sum_k += w.air_temp_k;
                low_k = fmin(low_k, w.air_temp_k);
                if (w.air_temp_k > high_k) {
                    high_k = w.air_temp_k;
                    high_s = from_s + 60 * minute;
                }
            }
            weather_course_close(course);
            CHECK(high_k - low_k <= (fabs(lats[l]) < 60 ? 20.05 : 20.8));
            /* a mean from midnight to midnight takes in two cycles, of unlike lengths where days change fast */
            const double off_k = fabs(sum_k / 1440 - 288.15);
            CHECK_NEAR(off_k, 0, fabs(lats[l]) < 60 ? 0.1 : 0.4);
            if (fabs(lats[l]) > 89) CHECK_NEAR(high_k - low_k, 0, 1e-9);
            if (fabs(lats[l]) > 60) continue;
            worst_mean_k = fmax(worst_mean_k, off_k);
            worst_range_k = fmax(worst_range_k, fabs(high_k - low_k - 20));
            /* 1.86 h after noon of local mean time; the equation of time is at most 0.275 h */
            const double local_h = fmod(high_s / 3600 + config.longitude_rad / rad_per_deg / 15 + 48, 24);
            worst_max_h = fmax(worst_max_h, fabs(local_h - 13.86));
        }
    printf("clear day: mean within %.3f K, range within %.3f K, maximum within %.2f h, steps of %.3f K a minute\n",
           worst_mean_k, worst_range_k, worst_max_h, worst_step_k);
    CHECK_NEAR(worst_range_k, 0, 0.05);
    CHECK_NEAR(worst_max_h, 0, 0.3);
    /* steepest: the decay after sunset, 2.2 of 20 K over a night of 3.8 h, 0.21 K/min */
    CHECK_NEAR(worst_step_k, 0, 0.25);
}

/* No step to the second at the minimum, at sunset and at midnight, found as places of the steepest change of slope. */
static void clear_day_has_no_step(void **state)
{
    (void)state;
    for (int l = -90; l <= 90; l += 15)
        for (int month = 0; month < 12; month++) {
            const WeatherCourseConfig config = config_of(l, 100);
            WeatherCourse            *course;
            CHECK(weather_course_open(&course, "clear", &config) == STATUS_OK);
            const double from_s = new_year_2016_s + month * 30.4 * day_s;
            double       before_k = at(course, from_s).air_temp_k;
            for (int s = 10; s <= 86400; s += 10) {
                const double k = at(course, from_s + s).air_temp_k;
                CHECK_NEAR(k, before_k, 0.03); /* 0.13 K/min at most with 12 K; a step of the mean would show at 0.01 */
                before_k = k;
            }
            weather_course_close(course);
        }
}

/* The minimum is 0.17 h before the sun's centre rises, by ERFA without refraction; the maximum 1.86 h after it is
 * highest. */
static void clear_day_follows_the_sun(void **state)
{
    (void)state;
    double worst_deg = 0;
    for (int d = 0; d < 24; d++) {
        const double              lat_deg = -55 + 110 * random_uniform(5, 0, 0, (uint64_t)d);
        const WeatherCourseConfig config = config_of(lat_deg, 23);
        const Geodetic            place = {lat_deg * rad_per_deg, 23 * rad_per_deg, 0};
        const double              from_s = new_year_2016_s + 101.3 * d * day_s;
        WeatherCourse            *course;
        CHECK(weather_course_open(&course, "clear", &config) == STATUS_OK);
        double low_k = 1e9, low_s = 0, high_k = 0, high_s = 0;
        for (double s = 0; s < day_s; s += 20) {
            const double k = at(course, from_s + s).air_temp_k;
            if (k < low_k) low_k = k, low_s = from_s + s;
            if (k > high_k) high_k = k, high_s = from_s + s;
        }
        weather_course_close(course);
        Sun sun, early, late;
        CHECK(sun_at(&sun, low_s + 0.17 * 3600, &place, 0, 15, NAN) == STATUS_OK);
        CHECK_NEAR(sun.elevation_rad / rad_per_deg, 0, 0.35); /* declination of noon: up to 0.4 degree a day */
        worst_deg = fmax(worst_deg, fabs(sun.elevation_rad / rad_per_deg));
        const double noon_s = high_s - 1.86 * 3600;
        CHECK(sun_at(&early, noon_s - 7200, &place, 0, 15, NAN) == STATUS_OK);
        CHECK(sun_at(&late, noon_s + 7200, &place, 0, 15, NAN) == STATUS_OK);
        CHECK_NEAR(early.elevation_rad / rad_per_deg, late.elevation_rad / rad_per_deg, 0.5); /* 2 minutes */
    }
    printf("sun at the minimum's sunrise: within %.2f degree\n", worst_deg);
}

static void polar_days(void **state)
{
    (void)state;
    const WeatherCourseConfig config = config_of(80, 0);
    WeatherCourse            *course;
    CHECK(weather_course_open(&course, "clear", &config) == STATUS_OK);
    const double winter_s = new_year_2016_s, summer_s = new_year_2016_s + 172 * day_s;
    double       low_k = 1e9, high_k = 0;
    for (double s = 0; s < day_s; s += 600) {
        CHECK_NEAR(at(course, winter_s + s).air_temp_k, 288.15, 1e-9);
        low_k = fmin(low_k, at(course, summer_s + s).air_temp_k);
        high_k = fmax(high_k, at(course, summer_s + s).air_temp_k);
    }
    CHECK_NEAR(high_k - low_k, 12, 0.05);
    weather_course_close(course);
}

/* The vapour pressure is constant: e_s(288.15) = 611 exp(17.502 15 / 255.97) = 1703.9 Pa, 0.6 of it 1022.4 Pa. */
static void clear_day_keeps_its_vapour(void **state)
{
    (void)state;
    const WeatherCourseConfig config = config_of(40, 0);
    WeatherCourse            *course;
    CHECK(weather_course_open(&course, "clear", &config) == STATUS_OK);
    for (double s = 0; s < day_s; s += 1800) {
        const Weather w = at(course, new_year_2016_s + s);
        const double  c = w.air_temp_k - 273.15;
        CHECK_NEAR(w.humidity * 611 * exp(17.502 * c / (240.97 + c)), 1022.4, 0.1);
        CHECK(w.wind_mps == 3);
    }
    weather_course_close(course);
}

/* ---- our own table ---------------------------------------------------------------------------- */

static void plain_values(void **state)
{
    (void)state;
    const WeatherCourseConfig config = config_of(50, 10);
    WeatherCourse            *course =
        course_of("\xEF\xBB\xBF# made by hand\n"
                  "time_utc,air_temp_c,humidity_pct,wind_from_deg,direct_w_m2,pressure_hpa,cloud\r\n"
                  "2016-01-01T00:00:00Z,10,50,350,100,1000,0\r\n"
                  "\n"
                  "2016-01-01T01:00:00Z,20,,30,200,,0.5\r\n"
                  "2016-01-01T02:00:00Z,30,70,,-2,,1\r\n"
                  "2016-01-01T06:00:00Z,10,110,150,400,900,1\r\n",
                  &config);
    const double t0 = new_year_2016_s;
    Weather      w = at(course, t0);
    CHECK_NEAR(w.air_temp_k, 283.15, 1e-12);
    CHECK_NEAR(w.direct_w_m2, 100, 0);
    w = at(course, t0 + 900);
    CHECK_NEAR(w.air_temp_k, 285.65, 1e-12);
    CHECK_NEAR(w.humidity, 0.525, 1e-12); /* 50 to 70 over two hours */
    CHECK_NEAR(fmod(w.wind_from_rad + pi_rad, 2 * pi_rad), pi_rad,
               1e-9); /* 350 to 30 through north, a quarter of the way */
    CHECK_NEAR(w.direct_w_m2, 125, 1e-12);
    CHECK_NEAR(w.pressure_mbar, 1000 - 100.0 / 24, 1e-9);
    CHECK_NEAR(w.cloud, 0.125, 1e-12);
    CHECK(w.rain_mm_h == 0.5 && w.wind_mps == 3 && isnan(w.diffuse_w_m2)); /* not in the file: the base's */
    w = at(course, t0 + 7200);
    CHECK_NEAR(w.direct_w_m2, 0, 0); /* an instrument's offset at night */
    CHECK_NEAR(w.wind_from_rad / rad_per_deg, 30 + 120 / 5.0, 1e-9);
    w = at(course, t0 + 4 * 3600);
    CHECK_NEAR(w.air_temp_k, 293.15, 1e-12);
    CHECK(isnan(w.direct_w_m2)); /* 4 h without a value */
    CHECK_NEAR(at(course, t0 + 6 * 3600).direct_w_m2, 400, 0);
    CHECK_NEAR(at(course, t0 + 6 * 3600).humidity, 1, 0);
    /* shorter than a day: the ends hold */
    CHECK_NEAR(at(course, t0 - 1e6).air_temp_k, 283.15, 1e-12);
    CHECK_NEAR(at(course, t0 + 1e9).air_temp_k, 283.15, 1e-12);
    CHECK_NEAR(at(course, t0 - 1e6).direct_w_m2, 100, 0);
    CHECK(strstr(weather_course_about(course), "4 rows from 2016-01-01T00:00:00Z to 2016-01-01T06:00:00Z"));
    CHECK(strstr(weather_course_about(course), "not in the file: wind speed, visibility, rain, diffuse, longwave"));
    weather_course_close(course);
}

/* 48 hourly rows: temperature is their number. */
static void plain_repeats_its_first_and_last_day(void **state)
{
    (void)state;
    const WeatherCourseConfig config = config_of(50, 10);
    char                      text[4096] = "unix_s,air_temp_k\n";
    for (int i = 0; i < 48; i++)
        snprintf(text + strlen(text), sizeof text - strlen(text), "%.0f,%d\n", new_year_2016_s + 3600.0 * i, 240 + i);
    WeatherCourse *course = course_of(text, &config);
    const double   t0 = new_year_2016_s, last = t0 + 47 * 3600;
    CHECK_NEAR(at(course, t0 + 5400).air_temp_k, 241.5, 1e-9);
    for (int days = 1; days < 400; days += 57) { /* spin-up */
        CHECK_NEAR(at(course, t0 - days * day_s).air_temp_k, 240, 1e-9);
        CHECK_NEAR(at(course, t0 - days * day_s + 5400).air_temp_k, 241.5, 1e-9);
        CHECK_NEAR(at(course, t0 - days * day_s + day_s - 1800).air_temp_k, 263.5, 1e-9);
        CHECK_NEAR(at(course, last + days * day_s).air_temp_k, 287, 1e-9);
        CHECK_NEAR(at(course, last + days * day_s - 7200).air_temp_k, 285, 1e-9);
        CHECK_NEAR(at(course, last + (days - 1) * day_s + 1800).air_temp_k, 263.5, 1e-9);
    }
    CHECK(strstr(weather_course_about(course), "first 24 h repeated"));
    weather_course_close(course);
}

static void plain_refusals(void **state)
{
    (void)state;
    refused("", "no header", "");
    refused("# nothing\n", "no header", "");
    refused("unix_s,air_temp_k\n", "no row has an air temperature", "");
    refused("unix_s,air_temp_k\n0,\n", "no row has an air temperature", "");
    refused("unix_s,wind_mps\n0,3\n", "air_temp_k", ":1:");
    refused("air_temp_k\n280\n", "time_utc and unix_s", ":1:");
    refused("unix_s,time_utc,air_temp_k\n", "time_utc and unix_s", ":1:");
    refused("unix_s,air_temp_k,air_temp_c\n", "air_temp_c", ":1:");
    refused("unix_s,air_temp_k,air_temp_k\n", "given twice", ":1:");
    refused("unix_s,air_temp_f\n0,50\n", "no such column: 'air_temp_f'", "humidity_pct");
    refused("unix_s,air_temp_k\n0,280\n0,281\n", ":3:", "not after");
    refused("unix_s,air_temp_k\n60,280\n0,281\n", ":3:", "not after");
    refused("unix_s,air_temp_k\n0,400\n", ":2: column air_temp_k: '400'", "220 .. 330");
    refused("unix_s,air_temp_k\n0,nan\n", "'nan'", "220 .. 330");
    refused("unix_s,air_temp_k\n0,280K\n", "'280K'", "220 .. 330");
    refused("unix_s,air_temp_k\n1e12,280\n", ":2: column unix_s: '1e12'", " .. ");
    refused("unix_s,air_temp_k\n,280\n", ":2: column unix_s: ''", " .. ");
    refused("time_utc,air_temp_k\n2016-02-30T00:00:00Z,280\n", ":2: column time_utc", "2016-01-01T00:30:00Z");
    refused("unix_s,air_temp_k\n0,280,1\n", ":2: 3 columns where the header has 2", "");
    refused("unix_s,air_temp_k\n0,\"280\n", ":2: a quote is not closed", "");
    refused("unix_s,air_temp_k,humidity_pct\n0,280,111\n", "column humidity_pct: '111'", "0 .. 110");
    refused("unix_s,air_temp_k,cloud\n0,280,5\n", "column cloud: '5'", "0 .. 1");
    refused("unix_s,air_temp_k,direct_w_m2\n0,280,1501\n", "column direct_w_m2", "-20 .. 1500");

    /* a NUL octet, which text_file cannot write */
    const WeatherCourseConfig config = config_of(50, 10);
    static const char         nul[] = "unix_s,air_temp_k\n0,280\0\n";
    char                      path[text_file_size];
    WeatherCourse            *course = NULL;
    text_file(path, "");
    FILE *file = fopen(path, "wb");
    CHECK(file && fwrite(nul, 1, sizeof nul - 1, file) == sizeof nul - 1 && fclose(file) == 0);
    log_set_sink(check_listen, NULL);
    CHECK(weather_course_open(&course, path, &config) == STATUS_BAD_VALUE && !course && strstr(check_said, "NUL"));
    log_set_sink(NULL, NULL);
    remove(path);
}

/* One row more than a million; one less is accepted. */
static void a_million_rows(void **state)
{
    (void)state;
    const WeatherCourseConfig config = config_of(50, 10);
    for (int rows = 1000000; rows <= 1000001; rows++) {
        char           path[text_file_size];
        WeatherCourse *course = NULL;
        text_file(path, "");
        FILE *file = fopen(path, "wb");
        CHECK(file);
        fputs("unix_s,air_temp_k\n", file);
        for (int i = 0; i < rows; i++) fprintf(file, "%d,280\n", i);
        CHECK(fclose(file) == 0);
        log_set_sink(check_listen, NULL);
        const Status status = weather_course_open(&course, path, &config);
        log_set_sink(NULL, NULL);
        remove(path);
        CHECK(rows == 1000000 ? status == STATUS_OK : status == STATUS_BAD_VALUE && strstr(check_said, "1000000 rows"));
        weather_course_close(course);
    }
}

/* ---- EPW ---------------------------------------------------------------------------------- */

static const char epw_head[] = "LOCATION,\"Made, by hand\",-,DEU,none,000000,50.0,9.0,1.0,100\nDESIGN CONDITIONS,0\n"
                               "TYPICAL/EXTREME PERIODS,0\nGROUND TEMPERATURES,0\nHOLIDAYS/DAYLIGHT SAVINGS,No,0,0,0\n"
                               "COMMENTS 1,\"quotes are not ours to close\nCOMMENTS 2\n"
                               "DATA PERIODS,1,1,Data,Sunday, 1/ 1,12/31\n";

/* A row with these cells from its 6th to 9th, its radiation, and then wind direction, speed, cover and the rest. */
static void epw_row(char *text, size_t size, const char *date, const char *state4, const char *infrared,
                    const char *direct, const char *diffuse, const char *wind)
{
    snprintf(text + strlen(text), size - strlen(text),
             "1999,%s,60,?9?9?9?9E0,%s,9999,9999,%s,9999,%s,%s,999999,999999,999999,9999,%s\n", date, state4, infrared,
             direct, diffuse, wind);
}

/* 8760 rows: the temperature is a sawtooth of the hour, the day's number is in the direct radiation. */
static char *epw_year(void)
{
    const size_t size = 1 << 21;
    char        *text = calloc(1, size);
    CHECK(text != NULL);
    static const int days[12] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    size_t           n = (size_t)snprintf(text, size, "%s", epw_head);
    for (int m = 0, number = 0; m < 12; m++)
        for (int d = 1; d <= days[m]; d++, number++)
            for (int h = 1; h <= 24; h++)
                n +=
                    (size_t)snprintf(text + n, size - n,
                                     "%d,%d,%d,%d,0,?9,%d,5.0,80,100000,0,0,300,0,%d,%d,0,0,0,0,180,4.0,5,3,20.0,77777,"
                                     "9,999999999,999,0.999,999,99,999,2.0,4\n",
                                     1980 + m, m + 1, d, h, h, number, h);
    return text;
}

static void epw_repeats_each_year(void **state)
{
    (void)state;
    const WeatherCourseConfig config = config_of(50, 9);
    char                     *text = epw_year();
    WeatherCourse            *course = course_of(text, &config);
    free(text);
    const double tz_s = 3600;                        /* the file's time is UTC+1 */
    for (int years = -60; years <= 84; years += 4) { /* years since 2016, all leap but 2100: stay within 1956 .. 2099 */
        if (years > 80) continue;
        const double year_s = new_year_2016_s + (years * 365 + years / 4) * day_s - tz_s;
        CHECK_NEAR(at(course, year_s + 3600).air_temp_k, 274.15, 1e-9); /* hour 1 of 1 January ends */
        CHECK_NEAR(at(course, year_s + 3600 * 12.25).air_temp_k, 285.4, 1e-9);
        CHECK_NEAR(at(course, year_s).air_temp_k, 297.15, 1e-9); /* hour 24 of 31 December */
        CHECK_NEAR(at(course, year_s + 1800).air_temp_k, (297.15 + 274.15) / 2, 1e-9);
        /* means over the hour that ends at the row: in its middle */
        CHECK_NEAR(at(course, year_s + 1800).diffuse_w_m2, 1, 1e-9);
        CHECK_NEAR(at(course, year_s + 3600 * 12).diffuse_w_m2, 12.5, 1e-9);
        CHECK_NEAR(at(course, year_s + 3600 * 12).direct_w_m2, 0, 1e-9);
        CHECK_NEAR(at(course, year_s + 58.5 * day_s).direct_w_m2, 58, 1e-9);         /* 28 February */
        CHECK_NEAR(at(course, year_s + 59.5 * day_s).direct_w_m2, 58, 1e-9);         /* 29 February */
        CHECK_NEAR(at(course, year_s + 60.5 * day_s).direct_w_m2, 59, 1e-9);         /* 1 March */
        CHECK_NEAR(at(course, year_s + 365.5 * day_s).direct_w_m2, 364, 1e-9);       /* 31 December */
        CHECK_NEAR(at(course, year_s + 366.5 * day_s).direct_w_m2, 0, 1e-9);         /* 1 January of the next */
        CHECK_NEAR(at(course, year_s + (366 + 59.5) * day_s).direct_w_m2, 59, 1e-9); /* its 1 March */
    }
    CHECK_NEAR(at(course, 4107542400 - tz_s + 43200).direct_w_m2, 59, 1e-9); /* 2100-03-01: 2100 is no leap year */
    const Weather w = at(course, new_year_2016_s);
    CHECK_NEAR(w.humidity, 0.8, 1e-12);
    CHECK_NEAR(w.pressure_mbar, 1000, 1e-9);
    CHECK_NEAR(w.wind_from_rad, pi_rad, 1e-12);
    CHECK_NEAR(w.cloud, 0.5, 1e-12);
    CHECK_NEAR(w.visibility_m, 20000, 1e-9);
    CHECK_NEAR(w.rain_mm_h, 0.5, 1e-12); /* 2 mm in 4 h */
    CHECK_NEAR(w.longwave_w_m2, 300, 1e-9);
    CHECK(strstr(weather_course_about(course),
                 "EPW of Made, by hand, UTC+1 h: 8760 rows from 01-01 01:00 to 01-01 00:00"));
    CHECK(strstr(weather_course_about(course), "; 0 km away"));
    weather_course_close(course);
}

static void epw_missing_values(void **state)
{
    (void)state;
    const WeatherCourseConfig config = config_of(50, 9);
    char                      text[4096];
    snprintf(text, sizeof text, "%s", epw_head);
    epw_row(text, sizeof text, "1,1,1", "10.0,5.0,999,99999", "0", "9999", "50", "999,999,99,4,9999");
    epw_row(text, sizeof text, "1,1,2", "99.9,99.9,999,999999", "9999.", "99999", "9999", "90,2.0,99,6,777.7");
    epw_row(text, sizeof text, "1,1,3", "30.0,,50,999999", "310", "", "150", ",,,,");
    epw_row(text, sizeof text, "2,29,1", "30.0,,50,999999", "310", "", "150", ",,,,");
    WeatherCourse *course = course_of(text, &config);
    const double   t2 = new_year_2016_s - 3600 + 7200; /* hour 2 ends */
    const Weather  w = at(course, t2);
    CHECK_NEAR(w.air_temp_k, 293.15, 1e-9); /* between its neighbours */
    /* hour 1: by the dew point, e_s(5 C) / e_s(10 C) = 872.3 / 1227.6 = 0.7106; hour 3: 0.5 */
    CHECK_NEAR(w.humidity, (0.7106 + 0.5) / 2, 1e-4);
    CHECK_NEAR(w.pressure_mbar, 999.99, 1e-9);
    CHECK_NEAR(w.wind_from_rad, pi_rad / 2, 1e-9);
    CHECK_NEAR(w.cloud, 0.6, 1e-12);                           /* opaque cover where the total is missing */
    CHECK_NEAR(w.visibility_m, 300000, 0);                     /* 777.7: unlimited */
    CHECK(w.rain_mm_h == 0.5 && isnan(w.direct_w_m2));         /* in no row: the base's */
    CHECK_NEAR(at(course, t2 - 1800).diffuse_w_m2, 100, 1e-9); /* 2 h without: bridged */
    CHECK_NEAR(at(course, t2 + 1800).longwave_w_m2, 310, 0);
    CHECK(isnan(at(course, t2 + 1801).longwave_w_m2)); /* none for the rest of the year */
    CHECK(isnan(at(course, t2 + 1e6).diffuse_w_m2));
    CHECK(isfinite(at(course, t2 + 1e6).air_temp_k));
    CHECK(strstr(weather_course_about(course), "1 rows of 29 February left out"));
    weather_course_close(course);
}

static void epw_refusals(void **state)
{
    (void)state;
    static const struct {
        const char *date, *state4, *wind, *word, *other;
    } bad[] = {
        {"13,1,1", "10,5,50,100000", "0,1,0,0,9", ":9: column month: '13'", "1 .. 12"},
        {"1.5,1,1", "10,5,50,100000", "0,1,0,0,9", ":9: '1.5, 1, 1'", "month"},
        {"4,31,1", "10,5,50,100000", "0,1,0,0,9", ":9: '4, 31, 1'", "day"},
        {"1,1,0", "10,5,50,100000", "0,1,0,0,9", ":9: column hour: '0'", "1 .. 24"},
        {"1,1,25", "10,5,50,100000", "0,1,0,0,9", ":9: column hour: '25'", "1 .. 24"},
        {"1,1,1", "60,5,50,100000", "0,1,0,0,9", ":9: column dry bulb temperature: '60'", "-53.15 .. 56.85"},
        {"1,1,1", "ten,5,50,100000", "0,1,0,0,9", "'ten'", "-53.15 .. 56.85"},
        {"1,1,1", "10,5,150,100000", "0,1,0,0,9", "relative humidity: '150'", "0 .. 110"},
        {"1,1,1", "10,5,50,1013", "0,1,0,0,9", "pressure: '1013'", "30000 .. 110000"},
        {"1,1,1", "10,5,50,100000", "361,1,0,0,9", "wind direction: '361'", "0 .. 360"},
        {"1,1,1", "10,5,50,100000", "0,1,11,0,9", "total sky cover: '11'", "0 .. 10"},
        {"1,1,1", "10,5,50,100000", "0,-1,0,0,9", "wind speed: '-1'", "0 .. 60"},
        {"1,1,1", "99.9,5,50,100000", "0,1,0,0,9", "no row has an air temperature", ""},
    };
    char text[4096];
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        snprintf(text, sizeof text, "%s", epw_head);
        epw_row(text, sizeof text, bad[i].date, bad[i].state4, "300", "0", "0", bad[i].wind);
        refused(text, bad[i].word, bad[i].other);
    }
    snprintf(text, sizeof text, "%s", epw_head);
    for (int i = 0; i < 2; i++) epw_row(text, sizeof text, "1,1,1", "10,5,50,100000", "300", "0", "0", "0,1,0,0,9");
    refused(text, ":10:", "not after");
    snprintf(text, sizeof text, "%s1999,1,1,1,60\n", epw_head);
    refused(text, ":9: 5 columns", "35");
    refused(epw_head, "no row has an air temperature", "");
    refused("LOCATION,x\n", ":1: column latitude: ''", "-90 .. 90");
    refused("LOCATION,x,,,,,91,0,0\n", ":1: column latitude: '91'", "-90 .. 90");
    refused("LOCATION,x,,,,,50,0,0,0\n2\n3\n4\n5\n6\n7\n8\n", ":8:", "DATA PERIODS");
    refused("LOCATION,x,,,,,50,0,0,0\n2\n", "DATA PERIODS", "line 8");
    refused_as(STATUS_UNSUPPORTED,
               "LOCATION,x,,,,,50,0,0,0\n2\n3\n4\n5\n6\n7\nDATA PERIODS,1,4,Data,Sunday,1/1,12/31\n",
               ":8: 4 records per hour", "hourly");
}

/* ---- TMY3 --------------------------------------------------------------------------------- */

static const char tmy3_head[] =
    "000001,\"MADE BY HAND\",NC,-5.0,36.100,-79.950,273\n"
    "Date (MM/DD/YYYY),Time (HH:MM),DNI (W/m^2),DHI (W/m^2),TotCld (tenths),Dry-bulb (C),"
    "Dew-point (C),RHum (%),Pressure (mbar),Wdir (degrees),Wspd (m/s),Hvis (m),Alb (unitless),"
    "Lprecip depth (mm),Lprecip quantity (hr)\n";

static void tmy3_values(void **state)
{
    (void)state;
    const WeatherCourseConfig config = config_of(36, -80);
    char                      text[4096];
    snprintf(text, sizeof text, "%s%s", tmy3_head,
             "06/30/1988,24:00,0,0,10,20.0,10,55,985,350,3.0,16000,0.2,1,1\n"
             "07/01/1976,01:00,100,40,0,22.0,10,65,987,10,5.0,77777,-9900,3,1\n"
             "07/01/1976,02:00,-9900,-9900,0,24.0,10,-9900,987,10,5.0,-9900,-9900,-9900,-9900\n");
    WeatherCourse *course = course_of(text, &config);
    const double   midnight_s = new_year_2016_s + 182 * day_s + 5 * 3600; /* 2016-07-01, UTC-5 */
    Weather        w = at(course, midnight_s);
    CHECK_NEAR(w.air_temp_k, 293.15, 1e-9);
    CHECK_NEAR(w.direct_w_m2, 50, 1e-9); /* between the middles of the two hours */
    CHECK_NEAR(w.rain_mm_h, 2, 1e-9);
    w = at(course, midnight_s + 1800);
    CHECK_NEAR(w.air_temp_k, 294.15, 1e-9);
    CHECK_NEAR(w.humidity, 0.6, 1e-9);
    CHECK_NEAR(w.pressure_mbar, 986, 1e-9);
    CHECK_NEAR(w.direct_w_m2, 100, 1e-9);
    CHECK_NEAR(w.diffuse_w_m2, 40, 1e-9);
    CHECK_NEAR(w.cloud, 0.5, 1e-9);
    CHECK_NEAR(w.visibility_m, (16000 + 77777) / 2.0, 1e-9);
    CHECK_NEAR(fmod(w.wind_from_rad + pi_rad, 2 * pi_rad), pi_rad, 1e-9); /* through north */
    CHECK(isnan(w.longwave_w_m2) && isnan(at(course, midnight_s + 5400).direct_w_m2));
    CHECK(
        strstr(weather_course_about(course), "TMY3 of MADE BY HAND, UTC-5 h: 3 rows from 07-01 00:00 to 07-01 02:00"));
    weather_course_close(course);
}

static void tmy3_refusals(void **state)
{
    (void)state;
    static const char *const bad[][3] = {
        {"13/01/1988,01:00,0,0,10,20,10,55,985,0,3,16000,0.2,0,1\n", ":3: '13/01/1988 01:00'", "month"},
        {"01/01/1988,00:00,0,0,10,20,10,55,985,0,3,16000,0.2,0,1\n", ":3:", "hour 1 .. 24"},
        {"01/01/1988,01:30,0,0,10,20,10,55,985,0,3,16000,0.2,0,1\n", ":3:", "01:30"},
        {"1988-01-01,01:00,0,0,10,20,10,55,985,0,3,16000,0.2,0,1\n", ":3:", "1988-01-01"},
        {"01/01/1988,01:00,0,0,10,20,10,55,85,0,3,16000,0.2,0,1\n", "column Pressure (mbar): '85'", "300 .. 1100"},
        {"01/01/1988,01:00,0,0,10,20,10,55,985,0,3,16000,0.2,0\n", ":3: 14 columns where the header has 15", ""},
        {"01/01/1988,02:00,0,0,10,20,10,55,985,0,3,16000,0.2,0,1\n"
         "01/01/1988,01:00,0,0,10,20,10,55,985,0,3,16000,0.2,0,1\n",
         ":4:", "not after"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char text[4096];
        snprintf(text, sizeof text, "%s%s", tmy3_head, bad[i][0]);
        refused(text, bad[i][1], bad[i][2]);
    }
    refused("1,a,b,0,36,400\nDate (MM/DD/YYYY),Time (HH:MM),Dry-bulb (C)\n", ":1: column longitude: '400'",
            "-180 .. 180");
    refused("1,a,b,0,36,80\nDate (MM/DD/YYYY),Time,Dry-bulb (C)\n", ":2:", "Time (HH:MM)");
}

/* A station far from the terrain is said so: its radiation is of another sun. */
static void far_station_is_said(void **state)
{
    (void)state;
    const WeatherCourseConfig config = config_of(50, 20);
    char                      text[4096], path[text_file_size];
    WeatherCourse            *course;
    snprintf(text, sizeof text, "%s%s", tmy3_head, "06/30/1988,24:00,0,0,10,20.0,10,55,985,350,3.0,16000,0.2,1,1\n");
    text_file(path, text);
    *check_said = 0;
    log_set_sink(check_listen, NULL);
    CHECK(weather_course_open(&course, path, &config) == STATUS_OK);
    log_set_sink(NULL, NULL);
    remove(path);
    CHECK(strstr(check_said, "km from the terrain"));
    CHECK_NEAR(at(course, 1e9).air_temp_k, 293.15, 1e-9); /* one row is all year's */
    weather_course_close(course);
}

/* Saturated air holds 12.83 g/m3 at 15 degrees and 30.4 at 30 (Smithsonian Meteorological Tables, 6th edition, table
 * 108). */
static void vapour_density(void **state)
{
    (void)state;
    Weather w = weather_default();
    w.humidity = 1, w.air_temp_k = 288.15;
    CHECK_NEAR(weather_vapour_kg_m3(&w), 12.83e-3, 0.04e-3);
    w.air_temp_k = 303.15;
    CHECK_NEAR(weather_vapour_kg_m3(&w), 30.38e-3, 0.09e-3);
    w.humidity = 0.5;
    CHECK_NEAR(weather_vapour_kg_m3(&w), 15.19e-3, 0.045e-3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(vapour_density),
        cmocka_unit_test(constant_is_base),
        cmocka_unit_test(config_is_checked),
        cmocka_unit_test(clear_day),
        cmocka_unit_test(clear_day_has_no_step),
        cmocka_unit_test(clear_day_follows_the_sun),
        cmocka_unit_test(polar_days),
        cmocka_unit_test(clear_day_keeps_its_vapour),
        cmocka_unit_test(plain_values),
        cmocka_unit_test(plain_repeats_its_first_and_last_day),
        cmocka_unit_test(plain_refusals),
        cmocka_unit_test(a_million_rows),
        cmocka_unit_test(epw_repeats_each_year),
        cmocka_unit_test(epw_missing_values),
        cmocka_unit_test(epw_refusals),
        cmocka_unit_test(tmy3_values),
        cmocka_unit_test(tmy3_refusals),
        cmocka_unit_test(far_station_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
