/* One record per target, and its box in the forms of all formats: pixel numbers are counted out one by one, the others
 * are worked by hand. tests/system/test_five_records.sh reads the formats themselves. */
#include "tests/check.h"
#include "tests/sensor/open_catalog.h"

#include "sensor/frame/target_record.h"

/* Number of the pixel: counted row by row from the upper left, which is 1. */
static uint64_t counted(int column, int row, int width)
{
    uint64_t n = 0;
    for (int y = 0; y <= row; y++)
        for (int x = 0; x < width; x++) {
            n++;
            if (x == column && y == row) return n;
        }
    return 0;
}

static void a_box_in_every_form(void **state)
{
    (void)state;
    enum { width = 7, height = 5 };
    for (int x0 = 0; x0 < width; x0++)
        for (int y0 = 0; y0 < height; y0++)
            for (int x1 = x0 + 1; x1 <= width; x1++)
                for (int y1 = y0 + 1; y1 <= height; y1++) {
                    const int box[4] = {x0, y0, x1, y1};
                    int       coco[4];
                    uint16_t  edge[4];
                    uint64_t  number[2];
                    target_box_coco(coco, box);
                    target_box_u16(edge, box);
                    target_box_pixel_numbers(number, box, width);
                    CHECK(coco[0] == x0 && coco[1] == y0 && coco[0] + coco[2] == x1 && coco[1] + coco[3] == y1);
                    CHECK(edge[0] == x0 && edge[1] == y0 && edge[2] == x1 && edge[3] == y1);
                    CHECK(number[0] == counted(x0, y0, width) && number[1] == counted(x1 - 1, y1 - 1, width));
                    const uint64_t centre = target_box_centre_number(box, width);
                    CHECK(centre == counted((x0 + x1) / 2, (y0 + y1) / 2, width));
                    CHECK(!target_box_is_empty(box));
                }
    /* MISB ST 0903: the first pixel is 1, the last one of 640 x 480 is 307200 */
    const int whole[4] = {0, 0, 640, 480}, one[4] = {639, 479, 640, 480};
    uint64_t  number[2];
    target_box_pixel_numbers(number, whole, 640);
    CHECK(number[0] == 1 && number[1] == 307200 && target_box_centre_number(whole, 640) == 240 * 640 + 321);
    target_box_pixel_numbers(number, one, 640);
    CHECK(number[0] == 307200 && number[1] == 307200 && target_box_centre_number(one, 640) == 307200);
}

static void no_pixels_and_too_many(void **state)
{
    (void)state;
    const int none[4] = {0, 0, 0, 0}, huge[4] = {65534, 3, 70000, 65535};
    uint16_t  edge[4];
    uint64_t  number[2] = {9, 9};
    target_box_pixel_numbers(number, none, 640);
    CHECK(target_box_is_empty(none) && number[0] == 0 && number[1] == 0 && target_box_centre_number(none, 640) == 0);
    target_box_u16(edge, none);
    CHECK(edge[0] == 0 && edge[1] == 0 && edge[2] == 0 && edge[3] == 0);
    target_box_u16(edge, huge);
    CHECK(edge[0] == 65534 && edge[1] == 3 && edge[2] == 65535 && edge[3] == 65535);
}

static void the_record_is_of_its_entity(void **state)
{
    (void)state;
    SnapshotEntity entity[3] = {
        {.id = {1, 2, 3},
         .type = {1, 1, 222, 1, 1, 1, 0},
         .marking = "T-72",
         .model = 0,
         .age_s = 1.5,
         .position_error_m = 0.25},
        {.id = {1, 2, 4}, .marking = "\xff\x01", .model = 1, .p_ecef = {11, 12, 13}, .v_ecef_mps = {14, 15, 16}},
        {.id = {7, 8, 9}},
    };
    const Snapshot snapshot = {.count = 3, .entity = entity};
    const Target   target[4] = {
          {.index = 1,
           .range_m = 1234.5,
           .closing_mps = NAN,
           .box = {3, 4, 6, 9},
           .amodal_box = {-2.5, 4, 6.25, 8},
           .pixels = 12.5,
           .visible_fraction = 0.75,
           .occluder = "entity",
           .occluder_index = 2,
           .los_rate_rps = {1, 2},
           .boresight_error_rad = {3, 4},
           .band = {{.snr = 5}, {.snr = 6}, {.contrast_k = 7}, {.contrast = 8}}},
          {.index = 0,
           .aspect_rad = 1,
           .depression_rad = 2,
           .los_az_rad = 3,
           .los_el_rad = 4,
           .occluder = "ground",
           .occluder_index = -1},
          {.index = 2, .occluder = "entity", .occluder_index = -1},
          {.index = 2, .occluder = "trees", .occluder_index = -1, .foliage_fraction = 0.5},
    };
    Arena              *arena = arena_create();
    const TargetRecord *r = target_records(target, 4, &snapshot, catalog, arena);
    CHECK(r);
    CHECK(r[0].index == 1 && r[0].plane_value == 2 && r[0].id.entity == 4 && r[0].marking[0] == '\xff');
    CHECK(r[0].range_m == 1234.5 && isnan(r[0].closing_mps) && r[0].pixels == 12.5 && r[0].visible_fraction == 0.75);
    CHECK(r[0].box[0] == 3 && r[0].box[1] == 4 && r[0].box[2] == 6 && r[0].box[3] == 9);
    CHECK(r[0].amodal_box[0] == -2.5 && r[0].amodal_box[2] == 6.25);
    CHECK(r[0].occluder == OCCLUDER_ENTITY && r[0].occluder_id.site == 7);
    CHECK(r[0].los_rate_rps[1] == 2 && r[0].boresight_error_rad[0] == 3);
    CHECK(r[0].p_ecef[0] == 11 && r[0].p_ecef[2] == 13 && r[0].v_ecef_mps[1] == 15);
    CHECK(r[0].band[0].snr == 5 && r[0].band[2].contrast_k == 7 && r[0].band[3].contrast == 8);
    CHECK(strcmp(r[0].model, catalog_model(catalog, 1)->name) == 0);
    CHECK(r[1].plane_value == 1 && strcmp(r[1].marking, "T-72") == 0 && r[1].age_s == 1.5);
    CHECK(r[1].position_error_m == 0.25 && strcmp(target_class_name(r[1].class_number), "tank") == 0);
    CHECK(r[1].aspect_rad == 1 && r[1].depression_rad == 2 && r[1].los_az_rad == 3 && r[1].los_el_rad == 4);
    CHECK(r[1].occluder == OCCLUDER_GROUND && dis_entity_id_is_none(r[1].occluder_id));
    CHECK(r[2].occluder == OCCLUDER_ENTITY && dis_entity_id_is_none(r[2].occluder_id)); /* its occluder is not known */
    CHECK(r[3].occluder == OCCLUDER_TREES && dis_entity_id_is_none(r[3].occluder_id) && r[3].foliage_fraction == 0.5);
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_box_in_every_form),
        cmocka_unit_test(no_pixels_and_too_many),
        cmocka_unit_test(the_record_is_of_its_entity),
    };
    return cmocka_run_group_tests(tests, open_catalog, close_catalog);
}
