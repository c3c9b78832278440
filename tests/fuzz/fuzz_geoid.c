/* tests/fuzz/fuzz_geoid.c: any octets as a .gtx grid. Without a fuzzer run_corpus.c drives it. */
#include "tests/fuzz/fuzz_seed.h"

#include "terrain/earth/geoid.h"

#include <stdlib.h>

const int fuzz_rounds = 20000;

static size_t put_f64(uint8_t *out, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    for (int i = 0; i < 8; i++) out[i] = (uint8_t)(bits >> (56 - 8 * i));
    return 8;
}

static size_t put_u32(uint8_t *out, uint32_t bits)
{
    for (int i = 0; i < 4; i++) out[i] = (uint8_t)(bits >> (24 - 8 * i));
    return 4;
}

/* The whole Earth in steps of 30 degrees, or a piece of it. */
size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    const bool     whole = index % 2 == 0;
    const uint32_t rows = whole ? 7 : 5, columns = whole ? 12 : 6;
    size_t         n = 0;
    n += put_f64(out + n, whole ? -90 : 10);
    n += put_f64(out + n, whole ? -180 : 20);
    n += put_f64(out + n, whole ? 30 : 0.25);
    n += put_f64(out + n, whole ? 30 : 0.25);
    n += put_u32(out + n, rows);
    n += put_u32(out + n, columns);
    for (uint32_t i = 0; i < rows * columns; i++) {
        const float n_m = i == 8 && !whole ? -88.8888f : (float)(i % 50) - 25;
        uint32_t    bits;
        memcpy(&bits, &n_m, sizeof bits);
        n += put_u32(out + n, bits);
    }
    return n;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    log_set_level((LogLevel)(LOG_ERROR + 1));
    char      path[fuzz_path_size];
    const int file = fuzz_file(path, data, size);
    if (file < 0) return 0;
    Geoid geoid;
    if (geoid_open(&geoid, path) == STATUS_OK) {
        static const double at_deg[] = {-90, -89.9, -45.1, 0, 10.3, 11, 45, 89.99, 90, 179.999, 180, 21, 359};
        enum { places = sizeof at_deg / sizeof *at_deg };
        for (int i = 0; i < places; i++)
            for (int k = 0; k < places; k++) {
                const double n_m = geoid_height_m(&geoid, at_deg[i] * rad_per_deg, at_deg[k] * rad_per_deg);
                /* a cubic through posts of at most 200 m cannot pass twice that */
                if (!isnan(n_m) && !(fabs(n_m) <= 500)) abort();
            }
        geoid_close(&geoid);
    }
    close(file);
    return 0;
}
