/* sensor/verify/bisect/bisect_report.c: what a bisection prints and writes: bisect.json and a page. */
#include "sensor/verify/bisect/bisect_private.h"
#include "pitviper_output.h"

#include "sensor/frame/field.h"
#include "sensor/publish/files/html_page.h"

#include <errno.h>
#include <stdlib.h>

enum { said_size = 900 };

/* ---- in words ----------------------------------------------------------------------------------- */

static void say(char out[said_size], const Bisect *b, int difference, int level)
{
    differences_say(out, said_size, &b->d, difference, level);
}

static const char *verdict_of_trial(const Trial *t)
{
    if (t->answer == DELTA_UNKNOWN || t->answer == DELTA_STOP) return "cannot be run";
    return t->first < 0 ? "nothing moves" : "";
}

/* What was tried alone is worth a line where there are others, and it is no cause. */
static bool is_told(const Bisect *b, int i)
{
    const int trial = b->alone[i].trial;
    for (int k = 0; k < b->cause_count; k++)
        if (b->cause[k].trial == trial) return false;
    return b->trial[trial].size < b->d.count;
}

static const char *word_of_cause(const Cause *c)
{
    if (!c->smallest) return c->size == 1 ? "cause" : "cause, not told further apart";
    return c->size == 1 ? "cause" : "cause, only together";
}

/* What happens without what was found. */
static void say_rest(char out[said_size], const Bisect *b)
{
    const char *channel = verdict_channel_name(b->moved),
               *it = b->cause_count == 1 && b->cause[0].size == 1 ? "it" : "them";
    int size = 0;
    for (int i = 0; i < b->cause_count; i++) size += b->cause[i].size;
    const int others = b->d.count - size;
    if (others == 0) snprintf(out, said_size, "there is no other difference");
    else if (b->rest == DELTA_STILL)
        snprintf(out, said_size, "without %s the other %d do not move %s", it, others, channel);
    else if (b->rest == DELTA_MOVES)
        snprintf(out, said_size, "without %s the other %d move %s as well: bisect again without what was found", it,
                 others, channel);
    else if (b->rest == DELTA_UNKNOWN)
        snprintf(out, said_size, "whether the other %d move %s without %s is not known: they cannot be run", others,
                 channel, it);
    else
        snprintf(out, said_size, "whether the other %d move %s without %s was not tried: no more runs (--runs)", others,
                 channel, it);
}

static void print(const Bisect *b, const char *word, const char *text)
{
    text_print(stdout, "%-24s %s: %s\n", b->c.name, word, text);
}

void bisect_print(const Bisect *b)
{
    char said[said_size], line[2 * said_size];
    print(b, "moved", b->new->line);
    for (int i = 0; i < b->alone_count; i++) {
        const Trial *t = &b->trial[b->alone[i].trial];
        if (!is_told(b, i)) continue;
        say(said, b, b->alone[i].index, b->alone[i].level);
        const char *verdict = verdict_of_trial(t);
        snprintf(line, sizeof line, "%s: %s%s%s", said, verdict,
                 *verdict && t->first < 0 && *t->line && *verdict == 'c' ? ": " : "", *verdict == 'n' ? "" : t->line);
        print(b, "alone", line);
    }
    for (int i = 0; i < b->cause_count; i++) {
        const Cause *c = &b->cause[i];
        const char  *moves = c->trial >= 0 ? b->trial[c->trial].line : "";
        for (int k = 0; k < b->d.count; k++) {
            if (!c->in[k]) continue;
            say(said, b, k, level_all);
            snprintf(line, sizeof line, "%s%s%s", said, c->size == 1 ? ": " : "", c->size == 1 ? moves : "");
            print(b, word_of_cause(c), line);
        }
        if (c->size > 1) print(b, "they move", moves);
    }
    say_rest(said, b);
    if (b->cause_count) print(b, "rest", said);
}

/* ---- bisect.json ------------------------------------------------------------------------------------ */

/* A difference, tried alone or of a cause, as its fields. */
typedef struct Told {
    char        what[said_size];
    const char *table, *setting, *channel, *line;
} Told;

typedef struct CauseTold {
    const Bisect *b;
    const Cause  *cause;
    const char   *channel, *line;
    bool          smallest, together;
    Told         *told; /* [size] */
} CauseTold;

typedef struct BisectTold {
    const char *name, *old, *new, *kind, *channel, *line, *rest, *approved;
    int         frame, differences, runs;
    int         alone_count, cause_count;
    Told        alone[alone_most];
    CauseTold   cause[causes_most];
} BisectTold;

static void tell(Told *out, const Bisect *b, int difference, int level)
{
    const Difference *one = &b->d.difference[difference];
    *out = (Told){0};
    say(out->what, b, difference, level);
    if (level > level_parts && (one->kind == OF_FILE || one->kind == OF_ROW))
        out->table = b->d.tables.file[one->file].name;
    if (one->kind == OF_KEY) out->setting = config_key(one->key);
}

static const void *next_alone(FieldAt *at, int i)
{
    const BisectTold *t = at->of;
    return i < t->alone_count ? &t->alone[i] : NULL;
}
static const void *next_cause(FieldAt *at, int i)
{
    const BisectTold *t = at->of;
    return i < t->cause_count ? &t->cause[i] : NULL;
}
static const void *next_of_cause(FieldAt *at, int i)
{
    const CauseTold *c = at->of;
    return i < c->cause->size ? &c->told[i] : NULL;
}

#define OF_TOLD(member) FIELD_MEMBER(Told, member)
static const Field told_rows[] = {
    {"what", "", "", "", "the difference, in words", OF_TOLD(what)},
    {"table", "", "", "of others", "its file in the folder of tables", OF_TOLD(table)},
    {"setting", "", "", "of others", "its key", OF_TOLD(setting)},
    {"channel", "", "", "when none fails", "first channel that it moves alone", OF_TOLD(channel)},
    {"line", "", "", "", "what it does alone; empty: nothing moves", OF_TOLD(line)},
};
#define OF_CAUSE(member) FIELD_MEMBER(CauseTold, member)
static const Field cause_rows[] = {
    {"together", "", "", "", "whether it takes all of them", OF_CAUSE(together)},
    {"smallest", "", "", "", "whether it was tried with each left out", OF_CAUSE(smallest)},
    {"channel", "", "", "", "first channel that they move", OF_CAUSE(channel)},
    {"line", "", "", "", "by how much, and where", OF_CAUSE(line)},
    {"differences", "", "", "", "", .item = next_of_cause, FIELD_OBJECTS(told_rows)},
};
#define OF_ALL(member) FIELD_MEMBER(BisectTold, member)
static const Field rows[] = {
    {"case", "", "", "", "its name", OF_ALL(name)},
    {"kind", "", "", "", "programs, tables or settings", OF_ALL(kind)},
    {"old", "", "", "", "as given", OF_ALL(old)},
    {"new", "", "", "", "as given", OF_ALL(new)},
    {"approved", "", "", "without a baseline", "OLD and the approved baseline", OF_ALL(approved)},
    {"differences", "", "", "", "how many there are", OF_ALL(differences)},
    {"runs", "", "", "", "how many, beside those of OLD and NEW", OF_ALL(runs)},
    {"channel", "", "", "when none fails", "first channel that NEW moves", OF_ALL(channel)},
    {"frame", "", "", "when none fails", "where it is worst; -1: of the whole run", OF_ALL(frame)},
    {"line", "", "", "", "by how much, and where", OF_ALL(line)},
    {"causes", "", "", "", "", .item = next_cause, FIELD_OBJECTS(cause_rows)},
    {"rest", "", "", "", "what happens without them, in words", OF_ALL(rest)},
    {"alone", "", "", "", "what was tried alone", .item = next_alone, FIELD_OBJECTS(told_rows)},
};

static const char *channel_name(int channel) { return channel < 0 ? NULL : verdict_channel_name((Channel)channel); }

static void tell_cause(CauseTold *out, const Bisect *b, const Cause *c)
{
    const Trial *t = c->trial >= 0 ? &b->trial[c->trial] : NULL;
    int          n = 0;
    *out = (CauseTold){b,           c,           t ? channel_name(t->first) : NULL,    t ? t->line : "",
                       c->smallest, c->size > 1, calloc((size_t)c->size, sizeof(Told))};
    for (int k = 0; out->told && k < b->d.count; k++)
        if (c->in[k]) tell(&out->told[n++], b, k, level_all);
}

static void put_line(FILE *to, const void *user) { fprintf(to, "%s\n", (const char *)user); }

static void say_approved(char out[said_size], const Bisect *b)
{
    const int first = b->approved.first;
    if (first < 0) snprintf(out, said_size, "within tolerance");
    else snprintf(out, said_size, "%s: %s", verdict_channel_name((Channel)first), b->approved.channel[first].line);
}

static Status write_json(const Bisect *b, const char *path)
{
    char        rest[said_size], approved[said_size];
    BisectTold *t = calloc(1, sizeof *t);
    Status      status = STATUS_NO_MEMORY;
    if (!t) return status;
    say_rest(rest, b);
    say_approved(approved, b);
    *t = (BisectTold){.name = b->c.name,
                      .old = b->d.old.given,
                      .new = b->d.new.given,
                      .kind = side_kind_name(b->d.old.kind),
                      .channel = channel_name(b->new->verdict.first),
                      .line = b->new->line,
                      .rest = b->cause_count ? rest : NULL,
                      .approved = b->compared_approved ? approved : NULL,
                      .frame = b->new->verdict.first < 0 ? -1 : b->new->verdict.channel[b->new->verdict.first].frame,
                      .differences = b->d.count,
                      .runs = b->runs};
    for (int i = 0; i < b->alone_count; i++) {
        const Trial *trial = &b->trial[b->alone[i].trial];
        if (!is_told(b, i)) continue;
        Told *told = &t->alone[t->alone_count++];
        tell(told, b, b->alone[i].index, b->alone[i].level);
        told->channel = channel_name(trial->first);
        told->line = trial->line;
    }
    for (int i = 0; i < b->cause_count; i++) tell_cause(&t->cause[t->cause_count++], b, &b->cause[i]);
    char *line = field_line(&FIELD_TABLE(rows), t, 15);
    if (line) status = text_write_file("regress", path, put_line, line);
    free(line);
    for (int i = 0; i < t->cause_count; i++) free(t->cause[i].told);
    free(t);
    return status;
}

/* ---- the page ------------------------------------------------------------------------------------- */

static void put_causes(FILE *page, const Bisect *b)
{
    char said[said_size];
    fputs("<table><tr><th>cause</th><th>differences</th><th>what they move</th></tr>\n", page);
    for (int i = 0; i < b->cause_count; i++) {
        const Cause *c = &b->cause[i];
        fprintf(page, "<tr><td style=\"white-space:nowrap\"><a href=\"#case%d\">%s %d</a></td><td class=\"bad\">",
                i + 1, c->size > 1 ? "only together" : "alone", i + 1);
        for (int k = 0, n = 0; k < b->d.count; k++) {
            if (!c->in[k]) continue;
            say(said, b, k, level_all);
            html_text(page, "%s", said);
            fputs(++n < c->size ? ";<br>" : "", page);
        }
        fputs("</td><td>", page);
        html_text(page, "%s", c->trial >= 0 ? b->trial[c->trial].line : "");
        fputs("</td></tr>\n", page);
    }
    fputs("</table>\n", page);
}

static void put_alone(FILE *page, const Bisect *b)
{
    char said[said_size];
    fputs("<h2>Tried alone</h2>\n<table><tr><th>difference</th><th>what it moves</th></tr>\n", page);
    for (int i = 0; i < b->alone_count; i++) {
        const Trial *t = &b->trial[b->alone[i].trial];
        if (!is_told(b, i)) continue;
        const char *verdict = verdict_of_trial(t);
        say(said, b, b->alone[i].index, b->alone[i].level);
        fputs("<tr><td>", page);
        html_text(page, "%s", said);
        fputs("</td><td>", page);
        html_text(page, "%s%s%s", verdict, *verdict == 'c' ? ": " : "", *verdict == 'n' ? "" : t->line);
        fputs("</td></tr>\n", page);
    }
    fputs("</table>\n", page);
}

static void put_head(FILE *page, const Bisect *b)
{
    char said[said_size];
    fputs("<p>pitviper " PITVIPER_VERSION ": of two ", page);
    html_text(page, "%s, %s (old) and %s (new), the differences that move the case %s. ",
              b->d.old.kind == SIDE_PROGRAM  ? "programs"
              : b->d.old.kind == SIDE_TABLES ? "folders of tables"
                                             : "files of settings",
              b->d.old.given, b->d.new.given, b->c.name);
    html_text(
        page,
        "%d difference%s, %d runs beside those of old and new, each compared with the run of old: below, the baseline is that run.",
        b->d.count, b->d.count == 1 ? "" : "s", b->runs);
    fputs("</p>\n<p>", page);
    say_approved(said, b);
    if (b->compared_approved) html_text(page, "Old and the approved baseline: %s. ", said);
    html_text(page, "New against old: %s.", b->new->verdict.first < 0 ? "nothing moves" : b->new->line);
    fputs("</p>\n", page);
    if (b->cause_count == 0) return;
    put_causes(page, b);
    say_rest(said, b);
    fputs("<p>", page);
    html_text(page, "%c%s.", said[0] - ('a' - 'A'), said + 1);
    fputs("</p>\n", page);
}

/* Each cause once more, in a folder of its own, for its images and the commands that reproduce it. */
static void put_runs(FILE *page, Bisect *b)
{
    char work[32];
    for (int i = 0; i < b->cause_count; i++) {
        snprintf(work, sizeof work, "cause%d", i + 1);
        trial_run(b->tried, b, work, b->cause[i].in, false, true);
        snprintf(b->tried->c.name, sizeof b->tried->c.name, "Cause %d: old with these differences", i + 1);
        regress_report_failed(page, b->tried, i + 1);
    }
    if (b->new->verdict.first < 0) return;
    snprintf(b->new->c.name, sizeof b->new->c.name, "New against old");
    regress_report_failed(page, b->new, 0);
}

Status bisect_write(Bisect *b, const char *folder)
{
    char path[bisect_path_size];
    snprintf(path, sizeof path, "%s/bisect.json", folder);
    Status status = write_json(b, path);
    if (status != STATUS_OK) return status;
    snprintf(path, sizeof path, "%s/report.html", folder);
    FILE *page = html_begin(path, "Regression: what moved it");
    if (!page) return STATUS_IO;
    put_head(page, b);
    put_runs(page, b);
    if (b->alone_count) put_alone(page, b);
    return html_end(page, path);
}
