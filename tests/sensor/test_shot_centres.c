/* Which scattering centres of an entity a radar sees past a box half way: by where the box's shadow ends, and by the
 * cells of centres that share a sight line. labels: physics */
#include "tests/sensor/radar_scene.h"

#include "sensor/radar/seeker_radar_private.h"

/* From the origin a box of 2 m, whose front is 49 m to the north, hides at 100 m what is less than 100 / 49 m off the
 * axis. */
static const double edge_m = 100 / 49.0;
enum { most = 8 };

static int open_stage(void **state)
{
    (void)state;
    scene_folder();
    FILE *file = scene_obj("box", NULL);
    scene_box(file, "box", 1, (const double[3]){-1, -1, -1}, (const double[3]){1, 1, 1});
    CHECK(fclose(file) == 0);
    scene_open((const char *const[]){"box"}, 1);
    return 0;
}

static int close_stage(void **state)
{
    (void)state;
    scene_close();
    return 0;
}

/* Centres at places along an axis of the entity (0: east, 2: up), which is 100 m north, and their weights. own: index
 * of the entity that they are of. */
static void look(bool seen[most], int count, const double *at_m, const double *weight, int axis, int own)
{
    static const double turned[9] = {0, 1, 0, 1, 0, 0, 0, 0, -1}, north[3] = {0, 100, 0};
    ScatterCentre       centre[most] = {0};
    Visibility         *visibility;
    arena_reset(stage.arena);
    for (int k = 0; k < 3; k++) stage.view.p_enu[k] = 0;
    for (int i = 0; i < count; i++) { /* body axes: forward north, right east, down */
        centre[i].p[axis == 0 ? 1 : 2] = axis == 0 ? at_m[i] : -at_m[i];
        centre[i].weight = weight[i];
    }
    CHECK(visibility_create(&visibility, stage.world.tracer, NULL, &stage.world.frame, &stage.snapshot, 0,
                            stage.arena) == STATUS_OK);
    const RadarShot shot = {.scene = &stage.scene, .visibility = visibility, .arena = stage.arena};
    const Centres   centres = {.count = count, .centre = centre};
    for (int i = 0; i < most; i++) seen[i] = i % 2;
    CHECK(shot_sees_centres(seen, &shot, own, north, turned, &centres) == STATUS_OK);
}

/* Cells are a 47th of the extent: from -3 to 4.05 m 0.15 m; that from 1.95 to 2.1 m has the shadow's end. All of a cell
 * are seen where the mean of its places by weight is. Alike to the east and up. */
static void a_cell_is_seen_by_its_middle(void **state)
{
    (void)state;
    static const double at[7] = {-3, 4.05, 1.96, 2.09, 1.94, 2.11, 0},
                        weight[2][7] = {{1, 1, 1, 1, 1, 1, 1}, {1, 1, 1, 2, 1, 1, 0}};
    bool seen[most];
    stage.snapshot.count = 0;
    scene_add(0, 0, 50, 0);
    for (int axis = 0; axis <= 2; axis += 2)
        for (int heavier = 0; heavier < 2; heavier++) {
            look(seen, 7, at, weight[heavier], axis, 7);
            CHECK(seen[0] && seen[1] && seen[5] && !seen[4] && !seen[6]);
            CHECK(seen[2] == (heavier == 1) && seen[3] == (heavier == 1)); /* 2.025; 2.047 m */
        }
    /* of the box itself: what it hides of itself is in its list already */
    look(seen, 7, at, weight[0], 0, 0);
    for (int i = 0; i < 7; i++) CHECK(seen[i]);
    /* nor does another box behind its front, since a line ends at what it meets first; before it, it does */
    scene_add(0, 0, 75, 0);
    look(seen, 7, at, weight[0], 0, 0);
    for (int i = 0; i < 7; i++) CHECK(seen[i]);
    look(seen, 7, at, weight[0], 0, 1);
    CHECK(seen[0] && !seen[4] && !seen[6]);
    /* what stands behind hides nothing */
    stage.snapshot.count = 0;
    scene_add(0, 0, 150, 0);
    look(seen, 7, at, weight[0], 0, 7);
    for (int i = 0; i < 7; i++) CHECK(seen[i]);
    look(seen, 0, at, weight[0], 0, 7);
    CHECK(!seen[0] && seen[1]); /* as before: there are none */
}

/* No cell is smaller than 5 cm: of places from 5.2 cm within the shadow, one a centimetre within it and one 2 mm beyond
 * are in two. */
static void cells_are_five_centimetres_at_least(void **state)
{
    (void)state;
    const double        at[3] = {edge_m - 0.052, edge_m - 0.01, edge_m + 0.002};
    static const double weight[3] = {1, 1, 1};
    bool                seen[most];
    stage.snapshot.count = 0;
    scene_add(0, 0, 50, 0);
    look(seen, 3, at, weight, 0, 7);
    CHECK(!seen[0] && !seen[1] && seen[2]);
    const double nearer[3] = {edge_m - 0.045, edge_m - 0.01, edge_m + 0.002}; /* in one */
    look(seen, 3, nearer, weight, 0, 7);
    CHECK(!seen[0] && !seen[1] && !seen[2]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_cell_is_seen_by_its_middle),
        cmocka_unit_test(cells_are_five_centimetres_at_least),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
