/* sensor/score/coco_truth.c: images and annotations of coco.json, read piece by piece. */
#include "sensor/score/coco_truth.h"
#include "sensor/frame/clutter_record.h"
#include "sensor/score/json_member.h"

#include <stdlib.h>

static const char not_ours[] = "give the coco.json that the run wrote (publish.coco)";

static Status wrong(const JsonStream *s, const char *what)
{
    log_error("score: %s:%ld: %s; %s", s->path, s->line, what, not_ours);
    return STATUS_BAD_VALUE;
}

/* Room for one more of a list. */
static void *one_more(void *list, size_t count, size_t *room, size_t size)
{
    if (count < *room) return list;
    const size_t more = *room ? 2 * *room : 256;
    void        *grown = realloc(list, more * size);
    if (grown) *room = more;
    return grown;
}

/* ---- images --------------------------------------------------------------------------------------- */

static Status find_variant(int *out, CocoImages *images, const char *name)
{
    for (int i = images->names - 1; i >= 0; i--) /* images of a variant follow each other */
        if (strcmp(images->name[i], name) == 0) return *out = i, STATUS_OK;
    size_t room = (size_t)images->names_room;
    void  *grown = one_more(images->name, (size_t)images->names, &room, sizeof *images->name);
    if (!grown) return STATUS_NO_MEMORY;
    images->name = grown;
    images->names_room = (int)room;
    snprintf(images->name[images->names], sizeof *images->name, "%s", name);
    *out = images->names++;
    return STATUS_OK;
}

static Status add_image(CocoImages *images, const json_t *from, const JsonStream *s)
{
    enum { variants_most = 1000000 };
    long long   id, frame;
    int         variant = -1;
    const int   band = json_member_band(from, "band");
    const char *name = json_string_value(json_object_get(from, "variant"));
    if (!json_member_whole(&id, from, "id", 0, 1LL << 52) || !json_member_whole(&frame, from, "frame", 0, INT32_MAX) ||
        band < 0)
        return wrong(s, "an image without a whole `id` and `frame` and a `band` of this program");
    if (name && (strlen(name) >= sizeof *images->name || images->names == variants_most))
        return wrong(s, "an image with a `variant` that no sweep has");
    Status status = name ? find_variant(&variant, images, name) : STATUS_OK;
    void  *grown = one_more(images->image, images->count, &images->room, sizeof *images->image);
    if (!grown || status != STATUS_OK) return STATUS_NO_MEMORY;
    images->image = grown;
    images->image[images->count++] = (CocoImage){id, (int)frame, variant, (uint8_t)band};
    return STATUS_OK;
}

static int by_id(const void *a, const void *b)
{
    const CocoImage *x = a, *y = b;
    return (x->id > y->id) - (x->id < y->id);
}

const CocoImage *coco_image(const CocoImages *images, long long id)
{
    const CocoImage wanted = {.id = id};
    return images->count ? bsearch(&wanted, images->image, images->count, sizeof wanted, by_id) : NULL;
}

/* ---- annotations ---------------------------------------------------------------------------------- */

static Status add_target(CocoTruth *coco, const json_t *from, const JsonStream *s)
{
    CocoTarget t = {0};
    long long  category;
    if (json_member_whole(&category, from, "category_id", coco_clutter_category, coco_clutter_category))
        return STATUS_OK; /* no target */
    if (!json_member_whole(&t.id, from, "id", 0, 1LL << 52) ||
        !json_member_whole(&t.image, from, "image_id", 0, 1LL << 52) ||
        !json_member_whole(&category, from, "category_id", 1, 255) || !json_member_numbers(t.box, 4, from, "bbox") ||
        !(t.box[2] >= 0 && t.box[3] >= 0) || !json_member_entity(&t.entity, from))
        return wrong(s, "an annotation without `id`, `image_id`, `category_id`, `bbox` and `entity`");
    t.class_number = (uint8_t)category;
    const json_t *crowd = json_object_get(from, "iscrowd");
    t.ignored = json_integer_value(crowd) != 0;
    void *grown = one_more(coco->target, coco->count, &coco->room, sizeof *coco->target);
    if (!grown) return STATUS_NO_MEMORY;
    coco->target = grown;
    coco->target[coco->count++] = t;
    return STATUS_OK;
}

static int by_frame(const void *a, const void *b)
{
    const CocoTarget *x = a, *y = b;
    if (x->frame != y->frame) return x->frame < y->frame ? -1 : 1;
    if (x->band != y->band) return x->band < y->band ? -1 : 1;
    return (x->id > y->id) - (x->id < y->id);
}

const CocoTarget *coco_targets_of(size_t *count, const CocoTruth *coco, int frame, Band band)
{
    size_t low = 0, high = coco->count, end;
    while (low < high) {
        const size_t      middle = (low + high) / 2;
        const CocoTarget *t = &coco->target[middle];
        if (t->frame < frame || (t->frame == frame && t->band < band)) low = middle + 1;
        else high = middle;
    }
    for (end = low; end < coco->count && coco->target[end].frame == frame && coco->target[end].band == band;) end++;
    *count = end - low;
    return coco->target ? coco->target + low : NULL;
}

/* ---- the file ------------------------------------------------------------------------------------- */

static Status add_items(CocoTruth *coco, JsonLists *lists, bool images)
{
    bool        more = true;
    JsonStream *s = lists->stream;
    for (;;) {
        Status status = json_lists_item(&more, lists);
        if (status != STATUS_OK || !more) return status;
        json_t *item;
        status = json_member_load(&item, s->text, s->length);
        if (status == STATUS_NO_MEMORY) return status;
        if (!json_is_object(item)) status = wrong(s, "an item that is no JSON object");
        else status = images ? add_image(&coco->images, item, s) : add_target(coco, item, s);
        json_decref(item);
        if (status != STATUS_OK) return status;
    }
}

/* Finds the image of each annotation. */
static Status join(CocoTruth *coco, const JsonStream *s)
{
    CocoImages *images = &coco->images;
    if (images->count) qsort(images->image, images->count, sizeof *images->image, by_id);
    for (size_t i = 1; i < images->count; i++)
        if (images->image[i].id == images->image[i - 1].id) return wrong(s, "two images of one id");
    for (size_t i = 0; i < coco->count; i++) {
        const CocoImage *image = coco_image(images, coco->target[i].image);
        if (!image) return wrong(s, "an annotation of an image that is not in the list");
        coco->target[i].frame = image->frame;
        coco->target[i].band = image->band;
    }
    if (coco->count) qsort(coco->target, coco->count, sizeof *coco->target, by_frame);
    return STATUS_OK;
}

Status coco_truth_read_stream(CocoTruth *out, JsonStream *stream, bool targets)
{
    JsonLists lists = {.stream = stream};
    CocoTruth coco = {0};
    bool      more = true;
    Status    status = STATUS_OK;
    while (status == STATUS_OK && more) {
        status = json_lists_next(&more, &lists);
        if (status != STATUS_OK || !more) break;
        if (strcmp(lists.key, "images") == 0) status = add_items(&coco, &lists, true);
        else if (targets && strcmp(lists.key, "annotations") == 0) status = add_items(&coco, &lists, false);
    }
    if (status == STATUS_OK) status = join(&coco, stream);
    if (status == STATUS_OK) *out = coco;
    else coco_truth_free(&coco);
    return status;
}

Status coco_truth_read(CocoTruth *out, const char *path, bool targets)
{
    JsonStream stream;
    Status     status = json_stream_open(&stream, path, 64 << 20);
    if (status == STATUS_OK) status = coco_truth_read_stream(out, &stream, targets);
    json_stream_close(&stream);
    return status;
}

void coco_truth_free(CocoTruth *coco)
{
    free(coco->images.image);
    free(coco->images.name);
    free(coco->target);
    *coco = (CocoTruth){0};
}
