/* Fewer echoes than scattering centres: the map of all four channels hardly changes, a target that nothing resolves is
 * one echo, and where a target is resolved nothing is merged. labels: physics small */
#include "tests/sensor/radar_scene.h"

static int open_models(void **state)
{
    (void)state;
    scene_folder();
    FILE *file = scene_obj("boxes", NULL);
    int   first = 1;
    /* unlike, over seven metres along and across, and two up */
    for (int i = 0; i < 16; i++) {
        double low[3], high[3];
        for (int k = 0; k < 3; k++) {
            low[k] = (k < 2 ? -3.5 : 0) + (k < 2 ? 6.5 : 1.5) * random_uniform(1, 0, (uint32_t)i, (uint64_t)k);
            high[k] = low[k] + 0.3 + 0.2 * random_uniform(1, 1, (uint32_t)i, (uint64_t)k);
        }
        char name[8];
        snprintf(name, sizeof name, "box%d", i);
        first = scene_box(file, name, first, low, high);
    }
    CHECK(fclose(file) == 0);
    file = scene_obj("sphere", NULL);
    scene_sphere(file, 1, 0.1, 0, 0, 0);
    CHECK(fclose(file) == 0);
    scene_open((const char *const[]){"boxes", "sphere"}, 2);
    return 0;
}

static int close_models(void **state)
{
    (void)state;
    scene_close();
    return 0;
}

/* Root of the power of what merging changes over the map's own, of all channels; their numbers of echoes. */
static double changed(int *merged, int *apart, const char *preset)
{
    SeekerRadar *radar = scene_radar(preset, NULL);
    stage.scene.apart = true;
    const RadarFrame *want = scene_measure(radar);
    stage.scene.apart = false;
    const RadarFrame *got = scene_measure(radar);
    const size_t      cells = (size_t)interval_channels * (size_t)want->map.rows * (size_t)want->map.columns;
    double            off = 0, power = 0;
    for (size_t i = 0; i < cells; i++) {
        off += scatter_power(got->map.cell[i] - want->map.cell[i]);
        power += scatter_power(want->map.cell[i]);
    }
    *merged = got->echoes, *apart = want->echoes;
    seeker_radar_destroy(radar);
    return sqrt(off / power);
}

static void few_echoes_make_the_same_map(void **state)
{
    (void)state;
    /* still; turning, so that range rates differ; turned away from the axis, where the pattern has a slope */
    static const double rps[3] = {0, 0.002, 0}, north_m[3] = {0, 0, 12};
    for (int i = 0; i < 3; i++) {
        int merged, apart;
        stage.snapshot.count = 0;
        scene_add(0, 0, north_m[i], 0)->w_body_rps[2] = rps[i];
        const double off = changed(&merged, &apart, "search_ku");
        printf("boxes %g m off the axis, turning by %g rad/s: %d echoes of %d, %.2f %% of the map\n", north_m[i],
               rps[i], merged, apart, 100 * off);
        CHECK(merged < apart / 2 && off < 0.02 && off > 1e-9);
    }
}

static void one_echo_of_what_nothing_resolves(void **state)
{
    (void)state;
    int merged, apart;
    stage.snapshot.count = 0;
    scene_add(1, 0, 0, 0);
    const double off = changed(&merged, &apart, "search_ku");
    printf("a sphere of 0.1 m: %d echo of %d, %.2f %% of the map\n", merged, apart, 100 * off);
    CHECK(merged == 1 && apart > 1 && off < 0.05);
}

static void what_is_resolved_stays(void **state)
{
    (void)state;
    int merged, apart;
    stage.snapshot.count = 0;
    scene_add(0, 0, 0, 0)->w_body_rps[2] = 2;
    CHECK(changed(&merged, &apart, "seeker_35") == 0 && merged == apart);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(few_echoes_make_the_same_map),
                                       cmocka_unit_test(one_echo_of_what_nothing_resolves),
                                       cmocka_unit_test(what_is_resolved_stays)};
    return cmocka_run_group_tests(tests, open_models, close_models);
}
