/* terrain/landscape/elevation_correct.c: corrects imported elevation by fixes of the ground. */
#include "terrain/landscape/elevation_import_private.h"

#include <stdlib.h>

Status elevation_import_correct(Import *m, const GroundFix *fix, int fix_count, double *largest_m)
{
    enum { margin = 6 };
    static const double widest_m = 16384;
    FixSet    set = {0};
    FieldAim *aim = NULL;
    Field     spline = {0};
    int       count = 0;
    Status    status = fix_set_create(&set, m->frame, fix, fix_count, m->files->horizon_m);
    if (status != STATUS_OK) return status;
    status = STATUS_NO_MEMORY;
    aim    = malloc(((size_t)set.count + 1) * sizeof *aim);
    if (!aim) goto done;
    double reach_m = 0;
    for (int n = 0; n < set.count; n++) {
        const FixRow *row = &set.row[n];
        int           corner[3];
        double        weight[3], h_m = NAN;
        if (row->dropped) continue;
        for (int k = 0; k < m->level_count && !isfinite(h_m); k++)
            h_m = posts_at(&m->level[k].z, row->x_m, row->y_m, corner, weight);
        if (!isfinite(h_m)) continue;
        aim[count++] = (FieldAim){row->x_m, row->y_m, row->h_m - h_m, false};
        reach_m = fmax(reach_m, fmax(fabs(row->x_m), fabs(row->y_m)));
    }
    status = STATUS_OK;
    if (count == 0) goto done;

    const double least_m = fmax(8, 4 * m->spacing_m[0]), half_m = fmin(reach_m + 2 * widest_m, m->files->horizon_m);
    double       spacing_m = widest_m;
    int          half = (int)ceil(half_m / spacing_m) + margin;
    status = field_create(&spline, spacing_m, -half, -half, 2 * half + 1, 2 * half + 1);
    for (;;) {
        if (status == STATUS_OK) status = field_pull(&spline, aim, count);
        if (status != STATUS_OK) goto done;
        half = (int)ceil((reach_m + 8 * spacing_m) / spacing_m) * 2 + margin;
        if (half > spline.nx - 1 - 8) half = spline.nx - 1 - 8;
        if (spacing_m / 2 < least_m || (double)half * half > 4e6) break;
        Field fine;
        status = field_refine(&fine, &spline, -half, -half, 2 * half + 1, 2 * half + 1);
        if (status != STATUS_OK) goto done;
        field_destroy(&spline);
        spline = fine;
        spacing_m /= 2;
    }
    /* no data beyond the finest window: faded to 0 over its last eighth */
    const double edge_m = (half - margin) * spline.spacing_m;
    for (int k = 0; k < m->level_count; k++) {
        Field *z = &m->level[k].z;
        for (int j = 0; j < z->ny; j++)
            for (int i = 0; i < z->nx; i++) {
                const double x_m = (z->i0 + i) * z->spacing_m, y_m = (z->j0 + j) * z->spacing_m;
                const double out_m = fmax(fabs(x_m), fabs(y_m));
                if (out_m >= edge_m) continue;
                const double by_m =
                    field_spline_at(&spline, x_m, y_m) * (1 - smooth_step(0.875 * edge_m, edge_m, out_m));
                if (!isfinite(by_m)) continue;
                z->v[(size_t)j * (size_t)z->nx + (size_t)i] += (float)by_m;
                *largest_m = fmax(*largest_m, fabs(by_m));
            }
    }
done:
    field_destroy(&spline);
    free(aim);
    fix_set_destroy(&set);
    return status;
}
