/* The field of ray tubes against answers from elsewhere: Mie's series for spheres, closed forms of physical optics
 * for plates, discs and cylinders, the handbook's corner reflectors. Each figure reached is printed. labels: physics */
#include "tests/render/radar_stage.h"

static const double x_hz = 10e9, w_hz = 94e9;

static double sigma(double complex s) { return 4 * pi_rad * (creal(s) * creal(s) + cimag(s) * cimag(s)); }

/* A table of reference data; false, and said, when absent. */
static bool open_reference(Table *table, int *column, const char *name, const char *const *names, int count)
{
    char path[512];
    if (!reference_path(path, name)) return false;
    CHECK(table_open(table, path) == STATUS_OK && table_columns(column, table, names, count, "test"));
    return true;
}

static void read_row(double *x, const Table *table, int row, const int *column, int count)
{
    for (int c = 0; c < count; c++) CHECK(text_to_double(&x[c], table_text(table, row, column[c])));
}

/* ---- spheres ------------------------------------------------------------------------------------------ */

/* Worst error over looks, of a sphere of this ka at 94 GHz, in dB and degrees. */
static void sphere_error(double *db, double *deg, double ka, double complex want)
{
    const double radius_m = ka * light_mps / (2 * pi_rad * w_hz);
    char         name[64];
    RadarStage   s;
    snprintf(name, sizeof name, "sphere:%.12g", radius_m);
    stage_open(&s, name, w_hz);
    *db = *deg = 0;
    for (int look = 0; look < 2; look++) {
        const ScatterMatrix  m = stage_look(&s, 20 + 50 * look, 10 * look, look == 1 ? 5000 : INFINITY);
        const double complex got[2] = {m.hh / radius_m, m.vv / radius_m};
        for (int p = 0; p < 2; p++) {
            *db = fmax(*db, fabs(20 * log10(cabs(got[p]) / cabs(want))));
            *deg = fmax(*deg, fabs(phase_deg(got[p], want)));
        }
        CHECK(cabs(m.hv) < 0.001 * cabs(m.hh) && cabs(m.vh) < 0.001 * cabs(m.hh));
    }
    stage_close(&s);
}

static void spheres_equal_mie(void **state)
{
    (void)state;
    static const char *const names[] = {"ka", "Es_over_Ei_times_R_over_a_re", "Es_over_Ei_times_R_over_a_im"};
    Table                    table;
    int                      column[3], seen = 0;
    if (!open_reference(&table, column, "radar/mie/mie_pec_backscatter.csv", names, 3)) skip();
    for (int r = 0; r < table.rows; r++) {
        double x[3], db, deg;
        read_row(x, &table, r, column, 3);
        if (!(x[0] >= 30 && x[0] < 1000)) continue;
        sphere_error(&db, &deg, x[0], CMPLX(x[1], x[2]));
        printf("sphere ka %.4g: %.3f dB, %.2f deg\n", x[0], db, deg);
        CHECK(db <= (x[0] <= 100 ? 0.3 : 0.1) && deg <= 5);
        seen++;
    }
    CHECK(seen >= 8);
    table_close(&table);
}

/* ---- plates, discs, cylinders ------------------------------------------------------------------------- */

typedef struct Pattern {
    double peak, level_db, off_db; /* worst amplitude error, over the peak's; worst where the form is above -40 dB */
} Pattern;

static void compare(Pattern *p, const ScatterMatrix *m, double want)
{
    const double got[2] = {sigma(m->hh), sigma(m->vv)};
    for (int q = 0; q < 2; q++) {
        p->level_db = fmax(p->level_db, 20 * log10(fabs(sqrt(got[q] / p->peak) - sqrt(want / p->peak)) + 1e-10));
        if (want > 1e-4 * p->peak) p->off_db = fmax(p->off_db, fabs(decibels(got[q] / want)));
    }
}

/* The field of the last look, of its first part alone. */
static ScatterMatrix without_ends(RadarStage *s)
{
    ScatterMatrix m;
    for (size_t i = 0; i < s->hits.count; i++)
        for (int c = 0; c < 8 && s->hits.part[i] != 0; c++) s->hits.amplitude[c][i] = 0;
    CHECK(field_at(&m, s->config.frequency_hz, &s->hits, s->pool) == STATUS_OK);
    return m;
}

/* The table's angles are from the normal in azimuth. Of the cylinder: from broadside towards its axis. */
static void patterns_equal_the_closed_forms(void **state)
{
    (void)state;
    static const char *const names[] = {"f_hz", "theta_from_normal_deg", "plate_PO_m2", "disc_PO_m2", "cylinder_PO_m2"};
    /* the closed form of the cylinder is itself an approximation, of order 1/(8 k r), kr = 15.7 */
    static const struct {
        const char *shape;
        int         column;
        double      off_db, level_db;
    } cases[] = {{"plate:0.3x0.3", 2, 0.05, -75}, {"disc:0.15", 3, 0.2, -58}, {"cylinder:0.075x0.3", 4, 0.3, -50}};
    Table table;
    int   column[5];
    if (!open_reference(&table, column, "radar/closed_form/po_patterns.csv", names, 5)) skip();
    for (int k = 0; k < 3; k++) {
        RadarStage s;
        Pattern    p = {.level_db = -INFINITY};
        double     f_hz = 0;
        for (int r = 0; r < table.rows; r++) {
            double x[5];
            read_row(x, &table, r, column, 5);
            if (f_hz == 0) {
                f_hz = x[0], p.peak = x[cases[k].column];
                stage_open(&s, cases[k].shape, f_hz);
            }
            if (x[0] != f_hz || x[1] > 80 || r % 6) continue;
            ScatterMatrix m = k < 2 ? stage_look(&s, x[1], 0, INFINITY) : stage_look(&s, 17, x[1], INFINITY);
            if (k == 2) m = without_ends(&s);
            compare(&p, &m, x[cases[k].column]);
            if (r == 0) printf("%s: peak off by %.4f dB\n", cases[k].shape, decibels(sigma(m.hh) / p.peak));
        }
        printf("%s: within %.2f dB down to -40 dB of the peak, amplitude %.1f dB below the peak's everywhere\n",
               cases[k].shape, p.off_db, p.level_db);
        CHECK(p.off_db <= cases[k].off_db && p.level_db <= cases[k].level_db);
        stage_close(&s);
    }
    table_close(&table);
}

/* ---- corner reflectors -------------------------------------------------------------------------------- */

static void dihedral_turns_one_polarisation(void **state)
{
    (void)state;
    RadarStage   s;
    const double want = 8 * pi_rad * pow(0.3, 4) * pow(x_hz / light_mps, 2);
    stage_open(&s, "dihedral:0.3x0.3", x_hz);
    for (int last = 0; last < 2; last++) {
        s.config.last_only = last;
        const ScatterMatrix m = stage_look(&s, 0, 0, INFINITY);
        const double hh = decibels(sigma(m.hh) / want), vv = decibels(sigma(m.vv) / want), deg = phase_deg(m.hh, m.vv);
        printf("dihedral, %s: hh %.3f, vv %.3f dB, phase %.2f deg apart\n", last ? "last mirror" : "all", hh, vv,
               fabs(deg));
        CHECK(fabs(hh) <= (last ? 0.05 : 0.15) && fabs(vv) <= (last ? 0.05 : 0.15));
        CHECK(fabs(fabs(deg) - 180) < 1);
        CHECK(cabs(m.hv) < 1e-4 * cabs(m.hh));
    }
    stage_close(&s);

    /* rolled by 45 degrees about the line of sight */
    s = (RadarStage){0};
    CHECK(radar_shape_build(&s.model, "dihedral:0.3x0.3", 1e-4) == STATUS_OK);
    for (int v = 0; v < s.model.vertex_count; v++) {
        double *p = s.model.vertex[v], y = p[1], z = p[2], c = sqrt(0.5);
        float  *n = s.model.normal[v], ny = n[1], nz = n[2];
        p[1] = c * (y - z), p[2] = c * (y + z);
        n[1] = (float)c * (ny - nz), n[2] = (float)c * (ny + nz);
    }
    CHECK(model_measure(&s.model) == STATUS_OK);
    stage_target(&s, x_hz);
    s.config.last_only = true;
    const ScatterMatrix m = stage_look(&s, 0, 0, INFINITY);
    const double        cross = decibels(sigma(m.hv) / want);
    const double        co = fmax(decibels(sigma(m.hh) / want), decibels(sigma(m.vv) / want));
    printf("dihedral rolled by 45 deg: cross %.3f dB, co %.1f dB, of the peak\n", cross, co);
    CHECK(fabs(cross) <= 0.05 && co < -43);
    CHECK_NEAR(decibels(sigma(m.vh) / want), cross, 0.01);
    stage_close(&s);
}

/* By the handbook where only the last mirror radiates; with every mirror by a run of four times as many tubes. */
static void trihedrals_equal_the_handbook(void **state)
{
    (void)state;
    static const struct {
        const char *shape;
        double      factor;
    } cases[] = {{"trihedral:0.45", 4 / 3.0}, {"corner:0.45", 12}};
    const double el_deg = atan(sqrt(0.5)) / rad_per_deg;
    for (int k = 0; k < 2; k++) {
        RadarStage   s;
        const double want = cases[k].factor * pi_rad * pow(0.45, 4) * pow(x_hz / light_mps, 2);
        stage_open(&s, cases[k].shape, x_hz);
        s.config.last_only = true;
        const ScatterMatrix last = stage_look(&s, 45, el_deg, INFINITY);
        s.config.last_only = false;
        const ScatterMatrix all = stage_look(&s, 45, el_deg, INFINITY);
        s.config.rays_per_radius *= 4;
        const ScatterMatrix fine = stage_look(&s, 45, el_deg, INFINITY);
        printf("%s: last mirror hh %.3f, vv %.3f dB; all %.3f, %.3f dB; with 16 times the tubes %.3f, %.3f dB\n",
               cases[k].shape, decibels(sigma(last.hh) / want), decibels(sigma(last.vv) / want),
               decibels(sigma(all.hh) / want), decibels(sigma(all.vv) / want), decibels(sigma(fine.hh) / want),
               decibels(sigma(fine.vv) / want));
        CHECK_NEAR(decibels(sigma(last.hh) / want), 0, 0.1);
        CHECK_NEAR(decibels(sigma(last.vv) / want), 0, 0.1);
        CHECK_NEAR(decibels(sigma(all.hh) / sigma(fine.hh)), 0, 0.1);
        CHECK_NEAR(decibels(sigma(all.vv) / sigma(fine.vv)), 0, 0.1);
        stage_close(&s);
    }
}

/* ---- surfaces that are no metal ------------------------------------------------------------------------ */

/* At normal incidence a plate's field is that of metal times its reflection; a matched one returns nothing. */
static void a_plate_returns_what_its_surface_reflects(void **state)
{
    (void)state;
    RadarStage           s;
    RadarMaterial        row = {.name = "metal",
                                .kind = RADAR_SLAB,
                                .thick_m = 0.004,
                                .rough_m = 0.0002,
                                .points = 1,
                                .frequency_hz = {1e10},
                                .e1 = {6},
                                .e2 = {0.05}};
    const RadarMaterials materials = {1, &row};
    stage_open(&s, "plate:0.3x0.2", x_hz);
    const ScatterMatrix metal = stage_look(&s, 0, 0, INFINITY);
    s.target->materials = &materials;
    for (int kind = RADAR_HALF_SPACE; kind < RADAR_SURFACE_KINDS; kind++) {
        RadarSurface   surface;
        double complex te, tm;
        row.kind = (RadarSurfaceKind)kind;
        radar_surface(&surface, &row, x_hz);
        fresnel_surface(&te, &tm, &surface, 2 * pi_rad * x_hz / light_mps, 1);
        const ScatterMatrix m = stage_look(&s, 0, 0, INFINITY);
        CHECK(cabs(m.hh / metal.hh + te) < 1e-6 && cabs(m.vv / metal.vv + te) < 1e-6);
    }
    row.kind = RADAR_HALF_SPACE, row.e1[0] = 1, row.e2[0] = 0, row.rough_m = 0;
    for (double az = 0; az < 80; az += 10) {
        const ScatterMatrix m = stage_look(&s, az, 20, INFINITY);
        CHECK(cabs(m.hh) + cabs(m.vv) + cabs(m.hv) < 1e-6 * cabs(metal.hh));
    }
    stage_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spheres_equal_mie),
        cmocka_unit_test(patterns_equal_the_closed_forms),
        cmocka_unit_test(dihedral_turns_one_polarisation),
        cmocka_unit_test(trihedrals_equal_the_handbook),
        cmocka_unit_test(a_plate_returns_what_its_surface_reflects),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
