/* tests/sensor/test_tracks.c: scores of tracks of sequences worked out by hand; all assignments of small matrices tried
 * one by one; the order in a frame; what hostile answers cost. Random sequences: tests/system/test_tracks_judge.sh. */
#include "sensor/score/assignment.h"
#include "sensor/score/track_fields.h"
#include "sensor/score/tracks.h"
#include "tests/check.h"

/* ---- a frame in a line ---------------------------------------------------------------------------- */

/* `A=1 B? C 2 b3`: truth A, seen, overlaps track 1 by 0.8; B is hidden; C is seen and has none; track 2 is on nothing.
 * `A~1`: by 0.2. `?` behind a letter: hidden, also as `A?=1`. A letter's number is its id. */
static void put(Tracks *t, double t_s, const char *line)
{
    TracksTruth  truth[16];
    TracksAnswer answer[16];
    TracksPair   pair[16];
    TracksFrame  f = {.t_s = t_s, .truth = truth, .answer = answer, .pair = pair};
    for (const char *at = line; *at;) {
        if (*at == ' ') {
            at++;
            continue;
        }
        bool of_truth = false;
        if (*at >= 'A' && *at <= 'Z') {
            truth[f.truths++] = (TracksTruth){.id = (uint64_t)*at++};
            of_truth = true;
        }
        if (*at == '?') truth[f.truths - 1].hidden = *at++;
        const bool on = *at == '=' || *at == '~';
        if (on) pair[f.pairs++] = (TracksPair){f.truths - 1, f.answers, *at++ == '=' ? 0.8 : 0.2};
        if (*at >= '0' && *at <= '9') {
            CHECK(on || !of_truth);
            answer[f.answers++] = (TracksAnswer){.track = (uint32_t)(*at++ - '0')};
            if (*at == '!') answer[f.answers - 1].outside = *at++;
        }
    }
    assert_int_equal(tracks_frame(t, &f), STATUS_OK);
}

static TracksScore of(const char *const *line, int count)
{
    Tracks     *t;
    TracksScore score;
    assert_int_equal(tracks_create(&t, 0.5), STATUS_OK);
    for (int i = 0; i < count; i++) put(t, 10 + 0.5 * i, line[i]);
    assert_int_equal(tracks_score(&score, t), STATUS_OK);
    tracks_destroy(t);
    return score;
}
#define OF(...) of((const char *const[]){__VA_ARGS__}, sizeof((const char *const[]){__VA_ARGS__}) / sizeof(char *))

/* ---- on paper ------------------------------------------------------------------------------------- */

/* One target in ten frames; a track has it in four of them, another in five, which the assignment therefore takes. */
static void one_switch(void **state)
{
    (void)state;
    const TracksScore s = OF("A=1", "A=1", "A=1", "A=1", "A", "A=2", "A=2", "A=2", "A=2", "A=2");
    CHECK(s.frames == 10 && s.present == 10 && s.answers == 9 && s.truths == 1 && s.tracks == 2);
    CHECK(s.idtp == 5 && s.idfp == 4 && s.idfn == 5 && s.idtp_dropped == 0);
    CHECK(s.matched == 9 && s.switches == 1 && s.fragmentations == 1 && s.mostly_tracked == 1);
    CHECK_NEAR(tracks_idf1(&s), 10.0 / 19, 1e-15);
    CHECK_NEAR(tracks_idp(&s), 5.0 / 9, 1e-15);
    CHECK_NEAR(tracks_idr(&s), 0.5, 1e-15);
    CHECK_NEAR(tracks_mota(&s), 0.8, 1e-15); /* a miss and a switch of ten */
    CHECK_NEAR(tracks_purity(&s), 1, 1e-15);
    CHECK_NEAR(tracks_length(&s), 4.5, 1e-15);
    CHECK_NEAR(s.similarity, 9 * 0.8, 1e-12);
    CHECK(s.length_most == 5 && s.tracks_false == 0 && s.coasts == 0 && s.hidings == 0);
}

/* Two targets swap their tracks after three of five frames: 3 + 3 frames by identity, as before the swap. */
static void a_swap(void **state)
{
    (void)state;
    const TracksScore s = OF("A=1 B=2", "A=1 B=2", "A=1 B=2", "A=2 B=1", "A=2 B=1 9");
    CHECK(s.idtp == 6 && s.idfp == 5 && s.idfn == 4 && s.switches == 2 && s.fragmentations == 0);
    CHECK(s.tracks == 3 && s.tracks_false == 1 && s.matched == 10);
    CHECK_NEAR(tracks_purity(&s), 0.6, 1e-15); /* 3 of 5 answers of either; the false one has none */
    CHECK_NEAR(tracks_idf1(&s), 12.0 / 21, 1e-15);
}

/* A match of the frame before is kept, though another is nearer. */
static void a_match_is_kept(void **state)
{
    (void)state;
    Tracks *t;
    assert_int_equal(tracks_create(&t, 0.5), STATUS_OK);
    const TracksTruth  truth[1] = {{.id = 7}};
    const TracksAnswer answer[2] = {{.track = 1}, {.track = 2}};
    const TracksPair   alone[1] = {{0, 0, 0.5}}, both[2] = {{0, 1, 1.0}, {0, 0, 0.5}};
    TracksFrame f = {.t_s = 0, .truth = truth, .truths = 1, .answer = answer, .answers = 1, .pair = alone, .pairs = 1};
    assert_int_equal(tracks_frame(t, &f), STATUS_OK);
    f = (TracksFrame){.t_s = 1, .truth = truth, .truths = 1, .answer = answer, .answers = 2, .pair = both, .pairs = 2};
    assert_int_equal(tracks_frame(t, &f), STATUS_OK);
    TracksScore s;
    assert_int_equal(tracks_score(&s, t), STATUS_OK);
    CHECK(s.switches == 0 && s.matched == 2 && s.idtp == 2 && s.idfp == 1);
    CHECK_NEAR(s.similarity, 1, 1e-15);
    tracks_destroy(t);
}

/* 0.5 s a frame: found after two frames, 1 s, and at once; one never. */
static void delays(void **state)
{
    (void)state;
    const TracksScore s = OF("A C", "A C", "A=1 B=2 C", "A=1 B C~3", "A=1 B");
    CHECK(s.truths == 3 && s.truths_found == 2);
    CHECK_NEAR(tracks_delay_s(&s), 0.5, 1e-15);
    CHECK_NEAR(s.delay_s_most, 1, 1e-15);
    CHECK(s.fragmentations == 0); /* B is not found again */
    CHECK(s.mostly_lost == 1 && s.mostly_tracked == 0);
}

/* A is followed, hides for four frames and is answered in three of them, at last beside it, and resumes with its track;
 * B is followed, hides, is not answered, and comes back as another; C hides unfollowed. */
static void coasting(void **state)
{
    (void)state;
    const TracksScore s = OF("A=1 B=2 C", "A?=1 B? C?=3", "A?=1 B?", "A?~1 B?", "A? B?", "A=1 B=4");
    CHECK(s.hidings == 2 && s.coasts == 1 && s.coast_frames == 3 && s.coast_held == 2 && s.coast_most == 3);
    CHECK_NEAR(s.coast_similarity, 0.8 + 0.8 + 0.2, 1e-15);
    CHECK(s.returns == 2 && s.resumed == 1);
    /* hidden, at the threshold: neither right nor wrong; track 1 beside A is false */
    CHECK(s.beside == 3 && s.answers == 2 + 1 + 2 && s.present == 5 && s.idtp == 3 && s.idfp == 2 && s.idfn == 2);
    CHECK(s.switches == 1 && s.fragmentations == 0 && s.tracks == 3 && s.truths == 3);
}

/* Coasting ends with a gap, with another target, and outside the image. */
static void coasting_ends(void **state)
{
    (void)state;
    TracksScore s = OF("A=1", "A?=1", "A?", "A?=1", "A=1");
    CHECK(s.hidings == 1 && s.coast_frames == 1 && s.returns == 1 && s.resumed == 1);
    s = OF("A=1 B", "A? B=1", "A?=1 B");
    CHECK(s.hidings == 1 && s.coasts == 0 && s.coast_frames == 0 && s.returns == 0);
    s = OF("A=1", "A?=1", "1", "A?=1");
    CHECK(s.hidings == 1 && s.coast_frames == 1);
    s = OF("A=1", "", "A?=1"); /* not in the next frame */
    CHECK(s.hidings == 0 && s.coasts == 0);
    s = OF("A=1", "A", "A?=1"); /* lost before it hid */
    CHECK(s.hidings == 0);
}

static void what_is_left_out(void **state)
{
    (void)state;
    TracksScore s = OF("A=1 2! 3 0 1", "A=1! 2!");
    CHECK(s.answers == 3 && s.idtp == 2 && s.idfp == 1 && s.beside == 2 && s.untracked == 1 && s.repeated == 1);
    s = OF("A B", "A");
    CHECK(s.idfn == 3 && s.idtp == 0 && s.truths == 2 && s.mostly_lost == 2 && tracks_idf1(&s) == 0);
    CHECK(isnan(tracks_idp(&s)) && tracks_idr(&s) == 0 && isnan(tracks_purity(&s)) && isnan(tracks_delay_s(&s)));
    s = OF("1 2", "3");
    CHECK(s.idfp == 3 && s.tracks == 3 && s.tracks_false == 3 && tracks_idf1(&s) == 0 && isnan(tracks_idr(&s)));
    s = OF("", "");
    CHECK(s.frames == 2 && isnan(tracks_idf1(&s)) && isnan(tracks_mota(&s)));
}

static void bad_frames(void **state)
{
    (void)state;
    Tracks *t;
    assert_int_equal(tracks_create(&t, 1), STATUS_OK);
    log_set_sink(check_listen, NULL);
    put(t, 5, "A=1");
    TracksFrame f = {.t_s = 5};
    assert_int_equal(tracks_frame(t, &f), STATUS_BAD_VALUE);
    assert_non_null(strstr(check_said, "give frames in order of time"));
    f.t_s = NAN;
    assert_int_equal(tracks_frame(t, &f), STATUS_BAD_VALUE);
    const TracksTruth twice[2] = {{.id = 3}, {.id = 3}};
    f = (TracksFrame){.t_s = 6, .truth = twice, .truths = 2};
    assert_int_equal(tracks_frame(t, &f), STATUS_BAD_VALUE);
    assert_non_null(strstr(check_said, "write each target once"));
    log_set_sink(NULL, NULL);
    TracksScore s;
    assert_int_equal(tracks_score(&s, t), STATUS_OK);
    CHECK(s.frames == 1 && s.present == 1 && s.matched == 0); /* 0.8 is below the threshold */
    tracks_destroy(t);
    tracks_destroy(NULL);
}

static void truths_one_by_one(void **state)
{
    (void)state;
    Tracks *t;
    assert_int_equal(tracks_create(&t, 0.5), STATUS_OK);
    const char *const line[] = {"B A=1", "B=1 A", "A=2 B?", "A=3"};
    for (int i = 0; i < 4; i++) put(t, i, line[i]);
    int               count;
    TracksTruthScore *truth = tracks_truths(t, &count);
    assert_int_equal(count, 2);
    CHECK(truth[0].id == 'A' && truth[0].visible == 4 && truth[0].hidden == 0 && truth[0].matched == 3);
    CHECK(truth[0].switches == 2 && truth[0].fragmentations == 1 && truth[0].seen_t_s == 0 && truth[0].found_t_s == 0);
    CHECK(truth[1].id == 'B' && truth[1].visible == 2 && truth[1].hidden == 1 && truth[1].found_t_s == 1);
    free(truth);
    tracks_destroy(t);
}

static void sums(void **state)
{
    (void)state;
    TracksScore       a = OF("A=1", "A=1", "A?=1", "A=2"), total = {0};
    const TracksScore b = OF("B", "B=5 C=6", "B=5", "B=5 7"), first = a;
    tracks_add(&total, &a);
    assert_memory_equal(&total, &a, sizeof a);
    tracks_add(&total, &b);
    CHECK(total.sequences == 2 && total.frames == 8 && total.present == 8 && total.idtp == first.idtp + b.idtp);
    CHECK(total.idtp == 2 + 4 && total.tracks == 5 && total.tracks_false == 1 && total.length_most == 3);
    CHECK(total.switches == 1 && total.coast_frames == 1 && total.coast_most == 1 && total.truths == 3);
    CHECK_NEAR(tracks_delay_s(&total), 0.5 / 3, 1e-15);
    CHECK_NEAR(total.delay_s_most, 0.5, 1e-15);
    CHECK_NEAR(tracks_length(&total), (2 + 1 + 3 + 1) / 4.0, 1e-15);
}

static void as_json(void **state)
{
    (void)state;
    const TracksScore s = OF("A=1", "A?~1", "A=2");
    char             *line = field_line(&score_track_fields, &s, 4);
    const char *const has[] = {"\"idf1\":0.4,",    "\"idtp\":1,",    "\"similarity\":0.8,",       "\"delay_s\":0.0,",
                               "\"purity\":0.75,", "\"length\":1.5", "\"coast_similarity\":0.2,", "\"targets\":1,"};
    CHECK(line);
    for (size_t k = 0; k < sizeof has / sizeof *has; k++)
        if (!strstr(line, has[k])) fail_msg("no %s in %s", has[k], line);
    CHECK(!strstr(line, "idf1_most") && !strstr(line, "pairs_dropped") && !strstr(line, "repeated"));
    free(line);
    const TracksScore none = OF(""), some = {.present = 4, .answers = 4, .idtp = 1, .idtp_dropped = 2};
    line = field_line(&score_track_fields, &none, 4);
    CHECK(line && !strstr(line, "idf1") && !strstr(line, "similarity") && !strstr(line, "mota"));
    free(line);
    line = field_line(&score_track_fields, &some, 4);
    CHECK(line && strstr(line, "\"idf1\":0.25,\"idf1_most\":0.75,"));
    free(line);
}

/* ---- the order in a frame ------------------------------------------------------------------------- */

static void shuffle(int *order, int count, uint32_t stream, uint32_t frame)
{
    for (int i = 0; i < count; i++) order[i] = i;
    for (int i = count - 1; i > 0; i--) {
        const int at = (int)(random_uniform(5, stream, frame, (uint64_t)i) * (i + 1)), kept = order[i];
        order[i] = order[at];
        order[at] = kept;
    }
}

/* Similarities of few values, so that assignments are tied. */
static TracksScore shuffled(uint32_t by)
{
    enum { truths = 6, answers = 7 };
    Tracks *t;
    assert_int_equal(tracks_create(&t, 0.5), STATUS_OK);
    for (uint32_t n = 0; n < 200; n++) {
        int          order[truths], turn[answers], line[truths * answers];
        TracksTruth  truth[truths];
        TracksAnswer answer[answers];
        TracksPair   pair[truths * answers];
        shuffle(order, truths, by, n);
        shuffle(turn, answers, by + 1, n);
        shuffle(line, truths * answers, by + 2, n);
        if (by == 0) {
            for (int i = 0; i < truths; i++) order[i] = i;
            for (int j = 0; j < answers; j++) turn[j] = j;
        }
        for (int i = 0; i < truths; i++)
            truth[order[i]] = (TracksTruth){(uint64_t)i, random_uniform(6, 0, n, (uint64_t)i) < 0.2};
        for (int j = 0; j < answers; j++)
            answer[turn[j]] =
                (TracksAnswer){.track = 1 + (uint32_t)(random_uniform(6, 1, n, (uint64_t)j) * 4) * 8 + (uint32_t)j};
        for (int k = 0; k < truths * answers; k++) {
            const int i = k / answers, j = k % answers;
            pair[line[k]] = (TracksPair){order[i], turn[j], floor(4 * random_uniform(6, 2, n, (uint64_t)k)) / 4};
        }
        const TracksFrame f = {.t_s = n,
                               .truth = truth,
                               .truths = truths,
                               .answer = answer,
                               .answers = answers,
                               .pair = pair,
                               .pairs = truths * answers};
        assert_int_equal(tracks_frame(t, &f), STATUS_OK);
    }
    TracksScore s;
    assert_int_equal(tracks_score(&s, t), STATUS_OK);
    tracks_destroy(t);
    return s;
}

static void order_changes_nothing(void **state)
{
    (void)state;
    const TracksScore one = shuffled(0);
    CHECK(one.switches > 100 && one.coast_frames > 10 && one.idtp > 50);
    for (uint32_t by = 3; by < 12; by += 3) {
        const TracksScore other = shuffled(by);
        assert_memory_equal(&one, &other, sizeof one);
    }
}

/* ---- assignment ----------------------------------------------------------------------------------- */

static double best_of_all(const double *weight, int rows, int columns, unsigned taken, int row)
{
    if (row == rows) return 0;
    double best = best_of_all(weight, rows, columns, taken, row + 1);
    for (int c = 0; c < columns; c++)
        if (!(taken >> c & 1) && weight[row * columns + c] > 0)
            best = fmax(best, weight[row * columns + c] + best_of_all(weight, rows, columns, taken | 1u << c, row + 1));
    return best;
}

/* Integers, many of them equal, and any; sparse and dense; more rows and more columns. */
static void assignments_of_small_matrices(void **state)
{
    (void)state;
    Arena *arena = arena_create();
    for (uint32_t n = 0; n < 3000; n++) {
        const int rows = 1 + (int)(n % 6), columns = 1 + (int)(n / 6 % 6);
        double    full[36], weight[36], sum = 0;
        int       first[7] = {0}, column[36], match[6], count = 0;
        unsigned  taken = 0;
        for (int r = 0; r < rows; r++) {
            for (int c = 0; c < columns; c++) {
                const double u = random_uniform(8, n, 0, (uint64_t)(r * columns + c)),
                             v = random_uniform(8, n, 1, (uint64_t)(r * columns + c));
                double *w = &full[r * columns + c];
                *w = u < (n % 4) * 0.25 ? 0 : n % 3 ? floor(5 * v) : v;
                if (*w > 0 || n % 2) column[count] = c, weight[count++] = *w;
            }
            first[r + 1] = count;
        }
        const Assignment of = {.rows = rows, .columns = columns, .first = first, .column = column, .weight = weight};
        assert_int_equal(assignment_greatest(match, &of, arena), STATUS_OK);
        for (int r = 0; r < rows; r++) {
            if (match[r] < 0) continue;
            CHECK(!(taken >> match[r] & 1) && full[r * columns + match[r]] > 0);
            taken |= 1u << match[r];
            sum += full[r * columns + match[r]];
        }
        CHECK_NEAR(sum, best_of_all(full, rows, columns, 0, 0), n % 3 ? 0 : 1e-14);
        arena_reset(arena);
    }
    arena_destroy(arena);
}

/* ---- hostile -------------------------------------------------------------------------------------- */

/* 64 answers a frame. A true track is among tracks that are new in every frame, each of which meets another truth: of
 * those no count can be kept, and of the true one all are. */
static void a_flood_of_tracks(void **state)
{
    (void)state;
    enum { frames = 20000, answers = 64 };
    Tracks *t;
    assert_int_equal(tracks_create(&t, 0.5), STATUS_OK);
    TracksTruth  truth[2] = {{.id = 1}, {.id = 2}};
    TracksAnswer answer[answers];
    TracksPair   pair[answers];
    for (int j = 0; j < answers; j++) pair[j] = (TracksPair){j > 0, j, 0.9};
    for (uint32_t n = 0; n < frames; n++) {
        for (uint32_t j = 0; j < answers; j++) answer[j].track = j ? 1000 + n * answers + j : 1;
        assert_int_equal(tracks_frame(t, &(TracksFrame){.t_s = n,
                                                        .truth = truth,
                                                        .truths = 2,
                                                        .answer = answer,
                                                        .answers = answers,
                                                        .pair = pair,
                                                        .pairs = answers}),
                         STATUS_OK);
    }
    TracksScore s;
    assert_int_equal(tracks_score(&s, t), STATUS_OK);
    CHECK(s.answers == (uint64_t)frames * answers && s.present == 2 * frames);
    CHECK(s.tracks == 1 + (uint64_t)frames * (answers - 1)); /* each ended once */
    CHECK(s.tracks_ended > 0 && s.tracks_ended < s.tracks && s.length_most == frames &&
          s.tracks_false == s.tracks - 1 - frames);
    /* exactly known is frames + 1; the pairs that went had 1 each, of which one only could have counted */
    CHECK(s.pairs_dropped > 0 && s.idtp_dropped == s.pairs_dropped);
    CHECK(s.idtp == frames + 1 && tracks_idf1_most(&s) >= tracks_idf1(&s) && tracks_idf1_most(&s) <= 1);
    tracks_destroy(t);
}

/* More truths than there is room for, and longer lists than a frame may have. */
static void too_many(void **state)
{
    (void)state;
    static TracksTruth  truth[3000];
    static TracksAnswer answer[1500];
    Tracks             *t;
    assert_int_equal(tracks_create(&t, 0.5), STATUS_OK);
    const TracksPair pair[3] = {{0, 0, 1}, {1, 1400, 1}, {2000, 1, 1}}; /* the latter two are dropped */
    for (int n = 0; n < 5; n++) {
        for (int i = 0; i < 3000; i++) truth[i] = (TracksTruth){.id = (uint64_t)(n * 3000 + i)};
        for (int j = 0; j < 1500; j++) answer[j].track = (uint32_t)j + 1;
        assert_int_equal(tracks_frame(t, &(TracksFrame){.t_s = n,
                                                        .truth = truth,
                                                        .truths = 3000,
                                                        .answer = answer,
                                                        .answers = 1500,
                                                        .pair = pair,
                                                        .pairs = 3}),
                         STATUS_OK);
    }
    TracksScore s;
    assert_int_equal(tracks_score(&s, t), STATUS_OK);
    CHECK(s.present == 15000 && s.truths == 4096 && s.truths_dropped == 15000 - 4096 && s.crowded == 5 * 476);
    CHECK(s.answers == 5 * 1024 && s.matched == 4 && s.idtp == 1 && s.idtp_dropped == 1); /* the fifth frame's first */
    tracks_destroy(t);
}

/* All truths and tracks met, by counts that differ little: what the assignment costs at the limit. */
static void the_largest_assignment(void **state)
{
    (void)state;
    enum { rows = 2048, each = 128, columns = 2048 };
    Arena *arena = arena_create();
    int   *first = calloc(rows + 1, sizeof *first), *column = calloc(rows * each, sizeof *column),
        *match = calloc(rows, sizeof *match);
    double *weight = calloc(rows * each, sizeof *weight);
    CHECK(arena && first && column && match && weight);
    for (int r = 0; r < rows; r++) {
        first[r + 1] = (r + 1) * each;
        for (int k = 0; k < each; k++) {
            column[r * each + k] = (r % 16 * 128 + k) % columns; /* 128 rows want the same 128 columns */
            weight[r * each + k] = 1000 + floor(1000 * random_uniform(9, 0, (uint32_t)r, (uint64_t)k));
        }
    }
    const double     before_s = cpu_s();
    const Assignment of = {.rows = rows, .columns = columns, .first = first, .column = column, .weight = weight};
    assert_int_equal(assignment_greatest(match, &of, arena), STATUS_OK);
    printf("%d rows, %d entries: %.2f s\n", rows, rows * each, cpu_s() - before_s);
    int count = 0;
    for (int r = 0; r < rows; r++) count += match[r] >= 0;
    CHECK(count == rows); /* all can have one, and it is worth it */
    arena_destroy(arena);
    free(first), free(column), free(match), free(weight);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_switch),
        cmocka_unit_test(a_swap),
        cmocka_unit_test(a_match_is_kept),
        cmocka_unit_test(delays),
        cmocka_unit_test(coasting),
        cmocka_unit_test(coasting_ends),
        cmocka_unit_test(what_is_left_out),
        cmocka_unit_test(bad_frames),
        cmocka_unit_test(truths_one_by_one),
        cmocka_unit_test(sums),
        cmocka_unit_test(as_json),
        cmocka_unit_test(order_changes_nothing),
        cmocka_unit_test(assignments_of_small_matrices),
        cmocka_unit_test(a_flood_of_tracks),
        cmocka_unit_test(too_many),
        cmocka_unit_test(the_largest_assignment),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
