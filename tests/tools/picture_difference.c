/* picture_difference A B [A B ...]: how the pictures of two runs of `pitviper replay --out` differ, plane by plane.
 *
 * Where more than two are given, each pair begins with a line `pair A B`: to load the image library takes longer than
 * to compare small pictures. A line a plane, over all frames that both have, so that a script can ask for any column by
 * name:
 *
 *     plane lwir.Y frames 8 pixels 49152 changed 120 slight 50 clear 31 largest 0.81 relative 0.019 edge_px 1
 *
 * changed   pixels that are not the same bits (NaN is NaN)
 * clear     pixels that a person would notice: another id; 0.05 m of range, or hit against none; 0.1 K; 0.01 of a
 *           normal; 1 % of a radiance; of radar 5 %, beside 1e-3 of the frame's brightest
 * slight    pixels that differ by more than a tenth of that
 * largest   largest difference, in the plane's unit; none of ids
 * relative  largest difference over the larger of the two values; none of ids
 * edge_px   how far a changed pixel is from an edge of A at most: a place whose entity, part or material is not that of
 *           its four neighbours; 1 is at the edge
 *
 * Exit code 0: compared. 2: nothing to compare, or frames that one of them lacks. */
#include "sensor/publish/images/image_file.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>

enum { names_max = 4096, name_size = 32, path_size = 4096 };

static const char *const bands[] = {"truth", "optical", "mwir", "lwir", "radar"};
enum { band_count = sizeof bands / sizeof *bands };

typedef struct Tally {
    char   name[96];
    int    frames;
    long   pixels, changed, slight, clear;
    double largest, relative;
    int    edge_px;
    bool   ids;
} Tally;

static int by_name(const void *a, const void *b) { return strcmp(a, b); }

/* The EXR files of a band in order; -1: no such folder. */
static int list(char name[names_max][name_size], const char *out, const char *band)
{
    char           path[path_size];
    int            count = 0;
    struct dirent *entry;
    snprintf(path, sizeof path, "%s/frames/%s", out, band);
    DIR *folder = opendir(path);
    if (!folder) return -1;
    while ((entry = readdir(folder)) && count < names_max) {
        const size_t length = strlen(entry->d_name);
        if (length > 4 && length < name_size && strcmp(entry->d_name + length - 4, ".exr") == 0)
            strcpy(name[count++], entry->d_name);
    }
    closedir(folder);
    qsort(name, (size_t)count, name_size, by_name);
    return count;
}

/* ---- edges ------------------------------------------------------------------------------------- */

static void mark_edges(bool *edge, const uint32_t *id, int w, int h)
{
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++) {
            const uint32_t here = id[y * w + x];
            if (x + 1 < w && id[y * w + x + 1] != here) edge[y * w + x] = edge[y * w + x + 1] = true;
            if (y + 1 < h && id[(y + 1) * w + x] != here) edge[y * w + x] = edge[(y + 1) * w + x] = true;
        }
}

/* Rings round the pixel until one holds an edge; 1: it is one itself. */
static int edge_distance(const bool *edge, int w, int h, int x, int y)
{
    for (int r = 0; r < w + h; r++)
        for (int b = y - r; b <= y + r; b++)
            for (int a = x - r; a <= x + r; a += b == y - r || b == y + r || r == 0 ? 1 : 2 * r)
                if (a >= 0 && a < w && b >= 0 && b < h && edge[b * w + a]) return r + 1;
    return w + h;
}

static bool read_edges(bool *edge, const char *out, const char *frame, int w, int h, uint32_t *id)
{
    static const char *const channel[] = {"entity", "part", "material"};
    char                     path[path_size];
    snprintf(path, sizeof path, "%s/frames/truth/%s", out, frame);
    memset(edge, 0, (size_t)w * (size_t)h);
    for (int c = 0; c < 3; c++) {
        if (image_read_u32(id, path, channel[c]) != STATUS_OK) return false;
        mark_edges(edge, id, w, h);
    }
    return true;
}

/* ---- one plane of one frame ---------------------------------------------------------------------- */

static double noticed(double a, double b, const char *name, double brightest)
{
    const double difference = fabs(a - b), larger = fmax(fabs(a), fabs(b));
    if (strcmp(name, "truth.range_m") == 0) return difference / 0.05;
    if (strcmp(name, "truth.temp_k") == 0) return difference / 0.1;
    if (strncmp(name, "truth.n", 7) == 0) return difference / 0.01;
    if (strcmp(name, "radar.Y") == 0) return difference / (0.05 * larger + 1e-3 * brightest);
    return difference / (0.01 * larger);
}

static void compare_plane(Tally *t, const void *left, const void *right, const bool *edge, int w, int h)
{
    const float    *a = left, *b = right;
    const uint32_t *i = left, *j = right;
    double          brightest = 0;
    for (int k = 0; k < w * h && !t->ids; k++)
        if (isfinite(a[k])) brightest = fmax(brightest, fabs((double)a[k]));
    t->frames++;
    t->pixels += w * h;
    for (int k = 0; k < w * h; k++) {
        if (i[k] == j[k] || (!t->ids && isnan(a[k]) && isnan(b[k]))) continue;
        t->changed++;
        const int away = edge_distance(edge, w, h, k % w, k / w);
        if (away > t->edge_px) t->edge_px = away;
        if (t->ids || !isfinite(a[k]) || !isfinite(b[k])) {
            t->clear++, t->slight++;
            if (!t->ids) t->largest = INFINITY, t->relative = INFINITY;
            continue;
        }
        const double difference = fabs((double)a[k] - b[k]), larger = fmax(fabs((double)a[k]), fabs((double)b[k]));
        t->largest = fmax(t->largest, difference);
        t->relative = fmax(t->relative, larger > 0 ? difference / larger : 0);
        const double seen = noticed(a[k], b[k], t->name, brightest);
        t->slight += seen > 0.1;
        t->clear += seen > 1;
    }
}

/* ---- all of them ----------------------------------------------------------------------------------- */

typedef struct Room {
    void     *a, *b;
    uint32_t *id;
    bool     *edge;
} Room;

static bool has_channel(const ImageInfo *info, const char *channel)
{
    for (int c = 0; c < info->channels; c++)
        if (strcmp(info->name[c], channel) == 0) return true;
    return false;
}

/* Whether all channels of a are in b, but for those that a run has for each of its thermal bands. */
static bool shares_channels(const ImageInfo *a, const ImageInfo *b)
{
    for (int c = 0; c < a->channels; c++)
        if (!has_channel(b, a->name[c]) && strncmp(a->name[c], "emissivity_", 11) != 0) return false;
    return true;
}

static bool compare_file(Tally *tally, int *tallies, const char *const out[2], const char *band, const char *frame)
{
    char      path[2][path_size];
    ImageInfo info[2];
    for (int s = 0; s < 2; s++) {
        snprintf(path[s], sizeof path[s], "%s/frames/%s/%s", out[s], band, frame);
        if (image_info(&info[s], path[s]) != STATUS_OK) return false;
    }
    const int    w = info[0].width, h = info[0].height;
    const size_t count = (size_t)w * (size_t)h;
    if (info[1].width != w || info[1].height != h || !shares_channels(&info[0], &info[1]) ||
        !shares_channels(&info[1], &info[0])) {
        log_error("picture_difference: %s and %s differ in size or channels", path[0], path[1]);
        return false;
    }
    Room room = {malloc(count * 4), malloc(count * 4), malloc(count * 4), malloc(count)};
    bool good = room.a && room.b && room.id && room.edge && read_edges(room.edge, out[0], frame, w, h, room.id);
    for (int c = 0; c < info[0].channels && good; c++) {
        char        name[96];
        const char *channel = info[0].name[c];
        const bool  ids = info[0].type[c] == PLANE_U32;
        int         t = 0;
        if (!has_channel(&info[1], channel)) continue;
        snprintf(name, sizeof name, "%s.%s", band, channel);
        while (t < *tallies && strcmp(tally[t].name, name) != 0) t++;
        if (t == *tallies) {
            tally[(*tallies)++] = (Tally){.ids = ids};
            strcpy(tally[t].name, name);
        }
        for (int s = 0; s < 2 && good; s++)
            good = (ids ? image_read_u32(s ? room.b : room.a, path[s], channel)
                        : image_read_f32(s ? room.b : room.a, path[s], channel)) == STATUS_OK;
        if (good) compare_plane(&tally[t], room.a, room.b, room.edge, w, h);
    }
    free(room.a), free(room.b), free(room.id), free(room.edge);
    return good;
}

static bool compare_runs(const char *const out[2])
{
    static char  name[2][names_max][name_size];
    static Tally tally[256];
    int          tallies = 0, frames = 0;
    for (int b = 0; b < band_count; b++) {
        const int a_count = list(name[0], out[0], bands[b]), b_count = list(name[1], out[1], bands[b]);
        if (a_count < 0 || b_count < 0) continue; /* a band that one of them left out */
        if (a_count != b_count || memcmp(name[0], name[1], (size_t)a_count * name_size) != 0) {
            log_error("picture_difference: %s and %s have other frames of %s", out[0], out[1], bands[b]);
            return false;
        }
        for (int i = 0; i < a_count; i++, frames++)
            if (!compare_file(tally, &tallies, out, bands[b], name[0][i])) return false;
    }
    if (frames == 0) {
        log_error("picture_difference: %s and %s share no frames", out[0], out[1]);
        return false;
    }
    for (int t = 0; t < tallies; t++)
        printf("plane %s frames %d pixels %ld changed %ld slight %ld clear %ld largest %g relative %g edge_px %d\n",
               tally[t].name, tally[t].frames, tally[t].pixels, tally[t].changed, tally[t].slight, tally[t].clear,
               tally[t].largest, tally[t].relative, tally[t].edge_px);
    return true;
}

int main(int argc, char **argv)
{
    if (argc < 3 || argc % 2 == 0) {
        fputs("usage: picture_difference A B [A B ...]\n", stderr);
        return 2;
    }
    for (int i = 1; i < argc; i += 2) {
        const char *const out[2] = {argv[i], argv[i + 1]};
        if (argc > 3) printf("pair %s %s\n", out[0], out[1]);
        if (!compare_runs(out)) return 2;
    }
    return 0;
}
