/* entities/catalog/model_size.c: lengths of things, from the catalog and the built-in shapes; a model's size against
 * what is expected, under other axes and units. */

#include "entities/catalog/model_size_private.h"
#include "entities/shapes/parametric.h"

#include <ctype.h>
#include <strings.h>

void model_size_range_take(SizeRange *r, double size_m, const char *who)
{
    if (!(size_m > 0)) return;
    if (r->high_m == 0 || size_m < r->low_m) {
        r->low_m = size_m;
        snprintf(r->low, sizeof r->low, "%s", who);
    }
    if (size_m > r->high_m) {
        r->high_m = size_m;
        snprintf(r->high, sizeof r->high, "%s", who);
    }
}

/* Whether `word` stands in `name`, in any case, with no letter before and after it. */
static bool has_word(const char *name, const char *word)
{
    const size_t length = strlen(word);
    for (const char *at = name; *at; at++) {
        if (at > name && isalpha((unsigned char)at[-1])) continue;
        if (strncasecmp(at, word, length) == 0 && !isalpha((unsigned char)at[length])) return true;
    }
    return false;
}

bool model_size_range_named(SizeRange *out, const char *name)
{
    static const double coarse_m = 0.1;
    const char         *best = NULL;
    for (int i = 0; i < parametric_count(); i++) {
        const char *shape = parametric_name(i);
        if (strcmp(shape, "unknown") != 0 && has_word(name, shape) && (!best || strlen(shape) > strlen(best)))
            best = shape;
    }
    Model model;
    *out = (SizeRange){0};
    if (!best || parametric_build(&model, best, coarse_m) != STATUS_OK) return false;
    model_size_range_take(out, model_size_largest_m(&model), best);
    model_destroy(&model);
    return true;
}

double model_size_largest_m(const Model *model)
{
    return fmax(model->length_m, fmax(model->width_m, fmax(model->box_high[2], 0) - model->box_low[2]));
}

bool model_size_is_odd(char advice[200], double largest_m, const SizeRange *range, double slack,
                       const ModelImport *import)
{
    static const struct {
        double      factor;
        const char *unit;
    } units[] = {{0.01, "centimetres"}, {0.001, "millimetres"}, {0.0254, "inches"}, {0.3048, "feet"},
                 {100, NULL},           {1000, NULL},           {1 / 0.0254, NULL}, {1 / 0.3048, NULL}};
    advice[0] = 0;
    if (range->high_m == 0 || (largest_m <= slack * range->high_m && slack * largest_m >= range->low_m)) return false;
    const double middle = sqrt(range->low_m * range->high_m);
    int          best = -1;
    double       nearest = INFINITY;
    for (int u = 0; u < (int)(sizeof units / sizeof *units); u++) {
        const double size = largest_m * units[u].factor, off = fabs(log(size / middle));
        if (size > slack * range->high_m || slack * size < range->low_m || off > nearest - 1e-9) continue;
        best = u;
        nearest = off;
    }
    if (best < 0)
        snprintf(advice, 200, "no usual unit explains it: is it this model? `scale` in its sidecar changes it");
    else
        snprintf(advice, 200, "`scale: %.4g`%s%s%s in its sidecar makes it %.3g m",
                 import->scale_m * units[best].factor, units[best].unit ? " (drawn in " : "",
                 units[best].unit ? units[best].unit : "", units[best].unit ? ")" : "", largest_m * units[best].factor);
    return true;
}

/* ---- an expected size ----------------------------------------------------------------------- */

/* Units that files are drawn in, in metres, and the same units applied the wrong way round. */
static const struct {
    double      factor;
    const char *unit;
} units[] = {{1, NULL},          {0.001, "millimetres"}, {0.01, "centimetres"},
             {0.0254, "inches"}, {0.3048, "feet"},       {1000, NULL},
             {100, NULL},        {1 / 0.0254, NULL},     {1 / 0.3048, NULL}};

/* The axes as loaded come first, then a turn about the vertical, then what a file with another upward axis gives. */
static const int orders[6][3] = {{0, 1, 2}, {1, 0, 2}, {2, 0, 1}, {0, 2, 1}, {1, 2, 0}, {2, 1, 0}};

/* The largest logarithm, over the known lengths, of the ratio of actual to expected length. */
static double misfit(const double has_m[3], const double want_m[3], const int axis[3], double factor)
{
    double worst = 0;
    for (int k = 0; k < 3; k++)
        if (want_m[k] > 0) worst = fmax(worst, fabs(log(has_m[axis[k]] * factor / want_m[k])));
    return worst;
}

/* The rms of these logarithms, to choose among several that agree. */
static double rms_size_error(const double has_m[3], const double want_m[3], const int axis[3], double factor)
{
    double sum = 0;
    for (int k = 0; k < 3; k++)
        if (want_m[k] > 0) sum += pow(log(has_m[axis[k]] * factor / want_m[k]), 2);
    return sqrt(sum);
}

/* The mean factor that all lengths would need. */
static double mean_factor(const double has_m[3], const double want_m[3], const int axis[3])
{
    double sum = 0;
    int    count = 0;
    for (int k = 0; k < 3; k++)
        if (want_m[k] > 0) sum += log(want_m[k] / has_m[axis[k]]), count++;
    return exp(sum / count);
}

/* The file's axis, as a sidecar names it, that lies along a body axis of the model as loaded. */
static char letter(const ModelImport *import, int body_axis)
{
    const double *row = import->r_body_from_file + 3 * body_axis;
    int           most = 0;
    for (int i = 1; i < 3; i++)
        if (fabs(row[i]) > fabs(row[most])) most = i;
    return (char)('x' + most);
}

static void advise(ModelFit *fit, const ModelImport *import, const char *unit)
{
    char       axes[160] = "", scale[120] = "";
    const bool turned = fit->axis[0] != 0 || fit->axis[2] != 2;
    if (turned)
        snprintf(axes, sizeof axes, "`axes: '+%c +%c'` (forward, up; a - turns one about)",
                 letter(import, fit->axis[0]), letter(import, fit->axis[2]));
    if (fabs(fit->factor - 1) > 1e-9)
        snprintf(scale, sizeof scale, "`scale: %.4g`%s%s%s", import->scale_m * fit->factor,
                 unit ? " (the file is in " : "", unit ? unit : "", unit ? ")" : "");
    snprintf(fit->advice, sizeof fit->advice,
             "%s%s%s in its sidecar would give that size; look at it with `pitviper "
             "model show`",
             axes, *axes && *scale ? " and " : "", scale);
}

void model_fit(ModelFit *out, const Model *model, const ModelImport *import, const ModelSize *want, double tolerance)
{
    const double has_m[3] = {model->length_m, model->width_m, fmax(model->box_high[2], 0) - model->box_low[2]};
    const double want_m[3] = {want->length_m, want->width_m, want->height_m};
    const double most = log(tolerance),
                 dearer = 0.02; /* a simple remedy is preferred to a complicated one that fits 2 % better */
    const char *unit = NULL;
    double      best = INFINITY;
    int         known = 0;
    *out = (ModelFit){.axis = {0, 1, 2}, .factor = 1};
    for (int k = 0; k < 3; k++) {
        known += want_m[k] > 0;
        if (!(has_m[k] > 0)) known = -9; /* a flat thing has no proportions */
    }
    out->fits = known <= 0 || misfit(has_m, want_m, orders[0], 1) <= most;
    if (out->fits) return;
    for (size_t o = 0; o < 6; o++)
        for (size_t u = 0; u < sizeof units / sizeof *units; u++) {
            const double wrong = misfit(has_m, want_m, orders[o], units[u].factor);
            const double cost =
                rms_size_error(has_m, want_m, orders[o], units[u].factor) + dearer * ((o > 0) + (u > 0));
            if (wrong > most || cost >= best) continue;
            best = cost;
            memcpy(out->axis, orders[o], sizeof out->axis);
            out->factor = units[u].factor;
            unit = fabs(import->scale_m - 1) < 1e-12 ? units[u].unit : NULL;
        }
    const bool exact = tolerance < 1.25; /* where sizes are known roughly, only usual scales are suggested */
    for (size_t o = 0; o < 6 && exact && !(best < INFINITY) && known > 1; o++) {
        const double factor = mean_factor(has_m, want_m, orders[o]);
        if (misfit(has_m, want_m, orders[o], factor) > most) continue;
        best = 0;
        memcpy(out->axis, orders[o], sizeof out->axis);
        out->factor = factor;
    }
    if (best < INFINITY) {
        advise(out, import, unit);
        return;
    }
    out->factor = 0;
    snprintf(out->advice, sizeof out->advice,
             "neither other axes nor another unit explain it: is it this model? `pitviper model show` draws it");
}
