/* entities/scenery/clutter_variants.c: the shapes of clutter in their paints and sizes. */
#include "entities/scenery/scenery_clutter_private.h"
#include "entities/shapes/parametric.h"

#include <stdio.h>
#include <stdlib.h>

enum { lengths = 3 };
static const double coarse_m = 0.1;

static ModelSize size_of(const ClutterVariant *v) { return (ModelSize){.length_m = v->length_m}; }

/* Paint n of a row; false: there are fewer. */
static bool paint_of(char out[32], const ClutterRow *row, int n)
{
    const char *at = row->paint + strspn(row->paint, " ");
    for (; n > 0 && *at; n--) at += strcspn(at, " "), at += strspn(at, " ");
    snprintf(out, 32, "%.*s", (int)strcspn(at, " "), at);
    return *out;
}

static int same_as(const ClutterWork *work, const ClutterVariant *v)
{
    int k = 0;
    for (; &work->variant[k] < v; k++) {
        const ClutterVariant *o = &work->variant[k];
        if (strcmp(o->row->shape, v->row->shape) == 0 && strcmp(o->paint, v->paint) == 0 &&
            !(o->length_m < v->length_m) && !(o->length_m > v->length_m))
            break;
    }
    return k;
}

Status clutter_make_variants(ClutterWork *work)
{
    const ClutterTable *table = &work->table;
    work->variant = calloc((size_t)table->rows * clutter_most_variants * lengths + 1, sizeof *work->variant);
    if (!work->variant) return STATUS_NO_MEMORY;
    for (int r = 0; r < table->rows; r++) {
        const ClutterRow *row = &table->row[r];
        const int         sizes = row->length_high_m > row->length_low_m ? lengths : 1;
        work->first_variant[r] = work->variants;
        for (int size = 0; size < sizes; size++) {
            Model          model = {0};
            ClutterVariant v = {.row = row, .model = -1, .length_m = row->length_low_m};
            char           paint[32];
            if (sizes > 1 && row->length_low_m > 0)
                v.length_m *= pow(row->length_high_m / row->length_low_m, (double)size / (sizes - 1));
            const ModelSize of = size_of(&v);
            const Status    status = parametric_build_size(&model, row->shape, &of, coarse_m);
            if (status != STATUS_OK) return status;
            v.size_m[0] = (float)model.length_m, v.size_m[1] = (float)model.width_m,
            v.size_m[2] = (float)model.height_m;
            model_destroy(&model);
            work->variant[work->variants++] = v;
            for (int n = 0; paint_of(paint, row, n); n++) {
                if (n > 0) work->variant[work->variants++] = v;
                memcpy(work->variant[work->variants - 1].paint, paint, sizeof paint);
            }
        }
    }
    work->first_variant[table->rows] = work->variants;
    for (int k = 0; k < work->variants; k++) work->variant[k].same = same_as(work, &work->variant[k]);
    return STATUS_OK;
}

int clutter_variant_of(const ClutterWork *work, int row, uint64_t h)
{
    const int first = work->first_variant[row], count = work->first_variant[row + 1] - first;
    return first + (int)(clutter_unit(h, 90) * count);
}

Status clutter_build_variant(Model *out, const ClutterVariant *v, double sag_m)
{
    const ModelSize of = size_of(v);
    const Status    status = parametric_build_size(out, v->row->shape, &of, sag_m);
    if (status != STATUS_OK || !*v->paint) return status;
    char old[sizeof out->part->material];
    int  first = 0;
    for (int p = out->part_count - 1; p >= 0; p--)
        if (strncmp(out->part[p].material, "paint_", 6) == 0) first = p;
    memcpy(old, out->part[first].material, sizeof old);
    for (int p = 0; p < out->part_count; p++)
        if (strcmp(out->part[p].material, old) == 0) memcpy(out->part[p].material, v->paint, sizeof v->paint);
    return STATUS_OK;
}
