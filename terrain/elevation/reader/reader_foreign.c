/* terrain/elevation/reader/reader_foreign.c: terrain databases of visual systems, which are not read: how one is known
 * by its name, and what to do with it. */
#include "terrain/elevation/reader/reader_private.h"

#include <strings.h>
#include <sys/stat.h>

static bool ends_in(const char *path, const char *ending)
{
    const size_t length = strlen(path), octets = strlen(ending);
    return length >= octets && strcasecmp(path + length - octets, ending) == 0;
}

static bool holds(const char *folder, const char *name)
{
    char        path[wire_path_size];
    struct stat about;
    return snprintf(path, sizeof path, "%s/%s", folder, name) < (int)sizeof path && stat(path, &about) == 0;
}

const char *reader_foreign(const char *path)
{
    static const char *const tiles[] = {"tileset.json", ".b3dm", ".i3dm", ".cmpt", ".pnts", ".subtree"};
    for (size_t k = 0; k < sizeof tiles / sizeof *tiles; k++)
        if (ends_in(path, tiles[k]) || (k == 0 && holds(path, tiles[k])))
            return "3D Tiles are not read: give elevation as GeoTIFF and buildings as footprints with heights "
                   "(GeoJSON, GeoPackage, Shapefile), of which tiles are made as a rule";
    if (ends_in(path, ".flt"))
        return "OpenFlight terrain is not read: export its elevation as GeoTIFF and its buildings as footprints with "
               "heights from the program that made it (a GridFloat file of this name needs its .hdr beside it)";
    if (holds(path, "Tiles") && (holds(path, "Metadata") || holds(path, "GTModel")))
        return "a CDB store is not read as a whole: name the folders of its elevation tiles "
               "(Tiles/N*/E*/001_Elevation/L*/U*), and convert its vectors (ogr2ogr OUT.gpkg FILE.shp)";
    return NULL;
}
