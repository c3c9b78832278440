/* Signatures that are given: grids and scatterers against closed forms (a sphere off the phase centre, a plate's sinc),
 * what lies between rows, how far a table is known, lists of entities, and what is refused. labels: physics */
#include "tests/check.h"

#include "render/scattering/signatures/given_signature.h"
#include "render/scattering/field/total_field.h"
#include "tests/render/radar_stage.h"

#include <sys/stat.h>
#include <stdlib.h>
#include <unistd.h>

static char folder[64], table_path[128];

static int open_folder(void **state)
{
    (void)state;
    strcpy(folder, "/tmp/pitviper_given_XXXXXX");
    return mkdtemp(folder) ? 0 : -1;
}

static int close_folder(void **state)
{
    (void)state;
    return rmdir(folder);
}

static FILE *begin(const char *name)
{
    snprintf(table_path, sizeof table_path, "%s/%s", folder, name);
    FILE *file = fopen(table_path, "w");
    CHECK(file);
    return file;
}

static GivenSignature *opened(FILE *file)
{
    GivenSignature *given = NULL;
    CHECK(fclose(file) == 0);
    CHECK(given_signature_open(&given, table_path) == STATUS_OK);
    remove(table_path);
    return given;
}

static Status refused(const char *text)
{
    GivenSignature *given = NULL;
    FILE           *file = begin("bad.csv");
    fputs(text, file);
    CHECK(fclose(file) == 0);
    log_set_level((LogLevel)(LOG_ERROR + 1));
    const Status status = given_signature_open(&given, table_path);
    log_set_level(LOG_WARN);
    CHECK((status == STATUS_OK) == (given != NULL));
    given_signature_close(given);
    remove(table_path);
    return status;
}

static ScatterMatrix field_at_look(const GivenSignature *given, double az_deg, double el_deg, double frequency_hz)
{
    const ScatterAntenna antenna = antenna_at(az_deg, el_deg, INFINITY);
    ScatterMatrix        s;
    CHECK(given_signature_knows(given, &antenna, frequency_hz));
    given_signature_field(&s, given, &antenna, frequency_hz);
    return s;
}

static double complex sum_of(const Centres *centres, double k)
{
    double complex sum = 0;
    for (int i = 0; i < centres->count; i++) sum += centres->centre[i].s.vv * cexp(-I * k * centres->centre[i].path_m);
    return sum;
}

/* A point of 10 m2 at x = 0.05 m, whose field turns by the path 2 x cos(az) cos(el): the grid's own rows to its digits,
 * and between them, where the phase steps by at most d, the chord's error d^2 / 8 of the field. */
static void fields_between_rows_follow_the_phase(void **state)
{
    (void)state;
    enum { step_deg = 2 };
    const double hz = 10e9, k = 2 * pi_rad * hz / 299792458.0, x_m = 0.05, amplitude = sqrt(10 / (4 * pi_rad));
    FILE        *file = begin("point.csv");
    fputs("az_deg,el_deg,f_ghz,hh_re_m,hh_im_m,vv_re_m,vv_im_m\n", file);
    for (int az = 0; az <= 360; az += step_deg)
        for (int el = -10; el <= 10; el += step_deg) {
            const double complex s = amplitude * cexp(I * k * 2 * x_m * cos(az * rad_per_deg) * cos(el * rad_per_deg));
            fprintf(file, "%d,%d,10,%.12g,%.12g,%.12g,%.12g\n", az, el, creal(s), cimag(s), creal(s), cimag(s));
        }
    GivenSignature *given = opened(file);
    const double most_step_rad = k * 2 * x_m * (step_deg * rad_per_deg) * (1 + 0.18); /* in azimuth, and in elevation */
    double       worst_db = 0, worst = 0;
    for (double az = -200; az < 400; az += 0.37) {
        const double         el = 9.9 * sin(az);
        const double complex want = amplitude * cexp(I * k * 2 * x_m * cos(az * rad_per_deg) * cos(el * rad_per_deg));
        const ScatterMatrix  s = field_at_look(given, az, el, hz);
        worst = fmax(worst, cabs(s.vv - want) / amplitude);
        worst_db = fmax(worst_db, fabs(20 * log10(cabs(s.hh) / amplitude)));
        CHECK(s.hv == 0 && s.vh == 0);
    }
    print_message("a point 5 cm from the origin, rows 2 degrees apart: %.4f of the field (bound %.4f), %.3f dB\n",
                  worst, most_step_rad * most_step_rad / 8, worst_db);
    CHECK(worst <= most_step_rad * most_step_rad / 8);
    const ScatterMatrix row = field_at_look(given, 30, 4, hz);
    CHECK(cabs(row.vv - amplitude * cexp(I * k * 2 * x_m * cos(30 * rad_per_deg) * cos(4 * rad_per_deg))) < 1e-11);
    given_signature_close(given);
}

/* A plate of 0.3 m at 10 GHz, 10 wavelengths: 4 pi A^2 / lambda^2 cos^2 sinc^2, rows of dBsm every 0.1 degrees; between
 * them linear in decibels. In the main lobe the error is the chord's, by the second derivative of sinc^2 in decibels.
 */
static void decibels_between_rows_are_linear(void **state)
{
    (void)state;
    const double hz = 299792458.0 / 0.03, side_m = 0.3;
    FILE        *file = begin("plate.csv");
    fputs("vv_dbsm,hh_dbsm,f_ghz,el_deg,az_deg\n", file); /* in any order */
    for (int i = 40; i >= -40; i--) {
        const double x = 2 * pi_rad * side_m / 0.03 * sin(0.1 * i * rad_per_deg), sinc = i ? sin(x) / x : 1;
        const double m2 = 4 * pi_rad * pow(side_m, 4) / (0.03 * 0.03) * pow(cos(0.1 * i * rad_per_deg) * sinc, 2);
        fprintf(file, "%.10f,%.10f,%.10f,0,%.10g\n", 10 * log10(m2), 10 * log10(m2) - 1, 1e-9 * hz, 0.1 * i);
    }
    GivenSignature *given = opened(file);
    double          worst_db = 0;
    for (double az = -2; az <= 2; az += 0.013) {
        const double x = 2 * pi_rad * side_m / 0.03 * sin(az * rad_per_deg), sinc = fabs(x) > 1e-9 ? sin(x) / x : 1;
        const double m2 = 4 * pi_rad * pow(side_m, 4) / (0.03 * 0.03) * pow(cos(az * rad_per_deg) * sinc, 2);
        const ScatterMatrix s = field_at_look(given, az, 0, hz);
        worst_db = fmax(worst_db, fabs(rcs_dbsm(s.vv) - 10 * log10(m2)));
        CHECK_NEAR(rcs_dbsm(s.hh), rcs_dbsm(s.vv) - 1, 1e-9);
        CHECK(cimag(s.vv) == 0);
    }
    /* 20 / ln 10 (1 / sin^2 x - 1 / x^2), greatest at the end, and 1 % for cos^2 */
    const double end = 2 * pi_rad * 10 * sin(2 * rad_per_deg), step = 2 * pi_rad * 10 * 0.1 * rad_per_deg;
    const double bound_db = 1.01 * 20 / log(10) * (1 / pow(sin(end), 2) - 1 / (end * end)) * step * step / 8;
    print_message("a plate's main lobe in rows of dBsm: %.4f dB (bound %.4f)\n", worst_db, bound_db);
    CHECK(worst_db < bound_db);
    /* half way in decibels, not in m2: 0.05 degrees between the rows of 3.9 and 4.0 */
    const ScatterMatrix low = field_at_look(given, 3.9, 0, hz), high = field_at_look(given, 4.0, 0, hz),
                        middle = field_at_look(given, 3.95, 0, hz);
    CHECK_NEAR(rcs_dbsm(middle.vv), 0.5 * (rcs_dbsm(low.vv) + rcs_dbsm(high.vv)), 1e-9);
    given_signature_close(given);
}

/* Two scatterers against their sum on paper, far and near, over frequency; and their centres are that sum. */
static void scatterers_add_up(void **state)
{
    (void)state;
    FILE *file = begin("two.csv");
    fputs("x_m,y_m,z_m,hh_dbsm,vv_dbsm,hv_dbsm,vv_deg,az_deg,az_width_deg,el_deg,el_width_deg\n"
          "2,0.5,-1,10,10,,0,,,,\n-2,-0.5,-0.2,3,7,-5,90,10,40,0,60\n",
          file);
    GivenSignature *given = opened(file);
    Centres         centres = {0};
    for (double ghz = 9; ghz <= 95; ghz += 4.3)
        for (double az = -60; az <= 60; az += 7) {
            const double k = 2 * pi_rad * ghz * 1e9 / 299792458.0, el = 11, range_m = 700;
            for (int near = 0; near < 2; near++) {
                const double   u[3] = {cos(az * rad_per_deg) * cos(el * rad_per_deg),
                                       sin(az * rad_per_deg) * cos(el * rad_per_deg), -sin(el * rad_per_deg)};
                const double   p[2][3] = {{2, 0.5, -1}, {-2, -0.5, -0.2}};
                double complex want[2];
                for (int i = 0; i < 2; i++) {
                    long double square = 0;
                    for (int c = 0; c < 3; c++) square += powl((long double)u[c] * range_m - p[i][c], 2);
                    const double path_m = near ? 2 * (double)(sqrtl(square) - range_m) : -2 * v3_dot(u, p[i]);
                    want[i] = sqrt((i ? pow(10, 0.7) : 10) / (4 * pi_rad)) *
                              cexp(I * (i ? 0.5 * pi_rad : 0) - I * k * path_m);
                }
                const bool           both = az >= -10 && az <= 30;
                const ScatterAntenna antenna = antenna_at(az, el, near ? range_m : INFINITY);
                ScatterMatrix        s;
                CHECK(given_signature_knows(given, &antenna, ghz * 1e9));
                given_signature_field(&s, given, &antenna, ghz * 1e9);
                CHECK(cabs(s.vv - want[0] - (both ? want[1] : 0)) < 1e-8);
                CHECK((cabs(s.hv) > 0) == both && s.hv == s.vh);
                CHECK(given_signature_centres(&centres, given, &antenna, ghz * 1e9) == STATUS_OK);
                CHECK(centres.count == (both ? 2 : 1) && centres.centre[0].part == -1);
                CHECK(cabs(sum_of(&centres, k) - s.vv) < 1e-9);
            }
        }
    centres_free(&centres);
    given_signature_close(given);
}

/* What the program computes for a sphere, written as a grid and read back: the same within what lies between rows. */
static void a_computed_sphere_comes_back(void **state)
{
    (void)state;
    RadarStage stage;
    FILE      *file = begin("rcs.csv");
    stage_open(&stage, "sphere:0.5", 10e9);
    fputs(
        "az_deg,el_deg,f_ghz,hh_dbsm,hv_dbsm,vh_dbsm,vv_dbsm,hh_re_m,hh_im_m,hv_re_m,hv_im_m,vh_re_m,vh_im_m,vv_re_m,vv_im_m\n",
        file);
    for (int az = 0; az <= 12; az += 4)
        for (int el = 0; el <= 10; el += 10) {
            const ScatterMatrix s = stage_look(&stage, az, el, INFINITY);
            fprintf(file, "%d,%d,10,%.4f,,,%.4f,%.9g,%.9g,0,0,0,0,%.9g,%.9g\n", az, el, rcs_dbsm(s.hh), rcs_dbsm(s.vv),
                    creal(s.hh), cimag(s.hh), creal(s.vv), cimag(s.vv));
        }
    GivenSignature *given = opened(file);
    for (double az = 0; az <= 12; az += 1.7) {
        const ScatterMatrix s = field_at_look(given, az, 3, 10e9);
        CHECK_NEAR(rcs_dbsm(s.hh), 10 * log10(pi_rad * 0.25), 0.1); /* ka 105: pi a^2 within the grid's error */
        CHECK_NEAR(rcs_dbsm(s.vv), 10 * log10(pi_rad * 0.25), 0.1);
    }
    given_signature_close(given);
    stage_close(&stage);
}

static void a_table_ends_somewhere(void **state)
{
    (void)state;
    FILE *file = begin("part.csv");
    fputs("az_deg,el_deg,f_ghz,hh_dbsm,vv_dbsm\n350,10,35,0,0\n352,10,35,0,0\n354,10,35,0,0\n", file);
    GivenSignature *given = opened(file);
    static const struct {
        double az_deg, el_deg, ghz;
        bool   known;
    } look[] = {{-10, 10, 35, true},    {-10.9, 10, 35, true}, {-11.1, 10, 35, false}, {354.9, 10, 35, true},
                {355.1, 10, 35, false}, {0, 10, 35, false},    {352, 12.4, 35, true},  {352, 12.6, 35, false},
                {352, 7.6, 35, true},   {352, 10, 36.7, true}, {352, 10, 36.8, false}, {352, 10, 33.3, true},
                {352, 10, 33.2, false}, {172, 10, 35, false}};
    for (size_t i = 0; i < sizeof look / sizeof *look; i++) {
        const ScatterAntenna antenna = antenna_at(look[i].az_deg, look[i].el_deg, 1000);
        CHECK(given_signature_knows(given, &antenna, look[i].ghz * 1e9) == look[i].known);
        ScatterMatrix s;
        given_signature_field(&s, given, &antenna, look[i].ghz * 1e9);
        CHECK((s.hh != 0) == look[i].known);
    }
    given_signature_close(given);
}

static void what_is_wrong_is_refused(void **state)
{
    (void)state;
    const char               head[] = "az_deg,el_deg,f_ghz,hh_dbsm,vv_dbsm\n";
    char                     text[512];
    static const char *const row[] = {"",
                                      "0,0,35,1\n",
                                      "0,0,35,x,1\n",
                                      "0,0,35,nan,1\n",
                                      "0,0,35,inf,1\n",
                                      "0,0,35,101,1\n",
                                      "0,0,0.01,1,1\n",
                                      "0,91,35,1,1\n",
                                      "721,0,35,1,1\n",
                                      "0,0,35,1,1\n0,0,35,1,1\n",
                                      "0,0,35,1,1\n1,1,35,1,1\n",
                                      "0,0,35,1,1\n200,0,35,1,1\n361,0,35,1,1\n",
                                      "0,0,35,1,1\n0,1,35,1,1\n1,0,35,1,1\n1,0,35,1,1\n"};
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        snprintf(text, sizeof text, "%s%s", head, row[i]);
        CHECK(refused(text) == STATUS_BAD_VALUE);
    }
    CHECK(refused("az_deg,el_deg,f_ghz,hh_dbsm,vv_dbsm\n0,0,35,1,1\n") ==
          STATUS_OK); /* and nothing else is wrong with them */
    CHECK(refused("az_deg,el_deg,f_ghz,hh_dbsm\n0,0,35,1\n") == STATUS_BAD_VALUE);
    CHECK(refused("az_deg,el_deg,hh_dbsm,vv_dbsm\n0,0,1,1\n") == STATUS_BAD_VALUE);
    CHECK(refused("az_deg,el_deg,f_ghz,hh_re_m,hh_im_m,vv_re_m\n0,0,35,1,1,1\n") == STATUS_BAD_VALUE);
    CHECK(refused("x_m,y_m,hh_dbsm,vv_dbsm\n0,0,1,1\n") == STATUS_BAD_VALUE);
    CHECK(refused("x_m,y_m,z_m,hh_dbsm,vv_dbsm\n0,1001,0,1,1\n") == STATUS_BAD_VALUE);
    CHECK(refused("x_m,y_m,z_m,hh_dbsm,vv_dbsm,az_width_deg\n0,1,0,1,1,-5\n") == STATUS_BAD_VALUE);
    CHECK(refused("x_m,y_m,z_m,hh_dbsm,vv_dbsm\n0,1,0,1,1\n") == STATUS_OK);
    CHECK(refused("") != STATUS_OK);
}

static void put(const char *name, const char *text)
{
    FILE *file = begin(name);
    fputs(text, file);
    CHECK(fclose(file) == 0);
}

static void the_closest_name_wins(void **state)
{
    (void)state;
    GivenList               *list = NULL;
    char                     path[128], kept[3][128];
    static const char *const name[3] = {"a.csv", "b.csv", "c.csv"};
    for (int i = 0; i < 3; i++) {
        char text[128];
        snprintf(text, sizeof text, "x_m,y_m,z_m,hh_dbsm,vv_dbsm\n0,0,0,%d,%d\n", 10 * i, 10 * i);
        put(name[i], text);
        strcpy(kept[i], table_path);
    }
    put("list.csv", "entity,signature\n1:1:7,c.csv\n*,a.csv\ntank,b.csv\n");
    strcpy(path, table_path);
    CHECK(given_list_open(&list, path) == STATUS_OK);
    const DisEntityId of[3] = {{1, 1, 8}, {1, 1, 8}, {1, 1, 7}};
    for (int i = 0; i < 3; i++) {
        const GivenSignature *given = given_list_find(list, of[i], i == 0 ? "truck" : "tank");
        CHECK(given);
        CHECK_NEAR(rcs_dbsm(field_at_look(given, 40, 5, 1e10).vv), 10 * i, 1e-9);
    }
    CHECK(!given_list_find(NULL, of[0], "tank"));
    given_list_close(list);
    put("list.csv", "entity,signature\ntank,none.csv\n");
    log_set_level((LogLevel)(LOG_ERROR + 1));
    list = NULL;
    CHECK(given_list_open(&list, path) != STATUS_OK && !list);
    put("list.csv", "entity,signature\n,a.csv\n");
    CHECK(given_list_open(&list, path) == STATUS_BAD_VALUE && !list);
    log_set_level(LOG_WARN);
    remove(path);
    for (int i = 0; i < 3; i++) remove(kept[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fields_between_rows_follow_the_phase),
        cmocka_unit_test(decibels_between_rows_are_linear),
        cmocka_unit_test(scatterers_add_up),
        cmocka_unit_test(a_computed_sphere_comes_back),
        cmocka_unit_test(a_table_ends_somewhere),
        cmocka_unit_test(what_is_wrong_is_refused),
        cmocka_unit_test(the_closest_name_wins),
    };
    return cmocka_run_group_tests(tests, open_folder, close_folder);
}
