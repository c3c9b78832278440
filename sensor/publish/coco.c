/* sensor/publish/coco.c: a run's coco.json, from the same records as truth.jsonl and the truth plane. */
#include "sensor/publish/coco.h"

#include "sensor/publish/json_write.h"
#include "sensor/publish/coco_file.h"
#include "sensor/publish/coco_mask.h"
#include "sensor/publish/target_class.h"

#include <stdlib.h>

struct Coco {
    CocoFile    file;
    bool        begun;      /* the file is open */
    char        folder[coco_path_size];
    const char *ending;
    CocoLimits  limits;
    char        config_sha256[80];
    long long   seed;
    int         extents;    /* capacity in masks and in text; both grow to what a frame needs */
    MaskExtent *extent;
    size_t      text_size;
    char       *text;
};

Status coco_open(Coco **out, const char *folder, const char *ending, CocoLimits limits, const char *config_sha256,
                 long long seed)
{
    Coco *c = calloc(1, sizeof *c);
    if (!c) return STATUS_NO_MEMORY;
    c->ending = ending;
    c->limits = limits;
    c->seed   = seed;
    snprintf(c->config_sha256, sizeof c->config_sha256, "%s", config_sha256);
    snprintf(c->folder, sizeof c->folder, "%s", folder);
    *out = c;
    return STATUS_OK;
}

Status coco_begin(Coco *c)
{
    const Status status = coco_file_open(&c->file, c->folder);
    c->begun            = status == STATUS_OK;
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
static const char *ignored_as(const CocoLimits *limits, const MaskExtent *mask, const TargetRecord *t, Band band)
{
    if (mask->pixels == 0) return "no_mask";
    if (mask->pixels < limits->min_pixels) return "small";
    if (limits->min_visible > 0 && !(t->visible_fraction >= limits->min_visible)) return "hidden";
    return fabs(t->band[band].snr) < limits->min_snr ? "faint" : NULL;
}

static bool is_visible(const TargetRecord *t, const MaskExtent *mask)
{
    return mask->pixels > 0 || !box_is_empty(t->box);
}

/* The box of an ignore region: all pixels that show a part of it, among them those of the mask. */
static MaskExtent region_of(const TargetRecord *t, const MaskExtent *mask)
{
    MaskExtent region = *mask;
    const bool masked = mask->pixels > 0, boxed = !box_is_empty(t->box);
    for (int k = 0; k < 4 && boxed; k++) {
        const bool outer = k < 2 ? t->box[k] < region.box[k] : t->box[k] > region.box[k];
        if (!masked || outer) region.box[k] = t->box[k];
    }
    region.pixels = (long long)(region.box[2] - region.box[0]) * (region.box[3] - region.box[1]);
    return region;
}

static void set_text(json_t *object, const char *key, const char *text)
{
    if (text) json_object_set_new(object, key, json_string(text));
}

/* Of the target in the image's band. */
static void set_signal(json_t *out, const TargetRecord *t, Band band)
{
    const TargetBand *signal = &t->band[band];
    set_number(out, "snr", signal->snr);
    set_number(out, "contrast", isfinite(signal->contrast_k) ? signal->contrast_k : signal->contrast);
    set_number(out, "contrast_k", signal->contrast_k);
}

static json_t *annotation_json(const Coco *c, const FrameRecord *r, const TargetRecord *t, const MaskExtent *extent,
                               const char *why, long long image, Band band)
{
    const double *all = t->amodal_box;
    int           box[4];
    char          name[dis_id_text_size], type[dis_type_text_size], occluder[dis_id_text_size];
    box_coco(box, extent->box);
    dis_entity_id_text(name, t->id);
    dis_entity_type_text(type, t->type);
    json_t *out = json_pack("{s:I,s:I,s:i,s:[i,i,i,i],s:I,s:i,s:i,s:s,s:i,s:s,s:s,s:f,s:{s:[i,i],s:s}}", "id",
                            (json_int_t)c->file.annotations + 1, "image_id", (json_int_t)image, "category_id",
                            t->class_number, "bbox", box[0], box[1], box[2], box[3], "area",
                            (json_int_t)extent->pixels, "iscrowd", why != NULL, "ignore", why != NULL, "entity", name,
                            "plane_value", t->plane_value, "type", type, "model", t->model, "pixels", t->pixels,
                            "segmentation", "size", r->request->view.height, r->request->view.width, "counts", c->text);
    if (!out) return NULL;
    set_text(out, "ignored_as", why);
    json_object_set_new(out, "bbox_amodal", json_pack("[f,f,f,f]", all[0], all[1], all[2] - all[0], all[3] - all[1]));
    set_number(out, "range_m", t->range_m);
    set_number(out, "aspect_deg", t->aspect_rad / rad_per_deg);
    set_number(out, "visible_fraction", t->visible_fraction);
    set_number(out, "foliage_fraction", t->foliage_fraction);
    set_text(out, "occluded_by", target_occluder_text(occluder, t));
    set_signal(out, t, band);
    return out;
}

/* Memory for the masks of a frame, which is reused for the next one. */
static Status measure(Coco *c, const FrameRecord *r, const uint32_t *entity)
{
    const int count = r->snapshot->count, width = r->request->view.width, height = r->request->view.height;
    if (count > c->extents) {
        MaskExtent *extent = realloc(c->extent, (size_t)count * sizeof *extent);
        if (!extent) return STATUS_NO_MEMORY;
        c->extent  = extent;
        c->extents = count;
    }
    mask_extents(c->extent, count, entity, width, height);
    size_t most = 0;
    for (int i = 0; i < r->target_count; i++) {
        const MaskExtent region = region_of(&r->target[i], &c->extent[r->target[i].index]);
        const size_t     size   = mask_text_size(&region);
        if (size > most) most = size;
    }
    if (most <= c->text_size) return STATUS_OK;
    char *text = realloc(c->text, most);
    if (!text) return STATUS_NO_MEMORY;
    c->text      = text;
    c->text_size = most;
    return STATUS_OK;
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
            const TargetRecord *t    = &r->target[i];
            const MaskExtent   *mask = &c->extent[t->index];
            if (!is_visible(t, mask)) continue;
            const char      *why    = ignored_as(&c->limits, mask, t, (Band)b);
            const MaskExtent extent = why ? region_of(t, mask) : *mask;
            if (why) mask_box_text(c->text, width, height, &extent);
            else mask_text(c->text, entity, (uint32_t)t->plane_value, width, height, &extent);
            status = coco_file_annotation(&c->file, annotation_json(c, r, t, &extent, why, image, (Band)b));
        }
    }
    return status;
}

Status coco_close(Coco *c)
{
    if (!c) return STATUS_OK;
    json_t *info = json_pack("{s:s,s:s,s:s,s:I,s:i,s:f,s:f}", "description", "pitviper replay", "version", PITVIPER_VERSION,
                             "config_sha256", c->config_sha256, "seed", (json_int_t)c->seed, "min_pixels",
                             c->limits.min_pixels, "min_visible", c->limits.min_visible, "min_snr", c->limits.min_snr);
    const Status status = c->begun ? coco_file_close(&c->file, info, true) : STATUS_OK;
    if (!c->begun) json_decref(info);
    free(c->extent);
    free(c->text);
    free(c);
    return status;
}
