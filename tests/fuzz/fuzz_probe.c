/* tests/fuzz/fuzz_probe.c: any octets as the rows of every probe whose columns they have. Without a fuzzer
 * run_corpus.c drives it. */
#include "tests/fuzz/fuzz_seed.h"

#include "entities/probe.h"
#include "render/probe.h"
#include "sensor/probe.h"
#include "terrain/probe.h"

#include <stdlib.h>

const int fuzz_rounds = 5000;

static const struct {
    const Probe *probe;
    const int   *count;
} lists[] = {{terrain_probes, &terrain_probe_count},
             {entities_probes, &entities_probe_count},
             {render_probes, &render_probe_count},
             {sensor_probes, &sensor_probe_count}};

enum { most_probes = 64, most_octets = 4096 };

/* What a probe opens is opened once and shared. */
typedef struct Kept {
    Probe probe;
    Status (*open)(void **state, int argc, char **argv);
    void *state;
} Kept;
static Kept kept[most_probes];
static int  kept_count, opening;

static Status open_kept(void **state, int argc, char **argv)
{
    Kept *k = &kept[opening];
    if (!k->state && k->open) {
        const Status status = k->open(&k->state, argc, argv);
        if (status != STATUS_OK) return status;
    }
    *state = k->state;
    return STATUS_OK;
}

static void keep(void)
{
    for (size_t l = 0; l < sizeof lists / sizeof *lists; l++)
        for (int i = 0; i < *lists[l].count; i++) {
            if (kept_count == most_probes) abort();
            Kept *k = &kept[kept_count++];
            k->probe = lists[l].probe[i];
            k->open = k->probe.open;
            k->probe.open = open_kept;
            k->probe.close = NULL;
        }
}

/* A row of ones for each probe in turn, and one of every kind of cell. */
size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    if (!kept_count) keep();
    const Probe *probe = &kept[index % (uint32_t)kept_count].probe;
    size_t       n = 0;
    for (const char *c = probe->in; *c; c++)
        if (*c != '$' && *c != '?') out[n++] = (uint8_t)*c;
    out[n++] = '\n';
    int columns = 1;
    for (const char *c = probe->in; *c; c++) columns += *c == ',';
    static const char *const cell[] = {"1", "0.5", "2", "us1976", "", "\"3\"", "-1e3", "lwir", "2026-06-21T10:00:00Z"};
    for (uint32_t row = 0; row < 3; row++)
        for (int i = 0; i < columns; i++) {
            const uint32_t at = (index / 8 + row * (uint32_t)i) % (sizeof cell / sizeof *cell);
            const char    *text = cell[row == 0 ? 0 : at];
            n += (size_t)sprintf((char *)out + n, "%s%s", text, i < columns - 1 ? "," : "\n");
        }
    return n;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static char model[] = "unknown", *argv[3] = {NULL, model, NULL};
    log_set_level((LogLevel)(LOG_ERROR + 1));
    if (!kept_count) keep();
    if (size == 0 || size > most_octets) return 0;
    for (opening = 0; opening < kept_count; opening++) {
        Probe *probe = &kept[opening].probe;
        /* noise3d makes as many frames as it is asked for: its limits are its own test's */
        if (strcmp(probe->name, "noise3d") == 0) continue;
        FILE  *in = fmemopen((void *)(uintptr_t)data, size, "rb");
        char  *text = NULL;
        size_t written = 0;
        FILE  *out = open_memstream(&text, &written);
        if (!in || !out) abort();
        argv[0] = (char *)(uintptr_t)probe->name;
        const Status status =
            probe_run(probe, probe->arguments && strcmp(probe->name, "rays") == 0 ? 2 : 1, argv, in, out);
        fclose(in);
        fclose(out);
        /* a line for each line, none of them longer than its own and its results */
        if (status == STATUS_OK && (written == 0 || text[written - 1] != '\n')) abort();
        free(text);
    }
    return 0;
}
