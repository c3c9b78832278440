/* Forms of answers and of truth: what is read, what is refused with its line, and that the order of lines, and the file
 * that they come in, change nothing. */
#include "tests/sensor/score_fixture.h"

#include "sensor/frame/json_object.h"
#include "sensor/score/answers.h"
#include "sensor/score/json_pick.h"
#include "sensor/score/score_fields.h"

/* ---- refused ---------------------------------------------------------------------------------------------- */

static char said[512];

static void hear(void *user, LogLevel level, const char *line)
{
    (void)user;
    if (level == LOG_ERROR && !*said) snprintf(said, sizeof said, "%s", line);
}

static Status read_answers(Answers *out, const char *text, int default_band)
{
    char             name[1][256] = {""};
    AnswerSequences  sequences = {1, name, default_band};
    CocoImage        image = {17, 4, -1, BAND_LWIR};
    const CocoImages images = {.count = 1, .image = &image};
    JsonStream       stream;
    json_stream_of(&stream, fmemopen((void *)(uintptr_t)text, strlen(text), "r"), "answers", 1 << 16);
    *out = (Answers){0};
    *said = 0;
    log_set_sink(hear, NULL);
    const Status status = answers_read_stream(out, &stream, 0, &sequences, &images);
    log_set_sink(NULL, NULL);
    json_stream_close(&stream);
    return status;
}

static void test_refused(void **state)
{
    (void)state;
    static const struct {
        const char *line, *says;
    } cases[] = {
        {"[1]", "no JSON object"},
        {"{\"frame\":-1,\"class\":\"tank\",\"box_px\":[1,2,3,4]}", "`frame`"},
        {"{\"frame\":0.5,\"class\":\"tank\",\"box_px\":[1,2,3,4]}", "`frame`"},
        {"{\"frame\":1e300,\"class\":\"tank\",\"box_px\":[1,2,3,4]}", "`frame`"},
        {"{\"frame\":1,\"band\":\"uv\",\"class\":\"tank\",\"box_px\":[1,2,3,4]}", "`band` is none"},
        {"{\"frame\":1,\"class\":\"tank\",\"box_px\":[3,2,1,4]}", "`box_px`"},
        {"{\"frame\":1,\"class\":\"tank\",\"box_px\":[1,2,3]}", "`box_px`"},
        {"{\"frame\":1,\"class\":\"tank\",\"box_px\":[1,2,1e12,4]}", "`box_px`"},
        {"{\"frame\":1,\"class\":\"tank\"}", "neither `box_px`, nor `los_deg`"},
        {"{\"frame\":1,\"class\":\"tank\",\"los_deg\":[1,91]}", "`los_deg`"},
        {"{\"frame\":1,\"class\":7,\"box_px\":[1,2,3,4]}", "`class`"},
        {"{\"frame\":1,\"class\":\"tank\",\"box_px\":[1,2,3,4],\"score\":\"high\"}", "`score`"},
        {"{\"frame\":1,\"class\":\"tank\",\"box_px\":[1,2,3,4],\"track\":-1}", "`track`"},
        {"{\"frame\":1,\"class\":\"tank\",\"box_px\":[1,2,3,4],\"range_m\":-5}", "`range_m`"},
        {"{\"frame\":1,\"class\":\"tank\",\"box_px\":[1,2,3,4],\"latency_ms\":\"old\"}", "`latency_ms`"},
        {"{\"frame\":1,\"sequence\":\"v9\",\"class\":\"tank\",\"box_px\":[1,2,3,4]}", "`sequence`"},
        {"nonsense", "no JSON object"},
    };
    char    text[512];
    Answers answers;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        snprintf(text, sizeof text, "{\"frame\":0}\n\n%s\n{\"frame\":2}\n", cases[i].line);
        const Status status = read_answers(&answers, text, BAND_LWIR);
        if (status != STATUS_BAD_VALUE || !strstr(said, cases[i].says) || !strstr(said, "answers:3:"))
            fail_msg("%s: %s, said '%s'", cases[i].line, status_name(status), said);
        answers_free(&answers);
    }
    CHECK(read_answers(&answers, "{\"frame\":0}\n", -1) == STATUS_BAD_VALUE && strstr(said, "`band` is missing"));
    answers_free(&answers);
    static const char *const results[] = {
        "[{\"image_id\":18,\"category_id\":1,\"bbox\":[1,2,3,4],\"score\":1}]",
        "[{\"image_id\":17,\"category_id\":1,\"bbox\":[1,2,0,4],\"score\":1}]",
        "[{\"image_id\":17,\"bbox\":[1,2,3,4],\"score\":1}]",
        "[{\"image_id\":17,\"category_id\":1,\"bbox\":[1,2,3,4],\"score\":1}",
        "[{\"image_id\":17,\"category_id\":1,\"bbox\":[1,2,3,4],\"score\":1} 5]",
        "[7]",
    };
    for (size_t i = 0; i < sizeof results / sizeof *results; i++) {
        const Status status = read_answers(&answers, results[i], BAND_LWIR);
        if (status != STATUS_BAD_VALUE) fail_msg("%s: %s", results[i], status_name(status));
        answers_free(&answers);
    }
}

static void test_read(void **state)
{
    (void)state;
    Answers answers;
    size_t  count;
    CHECK(read_answers(&answers,
                       "{\"frame\":4,\"class\":\"TANK\",\"box_px\":[1,2,4,8],\"score\":0.25,\"track\":4294967295}\n"
                       "{\"frame\":4,\"band\":\"optical\",\"class\":\"lorry\",\"los_deg\":[359,-2]}\n"
                       "{\"frame\":4,\"answer\":0,\"of\":0,\"latency_ms\":3.5,\"late\":true}\n"
                       "{\"frame\":4,\"class\":\"tank\",\"box_", /* of a file that is still being written */
                       BAND_LWIR) == STATUS_OK);
    answers_sort(&answers);
    CHECK(answers.count == 3 && answers.lines_of_sight && answers.words == 1 &&
          strcmp(answers.word[0].word, "lorry") == 0);
    CHECK(answers.bands == (1u << BAND_LWIR | 1u << BAND_OPTICAL));
    const Answer *a = answers_of(&count, &answers, 0, 4, BAND_LWIR);
    CHECK(count == 2 && a[0].found && a[0].track == UINT32_MAX && a[0].box[2] == 3 && a[0].box[3] == 6);
    CHECK(a[0].class_number == 1 && isnan(a[0].range_m) && isnan(a[0].latency_ms));
    CHECK(!a[1].found && a[1].late && a[1].latency_ms == 3.5f);
    answers_of(&count, &answers, 0, 5, BAND_LWIR);
    CHECK(count == 0);
    answers_free(&answers);
    CHECK(read_answers(&answers,
                       " [ {\"image_id\":17,\"category_id\":2,\"bbox\":[1,2,3,4],\"score\":0.5},\n"
                       "{\"image_id\":17,\"category_id\":99,\"bbox\":[1,2,3,4],\"score\":0.5}]",
                       -1) == STATUS_OK);
    CHECK(answers.count == 2 && answers.one[0].frame == 4 && answers.one[0].class_number == 2);
    CHECK(answers.one[1].class_number == 0 && strcmp(answers.word[0].word, "category 99") == 0);
    answers_free(&answers);
}

/* ---- what is wanted of a line ------------------------------------------------------------------------------ */

static void test_pick(void **state)
{
    (void)state;
    static const char *const names[] = {"a", "list"};
    static const struct {
        const char *text, *want;
    } cases[] = {
        {"{\"a\":1,\"b\":{\"a\":[2]},\"list\":[{\"b\":\"}\\\"\",\"a\":\"x\\\\\"},3]}",
         "{\"a\":1,\"list\":[{\"a\":\"x\\\\\"},3]}"},
        {" { \"b\" : 1 , \"a\" : null } ", "{\"a\":null}"},
        {"[]", "[]"},
        {"{\"b\":[[[{}]]]}", "{}"},
        {"{\"a\":1", NULL},
        {"{\"a\" 1}", NULL},
        {"{\"a\":1]", NULL},
        {"{\"a\":1}x", NULL},
        {"{\"b\":}", NULL},
        {"{\"b\":1 \"a\":2}", NULL},
        {"{\"a\":\"", NULL},
        {"[1 2", NULL},
    };
    char out[256];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const size_t length = json_pick(out, cases[i].text, strlen(cases[i].text), names, 2);
        const char  *want = cases[i].want ? cases[i].want : "";
        if (length != strlen(want) || memcmp(out, want, length) != 0)
            fail_msg("%s: '%.*s'", cases[i].text, (int)length, out);
    }
}

/* ---- order ------------------------------------------------------------------------------------------------- */

enum { lines_most = 400 };

static char *report_text(const ScoreFolder *f)
{
    ScoreReport report;
    CHECK(score_folder_run(&report, f, NULL) == STATUS_OK);
    char *text = field_line(&score_fields, &report, 17);
    CHECK(text);
    score_report_free(&report);
    return text;
}

/* Many answers of few scores, boxes and classes, so that ties abound. */
static void test_permuted(void **state)
{
    (void)state;
    static char              line[lines_most][160];
    static const char *const kind[] = {"tank", "truck", "unknown"};
    ScoreFolder              f;
    char                    *first = NULL;
    score_folder_open(&f);
    for (int frame = 0; frame < 10; frame++) {
        score_frame(&f, frame, "\"lwir\",\"mwir\"");
        for (int k = 0; k < 4; k++) {
            const int box[4] = {100 + 12 * k, 100, 110 + 12 * k, 106};
            score_target(&f, k ? "," : "", k + 1, kind[k % 2], box, k == 3 ? 3 : 60 * k + 20);
        }
        score_frame_end(&f);
    }
    for (int i = 0; i < lines_most; i++) {
        const int n[5] = {
            (int)(10 * random_uniform(1, 1, 0, (uint64_t)i)), (int)(4 * random_uniform(1, 2, 0, (uint64_t)i)),
            (int)(3 * random_uniform(1, 3, 0, (uint64_t)i)), (int)(3 * random_uniform(1, 4, 0, (uint64_t)i)),
            (int)(2 * random_uniform(1, 5, 0, (uint64_t)i))};
        snprintf(line[i], sizeof line[i],
                 "{\"frame\":%d,\"band\":\"%s\",\"class\":\"%s\",\"box_px\":[%d,100,%d,106],\"score\":0.%d,"
                 "\"latency_ms\":%d,\"range_m\":%d,\"track\":%d}\n",
                 n[0], n[4] ? "lwir" : "mwir", kind[n[2]], 98 + 12 * n[1], 108 + 12 * n[1], 5 + n[3], 5 * n[3],
                 1190 + n[4], i % 7);
    }
    for (int shuffle = 0; shuffle < 5; shuffle++) {
        for (int i = 0; i < lines_most; i++) fputs(line[i], f.answers);
        score_folder_close(&f);
        char *text = report_text(&f);
        if (!first) first = text;
        else CHECK(strcmp(text, first) == 0);
        if (text != first) free(text);
        for (int i = lines_most - 1; i > 0; i--) { /* Fisher and Yates */
            const int k = (int)((i + 1) * random_uniform(2, (uint32_t)shuffle, 0, (uint64_t)i));
            char      held[sizeof line[0]];
            memcpy(held, line[i], sizeof held);
            memcpy(line[i], line[k], sizeof held);
            memcpy(line[k], held, sizeof held);
        }
        f.answers = score_file(&f, "answers.jsonl");
    }
    CHECK(strstr(first, "\"found\":") && !strstr(first, "\"found\":0,"));
    free(first);
    score_folder_close(&f);
    score_folder_remove(&f);
}

/* ---- truth ------------------------------------------------------------------------------------------------- */

static void test_bad_truth(void **state)
{
    (void)state;
    static const char *const lines[] = {
        "{\"frame\":0}\n", "[]\n", "{\"frame\":\"0\"\n\n", "0\n",
        "{\"frame\":6,\"time_s\":6,\"sensors\":[{\"bands\":[\"swir\"],\"width_px\":9,\"height_px\":9,"
        "\"hfov_deg\":4,\"vfov_deg\":3}],\"targets\":[]}\n"};
    for (size_t i = 0; i <= sizeof lines / sizeof *lines; i++) {
        ScoreFolder f;
        ScoreReport report;
        score_folder_open(&f);
        score_frame(&f, 5, "\"lwir\"");
        score_frame_end(&f);
        if (i < sizeof lines / sizeof *lines) {
            fputs(lines[i], f.truth);
        } else { /* a frame twice */
            score_frame(&f, 5, "\"lwir\"");
            score_frame_end(&f);
        }
        fputs("{\"frame\":5}\n", f.answers);
        score_folder_close(&f);
        *said = 0;
        log_set_sink(hear, NULL);
        const Status status = score_folder_run(&report, &f, NULL);
        log_set_sink(NULL, NULL);
        if (status != STATUS_BAD_VALUE || !strstr(said, "truth.jsonl:2:"))
            fail_msg("line %zu: %s, '%s'", i, status_name(status), said);
        CHECK(report.recognisers == 0 && !report.recogniser);
        score_folder_remove(&f);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_refused),  cmocka_unit_test(test_read),      cmocka_unit_test(test_pick),
        cmocka_unit_test(test_permuted), cmocka_unit_test(test_bad_truth),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
