/* sensor/score/sequences.c: finds the folders of OUT that have truth. */
#include "sensor/score/sequences.h"
#include "pitviper_file.h"
#include "sensor/score/json_member.h"
#include "sensor/score/json_stream.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <sys/stat.h>

bool sequence_path(char out[sequence_path_size], const char *folder, const char *sequence, const char *file)
{
    return snprintf(out, sequence_path_size, "%s/%s%s%s", folder, sequence, *sequence ? "/" : "", file) <
           sequence_path_size;
}

static bool has(const char *folder, const char *sequence, const char *file)
{
    char path[sequence_path_size], why[file_why_size];
    return sequence_path(path, folder, sequence, file) && file_is_regular(why, path);
}

static Status add(Sequences *s, const char *name)
{
    if (strlen(name) >= sizeof *s->name) return STATUS_OK;
    if (s->count == sequences_most) return STATUS_NO_MEMORY;
    if (s->count == s->room) {
        const int room = s->room ? 2 * s->room : 16;
        void     *grown = realloc(s->name, (size_t)room * sizeof *s->name);
        if (!grown) return STATUS_NO_MEMORY;
        s->name = grown;
        s->room = room;
    }
    snprintf(s->name[s->count++], sizeof *s->name, "%s", name);
    return STATUS_OK;
}

/* One line of the manifest. */
static Status add_variant(Sequences *s, const char *folder, const JsonStream *stream)
{
    json_t *line;
    if (json_member_load(&line, stream->text, stream->length) == STATUS_NO_MEMORY) return STATUS_NO_MEMORY;
    const char *name = json_string_value(json_object_get(line, "folder"));
    const char *how = json_string_value(json_object_get(line, "status"));
    Status      status = STATUS_OK;
    if (!name || !how || !*name || strchr(name, '/') || *name == '.') {
        log_error("score: %s:%ld: a line without `folder` and `status`; this is no manifest of a sweep", stream->path,
                  stream->line);
        status = STATUS_BAD_VALUE;
    } else if (strcmp(how, "failed") != 0) {
        if (has(folder, name, "truth.jsonl")) status = add(s, name);
        else log_warn("score: %s/%s has no truth.jsonl, and is left out", folder, name);
    }
    json_decref(line);
    return status;
}

static Status find_variants(Sequences *s, const char *folder)
{
    char       path[sequence_path_size];
    JsonStream stream = {0};
    bool       more = true;
    Status     status = sequence_path(path, folder, "", "manifest.jsonl") ? STATUS_OK : STATUS_BAD_VALUE;
    if (status == STATUS_OK) status = json_stream_open(&stream, path, 64 << 20);
    while (status == STATUS_OK && more) {
        status = json_stream_line(&more, &stream);
        if (status == STATUS_OK && more) status = add_variant(s, folder, &stream);
    }
    json_stream_close(&stream);
    return status;
}

static Status find_hosts(Sequences *s, const char *folder)
{
    DIR   *list = opendir(folder);
    Status status = STATUS_OK;
    if (!list) {
        log_error("score: cannot read %s: %s; name a folder that `pitviper replay` or `run` wrote", folder,
                  strerror(errno));
        return STATUS_IO;
    }
    for (struct dirent *entry; status == STATUS_OK && (entry = readdir(list));)
        if (*entry->d_name != '.' && has(folder, entry->d_name, "truth.jsonl")) status = add(s, entry->d_name);
    closedir(list);
    return status;
}

static int by_name(const void *a, const void *b) { return strcmp(a, b); }

Status sequences_find(Sequences *out, const char *folder)
{
    Sequences s = {.sweep = has(folder, "", "manifest.jsonl")};
    Status    status = STATUS_OK;
    if (s.sweep) status = find_variants(&s, folder);
    else if (has(folder, "", "truth.jsonl")) status = add(&s, "");
    else status = find_hosts(&s, folder);
    if (status == STATUS_OK && s.count == 0) {
        log_error(
            "score: %s has no truth.jsonl, and no folder in it has; name a folder that `pitviper replay` or `run` "
            "wrote (publish.files on)",
            folder);
        status = STATUS_BAD_VALUE;
    }
    if (status != STATUS_OK) {
        sequences_free(&s);
        return status;
    }
    qsort(s.name, (size_t)s.count, sizeof *s.name, by_name);
    *out = s;
    return STATUS_OK;
}

void sequences_free(Sequences *s)
{
    free(s->name);
    *s = (Sequences){0};
}
