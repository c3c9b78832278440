/* terrain/landscape/take_apart.c: a surface model taken apart: not in this build. */
#include "terrain/landscape/take_apart.h"

Status surface_take_apart(SurfaceParts *out, const SurfaceModel *model)
{
    (void)out;
    (void)model;
    log_error("terrain import: surface models cannot be taken apart in this build; give a terrain model");
    return STATUS_UNSUPPORTED;
}
