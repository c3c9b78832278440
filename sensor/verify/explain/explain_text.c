/* sensor/verify/explain/explain_text.c: a pixel explained in words, some 40 lines. */
#include "sensor/verify/explain/explain_private.h"

#include "sensor/detector/array_noise.h"

enum { surfaces_shown = 5, heats_shown = 3, surfaces_most = 64, label_width = 30 };

/* ---- what the rays met --------------------------------------------------------------------------- */

/* Samples of one surface, and means over them by their weight in the first plane. */
typedef struct Surface {
    const PixelSample *of; /* the first */
    int                samples;
    double             weight, low_m, high_m, temp_k, air_k, stored_k, sun_k, detail_k, canopy_k, lit;
} Surface;

static bool same_surface(const PixelSample *a, const PixelSample *b)
{
    return a->kind == b->kind && a->entity == b->entity && a->part == b->part && a->material == b->material &&
           a->surface == b->surface && (a->kind != hit_scenery || a->plant == b->plant) &&
           (a->radius_m > 0) == (b->radius_m > 0);
}

static void add_to(Surface *s, const PixelSample *of, double weight)
{
    s->samples++;
    s->weight += weight;
    s->low_m = fmin(s->low_m, of->range_m), s->high_m = fmax(s->high_m, of->range_m);
    s->air_k += weight * (double)of->air_k;
    s->stored_k += weight * ((double)of->still_k - (double)of->air_k);
    s->sun_k += weight * ((double)of->sunlit_k - (double)of->still_k);
    s->detail_k += weight * ((double)of->detailed_k - (double)of->sunlit_k);
    s->canopy_k += weight * ((double)of->temp_k - (double)of->detailed_k);
    s->temp_k += weight * (double)of->temp_k;
    s->lit += weight * (double)of->sun;
}

/* The plane whose weights stand for all: the last thermal one, else the first. */
static const ExplainedPlane *main_plane(const Explained *e)
{
    const ExplainedPlane *found = &e->plane[0];
    for (int k = 0; k < e->planes; k++)
        if (!e->plane[k].is_radar && e->plane[k].channel >= AIR_MWIR) found = &e->plane[k];
    return found;
}

/* Largest first; returns their number. */
static int find_surfaces(Surface out[surfaces_most], const ExplainedPlane *p)
{
    int count = 0;
    for (int i = 0; i < p->record->samples; i++) {
        const PixelSample *s = &p->record->sample[i];
        int                k = 0;
        if (!(p->weight[i] > 0)) continue;
        while (k < count && !same_surface(out[k].of, s)) k++;
        if (k == surfaces_most) continue;
        if (k == count) out[count++] = (Surface){.of = s, .low_m = INFINITY, .high_m = -INFINITY};
        add_to(&out[k], s, p->weight[i]);
    }
    for (int k = 1; k < count; k++)
        for (int at = k; at > 0 && out[at - 1].weight < out[at].weight; at--) {
            const Surface other = out[at];
            out[at] = out[at - 1], out[at - 1] = other;
        }
    return count;
}

static void print_surfaces(FILE *to, const Explained *e, const Surface *surface, int count, const char *plane)
{
    fprintf(to, "\nwhat they met, by its share of %s:\n", plane);
    for (int k = 0; k < count && k < surfaces_shown; k++) {
        const Surface *s = &surface[k];
        char           name[3 * model_name_size], range[64] = "";
        explain_surface(name, sizeof name, e, s->of);
        if (s->high_m < INFINITY && s->high_m - s->low_m < 0.05) snprintf(range, sizeof range, "  %.1f m", s->low_m);
        else if (s->high_m < INFINITY) snprintf(range, sizeof range, "  %.1f to %.1f m", s->low_m, s->high_m);
        fprintf(to, "  %5.1f %%  %4d ray%s  %s", 100 * s->weight, s->samples, s->samples == 1 ? " " : "s", name);
        if (s->of->range_m < INFINITY)
            fprintf(to, " (%s)%s, %.0f %% in the sun", e->scene->world.materials.material[s->of->material].name, range,
                    100 * s->lit / s->weight);
        fprintf(to, "\n");
    }
    if (count > surfaces_shown) fprintf(to, "  and %d more surfaces: --json lists every ray\n", count - surfaces_shown);
}

/* ---- temperatures ---------------------------------------------------------------------------------- */

static void print_heat(FILE *to, const Explained *e, const Surface *s)
{
    const PixelSample *of = s->of;
    const double       w = s->weight;
    char               name[3 * model_name_size];
    const bool         plant = of->kind == hit_plant, leaf = plant && !(of->radius_m > 0);
    const bool         scenery = of->kind == hit_scenery;
    explain_surface(name, sizeof name, e, of);
    fprintf(to, "  %.2f K  %s = air there %.2f %+.2f %s", s->temp_k / w, name, s->air_k / w, s->stored_k / w,
            of->entity                     ? "of its heat (engine, motion, sun of the hours before)"
            : scenery && of->scenery.state ? "of its heat (engine, fire, life, sun of the hours before)"
            : scenery                      ? "of its construction (what is behind it, sun of the hours before)"
            : leaf                         ? "in the shade"
            : plant                        ? "of the sun of the day"
                                           : "of the ground's heat");
    if (leaf) fprintf(to, " %+.2f in this sun", s->sun_k / w);
    if (!plant && !scenery && !of->entity) {
        if (s->sun_k != 0) fprintf(to, " %+.2f by the photograph", s->sun_k / w);
        fprintf(to, " %+.2f of its detail", s->detail_k / w);
        if (s->canopy_k != 0) fprintf(to, " %+.2f of far woods", s->canopy_k / w);
    }
    fprintf(to, "\n");
    if (scenery) explain_scenery_heat(to, &of->scenery);
    for (int k = 0; k < of->patches && k < 2 && (k == 0 || of->patch[k].share >= 0.005F); k++) {
        const Patch *patch = &e->scene->world.patches->of[of->model].patch[of->patch[k].index];
        fprintf(to, "%s%.0f %% patch %d (%s) %.2f K",
                k ? ", " : "            first ray: ", 100 * (double)of->patch[k].share, of->patch[k].index,
                heat_role_name(patch->role), (double)of->patch[k].temp_k);
    }
    if (of->patches > 0) fprintf(to, "\n");
}

static void print_heats(FILE *to, const Explained *e, const Surface *surface, int count)
{
    int shown = 0;
    for (int k = 0; k < count && shown < heats_shown; k++) {
        if (!isfinite(surface[k].temp_k)) continue;
        if (shown++ == 0) fprintf(to, "\ntemperatures (means over those rays):\n");
        print_heat(to, e, &surface[k]);
    }
}

/* ---- light ------------------------------------------------------------------------------------------- */

static const char *const term_label[EXPLAIN_BOUNCES] = {"emitted",
                                                        "sun, reflected",
                                                        "sky, reflected",
                                                        "ground, reflected",
                                                        "surroundings, reflected",
                                                        "lamps",
                                                        "air before it, or the sky",
                                                        "ground beyond the terrain",
                                                        "the sun's disc",
                                                        "smoke before it",
                                                        "from neighbours (plants)"};

static void print_row(FILE *to, const Explained *e, const char *label, double (*value)(const ExplainedPlane *, int),
                      int which, const char *format)
{
    bool any = false;
    for (int k = 0; k < e->planes; k++) any |= !e->plane[k].is_radar && isfinite(value(&e->plane[k], which));
    if (!any) return;
    fprintf(to, "  %-*s", label_width - 2, label);
    for (int k = 0; k < e->planes; k++) {
        const double v = value(&e->plane[k], which);
        char         text[32] = "-";
        if (e->plane[k].is_radar) continue;
        if (isfinite(v)) snprintf(text, sizeof text, format, v);
        fprintf(to, "%12s", text);
    }
    fprintf(to, "\n");
}

/* NaN: nothing, or what rounding leaves. */
static double term_of(const ExplainedPlane *p, int which)
{
    return fabs(p->term[which]) > 1e-6 * fabs((double)p->value) ? p->term[which] : NAN;
}
static double value_of(const ExplainedPlane *p, int which) { return (double)(which ? p->value : p->sum); }
static double temp_of(const ExplainedPlane *p, int which) { return which ? NAN : p->temp_k; }
static double passes_of(const ExplainedPlane *p, int which)
{
    if (which == 2 && !(p->passes[2] < 1)) return NAN;
    return p->passes[which];
}

static void print_light(FILE *to, const Explained *e)
{
    bool any = false, thermal = false;
    for (int k = 0; k < e->planes; k++)
        any |= !e->plane[k].is_radar, thermal |= !e->plane[k].is_radar && e->plane[k].channel >= AIR_MWIR;
    if (!any) return;
    fprintf(to, "\n%-*s", label_width, "light at the eye, W/(m2 sr)");
    for (int k = 0; k < e->planes; k++)
        if (!e->plane[k].is_radar) fprintf(to, "%12s", e->plane[k].name);
    fprintf(to, "\n");
    for (int t = 0; t < EXPLAIN_BOUNCES; t++) print_row(to, e, term_label[t], term_of, t, "%.6g");
    print_row(to, e, "sum, in the program's order", value_of, 0, "%.9g");
    print_row(to, e, "the plane's value", value_of, 1, "%.9g");
    if (thermal) print_row(to, e, "apparent temperature, K", temp_of, 0, "%.3f");
    print_row(to, e, "path transmittance", passes_of, 0, "%.4f");
    if (thermal) print_row(to, e, "  for reflected sky, ground", passes_of, 1, "%.4f");
    print_row(to, e, "smoke transmittance", passes_of, 2, "%.4f");
}

static void print_radar(FILE *to, const Explained *e)
{
    for (int k = 0; k < e->planes; k++) {
        const ExplainedPlane *p = &e->plane[k];
        if (!p->is_radar) continue;
        fprintf(to, "\n%s, %s: %.6g by one bounce, %.6g by two, %.6g by three and more", p->name, p->unit,
                p->term[EXPLAIN_BOUNCES], p->term[EXPLAIN_BOUNCES + 1], p->term[EXPLAIN_BOUNCES + 2]);
        fprintf(to, "\n  sum %.9g; the plane's value %.9g\n", (double)p->sum, (double)p->value);
    }
}

/* ---- the rays ------------------------------------------------------------------------------------------ */

static void list_planes(char *out, size_t size, const Explained *e, const PixelStep *step)
{
    size_t at = 0;
    bool   all = true;
    out[0] = 0;
    for (int k = 0; k < e->planes; k++) all &= step->planes >> e->plane[k].plane & 1;
    for (int k = 0; k < e->planes && !all && at < size; k++)
        if (step->planes >> e->plane[k].plane & 1)
            at += (size_t)snprintf(out + at, size - at, "%s%s", at ? ", " : "", e->plane[k].name);
    if (all) snprintf(out, size, "all planes");
}

static int samples_of(const PixelRecord *r, int group)
{
    int count = 0;
    for (int i = 0; i < r->samples; i++) count += r->sample[i].group == group;
    return count;
}

static void print_mean(FILE *to, const PixelRecord *r, int k)
{
    const PixelStep *s = &r->step[k];
    const int        rays = s->n * s->n, parts = samples_of(r, s->group);
    if (rays == 1) fprintf(to, k ? "the same ray, with the ground about it" : "one ray");
    else fprintf(to, "%smean of %d rays (%d x %d)", k ? "sampled again: " : "", rays, s->n, s->n);
    if (s->several && parts > rays) fprintf(to, ", split by ground class into %d", parts);
    if (k > 0 && s->share == 1) fprintf(to, ", in place of the value before");
    if (s->share != 1)
        fprintf(to, ": %.1f %% of the value, and %.1f %% of the one before", 100 * s->share, 100 - 100 * s->share);
}

static void print_target(FILE *to, const Explained *e, const PixelRecord *r, const PixelStep *s)
{
    char id[dis_id_text_size];
    dis_entity_id_text(id, e->scene->snapshot.entity[s->entity].id);
    fprintf(to, "+ %s%s: %d rays of its own grid",
            s->kind == PIXEL_BEFORE ? "what hides parts of " : "the small target ", id, samples_of(r, s->group));
}

static void print_steps(FILE *to, const Explained *e)
{
    const PixelRecord *r = &e->record[0];
    fprintf(to, "how its value was made, in this order:\n");
    for (int k = 0; k < r->steps; k++) {
        const PixelStep *s = &r->step[k];
        char             planes[256];
        if (s->kind == PIXEL_BEFORE && samples_of(r, s->group) == 0) continue;
        list_planes(planes, sizeof planes, e, s);
        fprintf(to, "  ");
        if (s->kind == PIXEL_MEAN) print_mean(to, r, k);
        else if (s->kind == PIXEL_SMOOTHED)
            fprintf(to, "plants are smoothed over 3 x 3 pixels: %.1f %% is its own", 100 * (double)s->weight[4]);
        else if (s->kind == PIXEL_BESIDE) fprintf(to, "x %.4f: the share of the pixel beside small targets", s->share);
        else print_target(to, e, r, s);
        fprintf(to, " (%s)\n", planes);
    }
    if (e->record[1].steps + e->record[2].steps > 0)
        fprintf(to, "  R and B have rays of their own (lateral colour of the lens): --json lists them\n");
}

/* ---- the detector ---------------------------------------------------------------------------------------- */

static const char *const stage_name[chain_stages] = {"electrons",     "small targets", "optics and motion",
                                                     "line times",    "gain",          "dark current and noise",
                                                     "pattern noise", "AC coupling",   "counts"};

static void print_chain(FILE *to, const ExplainedBand *b, int c)
{
    double before = NAN;
    for (int s = 0; s < chain_stages; s++) {
        if (!(b->watch.has[c] >> s & 1)) continue;
        fprintf(to, "%s%s %.*f", s ? ", " : "", stage_name[s], s == CHAIN_COUNTS ? 0 : 1, b->watch.value[c][s]);
        before = b->watch.value[c][s];
    }
    if (b->watch.defect != PIXEL_GOOD && isfinite(before)) fprintf(to, ", a defective pixel");
}

static void print_band(FILE *to, const ExplainedBand *band, int b)
{
    static const char *const rgb[] = {"R ", "G ", "B "};
    fprintf(to, "  %s: ", band_name((Band)b));
    for (int c = 0; c < band->channels && band->has_chain; c++) {
        fprintf(to, "%s", band->channels == 3 ? rgb[c] : "");
        print_chain(to, band, c);
        fprintf(to, "\n    ");
    }
    if (b == BAND_RADAR) {
        fprintf(to, "displayed %d of 255, in dB below the brightest pixel\n", band->grey[0]);
        return;
    }
    if (!band->has_chain) fprintf(to, "%s", "no sensor.preset, noise as set: ");
    for (int c = 0; c < band->channels; c++)
        fprintf(to, "%s%s%.6g -> displayed %d", c ? ", " : "", band->channels == 3 ? rgb[c] : "",
                (double)band->displayed[c], band->grey[c]);
    fprintf(to, " of 255 (%sblack %.6g, white %.6g%s)\n", band->channels == 3 ? "white-balanced; " : "",
            band->level.low, band->level.high, band->curved ? ", by a curve" : "");
}

static void print_bands(FILE *to, const Explained *e)
{
    bool any = false;
    for (int b = 0; b < BAND_COUNT; b++) {
        if (!e->band[b].there) continue;
        if (!any) fprintf(to, "\nbehind the detector:\n");
        any = true;
        print_band(to, &e->band[b], b);
    }
    if (any && e->scene->config.detector.agc_s > 0)
        fprintf(to,
                "  black and white are of this frame alone; in the run they follow earlier ones (detector.agc_s)\n");
}

void explain_print(FILE *to, const Explained *e)
{
    const SavedFrame     *file = e->file;
    const ExplainedPlane *p = main_plane(e);
    Surface               surface[surfaces_most];
    const int             count = e->planes ? find_surfaces(surface, p) : 0;
    fprintf(to, "column %d, row %d of frame %d of host ", e->x, e->y, file->frame);
    text_print(to, "%s", file->host);
    fprintf(to, " at %.3f s; %d x %d pixels\n", file->time_s, e->picture->width, e->picture->height);
    print_steps(to, e);
    if (count > 0) print_surfaces(to, e, surface, count, p->name);
    print_heats(to, e, surface, count);
    print_light(to, e);
    print_radar(to, e);
    print_bands(to, e);
    fprintf(to, "\n%s\n",
            e->wrong    ? "SUMS DIFFER from the planes: see above"
            : e->differ ? "the sums are the planes' values to the bit; but the planes are not those of the run"
                        : "the sums are the planes' values to the bit, and the planes are those of the run");
}
