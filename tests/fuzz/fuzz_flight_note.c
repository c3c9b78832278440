/* tests/fuzz/fuzz_flight_note.c: any octets as the notes of a recording: a flight's are what would be written of them.
 */
#include "tests/fuzz/fuzz_seed.h"

#include "sensor/node/flight/flight_note.h"

#include <stdlib.h>

const int fuzz_rounds = 20000;

size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    const double u = (double)(index % 17) / 17;
    FlightNote   note = {.launch = index % 3 == 0, .tick = index, .taken_s = 10 + u, .after = index % 2};
    char         text[flight_note_size];
    FlightSight *s = &note.usable.sight;
    note.usable.from_s = 11 + u;
    s->t_s = 10 + u;
    for (int k = 0; k < 3; k++) {
        s->eye_ecef[k] = 4e6 + k + u, s->eye_v_ecef_mps[k] = 100 * u;
        s->los_ecef[k] = k == 0, s->los_rate_ecef_rps[k] = index % 5 ? 0.01 * u : NAN;
    }
    s->range_m = s->closing_mps = index % 7 ? NAN : 1000 * u;
    flight_note_text(text, &note);
    return fuzz_seed_text(out, text);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char       *notes = malloc(size + 1);
    FlightNote *note;
    char        text[flight_note_size];
    int         count;
    if (!notes) return 0;
    memcpy(notes, data, size);
    notes[size] = 0;
    if (flight_notes_read(&note, &count, notes) != STATUS_OK) abort();
    for (int i = 0; i < count; i++) {
        flight_note_text(text, &note[i]);
        if (!strstr(notes, text) || !(fabs(note[i].usable.from_s) <= 1e11)) abort();
    }
    free(note);
    free(notes);
    return 0;
}
