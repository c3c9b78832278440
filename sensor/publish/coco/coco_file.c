/* sensor/publish/coco/coco_file.c: coco.json while it is written, by a run or from those of a sweep's variants. */
#include "sensor/publish/coco/coco_file.h"
#include "pitviper_output.h"
#include "sensor/frame/clutter_record.h"
#include "sensor/frame/target_record.h"
#include "sensor/frame/json_object.h"

#include <errno.h>
#include <stdlib.h>
#include <unistd.h>

static Status fail(CocoFile *c)
{
    if (!c->failed) log_error("coco: cannot write %s: %s", c->path, output_reason(errno));
    c->failed = true;
    return STATUS_IO;
}

static void drop(CocoFile *c)
{
    if (c->waiting) output_remove(c->waiting_path);
    if (c->waiting) fclose(c->waiting);
    if (c->file) output_abandon(c->file, c->path);
    c->file = c->waiting = NULL;
}

Status coco_file_open(CocoFile *c, const char *folder)
{
    *c = (CocoFile){0};
    snprintf(c->path, sizeof c->path, "%s/coco.json", folder);
    snprintf(c->waiting_path, sizeof c->waiting_path, "%s/coco.json.annotations.part", folder);
    c->file = output_begin(c->path, 0);
    c->waiting = c->file ? output_file(c->waiting_path, OUTPUT_READ) : NULL;
    if (c->file && c->waiting) {
        fputs("{\"images\":[", c->file);
        return STATUS_OK;
    }
    fail(c);
    drop(c);
    return STATUS_IO;
}

static Status put(CocoFile *c, FILE *file, json_t *object, long long place)
{
    char      *text = object && !c->failed ? json_dumps(object, JSON_COMPACT | JSON_REAL_PRECISION(15)) : NULL;
    const bool ok = text && fprintf(file, "%s%s", place == 0 ? "\n" : ",\n", text) > 0;
    free(text);
    json_decref(object);
    return ok ? STATUS_OK : fail(c);
}

Status coco_file_image(CocoFile *c, json_t *image) { return put(c, c->file, image, c->images++); }
Status coco_file_annotation(CocoFile *c, json_t *annotation)
{
    c->clutter |= json_integer_value(json_object_get(annotation, "category_id")) == coco_clutter_category;
    return put(c, c->waiting, annotation, c->annotations++);
}

static void join(CocoFile *c, const json_t *info)
{
    char   block[65536];
    size_t n;
    fputs("],\n\"annotations\":[", c->file);
    rewind(c->waiting);
    while ((n = fread(block, 1, sizeof block, c->waiting)) > 0) fwrite(block, 1, n, c->file);
    fputs("],\n\"categories\":[", c->file);
    for (int k = 1; k <= target_class_count(); k++)
        put(c, c->file,
            json_pack("{s:i,s:s,s:s}", "id", k, "name", target_class_name(k), "supercategory", target_class_group(k)),
            k - 1);
    if (c->clutter)
        put(c, c->file,
            json_pack("{s:i,s:s,s:s}", "id", coco_clutter_category, "name", "clutter", "supercategory", "clutter"), 1);
    fputs("],\n\"licenses\":[],\n\"info\":", c->file);
    json_dumpf(info, c->file, JSON_COMPACT);
    fputs("}\n", c->file);
}

Status coco_file_close(CocoFile *c, json_t *info, bool whole)
{
    if (!c->failed && whole) {
        errno = 0;
        join(c, info);
        if (ferror(c->file) || ferror(c->waiting)) fail(c);
        if (!c->failed) {
            if (!output_end(c->file, c->path)) fail(c);
            c->file = NULL;
        }
    }
    json_decref(info);
    drop(c);
    return c->failed ? STATUS_IO : STATUS_OK;
}

/* ---- one coco.json of those of the variants of a sweep, with new ids ----------------------------- */

struct CocoMerge {
    char     folder[coco_path_size];
    bool     open;
    CocoFile file;
    int      variants;
};

Status coco_merge_open(CocoMerge **out, const char *folder)
{
    CocoMerge *m = calloc(1, sizeof *m);
    if (!m) return STATUS_NO_MEMORY;
    snprintf(m->folder, sizeof m->folder, "%s", folder);
    *out = m;
    return STATUS_OK;
}

/* An image's id in its own file, and in this one. */
typedef struct NewId {
    json_int_t was, is;
} NewId;

static int by_was(const void *a, const void *b)
{
    const NewId *x = a, *y = b;
    return (x->was > y->was) - (x->was < y->was);
}

static Status refuse(const char *path)
{
    log_error("coco: %s: not as this program writes it; delete its folder, and the sweep makes it again", path);
    return STATUS_BAD_VALUE;
}

static Status add_images(CocoMerge *m, NewId *id, json_t *images, const char *name, const char *path)
{
    char file_name[coco_path_size];
    for (size_t i = 0; i < json_array_size(images); i++) {
        json_t     *image = json_array_get(images, i);
        const char *file = json_string_value(json_object_get(image, "file_name"));
        if (!file || !json_is_integer(json_object_get(image, "id"))) return refuse(path);
        id[i] = (NewId){json_integer_value(json_object_get(image, "id")), m->file.images + 1};
        snprintf(file_name, sizeof file_name, "%s/%s", name, file);
        json_object_set_new(image, "id", json_integer(id[i].is));
        json_object_set_new(image, "file_name", json_string(file_name));
        json_object_set_new(image, "variant", json_string(name));
        const Status status = coco_file_image(&m->file, json_incref(image));
        if (status != STATUS_OK) return status;
    }
    return STATUS_OK;
}

static Status add_annotations(CocoMerge *m, const NewId *id, size_t ids, json_t *annotations, const char *path)
{
    for (size_t i = 0; i < json_array_size(annotations); i++) {
        json_t      *annotation = json_array_get(annotations, i);
        const NewId  wanted = {.was = json_integer_value(json_object_get(annotation, "image_id"))};
        const NewId *image = bsearch(&wanted, id, ids, sizeof *id, by_was);
        if (!image) return refuse(path);
        json_object_set_new(annotation, "id", json_integer(m->file.annotations + 1));
        json_object_set_new(annotation, "image_id", json_integer(image->is));
        const Status status = coco_file_annotation(&m->file, json_incref(annotation));
        if (status != STATUS_OK) return status;
    }
    return STATUS_OK;
}

Status coco_merge_add(CocoMerge *m, const char *name)
{
    char   path[2 * coco_path_size];
    Status status = STATUS_OK;
    snprintf(path, sizeof path, "%s/%s/coco.json", m->folder, name);
    if (!m->open) status = coco_file_open(&m->file, m->folder);
    if (status != STATUS_OK) return status;
    m->open = true;
    json_t      *whole = json_read_file(path), *images = json_object_get(whole, "images");
    const size_t count = json_array_size(images);
    NewId       *id = calloc(count + 1, sizeof *id);
    if (!json_is_array(images)) status = refuse(path);
    else if (!id) status = STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = add_images(m, id, images, name, path);
    if (status == STATUS_OK) {
        qsort(id, count, sizeof *id, by_was);
        status = add_annotations(m, id, count, json_object_get(whole, "annotations"), path);
    }
    m->variants += status == STATUS_OK;
    free(id);
    json_decref(whole);
    return status;
}

Status coco_merge_close(CocoMerge *m, bool whole)
{
    Status status = STATUS_OK;
    if (!m) return status;
    if (m->open)
        status = coco_file_close(&m->file,
                                 json_pack("{s:s,s:s,s:i}", "description", "pitviper replay --sweep", "version",
                                           PITVIPER_VERSION, "variants", m->variants),
                                 whole);
    char path[coco_path_size + 16];
    snprintf(path, sizeof path, "%s/truth.jsonl", m->folder); /* next to it: coco.json is that run's own */
    if ((!m->open || !whole || status != STATUS_OK) && access(path, F_OK) != 0) {
        snprintf(path, sizeof path, "%s/coco.json", m->folder);
        output_remove(path);
    }
    free(m);
    return status;
}
