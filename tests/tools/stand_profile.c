/* tests/tools/stand_profile.c: what a standing box takes from the ground beside it, along a line through its middle,
 * for tests/system/stand_judge.py: the material and what shines on it, then a line `y_m kelvins` for each place. */
#include "tests/scenes/paper_day.h"

#include <stdio.h>
#include <stdlib.h>

int main(int argc, char **argv)
{
    enum { kind = SURFACE_SAND, places = 301 };
    static const double from_h = 9, enu_from_body[9] = {0, 1, 0, 1, 0, 0, 0, 0, -1}, up[3] = {0, 0, 1}, half_m = 1.7,
                        high_m = 2.4;
    const double until_h = argc > 1 ? atof(argv[1]) : 12;
    GroundKinds  kinds;
    LocalFrame   frame;
    Column       layers;
    HeatNow     *now;
    MarkHeat    *heat;
    Arena       *arena = arena_create();
    GroundStand  box = {.from_s = 3600 * from_h, .to_s = INFINITY, .owner = 1};
    paper_kinds(&kinds);
    if (!arena || local_frame_at(&frame, &(Geodetic){0.785, 0.2, 0}) != STATUS_OK) return 1;
    if (ground_layers(&layers, &kinds.kind[kind], &ground_grid_default) != STATUS_OK) return 1;
    Heat *h = paper_heat(&kinds, &paper_summer, from_h - 3, NULL);
    ecef_from_enu(box.p_ecef, &frame, (const double[3]){0, 0, 0});
    m3_mul(box.r_ecef_from_body, frame.r_ecef_from_enu, enu_from_body);
    for (int a = 0; a < 2; a++) box.low_m[a] = (float)-half_m, box.high_m[a] = (float)half_m;
    box.low_m[2] = (float)-high_m;
    const GroundMarks marks = {.stands = 1, .stand = &box};
    if (heat_now(&now, h, paper_unix_s + 3600 * until_h, arena) != STATUS_OK ||
        heat_marks_create(&heat, &marks, &frame, paper_unix_s, paper_unix_s + 3600 * until_h, now, arena) != STATUS_OK)
        return 1;
    const double k_w_mk = layers.conductance_w_m2k[5] * (layers.depth_m[6] - layers.depth_m[5]);
    const double c_j_m3k = layers.capacity_j_m2k[5] / (0.5 * (layers.depth_m[6] - layers.depth_m[4]));
    printf("%.6g %.6g %.6g %.6g\n", k_w_mk, c_j_m3k, kinds.kind[kind].absorptance, kinds.kind[kind].emissivity);
    for (int n = 0; n < places; n++) {
        const double y = 0.02 * (n - places / 2), p_enu[3] = {0, y, 0};
        MarkedGround mark;
        heat_marks_at(&mark, heat, kind, p_enu, up, 1);
        printf("%.3f %.5f\n", y, mark.add_k);
    }
    heat_destroy(h);
    arena_destroy(arena);
    return 0;
}
