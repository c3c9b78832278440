#include "sensor/publish/coco.h"

#include <errno.h>
#include <jansson.h>
#include <stdlib.h>
#include <unistd.h>

enum { path_size = 4200 };

/* Images go straight into the file; annotations wait in another, which is read back at the end. */
struct Coco {
    char           path[path_size], part[path_size], waiting_path[path_size];
    FILE          *file, *waiting;
    const char    *ending;
    char           config_sha256[80];
    long long      seed;
    const Catalog *catalog;
    long long      images, annotations;
    bool           failed;
};

static Status fail(Coco *c)
{
    if (!c->failed) log_error("coco: cannot write %s: %s", c->path, strerror(errno));
    c->failed = true;
    return STATUS_IO;
}

Status coco_open(Coco **out, const char *folder, const char *ending, const char *config_sha256, long long seed)
{
    Coco *c = calloc(1, sizeof *c);
    if (!c) return STATUS_NO_MEMORY;
    c->ending = ending;
    c->seed   = seed;
    snprintf(c->config_sha256, sizeof c->config_sha256, "%s", config_sha256);
    snprintf(c->path, sizeof c->path, "%s/coco.json", folder);
    snprintf(c->part, sizeof c->part, "%s/coco.json.part", folder);
    snprintf(c->waiting_path, sizeof c->waiting_path, "%s/coco.json.annotations.part", folder);
    c->file    = fopen(c->part, "w");
    c->waiting = fopen(c->waiting_path, "w+");
    if (!c->file || !c->waiting) {
        fail(c);
        coco_close(c);
        return STATUS_IO;
    }
    fputs("{\"images\":[", c->file);
    *out = c;
    return STATUS_OK;
}

/* ---- one frame -------------------------------------------------------------------------------- */

/* open: without its closing brace, for more to be written behind it. */
static bool put(FILE *file, json_t *object, bool first, bool open)
{
    char      *text = object ? json_dumps(object, JSON_COMPACT | JSON_REAL_PRECISION(15)) : NULL;
    const bool ok = text && fprintf(file, "%s%.*s", first ? "\n" : ",\n", (int)strlen(text) - open, text) > 0;
    free(text);
    json_decref(object);
    return ok;
}

static void set_number(json_t *object, const char *key, double value)
{
    if (isfinite(value)) json_object_set_new(object, key, json_real(value));
}

/* COCO's order: down the columns, beginning with how many are not the target. */
static void put_runs(FILE *file, const uint32_t *entity, int width, int height, const Target *t)
{
    const uint32_t id  = (uint32_t)t->index + 1;
    long long      end = 0; /* of the last run of the target's pixels */
    bool           on = false, any = false;
    fprintf(file, ",\"segmentation\":{\"size\":[%d,%d],\"counts\":[", height, width);
    for (int x = t->box[0]; x < t->box[2]; x++)
        for (int y = t->box[1]; y <= t->box[3]; y++) { /* one beyond: a run ends where the box does, or the picture goes on */
            const long long at   = (long long)x * height + y;
            const bool      here = y < t->box[3] && entity[(size_t)y * (size_t)width + (size_t)x] == id;
            if (here == on) continue;
            if (on && y == height && x + 1 < t->box[2] && t->box[1] == 0 && entity[x + 1] == id) break; /* goes on */
            fprintf(file, "%s%lld", any ? "," : "", at - end);
            end = at;
            on  = here;
            any = true;
        }
    const long long rest = (long long)width * height - end; /* 0: the target has the last pixel */
    if (rest > 0) fprintf(file, "%s%lld", any ? "," : "", rest);
    fputs("]}}", file);
}

static json_t *annotation_json(const FrameRecord *r, const Target *t, long long image, long long id)
{
    const SnapshotEntity *entity = &r->snapshot->entity[t->index];
    char                  name[dis_id_text_size], type[dis_type_text_size];
    dis_entity_id_text(name, entity->id);
    dis_entity_type_text(type, entity->type);
    const int category = catalog_class(r->catalog, entity->model) + 1;
    json_t   *out = json_pack("{s:I,s:I,s:i,s:[i,i,i,i],s:f,s:i,s:s,s:s}", "id", (json_int_t)id, "image_id",
                              (json_int_t)image, "category_id", category, "bbox", t->box[0], t->box[1],
                              t->box[2] - t->box[0], t->box[3] - t->box[1], "area", t->pixels, "iscrowd", 0, "entity",
                              name, "type", type);
    if (!out) return NULL;
    set_number(out, "range_m", t->range_m);
    set_number(out, "aspect_deg", t->aspect_rad / rad_per_deg);
    set_number(out, "visible_fraction", t->visible_fraction);
    return out;
}

Status coco_frame(Coco *c, const FrameRecord *r, const uint32_t *entity)
{
    const int width = r->request->view.width, height = r->request->view.height;
    if (c->failed) return STATUS_IO;
    c->catalog = r->catalog;
    for (int b = 0; b < BAND_COUNT; b++) {
        if (!(r->request->bands >> b & 1)) continue;
        const long long image = (long long)r->frame * BAND_COUNT + b + 1;
        const char     *band = band_name((Band)b);
        char            name[64];
        snprintf(name, sizeof name, "frames/%s/%06d.%s", band, r->frame, c->ending);
        if (!put(c->file, json_pack("{s:I,s:i,s:i,s:s,s:s,s:i,s:f}", "id", (json_int_t)image, "width", width, "height",
                                    height, "file_name", name, "band", band, "frame", r->frame, "time_s", r->time_s),
                 c->images++ == 0, false))
            return fail(c);
        for (int i = 0; i < r->target_count; i++) {
            const Target *t = &r->target[i];
            if (t->box[2] == 0) continue;
            c->annotations++;
            if (!put(c->waiting, annotation_json(r, t, image, c->annotations), c->annotations == 1, true))
                return fail(c);
            put_runs(c->waiting, entity, width, height, t);
        }
    }
    return ferror(c->file) || ferror(c->waiting) ? fail(c) : STATUS_OK;
}

/* ---- the end ---------------------------------------------------------------------------------- */

static void join(Coco *c)
{
    char   block[65536];
    size_t n;
    fputs("],\n\"annotations\":[", c->file);
    rewind(c->waiting);
    while ((n = fread(block, 1, sizeof block, c->waiting)) > 0) fwrite(block, 1, n, c->file);
    fputs("],\n\"categories\":[", c->file);
    for (int m = 0; c->catalog && m < catalog_model_count(c->catalog); m++)
        if (catalog_class(c->catalog, m) == m) /* one for all sizes of a shape */
            put(c->file, json_pack("{s:i,s:s,s:s}", "id", m + 1, "name", catalog_model(c->catalog, m)->name,
                                   "supercategory", "entity"), m == 0, false);
    fputs("],\n\"licenses\":[],\n\"info\":", c->file);
    json_t *info = json_pack("{s:s,s:s,s:s,s:I}", "description", "pitviper replay", "version", PITVIPER_VERSION,
                             "config_sha256", c->config_sha256, "seed", (json_int_t)c->seed);
    json_dumpf(info, c->file, JSON_COMPACT);
    json_decref(info);
    fputs("}\n", c->file);
}

Status coco_close(Coco *c)
{
    if (!c) return STATUS_OK;
    if (!c->failed) {
        errno = 0;
        join(c);
        if (ferror(c->file) || ferror(c->waiting)) fail(c);
    }
    if (c->waiting) fclose(c->waiting);
    unlink(c->waiting_path);
    if (c->file && fclose(c->file) != 0) fail(c);
    if (!c->failed && rename(c->part, c->path) != 0) fail(c);
    if (c->failed) unlink(c->part);
    const Status status = c->failed ? STATUS_IO : STATUS_OK;
    free(c);
    return status;
}
