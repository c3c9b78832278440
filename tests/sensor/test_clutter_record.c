/* What truth.jsonl says of clutter in a scene made by hand, and that a frame without clutter says nothing of it. */
#include "tests/check.h"

#include "sensor/frame/records.h"
#include "sensor/frame/record_fields.h"

#include <string.h>

static void a_scene_made_by_hand(void **state)
{
    (void)state;
    Arena               *arena = arena_create();
    SceneryObject        object[3] = {{.id = 0x1234, .class = CLUTTER_ROCK, .kind = SCENERY_CLUTTER},
                                      {.id = 9, .kind = SCENERY_BUILDINGS},
                                      {.id = 0xfedcba9876543210u, .class = CLUTTER_FIRE, .kind = SCENERY_CLUTTER}};
    const Scenery        scenery = {.objects = 3, .object = object};
    SceneryPixels        seen[2] = {{0, 0.25, {3, 4, 4, 5}, 812.5, NAN}, {2, 17.5, {10, 20, 15, 26}, 90.25, 1043.75}};
    const Picture        picture = {.scenery = seen, .scenery_count = 2};
    const ClutterRecord *record = NULL;
    int                  count = -1;
    assert_int_equal(clutter_records(&record, &count, &picture, &scenery, arena), STATUS_OK);
    assert_int_equal(count, 2);
    char *text[2];
    for (int k = 0; k < 2; k++) text[k] = field_line(&clutter_fields, &record[k], 9);
    assert_string_equal(text[0], "{\"class\":\"rock\",\"id\":\"0000000000001234\",\"pixels\":0.25,\"box_px\":[3,4,4,5],"
                                 "\"range_m\":812.5,\"instance\":1}");
    assert_string_equal(text[1], "{\"class\":\"fire\",\"id\":\"fedcba9876543210\",\"pixels\":17.5,"
                                 "\"box_px\":[10,20,15,26],\"range_m\":90.25,\"temp_k\":1043.75,\"instance\":3}");
    free(text[0]), free(text[1]);

    const Picture none = {0};
    assert_int_equal(clutter_records(&record, &count, &none, &scenery, arena), STATUS_OK);
    CHECK(count == 0 && !record);
    assert_int_equal(clutter_records(&record, &count, &picture, NULL, arena), STATUS_OK);
    CHECK(count == 0 && !record);
    arena_destroy(arena);
}

static void classes_have_names_of_their_own(void **state)
{
    (void)state;
    const Field *row = clutter_fields.row;
    for (int a = 1; a < CLUTTER_CLASSES; a++) {
        const char *name = scenery_class_name((SceneryClass)a);
        for (int b = 0; b < a; b++) CHECK(strcmp(name, scenery_class_name((SceneryClass)b)) != 0);
        if (!strstr(row->about, name)) fail_msg("%s is not in what help says of clutter[].class", name);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_scene_made_by_hand),
        cmocka_unit_test(classes_have_names_of_their_own),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
