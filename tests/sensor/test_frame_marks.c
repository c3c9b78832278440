/* tests/sensor/test_frame_marks.c: ground marks in a frame file: the same bits again, and nothing out of its range. */
#include "tests/check.h"

#include "sensor/verify/saved_frame/saved_frame.h"

static GroundStand stand[2];
static GroundTrack track[3];
static GroundBurn  burn[1];

static SavedFrame small_file(void)
{
    SavedFrame file = {.version = "1", .host = "1:2:3", .config_sha256 = "", .settings = "seed: 1\n", .frame = 7};
    for (int i = 0; i < 2; i++) {
        stand[i] = (GroundStand){.p_ecef = {6378137 + 1.0 / 3, i, -5},
                                 .low_m = {-4, -2, -3.3f},
                                 .high_m = {4, 2, 0},
                                 .from_s = -3600 + 0.1 * i,
                                 .to_s = i ? INFINITY : 12.3,
                                 .owner = (uint64_t)1 << 40};
        m3_identity(stand[i].r_ecef_from_body);
    }
    for (int i = 0; i < 3; i++)
        track[i] = (GroundTrack){.a_ecef = {6378137, 0.1 * i, 0},
                                 .b_ecef = {6378137, 4, 0.7 * i},
                                 .a_s = i,
                                 .b_s = i + 0.3,
                                 .width_m = 0.58f,
                                 .apart_m = 3.04f,
                                 .heat_j_m2 = 11234.5f,
                                 .tracked = i == 1};
    burn[0] = (GroundBurn){.p_ecef = {6378137, 0, 9}, .t_s = 3, .radius_m = 2, .crater_m = 1, .heat_j_m2 = 1e5f};
    file.request = (RenderRequest){.view = {.width = 16, .height = 12, .focal_px = 30},
                                   .bands = 15,
                                   .truth = true,
                                   .samples = 1,
                                   .hidden_entity = -1,
                                   .profile_bins = 16,
                                   .profile_bin_m = 0.3};
    file.eye.host_index = -1;
    m3_identity(file.request.view.r_enu_from_cam);
    m3_identity(file.eye.r_ecef_from_cam);
    m3_identity(file.r_ecef_from_body);
    file.ground = (LandscapeParts){.invented = true, .config = landscape_default_config()};
    file.snapshot.marks = (GroundMarks){2, 3, 1, stand, track, burn, 5};
    return file;
}

static Status through(SavedFrame *out, const SavedFrame *file, Arena *arena)
{
    ByteSink bytes = {0};
    CHECK(saved_frame_pack(&bytes, file, NULL) == STATUS_OK);
    const Status status = saved_frame_parse(out, bytes.bytes, bytes.count, "test", arena);
    sink_free(&bytes);
    return status;
}

static void marks_come_back_to_the_bit(void **state)
{
    (void)state;
    Arena     *arena = arena_create();
    SavedFrame file = small_file(), again;
    CHECK(through(&again, &file, arena) == STATUS_OK);
    const GroundMarks *m = &again.snapshot.marks;
    CHECK(m->stands == 2 && m->tracks == 3 && m->burns == 1 && m->forgotten == 5);
    CHECK(memcmp(m->stand, stand, sizeof stand) == 0);
    for (int i = 0; i < 3; i++)
        CHECK(memcmp(&m->track[i], &track[i], offsetof(GroundTrack, tracked)) == 0 && m->track[i].tracked == (i == 1));
    CHECK(memcmp(m->burn[0].p_ecef, burn[0].p_ecef, offsetof(GroundBurn, heat_j_m2)) == 0 &&
          m->burn[0].heat_j_m2 == 1e5f);
    /* a frame without any has no such chunk, and is read as without */
    file.snapshot.marks = (GroundMarks){0};
    CHECK(through(&again, &file, arena) == STATUS_OK);
    CHECK(m->stands == 0 && m->tracks == 0 && m->burns == 0 && m->forgotten == 0);
    arena_destroy(arena);
}

static void every_field_has_its_range(void **state)
{
    (void)state;
    Arena *arena = arena_create();
    log_set_sink(check_listen, NULL);
    for (int wrong = 0; wrong < 13; wrong++) {
        SavedFrame file = small_file(), again;
        switch (wrong) {
        case 0:
            stand[1].p_ecef[2] = NAN;
            break;
        case 1:
            stand[0].r_ecef_from_body[0] = 0.9;
            break;
        case 2:
            stand[0].high_m[1] = -2.5f;
            break;
        case 3:
            stand[0].to_s = -4000;
            break;
        case 4:
            stand[0].from_s = -INFINITY;
            break;
        case 5:
            track[2].b_s = 1;
            break;
        case 6:
            track[2].a_ecef[0] = 1e9;
            break;
        case 7:
            track[0].width_m = -1;
            break;
        case 8:
            track[0].heat_j_m2 = NAN;
            break;
        case 9:
            burn[0].radius_m = INFINITY;
            break;
        case 10:
            burn[0].t_s = NAN;
            break;
        case 11:
            burn[0].p_ecef[1] = INFINITY;
            break;
        default:
            file.snapshot.marks.forgotten = -1;
            break;
        }
        if (through(&again, &file, arena) != STATUS_BAD_VALUE || !strstr(check_said, "out of range"))
            fail_msg("wrong value %d: said \"%s\"", wrong, check_said);
        *check_said = 0;
    }
    log_set_sink(NULL, NULL);
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(marks_come_back_to_the_bit),
        cmocka_unit_test(every_field_has_its_range),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
