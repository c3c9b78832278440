/* sensor/score/score_text.c: a report as text: the summary of `pitviper score`, and of the end of `run` and `replay`.
 */
#include "sensor/frame/target_record.h"
#include "sensor/score/score.h"

/* A number of three figures; NaN: a dash. */
static const char *figure(char out[24], double value)
{
    if (isnan(value)) return "-";
    snprintf(out, 24, fabs(value) >= 1000 && fabs(value) < 1e7 ? "%.0f" : "%.3g", value);
    return out;
}

/* `0.842 (0.710 .. 0.920)`, in columns */
static const char *share(char out[96], const ScoreShare *s)
{
    if (isnan(s->value)) return "-";
    snprintf(out, 96, "%.3f (%.3f .. %.3f)", s->value, s->low, s->high);
    return out;
}

/* The same of a count, which has no highest value. */
static const char *rate(char out[96], const ScoreShare *s)
{
    char value[24], low[24], high[24];
    if (isnan(s->value)) return "-";
    snprintf(out, 96, "%s (%s .. %s)", figure(value, s->value), figure(low, s->low), figure(high, s->high));
    return out;
}

static void print_head(FILE *to, const ScoreRecogniser *r)
{
    char bands[64] = "";
    for (int b = 0; b < BAND_COUNT; b++)
        if (r->bands >> b & 1)
            snprintf(bands + strlen(bands), sizeof bands - strlen(bands), "%s%s", *bands ? ", " : "",
                     band_name((Band)b));
    fprintf(to, "%s: %lld answers in %s; %lld of %lld frames and bands answered", r->name, r->answers,
            *bands ? bands : "no band", r->total.frames_answered, r->total.frames);
    if (r->ignored) fprintf(to, "; %lld neither right nor wrong", r->ignored);
    if (r->aged) fprintf(to, "; %lld too old", r->aged);
    if (r->elsewhere) fprintf(to, "; %lld of frames or bands that truth does not have", r->elsewhere);
    fputc('\n', to);
    for (int i = 0; i < r->words; i++)
        fprintf(to, "%s'%s' (%lld)", i ? ", " : "  words that are no class, taken as unknown: ", r->word[i].word,
                r->word[i].count);
    if (r->words) fputc('\n', to);
}

/* ---- rates ---------------------------------------------------------------------------------------- */

static void print_rates(FILE *to, const char *name, const ScoreRates *r)
{
    char detection[96], recognition[96], frame[96], deg2[24], km2[24];
    fprintf(to, "  %-16s %8lld  %-24s %-24s %-26s %9s %9s\n", name, r->chances, share(detection, &r->detection),
            share(recognition, &r->recognition), rate(frame, &r->per_frame), figure(deg2, r->per_deg2.value),
            figure(km2, r->per_km2.value));
}

static void print_columns(FILE *to, const char *what)
{
    fprintf(to, "  %-16s %8s  %-24s %-24s %-26s %9s %9s\n", what, "targets", "found", "with its class",
            "false alarms a frame", "a deg2", "a km2");
}

static void print_against(FILE *to, const ScoreRecogniser *r)
{
    for (int which = 0; which < AGAINST_COUNT; which++) {
        const ScoreBins *bins = &r->against[which];
        if (bins->count == 0) continue;
        print_columns(to, score_against_name[which]);
        for (int i = 0; i < bins->count; i++) {
            char name[64], from[24], upto[24];
            snprintf(name, sizeof name, isnan(bins->bin[i].to) ? "%s .." : "%s .. %s", figure(from, bins->bin[i].from),
                     figure(upto, bins->bin[i].to));
            print_rates(to, name, &bins->bin[i]);
        }
    }
}

/* ---- classes --------------------------------------------------------------------------------------- */

static void print_classes(FILE *to, const ScoreRecogniser *r)
{
    char ap[24], ap50[24], ap75[24], centre[24];
    if (r->classes == 0) return;
    fprintf(to, "  %-24s %8s %8s %8s %8s %8s %10s\n", "class", "targets", "answers", "AP", "AP50", "AP75", "AP centre");
    for (int i = 0; i < r->classes; i++) {
        const ScorePrecision *p = &r->of_class[i].all;
        fprintf(to, "  %-24s %8lld %8lld %8s %8s %8s %10s\n", r->of_class[i].name, p->targets, p->answers,
                figure(ap, p->ap), figure(ap50, p->ap50), figure(ap75, p->ap75), figure(centre, p->ap_centre));
    }
}

static void print_confusion(FILE *to, const ScoreRecogniser *r)
{
    const int classes = target_class_count();
    fputs("  targets, and what they were answered as\n", to);
    for (int row = 0; row <= classes; row++) {
        bool any = false;
        for (int column = 0; column < classes + 2; column++) {
            const long long n = r->confusion.count[row][column];
            if (n == 0) continue;
            if (!any) fprintf(to, "    %-22s", row < classes ? target_class_name(row + 1) : "false alarms");
            fprintf(to, "%s%s %lld", any ? ", " : " ",
                    column < classes    ? target_class_name(column + 1)
                    : column == classes ? "unknown"
                                        : "missed",
                    n);
            any = true;
        }
        if (any) fputc('\n', to);
    }
}

static void print_on_clutter(FILE *to, const ScoreRecogniser *r)
{
    bool any = false;
    for (int k = CLUTTER_NONE + 1; k < CLUTTER_CLASSES; k++) {
        if (r->on_clutter[k] == 0) continue;
        fprintf(to, "%s%s %lld", any ? ", " : "  false alarms on clutter: ", scenery_class_name((SceneryClass)k),
                r->on_clutter[k]);
        any = true;
    }
    if (any) fputc('\n', to);
}

/* ---- errors and ages -------------------------------------------------------------------------------- */

static void print_errors(FILE *to, const ScoreRecogniser *r)
{
    char               a[24], b[24], c[24], d[24];
    const ScoreErrors *e = &r->errors;
    const ScoreAges   *age = &r->ages;
    if (e->count)
        fprintf(to, "  centre off by %s px rms (%s deg), mean %s right, %s down\n", figure(a, e->rms_px),
                figure(b, e->rms_deg), figure(c, e->mean_px[0]), figure(d, e->mean_px[1]));
    if (e->ranges)
        fprintf(to, "  range off by %s m rms, mean %s m, of %lld answers\n", figure(a, e->range_rms_m),
                figure(b, e->range_mean_m), e->ranges);
    if (age->count)
        fprintf(to, "  age of answers: median %s, 95 %% within %s, at most %s ms; %lld late\n",
                figure(a, age->median_ms), figure(b, age->p95_ms), figure(c, age->max_ms), age->late);
}

static void print_tracks(FILE *to, const TracksScore *t)
{
    char idf1[24], purity[24], delay[24];
    if (t->sequences == 0) return;
    fprintf(
        to,
        "  tracks: IDF1 %s, purity %s, %llu switches, %llu fragmentations; %llu of %llu targets found, after %s s\n",
        figure(idf1, tracks_idf1(t)), figure(purity, tracks_purity(t)), (unsigned long long)t->switches,
        (unsigned long long)t->fragmentations, (unsigned long long)t->truths_found, (unsigned long long)t->truths,
        figure(delay, tracks_delay_s(t)));
    if (t->hidings)
        fprintf(to, "  hidden targets: %llu times, coasted %llu times, again by the same track %llu of %llu times\n",
                (unsigned long long)t->hidings, (unsigned long long)t->coasts, (unsigned long long)t->resumed,
                (unsigned long long)t->returns);
}

static void print_recogniser(FILE *to, const ScoreRecogniser *r, bool full)
{
    char ap[24], ap50[24], centre[24];
    print_head(to, r);
    print_columns(to, "");
    print_rates(to, "all", &r->total);
    for (int b = 0; b < BAND_COUNT; b++)
        if (r->bands >> b & 1 && r->bands != 1u << b) print_rates(to, band_name((Band)b), &r->band[b]);
    if (full) print_against(to, r);
    fprintf(to, "  mean of classes: AP %s, AP50 %s, AP centre %s\n", figure(ap, r->map), figure(ap50, r->map50),
            figure(centre, r->ap_centre));
    if (full) print_classes(to, r);
    if (full) print_confusion(to, r);
    print_on_clutter(to, r);
    print_errors(to, r);
    print_tracks(to, &r->tracks);
}

/* ---- several, side by side --------------------------------------------------------------------------- */

static void print_row(FILE *to, const ScoreReport *report, const char *name,
                      const char *(*cell)(char out[96], const ScoreRecogniser *r))
{
    char text[96];
    fprintf(to, "  %-24s", name);
    for (int i = 0; i < report->recognisers; i++) fprintf(to, " %-28s", cell(text, &report->recogniser[i]));
    fputc('\n', to);
}

static const char *cell_name(char out[96], const ScoreRecogniser *r)
{
    return snprintf(out, 96, "%.27s", r->name), out;
}
static const char *cell_found(char out[96], const ScoreRecogniser *r) { return share(out, &r->total.detection); }
static const char *cell_class(char out[96], const ScoreRecogniser *r) { return share(out, &r->total.recognition); }
static const char *cell_false(char out[96], const ScoreRecogniser *r) { return rate(out, &r->total.per_frame); }
static const char *cell_ap(char out[96], const ScoreRecogniser *r) { return figure(out, r->map); }
static const char *cell_centre(char out[96], const ScoreRecogniser *r) { return figure(out, r->ap_centre); }
static const char *cell_px(char out[96], const ScoreRecogniser *r) { return figure(out, r->errors.rms_px); }
static const char *cell_age(char out[96], const ScoreRecogniser *r)
{
    return r->ages.count ? figure(out, r->ages.median_ms) : "-";
}

static void print_side_by_side(FILE *to, const ScoreReport *report)
{
    print_row(to, report, "", cell_name);
    print_row(to, report, "found", cell_found);
    print_row(to, report, "with its class", cell_class);
    print_row(to, report, "false alarms a frame", cell_false);
    print_row(to, report, "AP", cell_ap);
    print_row(to, report, "AP centre", cell_centre);
    print_row(to, report, "centre off by, px rms", cell_px);
    print_row(to, report, "median age, ms", cell_age);
}

void score_print(FILE *to, const ScoreReport *report, bool full)
{
    fprintf(to, "%s: %lld frames of %d %s; intervals of 95 %% over %s\n", report->out, report->frames,
            report->sequences,
            report->sweep            ? "variants"
            : report->sequences == 1 ? "sequence"
                                     : "sequences",
            report->sequences == 1 ? "one sample" : "sequences");
    for (int i = 0; i < report->recognisers; i++) print_recogniser(to, &report->recogniser[i], full);
    if (report->recognisers > 1) print_side_by_side(to, report);
}
