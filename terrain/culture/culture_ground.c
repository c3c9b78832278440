/* terrain/culture/culture_ground.c: lines of culture as what lies on a landscape. */
#include "terrain/culture/culture_ground.h"

static int surface_at(const void *of, double x_m, double y_m) { return culture_surface_at(of, x_m, y_m); }

static bool surface_near(const void *of, double x_m, double y_m, double within_m)
{
    return culture_surface_near(of, x_m, y_m, within_m);
}

void culture_lay(Landscape *landscape, const Culture *culture)
{
    bool any = false;
    for (int n = 0; culture && n < culture->lines; n++) any = any || culture->line[n].surface != SURFACE_NONE;
    landscape->over = any ? (LandscapeOver){culture, surface_at, surface_near} : (LandscapeOver){0};
}
