/* tests/fuzz/fuzz_scenario.c: any octets as a scenario. Without a fuzzer run_corpus.c drives it. */
#include "tests/fuzz/fuzz_seed.h"

#include "entities/exercise/scenario.h"

#include <stdlib.h>

const int fuzz_rounds = 4000;

/* One that comes with the program. */
size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    static const char *const name[] = {"demo", "guns", "aircraft", "crowd", "empty", "bad-pdus"};
    char                     path[1024], file_name[64];
    snprintf(file_name, sizeof file_name, "scenarios/%s.yaml", name[index % (sizeof name / sizeof *name)]);
    FILE *file = etc_path(path, sizeof path, file_name) ? fopen(path, "rb") : NULL;
    if (!file) return 0;
    const size_t size = fread(out, 1, fuzz_seed_octets, file);
    fclose(file);
    return size;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    log_set_level((LogLevel)(LOG_ERROR + 1));
    char      path[fuzz_path_size];
    const int file = fuzz_file(path, data, size);
    if (file < 0) return 0;
    Scenario scenario;
    if (scenario_read(&scenario, path) == STATUS_OK) {
        /* what the cast builds on */
        if (scenario_check(&scenario) != STATUS_OK) abort();
        if (scenario.group_count < 0 || scenario.group_count > scenario_max_groups) abort();
        if (scenario.shot_count < 0 || scenario.shot_count > scenario_max_shots) abort();
        int *ids = calloc((size_t)(scenario.group_count + scenario.shot_count) + 1, sizeof *ids);
        if (!ids) abort();
        long entities = 0;
        for (int g = 0; g < scenario.group_count; g++) {
            const int here = scenario_group_size(&scenario, &scenario.group[g]);
            if (here < 1 || here > scenario_max_entities || scenario.group[g].route_m.count % 2) abort();
            entities += here;
        }
        if (entities > scenario_max_entities) abort();
        if (scenario_ids(ids, &scenario))
            for (int s = 0; s < scenario.shot_count; s++) {
                int group, member;
                if (!scenario_find(&group, &member, &scenario, ids, scenario.shot[s].from)) continue;
                if (group < 0 || group >= scenario.group_count || member < 0) abort();
                if (member >= scenario_group_size(&scenario, &scenario.group[group])) abort();
            }
        free(ids);
        scenario_destroy(&scenario);
    }
    close(file);
    return 0;
}
