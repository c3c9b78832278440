/* A channel's own spectral response: its file, black bodies seen through it against 30 digits, droplets, and the row of
 * etc/channels.csv that names it. labels: physics */
#include "tests/check.h"

#include "pitviper_channels.h"
#include "render/air/droplets_private.h"
#include "render/materials/planck.h"

static char folder[] = "/tmp/test_response_XXXXXX", path[64];

static int make_folder(void **state)
{
    (void)state;
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state)
{
    (void)state;
    return rmdir(folder);
}

static const char *write_file(const char *name, const char *text)
{
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    CHECK(file != NULL && fputs(text, file) >= 0 && fclose(file) == 0);
    return path;
}

static SpectralBand band_of(const char *text)
{
    SpectralResponse *r = NULL;
    CHECK(response_open(&r, write_file("r.csv", text)) == STATUS_OK);
    CHECK(remove(path) == 0);
    return (SpectralBand){r->at_m[0], r->at_m[r->points - 1], r};
}

static void close_band(SpectralBand *band) { response_close((SpectralResponse *)band->response); }

static const char *const triangle = "wavelength_um,response\n8,0\n10,1\n12,0\n";
static const char *const filter = "# cooled, with its filter\nresponse,wavelength_um\n0,3.6\n1,3.8\n1,4.7\n0,4.9\n";
static const char *const silicon = "wavelength_um,response\n0.6,0\n0.7,1\n0.8,0.5\n";

/* Planck's law times straight lines, integrated by mpmath 1.3 with 30 digits (quad, nine pieces an interval): radiance
 * and its slope. */
static void black_bodies_through_it(void **state)
{
    (void)state;
    static const struct {
        const char *const *text;
        double             temp_k, w_m2_sr, per_k;
    } row[] = {
        {&triangle, 180, 0.79996391302432, 0.035073643324526}, {&triangle, 300, 19.550490581936, 0.31749783212396},
        {&triangle, 1000, 770.68955093095, 1.4773340152959},   {&filter, 180, 0.0009464210595829, 9.3256237692431e-5},
        {&filter, 300, 1.2609965599074, 0.046099026099162},    {&filter, 1000, 3317.163170024, 11.777574201582},
        {&silicon, 1000, 0.2001130496021, 0.0038452565293807}, {&silicon, 5772, 2524477.2525801, 1591.1654361906},
    };
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        SpectralBand band = band_of(*row[i].text);
        double       per_k;
        CHECK_NEAR(planck_seen(&band, row[i].temp_k, &per_k) / row[i].w_m2_sr, 1, 1e-8);
        CHECK_NEAR(per_k / row[i].per_k, 1, 1e-8);
        CHECK_NEAR(planck_seen_inverse(&band, row[i].w_m2_sr) / row[i].temp_k, 1, 1e-8);
        if (row[i].temp_k >= 180 && row[i].temp_k <= 1500) {
            PlanckTable *table = NULL;
            CHECK(planck_table_seen(&table, &band) == STATUS_OK);
            CHECK_NEAR(planck_table_radiance(table, row[i].temp_k) / row[i].w_m2_sr, 1, 2e-8);
            CHECK_NEAR(planck_table_temp(table, row[i].w_m2_sr), row[i].temp_k, 1e-3);
            /* beyond it, hot and cold */
            CHECK(planck_table_radiance(table, 2000) == planck_seen(&band, 2000, NULL));
            CHECK_NEAR(planck_table_temp(table, planck_seen(&band, 2500, NULL)), 2500, 1e-5);
            planck_table_destroy(table);
        }
        close_band(&band);
    }
}

/* A response of 1 throughout is the band without one; a finer file of the same straight lines is the same. */
static void of_ones_it_is_the_band(void **state)
{
    (void)state;
    SpectralBand flat = band_of("wavelength_um,response\n3.4,1\n4.8,1\n"), coarse = band_of(triangle);
    char         text[16384];
    int          n = snprintf(text, sizeof text, "wavelength_um,response\n");
    for (int i = 0; i <= 400; i++)
        n += snprintf(text + n, sizeof text - (size_t)n, "%.4f,%.6f\n", 8 + 0.01 * i, 1 - fabs(0.01 * i - 2) / 2);
    SpectralBand fine = band_of(text);
    for (double temp_k = 180; temp_k < 1500; temp_k *= 1.4) {
        double slope, own;
        CHECK_NEAR(planck_seen(&flat, temp_k, &slope) / planck_band(3.4e-6, 4.8e-6, temp_k, &own), 1, 1e-8);
        CHECK_NEAR(slope / own, 1, 1e-8);
        CHECK_NEAR(planck_seen(&fine, temp_k, NULL) / planck_seen(&coarse, temp_k, NULL), 1, 1e-7);
    }
    CHECK(isnan(planck_seen(&flat, -1, NULL)) && isnan(planck_seen_inverse(&flat, 0)));
    close_band(&flat);
    close_band(&coarse);
    close_band(&fine);
}

static Status check_response(const char *text)
{
    SpectralResponse *r = NULL;
    const Status      status = response_open(&r, write_file("r.csv", text));
    CHECK((status == STATUS_OK) == (r != NULL));
    response_close(r);
    CHECK(remove(path) == 0);
    return status;
}

static void wrong_files_are_refused(void **state)
{
    (void)state;
    static const char *const wrong[] = {
        "",
        "wavelength_um,response\n",
        "wavelength_um,response\n8,1\n",      /* one point */
        "wavelength_um\n8\n9\n",              /* a column is missing */
        "wavelength_um,response\n8,0\n8,1\n", /* not rising */
        "wavelength_um,response\n9,0\n8,1\n",
        "wavelength_um,response\n8,0\n9,1.2\n", /* beyond 1 */
        "wavelength_um,response\n8,-0.1\n9,1\n",
        "wavelength_um,response\n8,0\n9,0.8\n", /* with the optics in it */
        "wavelength_um,response\n8,0\n9,0\n",
        "wavelength_um,response\n8,nan\n9,1\n",
        "wavelength_um,response\n0.2,0\n9,1\n", /* beyond what tables have */
        "wavelength_um,response\n8000,0\n9000,1\n",
        "wavelength_um,response\n8,0\n9,1,1\n9,",
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) CHECK(check_response(wrong[i]) == STATUS_BAD_VALUE);
    CHECK(check_response(triangle) == STATUS_OK);
    SpectralResponse *r = NULL;
    CHECK(response_open(&r, "/nowhere/r.csv") == STATUS_IO && r == NULL);
    /* as many points as it may have, each far from the next or near it, have room for their nodes */
    char text[16384];
    int  n = snprintf(text, sizeof text, "wavelength_um,response\n");
    for (int i = 0; i < response_points_most; i++)
        n += snprintf(text + n, sizeof text - (size_t)n, "%.7f,1\n", 0.3 * pow(100, i / (response_points_most - 1.0)));
    CHECK(check_response(text) == STATUS_OK);
    n += snprintf(text + n, sizeof text - (size_t)n, "30.1,1\n");
    CHECK(check_response(text) == STATUS_BAD_VALUE);
}

static Status check_rows(const char *more)
{
    char text[1024];
    snprintf(
        text, sizeof text,
        "name,low_um,high_um,kind,place,response\nb,0.4,0.5,reflective,b,\ng,0.5,0.6,reflective,g,\n"
        "r,0.6,0.7,reflective,r,\npan,0.4,0.7,reflective,pan,\nnir,0.7,1.1,reflective,nir,\nmwir,3.4,4.8,both,mwir,\n"
        "lwir,8,12,emissive,lwir,%s\n",
        more);
    const Status status = channels_check(write_file("channels.csv", text));
    CHECK(remove(path) == 0);
    return status;
}

static void a_row_names_it(void **state)
{
    (void)state;
    char file[64];
    write_file("filter.csv", filter);
    snprintf(file, sizeof file, "%s", path);
    CHECK(check_rows("") == STATUS_OK);
    CHECK(check_rows("\ncooled,3.6,4.9,both,mwir,filter.csv") == STATUS_OK);
    CHECK(check_rows("\ncooled,3.6,4.8,both,mwir,filter.csv") == STATUS_BAD_VALUE); /* not its ends */
    CHECK(check_rows("\ncooled,3.6,4.9,both,mwir,nobodys.csv") == STATUS_IO);
    CHECK(check_rows("\ncooled,3.6,4.9,both,mwir,../filter.csv") == STATUS_BAD_VALUE);
    CHECK(check_rows("\ncooled,3.6,4.9,both,mwir,filter") == STATUS_BAD_VALUE);
    /* a standard channel's tables are those of all between its edges */
    CHECK(check_rows("filter.csv") == STATUS_BAD_VALUE);
    CHECK(remove(file) == 0);
}

/* Fog between 8 and 12 um is the mean over the band; through a response, that of the wavelengths it sees: where it sees
 * 8 to 8.1 um and 11.9 to 12 um alike, the mean of the two ends. */
static void droplets_are_seen_through_it(void **state)
{
    (void)state;
    channels_standard();
    const SpectralChannel *lwir = channel_in(SPECTRAL_LWIR);
    SpectralChannel        own = *lwir;
    SpectralBand           end[2] = {band_of("wavelength_um,response\n8,1\n8.001,1\n"),
                                     band_of("wavelength_um,response\n11.999,1\n12,1\n")};
    SpectralBand both = band_of("wavelength_um,response\n8,1\n8.001,1\n8.0010001,0\n11.9989999,0\n11.999,1\n12,1\n");
    DropletRow   row[3];
    for (int i = 0; i < 3; i++) {
        own.response = i < 2 ? end[i].response : both.response;
        channel_choose(&own);
        row[i] = droplet_optics(droplet_radiation, SPECTRAL_LWIR);
    }
    channels_standard();
    CHECK(fabs(row[0].extinction / row[1].extinction - 1) > 0.2);
    CHECK_NEAR(row[2].extinction, 0.5 * (row[0].extinction + row[1].extinction), 1e-3 * row[2].extinction);
    close_band(&end[0]);
    close_band(&end[1]);
    close_band(&both);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(black_bodies_through_it),      cmocka_unit_test(of_ones_it_is_the_band),
        cmocka_unit_test(wrong_files_are_refused),      cmocka_unit_test(a_row_names_it),
        cmocka_unit_test(droplets_are_seen_through_it),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
