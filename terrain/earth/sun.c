/* terrain/earth/sun.c: the sun's apparent place.
 *
 * ERFA gives the Earth's orbit (epv00), precession and nutation (pnm06a) and sidereal time (gst06). Light
 * time and aberration are one step: the heliocentric Earth is taken one light time earlier (planetary
 * aberration; the sun's own motion about the barycentre adds less than 0.01 arcsecond). Parallax is the
 * difference of two vectors. Refraction is the formula of NREL SPA (Reda and Andreas, NREL/TP-560-34302),
 * with its true pressure and temperature. */
#include "terrain/earth/sun.h"

#include <erfa.h>

static const double day_s = 86400, unix_epoch_jd = 2440587.5;
static const double unix_1900_s = -2208988800, unix_2101_s = 4133980800; /* 1900-01-01, 2101-01-01 */
static const double au_m = 149597870700.0, light_day_per_au = 499.004783836 / 86400;

/* TT - UT1 where it does not follow from UTC, which ERFA knows from 1960 until five years after its release. 1900 ..
 * 1960: observed, every five years (Astronomical Almanac, section K), linear between, within 0.9 s. After 2020 an
 * estimate, with an error of up to tens of seconds in 2100; the sun moves 0.04 arcsecond a second, so even that is a
 * thousandth of a degree. */
static double estimate_delta_t_s(double year)
{
    static const struct {
        double year, delta_t_s;
    } table[] = {
        {1900, -2.72}, {1905, 3.86},  {1910, 10.46}, {1915, 17.20}, {1920, 21.16}, {1925, 23.62},
        {1930, 24.02}, {1935, 23.93}, {1940, 24.33}, {1945, 26.77}, {1950, 29.15}, {1955, 31.07},
        {1960, 33.15}, {2020, 69.36}, {2050, 75},    {2101, 95},
    };
    const int count = sizeof table / sizeof table[0];
    int       k = 1;
    while (k < count - 1 && year > table[k].year) k++;
    const double u = (year - table[k - 1].year) / (table[k].year - table[k - 1].year);
    return table[k - 1].delta_t_s + u * (table[k].delta_t_s - table[k - 1].delta_t_s);
}

/* TT - UT1 with UT1 taken as UTC, which is kept within 0.9 s of it. */
static double default_delta_t_s(double day_jd, double day_fraction)
{
    int    year, month, day;
    double fraction, tai_utc_s;
    (void)eraJd2cal(day_jd, 0, &year, &month, &day,
                    &fraction); /* fails only before -4799: sun_at's range begins in 1900 */
    const int status = eraDat(year, month, day, day_fraction, &tai_utc_s);
    /* 0: known. 1: before UTC, or so long after the library's last leap second that there may be more;
     * negative: unacceptable. Both fall back on the Earth's rotation itself. */
    if (status == 0) return 32.184 + tai_utc_s;
    return estimate_delta_t_s(year + (month - 0.5) / 12);
}

static void m33_mul(double out[3], double m[3][3], const double a[3])
{
    for (int i = 0; i < 3; i++) out[i] = v3_dot(m[i], a);
}

/* NREL SPA equation 42: degrees, millibar, Celsius. Not applied once the whole disc is down (0.26667 degrees
 * of radius and 0.5667 of refraction at the horizon, SPA's defaults). */
static double refraction_deg(double elevation_deg, double pressure_mbar, double temp_c)
{
    if (!(elevation_deg >= -(0.26667 + 0.5667))) return 0;
    const double bent_deg = elevation_deg + 10.3 / (elevation_deg + 5.11);
    return pressure_mbar / 1010 * 283 / (273 + temp_c) * 1.02 / (60 * tan(bent_deg * rad_per_deg));
}

Status sun_at(Sun *out, double unix_s, const Geodetic *place, double pressure_mbar, double temp_c, double delta_t_s)
{
    if (!(unix_s >= unix_1900_s && unix_s < unix_2101_s)) return STATUS_BAD_VALUE;
    if (!(pressure_mbar >= 0 && pressure_mbar <= 1200 && temp_c > -150 && temp_c < 100)) return STATUS_BAD_VALUE;
    if (!isnan(delta_t_s) && !(fabs(delta_t_s) <= 1000)) return STATUS_BAD_VALUE;

    double       p_ecef[3], r_ecef_from_enu[9];
    const Status status = ecef_from_geodetic(p_ecef, r_ecef_from_enu, place);
    if (status != STATUS_OK) return status;

    const double day_count = floor(unix_s / day_s), day_jd = unix_epoch_jd + day_count;
    const double ut_day = (unix_s - day_count * day_s) / day_s;
    if (isnan(delta_t_s)) delta_t_s = default_delta_t_s(day_jd, ut_day);
    const double tt_day = ut_day + delta_t_s / day_s;

    /* epv00 warns outside 1900 .. 2100, by at most a year here: errors stay far below an arcsecond */
    double pv_helio[2][3], pv_bary[2][3];
    eraEpv00(day_jd, tt_day, pv_helio, pv_bary);
    const double distance_au = v3_length(pv_helio[0]);
    eraEpv00(day_jd, tt_day - distance_au * light_day_per_au, pv_helio, pv_bary);

    double sun_gcrs_au[3], sun_of_date_au[3], r_date_from_gcrs[3][3];
    v3_scale(sun_gcrs_au, -1, pv_helio[0]);
    eraPnm06a(day_jd, tt_day, r_date_from_gcrs);
    m33_mul(sun_of_date_au, r_date_from_gcrs, sun_gcrs_au);

    /* polar motion, below 0.5 arcsecond, is left out */
    const double gst_rad = eraGst06(day_jd, ut_day, day_jd, tt_day, r_date_from_gcrs);
    const double c = cos(gst_rad), s = sin(gst_rad);
    const double sun_from_place_au[3] = {c * sun_of_date_au[0] + s * sun_of_date_au[1] - p_ecef[0] / au_m,
                                         c * sun_of_date_au[1] - s * sun_of_date_au[0] - p_ecef[1] / au_m,
                                         sun_of_date_au[2] - p_ecef[2] / au_m};

    double enu[3];
    m3_tmul_v3(enu, r_ecef_from_enu, sun_from_place_au);
    double       azimuth_rad = atan2(enu[0], enu[1]);
    const double true_rad = atan2(enu[2], hypot(enu[0], enu[1]));
    const double elevation_rad = true_rad + refraction_deg(true_rad / rad_per_deg, pressure_mbar, temp_c) * rad_per_deg;
    if (azimuth_rad < 0) azimuth_rad += 2 * pi_rad;

    *out = (Sun){
        .azimuth_rad = azimuth_rad,
        .elevation_rad = elevation_rad,
        .distance_au = distance_au,
        .d_enu = {cos(elevation_rad) * sin(azimuth_rad), cos(elevation_rad) * cos(azimuth_rad), sin(elevation_rad)}};
    return STATUS_OK;
}
