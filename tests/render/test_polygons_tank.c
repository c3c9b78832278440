/* Flat faces in closed form on bodies that also take ray tubes: corners, and a tank. labels: physics slow */
#include "tests/render/polygon_stage.h"

#include <limits.h>

/* Later mirrors stay with the tubes: corner reflectors by both ways against a fine grid. */
static void later_mirrors_stay_with_tubes(void **state)
{
    (void)state;
    static const char *const shapes[] = {"dihedral:0.3x0.3", "trihedral:0.45", "corner:0.45"};
    for (int n = 0; n < 3; n++) {
        double     off[2] = {0}, whole = 0;
        RadarStage s;
        stage_open(&s, shapes[n], x_hz);
        for (int i = 0; i < 6; i++) {
            const double         az_deg = n ? 32 + 5 * i : 7 * i - 17, el_deg = n ? 27 + 3 * i : 2 * i - 5;
            const ScatterAntenna a = antenna_at(az_deg, el_deg, i % 2 ? 50 : INFINITY);
            const ScatterMatrix  tubes = look(&s, &a, &a, 0), on = look(&s, &a, &a, polygon_faces_few);
            const TubeConfig     used = s.config;
            CHECK(field.polygons.count > 0 && !field.polygons.all && field.hits.count > 0);
            s.config.splits = 5;
            s.config.cuts_per_radius = 1e5;
            s.config.seed = 7;
            const ScatterMatrix fine = look(&s, &a, &a, 0);
            s.config = used;
            off[0] += power_apart(&tubes, &fine);
            off[1] += power_apart(&on, &fine);
            whole += scatter_power(fine.hh) + scatter_power(fine.vv);
        }
        printf("%s: tubes %.1f dB of the power from a fine grid, the first bounce in closed form %.1f dB\n", shapes[n],
               decibels(off[0] / whole), decibels(off[1] / whole));
        CHECK(off[1] <= 1e-5 * whole && (off[1] <= 1e-7 * whole || off[1] <= off[0]));
        close_stage(&s);
    }
}

/* Of a tank, forced: no farther from the tubes than these are from themselves. The same bits for any threads. */
static void a_tank_keeps_its_field_and_bits(void **state)
{
    (void)state;
    RadarMaterials materials = {0};
    RadarModel     tank = {0};
    TotalField     by[2] = {0};
    Pool          *pool = NULL;
    TubeConfig     config = tubes_default_config(x_hz);
    double         off = 0, apart = 0, whole = 0;
    CHECK(radar_materials_load(&materials) == STATUS_OK);
    CHECK(radar_model_open(&tank, "tank", &materials, radar_sag_m(x_hz)) == STATUS_OK);
    CHECK(pool_create(&pool, 3) == STATUS_OK);
    radar_target_pose(tank.target, NULL, 0);
    config.splits = 0;
    CHECK(tank.target->faces.count > polygon_faces_few);
    for (int i = 0; i < 4; i++) {
        ScatterMatrix        m[3], again;
        const ScatterAntenna tx = antenna_at(20 + 83 * i, 5 + 4 * i, 2000), apart_rx = antenna_at(40 + 83 * i, 9, 2000);
        const ScatterAntenna *rx = i == 3 ? &apart_rx : &tx;
        for (int kind = 0; kind < 3; kind++) { /* tubes, faces too, tubes of another grid */
            config.polygon_faces = kind == 1 ? INT_MAX : 0;
            config.seed = kind == 2;
            CHECK(total_field_trace(&by[0], tank.target, &tx, rx, &config, true, pool) == STATUS_OK);
            CHECK(total_field_sweep(&m[kind], &(FrequencySweep){.count = 1, .first_hz = x_hz}, &by[0], pool) ==
                  STATUS_OK);
            if (kind != 1) continue;
            CHECK(by[0].polygons.count > 100);
            CHECK(total_field_trace(&by[1], tank.target, &tx, rx, &config, true, NULL) == STATUS_OK);
            CHECK(total_field_sweep(&again, &(FrequencySweep){.count = 1, .first_hz = x_hz}, &by[1], NULL) ==
                  STATUS_OK);
            CHECK(by[0].polygons.count == by[1].polygons.count && by[0].hits.count == by[1].hits.count);
            CHECK(memcmp(by[0].polygons.whole, by[1].polygons.whole, (size_t)tank.model.triangle_count) == 0);
            CHECK(memcmp(by[0].hits.path_m, by[1].hits.path_m, by[0].hits.count * sizeof(double)) == 0);
            CHECK(memcmp(&again, &m[1], sizeof again) == 0);
        }
        off += power_apart(&m[1], &m[0]);
        apart += power_apart(&m[2], &m[0]);
        whole += scatter_power(m[0].hh) + scatter_power(m[0].vv);
    }
    config.polygon_faces = polygon_faces_few; /* of thousands: none */
    const ScatterAntenna a = antenna_at(20, 5, 2000);
    CHECK(total_field_trace(&by[0], tank.target, &a, &a, &config, false, pool) == STATUS_OK);
    CHECK(by[0].polygons.count == 0 && by[0].polygons.rays == 0);
    printf("tank: %.1f dB of the power from tubes alone, two grids of which are %.1f dB apart\n", decibels(off / whole),
           decibels(apart / whole));
    CHECK(off <= 0.5 * apart);
    for (int k = 0; k < 2; k++) total_field_free(&by[k]);
    pool_destroy(pool);
    radar_model_close(&tank);
    radar_materials_close(&materials);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(later_mirrors_stay_with_tubes),
        cmocka_unit_test(a_tank_keeps_its_field_and_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
