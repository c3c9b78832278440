/* sensor/publish/coco_merge.c: joins the coco.json of a sweep's variants, with new ids. */
#include "sensor/publish/coco_merge.h"
#include "pitviper_output.h"

#include "sensor/publish/coco_file.h"
#include "sensor/publish/json_read.h"

#include <stdlib.h>
#include <unistd.h>

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
        const char *file  = json_string_value(json_object_get(image, "file_name"));
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
        const NewId *image  = bsearch(&wanted, id, ids, sizeof *id, by_was);
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
    char         path[2 * coco_path_size];
    Status       status = STATUS_OK;
    snprintf(path, sizeof path, "%s/%s/coco.json", m->folder, name);
    if (!m->open) status = coco_file_open(&m->file, m->folder);
    if (status != STATUS_OK) return status;
    m->open = true;
    json_t      *whole = json_read_file(path), *images = json_object_get(whole, "images");
    const size_t count = json_array_size(images);
    NewId       *id    = calloc(count + 1, sizeof *id);
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
