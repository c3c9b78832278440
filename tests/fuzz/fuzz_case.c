/* tests/fuzz/fuzz_case.c: any octets as a case.yaml. Without a fuzzer run_corpus.c drives it. */
#include "tests/fuzz/fuzz_seed.h"

#include "sensor/verify/regress/case.h"

#include <stdlib.h>

const int fuzz_rounds = 20000;

size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    static const char *const seed[2] = {
        "purpose: a missile flies at a truck\nscenario: demo\nscenario_set: seed=7 dis.version=6\nconfig: |\n  "
        "sensor:\n"
        "    width_px: 96\nframes: [3, 7, 12]\ncausal: true\ntimeout_s: 20\ntolerance:\n  lwir_k: 0.1\n  share: 0\n",
        "{purpose: p, log: \"${PITVIPER_DATA}/dis/singles.pcap\", config_file: node.yaml, frames: [0], tolerance: "
        "{truth: 2}}\n",
    };
    return fuzz_seed_text(out, seed[index % 2]);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    log_set_level((LogLevel)(LOG_ERROR + 1));
    char      path[fuzz_path_size], file_path[case_path_size], reason[256];
    const int file = fuzz_file(path, data, size);
    if (file < 0) return 0;
    Case         c = case_default();
    const Status status = case_read_file(&c, path);
    close(file);
    if (status != STATUS_OK) return 0;
    /* what the command builds on */
    if (!*c.purpose || !*c.log == !*c.scenario || (*c.config && *c.config_file)) abort();
    if (c.frames.count < 1 || c.frames.count > case_frames_max || !(c.timeout_s > 0)) abort();
    for (int i = 0; i < c.frames.count; i++)
        if (!(c.frames.number[i] >= 0 && c.frames.number[i] <= 999999) ||
            (i > 0 && !(c.frames.number[i] > c.frames.number[i - 1])))
            abort();
    (void)case_path(file_path, reason, &c, c.log);
    return 0;
}
