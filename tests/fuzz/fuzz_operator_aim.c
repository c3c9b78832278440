/* tests/fuzz/fuzz_operator_aim.c: any octets as a datagram of an operator's aim: what is taken is within its ranges. */
#include "tests/fuzz/fuzz_seed.h"

#include "sensor/node/flight/operator_sight.h"

#include <stdio.h>
#include <stdlib.h>

const int fuzz_rounds = 20000;

size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    return (size_t)sprintf((char *)out, "aim %u %d.5 -%d%s%s", index, (int)(index % 720) - 360, (int)(index % 89),
                           index % 3 ? "" : " launch", index % 2 ? "\n" : "");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    OperatorAim  aim = {.number = -7};
    const Status status = operator_aim_parse(&aim, data, size);
    if (status != STATUS_OK && aim.number != -7) abort();
    if (status == STATUS_OK && !(aim.number >= 0 && fabs(aim.azimuth_rad) < 7 && fabs(aim.elevation_rad) < 1.6))
        abort();
    return 0;
}
