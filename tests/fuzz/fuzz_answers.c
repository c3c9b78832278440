/* tests/fuzz/fuzz_answers.c: any octets as a file of a recogniser's answers: lines of JSON, or COCO results; what is
 * read is judged against a frame. Without a fuzzer run_corpus.c drives it. */
#include "tests/fuzz/fuzz_seed.h"

#include "sensor/score/judge.h"

#include <stdlib.h>

const int fuzz_rounds = 20000;

static const char *const seed[] = {
    "{\"frame\":3,\"band\":\"lwir\",\"time_s\":1.5,\"answer\":1,\"of\":2,\"class\":\"tank\",\"box_px\":[10,10,20,16],"
    "\"score\":0.75,\"track\":7,\"latency_ms\":12.5,\"late\":false}\n"
    "{\"frame\":3,\"class\":\"lorry\",\"los_deg\":[0.1,-0.2],\"range_m\":900}\n"
    "{\"frame\":4,\"answer\":0,\"of\":0,\"latency_ms\":3}\n",
    "[{\"image_id\":15,\"category_id\":1,\"bbox\":[10,10,10,6],\"score\":0.5},\n"
    " {\"image_id\":16,\"category_id\":99,\"bbox\":[300.5,200,40,20],\"score\":0.25}]",
    "{\"sequence\":\"\",\"frame\":3,\"class\":\"unknown\",\"box_px\":[300,200,340,220],\"score\":-2}\n",
};
enum { seeds = sizeof seed / sizeof *seed };

size_t fuzz_seed(uint8_t *out, uint32_t index) { return fuzz_seed_text(out, seed[index % seeds]); }

/* A small target, a large one, an ignore region and a hidden one. */
static TruthFrame make_frame(TruthTarget target[4])
{
    TruthFrame frame = {.frame = 3, .width = 640, .height = 480, .hour = 12, .deg2 = 12, .km2 = NAN, .focal_px = 9000};
    const double axes[9] = {1, 0, 0, 0, 0, -1, 0, 1, 0};
    frame.bands = 1u << BAND_LWIR, frame.count = frame.room = 4, frame.target = target;
    memcpy(frame.r_cam_from_enu, axes, sizeof axes);
    for (int i = 0; i < 4; i++) {
        const double box[4] = {i == 1 ? 300 : 10 + 30 * i, i == 1 ? 200 : 10, i == 1 ? 40 : 10, i == 1 ? 20 : 6};
        target[i] = (TruthTarget){.id = (uint64_t)i,
                                  .class_number = 1 + i % 2,
                                  .range_m = 1000,
                                  .aspect_deg = 10,
                                  .pixels = (double[]){30, 600, 2, 0}[i],
                                  .visible = 1,
                                  .foliage = NAN,
                                  .seen = i < 3};
        memcpy(target[i].box, box, sizeof box);
        memcpy(target[i].amodal, box, sizeof box);
        for (int b = 0; b < BAND_COUNT; b++) target[i].snr[b] = 3;
    }
    return frame;
}

static void judge(const Answers *answers)
{
    TruthTarget      target[4];
    const TruthFrame frame = make_frame(target);
    Judge            j = {.rules = {.grow = 0.25, .iou = 0.3, .small_px = 100, .max_age_ms = INFINITY, .min_pixels = 5},
                          .answers = answers,
                          .bands = (1u << BAND_COUNT) - 1};
    ScoreRecogniser *report = calloc(1, sizeof *report);
    if (!report || judge_frame(&j, &frame, 0, NULL) != STATUS_OK) abort();
    judge_end_sequence(&j);
    if (judge_report(report, &j) != STATUS_OK) abort();
    const ScoreRates *r = &report->total;
    /* two targets to be found; every answer of the frame is one of three things */
    if (r->chances != 2 || r->found > r->chances || r->recognised > r->found || r->frames != 1) abort();
    if (r->found + r->false_alarms + report->ignored > report->answers || report->elsewhere < 0) abort();
    for (int i = 0; i < report->classes; i++) {
        const ScorePrecision *p = &report->of_class[i].all;
        if (p->ap < 0 || p->ap > 1 + 1e-12 || p->ap50 < p->ap - 1e-12 || p->ap_centre > 1 + 1e-12) abort();
    }
    free(report);
    judge_free(&j);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char                  name[1][256] = {""};
    const AnswerSequences sequences = {1, name, BAND_LWIR};
    CocoImage             image[2] = {{15, 3, -1, BAND_LWIR}, {16, 3, -1, BAND_MWIR}};
    const CocoImages      images = {.count = 2, .image = image};
    Answers               answers = {0};
    JsonStream            stream;
    FILE                 *file = size > 0 ? fmemopen((void *)(uintptr_t)data, size, "r") : NULL;
    if (!file) return 0;
    log_set_level((LogLevel)(LOG_ERROR + 1));
    json_stream_of(&stream, file, "fuzz", 1 << 16);
    const Status status = answers_read_stream(&answers, &stream, 0, &sequences, &images);
    json_stream_close(&stream);
    answers_sort(&answers);
    for (size_t i = 0; i < answers.count; i++) {
        const Answer *a = &answers.one[i];
        if (i > 0 && answers_order(a - 1, a) > 0) abort();
        if (a->sequence != 0 || a->frame < 0 || a->band >= BAND_COUNT || !isfinite(a->score)) abort();
        if (a->found && !a->line_of_sight && !(a->box[2] > 0 && a->box[3] > 0)) abort();
    }
    if (status == STATUS_OK) judge(&answers);
    answers_free(&answers);
    return 0;
}
