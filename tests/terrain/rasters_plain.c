/* tests/terrain/rasters_plain.c: a reader of rasters whose GDAL has none of the options that keep it from servers; as
 * rasters_open it has no confinement either, and as rasters_by_name it looks at names as where Landlock is missing:
 * what test_raster_reader.c compares the product with. */
#include "pitviper_confine.h"

#include <cpl_conv.h>
#include <stdio.h>

/* in the place of the jump to GDAL's own, which is weak */
void CPLSetConfigOption(const char *name, const char *value)
{
    (void)name;
    (void)value;
}

#ifdef WITHOUT_CONFINEMENT
void confine_limits(uint64_t more_octets) { (void)more_octets; }

bool confine_files(char why[confine_why_size], const char *const *readable, int count)
{
    (void)readable;
    (void)count;
    snprintf(why, confine_why_size, "not tried");
    return !BY_NAME; /* true: names are looked at as where Landlock does its part */
}

bool confine_calls(char why[confine_why_size])
{
    (void)why;
    return true;
}
#endif
