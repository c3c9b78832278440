/* A table of fields of a toy: what a row says is written, listed in the reference and compared, and nothing else is.
 * tests/system/test_new_field.sh does so with a row of truth.jsonl. */
#include "tests/check.h"

#include "sensor/frame/json_object.h"
#include "sensor/frame/record_fields.h"
#include "sensor/reference/reference.h"
#include "sensor/verify/regress/verdict.h"

#include <stdlib.h>

typedef struct Wheel {
    double radius_m;
    bool   flat;
} Wheel;

typedef struct Toy {
    const char *name;
    char        marking[12];
    DisEntityId id;
    double      speed_mps, turn_rad, at_m[2];
    int         colours, wheels;
    uint64_t    lost;
    Wheel       wheel[3];
} Toy;

static const void *next_wheel(FieldAt *at, int i)
{
    const Toy *t = at->of;
    return i < t->wheels ? &t->wheel[i] : NULL;
}

static const void *by_side(FieldAt *at, int i)
{
    const Toy *t = at->of;
    return i < 2 ? field_keyed(at, i ? "right" : "left", &t->wheel[i]) : NULL;
}

static json_t *motto(FieldAt *at) { return ((const Toy *)at->record)->colours ? json_string("red") : NULL; }

static const Field wheel_rows[] = {
    {"radius_m", "m", "", "", "its size", FIELD_MEMBER(Wheel, radius_m), FIELD_WITHIN(0.1, 0)},
    {"flat", "", "", "", "without air", FIELD_MEMBER(Wheel, flat), .channel = FIELD_TEMP},
};
static const Field side_rows[] = {
    {"SIDE", "", "", "", "one of left, right", FIELD_OBJECT(wheel_rows), .item = by_side, .unless_empty = true},
};
static const Field rows[] = {
    {"name", "", "", "without one", "what it is called", FIELD_MEMBER(Toy, name), FIELD_EXACT},
    {"marking", "", "", "when empty", "octets", FIELD_MEMBER(Toy, marking), .unless_empty = true},
    {"entity", "", "site:application:entity", "", "its id", FIELD_MEMBER(Toy, id), FIELD_EXACT},
    {"speed_mps", "m/s", "", "at rest", "how fast", FIELD_MEMBER(Toy, speed_mps), FIELD_WITHIN(0.5, 0.01),
     .newer = true},
    {"turn_deg", "deg", "", "", "where to", FIELD_MEMBER(Toy, turn_rad), .as = field_deg},
    {"at_m", "m", "x, y", "", "where", FIELD_MEMBER(Toy, at_m)},
    {"motto", "", "", "without a colour", "its first colour", FIELD_GET("string", motto)},
    {"lost", "", "", "when 0", "parts", FIELD_MEMBER(Toy, lost), .unless_0 = true, .channel = FIELD_APART},
    {"wheels", "", "from 0", "", "it rolls on", FIELD_OBJECTS(wheel_rows), .item = next_wheel, .channel = FIELD_MOTION},
    {"sides", "", "", "", "the first two", FIELD_OBJECT(side_rows)},
};
static const FieldTable toy_fields = {rows, sizeof rows / sizeof *rows};

static const Toy a_toy = {.name = "cart",
                          .marking = "a\tb",
                          .id = {1, 2, 3},
                          .speed_mps = 2.5,
                          .turn_rad = pi_rad / 2,
                          .at_m = {1, -2},
                          .colours = 1,
                          .lost = 7,
                          .wheels = 3,
                          .wheel = {{.radius_m = 1}, {.radius_m = NAN, .flat = true}, {.radius_m = 3}}};

static void written(char out[600], const Toy *toy)
{
    char *text = field_line(&toy_fields, toy, 15);
    snprintf(out, 600, "%s", text);
    free(text);
}

static void rows_are_written_in_order(void **state)
{
    (void)state;
    char text[600];
    Toy  plain = a_toy;
    written(text, &a_toy);
    assert_string_equal(text, "{\"name\":\"cart\",\"marking\":\"a\\\\x09b\",\"entity\":\"1:2:3\",\"speed_mps\":2.5,"
                              "\"turn_deg\":90.0,\"at_m\":[1.0,-2.0],\"motto\":\"red\",\"lost\":7,"
                              "\"wheels\":[{\"radius_m\":1.0,\"flat\":false},{\"flat\":true},"
                              "{\"radius_m\":3.0,\"flat\":false}],"
                              "\"sides\":{\"left\":{\"radius_m\":1.0,\"flat\":false},\"right\":{\"flat\":true}}}");
    plain.name = NULL, plain.speed_mps = INFINITY, plain.colours = 0, plain.lost = 0, plain.wheels = 0,
    *plain.marking = 0;
    written(text, &plain);
    assert_string_equal(text, "{\"entity\":\"1:2:3\",\"turn_deg\":90.0,\"at_m\":[1.0,-2.0],"
                              "\"wheels\":[],"
                              "\"sides\":{\"left\":{\"radius_m\":1.0,\"flat\":false},\"right\":{\"flat\":true}}}");
}

static void rows_are_listed(void **state)
{
    (void)state;
    const Reference toy = {
        .topic = "toy", .file = "toy.json", .title = "a toy", .about = "Of the attic.", .table = &toy_fields};
    char  *text = NULL;
    size_t size = 0;
    FILE  *to = open_memstream(&text, &size);
    CHECK(to != NULL);
    reference_write_topic(to, &toy);
    fclose(to);
    static const char *const line[] = {"  name                                   string\n"
                                       "      what it is called. Absent without one.\n",
                                       "  entity                                 string\n"
                                       "      its id; site:application:entity.\n",
                                       "  speed_mps                              number, m/s\n"
                                       "      how fast. Absent at rest.\n",
                                       "  at_m                                   list of 2 numbers, m\n",
                                       "  lost                                   integer\n",
                                       "  wheels                                 list of objects\n",
                                       "  wheels[].radius_m                      number, m\n",
                                       "  wheels[].flat                          boolean\n",
                                       "  sides.SIDE.radius_m                    number, m\n"};
    const char              *at = text;
    for (size_t i = 0; i < sizeof line / sizeof *line; i++) {
        const char *found = strstr(at, line[i]);
        CHECK(found != NULL); /* and in this order */
        at = found ? found : at;
    }
    free(text);
}

/* First channel that differs, with its message; -1: none. */
static int differs(char said[512], const char *expected, const char *got)
{
    ChannelResult   result[CHANNEL_COUNT] = {{0}};
    const FieldRule rule = {&toy_fields, FIELD_POSE, false, 1};
    JsonValues      was, is;
    int             first = -1;
    CHECK(json_values_read(&was, expected, strlen(expected), "test", "expected") == STATUS_OK);
    CHECK(json_values_read(&is, got, strlen(got), "test", "got") == STATUS_OK);
    verdict_fields(result, 0, &was, &is, &rule);
    for (int k = CHANNEL_COUNT - 1; k >= 0; k--)
        if (result[k].failed) first = k;
    snprintf(said, 512, "%s", first >= 0 ? result[first].line : "");
    json_values_free(&was);
    json_values_free(&is);
    return first;
}

static void rows_are_compared(void **state)
{
    (void)state;
    char said[512];
    CHECK(differs(said, "{\"speed_mps\":100.0}", "{\"speed_mps\":101.49}") == -1);
    CHECK(differs(said, "{\"speed_mps\":100.0}", "{\"speed_mps\":101.51}") == CHANNEL_POSE);
    assert_string_equal(said, "speed_mps is 101.51, was 100 in frame 0");
    CHECK(differs(said, "{\"speed_mps\":1.0}", "{}") == CHANNEL_POSE);
    CHECK(differs(said, "{}", "{\"speed_mps\":1.0}") == -1); /* newer */
    CHECK(differs(said, "{}", "{\"name\":\"cart\"}") == CHANNEL_POSE);
    CHECK(differs(said, "{}", "{\"turn_deg\":1.0}") == -1); /* not held: it may be added, not changed, not removed */
    CHECK(differs(said, "{\"turn_deg\":1.0}", "{\"turn_deg\":1.00001}") == CHANNEL_POSE);
    CHECK(differs(said, "{\"turn_deg\":1.0}", "{\"turn_deg\":1.0000001}") == -1);
    CHECK(differs(said, "{\"turn_deg\":1.0}", "{}") == CHANNEL_POSE);
    CHECK(differs(said, "{\"lost\":1}", "{\"lost\":9}") == -1); /* apart */
    CHECK(differs(said, "{\"wheels\":[{\"radius_m\":1.0}]}", "{\"wheels\":[{\"radius_m\":1.2}]}") == CHANNEL_MOTION);
    CHECK(differs(said, "{\"wheels\":[{\"flat\":true}]}", "{\"wheels\":[{\"flat\":false}]}") == CHANNEL_TEMP);
    CHECK(differs(said, "{\"sides\":{\"left\":{\"radius_m\":1.0}}}", "{\"sides\":{\"left\":{\"radius_m\":1.2}}}") ==
          CHANNEL_POSE);
    CHECK(differs(said, "{}", "{\"nobody\":1}") == -1);
}

/* Keys of other programs' records: no row, and nothing is read beyond the end. */
static void paths_without_a_row(void **state)
{
    (void)state;
    static const char *const path[] = {"",
                                       ".",
                                       "[",
                                       "]",
                                       "nobody",
                                       "wheels[",
                                       "wheels[0",
                                       "wheels[0].",
                                       "wheels[0].no",
                                       "name.more",
                                       "sides",
                                       "sides.any.radius_m",
                                       "wheels[1:2.5:3].radius_m"};
    static const char *const row[] = {NULL, NULL, NULL, NULL,    NULL,       "wheels",  "wheels",
                                      NULL, NULL, NULL, "sides", "radius_m", "radius_m"};
    for (size_t i = 0; i < sizeof path / sizeof *path; i++) {
        FieldChannel channel = FIELD_POSE;
        const Field *found = field_find(&channel, &toy_fields, path[i]);
        CHECK(row[i] ? found && strcmp(found->name, row[i]) == 0 : !found);
        CHECK(channel == (strncmp(path[i], "wheels", 6) == 0 ? FIELD_MOTION : FIELD_POSE));
    }
}

/* How far two runs may differ, a second time, so that no bound of truth.jsonl is widened unnoticed. Reasons: positions
 * and ranges are good to 1 mm, angles to 1e-4 deg (0.2 m at 100 km; a pixel of a narrow view is ten times that), areas
 * to a few samples, temperatures to 0.05 K, and what is divided by noise or clutter to 2 %. */
static void bounds_are_as_listed(void **state)
{
    (void)state;
    static const struct {
        const char *path;
        double      absolute, relative;
    } want[] = {
        {"time_s", 1e-6, 0},
        {"targets[1:2:3].range_m", 1e-3, 1e-6},
        {"targets[1:2:3].closing_mps", 1e-3, 1e-6},
        {"targets[1:2:3].aspect_deg", 1e-3, 0},
        {"targets[1:2:3].depression_deg", 1e-4, 0},
        {"targets[1:2:3].los_az_deg", 1e-4, 0},
        {"targets[1:2:3].los_el_deg", 1e-4, 0},
        {"targets[1:2:3].los_rate_dps", 1e-3, 1e-5},
        {"targets[1:2:3].boresight_error_deg", 1e-4, 0},
        {"targets[1:2:3].pixels", 0.02, 0.005},
        {"targets[1:2:3].visible_fraction", 0.005, 0},
        {"targets[1:2:3].foliage_fraction", 0.005, 0},
        {"targets[1:2:3].box_px", 0, 0},
        {"targets[1:2:3].amodal_box_px", 0.02, 0},
        {"targets[1:2:3].dt_k", 0.05, 0},
        {"targets[1:2:3].patch_temp_k", 0.05, 0},
        {"targets[1:2:3].age_s", 1e-5, 0},
        {"targets[1:2:3].position_error_m", 1e-3, 1e-3},
        {"targets[1:2:3].error_px", 0.01, 0.05},
        {"targets[1:2:3].bands.lwir.contrast_k", 0.05, 0.01},
        {"targets[1:2:3].bands.lwir.dt_rss_k", 0.05, 0.01},
        {"targets[1:2:3].bands.lwir.contrast", 0.01, 0.01},
        {"targets[1:2:3].bands.lwir.snr", 0.05, 0.02},
        {"targets[1:2:3].bands.lwir.veil_transmittance", 0.002, 0},
        {"targets[1:2:3].bands.lwir.intensity_w_sr", 1e-4, 0.01},
        {"targets[1:2:3].bands.lwir.intensity_error_w_sr", 1e-4, 0.05},
        {"targets[1:2:3].bands.lwir.error_rms_k", 0.05, 0.05},
        {"targets[1:2:3].bands.lwir.error_median_k", 0.05, 0.05},
    };
    for (size_t i = 0; i < sizeof want / sizeof *want; i++) {
        FieldChannel channel = FIELD_POSE;
        const Field *row = field_find(&channel, &record_frame_fields, want[i].path);
        if (!row || !row->held || row->absolute != want[i].absolute || row->relative != want[i].relative)
            fail_msg("%s: %g, %g", want[i].path, row ? row->absolute : NAN, row ? row->relative : NAN);
    }
    /* none of a target's and a band's is left out of the list but those that are words or exact */
    int held = 0, bounded = 0;
    for (int k = 0; k < target_fields.count; k++) bounded += target_fields.row[k].absolute > 0;
    for (size_t i = 0; i < sizeof want / sizeof *want; i++)
        held += strstr(want[i].path, "targets") && !strstr(want[i].path, "bands") && want[i].absolute > 0;
    assert_int_equal(held, bounded);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_are_written_in_order), cmocka_unit_test(rows_are_listed),
        cmocka_unit_test(rows_are_compared),         cmocka_unit_test(paths_without_a_row),
        cmocka_unit_test(bounds_are_as_listed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
