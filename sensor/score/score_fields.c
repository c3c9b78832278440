/* sensor/score/score_fields.c: score.json: its fields, from a ScoreReport. */
#include "sensor/score/score_fields.h"

#include "sensor/frame/json_object.h"
#include "sensor/frame/target_record.h"
#include "sensor/score/report.h"
#include "sensor/score/track_fields.h"

#define IN_RATES(member)      FIELD_MEMBER(ScoreRates, member)
#define IN_SHARE(member)      FIELD_MEMBER(ScoreShare, member)
#define IN_PRECISION(member)  FIELD_MEMBER(ScorePrecision, member)
#define IN_ERRORS(member)     FIELD_MEMBER(ScoreErrors, member)
#define IN_AGES(member)       FIELD_MEMBER(ScoreAges, member)
#define IN_POINT(member)      FIELD_MEMBER(ScorePoint, member)
#define IN_RULES(member)      FIELD_MEMBER(ScoreRules, member)
#define IN_RECOGNISER(member) FIELD_MEMBER(ScoreRecogniser, member)
#define IN_REPORT(member)     FIELD_MEMBER(ScoreReport, member)

/* ---- rates --------------------------------------------------------------------------------------- */

static const void *known_share(const ScoreShare *share) { return isfinite(share->value) ? share : NULL; }
static const void *detection_of(const void *of) { return known_share(&((const ScoreRates *)of)->detection); }
static const void *recognition_of(const void *of) { return known_share(&((const ScoreRates *)of)->recognition); }
static const void *per_frame_of(const void *of) { return known_share(&((const ScoreRates *)of)->per_frame); }
static const void *per_deg2_of(const void *of) { return known_share(&((const ScoreRates *)of)->per_deg2); }
static const void *per_km2_of(const void *of) { return known_share(&((const ScoreRates *)of)->per_km2); }

static const Field share_rows[] = {
    {"value", "", "", "", "the rate", IN_SHARE(value)},
    {"low", "", "", "", "lower bound of 95 %, over sequences", IN_SHARE(low)},
    {"high", "", "", "", "upper bound of 95 %, over sequences", IN_SHARE(high)},
};

/* clang-format off */
#define RATES_ROWS \
    {"chances", "", "", "", "targets to be found: one a target, frame and band", IN_RATES(chances)}, \
    {"found", "", "", "", "those that an answer names, whatever its class", IN_RATES(found)}, \
    {"recognised", "", "", "", "those that an answer names with their class", IN_RATES(recognised)}, \
    {"sequences", "", "", "", "sequences that have such a target", IN_RATES(sequences)}, \
    {"samples", "", "", "", "effective number of sequences: 1 over the sum of squares of their shares of the chances", \
     IN_RATES(samples)}, \
    {"detection", "", "", "without a target to be found", "detection rate: found of chances", .in = detection_of, \
     FIELD_OBJECT(share_rows)}, \
    {"recognition", "", "", "without a target to be found", "recognised of chances", .in = recognition_of, \
     FIELD_OBJECT(share_rows)}, \
    {"frames", "", "", "", \
     "frames times bands that were scored; of a bin: those whose largest target to be found is in it", \
     IN_RATES(frames)}, \
    {"frames_answered", "", "", "", "of these: with an answer, also one that found nothing", IN_RATES(frames_answered)}, \
    {"false_alarms", "", "", "", "answers in these frames that name nothing", IN_RATES(false_alarms)}, \
    {"deg2", "deg2", "", "", "fields of view of these frames, together", IN_RATES(deg2)}, \
    {"km2", "km2", "on the map", "", "visible ground of these frames, together; 0: not known", IN_RATES(km2)}, \
    {"per_frame", "", "", "without a frame", "false alarms a frame", .in = per_frame_of, FIELD_OBJECT(share_rows)}, \
    {"per_deg2", "1/deg2", "", "without a frame", "false alarms a square degree", .in = per_deg2_of, \
     FIELD_OBJECT(share_rows)}, \
    {"per_km2", "1/km2", "on the map", "where truth has no ground_km2", "false alarms a km2 of visible ground", \
     .in = per_km2_of, FIELD_OBJECT(share_rows)},
/* clang-format on */

static const Field rates_rows[] = {RATES_ROWS};
static const Field bin_rows[] = {
    {"from", "as the quantity", "", "", "first value of the bin", IN_RATES(from)},
    {"to", "as the quantity", "", "of the last bin, where it has no end", "value behind the bin", IN_RATES(to)},
    RATES_ROWS};

static const void *the_total(const void *of) { return &((const ScoreRecogniser *)of)->total; }

static const void *next_band_rates(FieldAt *at, int i)
{
    const ScoreRecogniser *r = at->of;
    if (i >= BAND_COUNT) return NULL;
    return field_keyed(at, r->bands >> i & 1 ? band_name((Band)i) : "", &r->band[i]);
}

static const Field band_rows[] = {
    {"BAND", "", "", "when the band was not scored", "as `total`, of one band", .item = next_band_rates,
     FIELD_OBJECT(rates_rows)},
};

/* ---- against quantities -------------------------------------------------------------------------- */

static const void *next_bin(FieldAt *at, int i)
{
    const ScoreBins *bins = at->of;
    return i < bins->count ? &bins->bin[i] : NULL;
}

static const void *bins_of(const void *of, ScoreAgainst which)
{
    const ScoreBins *bins = &((const ScoreRecogniser *)of)->against[which];
    return bins->count > 0 ? bins : NULL;
}
static const void *by_range(const void *of) { return bins_of(of, AGAINST_RANGE); }
static const void *by_pixels(const void *of) { return bins_of(of, AGAINST_PIXELS); }
static const void *by_aspect(const void *of) { return bins_of(of, AGAINST_ASPECT); }
static const void *by_visible(const void *of) { return bins_of(of, AGAINST_VISIBLE); }
static const void *by_foliage(const void *of) { return bins_of(of, AGAINST_FOLIAGE); }
static const void *by_snr(const void *of) { return bins_of(of, AGAINST_SNR); }
static const void *by_hour(const void *of) { return bins_of(of, AGAINST_HOUR); }

#define BINS(find) .in = (find), .item = next_bin, FIELD_OBJECTS(bin_rows)

static const Field against_rows[] = {
    {"range_m", "m", "", "without a target to be found", "as `total`, by range", BINS(by_range)},
    {"pixels", "px", "", "without a target to be found", "by visible area of the target", BINS(by_pixels)},
    {"aspect_deg", "deg", "its body; clockwise from above", "without a target to be found",
     "by direction of the sensor from the target: sectors about 0 (nose on), 45, 90 (from its right) ...",
     BINS(by_aspect)},
    {"visible_fraction", "", "0 .. 1", "where truth has none", "by share of the target that is not hidden",
     BINS(by_visible)},
    {"foliage_fraction", "", "0 .. 1", "where truth has none", "by share of the target that plants hide",
     BINS(by_foliage)},
    {"snr", "", "", "where truth has none", "by snr in the band, without its sign", BINS(by_snr)},
    {"hour", "h", "local solar time", "without a target to be found", "by time of day, from the sun's direction",
     BINS(by_hour)},
};

/* ---- classes ------------------------------------------------------------------------------------- */

static const void *every_band(const void *of) { return &((const ScoreClass *)of)->all; }

static const void *next_band_of_class(FieldAt *at, int i)
{
    const ScoreClass *c = at->of;
    if (i >= BAND_COUNT) return NULL;
    return field_keyed(at, c->band[i].targets + c->band[i].answers > 0 ? band_name((Band)i) : "", &c->band[i]);
}

static const void *next_class(FieldAt *at, int i)
{
    const ScoreRecogniser *r = at->of;
    return i < r->classes ? field_keyed(at, r->of_class[i].name, &r->of_class[i]) : NULL;
}

static const Field precision_rows[] = {
    {"targets", "", "", "", "targets to be found", IN_PRECISION(targets)},
    {"answers", "", "", "", "answers of the class, at any score", IN_PRECISION(answers)},
    {"ap", "", "0 .. 1", "without a target to be found; where answers are lines of sight",
     "COCO's average precision, mean of IoU 0.50 to 0.95", IN_PRECISION(ap)},
    {"ap50", "", "0 .. 1", "likewise", "the same at IoU 0.50", IN_PRECISION(ap50)},
    {"ap75", "", "0 .. 1", "likewise", "the same at IoU 0.75", IN_PRECISION(ap75)},
    {"ap_centre", "", "0 .. 1", "without a target to be found",
     "average precision by the rule that rates have: centres of small targets, IoU of large ones",
     IN_PRECISION(ap_centre)},
};

static const Field class_bands_rows[] = {
    {"BAND", "", "", "when it has neither target nor answer of the class", "in one band", .item = next_band_of_class,
     FIELD_OBJECT(precision_rows)},
};

static const Field class_rows[] = {
    {"all", "", "", "", "over all bands", .in = every_band, FIELD_OBJECT(precision_rows)},
    {"bands", "", "", "", "by band", FIELD_OBJECT(class_bands_rows)},
};

static const Field classes_rows[] = {
    {"CLASS", "", "", "when it has neither target nor answer", "precision and recall of one class", .item = next_class,
     FIELD_OBJECT(class_rows)},
};

/* ---- confusion ----------------------------------------------------------------------------------- */

static const char *row_name(const ScoreRecogniser *r, int row)
{
    (void)r;
    return row < target_class_count() ? target_class_name(row + 1) : "false";
}

static const char *column_name(int column)
{
    const int classes = target_class_count();
    return column < classes ? target_class_name(column + 1) : column == classes ? "unknown" : "missed";
}

/* An item is the row itself. */
static const void *next_row(FieldAt *at, int i)
{
    const ScoreRecogniser *r = at->of;
    long long              any = 0;
    if (i > target_class_count()) return NULL;
    for (int k = 0; k < target_class_count() + 2; k++) any += r->confusion.count[i][k];
    return field_keyed(at, any > 0 ? row_name(r, i) : "", r->confusion.count[i]);
}

static const void *next_column(FieldAt *at, int i)
{
    const long long *row = at->of;
    if (i >= target_class_count() + 2) return NULL;
    return field_keyed(at, row[i] > 0 ? column_name(i) : "", &row[i]);
}

static const Field confusion_row_rows[] = {
    {"ANSWERED", "", "", "where it is 0", "how many were answered so", .item = next_column, .kind = FIELD_OF_LONG_LONG,
     .size = sizeof(long long)},
};

static const Field confusion_rows[] = {
    {"TRUE", "", "", "where nothing was counted", "targets of one class to be found, by what was answered",
     .item = next_row, FIELD_OBJECT(confusion_row_rows)},
};

/* ---- clutter ------------------------------------------------------------------------------------- */

static const void *next_clutter(FieldAt *at, int i)
{
    const ScoreRecogniser *r = at->of;
    if (i + 1 >= CLUTTER_CLASSES) return NULL;
    const bool any = r->on_clutter[i + 1] > 0;
    return field_keyed(at, any ? scenery_class_name((SceneryClass)(i + 1)) : "", &r->on_clutter[i + 1]);
}

static const Field clutter_rows[] = {
    {"CLUTTER", "", "", "where it is 0", "how many lie on clutter of this class", .item = next_clutter,
     .kind = FIELD_OF_LONG_LONG, .size = sizeof(long long)},
};

/* ---- the rest ------------------------------------------------------------------------------------ */

static const void *errors_of(const void *of)
{
    const ScoreErrors *e = &((const ScoreRecogniser *)of)->errors;
    return e->count > 0 ? e : NULL;
}

static const void *ages_of(const void *of)
{
    const ScoreAges *a = &((const ScoreRecogniser *)of)->ages;
    return a->count > 0 ? a : NULL;
}

static const void *next_point(FieldAt *at, int i)
{
    const ScoreRecogniser *r = at->of;
    return i < r->points ? &r->curve[i] : NULL;
}

static const void *next_word(FieldAt *at, int i)
{
    const ScoreRecogniser *r = at->of;
    return i < r->words ? field_keyed(at, r->word[i].word, &r->word[i].count) : NULL;
}

static json_t *bands_scored(FieldAt *at)
{
    json_t *bands = json_array();
    for (int b = 0; b < BAND_COUNT; b++)
        if (((const ScoreRecogniser *)at->of)->bands >> b & 1)
            json_array_append_new(bands, json_string(band_name((Band)b)));
    return bands;
}

static json_t *out_of(FieldAt *at) { return json_string(((const ScoreReport *)at->of)->out); }
static json_t *file_of(FieldAt *at) { return json_string(((const ScoreRecogniser *)at->of)->file); }

static json_t *version(FieldAt *at)
{
    (void)at;
    return json_string(PITVIPER_VERSION);
}

static const void *tracks_of(const void *of)
{
    const ScoreRecogniser *r = of;
    return r->tracks.sequences > 0 ? &r->tracks : NULL;
}

static const Field errors_rows[] = {
    {"count", "", "", "", "found targets", IN_ERRORS(count)},
    {"mean_px", "px", "image: column, row", "", "mean of the answer's centre less that of the target's amodal box",
     IN_ERRORS(mean_px)},
    {"rms_px", "px", "", "", "rms length of this difference", IN_ERRORS(rms_px)},
    {"rms_deg", "deg", "", "", "the same by the scale at the image's centre", IN_ERRORS(rms_deg)},
    {"ranges", "", "", "", "answers with a range among these", IN_ERRORS(ranges)},
    {"range_mean_m", "m", "", "when no answer has a range", "mean of the answer's range less truth's",
     IN_ERRORS(range_mean_m)},
    {"range_rms_m", "m", "", "when no answer has a range", "rms of this difference", IN_ERRORS(range_rms_m)},
};

static const Field ages_rows[] = {
    {"count", "", "", "", "answers whose age is known", IN_AGES(count)},
    {"late", "", "", "", "of these: a newer frame of the band had been answered before", IN_AGES(late)},
    {"median_ms", "ms", "from the end of rendering", "", "median age", IN_AGES(median_ms)},
    {"p95_ms", "ms", "from the end of rendering", "", "age that 95 % do not exceed", IN_AGES(p95_ms)},
    {"max_ms", "ms", "from the end of rendering", "", "greatest age", IN_AGES(max_ms)},
};

static const Field point_rows[] = {
    {"score", "", "", "", "least score of the answers that count", IN_POINT(score)},
    {"recall", "", "0 .. 1", "without a target to be found", "found of chances", IN_POINT(recall)},
    {"precision", "", "0 .. 1", "where all answers are neither right nor wrong", "found of found and false alarms",
     IN_POINT(precision)},
    {"false_per_frame", "", "", "", "false alarms a frame", IN_POINT(false_per_frame)},
};

static const Field word_rows[] = {
    {"WORD", "", "", "", "how many answers have this word", .item = next_word, .kind = FIELD_OF_LONG_LONG,
     .size = sizeof(long long)},
};

static const Field recogniser_rows[] = {
    {"name", "", "", "", "name of the file without folder and ending", IN_RECOGNISER(name)},
    {"file", "", "", "", "file or folder of the answers, as given", FIELD_GET("string", file_of)},
    {"bands", "", "", "", "which of optical, mwir, lwir, radar were scored",
     FIELD_GET("list of strings", bands_scored)},
    {"answers", "", "", "", "detections read that are of a frame and band of truth", IN_RECOGNISER(answers)},
    {"elsewhere", "", "", "", "detections of a frame or band that truth does not have", IN_RECOGNISER(elsewhere)},
    {"aged", "", "", "", "detections older than max_age_ms, dropped", IN_RECOGNISER(aged)},
    {"ignored", "", "", "", "detections in ignore regions and on hidden targets: neither right nor wrong",
     IN_RECOGNISER(ignored)},
    {"lines_of_sight", "", "", "", "some answers are lines of sight, without a box", IN_RECOGNISER(lines_of_sight)},
    {"unknown_words", "", "", "when there is none", "words of answers that are no class of truth, at most 8",
     .unless_empty = true, FIELD_OBJECT(word_rows)},
    {"total", "", "", "", "rates over all bands", .in = the_total, FIELD_OBJECT(rates_rows)},
    {"by_band", "", "", "", "rates by band", FIELD_OBJECT(band_rows)},
    {"against", "", "", "", "rates by what the target and the frame are like", FIELD_OBJECT(against_rows)},
    {"map", "", "0 .. 1", "without a target to be found; where answers are lines of sight", "mean of classes' `ap`",
     IN_RECOGNISER(map)},
    {"map50", "", "0 .. 1", "likewise", "mean of classes' `ap50`", IN_RECOGNISER(map50)},
    {"ap_centre", "", "0 .. 1", "without a target to be found", "mean of classes' `ap_centre`",
     IN_RECOGNISER(ap_centre)},
    {"classes", "", "", "", "average precision by class", FIELD_OBJECT(classes_rows)},
    {"confusion", "", "", "", "what targets were answered as; `false`: answers where nothing is",
     FIELD_OBJECT(confusion_rows)},
    {"on_clutter", "", "", "when there is none",
     "false alarms on clutter (clutter[] of truth.jsonl): centres within its box or 1 px beside it; of several the "
     "smallest",
     .unless_empty = true, FIELD_OBJECT(clutter_rows)},
    {"errors", "", "", "when nothing was found", "centroid and range", .in = errors_of, FIELD_OBJECT(errors_rows)},
    {"ages", "", "", "when no answer has latency_ms", "age of answers", .in = ages_of, FIELD_OBJECT(ages_rows)},
    {"tracks", "", "", "when no answer has a track", "how the answers' track numbers follow targets", .in = tracks_of,
     .type = "object", .rows = &score_track_fields},
    {"curve", "", "falling score", "", "precision and recall down to a score, at most 101 points", .item = next_point,
     FIELD_OBJECTS(point_rows)},
};

static const void *rules_of(const void *of) { return &((const ScoreReport *)of)->rules; }

static const void *next_recogniser(FieldAt *at, int i)
{
    const ScoreReport *r = at->of;
    return i < r->recognisers ? &r->recogniser[i] : NULL;
}

static const Field rules_rows[] = {
    {"least_score", "", "", "", "--score", IN_RULES(least_score)},
    {"grow", "", "", "", "--grow", IN_RULES(grow)},
    {"iou", "", "0 .. 1", "", "--iou", IN_RULES(iou)},
    {"small_px", "px", "", "", "--small-px", IN_RULES(small_px)},
    {"max_age_ms", "ms", "", "without it", "--max-age", IN_RULES(max_age_ms)},
    {"answered", "", "", "", "--answered: frames without an answer are left out", IN_RULES(answered)},
    {"min_pixels", "px", "", "", "--min-pixels", IN_RULES(min_pixels)},
    {"min_visible", "", "0 .. 1", "", "--min-visible", IN_RULES(min_visible)},
    {"min_snr", "", "", "", "--min-snr", IN_RULES(min_snr)},
};

static const Field report_rows[] = {
    {"pitviper", "", "", "", "version of the program", FIELD_GET("string", version)},
    {"out", "", "", "", "folder whose truth was scored, as given", FIELD_GET("string", out_of)},
    {"sweep", "", "", "", "it is that of a sweep: a sequence is a variant", IN_REPORT(sweep)},
    {"sequences", "", "", "", "folders with truth.jsonl: hosts, variants", IN_REPORT(sequences)},
    {"frames", "", "", "", "lines of truth, of all sequences", IN_REPORT(frames)},
    {"rules", "", "", "", "how answers were matched", .in = rules_of, FIELD_OBJECT(rules_rows)},
    {"recognisers", "", "as given", "", "one for each ANSWERS", .item = next_recogniser,
     FIELD_OBJECTS(recogniser_rows)},
};
const FieldTable score_fields = {report_rows, sizeof report_rows / sizeof *report_rows};
