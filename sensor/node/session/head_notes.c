/* sensor/node/session/head_notes.c: poses of a head, written to and read from the notes of a live node's recording. */
#include "sensor/node/session/head_notes.h"

#include <stdlib.h>

static const char begin[] = "pitviper: head at ", between[] = " s ";

void head_note_text(char out[head_note_size], const HeadNote *n)
{
    uint8_t      octets[head_octets_most];
    const size_t count = head_pose_write(octets, &n->pose);
    size_t       at = (size_t)snprintf(out, head_note_size, "%s%a%s", begin, n->t_s, between);
    for (size_t i = 0; i < count; i++) at += (size_t)snprintf(out + at, head_note_size - at, "%02x", octets[i]);
}

static int digit(char c) { return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1; }

/* A line that is, to the octet, what head_note_text writes. */
static bool read_line(HeadNote *out, const char *line)
{
    static const double latest_s = 1e11;
    char                text[head_note_size], again[head_note_size];
    uint8_t             octets[head_octets_most];
    size_t              count = 0;
    const size_t        length = strcspn(line, "\n");
    if (length >= sizeof text || strncmp(line, begin, sizeof begin - 1) != 0) return false;
    memcpy(text, line, length);
    text[length] = 0;
    char *at = text + sizeof begin - 1;
    if (*at == ' ') return false; /* strtod would pass over it */
    out->t_s = strtod(at, &at);
    if (!(fabs(out->t_s) < latest_s) || strncmp(at, between, sizeof between - 1) != 0) return false;
    for (at += sizeof between - 1; count < sizeof octets && digit(at[0]) >= 0 && digit(at[1]) >= 0; at += 2)
        octets[count++] = (uint8_t)(16 * digit(at[0]) + digit(at[1]));
    if (head_pose_read(&out->pose, octets, count) != HEAD_GOOD) return false;
    head_note_text(again, out);
    return strcmp(text, again) == 0;
}

static int by_time(const void *a, const void *b)
{
    const HeadNote *p = a, *q = b;
    return p->t_s < q->t_s ? -1 : p->t_s > q->t_s;
}

Status head_notes_read(HeadNotes **out, const char *notes)
{
    int      lines = 0;
    HeadNote one;
    *out = NULL;
    for (const char *at = notes; at; at = text_next_line(at)) lines += read_line(&one, at);
    if (lines == 0) return STATUS_OK;
    HeadNotes *n = malloc(sizeof *n + (size_t)lines * sizeof *n->note);
    if (!n) return STATUS_NO_MEMORY;
    n->count = 0;
    for (const char *at = notes; at; at = text_next_line(at))
        if (read_line(&one, at)) n->note[n->count++] = one;
    qsort(n->note, (size_t)n->count, sizeof *n->note, by_time);
    *out = n;
    return STATUS_OK;
}

int head_notes_at(const HeadNotes *n, double t_s)
{
    int low = -1, high = n->count; /* low is at or before t_s, high after it */
    while (high - low > 1) {
        const int middle = low + (high - low) / 2;
        if (n->note[middle].t_s <= t_s) low = middle;
        else high = middle;
    }
    return low;
}
