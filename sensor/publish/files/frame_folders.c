/* sensor/publish/files/frame_folders.c: the folders of OUT: created, searched for the products of an earlier run, and
 * cleared of them. */
#include "sensor/publish/files/frame_files.h"

#include "pitviper_channels.h"
#include "pitviper_output.h"

#include <errno.h>
#include <stdio.h>
#include <strings.h>
#include <sys/stat.h>

enum { path_size = frame_path_size };

static bool too_long(const char *out) { return strlen(out) + frame_path_room >= path_size; }

Status frame_files_folder(const char *path)
{
    if (!*path) {
        log_error("out: the folder for the products has no name; choose one with --out");
        return STATUS_BAD_VALUE;
    }
    if (too_long(path)) {
        log_error("out: the folder's name has %zu characters, %d are possible; choose another place with --out",
                  strlen(path), path_size - frame_path_room - 1);
        return STATUS_BAD_VALUE;
    }
    if (output_folder(path) == 0) return STATUS_OK;
    log_error("out: cannot write in %s: %s; choose another place with --out", path, output_reason(errno));
    return STATUS_IO;
}

/* NNNNNN.exr, .png, .csv: the files of frame_files_write, and those of consume_radar, and nothing else. */
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

/* The name of a band of any run: another may have had a channel that is not among this one's. */
static bool is_band(const char *name, size_t length)
{
    static const char *const others[] = {"optical", "radar"};
    for (int i = 0; i < 2; i++)
        if (strlen(others[i]) == length && memcmp(name, others[i], length) == 0) return true;
    return channel_named(name, length) != NULL;
}

static bool is_of_band(const char *name, const char *const *ending, int endings)
{
    const size_t stem = strcspn(name, ".");
    bool         ends = false;
    for (int i = 0; i < endings; i++) ends |= strcasecmp(name + stem, ending[i]) == 0;
    return ends && is_band(name, stem);
}

static bool is_latest(const char *name) { return is_of_band(name, (const char *const[]){".png", ".png.part"}, 2); }
static bool is_klv(const char *name) { return is_of_band(name, (const char *const[]){".klv"}, 1); }
static bool is_video(const char *name) { return is_of_band(name, (const char *const[]){".ts", ".mp4", ".mkv"}, 3); }
static bool is_below(const char *name) { return strcmp(name, "truth") == 0 || is_band(name, strlen(name)); }

/* Calls found for each name in a folder for which ours(name) holds, until it returns false. */
static void each_in(const char *folder, bool (*ours)(const char *name), bool (*found)(void *user, const char *path),
                    void       *user)
{
    DIR *directory = output_list(folder);
    char path[path_size + 300];
    for (struct dirent *entry; directory && (entry = readdir(directory));) {
        if (!ours(entry->d_name)) continue;
        if (snprintf(path, sizeof path, "%s/%s", folder, entry->d_name) >= (int)sizeof path) continue;
        if (!found(user, path)) break;
    }
    if (directory) closedir(directory);
}

static bool remove_it(void *user, const char *path)
{
    (void)user;
    output_remove(path);
    return true;
}

static bool remove_frames(void *user, const char *folder)
{
    each_in(folder, is_frame_name, remove_it, user);
    output_remove(folder); /* only if it is empty otherwise */
    return true;
}

/* Folder of band b; BAND_COUNT: truth; BAND_COUNT + 1: range profiles; raw_folder + b: raw counts. */
enum { raw_folder = BAND_COUNT + 2, folder_count = raw_folder + BAND_COUNT };

static void product_folder(char path[path_size], const char *out, int b)
{
    if (b >= raw_folder) {
        snprintf(path, path_size, "%s/raw/%s", out, band_name((Band)(b - raw_folder)));
        return;
    }
    snprintf(path, path_size, "%s/%s%s", out, b <= BAND_COUNT ? "frames/" : "profiles/",
             b < BAND_COUNT    ? band_name((Band)b)
             : b == BAND_COUNT ? "truth"
                               : "radar");
}

/* Folders that have a folder for each band; the last is that of consume_radar, with files. */
static const char *const parents[] = {"frames", "profiles", "raw"}, radar_folder[] = "radar";

const char *const pair_folder[pair_folders] = {"pairs/clean", "pairs/background", "pairs/background_clean"};

static void clear_products(const char *out)
{
    char path[path_size];
    snprintf(path, sizeof path, "%s/latest", out);
    each_in(path, is_latest, remove_it, NULL);
    output_remove(path); /* a folder: only if it is empty otherwise */
    for (int i = 0; i < 3; i++) {
        snprintf(path, sizeof path, "%s/%s", out, parents[i]);
        each_in(path, is_below, remove_frames, NULL);
        output_remove(path);
    }
    snprintf(path, sizeof path, "%s/%s", out, radar_folder);
    remove_frames(NULL, path);
}

static bool first_file(void *found, const char *path) { return snprintf(found, path_size, "%s", path) >= path_size; }

/* The first image or table of a frame in a folder: found is empty before. */
static bool first_frame(void *found, const char *folder)
{
    each_in(folder, is_frame_name, first_file, found);
    return !*(const char *)found;
}

static bool is_there(const char *path, struct stat *about) { return lstat(path, about) == 0; }

bool frame_files_earlier(char found[frame_path_size], const char *out)
{
    char        path[path_size], truth[path_size];
    struct stat about;
    if (too_long(out)) return false; /* no run was ever started there */
    snprintf(truth, sizeof truth, "%s/truth.jsonl", out);
    const bool begun = is_there(truth, &about); /* a run without a line did not reach its first frame */
    if (begun && about.st_size > 0) return snprintf(found, frame_path_size, "%s", truth) > 0;
    snprintf(path, sizeof path, "%s/run.json", out);
    if (!begun && is_there(path, &about)) return snprintf(found, frame_path_size, "%s", path) > 0;
    *found = 0;
    for (int i = 0; i < 3 && !*found; i++) {
        snprintf(path, sizeof path, "%s/%s", out, parents[i]);
        each_in(path, is_below, first_frame, found);
    }
    snprintf(path, sizeof path, "%s/%s", out, radar_folder);
    return *found || !first_frame(found, path);
}

/* A run leaves truth.jsonl from its first moment on, and run.json at its end. */
static const char *const marks[] = {"run.json", "truth.jsonl"};

void frame_files_clear(const char *out)
{
    static const char *const beside[] = {"pairs",      "pairs.jsonl", "coco.json",  "answers.jsonl",
                                         "score.json", "score.html",  "flight.csv", "flight.pcapng"};
    char                     path[path_size];
    bool                     earlier = !too_long(out) && frame_files_earlier(path, out);
    if (too_long(out)) return;
    for (int i = 0; i < 2; i++) {
        snprintf(path, sizeof path, "%s/%s", out, marks[i]);
        earlier = output_remove(path) == 0 || earlier;
    }
    if (!earlier) return;
    clear_products(out);
    each_in(out, is_frame_file, remove_it, NULL);
    each_in(out, is_klv, remove_it, NULL);
    for (int i = 0; i < pair_folders; i++) {
        snprintf(path, sizeof path, "%s/%s", out, pair_folder[i]);
        clear_products(path);
        output_remove(path);
    }
    for (size_t i = 0; i < sizeof beside / sizeof *beside; i++) {
        snprintf(path, sizeof path, "%s/%s", out, beside[i]);
        output_remove(path);
    }
}

void frame_files_clear_videos(const char *folder) { each_in(folder, is_video, remove_it, NULL); }

/* Logged: what is there cannot be written. */
static bool blocked(const char *out, const char *name, unsigned how)
{
    char path[path_size + 64];
    snprintf(path, sizeof path, "%s/%s", out, name);
    if (output_check(path, how) == 0) return false;
    log_error("out: cannot write %s: %s; choose another place with --out", path, output_reason(errno));
    return true;
}

Status frame_files_check(const char *out)
{
    static const char *const        files[] = {"run.json",      "truth.jsonl", "coco.json",    "pairs.jsonl",
                                               "answers.jsonl", "flight.csv",  "flight.pcapng"},
                             *const folders[] = {"frames", "profiles", "raw", "radar", "latest", "pairs"};
    bool                            bad = too_long(out);
    char                            path[path_size], name[64];
    for (size_t i = 0; i < sizeof files / sizeof *files && !bad; i++) bad = blocked(out, files[i], 0);
    for (size_t i = 0; i < sizeof folders / sizeof *folders && !bad; i++) bad = blocked(out, folders[i], OUTPUT_FOLDER);
    for (int b = 0; b < folder_count && !bad; b++) {
        product_folder(path, out, b);
        bad = blocked(out, path + strlen(out) + 1, OUTPUT_FOLDER);
    }
    for (int i = 0; i < pair_folders && !bad; i++) {
        bad = blocked(out, pair_folder[i], OUTPUT_FOLDER);
        for (int b = 0; b < folder_count && !bad; b++) {
            product_folder(path, pair_folder[i], b);
            bad = blocked(out, path, OUTPUT_FOLDER);
        }
    }
    for (int b = 0; b < BAND_COUNT && !bad; b++) {
        snprintf(name, sizeof name, "%s.klv", band_name((Band)b));
        bad = blocked(out, name, 0);
    }
    return bad ? STATUS_IO : STATUS_OK;
}

Status frame_files_prepare(const char *out, unsigned bands, unsigned raw)
{
    char   path[path_size];
    Status status = frame_files_folder(out);
    if (status == STATUS_OK) frame_files_clear(out);
    for (int b = 0; b < folder_count && status == STATUS_OK; b++) {
        if (bands == 0) break;
        if (b >= raw_folder ? !(raw >> (b - raw_folder) & 1) : !(bands >> (b <= BAND_COUNT ? b : BAND_RADAR) & 1))
            continue;
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
        if (b >= raw_folder ? !(raw >> (b - raw_folder) & 1) : b >= BAND_COUNT || !(bands & detector_bands & 1u << b))
            continue;
        product_folder(path, out, b);
        status = frame_files_folder(path);
    }
    return status;
}
