/* terrain/from_files/elevation_survey.c: range, suspected voids and unit of files of heights. */
#include "terrain/from_files/elevation_import.h"

#include <stdlib.h>

const double elevation_lowest_m = -12500, elevation_highest_m = 9500;

enum { window_side = 512, windows_a_side = 8, whole_posts = 16 << 20, least_posts = 64 };

/* ---- numbers --------------------------------------------------------------------------------- */

/* The lowest heights and how often each occurs. Those that remain at the end were counted completely. */
typedef struct Lowest {
    int    count;
    double h_m[survey_most_voids + 1], posts[survey_most_voids + 1];
} Lowest;

static void lowest_add(Lowest *l, double h_m, double posts)
{
    int at = l->count;
    while (at > 0 && l->h_m[at - 1] > h_m) at--;
    if (at > 0 && l->h_m[at - 1] == h_m) {
        l->posts[at - 1] += posts;
        return;
    }
    if (at == survey_most_voids + 1) return;
    if (l->count <= survey_most_voids) l->count++;
    for (int k = l->count - 1; k > at; k--) {
        l->h_m[k] = l->h_m[k - 1];
        l->posts[k] = l->posts[k - 1];
    }
    l->h_m[at] = h_m;
    l->posts[at] = posts;
}

/* A difference larger than ground falls between two posts. */
static double least_gap_m(const Raster *raster) { return clamp(4 * raster->posting_m[0], 300, 5000); }

/* How many of the lowest heights lie below all others by more than gap_m; 0: none do. */
static int alone(const Lowest *l, double gap_m)
{
    for (int k = l->count - 1; k > 0; k--)
        if (l->h_m[k] - l->h_m[k - 1] > gap_m) return k;
    return 0;
}

typedef struct Counts {
    Lowest lowest;
    double posts, voids, outside, high_m;
    double lengths; /* how many of those outside may be heights in another unit, 1e7 at most */
    bool   beside;  /* numbers that are alone were seen beside one another */
    double least_out_m, most_out_m;
} Counts;

static const Counts no_counts = {.high_m = -INFINITY, .least_out_m = INFINITY, .most_out_m = -INFINITY};

static void counts_add(Counts *to, const Counts *from)
{
    to->posts += from->posts;
    to->voids += from->voids;
    to->outside += from->outside;
    to->lengths += from->lengths;
    to->high_m = fmax(to->high_m, from->high_m);
    to->least_out_m = fmin(to->least_out_m, from->least_out_m);
    to->most_out_m = fmax(to->most_out_m, from->most_out_m);
    to->beside |= from->beside;
    for (int k = 0; k < from->lowest.count; k++) lowest_add(&to->lowest, from->lowest.h_m[k], from->lowest.posts[k]);
}

static void count_posts(Counts *c, const float *value, size_t count, double unit_m)
{
    double last = INFINITY; /* the lowest number for which there is no room */
    for (size_t n = 0; n < count; n++) {
        const double h_m = value[n] * unit_m;
        c->posts++;
        if (isnan(h_m)) c->voids++;
        else if (!(h_m >= elevation_lowest_m && h_m <= elevation_highest_m)) {
            c->outside++;
            c->lengths += fabs(h_m) <= 1e7;
            c->least_out_m = fmin(c->least_out_m, h_m);
            c->most_out_m = fmax(c->most_out_m, h_m);
        } else {
            if (h_m <= last) {
                lowest_add(&c->lowest, h_m, 1);
                if (c->lowest.count > survey_most_voids) last = c->lowest.h_m[survey_most_voids];
            }
            c->high_m = fmax(c->high_m, h_m);
        }
    }
}

/* ---- reading --------------------------------------------------------------------------------- */

typedef struct Job {
    const Raster *raster;
    const char   *key;
    bool          whole;
    int           band, rows; /* rows: those of a strip, when the whole raster is looked at */
    double        gap_m;
    Counts       *counts; /* [tasks] */
    Status       *status;
} Job;

static void look_at(Job *job, int task, int x0, int y0, int width, int height)
{
    const size_t count = (size_t)width * (size_t)height;
    float       *value = malloc(count * sizeof *value);
    Counts       here = no_counts;
    Status       status = value ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK)
        status = raster_read(value, job->raster, job->band, (RasterWindow){x0, y0, width, height}, job->key);
    if (status == STATUS_OK) {
        count_posts(&here, value, count, job->raster->metres_per_unit);
        here.beside = alone(&here.lowest, job->gap_m) > 0;
        counts_add(&job->counts[task], &here);
    } else job->status[task] = status;
    free(value);
}

static void look(void *user, int worker, int task)
{
    Job          *job = user;
    const Raster *raster = job->raster;
    (void)worker;
    job->counts[task] = no_counts;
    if (job->whole) {
        const int y0 = task * job->rows, y1 = y0 + job->rows < raster->height ? y0 + job->rows : raster->height;
        look_at(job, task, 0, y0, raster->width, y1 - y0);
        return;
    }
    const int w = raster->width < window_side ? raster->width : window_side;
    const int h = raster->height < window_side ? raster->height : window_side;
    for (int k = 0; k < windows_a_side && job->status[task] == STATUS_OK; k++)
        look_at(job, task, (int)((int64_t)(raster->width - w) * k / (windows_a_side - 1)),
                (int)((int64_t)(raster->height - h) * task / (windows_a_side - 1)), w, h);
}

static Status look_all(Counts *out, Job *job, Pool *pool)
{
    const int tasks = job->whole ? (job->raster->height + job->rows - 1) / job->rows : windows_a_side;
    Status    status = STATUS_OK;
    job->counts = calloc((size_t)tasks, sizeof *job->counts);
    job->status = calloc((size_t)tasks, sizeof *job->status);
    if (!job->counts || !job->status) status = STATUS_NO_MEMORY;
    if (status == STATUS_OK && pool) pool_run(pool, tasks, look, job);
    for (int n = 0; status == STATUS_OK && !pool && n < tasks; n++) look(job, 0, n);
    *out = no_counts;
    for (int n = 0; status == STATUS_OK && n < tasks; n++) {
        status = job->status[n];
        counts_add(out, &job->counts[n]);
    }
    free(job->counts);
    free(job->status);
    return status;
}

/* ---- judgement ------------------------------------------------------------------------------- */

static const char *path_of(const Raster *raster) { return raster->sheet[0].path; }

/* Whether the raster can be heights at all, by what the file states. */
static Status judge_stated(const Raster *raster, const char *key)
{
    const RasterStated *s = &raster->stated;
    const RasterChoice *c = &raster->choice;
    const char         *path = path_of(raster);
    const char         *unit = *c->unit ? c->unit : s->unit;
    if ((s->coloured || s->grey) && !c->band && !*c->unit) {
        log_error("%s: %s holds %s of %d band%s: a photograph, not heights; a photograph goes to terrain.orthophoto "
                  "(terrain import: --photo); %s:1 takes band 1 as heights all the same",
                  key, path, s->coloured ? "colours" : "octets without a unit", raster->bands,
                  raster->bands == 1 ? "" : "s", path);
        return STATUS_BAD_VALUE;
    }
    if (*unit && !(raster_unit_m(unit) > 0)) {
        log_error("%s: %s: its unit is '%s', which is no length that is known here; say what its heights are in: %s@m, "
                  "%s@ft or %s@us-ft (terrain import: --unit)",
                  key, path, unit, path, path, path);
        return STATUS_BAD_VALUE;
    }
    if (!*unit && s->crs_unit_m > 0 && fabs(s->crs_unit_m - 1) > 1e-6) {
        log_error(
            "%s: %s does not say the unit of its heights, and its coordinate system %s is in '%s'; say it: %s@m or "
            "%s@%s (terrain import: --unit)",
            key, path, s->crs, s->crs_unit, path, path, fabs(s->crs_unit_m - 0.3048) < 1e-9 ? "ft" : "us-ft");
        return STATUS_BAD_VALUE;
    }
    return STATUS_OK;
}

static bool is_usual(double value)
{
    static const double usual[] = {-9999, -999, -9998, -99999, -32767, -32768, -9999.9, -999.9};
    for (size_t k = 0; k < sizeof usual / sizeof *usual; k++)
        if (fabs(value - usual[k]) < 1e-3) return true;
    return false;
}

static void warn_of_voids(const ElevationSurvey *s, const char *key)
{
    char        numbers[120] = "";
    const char *path = path_of(s->raster);
    for (int k = 0; k < s->suspects && k < 3; k++) {
        const size_t used = strlen(numbers);
        snprintf(numbers + used, sizeof numbers - used, "%s%.7g", k ? ", " : "", s->suspect[k]);
    }
    if (!(s->gap_m > 0)) {
        log_warn("%s: %s holds %s alone: taken for voids that no tag declares; %s@nodata=none reads them as heights",
                 key, path, numbers, path);
        return;
    }
    log_warn("%s: %s: %s%.0f posts of %s%s lie %.0f m below all others: taken for voids that no tag declares, and "
             "filled; %s@nodata=%.7g says so too, @nodata=none reads them as heights (terrain import: --nodata)",
             key, path, s->whole ? "" : "at least ", s->suspect_posts, numbers, s->suspects > 3 ? " ..." : "", s->gap_m,
             path, s->suspect[0]);
}

static Status judge_counts(ElevationSurvey *s, Raster *raster, const Counts *c, const char *key)
{
    const double unit_m = raster->metres_per_unit, heights = c->posts - c->voids - c->outside;
    const char  *path = path_of(raster);
    const bool   constant = !(c->least_out_m < c->most_out_m); /* a single number is a void, however often it occurs */
    if (!constant && (c->lengths > heights || !(heights > 0))) {
        log_error(
            "%s: %s: numbers of %.6g .. %.6g, which are no heights on Earth in %s; say what they are: %s@cm, %s@dm "
            "(terrain import: --unit), or declare its voids: %s@nodata=%.7g",
            key, path, fmin(c->least_out_m / unit_m, c->most_out_m / unit_m),
            fmax(c->least_out_m / unit_m, c->most_out_m / unit_m),
            *raster->choice.unit   ? raster->choice.unit
            : *raster->stated.unit ? raster->stated.unit
                                   : "metres",
            path, path, path, c->least_out_m / unit_m);
        return STATUS_BAD_VALUE;
    }
    if (c->outside > 0)
        log_warn(
            "%s: %s: %s%.0f posts are no heights on Earth (%.6g .. %.6g m): taken for voids that no tag declares, and "
            "filled; %s@nodata=%.7g says so (terrain import: --nodata)",
            key, path, s->whole ? "" : "at least ", c->outside, c->least_out_m, c->most_out_m, path,
            c->least_out_m / unit_m);
    int n = raster->choice.no_void || heights < least_posts ? 0 : alone(&c->lowest, least_gap_m(raster));
    if (n > 0 && !s->whole && !c->beside)
        for (int k = 0; k < n; k++)
            if (!is_usual(c->lowest.h_m[k] / unit_m)) n = 0;
    const bool empty = n == 0 && !raster->choice.no_void && c->lowest.count == 1 && is_usual(c->lowest.h_m[0] / unit_m);
    s->low_m = heights > 0 && !empty ? c->lowest.h_m[n] : NAN;
    s->high_m = heights > 0 && !empty ? c->high_m : NAN;
    if (n == 0 && !empty) return STATUS_OK;
    s->suspects = n + empty;
    s->gap_m = empty ? 0 : c->lowest.h_m[n] - c->lowest.h_m[n - 1];
    for (int k = 0; k < s->suspects; k++) {
        s->suspect[k] = c->lowest.h_m[k] / unit_m;
        s->suspect_posts += c->lowest.posts[k];
    }
    const double limit = (empty ? c->lowest.h_m[0] + 1 : 0.5 * (c->lowest.h_m[n] + c->lowest.h_m[n - 1])) / unit_m;
    if (unit_m > 0) raster->low = limit;
    else raster->high = limit;
    warn_of_voids(s, key);
    return STATUS_OK;
}

Status elevation_survey(ElevationSurvey *out, Raster *raster, const char *key, Pool *pool)
{
    ElevationSurvey s = {.raster = raster, .low_m = NAN, .high_m = NAN};
    Job             job = {.raster = raster,
                           .key = key,
                           .band = 1,
                           .rows = raster->row_block > 0 ? raster->row_block : 64,
                           .gap_m = least_gap_m(raster)};
    Counts          counts = no_counts;
    Status          status = judge_stated(raster, key);
    if (status == STATUS_OK) {
        s.whole = job.whole = (double)raster->width * raster->height <= whole_posts;
        status = look_all(&counts, &job, pool);
    }
    s.posts = counts.posts;
    s.voids = counts.voids;
    s.outside = counts.outside;
    if (status == STATUS_OK) status = judge_counts(&s, raster, &counts, key);
    *out = s;
    return status;
}

void elevation_survey_words(const char **unit, const char **unit_from, const char **datum, const char **datum_from,
                            const ElevationSurvey *survey)
{
    const Raster       *raster = survey->raster;
    const RasterStated *s = &raster->stated;
    const RasterChoice *c = &raster->choice;
    *unit = *c->unit ? c->unit : *s->unit ? s->unit : "metre";
    *unit_from = *c->unit ? "named" : !*s->unit ? "not stated" : s->unit_of_crs ? "of its vertical system" : "stated";
    *datum = survey->ellipsoidal ? "the ellipsoid" : "the geoid";
    *datum_from = c->vertical != RASTER_VERTICAL_BY_CRS ? "named"
                  : *s->vertical                        ? s->vertical
                  : raster->ellipsoidal                 ? "its coordinate system has three axes"
                                                        : "not stated";
}
