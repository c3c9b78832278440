/* A beam that scans, by many threads and by one: the same bits, and those of a beam that stares.
 * labels: physics threads */
#include "tests/sensor/scan_stage.h"

/* Whatever makes it: and the middle position is the interval of a beam that stares: over ground bit for bit, of
 * entities but for finer scattering centres, which are to hold over all positions. */
static void the_same_bits(void **state)
{
    (void)state;
    static const double still[3] = {0, 0, 0};
    const Weather       weather = weather_default();
    SeekerRadar        *radar = open_radar("search_ku", 12, 0.5, false);
    SeekerRadar        *stares = open_radar("search_ku", 0, 0.5, false);
    place_sphere(0, 2 * rad_per_deg, still);
    place_sphere(1, -3 * rad_per_deg, still);
    for (int ground = 0; ground < 2; ground++) {
        if (ground) {
            seeker_radar_destroy(radar);
            seeker_radar_destroy(stares);
            radar = open_radar("seeker_35", 8, 0.5, true);
            stares = open_radar("seeker_35", 0, 0.5, true);
            stage.snapshot.count = 0;
        }
        RadarScene scene = scene_of(200, &weather);
        if (ground) { /* down onto the ground, in radar axes of another kind */
            const double r[9] = {0, -0.2, sqrt(0.96), -1, 0, 0, 0, -sqrt(0.96), -0.2};
            memcpy(stage.view.r_enu_from_cam, r, sizeof r);
            scene.reference_m = eye_m / 0.2;
        }
        for (int i = 0; i < rows_px * columns_px; i++) stage.range_m[i] = (float)scene.reference_m;
        scene.range_m = stage.range_m;
        arena_reset(stage.arena);
        const RadarFrame  *three = measure(radar, &scene, stage.pool), *one = measure(radar, &scene, NULL);
        const RadarFrame  *still_one = measure(stares, &scene, stage.pool);
        const RadarSector *a = three->scan, *b = one->scan;
        const size_t map = interval_channels * (size_t)one->map.rows * (size_t)one->map.columns * sizeof *one->map.cell;
        const size_t pixels = (size_t)a->width * (size_t)a->height;
        CHECK(memcmp(three->map.cell, one->map.cell, map) == 0);
        double most = 0, apart = 0;
        for (size_t i = 0; i < map / sizeof *one->map.cell; i++) {
            most = fmax(most, cabs(one->map.cell[i]));
            apart = fmax(apart, cabs(one->map.cell[i] - still_one->map.cell[i]));
        }
        printf("%s: the middle position is %.1e off the beam that stares\n", ground ? "ground" : "spheres",
               apart / most);
        CHECK(!still_one->scan && apart <= (ground ? 0 : 0.03 * most));
        CHECK(memcmp(a->power_w, b->power_w, (size_t)a->plan.positions * (size_t)a->columns * sizeof *a->power_w) == 0);
        CHECK(memcmp(a->sharp_w, b->sharp_w, (size_t)a->azimuths * (size_t)a->columns * sizeof *a->sharp_w) == 0);
        CHECK(memcmp(a->view_w, b->view_w, pixels * sizeof *a->view_w) == 0);
        CHECK(memcmp(a->view_sharp_w, b->view_sharp_w, pixels * sizeof *a->view_sharp_w) == 0);
        CHECK(!ground || one->ground_cells > still_one->ground_cells);
    }
    seeker_radar_destroy(radar);
    seeker_radar_destroy(stares);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_same_bits),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
