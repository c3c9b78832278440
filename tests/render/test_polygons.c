/* scratch */
#include "tests/render/radar_stage.h"
#include "render/radar/radar_model.h"
#include "render/radar/total_field.h"

static void one(const char *name, double hz, double range, int looks, int fine_more)
{
    RadarMaterials materials = {0};
    RadarModel m = {0};
    Pool *pool = NULL;
    TotalField f = {0};
    radar_materials_load(&materials);
    radar_model_open(&m, name, &materials, radar_sag_m(hz));
    pool_create(&pool, 1);
    radar_target_pose(m.target, NULL, 0);
    ScatterMatrix s[5][16];
    double t[5] = {0}; long long rays[5] = {0}, hits[5] = {0}, pol[5] = {0}, prays[5] = {0};
    double share = 0, first = 0;
    for (int k = 0; k < 5; k++)
        for (int i = 0; i < looks; i++) {
            TubeConfig c = tubes_default_config(hz);
            ScatterAntenna a;
            if (k == 4 && !fine_more) continue;
            c.polygons = k == 1 || k == 3;
            if (k >= 2 && k < 4) c.splits = 0;
            if (k == 4) { c.seed = 5; c.splits = fine_more; c.cuts_per_radius = 1e6; }
            radar_look(&a, (20 + 57.3 * i) * rad_per_deg, (5 + 5 * (i % 4)) * rad_per_deg, range);
            double b = wall_clock_s();
            if (total_field_trace(&f, m.target, &a, &a, &c, false, pool)) fail_msg("x");
            total_field_sweep(&s[k][i], 1, hz, 0, &f, NULL, NULL, pool);
            t[k] += wall_clock_s() - b;
            rays[k] += f.hits.rays, hits[k] += (long long)f.hits.count; pol[k] += f.polygons.count; prays[k] += f.polygons.rays;
            if (k == 1) { for (int q = 0; q < f.polygons.count; q++) for (int j = 0; j < 8; j++) share += fabs(f.polygons.polygon[q].amplitude[j]); }
            if (k == 0 || k == 1) for (size_t h = 0; h < f.hits.count; h++) if (f.hits.bounce[h] == 1 && k == 0) for (int j = 0; j < 8; j++) first += fabs((double)f.hits.amplitude[j][h]);
        }
    printf("%s %g GHz range %g: faces %d convex %d; share of first bounce in polygons %.2f\n", name, hz/1e9, range, m.target->faces.count, m.target->faces.convex, share/first);
    const int ref = fine_more ? 4 : 0;
    for (int k = 0; k < 5; k++) {
        double off = 0, whole = 0;
        for (int i = 0; i < looks; i++) {
            off += scatter_power(s[k][i].hh - s[ref][i].hh) + scatter_power(s[k][i].vv - s[ref][i].vv);
            whole += scatter_power(s[ref][i].hh) + scatter_power(s[ref][i].vv);
        }
        printf("  %s: %.3f s a look, rays %lld hits %lld polygons %lld (rays %lld); off %.1f dB\n", (const char *[]){"off s2", "on s2", "off s0", "on s0", "fine"}[k], t[k] / looks, rays[k]/looks, hits[k]/looks, pol[k]/looks, prays[k]/looks, decibels(off / whole));
    }
    total_field_free(&f);
    pool_destroy(pool);
    radar_model_close(&m);
    radar_materials_close(&materials);
}

static void scratch(void **state)
{
    (void)state;
    one("plate:0.3x0.3", 10e9, INFINITY, 6, 4);
    one("plate:1.3x0.8", 94e9, 100, 3, 4);
    one("dihedral:0.3x0.3", 10e9, INFINITY, 6, 4);
    one("tank", 10e9, 2000, 6, 3);
    one("truck", 10e9, 2000, 6, 3);
    one("tank", 94e9, 2000, 1, 0);
}
int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(scratch)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
