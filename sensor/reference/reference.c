/* sensor/reference/reference.c: the reference of the products as text for a terminal and as Markdown. */
#include "sensor/reference/reference.h"
#include "render/scene/view.h"

static const Reference *const topics[] = {
    &reference_products,
    &reference_truth,
    &reference_run,
    &reference_exr,
    &reference_png,
    &reference_raw,
    &reference_profile,
    &reference_radar,
    &reference_radar_map,
    &reference_radar_scan,
    &reference_radar_azimuths,
    &reference_pairs,
    &reference_coco,
    &reference_answers,
    &reference_score,
    &reference_manifest,
    &reference_sheet,
    &reference_data_pdu,
    &reference_stream_pdu,
    &reference_radar_pdu,
    &reference_pdus,
    &reference_regress,
};
enum { topic_count = sizeof topics / sizeof *topics, columns = 112 };

const char *reference_band(int i) { return i < BAND_COUNT ? band_name((Band)i) : NULL; }

/* ---- terminal -------------------------------------------------------------------------------- */

/* Wraps text to `columns`, indented by `indent`; lines that begin with a blank are kept as they are. */
static void put_wrapped(FILE *to, const char *text, int indent)
{
    int at = -1; /* column; -1: a new line */
    while (*text) {
        const size_t length = strcspn(text, " \n");
        if (at < 0 && *text == ' ') {
            const size_t whole = strcspn(text, "\n");
            fprintf(to, "%*s%.*s\n", indent, "", (int)whole, text);
            text += whole + (text[whole] == '\n');
            continue;
        }
        if (length > 0) {
            if (at >= 0 && at + 1 + (int)length > columns) {
                fputc('\n', to);
                at = -1;
            }
            fprintf(to, "%*s%.*s", at < 0 ? indent : 1, "", (int)length, text);
            at = (at < 0 ? indent : at + 1) + (int)length;
        }
        text += length;
        if (*text == '\n') {
            if (at >= 0) fputc('\n', to);
            if (text[1] == '\n') fputc('\n', to);
            while (*text == '\n') text++;
            at = -1;
        } else if (*text) {
            text++;
        }
    }
    if (at >= 0) fputc('\n', to);
}

static void put_field(FILE *to, const ReferenceField *f)
{
    char line[700];
    fprintf(to, "  %-38s %s%s%s\n", f->path, f->type, *f->unit ? ", " : "", f->unit);
    snprintf(line, sizeof line, "%s%s%s.%s%s%s", f->about, *f->frame ? "; " : "", f->frame,
             *f->absent ? " Absent "
                          ""
                        : "",
             f->absent, *f->absent ? "." : "");
    put_wrapped(to, line, 6);
}

static void put_words(FILE *to, const Reference *r)
{
    for (int i = 0; i < r->word_count; i++) {
        const ReferenceWord *w = &r->word[i];
        fprintf(to, "\n  %s: %s\n", w->word, w->about);
        for (int k = 0; w->name && w->name(k); k++)
            if (w->what) fprintf(to, "      %-24s %s\n", w->name(k), w->what(k));
            else fprintf(to, "      %s\n", w->name(k));
    }
}

static void put_python(FILE *to, const char *python)
{
    for (size_t length; *python; python += length + (python[length] == '\n')) {
        length = strcspn(python, "\n");
        fprintf(to, "%s%.*s\n", length ? "    " : "", (int)length, python);
    }
}

/* ---- fields -------------------------------------------------------------------------------------- */

typedef void PutField(FILE *to, const ReferenceField *field);

static void put_table(FILE *to, const FieldTable *table, const char *above, PutField *put)
{
    char path[200], type[field_type_size];
    for (int i = 0; i < table->count; i++) {
        const Field *f = &table->row[i];
        const int    n = snprintf(path, sizeof path, "%s%s%s", above, *above ? "." : "", f->name);
        put(to, &(ReferenceField){path, field_type(type, f), f->unit, f->frame, f->absent, f->about});
        if (field_is_list(f)) snprintf(path + n, sizeof path - (size_t)n, "[]");
        if (f->rows) put_table(to, f->rows, path, put);
    }
}

static void put_fields(FILE *to, const Reference *r, PutField *put)
{
    ReferenceField f;
    for (int i = 0; r->listed && r->listed(&f, i); i++) put(to, &f);
    for (int i = 0; i < r->field_count; i++) put(to, &r->field[i]);
    if (r->table) put_table(to, r->table, "", put);
}

static bool has_fields(const Reference *r) { return r->listed || r->field_count || r->table; }

/* ---- topics -------------------------------------------------------------------------------------- */

void reference_list(FILE *to)
{
    for (int i = 0; i < topic_count; i++) fprintf(to, "%s%s", i ? " " : "", topics[i]->topic);
}

static const Reference *find(const char *topic)
{
    for (int i = 0; i < topic_count; i++)
        if (strcmp(topics[i]->topic, topic) == 0 || strcmp(topics[i]->file, topic) == 0) return topics[i];
    return NULL;
}

void reference_write_topic(FILE *to, const Reference *r)
{
    fprintf(to, "%s: %s\n\n", r->file, r->title);
    put_wrapped(to, r->about, 0);
    if (r->notation) {
        fputc('\n', to);
        put_wrapped(to, r->notation, 0);
    }
    if (has_fields(r)) fputc('\n', to);
    put_fields(to, r, put_field);
    put_words(to, r);
    if (r->python) {
        fputs("\nin Python, in the folder given by --out\n\n", to);
        put_python(to, r->python);
    }
}

bool reference_write(FILE *to, const char *topic)
{
    const Reference *r = find(topic);
    if (r) reference_write_topic(to, r);
    return r != NULL;
}

/* ---- Markdown -------------------------------------------------------------------------------- */

/* Escapes bars, which end a cell. */
static void put_cell(FILE *to, const char *text)
{
    for (; *text; text++) {
        if (*text == '|') fputc('\\', to);
        fputc(*text, to);
    }
}

static void put_row(FILE *to, const ReferenceField *f)
{
    const char *const cell[] = {f->type, f->unit, f->frame, f->absent, f->about};
    fprintf(to, "| `%s` |", f->path);
    for (int i = 0; i < 5; i++) {
        fputc(' ', to);
        put_cell(to, cell[i]);
        fputs(" |", to);
    }
    fputc('\n', to);
}

static void put_topic(FILE *to, const Reference *r)
{
    fprintf(to, "\n## %s\n\n`%s`: %s\n\n%s\n", r->topic, r->file, r->title, r->about);
    if (r->notation) fprintf(to, "\n%s\n", r->notation);
    if (has_fields(r))
        fputs("\n| field | type | unit | frame, order, index base | absent | meaning |\n"
              "|---|---|---|---|---|---|\n",
              to);
    put_fields(to, r, put_row);
    for (int i = 0; i < r->word_count; i++) {
        const ReferenceWord *w = &r->word[i];
        fprintf(to, "\n`%s`: %s", w->word, w->about);
        for (int k = 0; w->name && w->name(k); k++) {
            fprintf(to, "%s`%s`", k ? ", " : " ", w->name(k));
            if (w->what) fprintf(to, " (%s)", w->what(k));
        }
        fputc('\n', to);
    }
    if (r->python) fprintf(to, "\n```python\n%s```\n", r->python);
}

void reference_write_markdown(FILE *to)
{
    fputs("# Products of pitviper " PITVIPER_VERSION "\n\n"
          "Every field of every file, as in `pitviper help TOPIC`. Generated by `pitviper help --markdown`.\n",
          to);
    for (int i = 0; i < topic_count; i++) put_topic(to, topics[i]);
}
