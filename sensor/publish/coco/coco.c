/* sensor/publish/coco/coco.c: coco.json of a run, from the same records as truth.jsonl and the truth plane; masks as
 * run lengths. */
#include "sensor/publish/coco/coco.h"
#include "sensor/frame/json_object.h"
#include "sensor/publish/coco/coco_file.h"
#include "sensor/frame/record_fields.h"
#include "sensor/frame/target_record.h"

#include <stdlib.h>

/* ---- masks: the pixels of each entity in the truth plane, and their run lengths as text ---------- */

void coco_mask_extents(CocoMaskExtent *extent, int count, const uint32_t *plane, int width, int height)
{
    memset(extent, 0, (size_t)count * sizeof *extent);
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            const uint32_t value = plane[(size_t)y * (size_t)width + (size_t)x];
            if (value == 0 || value > (uint32_t)count) continue;
            CocoMaskExtent *e = &extent[value - 1];
            int            *box = e->box;
            if (e->pixels++ == 0) box[0] = x, box[1] = y; /* rows come in order */
            if (x < box[0]) box[0] = x;
            if (x + 1 > box[2]) box[2] = x + 1;
            box[3] = y + 1;
        }
}

size_t coco_mask_text_size(const CocoMaskExtent *extent)
{
    /* a run begins and ends at most once in two rows of a column; one more run lies on either side of the box */
    const size_t columns = (size_t)(extent->box[2] - extent->box[0]), rows = (size_t)(extent->box[3] - extent->box[1]);
    return coco_mask_run_characters * (columns * (rows + 1) + 2) + 1;
}

typedef struct RunText {
    char     *at;
    long long before[2]; /* the run before, and the one before that */
    int       count;
} RunText;

static void put_run(RunText *t, long long run)
{
    long long rest = t->count > 2 ? run - t->before[1] : run;
    bool      more = true;
    while (more) {
        const int group = (int)(rest & 31);
        rest >>= 5; /* of negative numbers too: gcc and clang shift arithmetically */
        more = group & 16 ? rest != -1 : rest != 0;
        *t->at++ = (char)(48 + (group | (more ? 32 : 0)));
    }
    t->before[1] = t->before[0];
    t->before[0] = run;
    t->count++;
}

void coco_mask_text(char *text, const uint32_t *plane, uint32_t value, int width, int height,
                    const CocoMaskExtent *extent)
{
    RunText   t = {.at = text};
    long long end = 0; /* of the last run */
    bool      on = false;
    for (int x = extent->box[0]; x < extent->box[2]; x++) {
        /* a column begins at row 0 where the previous column ended within the mask, and ends at the row after the box
         * or at the last row of the image */
        const int first = on ? 0 : extent->box[1], behind = extent->box[3] < height ? extent->box[3] + 1 : height;
        for (int y = first; y < behind; y++) {
            if ((plane[(size_t)y * (size_t)width + (size_t)x] == value) == on) continue;
            const long long at = (long long)x * height + y;
            put_run(&t, at - end);
            end = at;
            on = !on;
        }
    }
    const long long rest = (long long)width * height - end;
    if (on && extent->box[2] < width) { /* its last column ends with the last row of the image */
        put_run(&t, (long long)extent->box[2] * height - end);
        end = (long long)extent->box[2] * height;
        if ((long long)width * height > end) put_run(&t, (long long)width * height - end);
    } else if (rest > 0) {
        put_run(&t, rest);
    }
    *t.at = 0;
}

void coco_mask_box_text(char *text, int width, int height, const CocoMaskExtent *extent)
{
    const int *box = extent->box, columns = box[2] - box[0], rows = box[3] - box[1];
    const bool whole = rows == height; /* its columns follow each other without a gap */
    RunText    t = {.at = text};
    long long  end = (long long)box[0] * height + box[1];
    put_run(&t, end);
    for (int x = 0; x < (whole ? 1 : columns); x++) {
        const long long run = whole ? (long long)columns * height : rows;
        if (x > 0) put_run(&t, height - rows);
        put_run(&t, run);
        end += run + (x > 0 ? height - rows : 0);
    }
    if ((long long)width * height > end) put_run(&t, (long long)width * height - end);
    *t.at = 0;
}

/* ---- the file ------------------------------------------------------------------------------------ */

struct Coco {
    CocoFile        file;
    bool            begun; /* the file is open */
    char            folder[coco_path_size];
    const char     *ending;
    CocoLimits      limits;
    char            config_sha256[80];
    long long       seed;
    int             extents; /* capacity in masks and in text; both grow to what a frame needs */
    CocoMaskExtent *extent;
    size_t          text_size;
    char           *text;
};

Status coco_open(Coco **out, const char *folder, const char *ending, CocoLimits limits, const char *config_sha256,
                 long long seed)
{
    Coco *c = calloc(1, sizeof *c);
    if (!c) return STATUS_NO_MEMORY;
    c->ending = ending;
    c->limits = limits;
    c->seed = seed;
    snprintf(c->config_sha256, sizeof c->config_sha256, "%s", config_sha256);
    snprintf(c->folder, sizeof c->folder, "%s", folder);
    *out = c;
    return STATUS_OK;
}

Status coco_begin(Coco *c)
{
    const Status status = coco_file_open(&c->file, c->folder);
    c->begun = status == STATUS_OK;
    return status;
}

/* ---- one frame -------------------------------------------------------------------------------- */

static json_t *image_json(const Coco *c, const FrameRecord *r, Band band, long long id)
{
    char name[64];
    snprintf(name, sizeof name, "frames/%s/%06d.%s", band_name(band), r->frame, c->ending);
    return json_pack("{s:I,s:i,s:i,s:s,s:s,s:i,s:f}", "id", (json_int_t)id, "width", r->request->view.width, "height",
                     r->request->view.height, "file_name", name, "band", band_name(band), "frame", r->frame, "time_s",
                     r->time_s);
}

/* Why a target need not be found; NULL: it is to be found. */
static const char *ignored_as(const CocoLimits *limits, const CocoMaskExtent *mask, const TargetRecord *t, Band band)
{
    if (mask->pixels == 0) return "no_mask";
    if (mask->pixels < limits->min_pixels) return "small";
    if (limits->min_visible > 0 && !(t->visible_fraction >= limits->min_visible)) return "hidden";
    return fabs(t->band[band].snr) < limits->min_snr ? "faint" : NULL;
}

static bool is_visible(const TargetRecord *t, const CocoMaskExtent *mask)
{
    return mask->pixels > 0 || !target_box_is_empty(t->box);
}

/* The box of an ignore region: it holds all pixels that show a part of the region, and so those of the mask. */
static CocoMaskExtent region_of(const TargetRecord *t, const CocoMaskExtent *mask)
{
    CocoMaskExtent region = *mask;
    const bool     masked = mask->pixels > 0, boxed = !target_box_is_empty(t->box);
    for (int k = 0; k < 4 && boxed; k++) {
        const bool outer = k < 2 ? t->box[k] < region.box[k] : t->box[k] > region.box[k];
        if (!masked || outer) region.box[k] = t->box[k];
    }
    region.pixels = (long long)(region.box[2] - region.box[0]) * (region.box[3] - region.box[1]);
    return region;
}

/* Sets the signal of the target in the image's band. */
static void set_signal(json_t *out, const TargetRecord *t, Band band)
{
    const TargetBand *signal = &t->band[band];
    json_set_number(out, "snr", signal->snr);
    json_set_number(out, "contrast", isfinite(signal->contrast_k) ? signal->contrast_k : signal->contrast);
    json_set_number(out, "contrast_k", signal->contrast_k);
}

static json_t *annotation_json(const Coco *c, const FrameRecord *r, const TargetRecord *t, const CocoMaskExtent *extent,
                               const char *why, long long image, Band band)
{
    const double *all = t->amodal_box;
    int           box[4];
    char          name[dis_id_text_size], type[dis_type_text_size];
    target_box_coco(box, extent->box);
    dis_entity_id_text(name, t->id);
    dis_entity_type_text(type, t->type);
    json_t *out = json_pack("{s:I,s:I,s:i,s:[i,i,i,i],s:I,s:i,s:i,s:s,s:i,s:s,s:s,s:f,s:{s:[i,i],s:s}}", "id",
                            (json_int_t)c->file.annotations + 1, "image_id", (json_int_t)image, "category_id",
                            t->class_number, "bbox", box[0], box[1], box[2], box[3], "area", (json_int_t)extent->pixels,
                            "iscrowd", why != NULL, "ignore", why != NULL, "entity", name, "plane_value",
                            t->plane_value, "type", type, "model", t->model, "pixels", t->pixels, "segmentation",
                            "size", r->request->view.height, r->request->view.width, "counts", c->text);
    if (!out) return NULL;
    if (why) json_object_set_new(out, "ignored_as", json_string(why));
    json_object_set_new(out, "bbox_amodal", json_pack("[f,f,f,f]", all[0], all[1], all[2] - all[0], all[3] - all[1]));
    static const char *const as_in_truth[] = {"range_m", "aspect_deg", "visible_fraction", "foliage_fraction",
                                              "occluded_by"};
    for (size_t i = 0; i < sizeof as_in_truth / sizeof *as_in_truth; i++)
        field_carry(out, &target_fields, as_in_truth[i], t);
    set_signal(out, t, band);
    return out;
}

/* Memory for the masks of a frame, which is reused for the next one. */
static Status make_room(Coco *c, int count, size_t octets)
{
    if (count > c->extents) {
        CocoMaskExtent *extent = realloc(c->extent, (size_t)count * sizeof *extent);
        if (!extent) return STATUS_NO_MEMORY;
        c->extent = extent;
        c->extents = count;
    }
    if (octets <= c->text_size) return STATUS_OK;
    char *text = realloc(c->text, octets);
    if (!text) return STATUS_NO_MEMORY;
    c->text = text;
    c->text_size = octets;
    return STATUS_OK;
}

static Status measure(Coco *c, const FrameRecord *r, const uint32_t *entity)
{
    const int    count = r->snapshot->count, width = r->request->view.width, height = r->request->view.height;
    const Status status = make_room(c, count, 0);
    if (status != STATUS_OK) return status;
    coco_mask_extents(c->extent, count, entity, width, height);
    size_t most = 0;
    for (int i = 0; i < r->target_count; i++) {
        const CocoMaskExtent region = region_of(&r->target[i], &c->extent[r->target[i].index]);
        const size_t         size = coco_mask_text_size(&region);
        if (size > most) most = size;
    }
    return make_room(c, 0, most);
}

Status coco_frame(Coco *c, const FrameRecord *r, const uint32_t *entity)
{
    const int width = r->request->view.width, height = r->request->view.height;
    Status    status = measure(c, r, entity);
    for (int b = 0; b < BAND_COUNT && status == STATUS_OK; b++) {
        if (!(r->request->bands >> b & 1)) continue;
        const long long image = (long long)r->frame * BAND_COUNT + b + 1;
        status = coco_file_image(&c->file, image_json(c, r, (Band)b, image));
        for (int i = 0; i < r->target_count && status == STATUS_OK; i++) {
            const TargetRecord   *t = &r->target[i];
            const CocoMaskExtent *mask = &c->extent[t->index];
            if (!is_visible(t, mask)) continue;
            const char          *why = ignored_as(&c->limits, mask, t, (Band)b);
            const CocoMaskExtent extent = why ? region_of(t, mask) : *mask;
            if (why) coco_mask_box_text(c->text, width, height, &extent);
            else coco_mask_text(c->text, entity, (uint32_t)t->plane_value, width, height, &extent);
            status = coco_file_annotation(&c->file, annotation_json(c, r, t, &extent, why, image, (Band)b));
        }
    }
    return status;
}

static json_t *clutter_json(const Coco *c, const FrameRecord *r, const ClutterRecord *of, const CocoMaskExtent *mask,
                            long long image)
{
    int box[4];
    target_box_coco(box, mask->box);
    json_t *out = json_pack(
        "{s:I,s:I,s:i,s:[i,i,i,i],s:I,s:i,s:i,s:s,s:s,s:{s:[i,i],s:s}}", "id", (json_int_t)c->file.annotations + 1,
        "image_id", (json_int_t)image, "category_id", coco_clutter_category, "bbox", box[0], box[1], box[2], box[3],
        "area", (json_int_t)mask->pixels, "iscrowd", 0, "ignore", 0, "class", of->class_name, "clutter", of->id,
        "segmentation", "size", r->request->view.height, r->request->view.width, "counts", c->text);
    static const char *const as_in_truth[] = {"pixels", "range_m"};
    for (size_t i = 0; out && i < sizeof as_in_truth / sizeof *as_in_truth; i++)
        field_carry(out, &clutter_fields, as_in_truth[i], of);
    return out;
}

Status coco_clutter(Coco *c, const FrameRecord *r, const uint32_t *plane)
{
    const int width = r->request->view.width, height = r->request->view.height;
    Status    status = r->clutter_count > 0 ? make_room(c, r->clutter_count, 0) : STATUS_OK;
    if (r->clutter_count == 0 || status != STATUS_OK) return status;
    coco_mask_extents(c->extent, r->clutter_count, plane, width, height);
    for (int i = 0; i < r->clutter_count && status == STATUS_OK; i++) {
        const CocoMaskExtent *mask = &c->extent[i];
        if (mask->pixels == 0) continue; /* it fills no pixel by more than half */
        status = make_room(c, 0, coco_mask_text_size(mask));
        if (status != STATUS_OK) break;
        coco_mask_text(c->text, plane, (uint32_t)i + 1, width, height, mask);
        for (int b = 0; b < BAND_COUNT && status == STATUS_OK; b++)
            if (r->request->bands >> b & 1)
                status = coco_file_annotation(
                    &c->file, clutter_json(c, r, &r->clutter[i], mask, (long long)r->frame * BAND_COUNT + b + 1));
    }
    return status;
}

Status coco_close(Coco *c)
{
    if (!c) return STATUS_OK;
    json_t *info =
        json_pack("{s:s,s:s,s:s,s:I,s:i,s:f,s:f}", "description", "pitviper replay", "version", PITVIPER_VERSION,
                  "config_sha256", c->config_sha256, "seed", (json_int_t)c->seed, "min_pixels", c->limits.min_pixels,
                  "min_visible", c->limits.min_visible, "min_snr", c->limits.min_snr);
    const Status status = c->begun ? coco_file_close(&c->file, info, true) : STATUS_OK;
    if (!c->begun) json_decref(info);
    free(c->extent);
    free(c->text);
    free(c);
    return status;
}
