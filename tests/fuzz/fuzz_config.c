/* tests/fuzz/fuzz_config.c: any octets as a configuration file. Without a fuzzer run_corpus.c drives it. */
#include "tests/fuzz/fuzz_seed.h"

#include "sensor/settings/config.h"
#include "sensor/settings/publish_choice.h"

#include <stdlib.h>

const int fuzz_rounds = 20000;

/* A key of every type, in one of three spellings. */
size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    static const char *const seed[3] = {
        "sensor:\n  width_px: 96\n  hfov_deg: 1.5e0\n  bands: optical,lwir\n  optical: pan\n  preset: none\n"
        "detector:\n  bits: 16\n  level: manual\n  smear: false\nexercise:\n  utc: 2026-06-21T10:00:00Z\n  from_s: -1\n"
        "  to_s: 2\npublish:\n  stream: udp://239.1.2.3:5004\n  video: a.mkv\n  video_codec: h264-10\nseed: 7\n",
        "{sensor: {width_px: 96, rate_hz: 0}, weather: {visibility_m: 23000, wind_from_deg: 0},\n"
        "terrain: {vertical: geoid, elevation: \"a,b\"}, observer: {range_m: 10}, entities: {capacity: 1}, seed: 1}\n",
        "# anchors\nsensor: &s {height_px: &n 64}\nradar:\n  bins: *n\n  bin_m: 0.3\nmodels: {sag_m: 0.1}\n",
    };
    return fuzz_seed_text(out, seed[index % 3]);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    log_set_level((LogLevel)(LOG_ERROR + 1));
    char      path[fuzz_path_size];
    const int file = fuzz_file(path, data, size);
    if (file < 0) return 0;
    const Config before = config_default();
    Config       config = before;
    const Status status = config_read(&config, path);
    close(file);
    if (status != STATUS_OK) {
        if (memcmp(&config, &before, sizeof config) != 0) abort(); /* a refused file changes nothing */
        return 0;
    }
    /* what the rest of the program builds on */
    if (!(config.sensor.width_px >= 8 && config.sensor.width_px <= 8192)) abort();
    if (!(config.sensor.hfov_deg >= 0.01 && config.sensor.hfov_deg <= 120)) abort();
    if (!(config.entities.capacity >= 1 && config.entities.capacity <= 1000000)) abort();
    if ((unsigned)config.sensor.optical > SENSOR_OPTICAL_NIR) abort();
    if ((unsigned)config.detector.level > DISPLAY_LEVEL_MANUAL) abort();
    static char text[1 << 16];
    config_text(text, sizeof text, &config);
    if (strlen(text) >= sizeof text - 1) abort();
    StreamUrl   url;
    const char *why = NULL;
    if (config_check(&config) == STATUS_OK && *config.publish.stream &&
        !(publish_stream_parse(&url, &why, config.publish.stream) && url.port > 0))
        abort();
    return 0;
}
