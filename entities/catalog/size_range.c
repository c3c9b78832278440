/* entities/catalog/size_range.c: lengths of things, from the catalog and the built-in shapes. */
#include "entities/catalog/size_range.h"

#include "entities/parametric/parametric.h"

#include <ctype.h>
#include <strings.h>

void size_range_take(SizeRange *r, double size_m, const char *who)
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

bool size_range_named(SizeRange *out, const char *name)
{
    static const double coarse_m = 0.1;
    const char *best = NULL;
    for (int i = 0; i < parametric_count(); i++) {
        const char *shape = parametric_name(i);
        if (strcmp(shape, "unknown") != 0 && has_word(name, shape) && (!best || strlen(shape) > strlen(best)))
            best = shape;
    }
    Model model;
    *out = (SizeRange){0};
    if (!best || parametric_build(&model, best, coarse_m) != STATUS_OK) return false;
    size_range_take(out, size_of_model(&model), best);
    model_destroy(&model);
    return true;
}

double size_of_model(const Model *model)
{
    return fmax(model->length_m, fmax(model->width_m, fmax(model->box_high[2], 0) - model->box_low[2]));
}

bool size_is_odd(char advice[200], double largest_m, const SizeRange *range, double slack, const ModelImport *import)
{
    static const struct {
        double factor;
        const char *unit;
    } units[] = {{0.01, "centimetres"}, {0.001, "millimetres"}, {0.0254, "inches"}, {0.3048, "feet"},
                 {100, NULL},           {1000, NULL},           {1 / 0.0254, NULL}, {1 / 0.3048, NULL}};
    advice[0] = 0;
    if (range->high_m == 0 || (largest_m <= slack * range->high_m && slack * largest_m >= range->low_m)) return false;
    const double middle = sqrt(range->low_m * range->high_m);
    int best = -1;
    double nearest = INFINITY;
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
