/* tests/fuzz/fuzz_world_note.c: any octets as the notes of a recording: a world's is within its ranges, and is what
 * would be written of it. */
#include "tests/fuzz/fuzz_seed.h"

#include "sensor/node/run/world_note.h"

#include <stdlib.h>

const int fuzz_rounds = 20000;

size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    const double    u = (double)(index % 17) / 17;
    const WorldNote note = {1.7e9 + u, {u - 0.5, 3 * u, 100 * u}, {{1e4 * u, -1e3 * u}, 50 + 1e4 * u, index % 2}};
    char            text[world_note_size];
    world_note_text(text, &note);
    return fuzz_seed_text(out, text);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char     *notes = malloc(size + 1);
    WorldNote note;
    char      text[world_note_size];
    if (!notes) return 0;
    memcpy(notes, data, size);
    notes[size] = 0;
    if (world_note_read(&note, notes)) {
        world_note_text(text, &note);
        if (!strstr(notes, text) || !(fabs(note.origin.lat_rad) <= 2) || !(note.square.half_width_m <= 50000)) abort();
    }
    free(notes);
    return 0;
}
