/* sensor/publish/frame_folders.c: the folders of OUT: created, searched for the products of an earlier run, and
 * cleared of them. */
#include "sensor/publish/frame_files.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

enum { path_size = frame_path_size };

static bool too_long(const char *out) { return strlen(out) + frame_path_room >= path_size; }

Status frame_files_folder(const char *path)
{
    char part[path_size];
    if (!*path) {
        log_error("out: the folder for the products has no name; choose one with --out");
        return STATUS_BAD_VALUE;
    }
    if (too_long(path)) {
        log_error("out: the folder's name has %zu characters, %d are possible; choose another place with --out",
                  strlen(path), path_size - frame_path_room - 1);
        return STATUS_BAD_VALUE;
    }
    strcpy(part, path);
    for (char *at = part + 1;; at++) {
        if (*at != '/' && *at) continue;
        const char kept = *at;
        *at             = 0;
        if (mkdir(part, 0777) != 0 && errno != EEXIST) {
            log_error("out: cannot make the folder %s: %s; choose another place with --out", part, strerror(errno));
            return STATUS_IO;
        }
        *at = kept;
        if (!kept) break;
    }
    struct stat there;
    if (stat(path, &there) == 0 && !S_ISDIR(there.st_mode)) errno = ENOTDIR;
    else errno = 0;
    if (errno || access(path, W_OK | X_OK) != 0) {
        log_error("out: cannot write in %s: %s; choose another place with --out", path, strerror(errno));
        return STATUS_IO;
    }
    return STATUS_OK;
}

/* NNNNNN.exr, .png, .csv: the files of frame_files_write, and those of radar_scan_files, and nothing else. */
static bool is_frame_name(const char *name)
{
    static const char *const scan[] = {"_scan", "_dbs", "_view", "_view_scan", "_view_dbs"};
    for (int i = 0; i < 6; i++)
        if (name[i] < '0' || name[i] > '9') return false;
    const size_t stem = strcspn(name + 6, ".");
    bool         known = stem == 0;
    for (size_t i = 0; i < sizeof scan / sizeof *scan; i++)
        known |= strlen(scan[i]) == stem && strncmp(name + 6, scan[i], stem) == 0;
    const char *ending = name + 6 + stem;
    return known && (strcmp(ending, ".exr") == 0 || strcmp(ending, ".png") == 0 || strcmp(ending, ".csv") == 0);
}

/* frame_NNNNNN.pvf: the files of frame_save. */
static bool is_frame_file(const char *name)
{
    int end = 0;
    return strlen(name) == strlen("frame_NNNNNN.pvf") && strspn(name + 6, "0123456789") == 6 &&
           sscanf(name, "frame_%*6d.pvf%n", &end) == 0 && end > 0;
}

/* Removes the files for which ours(name) holds. */
static void clear_folder(const char *folder, bool (*ours)(const char *name))
{
    DIR *directory = opendir(folder);
    if (!directory) return;
    char path[path_size + 300];
    for (struct dirent *entry; (entry = readdir(directory));)
        if (ours(entry->d_name)) {
            snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
            unlink(path);
        }
    closedir(directory);
}

/* Folder of band b; BAND_COUNT: truth; BAND_COUNT + 1: range profiles; raw_folder + b: raw counts; radar_folder:
 * consume_radar's. */
enum { raw_folder = BAND_COUNT + 2, radar_folder = raw_folder + BAND_COUNT, folder_count };

static void product_folder(char path[path_size], const char *out, int b)
{
    if (b == radar_folder) {
        snprintf(path, path_size, "%s/radar", out);
        return;
    }
    if (b >= raw_folder) {
        snprintf(path, path_size, "%s/raw/%s", out, band_name((Band)(b - raw_folder)));
        return;
    }
    snprintf(path, path_size, "%s/%s%s", out, b <= BAND_COUNT ? "frames/" : "profiles/",
             b < BAND_COUNT ? band_name((Band)b) : b == BAND_COUNT ? "truth" : "radar");
}

const char *const pair_folder[pair_folders] = {"pairs/clean", "pairs/background", "pairs/background_clean"};

/* BAND.png and BAND.part.png of consume_latest. */
static bool is_latest(const char *name)
{
    const size_t stem = strcspn(name, ".");
    bool         band = false;
    for (int b = 0; b < BAND_COUNT; b++)
        band |= strlen(band_name((Band)b)) == stem && strncmp(name, band_name((Band)b), stem) == 0;
    return band && (strcmp(name + stem, ".png") == 0 || strcmp(name + stem, ".part.png") == 0);
}

static void clear_products(const char *out)
{
    static const char *const parents[] = {"frames", "profiles", "raw"};
    char path[path_size];
    snprintf(path, sizeof path, "%s/latest", out);
    clear_folder(path, is_latest);
    rmdir(path);
    for (int b = 0; b < folder_count; b++) {
        product_folder(path, out, b);
        clear_folder(path, is_frame_name);
        rmdir(path); /* only if it is empty otherwise */
    }
    for (int i = 0; i < 3; i++) {
        snprintf(path, sizeof path, "%s/%s", out, parents[i]);
        rmdir(path);
    }
}

/* The first image or table of a frame in a folder. */
static bool first_frame(char path[path_size], const char *folder)
{
    DIR *directory = opendir(folder);
    bool found = false;
    for (struct dirent *entry; directory && !found && (entry = readdir(directory));)
        if (is_frame_name(entry->d_name)) found = snprintf(path, path_size, "%s/%s", folder, entry->d_name) < path_size;
    if (directory) closedir(directory);
    return found;
}

bool frame_files_earlier(char found[frame_path_size], const char *out)
{
    char        path[path_size], truth[path_size];
    struct stat about;
    if (too_long(out)) return false; /* no run was ever started there */
    snprintf(truth, sizeof truth, "%s/truth.jsonl", out);
    const bool begun = stat(truth, &about) == 0; /* a run without a line did not reach its first frame */
    if (begun && about.st_size > 0) return snprintf(found, frame_path_size, "%s", truth) > 0;
    snprintf(path, sizeof path, "%s/run.json", out);
    if (!begun && access(path, F_OK) == 0) return snprintf(found, frame_path_size, "%s", path) > 0;
    for (int b = 0; b < folder_count; b++) {
        product_folder(path, out, b);
        if (first_frame(found, path)) return true;
    }
    return false;
}

void frame_files_clear(const char *out)
{
    /* a run leaves truth.jsonl from its first moment, run.json at its end */
    static const char *const marks[] = {"run.json", "truth.jsonl"}, *const beside[] = {
        "pairs", "pairs.jsonl", "coco.json", "answers.jsonl", "optical.klv", "mwir.klv", "lwir.klv", "radar.klv"};
    char path[path_size];
    bool earlier = false;
    if (too_long(out)) return;
    for (int i = 0; i < 2; i++) {
        snprintf(path, sizeof path, "%s/%s", out, marks[i]);
        earlier = unlink(path) == 0 || earlier;
    }
    if (!earlier) return;
    clear_products(out);
    clear_folder(out, is_frame_file);
    for (int i = 0; i < pair_folders; i++) {
        snprintf(path, sizeof path, "%s/%s", out, pair_folder[i]);
        clear_products(path);
        rmdir(path);
    }
    for (size_t i = 0; i < sizeof beside / sizeof *beside; i++) {
        snprintf(path, sizeof path, "%s/%s", out, beside[i]);
        remove(path); /* a folder: only if it is empty otherwise */
    }
}

Status frame_files_prepare(const char *out, unsigned bands, unsigned raw)
{
    char   path[path_size];
    Status status = frame_files_folder(out);
    if (status == STATUS_OK) frame_files_clear(out);
    for (int b = 0; b < folder_count && status == STATUS_OK; b++) {
        if (bands == 0) break;
        if (b >= raw_folder ? !(raw >> (b - raw_folder) & 1) :
            !(bands >> (b <= BAND_COUNT ? b : BAND_RADAR) & 1)) continue;
        product_folder(path, out, b);
        status = frame_files_folder(path);
    }
    return status;
}

Status frame_files_prepare_displays(const char *out, unsigned bands, unsigned raw)
{
    char   path[path_size];
    Status status = frame_files_folder(out);
    for (int b = 0; b < folder_count && status == STATUS_OK; b++) {
        if (b >= raw_folder ? !(raw >> (b - raw_folder) & 1) : b >= BAND_COUNT || !(bands & detector_bands & 1u << b)) continue;
        product_folder(path, out, b);
        status = frame_files_folder(path);
    }
    return status;
}
