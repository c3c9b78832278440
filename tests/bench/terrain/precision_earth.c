/* tests/bench/terrain/precision_earth.c: places, the geoid between its posts, and the sun between frames. */
#include "tests/bench/suites.h"

#include "tests/bench/bench.h"
#include "pitviper_simd.h"
#include "terrain/earth/geoid.h"
#include "terrain/earth/geodesy.h"
#include "terrain/earth/refraction.h"
#include "terrain/earth/sun.h"

#include <stdlib.h>

/* ---- places -------------------------------------------------------------------------------------- */

enum { places = 1024 };

typedef enum FrameWay { FRAME_FLOAT, FRAME_FLOAT_TURN, FRAME_DOUBLE, FRAME_LONG } FrameWay;

typedef struct FrameSet {
    const LocalFrame *frame;
    FrameWay          way;
    double            p_ecef[places][3], p_enu[places][3];
} FrameSet;

static void to_enu(void *user)
{
    FrameSet         *s = user;
    const LocalFrame *f = s->frame;
    for (int i = 0; i < places; i++) {
        if (s->way == FRAME_DOUBLE) enu_from_ecef(s->p_enu[i], f, s->p_ecef[i]);
        for (int c = 0; c < 3 && s->way != FRAME_DOUBLE; c++) {
            float       narrow = 0;
            long double wide = 0;
            for (int k = 0; k < 3; k++) {
                const double p = s->p_ecef[i][k], from = f->origin_ecef[k], r = f->r_ecef_from_enu[3 * k + c];
                narrow += (float)r * (s->way == FRAME_FLOAT ? (float)p - (float)from : (float)(p - from));
                wide += (long double)r * ((long double)p - (long double)from);
            }
            s->p_enu[i][c] = s->way == FRAME_LONG ? (double)wide : (double)narrow;
        }
    }
    bench_keep(s->p_enu);
}

static Status tunable_frame(Bench *bench)
{
    enum { settings = 4 };
    static const char *const name[settings] = {"float", "difference in double, turned in float", "double",
                                               "long double"};
    static FrameSet          set[settings];
    const Geodetic           origin = {48 * rad_per_deg, 11 * rad_per_deg, 500};
    BenchWork                work[settings];
    BenchSetting             point[settings] = {0};
    LocalFrame               frame;
    const Status             status = local_frame_at(&frame, &origin);
    if (status != STATUS_OK) return status;
    for (int k = settings - 1; k >= 0; k--) {
        set[k].frame = &frame, set[k].way = (FrameWay)k;
        for (int i = 0; i < places; i++) {
            double p_enu[3];
            for (int c = 0; c < 3; c++)
                p_enu[c] = (c < 2 ? 4e4 : 4e3) * (random_uniform(31, (uint32_t)c, 0, (uint64_t)i) - 0.5);
            ecef_from_enu(set[k].p_ecef[i], &frame, p_enu);
        }
        to_enu(&set[k]);
        for (int i = 0; i < places; i++) {
            double off[3];
            v3_sub(off, set[k].p_enu[i], set[settings - 1].p_enu[i]);
            bench_worst(&point[k].error, v3_length(off));
        }
        work[k] = (BenchWork){to_enu, &set[k], places};
        point[k].setting = name[k];
        point[k].is_default = k == FRAME_DOUBLE;
    }
    bench_tunable(bench,
                  &(BenchTunable){"Earth to local frame", "terrain/earth/geodesy.h", "a place within 20 km", "m",
                                  "largest, long double", 1e-10},
                  work, point, settings);
    return STATUS_OK;
}

typedef struct GeodeticSet {
    int      rounds; /* of Bowring's; 0: GeographicLib */
    double   p_ecef[places][3];
    Geodetic out[places];
} GeodeticSet;

static const double wgs84_a_m = 6378137, wgs84_f = 1 / 298.257223563;

/* Bowring, Survey Review 23 (1976) 323. */
static void bowring(Geodetic *out, const double p[3], int rounds)
{
    const double e2 = wgs84_f * (2 - wgs84_f), b_m = wgs84_a_m * (1 - wgs84_f), ep2 = e2 / (1 - e2),
                 r = hypot(p[0], p[1]);
    double beta = atan2(p[2] * wgs84_a_m, r * b_m), lat = 0;
    for (int k = 0; k < rounds; k++) {
        const double s = sin(beta), c = cos(beta);
        lat = atan2(p[2] + ep2 * b_m * s * s * s, r - e2 * wgs84_a_m * c * c * c);
        beta = atan2((1 - wgs84_f) * sin(lat), cos(lat));
    }
    const double s = sin(lat), n = wgs84_a_m / sqrt(1 - e2 * s * s);
    *out = (Geodetic){lat, atan2(p[1], p[0]), r * cos(lat) + p[2] * s - wgs84_a_m * wgs84_a_m / n};
}

static void to_geodetic(void *user)
{
    GeodeticSet *s = user;
    for (int i = 0; i < places; i++) {
        if (s->rounds > 0) bowring(&s->out[i], s->p_ecef[i], s->rounds);
        else if (geodetic_from_ecef(&s->out[i], s->p_ecef[i]) != STATUS_OK) s->out[i] = (Geodetic){NAN, NAN, NAN};
    }
    bench_keep(s->out);
}

static void ecef_by_hand(long double p[3], const Geodetic *g)
{
    const long double f = 1 / 298.257223563L, e2 = f * (2 - f), lat = (long double)g->lat_rad,
                      lon = (long double)g->lon_rad, h = (long double)g->h_m, s = sinl(lat),
                      n = 6378137 / sqrtl(1 - e2 * s * s);
    p[0] = (n + h) * cosl(lat) * cosl(lon), p[1] = (n + h) * cosl(lat) * sinl(lon), p[2] = (n * (1 - e2) + h) * s;
}

static void tunable_geodetic(Bench *bench)
{
    enum { settings = 3 };
    static const char *const name[settings] = {"Bowring, once", "Bowring, twice", "GeographicLib"};
    static const int         rounds[settings] = {1, 2, 0};
    static GeodeticSet       set[settings];
    BenchWork                work[settings];
    BenchSetting             point[settings] = {0};
    for (int k = 0; k < settings; k++) {
        set[k].rounds = rounds[k];
        for (int i = 0; i < places; i++) {
            const Geodetic at = {3 * (random_uniform(32, 0, 0, (uint64_t)i) - 0.5),
                                 6 * (random_uniform(32, 1, 0, (uint64_t)i) - 0.5),
                                 5e5 * pow(random_uniform(32, 2, 0, (uint64_t)i), 4)};
            long double    p[3];
            ecef_by_hand(p, &at);
            for (int c = 0; c < 3; c++) set[k].p_ecef[i][c] = (double)p[c];
        }
        to_geodetic(&set[k]);
        for (int i = 0; i < places; i++) {
            long double back[3], square = 0;
            ecef_by_hand(back, &set[k].out[i]);
            for (int c = 0; c < 3; c++)
                square += (back[c] - (long double)set[k].p_ecef[i][c]) * (back[c] - (long double)set[k].p_ecef[i][c]);
            bench_worst(&point[k].error, (double)sqrtl(square));
        }
        work[k] = (BenchWork){to_geodetic, &set[k], places};
        point[k].setting = name[k];
        point[k].is_default = k == settings - 1;
    }
    bench_tunable(bench,
                  &(BenchTunable){"latitude, longitude, height", "terrain/earth/geodesy.cpp",
                                  "a place up to 500 km high", "m", "largest, back again in long double", 1e-8},
                  work, point, settings);
}

/* ---- refraction ------------------------------------------------------------------------------------ */

enum { eyes = 256 };

/* How the air's gradient is taken along the line of sight to the horizon. */
typedef enum BendWay { BEND_NONE, BEND_AT_GROUND, BEND_AT_EYE, BEND_MEAN } BendWay;

typedef struct BendSet {
    BendWay way;
    double  eye_m[eyes], dip_rad[eyes];
} BendSet;

static const double bend_earth_m = 6371e3;

static void find_dips(void *user)
{
    BendSet *s = user;
    for (int i = 0; i < eyes; i++) {
        const double eye_m = s->eye_m[i];
        const double bend = s->way == BEND_NONE        ? 0
                            : s->way == BEND_AT_GROUND ? refraction_bend(REFRACTION_OPTICAL, 0, 0)
                            : s->way == BEND_AT_EYE    ? refraction_bend(REFRACTION_OPTICAL, eye_m, eye_m)
                                                       : refraction_bend(REFRACTION_OPTICAL, eye_m, 0);
        const double flat = 0.5 / bend_earth_m - bend;
        /* the slope of a parabola; a circle's for the rest of it */
        s->dip_rad[i] = acos(bend_earth_m / (bend_earth_m + eye_m)) * sqrt(2 * bend_earth_m * flat);
    }
    bench_keep(s->dip_rad);
}

/* Dip of the horizon from 2 m to 30 km: n r cos is the same all along a ray in a spherical atmosphere. */
static void tunable_refraction(Bench *bench)
{
    enum { settings = 4 };
    static const char *const name[settings] = {"none", "gradient at the ground", "gradient at the eye",
                                               "mean of the heights between"};
    static BendSet           set[settings];
    BenchWork                work[settings];
    BenchSetting             point[settings] = {0};
    const double             scale_m = 11000, n = (1 - 1 / 1.149) * scale_m / bend_earth_m;
    for (int k = 0; k < settings; k++) {
        set[k].way = (BendWay)k;
        for (int i = 0; i < eyes; i++) set[k].eye_m[i] = 2 * pow(15000, i / (eyes - 1.0));
        find_dips(&set[k]);
        for (int i = 0; i < eyes; i++) {
            const double eye_m = set[k].eye_m[i];
            const double share = (1 + n) * bend_earth_m / ((1 + n * exp(-eye_m / scale_m)) * (bend_earth_m + eye_m));
            bench_worst(&point[k].error, fabs(set[k].dip_rad[i] / acos(share) - 1));
        }
        work[k] = (BenchWork){find_dips, &set[k], eyes};
        point[k].setting = name[k];
        point[k].is_default = k == BEND_MEAN;
    }
    bench_tunable(bench,
                  &(BenchTunable){"refraction: dip of the horizon", "terrain/earth/refraction.h",
                                  "an eye of 2 m to 30 km", "of it", "largest, Snell's invariant", 1e-4},
                  work, point, settings);
}

/* ---- geoid ---------------------------------------------------------------------------------------- */

enum { geoid_places = 512, widest = 16 };

typedef struct GeoidSet {
    const Geoid *geoid;
    /* of Lagrange's polynomial each way, of posts so many apart; points 0: geoid_height_m */
    int    points, stride;
    double lat_rad[geoid_places], lon_rad[geoid_places], n_m[geoid_places];
} GeoidSet;

static double geoid_post(const Geoid *g, int row, int column)
{
    column = ((column % g->columns) + g->columns) % g->columns;
    return (double)g->n_m[(size_t)(row + 2) * (size_t)(g->columns + 4) + (size_t)(column + 2)];
}

static void lagrange(double w[widest], int points, double t)
{
    for (int k = 0; k < points; k++) {
        w[k] = 1;
        for (int m = 0; m < points; m++)
            if (m != k) w[k] *= (t + points / 2 - 1 - m) / (k - m);
    }
}

static void ask_geoid(void *user)
{
    GeoidSet    *s = user;
    const Geoid *g = s->geoid;
    for (int i = 0; i < geoid_places; i++) {
        if (s->points == 0) {
            s->n_m[i] = geoid_height_m(g, s->lat_rad[i], s->lon_rad[i]);
            continue;
        }
        const double y = (s->lat_rad[i] / rad_per_deg - g->south_deg) / (g->step_lat_deg * s->stride);
        const double x = (s->lon_rad[i] / rad_per_deg - g->west_deg) / (g->step_lon_deg * s->stride);
        const int    j = (int)floor(y), k = (int)floor(x);
        double       wx[widest], wy[widest], sum = 0;
        lagrange(wx, s->points, x - k);
        lagrange(wy, s->points, y - j);
        for (int b = 0; b < s->points; b++) {
            double row = 0;
            for (int a = 0; a < s->points; a++)
                row += wx[a] *
                       geoid_post(g, (j - s->points / 2 + 1 + b) * s->stride, (k - s->points / 2 + 1 + a) * s->stride);
            sum += wy[b] * row;
        }
        s->n_m[i] = sum;
    }
    bench_keep(s->n_m);
}

/* EGM96 ends at degree 360, half the grid's own Nyquist degree of 720: a polynomial through enough posts is the
 * series. */
static void tunable_geoid(Bench *bench)
{
    enum { settings = 6 };
    static const char *const name[settings] = {"posts of 30', straight", "posts of 30', cubic",
                                               "posts of 15', straight", "posts of 15', cubic",
                                               "posts of 15', quintic",  "posts of 15', of degree 7"};
    static const int         points[settings] = {2, 4, 2, 0, 6, 8}, stride[settings] = {2, 2, 1, 1, 1, 1};
    static GeoidSet          set[settings], fine;
    BenchWork                work[settings];
    BenchSetting             point[settings] = {0};
    Geoid                    geoid;
    log_suppress(true);
    const Status status = geoid_open(&geoid, NULL);
    log_suppress(false);
    if (status != STATUS_OK) {
        const BenchRow row = bench_row("geoid between posts: no grid here (apt-get install proj-data)");
        bench_add(bench, &row);
        return;
    }
    for (int k = -1; k < settings; k++) {
        GeoidSet *s = k < 0 ? &fine : &set[k];
        *s = (GeoidSet){.geoid = &geoid, .points = k < 0 ? widest : points[k], .stride = k < 0 ? 1 : stride[k]};
        for (int i = 0; i < geoid_places; i++) {
            s->lat_rad[i] = 2.6 * (random_uniform(33, 0, 0, (uint64_t)i) - 0.5);
            s->lon_rad[i] = 6.2 * (random_uniform(33, 1, 0, (uint64_t)i) - 0.5);
        }
        ask_geoid(s);
        if (k < 0) continue;
        double square = 0;
        for (int i = 0; i < geoid_places; i++) square += (s->n_m[i] - fine.n_m[i]) * (s->n_m[i] - fine.n_m[i]);
        work[k] = (BenchWork){ask_geoid, s, geoid_places};
        point[k] = (BenchSetting){.setting = name[k],
                                  .error = sqrt(square / geoid_places),
                                  .is_default = k == 3,
                                  .bytes = 4.0 * geoid.rows * geoid.columns / (stride[k] * stride[k])};
    }
    bench_tunable(bench,
                  &(BenchTunable){"geoid between posts", "terrain/earth/geoid.c", "a place between 74 S and 74 N", "m",
                                  "rms, 16 x 16 posts", 0.03},
                  work, point, settings);
    geoid_close(&geoid);
}

/* ---- sun ------------------------------------------------------------------------------------------ */

/* The example of NREL/TP-560-34302: Golden, Colorado, 2003-10-17 12:30:30 at UTC - 7 h, with TT - UT1 = 67 s. */
static const double   spa_unix_s = 1066419030, spa_zenith_deg = 50.11162, spa_azimuth_deg = 194.34024;
static const Geodetic spa_place = {39.742476 * 0.017453292519943295769, -105.1786 * 0.017453292519943295769, 1830.14};

typedef struct SunSet {
    double hold_s; /* evaluated at this interval; below 0: by the short formula */
    int    frames; /* of 30 a second in that time */
    double d_enu[3];
} SunSet;

/* The formula of the Astronomical Almanac (page C5), good to 0.01 degree until 2050, with the refraction left out. */
static void short_formula(double d_enu[3], double unix_s, const Geodetic *place)
{
    const double n = unix_s / 86400 - 10957.5, l = (280.460 + 0.9856474 * n) * rad_per_deg,
                 g = (357.528 + 0.9856003 * n) * rad_per_deg;
    const double lambda = l + (1.915 * sin(g) + 0.020 * sin(2 * g)) * rad_per_deg,
                 e = (23.439 - 4e-7 * n) * rad_per_deg;
    const double ra = atan2(cos(e) * sin(lambda), cos(lambda)), dec = asin(sin(e) * sin(lambda));
    const double hour = (280.46061837 + 360.98564736629 * n) * rad_per_deg + place->lon_rad - ra;
    d_enu[0] = -cos(dec) * sin(hour);
    d_enu[1] = sin(dec) * cos(place->lat_rad) - cos(dec) * cos(hour) * sin(place->lat_rad);
    d_enu[2] = sin(dec) * sin(place->lat_rad) + cos(dec) * cos(hour) * cos(place->lat_rad);
}

static void ask_sun(void *user)
{
    SunSet *s = user;
    Sun     sun;
    if (s->hold_s < 0) short_formula(s->d_enu, spa_unix_s, &spa_place);
    else if (sun_at(&sun, spa_unix_s - s->hold_s, &spa_place, 820, 11, 67) == STATUS_OK)
        memcpy(s->d_enu, sun.d_enu, sizeof s->d_enu);
    bench_keep(s->d_enu);
}

static void tunable_sun(Bench *bench)
{
    enum { settings = 5 };
    static const char *const name[settings] = {"short formula, each frame", "once a minute", "once in 10 s",
                                               "once a second", "each frame"};
    static SunSet            set[settings] = {
                   {.hold_s = -1, .frames = 1}, {60, 1800, {0}}, {10, 300, {0}}, {1, 30, {0}}, {0, 1, {0}}};
    BenchWork    work[settings];
    BenchSetting point[settings] = {0};
    const double up_rad = (90 - spa_zenith_deg) * rad_per_deg, az_rad = spa_azimuth_deg * rad_per_deg;
    const double want[3] = {cos(up_rad) * sin(az_rad), cos(up_rad) * cos(az_rad), sin(up_rad)};
    for (int k = 0; k < settings; k++) {
        double off[3];
        ask_sun(&set[k]);
        v3_sub(off, set[k].d_enu, want);
        work[k] = (BenchWork){ask_sun, &set[k], set[k].frames};
        point[k] =
            (BenchSetting){.setting = name[k], .error = v3_length(off) / rad_per_deg, .is_default = k == settings - 1};
    }
    bench_tunable(bench,
                  &(BenchTunable){"the sun's place", "terrain/earth/sun.c", "a frame of 30 a second", "deg",
                                  "NREL's published place, at the end of the time", 0.0005},
                  work, point, settings);
}

/* ---- powers of two -------------------------------------------------------------------------------- */

enum { powers = 4096 };

typedef struct PowerSet {
    int   way; /* 0: the library's in float, 1: in double, 2: eight at a time */
    float in[powers], out[powers];
} PowerSet;

static void ask_powers(void *user)
{
    PowerSet *s = user;
    for (int i = 0; i < powers && s->way == 0; i++) s->out[i] = exp2f(s->in[i]);
    for (int i = 0; i < powers && s->way == 1; i++) s->out[i] = (float)exp2((double)s->in[i]);
    for (int i = 0; i < powers && s->way == 2; i += 8) f32x8_store(s->out + i, f32x8_exp2(f32x8_load(s->in + i)));
    bench_keep(s->out);
}

static void tunable_powers(Bench *bench)
{
    enum { settings = 3 };
    static const char *const name[settings] = {"the library's in float", "the library's in double, narrowed",
                                               "eight at a time, degree 5"};
    static PowerSet          set[settings];
    BenchWork                work[settings];
    BenchSetting             point[settings] = {0};
    for (int k = 0; k < settings; k++) {
        set[k].way = k;
        for (int i = 0; i < powers; i++) set[k].in[i] = (float)(-100 + 200 * random_uniform(34, 0, 0, (uint64_t)i));
        ask_powers(&set[k]);
        for (int i = 0; i < powers; i++)
            bench_worst(&point[k].error,
                        (double)fabsl((long double)set[k].out[i] / exp2l((long double)set[k].in[i]) - 1) * 100);
        work[k] = (BenchWork){ask_powers, &set[k], powers};
        point[k].setting = name[k];
        point[k].is_default = k == settings - 1;
    }
    bench_tunable(bench,
                  &(BenchTunable){"powers of two", "pitviper_simd.h", "a number of -100 .. 100", "%",
                                  "largest, long double", 2e-5},
                  work, point, settings);
}

Status bench_precision_earth(Bench *bench)
{
    const Status status = tunable_frame(bench);
    if (status != STATUS_OK) {
        log_error("bench: precision: %s", status_name(status));
        return status;
    }
    tunable_geodetic(bench);
    tunable_refraction(bench);
    tunable_geoid(bench);
    tunable_sun(bench);
    tunable_powers(bench);
    return STATUS_OK;
}
