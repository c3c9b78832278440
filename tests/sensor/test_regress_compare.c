/* Comparison of planes and records in the regression, on planes of a few pixels whose answers are worked out by hand.
 */
#include "tests/check.h"

#include "render/materials/planck.h"
#include "sensor/verify/regress/verdict.h"

/* 2 x 3; differences 0, 0.02, 0.3, -0.4, 0, 0: two of six beyond 0.05. */
static void shares_and_places_are_counted(void **state)
{
    (void)state;
    const float  expected[6] = {1, 2, 3, 4, 5, 6}, got[6] = {1, 2.02f, 3.3f, 3.6f, 5, 6};
    float        difference[6];
    PlaneVerdict v;
    verdict_compare_numbers(&v, difference, expected, got, 3, 2, &(PlaneLimits){0.05, 0, NULL});
    CHECK(v.compared == 6 && v.beyond == 2);
    CHECK_NEAR(v.share, 2.0 / 6, 1e-15);
    CHECK_NEAR(v.max, 0.4, 1e-6); /* floats of that size step by 2.4e-7 */
    CHECK(v.column == 0 && v.row == 1);
    CHECK_NEAR(v.expected, 4, 0);
    CHECK_NEAR(v.got, 3.6, 1e-6);
    CHECK_NEAR(v.rms, sqrt((0.02 * 0.02 + 0.3 * 0.3 + 0.4 * 0.4) / 6), 1e-6);
    CHECK_NEAR(difference[3], -0.4, 1e-6);

    const uint8_t ignored[6] = {0, 0, 0, 1, 0, 0};
    verdict_compare_numbers(&v, difference, expected, got, 3, 2, &(PlaneLimits){0.05, 0, ignored});
    CHECK(v.compared == 5 && v.beyond == 1 && v.column == 2 && v.row == 0);
    verdict_compare_numbers(&v, NULL, expected, got, 3, 2,
                            &(PlaneLimits){0, 0.09, NULL}); /* 0.27, 0.36 allowed: both beyond still */
    CHECK(v.beyond == 2);
    verdict_compare_numbers(&v, NULL, expected, got, 3, 2, &(PlaneLimits){0, 0.11, NULL}); /* 0.33, 0.44: none */
    CHECK(v.beyond == 0 && v.max > 0.3);
}

static void what_is_not_finite_is_equal_only_to_itself(void **state)
{
    (void)state;
    const float  expected[4] = {INFINITY, NAN, INFINITY, 1}, same[4] = {INFINITY, NAN, INFINITY, 1};
    const float  other[4] = {INFINITY, 2, -INFINITY, NAN};
    PlaneVerdict v;
    verdict_compare_numbers(&v, NULL, expected, same, 4, 1, &(PlaneLimits){0, 0, NULL});
    CHECK(v.beyond == 0 && v.max == 0 && v.column == -1);
    verdict_compare_numbers(&v, NULL, expected, other, 4, 1, &(PlaneLimits){1e30, 10, NULL});
    CHECK(v.beyond == 3 && isinf(v.max) && v.column == 1);
    CHECK(v.unmatched == 3 && v.rms == 0); /* the one pixel that is alike */
}

/* 4 x 3, a square of 7 in the corner; its edge pixels are those that touch another id. */
static void edges_may_differ_only_when_told(void **state)
{
    (void)state;
    const uint32_t expected[12] = {7, 7, 0, 0, 7, 7, 0, 0, 0, 0, 0, 0}, got[12] = {7, 7, 7, 0, 7, 7, 0, 0, 0, 0, 0, 0};
    const uint32_t far[12] = {7, 7, 0, 9, 7, 7, 0, 0, 0, 0, 0, 0};
    uint8_t        edge[12] = {0};
    size_t         at_edge;
    PlaneVerdict   v;
    verdict_compare_ids(&v, &at_edge, expected, got, 4, 3, NULL);
    CHECK(v.beyond == 1 && at_edge == 0 && v.column == 2 && v.row == 0 && v.expected == 0 && v.got == 7);
    /* expected alone: 7s but the corner (0, 0), and 0s beside them: (1,0) (0,1) (1,1) (2,0) (2,1) (0,2) (1,2) */
    CHECK(verdict_mark_edges(edge, expected, expected, 4, 3) == 7 && edge[0] == 0 && edge[3] == 0 && edge[2] == 1);
    /* and of got: (3, 0) too; (2, 0), (2, 1), (1, 1) are there already, (1, 0) has only 7s but (1, 1) around */
    CHECK(verdict_mark_edges(edge, expected, got, 4, 3) == 8 && edge[3] == 1);
    verdict_compare_ids(&v, &at_edge, expected, got, 4, 3, edge);
    CHECK(v.beyond == 0 && at_edge == 1);
    memset(edge, 0, sizeof edge);
    verdict_mark_edges(edge, expected, expected, 4, 3);
    verdict_compare_ids(&v, &at_edge, expected, far, 4, 3, edge);
    CHECK(v.beyond == 1 && v.column == 3 && v.got == 9);
}

static void units_are_those_of_physics(void **state)
{
    (void)state;
    const double low_m = 8e-6, high_m = 12e-6;
    const float  radiance[7] = {
         (float)planck_band(low_m, high_m, 300, NULL), 0,  NAN,     (float)planck_band(low_m, high_m, 250, NULL),
         (float)planck_band(low_m, high_m, 60, NULL),  -1, INFINITY};
    float kelvin[7], db[4];
    verdict_plane_to_kelvin(kelvin, radiance, 7, low_m, high_m);
    CHECK_NEAR(kelvin[0], 300, 1e-4); /* radiance to 24 bits: 4e-6 K */
    CHECK(kelvin[1] == (float)apparent_floor_k &&
          kelvin[4] == kelvin[1]); /* no radiance, and next to none, are alike */
    CHECK(isnan(kelvin[2]) && isnan(kelvin[5]) && isnan(kelvin[6]));
    CHECK_NEAR(kelvin[3], 250, 1e-4);
    const float power[4] = {2, 0.2f, 0, 2e-9f};
    verdict_plane_to_db(db, power, 4, 2, 60);
    CHECK_NEAR(db[0], 0, 0);
    CHECK_NEAR(db[1], -10, 1e-5);
    CHECK_NEAR(db[2], -60, 0);
    CHECK_NEAR(db[3], -60, 0);
}

/* Steps: a mantissa of 1 bit has 1, 1.5, 2, 3, 4; ties go up. */
static void numbers_are_rounded_to_steps(void **state)
{
    (void)state;
    const PlaneRounding one = {1, 0}, half = {0, 0.5}, fine = {16, 0};
    CHECK_NEAR(record_value(&one, record_steps(&one, 1.2f)), 1, 0);
    CHECK_NEAR(record_value(&one, record_steps(&one, 1.25f)), 1.5, 0);
    CHECK_NEAR(record_value(&one, record_steps(&one, 1.8f)), 2, 0);
    CHECK_NEAR(record_value(&one, record_steps(&one, -2.6f)), -3, 0);
    CHECK_NEAR(record_value(&half, record_steps(&half, 3.7f)), 3.5, 0);
    CHECK_NEAR(record_value(&half, record_steps(&half, -0.3f)), -0.5, 0);
    const float odd[6] = {0, -0.0f, INFINITY, -INFINITY, 1e-42f, 3e38f};
    for (int i = 0; i < 6; i++)
        for (int k = 0; k < 2; k++) {
            const float back = record_value(k ? &fine : &half, record_steps(k ? &fine : &half, odd[i]));
            if (isinf(odd[i])) CHECK(back == odd[i]);
            else if (i < 2) CHECK(back == 0);
            else CHECK(!isnan(back));
        }
    CHECK(isnan(record_value(&half, record_steps(&half, NAN))) && isnan(record_value(&fine, record_steps(&fine, NAN))));
    uint64_t worst = 0;
    for (uint32_t i = 0; i < 10000; i++) { /* error of 16 bits: half a step, 2^-17 of itself */
        const float value = (float)(1e-3 * exp(20 * random_uniform(1, 2, 3, i)));
        const float back = record_value(&fine, record_steps(&fine, value));
        if (!(fabs((double)back - (double)value) <= ldexp((double)value, -17))) worst++;
        CHECK(record_steps(&fine, back) == record_steps(&fine, value)); /* what is rounded stays */
    }
    CHECK(worst == 0);
}

static void a_coded_plane_comes_back(void **state)
{
    (void)state;
    enum { width = 37, height = 5 };
    const PlaneRounding rounding[2] = {{11, 0}, {0, 1.0 / 32}};
    float               value[width * height], back[width * height];
    uint32_t            coded[width * height];
    for (uint32_t i = 0; i < width * height; i++)
        value[i] = i % 11 == 3 ? NAN : i % 13 == 5 ? INFINITY : (float)(600 * (random_uniform(4, 5, 6, i) - 0.5));
    for (int k = 0; k < 2; k++) {
        record_code_plane(coded, value, width, height, &rounding[k]);
        record_decode_plane(back, coded, width, height, &rounding[k]);
        for (int i = 0; i < width * height; i++) {
            const float want = record_value(&rounding[k], record_steps(&rounding[k], value[i]));
            CHECK(isnan(want) ? isnan(back[i]) : back[i] == want);
        }
    }
    /* one step up and one down are small in both halves */
    const float stairs[3] = {1, 1.03125f, 1};
    record_code_plane(coded, stairs, 3, 1, &rounding[1]);
    CHECK(coded[0] == 0x400040 && coded[1] == 0x20002 && coded[2] == 0x10001);
    for (uint32_t i = 0; i < width * height; i++) coded[i] = (uint32_t)(4294967296.0 * random_uniform(7, 8, 9, i));
    for (int k = 0; k < 2; k++) record_decode_plane(back, coded, width, height, &rounding[k]); /* any octets: no trap */
}

/* ---- frames ---------------------------------------------------------------------------------- */

enum { pixels = 40 * 25 };

static void make_frame(RecordFrame *f)
{
    *f = (RecordFrame){.number = 7, .width = 40, .height = 25};
    for (int p = 0; plane_recorded(p); p++) {
        if (p == record_plane("optical.Y")) continue;
        if (record_plane_is_id(p)) f->id_plane[p] = calloc(pixels, sizeof(uint32_t));
        else f->number_plane[p] = calloc(pixels, sizeof(float));
        for (int i = 0; i < pixels; i++) {
            if (f->id_plane[p]) f->id_plane[p][i] = i < 500 ? 1 : 2;
            else f->number_plane[p][i] = p == record_plane("temp_k") ? 290 : p == record_plane("range_m") ? 1000 : 10;
        }
    }
}

/* Spoils so many pixels of a plane, and asks what is said first. */
static int first_failure(const char *name, int count, float by, bool edges_allowed)
{
    RecordFrame     expected, got;
    const Tolerance tolerance = case_default().tolerance;
    ChannelResult   result[CHANNEL_COUNT] = {{0}};
    const int       plane = record_plane(name);
    int             first = -1;
    make_frame(&expected);
    make_frame(&got);
    for (int i = 0; i < count; i++) {
        const int at = 480 + i; /* row 12, columns 0 ..: beside the border between 1 and 2 at row 12, column 20 */
        if (got.id_plane[plane]) got.id_plane[plane][at] += (uint32_t)by;
        else got.number_plane[plane][at] += by;
    }
    verdict_frame(result, &expected, &got, &tolerance, edges_allowed);
    for (int k = CHANNEL_COUNT - 1; k >= 0; k--)
        if (result[k].failed) first = k;
    record_frame_free(&expected);
    record_frame_free(&got);
    return first;
}

/* Of 1000 pixels 1 may be beyond (0.1 %). The limits in the planes' own terms: 1 % of 10 and 0.001 of light; 0.05 K is
 * 0.8 % of 10 W/(m2 sr) in 8-12 um at some 230 K; 0.1 dB is 2.3 %. */
static void each_channel_has_its_own_limit(void **state)
{
    (void)state;
    CHECK(first_failure("temp_k", 0, 0, false) == -1);
    CHECK(first_failure("temp_k", 500, 0.04f, false) == -1);
    CHECK(first_failure("temp_k", 1, 5, false) == -1);
    CHECK(first_failure("temp_k", 2, 0.07f, false) == CHANNEL_TEMP);
    CHECK(first_failure("optical.G", 500, 0.09f, false) == -1);
    CHECK(first_failure("optical.G", 2, 0.12f, false) == CHANNEL_OPTICAL);
    CHECK(first_failure("radar.Y", 2, -0.2f, false) == -1);
    CHECK(first_failure("radar.Y", 2, -0.3f, false) == CHANNEL_RADAR);
    CHECK(first_failure("lwir.Y", 2, 0.5f, false) == CHANNEL_LWIR);
    CHECK(first_failure("mwir.Y", 2, 0.5f, false) == CHANNEL_MWIR);
    CHECK(first_failure("ny", 1, 0.005f, false) == CHANNEL_NORMAL); /* geometry: not one pixel */
    CHECK(first_failure("range_m", 1, 0.02f, false) == -1);
    CHECK(first_failure("range_m", 1, 0.04f, false) == CHANNEL_RANGE);
    CHECK(first_failure("entity", 1, 1, false) == CHANNEL_ENTITY);
    CHECK(first_failure("part", 1, 1, false) == CHANNEL_PART);
    CHECK(first_failure("material", 1, 1, false) == CHANNEL_MATERIAL);
    CHECK(first_failure("lwir.Y", 2, NAN, false) == CHANNEL_LWIR);
}

/* A row of the list of planes names a channel that there is, and one name is of one plane. */
static void each_plane_has_a_channel(void **state)
{
    (void)state;
    const PlaneRow *row;
    for (int p = 0; (row = plane_recorded(p)); p++) {
        int channels = 0;
        for (int c = 0; c < CHANNEL_COUNT; c++) channels += strcmp(verdict_channel_name((Channel)c), row->verdict) == 0;
        CHECK(channels == 1 && record_plane(row->record) == p);
        CHECK((row->type != PLANE_F32) == (row->rounding.bits == 0 && !(row->rounding.step > 0)));
    }
    CHECK(record_plane("cover") == record_no_plane);
}

/* Two pixels of a plane get a value; the line that is said of it. */
static const char *line_of(char out[512], const char *name, Channel channel, float was, float is)
{
    RecordFrame     expected, got;
    const Tolerance tolerance = case_default().tolerance;
    ChannelResult   result[CHANNEL_COUNT] = {{0}};
    const int       plane = record_plane(name);
    make_frame(&expected);
    make_frame(&got);
    for (int i = 3; i < 5; i++) {
        expected.number_plane[plane][i] = was;
        got.number_plane[plane][i] = is;
    }
    verdict_frame(result, &expected, &got, &tolerance, false);
    snprintf(out, 512, "%s", result[channel].failed ? result[channel].line : "");
    record_frame_free(&expected);
    record_frame_free(&got);
    return out;
}

static void what_has_no_number_is_said_in_words(void **state)
{
    (void)state;
    char said[512], value[64];
    CHECK(strstr(line_of(said, "lwir.Y", CHANNEL_LWIR, 10, 0), "K became below 100 K at frame 7 (3, 0)"));
    CHECK(strstr(line_of(said, "lwir.Y", CHANNEL_LWIR, 0, 10), "worst below 100 K became "));
    CHECK(!*line_of(said, "lwir.Y", CHANNEL_LWIR, 0, 1e-20f)); /* both colder than anything seen */
    CHECK(strstr(line_of(said, "mwir.Y", CHANNEL_MWIR, 10, NAN), "K became not a number"));
    CHECK(strstr(line_of(said, "range_m", CHANNEL_RANGE, INFINITY, 500), "no surface became 500 m"));
    CHECK(strstr(line_of(said, "range_m", CHANNEL_RANGE, 500, NAN), "500 m became not a number"));
    CHECK(strstr(line_of(said, "optical.G", CHANNEL_OPTICAL, 10, INFINITY), "10 W/(m2 sr) became out of range"));
    for (int c = 0; c < CHANNEL_COUNT; c++) {
        const double odd[] = {INFINITY, -INFINITY, NAN, 0, 1};
        for (int i = 0; i < 5; i++) {
            verdict_channel_value(value, (Channel)c, odd[i], 4);
            CHECK(!strstr(value, "inf") && !strstr(value, "nan"));
        }
    }
}

/* The border has 80 pixels, or a few more with what was changed: 1 of them is within 2 %, 8 are not. */
static void other_libraries_may_change_a_few_edges(void **state)
{
    (void)state;
    CHECK(first_failure("entity", 1, 1, true) == -1);
    CHECK(first_failure("entity", 8, 1, true) == CHANNEL_ENTITY);
}

/* ---- truth ----------------------------------------------------------------------------------- */

static int first_of_truth(const char *expected, const char *got, double factor, char said[512])
{
    ChannelResult result[CHANNEL_COUNT] = {{0}};
    JsonValues    was, is;
    int           first = -1;
    CHECK(json_values_read(&was, expected, strlen(expected), "test", "expected") == STATUS_OK);
    CHECK(json_values_read(&is, got, strlen(got), "test", "got") == STATUS_OK);
    verdict_truth(result, 3, &was, &is, factor);
    for (int k = CHANNEL_COUNT - 1; k >= 0; k--)
        if (result[k].failed) first = k;
    if (first >= 0) snprintf(said, 512, "%s", result[first].line);
    json_values_free(&was);
    json_values_free(&is);
    return first;
}

static void each_field_has_its_own_tolerance(void **state)
{
    (void)state;
    char said[512];
#define TARGET(rest) "{\"frame\":3,\"targets\":[{\"entity\":\"1:2:3\"," rest "}]}"
    CHECK(first_of_truth(TARGET("\"range_m\":1000.0"), TARGET("\"range_m\":1000.001"), 1, said) == -1);
    CHECK(first_of_truth(TARGET("\"range_m\":1000.0"), TARGET("\"range_m\":1000.003"), 1, said) == CHANNEL_MOTION);
    assert_string_equal(said, "targets[1:2:3].range_m is 1000.003, was 1000 in frame 3");
    CHECK(first_of_truth(TARGET("\"range_m\":1000.0"), TARGET("\"range_m\":1000.003"), 2, said) == -1);
    CHECK(first_of_truth(TARGET("\"bands\":{\"lwir\":{\"contrast_k\":2.0}}"),
                         TARGET("\"bands\":{\"lwir\":{\"contrast_k\":2.06}}"), 1, said) == -1);
    CHECK(first_of_truth(TARGET("\"bands\":{\"lwir\":{\"contrast_k\":2.0}}"),
                         TARGET("\"bands\":{\"lwir\":{\"contrast_k\":2.08}}"), 1, said) == CHANNEL_SIGNALS);
    CHECK(first_of_truth(TARGET("\"box_px\":[1,2,3,4]"), TARGET("\"box_px\":[1,2,3,5]"), 1, said) == CHANNEL_TARGETS);
    CHECK(first_of_truth("{\"time_s\":5.0}", "{\"time_s\":5.1}", 1, said) == CHANNEL_TIME);
    CHECK(first_of_truth("{\"sun\":{\"elevation_deg\":10}}", "{\"sun\":{\"elevation_deg\":11}}", 1, said) ==
          CHANNEL_SUN);
    CHECK(first_of_truth("{\"host\":{\"lat_deg\":10}}", "{\"host\":{\"lat_deg\":10.1}}", 1, said) == CHANNEL_POSE);
    CHECK(first_of_truth(TARGET("\"pixels_error\":5"), TARGET("\"pixels_error\":6"), 1, said) == CHANNEL_MOTION);
    CHECK(first_of_truth(TARGET("\"visible_fraction\":0.5"), TARGET("\"visible_fraction\":0.6"), 1, said) ==
          CHANNEL_TARGETS);
    /* an error, to 5 % and 0.001 */
    CHECK(first_of_truth("{\"error\":{\"lwir\":{\"total\":0.1}}}", "{\"error\":{\"lwir\":{\"total\":0.1059}}}", 1,
                         said) == -1);
    CHECK(first_of_truth("{\"error\":{\"lwir\":{\"total\":0.1}}}", "{\"error\":{\"lwir\":{\"total\":0.1061}}}", 1,
                         said) == CHANNEL_ERROR);
}

static void fields_may_come_but_not_go(void **state)
{
    (void)state;
    char said[512];
    CHECK(first_of_truth(TARGET("\"pixels\":3,\"box_px\":[1]"), TARGET("\"pixels\":3"), 1, said) == CHANNEL_TARGETS);
    assert_string_equal(said, "targets[1:2:3].box_px[0] is absent, was 1 in frame 3");
    CHECK(first_of_truth(TARGET("\"pixels\":3"), TARGET("\"pixels\":3,\"box_px\":[1]"), 1, said) == CHANNEL_TARGETS);
    CHECK(first_of_truth(TARGET("\"pixels\":3"), TARGET("\"pixels\":3,\"colour\":\"red\""), 1, said) ==
          -1); /* unknown */
    CHECK(first_of_truth(TARGET("\"colour\":\"red\""), TARGET("\"pixels\":3"), 1, said) == CHANNEL_MOTION);
    CHECK(first_of_truth(TARGET("\"occluded_by\":\"ground\""), TARGET("\"occluded_by\":\"1:1:1\""), 1, said) ==
          CHANNEL_TARGETS);
    CHECK(first_of_truth("{\"frame\":3,\"targets\":[]}", TARGET("\"pixels\":3"), 1, said) == CHANNEL_MOTION);
    CHECK(first_of_truth("{\"frame_sha256\":\"a\"}", "{\"frame_sha256\":\"b\"}", 1, said) == -1);
}

static void counters_are_the_same_or_not(void **state)
{
    (void)state;
    ChannelResult     result[CHANNEL_COUNT] = {{0}};
    JsonValues        was, is;
    static const char one[] = "{\"counters\":{\"dropped\":{\"truncated\":3},\"rays_primary\":5},\"threads\":1}";
    static const char two[] = "{\"counters\":{\"dropped\":{\"truncated\":4},\"rays_primary\":6},\"threads\":2}";
    CHECK(json_values_read(&was, one, strlen(one), "test", "one") == STATUS_OK);
    CHECK(json_values_read(&is, two, strlen(two), "test", "two") == STATUS_OK);
    verdict_counters(result, &was, &was);
    CHECK(!result[CHANNEL_COUNTERS].failed && result[CHANNEL_COUNTERS].there);
    verdict_counters(result, &was, &is);
    CHECK(result[CHANNEL_COUNTERS].failed && result[CHANNEL_COUNTERS].diffs == 1); /* rays may change */
    assert_string_equal(result[CHANNEL_COUNTERS].line, "counters.dropped.truncated is 4, was 3");
    json_values_free(&was);
    json_values_free(&is);
}

/* The same materials under other numbers are equal; a name that the baseline lacks is none of its own. */
static void materials_are_compared_by_name(void **state)
{
    (void)state;
    uint32_t    was[4] = {0, 1, 2, 3}, is[4] = {0, 2, 3, 1}, other[4] = {0, 1, 4, 9};
    char        before[] = "turf,steel,paint", after[] = "paint,turf,steel", more[] = "turf,a,b,glass";
    RecordFrame record = {.width = 4, .height = 1, .material_names = before};
    RecordFrame run = {.width = 4, .height = 1, .material_names = after};
    record.id_plane[record_plane("material")] = was;
    run.id_plane[record_plane("material")] = is;
    CHECK(record_frame_rename_materials(&run, &record) == STATUS_OK && memcmp(is, was, sizeof is) == 0);
    run.material_names = more;
    run.id_plane[record_plane("material")] = other;
    CHECK(record_frame_rename_materials(&run, &record) == STATUS_OK);
    CHECK(other[0] == 0 && other[1] == 1 && other[2] > 3 && other[3] > 3 && other[2] != other[3]);
    run.material_names = NULL; /* by number */
    run.id_plane[record_plane("material")] = was;
    CHECK(record_frame_rename_materials(&run, &record) == STATUS_OK && was[3] == 3);
}

/* Two of three found in one band; rates against each other by the case's tolerances. */
static void scores_are_compared_in_all_bands_and_in_each(void **state)
{
    (void)state;
    static const char was_text[] =
        "{\"ap\":0.5,\"all\":{\"chances\":4,\"found\":3,\"detection\":0.75,\"detection_low\":0.3,"
        "\"detection_high\":0.95,\"frames\":2,\"false_alarms\":1,\"false_alarms_per_frame\":0.5},"
        "\"bands\":{\"lwir\":{\"detection\":1},\"mwir\":{\"detection\":0.5}}}";
    static const char is_text[] =
        "{\"ap\":0.45,\"all\":{\"chances\":4,\"found\":3,\"detection\":0.75,\"frames\":2,\"false_alarms\":1,"
        "\"false_alarms_per_frame\":0.5},\"bands\":{\"lwir\":{\"detection\":0.5},\"mwir\":{\"detection\":1}}}";
    static const char one_band[] = "{\"all\":{\"detection\":0.75,\"false_alarms_per_frame\":0.5},\"ap\":0.5,"
                                   "\"bands\":{\"lwir\":{\"detection\":1}}}";
    JsonValues        was, is, one;
    Tolerance         tolerance = case_default().tolerance;
    CHECK(json_values_read(&was, was_text, strlen(was_text), "test", "was") == STATUS_OK);
    CHECK(json_values_read(&is, is_text, strlen(is_text), "test", "is") == STATUS_OK);
    CHECK(json_values_read(&one, one_band, strlen(one_band), "test", "one") == STATUS_OK);
    ChannelResult same = {0}, other = {0}, wide = {0}, gone = {0}, come = {0};
    verdict_scores(&same, &was, &was, &tolerance);
    CHECK(same.there && !same.failed);
    assert_string_equal(same.line,
                        "detection rate 0.75 (0.3 .. 0.95; 3 of 4 targets), false alarms per frame 0.5 (1 of "
                        "2 frames), AP 0.5");
    verdict_scores(&other, &was, &is, &tolerance);
    CHECK(other.failed && other.diffs == 3); /* AP, lwir, mwir */
    assert_string_equal(other.line, "AP 0.45, was 0.5");
    tolerance.ap = 0.05;
    other = (ChannelResult){0};
    verdict_scores(&other, &was, &is, &tolerance);
    CHECK(other.failed && other.diffs == 2);
    assert_string_equal(other.line, "lwir: detection rate 0.5, was 1");
    tolerance.detection = 0.5;
    verdict_scores(&wide, &was, &is, &tolerance);
    CHECK(wide.there && !wide.failed);
    verdict_scores(&gone, &was, &one, &tolerance); /* a band that is no longer answered differs by any tolerance */
    CHECK(gone.failed && gone.diffs == 1);
    assert_string_equal(gone.line, "mwir: detection rate none, was 0.5");
    verdict_scores(&come, &one, &was, &tolerance);
    CHECK(come.failed && come.diffs == 1);
    json_values_free(&was);
    json_values_free(&is);
    json_values_free(&one);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scores_are_compared_in_all_bands_and_in_each),
        cmocka_unit_test(materials_are_compared_by_name),
        cmocka_unit_test(shares_and_places_are_counted),
        cmocka_unit_test(what_is_not_finite_is_equal_only_to_itself),
        cmocka_unit_test(edges_may_differ_only_when_told),
        cmocka_unit_test(units_are_those_of_physics),
        cmocka_unit_test(numbers_are_rounded_to_steps),
        cmocka_unit_test(a_coded_plane_comes_back),
        cmocka_unit_test(each_channel_has_its_own_limit),
        cmocka_unit_test(each_plane_has_a_channel),
        cmocka_unit_test(what_has_no_number_is_said_in_words),
        cmocka_unit_test(other_libraries_may_change_a_few_edges),
        cmocka_unit_test(each_field_has_its_own_tolerance),
        cmocka_unit_test(fields_may_come_but_not_go),
        cmocka_unit_test(counters_are_the_same_or_not),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
