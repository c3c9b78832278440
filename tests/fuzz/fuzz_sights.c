/* tests/fuzz/fuzz_sights.c: any octets as the recording of a flight's sights. Without a fuzzer run_corpus.c drives it.
 */
#include "tests/fuzz/fuzz_seed.h"

#include "sensor/node/flight/flight_loop.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

const int fuzz_rounds = 2000;

size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    return (size_t)sprintf((char *)out,
                           "frame,sight,column_px,row_px\n%u,seen,48.25,%u.5\n%u,outside,,\n%u,none,,\n%u,empty,,\n",
                           index, index % 64, index + 1, index + 2, index + 3);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static FlightLoop loop;
    char              path[] = "/tmp/pitviper-fuzz-sights-XXXXXX";
    const int         file = mkstemp(path);
    log_set_level((LogLevel)(LOG_ERROR + 1));
    if (file < 0 || write(file, data, size) != (ssize_t)size || close(file) != 0) abort();
    loop = (FlightLoop){.row = NULL};
    const Status status = loop_sights_read(&loop, path);
    unlink(path);
    for (int i = 0; status == STATUS_OK && i < loop.row_count; i++) {
        const LoopRow *r = &loop.row[i];
        if (r->frame < 0 || r->frame > 999999 || (int)r->sight < 0 || r->sight >= loop_verdict_count) abort();
        if ((r->sight == LOOP_SEEN) != (isfinite(r->px[0]) && isfinite(r->px[1]))) abort();
    }
    free(loop.row);
    return 0;
}
