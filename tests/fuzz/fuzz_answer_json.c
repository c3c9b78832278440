/* tests/fuzz/fuzz_answer_json.c: any octets as an answer, from JSON. Without a fuzzer run_corpus.c drives it. */
#include "tests/fuzz/fuzz_answer.h"

const int fuzz_rounds = 100000;

static const char *const seed[4] = {
    "{\"frame\":12,\"band\":\"lwir\",\"detections\":[{\"class\":\"tank\",\"score\":0.9,\"box_px\":[1,2,30.5,40],\"track\":3},"
    "{\"los_deg\":[350.5,-2],\"range_m\":1200}]}",
    "{\"frame\":12,\"band\":\"optical\",\"time_s\":1369.0,\"answer\":1,\"of\":2,\"class\":\"truck\",\"box_px\":[8.0,4.0,36.0,27.0],"
    "\"score\":0.9,\"track\":3,\"latency_ms\":41.7,\"age_ms\":99.5,\"late\":false,\"form\":\"klv\"}\n"
    "{\"frame\":12,\"band\":\"optical\",\"answer\":2,\"of\":2,\"los_deg\":[10.0,-3.0],\"form\":\"ring\"}\n",
    "{\"frame\":12,\"band\":\"lwir\",\"time_s\":1.0,\"answer\":0,\"of\":0,\"late\":false}",
    "{\"frame\":0,\"band\":\"lwir\",\"detections\":[]}",
};

size_t fuzz_seed(uint8_t *out, uint32_t index) { return fuzz_seed_text(out, seed[index % 4]); }

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_answer(data, size);
    return 0;
}
