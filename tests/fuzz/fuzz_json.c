/* tests/fuzz/fuzz_json.c: any octets as run.json, scores.json or a line of truth.jsonl: two of them, held against each
 * other. Without a fuzzer run_corpus.c drives it. */
#include "tests/fuzz/fuzz_seed.h"

#include "sensor/verify/regress/verdict.h"

#include <stdlib.h>

const int fuzz_rounds = 20000;

static const char *const seed[3] = {
    "{\"frame\":3,\"time_s\":1364.5,\"host\":{\"entity\":\"1:3001:41\",\"ecef_m\":[-2812048.8,-4333706.3,3728373.2]},"
    "\"targets\":[{\"entity\":\"1:3001:12\",\"range_m\":1916.1,\"box_px\":[94,32,96,34],"
    "\"bands\":{\"lwir\":{\"contrast_k\":-4.0}}},{\"entity\":\"1:3001:13\",\"pixels\":2.6,\"x\":null}]}",
    "{\"pitviper\":\"0.1.0\",\"counters\":{\"datagrams\":132,\"pdus\":{\"1\":130},\"dropped\":{\"truncated\":0},"
    "\"entities\":{\"created\":7}},\"hosts\":[\"1:3001:41\"],\"live\":true}",
    "{\"answers\":3,\"ap\":0.5,\"all\":{\"chances\":3,\"found\":2,\"frames\":2,\"false_alarms\":1,\"detection\":0.6,"
    "\"detection_low\":0.1,\"detection_high\":0.9},\"bands\":{\"lwir\":{\"detection\":0.6,\"false_alarms_per_frame\":0.5}}}",
};

size_t fuzz_seed(uint8_t *out, uint32_t index) { return fuzz_seed_text(out, seed[index % 3]); }

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    log_set_level((LogLevel)(LOG_ERROR + 1));
    ChannelResult result[CHANNEL_COUNT] = {{0}};
    JsonValues    good, got;
    Tolerance     tolerance = case_default().tolerance;
    if (json_values_read(&got, (const char *)data, size, "fuzz", "fuzz") != STATUS_OK) return 0;
    for (int i = 0; i < got.count; i++) {
        if (!got.value[i].path || (got.value[i].text && !isnan(got.value[i].number))) abort();
        if (i > 0 && strcmp(got.value[i - 1].path, got.value[i].path) > 0) abort();
        if (!json_values_find(&got, got.value[i].path)) abort();
    }
    for (int i = 0; i < 3; i++) {
        if (json_values_read(&good, seed[i], strlen(seed[i]), "fuzz", "seed") != STATUS_OK) abort();
        verdict_truth(result, 3, &good, &got, 1);
        verdict_truth(result, 3, &got, &good, 1);
        verdict_counters(result, &good, &got);
        verdict_scores(&result[CHANNEL_SCORES], &good, &got, &tolerance);
        verdict_scores(&result[CHANNEL_SCORES], &got, &good, &tolerance);
        json_values_free(&good);
    }
    /* nothing differs from itself */
    ChannelResult same[CHANNEL_COUNT] = {{0}};
    verdict_truth(same, 3, &got, &got, 1);
    verdict_scores(&same[CHANNEL_SCORES], &got, &got, &tolerance);
    for (int k = 0; k < CHANNEL_COUNT; k++)
        if (same[k].failed) abort();
    json_values_free(&got);
    return 0;
}
