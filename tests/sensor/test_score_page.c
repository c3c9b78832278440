/* tests/sensor/test_score_page.c: the page of a report: elements that close, text that stays text, numbers of the
 * report in their places, equal octets; which cases are the worst. */
#include "sensor/score/score_page.h"
#include "tests/check.h"
#include "tests/sensor/score_example.h"

#include "sensor/publish/images/image_file.h"

#include <sys/stat.h>
#include <unistd.h>

static char *page_of(const ScoreReport *report)
{
    char path[text_file_size], *text;
    text_file(path, "");
    size_t octets;
    assert_int_equal(score_write_page(report, path), STATUS_OK);
    assert_int_equal(text_read_file(&text, &octets, "test", path, 16 << 20), STATUS_OK);
    remove(path);
    assert_int_equal(strlen(text), octets);
    return text;
}

static int times_of(const char *text, const char *what)
{
    int count = 0;
    for (; (text = strstr(text, what)); text++) count++;
    return count;
}

/* ---- elements that close --------------------------------------------------------------------------- */

/* The first wrong place of a page, NULL: none. Every element but the void ones closes in the order of opening,
 * attributes have double quotes, `<` and `&` are markup alone. */
static const char *ill_formed(const char *text)
{
    static const char *const alone[] = {"!doctype", "meta", "img", "br"};
    char                     open[64][16];
    int                      depth = 0;
    for (const char *at = text; *at; at++) {
        if (*at == '&') {
            const size_t name = strspn(at + 1, "abcdefghijklmnopqrstuvwxyz");
            if (name == 0 || at[1 + name] != ';') return at;
        }
        if (*at == '>') return at;
        if (*at != '<') continue;
        const char  *begin = at;
        const bool   closes = at[1] == '/';
        const size_t length = strspn(at + 1 + closes, "!abcdefghijklmnopqrstuvwxyz0123456789");
        char         name[16];
        if (length == 0 || length >= sizeof name) return begin;
        snprintf(name, sizeof name, "%.*s", (int)length, at + 1 + closes);
        for (at += 1 + closes + length; *at != '>'; at++) {
            if (!*at || *at == '<') return begin;
            if (*at != '"') continue;
            at = strchr(at + 1, '"');
            if (!at) return begin;
        }
        bool single = at[-1] == '/';
        for (size_t k = 0; k < sizeof alone / sizeof *alone; k++) single = single || strcmp(name, alone[k]) == 0;
        if (closes) {
            if (depth == 0 || strcmp(open[--depth], name) != 0) return begin;
        } else if (!single) {
            if (depth == 64) return begin;
            strcpy(open[depth++], name);
            if (strcmp(name, "style") == 0) { /* its text is no markup */
                at = strstr(at, "</style>");
                if (!at) return begin;
                at--;
            }
        }
    }
    return depth ? "(the end)" : NULL;
}

static void elements_close(void **state)
{
    (void)state;
    for (int n = 1; n <= score_recognisers_max; n++) {
        ScoreReport report = example_report(n);
        char       *text = page_of(&report);
        const char *wrong = ill_formed(text);
        if (wrong) fail_msg("%d recognisers: %.80s", n, wrong);
        /* nothing of another place is asked for */
        CHECK(!strstr(text, "http://") ||
              times_of(text, "http://") == times_of(text, "xmlns=\"http://www.w3.org/2000/svg\""));
        CHECK(!strstr(text, "https://") && !strstr(text, "<script") && !strstr(text, "<link") && !strstr(text, "url("));
        CHECK(!strstr(text, "nan") && !strstr(text, "inf\"") && !strstr(text, ">inf"));
        CHECK(strstr(text, "prefers-color-scheme:dark"));
        free(text);
        free(report.recogniser);
    }
    /* its twins */
    CHECK(!ill_formed("<p>a &amp; <br>b</p>"));
    CHECK(ill_formed("<p>a & b</p>") && ill_formed("<p><b></p></b>") && ill_formed("<p>") &&
          ill_formed("<p title=\"a>b</p>") && ill_formed("a > b") && ill_formed("a < b"));
}

/* A report of nothing: one recogniser without answers, no rates known. */
static void a_report_of_nothing(void **state)
{
    (void)state;
    const ScoreShare unknown = {NAN, NAN, NAN};
    ScoreRecogniser  r = {.map = NAN, .map50 = NAN, .ap_centre = NAN};
    r.total.detection = r.total.recognition = r.total.per_frame = r.total.per_deg2 = r.total.per_km2 = unknown;
    ScoreReport report = {.rules = score_default_rules(), .sequences = 1, .recognisers = 1, .recogniser = &r};
    char       *text = page_of(&report);
    CHECK(!ill_formed(text) && strstr(text, "No answer has a track number.") && strstr(text, ">None.<"));
    CHECK(!strstr(text, "nan"));
    free(text);
}

/* ---- text stays text ------------------------------------------------------------------------------- */

static void hostile_texts(void **state)
{
    (void)state;
    static const char hostile[] = "</td><script>alert(1)</script>\"'&\x1b[31m\xff\xe2\x80\xae";
    ScoreReport       report = example_report(2);
    for (int k = 0; k < 2; k++) {
        ScoreRecogniser *r = &report.recogniser[k];
        snprintf(r->name, sizeof r->name, "%s", hostile);
        snprintf(r->file, sizeof r->file, "%s", hostile);
        r->words = 1;
        snprintf(r->word[0].word, sizeof r->word[0].word, "<img src=x>%.8s", hostile);
        for (int i = 0; i < r->missed.count; i++) {
            snprintf(r->missed.one[i].name, sizeof r->missed.one[i].name, "%s", hostile);
            snprintf(r->missed.one[i].sequence, sizeof r->missed.one[i].sequence, "%s", hostile);
            snprintf(r->missed.one[i].id, sizeof r->missed.one[i].id, "<b>");
            snprintf(r->false_alarms.one[i].name, sizeof r->false_alarms.one[i].name, "%s", hostile);
        }
    }
    snprintf(report.out, sizeof report.out, "%s", hostile);
    char       *text = page_of(&report);
    const char *wrong = ill_formed(text);
    if (wrong) fail_msg("%.80s", wrong);
    CHECK(!strstr(text, "<script") && !strstr(text, "<img src=x") && !strstr(text, "<b>"));
    CHECK(strstr(text, "&lt;/td&gt;&lt;script&gt;alert(1)&lt;/script&gt;&quot;"));
    CHECK(strstr(text, "\\x1B[31m\\xFF") || strstr(text, "\\x1b[31m\\xff"));
    CHECK(!strchr(text, '\x1b') && !strstr(text, "\xe2\x80\xae") && !strchr(text, '\xff'));
    free(text);
    free(report.recogniser);
}

/* ---- numbers --------------------------------------------------------------------------------------- */

static void numbers_of_the_report(void **state)
{
    (void)state;
    ScoreReport      report = example_report(1);
    ScoreRecogniser *r = &report.recogniser[0];
    r->total.detection = (ScoreShare){0.8125, 0.75, 0.875};
    r->total.per_frame = (ScoreShare){0.034, 0.02, 0.06};
    r->against[AGAINST_RANGE].count = 2;
    r->against[AGAINST_RANGE].bin[0] =
        (ScoreRates){.from = 1000, .to = 2000, .chances = 40, .detection = {0.5, 0.25, 0.75}};
    r->against[AGAINST_RANGE].bin[1] = (ScoreRates){.from = 4000, .to = NAN, .chances = 10, .detection = {0.1, 0, 0.4}};
    r->tracks.idtp = 4480; /* of 9120 and 8800: 0.5 */
    char *text = page_of(&report);
    CHECK(strstr(text, "<td>0.81<small>0.75 \xe2\x80\x93 0.88</small></td>"));
    CHECK(strstr(text, "<td>0.034<small>0.020 \xe2\x80\x93 0.060</small></td>"));
    CHECK(strstr(
        text, "<tr><td>1 &ndash; 2</td><td class=\"n\">40</td><td class=\"n\">0.500</td><td class=\"n\">0.250</td><td "
              "class=\"n\">0.750</td>"));
    CHECK(strstr(text, "<tr><td>from 4</td><td class=\"n\">10</td>"));
    CHECK(strstr(text, "<td>IDF1</td><td class=\"n\">0.500</td>"));
    /* three slots of (538 - 62) / 3, the middle one a gap; 0.25 .. 0.75 of 272 .. 52 */
    CHECK(strstr(text, "points=\" 62.0,217.0 62.0,107.0 220.7,107.0 220.7,217.0\""));
    CHECK(strstr(text, "cx=\"141.3\" cy=\"162.0\" r=\"4.0\""));
    CHECK(strstr(text, "cx=\"458.7\" cy=\"250.0\" r=\"4.0\""));
    free(text);
    free(report.recogniser);
}

/* ---- the worst ------------------------------------------------------------------------------------- */

static WorstCase a_miss(int target, int frame, double weight)
{
    WorstCase c = {.frame = frame, .band = BAND_LWIR, .weight = weight, .t_s = frame, .box_px = {NAN, 0, 0, 0}};
    snprintf(c.id, sizeof c.id, "1:1:%d", target);
    return c;
}

/* 40 targets, each missed in ten frames: of the twelve worst targets the worst frame, in any order of telling. */
static void the_worst(void **state)
{
    (void)state;
    WorstCases first = {0};
    for (uint32_t by = 0; by < 5; by++) {
        WorstCases cases = {0};
        for (int n = 0; n < 400; n++) {
            const int k = (int)((unsigned)n * (by == 0 ? 1u : 12 * by - 5) % 400), target = k % 40, frame = k / 40;
            const WorstCase c = a_miss(target, frame, 100 + target - fabs(frame - 3.2));
            worst_add(&cases, &c);
        }
        assert_int_equal(cases.count, worst_most);
        for (int i = 0; i < worst_most; i++) {
            char id[24];
            snprintf(id, sizeof id, "1:1:%d", 39 - i);
            assert_string_equal(cases.one[i].id, id);
            assert_int_equal(cases.one[i].frame, 3);
        }
        if (by == 0) first = cases;
        assert_memory_equal(&first, &cases, sizeof cases);
    }
    WorstCases none = {0};
    WorstCase  c = a_miss(1, 1, NAN);
    worst_add(&none, &c);
    CHECK(none.count == 0);
    /* answers without a track: alike within 25 frames and of one class */
    c = (WorstCase){.frame = 30, .name = "tank", .weight = 0.5};
    worst_add(&none, &c);
    c.frame = 40, c.weight = 0.9;
    worst_add(&none, &c);
    CHECK(none.count == 1 && none.one[0].frame == 40);
    c.frame = 60, c.weight = 0.7;
    worst_add(&none, &c);
    snprintf(c.name, sizeof c.name, "truck");
    c.frame = 41, c.weight = 0.95;
    worst_add(&none, &c);
    CHECK(none.count == 3 && none.one[0].frame == 41 && none.one[1].frame == 40 && none.one[2].frame == 60);
}

/* A page of cases told in another order is the same. */
static void equal_octets(void **state)
{
    (void)state;
    ScoreReport one = example_report(3), other = example_report(3);
    WorstCases  again = {0};
    for (int i = other.recogniser[0].missed.count - 1; i >= 0; i--)
        worst_add(&again, &other.recogniser[0].missed.one[i]);
    other.recogniser[0].missed = again;
    char *a = page_of(&one), *b = page_of(&other);
    assert_string_equal(a, b);
    free(a), free(b);
    other.recogniser[1].total.detection.value += 0.01;
    a = page_of(&one), b = page_of(&other);
    CHECK(strcmp(a, b) != 0);
    free(a), free(b);
    free(one.recogniser), free(other.recogniser);
}

/* ---- crops ----------------------------------------------------------------------------------------- */

/* The frame's PNG is cropped about the box, which is marked in it; a box at the image's edge, of another size and none.
 */
static void crops(void **state)
{
    (void)state;
    char folder[temp_path_size], path[temp_path_size + 64];
    CHECK(temp_folder(folder));
    for (int depth = 0; depth < 2; depth++) {
        snprintf(path, sizeof path, "%s/%s", folder, depth ? "frames/lwir" : "frames");
        assert_int_equal(mkdir(path, 0700), 0);
    }
    static uint8_t grey[96 * 128];
    for (int i = 0; i < 96 * 128; i++) grey[i] = (uint8_t)(i * 7);
    for (int n = 0; n < 2; n++) {
        snprintf(path, sizeof path, "%s/frames/lwir/%06d.png", folder, n);
        assert_int_equal(image_write_png(path, grey, 128, 96, 1, 8), STATUS_OK);
    }
    ScoreReport      report = example_report(1);
    ScoreRecogniser *r = &report.recogniser[0];
    snprintf(report.out, sizeof report.out, "%s", folder);
    r->missed = r->false_alarms = (WorstCases){0};
    WorstCase c = {.frame = 0, .band = BAND_LWIR, .weight = 4, .box_px = {60, 40, 16, 8}, .id = "1:1:1"};
    worst_add(&r->missed, &c); /* 48 px about (68, 44): from (44, 20) */
    c = (WorstCase){.frame = 1, .band = BAND_LWIR, .weight = 3, .box_px = {120, 0, 20, 4}, .id = "1:1:2"};
    worst_add(&r->missed, &c); /* 60 px in the corner: from (68, 0) */
    c = (WorstCase){.frame = 2, .band = BAND_LWIR, .weight = 2, .box_px = {60, 40, 16, 8}, .id = "1:1:3"};
    worst_add(&r->missed, &c); /* no such file */
    c = (WorstCase){.frame = 1, .band = BAND_LWIR, .weight = 1, .box_px = {NAN, NAN, NAN, NAN}, .id = "1:1:4"};
    worst_add(&r->missed, &c);
    char *text = page_of(&report);
    CHECK(!ill_formed(text) && times_of(text, "data:image/png") == 2);
    CHECK(strstr(text, "<a href=\"frames/lwir/000000.png\">"));
    CHECK(strstr(text, "<i style=\"left:33.33%;top:41.67%;width:33.33%;height:16.67%\">"));
    CHECK(strstr(text, "<i style=\"left:86.67%;top:0.00%;width:13.33%;height:6.67%\">"));
    free(text);
    snprintf(path, sizeof path, "rm -r '%s'", folder);
    assert_int_equal(system(path), 0);
    free(report.recogniser);
}

static void no_place(void **state)
{
    (void)state;
    log_set_sink(check_listen, NULL);
    ScoreReport report = example_report(1);
    assert_int_equal(score_write_page(&report, "/nowhere/at/all.html"), STATUS_IO);
    assert_non_null(strstr(check_said, "/nowhere/at/all.html"));
    log_set_sink(NULL, NULL);
    free(report.recogniser);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(elements_close), cmocka_unit_test(a_report_of_nothing),
        cmocka_unit_test(hostile_texts),  cmocka_unit_test(numbers_of_the_report),
        cmocka_unit_test(the_worst),      cmocka_unit_test(equal_octets),
        cmocka_unit_test(crops),          cmocka_unit_test(no_place),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
