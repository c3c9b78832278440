/* sensor/score/score_page_plots.c: shares of targets found against what they and the frame are like. */
#include "sensor/score/score_page_private.h"

enum { width_px = 560, height_px = 330, slots_max = 2 * score_bins_max * score_recognisers_max };

static const SvgBox box = {.left = 62, .right = 538, .top = 52, .bottom = 272};

/* Bins of all recognisers side by side, each as wide as any other; a gap where none has one. */
typedef struct Slot {
    double      from, to;
    const char *name; /* of a band; NULL: of a quantity */
    bool        gap;
} Slot;

typedef struct Slots {
    int  count;
    Slot slot[slots_max];
} Slots;

static const struct {
    const char *name, *axis;
    double      unit; /* of the axis */
} quantity[AGAINST_COUNT] = {
    [AGAINST_RANGE] = {"range", "range, km", 1000},
    [AGAINST_PIXELS] = {"pixels on target", "visible pixels of the target", 1},
    [AGAINST_ASPECT] = {"aspect", "direction of the sensor from the target, deg", 1},
    [AGAINST_VISIBLE] = {"visible fraction", "share of the target that is not hidden", 1},
    [AGAINST_FOLIAGE] = {"foliage", "share of the target behind plants", 1},
    [AGAINST_SNR] = {"signal to noise", "|SNR| in the band", 1},
    [AGAINST_HOUR] = {"time of day", "local solar time, h", 1},
};

static bool same(double a, double b) { return a == b || (isnan(a) && isnan(b)); }

static const ScoreRates *rates_in(const ScoreRecogniser *r, int which, const Slot *slot)
{
    if (slot->gap) return NULL;
    if (which == AGAINST_COUNT) {
        for (int b = 0; b < BAND_COUNT; b++)
            if (r->bands >> b & 1 && strcmp(band_name((Band)b), slot->name) == 0) return &r->band[b];
        return NULL;
    }
    for (int i = 0; i < r->against[which].count && i < score_bins_max; i++) {
        const ScoreRates *bin = &r->against[which].bin[i];
        if (same(bin->from, slot->from) && same(bin->to, slot->to)) return bin;
    }
    return NULL;
}

static void add_slot(Slots *s, double from, double to)
{
    int at = 0;
    while (at < s->count && s->slot[at].from < from) at++;
    if (!isfinite(from) || s->count == slots_max || (at < s->count && s->slot[at].from == from)) return;
    memmove(&s->slot[at + 1], &s->slot[at], (size_t)(s->count++ - at) * sizeof *s->slot);
    s->slot[at] = (Slot){.from = from, .to = to};
}

static void find_slots(Slots *s, const ScoreReport *report, int which)
{
    *s = (Slots){0};
    if (which == AGAINST_COUNT) {
        unsigned bands = 0;
        for (int k = 0; k < report->recognisers; k++) bands |= report->recogniser[k].bands;
        for (int b = 0; b < BAND_COUNT; b++)
            if (bands >> b & 1) s->slot[s->count++] = (Slot){.name = band_name((Band)b)};
        return;
    }
    for (int k = 0; k < report->recognisers; k++) {
        const ScoreBins *bins = &report->recogniser[k].against[which];
        for (int i = 0; i < bins->count && i < score_bins_max; i++) add_slot(s, bins->bin[i].from, bins->bin[i].to);
    }
    for (int i = 0; i + 1 < s->count && s->count < slots_max; i++) {
        const double to = s->slot[i].to, next = s->slot[i + 1].from;
        if (!(to < next)) continue;
        memmove(&s->slot[i + 2], &s->slot[i + 1], (size_t)(s->count++ - i - 1) * sizeof *s->slot);
        s->slot[++i] = (Slot){.from = to, .to = next, .gap = true};
    }
}

/* ---- a plot --------------------------------------------------------------------------------------- */

static const char *aspect_name(double deg)
{
    static const char *const name[] = {"nose", "45", "right", "135", "tail", "225", "left", "315"};
    const int                k = (int)lround(deg / 45);
    return k >= 0 && k < 8 ? name[k] : "";
}

static void label_slots(FILE *page, const Slots *s, int which, const SvgAxis *x)
{
    static const SvgPen grid = {SVG_GRID, 1, NULL};
    for (int i = 0; i <= s->count; i++) {
        const Slot  *slot = &s->slot[i < s->count ? i : i - 1];
        const double at = svg_at(x, i), middle = svg_at(x, i + 0.5), edge = i < s->count ? slot->from : slot->to;
        char         text[24];
        svg_line(page, &grid, at, box.top, at, box.bottom);
        if (which == AGAINST_COUNT || which == AGAINST_ASPECT) {
            const char *name = which == AGAINST_COUNT ? slot->name : aspect_name(0.5 * (slot->from + slot->to));
            if (i < s->count) svg_text(page, SVG_INK, SVG_MIDDLE, middle, box.bottom + 17, "%s", name);
            continue;
        }
        if (isfinite(edge)) snprintf(text, sizeof text, "%.6g", edge / quantity[which].unit);
        else snprintf(text, sizeof text, "\xe2\x88\x9e");
        svg_text(page, SVG_INK, SVG_MIDDLE, at, box.bottom + 17, "%s", text);
    }
}

static bool has_rate(const ScoreRecogniser *r, int which, const Slots *s, int slot)
{
    const ScoreRates *rates = slot >= 0 && slot < s->count ? rates_in(r, which, &s->slot[slot]) : NULL;
    return rates && isfinite(rates->detection.value);
}

/* One recogniser: intervals as areas, of a single one as wide as its bins; shares as points, joined where bins touch.
 */
static void put_shares(FILE *page, const ScoreReport *report, int k, int which, const Slots *s, const SvgAxis *x,
                       const SvgAxis *y)
{
    const ScoreRecogniser *r = &report->recogniser[k];
    const double           aside = 0.16 * (k - 0.5 * (report->recognisers - 1)); /* points of several do not cover */
    const bool             wide = report->recognisers == 1 && which != AGAINST_COUNT;
    const double           half = wide ? 0.5 : 0.06;
    for (int i = 0; i < s->count; i++) {
        if (!has_rate(r, which, s, i)) continue;
        const ScoreShare *share = &rates_in(r, which, &s->slot[i])->detection;
        const double      middle = i + 0.5 + aside;
        const double      left = svg_at(x, middle - half), right = svg_at(x, middle + half);
        svg_area_begin(page, page_colour[k], wide ? 0.2 : 0.28);
        svg_curve_point(page, left, svg_at(y, share->low));
        svg_curve_point(page, left, svg_at(y, share->high));
        svg_curve_point(page, right, svg_at(y, share->high));
        svg_curve_point(page, right, svg_at(y, share->low));
        svg_curve_end(page);
    }
    for (int i = 0; i < s->count && which != AGAINST_COUNT; i++) {
        if (!has_rate(r, which, s, i) || !has_rate(r, which, s, i + 1)) continue;
        svg_curve_begin(page, &(SvgPen){page_colour[k], 1.8, page_dashes[k]});
        for (; has_rate(r, which, s, i); i++)
            svg_curve_point(page, svg_at(x, i + 0.5 + aside),
                            svg_at(y, rates_in(r, which, &s->slot[i])->detection.value));
        svg_curve_end(page);
    }
    for (int i = 0; i < s->count; i++)
        if (has_rate(r, which, s, i))
            svg_circle(page, &(SvgPen){.colour = page_colour[k]}, svg_at(x, i + 0.5 + aside),
                       svg_at(y, rates_in(r, which, &s->slot[i])->detection.value), 4);
}

/* ---- its numbers ---------------------------------------------------------------------------------- */

static void put_bin_name(FILE *page, const Slot *slot, int which)
{
    if (slot->name) fprintf(page, "%s", slot->name);
    else if (which == AGAINST_ASPECT) fprintf(page, "%s", aspect_name(0.5 * (slot->from + slot->to)));
    else if (isfinite(slot->to))
        fprintf(page, "%g &ndash; %g", slot->from / quantity[which].unit, slot->to / quantity[which].unit);
    else fprintf(page, "from %g", slot->from / quantity[which].unit);
}

static void put_numbers(FILE *page, const ScoreReport *report, int which, const Slots *s)
{
    fputs("<details><summary>numbers</summary><div class=\"scroll\"><table class=\"figures\"><thead>", page);
    if (report->recognisers > 1) {
        fputs("<tr><th></th>", page);
        for (int k = 0; k < report->recognisers; k++) {
            fputs("<th class=\"rec\" colspan=\"5\">", page);
            page_key(page, report, k);
            fputs("</th>", page);
        }
        fputs("</tr>", page);
    }
    fprintf(page, "<tr><th>%s</th>", which == AGAINST_COUNT ? "band" : quantity[which].axis);
    for (int k = 0; k < report->recognisers; k++)
        fputs("<th class=\"n first\">targets</th><th class=\"n\">found</th><th class=\"n\">from</th><th "
              "class=\"n\">to</th><th class=\"n\">false a frame</th>",
              page);
    fputs("</tr></thead><tbody>\n", page);
    for (int i = 0; i < s->count; i++) {
        if (s->slot[i].gap) continue;
        fputs("<tr><td>", page);
        put_bin_name(page, &s->slot[i], which);
        fputs("</td>", page);
        for (int k = 0; k < report->recognisers; k++) {
            const ScoreRates *r = rates_in(&report->recogniser[k], which, &s->slot[i]);
            page_cell(page, "%.0f", r ? (double)r->chances : (double)NAN);
            page_cell(page, "%.3f", r ? r->detection.value : (double)NAN);
            page_cell(page, "%.3f", r ? r->detection.low : (double)NAN);
            page_cell(page, "%.3f", r ? r->detection.high : (double)NAN);
            page_cell(page, "%.3f", r ? r->per_frame.value : (double)NAN);
        }
        fputs("</tr>\n", page);
    }
    fputs("</tbody></table></div></details>", page);
}

static void put_plot(FILE *page, const ScoreReport *report, int which)
{
    Slots s;
    find_slots(&s, report, which);
    if (s.count == 0) return;
    const SvgAxis x = {.low = 0, .high = s.count, .from_px = box.left, .to_px = box.right};
    const SvgAxis y = {
        .low = 0, .high = 1, .from_px = box.bottom, .to_px = box.top, .ticks = 6, .tick = {0, 0.2, 0.4, 0.6, 0.8, 1}};
    fputs("<figure>", page);
    svg_begin(page, width_px, height_px, "Found, by ", which == AGAINST_COUNT ? "band" : quantity[which].name, "");
    svg_axes(page, &box, &x, which == AGAINST_COUNT ? "band" : quantity[which].axis, &y, "share of targets found");
    label_slots(page, &s, which, &x);
    for (int k = 0; k < report->recognisers; k++) put_shares(page, report, k, which, &s, &x, &y);
    svg_end(page);
    put_numbers(page, report, which, &s);
    fputs("</figure>\n", page);
}

void page_plots(FILE *page, const ScoreReport *report)
{
    fputs(
        "<h2>What is found</h2>\n<p class=\"dim\">Share of the targets to be found that an answer names, whatever its "
        "class; shaded: its bounds of 95 %.</p>\n",
        page);
    page_legend(page, report);
    fputs("<div class=\"plots\">\n", page);
    for (int which = 0; which <= AGAINST_COUNT; which++) put_plot(page, report, which);
    fputs("</div>\n", page);
}
