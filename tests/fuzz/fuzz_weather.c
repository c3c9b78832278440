/* tests/fuzz/fuzz_weather.c: any octets as a weather file. Without a fuzzer run_corpus.c drives it. */
#include "tests/fuzz/fuzz_seed.h"

#include "terrain/weather/weather.h"

#include <stdlib.h>

const int fuzz_rounds = 60000;

/* One of each format, with something missing in it. */
size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    static const char *const seed[] = {
        "LOCATION,a,b,c,d,1,50,9,1,0\n2\n3\n4\n5\n6\n7\nDATA PERIODS,1,1,Data,Sunday,1/1,12/31\n"
        "1999,1,1,1,60,?9,10,5,80,100000,0,0,300,0,0,0,0,0,0,0,10,2,5,3,20,777,9,9,1,.1,0,1,.2,1,1\n"
        "1999,1,1,2,60,?9,99.9,5,999,999999,0,0,9999,0,10,20,0,0,0,0,350,2,99,3,9999,777,9,9,1,.1,0,1,.2,999,99\n"
        "1999,2,29,24,60,?9,12,5,80,100000,0,0,300,0,0,0,0,0,0,0,10,2,5,3,20\n"
        "1999,12,31,24,60,?9,12,5,80,100000,0,0,300,0,0,0\n",
        "1,\"a, b\",c,-5,36,-79,273\n"
        "Date (MM/DD/YYYY),Time (HH:MM),DNI (W/m^2),DHI (W/m^2),TotCld (tenths),Dry-bulb (C),RHum (%),Wdir (degrees)\n"
        "01/01/1988,01:00,0,0,10,20,55,350\n02/28/1977,24:00,100,-9900,5,-9900,55,10\n12/31/1980,24:00,0,50,0,22,5,0\n",
        "# ours\ntime_utc,air_temp_c,humidity_pct,pressure_hpa,wind_mps,wind_from_deg,direct_w_m2,longwave_w_m2,cloud\n"
        "2016-01-01T00:00:00Z,10,50,1000,3,350,100,300,0\n2016-01-01T12:00:00Z,,,,,10,,,1\n"
        "2016-01-02T06:00:00Z,12,60,990,4,190,-3,310,.5\n",
        "unix_s,air_temp_k,diffuse_w_m2,rain_mm_h,visibility_m\n0,280,10,0,100\n3600,,20,300,300000\n",
    };
    return fuzz_seed_text(out, seed[index % (sizeof seed / sizeof *seed)]);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    log_set_level((LogLevel)(LOG_ERROR + 1));
    char      path[fuzz_path_size];
    const int file = fuzz_file(path, data, size);
    if (file < 0) return 0;
    const WeatherCourseConfig config = {.base = weather_default(), .air_range_k = 10};
    WeatherCourse            *course;
    const Status              status = weather_course_open(&course, path, &config);
    close(file);
    if (status != STATUS_OK) return 0;
    if (!*weather_course_about(course)) abort();
    /* about the seeds' rows, leap days, far from them, and no time at all */
    static const double times[] = {0,      1,    1800,       3599,       3600,       5400,       86400,      -1,
                                   -86400, -1e5, 1451606400, 1451649600, 1451606399, 1456750800, 1456704000, 1483225200,
                                   1e9,    -3e9, 1e18,       -1e18,      NAN,        INFINITY};
    for (size_t i = 0; i < sizeof times / sizeof *times; i++) {
        Weather w, again;
        weather_at(&w, course, times[i]);
        weather_at(&again, course, times[i]);
        if (memcmp(&w, &again, sizeof w) != 0) abort();
        if (!(w.air_temp_k >= 219.99 && w.air_temp_k <= 330.01) || !(w.humidity >= 0 && w.humidity <= 1)) abort();
        if (!(w.pressure_mbar >= 299.99 && w.pressure_mbar <= 1100.01) || !(w.wind_mps >= 0 && w.wind_mps <= 60))
            abort();
        if (!(w.cloud >= 0 && w.cloud <= 1.0001) || !(w.rain_mm_h >= 0 && w.rain_mm_h <= 300)) abort();
        if (!(w.visibility_m >= 99.99 && w.visibility_m <= 300000.01) || !(fabs(w.wind_from_rad) <= 6.2832)) abort();
        const double radiation[] = {w.direct_w_m2, w.diffuse_w_m2, w.longwave_w_m2};
        for (int k = 0; k < 3; k++)
            if (!isnan(radiation[k]) && !(radiation[k] >= 0 && radiation[k] <= 1500)) abort();
    }
    weather_course_close(course);
    return 0;
}
