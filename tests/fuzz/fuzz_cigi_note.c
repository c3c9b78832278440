/* tests/fuzz/fuzz_cigi_note.c: any octets as the notes of a recording: those of a CIGI host's time are within their
 * ranges, and are what would be written of them. */
#include "tests/fuzz/fuzz_seed.h"

#include "sensor/node/cigi/cigi_recorded.h"

#include <stdlib.h>

const int fuzz_rounds = 20000;

size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    const CigiTimeNote note = {1 + index * (uint64_t)index, 1e3 * (double)(index % 17) / 17 - 300,
                               1 + (int)index % 65535};
    char               text[cigi_time_note_size];
    cigi_time_note_text(text, &note);
    return fuzz_seed_text(out, text);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char        *notes = malloc(size + 1);
    const char  *at = notes;
    CigiTimeNote note;
    char         text[cigi_time_note_size];
    if (!notes) return 0;
    memcpy(notes, data, size);
    notes[size] = 0;
    while (cigi_time_note_next(&note, &at)) {
        cigi_time_note_text(text, &note);
        if (!strstr(notes, text) || note.datagram == 0 || note.port < 1 || !(fabs(note.offset_s) < 1e9)) abort();
    }
    free(notes);
    return 0;
}
