/* The table of materials: what it must hold, what it must refuse, and a lobe that makes no light. labels: physics */
#include "tests/check.h"
#include "render/materials/materials.h"

#include <unistd.h>

static char last_error[512];

static void keep_error(void *user, LogLevel level, const char *line)
{
    (void)user;
    if (level == LOG_ERROR) snprintf(last_error, sizeof last_error, "%s", line);
}

static int listen(void **state)
{
    (void)state;
    last_error[0] = 0;
    log_set_sink(keep_error, NULL);
    return 0;
}

static int stop_listening(void **state)
{
    (void)state;
    log_set_sink(NULL, NULL);
    return 0;
}

static const char header[] = "name,rho_b,rho_g,rho_r,rho_pan,rho_nir,rho_mwir,rho_lwir,solar_absorptance,gloss,"
                             "roughness_rad,metal,radar_gamma,conductivity_w_mk,density_kg_m3,heat_capacity_j_kgk,"
                             "source\n";
static const char rows[] = "turf,0.04,0.09,0.06,0.0625,0.45,0.015,0.019,0.73,0,1,0,0.1,1,1700,1200,test\n"
                           "steel,0.2,0.2,0.3,0.25,0.35,0.3,0.2,0.8,0.5,0.2,1,0.02,45,7824,500,test\n";
static const char surfaces[] = "surface,material\ngrass,turf\ndry_grass,turf\ncrop,turf\nbare_soil,turf\n"
                               "ploughed,turf\ntrack,turf\nrock,turf\nscrub,turf\nwater,steel\n"
                               "forest_broadleaf,turf\nforest_conifer,turf\nbuilt,steel\nroad,steel\nsand,turf\n"
                               "snow,turf\nwetland,turf\n";

static Status open_texts(Materials *out, const char *table, const char *surface_table)
{
    char a[64], b[64];
    text_file(a, table);
    text_file(b, surface_table);
    const Status status = materials_open(out, a, b, NULL);
    remove(a);
    remove(b);
    return status;
}

static void reads_what_is_written(void **state)
{
    (void)state;
    char text[2048];
    snprintf(text, sizeof text, "# a comment\n%s%s", header, rows);
    Materials m;
    CHECK(open_texts(&m, text, surfaces) == STATUS_OK);
    CHECK(m.count == 3 && materials_find(&m, "none") == 0 && materials_find(&m, "turf") == 1);
    CHECK(materials_find(&m, "steel") == 2 && materials_find(&m, "Steel") == -1 && materials_find(&m, "") == -1);
    const Material *steel = &m.material[2];
    CHECK_NEAR(steel->rho[optical_channel_b], 0.2, 1e-7);
    CHECK_NEAR(steel->rho[optical_channel_r], 0.3, 1e-7);
    CHECK_NEAR(steel->rho[optical_channel_pan], 0.25, 1e-7);
    CHECK_NEAR(steel->rho[optical_channel_nir], 0.35, 1e-7);
    CHECK_NEAR(steel->rho_mwir, 0.3, 1e-7);
    CHECK(steel->conductivity_w_mk == 45 && steel->density_kg_m3 == 7824 && steel->heat_capacity_j_kgk == 500);
    CHECK_NEAR(steel->rho_lwir, 0.2, 1e-7);
    CHECK_NEAR(steel->gloss, 0.5, 1e-7);
    CHECK_NEAR(steel->roughness, 0.2, 1e-7);
    CHECK_NEAR(steel->radar_gamma, 0.02, 1e-7);
    CHECK(steel->metal == 1 && m.material[0].rho[0] == 0 && m.material[0].metal == 0);
    CHECK(m.surface[SURFACE_NONE] == 0 && m.surface[SURFACE_GRASS] == 1 && m.surface[SURFACE_WATER] == 2);
    CHECK_NEAR(m.ground_rho[optical_channel_pan], 0.0625, 1e-7); /* water is not ground */
    materials_close(&m);
    CHECK(m.material == NULL && m.count == 0);
    materials_close(&m);
    materials_close(NULL);
}

static void refuses_and_says_why(void **state)
{
    (void)state;
    static const struct {
        const char *rows, *surfaces, *said;
    } bad[] = {
        {"turf,0.04,0.09,0.06,1.06,0.4,0.015,0.019,0.73,0,1,0,0.1,1,1700,1200,t\n", surfaces,
         "rho_pan"}, /* more than all */
        {"turf,0.04,0.09,0.06,nan,0.4,0.015,0.019,0.73,0,1,0,0.1,1,1700,1200,t\n", surfaces, "rho_pan"},
        {"turf,0.04,0.09,0.06,,0.4,0.015,0.019,0.73,0,1,0,0.1,1,1700,1200,t\n", surfaces, "rho_pan"},
        {"turf,0,0,0,0,1.2,0,0,0,0,0,0,0,1,1700,1200,t\n", surfaces, "rho_nir"},
        {"turf,0,0,0,0,0,0,0,0,0,0,0,0,0,1700,1200,t\n", surfaces, "conductivity_w_mk"},
        {"turf,0,0,0,0,0,0,0,0,0,0,0,0,1,0.5,1200,t\n", surfaces, "density_kg_m3"},
        {"turf,0,0,0,0,0,0,0,0,0,0,0,0,1,1700,1e5,t\n", surfaces, "heat_capacity_j_kgk"},
        {"turf,0.04,0.09\n", surfaces, ""},                                 /* narrow row */
        {"none,0,0,0,0,0,0,0,0,0,0,0,0,1,1700,1200,t\n", surfaces, "none"}, /* row 0 is taken */
        {"turf,0,0,0,0,0,0,0,0,0,0,0,0,1,1700,1200,t\nturf,0,0,0,0,0,0,0,0,0,0,0,0,1,1700,1200,t\n", surfaces, "turf"},
        {"a_name_of_more_than_thirty_one_bytes,0,0,0,0,0,0,0,0,0,0,0,0,1,1700,1200,t\n", surfaces, "thirty"},
        {rows, "surface,material\ngrass,moss\n", "moss"},
        {rows, "surface,material\nlawn,turf\n", "lawn"},
        {rows, "surface,material\ngrass,turf\ngrass,turf\n", "grass"},
        {rows, "surface,material\ngrass,turf\n", "dry_grass"}, /* a class left out */
        {rows, "surface,cover\ngrass,turf\n", "material"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char text[2048];
        snprintf(text, sizeof text, "%s%s", header, bad[i].rows);
        Materials m = {.count = -7};
        last_error[0] = 0;
        const Status status = open_texts(&m, text, bad[i].surfaces);
        if (status == STATUS_OK || !strstr(last_error, bad[i].said) || !last_error[0])
            fail_msg("case %zu: status %s, said \"%s\", want \"%s\"", i, status_name(status), last_error, bad[i].said);
        CHECK(m.count == -7); /* untouched */
    }
    Materials m;
    CHECK(open_texts(&m, "name,rho_b\nturf,0.1\n", surfaces) == STATUS_BAD_VALUE);
    CHECK(materials_open(&m, "/nonexistent/materials.csv", "/nonexistent/surfaces.csv", NULL) == STATUS_IO);
}

/* The product's own files: everything a built-in model or a surface names exists. */
static void the_house_is_in_order(void **state)
{
    (void)state;
    char table[512], surface_table[512], catalog_path[512];
    CHECK(etc_path(table, sizeof table, "materials.csv"));
    CHECK(etc_path(surface_table, sizeof surface_table, "surfaces.csv"));
    CHECK(etc_path(catalog_path, sizeof catalog_path, "catalog.csv"));
    Catalog *catalog = NULL;
    CHECK(catalog_open(&catalog, catalog_path, 0.02) == STATUS_OK);
    Materials m;
    CHECK(materials_open(&m, table, surface_table, catalog) == STATUS_OK);
    CHECK(m.model_count == catalog_model_count(catalog) && m.model_count >= 5);
    for (int i = 0; i < m.model_count; i++)
        for (int p = 0; p < catalog_model(catalog, i)->part_count; p++) {
            const int row = m.part[i][p];
            CHECK(row > 0 && row < m.count);
            CHECK(strcmp(m.material[row].name, catalog_model(catalog, i)->part[p].material) == 0);
        }
    for (int s = SURFACE_NONE + 1; s < SURFACE_COUNT; s++) CHECK(m.surface[s] > 0 && m.surface[s] < m.count);
    materials_close(&m);
    catalog_close(catalog);
}

/* Power that a lobe sends out for a unit of power sent in, by midpoints over the hemisphere. */
static double lobe_albedo(double roughness_rad, double sun_zenith_rad)
{
    const double n[3] = {0, 0, 1}, sun[3] = {sin(sun_zenith_rad), 0, cos(sun_zenith_rad)};
    const int    heights = 700, azimuths = 700;
    double       sum = 0;
    for (int h = 0; h < heights; h++) {
        const double zenith = (h + 0.5) / heights * pi_rad / 2;
        for (int a = 0; a < azimuths; a++) {
            const double azimuth = (a + 0.5) / azimuths * pi_rad; /* half: symmetric */
            const double eye[3] = {sin(zenith) * cos(azimuth), sin(zenith) * sin(azimuth), cos(zenith)};
            sum += material_lobe(roughness_rad, n, eye, sun) * eye[2] * sin(zenith);
        }
    }
    return sum * 2 * pi_rad / azimuths * pi_rad / 2 / heights / sun[2];
}

static void the_lobe_makes_no_light(void **state)
{
    (void)state;
    static const double roughness[] = {0.05, 0.2, 0.6}, zenith_deg[] = {10, 45, 75};
    for (int r = 0; r < 3; r++)
        for (int z = 0; z < 3; z++) {
            const double albedo = lobe_albedo(roughness[r], zenith_deg[z] * rad_per_deg);
            CHECK(albedo < 1.005 && albedo > 0.6); /* what masking hides is lost, not bounced again */
            if (r == 0 && z < 2) CHECK_NEAR(albedo, 1, 0.01);
        }
}

static void the_lobe_is_reciprocal_and_peaks_at_the_mirror(void **state)
{
    (void)state;
    const double n[3] = {0, 0, 1};
    const double a[3] = {sin(0.5), 0, cos(0.5)}, b[3] = {-sin(0.7) * cos(0.2), sin(0.7) * sin(0.2), cos(0.7)};
    /* radiance a irradiance facing the source: Helmholtz holds after division by the source's cosine */
    CHECK_NEAR(material_lobe(0.2, n, a, b) * a[2] / (material_lobe(0.2, n, b, a) * b[2]), 1, 1e-12);
    const double mirror[3] = {-a[0], 0, a[2]}, beside[3] = {-sin(0.55), 0, cos(0.55)}, below[3] = {0.6, 0, -0.8};
    CHECK(material_lobe(0.05, n, mirror, a) > 3 * material_lobe(0.05, n, (double[3]){-sin(0.62), 0, cos(0.62)}, a));
    CHECK(material_lobe(0.05, n, mirror, a) > material_lobe(0.05, n, beside, a));
    CHECK(material_lobe(0.05, n, mirror, below) == 0);
    CHECK(isfinite(material_lobe(0, n, mirror, a)) && material_lobe(0, n, n, n) > 0);
}

static void reflectance_stays_between_its_ends(void **state)
{
    (void)state;
    /* no rise: below what it is at normal incidence only by Brewster's dip, which Fresnel has and Schlick has not */
    CHECK(material_fresnel(0, 0.1, 0) == 0 && material_fresnel(0, 0.1, 1) == 0);
    for (double rho = 0.001; rho <= 1; rho *= 1.4)
        for (double roughness = 0; roughness <= 1.5; roughness += 0.25) {
            CHECK_NEAR(material_fresnel(rho, roughness, 1), rho, 1e-15);
            double last = rho;
            for (double c = 1; c >= 0; c -= 0.05) {
                const double f = material_fresnel(rho, roughness, c);
                CHECK(f >= 0.98 * last - 1e-12 && f <= 1 + 1e-12);
                last = f;
                /* what is not reflected by the lobe is shared out, never more than all of it */
                double diffuse, lobe;
                material_split(&diffuse, &lobe, fmin(1.5 * rho, 1), fmin(rho / fmin(1.5 * rho, 1), 1), roughness, c);
                CHECK_NEAR(lobe, f, 1e-12);
                CHECK(diffuse >= 0 && diffuse + lobe <= 1 + 1e-12);
            }
        }
}

/* Unpolarised glass of refractive index 1.5 in air, from the formulae in any book of optics: at 0, 60, 75 and 85
 * degrees, and Brewster's angle, where all of what is left is polarised one way. */
static void glass_is_a_dielectric(void **state)
{
    (void)state;
    static const double angle_deg[] = {0, 30, 60, 75, 85}, want[] = {0.04, 0.0415, 0.0892, 0.2531, 0.6128};
    for (int i = 0; i < 5; i++) CHECK_NEAR(material_fresnel(0.04, 0, cos(angle_deg[i] * rad_per_deg)), want[i], 5e-5);
    const double brewster_rad = atan(1.5), across = (1 - 1.5 * 1.5) / (1 + 1.5 * 1.5);
    CHECK_NEAR(material_fresnel(0.04, 0, cos(brewster_rad)), 0.5 * across * across, 1e-12);
    CHECK_NEAR(material_fresnel(0.04, 0, 0), 1, 1e-12);
    CHECK_NEAR(material_fresnel(0.9, 0, 0), 1, 1e-12); /* and metal mirrors at grazing */
}

/* A pane of the same glass, light going back and forth between its sides, each polarisation for itself. */
static void a_pane_has_two_sides(void **state)
{
    (void)state;
    const double rho = 2 * 0.04 / 1.04;
    CHECK_NEAR(material_pane(rho, 0, 1), rho, 1e-12);
    const double s = 0.176568, p = 0.0018018; /* of one side at 60 degrees */
    CHECK_NEAR(material_pane(rho, 0, 0.5), s / (1 + s) + p / (1 + p), 2e-5);
    const double brewster_rad = atan(1.5), across = (1 - 1.5 * 1.5) / (1 + 1.5 * 1.5), one = across * across;
    CHECK_NEAR(material_pane(rho, 0, cos(brewster_rad)), one / (1 + one), 1e-12);
    CHECK_NEAR(material_pane(rho, 0, 0), 1, 1e-12);
    CHECK(material_pane(0, 0, 0.5) == 0);
}

/* Bare metal and glass give nothing back but a mirror's light. */
static void metal_and_glass_have_no_diffuse_share(void **state)
{
    (void)state;
    char table[512], surface_table[512];
    CHECK(etc_path(table, sizeof table, "materials.csv") &&
          etc_path(surface_table, sizeof surface_table, "surfaces.csv"));
    Materials m;
    CHECK(materials_open(&m, table, surface_table, NULL) == STATUS_OK);
    static const char *const names[] = {"metal_aluminium_bare", "metal_steel_galvanized", "steel_worn", "glass_window"};
    for (int i = 0; i < 4; i++) {
        const int row = materials_find(&m, names[i]);
        CHECK(row > 0);
        for (int c = 0; c < optical_channel_count; c++) {
            double diffuse, lobe;
            material_split(&diffuse, &lobe, m.material[row].rho[c], m.material[row].gloss, m.material[row].roughness,
                           1);
            CHECK(diffuse == 0);
            CHECK_NEAR(lobe, m.material[row].rho[c], 1e-12); /* coloured by the reflectance itself */
        }
    }
    /* vegetation is bright beyond red, and the table knows */
    const Material *grass = &m.material[materials_find(&m, "grass_green")];
    CHECK(grass->rho[optical_channel_nir] > 5 * grass->rho[optical_channel_r]);
    materials_close(&m);
}

/* ---- plants --------------------------------------------------------------------------------- */

enum { table_most = 1 << 16 };

/* The product's own table of plants, with one piece of it replaced. */
static Status add_plants(Materials *m, const char *from, const char *to)
{
    static char text[table_most], changed[table_most];
    char        table[512], surface_table[512], optics[512], ground[512], path[text_file_size];
    CHECK(etc_path(table, sizeof table, "materials.csv") &&
          etc_path(surface_table, sizeof surface_table, "surfaces.csv"));
    CHECK(etc_path(optics, sizeof optics, "plant_optics.csv") && etc_path(ground, sizeof ground, "woods.csv"));
    CHECK(materials_open(m, table, surface_table, NULL) == STATUS_OK);
    FILE *file = fopen(optics, "r");
    CHECK(file != NULL);
    text[fread(text, 1, sizeof text - 1, file)] = 0;
    fclose(file);
    const char *at = strstr(text, from);
    CHECK(at != NULL);
    snprintf(changed, sizeof changed, "%.*s%s%s", (int)(at - text), text, to, at + strlen(from));
    text_file(path, changed);
    const Status status = materials_add_plants(m, path, ground);
    remove(path);
    return status;
}

/* Healthy leaves are dark in red, bright beyond it and let about as much through; all rows keep their energy. */
static void leaves_are_as_leaves_are(void **state)
{
    (void)state;
    Materials m;
    CHECK(add_plants(&m, "name,", "name,") == STATUS_OK);
    for (int kind = 0; kind < PLANT_KINDS; kind++) {
        if (kind == PLANT_ROCK) continue;
        const Material *leaf = &m.material[m.plant[kind][PLANT_LEAF]];
        CHECK(m.plant[kind][PLANT_LEAF] > 0 && material_is_leaf(leaf));
        if (kind != PLANT_DRY_GRASS) CHECK(leaf->rho[optical_channel_nir] > 4 * leaf->rho[optical_channel_r]);
        const double through = (double)leaf->tau[optical_channel_nir] / (double)leaf->rho[optical_channel_nir];
        CHECK(through > 0.6 && through < 1.15);
        CHECK_NEAR(material_through(leaf, optical_channel_nir), through, 1e-12);
        for (int c = 0; c < optical_channel_count; c++) CHECK((double)leaf->rho[c] + (double)leaf->tau[c] < 0.95);
        CHECK((double)leaf->rho_lwir + (double)leaf->tau_lwir < 0.07);
        if (kind < PLANT_STANDING)
            CHECK(m.plant[kind][PLANT_BARK] > 0 && !material_is_leaf(&m.material[m.plant[kind][PLANT_BARK]]));
    }
    CHECK(m.plant[PLANT_ROCK][PLANT_STONE] > 0 && materials_let_through(&m));
    /* the ground beneath a wood is its litter, that of a meadow still grass */
    CHECK(m.surface[SURFACE_FOREST_BROADLEAF] == materials_find(&m, "leaf_litter"));
    CHECK(m.surface[SURFACE_GRASS] == materials_find(&m, "grass_green"));
    materials_close(&m);
}

/* Rows of the user's own: an equal one changes nothing, a changed one keeps its place, new ones follow plants too, and
 * what referred to a new one still does. */
static void own_rows_move_no_other(void **state)
{
    (void)state;
    static const char *const figures = "0.04,0.09,0.06,0.0625,0.45,0.015,0.019,0.73,0,1,0,0.1,1,1700,1200,test\n";
    char                     text[2048], path[text_file_size], a[512], b[512], optics[512], ground[512];
    Materials                plain, own;
    CHECK(add_plants(&plain, "name,", "name,") == STATUS_OK);
    snprintf(text, sizeof text, "%snew_paint,%sgrass_green,%sleaf_spare,%s", header, figures, figures, figures);
    text_file(path, text);
    CHECK(etc_own_set("materials.csv", path));
    CHECK(add_plants(&own, "name,", "name,") == STATUS_OK);
    CHECK(own.count == plain.count + 2 && own.own_first == plain.count);
    for (int i = 0; i < plain.count; i++) CHECK(strcmp(own.material[i].name, plain.material[i].name) == 0);
    CHECK(materials_find(&own, "new_paint") == plain.count && materials_find(&own, "leaf_spare") == plain.count + 1);
    CHECK_NEAR(own.material[materials_find(&own, "grass_green")].rho_lwir, 0.019, 1e-6);
    CHECK(memcmp(own.surface, plain.surface, sizeof own.surface) == 0 &&
          memcmp(own.plant, plain.plant, sizeof own.plant) == 0);
    materials_close(&own);

    /* a surface of a new material, and a row twice */
    char changed[1024];
    snprintf(changed, sizeof changed, "%.*s%s", (int)(strstr(surfaces, "grass,turf") - surfaces), surfaces,
             "grass,new_paint\ndry_grass,new_paint\ncrop,new_paint\nbare_soil,grass_green\nploughed,grass_green\n"
             "track,grass_green\nrock,grass_green\nscrub,leaf_spare\nwater,grass_green\nforest_broadleaf,grass_green\n"
             "forest_conifer,grass_green\nbuilt,grass_green\nroad,leaf_spare\nsand,grass_green\nsnow,grass_green\n"
             "wetland,grass_green\n");
    char surface_path[text_file_size];
    text_file(surface_path, changed);
    CHECK(etc_path(a, sizeof a, "materials.csv") && etc_path(b, sizeof b, "surfaces.csv"));
    CHECK(etc_path(optics, sizeof optics, "plant_optics.csv") && etc_path(ground, sizeof ground, "woods.csv"));
    CHECK(materials_open(&own, a, surface_path, NULL) == STATUS_OK);
    CHECK(materials_add_plants(&own, optics, ground) == STATUS_OK);
    CHECK(strcmp(own.material[own.surface[SURFACE_GRASS]].name, "new_paint") == 0);
    CHECK(strcmp(own.material[own.surface[SURFACE_ROAD]].name, "leaf_spare") == 0);
    materials_close(&own);
    remove(path);
    snprintf(text, sizeof text, "%snew_paint,%snew_paint,%s", header, figures, figures);
    text_file(path, text);
    CHECK(etc_own_set("materials.csv", path));
    CHECK(materials_open(&own, a, b, NULL) == STATUS_BAD_VALUE);
    CHECK(etc_own_set("materials.csv", NULL));
    remove(path);
    remove(surface_path);
    materials_close(&plain);
}

static void bad_plants_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *from, *to, *said;
    } bad[] = {
        {"tau_nir", "tau_near", "tau_nir"}, /* a column */
        {"rho_mwir,rho_lwir", "rho_mw,rho_lw", "rho_mwir"},
        {",0.3172,", ",0.6,", "tau_nir"}, /* of pine: with 0.4661, more than all */
        {",0.3172,", ",-0.1,", "tau_nir"},
        {",0.3172,", ",nan,", "tau_nir"},
        {"0.5839,0,0.6", "0.5839,0.2,0.6", "gloss"}, /* glossy, and lets light through */
        {"leaf_pine,0.0441", "leaf_pine,0", "reflects"},
        {"leaf_pine", "leaf_fir", "leaf_pine"}, /* kinds without their rows */
        {"bark_hedge", "bark_wall", "bark_hedge"},
        {"stone_boulder", "stone_age", "stone_boulder"},
        {"leaf_alder", "leaf_pine", "leaf_pine"}, /* twice */
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        Materials m;
        last_error[0] = 0;
        const Status status = add_plants(&m, bad[i].from, bad[i].to);
        if (status != STATUS_BAD_VALUE || !strstr(last_error, bad[i].said))
            fail_msg("case %zu: status %s, said \"%s\", want \"%s\"", i, status_name(status), last_error, bad[i].said);
        materials_close(&m);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(reads_what_is_written, listen, stop_listening),
        cmocka_unit_test_setup_teardown(refuses_and_says_why, listen, stop_listening),
        cmocka_unit_test(the_house_is_in_order),
        cmocka_unit_test(the_lobe_makes_no_light),
        cmocka_unit_test(the_lobe_is_reciprocal_and_peaks_at_the_mirror),
        cmocka_unit_test(reflectance_stays_between_its_ends),
        cmocka_unit_test(glass_is_a_dielectric),
        cmocka_unit_test(a_pane_has_two_sides),
        cmocka_unit_test(metal_and_glass_have_no_diffuse_share),
        cmocka_unit_test(leaves_are_as_leaves_are),
        cmocka_unit_test_setup_teardown(own_rows_move_no_other, listen, stop_listening),
        cmocka_unit_test_setup_teardown(bad_plants_are_refused, listen, stop_listening),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
