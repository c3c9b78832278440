/* tests/bench/terrain/stability_earth.c: geodesy at its edge cases: poles, date line, trenches and orbits, each with
 * its neighbours in floating point. References: WGS 84 in long double, ERFA by another method, and symmetry. */
#include "tests/bench/suites.h"

#include "terrain/earth/geoid.h"
#include "terrain/earth/geodesy.h"
#include "terrain/earth/sun.h"

#include <erfa.h>

static double uniform(uint32_t stream, uint64_t index, double low, double high)
{
    return low + (high - low) * random_uniform(0x7E44, stream, 0, index);
}

/* ---- WGS 84 in long double ------------------------------------------------------------------ */

typedef struct FrameL {
    long double origin[3], r[9]; /* r: ECEF from ENU */
} FrameL;

static FrameL frame_l(const Geodetic *g)
{
    const long double f = 1 / 298.257223563L, e2 = f * (2 - f);
    const long double sp = sinl(g->lat_rad), cp = cosl(g->lat_rad), sl = sinl(g->lon_rad), cl = cosl(g->lon_rad);
    const long double n = 6378137.0L / sqrtl(1 - e2 * sp * sp);
    return (FrameL){{(n + g->h_m) * cp * cl, (n + g->h_m) * cp * sl, (n * (1 - e2) + g->h_m) * sp},
                    {-sl, -sp * cl, cp * cl, cl, -sp * sl, cp * sl, 0, cp, sp}};
}

static double distance_l(const double p[3], const long double q[3])
{
    return (double)sqrtl((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) + (p[2] - q[2]) * (p[2] - q[2]));
}

/* ---- places --------------------------------------------------------------------------------- */

static const double lat_deg[] = {0,       -0.0,     1e-310,      1e-12,        -1e-12, 45, -45,
                                 89.9999, -89.9999, 89.99999999, -89.99999999, 90,     -90};
static const double lon_deg[] = {0, -0.0, 1e-310, -1e-12, 90, -90, 179.9999, -179.9999, 180, -180, 359.9, -270};
static const double high_m[] = {-11000, -1e-310, 0, 8848, 1e5, 1e6};
enum {
    lats = 3 * sizeof lat_deg / sizeof *lat_deg,
    lons = 3 * sizeof lon_deg / sizeof *lon_deg,
    heights = sizeof high_m / sizeof *high_m,
    special_places = lats * lons * heights
};

/* Gives a special angle, or its neighbour below or above. */
static double neighbour_rad(const double *deg, int i)
{
    const double rad = deg[i / 3] * rad_per_deg;
    return i % 3 == 0 ? rad : nextafter(rad, i % 3 == 1 ? -INFINITY : INFINITY);
}

static Geodetic place_at(int n)
{
    if (n >= special_places)
        return (Geodetic){uniform(1, (uint64_t)n, -0.5, 0.5) * pi_rad, uniform(2, (uint64_t)n, -1, 1) * pi_rad,
                          uniform(3, (uint64_t)n, -11e3, 1e6)};
    const double lat_rad = neighbour_rad(lat_deg, n % lats);
    return (Geodetic){clamp(lat_rad, -0.5 * pi_rad, 0.5 * pi_rad), neighbour_rad(lon_deg, n / lats % lons),
                      high_m[n / lats / lons]};
}

static void off_rotation(double *worst, const double r[9])
{
    double product[9], cross[3];
    m3_tmul(product, r, r);
    for (int k = 0; k < 9; k++) bench_worse(worst, product[k] - (k % 4 == 0));
    v3_cross(cross, r, r + 3); /* right-handed: the third row */
    for (int k = 0; k < 3; k++) bench_worse(worst, cross[k] - r[6 + k]);
}

static void places(Bench *bench)
{
    const int count = special_places + (bench_quick(bench) ? 3000 : 1000000);
    double    forward_m = 0, back_m = 0, crooked = 0, turned = 0, jump = 0, beyond = 0;
    for (int n = 0; n < count; n++) {
        const Geodetic place = place_at(n), east = {place.lat_rad, nextafter(place.lon_rad, 9), place.h_m};
        const FrameL   want = frame_l(&place);
        double         p_ecef[3], r[9], q_ecef[3], r_east[9];
        Geodetic       back;
        if (ecef_from_geodetic(p_ecef, r, &place) != STATUS_OK || geodetic_from_ecef(&back, p_ecef) != STATUS_OK ||
            ecef_from_geodetic(q_ecef, r_east, &east) != STATUS_OK) {
            forward_m = INFINITY;
            continue;
        }
        bench_worse(&forward_m, distance_l(p_ecef, want.origin));
        const FrameL again = frame_l(&back);
        bench_worse(&back_m, distance_l(p_ecef, again.origin));
        off_rotation(&crooked, r);
        for (int k = 0; k < 9; k++) bench_worse(&turned, (double)(r[k] - want.r[k]));
        for (int k = 0; k < 9; k++) bench_worse(&jump, r[k] - r_east[k]);
        beyond += !(fabs(back.lat_rad) <= 0.5 * pi_rad && fabs(back.lon_rad) <= pi_rad);
    }
    const char *l = "WGS 84 in long double";
    bench_stress(bench, "latitude, longitude, height to ECEF, -11 .. 1000 km", forward_m, 7e-9, "m", l);
    bench_stress(bench, "ECEF to latitude, longitude, height, and back", back_m, 7e-9, "m", l);
    bench_stress(bench, "the same: angles beyond a pole or the date line", beyond, 0, "places", "range of the angles");
    bench_stress(bench, "ENU axes: not square, not unit or left-handed by", crooked, 1e-15, "",
                 "R'R = I, cross products");
    bench_stress(bench, "ENU axes: off their directions", turned, 1e-15, "", l);
    bench_stress(bench, "ENU axes: jump to the next longitude there is", jump, 1e-15, "", "continuity");
}

/* Points given as ECEF: on the axis, in the equator's plane, with zeroes of both signs. */
static void awkward_points(Bench *bench)
{
    static const double value[] = {0,       -0.0,     1e-310, 1e-9, -1e-9, 6356752.3142451793, -6356752.3142451793,
                                   6378137, -6378137, 7.4e6,  -4e6};
    enum { values = sizeof value / sizeof *value };
    double off_m = 0;
    for (int n = 0; n < values * values * values; n++) {
        const double p_ecef[3] = {value[n % values], value[n / values % values], value[n / values / values]};
        Geodetic     place;
        if (!(v3_length(p_ecef) > 3e6)) continue; /* where latitude is not one: no sender is there */
        if (geodetic_from_ecef(&place, p_ecef) != STATUS_OK) {
            off_m = INFINITY;
            continue;
        }
        const FrameL back = frame_l(&place);
        bench_worse(&off_m, distance_l(p_ecef, back.origin));
    }
    /* beyond 12 000 km out the angles' last bits alone are worth 2 nm each */
    bench_stress(bench, "ECEF on the axis, in the equator's plane, zeroes of both signs", off_m, 1e-8, "m",
                 "WGS 84 in long double");
}

/* ---- local frames --------------------------------------------------------------------------- */

static void frames_within(Bench *bench, double reach_m, double limit_m, double limit_back_m, const char *what,
                          const char *what_back)
{
    double    off_m = 0, back_m = 0;
    const int points = bench_quick(bench) ? 6 : 200;
    for (int n = 0; n < special_places; n += bench_quick(bench) ? 7 : 1) {
        const Geodetic origin = place_at(n);
        const FrameL   want = frame_l(&origin);
        LocalFrame     frame;
        if (local_frame_at(&frame, &origin) != STATUS_OK) off_m = INFINITY;
        else
            for (int k = 0; k < points; k++) {
                double      p_enu[3], p_ecef[3], back[3];
                long double ecef[3], enu[3] = {0};
                for (int c = 0; c < 3; c++) {
                    const double share = uniform(10 + (uint32_t)c, (uint64_t)(n * points + k), -1, 1);
                    p_enu[c] = reach_m * (k == 0 ? 0 : k < 4 ? (k - 1 == c) : share);
                }
                ecef_from_enu(p_ecef, &frame, p_enu);
                enu_from_ecef(back, &frame, p_ecef);
                for (int c = 0; c < 3; c++) {
                    ecef[c] = want.origin[c];
                    for (int i = 0; i < 3; i++) {
                        ecef[c] += want.r[3 * c + i] * p_enu[i];
                        enu[c] += want.r[3 * i + c] * (p_ecef[i] - want.origin[i]);
                    }
                }
                bench_worse(&off_m, distance_l(p_ecef, ecef));
                bench_worse(&off_m, distance_l(back, enu));
                for (int c = 0; c < 3; c++) bench_worse(&back_m, back[c] - p_enu[c]);
            }
    }
    bench_stress(bench, what, off_m, limit_m, "m", "long double");
    bench_stress(bench, what_back, back_m, limit_back_m, "m", "itself");
}

/* Two points some metres apart as frames all over the Earth see them: how far they are from each other. */
static void any_origin(Bench *bench)
{
    double near_m = 0, far_m = 0;
    for (int n = 0; n < (bench_quick(bench) ? 3000 : 300000); n++) {
        const uint64_t at = (uint64_t)n;
        const Geodetic place = place_at(n % special_places);
        const FrameL   here = frame_l(&place);
        double         a_ecef[3], b_ecef[3], d_ecef[3], d_unit[3];
        for (int c = 0; c < 3; c++) {
            a_ecef[c] = (double)here.origin[c];
            b_ecef[c] = a_ecef[c] + uniform(20 + (uint32_t)c, at, -30, 30);
            d_ecef[c] = b_ecef[c] - a_ecef[c]; /* exact or nearly so: the numbers are neighbours */
            d_unit[c] = uniform(23 + (uint32_t)c, at, -1, 1);
        }
        for (int far = 0; far < 2; far++) {
            double     o_ecef[3], a_enu[3], b_enu[3], seen_enu[3], seen_ecef[3];
            Geodetic   origin;
            LocalFrame frame;
            if (far) origin = place_at((int)uniform(26, at, 0, special_places));
            else {
                v3_add_scaled(o_ecef, a_ecef, pow(10, uniform(27, at, 0, 5)), d_unit);
                if (geodetic_from_ecef(&origin, o_ecef) != STATUS_OK) near_m = INFINITY;
            }
            if (local_frame_at(&frame, &origin) != STATUS_OK) {
                far_m = INFINITY;
                continue;
            }
            enu_from_ecef(a_enu, &frame, a_ecef);
            enu_from_ecef(b_enu, &frame, b_ecef);
            v3_sub(seen_enu, b_enu, a_enu);
            m3_mul_v3(seen_ecef, frame.r_ecef_from_enu, seen_enu);
            for (int c = 0; c < 3; c++) bench_worse(far ? &far_m : &near_m, seen_ecef[c] - d_ecef[c]);
        }
    }
    /* the limit is 100 km times 2^-53, for three products and two sums; and 14 000 km for the far side of the Earth */
    bench_stress(bench, "two points 0 .. 50 m apart, seen from origins within 170 km", near_m, 1e-10, "m",
                 "their difference in ECEF");
    bench_stress(bench, "the same from origins anywhere, the far side of the Earth too", far_m, 2e-8, "m",
                 "their difference in ECEF");
}

/* ---- sun ------------------------------------------------------------------------------------ */

/* Computes the sun by another method of ERFA: the CIO-based matrix, light time to the Sun's barycentric position, and
 * the aberration of an observer rotating with the Earth. Gives a unit vector at the position, ENU, without refraction.
 */
static void sun_another_way(double d_enu[3], double unix_s, const Geodetic *place, double delta_t_s)
{
    const double au_m = 149597870700.0, c_au_day = 173.144632674, day = floor(unix_s / 86400), jd = 2440587.5 + day;
    const double ut = (unix_s - 86400 * day) / 86400, tt = ut + delta_t_s / 86400,
                 turn_per_day = 2 * pi_rad * 1.00273781191135448;
    const FrameL site = frame_l(place);
    double       helio[2][3], bary[2][3], later_helio[2][3], later_bary[2][3], r[3][3], eye[3], spin[3], v[3], seen[3],
        way[3];
    double natural[3], apparent[3], distance = 1;
    eraEpv00(jd, tt, helio, bary);
    eraC2t06a(jd, tt, jd, ut, 0, 0, r);
    const double p_au[3] = {(double)site.origin[0] / au_m, (double)site.origin[1] / au_m,
                            (double)site.origin[2] / au_m};
    const double v_itrs[3] = {-turn_per_day * p_au[1], turn_per_day * p_au[0], 0};
    eraTrxp(r, (double *)p_au, eye);
    eraTrxp(r, (double *)v_itrs, spin);
    for (int k = 0; k < 3; k++) v[k] = (bary[1][k] + spin[k]) / c_au_day;
    for (int step = 0; step < 3; step++) {
        eraEpv00(jd, tt - distance / c_au_day, later_helio, later_bary);
        for (int k = 0; k < 3; k++) way[k] = later_bary[0][k] - later_helio[0][k] - bary[0][k] - eye[k];
        distance = v3_length(way);
    }
    v3_scale(natural, 1 / distance, way);
    eraAb(natural, v, distance, sqrt(1 - v3_dot(v, v)), apparent);
    eraRxp(r, apparent, seen);
    for (int k = 0; k < 3; k++)
        d_enu[k] = (double)(site.r[k] * seen[0] + site.r[3 + k] * seen[1] + site.r[6 + k] * seen[2]);
}

static const double arcsec_rad = 4.84813681109536e-6;

static double angle_between(const double a[3], const double b[3])
{
    double cross[3];
    v3_cross(cross, a, b);
    return atan2(v3_length(cross), v3_dot(a, b));
}

/* Leap days, leap seconds, the ends of the centuries and of what is stated. */
static const char *const special_utc[] = {"1950-01-01T00:00:00Z", "1952-02-29T12:00:00Z", "1972-06-30T23:59:59.999Z",
                                          "1972-07-01T00:00:00Z", "2000-02-29T00:00:00Z", "2016-12-31T23:59:59.999Z",
                                          "2017-01-01T00:00:00Z", "2024-02-29T23:59:59Z", "2024-12-31T23:59:59Z",
                                          "2100-02-28T23:59:59Z", "2100-03-01T00:00:00Z", "2100-12-31T23:59:59Z"};

static double instant(int n)
{
    double unix_s;
    if (n < (int)(sizeof special_utc / sizeof *special_utc))
        return text_to_unix_s(&unix_s, special_utc[n]) ? unix_s : NAN;
    return uniform(30, (uint64_t)n, -631152000, 4133980799); /* 1950 .. 2100 */
}

static void sun(Bench *bench)
{
    const int count = bench_quick(bench) ? 400 : 12000;
    double    off_rad = 0, unit = 0, bent_rad = 0;
    for (int n = 0; n < count; n++) {
        const Geodetic place = place_at(n % 5 ? n * 37 % special_places : special_places + n);
        const double   unix_s = instant(n), delta_t_s = uniform(31, (uint64_t)n, 20, 100);
        double         want[3];
        Sun            bare, air;
        if (sun_at(&bare, unix_s, &place, 0, 10, delta_t_s) != STATUS_OK ||
            sun_at(&air, unix_s, &place, 1010, 10, delta_t_s) != STATUS_OK) {
            off_rad = INFINITY;
            continue;
        }
        sun_another_way(want, unix_s, &place, delta_t_s);
        bench_worse(&off_rad, angle_between(bare.d_enu, want));
        bench_worse(&unit, v3_length(bare.d_enu) - 1);
        bench_worse(&unit, v3_length(air.d_enu) - 1);
        /* NREL SPA, equation 42, from the other method's elevation */
        const long double e_deg = atan2l(want[2], hypotl(want[0], want[1])) / rad_per_deg;
        if (fabsl(e_deg + 0.83337L) < 2e-3L) continue; /* where the formula itself breaks off */
        const long double bend =
            e_deg < -0.83337L ? 0 : 1.02L / (60 * tanl((e_deg + 10.3L / (e_deg + 5.11L)) * (long double)rad_per_deg));
        bench_worse(&bent_rad, (air.elevation_rad - bare.elevation_rad) - (double)bend * rad_per_deg);
    }
    const char *another = "ERFA another way: CIO, own light time, eraAb";
    /* the diurnal aberration, 0.32 arcsecond at the equator, is what sun_at leaves out */
    bench_stress(bench, "sun 1950 .. 2100, poles, date line, horizon, nadir", off_rad / arcsec_rad, 0.4, "arcsec",
                 another);
    bench_stress(bench, "the same: length of its direction, with and without air", unit, 4e-16, "", "1");
    bench_stress(bench, "the same: refraction", bent_rad / arcsec_rad, 0.01, "arcsec", "NREL SPA (42), long double");
}

/* Over the steps of the clocks, where TT - UT1 changes its source: leap seconds, year ends, the table's end. */
static void sun_over_steps(Bench *bench)
{
    const Geodetic place = {0.6, -2.1, 0};
    double         jump_rad = 0;
    const int      years = bench_quick(bench) ? 40 : 1;
    for (int month = 0; month < 12 * 200; month++) {
        const int year = 1900 + month / 12, m = month % 12 + 1;
        char      text[32];
        double    at_s;
        Sun       before, after;
        if ((m != 1 && m != 7 && m != 3) || (years > 1 && year % 4 != 1)) continue;
        snprintf(text, sizeof text, "%04d-%02d-01T00:00:00Z", year, m);
        if (!text_to_unix_s(&at_s, text) || sun_at(&before, at_s - 5e-4, &place, 0, 10, NAN) != STATUS_OK ||
            sun_at(&after, at_s + 5e-4, &place, 0, 10, NAN) != STATUS_OK) {
            if (year > 1900) jump_rad = INFINITY;
            continue;
        }
        bench_worse(&jump_rad, angle_between(before.d_enu, after.d_enu));
    }
    /* 0.015 arcsec of the Earth's rotation in 1 ms, and 0.04 of the sun's motion in the second by which TT - UT1 may
     * step */
    bench_stress(bench, "sun over leap seconds, leap days, new years: step in 1 ms", jump_rad / arcsec_rad, 0.06,
                 "arcsec", "continuity");
}

/* ---- geoid ---------------------------------------------------------------------------------- */

static Status geoid(Bench *bench)
{
    Geoid        grid;
    double       pole_m = 0, seam_m = 0, jump_m = 0, kink = 0;
    const Status status = geoid_open(&grid, NULL);
    if (status != STATUS_OK) return status;
    for (int n = 0; n < (bench_quick(bench) ? 2000 : 200000); n++) {
        const double lon_rad = n < lons ? neighbour_rad(lon_deg, n) : uniform(40, (uint64_t)n, -1, 1) * pi_rad;
        const double lat_rad = n < lats ? clamp(neighbour_rad(lat_deg, n), -0.5 * pi_rad, 0.5 * pi_rad)
                                        : uniform(41, (uint64_t)n, -0.5, 0.5) * pi_rad;
        for (int south = 0; south < 2; south++)
            bench_worse(&pole_m, geoid_height_m(&grid, (south ? -0.5 : 0.5) * pi_rad, lon_rad) -
                                     geoid_height_m(&grid, (south ? -0.5 : 0.5) * pi_rad, 0));
        /* the slope at a pole, by the last metres and by the rows on both sides of it; posts every 1/4 degree */
        const double row_off = 0.25 * rad_per_deg, m_rad = 6.4e6, last = 1e-5, hand = n & 1 ? -1 : 1,
                     top_rad = 0.5 * pi_rad;
        const double post_rad = rint(lon_rad / row_off) * row_off;
        const double over = (geoid_height_m(&grid, hand * (top_rad - row_off), post_rad) -
                             geoid_height_m(&grid, hand * (top_rad - row_off), post_rad + pi_rad)) /
                            (2 * row_off * m_rad);
        const double near = (geoid_height_m(&grid, hand * (top_rad - last), post_rad) -
                             geoid_height_m(&grid, hand * top_rad, post_rad)) /
                            (last * m_rad);
        bench_worse(&kink, near - over);
        bench_worse(&seam_m, geoid_height_m(&grid, lat_rad, pi_rad) - geoid_height_m(&grid, lat_rad, -pi_rad));
        bench_worse(&seam_m,
                    geoid_height_m(&grid, lat_rad, lon_rad) - geoid_height_m(&grid, lat_rad, lon_rad + 2 * pi_rad));
        /* 6 mm of ground on either side of any place: over the seam, over a pole, over the rows of the grid */
        const double row_rad = rint(lat_rad / rad_per_deg * 4) / 4 * rad_per_deg;
        const double top = fmin(row_rad + 1e-9, 0.5 * pi_rad), low = fmax(row_rad - 1e-9, -0.5 * pi_rad);
        bench_worse(&jump_m, geoid_height_m(&grid, top, lon_rad) - geoid_height_m(&grid, low, lon_rad));
        bench_worse(&jump_m,
                    geoid_height_m(&grid, lat_rad, -pi_rad - 1e-9) - geoid_height_m(&grid, lat_rad, -pi_rad + 1e-9));
        bench_worse(&jump_m, geoid_height_m(&grid, (n & 1 ? -1 : 1) * (0.5 * pi_rad - 1e-9), lon_rad) -
                                 geoid_height_m(&grid, (n & 1 ? -1 : 1) * (0.5 * pi_rad - 1e-9), lon_rad + pi_rad));
    }
    geoid_close(&grid);
    bench_stress(bench, "geoid: a pole at any longitude", pole_m, 1e-12, "m", "the same pole at 0 E");
    bench_stress(bench, "geoid: east and west of the date line, a turn apart", seam_m, 1e-9, "m", "the same place");
    /* what a cubic leaves of the curvature between posts 28 km apart */
    bench_stress(bench, "geoid: slope at a pole", kink, 6e-6, "", "the posts on both sides of it");
    /* its slope is below 1e-3 */
    bench_stress(bench, "geoid: step over poles, date line and rows, in 12 mm", jump_m, 1.2e-5, "m", "continuity");
    return STATUS_OK;
}

Status bench_stability_earth(Bench *bench)
{
    bench_progress(bench, "places");
    places(bench);
    awkward_points(bench);
    /* the limit is the origin's own 7 nm and one of the sum's */
    frames_within(bench, 1e5, 8e-9, 2e-9, "local frame, points 100 km away", "the same, there and back");
    frames_within(bench, 1e6, 8e-9, 2e-9, "local frame, points 1000 km away", "the same, 1000 km, there and back");
    any_origin(bench);
    bench_progress(bench, "sun");
    sun(bench);
    sun_over_steps(bench);
    const Status status = geoid(bench);
    return status == STATUS_OK ? bench_stability_posts(bench) : status;
}
