/* sensor/verify/regress/record_frame.c: reads the planes of a frame from a run and from a baseline, and writes the
 * latter. */
#include "pitviper_table.h"
#include "sensor/verify/regress/verdict.h"

#include "sensor/publish/images/image_file.h"

#include <stdlib.h>
#include <unistd.h>

enum { path_size = 4096 };

static const PlaneRounding profile_rounding = {7, 0};
static const char *const   bounce_name[frame_bounces] = {"bounce_1", "bounce_2", "bounce_3"};
static const char          compression[] = "zip:9";

RecordPlane record_plane(const char *name)
{
    const PlaneRow *row;
    for (int p = 0; (row = plane_recorded(p)); p++)
        if (strcmp(row->record, name) == 0) return p;
    return record_no_plane;
}

const char *record_plane_name(RecordPlane plane) { return plane_recorded(plane)->record; }
bool        record_plane_is_id(RecordPlane plane) { return plane_recorded(plane)->type != PLANE_F32; }

/* ---- rounding -------------------------------------------------------------------------------- */

enum { steps_nan = 1 << 30, steps_infinity = steps_nan - 1, steps_most = 1 << 29 };

int32_t record_steps(const PlaneRounding *rounding, float value)
{
    const float size = fabsf(value);
    int32_t     steps;
    if (isnan(value)) return steps_nan;
    if (isinf(value)) {
        steps = steps_infinity;
    } else if (rounding->bits) {
        const int dropped = 23 - rounding->bits;
        uint32_t  word;
        memcpy(&word, &size, sizeof word);
        steps = (int32_t)((word + (1u << (dropped - 1))) >> dropped);
    } else {
        const double whole = nearbyint(size / rounding->step);
        steps = whole < steps_most ? (int32_t)whole : steps_infinity;
    }
    return value < 0 ? -steps : steps;
}

float record_value(const PlaneRounding *rounding, int32_t steps)
{
    const int64_t size = steps < 0 ? -(int64_t)steps : steps;
    float         value;
    if (size >= steps_nan) return NAN;
    if (size == steps_infinity) {
        value = INFINITY;
    } else if (rounding->bits) {
        const uint32_t word = (uint32_t)size << (23 - rounding->bits) & 0x7fffffffu;
        memcpy(&value, &word, sizeof value);
    } else {
        value = (float)((double)size * rounding->step);
    }
    return steps < 0 ? -value : value;
}

/* Zigzag coding makes small differences of either sign small numbers; they are repeated in both halves of the word
 * because OpenEXR stores octets 0 and 2 of a word in one run, 1 and 3 in another, each as differences. */
void record_code_plane(uint32_t *coded, const float *value, int width, int height, const PlaneRounding *rounding)
{
    for (int y = 0; y < height; y++) {
        uint32_t left = 0;
        for (int x = 0; x < width; x++) {
            const size_t   i = (size_t)y * (size_t)width + (size_t)x;
            const uint32_t steps = (uint32_t)record_steps(rounding, value[i]), change = steps - left;
            const uint32_t zigzag = change << 1 ^ (change >> 31 ? UINT32_MAX : 0);
            coded[i] = zigzag ^ zigzag << 16;
            left = steps;
        }
    }
}

void record_decode_plane(float *value, const uint32_t *coded, int width, int height, const PlaneRounding *rounding)
{
    for (int y = 0; y < height; y++) {
        uint32_t steps = 0;
        for (int x = 0; x < width; x++) {
            const size_t   i = (size_t)y * (size_t)width + (size_t)x;
            const uint32_t zigzag = coded[i] ^ coded[i] << 16;
            steps += zigzag >> 1 ^ (zigzag & 1 ? UINT32_MAX : 0);
            value[i] = record_value(rounding, (int32_t)steps);
        }
    }
}

static void round_plane(float *value, size_t count, const PlaneRounding *rounding)
{
    for (size_t i = 0; i < count; i++) value[i] = record_value(rounding, record_steps(rounding, value[i]));
}

/* ---- reading --------------------------------------------------------------------------------- */

static bool has_channel(const ImageInfo *info, const char *name)
{
    for (int i = 0; i < info->channels; i++)
        if (strcmp(info->name[i], name) == 0) return true;
    return false;
}

/* The size of a frame is that of its first file. */
static Status take_size(RecordFrame *f, const ImageInfo *info, const char *path)
{
    if (f->width == 0) {
        f->width = info->width;
        f->height = info->height;
    }
    if (info->width == f->width && info->height == f->height && f->width > 0 && f->width <= frame_size_max &&
        f->height > 0 && f->height <= frame_size_max)
        return STATUS_OK;
    log_error("regress: %s: is %d x %d pixels, expected %d x %d", path, info->width, info->height, f->width, f->height);
    return STATUS_BAD_VALUE;
}

/* Reads the names of the material plane, if the file has them. A list too long for any table of materials in use counts
 * as none. */
static Status read_material_names(RecordFrame *f, const char *path)
{
    enum { most = 65536 };
    char  *text = malloc(most);
    Status status = text ? STATUS_OK : STATUS_NO_MEMORY;
    if (text && image_read_string(text, most, path, "material_names") && *text && strlen(text) < most - 1 &&
        !(f->material_names = strdup(text)))
        status = STATUS_NO_MEMORY;
    free(text);
    return status;
}

static Status read_plane(RecordFrame *f, int plane, const char *path, const char *channel)
{
    const size_t count = (size_t)f->width * (size_t)f->height;
    void        *value = malloc(count * sizeof(float));
    if (!value) return STATUS_NO_MEMORY;
    const bool is_id = record_plane_is_id(plane);
    if (is_id) f->id_plane[plane] = value;
    else f->number_plane[plane] = value;
    return is_id ? image_read_u32(value, path, channel) : image_read_f32(value, path, channel);
}

/* A coded plane of a record. */
static Status read_coded(float **out, const char *path, const char *channel, int width, int height,
                         const PlaneRounding *rounding)
{
    const size_t count = (size_t)width * (size_t)height;
    uint32_t    *coded = malloc(count * sizeof *coded);
    float       *value = malloc(count * sizeof *value);
    Status       status = coded && value ? image_read_u32(coded, path, channel) : STATUS_NO_MEMORY;
    if (status == STATUS_OK) record_decode_plane(value, coded, width, height, rounding);
    free(coded);
    *out = value;
    return status;
}

/* bins lines of `middle,bounce_1,bounce_2,bounce_3`. */
static Status read_profile_csv(RecordFrame *f, const char *path)
{
    enum { numbers = 1 + frame_bounces };
    TableColumn column[numbers] = {{"range_m", TABLE_DOUBLE, TABLE_AT_NUMBER(0), .low = -1e9, .high = 1e9}};
    for (int b = 0; b < frame_bounces; b++)
        column[1 + b] =
            (TableColumn){bounce_name[b], TABLE_DOUBLE, TABLE_AT_NUMBER((size_t)b + 1), .low = -1e30, .high = 1e30};
    const TableFormat format = {"regress",       column,
                                numbers,         .next = "replay writes range profiles",
                                .least_rows = 2, .most_rows = frame_bins_max};
    TableRows         lines;
    double           *number = NULL;
    Status            status = table_rows_open(&lines, &format, path);
    if (status != STATUS_OK) return status;
    status = table_rows_numbers(&number, &lines);
    f->bins = lines.table.rows;
    if (status == STATUS_OK) f->near_m = number[0], f->bin_m = number[numbers] - number[0];
    for (int b = 0; b < frame_bounces && status == STATUS_OK; b++) {
        f->profile[b] = malloc((size_t)f->bins * sizeof(float));
        if (!f->profile[b]) status = STATUS_NO_MEMORY;
        for (int i = 0; i < f->bins && status == STATUS_OK; i++)
            f->profile[b][i] = (float)number[(size_t)i * numbers + 1 + (size_t)b];
        if (status == STATUS_OK) round_plane(f->profile[b], (size_t)f->bins, &profile_rounding);
    }
    free(number);
    table_rows_close(&lines);
    return status;
}

Status record_frame_from_run(RecordFrame *out, const char *folder, int number)
{
    RecordFrame     f = {.number = number};
    char            path[path_size];
    ImageInfo       info;
    Status          status = STATUS_OK;
    const char     *opened = "";
    const PlaneRow *row;
    for (int p = 0; (row = plane_recorded(p)) && status == STATUS_OK; p++) {
        snprintf(path, sizeof path, "%s/frames/%s/%06d.exr", folder, row->group, number);
        if (row->kind != PLANE_TRUTH && access(path, F_OK) != 0) continue; /* a band not requested */
        if (strcmp(opened, row->group) != 0) {
            status = image_info(&info, path);
            if (status == STATUS_OK) status = take_size(&f, &info, path);
            opened = row->group;
        }
        if (status != STATUS_OK || !has_channel(&info, row->name)) continue;
        status = read_plane(&f, p, path, row->name);
        if (status == STATUS_OK && f.number_plane[p])
            round_plane(f.number_plane[p], (size_t)f.width * (size_t)f.height, &row->rounding);
        if (p == 0 && !image_read_string(f.date, sizeof f.date, path, "DateTime")) *f.date = 0;
        if (p == 0 && status == STATUS_OK) status = read_material_names(&f, path);
    }
    snprintf(path, sizeof path, "%s/profiles/radar/%06d.csv", folder, number);
    if (status == STATUS_OK && access(path, F_OK) == 0) status = read_profile_csv(&f, path);
    if (status == STATUS_OK) *out = f;
    else record_frame_free(&f);
    return status;
}

static Status read_profile_exr(RecordFrame *f, const char *path, int bins)
{
    ImageInfo info;
    Status    status = image_info(&info, path);
    if (status == STATUS_OK && (info.width != bins || info.height != 1)) {
        log_error("regress: %s: holds %d range bins, expected %d", path, info.width, bins);
        status = STATUS_BAD_VALUE;
    }
    if (status != STATUS_OK) return status;
    f->bins = bins;
    if (!image_read_number(&f->near_m, path, "near_m") || !image_read_number(&f->bin_m, path, "bin_m")) {
        log_error("regress: %s: has no position of its bins (near_m, bin_m)", path);
        return STATUS_BAD_VALUE;
    }
    for (int b = 0; b < frame_bounces && status == STATUS_OK; b++)
        status = read_coded(&f->profile[b], path, bounce_name[b], bins, 1, &profile_rounding);
    return status;
}

Status record_frame_size(RecordFrameSize *out, const char *folder, int number)
{
    char      path[path_size];
    ImageInfo info, profile = {.width = 0};
    snprintf(path, sizeof path, "%s/%06d.exr", folder, number);
    Status status = image_info(&info, path);
    snprintf(path, sizeof path, "%s/%06d.profile.exr", folder, number);
    if (status == STATUS_OK && access(path, F_OK) == 0) status = image_info(&profile, path);
    if (status == STATUS_OK) *out = (RecordFrameSize){info.width, info.height, profile.width};
    return status;
}

Status record_frame_from_record(RecordFrame *out, const char *folder, const RecordFrame *like)
{
    RecordFrame f = {.number = like->number, .width = like->width, .height = like->height};
    char        path[path_size];
    ImageInfo   info;
    snprintf(path, sizeof path, "%s/%06d.exr", folder, like->number);
    Status status = image_info(&info, path);
    if (status == STATUS_OK) status = take_size(&f, &info, path);
    const PlaneRow *row;
    for (int p = 0; (row = plane_recorded(p)) && status == STATUS_OK; p++)
        if (has_channel(&info, row->record))
            status = record_plane_is_id(p)
                         ? read_plane(&f, p, path, row->record)
                         : read_coded(&f.number_plane[p], path, row->record, f.width, f.height, &row->rounding);
    if (status == STATUS_OK && !image_read_string(f.date, sizeof f.date, path, "DateTime")) *f.date = 0;
    if (status == STATUS_OK) status = read_material_names(&f, path);
    snprintf(path, sizeof path, "%s/%06d.profile.exr", folder, like->number);
    if (status == STATUS_OK && like->bins > 0 && access(path, F_OK) == 0)
        status = read_profile_exr(&f, path, like->bins);
    if (status == STATUS_OK) *out = f;
    else record_frame_free(&f);
    return status;
}

/* ---- writing --------------------------------------------------------------------------------- */

Status record_frame_write(const char *folder, const RecordFrame *f)
{
    Plane        plane[planes_most];
    char         path[path_size];
    int          planes = 0, rows = 0;
    const size_t count = (size_t)f->width * (size_t)f->height, bins = (size_t)f->bins;
    const char  *date = *f->date ? f->date : NULL;
    while (plane_recorded(rows)) rows++;
    uint32_t *coded = malloc(((size_t)rows * count + frame_bounces * bins) * sizeof *coded);
    if (!coded) return STATUS_NO_MEMORY;
    for (int p = 0; p < rows; p++) {
        const PlaneRow *row = plane_recorded(p);
        uint32_t       *to = coded + (size_t)p * count;
        if (f->number_plane[p]) record_code_plane(to, f->number_plane[p], f->width, f->height, &row->rounding);
        if (f->number_plane[p]) plane[planes++] = plane_u32(row->record, f->width, f->height, to);
        if (f->id_plane[p]) plane[planes++] = plane_u32(row->record, f->width, f->height, f->id_plane[p]);
    }
    const ImageAttribute number = image_int("frame", f->number);
    const ImageAttribute named[] = {number, image_string("material_names", f->material_names ? f->material_names : "")};
    snprintf(path, sizeof path, "%s/%06d.exr", folder, f->number);
    Status status = image_write_exr_as(path, compression, plane, planes, date, named, f->material_names ? 2 : 1);

    const ImageAttribute attribute[] = {number, image_double("near_m", f->near_m), image_double("bin_m", f->bin_m)};
    for (int b = 0; b < frame_bounces && f->bins > 0; b++) {
        uint32_t *to = coded + (size_t)rows * count + (size_t)b * bins;
        record_code_plane(to, f->profile[b], f->bins, 1, &profile_rounding);
        plane[b] = plane_u32(bounce_name[b], f->bins, 1, to);
    }
    snprintf(path, sizeof path, "%s/%06d.profile.exr", folder, f->number);
    if (status == STATUS_OK && f->bins > 0)
        status = image_write_exr_as(path, compression, plane, frame_bounces, date, attribute, 3);
    free(coded);
    return status;
}

/* ---- ids by name ----------------------------------------------------------------------------- */

/* Number, from 1, of a name of that length in a list separated by commas; 0: not there. *count: names in the list. */
static uint32_t number_of(uint32_t *count, const char *list, const char *name, size_t length)
{
    uint32_t at = 0, found = 0;
    for (const char *next = list; *next;) {
        const size_t n = strcspn(next, ",");
        at++;
        if (!found && n == length && memcmp(next, name, n) == 0) found = at;
        next += n + (next[n] == ',');
    }
    *count = at;
    return found;
}

Status record_frame_rename_materials(RecordFrame *frame, const RecordFrame *like)
{
    uint32_t *id = frame->id_plane[record_plane("material")], count, beyond, most;
    if (!id || !frame->material_names || !like->material_names ||
        strcmp(frame->material_names, like->material_names) == 0)
        return STATUS_OK;
    number_of(&count, frame->material_names, "", 0);
    uint32_t *map = calloc((size_t)count + 1, sizeof *map), k = 1;
    if (!map) return STATUS_NO_MEMORY;
    number_of(&beyond, like->material_names, "", 0);
    most = beyond + count;
    for (const char *next = frame->material_names; *next; k++) {
        const size_t n = strcspn(next, ",");
        uint32_t     ignored;
        map[k] = number_of(&ignored, like->material_names, next, n);
        if (map[k] == 0) map[k] = ++beyond;
        next += n + (next[n] == ',');
    }
    for (size_t i = 0; i < (size_t)frame->width * (size_t)frame->height; i++)
        id[i] = id[i] <= count ? map[id[i]] : most + id[i];
    free(map);
    return STATUS_OK;
}

void record_frame_free(RecordFrame *frame)
{
    free(frame->material_names);
    for (int p = 0; p < planes_most; p++) {
        free(frame->number_plane[p]);
        free(frame->id_plane[p]);
    }
    for (int b = 0; b < frame_bounces; b++) free(frame->profile[b]);
    *frame = (RecordFrame){0};
}
