/* sensor/publish/coco_file.c: writes coco.json part by part, and renames it when it is complete. */
#include "sensor/publish/coco_file.h"
#include "pitviper_output.h"

#include "sensor/publish/target_class.h"

#include <errno.h>
#include <stdlib.h>

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
    c->file    = output_begin(c->path, 0);
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
    const bool ok   = text && fprintf(file, "%s%s", place == 0 ? "\n" : ",\n", text) > 0;
    free(text);
    json_decref(object);
    return ok ? STATUS_OK : fail(c);
}

Status coco_file_image(CocoFile *c, json_t *image) { return put(c, c->file, image, c->images++); }
Status coco_file_annotation(CocoFile *c, json_t *annotation)
{
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
        put(c, c->file, json_pack("{s:i,s:s,s:s}", "id", k, "name", target_class_name(k), "supercategory",
                                  target_class_group(k)), k - 1);
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
