/* The field of ray tubes against answers from elsewhere: Mie's series for spheres, closed forms of physical optics for plates,
 * discs, cylinders and dihedrals, the handbook's corner reflectors. Each figure reached is printed. */
#include "tests/render/radar_stage.h"

static const double x_hz = 10e9, w_hz = 94e9;

/* ---- spheres ------------------------------------------------------------------------------------------ */

typedef struct Series {
    int    count;
    double ka[1024];
    double complex s[1024]; /* over the radius */
} Series;

static bool read_mie(Series *out)
{
    static const char *const names[] = {"ka", "Es_over_Ei_times_R_over_a_re", "Es_over_Ei_times_R_over_a_im"};
    char  path[512];
    int   column[3];
    Table table;
    if (!reference_path(path, "radar/mie/mie_pec_backscatter.csv")) return false;
    CHECK(table_open(&table, path) == STATUS_OK && table_columns(column, &table, names, 3, "test"));
    out->count = 0;
    for (int r = 0; r < table.rows; r++) {
        double x[3];
        for (int c = 0; c < 3; c++) CHECK(text_to_double(&x[c], table_text(&table, r, column[c])));
        if (x[0] < 25 || x[0] > 900 || out->count == 1024) continue;
        out->ka[out->count] = x[0];
        out->s[out->count++] = CMPLX(x[1], x[2]);
    }
    table_close(&table);
    return true;
}

static double ray=128;/* Radius for the frequency and a given ka; worst error in dB and degrees over looks. */
static void sphere_error(double *db, double *deg, double ka, double complex want, double rays, double frequency_hz)
{
    const double radius_m = ka * light_mps / (2 * pi_rad * frequency_hz);
    char         name[64];
    RadarStage   s;
    snprintf(name, sizeof name, "sphere:%.12g", radius_m);
    stage_open(&s, name, frequency_hz);
    s.config.rays_per_wavelength = rays;
    s.config.rays_per_radius=ray;*db = *deg = 0;
    for (int look = 0; look < 3; look++) {
        const ScatterMatrix m = stage_look(&s, 20 + 50 * look, 10 * look, look == 2 ? 5000 : INFINITY);
        const double complex got[2] = {m.hh / radius_m, m.vv / radius_m};
        for (int p = 0; p < 2; p++) {
            *db = fmax(*db, fabs(2 * decibels(cabs(got[p]) / cabs(want))));
            *deg = fmax(*deg, fabs(phase_deg(got[p], want)));
        }
        CHECK(cabs(m.hv) < 0.01 * cabs(m.hh) && cabs(m.vh) < 0.01 * cabs(m.hh));
    }
    stage_close(&s);
}

static void spheres_equal_mie(void **state)
{
    (void)state;
    static Series mie;
    if (!read_mie(&mie)) skip();
    double rpr[4]={0.001,64,128,256};for(int r=0;r<4;r++) for (int i = 0; i < mie.count; i += mie.count / 8) {ray=rpr[r];
        double db, deg;
        sphere_error(&db, &deg, mie.ka[i], mie.s[i], 1, w_hz);
        printf("%g sphere ka %.4g, 1 ray a wavelength: %.3f dB, %.2f deg\n", ray,mie.ka[i], db, deg);
    }
}

/* ---- plates ------------------------------------------------------------------------------------------- */

static void plate_has_its_pattern(void **state)
{
    (void)state;
    RadarStage   s;
    const double a_m = 0.3, k = 2 * pi_rad * x_hz / light_mps, peak = 4 * pi_rad * pow(a_m, 4) * pow(k / (2 * pi_rad), 2);
    double       worst = 0;
    stage_open(&s, "plate:0.3x0.3", x_hz);
    for (double az = 0; az <= 60; az += 0.5) {
        const double x = k * a_m * sin(az * rad_per_deg), shape = cos(az * rad_per_deg) * (x > 0 ? sin(x) / x : 1);
        const double want = peak * shape * shape;
        const ScatterMatrix m = stage_look(&s, az, 0, INFINITY);
        const double hh = 4 * pi_rad * pow(cabs(m.hh), 2), vv = 4 * pi_rad * pow(cabs(m.vv), 2);
        const double off = fmax(fabs(sqrt(hh / peak) - fabs(shape)), fabs(sqrt(vv / peak) - fabs(shape)));
        worst = fmax(worst, off);
        if (az == 0) printf("plate peak: hh %.4f vv %.4f dB\n", decibels(hh / want), decibels(vv / want));
    }
    printf("plate 10 wavelengths wide: amplitude within %.1f dB of the peak\n", 2 * decibels(worst));
    stage_close(&s);
}

/* ---- corner reflectors -------------------------------------------------------------------------------- */

static void show(const char *what, RadarStage *s, double az, double el, double want)
{
    for (int last = 0; last < 2; last++)
        for (int r = 1; r <= 8; r *= 2) {
            s->config.last_only = last, s->config.rays_per_wavelength = r;
            const ScatterMatrix m = stage_look(s, az, el, INFINITY);
            printf("%s %s %d rays: hh %.3f vv %.3f dB, hv %.1f dB, hh to vv %.2f deg\n", what, last ? "last" : "all", r,
                   decibels(4 * pi_rad * pow(cabs(m.hh), 2) / want), decibels(4 * pi_rad * pow(cabs(m.vv), 2) / want),
                   2 * decibels(cabs(m.hv) / cabs(m.hh)), phase_deg(m.hh, m.vv));
        }
}

static void corners(void **state)
{
    (void)state;
    RadarStage   s;
    const double lambda = light_mps / x_hz, el = atan(sqrt(0.5)) / rad_per_deg;
    stage_open(&s, "dihedral:0.3x0.3", x_hz);
    show("dihedral", &s, 0, 0, 8 * pi_rad * pow(0.3, 4) / pow(lambda, 2));
    stage_close(&s);
    stage_open(&s, "trihedral:0.45", x_hz);
    show("trihedral", &s, 45, el, 4 * pi_rad * pow(0.45, 4) / (3 * pow(lambda, 2)));
    stage_close(&s);
    stage_open(&s, "corner:0.45", x_hz);
    show("corner", &s, 45, el, 12 * pi_rad * pow(0.45, 4) / pow(lambda, 2));
    stage_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plate_has_its_pattern), cmocka_unit_test(corners), cmocka_unit_test(spheres_equal_mie),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
