/* Answers as JSON: an object with a list, and lines of answers.jsonl: what they mean, and everything that is refused,
 * each for its reason. */
#include "tests/sensor/answer_lab.h"

static Answer answer;

static AnswerReason read_text(const char *text)
{
    return answer_read(&answer, (const uint8_t *)text, strlen(text), &answer_scope);
}

static void an_object(void **state)
{
    (void)state;
    static const char text[] =
        "{\"frame\": 12, \"band\": \"lwir\", \"detections\": [\n"
        " {\"class\": \"tank\", \"score\": 0.9, \"box_px\": [1, 2.5, 64, 48.0], \"track\": 4294967295},\n"
        " {\"class\": \"truck\", \"score\": 1, \"los_deg\": [-90, 45], \"range_m\": 1200},\n"
        " {\"los_deg\": [359.5, -90], \"box_px\": [0, 0, 1, 1]}]}\n";
    const double half_pi = 0.5 * 3.141592653589793;
    CHECK(read_text(text) == ANSWER_GOOD);
    CHECK(answer.form == ANSWER_JSON && answer.count == 3 && answer.band == BAND_LWIR);
    CHECK(answer.numbered && answer.frame == 12 && answer.number_bits == UINT32_MAX && !answer.timed);
    const AnswerDetection *d = answer.detection;
    assert_memory_equal(d[0].box_px, ((const double[4]){1, 2.5, 64, 48}), sizeof d[0].box_px);
    CHECK(d[0].score == 0.9 && d[0].track == UINT32_MAX && strcmp(d[0].class_name, "tank") == 0);
    CHECK(isnan(d[0].los_rad[0]) && isnan(d[0].range_m) && isnan(d[0].point_px[0]) && !d[0].located);
    CHECK_NEAR(d[1].los_rad[0], 3 * half_pi, 1e-12);
    CHECK_NEAR(d[1].los_rad[1], 0.5 * half_pi, 1e-12);
    CHECK(d[1].range_m == 1200 && isnan(d[1].box_px[0]) && d[1].track == 0);
    CHECK(isnan(d[2].score) && *d[2].class_name == 0 && d[2].box_px[3] == 1);
    CHECK_NEAR(d[2].los_rad[1], -half_pi, 1e-12);
    CHECK(read_text("{\"frame\":0,\"band\":\"lwir\",\"detections\":[]}") == ANSWER_GOOD && answer.count == 0);
    const size_t end = strlen(text) - 2; /* without the last brace and its newline */
    for (size_t cut = 0; cut <= end; cut++)
        CHECK(answer_read(&answer, (const uint8_t *)text, cut, &answer_scope) != ANSWER_GOOD);
}

/* Lines as a run writes them, of both kinds. */
static void lines(void **state)
{
    (void)state;
    static const char two[] =
        "{\"frame\":12,\"band\":\"lwir\",\"time_s\":1369.0,\"answer\":1,\"of\":2,\"class\":\"truck\",\"box_px\":[28.0,24.0,36.0,"
        "27.0],\"score\":0.9,\"track\":3,\"latency_ms\":41.7,\"age_ms\":99.5,\"late\":false,\"form\":\"klv\"}\n"
        "{\"frame\":12,\"band\":\"lwir\",\"time_s\":1369.0,\"answer\":2,\"of\":2,\"class\":\"\",\"los_deg\":[10.0,-3.0],"
        "\"range_m\":900.0,\"latency_ms\":41.7,\"late\":true,\"form\":\"ring\"}\n";
    static const char none[] = "{\"frame\":12,\"band\":\"lwir\",\"time_s\":1.0,\"answer\":0,\"of\":0,\"late\":false}";
    CHECK(read_text(two) == ANSWER_GOOD && answer.count == 2 && answer.frame == 12 && answer.detection[0].track == 3);
    CHECK(answer.detection[1].range_m == 900 && isnan(answer.detection[1].score) &&
          isnan(answer.detection[1].box_px[0]));
    for (size_t cut = 0; cut + 2 < sizeof two; cut++)
        CHECK(answer_read(&answer, (const uint8_t *)two, cut, &answer_scope) != ANSWER_GOOD);
    CHECK(read_text(none) == ANSWER_GOOD && answer.count == 0);
    /* without `of`, as many as there are */
    CHECK(
        read_text(
            "{\"frame\":1,\"band\":\"lwir\",\"box_px\":[0,0,1,1]} {\"frame\":1,\"band\":\"lwir\",\"box_px\":[0,0,2,2]}") ==
            ANSWER_GOOD &&
        answer.count == 2);
}

#define LINE(fields) "{\"frame\":1,\"band\":\"lwir\"," fields "}"
#define LIST(fields) "{\"frame\":1,\"band\":\"lwir\",\"detections\":[{" fields "}]}"
#define BOX          "\"box_px\":[0,0,1,1]"

static void what_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char  *text;
        AnswerReason reason;
    } of[] = {
        {LIST(BOX), ANSWER_GOOD},
        {LINE(BOX), ANSWER_GOOD},
        /* no JSON */
        {"{", ANSWER_NO_JSON},
        {"{}{", ANSWER_FIELD},
        {"{\"frame\":1", ANSWER_NO_JSON},
        {LIST(BOX) "x", ANSWER_NO_JSON},
        {LIST("\"score\":NaN," BOX), ANSWER_NO_JSON},
        {LIST("\"score\":1e999," BOX), ANSWER_NO_JSON},
        {LIST("\"track\":99999999999999999999," BOX), ANSWER_NO_JSON},
        {LIST("\"class\":\"\xff\"," BOX), ANSWER_NO_JSON},
        {LIST("\"class\":\"a\\u0000b\"," BOX), ANSWER_NO_JSON},
        {LIST(BOX "," BOX), ANSWER_NO_JSON}, /* a field twice */
        {"{\"frame\":1,\"frame\":1,\"band\":\"lwir\",\"detections\":[]}", ANSWER_NO_JSON},
        /* fields: missing, unknown, of another type */
        {"{}", ANSWER_FIELD},
        {"{\"band\":\"lwir\",\"detections\":[]}", ANSWER_FIELD},
        {"{\"frame\":1,\"detections\":[]}", ANSWER_FIELD},
        {"{\"frame\":1,\"band\":\"lwir\",\"detections\":{}}", ANSWER_FIELD},
        {"{\"frame\":1,\"band\":\"lwir\",\"detections\":[1]}", ANSWER_FIELD},
        {"{\"frame\":1,\"band\":\"lwir\",\"detections\":[],\"x\":1}", ANSWER_FIELD},
        {"{\"frame\":1,\"band\":\"lwir\",\"detections\":[]," BOX "}", ANSWER_FIELD},
        {"{\"frame\":1.0,\"band\":\"lwir\",\"detections\":[]}", ANSWER_FIELD},
        {"{\"frame\":-1,\"band\":\"lwir\",\"detections\":[]}", ANSWER_FIELD},
        {"{\"frame\":2147483648,\"band\":\"lwir\",\"detections\":[]}", ANSWER_FIELD},
        {"{\"frame\":1,\"band\":2,\"detections\":[]}", ANSWER_FIELD},
        {LIST("\"frame\":1," BOX), ANSWER_FIELD},
        {LIST("\"x\":1," BOX), ANSWER_FIELD},
        {LINE("\"x\":1," BOX), ANSWER_FIELD},
        {LINE("\"late\":1," BOX), ANSWER_FIELD},
        {LINE("\"time_s\":\"1\"," BOX), ANSWER_FIELD},
        {LIST("\"class\":1," BOX), ANSWER_FIELD},
        {LIST("\"score\":\"1\"," BOX), ANSWER_FIELD},
        {LIST("\"score\":null," BOX), ANSWER_FIELD},
        {LIST("\"track\":1.5," BOX), ANSWER_FIELD},
        {LIST("\"track\":-1," BOX), ANSWER_FIELD},
        {LIST("\"track\":4294967296," BOX), ANSWER_FIELD},
        {LIST("\"box_px\":[0,0,1]"), ANSWER_FIELD},
        {LIST("\"box_px\":[0,0,1,1,1]"), ANSWER_FIELD},
        {LIST("\"box_px\":[0,0,1,[1]]"), ANSWER_FIELD},
        {LIST("\"box_px\":[0,0,1,null]"), ANSWER_FIELD},
        {LIST("\"los_deg\":[0]"), ANSWER_FIELD},
        {LIST("\"los_deg\":{\"az\":0}"), ANSWER_FIELD},
        /* values */
        {"{\"frame\":1,\"band\":\"mwir\",\"detections\":[]}", ANSWER_BAND},
        {"{\"frame\":1,\"band\":\"\",\"detections\":[]}", ANSWER_BAND},
        {LIST(""), ANSWER_BOX}, /* no place at all */
        {LINE("\"of\":1"), ANSWER_BOX},
        {LIST("\"box_px\":[0,0,0,1]"), ANSWER_BOX},
        {LIST("\"box_px\":[0,0,64.001,1]"), ANSWER_BOX},
        {LIST("\"box_px\":[0,-1,1,1]"), ANSWER_BOX},
        {LIST("\"box_px\":[0,0,1,48.5]"), ANSWER_BOX},
        {LIST("\"box_px\":[0,0,1e300,1]"), ANSWER_BOX},
        {LIST("\"score\":1.001," BOX), ANSWER_SCORE},
        {LIST("\"score\":-0.001," BOX), ANSWER_SCORE},
        {LIST("\"los_deg\":[360.01,0]"), ANSWER_SIGHT},
        {LIST("\"los_deg\":[0,90.01]"), ANSWER_SIGHT},
        {LIST("\"los_deg\":[0,-1e308]"), ANSWER_SIGHT},
        {LIST("\"los_deg\":[360,90]"), ANSWER_GOOD},
        {LIST("\"los_deg\":[-360,-90]"), ANSWER_GOOD},
        {LIST("\"range_m\":0," BOX), ANSWER_RANGE},
        {LIST("\"range_m\":-5," BOX), ANSWER_RANGE},
        {LIST("\"range_m\":1e10," BOX), ANSWER_RANGE},
        {LIST("\"class\":\"0123456789012345678901234567890\"," BOX), ANSWER_GOOD},
        {LIST("\"class\":\"01234567890123456789012345678901\"," BOX), ANSWER_TEXT},
        {LIST("\"class\":\"a\\n\"," BOX), ANSWER_TEXT},
        {LIST("\"class\":\"\xc3\xa4\"," BOX), ANSWER_TEXT},
        /* lines that do not belong together */
        {LINE(BOX) LINE("\"of\":2," BOX), ANSWER_COUNT},
        {LINE("\"of\":2," BOX), ANSWER_COUNT},
        {LINE("\"of\":1," BOX) LINE("\"of\":1," BOX), ANSWER_COUNT},
        {LINE("\"of\":-1," BOX), ANSWER_COUNT},
        {LINE("\"of\":65," BOX), ANSWER_COUNT},
        {LINE("\"of\":0," BOX), ANSWER_FIELD},
        {LINE("\"of\":0") LINE("\"of\":0"), ANSWER_COUNT},
        {LINE(BOX) "{\"frame\":2,\"band\":\"lwir\"," BOX "}", ANSWER_FIELD},
        {LIST(BOX) LIST(BOX), ANSWER_COUNT},
        {LIST(BOX) LINE(BOX), ANSWER_COUNT},
        {LINE(BOX) LIST(BOX), ANSWER_COUNT},
        {LINE(BOX) "1", ANSWER_NO_JSON},
        {LINE(BOX) "[]", ANSWER_FIELD},
    };
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        const AnswerReason reason = read_text(of[i].text);
        if (reason != of[i].reason) fail_msg("%zu: %s: %s", i, of[i].text, answer_reason_name[reason]);
    }
}

/* 64 detections and 65, as a list and as lines; and nesting as deep as a datagram allows. */
static void many_and_deep(void **state)
{
    (void)state;
    static char text[answer_octets_most + 1];
    for (int form = 0; form < 2; form++)
        for (int count = answer_detections_most; count <= answer_detections_most + 1; count++) {
            size_t used = form == 0 ? (size_t)sprintf(text, "{\"frame\":1,\"band\":\"lwir\",\"detections\":[") : 0;
            for (int i = 0; i < count; i++)
                used += (size_t)sprintf(text + used, "%s",
                                        form == 1 ? LINE(BOX) "\n"
                                        : i == 0  ? "{" BOX "}"
                                                  : ",{" BOX "}");
            if (form == 0) sprintf(text + used, "]}");
            CHECK(read_text(text) == (count == answer_detections_most ? ANSWER_GOOD : ANSWER_COUNT));
        }
    static const char *const begin[] = {"{\"detections\":", "{\"frame\":", "{\"x\":"};
    static const size_t      depths[] = {1, 5, 100, 2000, 3000, 65000};
    for (int k = 0; k < 3; k++)
        for (int n = 0; n < 6; n++)
            for (int closed = 0; closed < 2; closed++) {
                const size_t depth = closed && depths[n] > 32000 ? 32000 : depths[n];
                size_t       used = (size_t)sprintf(text, "%s", begin[k]);
                memset(text + used, '[', depth);
                memset(text + used + depth, ']', closed ? depth : 0);
                strcpy(text + used + depth + (closed ? depth : 0), "}");
                CHECK(read_text(text) != ANSWER_GOOD);
            }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_object),
        cmocka_unit_test(lines),
        cmocka_unit_test(what_is_refused),
        cmocka_unit_test(many_and_deep),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
