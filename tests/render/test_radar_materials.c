/* Radar materials: each material that a model may name has a row or its stated default, permittivities between rows,
 * and broken tables refused with file and line. labels: physics */
#include "tests/check.h"

#include "render/scattering/radar_surfaces.h"

static const char head[] = "name,kind,f_ghz,eps_re,eps_im,thick_mm,rough_mm,source\n"
                           "metal_default,metal,10,1,0,0,0.03,estimate\n"
                           "other_default,half_space,10,3,0.1,0,0.5,estimate\n";

static Status open_text(RadarMaterials *out, const char *rows)
{
    char            path[text_file_size], text[4096];
    Material        some[3] = {{.name = "none"}, {.name = "iron", .metal = 1}, {.name = "felt"}};
    const Materials optical = {.count = 3, .material = some};
    snprintf(text, sizeof text, "%s%s", head, rows);
    text_file(path, text);
    const Status status = radar_materials_open(out, path, &optical);
    remove(path);
    return status;
}

static void every_material_has_a_row_or_its_default(void **state)
{
    (void)state;
    RadarMaterials m;
    RadarSurface   s;
    CHECK(open_text(&m, "felt,slab,10,1.2,0.01,3,0,estimate\n") == STATUS_OK);
    radar_surface(&s, &m.material[radar_materials_find(&m, "iron")], 1e10);
    CHECK(s.kind == RADAR_METAL);
    CHECK_NEAR(s.rough_m, 3e-5, 1e-15);
    radar_surface(&s, &m.material[radar_materials_find(&m, "none")], 1e10);
    CHECK(s.kind == RADAR_HALF_SPACE && s.eps == CMPLX(3, -0.1));
    radar_surface(&s, &m.material[radar_materials_find(&m, "felt")], 1e10);
    CHECK(s.kind == RADAR_SLAB);
    CHECK_NEAR(s.thick_m, 0.003, 1e-15);
    CHECK(radar_materials_find(&m, "wool") == -1);
    radar_materials_close(&m);

    /* the table in use, with a row of each kind */
    bool seen[RADAR_SURFACE_KINDS] = {0};
    CHECK(radar_materials_load(&m) == STATUS_OK);
    for (int i = 0; i < m.count; i++)
        for (double f_hz = 1e9; f_hz < 2e11; f_hz *= 1.7) {
            double complex te, tm;
            radar_surface(&s, &m.material[i], f_hz);
            seen[s.kind] = true;
            for (double cosine = 0.01; cosine <= 1; cosine += 0.11) {
                fresnel_surface(&te, &tm, &s, 2 * pi_rad * f_hz / 299792458.0, cosine);
                CHECK(cabs(te) <= 1 + 1e-12 && cabs(tm) <= 1 + 1e-12); /* nothing gains */
            }
        }
    for (int k = 0; k < RADAR_SURFACE_KINDS; k++) CHECK(seen[k]);
    CHECK(radar_materials_find(&m, "paint_olive") >= 0 && radar_materials_find(&m, "grass_green") >= 0);
    radar_materials_close(&m);
}

static void permittivity_is_joined_between_rows(void **state)
{
    (void)state;
    RadarMaterials m;
    RadarSurface   s;
    CHECK(open_text(&m, "wet,half_space,10,60,30,0,0,estimate\nwet,half_space,40,20,28,0,0,estimate\n") == STATUS_OK);
    const RadarMaterial *wet = &m.material[radar_materials_find(&m, "wet")];
    radar_surface(&s, wet, 20e9); /* half way by logarithm */
    CHECK(cabs(s.eps - CMPLX(40, -29)) < 1e-9);
    radar_surface(&s, wet, 1e9);
    CHECK(s.eps == CMPLX(60, -30));
    radar_surface(&s, wet, 94e9);
    CHECK(s.eps == CMPLX(20, -28));
    radar_materials_close(&m);
}

static void broken_tables_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *rows, *said;
    } cases[] = {
        {"a,gel,10,2,0,0,0,x\n", "kind: 'gel' is not one of metal, half_space, slab, coated"},
        {"a,half_space,10,0.5,0,0,0,x\n", "eps_re"},
        {"a,half_space,10,2,-1,0,0,x\n", "eps_im"},
        {"a,slab,10,2,0,0,0,x\n", "thick_mm"},
        {"a,metal,10,2,0,1,0,x\n", "thick_mm"},
        {"a,metal,10,2,0,0,-1,x\n", "rough_mm"},
        {"a,metal,0,2,0,0,0,x\n", "f_ghz"},
        {"a,metal,nan,2,0,0,0,x\n", "f_ghz"},
        {"a,metal,10,2,0,0,0,\n", "source"},
        {",metal,10,2,0,0,0,x\n", "name is empty"},
        {"a,half_space,10,2,0,0,0,x\na,half_space,10,2,0,0,0,x\n", "must rise"},
        {"a,half_space,10,2,0,0,0,x\na,metal,20,2,0,0,0,x\n", "first row"},
        {"a,metal,10,2,0,0,0,x\nb,metal,10,2,0,0,0,x\na,metal,20,2,0,0,0,x\n", "together"},
    };
    RadarMaterials m;
    log_set_sink(check_listen, NULL);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        check_said[0] = 0;
        CHECK(open_text(&m, cases[i].rows) == STATUS_BAD_VALUE);
        if (!strstr(check_said, cases[i].said) || !strstr(check_said, "pitviper-test-"))
            fail_msg("case %zu: '%s'", i, check_said);
    }
    char            path[text_file_size];
    const Materials none = {0};
    text_file(path, "name,kind,f_ghz,eps_re,eps_im,thick_mm,rough_mm,source\nmetal_default,metal,10,1,0,0,0,x\n");
    CHECK(radar_materials_open(&m, path, &none) == STATUS_BAD_VALUE && strstr(check_said, "other_default"));
    remove(path);
    text_file(path, "name,kind\n");
    CHECK(radar_materials_open(&m, path, &none) == STATUS_BAD_VALUE);
    remove(path);
    log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_material_has_a_row_or_its_default),
        cmocka_unit_test(permittivity_is_joined_between_rows),
        cmocka_unit_test(broken_tables_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
