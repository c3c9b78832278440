/* sensor/verify/regress/case_update.c: approves the output of a run: writes the baseline (record/) and card.md. */
#include "sensor/verify/regress/run_case.h"
#include "pitviper_output.h"

#include "sensor/publish/files/frame_files.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

enum { path_size = case_path_size + 64, file_most = 64 << 20 };

static Status write_file(const char *path, const char *text, size_t octets)
{
    FILE *file = output_begin(path, 0);
    if (file) fwrite(text, 1, octets, file);
    if (file && output_end(file, path)) return STATUS_OK;
    log_error("regress: cannot write %s: %s", path, output_reason(errno));
    return STATUS_IO;
}

static Status copy_file(const char *from_folder, const char *to_folder, const char *name)
{
    char   path[path_size], *text;
    size_t octets;
    snprintf(path, sizeof path, "%.4090s/%s", from_folder, name);
    Status status = text_read_file(&text, &octets, "regress", path, file_most);
    if (status != STATUS_OK) return status;
    snprintf(path, sizeof path, "%.4090s/%s", to_folder, name);
    status = write_file(path, text, octets);
    free(text);
    return status;
}

/* run.json without what differs in every run and place, so that an equal run gives an equal file. */
static Status copy_run(const char *from_folder, const char *to_folder, const Case *c)
{
    static const char *const other[] = {"timings_ms", "threads"};
    char                     path[path_size], *text, *same = NULL;
    size_t                   octets;
    snprintf(path, sizeof path, "%.4090s/run.json", from_folder);
    Status status = text_read_file(&text, &octets, "regress", path, file_most);
    if (status != STATUS_OK) return status;
    status = json_text_without(&same, text, octets, other, 2, "regress", path);
    free(text);
    if (status == STATUS_OK) status = case_relative(&same, c);
    snprintf(path, sizeof path, "%.4090s/run.json", to_folder);
    if (status == STATUS_OK) status = write_file(path, same, strlen(same));
    free(same);
    return status;
}

/* NNNNNN.exr, NNNNNN.profile.exr, truth.jsonl, run.json, scores.json: the files of a baseline. */
static bool is_of_record(const char *name)
{
    static const char *const json[] = {"truth.jsonl", "run.json", "scores.json"};
    for (int i = 0; i < 3; i++)
        if (strcmp(name, json[i]) == 0) return true;
    for (int i = 0; i < 6; i++)
        if (name[i] < '0' || name[i] > '9') return false;
    return strcmp(name + 6, ".exr") == 0 || strcmp(name + 6, ".profile.exr") == 0;
}

/* Moves the files of a baseline, and no others, to another folder; NULL: deletes them. */
static bool move_files(const char *folder, const char *to)
{
    char from_path[path_size + 300], to_path[path_size + 300];
    bool ok = true;
    DIR *directory = output_list(folder);
    if (!directory) return errno == ENOENT;
    for (struct dirent *entry; (entry = readdir(directory));) {
        if (!is_of_record(entry->d_name)) continue;
        snprintf(from_path, sizeof from_path, "%s/%s", folder, entry->d_name);
        snprintf(to_path, sizeof to_path, "%s/%s", to ? to : "", entry->d_name);
        ok = (to ? output_rename(from_path, to_path) : output_remove(from_path)) == 0 && ok;
    }
    closedir(directory);
    return ok;
}

static Status write_products(const CaseResult *r, const char *out, const char *to, char date[32])
{
    Status status = frame_files_folder(to) == STATUS_OK && move_files(to, NULL) ? STATUS_OK : STATUS_IO;
    for (int i = 0; i < r->c.frames.count && status == STATUS_OK; i++) {
        RecordFrame frame = {0};
        status = record_frame_from_run(&frame, out, (int)r->c.frames.number[i]);
        if (status == STATUS_OK) status = record_frame_write(to, &frame);
        if (status == STATUS_OK && i == 0) memcpy(date, frame.date, sizeof frame.date);
        record_frame_free(&frame);
    }
    if (status == STATUS_OK) status = copy_file(out, to, "truth.jsonl");
    if (status == STATUS_OK && case_has_scores(&r->c)) status = copy_file(out, to, "scores.json");
    if (status == STATUS_OK) status = copy_run(out, to, &r->c);
    return status;
}

Status case_write_record(const CaseResult *r, const char *folder)
{
    char out[path_size], date[32];
    snprintf(out, sizeof out, "%.4080s/out", r->work);
    return write_products(r, out, folder, date);
}

/* Reads the present content of card.md from its first entry on. NULL: there is none. */
static char *old_card(const char *path)
{
    char  *text;
    size_t octets;
    if (access(path, F_OK) != 0 || text_read_file(&text, &octets, "regress", path, file_most) != STATUS_OK) return NULL;
    char *first = strncmp(text, "## ", 3) == 0 ? text : strstr(text, "\n## ");
    if (first && *first == '\n') first++;
    memmove(text, first ? first : text + octets, strlen(first ? first : text + octets) + 1);
    return text;
}

static void put_line(FILE *to, const char *text)
{
    for (; *text; text++) fputc((unsigned char)*text < ' ' ? ' ' : *text, to);
}

/* Writes what the update changes: each channel that fails against the old baseline. */
static void put_changes(FILE *to, const CaseResult *r)
{
    if (!r->compared) {
        fputs("- what: first baseline\n", to);
        return;
    }
    int count = 0;
    for (const char *at = r->verdict.remarks; *at; at += strcspn(at, "\n") + (at[strcspn(at, "\n")] == '\n'))
        if (strncmp(at, "table ", 6) == 0 || strncmp(at, "setting ", 8) == 0)
            fprintf(to, "- changed: %.*s\n", (int)strcspn(at, "\n"), at);
    for (int k = 0; k < CHANNEL_COUNT; k++)
        if (r->verdict.channel[k].failed && count++ >= 0)
            fprintf(to, "- what: %s: %s\n", verdict_channel_name((Channel)k), r->verdict.channel[k].line);
    if (count == 0) fputs("- what: nothing beyond tolerance\n", to);
}

static Status write_card(const CaseResult *r, const char *why, const JsonValues *run, const char *date)
{
    char   path[path_size], *text = NULL;
    size_t octets = 0;
    snprintf(path, sizeof path, "%.4090s/card.md", r->c.folder);
    const JsonValue *version = json_values_find(run, "pitviper"), *hash = json_values_find(run, "config_sha256");
    char            *old = old_card(path);
    FILE            *card = open_memstream(&text, &octets);
    if (!card) {
        free(old);
        return STATUS_NO_MEMORY;
    }
    fprintf(card, "# %s\n\n", r->c.name);
    put_line(card, r->c.purpose);
    fprintf(card, "\n\n## pitviper %s, exercise of %.4s-%.2s-%.2s %s UTC\n\n- why: ",
            version && version->text ? version->text : "?", date, date + 5, date + 8,
            strlen(date) > 11 ? date + 11 : "");
    put_line(card, why);
    fputc('\n', card);
    put_changes(card, r);
    fprintf(card, "- settings: %s\n- frames:", hash && hash->text ? hash->text : "?");
    for (int i = 0; i < r->c.frames.count; i++) fprintf(card, " %.0f", r->c.frames.number[i]);
    fprintf(card, "\n%s%s", old && *old ? "\n" : "", old ? old : "");
    free(old);
    const bool   ok = fclose(card) == 0;
    const Status status = ok ? write_file(path, text, octets) : STATUS_NO_MEMORY;
    free(text);
    return status;
}

static Status read_run(JsonValues *out, const char *folder)
{
    char   path[path_size], *text;
    size_t octets;
    snprintf(path, sizeof path, "%.4090s/run.json", folder);
    Status status = text_read_file(&text, &octets, "regress", path, file_most);
    if (status != STATUS_OK) return status;
    status = json_values_read(out, text, octets, "regress", path);
    free(text);
    return status;
}

/* Size of the baseline. */
static double record_octets(const char *folder)
{
    char        path[path_size + 300];
    double      sum = 0;
    struct stat about;
    DIR        *directory = opendir(folder);
    for (struct dirent *entry; directory && (entry = readdir(directory));) {
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        if (is_of_record(entry->d_name) && stat(path, &about) == 0) sum += (double)about.st_size;
    }
    if (directory) closedir(directory);
    return sum;
}

/* Copies the automatic choices that replay printed: host, aim, terrain, time. */
static void take_choices(CaseResult *r, const JsonValues *run)
{
    const JsonValue *host = json_values_find(run, "hosts[0]"), *aim = json_values_find(run, "settings.exercise.aim");
    char             all[sizeof r->chosen] = "";
    size_t           n = 0;
    bool             said_host = false, said_aim = false;
    for (int i = 0; i < 1000 && n < sizeof all; i++) { /* values are sorted by path as text: 10 before 2 */
        char path[32];
        snprintf(path, sizeof path, "choices[%d]", i);
        const JsonValue *choice = json_values_find(run, path);
        if (!choice || !choice->text) break;
        said_host |= strncmp(choice->text, "host:", 5) == 0;
        said_aim |= strncmp(choice->text, "aim:", 4) == 0;
        n += (size_t)snprintf(all + n, sizeof all - n, "%s\n", choice->text);
    }
    n = 0;
    if (!said_host && host && host->text)
        n += (size_t)snprintf(r->chosen, sizeof r->chosen, "host: %.100s\n", host->text);
    if (!said_aim && aim && aim->text && *aim->text)
        n += (size_t)snprintf(r->chosen + n, sizeof r->chosen - n, "aim: %.100s (exercise.aim)\n", aim->text);
    snprintf(r->chosen + n, sizeof r->chosen - n, "%s", all);
}

void case_update(CaseResult *r, const char *why)
{
    char       out[path_size], record[path_size], fresh[path_size], date[32] = "";
    JsonValues run = {0};
    snprintf(out, sizeof out, "%.4080s/out", r->work);
    snprintf(record, sizeof record, "%.4080s/record", r->c.folder);
    snprintf(fresh, sizeof fresh, "%.4080s/record.part", r->c.folder);

    /* an unreadable old baseline does not prevent the update */
    char kept[sizeof r->said];
    memcpy(kept, r->said, sizeof kept);
    if (access(record, F_OK) == 0) r->compared = verdict_of(&r->verdict, &r->c, record, out) == STATUS_OK;
    memcpy(r->said, kept, sizeof kept);

    Status status = read_run(&run, out);
    if (status == STATUS_OK) take_choices(r, &run);
    if (status == STATUS_OK) status = write_products(r, out, fresh, date);
    if (status == STATUS_OK &&
        (frame_files_folder(record) != STATUS_OK || !move_files(record, NULL) || !move_files(fresh, record))) {
        log_error("regress: cannot write in %s: %s", record, output_reason(errno));
        status = STATUS_IO;
    }
    if (status == STATUS_OK) status = write_card(r, why, &run, date);
    move_files(fresh, NULL);
    rmdir(fresh);
    json_values_free(&run);
    r->updated = status == STATUS_OK;
    r->state = r->updated ? CASE_OK : CASE_BROKEN;
    if (!r->updated) {
        snprintf(r->line, sizeof r->line, "the baseline was not written: %s", status_name(status));
        return;
    }
    if (r->compared && r->verdict.first >= 0)
        snprintf(r->line, sizeof r->line, "approved, %.0f kB; was %s: %.500s", record_octets(record) / 1000,
                 verdict_channel_name((Channel)r->verdict.first), r->verdict.channel[r->verdict.first].line);
    else
        snprintf(r->line, sizeof r->line, "approved, %.0f kB%s", record_octets(record) / 1000,
                 r->compared ? "; within tolerance of the previous baseline" : "");
}
