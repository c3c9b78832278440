/* tests/sensor/test_store_paging.c: a terrain store larger than the memory that the process may have, read whole and
 * rendered with the same bits. labels: deep */
#include "tests/sensor/store_frames.h"

#include "terrain/store/store.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>

static char folder[temp_path_size];

enum { wide_nx = 8001, wide_ny = 10001, coarse_nx = 1041, coarse_ny = 1281, limit_mb = 160 };

static void hills(StoreWriter *w, int index, const StoreLevel *l)
{
    float *row = malloc((size_t)64 * (size_t)l->nx * sizeof *row), *wave = malloc((size_t)l->nx * sizeof *wave);
    CHECK(row && wave);
    for (int i = 0; i < l->nx; i++) wave[i] = (float)(40 * sin((l->x0_m + i * l->spacing_m) / 97));
    for (int j0 = 0; j0 < l->ny; j0 += 64) {
        const int rows = l->ny - j0 < 64 ? l->ny - j0 : 64;
        for (int j = 0; j < rows; j++) {
            const float north = (float)(30 * cos((l->y0_m + (j0 + j) * l->spacing_m) / 61));
            for (int i = 0; i < l->nx; i++) row[(size_t)j * (size_t)l->nx + (size_t)i] = wave[i] + north;
        }
        assert_int_equal(store_write_posts(w, index, rows, row), STATUS_OK);
    }
    free(row);
    free(wave);
}

static void large_store(const char *path)
{
    const StorePlan plan = {
        .origin = {0.8, 0.2, 0},
        .level_count = 2,
        .level = {{wide_nx, wide_ny, -4000, -5000, 1, 0, 0, -1}, {coarse_nx, coarse_ny, -4160, -5120, 8, 0, 0, -1}}};
    StoreWriter *w;
    assert_int_equal(store_writer_create(&w, path, &plan, NULL), STATUS_OK);
    for (int n = 1; n >= 0; n--) hills(w, n, &plan.level[n]);
    assert_int_equal(store_writer_finish(w, 0, NULL), STATUS_OK);
}

/* A group of processes below this one's own, with a limit of memory: cgroup v2, or v1's memory controller. False: it
 * cannot be made. */
static bool make_group(char group[4096], bool *v2)
{
    char  line[2048], text[64];
    FILE *own = fopen("/proc/self/cgroup", "r");
    group[0] = 0;
    while (own && fgets(line, sizeof line, own)) {
        line[strcspn(line, "\n")] = 0;
        char *path = strchr(line, ':') ? strchr(strchr(line, ':') + 1, ':') : NULL;
        if (!path) continue;
        const bool unified = strncmp(line, "0::", 3) == 0, memory = strstr(line, ":memory:") != NULL;
        if (!unified && !memory) continue;
        char at[4096];
        snprintf(at, sizeof at, "/sys/fs/cgroup%s%s/pitviper-%d", memory ? "/memory" : "", path + 1, (int)getpid());
        if (mkdir(at, 0755) != 0) continue;
        snprintf(line, sizeof line, "%.2000s/%s", at, memory ? "memory.limit_in_bytes" : "memory.max");
        snprintf(text, sizeof text, "%d", limit_mb << 20);
        FILE      *limit = fopen(line, "r+");
        const bool put = limit && fputs(text, limit) >= 0;
        if (limit && fclose(limit) == 0 && put) {
            snprintf(group, 4096, "%s", at);
            *v2 = unified;
            break;
        }
        rmdir(at);
    }
    if (own) fclose(own);
    return group[0] != 0;
}

/* Every post, then frames, then every post again: the sum, and the hashes. */
static bool visit(FrameHashes *out, uint64_t *sum, const char *path)
{
    Landscape landscape;
    if (store_open_landscape(&landscape, path, 1) != STATUS_OK) return false;
    bool good = true;
    *sum = 0;
    for (int round = 0; round < 2; round++) {
        for (int n = 0; n < landscape.elevation.level_count; n++) {
            const ElevationLevel *l = &landscape.elevation.level[n];
            for (size_t k = 0; k < elevation_level_stored(l); k++) *sum += l->stored[k];
        }
        if (round == 0) good = render_all(out, &landscape);
    }
    landscape_destroy(&landscape);
    return good;
}

static void a_store_larger_than_memory_pages(void **state)
{
    (void)state;
    char        path[temp_name_size], group[4096], file[4200];
    FrameHashes free_hashes, limited;
    uint64_t    free_sum, sum;
    bool        v2 = false;
    int         pipe_ends[2], ended;
    struct stat about;
    if (!make_group(group, &v2)) {
        printf("skipped: no group of processes with a limit of memory can be made (cgroup, as root)\n");
        skip();
    }
    CHECK(temp_folder(folder));
    snprintf(path, sizeof path, "%s/large.store", folder);
    large_store(path);
    CHECK(visit(&free_hashes, &free_sum, path) && pipe(pipe_ends) == 0);
    const int store = open(path, O_RDONLY);
    CHECK(store >= 0 && fstat(store, &about) == 0 && posix_fadvise(store, 0, 0, POSIX_FADV_DONTNEED) == 0);
    close(store); /* its pages count for the group that reads them first */
    CHECK(about.st_size > (off_t)limit_mb << 20);
    const pid_t child = fork();
    CHECK(child >= 0);
    if (child == 0) {
        snprintf(file, sizeof file, "%s/cgroup.procs", group);
        FILE *procs = fopen(file, "w");
        if (!procs || fprintf(procs, "%d", (int)getpid()) < 0 || fclose(procs) != 0) _exit(3);
        if (!visit(&limited, &sum, path)) _exit(4);
        if (write(pipe_ends[1], &limited, sizeof limited) != sizeof limited ||
            write(pipe_ends[1], &sum, sizeof sum) != sizeof sum)
            _exit(5);
        _exit(0);
    }
    CHECK(waitpid(child, &ended, 0) == child);
    snprintf(file, sizeof file, "%s/%s", group, v2 ? "memory.peak" : "memory.max_usage_in_bytes");
    double peak = NAN;
    FILE  *usage = fopen(file, "r");
    if (usage) {
        if (fscanf(usage, "%lf", &peak) != 1) peak = NAN;
        fclose(usage);
    }
    rmdir(group);
    if (!WIFEXITED(ended) || WEXITSTATUS(ended) != 0)
        fail_msg("the reader under the limit ended with 0x%x, at %.0f MB", (unsigned)ended, 1e-6 * peak);
    CHECK(read(pipe_ends[0], &limited, sizeof limited) == sizeof limited);
    CHECK(read(pipe_ends[0], &sum, sizeof sum) == sizeof sum);
    printf("a store of %.0f MB, read twice and rendered in at most %.0f MB (limit %d)\n", 1e-6 * (double)about.st_size,
           1e-6 * peak, limit_mb);
    CHECK(sum == free_sum && memcmp(&limited, &free_hashes, sizeof limited) == 0);
    unlink(path);
    rmdir(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_store_larger_than_memory_pages)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
