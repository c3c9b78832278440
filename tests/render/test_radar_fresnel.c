/* Fresnel reflection against the reference table (half space and slab), and identities: limits, energy, a coating
 * that is air or metal, and the roughness factor. labels: physics */
#include "tests/check.h"

#include "render/scattering/radar_surfaces.h"

static double worst(double complex got, double complex want, double so_far) { return fmax(so_far, cabs(got - want)); }

static void half_spaces_and_slabs_equal_the_table(void **state)
{
    (void)state;
    static const char *const names[] = {"f_hz",        "eps_re",      "eps_im(e=re-j*im)", "incidence_deg",
                                        "gamma_TE_re", "gamma_TE_im", "gamma_TM_re",       "gamma_TM_im",
                                        "slab_d_m",    "slabR_TE_re", "slabR_TE_im",       "slabR_TM_re",
                                        "slabR_TM_im", "slabT2_TE",   "slabT2_TM"};
    enum { columns = sizeof names / sizeof *names };
    char   path[512];
    int    column[columns];
    double space = 0, slab = 0, through = 0;
    Table  table;
    if (!reference_path(path, "radar/fresnel/fresnel.csv")) skip();
    CHECK(table_open(&table, path) == STATUS_OK && table_columns(column, &table, names, columns, "test"));
    for (int r = 0; r < table.rows; r++) {
        double         x[columns];
        double complex te, tm, tte, ttm;
        for (int c = 0; c < columns; c++) CHECK(text_to_double(&x[c], table_text(&table, r, column[c])));
        const double cosine = cos(x[3] * rad_per_deg), k = 2 * pi_rad * x[0] / 299792458.0;
        fresnel_half_space(&te, &tm, CMPLX(x[1], -x[2]), cosine);
        space = worst(te, CMPLX(x[4], x[5]), worst(tm, CMPLX(x[6], x[7]), space));
        fresnel_slab(&te, &tm, &tte, &ttm, &(RadarSurface){.eps = CMPLX(x[1], -x[2]), .thick_m = x[8]}, k, cosine);
        slab = worst(te, CMPLX(x[9], x[10]), worst(tm, CMPLX(x[11], x[12]), slab));
        through = worst(pow(cabs(tte), 2), x[13], worst(pow(cabs(ttm), 2), x[14], through));
    }
    printf("%d rows: half space within %.1e, slab %.1e, what passes %.1e\n", table.rows, space, slab, through);
    CHECK(table.rows > 50 && space <= 1e-11 && slab <= 1e-11 && through <= 1e-11);
    table_close(&table);
}

static void limits_hold(void **state)
{
    (void)state;
    double complex te, tm, te2, tm2, tte, ttm;
    for (int i = 0; i < 200; i++) {
        const double         cosine = random_uniform(1, 2, 3, (uint64_t)i) * 0.98 + 0.02, k = 200 + 10 * i;
        const double         thick_m = 1e-5 * (1 + i);
        const double complex eps = CMPLX(1 + 8 * random_uniform(1, 2, 4, (uint64_t)i), 0);
        /* no loss: what is not reflected passes, and a coating returns all */
        fresnel_slab(&te, &tm, &tte, &ttm, &(RadarSurface){.eps = eps, .thick_m = thick_m}, k, cosine);
        CHECK_NEAR(pow(cabs(te), 2) + pow(cabs(tte), 2), 1, 1e-12);
        CHECK_NEAR(pow(cabs(tm), 2) + pow(cabs(ttm), 2), 1, 1e-12);
        fresnel_coated(&te, &tm, eps, thick_m, k, cosine);
        CHECK_NEAR(cabs(te), 1, 1e-12);
        CHECK_NEAR(cabs(tm), 1, 1e-12);
        /* a coating of air: the wall behind, twice the depth away */
        fresnel_coated(&te, &tm, 1, thick_m, k, cosine);
        const double complex twice = cexp(-2 * I * k * thick_m * cosine);
        CHECK(cabs(te + twice) < 1e-12 && cabs(tm - twice) < 1e-12);
        /* a thick lossy coating or slab is a half space; a vanishing one is the wall, or nothing */
        fresnel_half_space(&te2, &tm2, eps - 2 * I, cosine);
        fresnel_coated(&te, &tm, eps - 2 * I, 1, k, cosine);
        CHECK(cabs(te - te2) < 1e-12 && cabs(tm - tm2) < 1e-12);
        fresnel_slab(&te, &tm, NULL, NULL, &(RadarSurface){.eps = eps - 2 * I, .thick_m = 1}, k, cosine);
        CHECK(cabs(te - te2) < 1e-12 && cabs(tm - tm2) < 1e-12);
        fresnel_coated(&te, &tm, eps, 1e-14, k, cosine);
        CHECK(cabs(te + 1) < 1e-8 && cabs(tm - 1) < 1e-8);
        /* a good conductor is near metal */
        fresnel_half_space(&te, &tm, 1 - 1e12 * I, cosine);
        CHECK(cabs(te + 1) < 1e-3 && cabs(tm - 1) < 1e-3);
        /* Brewster's angle: nothing in the plane */
        fresnel_half_space(&te, &tm, eps, 1 / sqrt(1 + creal(eps)));
        CHECK(cabs(tm) < 1e-12);
    }
}

/* By a boundary condition, not the formula: the fields of a coating met by a plane wave at right angles vanish on the
 * wall and are continuous at the face. Inside: a (exp(-j q z) - exp(j q (z - 2 d))). */
static void a_coating_keeps_the_boundary_conditions(void **state)
{
    (void)state;
    for (int i = 1; i < 50; i++) {
        const double complex eps = CMPLX(1 + 0.2 * i, -0.05 * i), n = csqrt(eps);
        const double         k = 2000, d = 2e-5 * i;
        double complex       te, tm;
        fresnel_coated(&te, &tm, eps, d, k, 1);
        /* E: 1 + r = a (1 - p), H: 1 - r = a n (1 + p), p = exp(-2 j k n d) */
        const double complex p = cexp(-2 * I * k * n * d), ratio = n * (1 + p) / (1 - p), r = (1 - ratio) / (1 + ratio);
        CHECK(cabs(te - r) < 1e-12 && cabs(tm + r) < 1e-12);
    }
}

static void roughness_costs_what_it_must(void **state)
{
    (void)state;
    /* 94 GHz, 0.1 mm rms, normal incidence: 0.67 dB of power; at 60 degrees a quarter of that */
    const double k = 2 * pi_rad * 94e9 / 299792458.0;
    CHECK_NEAR(-20 * log10(fresnel_rough(1e-4, k, 1)), 0.674, 1e-3);
    CHECK_NEAR(-20 * log10(fresnel_rough(1e-4, k, 0.5)), 0.674 / 4, 1e-3);
    double complex     te, tm;
    const RadarSurface metal = {.kind = RADAR_METAL, .rough_m = 1e-4};
    fresnel_surface(&te, &tm, &metal, k, 1);
    CHECK(te == -tm && creal(te) < 0);
    CHECK_NEAR(cabs(te), fresnel_rough(1e-4, k, 1), 1e-15);
}

/* Below 0 and without loss, as a plasma, nothing enters: all is mirrored, with the phase of a field that dies away
 * inwards, q = -j (1 - eps - cos^2)^0.5: te = (c - q) / (c + q), tm = (eps c - q) / (eps c + q). */
static void a_plasma_mirrors_all(void **state)
{
    (void)state;
    for (int i = 1; i < 10; i++) {
        const double         cosine = 0.1 * i, inside = sqrt(5 + 1 - cosine * cosine);
        const double complex q = CMPLX(0, -inside);
        double complex       te, tm;
        fresnel_half_space(&te, &tm, CMPLX(-5, 0.0), cosine);
        CHECK_NEAR(cabs(te - (cosine - q) / (cosine + q)), 0, 1e-12);
        CHECK_NEAR(cabs(tm - (-5 * cosine - q) / (-5 * cosine + q)), 0, 1e-12);
        CHECK_NEAR(cabs(te), 1, 1e-12);
        CHECK_NEAR(cabs(tm), 1, 1e-12);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(half_spaces_and_slabs_equal_the_table),
        cmocka_unit_test(limits_hold),
        cmocka_unit_test(a_coating_keeps_the_boundary_conditions),
        cmocka_unit_test(roughness_costs_what_it_must),
        cmocka_unit_test(a_plasma_mirrors_all),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
