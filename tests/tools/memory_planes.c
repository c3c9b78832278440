/* memory_planes OUT RAW: whether the planes that a reader of shared memory has dumped as RAW/FRAME_BAND_NAME.raw are,
 * to the bit, those of the files of the same run: OUT/frames/BAND/FRAME.exr; where OUT/raw/BAND/FRAME.png is, its
 * counts.
 *
 * Prints how many planes are the same. Exit code 0: all are, and there is one at least. */
#include "sensor/publish/images/image_file.h"

#include <dirent.h>
#include <stdlib.h>
#include <unistd.h>

enum { path_size = 4096, octets_max = 1 << 22 };

static bool same(const char *out, const char *raw, const char *name)
{
    static _Alignas(float) uint8_t dumped[octets_max], written[octets_max];
    char                           path[path_size], frame[8], band[16], channel[16];
    ImageInfo                      info;
    if (sscanf(name, "%6[0-9]_%15[a-z]_%15[A-Z].raw", frame, band, channel) != 3) return false;
    snprintf(path, sizeof path, "%s/%s", raw, name);
    FILE        *file = fopen(path, "rb");
    const size_t size = file ? fread(dumped, 1, sizeof dumped, file) : 0;
    if (file) fclose(file);
    snprintf(path, sizeof path, "%s/raw/%s/%s.png", out, band, frame);
    const bool counts = access(path, R_OK) == 0;
    if (!counts) snprintf(path, sizeof path, "%s/frames/%s/%s.exr", out, band, frame);
    if (image_info(&info, path) != STATUS_OK) return false;
    const size_t pixels = (size_t)info.width * (size_t)info.height, want = pixels * (counts ? 2 : 4);
    if (size != want || want > sizeof written || (counts && (info.channels != 1 || info.bits != 16))) return false;
    const Status status =
        counts ? image_read_png(written, path) : image_read_f32((float *)(void *)written, path, channel);
    return status == STATUS_OK && memcmp(dumped, written, size) == 0;
}

int main(int argc, char **argv)
{
    int            equal = 0, other = 0;
    struct dirent *entry;
    DIR           *folder = argc == 3 ? opendir(argv[2]) : NULL;
    if (!folder) {
        fprintf(stderr, "usage: memory_planes OUT RAW\n");
        return 2;
    }
    while ((entry = readdir(folder))) {
        if (entry->d_name[0] == '.') continue;
        if (same(argv[1], argv[2], entry->d_name)) {
            equal++;
        } else {
            printf("%s differs\n", entry->d_name);
            other++;
        }
    }
    closedir(folder);
    printf("%d planes are the same\n", equal);
    return other > 0 || equal == 0;
}
