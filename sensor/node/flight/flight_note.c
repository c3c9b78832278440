/* sensor/node/flight/flight_note.c: notes of a live node's flight: written, and read again. */
#include "sensor/node/flight/flight_note.h"

#include <stdio.h>
#include <stdlib.h>

static const char begin_launch[] = "pitviper: missile launched at ", begin_sight[] = "pitviper: sight ";
enum { sight_numbers = 17 };

/* The numbers of a sight, in the order of the line. */
static void numbers_of(double *number[sight_numbers], FlightNote *n)
{
    FlightSight *s = &n->usable.sight;
    int          k = 0;
    number[k++] = &n->taken_s;
    number[k++] = &n->usable.from_s;
    number[k++] = &s->t_s;
    double *const vector[4] = {s->eye_ecef, s->eye_v_ecef_mps, s->los_ecef, s->los_rate_ecef_rps};
    for (int v = 0; v < 4; v++)
        for (int i = 0; i < 3; i++) number[k++] = &vector[v][i];
    number[k++] = &s->range_m;
    number[k++] = &s->closing_mps;
}

void flight_note_text(char out[flight_note_size], const FlightNote *note)
{
    FlightNote copy = *note;
    double    *number[sight_numbers];
    if (note->launch) {
        snprintf(out, flight_note_size, "%s%lld ms", begin_launch, (long long)note->tick);
        return;
    }
    size_t n = (size_t)snprintf(out, flight_note_size, "%s%s", begin_sight, note->after ? "after" : "before");
    numbers_of(number, &copy);
    for (int k = 0; k < sight_numbers && n < flight_note_size; k++)
        n += (size_t)(isnan(*number[k]) ? snprintf(out + n, flight_note_size - n, " nan")
                                        : snprintf(out + n, flight_note_size - n, " %a", *number[k]));
}

static bool in_range(const FlightNote *n)
{
    static const double latest_s = 1e11, far = 1e9;
    FlightNote          copy = *n;
    double             *number[sight_numbers];
    if (n->launch) return n->tick > -(INT64_C(1) << 50) && n->tick < INT64_C(1) << 50;
    numbers_of(number, &copy);
    for (int k = 0; k < sight_numbers; k++)
        if (k < 3 ? !(fabs(*number[k]) < latest_s) : fabs(*number[k]) > far) return false;
    return true; /* flight_command checks what guides */
}

static bool read_sight(FlightNote *out, const char *at)
{
    double *number[sight_numbers];
    char   *end;
    numbers_of(number, out);
    out->after = strncmp(at, "after ", 6) == 0;
    if (!out->after && strncmp(at, "before ", 7) != 0) return false;
    at += out->after ? 5 : 6;
    for (int k = 0; k < sight_numbers; k++) {
        if (*at++ != ' ') return false;
        *number[k] = strtod(at, &end);
        if (end == at) return false;
        at = end;
    }
    for (int i = 0; i < 3; i++) out->usable.sight.target_a_ecef_mps2[i] = NAN; /* of none that is noted it is known */
    return true;
}

bool flight_note_read(FlightNote *out, const char *line)
{
    char         text[flight_note_size], again[flight_note_size];
    const size_t length = strcspn(line, "\n");
    FlightNote   note = {0};
    if (length >= sizeof text) return false;
    memcpy(text, line, length);
    text[length] = 0;
    if (strncmp(text, begin_launch, sizeof begin_launch - 1) == 0) {
        note.launch = true;
        note.tick = strtoll(text + sizeof begin_launch - 1, NULL, 10);
    } else if (strncmp(text, begin_sight, sizeof begin_sight - 1) != 0 ||
               !read_sight(&note, text + sizeof begin_sight - 1)) {
        return false;
    }
    flight_note_text(again, &note);
    if (!in_range(&note) || strcmp(text, again) != 0) return false;
    *out = note;
    return true;
}

Status flight_notes_read(FlightNote **out, int *count, const char *notes)
{
    int        lines = 0;
    FlightNote one;
    *out = NULL;
    *count = 0;
    for (const char *at = notes; at; at = text_next_line(at)) lines += flight_note_read(&one, at);
    if (lines == 0) return STATUS_OK;
    *out = calloc((size_t)lines, sizeof **out);
    if (!*out) return STATUS_NO_MEMORY;
    for (const char *at = notes; at && *count < lines; at = text_next_line(at))
        if (flight_note_read(&(*out)[*count], at)) ++*count;
    return STATUS_OK;
}
