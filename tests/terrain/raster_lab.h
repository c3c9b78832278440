/* tests/terrain/raster_lab.h: small raster files made octet by octet, and the processes that read them. */
#ifndef TESTS_TERRAIN_RASTER_LAB_H
#define TESTS_TERRAIN_RASTER_LAB_H

#include "tests/check.h"

#include "terrain/elevation/raster.h"
#include "terrain/elevation/raster_child.h"

#include <dirent.h>
#include <sys/stat.h>

typedef struct LabFile {
    uint8_t octets[1 << 19];
    size_t  count;
} LabFile;

static inline void lab_put(LabFile *f, const void *octets, size_t count)
{
    CHECK(f->count + count <= sizeof f->octets);
    memcpy(f->octets + f->count, octets, count);
    f->count += count;
}

static inline void lab_number(LabFile *f, uint64_t value, int octets, bool big)
{
    for (int n = 0; n < octets; n++) {
        const uint8_t octet = (uint8_t)(value >> 8 * (big ? octets - 1 - n : n));
        lab_put(f, &octet, 1);
    }
}

static inline void lab_double(LabFile *f, double value, bool big)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    lab_number(f, bits, 8, big);
}

static inline void lab_float(LabFile *f, float value, bool big)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    lab_number(f, bits, 4, big);
}

static inline void lab_save(const LabFile *f, const char *path)
{
    FILE *file = fopen(path, "wb");
    CHECK(file && fwrite(f->octets, 1, f->count, file) == f->count && fclose(file) == 0);
}

/* A GeoTIFF in UTM 33 N, pixels of 10 m, side x side tiles of 64 x 64 floats; bit n of has: tile n is in the file.
 * nodata: NAN: none is declared. */
static inline float lab_height(int x, int y) { return (float)(300 + x + 0.25 * y); }
static inline void  lab_tiff(LabFile *f, int side, uint32_t has, double nodata)
{
    enum { tile = 64 };
    const uint32_t tiles = (uint32_t)(side * side), ascii = !isnan(nodata), tags = 14 + ascii;
    const uint32_t lists = 8 + 2 + 12 * tags + 4, scale = lists + 8 * tiles, tie = scale + 24, keys = tie + 48,
                   text = keys + 32;
    const uint32_t        data = text + 16;
    static const uint16_t geo[16] = {1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 1, 3072, 0, 1, 32633};
    f->count = 0;
    lab_put(f, "II*\0", 4);
    lab_number(f, 8, 4, false);
    lab_number(f, tags, 2, false);
    const uint32_t entry[15][4] = {{256, 4, 1, (uint32_t)(side * tile)},
                                   {257, 4, 1, (uint32_t)(side * tile)},
                                   {258, 3, 1, 32},
                                   {259, 3, 1, 1},
                                   {262, 3, 1, 1},
                                   {277, 3, 1, 1},
                                   {322, 3, 1, tile},
                                   {323, 3, 1, tile},
                                   {324, 4, tiles, lists},
                                   {325, 4, tiles, lists + 4 * tiles},
                                   {339, 3, 1, 3},
                                   {33550, 12, 3, scale},
                                   {33922, 12, 6, tie},
                                   {34735, 3, 16, keys},
                                   {42113, 2, 16, text}};
    for (uint32_t t = 0; t < tags; t++) {
        lab_number(f, entry[t][0], 2, false);
        lab_number(f, entry[t][1], 2, false);
        lab_number(f, entry[t][2], 4, false);
        lab_number(f, entry[t][3], 4, false);
    }
    lab_number(f, 0, 4, false);
    uint32_t at = data;
    for (uint32_t n = 0; n < tiles; n++) {
        lab_number(f, has >> n & 1 ? at : 0, 4, false);
        at += has >> n & 1 ? 4 * tile * tile : 0;
    }
    for (uint32_t n = 0; n < tiles; n++) lab_number(f, has >> n & 1 ? 4 * tile * tile : 0, 4, false);
    for (int k = 0; k < 3; k++) lab_double(f, k < 2 ? 10 : 0, false);
    for (int k = 0; k < 6; k++) lab_double(f, k == 3 ? 500000 : k == 4 ? 5200000 : 0, false);
    for (int k = 0; k < 16; k++) lab_number(f, geo[k], 2, false);
    char number[16] = "";
    snprintf(number, sizeof number, "%.6g", nodata);
    lab_put(f, number, sizeof number);
    for (int n = 0; n < side * side; n++)
        for (int p = 0; has >> n & 1 && p < tile * tile; p++)
            lab_float(f, lab_height(n % side * tile + p % tile, n / side * tile + p / tile), false);
}

static inline void lab_vrt(LabFile *f, const char *source)
{
    f->count = 0;
    f->count = (size_t)snprintf(
        (char *)f->octets, sizeof f->octets,
        "<VRTDataset rasterXSize=\"64\" rasterYSize=\"64\"><SRS>EPSG:32633</SRS>"
        "<GeoTransform>500000,10,0,5200000,0,-10</GeoTransform><VRTRasterBand dataType=\"Float32\" band=\"1\">"
        "<NoDataValue>-9999</NoDataValue><SimpleSource><SourceFilename relativeToVRT=\"0\">%s</SourceFilename>"
        "<SourceBand>1</SourceBand><SrcRect xOff=\"0\" yOff=\"0\" xSize=\"64\" ySize=\"64\"/>"
        "<DstRect xOff=\"0\" yOff=\"0\" xSize=\"64\" ySize=\"64\"/></SimpleSource></VRTRasterBand></VRTDataset>",
        source);
}

/* ---- processes: the one that starts readers, and the readers ---- */

static inline pid_t lab_child_of(pid_t parent)
{
    DIR  *all = opendir("/proc");
    pid_t found = 0;
    for (struct dirent *entry; all && (entry = readdir(all));) {
        char path[300], state;
        int  number, of;
        if (sscanf(entry->d_name, "%d", &number) != 1) continue;
        snprintf(path, sizeof path, "/proc/%d/stat", number);
        FILE *stat = fopen(path, "r");
        if (stat && fscanf(stat, "%*d (pitviper-raster) %c %d", &state, &of) == 2 && of == parent && state != 'Z')
            found = number;
        if (stat) fclose(stat);
    }
    if (all) closedir(all);
    return found;
}

static inline pid_t lab_starter(void) { return lab_child_of(getpid()); }
static inline pid_t lab_reader(void)
{
    const pid_t reader = lab_child_of(lab_starter());
    CHECK(reader > 0);
    return reader;
}

#endif
